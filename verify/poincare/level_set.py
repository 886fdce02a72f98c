"""The coordinate that follows from a fixed level at points of a set, as an element of the algebra (section 12.6)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import arb

from orbitproof.shared.systems import ReversibleSystem, record
from orbitproof.verify.algebra import GradedNorm, Series, at_start, convolve, geometric, inflate, total, without_time
from orbitproof.verify.claim import LevelEquation, level_program, quadratic_coefficient
from orbitproof.verify.evidence import IntegrationFailure, enclose, guarded, sign
from orbitproof.verify.poincare.crossing import range_of, wide_parts
from orbitproof.verify.poincare.functions import with_functions

_BISECTIONS = 60
_MOST_ITERATIONS = 16
_ATTEMPTS = 3
_MORE = 17 / 16
_PARTS = 8
_INVERSE = record(lambda x: (1 / x[0],), ("x",))


def on_fixed_level(system: ReversibleSystem, values: Sequence[Series]) -> list[Series]:
    """State and parameters at points of a system's fixed level; the entry of the level coordinate is not used."""
    place = system.state.index(str(system.level_coordinate))
    values = [*values[:place], on_level(system, values), *values[place + 1 :]]
    # H depends on no function of the level coordinate (12.1); the field may.
    return with_functions(system, values)


def on_level(system: ReversibleSystem, values: Sequence[Series]) -> Series:
    """The level coordinate w at points of a system's fixed level.

    Args:
        values: state and parameters; the entry of w is not used.

    Raises `IntegrationFailure` unless w follows from the level at all points.
    """
    level = system.fixed_level
    assert level is not None
    if level.between is None:
        if not quadratic_coefficient(system):
            raise IntegrationFailure("level", f"no coordinate of {system.name} follows from the level", "leave it out")
        constant = values[0].arithmetic.constant(level.value)
        return at_start(level_program(system, level.sign or 1), (*values, constant))[0]
    try:
        equation = LevelEquation.of(system)
    except ValueError as error:
        raise IntegrationFailure("level", str(error), "choose another level coordinate") from None
    arithmetic = values[0].arithmetic
    flat = [without_time(x) for x in values]
    with guarded(arithmetic.bits):
        w = _enclosed(equation, flat, _approximate(equation, flat))
        parts: Sequence[arb | None] = wide_parts(_PARTS) if arithmetic.width else [None]
        for part in parts:
            slope = equation.slope([range_of(x, part) for x in flat])
            if slope is None or not equation.contains(range_of(w, part)):
                raise _not_followed(equation, "is not shown to be the only one in its interval")
    return Series(arithmetic, w.coefs, w.errors)


def _not_followed(equation: LevelEquation, what: str) -> IntegrationFailure:
    remedy = "give fixed_level another interval (between), smaller radii, or a narrower piece"
    return IntegrationFailure("level", f"{equation.name} on the level {what}", remedy, needs_precision=True)


def _approximate(equation: LevelEquation, values: Sequence[Series]) -> Series:
    """By bisection at the middle of the set, then by Newton's method in the algebra; an element without errors."""
    arithmetic = values[0].arithmetic
    middle = [enclose(Fraction(int(x.coefs[0][0]), int(arithmetic.one))) for x in values]
    low, high = equation.level.ends
    assert low is not None
    assert high is not None
    first, last = (sign(equation.at(middle, enclose(end))[0]) for end in (low, high))
    if first * last >= 0:
        raise _not_followed(equation, "is not in its interval over the middle of the set")
    for _ in range(_BISECTIONS):
        half = (low + high) / 2
        low, high = (half, high) if sign(equation.at(middle, enclose(half))[0]) == first else (low, half)
    w = arithmetic.constant((low + high) / 2)
    before = float("inf")
    for _ in range(_MOST_ITERATIONS):
        step, _ = _newton(equation, values, w)
        size = total(step.known)
        if not size < before / 2:
            break
        w, before = _known(w - step), size
    return w


def _known(element: Series) -> Series:
    return Series(element.arithmetic, element.coefs, element.arithmetic.zero_errors())


def _newton(equation: LevelEquation, values: Sequence[Series], w: Series) -> tuple[Series, Series]:
    """c (H(w) - h), and c: about the inverse of dH/dw, an element without errors."""
    height, slope = _at(equation, values, w)
    try:
        c = _known(at_start(_INVERSE, [_known(slope)])[0])
    except IntegrationFailure:
        raise _not_followed(equation, "is not shown to vary smoothly with the other coordinates") from None
    return c * (height - w.arithmetic.constant(equation.level.value)), c


def _at(equation: LevelEquation, values: Sequence[Series], w: Series) -> list[Series]:
    """H and dH/dw where the level coordinate is w."""
    return at_start(equation.both, [*values[: equation.place], w, *values[equation.place + 1 :]])


def _enclosed(equation: LevelEquation, values: Sequence[Series], w: Series) -> Series:
    """The element near w with H = h, by the contraction of Lemma 12.4."""
    step, c = _newton(equation, values, w)
    one, size = w.arithmetic.constant(Fraction(1)), step.norm()
    reach = [inflate(2 * bound) for bound in size]
    for _ in range(_ATTEMPTS):
        _, slope = _at(equation, values, w.with_errors(reach))
        defect = (one - c * slope).norm()
        # A little more than m, so that the next r is more than d + m r in grades where d is 0, too.
        series = geometric([_MORE * bound for bound in defect])
        if series is None:
            break
        moved = _sum(size, convolve(defect, reach))
        if all(a <= b for a, b in zip(moved, reach, strict=True)):
            return w.with_errors(moved)
        reach = [inflate(2 * bound) for bound in _sum(size, convolve(series, size))]
    raise _not_followed(equation, "is not shown to vary smoothly with the other coordinates")


def _sum(left: GradedNorm, right: GradedNorm) -> GradedNorm:
    return [inflate(a + b) for a, b in zip(left, right, strict=True)]
