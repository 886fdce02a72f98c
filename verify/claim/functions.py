"""That coordinates stay functions of the others along orbits (sections 1.4 and 5.5)."""

from __future__ import annotations

from functools import cache

from flint import fmpq_mpoly

from orbitproof.shared.systems import Program, System
from orbitproof.verify.claim.first_integral import AlongFlow, NotShownError, Ring

_PARTNERS = {"sin": "cos", "cos": "sin"}


def keeps_its_functions(system: System) -> bool:
    """Whether the last coordinates are shown to be functions of earlier ones all along an orbit that begins so.

    False also where that takes a relation between the bases of different powers, or polynomials that are too large.
    """
    names = [each.name for each in system.defined]
    programs, kinds = system.argument_programs, [each.function for each in system.defined]
    given = len(system.given_state)
    for place, (kind, argument) in enumerate(zip(kinds, programs, strict=True)):
        if argument.used_inputs & set(names[place:]):
            return False
        partner = None
        if kind in _PARTNERS:
            partners = [i for i, p in enumerate(programs) if kinds[i] == _PARTNERS[kind] and p == argument]
            if not partners:
                return False
            partner = given + partners[0]
        if not _moves_so(system.program, argument, kind, given + place, partner):
            return False
    return True


@cache
def _moves_so(field: Program, argument: Program, kind: str, place: int, partner: int | None) -> bool:
    """Whether the coordinate of an index has the rate of a function of its argument."""
    ring = Ring(field, argument)
    try:
        velocity = [output.value for output in field.evaluate(ring.inputs, ring.constant, AlongFlow.power)]
        ring.is_closed = True
        moving = [AlongFlow(ring, x.value, rate) for x, rate in zip(ring.inputs, velocity, strict=False)]
        inputs = [*moving, *ring.inputs[len(velocity) :]]
        (value,) = argument.evaluate(inputs, ring.constant, AlongFlow.power)
        left, right = _sides(ring, kind, velocity[place], value, ring.inputs[place if partner is None else partner])
        return ring.vanishes(ring.sum(left, -right))
    except NotShownError:
        return False


def _sides(
    ring: Ring, kind: str, rate: fmpq_mpoly, argument: AlongFlow, other: AlongFlow
) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    """w' and phi'(e) e', both times e for a logarithm; `other` is the partner of a sine or cosine, or w."""
    match kind:
        case "sin" | "exp":
            return rate, ring.product(other.value, argument.rate)
        case "cos":
            return rate, ring.product(-other.value, argument.rate)
        case "log":
            return ring.product(rate, argument.value), argument.rate
    raise NotShownError
