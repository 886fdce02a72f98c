"""Families of periodic orbits without symmetry: followed, and their bifurcations found where closed forms have them."""

from __future__ import annotations

from fractions import Fraction
from math import pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from orbitproof.explore.__main__ import main
from orbitproof.explore.periodic import (
    BRANCH,
    DOUBLING,
    FOLD,
    PITCHFORK,
    TORUS,
    PeriodicFamily,
    PeriodicProblem,
    StepControl,
    continue_orbit,
    correct,
    family_described,
    refine_bifurcation,
)
from orbitproof.explore.periodic.continuation import near_rest
from orbitproof.explore.refinement import RefinementFailure
from orbitproof.shared.formats import define_system


def _system(name: str, state: str, field: dict[str, str], **more: Any) -> Any:
    return define_system({"name": name, "state": state, "field": field, **more})


CIRCLE = {"x": "x*s - y", "y": "x + y*s"}
ONE = {"s": "1 - x**2 - y**2"}
TURNING = _system("turning", "x y u v", {**CIRCLE, "u": "a*u - v/3", "v": "u/3 + a*v"}, parameters="a", where=ONE)
TWICE = _system("twice", "x y u v", {**CIRCLE, "u": "a*u - v/2", "v": "u/2 + a*v"}, parameters="a", where=ONE)
"""Circles with the multiplier -exp(2 pi a), twice."""
MIRRORED = _system("pitchfork", "x y w", {**CIRCLE, "w": "a*w - w**3"}, parameters="a", where=ONE)
EXCHANGE = _system("exchange", "x y w", {**CIRCLE, "w": "a*w - w**2"}, parameters="a", where=ONE)
TWO_CYCLES = _system("cycles", "x y", CIRCLE, parameters="a", where={"r": "x**2 + y**2", "s": "a + r - r**2"})
"""Circles with a + r - r^2 = 0, r the square of the radius: a fold at a = -1/4, r = 1/2."""
ROESSLER = _system("roessler", "x y z", {"x": "-y - z", "y": "x + y/5", "z": "1/5 + z*(x - c)"}, parameters="c")
ISOCHRONOUS = _system(
    "isochronous", "x y u v", {"x": "y", "y": "-x", "u": "v", "v": "-2*u"}, first_integral="x**2 + y**2"
)


def _family(
    system: Any, value: str, start: list[float], period: float, bounds: tuple[float, float], **control: Any
) -> PeriodicFamily:
    (name,) = system.parameters
    problem = PeriodicProblem(system, {name: Fraction(value)})
    return continue_orbit(problem, correct(problem, start, period), name, bounds, StepControl(**control))


@pytest.mark.parametrize(("period", "power", "told"), [(20.0, 3, True), (7.0, 3, False), (20.0, 1, False)])
def test_a_family_that_slows_down_close_to_one_place_says_where(period: float, power: int, told: bool) -> None:
    angles = pi * np.linspace(-1, 1, 2001) ** power
    loop = np.column_stack([2 + np.cos(angles), np.sin(angles)])
    first, last = SimpleNamespace(period=6.0), SimpleNamespace(period=period, loop=loop)
    said = near_rest(first, last)  # type: ignore[arg-type]
    assert ("has grown to 20" in said and "near (3, " in said) is told
    assert bool(said) is told


def test_a_pair_that_crosses_the_circle_is_followed_to_it() -> None:
    family = _family(TURNING, "-1/10", [1, 0, 0, 0], 6.3, (-0.11, 0.1))
    (found,) = family.bifurcations
    assert found.kind == TORUS
    assert found.member.value == pytest.approx(0, abs=1e-7)
    assert abs(found.multiplier) == pytest.approx(1, abs=1e-6)
    assert {round(each.orbit.period, 9) for each in family.members} == {round(2 * pi, 9)}


