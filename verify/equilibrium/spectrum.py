"""Eigenvalues of the derivative at an equilibrium, enclosed and counted (section 36.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from flint import acb, arb

from orbitproof.shared.stored import rules
from orbitproof.verify.evidence import is_positive
from orbitproof.verify.periodic import eigenvalues_of

Number = Annotated[int, rules("number_of_eigenvalues", minimum=0, maximum=32)]


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues of a real matrix.

    Attributes:
        values: one enclosure for each, with multiplicity; empty where none is found.
        left, right: how many are certain to have negative and positive real parts.
        undecided: how many of them are neither.
    """

    values: Annotated[tuple[acb, ...], rules("complex_balls", maxItems=32)]
    left: Number
    right: Number
    undecided: Number

    @property
    def is_stable(self) -> bool:
        """Whether all have negative real parts."""
        return self.right == self.undecided == 0

    @property
    def is_hyperbolic(self) -> bool:
        """Whether none may be on the imaginary axis."""
        return self.undecided == 0


def spectrum_of(matrix: Sequence[Sequence[arb]]) -> Spectrum:
    """The eigenvalues of every real matrix in an interval matrix."""
    values = eigenvalues_of(matrix)
    left = sum(is_positive(-value.real) for value in values)
    right = sum(is_positive(value.real) for value in values)
    return Spectrum(tuple(values), left, right, len(matrix) - left - right)
