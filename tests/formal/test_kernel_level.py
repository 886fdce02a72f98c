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
from types import SimpleNamespace

import pytest
from support.runs import is_running, wait_until

from orbitproof import verify
from orbitproof.__main__ import main as orbitproof
from orbitproof.formal import checking, files, rows
from orbitproof.shared import read_candidates
from orbitproof.shared.processes import Failure
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
    """Levels before are passed, and each row has four files with little in them."""
    mark = request.node.get_closest_marker("slow")
    if mark and not mark.args:  # not of those that are left out because they take long
        return

    def before(given: list[verify.Certificate], **_: object) -> list[Recheck]:
        return [Recheck(entry.id, entry.verdict, 1, (), level=Level.CONCLUSION) for entry in given]

    def apart(_work: object, _name: str, arguments: tuple[verify.Certificate, Path], _limits: object) -> object:
        entry, folder = arguments
        row = folder / files.name_of(entry.id)
        row.mkdir(exist_ok=True)
        for name, text in {
            "Row": "",
            "Step1": "\nLemma step_1",
            "Crossing1": "\nLemma crossing_1",
            "Conclusion": "",
        }.items():
            (row / f"{name}.v").write_text(text)
        return True, "", checking._digest_of_files(row)

    monkeypatch.setattr(checking, "recheck_before", before)
    monkeypatch.setattr(checking, "apart", apart)
    monkeypatch.setattr(checking, "difference", lambda _entry, _text: "")


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
    assert f"by {tmp_path}/bin/coqc: 8.16; what Coq states is the claim of the certificate, of its results the" in said
    assert f"parameter only, between wider ends: read {tmp_path}/out" in said

    # The next one takes no file; what was checked before is not handed to it.
    coq("*.v", "exit 1")
    first, second = checking.recheck(certificates(ROW, OTHER), folder=tmp_path / "out", quiet=True)
    assert (first.checked, first.earlier, second.checked, second.earlier) == (True, True, True, True)
    assert first.words.endswith("checked.json says so, `fresh` checks it again")
    (tmp_path / "out" / files.name_of(OTHER) / "statement.txt").write_text("another claim")
    (tmp_path / "out" / files.name_of(ROW) / "Step1.v").write_text("\nLemma step_2")
    first, second = checking.recheck(certificates(ROW, OTHER), folder=tmp_path / "out", quiet=True)
    assert (first.checked, second.checked) == (False, False)


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


