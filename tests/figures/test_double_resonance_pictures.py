"""The picture of where two resonances meet: its curves are those of the enclosed coefficients."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from flint import arb

from orbitproof.figures.pictures import draw_double_resonance
from orbitproof.figures.style import close
from orbitproof.shared.formats import read_candidates
from orbitproof.verify.double_resonance import ResonanceResults

CLAIM = Path(__file__).parents[1] / "data" / "double-resonance.json"


def test_the_curves_are_those_of_the_coefficients() -> None:
    (candidate,) = read_candidates(CLAIM)
    one = arb(1)
    point = dict.fromkeys(candidate.coordinates, one)
    kappa = arb(3) / 8
    found = ResonanceResults(point, "mu", one, "above", 1, "minimum", one, one, "vy", arb(-4), arb(3), kappa)
    figure = draw_double_resonance(candidate, found)
    families, resonances = figure.axes
    (curve,) = (line for line in resonances.lines if len(line.get_xdata()) > 10)
    assert np.asarray(curve.get_xdata()) == pytest.approx(3 / 8 * np.asarray(curve.get_ydata()) ** 2)
    below, at, above = (line for line in families.lines if len(line.get_xdata()) > 10)
    assert min(np.asarray(below.get_ydata())) > 0
    assert min(np.asarray(at.get_ydata())) == 0
    assert min(np.asarray(above.get_ydata())) < 0
    ends = next(line for line in families.lines if line.get_marker() == "." and len(line.get_xdata()) == 2)
    x, y = np.asarray(above.get_xdata()), np.asarray(above.get_ydata())
    assert np.interp(ends.get_xdata()[1], x, y) == pytest.approx(0.0, abs=1e-7)
    close(figure)
