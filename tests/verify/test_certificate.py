"""Certificates: exact balls, outward decimals, and nothing that could pass for a proof."""

from __future__ import annotations

import json
from fractions import Fraction as F
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from support.balls import agree
from support.claims import TOUCH_AND_GO

from orbitproof.shared import InputError
from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import candidate_from_json
from orbitproof.verify.attempt import Limits, first_precision
from orbitproof.verify.certificate import (
    Certificate,
    Computation,
    certify,
    digest,
    is_proof_of,
    make_certificate,
    read_certificates,
    write_certificates,
)
from orbitproof.verify.evidence import (
    DerivativeTable,
    IntegrationFailure,
    NotProved,
    Reason,
    ball_from_json,
    ball_to_json,
    bounds,
    certain_digits,
    count_certain_digits,
    decimal_interval,
    enclose,
    exact_value,
    located,
    range_text,
)
from orbitproof.verify.poincare import Enclosures, IntegratorSettings

FALKNER_SKAN = {**TOUCH_AND_GO, "id": "falkner-skan k=3"}


def candidate(**changes: Any) -> Candidate:
    return candidate_from_json({**FALKNER_SKAN, **changes}, "test")


COMPUTATION = Computation(64, 16, 1, 1, 0.0)

balls = st.builds(
    lambda m, e, r, s: arb((m, e), arb((r, e + s)) if r else 0),
    st.integers(-(2**300), 2**300),
    st.integers(-2000, 200),
    st.integers(0, 2**40),
    st.integers(-200, 300),
)


@given(balls, st.sampled_from([53, 200, 1000]))
def test_a_ball_reads_back_to_the_same_ball(ball: arb, precision: int) -> None:
    text = json.dumps(ball_to_json(ball))
    with ctx.workprec(precision):
        again = ball_from_json(json.loads(text))
    assert exact_value(again.mid()) == exact_value(ball.mid())
    assert exact_value(again.rad()) == exact_value(ball.rad())


def ends(text: str) -> tuple[F, F]:
    low, high = text.strip("[]").split(", ")
    return F(low), F(high)


@given(balls, st.integers(3, 60))
def test_decimals_are_rounded_outward(ball: arb, digits: int) -> None:
    lower, upper = bounds(ball)
    low, high = ends(decimal_interval(ball, digits))
    assert low <= lower <= upper <= high
    size = max(abs(lower), abs(upper))
    assert high - low <= (upper - lower) + 2 * max((upper - lower) / 5, size * F(10) ** (2 - digits))


@given(balls, st.integers(3, 60))
def test_both_ends_of_a_range_keep_their_digits(ball: arb, digits: int) -> None:
    lower, upper = bounds(ball)
    low, high = ends(range_text(ball, digits))
    assert lower - abs(lower) * F(10) ** (1 - digits) <= low <= lower
    assert upper <= high <= upper + abs(upper) * F(10) ** (1 - digits)


def test_what_is_zero_is_said_to_be_zero() -> None:
    assert located("z", arb(0), 20) == "z = 0"
    assert located("z", arb(2), 20).startswith("z in [2")


@given(balls, st.integers(3, 60))
def test_common_digits_notation_contains_the_ball(ball: arb, digits: int) -> None:
    lower, upper = bounds(ball)
    text = certain_digits(ball, digits)
    if text.startswith("["):
        low, high = ends(text)
    elif "[" in text:
        stem, rest = text.split("[")
        first, last = rest.rstrip("]").split(",")
        low, high = sorted((F(stem + first), F(stem + last)))
    else:
        low = high = F(text)
    assert low <= lower <= upper <= high


def test_common_digits_notation_of_known_balls() -> None:
    assert certain_digits(arb("3.02161925", 2e-7)) == "3.021619[04,46]"
    assert certain_digits(arb("-3.02161925", 2e-7)) == "-3.021619[04,46]"
    assert certain_digits(arb(0, 1)) == "[-1.1, 1.1]"
    assert certain_digits(arb("nan")) == "not finite"
    assert count_certain_digits(arb("3.02161925", 2e-7)) == 7


@pytest.mark.parametrize("ball", [arb("nan"), arb("inf"), arb(0, "inf")])
def test_a_ball_that_is_not_finite_has_no_text(ball: arb) -> None:
    with pytest.raises(ValueError, match="not finite"):
        ball_to_json(ball)


@pytest.mark.parametrize(
    "entry",
    [{"mid": "0x1", "rad": "-0x1"}, {"mid": "0.1", "rad": "0x0"}, {"mid": "0x1", "rad": "0x1234567890abcdef1"},
     {"mid": "nan", "rad": "0x0"}],
)  # fmt: skip
def test_text_that_is_no_ball_is_refused(entry: dict[str, str]) -> None:
    with pytest.raises(ValueError):
        ball_from_json(entry)


