"""Reports of bifurcations of periodic orbits without symmetry."""

from __future__ import annotations

from pathlib import Path

from support import periodic_bifurcation_cases as cases

from orbitproof import verify
from orbitproof.figures.commands.report import main


def test_a_report_tells_the_theorem_with_its_interval_and_margins(tmp_path: Path) -> None:
    path, output = tmp_path / "certificates.json", tmp_path / "report.md"
    verify.write(str(path), verify.certify(cases.breaking(), quiet=True))
    assert main([str(path), "-o", str(output)]) == 0
    told = output.read_text()
    for words in (
        "A symmetry breaking of periodic orbits",
        "`parameter_radius`",
        "`kernel[0][1]`",
        "`kernel_radius`",
        "`symmetry[2][2]`",
        "widths from 0",
    ):
        assert words in told, words
