"""What is known of a vector field on the box of a claim (sections 36.2 and 36.6)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from flint import acb, arb

from orbitproof.shared.claims import Equilibrium, HopfPoint
from orbitproof.shared.stored import rules, stored
from orbitproof.verify.equilibrium.expansions import Expansion, expand
from orbitproof.verify.evidence import enclose, guarded, symmetric
from orbitproof.verify.periodic import Linearised
from orbitproof.verify.poincare import IntegratorSettings

Progress = Callable[[float], None]
_DEGREE = 3
"""The highest derivative."""


@dataclass(frozen=True)
class EquilibriumEnclosures:
    """What one proof is evaluated from.

    Attributes:
        field: the N components of f, as functions of x on the box.
        order: the highest derivative of f that was enclosed.
        precision: bits.
        steps: none: nothing is integrated.
        coordinates: those of the system.
    """

    field: Annotated[tuple[Linearised, ...], rules(minItems=1, maxItems=32)]
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default="physical")


Row = Annotated[tuple[arb, ...], rules("balls_of_a_row", minItems=1, maxItems=1000)]


@dataclass(frozen=True)
class HopfEnclosures:
    """What one proof is evaluated from.

    Attributes:
        field: the N components of f, as functions of (x, a) on the box.
        linear: shape (N, N): the derivative of f in x at the centre of the box.
        second: for each component its second derivatives at all points of the box, in the order of `pairs`.
        third: C(q, q, conj q) at all points of the box, N numbers.
        order, precision, steps, coordinates: as in `EquilibriumEnclosures`.
    """

    field: Annotated[tuple[Linearised, ...], rules(minItems=1, maxItems=32)]
    linear: Annotated[tuple[Row, ...], rules(minItems=1, maxItems=32)]
    second: Annotated[tuple[Row, ...], rules(minItems=1, maxItems=32)]
    third: Annotated[tuple[acb, ...], rules("complex_balls_of_a_row", minItems=1, maxItems=32)]
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default="physical")


def pairs(size: int) -> list[tuple[int, int]]:
    """Places of the second derivatives in (x, a) that are enclosed: all but that in a alone, each pair once."""
    return [(j, k) for j in range(size) for k in range(j, size + 1)]


def enclose_equilibrium(
    claim: Equilibrium, settings: IntegratorSettings, progress: Progress | None = None
) -> EquilibriumEnclosures:
    """Enclose the field at the centre of the box, and its derivatives on the box."""
    with guarded(settings.precision):
        parameters = list(map(enclose, claim.values))
        centre = [enclose(value) for value in claim.centre]
        box = [value + symmetric(radius) for value, radius in zip(centre, claim.radii, strict=True)]
        size = len(centre)
        at_centre = expand(claim.system, centre, parameters, [], 0)
        on_box = expand(claim.system, box, parameters, _units(range(size), size), 1)
        field = tuple(
            Linearised(value.value, tuple(f.slope(j) for j in range(size)))
            for value, f in zip(at_centre, on_box, strict=True)
        )
    return EquilibriumEnclosures(field, _DEGREE, settings.precision)


def enclose_hopf(claim: HopfPoint, settings: IntegratorSettings, progress: Progress | None = None) -> HopfEnclosures:
    """Enclose the field and its first derivatives at the centre of the box, and its derivatives on the box."""
    with guarded(settings.precision):
        system, size = claim.system, len(claim.centre)
        parameters = list(map(enclose, claim.values))
        centre = [enclose(value) for value in claim.centre]
        box = [value + symmetric(radius) for value, radius in zip(centre, claim.radii, strict=True)]
        varying = list(claim.system.parameters).index(claim.parameter)
        all_values = list(parameters)
        all_values[varying] += symmetric(claim.parameter_radius)
        units = _units([*range(size), size + varying], size + len(parameters))
        at_centre = expand(system, centre, parameters, units[:size], 1)
        on_box = expand(system, box, all_values, units, 2)
        q = kernel_on_box(claim)
        along = expand(system, box, all_values, [q, [value.conjugate() for value in q]], 3)
        field = tuple(
            Linearised(value.value, tuple(f.slope(j) for j in range(size + 1)))
            for value, f in zip(at_centre, on_box, strict=True)
        )
        linear = tuple(tuple(f.slope(j) for j in range(size)) for f in at_centre)
        second = tuple(tuple(f.second(j, k) for j, k in pairs(size)) for f in on_box)
        third = tuple(map(_third, along))
    return HopfEnclosures(field, linear, second, third, _DEGREE, settings.precision)


def kernel_on_box(claim: HopfPoint) -> list[acb]:
    """The vectors q of the box."""
    side = symmetric(claim.kernel_radius)
    return [acb(enclose(u) + side, enclose(v) + side) for u, v in zip(*claim.kernel, strict=True)]


def _third(along: Expansion) -> acb:
    """C(q, q, conj q): twice the coefficient of z^2 w of f(x + z q + w conj q) (36.2)."""
    return acb(2 * along[2, 1])


def _units(places: Sequence[int], size: int) -> list[list[Any]]:
    return [[arb(int(i == place)) for i in range(size)] for place in places]