def test_two_multipliers_that_meet_the_circle_at_once_are_told_once_and_are_no_claim() -> None:
    problem, told = PeriodicProblem(TWICE, {"a": Fraction(-1, 10)}), dict[str, float]()
    orbit = correct(problem, [1, 0, 0, 0], 6.3)
    # Each bifurcation is told as it is passed, with the family still to be followed.
    shares = [0.0]

    def note(text: str, share: float | None) -> None:
        shares.append(shares[-1] if share is None else share)
        told.update({text: shares[-1]} if text else {})

    family = continue_orbit(problem, orbit, "a", (-0.11, 0.1), progress=note)
    ((said, share),) = told.items()
    assert said.startswith("period doubling at a = ")
    assert 0.5 < share < shares[-1]
    (found,) = family.bifurcations
    assert (found.kind, found.is_double) == (DOUBLING, True)
    assert found.value == pytest.approx(0, abs=1e-7)
    assert family_described(family)[-1].strip().startswith("two multipliers meet the circle at once")
    with pytest.raises(RefinementFailure, match="claims are of one that meets it alone"):
        refine_bifurcation(found, "twice", 30)


def test_a_multiplier_1_where_the_family_goes_on_is_a_branch_point() -> None:
    family = _family(EXCHANGE, "-1/10", [1, 0, 0], 6.3, (-0.11, 0.1))
    (found,) = family.bifurcations
    assert found.kind == BRANCH
    assert found.member.value == pytest.approx(0, abs=1e-7)
    assert found.symmetry is None


def test_a_branch_point_that_a_symmetry_explains_is_a_pitchfork() -> None:
    family = _family(MIRRORED, "-1/10", [1, 0, 0], 6.3, (-0.11, 0.1))
    (found,) = family.bifurcations
    assert found.kind == PITCHFORK
    assert found.member.value == pytest.approx(0, abs=1e-7)
    assert found.symmetry is not None
    assert found.symmetry.described(("x", "y", "w")) == "(x, y, w) -> (x, y, -w)"
    assert found.parts == 1


def test_a_family_is_followed_through_its_fold() -> None:
    family = _family(TWO_CYCLES, "-1/5", [0.8506, 0], 6.3, (-0.3, 0.0))
    (found,) = family.bifurcations
    assert found.kind == FOLD
    assert found.member.value == pytest.approx(-0.25, abs=1e-7)
    x, y = found.member.orbit.point
    assert x * x + y * y == pytest.approx(0.5, abs=1e-3)
    for each in family.members:
        x, y = each.orbit.point
        r = x * x + y * y
        assert each.value + r - r * r == pytest.approx(0, abs=1e-9)


def test_the_first_period_doubling_of_roessler_is_found() -> None:
    family = _family(ROESSLER, "27/10", [-2.77, -2.77, 0.036], 5.76, (2.6, 3.0))
    (found,) = family.bifurcations
    assert found.kind == DOUBLING
    assert found.member.value == pytest.approx(2.8324450, abs=1e-6)
    assert found.multiplier == pytest.approx(-1, abs=1e-6)


def test_a_family_over_the_levels_of_a_first_integral() -> None:
    problem = PeriodicProblem(ISOCHRONOUS, {})
    family = continue_orbit(problem, correct(problem, [1, 0, 0, 0], 6.28), None, (0.5, 2.0))
    assert family.name == "first integral"
    assert min(each.value for each in family.members) < 0.5
    assert max(each.value for each in family.members) > 2.0
    for each in family.members:
        assert each.orbit.point @ each.orbit.point == pytest.approx(each.value, rel=1e-9)
    assert not family.bifurcations


def test_a_family_is_written_by_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.py").write_text(
        "name = 'pitchfork'\nstate = 'x y w'\nparameters = 'a'\n\n"
        "def field(x, y, w, a):\n    s = 1 - x**2 - y**2\n    return x*s - y, x + y*s, a*w - w**3\n"
    )
    table = tmp_path / "family.csv"
    system = ["--system", str(tmp_path / "mine.py"), "--parameter", "a=-1/10", "--start", "x=1", "y=0", "w=0"]
    assert (
        main(["periodic", *system, "--period", "6.3", "--along", "a", "-0.11", "0.1", "--csv", str(table), "--quiet"])
        == 0
    )
    said = capsys.readouterr().out
    assert "family in a:" in said
    assert "pitchfork: a = " in said
    lines = table.read_text().splitlines()
    assert lines[0] == "a,period,x,y,w,multiplier1 real,multiplier1 imaginary,multiplier2 real,multiplier2 imaginary"
    assert len(lines) > 5
    for words in (["--along", "b", "0", "1"], ["--along", "a", "1", "0"], ["--csv", str(table)]):
        assert main(["periodic", *system, "--period", "6.3", *words]) == 2
        assert capsys.readouterr().err.count("\n") == 1
