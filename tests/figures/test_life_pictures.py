"""Pictures of whole lives: what is drawn is what the file says, and what is filled is what certificates prove."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from support.picture_texts import unreadable
from support.within import within

from orbitproof.explore.periodic import LifeRecord, read_life, write_life
from orbitproof.explore.periodic.life_file import (
    STATUS,
    CycleRecord,
    CyclesRecord,
    PassedRecord,
    RestRecord,
    SpecialRecord,
)
from orbitproof.figures.__main__ import main
from orbitproof.figures.pictures import CertifiedPoint, draw_life
from orbitproof.figures.style import close, use_style


def cycle(value: float) -> CycleRecord:
    size = value**0.5
    return CycleRecord(value, 6 + value, (-size, -2 * size), (size, 2 * size), value > 1 / 2)


CYCLES = tuple(map(cycle, (0.01, 0.2, 0.5, 0.7, 1.0)))
LIFE = LifeRecord(
    STATUS,
    "tank",
    ("u", "v"),
    {"b": Fraction(1, 3)},
    "rate",
    tuple(RestRecord(value, (0.0, value), 2 * int(value > 0)) for value in np.linspace(-1, 1, 21).tolist()),
    (SpecialRecord("Hopf", 0.0, (0.0, 0.0)),),
    (CyclesRecord("Hopf", CYCLES, (PassedRecord("fold", CYCLES[2]),), "reaches 1"),),
)

style = within(lambda: use_style())


def test_stable_parts_are_solid_and_extrema_are_those_of_the_file() -> None:
    figure = draw_life(LIFE)
    left, right = figure.axes
    drawn = [line for line in left.get_lines() if line.get_marker() == "None"]
    solid = [line for line in drawn if line.get_linestyle() == "-"]
    assert len(drawn) == 6
    assert [line.get_xdata()[0] for line in solid] == pytest.approx([-1, 0.7, 0.7])
    lows = [line.get_ydata() for line in drawn[2:4]]
    assert np.concatenate(lows).min() == -1
    assert [line.get_ydata()[0] for line in right.get_lines() if line.get_marker() == "None"] == [6.01, 6.7]
    assert (left.get_ylabel(), left.get_xlabel()) == ("$u$", r"$\mathrm{rate}$")
    assert unreadable(figure) == []
    close(figure)


@pytest.mark.parametrize(
    ("certified", "filled"),
    [
        ([], set()),
        ([CertifiedPoint("tank", "Hopf", "rate", 1e-12)], {"o"}),
        ([CertifiedPoint("tank", "Hopf", "rate", 1e-3), CertifiedPoint("tank", "fold", "rate", 0.5)], {"v"}),
        ([CertifiedPoint("tank", "fold", "rate", 0.0), CertifiedPoint("tank", "Hopf", "b", 0.0)], set()),
        ([CertifiedPoint("sink", "Hopf", "rate", 0.0)], set()),
    ],
)
def test_only_points_of_certificates_are_filled(certified: list[CertifiedPoint], filled: set[str]) -> None:
    figure = draw_life(LIFE, certified)
    marks = [line for line in figure.axes[0].get_lines() if line.get_marker() in ("o", "v")]
    assert len(marks) == 3
    assert {line.get_marker() for line in marks if line.get_markerfacecolor() != "white"} == filled
    close(figure)


def test_a_file_is_read_as_it_was_written_and_drawn_by_the_command(tmp_path: Path) -> None:
    path = tmp_path / "life.json"
    write_life(path, LIFE)
    assert read_life(path) == LIFE
    assert main(["periodic", str(path), "-o", str(tmp_path), "--format", "png", "--dpi", "50"]) == 0
    assert (tmp_path / "life-life.png").is_file()
