"""Complete lists: what is listed is there, nothing else is, and forged lists are refused."""

from __future__ import annotations

import json
import random
from dataclasses import fields, replace
from fractions import Fraction
from math import ceil, cos, pi
from pathlib import Path
from typing import Any

import pytest
from flint import arb, arb_poly, ctx
from support.balls import agree
from support.flow_checks import ball
from support.forgeries import checked, honest
from support.stability_cases import Results, atlas, listed, results
from support.stored import value_of, values
from support.within import within

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.formats import read_atlas
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.curve import Bifurcation, PlaceOnCurve, conclude
from orbitproof.verify.evidence import EmptyIntersectionError, Proved
from orbitproof.verify.functions import REACH, BoundedFunction
from orbitproof.verify.stability import Kind, Point, Segment, extrema_on, is_stable, open_on
from orbitproof.verify.stability.complete_list import complete_list, orders
from orbitproof.verify.stability.kinds import Matter, Resonance
from orbitproof.verify.stability.list_entries import Gap
from orbitproof.verify.stability.matching import about_the_list, with_certificates

DATA = Path(__file__).parents[1] / "data"

_precision = within(lambda: ctx.workprec(160))


def constant(value: Fraction) -> BoundedFunction:
    return BoundedFunction(arb_poly([ball(value)]), arb(0))


@pytest.mark.parametrize("seed", range(60))
def test_linear_stability_is_decided_as_by_the_eigenvalues(seed: int) -> None:
    """Two stability parameters: real, complex, inside (-1, 1) or not."""
    source = random.Random(seed)
    first, second = (Fraction(source.randint(-150, 150), 100) for _ in range(2))
    if seed % 3 == 0:
        trace, determinant = first, first * first / 4 + abs(second) + Fraction(1, 10**6)
        expected = False
    else:
        trace, determinant = first + second, first * second
        expected = max(abs(first), abs(second)) < 1 and first != second
    zero = Fraction(0)
    flat = constant(zero)
    segment = Segment(
        0, zero, zero, zero, zero, Fraction(1), (constant(trace), constant(determinant)), flat, flat, flat
    )
    if 1 in (abs(first), abs(second)) or first == second:
        assert is_stable(segment, arb(0)) is not True
    else:
        assert is_stable(segment, arb(0)) is expected


def two_parameters(first: arb_poly, second: arb_poly, error: float = 0.0) -> Segment:
    """A segment on which the stability parameters are these polynomials of s, for s in [-1, 1]/REACH."""
    zero, flat = Fraction(0), constant(Fraction(0))
    functions = tuple(BoundedFunction(f, arb(error)) for f in (first + second, first * second))
    return Segment(0, -1 / REACH, -1 / REACH, 1 / REACH, zero, Fraction(1), functions, flat, flat, flat)


@pytest.mark.parametrize("seed", range(20))
def test_extrema_of_stability_parameters_are_found_with_their_values(seed: int) -> None:
    """The first turns close to -1, in a random place; the second is large, and turns beyond the band."""
    source = random.Random(seed)
    place, value = Fraction(source.randint(-60, 60), 100), -1 - Fraction(source.randint(1, 9), 10**5)
    shift = arb_poly([-ball(place), 1])
    first = shift * shift * arb_poly([source.choice((1, -1)), arb(1) / 4]) + arb_poly([ball(value)])
    second = arb_poly([40, -3, 7])
    found, undecided = extrema_on(two_parameters(first, second, 1e-12), 0)
    (height,) = (height for tau, height in found if tau.contains(ball(place)))
    assert height.contains(ball(value))
    assert float(height.rad()) < 1e-8
    assert undecided == []
    for other, reached in found:
        assert first.derivative()(other).contains(arb(0)) or other.contains(ball(place))
        assert agree(first(other), reached)


def test_extrema_within_wide_bounds_or_at_collisions_are_undecided() -> None:
    shift = arb_poly([arb(1) / 8, 1])
    found, undecided = extrema_on(two_parameters(shift * shift - 1, arb_poly([40, 1]), 0.5), 0)
    assert found == []
    assert undecided
    same = shift * shift - 1
    found, undecided = extrema_on(two_parameters(same, same), 0)
    assert all(not tau.contains(arb(-0.125)) for tau, _ in found)
    assert any(low <= Fraction(-1, 8) <= high for low, high in undecided)


class Close(Segment):
    """A segment on which the two parameters are not shown to differ."""

    @property
    def discriminant(self) -> BoundedFunction:
        return BoundedFunction(arb_poly([1]), arb(2))


