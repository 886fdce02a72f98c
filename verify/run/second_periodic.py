"""Whether the second proof of a periodic orbit says the same as its certificate. Section 9.6 of its chapter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import acb, arb, arb_mat, fmpq

from orbitproof.shared.numbers import parse_exact
from orbitproof.verify.evidence import ball_from_json
from orbitproof.verify.run.relation import NOT_CONFIRMED, Comparison, agreement
from orbitproof.verify.second_proof import ProvedPeriodic, ProvedPeriodicBifurcation, ProvedTorus

_PARTS = ("real", "imaginary")
CROSSINGS = "the least period, with the crossings that are claimed"
COUNTS = "how many multipliers are inside, on and outside the circle"
"""What agrees where nothing else is said."""


def compare_periodic(certificate: Mapping[str, Any], result: ProvedPeriodic) -> Comparison:
    """Point, period and multipliers, ball by ball, and how many multipliers are where; the point in the claim's box.

    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    claim, results = certificate["statement"]["candidate"], certificate["results"]
    if set(results["point"]) != set(result.point):
        return Comparison("disagrees", "point: other coordinates in the certificate")
    pairs = {f"point.{name}": (ball, results["point"][name]) for name, ball in result.point.items()}
    pairs["period"] = result.period, results["period"]
    if (result.level is None) != (results.get("level") is None):
        return Comparison("disagrees", "level: is here or in the certificate, and not in both")
    if result.level is not None:
        pairs["level"] = result.level, results["level"]
    found = compare_multipliers(results["multipliers"], result, on_level=result.level is not None)
    if isinstance(found, Comparison):
        return found
    left = [NOT_CONFIRMED] if result.level is None else ["that the first integral is one", NOT_CONFIRMED]
    is_in_box = is_in_the_box(claim, list(result.point.values()))
    return agreement([CROSSINGS, COUNTS], pairs | found, left, is_in_box)


def compare_multipliers(
    stored: Mapping[str, Any], result: ProvedPeriodic | ProvedPeriodicBifurcation | ProvedTorus, *, on_level: bool
) -> dict[str, tuple[arb, Any]] | Comparison:
    """The multipliers with the stored balls that they may lie in, if as many are where they are stored; or why not."""
    if stored["trivial"] != (2 if on_level else 1):
        return Comparison("disagrees", "multipliers: another number of them is 1 for every orbit")
    mine = {"inside": result.inside, "on": result.on, "outside": result.outside}
    return compare_places(stored, mine, result.multipliers, ("multiplier", "the circle"))


def compare_places(
    stored: Mapping[str, Any], mine: Mapping[str, int], balls: Sequence[acb], called: tuple[str, str]
) -> dict[str, tuple[arb, Any]] | Comparison:
    """Numbers in balls of their own with the stored balls that they may lie in, if as many are where they are stored.

    Args:
        stored: how many are where, how many are undecided, and the balls.
        mine: how many are shown to be where.
        called: what a number is called, and beside what they are counted.
    """
    name, border = called
    size = len(balls)
    if sum(stored[place] for place in (*mine, "undecided")) != size:
        return Comparison("disagrees", f"{name}s: another number of them")
    for place, count in mine.items():
        # What is shown here to be elsewhere cannot be there.
        if stored[place] > size - sum(other for key, other in mine.items() if key != place):
            return Comparison("disagrees", f"{name}s: {stored[place]} {place} {border} in the certificate")
        if stored[place] > count:
            return Comparison("cannot follow", f"{name}s: that {stored[place]} are {place} is not shown here")
    entries = stored["values"]
    values = [acb(*(ball_from_json(value[part]) for part in _PARTS)) for value in entries]
    if not values:
        return {}
    held, pairs = [0] * size, dict[str, tuple[arb, Any]]()
    for number, ball in enumerate(balls, start=1):
        near = [place for place, value in enumerate(values) if value.overlaps(ball)]
        if not near:
            return Comparison("disagrees", f"{name} {number}: no stored ball has a point in common")
        # The ball of a cluster is repeated; else each has one of them.
        if any(entries[place] != entries[near[0]] for place in near):
            return Comparison("cannot follow", f"{name} {number}: may lie in either of two stored balls")
        for index in near:
            held[index] += 1
        for part in _PARTS:
            here, there = (getattr(value, part[:4]) for value in (ball, values[near[0]]))
            pairs[f"{name} {number}, {part} part"] = here, there
    if any(count != entries.count(entry) for count, entry in zip(held, entries, strict=True)):
        return Comparison("disagrees", f"{name}s: a stored ball has another number of them")
    return pairs


def is_in_the_box(claim: Mapping[str, Any], point: Sequence[arb]) -> bool | None:
    """Whether a point certainly lies in the box of a claim, certainly does not, or None: neither is certain."""
    rows = [[*map(_exact, row)] for row in claim["frame"]]
    if "normal" in claim:
        # The frame spans a section, which is less than the state.
        rows = [[*row, _exact(a)] for row, a in zip(rows, claim["normal"], strict=True)]
    right = [[x - _exact(c)] for x, c in zip(point, claim["centre"], strict=True)]
    moved = arb_mat(rows).solve(arb_mat(right))
    sizes = [(abs(moved[i, 0]), _exact(radius)) for i, radius in enumerate(claim["radii"])]
    if any(size > radius for size, radius in sizes):
        return False
    return True if all(size <= radius for size, radius in sizes) else None


def is_within(value: arb, middle: str, radius: str) -> bool | None:
    """Whether a value certainly lies in an interval, certainly does not, or None: neither is certain."""
    away, most = abs(value - _exact(middle)), _exact(radius)
    return False if away > most else True if away <= most else None


def _exact(number: str) -> arb:
    value = parse_exact(number)
    return arb(fmpq(value.numerator, value.denominator))
