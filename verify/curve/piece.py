"""One piece of a curve of symmetric orbits, proved over an interval of its parameter (section 15.2).

The flow takes the whole piece at once: s is the wide variable, the unknowns across the curve have weight 1 and
G = 1. The interval Newton operator then shows, for every s, that the tube contains exactly one symmetric orbit.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from math import comb, floor, log2

import numpy as np
from flint import arb, arb_poly

from orbitproof.shared.formats import Piece
from orbitproof.shared.formats import is_regular as is_regular_frame
from orbitproof.shared.systems import REGULARISATIONS, ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading, Series
from orbitproof.verify.curve.libration_point import parameter_series
from orbitproof.verify.curve.piece_result import PieceLimits, PieceResult
from orbitproof.verify.evidence import IntegrationFailure, all_finite, enclose, guarded, hull, is_inside
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.poincare import PHYSICAL, REGULARISED, Returns, evaluate

__all__ = ["PieceLimits", "PieceResult", "divided_by_wide", "prove_piece", "recentred"]

Progress = Callable[[float], None]

_BEYOND = Fraction(17, 16)
"""The flow is enclosed for |sigma| <= 1; the interval that is proved is |sigma| <= 1/_BEYOND."""

_TUBE = Fraction(1, 2)
"""The flow is enclosed for |omega_j| <= 1; the tube is |omega_j| <= _TUBE."""

_MARGIN = 16
"""The curve has to be so much closer to its polynomial than the tube is wide: neighbours may have narrower tubes."""

_PARTS, _HALVINGS = 8, 6
"""The Newton operator is evaluated on so many parts of the interval of s, each halved at most so often."""

_SLOPE_BITS = 52
"""Significant bits of the derivatives across the curve; what a Newton operator needs of them is little."""

_MAX_STEPS = 200

_MENDED_BY_COORDINATES = ("tube", "newton", "singularity", "steps")
"""Conditions for which regularised coordinates are tried where the system's own fail."""


def prove_piece(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    piece: Piece,
    interval: tuple[Fraction, Fraction],
    limits: PieceLimits | None = None,
    progress: Progress | None = None,
    symmetry: str | None = None,
) -> PieceResult:
    """Prove the claim of a piece for s in an interval within [-1, 1], or say why it is not proved.

    Args:
        parameters: exact values of the system's fixed parameters.
        progress: called after every step with the number of steps; what it raises passes through.
        symmetry: name of the symmetry of a symmetric piece.
    """
    limits = PieceLimits() if limits is None else limits
    found = _prove(system, parameters, piece, interval, limits, progress, symmetry)
    other = replace(piece, coordinates=REGULARISED)
    in_physical = found.computation["coordinates"] == PHYSICAL and system.name in REGULARISATIONS
    if found.is_proved or not in_physical or found.condition not in _MENDED_BY_COORDINATES:
        return found
    again = _prove(system, parameters, other, interval, limits, progress, symmetry)
    return again if again.is_proved else found


def _prove(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    piece: Piece,
    interval: tuple[Fraction, Fraction],
    limits: PieceLimits,
    progress: Progress | None,
    symmetry: str | None,
) -> PieceResult:
    start = time.monotonic()
    proof = _Proof(system, parameters, piece, interval, limits, symmetry)
    try:
        with np.errstate(all="ignore"), guarded(limits.precision):
            found = proof.run(progress)
    except IntegrationFailure as error:
        found = PieceResult(
            piece.id, interval, reason=error.message, remedy=error.remedy, condition=error.condition
        )  # fmt: skip
    except (ArithmeticError, ValueError) as error:
        reason = " ".join(f"the verification broke off: {type(error).__name__}: {error}".split())
        found = PieceResult(piece.id, interval, reason=reason, remedy="give a narrower piece")
    computation: dict[str, float | int | str] = {
        "precision": limits.precision, "order": limits.order, "width": limits.width, "steps": proof.steps,
        "coordinates": proof.coordinates, "seconds": round(time.monotonic() - start, 3),
    }  # fmt: skip
    return replace(found, computation=computation)


