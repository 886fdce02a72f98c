"""A point of Fix(R) that two functions single out: Newton's method, up to the box for the verifier.

The unknowns are the coordinates u of a point of Fix(R); the equations are pi_q P(u) = 0 and one more, which says that
R is lost or that multipliers collide.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import ceil, isfinite, log2
from typing import Any

import mpmath

from orbitproof.explore.engines import Progress
from orbitproof.explore.numerics import (
    GrowingDigits,
    Linearised,
    Solution,
    bits_of,
    fraction,
    mpf,
    newton_with_digits,
    working_context,
)
from orbitproof.explore.refinement.crossing import level_jet, shorter_coordinates
from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.half_return import HalfReturn, start_jets
from orbitproof.explore.refinement.jets import JetBasis
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import Regularisation, ReversibleSystem

_RULE = GrowingDigits(RefinementFailure, farthest=3e-2)
_BOX_DIGITS, _NARROWER = 24, 6
"""The half-widths of the box: small enough for third derivatives, and so many digits wider than the centre's error."""
FRAME_BITS = 40


@dataclass(frozen=True)
class Defect:
    """What is looked at near the point.

    Attributes:
        value: of the further function.
        slope: its derivatives in u.
        half: P and DP there.
        kernel_frame: for a claim at this point.
    """

    value: Any
    slope: Sequence[Any]
    half: HalfReturn
    kernel_frame: tuple[tuple[Fraction, ...], ...]

    @property
    def spread(self) -> float:
        """The largest entry of DP."""
        return max(float(abs(value)) for value in self.half.derivative)


@dataclass(frozen=True)
class Setting:
    """The orbits on which a function is evaluated.

    Attributes:
        system, parameters: of the orbits.
        crossings: m.
        regularisation: in which they are followed.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    crossings: int
    regularisation: Regularisation | None


Evaluate = Callable[[Setting, Sequence[Fraction], mpmath.MPContext], Defect]


def refine_defect(
    kind: str,
    evaluate: Evaluate,
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    guess: Sequence[float],
    *,
    digits: int,
    crossings: int = 1,
    id: str,
    provenance: Mapping[str, Any],
    progress: Progress | None = None,
) -> Candidate:
    """The claim of a kind near a point, with the box in which it is to be proved.

    Raises `RefinementFailure`, one line, if Newton's method does not come to a point.
    """
    names = system.centre_coordinates
    if len(guess) != len(names) or not all(map(isfinite, guess)):
        raise RefinementFailure(f"the guess needs finite numbers for {', '.join(names)}")
    if system.family_parameter is None and system.level_coordinate not in names:
        raise RefinementFailure(f"{system.name} names no level coordinate: the level cannot be the parameter")
    try:
        setting = Setting(system, parameters, crossings, shorter_coordinates(system, parameters, guess, crossings))
        found = newton_with_digits(
            partial(_linearised, setting, evaluate),
            [Fraction(value) for value in guess],
            bits_of(digits),
            _RULE,
            progress,
        )
        return _candidate(kind, setting, found, digits, id, provenance)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise RefinementFailure(str(failure)) from None


def _linearised(
    setting: Setting, evaluate: Evaluate, point: Sequence[Fraction], context: mpmath.MPContext
) -> Linearised:
    """pi_q P and the further function; its second derivatives of P lose the bits of the spread once more."""
    found = evaluate(setting, point, context)
    n = len(point) - 1
    rows = [[found.half.derivative[n + 1 + i, j] for j in range(n + 1)] for i in range(n)]
    residual = context.matrix([*found.half.kernel_values, found.value])
    return Linearised(residual, context.matrix([*rows, list(found.slope)]), found.spread**2, found)


def _candidate(
    kind: str,
    setting: Setting,
    found: Solution,
    digits: int,
    id: str,
    provenance: Mapping[str, Any],
) -> Candidate:
    system, point, bits, defect = setting.system, found.unknowns, found.bits, found.last.found
    size = len(point)
    exponent = ceil(min(_BOX_DIGITS, digits - _NARROWER) * log2(10) + log2(max(1.0, defect.spread)))
    names, centre, sign = system.centre_coordinates, list(point), None
    if system.family_parameter is None:
        context, basis = working_context(bits), JetBasis.graded((1,), 0)
        values = [mpf(value, context) for value in point]
        start, _ = start_jets(system, values, [], basis)
        level = level_jet(system, setting.parameters, start, None, context).coefficients[0]
        position = names.index(str(system.level_coordinate))
        sign = 1 if point[position] > 0 else -1
        centre = [fraction(level), *point[:position], *point[position + 1 :]]
    return Candidate(
        id=id,
        system=system,
        parameters=dict(setting.parameters),
        kind=kind,  # type: ignore[arg-type]
        k=1,
        centre=tuple(round_dyadic(value, bits) for value in centre),
        frame=tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size)),
        kernel_frame=defect.kernel_frame,
        radii=(Fraction(1, 2**exponent),) * size,
        level_sign=sign,
        crossings=setting.crossings,
        provenance={"digits": digits, **provenance},
    )
