"""The page on balls in other packages: its blocks run, and what they end with contains the ball."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from support.claims import known

from orbitproof import shared, verify

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "how-to" / "take-a-ball-elsewhere.md").read_text("utf-8")


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the blocks define, run one after the other beside a certificate."""
    folder = tmp_path_factory.mktemp("page")
    verify.write(folder / "certificates.json", verify.certify(known("fs2"), quiet=True))
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    assert len(blocks) == 4
    found: dict[str, Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for block in blocks:
            exec(block, found)
    return found


def exact(value: Any) -> Fraction:
    """An mpmath number as a fraction."""
    sign, mantissa, exponent, _ = value._mpi_[0] if hasattr(value, "_mpi_") else value._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def test_every_form_contains_the_ball(names: dict[str, Any]) -> None:
    lower, upper = names["lower"], names["upper"]
    assert 0 < upper - lower < Fraction(1, 10**20)
    assert exact(names["interval"].a) <= lower < upper <= exact(names["interval"].b)
    assert exact(names["interval"].b) - exact(names["interval"].a) <= 2 * (upper - lower)
    low, high = map(Fraction, names["doubles"].tolist())
    assert low < lower < upper < high
    assert high - low < 4 * Fraction(2) ** -52 * upper
    assert all(
        verify.bounds(names["squared"])[0] <= x * x + 1 <= verify.bounds(names["squared"])[1] for x in (lower, upper)
    )


def test_the_ends_are_those_of_the_file(names: dict[str, Any]) -> None:
    entry = names["proof"].to_json()["results"]["parameter"]
    middle, radius = (shared.parse_exact(entry[key]) for key in ("mid", "rad"))
    assert (middle - radius, middle + radius) == (names["lower"], names["upper"])
    assert isinstance(names["ball"], arb)
    assert shared.parse_exact("0x3p-4") == Fraction(3, 16) == Fraction(float.fromhex("0x1.8p-3"))
