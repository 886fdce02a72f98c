"""What is known of a function on a box: enclosures of its partial derivatives (sections 6 and 7.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from math import factorial, prod
from typing import Annotated

from flint import arb

from orbitproof.shared.stored import rules

MAX_ORDER = 3
MultiIndex = tuple[int, ...]
Brief = Annotated[arb, "MID +- RAD"]
"""A ball that certificates hold as text, exactly."""
Briefs = Annotated[tuple[Brief, ...], rules("balls", maxItems=10000)]


@dataclass(frozen=True)
class DerivativeTable:
    """Partial derivatives up to order 3 of a scalar function of p = (p_0, .., p_n).

    Attributes:
        box: for each multi-index a ball that contains the derivative at every point of the box
            |p_i| <= R_i.
        centre: the same at p = 0.
    """

    box: Mapping[MultiIndex, arb]
    centre: Mapping[MultiIndex, arb]


@cache
def indices_of_degree(variables: int, degree: int) -> tuple[MultiIndex, ...]:
    """All multi-indices of the given length and total degree."""
    if variables == 0:
        return ((),) if degree == 0 else ()
    return tuple(
        (first, *rest) for first in range(degree, -1, -1) for rest in indices_of_degree(variables - 1, degree - first)
    )


@cache
def indices_up_to(variables: int, degree: int) -> tuple[MultiIndex, ...]:
    """All multi-indices of the given length up to a total degree, by degree."""
    return tuple(index for d in range(degree + 1) for index in indices_of_degree(variables, d))


def index_factorial(index: MultiIndex) -> int:
    """alpha! = prod alpha_i!."""
    return prod(factorial(power) for power in index)
