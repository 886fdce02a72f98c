"""Taylor coefficients of the centre's orbit."""

from __future__ import annotations

from fractions import Fraction

import pytest

from orbitproof.shared.systems import FALKNER_SKAN
from orbitproof.verify.algebra import prepare
from orbitproof.verify.oracle.centre import fixed_coefficients, rescaled


@pytest.mark.parametrize("share", [Fraction(1), Fraction(5, 8), Fraction(0x1234567890ABCDEF, 2**64)])
def test_a_shorter_step_has_the_coefficients_of_the_longer_one_rescaled(share: Fraction) -> None:
    bits, degree, step = 120, 40, Fraction(3, 8)
    program = prepare(FALKNER_SKAN.program)
    start = [int(Fraction(1, n + 2) * 2**bits) for n in range(program.inputs)]
    longer, shorter = (fixed_coefficients(program, start, degree, bits, size) for size in (step, step * share))
    found = rescaled(longer, bits, share)
    assert any(value for row in longer for value in row[degree // 2 :])
    assert all(abs(x - y) < 2**10 for a, b in zip(found, shorter, strict=True) for x, y in zip(a, b, strict=True))
