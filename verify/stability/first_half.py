"""The stability parameter of orbits from the first half of them alone, n = 1 (section 18.16).

The flow preserves volume, so the determinant of the half map is a quotient of speeds across the section, and the block
A' of its inverse is the block D over that determinant: a derivative off Fix(R). With it variations out of the plane are
followed, in one integration.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import ceil, floor, log2
from typing import TYPE_CHECKING

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.curve import HalfReturn
from orbitproof.verify.functions import StoredFunction, determinant, error_of, inverse, known_part, restricted, slope
from orbitproof.verify.out_of_plane import VariationFunctions
from orbitproof.verify.poincare import PHYSICAL, HalfOrbits, at_start, first_integral
from orbitproof.verify.stability.along import CurveInTube, at_origin
from orbitproof.verify.stability.stored_stability import SHARE, OrbitFunctions
from orbitproof.verify.stability.units import units_of

if TYPE_CHECKING:
    from orbitproof.verify.stability.matrix import TubeOfOrbits

_ACROSS = ("w", "w'")
"""Variations out of the plane."""
_NARROW = 48
"""Points off the curve are followed at a distance of 2^-48 from it: only derivatives are of use."""
_BELOW_ERROR, _LEAST_BITS, _LEAST_ORDER = 24, 60, 24
"""Bits with which points are followed: so many beyond the error they are known with, and so many at least."""


def is_enough(tube: TubeOfOrbits) -> bool:
    """Whether the first half of the orbits is followed alone: motion in a plane, n = 1, a flow that preserves volume.

    Distances are those along the second half, and the coordinates that are integrated here the system's own.
    """
    system = tube.system
    plain = not (system.defined or system.arrival or system.fixed_level or system.squared_distance)
    in_plane = system.stiffness_across is not None and len(tube.piece.tube) == 1
    return in_plane and plain and tube.coordinates == PHYSICAL and preserves_volume(system)


def preserves_volume(system: ReversibleSystem) -> bool:
    """Whether no component of the vector field depends on the coordinate whose derivative it is, by its program."""
    program = system.program
    rows = (replace(program, outputs=(output,)) for output in program.outputs)
    return all(name not in row.used_inputs for name, row in zip(system.state, rows, strict=True))


def from_first_half(
    tube: TubeOfOrbits, half: HalfReturn, progress: Callable[[float], None] | None = None
) -> OrbitFunctions:
    """All functions, from the return of a tube for which `is_enough` holds. Raises `IntegrationFailure`."""
    system, curve, (width,) = tube.system, tube.curve(half), half.widths
    level = first_integral(system, half.state[0].arithmetic, half.start)
    level = half.start[str(system.family_parameter)] if level is None else level
    there = tube.named(half.start, half.state, 1)
    along = [slope(curve.value(element), SHARE) for element in there]
    image = [restricted(curve.across(element, 0).scaled(1 / width), SHARE) for element in there]
    factor = determinant([along, image])
    derivatives = _derivatives(tube, half, curve, progress)
    return OrbitFunctions(
        (_parameter(tube, half, curve, factor, derivatives[system.kernel_coordinates[0]][0]),),
        restricted(curve.value(level), SHARE),
        restricted(curve.value(half.time), SHARE),
        factor,
        None,
        _across(derivatives[len(system.state) :]),
    )


def _derivatives(
    tube: TubeOfOrbits, half: HalfReturn, curve: CurveInTube, progress: Callable[[float], None] | None
) -> list[list[Series]]:
    """Derivatives at P(x) of state coordinates by q, and of w and w' by those at x: functions of sigma (Lemma 18.9)."""
    from orbitproof.verify.out_of_plane import with_variations

    flow, system = half.state[0].arithmetic, with_variations(tube.system, _ACROSS)
    names = [*(system.state[index] for index in tube.system.kernel_coordinates), *_ACROSS]
    count, known = len(names), {name: curve.value(element) for name, element in half.start.items()}
    bits, order = _needed(max(map(error_of, known.values())), flow.bits, flow.degree)
    arithmetic = WideArithmetic(Grading((1,) * count, 1), bits, _NARROW, order, width=flow.width)
    start = {name: _on_curve(arithmetic, element) for name, element in known.items()}
    for j, name in enumerate(names):
        start[name] = arithmetic.polynomial({tuple(int(i == j) for i in range(count)): Fraction(1, 2**_NARROW)})
    returns = HalfOrbits(system, arithmetic, start, tube.oracle, PHYSICAL)
    state, _ = returns.half_orbit(tube.crossings, _after(half.steps, progress))
    scale = Fraction(2**_NARROW)
    return [[at_origin(element, j, tube.arithmetic).scaled(scale) for j in range(count)] for element in state]


def _needed(error: Fraction, bits: int, order: int) -> tuple[int, int]:
    """Bits and order of the integration of points that are known with this error, at most those of their own."""
    enough = max(_LEAST_BITS, _BELOW_ERROR - floor(log2(error))) if error else bits
    return (enough, max(_LEAST_ORDER, ceil(order * enough / bits))) if enough < bits else (bits, order)


def _after(steps: int, progress: Callable[[float], None] | None) -> Callable[[int], None] | None:
    return None if progress is None else lambda number: progress(steps + number)


def _on_curve(arithmetic: WideArithmetic, element: Series) -> Series:
    """A function of sigma as one of sigma and omega."""
    return arithmetic.polynomial({arithmetic.grading.monomials[0]: known_part(element, 0)}).widened(error_of(element))


def _parameter(tube: TubeOfOrbits, half: HalfReturn, curve: CurveInTube, factor: Series, block: Series) -> Series:
    """Sigma, from det (v', A b_1) and D (18.10)."""
    system = tube.system
    program = replace(system.program, outputs=(system.program.outputs[system.section_index],))
    here = tube.initial(system, curve, half.start)
    state = [curve.value(element) for element in half.state]
    (speed,), (speed_there,) = at_start(program, here), at_start(program, [*state, *here[len(state) :]])
    share = block * speed_there
    if system.normalised:
        share = share * state[system.state.index(units_of(system)[1])]
    (a, b), (c, d) = tube.piece.frame
    scale = 2 / (tube.piece.half_width * tube.radius * (a * d - b * c))
    found = factor * restricted(share, SHARE) * inverse(restricted(speed, SHARE))
    return found.scaled(scale) - found.arithmetic.constant(Fraction(1))


def _across(derivatives: list[list[Series]]) -> VariationFunctions:
    """V, from the derivatives of w and w'."""
    return VariationFunctions(*(StoredFunction.of(restricted(row[j], SHARE)) for row in derivatives for j in (1, 2)))
