"""Orbits at which invariant tori accumulate: springs with known torsion, certificates, refusals."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import arb
from support import tori_cases as cases
from support.balls import agree
from support.springs import BITS, exactly
from support.springs import claim as soft_claim
from support.within import within

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import INVARIANT_TORI, candidate_from_json, candidate_to_json
from orbitproof.shared.systems import SYSTEMS
from orbitproof.verify.certificate import Certificate, Limits, certify
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import NotProved, Proved, Reason, bounds
from orbitproof.verify.orbit import OrbitTheorem
from orbitproof.verify.tori import ToriResults, ToriTheorem, theorem_of_tori

LIMITS = Limits(digits=12, max_precision=128)

precision = within(lambda: mpmath.workprec(BITS))


@pytest.fixture(scope="module")
def certificate() -> Certificate:
    with mpmath.workprec(BITS):
        return certify(cases.claim(cases.BENT), LIMITS)


def outcome(springs: cases.Springs) -> Any:
    return _conclude(cases.claim(springs), 160, cases.enclosures(springs))


def holds(ball: Any, value: Any) -> bool:
    low, high = bounds(ball)
    return bool(low - Fraction(1, 2**80) <= exactly(value) <= high + Fraction(1, 2**80))


def test_the_torsion_of_springs_is_known() -> None:
    found = outcome(cases.BENT)
    assert isinstance(found, Proved), found.reason
    assert isinstance(found.results, ToriResults)
    cosines, torsion = cases.expected(cases.BENT)
    for rotation, cosine in zip(found.results.rotation_numbers, cosines, strict=True):
        assert holds((2 * rotation).cos_pi(), cosine)
    for row, wanted in zip(found.results.torsion, torsion, strict=True):
        for ball, value in zip(row, wanted, strict=True):
            assert holds(ball, value)
            assert float(ball.rad()) < 1e-8
    determinant = torsion[0][0] * torsion[1][1] - torsion[0][1] * torsion[1][0]
    assert holds(found.results.torsion_determinant, determinant)
    for parameter, cosine in zip(found.results.stability.parameters, cosines, strict=True):
        assert holds(parameter.real, cosine)


REFUSED = {
    "degenerate": (cases.LINEAR, "torsion"),
    "resonant": (cases.RESONANT, "non-resonance"),
    "unstable": (cases.UNSTABLE, "elliptic"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_nothing_is_proved_of_springs_that_are(name: str) -> None:
    springs, condition = REFUSED[name]
    found = outcome(springs)
    assert isinstance(found, NotProved)
    assert found.reason.condition == condition
    assert [hypothesis.name for hypothesis in found.hypotheses][-1] == condition


def test_hypotheses_are_those_of_the_orbit_and_four_more() -> None:
    claim = cases.claim(cases.BENT)
    assert ToriTheorem(claim).hypotheses == (
        *OrbitTheorem(claim).hypotheses, "full-return", "elliptic", "non-resonance", "torsion"
    )  # fmt: skip


def intervals(text: str) -> list[tuple[float, float]]:
    return [(float(low), float(high)) for low, high in re.findall(r"\[(-?[0-9][^,\]]*), ([^\]]+)\]", text)]


def tells(interval: tuple[float, float], ball: arb) -> bool:
    """Whether it is an interval that contains the ball, and is not much wider."""
    low, high = interval
    slack = 1e-15 * abs(low)
    inside = low - slack <= float(ball.lower()) <= float(ball.upper()) <= high + slack
    return inside and high - low <= 25 * float(ball.rad()) + 4 * slack


def test_numbers_are_told_under_their_names(certificate: Certificate) -> None:
    found, told = certificate.results, certificate.statement["in_full"]
    assert isinstance(found, ToriResults)
    first, second = found.rotation_numbers
    assert 0 < float(second) < float(first) < 0.5
    for rotation, parameter in zip(found.rotation_numbers, found.stability.parameters, strict=True):
        assert agree((2 * rotation).cos_pi(), parameter.real)
    (line,) = [line for line in told.splitlines() if line.startswith("The rotation numbers")]
    assert all(map(tells, intervals(line), found.rotation_numbers))
    assert len(intervals(line)) == 2
    (line,) = [line for line in told.splitlines() if "tau_11 in" in line]
    entries, determinant = line.split("there are ")[1].split("; the determinant lies in ")
    for j, row in enumerate(found.torsion, start=1):
        for position, ball in enumerate(row, start=1):
            (at,) = intervals(entries.split(f"tau_{j}{position} in ")[1].split(", tau_")[0])
            assert tells(at, ball)
    assert tells(intervals(determinant)[0], found.torsion_determinant)
    assert certificate.parameter is not None
    assert agree(certificate.parameter, found.period)
    assert not certificate.parameter.overlaps(found.half_period)


def test_a_system_with_one_pair_is_refused() -> None:
    claim = replace(
        soft_claim(111, Fraction(8), 1, (Fraction(1, 2**50), Fraction(1, 2**54)), Fraction(1, 2)), kind=INVARIANT_TORI
    )
    found = certify(claim, LIMITS)
    assert not found.proved
    assert found.reason is not None
    assert "n = 2, and springs has n = 1" in found.reason.message


def test_a_claim_is_read_as_it_was_written_and_has_an_equation() -> None:
    claim = cases.claim(cases.BENT)
    assert isinstance(theorem_of_tori(claim), ToriTheorem)
    assert isinstance(theorem_of_tori(replace(claim, kind="orbit")), Reason)
    entry = candidate_to_json(claim)
    known = {**SYSTEMS, claim.system.name: claim.system}
    assert candidate_from_json(entry, "file", known).kind == INVARIANT_TORI
    with pytest.raises(InputError, match="equation"):
        replace(claim, equation=None)
    with pytest.raises(InputError, match="k"):
        candidate_from_json({**entry, "k": 2}, "file", known)
