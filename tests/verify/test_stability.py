"""Stability along a curve: functions contain what they enclose, no zero is lost, and nothing is listed that is not."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import cos, gcd, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_poly, ctx
from scipy.integrate import solve_ivp
from support.flow_checks import ball
from support.forgeries import checked, forged, honest

from orbitproof.shared.formats.atlas import Atlas, read_atlas
from orbitproof.shared.formats.pieces import Piece, piece_from_json
from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.shared.systems.libration import AROUND
from orbitproof.shared.systems.system import CR3BP, FALKNER_SKAN
from orbitproof.verify.algebra.grading import Grading
from orbitproof.verify.algebra.series import Series
from orbitproof.verify.algebra.wide import WideArithmetic
from orbitproof.verify.atlas.certificate import make_atlas_certificate
from orbitproof.verify.curve.bifurcations_on_it import Bifurcation, Place
from orbitproof.verify.curve.libration_point import derived_parameter
from orbitproof.verify.curve.piece import PieceLimits
from orbitproof.verify.curve.theorem import conclude
from orbitproof.verify.evidence.comparisons import EmptyIntersectionError
from orbitproof.verify.evidence.failure import IntegrationFailure
from orbitproof.verify.evidence.outcome import Proved
from orbitproof.verify.stability.along import solve
from orbitproof.verify.stability.complete_list import Segment, about_the_list, complete_list, orders, resonant_value
from orbitproof.verify.stability.functions import (
    REACH,
    BoundedFunction,
    function,
    function_from_json,
    function_to_json,
    inverse,
    restricted,
    slope,
)
from orbitproof.verify.stability.linear_stability import is_stable
from orbitproof.verify.stability.matrix import SHARE, orbit_functions
from orbitproof.verify.stability.theorem import with_complete_list
from orbitproof.verify.stability.units import scales
from orbitproof.verify.stability.zeros import zeros_beside_double_one, zeros_on

DATA = Path(__file__).parents[1] / "data"
END = 1 / REACH
Results = list[dict[str, Any]]
PIECES: dict[str, Any] = json.loads((DATA / "branch-pieces.json").read_text())


@pytest.fixture(autouse=True)
def _precision() -> Any:
    with ctx.workprec(160):
        yield


@cache
def atlas() -> Atlas:
    """The Falkner-Skan family for beta from 260 to 690."""
    return read_atlas(DATA / "atlas-falkner-skan.json")


def results() -> Results:
    """What is proved of its two pieces, with the stability of the orbits."""
    found: Results = json.loads((DATA / "stability-falkner-skan.json").read_text())
    return found


# Functions


ALGEBRA = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=10)


def element(*coefficients: str, error: str = "0") -> Series:
    return function(ALGEBRA, [Fraction(value) for value in coefficients], Fraction(error))


def enclosed(series: Series) -> BoundedFunction:
    return function_from_json(function_to_json(series))


@pytest.mark.parametrize("seed", range(20))
def test_functions_hold_unknown_parts_and_their_derivatives(seed: int) -> None:
    """1/(3 - s) + e s^7 on |s| <= 1, stored, with its derivatives in tau."""
    source = random.Random(seed)
    error = Fraction(source.randint(1, 100), 10**4)
    sign = source.choice((1, -1))
    known = inverse(element("3", "-1")).widened(error)
    stored = enclosed(restricted(known, SHARE))
    share, tau = float(SHARE), source.uniform(-1, 1) * float(END)
    s = share * tau
    part = ball(Fraction(tau)) + arb(0, 1e-9)
    unknown = sign * float(error)
    assert stored.value(part).contains(arb(1 / (3 - s) + unknown * s**7))
    assert stored.slope(part).contains(arb(share * (1 / (3 - s) ** 2 + unknown * 7 * s**6)))
    assert stored.curvature(part).contains(arb(share**2 * (2 / (3 - s) ** 3 + unknown * 42 * s**5)))
    derived = enclosed(slope(known, SHARE))
    assert derived.value(part).contains(arb(1 / (3 - s) ** 2 + unknown * 7 * s**6))
    product = stored * stored
    assert product.value(part).contains(arb((1 / (3 - s) + unknown * s**7) ** 2))
    assert stored.mirrored().value(-part).overlaps(stored.value(part))


def test_functions_are_not_much_wider_than_what_is_known() -> None:
    stored = enclosed(restricted(element("1", "2", "3", error="1e-12"), SHARE))
    assert float(stored.error) < 2e-11
    assert float(stored.slope(arb(0)).rad()) < 1e-9


def test_a_function_with_a_zero_in_the_disc_has_no_inverse() -> None:
    for middle in ("0", "1/2", "-9/10"):
        with pytest.raises(IntegrationFailure):
            inverse(element(middle, "1"))


def test_confirmation_takes_an_enclosure_inside() -> None:
    coarse, fine = element("1", "2", error="1e-6"), element("1.0000000001", "2", error="1e-7")
    other = element("1.0001", "2", error="1e-7")
    assert enclosed(coarse).contains(enclosed(fine))
    assert not enclosed(fine).contains(enclosed(coarse))
    assert not enclosed(coarse).contains(enclosed(other))


def test_functions_without_error_are_confirmed_with_more_bits() -> None:
    """What is lost by writing a function down is less with more precision."""
    finer = WideArithmetic(Grading((1,), 0), 192, 0, 0, width=10)
    coarse = WideArithmetic(Grading((1,), 0), 160, 0, 0, width=10)
    stored, fresh = (
        enclosed(inverse(function(a, [Fraction(3), Fraction(1, 9)], Fraction(0)))) for a in (coarse, finer)
    )
    linear = [enclosed(function(a, [Fraction(1, 3), Fraction(1, 7)], Fraction(0))) for a in (coarse, finer)]
    assert linear[0].contains(linear[1])
    assert stored.value(arb(0)).overlaps(fresh.value(arb(0)))


@pytest.mark.parametrize("entry", [{"coefficients": ["1"], "error": "-1"}, {"coefficients": ["x"], "error": "0"}])
def test_functions_that_are_none_are_refused(entry: dict[str, Any]) -> None:
    with pytest.raises(ValueError):
        function_from_json(entry)


# The curve in its tube


def tube_equation(error: float = 0.0) -> Series:
    """F = s/8 + (2 + s) w + unknown parts."""
    arithmetic = WideArithmetic(Grading((1,), 1), 80, 0, 0, width=10)
    known = arithmetic.polynomial({(0,): [Fraction(0), Fraction(1, 8)], (1,): [Fraction(3), Fraction(1)]})
    return known.with_errors([error, error, error])


@pytest.mark.parametrize("sign", [1, -1])
def test_the_curve_in_its_tube_is_enclosed(sign: int) -> None:
    """With s^3/1000 + s w/1000 + w^2/1000 added, the zero w(s) is that of a quadratic equation."""
    error = 1 / 1000
    (omega,) = solve(ALGEBRA, [tube_equation(error)]).omega
    found = enclosed(restricted(omega, SHARE))
    for number in range(-20, 21):
        s = number / 21
        linear, constant = 3 + s + sign * error * s, s / 8 + sign * error * s**3
        root = 2 * -constant / (linear + (linear**2 - 4 * sign * error * constant) ** 0.5)
        assert found.value(arb(s / float(SHARE))).contains(arb(root))


def test_a_curve_that_leaves_its_tube_or_turns_is_not_enclosed() -> None:
    for equation in (tube_equation(0.5), tube_equation(float("inf")), tube_equation(float("nan"))):
        with pytest.raises(IntegrationFailure):
            solve(ALGEBRA, [equation])


# Zeros


def polynomial(roots: Sequence[Fraction], error: float = 0.0) -> BoundedFunction:
    value = arb_poly([1])
    for root in roots:
        value = value * arb_poly([-ball(root), 1])
    return BoundedFunction(value, arb(error))


@pytest.mark.parametrize("seed", range(40))
def test_all_zeros_are_found_one_by_one(seed: int) -> None:
    source = random.Random(seed)
    roots = sorted({Fraction(source.randint(-1200, 1200), 1000) for _ in range(source.randint(0, 7))})
    inside = [root for root in roots if -END < root < END]
    found = zeros_on(polynomial(roots), -END, END)
    assert not found.undecided
    assert len(found.zeros) == len(inside)
    for zero, root in zip(found.zeros, inside, strict=True):
        assert zero.lower < root < zero.upper
        assert zero.place.contains(ball(root))
        assert float(zero.place.rad()) < 1e-12


def test_double_zeros_and_wide_bounds_are_undecided() -> None:
    for function_ in (polynomial([Fraction(1, 3)] * 2), polynomial([Fraction(1, 3)], 0.5), polynomial([END])):
        found = zeros_on(function_, -END, END)
        assert found.undecided
        assert not found.zeros
    touching = zeros_on(polynomial([Fraction(1, 3)] * 2), -END, END).undecided
    assert all(low <= Fraction(1, 3) <= high for low, high in touching)


def test_zeros_beside_a_double_one_are_found() -> None:
    twice = [Fraction(0), Fraction(0), Fraction(1, 2)]
    end, found = zeros_beside_double_one(polynomial(twice), END)
    assert 0 < end < Fraction(1, 2)
    (zero,) = found.zeros
    assert zero.place.contains(ball(Fraction(1, 2)))
    _, none = zeros_beside_double_one(polynomial(twice), -END)
    assert not none.zeros
    assert not none.undecided
    _, unknown = zeros_beside_double_one(polynomial([Fraction(0)] * 4), END)
    assert unknown.undecided


def test_each_resonant_value_occurs_once() -> None:
    values = [cos(2 * pi * j / k) for k, j in orders(12)]
    every = {round(cos(2 * pi * j / k), 12) for k in range(1, 13) for j in range(k)}
    assert sorted({round(value, 12) for value in values}) == sorted(every)
    assert len(values) == len(every)
    for (k, j), value in zip(orders(12), values, strict=True):
        assert gcd(k, j) == 1
        assert abs(float(resonant_value(k, j)) - value) < 1e-15


# The stability matrix


def variations(piece: Piece, s: Any, half_periods: Any) -> tuple[Any, Any]:
    """dy/dy(0) after one and two half periods of Falkner-Skan orbits, by an integrator that knows no enclosures."""
    points = np.array([[float(value) for value in piece.point(Fraction(float(x)))] for x in s])
    beta, y = points.T
    zero, one = np.zeros_like(y), np.ones_like(y)

    def field(_: float, flat: Any) -> Any:
        x, y, z, dx, dy, dz = flat.reshape(6, -1)
        rates = [y, z, beta * (y * y - 1) - x * z, dy, dz, beta * 2 * y * dy - dx * z - x * dz]
        return (np.array(rates) * half_periods).ravel()

    start = np.concatenate([zero, y, zero, zero, one, zero])
    found = solve_ivp(field, (0, 2), start, "DOP853", (1.0, 2.0), rtol=3e-14, atol=1e-15)
    ends = found.y.reshape(6, len(y), 2)
    return ends[4, :, 0], ends[4, :, 1]


def check_falkner_skan(
    piece: Piece, entry: Mapping[str, Any], interval: tuple[Fraction, Fraction], number: int
) -> None:
    """Random points of the curve: the independent derivatives lie in the enclosures, up to their own accuracy."""
    start, end = interval
    source = np.random.default_rng(1)
    s = source.uniform(float(start), float(end), number)
    middle, radius = float(start + end) / 2, float(end - start) / 2 * float(REACH)
    taus = [arb(float(value)) for value in (s - middle) / radius]
    names = ("half_period", "level")
    period, level = ([function_from_json(entry[name]).value(tau) for tau in taus] for name in names)
    sigma = [function_from_json(entry["characteristic"][0]).value(tau) for tau in taus]
    factor = [function_from_json(entry["first_factor"]).value(tau) for tau in taus]
    out, around = variations(piece, s, np.array([float(value) for value in period]))
    assert np.allclose([float(value) for value in level], [float(piece.point(Fraction(x))[0]) for x in s], rtol=1e-12)
    for enclosure, value in zip(sigma, around, strict=True):
        assert (enclosure + arb(0, 1e-9)).contains(arb(value))
        assert float(enclosure.rad()) < 1e-6
    ratios = np.array([float(value) for value in factor]) / out
    assert np.all(np.abs(ratios) > 0)
    assert np.all(np.sign(ratios) == np.sign(ratios[0]))


def test_sigma_contains_independent_variations_at_random_points() -> None:
    """Sigma = dy(P^2)/dy at fixed beta: the velocity y' = z vanishes on the section."""
    for piece, result in zip(atlas().curve_pieces(), results(), strict=True):
        start, end = (parse_exact(text) for text in result["interval"])
        check_falkner_skan(piece, result["stability"], (start, end), 1000)


