"""Tables of derivatives as text, exactly: what a certificate carries to be checked again without integrating."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import count

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
    """The ball that a text of a table stands for. Raises `ValueError` for a text that `ball_to_text` does not write."""
    middle, separator, radius = text.partition(_SEPARATOR)
    if not separator:
        raise ValueError(f"{text[:40]!r} is not a ball")
    ball = ball_from_json({"mid": middle, "rad": radius})
    if ball_to_text(ball) != text:
        raise ValueError(f"{text[:40]!r} is not written as it should be")
    return ball


def table_to_json(table: DerivativeTable) -> dict[str, list[str]]:
    """All derivatives of a table, exactly. Raises `ValueError` if one is not finite."""
    indices = sorted(indices_up_to(len(next(iter(table.box))), MAX_ORDER))
    return {
        "box": [ball_to_text(table.box[index]) for index in indices],
        "centre": [ball_to_text(table.centre[index]) for index in indices],
    }


def table_from_json(entry: Mapping[str, Sequence[str]]) -> DerivativeTable:
    """The table that its JSON stands for. Raises `ValueError` that names the derivative that cannot be read."""
    return DerivativeTable(_part(entry, "box"), _part(entry, "centre"))


def _part(entry: Mapping[str, Sequence[str]], name: str) -> dict[MultiIndex, arb]:
    texts = entry[name]
    variables = next(number for number in count(1) if len(indices_up_to(number, MAX_ORDER)) >= len(texts))
    indices = sorted(indices_up_to(variables, MAX_ORDER))
    if len(texts) != len(indices):
        raise ValueError(f"{name}: {len(texts)} is no number of derivatives up to order {MAX_ORDER}")
    found = {}
    for index, text in zip(indices, texts, strict=True):
        try:
            found[index] = ball_from_text(text)
        except ValueError as error:
            raise ValueError(f"the derivative {index} of {name}: {error}") from None
    return found
