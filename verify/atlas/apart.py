"""Checks of curves and surfaces, and of places on curves, in processes of their own with limits of time and memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from orbitproof.shared.systems import shown
from orbitproof.verify.atlas.certificate import AtlasCertificate
from orbitproof.verify.atlas.places import Placed, check_of_conclusion, places_on, recheck_places
from orbitproof.verify.certificate import Certificate, Level, Recheck, not_checked
from orbitproof.verify.engines import CheckLimits, Failure, Report, apart


def conclusion_apart(document: Mapping[str, Any], limits: CheckLimits, given: Sequence[Certificate] = ()) -> Recheck:
    """As `check_of_conclusion`; what is not brought to an end cannot be checked."""
    name = str(document["id"])
    result = apart(_conclusion, name, (document, given), limits)
    return not_checked(name, str(document["verdict"]), result) if isinstance(result, Failure) else result


def places_on_apart(curve: AtlasCertificate, orbits: Sequence[Certificate], limits: CheckLimits) -> list[Placed]:
    """As `places_on`; what is not brought to an end is not shown."""
    name = str(curve.document["id"])
    result = apart(_places, name, (curve, orbits), limits)
    if isinstance(result, Failure):
        words = f"not shown to lie on {shown(name)}: {result.message}"
        return [Placed(entry.with_place(None), f"{shown(entry.id)}: {words}") for entry in orbits]
    return list(result)


def recheck_places_apart(
    curve: AtlasCertificate | None,
    examined: Recheck | None,
    certificates: Sequence[Certificate],
    checks: Mapping[str, Recheck],
    limits: CheckLimits,
) -> dict[str, Recheck]:
    """As `recheck_places`, each certificate by itself; what is not brought to an end cannot be checked."""
    found = dict(checks)
    for entry in certificates:
        check = checks.get(entry.id)
        if check is None or not check.stands_without_place or "place" not in entry.to_json():
            continue
        result = apart(_place, entry.id, (curve, examined, entry, check), limits)
        if isinstance(result, Failure):
            obstacle = not_checked(entry.id, entry.verdict, result).obstacle
            result = replace(check, obstacle=f"its place: {obstacle}", level=min(check.level, Level.FORM))
        found[entry.id] = result
    return found


def _conclusion(argument: tuple[Mapping[str, Any], Sequence[Certificate]], report: Report) -> Recheck:
    return check_of_conclusion(*argument)


def _places(argument: tuple[AtlasCertificate, Sequence[Certificate]], report: Report) -> list[Placed]:
    return places_on(*argument)


def _place(argument: tuple[AtlasCertificate | None, Recheck | None, Certificate, Recheck], report: Report) -> Recheck:
    curve, examined, entry, check = argument
    return recheck_places(curve, examined, [entry], {entry.id: check})[entry.id]
