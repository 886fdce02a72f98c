"""Results of pieces as files hold them, and as values; single parts of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from orbitproof.shared.codec import from_json, to_json
from orbitproof.verify.branches import Result
from orbitproof.verify.curve import IntervalResult, PieceResult
from orbitproof.verify.distances import DistanceFunctions, KnownDistances, known_distances
from orbitproof.verify.evidence import NotKnown
from orbitproof.verify.functions import BoundedFunction, StoredFunction
from orbitproof.verify.lasting import CurveIntervalResult
from orbitproof.verify.out_of_plane import KnownVariations, VariationFunctions
from orbitproof.verify.periodic_curve import PeriodicIntervalResult
from orbitproof.verify.stability import StabilityFunctions, unconfirmed
from orbitproof.verify.surface import ProvedPart, SurfaceResult


def value_of(entry: Mapping[str, Any] | Result) -> Result:
    """The result that a JSON object says, of a piece of the kind that it looks like."""
    if isinstance(entry, IntervalResult):
        return entry
    kind: type[Result] = CurveIntervalResult if "parts" not in entry else SurfaceResult
    kind = PeriodicIntervalResult if "multipliers" in entry else kind
    whole = {key: value for key, value in entry.items() if value is not None}
    whole["computation"] = {"seconds": 0.0, **entry.get("computation", {})}
    return from_json(kind, whole, "the result")


def values(entries: Sequence[Mapping[str, Any] | Result]) -> list[Result]:
    """The results that JSON objects say."""
    return [value_of(entry) for entry in entries]


def entry_of(found: PieceResult[Any] | IntervalResult, **more: Any) -> dict[str, Any]:
    """The JSON object of what was found, with more keys."""
    stored = found.stored if isinstance(found, PieceResult) else found
    return {**to_json(stored), **more}


ENTRIES = ("11", "12", "21", "22")
"""Keys of the variations out of the plane, by rows."""


def function_of(entry: Mapping[str, Any]) -> BoundedFunction:
    """The function of a JSON object."""
    return from_json(StoredFunction, entry, "the function").enclosed


def json_of_function(element: Any) -> dict[str, Any]:
    """The JSON object of a function that is enclosed in the algebra."""
    return dict(to_json(StoredFunction.of(element)))


def stored_distances(entry: Mapping[str, Any] | None) -> KnownDistances | None:
    """The distances of a JSON object; `None` where it says why they are not known."""
    if entry is None or "reason" in entry:
        return None
    return known_distances(from_json(DistanceFunctions, entry, "the distance"))


def variations_of(entry: Mapping[str, Any] | None) -> KnownVariations | None:
    """The variations of a JSON object; `None` where it says why they are not known."""
    if entry is None or "reason" in entry:
        return None
    return from_json(VariationFunctions, entry, "the variations").known


def stability_of(entry: Mapping[str, Any]) -> StabilityFunctions | NotKnown:
    """The stored stability of a JSON object."""
    return from_json(NotKnown, entry, "stability") if "reason" in entry else from_json(StabilityFunctions, entry, "")


def unconfirmed_of(stored: Mapping[str, Any], fresh: Mapping[str, Any]) -> list[str]:
    """See `stability.unconfirmed`, of JSON objects."""
    return list(unconfirmed(stability_of(stored), stability_of(fresh)))


def part_of(entry: Mapping[str, Any]) -> ProvedPart:
    """The part of a surface that a JSON object says."""
    return from_json(ProvedPart, entry, "the part")
