"""Certificates store all that values say and nothing else; no number of them is left out when they are compared."""

from __future__ import annotations

import copy
from dataclasses import replace
from fractions import Fraction
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from flint import arb, ctx
from support.stability_cases import atlas, listed, results
from support.stored import values
from support.within import within

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.formats import read_atlas
from orbitproof.verify.branches import interval_proof
from orbitproof.verify.branches.conclusion_as_json import curve_to_json, list_to_json
from orbitproof.verify.branches.interval_proof import question
from orbitproof.verify.curve import Bifurcation, Computation, PieceResult, PlaceOnCurve, ProvedInterval, conclude
from orbitproof.verify.distances import DistanceFunctions, Extreme, Extremes, Ranges, Where
from orbitproof.verify.distances.distances import PARTS
from orbitproof.verify.evidence import (
    Hypothesis,
    NotKnown,
    Proved,
    Reason,
    ball_to_json,
    hypothesis_to_json,
    reason_to_json,
)
from orbitproof.verify.functions import BoundedFunction, StoredFunction
from orbitproof.verify.out_of_plane import VariationFunctions
from orbitproof.verify.stability import (
    Bound,
    CurveEnd,
    Extremum,
    Gap,
    Kind,
    ListAcross,
    ListConclusion,
    Matter,
    Point,
    Resonance,
    Segment,
    StabilityFunctions,
    StableInterval,
    TubeOfOrbits,
    conclude_list,
    unconfirmed,
)
from orbitproof.verify.stability.known_functions import segment_of

DATA = Path(__file__).parents[1] / "data"

_precision = within(lambda: ctx.workprec(160))


def test_what_is_stored_of_a_curve_and_of_points_on_it_is_what_is_known() -> None:
    on_it = Bifurcation(
        "a",
        "fold",
        1,
        PlaceOnCurve("p015", arb(1, 2**-9), True, True),
        "",
        {"beta": arb(2), "y": arb(3)},
        "beta",
        arb(4),
    )
    beside = Bifurcation("b", "period_tupling", 2, None, "elsewhere", {}, "", None, True)
    curve = replace(conclude(atlas(), values(results())), bifurcations=(on_it, beside))
    assert isinstance(curve.outcome, Proved)
    chain = curve.outcome.results.chain
    told = curve_to_json(curve, "words")
    stored = [(each["piece"], parse_exact(each["enters"]), parse_exact(each["leaves"])) for each in told["stretches"]]
    assert stored == [(each.tube.piece.id, each.enters, each.leaves) for each in chain.stretches]
    (joint,), (entry,) = chain.joints, told["joints"]
    assert entry == {
        "before": "p014",
        "after": "p015",
        "leaves": entry["leaves"],
        "enters": ball_to_json(joint.enters),
        "offsets": [ball_to_json(ball) for ball in joint.offsets],
        "turn": ball_to_json(joint.turn),
    }
    assert parse_exact(entry["leaves"]) == joint.leaves
    assert told["ends"]["start"].keys() == curve.outcome.results.ends["start"].keys()
    assert told["ends"]["start"]["beta"] == ball_to_json(curve.outcome.results.ends["start"]["beta"])
    assert told["ends"]["end"]["beta"] == ball_to_json(curve.outcome.results.ends["end"]["beta"])
    assert (told["verdict"], told["statement"], told["reason"]) == ("proved", "words", None)
    assert told["bifurcations"] == [
        {
            "id": "a", "kind": "fold", "k": 1, "on_curve": True, "piece": "p015", "s": ball_to_json(arb(1, 2**-9)),
            "mirrored": True, "other_point": True, "is_foreign": False, "reason": "",
            "point": {"beta": ball_to_json(arb(2)), "y": ball_to_json(arb(3))},
            "parameter_name": "beta", "parameter": ball_to_json(arb(4)),
        },
        {
            "id": "b", "kind": "period_tupling", "k": 2, "on_curve": False, "piece": None, "s": None,
            "mirrored": False, "other_point": False, "is_foreign": True, "reason": "elsewhere", "point": {},
            "parameter_name": "", "parameter": None,
        },
    ]  # fmt: skip


