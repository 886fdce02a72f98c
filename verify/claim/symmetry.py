"""Parity analysis of straight-line programs (section 1.3).

Under a diagonal sign change of the state every node of a program is even (unchanged), odd (negated)
or neither. Sums of two even nodes are even, of two odd nodes odd; parities multiply in products and
quotients; a power of an even node is even, an integer power of an odd node has the parity of the
exponent. That proves f(R x) = -R f(x), f(S x) = S f(x) and the invariance of a first integral.
"""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.systems import Program, ReversibleSystem
from orbitproof.verify.evidence import IntegrationFailure

_NEITHER = 0


def parities(program: Program, signs: Sequence[int]) -> list[int]:
    """For each output 1 (even), -1 (odd) or 0 (not decided) under the signs of the inputs.

    `signs` covers the first inputs; the further inputs (parameters) are unchanged. A constant zero is
    not treated as odd.
    """
    values: list[int] = []
    for index, step in enumerate(program.instructions):
        operands = [values[operand] for operand in step.operands]
        match step.operation:
            case "input":
                values.append(signs[index] if index < len(signs) else 1)
            case "constant":
                values.append(1)
            case "add" | "sub":
                values.append(operands[0] if operands[0] == operands[1] else _NEITHER)
            case "mul" | "div":
                values.append(operands[0] * operands[1])
            case "pow":
                assert step.value is not None
                whole = step.value.denominator == 1
                odd = operands[0] == -1
                if odd and not whole:
                    values.append(_NEITHER)
                elif odd:
                    values.append(-1 if step.value.numerator % 2 else 1)
                else:
                    values.append(operands[0])
    return [values[index] for index in program.outputs]


def signs_on(system: ReversibleSystem, symmetry: str, coordinates: Sequence[str]) -> tuple[int, ...]:
    """The signs of a symmetry on coordinates of Fix(R); parameters and levels among them are left alone."""
    signs = dict(zip(system.state, system.symmetries[symmetry], strict=True))
    return tuple(signs.get(name, 1) for name in coordinates)


def check_symmetries(system: ReversibleSystem, symmetry: str | None = None) -> None:
    """Prove that R reverses the system and that `symmetry`, if named, commutes with its flow.

    Both leave the first integral unchanged, and R and S commute because both are diagonal. Raises
    `IntegrationFailure` if the program does not show it.
    """
    _check(system, "R", system.reversing_symmetry, -1)
    if symmetry is not None:
        _check(system, symmetry, system.symmetries[symmetry], 1)


def _check(system: ReversibleSystem, name: str, signs: Sequence[int], orientation: int) -> None:
    wanted = [orientation * sign for sign in signs]
    integral = system.first_integral_program
    if parities(system.program, signs) != wanted or (integral is not None and parities(integral, signs) != [1]):
        raise IntegrationFailure(
            "symmetry",
            f"the vector field of {system.name} was not shown to have the symmetry {name}",
            "correct the description of the system",
        )
