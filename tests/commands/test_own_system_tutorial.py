"""Every block of the tutorial on one's own system runs, and prints what it shows."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```(\w+)[ ]?(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_every_block_of_the_tutorial_runs_and_prints_what_it_shows(tmp_path: Path) -> None:
    printed = ""
    blocks = BLOCK.findall((ROOT / "docs" / "own-system.md").read_text("utf-8"))
    assert [language for language, _, _ in blocks].count("sh") >= 4
    for language, name, text in blocks:
        if name:
            (tmp_path / name).write_text(text, "utf-8")
        elif language == "text":
            for line in text.splitlines():
                assert line in printed
        else:
            printed = ""
            lines = text.splitlines() if language == "sh" else [text]
            for line in lines:
                words = shlex.split(line)[1:] if language == "sh" else []
                command = ["-m", "orbitproof", *words] if language == "sh" else ["-c", line]
                done = subprocess.run(
                    [sys.executable, *command], cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False
                )
                assert done.returncode == 0, done.stderr
                printed += done.stdout
