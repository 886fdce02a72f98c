"""``orbitproof explore orbit``: one symmetric orbit, corrected; or to many digits, as a claim for the verifier."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import dist, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands import common
from orbitproof.explore.commands.orbit_lines import tell_corrected, tell_refined
from orbitproof.explore.commands.orbit_options import equation_of, kind_of
from orbitproof.explore.names import label_of, system_named
from orbitproof.explore.three_body.names import (
    families_to_give,
    family_name,
    given_parameters,
    has_branches,
    is_family_name,
    mass_name,
    name_on,
    on_branch,
    system_with,
)
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import (
    HALF_PERIOD,
    Candidate,
    Equation,
    InputError,
    check_writable,
    read_candidates,
    write_candidates,
)
from orbitproof.shared.help_text import add_command
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.shared.wording import counted

if TYPE_CHECKING:
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.families import Family, TracedFamily
    from orbitproof.explore.orbits import SymmetricOrbit
    from orbitproof.explore.records import FamilyRecord
    from orbitproof.explore.refinement import OrbitTask
    from orbitproof.explore.seeds import FirstOrbit

_GOES_ON = "; the same command goes on from there"
_EXAMPLES = """\
examples:
  orbitproof explore orbit --system mine.py --start c=0.1 y=0.2
  orbitproof explore orbit --system cr3bp --mass earth-moon --start x=0.8234 z=0 vy=0.126 -o orbit.json
  orbitproof explore family --from-family orbit.json --parameter-max x 0.83 -o family.json
  orbitproof explore orbit --family L2-halo --mass earth-moon --branch north --period 1.5 -o candidate.json
  orbitproof explore orbit --family L2-halo --mass 0.01215 --period 'synodic_month*2/9' -o candidate.json
  orbitproof explore orbit --from-family families.json --family earth-moon-L2-halo --extrema -o extrema.json
  orbitproof explore orbit --family L2-vertical --mass earth-moon --at z=0.1 -o vertical.json
  orbitproof explore orbit --system henon-heiles.py --start y=0.1 vx=0.1 --at y=0.1 --stable -o stable.json
  orbitproof explore orbit --family L2-halo --mass earth-moon --period 1.36 --tori -o tori.json
  orbitproof explore orbit --from-catalogue halo.json --every 10 -o candidates.json
  orbitproof explore orbit --from-catalogue halo.json --certificates certificates.json
  orbitproof verify candidate.json -o certificate.json

With --start alone the orbit is corrected in float64; its family is traced, both ways, from the file that -o writes, or
by explore family with the same options. With --period, --level, --at or --extrema, or with a catalogue, orbits are
refined to many digits, and -o is a candidates file: orbitproof verify proves that they exist, with --stable that they
are stable for ever (n = 1), with --tori that invariant tori accumulate at them (n = 2; not stability). Three orbits at
each extremum of a stability parameter give orbitproof verify atlas --complete its value to some 14 digits. An
interrupted run goes on with the same command. Exit codes: 0 corrected, 1 not, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    meaning = "one symmetric orbit: corrected, or to many digits for the verifier"
    parser = add_command(commands, "orbit", meaning, _EXAMPLES)
    common.add_start(parser)
    parser.add_argument(
        "--mass", type=mass_name, nargs=1, metavar="MU", help="mass parameter of the CR3BP: a name or a number"
    )
    parser.add_argument(
        "--family",
        nargs=1,
        type=family_name,
        metavar="NAME",
        help="the family of the orbit; with --start the name to give its family",
    )
    common.add_branch(parser)
    parser.add_argument("--from-family", type=Path, metavar="FILE", help="take the orbit from a family in this file")
    parser.add_argument("--from-catalogue", type=Path, metavar="FILE", help="orbits near rows of a catalogue file")
    parser.add_argument(
        "--catalogue-orbit", type=common.index, nargs="+", metavar="N", help="these rows, counted from 1 (default: all)"
    )
    parser.add_argument("--every", type=common.index, metavar="N", help="every N-th row: 1, 1 + N, 1 + 2 N, ..")
    common.add_accept(parser)
    parser.add_argument(
        "--certificates",
        type=Path,
        metavar="FILE",
        help="with --from-catalogue: compare certified orbits with their rows, search for none",
    )
    wanted = parser.add_argument_group(
        "what singles out the orbit: a number, or arithmetic with numbers, taken exactly as written"
    )
    wanted.add_argument(
        "--period",
        metavar="P",
        help="its period; with a mass of the catalogue also 6.5d or 12h; for orbits of the Earth-Moon system "
        "synodic_month and sidereal_month may stand in it",
    )
    wanted.add_argument("--level", metavar="H", help="its value of the first integral")
    wanted.add_argument(
        "--at", metavar="NAME=VALUE", help="a coordinate of its point on Fix(R), or the family parameter"
    )
    wanted.add_argument(
        "--extrema",
        action="store_true",
        help="at each extremum of a stability parameter that the family file lists, and on both sides close to it",
    )
    wanted.add_argument(
        "--stable",
        action="store_true",
        help="claim that it is stable for ever: for systems with n = 1, planar problems",
    )
    wanted.add_argument(
        "--tori",
        action="store_true",
        help="claim that invariant tori accumulate at it, which is not stability: for systems with n = 2",
    )
    parser.add_argument("--digits", type=common.digits, default=50, metavar="N", help="default: %(default)s")
    parser.add_argument("--id", metavar="NAME", help="of the candidate (default: mass and family)")
    common.add_output(parser, "family file of this orbit, or candidates file", required=False)
    common.add_jobs(parser, ": orbits refined at the same time")
    common.add_quiet(parser)
    parser.set_defaults(run=run, vy_max=None)


