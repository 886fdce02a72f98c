"""The normal form of a fixed point of a reversible map of the plane, and its twist (sections 28.2 and 28.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import acb, arb

from orbitproof.verify.evidence import is_positive, meet, sign
from orbitproof.verify.newton import Jet


class NotEllipticError(ArithmeticError):
    """The multipliers of a map are not shown to be two numbers on the unit circle that are not real."""


@dataclass(frozen=True)
class Rotation:
    """The derivative of the map at the fixed point, in coordinates in which it is a rotation by omega in (0, pi).

    Attributes:
        cosine: s = cos omega, the stability parameter.
        sine: sin omega, positive.
        scale: kappa > 0; p = kappa u and q = v/kappa, u + i v or u - i v being turned.
        orientation: 1 if u + i v is turned by omega, -1 if u - i v is.
    """

    cosine: arb
    sine: arb
    scale: arb
    orientation: int

    @property
    def multiplier(self) -> acb:
        """lambda = cos omega + i sin omega."""
        return acb(self.cosine, self.sine)

    @property
    def direction(self) -> tuple[acb, acb]:
        """The derivatives of (p, q) by w, at fixed conj(w)."""
        return acb(self.scale / 2), acb(0, -self.orientation) / (2 * self.scale)

    @property
    def component(self) -> tuple[acb, acb]:
        """The derivatives of w by (p, q)."""
        return acb(1 / self.scale), acb(0, self.orientation) * self.scale


@dataclass(frozen=True)
class Twist:
    """w -> lambda w (1 + (defect + i twist) |w|^2) + O(|w|^4) in the coordinate w of 28.2, with dp dq = du dv.

    Attributes:
        twist: tau; the map turns by about omega + tau |w|^2.
        defect: Re(conj(lambda) c_1), which is 0 for a reversible map.
    """

    twist: arb
    defect: arb


def stability_parameter(functions: Sequence[Jet]) -> arb:
    """s = cos omega, half the trace of the derivative: both diagonal entries of a reversible map are s (28.2)."""
    return meet(functions[0][1, 0], functions[1][0, 1])


def rotation_of(functions: Sequence[Jet]) -> Rotation:
    """The rotation to which the derivative of a map is conjugate.

    Args:
        functions: jets of both components at the fixed point, in (p, q); the map is reversible under q -> -q.

    Raises `NotEllipticError` unless -1 < s < 1 and the entries off the diagonal have signs for certain.
    """
    cosine = stability_parameter(functions)
    left, orientation = 1 - cosine * cosine, sign(functions[1][1, 0])
    if not is_positive(left) or not orientation or sign(functions[0][0, 1]) != -orientation:
        raise NotEllipticError("the multipliers are not shown to lie on the unit circle")
    sine = left.sqrt()
    return Rotation(cosine, sine, (abs(functions[0][0, 1]) / sine).sqrt(), orientation)


def twist_of(functions: Sequence[Jet], rotation: Rotation) -> Twist:
    """tau = Im(conj(lambda) c_1), c_1 the coefficient of w^2 conj(w) that no change of coordinates takes away.

    Args:
        functions: jets of order 3 of both components at the fixed point, in (p, q).

    The result is not finite unless lambda^3 is shown not to be 1 (28.3).
    """
    value, to_w = rotation.multiplier, rotation.component
    out = rotation.direction
    bar = (out[0].conjugate(), out[1].conjugate())

    def coefficient(*vectors: tuple[acb, acb]) -> acb:
        """g_jk: the derivative of w o F along these vectors."""
        total = acb(0)
        for part, jet in zip(to_w, functions, strict=True):
            total += part * _along(jet, vectors)
        return total

    g20, g11, g02 = coefficient(out, out), coefficient(out, bar), coefficient(bar, bar)
    back, square = value.conjugate(), value * value
    first = (
        g20 * g11 * (1 - 2 * value) / (2 * (square - value))
        + g11 * g11.conjugate() / (1 - back)
        + g02 * g02.conjugate() / (2 * (square - back))
        + coefficient(out, out, bar) / 2
    )
    found = back * first
    return Twist(found.imag, found.real)


def _along(jet: Jet, vectors: Sequence[tuple[acb, acb]]) -> acb:
    """The derivative of a function of two variables along several vectors."""
    order = len(vectors)
    sums = [acb(1)]
    for x, y in vectors:
        # By how many of the vectors so far their second component is taken.
        sums = [
            (sums[i] * x if i < len(sums) else acb(0)) + (sums[i - 1] * y if i else acb(0))
            for i in range(len(sums) + 1)
        ]
    total = acb(0)
    for number, factor in enumerate(sums):
        total += factor * jet.derivative(order - number, number)
    return total
