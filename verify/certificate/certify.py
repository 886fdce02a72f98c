"""Certification of one candidate: symmetries, frames, integration, conditions; more precision if it helps.

The first precision follows from the radii; whatever fails for want of precision is tried again with
more, up to a limit. No exception leaves `certify`: what breaks off proves nothing, for whatever reason.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import ceil, isfinite

import numpy as np
from flint import arb

from orbitproof.shared.formats import Candidate, InputError
from orbitproof.verify.bifurcation import (
    BifurcationResults,
    check_exactly,
    check_own_box,
    coordinates_in_box,
    in_own_box,
    level_form,
    level_spread,
    prove,
    theorem_of,
)
from orbitproof.verify.certificate.certificate import Certificate, make_certificate
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    count_certain_digits,
    enclose,
    guarded,
    is_below,
    is_outside,
)
from orbitproof.verify.poincare import Enclosures, IntegratorSettings, enclose_iterates

Integrator = Callable[[Candidate, IntegratorSettings, Callable[[float], None] | None], Enclosures]
Progress = Callable[[float, str], None]

LEAST_PRECISION = 64
GREATEST_PRECISION = 65536
LEVELS = ("auto", "integral", "coordinates")

_SPARE = 8
_RESERVE = 32
_RESERVE_PER_RETURN = 6
"""Bits that errors were found to gain along an orbit, and a little more."""

_BITS_PER_DIGIT = 3.33

_NARROW_BITS = 4
"""An enclosure that is 2 to the minus this of a box wide, and reaches over its edge, is no longer for want of bits."""

_MOST_SPREAD = 8
"""The level form is tried first if its P_0 is at most so many times as long as the old one in terms of the level."""

_MOST_BITS_ACROSS = 32
"""It is not if P_2 is narrower than P_0 by more bits than that."""

_AT_THE_PARAMETER = (
    *("level-box", "candidate-box", "C2", "C3", "C4", "HC2", "HC3", "HC4", "point"),
    *("dH/dp_0", "h_fp'", "h_b'", "h_b''", "G_11", "G_01", "G_111"),
)
"""Hypotheses that depend on what the bifurcation parameter is; the others fail in both forms."""


@dataclass(frozen=True)
class Limits:
    """How far to go for one candidate. Raises `ValueError` if a limit makes no sense.

    Attributes:
        max_precision: bits that are never exceeded.
        digits: certain digits of the parameter to aim for; a proof with fewer stands all the same.
        timeout: seconds, or `None`; looked at between integration steps.
        level: "coordinates" for candidates as they are, "integral" for the level of the first integral as
            parameter where there is such a form, "auto" for the better conditioned of both, then the other.
    """

    max_precision: int = 1024
    digits: int = 30
    timeout: float | None = None
    level: str = "auto"

    def __post_init__(self) -> None:
        if not LEAST_PRECISION <= self.max_precision <= GREATEST_PRECISION:
            raise ValueError(f"max_precision: {self.max_precision} bits are too few or too many")
        if self.digits < 1:
            raise ValueError(f"digits: {self.digits} is not positive")
        if self.timeout is not None and not (isfinite(self.timeout) and self.timeout > 0):
            raise ValueError(f"timeout: {self.timeout} is not a positive number of seconds")
        if self.level not in LEVELS:
            raise ValueError(f"level: {self.level!r} is none of {', '.join(LEVELS)}")


class _OutOfTime(Exception):
    """The time limit of the row has passed."""


@dataclass(frozen=True)
class _Attempt:
    outcome: Outcome[BifurcationResults]
    precision: int
    order: int
    steps: int
    enclosures: Enclosures | None = None


def first_precision(candidate: Candidate, digits: int) -> int:
    """Bits to begin with.

    The error of G_1 has to stay well below R_0 G_01 for C3, and below the wanted digits of the
    bifurcation value; the error of p_2^H has to stay below R_2. Both grow with every return, and the
    first grade of a series is known to 5/6 of its bits.
    """
    value, slope = accuracy_bits(candidate, digits)
    reserve = _RESERVE + _RESERVE_PER_RETURN * candidate.k
    # A box much smaller than the digits ask for was made for an orbit along which errors grow.
    growth = max(0, slope - ceil(digits * _BITS_PER_DIGIT)) // 3
    wanted = max(value + reserve, (slope + reserve) * 6 // 5 + growth)
    return max(LEAST_PRECISION, -(-wanted // 8) * 8)


def accuracy_bits(candidate: Candidate, digits: int) -> tuple[int, int]:
    """Bits that the errors of the last return and of its derivative should have.

    The first decide p_2^H, the second G_1, hence p_0 and the parameter. A guess that saves attempts.
    """
    radii = [_bits_below_one(radius.numerator, radius.denominator) for radius in candidate.radii]
    slope = max(radii[0], ceil(digits * _BITS_PER_DIGIT)) - _SPARE
    return max(slope, *radii[2:]) if radii[2:] else slope, slope


def _bits_below_one(numerator: int, denominator: int) -> int:
    return max(0, denominator.bit_length() - numerator.bit_length())


def certify(
    candidate: Candidate,
    limits: Limits | None = None,
    progress: Progress | None = None,
    integrate: Integrator = enclose_iterates,
) -> Certificate:
    """The certificate of a candidate, proved or not.

    `progress` is called with the fraction of the current attempt and a word on what is being done.
    An exception of any kind, a defect of this program included, gives "not proved" with that reason.
    """
    limits = Limits() if limits is None else limits
    start = time.monotonic()
    try:
        return _certify(candidate, limits, start, progress, integrate)
    except Exception as error:
        return not_proved(candidate, broken_off("verification", error), time.monotonic() - start)


def not_proved(candidate: Candidate, reason: Reason, seconds: float) -> Certificate:
    """The certificate of a candidate of which nothing but a reason is known."""
    computation = {"precision": 0, "order": 0, "steps": 0, "attempts": 1, "seconds": round(seconds, 3)}
    return make_certificate(candidate, NotProved(reason), computation)


def broken_off(stage: str, error: Exception) -> Reason:
    """The reason of a stage that ended with an exception that no hypothesis accounts for."""
    message = " ".join(f"the {stage} broke off: {type(error).__name__}: {error}".split()).removesuffix(":")
    if isinstance(error, MemoryError):
        remedy = "free memory, or give fewer --jobs or --max-precision less"
    elif isinstance(error, InputError):
        remedy = "correct the candidate"
    elif isinstance(error, (ArithmeticError, ValueError)):
        remedy = "smaller radii or another centre"
    else:
        remedy = "report it together with the candidate: this is a defect of the verifier"
    return Reason(stage, message, remedy)


def _certify(
    candidate: Candidate, limits: Limits, start: float, progress: Progress | None, integrate: Integrator
) -> Certificate:
    tried: list[tuple[Candidate | None, _Attempt]] = []
    attempts = 0
    for form in _forms(candidate, limits):
        best, more = _escalate(candidate, form, limits, start, progress, integrate)
        attempts += more
        tried.append((form, best))
        if isinstance(best.outcome, Proved) or best.outcome.reason.condition not in _AT_THE_PARAMETER:
            break
    form, best = tried[-1] if isinstance(tried[-1][1].outcome, Proved) else tried[0]
    computation: dict[str, float | str] = {
        "precision": best.precision,
        "order": best.order,
        "steps": best.steps,
        "attempts": attempts,
        "seconds": round(time.monotonic() - start, 3),
    }
    if best.enclosures is not None:
        computation["coordinates"] = best.enclosures.coordinates
    return make_certificate(candidate, best.outcome, computation, best.enclosures, form)


def _forms(candidate: Candidate, limits: Limits) -> list[Candidate | None]:
    """What to try, in this order: level forms of the candidate, or `None` for the candidate as it is."""
    form = None if limits.level == "coordinates" else level_form(candidate)
    if form is None:
        return [None]
    if limits.level == "integral":
        return [form]
    # The point that the level form finds has to be known to the narrowest radius of the candidate's own box.
    value, slope = accuracy_bits(candidate, limits.digits)
    wide = level_spread(candidate, form) > _MOST_SPREAD
    return [None, form] if wide or value > slope + _MOST_BITS_ACROSS else [form, None]


def _escalate(
    origin: Candidate,
    form: Candidate | None,
    limits: Limits,
    start: float,
    progress: Progress | None,
    integrate: Integrator,
) -> tuple[_Attempt, int]:
    """The best attempt, with more precision as long as that helps, and the number of attempts."""
    candidate = form or origin
    deadline = None if limits.timeout is None else start + limits.timeout
    attempts = 0
    best: _Attempt | None = None
    previous: _Attempt | None = None

    def report(fraction: float) -> None:
        if deadline is not None and time.monotonic() > deadline:
            raise _OutOfTime
        if progress is not None:
            progress(fraction, f"{precision} bits" if attempts == 1 else f"{precision} bits, attempt {attempts}")

    accuracy = accuracy_bits(candidate, limits.digits)
    precision = min(first_precision(candidate, limits.digits), limits.max_precision)
    while True:
        attempts += 1
        try:
            report(0.0)
            attempt = _attempt(candidate, precision, accuracy, report, integrate)
            if form is not None:
                attempt = replace(attempt, outcome=for_origin(origin, attempt.outcome, precision))
        except _OutOfTime:
            best = _stopped(best, precision, limits)
            break
        more = _more_precision(candidate, attempt, previous, limits)
        best, previous = _better(best, attempt), attempt
        if more is None:
            break
        if more <= precision:
            best = _at_the_limit(best, limits)
            break
        precision = more
    assert best is not None
    return best, attempts


def _better(old: _Attempt | None, new: _Attempt) -> _Attempt:
    keep_old = old is not None and isinstance(old.outcome, Proved) and isinstance(new.outcome, NotProved)
    return old if keep_old and old is not None else new


def _stopped(best: _Attempt | None, precision: int, limits: Limits) -> _Attempt:
    """What is left when time is up: a proof at hand stands, only its further digits are given up."""
    remedy = "give --row-timeout more seconds"
    message = f"the time limit of {limits.timeout:g} s has passed at {precision} bits"
    if best is None:
        return _Attempt(NotProved(Reason("time", message, remedy)), precision, 0, 0)
    if isinstance(best.outcome, Proved):
        return best
    message += f"; before that, {best.outcome.reason.message}"
    return replace(best, outcome=replace(best.outcome, reason=Reason("time", message, remedy)))


def _more_precision(candidate: Candidate, attempt: _Attempt, previous: _Attempt | None, limits: Limits) -> int | None:
    """Bits for the next attempt, at most the limit; `None` if there is no need or no hope."""
    precision, outcome = attempt.precision, attempt.outcome
    if isinstance(outcome, Proved):
        missing = limits.digits - count_certain_digits(outcome.results.parameter)
        wanted = precision + ceil(missing * _BITS_PER_DIGIT) + 16
        tried = previous is not None and isinstance(previous.outcome, Proved)
        return wanted if missing > 0 and not tried and wanted <= limits.max_precision else None
    if not outcome.reason.needs_precision:
        return None
    if outcome.reason.enough_precision is not None:
        return min(max(outcome.reason.enough_precision, precision + 8), limits.max_precision)
    enclosures = _enclosures(outcome)
    if not enclosures:
        # Nothing says how far away success is, so each attempt costs more than all before it.
        return min(2 * precision, limits.max_precision)
    if previous is not None and not _narrower(enclosures, previous.outcome, outcome.reason.condition):
        return None
    short = _bits_to_fit(candidate, enclosures)
    return min(precision + (max(32, precision // 4) if short is None else short * 6 // 5), limits.max_precision)


def _bits_to_fit(candidate: Candidate, enclosures: Mapping[str, arb]) -> int | None:
    """Bits by which the images of interval Newton operators are too wide for the box, and a few more."""
    images = {"p_0(P_1)": 0, "p_1": 1, "p_2": 2}
    ratios = [
        enclosures[name].abs_upper() / enclose(candidate.radii[j]) for name, j in images.items() if name in enclosures
    ]
    widest = max((float(ratio.log_base(2).mid()) for ratio in ratios if ratio.is_finite()), default=0.0)
    return ceil(widest) + _SPARE if widest > 0.0 and isfinite(widest) else None


def _narrower(enclosures: dict[str, arb], previous: Outcome[BifurcationResults], condition: str) -> bool:
    """Whether the last attempt made an enclosure of the failing condition half as wide.

    True if the attempt before it did not fail at the same condition.
    """
    if isinstance(previous, Proved) or previous.reason.condition != condition:
        return True
    before = _enclosures(previous)
    return not before or any(is_below(2 * enclosures[n].rad(), before[n].rad()) for n in before if n in enclosures)


def _enclosures(outcome: NotProved) -> dict[str, arb]:
    condition = outcome.reason.condition
    found = [hypothesis.enclosures for hypothesis in outcome.hypotheses if hypothesis.name == condition]
    return {name: ball for name, ball in found[-1].items() if ball.is_finite()} if found else {}


def _at_the_limit(attempt: _Attempt, limits: Limits) -> _Attempt:
    outcome = attempt.outcome
    if isinstance(outcome, Proved):
        return attempt
    reason = replace(
        outcome.reason,
        message=f"{outcome.reason.message} (at the limit of {limits.max_precision} bits)",
        remedy=f"{outcome.reason.remedy}; or give --max-precision more",
    )
    return replace(attempt, outcome=replace(outcome, reason=reason))


def _attempt(
    candidate: Candidate,
    precision: int,
    accuracy: tuple[int, int],
    report: Callable[[float], None],
    integrate: Integrator,
) -> _Attempt:
    checklist = Checklist()

    def refused(reason: Reason) -> _Attempt:
        return _Attempt(NotProved(reason, tuple(checklist.hypotheses)), precision, 0, 0)

    theorem = theorem_of(candidate)
    if isinstance(theorem, Reason):
        return refused(theorem)
    stage = "exact checks"
    with guarded(precision):
        try:
            check_exactly(checklist, candidate)
            stage = "integration"
            # Bounds that overflow are infinite, and what is infinite proves nothing.
            with np.errstate(all="ignore"):
                found = integrate(candidate, IntegratorSettings(precision, accuracy=accuracy), report)
            stage = "evaluation"
            outcome = prove(candidate, checklist, found.iterates, found.first_integral, found.return_times)
        except _OutOfTime:
            raise
        except NotEstablishedError as error:
            return refused(error.reason)
        except Exception as error:
            return refused(broken_off(stage, error))
        return _Attempt(outcome, precision, found.order, found.steps, found)


def for_origin(origin: Candidate, outcome: Outcome[BifurcationResults], precision: int) -> Outcome[BifurcationResults]:
    """The outcome for a candidate whose level form was checked: that it holds for its own box has to be shown too."""
    if isinstance(outcome, NotProved):
        return outcome
    form = level_form(origin)
    if form is None:
        reason = Reason("level-box", "the candidate has no level form", "verify it with --level coordinates")
        return NotProved(reason, outcome.hypotheses)
    checklist = Checklist()
    checklist.hypotheses += outcome.hypotheses
    with guarded(precision):
        try:
            check_own_box(checklist, origin, form, outcome.results.point)
        except NotEstablishedError as error:
            reason, missing = error.reason, _missing_bits(origin, outcome.results.point)
            if reason.condition == "candidate-box" and missing is not None:
                reason = replace(reason, needs_precision=True, enough_precision=precision + missing)
            return NotProved(reason, tuple(checklist.hypotheses))
    return Proved(in_own_box(outcome.theorem), outcome.results, tuple(checklist.hypotheses))


def _missing_bits(origin: Candidate, point: Mapping[str, arb]) -> int | None:
    """Bits until the enclosure of a point is narrow compared with the box; `None` if it is so, or lies outside."""
    where = list(zip(coordinates_in_box(origin, point), origin.radii, strict=True))
    if not all(ball.is_finite() for ball, _ in where) or any(is_outside(ball, radius) for ball, radius in where):
        return None
    floor = arb(2) ** (-2 * _NARROW_BITS)
    widths = [float((ball.rad() / enclose(radius) + floor).log_base(2).mid()) for ball, radius in where]
    missing = ceil(max(widths)) + _NARROW_BITS
    return missing * 6 // 5 + _SPARE if missing > 0 else None
