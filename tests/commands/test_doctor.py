"""``orbitproof doctor``: tells what is installed, and fails if something that is installed does not work."""

from __future__ import annotations

import pytest

from orbitproof import doctor
from orbitproof.doctor import Finding, fits, found_base, found_extra, found_proofs, requirements


def test_the_small_proof_goes_through_and_the_false_claim_does_not() -> None:
    told = {finding.topic: finding for finding in found_proofs()}
    assert not any(finding.is_fault for finding in told.values())
    assert ", proved, below, beta = 340.1875349891435" in told["true claim"].words
    assert told["its check"].words == "stands"
    assert told["false claim"].words.startswith("not proved")


def test_a_missing_extra_is_no_fault_and_a_broken_one_is(monkeypatch: pytest.MonkeyPatch) -> None:
    missing = found_extra("oem", {"no-such-package": ">=1"})
    assert (missing.words, missing.is_fault) == ("not installed: pip install 'orbitproof[oem]'", False)
    monkeypatch.setitem(doctor._IMPORTS, "oem", "orbitproof.no_such_module")
    broken = found_extra("oem", {"numpy": ">=2"})
    assert broken.is_fault
    assert "ModuleNotFoundError" in broken.words


def test_a_base_that_is_missing_or_too_old_is_a_fault() -> None:
    assert not found_base({"numpy": ">=2"}).is_fault
    assert "no-such-package is missing" in found_base({"no-such-package": ""}).words
    assert "wanted >=99" in found_base({"numpy": ">=99"}).words
    assert found_base({"numpy": "<2"}).is_fault


@pytest.mark.parametrize(
    ("version", "wanted", "is_fit"),
    [("0.10.1", ">=0.9,<0.10", False), ("0.9.0", "<0.10,>=0.9", True), ("2024.8", ">=2024.8", True), ("1.2", "", True)],
)
def test_versions_are_compared_number_by_number(version: str, wanted: str, is_fit: bool) -> None:
    assert fits(version, wanted) is is_fit


def test_requirements_are_read_by_extra() -> None:
    lines = ["python-flint<0.10,>=0.9", 'jax>=0.9; extra == "explore"', "jax>=0.9 ; extra == 'dev'"]
    assert requirements(lines) == {
        "": {"python-flint": "<0.10,>=0.9"},
        "explore": {"jax": ">=0.9"},
        "dev": {"jax": ">=0.9"},
    }


@pytest.mark.parametrize("is_fault", [False, True])
def test_the_exit_code_says_whether_all_is_well(
    is_fault: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(doctor, "findings", lambda: iter([Finding("base", "FAULT: x is missing", is_fault)]))
    assert doctor.main([]) == int(is_fault)
    assert ("not all is well" in capsys.readouterr().out) is is_fault
