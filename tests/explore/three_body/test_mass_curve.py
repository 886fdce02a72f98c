"""Curves of symmetry-breaking points in the mass parameter: what lies on them, and how exactly."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from math import log
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from orbitproof.explore.__main__ import main
from orbitproof.explore.flow import flow_of
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.orbits.stability import half_return
from orbitproof.explore.three_body.masses import (
    CurveRecord,
    ExtremumRecord,
    PointRecord,
    PrecisePoint,
    PreciseRecord,
    PrecisionFailure,
    SettingsRecord,
    chart_of,
    correct_at,
    extremum_between,
    extremum_brackets,
    first_breaking,
    point_at,
    precise_breaking,
    precise_extremum,
    read_curves,
    trace_curve,
    write_curves,
)
from orbitproof.explore.three_body.masses.charts import evaluate
from orbitproof.explore.three_body.masses.expansion import Settings
from orbitproof.explore.three_body.masses.file import decimal_text, rounded
from orbitproof.explore.three_body.seeds import LIBRATION_POINTS
from orbitproof.figures.pictures import draw_mass_curves, read_mass_curves
from orbitproof.figures.style import close, use_style
from orbitproof.figures.tables import default_published, read_published
from orbitproof.shared import InputError
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

EARTH_MOON = MASS_PARAMETERS["earth-moon"]
HALF = Fraction(1, 2)


@pytest.fixture(scope="module")
def curves() -> dict[str, CurveRecord]:
    """All three curves in long steps."""
    return {name: trace_curve(name, [first_breaking(name, HALF)], 1e-10, step=0.4) for name in LIBRATION_POINTS}


def distance(a: tuple[float, float], b: tuple[float, float]) -> float:
    return max(abs(x - y) for x, y in zip(a, b, strict=True))


@pytest.mark.parametrize("name", LIBRATION_POINTS)
def test_curve_reaches_the_smallest_mass_exactly(curves: dict[str, CurveRecord], name: str) -> None:
    curve = curves[name]
    assert curve.outcome == "complete"
    assert curve.points[0].mu == 0.5
    assert curve.points[-1].mu == pytest.approx(1e-10, rel=1e-13)
    assert max(point.residual for point in curve.points) < 1e-12
    masses = [point.mu for point in curve.points]
    assert masses == sorted(masses, reverse=True)


@pytest.mark.parametrize("name", LIBRATION_POINTS)
@pytest.mark.parametrize("index", [0, 10, 20])
def test_points_are_symmetry_breakings_of_the_plain_equations(
    curves: dict[str, CurveRecord], name: str, index: int
) -> None:
    point = curves[name].points[index]
    flow = flow_of(CR3BP).derivative([point.x, 0.0, 0.0, 0.0, point.vy, 0.0], point.half_period, [point.mu])
    assert flow.state[[1, 3]] == pytest.approx([0, 0], abs=1e-11)
    assert flow.state[[0, 4]] == pytest.approx(point.second, abs=1e-11)
    odd = half_return(CR3BP, flow).derivative[-1, 1]
    # Near L3 the function is of order mu: that is how small it must be in units of its slope.
    assert abs(odd) < 1e-10
    moved = flow_of(CR3BP).derivative([point.x + 1e-4, 0.0, 0.0, 0.0, point.vy, 0.0], point.half_period, [point.mu])
    assert abs(half_return(CR3BP, moved).derivative[-1, 1]) > 1e-7


@pytest.mark.parametrize("name", LIBRATION_POINTS)
@pytest.mark.parametrize("mass", ["earth-moon", "sun-jupiter"])
def test_curve_meets_the_first_breaking_of_each_family(curves: dict[str, CurveRecord], name: str, mass: str) -> None:
    mu = MASS_PARAMETERS[mass]
    on_curve, on_family = point_at(name, curves[name].points, float(mu)), first_breaking(name, mu)
    assert distance(on_curve.scaled, on_family.scaled) < 1e-12
    assert on_curve.half_period == pytest.approx(on_family.half_period, abs=1e-12)


def test_earth_moon_point_lies_in_the_published_enclosure(curves: dict[str, CurveRecord]) -> None:
    published = next(entry for entry in read_published(default_published()) if entry.family == "L1-halo")
    row = next(row for row in published.rows if row.k == 1 and row.j == 0)
    level = point_at("L1", curves["L1"].points, float(EARTH_MOON)).jacobi_constant
    assert row.parameter.interval.lower < Fraction(level) < row.parameter.interval.upper


def test_curves_of_l2_and_l3_are_mirror_images_at_equal_masses(curves: dict[str, CurveRecord]) -> None:
    second, third = (curves[name].points[0] for name in ("L2", "L3"))
    assert (third.x, third.vy) == pytest.approx((-second.x, -second.vy), abs=1e-12)
    assert third.jacobi_derivative == pytest.approx(-second.jacobi_derivative, abs=1e-10)


def test_shape_near_the_smaller_mass_tends_to_that_of_hills_problem(curves: dict[str, CurveRecord]) -> None:
    """Hill's problem is symmetric under a half turn, which maps L1 to L2 and the first crossing to the second."""
    first, second = curves["L1"].points[-1], curves["L2"].points[-1]
    unit = np.cbrt(first.mu)
    turned = ((1.0 - second.mu - second.second[0]) / unit, -second.second[1] / unit)
    # Both differ from Hill's problem by O(mu^(1/3)).
    assert distance(first.scaled, turned) < 2 * unit
    assert first.half_period == pytest.approx(second.half_period, abs=2 * unit)


