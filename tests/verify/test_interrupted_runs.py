"""Neither an interruption nor the order in which results come changes what a run over an atlas proves."""

from __future__ import annotations

import json
import random
import signal
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import atlas_work, lasting_work
from support.atlas_runs import CURVE, ROOT
from support.chain_cases import symmetric_loop
from support.runs import SEES_PROCESSES, untimed, wait_until
from support.runs import started as process
from support.stability_cases import atlas as falkner_skan
from support.stored import values

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.formats import read_atlas, write_atlas
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.processes import Answer, Progress, Source
from orbitproof.verify.branches import Result
from orbitproof.verify.certificate import read_certificate
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.run import Display, Engine, Work, Workplace, branches, piece_order
from orbitproof.verify.run.branch_tables import piece_table
from orbitproof.verify.run.branch_tasks import RunLimits
from orbitproof.verify.run.branches import AtlasRun, conclude_run, limits_of, prove_pieces, started
from orbitproof.verify.run.processes import Finished
from orbitproof.verify.run.splitting import Interval, Plan, plan, with_closer_looks


@dataclass(frozen=True)
class Disturbed:
    """An engine without processes: up to `jobs` tasks at a time, answered in a random order, `most` and no more."""

    source: random.Random
    jobs: int
    most: int

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        under_way: list[Any] = []
        for number in count():
            while len(under_way) < self.jobs and (task := source()) is not None:
                under_way.append(task)
            if not under_way:
                return
            if number == self.most:
                raise KeyboardInterrupt
            task = under_way.pop(self.source.randrange(len(under_way)))
            finished(Answer(task, json.loads(json.dumps(work(task.argument, lambda fraction, label: None))), 0.25))


class DisturbedPlace(Workplace):
    """Where tasks are done so."""

    def __init__(self, engine: Disturbed) -> None:
        super().__init__(quiet=True)
        object.__setattr__(self, "_engine", engine)

    def engine(self, timeout: float | None, memory: int | None = None) -> AbstractContextManager[Engine]:
        return nullcontext(self._engine)  # type: ignore[attr-defined]


def made(
    path: Path, atlas: Any, limits: RunLimits, work: Work, source: random.Random | None = None, most: int = 10**9
) -> str:
    """The file of a run that is interrupted after `most` answers and goes on, as often as need be.

    With a `source` of random numbers it has up to three tasks at a time, answered in any order.
    """
    for _ in range(100):
        run = started(atlas, limits, path)
        jobs = 1 if source is None else source.randint(1, 3)
        most = most if source is None else source.randint(0, 4)
        try:
            prove_pieces(run, DisturbedPlace(Disturbed(source or random.Random(0), jobs, most)), work)
        except KeyboardInterrupt:
            assert run.pending
        else:
            assert not run.pending
            return path.read_text()
    raise AssertionError("no end of it")


@pytest.fixture(autouse=True)
def _any_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which piece comes first is no matter here, and not asked of an integration each time."""
    monkeypatch.setattr(piece_order, "steps_about", lambda system, points, *_: [0] * len(points))


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is left open on an interval is looked for once, by its settings: the same work finds the same there."""
    for name in ("open_on", "twist_open_on", "exceptions_to_sharpen"):
        monkeypatch.setattr(branches, name, _once(getattr(branches, name)))


def _once(function: Callable[..., Any]) -> Callable[..., Any]:
    known: dict[Any, Any] = {}

    def found(piece: Any, result: Result, *more: Any) -> Any:
        key = piece.id, result.interval, str(result.computation)
        if key not in known:
            known[key] = function(piece, result, *more)
        return known[key]

    return found


@cache
def _lasting(text: str) -> Any:
    return lasting_work.proving(json.loads(text), lambda fraction, label: None)


def lasting(argument: Any, report: Any) -> Any:
    """`lasting_work.proving`, once for each argument."""
    asked = {key: value for key, value in argument.items() if key != "expected_steps"}
    return _lasting(json.dumps(asked, sort_keys=True))


