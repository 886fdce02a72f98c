"""A prover of intervals that integrates nothing: the Falkner-Skan family for beta from 260 to 690, with any twist.

What it finds depends on the length of an interval and on the settings, as what an integration finds does: too long an
interval is not proved, or leaves the twist open, and closer looks find more the shorter they are, the first one on
p014 less than what it was made for. Functions on a part of a piece are those on all of it, in other variables.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from math import comb
from pathlib import Path
from typing import Any

from orbitproof.shared import format_exact, parse_exact

DATA = Path(__file__).parents[1] / "data"
LOOK = 12
"""The width of closer looks."""
_ZERO = {"p014": Fraction(5, 8), "p015": Fraction(1, 64)}
"""Where the twist of each piece vanishes, by s; on p015 both halves know the place."""
_BITS = 120


def proving(argument: Mapping[str, Any], report: Any) -> dict[str, Any]:
    """What is true of the two pieces, as far as such an interval tells."""
    report(0.5, "half way")
    name = argument["piece"]["id"]
    results = json.loads((DATA / "lasting-falkner-skan.json").read_text())
    (known,) = (entry for entry in results if entry["piece"] == name)
    start, end = (parse_exact(text) for text in argument["interval"])
    length, settings = end - start, argument["integrator"]
    computation = {**known["computation"], **settings, "seconds": 0.25}
    found = {**known, "interval": list(argument["interval"]), "computation": computation}
    is_look, is_precise = settings["width"] == LOOK, settings["precision"] > 100
    if length > Fraction(3, 4) and name == "p015" and not is_precise:
        for key in ("deviation", "slope_deviation", "time", "stability", "twist"):
            del found[key]
        reason = {"condition": "newton", "message": "too long", "remedy": "give less"}
        return {**found, "verdict": "not proved", "reason": reason}
    known = found["stability"]
    for key in ("level", "half_period", "first_factor"):
        known[key] = _moved(known[key], start, end)
    known["characteristic"] = [_moved(each, start, end) for each in known["characteristic"]]
    if is_look:
        error = Fraction(1) if name == "p014" else 2**10 * length**4 if length > 2**-12 else length**3
    else:
        error = (1 + (not is_precise)) * length**4 / 2**7
    # 16 (s - zero), which changes its sign at the zero.
    middle, radius = (start + end) / 2, length / 2 * Fraction(33, 32)
    sign = -1 if name == "p015" else 1
    twist = _stored([sign * 16 * (middle - _ZERO[name]), sign * 16 * radius], error)
    constant = _stored([Fraction(1)], Fraction(1, 2**20))
    nothing = _stored([], Fraction(1, 2**20))
    return {**found, "twist": {"twist": twist, "exchanged": twist, "fourth": constant, "defect": nothing}}


def _stored(coefficients: list[Fraction], error: Fraction) -> dict[str, Any]:
    rounded = [Fraction(round(value * 2**_BITS), 2**_BITS) for value in coefficients]
    above = Fraction(-((-error * 2**_BITS) // 1), 2**_BITS)
    return {"coefficients": [format_exact(value) for value in rounded], "error": format_exact(above)}


def _moved(function: Mapping[str, Any], start: Fraction, end: Fraction) -> dict[str, Any]:
    """A function on [-1, 1], on a part of that."""
    coefficients = [parse_exact(text) for text in function["coefficients"]]
    shift, factor = (start + end) / 2 * Fraction(32, 33), (end - start) / 2
    moved = [
        sum((comb(n, k) * value * shift ** (n - k) for n, value in enumerate(coefficients) if n >= k), Fraction(0))
        * factor**k
        for k in range(len(coefficients))
    ]
    share = min(Fraction(1), (end - start) ** 3)
    return _stored(moved, parse_exact(function["error"]) * share + Fraction(1, 2 ** (_BITS - 8)))
