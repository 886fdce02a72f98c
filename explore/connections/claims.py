"""Homoclinic and heteroclinic orbits as claims for the verifier."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import ceil, log2

from orbitproof.explore.connections.heteroclinic import Heteroclinic, closer_pair
from orbitproof.explore.connections.homoclinic import Homoclinic, Hyperbolic, closer, slopes_at_arrival
from orbitproof.shared.claims import BoxClaim, HeteroclinicOrbit, HomoclinicOrbit
from orbitproof.shared.numbers import round_dyadic

_BOX = Fraction(3, 2)
"""The box reaches so many times as far as the homoclinic orbit begins."""
_INTERVAL = 2.0**-40
"""Least half-width of the interval of a, as a part of a: errors grow with the interval."""
_AROUND = 4
"""It is so many times as wide as the end of the unstable manifold is known."""
_BITS = 64
_SAME = 0.01
"""Orbits whose a differ by a smaller part of it are one, as their periodic orbits then."""
_WIDER = 4
"""The cone is so many times as wide as the samples ask for."""


def homoclinic_claim(found: Homoclinic, name: str, near: float, digits: int) -> HomoclinicOrbit:
    """The claim about a homoclinic orbit that begins at most at the distance `near` from the periodic orbit.

    Raises `ConnectionFailure`.
    """
    return _claimed(closer(found, near, digits), name, digits)


def heteroclinic_claim(found: Heteroclinic, name: str, near: float, digits: int) -> HeteroclinicOrbit:
    """The claim about a heteroclinic orbit between points at most at the distance `near` from the periodic orbits.

    Raises `ConnectionFailure`.
    """
    pair = closer_pair(found, near, digits)
    ends = [_claimed(end, name, digits) for end in pair.ends]
    # What s changes at the arrivals, and how far both a move with that.
    (p_1, q_1), (p_2, q_2) = map(slopes_at_arrival, pair.ends)
    wide = [2 * float(end.cone * abs(end.centre[1])) for end in ends]
    size = abs(p_1[0] * q_2[0] + p_2[0] * q_1[0])
    p, q = (sum(abs(each[1]) * width for each, width in zip(pq, wide, strict=True)) for pq in ((p_1, p_2), (q_1, q_2)))
    moved = [abs(q_2[0]) * p + abs(p_2[0]) * q, abs(q_1[0]) * p + abs(p_1[0]) * q]
    first, second = (
        replace(
            end,
            radii=(
                end.radii[0],
                short_above(max(Fraction(_INTERVAL) * abs(end.centre[1]), Fraction(_AROUND * by / size))),
            ),
        )
        for end, by in zip(ends, moved, strict=True)
    )
    return HeteroclinicOrbit.between(name, first, second)


def _claimed(at: Homoclinic, name: str, digits: int) -> HomoclinicOrbit:
    orbit, setting = at.orbit, at.orbit.setting
    system = setting.system
    scale = ceil(-log2(abs(at.distance)))
    a = round_dyadic(at.distance, _BITS)
    radius = short_above(_BOX * abs(a))
    cone = short_above(_WIDER * Fraction(_steepness(orbit, radius)))
    # What (a, s) with |s| <= 2 cone |a| changes at the arrival, as a part of what a changes there.
    along, across = slopes_at_arrival(at)[1]
    interval = max(_INTERVAL, _AROUND * 2 * float(cone) * abs(across / along))
    assert system.level_coordinate is not None
    return HomoclinicOrbit(
        id=name,
        system=system,
        parameters=dict(setting.parameters),
        reversing_symmetry=tuple(1 if sign > 0 else -1 for sign in system.reversing_symmetry),
        section=system.section,
        level=setting.level,
        level_coordinate=system.level_coordinate,
        level_sign=1 if setting.sign > 0 else -1,
        crossings=2 * orbit.half,
        arrival=at.crossings,
        slope=round_dyadic(orbit.slope, _BITS),
        cone=cone,
        centre=(round_dyadic(orbit.p, 2 * scale + _BITS), a),
        radii=(radius, short_above(Fraction(interval) * abs(a))),
        provenance={"digits": digits},
    )


def is_pair_claimed(found: Heteroclinic, claim: BoxClaim) -> bool:
    """As `is_claimed`, of both ends."""
    if not isinstance(claim, HeteroclinicOrbit):
        return False
    return all(is_claimed(each, end) for each, end in zip(found.ends, claim.ends, strict=True))


def is_claimed(found: Homoclinic, claim: BoxClaim) -> bool:
    """Whether a claim is about this orbit, from some point of the unstable manifold, as far as its rounded a tells."""
    if not isinstance(claim, HomoclinicOrbit):
        return False
    orbit, setting = found.orbit, found.orbit.setting
    given = setting.system.name, setting.parameters, setting.level, setting.sign, 2 * orbit.half
    if given != (claim.system.name, claim.parameters, claim.level, claim.level_sign, claim.crossings):
        return False
    returns, rest = divmod(claim.arrival - found.crossings, 2 * orbit.half)
    a = float(claim.centre[1]) * float(orbit.multiplier) ** returns
    same = float(claim.centre[0] - orbit.p), float(found.distance) - a
    return rest == 0 and max(map(abs, same)) < _SAME * abs(a)


def short_above(value: Fraction) -> Fraction:
    """A positive number with few digits, up to an eighth larger than a given one."""
    exponent = ceil(-log2(value)) + 3
    return Fraction(ceil(value * Fraction(2) ** exponent)) / Fraction(2) ** exponent


def _steepness(orbit: Hyperbolic, radius: Fraction) -> float:
    """The greatest slope, in (a, s), of images of the unstable direction at the corners of the box."""
    bits = 64 + 2 * ceil(-log2(radius))
    steepest = 0.0
    for a, s in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        p = orbit.p + radius * (a + s)
        q = orbit.slope * radius * (a - s)
        for number, place in enumerate(orbit.setting.crossings(p, q, [(1, orbit.slope)], bits), start=1):
            if number == 2 * orbit.half:
                along, across = (float(slopes[0]) for slopes in place.slopes)
                across /= float(orbit.slope)
                steepest = max(steepest, abs((along - across) / (along + across)))
                break
    return max(steepest, 2.0**-_BITS)
