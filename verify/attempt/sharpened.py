"""The counsel: what to try about a claim that is not proved, and whether more precision is tried.

It is not where a condition would fail even if nothing were rounded.
"""

from __future__ import annotations

from dataclasses import replace

from flint import arb

from orbitproof.verify.attempt.remedies import advice_on
from orbitproof.verify.bifurcation import Failure, Problem
from orbitproof.verify.evidence import DerivativeTable, NotEstablishedError, Reason
from orbitproof.verify.newton import BoxFunction

_SAFETY = 2**10
"""An enclosure over the box may owe so many times more to rounding than the one at its centre."""


def counsel(failure: Failure) -> Reason:
    """See `bifurcation.counsel`."""
    advice = advice_on(failure.claim.kind, failure.problem.radii, failure.hypotheses)
    reason = failure.reason if advice is None else replace(failure.reason, remedy=advice.words)
    return for_want_of_size(reason) if fails_sharpened(failure) else reason


def fails_sharpened(failure: Failure) -> bool:
    """Whether what failed for want of precision stays undecided however precisely the derivatives are enclosed."""
    reason = failure.reason
    if not reason.needs_precision:
        return False
    try:
        failure.check(sharpened(failure.problem))
    except NotEstablishedError as error:
        return error.reason.condition == reason.condition and error.reason.needs_precision
    except ArithmeticError:
        return False
    return False


def for_want_of_size(reason: Reason) -> Reason:
    """The reason, of a condition that `fails_sharpened`."""
    why = "that owes nothing to rounding as far as the enclosures show, so more precision is not tried"
    return replace(reason, message=f"{reason.message}; {why}", needs_precision=False)


def sharpened(problem: Problem) -> Problem:
    """The problem as more precision may make it at best: what is wide because the box is wide stays so."""
    integral = problem.first_integral
    return replace(
        problem,
        iterates=tuple(tuple(_function(component) for component in components) for components in problem.iterates),
        first_integral=None if integral is None else _function(integral),
    )


def _function(function: BoxFunction) -> BoxFunction:
    table = function.table
    centre = {index: arb(ball.mid()) for index, ball in table.centre.items()}
    box = {index: _over_the_box(ball, table.centre[index]) for index, ball in table.box.items()}
    return BoxFunction(DerivativeTable(box, centre))


def _over_the_box(ball: arb, centre: arb) -> arb:
    """What the box alone makes of the value at the centre, or that value if rounding may account for the width."""
    width = arb(ball.rad()) - arb(centre.rad()) * _SAFETY
    return arb(ball.mid(), width.upper()) if width > 0 else arb(centre.mid())
