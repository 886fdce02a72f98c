"""What a curve of vertical orbits has to satisfy, and what is said of it: fabricated pieces, without integration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb
from support.balls import agree
from support.chain_cases import Result, proved
from support.conclusions import conclude
from support.stored import values

from orbitproof.shared.claims import REVERSOR_BREAKING, Atlas, Claim, Covers, Piece
from orbitproof.shared.claims.web import Meeting
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_AXIAL, LIFTED, VERTICAL, ReversibleSystem
from orbitproof.verify.branches.conclusion import conclusion_of
from orbitproof.verify.curve import (
    CertifiedPoint,
    Conclusion,
    PlaceOnCurve,
    ProvedCurve,
    certified_systems,
    jacobi_constant,
)
from orbitproof.verify.curve import conclude as concluded
from orbitproof.verify.curve.lyapunov_family import libration_point
from orbitproof.verify.curve.vertical_family import (
    check_vertical,
    in_units_of_vertical_orbit,
    stiffness_at_rest,
    vertical_point,
)
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Proved, ball_to_json
from orbitproof.verify.web import Arc, Incidence, level_at, libration_vertex
from orbitproof.verify.web.meetings import meeting_shown
from orbitproof.verify.words.branches import conclusion_in_words
from orbitproof.verify.words.curve import bifurcations_in_words
from orbitproof.verify.words.place import place_in_words

MU = {"mu": Fraction(1, 80)}
CENTRE = (Fraction(1, 100), Fraction(-1, 4), Fraction(1, 2))
QUARTER = arb(0.7, 0.05)
CLAIM = Claim("arc", None, ("eps2",), Covers("eps2", Fraction(0), Fraction(1, 50)))


def piece(kind: str = "regular") -> Piece:
    """eps2 from -1/100 to 3/100; x and vy do not change."""
    unit = tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3))
    return Piece(
        "p001", kind, CENTRE, unit, Fraction(1, 50), ((Fraction(0),), (Fraction(0),)), (Fraction(1, 1000),) * 2
    )


def atlas(point: str = "L1", claim: Claim = CLAIM, **changes: Any) -> Atlas:
    return replace(Atlas("vertical", "a curve", VERTICAL[point], MU, claim, (piece(),)), **changes)


def result(time: arb = QUARTER, start: str = "-1", end: str = "1") -> Result:
    return proved(piece(), start, end, time=ball_to_json(time))


def of_vertical(conclusion: Conclusion[ProvedCurve]) -> str:
    """The hypothesis that is not shown; empty if all are."""
    return conclusion.outcome.reason.condition if isinstance(conclusion.outcome, NotProved) else ""


@pytest.mark.parametrize("point", VERTICAL)
def test_the_stiffness_across_the_plane_and_the_level_are_those_of_the_libration_point(point: str) -> None:
    mu, around = 1 / 80, atlas(point)
    x_l = float(libration_point(around.system, MU) or arb("nan"))
    larger, smaller = abs(x_l + mu), abs(x_l + mu - 1)
    assert float(stiffness_at_rest(around.system, MU)) == pytest.approx(
        (1 - mu) / larger**3 + mu / smaller**3, rel=1e-12
    )
    # With a speed in the plane and across it, off the point: 2 U - v^2.
    eps2, x, vy = 1 / 64, -0.25, 0.5
    X, Y = x_l + eps2 * x, eps2 * vy
    level = jacobi_constant(around.system, MU, {"eps2": arb(eps2), "x": arb(x), "vy": arb(vy)})
    wanted = X * X + 2 * (1 - mu) / abs(X + mu) + 2 * mu / abs(X + mu - 1) - Y * Y - eps2
    assert level is not None
    assert float(level) == pytest.approx(wanted, rel=1e-12)
    assert float(level_at(around, {"eps2": arb(eps2), "x": arb(x), "vy": arb(vy)})) == pytest.approx(wanted, rel=1e-12)
    assert vertical_point(around.system) == point
    assert certified_systems(around.system) == (CR3BP,)


def test_a_family_is_what_its_equations_are_and_not_what_they_are_called() -> None:
    for system in (replace(VERTICAL["L1"], title="another"), AROUND["L1"], CR3BP, CR3BP_AXIAL):
        assert vertical_point(system) is None


COVERS = CLAIM.covers
assert COVERS is not None
CLAIMS: Mapping[str, tuple[Claim, bool]] = {
    "from rest": (CLAIM, True),
    "from before it": (replace(CLAIM, covers=replace(COVERS, start=Fraction(-1, 200))), True),
    "from above 0": (replace(CLAIM, covers=replace(COVERS, start=Fraction(1, 10**6))), False),
    "up to 0": (replace(CLAIM, covers=replace(COVERS, start=Fraction(-1, 200), end=Fraction(0))), False),
    "not increasing": (replace(CLAIM, increasing=()), True),
    "nothing covered": (replace(CLAIM, covers=None), False),
    "a later crossing": (replace(CLAIM, crossings=2), False),
}


@pytest.mark.parametrize("case", CLAIMS)
def test_vertical_families_are_claimed_from_rest_to_above_with_the_first_return(case: str) -> None:
    claim, holds = CLAIMS[case]
    conclusion = conclude(atlas(claim=claim), [result()])
    assert of_vertical(conclusion) == ("" if holds else "vertical")
    assert ("emanates from L1" in conclusion_in_words(conclusion)) == holds


@pytest.mark.parametrize("kind", ["arc", "loop", "symmetric-arc", "symmetric-loop"])
def test_a_vertical_family_is_an_arc(kind: str) -> None:
    """Whatever the other hypotheses are, which a loop cannot satisfy together with `covers`."""
    conclusion = conclude(atlas(), [result()])
    assert isinstance(conclusion.outcome, Proved)
    checklist, claimed = Checklist(), atlas(claim=replace(CLAIM, kind=kind))
    said = ""
    try:
        check_vertical(checklist, claimed, conclusion.outcome.results.chain)
    except NotEstablishedError as error:
        said = error.reason.message
    assert said.endswith("" if kind == "arc" else f": the claim is about no arc, but about a {kind}")
    assert bool(said) == (kind != "arc")


@pytest.mark.parametrize(
    ("row", "parts", "holds"),
    [
        # Up to s = 1/2 only; it is 0 at s = -1/2.
        ((3, 4, -4), [("-1", "1/4"), ("0", "1")], True),
        ((3, 4, -4), [("-1", "1")], False),
        ((0, -3, 0, 4), [("-1", "1")], False),
    ],
)
def test_eps2_may_fall_again_but_not_where_it_may_be_0(
    row: tuple[int, ...], parts: list[tuple[str, str]], holds: bool
) -> None:
    """A piece over vy, along which eps2 is a polynomial in s."""
    frame = tuple(tuple(Fraction(int(i == j)) for j in (2, 0, 1)) for i in range(3))
    size = tuple(Fraction(value, 200) for value in row)
    over = replace(piece(), frame=frame, polynomial=(size, (Fraction(0),)), centre=(Fraction(0), *CENTRE[1:]))
    claim = replace(CLAIM, increasing=("vy",), covers=replace(COVERS, end=Fraction(1, 400)))
    results = [proved(over, start, end, time=ball_to_json(QUARTER)) for start, end in parts]
    found = conclude(atlas(claim=claim, pieces=(over,)), results)
    assert of_vertical(found) == ("" if holds else "vertical")


def test_another_coordinate_that_is_covered_is_no_size() -> None:
    unit = piece().frame
    slanted = replace(
        piece(), centre=(CENTRE[0], Fraction(0), CENTRE[2]), frame=(unit[0], (Fraction(1), *unit[1][1:]), unit[2])
    )
    for covered, wanted in (("x", "vertical"), ("eps2", "")):
        claim = replace(CLAIM, increasing=("eps2", "x"), covers=Covers(covered, Fraction(-1, 200), Fraction(1, 100)))
        assert of_vertical(conclude(atlas(claim=claim, pieces=(slanted,)), [result()])) == wanted


@pytest.mark.parametrize(
    ("parts", "holds"),
    [
        ([result()], True),
        ([result(arb(1.385, 0.001))], False),
        ([result(arb(1.3, 0.2))], False),
        ([result(arb(1.38, 0.001))], True),
        # Only where eps2 may be 0, at s = -1/2, is the time a quarter; but on all intervals over it.
        ([result(QUARTER, end="0"), result(arb(2, 0.1), "-1/8")], True),
        ([result(QUARTER, end="-3/8"), result(arb(2, 0.1), "-5/8")], False),
        ([result(arb(2, 0.1), end="-3/8"), result(QUARTER, "-5/8")], False),
    ],
)  # fmt: skip
def test_at_rest_the_return_is_before_half_the_period_across_the_plane(parts: list[Result], holds: bool) -> None:
    # pi/c^(1/2) is 1.38299.. for this mass.
    conclusion = conclude(atlas(), parts)
    assert of_vertical(conclusion) == ("" if holds else "vertical")


def test_lists_of_resonances_are_made_of_orbits_in_units_of_their_own() -> None:
    for around in (
        atlas(),
        atlas(system=LIFTED),
        atlas(system=AROUND["L1"], claim=Claim("arc"), pieces=(planar(),)),
    ):
        results = values([proved(around.curve_pieces()[0], time=ball_to_json(QUARTER))])
        found = conclusion_of(around, results, [], lambda entries: [], 4)
        assert found["verdict"] == "proved"
        assert "complete" in found


def planar() -> Piece:
    """eps from -1/50 to 1/50; vy does not change."""
    unit = ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)))
    return Piece(
        "p001", "regular", (Fraction(0), Fraction(2)), unit, Fraction(1, 50), ((Fraction(0),),), (Fraction(1, 1000),)
    )


def on_axis(place: arb, sign: int = -1, system: ReversibleSystem = VERTICAL["L1"]) -> Mapping[str, arb]:
    """The crossing of the axis by the orbit of the fabricated curve with this eps2."""
    x_l = libration_point(system, MU)
    assert x_l is not None
    return {"x": x_l + place * arb(CENTRE[1].numerator) / 4, "vy": place / 2, "vz": sign * place.sqrt()}


class Axis:
    """A partner that knows the crossing, and how it was asked."""

    def __init__(self, crossing: Mapping[str, arb] | None) -> None:
        self.crossing, self.asked = crossing, list[Any]()

    def __call__(self, *asked: Any) -> Mapping[str, arb] | None:
        self.asked.append(asked)
        return self.crossing


LOSS = CertifiedPoint(
    "v", REVERSOR_BREAKING, 1, crossings=2, point={"x": arb(1), "z": arb(1), "vy": arb(1)}, shifted_by=("S",)
)
SIZE = arb(1, 1e-12) / 80


@pytest.mark.parametrize(
    ("change", "crossing", "reason"),
    [
        ({}, on_axis(SIZE), ""),
        ({}, on_axis(SIZE, 1), ""),
        ({}, None, "its crossing of the axis is not enclosed"),
        ({}, {**on_axis(SIZE), "vz": arb(0, 1)}, "its crossing of the axis is not enclosed"),
        ({}, {**on_axis(SIZE), "vy": -SIZE / 2}, "it lies outside the tubes"),
        ({}, {**on_axis(SIZE), "x": on_axis(SIZE)["x"] + arb(1e-3)}, "it lies outside the tubes"),
        ({}, on_axis(SIZE, system=VERTICAL["L2"]), "it lies outside the tubes"),
        ({}, on_axis(arb(1, 1e-12) / 25), "it lies beyond the ends"),
        ({"shifted_by": ()}, on_axis(SIZE), "not shown that z -> -z shifts"),
        ({"shifted_by": ("another",)}, on_axis(SIZE), "not shown that z -> -z shifts"),
        ({"kind": "symmetry_breaking"}, on_axis(SIZE), "only orbits that lose R"),
        ({"kind": "orbit"}, on_axis(SIZE), "only orbits that lose R"),
        ({"crossings": 1}, on_axis(SIZE), "meet the section 1 times, those of the curve 2"),
        ({"crossings": 4}, on_axis(SIZE), "meet the section 4 times, those of the curve 2"),
        ({"problem": "the certificate does not stand"}, on_axis(SIZE), "does not stand"),
    ],
)  # fmt: skip
def test_a_loss_of_r_is_placed_by_its_crossing_of_the_axis_in_units_of_the_orbit(
    change: Mapping[str, Any], crossing: Mapping[str, arb] | None, reason: str
) -> None:
    partner = Axis(crossing)
    (entry,) = concluded(atlas(), values([result()]), [replace(LOSS, **change)], partner).bifurcations
    assert (entry.place is None) == bool(reason)
    assert reason in entry.reason
    if entry.place is not None:
        # eps2 = 1/80 is s = 1/8; the first crossing of a half orbit of two, on the fixed points of R S.
        assert agree(entry.place.s, arb(1) / 8)
        assert entry.place.s.rad() < 1e-9
        assert not entry.place.other_point
        assert partner.asked == [(CR3BP, MU, LOSS.point, 1, CR3BP_AXIAL)]
        assert list(entry.point) == ["eps2", "x", "vy"]


def test_units_of_an_orbit_are_the_square_of_its_speed_across_the_plane() -> None:
    for sign in (-1, 1):
        found = in_units_of_vertical_orbit(VERTICAL["L1"], MU, on_axis(arb(1) / 80, sign))
        assert found is not None
        assert [round(float(ball), 12) for ball in found.values()] == [0.0125, -0.25, 0.5]
    assert in_units_of_vertical_orbit(VERTICAL["L1"], {"mu": Fraction(0)}, on_axis(SIZE)) is None


def arc(point: str = "L1") -> Arc:
    conclusion = concluded(atlas(point), values([result(arb(0.5, 0.01))]), [LOSS], Axis(on_axis(SIZE)))
    assert isinstance(conclusion.outcome, Proved)
    return Arc(atlas(point), conclusion.outcome.results, "", {entry.id: entry for entry in conclusion.bifurcations})


def test_an_arc_of_vertical_orbits_ends_at_its_point_has_four_quarters_and_all_levels() -> None:
    for point in VERTICAL:
        assert libration_vertex(arc(point)) == point
    own = arc()
    assert own.system is CR3BP
    assert own.period.contains(arb(2)) is True
    assert not own.period.overlaps(arb(1))
    for eps2 in (-0.01, 0, 0.01, 0.03):
        level = level_at(own.atlas, {"eps2": arb(eps2), "x": arb(-0.25), "vy": arb(0.5)})
        assert agree(own.levels(), level)
    assert own.levels().rad() < 0.03
    assert own.setting != arc("L2").setting
    assert isinstance(meeting_shown(own, Meeting("v", "passes through")), Incidence)
    for meeting in (Meeting("L2", "ends at"), Meeting("v", "ends at"), Meeting("v", "branches off at")):
        assert isinstance(meeting_shown(own, meeting), str)


def test_words_of_a_place_do_not_say_that_a_point_of_the_three_body_problem_is_one_of_a_curve_in_other_units() -> None:
    place = PlaceOnCurve("p001", arb(1) / 8, False)
    for units in (atlas(), atlas(system=AROUND["L1"])):
        words = place_in_words(units, place, "curve", "sha256:0")
        assert "point x lies on the curve" not in words
        assert "orbit of x is that of a point of the curve" in words
    assert "The point x lies on the curve" in place_in_words(atlas(system=CR3BP), place, "curve", "sha256:0")
    placed = bifurcations_in_words(atlas(), list(arc().placed.values()))
    assert "v: loss of R" in placed
    assert "in piece p001" in placed
    assert "the point" not in placed
