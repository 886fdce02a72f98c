"""The statement of a certificate, read as data: programs, symmetries, section, parameters, claim, centre."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

_HEXADECIMAL = re.compile(r"(-?)0x([0-9a-f]+)(?:p([+-]?[0-9]{1,6}))?\Z")
_DECIMAL = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]{1,5})?\Z")
_FRACTION = re.compile(r"-?[0-9]{1,4000}/0*[1-9][0-9]{0,3999}\Z")
_LINE = re.compile(
    r"v(?P<index>[0-9]+) = (?:"
    r"v(?P<left>[0-9]+) (?:(?P<sign>[-+*/]) v(?P<right>[0-9]+)|\*\* \((?P<power>-?[0-9]+(?:/2)?)\))"
    r"|(?P<constant>-?[0-9]+(?:/[1-9][0-9]*)?)|(?P<name>[A-Za-z_]\w*))\Z"
)


class BadCertificate(ValueError):
    """The input is no certificate that can be read; the message names the field."""


@dataclass(frozen=True)
class Program:
    """A straight-line program; an output None is the constant 0.

    Attributes:
        lines: operation (``name``, ``constant``, ``+``, ``-``, ``*``, ``/``, ``**``), numbers of earlier lines,
            constant or exponent, name.
    """

    lines: tuple[tuple[str, tuple[int, ...], Fraction, str], ...]
    outputs: tuple[int | None, ...]

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs in their order."""
        return tuple(name for operation, _, _, name in self.lines if operation == "name")

    def parities(self, signs: Mapping[str, int]) -> list[int | None]:
        """For each output 1 if it is even, -1 if it is odd under the sign changes of the inputs, None if unknown."""
        found: list[int | None] = []
        for operation, operands, value, name in self.lines:
            sides = [found[i] for i in operands]
            if operation in ("name", "constant"):
                found.append(signs.get(name, 1))
            elif None in sides:
                found.append(None)
            elif operation in "+-":
                found.append(sides[0] if sides[0] == sides[1] else None)
            elif operation in "*/":
                found.append(1 if sides[0] == sides[1] else -1)
            elif sides[0] == 1 or value.denominator == 1:
                found.append(1 if sides[0] == 1 or value.numerator % 2 == 0 else -1)
            else:
                found.append(None)
        return [None if i is None else found[i] for i in self.outputs]


@dataclass(frozen=True)
class Statement:
    """What a certificate claims, with a family parameter as a further state coordinate that does not move.

    Attributes:
        field: m outputs, one per name in `state`; `integral`: one output, the bifurcation parameter.
        reversing, symmetry: m signs of R and, for symmetry breaking, of S.
        fixed: indices of the coordinates of Fix(R), n + 1 of them; `kernel`: of the n others, without the section.
        centre: values of the coordinates in `fixed`.
        crossings: of the section in a half orbit, its end included.
    """

    state: tuple[str, ...]
    parameters: Mapping[str, Fraction]
    field: Program
    integral: Program
    reversing: tuple[int, ...]
    symmetry: tuple[int, ...] | None
    section: int
    fixed: tuple[int, ...]
    kernel: tuple[int, ...]
    kind: str
    k: int
    centre: tuple[Fraction, ...]
    crossings: int = 1


def exact(text: object, field: str) -> Fraction:
    """The number that a string denotes exactly: hexadecimal dyadic, decimal, or a fraction."""
    if isinstance(text, str) and len(text) < 50_000:
        if match := _HEXADECIMAL.match(text):
            value = Fraction(int(match[2], 16)) * Fraction(2) ** int(match[3] or 0)
            return -value if match[1] else value
        if _DECIMAL.match(text) or _FRACTION.match(text):
            return Fraction(text)
    raise BadCertificate(f"{field}: not an exact number")