@pytest.fixture(scope="module")
def proved() -> Certificate:
    return certify(candidate())


def test_the_falkner_skan_point_is_proved_to_thirty_digits(proved: Certificate) -> None:
    assert proved.verdict == "proved"
    assert count_certain_digits(proved.parameter) >= 30
    # The paper prints 453.442586821384637563 and G_11 in -[27.1801, 27.1803].
    assert abs(proved.parameter - arb("453.442586821384637563")) < 1e-12
    second = next(hypothesis for hypothesis in proved.hypotheses if hypothesis.name == "G_11").enclosures["G_11"]
    assert agree(second, arb("-27.1802", 1e-4))
    assert proved.side == "both"


def test_certificates_are_read_back_as_written(proved: Certificate, tmp_path: Path) -> None:
    path = tmp_path / "certificates.json"
    write_certificates(path, [proved])
    assert read_certificates(path) == {proved.id: proved}
    assert is_proof_of(read_certificates(path)[proved.id], candidate())


def test_a_file_has_one_certificate_of_an_id(tmp_path: Path) -> None:
    path = tmp_path / "certificates.json"
    outcome = NotProved(Reason("C3", "what", "try"))
    entries = [make_certificate(candidate(id=name), outcome, COMPUTATION) for name in ("a", "b", "a")]
    write_certificates(path, entries[:2])
    assert [*read_certificates(path)] == ["a", "b"]
    write_certificates(path, entries)
    with pytest.raises(InputError, match="id 'a' appears twice"):
        read_certificates(path)


@pytest.mark.parametrize(
    "changes",
    [
        {"radii": ["1e-12", "1e-15"]},
        {"k": 9},
        {"centre": ["453.4425868213848226", FALKNER_SKAN["centre"][1]]},
        {"frame": [["1", "0"], ["3.699898e-7", "1"]]},
        {"kernel_frame": [["2"]]},
    ],
)
def test_a_certificate_proves_no_other_candidate(proved: Certificate, changes: dict[str, Any]) -> None:
    assert not is_proof_of(proved, candidate(**changes))


def test_an_edited_certificate_is_no_proof(proved: Certificate) -> None:
    def edit(change: Any) -> Certificate:
        entry = proved.to_json()
        change(entry)
        return Certificate.from_json(entry)

    edits = [
        edit(lambda entry: entry["hypotheses"].pop()),
        edit(lambda entry: entry["hypotheses"].reverse()),
        edit(lambda entry: entry["statement"].update(vector_field="")),
        edit(lambda entry: entry["statement"].update(theorem="anything")),
        edit(lambda entry: entry["software"].update(source="sha256:0")),
        edit(lambda entry: entry.pop("software")),
    ]
    assert not any(is_proof_of(entry, candidate()) for entry in edits)
    assert is_proof_of(edit(lambda _: None), candidate())
    # Nor is it with a digest that fits; and where nothing else tells, the digest does.
    for entry in edits:
        whole = entry.to_json()
        assert not is_proof_of(Certificate.from_json({**whole, "digest": digest(whole)}), candidate())
    assert not is_proof_of(edit(lambda entry: entry["computation"].update(seconds=0.0)), candidate())
    assert not is_proof_of(edit(lambda entry: entry["results"]["normal_form"].clear()), candidate())


@pytest.mark.parametrize(
    "change",
    [
        lambda entry: entry["hypotheses"][0].update(holds=False),
        lambda entry: entry["hypotheses"][3].update(holds=False),
        lambda entry: entry.update(hypotheses=[]),
        lambda entry: entry.update(results=None),
        lambda entry: entry["statement"].pop("theorem"),
        lambda entry: entry.update(verdict="not proved"),
        lambda entry: entry.update(reason={"condition": "C3", "message": "m", "remedy": "r"}),
        lambda entry: entry["results"]["parameter"].update(mid="3.02"),
        lambda entry: entry["results"]["parameter"].update(rad="-0x1"),
        lambda entry: entry["results"]["point"]["y"].update(rad="0x1234567890abcdef1"),
        lambda entry: entry["statement"]["candidate"].pop("k"),
        lambda entry: entry.update(comment="fine"),
    ],
)
def test_a_contradictory_certificate_is_refused(proved: Certificate, change: Any) -> None:
    entry = proved.to_json()
    change(entry)
    with pytest.raises(InputError):
        Certificate.from_json(entry)


def test_not_proved_carries_its_reason_and_only_finite_enclosures(tmp_path: Path) -> None:
    outcome = NotProved(Reason("C3", "what", "try"))
    entry = make_certificate(candidate(), outcome, COMPUTATION)
    write_certificates(tmp_path / "c.json", [entry])
    assert entry.reason == Reason("C3", "what", "try")
    assert entry.to_json()["results"] is None
    assert entry.theorem is None


