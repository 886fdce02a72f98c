"""How the fields of a dataclass stand in JSON, said where they are declared; `codec` reads it."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Annotated, Any

Rational = Annotated[Fraction, "rational"]
"""An exact number that need be neither dyadic nor decimal, as parameters."""


@dataclass(frozen=True)
class Rules:
    """What a schema says of a type beside it; with a name it becomes a definition."""

    name: str
    keywords: tuple[tuple[str, Any], ...] = field(hash=False)


def rules(name: str = "", **keywords: Any) -> Rules:
    """For annotations: ``Annotated[str, rules("id", pattern=ID)]``."""
    return Rules(name, tuple(keywords.items()))


@dataclass(frozen=True)
class Unread:
    """JSON that stays as it is, and fits the schema of a type: ``Annotated[Any, Unread(Kind)]``.

    Attributes:
        kind: the type, or a function that gives it when the schema is written.
    """

    kind: Any


@dataclass(frozen=True)
class ToldBy:
    """Where an object says which of several types it has, as ``Annotated[A | B, ToldBy(("claim", "kind"))]``."""

    path: tuple[str, ...]


def stored(
    key: str = "",
    *,
    always: bool = False,
    flat: bool = False,
    hidden: bool = False,
    beside: tuple[str, str] | None = None,
    **more: Any,
) -> Any:
    """A field of a dataclass that is stored in another way.

    Args:
        key: its name in JSON, if it is not that of the field.
        always: written even where it has its default.
        flat: its own keys stand among those of the object.
        hidden: not stored; what is read has the default.
        beside: a key and a value that stand beside it where it is written.
        more: arguments of `dataclasses.field`.
    """
    how = {"key": key, "always": always, "flat": flat, "hidden": hidden, "beside": beside}
    return field(metadata=how, **more)
