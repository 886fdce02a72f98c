"""The theorem about a whole branch in words: a curve, a curve with its list, a surface (sections 15.9, 17.4, 18.7)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.formats import AnyAtlas, Atlas
from orbitproof.verify.curve import Bifurcation, Conclusion, CurveTheorem, ProvedCurve
from orbitproof.verify.evidence import Proved
from orbitproof.verify.lasting import LastingTheorem, ProvedLasting
from orbitproof.verify.periodic_curve import PeriodicCurveTheorem, ProvedPeriodicCurve
from orbitproof.verify.stability import ListConclusion, ListTheorem, ProvedList
from orbitproof.verify.surface import ProvedSurface, SurfaceTheorem
from orbitproof.verify.words.complete_list import list_in_words
from orbitproof.verify.words.curve import bifurcations_in_words, curve_in_words
from orbitproof.verify.words.formulas import setting
from orbitproof.verify.words.lasting import lasting_in_words
from orbitproof.verify.words.periodic_curve import periodic_curve_in_full, periodic_curve_in_words
from orbitproof.verify.words.surface import surface_in_words

BranchConclusion = (
    Conclusion[ProvedCurve] | Conclusion[ProvedSurface] | Conclusion[ProvedPeriodicCurve] | ListConclusion
)


def conclusion_in_words(conclusion: BranchConclusion) -> str:
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
        case SurfaceTheorem() as theorem, ProvedSurface() as surface, _:
            return surface_in_words(theorem, surface)
        case PeriodicCurveTheorem() as theorem, ProvedPeriodicCurve() as periodic, _:
            return periodic_curve_in_words(theorem, periodic)
    raise TypeError(f"{type(outcome.theorem).__name__}: a theorem about no branch")


def _with_bifurcations(theorem: CurveTheorem, curve: ProvedCurve, bifurcations: Sequence[Bifurcation]) -> str:
    texts = (curve_in_words(theorem, curve), bifurcations_in_words(theorem.atlas, bifurcations))
    return "\n".join(text for text in texts if text)


def branch_in_full(atlas: AnyAtlas, statement: str) -> str:
    """The statement so that it stands alone: the system in formulas before it (section 10.4)."""
    if not isinstance(atlas, Atlas):
        return periodic_curve_in_full(atlas, statement)
    words = setting(atlas.system, atlas.parameters, atlas.claim.symmetry, atlas.claim.crossings)
    return "\n".join([*words, "Theorem.", statement])
