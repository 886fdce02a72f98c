"""The search from start to end: trace families, detect resonances, refine them, write files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import (
    Limits,
    Traced,
    TracedFamily,
    TraceTask,
    family_of,
    largest_changes,
    limited_names,
    trace_tasks,
)
from orbitproof.explore.flow import Vector
from orbitproof.explore.names import bounds_of
from orbitproof.explore.records import BAND, FamilyRecord, read_families
from orbitproof.explore.refinement import refine_tasks
from orbitproof.explore.search.branches import branches_of, shared_branches
from orbitproof.explore.search.outputs import write_catalogue, write_outputs, write_traced
from orbitproof.explore.search.request import FamilyRequest, Request
from orbitproof.explore.search.targets import Target, is_refined, merged, targets_of
from orbitproof.explore.three_body.catalogues import CatalogueStart, catalogue_start
from orbitproof.explore.three_body.families import branch_of, by_name
from orbitproof.explore.three_body.names import DEFAULT_BRANCH, name_on
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import Candidate, InputError, read_candidates, write_candidates
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.printed_tables import aligned, terminal_width, wrapped
from orbitproof.shared.systems import FALKNER_SKAN, THREE_BODY, ReversibleSystem, shown
from orbitproof.shared.wording import counted

_WORTH_TELLING = 1e-9
"""An error of a stability parameter from which on it is told: resonances are located as exactly as that."""


@dataclass(frozen=True)
class Row:
    """A line of the result table."""

    target: Target
    point: Vector
    level: float | str


def search(request: Request) -> int:
    """Do what a checked command line asks for; returns the exit code. Raises `InputError`."""
    options = request.options
    kept: list[Candidate] = []
    if request.command == "candidates" and options.append and options.output.is_file():
        kept = read_candidates(options.output)
    lines: tuple[str, ...] = ()
    with Reporter(options.quiet) as report:
        if options.from_catalogue is None:
            tasks, complete = _trace_tasks(request), True
        else:
            start = catalogue_start(
                options.from_catalogue, options.catalogue_orbit, request.control.tolerance, report, options.accept
            )
            tasks, lines, complete = _catalogue_tasks(request, start), start.table, start.complete
            if start.corrected is not None:
                write_catalogue(start.corrected, start.name, *_catalogue_paths(request), report)
        code, rows = _search(request, tasks, kept, report) if tasks else (1, [])
    # Only now: a running progress display would take what is printed to standard output.
    if lines:
        tell("\n".join(lines), [{"catalogue": lines}])
    _print_rows(rows)
    return code or (0 if complete else 1)


def _search(request: Request, tasks: list[TraceTask], kept: list[Candidate], report: Reporter) -> tuple[int, list[Row]]:
    """Trace, detect, refine and write; the exit code and the lines of the result table."""
    (results, interrupted), unlocated = _trace_all(tasks, request.options.jobs, report), False
    if request.options.branches and not interrupted:
        branches = branches_of(results, request.options.branch or DEFAULT_BRANCH)
        if branches.tasks:
            more, interrupted = _trace_all(branches.tasks, request.options.jobs, report)
            results += more
        for line in shared_branches(results):
            report.message(line)
        for line in branches.failures:
            report.error(line)
        unlocated = bool(branches.failures)
    traced = [result.item for result in results if result.item is not None]
    complete = False not in [_is_complete(result, report) for result in results] and not unlocated
    if traced:
        write_outputs(traced, request.family_output, report)
        if request.options.from_catalogue is None:
            write_traced(traced, *_catalogue_paths(request), report)
    if interrupted:
        written = request.family_output is not None and traced
        where = f"resume with --from-family {request.family_output}" if written else "nothing is written"
        report.error(f"interrupted while tracing; {where}")
        return INTERRUPTED, []
    if request.command == "family":
        return (0 if complete else 1), [row for item in traced for row in _float_rows(item)]
    code, rows = _refine_all(request, traced, kept, report)
    return max(code, 0 if complete else 1), rows


def _catalogue_paths(request: Request) -> tuple[Path | None, Path | None]:
    """Where orbits go in the catalogue's forms, CSV and JSON, if anywhere."""
    return getattr(request.options, "csv", None), getattr(request.options, "catalogue", None)


