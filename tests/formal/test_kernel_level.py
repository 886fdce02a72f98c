"""The fourth level of checking certificates again: the kernel of Coq decides, and nothing else makes a row checked.

But for the slow test, a stand-in takes the place of Coq, and files of rows are empty.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from support.runs import is_running, wait_until

from orbitproof import verify
from orbitproof.__main__ import main as orbitproof
from orbitproof.formal import checking, files
from orbitproof.shared import read_candidates
from orbitproof.verify.certificate import Level, Recheck
from orbitproof.verify.run import Display

DATA = Path(__file__).parents[1] / "data"
FILE = DATA / "figures-certificates.json"
COMMAND = ["orbitproof", "verify", "--recheck", "--formal", str(FILE)]
ROW, OTHER = "falkner-skan-odd-k2-1", "earth-moon-L1-halo-k1-1"
ANSWER = "cat <<'END'\nAxioms:\nPrimInt63.add\nPrimInt63.int : Set\n     = tt\n     : unit\nEND"
Coq = Callable[[str, str], None]


@pytest.fixture
def coq(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Coq:
    """Makes a stand-in for Coq: what it does with a file whose name fits a pattern, and what else."""
    (tmp_path / "bin").mkdir()
    for name in (
        "sh",
        "cat",
        "grep",
        "sed",
        "rm",
        "find",
        "ls",
        "wc",
        "tr",
        "date",
        "dirname",
        "xargs",
        "head",
        "tail",
    ):
        found = shutil.which(name)
        assert found is not None
        (tmp_path / "bin" / name).symlink_to(found)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))

    def make(pattern: str, does: str) -> None:
        tool = tmp_path / "bin" / "coqc"
        tool.write_text(
            f'#!/bin/sh\ncase "$*" in --version) echo 8.16;; {pattern}) {does};; *Statement.v) {ANSWER}\n;; esac\n'
        )
        tool.chmod(0o755)

    return make


@pytest.fixture(autouse=True)
def rows_that_stand(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Levels before are passed, and each row has four empty files."""
    if request.node.get_closest_marker("slow"):
        return

    def before(given: list[verify.Certificate], **_: object) -> list[Recheck]:
        return [Recheck(entry.id, entry.verdict, 1, (), level=Level.CONCLUSION) for entry in given]

    def apart(_work: object, _name: str, arguments: tuple[verify.Certificate, Path], _limits: object) -> object:
        entry, folder = arguments
        row = folder / files.name_of(entry.id)
        row.mkdir(exist_ok=True)
        for name in ("Row", "Step1", "Crossing1", "Conclusion"):
            (row / f"{name}.v").touch()
        return True, ""

    monkeypatch.setattr(checking, "recheck_before", before)
    monkeypatch.setattr(checking, "apart", apart)


def certificates(*names: str) -> list[verify.Certificate]:
    return [entry for entry in verify.read(FILE) if entry.id in names]


