"""Reversible maps of the plane: Taylor coefficients of return maps, and their normal form in complex numbers.

Nothing here takes part in a proof, and nothing is taken from the code under test but the class of numbers' protocol.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import product
from math import exp, factorial, pi, sqrt

import numpy as np
from scipy.integrate import solve_ivp

Taylor = Mapping[tuple[int, int], float]

INDICES = [(i, j) for i in range(4) for j in range(4) if 0 < i + j <= 3]


class Number(float):
    """A float that the code under test takes for a function."""

    def __add__(self, other: float) -> Number:
        return Number(float(self) + float(other))

    def __sub__(self, other: float) -> Number:
        return Number(float(self) - float(other))

    def __mul__(self, other: float) -> Number:
        return Number(float(self) * float(other))

    def scaled(self, factor: Fraction) -> Number:
        """The product with a number."""
        return Number(float(self) * float(factor))


def random_taylor(source: random.Random) -> dict[tuple[int, int], Number]:
    """Random coefficients up to order 3."""
    return {index: Number(source.uniform(-1, 1)) for index in INDICES}


def coefficients(first: Taylor, second: Taylor) -> tuple[complex, complex, complex]:
    """c_1 of w^2 conj(w), d of conj(w)^3 and g_02, in the coordinate w = (c p + i S q)/(2 c S), order 2 taken away."""
    s, c = float(first[1, 0]), float(second[1, 0])
    size = sqrt(1 - s * s)
    value = complex(s, size)
    component = (1 / (2 * size), 1j / (2 * c))
    out = (complex(size), -1j * c)
    bar = (out[0].conjugate(), out[1].conjugate())

    def g(*vectors: tuple[complex, complex]) -> complex:
        total, order = 0j, len(vectors)
        for chosen in product((0, 1), repeat=order):
            term = 1 + 0j
            for vector, which in zip(vectors, chosen, strict=True):
                term *= vector[which]
            index = (order - sum(chosen), sum(chosen))
            factor = factorial(index[0]) * factorial(index[1])
            term *= sum(part * float(jet[index]) * factor for part, jet in zip(component, (first, second), strict=True))
            total += term
        return total

    g20, g11, g02, g21, g03 = g(out, out), g(out, bar), g(bar, bar), g(out, out, bar), g(bar, bar, bar)
    back = value.conjugate()
    h20, h11, h02 = g20 / (value**2 - value), g11 / (1 - value), g02 / (back**2 - value)
    c_1 = g21 / 2 + g20 * h11 + g11 * (h11.conjugate() + h20 / 2) + g02 * h02.conjugate() / 2
    d = g03 / 6 + g11 * h02 / 2 + g02 * h20.conjugate() / 2
    return c_1, d, g02


def turning(step: Callable[[float, float], tuple[float, float]], c: float, size: float, start: float, n: int) -> float:
    """The mean angle by which iterates turn in w, over n of them with smooth weights."""
    p, q = start, 0.0
    places = [complex(c * p, size * q)]
    for _ in range(n):
        p, q = step(p, q)
        places.append(complex(c * p, size * q))
    z = np.array(places)
    angles = np.mod(np.angle(z[1:] / z[:-1]), 2 * pi)
    weights = [exp(-1 / (t * (1 - t))) for t in np.arange(1, n + 1) / (n + 1)]
    return float(np.average(angles, weights=weights))


def falkner_skan_half_return(beta: float, y: float, time: float) -> tuple[dict[tuple[int, int], float], ...]:
    """Taylor coefficients of (y, x) at z = 0 after half an orbit, by increments of y and x of the start.

    Integrated as polynomials in the increments, of degree 3, and brought onto the section by Newton's method.
    """
    indices = [(0, 0), *INDICES]
    place = {index: number for number, index in enumerate(indices)}
    pairs = [
        (place[a], place[b], place[a[0] + b[0], a[1] + b[1]]) for a in indices for b in indices if sum(a) + sum(b) <= 3
    ]
    left, right, target = (np.array(row) for row in zip(*pairs, strict=True))

    def times(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.bincount(target, a[left] * b[right], len(indices))

    one = np.eye(len(indices))[0]

    def field(state: np.ndarray) -> np.ndarray:
        x, u, z = state.reshape(3, -1)
        return np.concatenate([u, z, beta * (times(u, u) - one) - times(x, z)])

    start = np.zeros((3, len(indices)))
    start[0, place[0, 1]] = 1.0
    start[1, place[0, 0]], start[1, place[1, 0]] = y, 1.0
    found = solve_ivp(lambda t, state: field(state), (0, time), start.ravel(), method="DOP853", rtol=1e-13, atol=1e-13)
    state = found.y[:, -1]
    for _ in range(4):
        # The time to the section as a polynomial in the increments, and the flow for that time as a series in it.
        first, second, third = field(state), _second(field, state), _third(field, state)
        z, dz = (row.reshape(3, -1)[2] for row in (state, first))
        inverse = one / dz[0]
        for _ in range(3):
            inverse = times(inverse, 2 * one - times(dz, inverse))
        delay = -times(z, inverse)
        square = times(delay, delay)
        parts = (delay, square / 2, times(square, delay) / 6)
        moves = zip(parts, (first, second, third), strict=True)
        state = state + sum(np.concatenate([times(part, row) for row in rate.reshape(3, -1)]) for part, rate in moves)
    x, u, _ = state.reshape(3, -1)
    return tuple({index: float(row[place[index]]) for index in indices} for row in (u, x))


_STEP = 1e-3


def _second(field: Callable[[np.ndarray], np.ndarray], state: np.ndarray) -> np.ndarray:
    """The second derivative by time along the flow; exact for fields of degree 2."""
    rate = _STEP * field(state)
    return (field(state + rate) - field(state - rate)) / (2 * _STEP)


def _third(field: Callable[[np.ndarray], np.ndarray], state: np.ndarray) -> np.ndarray:
    """The third derivative."""
    rate = _STEP * field(state)
    return (_second(field, state + rate) - _second(field, state - rate)) / (2 * _STEP)
