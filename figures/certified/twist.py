"""The twist along a certified curve from the stored functions of its sign, in double precision: for drawing only."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

import numpy as np

from orbitproof.figures.certified.curve import Stretch
from orbitproof.figures.orbits import Array, state_on_fixed_set
from orbitproof.shared.formats import Atlas
from orbitproof.verify.branches import Result
from orbitproof.verify.lasting import TwistFunctions
from orbitproof.verify.stability import REACH, StabilityFunctions

_STEP = 1e-6
_FLAT = 1e-6
"""A coordinate changes along a level if by more than so much of the length."""


def twist_on(stretch: Stretch, atlas: Atlas, results: Sequence[Result]) -> Array:
    """The twist of the orbits at the stretch's s in the coordinates of section 28.6; NaN where nothing is known."""
    found = np.full(len(stretch.s), np.nan)
    known = [each for each in results if each.piece == stretch.piece]
    for result in sorted(known, key=lambda each: each.interval[0] - each.interval[1]):
        if isinstance(result.stability, StabilityFunctions) and isinstance(result.twist, TwistFunctions):
            start, end = map(float, result.interval)
            inside = (stretch.s >= start) & (stretch.s <= end)
            tau = (stretch.s[inside] - (start + end) / 2) / ((end - start) / 2 * float(REACH))
            scale = _scale(stretch, atlas, (start + end) / 2)[inside]
            found[inside] = _twist(result.stability, result.twist, tau) / scale
    return found


def _twist(stability: StabilityFunctions, stored: TwistFunctions, tau: Array) -> Array:
    """In the coordinates of the level of section 29.2: (29.5), where |c|^3 = S^3 (Theta/Theta')^(1/2) by Lemma 29.3.

    Of odd maps (29.9).
    """
    s, first, second = (
        np.polynomial.polynomial.polyval(tau, [float(value) for value in each.coefficients] or [0.0])
        for each in (stability.characteristic[0], stored.twist, stored.exchanged)
    )
    with np.errstate(all="ignore"):
        size = np.sign(first) * np.sqrt(first * second)
        factor = 1.0 if stored.odd else 1 + 2 * s
        twist: Array = size / (64 * (1 - s * s) ** 2.5 * (1 - s) * factor)
    return np.where(np.abs(s) < 1, twist, np.nan)


def _scale(stretch: Stretch, atlas: Atlas, middle: float) -> Array:
    """How far the first coordinate goes along the level where that of section 29.2 goes on by 1."""
    system = atlas.system
    if system.family_parameter is not None:
        return np.ones(len(stretch.s))
    gradients = np.array([_gradient(atlas, point) for point in stretch.points])
    across = np.array([np.interp(middle, stretch.s, column) for column in gradients.T])
    along = np.array([-across[1], across[0]]) / hypot(*across)
    tangents = np.stack([-gradients[:, 1], gradients[:, 0]], axis=1)
    # The first coordinate by which orbits of the level are told apart.
    slopes = np.abs(tangents / np.hypot(*tangents.T)[:, None]).min(axis=0)
    first = int(slopes[0] < _FLAT)
    scale: Array = np.abs(tangents[:, first] / (tangents @ along))
    return scale


def _gradient(atlas: Atlas, point: Array) -> list[float]:
    """Derivatives of the first integral by the two coordinates on Fix(R)."""
    system, parameters = atlas.system, [float(atlas.parameters[name]) for name in atlas.system.parameters]
    assert system.first_integral is not None
    values = []
    for step in _STEP * np.eye(2):
        ends = [state_on_fixed_set(system, atlas.parameters, list(point + sign * step)) for sign in (1, -1)]
        first, second = (float(system.first_integral(end, parameters)[0]) for end in ends)
        values.append((first - second) / (2 * _STEP))
    return values
