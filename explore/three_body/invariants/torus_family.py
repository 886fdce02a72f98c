"""Families of invariant tori at a fixed Jacobi constant, from an elliptic periodic orbit until the method fails."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import islice
from math import acos, pi

import numpy as np

from orbitproof.explore.flow import Matrices, Vector, flow_batch
from orbitproof.explore.numerics import NoStep, walked
from orbitproof.explore.orbits import SymmetricOrbit
from orbitproof.explore.three_body.invariants.curve import InvariantCurve, NoCurve, correct, measured, returns, tangent
from orbitproof.shared.systems import CR3BP

FIRST_STEP = 1e-3
SMALLEST_STEP = 1e-5
FIRST_MODES, MOST_MODES = 8, 60
TAIL = 1e-8
"""More modes are taken where the upper fourth of them is larger than this part of the largest."""
ERROR = 1e-8
"""A curve that is invariant to no better than this is no longer believed, and the family ends."""


@dataclass(frozen=True)
class TorusFamily:
    """Invariant curves by increasing amplitude.

    Attributes:
        orbit: the periodic orbit that they surround, at the point `centre` of the section.
        centre: shape (4,), x, z, vx, vz.
        stability: the stability parameter whose plane they start in.
        curves: the curves, each with its error of invariance.
        reason: why the family ends; "interrupted" if a key or signal did that, with the curves found until then.
    """

    orbit: SymmetricOrbit
    centre: Vector
    stability: float
    curves: tuple[InvariantCurve, ...]
    reason: str


def first_curve(orbit: SymmetricOrbit, mass: float, index: int, amplitude: float) -> tuple[InvariantCurve, float]:
    """A small circle in the plane of an elliptic pair of multipliers, and the stability parameter of the pair.

    Arguments:
        index: which of the elliptic pairs, 0 the one with the smallest stability parameter.

    Raises `NoCurve` if the orbit has no such pair.
    """
    elliptic = sorted(s.real for s in orbit.stability if s.imag == 0 and -1 < s.real < 1)
    if index >= len(elliptic):
        listed = ", ".join(f"{s:.6g}" if s.imag else f"{s.real:.6g}" for s in orbit.stability)
        raise NoCurve(f"elliptic pairs of multipliers: {len(elliptic)}; stability parameters: {listed}")
    x, z, vy = orbit.unknowns[:3]
    side = 1.0 if vy > 0 else -1.0
    assert orbit.first_integral is not None
    point = np.array([[x, z, 0.0, 0.0]])
    _, derivatives, _, late = returns(point, np.array([orbit.period]), mass, orbit.first_integral, side)
    if late[0] > 1e-6:
        raise NoCurve("the orbit does not return to the section after its period")
    vector, angle = _elliptic_vector(derivatives, elliptic[index])
    even, odd = np.zeros((2, FIRST_MODES + 1)), np.zeros((2, FIRST_MODES))
    even[:, 0] = point[0, :2]
    even[:, 1] = amplitude * vector.real[:2]
    odd[:, 0] = -amplitude * vector.imag[2:]
    times = np.full(2 * FIRST_MODES + 1, orbit.period)
    return InvariantCurve(mass, orbit.first_integral, side, even, odd, angle, times), elliptic[index]


def _elliptic_vector(derivatives: Matrices, stability: float) -> tuple[np.ndarray, float]:
    """The eigenvector w of the multiplier next to exp(i acos(s)) with R w = conj(w), of length one, and its angle."""
    values, vectors = np.linalg.eig(derivatives[0])
    wanted = acos(stability)
    index = int(np.argmin(np.abs(values - np.exp(1j * wanted))))
    vector = vectors[:, index]
    lead = vector[int(np.argmax(np.abs(vector[:2])))]
    vector = vector * (abs(lead) / lead)
    return vector / np.linalg.norm(vector), float(np.angle(values[index]))


def trace_tori(
    orbit: SymmetricOrbit,
    mass: float,
    *,
    index: int = 0,
    largest_step: float = 0.01,
    most: int = 40,
    progress: Callable[[str, float], None] | None = None,
) -> TorusFamily:
    """Tori around an elliptic symmetric orbit of the CR3BP, at its Jacobi constant.

    Arguments:
        index: which elliptic pair of multipliers, counted from 0 by stability parameter.
        largest_step: along the family, in Fourier coefficients.
        most: number of curves.

    Raises `NoCurve` if not even a first curve is found.
    """
    guess, stability = first_curve(orbit, mass, index, FIRST_STEP)
    direction = guess.unknowns.copy()
    direction[[0, guess.modes + 1, -1]] = 0.0
    direction /= np.linalg.norm(direction)
    curve = correct(guess, direction)
    curves = [replace(curve, error=measured(curve))]
    directions, reason = [tangent(curve, direction)], f"{most} curves"

    def advance(step: float) -> tuple[tuple[InvariantCurve, Vector], float]:
        if progress is not None:
            progress(f"{len(curves)} tori, amplitude {curves[-1].amplitude:.3g}", len(curves) / most)
        across = directions[-1]
        found = correct(curves[-1].with_unknowns(curves[-1].unknowns + step * across, curves[-1].times), across)
        if found.tail > TAIL and found.modes < MOST_MODES:
            found, across = _finer(found, across)
        error = measured(found)
        while error > ERROR and found.modes < MOST_MODES:
            found, across = _finer(found, across, always=True)
            error = measured(found)
        if error > ERROR:
            raise NoCurve(f"the error of invariance grows to {error:.1e} with {found.modes} modes")
        ahead = tangent(found, _padded(across, found.modes))
        return (replace(found, error=error), ahead), min(1.5 * step, largest_step)

    try:
        steps = walked(advance, 2 * FIRST_STEP, SMALLEST_STEP, (NoCurve,))
        for curve, ahead in islice(steps, max(0, most - 1)):
            curves.append(curve)
            directions.append(ahead)
    except NoStep as failure:
        reason = f"steps shorter than {SMALLEST_STEP:g}: {failure}"
    except KeyboardInterrupt:
        reason = "interrupted"
    centre = np.array([orbit.unknowns[0], orbit.unknowns[1], 0.0, 0.0])
    return TorusFamily(orbit, centre, stability, tuple(curves), reason)


def _finer(curve: InvariantCurve, direction: Vector, *, always: bool = False) -> tuple[InvariantCurve, Vector]:
    """The curve and the direction with half as many modes more, corrected again, until there are enough."""
    while always or (curve.tail > TAIL and curve.modes < MOST_MODES):
        always = False
        more = min(MOST_MODES, curve.modes + max(4, curve.modes // 2))
        direction = _padded(direction, more)
        curve = correct(curve.with_modes(more), direction)
    return curve, direction


def _padded(direction: Vector, modes: int) -> Vector:
    """A direction in the unknowns of a curve with more modes."""
    own = (len(direction) - 3) // 4
    if own == modes:
        return direction
    pad = ((0, 0), (0, modes - own))
    even = np.pad(direction[: 2 * own + 2].reshape(2, -1), pad)
    odd = np.pad(direction[2 * own + 2 : -1].reshape(2, -1), pad)
    return np.concatenate([even.ravel(), odd.ravel(), direction[-1:]])


def frequencies(curve: InvariantCurve) -> tuple[float, float]:
    """The two frequencies of the torus, radians per unit of time: along the orbits, and around them."""
    mean = float(np.mean(curve.times))
    return 2 * pi / mean, curve.rotation / mean


def surface_of(curve: InvariantCurve, around: int = 48, along: int = 96) -> np.ndarray:
    """Places on the torus, shape (around, along, 3): orbits from `around` points of the curve, for one return each."""
    angles = np.arange(around) * 2 * pi / around
    states = curve.states(angles)
    times = np.interp(angles, np.append(curve.angles, 2 * pi), np.append(curve.times, curve.times[0]))
    parameters = np.full((around, 1), curve.mass)
    rows = [states]
    for _ in range(along - 1):
        states = flow_batch(CR3BP, states, times / (along - 1), parameters).states
        rows.append(states)
    return np.stack(rows, axis=1)[:, :, :3]