def run(options: argparse.Namespace) -> int:
    """Correct or refine, print and write; returns the exit code. Raises `InputError`."""
    if options.output is not None:
        check_writable(options.output)
    if options.extrema:
        return _extrema(options)
    if options.from_catalogue is not None:
        return _catalogue(options)
    if options.branch is not None and (options.from_family is not None or options.start is not None):
        raise InputError("--branch: the start says which orbits; leave it out")
    for option in ("certificates", "catalogue_orbit", "every"):
        if getattr(options, option) is not None:
            raise InputError(f"--{option.replace('_', '-')}: belongs to --from-catalogue; give that too")
    if options.from_family is not None:
        return _of_families(options, None)
    if options.system is None:
        of_family = None if options.start else system_with(options.family or ())
        options.system = of_family or ("cr3bp" if options.mass is not None else None)
    if options.system is None:
        raise InputError("--system: missing; give one")
    system = system_named(options.system)
    if options.start is None and options.family is not None and is_family_name(system.name, options.family[0]):
        return _of_families(options, system)
    if options.start is None and options.family is not None:
        name = options.family[0]
        raise InputError(f"--family {name}: no family of {system.name}; give {families_to_give(system.name, name)}")
    if options.start is None:
        raise InputError("--start: missing; give one, or the --family that the orbit is of")
    return _started(options, system)


def _started(options: argparse.Namespace, system: ReversibleSystem) -> int:
    """An approximate orbit: corrected, and refined if an equation is given."""
    equation = equation_of(options, system, wanted=options.stable or options.tori)

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.families import CONTROL, FamilyFailure, TracedFamily, family_record, first_family
    from orbitproof.explore.records import write_families
    from orbitproof.explore.refinement import OrbitTask
    from orbitproof.explore.search import started
    from orbitproof.explore.three_body.families import branch_of

    found: list[TracedFamily] = []
    requests = started(options, system)
    held = None
    if equation is not None and equation.coordinate is not None:
        held = equation.coordinate, float(equation.value)
    with Reporter(options.quiet) as report:
        for request in requests:
            assert request.first is not None
            try:
                family = first_family(system, request.parameters, request.first, CONTROL, held)
            except FamilyFailure as error:
                report.error(f"{request.name}: {error}")
                continue
            found.append(TracedFamily(request.name, request.label, family, branch=branch_of(family)))
            if request.first.half_period is not None:
                times = round(request.first.half_period / float(family.orbits[0].half_period))
                if times > 1:
                    report.message(
                        f"{request.name}: the half period given is {times} times that of the orbit, which is taken"
                    )
            moved = _moved(request.first, family.orbits[0])
            if moved > common.WORTH_TELLING:
                report.message(
                    f"{request.name}: the orbit that was found starts {moved:.1%} of the guess's size away from it; "
                    "if another one is meant, give a closer guess and --half-period"
                )
        if equation is not None:
            tasks = [
                OrbitTask(
                    options.id or item.title.replace(" ", "-"), system, item.family.problem.parameters, equation,
                    tuple(map(float, item.family.orbits[0].centre("first"))), options.digits, {},
                    item.family.orbits[0].crossings,
                )
                for item in found
            ]  # fmt: skip
            return _refined(options, tasks, report) if len(found) == len(requests) else 1
        if options.output is not None and found:
            write_families(options.output, [family_record(item) for item in found])
            report.message(f"written to {options.output}")
    for item in found:
        tell_corrected(item)
    return 0 if len(found) == len(requests) else 1


def _moved(first: FirstOrbit, orbit: SymmetricOrbit) -> float:
    """How far an orbit starts from the point that was given, relative to that."""
    size = sqrt(sum(value * value for value in first.point)) or 1.0
    return dist(first.point, [float(value) for value in orbit.unknowns[:-1]]) / size


