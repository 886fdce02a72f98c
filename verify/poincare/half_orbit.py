"""Where half orbits end that meet the section more than once (section 8.8)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.verify.evidence import Checklist, DerivativeTable, excludes_zero


def check_half_orbit(checklist: Checklist, before: Sequence[Sequence[DerivativeTable]]) -> None:
    """No point of the box is mapped into Fix(R) `before` its half orbit is said to end.

    Args:
        before: the tables of q_1, .., q_n of P, .., P^(m - 1); nothing is asked if there are none.
    """
    if not before:
        return
    statement = f"no point of the box has P^i in Fix(R) for an i <= {len(before)}: some q_j of P^i has no zero there"
    with checklist.hypothesis("half-orbit", "8.8", statement, "claim fewer crossings, or a smaller box") as evidence:
        for i, components in enumerate(before, start=1):
            values = [table.box[(0,) * len(next(iter(table.box)))] for table in components]
            apart = [j for j, value in enumerate(values) if excludes_zero(value)]
            for j in apart[:1] or range(len(values)):
                evidence.record(f"q_{j + 1}(P^{i})", values[j])
            evidence.require(bool(apart), f"P^{i} may map points of the box into Fix(R)")
