"""What a search is told on the command line: the same options for each of the example systems."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import pytest

from orbitproof.explore.__main__ import main as explore_main
from orbitproof.explore.records import OrbitRecord, read_families
from orbitproof.shared.formats import read_candidates

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"


class Example(NamedTuple):
    """An orbit of a system, limits about it, and a bifurcation of its family."""

    system: list[str]
    start: list[str]
    limits: dict[str, tuple[float, float]]
    k: int
    point: list[str]


SYSTEMS = {
    "michelson": Example(
        ["michelson.py"],
        ["c=0.22", "y=0.42"],
        {"c": (0.21, 0.23), "half-period": (3.146, 3.15)},
        4,
        ["c=0.22544", "y=0.43305"],
    ),
    "henon-heiles": Example(
        ["henon-heiles.py"],
        ["y=-0.44", "vx=0"],
        {"y": (-0.46, -0.42), "integral": (0.12, 0.13)},
        2,
        ["y=-0.45556542", "vx=0"],
    ),
    "hill": Example(
        ["hill.py"],
        ["x=0.58", "z=0", "vy=0.67"],
        {"x": (0.57, 0.59), "integral": (3.9, 4.1)},
        1,
        ["x=0.58126467", "z=0", "vy=0.67012429"],
    ),
    "beam": Example(
        ["beam.py", "--parameter", "P=7/3"],
        ["u=-0.224", "u2=1.60069"],
        {"u": (-0.25, -0.2), "half-period": (2.05, 2.08)},
        4,
        ["u=-0.223976", "u2=1.600686"],
    ),
}
each_system = pytest.mark.parametrize("name", SYSTEMS)


def run(command: str, name: str, *words: str) -> int:
    file, *fixed = SYSTEMS[name].system
    return explore_main([command, "--system", str(EXAMPLES / file), *fixed, *words, "--quiet"])


def value(name: str, orbit: OrbitRecord, limited: str) -> float:
    if limited == "half-period":
        return orbit.half_period
    if limited == "integral":
        assert orbit.first_integral is not None
        return orbit.first_integral
    words = SYSTEMS[name].start
    return orbit.point[[word.partition("=")[0] for word in words].index(limited)]


@each_system
def test_an_orbit_is_corrected_and_followed_both_ways_from_its_file(name: str, tmp_path: Path) -> None:
    orbit, output = tmp_path / "orbit.json", tmp_path / "family.json"
    assert run("orbit", name, "--start", *SYSTEMS[name].start, "-o", str(orbit)) == 0
    (alone,) = read_families(orbit)
    assert len(alone.orbits) == 1
    for limited, (low, high) in SYSTEMS[name].limits.items():
        limits = ["--parameter-min", limited, str(low), "--parameter-max", limited, str(high)]
        words = ["family", "--from-family", str(orbit), *limits, "--jobs", "1", "--quiet", "-o", str(output)]
        assert explore_main(words) == 0
        (family,) = read_families(output)
        first, *inner, last = (value(name, each, limited) for each in family.orbits)
        assert all(low < each < high for each in inner)
        assert {first < low, last < low} == {first > high, last > high} == {True, False}


@each_system
def test_limits_that_the_first_orbit_has_passed_are_named(name: str, tmp_path: Path) -> None:
    output = tmp_path / "family.json"
    limited, (_, high) = next(iter(SYSTEMS[name].limits.items()))
    beyond = ["--parameter-min", limited, str(high)]
    assert run("family", name, "--start", *SYSTEMS[name].start, *beyond, "--jobs", "1", "-o", str(output)) == 0
    (family,) = read_families(output)
    assert len(family.orbits) == 1
    assert f"limit {limited} = {high}, which its first orbit has passed" in family.reason


@each_system
def test_a_point_is_refined_for_its_own_resonance_alone(name: str, tmp_path: Path) -> None:
    output, example = tmp_path / "candidate.json", SYSTEMS[name]
    assert run("refine", name, "-k", "5", "--point", *example.point, "-o", str(output)) == 1
    assert not output.exists() or not read_candidates(output)
    refine = ["refine", name, "-k", str(example.k), "--digits", "25"]
    assert run(*refine, "--point", *example.point, "-o", str(output)) == 0
    (candidate,) = read_candidates(output)
    given = [float(word.partition("=")[2]) for word in example.point]
    assert [float(each) for each in candidate.centre] == pytest.approx(given, abs=1e-5)


@each_system
@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--parameter", "nonsense=1"], "--parameter nonsense: "),
        (["--parameter-max", "nonsense", "1"], "--parameter-max nonsense: unknown"),
        (["--parameter-min", "half-period", "many"], "--parameter-min half-period many: no number"),
    ],
)
def test_an_option_that_does_not_fit_is_named(
    name: str, words: list[str], line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("family", name, "--start", *SYSTEMS[name].start, *words, "-o", str(tmp_path / "never.json")) == 2
    error = capsys.readouterr().err
    assert line in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("system", "frequencies"),
    [
        (["hill.py", "x=0.7"], [math.sqrt(2 * math.sqrt(7) - 1), 2.0]),
        (["beam.py", "--parameter", "P=7/3"], [math.sqrt((7 + sign * math.sqrt(13)) / 6) for sign in (1, -1)]),
        (["beam.py", "--parameter", "P=2.5"], [math.sqrt(2)]),
    ],
)
def test_the_families_of_an_equilibrium_begin_with_its_frequencies(
    system: list[str], frequencies: list[float], tmp_path: Path
) -> None:
    output, (file, *given) = tmp_path / "family.json", system
    fixed, near = (given, []) if "--parameter" in given else ([], given)
    words = ["--start", "equilibrium", *near, "--max-orbits", "3", "--jobs", "1", "--quiet", "-o", str(output)]
    # At P = 5/2 one frequency is twice the other one, and the slower orbits are not to be found.
    assert explore_main(["family", "--system", str(EXAMPLES / file), *fixed, *words]) == (len(frequencies) == 1)
    found = [family.orbits[0].half_period for family in read_families(output)]
    assert found == pytest.approx([math.pi / frequency for frequency in frequencies], rel=1e-3)


@pytest.mark.parametrize(
    ("system", "line"),
    [
        (["michelson.py"], "michelson has no first integral"),
        (["henon-heiles.py"], "two pairs have the same frequency"),
        (["beam.py", "--parameter", "P=1"], "no elliptic pair"),
        (["beam.py"], "--parameter: P is missing"),
        (["beam.py", "--parameter", "P=x"], "no number"),
    ],
)
def test_an_equilibrium_without_small_orbits_is_one_line(
    system: list[str], line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--system", str(EXAMPLES / system[0]), *system[1:], "--start", "equilibrium"]
    assert explore_main(["family", *words, "-o", str(tmp_path / "never.json")]) == 2
    error = capsys.readouterr().err
    assert line in error
    assert error.count("\n") == 1
