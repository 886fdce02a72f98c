"""The period of an orbit of a forced system is a multiple of that of the force (section 24.8)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache

from flint import arb, ctx

from orbitproof.shared.formats import InSection
from orbitproof.shared.systems import FORCE_AT_START, Program, System
from orbitproof.verify.claim.first_integral import AlongFlow, NotShownError, Ring
from orbitproof.verify.evidence import enclose, excludes_zero, power

_PRECISION = 256


@dataclass(frozen=True)
class PeriodsOfForce:
    """A period T = 2 pi q/omega.

    Attributes:
        number: q, at least 1.
        rate: omega > 0, exactly or in a ball.
    """

    number: int
    rate: Fraction | arb


def periods_of_force(
    system: System, parameters: Mapping[str, Fraction | arb], point: Mapping[str, arb], period: arb
) -> PeriodsOfForce | None:
    """How often a force turns within a period (Lemma 24.6); `None` if there is none, or that is not known.

    Args:
        parameters: the values of all that are the same for the orbits in question.
        point: of one of these orbits, as far as it is known.
        period: contains the least periods of all of them.
    """
    circle = _circle(system)
    if circle is None or not {*circle.inputs} <= {*FORCE_AT_START, *parameters} or not _turns(circle):
        return None
    if not any(excludes_zero(point[name]) for name in FORCE_AT_START if name in point):
        return None
    with ctx.workprec(_PRECISION):
        rate = _rate(circle, parameters)
        number = (_ball(rate) * period / (2 * arb.pi())).unique_fmpz()
    return None if number is None or number < 1 else PeriodsOfForce(int(number), rate)


def of_orbit(
    claim: InSection, point: Mapping[str, arb], period: arb, parameter: arb | None = None
) -> PeriodsOfForce | None:
    """The same of one orbit of a claim; `parameter` encloses the value, there, of what varies."""
    values: dict[str, Fraction | arb] = {**claim.parameters}
    if claim.parameter is not None:
        assert parameter is not None
        values[claim.parameter] = parameter
    return periods_of_force(claim.system, values, point, period)


def _circle(system: System) -> Program | None:
    """The field in the coordinates of the force, as a program of what it uses; `None` if it does not use them."""
    if not {*FORCE_AT_START} <= {*system.given_state}:
        return None
    program = system.program
    outputs = [program.outputs[system.state.index(name)] for name in FORCE_AT_START]
    kept, pending = set[int](), list(outputs)
    while pending:
        kept.add(index := pending.pop())
        pending += {*program.instructions[index].operands} - kept
    steps = {index: program.instructions[index] for index in sorted(kept)}
    inputs = tuple(step.name for step in steps.values() if step.name is not None)
    if not {*FORCE_AT_START} <= {*inputs}:
        return None
    place = {old: new for new, old in enumerate(steps)}
    alone = (replace(step, operands=tuple(place[each] for each in step.operands)) for step in steps.values())
    return Program(inputs, tuple(alone), tuple(place[old] for old in outputs))


@cache
def _turns(circle: Program) -> bool:
    """Whether (24.2) is shown, c being the second function at the start of the force."""
    ring = Ring(circle, circle)
    here = dict(zip(circle.inputs, ring.inputs, strict=True))
    at_start = {name: ring.constant(Fraction(value)) for name, value in FORCE_AT_START.items()}
    try:
        u_slope, w_slope = circle.evaluate(list(here.values()), ring.constant, AlongFlow.power)
        _, c = circle.evaluate(list((here | at_start).values()), ring.constant, AlongFlow.power)
        u, w = (here[name] for name in FORCE_AT_START)
        g = (ring.constant(Fraction(1)) - u * u - w * w) * ring.constant(Fraction(1, 4))
        rests = (u_slope - c * (g * u - w), w_slope - c * (u + g * w))
        return all(ring.vanishes(rest.value) for rest in rests)
    except NotShownError:
        return False


def _rate(circle: Program, parameters: Mapping[str, Fraction | arb]) -> Fraction | arb:
    """|c|, exactly if no root is taken, all values are exact and c is not longer than a ball."""
    start = {name: Fraction(value) for name, value in FORCE_AT_START.items()}
    arguments = [{**parameters, **start}[name] for name in circle.inputs]
    try:
        if all(isinstance(value, Fraction) for value in arguments):
            exact: Fraction = circle.evaluate(arguments, Fraction, _exact_power)[1]
            if (exact.numerator * exact.denominator).bit_length() <= _PRECISION:
                return abs(exact)
    except (ValueError, ZeroDivisionError):
        # In balls the root is taken, and what is divided by 0 is not finite.
        pass
    ball: arb = circle.evaluate(list(map(_ball, arguments)), enclose, power)[1]
    return abs(ball)


def _exact_power(base: Fraction, exponent: Fraction) -> Fraction:
    if exponent.denominator > 1:
        raise ValueError("a root is not exact")
    return base ** int(exponent)


def _ball(value: Fraction | arb) -> arb:
    return value if isinstance(value, arb) else enclose(value)
