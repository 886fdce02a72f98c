"""How many bits to integrate a candidate with, and how many more if they are not enough (section 10.3).

Nothing here carries proof: a guess that is wrong costs an attempt.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite
from typing import TYPE_CHECKING, Any, Protocol

from flint import arb

from orbitproof.shared.claims import AroundPoint, HomoclinicCurve, HomoclinicOrbit
from orbitproof.shared.formats import BoxClaim, Candidate, InSection
from orbitproof.verify.bifurcation import coordinates_in_box
from orbitproof.verify.evidence import (
    GREATEST_PRECISION,
    LEAST_PRECISION,
    IntegrationFailure,
    NotProved,
    Outcome,
    Proved,
    Reason,
    count_certain_digits,
    enclose,
    excludes_zero,
    guarded,
    is_below,
    is_outside,
)
from orbitproof.verify.oracle.approximations import ORACLE
from orbitproof.verify.poincare import Returns, box_of, default_order

Verdict = Outcome[Any]

LEVELS = ("auto", "integral", "coordinates")

if TYPE_CHECKING:
    from orbitproof.verify.orbit import OrbitResults

_SPARE = 8
_RESERVE = 32
_RESERVE_PER_RETURN = 6
"""Bits that errors were found to gain along an orbit, and a little more."""

_FEW_STEPS = 8
"""A half return in regularised coordinates that takes more steps costs half a bit more for each of them."""

_BITS_PER_DIGIT = 3.33

_OF_ALL = 30

_NARROW_BITS = 4
"""An enclosure that is 2 to the minus this of a box wide, and reaches over its edge, is no longer for want of bits."""


_FARTHER = 1.01
"""More precision is worth while if the integration comes so many times as far."""


@dataclass(frozen=True)
class Limits:
    """How far to go for one candidate. Raises `ValueError` if a limit makes no sense.

    Attributes:
        max_precision: bits that are never exceeded.
        digits: certain digits to aim for, of the parameter or of the numbers of an orbit; a proof with fewer stands all
            the same.
        timeout: seconds of processor time, or `None`; looked at between integration steps.
        level: "coordinates" for candidates as they are, "integral" for the level of the first integral as
            parameter where there is such a form, "auto" for the better conditioned of both, then the other.
        other_boxes: so many boxes that failures ask for are tried where a claim is not proved on its own.
    """

    max_precision: int = 1024
    digits: int = 30
    timeout: float | None = None
    level: str = "auto"
    other_boxes: int = 4

    def __post_init__(self) -> None:
        if not LEAST_PRECISION <= self.max_precision <= GREATEST_PRECISION:
            raise ValueError(f"max_precision: {self.max_precision} bits are too few or too many")
        if self.digits < 1:
            raise ValueError(f"digits: {self.digits} is not positive")
        if self.timeout is not None and not (isfinite(self.timeout) and self.timeout > 0):
            raise ValueError(f"timeout: {self.timeout} is not a positive number of seconds")
        if self.level not in LEVELS:
            raise ValueError(f"level: {self.level!r} is none of {', '.join(LEVELS)}")
        if self.other_boxes < 0:
            raise ValueError(f"other_boxes: {self.other_boxes} is negative")


def first_precision(candidate: BoxClaim, digits: int, steps: int = 0) -> int:
    """Bits to begin with, if a half return takes so many `steps` in regularised coordinates (0: in the system's own).

    The error of G_1 has to stay well below R_0 G_01 for C3, and below the wanted digits of the
    bifurcation value; the error of p_2^H has to stay below R_2. Both grow with every return, and the
    first grade of a series is known to 5/6 of its bits.
    """
    value, slope = accuracy_bits(candidate, digits)
    a_return = _RESERVE_PER_RETURN + max(0, steps - _FEW_STEPS) / 2
    reserve = _RESERVE + floor(a_return * candidate.crossings * candidate.k)
    # A box much smaller than the digits ask for was made for an orbit along which errors grow.
    growth = max(0, slope - ceil(digits * _BITS_PER_DIGIT)) // 3
    wanted = max(value + reserve, (slope + reserve) * 6 // 5 + growth)
    return max(LEAST_PRECISION, -(-wanted // 8) * 8)


def periodic_precision(claim: InSection, digits: int) -> int:
    """Bits to begin with for a periodic orbit without symmetry.

    Derivatives are known to the error of the image divided by the half-widths of the box.
    """
    widths = max(_bits_below_one(radius.numerator, radius.denominator) for radius in claim.half_widths)
    wanted = widths + ceil(digits * _BITS_PER_DIGIT) + _RESERVE + 2 * _RESERVE_PER_RETURN * claim.crossings
    return max(LEAST_PRECISION, -(-wanted // 8) * 8)


def homoclinic_precision(claim: HomoclinicOrbit | HomoclinicCurve, digits: int) -> int:
    """Bits to begin with for a homoclinic orbit: errors are carried in frames, and grow as the orbits part."""
    widths = max(_bits_below_one(radius.numerator, radius.denominator) for radius in claim.half_widths)
    wanted = widths + _RESERVE + _RESERVE_PER_RETURN * (claim.crossings + claim.arrival)
    return max(LEAST_PRECISION, -(-wanted // 8) * 8)


def equilibrium_precision(claim: AroundPoint, digits: int) -> int:
    """Bits to begin with around a point: nothing is integrated, and few are lost."""
    widths = max(_bits_below_one(radius.numerator, radius.denominator) for radius in claim.half_widths)
    wanted = widths + ceil(digits * _BITS_PER_DIGIT) + 2 * _RESERVE
    return max(LEAST_PRECISION, -(-wanted // 8) * 8)


def breaking_precision(candidate: Candidate, digits: int) -> int:
    """Bits to begin with where R is lost: g is a derivative in q, over intervals of half as many bits as those of p.

    The same serves where multipliers collide.
    """
    widths = max(_bits_below_one(radius.numerator, radius.denominator) for radius in candidate.radii)
    a_return = _RESERVE_PER_RETURN * candidate.crossings
    wanted = widths // 2 + max(widths, ceil(digits * _BITS_PER_DIGIT)) + _RESERVE + 2 * a_return
    return max(LEAST_PRECISION, -(-wanted // 8) * 8)


def resonance_precision(candidate: Candidate, digits: int) -> int:
    """Bits to begin with where two resonances meet: an error over a width for each derivative."""
    widths = max(_bits_below_one(radius.numerator, radius.denominator) for radius in candidate.radii)
    a_return = 2 * _RESERVE_PER_RETURN * candidate.crossings
    wanted = widths + max(widths, ceil(digits * _BITS_PER_DIGIT)) + 2 * _RESERVE + a_return
    return max(LEAST_PRECISION, -(-wanted // 8) * 8)


def steps_of_centre(candidate: Candidate, precision: int) -> int:
    """About as many steps as the centre takes to its first return, 0 in the system's own coordinates."""
    try:
        with guarded(precision):
            box = box_of(candidate, precision, default_order(precision))
            return Returns(candidate.system, box.arithmetic, box.point, ORACLE, level=box.level).coordinates.steps
    except (IntegrationFailure, ArithmeticError, ValueError):
        return 0


def accuracy_bits(candidate: BoxClaim, digits: int) -> tuple[int, int]:
    """Bits that the errors of the last return and of its derivative should have.

    The first decide p_2^H, the second G_1, hence p_0 and the parameter. A guess that saves attempts.
    """
    radii = [_bits_below_one(radius.numerator, radius.denominator) for radius in candidate.radii]
    slope = max(radii[0], ceil(digits * _BITS_PER_DIGIT)) - _SPARE
    return max(slope, *radii[2:]) if radii[2:] else slope, slope


def _bits_below_one(numerator: int, denominator: int) -> int:
    return max(0, denominator.bit_length() - numerator.bit_length())


class _AtParameter(Protocol):
    @property
    def parameter(self) -> arb: ...


class _WithPeriod(Protocol):
    @property
    def period(self) -> arb: ...


class _AtPoint(Protocol):
    @property
    def point(self) -> Mapping[str, arb]: ...


class _AtParameterWithPeriod(_AtParameter, _WithPeriod, Protocol): ...


def missing_of_parameter(found: _AtParameter, digits: int) -> int:
    """How many digits the parameter of a bifurcation lacks."""
    return digits - count_certain_digits(found.parameter)


def missing_of_period(found: _WithPeriod, digits: int) -> int:
    """How many digits the period of an orbit lacks."""
    return digits - count_certain_digits(found.period)


def missing_of_either(found: _AtParameterWithPeriod, digits: int) -> int:
    """How many digits the parameter lacks, or the period where the parameter may be 0."""
    return missing_of_parameter(found, digits) if excludes_zero(found.parameter) else missing_of_period(found, digits)


def missing_of_point(found: _AtPoint, digits: int) -> int:
    """How many digits the coordinates of a point lack that are not 0."""
    return _missing(list(found.point.values()), digits)


def missing_of_orbit(found: OrbitResults, digits: int) -> int:
    """How many digits the number of an orbit lacks that is known least well.

    Stability parameters and multipliers are derivatives, which need more bits: from `_OF_ALL` digits on as many are
    asked of them, below that three fewer for each digit less.
    """
    balls = [*found.point.values(), *found.other_point.values(), found.period]
    balls += [] if found.level is None else [found.level]
    balls += [extremum.distance for extremum in (found.least, found.greatest) if extremum is not None]
    complex_numbers = (*found.stability.parameters, *found.stability.multipliers)
    derivatives = [part for value in complex_numbers for part in (value.real, value.imag)]
    of_derivatives = min(digits, 3 * digits - 2 * _OF_ALL)
    return max(_missing(balls, digits), _missing(derivatives, of_derivatives))


def _missing(balls: Sequence[arb], digits: int) -> int:
    """How many certain digits the balls that do not contain 0 lack at the most."""
    return max((digits - count_certain_digits(ball) for ball in balls if excludes_zero(ball)), default=0)


def more_precision(
    candidate: BoxClaim,
    precision: int,
    outcome: Verdict,
    previous: Verdict | None,
    limits: Limits,
    missing_digits: Callable[[Any, int], int],
) -> int | None:
    """Bits for the next attempt, at most the limit; `None` if there is no need or no hope.

    Args:
        missing_digits: how many digits the results lack, of so many that are wanted.
    """
    if isinstance(outcome, Proved):
        missing = missing_digits(outcome.results, limits.digits)
        wanted = precision + ceil(missing * _BITS_PER_DIGIT) + 16
        tried = isinstance(previous, Proved)
        return wanted if missing > 0 and not tried and wanted <= limits.max_precision else None
    if not outcome.reason.needs_precision:
        return None
    if outcome.reason.enough_precision is not None:
        return min(max(outcome.reason.enough_precision, precision + 8), limits.max_precision)
    enclosures = _enclosures(outcome)
    if not enclosures:
        if previous is not None and not _farther(outcome.reason, previous):
            return None
        # Nothing says how far away success is, so each attempt costs more than all before it.
        return min(2 * precision, limits.max_precision)
    if previous is not None and not _narrower(enclosures, previous, outcome.reason.condition):
        return None
    short = _bits_to_fit(candidate, enclosures)
    return min(precision + (max(32, precision // 4) if short is None else short * 6 // 5), limits.max_precision)


def _bits_to_fit(candidate: BoxClaim, enclosures: Mapping[str, arb]) -> int | None:
    """Bits by which the images of interval Newton operators are too wide for the box, and a few more."""
    images = {"p_0": 0, "p_0(P_1)": 0, "p_1": 1, "p_2": 2}
    ratios = [
        enclosures[name].abs_upper() / enclose(candidate.radii[j]) for name, j in images.items() if name in enclosures
    ]
    widest = max((float(ratio.log_base(2).mid()) for ratio in ratios if ratio.is_finite()), default=0.0)
    return ceil(widest) + _SPARE if widest > 0.0 and isfinite(widest) else None


def _narrower(enclosures: dict[str, arb], previous: Verdict, condition: str) -> bool:
    """Whether the last attempt made an enclosure of the failing condition half as wide.

    True if the attempt before it did not fail at the same condition.
    """
    if isinstance(previous, Proved) or previous.reason.condition != condition:
        return True
    before = _enclosures(previous)
    return not before or any(is_below(2 * enclosures[n].rad(), before[n].rad()) for n in before if n in enclosures)


def _farther(reason: Reason, previous: Verdict) -> bool:
    """Whether an integration broke off later than the one before it, or nothing tells."""
    if isinstance(previous, Proved) or previous.reason.reached is None or reason.reached is None:
        return True
    return previous.reason.condition != reason.condition or reason.reached > previous.reason.reached * _FARTHER


def _enclosures(outcome: NotProved) -> dict[str, arb]:
    condition = outcome.reason.condition
    found = [hypothesis.enclosures for hypothesis in outcome.hypotheses if hypothesis.name == condition]
    found += [outcome.reason.enclosures] if outcome.reason.enclosures else []
    return {name: ball for name, ball in found[-1].items() if ball.is_finite()} if found else {}


def missing_bits(origin: Candidate, point: Mapping[str, arb]) -> int | None:
    """Bits until the enclosure of a point is narrow compared with the box; `None` if it is so, or lies outside."""
    where = list(zip(coordinates_in_box(origin, point), origin.radii, strict=True))
    if not all(ball.is_finite() for ball, _ in where) or any(is_outside(ball, radius) for ball, radius in where):
        return None
    floor = arb(2) ** (-2 * _NARROW_BITS)
    widths = [float((ball.rad() / enclose(radius) + floor).log_base(2).mid()) for ball, radius in where]
    missing = ceil(max(widths)) + _NARROW_BITS
    return missing * 6 // 5 + _SPARE if missing > 0 else None
