"""Certification of one candidate: symmetries, frames, integration, conditions; more precision if it helps.

The first precision follows from the radii; whatever fails for want of precision is tried again with
more, up to a limit. No exception leaves `certify`: what breaks off proves nothing, for whatever reason.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import cast

import numpy as np

from orbitproof.shared.formats import BoxClaim, Candidate
from orbitproof.verify.attempt.precision import (
    Limits,
    Verdict,
    accuracy_bits,
    missing_bits,
    more_precision,
)
from orbitproof.verify.bifurcation import level_spread
from orbitproof.verify.certificate.certificate import Certificate, make_certificate
from orbitproof.verify.certificate.document import Computation
from orbitproof.verify.certificate.kinds import Found, check_exactly, enclose, kind_of, level_form, prove, theorem_of
from orbitproof.verify.certificate.own_box import broken_off, for_origin
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Proved,
    Reason,
    guarded,
    spared,
)
from orbitproof.verify.poincare import IntegratorSettings

Integrator = Callable[[BoxClaim, IntegratorSettings, Callable[[float], None] | None], Found]
Progress = Callable[[float, str], None]

_MORE = "give `max_precision` more"

_MOST_SPREAD = 8
"""The level form is tried first if its P_0 is at most so many times as long as the old one in terms of the level."""

_MOST_BITS_ACROSS = 24
"""It is not if P_2 is narrower than P_0 by more bits than that."""

_AT_THE_PARAMETER = (
    *("level-box", "candidate-box", "C2", "C3", "C4", "HC2", "HC3", "HC4", "point"),
    *("curve", "extremum", "dH/dp_0", "h_fp'", "h_b'", "h_b''", "G_11", "G_01", "G_111"),
)
"""Hypotheses that depend on what the bifurcation parameter is; the others fail in both forms."""


class _OutOfTime(Exception):
    """The time limit of the row has passed."""


@dataclass(frozen=True)
class _Attempt:
    outcome: Verdict
    precision: int
    order: int
    steps: int
    enclosures: Found | None = None


def certify(
    candidate: BoxClaim,
    limits: Limits | None = None,
    progress: Progress | None = None,
    integrate: Integrator = enclose,
) -> Certificate:
    """The certificate of a candidate, proved or not.

    `progress` is called with the fraction of the current attempt and a word on what is being done.
    An exception of any kind, a defect of this program included, gives "not proved" with that reason.
    """
    limits = Limits() if limits is None else limits
    start = time.process_time()
    try:
        return _certify(candidate, limits, start, progress, integrate)
    except Exception as error:
        return not_proved(candidate, broken_off("verification", error), time.process_time() - start)


def not_proved(candidate: BoxClaim, reason: Reason, seconds: float) -> Certificate:
    """The certificate of a candidate of which nothing but a reason is known."""
    return make_certificate(candidate, NotProved(reason), Computation(0, 0, 0, 1, round(seconds, 3)))


def _certify(
    candidate: BoxClaim, limits: Limits, start: float, progress: Progress | None, integrate: Integrator
) -> Certificate:
    tried: list[tuple[Candidate | None, _Attempt]] = []
    attempts = 0
    for form in _forms(candidate, limits):
        best, more = _escalate(candidate, form, limits, start, progress, integrate)
        attempts += more
        tried.append((form, best))
        if isinstance(best.outcome, Proved):
            break
        if not _another_form_may_do(best.outcome.reason):
            break
    form, best = tried[-1] if isinstance(tried[-1][1].outcome, Proved) else tried[0]
    coordinates = None if best.enclosures is None else best.enclosures.coordinates
    seconds = round(time.process_time() - start, 3)
    computation = Computation(best.precision, best.order, best.steps, attempts, seconds, coordinates)
    return make_certificate(candidate, best.outcome, computation, best.enclosures, form)


def _another_form_may_do(reason: Reason) -> bool:
    # The box of a level form contains the candidate's: what is excluded there is excluded here, and a point that is
    # known well enough to reach over the edge of the candidate's box does so here as well.
    on_the_edge = reason.condition == "candidate-box" and not reason.needs_precision
    return reason.condition in _AT_THE_PARAMETER and not (reason.excluded or on_the_edge)


def _forms(candidate: BoxClaim, limits: Limits) -> list[Candidate | None]:
    """What to try, in this order: level forms of the candidate, or `None` for the candidate as it is."""
    form = None if limits.level == "coordinates" else level_form(candidate)
    if form is None:
        return [None]
    if limits.level == "integral":
        return [form]
    # The point that the level form finds has to be known to the narrowest radius of the candidate's own box.
    value, slope = accuracy_bits(candidate, limits.digits)
    wide = level_spread(cast(Candidate, candidate), form) > _MOST_SPREAD
    return [None, form] if wide or value > slope + _MOST_BITS_ACROSS else [form, None]


def _escalate(
    origin: BoxClaim,
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
    previous: Verdict | None = None

    def report(fraction: float) -> None:
        if deadline is not None and time.process_time() > deadline:
            raise _OutOfTime
        if progress is not None:
            progress(fraction, f"{precision} bits" if attempts == 1 else f"{precision} bits, attempt {attempts}")

    accuracy = accuracy_bits(candidate, limits.digits)
    missing = kind_of(candidate).missing
    precision = min(kind_of(candidate).first_precision(candidate, limits.digits), limits.max_precision)
    while True:
        attempts += 1
        try:
            report(0.0)
            attempt = _attempt(candidate, precision, accuracy, report, integrate)
            if form is not None:
                attempt = replace(attempt, outcome=_for_origin(origin, attempt.outcome, precision))
        except _OutOfTime:
            best = _stopped(best, precision, limits)
            break
        more = more_precision(candidate, attempt.precision, attempt.outcome, previous, limits, missing)
        best, previous = _better(best, attempt), attempt.outcome
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
    remedy = "give `timeout` more seconds"
    message = f"the time limit of {limits.timeout:g} s has passed at {precision} bits"
    if best is None:
        return _Attempt(NotProved(Reason("time", message, remedy)), precision, 0, 0)
    if isinstance(best.outcome, Proved):
        return best
    message += f"; before that, {best.outcome.reason.message}"
    return replace(best, outcome=replace(best.outcome, reason=Reason("time", message, remedy)))


def _at_the_limit(attempt: _Attempt, limits: Limits) -> _Attempt:
    outcome = attempt.outcome
    if isinstance(outcome, Proved):
        return attempt
    reason = replace(
        outcome.reason,
        message=f"{outcome.reason.message} (at the limit of {limits.max_precision} bits)",
        remedy=outcome.reason.remedy if _MORE in outcome.reason.remedy else f"{outcome.reason.remedy}; or {_MORE}",
    )
    return replace(attempt, outcome=replace(outcome, reason=reason))


def _attempt(
    candidate: BoxClaim,
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
            # What is concluded is concluded from what is stored.
            found = spared(found, negligible=Fraction(1, 2**precision))
            stage = "evaluation"
            outcome = prove(candidate, checklist, found)
        except _OutOfTime:
            raise
        except NotEstablishedError as error:
            return refused(error.reason)
        except Exception as error:
            return refused(broken_off(stage, error))
        return _Attempt(outcome, precision, found.order, found.steps, found)


def _for_origin(origin: BoxClaim, outcome: Verdict, precision: int) -> Verdict:
    """The outcome for the candidate's own box; where the box is left for want of bits, with how many are missing."""
    own = for_origin(origin, outcome, precision)
    if not isinstance(own, NotProved) or not isinstance(outcome, Proved):
        return own
    if own.reason.condition == "candidate-box":
        with guarded(precision):
            missing = missing_bits(cast(Candidate, origin), outcome.results.point)
        if missing is not None:
            reason = replace(own.reason, needs_precision=True, enough_precision=precision + missing)
            return replace(own, reason=reason)
    return own
