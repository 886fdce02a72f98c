"""The campaign of false claims and forged certificates, for two minutes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_nothing_false_is_proved_and_no_forgery_stands(tmp_path: Path) -> None:
    script = Path(__file__).with_name("campaign.py")
    command = [sys.executable, str(script), "--output", str(tmp_path / "campaign.json"), "--seconds", "100"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr
    assert "wrong: 0" in found.stdout
