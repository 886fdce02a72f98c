"""Elliptic orbits with two pairs of multipliers at which tori accumulate, once more. README, section 16."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from flint import acb, arb

from .conditions import Hypothesis
from .full_return import FullReturn
from .legs import form
from .newton import checked
from .periodic_torus import product

Rows = tuple[tuple[arb, arb], tuple[arb, arb]]
COMBINATIONS = tuple((a, b) for a in range(5) for b in range(-4, 5) if 0 < a + abs(b) <= 4 and (a > 0 or b > 0))
"""(k_1, k_2) with |k_1| + |k_2| <= 4, one of each pair k, -k."""


class Torsion(NamedTuple):
    """What is shown of the return.

    Attributes:
        rotation_numbers: of the multipliers with positive imaginary part, whose real parts ascend.
        rows: tau, in coordinates that belong to some vectors W_1, W_2.
        defect: what is 0 by reversibility.
    """

    hypotheses: list[Hypothesis]
    rotation_numbers: tuple[arb, ...]
    rows: Rows
    defect: tuple[arb, ...]

    @property
    def determinant(self) -> arb:
        """The determinant of tau; its sign does not depend on the vectors."""
        (a, b), (c, d) = self.rows
        return a * d - b * c


def torsion(full: FullReturn) -> Torsion:
    """The conditions of tori, from jets of order 3 of the return."""
    parameters = full.stability()[::-1]
    cosines = [s.real for s in parameters]
    margins = {f"1 - s_{j}^2": 1 - s * s for j, s in enumerate(cosines, start=1)} | {
        "s_2 - s_1": cosines[1] - cosines[0]
    }
    real = all(s.imag == 0 for s in parameters)
    elliptic = Hypothesis("elliptic", real and all(z > 0 for z in margins.values()), margins)
    checked([elliptic])
    at = [acb(s, (1 - s * s).sqrt()) for s in cosines]
    powers = {f"k = ({a}, {b})": abs(at[0] ** a * at[1] ** b - 1) for a, b in COMBINATIONS}
    away = Hypothesis("non-resonance", all(z > 0 for z in powers.values()), powers)
    # At a resonance of order 3 there is no torsion.
    checked([away])
    found = normal_form(full, at)
    rows, defect = (
        ((found[0][0].imag, found[0][1].imag), (found[1][0].imag, found[1][1].imag)),
        [z.real for row in found for z in row],
    )
    numbers = tuple(s.acos() / (2 * arb.pi()) for s in cosines)
    result = Torsion([], numbers, rows, tuple(defect))
    names = {f"tau_{j}{i}": rows[j - 1][i - 1] for j in (1, 2) for i in (1, 2)} | {"determinant": result.determinant}
    regular = not result.determinant.contains(0) and all(z.contains(0) for z in defect)
    return result._replace(hypotheses=[elliptic, away, Hypothesis("torsion", regular, names)])


def normal_form(full: FullReturn, at: Sequence[acb]) -> list[list[acb]]:
    """conj(lambda_j) c_jl. README, section 16.2."""
    known = [full.direction(value) for value in at]
    vectors = [vector for vector, _ in known]
    bars = [[z.conjugate() for z in vector] for vector in vectors]

    def entry(j: int, i: int) -> acb:
        if i == j:
            return full.coefficient(at[j])[0]
        terms = (
            form(full.rows, vectors[j], vectors[i], bars[i]),
            form(full.rows, vectors[j], full.second(acb(1), vectors[i], bars[i])),
            form(full.rows, vectors[i], full.second(at[j] * at[i].conjugate(), vectors[j], bars[i])),
            form(full.rows, bars[i], full.second(at[j] * at[i], vectors[j], vectors[i])),
        )
        return product(known[j][1], [sum(parts, acb(0)) for parts in zip(*terms, strict=True)])

    return [[at[j].conjugate() * entry(j, i) for i in (0, 1)] for j in (0, 1)]
