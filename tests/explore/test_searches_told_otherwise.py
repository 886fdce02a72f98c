"""Searches in systems that call things as the search does: nothing is taken for another thing of the same name."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import cache
from math import pi, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.metamorphic import Change, changed_system

from orbitproof import explore
from orbitproof.explore.names import told_apart, varied
from orbitproof.explore.periodic import PeriodicFamily, PeriodicProblem
from orbitproof.explore.periodic.continuation import family_csv
from orbitproof.explore.periodic.family import FamilyMember
from orbitproof.explore.periodic.family_file import record_of
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, LEVEL, define_system
from orbitproof.shared.systems import ReversibleSystem, System

QUARTER = define_system(
    {
        "name": "quarter", "state": "w y s q", "parameters": "e", "section": "s", "R": {"s": -1, "q": -1},
        "field": {"w": "-s", "y": "q", "s": "w", "q": "-(e + (w**2 + s**2)/8)*y - y**3"},
        "first_integral": "w**2 + s**2", "first_integral_name": "energy",
    }
)  # fmt: skip
"""y = 0 on the level h: y turns by (e + h/8)^(1/2) times 2 pi in a period of 2 pi."""

TOLD = {
    "plainly": Change("plainly"),
    "otherwise": Change(
        "otherwise",
        {"w": "integral", "y": "level", "s": "period", "q": "t", "e": "half_period"},
        "period",
        shuffle=3,
        factors={"w": Q(-2), "y": Q(1, 2), "s": Q(4), "e": Q(1, 4)},
        time=Q(2),
        level=Q(1, 2),
        unused={"distance": Q(0), "arclength": Q(1)},
    ),
}


@cache
def family(told: str) -> explore.OrbitFamily:
    """The family of w = 1, h from 1/4 to 2."""
    change = TOLD[told]
    assert isinstance(QUARTER, ReversibleSystem)
    system = changed_system(QUARTER, change)
    start = {change.name(name): float(value * change.factor(name)) for name, value in (("w", Q(1)), ("y", Q(0)))}
    numbers = {change.name("e"): Q(1, 20) * change.factor("e"), **change.unused}
    (level,) = told_apart(["integral"], system.centre_coordinates)
    bounds = {level: (float(change.level) / 4, float(change.level) * 2)}
    return explore.trace_from(
        system, start, parameters=numbers, half_period=3.1 * float(change.time), bounds=bounds, quiet=True
    )


@pytest.mark.parametrize("told", TOLD)
def test_resonances_are_where_they_are_whatever_things_are_called(told: str) -> None:
    """1:3 at h = 22/45 and 1:2 at h = 8/5."""
    change, found = TOLD[told], explore.resonances(family(told), (2, 3), quiet=True)
    expected = {3: 22 / 45, 2: 8 / 5}
    assert {each.k for each in found} == {*expected}
    for each in found:
        h, orbit = expected[each.k], each.orbit
        assert orbit.first_integral == pytest.approx(h * float(change.level), rel=1e-9)
        assert orbit.period == pytest.approx(2 * pi * float(change.time), rel=1e-9)
        place = dict(zip(family(told).system.centre_coordinates, each.point, strict=True))
        assert place[change.name("w")] == pytest.approx(sqrt(h) * float(change.factor("w")), rel=1e-9)
        assert place[change.name("y")] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("told", TOLD)
def test_tables_have_a_column_for_everything(told: str, tmp_path: Path) -> None:
    found = family(told)
    orbit, names = found[0], (*found.system.state, *found.system.parameters)
    found.to_csv(tmp_path / "family.csv")
    head, first, *_ = (tmp_path / "family.csv").read_text().splitlines()
    columns = head.split(",")
    assert len({*columns}) == len(columns) == len(found.system.state) + 5
    row = dict(zip(columns, map(float, first.split(",")), strict=True))
    assert [row[name] for name in found.system.state] == orbit.point.tolist()
    rest = ["stability index", "s1", "arclength"]
    values = [orbit.stability_index, orbit.stability[0].real, orbit.arclength]
    ours = dict(list(row.items())[len(found.system.state) :])
    assert [key.strip("()") for key in ours] == ["period", str(found.system.first_integral_name), *rest]
    assert list(ours.values()) == [orbit.period, orbit.first_integral, *values]
    assert not {*ours} & {*names}


def test_what_is_claimed_of_an_orbit_is_what_is_meant() -> None:
    """A coordinate that is called so comes first; the orbit's own quantities are there in parentheses."""
    plain, otherwise = family("plainly")[2], family("otherwise")[2]
    level = Q(otherwise.first_integral or 0)
    asked: list[tuple[Any, str, Q, tuple[str, str | None]]] = [
        (plain, "level", Q(plain.first_integral or 0), (LEVEL, None)),
        (plain, "y", Q(0), (COORDINATE, "y")),
        (otherwise, "level", Q(0), (COORDINATE, "level")),
        (otherwise, "(level)", level, (LEVEL, None)),
        (otherwise, "integral", Q(-1), (COORDINATE, "integral")),
    ]  # fmt: skip
    for orbit, quantity, value, expected in asked:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("orbitproof.explore.values.orbits.refine_orbit", lambda task: task.equation)
            equation: Any = orbit.claim(quantity, value)
        assert (equation.quantity, equation.coordinate) == expected
        assert equation.value == value
    with pytest.raises(ValueError, match=r"there are period, \(level\), level, integral"):
        otherwise.claim("(integral)", 1)
    assert HALF_PERIOD not in {expected[0] for _, _, _, expected in asked}


