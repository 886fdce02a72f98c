"""The statement of a certificate as data: programs, symmetries, section, claim, centre, frames. README, section 1."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

from .fixed_level import LevelSet, level_coordinate
from .jets import CannotFollow, Jet, constant, power

_NUMBER = re.compile(
    r"(-?)(?:0x(?P<digits>[0-9a-f]+)(?:p([+-]?[0-9]{1,6}))?"
    r"|[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]{1,5})?|[0-9]+/0*[1-9][0-9]*)"
)
N = TypeVar("N")
"""Jets or numbers."""
LEVEL = "(level)"
"""The value of the first integral among the inputs of a program; no coordinate or parameter can be called so."""
Operations = Mapping[str, Callable[[Any, Any], Any]]
ARITHMETIC = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "**": operator.pow}
"""For anything that has these operations."""
NUMBERS = ARITHMETIC | {"/": lambda a, b: a * power(b, Fraction(-1)), "**": power}
"""For arb and acb."""
PARITY = {
    "+": lambda a, b: a if a == b else 0, "-": lambda a, b: a if a == b else 0, "*": operator.mul, "/": operator.mul,
    "**": lambda a, e: a * a if e.numerator % 2 == 0 else a if e.denominator == 1 else int(a == 1),
}  # fmt: skip
"""For 1 of an even function, -1 of an odd one, 0 of one of which neither is known."""


class BadCertificate(ValueError):
    """The input is no certificate that can be read; the message names the field."""


def read(certificate: Mapping[str, Any], path: str, convert: Callable[[Any], Any]) -> Any:
    """A field of a certificate, converted. Raises `BadCertificate`."""
    value: Any = certificate
    try:
        for name in path.split("."):
            value = value[name]
        return convert(value)
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        why = f"{error}" if type(error) is ValueError else "it, or a part of it, is missing or has another form"
        raise BadCertificate(f"{path}: {why}") from None


def exact(value: Any) -> Any:
    """What a string denotes exactly, hexadecimal dyadic, decimal, or a fraction; the same for lists of them."""
    if isinstance(value, list):
        return tuple(map(exact, value))
    match = _NUMBER.fullmatch(value) if len(value) < 50_000 else None
    if match is None:
        raise ValueError("not an exact number")
    if match["digits"] is None:
        return Fraction(value)
    return Fraction(int(match[1] + match["digits"], 16)) * Fraction(2) ** int(match[3] or 0)


@dataclass(frozen=True)
class Program:
    """A straight-line program: lines of an operation and its operands, which are lines before it; lines returned."""

    lines: tuple[tuple[str, tuple[Any, ...]], ...]
    outputs: tuple[int, ...]

    @classmethod
    def from_text(cls, text: str) -> Program:
        """One operation a line, ``return v.., v..`` at the end."""
        *body, last = text.split("\n")
        lines: list[tuple[str, tuple[Any, ...]]] = []
        known: dict[str, int] = {}
        for n, row in enumerate(body):
            match row.removeprefix(f"v{n} = ").split(" "):
                case [base, "**", exponent] if re.fullmatch(r"\(-?[0-9]{1,3}(/2)?\)", exponent):
                    lines.append(("**", (known[base], Fraction(exponent[1:-1]))))
                case [left, "+" | "-" | "*" | "/" as operation, right]:
                    lines.append((operation, (known[left], known[right])))
                case [word] if word.isidentifier() or word == LEVEL:
                    if ("name", (word,)) in lines:
                        raise ValueError(f"two inputs are called {word}")
                    lines.append(("name", (word,)))
                case [word]:
                    lines.append(("constant", (exact(word),)))
                case words:
                    raise ValueError(f"no operation: {' '.join(words)}")
            known[f"v{n}"] = n
        return cls(tuple(lines), tuple(known[v] for v in last.removeprefix("return ").split(", ")))

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs in their order."""
        return tuple(operands[0] for operation, operands in self.lines if operation == "name")

    def run(
        self, inputs: Mapping[str, Any], constant: Callable[[Fraction], Any], operations: Operations = ARITHMETIC
    ) -> list[Any]:
        """The outputs, if lines are what these operations make of them."""
        values: list[Any] = []
        for operation, (first, *more) in self.lines:
            if operation == "name":
                values.append(inputs[first])
            elif operation == "constant":
                values.append(constant(first))
            else:
                second = more[0] if operation == "**" else values[more[0]]
                values.append(operations[operation](values[first], second))
        return [values[i] for i in self.outputs]

    def at(self, inputs: Mapping[str, Any], kind: Any) -> list[Any]:
        """The outputs on jets like this one, or on numbers if it is one; inputs may be exact rationals too."""
        known = {name: constant(kind, x) if isinstance(x, Fraction) else x for name, x in inputs.items()}
        return self.run(known, lambda x: constant(kind, x), ARITHMETIC if isinstance(kind, Jet) else NUMBERS)


