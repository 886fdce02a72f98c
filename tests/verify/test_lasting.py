"""Stability for ever along a curve: the functions, the list that is made of them, and what is refused."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import acos, cos, pi, sin, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from flint import arb, ctx
from support.closed_form_lists import line
from support.closed_form_lists import results as closed_results
from support.conclusions import conclude, with_lasting
from support.forgeries import checked, honest
from support.return_maps import INDICES, Number, coefficients, falkner_skan_half_return, random_taylor, turning
from support.stability_cases import atlas
from support.stored import value_of, values
from support.within import within

import orbitproof.verify.lasting.fates as fates
from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import InputError, piece_from_json
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, HILL, Defined
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.branches.conclusion import conclusion_of
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.evidence import NotKnown, ball_from_json
from orbitproof.verify.functions import REACH, StoredFunction
from orbitproof.verify.lasting import (
    FunctionJet,
    compose,
    conclude_lasting,
    exceptions_to_sharpen,
    exchanged,
    inverse_of_plane_map,
    is_known_of,
    normal_form,
    solved,
    twist_of_piece,
    twist_open_on,
    unconfirmed_twist,
)
from orbitproof.verify.lasting.fates import _may_end, _twist_on
from orbitproof.verify.lasting.stored import may_be_stable
from orbitproof.verify.newton import Jet
from orbitproof.verify.run.branch_tasks import reusable
from orbitproof.verify.run.branches import limits_of
from orbitproof.verify.stability import PRECISION, Matter, Resonance, StabilityFunctions, conclude_list, zeros_on
from orbitproof.verify.theorems.curve import KIND as CURVE
from orbitproof.verify.twist import rotation_of, twist_of
from orbitproof.verify.words.lasting import lasting_in_words

DATA = Path(__file__).parents[1] / "data"
Results = list[dict[str, Any]]
Pair = tuple[FunctionJet[Number], FunctionJet[Number]]


@cache
def _stored() -> str:
    return (DATA / "lasting-falkner-skan.json").read_text()


def results() -> Results:
    """What is proved of the Falkner-Skan family for beta from 260 to 690, with the twist of its orbits."""
    found: Results = json.loads(_stored())
    return found


_precision = within(lambda: ctx.workprec(160))


# The functions of section 29.3


def return_map(half: Pair) -> Pair:
    """R P^-1 R P in floats."""
    (a, b), (c, d) = ([jet.coefficients[unit] for unit in ((1, 0), (0, 1))] for jet in half)
    back = inverse_of_plane_map(*half, Number(1 / (a * d - b * c)))
    turned = [half[0], half[1].scaled(Fraction(-1))]
    return compose(back[0], turned), compose(back[1], turned).scaled(Fraction(-1))


def elliptic(seed: int, wanted: float | None = None) -> Pair:
    """The return map of a random P, with |s| < 1, or with s = `wanted`."""
    source = random.Random(seed)
    while True:
        rows = [random_taylor(source) for _ in range(2)]
        if wanted is not None:
            # s = 2 a d/(a d - b c) - 1.
            a, b, c = (rows[i][unit] for i, unit in ((0, (1, 0)), (0, (0, 1)), (1, (1, 0))))
            rows[1][0, 1] = Number(b * c * (1 + wanted) / (a * (wanted - 1)))
        half = FunctionJet(rows[0]), FunctionJet(rows[1])
        (a, b), (c, d) = ([jet.coefficients[unit] for unit in ((1, 0), (0, 1))] for jet in half)
        if abs(a * d - b * c) < 0.2:
            continue
        found = return_map(half)
        if abs(found[0].coefficients[1, 0]) < 0.95:
            return found


def form(found: Pair) -> Any:
    """Theta, D and Delta."""
    return normal_form(*found, found[0].coefficients[1, 0], Number(1))


@pytest.mark.parametrize("seed", range(20))
def test_inverses_and_implicit_functions_solve_their_equations(seed: int) -> None:
    source = random.Random(seed)
    half = FunctionJet(random_taylor(source)), FunctionJet(random_taylor(source))
    (a, b), (c, d) = ([float(jet.coefficients[unit]) for unit in ((1, 0), (0, 1))] for jet in half)
    back = inverse_of_plane_map(*half, Number(1 / (a * d - b * c)))
    scale = max(1, abs(1 / (a * d - b * c))) ** 5
    for place, jet in enumerate(back):
        one = compose(jet, half).coefficients
        assert all(abs(one[index] - (index == ((1, 0), (0, 1))[place])) < 1e-9 * scale for index in INDICES)
    indices = [(i, j, k) for i in range(4) for j in range(4) for k in range(4) if 0 < i + j + k <= 3]
    function = FunctionJet({index: Number(source.uniform(-1, 1)) for index in indices})
    slope = function.coefficients[1, 0, 0]
    known = [FunctionJet({unit: Number(1)}) for unit in ((1, 0), (0, 1))]
    level = compose(function, [solved(function, Number(1 / slope), known), *known]).coefficients
    assert max(map(abs, level.values())) < 1e-9 * max(1, 1 / abs(slope)) ** 5


@pytest.mark.parametrize("seed", range(40))
def test_theta_is_the_twist_times_what_clears_its_denominators(seed: int) -> None:
    """Against (28.2) in complex floats, and by the reversibility of the map."""
    found = elliptic(seed)
    first, second = (jet.coefficients for jet in found)
    s, c = float(first[1, 0]), float(second[1, 0])
    size = sqrt(1 - s * s)
    twist = (complex(s, -size) * coefficients(first, second)[0]).imag
    expected = 16 * c * c * size * (1 - s) * (1 + 2 * s) * twist
    known = form(found)
    scale = max(1.0, *(abs(v) for row in (first, second) for v in row.values())) ** 4
    assert known.twist == pytest.approx(expected, rel=1e-8, abs=1e-9 * scale)
    assert abs(known.defect) < 1e-8 * scale
    other = normal_form(exchanged(found[1]), exchanged(found[0]), first[1, 0], Number(1))
    assert other.twist == pytest.approx(known.twist * abs(first[0, 1] / c) ** 3, rel=1e-6, abs=1e-8 * scale)


@pytest.mark.parametrize("seed", range(20))
def test_theta_has_the_sign_of_the_twist_of_one_orbit(seed: int) -> None:
    """Of section 28.3, in balls: an implementation of its own."""
    found = elliptic(seed + 100)
    jets = [
        Jet(2, 3, {(0, 0): arb(0), **{index: arb(float(value)) for index, value in jet.coefficients.items()}})
        for jet in found
    ]
    # What the entries of DF have of rounding, is none of the map's.
    s = jets[0][1, 0]
    entries = [{**jet.coefficients} for jet in jets]
    entries[1][0, 1] = s
    entries[0][0, 1] = (s * s - 1) / entries[1][1, 0]
    jets = [Jet(2, 3, entry) for entry in entries]
    twist = twist_of(jets, rotation_of(jets)).twist
    theta = form(found).twist * (1 + 2 * float(s))
    assert theta * float(twist.mid()) > 0


@pytest.mark.parametrize("seed", range(20))
def test_at_resonances_of_order_3_and_4_the_functions_say_what_they_shall(seed: int) -> None:
    third = elliptic(seed, -0.5)
    first, second = (jet.coefficients for jet in third)
    c, size = float(second[1, 0]), sqrt(0.75)
    g_02 = coefficients(first, second)[2] * 2 * c * size
    assert form(third).twist == pytest.approx(2 * abs(g_02) ** 2, rel=1e-6)
    fourth = elliptic(seed, 0.0)
    first, second = (jet.coefficients for jet in fourth)
    c_1, d, _ = coefficients(first, second)
    scale = 144 * (2 * float(second[1, 0])) ** 4
    expected = scale * (abs(d) ** 2 - (-1j * c_1).imag ** 2)
    assert form(fourth).fourth == pytest.approx(expected, rel=1e-6, abs=1e-6 * scale * abs(d) ** 2)


def test_delta_has_both_signs() -> None:
    signs = {form(elliptic(seed, 0.0)).fourth > 0 for seed in range(40)}
    assert signs == {True, False}


def kick(share: float, square: float, cube: float) -> tuple[Pair, Callable[[float, float], tuple[float, float]]]:
    """An area-preserving reversible map, q + f(p)/2, p + q, q + f(p)/2 with f = -share p + .., as jets and as such."""

    def force(p: float) -> float:
        return -share * p + square * p * p + cube * p**3

    def step(p: float, q: float) -> tuple[float, float]:
        middle = q + force(p) / 2
        return p + middle, middle + force(p + middle) / 2

    zero = FunctionJet({index: Number(0) for index in INDICES})
    p, q = (FunctionJet({unit: Number(1)}) for unit in ((1, 0), (0, 1)))

    def half(jet: FunctionJet[Number]) -> FunctionJet[Number]:
        terms = jet.scaled(Fraction(-share)) + (jet * jet).scaled(Fraction(square))
        return (terms + (jet * jet * jet).scaled(Fraction(cube))).scaled(Fraction(1, 2))

    middle = q + half(p)
    image = p + middle
    return (zero + image, zero + middle + half(image)), step


@pytest.mark.parametrize(
    ("share", "square", "cube"), [(0.6, 0.5, 0.1), (2.2, 0.7, -0.4), (3.5, -0.3, 0.8), (2.7, 0.9, 0)]
)
def test_orbits_turn_as_the_twist_says(share: float, square: float, cube: float) -> None:
    found, step = kick(share, square, cube)
    s, c = float(found[0].coefficients[1, 0]), float(found[1].coefficients[1, 0])
    size = sqrt(1 - s * s)
    small = 1e-2
    turned = turning(step, c, size, small, 3000) - acos(s)
    theta = form(found).twist
    twist = theta / (16 * c * c * size * (1 - s) * (1 + 2 * s))
    assert turned == pytest.approx(twist * (small / (2 * size)) ** 2, rel=0.02)


@pytest.mark.parametrize(("share", "cube"), [(0.6, 0.3), (3.0, 0.4), (3.0, -0.7), (3.3, 0.2)])
def test_orbits_of_odd_maps_turn_as_the_twist_says_at_1_3_too(share: float, cube: float) -> None:
    """(29.9), with terms of degree 2 that are 0 and with none."""
    found, step = kick(share, 0, cube)
    s, c = float(found[0].coefficients[1, 0]), float(found[1].coefficients[1, 0])
    size, small = sqrt(1 - s * s), 2e-2
    without = [FunctionJet({i: v for i, v in jet.coefficients.items() if sum(i) != 2}) for jet in found]
    known, same = (normal_form(jets[0], jets[1], Number(s), Number(1), odd=True) for jets in (found, without))
    assert (known.twist, known.fourth) == (same.twist, same.fourth)
    assert abs(known.defect) < 1e-12
    twist = known.twist / (16 * c * c * size * (1 - s))
    turned = turning(step, c, size, small, 3000) - acos(s)
    assert turned == pytest.approx(twist * (small / (2 * size)) ** 2, rel=0.02)
    assert form(found).twist == pytest.approx((1 + 2 * s) * known.twist)
    # Beside it the same map with a quadratic term throws points out at 1:3.
    _, bent = kick(share, 0.5, cube)
    if share == 3.0:
        assert farthest_of(step, 0.02) < 0.1
        assert farthest_of(bent, 0.02) > 0.1


def farthest_of(step: Callable[[float, float], tuple[float, float]], start: float) -> float:
    farthest = 0.0
    for direction in range(6):
        p, q = start * cos(direction * pi / 3), start * sin(direction * pi / 3)
        for _ in range(2000):
            p, q = step(p, q)
            farthest = max(farthest, abs(p) + abs(q))
            if farthest > 1:
                return farthest
    return farthest


@pytest.mark.parametrize("square", [0.7, -1.5])
def test_the_quadratic_map_has_no_twist_where_the_cosine_is_a_quarter_below_0(square: float) -> None:
    """3 cot(omega/2) + cot(3 omega/2) = 0, and rotation numbers of iterates fall and grow on the two sides."""
    below, middle, above = (kick(share, square, 0) for share in (2.4, 2.5, 2.6))
    assert float(middle[0][0].coefficients[1, 0]) == -0.25
    assert abs(form(middle[0]).twist) < 1e-12
    for found, step in (below, above):
        s, c = float(found[0].coefficients[1, 0]), float(found[1].coefficients[1, 0])
        theta, size = form(found).twist * (1 + 2 * s), sqrt(1 - s * s)
        assert (turning(step, c, size, 1e-2, 3000) - acos(s)) * theta > 0
    assert form(below[0]).twist * form(above[0]).twist < 0


@pytest.mark.parametrize(
    ("square", "cube", "unstable"), [(0.99, -0.06, True), (0.67, -0.05, True), (0.52, 0.18, False), (0.27, 0.74, False)]
)
def test_orbits_leave_a_resonance_of_order_4_where_delta_is_positive(
    square: float, cube: float, unstable: bool
) -> None:
    found, step = kick(2.0, square, cube)
    assert (form(found).fourth > 0) is unstable
    farthest = 0.0
    for direction in range(8):
        p, q = 0.04 * cos(direction * pi / 4), 0.04 * sin(direction * pi / 4)
        for _ in range(20000):
            p, q = step(p, q)
            farthest = max(farthest, abs(p) + abs(q))
            if farthest > 0.2:
                break
    assert (farthest > 0.2) is unstable


# Along the Falkner-Skan family


@cache
def listed() -> dict[str, Any]:
    """The conclusion with which orbits are stable for ever."""
    with ctx.workprec(160):
        return with_lasting(atlas(), results())


def test_the_orbits_of_the_family_are_stable_but_for_three() -> None:
    conclusion = listed()
    assert conclusion["verdict"] == "proved"
    lasting = conclusion["complete"]["lasting"]
    assert [(entry["k"], entry["fate"]) for entry in lasting["exceptions"]] == [
        (2, "open"), (3, "unstable"), (4, "unstable")
    ]  # fmt: skip
    assert [entry["twist"] for entry in lasting["stable"]] == ["negative", "positive", "positive"]
    assert lasting["gaps"] == lasting["undecided"] == []
    assert "- 1:4, a stability parameter is cos(2 pi 1/4): beta in [679.95" in conclusion["statement"]
    told = [line for line in conclusion["statement"].splitlines() if line.startswith("- from ")]
    assert [line.rpartition("; ")[2] for line in told if "; twist" in line] == [
        "twist negative", "twist positive", "twist positive"
    ]  # fmt: skip
    fates = [line.rpartition(": ")[2] for line in conclusion["statement"].splitlines() if "- 1:" in line]
    assert fates[-3:] == ["whether it is stable is not said", "unstable", "unstable"]
    assert (
        "All the other orbits of the curve, but for the exceptions listed here, have a multiplier outside the unit "
        "circle, and are unstable."
    ) in conclusion["statement"]
    assert "at the value of beta that belongs to the orbit" in conclusion["statement"]


@pytest.mark.parametrize(("number", "s"), [(0, -0.9), (0, 0.1), (0, 0.83), (1, -0.7), (1, 0.35), (1, 0.95)])
def test_functions_contain_those_of_orbits_that_are_integrated_apart(number: int, s: float) -> None:
    piece = atlas().curve_pieces()[number]
    result: Any = value_of(results()[number])
    beta = float(piece.centre[0]) + float(piece.half_width) * s
    y = float(piece.centre[1]) + sum(float(value) * s**n for n, value in enumerate(piece.polynomial[0]))
    tau = arb(s) * 32 / 33
    time = float(result.stability.half_period.enclosed.value(tau).mid())
    even, odd = falkner_skan_half_return(beta, y, time)
    half = tuple(FunctionJet({index: Number(row[index]) for index in INDICES}) for row in (even, odd))
    found = return_map(half)
    known = form(found)
    other = normal_form(exchanged(found[1]), exchanged(found[0]), found[0].coefficients[1, 0], Number(1))
    assert abs(odd[0, 0]) < 1e-9
    wanted = {"twist": known.twist, "exchanged": other.twist, "fourth": known.fourth, "defect": known.defect}
    for name, value in wanted.items():
        function = getattr(result.twist, name).enclosed
        far = abs(float(function.value(tau).mid()) - value)
        scale = abs(known.twist) if name == "defect" else abs(value)
        assert far < float(function.error) + 1e-6 * scale + 1e-9 * float(function.size), name


def test_a_new_integration_confirms_what_it_finds_and_nothing_narrower() -> None:
    result: Any = value_of(results()[1])
    twist = result.twist
    assert list(unconfirmed_twist(twist, twist)) == []
    for name in ("twist", "exchanged", "fourth", "defect"):
        known = getattr(twist, name)
        narrower = replace(known, error=known.error / 4)
        moved = replace(known, coefficients=(known.coefficients[0] + 2 * known.error, *known.coefficients[1:]))
        for other in (narrower, moved):
            assert len(list(unconfirmed_twist(replace(twist, **{name: other}), twist))) == 1
    assert "missing" in next(unconfirmed_twist(twist, None))
    assert "symmetry" in next(unconfirmed_twist(replace(twist, odd=True), twist))
    assert "symmetry" in next(unconfirmed_twist(twist, replace(twist, odd=True)))
    assert list(unconfirmed_twist(None, twist)) == []
    assert not list(CURVE.unconfirmed(result, result, "p"))
    (found,) = CURVE.unconfirmed(replace(result, stability=None), result, "p")
    assert "without the functions of stability" in str(found)


# Lists of functions that are made up


def through(points: list[float], sign: int = 1, power: int = 1) -> list[Fraction]:
    """Coefficients of a polynomial in tau with zeros at these points."""
    found = [Fraction(sign)]
    for point in points:
        for _ in range(power):
            zero = Fraction(point)
            found = [a - zero * b for a, b in zip([Fraction(0), *found], [*found, Fraction(0)], strict=True)]
    return found


def stored(coefficients: list[Fraction], error: float = 1e-9) -> dict[str, Any]:
    return dict(to_json(StoredFunction(tuple(coefficients), Fraction(error))))


def made_up(
    points: tuple[list[float], list[float]], signs: tuple[int, int] = (1, 1), error: float = 1e-9, fourth: int = 1
) -> Results:
    """The family with these zeros of Theta on its two pieces, by tau."""
    found = results()
    for result, row, sign in zip(found, points, signs, strict=True):
        function = stored(through(row, sign), error)
        more = stored([Fraction(fourth)])
        result["twist"] = {"twist": function, "exchanged": function, "fourth": more, "defect": stored([])}
    return found


def of_beta(number: int, beta: float) -> float:
    """tau on a piece."""
    piece = atlas().curve_pieces()[number]
    return (beta - float(piece.centre[0])) / float(piece.half_width) * 32 / 33


def said(found: Results) -> dict[str, Any]:
    conclusion = with_lasting(atlas(), found)
    assert conclusion["verdict"] == "proved", conclusion["reason"]
    lasting: dict[str, Any] = conclusion["complete"]["lasting"]
    return lasting


def near(entry: dict[str, Any]) -> int:
    return round(float(ball_from_json(entry["level"]).mid()))


@pytest.mark.parametrize("seed", range(12))
def test_every_twistless_orbit_is_listed_once_and_only_where_orbits_are_elliptic(seed: int) -> None:
    """Zeros at random, on both sides of the doubling at 340, of 1:3 at 453 and of 1:4 at 680."""
    source = random.Random(seed)
    first = sorted(source.sample([270.0, 300.0, 330.0, 350.0, 357.0, 380.0, 405.0], source.randint(0, 3)))
    second = sorted(source.sample([440.0, 447.0, 470.0, 555.0, 640.0, 689.0], source.randint(0, 4)))
    signs = source.choice((1, -1)), source.choice((1, -1))
    points = [of_beta(0, beta) for beta in first], [of_beta(1, beta) for beta in second]
    # Where both pieces know the family they have the same sign.
    if sign_at(points[0], signs[0], of_beta(0, 417.0)) != sign_at(points[1], signs[1], of_beta(1, 417.0)):
        signs = signs[0], -signs[1]
    lasting = said(made_up(points, signs))
    assert lasting["gaps"] == lasting["undecided"] == []
    twistless = [near(entry) for entry in lasting["exceptions"] if entry["kind"] == "twistless"]
    assert twistless == [beta for beta in (*first, *second) if beta > 341]
    resonances = [entry["k"] for entry in lasting["exceptions"] if entry["kind"] != "twistless"]
    assert resonances == [2, 3, 4]
    bounds = sorted([340.1875, 453.4426, 679.954, *twistless, 698.646])
    assert len(lasting["stable"]) == len(bounds) - 1
    for entry, low, high in zip(lasting["stable"], bounds, bounds[1:], strict=False):
        middle = (low + high) / 2
        number = 0 if middle < 417 else 1
        above = sign_at(points[number], signs[number], of_beta(number, middle)) * (1 if middle > 453.4426 else -1)
        assert entry["twist"] == ("positive" if above > 0 else "negative")


def sign_at(points: list[float], sign: int, tau: float) -> int:
    for point in points:
        sign *= 1 if tau > point else -1
    return sign


def test_what_is_not_decided_is_a_gap_and_is_not_stable() -> None:
    at = of_beta(1, 555.0)
    # A double zero, a pair closer than the bounds, functions that are not known.
    for row, error in (([at, at], 1e-9), ([at, at + 1e-4], 1e-3)):
        lasting = said(made_up(([], row), error=error))
        assert len(lasting["gaps"]) == 1
        assert len(lasting["undecided"]) == 1
        assert not [entry for entry in lasting["exceptions"] if entry["kind"] == "twistless"]
        assert len(lasting["stable"]) == 4
    missing = made_up(([], []))
    missing[1]["twist"] = {"reason": {"condition": "stability", "message": "no", "remedy": ""}}
    lasting = said(missing)
    assert [gap["piece"] for gap in lasting["gaps"]] == ["p015"]
    # Up to where the pieces meet the orbits are stable; beyond it nothing is known.
    assert len(lasting["stable"]) == 1
    assert lasting["undecided"]
    assert {entry["fate"] for entry in lasting["exceptions"]} == {"open"}
    assert "but for the places named below" in with_lasting(atlas(), missing)["statement"].lower()


def test_where_one_form_has_a_zero_of_order_3_the_other_decides() -> None:
    doubling = of_beta(0, 340.187535)
    found = made_up(([], []))
    found[0]["twist"]["twist"] = stored(through([doubling], 1, 3), 1e-6)
    assert said(found)["gaps"] == []
    found[0]["twist"]["exchanged"] = stored(through([doubling], 1, 3), 1e-6)
    assert said(found)["gaps"]
    # The other one may have zeros where this one is not decided.
    found[0]["twist"]["twist"] = stored([Fraction(0)], 1.0)
    found[0]["twist"]["exchanged"] = stored(through([of_beta(0, 350.0)]))
    lasting = said(found)
    assert [near(entry) for entry in lasting["exceptions"] if entry["kind"] == "twistless"] == [350]


def test_a_zero_next_to_a_resonance_is_not_told_from_it() -> None:
    doubling = ball_from_json(said(made_up(([], [])))["exceptions"][0]["s"])
    tau = float(doubling.mid()) * 32 / 33
    lasting = said(made_up(([tau], [])))
    assert lasting["undecided"]
    assert len(lasting["stable"]) == 3
    assert "twistless" not in [entry["kind"] for entry in lasting["exceptions"]]
    # Also one that is known better than the resonance.
    assert said(made_up(([tau], []), error=1e-60))["gaps"]
    third = ball_from_json(said(made_up(([], [])))["exceptions"][1]["s"])
    lasting = said(made_up(([], [float(third.mid()) * 32 / 33])))
    assert lasting["undecided"]
    assert [entry["fate"] for entry in lasting["exceptions"] if entry["k"] == 3] == ["open"]
    # There Theta may be 1 + 2 c_1 times a function without zeros: that the twist is 0 is not shown.
    assert "twistless" not in [entry["kind"] for entry in lasting["exceptions"]]
    assert [gap["reason"] for gap in lasting["gaps"]] == ["the twist may vanish next to a resonance"]


def test_where_linear_stability_is_not_decided_the_zeros_are_looked_for_as_well(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An orbit may be elliptic for certain between places of which that was not decided."""
    decided = fates.stable_intervals
    monkeypatch.setattr(fates, "stable_intervals", lambda *known: ([], decided(*known)[0]))
    lasting = said(made_up(([], [of_beta(1, 555.0)])))
    assert [near(entry) for entry in lasting["exceptions"] if entry["kind"] == "twistless"] == [555]
    assert len(lasting["stable"]) == 4


