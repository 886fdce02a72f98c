"""A list decides by values, its sentences say what is proved and no more, and their intervals are rounded outward."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from flint import arb, arb_poly, ctx
from support.flow_checks import ball
from support.stability_cases import atlas, listed, results
from support.stored import values
from support.within import within

from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Claim
from orbitproof.verify.curve import Bifurcation, Chain, PlaceOnCurve, conclude
from orbitproof.verify.evidence import EmptyIntersectionError, Proved, exact_interval_text
from orbitproof.verify.functions import REACH, BoundedFunction
from orbitproof.verify.stability import (
    BAND,
    CompleteList,
    CurveEnd,
    Extremum,
    Gap,
    Kind,
    ListAcross,
    Matter,
    Point,
    Resonance,
    Segment,
    Subject,
    extrema_on,
    is_in_band,
    may_change_stability,
    stable_intervals,
)
from orbitproof.verify.stability.complete_list import complete_list
from orbitproof.verify.stability.matching import with_certificates
from orbitproof.verify.stability.zeros import zeros_on
from orbitproof.verify.words import complete_list as sentences
from orbitproof.verify.words.complete_list import statement

ROOT = Path(__file__).parents[2]

_precision = within(lambda: ctx.workprec(160))


@cache
def chain() -> Chain:
    outcome = conclude(atlas(), values(results())).outcome
    assert isinstance(outcome, Proved)
    return outcome.results.chain


@cache
def found(order: int = 4) -> CompleteList:
    with ctx.workprec(160):
        return complete_list(atlas(), chain(), values(results()), order)


# Values decide

OPEN: list[Any] = [Matter.EVERYTHING, Matter.COLLISION, Resonance(1, 0), Resonance(2, 1), "something new", None]
HARMLESS: list[Subject] = [
    Matter.EXTREMA,
    Matter.COMBINATIONS,
    Matter.TWIST,
    Resonance(3, 1),
    Resonance(5, 2),
    Resonance(12, 5),
]


@pytest.mark.parametrize("subject", OPEN)
def test_where_something_else_than_these_is_open_stability_may_change(subject: Any) -> None:
    """Also where it is something that nobody has thought of."""
    assert may_change_stability(subject)
    gap = Gap(1, "p015", Fraction(0), Fraction(1, 8), subject, "")
    stable, unknown = stable_intervals(chain(), replace(found(), gaps=(gap,)), False)
    assert len(stable) == 2
    (entry,) = unknown
    assert (entry.begin.lower, entry.begin.upper, entry.begin.what) == (0, Fraction(1, 8), (subject,))


def places(given: CompleteList) -> list[Any]:
    stable, unknown = stable_intervals(chain(), given, False)
    assert unknown == []
    ends = [(entry.begin, entry.end) for entry in stable]
    return [[(bound.stretch, bound.lower, bound.upper, bound.what) for bound in pair] for pair in ends]


@pytest.mark.parametrize("subject", HARMLESS)
def test_where_only_these_are_open_stability_does_not_change(subject: Subject) -> None:
    assert not may_change_stability(subject)
    gap = Gap(1, "p015", Fraction(0), Fraction(1, 8), subject, "")
    assert places(replace(found(), gaps=(gap,))) == places(found())


def bounds(document: dict[str, Any]) -> list[Any]:
    return [
        entry[end]["interval"] for name in ("stable", "undecided") for entry in document[name] for end in ("from", "to")
    ]


def test_no_other_name_or_word_changes_what_is_stable(monkeypatch: Any) -> None:
    """Where one piece is not looked at, and where it is."""
    half = [{key: value for key, value in results()[0].items() if key != "stability"}, results()[1]]
    before = [bounds(listed(case, 3)["complete"]) for case in (results(), half)]
    for each in (*Kind, *Matter, *CurveEnd):
        monkeypatch.setattr(each, "_value_", f"respelled {each.name}")
    for table in ("_POINTS", "_MATTERS", "_ENDS"):
        monkeypatch.setattr(sentences, table, dict.fromkeys(getattr(sentences, table), "other words"))
    assert [bounds(listed(case, 3)["complete"]) for case in (results(), half)] == before


def test_stability_is_the_same_whatever_order_is_asked_for() -> None:
    """It changes where a stability parameter is -1, also in a list of k = 1."""
    few, more, many = (listed(results(), order)["complete"] for order in (1, 2, 12))
    assert few["order"] == 2
    assert few["stable"] == more["stable"] == many["stable"]
    assert [point["kind"] for point in few["points"]] == ["singular at this point"]


def test_a_certificate_is_not_of_a_point_beside_a_gap_in_which_it_may_be() -> None:
    at = ball(Fraction(1, 3))
    point = Point(0, "p001", 5, 2, Kind.RESONANCE, at, at, at, {})
    entry = Bifurcation("row", "period_tupling", 5, PlaceOnCurve("p001", at, False), "", {})
    subjects: list[tuple[Subject, bool]] = [
        (Resonance(5, 1), True), (Matter.EVERYTHING, True), (Resonance(4, 1), False), (Matter.COLLISION, False)
    ]  # fmt: skip
    for subject, hides in subjects:
        gap = Gap(0, "p001", Fraction(1, 4), Fraction(1, 2), subject, "")
        (kept,) = with_certificates([point], [gap], [entry])
        assert kept.certificates == (() if hides else ("row",))
        if not hides:
            with pytest.raises(EmptyIntersectionError):
                with_certificates([], [gap], [entry])
        else:
            assert with_certificates([], [gap], [entry]) == ()


# What is said


def words(kind: str = "arc", **changes: Any) -> str:
    claim = Claim(kind, "S" if kind.startswith("symmetric") else None)
    listed_ = replace(found(), **changes)
    return statement(replace(atlas(), claim=claim), listed_, *stable_intervals(chain(), listed_, kind == "loop"))


ACROSS = (Kind.ACROSS_SYMMETRIC, Kind.ACROSS_AXIAL, Kind.ACROSS_DOUBLING)


def the_point(text: str) -> str:
    (line,) = [line for line in text.splitlines() if line.startswith("- ") and line.endswith("in piece p015")]
    return line


COMBINED = (Kind.TWO_TO_ONE, Kind.THREE_TO_ONE, Kind.OPPOSITE)


@pytest.mark.parametrize("kind", [kind for kind in Kind if kind not in (*ACROSS, *COMBINED, Kind.TWISTLESS)])
def test_a_point_is_said_to_be_what_is_proved(kind: Kind) -> None:
    """A value of a stability parameter, no orbits; where a family leaves the plane, that its own are born there."""
    line = the_point(words(points=(Point(1, "p015", 3, 1, kind, arb(0), arb(450), arb(1), {}),), order=3))
    line = line.replace("eps2 is 0, the planar orbit from which those of the curve are born", "", kind is Kind.IN_PLANE)
    assert not re.search("orbits|twice|times the period|branch|born|doubl|eps2", line)
    assert ("a stability parameter is" in line) == (kind is not Kind.COLLISION)
    if kind in (Kind.RESONANCE, Kind.UNDECIDED):
        assert "1:3, a stability parameter is cos(2 pi 1/3)" in line


@pytest.mark.parametrize("kind", [*ACROSS, Kind.RESONANCE, Kind.UNDECIDED])
def test_out_of_the_plane_it_is_that_of_the_variations_across(kind: Kind) -> None:
    """Orbits are claimed where a curve of them begins (Lemma 21.1); "stability parameters" are those in the plane."""
    gap = Gap(1, "p015", Fraction(-1, 8), Fraction(0), Resonance(2, 1), "")
    point = Point(1, "p015", 5, 2, kind, arb(0.5), arb(450), arb(1), {})
    across = replace(found(), parameters=1, points=(point,), gaps=(gap,))
    text = sentences.statement_across(atlas(), ListAcross(across, *stable_lists(across), (None,)))
    assert "stability parameter" not in text
    assert ("orbits" in the_point(text)) == (kind in (Kind.ACROSS_SYMMETRIC, Kind.ACROSS_AXIAL))
    if kind in (Kind.RESONANCE, Kind.UNDECIDED):
        assert "1:5, (lambda + 1/lambda)/2 is cos(2 pi 2/5)" in the_point(text)
    assert "not covered: where (lambda + 1/lambda)/2 is -1" in text


def stable_lists(given: CompleteList) -> Any:
    return (tuple(entries) for entries in stable_intervals(chain(), given, False))


def test_ends_of_a_curve_belong_to_its_stable_intervals_and_points_do_not() -> None:
    assert "themselves not included unless they are ends of the curve, are linearly stable" in words()
    last = chain().stretches[-1].leaves
    gap = Gap(1, "p015", last - Fraction(1, 8), last, Matter.EVERYTHING, "")
    assert "themselves not included, are linearly stable" in words(gaps=(gap,))


def test_places_that_are_not_separated_are_given_as_one_range() -> None:
    """The level of one of them is not that of the orbits beside the other."""
    point = Point(1, "p015", 1, 0, Kind.FOLD, arb(0), arb(450), arb(1), {})
    gap = Gap(1, "p015", Fraction(-1, 8), Fraction(1, 3), Matter.COLLISION, "bounds too wide")
    text = words(points=(point,), gaps=(gap,))
    merged = "s in [-0.125, 0.333333334] (piece p015: not covered: equal stability parameters, extremum of"
    assert merged in text
    assert "450" not in text.split("linearly stable (")[1]
    undecided = replace(point, k=2, j=1, kind=Kind.UNDECIDED)
    assert "1:2, a stability parameter is -1, kind not decided)" in words(points=(undecided,), gaps=(gap,))


def extremum(value: arb) -> Extremum:
    return Extremum(1, "p015", value, is_in_band(value), arb(0), arb(450), arb(1))


def test_an_extremum_that_may_lie_beyond_the_band_is_not_said_to_be_within() -> None:
    inside, straddling = extremum(arb(1)), extremum(ball(BAND) + arb(0, 1) / 100)
    text = words(extrema=(straddling,))
    assert "no stability parameter is stationary with a value between -1.1 and 1.1, but for the places" in text
    assert "it is not decided whether its value is between these or beyond" in text
    both = words(extrema=(inside, straddling))
    assert both.index("exactly here") < both.index("[1.0") < both.index("not decided whether its value")
    assert "beyond" not in words(extrema=(inside,))
    assert [entry.in_band for entry in (inside, straddling)] == [True, False]


def test_an_extremum_at_a_joint_beside_a_symmetric_point_is_open() -> None:
    """(tau^2 - 1/4)^2 is stationary at -1/2, where the curve may or may not have entered the piece."""
    flat = BoundedFunction(arb_poly([0]), arb(0))
    square = arb_poly([-0.25, 0, 1])
    segment = Segment(
        0, Fraction(-51, 100), Fraction(-49, 100), Fraction(0), Fraction(0), Fraction(1),
        (BoundedFunction(square * square, arb(0)),), flat, flat, flat,
    )  # fmt: skip
    assert extrema_on(segment, 1) == ([], [(Fraction(-51, 100), Fraction(-49, 100))])
    assert extrema_on(replace(segment, start=segment.entered), 1) == ([], [])
    assert REACH > 1


def test_the_search_for_zeros_ends_where_bounds_stay_wide() -> None:
    """Point values have certain signs, and no part is short enough: what is left is undecided, and nothing is lost."""

    class Wide:
        calls = 0

        def value(self, part: arb) -> arb:
            self.calls += 1
            return part + 2 if part.rad() == 0 else arb(0, 1)

        def slope(self, part: arb) -> arb:
            return arb(0, 1)

    function = Wide()
    found_ = zeros_on(function, Fraction(-1), Fraction(1))
    assert found_.zeros == ()
    assert found_.undecided == ((Fraction(-1), Fraction(1)),)
    assert function.calls < 50000


# Intervals


@pytest.mark.parametrize("seed", range(50))
def test_exact_intervals_are_printed_outward_or_inward(seed: int) -> None:
    source = random.Random(seed)
    low = Fraction(source.randint(-(10**12), 10**12), source.choice((2**40, 3**25, 10**12, 7)))
    high = low + Fraction(source.randint(0, 10**6), source.choice((1, 2**20, 2**60, 3**40)))
    down, up = (Fraction(text) for text in exact_interval_text(low, high).strip("[]").split(","))
    assert down <= low <= high <= up
    size = max(abs(low), abs(high))
    assert up - down <= (high - low) * Fraction(6, 5) + size / 10**8
    if low < high:
        inner = [Fraction(text) for text in exact_interval_text(low, high, inward=True).strip("[]").split(",")]
        assert low <= inner[0] <= inner[1] <= high


def test_short_numbers_are_printed_as_they_are() -> None:
    assert exact_interval_text(Fraction(-1), Fraction(1)) == "[-1, 1]"
    assert exact_interval_text(Fraction(0), Fraction(0)) == "[0, 0]"
    assert exact_interval_text(Fraction(-3, 16), Fraction(5, 8)) == "[-0.1875, 0.625]"
    assert exact_interval_text(Fraction(100), Fraction(1200)) == "[100, 1200]"


def test_no_point_of_a_gap_is_outside_of_what_is_printed_of_it() -> None:
    low, high = Fraction(-7135216954807, 10**13), Fraction(-71352169548, 10**11)
    text = words(gaps=(Gap(1, "p015", low, high, Resonance(4, 1), ""),))
    ((first, last),) = re.findall(r"piece p015, s in \[([^,]*), ([^\]]*)\], k = 4, j = 1", text)
    assert Fraction(first) <= low <= high <= Fraction(last)


def test_gaps_are_printed_with_all_of_their_points() -> None:
    """A list with many gaps: the numbers in the theorem enclose those of the file."""
    wide = results()
    for function in wide[1]["stability"]["characteristic"]:
        function["error"] = "0x1p-3"
    document = listed(wide)
    gaps = document["complete"]["gaps"]
    assert len(gaps) > 3
    printed = re.findall(r"s in \[([^,]*), ([^\]]*)\], [ke]", document["statement"])
    assert len(printed) == len(gaps)
    for gap, (first, last) in zip(gaps, printed, strict=True):
        low, high = map(parse_exact, gap["interval"])
        # The file's ends are rounded outward themselves, to 2^-60.
        assert Fraction(first) <= low + Fraction(1, 2**59)
        assert high - Fraction(1, 2**59) <= Fraction(last)


def test_no_interval_is_printed_by_rounding_to_nearest() -> None:
    """Numbers in brackets are formatted by `exact_interval_text`, `decimal_interval` and others, outward."""
    rounded = re.compile(r"\[\{[^{}]*(float\(|:[.\d]*[gef]\})")
    files = [path for folder in ("verify", "shared") for path in (ROOT / folder).rglob("*.py")]
    assert len(files) > 100
    assert [path.name for path in files if rounded.search(path.read_text())] == []
