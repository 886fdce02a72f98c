"""Symmetric homoclinic orbits of reversible systems with two degrees of freedom, on a level of the first integral.

The section of the system on one level is a surface with the coordinates (p, q); R maps (p, q) to (p, -q), and Fix(R) is
q = 0. A symmetric periodic orbit meets the section in a point of Fix(R). Its unstable manifold leaves in the direction
(1, slope), and points of the manifold that come to Fix(R) lie on homoclinic orbits, because R maps the unstable manifold
to the stable one. Not rigorous.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import exp, log, log2
from typing import Any

import mpmath

from orbitproof.explore.flow import Flow, FlowFailure, flow_of
from orbitproof.explore.numerics import fraction, mpf, working_context
from orbitproof.explore.refinement import IntegrationFailure, Jet, JetBasis, operations, section_crossings
from orbitproof.shared.systems import ReversibleSystem

_FIRST = 1e-7
"""Samples of the unstable manifold begin so far from the periodic orbit, relative to its distance from 0."""
_SAMPLES = 96
_NEWTON_STEPS = 40
_FEW_BITS = 64
_BISECTIONS = 40
_POLISH = 3
_LONGEST = 40
"""Orbits are followed for so many half periods."""
_CLOSEST = 1e-6
"""Where q changes its sign and is not so small, it jumps."""


class ConnectionFailure(Exception):
    """There is no such orbit, or it is not found; the message is one line that says why."""


@dataclass(frozen=True)
class OnLevel:
    """The section of a system on one level of its first integral, with coordinates (p, q).

    Attributes:
        system: of 4 coordinates of which R fixes 2, without family parameter; its first integral is A + b w^2 in its
            level coordinate w.
        parameters: exact values, by name.
        level: of the first integral.
        sign: of w at the points of the section that are meant.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    level: Fraction
    sign: int

    def __post_init__(self) -> None:
        """Raises `ConnectionFailure` for a system that has no such coordinates."""
        system = self.system
        if len(system.given_state) != 4 or len(system.fixed_coordinates) != 2 or system.first_integral is None:
            raise ConnectionFailure(
                f"{system.name}: give a system of 4 coordinates of which R fixes 2, with a first integral"
            )
        if system.level_coordinate is None:
            raise ConnectionFailure(f"{system.name}: names no coordinate that follows from the level")

    @property
    def along(self) -> int:
        """Index of p in the state."""
        others = (i for i in self.system.fixed_coordinates if self.system.state[i] != self.system.level_coordinate)
        return next(others)

    @property
    def across(self) -> int:
        """Index of q in the state."""
        return self.system.kernel_coordinates[0]

    def start(self, p: Jet, q: Jet, context: mpmath.MPContext) -> list[Jet]:
        """The state at points of the section. Raises `IntegrationFailure` where the level has none."""
        system, basis = self.system, p.basis
        constant, power = operations(context)
        integral = system.first_integral_program
        assert integral is not None
        place = system.state.index(str(system.level_coordinate))
        given = [constant(self.parameters[name]) for name in system.parameters]

        def height(w: int) -> Jet:
            state = [basis.constant(context.mpf(0)) for _ in system.state]
            state[self.along], state[self.across], state[place] = p, q, basis.constant(context.mpf(w))
            (found,) = integral.evaluate([*state, *given], constant, power)
            return found if isinstance(found, Jet) else basis.constant(found)

        rest, one = height(0), height(1)
        square = (basis.constant(constant(self.level)) - rest) / (one - rest)
        if not square.coefficients[0] > 0:
            raise IntegrationFailure(f"no point of the level {float(self.level):.6g} lies over this point")
        result = [basis.constant(context.mpf(0)) for _ in system.state]
        result[self.along], result[self.across] = p, q
        result[place] = square.power(Fraction(1, 2), power) * self.sign
        return result

    def crossings(self, p: Any, q: Any, directions: Sequence[Sequence[Any]], bits: int) -> Iterator[Place]:
        """The successive crossings of the section by the orbit of a point, with derivatives in some directions."""
        context = working_context(bits)
        basis = JetBasis.graded((1,) * max(1, len(directions)), 1 if directions else 0)
        jets = []
        for number, value in enumerate((p, q)):
            jet = basis.constant(_number(value, context))
            for variable, direction in enumerate(directions):
                jet.coefficients[basis.variable(variable)] = _number(direction[number], context)
            jets.append(jet)
        start = self.start(*jets, context)
        for crossing in section_crossings(self.system, self.parameters, start, None, context):
            found = [crossing.jets[i] for i in (self.along, self.across)]
            slopes = [[jet.coefficients[basis.variable(v)] for v in range(len(directions))] for jet in found]
            yield Place(found[0].coefficients[0], found[1].coefficients[0], slopes, crossing.time)


