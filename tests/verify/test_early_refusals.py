"""A claim that is refused without another attempt is not proved with more precision; one that is true is never so."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb
from support.balls import agree
from support.claims import known, moved, with_radii

from orbitproof.shared.formats import FOLD, Candidate
from orbitproof.verify.attempt import Limits, Verdict, accuracy_bits, first_precision
from orbitproof.verify.bifurcation.on_the_way import _iterate, _problem
from orbitproof.verify.certificate import certify
from orbitproof.verify.certificate.certifying import _attempt
from orbitproof.verify.certificate.kinds import enclose
from orbitproof.verify.evidence import NotProved, Proved, guarded
from orbitproof.verify.newton import BoxFunction
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import EarlyEnd, HalfReturns, IntegratorSettings, Returns, enclose_iterates

DIGITS = 30
LIMITS = Limits(max_precision=512)
KINDS = {1: FOLD, 2: "period_tupling", 3: "touch_and_go", 4: "period_tupling", 5: "touch_and_go"}


def outcome_with(claim: Candidate, bits: int) -> Verdict:
    """Of one attempt, in which no wish for accuracy breaks off the integration."""
    return _attempt(claim, bits, accuracy_bits(claim, 1), lambda fraction: None, enclose).outcome


def is_final(outcome: Verdict) -> bool:
    return isinstance(outcome, NotProved) and not outcome.reason.needs_precision


def with_multiplicity(claim: Candidate, k: int) -> Candidate:
    return replace(claim, kind=KINDS[k], k=k)


def false_claims(name: str, number: int) -> Iterator[Candidate]:
    """A true claim with another multiplicity, kind, centre or size of the box."""
    source, claim = random.Random(7), known(name)
    yield from (with_multiplicity(claim, k) for k in (1, 2, 3) if k != claim.k)
    for _ in range(number):
        factor = Fraction(source.choice((1, 3, 30, 10**4, 10**9)) * source.choice((-1, 1)))
        yield moved(claim, source.randrange(2), factor)
        wide, other = Fraction(2) ** source.randint(0, 24), Fraction(2) ** source.randint(-8, 24)
        yield with_radii(claim, other, wide)
        yield with_radii(with_multiplicity(claim, source.randint(2, 3)), wide, other)


@pytest.mark.parametrize(
    ("name", "number"), [("fs2", 2), *(pytest.param(name, 4, marks=pytest.mark.slow) for name in ("fs3", "fs4"))]
)
def test_what_is_refused_at_the_first_attempt_is_not_proved_with_more_precision(name: str, number: int) -> None:
    refused = 0
    for claim in false_claims(name, number):
        bits = first_precision(claim, DIGITS)
        if is_final(outcome_with(claim, bits)):
            refused += 1
            assert not isinstance(outcome_with(claim, 2 * bits), Proved), claim
    assert refused > number


@pytest.mark.parametrize("name", ["fs2", "fs3", pytest.param("fs5", marks=pytest.mark.slow), "em1"])
def test_a_true_claim_is_never_refused_for_good_for_want_of_precision(name: str) -> None:
    claim = known(name)
    enough = first_precision(claim, DIGITS)
    assert isinstance(outcome_with(claim, enough), Proved)
    starved = [outcome_with(claim, bits) for bits in (enough - 16, enough - 48, enough - 80)]
    assert any(isinstance(outcome, NotProved) for outcome in starved)
    assert not any(map(is_final, starved))


@pytest.mark.parametrize(("name", "k"), [("fs2", 1), ("fs3", 1), ("fs3", 2), ("fs4", 1), ("fs4", 2), ("fs5", 2)])
def test_a_wrong_multiplicity_is_excluded_at_the_first_attempt(name: str, k: int) -> None:
    found = certify(with_multiplicity(known(name), k), LIMITS)
    assert not found.proved
    assert found.computation.attempts == 1
    assert found.reason is not None
    words = ("branch off or merge in the box", "there is no such point in the box")
    assert any(word in found.reason.message for word in words)


@pytest.mark.parametrize(
    ("name", "k", "returns"), [("fs2", 3, 2), ("fs2", 4, 2), ("fs3", 4, 2), ("fs4", 3, 2), ("fs3", 6, 3), ("em1", 3, 1)]
)
def test_a_wrong_multiplicity_is_refused_before_its_orbits_are_followed_to_the_end(
    name: str, k: int, returns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[int] = []
    plain = Returns.next_crossing

    def counted(self: Returns, progress: Any = None) -> Any:
        found = plain(self, progress)
        seen.append(self.crossings)
        return found

    monkeypatch.setattr(Returns, "next_crossing", counted)
    claim = replace(known(name), kind="touch_and_go" if k == 3 else "period_tupling", k=k, symmetry=None)
    found = certify(claim, LIMITS)
    assert not found.proved
    assert found.computation.attempts == 1
    assert seen == list(range(1, returns + 1))
    # P^k was not enclosed over the box, and nothing is said of it there.
    assert found.reason is not None
    assert f"P^{k} over it" not in found.reason.message
    assert (found.reason.condition == "multiplicity") == ("by P and P^2" in found.reason.message)


@pytest.mark.parametrize("name", ["fs3", "fs4", pytest.param("em3", marks=pytest.mark.slow)])
def test_two_half_returns_give_the_derivatives_of_all(name: str) -> None:
    claim = known(name)
    half_returns: list[HalfReturns] = []
    bits = first_precision(claim, DIGITS)
    with guarded(bits):
        settings = IntegratorSettings(bits, accuracy=(0, 0))
        watch = EarlyEnd(settings.accuracy, lambda _claim, returns: half_returns.append(returns))
        found = enclose_iterates(claim, settings, ORACLE, None, watch)
        assert [len(returns.kernels) for returns in half_returns] == list(range(1, claim.k))
        problem = _problem(claim, half_returns[1])
        for i, tables in enumerate(found.iterates, start=1):
            derived = _iterate(replace(claim, k=i), problem, half_returns[1])
            for row, table in enumerate(tables):
                # At the centre, which is on the family but for its last digits.
                for column, ball in enumerate(BoxFunction(table).gradient([arb(0)] * len(claim.radii), 0)):
                    assert agree(derived[row, column], ball)
                    assert derived[row, column].rad() < 1e-6 * (1 + abs(ball))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "k"), [("em3", 1), ("em4", 1), ("em4", 2), ("em4", 3), ("em2", 1)])
def test_wrong_multiplicities_of_halo_orbits_are_excluded_too(name: str, k: int) -> None:
    found = certify(with_multiplicity(known(name), k), LIMITS)
    assert not found.proved
    assert found.computation.attempts <= 2
