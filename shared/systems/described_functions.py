"""Functions of state and parameters, from formulas, programs or Python functions, as descriptions give them."""

from __future__ import annotations

import keyword
import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.formulas import FormulaError, evaluate_formula, remedy_for
from orbitproof.shared.systems.names import IDENTIFIER, fits
from orbitproof.shared.systems.program import Program, Variable, record
from orbitproof.shared.systems.program_text import program_from_text
from orbitproof.shared.wording import counted


class DescriptionError(ValueError):
    """What is wrong with a description, in one line that begins with the key and ends with the remedy."""


def mapping_of(key: str, value: Any) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise DescriptionError(f"{key}: {value!r} is no table; give a value for each name")
    return value


def name_of(key: str, value: Any) -> str:
    if not isinstance(value, str) or not fits(IDENTIFIER, value) or keyword.iskeyword(value):
        raise DescriptionError(f"{key}: {value!r} is no name; use letters, digits and _, a letter first")
    # In the text of a program v0, v1, .. are its lines.
    if re.fullmatch(r"v[0-9]+", value) or value == "sqrt":
        raise DescriptionError(f"{key}: {value!r} is a name of formulas themselves; choose another one, such as u1")
    return value


def formula_value(key: str, text: str, known: Mapping[str, Any]) -> Any:
    try:
        return evaluate_formula(text, known)
    except FormulaError as error:
        raise DescriptionError(f"{key}: {error}") from None


Arithmetic = Callable[[Sequence[Any], Sequence[Any]], Sequence[Any]]


class DescribedFunctions:
    """Functions of state and parameters from formulas, programs or Python functions."""

    def __init__(self, state: tuple[str, ...], parameters: tuple[str, ...], where: Any) -> None:
        self.state = state
        self.inputs = (*state, *parameters)
        self.where: dict[str, str] = {}
        for name, text in mapping_of("where", where).items():
            if name_of("where", name) in self.inputs or not isinstance(text, str):
                raise DescriptionError(f"where.{name}: is a coordinate or no formula; give text under a new name")
            self.where[name] = text

    def function(self, key: str, value: Any, names: tuple[str, ...] | None) -> Arithmetic:
        """The function: of as many values as `names`, or of one if that is `None`."""
        return program_function(self._program(key, value, names), len(self.state))

    def _program(self, key: str, value: Any, names: tuple[str, ...] | None) -> Program:
        count = 1 if names is None else len(names)
        if isinstance(value, str) and value.lstrip().startswith("v0 ="):
            try:
                program = program_from_text(value)
            except ValueError as error:
                raise DescriptionError(f"{key}: {error}; write a formula for each coordinate") from None
            if program.inputs != self.inputs or len(program.outputs) != count:
                raise DescriptionError(
                    f"{key}: needs the inputs {', '.join(self.inputs)} and gives {counted(count, 'value')}"
                )
            return program
        if names is None and isinstance(value, str):
            return self._formulas({key: value})
        if isinstance(value, Mapping) and names is not None:
            if set(value) != set(names) or not all(isinstance(text, str) for text in value.values()):
                raise DescriptionError(f"{key}: needs a formula, as text, for each of {', '.join(names)}")
            return self._formulas({f"{key}.{name}": value[name] for name in names})
        if not callable(value):
            raise DescriptionError(f"{key}: {type(value).__name__} is no formula; give text")

        def called(inputs: Sequence[Any]) -> Sequence[Any]:
            result = value(*inputs)
            return result if isinstance(result, (list, tuple)) else (result,)

        try:
            program = record(called, self.inputs)
        except DescriptionError:
            raise
        except Exception as error:
            raise DescriptionError(f"{key}: {type(error).__name__}: {error}; {self._remedy(error)}") from None
        if len(program.outputs) != count:
            raise DescriptionError(f"{key}: gives {counted(len(program.outputs), 'value')}; give {count}")
        return program

    def _remedy(self, error: Exception) -> str:
        name = error.name if isinstance(error, NameError) and error.name else ""
        known = ", ".join(self.inputs)
        if name in ("t", "time", "pi"):
            return remedy_for(name, known)
        remedy = f"give a function of {known} in plain arithmetic with exact constants"
        if name or isinstance(error, TypeError):
            remedy += "; sqrt, sin, cos, exp and log are for formulas as text (docs/how-to/sin-and-exp.md)"
        return remedy

    def _formulas(self, texts: Mapping[str, str]) -> Program:
        def values(inputs: Sequence[Any]) -> Sequence[Any]:
            known: dict[str, Any] = dict(zip(self.inputs, inputs, strict=True))
            for name, text in self.where.items():
                known[name] = formula_value(f"where.{name}", text, known)
            return [formula_value(key, text, known) for key, text in texts.items()]

        return record(values, self.inputs)


def program_function(program: Program, size: int) -> Arithmetic:
    """The program as plain arithmetic on (state, parameters), as `ReversibleSystem` takes it.

    Arguments:
        size: number of state coordinates, the first inputs.
    """

    def function(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        if len(state) != size:
            raise ValueError(f"the program takes {size} state coordinates")
        arguments = [*state, *parameters]
        recorder = next((each.recorder for each in arguments if isinstance(each, Variable)), None)
        # A constant is recorded as such, so that arithmetic with constants alone is an operation like any other.
        return program.evaluate(arguments, Fraction if recorder is None else recorder.lift, pow)

    return function
