"""Claims about maps with a known bifurcation, and what is concluded of them.

The maps stand for return maps of x' = 0, t' = 1: every function of x is a first integral, and linear maps of x are
symmetries.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import arb
from support.normal_form_maps import KnownBifurcation, Polynomial, known_bifurcation
from support.other_coordinates import Rows, elsewhere

from orbitproof.shared.formats import PeriodicBifurcation, define_system
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import (
    DerivativeTable,
    Outcome,
    enclose,
    guarded,
    index_factorial,
    indices_up_to,
    symmetric,
    total,
)
from orbitproof.verify.periodic import SectionReturn
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    PeriodicBifurcationResults,
)

BITS = 200
ZERO, ONE = Fraction(0), Fraction(1)
WIDTH = Fraction(1, 2**60)

SETTINGS = ["free", "level", "parameter on a level"]
KINDS = ["periodic-fold", "periodic-doubling", "fixed", "moved"]
CASES = [(kind, setting) for kind in KINDS for setting in SETTINGS if (kind, setting[-5:]) != ("moved", "level")]


def case(kind: str, setting: str, seed: int) -> tuple[KnownBifurcation, PeriodicBifurcation]:
    """A map of two or three coordinates and a claim about it; its other multipliers as those of the orbit."""
    chance = random.Random(f"{kind} {setting} {seed}")
    size, on_level = 2 + seed % 2, setting != "free"
    signs = (-1, *(chance.choice([1, -1]) for _ in range(1, size - on_level)), *([1] if on_level else []))
    known = known_bifurcation(
        1 if kind == "periodic-fold" else -1, size, chance, on_level, setting == "level",
        signs if kind == "fixed" else None,
    )  # fmt: skip
    more: dict[str, Any] = {"free": {}, "level": {"parameter": None, "level": ZERO}}.get(setting, {"level": ZERO})
    if kind == "fixed":
        more["symmetry"] = diagonal(*signs, 1)
        others = tuple(value * sign for value, sign in zip(known.others, signs[1:], strict=False))
        known = replace(known, others=others)
    if kind == "moved":
        more |= {"symmetry": diagonal(*[-1] * size, 1), "centre": (ONE,) * size + (ZERO,)}
        known = replace(known, others=tuple(value**2 for value in known.others))
    claim = claim_of(known, kind if kind.startswith("periodic") else "periodic-pitchfork", **more)
    return known, claim if seed < 3 else elsewhere(claim, chance)


def diagonal(*entries: int) -> Rows:
    """The matrix with these on its diagonal."""
    return tuple(tuple(Fraction(entry * (i == j)) for j in range(len(entries))) for i, entry in enumerate(entries))


def claim_of(known: KnownBifurcation, kind: str, **more: Any) -> PeriodicBifurcation:
    """One about the fixed point of the map."""
    size = len(known.derivatives)
    names = [f"x{place}" for place in range(size)]
    description: dict[str, Any] = {
        "name": "map",
        "state": [*names, "t"],
        "parameters": "a",
        "field": {**dict.fromkeys(names, "0*t"), "t": "1 + t**2"},
    }
    if known.integral is not None:
        description["first_integral"] = _written(known.integral, [*names, "a"])
    claim: dict[str, Any] = {
        "id": "map",
        "system": define_system(description),
        "parameters": {"a": ZERO},
        "parameter": "a",
        "normal": (ZERO,) * size + (ONE,),
        "offset": ZERO,
        "direction": 1,
        "crossings": 1,
        "centre": (ZERO,) * (size + 1),
        "frame": tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size + 1)),
        "radii": (WIDTH,) * size,
        "kind": kind,
        "kernel": (known.eigenvector,),
        "kernel_radius": Fraction(1, 2**20),
        "parameter_radius": WIDTH,
    }
    return PeriodicBifurcation(**(claim | more))


def _written(polynomial: Polynomial, names: list[str]) -> str:
    terms = []
    for index, value in polynomial.items():
        powers = [name for name, power in zip(names, index, strict=True) for _ in range(power)]
        terms.append("*".join([f"({value.numerator})/{value.denominator}", *powers]))
    return " + ".join(terms)


def enclosures_of(known: KnownBifurcation, claim: PeriodicBifurcation) -> BifurcationEnclosures:
    """As if the map were the return map of the claim."""
    varies = claim.parameter is not None
    sides = list(map(symmetric, (*claim.radii, *([claim.parameter_radius] if varies else []))))
    indices = indices_up_to(len(sides), 3)

    def table(values: Mapping[tuple[int, ...], Fraction]) -> DerivativeTable:
        known_here = {index if varies else index[:-1]: x for index, x in values.items() if varies or not index[-1]}
        centre = {index: enclose(known_here.get(index, ZERO)) for index in indices}
        return DerivativeTable({index: over_box(centre, index, sides) for index in indices}, centre)

    integral = None
    if known.integral is not None:
        integral = table({index: value * index_factorial(index) for index, value in known.integral.items()})
    time = table({(0,) * (len(claim.radii) + 1): ONE})
    return BifurcationEnclosures((), tuple(map(table, known.derivatives)), time, integral, 1, BITS, 1)


def outcome_of(
    known: KnownBifurcation, claim: PeriodicBifurcation, earlier: tuple[SectionReturn, ...] = ()
) -> Outcome[PeriodicBifurcationResults]:
    with guarded(BITS):
        found = replace(enclosures_of(known, claim), earlier=earlier)
    return _conclude(claim, BITS, found)


def over_box(centre: dict[tuple[int, ...], arb], index: tuple[int, ...], sides: list[arb]) -> arb:
    """The derivative of a polynomial of degree 3 on a box."""
    terms = []
    for shift in indices_up_to(len(index), 3 - sum(index)):
        term = centre[tuple(map(sum, zip(index, shift, strict=True)))] / index_factorial(shift)
        for side, power in zip(sides, shift, strict=True):
            for _ in range(power):
                term = term * side
        terms.append(term)
    return total(terms)