def test_orbits_are_stable_among_states_whose_further_coordinates_are_functions_of_the_others() -> None:
    system = atlas().system
    further = replace(
        system,
        state=(*system.state, "sine"),
        reversing_symmetry=(*system.reversing_symmetry, 1),
        defined=(Defined("sine", "sin", lambda state, _: (state[1],)),),
    )
    known: Any = values(results())
    found: Any = conclude_lasting(
        atlas(), known, conclude_list(atlas(), known, conclude(atlas(), results()), 4)
    ).outcome
    theorem = replace(found.theorem, curve=replace(found.theorem.curve, atlas=replace(atlas(), system=further)))
    assert "in the system with the states (x, y, z), at the value of beta" in lasting_in_words(theorem, found.results)


def test_a_shorter_list_of_a_curve_whose_twist_is_known_is_that_list() -> None:
    found = conclusion_of(atlas(), values(results()), (), lambda _: (), 3)
    assert found["verdict"] == "proved"
    assert "lasting" not in found["complete"]
    assert "lasting" in conclusion_of(atlas(), values(results()), (), lambda _: (), 4)["complete"]


def test_stability_may_change_where_a_resonance_up_to_4_or_the_twist_is_open() -> None:
    open_places = [Resonance(k, 1) for k in (1, 2, 3, 4, 5)] + [*Matter]
    assert [_may_end(subject) for subject in open_places[:5]] == [True, True, True, True, False]
    assert {subject for subject in Matter if not _may_end(subject)} == {Matter.EXTREMA, Matter.COMBINATIONS}