def test_another_interval_and_other_settings_enclose_the_same() -> None:
    piece = atlas().curve_pieces()[1]
    interval = (Fraction(1, 4), Fraction(1, 2))
    found = orbit_functions(atlas().system, {}, piece, interval, PieceLimits(60, 24, 16), "physical").to_json()
    check_falkner_skan(piece, found, interval, 20)


def test_planar_orbits_in_units_of_their_size_have_the_stability_of_the_three_body_problem() -> None:
    """The trace of the planar monodromy matrix of the CR3BP is 2 + 2 Sigma, and Sigma is continuous at size 0."""
    entry = PIECES["lyapunov"]
    system = AROUND["L1"]
    parameters = {key: parse_exact(value) for key, value in entry["parameters"].items()}
    piece = piece_from_json(entry["piece"], system, "piece")
    assert isinstance(piece, Piece)
    interval = (Fraction(1, 2), Fraction(3, 4))
    found = orbit_functions(system, parameters, piece, interval, PieceLimits(72, 28, 16), "physical").to_json()
    functions = [function_from_json(found[name]) for name in ("half_period", "level")]
    (sigma,) = (function_from_json(part) for part in found["characteristic"])
    taus = [arb(number) / 32 for number in range(-30, 31, 6)]
    periods, sizes = (np.array([float(function_.value(tau)) for tau in taus]) for function_ in functions)
    s = [Fraction(5, 8) + Fraction(1, 8) * REACH * Fraction(number, 32) for number in range(-30, 31, 6)]
    points = np.array([[float(value) for value in piece.point(place)] for place in s]).T
    assert np.allclose(points[0], sizes, rtol=1e-9)
    mu = parameters["mu"]
    state = np.zeros((6, len(s)))
    x_l = float(derived_parameter(system, "x_l", parameters, 80).middle)
    state[0], state[4] = x_l + points[0], points[0] * points[1]
    whole, _ = monodromy(state, float(mu), 2 * periods)
    plane = np.moveaxis(whole[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], -1, 0)
    for tau, trace in zip(taus, np.trace(plane, axis1=1, axis2=2), strict=True):
        value = sigma.value(tau)
        assert (value + arb(0, 1e-5 * abs(trace))).contains(arb((trace - 2) / 2))
        assert float(value.rad()) < 0.05 * abs(trace)


