"""What the pieces of an atlas prove together, as certificates say it: exact numbers, balls with decimals beside."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from orbitproof.shared.numbers import format_exact
from orbitproof.verify.branches.whole_as_json import named_balls, whole_to_json
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.curve import Conclusion, ProvedCurve
from orbitproof.verify.distances import Ranges
from orbitproof.verify.evidence import Proved, hypothesis_to_json, outcome_to_json
from orbitproof.verify.lasting import ExceptionalOrbit, LastingInterval, ProvedLasting, Reversibility
from orbitproof.verify.stability import (
    Bound,
    CompleteList,
    Extremum,
    Gap,
    ListAcross,
    ListConclusion,
    Point,
    ProvedList,
    StableInterval,
    name_of,
)

Json = dict[str, Any]


def list_to_json(conclusion: ListConclusion, statement: str) -> Json:
    """The JSON object of what is concluded of a curve with its list; `statement` is the theorem in words."""
    listed = conclusion.outcome.results if isinstance(conclusion.outcome, Proved) else None
    complete = _EMPTY | {"order": conclusion.order} if listed is None else _list(listed)
    curve = curve_to_json(conclusion.curve, statement)
    return {**curve, **outcome_to_json(conclusion.outcome), "complete": complete}


def curve_to_json(conclusion: Conclusion[ProvedCurve], statement: str) -> Json:
    """The JSON object of what is concluded of a curve; `statement` is its theorem in words."""
    chain = conclusion.outcome.results.chain if isinstance(conclusion.outcome, Proved) else None
    return whole_to_json(conclusion, statement, chain)


_EMPTY: Json = {name: [] for name in ("hypotheses", "points", "stable", "undecided", "gaps", "extrema", "open_extrema")}


def _list(known: ProvedList) -> Json:
    found = known.found
    return {
        "order": found.order,
        "hypotheses": [hypothesis_to_json(hypothesis) for hypothesis in found.hypotheses],
        "stability_parameters": found.parameters,
        **_entries(found, known.stable, known.unknown),
        "extrema": [_extremum(entry) for entry in found.extrema],
        "open_extrema": [_gap(gap) for gap in found.open_extrema],
        **_combinations(found),
        **({} if known.across is None else {"out_of_plane": _across(known.across)}),
        **({"lasting": _lasting(known)} if isinstance(known, ProvedLasting) else {}),
    }


def _combinations(found: CompleteList) -> Json:
    """Absent if they were not asked for."""
    if found.combinations is None:
        return {}
    points, gaps = found.combinations.points, found.combinations.open
    return {"combinations": [_point(point) for point in points], "open_combinations": [_gap(gap) for gap in gaps]}


def _lasting(known: ProvedLasting) -> Json:
    lasting, shown = known.lasting, known.reversibility
    return {
        "exceptions": [_exception(entry) for entry in lasting.exceptions],
        "stable": [_lasting_interval(entry) for entry in lasting.stable],
        "undecided": [_stable(entry) for entry in lasting.undecided],
        "gaps": [_gap(gap) for gap in lasting.gaps],
        **({} if shown is None else {"reversibility": _reversibility(shown)}),
    }


def _reversibility(shown: Reversibility) -> Json:
    balls = {"known_part": shown.known_part, **({} if shown.bound is None else {"bound": shown.bound})}
    return {"intervals": shown.intervals, "sharp": shown.sharp, **named_balls(balls)}


def _exception(entry: ExceptionalOrbit) -> Json:
    return {**_point(entry.point), "fate": entry.fate.value}


def _lasting_interval(entry: LastingInterval) -> Json:
    return {**_stable(entry.between), "twist": "positive" if entry.sign > 0 else "negative"}


def _across(across: ListAcross) -> Json:
    listed = _entries(across.found, across.stable, across.unknown)
    for point, value in zip(listed["points"], across.jacobi_constants, strict=True):
        point |= {} if value is None else {"jacobi_constant": to_json(value)}
    return listed


def _entries(found: CompleteList, stable: tuple[StableInterval, ...], unknown: tuple[StableInterval, ...]) -> Json:
    return {
        "points": [_point(point) for point in found.points],
        "stable": [_stable(entry) for entry in stable],
        "undecided": [_stable(entry) for entry in unknown],
        "gaps": [_gap(gap) for gap in found.gaps],
    }


def _point(point: Point) -> Json:
    balls = named_balls({"s": point.s, "level": point.level, "half_period": point.half_period})
    names = {"piece": point.piece, "k": point.k, "j": point.j, "kind": name_of(point.kind)}
    return {**names, **balls, "point": named_balls(point.point), "certificates": list(point.certificates)}


def _extremum(entry: Extremum) -> Json:
    balls = {"value": entry.value, "s": entry.s, "level": entry.level, "half_period": entry.half_period}
    known = {"certificates": list(entry.certificates)} if entry.certificates else {}
    return {"piece": entry.piece, "in_band": entry.in_band, **named_balls(balls), **known}


def _gap(gap: Gap) -> Json:
    interval = _outward(gap.start, gap.end)
    return {"piece": gap.piece, "interval": interval, "about": name_of(gap.subject), "reason": gap.reason}


def _stable(entry: StableInterval) -> Json:
    """What is at both ends, and where on their pieces."""
    between = {} if entry.ranges is None else {"between": _ranges(entry.ranges)}
    return {"from": _bound(entry.begin, entry.pieces[0]), "to": _bound(entry.end, entry.pieces[1]), **between}


def _bound(bound: Bound, piece: str) -> Json:
    """With level and half period if it is a point of the list."""
    known = {} if bound.ranges is None else _ranges(bound.ranges)
    if bound.point is not None:
        known |= named_balls({"level": bound.point.level, "half_period": bound.point.half_period})
    interval = _outward(bound.lower, bound.upper)
    return {"what": [name_of(what) for what in bound.what], "piece": piece, "interval": interval, **known}


def _ranges(ranges: Ranges) -> Json:
    entry = named_balls({"half_period": ranges.half_period})
    places: Json = {}
    for name, (distance, where) in ranges.distances.items():
        places |= {f"{name}_distance": to_json(distance), f"{name}_distance_at": where.value}
    return {**entry, **places}


def _outward(start: Fraction, end: Fraction) -> list[str]:
    return [format_exact(shortened(start, -1)), format_exact(shortened(end, 1))]


def shortened(value: Fraction, side: int) -> Fraction:
    """A dyadic number next to an end of an interval, beyond it."""
    scaled = value * 2**60
    whole = scaled.numerator // scaled.denominator
    return Fraction(whole + (1 if side > 0 and whole != scaled else 0), 2**60)
