"""Periodic orbits without symmetry: found, corrected, refined; closed forms and published periods."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from math import exp, pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.periodic_cases import HOPF
from support.refusals import refused

from orbitproof import explore
from orbitproof.explore.__main__ import main
from orbitproof.explore.periodic import (
    AffineSection,
    ClosedOrbit,
    FoundOrbit,
    PeriodicFailure,
    PeriodicProblem,
    PeriodicRequest,
    correct,
    described,
    find_periodic,
    map_derivative,
    refined,
    remarks,
    search,
    sections,
)
from orbitproof.explore.periodic.bifurcations import digits_of_box
from orbitproof.explore.periodic.flow import growth_of_bounds, stretching
from orbitproof.explore.periodic.nearly import equilibrium_of
from orbitproof.explore.periodic.refinement import box_exponent, digits_of_centre
from orbitproof.explore.refinement import RefinementFailure
from orbitproof.shared.formats import define_system, read_claims
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.flow import LEAST_ERROR

LORENZ = """\
name = "lorenz"
state = "x y z"
parameters = "sigma rho beta"

def field(x, y, z, sigma, rho, beta):
    return sigma * (y - x), rho * x - y - x * z, x * y - beta * z
"""

HOPF_FILE = """\
name = "hopf"
state = "x y w"
parameters = "c"

def field(x, y, w, c):
    s = 1 - x * x - y * y
    return x * s - y, x + y * s, -c * w
