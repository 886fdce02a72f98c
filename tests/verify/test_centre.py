"""Taylor coefficients of the centre's orbit."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from orbitproof.shared.systems import CR3BP, FALKNER_SKAN
from orbitproof.verify.algebra import prepare
from orbitproof.verify.oracle.centre import (
    fixed_coefficients,
    float_coefficients,
    rescaled,
    variation_coefficients,
)


@pytest.mark.parametrize("share", [Fraction(1), Fraction(5, 8), Fraction(0x1234567890ABCDEF, 2**64)])
def test_a_shorter_step_has_the_coefficients_of_the_longer_one_rescaled(share: Fraction) -> None:
    bits, degree, step = 120, 40, Fraction(3, 8)
    program = prepare(FALKNER_SKAN.program)
    start = [int(Fraction(1, n + 2) * 2**bits) for n in range(program.inputs)]
    longer, shorter = (fixed_coefficients(program, start, degree, bits, size) for size in (step, step * share))
    found = rescaled(longer, bits, share)
    assert any(value for row in longer for value in row[degree // 2 :])
    assert all(abs(x - y) < 2**10 for a, b in zip(found, shorter, strict=True) for x, y in zip(a, b, strict=True))


@pytest.mark.parametrize("bits", [60, 120, 700])
def test_late_coefficients_are_as_exact_as_those_before(bits: int) -> None:
    """Against more bits, at a step that suits the format and at one that does not; with a power and parameters."""
    program, degree = prepare(CR3BP.program), bits // 2
    start = [Fraction(value) for value in ("0.8", "0.1", "0.05", "0.02", "0.2", "-0.1", "0.0121505")]
    for step in (Fraction(1, 32), Fraction(3, 32)):
        found, finer = (
            fixed_coefficients(program, [int(x * 2**own) for x in start], degree, own, step)
            for own in (bits, bits + 400)
        )
        worst = [
            max(abs(x - (y >> 400)) for x, y in zip(*pair, strict=True)) for pair in zip(found, finer, strict=True)
        ]
        assert max(worst) < 2**12
        assert any(row[-1] for row in finer)


def test_the_orbit_beside_its_variation_is_the_orbit_and_a_difference_quotient_the_variation() -> None:
    program, degree = prepare(CR3BP.program), 12
    start = [0.8, 0.1, 0.05, 0.02, 0.2, -0.1, 0.0121505]
    orbit, variation = variation_coefficients(program, start, degree)
    alone, nearby = (
        np.array(float_coefficients(program, [x + size / (1 + n) * (n < 6) for n, x in enumerate(start)], degree))
        for size in (0.0, 1e-7)
    )
    np.testing.assert_allclose(orbit, alone, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(variation, (nearby - alone) / 1e-7, rtol=1e-3, atol=1e-5)
