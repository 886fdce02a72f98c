"""A homoclinic orbit on all levels of an interval, as a claim for the verifier: polynomials through some levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction
from math import cos, pi

from orbitproof.explore.connections.claims import homoclinic_claim, short_above
from orbitproof.explore.connections.homoclinic import ConnectionFailure, Homoclinic, hyperbolic_orbit, refined
from orbitproof.shared.claims import HomoclinicCurve
from orbitproof.shared.numbers import round_dyadic

_LEVELS = 12
"""So many levels are looked at."""
_INTERVAL = Fraction(1, 2**17)
"""Least half-width of the interval of a, as a part of a: the polynomials have to follow the orbits so well."""
_WELL = Fraction(1, 64)
"""Coefficients that are a smaller part of what matters are left out."""
_BITS = 40
"""So many bits below it they end."""


def homoclinic_curve_claim(
    found: Homoclinic, name: str, near: float, digits: int, level_radius: Fraction
) -> HomoclinicCurve:
    """The claim about a homoclinic orbit, as `homoclinic_claim`, for all levels at most so far from its own.

    Raises `ConnectionFailure`.
    """
    middle = homoclinic_claim(found, name, near, digits)
    setting, half, (p, a) = found.orbit.setting, found.orbit.half, middle.centre
    times: list[Fraction] = []
    rows: list[list[Fraction]] = [[], [], []]
    for t in sorted((Fraction(cos(pi * (2 * k + 1) / (2 * _LEVELS))) for k in range(_LEVELS)), key=abs):
        if times:
            p, a = (_value(_through(times, row), t) for row in rows[:2])
        orbit = hyperbolic_orbit(replace(setting, level=setting.level + level_radius * t), p, half, digits)
        at = refined(orbit, a, middle.arrival, digits)
        times.append(t)
        for row, value in zip(rows, (orbit.p, at.distance, orbit.slope), strict=True):
            row.append(value)
    farthest = max(map(abs, rows[1]))
    interval = max(middle.radii[1], _INTERVAL * farthest)
    scales = interval, interval, middle.cone
    polynomials = tuple(_kept(_through(times, row), scale) for row, scale in zip(rows, scales, strict=True))
    if any(len(row) == _LEVELS for row in polynomials):
        raise ConnectionFailure("the orbits change too much from level to level; give a smaller --level-radius")
    given = {each.name: getattr(middle, each.name) for each in fields(middle)}
    c, start, slope = (row[0] for row in polynomials)
    given |= {"centre": (c, start), "slope": slope}
    given |= {"radii": (short_above(Fraction(3, 2) * farthest), short_above(interval))}
    powers = tuple(row[1:] or (Fraction(0),) for row in polynomials)
    return HomoclinicCurve(level_radius=level_radius, powers=powers, **given)


def _through(times: Sequence[Fraction], values: Sequence[Fraction]) -> list[Fraction]:
    """Coefficients of the polynomial with these values: Newton's divided differences."""
    differences = list(values)
    for order in range(1, len(times)):
        for i in range(len(times) - 1, order - 1, -1):
            differences[i] = (differences[i] - differences[i - 1]) / (times[i] - times[i - order])
    result: list[Fraction] = []
    for t, value in zip(reversed(times), reversed(differences), strict=True):
        # result (x - t) + value
        shifted = [Fraction(0), *result]
        result = [a - t * b for a, b in zip(shifted, [*result, Fraction(0)], strict=True)]
        result[0] += value
    return result


def _value(polynomial: Sequence[Fraction], t: Fraction) -> Fraction:
    value = Fraction(0)
    for coefficient in reversed(polynomial):
        value = value * t + coefficient
    return round_dyadic(value, 256)


def _kept(polynomial: Sequence[Fraction], scale: Fraction) -> tuple[Fraction, ...]:
    """The coefficients that matter, rounded to `_BITS` bits below the scale."""
    unit = Fraction(2) ** (scale.numerator.bit_length() - scale.denominator.bit_length() - _BITS)
    rounded = [round(value / unit) * unit for value in polynomial]
    while len(rounded) > 1 and abs(rounded[-1]) < _WELL * scale:
        rounded.pop()
    return tuple(rounded)
