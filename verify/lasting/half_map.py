"""The return map near the orbits of a curve, to order 3, as functions along an interval of a piece (section 29.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import floor, hypot, log2

from orbitproof.verify.algebra import Series, fraction_above, inflate
from orbitproof.verify.curve import HalfReturn, parameter_series
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.functions import error_of, finite, function, inverse, known_part, restricted
from orbitproof.verify.lasting.jets import ORDER, FunctionJet, compose, inverse_of_plane_map, solved
from orbitproof.verify.poincare import PHYSICAL, HalfOrbits, first_integral
from orbitproof.verify.stability import SHARE, CurveInTube, TubeOfOrbits

Jet = FunctionJet[Series]

_FRAME = 2**16
"""Denominator of the directions that are chosen at both points."""
_SLOPE_BITS = 48
"""Significant bits of derivatives of order 3, at least; those of lower order have more, as their errors spread."""


def return_map(
    tube: TubeOfOrbits,
    half: HalfReturn,
    curve: CurveInTube,
    progress: Callable[[float], None] | None,
    odd: str | None = None,
) -> tuple[Jet, Jet]:
    """Both components of R P^-1 R P, in coordinates (p, q) of the level of each orbit about its point of the curve.

    Args:
        half: the return of the tube.
        curve: the curve in it.
        progress: called after every step with the number of steps; what it raises passes through.
        odd: the coordinate that is 0 on the curve and that a symmetry negates with q, if there is one (29.7).

    Raises `IntegrationFailure`.
    """
    system = tube.system
    names = [name for name in system.centre_coordinates if name in system.state]
    width = Fraction(2) ** floor(log2(max(half.widths)))
    points = _around(tube, half, curve, names, odd)
    own = None if odd is None else [Fraction(int(name == odd)) for name in names]
    if system.family_parameter is None:
        begun = _elements(tube, points, width)
        integral = first_integral(system, begun[names[0]].arithmetic, begun)
        assert integral is not None
        points = _on_level(tube, _jet(tube, integral, width), points, own)
    begun = _elements(tube, points, width)

    def after_step(number: float) -> None:
        if progress is not None:
            progress(half.steps + number)

    orbits = HalfOrbits(system, begun[names[0]].arithmetic, begun, tube.oracle, PHYSICAL)
    state, _ = orbits.half_orbit(tube.crossings, after_step)
    images = [_restricted(_jet(tube, state[system.state.index(name)], width)) for name in names]
    kernel = _restricted(_jet(tube, state[system.kernel_coordinates[0]], width))
    even = _combined(own or _direction([jet.coefficients[1, 0] for jet in images]), images)
    if odd is not None:
        even, kernel = (_odd_part(jet) for jet in (even, kernel))
    (a, b), (c, d) = ([jet.coefficients[unit] for unit in ((1, 0), (0, 1))] for jet in (even, kernel))
    back = inverse_of_plane_map(even, kernel, inverse(a * d - b * c))
    turned = [even.of_degrees(1), kernel.of_degrees(1).scaled(Fraction(-1))]
    return compose(back[0], turned), compose(back[1], turned).scaled(Fraction(-1))


def _around(
    tube: TubeOfOrbits, half: HalfReturn, curve: CurveInTube, names: Sequence[str], odd: str | None = None
) -> Mapping[str, Jet]:
    """The points of the curve and those beside them in the section, by increments of these coordinates and of q."""
    system, one = tube.system, tube.arithmetic.constant(Fraction(1))
    size = len(names) + 1
    units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
    found = {name: FunctionJet({(0,) * size: curve.value(half.start[name])}) for name in system.centre_coordinates}
    found |= {name: FunctionJet({}) for name in (system.state[system.kernel_coordinates[0]], odd) if name is not None}
    for name, unit in zip((*names, system.state[system.kernel_coordinates[0]]), units, strict=True):
        found[name] = found[name] + FunctionJet({unit: one})
    return found


def _on_level(
    tube: TubeOfOrbits, level: Jet, points: Mapping[str, Jet], own: Sequence[Fraction] | None = None
) -> Mapping[str, Jet]:
    """Points on the level of each orbit up to terms of order 4, by one coordinate and q; `level` is known on all.

    `own`: the direction of that coordinate, if it is not to be chosen.
    """
    one = tube.arithmetic.constant(Fraction(1))
    slopes = [level.coefficients[unit] for unit in ((1, 0, 0), (0, 1, 0))]
    across = _direction(slopes) if own is None else [own[1], -own[0]]
    along = [-across[1], across[0]]
    turned = [
        FunctionJet({(1, 0, 0): one.scaled(first), (0, 1, 0): one.scaled(second)})
        for first, second in zip(across, along, strict=True)
    ]
    turned.append(FunctionJet({(0, 0, 1): one}))
    level = compose(level, turned)
    known = [FunctionJet({unit: one}) for unit in ((1, 0), (0, 1))]
    steps = [solved(level, inverse(level.coefficients[1, 0, 0]), known), *known]
    increments = [compose(jet, steps) for jet in turned]
    found = {}
    for name, jet in points.items():
        found[name] = compose(jet, increments)
        origin = jet.coefficients.get((0, 0, 0))
        if origin is not None:
            found[name] = found[name] + FunctionJet({(0, 0): origin})
    return found


def _elements(tube: TubeOfOrbits, points: Mapping[str, Jet], width: Fraction) -> Mapping[str, Series]:
    """Points, and the parameters, as elements whose variables are the increments over `width`."""
    size = len(next(iter(next(iter(points.values())).coefficients)))
    flow = tube.limits.arithmetic([width] * size, max(_SLOPE_BITS, tube.limits.precision // 2), ORDER)
    found = parameter_series(flow, tube.system, tube.parameters)
    for name, jet in points.items():
        errors = flow.zero_errors()
        terms = {}
        for exponents, value in jet.coefficients.items():
            grade, scale = sum(exponents), width ** sum(exponents)
            terms[exponents] = [coefficient * scale for coefficient in known_part(value, 0)]
            errors[grade] = inflate(errors[grade] + fraction_above(error_of(value) * scale))
        known = flow.polynomial(terms)
        found[name] = known.with_errors([inflate(a + b) for a, b in zip(known.errors, errors, strict=True)])
    return found


def _jet(tube: TubeOfOrbits, element: Series, width: Fraction) -> Jet:
    """The Taylor coefficients on the curve, in the coordinates themselves, as functions of sigma (Lemma 29.1)."""
    grading = element.arithmetic.grading
    finite(element.errors, "the returns beside the curve were not enclosed")
    found = {}
    for position, (exponents, grade) in enumerate(zip(grading.monomials, grading.grades, strict=True)):
        scale = width**-grade
        known = [value * scale for value in known_part(element, position)]
        error = Fraction(element.errors[grade]) * scale
        found[exponents] = function(tube.arithmetic, known, error)
    return FunctionJet(found)


def _restricted(jet: Jet) -> Jet:
    """The functions of s as functions of tau."""
    return FunctionJet({index: restricted(value, SHARE) for index, value in jet.coefficients.items()})


def _odd_part(jet: Jet) -> Jet:
    """An odd function without what is enclosed of its terms of even degree, which are 0."""
    return FunctionJet({index: value for index, value in jet.coefficients.items() if sum(index) % 2})


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
