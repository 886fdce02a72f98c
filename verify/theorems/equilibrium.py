"""One equilibrium (section 36)."""

from __future__ import annotations

from orbitproof.shared.claims import EQUILIBRIUM
from orbitproof.verify.attempt.precision import equilibrium_precision, missing_of_point
from orbitproof.verify.certificate.kind import BoxKind
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.equilibrium import (
    EquilibriumEnclosures,
    EquilibriumResults,
    EquilibriumTheorem,
    check_equilibrium_exactly,
    enclose_equilibrium,
    prove_equilibrium,
)
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.equilibrium import equilibrium_in_full, equilibrium_in_words
from orbitproof.verify.words.row_in_full import in_lines

KIND = BoxKind(
    names=(EQUILIBRIUM,),
    enclosures=EquilibriumEnclosures,
    results=EquilibriumResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: EquilibriumTheorem(claim),
    first_precision=equilibrium_precision,
    check_exactly=check_equilibrium_exactly,
    enclose=enclose_equilibrium,
    prove=prove_equilibrium,
    titles={"equilibrium": "One equilibrium"},
    said=lambda k, kind: "equilibrium",
    attributes=lambda found: {},
    missing=missing_of_point,
    in_words=equilibrium_in_words,
    in_full=lambda claim, theorem, found: in_lines(equilibrium_in_full(claim, equilibrium_in_words(theorem), found)),
)