@dataclass(frozen=True)
class Place:
    """A crossing of the section.

    Attributes:
        p, q: its coordinates, numbers of mpmath.
        slopes: derivatives of p and of q in the directions that were asked for.
        time: since the start.
    """

    p: Any
    q: Any
    slopes: Sequence[Sequence[Any]]
    time: float


@dataclass(frozen=True)
class Hyperbolic:
    """A hyperbolic symmetric periodic orbit on its level.

    Attributes:
        setting: the section and the level.
        half: the number of crossings of the section in half a period.
        p: its point on Fix(R), exact.
        multiplier: the one of absolute value above 1.
        slope: its unstable direction is (1, slope) in (p, q), the stable one (1, -slope).
        period: of the orbit.
    """

    setting: OnLevel
    half: int
    p: Fraction
    multiplier: Fraction
    slope: Fraction
    period: float

    def point_at(self, distance: float) -> tuple[float, float]:
        """(p, q) at a distance a on the unstable direction."""
        return float(self.p) + distance, float(self.slope) * distance


@dataclass(frozen=True)
class Homoclinic:
    """A symmetric homoclinic orbit.

    Attributes:
        orbit: the periodic orbit to which it tends.
        distance: a, its point p + a, slope a on the unstable manifold, to first order in a; exact.
        crossings: the number of crossings of the section from there to Fix(R).
    """

    orbit: Hyperbolic
    distance: Fraction
    crossings: int


