"""Atlases of period doublings of halo orbits over the mass parameter.

In the equations of `shared.systems.HILL_VARIED` a period doubling is a symmetric orbit: the halo orbit with the
variation that its multiplier -1 belongs to. It is found on a halo family at one mass and followed over h = mu^(1/3).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from operator import attrgetter

import numpy as np

from orbitproof.explore.atlases import HalfReturns, LibrationFailure, orbit_at, zero_near
from orbitproof.explore.families import Limits, detect
from orbitproof.explore.flow import Matrix, Vector, flow_of
from orbitproof.explore.three_body.atlases.graphs import pieces_of
from orbitproof.explore.three_body.families import trace_family
from orbitproof.explore.three_body.names import NORTH, SOUTH
from orbitproof.shared.formats import Atlas, Claim, Covers
from orbitproof.shared.systems import CR3BP, HILL_VARIED, ReversibleSystem

START, NEAREST = Fraction(1, 100), 0.15
"""The mass at which the doubling is found on the halo family, and how near to the smaller primary that is followed, in
units of h."""
TOLERANCE = 1e-8
STEP = 0.01
"""Step of the continuation in h."""
BEYOND = 2e-5
"""So far the pieces go beyond the range of h."""
FREE = [HILL_VARIED.state.index(name) for name in HILL_VARIED.centre_coordinates[1:]]
"""The coordinates of the state with which orbits start."""
WANTED = [HILL_VARIED.section_index, *HILL_VARIED.kernel_coordinates]
"""What vanishes at their ends."""


@dataclass(frozen=True)
class Doubling:
    """A halo orbit with the multiplier -1, and its variation.

    Attributes:
        h: mu^(1/3).
        start: shape (5,), the coordinates with which it starts, as in `HILL_VARIED`.
        half_period: of the halo orbit.
        slopes: shape (6,), derivatives of start and half period in h.
    """

    h: float
    start: Vector
    half_period: float
    slopes: Vector


@dataclass(frozen=True)
class DoublingFamily:
    """The first period doubling that is found along the halo family of L1 or L2, over the mass.

    Attributes:
        first: where it is known.
    """

    first: Doubling
    _known: list[Doubling] = field(default_factory=list, compare=False)

    @classmethod
    def of(cls, point: str) -> DoublingFamily:
        """The family of a libration point. Raises `LibrationFailure` and what tracing raises."""
        h = float(START) ** (1 / 3)
        # Those with z > 0 at the first point, the one at which the curve starts.
        branch = NORTH if point == "L1" else SOUTH
        halo = trace_family(CR3BP, f"{point}-halo", {"mu": START}, Limits(min_distance=NEAREST * h), branch=branch)
        found = detect(halo, [2]).resonances
        if not found:
            raise LibrationFailure(f"no period doubling was found on the halo family of {point}")
        x, z, vy = found[0].point
        time = found[0].orbit.half_period
        state = [x, 0.0, z, 0.0, vy, 0.0]
        transition = flow_of(CR3BP).derivative(state, time, [float(START)]).state_transition
        variation = np.linalg.svd(transition[np.ix_([0, 2, 4], [0, 2, 4])])[2][-1]
        place = np.array([(x - 1 + float(START)) / h, z / h, vy / h, *(variation[:2] / variation[2])])
        return cls(_correct(h, np.append(place, time)))

    @property
    def system(self) -> ReversibleSystem:
        """The equations."""
        return HILL_VARIED

    @property
    def constants(self) -> list[float]:
        """The parameters before h: none."""
        return []

    def orbit(self, place: float) -> Doubling:
        """The doubling at h = `place`, from its nearest known neighbour in steps. Raises `LibrationFailure`."""
        if not self._known:
            self._known.append(self.first)
        return orbit_at(place, self._known, STEP, attrgetter("h"), self._beside)

    def _beside(self, near: Doubling, h: float) -> Doubling:
        return _correct(h, np.append(near.start, near.half_period) + (h - near.h) * near.slopes)

    @cached_property
    def returns(self) -> HalfReturns:
        """Half returns of the equations."""
        return HalfReturns(HILL_VARIED, {})

    def start(self, place: float) -> tuple[float, ...]:
        """The coordinates of its start, and the half period."""
        doubling = self.orbit(place)
        return (*map(float, doubling.start), doubling.half_period)


def _correct(h: float, unknowns: Vector) -> Doubling:
    """Newton's method for the start and the half period."""

    def linearised(unknowns: Vector) -> tuple[Vector, Matrix, Vector]:
        state = np.zeros(len(HILL_VARIED.state))
        state[FREE] = unknowns[:-1]
        for name, value in HILL_VARIED.normalised.items():
            state[HILL_VARIED.state.index(name)] = float(value)
        result = flow_of(HILL_VARIED).derivative(state, unknowns[-1], [h])
        jacobian = np.column_stack([result.state_transition[np.ix_(WANTED, FREE)], result.velocity[WANTED]])
        return result.state[WANTED], jacobian, result.parameter_derivative[WANTED]

    found, jacobian, rates = zero_near(
        unknowns,
        linearised,
        lambda step, found, _: np.abs(step).max() < TOLERANCE * np.abs(found).max(),
        f"at h = {h:.6g}",
    )
    return Doubling(h, found[:-1], float(found[-1]), -np.linalg.solve(jacobian, rates))


def doubling_atlas(point: str, lowest: Fraction, highest: Fraction, tube: float) -> Atlas:
    """The atlas of the period doublings over lowest <= h <= highest.

    Arguments:
        point: "L1" or "L2".
        tube: half-width of the tubes relative to the coordinates.

    Raises `LibrationFailure`, and those of `explore.families` and `explore.orbits`.
    """
    family = DoublingFamily.of(point)
    pieces = pieces_of(family, float(lowest) - BEYOND, float(highest) + BEYOND, tube)
    return Atlas(
        id=f"halo-doubling-{point.lower()}-masses",
        title=f"period doublings of halo orbits near {point}",
        system=HILL_VARIED,
        parameters={},
        claim=Claim("arc", None, ("h",), Covers("h", lowest, highest)),
        pieces=pieces,
        provenance={"point": point, "found_at": float(START)},
    )
