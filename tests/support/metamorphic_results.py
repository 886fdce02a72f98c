"""What is proved of a claim, and of the same claim told otherwise, compared number by number and word by word."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from fractions import Fraction
from typing import Any

from flint import acb, arb, ctx
from support.balls import agree
from support.metamorphic import Change

from orbitproof.verify.evidence import enclose
from orbitproof.verify.orbit.multipliers import UNDECIDED

PRECISION = 2048
MOST = 8.0
"""An enclosure is at most so many times as wide as that of the claim told otherwise, if all has the same units; else
so many times the largest of their ratios: all numbers are followed with the same bits after the point."""
LEAST = 2.0**-60
"""Radii below this part of a number, or of 1, are not compared: they are those of rounding."""
NEAR = Fraction(1, 2**20)
"""So near are ends of intervals of s."""

NAMED = ("point", "meeting", "other_point", "direction", "start", "end", "value", "jacobian", "derivatives")
"""Fields whose keys are names of coordinates and parameters."""
CALLED = ("parameter_name", "level_name", "along", "twist_coordinate", "twist_momentum")
"""Fields that hold a name."""
TIMES = ("period", "half_period", "time", "times", "time_derivatives")
RATES = ("frequency", "eigenvalues")
OF_PARAMETER = ("parameter", "values", "all_values")
OF_OTHER_UNITS = (
    "opening", "speed", "slope", "curvature", "unfolding", "coefficient", "gamma", "beta", "alpha", "twist", "defect",
    "lyapunov", "torsion", "torsion_determinant", "normal_form", "local", "passage", "slopes",
)  # fmt: skip
"""In units of the parameter, of coordinates in the section, or of both: of these only the accuracy is compared where
units differ."""
IN_ANY_ORDER = ("parameters", "multipliers", "values")
LEFT_OUT = (
    "chain", "segments", "hypotheses", "computation", "theorem", "certificates", "reason", "steps", "bits",
    "reversibility",
)  # fmt: skip
"""What says how something was shown; `reversibility` gives shares of widths of enclosures."""
BESIDE = (
    "stability",
    "multipliers",
    "eigenvalues",
    "sides",
    "characteristic",
    "local",
    "coefficients",
    "defect",
    "on",
    "inside",
    "outside",
)
"""Of coordinates beside more is said."""


@dataclass(frozen=True)
class Named:
    """What units a claim uses.

    Attributes:
        varies: the name of the parameter along which it is; `None` for the level of the first integral.
        integral: the name of that.
        along_parameter: whether `level` along a curve is that parameter.
    """

    varies: str | None
    integral: str | None
    along_parameter: bool = False


def leaves(value: Any, place: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Numbers and words of a value, by their place."""
    if isinstance(value, (arb, acb, str, bool, int, float, Fraction, Enum)) or value is None:
        yield place, value
    elif is_dataclass(value):
        for each in fields(value):
            if each.name not in LEFT_OUT:
                yield from leaves(getattr(value, each.name), (*place, each.name))
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from leaves(inner, (*place, str(key)))
    else:
        items = list(value)
        if place and place[-1] in IN_ANY_ORDER and all(isinstance(item, acb) for item in items):
            yield place, sorted(items, key=lambda item: (float(item.real.mid()), float(item.imag.mid())))
            return
        for index, inner in enumerate(items):
            yield from leaves(inner, (*place, str(index)))


def differences(before: Any, after: Any, change: Change, named: Named) -> Iterator[str]:
    """What differs between results of a claim and of the claim told otherwise, beyond names and units."""
    old = {_place(place, change): (place, value) for place, value in leaves(before) if not _is_left(place, change)}
    new = {place: value for place, value in leaves(after) if not _is_left(place, change)}
    if change.beside is not None:
        # Names of these are nowhere before.
        new = {place: value for place, value in new.items() if place in old}
    for place in sorted({*old} ^ {*new}):
        yield f"{'.'.join(place)}: is {'not there' if place in old else 'new'}"
    # Multipliers next to 1 are known to as many digits as chance has it.
    undecided = [place[:-1] for place, value in new.items() if value == UNDECIDED]
    with ctx.workprec(PRECISION):
        for place in [place for place in old if place in new and place[:-1] not in undecided]:
            (origin, value), found = old[place], new[place]
            why = _difference(origin, value, found, change, named)
            if why:
                yield f"{'.'.join(place)}: {why}"


