"""The equations of points at which R is lost, and the coefficients there (sections 27.3 and 27.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from orbitproof.verify.evidence import (
    MultiIndex,
    dot,
    index_factorial,
    indices_of_degree,
    total,
)
from orbitproof.verify.newton import BoxFunction, bordered, bordering, left_kernel, newton_image
from orbitproof.verify.reversor_breaking.following import BreakingEnclosures

Matrix = list[list[arb]]


@dataclass(frozen=True)
class Kernel:
    """Where B is bordered by e and r = (1, 0, .., 0): w, l and g with B w = - g e, l B = - g r, r w = l e = 1.

    Attributes:
        right, left: w and l.
        defect: g, 0 exactly where B is singular.
    """

    right: list[arb]
    left: list[arb]
    defect: arb


@dataclass(frozen=True)
class Coefficients:
    """The first terms of psi(h, y) = gamma (h - h*) + beta y^2 + .. (Lemma 27.2).

    Attributes:
        gamma, beta: the derivative by h, and half the second one by y.
    """

    gamma: arb
    beta: arb

    @property
    def opening(self) -> arb:
        """kappa: h - h* = kappa y^2 + .. where new orbits are."""
        return -self.beta / self.gamma


@dataclass(frozen=True)
class LossEquations:
    """pi_q P^m and g as functions of p = (p_0, .., p_n) at q = 0, with p_0 the parameter h less its centre.

    Attributes:
        kernel: pi_q P^m, functions of p and q.
        image: the coordinates p' of P^m.
        column: e is this unit vector.
    """

    kernel: tuple[BoxFunction, ...]
    image: tuple[BoxFunction, ...]
    column: int

    @property
    def size(self) -> int:
        """n."""
        return len(self.image)

    def _at(self, where: Sequence[arb]) -> list[arb]:
        return [*where, *(arb(0) for _ in self.image)]

    def _unit(self, *places: int) -> MultiIndex:
        """The derivative in the variables with these numbers; those of q are n + 1, .., 2 n."""
        return tuple(places.count(i) for i in range(2 * self.size + 1))

    def _q(self, column: int) -> int:
        return self.size + 1 + column

    def values(self, where: Sequence[arb]) -> list[arb]:
        """Enclosures of pi_q P^m at all points with p in `where`."""
        return [function.value(self._at(where)) for function in self.kernel]

    def slopes(self, where: Sequence[arb]) -> Matrix:
        """Enclosures of the derivatives of pi_q P^m in p: n rows of n + 1, the last n of them C."""
        at, places = self._at(where), range(self.size + 1)
        return [[function.derivative(self._unit(place), at) for place in places] for function in self.kernel]

    def crossing(self, where: Sequence[arb]) -> Matrix:
        """Enclosures of B = D_q p' o P^m."""
        at, places = self._at(where), range(self.size)
        return [[function.derivative(self._unit(self._q(j)), at) for j in places] for function in self.image]

    def crossing_slope(self, where: Sequence[arb], place: int) -> Matrix:
        """Enclosures of the derivative of B in p_place."""
        at, places = self._at(where), range(self.size)
        return [[function.derivative(self._unit(place, self._q(j)), at) for j in places] for function in self.image]

    def bordered(self, where: Sequence[arb]) -> Matrix:
        """B, bordered by e and r."""
        return bordered(self.crossing(where), self.column, _first(self.size))

    def kernel_over(self, where: Sequence[arb]) -> Kernel:
        """w, l and g at all points with p in `where`. Raises `ZeroDivisionError` if B is not shown bordered regular."""
        solution = arb_mat(self.bordered(where)).solve(arb_mat([[0]] * self.size + [[1]]))
        *right, defect = (solution[i, 0] for i in range(self.size + 1))
        return Kernel(right, left_kernel(self.crossing(where), self.column, _first(self.size)), defect)

    def matrix(self, where: Sequence[arb]) -> Matrix:
        """Enclosures of the derivative of (pi_q P^m, g): dg = - l dB w (Lemma 27.1)."""
        at = self.kernel_over(where)
        last = [-_form(at.left, self.crossing_slope(where, place), at.right) for place in range(self.size + 1)]
        return [*self.slopes(where), last]

    def coefficients(self, where: Sequence[arb]) -> Coefficients:
        """gamma and beta at the point with p in `where`, at which B is singular (Lemma 27.2)."""
        at, w = self._at(where), self.kernel_over(where)
        slopes = self.slopes(where)
        regular = [row[1:] for row in slopes]
        along = [arb(1), *newton_image(regular, [row[0] for row in slopes])]
        bent = [self._power(function, at, w.right, 2) / 2 for function in self.kernel]
        second = newton_image(regular, bent)
        rates = [_form(w.left, self.crossing_slope(where, place), w.right) for place in range(self.size + 1)]
        cubic = dot(w.left, [self._power(function, at, w.right, 3) for function in self.image])
        return Coefficients(dot(rates, along), dot(rates[1:], second) + cubic / 6)

    def _power(self, function: BoxFunction, at: Sequence[arb], w: Sequence[arb], degree: int) -> arb:
        """The derivative of this degree in the direction w of q, that many times."""
        none = (0,) * (self.size + 1)
        terms = []
        for index in indices_of_degree(self.size, degree):
            term = function.derivative((*none, *index), at) / index_factorial(index)
            for ball, exponent in zip(w, index, strict=True):
                for _ in range(exponent):
                    term = term * ball
            terms.append(term)
        return total(terms) * (6 if degree == 3 else 2)


def equations_of(found: BreakingEnclosures) -> LossEquations:
    """The equations of a claim from its enclosures, which are complete."""
    kernel, image = (tuple(map(BoxFunction, tables)) for tables in (found.iterates[-1], found.image))
    equations = LossEquations(kernel, image, 0)
    middle = equations.crossing([arb(0)] * (len(image) + 1))
    return LossEquations(kernel, image, bordering(middle, _first(len(image))))


def _first(size: int) -> list[arb]:
    """r: the first of the unit rows."""
    return [arb(int(i == 0)) for i in range(size)]


def _form(row: Sequence[arb], matrix: Matrix, column: Sequence[arb]) -> arb:
    return dot(row, [dot(entries, column) for entries in matrix])
