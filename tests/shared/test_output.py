"""Files that are written: atomically where links lead, into what is no regular file, or refused."""

from __future__ import annotations

import json
import os
import socket
import stat
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from support import atlas_work
from support.atlas_runs import CURVE, ROOT, write

from orbitproof.shared import output
from orbitproof.shared.formats import InputError, check_writable, write_bytes, write_text
from orbitproof.shared.interrupts import run_command
from orbitproof.verify.__main__ import main
from orbitproof.verify.run.branch_command import main as verify_branch

FOLDS = ROOT / "tests" / "data" / "known-folds.json"


@contextmanager
def reader(path: Path) -> Iterator[list[str]]:
    """What a process that opens a FIFO once gets from it, in a list that is filled when the body is left."""
    os.mkfifo(path)
    found: list[str] = []
    thread = threading.Thread(target=lambda: found.append(path.read_text("utf-8")), daemon=True)
    thread.start()
    yield found
    thread.join(60)


def null_device(folder: Path) -> Path:
    """A device that takes everything, of its own where the system lets us make one."""
    path = folder / "null"
    try:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 3))
        write_bytes(path, b"")
    except (PermissionError, InputError):
        path.unlink(missing_ok=True)
        path.symlink_to(os.devnull)
    return path


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@pytest.mark.parametrize("is_there", [True, False])
def test_a_link_is_followed_and_stays(is_there: bool, tmp_path: Path) -> None:
    there, here = tmp_path / "there", tmp_path / "here"
    there.mkdir()
    here.mkdir()
    target = there / "file.json"
    if is_there:
        target.write_text("old")
        before = target.stat().st_ino
    (there / "link").symlink_to("file.json")
    link = here / "link"
    link.symlink_to(Path("..", "there", "link"))
    write_text(link, "new")
    assert link.is_symlink()
    assert (there / "link").is_symlink()
    assert target.read_text() == "new"
    # By a rename: whoever has the old file open keeps it whole.
    assert not is_there or target.stat().st_ino != before
    assert (names(there), names(here)) == ({"file.json", "link"}, {"link"})


def test_a_device_is_written_into(tmp_path: Path) -> None:
    device = null_device(tmp_path)
    write_bytes(device, b"gone")
    assert stat.S_ISCHR(device.stat().st_mode)
    assert main([str(FOLDS), "--only", "michelson*", "-o", str(device), "--quiet"]) == 0
    assert stat.S_ISCHR(device.stat().st_mode)
    assert names(tmp_path) == {device.name}
    with pytest.raises(InputError, match="No space left"):
        write_bytes(Path("/dev/full"), b"more")


@pytest.mark.slow
def test_a_reader_of_a_fifo_gets_one_document_of_a_run_that_saves_as_it_comes(tmp_path: Path) -> None:
    words = [str(FOLDS), "--only", "*fold-1", "--quiet", "-o"]
    with reader(tmp_path / "rows") as found:
        code = run_command(lambda: main([*words, str(tmp_path / "rows")]))
    document = json.loads(found[0])
    assert len(document["certificates"]) > 1
    assert code == 0
    with reader(tmp_path / "branch") as found:
        given = [write(tmp_path / "atlas.json"), "-o", str(tmp_path / "branch"), "--quiet"]
        assert run_command(lambda: verify_branch(given, atlas_work.proving)) == 0
    assert {result["piece"] for result in json.loads(found[0])["results"]} == {piece.id for piece in CURVE.pieces}


def test_a_fifo_that_nobody_reads_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nor is it read for the results of an earlier run."""
    monkeypatch.setattr(output, "_READER_SECONDS", 0.0)
    path = tmp_path / "fifo"
    os.mkfifo(path)
    assert run_command(lambda: main([str(FOLDS), "--only", "michelson*", "--quiet", "-o", str(path)])) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == f"error: {path}: nobody reads what is written there; start its reader first"
    assert stat.S_ISFIFO(path.stat().st_mode)


def test_what_cannot_be_a_file_is_refused_before_a_run(tmp_path: Path) -> None:
    loop, bound, folder, dangling = (tmp_path / name for name in ("loop", "socket", "folder", "dangling"))
    loop.symlink_to("loop")
    folder.mkdir()
    dangling.symlink_to(tmp_path / "nowhere" / "file")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(bound))
        for path, why in (
            (loop, "cannot be written"),
            (bound, "is a socket and no file"),
            (folder, "is a folder"),
            (dangling, "nowhere does not exist"),
            (tmp_path / ("x" * 300), "cannot be written"),
            (tmp_path / "a\0b", "cannot be written"),
        ):
            with pytest.raises(InputError, match=why):
                check_writable(path)
            with pytest.raises(InputError, match=why):
                write_bytes(path, b"")


def test_a_disk_is_refused(tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    try:
        os.mknod(disk, stat.S_IFBLK | 0o666, os.makedev(7, 0))
    except PermissionError:
        pytest.skip("only root makes devices")
    with pytest.raises(InputError, match="is a disk and no file"):
        write_bytes(disk, b"")


@pytest.mark.parametrize("named", ["out.json", "/dev/stdout"])
def test_a_file_is_not_taken_from_under_what_is_printed(named: str, tmp_path: Path) -> None:
    target = tmp_path / "out.json"
    words = ["-m", "orbitproof.verify", str(FOLDS), "--only", "michelson*", "-o", named]
    with target.open("w") as stream:
        run = subprocess.run([sys.executable, *words], stdout=stream, stderr=subprocess.PIPE, cwd=tmp_path, text=True)
    assert run.returncode == 2
    assert "what is printed goes to this file too" in run.stderr
    assert target.read_text() == ""
