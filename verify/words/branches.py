"""The theorem about a whole curve in words, with its list or without (sections 15.9 and 18.7); any branch in full."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.formats import Atlas
from orbitproof.verify.curve import Bifurcation, Conclusion, CurveTheorem, ProvedCurve
from orbitproof.verify.evidence import Proved
from orbitproof.verify.lasting import LastingTheorem, ProvedLasting
from orbitproof.verify.stability import ListConclusion, ListTheorem, ProvedList
from orbitproof.verify.words.complete_list import list_in_words
from orbitproof.verify.words.curve import bifurcations_in_words, curve_in_words
from orbitproof.verify.words.formulas import setting
from orbitproof.verify.words.lasting import lasting_in_words

CurveConclusion = Conclusion[ProvedCurve] | ListConclusion


def conclusion_in_words(conclusion: CurveConclusion) -> str:
    """What pieces prove together; empty if that is nothing."""
    outcome = conclusion.outcome
    if not isinstance(outcome, Proved):
        return ""
    match outcome.theorem, outcome.results, conclusion:
        case ListTheorem() as theorem, ProvedList() as known, ListConclusion():
            whole = _with_bifurcations(theorem.curve, known.curve, conclusion.curve.bifurcations)
            words = f"{whole}\n{list_in_words(theorem, known)}"
            match theorem, known:
                case LastingTheorem(), ProvedLasting():
                    return f"{words}\n{lasting_in_words(theorem, known)}"
            return words
        case CurveTheorem() as theorem, ProvedCurve() as curve, Conclusion():
            return _with_bifurcations(theorem, curve, conclusion.bifurcations)
    raise TypeError(f"{type(outcome.theorem).__name__}: a theorem about no curve")


def _with_bifurcations(theorem: CurveTheorem, curve: ProvedCurve, bifurcations: Sequence[Bifurcation]) -> str:
    texts = (curve_in_words(theorem, curve), bifurcations_in_words(theorem.atlas, bifurcations))
    return "\n".join(text for text in texts if text)


def branch_in_full(atlas: Atlas, statement: str) -> str:
    """The statement so that it stands alone: the system in formulas before it (section 10.4)."""
    words = setting(atlas.system, atlas.parameters, atlas.claim.symmetry, atlas.claim.crossings)
    return "\n".join([*words, "Theorem.", statement])
