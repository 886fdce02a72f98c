"""Curves of equilibria (section 37)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from orbitproof.shared.claims import EQUILIBRIUM_CURVES, BirthAtlas, EquilibriumAtlas
from orbitproof.shared.formats import Piece, atlas_to_json
from orbitproof.verify.branches.document import PeriodicCurveStatement
from orbitproof.verify.branches.kinds import BranchKind
from orbitproof.verify.branches.recheck import OF_ANY_BRANCH
from orbitproof.verify.branches.whole_as_json import whole_to_json
from orbitproof.verify.certificate import stated_functions
from orbitproof.verify.certificate.document import Names
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.curve import Conclusion, IntervalResult
from orbitproof.verify.equilibrium_curve import (
    EquilibriumCurveTheorem,
    EquilibriumLimits,
    ProvedEquilibriumCurve,
    conclude_equilibria,
    prove_equilibrium_piece,
)
from orbitproof.verify.evidence import Proved
from orbitproof.verify.words.equilibrium_curve import equilibrium_curve_in_full, equilibrium_curve_in_words


def statement_of(atlas: EquilibriumAtlas | BirthAtlas, results: Sequence[Any]) -> PeriodicCurveStatement:
    """The claim in full, but for the theorem."""
    system = atlas.system
    return PeriodicCurveStatement(
        claim=atlas_to_json(atlas, provenance=False),
        vector_field=system.program.text(),
        first_integral=None,
        functions=stated_functions(system),
        names=Names(system=system.title, first_integral=None),
    )


def told(found: Conclusion[ProvedEquilibriumCurve]) -> dict[str, Any]:
    """A conclusion as JSON, with its theorem in words."""
    if not isinstance(found.outcome, Proved):
        return whole_to_json(found, "", None)
    theorem, known = cast(EquilibriumCurveTheorem, found.outcome.theorem), found.outcome.results
    more = {"folds": [to_json(fold) for fold in known.folds], "sides": [to_json(part) for part in known.sides]}
    return whole_to_json(found, equilibrium_curve_in_words(theorem, known), known.chain, **more)


KIND = BranchKind(
    names=EQUILIBRIUM_CURVES,
    titles={"equilibrium-arc": "A curve of equilibria", "equilibrium-loop": "A closed curve of equilibria"},
    said=lambda k, kind: "equilibria",
    **OF_ANY_BRANCH,
    theorem=EquilibriumCurveTheorem,
    limits=EquilibriumLimits,
    about="equilibria",
    results={Piece: IntervalResult},
    coordinates=lambda atlas: atlas.coordinates,
    setting=lambda atlas: atlas.claim.setting,
    in_question=lambda atlas: {"claim": to_json(atlas.claim)},
    prove=lambda *asked: prove_equilibrium_piece(*asked).stored,
    more_at_next={"top": 1},
    statement=statement_of,
    conclude=lambda atlas, results, *_: told(conclude_equilibria(atlas, results)),
    in_full=equilibrium_curve_in_full,
    time="time",
)
