"""JSON documents: read, checked against their schema, and written whole or not at all.

Schemas stand beside this module in ``schemas/``; unknown keys, JSON floats where exact numbers
belong, NaN and infinities are refused. Errors are `InputError`, one line that names the file, the
field and the remedy.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import cache, partial
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from orbitproof.shared.errors import LONGEST_QUOTED, InputError, short
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.output import write_text
from orbitproof.shared.systems import (
    ID,
    ID_IN_WORDS,
    IDENTIFIER,
    LINE,
    MASS_PARAMETERS,
    PIECE,
    PIECE_IN_WORDS,
    SYSTEM,
    TITLE,
)

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import ValidationError
    from jsonschema_rs import Draft202012Validator as QuickValidator


@cache
def validator(name: str) -> Draft202012Validator:
    """What checks a document against the schema `name`. An integer is written as one: 7.0 and true are none."""
    # Imported late: it takes most of the time of a command that reads nothing.
    from jsonschema import Draft202012Validator
    from jsonschema.validators import extend

    checker = Draft202012Validator.TYPE_CHECKER.redefine("integer", lambda _, value: type(value) is int)
    strict: type[Draft202012Validator] = extend(Draft202012Validator, {"anyOf": _any_of}, type_checker=checker)
    schema = _schema(name)
    return strict(_with_definitions(schema, schema.get("$defs", {})))


_SCHEMAS = Path(__file__).parents[1] / "schemas"


def _schema(name: str) -> Any:
    return json.loads((_SCHEMAS / f"{name}.schema.json").read_text("utf-8"))


_SURROGATES = "\\ud800-\\udfff"
"""As patterns name them; texts with one of them are none that the quick check reads."""
_MANY = re.compile(r"\{1,(\d{4,})\}")
"""How patterns say that there are one or more, up to a thousand or more."""


class _WrittenWhole:
    """A keyword of the quick check beside the type integer, of which 7.0 is one otherwise."""

    def __init__(self, _parent: object, _value: object, _path: object) -> None:
        pass

    def validate(self, instance: object) -> None:
        """Raises `ValueError` for what is no integer of a file."""
        if isinstance(instance, float):
            raise ValueError("no integer")


def _for_quick_check(part: Any) -> Any:
    if isinstance(part, list):
        return [_for_quick_check(entry) for entry in part]
    if isinstance(part, str):
        return part.replace(_SURROGATES, "")
    if not isinstance(part, dict):
        return part
    pattern = part.get("pattern")
    if isinstance(pattern, str) and (most := [int(digits) for digits in _MANY.findall(pattern)]):
        # To count so far takes milliseconds to prepare; texts that are shorter as a whole need not be counted.
        part = {**part, "pattern": _MANY.sub("+", pattern), "maxLength": min(*most, part.get("maxLength", most[0]))}
    types = part.get("type")
    whole = {"writtenWhole": True} if types == "integer" or (isinstance(types, list) and "integer" in types) else {}
    return {key: _for_quick_check(entry) for key, entry in part.items()} | whole


@cache
def _quick(name: str) -> QuickValidator:
    from jsonschema_rs import Draft202012Validator

    return Draft202012Validator(_for_quick_check(_schema(name)), keywords={"writtenWhole": _WrittenWhole})


def fits(document: object, name: str) -> bool:
    """Whether a document fits the schema `name`, told quickly. Where this is `False`, `validator` decides."""
    try:
        return _quick(name).is_valid(document)
    except ValueError:
        # Deeper than it reads, or with what no JSON text holds.
        return False


def _with_definitions(part: Any, definitions: Mapping[str, Any]) -> Any:
    """A part of a schema with definitions in place of references, which are otherwise looked up for each value."""
    if isinstance(part, list):
        return [_with_definitions(entry, definitions) for entry in part]
    if not isinstance(part, dict):
        return part
    if "$ref" in part and part.keys() <= {"$ref", "description"}:
        return definitions[part["$ref"].removeprefix("#/$defs/")]
    for key, entry in part.items():
        part[key] = _with_definitions(entry, definitions)
    return part


_MOST_ERRORS = 100
"""That are looked at: there may be one for each character of a file."""


def _any_of(checker: Any, alternatives: Any, instance: Any, schema: Any) -> Iterator[ValidationError]:
    """The keyword, with the first errors of the alternative that fits best, or of each."""
    from jsonschema.exceptions import ValidationError

    found: list[list[ValidationError]] = []
    for index, alternative in enumerate(alternatives):
        found.append(list(islice(checker.descend(instance, alternative, schema_path=index), _MOST_ERRORS)))
        if not found[-1]:
            return
    # First those with the keys that they need and no others, so that something inside is wrong; then the fewest errors.
    fits = [(min(len(error.relative_path) for error in errors), -len(errors)) for errors in found]
    if fits.count(max(fits)) == 1:
        yield from found[fits.index(max(fits))]
    else:
        yield ValidationError("no alternative fits", context=[error for errors in found for error in errors])


def _refuse_constant(text: str) -> NoReturn:
    raise ValueError(f"{text} is not allowed")


def _finite(text: str, number: Callable[[str], float]) -> float:
    value = number(text)
    if not isfinite(value):
        raise ValueError(f"{short(text)} is too large")
    return value


def _unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for key, value in pairs:
        if key in result:
            raise ValueError(f"key {key!r} appears twice")
        result[key] = value
    return result


_MOST_BYTES = 2**28
"""Bytes of a file: a hundred times as many as any of ours has."""


def _text_of(path: Path, remedy: str) -> str:
    """The text of a file. Raises `InputError` with the `remedy`."""
    try:
        with path.open("rb") as stream:
            content = stream.read(_MOST_BYTES + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); {remedy}") from None
    if len(content) > _MOST_BYTES:
        raise InputError(f"{path}: has more than {_MOST_BYTES // 2**20} MiB; split it")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file; {remedy} (JSON, UTF-8)") from None


def stated_format(path: Path, remedy: str) -> str:
    """The file's format as it says itself, "" where it does not; whoever reads it in full reports what is wrong.

    Raises `InputError`, with the `remedy`, where it cannot be read.
    """
    text = _text_of(path, remedy).removeprefix("\ufeff")
    try:
        document = json.loads(text) if text.lstrip().startswith("{") else {}
    except (ValueError, RecursionError):
        return ""
    return str(document.get("format", "")).removeprefix("orbitproof-")


def read_document(path: Path, name: str, number: Callable[[str], float] = float) -> dict[str, Any]:
    """Read and validate a JSON document against the schema `name` ("candidates", "certificates").

    `number` reads what is written with a point or an exponent.

    Raises `InputError` if the file cannot be read, is not JSON, or does not fit the schema.
    """
    article = "an" if name[0] in "aeiou" else "a"
    text = _text_of(path, f"give the path of {article} {name} file")
    if _long_numbers(text) > _MOST_BITS:
        raise InputError(f"{path}: its numbers are too long for this memory; write smaller exponents")
    try:
        document = json.loads(
            text,
            parse_constant=_refuse_constant,
            parse_float=partial(_finite, number=number),
            object_pairs_hook=_unique_keys,
        )
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}: not valid JSON at line {error.lineno}, column {error.colno} ({error.msg}); "
            "the file may be truncated: write it again"
        ) from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: {error}; write numbers as exact strings and every key once") from None
    if _is_deep(document):
        raise InputError(f"{path}: lists and objects are nested more than {_MOST_NESTED} deep; write it again")
    _refuse_other_format(document, name, path)
    validate_document(document, name, str(path))
    return document  # type: ignore[no-any-return]


_MOST_BITS = 2**33
"""What the numbers of a document take together, if each is written out: a gibibyte."""
_LONG = re.compile(r"(?:p|e)[+-]?([0-9]{4,6})(?=[\"\s])")
_ESCAPED = re.compile(r"\\u00([2-7][0-9a-fA-F])")
"""How JSON may write a letter or a digit too."""


def _long_numbers(text: str) -> int:
    """A bound of the bits of all exact numbers in a text whose exponents have four digits or more."""
    plain = _ESCAPED.sub(lambda found: chr(int(found[1], 16)), text)
    return sum(4 * int(digits) for digits in _LONG.findall(plain))


_MOST_NESTED = 100
"""Deeper documents than any of ours exhaust the stack of what writes, compares and sends them."""


def _is_deep(document: Any) -> bool:
    level = [document] if isinstance(document, (dict, list)) else []
    for _ in range(_MOST_NESTED):
        level = [
            inner
            for container in level
            for inner in (container.values() if isinstance(container, dict) else container)
            if isinstance(inner, (dict, list))
        ]
        if not level:
            return False
    return True


_FORMATS = {
    "candidates": "candidates, to prove with: orbitproof verify {}",
    "certificates": "certificates, to check again with: orbitproof verify --recheck {}",
    "atlas": "an atlas, to prove with: orbitproof verify atlas {}",
    "atlas-certificate": "the certificate of an atlas, to check again with: orbitproof verify atlas --recheck {}",
    "web": "a web, to prove with: orbitproof verify web {}",
    "web-certificate": "the certificate of a web, to check again with: orbitproof verify web --recheck {}",
    "life": "a life in double precision, to draw with: orbitproof figures periodic {}",
    "life-claim": "the claim of a life, to prove with: orbitproof verify life {}",
    "life-certificate": "the certificate of a life, to check again with: orbitproof verify life --recheck {}",
    "index-certificate": "the certificate of an index, to check again with: orbitproof verify index --recheck {}",
    "family": "families, to search with: orbitproof explore candidates --from-family {}",
    "branches": "branches",
    "portraits": "portraits",
    "mass-curve": "curves over the mass",
    "tori": "tori, to draw with: orbitproof figures tori {}",
    "manifold": "a manifold, to draw with: orbitproof figures tori {}",
    "published": "published values",
    "system": "a system, to search with: orbitproof explore family --system {}",
}
"""What a file of each format holds, and the command for it."""


def _refuse_other_format(document: object, name: str, path: Path) -> None:
    """Say what the file is if it is another one of ours."""
    found = str(document.get("format")).removeprefix("orbitproof-") if isinstance(document, dict) else ""
    if found != name and found in _FORMATS:
        wanted = _FORMATS.get(name, name).partition(",")[0]
        raise InputError(f"{path}: field format: needs {wanted}; the file holds {_FORMATS[found].format(path)}")


def validate_document(document: object, name: str, source: str) -> None:
    """Check a JSON value against the schema `name`; raises `InputError` that names the field and the rule.

    It is the best of the first ones.
    """
    if fits(document, name):
        return
    from jsonschema.exceptions import best_match

    error = best_match(islice(validator(name).iter_errors(document), _MOST_ERRORS))
    if error is not None:
        where = short(error.json_path.removeprefix("$").removeprefix(".")) or "the document"
        raise InputError(f"{source}: field {where}: {_broken_rule(error)}; see shared/schemas/{name}.schema.json")


_SIZES = {
    "minItems": "needs at least {} entries",
    "maxItems": "has room for {} entries",
    "minLength": "needs at least {} characters",
    "maxLength": "has room for {} characters",
    "minimum": "must be at least {}",
    "maximum": "must be at most {}",
    "exclusiveMinimum": "must be greater than {}",
}


_FORMS = {
    ID: f"is no id; {ID_IN_WORDS}",
    IDENTIFIER: "is no name; use letters, digits and _, a letter first",
    LINE: "is not one line of printable text",
    PIECE: f"is no id of a piece; {PIECE_IN_WORDS}",
    SYSTEM: "is no name of a system; use letters, digits, - and _, a letter first",
    TITLE: "is no title; give letters, digits and signs such as . , ' ( ) + - * / ^ =, and no sentences",
}
"""What texts of these patterns have to be, in words."""


def _broken_rule(error: ValidationError) -> str:
    """The rule in words. The value is quoted only if it is a short scalar: it may be a whole file."""
    rule = str(error.validator)
    wanted: Any = error.validator_value
    value: Any = error.instance
    schema: Any = error.schema
    if rule == "additionalProperties":
        unknown = sorted(str(key) for key in value if key not in schema.get("properties", {}))
        return f"unknown key {short(unknown[0])!r}" + (f" and {len(unknown) - 1} more" if unknown[1:] else "")
    if rule == "required":
        return f"key {next(key for key in wanted if key not in value)!r} is missing"
    if rule == "not" and "required" in wanted:
        return f"must not have the key {wanted['required'][0]!r}"
    if isinstance(value, str) and value in MASS_PARAMETERS:
        text = f"is the name of a mass parameter; write its value, {format_exact(MASS_PARAMETERS[value])}"
    elif rule == "pattern":
        text = _FORMS.get(wanted, f"must have the form {wanted}")
    elif rule in ("const", "enum"):
        text = "must be " + " or ".join(json.dumps(choice) for choice in ([wanted] if rule == "const" else wanted))
    elif rule == "type":
        text = "must be of type " + " or ".join([wanted] if isinstance(wanted, str) else wanted)
    else:
        text = _SIZES.get(rule, f"breaks the rule {rule!r}").format(wanted)
    scalar = not isinstance(value, (dict, list))
    return f"{json.dumps(value)} {text}" if scalar and len(str(value)) <= LONGEST_QUOTED else text


def write_document(path: Path, document: Mapping[str, Any], name: str) -> None:
    """Validate `document` against the schema `name` and write it atomically as JSON."""
    validate_document(document, name, f"{name} to be written")
    write_text(path, json.dumps(document, indent=1, allow_nan=False) + "\n")


_on_one_line = partial(json.dumps, allow_nan=False)


def json_text(
    value: Any,
    one_a_line: Collection[tuple[str, ...]] = (),
    line: Callable[[Any], str] = _on_one_line,
    path: tuple[str, ...] = (),
) -> str:
    """A document as text, with an entry a line of the arrays at these paths: a number a line is long and says nothing.

    Args:
        line: an entry of such an array on one line.
        path: of the value in its document.
    """
    outer = " " * len(path)
    if path in one_a_line and value:
        entries = ",\n".join(f"{outer} {line(entry)}" for entry in value)
        return f"[\n{entries}\n{outer}]"
    if isinstance(value, Mapping) and any(place[: len(path)] == path for place in one_a_line):
        members = (f"{json.dumps(key)}: {json_text(value[key], one_a_line, line, (*path, key))}" for key in value)
        return "{\n" + ",\n".join(f"{outer} {member}" for member in members) + f"\n{outer}}}"
    # No text in JSON holds a line break.
    return json.dumps(value, indent=1, allow_nan=False).replace("\n", f"\n{outer}")
