"""What fits a schema, as it is decided quickly, is nothing with which jsonschema finds something wrong."""

from __future__ import annotations

import copy
import json
import math
import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from orbitproof.shared.formats import documents
from orbitproof.shared.formats.documents import validator

ROOT = Path(__file__).parents[2]
NAMES = sorted(path.name.partition(".")[0] for path in (ROOT / "shared" / "schemas").glob("*.schema.json"))
FILES = sorted([*(ROOT / "tests" / "data").glob("*.json"), *(ROOT / "docs").glob("*/*.json")])

LONG = "0" * 101
SCALARS = (None, True, False, 0, 1, -1, 2, 7, 1.0, 0.0, 7.0, 0.5, math.nan, math.inf, Fraction(1), Fraction(1, 2))
TEXTS = ("", "a", "ab", "b\n", "a\n", "1", "0x1", "0x1\n", "proved", "x. It is so", LONG)
NESTED = (
    [],
    [1],
    ["a"],
    ["a", "a"],
    ["a", 1],
    [1, True],
    [None] * 9,
    {},
    {"a": 1},
    {"a": "a", "b": 1},
    {"b": [1]},
    {1: 2},
)
VALUES = (*SCALARS, *TEXTS, *NESTED)

SCHEMAS: tuple[dict[str, Any], ...] = (
    *({"type": kind} for kind in ("object", "array", "string", "integer", "number", "boolean", "null")),
    {"type": ["integer", "null"]},
    *({"const": value} for value in ("a", 1, 0, 1.0, True, False, None)),
    {"enum": ["a", 1, None]},
    {"enum": ["a", True]},
    {"enum": [0, False]},
    {"pattern": "^a$"},
    {"pattern": "^a(?![\\s\\S])"},
    {"pattern": "b"},
    {"minLength": 1, "maxLength": 2},
    {"minItems": 1},
    {"maxItems": 1},
    {"minimum": 0, "maximum": 1},
    {"exclusiveMinimum": 0},
    {"items": {"type": "integer"}},
    {"prefixItems": [{"type": "string"}], "items": {"type": "integer"}},
    {"prefixItems": [{"type": "string"}]},
    {"prefixItems": [{"type": "string"}], "items": False},
    {"items": {"type": "string"}, "uniqueItems": True},
    {"properties": {"a": {"type": "integer"}}},
    {"properties": {"a": {"type": "integer"}}, "additionalProperties": False},
    {"properties": {"a": True, "b": False}},
    {"additionalProperties": {"type": "integer"}},
    {"propertyNames": {"enum": ["a"]}},
    {"required": ["a", "b"]},
    {"dependentRequired": {"a": ["b"]}},
    {"anyOf": [{"type": "string"}, {"minimum": 1}]},
    {"oneOf": [{"type": "string"}, {"minLength": 2}]},
    {"oneOf": [{"required": ["a"]}, {"required": ["b"]}]},
    {"allOf": [{"type": "string"}, {"minLength": 2}, {"pattern": "0"}]},
    {"not": {"required": ["a"]}},
    {"if": {"type": "string"}, "then": {"minLength": 2}, "else": {"minimum": 1}},
    {"if": {"properties": {"a": {"const": 1}}, "required": ["a"]}, "then": {"required": ["b"]}},
    {"if": {"type": "string"}, "else": {"type": "array"}},
    {"$defs": {"text": {"type": "string"}}, "$ref": "#/$defs/text", "maxLength": 1},
)


