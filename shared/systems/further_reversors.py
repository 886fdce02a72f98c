"""A system with one of its further reversing symmetries in place of R."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from orbitproof.shared.systems.system import ReversibleSystem


def settings_of(system: ReversibleSystem) -> Mapping[str, ReversibleSystem]:
    """By the names of these symmetries. Raises `ValueError` for one that does not fit the system."""
    return {
        name: replace(
            system,
            name=f"{system.name}-{name}",
            title=f"{system.title}, reversible under {reversor.title}",
            reversing_symmetry=reversor.signs,
            section=reversor.section or system.section,
            level_coordinate=reversor.level_coordinate or system.level_coordinate,
            reversors={},
            original=system,
            reversor=name,
        )
        for name, reversor in system.reversors.items()
    }
