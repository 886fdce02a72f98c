"""Tables of derivatives as text, exactly: what a certificate carries to be checked again without integrating."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import arb

from orbitproof.shared.formats import ORBIT, Candidate
from orbitproof.shared.numbers import format_dyadic
from orbitproof.verify.evidence import (
    MAX_ORDER,
    DerivativeTable,
    MultiIndex,
    ball_from_json,
    exact_value,
    indices_up_to,
)
from orbitproof.verify.orbit import Approach, Distance, OrbitEnclosures
from orbitproof.verify.poincare import Enclosures

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


def tables_to_json(enclosures: Enclosures | OrbitEnclosures) -> dict[str, Any] | None:
    """All derivatives and times; `None` if a ball is not finite, which proves nothing anyway."""
    integral = enclosures.first_integral
    try:
        if isinstance(enclosures, OrbitEnclosures):
            return _orbit_to_json(enclosures)
        return {
            "iterates": [[_table_to_json(table) for table in components] for components in enclosures.iterates],
            "first_integral": None if integral is None else _table_to_json(integral),
            "return_times": [ball_to_text(time) for time in enclosures.return_times],
        }
    except (KeyError, ValueError):
        return None


def _orbit_to_json(found: OrbitEnclosures) -> dict[str, Any]:
    integral, distance = found.first_integral, found.distance
    return {
        "iterates": [[_table_to_json(table) for table in components] for components in found.iterates],
        "image": [_table_to_json(table) for table in found.image],
        "half_period": _table_to_json(found.half_period),
        "first_integral": None if integral is None else _table_to_json(integral),
        "back": [[ball_to_text(ball) for ball in row] for row in found.back],
        "distance": None
        if distance is None
        else {
            "start": _table_to_json(distance.start),
            "end": _table_to_json(distance.end),
            "start_kind": distance.start_kind,
            "end_kind": distance.end_kind,
            "between": [
                {"time": ball_to_text(each.time), "value": ball_to_text(each.value), "kind": each.kind}
                for each in distance.between
            ],
        },
    }


def _orbit_from_json(entry: Mapping[str, Any], dimension: int, computation: Mapping[str, Any]) -> OrbitEnclosures:
    integral, far = entry["first_integral"], entry["distance"]
    distance = None
    if far is not None:
        between = tuple(
            Approach(_read(each["time"], f"time of extremum {i}"), _read(each["value"], f"extremum {i}"), each["kind"])
            for i, each in enumerate(far["between"], start=1)
        )
        start, end = (_table_from_json(far[name], dimension, f"distance, {name}") for name in ("start", "end"))
        distance = Distance(start, end, far["start_kind"], far["end_kind"], between)
    return OrbitEnclosures(
        tuple(
            tuple(_table_from_json(table, dimension, f"q_{j}(P^{i})") for j, table in enumerate(components, start=1))
            for i, components in enumerate(entry["iterates"], start=1)
        ),
        tuple(_table_from_json(table, dimension, f"coordinate {j} of P") for j, table in enumerate(entry["image"], 1)),
        _table_from_json(entry["half_period"], dimension, "the half period"),
        None if integral is None else _table_from_json(integral, dimension, "the first integral"),
        tuple(tuple(_read(text, "back") for text in row) for row in entry["back"]),
        distance,
        computation["order"], computation["precision"], computation.get("steps", 0), computation.get("coordinates", ""),
    )  # fmt: skip


def tables_from_json(
    entry: Mapping[str, Any], candidate: Candidate, computation: Mapping[str, Any]
) -> Enclosures | OrbitEnclosures:
    """The same enclosures, those of a claim.

    Raises `ValueError` that names the table and the derivative that cannot be read.
    """
    dimension = len(candidate.radii)
    if (candidate.kind == ORBIT) != ("back" in entry):
        raise ValueError("the enclosures are those of another kind of claim")
    if candidate.kind == ORBIT:
        return _orbit_from_json(entry, dimension, computation)
    iterates = tuple(
        tuple(
            _table_from_json(table, dimension, f"q_{j}(P^{i})") for j, table in enumerate(components, start=1)
        )
        for i, components in enumerate(entry["iterates"], start=1)
    )  # fmt: skip
    integral = entry["first_integral"]
    return Enclosures(
        iterates,
        None if integral is None else _table_from_json(integral, dimension, "the first integral"),
        tuple(_read(text, f"time of crossing {i}") for i, text in enumerate(entry["return_times"], start=1)),
        computation["order"], computation["precision"], computation.get("steps", 0),
    )  # fmt: skip


def _table_to_json(table: DerivativeTable) -> dict[str, list[str]]:
    indices = sorted(indices_up_to(len(next(iter(table.box))), MAX_ORDER))
    return {
        "box": [ball_to_text(table.box[index]) for index in indices],
        "centre": [ball_to_text(table.centre[index]) for index in indices],
    }


def _table_from_json(entry: Mapping[str, Sequence[str]], dimension: int, name: str) -> DerivativeTable:
    indices = sorted(indices_up_to(dimension, MAX_ORDER))
    parts: list[dict[MultiIndex, arb]] = []
    for part in ("box", "centre"):
        texts = entry[part]
        if len(texts) != len(indices):
            raise ValueError(f"{name}, {part}: {len(texts)} derivatives up to order {MAX_ORDER}, not {len(indices)}")
        parts.append(
            {index: _read(text, f"{derivative_name(index)} of {name}, {part}")
             for index, text in zip(indices, texts, strict=True)}
        )  # fmt: skip
    return DerivativeTable(*parts)


def derivative_name(index: MultiIndex) -> str:
    """A derivative for messages: d^(2,1,0) is taken twice in p_0 and once in p_1."""
    return f"d^({','.join(str(order) for order in index)})"


def _read(text: str, name: str) -> arb:
    try:
        return ball_from_text(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
