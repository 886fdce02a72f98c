"""The search from start to end: trace families, detect resonances, refine them, write files."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from explore.arguments import Request
from explore.continuation import Family
from explore.detection import LocatedResonance, detect
from explore.families import FamilyFailure, Limits, continue_family, trace_family
from explore.family_file import FamilyRecord, OrbitRecord, ResonanceRecord, read_families, write_families
from explore.flow import Vector
from explore.progress import Reporter
from explore.refining import Refined, Task, refine_tasks
from explore.shooting import ShootingProblem, SymmetricOrbit
from explore.stability import Side
from shared.formats import Candidate, InputError, read_candidates, write_candidates
from shared.systems import ReversibleSystem


@dataclass(frozen=True)
class TracedFamily:
    """A family with the name under which it was asked for and the resonances found on it."""

    name: str
    label: str
    family: Family
    resonances: tuple[LocatedResonance, ...] = ()

    @property
    def system(self) -> ReversibleSystem:
        """The family's system."""
        return self.family.problem.system


@dataclass(frozen=True)
class Row:
    """A line of the result table."""

    item: TracedFamily
    k: int
    kind: str
    point: Vector
    level: float | Fraction
    side: Side
    id: str


def run(request: Request) -> int:
    """Do what a checked command line asks for; returns the exit code. Raises `InputError`."""
    options = request.options
    kept: list[Candidate] = []
    if request.command == "candidates" and options.append and options.output.exists():
        kept = read_candidates(options.output)
    resumed = _resumed(request)
    limits = Limits(
        max_orbits=options.max_orbits,
        coordinate_max={} if options.z_max is None else {"z": options.z_max},
        parameter_min=options.beta_min,
        parameter_max=options.beta_max,
        integral_min=options.jacobi_min,
        min_distance=options.min_distance,
    )
    with Reporter(options.quiet) as report:
        code, rows = _search(request, resumed, limits, kept, report)
    # Only now: a running progress display would take what is printed to standard output.
    _print_rows(rows)
    return code


def _search(
    request: Request, resumed: list[TracedFamily], limits: Limits, kept: list[Candidate], report: Reporter
) -> tuple[int, list[Row]]:
    """Trace, detect, refine and write; the exit code and the lines of the result table."""
    traced, complete = _trace_all(request, resumed, limits, report)
    if request.family_output is not None and traced:
        write_families(request.family_output, [_record(family) for family in traced])
        report.message(f"families written to {request.family_output}")
    if any(family.family.outcome == "interrupted" for family in traced):
        where = f"resume with --from-family {request.family_output}" if request.family_output else "nothing is written"
        report.error(f"interrupted while tracing; {where}")
        return 130, []
    if request.command == "family":
        return (0 if complete else 1), [row for family in traced for row in _float_rows(family)]
    code, rows = _refine_all(request, traced, kept, report)
    return max(code, 0 if complete else 1), rows


def _resumed(request: Request) -> list[TracedFamily]:
    if request.options.from_family is None:
        return []
    records = read_families(request.options.from_family)
    wrong = next((record for record in records if request.system not in (None, record.system)), None)
    if wrong is not None and request.system is not None:
        raise InputError(
            f"--system {request.system.name}: {request.options.from_family} holds a family of {wrong.system.name}; "
            "leave the option out"
        )
    return [TracedFamily(record.name, record.label, family_of(record)) for record in records]


def _trace_all(
    request: Request, resumed: list[TracedFamily], limits: Limits, report: Reporter
) -> tuple[list[TracedFamily], bool]:
    """All families with their resonances; False if something asked for is missing.

    An interrupt ends the list with the family at hand, marked as interrupted, if it has orbits.
    """
    traced: list[TracedFamily] = []
    complete = True
    for index, name in enumerate([item.name for item in resumed] or request.families):
        report.stage(name)
        started = time.monotonic()
        try:
            item = _trace(request, name, resumed[index] if resumed else None, limits, report)
        except FamilyFailure as error:
            report.error(f"{name}: {error}")
            complete = False
            continue
        family = item.family
        seconds = time.monotonic() - started
        report.message(f"{item.name}: {len(family.orbits)} orbits in {seconds:.1f} s, ends: {family.reason}")
        complete = complete and family.outcome != "failed"
        if family.outcome != "interrupted" and request.options.k:
            try:
                item, found = _detected(item, request.options.k, report)
                complete = complete and found
            except KeyboardInterrupt:
                item = replace(item, family=replace(family, outcome="interrupted"))
        traced.append(item)
        if item.family.outcome == "interrupted":
            break
    return traced, complete


