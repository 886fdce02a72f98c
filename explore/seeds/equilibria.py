"""Symmetric equilibria, and the small periodic orbits that linearisation gives around them."""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.seeds.first_orbit import FirstOrbit
from orbitproof.shared.systems import ReversibleSystem, with_functions

Array = NDArray[np.float64]

AMPLITUDE = 1e-3
"""Amplitude of the first orbit of a family that is born at an equilibrium."""

_FUNCTIONS = {"sin": cmath.sin, "cos": cmath.cos, "exp": cmath.exp, "log": cmath.log}
_STEPS = 50
_ACCURACY = 1e-12
_ELLIPTIC = 1e-7


class EquilibriumFailure(Exception):
    """There is no symmetric equilibrium near the guess, or no elliptic pair; one line says why."""


def small_orbits(
    system: ReversibleSystem, parameters: Mapping[str, float], guess: Mapping[str, float]
) -> list[FirstOrbit]:
    """A small orbit for each elliptic pair of the symmetric equilibrium near `guess`, the fastest first.

    To first order in the amplitude; the direction is the one in which the amplitude grows.

    Arguments:
        parameters: the fixed parameters.
        guess: centre coordinates by name; those not named are 0.

    Raises `EquilibriumFailure`.
    """
    if system.first_integral is None:
        raise EquilibriumFailure(f"{system.name} has no first integral: no families of orbits begin at an equilibrium")
    if system.family_parameter is not None:
        raise EquilibriumFailure(
            f"small orbits about an equilibrium of {system.name} lie on other levels; leave family_parameter and "
            "fixed_level out of its file to find them, or start from an orbit"
        )
    point = np.array([guess.get(name, 0.0) for name in system.centre_coordinates])
    fixed = list(system.fixed_coordinates)
    # On Fix(R) the others vanish.
    equations = [i for i, sign in enumerate(system.reversing_symmetry) if sign == -1 and system.is_given(i)]
    values = [parameters[name] for name in system.parameters]
    for _ in range(_STEPS):
        state = np.zeros(len(system.given_state), dtype=complex)
        state[fixed] = point
        value, matrix = _derivatives(system, state, values)
        step = np.linalg.lstsq(matrix[np.ix_(equations, fixed)], value[equations], rcond=None)[0]
        point = point - step
        if not np.all(np.isfinite(point)):
            break
        if float(np.linalg.norm(step)) < _ACCURACY * (1 + float(np.linalg.norm(point))):
            return _pairs(system, point, matrix)
    raise EquilibriumFailure("Newton's method finds no equilibrium on Fix(R) there; give coordinates closer to one")


def _derivatives(system: ReversibleSystem, state: np.ndarray, values: Sequence[float]) -> tuple[Array, Array]:
    """The field and its derivatives, of the coordinates that are given, by complex steps, which lose no digits."""
    step = 1e-30
    columns: list[np.ndarray] = []
    given, further = len(state), [0j] * len(system.defined)
    for shift in np.eye(len(state)) * 1j * step:
        try:
            whole = with_functions(system, [*(state + shift).tolist(), *further], values, _FUNCTIONS)
            columns.append(np.array(system.vector_field(whole, values)[:given], dtype=complex))
        except (ArithmeticError, ValueError):
            raise EquilibriumFailure("the field is not defined there; give coordinates closer to one") from None
    return columns[0].real.copy(), np.array([column.imag / step for column in columns]).T


def _pairs(system: ReversibleSystem, point: Array, matrix: Array) -> list[FirstOrbit]:
    values, vectors = np.linalg.eig(matrix)
    size = max(1.0, float(np.max(np.abs(values))))
    signs = np.array(system.reversing_symmetry[: len(values)], dtype=float)
    chosen = [i for i in range(len(values)) if abs(values[i].real) < _ELLIPTIC * size < values[i].imag]
    frequencies = sorted((float(values[i].imag) for i in chosen), reverse=True)
    if not chosen:
        raise EquilibriumFailure("the equilibrium has no elliptic pair, so that no small orbits are around it")
    if any(a - b < 1e-6 * size for a, b in pairwise(frequencies)):
        raise EquilibriumFailure(
            "two pairs have the same frequency; start from an orbit: give its point and --half-period"
        )
    found = []
    for i in sorted(chosen, key=lambda i: -values[i].imag):
        vector = vectors[:, i]
        largest = int(np.argmax(np.abs(vector)))
        # R v is a multiple of the conjugate of v; turned by half its angle, the real part of v lies in Fix(R).
        turn = signs[largest] * vector[largest] / np.conj(vector[largest])
        real = (vector * np.exp(-0.5j * np.angle(turn))).real[list(system.fixed_coordinates)]
        direction = real * np.sign(real[int(np.argmax(np.abs(real)))]) / np.linalg.norm(real)
        place = point + AMPLITUDE * direction
        found.append(FirstOrbit(tuple(place.tolist()), float(np.pi / values[i].imag), tuple(direction.tolist())))
    return found
