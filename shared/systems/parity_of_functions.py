"""Parities of coordinates that are functions of others (section 5.5)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.systems.parity import parities
from orbitproof.shared.systems.program import Program


def function_parity(function: str, argument: int) -> int:
    """The parity of sin, cos, exp or log of something of parity `argument`; 0 if it is not decided."""
    match function:
        case "sin":
            return argument
        case "cos":
            return argument * argument
        case _:
            # exp(-e) and log(-e) are no multiples of exp(e) and log(e).
            return 1 if argument == 1 else 0


def signs_with_functions(
    functions: Sequence[str], arguments: Sequence[Program], signs: Sequence[int]
) -> tuple[int, ...]:
    """The signs of given coordinates, then those of coordinates that are functions of earlier ones; 0 if not decided.

    Args:
        functions: of each further coordinate its function.
        arguments: of each its argument; inputs are the state and the parameters.
    """
    result = list(signs)
    for function, argument in zip(functions, arguments, strict=True):
        # Later coordinates are not in the argument.
        later = [0] * (len(signs) + len(functions) - len(result))
        result.append(function_parity(function, parities(argument, [*result, *later])[0]))
    return tuple(result)