@pytest.mark.usefixtures("quick")
def test_an_interrupted_run_for_lasting_ends_as_an_undisturbed_one(tmp_path: Path) -> None:
    """Interrupted after each single answer, and with several tasks at a time in any order."""
    atlas = falkner_skan()
    limits = limits_of(atlas, 4, lasting=True)
    undisturbed = made(tmp_path / "a.json", atlas, limits, lasting)
    results = read_certificate(tmp_path / "a.json", "atlas-certificate").results
    looks = [result for result in results if result.computation.width == lasting_work.LOOK]
    # Both halves of a piece know one place roughly, and one look is in vain.
    assert [sum(result.is_proved == proved for result in looks) for proved in (True, False)] == [6, 1]
    assert made(tmp_path / "b.json", atlas, limits, lasting, most=1) == undisturbed
    for seed in range(12):
        assert made(tmp_path / f"{seed}.json", atlas, limits, lasting, random.Random(seed)) == undisturbed


@pytest.mark.usefixtures("quick")
def test_a_closer_look_that_leaves_open_what_a_wider_interval_decides_does_not_count(tmp_path: Path) -> None:
    """Of two results over the same s that of the shorter interval counts."""
    atlas = falkner_skan()
    path = tmp_path / "curve.json"
    limits = limits_of(atlas, 4, lasting=True)
    made(path, atlas, limits, lasting)
    run = started(atlas, limits, path)
    assert not run.pending
    certificate = conclude_run(run, (), Workplace(quiet=True))
    assert certificate.proved
    assert certificate.is_whole
    known = certificate.document["conclusion"]["complete"]["lasting"]["exceptions"]
    assert [entry["piece"] for entry in known if entry["kind"] == "twistless"] == ["p014", "p015"]


@pytest.mark.usefixtures("quick")
def test_what_is_left_out_for_want_of_time_is_told_and_tried_by_the_next_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def in_haste(argument: Any, report: Any) -> Any:
        if argument["integrator"]["width"] == lasting_work.LOOK and argument["piece"]["id"] == "p015":
            return {
                **atlas_work.failing(argument, report),
                "reason": {"condition": "time", "message": "", "remedy": ""},
            }
        return lasting(argument, report)

    atlas, path = falkner_skan(), tmp_path / "curve.json"
    limits = limits_of(atlas, 4, lasting=True)
    made(path, atlas, limits, in_haste)
    run = started(atlas, limits, path)
    # Of a file that is read what came to no end is tried again.
    assert run.pending == ["p015"]
    run = AtlasRun(atlas, limits)
    run.run(Disturbed(random.Random(0), 1, 10**9), Display({"p014": 1.0, "p015": 1.0}, False), lambda _: None, in_haste)
    line = "p015: proved in 2 intervals; not looked at to the end, for want of time or memory: s in [-0.7243"
    assert line in capsys.readouterr().err
    assert "\np015: not looked at to the end, for want of time" in piece_table(run)
    assert run.left_out("p014") == ""
    undisturbed = made(tmp_path / "a.json", atlas, limits, lasting)
    assert made(path, atlas, limits, lasting) == undisturbed


def test_an_interrupted_run_for_a_list_ends_as_an_undisturbed_one(tmp_path: Path) -> None:
    def listing(argument: Any, report: Any) -> Any:
        return {key: value for key, value in lasting(argument, report).items() if key != "twist"}

    atlas, limits = falkner_skan(), RunLimits({}, stability=True, order=12)
    undisturbed = made(tmp_path / "a.json", atlas, limits, listing)
    for seed in range(2):
        assert made(tmp_path / f"{seed}.json", atlas, limits, listing, random.Random(seed)) == undisturbed