def _of_families(options: argparse.Namespace, system: ReversibleSystem | None) -> int:
    """Orbits of a family by name, or of one in a file, that satisfy an equation."""
    if options.output is None:
        raise InputError("--output: missing; give the candidates file to write")

    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.families import FamilyFailure

    try:
        with Reporter(options.quiet) as report:
            title, family = _family(options, system, report)
            from orbitproof.explore.search import tasks_of_family
            from orbitproof.explore.three_body.families import branch_of

            equation = equation_of(options, family.problem.system)
            assert equation is not None
            tasks = tasks_of_family(family, equation, options.id or title, options.digits)
            named = on_branch(title, branch_of(family))
            if not tasks:
                report.error(f"{named}: no orbit with {_shown(equation)} on the part traced; it ends: {family.reason}")
                return 1
            report.message(f"{named}: {counted(len(tasks), 'orbit')} with {_shown(equation)}")
            return _refined(options, tasks, report)
    except FamilyFailure as error:
        print(f"{options.family[0]}: {error}", file=sys.stderr)
        return 1


def _family(options: argparse.Namespace, system: ReversibleSystem | None, report: Reporter) -> tuple[str, Family]:
    """The family that is meant, traced or read, and what it is called. Raises `FamilyFailure`, `InputError`."""
    if system is None:
        from orbitproof.explore.families import family_of
        from orbitproof.explore.records import read_families

        records = read_families(options.from_family)
        record = _record(options, records)
        return _full_name(record), family_of(record)
    parameters = given_parameters(system, None if options.mass is None else options.mass[0], options.parameter)
    equation = equation_of(options, system)
    if options.branch is not None and not has_branches(options.family[0]):
        raise InputError(f"--branch: {options.family[0]} has no northern and southern orbits; leave it out")
    label = label_of(system, None if options.mass is None else options.mass[0], options.parameter)
    report.stage(f"tracing {label} {options.family[0]}")
    # Only now: JAX takes a moment to load.
    from orbitproof.explore.families import Limits
    from orbitproof.explore.three_body.families import trace_reaching

    place = None if equation is None or equation.coordinate is None else (equation.coordinate, float(equation.value))
    named = (system, options.family[0], parameters)
    family, branch = trace_reaching(*named, Limits(), options.branch, place, progress=report.update)
    return f"{label}-{name_on(options.family[0], branch)}", family


def _full_name(record: FamilyRecord) -> str:
    """The name of a family with that of its mass parameter, or else of its system."""
    return f"{record.label or record.system.name}-{record.name}"


def _record(options: argparse.Namespace, records: Sequence[FamilyRecord]) -> FamilyRecord:
    """The family of a file that is meant, by its name with or without that of the mass parameter."""
    wanted = None if options.family is None else options.family[0]
    named = [each for each in records if wanted in (None, each.name, _full_name(each))]
    if len(named) != 1:
        names = ", ".join(_full_name(each) for each in records)
        raise InputError(f"--family: {options.from_family} holds {names}; give the name of one")
    return named[0]


def _extrema(options: argparse.Namespace) -> int:
    """Three orbits beside each extremum of a stability parameter that a family file lists."""
    if options.from_family is None or options.output is None:
        raise InputError("--extrema: needs a family file and a file to write; give --from-family and --output")
    for option in ("stable", "tori"):
        if getattr(options, option):
            raise InputError(f"--{option}: --extrema says which orbits; leave it out")
    for option in ("period", "level", "at", "system", "start", "from_catalogue"):
        if getattr(options, option) is not None:
            raise InputError(f"--{option.replace('_', '-')}: --extrema says which orbits; leave it out")

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.records import read_families
    from orbitproof.explore.refinement import SIDES, refine_turns
    from orbitproof.explore.search import tasks_of_extrema

    record = _record(options, read_families(options.from_family))
    kept = {each.id: each for each in (read_candidates(options.output) if options.output.is_file() else [])}
    complete = True
    with Reporter(options.quiet) as report:
        tasks = tasks_of_extrema(record, options.id or _full_name(record), options.digits)
        if not tasks:
            report.error(
                f"{options.from_family}: lists no extrema of the stability parameters of {_full_name(record)}; "
                "explore family -k K finds them, for K from 2 on"
            )
        waiting = [task for task in tasks if not all(_is_there(task, kept, word) for word in SIDES)]
        report.stage(f"refining {len(waiting)} of {len(tasks)} extrema")
        try:
            for result in refine_turns(waiting, options.jobs, report.update):
                if result.failure is not None:
                    report.error(f"{result.task.id}: not refined: {result.failure}")
                    complete = False
                if result.candidates:
                    kept |= {each.id: each for each in result.candidates}
                    write_candidates(options.output, list(kept.values()))
        except KeyboardInterrupt:
            report.error(f"interrupted{_GOES_ON if kept else ''}")
            return 130
        if kept:
            report.message(f"{options.output}: {counted(len(kept), 'orbit')}")
    return 0 if complete and tasks else 1


