"""Atlases of curves of periodic orbits from the equilibrium at which they are born on."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

from orbitproof.shared.claims.fields import Identifier
from orbitproof.shared.claims.periodic_curve import PeriodicAtlas, Refusal
from orbitproof.shared.systems import AMPLITUDE, System, own_name

BIRTH_CURVES = ("birth-arc", "birth-to-birth")


@dataclass(frozen=True)
class BirthCurveClaim:
    """What the pieces are claimed to be together: the orbits that are born at an equilibrium while a parameter varies.

    An orbit is written as x = c + eps y, c an equilibrium for the same value of the parameter. It crosses the plane
    where `section` has its value at c exactly once in the direction, at the point with y = 1 for `amplitude`; there
    that coordinate of x differs from that of c by eps. The curve begins with eps = 0, and eps is positive along it.

    Attributes:
        kind: one of `BIRTH_CURVES`; `birth-to-birth`: the curve ends with eps = 0 too.
        section: a coordinate of the state.
        direction: 1 or -1, whether it grows or falls where the plane is crossed.
        amplitude: another coordinate of the state.
        parameter: the one that varies along the curve.
    """

    kind: Literal["birth-arc", "birth-to-birth"]
    section: Identifier
    direction: Literal[1, -1]
    amplitude: Identifier
    parameter: Identifier

    symmetry = level = covers = None
    increasing = numbers = ()
    uses_integral = is_of_symmetric_curve = is_closed = goes_round = False
    crossings = 1

    def refusal(self, system: System) -> Refusal | None:
        """What the claim cannot say of a system."""
        for field, named in (("section", self.section), ("amplitude", self.amplitude)):
            if named not in system.given_state:
                known = ", ".join(system.given_state)
                return field, f"{system.name} has no coordinate {named!r}", f"choose one of: {known}"
        if self.section == self.amplitude:
            return "amplitude", "is the coordinate of the section", "choose another one"
        return None

    def across(self, system: System) -> tuple[str, ...]:
        """The coordinates of y that are unknown, as those of the state are called: on the plane, without that of 1."""
        return tuple(name for name in system.given_state if name not in (self.section, self.amplitude))

    def coordinates(self, system: System) -> tuple[str, ...]:
        """Names of the coordinates of a point: the parameter that varies, eps, those of c, those of y."""
        return (
            self.parameter, AMPLITUDE, *system.given_state, *(own_name(f"along {x}") for x in self.across(system))
        )  # fmt: skip

    def normal(self, system: System) -> tuple[Fraction, ...]:
        """The normal of the plane of the section, shape (N,)."""
        return tuple(Fraction(int(name == self.section)) for name in system.given_state)

    @property
    def setting(self) -> tuple[Any, ...]:
        """What a proof of a piece depends on beside the piece, the system and its parameters."""
        return self.kind, self.section, self.direction, self.amplitude, self.parameter


@dataclass(frozen=True, repr=False)
class BirthAtlas(PeriodicAtlas):
    """A claim about orbits from their birth on: fields as of a curve of periodic orbits without symmetry."""

    claim: BirthCurveClaim  # type: ignore[assignment]
