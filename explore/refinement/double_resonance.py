"""Parameters at which two 1:k resonances of a family meet, refined to claims.

The unknowns are the parameter and the coordinates u of a point of Fix(R); the equations are pi_q P = 0, f = 0 with
f = det(c - S), c = cos(2 pi j/k) and S the derivative of u o P^2, and g = 0, g the determinant of the derivative of
(pi_q P, f) in u. Jets of order 2 give the equations exactly, and the derivatives of all but g. Those of g, which would
take the third derivatives, are difference quotients, good to a third of the bits, as is each step of Newton's method.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, gcd, isfinite, log2
from typing import Any

import mpmath

from orbitproof.explore.engines import Progress
from orbitproof.explore.numerics import GrowingDigits, Linearised, bits_of, mpf, newton_with_digits
from orbitproof.explore.refinement.crossing import section_crossings
from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.jets import Jet, JetBasis
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import DOUBLE_RESONANCE, Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import ReversibleSystem

_RULE = GrowingDigits(RefinementFailure, farthest=3e-2, first_bits=110, growth=5)
"""Difference quotients are dear: few precisions."""
_BOX_DIGITS, _NARROWER = 24, 6
"""The half-widths of the box: small enough for third derivatives, and so many digits wider than the centre's error."""


def refine_double_resonance(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    guess: Sequence[float],
    k: int,
    *,
    digits: int,
    crossings: int = 1,
    id: str,
    provenance: Mapping[str, Any],
    progress: Progress | None = None,
) -> Candidate:
    """The claim that two 1:k resonances meet near a point, with the box in which it is to be proved.

    Arguments:
        parameters: all fixed parameters but the one that varies.
        guess: that one, then the coordinates of Fix(R).

    Raises `RefinementFailure`, one line, if Newton's method does not come to a point.
    """
    if len(guess) != 1 + len(system.fixed_coordinates) or not all(map(isfinite, guess)):
        raise RefinementFailure("the guess needs a finite number for the parameter, and for each coordinate of Fix(R)")
    equations = _Newton(system, parameters, k, crossings)
    start = [Fraction(value) for value in guess]
    try:
        found = newton_with_digits(equations.linearised, start, bits_of(digits), _RULE, progress)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise RefinementFailure(str(failure)) from None
    size = len(start)
    exponent = ceil(min(_BOX_DIGITS, digits - _NARROWER) * log2(10) + log2(max(1.0, found.last.found)))
    return Candidate(
        id=id,
        system=system,
        parameters=dict(parameters),
        kind=DOUBLE_RESONANCE,
        k=k,
        centre=tuple(round_dyadic(value, found.bits) for value in found.unknowns),
        frame=_unit_rows(size),
        kernel_frame=_unit_rows(len(system.kernel_coordinates)),
        radii=(Fraction(1, 2**exponent),) * size,
        crossings=crossings,
        provenance={"digits": digits, "turn": equations.turn, **provenance},
    )


class _Newton:
    """The equations of Newton's method; difference quotients stay until the precision grows.

    Attributes:
        turn: j, from the first point on.
    """

    def __init__(self, system: ReversibleSystem, parameters: Mapping[str, Fraction], k: int, crossings: int) -> None:
        self.turn: int | None = None
        self._about = system, parameters, k, crossings
        self._quotients: list[Any] = []
        self._bits: list[int] = []

    def linearised(self, point: Sequence[Fraction], context: mpmath.MPContext) -> Linearised:
        """The equations at a point; determinants of second derivatives of P lose the bits of the spread three times."""
        place = _Equations(*self._about, context)
        if self.turn is None:
            self.turn = place.nearest_turn(point)
        found = place.evaluate(point, self.turn)
        # Those at the guess may be far from those at the point.
        if len(self._bits) < 2 or self._bits[-1] < context.prec:
            self._quotients = place.last_slopes(point, self.turn, found.values[-1])
        self._bits.append(context.prec)
        matrix = context.matrix([*found.slopes, self._quotients])
        return Linearised(context.matrix(found.values), matrix, found.spread**3, found.spread)


@dataclass(frozen=True)
class _Evaluation:
    """The equations at a point, and their derivatives but those of g, in (parameter, u)."""

    values: list[Any]
    slopes: list[list[Any]]
    spread: float