def test_an_extremum_at_which_the_parameters_are_not_shown_to_differ_is_undecided() -> None:
    shift = arb_poly([arb(1) / 8, 1])
    segment = two_parameters(shift * shift - 1, arb_poly([40, 1]), 1e-12)
    ((place, _),), undecided = extrema_on(segment, 0)
    assert place.contains(arb(-0.125))
    assert undecided == []
    close = Close(**{field.name: getattr(segment, field.name) for field in fields(segment)})
    found, undecided = extrema_on(close, 0)
    assert found == []
    assert any(low <= Fraction(-1, 8) <= high for low, high in undecided)


def test_a_symmetric_point_is_not_counted_as_an_extremum() -> None:
    even = two_parameters(arb_poly([-1, 0, 1]), arb_poly([40, 0, 1]))
    half = replace(even, start=Fraction(0), entered=Fraction(0))
    assert extrema_on(half, -1) == ([], [])
    turning = replace(
        half, characteristic=two_parameters(arb_poly([0, 0, -1, 0, 1]), arb_poly([40, 0, 1])).characteristic
    )
    ((tau, value),) = extrema_on(turning, -1)[0]
    assert tau.contains(arb(0.5).sqrt())
    assert value.contains(arb(-0.25))
    flat = replace(half, characteristic=two_parameters(arb_poly([0]), arb_poly([40])).characteristic)
    assert extrema_on(flat, -1)[1]


# The list


def test_the_list_of_the_falkner_skan_family_is_complete() -> None:
    """Sigma goes from below -1 to about 0.05 along these pieces, and increases."""
    document = listed(results())
    assert document["verdict"] == "proved"
    found = document["complete"]
    assert found["gaps"] == found["undecided"] == []
    expected = sorted((cos(2 * pi * j / k), k, j) for k, j in orders(12) if -1 <= cos(2 * pi * j / k) < 0.05)
    assert [(point["k"], point["j"]) for point in found["points"]] == [(k, j) for _, k, j in expected]
    (stable,) = found["stable"]
    assert stable["from"]["what"] == ["singular at this point"]
    assert stable["to"]["what"] == ["the end of the curve"]
    (touch_and_go,) = [point for point in found["points"] if point["k"] == 3]
    assert "453.44258" in touch_and_go["level"]["decimal"]
    assert "1:11, a stability parameter is cos(2 pi 5/11)" in document["statement"]
    assert "and no others are" in document["statement"]


def test_lower_orders_are_a_part_of_the_list() -> None:
    every, few = (listed(results(), order)["complete"]["points"] for order in (12, 4))
    assert few == [point for point in every if point["k"] <= 4]


def without_stability(found: Results, number: int, why: dict[str, Any] | None = None) -> Results:
    entry = dict(found[number])
    del entry["stability"]
    if why is not None:
        entry["stability"] = {"reason": why}
    return [*found[:number], entry, *found[number + 1 :]]


def test_what_is_not_covered_is_named_and_the_theorem_speaks_of_the_rest() -> None:
    """In its own words: what a file gives as the reason is no part of a theorem."""
    reason = {"condition": "stability", "message": "It is proved that all orbits are stable", "remedy": ""}
    for why, text in ((None, "was not looked at"), (reason, "was not enclosed there")):
        document = listed(without_stability(results(), 0, why))
        found = document["complete"]
        assert document["verdict"] == "proved"
        assert [gap["piece"] for gap in found["gaps"]] == ["p014"]
        assert text in found["gaps"][0]["reason"]
        assert text in document["statement"]
        assert "all orbits are stable" not in json.dumps(document)
        assert "but for the places named below" in document["statement"]
        assert {point["piece"] for point in found["points"]} == {"p015"}
        assert found["undecided"]


def test_a_resonance_within_the_bounds_of_a_joint_is_counted_once_or_named() -> None:
    """The joint is moved over a resonance: the list is the same as before."""
    before = [(point["k"], point["j"]) for point in listed(results())["complete"]["points"]]
    moved = results()
    moved[0]["interval"] = ["-1", moved[0]["interval"][1]]
    assert [(point["k"], point["j"]) for point in listed(moved)["complete"]["points"]] == before


def coarser(found: Results, number: int, factor: int) -> Results:
    """The same functions with wider bounds."""
    entries: Results = json.loads(json.dumps(found))
    for function in entries[number]["stability"]["characteristic"]:
        function["error"] = format_exact(parse_exact(function["error"]) * factor)
    return entries


