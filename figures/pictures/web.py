"""The picture of a web: level of the first integral against x where orbits start, arcs from certified polynomials."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from textwrap import wrap
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from orbitproof.figures.certified import CertifiedPoint, Curve
from orbitproof.figures.orbits import Array
from orbitproof.figures.pictures.legends import bottom_margin, legend_below
from orbitproof.figures.pictures.marks import draw_point
from orbitproof.figures.style import INK, label_of, level_label
from orbitproof.shared.formats import AnyAtlas, InputError
from orbitproof.shared.systems import (
    AROUND,
    BRANCH_SYSTEMS,
    CR3BP,
    CR3BP_PLANAR,
    LIFTED,
    VERTICAL,
    ReversibleSystem,
    System,
    shown,
)
from orbitproof.verify.branches import StoredArc, StoredVertex
from orbitproof.verify.branches.listed import ListedInterval
from orbitproof.verify.certificate import Certificate

COLOURS = {"planar": "#3c6e91", "R": "#1b7837", "axial": "#b2182b", "vertical": "#762a83"}
WORDS = {
    "planar": "in the plane",
    "R": "symmetric under R",
    "axial": "symmetric under the half turn",
    "vertical": "vertical",
}
DASHES: Mapping[str, tuple[float, ...]] = {
    "planar": (), "R": (7, 1.5), "axial": (1.5, 1.2), "vertical": (6, 1.5, 1, 1.5)
}  # fmt: skip
"""Lengths of dashes and gaps, in widths of the line."""
STYLES: Mapping[str, Any] = {kind: (0, dashes) if dashes else "solid" for kind, dashes in DASHES.items()}
_WIDTH, _HEIGHT = 7.2, 4.6
_CHARACTERS = 95
_NEAR = "(b)  around L1 and L2"
_STABLE: Mapping[str, Any] = {"linewidth": 6.0, "alpha": 0.3, "solid_capstyle": "butt"}
_POINT: Mapping[str, Any] = {"color": INK, "marker": "d", "linestyle": "none", "markersize": 6.0}


@dataclass(frozen=True)
class DrawnArc:
    """An arc as it is drawn.

    Attributes:
        name: what it is called in the picture.
        kind: of its symmetry, a key of `WORDS`.
        lines: for each piece level and x, shape (2, M).
        marks: the vertices on it, with level and x.
        stable: lines where its certificate lists that orbits are linearly stable, of a planar arc in the plane.
    """

    name: str
    kind: str
    lines: tuple[Array, ...]
    marks: tuple[tuple[StoredVertex, float, float], ...]
    stable: tuple[Array, ...]


def drawn_arcs(web: Certificate, curves: Mapping[str, Curve]) -> tuple[DrawnArc, ...]:
    """The arcs of a proved web of the CR3BP, from the certificates of their curves by id. Raises `InputError`."""
    if not web.proved:
        raise InputError(f"the web {web.id}: its certificate says {web.verdict!r}; there is nothing to draw")
    vertices = {vertex.id: vertex for vertex in web.vertices}
    named = names_of([arc.id for arc in web.arcs])
    return tuple(_drawn(arc, name, curves[arc.id], vertices) for arc, name in zip(web.arcs, named, strict=True))


def names_of(ids: Sequence[str]) -> list[str]:
    """What arcs are called: their ids without the words that all of them have, the libration point first.

    >>> names_of(["vertical-l1-earth-moon", "l2-halo-earth-moon"]), names_of(["circle"])
    (['L1 vertical', 'L2 halo'], ['circle'])
    """
    shared = set.intersection(*(set(each.split("-")) for each in ids)) if len(ids) > 1 else set()
    words = ([_WRITTEN.get(word, word) for word in each.split("-") if word not in shared | {"family"}] for each in ids)
    names = [" ".join(sorted(each, key=lambda word: word not in ("L1", "L2", "L3"))) for each in words]
    are_plain = all(shown(each) == each for each in ids) and "" not in names and len({*names}) == len(ids)
    return names if are_plain else [shown(each) for each in ids]


_WRITTEN = {"l1": "L1", "l2": "L2", "l3": "L3", "lyapunov": "Lyapunov", "dro": "DRO"}


def is_around_smaller_primary(arc: StoredArc) -> bool:
    """Whether it ends at L1 or L2, beside which other arcs are large."""
    return any(meeting.vertex in ("L1", "L2") for meeting in arc.meets)


def _drawn(arc: StoredArc, name: str, curve: Curve, vertices: Mapping[str, StoredVertex]) -> DrawnArc:
    kind, states = _kind_of(curve.atlas), States.of(curve)
    lines = tuple(states.level_and_x(stretch.points) for stretch in curve.stretches)
    marks = []
    for meeting in arc.meets:
        vertex = vertices[meeting.vertex]
        if meeting.piece is None or meeting.s is None:
            x = states.libration_point
        elif meeting.piece in {piece.id for piece in curve.atlas.birth_pieces()}:
            # Where the curve goes on to it: the picture does not follow the piece of a birth.
            x = float(lines[-1][1, -1])
        else:
            mark = CertifiedPoint(vertex.id, vertex.kind, vertex.k, meeting.piece, float(meeting.s.mid()), False)
            x = float(states.level_and_x(curve.place_of(mark)[1][None, :])[1, 0])
        marks.append((vertex, float(vertex.level.mid()), x))
    stable = [states.level_and_x(part) for interval in arc.stable for part in _between(curve, interval)]
    return DrawnArc(name, kind, lines, tuple(marks), tuple(stable))


def _between(curve: Curve, interval: ListedInterval) -> Iterator[Array]:
    """The points of a curve between the ends of an interval, piece by piece; on a loop it may pass its beginning."""
    order = [stretch.piece for stretch in curve.stretches]
    first, last = (order.index(end.piece) for end in (interval.start, interval.end))
    begin, end = float(interval.start.interval[1]), float(interval.end.interval[0])
    wraps = (last, end) < (first, begin)
    for number in range(first, last + 1 + wraps * len(order)):
        stretch = curve.stretches[number % len(order)]
        low = begin if number == first else -np.inf
        high = end if number == last + wraps * len(order) else np.inf
        points = stretch.points[(stretch.s >= low) & (stretch.s <= high)]
        if len(points):
            yield points


def _kind_of(atlas: AnyAtlas) -> str:
    system = atlas.system
    around = _around(system)
    if around is not None or system == CR3BP_PLANAR:
        return "planar" if around is None else around[0]
    if system == LIFTED:
        return "axial"
    return "axial" if isinstance(system, ReversibleSystem) and system.reversor is not None else "R"


def _around(system: System) -> tuple[str, str] | None:
    """Planar or vertical, and the libration point, of a system in units of such orbits around one."""
    kinds = {"planar": AROUND, "vertical": VERTICAL}
    return next(
        ((kind, name) for kind, points in kinds.items() for name, known in points.items() if known == system), None
    )


@dataclass(frozen=True)
class States:
    """How points of a curve are states of the CR3BP, in double precision.

    Attributes:
        names: of the coordinates of its points.
        mu: the mass parameter.
        libration_point: its x; of a curve that is not around one, 0.
        around: "planar" or "vertical" of a curve in units of such orbits around it, "plane" of one in units of
            the speed across the plane; `None` for others.
    """

    names: tuple[str, ...]
    mu: float
    libration_point: float
    around: str | None

    @classmethod
    def of(cls, curve: Curve) -> States:
        """Raises `InputError` for curves of other systems."""
        system = curve.atlas.system
        if (
            "mu" not in curve.parameters
            or not {"x", "eps", "eps2"} & set(curve.coordinates)
            or system.name not in BRANCH_SYSTEMS
        ):
            raise InputError(f"the curve {curve.atlas.id}: is none of the CR3BP; give certificates of such arcs")
        mu = float(curve.parameters["mu"])
        around = _around(system)
        if around is None:
            return cls(curve.coordinates, mu, 0.0, "plane" if system == LIFTED else None)
        return cls(curve.coordinates, mu, _libration_point(mu, around[1]), around[0])

    def level_and_x(self, points: Array) -> Array:
        """Level and x of points, shape (M, 1 + n); shape (2, M)."""
        program = CR3BP.first_integral_program
        assert program is not None
        states = self.states(points)
        at = {**dict(zip(CR3BP.state, states.T, strict=True)), "mu": self.mu}
        (level,) = program.evaluate(
            [at[name] for name in program.inputs], float, lambda base, power: base ** float(power)
        )
        return np.array([level, states[:, 0]])

    def states(self, points: Array) -> Array:
        """The states of points, shape (M, 1 + n), in the CR3BP; shape (M, 6)."""
        known = dict(zip(self.names, points.T, strict=True))
        zero = np.zeros(len(points))
        if self.around == "planar":
            eps = known["eps"]
            known = {"x": self.libration_point + eps, "vy": eps * known["vy"]}
        elif self.around == "vertical":
            size = np.maximum(known["eps2"], 0.0)
            known = {"x": self.libration_point + size * known["x"], "vy": size * known["vy"], "vz": np.sqrt(size)}
        elif self.around == "plane":
            known["vz"] = np.sqrt(np.maximum(known["eps2"], 0.0))
        return np.column_stack([known.get(name, zero) for name in CR3BP.state])


def _libration_point(mu: float, name: str) -> float:
    """x of one of the three in double precision, by bisection of the force on the axis."""
    left, right = {"L1": (-mu, 1 - mu), "L2": (1 - mu, 2.0), "L3": (-2.0, -mu)}[name]
    for _ in range(200):
        x = 0.5 * (left + right)
        larger, smaller = x + mu, x - 1 + mu
        force = x - (1 - mu) * larger / abs(larger) ** 3 - mu * smaller / abs(smaller) ** 3
        left, right = (left, x) if force > 0 else (x, right)
    return 0.5 * (left + right)


def draw_web(web: Certificate, curves: Mapping[str, Curve]) -> Figure:
    """Level against x where orbits start; the surroundings of planar and vertical arcs beside."""
    arcs = drawn_arcs(web, curves)
    near = [arc for known, arc in zip(web.arcs, arcs, strict=True) if is_around_smaller_primary(known)]
    claims = sorted({(vertex.k, vertex.kind) for vertex in web.vertices if not vertex.is_libration_point})
    handles = [
        Line2D([], [], color=COLOURS[kind], linestyle=STYLES[kind], linewidth=1.6, label=words)
        for kind, words in WORDS.items() if kind in {arc.kind for arc in arcs}
    ]  # fmt: skip
    if any(arc.stable for arc in arcs):
        handles.append(Line2D([], [], color=INK, **_STABLE, label=f"linearly stable{in_the_plane(arcs)}"))
    if len(claims) < len(web.vertices):
        handles.append(Line2D([], [], **_POINT, label="libration point"))
    figure = plt.figure(figsize=(_WIDTH, _HEIGHT))
    foot = bottom_margin(_HEIGHT, claims, [True], handles)
    panels = [("", arcs)] if len(near) in (0, len(arcs)) else [("(a)  all arcs", arcs), (_NEAR, near)]
    grid = figure.add_gridspec(1, len(panels), left=0.1, right=0.98, top=0.86, bottom=foot, wspace=0.26)
    places = [figure.add_subplot(grid[0, number]) for number in range(len(panels))]
    unnamed: Sequence[DrawnArc] = arcs
    # The last panel first: what is large there is named there.
    for axes, (title, wanted) in reversed(list(zip(places, panels, strict=True))):
        _draw(axes, arcs, wanted)
        unnamed = _named(axes, unnamed, arcs, everything=axes is places[0])
        axes.set_title(title, color=INK)
    figure.text(0.1, 0.955, "\n".join(wrap(web.claim.title, _CHARACTERS)), color=INK, fontweight="bold", va="center")
    legend_below(figure, claims, [True], handles)
    return figure


def _named(axes: Axes, wanted: Sequence[DrawnArc], arcs: Sequence[DrawnArc], everything: bool) -> list[DrawnArc]:
    """Write names on arcs, each where the others are far, and return those arcs that are mostly outside of the axes.

    With `everything` these are named too, on what is seen of them.
    """
    limits = np.array([axes.get_xlim(), axes.get_ylim()])
    places = {id(arc): _within(limits, np.concatenate(arc.lines, axis=1).T) for arc in arcs}
    marks = [_within(limits, np.array([[level, x]])) for arc in arcs for _, level, x in arc.marks]
    taken: list[Array] = []
    left: list[DrawnArc] = []
    for arc in wanted:
        inside = [place for place in places[id(arc)] if (place > _EDGE).all() and (place < 1 - _EDGE).all()]
        if len(inside) < (1 if everything else len(places[id(arc)]) / 2):
            left.append(arc)
            continue
        others = np.concatenate([*(places[id(each)] for each in arcs if each is not arc), *marks, *taken, _FAR])
        best, above = max(
            product(inside[:: max(1, len(inside) // 60)], (1, -1)),
            key=lambda tried: _room(tried[0] + _LETTERS * (1, tried[1]), places[id(arc)], others),
        )
        taken.append(best + _LETTERS * (1, above))
        axes.annotate(
            arc.name, best, (3, 4 * above), xycoords="axes fraction", textcoords="offset points", fontsize=7,
            va="bottom" if above > 0 else "top", color=COLOURS[arc.kind], zorder=6,
            path_effects=[withStroke(linewidth=2, foreground="white")],
        )  # fmt: skip
    return left


def _room(letters: Array, own: Array, others: Array) -> tuple[bool, bool, float]:
    """How good a place these letters have: in the axes, off the line that they name, far from all else."""
    off, far = (float(np.min(np.linalg.norm(letters[:, None] - points, axis=2))) for points in (own, others))
    return bool((letters < 1.0).all()), off > _OFF, far


def _within(limits: Array, points: Array) -> Array:
    """Points as parts of the axes."""
    return np.asarray((points - limits[:, 0]) / (limits[:, 1] - limits[:, 0]))


_EDGE = 0.04
_LETTERS = np.array([[0.02, 0.035], [0.09, 0.035], [0.17, 0.035]])
"""Where a name is, from the place that it belongs to, if it stands above that."""
_OFF = 0.025
_FAR = np.array([[9.0, 9.0]])


def in_the_plane(arcs: Sequence[DrawnArc]) -> str:
    """What is to be said beside proved stability: that of planar arcs is about variations in the plane (33.5)."""
    return ", planar ones in the plane" if any(arc.stable and arc.kind == "planar" for arc in arcs) else ""


def _draw(axes: Axes, arcs: Sequence[DrawnArc], around: Sequence[DrawnArc]) -> None:
    """The arcs, as far as the axes show the surroundings of some."""
    for number, set_limits in enumerate((axes.set_xlim, axes.set_ylim)):
        values = np.concatenate([line[number] for arc in around for line in arc.lines])
        room = 0.06 * (values.max() - values.min())
        set_limits(values.min() - room, values.max() + room)
    for arc in arcs:
        for level, x in arc.stable:
            axes.plot(level, x, color=COLOURS[arc.kind], **_STABLE)
        for level, x in arc.lines:
            axes.plot(level, x, color=COLOURS[arc.kind], linestyle=STYLES[arc.kind], linewidth=1.4)
    limits = np.array([axes.get_xlim(), axes.get_ylim()])
    for vertex, level, x in (mark for arc in arcs for mark in arc.marks):
        place = np.array([level, x])
        if vertex.is_libration_point:
            axes.plot([level], [x], **_POINT, zorder=5)
        elif ((limits[:, 0] < place) & (place < limits[:, 1])).all():
            draw_point(axes, place, vertex.k, True, vertex.id, vertex.kind)
    axes.set_xlabel(level_label(CR3BP))
    axes.set_ylabel(f"{label_of(CR3BP, 'x', unit=False)} where the orbit starts")
