"""Values as JSON and back: what is written is read as the same, the schema is that of the type, and files have it."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from orbitproof.shared import InputError
from orbitproof.shared.codec import from_json, register, schema_of, to_json
from orbitproof.shared.formats.schemas import schema_text
from orbitproof.shared.stored import Rational, rules, stored

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs"))

import schemas


class Side(Enum):
    ABOVE = "above"
    BELOW = "below"


@dataclass(frozen=True)
class Line:
    """A line.

    Attributes:
        slope: its slope,
            exactly.
        kind: what it is.
    """

    slope: Rational
    kind: Literal["straight", "tangent"]


@dataclass(frozen=True)
class Circle:
    radius: Fraction

    kind = "circle"


@dataclass(frozen=True)
class Middle:
    point: tuple[Fraction, Fraction]
    size: int = 1


@dataclass(frozen=True)
class Drawing:
    shapes: tuple[Line | Circle, ...]
    values: Mapping[Annotated[str, rules("letter", pattern="^[a-z]$")], Fraction]
    middle: Middle = stored(flat=True)
    side: Side | None = None
    start: Fraction = stored("from", always=True, default=Fraction(0))
    note: str | None = stored(always=True, default=None)
    sign: Literal[1, -1] | None = stored(beside=("signed", "yes"), default=None)
    cache: tuple[int, ...] = stored(hidden=True, default=())


exact = st.builds(lambda m, e: Fraction(m) * Fraction(2) ** e, st.integers(-(10**9), 10**9), st.integers(-60, 60))
shapes = st.one_of(st.builds(Line, st.fractions(), st.sampled_from(["straight", "tangent"])), st.builds(Circle, exact))
drawings = st.builds(
    Drawing,
    st.lists(shapes, max_size=3).map(tuple),
    st.dictionaries(st.sampled_from("abc"), exact, max_size=2),
    st.builds(Middle, st.tuples(exact, exact), st.integers(0, 3)),
    st.one_of(st.none(), st.sampled_from(Side)),
    exact,
    st.one_of(st.none(), st.text(max_size=3)),
    st.sampled_from([None, 1, -1]),
)


@cache
def validator() -> Draft202012Validator:
    schema, definitions = schema_of(Drawing)
    return Draft202012Validator({**schema, "$defs": definitions})


@given(drawings)
def test_what_is_written_fits_the_schema_and_is_read_as_the_same(drawing: Drawing) -> None:
    entry = json.loads(json.dumps(to_json(drawing)))
    assert list(validator().iter_errors(entry)) == []
    assert from_json(Drawing, entry, "here") == drawing


DRAWING = Drawing(
    (Line(Fraction(1, 3), "tangent"), Circle(Fraction(1, 2))), {"a": Fraction(3)}, Middle((Fraction(1), Fraction(2)))
)


def test_a_value_is_written_as_its_type_says() -> None:
    assert to_json(DRAWING) == {
        "shapes": [{"slope": "1/3", "kind": "tangent"}, {"kind": "circle", "radius": "0x1p-1"}],
        "values": {"a": "0x3"},
        "point": ["0x1", "0x1p+1"],
        "from": "0x0",
        "note": None,
    }
    assert to_json(Drawing((), {}, DRAWING.middle, sign=-1))["signed"] == "yes"


@pytest.mark.parametrize(
    "change",
    [
        {"more": 1}, {"shapes": [{"kind": "square"}]}, {"shapes": [{"kind": "circle", "radius": 0.5}]},
        {"shapes": [{"kind": "circle", "radius": "1/3"}]}, {"shapes": [{"kind": "straight"}]}, {"side": "left"},
        {"values": {"A": "0x1"}}, {"point": ["0x1"]}, {"point": ["0x1", "0x1", "0x1"]}, {"size": "1"}, {"sign": 2},
        {"side": None}, {"cache": [1]}, {"from": None}, {"signed": "no"},
    ],
    ids=str,
)  # fmt: skip
def test_other_entries_do_not_fit_the_schema(change: dict[str, Any]) -> None:
    assert list(validator().iter_errors({**to_json(DRAWING), **change})) != []


@pytest.mark.parametrize("name", ["shapes", "values", "point"])
def test_what_has_no_default_has_to_be_there(name: str) -> None:
    entry = to_json(DRAWING)
    del entry[name]
    assert "required" in {error.validator for error in validator().iter_errors(entry)}


def test_an_error_names_the_field() -> None:
    entry = to_json(DRAWING)
    entry["shapes"][1]["radius"] = "0x1p"
    with pytest.raises(InputError, match=r"^here\.shapes\[1\]\.radius: '0x1p' is not an exact number"):
        from_json(Drawing, entry, "here")


def test_what_a_value_refuses_itself_begins_with_its_place() -> None:
    @dataclass(frozen=True)
    class Positive:
        value: Fraction

        def __post_init__(self) -> None:
            if self.value <= 0:
                raise InputError("value: not positive; give a positive number")

    with pytest.raises(InputError, match=r"^there\[3\]\.value: not positive"):
        from_json(Positive, {"value": "-1"}, "there[3]")


def test_a_docstring_describes_the_fields() -> None:
    _, definitions = schema_of(Line)
    properties = definitions["line"]["properties"]
    assert properties["slope"] == {"$ref": "#/$defs/rational", "description": "its slope, exactly."}
    assert properties["kind"]["description"] == "what it is."


def test_a_type_that_nothing_is_said_of_has_no_form() -> None:
    with pytest.raises(TypeError, match="no form in JSON"):
        to_json(object())


def test_what_a_type_is_can_be_said_once() -> None:
    class Colour:
        def __init__(self, name: str) -> None:
            self.name = name

    register(Colour, lambda colour: colour.name, Colour, {"type": "string"})
    assert to_json(Colour("red")) == "red"
    assert from_json(Colour, "blue", "here").name == "blue"


@pytest.mark.parametrize(("name", "schema"), schemas.schemas().items(), ids=schemas.schemas())
def test_the_files_of_schemas_are_those_of_the_types(name: str, schema: dict[str, Any]) -> None:
    stored = resources.files("orbitproof.shared").joinpath("schemas", f"{name}.schema.json").read_text("utf-8")
    assert stored == schema_text(schema), "write them again: python docs/schemas.py"
