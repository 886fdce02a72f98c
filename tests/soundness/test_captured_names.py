"""Names of a file that are words of the verifier as well: nothing false follows, and all that is true does.

Every system here turns with closed forms: (u, y) or (w, s) on circles, y or s = 0 after half a turn, and what half a
turn adds to q is known. Each false claim is one that holds if a symbol of the system is taken for a quantity of the
verifier that has the same name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction as Q
from math import pi
from typing import Any

import pytest
from flint import arb
from support.balls import agree

from orbitproof.shared.claims import Claim, Piece
from orbitproof.shared.formats import (
    COORDINATE,
    Atlas,
    Candidate,
    Equation,
    PeriodicAtlas,
    PeriodicCurveClaim,
    PeriodicOrbit,
    define_system,
)
from orbitproof.shared.systems import ReversibleSystem, System
from orbitproof.verify import enclose
from orbitproof.verify.certificate import Certificate, Limits, certify, recheck
from orbitproof.verify.curve import IntervalResult, PieceLimits, prove_piece
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_curve import PeriodicLimits, prove_periodic_piece

LIMITS = Limits(max_precision=256)
WHOLE = (Q(-1), Q(1))
SMALL = (Q(1, 2**92), Q(1, 2**56))
"""Half-widths of a box about a bifurcation."""
TINY = Q(1, 2**50)


def unit(size: int) -> tuple[tuple[Q, ...], ...]:
    """The unit matrix."""
    return tuple(tuple(Q(int(i == j)) for j in range(size)) for i in range(size))


def turning(added: str, unused: str = "b", rate: str = "u**2 + y**2") -> ReversibleSystem:
    """u = r cos(w t), y = r sin(w t), where w is the `rate`; q' is `added`; r stands for r^2 in it."""
    system = define_system(
        {
            "name": "turning", "state": "u y q", "parameters": ["a", unused], "section": "y", "family_parameter": "a",
            "where": {"r": "u**2 + y**2", "w": rate}, "field": {"u": "-w*y", "y": "w*u", "q": added},
            "R": {"y": -1, "q": -1},
        }
    )  # fmt: skip
    assert isinstance(system, ReversibleSystem)
    return system


def springing(integral: str, added: str, parameters: str = "", other: str = "y", **more: Any) -> ReversibleSystem:
    """w = h^(1/2) cos t, s = h^(1/2) sin t on the level h; the coordinate `other` rests; q' is `added`."""
    system = define_system(
        {
            "name": "springing", "state": ["w", "s", other, "q"], "parameters": parameters, "section": "s",
            "field": {"w": "-s", "s": "w", other: "0", "q": added}, "R": {"s": -1, "q": -1},
            "first_integral": "w**2 + s**2", "first_integral_name": integral, "level_coordinate": "w", **more,
        }
    )  # fmt: skip
    assert isinstance(system, ReversibleSystem)
    return system


def claimed(system: ReversibleSystem, kind: str, *centre: Q, **more: Any) -> Candidate:
    """A claim about a box about a point; all parameters but the first are 0, unless they are given."""
    given: dict[str, Any] = {
        "id": "claim", "system": system, "parameters": dict.fromkeys(system.fixed_parameters, Q(0)), "kind": kind,
        "k": 1, "centre": centre, "frame": unit(2), "kernel_frame": unit(1), "radii": SMALL,
    }  # fmt: skip
    return Candidate(**(given | more))


def orbit(system: ReversibleSystem, a: Q, at: Q, **more: Any) -> Candidate:
    """One orbit, that at this value of the family parameter."""
    equation = Equation(COORDINATE, a, "a")
    return claimed(system, "orbit", a, at, radii=(Q(1, 2**40),) * 2, equation=equation, **more)


def on_a_level(unused: str = "b", other: str = "y") -> ReversibleSystem:
    """On the level 7/4 half a turn adds pi (3/4 + y + a) to q: the orbits have y = -3/4 - a."""
    level = {"fixed_level": {"value": "7/4", "sign": 1}, "family_parameter": "a"}
    return springing("energy", f"{other} + a + w**2 + s**2 - 1", f"a {unused}", other, **level)


def at_level(integral: str, h: Q) -> Candidate:
    """That of half a turn, which adds pi (y^2 - h + 1) to q, the fold is at the level h; it is at 1."""
    system = springing(integral, "y**2 - w**2 - s**2 + 1 + w")
    return claimed(system, "fold", h, Q(0), level_sign=1, radii=(Q(1, 2**52), Q(1, 2**30)))


def with_energy(integral: str, h: Q) -> Candidate:
    """The same of half a turn that adds pi (y^2 - h + 13/4): there is a parameter E = -5/4."""
    system = springing(integral, "y**2 - w**2 - s**2 - E + 2", "E")
    numbers = {"parameters": {"E": Q(-5, 4)}, "radii": (Q(1, 2**52), Q(1, 2**30))}
    return claimed(system, "fold", h, Q(0), level_sign=1, **numbers)


