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

from orbitproof.explore.engines import Progress
from orbitproof.explore.numerics import fraction, mpf, working_context
from orbitproof.explore.refinement.crossing import section_crossings
from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.jets import Jet, JetBasis
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import DOUBLE_RESONANCE, Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import ReversibleSystem

_FIRST_BITS = 110
_GUARD_BITS = 40
_MARGIN_DIGITS = 6
_BOX_DIGITS = 24
_MOST_STEPS = 20
_FARTHEST = 3e-2


@dataclass(frozen=True)
class _Evaluation:
    """The equations at a point, and their derivatives but those of g, in (parameter, u)."""

    values: list[Any]
    slopes: list[list[Any]]
    spread: float


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
    report = progress or (lambda _message, _fraction: None)
    try:
        return _refine(system, parameters, guess, k, digits, crossings, id, provenance, report)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise RefinementFailure(str(failure)) from None


def _refine(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    guess: Sequence[float],
    k: int,
    digits: int,
    crossings: int,
    id: str,
    provenance: Mapping[str, Any],
    report: Progress,
) -> Candidate:
    goal = ceil((digits + _MARGIN_DIGITS) * log2(10))
    point, bits = [Fraction(value) for value in guess], _FIRST_BITS
    last: list[Any] | None = None
    known, turn = 0, None
    for number in range(_MOST_STEPS):
        report(f"Newton step {number + 1} with {bits} bits", min(0.9, number / 8))
        context = working_context(bits)
        place = _Place(system, parameters, k, crossings, context)
        turn = place.nearest_turn(point) if turn is None else turn
        found = place.evaluate(point, turn)
        # Difference quotients at the guess may be far from those at the point.
        if last is None or number == 1 or known < bits:
            last, known = place.last_slopes(point, turn, found.values[-1]), bits
        correction = context.lu_solve(context.matrix([*found.slopes, last]), -context.matrix(found.values))
        size = max(float(abs(value)) for value in correction)
        point = [value + round_dyadic(fraction(change), bits) for value, change in zip(point, correction, strict=True)]
        far = max(abs(float(p) - g) / max(1.0, abs(g)) for p, g in zip(point, guess, strict=True))
        if far > _FARTHEST:
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
        guard = _GUARD_BITS + 3 * ceil(log2(max(found.spread, 1.0)))
        if bits >= goal + guard and size < 2.0**-goal:
            break
        if size < 2.0 ** -(_FIRST_BITS // 3):
            bits = goal + guard
    else:
        raise RefinementFailure(f"Newton's method did not converge in {_MOST_STEPS} steps")
    size = len(point)
    exponent = ceil(min(_BOX_DIGITS, digits - _MARGIN_DIGITS) * log2(10) + log2(max(1.0, found.spread)))
    n = len(system.kernel_coordinates)
    return Candidate(
        id=id,
        system=system,
        parameters=dict(parameters),
        kind=DOUBLE_RESONANCE,
        k=k,
        centre=tuple(round_dyadic(value, bits) for value in point),
        frame=_unit_rows(size),
        kernel_frame=_unit_rows(n),
        radii=(Fraction(1, 2**exponent),) * size,
        crossings=crossings,
        provenance={"digits": digits, "turn": turn, **provenance},
    )


@dataclass(frozen=True)
class _Place:
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
