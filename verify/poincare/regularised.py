"""Regularised coordinates, in which the orbits of some systems can be followed (section 14)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from orbitproof.shared.systems import REGULARISATIONS, ReversibleSystem
from orbitproof.verify.algebra import PreparedProgram, prepare
from orbitproof.verify.poincare.coordinates import Coordinates
from orbitproof.verify.poincare.section_field import build_section_program


@cache
def _prepared(name: str) -> tuple[PreparedProgram, PreparedProgram]:
    regularisation = REGULARISATIONS[name]
    size = len(regularisation.state)
    program = regularisation.program
    return prepare(program), build_section_program(program, size, regularisation.section_index)


def is_regularised(system: ReversibleSystem) -> bool:
    """Whether there are such coordinates. The same name is not enough: the equations are those of one system only."""
    regularisation = REGULARISATIONS.get(system.name)
    return regularisation is not None and regularisation.system is system


def regularised(system: ReversibleSystem, state: Sequence[float], parameters: Sequence[float]) -> Coordinates | None:
    """Regularised coordinates of the system, if it has any, that suit a point of the section."""
    if not is_regularised(system):
        return None
    regularisation = REGULARISATIONS[system.name]
    program, section_program = _prepared(system.name)
    embedding = regularisation.embedding_program(regularisation.branch(state, parameters))
    field, section = regularisation.program, regularisation.section_index
    return Coordinates(regularisation.name, field, program, section_program, section, regularisation, embedding)
