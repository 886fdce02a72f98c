"""The other point of a symmetric orbit on Fix(R) (section 15.8).

An R-symmetric orbit with P^2(x) = x meets Fix(R) in x and in P(x). A bifurcation that is certified at one of the
two points may lie on a curve of initial values through the other one.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, log2

from flint import arb

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading, Series
from orbitproof.verify.curve.equation import parameter_series
from orbitproof.verify.evidence import (
    IntegrationFailure,
    all_finite,
    exact_value,
    excludes_zero,
    guarded,
    total,
)
from orbitproof.verify.poincare import HalfOrbits, WideOracle, default_order

_LEAST_BITS = 96
_SPARE_BITS = 16


def enclose_other_point(
    oracle: WideOracle,
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Mapping[str, arb],
    crossings: int = 1,
    onto: ReversibleSystem | None = None,
) -> dict[str, arb] | None:
    """Enclosures of the coordinates of P(x) for a symmetric orbit through x, or `None` if there are none.

    Args:
        oracle: finds approximations.
        parameters: exact values of the system's fixed parameters.
        point: enclosures of the system's `centre_coordinates` at x, where P(x) is known to lie in Fix(R).
        onto: a system with the same equations whose R is meant in this, if it is not `system`.
        crossings: m, how often half orbits meet the section; P^m stands for P.
    """
    if not all_finite(point.values()):
        return None
    widest = max(float(ball.rad()) for ball in point.values())
    bits = max(_LEAST_BITS, _SPARE_BITS + ceil(-log2(widest)) if widest else 0)
    with guarded(bits):
        try:
            arithmetic = Arithmetic(Grading((1,), 0), bits, 0, default_order(bits))
            return _half_return(system, parameters, point, arithmetic, oracle, crossings, onto or system)
        except (IntegrationFailure, ArithmeticError):
            return None


def _half_return(
    system: ReversibleSystem,
    given: Mapping[str, Fraction],
    point: Mapping[str, arb],
    arithmetic: Arithmetic,
    oracle: WideOracle,
    crossings: int,
    onto: ReversibleSystem,
) -> dict[str, arb] | None:
    known = {name: _constant(arithmetic, ball) for name, ball in point.items()}
    returns = HalfOrbits(system, arithmetic, {**parameter_series(arithmetic, system, given), **known}, oracle)
    state = [_ball(element) for element in returns.half_orbit(crossings)[0]]
    if any(excludes_zero(state[index]) for index in onto.kernel_coordinates):
        # The orbit through x is not symmetric: what was said of x is wrong.
        return None
    at = dict(zip(system.state, state, strict=True))
    if system.fixed_level is not None:
        from orbitproof.verify.claim import is_in

        if not is_in(system.fixed_level, at[str(system.level_coordinate)]):
            # The curve consists of points on one sheet of the level (12.5).
            return None
    result = {name: at.get(name, point.get(name, arb("nan"))) for name in onto.centre_coordinates}
    return result if all_finite(result.values()) else None


def _constant(arithmetic: Arithmetic, ball: arb) -> Series:
    """An element that contains every number of a ball."""
    return arithmetic.constant(exact_value(ball.mid())).widened(exact_value(ball.rad()))


def _ball(element: Series) -> arb:
    """The values of an element without variables that does not depend on time."""
    value = arb(element.coefs[0][0]) * arb(2) ** -element.arithmetic.scales[0]
    return value + arb(0, 1) * total(arb(error) for error in element.errors)
