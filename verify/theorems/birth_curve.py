"""Curves of periodic orbits from the equilibrium at which they are born on (section 38)."""

from __future__ import annotations

from typing import Any, cast

from orbitproof.shared.claims import BIRTH_CURVES
from orbitproof.shared.formats import Piece
from orbitproof.verify.birth_curve import (
    BirthCurveTheorem,
    BirthLimits,
    ProvedBirthCurve,
    conclude_births,
    prove_birth_curve_piece,
)
from orbitproof.verify.branches.kinds import BranchKind
from orbitproof.verify.branches.recheck import OF_ANY_BRANCH
from orbitproof.verify.branches.whole_as_json import whole_to_json
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.curve import Conclusion, IntervalResult
from orbitproof.verify.evidence import Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.theorems.equilibrium_curve import statement_of
from orbitproof.verify.words.birth_curve import birth_curve_in_words
from orbitproof.verify.words.equilibrium_curve import equilibrium_curve_in_full


def told(found: Conclusion[ProvedBirthCurve]) -> dict[str, Any]:
    """A conclusion as JSON, with its theorem in words."""
    if not isinstance(found.outcome, Proved):
        return whole_to_json(found, "", None)
    theorem, known = cast(BirthCurveTheorem, found.outcome.theorem), found.outcome.results
    more = {
        **({"period": to_json(known.period)} if known.period.is_finite() else {}),
        "turns": [to_json(turn) for turn in known.turns],
        "frequency": to_json(known.frequency),
        "eigenvalues": to_json(known.eigenvalues),
    }
    if known.pair_at_end is not None:
        omega, others = known.pair_at_end
        more |= {"frequency_at_end": to_json(omega), "eigenvalues_at_end": to_json(others)}
    return whole_to_json(found, birth_curve_in_words(theorem, known), known.chain, **more)


KIND = BranchKind(
    names=BIRTH_CURVES,
    titles={
        "birth-arc": "A curve of periodic orbits from their birth on",
        "birth-to-birth": "A curve of periodic orbits from one birth to another",
    },
    said=lambda k, kind: "orbits from their birth on",
    **OF_ANY_BRANCH,
    theorem=BirthCurveTheorem,
    limits=BirthLimits,
    about="orbits from their birth on",
    results={Piece: IntervalResult},
    coordinates=lambda atlas: atlas.coordinates,
    setting=lambda atlas: atlas.claim.setting,
    in_question=lambda atlas: {"claim": to_json(atlas.claim)},
    prove=lambda atlas, piece, interval, limits, stepped: (
        prove_birth_curve_piece(atlas, piece, interval, ORACLE, limits, stepped).stored
    ),
    more_at_next={"top": 1},
    statement=statement_of,
    conclude=lambda atlas, results, *_: told(conclude_births(atlas, results)),
    in_full=equilibrium_curve_in_full,
    time="period",
)
