"""Lists of vertical orbits: up to z -> -z, against variations in the CR3BP itself by another integrator."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_poly, ctx
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from support.conclusions import conclude, with_complete_list
from support.flow_checks import ball
from support.stored import function_of, stability_of, values
from support.within import within

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import REVERSOR_BREAKING, Atlas
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import atlas_from_json
from orbitproof.shared.systems import AROUND, CR3BP, LIFTED, VERTICAL
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.branches.index import certified_index
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.curve import Bifurcation, PieceLimits, PlaceOnCurve, prove_piece
from orbitproof.verify.curve.lyapunov_family import libration_point
from orbitproof.verify.evidence import EmptyIntersectionError, IntegrationFailure, Proved, ball_from_json
from orbitproof.verify.functions import REACH, BoundedFunction
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import Kind, Point, TubeOfOrbits, stability_of_piece, stability_slope_bits
from orbitproof.verify.stability.complete_list import Finder, complete_list
from orbitproof.verify.stability.confirmation import unconfirmed
from orbitproof.verify.stability.kinds import Resonance
from orbitproof.verify.stability.list_entries import Gap
from orbitproof.verify.stability.matching import about_the_list, with_certificates
from orbitproof.verify.stability.units import at_other_point, units_of
from orbitproof.verify.stability.zeros import Zero

ARC: dict[str, Any] = json.loads((Path(__file__).parents[1] / "data" / "vertical-arc.json").read_text())
"""The family of L1, Earth-Moon, from rest through the birth of the axial orbits."""

_precision = within(lambda: ctx.workprec(192))


@cache
def arc() -> Atlas:
    return atlas_from_json(ARC["atlas"], "the arc")


@cache
def listed(order: int) -> dict[str, Any]:
    document = with_complete_list(arc(), ARC["results"], conclude(arc(), ARC["results"]), order)
    assert document["verdict"] == "proved"
    return document


def motion(_: float, flat: Any, mu: float) -> Any:
    """The CR3BP with six variations."""
    place, speed, turns = flat[:3], flat[3:6], flat[6:].reshape(6, 6)
    x, y, _z = place
    force, gradient = np.array([x + 2 * speed[1], y - 2 * speed[0], 0]), np.diag([1.0, 1, 0])
    for mass, centre in ((1 - mu, -mu), (mu, 1 - mu)):
        along = place - [centre, 0, 0]
        distance = np.linalg.norm(along)
        force -= mass * along / distance**3
        gradient += mass * (3 * np.outer(along, along) / distance**5 - np.eye(3) / distance**3)
    rate = np.zeros((6, 6))
    rate[:3, 3:], rate[3:, :3], rate[3, 4], rate[4, 3] = np.eye(3), gradient, 2, -2
    return np.concatenate([speed, force, (rate @ turns).ravel()])


def after(start: Any, time: float, mu: float) -> tuple[Any, Any]:
    """The state and the derivative of the flow."""
    flat = np.concatenate([start, np.eye(6).ravel()])
    end = solve_ivp(motion, (0, time), flat, "DOP853", args=(mu,), rtol=1e-13, atol=1e-14).y[:, -1]
    return end[:6], end[6:].reshape(6, 6)


@cache
def orbit(eps2: float, x: float, vy: float, quarter: float) -> tuple[float, Any, Any]:
    """The quarter of the period, and the derivatives after a half followed by z -> -z, and after the whole period."""
    mu, x_l, vz = float(arc().parameters["mu"]), float(libration_point(arc().system, arc().parameters)), eps2**0.5

    def start(unknown: Any) -> Any:
        return np.array([unknown[0], 0, 0, 0, unknown[1], vz])

    def amiss(unknown: Any) -> Any:
        return after(start(unknown), unknown[2], mu)[0][[1, 3, 5]]

    found = fsolve(amiss, [x_l + eps2 * x, eps2 * vy, quarter], xtol=1e-13)
    half, turned = after(start(found), 2 * found[2], mu)
    across = np.diag([1, 1, -1, 1, 1, -1])
    assert np.abs(across @ half - start(found)).max() < 1e-9
    return float(found[2]), across @ turned, after(start(found), 4 * found[2], mu)[1]


def at(result: dict[str, Any], tau: float) -> tuple[tuple[float, ...], float]:
    """(eps2, x, vy) by the polynomials of the piece, and its quarter of the period, to start from."""
    (piece,) = [piece for piece in arc().curve_pieces() if piece.id == result["piece"]]
    low, high = (float(parse_exact(end)) for end in result["interval"])
    s = (low + high) / 2 + (high - low) / 2 * float(REACH) * tau
    local = [float(piece.half_width) * s, *(np.polyval([float(c) for c in row][::-1], s) for row in piece.polynomial)]
    point = np.array(piece.centre, float) + np.array(piece.frame, float) @ local
    return tuple(map(float, point)), float(function_of(result["stability"]["half_period"]).value(arb(tau)).mid())


def sums(matrix: Any) -> tuple[float, float]:
    """The sum and the product of the two stability parameters other than the two that are 1 on any orbit."""
    first = (np.trace(matrix) - 2) / 2
    squares = (np.trace(matrix @ matrix) - 2 + 4) / 4
    return first, (first**2 - squares) / 2


def agrees(result: dict[str, Any], tau: float) -> bool:
    """Whether the stored functions hold what the other integrator finds, also over the whole period, and closely."""
    point, quarter = at(result, tau)
    time, half, whole = orbit(*point, quarter)
    a_1, a_2 = (function_of(entry).value(arb(tau)) for entry in result["stability"]["characteristic"])
    squares = a_1 * a_1 - 2 * a_2
    known = [a_1, a_2, function_of(result["stability"]["half_period"]).value(arb(tau))]
    wanted = [*sums(half), time, *sums(whole)]
    # 2 c^2 - 1 for the whole period.
    known += [2 * squares - 2, 4 * a_2 * a_2 - 2 * squares + 1]
    assert all(float(ball_.rad()) < 1e-2 * abs(value) for ball_, value in zip(known, wanted, strict=True))
    return all(
        bool((ball_ + arb(0, 1e-7 * abs(value))).contains(arb(value)))
        for ball_, value in zip(known, wanted, strict=True)
    )


def test_functions_hold_what_variations_give_over_half_a_period_and_over_the_whole_one() -> None:
    for result in ARC["results"]:
        assert agrees(result, 0.625)
    for number in (0, 1):
        other = copy.deepcopy(ARC["results"][-1])
        function = other["stability"]["characteristic"][number]
        first = parse_exact(function["coefficients"][0])
        function["coefficients"][0] = format_exact(first + max(abs(first) / 1000, 4 * parse_exact(function["error"])))
        assert not agrees(other, 0.625)


def test_at_the_libration_point_the_parameters_are_those_of_its_frequencies() -> None:
    mu, x_l = float(arc().parameters["mu"]), float(libration_point(arc().system, arc().parameters))
    c = (1 - mu) / abs(x_l + mu) ** 3 + mu / abs(x_l + mu - 1) ** 3
    low, high = sorted(np.roots([1, 2 - c, (1 + 2 * c) * (1 - c)]).real)
    first, second = np.cos(np.pi * (-low / c) ** 0.5), np.cosh(np.pi * (high / c) ** 0.5)
    result = ARC["results"][0]
    (piece,) = [piece for piece in arc().curve_pieces() if piece.id == result["piece"]]
    start, end = (parse_exact(end) for end in result["interval"])
    tau = (2 * -piece.centre[0] / piece.half_width - start - end) / (end - start) / REACH
    a_1, a_2 = (function_of(entry).value(ball(tau)) for entry in result["stability"]["characteristic"])
    assert (a_1 + arb(0, 1e-9)).contains(arb(first + second))
    assert (a_2 + arb(0, 1e-9)).contains(arb(first * second))


def test_the_birth_of_the_axial_orbits_is_the_one_point_at_which_the_list_has_two() -> None:
    """A parameter passes -1 there, over half a period followed by z -> -z: over the whole period it touches 1."""
    complete = listed(12)["complete"]
    assert complete["gaps"] == []
    (birth,) = [point for point in complete["points"] if point["k"] <= 2]
    assert (birth["k"], birth["kind"]) == (2, "singular at this point")
    level = float(parse_exact(birth["level"]["mid"]))
    assert level == pytest.approx(ARC["atlas"]["provenance"]["axial_birth"], abs=1e-8)
    known = {name: float(parse_exact(entry["mid"])) for name, entry in birth["point"].items()}
    quarter = float(parse_exact(birth["half_period"]["mid"]))
    signs = []
    for eps2 in (level - 1e-5, level + 1e-5):
        _, half, whole = orbit(eps2, known["x"], known["vy"], quarter)
        total, product = sums(half)
        signs.append(1 + total + product)
        total, product = sums(whole)
        assert abs(1 - total + product) < 1
    assert signs[0] * signs[1] < 0
    # One parameter is above 1 all along, so no orbit is linearly stable.
    assert complete["stable"] == complete["undecided"] == []


def test_the_index_over_the_whole_period_is_told_of_single_orbits_only() -> None:
    document = make_atlas_certificate(arc(), values(ARC["results"]), listed(12))
    found = certified_index(Certificate(document))
    assert found["verdict"] == "proved"
    assert [sorted(entry) for entry in found["orbits"] if "begin" in entry or "end" in entry] == []
    assert len(found["orbits"]) == 1


def test_units_are_those_of_either_end() -> None:
    for system in VERTICAL.values():
        assert units_of(system) == ("w", "u")
        assert at_other_point(system).normalised == {"u": 1, "w": 0}
    assert units_of(AROUND["L1"]) == ("x", "x")
    assert units_of(LIFTED) == ("vz", "vz")
    for other in (replace(LIFTED, title="another"), replace(VERTICAL["L1"], title="another")):
        with pytest.raises(IntegrationFailure):
            units_of(other)


def test_a_certified_loss_of_r_is_at_a_point_at_which_the_square_is_1() -> None:
    at_ = ball(Fraction(1, 3))
    entry = Bifurcation("loss", REVERSOR_BREAKING, 1, PlaceOnCurve("p003", at_, False), "", {})
    tupling = replace(entry, kind="period_tupling", k=2)
    assert about_the_list(arc(), [entry, tupling], 12) == [entry]
    for k, kind, here in (
        (1, Kind.UNDECIDED, True),
        (2, Kind.HERE, True),
        (2, Kind.THERE, True),
        (4, Kind.RESONANCE, False),
    ):
        point = Point(0, "p003", k, 1, kind, at_, at_, at_, {})
        if here:
            assert with_certificates([point], [], [entry], True)[0].certificates == ("loss",)
        else:
            with pytest.raises(EmptyIntersectionError):
                with_certificates([point], [], [entry], True)
    for k, hides in ((1, True), (2, True), (3, False)):
        gap = Gap(0, "p003", Fraction(1, 4), Fraction(1, 2), Resonance(k, 1), "")
        if hides:
            assert with_certificates([], [gap], [entry], True) == ()
        else:
            with pytest.raises(EmptyIntersectionError):
                with_certificates([], [gap], [entry], True)


def test_a_list_takes_certified_losses_of_r_for_square_roots() -> None:
    curve = conclude(arc(), ARC["results"]).outcome
    assert isinstance(curve, Proved)
    (birth,) = [point for point in listed(12)["complete"]["points"] if point["k"] <= 2]
    entry = Bifurcation(
        "loss", REVERSOR_BREAKING, 1, PlaceOnCurve(birth["piece"], ball_from_json(birth["s"]), False), "", {}
    )
    found = complete_list(arc(), curve.results.chain, values(ARC["results"]), 2, [entry])
    assert [point.certificates for point in found.points] == [("loss",)]


def test_of_a_zero_for_k_1_the_kind_is_not_known_along_a_curve_over_the_size_of_its_orbits() -> None:
    extremal: Any = SimpleNamespace(level=BoundedFunction(arb_poly([0, 0, 1]), arb(0)))
    nowhere: Any = None
    zero = Zero(Fraction(-1, 2), Fraction(1, 2), arb(0))
    for system, kind in ((VERTICAL["L1"], Kind.UNDECIDED), (AROUND["L1"], Kind.UNDECIDED), (CR3BP, Kind.FOLD)):
        assert Finder(replace(arc(), system=system), nowhere, extremal)._kind(1, zero) is kind


@pytest.mark.slow
def test_a_new_integration_confirms_what_is_stored_and_nothing_else() -> None:
    stored = ARC["results"][0]
    (piece,) = [piece for piece in arc().curve_pieces() if piece.id == stored["piece"]]
    limits = PieceLimits(*(stored["computation"][key] for key in ("precision", "order", "width")))
    proof = prove_piece(
        arc().system, arc().parameters, piece, (Fraction(-1), Fraction(1)), ORACLE, limits,
        slope_bits=stability_slope_bits(limits.precision),
    )  # fmt: skip
    assert isinstance(proof.outcome, Proved)
    known = proof.outcome.results
    interval = known.start, known.end
    tube = TubeOfOrbits(arc().system, arc().parameters, piece, interval, limits, piece.coordinates, ORACLE)
    fresh = stability_of_piece(tube, half=known.half_return)
    assert agrees({**stored, "stability": to_json(fresh)}, -0.3)
    assert list(unconfirmed(stability_of(stored["stability"]), fresh)) == []
    other = copy.deepcopy(stored["stability"])
    function = other["characteristic"][1]
    moved = parse_exact(function["coefficients"][0]) + 4 * parse_exact(function["error"])
    function["coefficients"][0] = format_exact(moved)
    assert list(unconfirmed(stability_of(other), fresh)) != []
