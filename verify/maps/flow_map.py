"""The flow of a set over a given time, with derivatives (section 23.1)."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from orbitproof.shared.systems import Program, record
from orbitproof.verify.algebra import prepare
from orbitproof.verify.evidence import IntegrationFailure, guarded
from orbitproof.verify.flow import InFrame, planned_step
from orbitproof.verify.maps.framed_orbits import FramingOracle
from orbitproof.verify.maps.image import Image, image_of
from orbitproof.verify.maps.starting_set import Format, StartingSet
from orbitproof.verify.poincare import MOST_STEPS

LEAST_SHARE = 1 / 8


def enclose_flow(
    program: Program,
    start: StartingSet,
    time: Fraction,
    chosen: Format,
    oracle: FramingOracle,
    progress: Callable[[int], None] | None = None,
) -> Image:
    """Enclose the states at `time`, of either sign, of all orbits that begin in a set, and their derivatives.

    Args:
        program: the vector field; inputs: state, then parameters.
        oracle: finds approximations; nothing is believed of it.
        progress: called after every step with the number of steps; what it raises passes through.

    Raises `IntegrationFailure`.
    """
    field = prepare(program if time > 0 else backwards(program))
    with guarded(chosen.precision):
        arithmetic = start.arithmetic(chosen)
        state, parameters = start.elements(arithmetic)
        reached, share, steps, sign = Fraction(0), 1.0, 0, 1 if time > 0 else -1
        carried = InFrame(oracle)
        while reached < abs(time):
            if steps == MOST_STEPS:
                raise IntegrationFailure(
                    "steps",
                    f"time {float(time):.6g} is not reached within {MOST_STEPS} steps",
                    "give a shorter time, and go on from an enclosure of the states there",
                ).at(float(sign * reached))
            try:
                expansion = oracle.expand(field, arithmetic, state, parameters)
                step = expansion.shortened(planned_step(expansion.step_size, share, float(sign * reached)))
                step = min(step, abs(time) - reached)
                state = list(carried.advance(field, state, parameters, expansion, step).end)
            except IntegrationFailure as failure:
                if share <= LEAST_SHARE or failure.reason.condition != "tube":
                    raise failure.at(float(sign * reached)) from None
                share /= 2
                continue
            reached, steps = reached + step, steps + 1
            if progress is not None:
                progress(steps)
        return image_of(start, state, arithmetic.constant(time), steps)


def backwards(program: Program) -> Program:
    """The negative of a vector field."""
    names = program.inputs
    return record(lambda arguments: [-value for value in program.evaluate(arguments, _same, pow)], names)


def _same(value: Fraction) -> Fraction:
    return value