def test_at_1_4_the_larger_one_of_resonant_term_and_twist_decides() -> None:
    for fourth, fate, words in (
        (1, "unstable", "unstable"),
        (-1, "stable", "stable for ever"),
        (0, "open", "not said"),
    ):
        conclusion = with_lasting(atlas(), made_up(([], []), fourth=fourth))
        exceptions = conclusion["complete"]["lasting"]["exceptions"]
        assert [(entry["k"], entry["fate"]) for entry in exceptions] == [(2, "open"), (3, "unstable"), (4, fate)]
        line = [line for line in conclusion["statement"].splitlines() if line.startswith("- 1:4")][-1]
        assert line.endswith(words)


def test_the_twist_is_open_where_it_is_not_decided_between_elliptic_orbits() -> None:
    first, second = atlas().curve_pieces()

    def open_on(piece: Any, entry: dict[str, Any]) -> str:
        found: Any = value_of(entry)
        return twist_open_on(piece, found)

    true = made_up(([], []))
    assert open_on(first, true[0]) == open_on(second, true[1]) == ""
    assert open_on(second, made_up(([], [0.1]))[1]) == ""
    # An orbit without twist has to be known well enough for a closer look.
    assert open_on(second, made_up(([], [0.1]), error=1.8e-2)[1]) == "zeros"
    # A closer look may part two zeros, or more precision if they are not told apart on a longer interval.
    assert open_on(second, made_up(([], [0.1, 0.1]))[1]) == ""
    assert open_on(second, made_up(([], [0.1, 0.1]), error=1e-3)[1]) == "zeros"
    # Where the bound is as large as the function, a shorter interval does more.
    assert open_on(second, made_up(([], []), error=2.0)[1]) == "stability"
    assert open_on(first, made_up(([-0.5, -0.5], []))[0]) == ""
    assert open_on(second, without_twist(true[1])) == "stability"


