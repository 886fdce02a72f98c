"""Where the symmetry breaking of L3 goes as the mass tends to 0: enclosed, simple, and where computed curves go."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import acb, arb, ctx

from orbitproof.explore.three_body.masses import chart_of, correct_at
from orbitproof.verify.evidence import enclose
from orbitproof.verify.surface import kepler_limit as chapter
from orbitproof.verify.surface.kepler_limit import LOWER, UPPER, kepler_limit, melnikov


def test_the_zero_is_enclosed_and_simple() -> None:
    found = kepler_limit()
    assert found is not None
    assert found.eccentricity.contains(arb("0.70721427031"))
    assert found.eccentricity.rad() < 1e-8
    assert found.slope < -10
    assert found.slope > -11


def test_the_function_is_that_of_independent_quadrature() -> None:
    with mpmath.workdps(20), ctx.workprec(96):
        for e in (0.3, 0.6, 0.7, 0.8):
            value = mpmath.mpf(e)
            b = mpmath.sqrt(1 - value**2)

            def place(anomaly: mpmath.mpf, value: mpmath.mpf = value, b: mpmath.mpf = b) -> tuple[mpmath.mpf, ...]:
                time, rate = anomaly - value * mpmath.sin(anomaly), 1 - value * mpmath.cos(anomaly)
                position = mpmath.matrix([value - mpmath.cos(anomaly), -b * mpmath.sin(anomaly)])
                velocity = mpmath.matrix([mpmath.sin(anomaly), -b * mpmath.cos(anomaly)]) / rate
                other = mpmath.matrix([mpmath.cos(time), mpmath.sin(time)])
                near = mpmath.norm(position - other) ** -3
                return position, velocity, -(position - other) * near - other, other, near, rate

            def turn(anomaly: mpmath.mpf, b: mpmath.mpf = b) -> mpmath.mpf:
                position, velocity, force, _, _, rate = place(anomaly)
                torque = position[0] * force[1] - position[1] * force[0]
                return (-force[0] * b - velocity[0] * torque) * rate

            def wronskian(anomaly: mpmath.mpf, value: mpmath.mpf = value) -> mpmath.mpf:
                *_, other, near, rate = place(anomaly)
                return other[0] * (1 - near) * (mpmath.cos(anomaly) - value) / (1 - value) * rate

            ends = [0, mpmath.pi / 2, mpmath.pi]
            first, second = mpmath.quad(turn, ends), mpmath.quad(wronskian, ends)
            expected = mpmath.sqrt((1 + value) / (1 - value)) * first - value * second
            assert abs(float(melnikov(acb(enclose(Fraction(e)))).real) - float(expected)) < 1e-12


def test_computed_symmetry_breakings_go_there_and_the_jacobi_constant_increases() -> None:
    chart = chart_of("L3")
    limit = float((LOWER + UPPER) / 2)
    at_limit = 1 + 2 * np.sqrt(1 - limit**2)
    unknowns = np.array([limit - 1, 1 - limit - np.sqrt((1 + limit) / (1 - limit)), -1.817, 0.0])
    for mu in (1e-6, 1e-5):
        unknowns[3] = np.log(mu)
        point = correct_at(chart, unknowns)
        assert point.scaled[0] == pytest.approx(limit - 1, abs=2 * mu)
        assert (point.jacobi_constant - at_limit) / mu == pytest.approx(0.752, abs=0.01)


@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        ("0.6", "0.61"), ("0.5", "0.9"),
        # The sign is the same at both ends, and the slope is known.
        ("0.6", "0.60000001"), ("0.8", "0.80000001"),
        # It changes, and the slope is not known to differ from 0 on so wide a range.
        ("0.7", "0.715"),
    ],
)  # fmt: skip
def test_where_no_simple_zero_is_shown_nothing_is_claimed(
    lower: str, upper: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chapter, "LOWER", Fraction(lower))
    monkeypatch.setattr(chapter, "UPPER", Fraction(upper))
    assert kepler_limit() is None


def test_the_slope_is_enclosed_between_the_ends() -> None:
    found = kepler_limit()
    assert found is not None
    with ctx.workprec(160):
        step = Fraction(1, 2**40)
        for e in (LOWER, UPPER):
            low, high = (melnikov(acb(enclose(e + sign * step))).real for sign in (-1, 1))
            # The third derivative is far below 2^40 there.
            slope = (high - low) / (2 * enclose(step)) + arb(0, 2.0**-40)
            assert found.slope.contains(slope)
