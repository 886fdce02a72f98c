"""What a proved curve with the functions of its list says of one of its orbits (section 32)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.shared.numbers import round_dyadic
from orbitproof.verify.claim import signs_on
from orbitproof.verify.curve import ProvedCurve, Stretch
from orbitproof.verify.distances import is_distance_of_orbits, ranges_between
from orbitproof.verify.evidence import enclose, exact_value, total, up_to
from orbitproof.verify.orbit import Stability, stability_from
from orbitproof.verify.stability import Segment, StabilityResult, segments_of

PRECISION = 192
"""Bits of the ball arithmetic."""

_BITS = 64
"""Bits of s."""


@dataclass(frozen=True)
class OrbitPlace:
    """A place on a curve.

    Attributes:
        piece: id of a piece.
        s: in [-1, 1].
        mirrored: whether the mirror image is meant.
    """

    piece: str
    s: Fraction
    mirrored: bool = False


@dataclass(frozen=True)
class OrbitOnCurve:
    """What is known of an orbit; all in the units of the system (Proposition 32.1).

    Attributes:
        point: encloses the coordinates of a point of the orbit on Fix(R), by name.
        level: of the first integral, or the family parameter.
        period: from the point back to it.
        stability: its stability parameters, and what follows from them; none for more than two.
        stability_index: as in Lemma 32.2; `None` without stability parameters.
        least, greatest: distance from the body that the system names; `None` if it is not known.
    """

    point: Mapping[str, arb]
    level: arb
    period: arb
    stability: Stability
    stability_index: arb | None
    least: arb | None
    greatest: arb | None


@dataclass(frozen=True)
class OrbitsOfCurve:
    """The orbits of a proved curve, one by one.

    Attributes:
        atlas: the claim about the curve.
        curve: what is proved of it.
        segments: for each stretch the parts on which functions are known.
    """

    atlas: Atlas
    curve: ProvedCurve
    segments: tuple[tuple[Segment, ...], ...]

    @classmethod
    def of(cls, atlas: Atlas, curve: ProvedCurve, results: Sequence[StabilityResult]) -> OrbitsOfCurve:
        """From the results from which the curve is proved, with the functions that are known there."""
        with_distance = is_distance_of_orbits(atlas.system, atlas.claim.symmetry)
        with ctx.workprec(PRECISION):
            found = [segments_of(number, stretch, results)[0] for number, stretch in enumerate(curve.chain.stretches)]
        if not with_distance:
            found = [[replace(segment, distances=None) for segment in segments] for segments in found]
        return cls(atlas, curve, tuple(map(tuple, found)))

    def at(self, place: OrbitPlace) -> OrbitOnCurve:
        """The orbit at a place. Raises `ValueError` if that is not on the curve, or no functions are known there."""
        signs = self._signs(place.mirrored)
        for number, stretch in enumerate(self.curve.chain.stretches):
            if stretch.tube.piece.id != place.piece or not stretch.entered <= place.s <= stretch.leaves:
                continue
            for segment in self.segments[number]:
                if segment.start <= place.s <= segment.end:
                    with ctx.workprec(PRECISION):
                        return self._orbit(stretch, segment, place.s, signs)
            raise ValueError(f"{place.piece}: the stability of its orbits is not known there; prove it with a list")
        raise ValueError(f"{place.piece}: the curve does not run through that part of it")

    def near(self, state: Mapping[str, Fraction]) -> OrbitPlace:
        """The place next to a point of the state space (section 32.3).

        Raises `ValueError` if the points of Fix(R) are not all that the system's claims are about.
        """
        on_fix = [state[self.atlas.system.state[index]] for index in self._fixed]
        with ctx.workprec(PRECISION):
            found = [
                _beside(stretch, on_fix, self._signs(mirrored), mirrored)
                for mirrored in (False, True) if not mirrored or self.atlas.claim.is_of_symmetric_curve
                for stretch in self.curve.chain.stretches
            ]  # fmt: skip
        return min(found, key=lambda entry: entry[0])[1]

    def distance(self, orbit: OrbitOnCurve, state: Mapping[str, Fraction]) -> arb:
        """From 0 to a bound of the distance of the orbit's point from a state (section 32.3).

        A coordinate of the state that is none of the point's is 0 there: R negates it, or the system has it not.
        """
        assert set(orbit.point) == {self.atlas.system.state[index] for index in self._fixed} <= set(state)
        with ctx.workprec(PRECISION):
            offsets = [enclose(value) - orbit.point.get(name, arb(0)) for name, value in state.items()]
            square = total(offset * offset for offset in offsets)
            return up_to(square.upper().sqrt().upper())

    @property
    def _fixed(self) -> tuple[int, ...]:
        """Indices of the coordinates that parametrise Fix(R); R negates the others, which are 0 on it."""
        system = self.atlas.system
        fixed = tuple(index for index, sign in enumerate(system.reversing_symmetry) if sign == 1)
        if fixed != system.fixed_coordinates or system.family_parameter is not None:
            raise ValueError(f"{system.name}: its points on Fix(R) are not given by their coordinates there alone")
        return fixed

    def _signs(self, mirrored: bool) -> tuple[int, ...]:
        """Signs of S on Fix(R), or of the identity. Raises `ValueError` if mirror images are not on the curve."""
        system, claim = self.atlas.system, self.atlas.claim
        if not mirrored:
            return (1,) * len(system.centre_coordinates)
        if not claim.is_of_symmetric_curve or claim.symmetry is None:
            raise ValueError("mirrored: nothing is proved of mirror images of this curve")
        return signs_on(system, claim.symmetry, system.centre_coordinates)

    def _orbit(self, stretch: Stretch, segment: Segment, s: Fraction, signs: Sequence[int]) -> OrbitOnCurve:
        names = self.atlas.system.centre_coordinates
        point = stretch.tube.point(stretch.run, s)
        tau = enclose(segment.tau(s))
        stability = stability_from([function.value(tau) for function in segment.characteristic])
        known = ranges_between([segment], (segment.stretch, s), (segment.stretch, s))
        distances = {} if known is None else known.distances
        return OrbitOnCurve(
            point={name: sign * ball for name, sign, ball in zip(names, signs, point, strict=True)},
            level=segment.level.value(tau),
            period=2 * segment.half_period.value(tau),
            stability=stability,
            stability_index=_index(stability),
            least=distances["least"][0] if "least" in distances else None,
            greatest=distances["greatest"][0] if "greatest" in distances else None,
        )


def _index(stability: Stability) -> arb | None:
    """The stability index (Lemma 32.2)."""
    sizes = [(abs(c - 1) + abs(c + 1)) / 2 for c in stability.parameters]
    if not sizes:
        return None
    return sizes[0] if len(sizes) == 1 else sizes[0].max(sizes[1])


def _beside(
    stretch: Stretch, point: Sequence[Fraction], signs: Sequence[int], mirrored: bool
) -> tuple[float, OrbitPlace]:
    """The place on a stretch next to a point of Fix(R), with its distance from the polynomial in units of the tube."""
    tube, piece = stretch.tube, stretch.tube.piece
    p = tube.to_local([sign * enclose(x) for sign, x in zip(signs, point, strict=True)])
    s = round_dyadic(exact_value(tube.parameter(p).mid()), _BITS)
    s = min(max(s, stretch.entered), stretch.leaves)
    offsets = (p[0] - enclose(piece.half_width * s), *tube.offsets(enclose(s), p))
    units = (max(piece.tube), *piece.tube)
    offset = max(float(abs(x / enclose(unit)).mid()) for x, unit in zip(offsets, units, strict=True))
    return offset, OrbitPlace(piece.id, s, mirrored)
