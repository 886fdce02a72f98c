"""Homoclinic orbits: one is proved, and claims of what is not there are refused (section 40)."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb
from support import homoclinic_cases as cases

from orbitproof.shared.claims import HomoclinicOrbit
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import define_system
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import Checklist, NotProved, Proved, enclose, guarded
from orbitproof.verify.homoclinic import (
    HomoclinicResults,
    HomoclinicTheorem,
    check_homoclinic_exactly,
    enclose_homoclinic,
    prove_homoclinic,
)
from orbitproof.verify.homoclinic.following import HomoclinicEnclosures
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import Linearised
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.words.homoclinic import homoclinic_in_full, homoclinic_in_words

BITS = 96
LIMITS = Limits(digits=10, max_precision=256)


@pytest.fixture(scope="module")
def enclosures() -> HomoclinicEnclosures:
    return enclose_homoclinic(cases.wells(), IntegratorSettings(precision=BITS), ORACLE)


def outcome(found: HomoclinicEnclosures | None, **changes: Any) -> Any:
    """What is concluded of a claim that is told otherwise, from the same enclosures."""
    claim, checklist = replace(cases.wells(), **changes), Checklist()
    with guarded(BITS):
        check_homoclinic_exactly(checklist, claim)
        return prove_homoclinic(claim, checklist, found)


def reason(found: HomoclinicEnclosures | None, **changes: Any) -> str:
    result = outcome(found, **changes)
    assert isinstance(result, NotProved)
    return result.reason.condition


def test_an_orbit_between_two_wells_is_proved(enclosures: HomoclinicEnclosures) -> None:
    """The periodic orbit is x = 1, y = sin(2 t)/2: p is exactly 1 and the period pi."""
    found = outcome(enclosures)
    assert isinstance(found, Proved)
    assert found.results.point["x"].contains(1)
    assert found.results.period.overlaps(arb.pi())
    assert found.results.multiplier.overlaps(arb(cases.MULTIPLIER))


def test_what_the_enclosures_do_not_show_is_not_proved(enclosures: HomoclinicEnclosures) -> None:
    claim = cases.wells()
    r, rho = claim.radii
    assert reason(None) == "return-map"
    assert reason(enclosures, level_sign=-1) == "return-map"
    # Another cone: no cone at all, and one that leaves the box.
    assert reason(enclosures, cone=claim.cone / 2**20) == "cone"
    assert reason(enclosures, cone=Q(2)) == "cone"
    # The interval lies beside the homoclinic orbit, beyond the box, or about the periodic orbit.
    assert reason(enclosures, centre=(claim.centre[0], r), radii=(r, rho)) == "arrival"
    assert reason(enclosures, centre=(claim.centre[0], rho / 2)) == "arrival"
    assert reason(enclosures, radii=(r, rho / 2**20)) in ("arrival", "homoclinic")


def test_each_bound_is_used(enclosures: HomoclinicEnclosures) -> None:
    """Enclosures that are wider in one place are refused where this place counts."""

    def wider(way: str, function: str, place: int, by: float) -> HomoclinicEnclosures:
        old = getattr(getattr(enclosures, way), function)
        balls = [*old.balls]
        balls[place] += arb(0, by)
        new = replace(getattr(enclosures, way), **{function: Linearised(balls[0], tuple(balls[1:]))})
        return replace(enclosures, **{way: new})

    assert reason(wider("returned", "first", 1, 100)) == "periodic"
    assert reason(wider("returned", "second", 1, 1)) == "cone"
    assert reason(wider("returned", "first", 2, 1e9)) in ("periodic", "cone")
    assert reason(wider("returned", "w", 0, 10)) == "return-map"
    assert reason(wider("returned", "time", 0, 10)) == "return-map"
    assert reason(wider("arrived", "second", 0, 1)) == "homoclinic"
    assert reason(wider("arrived", "second", 1, 1e12)) == "homoclinic"
    assert reason(wider("arrived", "first", 1, float("inf"))) == "return-map"
    flat = replace(enclosures.arrived, first=Linearised(arb(1), (arb(0, 1e9), arb(0))))
    flat = replace(flat, w=flat.first)
    assert reason(replace(enclosures, arrived=flat)) == "transversal"


@pytest.mark.slow
def test_false_claims_are_refused() -> None:
    claim = cases.wells()
    r, rho = claim.radii
    a = claim.centre[1]

    def why(**changes: Any) -> str:
        found = certify(replace(claim, **changes), LIMITS)
        assert not found.proved
        return found.reason.condition

    # No intersection there; another number of crossings; the stable direction for the unstable one.
    assert why(centre=(claim.centre[0], a + 4 * rho)) == "homoclinic"
    assert why(arrival=claim.arrival + 1) == "homoclinic"
    assert why(arrival=claim.arrival - 1) == "homoclinic"
    assert why(slope=-claim.slope) in ("cone", "periodic")
    # Another orbit, and none: the other sheet's return after one crossing; a box beside the periodic orbit.
    assert why(crossings=1) == "return-map"
    assert why(centre=(claim.centre[0] + 4 * r, a)) == "periodic"
    assert why(radii=(r * 2**14, rho)) not in ("", "homoclinic")


@pytest.mark.slow
def test_orbits_of_the_sun_and_jupiter_are_proved() -> None:
    """Wilczak and Zgliczynski 2003: mu = 0.0009537, C = 3.03 (theirs is larger by mu (1 - mu)), about L1 and L2."""
    found = certify(cases.jupiter(), Limits(digits=10, max_precision=256))
    assert found.proved, found.reason
    assert found.results.point["x"].overlaps(enclose(Q("0.92080349132074")) + arb(0, 1e-13))
    assert abs(float(found.results.multiplier) - 1391.778) < 1e-3
    assert abs(float(found.results.meeting["x"]) + 0.64819169) < 1e-7
    found = certify(cases.beyond_jupiter(), Limits(digits=10, max_precision=256))
    assert found.proved, found.reason
    assert found.results.point["x"].overlaps(enclose(Q("1.08192948684179")) + arb(0, 1e-13))
    assert abs(float(found.results.multiplier) - 1147.248) < 1e-3
    assert abs(float(found.results.meeting["x"]) + 2.05362134) < 1e-7


def test_claims_that_cannot_be_are_refused_with_their_field() -> None:
    claim: HomoclinicOrbit = cases.wells()
    wrong: dict[str, Any] = {
        "reversing_symmetry": (1, 1, 1, -1), "section": "x", "level_coordinate": "y", "level_sign": 0, "crossings": 0,
        "arrival": 0, "slope": Q(0), "cone": Q(0), "centre": (Q(1),), "radii": (Q(0), Q(1)), "level": None,
    }  # fmt: skip
    for name, value in wrong.items():
        with pytest.raises(InputError, match=f"^{name}"):
            replace(claim, **{name: value})


def test_each_letter_has_one_meaning() -> None:
    """Neither names of the system nor parts of the field are called as coordinates of the box or parts of H."""
    system = define_system({
        "name": "own", "state": "a s l r", "parameters": "c g", "where": {"m": "c*(a - 1) + g*(a - 1)**3 + (a - 1)**5"},
        "field": {"a": "l", "s": "r", "l": "-(m + m**2)*(c + 3*g*(a - 1)**2 + 5*(a - 1)**4)", "r": "-s"},
        "first_integral": "(r**2 + l**2 + s**2 + m**2)/2 + m**3/3",
    })  # fmt: skip
    claim = replace(cases.wells(), system=system, parameters={"c": Q(1), "g": Q(1)}, section="s", level_coordinate="r")
    one = arb(1)
    found = HomoclinicResults({"a": one}, one, one, one, {"a": one, "r": one}, one, (one, one))
    lines = list(homoclinic_in_full(claim, homoclinic_in_words(HomoclinicTheorem(claim)), found))
    left = [line.partition(" = ")[0].strip() for line in lines if line.startswith("  ")]
    assert len({*left}) == len(left) == 9
    text = "\n".join(lines)
    assert "coordinates a0 and s0: a = c0 + a0 + s0, l = l0 (a0 - s0), |a0| and |s0| at most r0" in text
    assert "as a graph s0 = g0(a0)" in text
