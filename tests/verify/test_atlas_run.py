"""Runs over an atlas: splitting, keeping, going on, and what comes of them, with provers that integrate nothing."""

from __future__ import annotations

import json
import os
import random
import sys
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import atlas_work
from support.atlas_runs import CURVE, LIMITS, ROOT, InOrder, go, refused, write
from support.chain_cases import symmetric_loop
from support.periodic_curves import turning_atlas
from support.stored import values

from orbitproof.shared import format_exact
from orbitproof.shared.processes import Answer, Task
from orbitproof.verify.certificate import read_certificate
from orbitproof.verify.run import Display, Processes, Work
from orbitproof.verify.run.branch_command import main
from orbitproof.verify.run.branch_tasks import RunLimits, all_attempts_of, attempts_of, for_slopes_of
from orbitproof.verify.run.branches import AtlasRun
from orbitproof.verify.run.splitting import Plan, covers, full_interval, halves, plan, with_closer_looks


@given(st.lists(st.booleans(), max_size=6))
def test_halves_cover_their_interval_and_overlap(turns: list[bool]) -> None:
    interval = (Fraction(-1), Fraction(1))
    for turn in turns:
        left, right = halves(interval)
        assert covers([left, right], interval)
        assert left[1] > right[0]
        assert interval[0] == left[0] < left[1] < right[1] == interval[1]
        interval = (left, right)[turn]


def test_intervals_with_a_gap_cover_nothing_beyond_it() -> None:
    half = Fraction(1, 2)
    assert covers([(half, Fraction(1)), (Fraction(0), half)], (Fraction(0), Fraction(1)))
    assert not covers([(Fraction(0), half), (half + Fraction(1, 10**30), Fraction(1))], (Fraction(0), Fraction(1)))
    assert not covers([], (Fraction(0), Fraction(1)))


def test_of_a_symmetric_piece_one_half_is_asked_for() -> None:
    atlas, _ = symmetric_loop()
    run, engine = go(atlas, atlas_work.proving)
    asked = dict(engine.asked)
    assert asked["p000"] == ("0x0", "0x1")
    assert asked["p001"] == ("-0x1", "0x1")
    assert not run.pending


def test_a_piece_that_fails_is_split_and_the_others_are_left_whole() -> None:
    run, engine = go(CURVE, atlas_work.short_only)
    # Both attempts at the whole and at its halves, one at their halves.
    assert [name for name, _ in engine.asked].count("p001") == 2 * (1 + 2) + 4
    assert [name for name, _ in engine.asked].count("p000") == 1
    assert run.plan_of("p001").is_proved
    assert covers([r.interval for r in run.results_of("p001") if r.is_proved], full_interval(CURVE.pieces[1]))
    proved = [result.interval for result in run.results_of("p001") if result.is_proved]
    assert all(left[1] > right[0] for left, right in pairwise(sorted(proved)))


@pytest.mark.parametrize("splits", [0, 1, 3])
def test_a_piece_is_given_up_at_the_first_interval_that_may_not_be_split(splits: int) -> None:
    run, engine = go(CURVE, atlas_work.not_the_second, RunLimits({}, None, splits))
    assert [name for name, _ in engine.asked].count("p001") == 2 * (splits + 1)
    assert run.plan_of("p001").failed
    assert not run.plan_of("p001").is_proved
    assert run.plan_of("p002").is_proved
    assert run.pending == []


def test_an_interval_across_a_bifurcation_is_not_split_and_not_tried_again(
    capsys: pytest.CaptureFixture[str],
) -> None:
    run, engine = go(CURVE, atlas_work.singular)
    assert [name for name, _ in engine.asked].count("p001") == 1
    assert run.plan_of("p001").failed
    assert not run.plan_of("p001").is_proved
    assert not go(CURVE, atlas_work.singular, earlier=run.results)[1].asked
    again = AtlasRun(CURVE, RunLimits({}))
    with (display := Display(dict.fromkeys(again.pending, 1.0), quiet=False)).shown():
        again.run(InOrder(), display, lambda results: None, atlas_work.singular)
    assert "a bifurcation is there; end the curve before it" in capsys.readouterr().err