QUARTER, HALF = Fraction(1, 4), Fraction(1, 2)
POINT = Point(0, "p014", 5, 2, Kind.RESONANCE, arb(1), arb(2), arb(3), {"beta": arb(4)}, ("a", "b"))
NEAR = Ranges(arb(5), Extreme(arb(4), Where.HERE), Extreme(arb(9), Where.THERE))


def _interval(number: int) -> StableInterval:
    """Distinct in all that is told of it."""
    begin = Bound(0, -QUARTER, Fraction(number, 64), (CurveEnd.BEGINNING,))
    end = Bound(1, QUARTER, HALF, (POINT.found,), POINT, ranges=NEAR)
    return StableInterval(begin, end, ("p014", "p015"), replace(NEAR, half_period=arb(number)))


def test_what_is_stored_of_a_list_is_what_is_known() -> None:
    curve = conclude(atlas(), values(results()))
    conclusion = conclude_list(atlas(), values(results()), curve, 4)  # type: ignore[arg-type]
    assert isinstance(conclusion.outcome, Proved)
    known_ = conclusion.outcome.results
    gap = Gap(0, "p014", QUARTER, HALF, Matter.COLLISION, "not decided")
    beside = Gap(1, "p015", -HALF, QUARTER, Resonance(3, 1), "not looked at")
    open_gap = Gap(1, "p015", QUARTER, HALF, Matter.EXTREMA, "open")
    extrema = (
        Extremum(0, "p014", arb(1), False, arb(2), arb(3), arb(4), ("c",)),
        Extremum(1, "p015", arb(5), True, arb(6), arb(7), arb(8)),
    )
    found = replace(
        known_.found, points=(POINT,), gaps=(gap,), extrema=extrema, open_extrema=(open_gap,), order=6, parameters=2
    )
    across = replace(known_.found, points=(POINT, replace(POINT, k=7)), gaps=(beside,))
    listed = replace(
        known_,
        found=found,
        stable=(_interval(1),),
        unknown=(_interval(2),),
        across=ListAcross(across, (_interval(3),), (_interval(4),), (arb(9), None)),
    )
    told = list_to_json(replace(conclusion, outcome=replace(conclusion.outcome, results=listed)), "words")
    complete = told["complete"]
    assert told["statement"] == "words"
    assert (complete["order"], complete["stability_parameters"]) == (6, 2)
    assert complete["hypotheses"] == [hypothesis_to_json(each) for each in found.hypotheses]
    assert complete["points"] == [point_as_said(5)]
    assert complete["stable"] == [interval_as_said(1)]
    assert complete["undecided"] == [interval_as_said(2)]
    assert complete["gaps"] == [
        {"piece": "p014", "interval": ["0x1p-2", "0x1p-1"], "about": Matter.COLLISION.value, "reason": "not decided"}
    ]
    assert complete["open_extrema"] == [
        {"piece": "p015", "interval": ["0x1p-2", "0x1p-1"], "about": Matter.EXTREMA.value, "reason": "open"}
    ]
    assert complete["extrema"] == [
        {"piece": "p014", "in_band": False, **balls(value=1, s=2, level=3, half_period=4), "certificates": ["c"]},
        {"piece": "p015", "in_band": True, **balls(value=5, s=6, level=7, half_period=8)},
    ]
    assert complete["out_of_plane"] == {
        "points": [{**point_as_said(5), **balls(jacobi_constant=9)}, point_as_said(7)],
        "stable": [interval_as_said(3)],
        "undecided": [interval_as_said(4)],
        "gaps": [
            {"piece": "p015", "interval": ["-0x1p-1", "0x1p-2"], "about": {"k": 3, "j": 1}, "reason": "not looked at"}
        ],
    }


