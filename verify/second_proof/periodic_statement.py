"""What a certificate claims of a periodic orbit without symmetry. README, sections 9.1 and 9.2."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from .jets import CannotFollow, ball, constant
from .statement import PARITY, BadCertificate, Program, exact, read

DEPENDENCE = {name: lambda a, b: a | b for name in "+-*/"} | {"**": lambda a, exponent: a}
"""For the sets of names on which lines depend."""


def gradient(program: Program, names: Sequence[str]) -> Program:
    """The partial derivatives of a program with one output, by reverse accumulation. README, section 9.2."""
    lines, adjoint = list(program.lines), dict[int, int]()

    def line(operation: str, *operands: Any) -> int:
        lines.append((operation, operands))
        return len(lines) - 1

    def add(place: int, term: int) -> None:
        adjoint[place] = line("+", adjoint[place], term) if place in adjoint else term

    zero, minus = line("constant", Fraction(0)), line("constant", Fraction(-1))
    adjoint[program.outputs[0]] = line("constant", Fraction(1))
    for place, (operation, (left, *more)) in reversed(list(enumerate(program.lines))):
        if place not in adjoint or operation in ("name", "constant"):
            continue
        factor, right = adjoint[place], more[0]
        if operation in "+-":
            add(left, factor)
            add(right, factor if operation == "+" else line("*", minus, factor))
        elif operation == "*":
            add(left, line("*", factor, right))
            add(right, line("*", factor, left))
        elif operation == "/":
            add(left, line("/", factor, right))
            add(right, line("*", minus, line("/", line("*", factor, place), right)))
        elif right:
            slope = line("*", line("constant", right), line("**", left, right - 1))
            add(left, line("*", factor, slope))
    places = {operands[0]: n for n, (operation, operands) in enumerate(program.lines) if operation == "name"}
    return Program(tuple(lines), tuple(adjoint.get(places.get(name, -1), zero) for name in names))


@dataclass(frozen=True)
class PeriodicStatement:
    """What a certificate claims of a periodic orbit: the field, a section in a direction, its crossings, the box.

    Followed are x, with a first integral mu, and the height y = a . x - b. README, section 9.1.

    Attributes:
        integral, slopes: the first integral and its gradient; `None` where no level is claimed, as `level`.
        varying: a parameter that is followed as a coordinate with rate 0, before y; `parameters` has a value near it.
        symmetry: signs of the coordinates under the S of a pitchfork.
    """

    names: tuple[str, ...]
    parameters: Mapping[str, Fraction]
    field: Program
    integral: Program | None
    slopes: Program | None
    level: Fraction | None
    normal: tuple[Fraction, ...]
    offset: Fraction
    direction: int
    crossings: int
    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    varying: str | None = None
    symmetry: tuple[int, ...] | None = None

    @property
    def section(self) -> int:
        """The coordinate y."""
        return len(self.names) + (self.slopes is not None) + (self.varying is not None)

    def evaluate(self, program: Program, state: Sequence[Any]) -> list[Any]:
        """The outputs of a program at x, a jet or numbers."""
        known = {**self.parameters, **dict(zip(self.names, state, strict=False))}
        if self.varying is not None:
            known[self.varying] = state[self.section - 1]
        return program.at(known, state[0])

    def velocity(self, state: Sequence[Any]) -> list[Any]:
        """f + mu grad H, mu' = 0, the rate 0 of what varies, and y'."""
        rows, zero = self.evaluate(self.field, state), constant(state[0], Fraction(0))
        if self.slopes is not None:
            mu = state[len(self.names)]
            rows = [f + mu * slope for f, slope in zip(rows, self.evaluate(self.slopes, state), strict=True)]
        still = [zero] * ((self.slopes is not None) + (self.varying is not None))
        return [*rows, *still, sum((f * ball(a) for f, a in zip(rows, self.normal, strict=True)), zero)]

    def keeps_volume(self) -> bool:
        """Whether no component of the field depends on its own coordinate: then its divergence is 0."""
        inputs = {name: frozenset({name}) for name in (*self.names, *self.parameters)}
        found = self.field.run(inputs, lambda _: frozenset(), DEPENDENCE)
        return all(name not in used for name, used in zip(self.names, found, strict=True))

    def check(self) -> None:
        """The box lies in the section, and is as many-dimensional as that is."""
        columns = list(zip(*self.frame, strict=True))
        flat = all(sum(map(operator.mul, self.normal, column)) == 0 for column in columns)
        if not any(self.normal) or not flat or sum(map(operator.mul, self.normal, self.centre)) != self.offset:
            raise CannotFollow("the box does not lie in the section")
        if self.symmetry is not None:
            signs = dict.fromkeys(self.parameters, 1) | dict(zip(self.names, self.symmetry, strict=True))
            kept = self.field.run(signs, lambda _: 1, PARITY) == list(self.symmetry)
            level = self.integral is None or self.integral.run(signs, lambda _: 1, PARITY) == [1]
            if (
                not kept
                or not level
                or any(a and sign != 1 for a, sign in zip(self.normal, self.symmetry, strict=True))
            ):
                raise CannotFollow("S is not shown to respect the field, the first integral and the section")


def read_periodic(certificate: Mapping[str, Any]) -> PeriodicStatement:
    """The statement of a certificate of a periodic orbit. Raises `BadCertificate`, and `CannotFollow` for functions."""
    claim, words = "statement.candidate", read(certificate, "statement", dict)
    given = read(certificate, claim, dict)
    if words.get("functions"):
        raise CannotFollow("coordinates that are functions of others are not followed")
    field = read(certificate, "statement.vector_field", Program.from_text)
    names = field.inputs[: len(field.outputs)]
    parameters = read(certificate, f"{claim}.parameters", lambda known: {n: exact(v) for n, v in known.items()})
    level = None if given.get("level") is None else read(certificate, f"{claim}.level", exact)
    integral = None
    if level is not None:
        integral = read(certificate, "statement.first_integral", Program.from_text)
    shape = {"normal": len(names), "centre": len(names), "frame": len(names)}
    vectors = {name: read(certificate, f"{claim}.{name}", exact) for name in (*shape, "offset")}
    direction, crossings = (read(certificate, f"{claim}.{name}", operator.index) for name in ("direction", "crossings"))
    is_claim = direction in (1, -1) and 0 < crossings <= 1000 and words.get("vector_field") is not None
    sizes = all(len(vectors[name]) == size for name, size in shape.items())
    if not is_claim or not sizes or any(len(row) != len(names) - 1 for row in vectors["frame"]):
        raise BadCertificate(f"{claim}: direction, crossings or the box are not those of a claim")
    if len(set(names)) != len(names) or len(integral.outputs if integral else [0]) != 1:
        raise BadCertificate("statement: the programs are not those of a field and its first integral")
    if not {*names, *parameters} >= {*field.inputs, *(integral.inputs if integral else ())}:
        raise BadCertificate(f"{claim}.parameters: state and parameters are not the inputs of the programs")
    slopes = None if integral is None else gradient(integral, names)
    return PeriodicStatement(
        names, parameters, field, integral, slopes, level, vectors["normal"], vectors["offset"], direction, crossings,
        vectors["centre"], vectors["frame"],
    )  # fmt: skip