def _catalogue_tasks(request: Request, start: CatalogueStart) -> list[TraceTask]:
    if start.seed is None:
        return []
    options, problem = request.options, start.seed.problem
    asked = FamilyRequest(problem.system, start.name, problem.parameters, start.label)
    limits = _limits(options, problem.system, options.vy_max[0] if options.vy_max else None)
    return [_trace_task(request, asked, limits, start=start.seed, both_ways=True, of_catalogue=True)]


def _trace_tasks(request: Request) -> list[TraceTask]:
    """The families to trace, those of a family file from where they end. Raises `InputError`."""
    options = request.options
    records = [] if options.from_family is None else read_families(options.from_family)
    wrong = next((record for record in records if request.systems and record.system not in request.systems), None)
    if wrong is not None:
        names = " ".join(system.name for system in request.systems)
        raise InputError(
            f"--system {names}: {options.from_family} holds a family of {wrong.system.name}; leave the option out"
        )
    foreign = next((record.system.name for record in records if record.system not in THREE_BODY), None)
    option = next((f"--{name}" for name in ("csv", "catalogue") if getattr(options, name, None) is not None), None)
    if option is not None and foreign is not None:
        raise InputError(
            f"{option}: {options.from_family} holds a family of {foreign}, and the catalogue's columns are those "
            "of the CR3BP; leave the option out"
        )
    if not request.families:
        speed = options.vy_max[0] if options.vy_max else None
        return [
            _trace_task(
                request,
                record,
                _limits(options, record.system, speed),
                start=family_of(record),
                both_ways=len(record.orbits) == 1 and record.beginning is None,
            )
            for record in records
        ]
    return [_task(request, family, records) for family in request.families]


def _task(request: Request, family: FamilyRequest, records: list[FamilyRecord]) -> TraceTask:
    branch = request.options.branch or DEFAULT_BRANCH
    name = family.name if family.first is not None else name_on(family.name, branch)
    limits = _limits(request.options, family.system, family.velocity_max, family.z_max)
    for record in records:
        if record.name == name and dict(record.parameters) == dict(family.parameters):
            return _trace_task(request, record, limits, family.multiplicities, start=family_of(record))
    asked, start = replace(family, name=name), family.first or by_name(family.name, branch)
    return _trace_task(request, asked, limits, family.multiplicities, start=start)


def _trace_task(
    request: Request,
    family: FamilyRequest | FamilyRecord,
    limits: Limits,
    multiplicities: tuple[int, ...] | None = None,
    **more: Any,
) -> TraceTask:
    return TraceTask(
        system=family.system,
        name=family.name,
        label=family.label,
        parameters=dict(family.parameters),
        limits=limits,
        multiplicities=request.multiplicities if multiplicities is None else multiplicities,
        folds=request.options.folds,
        control=request.control,
        sampling_timeout=request.options.sampling_timeout,
        **more,
    )


def _limits(options: Any, system: ReversibleSystem, velocity_max: float | None, z_max: float | None = None) -> Limits:
    bounds = {"z": options.z_max if z_max is None else z_max, "vy": velocity_max}
    beta = (options.beta_min, options.beta_max) if system is FALKNER_SKAN else (-inf, inf)
    return Limits(
        max_orbits=options.max_orbits,
        coordinate_max={name: bound for name, bound in bounds.items() if bound is not None},
        parameter_min=beta[0],
        parameter_max=beta[1],
        bounds=bounds_of(limited_names(system), options.parameter_min, options.parameter_max),
        integral_min=options.jacobi_min,
        min_distance=options.min_distance,
    )


