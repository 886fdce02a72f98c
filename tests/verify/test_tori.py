"""Orbits at which invariant tori accumulate: springs with known torsion, certificates, refusals."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import mpmath
import pytest
from flint import arb
from support import tori_cases as cases
from support.forgeries import forged
from support.springs import BITS, exactly
from support.springs import claim as soft_claim

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import INVARIANT_TORI, candidate_from_json, candidate_to_json
from orbitproof.shared.systems import SYSTEMS, FixedLevel
from orbitproof.verify.certificate import Certificate, Level, Limits, certify, recheck
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import NotProved, Proved, Reason, bounds, indices_up_to
from orbitproof.verify.orbit import OrbitTheorem
from orbitproof.verify.poincare import HalfReturn
from orbitproof.verify.tori import ToriResults, ToriTheorem, theorem_of_tori
from orbitproof.verify.words.tori import _where, tori_in_words

LIMITS = Limits(digits=12, max_precision=128)


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    with mpmath.workprec(BITS):
        yield


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


def with_nan(row: tuple[arb, ...]) -> tuple[arb, ...]:
    """The third derivative by p_1 is no number."""
    indices = sorted(indices_up_to(5, 3))
    return tuple(arb("nan") if index == (0, 3, 0, 0, 0) else ball for index, ball in zip(indices, row, strict=True))


def test_enclosures_that_lack_something_prove_nothing() -> None:
    claim, found = cases.claim(cases.BENT), cases.enclosures(cases.BENT)
    half = found.half_return
    assert half.first_integral is not None
    for lacking in (
        HalfReturn((), None),
        replace(half, image=half.image[1:]),
        replace(half, first_integral=None),
        replace(half, first_integral=half.first_integral[1:]),
        replace(half, image=(*half.image[:-1], tuple(0 * ball for ball in half.image[-1]))),
        replace(half, image=(*half.image[:-1], tuple(ball * float("inf") for ball in half.image[-1]))),
        replace(half, image=(*half.image[:-1], with_nan(half.image[-1]))),
    ):
        outcome = _conclude(claim, 160, replace(found, half_return=lacking))
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "full-return"


def test_a_certificate_says_what_is_proved_and_no_more(certificate: Certificate) -> None:
    assert certificate.proved, certificate.reason
    assert str(certificate).startswith("tori, proved, period = ")
    theorem = certificate.theorem or ""
    assert (
        "on its level of the first integral, every neighbourhood of the orbit contains tori of dimension 3" in theorem
    )
    assert "It is not stability: tori of dimension 3 do not separate the set of dimension 5" in theorem
    told = certificate.statement["in_full"]
    assert "tau_11 in " in told
    assert "the determinant lies in " in told
    assert told.endswith("That the orbit is stable is not claimed.")
    assert certificate.orbit is not None


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
        assert (2 * rotation).cos_pi().overlaps(parameter.real)
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
    assert certificate.parameter.overlaps(found.period)
    assert not certificate.parameter.overlaps(found.half_period)


def test_where_the_tori_are_is_told() -> None:
    claim = cases.claim(cases.BENT)
    assert "on its level of the first integral, every neighbourhood" in tori_in_words(ToriTheorem(claim))
    for fixed, words in (
        (None, "at its value of the family parameter"),
        (FixedLevel(Fraction(1), 1), "on the level, at its value of the family parameter"),
    ):
        system = SimpleNamespace(family_parameter="w1", fixed_level=fixed)
        assert _where(SimpleNamespace(system=system)) == words  # type: ignore[arg-type]


def test_a_certificate_stands_at_all_levels(certificate: Certificate) -> None:
    again = recheck(certificate)
    assert again.stands, again.findings
    assert again.passed is Level.CONCLUSION
    assert Certificate.from_json(certificate.to_json()).to_json() == certificate.to_json()


@pytest.mark.slow
def test_a_new_integration_confirms_it(certificate: Certificate) -> None:
    again = recheck(certificate, integrate=True)
    assert again.stands, again.findings
    assert again.passed is Level.INTEGRATION


def _shift(entry: Any) -> None:
    entry["mid"] = "0x1" if entry["mid"] != "0x1" else "0x3"


CHANGES: dict[str, Callable[[Any], Any]] = {
    "torsion": lambda entry: _shift(entry["results"]["torsion"][0][1]),
    "determinant": lambda entry: _shift(entry["results"]["torsion_determinant"]),
    "rotation number": lambda entry: _shift(entry["results"]["rotation_numbers"][1]),
    "rotation numbers exchanged": lambda entry: entry["results"]["rotation_numbers"].reverse(),
    "no resonance looked at": lambda entry: entry["hypotheses"].pop(-2),
    "another half return": lambda entry: entry["enclosures"]["half_return"]["image"].reverse(),
    "a derivative less": lambda entry: entry["enclosures"]["half_return"]["image"][0].pop(),
    "no first integral": lambda entry: entry["enclosures"]["half_return"].pop("first_integral"),
    "an orbit alone": lambda entry: entry["statement"]["candidate"].update(kind="orbit"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_forged_certificates_are_refused(certificate: Certificate, change: str) -> None:
    entry = forged(certificate.to_json(), CHANGES[change])
    try:
        again = recheck(Certificate.from_json(entry))
    except InputError:
        return
    assert not again.stands


def test_the_certificate_of_the_orbit_is_none_of_tori(certificate: Certificate) -> None:
    alone = certify(replace(cases.claim(cases.BENT), kind="orbit"), LIMITS)
    assert alone.proved
    entry = copy.deepcopy(alone.to_json())
    changed = forged(entry, lambda content: content["statement"]["candidate"].update(kind=INVARIANT_TORI))
    try:
        again = recheck(Certificate.from_json(changed))
    except InputError:
        return
    assert not again.stands


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
