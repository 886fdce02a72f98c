"""The curve in its tube as functions of s, and what the flow of the tube says on it (section 18.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, log2

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Series, WideArithmetic
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.functions import determinant, error_of, finite, function, inverse, known_part, norm_of
from orbitproof.verify.poincare import first_integral

_HALF = Fraction(1, 2)


@dataclass(frozen=True)
class CurveInTube:
    """omega_j on the curve, as functions of sigma.

    Attributes:
        omega: elements of the algebra in sigma.
        size: a bound of their norms, at most 1/2.
    """

    omega: tuple[Series, ...]
    size: Fraction

    def value(self, element: Series) -> Series:
        """A function of (sigma, omega) on the curve (18.3)."""
        known, variables, errors = _parts(element)
        error = errors[0] + self.size * errors[1] + self.size**2 * errors[2]
        result = function(self._arithmetic, known, error)
        for coefficients, omega in zip(variables, self.omega, strict=True):
            result = result + function(self._arithmetic, coefficients, Fraction(0)) * omega
        return result

    def across(self, element: Series, variable: int) -> Series:
        """The derivative of a function in omega_variable on the curve (18.3)."""
        _, variables, errors = _parts(element)
        return function(self._arithmetic, variables[variable], errors[1] + 2 * self.size * errors[2])

    @property
    def _arithmetic(self) -> WideArithmetic:
        arithmetic = self.omega[0].arithmetic
        assert isinstance(arithmetic, WideArithmetic)
        return arithmetic


def at_origin(element: Series, variable: int, arithmetic: WideArithmetic) -> Series:
    """The derivative in omega_variable at omega = 0 of a function of (sigma, omega)."""
    _, variables, errors = _parts(element)
    return function(arithmetic, variables[variable], errors[1])


def level_around(points: Mapping[str, Series], system: ReversibleSystem, on_curve: Series) -> Series | None:
    """The first integral of points of Fix(R), where that of those with omega = 0 is known already (section 18.3)."""
    flow = next(iter(points.values())).arithmetic
    level = first_integral(system, flow, points)
    known = flow.polynomial({flow.grading.monomials[0]: known_part(on_curve, 0)}).widened(error_of(on_curve))
    return level and Series(flow, [known.coefs[0], *level.coefs[1:]], [known.errors[0], *level.errors[1:]])


def solve(arithmetic: WideArithmetic, equations: Sequence[Series]) -> CurveInTube:
    """The zero omega(sigma) of as many equations F(sigma, omega) = 0 as there are omega_j (Lemma 18.2).

    Raises `IntegrationFailure` if it is not shown to exist in the algebra with norms of at most 1/2.
    """
    middle, inverted, errors = _newton(arithmetic, equations)
    norms = [[norm_of(entry) for entry in row] for row in inverted]
    reach = max(norm_of(element) for element in middle)

    def image(bounds: Sequence[Fraction]) -> Fraction:
        return max(sum((b * e for b, e in zip(row, bounds, strict=True)), Fraction(0)) for row in norms)

    radius = 2 * image([e[0] + 2 * reach * e[1] + 4 * reach**2 * e[2] for e in errors])
    total = reach + radius
    inside = image([e[0] + total * e[1] + total**2 * e[2] for e in errors]) <= radius
    contracts = image([e[1] + 2 * total * e[2] for e in errors]) < 1
    if not (total <= _HALF and inside and contracts):
        message = f"the curve is not shown to be an analytic function of complex s in the tube ({float(total):.3g})"
        raise IntegrationFailure("stability", message, "give a narrower piece, a wider tube or more precision")
    return CurveInTube(tuple(element.widened(radius) for element in middle), total)


def about_zero(arithmetic: WideArithmetic, equations: Sequence[Series]) -> list[list[Fraction]]:
    """Coefficients of the omega^ of Lemma 18.2, about the zero: what is known of -G^-1 f_0, without a bound."""
    middle, _, _ = _newton(arithmetic, equations)
    return [known_part(element, 0) for element in middle]


def _newton(
    arithmetic: WideArithmetic, equations: Sequence[Series]
) -> tuple[list[Series], list[list[Series]], list[list[Fraction]]]:
    """omega^ = -G^-1 f_0, G^-1 and the bounds of the unknown parts by grade, rows of G brought to about 1."""
    parts = [_parts(equation) for equation in equations]
    size = len(parts)
    if size != len(parts[0][1]):
        raise ValueError("there are as many equations as variables")
    scales = [_scale(variables) for _, variables, _ in parts]
    matrix = [
        [function(arithmetic, [scale * c for c in coefficients], Fraction(0)) for coefficients in variables]
        for (_, variables, _), scale in zip(parts, scales, strict=True)
    ]
    values = [
        function(arithmetic, [-scale * c for c in known], Fraction(0))
        for (known, _, _), scale in zip(parts, scales, strict=True)
    ]
    errors = [[scale * bound for bound in bounds] for (_, _, bounds), scale in zip(parts, scales, strict=True)]
    inverted = _inverse_matrix(matrix)
    middle = []
    for row in inverted:
        terms = [entry * value for entry, value in zip(row, values, strict=True)]
        middle.append(sum(terms[1:], terms[0]))
    return middle, inverted, errors


def _parts(element: Series) -> tuple[list[Fraction], list[list[Fraction]], list[Fraction]]:
    """Known coefficients in sigma of 1 and of each omega_j; bounds of the unknown part, grades 0, 1 and above."""
    grading = element.arithmetic.grading
    finite([*element.errors, *element.known], "the returns of the tube were not enclosed")
    positions = [grading.variable(j) for j in range(len(grading.weights))]
    variables = [known_part(element, position) for position in positions if position is not None]
    # Of grades above 1 that are kept the norm is all that is used.
    beyond = sum(map(Fraction, [*element.errors[2:], *element.known[2:]]), Fraction(0))
    return known_part(element, 0), variables, [*map(Fraction, element.errors[:2]), beyond]


def _scale(variables: Sequence[Sequence[Fraction]]) -> Fraction:
    """A power of two that brings a row to about 1."""
    largest = max((sum(map(abs, row), Fraction(0)) for row in variables), default=Fraction(0))
    if not largest:
        raise IntegrationFailure("stability", "an equation does not depend on the tube", "give a wider tube")
    return Fraction(2) ** -ceil(log2(largest.numerator) - log2(largest.denominator))


def _inverse_matrix(rows: Sequence[Sequence[Series]]) -> list[list[Series]]:
    """The inverse of a matrix of functions, by minors."""
    scale = inverse(determinant(rows))
    if len(rows) == 1:
        return [[scale]]
    result = []
    for i in range(len(rows)):
        entries = []
        for j in range(len(rows)):
            minor = determinant([[*row[:i], *row[i + 1 :]] for k, row in enumerate(rows) if k != j])
            entry = minor * scale
            entries.append(entry.scaled(Fraction(-1)) if (i + j) % 2 else entry)
        result.append(entries)
    return result
