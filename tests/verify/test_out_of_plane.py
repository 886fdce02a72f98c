"""Variations out of the plane of planar families: compared with the spatial problem, listed, forged."""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from math import cos, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from scipy.integrate import solve_ivp
from support.conclusions import with_complete_list
from support.flow_checks import ball
from support.forgeries import checked, honest
from support.stored import ENTRIES, function_of, values, variations_of
from support.within import within

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import read_atlas
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_PLANAR
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.curve import Bifurcation, PieceLimits, PlaceOnCurve, conclude, derived_parameter
from orbitproof.verify.evidence import EmptyIntersectionError, Proved
from orbitproof.verify.functions import REACH
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.out_of_plane.out_of_plane import with_variations
from orbitproof.verify.stability import TubeOfOrbits, list_across, orbit_functions
from orbitproof.verify.stability.complete_list import complete_list

DATA = Path(__file__).parents[1] / "data"
Results = list[dict[str, Any]]

_precision = within(lambda: ctx.workprec(160))


def atlas() -> Atlas:
    """The planar Lyapunov family of L1, Earth-Moon, one piece."""
    return read_atlas(DATA / "atlas-lyapunov.json")


def results() -> Results:
    found: Results = json.loads((DATA / "stability-lyapunov.json").read_text())
    return found


def place_of(eps: float) -> float:
    """s where the family has this size."""
    (piece,) = atlas().curve_pieces()
    first, second = (float(piece.point(Fraction(s))[0]) for s in (0, 1))
    return (eps - first) / (second - first)


BIRTH = -0.013524226852042805


def half_variation(eps: float, vy: float, mu: float, x_l: float, half_period: float) -> Any:
    """V from the spatial CR3BP, by complex steps in z and vz, by an integrator that knows no enclosures."""
    step = 1e-30
    start = np.zeros((6, 2), complex)
    start[0], start[4] = x_l + eps, eps * vy
    start[2, 0] = start[5, 1] = 1j * step

    def field(_: float, flat: Any) -> Any:
        return np.array(CR3BP.vector_field(list(flat.reshape(6, 2)), [mu])).ravel()

    run = solve_ivp(field, (0, half_period), start.ravel(), "DOP853", rtol=3e-14, atol=1e-20)
    end = run.y[:, -1].reshape(6, 2)
    return end[[2, 5]].imag / step


def check_containment(entry: dict[str, Any], start: Fraction, end: Fraction, shares: list[float]) -> None:
    (piece,) = atlas().curve_pieces()
    known = variations_of(entry["out_of_plane"])
    assert known is not None
    mu = atlas().parameters["mu"]
    x_l = float(derived_parameter(atlas().system, "x_l", atlas().parameters, 80).middle)
    for share in shares:
        s = start + (end - start) * Fraction(share)
        tau = ball((2 * (s - start) / (end - start) - 1) / REACH)
        eps, vy = (float(value) for value in piece.point(s))
        half_period = float(function_of(entry["half_period"]).value(tau).mid())
        expected = half_variation(eps, vy, float(mu), x_l, half_period)
        for enclosed, value in zip(known.entries, expected.ravel(), strict=True):
            assert (enclosed.value(tau) + arb(0, 1e-7)).contains(arb(value))
            assert float(enclosed.value(tau).rad()) < 1e-6
        assert (known.parameter.value(tau) + arb(0, 1e-7)).contains(
            arb(expected[0, 0] * expected[1, 1] + expected[0, 1] * expected[1, 0])
        )


def test_variations_contain_those_of_the_spatial_problem() -> None:
    check_containment(results()[0]["stability"], Fraction(-1), Fraction(1), [0.01, 0.05, 0.3, 0.62, 0.87])


@pytest.mark.slow
def test_an_integration_of_a_part_contains_them_too() -> None:
    interval = (Fraction(1, 2), Fraction(3, 4))
    (piece,) = atlas().curve_pieces()
    limits = PieceLimits(72, 28, 16)
    found = to_json(
        orbit_functions(
            TubeOfOrbits(atlas().system, atlas().parameters, piece, interval, limits, "physical", ORACLE)
        ).stored
    )
    check_containment(found, *interval, [0.1, 0.9])


def test_at_the_libration_point_it_is_that_of_the_linear_frequencies() -> None:
    """s_v = cos(2 pi sqrt(c)/omega) with omega^4 - (2 - c) omega^2 + (1 + 2c)(1 - c) = 0."""
    known = variations_of(results()[0]["stability"]["out_of_plane"])
    assert known is not None
    mu = float(atlas().parameters["mu"])
    x_l = float(derived_parameter(atlas().system, "x_l", atlas().parameters, 80).middle)
    c = (1 - mu) / abs(x_l + mu) ** 3 + mu / abs(x_l + mu - 1) ** 3
    omega = sqrt((2 - c + sqrt(9 * c * c - 8 * c)) / 2)
    value = known.parameter.value(ball(Fraction(place_of(0.0)) / REACH))
    assert abs(float(value) - cos(2 * pi * sqrt(c) / omega)) < 1e-9


def test_the_stiffness_is_that_of_the_three_body_problem() -> None:
    source = np.random.default_rng(5)
    for name, system in AROUND.items():
        assert system.stiffness_across is not None
        mu, x_l = 0.1, {"L1": 0.6, "L2": 1.25, "L3": -1.04}[name]
        for x, y, eps in source.uniform(-0.1, 0.1, (5, 3)):
            (found,) = system.stiffness_across([x, y, 0.3, 0.4], [mu, x_l, eps])
            force = CR3BP.vector_field([x_l + eps * x, eps * y, 1e-30j, 0, 0, 0], [mu])[5]
            assert abs(found + force.imag / 1e-30) < 1e-12 * abs(found)


