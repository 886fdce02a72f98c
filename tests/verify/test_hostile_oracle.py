"""Whatever an oracle answers, nothing false follows: what is enclosed all the same is what it would have been."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from support.balls import agree
from support.claims import known

from orbitproof.shared import define_system
from orbitproof.verify import enclose
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import planned_step
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import Enclosures, IntegratorSettings, enclose_iterates

SETTINGS = IntegratorSettings(100)
REFUSALS = (IntegrationFailure, ArithmeticError, ValueError)

STEPS = (float("nan"), float("inf"), -1.0, 0.0, 1e-9, 1e-4, 0.03, 0.3, 3.0, 300.0)
SHARES = (Fraction(-1), Fraction(0), Fraction(1, 3), Fraction(3, 4), Fraction(1), Fraction(5, 2))


@dataclass
class Hostile:
    """An expansion that says something else than what it has found, some of the times."""

    honest: Any
    source: random.Random
    often: float

    def __post_init__(self) -> None:
        self.step_size = self.maybe(self.honest.step_size, lambda: self.source.choice(STEPS))

    def maybe(self, honest: Any, hostile: Callable[[], Any]) -> Any:
        return hostile() if self.source.random() < self.often else honest

    def shortened(self, step: Fraction) -> Fraction:
        return self.maybe(self.honest.shortened(step), lambda: step * self.source.choice(SHARES))

    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        root = self.honest.crossing(section, step, starts_on_section)
        return self.maybe(root, lambda: self.source.choice((None, *SHARES)))

    def solve(self, along: Any, step: Fraction) -> None:
        self.honest.solve(along, self.maybe(step, lambda: step * self.source.choice(SHARES[2:])))


@dataclass
class HostileOracle:
    """Hands out such expansions, and any coordinates."""

    source: random.Random
    often: float

    def expand(self, *arguments: Any) -> Hostile:
        return Hostile(ORACLE.expand(*arguments), self.source, self.often)

    def return_times(self, *arguments: Any) -> list[Fraction] | None:
        return [self.source.choice(SHARES) for _ in range(3)]

    def regularised_steps(self, *arguments: Any) -> int:
        return self.source.choice((-3, 0, 1, 10**9))


def all_agree(one: Enclosures, other: Enclosures) -> bool:
    """Whether two enclosures of the same numbers have common points throughout."""
    pairs = zip(sum(one.iterates, ()), sum(other.iterates, ()), strict=True)
    tables = all(agree(a.box[alpha], b.box[alpha]) for a, b in pairs for alpha in a.box)
    return tables and all(agree(a, b) for a, b in zip(one.return_times, other.return_times, strict=True))


@pytest.mark.parametrize("name", ["fs2", "em1"])
def test_what_is_enclosed_with_absurd_answers_is_true(name: str) -> None:
    claim = known(name)
    honest = enclose_iterates(claim, SETTINGS, ORACLE)
    enclosed = refused = 0
    for seed in range(12):
        source = random.Random(f"{name} {seed}")
        try:
            found = enclose_iterates(claim, SETTINGS, HostileOracle(source, source.choice((0.02, 0.1, 0.5))))
        except REFUSALS:
            refused += 1
            continue
        enclosed += 1
        assert all_agree(found, honest)
    assert enclosed
    assert refused


def test_an_approximate_solution_over_another_time_is_no_solution() -> None:
    """The defect is that of the step that is taken, not of the one for which the oracle has solved."""

    class Elsewhere(HostileOracle):
        def expand(self, *arguments: Any) -> Hostile:
            found = Hostile(ORACLE.expand(*arguments), self.source, 0.0)
            found.maybe = lambda honest, hostile: honest * Fraction(9, 8) if isinstance(honest, Fraction) else honest  # type: ignore[method-assign]
            found.shortened = found.honest.shortened  # type: ignore[method-assign]
            found.crossing = found.honest.crossing  # type: ignore[method-assign]
            return found

    with pytest.raises(REFUSALS):
        enclose_iterates(known("fs2"), SETTINGS, Elsewhere(random.Random(1), 0.0))


DAMPED = define_system({"name": "damped", "state": "x y", "field": {"x": "y", "y": "-x - y"}})
BREAKDOWNS = (
    OverflowError("int too large"),
    ZeroDivisionError(),
    np.linalg.LinAlgError("singular"),
    TypeError("complex"),
)


def raising(error: Exception) -> Callable[..., Any]:
    def broken(*_: Any, **__: Any) -> Any:
        raise error

    return broken


@pytest.mark.parametrize("error", BREAKDOWNS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("where", ["solution.fixed_coefficients", "solution.LinearEquation"])
def test_a_search_that_breaks_down_is_a_reason(where: str, error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"orbitproof.verify.oracle.{where}", raising(error))
    found = enclose.flow(DAMPED, enclose.box({"x": 1, "y": 0}, radii={"x": "1e-9"}), 1)
    assert not found
    assert "no approximate solution was found" in found.reason.message
    assert type(error).__name__ in found.reason.message


@pytest.mark.parametrize("where", ["numpy.linalg.qr", "orbitproof.verify.oracle.frames._integers"])
def test_without_a_frame_errors_are_bounded_all_the_same(where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    box = enclose.box({"x": 1, "y": 0}, radii={"x": "1e-9"})
    honest = enclose.flow(DAMPED, box, 1)
    monkeypatch.setattr(where, raising(OverflowError("int too large")))
    found = enclose.flow(DAMPED, box, 1)
    assert honest
    assert found
    assert all(agree(found.value[name], honest.value[name]) for name in DAMPED.state)


@pytest.mark.parametrize("size", STEPS)
def test_a_step_is_a_positive_number_or_there_is_a_reason(size: float) -> None:
    if 1e-8 <= size < float("inf"):
        assert 0 < planned_step(size, 0.5, 0.0) <= size
    else:
        with pytest.raises(IntegrationFailure, match="only a step of"):
            planned_step(size, 0.5, 0.0)