def sheared(unused: str) -> PeriodicOrbit:
    """The circle x^2 + y^2 = 1, from the section x + y = 1: its multiplier is exp(pi/4)."""
    system = define_system(
        {
            "name": "sheared", "state": "x y", "parameters": [unused],
            "where": {"r": "x**2 + y**2 - 1", "w": "1 + r/30"},
            "field": {"x": "x*r/16 - w*y", "y": "w*x + y*r/16"},
        }
    )  # fmt: skip
    return PeriodicOrbit(
        id="circle", system=system, parameters={unused: Q(0)}, normal=(Q(1), Q(1)), offset=Q(1), direction=1,
        crossings=1, centre=(Q(1), Q(0)), frame=((Q(1),), (Q(-1),)), radii=(TINY,),
    )  # fmt: skip


FOLD, DOUBLING, DRIFT = "a + 1 - r - u", "(1 + a)*(r - 1) - u*(1 + r)/2", "1/2**50 - u"
"""Half a turn adds (pi/r) (a + 1 - r), (pi/r) (1 + a) (r - 1), and (pi/r)/2^50, with r for r^2."""

FALSE: dict[str, Callable[[str], Candidate]] = {
    "fold": lambda name: claimed(turning(FOLD, name), "fold", Q(0), Q(1)),
    "doubling": lambda name: claimed(
        turning(DOUBLING, name), "period_tupling", Q(0), Q(1), k=2, radii=(Q(1, 2**92), Q(1, 2**56))
    ),
    "drift": lambda name: orbit(turning(DRIFT, name), Q(0), Q(1)),
    "level": lambda name: orbit(on_a_level(name), Q(0), Q(0), parameters={name: Q(1)}),
}
"""By what is claimed; with the name of an unused parameter. On its level `on_a_level` has y = -3/4 at a = 0."""

HARMLESS = "b"
OURS = ("distance", "rate", "level", HARMLESS)


def said(certificate: Certificate) -> str:
    """The verdict, and what it is about."""
    return f"{certificate}: {dict(certificate.point)}"


@pytest.mark.parametrize("name", OURS)
@pytest.mark.parametrize("what", FALSE)
def test_nothing_false_is_proved_beside_an_unused_parameter(what: str, name: str) -> None:
    found = certify(FALSE[what](name), LIMITS)
    assert not found.proved, said(found)
    assert found.reason is not None
    assert found.reason.condition != "verification", found.reason.message


@pytest.mark.parametrize(("other", "y"), [("level", Q(1, 2)), ("level", Q(-3, 4)), ("y", Q(-3, 4))])
def test_a_coordinate_called_like_the_level_is_not_taken_for_it(other: str, y: Q) -> None:
    """With its own value for the level of H there is an orbit at 1/2."""
    assert certify(orbit(on_a_level(other=other), Q(0), y), LIMITS).proved == (y == Q(-3, 4))


@pytest.mark.parametrize("name", OURS)
def test_an_orbit_keeps_its_multiplier_beside_an_unused_parameter(name: str) -> None:
    found = certify(sheared(name), LIMITS)
    assert found.periodic is not None
    (multiplier,) = found.periodic.multipliers.values
    assert agree(multiplier.real, (arb.pi() / 4).exp())
    assert found.periodic.multipliers.outside == 1


INTEGRALS = ("E", "w", "s", "y", "q", "level", "energy")


@pytest.mark.parametrize("integral", INTEGRALS)
def test_a_first_integral_may_be_called_like_a_parameter(integral: str) -> None:
    """With the level for E the fold would be at 1; it is at 13/4."""
    false, true = (certify(with_energy(integral, h), LIMITS) for h in (Q(1), Q(13, 4)))
    assert not false.proved, said(false)
    assert true.proved, said(true)


@pytest.mark.parametrize("integral", INTEGRALS[1:])
def test_a_first_integral_may_be_called_like_a_coordinate(integral: str) -> None:
    """With the level for q at the start, which is 0, the fold would be at pi/(pi - 1), with that for s at 0.684."""
    wrong = (Q(int(pi / (pi - 1) * 2**40), 2**40), Q(int(0.6842891153174836 * 2**40), 2**40))
    for h in wrong:
        found = certify(at_level(integral, h), LIMITS)
        assert not found.proved, said(found)
    assert certify(at_level(integral, Q(1)), LIMITS).proved


def line(length: Q, tube: Q) -> Piece:
    """a from 0 to `length`, the other coordinate 1."""
    middle = length / 2
    return Piece("p1", "regular", (middle, Q(1)), unit(2), middle, ((Q(0),),), (tube,), "physical")