def quick(schema: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> Callable[[object], bool]:
    """The quick check of a schema."""
    monkeypatch.setattr(documents, "_schema", lambda name: schema)
    documents._quick.cache_clear()
    return lambda value: documents.fits(value, "of the test")


@pytest.fixture(autouse=True)
def own_schemas() -> Iterator[None]:
    """No schema of a test is left to the next."""
    yield
    documents._quick.cache_clear()


def is_json(value: Any) -> bool:
    """Whether a value is one that a file can hold."""
    try:
        return bool(json.loads(json.dumps(value, allow_nan=False)) == value)
    except (TypeError, ValueError):
        return False


@pytest.mark.parametrize("schema", SCHEMAS, ids=json.dumps)
def test_each_keyword_is_read_as_jsonschema_reads_it(schema: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    checker = type(validator("web"))(schema)
    fits = quick(schema, monkeypatch)
    for value in VALUES:
        if is_json(value):
            # The one difference: in Python $ is also before a newline at the end.
            assert fits(value) is (checker.is_valid(value) and not (schema == {"pattern": "^a$"} and value == "a\n"))


def test_what_cannot_be_read_does_not_fit_quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    deep: list[Any] = []
    for _ in range(3000):
        deep = [deep]
    letters = {"pattern": r"^[^\n\ud800-\udfff]*(?![\s\S])"}
    fits = quick({"items": letters, "propertyNames": letters}, monkeypatch)
    for value in (["\ud800"], ["a", "b\ud800"], {"\ud800": 1}, {1: 2}, Fraction(1)):
        assert not fits(value)
    assert fits(["a"])
    assert fits({"a": 1})
    fits = quick({"type": ["number", "string", "null"], "minimum": 0}, monkeypatch)
    for value in (deep, math.nan, math.inf):
        assert not fits(value)
    assert all(map(fits, (1, 0.5, "a", None)))


def test_the_keywords_of_our_schemas_stand_in_a_test() -> None:
    def keywords(part: Any) -> Iterator[str]:
        if isinstance(part, dict):
            for key, inner in part.items():
                yield key
                named = key in ("properties", "$defs", "dependentRequired")
                for each in inner.values() if named else inner if isinstance(inner, list) else [inner]:
                    yield from keywords(each)

    words = {"$schema", "$id", "title", "description"}
    used = {word for name in NAMES for word in keywords(documents._schema(name))}
    assert used - words <= {word for schema in SCHEMAS for word in keywords(schema)}


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in entries:
        yield value, key
        yield from _places(inner)


def _changed(document: dict[str, Any], chance: random.Random) -> dict[str, Any]:
    """A copy with something else, something more or something less at one place or two."""
    other = json.loads(json.dumps(document))
    for _ in range(chance.choice([1, 1, 2])):
        places = list(_places(other))
        holder, key = chance.choice(places)
        source, place = chance.choice(places)
        new = copy.deepcopy(chance.choice([chance.choice(VALUES), source[place]]))
        how = chance.randrange(4)
        if how == 0:
            del holder[key]
        elif how == 1 and isinstance(holder, list):
            holder.append(new)
        elif how == 1:
            holder[chance.choice([str(place), "more"])] = new
        else:
            holder[key] = new
    return other


def _entries(document: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Documents with few entries: of each kind and verdict one."""
    for key in ("candidates", "certificates"):
        if key in document:
            claims = [entry.get("statement", {}).get("candidate", entry) for entry in document[key]]
            kinds = {
                (claim["kind"], entry.get("verdict")): entry for claim, entry in zip(claims, document[key], strict=True)
            }
            yield from ({**document, key: [entry]} for entry in kinds.values())
            return
    yield document


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_documents_changed_at_random_fit_as_jsonschema_says(path: Path) -> None:
    whole, chance = json.loads(path.read_text(encoding="utf-8")), random.Random(path.name)
    name = str(whole.get("format")).removeprefix("orbitproof-") if isinstance(whole, dict) else ""
    if name not in NAMES:
        return
    checker = validator(name)
    answers = set()
    for document in _entries(whole):
        assert documents.fits(document, name)
        assert checker.is_valid(document)
        # As many as take about as long.
        for _ in range(4 + 30_000 // len(json.dumps(document))):
            other = _changed(document, chance)
            found = documents.fits(other, name)
            answers.add(found)
            assert not found or checker.is_valid(other)
            assert found or not is_json(other) or "\\n" in json.dumps(other) or not checker.is_valid(other)
    assert False in answers