def _trace_all(tasks: Sequence[TraceTask], jobs: int, report: Reporter) -> tuple[list[Traced], bool]:
    """The results in the order of the tasks, and whether there was an interrupt; fewer of them then."""
    report.stage(", ".join(task.title for task in tasks) if len(tasks) < 3 else f"{len(tasks)} families")
    results: dict[int, Traced] = {}
    interrupted = False
    try:
        for index, result in trace_tasks(tasks, jobs, report.update):
            if result.item is not None:
                result = replace(result, item=replace(result.item, branch=branch_of(result.item.family)))
            results[index] = result
            if result.item is not None:
                family, seconds = result.item.family, result.seconds
                side = "" if result.item.branch is None else f"{result.item.branch}ern "
                many = counted(len(family.orbits), f"{side}orbit")
                report.message(f"{result.item.title}: {many}, ends: {family.reason}")
                if family.beginning is not None:
                    report.message(f"{result.item.title}: begins: {family.beginning.reason}")
                for line in family.tangencies:
                    report.message(f"{result.item.title}: {line}")
                found = len(result.item.detection.resonances)
                report.message(f"{result.item.title}: {found} resonances, {seconds:.1f} s{_density(result.item)}")
                for target in targets_of(result.item, "one"):
                    report.message(f"{target.id}: {_in_words(target, f'{_float_level(target):.8g}')}")
    except KeyboardInterrupt:
        interrupted = True
    found = [results[index] for index in sorted(results)]
    return found, interrupted or any(result.interrupted for result in found)


def _density(item: TracedFamily) -> str:
    samples = item.detection.samples
    if not samples:
        return ""
    change = largest_changes([orbit.coefficients[1:] for orbit in samples])
    error = item.detection.error
    rounding = f" and are known to about {error:.0e}" if error > _WORTH_TELLING else ""
    band = f"stability parameters in [-{BAND}, {BAND}]"
    return f"; {counted(len(samples), 'sample')}, {band} change by {change:.2g} at most{rounding}"


def _is_complete(result: Traced, report: Reporter) -> bool:
    """Whether everything asked for was found; what was not is reported."""
    item = result.item
    if item is None:
        if not result.interrupted:
            report.error(f"{result.task.title}: {result.failure}")
        return False
    if result.interrupted:
        return False
    # Of the family of a catalogue's row as much is asked for as can be followed; where it ends is said.
    asked = result.task.multiplicities or result.task.folds or not result.task.of_catalogue
    complete = not (asked and item.family.failed) and not item.detection.undecided
    for line in item.detection.undecided:
        report.error(f"{item.title}: {line}")
    found = {resonance.k for resonance in item.detection.resonances if not resonance.is_fold}
    if result.task.folds and not any(resonance.is_fold for resonance in item.detection.resonances):
        report.error(f"{item.title}: no fold found on the part traced; it ends: {item.family.reason}")
        complete = False
    for k in sorted(set(result.task.multiplicities) - found):
        what = "symmetry breaking" if k == 1 else f"1:{k} resonance"
        report.error(f"{item.title}: no {what} found on the part traced; it ends: {item.family.reason}")
        complete = False
    return complete


def _refine_all(
    request: Request, traced: list[TracedFamily], kept: list[Candidate], report: Reporter
) -> tuple[int, list[Row]]:
    """Refine what the output file does not hold yet; every point is written as soon as it is refined."""
    options = request.options
    known = {candidate.id: candidate for candidate in kept}
    targets = [target for item in traced for target in targets_of(item, request.points)]
    tasks = [target.task(options.digits) for target in targets]
    done = {i: known[task.id] for i, task in enumerate(tasks) if task.id in known and is_refined(task, known[task.id])}
    missing = [i for i in range(len(tasks)) if i not in done]
    if done:
        report.message(f"refined in {options.output} already: {counted(len(done), 'point')}")
    new: dict[int, Candidate] = {}
    code = 0
    try:
        if missing:
            report.stage(f"refining {counted(len(missing), 'point')}")
        for position, result in refine_tasks([tasks[i] for i in missing], options.jobs, report.update):
            if result.candidate is None:
                report.error(f"{result.task.id}: not refined: {result.failure}")
                code = 1
                continue
            found = new | {missing[position]: result.candidate}
            write_candidates(options.output, merged(kept, [found[i] for i in sorted(found)]))
            new = found
            level = _exact_row(targets[missing[position]], result.candidate).level
            told = _in_words(targets[missing[position]], level[:20] if isinstance(level, str) else f"{level:.12g}")
            how = f"refined to {options.digits} digits in {result.seconds:.1f} s"
            report.message(f"{result.task.id}: {told}, {how}")
    except KeyboardInterrupt:
        resume = "; the same command with --append goes on from there" if done or new else ""
        report.error(f"interrupted; {len(done) + len(new)} of {len(tasks)} points are refined{resume}")
        code = INTERRUPTED
    done |= new
    if not done:
        if code != INTERRUPTED:
            report.error(f"no candidates found; nothing is written to {options.output}")
        return code or 1, []
    total = len(merged(kept, list(new.values())))
    report.message(f"{counted(len(new), 'candidate')} written to {options.output} ({total} in the file)")
    return code, [_exact_row(targets[i], done[i]) for i in sorted(done)]


