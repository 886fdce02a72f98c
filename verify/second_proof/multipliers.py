"""Multipliers in balls of their own, from an enclosure of the monodromy matrix. README, section 9.5."""

from __future__ import annotations

from collections.abc import Sequence

from flint import acb, acb_poly, arb, arb_mat, arb_poly

from .conditions import Vector
from .jets import CannotFollow
from .proof import NEWTON_STEPS


def linear(root: int) -> arb_poly:
    """t - root."""
    return arb_poly([-root, 1])


def multipliers(matrix: arb_mat, known: Sequence[arb_poly]) -> list[acb]:
    """The zeros of the characteristic polynomial but for those of its known factors, in disjoint balls.

    README, section 9.5.
    """
    polynomial: arb_poly = matrix.charpoly()
    for factor in known:
        polynomial = polynomial // factor
    coefficients: Vector = [polynomial[i] for i in range(polynomial.degree() + 1)]
    if len(coefficients) == 1:
        return []
    rounded = acb_poly([c.mid() for c in coefficients])
    balls = [_only_root(coefficients, _nearer(rounded, guess)) for guess in rounded.roots()]
    return apart(balls)


def apart(balls: list[acb]) -> list[acb]:
    """The balls, if no two have a point in common. Raises `CannotFollow`."""
    for i, one in enumerate(balls):
        if any(one.overlaps(other) for other in balls[:i]):
            raise CannotFollow("two multipliers are not told apart")
    return balls


def _nearer(polynomial: acb_poly, guess: acb) -> acb:
    """A guess of a root improved by Newton's method; real if it may be."""
    root, slope = acb(guess.real.mid(), 0 if guess.imag.contains(0) else guess.imag.mid()), polynomial.derivative()
    for _ in range(NEWTON_STEPS):
        root = (root - polynomial(root) / slope(root)).mid()
    return root


def _only_root(coefficients: Vector, centre: acb) -> acb:
    """A ball around a disc with exactly one root of every polynomial. README, Lemma 7."""
    shifted = acb_poly(coefficients)(acb_poly([centre, 1]))
    sizes = [abs(shifted[k]) for k in range(len(coefficients))]
    if sizes[1] > 0:
        radius = arb((2 * sizes[0] / sizes[1]).abs_upper() + arb(2) ** -1000)
        terms = [size * radius**k for k, size in enumerate(sizes)]
        if sum(terms[2:], terms[0]) < terms[1]:
            # About a real centre the root is real.
            return acb(centre.real + arb(0, radius), arb(0) if centre.imag == 0 else centre.imag + arb(0, radius))
    raise CannotFollow("a multiplier is not isolated")
