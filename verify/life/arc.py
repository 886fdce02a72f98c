"""An arc of a life: what is proved of a curve of equilibria, or of orbits from their birth on (section 39.1)."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from orbitproof.shared.claims import BirthAtlas, EquilibriumAtlas
from orbitproof.shared.claims.life import BEGINS, ENDS, Joining
from orbitproof.verify.birth_curve import ProvedBirthCurve
from orbitproof.verify.equilibrium.spectrum import Spectrum
from orbitproof.verify.equilibrium_curve import ProvedEquilibriumCurve
from orbitproof.verify.evidence import hull


@dataclass(frozen=True)
class Birth:
    """An equilibrium at which orbits are born.

    Attributes:
        point: enclosures of the parameter and of the equilibrium, by coordinate.
        frequency: omega of its eigenvalues +- i omega.
        others: the other eigenvalues (38.5).
    """

    point: dict[str, arb]
    frequency: arb
    others: Spectrum


@dataclass(frozen=True)
class LifeCurve:
    """A curve of a life.

    Attributes:
        atlas: the claim about it.
        curve: what is proved of it; `None` if that is nothing.
        problem: why it counts for nothing, if it does.
    """

    atlas: EquilibriumAtlas | BirthAtlas
    curve: ProvedEquilibriumCurve | ProvedBirthCurve | None
    problem: str = ""

    @property
    def id(self) -> str:
        """The id of the atlas."""
        return self.atlas.id

    @property
    def equations(self) -> tuple[object, ...]:
        """What two arcs have in common if they are about the same equations, by no name that a file gives a system."""
        system = self.atlas.system
        return (
            *(system.state, system.given_state, system.parameters, system.program.text()),
            tuple((each.name, each.function) for each in system.defined),
            tuple(argument.text() for argument in system.argument_programs),
            *(self.atlas.claim.parameter, dict(self.atlas.parameters)),
        )

    @property
    def births(self) -> dict[Joining, Birth]:
        """Where its orbits shrink to equilibria: at the beginning of a curve of orbits, and perhaps at its end."""
        if not isinstance(self.curve, ProvedBirthCurve):
            return {}
        start, end = (
            {name: self.curve.ends[key][name] for name in (self.atlas.claim.parameter, *self.atlas.system.given_state)}
            for key in ("start", "end")
        )
        found: dict[Joining, Birth] = {BEGINS: Birth(start, self.curve.frequency, self.curve.eigenvalues)}
        return found if self.curve.pair_at_end is None else {**found, ENDS: Birth(end, *self.curve.pair_at_end)}

    @property
    def pieces(self) -> set[tuple[object, ...]]:
        """Its pieces, as they are written."""
        coordinates = self.atlas.coordinates
        return {(coordinates, each.centre, each.frame, each.polynomial) for each in self.atlas.curve_pieces()}

    @property
    def values(self) -> arb:
        """A ball with the values of the parameter at all points of the proved curve (39.5)."""
        assert self.curve is not None
        found = [
            stretch.tube.points(proved.deviation, first, last)[0]
            for stretch in self.curve.chain.stretches
            for proved, first, last in stretch.run.between(stretch.enters, stretch.leaves)
        ]
        return hull(found[0], *found[1:])