def _is_there(task: OrbitTask, kept: Mapping[str, Candidate], word: str) -> bool:
    """Whether an earlier run has written this one of the orbits beside an extremum."""
    held = kept.get(f"{task.id}-{word}")
    return held is not None and _is_refined(task, held)


def _catalogue(options: argparse.Namespace) -> int:
    """Orbits near rows of a catalogue: refined, or compared with their certificates."""
    from orbitproof.explore.three_body.catalogues import compare_certificates, read_catalogue

    for option in ("system", "mass", "family", "branch", "start", "from_family", "half_period"):
        if getattr(options, option) is not None:
            raise InputError(f"--{option.replace('_', '-')}: --from-catalogue says which orbits; leave it out")
    catalogue = read_catalogue(options.from_catalogue)
    if options.certificates is not None:
        lines, complete = compare_certificates(catalogue, options.certificates)
        tell("\n".join(lines), [{"about": lines}])
        return 0 if complete else 1
    if options.output is None:
        raise InputError("--output: missing; give the candidates file to write")
    if options.every is not None and options.catalogue_orbit is not None:
        raise InputError("--every: --catalogue-orbit says which rows; leave out one of the two")
    rows: Sequence[int] = options.catalogue_orbit or range(1, len(catalogue) + 1, options.every or 1)
    if max(rows) > len(catalogue):
        raise InputError(
            f"--catalogue-orbit {max(rows)}: there are {counted(len(catalogue), 'row')}; give a smaller number"
        )

    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.search import tasks_of_catalogue
    from orbitproof.shared.systems import CR3BP

    equation = equation_of(options, CR3BP, wanted=False)
    with Reporter(options.quiet) as report:
        tasks, failures = tasks_of_catalogue(catalogue, rows, equation, options.digits, options.accept)
        for line in failures:
            report.error(line)
        done = _refined(options, tasks, report) if tasks else 0
        return max(done, 1 if failures else 0)


def _refined(options: argparse.Namespace, tasks: Sequence[OrbitTask], report: Reporter) -> int:
    """Refine what the output file does not hold yet; every orbit is written as soon as it is refined."""
    from orbitproof.explore.refinement import refine_orbits

    if options.output is None:
        raise InputError("--output: missing; give the candidates file to write")
    tasks = [replace(task, kind=kind_of(options, task.system)) for task in tasks]
    kept = {each.id: each for each in (read_candidates(options.output) if options.output.is_file() else [])}
    done = {task.id: kept[task.id] for task in tasks if task.id in kept and _is_refined(task, kept[task.id])}
    waiting = [task for task in tasks if task.id not in done]
    if done:
        report.message(f"{len(done)} of {len(tasks)} orbits are in {options.output} already")
    report.stage(f"refining {len(waiting)} orbits" if len(waiting) != 1 else f"refining {waiting[0].id}")
    complete = True
    others = [each for name, each in kept.items() if name not in {task.id for task in tasks}]
    try:
        for _, result in refine_orbits(waiting, options.jobs, report.update):
            if result.candidate is None:
                report.error(f"{result.task.id}: not refined: {result.failure}")
                complete = False
                continue
            done[result.task.id] = result.candidate
            write_candidates(options.output, [*others, *(done[task.id] for task in tasks if task.id in done)])
    except KeyboardInterrupt:
        report.error(f"interrupted: {len(done)} of {len(tasks)} orbits refined{_GOES_ON if done else ''}")
        return 130
    report.message(f"{len(done)} of {len(tasks)} orbits are in {options.output}")
    for name in done:
        if len(done) <= _MOST_SHOWN:
            tell_refined(name, options.output)
        else:
            tell("", [{"id": name}])
    return 0 if complete else 1


_MOST_SHOWN = 3
"""So many refined orbits are printed."""


def _is_refined(task: OrbitTask, candidate: Candidate) -> bool:
    """Whether a candidate of an earlier run is what the task asks for."""
    return (
        candidate.system == task.system
        and dict(candidate.parameters) == dict(task.parameters)
        and (task.equation is None or candidate.equation == task.equation)
        and candidate.crossings == task.crossings
        and candidate.kind == task.kind
        and candidate.provenance.get("digits") == task.digits
        and all(abs(float(c) - g) < 1e-2 for c, g in zip(candidate.centre, task.guess, strict=True))
    )


def _shown(equation: Equation) -> str:
    if equation.quantity == HALF_PERIOD:
        return f"the period {float(2 * equation.value):.15g}"
    name = equation.coordinate or "level"
    return f"{name} = {float(Fraction(equation.value)):.15g}"
