"""The normal form to order 3 of a reversible map at an elliptic fixed point, n = 2 (sections 30.2 to 30.4)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from flint import acb, acb_mat, arb, arb_mat

from orbitproof.verify.evidence import MultiIndex, dot, indices_of_degree
from orbitproof.verify.newton import Jet
from orbitproof.verify.newton.jets import plus, unit

Matrix = Sequence[Sequence[arb]]
Polynomial = Mapping[MultiIndex, acb]
"""Coefficients of a polynomial in (z_1, z_2, conj z_1, conj z_2), up to degree 3 and without constant term."""

_SIZE = 4
COMBINATIONS = tuple(
    (k, l)
    for order in range(1, 5)
    for k in range(order + 1)
    for l in ((order - k, k - order) if 0 < k < order else (order - k,))
)
"""All (k_1, k_2) with 0 < |k_1| + |k_2| <= 4, one of each pair k, -k."""


@dataclass(frozen=True)
class EllipticPoint:
    """Complex coordinates in which the derivative of a reversible map is diagonal (Lemma 30.1).

    Attributes:
        cosines: s_1 < s_2, in (-1, 1).
        multipliers: s_j + i (1 - s_j^2)^(1/2).
        covectors: rows l_1, l_2; z_j = l_j (p, q), the first half real, the second imaginary.
    """

    cosines: tuple[arb, arb]
    multipliers: tuple[acb, acb]
    covectors: tuple[tuple[acb, ...], tuple[acb, ...]]


def determinant_of(jets: Sequence[Jet]) -> arb:
    """Determinant of the derivative of a map."""
    found: arb = arb_mat(_derivative(jets)).det()
    return found


def trace_and_determinant(jets: Sequence[Jet]) -> tuple[arb, arb]:
    """Trace and determinant of the p, p part of the derivative: s_1 + s_2 and s_1 s_2 (Lemma 30.1)."""
    m = _derivative(jets)
    return m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]


def elliptic_point(jets: Sequence[Jet]) -> EllipticPoint:
    """The diagonal coordinates of a map that is known to be elliptic with two different cosines.

    Raises `ZeroDivisionError` where an eigenvector is not enclosed.
    """
    trace, determinant = trace_and_determinant(jets)
    root = (trace * trace / 4 - determinant).sqrt()
    cosines = trace / 2 - root, trace / 2 + root
    sines = [(1 - s * s).sqrt() for s in cosines]
    first, second = (_covector(_derivative(jets), s, t) for s, t in zip(cosines, sines, strict=True))
    multipliers = acb(cosines[0], sines[0]), acb(cosines[1], sines[1])
    return EllipticPoint(cosines, multipliers, (first, second))


def _derivative(jets: Sequence[Jet]) -> list[list[arb]]:
    return [[jet[unit(_SIZE, j)] for j in range(_SIZE)] for jet in jets]


def _covector(m: Matrix, s: arb, sine: arb) -> tuple[acb, ...]:
    """(a, i b) with a M_pp = s a and b = -a M_pq / sine, a of length 1."""
    choices = [(m[1][0], s - m[0][0]), (s - m[1][1], m[0][1])]
    a = max(choices, key=lambda pair: float((pair[0] * pair[0] + pair[1] * pair[1]).mid()))
    length = (a[0] * a[0] + a[1] * a[1]).sqrt()
    a = a[0] / length, a[1] / length
    b = [-dot(a, [m[0][j], m[1][j]]) / sine for j in (2, 3)]
    return acb(a[0]), acb(a[1]), acb(0, b[0]), acb(0, b[1])


def in_coordinates(jets: Sequence[Jet], point: EllipticPoint) -> tuple[dict[MultiIndex, acb], dict[MultiIndex, acb]]:
    """The components z_1, z_2 of the map in the coordinates of an elliptic point.

    Raises `ZeroDivisionError` if these are not shown to be coordinates.
    """
    rows = [list(row) for row in point.covectors]
    rows += [[value.conjugate() for value in row] for row in rows]
    inverse = acb_mat(rows).inv()
    linear = [{unit(_SIZE, j): inverse[i, j] for j in range(_SIZE)} for i in range(_SIZE)]
    images = [substituted({i: acb(value) for i, value in jet.coefficients.items() if any(i)}, linear) for jet in jets]
    first, second = (_combined(zip(row, images, strict=True)) for row in point.covectors)
    return first, second


def torsion(functions: Sequence[Polynomial], multipliers: Sequence[acb]) -> list[list[acb]]:
    """t_jl with N_j = lambda_j z_j (1 + t_j1 |z_1|^2 + t_j2 |z_2|^2) + .. the normal form of a map (Lemma 30.3).

    For a reversible map t_jl = i tau_jl with a real tau_jl. Raises `ZeroDivisionError` at a resonance of order 3.
    """
    whole = [*multipliers, *(value.conjugate() for value in multipliers)]
    changes: list[dict[MultiIndex, acb]] = []
    for j, function in enumerate(functions):
        change = {unit(_SIZE, j): acb(1)}
        for index in indices_of_degree(_SIZE, 2):
            change[index] = _at(function, index) / (_monomial(whole, index) - multipliers[j])
        changes.append(change)
    changes += [_conjugate(change) for change in changes]
    found = []
    for j, function in enumerate(functions):
        cubic = substituted(function, changes)
        resonant = [plus(unit(_SIZE, j), plus(unit(_SIZE, l), unit(_SIZE, l + 2))) for l in range(2)]
        found.append([_at(cubic, index) * multipliers[j].conjugate() for index in resonant])
    return found


def substituted(function: Polynomial, arguments: Sequence[Polynomial]) -> dict[MultiIndex, acb]:
    """A polynomial of polynomials, up to degree 3."""
    terms: list[tuple[acb, Polynomial]] = []
    for index, value in function.items():
        factors = [arguments[i] for i, power in enumerate(index) for _ in range(power)]
        result = factors[0]
        for factor in factors[1:]:
            result = _product(result, factor)
        terms.append((value, result))
    return _combined(iter(terms))


def _product(left: Polynomial, right: Polynomial) -> dict[MultiIndex, acb]:
    result: dict[MultiIndex, acb] = {}
    for (a, x), (b, y) in product(left.items(), right.items()):
        if sum(a) + sum(b) <= 3:
            index = plus(a, b)
            result[index] = result.get(index, acb(0)) + x * y
    return result


def _combined(terms: Iterator[tuple[acb, Polynomial]]) -> dict[MultiIndex, acb]:
    result: dict[MultiIndex, acb] = {}
    for factor, polynomial in terms:
        for index, value in polynomial.items():
            result[index] = result.get(index, acb(0)) + factor * value
    return result


def _conjugate(polynomial: Polynomial) -> dict[MultiIndex, acb]:
    """The complex conjugate, as a polynomial in the same variables."""
    return {(*index[2:], *index[:2]): value.conjugate() for index, value in polynomial.items()}


def _at(polynomial: Polynomial, index: MultiIndex) -> acb:
    return polynomial.get(index, acb(0))


def _monomial(values: Sequence[acb], index: MultiIndex) -> acb:
    result = acb(1)
    for value, power in zip(values, index, strict=True):
        for _ in range(power):
            result = result * value
    return result


def combination(multipliers: Sequence[acb], k: tuple[int, int]) -> acb:
    """lambda_1^k_1 lambda_2^k_2 for multipliers on the unit circle."""
    whole = [*multipliers, *(value.conjugate() for value in multipliers)]
    return _monomial(whole, (max(k[0], 0), max(k[1], 0), max(-k[0], 0), max(-k[1], 0)))