def test_exceptions_that_are_known_roughly_are_looked_at_closer() -> None:
    def looks(number: int, entry: dict[str, Any]) -> list[tuple[float, float]]:
        found: Any = value_of(entry)
        low, high = found.interval
        middle, radius = (low + high) / 2, (high - low) / 2 * Fraction(33, 32)
        intervals = exceptions_to_sharpen(atlas().curve_pieces()[number], found)
        assert all(low <= first < last <= high for first, last in intervals)
        return [(float((first - middle) / radius), float((last - middle) / radius)) for first, last in intervals]

    def about(place: float, found: list[tuple[float, float]]) -> list[float]:
        return [high - low for low, high in found if low < place - 1e-5 < place + 1e-5 < high]

    third, fourth = of_beta(1, 453.442587), of_beta(1, 679.954155)
    for error, is_looked_at in ((3e-2, False), (1e-6, True), (1e-15, False)):
        widths = about(0.1, looks(1, made_up(([], [0.1]), error=error)[1]))
        assert [width < 1e-3 for width in widths] == [True] * is_looked_at
    (width,) = about(0.1, looks(1, made_up(([], [0.1, 0.1]), error=1e-9)[1]))
    assert width < 1e-3
    assert looks(1, made_up(([], [0.1, 0.1]), error=1e-3)[1]) == looks(1, made_up(([], []))[1])
    # A resonance 1:3 or 1:4 is looked at if its place is known to some digits; 1:2 and unstable orbits are not.
    blurred = made_up(([-0.9], []))
    for result in blurred:
        for function in result["stability"]["characteristic"]:
            function["error"] = format_exact(Fraction(1, 2**16))
    found = looks(1, blurred[1])
    assert [len(about(place, found)) for place in (third, fourth)] == [1, 1]
    assert len(found) == 2
    assert looks(0, blurred[0]) == looks(0, without_twist(blurred[0])) == []


