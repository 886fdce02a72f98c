"""Elements with a wide variable, and checks of their enclosures."""

from __future__ import annotations

import random
from typing import Any

import mpmath
from support.exact_elements import (
    Element,
    Unknown,
    number,
    random_arithmetic,
    random_point,
)

from orbitproof.verify.algebra import Arithmetic

POINTS = 6


def wide_arithmetic(source: random.Random) -> Arithmetic:
    return random_arithmetic(source, wide=True)


def points(source: random.Random, arithmetic: Arithmetic, count: int = POINTS) -> list[tuple[Any, Any, Any]]:
    return [random_point(source, arithmetic.grading, wide=True) for _ in range(count)]


def shrunk(element: Element, factor: float) -> Element:
    """The same element with a smaller unknown part."""
    unknown = tuple(Unknown(factor * u.size, u.exponents, u.shape) for u in element.unknown)
    return Element(element.series.with_errors([factor * e for e in element.series.errors]), unknown)


def values_of(program: Any, arguments: list[Any]) -> Any:
    return program.evaluate(arguments, number, lambda base, e: mpmath.power(base, number(e)))
