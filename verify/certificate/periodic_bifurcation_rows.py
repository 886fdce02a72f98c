"""Bifurcations of periodic orbits without symmetry as rows of a certificates file."""

from __future__ import annotations

from typing import Any

from orbitproof.shared.claims import PERIODIC_BIFURCATIONS
from orbitproof.verify.certificate.periodic_rows import PeriodicRows
from orbitproof.verify.evidence import Reason


class PeriodicBifurcationRows(PeriodicRows):
    """See `row_kind.RowKind`."""

    names: tuple[str, ...] = PERIODIC_BIFURCATIONS

    def theorem_of(self, candidate: Any, form: Any) -> Any:
        """As in `RowKind`: there is no theorem."""
        what = "bifurcations of periodic orbits without symmetry are not proved by this version"
        return Reason("theorem", what, "claim a periodic orbit")

    def said(self, k: int, kind: str) -> str:
        """As in `RowKind`."""
        return kind


BIFURCATIONS_OF_PERIODIC_ORBITS = PeriodicBifurcationRows()
