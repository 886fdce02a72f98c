"""Limits of time count what a process uses of the processors, whatever else the machine does."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from types import SimpleNamespace

import pytest
from support.claims import known
from support.runs import SEES_PROCESSES, wait_until
from support.stability_cases import atlas

from orbitproof.shared import allowance
from orbitproof.shared.allowance import Allowance, processor_seconds
from orbitproof.verify.branches import interval_proof
from orbitproof.verify.certificate import Limits, certify, certifying
from orbitproof.verify.run.branch_tasks import RunLimits, attempts_of, task_of
from orbitproof.verify.run.splitting import full_interval

LIMIT = 10.0


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """One whose clock and whose process go as a test says; `used` is `None` where the system does not tell."""
    state = SimpleNamespace(now=1000.0, used=3.0)
    monkeypatch.setattr(allowance.time, "monotonic", lambda: state.now)
    monkeypatch.setattr(allowance, "processor_seconds", lambda process: state.used)
    return state


def over_after(machine: SimpleNamespace, share: float, step: float = 0.2) -> float:
    """Seconds until the time of a process is over that has this share of a processor."""
    allowed, start = Allowance(1, LIMIT), machine.now
    while not allowed.is_over():
        assert machine.now - start < 1e5
        machine.now += step
        machine.used = None if machine.used is None else machine.used + share * step
    return float(machine.now - start)


@pytest.mark.parametrize("share", [1.0, 0.1, 0.001])
def test_a_process_on_a_busy_machine_has_its_time_all_the_same(share: float, machine: SimpleNamespace) -> None:
    assert over_after(machine, share) == pytest.approx(LIMIT / share, rel=0.05)


def test_a_process_that_waits_for_nothing_is_over_too(machine: SimpleNamespace) -> None:
    assert over_after(machine, 0.0) == pytest.approx(LIMIT, rel=0.05)
    machine.used = None
    assert over_after(machine, 0.0) == pytest.approx(LIMIT, rel=0.05)


def test_time_in_which_nobody_looked_does_not_count(machine: SimpleNamespace) -> None:
    """Whoever looks was stopped, and the process with it."""
    assert over_after(machine, 0.0, step=1000.0) > LIMIT * 1000 / 2


@pytest.mark.skipif(not SEES_PROCESSES, reason="the system tells it otherwise, or not")
def test_what_another_process_has_used_is_told() -> None:
    busy = "x = 0\nwhile True: x += 1"
    with subprocess.Popen([sys.executable, "-c", busy]) as process:
        try:
            wait_until(lambda: (processor_seconds(process.pid) or 0.0) > 0.5)
        finally:
            process.kill()
    assert processor_seconds(process.pid) is None
    before = processor_seconds(os.getpid())
    assert before is not None
    assert before == pytest.approx(time.process_time(), abs=0.5)


def slow(clock: Callable[[], float]) -> Callable[[], float]:
    """A clock a thousand times as fast: that of a machine on which hours go by."""
    return lambda: 1000 * clock()


def test_no_proof_looks_at_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (certifying, interval_proof):
        clock = SimpleNamespace(monotonic=slow(time.monotonic), time=slow(time.time), process_time=lambda: 0.0)
        monkeypatch.setattr(module, "time", clock)
    certificate = certify(known("fs3"), Limits(max_precision=256, timeout=0.1))
    assert certificate.proved
    limits = RunLimits({}, timeout=0.1)
    piece = atlas().curve_pieces()[0]
    task = task_of(atlas(), piece, full_interval(piece), attempts_of(atlas(), limits)[0], limits, 16)
    assert interval_proof.prove_task(task.argument, lambda fraction, label: None)["verdict"] == "proved"
