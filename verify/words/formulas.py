"""A system in formulas, from its straight-line programs: what it takes to restate a theorem (section 1.5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from string import ascii_lowercase

from orbitproof.shared.systems import BRANCH_SYSTEMS, Program, ReversibleSystem, System
from orbitproof.verify.claim.wording import keyed_in_words, names_in_words, system_in_words
from orbitproof.verify.evidence import exact_text

_SUM, _PRODUCT, _POWER, _ATOM = range(4)
"""How tightly the outermost operation of a formula binds."""

_INLINE = 3
"""A subexpression that is used again and has more operations gets a name."""

_SIGNS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}


def equations(program: Program, left: Sequence[str], taken: Sequence[str] = ()) -> list[str]:
    """``left = formula`` for each output of a program, then what the names in them stand for, none of those `taken`.

    Operations are written down in the order in which the program does them, with ``^`` for powers; x*x is x^2, and
    the factor -1 a sign.
    """
    formulas = _Formulas(program, taken)
    lines = [f"{name} = {formulas.of(output)[0]}" for name, output in zip(left, program.outputs, strict=True)]
    return [*lines, *formulas.definitions]


class _Formulas:
    def __init__(self, program: Program, taken: Sequence[str] = ()) -> None:
        steps = program.instructions
        self.steps = steps
        self.texts: dict[int, tuple[str, int]] = {}
        self.definitions: list[str] = []
        uses = [0] * len(steps)
        needed = {*program.outputs}
        for index in range(len(steps) - 1, -1, -1):
            for operand in steps[index].operands if index in needed else ():
                needed.add(operand)
                uses[operand] += 1
        names = iter(_unused((*program.inputs, *taken)))
        sizes: list[int] = []
        for index, step in enumerate(steps):
            square = step.operation == "mul" and len(set(step.operands)) == 1
            sizes.append(sum(sizes[i] for i in (step.operands[:1] if square else step.operands)) + bool(step.operands))
            # x*x uses x twice and is written with one.
            if uses[index] > 1 and sizes[index] > _INLINE and not self._only_squared(index):
                name = next(names)
                self.definitions.append(f"{name} = {self.of(index)[0]}")
                self.texts[index], sizes[index] = (name, _ATOM), 0

    def _only_squared(self, index: int) -> bool:
        users = [step for step in self.steps if index in step.operands]
        return len(users) == 1 and users[0].operation == "mul"

    def of(self, index: int) -> tuple[str, int]:
        """A formula, and how tightly it binds."""
        if index not in self.texts:
            self.texts[index] = self._new(index)
        return self.texts[index]

    def _new(self, index: int) -> tuple[str, int]:
        step = self.steps[index]
        if step.name is not None:
            return step.name, _ATOM
        if step.operation == "constant":
            assert step.value is not None
            return _number(step.value)
        left = step.operands[0]
        if step.operation == "pow":
            assert step.value is not None
            text, binds = _number(step.value)
            return f"{self._within(left, _ATOM)}^{text if binds == _ATOM else f'({text})'}", _POWER
        right = step.operands[1]
        if step.operation == "mul":
            if left == right:
                return f"{self._within(left, _ATOM)}^2", _POWER
            for one, other in ((left, right), (right, left)):
                if self.steps[one].value == -1 and self.steps[one].operation == "constant":
                    return f"-{self._within(other, _PRODUCT)}", _SUM
        binds = _SUM if step.operation in ("add", "sub") else _PRODUCT
        second = self._within(right, binds + (step.operation != "add" and step.operation != "mul"))
        if second.startswith("-"):
            second = f"({second})"
        sign = _SIGNS[step.operation]
        return f"{self._within(left, binds)}{f' {sign} ' if binds == _SUM else sign}{second}", binds

    def _within(self, index: int, tightness: int) -> str:
        text, binds = self.of(index)
        return text if binds >= tightness else f"({text})"


def _number(value: Fraction) -> tuple[str, int]:
    return str(value), _SUM if value < 0 else _PRODUCT if value.denominator > 1 else _ATOM


def _unused(inputs: Sequence[str]) -> list[str]:
    """Letters that are no inputs, then numbered ones."""
    letters = [letter for letter in ascii_lowercase if letter not in (*inputs, "x", "y", "z", "t", "k", "p", "q")]
    return [*letters, *(f"u{number}" for number in range(1, 1000))]


def free_letter(system: System, letter: str) -> str:
    """A letter of a theorem, and what stands for it where somebody's coordinate or parameter is called so."""
    names = (*system.state, *system.parameters)
    return next(each for each in (letter, *(f"{letter}{n}" for n in range(len(names) + 1))) if each not in names)