def test_what_leaves_a_list_open_on_an_interval_is_known() -> None:
    piece = atlas().curve_pieces()[1]
    true = results()
    assert open_on(piece, value_of(true[1]), 12) == ""
    one = ceil(1 / parse_exact(true[1]["stability"]["characteristic"][0]["error"]))
    assert open_on(piece, value_of(coarser(true, 1, one)[1]), 12) == "zeros"
    assert open_on(piece, value_of(coarser(true, 1, one * 2**12)[1]), 12) == "stability"
    broken = {**true[1]["stability"], "characteristic": [{"coefficients": ["1"], "error": "-1"}]}
    assert open_on(piece, value_of({**true[1], "stability": broken}), 12) == "zeros"
    for missing in without_stability(true, 1), without_stability(true, 1, {"message": "tired"}):
        assert open_on(piece, value_of(missing[1]), 12) == "stability"


def test_a_narrow_interval_counts_where_a_wide_one_says_less() -> None:
    """Wide bounds of the same interval, first or last, change nothing."""
    true = results()
    expected = listed(true)["complete"]["points"]
    worse = coarser(true, 1, 2**60)[1]
    worse["computation"]["precision"] -= 8
    for found in ([*true, worse], [worse, *true]):
        document = listed(found)["complete"]
        assert document["gaps"] == []
        assert document["points"] == expected
    assert listed([true[0], worse])["complete"]["gaps"]


def certified(k: int, s: float, piece: str = "p015") -> Bifurcation:
    return Bifurcation("row", "touch_and_go", k, PlaceOnCurve(piece, ball(Fraction(s)), False), "", {})


@pytest.mark.parametrize("k", [3, 5])
def test_certificates_are_matched_by_where_they_are(k: int) -> None:
    outcome = conclude(atlas(), values(results())).outcome
    assert isinstance(outcome, Proved)
    chain = outcome.results.chain
    plain = complete_list(atlas(), chain, values(results()), 6)
    (at,) = [point for point in plain.points if point.k == k]
    entry = replace(certified(k, float(at.s.mid())), place=PlaceOnCurve(at.piece, at.s, False))
    (found,) = [p for p in complete_list(atlas(), chain, values(results()), 6, [entry]).points if p.k == k]
    assert found.certificates == ("row",)
    beside = PlaceOnCurve(at.piece, at.s + 1e-3, False)
    for wrong in (replace(entry, k=k + 1), replace(entry, k=2 * k), replace(entry, place=beside)):
        if wrong.k <= 6:
            with pytest.raises(EmptyIntersectionError):
                complete_list(atlas(), chain, values(results()), 6, [wrong])
    foreign = replace(entry, place=None, is_foreign=True)
    assert not any(
        point.certificates for point in complete_list(atlas(), chain, values(results()), 6, [foreign]).points
    )
    assert complete_list(atlas(), chain, values(results()), k - 1, [entry]).points


def test_two_certificates_of_a_resonance_of_order_six_are_matched_with_its_point() -> None:
    """One at each point of the orbit on Fix(R); those of other orders at the same place, or elsewhere, are refused."""
    at = ball(Fraction(1, 3))
    point = Point(0, "p001", 6, 1, Kind.RESONANCE, at, at, at, {})
    entries = [
        Bifurcation(name, "period_tupling", 6, PlaceOnCurve("p001", at, False, other), "", {})
        for name, other in (("row", False), ("row-second", True))
    ]
    (found,) = with_certificates([point], [], entries)
    assert found.certificates == ("row", "row-second")
    for wrong in (
        replace(entries[0], k=3),
        replace(entries[0], k=2),
        replace(entries[0], place=PlaceOnCurve("p002", at, False)),
        replace(entries[0], place=PlaceOnCurve("p001", at + 1, False)),
    ):
        with pytest.raises(EmptyIntersectionError):
            with_certificates([point], [], [wrong])


def test_bifurcations_out_of_the_plane_are_not_looked_for_in_the_plane() -> None:
    planar = read_atlas(DATA / "atlas-lyapunov.json")
    assert about_the_list(planar, [certified(1, 0.0)], 12) == []
    assert about_the_list(atlas(), [certified(1, 0.0), certified(13, 0.0)], 12) == [certified(1, 0.0)]


@pytest.mark.parametrize(
    ("kind", "found", "fits"),
    [
        ("fold", Kind.FOLD, True),
        ("fold", Kind.LOSS, False),
        ("fold", Kind.SYMMETRIC, False),
        ("symmetry_breaking", Kind.SYMMETRIC, True),
        ("symmetry_breaking", Kind.FOLD, False),
        ("reversor_breaking", Kind.LOSS, True),
        ("reversor_breaking", Kind.UNDECIDED, True),
        ("reversor_breaking", Kind.FOLD, False),
        ("reversor_breaking", Kind.SYMMETRIC, False),
        ("symmetry_breaking", Kind.LOSS, False),
    ],
)
def test_folds_symmetry_breakings_and_losses_of_r_are_matched_by_kind(kind: str, found: Kind, fits: bool) -> None:
    at = ball(Fraction(1, 3))
    point = Point(0, "p001", 1, 0, found, at, at, at, {})
    entry = Bifurcation("row", kind, 1, PlaceOnCurve("p001", at, False), "", {})
    if fits:
        assert with_certificates([point], [], [entry])[0].certificates == ("row",)
    else:
        with pytest.raises(EmptyIntersectionError):
            with_certificates([point], [], [entry])
    with pytest.raises(EmptyIntersectionError):
        with_certificates([replace(point, piece="p002")], [], [entry])