def test_variations_are_followed_with_the_motion_and_its_integral() -> None:
    """Those of the planar problem, which has a first integral."""
    size = len(CR3BP_PLANAR.state)
    extended = with_variations(CR3BP_PLANAR)
    state, mu = [0.9, 0.2, 0.3, -0.7, 1.1, 1.2, 1.3, 1.4], [0.1]
    assert CR3BP_PLANAR.first_integral is not None
    assert extended.first_integral is not None
    assert CR3BP_PLANAR.stiffness_across is not None
    rates = extended.vector_field(state, mu)
    (g,) = CR3BP_PLANAR.stiffness_across(state, mu)
    assert list(rates[:size]) == list(CR3BP_PLANAR.vector_field(state[:size], mu))
    assert list(rates[size:]) == [1.2, -g * 1.1, 1.4, -g * 1.3]
    assert extended.first_integral(state, mu) == CR3BP_PLANAR.first_integral(state[:size], mu)
    assert extended.first_integral_program is not None
    assert extended.squared_distance_program is None


def listed(found: Results, order: int = 12) -> dict[str, Any]:
    return with_complete_list(atlas(), found, conclude(atlas(), values(found)), order)


def test_the_halo_orbits_are_born_at_exactly_one_point() -> None:
    document = listed(results())
    across = document["complete"]["out_of_plane"]
    (birth,) = across["points"]
    assert birth["kind"] == "birth out of the plane"
    assert birth["level"]["decimal"].startswith("[-0.0135242268")
    assert abs(float(parse_exact(birth["level"]["mid"])) - BIRTH) < 1e-11
    x_l = float(derived_parameter(atlas().system, "x_l", atlas().parameters, 80).middle)
    eps, vy = (float(parse_exact(birth["point"][name]["mid"])) for name in ("eps", "vy"))
    assert CR3BP.first_integral is not None
    (constant,) = CR3BP.first_integral([x_l + eps, 0, 0, 0, eps * vy, 0], [float(atlas().parameters["mu"])])
    assert abs(float(parse_exact(birth["jacobi_constant"]["mid"])) - constant) < 1e-12
    assert "Jacobi constant in [3.174" in document["statement"]
    (stable,) = across["stable"]
    assert stable["from"]["what"] == ["birth out of the plane"]
    assert stable["to"]["what"] == ["the end of the curve"]
    assert across["gaps"] == across["undecided"] == []
    assert (
        "a curve of orbits out of the plane, symmetric under R, begins here: eps in [-0.013524226"
        in document["statement"]
    )
    assert "and no others are:\n- from eps in" in document["statement"]


def test_what_is_not_known_is_named() -> None:
    found = results()
    found[0]["stability"]["out_of_plane"] = {"reason": {"message": "tired"}}
    document = listed(found)
    across = document["complete"]["out_of_plane"]
    assert across["points"] == across["stable"] == []
    assert [gap["about"] for gap in across["gaps"]] == ["everything"]
    assert "Not covered, out of the plane" in document["statement"]


def certified(s: float, kind: str = "symmetry_breaking") -> Bifurcation:
    return Bifurcation("halo", kind, 1, PlaceOnCurve("p001", ball(Fraction(s)), False), "", {})


def test_a_certified_symmetry_breaking_is_the_birth_or_contradicts_the_list() -> None:
    outcome = conclude(atlas(), values(results())).outcome
    assert isinstance(outcome, Proved)
    chain = outcome.results.chain
    plane = complete_list(atlas(), chain, values(results()), 4)
    (birth,) = list_across(atlas(), chain, plane, []).found.points  # type: ignore[union-attr]
    place = float(birth.s.mid())
    (point,) = list_across(atlas(), chain, plane, [certified(place)]).found.points  # type: ignore[union-attr]
    assert point.certificates == ("halo",)
    assert list_across(atlas(), chain, plane, [certified(0.3, "period_tupling")]) is not None
    with pytest.raises(EmptyIntersectionError):
        list_across(atlas(), chain, plane, [certified(place + 1e-3)])


def document_of(found: Results) -> dict[str, Any]:
    return make_atlas_certificate(atlas(), values(found), listed(found, 3))


def axial(entry: dict[str, Any]) -> None:
    entry["conclusion"]["complete"]["out_of_plane"]["points"][0]["kind"] = "axial birth out of the plane"


@pytest.mark.parametrize("name", [None, *ENTRIES])
def test_forged_variations_are_found_by_another_integration(name: str | None) -> None:
    """Also with a list that fits them."""
    fresh = copy.deepcopy(results())
    known = fresh[0]["stability"]
    functions = [known[key] for key in ("level", "half_period", "first_factor")]
    for function in (*functions, *known["characteristic"], *known["out_of_plane"].values()):
        function["error"] = format_exact(parse_exact(function["error"]) / 4)
    stored = results()
    if name is not None:
        coefficients = stored[0]["stability"]["out_of_plane"][name]["coefficients"]
        coefficients[0] = format_exact(parse_exact(coefficients[0]) + Fraction(1, 2**12))
    found = checked(document_of(stored), honest(fresh))
    assert found.stands == (name is None)
    assert name is None or any("out of the plane" in finding.message for finding in found.findings)
