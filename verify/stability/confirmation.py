"""Whether a new integration confirms stored functions (section 18.8)."""

from __future__ import annotations

from collections.abc import Iterator

from flint import ctx

from orbitproof.verify.distances import DistanceFunctions, Where, known_distances
from orbitproof.verify.evidence import NotKnown
from orbitproof.verify.functions import StoredFunction
from orbitproof.verify.out_of_plane import VariationFunctions
from orbitproof.verify.stability.stored_stability import StabilityFunctions

_BITS = 192


def unconfirmed(stored: StabilityFunctions | NotKnown, fresh: StabilityFunctions | NotKnown | None) -> Iterator[str]:
    """What is stored of the stability on an interval, and is not contained in what a new integration finds, in words.

    A function is confirmed if every function that the new one encloses is one that the stored one encloses.
    """
    if isinstance(stored, NotKnown):
        return
    if not isinstance(fresh, StabilityFunctions):
        why = "it is missing" if fresh is None else fresh.reason.message
        yield f"stability is not enclosed again: {why}"
        return
    if len(stored.characteristic) != len(fresh.characteristic):
        yield "has another number of coefficients of the characteristic polynomial"
        return
    with ctx.workprec(_BITS):
        pairs = zip(stored.characteristic, fresh.characteristic, strict=True)
        for number, (old, new) in enumerate(pairs, start=1):
            if not _holds(old, new):
                name = f"coefficient {number} of the characteristic polynomial"
                yield f"the stored bounds of the {name} are not confirmed"
        for name in ("level", "half_period", "first_factor"):
            if not _holds(getattr(stored, name), getattr(fresh, name)):
                yield f"the stored bounds of the {name.replace('_', ' ')} are not confirmed"
        if isinstance(stored.out_of_plane, VariationFunctions):
            yield from _unconfirmed_variations(stored.out_of_plane, fresh.out_of_plane)
        if isinstance(stored.distance, DistanceFunctions):
            yield from _unconfirmed_distances(stored.distance, fresh.distance)


def _holds(stored: StoredFunction, fresh: StoredFunction) -> bool:
    return stored.enclosed.contains(fresh.enclosed.as_found)


def _unconfirmed_variations(old: VariationFunctions, new: VariationFunctions | NotKnown | None) -> Iterator[str]:
    if not isinstance(new, VariationFunctions):
        yield "variations out of the plane are not enclosed again"
    elif not all(map(_holds, old.entries, new.entries)):
        yield "the stored bounds of variations out of the plane are not confirmed"


def _unconfirmed_distances(stored: DistanceFunctions, fresh: DistanceFunctions | NotKnown | None) -> Iterator[str]:
    if not isinstance(fresh, DistanceFunctions):
        yield "distances are not enclosed again"
        return
    for name, before, after in (
        ("this point", stored.here, fresh.here),
        ("the other point", stored.there, fresh.there),
    ):
        if not _holds(before, after):
            yield f"the stored bounds of the distance at {name} are not confirmed"
    parts = zip(known_distances(stored).parts, known_distances(fresh).parts, strict=True)
    for number, (held_part, found_part) in enumerate(parts, start=1):
        for word in ("least", "greatest"):
            held, found = getattr(held_part, word), getattr(found_part, word).as_found
            if held.where not in (Where.ALONG, found.where) or not held.square.contains(found.square):
                yield f"the {word} distance on part {number} is not confirmed"