@pytest.mark.parametrize("name", LIBRATION_POINTS)
@pytest.mark.parametrize("log_mu", [-23.0, -5.0, -0.8])
def test_derivatives_agree_with_differences(curves: dict[str, CurveRecord], name: str, log_mu: float) -> None:
    chart = chart_of(name)
    point = point_at(name, curves[name].points, float(np.exp(log_mu)))
    unknowns = chart.unknowns(point.x, point.vy, point.half_period, point.mu)
    unknowns[:2] = point.scaled
    if name == "L3":
        unknowns[2] = -1.8  # T - pi over mu: rounding spoils it where mu is tiny
    here = evaluate(chart, unknowns)
    for column, direction in enumerate(np.eye(4)):
        ahead, behind = (evaluate(chart, unknowns + sign * 1e-6 * direction) for sign in (1, -1))
        difference = (ahead.residual - behind.residual) / 2e-6
        assert here.jacobian[:, column] == pytest.approx(difference, abs=2e-5)
        slope = (ahead.jacobi_constant - behind.jacobi_constant) / 2e-6
        assert here.jacobi_gradient[column] == pytest.approx(slope, abs=1e-8)


@pytest.mark.parametrize("name", LIBRATION_POINTS)
def test_derivative_of_the_jacobi_constant_is_that_along_the_curve(curves: dict[str, CurveRecord], name: str) -> None:
    for mu in (0.2, 1e-3):
        low, middle, high = (point_at(name, curves[name].points, mu * (1 + d)) for d in (-1e-4, 0.0, 1e-4))
        slope = (high.jacobi_constant - low.jacobi_constant) / (high.mu - low.mu)
        assert middle.jacobi_derivative == pytest.approx(slope, rel=1e-6)


def test_jacobi_constant_along_the_l3_curve_increases_with_the_mass(curves: dict[str, CurveRecord]) -> None:
    """The paper's Remark about L3 sees a local minimum for small mu; with mu as a regular parameter there is none."""
    points = curves["L3"].points
    assert not extremum_brackets(points)
    slopes = np.array([point.jacobi_derivative for point in points])
    assert slopes.min() > 0.75
    small = slopes[[point.mu < 1e-6 for point in points]]
    assert len(small) > 10
    assert small == pytest.approx(np.full(len(small), 0.751928), abs=1e-5)


def test_a_mass_beyond_the_curve_is_a_failure_with_a_reason(curves: dict[str, CurveRecord]) -> None:
    with pytest.raises(CorrectionFailure, match="does not lie on the curve"):
        point_at("L1", curves["L1"].points, 1e-11)
    with pytest.raises(ValueError, match="unknown libration point"):
        chart_of("L4")


@pytest.mark.parametrize(
    ("name", "mu"),
    [
        ("L1", Fraction(1, 10**10)),
        pytest.param("L3", Fraction(1, 10**10), marks=pytest.mark.slow),
        ("L2", EARTH_MOON),
    ],
)
def test_float64_points_have_thirteen_digits_of_the_size_of_the_orbit(
    curves: dict[str, CurveRecord], name: str, mu: Fraction
) -> None:
    near = point_at(name, curves[name].points, float(mu))
    precise = precise_breaking(chart_of(name), mu, near.scaled, digits=20)
    chart = chart_of(name)
    unit = chart.unit(float(mu))
    place = (float(precise.x - chart.origin_exact(mu)) / unit, float(precise.vy) / unit)
    assert precise.residual < 1e-21
    assert distance(place, near.scaled) < 2e-13
    assert float(precise.jacobi_constant) == pytest.approx(near.jacobi_constant, abs=5e-14)
    assert float(precise.jacobi_derivative) == pytest.approx(near.jacobi_derivative, rel=1e-9)


def test_precision_that_is_not_reached_is_a_failure(curves: dict[str, CurveRecord]) -> None:
    near = point_at("L3", curves["L3"].points, 1e-3)
    with pytest.raises(PrecisionFailure, match="30 digits are not reached"):
        precise_breaking(chart_of("L3"), Fraction(1, 1000), near.scaled, digits=30, settings=Settings(90))


