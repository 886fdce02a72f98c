"""Claims about periodic orbits of vector fields of which no symmetry is used."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.shared.claims.in_section import BoxInSection
from orbitproof.shared.stored import Rational, stored

PERIODIC = "periodic"
"""What a claim about a periodic orbit without symmetry says as its kind."""


@dataclass(frozen=True, repr=False)
class PeriodicOrbit(BoxInSection):
    """A claim: the box ``centre + frame p`` in a section contains exactly one point of a periodic orbit as described.

    The orbit of the point meets the section, in the direction, in as many points as `crossings` says, itself included,
    and returns to itself at the last of them.

    Attributes:
        level: of the first integral, on which the orbit is claimed to lie, exactly; `None` where the system has no
            first integral, or where none is used.
        provenance: free-form, ignored by the verifier.
    """

    level: Rational | None = None
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    kind = PERIODIC
    is_of_orbit = True
    parameter, parameter_radius = None, Fraction(0)

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        super().__post_init__()
        self.check_level(self.level)

    def __repr__(self) -> str:
        return f"<PeriodicOrbit {self.id!r}: {self.crossings} crossings, of {self.system.name}>"
