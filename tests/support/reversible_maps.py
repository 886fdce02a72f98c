"""Reversible maps of four variables (p_1, p_2, q_1, q_2) with known torsion, as jets: nothing of the code under test
but sums and products of jets makes them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from random import Random

from flint import acb, arb

from orbitproof.verify.evidence import indices_of_degree
from orbitproof.verify.newton import Jet, compose, derivatives_of
from orbitproof.verify.newton.jets import unit
from orbitproof.verify.orbit import inverse_jets

Matrix = Sequence[Sequence[arb]]


@dataclass(frozen=True)
class KnownMap:
    """A map, the cosines of its multipliers, and the torsion in the coordinates of section 30.2.

    Attributes:
        jets: order 3.
        cosines: increasing.
        torsion: rows.
    """

    jets: tuple[Jet, ...]
    cosines: tuple[arb, arb]
    torsion: list[list[arb]]


def _variable(j: int) -> Jet:
    return Jet(4, 3, {unit(4, j): arb(1)})


def turning(angles: Sequence[arb], torsion: Matrix) -> tuple[Jet, ...]:
    """z_j -> z_j exp(i (angle_j + sum torsion_jl |z_l|^2)) with z = p + i q, up to order 3."""
    squares = [_variable(j) * _variable(j) + _variable(j + 2) * _variable(j + 2) for j in range(2)]
    real, imaginary = [], []
    for j, (angle, row) in enumerate(zip(angles, torsion, strict=True)):
        turn = squares[0].scaled(row[0]) + squares[1].scaled(row[1])
        p, q = _variable(j), _variable(j + 2)
        # z (1 + i turn), then times exp(i angle).
        x, y = p + (q * turn).scaled(arb(-1)), q + p * turn
        real.append(x.scaled(angle.cos()) + y.scaled(-angle.sin()))
        imaginary.append(x.scaled(angle.sin()) + y.scaled(angle.cos()))
    return (*real, *imaginary)


def after(outer: Sequence[Jet], inner: Sequence[Jet]) -> tuple[Jet, ...]:
    """A map after another."""
    return tuple(compose(derivatives_of(jet), inner) for jet in outer)


@cache
def random_map(seed: int) -> KnownMap:
    """A turning map in coordinates changed at random by a linear and a polynomial map that commute with R."""
    random = Random(seed)

    def number(size: float = 1.0) -> arb:
        return arb(random.uniform(-size, size))

    angles = [arb(random.uniform(0.3, 2.8)) for _ in range(2)]
    twist = [[number(3), number(3)] for _ in range(2)]
    changes = []
    for i in range(4):
        odd = i >= 2
        even_part = {
            index: number()
            for degree in (2, 3)
            for index in indices_of_degree(4, degree)
            if (index[2] + index[3]) % 2 == int(odd)
        }
        changes.append(Jet(4, 3, {unit(4, i): arb(1), **even_part}))
    # p and q of the turning map are these rows times those of the map.
    rows = [[arb(1) + number(0.4), number(0.7)], [number(0.7), arb(1) + number(0.4)]]
    columns = [[arb(1) + number(0.4), number(0.7)], [number(0.7), arb(1) + number(0.4)]]
    linear = [
        Jet(4, 3, {unit(4, first + k): row[k] for k in range(2)})
        for first, block in ((0, rows), (2, columns))
        for row in block
    ]
    change = after(changes, linear)
    jets = after(inverse_jets(change), after(turning(angles, twist), change))
    signs = [1 if float(angle.sin()) > 0 else -1 for angle in angles]
    sizes = [row[0] * row[0] + row[1] * row[1] for row in rows]
    order = sorted(range(2), key=lambda j: float(angles[j].cos()))
    known = [[twist[j][k] * signs[j] * sizes[k] for k in order] for j in order]
    first, second = (angles[j].cos() for j in order)
    return KnownMap(jets, (first, second), known)


def widened(jets: Sequence[Jet], radius: str) -> tuple[Jet, ...]:
    """Balls about the coefficients."""
    return tuple(
        Jet(jet.variables, jet.order, {i: value + arb(0, radius) for i, value in jet.coefficients.items()})
        for jet in jets
    )


def on_circle(angle: arb) -> acb:
    """exp(i angle)."""
    return acb(angle.cos(), angle.sin())