def test_only_systems_that_scale_have_own_units() -> None:
    assert all(scales(system) for system in AROUND.values())
    assert not scales(FALKNER_SKAN)


@pytest.mark.parametrize("tube", [Fraction(1, 10**9), Fraction(1, 10**8)])
def test_a_curve_beside_its_tube_is_refused(tube: Fraction) -> None:
    """The polynomial is moved by 2e-8 across the curve: out of the tube, and in the wider one out of the half of it."""
    piece = atlas().curve_pieces()[1]
    ((first, *others),) = piece.polynomial
    moved = replace(piece, polynomial=((first + Fraction(2, 10**8), *others),), tube=(tube,))
    interval = (Fraction(1, 4), Fraction(1, 2))
    with pytest.raises(IntegrationFailure, match="in its tube" if tube == Fraction(1, 10**8) else "analytic"):
        orbit_functions(atlas().system, {}, moved, interval, PieceLimits(60, 24, 16), "physical")


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


# The list


def listed(found: Results, order: int = 12) -> dict[str, Any]:
    return with_complete_list(atlas(), found, conclude(atlas(), found), order)


def test_the_list_of_the_falkner_skan_family_is_complete() -> None:
    """Sigma goes from below -1 to about 0.05 along these pieces, and increases."""
    document = listed(results())
    assert document["verdict"] == "proved"
    found = document["complete"]
    assert found["gaps"] == found["undecided"] == []
    expected = sorted((cos(2 * pi * j / k), k, j) for k, j in orders(12) if -1 <= cos(2 * pi * j / k) < 0.05)
    assert [(point["k"], point["j"]) for point in found["points"]] == [(k, j) for _, k, j in expected]
    (stable,) = found["stable"]
    assert stable["from"]["what"] == "doubling at this point"
    assert stable["to"]["what"] == "the end of the curve"
    (touch_and_go,) = [point for point in found["points"] if point["k"] == 3]
    assert "453.44258" in touch_and_go["level"]["decimal"]
    assert "1:11 (j = 5)" in document["statement"]
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
    reason = {"condition": "stability", "message": "the computer was tired", "remedy": "let it sleep"}
    for why, text in ((None, "was not looked at"), (reason, "the computer was tired")):
        document = listed(without_stability(results(), 0, why))
        found = document["complete"]
        assert document["verdict"] == "proved"
        assert [gap["piece"] for gap in found["gaps"]] == ["p014"]
        assert text in found["gaps"][0]["reason"]
        assert text in document["statement"]
        assert "but for the places named below" in document["statement"]
        assert {point["piece"] for point in found["points"]} == {"p015"}
        assert found["undecided"]


