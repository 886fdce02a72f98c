"""Atlases of families of doubled period that end at the doubling from which their orbits are born.

The family is covered up to near the doubling, where two curves of orbits cross, and from there on by a piece about it
(`BirthPiece`), in which orbits are known by where they are in the middle of their half orbits.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import floor, log10

import numpy as np

from orbitproof.explore.atlases import AtlasRequest, CoverFailure, Curve, IncompleteAtlas, build_atlas, place_near
from orbitproof.explore.engines import Progress
from orbitproof.explore.families import Family
from orbitproof.explore.flow import FlowFailure, Vector, flow_of
from orbitproof.explore.three_body.atlases.births import VX, VY, VZ, OrbitsAtBirth, X, Z, birth_piece
from orbitproof.shared.formats import Atlas, BirthPiece, Covers
from orbitproof.shared.systems import CR3BP

AMPLITUDE, LEAVES = 0.2, 0.85
"""Half-width of the piece of the birth, relative to the speed there; up to which part it is used."""
NARROWER, BITS = 0.02, 96
"""Its tube, relative to those of other pieces: it begins close to a primary. What its orbits are computed with."""
JOINT = 30
"""The last tube before it is so many times wider: orbits of the piece of the birth, led to their ends, are in it."""


def doubled_atlas(request: AtlasRequest, progress: Progress | None = None) -> Atlas:
    """The atlas of a family that was traced from its birth at a doubling, from its last orbit to that.

    Raises `CoverFailure`.
    """
    family = _while_twice(request.family, request.covers)
    if len(family.orbits) < 3 or family.problem.system is not CR3BP:
        raise CoverFailure("the family does not begin at a doubling of orbits of the CR3BP that meet the section once")
    birth = _at_birth(family)
    size = AMPLITUDE * float(np.abs(birth.middle[2]))
    x, z, speed = np.abs(birth.middle - [1 - float(birth.mu), 0.0, 0.0])
    distance = float(np.hypot(x, z))
    tubes = NARROWER * request.tube * np.array([6 * distance, 2 * distance, speed, 1.0])
    piece, ends = birth_piece(birth, size, LEAVES * size, tubes)
    rest = _beyond(family, ends[:, [X, Z, VY]])
    try:
        atlas = build_atlas(replace(request, family=rest.turned(), covers=None), progress)
    except IncompleteAtlas as error:
        raise CoverFailure(str(error)) from None
    return _with_birth(atlas, piece, request.increasing)


def _while_twice(family: Family, covers: Covers | None) -> Family:
    """The family as far as half orbits meet the section twice, and one orbit before it is tangent to it.

    Not much beyond the beginning of the range that is to be covered.
    """
    count = next((n for n, orbit in enumerate(family.orbits) if orbit.crossings != 2), len(family.orbits) + 1) - 1
    if covers is not None:
        index = family.problem.system.centre_coordinates.index(covers.coordinate)
        below = (n for n, orbit in enumerate(family.orbits) if orbit.unknowns[index] < covers.start)
        count = min(count, next(below, count) + 1)
    return replace(family, orbits=family.orbits[:count], tangents=family.tangents[:count])


def _at_birth(family: Family) -> OrbitsAtBirth:
    """New orbits near the old one, in the middle of their half orbits."""
    first, mu = family.orbits[0], family.problem.parameters["mu"]
    time = 0.5 * first.half_period
    try:
        state = flow_of(CR3BP).derivative(family.problem.initial_state(first.unknowns), time, [float(mu)]).state
    except FlowFailure as error:
        raise CoverFailure(str(error)) from None
    return OrbitsAtBirth(mu, state[[X, Z, VY]], time, (VX, VZ), BITS)


def _beyond(family: Family, ends: Vector) -> Family:
    """The part of the family from that of two points on which is on its side of the birth."""
    first, second = family.orbits[:2]
    end = max(ends, key=lambda each: float((each - first.unknowns[:3]) @ (second.unknowns - first.unknowns)[:3]))
    place = place_near(Curve(family, False), end, 0.0, 1.0)
    later = [number for number, orbit in enumerate(family.orbits) if orbit.arclength > place]
    orbits = (family.orbit_at(place), *(family.orbits[number] for number in later))
    tangents = (family.tangents[later[0]], *(family.tangents[number] for number in later))
    return replace(family, orbits=orbits, tangents=tangents)


def _with_birth(atlas: Atlas, piece: BirthPiece, increasing: tuple[str, ...]) -> Atlas:
    """The atlas with its last piece, and with the range of a coordinate that increases."""
    claim = atlas.claim
    if increasing:
        index = atlas.system.centre_coordinates.index(increasing[0])
        first, *_, last = (*atlas.curve_pieces(), atlas.curve_pieces()[-1])
        low, high = (float(each.point(Fraction(s))[index]) for each, s in ((first, -1), (last, 1)))
        unit = Fraction(10) ** (floor(log10(high - low)) - 4)
        covers = Covers(increasing[0], -(-Fraction(low) // unit) * unit, Fraction(high) // unit * unit)
        claim = replace(claim, covers=covers)
    *others, last = atlas.curve_pieces()
    wider = replace(last, tube=tuple(JOINT * width for width in last.tube))
    return replace(atlas, claim=claim, pieces=(*others, wider, piece))
