"""Provers of intervals that integrate nothing, in a module that is quick to import: each process imports it afresh.

They answer as `verify.branches.interval_proof.prove_task` does, for the exact cases of `chain_cases`, whose curves are
known.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from orbitproof.shared import parse_exact

Report = Callable[[float, str], None]
Argument = Mapping[str, Any]


def proving(argument: Argument, report: Report) -> dict[str, Any]:
    """What is true of the cases."""
    report(0.5, "half way")
    size = len(argument["piece"]["tube"])
    return {
        "piece": argument["piece"]["id"],
        "interval": list(argument["interval"]),
        "verdict": "proved",
        "deviation": ["0x1p-30"] * size,
        "slope_deviation": ["0x1p-26"] * size,
        "time": {"mid": "0x3", "rad": "0x1p-2", "decimal": "[2.75, 3.25]"},
        "computation": {**argument["integrator"], "steps": 7, "coordinates": "physical", "seconds": 0.25},
    }


def failing(argument: Argument, report: Report) -> dict[str, Any]:
    """Fails on every interval."""
    return {
        "piece": argument["piece"]["id"],
        "interval": list(argument["interval"]),
        "verdict": "not proved",
        "reason": {"condition": "tube", "message": "the tube is empty", "remedy": "give another piece"},
        "computation": {**argument["integrator"], "seconds": 0.5},
    }


def singular(argument: Argument, report: Report) -> dict[str, Any]:
    """Fails on every interval of the second piece, for a reason that is there however short it is."""
    reason = {"condition": "singular", "message": "a bifurcation is there", "remedy": "end the curve before it"}
    return {**failing(argument, report), "reason": reason} if _second(argument) else proving(argument, report)


def short_only(argument: Argument, report: Report) -> dict[str, Any]:
    """Fails on intervals longer than 1 of the second piece."""
    return proving(argument, report) if _length(argument) <= 1 or not _second(argument) else failing(argument, report)


def precise_only(argument: Argument, report: Report) -> dict[str, Any]:
    """Fails with little precision on the second piece."""
    enough = argument["integrator"]["precision"] > _LITTLE_PRECISION
    return proving(argument, report) if enough or not _second(argument) else failing(argument, report)


def steep_only(argument: Argument, report: Report) -> dict[str, Any]:
    """Leaves open without second derivatives whether the derivative across the second piece is regular."""
    if argument["integrator"]["top"] > 1 or not _second(argument):
        return proving(argument, report)
    reason = {"condition": "slope", "message": "the derivative may be singular", "remedy": "give a larger top"}
    return {**failing(argument, report), "reason": reason}


def steep_halves(argument: Argument, report: Report) -> dict[str, Any]:
    """As `steep_only`, but with second derivatives the whole of the second piece takes too long."""
    if argument["integrator"]["top"] > 1 and _second(argument) and _length(argument) > Fraction(3, 2):
        return {**failing(argument, report), "reason": {"condition": "time", "message": "too long", "remedy": ""}}
    return steep_only(argument, report)


def unclear(argument: Argument, report: Report) -> dict[str, Any]:
    """Leaves that open with all settings, on intervals of the second piece longer than 1/2."""
    if _length(argument) <= Fraction(3, 5) or not _second(argument):
        return proving(argument, report)
    return {**failing(argument, report), "reason": {"condition": "slope", "message": "may be singular", "remedy": ""}}


def unclear_and_lost(argument: Argument, report: Report) -> dict[str, Any]:
    """As `unclear`, but no process bears second derivatives."""
    if argument["integrator"]["top"] > 1:
        return {**failing(argument, report), "reason": {"condition": "process", "message": "lost", "remedy": ""}}
    return unclear(argument, report)


def unclear_and_failing(argument: Argument, report: Report) -> dict[str, Any]:
    """As `unclear`, but with second derivatives the Newton operator fails."""
    if argument["integrator"]["top"] > 1:
        return failing(argument, report)
    return unclear(argument, report)


def not_the_second(argument: Argument, report: Report) -> dict[str, Any]:
    """Fails on the second piece, however short the interval."""
    return failing(argument, report) if _second(argument) else proving(argument, report)


def dying(argument: Argument, report: Report) -> dict[str, Any]:
    """Ends its process at the second piece."""
    if _second(argument):
        os._exit(3)
    return proving(argument, report)


def endless(argument: Argument, report: Report) -> dict[str, Any]:
    """Never comes to an end at the second piece."""
    if _second(argument):
        time.sleep(600)
    return proving(argument, report)


def other_times(argument: Argument, report: Report) -> dict[str, Any]:
    """Half periods that cannot be those of `proving`."""
    return {**proving(argument, report), "time": {"mid": "0x9", "rad": "0x1p-2", "decimal": "[8.75, 9.25]"}}


_LITTLE_PRECISION = 100


def _second(argument: Argument, name: str = "p001") -> bool:
    return bool(argument["piece"]["id"] == name)


def _length(argument: Argument) -> Fraction:
    start, end = (parse_exact(text) for text in argument["interval"])
    return end - start


def stored(argument: Argument, report: Report) -> dict[str, Any]:
    """What tests/data knows of two pieces of the Falkner-Skan family; of their stability only if it is asked for."""
    results = json.loads((Path(__file__).parents[1] / "data" / "stability-falkner-skan.json").read_text())
    (result,) = (entry for entry in results if entry["piece"] == argument["piece"]["id"])
    if not argument["stability"]:
        del result["stability"]
    report(0.5, "half way")
    return {**result, "computation": {**result["computation"], **argument["integrator"]}}


def stored_without_stability(argument: Argument, report: Report) -> dict[str, Any]:
    """As if the stability of the second piece could not be enclosed."""
    result = stored(argument, report)
    if _second(argument, "p015"):
        result["stability"] = {"reason": {"condition": "stability", "message": "a divisor may be zero", "remedy": ""}}
    return result
