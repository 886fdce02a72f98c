"""Curves of periodic orbits covered by pieces: through folds, closed, over levels, by command and from Python."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.periodic_curves import LEVELS, LIMITS, TURNING, WHOLE

from orbitproof import explore, shared, verify
from orbitproof.explore.__main__ import main
from orbitproof.explore.periodic import FoundOrbit
from orbitproof.shared.formats import PeriodicAtlas, read_atlas
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_curve import prove_periodic_piece


def _isola(x: Any, y: Any, a: Any) -> tuple[Any, Any]:
    q = x * x + y * y - 1
    rate = (16 * q * q + 16 * a * a - 1) / 32
    return rate * x - y, rate * y + x


ISOLA = shared.define_system({"name": "isola", "state": "x y", "parameters": "a", "field": _isola})
"""Orbits with (x^2 + y^2 - 1)^2 + a^2 = 1/16: a closed curve with two folds."""


def found(system: shared.System, a: str, **start: float) -> FoundOrbit:
    """The orbit near a point, of period about 2 pi, where y = 0 and grows."""
    (orbit,) = explore.find_periodic(
        system, start, parameters={"a": a}, period=6.28, section="y=0", direction="+", quiet=True
    )
    return orbit


@pytest.mark.slow
def test_a_curve_is_covered_through_its_fold_and_proved() -> None:
    atlas = explore.periodic_atlas(found(TURNING, "-0.9", x=1.14, y=0.0), ("a", -1.1, -0.8), quiet=True)
    ends = [piece.point(shared.parse_exact(s)) for piece, s in ((atlas.pieces[0], "-1"), (atlas.pieces[-1], "1"))]
    assert all(float(end[0]) > -0.8 for end in ends)
    assert min(float(ends[0][1]), float(ends[1][1])) < 0.75 < 1.2 < max(float(ends[0][1]), float(ends[1][1]))
    turning = [piece for piece in atlas.curve_pieces() if abs(float(piece.centre[0]) + 1) < 0.02]
    assert turning
    for piece in atlas.curve_pieces():
        for s in np.linspace(-1, 1, 7):
            a, x = map(float, piece.point(shared.parse_exact(repr(float(s)))))
            assert abs(x**4 - 2 * x**2 - a) < 1e-9
    proof = prove_periodic_piece(atlas, turning[0], WHOLE, ORACLE)
    assert proof.is_proved, proof.outcome


def test_a_closed_curve_is_found_to_be_closed() -> None:
    atlas = explore.periodic_atlas(found(ISOLA, "0", x=1.118, y=0.0), ("a", -1.0, 1.0), quiet=True)
    assert atlas.claim.kind == "periodic-loop"
    for piece in atlas.curve_pieces():
        a, x = map(float, piece.point(shared.parse_exact("0.5")))
        assert abs((x * x - 1) ** 2 + a * a - 1 / 16) < 1e-9


@pytest.mark.slow
def test_a_closed_curve_is_proved() -> None:
    atlas = explore.periodic_atlas(found(ISOLA, "0", x=1.118, y=0.0), ("a", -1.0, 1.0), quiet=True)
    (certificate,) = verify.certify(atlas, precision=104, order=40, width=32, quiet=True)
    assert certificate.proved, certificate.reason
    assert len(certificate.document["conclusion"]["turns"]) == 2


def test_curves_over_levels_and_on_a_level() -> None:
    orbit = found(LEVELS, "0.5", x=-1.0, y=0.0, z=-0.25)
    over = explore.periodic_atlas(orbit, ("level", 0.8, 1.2), name="over", quiet=True)
    assert over.claim.parameter is None
    assert over.coordinates == ("x", "z")
    on = explore.periodic_atlas(orbit, ("a", 0.4, 0.6), name="on", quiet=True)
    assert on.claim.level == 1
    assert on.claim.covers is not None
    for atlas in (over, on):
        assert prove_periodic_piece(atlas, atlas.curve_pieces()[0], WHOLE, ORACLE, LIMITS).is_proved


def test_what_cannot_vary_is_refused() -> None:
    orbit = found(TURNING, "-0.9", x=1.14, y=0.0)
    for along in (("b", 0.0, 1.0), ("level", 0.0, 1.0), ("a", 1.0, 0.0)):
        with pytest.raises(ValueError, match="along"):
            explore.periodic_atlas(orbit, along, quiet=True)


def test_the_command_writes_an_atlas(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    system, output = tmp_path / "turning.json", tmp_path / "atlas.json"
    rate = "(a + 2*(x**2 + y**2) - (x**2 + y**2)**2)/10"
    entry = {"format": "orbitproof-system", "version": 1, "name": "turning", "state": "x y", "parameters": "a"}
    system.write_text(json.dumps({**entry, "field": {"x": f"{rate}*x - y", "y": f"{rate}*y + x"}}))
    start = ["--parameter", "a=-0.9", "--start", "x=1.14", "y=0", "--period", "6.28"]
    given = ["periodic", "--system", str(system), *start]
    more = ["--section", "y=0", "--along", "a", "-0.95", "-0.85", "--atlas", str(output), "--quiet"]
    assert main([*given, *more]) == 0
    atlas = read_atlas(output)
    assert isinstance(atlas, PeriodicAtlas)
    assert atlas.id == "turning-a"
    assert main([*given, "--atlas", str(output)]) == 2
    assert "--atlas: belongs to --along" in capsys.readouterr().err
