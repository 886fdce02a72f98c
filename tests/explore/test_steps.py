"""Steps along a curve, where some fail."""

from __future__ import annotations

from itertools import islice

import pytest

from orbitproof.explore.numerics import NoStep, walked


def test_steps_are_halved_where_they_fail_and_grow_as_they_say() -> None:
    tried = []

    def advance(step: float) -> tuple[float, float]:
        tried.append(step)
        if step > 0.3:
            raise ValueError("too far")
        return step, 3 * step

    assert list(islice(walked(advance, 1.0, 0.01, (ValueError,)), 3)) == [0.25, 0.1875, 0.28125]
    assert tried == [1.0, 0.5, 0.25, 0.75, 0.375, 0.1875, 0.5625, 0.28125]


def test_the_last_failure_is_told_where_no_step_leads_on() -> None:
    def advance(step: float) -> tuple[float, float]:
        raise ValueError(f"not even {step}")

    with pytest.raises(NoStep, match=r"not even 0\.25"):
        next(walked(advance, 1.0, 0.25, (ValueError,)))


def test_other_exceptions_are_not_failures_of_a_step() -> None:
    def advance(step: float) -> tuple[float, float]:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        next(walked(advance, 1.0, 0.25, (ValueError,)))