def test_a_row_of_which_coq_states_something_else_is_not_checked(
    coq: Coq, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    coq("nothing", "true")
    monkeypatch.setattr(checking, "difference", lambda entry, text: f"{entry.id} beside {text.split()[0]}")
    for _ in range(2):
        (check,) = checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
        assert (check.checked, check.words) == (False, f"{ROW} beside Axioms:")


@pytest.mark.parametrize("answer", [(False, "no way", ""), Failure("process", "no way")])
def test_a_row_whose_files_are_not_written_is_not_checked(
    coq: Coq, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: object
) -> None:
    coq("nothing", "true")
    checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    (tmp_path / "out" / "checked.json").unlink()
    monkeypatch.setattr(checking, "apart", lambda *_: answer)
    (check,) = checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    assert (check.checked, check.words) == (False, "its files are not written: no way")


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


def test_files_that_were_not_written_for_a_certificate_are_not_checked_for_it(
    coq: Coq, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another process writes a row of the same id into the folder before Coq begins, or another Coq is there."""
    coq("*Polynomials.v", f"echo >>{tmp_path}/out/{files.name_of(ROW)}/Row.v")
    (check,) = checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    assert (check.checked, check.words) == (False, "its files were changed meanwhile")

    coq("nothing", "true")
    assert checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)[0].checked
    assert checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)[0].earlier
    assert not checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True, fresh=True)[0].earlier
    tool = tmp_path / "bin" / "coqc"
    tool.write_text(tool.read_text().replace("8.16", "8.17"))
    (check,) = checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)
    assert (check.checked, check.earlier) == (True, False)

    # Another program, exporter, theory, script or certificate: what was checked with the ones before is not known.
    monkeypatch.setattr(checking, "software", lambda: {"program": "another"})
    assert not checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)[0].earlier
    monkeypatch.setattr(checking, "source_digests", lambda *_: ["another"])
    assert not checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)[0].earlier
    shutil.copytree(files.THEORY, tmp_path / "formal" / "theory")
    shutil.copy(files.THEORY.parent / "check.sh", tmp_path / "formal")
    monkeypatch.setattr(checking, "THEORY", tmp_path / "formal" / "theory")
    for name in ("theory/Rows.v", "check.sh"):
        with (tmp_path / "formal" / name).open("a") as file:
            file.write("\n")
        assert not checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)[0].earlier, name
        assert (tmp_path / "out" / name).read_text() == (tmp_path / "formal" / name).read_text()
    other = certificates(ROW)[0].to_json()
    other["statement"]["theorem"] = "another"
    assert checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)[0].earlier
    (check,) = checking.recheck(verify.Certificate.from_json(other), folder=tmp_path / "out", quiet=True)
    assert not check.earlier


def test_a_folder_in_which_another_run_is_at_work_is_refused(coq: Coq, tmp_path: Path) -> None:
    coq("nothing", "true")
    with checking._alone(tmp_path / "out"), pytest.raises(verify.InputError, match="another run is at work there"):
        checking.recheck(certificates(ROW), folder=tmp_path / "out", quiet=True)


def test_links_and_other_files_in_the_folder_are_refused_and_kept(coq: Coq, tmp_path: Path) -> None:
    coq("nothing", "true")
    out = tmp_path / "out"
    (tmp_path / "mine").mkdir()
    for name in ("theory", "check.sh", "theory/Rows.v", "theory/sub"):
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).symlink_to(tmp_path / "mine")
        with pytest.raises(verify.InputError, match="is a link or a folder"):
            checking.recheck(certificates(ROW), folder=out, quiet=True)
        (out / name).unlink()
    with pytest.raises(verify.InputError, match="the theory itself lies there"):
        checking.lay_out(files.THEORY.parent)
    (out / "checked.json").write_text('{"a": {"of": "", "stated": "", "seconds": NaN}}')
    with pytest.raises(verify.InputError, match="does not say what was checked"):
        checking.recheck(certificates(ROW), folder=out, quiet=True)

    # Of the folder of a row, only files of a row are removed.
    row = SimpleNamespace(certificate=SimpleNamespace(id="mine"), moves=(), arrivals=())
    kept, ours = ("notes.vue", "main.v", "day.log"), ("Step3.v", "Row.vo", ".Step1.aux", "statement.txt", "done")
    for name in (*kept, *ours):
        (tmp_path / "mine" / name).touch()
    with pytest.MonkeyPatch.context() as short:
        for name in ("_row", "_theorem"):
            short.setattr(files, name, lambda _row: "")
        _, digest = files.write_row(row, tmp_path)
        assert digest == checking._digest_of_files(tmp_path / "mine")
        assert {path.name for path in (tmp_path / "mine").iterdir()} == {*kept, "Row.v", "Conclusion.v"}
        (out / "mine").symlink_to(tmp_path / "mine")
        with pytest.raises(verify.InputError, match="is a link"):
            files.write_row(row, out)
    with pytest.raises(verify.InputError, match="it would have the folder of the theory"):
        checking.own_folders([SimpleNamespace(id="theory")])


def test_words_of_another_version_are_not_printed(coq: Coq, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The sections of hypotheses are words: the certificate that is derived has those of this version."""
    coq("nothing", "true")
    (entry,) = certificates(ROW)
    foreign = entry.to_json()
    for hypothesis in foreign["hypotheses"]:
        hypothesis["section"] = "all of physics"
    before = Recheck(ROW, "proved", 1, (), level=Level.CONCLUSION, rendered=entry.to_json())
    monkeypatch.setattr(checking, "recheck_before", lambda _given, **_: [before])
    (check,) = checking.recheck(verify.Certificate.from_json(foreign), folder=tmp_path / "out", quiet=True)
    assert check.checked
    assert "(sections 1.3 to 5.2, 6, 7.1," in check.words


def test_the_time_that_is_left_goes_by_steps_whatever_a_file_says_of_them() -> None:
    entry, other = (certificates(name)[0] for name in (ROW, OTHER))
    assert checking._work(entry) / checking._work(other) == (1 + entry.computation.steps) / (
        1 + other.computation.steps
    )
    endless = entry.to_json()
    endless["computation"]["steps"] = 10**400
    assert checking._work(verify.Certificate.from_json(endless)) < 1e7


def proof_of(name: str) -> verify.Certificate:
    (claim,) = [each for each in read_candidates(DATA / "known-bifurcations.json") if each.id == name]
    (proof,) = verify.certify(claim, quiet=True)
    return proof


def test_the_own_box_beside_a_level_form_is_that_of_the_certificate() -> None:
    proof = proof_of(OTHER)
    own, form = rows._own(proof), rows.claim_of(proof)
    assert own.claim == proof.candidate != form
    assert None in rows.starts_of(form)
    assert None not in own.starts


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("coqc") is None, reason="Coq is not installed: apt install coq libcoq-bignums")
@pytest.mark.parametrize(("name", "size"), [(ROW, "15 steps, 2 crossings"), (OTHER, "6 steps, 1 crossing")])
def test_the_kernel_checks_a_certificate(name: str, size: str, tmp_path: Path) -> None:
    """Of maps with a parameter, and of a level form."""
    proof = proof_of(name)
    (check,) = checking.recheck(proof, folder=tmp_path, quiet=True, jobs=2)
    assert check.checked, check.words
    assert (check.earlier, check.before.level) == (False, Level.CONCLUSION)
    assert check.words.startswith(f"{size}, all that is computed for symmetries")
    assert "checked Conclusion.the_bifurcation" in (tmp_path / files.name_of(name) / "statement.txt").read_text()
    (again,) = checking.recheck(proof, folder=tmp_path, quiet=True)
    assert (again.checked, again.earlier) == (True, True)
