"""Tables of derivatives as text, exactly: what a certificate carries to be checked again without integrating."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import arb

from orbitproof.shared.numbers import format_dyadic
from orbitproof.verify.evidence import (
    MAX_ORDER,
    DerivativeTable,
    MultiIndex,
    ball_from_json,
    exact_value,
    indices_up_to,
)

_SEPARATOR = " +- "


def ball_to_text(ball: arb) -> str:
    """A finite ball as ``MID +- RAD``, both exact dyadic numbers. Raises `ValueError` for others."""
    if not ball.is_finite():
        raise ValueError("the ball is not finite")
    return _SEPARATOR.join(format_dyadic(exact_value(part)) for part in (ball.mid(), ball.rad()))


def ball_from_text(text: str) -> arb:
    """The same ball. Raises `ValueError` for a text that `ball_to_text` does not write."""
    middle, separator, radius = text.partition(_SEPARATOR)
    if not separator:
        raise ValueError(f"{text[:40]!r} is not a ball")
    ball = ball_from_json({"mid": middle, "rad": radius})
    if ball_to_text(ball) != text:
        raise ValueError(f"{text[:40]!r} is not written as it should be")
    return ball


def tables_of_iterates(iterates: Sequence[Sequence[DerivativeTable]]) -> list[list[dict[str, list[str]]]]:
    """The tables of P, P^2, .."""
    return [[table_to_json(table) for table in components] for components in iterates]


def read_iterates(entry: Sequence[Any], dimension: int) -> tuple[tuple[DerivativeTable, ...], ...]:
    """The same tables. Raises `ValueError` that names the table and the derivative that cannot be read."""
    return tuple(
        tuple(read_table(table, dimension, f"q_{j}(P^{i})") for j, table in enumerate(components, start=1))
        for i, components in enumerate(entry, start=1)
    )


def table_to_json(table: DerivativeTable) -> dict[str, list[str]]:
    """All derivatives of a table, exactly. Raises `ValueError` if one is not finite."""
    indices = sorted(indices_up_to(len(next(iter(table.box))), MAX_ORDER))
    return {
        "box": [ball_to_text(table.box[index]) for index in indices],
        "centre": [ball_to_text(table.centre[index]) for index in indices],
    }


def read_table(entry: Mapping[str, Sequence[str]], dimension: int, name: str) -> DerivativeTable:
    """The same table. Raises `ValueError` that names the derivative that cannot be read."""
    indices = sorted(indices_up_to(dimension, MAX_ORDER))
    parts: list[dict[MultiIndex, arb]] = []
    for part in ("box", "centre"):
        texts = entry[part]
        if len(texts) != len(indices):
            raise ValueError(f"{name}, {part}: {len(texts)} derivatives up to order {MAX_ORDER}, not {len(indices)}")
        parts.append(
            {index: read_ball(text, f"{derivative_name(index)} of {name}, {part}")
             for index, text in zip(indices, texts, strict=True)}
        )  # fmt: skip
    return DerivativeTable(*parts)


def derivative_name(index: MultiIndex) -> str:
    """A derivative for messages: d^(2,1,0) is taken twice in p_0 and once in p_1."""
    return f"d^({','.join(str(order) for order in index)})"


def read_ball(text: str, name: str) -> arb:
    """As `ball_from_text`; what is raised begins with the name."""
    try:
        return ball_from_text(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
