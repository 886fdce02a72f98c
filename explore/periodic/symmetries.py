"""Linear symmetries of a vector field, and the periodic orbits that they map to themselves, in float64.

A symmetry here is an involution S of the state with f(S x) = S f(x). Signed permutations of the coordinates are looked
for; any other one can be given.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicProblem
from orbitproof.explore.periodic.flow import Matrix, arc_of, velocity_at

_MOST_PERMUTED = 6
"""Up to so many coordinates permutations are tried too, beyond it changes of sign alone."""
_AGREES = 1e-11
_FLAT = 1e-6
_INVARIANT = 1e-5
_MOVE = 0.0173
"""By so much the parameter that varies is changed: a symmetry must not need its value."""


@dataclass(frozen=True)
class Symmetry:
    """A linear involution of the state that is no identity.

    Attributes:
        rows: shape (N, N), exact.
    """

    rows: tuple[tuple[Fraction, ...], ...]

    @property
    def matrix(self) -> Matrix:
        """The rows in float64."""
        return np.array([[float(value) for value in row] for row in self.rows])

    def applied(self, vector: Sequence[Any]) -> list[Any]:
        """S v, for numbers of any kind that integers multiply and divide."""
        return [_sum(row, vector) for row in self.rows]

    def leaves(self, normal: Sequence[Fraction]) -> bool:
        """Whether sections with this normal are mapped to themselves, with their direction."""
        size = len(self.rows)
        image = [sum((normal[i] * self.rows[i][j] for i in range(size)), Fraction(0)) for j in range(size)]
        return image == list(normal)

    def normals(self) -> Iterator[tuple[Fraction, ...]]:
        """Normals of sections that are mapped to themselves, few of them."""
        size, known = len(self.rows), set()
        for j in range(size):
            normal = tuple(Fraction(int(i == j)) + self.rows[j][i] for i in range(size))
            largest = max(normal, key=abs)
            if largest:
                scaled = tuple(value / largest for value in normal)
                if scaled not in known:
                    known.add(scaled)
                    yield scaled

    def described(self, names: Sequence[str]) -> str:
        """The image of the state in words: (x, y, z) -> (-x, -y, z)."""
        return f"({', '.join(names)}) -> ({', '.join(_combination(row, names) for row in self.rows)})"


def _sum(row: Sequence[Fraction], vector: Sequence[Any]) -> Any:
    terms = [value * a.numerator / a.denominator for a, value in zip(row, vector, strict=True) if a]
    return sum(terms[1:], terms[0])


def _combination(row: Sequence[Fraction], names: Sequence[str]) -> str:
    terms = []
    for value, name in zip(row, names, strict=True):
        if value:
            size = "" if abs(value) == 1 else f"{abs(value)}*"
            terms.append((" - " if value < 0 else " + ") + size + name)
    text = "".join(terms)
    return "-" + text[3:] if text.startswith(" - ") else text[3:]


def is_symmetry(problem: PeriodicProblem, rows: Sequence[Sequence[Fraction]], parameter: str | None) -> bool:
    """Whether f(S x) = S f(x), and H(S x) = H(x), at some points, for several values of the parameter that varies."""
    matrix = np.array([[float(value) for value in row] for row in rows])
    return bool(np.allclose(matrix @ matrix, np.eye(len(matrix)), atol=1e-14)) and _commutes(
        problem, matrix, parameter, _points(len(matrix))
    )


def linear_symmetries(problem: PeriodicProblem, parameter: str | None) -> tuple[Symmetry, ...]:
    """The signed permutations that are symmetries of a system for all values of a parameter (`None`: of none)."""
    points = _points(len(problem.system.given_state))
    found = []
    for matrix in _involutions(len(problem.system.given_state)):
        if _commutes(problem, matrix, parameter, points):
            found.append(Symmetry(tuple(tuple(Fraction(int(value)) for value in row) for row in matrix)))
    return tuple(found)


def keeps_volume(problem: PeriodicProblem) -> bool:
    """Whether the vector field has no divergence at some points."""
    points, step = _points(len(problem.system.given_state)), 1e-4
    try:
        for point in points:
            terms = []
            for i in range(len(point)):
                shift = step * np.eye(len(point))[i]
                ahead, back = (velocity_at(problem.system, point + sign * shift, problem.values) for sign in (1, -1))
                terms.append((ahead[i] - back[i]) / (2 * step))
            if abs(sum(terms)) > _FLAT * (1 + sum(map(abs, terms))):
                return False
    except FlowFailure:
        return False
    return True


def _points(size: int) -> Matrix:
    return np.random.default_rng(7).uniform(0.3, 1.4, (3, size))


def _involutions(size: int) -> Iterator[Matrix]:
    """All signed permutations with square 1 that are not 1."""
    for places in _pairings(list(range(size))) if size <= _MOST_PERMUTED else [list(range(size))]:
        leading = [i for i in range(size) if i <= places[i]]
        for signs in product((1, -1), repeat=len(leading)):
            matrix = np.zeros((size, size))
            for i, sign in zip(leading, signs, strict=True):
                matrix[i, places[i]] = matrix[places[i], i] = sign
            if not np.array_equal(matrix, np.eye(size)):
                yield matrix


def _pairings(items: list[int]) -> Iterator[list[int]]:
    """All permutations of 0, .., n - 1 with square 1; the identity first."""
    size = len(items)

    def paired(left: list[int], places: dict[int, int]) -> Iterator[list[int]]:
        if not left:
            yield [places[i] for i in range(size)]
            return
        first, *rest = left
        yield from paired(rest, {**places, first: first})
        for other in rest:
            remaining = [i for i in rest if i != other]
            yield from paired(remaining, {**places, first: other, other: first})

    yield from paired(items, {})


def _commutes(problem: PeriodicProblem, matrix: Matrix, parameter: str | None, points: Matrix) -> bool:
    system, names = problem.system, list(problem.system.parameters)
    for number, point in enumerate(points):
        values = problem.values
        if parameter is not None:
            values[names.index(parameter)] *= 1 + number * _MOVE
            values[names.index(parameter)] += number * _MOVE
        try:
            left, right = velocity_at(system, matrix @ point, values), matrix @ velocity_at(system, point, values)
            gaps = [np.max(np.abs(left - right)) / (1 + np.max(np.abs(right)))]
            if system.first_integral_program is not None:
                image, here = problem.level(matrix @ point, values), problem.level(point, values)
                gaps.append(abs((image or 0.0) - (here or 0.0)) / (1 + abs(here or 0.0)))
        except FlowFailure:
            return False
        if not all(gap < _AGREES for gap in gaps):
            return False
    return True


def invariance(problem: PeriodicProblem, orbit: ClosedOrbit, symmetry: Symmetry) -> int | None:
    """How S maps an orbit to itself: 1: each point to itself; 2: to the one half a period later; `None`: not at all."""
    matrix, size = symmetry.matrix, orbit.size
    if np.max(np.abs(orbit.loop @ matrix.T - orbit.loop)) < _INVARIANT * size:
        return 1
    half = arc_of(problem.system, orbit.point, orbit.period / 2, orbit.values)
    return 2 if np.max(np.abs(matrix @ half.end - orbit.point)) < _INVARIANT * size else None