class _Proof:
    def __init__(
        self,
        system: ReversibleSystem,
        parameters: Mapping[str, Fraction],
        piece: Piece,
        interval: tuple[Fraction, Fraction],
        limits: PieceLimits,
        symmetry: str | None,
    ) -> None:
        self.system = system
        self.given = parameters
        self.piece = piece
        self.limits = limits
        self.steps = 0
        self.coordinates = ""
        start, end = interval
        self.divided = piece.kind == "symmetric" and start <= 0 <= end
        if self.divided:
            # The equations are divided by s, which their symmetry allows on an interval about 0 only.
            start, end = -max(-start, end), max(-start, end)
        self.interval = (start, end)
        self.middle = (start + end) / 2
        self.radius = (end - start) / 2 * _BEYOND
        self.signs = system.symmetries.get(symmetry) if symmetry is not None else None
        self.tube = [width / _TUBE for width in piece.tube]

    @cached_property
    def arithmetic(self) -> Arithmetic:
        """The format, of a piece that has passed `_check`."""
        limits, tube = self.limits, self.tube
        grade_bits = floor(-log2(max(tube))) - max(0, limits.precision - _SLOPE_BITS)
        return Arithmetic(Grading((1,) * len(tube), 1), limits.precision, grade_bits, limits.order, width=limits.width)

    def run(self, progress: Progress | None) -> PieceResult:
        self._check()
        equations, when = self._half_return(progress)
        if self.divided:
            equations = [
                divided_by_wide(equation) if self._is_odd(index) else equation
                for index, equation in zip(self.system.kernel_coordinates, equations, strict=True)
            ]
        functions = [_Equation(equation) for equation in equations]
        images: list[list[arb]] = []
        slopes: list[list[arb]] = []
        parts = [(part, 0) for part in _parts(_PARTS)]
        while parts:
            part, halvings = parts.pop()
            try:
                image, slope = self._newton(functions, part)
            except IntegrationFailure:
                if halvings == _HALVINGS:
                    raise
                parts += [(half, halvings + 1) for half in _halves(part)]
                continue
            images.append(image)
            slopes.append(slope)
        deviation = [_largest([image[j] for image in images]) for j in range(len(self.tube))]
        slope_deviation = [_largest([slope[j] for slope in slopes]) for j in range(len(self.tube))]
        if self.piece.kind == "symmetric" and not self.divided:
            nearest = min(abs(end) for end in self.interval)
            slope_deviation = [bound / enclose(nearest) for bound in slope_deviation]
        return PieceResult(
            self.piece.id, self.interval,
            tuple(_above(enclose(width) * bound) for width, bound in zip(self.tube, deviation, strict=True)),
            tuple(_above(enclose(width) * bound) for width, bound in zip(self.tube, slope_deviation, strict=True)),
            when,
        )  # fmt: skip

    def _check(self) -> None:
        """Exact conditions on the piece."""
        start, end = self.interval
        if not -1 <= start < end <= 1:
            raise IntegrationFailure("interval", f"[{start}, {end}] is no interval within [-1, 1]", "correct it")
        system, piece = self.system, self.piece
        across, every = len(system.kernel_coordinates), len(system.centre_coordinates)
        sizes = len(piece.tube), len(piece.polynomial), len(piece.centre), len(piece.frame), *map(len, piece.frame)
        if sizes != (across, across, *[every] * (every + 2)) or not set(system.fixed_parameters) <= set(self.given):
            raise IntegrationFailure(
                "piece", f"the piece or its parameters are not those of {system.name}", "correct it"
            )
        if piece.kind not in ("regular", "symmetric") or not is_regular_frame(piece.frame):
            raise IntegrationFailure("piece", "the piece has an unknown kind or a singular frame", "correct it")
        if min(piece.half_width, *piece.tube) <= 0:
            raise IntegrationFailure("piece", "the half width or the tube of the piece is not positive", "correct it")
        if self.piece.kind == "symmetric":
            self._check_symmetry()

    def _check_symmetry(self) -> None:
        signs = self.signs
        if signs is None:
            raise IntegrationFailure("symmetry", "a symmetric piece of a claim without a symmetry", "name the symmetry")
        names = self.system.centre_coordinates
        parity = [signs[self.system.state.index(name)] if name in self.system.state else 1 for name in names]
        piece = self.piece
        fixed = all(value == 0 for value, sign in zip(piece.centre, parity, strict=True) if sign < 0)
        along = all(row[0] == 0 for row, sign in zip(piece.frame, parity, strict=True) if sign > 0)
        across = all(not any(row[1:]) for row, sign in zip(piece.frame, parity, strict=True) if sign < 0)
        even = all(not any(row[1::2]) for row in piece.polynomial)
        odd = sum(signs[index] < 0 for index in self.system.kernel_coordinates)
        if not (fixed and along and across and even and odd):
            raise IntegrationFailure(
                "symmetry", "the piece is not symmetric: its centre, frame or polynomial", "give a symmetric piece"
            )

    def _is_odd(self, index: int) -> bool:
        return self.signs is not None and self.signs[index] < 0

    def _initial(self) -> dict[str, Series]:
        """The points of the tube, by the names of the coordinates, as elements in (sigma, omega)."""
        piece, tube = self.piece, self.tube
        count = len(tube)
        along = [piece.half_width * self.middle, piece.half_width * self.radius]
        curves = [along, *(recentred(row, self.middle, self.radius) for row in piece.polynomial)]
        result = {}
        for name, middle, row in zip(self.system.centre_coordinates, piece.centre, piece.frame, strict=True):
            length = max(len(curve) for curve in curves)
            wide = [Fraction(0)] * length
            wide[0] += middle
            for factor, curve in zip(row, curves, strict=True):
                for power, value in enumerate(curve):
                    wide[power] += factor * value
            terms: dict[tuple[int, ...], Fraction | Sequence[Fraction]] = {(0,) * count: wide}
            for j in range(count):
                terms[tuple(int(i == j) for i in range(count))] = row[j + 1] * tube[j]
            result[name] = self.arithmetic.polynomial(terms)
        return result

    def _half_return(self, progress: Progress | None) -> tuple[list[Series], arb]:
        """The kernel coordinates at the first return, and the half periods."""
        system, arithmetic = self.system, self.arithmetic
        point = self._initial()
        initial = [
            point[name] if name in point else arithmetic.constant(system.normalised.get(name, Fraction(0)))
            for name in system.state
        ]
        known = parameter_series(arithmetic, system, self.given)
        parameters = [point[name] if name in point else known[name] for name in system.parameters]
        program = system.first_integral_program
        level = None if program is None else evaluate(arithmetic, program, (*initial, *parameters))[0]
        returns = Returns(system, arithmetic, initial, parameters, level, self.piece.coordinates)
        self.coordinates = returns.coordinates.name
        arrived = False
        while not arrived:
            if returns.steps >= _MAX_STEPS:
                raise IntegrationFailure("steps", f"no return within {_MAX_STEPS} steps", "give another centre")
            arrived = returns.step()
            self.steps = returns.steps
            if progress is not None:
                progress(returns.steps)
        state, when = returns.crossing(1)
        return [state[index] for index in system.kernel_coordinates], when

    def _newton(self, functions: Sequence[_Equation], part: arb) -> tuple[list[arb], list[arb]]:
        """Newton image and slope of omega on a part of the interval of sigma; raises if it is not inside the tube."""
        size = len(functions)
        matrix = [[function.slope(j, part) for j in range(size)] for function in functions]
        residual = [function.value(part) for function in functions]
        if not all_finite(residual) or not all_finite(entry for row in matrix for entry in row):
            raise IntegrationFailure("newton", "the half return was not enclosed", "give a narrower piece")
        if not is_regular(matrix):
            raise IntegrationFailure(
                "newton", "the derivative across the curve may be singular",
                "give a narrower tube or piece; the curve may bifurcate or turn",
            )  # fmt: skip
        image = newton_image(matrix, residual)
        if not all(is_inside(ball, _TUBE / _MARGIN) for ball in image):
            raise IntegrationFailure(
                "newton", f"the Newton image, {_size_text(image)} of the tube, is not well inside of it",
                "give a better polynomial, a wider tube or a narrower piece",
            )  # fmt: skip
        change = [function.wide_derivative(image, part, self.divided) for function in functions]
        slope = newton_image(matrix, change)
        scale = enclose(self.radius * self.radius if self.divided else self.radius)
        return image, [value / scale for value in slope]