def _is_left(place: Sequence[str], change: Change) -> bool:
    return change.beside is not None and any(key in BESIDE for key in place)


def _place(place: tuple[str, ...], change: Change) -> tuple[str, ...]:
    """The place with the names of the claim told otherwise."""
    return tuple(
        change.name(key) if number and _is_named(place, number) else key for number, key in enumerate(place)
    )  # fmt: skip


def _is_named(place: Sequence[str], number: int) -> bool:
    """Whether a key is the name of a coordinate or parameter; of points of a list it may be that of a field."""
    if "lasting" in place:
        return place[number - 1] == "point" and place[number] not in ("level", "half_period", "point")
    return place[number - 1] in NAMED


def _difference(place: tuple[str, ...], old: Any, new: Any, change: Change, named: Named) -> str:
    if isinstance(old, list):
        pairs = zip(old, new, strict=False)
        unit = 1 / change.time if any(key in RATES for key in place) else Fraction(1)
        found = (why for a, b in pairs for why in [_parts(a, b, unit, change)] if why)
        return f"{len(old)} and {len(new)} values" if len(old) != len(new) else next(found, "")
    if isinstance(old, (arb, acb)) and isinstance(new, (arb, acb)):
        return _parts(acb(old), acb(new), _unit(place, change, named), change)
    if isinstance(old, Fraction) and isinstance(new, Fraction):
        # Places along a curve, halved until something is decided.
        return "" if abs(old - new) <= NEAR else f"{float(old)}, told otherwise {float(new)}"
    if isinstance(old, str) and place[-1] in CALLED:
        integral = change.integral or named.integral
        old = integral if old == named.integral and place[-1] != "along" else change.name(old)
    if isinstance(old, str) and isinstance(new, str) and old not in (new, change.name(new)):
        return f"{old!r}, told otherwise {new!r}"
    return "" if old == new or isinstance(old, str) else f"{old}, told otherwise {new}"


def _unit(place: tuple[str, ...], change: Change, named: Named) -> Fraction | None:
    """What a number is multiplied by; `None` where that is not known."""
    for number, key in enumerate(place[1:], start=1):
        if _is_named(place, number):
            return change.factor(key)
    varied = change.level if named.varies is None else change.factor(named.varies)
    if any(key in TIMES for key in place):
        return change.time
    if any(key in RATES for key in place):
        return 1 / change.time
    if place[-1] == "level":
        return varied if named.along_parameter else change.level
    if any(key in OF_PARAMETER for key in place):
        return varied
    has_units = change.factors or change.time != 1 or change.level != 1
    return None if has_units and any(key in OF_OTHER_UNITS for key in place) else Fraction(1)


def _parts(old: acb, new: acb, unit: Fraction | None, change: Change) -> str:
    sizes = [1.0, *(abs(float(factor)) for factor in (*change.factors.values(), change.time, change.level))]
    most = MOST * max(sizes) / min(sizes)
    found = (_of_balls(a, b, unit, most) for a, b in ((old.real, new.real), (old.imag, new.imag)))
    return next((why for why in found if why), "")


def _of_balls(old: arb, new: arb, unit: Fraction | None, most: float) -> str:
    if unit is not None:
        expected = old * enclose(unit)
        if not agree(expected, new) and (old.is_finite() or new.is_finite()):
            return f"{expected.str(20)}, told otherwise {new.str(20)}"
    radii = []
    for ball, factor in ((old, abs(unit or 1)), (new, 1)):
        size = max(abs(float(ball.mid())), 1e-300)
        # Where the unit is not known, relative to the number.
        radii.append(float(ball.rad()) * float(factor) / (size if unit is None else 1.0))
    least = LEAST * (1.0 if unit is None else max(1.0, abs(float(new.mid()))))
    small, large = sorted(max(radius, least) for radius in radii)
    return f"radii {radii[0]:.2e}, told otherwise {radii[1]:.2e}" if large > most * small else ""