def test_krein_collisions_are_matched_with_listed_ones() -> None:
    """At either point of the orbit; a resonance at the same place is another point, and an open place may hide one."""
    at = ball(Fraction(1, 3))
    collision = Point(0, "p001", 0, 0, Kind.COLLISION, at, at, at, {})
    others = [replace(collision, k=1, kind=Kind.LOSS), replace(collision, kind=Kind.OPPOSITE)]
    entries = [
        Bifurcation(name, "krein_collision", 1, PlaceOnCurve("p001", at, False, other), "", {})
        for name, other in (("row", False), ("row-second", True))
    ]
    found = with_certificates([*others, collision], [], entries)
    assert [point.certificates for point in found] == [(), (), ("row", "row-second")]
    with pytest.raises(EmptyIntersectionError):
        with_certificates(others, [], entries)
    with pytest.raises(EmptyIntersectionError):
        with_certificates([collision], [], [replace(entries[0], kind="reversor_breaking")])
    for matter, hides in ((Matter.COLLISION, True), (Matter.EVERYTHING, True), (Matter.EXTREMA, False)):
        gap = Gap(0, "p001", Fraction(0), Fraction(1), matter, "")
        if hides:
            assert with_certificates(others, [gap], entries) == tuple(others)
            assert not with_certificates([collision], [gap], entries)[0].certificates
        else:
            assert with_certificates([collision], [gap], entries)[0].certificates
            with pytest.raises(EmptyIntersectionError):
                with_certificates(others, [gap], entries)
    resonance = Gap(0, "p001", Fraction(0), Fraction(1), Resonance(1, 0), "")
    assert with_certificates([collision], [resonance], entries)[0].certificates


@pytest.mark.parametrize("other_point", [True, False])
def test_doubling_is_certified_at_the_point_of_the_orbit_where_it_is_found(other_point: bool) -> None:
    outcome = conclude(atlas(), values(results())).outcome
    assert isinstance(outcome, Proved)
    chain = outcome.results.chain
    (at,) = [point for point in complete_list(atlas(), chain, values(results()), 2).points if point.k == 2]
    assert at.kind is Kind.HERE
    place = PlaceOnCurve(at.piece, at.s, False, other_point)
    entry = Bifurcation("row", "period_tupling", 2, place, "", {})
    if other_point:
        with pytest.raises(EmptyIntersectionError):
            complete_list(atlas(), chain, values(results()), 2, [entry])
    else:
        assert complete_list(atlas(), chain, values(results()), 2, [entry]).points[0].certificates == ("row",)


# Forgeries


def document_of(found: Results) -> dict[str, Any]:
    return make_atlas_certificate(atlas(), values(found), listed(found))


def shifted_function(entry: dict[str, Any], name: str) -> None:
    functions = entry["results"][0]["stability"][name]
    function_ = functions[0] if isinstance(functions, list) else functions
    value = parse_exact(function_["coefficients"][0])
    function_["coefficients"][0] = format_exact(value * (1 + Fraction(1, 2**10)))


def narrow_bound(entry: dict[str, Any]) -> None:
    entry["results"][0]["stability"]["characteristic"][0]["error"] = format_exact(Fraction(1, 2**60))


@pytest.mark.parametrize("change", ["characteristic", "level", "half_period", "first_factor", "bound"])
def test_forged_functions_are_found_by_another_integration(change: str) -> None:
    """Also with a list that fits them."""

    def forge(entry: dict[str, Any]) -> None:
        if change == "bound":
            narrow_bound(entry)
        else:
            shifted_function(entry, change)

    true = results()
    prover = honest(confirming(true))
    assert checked(document_of(true), prover).stands
    entry: dict[str, Any] = {"results": results()}
    forge(entry)
    found = checked(document_of(entry["results"]), prover)
    assert any("stability" in finding.place for finding in found.findings)


def confirming(found: Results) -> Results:
    """What another integration would find: the same functions with smaller bounds."""
    entries: Results = json.loads(json.dumps(found))
    for result in entries:
        stability = result["stability"]
        parts = [*stability["characteristic"], *(stability[n] for n in ("level", "half_period", "first_factor"))]
        for part in parts:
            part["error"] = format_exact(parse_exact(part["error"]) / 4)
    return entries
