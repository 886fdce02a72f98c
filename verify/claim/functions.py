"""That coordinates stay functions of the others along orbits (sections 1.4 and 5.5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from typing import Protocol, TypeVar

from flint import arb, fmpq_mpoly

from orbitproof.shared.systems import Program, ReversibleSystem, System, signs_with_functions, with_functions
from orbitproof.verify.claim.first_integral import AlongFlow, NotShownError, Ring
from orbitproof.verify.claim.related_functions import Functions, functions_of
from orbitproof.verify.evidence import FUNCTIONS, Checklist, Evidence, enclose, power

_PARTNERS = {"sin": "cos", "cos": "sin"}


def enclose_functions(system: System, state: Sequence[arb], parameters: Sequence[arb]) -> list[arb]:
    """The state with the coordinates that are functions of others; their own entries are not used."""
    return with_functions(system, state, parameters, FUNCTIONS, enclose, power)


def slope_of(function: str, argument: arb) -> arb:
    """The derivative of a function at the points of a ball."""
    match function:
        case "sin":
            return argument.cos()
        case "cos":
            return -argument.sin()
        case "exp":
            return argument.exp()
        case "log":
            return 1 / argument
    raise ValueError(f"{function!r} is no function of a field")


class Composable(Protocol):
    """Values and derivatives of a function, of which a function can be taken."""

    @property
    def value(self) -> arb:
        """The values."""

    def power(self: Linear, exponent: Fraction) -> Linear:
        """A power."""

    def composed(self: Linear, value: arb, slope: arb) -> Linear:
        """A function of it, with its values and its derivatives at those of this one."""


Linear = TypeVar("Linear", bound=Composable)


def with_slopes(
    system: System, state: Sequence[Linear], parameters: Sequence[Linear], constant: Callable[[Fraction], Linear]
) -> list[Linear]:
    """The given coordinates with those that are functions of them, by the chain rule."""
    zero = constant(Fraction(0))
    functions = {name: _chained(name) for name in FUNCTIONS}
    places = [*state, *[zero] * len(system.defined)]
    return with_functions(system, places, parameters, functions, constant, type(zero).power)


def _chained(name: str) -> Callable[[Linear], Linear]:
    return lambda argument: argument.composed(FUNCTIONS[name](argument.value), slope_of(name, argument.value))


def check_functions(checklist: Checklist, system: System) -> None:
    """Orbits that begin with the last coordinates as functions of the others keep them so (section 24.7)."""
    names = ", ".join(each.name for each in system.defined)
    statement = f"{names} have the rates of the functions that they are: orbits that begin with these values keep them"
    remedy = "write the functions in the formulas of the field, and no divisor in them that the field does not have"
    with checklist.hypothesis("functions", "24.7", statement, remedy) as evidence:
        message = "coordinates were not shown to stay functions of the others"
        evidence.require(keeps_its_functions(system), message)


def behind_functions(system: ReversibleSystem, program: Program) -> set[str]:
    """The inputs in the arguments of the functions that occur in a program, and in the arguments of those in them."""
    arguments = dict(zip((each.name for each in system.defined), system.argument_programs, strict=True))
    pending, found = list(program.used_inputs), set[str]()
    while pending:
        if (name := pending.pop()) in arguments:
            new = arguments[name].used_inputs - found
            found |= new
            pending += new
    return found


def keeps_functions(system: ReversibleSystem, signs: Sequence[int]) -> bool:
    """Whether the signs map the states whose last coordinates have their values as functions to such states."""
    functions = [each.function for each in system.defined]
    return tuple(signs) == signs_with_functions(functions, system.argument_programs, signs[: len(system.given_state)])


def keeps_its_functions(system: System) -> bool:
    """Whether the last coordinates are shown to be functions of earlier ones all along an orbit that begins so.

    False also where that takes a relation between the bases of different powers, or polynomials that are too large, and
    where they have other names than the last coordinates.
    """
    programs, kinds = system.argument_programs, [each.function for each in system.defined]
    given = len(system.given_state)
    names = system.state[given:]
    if names != tuple(each.name for each in system.defined):
        return False
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


def require_functions(
    evidence: Evidence, system: ReversibleSystem, involutions: Sequence[tuple[str, Sequence[int]]]
) -> Functions:
    """Require that orbits, and involutions of these signs, keep the states whose last coordinates are functions.

    Returns these, with which identities on such states are shown.
    """
    for name, signs in involutions:
        evidence.require(
            keeps_functions(system, signs),
            f"what coordinates are functions of others in the field of {system.name} was not shown to have the "
            f"symmetry {name}",
        )
    evidence.require(
        keeps_its_functions(system), f"coordinates of {system.name} were not shown to stay functions of the others"
    )
    return functions_of(system)


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