def test_a_closer_look_goes_no_farther_than_it_decides() -> None:
    """Of distant retrograde orbits of the Moon: what is known of the one without twist on three intervals about it.

    One closer look goes as far as the first result asks for, one four times as far, where few powers decide nothing.
    """
    stored = json.loads((DATA / "twistless-retrograde.json").read_text())
    piece: Any = piece_from_json(stored["piece"], CR3BP_PLANAR, "piece")
    results: list[Any] = values(stored["results"])
    wide, too_far, look = results
    assert [twist_open_on(piece, result) for result in results] == ["", "stability", ""]
    assert exceptions_to_sharpen(piece, wide) == [look.interval]
    with ctx.workprec(PRECISION):
        (first,), (closer,) = (
            zeros_on(each.twist.twist.enclosed, -1 / REACH, 1 / REACH).zeros for each in (wide, look)
        )
        assert first.place.rad() > 1e4 * closer.place.rad()
    low, high = too_far.interval
    assert (high - low) / (look.interval[1] - look.interval[0]) == 4


def without_twist(entry: dict[str, Any]) -> dict[str, Any]:
    return {**entry, "twist": {"reason": {"condition": "x", "message": "y", "remedy": ""}}}


def test_no_twist_is_asked_for_where_all_orbits_are_unstable() -> None:
    first = values(results())[0]
    parameter = StoredFunction((Fraction(-2),), Fraction(1, 2))
    assert isinstance(first.stability, StabilityFunctions)
    unstable = replace(first.stability, characteristic=(parameter,))
    touching = replace(first.stability, characteristic=(replace(parameter, error=Fraction(1)),))
    assert not may_be_stable(unstable)
    assert may_be_stable(touching)
    assert may_be_stable(first.stability)
    # Nothing is followed: there is nothing else in it.
    tube = cast(Any, SimpleNamespace(system=atlas().system))
    found = twist_of_piece(tube, None, None, unstable)
    assert isinstance(found, NotKnown)
    piece = atlas().curve_pieces()[0]
    assert twist_open_on(piece, replace(first, stability=unstable, twist=found)) == ""
    assert twist_open_on(piece, replace(first, stability=touching, twist=found)) == "stability"