def _exact_row(target: Target, candidate: Candidate) -> Row:
    level = candidate.provenance.get("level")
    point = np.array([float(value) for value in candidate.centre])
    return Row(target, point, level if isinstance(level, str) else _float_level(target))


def _float_level(target: Target) -> float:
    orbit = target.resonance.orbit
    if target.item.system.family_parameter is not None or orbit.first_integral is None:
        return float(orbit.unknowns[0])
    return orbit.first_integral


def _in_words(target: Target, level: str) -> str:
    """What was found, with its level or parameter, for a message."""
    resonance = target.resonance
    name = target.item.system.family_parameter or target.item.system.first_integral_name or "parameter"
    return f"{kind_in_words(resonance.k, resonance.kind)} (k = {resonance.k}), {name} = {level}"


def _float_rows(item: TracedFamily) -> list[Row]:
    return [Row(target, target.guess, _float_level(target)) for target in targets_of(item, "one")]


def _print_rows(rows: list[Row]) -> None:
    """The result table, on standard output, one for each system."""
    for name in dict.fromkeys(row.target.item.system.name for row in rows):
        _print_table([row for row in rows if row.target.item.system.name == name])


_KINDS = {"touch_and_go": "touch-and-go"}


def kind_in_words(k: int, kind: str) -> str:
    """A kind of bifurcation as tables have it."""
    return "period doubling" if (k, kind) == (2, "period_tupling") else _KINDS.get(kind, kind.replace("_", " "))


def _print_table(rows: list[Row]) -> None:
    """Rows of one system as a table or, where that is wider than the terminal, as blocks like those of the verifier."""
    system = rows[0].target.item.system
    title = system.family_parameter or system.first_integral_name or "parameter"
    with_sides = any(row.target.item.branch for row in rows)
    lines = [["family", "branch", "k", "kind", "on Fix(R)", title, ", ".join(system.centre_coordinates), "id"]]
    blocks: list[str] = []
    for row in rows:
        resonance, item, name = row.target.resonance, row.target.item, shown(row.target.id)
        values = [f"{value:.10g}" for value in row.point]
        level = row.level if isinstance(row.level, str) else f"{row.level:.12g}"
        level = level[: level.index(".") + 21] if "." in level else level
        kind, k = kind_in_words(resonance.k, resonance.kind), str(resonance.k)
        lines.append([item.title, item.branch or "", k, kind, row.target.side, level, ", ".join(values), name])
        place = ", ".join(f"{x} = {y}" for x, y in zip(system.centre_coordinates, values, strict=True))
        blocks += [f"{name}: {kind} (k = {k})", f"  {title} = {level}"]
        blocks.append(f"  at {place}, the {row.target.side} point on Fix(R)")
    if not with_sides:
        for line in lines:
            del line[1]
    table = aligned(lines)
    fits = max(map(len, table)) <= terminal_width()
    tell("\n".join(table) if fits else wrapped(blocks), list(map(_as_json, rows)))


def _as_json(row: Row) -> dict[str, Any]:
    """A line of the result table for programs; the parameter with all digits that are known of it."""
    resonance, item, system = row.target.resonance, row.target.item, row.target.item.system
    return {
        "id": row.target.id,
        "family": item.title,
        "branch": item.branch,
        "k": resonance.k,
        "kind": resonance.kind,
        "fix_r": row.target.side,
        "parameter_name": system.family_parameter or system.first_integral_name,
        "parameter": row.level,
        "point": dict(zip(system.centre_coordinates, row.point.tolist(), strict=True)),
    }
