"""What is stored of the twist of orbits on an interval of a piece (section 29.4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from flint import ctx

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Series
from orbitproof.verify.curve import HalfReturn, about_pieces, broken_off
from orbitproof.verify.evidence import IntegrationFailure, NotKnown, Reason, guarded, is_positive
from orbitproof.verify.functions import REACH, StoredFunction, error_of, known_part
from orbitproof.verify.lasting.half_map import return_map
from orbitproof.verify.lasting.jets import exchanged
from orbitproof.verify.lasting.odd import odd_coordinate
from orbitproof.verify.lasting.twist_function import normal_form
from orbitproof.verify.poincare import PHYSICAL
from orbitproof.verify.stability import (
    PRECISION,
    SPARE_BITS,
    StabilityFunctions,
    StabilityResult,
    TubeOfOrbits,
    between,
)


def is_known_of(system: ReversibleSystem) -> bool:
    """Whether the theorem speaks of curves of a system: n = 1, states of their own, no level that is held."""
    one = len(system.kernel_coordinates) == 1
    return one and not system.normalised and system.fixed_level is None


@dataclass(frozen=True)
class TwistFunctions:
    """Functions of tau on an interval of a piece, up to positive factors (section 29.4).

    Attributes:
        twist: Theta, with the sign of the twist times 1 + 2 c, c the stability parameter.
        exchanged: Theta', the same with p and q exchanged.
        fourth: Delta, which decides at resonances 1:4.
        defect: D, which is 0 by reversibility; its enclosure contains 0.
        odd: whether a symmetry fixes the orbits (29.7): then `twist` and `exchanged` are Theta_0 and Theta_0', without
            the factor 1 + 2 c.
    """

    twist: StoredFunction
    exchanged: StoredFunction
    fourth: StoredFunction
    defect: StoredFunction
    odd: bool = False


@dataclass(frozen=True)
class CurveIntervalResult(StabilityResult):
    """What was found for a piece of a curve.

    Attributes:
        twist: functions, or why there are none; `None` if they were not asked for.
    """

    twist: TwistFunctions | NotKnown | None = None


_PARTS = 32
_NO_TWIST = Reason("lasting", "none of its orbits is linearly stable, so no twist is asked for", "nothing is missing")


def parts_from(first: Fraction) -> list[tuple[Fraction, Fraction]]:
    """Equal parts of the values of tau from one of them to the end of the interval."""
    step = (1 / REACH - first) / _PARTS
    return [(first + number * step, first + (number + 1) * step) for number in range(_PARTS)]


def may_be_stable(known: StabilityFunctions) -> bool:
    """Whether it is not shown that |c_1| > 1 on all of an interval (section 29.5)."""
    with ctx.workprec(PRECISION):
        s = known.characteristic[0].enclosed
        values = [s.value(between(low, high)) for low, high in parts_from(-1 / REACH)]
        return not all(is_positive(value * value - 1) for value in values)


def twist_of_piece(
    tube: TubeOfOrbits,
    progress: Callable[[float], None] | None = None,
    half: HalfReturn | None = None,
    stability: StabilityFunctions | NotKnown | None = None,
) -> TwistFunctions | NotKnown:
    """The functions of section 29.3 as they are stored, or why there are none.

    Args:
        progress: called after every step with the number of steps; what it raises passes through.
        half: the return of the tube, if it is known already, with its limits.
        stability: of its orbits, if it is known already: none is followed for a twist that no orbit has.
    """
    if isinstance(stability, StabilityFunctions) and is_known_of(tube.system) and not may_be_stable(stability):
        return NotKnown(_NO_TWIST)
    followed = replace(tube, coordinates=PHYSICAL)
    try:
        if not is_known_of(tube.system):
            raise IntegrationFailure(
                "lasting", f"the twist is not known of orbits of {tube.system.name}", "leave it out"
            )
        with guarded(tube.limits.precision + SPARE_BITS), np.errstate(all="ignore"):
            return _twist(followed, tube.wider(progress) if half is None else half, progress)
    except IntegrationFailure as error:
        return NotKnown(about_pieces(error.reason))
    except (ArithmeticError, ValueError) as error:
        return NotKnown(broken_off("stability", error))


def _twist(tube: TubeOfOrbits, half: HalfReturn, progress: Callable[[float], None] | None) -> TwistFunctions:
    try:
        curve = tube.curve(half)
    except IntegrationFailure:
        half = tube.wider(progress)
        curve = tube.curve(half)
    coordinate = odd_coordinate(tube.system, tube.piece)
    first, second = return_map(tube, half, curve, progress, coordinate)
    odd = coordinate is not None
    one = tube.arithmetic.constant(Fraction(1))
    s = first.coefficients[1, 0]
    found = normal_form(first, second, s, one, odd)
    other = normal_form(exchanged(second), exchanged(first), s, one, odd)
    for form in (found, other):
        require_zero(form.defect)
    twist, other_form, fourth, defect = map(StoredFunction.of, (found.twist, other.twist, found.fourth, found.defect))
    return TwistFunctions(twist, other_form, fourth, defect, odd)


def require_zero(element: Series) -> None:
    """Raise `ArithmeticError` unless the enclosure of a function that is zero contains zero (section 29.3)."""
    known = sum(map(abs, known_part(element, 0)), Fraction(0))
    if not known <= error_of(element):
        raise ArithmeticError("what reversibility makes zero is not: an enclosure is wrong")
