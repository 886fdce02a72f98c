"""Whether a new integration confirms stored functions (section 18.8)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from flint import ctx

from orbitproof.verify.distances import Where, distances_from_json
from orbitproof.verify.functions import function_from_json
from orbitproof.verify.out_of_plane import variations_from_json

_BITS = 192
_FUNCTIONS = ("level", "half_period", "first_factor")


def unconfirmed(stored: Mapping[str, Any], fresh: Mapping[str, Any]) -> Iterator[str]:
    """What is stored of the stability on an interval, and is not contained in what a new integration finds, in words.

    A function is confirmed if every function that the new one encloses is one that the stored one encloses.
    """
    if "reason" in stored:
        return
    if "reason" in fresh:
        yield f"stability is not enclosed again: {fresh['reason']['message']}"
        return
    if len(stored["characteristic"]) != len(fresh["characteristic"]):
        yield "has another number of coefficients of the characteristic polynomial"
        return
    pairs = [
        (f"coefficient {number} of the characteristic polynomial", old, new)
        for number, (old, new) in enumerate(
            zip(stored["characteristic"], fresh["characteristic"], strict=True), start=1
        )
    ]
    pairs += [(name.replace("_", " "), stored[name], fresh[name]) for name in _FUNCTIONS]
    with ctx.workprec(_BITS):
        for name, old, new in pairs:
            if not function_from_json(old).contains(function_from_json(new).as_found):
                yield f"the stored bounds of the {name} are not confirmed"
        yield from _unconfirmed_variations(stored.get("out_of_plane"), fresh.get("out_of_plane"))
        yield from _unconfirmed_distances(stored.get("distance"), fresh.get("distance"))


def _unconfirmed_variations(stored: Mapping[str, Any] | None, fresh: Mapping[str, Any] | None) -> Iterator[str]:
    old, new = (variations_from_json(entry) for entry in (stored, fresh))
    if old is None:
        return
    if new is None:
        yield "variations out of the plane are not enclosed again"
    elif not all(held.contains(found.as_found) for held, found in zip(old.entries, new.entries, strict=True)):
        yield "the stored bounds of variations out of the plane are not confirmed"


def _unconfirmed_distances(stored: Mapping[str, Any] | None, fresh: Mapping[str, Any] | None) -> Iterator[str]:
    old, new = (distances_from_json(entry) for entry in (stored, fresh))
    if old is None:
        return
    if new is None:
        yield "distances are not enclosed again"
        return
    for name, before, after in (("this point", old.here, new.here), ("the other point", old.there, new.there)):
        if not before.contains(after.as_found):
            yield f"the stored bounds of the distance at {name} are not confirmed"
    for number, (held_part, found_part) in enumerate(zip(old.parts, new.parts, strict=True), start=1):
        for word in ("least", "greatest"):
            held, found = getattr(held_part, word), getattr(found_part, word).as_found
            if held.where not in (Where.ALONG, found.where) or not held.square.contains(found.square):
                yield f"the {word} distance on part {number} is not confirmed"