def maximum_along_l2(curves: dict[str, CurveRecord], digits: int, settings: Settings) -> PrecisePoint:
    ((a, b),) = extremum_brackets(curves["L2"].points)
    near = extremum_between("L2", a, b)
    return precise_extremum(chart_of("L2"), near.mu, near.scaled, digits=digits, settings=settings)


@pytest.mark.slow
def test_maximum_of_the_jacobi_constant_is_one(curves: dict[str, CurveRecord]) -> None:
    found = maximum_along_l2(curves, 15, Settings(130))
    assert found.jacobi_curvature is not None
    assert found.jacobi_curvature < 0
    assert found.residual < 1e-16
    top, mu, width = float(found.jacobi_constant), float(found.mu), 1e-4
    for side in (-width, width):
        beside = point_at("L2", curves["L2"].points, mu + side).jacobi_constant
        assert beside == pytest.approx(top + float(found.jacobi_curvature) * width**2 / 2, abs=1e-10)
        assert beside < top


@pytest.mark.slow
def test_thirty_digits_of_an_extremum_agree_for_two_precisions(curves: dict[str, CurveRecord]) -> None:
    coarse = maximum_along_l2(curves, 30, Settings(400, 80, 1e-60))
    fine = maximum_along_l2(curves, 40, Settings(500, 110, 1e-80))
    for a, b in ((coarse.mu, fine.mu), (coarse.x, fine.x), (coarse.jacobi_constant, fine.jacobi_constant)):
        assert abs(a - b) < Fraction(1, 10**40)
    assert coarse.mu != fine.mu


def settings() -> SettingsRecord:
    return SettingsRecord(400, 80, 1e-60)


def with_precise(curve: CurveRecord) -> CurveRecord:
    """A curve with a point in high precision and an extremum of made-up numbers."""
    near = curve.points[3]
    point = PreciseRecord(
        mu=Fraction(1, 1000),
        x=Fraction(near.x),
        vy=Fraction(near.vy),
        half_period=near.half_period,
        jacobi_constant=rounded(Fraction(22, 7), 33),
        jacobi_derivative=rounded(Fraction(-1, 3), 30),
        digits=30,
        settings=settings(),
        residual=1e-40,
        change=1e-39,
        float64_error=1e-14,
    )
    extremum = ExtremumRecord(
        kind="minimum",
        mu=rounded(Fraction(1, 300), 30),
        mu_exact=Fraction(1, 256),
        x=Fraction(near.x),
        vy=Fraction(near.vy),
        half_period=near.half_period,
        jacobi_constant=Fraction(3),
        jacobi_second_derivative=2.0,
        digits=30,
        settings=settings(),
        residual=1e-40,
        change=0.0,
    )
    return replace(curve, precise=(point,), extrema=(extremum,))


def test_file_gives_back_what_was_written(curves: dict[str, CurveRecord], tmp_path: Path) -> None:
    written = [with_precise(curves["L1"]), curves["L3"]]
    write_curves(tmp_path / "c.json", written)
    assert read_curves(tmp_path / "c.json") == written


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (Fraction(1, 3), 5, "0.33333"),
        (Fraction(-2, 3) / 10**12, 4, "-6.667e-13"),
        (Fraction(123456), 3, "1.23e+5"),
        (Fraction(0), 5, "0"),
    ],
)
def test_decimals_are_rounded_to_significant_digits(value: Fraction, digits: int, text: str) -> None:
    assert decimal_text(rounded(value, digits)) == text


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda d: d["curves"][0]["points"][0].update(mu="0"), "outside"),
        (lambda d: d["curves"][0]["points"][0].update(mu=0.5), "must be of type string"),
        (lambda d: d["curves"].append(d["curves"][0]), "appears twice"),
        (lambda d: d["curves"][0].pop("precise"), "'precise' is missing"),
        (lambda d: d["curves"][0].update(libration="L4"), "must be"),
    ],
)
def test_damaged_file_is_refused(
    curves: dict[str, CurveRecord], tmp_path: Path, change: object, complaint: str
) -> None:
    path = tmp_path / "c.json"
    write_curves(path, [curves["L1"]])
    document = json.loads(path.read_text())
    change(document)  # type: ignore[operator]
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=complaint):
        read_curves(path)


def run(*arguments: str) -> int:
    return main(["mass-curve", *arguments, "--jobs", "1", "--quiet"])


