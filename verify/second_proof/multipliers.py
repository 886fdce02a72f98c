"""Multipliers in balls of their own, from an enclosure of the monodromy matrix. README, section 9.5."""

from __future__ import annotations

from collections.abc import Sequence

from flint import acb, acb_poly, arb, arb_mat, arb_poly

from .conditions import Vector
from .jets import CannotFollow
from .proof import NEWTON_STEPS


def multipliers(matrix: arb_mat, trivial: int, known: Sequence[int] = ()) -> list[acb]:
    """The eigenvalues but for some 1 and others that are known, in disjoint balls. README, section 9.5."""
    polynomial: arb_poly = matrix.charpoly()
    coefficients: Vector = [polynomial[i] for i in range(polynomial.degree() + 1)]
    for root in [*[1] * trivial, *known]:
        quotient = [arb(0)]
        for c in reversed(coefficients[1:]):
            quotient.insert(0, c + root * quotient[0])
        coefficients = quotient[:-1]
    if len(coefficients) == 1:
        return []
    rounded = acb_poly([c.mid() for c in coefficients])
    balls = [_only_root(coefficients, _nearer(rounded, guess)) for guess in rounded.roots()]
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