_TAKEN = ("c", "h", "i", "j", "s", "u")
"""Letters of theorems, which no formula of somebody's own system has for a part of it."""


def setting(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], symmetry: str | None, crossings: int = 1
) -> list[str]:
    """Lines that say what the system is, its symmetries and first integral, the section and the map P.

    Args:
        parameters: the values that are given; a name that is not among them stays a name.
        symmetry: the name of S, if the theorem uses one.
        crossings: P is the map to the crossing of this number.
    """
    names, parameters = names_in_words(system), keyed_in_words(system, parameters)
    symmetry = None if symmetry is None else names.get(symmetry, symmetry)
    system = system_in_words(system)
    left = [f"{name}'" for name in system.state]
    taken: tuple[str, ...] = () if system.name in BRANCH_SYSTEMS else _TAKEN
    field = equations(system.program, left, taken)
    taken = (*taken, *_left_sides(field)) if taken else ()
    lines = [f"The {system.title}:", *(f"  {line}" for line in field)]
    lines += [f"  {name} = {exact_text(value)}" for name, value in parameters.items()]
    if system.defined:
        kinds = [(each.name, each.function) for each in system.defined]
        functions = functions_in_lines(system.given_state, kinds, system.argument_programs, taken)
        taken = (*taken, *_left_sides(functions))
        lines += functions
    if names:
        called = ", ".join(f"{new} is called {name}" for name, new in names.items())
        lines.append(f"In the description of the system {called}, which has another meaning here.")
    if system.first_integral_program is not None:
        lines.append(f"A first integral, the {system.first_integral_name or 'value of H'}:")
        lines += [f"  {line}" for line in equations(system.first_integral_program, ["H"], taken)]
    state = ", ".join(system.state)
    lines.append(f"R({state}) = ({_image(system, system.reversing_symmetry)}) reverses the flow.")
    if symmetry is not None and symmetry in system.symmetries:
        lines.append(f"{symmetry}({state}) = ({_image(system, system.symmetries[symmetry])}) commutes with it.")
    if crossings > 1:
        lines.append(
            f"The Poincare map takes a point of the section {{{system.section} = 0}} that its orbit crosses to the "
            f"next point in which the orbit crosses the section, in either direction; P is its power {crossings}."
        )
        return [*lines, *_points(system)]
    lines.append(
        f"P maps a point of the section {{{system.section} = 0}} that its orbit crosses to the next point in which "
        f"the orbit crosses the section, which is in the opposite direction."
    )
    return [*lines, *_points(system)]


def functions_in_lines(
    given: Sequence[str], functions: Sequence[tuple[str, str]], arguments: Sequence[Program], taken: Sequence[str]
) -> list[str]:
    """The coordinates that are functions of others, and what the names in their arguments stand for.

    Args:
        given: names of the others.
        functions: name and function of each.
        taken: letters that stand for something else.
    """
    lines: list[str] = []
    for (name, function), program in zip(functions, arguments, strict=True):
        # No letter stands for two things in one statement.
        formulas = _Formulas(program, (*taken, *_left_sides(lines)))
        lines.append(f"{name} = {function}({formulas.of(program.outputs[0])[0]})")
        lines += formulas.definitions
    named = ", ".join(name for name, _ in functions)
    first = f"The states are given by {', '.join(given)}; {named} are these functions of them:"
    return [first, *(f"  {line}" for line in lines)]


def _left_sides(lines: Sequence[str]) -> list[str]:
    return [line.strip().partition(" = ")[0] for line in lines]


def _points(system: ReversibleSystem) -> list[str]:
    """What x is, where a system of somebody's own has a coordinate or a parameter of that name."""
    if system.name in BRANCH_SYSTEMS or "x" not in (*system.state, *system.parameters):
        return []
    return [
        "In what follows x is a point of the section where it is called one or P, T or Sigma is taken of it, and "
        "elsewhere what is called x above."
    ]


def _image(system: ReversibleSystem, signs: Sequence[int]) -> str:
    return ", ".join(name if sign > 0 else f"-{name}" for name, sign in zip(system.state, signs, strict=True))