@dataclass(frozen=True)
class Statement:
    """What a certificate claims, with a family parameter as a last state coordinate that does not move.

    Attributes:
        field: one output per name in `state`, but for a family parameter; `integral`: the bifurcation parameter.
        reversing, symmetry: signs of R and, for symmetry breaking, of S.
        fixed: indices of the coordinates of Fix(R), n + 1 of them; `kernel`: of the n others, without the section.
        centre, frame, kernel_frame: of the claim, in the coordinates `fixed` and `kernel`.
        crossings: of the section in a half orbit, its end included.
        level_set: of a family on a fixed level; the coordinate w that coordinate of Fix(R) is not among `fixed`.
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
    frame: tuple[tuple[Fraction, ...], ...]
    kernel_frame: tuple[tuple[Fraction, ...], ...]
    crossings: int = 1
    level_set: LevelSet | None = None

    def _evaluate(self, program: Program, state: Sequence[N]) -> list[N]:
        return program.at({**self.parameters, **dict(zip(self.state, state, strict=True))}, state[0])

    def velocity(self, state: Sequence[N]) -> list[N]:
        """The vector field on jets or numbers: by induction over the lines of its program each encloses that line."""
        rows = self._evaluate(self.field, state)
        return rows + [constant(state[0], Fraction(0))] * (len(state) - len(rows))

    def level(self, state: Sequence[Jet]) -> Jet:
        """The first integral on jets."""
        return self._evaluate(self.integral, state)[0]

    def conserved(self, state: Sequence[Jet]) -> Jet:
        """What does not change along orbits: H, also where it is not the bifurcation parameter."""
        return self._evaluate(self.integral if self.level_set is None else self.level_set.integral, state)[0]

    def check(self) -> None:
        """There is a theorem; R reverses the field, S commutes with it, both keep the first integral: section 1."""
        if len(self.kernel) not in (1, 2) or (self.kind == "symmetry_breaking" and self.symmetry is None):
            raise CannotFollow("no theorem that is used here is about so many equations, or no symmetry is named")
        for name, signs, sense in (("R", self.reversing, -1), ("S", self.symmetry, 1)):
            if signs is not None:
                inputs = dict.fromkeys(self.parameters, 1) | dict(zip(self.state, signs, strict=True))
                kept = self.integral if self.level_set is None else self.level_set.integral
                field, level = (p.run(inputs, lambda _: 1, PARITY) for p in (self.field, kept))
                holds = level == [1] and (self.level_set is None or signs[self.level_set.place] == 1)
                if not holds or any(f != sense * sign for f, sign in zip(field, signs, strict=False)):
                    raise CannotFollow(f"{name} is not shown to be a symmetry of the field and its first integral")


def read_statement(certificate: Mapping[str, Any]) -> Statement:
    """The statement of one certificate. Raises `BadCertificate`, and `CannotFollow` for one of another form."""
    claim = "statement.candidate"
    kind = read(certificate, f"{claim}.kind", str)
    if "k" not in read(certificate, claim, dict):
        raise CannotFollow(f"no theorem that is used here is about the kind {kind}")
    k = read(certificate, f"{claim}.k", operator.index)
    if not {
        "symmetry_breaking": k == 1,
        "fold": k == 1,
        "period_tupling": k % 2 == 0,
        "touch_and_go": k % 2 == 1 < k,
    }.get(kind):
        raise CannotFollow(f"no theorem that is used here is about {kind} with k = {k}")
    if read(certificate, claim, dict).get("parameter"):
        raise CannotFollow("a centre that is given by a level of the first integral is not followed")
    return read_reversible(certificate, kind, k)


def read_reversible(certificate: Mapping[str, Any], kind: str, k: int) -> Statement:
    """The statement of a certificate about a reversible system; the first of the centre may be a level."""
    claim, words = "statement.candidate", read(certificate, "statement", dict)
    crossings = read(certificate, claim, lambda c: operator.index(c.get("crossings", 1)))
    if not (0 < k <= 100 and 0 < crossings <= 100):
        raise BadCertificate(f"{claim}: k and crossings are numbers from 1 to 100")
    if words.get("functions"):
        raise CannotFollow("coordinates that are functions of others are not followed")
    field = read(certificate, "statement.vector_field", Program.from_text)
    m = len(field.outputs)

    def signs(values: Sequence[int]) -> tuple[int, ...]:
        return tuple({1: 1, -1: -1}[sign] for _, sign in zip(range(m), values, strict=True))

    reversing = read(certificate, "statement.reversing_symmetry", signs)
    symmetry = read(certificate, "statement.symmetry", signs) if words.get("symmetry") else None
    parameters = read(certificate, f"{claim}.parameters", lambda given: {n: exact(v) for n, v in given.items()})
    state, free = field.inputs[:m], tuple(name for name in field.inputs[m:] if name not in parameters)
    section = read(certificate, "statement.section", state.index)
    if reversing[section] != -1:
        raise BadCertificate("statement.section: no coordinate that R negates")
    fixed = tuple(i for i, sign in enumerate(reversing) if sign == 1)
    kernel = tuple(i for i, sign in enumerate(reversing) if sign == -1 and i != section)
    level_set = _level_set(certificate, state)
    if level_set is not None:
        fixed = tuple(i for i in fixed if i != level_set.place)
    if (words.get("first_integral") is None or level_set is not None) and len(free) == 1:
        # A parameter nu is a coordinate with nu' = 0, fixed by R and S, and its own first integral.
        integral, state, fixed = Program((("name", free),), (0,)), (*state, *free), (m, *fixed)
        reversing, symmetry = (*reversing, 1), None if symmetry is None else (*symmetry, 1)
    else:
        integral = read(certificate, "statement.first_integral", Program.from_text)
    if len(set(state)) != len(state) or not {*state, *parameters} >= {*field.inputs, *integral.inputs}:
        raise BadCertificate(f"{claim}.parameters: state and parameters are not the inputs of the programs")
    numbers = [read(certificate, f"{claim}.{name}", exact) for name in ("centre", "frame", "kernel_frame")]
    size, n = len(fixed), len(kernel)
    shapes = [len(numbers[0]), [len(row) for row in numbers[1]], [len(row) for row in numbers[2]]]
    if len(integral.outputs) != 1 or size != n + 1 or shapes != [size, [size] * size, [n] * n]:
        raise BadCertificate(f"{claim}: centre and frames do not have the sizes of the coordinates p and q")
    claimed = kind, k, *numbers, crossings, level_set
    return Statement(state, parameters, field, integral, reversing, symmetry, section, fixed, kernel, *claimed)


def _level_set(certificate: Mapping[str, Any], state: Sequence[str]) -> LevelSet | None:
    """The fixed level that the system of a claim names, if it names one."""
    named = read(certificate, "statement.candidate", lambda claim: claim.get("system"))
    if not (isinstance(named, dict) and named.get("fixed_level")):
        return None
    place = read(certificate, "statement.candidate.system", lambda system: state.index(level_coordinate(system)))
    value = read(certificate, "statement.candidate.system.fixed_level.value", exact)
    integral = read(certificate, "statement.first_integral", Program.from_text)
    if "between" in named["fixed_level"]:
        where = "statement.candidate.system.fixed_level.between"
        return LevelSet(integral, value, place, 0, read(certificate, where, lambda e: (exact(e[0]), exact(e[1]))))
    sign = read(certificate, "statement.candidate.system.fixed_level.sign", {1: 1, -1: -1}.__getitem__)
    return LevelSet(integral, value, place, sign)