class Integrator:
    """An integrator that fails for want of precision until it has enough bits."""

    def __init__(self, enough: int, needs_precision: bool = True) -> None:
        self.enough = enough
        self.needs_precision = needs_precision
        self.asked: list[int] = []

    def __call__(self, claim: Candidate, settings: IntegratorSettings, progress: Any) -> Enclosures:
        self.asked.append(settings.precision)
        if settings.precision < self.enough:
            raise IntegrationFailure("defect", "too wide", "more bits", needs_precision=self.needs_precision)
        raise IntegrationFailure("enough", "enough bits", "none")


def test_precision_is_raised_until_it_is_enough() -> None:
    integrator = Integrator(400)
    entry = certify(candidate(), integrate=integrator)
    assert entry.reason.condition == "enough"
    assert integrator.asked == sorted(set(integrator.asked))
    assert integrator.asked[0] == first_precision(candidate(), 30)
    assert integrator.asked[-1] >= 400
    assert entry.computation.attempts == len(integrator.asked)


def test_precision_stays_below_the_limit_and_the_reason_says_so() -> None:
    integrator = Integrator(10**6)
    entry = certify(candidate(), Limits(max_precision=300), integrate=integrator)
    assert max(integrator.asked) == 300
    assert "300 bits" in entry.reason.message
    assert "`max_precision`" in entry.reason.remedy


def test_what_precision_cannot_mend_is_not_tried_again() -> None:
    integrator = Integrator(10**6, needs_precision=False)
    certify(candidate(), integrate=integrator)
    assert len(integrator.asked) == 1


def test_precision_that_does_not_narrow_the_enclosures_is_given_up() -> None:
    asked: list[int] = []

    def constant(claim: Candidate, settings: IntegratorSettings, progress: Any) -> Enclosures:
        asked.append(settings.precision)
        indices = [(i, j) for i in range(4) for j in range(4 - i)]
        wide = {index: arb(1, 2) for index in indices}
        tables = ((DerivativeTable(wide, wide),),) * 3
        return Enclosures(tables, None, (arb(1),) * 3, 16, settings.precision, 1)

    entry = certify(candidate(), integrate=constant)
    assert entry.reason.condition in ("family", "regular-1")
    assert len(asked) == 2


def test_time_limit_of_a_row_is_not_proved_with_that_reason() -> None:
    entry = certify(candidate(), Limits(timeout=1e-6))
    assert entry.verdict == "not proved"
    assert entry.reason.condition == "time"
    assert not is_proof_of(entry, candidate())


@pytest.mark.parametrize(
    "changes",
    [
        {"radii": ["1e-1", "1e-1"]},
        {"radii": ["1e300", "1e300"]},
        {"radii": ["1e-9000", "1e-9000"]},
        {"centre": ["1e300", "1"]},
        {"centre": ["0", "0"]},
        {"centre": ["453.4", "1e4000"]},
        {"kernel_frame": [["0"]]},
    ],
)  # fmt: skip
def test_extreme_boxes_are_not_proved_and_raise_nothing(changes: dict[str, Any]) -> None:
    entry = certify(candidate(**changes), Limits(max_precision=256, timeout=20))
    assert entry.verdict == "not proved"
    assert entry.reason.message


@pytest.mark.parametrize(
    ("changes", "conditions"),
    [
        ({"k": 2, "kind": "period_tupling"}, {"C3"}),
        ({"k": 4, "kind": "period_tupling"}, {"multiplicity"}),
        ({"centre": ["453.4425869", FALKNER_SKAN["centre"][1]]}, {"family", "C3"}),
        ({"kind": "period_tupling"}, {"adapted-frames"}),
    ],
    ids=["k=2", "k=4", "shifted", "period tupling with k=3"],
)
def test_false_claims_about_the_falkner_skan_point_are_not_proved(
    changes: dict[str, Any], conditions: set[str]
) -> None:
    entry = certify(candidate(**changes), Limits(max_precision=300))
    assert entry.verdict == "not proved"
    assert entry.reason.condition in conditions


@settings(max_examples=20)
@given(st.integers(1, 4000), st.integers(1, 4000))
def test_first_precision_grows_with_smaller_boxes(a: int, b: int) -> None:
    small, large = sorted((a, b))
    bits = [first_precision(candidate(radii=[f"1e-{n}", f"1e-{n}"]), 30) for n in (small, large)]
    assert bits[0] <= bits[1]
    assert bits[1] > large * 3.3


def test_enclosures_of_exact_numbers_contain_them() -> None:
    for value in (F(1, 3), F(-7, 5), F(0), F(2**400 + 1, 3**50)):
        lower, upper = bounds(enclose(value))
        assert lower <= value <= upper
