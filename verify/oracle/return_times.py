"""About when the orbits of a piece return to the section, in float64 (section 5.3).

Nothing here carries proof. The orbits of a wide piece are followed in a time of their own, in which they return
almost together; any positive function of s would do.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.polynomial import chebyshev, polynomial

from orbitproof.verify.algebra import Arithmetic, Floats, Grading, Points, PreparedProgram, Series, WideArithmetic
from orbitproof.verify.oracle.centre import step_size
from orbitproof.verify.oracle.wide_solution import taylor_at_points

_NODES = 24
_DEGREE = 20
_LOG_TOLERANCE = -36.0
_SAMPLES = np.linspace(0.0, 1.0, 33)
_MOST_STEPS = 2000
_NEGLIGIBLE = 1e-9
_CENTRE = Grading((), 0)


def relative_return_times(
    program: PreparedProgram,
    arithmetic: Arithmetic,
    section: int,
    state: Sequence[Series],
    constants: Sequence[Series],
    crossing: int = 1,
) -> list[Fraction] | None:
    """See `poincare.Oracle.return_times`."""
    if not isinstance(arithmetic, WideArithmetic):
        return None
    nodes = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    start = np.array([_at_nodes(arithmetic, x, nodes) for x in state])
    fixed = np.array([_at_nodes(arithmetic, p, nodes) for p in constants])
    times = _return_times(program, section, start, fixed, crossing)
    if times is None:
        return None
    series = chebyshev.chebfit(nodes, times, _NODES - 1)
    large = np.flatnonzero(np.abs(series) > _NEGLIGIBLE * np.abs(series).max())
    powers = chebyshev.cheb2poly(series[: large[-1] + 1])
    if not (np.all(np.isfinite(powers)) and powers[0] > 0):
        return None
    return [Fraction(float(value)) for value in powers / powers[0]]


def _at_nodes(arithmetic: WideArithmetic, element: Series, nodes: Floats) -> Points:
    """Values of the known part of grade 0 at real s, shape (1, nodes)."""
    coefficients = arithmetic.unpack(element.coefs[0], arithmetic.bits, 1)[0]
    return np.asarray(polynomial.polyval(nodes, coefficients)[None], dtype=complex)


def _return_times(program: PreparedProgram, section: int, start: Points, fixed: Points, crossing: int) -> Floats | None:
    times = np.full(start.shape[-1], np.nan)
    side = np.zeros(start.shape[-1])
    count = np.zeros(start.shape[-1], dtype=int)
    elapsed = 0.0
    for _ in range(_MOST_STEPS * crossing):
        taylor = taylor_at_points(program, _CENTRE, start, fixed, _DEGREE)[:, :, 0].real
        if not np.all(np.isfinite(taylor)):
            return None
        size = step_size(np.abs(taylor).max(axis=-1).tolist(), _LOG_TOLERANCE, _DEGREE)
        powers = np.asarray(size ** np.arange(_DEGREE + 1))
        scaled: Floats = taylor * powers[None, :, None]
        values = polynomial.polyval(_SAMPLES, scaled[section])
        side = np.where(side == 0.0, np.sign(values[:, 1]), side)
        for node in np.flatnonzero(np.isnan(times)):
            for place in range(1, len(_SAMPLES)):
                if np.isnan(times[node]) and values[node, place] * side[node] < 0:
                    side[node] = -side[node]
                    count[node] += 1
                    if count[node] == crossing:
                        low, high = (float(value) for value in _SAMPLES[place - 1 : place + 1])
                        times[node] = elapsed + size * _root(scaled[section][:, node], low, high)
        if not np.any(np.isnan(times)):
            return times
        start = scaled.sum(axis=1)[:, None].astype(complex)
        elapsed += size
    return None


def _root(coefficients: Floats, low: float, high: float) -> float:
    """The zero of a polynomial between two points with opposite signs, by bisection."""
    positive = polynomial.polyval(low, coefficients) > 0
    for _ in range(50):
        middle = (low + high) / 2
        if (polynomial.polyval(middle, coefficients) > 0) == positive:
            low = middle
        else:
            high = middle
    return (low + high) / 2
