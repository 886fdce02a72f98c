"""Values as JSON and back, from their types alone: one description of what is written, read, and said in the schema.

A frozen dataclass is an object with a key for each field, but for a field that has its default. Tuples are arrays,
mappings are objects, exact numbers are strings (`numbers`). What a type is that is none of these is said once, with
`register`, and how a field differs where it stands, with `stored`. What is read has to fit the schema already.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cache
from types import FunctionType, NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from orbitproof.shared.errors import InputError, short
from orbitproof.shared.numbers import NUMBER, RATIONAL, format_exact, format_rational, parse_exact
from orbitproof.shared.stored import Rational, Rules, ToldBy, Unread

Json = Any
Schema = dict[str, Any]
Definitions = dict[str, Schema]
T = TypeVar("T")


@dataclass(frozen=True)
class Form:
    """How values of one type stand in JSON.

    Attributes:
        encode: from a value to JSON.
        decode: back, from JSON that fits the schema; raises `InputError` that begins with the place, its second
            argument.
        schema: the JSON schema; what has a name goes into the definitions.
    """

    encode: Callable[[Any], Json]
    decode: Callable[[Json, str], Any]
    schema: Callable[[Definitions], Schema]


def to_json(value: object) -> Json:
    """The JSON of a value."""
    kind: Any = type(value)
    return form_of(kind).encode(value)


def from_json(kind: type[T], entry: Json, place: str) -> T:
    """The value of a type from JSON that fits its schema.

    Raises `InputError` that begins with `place` and the field; what a dataclass raises itself begins with the field.
    """
    form = form_of(cast(Any, kind))
    value: T = form.decode(entry, place)
    return value


def schema_of(kind: Any) -> tuple[Schema, Definitions]:
    """The JSON schema of a type, and the definitions that it refers to."""
    definitions: Definitions = {}
    return form_of(kind).schema(definitions), definitions


_registered: dict[Any, Form] = {}


def register(kind: Any, encode: Callable[[Any], Json], decode: Callable[[Json], Any], like: Any) -> None:
    """Say how a type stands in JSON; `decode` raises `ValueError` for what is none.

    `like`: a schema, or another type that stands in JSON in the same way.
    """
    form = _leaf(encode, decode, like)
    _registered[kind] = form if isinstance(like, dict) else replace(form, schema=form_of(like).schema)


def _leaf(encode: Callable[[Any], Json], decode: Callable[[Json], Any], schema: Schema, name: str = "") -> Form:
    def placed(entry: Json, place: str) -> Any:
        try:
            return decode(entry)
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(f"{place}: {short(str(error))}; write the file again") from None

    return Form(encode, placed, lambda definitions: _named(name, schema, definitions))


def _named(name: str, schema: Schema, definitions: Definitions) -> Schema:
    if not name:
        return schema
    if definitions.setdefault(name, schema) != schema:
        raise TypeError(f"two types are called {name!r}")
    return {"$ref": f"#/$defs/{name}"}


def _itself(value: Any) -> Any:
    return value


_LEAVES: dict[Any, Form] = {
    Rational: _leaf(format_rational, parse_exact, {"type": "string", "pattern": f"^({RATIONAL})$"}, "rational"),
    Fraction: _leaf(format_exact, parse_exact, {"type": "string", "pattern": f"^({NUMBER})$"}, "number"),
    Any: _leaf(_itself, _itself, {}),
    **{
        kind: _leaf(_itself, _itself, {"type": name})
        for kind, name in ((bool, "boolean"), (int, "integer"), (float, "number"), (str, "string"))
    },
}


@cache
def form_of(kind: Any) -> Form:
    """How values of a type stand in JSON. Raises `TypeError` for a type that nothing is said of."""
    known = _registered.get(kind) or _LEAVES.get(kind)
    if known is not None:
        return known
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is Annotated:
        form = form_of(arguments[0])
        for said in arguments[1:]:
            form = replace(form, schema=_with(form.schema, said))
        return form
    if origin is Literal:
        return _leaf(_itself, _itself, {"enum": list(arguments)})
    if isinstance(kind, type) and issubclass(kind, Enum):
        return _leaf(lambda value: value.value, kind, {"enum": [choice.value for choice in kind]})
    if origin in (Union, UnionType):
        return _union(arguments)
    if origin is tuple:
        return _array(arguments)
    if origin is not None and issubclass(origin, Mapping):
        return _object(*map(form_of, arguments))
    if isinstance(kind, type) and is_dataclass(kind):
        return Form(
            lambda value: dict(_entries(kind, value)),
            lambda entry, place: _read(kind, entry, place),
            lambda definitions: _record_schema(kind, definitions),
        )
    raise TypeError(f"{kind!r} has no form in JSON")


def _with(schema: Callable[[Definitions], Schema], said: Rules | ToldBy | Unread) -> Callable[[Definitions], Schema]:
    """A schema with what an annotation says."""
    if isinstance(said, Unread):
        given = said.kind
        return lambda definitions: form_of(given() if isinstance(given, FunctionType) else given).schema(definitions)
    if isinstance(said, ToldBy):
        return lambda definitions: _union_schema(schema(definitions)["anyOf"], definitions, said.path)
    return lambda definitions: _named(said.name, schema(definitions) | dict(said.keywords), definitions)


def _union(kinds: tuple[Any, ...]) -> Form:
    """A type or nothing; one of dataclasses that say which of them it is, in their ``kind`` or by a ``stored_key``."""
    others = tuple(kind for kind in kinds if kind is not NoneType)
    if len(others) < len(kinds):
        inner = form_of(_one_of(others))
        return Form(
            lambda value: None if value is None else inner.encode(value),
            lambda entry, place: None if entry is None else inner.decode(entry, place),
            lambda definitions: {"anyOf": [*_alternatives(inner.schema(definitions)), {"type": "null"}]},
        )
    forms = [form_of(kind) for kind in others]
    by_kind = {name: form for kind, form in zip(others, forms, strict=True) for name in kinds_said(kind)}
    keyed = {kind.stored_key: form for kind, form in zip(others, forms, strict=True) if hasattr(kind, "stored_key")}
    if keyed:
        ((key, told),) = keyed.items()
        (other,) = (form for form in forms if form is not told)
        return Form(
            to_json,
            lambda entry, place: (told if key in entry else other).decode(entry, place),
            lambda definitions: {
                "if": {"required": [key]}, "then": told.schema(definitions), "else": other.schema(definitions)
            },
        )  # fmt: skip
    if not by_kind:
        return Form(to_json, _refuse, lambda definitions: {"anyOf": [form.schema(definitions) for form in forms]})
    return Form(
        to_json,
        lambda entry, place: by_kind[entry["kind"]].decode(entry, place),
        lambda definitions: _union_schema([form.schema(definitions) for form in forms], definitions, ("kind",)),
    )


def _alternatives(schema: Schema) -> list[Schema]:
    return schema["anyOf"] if schema.keys() == {"anyOf"} else [schema]


def _refuse(entry: Json, place: str) -> Any:
    raise TypeError(f"{place}: nothing says which of several types it is of")


def _one_of(kinds: tuple[Any, ...]) -> Any:
    return kinds[0] if len(kinds) == 1 else Union[kinds]  # noqa: UP007 (how many they are is not known before)


def _union_schema(found: list[Schema], definitions: Definitions, path: tuple[str, ...]) -> Schema:
    """By what stands at a path, so that an error is one of the type that it tells."""
    tags: list[Schema] = []
    for schema in found:
        tag = definitions[schema["$ref"].rpartition("/")[2]]
        for key in path:
            tag = tag["properties"][key]
        tags.append({key: tag[key] for key in ("enum", "const") if key in tag})
    whole: Schema = {"enum": [name for tag in tags for name in tag.get("enum", [tag.get("const")])]}
    for key in reversed(path):
        whole = {"type": "object", "required": [key], "properties": {key: whole}}
        tags = [{"type": "object", "required": [key], "properties": {key: tag}} for tag in tags]
    return {**whole, "allOf": [{"if": tag, "then": schema} for tag, schema in zip(tags, found, strict=True)]}


def _array(kinds: tuple[Any, ...]) -> Form:
    if kinds[1:] == (Ellipsis,):
        inner = form_of(kinds[0])
        return Form(
            lambda value: [inner.encode(item) for item in value],
            lambda entry, place: tuple(inner.decode(item, f"{place}[{index}]") for index, item in enumerate(entry)),
            lambda definitions: {"type": "array", "items": inner.schema(definitions)},
        )
    forms = [form_of(kind) for kind in kinds]
    size = len(forms)
    return Form(
        lambda value: [form.encode(item) for form, item in zip(forms, value, strict=True)],
        lambda entry, place: tuple(forms[index].decode(entry[index], f"{place}[{index}]") for index in range(size)),
        lambda definitions: {
            "type": "array",
            "prefixItems": [form.schema(definitions) for form in forms],
            "minItems": size,
            "maxItems": size,
        },
    )


def _object(names: Form, inner: Form) -> Form:
    return Form(
        lambda value: {name: inner.encode(item) for name, item in value.items()},
        lambda entry, place: {name: inner.decode(item, f"{place}.{name}") for name, item in entry.items()},
        lambda definitions: _object_schema(names.schema(definitions), inner.schema(definitions)),
    )


def _object_schema(names: Schema, inner: Schema) -> Schema:
    named = {} if names == {"type": "string"} else {"propertyNames": names}
    return {"type": "object", **named, **({"additionalProperties": inner} if inner else {})}


@dataclass(frozen=True)
class _Stored:
    """A field of a dataclass: what it holds, and how it is `stored`."""

    name: str
    kind: Any
    default: Any
    key: str
    always: bool
    flat: bool
    beside: tuple[str, str] | None

    def is_left_out(self, value: Any) -> bool:
        """Whether this value is not written. Balls are equal only if they certainly are."""
        return not self.always and type(value) is type(self.default) and bool(value == self.default)


@cache
def _stored_fields(kind: type) -> tuple[_Stored, ...]:
    hints = get_type_hints(kind, include_extras=True)
    found = []
    for each in fields(kind):
        default = each.default if each.default_factory is MISSING else each.default_factory()
        how = {"key": "", "always": False, "flat": False, "beside": None, "hidden": False, **each.metadata}
        if not how.pop("hidden"):
            how["key"] = how["key"] or each.name
            held = hints[each.name]
            if default is None and not how["always"]:
                # Nothing is never written.
                held = _one_of(tuple(kind for kind in get_args(held) if kind is not NoneType))
            found.append(_Stored(each.name, kind=held, default=default, **how))
    return tuple(found)


def _constant(kind: type) -> dict[str, str]:
    """What tells a dataclass from others of a union, if it is no field."""
    name = kind.__dict__.get("kind")
    return {"kind": name} if isinstance(name, str) and "kind" not in {each.name for each in fields(kind)} else {}


def kinds_said(kind: Any) -> tuple[str, ...]:
    """What entries of a dataclass say as their ``kind``: its constant, or the values of that field."""
    if not is_dataclass(kind):
        return ()
    constant = _constant(cast(type, kind))
    return (constant["kind"],) if constant else get_args(get_type_hints(kind).get("kind"))


def _entries(kind: type, value: Any) -> Iterator[tuple[str, Json]]:
    yield from _constant(kind).items()
    for each in _stored_fields(kind):
        held = getattr(value, each.name)
        if each.flat:
            yield from form_of(each.kind).encode(held).items()
        elif not each.is_left_out(held):
            yield from [each.beside] if each.beside else []
            yield each.key, form_of(each.kind).encode(held)


def _read(kind: type, entry: Mapping[str, Json], place: str) -> Any:
    given: dict[str, Any] = {}
    for each in _stored_fields(kind):
        if each.flat:
            given[each.name] = form_of(each.kind).decode(entry, place)
        elif each.key in entry or each.default is MISSING:
            given[each.name] = form_of(each.kind).decode(entry[each.key], f"{place}.{each.key}")
    try:
        return kind(**given)
    except InputError as error:
        # A value knows its own fields, and not where it stands.
        raise InputError(f"{place}.{error}") from None


def _record_schema(kind: type, definitions: Definitions) -> Schema:
    words, properties = _described(kind), {key: {"const": value} for key, value in _constant(kind).items()}
    required = list(properties)
    for each in _stored_fields(kind):
        found = form_of(each.kind).schema(definitions)
        if each.flat:
            inner = definitions[found["$ref"].rpartition("/")[2]]
            properties |= inner["properties"]
            required += inner["required"]
            continue
        properties[each.key] = found | ({"description": words[each.name]} if each.name in words else {})
        properties |= {each.beside[0]: {"const": each.beside[1]}} if each.beside else {}
        required += [each.key] if each.default is MISSING else []
    more = getattr(kind, "stored_rules", {})
    more = more(definitions) if callable(more) else more
    closed = {"type": "object", "additionalProperties": False, **more}
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", kind.__name__).lower()
    return _named(name, {**closed, "required": required, "properties": properties}, definitions)


def _described(kind: type) -> dict[str, str]:
    """What the docstrings say of each attribute."""
    found: dict[str, str] = {}
    for each in reversed(kind.__mro__):
        _, _, listed = (each.__doc__ or "").partition("Attributes:\n")
        for entry in re.split(r"\n        (?! )", "\n" + listed.partition("\n\n")[0].rstrip())[1:]:
            names, _, words = entry.partition(": ")
            found |= dict.fromkeys(names.split(", "), " ".join(words.split()))
    return found