def program(text: object, field: str) -> Program:
    """A straight-line program from its text, one operation a line, the last line ``return v.., v..``."""
    if not isinstance(text, str):
        raise BadCertificate(f"{field}: not a program")
    *body, last = text.split("\n")
    lines: list[tuple[str, tuple[int, ...], Fraction, str]] = []
    for number, row in enumerate(body):
        match = _LINE.match(row)
        operands = tuple(int(match[key]) for key in ("left", "right") if match[key]) if match else ()
        if match is None or int(match["index"]) != number or any(i >= number for i in operands):
            raise BadCertificate(f"{field}: line {number + 1} is no operation on earlier lines")
        operation = "**" if match["power"] else match["sign"] or ("constant" if match["constant"] else "name")
        value = Fraction(match["power"] or match["constant"] or 0)
        lines.append((operation, operands, value, match["name"] or ""))
    outputs = re.fullmatch(r"return (v[0-9]+(?:, v[0-9]+)*)", last)
    if outputs is None or any(int(v[1:]) >= len(lines) for v in outputs[1].split(", ")):
        raise BadCertificate(f"{field}: the last line returns no earlier lines")
    return Program(tuple(lines), tuple(int(v[1:]) for v in outputs[1].split(", ")))


def _signs(value: object, length: int, field: str) -> tuple[int, ...]:
    if not isinstance(value, list) or len(value) != length or any(sign not in (1, -1) for sign in value):
        raise BadCertificate(f"{field}: not {length} signs")
    return tuple(value)


def read_statement(certificate: Mapping[str, Any]) -> Statement:
    """The statement of one certificate. Raises `BadCertificate`."""
    try:
        words, claim = certificate["statement"], certificate["statement"]["candidate"]
        kind, k, centre, given = claim["kind"], claim["k"], claim["centre"], claim["parameters"]
        crossings = claim.get("crossings", 1)
        text, signs = words["vector_field"], words["reversing_symmetry"]
    except (KeyError, TypeError) as error:
        raise BadCertificate(f"statement: {error} is missing") from None
    if type(k) is not int or not 1 <= k <= 100 or not isinstance(centre, list) or not isinstance(given, dict):
        raise BadCertificate("statement.candidate: k, centre or parameters are of the wrong type")
    if type(crossings) is not int or not 1 <= crossings <= 100:
        raise BadCertificate("statement.candidate.crossings: no number of crossings")
    if claim.get("parameter"):
        raise BadCertificate("statement.candidate.parameter: a centre with a level instead of a coordinate is not read")
    field = program(text, "statement.vector_field")
    m = len(field.outputs)
    reversing = _signs(signs, m, "statement.reversing_symmetry")
    symmetry = _signs(words["symmetry"], m, "statement.symmetry") if words.get("symmetry") else None
    parameters = {name: exact(value, f"statement.candidate.parameters.{name}") for name, value in given.items()}
    state, free = field.inputs[:m], [name for name in field.inputs[m:] if name not in parameters]
    if words.get("first_integral") is None and len(free) == 1:
        # A parameter nu is a coordinate with nu' = 0, fixed by R and S, and its own first integral.
        state, reversing = (*state, free[0]), (*reversing, 1)
        symmetry = None if symmetry is None else (*symmetry, 1)
        field = Program(field.lines, (*field.outputs, None))
        integral = Program((("name", (), Fraction(0), free[0]),), (0,))
    elif not free:
        integral = program(words.get("first_integral"), "statement.first_integral")
    else:
        raise BadCertificate(f"statement.candidate.parameters: no value of {', '.join(free)}")
    known = {*state, *parameters}
    if len(set(state)) != len(state) or len(integral.outputs) != 1 or not known.issuperset(integral.inputs):
        raise BadCertificate("statement.first_integral: not one function of state and parameters")
    if words.get("section") not in state[:m] or reversing[state.index(words["section"])] != -1:
        raise BadCertificate("statement.section: no coordinate that R negates")
    section = state.index(words["section"])
    fixed = tuple(i for i, sign in enumerate(reversing) if sign == 1)
    if state[-1] in free:
        fixed = (fixed[-1], *fixed[:-1])
    kernel = tuple(i for i, sign in enumerate(reversing) if sign == -1 and i != section)
    if len(fixed) != len(kernel) + 1 or len(centre) != len(fixed):
        raise BadCertificate("statement.candidate.centre: not one number for each coordinate of Fix(R)")
    point = tuple(exact(value, "statement.candidate.centre") for value in centre)
    claimed = (kind, k, point, crossings)
    return Statement(state, parameters, field, integral, reversing, symmetry, section, fixed, kernel, *claimed)