def test_a_list_that_is_not_proved_lists_nothing_and_the_reason_is_its_own() -> None:
    curve = conclude(atlas(), values(results()))
    refused = conclude(atlas(), values(results()[:1]))
    assert not refused.is_proved
    told = list_to_json(ListConclusion(curve, 4, refused.outcome), "")  # type: ignore[arg-type]
    assert told["verdict"] == "not proved"
    assert told["reason"] == reason_to_json(refused.outcome.reason)  # type: ignore[union-attr]
    empty = ("hypotheses", "points", "stable", "undecided", "gaps", "extrema", "open_extrema")
    assert told["complete"] == {**{name: [] for name in empty}, "order": 4}


def balls(**numbers: int) -> dict[str, Any]:
    return {name: ball_to_json(arb(number)) for name, number in numbers.items()}


def point_as_said(k: int) -> dict[str, Any]:
    return {
        "piece": "p014", "k": k, "j": 2, "kind": Kind.RESONANCE.value, **balls(s=1, level=2, half_period=3),
        "point": balls(beta=4), "certificates": ["a", "b"],
    }  # fmt: skip


def interval_as_said(number: int) -> dict[str, Any]:
    near = {
        "least_distance": ball_to_json(arb(4).sqrt()), "least_distance_at": "this point",
        "greatest_distance": ball_to_json(arb(9).sqrt()), "greatest_distance_at": "the other point",
    }  # fmt: skip
    begin = {
        "what": [CurveEnd.BEGINNING.value],
        "piece": "p014",
        "interval": ["-0x1p-2", format_exact(Fraction(number, 64))],
    }
    end = {
        "what": ["resonance"],
        "piece": "p015",
        "interval": ["0x1p-2", "0x1p-1"],
        **near,
        **balls(level=2, half_period=3),
    }
    return {"from": begin, "to": end, "between": {**near, **balls(half_period=number)}}


class OneHypothesis:
    hypotheses = ("piece",)


def asked_of(name: str, interval: tuple[Fraction, Fraction], **more: Any) -> dict[str, Any]:
    read = read_atlas(DATA / name)
    return {**question(read, read.pieces[0], interval, {"precision": 80, "order": 20}, True, None, 1), **more}


def test_stability_is_enclosed_as_the_piece_was_proved_and_on_the_interval_that_was(monkeypatch: Any) -> None:
    """On a symmetric piece that is a longer one than was asked for."""
    known_ = ProvedInterval(-QUARTER, QUARTER, (Fraction(1, 2**40),), (Fraction(1, 2**36),), arb(3))
    hypothesis = Hypothesis("piece", "", "15.2", True, {})
    proved = Proved(OneHypothesis(), known_, (hypothesis,))
    tubes: list[TubeOfOrbits] = []
    asked: list[dict[str, Any]] = []

    def prove(system: Any, parameters: Any, piece: Any, interval: Any, *rest: Any, **more: Any) -> Any:
        asked.append(more)
        return PieceResult(piece.id, interval, proved, Computation(1.5, 80, coordinates="regularised"))

    def stability(tube: TubeOfOrbits, *rest: Any) -> NotKnown:
        tubes.append(tube)
        return NotKnown(Reason("stability", "not here", ""))

    monkeypatch.setattr(interval_proof, "prove_piece", prove)
    monkeypatch.setattr(interval_proof, "stability_of_piece", stability)
    monkeypatch.setattr(interval_proof, "time", SimpleNamespace(process_time=count(100, 0.25).__next__))
    argument = asked_of("atlas-lyapunov.json", (Fraction(0), QUARTER), symmetry="S", crossings=3)
    answer = interval_proof.prove_task(argument, lambda fraction, label: None)
    (tube,) = tubes
    assert tube.interval == (-QUARTER, QUARTER)
    assert (tube.symmetry, tube.crossings, tube.coordinates) == ("S", 3, "regularised")
    assert (tube.limits.precision, tube.limits.order) == (80, 20)
    assert asked == [{"crossings": 3, "slope_bits": 56}]
    assert answer["interval"] == ["-0x1p-2", "0x1p-2"]
    assert answer["stability"] == {"reason": {"condition": "stability", "message": "not here", "remedy": ""}}
    assert answer["computation"]["seconds"] == 0.25
    del argument["stability"]
    assert "stability" not in interval_proof.prove_task(argument, lambda fraction, label: None)
    assert len(tubes) == 1


