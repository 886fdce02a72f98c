"""One piece of a curve of periodic orbits, proved over an interval of its parameter (section 26.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import PeriodicAtlas, Piece
from orbitproof.verify.algebra import Series
from orbitproof.verify.curve import (
    BEYOND,
    TUBE,
    Account,
    Interval,
    PieceLimits,
    PieceResult,
    Progress,
    attempt,
    check_newton,
    in_units,
)
from orbitproof.verify.evidence import Checklist, dot, enclose, excludes_zero, guarded, hull, is_positive
from orbitproof.verify.periodic import slopes_along
from orbitproof.verify.periodic_curve.characteristic import ProvedPeriodicInterval, multipliers_along
from orbitproof.verify.periodic_curve.conditions import check_integral, require_piece
from orbitproof.verify.periodic_curve.returns import FramingWideOracle, Returns, TubeOfOrbits, ranges
from orbitproof.verify.poincare import PHYSICAL, at_start


@dataclass(frozen=True)
class PeriodicLimits(PieceLimits):
    """How to integrate a piece: as `PieceLimits`.

    Attributes:
        top: as there; what is beyond grows with the bounds of the whole period.
    """

    precision: int = 128
    order: int = 52
    width: int = 40
    top: int = 2


@dataclass(frozen=True)
class PeriodicTubeTheorem:
    """For every s of the interval the tube contains exactly one point that returns as claimed (Lemma 26.2)."""

    uses_integral: bool

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        own, last = (("first-integral",), ("last-coordinate",)) if self.uses_integral else ((), ())
        return "piece", *own, "direction", "return-map", "least-period", "newton", *last


def prove_periodic_piece(
    atlas: PeriodicAtlas,
    piece: Piece,
    interval: Interval,
    oracle: FramingWideOracle,
    limits: PeriodicLimits | None = None,
    progress: Progress | None = None,
) -> PieceResult[ProvedPeriodicInterval]:
    """Prove the claim of a piece for s in an interval within [-1, 1], or say why it is not proved.

    Args:
        atlas: what is claimed; of its pieces only `piece` matters.
        oracle: finds approximations.
        progress: called after every step with the number of steps; what it raises passes through.
    """
    limits = PeriodicLimits() if limits is None else limits
    computation: Account = {**asdict(limits), "steps": 0, "coordinates": PHYSICAL}
    proof = _Proof(atlas, piece, interval, oracle, limits)
    theorem = PeriodicTubeTheorem(atlas.claim.uses_integral)
    with guarded(limits.precision):
        return attempt(
            piece.id, interval, theorem, computation, lambda checklist: proof.check(checklist, computation, progress)
        )


@dataclass(frozen=True)
class _Proof:
    """The claim of a piece on an interval, and how to integrate it."""

    atlas: PeriodicAtlas
    piece: Piece
    interval: Interval
    oracle: FramingWideOracle
    limits: PeriodicLimits

    def check(self, checklist: Checklist, computation: Account, progress: Progress | None) -> ProvedPeriodicInterval:
        """Check every hypothesis; raises `NotEstablishedError` at the first that is not shown."""
        start, end = self.interval
        claim = self.atlas.claim
        statement = "the piece has the coordinates of the section, a regular frame and a tube"
        with checklist.hypothesis("piece", "26.1", statement, "correct the piece") as evidence:
            evidence.require(-1 <= start < end <= 1, f"[{start}, {end}] is no interval within [-1, 1]")
            require_piece(evidence, self.atlas, self.piece)
        if claim.uses_integral:
            check_integral(checklist, self.atlas)
        radius = (end - start) / 2 * BEYOND
        widths = [width / TUBE for width in self.piece.tube]
        # Half of the bits are left at the highest grade.
        arithmetic = self.limits.arithmetic(widths, self.limits.precision // 2)
        orbits = TubeOfOrbits(self.atlas, self.piece, ((start + end) / 2, radius), widths, arithmetic)
        coordinates = orbits.section.coordinates(self.atlas.system.program)
        self._check_direction(checklist, ranges(orbits.across(coordinates)))

        def stepped(steps: int) -> None:
            computation["steps"] = steps
            if progress is not None:
                progress(steps)

        statement = "the orbits of the tube meet the section as often as claimed and are enclosed there"
        with checklist.hypothesis("return-map", "26.2", statement, "a narrower piece") as evidence:
            found = orbits.follow(coordinates, self.oracle, stepped)
            time = evidence.record("period", found.time_of_all())
            evidence.require(is_positive(time), "the periods are not enclosed")
        self._check_least(checklist, orbits, found)
        images, points = found.images[claim.crossings], orbits.others(orbits.state)
        dropped = self._dropped(orbits) if claim.uses_integral else None
        equations = [
            image + point.scaled(Fraction(-1))
            for i, (image, point) in enumerate(zip(images, points, strict=True))
            if i != dropped
        ]
        if claim.level is not None:
            equations.append(_level(orbits) + arithmetic.constant(-claim.level))
        deviation, slope_deviation = check_newton(checklist, equations, radius)
        if dropped is not None:
            self._check_last(checklist, orbits, images, dropped)
        bounds = in_units(widths, deviation), in_units(widths, slope_deviation)
        multipliers = multipliers_along(self.atlas, self.piece, self.interval, images, widths, deviation)
        return ProvedPeriodicInterval(start, end, *bounds, time, multipliers=multipliers)

    def _check_direction(self, checklist: Checklist, across: Sequence[arb]) -> None:
        """At all points of the tube the section is crossed in the direction."""
        direction = self.atlas.claim.direction
        statement = f"normal . f is {'positive' if direction > 0 else 'negative'} on the tube"
        remedy = "claim the other direction, or give a narrower piece"
        with checklist.hypothesis("direction", "26.2", statement, remedy) as evidence:
            evidence.record("normal . f", hull(across[0], *across[1:]))
            excluded = any(is_positive(-direction * ball) for ball in across)
            evidence.require(
                all(is_positive(direction * ball) for ball in across), "it may have the other sign", excluded=excluded
            )

    def _check_least(self, checklist: Checklist, orbits: TubeOfOrbits, found: Returns) -> None:
        """No point of the tube returns to itself at an earlier crossing."""
        m = self.atlas.claim.crossings
        earlier = [stop for stop in found.images if stop != m]
        statement = (
            "the orbits cross the section once in the direction within a period: there is no shorter one"
            if m == 1
            else f"after {', '.join(map(str, earlier))} of the {m} crossings no point of the tube is back at itself"
        )
        remedy = "claim fewer crossings, if the orbits are others run through several times; or a narrower piece"
        with checklist.hypothesis("least-period", "26.3", statement, remedy) as evidence:
            evidence.require(m in found.images, "the return is missing")
            points = orbits.others(orbits.state)
            for stop in earlier:
                moved = [
                    ranges(image + point.scaled(Fraction(-1)))
                    for image, point in zip(found.images[stop], points, strict=True)
                ]
                apart = all(any(map(excludes_zero, balls)) for balls in zip(*moved, strict=True))
                evidence.require(apart, f"orbits may be back after {stop} of {m} crossings", needs_precision=True)

    def _dropped(self, orbits: TubeOfOrbits) -> int:
        """The place of the coordinate whose equation is left out: one in which the first integral changes fast."""
        slopes = self._integral_slopes(orbits, [ranges(element)[0] for element in orbits.others(orbits.state)], 0)
        return max(range(len(slopes)), key=lambda j: float(abs(slopes[j].mid())))

    def _check_last(self, checklist: Checklist, orbits: TubeOfOrbits, images: Sequence[Series], dropped: int) -> None:
        """dH/dx_j is not 0 between a point of the tube and its image that differs from it in x_j alone."""
        name = [name for i, name in enumerate(self.atlas.system.given_state) if i != self.atlas.claim.pivot][dropped]
        statement = f"dH/d{name} along the section has no zero where {name} lies between a point and its image"
        with checklist.hypothesis("last-coordinate", "26.3", statement, "a narrower piece or tube") as evidence:
            others = [ranges(element) for element in orbits.others(orbits.state)]
            others[dropped] = [
                hull(*pair) for pair in zip(others[dropped], ranges(images[dropped]), strict=True)
            ]  # fmt: skip
            for part, where in enumerate(zip(*others, strict=True)):
                slope = self._integral_slopes(orbits, where, part)[dropped]
                evidence.require(excludes_zero(slope), "it may vanish", needs_precision=True)

    def _integral_slopes(self, orbits: TubeOfOrbits, others: Sequence[arb], part: int) -> list[arb]:
        """Derivatives of the first integral along the section, in its coordinates, at points with these."""
        system, claim = self.atlas.system, self.atlas.claim
        program = system.first_integral_program
        assert program is not None
        pivot = claim.pivot
        places = [i for i in range(len(system.given_state)) if i != pivot]
        factors = [-claim.normal[i] / claim.normal[pivot] for i in places]
        state = list(others)
        constant = enclose(claim.offset / claim.normal[pivot])
        state.insert(pivot, constant + dot([enclose(factor) for factor in factors], others))
        columns = [
            [factor if row == pivot else Fraction(int(row == i)) for row in range(len(system.given_state))]
            for i, factor in zip(places, factors, strict=True)
        ]
        parameters = [ranges(element)[part] for element in orbits.constants]
        return slopes_along(program, state, parameters, columns, system)


def _level(orbits: TubeOfOrbits) -> Series:
    """The first integral at the points of a tube."""
    program = orbits.system.first_integral_program
    assert program is not None
    return at_start(program, [*orbits.section.own_state(orbits.state), *orbits.constants])[0]
