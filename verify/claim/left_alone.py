"""Functions that the symmetries of a system leave alone, by their parities (section 1.3)."""

from __future__ import annotations

from orbitproof.shared.systems import Program, ReversibleSystem, parities


def is_left_alone(program: Program | None, system: ReversibleSystem, symmetry: str | None) -> bool:
    """Whether a program has one output, which R and the symmetry, if one is named, leave alone, by its parities."""
    involutions = [system.reversing_symmetry, *([] if symmetry is None else [system.symmetries[symmetry]])]
    return program is not None and all(parities(program, signs) == [1] for signs in involutions)
