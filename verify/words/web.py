"""The theorem about a web in words (section 33.4)."""

from __future__ import annotations

from collections.abc import Mapping

from orbitproof.shared.claims.web import BRANCHES
from orbitproof.shared.systems import AXIAL, LIFTED, shown
from orbitproof.shared.wording import counted, itemised
from orbitproof.verify.claim import atlas_in_words, system_in_words
from orbitproof.verify.curve import is_at_birth, is_born_at_doubling, is_planar, point_name, vertical_point
from orbitproof.verify.evidence import exact_text, interval_text, located, range_text
from orbitproof.verify.web import Arc, Incidence, Indices, KnownArc, ProvedWeb, Vertex, WebTheorem
from orbitproof.verify.words.index import CONVENTION, place_in_words, small_orbits, sum_in_words

_DIGITS, _FEW = 18, 5
_KINDS = {"arc": "an arc", "loop": "a loop", "symmetric-arc": "a symmetric arc", "symmetric-loop": "a symmetric loop"}


def web_in_words(theorem: WebTheorem, web: ProvedWeb, digests: Mapping[str, str]) -> str:
    """What is proved of a web that rests on certificates with these digests, by id."""
    assert [known.arc.id for known in web.arcs] == [arc.id for arc in theorem.web.arcs]
    first = web.arcs[0].arc
    system = system_in_words(first.system)
    level = system.family_parameter or system.first_integral_name or "first integral"
    values = ", ".join(f"{name} = {exact_text(value)}" for name, value in first.atlas.parameters.items())
    of_system = f"{system.title}{f' with {values}' if values else ''}"
    # Orbits for two values may consist of the same states.
    family = "" if system.family_parameter is None else f" with the value of {system.family_parameter}"
    lines = [
        f"Let the certificates named below be proved. Periodic orbits of the {of_system}, and libration points, are "
        f"here closed sets of states{family}, compared by their Hausdorff distance."
    ]
    if any(known.indices is not None for known in web.arcs):
        lines.append(f"The Conley-Zehnder index of an orbit is that over the period of its arc. {CONVENTION}")
    for known in web.arcs:
        lines += _arc(known, web, level, digests[known.arc.id])
        if known.indices is not None:
            lines += _indices(known.arc, known.indices)
    vertices = (_vertex(vertex, level, digests.get(vertex.id)) for vertex in web.vertices)
    lines += itemised("The vertices are different from each other:", vertices)
    for switch in web.switches:
        lines.append(
            f"Let R' be the reversing symmetry of the certificate of {shown(switch.vertex)}, and P its map. "
            f"Near its point the points x of Fix(R') with P^2(x) = x are those of {shown(switch.along)}, in the "
            f"plane, and those of {shown(switch.onto)}."
        )
    for part in web.parts:
        if len(part) > 1:
            names = ", ".join(map(shown, part))
            lines.append(
                f"Any two orbits of the {counted(len(part), 'arc')} {names} are joined by a path of orbits of these "
                "arcs, the libration points at their ends among them."
            )
    return "\n".join(lines)


def _arc(known: KnownArc, web: ProvedWeb, level: str, digest: str) -> list[str]:
    arc, claim = known.arc, known.arc.atlas.claim
    point = point_name(arc.atlas.system)
    vertical = vertical_point(arc.atlas.system)
    about = f"symmetric under {_reversor(arc.system.reversor)}"
    if is_planar(arc.atlas.system):
        about = f"in the plane around {point}" if point else f"in the plane, {about}"
    if vertical is not None:
        about = f"around {vertical} that are vertical, symmetric under R and the half turn about the x axis"
    mirrored = ", mirror images included" if claim.is_of_symmetric_curve or arc.atlas.system is LIFTED else ""
    # Once around an orbit of doubled period is twice around the one from which it is born.
    period = "a period" if is_born_at_doubling(arc.atlas) else "period"
    ranges = {level: known.level, period: known.period}
    told = "".join(f"; {name} in {range_text(ball, _FEW)}" for name, ball in ranges.items() if ball.is_finite())
    meetings = [_meeting(entry, arc) for entry in web.incidences if entry.arc == arc.id]
    return itemised(
        f"The arc {shown(arc.id)} ({digest}), {_KINDS[claim.kind]} of orbits {about}{mirrored}{told}:",
        meetings or ["is claimed to meet no vertex"],
    )


def _indices(arc: Arc, known: Indices) -> list[str]:
    """What the certificate of the index along the curve says, and nothing of other orbits (section 33.6)."""
    entries = []
    if known.small:
        entries.append(f"{small_orbits(arc.atlas)} that are small enough: {sum_in_words(known.small)}")
    mirrored = " and their mirror images" if arc.atlas.claim.is_of_symmetric_curve else ""
    for orbit in known.orbits:
        where = f"the orbit at s = {exact_text(orbit.s)} of piece {orbit.piece}"
        if orbit.begin is not None and orbit.end is not None:
            ends = f"from {place_in_words(orbit.begin)} to {place_in_words(orbit.end)}"
            where = f"all orbits{mirrored} {ends}, these places not included"
        entries.append(f"{where}: {sum_in_words(orbit.index)}")
    return itemised(
        f"The index of orbits of the arc {shown(arc.id)} ({known.digest}), of others nothing is said:", entries
    )


def _reversor(name: str | None) -> str:
    return "R" if name is None else {AXIAL: "the half turn about the x axis"}.get(name, shown(name))


def _meeting(entry: Incidence, arc: Arc) -> str:
    place, meets = entry.place, f"{entry.how} {shown(entry.vertex)}"
    if place is None:
        return f"{meets}: its orbits shrink to the libration point"
    if arc.atlas.system is LIFTED:
        born = "vertical" if arc.placed[entry.vertex].loses_reversor else "planar"
        return f"{meets}: from that {born} orbit, on piece {place.piece}, its orbits are born"
    if is_at_birth(arc.atlas, place):
        return f"{meets}: from that orbit, on piece {place.piece}, its orbits, of about twice the period, are born"
    if entry.how == BRANCHES:
        symmetry = atlas_in_words(arc.atlas).claim.symmetry
        return (
            f"{meets}: at the symmetric point of piece {place.piece}; of the points of the arc only symmetric points "
            f"are in Fix({symmetry})"
        )
    mirror = " (its mirror image)" if place.mirrored else ""
    which = "the other point of the orbit, " if place.other_point else ""
    return f"{meets}: {which}on piece {place.piece}{mirror}, {located('s', place.s, _DIGITS)}"


def _vertex(vertex: Vertex, level: str, digest: str | None) -> str:
    of_order = f" of order {vertex.k}" if vertex.k > 1 else ""
    certificate = "" if digest is None else f" ({digest})"
    where = f"{level} in {interval_text(vertex.level, _DIGITS)}"
    return f"{shown(vertex.id)}: {vertex.kind.replace('_', ' ')}{of_order}, {where}{certificate}"
