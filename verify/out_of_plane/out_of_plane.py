"""Variations out of the plane of motion along the half orbits of a curve (section 21)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.evidence import IntegrationFailure, NotKnown
from orbitproof.verify.functions import StoredFunction, error_of, known_part, restricted
from orbitproof.verify.out_of_plane.variations import VariationFunctions
from orbitproof.verify.poincare import HalfOrbits, WideOracle

_VARIATIONS = ("first'", "first_rate'", "second'", "second_rate'")
"""With primes no coordinate of a file is called so (1.6)."""
_START = (1, 0, 0, 1)


def with_variations(system: ReversibleSystem, names: Sequence[str] = _VARIATIONS) -> ReversibleSystem:
    """The system with solutions of w'' = -g w along its orbits: coordinates w, w' of each more, with these names.

    Without its symmetries, of which nothing is said there.
    """
    size, field, program = len(system.state), system.vector_field, system.stiffness_across_program
    if program is None:
        raise ValueError(f"{system.name} is not the motion in a plane")
    powers = {step.value for step in system.program.instructions if step.operation == "pow"}

    def power(base: Any, exponent: Fraction) -> Any:
        """A third power of a root that the field takes as well is found from that."""
        root = exponent / 3
        return base**root * base**root * base**root if root in powers - {exponent} else base**exponent

    def extended(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        own, more = state[:size], state[size:]
        (strength,) = program.evaluate([*own, *parameters], Fraction, power)
        rates: list[Any] = []
        for w, rate in zip(more[::2], more[1::2], strict=True):
            rates += [rate, -(strength * w)]
        return (*field(own, parameters), *rates)

    integral = system.first_integral

    def constant(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        assert integral is not None
        return integral(state[:size], parameters)

    return replace(
        system,
        name=f"{system.name}-out-of-plane",
        state=(*system.state, *names),
        vector_field=extended,
        reversing_symmetry=(*system.reversing_symmetry, *((1, -1) * (len(names) // 2))),
        symmetries={},
        reversors={},
        first_integral=None if integral is None else constant,
        squared_distance=None,
        stiffness_across=None,
    )


def variations_across(
    system: ReversibleSystem,
    flow: WideArithmetic,
    start: Mapping[str, Series],
    share: Fraction,
    crossings: int,
    oracle: WideOracle,
    progress: Callable[[int], None] | None = None,
) -> VariationFunctions | NotKnown:
    """The entries of V as functions of tau, or why they are not known.

    Args:
        flow: the format in which the half orbits are followed.
        start: parameters and coordinates of x(s), by name, functions of sigma.
        share: sigma = share tau.
        crossings: of the section in a half orbit, its end included.
    """
    arithmetic = WideArithmetic(Grading((1,), 0), flow.bits, 0, flow.degree, width=flow.width)
    begun = {
        name: arithmetic.polynomial({(0,): known_part(element, 0)}).widened(error_of(element))
        for name, element in start.items()
    }
    begun |= {name: arithmetic.constant(Fraction(value)) for name, value in zip(_VARIATIONS, _START, strict=True)}
    try:
        returns = HalfOrbits(with_variations(system), arithmetic, begun, oracle)
        state, _ = returns.half_orbit(crossings, progress)
        first, first_rate, second, second_rate = state[len(system.state) :]
        rows = (first, second, first_rate, second_rate)
        return VariationFunctions(*(StoredFunction.of(restricted(_flat(element), share)) for element in rows))
    except IntegrationFailure as failure:
        return NotKnown(failure.reason)


def _flat(element: Series) -> Series:
    """An element that does not depend on time, in an algebra without time."""
    arithmetic = element.arithmetic
    assert isinstance(arithmetic, WideArithmetic)
    return Series(replace(arithmetic, degree=0), element.coefs, element.errors)
