"""Curves of periodic orbits of which no symmetry is used (section 26)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

from orbitproof.shared.claims import PERIODIC_CURVES
from orbitproof.shared.formats import PeriodicAtlas, Piece, atlas_to_json
from orbitproof.verify.branches.document import PeriodicCurveStatement
from orbitproof.verify.branches.kinds import BranchKind
from orbitproof.verify.branches.recheck import OF_ANY_BRANCH
from orbitproof.verify.branches.whole_as_json import whole_to_json
from orbitproof.verify.certificate import stated_functions
from orbitproof.verify.certificate.document import Names
from orbitproof.verify.certificate.levels import Finding
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.curve import Conclusion
from orbitproof.verify.evidence import Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_curve import (
    PeriodicCurveTheorem,
    PeriodicIntervalResult,
    PeriodicLimits,
    ProvedPeriodicCurve,
    conclude_periodic,
    prove_periodic_piece,
    unconfirmed_multipliers,
)
from orbitproof.verify.words.periodic_curve import periodic_curve_in_full, periodic_curve_in_words


def _statement(atlas: PeriodicAtlas, results: Sequence[Any]) -> PeriodicCurveStatement:
    """The claim in full, but for the theorem; the first integral only if it is used."""
    system = atlas.system
    integral = system.first_integral_program if atlas.claim.uses_integral else None
    return PeriodicCurveStatement(
        claim=atlas_to_json(atlas, provenance=False),
        vector_field=system.program.text(),
        first_integral=None if integral is None else integral.text(),
        functions=stated_functions(system),
        names=Names(system=system.title, first_integral=None if integral is None else system.first_integral_name),
    )


def told(found: Conclusion[ProvedPeriodicCurve]) -> dict[str, Any]:
    """A conclusion as JSON, with its theorem in words."""
    if not isinstance(found.outcome, Proved):
        return whole_to_json(found, "", None)
    theorem, known = cast(PeriodicCurveTheorem, found.outcome.theorem), found.outcome.results
    more = {
        **({"period": to_json(known.period)} if known.period.is_finite() else {}),
        "turns": [to_json(turn) for turn in known.turns],
        **({"multipliers": [to_json(part) for part in known.multipliers]} if known.multipliers else {}),
    }
    return whole_to_json(found, periodic_curve_in_words(theorem, known), known.chain, **more)


def _unconfirmed(stored: Any, fresh: Any, place: str) -> Iterator[Finding]:
    yield from (Finding(place, text) for text in unconfirmed_multipliers(stored, fresh))


KIND = BranchKind(
    names=PERIODIC_CURVES,
    titles={"periodic-arc": "A curve of periodic orbits", "periodic-loop": "A closed curve of periodic orbits"},
    said=lambda k, kind: "orbits without symmetry",
    **OF_ANY_BRANCH,
    theorem=PeriodicCurveTheorem,
    limits=PeriodicLimits,
    about="orbits without symmetry",
    results={Piece: PeriodicIntervalResult},
    coordinates=lambda atlas: atlas.coordinates,
    setting=lambda atlas: atlas.claim.setting,
    in_question=lambda atlas: {"claim": to_json(atlas.claim)},
    prove=lambda atlas, piece, interval, limits, stepped: (
        prove_periodic_piece(atlas, piece, interval, ORACLE, limits, stepped).stored
    ),
    more_at_next={"top": 1},
    statement=_statement,
    conclude=lambda atlas, results, *_: told(conclude_periodic(atlas, results)),
    in_full=periodic_curve_in_full,
    unconfirmed=_unconfirmed,
    time="period",
)
