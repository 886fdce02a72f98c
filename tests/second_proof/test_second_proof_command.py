"""The command of the second proof: files, exit codes, going on, interrupts, and workers that end early."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from pathlib import Path
from typing import Any

import pytest
from support.runs import SEES_PROCESSES, is_running, started, wait_until, workers

from orbitproof.verify.__main__ import main
from orbitproof.verify.run import second_proofs

DATA = Path(__file__).parents[1] / "data" / "figures-certificates.json"
DOUBLING, TOUCHING, LONG = "falkner-skan-odd-k2-1", "falkner-skan-odd-k3-1", "earth-moon-L1-halo-k1-1"


def write(path: Path, *names: str, **claim: Any) -> Path:
    """Certificates of these names, their claims changed."""
    content = json.loads(DATA.read_text(encoding="utf-8"))
    content["certificates"] = [entry for entry in content["certificates"] if entry["id"] in names]
    for entry in content["certificates"]:
        entry["statement"]["candidate"].update(claim)
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


@pytest.fixture
def certificates(tmp_path: Path) -> Path:
    """Two rows that end at once, since no theorem is about them."""
    return write(tmp_path / "certificates.json", DOUBLING, TOUCHING, kind="symmetry_breaking")


def rows(path: Path) -> dict[str, dict[str, Any]]:
    return {row["id"]: row for row in json.loads(path.read_text(encoding="utf-8"))["rows"]}


def prove(*words: object) -> int:
    return main(["--second-proof", *map(str, words)])


def test_rows_are_saved_and_kept(certificates: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "second-proofs.json"
    assert prove(certificates, "-o", output, "--jobs", "2") == 1
    text, progress = capsys.readouterr()
    assert text.count("no theorem") == 2
    assert "[2/2]" in progress
    assert "left" in progress
    assert len(rows(output)) == 2
    assert prove(certificates, "-o", output) == 1
    assert "2 of 2 rows are there already" in capsys.readouterr().err
    content = json.loads(certificates.read_text(encoding="utf-8"))
    content["certificates"][0]["statement"]["candidate"]["k"] = 6
    certificates.write_text(json.dumps(content), encoding="utf-8")
    assert prove(certificates, "-o", output) == 1
    progress = capsys.readouterr().err
    assert "1 of 2 rows are there already" in progress
    assert "[1/1]" in progress, "only the row that changed is tried again"
    assert prove(certificates, "-o", output, "--only", DOUBLING, "--fresh") == 1
    assert "[1/1]" in capsys.readouterr().err
    assert set(rows(output)) == {DOUBLING, TOUCHING}, "a row that was not named is gone"


@pytest.mark.slow
def test_rows_that_agree_are_a_success(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, output = write(tmp_path / "certificates.json", DOUBLING, TOUCHING), tmp_path / "second-proofs.json"
    assert prove(source, "-o", output) == 0
    assert capsys.readouterr().out.count("agrees") == 2
    assert {row["verdict"] for row in rows(output).values()} == {"agrees"}


def test_bad_input_is_named(certificates: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    broken = tmp_path / "broken.json"
    content = json.loads(write(broken, DOUBLING, TOUCHING).read_text(encoding="utf-8"))
    content["certificates"][1]["statement"]["section"] = "w"
    for text, word in (
        ("{", "broken.json"),
        ("[]", "broken.json"),
        ('{"certificates": [{}]}', "broken.json"),
        (json.dumps(content), "statement.section"),
    ):
        broken.write_text(text, encoding="utf-8")
        assert prove(broken) == 2
        message = capsys.readouterr().err
        assert "broken.json" in message
        assert word in message
        assert "Traceback" not in message
    assert prove(tmp_path / "absent.json") == 2
    assert prove(certificates, "--only", "nothing") == 2
    assert prove(certificates, "-o", certificates) == 2
    assert prove(certificates, "-o", tmp_path / "absent" / "second-proofs.json") == 2
    with pytest.raises(SystemExit) as end:
        prove(certificates, "--jobs", "0")
    assert end.value.code == 2


def dies_at_the_first(certificate: dict[str, Any], _: Any) -> dict[str, Any]:
    """The work of a process that is lost at one row."""
    if certificate["id"] == DOUBLING:
        os._exit(7)
    return {"id": certificate["id"], "verdict": "agrees", "reason": "", "fingerprint": "its own"}


def test_a_lost_process_costs_its_row_only(
    certificates: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "second-proofs.json"
    monkeypatch.setattr(second_proofs, "prove_row", dies_at_the_first)
    assert prove(certificates, "-o", output) == 1
    found = rows(output)
    assert found[DOUBLING]["verdict"] == "cannot follow"
    assert "exit code 7" in found[DOUBLING]["reason"]
    assert found[TOUCHING]["verdict"] == "agrees"
    assert "exit code 7" in capsys.readouterr().out
    monkeypatch.setattr(second_proofs, "fingerprint", lambda _: "its own")
    assert prove(certificates, "-o", output) == 1
    assert "1 of 2 rows are there already" in capsys.readouterr().err, "the row that was lost was not tried again"


@pytest.mark.usefixtures("little_grace")
def test_a_row_that_takes_too_long_is_not_proved(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = write(tmp_path / "certificates.json", LONG)
    assert prove(source, "--row-timeout", "0.01") == 1
    assert "time limit" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.skipif(not SEES_PROCESSES, reason="looks for processes in /proc")
@pytest.mark.parametrize("sent", ["SIGKILL", "SIGTERM", "SIGINT"])
def test_an_interrupted_run_keeps_its_rows_and_leaves_nothing(sent: str, tmp_path: Path) -> None:
    source, output = write(tmp_path / "certificates.json", DOUBLING, LONG), tmp_path / "second-proofs.json"
    with started(["-m", "orbitproof", "verify", "--second-proof", str(source), "-o", str(output)]) as run:
        wait_until(output.exists)
        found = wait_until(lambda: workers(run.pid))
        run.send_signal(getattr(signal, sent))
        _, errors = run.communicate(timeout=60)
        deadline = time.monotonic() + 20
        while any(map(is_running, found)) and time.monotonic() < deadline:
            time.sleep(0.2)
        assert not any(map(is_running, found))
    assert "Traceback" not in errors
    if sent != "SIGKILL":
        assert run.returncode == 130
        assert "interrupted: 1 of 2 rows finished" in errors
    assert {name: row["verdict"] for name, row in rows(output).items()} == {DOUBLING: "agrees"}


def test_a_row_is_about_its_certificate_and_made_by_its_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = shutil.copytree(Path(str(second_proofs.folder.__file__)).parent, tmp_path / "second_proof")
    monkeypatch.setattr(second_proofs.folder, "__file__", str(here / "__init__.py"))
    content = json.loads(DATA.read_text(encoding="utf-8"))
    first, second = content["certificates"][:2]
    mark = second_proofs.fingerprint(first)
    assert second_proofs.fingerprint(dict(reversed(first.items()))) == mark
    assert len({mark, second_proofs.fingerprint(second), second_proofs.fingerprint({**first, "digest": ""})}) == 3
    (here / "flow.py").write_text((here / "flow.py").read_text("utf-8") + "# Another one.\n", encoding="utf-8")
    assert second_proofs.fingerprint(first) != mark


@pytest.mark.parametrize("name", ["relation.py", "second_bifurcation.py", "second_periodic.py", "second_proofs.py"])
def test_a_row_is_kept_by_the_comparison_that_made_it_alone(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = shutil.copytree(Path(str(second_proofs.__file__)).parent, tmp_path / "run")
    monkeypatch.setattr(second_proofs, "__file__", str(here / "second_proofs.py"))
    mark = second_proofs.fingerprint({})
    (here / name).write_text((here / name).read_text("utf-8") + "# Another one.\n", encoding="utf-8")
    assert second_proofs.fingerprint({}) != mark
