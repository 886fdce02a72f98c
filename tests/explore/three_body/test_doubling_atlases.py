"""Atlases of period doublings over the mass, as the search writes them."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from orbitproof.explore.__main__ import main
from orbitproof.shared.formats import Atlas, read_atlas
from orbitproof.shared.systems import HILL_VARIED

PROVED = read_atlas(Path(__file__).resolve().parents[2] / "data" / "atlas-doublings.json")
assert isinstance(PROVED, Atlas)


@pytest.mark.slow
def test_the_search_finds_the_curve_that_is_proved(tmp_path: Path) -> None:
    path, begin = tmp_path / "doublings.json", ["atlas-mass", "--point", "L1", "--family", "doubled", "--quiet"]
    assert main([*begin, "--mu-min", "0.0098", "--mu-max", "0.0102", "-o", str(path)]) == 0
    found = read_atlas(path)
    assert found.system is HILL_VARIED
    covers = found.claim.covers
    assert covers is not None
    assert covers.start**3 <= Fraction(98, 10000) < Fraction(102, 10000) <= covers.end**3
    (piece,) = found.curve_pieces()
    h = piece.point(Fraction(1, 3))[0]
    (whole,) = (each for each in PROVED.curve_pieces() if abs(h - each.centre[0]) <= each.half_width)
    wanted = whole.point((h - whole.centre[0]) / whole.half_width)
    assert wanted[0] == h
    assert max(abs(float(a - b)) for a, b in zip(piece.point(Fraction(1, 3)), wanted, strict=True)) < 1e-10


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["--point", "L3", "--family", "doubled"], "--family doubled"),
        (["--point", "L1", "--family", "doubled", "--z", "0.001"], "--z"),
        (["--point", "L1", "--family", "doubled", "--share", "0.1"], "--share"),
        (["--point", "L1", "--family", "doubled", "--lyapunov"], "--lyapunov"),
        (["--point", "L1", "--family", "doubled", "--tube", "0.01"], "--tube 0.01"),
        (["--point", "L1", "--tube", "1e-8"], "--tube"),
    ],
)
def test_what_there_is_not_of_doublings_is_one_line(
    arguments: list[str], option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "x.json"
    assert main(["atlas-mass", *arguments, "-o", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: {option}:")
    assert not path.exists()
