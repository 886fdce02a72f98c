"""What ``orbitproof explore periodic --atlas`` writes: the curve of an orbit as pieces."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands.periodic_claims import Along
from orbitproof.shared.formats import write_atlas
from orbitproof.shared.wording import counted

if TYPE_CHECKING:
    from orbitproof.explore.periodic import FoundOrbit


def cover(options: argparse.Namespace, orbit: FoundOrbit, along: Along, report: Any) -> int:
    """The curve of an orbit, written as an atlas; 1 if it does not go as far as asked for. Raises `InputError`."""
    from orbitproof.explore.periodic import PeriodicFailure, cover_curve

    name, low, high = along
    system = orbit.problem.system
    report.stage(f"covering the curve in {name or 'the level'}")
    base = options.id or f"{system.name}-{name or 'levels'}"
    try:
        found = cover_curve(orbit, name, (low, high), base, progress=lambda text: report.update(text, None))
    except PeriodicFailure as failure:
        report.error(f"{system.name}: no atlas: {failure}")
        return 1
    write_atlas(options.atlas, found.atlas)
    report.message(f"{counted(len(found.atlas.pieces), 'piece')} are in {options.atlas}; ends: {'; '.join(found.ends)}")
    return 0 if found.reaches else 1