def test_what_fails_on_a_curve_without_symmetry_is_told_with_its_parameter(capsys: pytest.CaptureFixture[str]) -> None:
    atlas = turning_atlas()
    run, engine = AtlasRun(atlas, RunLimits({}, None, 0)), InOrder()
    display = Display(dict.fromkeys(run.pending, 1.0), quiet=False)
    with display.shown():
        run.run(engine, display, lambda results: None, atlas_work.failing)
    value = float(atlas.curve_pieces()[0].point(Fraction(0))[0])
    assert f"not proved, near a = {value:.6g}, " in capsys.readouterr().err


def test_more_splits_go_on_where_fewer_ended() -> None:
    run, _ = go(CURVE, atlas_work.short_only, RunLimits({}, None, 1))
    assert not run.plan_of("p001").is_proved
    more, engine = go(CURVE, atlas_work.short_only, RunLimits({}, None, 2), run.results)
    assert more.plan_of("p001").is_proved
    assert ("p001", ("-0x1", "0x1")) not in engine.asked
    assert {name for name, _ in engine.asked} == {"p001"}


def test_a_proved_interval_counts_only_if_it_covers_what_is_asked() -> None:
    piece = CURVE.pieces[1]
    nearly = {"piece": "p001", "interval": ["-0x1", format_exact(1 - Fraction(1, 2**40))], "verdict": "proved"}
    assert plan(piece, values([nearly]), [{}], 3).missing == (((Fraction(-1), Fraction(1)), 0),)
    assert plan(piece, values([{**nearly, "interval": ["-0x1", "0x1"]}]), [{}], 3).is_proved


@pytest.mark.parametrize(
    "change", [{"piece": "p002"}, {"verdict": "not proved"}, {"time": "long"}, {"parts": []}, {"interval": ["x", "1"]}]
)
def test_an_answer_that_is_none_proves_nothing(change: dict[str, Any]) -> None:
    """Of another piece, with a verdict that does not fit, or not to be read."""
    run, _ = go(CURVE, lambda argument, report: {**atlas_work.proving(argument, report), **change})
    first = run.results_of("p000")[0]
    assert not first.is_proved
    assert first.reason is not None
    assert first.reason.condition == "process"
    assert not run.plan_of("p000").is_proved


def test_more_precision_is_tried_before_an_interval_is_split() -> None:
    run, engine = go(CURVE, atlas_work.precise_only)
    assert not run.pending
    assert [name for name, _ in engine.asked].count("p001") == 2
    precisions = [result.computation.precision for result in run.results_of("p001")]
    assert precisions[0] < precisions[1]
    assert run.plan_of("p001").is_proved


def test_intervals_that_are_halved_beforehand_are_not_tried_in_whole() -> None:
    piece = CURVE.pieces[1]
    whole = full_interval(piece)
    assert plan(piece, [], [{}], 3, halved=1).missing == tuple((half, 0) for half in halves(whole))
    assert plan(piece, [], [{}], 0, halved=1).missing == ((whole, 0),)
    proved = {"piece": "p001", "interval": ["-0x1", "0x1"], "verdict": "proved"}
    assert plan(piece, values([proved]), [{}], 3, halved=1).is_proved


def test_places_that_are_known_roughly_are_looked_at_once_on_short_intervals() -> None:
    whole = Fraction(-1), Fraction(1)
    attempts = [{"precision": 80}, {"precision": 128}]
    place, other = ((Fraction(n), Fraction(n) + Fraction(1, 64)) for n in (Fraction(1, 4), Fraction(1, 2)))

    def entry(interval: tuple[Fraction, Fraction], precision: int, verdict: str = "proved") -> dict[str, Any]:
        ends = [format_exact(end) for end in interval]
        reason = {} if verdict == "proved" else {"reason": {"condition": "newton", "message": "", "remedy": ""}}
        computation = {"precision": precision}
        return {"piece": "p001", "interval": ends, "verdict": verdict, "computation": computation, **reason}

    def looks(
        *entries: dict[str, Any], again: Sequence[tuple[Fraction, Fraction]] = ((Fraction(0), Fraction(1)),)
    ) -> Any:
        state = Plan((), ((other, 0),), ())
        wanted = {80: (place, (place[0], place[1] + Fraction(1, 64)), other), 128: again}
        return with_closer_looks(
            state, values(entries), lambda result: wanted[result.computation.precision], attempts
        ).missing

    assert looks(entry(whole, 80, "not proved")) == ((other, 0),)
    # The second is about the same place; what a closer look finds is not looked at again, nor what it failed to find.
    assert looks(entry(whole, 80)) == ((other, 0), (place, 1), (other, 1))
    for verdict in ("proved", "not proved"):
        assert looks(entry(whole, 80), entry(place, 128, verdict)) == ((other, 0), (other, 1))
    closer = place[0], place[0] + Fraction(1, 2048)
    assert looks(entry(place, 128), again=(closer,)) == ((other, 0), (closer, 1))
    assert looks(entry(place, 128, "not proved"), again=(closer,)) == ((other, 0),)
    assert looks(entry(place, 128), again=((place[0], place[0] + Fraction(1, 2**40)),)) == ((other, 0),)


