"""How far the orbits of a certified catalogue are from its rows."""

from __future__ import annotations

from orbitproof.verify.branches.catalogue import CertifiedRow
from orbitproof.verify.branches.catalogue_table import rounded_up

BOUNDS = ("state", "Jacobi constant", "period", "stability index")


def bounds_of(row: CertifiedRow) -> dict[str, float]:
    """Certified bounds of the differences, rounded up, by the names of `BOUNDS`; of a row without orbit none."""
    off = row.differences
    if off is None:
        return {}
    balls = zip(BOUNDS, (off.point, off.level, off.period, off.stability_index), strict=True)
    return {name: rounded_up(ball) for name, ball in balls if ball is not None}