def test_a_resonance_within_the_bounds_of_a_joint_is_counted_once_or_named() -> None:
    """The joint is moved over a resonance: the list is the same as before."""
    before = [(point["k"], point["j"]) for point in listed(results())["complete"]["points"]]
    moved = results()
    moved[0]["interval"] = ["-1", moved[0]["interval"][1]]
    assert [(point["k"], point["j"]) for point in listed(moved)["complete"]["points"]] == before


def certified(k: int, s: float, piece: str = "p015") -> Bifurcation:
    return Bifurcation("row", "touch_and_go", k, Place(piece, ball(Fraction(s)), False), "", {})


def test_certificates_are_matched_by_where_they_are() -> None:
    outcome = conclude(atlas(), results()).outcome
    assert isinstance(outcome, Proved)
    chain = outcome.results.chain
    plain = complete_list(atlas(), chain, results(), 4)
    (at,) = [point for point in plain.points if point.k == 3]
    place = float(at.s.mid())
    (found,) = [p for p in complete_list(atlas(), chain, results(), 4, [certified(3, place)]).points if p.k == 3]
    assert found.certificates == ("row",)
    for k, s in ((4, place), (3, place + 1e-3)):
        with pytest.raises(EmptyIntersectionError):
            complete_list(atlas(), chain, results(), 4, [certified(k, s)])
    assert complete_list(atlas(), chain, results(), 3, [certified(4, place)]).points