def results_of(atlas: Any, work: Work, source: random.Random | None = None) -> list[str]:
    """As `made`, without a file."""
    limits, results = RunLimits({}), []
    while True:
        run = AtlasRun(atlas, limits, results)
        jobs, most = (1, 10**9) if source is None else (source.randint(1, 3), source.randint(0, 4))
        display = Display(dict.fromkeys(run.pending, 1.0), quiet=True)
        try:
            run.run(Disturbed(source or random.Random(0), jobs, most), display, lambda results: None, work)
        except KeyboardInterrupt:
            results = run.results
        else:
            assert not run.pending
            return [json.dumps(to_json(result)) for result in run.results]


@pytest.mark.parametrize(
    "work",
    [
        *(atlas_work.proving, atlas_work.short_only, atlas_work.precise_only, atlas_work.steep_only),
        *(atlas_work.steep_halves, atlas_work.unclear, atlas_work.unclear_and_failing),
    ],
)
def test_an_interrupted_run_over_a_curve_ends_as_an_undisturbed_one(work: Work) -> None:
    for atlas in (CURVE, symmetric_loop()[0]):
        undisturbed = results_of(atlas, work)
        for seed in range(4):
            assert results_of(atlas, work, random.Random(seed)) == undisturbed


def test_an_interrupted_run_over_a_surface_ends_as_an_undisturbed_one() -> None:
    """Longer intervals are not proved, some for want of precision."""
    folder = ROOT / "tests" / "data"
    atlas = read_atlas(folder / "surface-light.json")
    known = {entry["piece"]: entry for entry in json.loads((folder / "surface-light-results.json").read_text())}

    def work(argument: Any, report: Any) -> Any:
        interval = list(argument["interval"])
        low, high = (parse_exact(end) for end in interval)
        if high - low > Fraction(1, 2) or (low > 0 and argument["integrator"]["precision"] < 100):
            return atlas_work.failing(argument, report)
        entry = known[argument["piece"]["id"]]
        parts = {"parts": [{**entry["parts"][0], "interval": interval}]} if "parts" in entry else {}
        computation = {**entry["computation"], **argument["integrator"]}
        return {**entry, "interval": interval, "computation": computation, **parts}

    undisturbed = results_of(atlas, work)
    assert sum(json.loads(text)["verdict"] == "proved" for text in undisturbed) > 4
    for seed in range(4):
        assert results_of(atlas, work, random.Random(seed)) == undisturbed


@pytest.mark.slow
@pytest.mark.skipif(not SEES_PROCESSES, reason="looks for processes in /proc")
def test_an_integration_that_is_interrupted_ends_as_an_undisturbed_one(tmp_path: Path) -> None:
    """By signals to the command as a user gives it, after its first, second and third result."""
    source, files = tmp_path / "atlas.json", [tmp_path / name for name in ("a.json", "b.json")]
    write_atlas(source, falkner_skan())
    words = ["-m", "orbitproof.verify", "atlas", str(source), "--complete", "4", "--lasting", "--max-splits", "2"]
    for path, signals in zip(files, ((), ("SIGTERM", "SIGINT", "SIGHUP")), strict=True):
        for number, sent in enumerate(signals, 1):
            with process([*words, "-o", str(path), "--jobs", "2"]) as run:
                wait_until(lambda path=path, number=number: path.exists() and count_of(path) >= number, 1800.0)
                run.send_signal(getattr(signal, sent))
                assert run.wait(60) == INTERRUPTED
        with process([*words, "-o", str(path), "--jobs", "2"]) as run:
            run.communicate(timeout=3600)
            assert run.returncode in (0, 1)
    first, second = map(untimed, files)
    assert first == second


def count_of(path: Path) -> int:
    return len(json.loads(path.read_text())["results"])


# Plans


ATTEMPTS = ({"precision": 80, "top": 1}, {"precision": 128, "top": 1})
ACROSS, LOOK = {"precision": 80, "top": 2}, {"precision": 144, "top": 1}
OUTCOMES = ("proved", "proved", "zeros", "zeros", "stability", "newton", "slope", "section", "singular", "process")


