"""Claims about boxes in a section in other coordinates of the state, without any symmetry of their own."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, TypeVar

from orbitproof.shared.formats import InSection, PeriodicBifurcation, define_system
from orbitproof.shared.systems import System
from orbitproof.verify.claim import inverse

Rows = tuple[tuple[Fraction, ...], ...]
Claim = TypeVar("Claim", bound=InSection)


def elsewhere(claim: Claim, chance: random.Random) -> Claim:
    """The same of M x for the state x; the coordinates of the box are the same, parameters stand in another order."""
    return moved_by(claim, mixing(len(claim.centre), chance))


def moved_by(claim: Claim, matrix: Rows) -> Claim:
    """The same with this M."""
    back = inverse(matrix)
    assert back is not None
    changes: dict[str, Any] = {}
    if isinstance(claim, PeriodicBifurcation) and claim.symmetry is not None:
        changes["symmetry"] = product(product(matrix, claim.symmetry), back)
    return replace(
        claim,
        system=_moved(claim.system, matrix, tuple(map(tuple, back))),
        normal=tuple(dot(claim.normal, column) for column in zip(*back, strict=True)),
        centre=tuple(dot(row, claim.centre) for row in matrix),
        frame=product(matrix, claim.frame),
        **changes,
    )


def _moved(system: System, matrix: Rows, back: Rows) -> System:
    size, own, names = len(matrix), list(system.parameters), list(system.parameters)[::-1]
    integral = system.first_integral_program

    def arguments(values: Sequence[Any]) -> list[Any]:
        known = dict(zip(names, values[size:], strict=True))
        return [*(dot(row, values[:size]) for row in back), *(known[name] for name in own)]

    def field(*values: Any) -> tuple[Any, ...]:
        slopes = system.program.evaluate(arguments(values), _same, pow)
        return tuple(dot(row, slopes) for row in matrix)

    def level(*values: Any) -> Any:
        assert integral is not None
        return integral.evaluate(arguments(values), _same, pow)[0]

    description: dict[str, Any] = {
        "name": "elsewhere", "state": [f"x{i}" for i in range(size)], "parameters": names, "field": field,
    }  # fmt: skip
    return define_system(description | ({} if integral is None else {"first_integral": level}))


def _same(value: Fraction) -> Fraction:
    return value


def mixing(size: int, chance: random.Random) -> Rows:
    """A regular matrix of whole numbers of both signs, of determinant 1."""
    lower, upper = ([[chance.choice((-2, -1, 1, 2)) for _ in range(size)] for _ in range(size)] for _ in "lu")
    ones = [[int(i == j) for j in range(size)] for i in range(size)]
    left = [[lower[i][j] if j < i else ones[i][j] for j in range(size)] for i in range(size)]
    right = [[upper[i][j] if j > i else ones[i][j] for j in range(size)] for i in range(size)]
    return product(left, right)


def shear(size: int, chance: random.Random) -> Rows:
    """Each coordinate and half of the one before it, or less that: for orbits that are followed."""
    half = [chance.choice((-1, 1)) * Fraction(1, 2) for _ in range(size)]
    return tuple(
        tuple(Fraction(int(i == j)) + (half[i] if j == i - 1 else 0) for j in range(size)) for i in range(size)
    )


def product(left: Sequence[Sequence[Any]], right: Sequence[Sequence[Any]]) -> Rows:
    """Of two matrices."""
    return tuple(tuple(Fraction(dot(row, column)) for column in zip(*right, strict=True)) for row in left)


def dot(left: Sequence[Any], right: Sequence[Any]) -> Any:
    """The sum of products, of numbers or of variables."""
    first, *others = (a * b for a, b in zip(left, right, strict=True))
    return sum(others, first)
