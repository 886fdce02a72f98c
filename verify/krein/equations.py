"""The discriminant of Sigma as a function on a box, with its derivative (section 31.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from orbitproof.verify.evidence import MAX_ORDER, MultiIndex, index_factorial, indices_up_to
from orbitproof.verify.newton import BoxFunction, Jet
from orbitproof.verify.reversor_breaking import BreakingEnclosures

Matrix = list[list[arb]]
SIZE = 2
"""n: two pairs of multipliers meet."""


@dataclass(frozen=True)
class CollisionEquations:
    """pi_q P^m and the discriminant of Sigma as functions of p = (p_0, p_1, p_2) at q = 0; p_0 is h less its centre.

    Attributes:
        kernel: pi_q P^m, functions of p and q.
        image: the coordinates p' of P^m.
    """

    kernel: tuple[BoxFunction, ...]
    image: tuple[BoxFunction, ...]

    def values(self, where: Sequence[arb]) -> list[arb]:
        """Enclosures of pi_q P^m at all points with p in `where`."""
        return [function.value(_on_fixed_set(where)) for function in self.kernel]

    def slopes(self, where: Sequence[arb]) -> Matrix:
        """Enclosures of the derivatives of pi_q P^m in p: rows of 1 + n, the last n of them C."""
        places = range(1 + SIZE)
        return [[_derivative(function, where, place) for place in places] for function in self.kernel]

    def half(self, where: Sequence[arb]) -> arb_mat:
        """Enclosure of L, the derivative of P^m in (p_1, p_2, q) at fixed h."""
        return arb_mat([[_derivative(each, where, place) for place in _MOVING] for each in self._components])

    def half_slope(self, where: Sequence[arb], place: int) -> arb_mat:
        """Enclosure of the derivative of L in p_place."""
        return arb_mat([[_derivative(each, where, other, place) for other in _MOVING] for each in self._components])

    @property
    def _components(self) -> tuple[BoxFunction, ...]:
        return (*self.image, *self.kernel)

    def discriminant(self, where: Sequence[arb]) -> arb:
        """Enclosure of (tr Sigma)^2 - 4 det Sigma. Raises `ZeroDivisionError` if L is not shown to be regular."""
        half = self.half(where)
        ((a, b), (c, d)) = _block(2 * _square(half.inv()) * _square(half))
        return (a - d) * (a - d) + 4 * b * c

    def matrix(self, where: Sequence[arb]) -> Matrix:
        """Enclosure of the derivative of (pi_q P^m, discriminant): dSigma = 2 (dA' A + A' dA), dL^-1 = -L^-1 dL L^-1.

        Raises as `discriminant`.
        """
        half = self.half(where)
        inverse = half.inv()
        there, back = _square(half), _square(inverse)
        ((a, b), (c, d)) = _block(2 * back * there)
        last = []
        for place in range(1 + SIZE):
            slope = self.half_slope(where, place)
            moved = 2 * (_square(inverse * slope * inverse) * there * -1 + back * _square(slope))
            ((da, db), (dc, dd)) = _block(moved)
            last.append(2 * (a - d) * (da - dd) + 4 * (db * c + b * dc))
        return [*self.slopes(where), last]

    def jets(self, where: Sequence[arb]) -> tuple[Jet, ...]:
        """Jets of P^m at fixed h in (p_1, p_2, q), without constant terms, at the points with p in `where`."""
        at, variables = _on_fixed_set(where), 2 * SIZE
        indices = [index for index in indices_up_to(variables, MAX_ORDER) if any(index)]
        return tuple(
            Jet(
                variables,
                MAX_ORDER,
                {index: each.derivative((0, *index), at) / index_factorial(index) for index in indices},
            )
            for each in self._components
        )


def equations_of(found: BreakingEnclosures) -> CollisionEquations:
    """The equations of a claim from its enclosures, which are complete."""
    return CollisionEquations(*(tuple(map(BoxFunction, tables)) for tables in (found.iterates[-1], found.image)))


_MOVING = range(1, 1 + 2 * SIZE)
"""The variables at fixed h: p_1, p_2, and the q."""


def _on_fixed_set(where: Sequence[arb]) -> list[arb]:
    return [*where, *(arb(0) for _ in range(SIZE))]


def _derivative(function: BoxFunction, where: Sequence[arb], *places: int) -> arb:
    index: MultiIndex = tuple(places.count(i) for i in range(1 + 2 * SIZE))
    return function.derivative(index, _on_fixed_set(where))


def _square(matrix: arb_mat) -> arb_mat:
    """The block of the coordinates p_1, p_2: A of L, A' of its inverse."""
    return arb_mat([[matrix[i, j] for j in range(SIZE)] for i in range(SIZE)])


def _block(matrix: arb_mat) -> Matrix:
    return [[matrix[i, j] for j in range(SIZE)] for i in range(SIZE)]
