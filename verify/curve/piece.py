"""One piece of a curve of symmetric orbits, proved over an interval of its parameter (section 15.2).

The flow takes the whole piece at once: s is the wide variable, the unknowns across the curve have weight 1, and
G = 1 if no more is asked for. The interval Newton operator then shows, for every s, that the tube contains exactly one
symmetric orbit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import floor, log2

from flint import arb, arb_mat

from orbitproof.shared.formats import Piece
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic
from orbitproof.verify.curve.equation import (
    BEYOND,
    TUBE,
    Equation,
    HalfReturn,
    combined,
    divided_by_wide,
    halves,
    inverse_near,
    parameter_series,
    parts_of_interval,
    tube_points,
)
from orbitproof.verify.curve.piece_claim import require_piece
from orbitproof.verify.curve.piece_result import Account, Interval, PieceResult, attempt
from orbitproof.verify.curve.proved_intervals import ProvedInterval
from orbitproof.verify.evidence import (
    Checklist,
    IntegrationFailure,
    NotProved,
    all_finite,
    dyadic_above,
    enclose,
    guarded,
    hull,
    is_inside,
    is_positive,
)
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.poincare import PHYSICAL, REGULARISED, WideOracle

Progress = Callable[[float], None]

_MARGIN = 16
"""The curve has to be so much closer to its polynomial than the tube is wide: neighbours may have narrower tubes."""

_PARTS, _HALVINGS = 8, 10
"""The Newton operator is evaluated on so many parts of the interval of s, each halved at most so often."""

SLOPE_BITS = 52
"""Significant bits of the derivatives across the curve; what a Newton operator needs of them is little."""

SINGULAR = "singular"
"""The condition of an interval of which no part helps: a derivative that has to be regular is not, somewhere on it."""

UNCLEAR_SLOPE = "slope"
"""The condition of an interval on which the derivative across the curve was not shown to be regular."""

_MENDED_BY_COORDINATES = ("tube", "newton", UNCLEAR_SLOPE, "singularity", "steps")
"""Conditions for which regularised coordinates are tried where the system's own fail."""


@dataclass(frozen=True)
class TubeTheorem:
    """For every s of the interval the tube contains exactly one point of an R-symmetric orbit with f^2(x) = x; it is a
    regular zero of pi_q f and depends smoothly on s; f = P^m, half orbits that meet the section m times (section 15.3).
    """

    hypotheses = ("piece", "half-return", "newton")


@dataclass(frozen=True)
class PieceLimits:
    """How to integrate a piece.

    Attributes:
        precision: fractional bits of the fixed-point format.
        order: degree of the time expansions.
        width: degree in s.
        top: highest grade across the curve that is kept.
    """

    precision: int = 80
    order: int = 40
    width: int = 40
    top: int = 1

    def __post_init__(self) -> None:
        if min(self.precision, self.order) < 16 or self.width < 1:
            raise ValueError(f"precision {self.precision}, order {self.order}, width {self.width} are too small")
        if self.top < 1:
            raise ValueError(f"top {self.top} is too small")

    def arithmetic(self, tube: Sequence[Fraction], slope_bits: int = SLOPE_BITS, top: int | None = None) -> Arithmetic:
        """The format, for an enlarged tube of these half-widths, with grades up to `top` if not to that of `self`."""
        top = self.top if top is None else top
        grade_bits = floor(-log2(max(tube))) - max(0, self.precision - slope_bits) // top
        grading = Grading((1,) * len(tube), top)
        return WideArithmetic(grading, self.precision, grade_bits, self.order, width=self.width)


def prove_piece(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    piece: Piece,
    interval: Interval,
    oracle: WideOracle,
    limits: PieceLimits | None = None,
    progress: Progress | None = None,
    symmetry: str | None = None,
    slope_bits: int = SLOPE_BITS,
    crossings: int = 1,
) -> PieceResult[ProvedInterval]:
    """Prove the claim of a piece for s in an interval within [-1, 1], or say why it is not proved.

    Args:
        parameters: exact values of the system's fixed parameters.
        oracle: finds approximations.
        progress: called after every step with the number of steps; what it raises passes through.
        symmetry: name of the symmetry of a symmetric piece.
        slope_bits: significant bits of the derivatives across the curve.
        crossings: of the section in a half orbit, its end included.
    """
    limits = PieceLimits() if limits is None else limits
    proof = _Proof(system, parameters, piece, interval, oracle, limits, symmetry, slope_bits, crossings)
    found = proof.result(progress)
    mended = isinstance(found.outcome, NotProved) and found.outcome.reason.condition in _MENDED_BY_COORDINATES
    if not (mended and found.computation.coordinates == PHYSICAL):
        return found
    from orbitproof.verify.poincare import is_regularised

    if not is_regularised(system):
        return found
    again = replace(proof, piece=replace(piece, coordinates=REGULARISED)).result(progress)
    return again if again.is_proved else found