def _trace(request: Request, name: str, resumed: TracedFamily | None, limits: Limits, report: Reporter) -> TracedFamily:
    known_extent = bool(limits.coordinate_max)

    def progress(message: str, fraction: float) -> None:
        report.update(message, fraction if known_extent else None)

    if resumed is not None:
        known_extent = known_extent or resumed.system.family_parameter is not None
        return replace(resumed, family=continue_family(resumed.family, limits, progress=progress))
    assert request.system is not None
    known_extent = known_extent or request.system.family_parameter is not None
    mirrored = request.options.mirror
    family = trace_family(request.system, name, request.parameters, limits, mirrored=mirrored, progress=progress)
    return TracedFamily(_mirrored_name(name, mirrored), request.label, family)


def _mirrored_name(name: str, mirrored: bool) -> str:
    return f"{name}-mirror" if mirrored and name.endswith("halo") else name


def _detected(item: TracedFamily, multiplicities: list[int], report: Reporter) -> tuple[TracedFamily, bool]:
    family = item.family
    report.stage(f"{item.name}: resonances")
    length = family.orbits[-1].arclength or 1.0
    detection = detect(family, multiplicities, progress=lambda place: report.update("", place / length))
    complete = not detection.undecided
    for line in detection.undecided:
        report.error(f"{item.name}: {line}")
    for k in sorted(set(multiplicities) - {resonance.k for resonance in detection.resonances}):
        what = "symmetry breaking" if k == 1 else f"1:{k} resonance"
        report.error(f"{item.name}: no {what} found on the part traced; it ends: {family.reason}")
        complete = False
    return replace(item, resonances=detection.resonances), complete


def _refine_all(
    request: Request, traced: list[TracedFamily], kept: list[Candidate], report: Reporter
) -> tuple[int, list[Row]]:
    options = request.options
    targets = [(item, *target) for item in traced for target in _targets(item, options.both_points)]
    tasks = [_task(item, resonance, side, id, options.digits) for item, resonance, side, id in targets]
    done: dict[int, Refined] = {}
    code = 0
    try:
        if tasks:
            report.stage("refining")
        for index, result in refine_tasks(tasks, options.jobs, report.update):
            if result.failure is not None:
                report.error(f"{result.task.id}: not refined: {result.failure}")
                code = 1
                continue
            done[index] = result
            report.message(f"{result.task.id}: refined to {options.digits} digits in {result.seconds:.1f} s")
    except KeyboardInterrupt:
        report.error(f"interrupted; {len(done)} of {len(tasks)} points are refined")
        code = 130
    candidates = [done[index].candidate for index in sorted(done)]
    fresh = {candidate.id for candidate in candidates}
    everything = [candidate for candidate in kept if candidate.id not in fresh] + candidates
    if not candidates:
        report.error(f"no candidates found; nothing is written to {options.output}")
        return code or 1, []
    write_candidates(options.output, everything)
    report.message(f"{len(candidates)} candidates written to {options.output} ({len(everything)} in the file)")
    rows: list[Row] = []
    for index in sorted(done):
        item, resonance, side, id = targets[index]
        point = np.array([float(value) for value in done[index].candidate.centre])
        rows.append(Row(item, resonance.k, resonance.kind, point, done[index].level, side, id))
    return code, rows


def _task(item: TracedFamily, resonance: LocatedResonance, side: Side, id: str, digits: int) -> Task:
    guess = resonance.orbit.centre(side)
    return Task(
        id=id, system=item.system.name, parameters=dict(item.family.problem.parameters), kind=resonance.kind,
        k=resonance.k, symmetry=resonance.symmetry, guess=tuple(float(value) for value in guess), digits=digits,
        provenance=_provenance(item, resonance, side, guess),
    )  # fmt: skip


