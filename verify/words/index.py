"""The index of the orbits of a curve, in words (section 35.6)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.systems import shown
from orbitproof.shared.wording import itemised
from orbitproof.verify.curve import ProvedCurve, point_name, vertical_point
from orbitproof.verify.evidence import exact_interval_text, exact_text
from orbitproof.verify.index import CountedOrbit, IndexTheorem, Interval, ProvedIndex
from orbitproof.verify.stability import Bound, name_of

_CONVENTION = (
    "It is that of the linearised flow on the level, transverse to the orbit, in a frame that is admissible in the "
    "canonical coordinates q = (x, y, z), p = (vx - y, vy + x, vz); small positive rotations have the index 1."
)


def index_in_words(theorem: IndexTheorem, found: ProvedIndex, curve: ProvedCurve, name: str, digest: str) -> str:
    """What is proved of the index along a curve, whose certificate has this name and digest."""
    atlas = theorem.atlas
    values = ", ".join(f"{key} = {exact_text(value)}" for key, value in atlas.parameters.items())
    lines = [
        f"Let the curve of the certificate {shown(name)} ({digest}) be proved, of periodic orbits of the "
        f"{atlas.system.title} with {values}. The Conley-Zehnder index of its orbits is as follows. {_CONVENTION}"
    ]
    if found.small:
        point = point_name(atlas.system)
        which = f"planar orbits around {point}" if point else f"vertical orbits around {vertical_point(atlas.system)}"
        lines.append(f"Those of its {which} that are small enough: {_sum(found.small)}.")
    if theorem.with_list:
        entries = [
            f"{_between(interval, curve)}: {_index(orbit)}"
            for interval, orbit in zip(found.intervals, found.orbits, strict=True)
        ]
        mirrored = ", and of their mirror images," if atlas.claim.is_of_symmetric_curve else ""
        lines += itemised(f"All orbits{mirrored} between the places named, these not included:", entries)
    else:
        entries = [f"piece {orbit.piece}, s = {exact_text(orbit.s)}: {_index(orbit)}" for orbit in found.orbits]
        lines += itemised("Single orbits; of others nothing is said:", entries)
    return "\n".join(lines)


def _index(orbit: CountedOrbit) -> str:
    return _sum([turns.index for turns in orbit.turns])


def _sum(parts: Sequence[int]) -> str:
    if len(parts) == 1:
        return str(parts[0])
    plane, across = parts
    return f"{plane + across}, in the plane {plane} and across it {across}"


def _between(interval: Interval, curve: ProvedCurve) -> str:
    return f"from {_place(interval.begin, curve)} to {_place(interval.end, curve)}"


def _place(bound: Bound, curve: ProvedCurve) -> str:
    piece = curve.chain.stretches[bound.stretch].tube.piece.id
    what = ", ".join(name_of(each) for each in bound.what)
    return f"{what} (piece {piece}, s in {exact_interval_text(bound.lower, bound.upper)})"
