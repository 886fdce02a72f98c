"""One piece of a curve of orbits from their birth on, proved over an interval of its parameter (section 38.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.claims import BirthAtlas, PeriodicCurveClaim, Piece
from orbitproof.shared.systems import AMPLITUDE, blown_up_program, own_name
from orbitproof.verify.algebra import Arithmetic, Series
from orbitproof.verify.birth_curve.functions import slopes_at_start
from orbitproof.verify.curve import (
    BEYOND,
    TUBE,
    Account,
    Interval,
    PieceResult,
    Progress,
    ProvedInterval,
    attempt,
    check_newton,
    in_units,
    tube_points,
)
from orbitproof.verify.evidence import Checklist, Evidence, guarded, hull, is_positive
from orbitproof.verify.periodic import functions_at_start, section_of
from orbitproof.verify.periodic_curve import PeriodicLimits, require_piece
from orbitproof.verify.periodic_curve.returns import FramingWideOracle, TubeOfOrbits, ranges
from orbitproof.verify.poincare import PHYSICAL, at_start, defined_values


@dataclass(frozen=True)
class BirthLimits(PeriodicLimits):
    """How to integrate a piece: as `PeriodicLimits`."""


@dataclass(frozen=True)
class BirthTubeTheorem:
    """For every s of the interval the tube contains exactly one zero of the equations (Lemma 38.3)."""

    hypotheses = ("piece", "direction", "return-map", "newton")


class _BornOrbits(TubeOfOrbits):
    """The points y of a tube on the plane y_k = 0, with y_j = 1, and their orbits under F.

    Attributes:
        rest: c at the points of the tube, all coordinates.
        parameters: those of the vector field there.
    """

    def __init__(
        self,
        atlas: BirthAtlas,
        piece: Piece,
        interval: tuple[Fraction, Fraction],
        widths: Sequence[Fraction],
        arithmetic: Arithmetic,
    ) -> None:
        claim, system = atlas.claim, atlas.system
        normal = claim.normal(system)
        self.claim = PeriodicCurveClaim("periodic-arc", normal, Fraction(0), claim.direction, 1, claim.parameter)
        self.system, self.arithmetic = system, arithmetic
        self.section = section_of(system, normal, Fraction(0))
        self.point = tube_points(arithmetic, atlas.coordinates, piece, interval, widths)
        exact = {claim.section: Fraction(0), claim.amplitude: Fraction(1)}
        given = [
            arithmetic.constant(exact[name]) if name in exact else self.point[own_name(f"along {name}")]
            for name in system.given_state
        ]
        self.parameters = [
            self.point[name] if name == claim.parameter else arithmetic.constant(atlas.parameters[name])
            for name in system.parameters
        ]
        own, amplitude = [self.point[name] for name in system.given_state], self.point[AMPLITUDE]
        self.rest = [*own, *defined_values(functions_at_start(system), own, self.parameters)]
        self.state = [*given, *slopes_at_start(system, given, self.parameters, amplitude, self.rest)]
        self.constants = [*self.parameters, amplitude, *self.rest]

    def equations(self, images: Sequence[Series]) -> list[Series]:
        """f(c), and the return of y less y but for its coordinate across the plane."""
        at_rest = at_start(self.system.program, [*self.rest, *self.parameters])[: len(self.system.given_state)]
        closing = [
            image + point.scaled(Fraction(-1))
            for image, point in zip(images, self.others(self.state), strict=True)
        ]  # fmt: skip
        return [*at_rest, *closing]


def require_claim(evidence: Evidence, atlas: BirthAtlas) -> None:
    """Require that the claim names coordinates and parameters of the field."""
    claim, system = atlas.claim, atlas.system
    two = claim.section != claim.amplitude and {claim.section, claim.amplitude} <= {*system.given_state}
    evidence.require(two, "section and amplitude are no two coordinates of the state")
    evidence.require(claim.direction in (1, -1), "no such direction")
    given = claim.parameter in system.parameters and {*atlas.parameters, claim.parameter} == {*system.parameters}
    evidence.require(given and claim.parameter not in atlas.parameters, "a parameter has no value, or is none")


def prove_birth_curve_piece(
    atlas: BirthAtlas,
    piece: Piece,
    interval: Interval,
    oracle: FramingWideOracle,
    limits: PeriodicLimits | None = None,
    progress: Progress | None = None,
) -> PieceResult[ProvedInterval]:
    """Prove the claim of a piece for s in an interval within [-1, 1], or say why it is not proved.

    Args:
        atlas: what is claimed; of its pieces only `piece` matters.
        oracle: finds approximations.
        progress: called after every step with the number of steps; what it raises passes through.
    """
    limits = BirthLimits() if limits is None else limits
    computation: Account = {**asdict(limits), "steps": 0, "coordinates": PHYSICAL}

    def stepped(steps: int) -> None:
        computation["steps"] = steps
        if progress is not None:
            progress(steps)

    def check(checklist: Checklist) -> ProvedInterval:
        start, end = interval
        statement = "the claim names two coordinates and a parameter; the piece has these coordinates, frame and tube"
        with checklist.hypothesis("piece", "38.1", statement, "correct the claim or the piece") as evidence:
            evidence.require(-1 <= start < end <= 1, f"[{start}, {end}] is no interval within [-1, 1]")
            require_claim(evidence, atlas)
            if evidence.holds:
                require_piece(evidence, atlas, piece)
        radius = (end - start) / 2 * BEYOND
        widths = [width / TUBE for width in piece.tube]
        # Half of the bits are left at the highest grade.
        arithmetic = limits.arithmetic(widths, limits.precision // 2)
        orbits = _BornOrbits(atlas, piece, ((start + end) / 2, radius), widths, arithmetic)
        field = blown_up_program(atlas.system.program, len(atlas.system.state))
        coordinates = orbits.section.coordinates(field)
        _check_direction(checklist, atlas, ranges(orbits.across(coordinates)))
        statement = "the orbits of the tube come back to the plane in the direction and are enclosed there"
        with checklist.hypothesis("return-map", "38.3", statement, "a narrower piece") as evidence:
            found = orbits.follow(coordinates, oracle, stepped)
            time = evidence.record("period", found.time_of_all())
            evidence.require(is_positive(time), "the periods are not enclosed")
        deviation, slope_deviation = check_newton(checklist, orbits.equations(found.images[1]), radius)
        bounds = in_units(widths, deviation), in_units(widths, slope_deviation)
        return ProvedInterval(start, end, *bounds, time)

    with guarded(limits.precision):
        return attempt(piece.id, interval, BirthTubeTheorem(), computation, check)


def _check_direction(checklist: Checklist, atlas: BirthAtlas, across: Sequence[arb]) -> None:
    """At all points of the tube the plane is crossed in the direction."""
    direction, name = atlas.claim.direction, atlas.claim.section
    statement = (
        f"the velocity of {name} over the amplitude is {'positive' if direction > 0 else 'negative'} on the tube"
    )
    remedy = "claim the other direction, or give a narrower piece"
    with checklist.hypothesis("direction", "38.3", statement, remedy) as evidence:
        evidence.record(f"velocity of {name}", hull(across[0], *across[1:]))
        excluded = any(is_positive(-direction * ball) for ball in across)
        holds = all(is_positive(direction * ball) for ball in across)
        evidence.require(holds, "it may have the other sign", excluded=excluded)
