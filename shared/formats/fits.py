"""Whether a JSON value fits a schema, as one function made of it: it says what jsonschema says, quickly, and not why.

A schema with a keyword that is none of these, or in a form that none of ours has, is refused when the function is made.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from numbers import Number
from typing import Any

Test = Callable[[Any], bool]
Schema = Mapping[str, Any] | bool
Inner = Callable[[Schema], Test]


def compiled(schema: Mapping[str, Any]) -> Test:
    """The function of a schema without loops. What several places of it share is made once."""
    known: dict[int, Test] = {}

    def inner(part: Schema) -> Test:
        if id(part) not in known:
            known[id(part)] = _all([] if part is True else [_none] if part is False else _tests(part))
        return known[id(part)]

    def _tests(part: Mapping[str, Any]) -> list[Test]:
        if part.keys() - _RULES.keys() - _SILENT - {"$ref"}:
            raise NotImplementedError(f"a keyword of the schema with the keys {', '.join(part)}")
        rules = dict.fromkeys(_RULES[key] for key in part if key in _RULES)
        referred = [inner(definitions[part["$ref"].removeprefix("#/$defs/")])] if "$ref" in part else []
        return [*(rule(part, inner) for rule in rules), *referred]

    definitions = schema.get("$defs", {})
    return inner(schema)


def _all(tests: list[Test]) -> Test:
    if not tests:
        return lambda value: True
    first, *others = tests
    if not others:
        return first
    if len(others) == 1:
        second = others[0]
        return lambda value: first(value) and second(value)

    def fits(value: Any) -> bool:
        for test in tests:  # noqa: SIM110 (three times as fast as `all` of a generator)
            if not test(value):
                return False
        return True

    return fits


def _none(value: Any) -> bool:
    return False


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) or (isinstance(value, Number) and not isinstance(value, bool))


_TYPES: dict[str, Test] = {
    "object": lambda value: isinstance(value, dict),
    "array": lambda value: isinstance(value, list),
    "string": lambda value: isinstance(value, str),
    # 7.0 and true are none.
    "integer": lambda value: type(value) is int,
    "number": _is_number,
    "boolean": lambda value: isinstance(value, bool),
    "null": lambda value: value is None,
}


def _type(schema: Mapping[str, Any], inner: Inner) -> Test:
    wanted = schema["type"]
    return _TYPES[wanted] if isinstance(wanted, str) else _any([_TYPES[each] for each in wanted])


def _any(tests: list[Test]) -> Test:
    return lambda value: any(test(value) for test in tests)


def _any_of(schema: Mapping[str, Any], inner: Inner) -> Test:
    return _any([inner(part) for part in schema["anyOf"]])


def _one_of(schema: Mapping[str, Any], inner: Inner) -> Test:
    tests = [inner(part) for part in schema["oneOf"]]
    return lambda value: sum(test(value) for test in tests) == 1


def _all_of(schema: Mapping[str, Any], inner: Inner) -> Test:
    return _all([inner(part) for part in schema["allOf"]])


def _not(schema: Mapping[str, Any], inner: Inner) -> Test:
    refused = inner(schema["not"])
    return lambda value: not refused(value)


def _if(schema: Mapping[str, Any], inner: Inner) -> Test:
    condition, then, other = (inner(schema.get(key, True)) for key in ("if", "then", "else"))
    return lambda value: then(value) if condition(value) else other(value)


def _choice(schema: Mapping[str, Any], inner: Inner) -> Test:
    """1.0 is 1, and true is neither."""
    choices = schema["enum"] if "enum" in schema else [schema["const"]]
    if any(isinstance(choice, (dict, list)) for choice in choices) or {"enum", "const"} <= schema.keys():
        raise NotImplementedError("choices that are no scalars, or two lists of them")
    texts = frozenset(choice for choice in choices if isinstance(choice, str))
    others = [choice for choice in choices if not isinstance(choice, str)]

    def fits(value: Any) -> bool:
        if isinstance(value, str):
            return value in texts
        return any(
            value is choice or (value == choice and not isinstance(value, bool) and not isinstance(choice, bool))
            for choice in others
        )

    return fits


def _pattern(schema: Mapping[str, Any], inner: Inner) -> Test:
    search = re.compile(schema["pattern"]).search
    return lambda value: search(value) is not None if isinstance(value, str) else True


def _size(least: str, most: str, kind: type[str] | type[list[Any]]) -> Callable[[Mapping[str, Any], Inner], Test]:
    def rule(schema: Mapping[str, Any], inner: Inner) -> Test:
        low, high = schema.get(least, 0), schema.get(most, float("inf"))
        return lambda value: low <= len(value) <= high if isinstance(value, kind) else True

    return rule


_length, _entries = _size("minLength", "maxLength", str), _size("minItems", "maxItems", list)


def _bounds(schema: Mapping[str, Any], inner: Inner) -> Test:
    """NaN is beyond no bound."""
    infinity = float("inf")
    low, high = schema.get("minimum", -infinity), schema.get("maximum", infinity)
    above = schema.get("exclusiveMinimum")

    def fits(value: Any) -> bool:
        if not _is_number(value):
            return True
        return not (value < low or value > high or (above is not None and value <= above))

    return fits


def _items(schema: Mapping[str, Any], inner: Inner) -> Test:
    first, others = [inner(part) for part in schema.get("prefixItems", ())], inner(schema.get("items", True))
    size = len(first)

    def fits(value: Any) -> bool:
        if not isinstance(value, list):
            return True
        for index, entry in enumerate(value):  # noqa: SIM110
            if not (first[index] if index < size else others)(entry):
                return False
        return True

    return fits


def _unique(schema: Mapping[str, Any], inner: Inner) -> Test:
    if schema["uniqueItems"] is not True or schema["items"] != {"type": "string"}:
        raise NotImplementedError("only texts are told to be unique")
    # Others are refused anyway.
    return lambda value: not isinstance(value, list) or len({each for each in value if type(each) is str}) == len(value)


def _members(schema: Mapping[str, Any], inner: Inner) -> Test:
    tests = {key: inner(part) for key, part in schema.get("properties", {}).items()}
    other = inner(schema.get("additionalProperties", True))

    def fits(value: Any) -> bool:
        if not isinstance(value, dict):
            return True
        for key, entry in value.items():  # noqa: SIM110
            if not tests.get(key, other)(entry):
                return False
        return True

    return fits


def _names(schema: Mapping[str, Any], inner: Inner) -> Test:
    test = inner(schema["propertyNames"])
    return lambda value: all(map(test, value)) if isinstance(value, dict) else True


def _required(schema: Mapping[str, Any], inner: Inner) -> Test:
    needed = frozenset(schema["required"])
    return lambda value: needed <= value.keys() if isinstance(value, dict) else True


def _dependent(schema: Mapping[str, Any], inner: Inner) -> Test:
    needed = {key: frozenset(others) for key, others in schema["dependentRequired"].items()}
    return lambda value: (
        all(others <= value.keys() for key, others in needed.items() if key in value)
        if isinstance(value, dict)
        else True
    )


_SILENT = frozenset({"$schema", "$id", "$defs", "title", "description"})
_RULES: dict[str, Callable[[Mapping[str, Any], Inner], Test]] = {
    "type": _type,
    "anyOf": _any_of,
    "oneOf": _one_of,
    "allOf": _all_of,
    "not": _not,
    "if": _if,
    "then": _if,
    "else": _if,
    "enum": _choice,
    "const": _choice,
    "pattern": _pattern,
    "minLength": _length,
    "maxLength": _length,
    "minItems": _entries,
    "maxItems": _entries,
    "minimum": _bounds,
    "maximum": _bounds,
    "exclusiveMinimum": _bounds,
    "items": _items,
    "prefixItems": _items,
    "uniqueItems": _unique,
    "properties": _members,
    "additionalProperties": _members,
    "propertyNames": _names,
    "required": _required,
    "dependentRequired": _dependent,
}