def test_parts_of_a_surface_that_are_asked_for_are_those_that_are_proved(monkeypatch: Any) -> None:
    handed: list[Any] = []

    def prove(*rest: Any) -> Any:
        handed.append(rest[7])
        raise ValueError("enough")

    monkeypatch.setattr(interval_proof, "prove_surface_piece", prove)
    parts = [["-0x1", "0x0"], ["0x0", "0x1"]]
    argument = asked_of("surface.json", (Fraction(-1), Fraction(1)), parts=parts)
    answer = interval_proof.prove_task(argument, lambda fraction, label: None)
    assert answer["reason"]["message"] == "broke off: ValueError: enough"
    assert handed == [[(-1, 0), (0, 1)]]


def test_all_that_is_known_of_an_interval_is_mirrored_for_minus_s() -> None:
    function = StoredFunction((Fraction(1), Fraction(2)), Fraction(1, 1024))
    parts = tuple(
        Extremes((Fraction(n), Fraction(n + 1)), (Fraction(n + 2), Fraction(n + 3)), Where.HERE, Where.THERE)
        for n in range(PARTS)
    )
    stored = StabilityFunctions(
        (function,), function, function, function, DistanceFunctions(function, function, parts),
        VariationFunctions(function, function, function, function),
    )  # fmt: skip
    here, there = (
        segment_of(0, (QUARTER, QUARTER, HALF), (QUARTER, HALF), stored, mirrored) for mirrored in (False, True)
    )
    assert [function.polynomial(HALF_BALL) for function in _functions(here)] == 10 * [arb(2)]
    assert [function.polynomial(HALF_BALL) for function in _functions(there)] == 10 * [arb(0)]
    assert here.distances is not None
    assert there.distances is not None
    for part, other in zip(here.distances.parts, reversed(there.distances.parts), strict=True):
        assert (part.lower, part.upper) == (-other.upper, -other.lower)
        for extreme, same in ((part.least, other.least), (part.greatest, other.greatest)):
            assert (extreme.square.mid(), extreme.where) == (same.square.mid(), same.where)


HALF_BALL = arb(0.5)


def _functions(segment: Segment) -> list[BoundedFunction]:
    distances, across = segment.distances, segment.out_of_plane
    assert distances is not None
    assert across is not None
    known_ = (segment.level, segment.half_period, segment.first_factor, distances.here, distances.there)
    return [*segment.characteristic, *known_, *across.entries]


def test_functions_of_an_interval_that_is_not_proved_do_not_count() -> None:
    """They would be preferred to those that are: no integration confirms them."""
    true = results()
    false = copy.deepcopy(true[0])
    false["computation"]["precision"] = 4096
    constant = {"coefficients": ["0x1p-1"], "error": "0x1p-90"}
    false["stability"]["characteristic"] = [constant]
    proved = listed([*true, false], 4)["complete"]
    assert proved != listed(true, 4)["complete"]
    reason = {"condition": "newton", "message": "there is no such orbit", "remedy": ""}
    false |= {"verdict": "not proved", "reason": reason}
    assert listed([*true, false], 4)["complete"] == listed(true, 4)["complete"]


def test_every_stored_function_is_compared_with_the_new_one() -> None:
    function, moved = (StoredFunction((Fraction(n),), Fraction(1, 1024)) for n in (1, 5))
    across = VariationFunctions(function, function, function, function)
    stored = StabilityFunctions((function,), function, function, function, None, across)
    assert not list(unconfirmed(stored, stored))
    for name, value in {
        "characteristic": (moved,),
        "level": moved,
        "half_period": moved,
        "first_factor": moved,
    }.items():
        changed: dict[str, Any] = {name: value}
        assert len(list(unconfirmed(replace(stored, **changed), stored))) == 1
    lacking = replace(stored, out_of_plane=None)
    assert list(unconfirmed(stored, lacking)) == ["variations out of the plane are not enclosed again"]
