"""Theorems about boxes and what was found, made and not proved: every sentence that may be said of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import fields, replace
from fractions import Fraction as Q
from functools import partial
from itertools import count, product
from typing import Any, get_type_hints

from flint import acb, arb
from support import periodic_bifurcation_cases as bifurcations
from support import periodic_cases
from support.claims import known
from support.metamorphic_cases import ROWS
from support.told import in_full

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import BoxClaim, Candidate, InSection
from orbitproof.shared.systems import FixedLevel, ReversibleSystem
from orbitproof.verify.bifurcation import level_form
from orbitproof.verify.certificate.kinds import kind_of
from orbitproof.verify.equilibrium import Spectrum
from orbitproof.verify.evidence import Reason
from orbitproof.verify.heteroclinic import End
from orbitproof.verify.orbit import STABLE, UNDECIDED, UNSTABLE, Extremum, Stability
from orbitproof.verify.periodic import Multipliers
from orbitproof.verify.tori import ToriTheorem

Told = Iterator[tuple[str, str]]
"""Names, and what is said under them; a name that begins with another one stands for a change of that."""


def ball(number: int) -> arb:
    """A different one for each number."""
    return arb(number, 2**-30) / 7


def made(kind: type, **given: Any) -> Any:
    """A value of a dataclass: fields that are balls are told apart by their places, others have to be given."""
    hints = get_type_hints(kind)
    balls = {each.name: ball(place) for place, each in enumerate(fields(kind), 3) if hints[each.name] is arb}
    named = {each.name: "a" for each in fields(kind) if each.name == "parameter_name"}
    return kind(**(balls | named | given))


def points(names: Any, first: int = 11) -> dict[str, arb]:
    return {name: ball(number) for name, number in zip(names, count(first), strict=False)}


MULTIPLIERS = {
    "none": Multipliers((), 0, 0, 0, 0, 1),
    "not enclosed": Multipliers((), 0, 0, 0, 2, 1),
    "inside": Multipliers((acb(ball(1)),), 1, 0, 0, 0, 1),
    "outside": Multipliers((acb(ball(1)), acb(ball(9), ball(2))), 1, 0, 1, 0, 1),
    "on": Multipliers((acb(ball(1), ball(2)), acb(ball(1), -ball(2))), 0, 2, 0, 0, 2),
    "one undecided": Multipliers((acb(ball(1)), acb(ball(7))), 1, 0, 0, 1, 1),
    "two undecided": Multipliers((acb(ball(7)), acb(ball(7)), acb(ball(8))), 0, 0, 1, 2, 1),
}
SPECTRA = {
    "none": Spectrum((), 0, 0, 0),
    "not enclosed": Spectrum((), 0, 0, 2),
    "left": Spectrum((acb(-ball(1)),), 1, 0, 0),
    "right": Spectrum((acb(ball(1)), acb(-ball(9), ball(2))), 1, 1, 0),
    "undecided": Spectrum((acb(-ball(1)), acb(ball(7))), 1, 0, 1),
}
_TWO = (acb(ball(1)), acb(ball(2), ball(3)))
FOUND: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "BifurcationResults": {
        "": {"side": "above", "normal_form": {}},
        "below": {"side": "below", "normal_form": {}},
        "on both sides": {"side": "both", "normal_form": {}},
    },
    "OrbitResults": {
        "": {"stability": Stability(_TWO, _TWO, STABLE)},
        "unstable": {"stability": Stability(_TWO, (), UNSTABLE)},
        "stability undecided": {"stability": Stability(_TWO, _TWO[1:], UNDECIDED)},
        "no stability": {"stability": Stability((), (), UNDECIDED)},
        "level and distances": {
            "stability": Stability(_TWO, _TWO, STABLE), "level": ball(20), "level_name": "energy",
            "distance_name": "the body", "least": Extremum(ball(21), (arb(0),)),
            "greatest": Extremum(ball(22), (ball(23),)),
        },
        "distances at several times": {
            "stability": Stability(_TWO, _TWO, STABLE), "distance_name": "the body",
            "least": Extremum(ball(21), (arb(0), ball(24))), "greatest": Extremum(ball(22), (ball(23), ball(25))),
        },
    },
    "StableOrbitResults": {
        "": {
            "stability": Stability(_TWO, _TWO, STABLE), "twist_coordinate": "x", "twist_momentum": "vx",
        },
        "falls": {
            "stability": Stability(_TWO, _TWO, STABLE), "twist_coordinate": "x", "twist_momentum": "vx",
            "twist": -ball(30),
        },
    },
    "ToriResults": {
        "": {
            "stability": Stability(_TWO, _TWO, STABLE), "rotation_numbers": (ball(1), ball(2)),
            "torsion": ((ball(3), ball(4)), (ball(5), ball(6))),
        },
    },
    "BreakingResults": {"": {"side": "above"}, "below": {"side": "below"}},
    "KreinResults": {
        "": {"side": "above", "type": "subcritical"},
        "below": {"side": "below", "type": "subcritical"},
        "supercritical": {"side": "above", "type": "supercritical"},
        "supercritical, below": {"side": "below", "type": "supercritical"},
    },
    "ResonanceResults": {
        "": {"side": "above", "turn": 1, "extremum": "minimum"},
        "below": {"side": "below", "turn": 1, "extremum": "maximum"},
    },
    "PeriodicResults": {
        name if number else "": {"multipliers": value} for number, (name, value) in enumerate(MULTIPLIERS.items())
    },
    "PeriodicBifurcationResults": {
        f"{multipliers}, {side}, {criticality}" if number else "": {
            "known": -1, "multipliers": MULTIPLIERS[multipliers], "side": side, "criticality": criticality,
        }
        for number, (multipliers, side, criticality) in enumerate(
            [("none", "above", None), ("inside", "above", None), ("inside", "below", None)]
            + [
                (multipliers, side, criticality)
                for multipliers in ("inside", "outside")
                for side in ("above", "below")
                for criticality in ("supercritical", "subcritical")
            ]
        )
    },
    "EquilibriumResults": {
        name if number else "": {"eigenvalues": value} for number, (name, value) in enumerate(SPECTRA.items())
    },
    "HopfResults": {
        f"{name}, {side}, {criticality}" if number else "": {
            "eigenvalues": SPECTRA[name], "side": side, "criticality": criticality,
        }
        for number, (name, side, criticality) in enumerate(
            (name, side, criticality)
            for name in ("none", "left", "right")
            for side in ("above", "below")
            for criticality in ("supercritical", "subcritical")
        )
    },
    "TorusResults": {
        f"{multipliers}, {side}, {criticality}, {sign:+d}" if number else "": {
            "multiplier": _TWO[1], "multipliers": MULTIPLIERS[multipliers], "speed": sign * ball(5), "side": side,
            "criticality": criticality,
        }
        for number, (multipliers, side, criticality, sign) in enumerate(
            (multipliers, side, criticality, sign)
            for multipliers in ("inside", "outside")
            for side, criticality, sign in (
                ("above", "supercritical", 1), ("below", "subcritical", 1), ("below", "supercritical", -1),
                ("above", "subcritical", -1),
            )
        )
    },
    "HeteroclinicResults": {
        "": {
            "ends": tuple(
                End({"x": ball(k)}, *map(ball, range(k + 1, k + 5)), (ball(k + 5), ball(k + 6))) for k in (1, 11)
            ),
            "meeting": {"x": ball(21), "u": ball(22), "v": ball(23)},
        },
    },
    "HomoclinicResults": {"": {"point": {"x": ball(1)}, "meeting": {"x": ball(2)}, "slopes": (ball(3), ball(4))}},
    "HomoclinicCurveResults": {"": {"point": {"x": ball(1)}, "meeting": {"x": ball(2)}, "slopes": (ball(3), ball(4))}},
}  # fmt: skip
"""By the kind of results, what may be found; the first as all others that are not named."""


def found_of(claim: BoxClaim) -> Mapping[str, Mapping[str, Any]]:
    """What may be found of a claim; of results that are not named there all follows from their fields."""
    return FOUND.get(kind_of(claim).results.__name__, {"": {}})


def results_of(claim: BoxClaim, **changes: Any) -> Any:
    """What may be found of a claim; with these changes."""
    kind = kind_of(claim).results
    given = {**found_of(claim)[""], **changes}
    hints, system = get_type_hints(kind), claim.system
    on_fixed = system.centre_coordinates if isinstance(system, ReversibleSystem) else system.state
    if "other_point" in hints:
        given["other_point"] = points(on_fixed, 31)
    if "direction" in hints:
        given["direction"] = points(system.state, 41)
    if "along" in hints:
        given["along"] = on_fixed[0]
    if "twist_coordinate" in hints:
        given |= {"twist_coordinate": system.state[0], "twist_momentum": system.state[1]}
    if "point" in hints:
        given = {"point": points(on_fixed), **given}
    return made(kind, **given)


def told(claim: BoxClaim, form: Candidate | None = None, **found: Any) -> str | None:
    """What a claim says, if that is a theorem, and what is found."""
    theorem = kind_of(claim).theorem_of(claim, form)
    return None if isinstance(theorem, Reason) else in_full(claim, theorem, results_of(claim, **found))


def _of(claim: BoxClaim, fixed: Mapping[str, Any] | None = None, **changes: Any) -> BoxClaim:
    """The claim about a system with other properties."""
    level = {} if fixed is None else {"fixed_level": FixedLevel(**fixed)}
    return replace(claim, system=replace(claim.system, **level, **changes))


def _variants(name: str, claim: BoxClaim) -> Iterator[tuple[str, Callable[[], BoxClaim]]]:
    if not isinstance(claim, Candidate | InSection):
        return
    for crossings in (2, 3):
        yield f"{crossings} crossings", partial(replace, claim, crossings=crossings)
    if not isinstance(claim, Candidate):
        yield "other direction", partial(replace, claim, direction=-claim.direction)
        normal = tuple(Q(2 * place - 1, 3) for place, _ in enumerate(claim.normal))
        yield "another section", partial(replace, claim, normal=normal)
        yield "a named integral", partial(_of, claim, first_integral_name="energy")
        yield "a level", partial(replace, claim, level=Q(3))
        return
    for sign in (1, -1):
        yield f"level {sign:+d}", partial(replace, claim, level_sign=sign)
    w = claim.system.level_coordinate or claim.system.state[0]
    for label, level in (("positive", {"sign": 1}), ("negative", {"sign": -1}), ("between", {"between": (Q(1), Q(4))})):
        fixed = {"value": Q(11, 4), **level}
        yield f"fixed level, {label}", partial(_of, claim, fixed, level_coordinate=w)
        yield (
            f"fixed level of no name, {label}",
            partial(_of, claim, fixed, level_coordinate=w, first_integral_name=None),
        )
    yield "no name of the integral", partial(_of, claim, first_integral_name=None)
    yield "a name that is a symbol", partial(_of, claim, first_integral_name="T")
    if name in ("tupling", "touch-and-go", "quadrupling", "symmetry-breaking", "double-resonance"):
        for k in (1, 2, 3, 4, 5, 6):
            if (claim.kind, k) != ("period_tupling", 3):
                yield f"k = {k}", partial(replace, claim, k=k)
            yield f"k = {k}, symmetric", partial(replace, claim, k=k, symmetry="S")


def variants(name: str, claim: BoxClaim) -> Iterator[tuple[str, BoxClaim]]:
    """The claim told otherwise, with more crossings, on levels, of another order, as far as that is a claim."""
    for label, make in _variants(name, claim):
        with suppress(InputError, ValueError):
            yield label, make()


def box_sentences() -> Told:
    """Of all cases of claims about boxes."""
    for name, text in _all():
        if text is not None:
            yield name, text


def _all() -> Iterator[tuple[str, str | None]]:
    kinds: set[str] = set()
    for name, make in ROWS.items():
        claim = make()
        yield name, told(claim)
        for label, found in found_of(claim).items():
            if label and claim.kind not in kinds:
                yield f"{name} / {label}", told(claim, **found)
        kinds.add(claim.kind)
        for label, other in variants(name, claim):
            yield f"{name} / {label}", told(other)
    for label, is_fixed in (("on the fixed set of S", True), ("moved by half a period", False)):
        found = {"is_fixed": is_fixed, "criticality": "supercritical"}
        yield f"periodic-half / {label}", told(ROWS["periodic-half"](), **found)
    area = bifurcations.area()
    yield "periodic-area", told(area)
    yield "periodic-area where c varies", told(replace(area, parameter="c"))
    yield from _of_other_systems()
    yield from _forced()


def _forced() -> Iterator[tuple[str, str | None]]:
    """Of a system with a force: how many of its periods an orbit has, if that is known."""
    orbit, fold, period = periodic_cases.locked(Q(7, 3)), bifurcations.forced_fold(), 4 * arb.pi()
    torus = replace(
        fold, kind="periodic-torus", kernel=((Q(1), Q(0), Q(0)), (Q(0), Q(1), Q(0))), multiplier=(Q(3, 5), Q(4, 5))
    )
    yield "forced", told(orbit, period=period * 3 / 7)
    yield "forced / not known how often", told(orbit, period=period * arb(3, 3) / 7)
    yield "forced-fold", told(fold, period=period / 3, parameter=arb(3, 2**-30))
    yield "forced-fold / where k varies", told(replace(fold, parameter="k"), period=period / 3)
    yield "forced-torus", told(torus, period=period / 3, parameter=arb(3, 2**-30))


def _of_other_systems() -> Iterator[tuple[str, str | None]]:
    """Claims for whose kinds no case is in such a system, and boxes in coordinates of the level."""
    level, family = ROWS["fixed-level"](), ROWS["fold"]()
    places = (("on a fixed level", level), ("of a family", family))
    for (where, base), kind in product(places, ("fold", "reversor_breaking", "stable_orbit")):
        equation = level.equation if kind == "stable_orbit" else None
        yield f"{kind} {where}", told(replace(base, kind=kind, equation=equation))
    # Tori need more coordinates than these systems have, and are told of them in the same way.
    for where, base in places:
        tori = replace(base, kind="invariant_tori", equation=level.equation)
        yield f"invariant_tori {where}", in_full(tori, ToriTheorem(tori), results_of(tori))
    for k in (2, 3, 4):
        yield f"tupling of order {k} with S", told(replace(ROWS["symmetry-breaking"](), kind="period_tupling", k=k))
    for name in ("em1", "em2"):
        claim = known(name)
        form = level_form(claim)
        assert isinstance(form, Candidate)
        yield f"{name} in its level form", told(claim, form)
        yield f"{name} in its level form / below", told(claim, form, side="below")