def test_results_of_a_run_are_in_the_order_of_the_pieces_and_of_their_intervals() -> None:
    """However they came: of one interval those that came first are first."""
    atlas, results = symmetric_loop()
    chance = random.Random(0)
    ends = [("0x0", "0x1"), ("-0x1", "0x0"), ("-0x1p-1", "0x1p-1"), ("-0x1", "-0x1p-1"), ("0x0", "0x1")]
    entries = [
        {**entry, "interval": list(interval), "computation": {"precision": number, "seconds": 0.0}}
        for entry in results for number, interval in enumerate(ends)
    ]  # fmt: skip
    for _ in range(4):
        given = values(chance.sample(entries, len(entries)))
        found = AtlasRun(atlas, LIMITS, given).results
        places = [piece.id for piece in atlas.pieces]
        assert sorted(map(id, found)) == sorted(map(id, given))
        assert [(each.piece, each.interval) for each in found] == sorted(
            ((each.piece, each.interval) for each in given), key=lambda each: (places.index(each[0]), each[1])
        )
        for one, other in pairwise(found):
            if (one.piece, one.interval) == (other.piece, other.interval):
                assert given.index(one) < given.index(other)


def test_what_takes_too_long_is_split_at_once() -> None:
    piece = CURVE.pieces[1]
    late = {
        "piece": "p001", "interval": ["-0x1", "0x1"], "verdict": "not proved",
        "reason": {"condition": "time", "message": "", "remedy": ""}, "computation": {"precision": 80},
    }  # fmt: skip
    missing = plan(piece, values([late]), [{"precision": 80}, {"precision": 128}], 3).missing
    assert missing == tuple((half, 0) for half in halves(full_interval(piece)))


@pytest.mark.parametrize(("condition", "is_halved"), [("slope", True), ("newton", False)])
def test_an_unclear_slope_is_split_before_more_precision_is_tried(condition: str, is_halved: bool) -> None:
    piece = CURVE.pieces[1]
    unclear = {
        "piece": "p001", "interval": ["-0x1", "0x1"], "verdict": "not proved",
        "reason": {"condition": condition, "message": "", "remedy": ""}, "computation": {"precision": 80},
    }  # fmt: skip
    attempts = [{"precision": 80}, {"precision": 128}]
    whole = full_interval(piece)
    more_precision = ((whole, 1),)
    shorter = tuple((half, 0) for half in halves(whole))
    assert plan(piece, values([unclear]), attempts, 3).missing == (shorter if is_halved else more_precision)
    # Where nothing may be halved, precision is what is left.
    assert plan(piece, values([unclear]), attempts, 0).missing == more_precision


def test_second_derivatives_are_followed_where_first_ones_leave_a_slope_open(
    capsys: pytest.CaptureFixture[str],
) -> None:
    run, engine = AtlasRun(CURVE, RunLimits({})), InOrder()
    with (display := Display(dict.fromkeys(run.pending, 1.0), quiet=False)).shown():
        run.run(engine, display, lambda results: None, atlas_work.steep_only)
    assert "p001: again with second derivatives, not proved" in capsys.readouterr().err
    assert [name for name, _ in engine.asked].count("p001") == 2
    assert run.plan_of("p001").is_proved
    first, second = (result.computation for result in run.results_of("p001"))
    assert (first.top, second.top) == (1, 2)
    assert first.precision == second.precision
    (other,) = (result.computation for result in run.results_of("p000"))
    assert other.top == 1
    # Nothing of it is tried again by a run that goes on.
    assert not go(CURVE, atlas_work.steep_only, earlier=run.results)[1].asked


