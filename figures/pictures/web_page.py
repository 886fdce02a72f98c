"""A proved web as one self-contained page: its diagram, and the orbits of the arc that is chosen, in space.

Levels, ranges, vertices and the theorem are those of the certificate. Orbits, periods and multipliers are double
precision.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from fractions import Fraction
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.flow import FlowFailure, flow_of
from orbitproof.figures.certified import Curve
from orbitproof.figures.orbits import Array, OrbitNotClosed, symmetric_orbit
from orbitproof.figures.pictures.web import (
    COLOURS,
    DASHES,
    WORDS,
    DrawnArc,
    States,
    drawn_arcs,
    in_the_plane,
    is_around_smaller_primary,
    names_of,
)
from orbitproof.figures.pictures.web_script import PAGE
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, System, shown
from orbitproof.verify.branches import StoredArc
from orbitproof.verify.branches.listed import ListedEnd
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.evidence import range_text
from orbitproof.verify.web import IndexOnArc

ORBITS, PLACES, LINE = 28, 84, 40
"""Orbits of an arc, points of each, and points of a line of the diagram, at most."""

SAME, LEVEL_DIGITS = 1e-6, 12
"""Places of a vertex that are as close as this in x are one; digits of its level."""

_SAID = {"vertical": "vertical, symmetric under R and under the half turn"}
"""Where the legend of the picture is too short."""


def page_of(web: Certificate, curves: Mapping[str, Curve]) -> str:
    """The page of a proved web, from the certificates of its arcs. Raises `InputError`."""
    drawn = drawn_arcs(web, curves)
    order = [vertex.id for vertex in web.vertices]
    arcs = [
        {
            **_arc(known, arc, curves[known.id], name),
            "meets": [[meeting.how, order.index(meeting.vertex)] for meeting in known.meets],
            "beside": beside,
        }
        for known, arc, beside, name in zip(
            web.arcs, drawn, _beside(web), names_of([each.id for each in web.arcs]), strict=True
        )
    ]
    mu = float(next(iter(curves.values())).parameters["mu"])
    data = {"arcs": arcs, "vertices": _vertices(web, drawn), "bodies": [-mu, 1 - mu]}
    theorem = "".join(f"<p>{escape(line)}</p>" for line in (web.theorem or "").split("\n"))
    # "</" would end the script.
    text = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
    stable = f", broad bands where orbits are proved to be linearly stable{in_the_plane(drawn)}"
    if not any(arc.stable for arc in drawn):
        stable = ""
    parts = {"TITLE": escape(web.claim.title), "STABLE": stable, "DATA": text, "THEOREM": theorem}
    page = PAGE
    for name, part in parts.items():
        page = page.replace(f"@{name}@", part)
    return page


def _vertices(web: Certificate, drawn: Sequence[DrawnArc]) -> list[dict[str, Any]]:
    """The vertices, each with all places at which arcs meet it: arcs may start at different points of its orbit."""
    places: dict[str, list[list[float]]] = {vertex.id: [] for vertex in web.vertices}
    for vertex, level, x in (mark for arc in drawn for mark in arc.marks):
        if all(abs(x - other) > SAME for _, other in places[vertex.id]):
            places[vertex.id].append([_short(level, 8), _short(x, 8)])
    return [
        {
            "name": shown(vertex.id),
            "kind": vertex.kind.replace("_", " ") + (f" of order {vertex.k}" if vertex.k > 1 else ""),
            "level": range_text(vertex.level, LEVEL_DIGITS),
            "places": sorted(places[vertex.id], key=lambda place: place[1]),
        }
        for vertex in web.vertices
    ]


def _beside(web: Certificate) -> list[list[int]]:
    """For each arc which arcs the diagram is about when it is chosen: those around L1 and L2, or those of its part."""
    near = {arc.id for arc in web.arcs if is_around_smaller_primary(arc)}
    part_of = {name: set(part) for part in web.document["parts"] for name in part}
    wanted = [near if near & part_of[arc.id] else part_of[arc.id] for arc in web.arcs]
    return [[number for number, arc in enumerate(web.arcs) if arc.id in names] for names in wanted]


def _arc(known: StoredArc, arc: DrawnArc, curve: Curve, name: str) -> dict[str, Any]:
    states = States.of(curve)
    points = np.concatenate([stretch.points for stretch in curve.stretches])
    places = [(number, float(s)) for number, stretch in enumerate(curve.stretches) for s in stretch.s]
    found = []
    for row in _evenly(len(points), ORBITS):
        orbit = _orbit(arc.kind, states, points[row])
        if orbit is not None:
            found.append({**orbit, "i": _index_at(places[row], known.index, curve)})
    return {
        "id": shown(known.id),
        "name": name,
        "words": _SAID.get(arc.kind, WORDS[arc.kind]),
        "colour": COLOURS[arc.kind],
        "dash": DASHES[arc.kind],
        "level": "not known" if known.level is None else range_text(known.level, 5),
        "period": "not known" if known.period is None else range_text(known.period, 5),
        "list": _list_in_words(known, arc.kind, curve.atlas.system),
        "line": [point for line in arc.lines for point in _thinned(line)],
        "stable": [_thinned(line) for line in arc.stable],
        "orbits": found,
    }


def _index_at(place: tuple[int, float], counted: Sequence[IndexOnArc], curve: Curve) -> int | None:
    """The index of the orbits of an interval with this place in it, by number of the piece and s; else `None`."""
    order = [stretch.piece for stretch in curve.stretches]
    for orbit in counted:
        if orbit.begin is None or orbit.end is None:
            continue
        begin = order.index(orbit.begin.piece), float(orbit.begin.interval[1])
        end = order.index(orbit.end.piece), float(orbit.end.interval[0])
        # On a loop the interval may pass its beginning.
        if begin < place < end if begin < end else place > begin or place < end:
            return sum(orbit.index)
    return None


def _list_in_words(known: StoredArc, kind: str, system: System) -> str:
    """What its certificate has of linear stability; of a planar arc it is about variations in the plane (33.5)."""
    where = " to variations in the plane" if kind == "planar" else ""
    if known.order is None:
        return "its certificate has no list"
    ends = "; ".join(f"{_end(each.start, system)} to {_end(each.end, system)}" for each in known.stable)
    return f"proved intervals of linear stability{where}: {len(known.stable)}" + (f" ({ends})" if ends else "")


def _end(end: ListedEnd, system: System) -> str:
    """The Jacobi constant at an end of an interval, the size of the orbit by its name, or what is there."""
    if end.level is None:
        return ", ".join(end.what)
    name = "" if system.family_parameter is None else f"{system.family_parameter} = "
    return f"{name}{float(end.level.mid()):.6g}"


def _orbit(kind: str, states: States, point: Array) -> dict[str, Any] | None:
    """An orbit of the arc, or `None` where it is none of the CR3BP, or is not followed."""
    ((level, x),) = states.level_and_x(point[None, :]).T
    state = states.states(point[None, :])[0]
    if not np.abs(state[1:]).any():
        return None
    system = CR3BP_AXIAL if kind in ("axial", "vertical") else CR3BP
    start = [float(state[index]) for index in system.fixed_coordinates]
    try:
        rows = symmetric_orbit(system, {"mu": Fraction(states.mu)}, start)
        period, multiplier = _period(state, rows, states.mu)
    except (OrbitNotClosed, FlowFailure):
        return None
    places = [_short(value, 5) for value in rows[_evenly(len(rows), PLACES), :3].ravel()]
    return {"c": _short(level, 8), "x": _short(x, 8), "t": _short(period), "m": _short(multiplier, 4), "p": places}


def _period(state: Array, rows: Array, mu: float) -> tuple[float, float]:
    """The period, and the largest modulus of a multiplier."""
    speeds = np.linalg.norm(rows[:, 3:], axis=1)
    guess = float(np.sum(2 * np.linalg.norm(np.diff(rows[:, :3], axis=0), axis=1) / (speeds[1:] + speeds[:-1])))
    flow = flow_of(CR3BP)
    half = flow.derivative(state, guess / 2, [mu])
    # The section is crossed after half of it.
    period = guess - 2 * float(half.state[1] / half.velocity[1])
    values = np.linalg.eigvals(flow.derivative(state, period, [mu]).state_transition)
    return period, float(np.abs(values).max())


def _evenly(count: int, most: int) -> NDArray[np.int_]:
    """Indices of at most so many of `count` rows, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, most).round().astype(int))


def _thinned(line: Array) -> list[list[float]]:
    """Points of a line, shape (2, M)."""
    return [[_short(level), _short(x)] for level, x in line.T[_evenly(line.shape[1], LINE)]]


def _short(value: float, digits: int = 6) -> float:
    return float(f"{float(value):.{digits}g}")
