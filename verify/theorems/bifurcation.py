"""Bifurcations (sections 8, 9 and 12)."""

from __future__ import annotations

from functools import partial

from orbitproof.shared.claims import FOLD, KINDS, Candidate
from orbitproof.verify import bifurcation
from orbitproof.verify.attempt import counsel
from orbitproof.verify.attempt.precision import first_precision, missing_of_parameter, steps_of_centre
from orbitproof.verify.bifurcation import BifurcationResults
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import with_reversor
from orbitproof.verify.evidence import Checklist, Outcome
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import EarlyEnd, Enclosures, IntegratorSettings, enclose_iterates
from orbitproof.verify.words.bifurcation import bifurcation_in_words
from orbitproof.verify.words.row_in_full import bifurcation_in_full

_WORDS = {
    "symmetry_breaking": "symmetry breaking",
    "fold": "fold",
    "period_tupling": "period tupling",
    "touch_and_go": "touch-and-go",
}


def _said(k: int, kind: str) -> str:
    word = "period doubling" if (k, kind) == (2, "period_tupling") else _WORDS.get(kind, kind)
    return word if k == 1 else f"{word} (k = {k})"


def _first_precision(candidate: Candidate, digits: int) -> int:
    least = first_precision(candidate, digits)
    return least if candidate.k == 1 else first_precision(candidate, digits, steps_of_centre(candidate, least))


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> Enclosures:
    decide = partial(bifurcation.check_half_returns, counsel=counsel)
    return enclose_iterates(candidate, settings, ORACLE, progress, EarlyEnd(settings.accuracy, decide))


def _prove(candidate: Candidate, checklist: Checklist, found: Enclosures | None) -> Outcome[BifurcationResults]:
    if found is None:
        return bifurcation.prove(candidate, checklist, (), None)
    tables = (found.iterates, found.first_integral, found.return_times)
    return bifurcation.prove(candidate, checklist, *tables, counsel)


_IN_LEGENDS = {
    "symmetry_breaking": "symmetry breaking",
    "fold": "fold",
    "period_tupling": "period tupling",
    "touch_and_go": "touch-and-go",
}


def _legend(k: int, kind: str) -> str:
    return f"$k={k}$, {'period doubling' if (k, kind) == (2, 'period_tupling') else _IN_LEGENDS[kind]}"


KIND = BoxKind(
    names=KINDS,
    enclosures=Enclosures,
    results=BifurcationResults,
    statement=with_reversor,
    theorem_of=bifurcation.theorem_of,
    level_form=bifurcation.level_form,
    check_own_box=bifurcation.check_own_box,
    first_precision=_first_precision,
    check_exactly=bifurcation.check_exactly,
    enclose=_enclose,
    prove=_prove,
    titles={
        "symmetry_breaking": "Symmetry breaking",
        "fold": "Fold",
        "period_tupling": "Period {k}-tupling",
        "touch_and_go": "Touch-and-go of order {k}",
    },
    said=_said,
    legend=_legend,
    picture="box",
    on_side=lambda kind: "two orbits" if kind == FOLD else "new orbits",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
        "normal_form": found.normal_form,
    },
    missing=missing_of_parameter,
    in_words=bifurcation_in_words,
    in_full=bifurcation_in_full,
)