@dataclass(frozen=True)
class _Proof:
    """The claim of a piece on an interval, and how to integrate it."""

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    piece: Piece
    asked: Interval
    oracle: WideOracle
    limits: PieceLimits
    symmetry: str | None
    slope_bits: int = SLOPE_BITS
    crossings: int = 1

    @property
    def divided(self) -> bool:
        """Whether the equations are divided by s, which their symmetry allows on an interval about 0 only."""
        return self.piece.is_symmetric and self.asked[0] <= 0 <= self.asked[1]

    @property
    def interval(self) -> Interval:
        """The interval of the proof."""
        start, end = self.asked
        return (-max(-start, end), max(-start, end)) if self.divided else (start, end)

    @property
    def middle(self) -> Fraction:
        return sum(self.interval, Fraction(0)) / 2

    @property
    def radius(self) -> Fraction:
        """ds/dsigma."""
        return (self.interval[1] - self.interval[0]) / 2 * BEYOND

    @property
    def tube(self) -> list[Fraction]:
        """dp_j/domega_j."""
        return [width / TUBE for width in self.piece.tube]

    @cached_property
    def arithmetic(self) -> Arithmetic:
        """The format, of a piece that has passed `check`."""
        return self.limits.arithmetic(self.tube, self.slope_bits)

    def result(self, progress: Progress | None) -> PieceResult[ProvedInterval]:
        """Whether the piece is proved."""
        computation: Account = {**asdict(self.limits), "steps": 0, "coordinates": ""}
        with guarded(self.limits.precision):
            return attempt(
                self.piece.id,
                self.asked,
                TubeTheorem(),
                computation,
                lambda checklist: self.check_all(checklist, computation, progress),
            )

    def check_all(self, checklist: Checklist, computation: Account, progress: Progress | None) -> ProvedInterval:
        """Check every hypothesis; raises `NotEstablishedError` at the first that is not shown."""
        self.check_claim(checklist)
        with checklist.hypothesis(
            "half-return", "15.1", "the orbits of the tube meet the section again and are enclosed", "a narrower piece"
        ) as evidence:
            half = self._half_return(computation, progress)
            equations, time = self._equations(half), half.time_of_all
            evidence.record("half period", time)
            evidence.require(len(equations) == len(self.tube), "an equation is missing")
            evidence.require(time.is_finite(), "the half periods are not enclosed")
        if self.divided:
            signs = self.system.symmetries[str(self.symmetry)]
            equations = [
                divided_by_wide(equation) if signs[index] < 0 else equation
                for index, equation in zip(self.system.kernel_coordinates, equations, strict=True)
            ]
        deviation, slope_deviation = check_newton(checklist, equations, self.radius, self.divided)
        if self.piece.is_symmetric and not self.divided:
            nearest = min(abs(end) for end in self.interval)
            slope_deviation = [bound / enclose(nearest) for bound in slope_deviation]
        bounds = in_units(self.tube, deviation), in_units(self.tube, slope_deviation)
        return ProvedInterval(*self.interval, *bounds, time, half)

    def check_claim(self, checklist: Checklist) -> None:
        """The exact conditions on the piece."""
        statement = "the piece is one of the system, with a regular frame, a tube, and the symmetry that it claims"
        with checklist.hypothesis("piece", "15.2", statement, "correct the piece") as evidence:
            start, end = self.asked
            evidence.require(-1 <= start < end <= 1, f"[{start}, {end}] is no interval within [-1, 1]")
            evidence.require(
                set(self.system.fixed_parameters) == set(self.parameters), f"{self.system.name} has other parameters"
            )
            require_piece(evidence, self.system, self.piece, self.symmetry)

    def points(self) -> dict[str, Series]:
        """The points of the tube, by the names of the coordinates, as elements in (sigma, omega)."""
        return tube_points(
            self.arithmetic, self.system.centre_coordinates, self.piece, (self.middle, self.radius), self.tube
        )

    def _half_return(self, computation: Account, progress: Progress | None) -> HalfReturn:
        """The orbits of the tube up to the end of their half orbits."""
        point = {**parameter_series(self.arithmetic, self.system, self.parameters), **self.points()}

        def begun(coordinates: str) -> None:
            computation["coordinates"] = coordinates

        def after_step(steps: int) -> None:
            computation["steps"] = steps
            if progress is not None:
                progress(steps)

        coordinates = self.piece.coordinates
        return HalfReturn.of(self.system, point, self.tube, coordinates, self.oracle, begun, after_step, self.crossings)

    def _equations(self, half: HalfReturn) -> list[Series]:
        """The kernel coordinates at the first return."""
        return [half.state[index] for index in self.system.kernel_coordinates]


