"""Births of periodic orbits from equilibria: Hopf points (section 36)."""

from __future__ import annotations

from orbitproof.shared.claims import HOPF
from orbitproof.verify.attempt.precision import equilibrium_precision, missing_of_either
from orbitproof.verify.certificate.kind import BoxKind
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.equilibrium import (
    HopfEnclosures,
    HopfResults,
    HopfTheorem,
    check_equilibrium_exactly,
    enclose_hopf,
    prove_hopf,
)
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.equilibrium import hopf_in_full, hopf_in_words
from orbitproof.verify.words.row_in_full import in_lines

KIND = BoxKind(
    names=(HOPF,),
    enclosures=HopfEnclosures,
    results=HopfResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: HopfTheorem(claim),
    first_precision=equilibrium_precision,
    check_exactly=check_equilibrium_exactly,
    enclose=enclose_hopf,
    prove=prove_hopf,
    titles={"hopf": "A Hopf bifurcation"},
    said=lambda k, kind: "Hopf bifurcation",
    on_side=lambda kind: "periodic orbits",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
    },
    missing=missing_of_either,
    in_words=hopf_in_words,
    in_full=lambda claim, theorem, found: in_lines(hopf_in_full(claim, hopf_in_words(theorem), found)),
)
