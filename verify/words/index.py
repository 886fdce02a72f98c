"""The index of the orbits of a curve, in words (section 35.6)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import LIFTED, shown
from orbitproof.shared.wording import itemised
from orbitproof.verify.curve import ProvedCurve, point_name, vertical_point
from orbitproof.verify.evidence import exact_interval_text, exact_text
from orbitproof.verify.index import CountedOrbit, IndexTheorem, Interval, ProvedIndex
from orbitproof.verify.stability import Bound, IntervalEnd

CONVENTION = (
    "It is that of the linearised flow on the level, transverse to the orbit, in a frame that is admissible in the "
    "canonical coordinates q = (x, y, z), p = (vx - y, vy + x, vz); small positive rotations have the index 1."
)


def index_in_words(theorem: IndexTheorem, found: ProvedIndex, curve: ProvedCurve, name: str, digest: str) -> str:
    """What is proved of the index along a curve, whose certificate has this name and digest."""
    atlas = theorem.atlas
    values = ", ".join(f"{key} = {exact_text(value)}" for key, value in atlas.parameters.items())
    lines = [
        f"Let the curve of the certificate {shown(name)} ({digest}) be proved, of periodic orbits of the "
        f"{atlas.system.title} with {values}. The Conley-Zehnder index of its orbits is as follows. {CONVENTION}"
    ]
    if atlas.system is LIFTED:
        lines.append(
            "Its orbits are those of the three-body problem that the points with eps2 > 0 stand for, over the period "
            "2 T, T the time after which they are in the plane Z = 0 again for the first time."
        )
    if found.small:
        lines.append(f"Those of its {small_orbits(atlas)} that are small enough: {sum_in_words(found.small)}.")
    if theorem.with_list:
        entries = [
            f"{_between(interval, curve)}: {_index(orbit)}"
            for interval, orbit in zip(found.intervals, found.orbits, strict=True)
        ]
        mirrored = " and their mirror images" if atlas.claim.is_of_symmetric_curve else ""
        lines += itemised(f"All orbits{mirrored} between the places named, these not included:", entries)
    else:
        entries = [f"piece {orbit.piece}, s = {exact_text(orbit.s)}: {_index(orbit)}" for orbit in found.orbits]
        lines += itemised("Single orbits; of others nothing is said:", entries)
    return "\n".join(lines)


def _index(orbit: CountedOrbit) -> str:
    return sum_in_words([turns.index for turns in orbit.turns])


def small_orbits(atlas: Atlas) -> str:
    """The orbits around a libration point to which a curve shrinks."""
    point = point_name(atlas.system)
    return f"planar orbits around {point}" if point else f"vertical orbits around {vertical_point(atlas.system)}"


def sum_in_words(parts: Sequence[int]) -> str:
    """An index; of planar orbits as a sum."""
    if len(parts) == 1:
        return str(parts[0])
    plane, across = parts
    return f"{plane + across}, in the plane {plane} and across it {across}"


def _between(interval: Interval, curve: ProvedCurve) -> str:
    return f"from {_place(interval.begin, curve)} to {_place(interval.end, curve)}"


def _place(bound: Bound, curve: ProvedCurve) -> str:
    return place_in_words(IntervalEnd.of(bound, curve.chain))


def place_in_words(place: IntervalEnd) -> str:
    """An end of an interval of a curve."""
    return f"{', '.join(place.what)} (piece {place.piece}, s in {exact_interval_text(*place.interval)})"