class Nature:
    """What is found on each interval with each settings, and what is left to be looked at; fixed by a seed."""

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def _chance(self, *about: object) -> random.Random:
        return random.Random(f"{self._seed} {about}")

    def found(self, interval: Interval, given: dict[str, int]) -> tuple[dict[str, Any], str]:
        """The JSON of a result, and what it lacks if it is proved."""
        chance = self._chance(interval, sorted(given.items()))
        # Where longer intervals fail, and shorter ones leave something open.
        if self._chance().random() < 0.5:
            outcomes = OUTCOMES[:5] if interval[1] - interval[0] < self._chance().random() else ("section", "newton")
            outcome = chance.choice(outcomes)
        else:
            outcome = chance.choice(OUTCOMES if chance.random() < 0.1 else OUTCOMES[:8])
        ends = [format_exact(end) for end in interval]
        entry = {"piece": "p001", "interval": ends, "verdict": "proved", "computation": {**given, "seconds": 0.0}}
        if outcome in ("proved", "zeros", "stability"):
            return entry, "" if outcome == "proved" else outcome
        reason = {"condition": outcome, "message": "", "remedy": ""}
        return {**entry, "verdict": "not proved", "reason": reason}, ""

    def wanted(self, result: Result) -> list[Interval]:
        """Short intervals about places that both halves may know, and about others."""
        low, high = result.interval
        chance = self._chance("wanted", result.interval, result.computation.precision)
        places = [Fraction(self._chance("place", n).randrange(-64, 64), 64 if n else 2**12) for n in range(3)]
        size = (high - low) * Fraction(1, chance.choice((16, 32, 512)))
        return [(max(low, place - size), min(high, place + size)) for place in places if low < place < high]


def ended(nature: Nature, order: random.Random, halved: int, begin: Sequence[Any] = (), most: int = 10**9) -> Any:
    """The results of a piece as they are in the end, or after `most` of them, and what is left to do."""
    results, attempts = list(begin), (*ATTEMPTS, ACROSS, LOOK)
    begun: set[Any] = set()
    under_way: list[Any] = []
    while True:
        state = left(nature, results, halved)
        under_way += [task for task in state.missing if task not in begun]
        begun |= set(state.missing)
        if not under_way or len(results) >= most:
            return results, state
        interval, attempt = under_way.pop(order.randrange(min(2, len(under_way))))
        results.append(nature.found(interval, attempts[attempt]))


def left(nature: Nature, results: Sequence[Any], halved: int) -> Plan:
    known = values([entry for entry, _ in results])
    lacks = {id(value): lack for value, (_, lack) in zip(known, results, strict=True)}
    state = plan(CURVE.pieces[1], known, ATTEMPTS, 4, lambda result: lacks[id(result)], halved, ACROSS)
    wanted: Callable[[Result], Any] = lambda result: [] if lacks[id(result)] else nature.wanted(result)  # noqa: E731
    return with_closer_looks(state, known, wanted, (*ATTEMPTS, ACROSS, LOOK))


def text_of(results: Sequence[Any]) -> list[str]:
    return sorted(json.dumps(entry) for entry, _ in results)


@given(st.integers(0, 10**6), st.randoms(use_true_random=False), st.integers(0, 1), st.integers(0, 12))
@settings(max_examples=50, deadline=None)
def test_a_plan_comes_to_the_same_in_whatever_order_results_come(
    seed: int, order: random.Random, halved: int, most: int
) -> None:
    nature = Nature(seed)
    first, state = ended(nature, random.Random(0), halved)
    begun, _ = ended(nature, order, halved, (), most)
    order.shuffle(begun)
    second, other = ended(nature, order, halved, begun)
    # Of a piece that is given up more may be known, of what was under way then.
    assert state.failed[:1] == other.failed[:1]
    if state.is_proved:
        assert state.proved == other.proved
        assert text_of(first) == text_of(second)