def test_how_far_what_reversibility_makes_zero_is_enclosed_with_zero_is_told() -> None:
    found = made_up(([], []))
    found[0]["twist"]["defect"] = stored([Fraction(1, 4)], 0.5)
    found[1]["twist"]["defect"] = stored([Fraction(1, 4)], 4.0)
    told = said(found)["reversibility"]
    # Theta is 1 on both: a bound of 4 says nothing of it.
    assert (told["intervals"], told["sharp"]) == (2, 1)
    assert [float(ball_from_json(told[name]).mid()) for name in ("known_part", "bound")] == pytest.approx([0.5, 0.5])
    text = with_lasting(atlas(), found)["statement"]
    assert "is at most 0.50 of the bound of what is not, and, on 1 of them, this bound at most 0.51 of" in text
    assert "on 1 the bound is larger" in text
    # Of bounds that say something the larger one is told.
    found[1]["twist"]["defect"] = stored([Fraction(1, 16)], 0.25)
    told = said(found)["reversibility"]
    assert told["sharp"] == 2
    assert float(ball_from_json(told["bound"]).mid()) == pytest.approx(0.5)
    true = said(results())["reversibility"]
    assert (true["intervals"], true["sharp"]) == (2, 2)
    assert float(ball_from_json(true["known_part"]).mid()) < 1e-3
    assert float(ball_from_json(true["bound"]).mid()) < 0.1


