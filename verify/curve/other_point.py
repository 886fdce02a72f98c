"""The other point of a symmetric orbit on Fix(R), and its crossings of another section (sections 15.8 and 16.11).

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
from orbitproof.verify.curve.followed import Crossing
from orbitproof.verify.evidence import (
    IntegrationFailure,
    all_finite,
    enclose,
    exact_value,
    excludes_zero,
    guarded,
    is_below,
    power,
    total,
)
from orbitproof.verify.poincare import HalfOrbits, WideOracle, default_order

_LEAST_BITS = 96
_LEAST_SPAN = arb(2) ** -400


def enclose_crossings(
    oracle: WideOracle,
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Mapping[str, arb],
    crossings: int,
) -> list[Crossing] | None:
    """See `Follow`: `point` has enclosures of coordinates of the section, those that it lacks are 0 or normalised."""
    if not all_finite(point.values()):
        return None
    with guarded(_bits_for(point)):
        try:
            returns = _from_point(system, parameters, point, oracle)
            found = []
            for _ in range(crossings):
                state, time = returns.next_crossing()
                found.append(Crossing(dict(zip(system.state, map(_ball, state), strict=True)), time))
        except (IntegrationFailure, ArithmeticError):
            return None
    return found if all_finite(ball for each in found for ball in (*each.state.values(), each.time)) else None


def meets_section_once(
    system: ReversibleSystem, parameters: Mapping[str, arb], state: Mapping[str, arb], span: arb
) -> bool:
    """Whether every orbit through states of the section meets it at no other time up to `span` (Lemma 16.9).

    Args:
        parameters: all of them, by name.
        state: enclosures of all coordinates.
        span: of time, forwards and backwards.
    """
    known = [parameters[name] for name in system.parameters]

    def velocity(at: Mapping[str, arb]) -> list[arb]:
        return system.program.evaluate([*(at[name] for name in system.state), *known], enclose, power)

    if not all_finite([span, *state.values(), *known]):
        return False
    longest = arb(span.abs_upper()) + _LEAST_SPAN
    reach = 2 * longest * total(arb(speed.abs_upper()) for speed in velocity(state)) + _LEAST_SPAN
    fast = velocity({name: state[name] + arb(0, 1) * reach for name in system.state})
    stays = all(is_below(longest * arb(speed.abs_upper()), reach) for speed in fast)
    return stays and excludes_zero(fast[system.section_index])


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
    with guarded(_bits_for(point)):
        try:
            return _half_return(system, parameters, point, oracle, crossings, onto or system)
        except (IntegrationFailure, ArithmeticError):
            return None


def _half_return(
    system: ReversibleSystem,
    given: Mapping[str, Fraction],
    point: Mapping[str, arb],
    oracle: WideOracle,
    crossings: int,
    onto: ReversibleSystem,
) -> dict[str, arb] | None:
    returns = _from_point(system, given, point, oracle)
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


def _bits_for(point: Mapping[str, arb]) -> int:
    """The precision that suits enclosures."""
    widest = max(float(ball.rad()) for ball in point.values())
    return max(_LEAST_BITS, _SPARE_BITS + ceil(-log2(widest)) if widest else 0)


def _from_point(
    system: ReversibleSystem, given: Mapping[str, Fraction], point: Mapping[str, arb], oracle: WideOracle
) -> HalfOrbits:
    """The orbits of all states in given enclosures, at the current precision."""
    bits = _bits_for(point)
    arithmetic = Arithmetic(Grading((1,), 0), bits, 0, default_order(bits))
    known = {name: _constant(arithmetic, ball) for name, ball in point.items()}
    return HalfOrbits(system, arithmetic, {**parameter_series(arithmetic, system, given), **known}, oracle)


def _constant(arithmetic: Arithmetic, ball: arb) -> Series:
    """An element that contains every number of a ball."""
    return arithmetic.constant(exact_value(ball.mid())).widened(exact_value(ball.rad()))


def _ball(element: Series) -> arb:
    """The values of an element without variables that does not depend on time."""
    value = arb(element.coefs[0][0]) * arb(2) ** -element.arithmetic.scales[0]
    return value + arb(0, 1) * total(arb(error) for error in element.errors)
