"""Numbers, functions known up to an error, and segments of a curve, drawn at random."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.stability.list_entries import Segment


def ball(chance: random.Random, low: float = -1.0, high: float = 1.0) -> arb:
    return arb(chance.uniform(low, high))


def number(chance: random.Random) -> Fraction:
    return Fraction(chance.randint(-64, 64), 64)


def function_of(chance: random.Random, degree: int = 4, error: float = 0.0) -> BoundedFunction:
    return BoundedFunction(ball_polynomial([number(chance) for _ in range(degree + 1)]), arb(error))


def segment_of(chance: random.Random, count: int, **changes: Any) -> Segment:
    own = [function_of(chance) for _ in range(count + 3)]
    places = Fraction(-1, 2), Fraction(-1, 4), Fraction(1, 2), Fraction(1, 8), Fraction(3, 4)
    found = Segment(0, *places, tuple(own[:count]), own[count], own[count + 1], own[count + 2])
    return replace(found, **changes)