def test_where_what_reversibility_makes_zero_is_not_nothing_is_proved() -> None:
    for coefficient, error, verdict in ((1, 1.0, "proved"), (1, 0.99, "not proved"), (0, 0.0, "proved")):
        found = made_up(([], []))
        found[1]["twist"]["defect"] = stored([Fraction(0), Fraction(coefficient)], error)
        conclusion = with_lasting(atlas(), found)
        assert conclusion["verdict"] == verdict
    assert "an enclosure is wrong" in with_lasting(atlas(), wrong_by_one())["reason"]["message"]


def wrong_by_one() -> Results:
    found = results()
    found[0]["twist"]["defect"]["coefficients"][0] = "0x1p6"
    return found


# What is refused


@cache
def document() -> str:
    with ctx.workprec(160):
        return json.dumps(make_atlas_certificate(atlas(), values(results()), listed()))


def odd(entry: dict[str, Any]) -> None:
    for result in entry["results"]:
        result["twist"]["odd"] = True


def test_functions_that_are_not_found_again_are_found_out() -> None:
    """Level 3: an integration that finds what is true."""
    entry = json.loads(document())
    true = results()
    for result in true:
        for function in (*result["twist"].values(), *halved(result)):
            function["error"] = format_exact(parse_exact(function["error"]) / 4)
    assert checked(entry, honest(true)).stands
    moved = results()
    coefficients = moved[1]["twist"]["twist"]["coefficients"]
    coefficients[0] = format_exact(parse_exact(coefficients[0]) + parse_exact("0x1p4"))
    other = make_atlas_certificate(atlas(), values(moved), with_lasting(atlas(), moved))
    found = checked(other, honest(true))
    assert not found.stands
    assert "function twist of the twist" in found.findings[0].message


