"""Which of the theorems about bifurcations of symmetric orbits a claim is about (section 9).

Each stands in a module of its own, which refuses claims that it says nothing of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation import fold, proved_bifurcation
from orbitproof.verify.bifurcation.counsel import Counsel, silent
from orbitproof.verify.bifurcation.fold import FoldTheorem
from orbitproof.verify.bifurcation.proved_bifurcation import BifurcationResults, BifurcationTheorem
from orbitproof.verify.bifurcation.refusals import prove_by
from orbitproof.verify.evidence import Checklist, DerivativeTable, Outcome, Reason

TheoremInBox = BifurcationTheorem | FoldTheorem


def theorem_of(candidate: Candidate, form: Candidate | None = None) -> TheoremInBox | Reason:
    """The theorem that a candidate claims, or why none of those that can be checked applies.

    `form` is its level form, if that is what is checked.
    """
    if form is None:
        return fold.theorem_of(candidate) if candidate.is_fold else proved_bifurcation.theorem_of(candidate)
    theorem = theorem_of(form)
    return theorem if isinstance(theorem, Reason) else replace(theorem, in_own_box=True)


def prove(
    candidate: Candidate,
    checklist: Checklist,
    iterates: Sequence[Sequence[DerivativeTable]],
    first_integral: DerivativeTable | None,
    return_times: Sequence[arb] = (),
    counsel: Counsel = silent,
) -> Outcome[BifurcationResults]:
    """Check the theorem that a candidate claims; `counsel` is asked about a claim that is not proved nor excluded."""
    theory = fold if candidate.is_fold else proved_bifurcation
    return prove_by(theory, candidate, checklist, iterates, first_integral, return_times, counsel)