def proved(atlas: Atlas | PeriodicAtlas) -> IntervalResult:
    """What is found of the first piece, over all of s."""
    piece = atlas.curve_pieces()[0]
    if isinstance(atlas, PeriodicAtlas):
        return prove_periodic_piece(atlas, piece, WHOLE, ORACLE, PeriodicLimits(80, 30, 16, 1)).stored
    limits = PieceLimits(80, 24, 12)
    return prove_piece(atlas.system, atlas.parameters, piece, WHOLE, ORACLE, limits).stored


def symmetric_arc(system: ReversibleSystem, name: str, value: Q, tube: Q) -> Atlas:
    """u = 1, a from 0 to 1."""
    piece = line(Q(1), tube)
    return Atlas("arc", "an arc", system, {name: value}, Claim("arc", None), (piece,))


def free_arc(name: str, value: Q) -> PeriodicAtlas:
    """The unit circle, run through in the time 2 pi/(1 + a/4), a from 0 to 1/2."""
    system: System = define_system(
        {
            "name": "faster", "state": "x y", "parameters": ["a", name],
            "where": {"r": "(1 - x**2 - y**2)/8", "w": "1 + a/4"}, "field": {"x": "r*x - w*y", "y": "r*y + w*x"},
        }
    )  # fmt: skip
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1)), Q(0), 1, 1, "a")
    piece = line(Q(1, 2), Q(1, 10**8))
    return PeriodicAtlas("faster", "Faster and faster", system, {name: value}, claim, (piece,))


@pytest.mark.parametrize("name", OURS)
def test_no_curve_is_proved_where_there_are_no_orbits(name: str) -> None:
    found = proved(symmetric_arc(turning(DRIFT, name), name, Q(0), Q(1, 2**30)))
    assert found.verdict == "not proved"


def within(times: arb, low: float, high: float) -> bool:
    """Whether a ball holds this interval and is less than half as wide again."""
    lower, upper = float(times.lower()), float(times.upper())
    return lower <= low <= high <= upper and upper - lower < 1.5 * (high - low)


@pytest.mark.parametrize("name", ["rate", "distance"])
def test_times_along_curves_are_kept_beside_an_unused_parameter(name: str) -> None:
    """They go from pi to pi/(1 + 1/10), and from 2 pi to 2 pi/(1 + 1/8)."""
    system, value = turning("r - 1", name, "1 + a/10"), Q(1, 2)
    found = proved(symmetric_arc(system, name, value, Q(1, 2**20))), proved(free_arc(name, value))
    for result, (low, high) in zip(found, ((pi / 1.1, pi), (2 * pi / 1.125, 2 * pi)), strict=True):
        assert result.verdict == "proved", result.reason
        assert result.time is not None
        assert within(result.time, low, high), result.time


@pytest.mark.parametrize("name", OURS)
@pytest.mark.parametrize("value", ["1e-8", "0", "1"])
def test_enclosures_for_use_are_kept_beside_an_unused_parameter(name: str, value: str) -> None:
    system = define_system({"name": "oscillator", "state": "x v", "parameters": [name], "field": {"x": "v", "v": "-x"}})
    box = enclose.box({"x": 1, "v": 0, name: value}, radii={"x": "1e-3"})
    half = enclose.poincare_map(system, box, enclose.section("v"), direction=1)
    assert isinstance(half, enclose.Enclosure), half
    assert agree(half.centre.time, arb.pi())
    assert agree(half.jacobian["x"][0], arb(-1))


NAMES_OF_KEYS: Sequence[tuple[str, str]] = (
    ("mid", "rad"), ("rad", "mid"), ("real", "imaginary"), ("box", "centre"), ("name", "decimal"), ("kind", "k"),
)  # fmt: skip
"""Keys of balls and tables in certificates."""


@pytest.mark.parametrize("names", NAMES_OF_KEYS, ids=" ".join)
def test_coordinates_may_be_called_like_the_keys_of_a_certificate(names: tuple[str, str]) -> None:
    x, y = names
    system = define_system(
        {
            "name": "keys", "state": [x, y], "parameters": "w",
            "where": {"s": f"1 - {x}**2 - {y}**2"},
            "field": {x: f"{x}*s/4 - w*{y}", y: f"w*{x} + {y}*s/4"},
        }
    )  # fmt: skip
    claim = PeriodicOrbit(
        id="keys", system=system, parameters={"w": Q(1)}, normal=(Q(0), Q(1)), offset=Q(0), direction=1, crossings=1,
        centre=(Q(1), Q(0)), frame=((Q(1),), (Q(0),)), radii=(TINY,),
    )  # fmt: skip
    found = certify(claim, LIMITS)
    assert found.proved
    again = Certificate.from_json(found.to_json())
    assert set(again.point) == {x, y}
    for integrate in (False, True):
        check = recheck(again, integrate)
        assert check.stands, (check.findings, check.obstacle)