def test_bifurcations_out_of_the_plane_are_not_looked_for_in_the_plane() -> None:
    planar = read_atlas(DATA / "atlas-lyapunov.json")
    assert about_the_list(planar, [certified(1, 0.0)], 12) == []
    assert about_the_list(atlas(), [certified(1, 0.0), certified(13, 0.0)], 12) == [certified(1, 0.0)]


@pytest.mark.parametrize("other_point", [True, False])
def test_doubling_is_certified_at_the_point_of_the_orbit_where_it_is_found(other_point: bool) -> None:
    outcome = conclude(atlas(), results()).outcome
    assert isinstance(outcome, Proved)
    chain = outcome.results.chain
    (at,) = [point for point in complete_list(atlas(), chain, results(), 2).points if point.k == 2]
    assert at.kind == "doubling at this point"
    place = Place(at.piece, at.s, False, other_point)
    entry = Bifurcation("row", "period_tupling", 2, place, "", {})
    if other_point:
        with pytest.raises(EmptyIntersectionError):
            complete_list(atlas(), chain, results(), 2, [entry])
    else:
        assert complete_list(atlas(), chain, results(), 2, [entry]).points[0].certificates == ("row",)


# Forgeries


def document_of(found: Results) -> dict[str, Any]:
    return make_atlas_certificate(atlas(), found, listed(found))


