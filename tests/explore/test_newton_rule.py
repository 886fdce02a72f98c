"""When Newton's method ends."""

from __future__ import annotations

from math import inf, nan

import numpy as np
import pytest

from orbitproof.explore.numerics import NewtonRule

RULE = NewtonRule(tolerance=1e-12, accepted=1e-9, steps=8)


@pytest.mark.parametrize(
    "size, last, found, lost",
    [
        (1e-13, 1e-6, True, False),
        (1e-3, inf, False, False),
        (1e-4, 1e-2, False, False),
        (1e-10, 2e-10, True, False),
        (1e-10, 1e-6, False, False),
        (1e-5, 2e-5, False, False),
        (3e-2, 1e-2, False, True),
        (inf, 1.0, False, True),
        (nan, 1.0, False, True),
        (nan, nan, False, True),
    ],
    ids=[
        "below the tolerance",
        "first step",
        "shrinking",
        "stalled where rounding is accepted",
        "still shrinking where rounding is accepted",
        "stalled too early",
        "growing",
        "infinite",
        "not a number",
        "never a number",
    ],
)
def test_a_step_is_the_end_or_leads_on_or_away(size: float, last: float, found: bool, lost: bool) -> None:
    assert RULE.judge(size, last) == (found, lost)


def test_a_small_step_counts_only_if_the_equations_hold() -> None:
    assert RULE.judge(1e-13, 1e-6, exact=False) == (False, False)
    assert RULE.judge(1e-13, 1e-13, exact=False) == (True, False)


def test_many_iterations_are_judged_like_each_of_them() -> None:
    sizes = np.array([1e-13, 1e-3, 1e-10, nan, inf, 0.5])
    lasts = np.array([1.0, inf, 2e-10, 1.0, 1.0, 0.1])
    found, lost = RULE.judge(sizes, lasts)
    alone = [RULE.judge(float(size), float(last)) for size, last in zip(sizes, lasts, strict=True)]
    assert list(zip(found.tolist(), lost.tolist(), strict=True)) == alone
