"""What the verifier advises about a box that fails is derived from what failed: who follows it gets a proof."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from flint import arb
from support.claims import known, to_the_end

from orbitproof.shared.formats import Candidate, read_candidates
from orbitproof.verify.attempt import Limits, Verdict, remedies
from orbitproof.verify.attempt.remedies import advice_on
from orbitproof.verify.bifurcation import Counsel, Failure, check_exactly, prove, silent
from orbitproof.verify.certificate import certify
from orbitproof.verify.evidence import Checklist, Hypothesis, NotProved, Proved, Reason, guarded
from orbitproof.verify.poincare import Enclosures, IntegratorSettings

TRUE = known("fs2")
CANDIDATES = Path(__file__).parents[1] / "data" / "figures-candidates.json"
_ROUNDS = 4


def scaled(candidate: Candidate, *factors: float) -> Candidate:
    pairs = zip(candidate.radii, factors, strict=True)
    return replace(candidate, radii=tuple(radius * Fraction(factor) for radius, factor in pairs))


def with_digits(candidate: Candidate, digits: int) -> Candidate:
    """The centre rounded to so many decimal places; the rest as it is."""
    ten = 10**digits
    return replace(candidate, centre=tuple(Fraction(round(x * ten), ten) for x in TRUE.centre))


_GIVEN: dict[tuple[object, ...], str | None] = {}


def advice(candidate: Candidate) -> str | None:
    """The remedy, or `None` where the claim is proved; asked once about each box."""
    box = candidate.id, candidate.centre, candidate.radii
    if box not in _GIVEN:
        reason = certify(candidate, Limits()).to_json()["reason"]
        _GIVEN[box] = None if reason is None else str(reason["remedy"])
    return _GIVEN[box]


def number(pattern: str, text: str) -> float:
    found = re.search(pattern + r" (?:up to |about )?([0-9.]+(?:e[+-]?[0-9]+)?)", text)
    assert found is not None, text
    return float(found[1])


BOXES: dict[str, tuple[float, float]] = {
    "P_0 too narrow": (1e3, 1e3),
    "P_0 far too narrow": (1e-2, 1e1),
    "P_0 much too narrow": (1e-12, 1.0),
    "P_0 too wide": (1e4, 1.0),
    "P_1 too narrow": (1.0, 1e-4),
    "box too small the same way in all directions": (1e-10, 1e-10),
    "box too large": (1e6, 1e6),
}
TOUCH_AND_GO: dict[str, tuple[float, float]] = {
    "P_0 too narrow": (1e-4, 1.0),
    "P_0 so narrow that g_0 is uncertain": (1e-16, 1.0),
    "P_0 too wide": (1e7, 1.0),
    "box too large": (1e13, 1e13),
}


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=pytest.mark.slow if "far" in case else ()) for case in BOXES]
)
@pytest.mark.parametrize("change", ["P_0", "P_1"])
def test_following_the_advice_on_the_box_leads_to_a_proof(case: str, change: str) -> None:
    follow(scaled(TRUE, *BOXES[case]), change, _ROUNDS)


@pytest.mark.parametrize("case", TOUCH_AND_GO)
def test_the_new_orbits_of_a_touch_and_go_need_p_0_of_the_order_of_p_1(case: str) -> None:
    """There is nothing to add to the first advice, up to what rounds to two digits."""
    follow(scaled(known("fs3"), *TOUCH_AND_GO[case]), "P_1", 1)


def follow(candidate: Candidate, change: str, rounds: int) -> None:
    """Change the box as is advised, P_0 or P_1 where there is a choice, so many times at most; it is proved then."""
    given = advice(candidate)
    assert given is not None
    assert "digits" not in given
    for _ in range(rounds):
        if given is None:
            return
        if "P_0 is too narrow" in given:
            factors = (number("widen P_0 by a factor of", given), 1.0)
            factors = factors if change == "P_0" else (1.0, 1 / number("make P_1 narrower by", given))
        elif "P_0 is too wide" in given:
            factors = (1 / number("make P_0 narrower by a factor of", given), 1.0)
            factors = factors if change == "P_0" else (1.0, number("P_1 wider by", given))
        else:
            narrower = number("make P_1 narrower by a factor of", given)
            factors = (1 / narrower if "P_0 by as much" in given else narrower**-2, 1 / narrower)
        candidate = scaled(candidate, *factors)
        given = advice(candidate)
    assert given is None, given


@pytest.mark.parametrize("share", [1e-2, 1e-7])
def test_of_a_touch_and_go_whose_new_orbits_do_not_cross_the_family_no_other_box_is_asked_for(share: float) -> None:
    """As where a symmetry that shifts time makes G_11 vanish."""
    radius = Fraction(1, 2**50)
    found = {"p_0(P_1)": arb(0, share * 2**-50)}
    looked_at = [
        Hypothesis("branch", "", "9.1", True, found),
        Hypothesis("G_11", "", "9.1", False, {"G_11": arb(0, 1)}),
    ]
    told = advice_on("touch_and_go", (radius * 1000, radius, radius), looked_at)
    assert told is not None
    assert ("no other box helps" in told.words, bool(told.factors)) == (
        (True, False) if share < 1e-6 else (False, True)
    )


@pytest.mark.parametrize("digits", [8, 14, 16, 20])
def test_a_centre_that_is_too_coarse_is_said_to_be_and_with_the_digits_named_it_is_proved(digits: int) -> None:
    candidate = with_digits(TRUE, digits)
    for _ in range(_ROUNDS):
        given = advice(candidate)
        if given is None:
            break
        assert "the centre is off by" in given
        assert "`digits` of the search" in given
        digits += int(number("refine it to", given))
        candidate = with_digits(TRUE, digits)
    assert given is None, given
    # The axis that shows it first may be the coarser one; a handful of digits too many is no harm, twenty would be.
    assert digits < 40


@pytest.mark.parametrize("digits", [20, 30])
def test_the_digits_named_are_enough_for_the_narrowest_direction(digits: int) -> None:
    (row,) = (c for c in read_candidates(CANDIDATES) if c.id == "earth-moon-L1-halo-k1-1")
    rounded = tuple(Fraction(round(x * 10**digits), 10**digits) for x in row.centre)
    given = advice(replace(row, centre=rounded))
    assert given is not None
    enough = digits + int(number("refine it to", given))
    assert enough < 60
    rounded = tuple(Fraction(round(x * 10**enough), 10**enough) for x in row.centre)
    assert advice(replace(row, centre=rounded)) is None


def test_a_solution_that_grows_without_bound_is_not_only_called_a_singularity_of_the_field() -> None:
    """The field of Falkner-Skan is polynomial."""
    given = advice(replace(TRUE, centre=(TRUE.centre[0], TRUE.centre[1] + 1)))
    assert given is not None
    assert "or grows without bound" in given


def test_a_centre_off_the_family_is_not_answered_with_radii() -> None:
    given = advice(replace(TRUE, centre=(TRUE.centre[0], TRUE.centre[1] + Fraction(1, 100))))
    assert given is not None
    assert "the centre is off by" in given
    assert "narrow" not in given
    assert "wide" not in given


def test_enclosures_that_tell_nothing_give_no_advice() -> None:
    radius = Fraction(1, 1024)
    assert remedies.of_image(0, 1, arb("nan"), [radius] * 2, 2) is None
    assert remedies.of_image(0, 1, arb(0, "inf"), [radius] * 2, 2) is None
    assert remedies.of_sign(arb(0, 1), 2) is None
    assert remedies.of_sign(arb("nan"), 2) is None
    assert remedies.of_shape((), radius, 2) is None


def test_radii_beyond_the_range_of_floats_are_no_trouble() -> None:
    told = remedies.of_image(0, 1, arb("0.1"), [Fraction(1, 10**9000)] * 2, 2)
    assert told is not None
    assert "e+8999 half-widths" in told.words
    assert number("refine it to", told.words) in (9000, 9001)


def test_advice_on_precision_is_given_once() -> None:
    tiny = replace(TRUE, radii=(Fraction(1, 2**640), Fraction(1, 2**320)))
    given = certify(tiny, Limits(max_precision=256), integrate=to_the_end).reason
    assert given is not None
    assert given.remedy.count("`max_precision`") == 1


@pytest.mark.parametrize("change", ["P_2", "P_1"])
def test_following_the_advice_on_p_2_leads_to_a_proof(change: str) -> None:
    claim = known("em1")
    candidate = scaled(claim, 1.0, 1.0, 1e-9)
    given = certify(candidate, Limits(level="coordinates")).reason
    assert given is not None
    assert "P_2 is too narrow for P_1" in given.remedy
    factor, narrower = number("widen P_2 by a factor of", given.remedy), number("make P_1 narrower by", given.remedy)
    assert "and P_0 by its square" in given.remedy
    factors = (1.0, 1.0, factor) if change == "P_2" else (narrower**-2, 1 / narrower, 1.0)
    assert certify(scaled(candidate, *factors), Limits(level="coordinates")).proved


@pytest.mark.parametrize("change", [(1.0, 1e-4), (1e6, 1e6)])
def test_whatever_a_counsel_answers_nothing_is_proved_or_excluded(change: tuple[float, float]) -> None:
    claim = scaled(TRUE, *change)
    asked: list[Failure] = []

    def liar(failure: Failure) -> Reason:
        asked.append(failure)
        return Reason("none", "all of it is proved", "nothing", excluded=True)

    with guarded(160):
        found = to_the_end(claim, IntegratorSettings(160))
        plain, told = (outcome_with(claim, found, counsel) for counsel in (silent, liar))
    assert isinstance(plain, NotProved)
    assert isinstance(told, NotProved)
    assert [failure.reason for failure in asked] == [plain.reason]
    assert told.hypotheses == asked[0].hypotheses
    assert [(each.name, each.holds) for each in told.hypotheses] == [
        (each.name, each.holds) for each in plain.hypotheses
    ]
    assert not told.hypotheses[-1].holds
    assert (told.reason.condition, told.reason.excluded) == (plain.reason.condition, False)
    assert told.reason.message == "all of it is proved"


def test_a_claim_that_is_proved_asks_nobody() -> None:
    def asked(failure: Failure) -> Reason:
        raise AssertionError(failure)

    with guarded(160):
        assert isinstance(outcome_with(TRUE, to_the_end(TRUE, IntegratorSettings(160)), asked), Proved)


def outcome_with(claim: Candidate, found: Enclosures, counsel: Counsel) -> Verdict:
    checklist = Checklist()
    check_exactly(checklist, claim)
    return prove(claim, checklist, found.iterates, found.first_integral, found.return_times, counsel)
