"""The coordinates in which the orbits of a box are followed (sections 3 and 14).

Either the system's own, or regularised ones, in which a passage close to a singularity takes a few long
steps instead of many short ones. Both give enclosures of the same Poincare map; which one is used can
decide how long a proof takes and whether it succeeds, not what it says.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

from orbitproof.shared.systems import REGULARISATIONS, Program, Regularisation, ReversibleSystem
from orbitproof.verify.algebra import PreparedProgram, prepare
from orbitproof.verify.poincare.section_field import build_section_program

PHYSICAL: Final = "physical"


@dataclass(frozen=True)
class Coordinates:
    """The equations that are integrated.

    Attributes:
        name: `PHYSICAL`, or the name of the regularisation.
        field: the vector field; inputs: state, then constants of motion.
        program: the same, prepared.
        section_program: see `verify.poincare.section_field`.
        section: index of the section coordinate.
        regularisation: `None` for the system's own coordinates.
        embedding: the state at a point of Fix(R); `None` for the system's own coordinates.
        steps: about as many regularised ones a half return takes, where that was estimated; else 0.
    """

    name: str
    field: Program
    program: PreparedProgram
    section_program: PreparedProgram
    section: int
    regularisation: Regularisation | None = None
    embedding: Program | None = None
    steps: int = 0


def coordinates_of(name: str, field: Program, size: int, section: int) -> Coordinates:
    """The equations of a vector field whose first `size` inputs are the state; the section is {x_section = 0}."""
    return Coordinates(name, field, prepare(field), build_section_program(field, size, section), section)


def physical(system: ReversibleSystem) -> Coordinates:
    """The system's own coordinates."""
    return coordinates_of(PHYSICAL, system.program, len(system.state), system.section_index)


@cache
def _prepared(name: str) -> tuple[PreparedProgram, PreparedProgram]:
    regularisation = REGULARISATIONS[name]
    size = len(regularisation.state)
    program = regularisation.program
    return prepare(program), build_section_program(program, size, regularisation.section_index)


def regularised(system: ReversibleSystem, state: Sequence[float], parameters: Sequence[float]) -> Coordinates | None:
    """Regularised coordinates of the system, if it has any, that suit a point of Fix(R)."""
    regularisation = REGULARISATIONS.get(system.name)
    # The same name is not enough: the equations are those of this system only.
    if regularisation is None or regularisation.system is not system:
        return None
    program, section_program = _prepared(system.name)
    embedding = regularisation.embedding_program(regularisation.branch(state, parameters))
    field, section = regularisation.program, regularisation.section_index
    return Coordinates(regularisation.name, field, program, section_program, section, regularisation, embedding)