class _Equation:
    """F(sigma, omega) = known part + unknown parts, with its derivatives on parts of the interval."""

    def __init__(self, element: Series) -> None:
        arithmetic = element.arithmetic
        self.polynomials = [
            arb_poly([arb(c) * arb(2) ** -scale for c in packed.coeffs()])
            for packed, scale in zip(element.coefs, arithmetic.scales, strict=True)
        ]
        self.order = [arithmetic.grading.variable(j) for j in range(len(arithmetic.grading.weights))]
        self.errors = [arb(e) for e in element.errors]
        self.inside = 1 / enclose(_BEYOND)

    def value(self, part: arb) -> arb:
        """F(sigma, 0)."""
        return _over(self.polynomials[0], part) + arb(0, 1) * self.errors[0]

    def slope(self, variable: int, part: arb) -> arb:
        """dF/d omega_variable for all omega in the tube.

        A monomial of degree n >= 2 in omega changes by at most n 2^(1-n) <= 1 on the tube.
        """
        return self._linear(variable, part) + arb(0, 1) * (self.errors[1] + self.errors[2])

    def _linear(self, variable: int, part: arb) -> arb:
        position = self.order[variable]
        assert position is not None
        return _over(self.polynomials[position], part)

    def wide_derivative(self, omega: Sequence[arb], part: arb, divided: bool) -> arb:
        """dF/d sigma, or that divided by sigma for an even F, at omega in given balls of the tube.

        With |sigma| <= r a power sigma^j of the unknown part changes by at most j r^(j-1) <= 1/(1 - r).
        """
        result = self._slope_of(self.polynomials[0], part, divided)
        for variable, ball in enumerate(omega):
            position = self.order[variable]
            assert position is not None
            result += self._slope_of(self.polynomials[position], part, divided) * ball
        unknown = self.errors[0] + self.errors[1] + self.errors[2]
        factor = 1 / (1 - self.inside)
        if divided:
            factor = factor / self.inside
        return result + arb(0, 1) * (unknown * factor)

    @staticmethod
    def _slope_of(polynomial: arb_poly, part: arb, divided: bool) -> arb:
        derivative = polynomial.derivative()
        if divided:
            # Odd coefficients of an even function are not there; what is known of them is rounding.
            derivative = arb_poly([c if n % 2 == 0 else arb(0) for n, c in enumerate(derivative.coeffs()[1:])])
        return _over(derivative, part)


