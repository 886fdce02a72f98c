"""Variations out of the plane of motion along the half orbits of a curve (section 21)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.evidence import IntegrationFailure, Reason
from orbitproof.verify.functions import (
    BoundedFunction,
    error_of,
    function_from_json,
    function_to_json,
    known_part,
    restricted,
)
from orbitproof.verify.poincare import Oracle, Returns

_VARIATIONS = ("w_1", "w_1'", "w_2", "w_2'")
_START = (1, 0, 0, 1)
ENTRIES = ("11", "12", "21", "22")
"""Names of the entries of V, by rows."""


def with_variations(system: ReversibleSystem) -> ReversibleSystem:
    """The system with two solutions of w'' = -g w along its orbits: 4 more coordinates w_1, w_1', w_2, w_2'.

    Without its symmetries, of which nothing is said there.
    """
    size, field, stiffness = len(system.state), system.vector_field, system.stiffness_across
    if stiffness is None:
        raise ValueError(f"{system.name} is not the motion in a plane")

    def extended(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        own, (first, first_rate, second, second_rate) = state[:size], state[size:]
        (strength,) = stiffness(own, parameters)
        rates = (first_rate, -(strength * first), second_rate, -(strength * second))
        return (*field(own, parameters), *rates)

    return replace(
        system,
        name=f"{system.name}-out-of-plane",
        state=(*system.state, *_VARIATIONS),
        vector_field=extended,
        reversing_symmetry=(*system.reversing_symmetry, 1, -1, 1, -1),
        symmetries={},
        reversors={},
        stiffness_across=None,
    )


def variations_across(
    system: ReversibleSystem,
    flow: WideArithmetic,
    start: Mapping[str, Series],
    share: Fraction,
    crossings: int,
    oracle: Oracle,
    progress: Callable[[int], None] | None = None,
) -> tuple[Series, ...] | Reason:
    """The entries of V, by rows, as functions of tau, or why they are not known.

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
        returns = Returns(with_variations(system), arithmetic, begun, oracle)
        state, _ = returns.half_orbit(crossings, progress)
        first, first_rate, second, second_rate = state[len(system.state) :]
        return tuple(restricted(_flat(element), share) for element in (first, second, first_rate, second_rate))
    except IntegrationFailure as failure:
        return failure.reason


def _flat(element: Series) -> Series:
    """The same as an element of an algebra without time."""
    arithmetic = element.arithmetic
    assert isinstance(arithmetic, WideArithmetic)
    return Series(replace(arithmetic, degree=0), element.coefs, element.errors)


def variations_to_json(found: tuple[Series, ...] | Reason) -> dict[str, Any]:
    """The JSON object."""
    if isinstance(found, Reason):
        return {"reason": found.to_json()}
    return {name: function_to_json(element) for name, element in zip(ENTRIES, found, strict=True)}


@dataclass(frozen=True)
class KnownVariations:
    """The entries of V on an interval, functions of tau."""

    entries: tuple[BoundedFunction, ...]

    @property
    def parameter(self) -> BoundedFunction:
        """The stability parameter across the plane, V_11 V_22 + V_12 V_21."""
        one, two, three, four = self.entries
        return one * four + two * three

    def mirrored(self) -> KnownVariations:
        """Those of -s."""
        return KnownVariations(tuple(entry.mirrored() for entry in self.entries))


def variations_from_json(entry: Mapping[str, Any] | None) -> KnownVariations | None:
    """What a JSON object that fits the schema says, if there is one."""
    if entry is None or "reason" in entry:
        return None
    return KnownVariations(tuple(function_from_json(entry[name]) for name in ENTRIES))
