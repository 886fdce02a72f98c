"""States whose last coordinates are functions of the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.system import System


def with_functions(
    system: System,
    state: Sequence[Any],
    parameters: Sequence[Any],
    functions: Mapping[str, Callable[[Any], Any]],
    constant: Callable[[Fraction], Any] | None = None,
    power: Callable[[Any, Fraction], Any] | None = None,
) -> list[Any]:
    """The state with the coordinates that are functions of others, in any arithmetic; their own entries are not used.

    Args:
        state: all coordinates.
        functions: "sin", "cos", "exp" and "log" in this arithmetic.
        constant, power: as for `Program.evaluate`.
    """
    values = list(state)
    first = len(system.given_state)
    for place, (each, argument) in enumerate(zip(system.defined, system.argument_programs, strict=True), first):
        (value,) = argument.evaluate([*values, *parameters], constant, power)
        values[place] = functions[each.function](value)
    return values
