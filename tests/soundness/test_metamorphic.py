"""Claims of every kind told otherwise: other names, order, units, and things beside; what is proved is the same."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest
from flint import arb
from support.metamorphic import Change
from support.metamorphic_cases import CASES, ROWS, Case
from support.metamorphic_changes import all_at_once, changes, is_free, symbols, words
from support.metamorphic_runs import LIMITS, Told, certificate_of, changed, objections, tell, told_in_every_way

from orbitproof.shared.claims import BOX_KINDS, KINDS_WITHOUT_REVERSOR
from orbitproof.verify.branches import places_on
from orbitproof.verify.certificate import certify
from orbitproof.verify.evidence import ball_from_json

LONG = ("tori", "list", "periodic-arc-functions", "periodic-arc-functions-levels", "homoclinic-curve")
"""Cases that take seconds."""


@cache
def plainly(name: str) -> tuple[Case, Told]:
    case = CASES[name]()
    return case, tell(case)


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow if name in LONG else ()) for name in CASES])
def test_a_claim_told_otherwise_is_proved_alike(name: str) -> None:
    """Names, order, units, signs, and parameters that play no part, all at once."""
    case, before = plainly(name)
    assert before.verdict in ("proved", "enclosed")
    change = all_at_once(name, case)
    after = tell(changed(case, change))
    assert objections(before, after, change) == []
    assert after.check(integrate=False) == "stands"


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_claim_told_in_every_way_is_proved_alike_at_every_level(name: str) -> None:
    found = dict(told_in_every_way(name, 0))
    assert len(found) >= 11
    assert {title: wrong for title, wrong in found.items() if wrong} == {}


def test_there_is_a_case_for_every_kind_of_claim_about_a_box() -> None:
    assert {row().kind for row in ROWS.values()} == {*BOX_KINDS, *KINDS_WITHOUT_REVERSOR}


def test_names_are_words_of_our_own_sources() -> None:
    """Among them what the verifier adds to programs, and keys of certificates; none that no file could have."""
    assert {"distance", "rate", "level", "mid", "rad", "centre", "point", "theorem"} <= {*words()}
    assert all(map(is_free, words()))
    case, _ = plainly("fold")
    told = {change.title: set(change.names.values()) for change in changes("fold", case, 0)}
    assert told["sources"] <= {*words()}
    assert told["exchanged"] == {*case.system.state, *case.system.parameters}  # type: ignore[union-attr]


def test_what_differs_is_noticed() -> None:
    """Another point, another verdict, wider balls, and a name that is not the new one."""
    case, before = plainly("fold")
    none = Change("none")
    assert objections(before, before, none) == []
    renamed = Change("renamed", {"u": "distance"})
    assert "point.u: is new" in objections(before, before, renamed)
    moved = Change("moved", factors={"u": Fraction(2)})
    assert any(each.startswith("point.u: ") for each in objections(before, before, moved))
    assert objections(before, replace(before, verdict="C3: .."), none) == ["proved, told otherwise C3: .."]
    wide = replace(before.results, parameter=before.results.parameter + arb(0, 1))
    assert [each.partition(":")[0] for each in objections(before, replace(before, results=wide), none)] == ["parameter"]
    elsewhere = tell(replace(case, centre=(Fraction(1), Fraction(1))))  # type: ignore[call-arg, arg-type]
    assert objections(before, elsewhere, none)[0].startswith("proved, told otherwise ")


@pytest.mark.parametrize("name", ["periodic-fold", "level-fold"])
def test_names_may_begin_with_an_underscore(name: str) -> None:
    case, before = plainly(name)
    change = Change("underscores", {old: f"_{old}" for old in (*symbols(case), "S")}, integral="_H")
    after = tell(changed(case, change))
    assert objections(before, after, change) == []
    assert after.check(integrate=False) == "stands"


def test_an_orbit_lies_at_the_same_place_of_a_curve_told_otherwise() -> None:
    """The orbit of a claim on the arc on a level."""
    curve, orbit = CASES["arc-on-level"](), CASES["fixed-level"]()
    places = []
    for change in (Change("plainly"), all_at_once("arc-on-level", curve)):
        arc = tell(changed(curve, change))
        assert arc.document is not None
        (found,) = places_on(certificate_of(arc), [certify(changed(orbit, change), LIMITS)])  # type: ignore[arg-type]
        place = found.certificate.to_json().get("place")
        assert place is not None, found.line
        places.append(place)
    first, other = (ball_from_json(place["s"]) for place in places)
    assert first.contains(0)
    assert other.contains(0)
    assert {place["piece"] for place in places} == {"p1"}
