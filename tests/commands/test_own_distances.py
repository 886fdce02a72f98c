"""Distances from a body that the file of one's own system names: in the certificate, which needs the file no more."""

from __future__ import annotations

from pathlib import Path

import mpmath
import pytest
from support.independent_flow import extrapolated_flow

from orbitproof.explore.__main__ import main as explore
from orbitproof.shared.formats import load_system, read_candidates
from orbitproof.verify.__main__ import main as verify
from orbitproof.verify.certificate import read_certificates
from orbitproof.verify.evidence import bounds, exact_value

HILL = Path(__file__).resolve().parents[2] / "docs" / "examples" / "hill.py"
DISTANCE = 'name = "hill-moon"\nsquared_distance = "x**2 + y**2 + z**2"\ndistance_name = "the small body"\n'


def test_orbits_of_an_own_system_are_near_and_far_as_certified(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own, found, proved = (tmp_path / name for name in ("own.py", "orbit.json", "certificate.json"))
    own.write_text(HILL.read_text() + DISTANCE)
    words = ["orbit", "--system", str(own), "--start", "x=0.3043", "z=0", "vy=1.5341", "--at", "x=0.3043"]
    assert explore([*words, "--digits", "20", "--id", "near", "-o", str(found), "--quiet"]) == 0
    system = load_system(own)
    (candidate,) = read_candidates(found)
    own.unlink()
    assert verify([str(found), "-o", str(proved), "--digits", "8", "--jobs", "1", "--quiet"]) == 0
    orbit = read_certificates(proved)["near"].orbit
    assert orbit is not None
    assert orbit.distance_name == "the small body"
    assert orbit.least is not None
    assert orbit.greatest is not None
    with mpmath.workprec(120):
        x, z, vy = (mpmath.mpf(value.numerator) / value.denominator for value in candidate.centre)
        half = exact_value(orbit.half_period.mid())
        share = mpmath.mpf(half.numerator) / half.denominator / 16
        least, greatest = (
            [mpmath.mpf(end.numerator) / end.denominator for end in bounds(extremum.distance)]
            for extremum in (orbit.least, orbit.greatest)
        )
        state, met = [x, mpmath.mpf(0), z, mpmath.mpf(0), vy, mpmath.mpf(0)], []
        for _ in range(17):
            met.append(mpmath.sqrt(sum(value**2 for value in state[:3])))
            state = extrapolated_flow(system, [], state, share, 1)
        assert all(least[0] - 1e-9 <= distance <= greatest[1] + 1e-9 for distance in met)
        assert least[1] - least[0] < 1e-9
        assert greatest[1] - greatest[0] < 1e-9
        assert min(met) - least[1] < 1e-2
        assert greatest[0] - max(met) < 1e-2
    assert verify(["--recheck", str(proved), "--jobs", "1", "--quiet"]) == 0
    capsys.readouterr()
    # The same certificate about another body, or one without a name.
    text = proved.read_text()
    for forged in (text.replace("the small body", "the large body"), text.replace("small body", "", 1)):
        proved.write_text(forged)
        assert verify(["--recheck", str(proved), "--jobs", "1", "--quiet"]) != 0
