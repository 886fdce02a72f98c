"""Claims of every kind about cheap systems, and the ways in which each is told otherwise."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction as Q
from typing import Any

import mpmath
from support import (
    birth_cases,
    breaking_cases,
    equilibrium_cases,
    homoclinic_cases,
    krein_cases,
    periodic_curves,
    springs,
    tori_cases,
    torus_cases,
)
from support import function_cases as functions
from support import periodic_bifurcation_cases as bifurcations
from support import periodic_cases as periodic
from support.claims import known
from support.piece_cases import SYMMETRIC, TWIST, TWISTED

from orbitproof.shared.claims import Atlas, Claim, Piece
from orbitproof.shared.formats import (
    COORDINATE,
    HALF_PERIOD,
    LEVEL,
    BoxClaim,
    Candidate,
    Equation,
    PeriodicAtlas,
    define_system,
)
from orbitproof.shared.systems import ReversibleSystem, System
from orbitproof.verify import enclose
from orbitproof.verify.birth_curve import conclude_births
from orbitproof.verify.curve import conclude
from orbitproof.verify.equilibrium_curve import conclude_equilibria
from orbitproof.verify.lasting import conclude_lasting
from orbitproof.verify.periodic_curve import conclude_periodic
from orbitproof.verify.stability import conclude_list

SMALL = (Q(1, 2**92), Q(1, 2**56))
TINY = Q(1, 2**50)


# Claims about boxes


def _unit(size: int) -> tuple[tuple[Q, ...], ...]:
    return tuple(tuple(Q(int(i == j)) for j in range(size)) for i in range(size))


def _system(name: str, **description: Any) -> ReversibleSystem:
    system = define_system({"name": name, **description})
    assert isinstance(system, ReversibleSystem)
    return system


def _claim(system: ReversibleSystem, kind: str, centre: Sequence[Q], radii: Sequence[Q], **more: Any) -> Candidate:
    size = len(centre)
    given: dict[str, Any] = {
        "id": kind, "system": system, "parameters": {}, "kind": kind, "k": 1, "centre": tuple(centre),
        "frame": _unit(size), "kernel_frame": _unit(len(system.kernel_coordinates)), "radii": tuple(radii),
    }  # fmt: skip
    return Candidate(**(given | more))


def _on_levels(added: str, **more: Any) -> ReversibleSystem:
    """w and s turn on the circle of radius h^(1/2); y rests; half a turn adds pi times `added` to q."""
    given: dict[str, Any] = {
        "state": "w s y q", "parameters": "c", "section": "s", "R": {"s": -1, "q": -1},
        "field": {"w": "-s", "s": "w", "y": "0", "q": added}, "first_integral": "w**2 + s**2",
        "first_integral_name": "energy", "level_coordinate": "w", "symmetries": {"S": {"y": -1, "q": -1}},
    }  # fmt: skip
    return _system("clock-beside", **(given | more))


def _turning(added: str, **more: Any) -> ReversibleSystem:
    """u and y turn on the circle of radius r^(1/2) with the rate r; half a turn adds pi/r times `added` to q."""
    return _system(
        "turning", state="u y q", parameters="a c", section="y", family_parameter="a", R={"y": -1, "q": -1},
        where={"r": "u**2 + y**2"}, field={"u": "-r*y", "y": "r*u", "q": added}, **more,
    )  # fmt: skip


def fold() -> Candidate:
    """a = c (r - 1)^2."""
    return _claim(_turning("a - c*(r - 1)**2"), "fold", (Q(0), Q(1)), SMALL, parameters={"c": Q(3)})


def under_another_reversor() -> Candidate:
    """The same where u and q change their signs, on u = 0."""
    system = _turning("a - c*(r - 1)**2", reversors={"R2": {"R": {"u": -1, "q": -1}, "section": "u"}}).under("R2")
    return _claim(system, "fold", (Q(0), Q(1)), SMALL, parameters={"c": Q(3)})


def level_fold() -> Candidate:
    """h = c + y^2 without S."""
    system = _on_levels("w**2 + s**2 - c - y**2", symmetries={})
    return _claim(system, "fold", (Q(2), Q(0)), SMALL, parameters={"c": Q(2)}, level_sign=1)


def symmetry_breaking() -> Candidate:
    """y = 0, or h = c + y^2."""
    system = _on_levels("y*(w**2 + s**2 - c - y**2)")
    numbers: dict[str, Any] = {"parameters": {"c": Q(2)}, "level_sign": -1}
    return _claim(system, "symmetry_breaking", (Q(2), Q(0)), SMALL, symmetry="S", **numbers)


def fixed_level(kind: str = "orbit") -> Candidate:
    """On the level c + 7/4 with c = 1 the orbits have y = -3/4 - a."""
    system = _on_levels(
        "y + a + w**2 + s**2 - 1 - c", symmetries={}, parameters="a c", family_parameter="a",
        fixed_level={"value": "11/4", "between": ["1", "4"]},
    )  # fmt: skip
    equation = Equation(COORDINATE, Q(0), "a")
    return _claim(system, kind, (Q(0), Q(-3, 4)), (TINY, TINY), parameters={"c": Q(1)}, equation=equation)


def _spring(name: str, **changes: Any) -> Candidate:
    with mpmath.workprec(springs.BITS):
        return replace(springs.CLAIMS[name](), **changes)


def along_spring(kind: str, quantity: Any) -> Candidate:
    """Along the hard spring, the other at rest."""
    a = Q(3, 2)
    with mpmath.workprec(springs.BITS):
        time = springs.exactly(springs.half(springs.number(a)))
    values = {COORDINATE: a, HALF_PERIOD: time, LEVEL: a**2 + a**4 / 2}
    equation = Equation(quantity, values[quantity], "x" if quantity == COORDINATE else None)
    system = replace(springs.SPRINGS, squared_distance=None, distance_name=None)
    numbers = {"parameters": {"w": Q(2)}, "equation": equation}
    return _claim(system, kind, (a, Q(0)), (Q(1, 2**60),) * 2, **numbers)


def double_resonance() -> Candidate:
    """y turns by a quarter while the clock goes round, at least; at c = 0 and the level 1 by no more."""
    system = _system(
        "quarter", state="w y s q", parameters="c e", section="s", R={"s": -1, "q": -1},
        field={"w": "-s", "y": "q", "s": "w", "q": "-(e + c + (w**2 + s**2 - 1)**2)*y"},
        first_integral="w**2 + s**2", first_integral_name="energy",
    )  # fmt: skip
    numbers = {"parameters": {"e": Q(1, 16)}, "k": 4}
    return _claim(system, "double_resonance", (Q(0), Q(1), Q(0)), (Q(1, 2**60),) * 3, **numbers)


ROWS: Mapping[str, Callable[[], BoxClaim]] = {
    "fold": fold,
    "other-reversor": under_another_reversor,
    "level-fold": level_fold,
    "symmetry-breaking": symmetry_breaking,
    "fixed-level": fixed_level,
    "tupling": lambda: known("fs2"),
    "touch-and-go": lambda: known("fs3"),
    "quadrupling": lambda: known("fs4"),
    "reversor-breaking": breaking_cases.modes,
    "breaking-on-level": breaking_cases.on_level,
    "breaking-with-sine": lambda: breaking_cases.modes(system=breaking_cases.ANGLE),
    "orbit": lambda: _spring("once"),
    "by-half-period": lambda: along_spring("orbit", HALF_PERIOD),
    "by-level": lambda: along_spring("orbit", LEVEL),
    "two-crossings": lambda: _spring("twice"),
    "stable-orbit": lambda: along_spring("stable_orbit", COORDINATE),
    "tori": lambda: tori_cases.claim(tori_cases.BENT),
    "krein": krein_cases.clock,
    "double-resonance": double_resonance,
    "periodic": lambda: periodic.planar(Q(3, 2)),
    "periodic-3": periodic.hopf,
    "periodic-level": periodic.oscillators,
    "periodic-functions": lambda: functions.circle("nested", Q(3, 2), Q(1, 5)),
    "periodic-functions-level": functions.pendulum,
    "periodic-fold": bifurcations.folding,
    "periodic-functions-fold": functions.folding,
    "periodic-functions-pitchfork": functions.breaking,
    "periodic-functions-level-fold": functions.level_fold,
    "periodic-doubling": bifurcations.doubling,
    "periodic-pitchfork": bifurcations.breaking,
    "periodic-half": bifurcations.half_a_period,
    "periodic-twice": bifurcations.lorenz_second_pitchfork,
    "periodic-levels": bifurcations.levels,
    "periodic-level-fold": bifurcations.level_fold,
    "periodic-torus": torus_cases.round_claim,
    "periodic-torus-4": torus_cases.product_claim,
    "equilibrium": equilibrium_cases.equilibrium,
    "equilibrium-functions": equilibrium_cases.equilibrium_with_functions,
    "hopf": equilibrium_cases.hopf,
    "hopf-functions": equilibrium_cases.hopf_with_functions,
    "homoclinic": homoclinic_cases.wells,
    "heteroclinic": homoclinic_cases.hills,
    "homoclinic-curve": homoclinic_cases.wells_on_levels,
}
"""By what is claimed."""


# Claims about curves


@dataclass(frozen=True)
class Curve:
    """A curve, how it is proved, and what is asked of it besides.

    Attributes:
        settings: of the integrator.
        complete: the list up to this order is asked for; `lasting`: which orbits are stable for ever, too.
        conclude: what its results give together.
    """

    atlas: Atlas | PeriodicAtlas
    settings: Mapping[str, int]
    complete: int | None = None
    lasting: bool = False
    conclude: Callable[[Any, Any], Any] = conclude


FAST = {"precision": 64, "order": 24, "width": 12}


def _arc(system: ReversibleSystem, centre: Sequence[Q], reach: Q, rows: Sequence[Sequence[Q]], **more: Any) -> Atlas:
    """A graph over the first coordinate."""
    size = len(centre)
    tube = (Q(1, 2**18),) * (size - 1)
    piece = Piece("p1", "regular", tuple(centre), _unit(size), reach, tuple(map(tuple, rows)), tube, "physical")
    given: dict[str, Any] = {"parameters": {}, "claim": Claim("arc", None), **more}
    return Atlas("arc", "an arc", system, pieces=(piece,), **given)


def arc() -> Curve:
    """u = 1 while a goes from 0 to 1; half a turn takes pi/(1 + a/10)."""
    system = _system(
        "slower", state="u y q", parameters="a c", section="y", family_parameter="a", R={"y": -1, "q": -1},
        where={"r": "u**2 + y**2", "w": "1 + a/10"}, field={"u": "-w*y", "y": "w*u", "q": "c*(r - 1)"},
    )  # fmt: skip
    claim = Claim("arc", None, ("a",))
    return Curve(_arc(system, (Q(1, 2), Q(1)), Q(1, 2), [[Q(0)]], parameters={"c": Q(1)}, claim=claim), FAST)


def arc_on_level() -> Curve:
    """y = -3/4 - a, as `fixed_level`."""
    claim = fixed_level()
    return Curve(
        _arc(claim.system, (Q(0), Q(-3, 4)), Q(1, 4), [[Q(0), Q(-1, 4)]], parameters=claim.parameters), FAST
    )  # fmt: skip


def arc_of_two_crossings() -> Curve:
    """u = 1 and p from 1/2 to 3/2: (p, q) turns by half as much as (u, y)."""
    system = _system(
        "half-as-much", state="u p y q", section="y", R={"y": -1, "q": -1}, first_integral="u**2 + y**2",
        where={"w": "u**2 + y**2 - 1/2"}, field={"u": "-y", "y": "u", "p": "-w*q", "q": "w*p"},
        first_integral_name="radius",
    )  # fmt: skip
    # Over the second coordinate.
    piece = Piece(
        "p1", "regular", (Q(1), Q(1)), ((Q(0), Q(1)), (Q(1), Q(0))), Q(1, 2), ((Q(0),),), (Q(1, 2**20),), "physical"
    )
    atlas = Atlas("arc", "an arc", system, {}, Claim("arc", None, ("p",), crossings=2), (piece,))
    return Curve(atlas, FAST)


def symmetric_arc() -> Curve:
    """A circle from the point that S fixes."""
    atlas = Atlas("circle", "a circle", TWIST, TWISTED, Claim("symmetric-arc", "S"), (SYMMETRIC,))
    return Curve(atlas, FAST)


def listed() -> Curve:
    """Orbits along a hard spring, y at rest: the stability parameter varies with the amplitude."""
    system = replace(springs.SPRINGS, squared_distance=None, distance_name=None)
    atlas = _arc(system, (Q(9, 8), Q(0)), Q(1, 8), [[Q(0)]], parameters={"w": Q(3)})
    return Curve(atlas, {"precision": 96, "order": 30, "width": 16}, 4, True, _lasting)


def _lasting(atlas: Atlas, results: Any) -> Any:
    return conclude_lasting(atlas, results, conclude_list(atlas, results, conclude(atlas, results), 4))


def with_sine() -> Curve:
    """y' = sin q beside a turn: half a turn adds pi c sin(r - a) to q, which is 0 for r = a."""
    system = _system(
        "sine", state="u y q", parameters="a c", section="y", family_parameter="a", R={"y": -1, "q": -1},
        where={"r": "u**2 + y**2"}, field={"u": "-y", "y": "u", "q": "c*sin(r - a)"},
    )  # fmt: skip
    half = [Q(0), Q(1, 16), Q(-1, 512), Q(1, 8192), Q(-5, 524288), Q(7, 8388608)]
    return Curve(_arc(system, (Q(1), Q(1)), Q(1, 8), [half], parameters={"c": Q(1)}), FAST)