@dataclass(frozen=True)
class _Equations:
    """Where the equations are evaluated."""

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    k: int
    crossings: int
    context: Any

    def jets(self, point: Sequence[Fraction], degree: int) -> tuple[list[Jet], list[Jet]]:
        """q of P^m and u of P^(2m) as jets in (parameter, u)."""
        system, context = self.system, self.context
        size = len(point)
        basis = JetBasis.graded((1,) * size, degree)
        variables = []
        for place, value in enumerate(point):
            jet = basis.constant(mpf(value, context))
            jet.coefficients[basis.variable(place)] = context.mpf(1)
            variables.append(jet)
        start = [basis.constant(context.mpf(0)) for _ in system.state]
        for index, jet in zip(system.fixed_coordinates, variables[1:], strict=True):
            start[index] = jet
        states = section_crossings(system, self.parameters, start, variables[0], context, every=self.crossings)
        half, whole = next(states), next(states)
        return [half.jets[i] for i in system.kernel_coordinates], [whole.jets[i] for i in system.fixed_coordinates]

    def nearest_turn(self, point: Sequence[Fraction]) -> int:
        """The j whose cos(2 pi j/k) is nearest to an eigenvalue of S."""
        _, image = self.jets(point, 1)
        turns = [j for j in range(1, self.k // 2 + 1) if gcd(j, self.k) == 1]
        return min(turns, key=lambda j: float(abs(self.defect(image, j).coefficients[0])))

    def evaluate(self, point: Sequence[Fraction], turn: int) -> _Evaluation:
        """The equations, and their derivatives but those of g."""
        kernel, image = self.jets(point, 2)
        f = self.defect(image, turn)
        places = range(1, len(point))
        g = _determinant([[_derivative(jet, i) for i in places] for jet in (*kernel, f)])
        basis = f.basis
        gradients = [[jet.coefficients[basis.variable(i)] for i in range(len(point))] for jet in (*kernel, f)]
        spread = max(float(abs(jet.coefficients[jet.basis.variable(i)])) for jet in image for i in range(len(point)))
        values = [*(jet.coefficients[0] for jet in kernel), f.coefficients[0], g.coefficients[0]]
        return _Evaluation(values, gradients, spread)

    def last_slopes(self, point: Sequence[Fraction], turn: int, value: Any) -> list[Any]:
        """Difference quotients of g."""
        bits = self.context.prec // 3
        step = Fraction(1, 2**bits)
        moved = [[p + step * (i == j) for i, p in enumerate(point)] for j in range(len(point))]
        return [(self.evaluate(other, turn).values[-1] - value) * 2**bits for other in moved]

    def defect(self, image: Sequence[Jet], turn: int) -> Jet:
        """det(c - S), a jet of one order less than those of the image."""
        c = self.context.cos(2 * self.context.pi * turn / self.k) if self.k != 4 else self.context.mpf(0)
        rows = [[-_derivative(jet, i) for i in range(1, len(image) + 1)] for jet in image]
        for i, row in enumerate(rows):
            row[i] = row[i] + c
        return _determinant(rows)


def _derivative(jet: Jet, variable: int) -> Jet:
    """The derivative in a variable, a jet of one order less."""
    basis = JetBasis.graded((1,) * jet.basis.variables, jet.basis.degree - 1)
    values = []
    for monomial in basis.monomials:
        raised = tuple(e + (i == variable) for i, e in enumerate(monomial))
        values.append(jet.coefficients[jet.basis.index[raised]] * raised[variable])
    return Jet(basis, values)


def _truncated(jet: Jet, basis: JetBasis) -> Jet:
    return Jet(basis, [jet.coefficients[jet.basis.index[monomial]] for monomial in basis.monomials])


def _determinant(rows: Sequence[Sequence[Jet]]) -> Jet:
    """Along the first row; all entries to the least order that one of them has."""
    least = min((jet.basis for row in rows for jet in row), key=lambda basis: basis.degree)
    entries = [[_truncated(jet, least) for jet in row] for row in rows]
    if len(entries) == 1:
        return entries[0][0]
    result: Jet = least.constant(0)
    for j, head in enumerate(entries[0]):
        minor = _determinant([[*row[:j], *row[j + 1 :]] for row in entries[1:]])
        result = result + (head * minor if j % 2 == 0 else -(head * minor))
    return result


def _unit_rows(size: int) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size))
