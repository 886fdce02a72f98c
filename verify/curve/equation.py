"""The equation of a curve on a piece, F(sigma, omega) = 0, and its derivatives (section 15.2).

|sigma| <= 1 is the enlarged interval of s and |omega_j| <= 1 the enlarged tube on which the flow is enclosed. What is
proved is proved for |sigma| <= 1/BEYOND, and |omega_j| <= TUBE is the tube.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat, arb_poly

from orbitproof.shared.formats import Piece
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Series, recentred, values_around
from orbitproof.verify.evidence import enclose, total
from orbitproof.verify.poincare import HalfOrbits, WideOracle

BEYOND = Fraction(17, 16)
TUBE = Fraction(1, 2)

Enclosed = tuple[arb_poly, arb]
"""A function of sigma: a polynomial, and a bound of the rest on the whole interval."""

_TERMS = 5
"""Powers of sigma in what the equations are multiplied by."""


def parameter_series(
    arithmetic: Arithmetic, system: ReversibleSystem, parameters: Mapping[str, Fraction]
) -> dict[str, Series]:
    """All parameters but the family parameter as constants of the algebra, derived ones with their errors."""
    result = {name: arithmetic.constant(parameters[name]) for name in system.fixed_parameters}
    if system.derived_parameters:
        from orbitproof.verify.curve.libration_point import derived_parameter

        for name in system.derived_parameters:
            root = derived_parameter(system, name, parameters, arithmetic.bits)
            result[name] = arithmetic.constant(root.middle).widened(root.radius)
    return result


def tube_points(
    arithmetic: Arithmetic,
    names: Sequence[str],
    piece: Piece,
    interval: tuple[Fraction, Fraction],
    widths: Sequence[Fraction],
) -> dict[str, Series]:
    """The points of a tube about a piece's polynomial, by the names of the coordinates, as elements in (sigma, omega).

    Args:
        names: of the coordinates.
        interval: middle and ds/dsigma.
        widths: dp_j/domega_j.
    """
    count, (middle, radius) = len(widths), interval
    along = [piece.half_width * middle, piece.half_width * radius]
    curves = [along, *(recentred(row, middle, radius) for row in piece.polynomial)]
    result = {}
    for name, origin, row in zip(names, piece.centre, piece.frame, strict=True):
        wide = [Fraction(0)] * max(len(curve) for curve in curves)
        wide[0] += origin
        for factor, curve in zip(row, curves, strict=True):
            for power, value in enumerate(curve):
                wide[power] += factor * value
        terms: dict[tuple[int, ...], Fraction | Sequence[Fraction]] = {(0,) * count: wide}
        for j in range(count):
            terms[tuple(int(i == j) for i in range(count))] = row[j + 1] * widths[j]
        result[name] = arithmetic.polynomial(terms)
    return result


@dataclass(frozen=True)
class HalfReturn:
    """The orbits of a tube, from Fix(R) to the end of their half orbits: the first return, or the m-th (section 15.3).

    Attributes:
        start: the points of the tube and the parameters, by name.
        widths: dp_j/domega_j.
        state: the system's state there.
        time: the system's time there.
        time_of_all: encloses it for all orbits.
        steps: of the integration.
    """

    start: Mapping[str, Series]
    widths: tuple[Fraction, ...]
    state: tuple[Series, ...]
    time: Series
    time_of_all: arb
    steps: int

    @classmethod
    def of(
        cls,
        system: ReversibleSystem,
        start: Mapping[str, Series],
        widths: Sequence[Fraction],
        coordinates: str,
        oracle: WideOracle,
        begun: Callable[[str], None] | None = None,
        progress: Callable[[int], None] | None = None,
        crossings: int = 1,
    ) -> HalfReturn:
        """Integrate.

        Args:
            coordinates: "physical", "regularised" or "auto".
            begun: called with the name of the coordinates that are integrated.
            progress: called after every step with the number of steps; what it raises passes through.
            crossings: m.

        Raises `IntegrationFailure`.
        """
        returns = HalfOrbits(system, next(iter(start.values())).arithmetic, start, oracle, coordinates)
        if begun is not None:
            begun(returns.coordinates.name)
        state, time = returns.half_orbit(crossings, progress)
        return cls(start, tuple(widths), tuple(state), returns.return_time, time, returns.steps)


class Equation:
    """F(sigma, omega) = known part + unknown parts, with its derivatives on parts of the interval."""

    def __init__(self, element: Series) -> None:
        arithmetic = element.arithmetic
        self.polynomials = [
            arb_poly([arb(c) * arb(2) ** -scale for c in packed.coeffs()])
            for packed, scale in zip(element.coefs, arithmetic.scales, strict=True)
        ]
        self.order = [arithmetic.grading.variable(j) for j in range(len(arithmetic.grading.weights))]
        # Of grades above 1 the norm is all that is used.
        beyond = [*element.errors[2:], *element.known[2:]]
        self.errors = [*map(arb, element.errors[:2]), sum(map(arb, beyond), arb(0))]
        self.inside = 1 / enclose(BEYOND)

    @property
    def at_zero(self) -> Enclosed:
        """F(sigma, 0)."""
        return self.polynomials[0], self.errors[0]

    def across(self, variable: int) -> Enclosed:
        """dF/d omega_variable for all omega in the tube.

        A monomial of degree n >= 2 in omega changes by at most n 2^(1-n) <= 1 on the tube.
        """
        return self.linear(variable), self.errors[1] + self.errors[2]

    def along(self, omega: Sequence[arb], divided: bool) -> Enclosed:
        """dF/d sigma, or that divided by sigma for an even F, at omega in given balls of the tube.

        With |sigma| <= r a power sigma^j of the unknown part changes by at most j r^(j-1) <= 1/(1 - r).
        """
        result = _slope_of(self.polynomials[0], divided)
        for variable, ball in enumerate(omega):
            result += _slope_of(self.linear(variable), divided) * ball
        unknown = self.errors[0] + self.errors[1] + self.errors[2]
        factor = 1 / (1 - self.inside)
        if divided:
            factor = factor / self.inside
        return result, unknown * factor

    def value(self, part: arb) -> arb:
        """F(sigma, 0) on a part of the interval."""
        return values_on(part, *self.at_zero)

    def slope(self, variable: int, part: arb) -> arb:
        """dF/d omega_variable on a part of the interval, for all omega in the tube."""
        return values_on(part, *self.across(variable))

    def linear(self, variable: int) -> arb_poly:
        """What is known of the coefficient of omega_variable, a polynomial in sigma."""
        position = self.order[variable]
        assert position is not None
        return self.polynomials[position]


def values_on(part: arb, polynomial: arb_poly, error: arb) -> arb:
    """Values of a function on a part of the interval."""
    return values_around(polynomial, part.mid(), part.rad()) + arb(0, 1) * error


def combined(weights: Sequence[arb_poly], functions: Sequence[Enclosed], part: arb) -> arb:
    """Values on a part of the interval of a sum of functions times weights, which is formed before it is evaluated."""
    known = sum((weight * function for weight, (function, _) in zip(weights, functions, strict=True)), arb_poly())
    sizes = [abs(values_on(part, weight, arb(0))) for weight in weights]
    return values_on(part, known, total(size * error for size, (_, error) in zip(sizes, functions, strict=True)))


def inverse_near(equations: Sequence[Equation], middle: arb) -> list[list[arb_poly]]:
    """Approximately the inverse of the derivative in omega: its power series about `middle`, up to `_TERMS`.

    Raises `ZeroDivisionError` if the derivative is numerically singular there.
    """
    size = range(len(equations))
    series = [[equation.linear(j)(arb_poly([middle, 1])) for j in size] for equation in equations]
    derivative = [arb_mat([[entry[power] for entry in row] for row in series]).mid() for power in range(_TERMS)]
    inverse = [derivative[0].inv().mid()]
    for power in range(1, _TERMS):
        products = (derivative[i] * inverse[power - i] for i in range(1, power + 1))
        inverse.append((inverse[0] * -sum(products, arb_mat(len(size), len(size)))).mid())
    back = arb_poly([-middle, 1])
    return [[arb_poly([term[i, j] for term in inverse])(back) for j in size] for i in size]


def _slope_of(polynomial: arb_poly, divided: bool) -> arb_poly:
    derivative = polynomial.derivative()
    if divided:
        # Odd coefficients of an even function are not there; what is known of them is rounding.
        derivative = arb_poly([c if n % 2 == 0 else arb(0) for n, c in enumerate(derivative.coeffs()[1:])])
    return derivative


def divided_by_wide(element: Series) -> Series:
    """F/sigma for a function F that is odd in sigma.

    The even part of what is known is none of F, and the odd part of what is unknown is not larger than all of it.
    """
    coefs = []
    for packed in element.coefs:
        values = packed.coeffs()
        coefs.append(type(packed)([value if n % 2 == 0 else 0 for n, value in enumerate(values[1:])]))
    return Series(element.arithmetic, coefs, element.errors)


def parts_of_interval(number: int) -> list[arb]:
    """Balls that cover |sigma| <= 1/BEYOND."""
    inside = 1 / enclose(BEYOND)
    return [inside * (arb(2 * part + 1 - number) + arb(0, 1)) / number for part in range(number)]


def halves(part: arb) -> list[arb]:
    """Two balls that cover a ball."""
    middle, quarter = part.mid(), part.rad() / 2
    return [middle + sign * quarter + arb(0, 1) * quarter for sign in (-1, 1)]