def _free(
    atlas: Any, precision: int = 64, order: int = 24, width: int = 14, top: int = 1, conclude: Any = conclude_periodic
) -> Curve:
    settings = {"precision": precision, "order": order, "width": width, "top": top}
    return Curve(atlas, settings, conclude=conclude)


CURVES: Mapping[str, Callable[[], Curve]] = {
    "arc": arc,
    "arc-on-level": arc_on_level,
    "arc-two-crossings": arc_of_two_crossings,
    "symmetric-arc": symmetric_arc,
    "arc-with-sine": with_sine,
    "list": listed,
    "periodic-arc": lambda: _free(periodic_curves.turning_atlas(), 80, 30, 20, 2),
    "periodic-arc-twice": lambda: _free(periodic_curves.twice_atlas()),
    "periodic-arc-levels": lambda: _free(periodic_curves.levels_atlas()),
    "periodic-arc-tilted": lambda: _free(periodic_curves.tilted_atlas()),
    "periodic-arc-on-level": lambda: _free(periodic_curves.on_level_atlas()),
    "equilibrium-arc": lambda: _free(equilibrium_cases.curve_of_equilibria(), 96, 24, 20, 2, conclude_equilibria),
    "birth-arc": lambda: _free(birth_cases.slaved_born(), 80, 24, 16, 1, conclude_births),
    "periodic-arc-functions": lambda: _free(functions.faster_atlas(), 80, 30, 20, 2),
    "periodic-arc-functions-levels": lambda: _free(functions.levels_atlas()),
}
"""By what is claimed."""