def divided_by_wide(element: Series) -> Series:
    """F/sigma for a function F that is odd in sigma.

    The even part of what is known is none of F, and the odd part of what is unknown is not larger than all of it.
    """
    arithmetic = element.arithmetic
    coefs = []
    for packed in element.coefs:
        values = packed.coeffs()
        coefs.append(type(packed)([value if n % 2 == 0 else 0 for n, value in enumerate(values[1:])]))
    return Series(arithmetic, coefs, element.errors)


def recentred(coefficients: Sequence[Fraction], middle: Fraction, radius: Fraction) -> list[Fraction]:
    """Coefficients in sigma of a polynomial in s = middle + radius * sigma, exactly."""
    if middle == 0:
        return [value * radius**n for n, value in enumerate(coefficients)]
    result = [Fraction(0)] * len(coefficients)
    for n, value in enumerate(coefficients):
        for j in range(n + 1):
            result[j] += value * comb(n, j) * middle ** (n - j)
    return [value * radius**j for j, value in enumerate(result)]


def _parts(number: int) -> list[arb]:
    inside = 1 / enclose(_BEYOND)
    return [inside * (arb(2 * part + 1 - number) + arb(0, 1)) / number for part in range(number)]


def _halves(part: arb) -> list[arb]:
    """Two balls that cover a ball."""
    middle, quarter = part.mid(), part.rad() / 2
    return [middle + sign * quarter + arb(0, 1) * quarter for sign in (-1, 1)]


def _over(polynomial: arb_poly, part: arb) -> arb:
    """Values on a ball, by Taylor's theorem of order 2 about its middle."""
    middle = part.mid()
    away = part - middle
    first = polynomial.derivative()
    return polynomial(middle) + (first(middle) + first.derivative()(part) * away / 2) * away


def _largest(balls: Sequence[arb]) -> arb:
    return hull(balls[0], *balls[1:]).abs_upper()


def _above(bound: arb) -> Fraction:
    """A dyadic number with few bits that is at least the bound."""
    if not bound.is_finite():
        raise ValueError("a bound is not finite")
    mantissa, exponent = bound.abs_upper().man_exp()
    shift = max(0, int(mantissa).bit_length() - 24)
    return Fraction(-(-int(mantissa) >> shift)) * Fraction(2) ** (int(exponent) + shift)


def _size_text(image: Sequence[arb]) -> str:
    return ", ".join(f"{float(ball.abs_upper() / enclose(_TUBE)):.3g}" for ball in image)
