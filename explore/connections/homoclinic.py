"""Symmetric homoclinic orbits of reversible systems with two degrees of freedom, on a level of the first integral.

On one level the section is a surface with the coordinates (p, q); R maps (p, q) to (p, -q), and Fix(R) is q = 0. A
symmetric periodic orbit meets the section in a point of Fix(R). Its unstable manifold leaves in the direction (1,
slope). Points of the manifold that come to Fix(R) lie on homoclinic orbits, because R maps the unstable manifold to
the stable one. Not rigorous.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import log, log2
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.connections.swarm import Array, crossings_of
from orbitproof.explore.numerics import fraction, mpf, working_context
from orbitproof.explore.refinement import (
    IntegrationFailure,
    Jet,
    JetBasis,
    RefinementFailure,
    operations,
    section_crossings,
)
from orbitproof.shared.systems import ReversibleSystem

_FIRST = 1e-7
"""Samples of the unstable manifold begin so far from the periodic orbit, relative to its distance from 0."""
_EARLY = 1e-4
"""They reach at least so far: where the multiplier is small they begin farther away."""
_SAMPLES = 64
_FARTHER = 5
"""Orbits of the unstable manifold are followed for so many times the crossings in a period after they have left."""
_NEWTON_STEPS = 40
_ABOUT = 0.03
"""A periodic orbit is looked for so far about a guess, relative to its distance from 0."""
_TIME = 1e3
"""Half a period takes no longer."""
_FEW_BITS = 64
_LONGEST = 12
"""Orbits are followed for so many periods longer than the periodic orbit has as many crossings."""
_REFINEMENTS = 3
_CLOSE = 0.1
_CLOSEST = 1e-4
"""Where q changes its sign and is not so small, it jumps."""


class ConnectionFailure(RefinementFailure):
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

    @property
    def _values(self) -> list[float]:
        return [float(self.parameters[name]) for name in self.system.parameters]

    def states(self, p: Array, q: Array) -> Array:
        """The states at points of the section, shape (4, N), in double precision; NaN where the level has none."""
        integral, place = self.system.first_integral_program, self.system.state.index(str(self.system.level_coordinate))
        assert integral is not None
        state = np.zeros((4, len(p)))
        state[self.along], state[self.across] = p, q

        def height(w: float) -> Array:
            state[place] = w
            found: Array = integral.evaluate([*state, *self._values], float, _power)[0]
            return found

        rest, one = height(0.0), height(1.0)
        with np.errstate(invalid="ignore"):
            state[place] = self.sign * np.sqrt((float(self.level) - rest) / (one - rest))
        return state

    def field(self, states: Array) -> Array:
        """The vector field at many states, shape (4, N), in double precision."""
        values = self.system.program.evaluate([*states, *self._values], float, _power)
        return np.array([np.broadcast_to(value, states.shape[1:]) for value in values])

    def crossings_of(self, start: Array, most: int, time: float) -> Array:
        """The crossings of the section by many orbits and their times, shape (most, 5, N), as `swarm.crossings_of`."""

        def field(states: Array) -> Array:
            return np.vstack([self.field(states[:-1]), np.ones_like(states[-1:])])

        start = np.vstack([start, np.zeros_like(start[-1:])])
        return crossings_of(field, start, self.system.section_index, most, time)

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

    @property
    def first(self) -> float:
        """The distance at which the unstable manifold is sampled, up to so many times as far as the multiplier says."""
        return max(_FIRST, _EARLY / abs(float(self.multiplier))) * max(1.0, abs(float(self.p)))

    @property
    def crossings(self) -> int:
        """So many crossings from there orbits are followed: as many as they take to leave, and some more."""
        returns = int(-log(self.first) / log(abs(float(self.multiplier))))
        return 2 * self.half * (returns + _FARTHER)


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
    p = context.mpf(_nearest(setting, float(guess), half))
    try:
        for _ in range(_NEWTON_STEPS):
            at = nth_place(setting.crossings(p, 0, [(1, 0)], few), half)
            step = at.q / at.slopes[1][0]
            p -= step
            size = abs(step) / (1 + abs(p))
            if few == bits and size < context.ldexp(1, 32 - bits):
                break
            # Newton's method doubles the digits.
            few = bits if size < context.ldexp(1, -bits // 4) else min(bits, max(few, _FEW_BITS - 2 * int(log2(size))))
        else:
            raise ConnectionFailure(f"no symmetric periodic orbit is found near {float(guess):.10g} on this level")
        back = nth_place(setting.crossings(p, 0, [(1, 0), (0, 1)], bits), 2 * half)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise ConnectionFailure(f"the periodic orbit is not found: {failure}") from None
    (a, b), (_, d) = back.slopes
    square = (a + d) ** 2 / 4 - 1
    if not square > 0:
        raise ConnectionFailure("the orbit is not hyperbolic: it has no unstable manifold")
    half_trace = (a + d) / 2
    multiplier = half_trace + context.sqrt(square) * (1 if half_trace > 0 else -1)
    slope = (multiplier - a) / b
    return Hyperbolic(setting, half, fraction(p), fraction(multiplier), fraction(slope), back.time)


def _nearest(setting: OnLevel, guess: float, half: int) -> float:
    """About where the orbit nearest to a guess is: Newton's method alone goes far from a guess that is not close."""
    p = guess + _ABOUT * max(1.0, abs(guess)) * np.linspace(-1, 1, 2 * _SAMPLES + 1)
    heights = setting.crossings_of(setting.states(p, 0 * p), half, _TIME)[-1, setting.across]
    # Where q jumps there is no orbit: its values on both sides are far from 0 there.
    places = [i for i in _changes(heights) if min(abs(heights[i : i + 2])) < _CLOSE]
    if not places:
        return guess
    place = min(places, key=lambda i: abs(p[i] + p[i + 1] - 2 * guess))
    part = heights[place] / (heights[place] - heights[place + 1])
    return float(p[place] + part * (p[place + 1] - p[place]))