"""

OSCILLATORS = define_system(
    {
        "name": "oscillators",
        "state": "x y u v",
        "field": {"x": "y", "y": "-x", "u": "v", "v": "-2*u"},
        "first_integral": "x**2 + y**2 + 2*u**2 + v**2",
    }
)


def _nothing(message: str, fraction: float | None) -> None:
    """No progress is shown."""


def test_a_limit_cycle_has_its_period_and_multipliers() -> None:
    problem = PeriodicProblem(HOPF, {"c": Fraction(1, 4)})
    orbit = correct(problem, [1.1, 0.1, 0.05], 6.0)
    assert orbit.period == pytest.approx(2 * pi, abs=1e-10)
    assert orbit.multipliers == pytest.approx([exp(-pi / 2), exp(-4 * pi)], abs=1e-9)


def test_an_orbit_that_is_run_through_twice_is_found_once() -> None:
    orbit = correct(PeriodicProblem(HOPF, {"c": Fraction(1, 4)}), [1.0, 0.0, 0.0], 4 * pi)
    assert orbit.period == pytest.approx(2 * pi, abs=1e-10)


def test_a_guess_that_goes_round_twice_or_lies_far_away_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "hopf.py"
    path.write_text(HOPF_FILE)
    words = ["periodic", "--system", str(path), "--parameter", "c=1/4", "--start"]
    assert main([*words, "x=1.1", "y=0", "w=0", "--period", "12.5"]) == 0
    said = capsys.readouterr()
    assert "the period given is 2 times that of the orbit" in said.err
    assert "away from the guess" in said.err
    assert main([*words, "x=1", "y=0", "w=0", "--period", "6.3"]) == 0
    assert "the guess" not in capsys.readouterr().err


def test_an_equilibrium_is_no_orbit() -> None:
    with pytest.raises(PeriodicFailure):
        correct(PeriodicProblem(HOPF, {"c": Fraction(1, 4)}), [0.0, 0.0, 0.0], 6.0)


def test_with_a_first_integral_the_orbit_is_on_the_level_of_the_guess() -> None:
    problem = PeriodicProblem(OSCILLATORS, {})
    orbit = correct(problem, [1.0, 0.0, 0.01, 0.0], 6.2)
    assert orbit.level == pytest.approx(1.0002, abs=1e-9)
    angle = np.arccos(np.cos(2 * pi * 2**0.5))
    found = sorted(orbit.multipliers, key=lambda value: value.imag)
    assert found == pytest.approx([np.exp(-1j * angle), np.exp(1j * angle)], abs=1e-9)


def test_the_derivative_of_the_return_map_has_the_multipliers() -> None:
    section = AffineSection((Fraction(1), Fraction(2), Fraction(0)), Fraction(0), 1)
    orbit = correct(PeriodicProblem(HOPF, {"c": Fraction(1, 4)}), [1.0, -0.5, 0.0], 6.2, section)
    found = np.linalg.eigvals(map_derivative(section, orbit.arc.by_state, orbit.arc.velocity))
    assert sorted(found.real, reverse=True) == pytest.approx(orbit.multipliers.real, abs=1e-9)


def test_orbits_are_found_by_following_until_they_repeat_and_refined() -> None:
    request = PeriodicRequest(HOPF, {"c": Fraction(1, 4)}, (0.3, 0.2, 0.1), transient=20.0, followed=30.0)
    (found,) = find_periodic(request, _nothing)
    assert found.crossings == 1
    claim = refined(found, "cycle", 40)
    assert claim.offset == sum(a * x for a, x in zip(claim.normal, claim.centre, strict=True))
    x, y, w = claim.centre
    assert abs(x * x + y * y - 1) < Fraction(1, 10**38)
    assert abs(w) < Fraction(1, 10**38)


def test_published_orbits_of_lorenz_are_found_by_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "lorenz.py").write_text(LORENZ)
    claims = tmp_path / "claims.json"
    system = ["--system", str(tmp_path / "lorenz.py"), "--parameter", "sigma=10", "rho=28", "beta=8/3"]
    arguments = ["--start", "x=-2.15", "y=2.08", "z=27", "--period", "1.56", "--section", "z=27", "--direction", "-"]
    assert main(["periodic", *system, *arguments, "--digits", "30", "-o", str(claims), "--quiet"]) == 0
    assert "period 1.5586522107162, 2 crossings" in capsys.readouterr().out
    (claim,) = read_claims(claims)
    assert (claim.kind, claim.crossings, claim.direction) == ("periodic", 2, -1)
    assert claim.centre[2] == 27


def test_orbits_are_found_and_refined_from_python() -> None:
    (found,) = explore.find_periodic(
        HOPF, {"x": 1.1, "y": 0, "w": "0"}, parameters={"c": "1/4"}, period=6.0, quiet=True
    )
    assert found.orbit.period == pytest.approx(2 * pi, abs=1e-10)
    claim = explore.refine_periodic(found, digits=20, name="cycle", quiet=True)
    assert claim.id == "cycle"
    with pytest.raises(ValueError, match="start: w is missing"):
        explore.find_periodic(HOPF, {"x": 1.1, "y": 0}, parameters={"c": "1/4"}, quiet=True)


VAN_DER_POL = define_system(
    {"name": "van-der-pol", "state": "x y", "parameters": "m", "field": {"x": "y", "y": "m*(1 - x**2)*y - x"}}
)


@pytest.mark.parametrize(
    ("stiffness", "least", "times"),
    [(1, 6.6632868593231, 2), (1, 6.6632868593231, 15), (1, 6.6632868593231, 17), (3, 8.859095499693, 5)],
)
def test_the_least_period_is_found_of_any_multiple(stiffness: int, least: float, times: int) -> None:
    parameters = {"m": Fraction(stiffness)}
    request = PeriodicRequest(VAN_DER_POL, parameters, (2.0, 0.0), period=least * times * 1.0005)
    (found,) = find_periodic(request, _nothing)
    assert found.orbit.period == pytest.approx(least, abs=1e-9)
    assert found.crossings == 1
    assert f"the period given is {times} times that of the orbit" in remarks(request, found)[0]


def test_the_least_period_is_found_where_samples_are_few() -> None:
    slow = {"x": "-y + x*(1 - x**2 - y**2)/1000", "y": "x + y*(1 - x**2 - y**2)/1000"}
    problem = PeriodicProblem(define_system({"name": "slow", "state": "x y", "field": slow}), {})
    for times in (61, 100):
        assert correct(problem, [1.001, 0.0], 2.0001 * pi * times).period == pytest.approx(2 * pi, abs=1e-12)


DAMPED = define_system({"name": "damped", "state": "x y", "parameters": "e", "field": {"x": "y", "y": "-x - e*y"}})


@pytest.mark.parametrize("damping", ["1/1000", "1/1000000", "-1/10000000"])
@pytest.mark.parametrize("period", [6.3, None])
def test_spirals_are_no_orbits(damping: str, period: float | None) -> None:
    request = PeriodicRequest(DAMPED, {"e": Fraction(damping)}, (1.0, 0.5), period=period)
    with pytest.raises(PeriodicFailure):
        list(find_periodic(request, _nothing))


@pytest.mark.parametrize("force", ["-x*(x**2)**(-3/2)", "-sqrt(x - 1)", "-1/x", "-log(x)"])
@pytest.mark.parametrize("period", [3.0, None])
def test_a_start_where_the_field_is_not_defined_is_told(force: str, period: float | None) -> None:
    integral = {"first_integral": "y**2/2 - 1/sqrt(x**2)"} if "3/2" in force else {}
    system = define_system({"name": "edge", "state": "x y", "field": {"x": "y", "y": force}, **integral})
    with pytest.raises(PeriodicFailure, match="the formulas of edge have no value at x = 0, y = 1"):
        list(find_periodic(PeriodicRequest(system, {}, (0.0, 1.0), period=period), _nothing))


def test_orbits_are_found_beside_one_that_is_not_claimed(monkeypatch: pytest.MonkeyPatch) -> None:
    request = PeriodicRequest(HOPF, {"c": Fraction(1, 4)}, (1.0, 0.1, 0.0), followed=30.0)
    (found,) = find_periodic(request, _nothing)

    def claimed(problem: PeriodicProblem, orbit: ClosedOrbit | None, *more: object) -> FoundOrbit:
        if orbit is None:
            raise PeriodicFailure("not this one")
        return found

    monkeypatch.setattr(search, "_claimed", claimed)
    for orbits, number in (([None, found.orbit], 1), ([found.orbit, None], 1)):
        monkeypatch.setattr(search, "nearby_orbits", lambda *_, orbits=orbits: iter(orbits))
        assert len(list(find_periodic(request, _nothing))) == number
    monkeypatch.setattr(search, "nearby_orbits", lambda *_: iter([None]))
    with pytest.raises(PeriodicFailure, match="not this one"):
        list(find_periodic(request, _nothing))


def test_orbits_that_were_found_print_as_a_table() -> None:
    found = explore.find_periodic(HOPF, {"x": 1, "y": 0, "w": 0}, parameters={"c": "1/4"}, period=6.3, quiet=True)
    head, line = repr(found).splitlines()
    assert head.split() == ["period", "crossings", "largest", "multiplier", "point"]
    assert line.startswith("[0]  6.283185307  1 ")
    assert repr(found[0]).startswith("period 6.28318530717")
    assert repr(type(found)()) == "no orbits"


def test_of_multipliers_what_is_known_is_told() -> None:
    (found,) = find_periodic(PeriodicRequest(HOPF, {"c": Fraction(5)}, (1.0, 0.1, 0.0), period=6.3), _nothing)
    *_, line = described(found)
    # exp(-4 pi) and exp(-10 pi), which is 2e-14.
    assert line == "  multipliers other than 1: 3.48734e-06, one below 1e-12"


def test_of_a_forced_orbit_it_is_told_how_often_the_force_repeats() -> None:
    driven = define_system({"name": "driven", "state": "x", "field": {"x": "-x + cos(2*t)"}})
    (found,) = find_periodic(PeriodicRequest(driven, {}, (0.2, 1.0, 0.0), period=3.1), _nothing)
    assert "  1 x 2 pi/omega, the period of the force, omega = 2; its multiplier is exp(-pi)" in described(found)


def test_an_orbit_that_nearly_repeats_keeps_its_period() -> None:
    # At c = 2.83 the orbit with two loops has just been born at a period doubling.
    rates = {"x": "-y - z", "y": "x + y/5", "z": "1/5 + z*(x - c)"}
    system = define_system({"name": "roessler", "state": "x y z", "parameters": "c", "field": rates})
    request = PeriodicRequest(system, {"c": Fraction("2.8337")}, (3.0, 0.0, 0.0), transient=2000.0, returns=2)
    periods = sorted(found.orbit.period for found in find_periodic(request, _nothing))
    assert periods[-1] == pytest.approx(2 * periods[0], rel=1e-2)
    assert len(periods) == 2


SWING_ENTRY = {
    "name": "swing", "state": ["x", "y"], "parameters": {"e": [None, None]},
    "field": {"x": "y", "y": "-sin(x) - e*y*(y**2/2 - cos(x))"},
}  # fmt: skip
SWING = define_system(SWING_ENTRY)
"""For e > 0 all orbits with energy below 1, but for the equilibrium, go to y^2/2 = cos(x): period 4 K(1/sqrt 2)."""
CYCLE = 7.41629870920548767


def test_the_only_limit_cycle_of_a_pendulum_is_found_from_given_states(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (followed,) = find_periodic(PeriodicRequest(SWING, {"e": Fraction(1, 10)}, (1.0, 0.0)), _nothing)
    assert followed.orbit.period == pytest.approx(CYCLE, abs=1e-12)
    x, y = followed.orbit.point
    assert y**2 / 2 == pytest.approx(np.cos(x), abs=1e-12)
    # The multiplier is exp(-e int y^2 dt), the integral over half the cycle by quadrature.
    angles = np.linspace(-pi / 2, pi / 2, 200001)
    action = 2 * np.trapezoid(np.sqrt(2 * np.cos(angles)), angles)
    assert followed.orbit.multipliers == pytest.approx([exp(-action / 10)], abs=1e-6)
    path = tmp_path / "swing.json"
    path.write_text(json.dumps({"format": "orbitproof-system", "version": 1, **SWING_ENTRY}))
    words = ["periodic", "--system", str(path), "--parameter", "e=1/10", "--quiet", "--start", "x=2", "y=0"]
    assert main([*words, "--period", "7"]) == 0
    assert "period 7.4162987092055, 1 crossing of" in capsys.readouterr().out
    assert main([*words, "sin_x=1", "cos_x=0"]) == 2
    assert "--start sin_x: there is no such name; there are x, y" in capsys.readouterr().err
    claim = explore.refine_periodic(followed, quiet=True)
    assert claim.coordinates == ("x", "y")
    with mpmath.workdps(50):
        x, y = (mpmath.mpf(value.numerator) / value.denominator for value in claim.centre)
        assert abs(y**2 / 2 - mpmath.cos(x)) < mpmath.mpf(10) ** -45


def test_a_family_of_orbits_of_a_pendulum_is_followed(tmp_path: Path) -> None:
    (found,) = find_periodic(PeriodicRequest(SWING, {"e": Fraction(1, 10)}, (1.5, 0.0), period=7.4), _nothing)
    (family,) = explore.follow_periodic(found, "e", (0.05, 0.2), quiet=True)
    assert [each.orbit.period for each in family.members] == pytest.approx([CYCLE] * len(family.members), abs=1e-9)
    assert not family.bifurcations


def test_a_first_integral_with_functions_has_its_slopes_in_given_states() -> None:
    entry = {"name": "free", "state": "x y", "parameters": "g", "field": {"x": "y", "y": "-g*sin(x)"}}
    system = define_system({**entry, "first_integral": "y**2/2 - g*cos(x)"})
    problem = PeriodicProblem(system, {"g": Fraction(1)})
    by_state, by_parameters = problem.level_slopes(np.array([0.7, 0.3]), problem.values)
    assert [*by_state, *by_parameters] == pytest.approx([np.sin(0.7), 0.3, -np.cos(0.7)], abs=1e-15)
    orbit = correct(problem, [1.5, 0.01], 7.3, level=0.0)
    assert orbit.period == pytest.approx(CYCLE, abs=1e-9)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--start", "x=1", "y=1"], "--start: z is missing"),
        (["--start", "x=1", "y=1", "z=1", "q=1"], "--start q: there is no such name"),
        (["--start", "x=1", "y=1", "z=one"], "--start z one: no number"),
        (["--start", "x=1", "y=1", "z=1", "--section", "z"], "no equation"),
        (["--start", "x=1", "y=1", "z=1", "--section", "x*z=1"], "not linear"),
        (["--start", "x=1", "y=1", "z=1", "--direction", "-"], "belongs to --section"),
        (["--start", "x=1", "y=1", "z=1", "--level", "1"], "has no first integral"),
    ],
)
def test_bad_input_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    (tmp_path / "lorenz.py").write_text(LORENZ)
    system = ["--system", str(tmp_path / "lorenz.py"), "--parameter", "sigma=10", "rho=28", "beta=8/3"]
    assert words in refused(main, ["periodic", *system, *arguments], capsys)


def test_bounds_grow_as_orbits_move_apart_or_by_absolute_values_where_volume_is_preserved() -> None:
    states = np.array([[1.0, 0.0], [0.5, 0.25]])
    turning = define_system({"name": "turning", "state": "x y", "field": {"x": "5*y", "y": "-5*x"}})
    assert growth_of_bounds(turning, states, ()) == pytest.approx(5.0)
    assert stretching(turning, states, ()) == pytest.approx(0.0)
    decay = define_system({"name": "decay", "state": "x y", "field": {"x": "-5*x", "y": "x - 2*y"}})
    assert growth_of_bounds(decay, states, ()) == stretching(decay, states, ()) == 0.0


def test_the_centre_has_digits_for_the_growth_of_bounds() -> None:
    assert digits_of_centre(10.0) < 50 < digits_of_centre(45.0) < digits_of_centre(1e9) <= 200


def bifurcation_in(field: dict[str, str]) -> Any:
    """As much of a bifurcation as the width of its box depends on: neighbours part at the rates of a linear field."""
    system = define_system({"name": "saddle", "state": "x y", "field": field})
    orbit = SimpleNamespace(loop=np.array([[1.0, 0.0], [0.5, 0.25]]), values=(), period=1.0)
    return SimpleNamespace(
        problem=SimpleNamespace(system=system), member=SimpleNamespace(orbit=orbit), parts=1
    )  # fmt: skip


def test_no_box_is_narrower_than_what_the_verifier_bounds() -> None:
    """Derivatives to order 3 over the box of a bifurcation, to order 1 over that of an orbit."""
    narrowest = digits_of_box(bifurcation_in({"x": "30*x", "y": "-30*y"}))
    assert narrowest > digits_of_box(bifurcation_in({"x": "30*x", "y": "-31*y"})) > 30
    assert Fraction(1, 10**narrowest) ** 3 > 1000 * Fraction(LEAST_ERROR)
    assert Fraction(1, 2 ** box_exponent(10**6, 1e9)) > 1000 * Fraction(LEAST_ERROR)
    with pytest.raises(RefinementFailure, match="narrower than the verifier's bounds"):
        digits_of_box(bifurcation_in({"x": "60*x", "y": "-60*y"}))


ENZYME = define_system(
    {
        "name": "enzyme", "state": "s a", "parameters": "S0 A0 AL RH RK",
        "where": {"v": "RH*s*a/(1 + s + RK*s**2)"},
        "field": {"s": "S0 - s - v", "a": "AL*(A0 - a) - v"},
    }
)  # fmt: skip


@pytest.mark.parametrize("start", [(1.0, 500.0), (100.0, 10.0)])
def test_a_stiff_orbit_is_followed_to_where_it_rests(start: tuple[float, float]) -> None:
    # Far from rest an explicit method would take tens of thousands of steps.
    numbers = {"S0": 110, "A0": 500, "AL": Fraction(1, 5), "RH": 13, "RK": Fraction(1, 10)}
    values = {name: Fraction(value) for name, value in numbers.items()}
    with pytest.raises(PeriodicFailure, match="comes to rest at the equilibrium") as failure:
        next(find_periodic(PeriodicRequest(ENZYME, values, start), _nothing))
    found = [float(text) for text in re.findall(r"= ([\d.]+)", str(failure.value))]

    def rates(_time: float, state: np.ndarray) -> np.ndarray:
        s, a = state
        v = 13 * s * a / (1 + s + s**2 / 10)
        return np.array([110 - s - v, (500 - a) / 5 - v])

    other = solve_ivp(rates, (0.0, 100.0), start, method="LSODA", rtol=1e-10, atol=1e-10)
    assert found == pytest.approx(other.y[:, -1], rel=1e-5)
    assert equilibrium_of(other.y.T[:200]) is None


def test_a_section_that_is_nearly_touched_is_taken_last() -> None:
    times = np.linspace(0, 2 * pi, 1001)
    loop = np.column_stack([np.cos(2 * times), np.sin(2 * times), 1e-4 * np.cos(times)])
    velocities = np.column_stack([-2 * np.sin(2 * times), 2 * np.cos(2 * times), -1e-4 * np.sin(times)])
    found = sections(loop, velocities)
    # The last coordinate is crossed once in a period, the others twice.
    assert [each.pivot for each in found[-2:]] == [2, 2]
    assert {each.pivot for each in found[:-2]} == {0, 1}
    assert AffineSection((Fraction(1), Fraction(-2), Fraction(0)), Fraction(1, 2), -1).described("xyz") == (
        "x-2*y=1/2 --direction -"
    )


def test_a_section_that_is_not_crossed_is_refused_with_others_to_try() -> None:
    far = AffineSection((Fraction(1), Fraction(0), Fraction(0)), Fraction(5), 1)
    request = PeriodicRequest(HOPF, {"c": Fraction(1)}, (1.0, 0.0, 0.0), 6.2, far)
    with pytest.raises(PeriodicFailure, match=r"sections that it crosses: [xy]=0"):
        list(find_periodic(request, lambda _text, _done: None))


@pytest.mark.slow
def test_an_orbit_that_no_symmetry_maps_to_itself_is_found_in_a_section_that_is_chosen() -> None:
    state = (
        0.9344801297091027, 0.0, 0.1794590652846985, 0.06389605635644968, 0.08723751109657948, -0.30965735212463297
    )  # fmt: skip
    mass = Fraction(float.fromhex("0x18e267d713713fp-59"))
    request = PeriodicRequest(CR3BP, {"mu": mass}, state, period=2.1685175482660664)
    (found,) = find_periodic(request, lambda _text, _done: None)
    assert found.orbit.period == pytest.approx(2.16851754818262, abs=1e-9)
    assert found.crossings == 1