def in_units(tube: Sequence[Fraction], bounds: Sequence[arb]) -> tuple[Fraction, ...]:
    """Bounds of omega_j as bounds of p_j, with few bits; `tube`: dp_j/domega_j."""
    return tuple(dyadic_above(enclose(width) * bound) for width, bound in zip(tube, bounds, strict=True))


def check_newton(
    checklist: Checklist, elements: Sequence[Series], radius: Fraction, divided: bool = False
) -> tuple[list[arb], list[arb]]:
    """Hypothesis `newton`: for every s exactly one zero in the tube; bounds of its omega and of their slopes by s.

    `radius` is ds/dsigma; `divided`: whether all equations are even in s, and slopes are those divided by s.
    """
    statement = f"on each part of the interval the Newton operator maps the tube into 1/{_MARGIN} of itself"
    with checklist.hypothesis("newton", "15.2", statement, "a narrower piece") as evidence:
        images = _images([Equation(element) for element in elements], radius, divided)
        evidence.require(
            len(images) >= _PARTS and all(is_inside(ball, TUBE / _MARGIN) for image, _ in images for ball in image),
            "it does not",
        )
    omega, slope = ([_largest([part[which][j] for part in images]) for j in range(len(elements))] for which in (0, 1))
    return omega, slope


def _images(equations: Sequence[Equation], radius: Fraction, divided: bool) -> list[tuple[list[arb], list[arb]]]:
    """Newton images and slopes of omega on parts that cover the interval of sigma."""
    found = []
    parts = [(part, 0) for part in parts_of_interval(_PARTS)]
    while parts:
        part, halvings = parts.pop()
        try:
            found.append(_newton(equations, part, radius, divided))
        except IntegrationFailure as failure:
            if halvings == _HALVINGS:
                raise _singular_between(equations) or failure from None
            parts += [(half, halvings + 1) for half in halves(part)]
    return found


def _slopes(equations: Sequence[Equation], part: arb) -> list[list[arb]]:
    return [[equation.slope(j, part) for j in range(len(equations))] for equation in equations]


def _singular_between(equations: Sequence[Equation]) -> IntegrationFailure | None:
    """Why the claim fails however short a piece is, if the derivative has determinants of both signs on the tube."""
    determinants = [arb_mat(_slopes(equations, part)).det() for part in parts_of_interval(_PARTS)]
    if not (any(map(is_positive, determinants)) and any(is_positive(-value) for value in determinants)):
        return None
    message = (
        "the determinant of the derivative across the curve changes its sign on the interval: a bifurcation is there"
    )
    remedy = "end the curve before this point, and begin another after it; the point itself may be certified (k = 1)"
    return IntegrationFailure(SINGULAR, message, remedy)


def _newton(equations: Sequence[Equation], part: arb, radius: Fraction, divided: bool) -> tuple[list[arb], list[arb]]:
    """Newton image and slope of omega on a part of the interval of sigma; raises if it is not inside the tube."""
    if not all_finite(error for equation in equations for error in equation.errors):
        raise IntegrationFailure("newton", "the half return was not enclosed", "give a narrower piece")
    across = [[equation.across(j) for equation in equations] for j in range(len(equations))]
    try:
        weights = inverse_near(equations, part.mid())
        matrix = [[combined(row, column, part) for column in across] for row in weights]
        residual = [combined(row, [equation.at_zero for equation in equations], part) for row in weights]
        image = newton_image(matrix, residual) if is_regular(matrix) else None
    except ZeroDivisionError:
        image = None
    if image is None:
        remedy = "give a narrower tube or piece, or a larger top; the curve may bifurcate or turn"
        raise IntegrationFailure(UNCLEAR_SLOPE, "the derivative across the curve may be singular", remedy)
    if not all(is_inside(ball, TUBE / _MARGIN) for ball in image):
        far = ", ".join(f"{float(ball.abs_upper() / enclose(TUBE)):.3g}" for ball in image)
        message = f"the Newton image, {far} of the tube, is not well inside of it"
        raise IntegrationFailure("newton", message, "give a better polynomial, a wider tube or a narrower piece")
    along = [equation.along(image, divided) for equation in equations]
    slope = newton_image(matrix, [combined(row, along, part) for row in weights])
    scale = enclose(radius * radius if divided else radius)
    return image, [value / scale for value in slope]


def _largest(balls: Sequence[arb]) -> arb:
    return hull(balls[0], *balls[1:]).abs_upper()
