"""The coordinates in which the orbits of a box are followed (sections 3 and 14).

Either the system's own, or regularised ones, in which a passage close to a singularity takes a few long
steps instead of many short ones. Both give enclosures of the same Poincare map; which one is used can
decide how long a proof takes and whether it succeeds, not what it says.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from orbitproof.shared.systems import Program, ReversibleSystem
from orbitproof.verify.algebra import PreparedProgram, prepare
from orbitproof.verify.poincare.section_field import build_section_program
from orbitproof.verify.poincare.settings import PHYSICAL

if TYPE_CHECKING:
    from orbitproof.shared.systems import Regularisation


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
        embedding: the state at a point of the section; `None` for the system's own coordinates.
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