def left_out(entry: dict[str, Any]) -> None:
    del entry["conclusion"]["complete"]["points"][3]


def one_too_many(entry: dict[str, Any]) -> None:
    points = entry["conclusion"]["complete"]["points"]
    points.insert(3, points[3])


def wrong_order(entry: dict[str, Any]) -> None:
    entry["conclusion"]["complete"]["points"][3]["k"] = 8


def longer(entry: dict[str, Any]) -> None:
    """The stable interval begins a little earlier."""
    begin = entry["conclusion"]["complete"]["stable"][0]["from"]
    begin["interval"] = [format_exact(parse_exact(end) - Fraction(1, 2**30)) for end in begin["interval"]]


def other_words(entry: dict[str, Any]) -> None:
    for holder in (entry["statement"], entry["conclusion"]):
        key = "theorem" if "theorem" in holder else "statement"
        holder[key] = holder[key].replace("1:11 (j = 5)", "1:11 (j = 4)")


def fewer_orders(entry: dict[str, Any]) -> None:
    entry["conclusion"]["complete"]["order"] = 11


def no_gap(entry: dict[str, Any]) -> None:
    """A piece was not looked at, and the list says nothing of it."""
    del entry["results"][1]["stability"]


@pytest.mark.parametrize(
    "change", [left_out, one_too_many, wrong_order, longer, other_words, fewer_orders, no_gap], ids=lambda f: f.__name__
)
def test_a_forged_list_is_found_without_integrating(change: Callable[[dict[str, Any]], None]) -> None:
    document = document_of(results())
    assert checked(document).stands
    found = checked(forged(document, change))
    assert not found.stands
    assert found.findings


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


# The CR3BP


def monodromy(state: Any, mu: float, times: Any) -> Any:
    """The derivative of the flow, shape (6, 6, points), and the states there, by complex steps of an integrator."""
    step = 1e-30
    number = state.shape[1]
    start = np.repeat(state[:, None, :], 6, axis=1).astype(complex)
    for column in range(6):
        start[column, column] += 1j * step

    def field(_: float, flat: Any) -> Any:
        values = CR3BP.vector_field(list(flat.reshape(6, 6, number)), [mu])
        return (np.array(values) * times).ravel()

    end = (
        solve_ivp(field, (0, 1), start.ravel(), "DOP853", (1.0,), rtol=3e-14, atol=1e-16).y[:, -1].reshape(start.shape)
    )
    return end.imag / step, end[:, 0].real


def on_section(derivative: Any, state: Any, mu: float) -> Any:
    """Derivatives of the point where the orbits meet y = 0."""
    velocity = np.array(CR3BP.vector_field(list(state), [mu]))
    return derivative - velocity[:, None] * (derivative[1] / velocity[1])[None]


