"""Where a stability parameter has a stationary value cos(2 pi j/k), as equations on a box (section 34.3)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import permutations
from operator import add

from flint import arb, arb_mat

from orbitproof.verify.double_resonance.following import ResonanceEnclosures
from orbitproof.verify.evidence import dot, enclose, index_factorial, indices_up_to
from orbitproof.verify.newton import BoxFunction, Jet, newton_image
from orbitproof.verify.newton.jets import plus, unit

Matrix = list[list[arb]]


@dataclass(frozen=True)
class Unfolding:
    """How the stability parameter s depends on a coordinate y along the family and on the parameter (Lemma 34.2).

    Attributes:
        slope: the derivative of its stationary value in the parameter.
        curvature: d^2 s/dy^2 along the family.
        simplicity: the derivative of the characteristic polynomial of S at c, not 0 if c is a simple eigenvalue.
    """

    slope: arb
    curvature: arb
    simplicity: arb

    @property
    def opening(self) -> arb:
        """kappa: the parameter differs by kappa y^2 + .. along the curve of resonances."""
        return -self.curvature / (2 * self.slope)


@dataclass(frozen=True)
class ResonanceEquations:
    """pi_q P^m, f = det(c - S) and g as functions of p = (p_0, .., p_(n+1)), S the derivative of p o P^(2m) on Fix(R).

    Attributes:
        kernel: pi_q P^m.
        image: the coordinates of Fix(R) of P^(2m).
        directions: by coordinate of Fix(R), the change of p that changes it alone; of the parameter first.
        level: c.
        along: the coordinate of Fix(R) by which the family is described.
    """

    kernel: tuple[BoxFunction, ...]
    image: tuple[BoxFunction, ...]
    directions: tuple[tuple[Fraction, ...], ...]
    level: arb
    along: int = 0

    @property
    def size(self) -> int:
        """How many variables p there are, n + 2."""
        return len(self.directions)

    @property
    def across(self) -> list[int]:
        """The coordinates of Fix(R) but `along`."""
        return [i for i in range(self.size - 1) if i != self.along]

    def values(self, where: Sequence[arb]) -> list[arb]:
        """Enclosures of (pi_q P^m, f, g) at all points with p in `where`."""
        return [jet[(0,) * self.size] for jet in (*self._kernel(where, 0), *self._last(where))]

    def matrix(self, where: Sequence[arb]) -> Matrix:
        """Enclosure of their derivative in p."""
        rows = (*self._kernel(where, 1), *self._last(where))
        return [[jet[unit(self.size, j)] for j in range(self.size)] for jet in rows]

    def slopes(self, where: Sequence[arb]) -> Matrix:
        """Enclosures of the derivatives of pi_q P^m in the coordinates of Fix(R), the parameter fixed."""
        zero = (0,) * self.size
        return [[self._by(jet, i + 1)[zero] for i in range(self.size - 1)] for jet in self._kernel(where, 1)]

    def across_slopes(self, where: Sequence[arb]) -> Matrix:
        """The columns of `slopes` in `across`: n rows of n."""
        return [[row[i] for i in self.across] for row in self.slopes(where)]

    def stability_matrix(self, where: Sequence[arb]) -> Matrix:
        """Enclosures of S."""
        zero = (0,) * self.size
        return [[entry[zero] for entry in row] for row in self._matrix(where, 0)]

    def unfolding(self, where: Sequence[arb]) -> Unfolding:
        """The coefficients at the point with p in `where`.

        Raises `ZeroDivisionError` if `across_slopes` may be singular.
        """
        zero, places = (0,) * self.size, range(1, self.size)
        kernel, (f, g) = self._kernel(where, 1), self._last(where)
        moved = newton_image(self.across_slopes(where), [self._by(jet, 0)[zero] for jet in kernel])
        rates = [self._by(f, i)[zero] for i in range(self.size)]
        by_parameter = rates[0] + dot([rates[i + 1] for i in self.across], moved)
        tangent = _tangent(self.slopes(where))
        second = dot(tangent, [self._by(g, i)[zero] for i in places])
        simplicity = self._simplicity(where)
        unit_speed = tangent[self.along] * tangent[self.along]
        return Unfolding(-by_parameter / simplicity, -second / (simplicity * unit_speed), simplicity)

    def _simplicity(self, where: Sequence[arb]) -> arb:
        """The derivative of det(s - S) at s = c: the sum of the principal minors of c - S of one row less."""
        rows, places = self.stability_matrix(where), range(self.size - 1)
        shifted = [[int(i == j) * self.level - rows[i][j] for j in places] for i in places]
        minors = (arb_mat([[shifted[i][j] for j in places if j != k] for i in places if i != k]).det() for k in places)
        return reduce(add, minors)

    def _kernel(self, where: Sequence[arb], order: int) -> list[Jet]:
        return [_jet(function, where, order) for function in self.kernel]

    def _matrix(self, where: Sequence[arb], order: int) -> list[list[Jet]]:
        """The entries of S as jets."""
        jets = [_jet(function, where, order + 1) for function in self.image]
        return [[self._by(jet, i + 1) for i in range(self.size - 1)] for jet in jets]

    def _last(self, where: Sequence[arb]) -> tuple[Jet, Jet]:
        """Jets of order 1 of f = det(c - S) and of g, the determinant of the derivative of (pi_q P^m, f) on Fix(R)."""
        places = range(self.size - 1)
        constant = Jet(self.size, 2, {(0,) * self.size: self.level})
        rows = [[entry.scaled(arb(-1)) for entry in row] for row in self._matrix(where, 2)]
        for i in places:
            rows[i][i] = rows[i][i] + constant
        f = _determinant(rows)
        equations = [*self._kernel(where, 2), f]
        return _truncated(f, 1), _determinant([[self._by(jet, i + 1) for i in places] for jet in equations])

    def _by(self, jet: Jet, coordinate: int) -> Jet:
        """The derivative by a coordinate of Fix(R) (from 1 on) or by the parameter (0), of one order less."""
        parts = (
            _derivative(jet, j).scaled(enclose(share)) for j, share in enumerate(self.directions[coordinate]) if share
        )
        return reduce(add, parts)


def equations_of(
    found: ResonanceEnclosures, directions: Iterable[Sequence[Fraction]], level: arb
) -> ResonanceEquations:
    """The equations of a claim from its enclosures, which are complete; `along` is where the family is steepest."""
    kernel, image = (tuple(map(BoxFunction, tables)) for tables in (found.iterates[-1], found.image))
    equations = ResonanceEquations(kernel, image, tuple(map(tuple, directions)), level)
    tangent = _tangent(equations.slopes([arb(0)] * equations.size))
    largest = max(range(len(tangent)), key=lambda i: float(abs(tangent[i].mid())))
    return ResonanceEquations(kernel, image, equations.directions, level, largest)


def _tangent(slopes: Matrix) -> list[arb]:
    """The cofactors t of a further row r: det (slopes, r) = r t; slopes t = 0."""
    places = range(len(slopes[0]))
    sign = (-1) ** len(slopes)
    return [sign * (-1) ** i * arb_mat([[row[j] for j in places if j != i] for row in slopes]).det() for i in places]


def _jet(function: BoxFunction, where: Sequence[arb], order: int) -> Jet:
    indices = indices_up_to(len(where), order)
    values = {index: function.derivative(index, where) / index_factorial(index) for index in indices}
    return Jet(len(where), order, values)


def _derivative(jet: Jet, place: int) -> Jet:
    step = unit(jet.variables, place)
    indices = indices_up_to(jet.variables, jet.order - 1)
    return Jet(jet.variables, jet.order - 1, {index: jet[plus(index, step)] * (index[place] + 1) for index in indices})


def _truncated(jet: Jet, order: int) -> Jet:
    return Jet(jet.variables, order, {index: jet[index] for index in indices_up_to(jet.variables, order)})


def _determinant(rows: Sequence[Sequence[Jet]]) -> Jet:
    """By Leibniz' formula: sizes are 2 and 3 for one and two pairs of multipliers."""
    terms = []
    for order in permutations(range(len(rows))):
        inversions = sum(order[i] > order[j] for j in range(len(order)) for i in range(j))
        product = reduce(lambda left, right: left * right, (rows[i][j] for i, j in enumerate(order)))
        terms.append(product.scaled(arb((-1) ** inversions)))
    return reduce(add, terms)