def _targets(item: TracedFamily, both_points: bool) -> list[tuple[LocatedResonance, Side, str]]:
    """The points to refine, with an id that does not depend on which other k were asked for."""
    label = "-".join(part for part in (item.label or item.system.name, item.name) if part)
    counts: dict[int, int] = {}
    result: list[tuple[LocatedResonance, Side, str]] = []
    for resonance in item.resonances:
        counts[resonance.k] = counts.get(resonance.k, 0) + 1
        id = f"{label}-k{resonance.k}-{counts[resonance.k]}"
        result.append((resonance, resonance.side, id))
        if both_points and resonance.other_side and resonance.k > 1:
            result.append((resonance, "second", f"{id}-second"))
    return result


def _provenance(item: TracedFamily, resonance: LocatedResonance, side: Side, guess: Vector) -> Mapping[str, Any]:
    return {
        "family": item.name,
        "parameters": item.label,
        "point_on_fix_r": side,
        "float64_point": [float(value) for value in guess],
        "float64_first_integral": resonance.orbit.first_integral,
        "stability_parameters": [[value.real, value.imag] for value in resonance.orbit.stability],
        "resonant_value": resonance.value,
        "arclength": resonance.orbit.arclength,
    }


def _float_rows(item: TracedFamily) -> list[Row]:
    rows: list[Row] = []
    for resonance, side, id in _targets(item, False):
        orbit = resonance.orbit
        level = orbit.first_integral if orbit.first_integral is not None else float(orbit.unknowns[0])
        rows.append(Row(item, resonance.k, resonance.kind, resonance.point, level, side, id))
    return rows


def _print_rows(rows: list[Row]) -> None:
    """The result table, on standard output."""
    if not rows:
        return
    system = rows[0].item.system
    title = system.first_integral_name or system.family_parameter or "parameter"
    header = ("family", "k", "kind", "on Fix(R)", title, ", ".join(system.centre_coordinates), "id")
    lines = [header]
    for row in rows:
        point = ", ".join(f"{value:.10g}" for value in row.point)
        lines.append((row.item.name, str(row.k), row.kind, row.side, _decimal(row.level), point, row.id))
    widths = [max(len(line[i]) for line in lines) for i in range(len(header))]
    for line in lines:
        print("  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)).rstrip())


def _decimal(value: float | Fraction, digits: int = 20) -> str:
    """A number in decimal notation, float64 to 12 digits, exact ones rounded to `digits` places."""
    if isinstance(value, float):
        return f"{value:.12g}"
    scaled = round(value * 10**digits)
    whole, part = divmod(abs(scaled), 10**digits)
    return f"{'-' if scaled < 0 else ''}{whole}.{part:0{digits}d}"


def _record(item: TracedFamily) -> FamilyRecord:
    family = item.family
    return FamilyRecord(
        name=item.name,
        label=item.label,
        system=item.system,
        parameters=family.problem.parameters,
        symmetry=family.problem.symmetry,
        scale=tuple(float(value) for value in family.problem.scales),
        outcome=family.outcome,
        reason=family.reason,
        orbits=tuple(
            OrbitRecord(
                arclength=orbit.arclength,
                point=orbit.centre("first"),
                second_point=orbit.centre("second"),
                half_period=orbit.half_period,
                first_integral=orbit.first_integral,
                stability=orbit.stability,
                coefficients=orbit.coefficients,
                tangent=tangent,
                crossings=orbit.crossings,
            )
            for orbit, tangent in zip(family.orbits, family.tangents, strict=True)
        ),
        resonances=tuple(
            ResonanceRecord(
                k=resonance.k,
                kind=resonance.kind,
                side=resonance.side,
                point=resonance.point,
                arclength=resonance.orbit.arclength,
                first_integral=resonance.orbit.first_integral,
                stability_parameter=resonance.value,
            )
            for resonance in item.resonances
        ),
    )


def family_of(record: FamilyRecord) -> Family:
    """A family from a file, ready to be searched and continued."""
    problem = ShootingProblem(record.system, record.parameters, record.symmetry, record.scale)
    fixed = len(record.system.fixed_coordinates)
    orbits = tuple(
        SymmetricOrbit(
            unknowns=np.append(orbit.point, orbit.half_period),
            second_point=orbit.second_point[-fixed:],
            first_integral=orbit.first_integral,
            coefficients=orbit.coefficients,
            arclength=orbit.arclength,
            crossings=orbit.crossings,
        )
        for orbit in record.orbits
    )
    tangents = tuple(orbit.tangent for orbit in record.orbits)
    return Family(problem, orbits, tangents, record.outcome, record.reason)  # type: ignore[arg-type]