def test_without_coq_one_line_says_how_to_install_it(
    coq: Coq, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", [*COMMAND, "--only", ROW, "--json"])
    assert orbitproof() == 1
    (answer,) = json.loads(capsys.readouterr().out)["results"]
    assert (answer["kernel"], answer["words"]) == (False, checking.COQ_IS_MISSING)
    assert "apt install coq libcoq-bignums" in checking.COQ_IS_MISSING


def test_what_is_checked_is_said_and_is_not_checked_again(
    coq: Coq, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    coq("nothing", "true")
    words = [
        "orbitproof",
        "verify",
        "--recheck",
        "--formal",
        str(FILE),
        "--only",
        ROW,
        OTHER,
        "-o",
        str(tmp_path / "out"),
    ]
    monkeypatch.setattr("sys.argv", words)
    assert orbitproof() == 0
    said = " ".join(capsys.readouterr().out.split())
    assert f"{ROW}: 1 step, 1 crossing, all that is computed for symmetries, frames," in said
    assert (
        "on paper: that period doubling (k = 2), new orbits below, follows from it (sections 1.3 to 5.2, 6, 7.1,"
        in said
    )
    assert "4 kernel" in said
    assert "definitions of formal/theory" in said

    # The next one takes no file; what was checked before is not handed to it.
    coq("*.v", "exit 1")
    first, second = checking.recheck(certificates(ROW, OTHER), folder=tmp_path / "out", quiet=True)
    assert (first.checked, first.earlier, second.checked, second.earlier) == (True, True, True, True)
    (tmp_path / "out" / files.name_of(ROW) / "Step1.v").write_text("(* changed *)")
    first, second = checking.recheck(certificates(ROW, OTHER), folder=tmp_path / "out", quiet=True)
    assert (first.checked, second.checked) == (False, True)
    assert not checking.recheck(certificates(OTHER), folder=tmp_path / "out", quiet=True, fresh=True)[0].checked


@pytest.mark.parametrize(
    ("pattern", "does", "words"),
    [
        ("*Step1.v", "echo Error: no such number; exit 1", "Step1 Error: no such number"),
        ("*Statement.v", "echo Axioms:; echo cheat : False", "it rests on more than primitive integers: cheat : False"),
        ("*Formats.v", "exit 1", "theory/Formats.v is not accepted"),
        ("*Step1.v", "kill -9 $$", "Step1"),
    ],
)
def test_what_coq_does_not_take_is_not_checked(coq: Coq, pattern: str, does: str, words: str, tmp_path: Path) -> None:
    coq(pattern, does)
    (check,) = checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    assert not check.checked
    assert words in check.words
    assert not (tmp_path / "out" / "checked.json").exists()


def test_what_does_not_stand_before_is_not_handed_to_coq(
    coq: Coq, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    coq("*Row.v", f"echo > {tmp_path}/asked")
    monkeypatch.setattr(
        checking,
        "recheck_before",
        lambda given, **_: [Recheck(each.id, "proved", 0, (), obstacle="no") for each in given],
    )
    (check,) = checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    assert (check.checked, check.words) == (False, "it does not stand at the levels before: no")
    assert not (tmp_path / "asked").exists()


def test_nothing_runs_on_after_a_limit_of_time_or_an_interrupt(
    coq: Coq, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pid = tmp_path / "pid"
    coq("*Step1.v", f"echo $$ > {pid}; exec {shutil.which('sleep', path=os.defpath)} 600")
    with monkeypatch.context() as late:
        late.setattr(checking, "monotonic", lambda: 1e9 if pid.exists() and pid.read_text().strip() else 0.0)
        (check,) = checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    assert not check.checked
    assert "did not come to an end in time" in check.words
    wait_until(lambda: not is_running(int(pid.read_text())))

    pid.unlink()

    def advance(_self: Display, _name: str, _fraction: float, _label: str) -> None:
        if pid.exists() and pid.read_text().strip():
            raise KeyboardInterrupt

    monkeypatch.setattr(Display, "advance", advance)
    with pytest.raises(KeyboardInterrupt):
        checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    wait_until(lambda: not is_running(int(pid.read_text())))
    assert not (tmp_path / "out" / "checked.json").exists()


def test_coq_ends_with_the_one_that_started_it(tmp_path: Path) -> None:
    """Also where that is killed: its end of the pipe is closed then."""
    script = tmp_path / "script"
    script.write_text(f"echo $$ >{tmp_path}/pid; sleep 600")
    words = ["sh", "-c", checking.WATCHED, str(script)]
    with subprocess.Popen(words, stdin=subprocess.PIPE, start_new_session=True) as run:
        number = int(wait_until(lambda: (tmp_path / "pid").exists() and (tmp_path / "pid").read_text().strip()))
        assert run.stdin is not None
        run.stdin.close()
        assert run.wait(60) < 0
    wait_until(lambda: not is_running(number))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("coqc") is None, reason="Coq is not installed: apt install coq libcoq-bignums")
def test_the_kernel_checks_a_certificate_of_falkner_skan(tmp_path: Path) -> None:
    (claim,) = [each for each in read_candidates(DATA / "known-bifurcations.json") if each.id == ROW]
    proof = verify.certify(claim, quiet=True)
    (check,) = checking.recheck(proof, folder=tmp_path, quiet=True, jobs=2)
    assert (check.checked, check.earlier, check.before.level) == (True, False, Level.CONCLUSION)
    assert check.words.startswith("15 steps, 2 crossings, all that is computed for symmetries")
    assert "checked the_bifurcation" in (tmp_path / files.name_of(ROW) / "statement.txt").read_text()
    (again,) = checking.recheck(proof, folder=tmp_path, quiet=True)
    assert (again.checked, again.earlier) == (True, True)
