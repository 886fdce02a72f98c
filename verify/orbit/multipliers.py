"""Stability parameters and multipliers of a symmetric orbit, from its two halves (section 19.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

from flint import acb, arb, arb_mat

from orbitproof.shared.stored import rules, stored
from orbitproof.verify.evidence import all_finite, is_below, is_positive, sign

STABLE, UNSTABLE, UNDECIDED = "linearly stable", "unstable", "not decided"
Balls = Annotated[tuple[acb, ...], rules("complex_balls", maxItems=32)]


@dataclass(frozen=True)
class Stability:
    """What the stability matrix says of an orbit.

    Attributes:
        parameters: its eigenvalues, the stability parameters.
        multipliers: one of each pair lambda, 1/lambda with (lambda + 1/lambda)/2 such an eigenvalue, not inside the
            unit circle where that is known; empty if it is not known which parameters are real.
        verdict: `STABLE`, `UNSTABLE` or `UNDECIDED`.
    """

    parameters: Balls = stored("stability_parameters")
    multipliers: Balls = stored()
    verdict: Annotated[str, rules(enum=(STABLE, UNSTABLE, UNDECIDED))] = stored("stability")


def stability_of(out: Sequence[Sequence[arb]], back: Sequence[Sequence[arb]]) -> Stability:
    """From the derivatives along Fix(R) of the coordinates on Fix(R) of P, at both points of the orbit on Fix(R).

    Closed formulas for one or two stability parameters; for more, and where nothing is finite, there are none.
    """
    size = len(out)
    sigma = 2 * arb_mat([list(row) for row in back]) * arb_mat([list(row) for row in out])
    for i in range(size):
        sigma[i, i] = sigma[i, i] - 1
    coefficients: list[arb] = []
    last = arb(1)
    for order in range(1, size):
        # det(c - Sigma) has the factor c - 1, that of the direction of the curve.
        last = _minors(sigma, order) - last
        coefficients.append(last)
    return stability_from(coefficients)


def stability_from(coefficients: Sequence[arb]) -> Stability:
    """From the elementary symmetric functions of the stability parameters: their sum, for two their product too."""
    if not all_finite(coefficients) or len(coefficients) > 2:
        return Stability((), (), UNDECIDED)
    parameters = [acb(coefficients[0])] if len(coefficients) == 1 else _roots(*coefficients)
    decided = all(value.imag.is_zero() or sign(value.imag) for value in parameters)
    multipliers = tuple(map(_multiplier, parameters)) if decided else ()
    return Stability(tuple(parameters), multipliers, _verdict(coefficients, parameters))


def _minors(matrix: arb_mat, order: int) -> arb:
    """The sum of the principal minors of an order."""
    total = arb(0)
    for places in combinations(range(matrix.nrows()), order):
        total = total + arb_mat([[matrix[i, j] for j in places] for i in places]).det()
    return total


def _roots(trace: arb, determinant: arb) -> list[acb]:
    """The zeros of c^2 - trace c + determinant, the smaller real one first.

    Both enclosures contain both where these are not known to be real or to be conjugate.
    """
    middle = trace / 2
    discriminant = middle * middle - determinant
    known = sign(discriminant)
    if known > 0:
        root = discriminant.sqrt()
        low, high = middle - root, middle + root
        # Without cancellation, where it is known in which of the two it would be.
        match sign(middle):
            case 1:
                low = determinant / high
            case -1:
                high = determinant / low
        return [acb(low), acb(high)]
    if known < 0:
        root = (-discriminant).sqrt()
        return [acb(middle, root), acb(middle, -root)]
    root = arb(0, abs(discriminant).upper().sqrt().upper())
    return [acb(middle + root, root), acb(middle + root, root)]


def _multiplier(parameter: acb) -> acb:
    """A multiplier lambda with (lambda + 1/lambda)/2 the parameter."""
    if parameter.imag.is_zero():
        s = parameter.real
        beyond = s * s - 1
        if is_positive(beyond):
            root = beyond.sqrt()
            return acb(s + (root if is_positive(s) else -root))
        if is_positive(-beyond):
            return acb(s, (-beyond).sqrt())
        # |lambda - s|^2 is at most |s^2 - 1|, whatever the sign.
        spread = arb(0, abs(beyond).upper().sqrt().upper())
        return acb(s + spread, spread)
    return parameter + (parameter - 1).sqrt() * (parameter + 1).sqrt()


def _verdict(coefficients: Sequence[arb], parameters: Sequence[acb]) -> str:
    if len(coefficients) == 1:
        inside = [1 - coefficients[0], 1 + coefficients[0]]
    else:
        trace, determinant = coefficients
        discriminant = trace * trace - 4 * determinant
        inside = [1 - trace + determinant, 1 + trace + determinant, 2 - trace, 2 + trace, discriminant]
    if all(is_positive(value) for value in inside):
        return STABLE
    real = all(value.imag.is_zero() for value in parameters)
    beyond = real and any(is_below(arb(1), abs(value.real)) for value in parameters)
    return UNSTABLE if beyond or any(is_positive(-value) for value in inside) else UNDECIDED
