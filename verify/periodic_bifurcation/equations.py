"""The equations of points that return, and their derivatives on parts of the box (section 25.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.evidence import (
    DerivativeTable,
    MultiIndex,
    dot,
    enclose,
    index_factorial,
    indices_of_degree,
    symmetric,
    total,
)
from orbitproof.verify.newton import BoxFunction
from orbitproof.verify.periodic_bifurcation.enclosures import BifurcationEnclosures, with_variable

Matrix = list[list[arb]]


@dataclass(frozen=True)
class PointEquations:
    """E(p, s) and J with E(p, s) = J p for the points that return: n functions of p_0, .., p_(n - 1) and s.

    Attributes:
        functions: E_i on the box: coordinate i of the return, and in the place of one of them the first integral, less
            its level.
        returns: all coordinates of the return.
        replaced: j, where the first integral stands; `None` if none is used.
    """

    functions: tuple[BoxFunction, ...]
    returns: tuple[BoxFunction, ...]
    replaced: int | None

    @property
    def size(self) -> int:
        """n."""
        return len(self.functions)

    def kept(self, row: int) -> int:
        """J_ii: 1, or 0 where the first integral stands."""
        return 0 if row == self.replaced else 1

    def values(self, where: Sequence[arb]) -> list[arb]:
        """Enclosures of E - J p at all points of the box with coordinates in `where`."""
        return [
            function.value(where) - self.kept(row) * where[row] for row, function in enumerate(self.functions)
        ]  # fmt: skip

    def slopes(self, where: Sequence[arb]) -> Matrix:
        """Enclosures of the derivatives of E in p and s: n rows of n + 1."""
        return [function.gradient(where, 0) for function in self.functions]

    def minus(self, multiplier: arb | int, slopes: Matrix) -> Matrix:
        """D_p E - multiplier J, from these derivatives."""
        return [
            [ball - multiplier * self.kept(row) if row == column else ball for column, ball in enumerate(balls[:-1])]
            for row, balls in enumerate(slopes)
        ]

    def curvatures(self, where: Sequence[arb], vector: Sequence[arb]) -> Matrix:
        """E_2(vector, e_k): n rows, for the directions e_k of p and s; the vector has n + 1 components."""
        size = self.size + 1
        units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
        rows = []
        for function in self.functions:
            second = {index: function.derivative(index, where) for index in indices_of_degree(size, 2)}
            rows.append([dot([second[_plus(unit, other)] for other in units], vector) for unit in units])
        return rows

    def cubic(self, where: Sequence[arb], vector: Sequence[arb]) -> list[arb]:
        """E_3(vector, vector, vector); the vector has n + 1 components."""
        return [
            total(
                function.derivative(index, where) * _power(vector, index) * 6 / index_factorial(index)
                for index in indices_of_degree(self.size + 1, 3)
            )
            for function in self.functions
        ]


def equations_of(claim: PeriodicBifurcation, found: BifurcationEnclosures) -> PointEquations:
    """The equations of a claim from its enclosures, which are complete."""
    size = len(claim.radii)
    returns = [BoxFunction(with_variable(table, size + 1)) for table in found.image]
    functions, replaced = list(returns), None
    if found.integral is not None and claim.level is not None:
        integral = with_variable(found.integral, size + 1)
        slopes = [integral.centre[unit] for unit in _units(size)]
        replaced = max(range(size), key=lambda j: float(abs(slopes[j].mid())))
        functions[replaced] = BoxFunction(_less_level(claim, integral))
    return PointEquations(tuple(functions), tuple(returns), replaced)


def _units(size: int) -> list[MultiIndex]:
    """The derivatives in p_0, .., p_(n - 1) of a function of p and s."""
    return [tuple(int(i == j) for i in range(size + 1)) for j in range(size)]


def _less_level(claim: PeriodicBifurcation, integral: DerivativeTable) -> DerivativeTable:
    """H - h, or H - h - s if the level varies."""
    assert claim.level is not None
    size, level = len(claim.radii) + 1, enclose(claim.level)
    zero, last = (0,) * size, (*(0,) * (size - 1), 1)
    box, centre = dict(integral.box), dict(integral.centre)
    box[zero], centre[zero] = box[zero] - level, centre[zero] - level
    if claim.parameter is None:
        box[zero] = box[zero] - symmetric(claim.parameter_radius)
        box[last], centre[last] = box[last] - 1, centre[last] - 1
    return DerivativeTable(box, centre)


def sides_of(claim: PeriodicBifurcation) -> list[arb]:
    """The box and the interval in the coordinates p and s."""
    return [symmetric(radius) for radius in radii_of(claim)]


def radii_of(claim: PeriodicBifurcation) -> tuple[Fraction, ...]:
    """Their half-widths."""
    return (*claim.radii, claim.parameter_radius)


def _plus(left: MultiIndex, right: MultiIndex) -> MultiIndex:
    return tuple(a + b for a, b in zip(left, right, strict=True))


def _power(vector: Sequence[arb], index: MultiIndex) -> arb:
    result = arb(1)
    for ball, exponent in zip(vector, index, strict=True):
        for _ in range(exponent):
            result = result * ball
    return result
