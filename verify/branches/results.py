"""What was found on the intervals of the pieces of an atlas: as values, and as they stand in files and answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, cast

from orbitproof.shared.formats import AnyAtlas, Atlas, InputError
from orbitproof.verify.certificate.kinds import kind_named
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.curve.piece_result import Interval, IntervalResult

if TYPE_CHECKING:
    from orbitproof.verify.lasting import CurveIntervalResult

Result = IntervalResult
"""What is known of an interval of a piece; each kind of branch has a type of its own: `BranchKind.result`."""

Settings = Mapping[str, int]
"""Settings of the integrator by name, as they stand in a result's `Computation`."""


def results_from_json(atlas: AnyAtlas, entries: Sequence[Mapping[str, Any]]) -> tuple[Result, ...]:
    """The results of a file, which fits the schema. Raises `InputError` for one that is about no piece of the atlas."""
    pieces = {piece.id: piece for piece in atlas.pieces}
    found = []
    for index, entry in enumerate(entries):
        if entry["piece"] not in pieces:
            raise InputError(f"results[{index}].piece: no such piece in the atlas")
        kind = cast(Any, kind_named(atlas.claim.kind)).result(pieces[entry["piece"]])
        found.append(result_from_json(kind, entry, f"results[{index}]"))
    return tuple(found)


def result_from_json(kind: type[Result], entry: Mapping[str, Any], place: str) -> Result:
    """What was found for a piece, of the type of its kind of branch. Raises `InputError` that begins with `place`."""
    for name in sorted(set(entry) - {each.name for each in fields(kind)}):
        raise InputError(f"{place}.{name}: is not found for such a piece; write the file again")
    return from_json(kind, entry, place)


def on_curve(atlas: Atlas, results: Sequence[Result]) -> list[CurveIntervalResult]:
    """The results about the pieces of a curve itself, and not about the birth of its orbits."""
    names = {piece.id for piece in atlas.curve_pieces()}
    return [cast("CurveIntervalResult", result) for result in results if result.piece in names]


def covers(intervals: Sequence[Interval], wanted: Interval) -> bool:
    """Whether closed intervals cover another one."""
    reached, end = wanted
    for first, last in sorted(intervals):
        if first > reached:
            break
        reached = max(reached, last)
        if reached >= end:
            return True
    return False


def condition_of(result: Result) -> str:
    """What stopped a proof, in one word; empty if the result does not say."""
    return "" if result.reason is None else result.reason.condition
