"""The families of the paper's two tables: completeness, the rows themselves, and long runs that go on."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.process_work import dying, endless, name_of, squared

import orbitproof.explore.search.run
from orbitproof.explore.__main__ import main
from orbitproof.explore.engines import Job, Lost, run_all
from orbitproof.explore.families import (
    Detection,
    Family,
    Limits,
    StabilityCurve,
    TracedFamily,
    detect,
    family_record,
    largest_changes,
)
from orbitproof.explore.families.stability_curve import MAX_CHANGE, largest_change
from orbitproof.explore.names import resonant_values
from orbitproof.explore.numerics import Samples, predict, subdivide
from orbitproof.explore.orbits import SymmetricOrbit
from orbitproof.explore.records import BAND, read_families, write_families
from orbitproof.explore.refinement import Refined, Task, refine_tasks
from orbitproof.explore.search import targets_of
from orbitproof.explore.search.targets import is_refined, merged
from orbitproof.explore.three_body.families import trace_family
from orbitproof.figures.__main__ import main as figures_main
from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import candidate_to_json, read_candidates
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS

EARTH_MOON = {"mu": MASS_PARAMETERS["earth-moon"]}
SUN_JUPITER = {"mu": MASS_PARAMETERS["sun-jupiter"]}
LEVELS = {2: (-1.0,), 3: (-0.5,), 4: (0.0,), 6: (0.5,)}


@pytest.fixture(scope="module")
def odd_family() -> Family:
    return trace_family(FALKNER_SKAN, "odd", {}, Limits(parameter_min=300.0, parameter_max=700.0))


@pytest.fixture(scope="module")
def l2_family() -> Family:
    """The Earth-Moon L2 halo family from its birth past the near-double doubling and the two 1:4 behind it."""
    return trace_family(CR3BP, "L2-halo", EARTH_MOON, Limits(coordinate_max={"vy": 0.9}))


@pytest.fixture(scope="module")
def l2_detection(l2_family: Family) -> Detection:
    return detect(l2_family, [1, 2, 3, 4])


def circle(angles: Sequence[float]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Points and unit tangents of the unit circle."""
    points = [np.array([cos(angle), sin(angle)]) for angle in angles]
    return points, [np.array([-sin(angle), cos(angle)]) for angle in angles]


def test_prediction_from_three_points_is_of_sixth_order() -> None:
    errors = []
    for step in (0.1, 0.05):
        points, tangents = circle([0.0, -step, -2 * step])
        guess = predict(points, tangents, tangents[0], sin(step))
        assert float((guess - points[0]) @ tangents[0]) == pytest.approx(sin(step), abs=1e-15)
        errors.append(abs(guess[0] - cos(step)))
    assert errors[0] < 5e-6
    assert errors[0] / errors[1] > 40


def test_prediction_leaves_out_points_where_the_curve_has_turned() -> None:
    points, tangents = circle([0.0, -0.1, -1.6])
    two = predict(points[:2], tangents[:2], tangents[0], 0.05)
    assert predict(points, tangents, tangents[0], 0.05) == pytest.approx(two, abs=0)
    across = np.array([1.0, 0.0])
    assert predict(points, tangents, across, 0.05) == pytest.approx(points[0] + 0.05 * across, abs=0)


def test_subdivision_bounds_the_change_between_samples() -> None:
    def curve(place: float) -> np.ndarray:
        return np.array([np.tanh(30 * (place - 0.3))])

    ends = Samples((0.0, 1.0), (curve(0.0), curve(1.0)))
    dense = subdivide(curve, ends, lambda low, high: abs(high[0] - low[0]) <= 0.05)
    values = [value[0] for value in dense.values]
    assert np.max(np.abs(np.diff(values))) <= 0.05
    assert list(dense.places) == sorted(dense.places)
    assert (dense.places[0], dense.places[-1]) == (0.0, 1.0)
    shallow = subdivide(curve, ends, lambda low, high: False, depth=3)
    assert len(shallow.places) == 9


