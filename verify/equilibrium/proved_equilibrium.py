"""One equilibrium in a box: interval Newton, and its eigenvalues (sections 36.3 to 36.5)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.claims import AroundPoint, Equilibrium
from orbitproof.verify.equilibrium.box import NARROWER, check_field, point_of, require_zero
from orbitproof.verify.equilibrium.enclosures import EquilibriumEnclosures
from orbitproof.verify.equilibrium.spectrum import Spectrum, spectrum_of
from orbitproof.verify.evidence import Checklist, Outcome, concluded
from orbitproof.verify.periodic import check_functions_of


@dataclass(frozen=True)
class EquilibriumResults:
    """What is known of a proved equilibrium, in the units of its system.

    Attributes:
        point: enclosures of its coordinates, by name.
        eigenvalues: of the derivative of the field there.
    """

    point: Mapping[str, arb]
    eigenvalues: Spectrum


@dataclass(frozen=True)
class EquilibriumTheorem:
    """The box of a claim contains exactly one equilibrium (Theorem 36.3)."""

    claim: Equilibrium

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return *(["functions"] if self.claim.system.defined else []), "field", "equilibrium"


def check_equilibrium_exactly(checklist: Checklist, claim: AroundPoint) -> None:
    """All hypotheses that need no enclosures; raises `NotEstablishedError` for the first that fails."""
    check_functions_of(checklist, claim.system)


def prove_equilibrium(
    claim: Equilibrium, checklist: Checklist, enclosures: EquilibriumEnclosures | None
) -> Outcome[EquilibriumResults]:
    """Check that the box contains exactly one equilibrium, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before; the current precision of Arb is used.
    """

    def check() -> EquilibriumResults:
        size = len(claim.centre)
        field = () if enclosures is None else enclosures.field
        check_field(checklist, "36.2", field, size, size, {})
        matrix = [list(f.slopes) for f in field]
        names = [f"x_{i}" for i in range(size)]
        statement = "interval Newton: f(x) = 0 has exactly one solution inside the box"
        with checklist.hypothesis("equilibrium", "36.3", statement, NARROWER) as evidence:
            where = require_zero(evidence, names, matrix, [f.centre for f in field], claim.radii)
        return EquilibriumResults(point_of(claim, where), spectrum_of(matrix))

    return concluded(EquilibriumTheorem(claim), checklist, check)
