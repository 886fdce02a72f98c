"""The return map near the orbits of a curve, to order 3, as functions along an interval of a piece (section 29.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import floor, hypot, log2

from orbitproof.verify.algebra import Series, WideArithmetic
from orbitproof.verify.curve import HalfReturn, parameter_series
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.functions import error_of, finite, function, inverse, known_part, restricted
from orbitproof.verify.lasting.jets import ORDER, FunctionJet, compose, inverse_of_plane_map, solved
from orbitproof.verify.poincare import PHYSICAL, HalfOrbits, first_integral
from orbitproof.verify.stability import SHARE, STABILITY_SLOPE_BITS, CurveInTube, TubeOfOrbits

Jet = FunctionJet[Series]

_FRAME = 2**16
"""Denominator of the directions that are chosen at both points."""


def return_map(
    tube: TubeOfOrbits, half: HalfReturn, curve: CurveInTube, progress: Callable[[float], None] | None
) -> tuple[Jet, Jet]:
    """Both components of R P^-1 R P, in coordinates (p, q) of the level of each orbit about its point of the curve.

    Args:
        half: the return of the tube.
        curve: the curve in it.
        progress: called after every step with the number of steps; what it raises passes through.

    Raises `IntegrationFailure`.
    """
    system = tube.system
    names = [name for name in system.centre_coordinates if name in system.state]
    width = Fraction(2) ** floor(log2(max(half.widths)))
    flow = tube.limits.arithmetic([width] * (len(names) + 1), STABILITY_SLOPE_BITS, ORDER)
    assert isinstance(flow, WideArithmetic)
    begun = {**parameter_series(flow, system, tube.parameters), **_around(tube, half, curve, flow, names, width)}

    def after_step(number: float) -> None:
        if progress is not None:
            progress(half.steps + number)

    state, _ = HalfOrbits(system, flow, begun, tube.oracle, PHYSICAL).half_orbit(tube.crossings, after_step)
    images = [_jet(tube, state[system.state.index(name)], width) for name in names]
    kernel = _jet(tube, state[system.kernel_coordinates[0]], width)
    if system.family_parameter is None:
        integral = first_integral(system, flow, begun)
        assert integral is not None
        *images, kernel = _on_level(tube, _jet(tube, integral, width), [*images, kernel])
    even = _combined(_direction([jet.coefficients[1, 0] for jet in images]), images)
    (a, b), (c, d) = ([jet.coefficients[unit] for unit in ((1, 0), (0, 1))] for jet in (even, kernel))
    back = inverse_of_plane_map(even, kernel, inverse(a * d - b * c))
    turned = [even.of_degrees(1), kernel.of_degrees(1).scaled(Fraction(-1))]
    return compose(back[0], turned), compose(back[1], turned).scaled(Fraction(-1))


def _around(
    tube: TubeOfOrbits,
    half: HalfReturn,
    curve: CurveInTube,
    flow: WideArithmetic,
    names: Sequence[str],
    width: Fraction,
) -> Mapping[str, Series]:
    """The points of the curve and those beside them in the section: width omega is added to each coordinate."""
    system = tube.system
    size = len(names) + 1
    units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
    across = dict(zip(names, units, strict=False))
    found = {system.state[system.kernel_coordinates[0]]: flow.polynomial({units[-1]: width})}
    for name in system.centre_coordinates:
        element = curve.value(half.start[name])
        terms: dict[tuple[int, ...], Fraction | Sequence[Fraction]] = {(0,) * size: known_part(element, 0)}
        if name in across:
            terms[across[name]] = width
        found[name] = flow.polynomial(terms).widened(error_of(element))
    return found


def _jet(tube: TubeOfOrbits, element: Series, width: Fraction) -> Jet:
    """The Taylor coefficients on the curve, in the coordinates themselves, as functions of tau (Lemma 29.1)."""
    grading = element.arithmetic.grading
    finite(element.errors, "the returns beside the curve were not enclosed")
    found = {}
    for position, (exponents, grade) in enumerate(zip(grading.monomials, grading.grades, strict=True)):
        scale = width**-grade
        known = [value * scale for value in known_part(element, position)]
        error = Fraction(element.errors[grade]) * scale
        found[exponents] = restricted(function(tube.arithmetic, known, error), SHARE)
    return FunctionJet(found)


def _on_level(tube: TubeOfOrbits, level: Jet, functions: Sequence[Jet]) -> list[Jet]:
    """Functions of both coordinates of Fix(R) and of q on the level of each orbit, by one coordinate and q."""
    one = tube.arithmetic.constant(Fraction(1))
    across = _direction([level.coefficients[unit] for unit in ((1, 0, 0), (0, 1, 0))])
    along = [-across[1], across[0]]
    turned = [
        FunctionJet({(1, 0, 0): one.scaled(first), (0, 1, 0): one.scaled(second)})
        for first, second in zip(across, along, strict=True)
    ]
    turned.append(FunctionJet({(0, 0, 1): one}))
    level, *functions = (compose(jet, turned) for jet in (level, *functions))
    known = [FunctionJet({unit: one}) for unit in ((1, 0), (0, 1))]
    increments = [solved(level, inverse(level.coefficients[1, 0, 0]), known), *known]
    return [compose(jet, increments) for jet in functions]


def _direction(slopes: Sequence[Series]) -> list[Fraction]:
    """About the direction of a vector at the middle of the interval; no result depends on it."""
    values = [float((known_part(slope, 0) or [Fraction(0)])[0]) for slope in slopes]
    length = hypot(*values)
    if not 0 < length < float("inf"):
        raise IntegrationFailure("stability", "a direction in the section is not found", "give a narrower piece")
    return [Fraction(round(value / length * _FRAME), _FRAME) for value in values]


def _combined(factors: Sequence[Fraction], jets: Sequence[Jet]) -> Jet:
    first, *others = (jet.scaled(factor) for jet, factor in zip(jets, factors, strict=True))
    return sum(others, first)
