"""Coefficients of a Neimark-Sacker bifurcation, from derivatives of the return map (sections 25.9 and 25.10)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from flint import acb, acb_mat, arb

from orbitproof.verify.evidence import MultiIndex

Derivatives = Sequence[Mapping[MultiIndex, arb]]
"""For each component of the map its partial derivatives up to order 3 in (p_0, .., p_{n-1}, a), by multi-index."""


@dataclass(frozen=True)
class TorusCoefficients:
    """What decides on which side of the parameter there is an invariant curve, and whether it attracts.

    Attributes:
        lyapunov: d = Re(conj(lambda) c_1); its sign is the same for all eigenvectors and coordinates.
        speed: the derivative of the absolute value of the multiplier along the curve of fixed points.
    """

    lyapunov: arb
    speed: arb


def coefficients_of_torus(derivatives: Derivatives, multiplier: acb, eigenvector: Sequence[acb]) -> TorusCoefficients:
    """Enclosures of d and of the speed of the multiplier at a fixed point.

    Arguments:
        derivatives: enclosures at the fixed point.
        multiplier: lambda, of absolute value 1.
        eigenvector: w with A w = lambda w, A the derivative by p; shape (n,).

    Raises `ZeroDivisionError` unless lambda is shown to be simple, and neither 1 nor lambda^2 to be an eigenvalue.
    """
    size, w = len(eigenvector), list(eigenvector)
    conjugate = [each.conjugate() for each in w]
    matrix = [[acb(table[_index(size, j)]) for j in range(size)] for table in derivatives]
    left = _left_eigenvector(matrix, multiplier, w)
    mixed = _solved(matrix, acb(1), _second(derivatives, w, conjugate))
    double = _solved(matrix, multiplier * multiplier, _second(derivatives, w, w))
    cubic = [
        third + 2 * first + second
        for third, first, second in zip(
            _third(derivatives, w, w, conjugate),
            _second(derivatives, w, mixed),
            _second(derivatives, conjugate, double),
            strict=True,
        )
    ]
    moved = _solved(matrix, acb(1), [acb(table[_index(size, size)]) for table in derivatives])
    turned = [
        by_point + _sum(table[_index(size, j, size)] * w[j] for j in range(size))
        for by_point, table in zip(_second(derivatives, moved, w), derivatives, strict=True)
    ]
    back = multiplier.conjugate()
    return TorusCoefficients((back * _dot(left, cubic)).real / 2, (back * _dot(left, turned)).real)


def _index(size: int, *places: int) -> MultiIndex:
    """The multi-index of derivatives in these variables, `size` being the place of the parameter."""
    return tuple(places.count(position) for position in range(size + 1))


def _second(derivatives: Derivatives, x: Sequence[acb], y: Sequence[acb]) -> list[acb]:
    """B(x, y), B the second derivative by p."""
    n = range(len(x))
    return [_sum(table[_index(len(x), j, k)] * x[j] * y[k] for j in n for k in n) for table in derivatives]


def _third(derivatives: Derivatives, x: Sequence[acb], y: Sequence[acb], z: Sequence[acb]) -> list[acb]:
    """C(x, y, z), C the third derivative by p."""
    n, size = range(len(x)), len(x)
    return [
        _sum(table[_index(size, j, k, m)] * x[j] * y[k] * z[m] for j in n for k in n for m in n)
        for table in derivatives
    ]


def _solved(matrix: Sequence[Sequence[acb]], value: acb, right: Sequence[acb]) -> list[acb]:
    """(value - A)^-1 applied to a vector."""
    shifted = [[int(i == j) * value - entry for j, entry in enumerate(row)] for i, row in enumerate(matrix)]
    return _column(acb_mat(shifted).solve(acb_mat([[entry] for entry in right])))


def _left_eigenvector(matrix: Sequence[Sequence[acb]], value: acb, w: Sequence[acb]) -> list[acb]:
    """The l with l A = value l and l w = 1."""
    size = len(w)
    shifted = [[entry - int(i == j) * value for j, entry in enumerate(row)] for i, row in enumerate(matrix)]
    bordered = [[*row, w[i]] for i, row in enumerate(shifted)]
    bordered.append([*(entry.conjugate() for entry in w), acb(0)])
    right = acb_mat([[acb(int(i == size))] for i in range(size + 1)])
    return _column(acb_mat(bordered).transpose().solve(right))[:size]


def _column(matrix: acb_mat) -> list[acb]:
    return [matrix[i, 0] for i in range(matrix.nrows())]


def _dot(left: Sequence[acb], right: Sequence[acb]) -> acb:
    return _sum(a * b for a, b in zip(left, right, strict=True))


def _sum(terms: Iterable[acb]) -> acb:
    return sum(terms, acb(0))
