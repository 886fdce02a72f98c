"""From a traced family to an atlas: its ends, its pieces and what they are claimed to be together.

- A family outside Fix(S) that starts at a symmetry breaking gives a symmetric arc, one that ends at another such point
  a symmetric loop; their first and last pieces are symmetric.
- A family that closes gives a loop.
- Any other gives an arc. In a system with a family parameter its pieces are graphs over the parameter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from math import ceil, floor, log10
from typing import Any

import numpy as np

from orbitproof.explore.atlases.complex_flow import Coordinates
from orbitproof.explore.atlases.cover import CoverControl, Coverer, CoverFailure
from orbitproof.explore.atlases.curve import Curve, FamilyPoint
from orbitproof.explore.atlases.expansion import Expansion
from orbitproof.explore.engines import Progress
from orbitproof.explore.families import Family, in_fixed_space, tangency
from orbitproof.explore.flow import Vector
from orbitproof.shared.formats import Atlas, Claim, Covers, Piece
from orbitproof.shared.wording import counted

BEYOND = Fraction(1, 1000)
"""Part by which an arc goes beyond the ends of the range that it has to cover."""

ERROR_MARGIN = 1000
"""A tube is at least this many times wider than the error of its polynomial."""

FIRST_WIDTH = 0.02
"""First guess for the half-width of the first piece of an arc, in units of the curve's scale."""


@dataclass(frozen=True)
class AtlasRequest:
    """What is to be covered.

    Attributes:
        id, title: for the atlas.
        family: traced a little beyond the range.
        covers: the range of a coordinate that an arc takes; `None`: the whole family.
        increasing: coordinates claimed to increase along the curve.
        tube: half-width of the tubes in units of the distance from the nearest primary (1 in other systems).
        coordinates: in which the orbits are followed; `None`: whatever is cheaper.
        arc: which one, counted from 1, where the family runs through the range several times.
        provenance: for the file.
    """

    id: str
    title: str
    family: Family
    covers: Covers | None = None
    increasing: tuple[str, ...] = ()
    tube: float = 1e-9
    control: CoverControl = field(default_factory=CoverControl)
    coordinates: Coordinates | None = None
    arc: int = 1
    provenance: Mapping[str, Any] = field(default_factory=dict)


class IncompleteAtlas(CoverFailure):
    """The pieces end before the curve does; `atlas` is of the part that they cover."""

    def __init__(self, reason: str, atlas: Atlas) -> None:
        super().__init__(reason)
        self.atlas = atlas


def build_atlas(request: AtlasRequest, progress: Progress | None = None) -> Atlas:
    """The atlas of a family. Raises `CoverFailure`, with what there is as `IncompleteAtlas`."""
    family = _directed(request)
    system, problem = family.problem.system, family.problem
    curve = Curve(family, system.family_parameter is not None and not _turns(family))
    coverer = Coverer(curve, request.control, request.coordinates)
    overlap = request.control.overlap
    symmetry = next(
        (name for name in system.symmetries if problem.symmetry is None and problem.odd_unknowns(name)), None
    )
    first = last = None
    if symmetry is not None and in_fixed_space(problem, family.orbits[0]):
        first = _symmetric(coverer, symmetry, 0)
        if family.outcome != "closed" and in_fixed_space(problem, family.orbits[-1]):
            last = _symmetric(coverer, symmetry, -1)
    places = family.arclengths
    if first is not None:
        start = first.point(1 - overlap)
        start_place = place_near(curve, start, places[0], first.chart.half_width)
        width = first.chart.half_width
    else:
        start_place = places[0] if request.covers is None else _place(curve, request.covers, request.covers.start)
        start, width = curve.at(start_place).point, FIRST_WIDTH * curve.scale(curve.at(start_place).point)
    if last is not None:
        end = last.point(overlap - 1)
        end_place = place_near(curve, end, places[-1], -last.chart.half_width)
    else:
        end_place = places[-1] if request.covers is None else _place(curve, request.covers, request.covers.end)
        end = curve.at(end_place).point
    crossings = _crossings(family, start_place, end_place)
    # A short range may lie in the symmetric piece alone.
    middle = [] if end_place <= start_place else coverer.pieces(start, start_place, end, end_place, width, progress)
    expansions = [item for item in (first, *middle, last) if item is not None]
    kind = "arc" if first is None else "symmetric-arc" if last is None else "symmetric-loop"
    covers = request.covers
    if coverer.failure is not None:
        last, kind = None, "arc" if first is None else "symmetric-arc"
        expansions = [item for item in (first, *middle) if item is not None]
        reached = expansions[-1].point(1 - overlap)
        covers = _shortened(covers, reached, coverer.failure, system.centre_coordinates)
    if covers is not None and first is not None:
        covers = replace(
            covers, start=max(covers.start, _rounded_start(first.point(0.0), covers, system.centre_coordinates))
        )
    pieces = [
        _piece(f"p{number:03d}", expansion, expansion in (first, last), request.tube)
        for number, expansion in enumerate(expansions, start=1)
    ]
    atlas = Atlas(
        id=request.id,
        title=request.title,
        system=system,
        parameters=dict(problem.parameters),
        claim=Claim(kind, symmetry if first is not None else None, request.increasing, covers, crossings),
        pieces=tuple(pieces),
        provenance=request.provenance,
    )
    if coverer.failure is not None:
        raise IncompleteAtlas(coverer.failure, atlas)
    return atlas


