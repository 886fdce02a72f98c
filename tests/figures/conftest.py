"""What tests of tables share."""

from __future__ import annotations

import pytest
from support.table_rows import CERTIFICATES

from orbitproof.figures.tables import CertifiedRow, read_rows


@pytest.fixture(scope="session")
def rows() -> list[CertifiedRow]:
    return read_rows([CERTIFICATES])


@pytest.fixture(scope="session")
def halo(rows: list[CertifiedRow]) -> CertifiedRow:
    """The Earth-Moon row with k = 2, C = 3.0216."""
    return next(row for row in rows if row.id == "earth-moon-L1-halo-k2-1")