LEVELS = define_system(
    {
        "name": "levels", "state": "x y z", "parameters": "a level", "field": {"x": "y", "y": "-x", "z": "a*x - z"},
        "first_integral": "x**2 + y**2", "first_integral_name": "a",
    }
)  # fmt: skip


def member(point: list[float]) -> FamilyMember:
    """An orbit of period 2 pi."""
    orbit: Any = SimpleNamespace(point=np.array(point), period=2 * pi, multipliers=(0.5 + 0j,))
    return FamilyMember(orbit, 0.5, np.zeros(1))


def test_a_family_over_levels_is_no_family_in_a_parameter_of_that_name() -> None:
    problem = PeriodicProblem(LEVELS, {"a": Q(1, 2), "level": Q(7)})
    record = record_of(PeriodicFamily(problem, None, (member([1, 0, 0.25]),), (), ""))
    assert record.over_levels
    assert record.name == "a"
    assert dict(record.parameters) == {"a": Q(1, 2), "level": Q(7)}


def test_the_level_and_a_parameter_called_level_are_told_apart() -> None:
    plain: System = define_system({**LEVEL_PLAIN, "parameters": "a"})
    assert [varied(plain, name) for name in ("a", "level", "(level)")] == ["a", None, None]
    assert [varied(LEVELS, name) for name in ("a", "level", "(level)")] == ["a", "level", None]
    with pytest.raises(LookupError, match=r"there are a, level, \(level\)"):
        varied(LEVELS, "b")


LEVEL_PLAIN: dict[str, Any] = {
    "name": "plain", "state": "x y", "field": {"x": "y", "y": "-x"}, "first_integral": "x**2 + y**2",
}  # fmt: skip


def test_heads_of_a_table_of_a_family_are_different() -> None:
    system = define_system(
        {
            "name": "heads", "state": "period multiplier", "parameters": "a",
            "field": {"period": "multiplier", "multiplier": "-a*period"},
        }
    )  # fmt: skip
    found = PeriodicFamily(PeriodicProblem(system, {"a": Q(1)}), "a", (member([1, 0]),), (), "")
    head, first = family_csv(found).splitlines()
    assert head.split(",")[:4] == ["a", "(period)", "period", "multiplier"]
    assert list(map(float, first.split(",")))[:4] == [0.5, 2 * pi, 1, 0]