def invariants(matrix: Any) -> tuple[Any, Any, Any]:
    """Trace, sum of the principal minors of order 2, determinant; shape (n, n, points)."""
    stacked = np.moveaxis(matrix, -1, 0)
    trace = np.trace(stacked, axis1=1, axis2=2)
    second = (trace**2 - np.trace(stacked @ stacked, axis1=1, axis2=2)) / 2
    return trace, second, np.linalg.det(stacked)


def independent_coefficients(points: Any, mu: float, half_periods: Any) -> list[tuple[Any, Any]]:
    """a_1 and a_2, from D(P^2) on Fix(R), and from 1 + 2 B^T C in canonical coordinates on the level."""
    state = np.zeros((6, points.shape[1]))
    state[[0, 2, 4]] = points
    whole, there = monodromy(state, mu, 2 * half_periods)
    return_map = on_section(whole, there, mu)[np.ix_([0, 2, 4], [0, 2, 4])]
    trace, second, _ = invariants(return_map)
    first_way = trace - 1, second - (trace - 1)
    half, there = monodromy(state, mu, half_periods)
    half = on_section(half, there, mu)
    integral = CR3BP.first_integral
    assert integral is not None
    gradient = [
        integral([*(state[:i] + 0j), state[i] + 1e-30j, *(state[i + 1 :] + 0j)], [mu])[0].imag / 1e-30 for i in (0, 2)
    ]
    block_b = half[np.ix_([0, 2], [3, 5])]
    block_c = np.stack(
        [
            half[[3, 5], i] + half[[3, 5], 4] * (slope_ / (2 * state[4]))
            for i, slope_ in zip((0, 2), gradient, strict=True)
        ],
        axis=1,
    )
    sigma = np.eye(2)[:, :, None] + 2 * np.einsum("kip,kjp->ijp", block_b, block_c)
    return [first_way, invariants(sigma)[:2]]


def check_three_body(name: str, interval: tuple[Fraction, Fraction], limits: PieceLimits, number: int) -> None:
    entry = PIECES[name]
    piece = piece_from_json(entry["piece"], CR3BP, "piece")
    assert isinstance(piece, Piece)
    parameters = {key: parse_exact(value) for key, value in entry["parameters"].items()}
    coordinates = "regularised" if name == "regularised" else "physical"
    found = orbit_functions(CR3BP, parameters, piece, interval, limits, coordinates, "S").to_json()
    source = np.random.default_rng(2)
    start, end = interval
    s = source.uniform(float(start), float(end), number)
    middle, radius = float(start + end) / 2, float(end - start) / 2 * float(REACH)
    taus = [arb(float(value)) for value in (s - middle) / radius]
    points = np.array([[float(value) for value in piece.point(Fraction(x))] for x in s]).T
    periods = np.array([float(function_from_json(found["half_period"]).value(tau)) for tau in taus])
    for coefficients in independent_coefficients(points, float(parameters["mu"]), periods):
        for stored, values in zip(found["characteristic"], coefficients, strict=True):
            function_ = function_from_json(stored)
            scale = max(1.0, float(np.max(np.abs(values))))
            for tau, value in zip(taus, values, strict=True):
                enclosure = function_.value(tau)
                assert (enclosure + arb(0, 1e-6 * scale)).contains(arb(value))
                assert float(enclosure.rad()) < 1e-2 * scale


@pytest.mark.parametrize("name", ["symmetric", pytest.param("regularised", marks=pytest.mark.slow)])
def test_sigma_of_halo_orbits_contains_independent_monodromy(name: str) -> None:
    """In both coordinates, with 0 of a symmetric piece inside; D(P^2) on Fix(R), and 1 + 2 B^T C."""
    interval = (Fraction(-1, 8), Fraction(1, 8)) if name == "symmetric" else (Fraction(5, 16), Fraction(3, 8))
    check_three_body(name, interval, PieceLimits(72, 28, 14), 50)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["symmetric", "regularised"])
def test_sigma_of_whole_pieces_contains_independent_monodromy(name: str) -> None:
    check_three_body(name, (Fraction(-1), Fraction(1)), PieceLimits(96, 40, 48), 1000)
