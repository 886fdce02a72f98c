"""Values of programs at elements that do not depend on time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from orbitproof.shared.systems import Program
from orbitproof.verify.algebra import Series, evaluate, prepare


def without_time(element: Series) -> Series:
    """An element that does not depend on time, of degree 0 in it. Raises `ValueError` if it does."""
    arithmetic = element.arithmetic
    if any(p.length() > arithmetic.stride for p in element.coefs):
        raise ValueError("an element depends on time")
    return Series(replace(arithmetic, degree=0), element.coefs, element.errors)


def at_start(program: Program, arguments: Sequence[Series]) -> list[Series]:
    """Values of a program at elements that do not depend on time, so that degree 0 does.

    Raises `ValueError` if one does.
    """
    values = evaluate(prepare(program), [without_time(x) for x in arguments])
    return [Series(arguments[0].arithmetic, x.coefs, x.errors) for x in values]