def test_who_begins_with_second_derivatives_is_not_given_third_ones() -> None:
    run, _ = go(CURVE, atlas_work.unclear, RunLimits({"top": 2}))
    assert {result.computation.top for result in run.results} == {2}
    assert run.plan_of("p001").is_proved


@pytest.mark.parametrize("work", [atlas_work.unclear, atlas_work.unclear_and_lost, atlas_work.unclear_and_failing])
def test_where_second_derivatives_fail_an_interval_is_halved_without_them(work: Work) -> None:
    run, _ = go(CURVE, work)
    tops = [result.computation.top for result in run.results_of("p001")]
    assert tops == [1, 2, 1, 1, 1, 1, 1, 1]
    assert run.plan_of("p001").is_proved


def test_the_loss_of_a_process_to_second_derivatives_is_no_reason_to_halve_without_end() -> None:
    run, _ = go(CURVE, atlas_work.unclear_and_lost, RunLimits({}, max_splits=1))
    attempts = [
        (result.computation.top, result.reason and result.reason.condition) for result in run.results_of("p001")
    ]
    assert attempts == [(1, "slope"), (2, "process"), (1, "slope"), (1, "slope")]
    assert run.plan_of("p001").is_settled
    assert not run.plan_of("p001").is_proved


def test_halves_have_second_derivatives_where_the_whole_has_them_in_vain_for_its_length() -> None:
    run, _ = go(CURVE, atlas_work.steep_halves)
    assert [result.computation.top for result in run.results_of("p001")] == [1, 2, 1, 2, 1, 2]
    assert run.plan_of("p001").is_proved


def test_settings_for_special_cases_come_after_the_others_and_closer_looks_last() -> None:
    """As a plan counts its attempts."""
    limits = RunLimits({}, stability=True, order=4, lasting=True)
    attempts = attempts_of(CURVE, limits)
    *others, across, closer = all_attempts_of(CURVE, limits)
    assert tuple(others) == attempts
    assert across == {**attempts[0], "top": 2}
    assert (closer["top"], closer["width"]) == (1, 12)
    plain = replace(limits, lasting=False)
    assert all_attempts_of(CURVE, plain)[len(attempts) :] == (for_slopes_of(attempts_of(CURVE, plain)),)
    assert all_attempts_of(CURVE, RunLimits({"top": 2})) == attempts_of(CURVE, RunLimits({"top": 2}))


def test_results_of_the_attempt_with_second_derivatives_count_in_the_next_run(tmp_path: Path) -> None:
    target = tmp_path / "curve.json"
    given = [write(tmp_path / "atlas.json"), "-o", str(target), "--max-splits", "0", "--quiet"]
    assert main(given, atlas_work.unclear) == 1
    before = target.read_text()
    results = read_certificate(target, "atlas-certificate").results
    assert [result.computation.top for result in results] == [1, 1, 2, 1, 1]
    assert main(given, atlas_work.proving) == 1
    assert json.loads(target.read_text())["results"] == json.loads(before)["results"]


def test_an_engine_asks_for_more_after_every_answer() -> None:
    """Tasks that exist only because of an answer are done too, also by processes that had become idle."""
    waiting = [Task("p001", task_argument("p001"))]
    names: list[str] = []

    def source() -> Task | None:
        return waiting.pop() if waiting else None

    def finished(answer: Answer) -> None:
        names.append(answer.task.name)
        if len(names) == 1:
            waiting.extend(Task(name, task_argument(name)) for name in ("a", "b", "c"))

    Processes(2).run(atlas_work.proving, source, lambda *_: None, finished)
    assert names[0] == "p001"
    assert sorted(names[1:]) == ["a", "b", "c"]