def _shortened(covers: Covers | None, end: Vector, failure: str, names: Sequence[str]) -> Covers:
    """The part of a range up to a point of the curve. Raises `CoverFailure` where nothing is left of it."""
    reached = None if covers is None else Fraction(float(end[list(names).index(covers.coordinate)]))
    if covers is None or reached is None or reached <= covers.start:
        raise CoverFailure(failure)
    unit = Fraction(1, 2**40)
    return replace(covers, end=(reached - abs(reached) * BEYOND) // unit * unit)


def _crossings(family: Family, start: float, end: float) -> int:
    """How often half orbits between two arclengths meet the section; `CoverFailure` if that changes."""
    orbits = [family.orbit_at(start), *(o for o in family.orbits if start <= o.arclength <= end), family.orbit_at(end)]
    for before, after in pairwise(orbits):
        if before.crossings != after.crossings:
            line = tangency(family.problem, before, after)
            raise CoverFailure(f"{line}; no piece contains such an orbit: cover one side of it, or both one by one")
    return orbits[0].crossings


def _directed(request: AtlasRequest) -> Family:
    """The family in the direction in which the coordinate that it covers increases."""
    family, covers = request.family, request.covers
    if covers is None:
        return family
    index = family.problem.system.centre_coordinates.index(covers.coordinate)
    if any(in_fixed_space(family.problem, family.orbits[end]) for end in (0, -1)):
        return family if family.orbits[0].unknowns[index] < family.orbits[-1].unknowns[index] else family.turned()
    return _arc(family, covers, request.arc)


def _turns(family: Family) -> bool:
    """Whether the family parameter has an extremum along a family."""
    steps = np.diff([orbit.unknowns[0] for orbit in family.orbits])
    return bool(np.any(steps > 0) and np.any(steps < 0))


def _arc(family: Family, covers: Covers, number: int) -> Family:
    """The part of the family on which the coordinate goes from one value of the range to the other.

    A family that turns back in the coordinate has several; `number` counts those on which orbits keep the number of
    their crossings, or else all. Raises `CoverFailure`.
    """
    index = family.problem.system.centre_coordinates.index(covers.coordinate)
    arcs: list[Family] = []
    for way in (family, family.turned()):
        values = [float(orbit.unknowns[index]) for orbit in way.orbits]
        low, high = _beyond(covers.start, -1), _beyond(covers.end, 1)
        start: int | None = None
        for place, value in enumerate(values):
            if value <= low:
                start = place
            elif value >= high and start is not None:
                part = slice(start, place + 1)
                arcs.append(replace(way, orbits=way.orbits[part], tangents=way.tangents[part]))
                start = None
    if not arcs:
        values = [float(orbit.unknowns[index]) for orbit in family.orbits]
        raise CoverFailure(
            f"the family does not go from {covers.coordinate} = {float(covers.start):.6g} to {float(covers.end):.6g}, "
            f"and a little beyond, to orbits at {low:.8g} and {high:.8g}; "
            f"along it {covers.coordinate} lies between {min(values):.8g} and {max(values):.8g}: cover less of it, or "
            "cover another coordinate where it turns"
        )
    even = [arc for arc in arcs if len({orbit.crossings for orbit in arc.orbits}) == 1] or arcs
    if number > len(even):
        raise CoverFailure(f"the family has {counted(len(even), 'such arc')}; give --arc a smaller number")
    return even[number - 1]


def _beyond(value: Fraction, sign: int) -> float:
    """A little beyond an end of a range."""
    return float(value + sign * abs(value) * BEYOND)


def _symmetric(coverer: Coverer, symmetry: str, index: int) -> Expansion:
    """The symmetric piece at one end of the family; s increases along the family."""
    family = coverer.curve.family
    orbit, tangent = family.orbits[index], family.tangents[index]
    odd = family.problem.odd_unknowns(symmetry)
    size = len(family.problem.system.centre_coordinates)
    if len(odd) != 1:
        raise CoverFailure(f"{symmetry} negates {len(odd)} coordinates of Fix(R); a symmetric piece needs one")
    direction = np.zeros(size)
    direction[odd[0]] = np.sign(tangent[odd[0]])
    across = np.eye(size)[:, [i for i in range(size) if i != odd[0]]]
    point = FamilyPoint(family.arclengths[index], orbit.unknowns[:-1], direction, orbit.half_period)
    return coverer.symmetric(point, direction, across)


def _place(curve: Curve, covers: Covers, value: Fraction) -> float:
    """The family's arclength a little beyond where a coordinate takes a value of the range."""
    sign = -1 if value == covers.start else 1
    target = _beyond(value, sign)
    index = curve.family.problem.system.centre_coordinates.index(covers.coordinate)
    values = np.array([orbit.unknowns[index] for orbit in curve.family.orbits])
    beyond = np.flatnonzero(sign * (values - target) >= 0)
    if not len(beyond):
        raise CoverFailure(
            f"the family does not reach {covers.coordinate} = {target:.6g}; along it {covers.coordinate} lies between "
            f"{values.min():.8g} and {values.max():.8g}: {curve.family.reason}"
        )
    inside = (int(beyond[0]) - 1) if sign > 0 else (int(beyond[-1]) + 1)
    outside = int(beyond[0]) if sign > 0 else int(beyond[-1])
    places = curve.family.arclengths
    if not 0 <= inside < len(places):
        return places[outside]
    low, high = places[inside], places[outside]
    for _ in range(40):
        middle = 0.5 * (low + high)
        reached = sign * (float(curve.at(middle).point[index]) - target) >= 0
        low, high = (low, middle) if reached else (middle, high)
    return high


def place_near(curve: Curve, point: Vector, origin: float, width: float) -> float:
    """The family's arclength of a point on it, near `origin`, about `width` away in the coordinates."""
    places = np.array(curve.family.arclengths)
    near = np.array([np.linalg.norm(orbit.unknowns[:-1] - point) for orbit in curve.family.orbits])
    best = int(np.argmin(np.where(np.sign(width) * (places - origin) >= 0, near, np.inf)))
    low, high = places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)]

    def ahead(place: float) -> float:
        here = curve.at(place)
        return float((point - here.point) @ here.tangent)

    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ahead(middle) > 0 else (low, middle)
    return float(0.5 * (low + high))


def _rounded_start(point: Vector, covers: Covers, names: Sequence[str]) -> Fraction:
    """The first point's coordinate of a range, rounded up to six digits."""
    value = float(point[list(names).index(covers.coordinate)])
    if value == 0:
        return Fraction(0)
    unit = Fraction(10) ** (floor(log10(abs(value))) - 5)
    return ceil(Fraction(value) / unit) * unit


def _piece(name: str, expansion: Expansion, symmetric: bool, tube: float) -> Piece:
    chart = expansion.chart
    # Few bits are enough for a tube, and a short number is easier to read.
    tubes = [Fraction(float(f"{max(tube * chart.scale, ERROR_MARGIN * error):.1e}")) for error in expansion.noise]
    return Piece(
        id=name,
        kind="symmetric" if symmetric else "regular",
        centre=_exact(chart.centre),
        frame=tuple(_exact(row) for row in chart.frame),
        half_width=Fraction(chart.half_width),
        polynomial=tuple(_exact(row) for row in expansion.trimmed),
        tube=tuple(tubes),
        coordinates=expansion.returns.coordinates,
    )


def _exact(values: Vector) -> tuple[Fraction, ...]:
    """Doubles as the fractions that they are."""
    return tuple(Fraction(float(value)) for value in values)