def hyperbolic_orbit(setting: OnLevel, guess: Fraction, half: int, digits: int) -> Hyperbolic:
    """The symmetric periodic orbit near a point of Fix(R). Raises `ConnectionFailure`."""
    bits = 64 + round(3.33 * digits)
    context, few = working_context(bits), _FEW_BITS
    p = mpf(guess, context)
    try:
        for _ in range(_NEWTON_STEPS):
            at = _nth(setting.crossings(p, 0, [(1, 0)], few), half)
            step = at.q / at.slopes[1][0]
            p -= step
            size = abs(step) / (1 + abs(p))
            if few == bits and size < context.ldexp(1, 32 - bits):
                break
            # Newton's method doubles the digits.
            few = bits if size < context.ldexp(1, -bits // 4) else min(bits, max(few, _FEW_BITS - 2 * int(log2(size))))
        else:
            raise ConnectionFailure(f"no symmetric periodic orbit is found near {float(guess):.10g} on this level")
        back = _nth(setting.crossings(p, 0, [(1, 0), (0, 1)], bits), 2 * half)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise ConnectionFailure(f"the periodic orbit is not found: {failure}") from None
    (a, b), (c, d) = back.slopes
    square = (a + d) ** 2 / 4 - 1
    if not square > 0:
        raise ConnectionFailure("the orbit is not hyperbolic: it has no unstable manifold")
    half_trace = (a + d) / 2
    multiplier = half_trace + context.sqrt(square) * (1 if half_trace > 0 else -1)
    slope = (multiplier - a) / b
    return Hyperbolic(setting, half, fraction(p), fraction(multiplier), fraction(slope), back.time)


def homoclinic_orbits(
    orbit: Hyperbolic, side: int, most: int, progress: Callable[[float], None] | None = None
) -> list[Homoclinic]:
    """Orbits of one branch of the unstable manifold that come to Fix(R) at one of the next `most` crossings.

    Arguments:
        side: 1 for the branch on which p grows, -1 for the other.
        progress: is called with the share of the samples that is done.
    """
    samples = []
    length = log(abs(float(orbit.multiplier))) * (1 if orbit.multiplier > 0 else 2)
    first = _FIRST * max(1.0, abs(float(orbit.p)))
    for number in range(_SAMPLES + 1):
        distance = side * first * exp(length * number / _SAMPLES)
        samples.append((distance, _heights(orbit, distance, most)))
        if progress is not None:
            progress(number / _SAMPLES)
    found = []
    for (low, left), (high, right) in zip(samples, samples[1:], strict=False):
        for number, (one, other) in enumerate(zip(left, right, strict=False), start=1):
            if one * other < 0:
                root = _root(orbit, low, high, one, number)
                if root is not None:
                    found.append(root)
    return found


def _heights(orbit: Hyperbolic, distance: float, most: int) -> list[float]:
    """q at the next crossings, as many as the orbit has before it comes too close to a singularity."""
    setting = orbit.setting
    flow, section = flow_of(setting.system), setting.system.section_index
    parameters = [float(setting.parameters[name]) for name in setting.system.parameters]
    result: list[float] = []
    try:
        context = working_context(53)
        jets = (JetBasis.graded((1,), 0).constant(context.mpf(value)) for value in orbit.point_at(distance))
        state = [float(jet.coefficients[0]) for jet in setting.start(*jets, context)]
        side = 0.0
        for _ in range(_LONGEST):
            path = flow.samples(state, orbit.period / 2, parameters)
            for before, after in pairwise(path):
                if side * after[section] < 0:
                    result.append(float(_onto(flow, before, after, parameters, section)[setting.across]))
                    if len(result) == most:
                        return result
                side = after[section] or side
            state = path[-1]
    except (FlowFailure, IntegrationFailure, ZeroDivisionError):
        pass
    return result


def _onto(flow: Flow, before: Any, after: Any, parameters: Sequence[float], section: int) -> Any:
    """The state on the section between two others, by Newton's method in the time from the nearer one."""
    state = before if abs(before[section]) < abs(after[section]) else after
    for _ in range(_POLISH):
        rate = flow.derivative(state, 0.0, parameters).velocity[section]
        state = flow.derivative(state, -state[section] / rate, parameters).state
    return state


def _from(orbit: Hyperbolic, distance: Any, bits: int, with_slope: bool) -> Iterator[Place]:
    context = working_context(bits)
    a, slope = mpf(distance, context), mpf(orbit.slope, context)
    directions = [(1, slope)] if with_slope else []
    return orbit.setting.crossings(mpf(orbit.p, context) + a, slope * a, directions, bits)


def _root(orbit: Hyperbolic, low: float, high: float, value: float, number: int) -> Homoclinic | None:
    """By bisection; `None` if q jumps there, where the orbits between have other crossings."""
    last = value
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        heights = _heights(orbit, middle, number)
        if len(heights) < number:
            return None
        last = heights[-1]
        low, high = (middle, high) if last * value > 0 else (low, middle)
    return Homoclinic(orbit, Fraction(low), number) if abs(last) < _CLOSEST else None


def refined(orbit: Hyperbolic, guess: Fraction, number: int, digits: int) -> Homoclinic:
    """The point of the unstable direction whose orbit meets Fix(R) at crossing `number`. Raises `ConnectionFailure`."""
    bits = 96 + round(3.33 * digits)
    context = working_context(bits)
    a = mpf(guess, context)
    try:
        for _ in range(_NEWTON_STEPS):
            at = _nth(_from(orbit, fraction(a), bits, True), number)
            step = at.q / at.slopes[1][0]
            a -= step
            if abs(step) < context.mpf(10) ** -digits * abs(a):
                return Homoclinic(orbit, fraction(a), number)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise ConnectionFailure(f"the homoclinic orbit is not found: {failure}") from None
    raise ConnectionFailure("Newton's method for the homoclinic orbit does not converge")


def closer(found: Homoclinic, distance: float, digits: int) -> Homoclinic:
    """The same orbit from an earlier point on the unstable manifold, one whose |a| is at most `distance`."""
    orbit, a, number = found.orbit, found.distance, found.crossings
    while abs(a) > distance:
        a, number = a / orbit.multiplier, number + 2 * orbit.half
    return refined(orbit, a, number, digits)


def _number(value: Any, context: mpmath.MPContext) -> Any:
    return mpf(value, context) if isinstance(value, Fraction) else context.mpf(value)


def _nth(places: Iterator[Place], number: int) -> Place:
    for _ in range(number - 1):
        next(places)
    return next(places)
