"""The section about an orbit that is stable for ever: orbits of the return map run round the certified point."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from flint import arb

from orbitproof.figures.orbits import section_iterates
from orbitproof.shared.formats import COORDINATE, STABLE_ORBIT, Candidate, Equation
from orbitproof.shared.systems import FALKNER_SKAN
from orbitproof.verify.orbit import UNDECIDED, Stability
from orbitproof.verify.twist import StableOrbitResults

ONE = (Fraction(1),)
CLAIM = Candidate(
    id="stable",
    system=FALKNER_SKAN,
    parameters={},
    kind=STABLE_ORBIT,
    k=1,
    centre=(Fraction(400), Fraction(94, 100)),
    frame=((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))),
    kernel_frame=(ONE,),
    radii=(Fraction(1, 10**9),) * 2,
    equation=Equation(COORDINATE, Fraction(400), "beta"),
)
FOUND = StableOrbitResults(
    point={"beta": arb(400), "y": arb("0.93982617466928519")},
    other_point={},
    half_period=arb("0.21233347074324242"),
    period=arb("0.42466694148648482"),
    stability=Stability((), (), UNDECIDED),
    rotation_number=arb("0.37354682431067263"),
    twist_coordinate="y",
    twist_momentum="x",
    twist=arb("-3296.33"),
    defect=arb(0),
)


def test_orbits_of_the_return_map_turn_by_the_rotation_number() -> None:
    rows = section_iterates(CLAIM, FOUND, 6)
    assert rows.shape[1:] == (7, 2)
    y = float(FOUND.point["y"].mid())
    inner = rows[0]
    assert inner[0, 1] == 0
    assert 0 < inner[0, 0] - y < 2e-3
    # kappa^2 of section 28.2 for this orbit: 2.91434 / sin(omega).
    scale = np.sqrt(2.91434 / np.sin(2 * np.pi * float(FOUND.rotation_number.mid())))
    turned = np.unwrap(np.angle((inner[:, 0] - y) / scale + 1j * inner[:, 1] * scale))
    mean = abs(turned[-1] - turned[0]) / 6 / (2 * np.pi)
    assert abs(mean - float(FOUND.rotation_number.mid())) < 0.02
    assert np.all(np.diff(np.abs(rows[:, 0, 0] - y)) > 0)
