"""Axial orbits in units of their speed across the plane: their lists and index, by other ways too, and false ones."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from flint import arb, ctx
from support.conclusions import conclude, with_complete_list
from support.flow_checks import ball
from support.forgeries import checked_by, forged
from support.graph_index import index_of_orbit
from support.stored import function_of, stability_of, values
from support.within import within
from test_lists_of_vertical_orbits import after, motion, sums

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import FOLD, REVERSOR_BREAKING, Atlas
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import atlas_from_json, read_atlas
from orbitproof.shared.systems import LIFTED, VERTICAL
from orbitproof.verify.algebra import Grading, WideArithmetic
from orbitproof.verify.branches import certified_index, conclusion_of, make_atlas_certificate
from orbitproof.verify.certificate import Certificate, recheck
from orbitproof.verify.curve import Bifurcation, HalfReturn, PieceLimits, PlaceOnCurve, prove_piece
from orbitproof.verify.evidence import EmptyIntersectionError, IntegrationFailure, Proved
from orbitproof.verify.functions import REACH
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.run.branch_tasks import RunLimits, attempts_of
from orbitproof.verify.stability import (
    Kind,
    Point,
    TubeOfOrbits,
    about_closer_polynomial,
    complete_list,
    matching,
    stability_of_piece,
    stability_slope_bits,
)
from orbitproof.verify.stability.complete_list import Finder
from orbitproof.verify.stability.confirmation import unconfirmed
from orbitproof.verify.stability.matching import about_the_list, with_certificates
from orbitproof.verify.stability.units import _over, degrees_of, scales
from orbitproof.verify.stability.zeros import Zero

DATA = Path(__file__).parents[1] / "data"
ARC: dict[str, Any] = json.loads((DATA / "axial-arc.json").read_text())
"""Of the family of L1, Earth-Moon, the first quarter from its birth on the planar orbits on."""

_precision = within(lambda: ctx.workprec(192))


@cache
def arc() -> Atlas:
    return atlas_from_json(ARC["atlas"], "the arc")


@cache
def listed() -> dict[str, Any]:
    document = with_complete_list(arc(), ARC["results"], conclude(arc(), ARC["results"]), 12)
    assert document["verdict"] == "proved"
    return document


@cache
def with_list() -> Certificate:
    return Certificate(make_atlas_certificate(arc(), values(ARC["results"]), listed()))


@cache
def family() -> Atlas:
    atlas = read_atlas(DATA / "atlas-axial-family.json")
    assert isinstance(atlas, Atlas)
    return atlas


@cache
def without_list() -> Certificate:
    results = values(json.loads((DATA / "results-axial-family.json").read_text()))
    conclusion = conclusion_of(family(), results, (), lambda _: (), None)
    return Certificate(make_atlas_certificate(family(), results, conclusion))


def place(s: float) -> Any:
    """(eps2, x, vy) by the polynomials of the piece of the arc."""
    (found,) = arc().curve_pieces()
    local = [float(found.half_width) * s, *(np.polyval([float(c) for c in row][::-1], s) for row in found.polynomial)]
    return np.array(found.centre, float) + np.array(found.frame, float) @ local


@pytest.mark.slow
def test_without_a_list_the_index_of_one_orbit_is_told() -> None:
    document = certified_index(without_list())
    assert document["verdict"] == "proved"
    (orbit,) = Certificate(document).orbits
    # Of an orbit of this family the graph of the flow has it.
    assert orbit.index == 4
    theorem = document["statement"]["theorem"]
    assert "the points with eps2 > 0 stand for, over the period 2 T" in theorem
    assert "Single orbits; of others nothing is said:" in theorem

    def check(entry: dict[str, Any]) -> bool:
        return checked_by(entry, without_list(), recheck(without_list())).stands

    def moved(entry: dict[str, Any]) -> None:
        # Where eps2 < 0 there is no orbit.
        entry["orbits"][0]["s"] = "-0x1"

    assert check(document)
    assert not check(forged(document, moved))
    assert not check(forged(document, lambda entry: entry["orbits"][0].update(index=5)))


def at(tau: float) -> float:
    """s of the piece of the arc."""
    (result,) = ARC["results"]
    low, high = (float(parse_exact(end)) for end in result["interval"])
    return (low + high) / 2 + (high - low) / 2 * float(REACH) * tau


@cache
def whole_period(eps2: float, x: float, vy: float, half_period: float) -> tuple[float, Any]:
    """Half the period, and the derivative of the flow of the CR3BP after all of it."""
    mu, vz = float(arc().parameters["mu"]), eps2**0.5

    def start(unknown: Any) -> Any:
        return np.array([unknown[0], 0, 0, 0, unknown[1], vz])

    found, wanted = np.array([x, vy, half_period]), [1, 2, 3]
    for _ in range(3):
        end, turned = after(start(found), found[2], mu)
        rates = motion(0.0, np.concatenate([end, np.eye(6).ravel()]), mu)[:6]
        slopes = np.stack([turned[wanted, 0], turned[wanted, 4], rates[wanted]], axis=1)
        found = found - np.linalg.solve(slopes, end[wanted])
    end, turned = after(start(found), 2 * found[2], mu)
    assert np.abs(end - start(found)).max() < 1e-9
    return float(found[2]), turned


def agrees(stability: dict[str, Any], tau: float) -> bool:
    """Whether stored functions hold what the other integrator finds over the whole period, and closely."""
    half_period = function_of(stability["half_period"]).value(arb(tau))
    time, turned = whole_period(*map(float, place(at(tau))), round(float(half_period.mid()), 6))
    known = [*(function_of(entry).value(arb(tau)) for entry in stability["characteristic"]), half_period]
    wanted = [*sums(turned), time]
    assert all(float(each.rad()) < 1e-4 * abs(value) for each, value in zip(known, wanted, strict=True))
    return all(
        bool((each + arb(0, 1e-7 * abs(value))).contains(arb(value))) for each, value in zip(known, wanted, strict=True)
    )


def test_functions_hold_what_variations_give_over_the_whole_period() -> None:
    (result,) = ARC["results"]
    for tau in (-0.75, 0.125, 0.875):
        assert agrees(result["stability"], tau)
    for number in (0, 1):
        other = copy.deepcopy(result["stability"])
        function = other["characteristic"][number]
        first = parse_exact(function["coefficients"][0])
        function["coefficients"][0] = format_exact(first + max(abs(first) / 1000, 4 * parse_exact(function["error"])))
        assert not agrees(other, 0.125)


def test_where_the_orbits_are_born_the_parameters_are_1_and_that_of_the_planar_orbit() -> None:
    (result,) = ARC["results"]
    (piece,) = arc().curve_pieces()
    # eps2 is centre + half_width s.
    s = -piece.centre[0] / piece.half_width
    start, end = (parse_exact(each) for each in result["interval"])
    tau = (2 * s - start - end) / (end - start) / REACH
    eps2, x, vy = place(float(s))
    assert abs(eps2) < 1e-15
    half_period = float(function_of(result["stability"]["half_period"]).value(ball(tau)).mid())
    _, turned = after(np.array([x, 0, 0, 0, vy, 0]), 2 * half_period, float(arc().parameters["mu"]))
    in_plane, across = turned[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], turned[np.ix_([2, 5], [2, 5])]
    assert np.trace(across) / 2 == pytest.approx(1, abs=1e-7)
    planar = (np.trace(in_plane) - 2) / 2
    a_1, a_2 = (function_of(entry).value(ball(tau)) for entry in result["stability"]["characteristic"])
    assert (a_1 + arb(0, 1e-5)).contains(arb(planar + 1))
    assert (a_2 + arb(0, 1e-5)).contains(arb(planar))


def test_the_list_has_the_birth_and_nothing_else() -> None:
    complete = listed()["complete"]
    assert complete["gaps"] == []
    (birth,) = complete["points"]
    assert (birth["k"], birth["kind"], birth["piece"]) == (1, "birth from the plane", "p001")
    assert abs(float(parse_exact(birth["level"]["mid"]))) < 1e-6
    assert complete["stable"] == complete["undecided"] == []
    said = listed()["statement"].partition("Hypothesis level")[2]
    assert "derivative by eps2 z'^2 on Fix(R) is -1" in said
    assert complete["order"] == 12
    assert "Along the curve the points with an eigenvalue cos(2 pi j/k), k at most 12, are exactly these:\n" in said
    assert "after its period, 2 T" in said
    assert "- eps2 is 0, the planar orbit from which those of the curve are born: a stability parameter is 1" in said
    assert "Points with eps2 < 0 stand for no orbit of the three-body problem.\n" in said
    assert "No orbit of the curve is linearly stable" in said


def test_an_orbit_that_may_be_at_rest_is_no_birth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Finder, "_coordinates", lambda *_: {"vy": arb(0, 1e-3)})
    document = with_complete_list(arc(), ARC["results"], conclude(arc(), ARC["results"]), 2)
    assert [point["kind"] for point in document["complete"]["points"]] == ["undecided"]


@pytest.mark.parametrize(
    ("slope", "offset", "speed", "is_birth"),
    [(1, 0, 2, True), (1, 3, 2, False), (1, -3, 2, False), (-1, 0, 2, False), (1, -1, 2, False), (1, 0, 0.5, False)],
)
def test_only_where_eps2_increases_through_0_and_y_is_crossed_is_the_birth(
    monkeypatch: pytest.MonkeyPatch, slope: int, offset: int, speed: float, is_birth: bool
) -> None:
    size = SimpleNamespace(value=lambda tau: slope * tau + offset)
    finder = Finder(arc(), cast(Any, None), cast(Any, SimpleNamespace(level=size, s_of=lambda tau: tau)))
    monkeypatch.setattr(finder, "_coordinates", lambda s: {"vy": s + arb(speed)})
    zero = Zero(Fraction(-1), Fraction(1), arb(0))
    assert finder._kind(1, zero) is (Kind.IN_PLANE if is_birth else Kind.UNDECIDED)


def test_of_the_piece_of_a_birth_the_list_says_nothing() -> None:
    entries = json.loads((DATA / "results-axial-family.json").read_text())
    found = conclusion_of(family(), values(entries), (), lambda _: (), 2)
    assert "Of the orbits of piece birth, beyond the end of the curve, nothing is said here." in found["statement"]
    assert {gap["piece"] for gap in found["complete"]["gaps"]} == {"p001", "p002", "p003"}


def test_certified_births_are_in_the_list() -> None:
    at_ = ball(Fraction(1, 3))
    entry = Bifurcation("birth", "symmetry_breaking", 1, PlaceOnCurve("p001", at_, False), "", {})
    of_vertical = replace(entry, kind=REVERSOR_BREAKING)
    assert about_the_list(arc(), [entry, of_vertical], 12) == [entry]
    for k, kind, s, holds in (
        (1, Kind.IN_PLANE, at_, True),
        (1, Kind.UNDECIDED, at_, True),
        (1, Kind.LOSS, at_, False),
        (2, Kind.HERE, at_, False),
        (1, Kind.IN_PLANE, at_ + 1, False),
    ):
        points = [Point(0, "p001", k, 1, kind, s, at_, at_, {})]
        if holds:
            assert with_certificates(points, [], [entry])[0].certificates == ("birth",)
        else:
            with pytest.raises(EmptyIntersectionError):
                with_certificates(points, [], [entry])
    birth = [Point(0, "p001", 1, 1, Kind.IN_PLANE, at_, at_, at_, {})]
    with pytest.raises(EmptyIntersectionError):
        with_certificates(birth, [], [replace(entry, kind=FOLD)])


def test_the_index_is_that_of_all_orbits_from_the_birth_on() -> None:
    document = certified_index(with_list())
    assert document["verdict"] == "proved"
    (orbit,) = Certificate(document).orbits
    assert orbit.begin is not None
    assert orbit.end is not None
    assert (orbit.begin.what, orbit.end.what) == (("birth from the plane",), ("the end of the curve",))
    # Close to the birth.
    eps2, x, vy = place(float(orbit.begin.interval[1]) + 0.05)
    assert eps2 > 0
    assert index_of_orbit((x, 0.0, 0.0, 0.0, vy, eps2**0.5), float(arc().parameters["mu"]), 1) == (orbit.index,)

    def before(entry: dict[str, Any]) -> None:
        entry["orbits"][0]["begin"] = {**entry["orbits"][0]["begin"], "interval": ["-0x1", "-0x1"]}

    for change, stands in ((lambda entry: None, True), (before, False)):
        entry = forged(document, change)
        assert checked_by(entry, with_list(), recheck(with_list())).stands is stands


def test_units_of_axial_orbits_leave_the_plane_alone() -> None:
    assert scales(LIFTED)
    assert degrees_of(LIFTED) == {"x": 0, "y": 0, "z": 1, "vx": 0, "vy": 0, "vz": 1, "eps2": -2}
    assert not scales(
        replace(LIFTED, vector_field=lambda state, parameters: LIFTED.vector_field(state[::-1], parameters))
    )
    assert [_over(8.0, -2.0, degree) for degree in (1, 0, -2)] == [-4.0, 8.0, 32.0]


def turned_back(interval: tuple[Fraction, Fraction], coefficients: list[Fraction]) -> tuple[TubeOfOrbits, HalfReturn]:
    """The tube of the piece of the arc with a first return at which each omega is minus this polynomial in sigma."""
    (piece,) = arc().curve_pieces()
    tube = TubeOfOrbits(
        arc().system, arc().parameters, piece, interval, PieceLimits(96, 24, 40), piece.coordinates, ORACLE
    )
    widths = tuple(2 * width for width in piece.tube)
    flow = WideArithmetic(Grading((1, 1), 1), 96, 32, 24, width=40)
    state = [flow.constant(Fraction(1)) for _ in LIFTED.state]
    for j, index in enumerate(LIFTED.kernel_coordinates):
        state[index] = flow.polynomial({(0, 0): coefficients, (int(j == 0), int(j == 1)): Fraction(1)})
    return tube, HalfReturn({}, widths, tuple(state), flow.constant(Fraction(2)), arb(2), 1)


def polynomial_of(tube: TubeOfOrbits, j: int, s: Fraction) -> Fraction:
    return sum((value * s**n for n, value in enumerate(tube.piece.polynomial[j])), Fraction(0))


CHEBYSHEV = [Fraction(int(value)) for value in np.polynomial.chebyshev.cheb2poly([0] * 16 + [1])]
"""Between -1 and 1 on an interval, with coefficients up to 180224."""


@pytest.mark.parametrize("interval", [(Fraction(-1), Fraction(1)), (Fraction(-1), Fraction(1, 32))])
def test_a_closer_tube_is_in_that_of_its_piece_on_the_interval(interval: tuple[Fraction, Fraction]) -> None:
    """The curve may be outside of the tube at complex s; of a half of a piece the interval is that half."""
    low, high = interval
    tube, half = turned_back(interval, [value / 4 for value in CHEBYSHEV])
    with pytest.raises(IntegrationFailure, match="analytic"):
        tube.curve(half)
    closer, known = about_closer_polynomial(tube, half)
    assert known is None
    for j, (width, outer, inner) in enumerate(zip(half.widths, tube.piece.tube, closer.piece.tube, strict=True)):
        # w is twice T.
        assert 0 < inner <= outer / 2
        assert inner > outer / 4
        for number in range(129):
            sigma = (Fraction(number, 64) - 1) * 16 / 17
            s = (low + high) / 2 + (high - low) / 2 * sigma * 17 / 16
            moved = polynomial_of(closer, j, s) - polynomial_of(tube, j, s)
            value = sum((c * sigma**n for n, c in enumerate(CHEBYSHEV)), Fraction(0))
            assert abs(moved + width * value / 4) < Fraction(1, 2**80)
            assert abs(moved) + inner <= outer


@pytest.mark.parametrize("coefficients", [[Fraction(3, 5)], [Fraction(1, 20), Fraction(0)] + [Fraction(3, 5)] * 3])
def test_a_polynomial_that_may_leave_the_tube_of_the_piece_is_not_taken(coefficients: list[Fraction]) -> None:
    tube, half = turned_back((Fraction(-1), Fraction(1)), coefficients)
    assert about_closer_polynomial(tube, half) == (tube, half)


@pytest.mark.parametrize(("system", "is_halved"), [(LIFTED, False), (VERTICAL["L1"], True)])
def test_lists_of_axial_orbits_are_about_the_whole_period(
    monkeypatch: pytest.MonkeyPatch, system: Any, is_halved: bool
) -> None:
    """A certificate for k = 1 is at no point with k = 2; over half the period followed by z -> -z it may be."""
    asked = []
    monkeypatch.setattr(matching, "with_certificates", lambda points, *others: asked.append(others[-1]) or points)
    curve = conclude(arc(), ARC["results"]).outcome.results
    entry = Bifurcation("birth", "symmetry_breaking", 1, None, "", {})
    complete_list.complete_list(replace(arc(), system=system), curve.chain, values(ARC["results"]), 2, [entry])
    assert asked == [is_halved]


def test_lists_of_axial_orbits_are_asked_for_with_more_bits_unless_others_are_given() -> None:
    def bits(**options: Any) -> int:
        return attempts_of(arc(), RunLimits(**options))[0]["precision"]

    assert bits(integrator={}, stability=True) == 108 > bits(integrator={})
    assert bits(integrator={"precision": 88}, stability=True) == 88


@pytest.mark.slow
def test_a_new_integration_confirms_what_is_stored_and_nothing_else() -> None:
    (stored,), (piece,) = ARC["results"], arc().curve_pieces()
    limits = PieceLimits(*(stored["computation"][key] for key in ("precision", "order", "width")))
    proof = prove_piece(
        arc().system, arc().parameters, piece, (Fraction(-1), Fraction(1)), ORACLE, limits,
        slope_bits=stability_slope_bits(limits.precision),
    )  # fmt: skip
    assert isinstance(proof.outcome, Proved)
    known = proof.outcome.results
    tube = TubeOfOrbits(
        arc().system, arc().parameters, piece, (known.start, known.end), limits, piece.coordinates, ORACLE
    )
    closer, half = about_closer_polynomial(tube, known.half_return)
    assert (closer.piece.polynomial, half) != (piece.polynomial, known.half_return)
    for old, new, outer, inner in zip(
        piece.polynomial, closer.piece.polynomial, piece.tube, closer.piece.tube, strict=True
    ):
        # At both ends of the interval, too, the closer tube is in that of the piece.
        for s in (known.start, known.end):
            moved = sum((b * s**n for n, b in enumerate(new)), -sum(a * s**n for n, a in enumerate(old)))
            assert abs(moved) + inner <= outer
    fresh = stability_of_piece(closer, half=half)
    assert agrees(dict(to_json(fresh)), -0.3)
    assert list(unconfirmed(stability_of(stored["stability"]), fresh)) == []
    other = copy.deepcopy(stored["stability"])
    function = other["characteristic"][1]
    moved = parse_exact(function["coefficients"][0]) + 4 * parse_exact(function["error"])
    function["coefficients"][0] = format_exact(moved)
    assert list(unconfirmed(stability_of(other), fresh)) != []