def test_the_twist_is_integrated_again_where_it_is_stored() -> None:
    entry, asked = json.loads(document()), []

    def prover(argument: Any, report: Any) -> Any:
        asked.append(argument.get("lasting", False))
        return honest(results())(argument, report)

    without = results()
    del without[1]["twist"]
    checked(entry, prover)
    checked(make_atlas_certificate(atlas(), values(without), with_lasting(atlas(), without)), prover)
    assert asked[:2] == [True, True]
    assert set(asked[-2:]) == {True, False}


def halved(result: dict[str, Any]) -> Any:
    known = result["stability"]
    return (*known["characteristic"], known["level"], known["half_period"], known["first_factor"])


def test_nothing_is_said_of_other_systems_and_of_shorter_lists() -> None:
    assert is_known_of(atlas().system)
    for system in (CR3BP, CR3BP_AXIAL, HILL, *AROUND.values()):
        assert not is_known_of(system)
    short = with_lasting(atlas(), results(), 3)
    assert short["verdict"] == "not proved"
    assert short["reason"]["condition"] == "lasting"
    system = line(1, 2, True)
    spatial = system.atlas(6)
    entries = closed_results(system, spatial)
    entries[0]["twist"] = results()[0]["twist"]
    found = with_lasting(spatial, entries)
    assert found["verdict"] == "not proved"
    assert found["reason"]["condition"] == "lasting"


def test_it_is_asked_for_with_a_long_enough_list_of_a_system_with_n_1() -> None:
    assert limits_of(atlas(), 4, lasting=True).lasting
    for order in (None, 3):
        with pytest.raises(InputError, match="complete"):
            limits_of(atlas(), order, lasting=True)
    with pytest.raises(InputError, match="leave it out"):
        limits_of(replace(atlas(), system=CR3BP), 4, lasting=True)


def test_where_it_is_wanted_only_results_with_the_twist_are_kept() -> None:
    entries = results()
    del entries[0]["twist"]
    before = Certificate(make_atlas_certificate(atlas(), values(entries), None))
    for asked, kept in (({}, 2), ({"stability": True}, 2), ({"stability": True, "lasting": True}, 1)):
        assert len(reusable(before, atlas(), (), **asked)) == kept


def test_a_list_with_a_gap_of_the_twist_leaves_something_out() -> None:
    for found, whole in ((results(), True), (made_up(([], []), error=2.0), False)):
        conclusion = with_lasting(atlas(), found)
        certificate = make_atlas_certificate(atlas(), values(found), conclusion)
        assert Certificate(certificate).is_whole is whole


def test_functions_are_those_of_the_interval_of_a_segment_and_mirrored_on_the_other_side() -> None:
    entry = made_up(([], [0.25]))[1]
    entry["twist"]["fourth"] = stored([Fraction(0), Fraction(1)])
    known: Any = value_of(entry)
    result = replace(known, interval=(Fraction(1, 4), Fraction(3, 4)))

    def found(middle: float, radius: float, symmetric: bool) -> Any:
        tube = SimpleNamespace(piece=SimpleNamespace(id=result.piece), is_symmetric=symmetric)
        segment = SimpleNamespace(middle=Fraction(middle), radius=Fraction(radius) * Fraction(33, 32))
        return _twist_on(cast(Any, segment), cast(Any, SimpleNamespace(tube=tube)), [result])

    assert found(0.5, 0.25, False).sign(arb(0.9)) == 1
    for other in ((0.5, 0.5, False), (0.25, 0.25, False), (-0.5, 0.25, False)):
        assert found(*other) is None
    mirrored = found(-0.5, 0.25, True)
    assert mirrored.sign(arb(-0.9)) == 1
    assert mirrored.sign(arb(0.9)) == -1
    assert [float(of.fourth.value(arb(0.5)).mid()) for of in (found(0.5, 0.25, True), mirrored)] == [0.5, -0.5]