def test_changes_count_real_parameters_in_the_band_only() -> None:
    def coefficients(first: complex, second: complex) -> np.ndarray:
        return np.array([-(first + second).real, (first * second).real])

    assert largest_change(coefficients(0.5, 100.0), coefficients(0.6, 200.0)) == pytest.approx(0.1)
    assert largest_change(coefficients(5.0, 100.0), coefficients(6.0, 200.0)) == 0.0
    assert largest_change(coefficients(1.2, 100.0), coefficients(0.9, 100.0)) == pytest.approx(0.3)
    assert largest_change(coefficients(0.5 + 1j, 0.5 - 1j), coefficients(0.2 + 1j, 0.2 - 1j)) == 0.0
    near = largest_change(coefficients(0.5 + 0.01j, 0.5 - 0.01j), coefficients(0.2, 0.8))
    assert near == pytest.approx(sqrt(0.3**2 + 0.01**2))


def test_resonant_values_are_exact_where_they_are_rational() -> None:
    assert {k: resonant_values(k) for k in LEVELS} == LEVELS
    assert resonant_values(5) == pytest.approx([cos(2 * pi / 5), cos(4 * pi / 5)], abs=1e-15)


def test_samples_of_a_family_are_dense_and_solve_the_shooting_equations(
    l2_family: Family, l2_detection: Detection
) -> None:
    samples = l2_detection.samples
    places = [orbit.arclength for orbit in samples]
    assert places == sorted(set(places))
    assert set(l2_family.arclengths) <= set(places)
    assert largest_changes([orbit.coefficients[1:] for orbit in samples]) <= MAX_CHANGE * (1 + 1e-9)
    for orbit in samples[:: len(samples) // 12]:
        residual, _, _ = l2_family.problem.evaluate(orbit.unknowns)
        assert np.linalg.norm(residual) < 1e-9


def test_l2_family_has_the_near_double_doubling_and_two_resonances_of_order_four_behind_it(
    l2_detection: Detection,
) -> None:
    found = [(resonance.k, resonance.side) for resonance in l2_detection.resonances]
    first, second = "first", "second"
    assert found == [(1, first), (4, first), (3, first), (2, second), (2, first), (4, first), (2, first), (4, first)]
    assert l2_detection.undecided == ()


def test_between_two_crossings_of_a_level_there_is_an_extremum_beyond_it(l2_detection: Detection) -> None:
    for k, pair in ((2, (3, 4)), (4, (5, 7))):
        low, high = (l2_detection.resonances[i].orbit.arclength for i in pair)
        (level,) = LEVELS[k]
        inside = [e for e in l2_detection.extrema if low < e.orbit.arclength < high and e.level == level]
        assert len(inside) == 1
        assert inside[0].value < level
        assert inside[0].k == k
        assert abs(inside[0].value) <= BAND


def test_extrema_are_orbits_at_which_the_stability_parameter_turns(l2_family: Family, l2_detection: Detection) -> None:
    curve = StabilityCurve(l2_family)
    for extremum in l2_detection.extrema:
        place = extremum.orbit.arclength
        around = []
        for shift in (-0.02, 0.02):
            roots = np.array([s.real for s in curve.orbit(place + shift).stability])
            around.append(float(roots[np.argmin(np.abs(roots - extremum.value))]))
        signs = {np.sign(value - extremum.value) for value in around}
        assert len(signs) == 1


def test_one_resonance_gives_candidates_at_both_points_where_the_new_orbits_differ(
    l2_family: Family, l2_detection: Detection
) -> None:
    item = TracedFamily("L2-halo", "earth-moon", l2_family, l2_detection)
    one, distinct, every = ([target.id for target in targets_of(item, points)] for points in ("one", "distinct", "all"))
    assert one[:4] == [f"earth-moon-L2-halo-{name}" for name in ("k1-1", "k4-1", "k3-1", "k2-1")]
    assert set(distinct) - set(one) == {f"earth-moon-L2-halo-k4-{n}-second" for n in (1, 2, 3)}
    assert set(every) - set(distinct) == {"earth-moon-L2-halo-k3-1-second"}
    tasks = {target.id: target.task(20) for target in targets_of(item, "all")}
    resonance = l2_detection.resonances[1]
    assert tasks["earth-moon-L2-halo-k4-1-second"].guess == pytest.approx(resonance.orbit.second_point)
    assert tasks["earth-moon-L2-halo-k4-1-second"].provenance["point_on_fix_r"] == "second"
    assert tasks["earth-moon-L2-halo-k4-1"].guess == pytest.approx(resonance.orbit.unknowns[:-1])


def test_ids_do_not_depend_on_the_extent_of_the_family_or_on_other_multiplicities(l2_family: Family) -> None:
    end = next(i for i, orbit in enumerate(l2_family.orbits) if orbit.unknowns[2] > 0.5)
    short = replace(l2_family, orbits=l2_family.orbits[:end], tangents=l2_family.tangents[:end])
    item = TracedFamily("L2-halo", "earth-moon", short, detect(short, [4]))
    assert [target.id for target in targets_of(item, "one")] == ["earth-moon-L2-halo-k4-1"]


def test_fifth_and_sixth_order_resonances_are_tuplings(odd_family: Family) -> None:
    kinds = {r.k: (r.kind, r.other_side) for r in detect(odd_family, [5, 6]).resonances}
    assert kinds[5] == ("period_tupling", True)
    assert set(kinds) <= {5, 6}


def test_family_file_keeps_the_samples_and_the_extrema(
    l2_family: Family, l2_detection: Detection, tmp_path: Path
) -> None:
    path = tmp_path / "family.json"
    write_families(path, [family_record(TracedFamily("L2-halo", "earth-moon", l2_family, l2_detection))])
    (record,) = read_families(path)
    assert record.curve is not None
    assert record.curve.arclength.tolist() == [orbit.arclength for orbit in l2_detection.samples]
    assert np.array_equal(record.curve.points, [orbit.centre() for orbit in l2_detection.samples])
    assert [e.stability_parameter for e in record.extrema] == [e.value for e in l2_detection.extrema]
    document = json.loads(path.read_text())
    for name, value in (("coefficients", [[1.0], [1.0]]), ("arclength", [1.0, 0.0]), ("points", [[1.0, 2.0], [1.0]])):
        broken = json.loads(json.dumps(document))
        broken["families"][0]["curve"][name] = value
        path.write_text(json.dumps(broken))
        with pytest.raises(orbitproof.explore.search.run.InputError, match="curve"):
            read_families(path)


def test_stability_figure_and_csv_agree_with_the_family(
    l2_family: Family, l2_detection: Detection, tmp_path: Path, capsys: Any
) -> None:
    path = tmp_path / "family.json"
    write_families(path, [family_record(TracedFamily("L2-halo", "earth-moon", l2_family, l2_detection))])
    out = tmp_path / "out"
    assert figures_main(["resonances", str(path), "-o", str(out)]) == 0
    written, errors = capsys.readouterr()
    assert sorted(Path(line).name for line in written.split()) == sorted(file.name for file in out.iterdir())
    assert "samples" in errors
    with (out / "stability-cr3bp-earth-moon-L2-halo.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(l2_detection.samples)
    for row, orbit in list(zip(rows, l2_detection.samples, strict=True))[::50]:
        assert float(row["jacobi_constant"]) == orbit.first_integral
        values = sorted(s.real for s in orbit.stability)
        assert [float(row["stability_1_real"]), float(row["stability_2_real"])] == pytest.approx(values, rel=1e-9)
    with (out / "resonances-cr3bp-earth-moon-L2-halo.csv").open() as stream:
        events = list(csv.DictReader(stream))
    assert [int(row["k"]) for row in events if row["what"] == "resonance"] == [r.k for r in l2_detection.resonances]
    assert sum(row["what"] == "extremum" for row in events) == len(l2_detection.extrema)


def test_family_file_without_samples_is_refused_by_the_stability_figure(tmp_path: Path, capsys: Any) -> None:
    data = Path(__file__).parents[1] / "data" / "figures-halo-family.json"
    assert figures_main(["resonances", str(data), "-o", str(tmp_path / "out")]) == 2
    assert "families[0].curve" in capsys.readouterr().err


@pytest.mark.parametrize("jobs", [1, 2])
def test_all_items_are_worked_on_and_progress_reaches_the_end(jobs: int) -> None:
    seen: list[tuple[str, float]] = []
    results = dict(run_all(Job(squared, name_of), [3, 4, 5], jobs, lambda text, part: seen.append((text, part))))
    assert results == {0: 9, 1: 16, 2: 25}
    assert all(text.startswith("item ") and 0 <= part <= 1 for text, part in seen)


def test_a_process_that_dies_loses_its_own_item_only() -> None:
    results = dict(run_all(Job(dying, name_of), [0, 1, 2, 3], 2, lambda text, part: None))
    assert isinstance(results[1], Lost)
    assert "exit code 3" in results[1].reason
    assert {index: result for index, result in results.items() if index != 1} == {0: 0, 2: 2, 3: 3}


def test_an_interrupt_collects_what_the_processes_have() -> None:
    def interrupt(text: str, part: float) -> None:
        if "working" in text:
            interrupts.append(text)
            if len(interrupts) == 1:
                raise KeyboardInterrupt

    interrupts: list[str] = []
    results: list[tuple[int, Any]] = []
    with pytest.raises(KeyboardInterrupt):
        results.extend(run_all(Job(endless, name_of), [0, 1, 2, 3], 2, interrupt))
    assert sorted(index for index, _ in results) == [0, 1]
    assert all(isinstance(steps, int) for _, steps in results)


@pytest.fixture(scope="module")
def refined(odd_family: Family) -> tuple[TracedFamily, list[Candidate]]:
    """The Falkner-Skan rows k = 2 and 3, refined to few digits."""
    item = TracedFamily("odd", "", odd_family, detect(odd_family, [2, 3]))
    tasks = [target.task(20) for target in targets_of(item, "one")]
    results = [result for _, result in refine_tasks(tasks, 1, lambda text, part: None)]
    assert all(result.candidate is not None for result in results)
    return item, [result.candidate for result in results if result.candidate is not None]


def test_a_refined_candidate_is_recognised_and_a_different_one_is_not(
    refined: tuple[TracedFamily, list[Candidate]],
) -> None:
    item, (two, three) = refined
    task = targets_of(item, "one")[0].task(20)
    assert is_refined(task, two)
    assert is_refined(replace(task, digits=15), two)
    assert not is_refined(replace(task, digits=30), two)
    assert not is_refined(task, replace(two, k=3))
    assert not is_refined(task, replace(two, provenance={}))
    assert not is_refined(replace(task, guess=(task.guess[0] + 0.1, task.guess[1])), two)
    assert not is_refined(task, three)


def test_candidates_of_a_family_stay_in_order_along_it(refined: tuple[TracedFamily, list[Candidate]]) -> None:
    _, (two, three) = refined
    other = replace(two, id="other", provenance={"family": "another", "parameters": "", "arclength": 1e9})
    foreign = replace(two, id="foreign", provenance={})
    assert [c.id for c in merged([], [three, two])] == [two.id, three.id]
    assert [c.id for c in merged([three, other, foreign], [two])] == [two.id, three.id, "other", "foreign"]
    fresh = replace(two, k=2, provenance={**two.provenance, "note": "fresh"})
    assert merged([two, three], [fresh]) == [fresh, three]
    both = replace(two, id="second", provenance={**two.provenance, "point_on_fix_r": "second"})
    assert [c.id for c in merged([], [both, two])] == [two.id, "second"]


def test_an_interrupted_refinement_goes_on_and_repeats_nothing(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[list[str]] = []

    def first_only(tasks: Sequence[Task], jobs: int, progress: Any) -> Iterator[tuple[int, Refined]]:
        asked.append([task.id for task in tasks])
        for pair in refine_tasks(tasks, 1, progress):
            yield pair
            if len(asked) == 1:
                raise KeyboardInterrupt

    monkeypatch.setattr(orbitproof.explore.search.run, "refine_tasks", first_only)
    output, family = tmp_path / "c.json", tmp_path / "f.json"
    arguments = ["candidates", "--system", "falkner-skan", "-k", "2", "3", "--beta-min", "300", "--beta-max", "460"]
    arguments += ["--digits", "20", "--quiet", "-o", str(output), "--family-output", str(family), "--append"]
    assert main(arguments) == 130
    assert [candidate.k for candidate in read_candidates(output)] == [2]
    assert "--append" in capsys.readouterr().err
    before = output.read_text()
    assert main([*arguments, "--from-family", str(family)]) == 0
    assert asked == [["falkner-skan-odd-k2-1", "falkner-skan-odd-k3-1"], ["falkner-skan-odd-k3-1"]]
    table = capsys.readouterr().out
    assert [candidate.k for candidate in read_candidates(output)] == [2, 3]
    assert "340.18753498914353" in table
    assert "453.44258682138" in table
    assert candidate_to_json(read_candidates(output)[0]) == json.loads(before)["candidates"][0]
    assert main([*arguments, "--from-family", str(family)]) == 0
    assert len(asked) == 2 or asked[2] == []


L1_MULTIPLICITIES = [1, 4, 3, 2, 2, 3, 3, 2, 2, 3, 4, 2, 3, 4, 1]
L2_MULTIPLICITIES = {"earth-moon": [1, 4, 3, 2, 2, 4, 2, 4, 2, 3, 4], "sun-jupiter": [1, 4, 3, 2, 2, 2, 2, 3, 4]}
NEW = {
    ("earth-moon", "L1-halo"): [4, 7, 8],
    ("sun-jupiter", "L1-halo"): [4, 7, 8],
    ("earth-moon", "L2-halo"): [3, 8],
    ("sun-jupiter", "L2-halo"): [3, 5, 6],
}
PAPER = {
    ("earth-moon", "L1-halo"): [1, 4, 3, 2, 3, 3, 3, 4, 2, 3, 4, 1],
    ("sun-jupiter", "L1-halo"): [1, 4, 3, 2, 3, 3, 3, 4, 2, 3, 4, 1],
    ("earth-moon", "L2-halo"): [1, 4, 3, 2, 4, 2, 4, 3, 4],
    ("sun-jupiter", "L2-halo"): [1, 4, 3, 2, 3, 4],
}
"""The multiplicities in the paper's two tables."""


@pytest.mark.slow
def test_preset_finds_every_row_of_both_tables_and_the_new_ones(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "families.json"
    assert main(["family", "--preset", "tables", "-k", "1", "2", "3", "4", "--jobs", "2", "-o", str(path)]) == 0
    assert "undecided" not in capsys.readouterr().err
    records = read_families(path)
    assert {(record.label, record.name) for record in records} == set(PAPER)
    for record in records:
        found = [resonance.k for resonance in record.resonances]
        key = (record.label, record.name)
        assert found == (L1_MULTIPLICITIES if record.name == "L1-halo" else L2_MULTIPLICITIES[record.label])
        assert [k for i, k in enumerate(found) if i not in NEW[key]] == PAPER[key]
        assert {found[i] for i in NEW[key]} == {2}
        assert record.curve is not None
        changes = largest_changes(list(record.curve.coefficients[:, 1:]))
        assert changes <= MAX_CHANGE * (1 + 1e-9)
        # Near-double: one turn beyond a resonant value by about 1e-4, no other turn near one.
        distances = sorted(abs(e.stability_parameter - e.level) for e in record.extrema)
        assert 1e-5 < distances[0] < 3e-4
        assert distances[1] > 0.05


@pytest.mark.slow
def test_a_preset_finds_the_births_of_the_axial_families(tmp_path: Path) -> None:
    path = tmp_path / "births.json"
    assert main(["candidates", "--preset", "axial-births", "--jobs", "2", "--quiet", "-o", str(path)]) == 0
    known = {item.id: item for item in read_candidates(Path(__file__).parents[1] / "data" / "axial-births.json")}
    found = {item.id: item for item in read_candidates(path)}
    assert set(found) == set(known)
    for name, item in found.items():
        assert max(abs(a - b) for a, b in zip(item.centre, known[name].centre, strict=True)) < 1e-30


@pytest.mark.slow
@pytest.mark.parametrize("parameters", [EARTH_MOON, SUN_JUPITER], ids=["earth-moon", "sun-jupiter"])
def test_families_pass_the_smaller_primary_below_a_thousandth(parameters: dict[str, Any]) -> None:
    speed = 20.5 if parameters is EARTH_MOON else 8.0
    family = trace_family(CR3BP, "L2-halo", parameters, Limits(coordinate_max={"vy": speed}))
    assert family.reason.startswith(f"limit vy = {speed:g}")
    place = 1 - float(parameters["mu"])

    def distance(orbit: SymmetricOrbit) -> float:
        return float(np.hypot(orbit.unknowns[0] - place, orbit.unknowns[1]))

    assert min(map(distance, family.orbits)) < 1e-4
    for orbit in family.orbits[-3:]:
        residual, _, _ = family.problem.evaluate(orbit.unknowns)
        assert np.linalg.norm(residual) < 1e-8
