"""Whatever goes wrong inside the verifier, its row is not proved with that reason, and the other rows go on."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import Any

import pytest
from flint import ctx
from support.claims import known
from support.faulty_worker import EXCEPTIONS, certify_task

import orbitproof.verify.run.rows
from orbitproof.shared import processes
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify, recheck
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import enclose_iterates
from orbitproof.verify.run.rows import certify_all

CERTIFY = import_module("orbitproof.verify.certificate.certifying")
RECHECK = import_module("orbitproof.verify.certificate.rechecking")

TRUE = known("fs2")
FAULTS = [*EXCEPTIONS.values(), ZeroDivisionError, OverflowError, KeyError, StopIteration]


def raising(fault: type[BaseException]) -> Callable[..., Any]:
    def broken(*_: Any, **__: Any) -> Any:
        raise fault("something\nunforeseen")

    return broken


def breaking_off(certificate: Certificate, stage: str, fault: type[BaseException]) -> None:
    assert certificate.verdict == "not proved"
    assert certificate.parameter is None
    reason = certificate.reason
    assert reason is not None
    assert reason.condition == stage
    assert reason.message == f"the {stage} broke off: {fault.__name__}: something unforeseen" or fault is KeyError
    assert reason.remedy
    assert ctx.prec == 53


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_the_integration_is_not_a_proof(fault: type[Exception]) -> None:
    certificate = certify(TRUE, Limits(), integrate=raising(fault))
    breaking_off(certificate, "integration", fault)
    assert [entry.name for entry in certificate.hypotheses] == ["symmetries", "frames"]


@pytest.mark.parametrize(
    ("name", "stage"),
    [
        ("check_exactly", "exact checks"),
        ("prove", "evaluation"),
        ("kind_of", "verification"),
        ("more_precision", "verification"),
        ("make_certificate", "verification"),
    ],
)
@pytest.mark.parametrize("fault", [MemoryError, TypeError, ValueError])
def test_a_fault_anywhere_else_is_not_a_proof(
    name: str, stage: str, fault: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    original, calls = getattr(CERTIFY, name), 0

    def once(*arguments: Any) -> Any:
        nonlocal calls
        calls += 1
        return raising(fault)() if calls == 1 else original(*arguments)

    monkeypatch.setattr(CERTIFY, name, once)
    breaking_off(certify(TRUE, Limits()), stage, fault)


def test_a_fault_with_more_precision_leaves_the_proof_at_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    precisions = []
    monkeypatch.setattr("orbitproof.verify.attempt.precision.count_certain_digits", lambda ball: 0)

    def broken_at_more(candidate: Any, settings: Any, report: Any) -> Any:
        precisions.append(settings.precision)
        if len(precisions) > 1:
            raise MemoryError
        return enclose_iterates(candidate, settings, ORACLE, report)

    certificate = certify(TRUE, Limits(), integrate=broken_at_more)
    assert certificate.proved
    assert certificate.computation.precision == precisions[0] < precisions[1]


@pytest.mark.parametrize("stop", [KeyboardInterrupt, SystemExit])
def test_an_interrupt_is_not_a_fault(stop: type[BaseException]) -> None:
    with pytest.raises(stop):
        certify(TRUE, Limits(), integrate=raising(stop))


def run(ids: list[str], jobs: int, timeout: float | None = None) -> dict[str, Certificate]:
    rows: list[Certificate] = []
    certify_all([replace(TRUE, id=id) for id in ids], Limits(timeout=timeout), jobs, lambda *_: None, rows.append)
    assert multiprocessing.active_children() == []
    assert len(rows) == len(ids)
    return {row.id: row for row in rows}


@pytest.mark.usefixtures("fresh_workers")
@pytest.mark.parametrize("jobs", [1, 2])
def test_a_fault_in_a_worker_costs_its_row_only(
    jobs: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(orbitproof.verify.run.rows, "certify_task", certify_task)
    rows = run([*EXCEPTIONS, "FLINT", "sound"], jobs)
    for name in EXCEPTIONS:
        assert rows[name].reason.condition == "integration"
        assert rows[name].reason.message == f"the integration broke off: {name}"
    assert rows["FLINT"].reason.condition == "process"
    assert "exit code -" in rows["FLINT"].reason.message
    assert rows["sound"].verdict == "proved"
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.usefixtures("little_grace")
def test_a_step_that_never_ends_is_ended_at_the_time_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(orbitproof.verify.run.rows, "certify_task", certify_task)
    rows = run(["endless", "sound"], 1, timeout=3.0)
    reason = rows["endless"].reason
    assert reason.condition == "time"
    assert "the time limit of 3 s passed within one step" in reason.message
    assert rows["endless"].computation.seconds >= 3.0 + processes.GRACE_SECONDS
    assert rows["sound"].verdict == "proved"


def test_what_cannot_be_checked_again_does_not_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    certificate = certify(TRUE, Limits())
    assert recheck(certificate).stands
    for name in ("level_form", "prove", "enclose"):
        with monkeypatch.context() as patch:
            patch.setattr(RECHECK, name, raising(MemoryError))
            result = recheck(certificate, integrate=True)
        # There is no level form in this certificate.
        assert result.stands == (name == "level_form")
        assert all("MemoryError" in finding.message for finding in result.findings)


@pytest.mark.parametrize(
    "limits",
    [{"max_precision": 0}, {"max_precision": -64}, {"max_precision": 10**9}, {"digits": 0}, {"timeout": 0.0},
     {"timeout": -1.0}, {"timeout": float("nan")}, {"timeout": float("inf")}, {"level": "energy"}],
)  # fmt: skip
def test_limits_that_make_no_sense_are_refused(limits: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(limits))):
        Limits(**limits)
