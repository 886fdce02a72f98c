"""``orbitproof verify atlas --complete``: printed, stored, kept, and refused where it makes no sense."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from support import atlas_work

from orbitproof.verify.certificate import read_certificate
from orbitproof.verify.run.branch_command import main

DATA = Path(__file__).parents[1] / "data"
SOURCE = str(DATA / "atlas-falkner-skan.json")


def test_the_list_is_part_of_the_theorem_and_stands(tmp_path: Path, capsys: Any) -> None:
    """A file that was made without it is completed by integrating again."""
    target = str(tmp_path / "curve.json")
    assert main([SOURCE, "-o", target, "--quiet"], atlas_work.stored) == 0
    assert "resonan" not in capsys.readouterr().out
    assert "complete" not in read_certificate(Path(target), "atlas-certificate").document["conclusion"]
    assert main([SOURCE, "-o", target, "--quiet", "--complete", "12"], atlas_work.stored) == 0
    printed = capsys.readouterr().out
    assert "- 1:11, a stability parameter is cos(2 pi 5/11): beta in [347.21" in printed
    document = read_certificate(Path(target), "atlas-certificate").document
    assert document["conclusion"]["complete"]["order"] == 12
    assert "cos(2 pi 5/11)" in document["statement"]["theorem"]
    assert main(["--recheck", target, "--quiet"]) == 0
    assert "stands  2 conclusion" in capsys.readouterr().out
    assert main([SOURCE, "-o", target, "--complete", "4"], atlas_work.endless) == 0
    captured = capsys.readouterr()
    assert "2 of 2 pieces settled already" in captured.err
    assert "1:11" not in captured.out


def test_a_list_with_gaps_is_named_and_is_not_all_that_was_asked(tmp_path: Path, capsys: Any) -> None:
    target = str(tmp_path / "curve.json")
    assert main([SOURCE, "-o", target, "--complete", "12", "--quiet"], atlas_work.stored_without_stability) == 1
    assert "piece p015" in capsys.readouterr().out.split("Not covered")[1]
    assert read_certificate(Path(target), "atlas-certificate").proved


@pytest.mark.parametrize("order", ["0", "-1", "100", "twelve", "1.5", ""])
def test_orders_that_are_none_are_refused(order: str, capsys: Any) -> None:
    with pytest.raises(SystemExit) as stop:
        main([SOURCE, f"--complete={order}"])
    assert stop.value.code == 2
    assert "number from 1 to 99" in capsys.readouterr().err


def test_a_surface_and_a_check_take_no_order(tmp_path: Path, capsys: Any) -> None:
    assert main([str(DATA / "surface.json"), "--complete", "4"]) == 2
    assert "surface" in capsys.readouterr().err
    target = str(tmp_path / "curve.json")
    assert main([SOURCE, "-o", target, "--quiet"], atlas_work.stored) == 0
    assert main(["--recheck", target, "--complete", "4"]) == 2
