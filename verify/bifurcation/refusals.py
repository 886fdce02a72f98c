"""Claims that are not proved: refused for good, or told as a counsel tells them (section 8.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation.conditions import Problem
from orbitproof.verify.bifurcation.counsel import Counsel, Failure, advised, silent
from orbitproof.verify.bifurcation.proved_bifurcation import BifurcationResults, Tell
from orbitproof.verify.evidence import Checklist, DerivativeTable, Outcome, Reason
from orbitproof.verify.newton import is_regular

EXCLUDED = "no R-symmetric orbits of this multiplicity branch off or merge in the box: "
"""What is said of a claim that is refused for good (section 8.2); what shows it comes after."""

REMEDY = "are k and the kind right, and is the centre at the bifurcation point?"


class Theory(Protocol):
    """A theorem about a bifurcation in a box: the module that proves it, as `proved_bifurcation`."""

    def check(self, candidate: Candidate, checklist: Checklist, problem: Problem) -> BifurcationResults:
        """The conditions, one by one; raises `NotEstablishedError` for the first that is not shown."""

    def prove(
        self,
        candidate: Candidate,
        checklist: Checklist,
        iterates: Sequence[Sequence[DerivativeTable]],
        first_integral: DerivativeTable | None,
        return_times: Sequence[arb],
        tell: Tell,
    ) -> Outcome[BifurcationResults]:
        """Check the theorem that a candidate claims."""


def excludes_branches(candidate: Candidate, problem: Problem) -> bool:
    """Whether no point of the box is a bifurcation of this k and kind, by section 8.2.

    D_(p_1, p_2) pi_q P^k is singular at all of them, but at folds only if p_0 is the parameter.
    """
    if candidate.is_fold and problem.first_integral is not None:
        return False
    return is_regular([component.gradient(problem.box, 1) for component in problem.iterates[-1]])


def prove_by(
    theory: Theory,
    candidate: Candidate,
    checklist: Checklist,
    iterates: Sequence[Sequence[DerivativeTable]],
    first_integral: DerivativeTable | None,
    return_times: Sequence[arb] = (),
    counsel: Counsel = silent,
) -> Outcome[BifurcationResults]:
    """As `theory.prove`; `counsel` is asked about a claim that is not proved and not excluded."""

    def told(problem: Problem, reason: Reason) -> Reason:
        if reason.needs_precision and excludes_branches(candidate, problem):
            matrix = f"D_(p_1, p_2) pi_q P^{candidate.k}"
            why = f"every matrix in the interval hull of {matrix} over it is regular (section 8.2)"
            message = f"{reason.message}; and {EXCLUDED}{why}"
            return replace(reason, message=message, remedy=REMEDY, needs_precision=False, excluded=True)
        hypotheses = tuple(checklist.hypotheses)
        failure = Failure(
            candidate, problem, reason, hypotheses, lambda other: theory.check(candidate, Checklist(), other)
        )
        return advised(failure, counsel)

    return theory.prove(candidate, checklist, iterates, first_integral, return_times, told)
