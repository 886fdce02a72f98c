"""The near-double pair of 1:2 resonances of Sun-Jupiter's L2 halo orbits: how far below -1 they turn back."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from orbitproof.shared import parse_exact
from orbitproof.verify.__main__ import main as verify

DATA = Path(__file__).parents[1] / "data"
FLOAT64 = -1.000089479233839
"""What the search finds."""


def extremum(curve: Path) -> tuple[float, float, dict[str, Any]]:
    """Value, radius and entry of the only one in the list."""
    (entry,) = json.loads(curve.read_text())["conclusion"]["complete"]["extrema"]
    middle, radius = (parse_exact(entry["value"][part]) for part in ("mid", "rad"))
    return float(middle), float(radius), entry


@pytest.mark.slow
def test_three_certified_orbits_give_the_extremum_to_twelve_digits_and_two_do_not(tmp_path: Path) -> None:
    certificates, curve = tmp_path / "certificates.json", tmp_path / "curve.json"
    common = ["--jobs", "1", "--quiet"]
    assert verify([str(DATA / "near-double-orbits.json"), "-o", str(certificates), *common]) == 0
    document = json.loads(certificates.read_text())
    two = tmp_path / "two.json"
    two.write_text(json.dumps({**document, "certificates": document["certificates"][:2]}))
    words = ["atlas", str(DATA / "near-double.json"), "-o", str(curve), "--complete", "2", *common]
    assert verify([*words, "--bifurcations", str(two)]) == 0
    value, radius, entry = extremum(curve)
    assert radius > 1e-6
    assert abs(value - FLOAT64) <= radius
    assert "certificates" not in entry
    assert verify([*words, "--bifurcations", str(certificates)]) == 0
    value, radius, entry = extremum(curve)
    assert radius < 1e-12
    assert abs(value - FLOAT64) < 1e-11
    assert entry["certificates"] == ["before", "at", "after"]
    assert verify(["atlas", "--recheck", str(curve), *common]) == 0