# Enclosures for use


@dataclass(frozen=True)
class Enclosed:
    """What is enclosed: the flow over a time, or a Poincare map."""

    system: System
    box: enclose.Box
    time: Q | None = None
    section: enclose.Section | None = None
    crossings: int = 1


def oscillator() -> Enclosed:
    """Half an oscillation, which takes pi/w."""
    system = define_system(
        {"name": "oscillator", "state": "x v", "parameters": "w", "field": {"x": "w*v", "v": "-w*x"}}
    )  # fmt: skip
    box = enclose.box({"x": 1, "v": 0, "w": 2}, radii={"x": "1e-3", "w": "1e-6"})
    return Enclosed(system, box, section=enclose.section("v"))


def lorenz() -> Enclosed:
    """From a plane to the plane, obliquely; in other units too z is what follows from the others on the plane."""
    box = enclose.box({"x": "-2", "y": "2", "z": "27", "sigma": 10, "rho": 28, "beta": "8/3"}, radii={"x": "1e-6"})
    return Enclosed(periodic.LORENZ, box, section=enclose.section({"z": 1, "x": "1/32"}, "27"), crossings=2)


def with_functions() -> Enclosed:
    """Along a field with sin, exp and log."""
    system = define_system(
        {
            "name": "functions", "state": "x y z", "parameters": "a",
            "field": {"x": "1", "y": "a*cos(a*exp(x))*exp(x)", "z": "log(x)"},
        }
    )  # fmt: skip
    box = enclose.box({"x": "7/10", "y": "1/10", "z": "-3/10", "a": "4/5"}, radii={"x": "1e-4", "a": "1e-5"})
    return Enclosed(system, box, time=Q(1, 4))


ENCLOSED: Mapping[str, Callable[[], Enclosed]] = {
    "enclose-map": oscillator,
    "enclose-plane": lorenz,
    "enclose-functions": with_functions,
}


Case = BoxClaim | Curve | Enclosed
CASES: Mapping[str, Callable[[], Case]] = {**ROWS, **CURVES, **ENCLOSED}


def system_of(case: Case) -> System:
    """The system that a case is about."""
    return case.atlas.system if isinstance(case, Curve) else case.system