def task_argument(name: str) -> dict[str, Any]:
    return {"piece": {"id": name, "tube": ["1"]}, "interval": ["-0x1", "0x1"], "integrator": {}}


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_cluster_gives_the_same_certificate_as_processes(tmp_path: Path, capsys: Any) -> None:
    import distributed

    sys.path.insert(0, str(ROOT / "tests"))
    source = write(tmp_path / "atlas.json")
    options = {"n_workers": 2, "threads_per_worker": 2, "dashboard_address": ":0", "silence_logs": 50}
    with distributed.LocalCluster(**options) as cluster:
        address = cluster.scheduler_address
        assert main([source, "-o", str(tmp_path / "a.json"), "--scheduler", address], atlas_work.short_only) == 0
        assert main([source, "-o", str(tmp_path / "c.json"), "--scheduler", address], atlas_work.dying) == 1
    assert main([source, "-o", str(tmp_path / "b.json"), "--jobs", "2"], atlas_work.short_only) == 0
    by_cluster, by_processes = (json.loads((tmp_path / name).read_text()) for name in ("a.json", "b.json"))
    assert by_cluster == by_processes
    lost = [r for r in read_certificate(tmp_path / "c.json", "atlas-certificate").results if not r.is_proved]
    assert [result.piece for result in lost] == ["p001"]
    assert "the cluster has no result for it (KilledWorker)" in str(lost[0].reason and lost[0].reason.message)


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_cluster_without_workers_or_with_other_software_is_refused(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    import distributed

    source = write(tmp_path / "atlas.json")
    options = {"threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    with distributed.LocalCluster(n_workers=0, **options) as cluster:
        assert "has no workers" in refused(capsys, source, "--scheduler", cluster.scheduler_address)
    with distributed.LocalCluster(n_workers=1, **options) as cluster:
        monkeypatch.setattr("orbitproof.verify.run.cluster.software", lambda: {"source": f"of process {os.getpid()}"})
        assert "install the same version everywhere" in refused(
            capsys, source, "--scheduler", cluster.scheduler_address
        )


def test_an_interval_on_which_a_list_is_open_is_tried_again_and_halved() -> None:
    """Twice as narrow, then with more precision, then narrower once more; in the end what is proved counts."""
    piece = CURVE.pieces[1]
    attempts = [{"precision": 80}, {"precision": 128}]

    def entry(interval: tuple[str, str], precision: int) -> dict[str, Any]:
        computation = {"precision": precision, "seconds": 0.0}
        return {"piece": piece.id, "interval": list(interval), "verdict": "proved", "computation": computation}

    def left(results: list[dict[str, Any]], condition: str, settled: int = 0) -> Any:
        return plan(
            piece, values(results), attempts, 6, lambda result: "" if result in results[:settled] else condition
        )

    whole_one = [entry(("-1", "1"), 80)]
    assert left(whole_one, "", 1).is_proved
    first, second = halves((Fraction(-1), Fraction(1)))
    assert left(whole_one, "zeros").missing == left(whole_one, "stability").missing == ((first, 0), (second, 0))
    narrower = entry((format_exact(first[0]), format_exact(first[1])), 80)
    assert left([*whole_one, narrower], "zeros").missing == ((first, 1), (second, 0))
    assert plan(piece, values(whole_one), attempts, 0, lambda _: "zeros").missing == (((Fraction(-1), Fraction(1)), 1),)
    results = [entry(("-1", "1"), precision) for precision in (80, 128)]
    for interval in (first, second, *halves(first), *halves(second)):
        names = (format_exact(interval[0]), format_exact(interval[1]))
        results += [entry(names, precision) for precision in (80, 128)]
    assert left(results, "zeros").is_proved
    assert left(results, "zeros").missing == ()


def test_parts_that_are_proved_change_nothing_about_what_is_tried_on_the_whole() -> None:
    """A part that failed is halved on and on, whether or not a list is open on its halves already."""
    piece, settings = CURVE.pieces[1], {"precision": 80}

    def entry(interval: Any, reason: str = "") -> dict[str, Any]:
        told = {"verdict": "not proved", "reason": {"condition": reason, "message": "", "remedy": ""}}
        computation = {**settings, "seconds": 0.0}
        verdict = told if reason else {"verdict": "proved"}
        return {"piece": piece.id, "interval": list(map(format_exact, interval)), "computation": computation, **verdict}

    first, second = halves(full_interval(piece))
    quarter, other = halves(first)
    parts = halves(quarter)
    failed = [entry(interval, "section") for interval in (full_interval(piece), first, quarter)]
    for known in ([*failed, *map(entry, parts)], [*map(entry, parts), *failed]):
        state = plan(piece, values(known), [settings, {"precision": 128}], 4, lambda _: "zeros")
        assert state.missing == ((parts[0], 1), (parts[1], 1), (other, 0), (second, 0))