def test_same_command_goes_on_with_an_interrupted_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "c.json"
    command = ["--points", "L1", "--mu-min", "1e-2", "--step", "0.5", "--at", "earth-moon", "--digits", "12"]
    assert run(*command, "-o", str(path)) == 0
    assert "3.17435194426" in capsys.readouterr().out
    (whole,) = read_curves(path)
    assert len(whole.precise) == 1
    write_curves(path, [replace(whole, outcome="interrupted", points=whole.points[:4])])
    assert run(*command, "-o", str(path)) == 0
    (again,) = read_curves(path)
    assert again.points[:4] == whole.points[:4]
    assert again.precise == whole.precise
    assert distance(again.points[-1].scaled, whole.points[-1].scaled) < 1e-12
    before = path.read_bytes()
    assert run(*command, "-o", str(path)) == 0
    assert path.read_bytes() == before


def test_curve_without_extremum_is_reported_as_not_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "c.json"
    assert run("--points", "L3", "--mu-min", "1e-2", "--step", "0.5", "--extrema", "L3", "-o", str(path)) == 1
    assert "no local extremum of the Jacobi constant for mu in [0.01, 0.5]" in capsys.readouterr().err
    assert read_curves(path)[0].outcome == "complete"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--mu-max", "0.6"], "above 1/2"),
        (["--mu-min", "0.5"], "not below"),
        (["--mu-min", "x"], "neither a name"),
        (["--mu-min", "1e-200"], "below 1e-100"),
        (["--at", "1e-12"], "outside"),
        (["--points", "L1", "--extrema", "L3"], "not among --points"),
        (["--digits", "3"], "give 10 to 300"),
        (["--step", "0"], "outside"),
        (["--extrema", "L2", "--tolerance", "nan"], "give a number"),
    ],
)
def test_bad_options_are_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], complaint: str
) -> None:
    assert run(*arguments, "-o", str(tmp_path / "c.json")) == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert error.count("\n") == 1
    assert not (tmp_path / "c.json").exists()


@pytest.fixture
def picture(curves: dict[str, CurveRecord], tmp_path: Path) -> Iterator[Figure]:
    path = tmp_path / "c.json"
    write_curves(path, [with_precise(curves["L1"]), curves["L2"], curves["L3"]])
    with use_style():
        figure = draw_mass_curves(read_mass_curves(path))
        yield figure
        close(figure)


def test_picture_shows_the_curves_and_what_was_located(picture: Figure, curves: dict[str, CurveRecord]) -> None:
    assert len(picture.axes) == 9
    assert all(axes.get_ylabel() and axes.get_xlabel() for axes in picture.axes)
    for axes, name in zip(picture.axes[4::3], ("L2", "L3"), strict=True):
        (line,) = axes.lines
        assert list(line.get_xdata()) == [point.mu for point in curves[name].points]
        assert list(line.get_ydata()) == [point.jacobi_constant for point in curves[name].points]
    located = [line for line in picture.axes[1].lines if line.get_marker() == "v"]
    assert [line.get_xdata()[0] for line in located] == [pytest.approx(1 / 300)]
    assert all(line.get_markerfacecolor() == "white" for line in located)
    texts = [text.get_text() for legend in picture.legends for text in legend.get_texts()]
    assert "minimum of the Jacobi constant" in texts
    assert "maximum of the Jacobi constant" not in texts


def test_legend_lies_below_all_panels(picture: Figure) -> None:
    picture.draw_without_rendering()
    top = max(legend.get_window_extent().y1 for legend in picture.legends)
    assert all(axes.get_tightbbox().y0 >= top - 1 for axes in picture.axes)


def test_file_without_a_curve_is_refused(curves: dict[str, CurveRecord], tmp_path: Path) -> None:
    write_curves(tmp_path / "c.json", [])
    with pytest.raises(InputError, match="empty"):
        read_mass_curves(tmp_path / "c.json")
    write_curves(tmp_path / "c.json", [replace(curves["L1"], points=curves["L1"].points[:1])])
    with pytest.raises(InputError, match="one point is no curve"):
        read_mass_curves(tmp_path / "c.json")


def test_slope_changes_are_seen_on_both_sides() -> None:
    def point(mu: float, slope: float) -> PointRecord:
        return PointRecord(mu, 0.0, 0.0, (0.0, 0.0), (0.0, 0.0), 1.0, 3.0, slope, 0.0)

    points = [point(mu, log(mu / 0.1) * log(mu / 0.01)) for mu in (0.5, 0.2, 0.05, 0.02, 0.005)]
    assert [(a.mu, b.mu) for a, b in extremum_brackets(points)] == [(0.2, 0.05), (0.02, 0.005)]


def test_correction_at_a_mass_keeps_the_mass(curves: dict[str, CurveRecord]) -> None:
    point = curves["L2"].points[5]
    chart = chart_of("L2")
    unknowns = chart.unknowns(point.x + 1e-5, point.vy, point.half_period, point.mu)
    found = correct_at(chart, unknowns)
    assert found.mu == pytest.approx(point.mu, rel=1e-15)
    assert distance(found.scaled, point.scaled) < 1e-12