def homoclinic_orbits(orbit: Hyperbolic, side: int, arrivals: Collection[int] = ()) -> list[Homoclinic]:
    """Orbits of one branch of the unstable manifold that come to Fix(R) at certain crossings.

    Arguments:
        side: 1 for the branch on which p grows, -1 for the other.
        arrivals: numbers of these crossings, counted from the fundamental interval that is sampled; by default the
            first at which there are such orbits.
    """
    length = log(abs(float(orbit.multiplier))) * (1 if orbit.multiplier > 0 else 2)
    first = side * orbit.first
    distances = first * np.exp(length * np.linspace(0, 1, _SAMPLES + 1))
    found = []
    heights = _heights(orbit, distances, max(arrivals, default=orbit.crossings))
    for number in sorted(arrivals) or range(1, len(heights) + 1):
        if found and not arrivals:
            break
        for place in _changes(heights[number - 1]):
            ends = distances[place], distances[place + 1]
            for _ in range(_REFINEMENTS):
                inner = np.linspace(*ends, _SAMPLES + 1)
                values = _heights(orbit, inner, number)[-1]
                changes = _changes(values)
                if len(changes) != 1:
                    break
                ends = inner[changes[0]], inner[changes[0] + 1]
            else:
                # Where q jumps, the orbits between have other crossings.
                if abs(values[changes[0]]) < _CLOSEST:
                    found.append(Homoclinic(orbit, Fraction(float(sum(ends) / 2)), number))
    return found


def _changes(values: Array) -> list[int]:
    """Where a function changes its sign from one sample to the next."""
    return [int(place) for place in np.flatnonzero(values[:-1] * values[1:] < 0)]


def _heights(orbit: Hyperbolic, distances: Array, most: int) -> Array:
    """q at the next crossings, shape (most, N), NaN where an orbit has not so many."""
    setting = orbit.setting
    start = setting.states(float(orbit.p) + distances, float(orbit.slope) * distances)
    time = orbit.period * (most / (2 * orbit.half) + _LONGEST)
    return setting.crossings_of(start, most, time)[:, setting.across]


def from_manifold(orbit: Hyperbolic, distance: Any, bits: int, *signs: int) -> Iterator[Place]:
    """The crossings from (1, slope) a, with derivatives in a, and in s for the sign -1."""
    context = working_context(bits)
    a, slope = mpf(distance, context), mpf(orbit.slope, context)
    directions = [(1, sign * slope) for sign in signs]
    return orbit.setting.crossings(mpf(orbit.p, context) + a, slope * a, directions, bits)


def refined(orbit: Hyperbolic, guess: Fraction, number: int, digits: int) -> Homoclinic:
    """The point of the unstable direction whose orbit meets Fix(R) at crossing `number`. Raises `ConnectionFailure`."""
    # What is lost on the way, from the distance of the start to that of the end.
    lost = 32 - int(log2(abs(guess)))
    bits = lost + 32 + round(3.33 * digits)
    context, few = working_context(bits), lost + 32
    a = mpf(guess, context)
    try:
        for _ in range(_NEWTON_STEPS):
            at = nth_place(from_manifold(orbit, fraction(a), few, 1), number)
            step = at.q / at.slopes[1][0]
            a -= step
            few = bits if abs(step) < 1e-4 * abs(a) else few
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


def slopes_at_arrival(found: Homoclinic) -> list[tuple[float, float]]:
    """Derivatives of p and q there in a and in s, the coordinates along the two directions of the periodic orbit."""
    bits = 64 - int(log2(abs(found.distance)))
    slopes = nth_place(from_manifold(found.orbit, found.distance, bits, 1, -1), found.crossings).slopes
    return [(float(along), float(across)) for along, across in slopes]


def _power(base: Array, power: Fraction) -> Array:
    return base ** float(power)


def _number(value: Any, context: mpmath.MPContext) -> Any:
    return mpf(value, context) if isinstance(value, Fraction) else context.mpf(value)


def nth_place(places: Iterator[Place], number: int) -> Place:
    """The one of that number, counted from 1."""
    for _ in range(number - 1):
        next(places)
    return next(places)
