"""Straight-line programs read from text, as descriptions of systems and certificates carry them."""

from __future__ import annotations

import re
from fractions import Fraction

from orbitproof.shared.systems.program import SYMBOLS, Instruction, Program, allowed_exponent

_MOST_LINES = 10_000
"""Lines that a program which is read may have."""


def program_from_text(text: str) -> Program:
    """The program that `Program.text` writes in this way. It is read as data, never run.

    Raises `ValueError` for every other text.
    """
    *body, last = text.split("\n")
    if len(body) > _MOST_LINES:
        raise ValueError(f"a program has at most {_MOST_LINES} lines, not {len(body)}")
    instructions = [_instruction(index, line) for index, line in enumerate(body)]
    inputs = tuple(step.name for step in instructions if step.name is not None)
    if not re.fullmatch(r"return v[0-9]{1,9}(, v[0-9]{1,9})*", last, re.ASCII):
        raise ValueError(f"the last line of a program names its outputs, not {last[:60]!r}")
    outputs = tuple(int(name) for name in re.findall(r"[0-9]+", last))
    leading = all(step.operation == "input" for step in instructions[: len(inputs)])
    earlier = all(operand < index for index, step in enumerate(instructions) for operand in step.operands)
    if not leading or not earlier or max(outputs) >= len(instructions):
        raise ValueError("a program begins with its inputs, and each line uses earlier ones only")
    program = Program(inputs, tuple(instructions), outputs)
    if len(set(inputs)) != len(inputs) or len(set(instructions)) != len(instructions) or program.text() != text:
        raise ValueError("a program names each input and writes each operation once, in one form")
    return program


_LINE = re.compile(
    r"v(?P<index>[0-9]{1,9}) = (?:"
    r"(?P<name>[A-Za-z_][A-Za-z0-9_]{0,59})"
    r"|(?P<constant>-?[0-9]{1,4000}(?:/[0-9]{1,4000})?)"
    r"|v(?P<base>[0-9]{1,9}) \*\* \((?P<exponent>-?[0-9]{1,9}(?:/[0-9]{1,9})?)\)"
    r"|v(?P<left>[0-9]{1,9}) (?P<sign>[-+*/]) v(?P<right>[0-9]{1,9})"
    r")",
    re.ASCII,
)
_OPERATIONS = {symbol: operation for operation, symbol in SYMBOLS.items()}


def _instruction(index: int, line: str) -> Instruction:
    """One line of a program's text. Raises `ValueError` for anything else."""
    found = _LINE.fullmatch(line)
    if found is None or found["index"] != str(index):
        raise ValueError(f"line {index + 1} is no operation of a program: {line[:60]!r}")
    try:
        if found["constant"] is not None:
            return Instruction("constant", value=Fraction(found["constant"]))
        if found["base"] is not None:
            return Instruction("pow", (int(found["base"]),), allowed_exponent(Fraction(found["exponent"])))
    except ZeroDivisionError:
        raise ValueError(f"line {index + 1} divides by zero: {line[:60]!r}") from None
    if found["sign"] is not None:
        return Instruction(_OPERATIONS[found["sign"]], (int(found["left"]), int(found["right"])))
    # A name that looks like a line, v7, would make two texts of one program.
    if re.fullmatch(r"v[0-9]+", found["name"]):
        raise ValueError(f"line {index + 1}: {found['name']!r} cannot be the name of an input")
    return Instruction("input", name=found["name"])
