"""Mass-parameter curves from start to end: trace, refine, locate extrema; written as they come."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import log
from operator import attrgetter
from pathlib import Path

from orbitproof.explore.engines import Job, Lost, Progress, Reporter, run_all
from orbitproof.explore.families import FamilyFailure
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.three_body.masses.charts import MassChart
from orbitproof.explore.three_body.masses.curve import (
    chart_of,
    extremum_between,
    extremum_brackets,
    first_breaking,
    point_at,
    trace_curve,
)
from orbitproof.explore.three_body.masses.expansion import Settings
from orbitproof.explore.three_body.masses.file import (
    CurveRecord,
    ExtremumRecord,
    PointRecord,
    PreciseRecord,
    SettingsRecord,
    decimal_text,
    read_curves,
    rounded,
    write_curves,
)
from orbitproof.explore.three_body.masses.precision import (
    PrecisePoint,
    PrecisionFailure,
    bits_for,
    precise_breaking,
    precise_extremum,
)
from orbitproof.shared.answers import tell
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.printed_tables import fitted
from orbitproof.shared.wording import counted

_SAVE_EVERY = 50
_EXTRA_DIGITS = 3
"""Digits that the Jacobi constant and its derivative are written with beyond those asked for."""


@dataclass(frozen=True)
class MassCurveRequest:
    """A checked command line; see ``orbitproof explore mass-curve --help``.

    Attributes:
        masses: of the points in high precision.
        extremum_settings: bits, order and tolerance for extrema.
    """

    points: tuple[str, ...]
    largest: Fraction
    smallest: Fraction
    step: float
    masses: tuple[Fraction, ...]
    extrema: tuple[str, ...]
    digits: int
    bits: int | None
    order: int | None
    tolerance: float | None
    extremum_settings: tuple[int, int, float]
    output: Path
    jobs: int
    quiet: bool


@dataclass(frozen=True)
class _Task:
    """A point to compute in high precision: at a mass, or (`bracket`) an extremum between two points of a curve."""

    libration: str
    mu: Fraction
    guess: tuple[float, float]
    digits: int
    settings: Settings | None
    is_extremum: bool

    @property
    def title(self) -> str:
        what = "extremum near" if self.is_extremum else "at"
        return f"{self.libration} {what} mu = {float(self.mu):.6g}"


def run_request(request: MassCurveRequest) -> int:
    """Do what is asked for; returns the exit code. Raises `InputError`."""
    curves = {curve.libration: curve for curve in read_curves(request.output)} if request.output.is_file() else {}
    code = 0
    with Reporter(request.quiet) as report:
        try:
            for libration in request.points:
                if not _trace(request, libration, curves, report):
                    code = 1
            if not _refine(request, curves, report):
                code = 1
        except KeyboardInterrupt:
            kept = (
                f"what is done stands in {request.output}; the same command goes on" if curves else "nothing is written"
            )
            report.error(f"interrupted; {kept}")
            code = INTERRUPTED
    _print(request, curves)
    return code


def _trace(request: MassCurveRequest, libration: str, curves: dict[str, CurveRecord], report: Reporter) -> bool:
    """Trace one curve, or the rest of it, and write the file; whether it reaches the smallest mass."""
    largest, smallest = float(request.largest), float(request.smallest)
    old = curves.get(libration)
    if old is not None and old.points[0].mu != largest:
        report.message(f"{libration}: the curve in {request.output} starts at another mass; it is traced again")
        old = replace(old, points=())
    if old is not None and old.outcome == "complete" and old.points and old.points[-1].mu <= smallest * (1 + 1e-12):
        report.message(f"{libration}: the curve is in {request.output} already, {counted(len(old.points), 'point')}")
        return True
    report.stage(f"{libration}, mu from {largest:g} to {smallest:g}")
    kept = CurveRecord(libration, "interrupted", "interrupted", ()) if old is None else old

    def save(curve: CurveRecord) -> None:
        curves[libration] = replace(curve, precise=kept.precise, extrema=kept.extrema)
        write_curves(request.output, [curves[name] for name in sorted(curves)])

    def progress(points: list[PointRecord]) -> None:
        report.update(f"mu = {points[-1].mu:.3g}", log(largest / points[-1].mu) / log(largest / smallest))
        if len(points) % _SAVE_EVERY == 0:
            save(CurveRecord(libration, "interrupted", "interrupted", tuple(points)))

    try:
        start = kept.points or (first_breaking(libration, request.largest),)
    except (FamilyFailure, CorrectionFailure) as failure:
        report.error(f"{libration}: no first point: {failure}")
        return False
    curve = trace_curve(libration, start, smallest, step=request.step, progress=progress)
    save(curve)
    if curve.outcome == "interrupted":
        raise KeyboardInterrupt
    report.message(f"{libration}: {counted(len(curve.points), 'point')}, ends: {curve.reason}")
    if curve.outcome != "complete":
        report.error(f"{libration}: the smallest mass is not reached: {curve.reason}")
    return curve.outcome == "complete"


def _refine(request: MassCurveRequest, curves: dict[str, CurveRecord], report: Reporter) -> bool:
    """Compute what the file does not hold yet in high precision; whether everything was found."""
    complete = True
    tasks: list[_Task] = []
    floats: list[PointRecord] = []
    for libration in request.points:
        curve = curves.get(libration)
        if curve is None:
            continue
        done = {(row.mu, row.digits) for row in curve.precise}
        for mu in request.masses:
            if any(mass == mu and digits >= request.digits for mass, digits in done):
                continue
            try:
                floats.append(point_at(libration, curve.points, float(mu)))
            except CorrectionFailure as failure:
                report.error(f"{libration}: {failure}")
                complete = False
                continue
            settings = None
            if request.bits is not None or request.order is not None or request.tolerance is not None:
                settings = Settings(request.bits or bits_for(mu, request.digits), request.order, request.tolerance)
            tasks.append(_Task(libration, mu, floats[-1].scaled, request.digits, settings, False))
        if libration in request.extrema:
            more = _extremum_tasks(request, curve, report)
            complete = complete and bool(more or curve.extrema)
            tasks += more
            floats += [curve.points[0]] * len(more)
    if not tasks:
        return complete
    report.stage(f"{counted(len(tasks), 'point')} to {request.digits} digits")
    for index, result in run_all(Job(_work, attrgetter("title")), tasks, request.jobs, report.update):
        task = tasks[index]
        if isinstance(result, (Lost, PrecisionFailure)):
            report.error(f"{task.title}: not found: {result.reason if isinstance(result, Lost) else result}")
            complete = False
            continue
        curves[task.libration] = _with(curves[task.libration], task, result, floats[index])
        write_curves(request.output, [curves[name] for name in sorted(curves)])
        report.message(f"{task.title}: {task.digits} digits, last correction {result.residual:.1e}")
    return complete


def _extremum_tasks(request: MassCurveRequest, curve: CurveRecord, report: Reporter) -> list[_Task]:
    """A task for each sign change of dC/dmu that is not located yet."""
    brackets = extremum_brackets(curve.points)
    if not brackets:
        slopes = [point.jacobi_derivative for point in curve.points[1:]]
        ends = sorted((curve.points[0].mu, curve.points[-1].mu))
        report.error(
            f"{curve.libration}: no local extremum of the Jacobi constant for mu in [{ends[0]:g}, {ends[1]:g}]: along "
            f"the curve dC/dmu stays in [{min(slopes):.6g}, {max(slopes):.6g}] at {len(slopes)} points"
        )
    tasks = []
    for a, b in brackets:
        low, high = sorted((a.mu, b.mu))
        if any(low <= row.mu <= high and row.digits >= request.digits for row in curve.extrema):
            continue
        try:
            near = extremum_between(curve.libration, a, b)
        except CorrectionFailure as failure:
            report.error(f"{curve.libration}: extremum between mu = {low:.6g} and {high:.6g}: {failure}")
            continue
        settings = Settings(*request.extremum_settings)
        tasks.append(_Task(curve.libration, Fraction(near.mu), near.scaled, request.digits, settings, True))
    return tasks


def _work(task: _Task, progress: Progress) -> PrecisePoint | PrecisionFailure:
    """One point in high precision; a failure is a result, not an exception."""
    chart = chart_of(task.libration)
    try:
        if task.is_extremum:
            assert task.settings is not None
            return precise_extremum(
                chart, float(task.mu), task.guess, digits=task.digits, settings=task.settings, progress=progress
            )
        return precise_breaking(
            chart, task.mu, task.guess, digits=task.digits, settings=task.settings, progress=progress
        )
    except PrecisionFailure as failure:
        return failure


def _with(curve: CurveRecord, task: _Task, point: PrecisePoint, near: PointRecord) -> CurveRecord:
    """The curve with one more point in high precision; it replaces an older one of the same place."""
    settings = SettingsRecord(point.settings.bits, point.settings.order, point.settings.tolerance)
    digits = task.digits + _EXTRA_DIGITS
    if task.is_extremum:
        assert point.jacobi_curvature is not None
        curvature = float(point.jacobi_curvature)
        extremum = ExtremumRecord(
            kind="minimum" if curvature > 0 else "maximum",
            mu=rounded(point.mu, task.digits),
            mu_exact=point.mu,
            x=point.x,
            vy=point.vy,
            half_period=point.half_period,
            jacobi_constant=rounded(point.jacobi_constant, digits),
            jacobi_second_derivative=curvature,
            digits=task.digits,
            settings=settings,
            residual=point.residual,
            change=point.derivative_change,
        )
        others = [row for row in curve.extrema if abs(float(row.mu / extremum.mu) - 1) > 1e-8]
        return replace(curve, extrema=tuple(sorted([*others, extremum], key=lambda row: -row.mu)))
    record = PreciseRecord(
        mu=point.mu,
        x=point.x,
        vy=point.vy,
        half_period=point.half_period,
        jacobi_constant=rounded(point.jacobi_constant, digits),
        jacobi_derivative=rounded(point.jacobi_derivative, task.digits),
        digits=task.digits,
        settings=settings,
        residual=point.residual,
        change=point.derivative_change,
        float64_error=_float64_error(chart_of(curve.libration), point, near),
    )
    kept = [row for row in curve.precise if row.mu != record.mu]
    return replace(curve, precise=tuple(sorted([*kept, record], key=lambda row: -row.mu)))


def _float64_error(chart: MassChart, point: PrecisePoint, near: PointRecord) -> float:
    unit = chart.unit(float(point.mu))
    place = (float(point.x - chart.origin_exact(point.mu)) / unit, float(point.vy) / unit)
    return max(abs(a - b) for a, b in zip(place, near.scaled, strict=True))


def _print(request: MassCurveRequest, curves: dict[str, CurveRecord]) -> None:
    """The result table, on standard output: points at given masses and extrema, or else the ends of the curves."""
    lines: list[tuple[str, ...]] = [("point", "mu", "x", "vy", "half period", "Jacobi constant", "dC/dmu", "")]
    for libration in request.points:
        curve = curves.get(libration)
        if curve is None:
            continue
        for row in curve.precise:
            slope, note = f"{float(row.jacobi_derivative):.12g}", f"float64 error {row.float64_error:.1e}"
            level = decimal_text(row.jacobi_constant)
            lines.append(_line(libration, f"{float(row.mu):.12g}", row.x, row.vy, row.half_period, level, slope, note))
        for turn in curve.extrema:
            mu, level = decimal_text(turn.mu), decimal_text(turn.jacobi_constant)
            lines.append(_line(libration, mu, turn.x, turn.vy, turn.half_period, level, "0", turn.kind))
        if not curve.precise and not curve.extrema:
            for end in (curve.points[0], curve.points[-1]):
                mu, slope = f"{end.mu:.12g}", f"{end.jacobi_derivative:.12g}"
                lines.append(
                    _line(libration, mu, end.x, end.vy, end.half_period, f"{end.jacobi_constant:.15g}", slope, "")
                )
    if len(lines) == 1:
        return
    titles = [title.replace(" ", "_") or "note" for title in lines[0]]
    tell("\n".join(fitted(lines)), [dict(zip(titles, line, strict=True)) for line in lines[1:]])


def _line(
    libration: str,
    mu: str,
    x: Fraction | float,
    vy: Fraction | float,
    half_period: float,
    level: str,
    slope: str,
    note: str,
) -> tuple[str, ...]:
    return libration, mu, f"{float(x):.12g}", f"{float(vy):.12g}", f"{half_period:.10g}", level, slope, note
