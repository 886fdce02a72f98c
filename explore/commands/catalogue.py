"""``orbitproof explore catalogue``: dense catalogues of families, as JSON, CSV and Parquet, and rows of them."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands import common
from orbitproof.explore.names import label_of, system_named
from orbitproof.explore.three_body.names import (
    DEFAULT_BRANCH,
    FAMILY_NAMES,
    WITHOUT_SYMMETRY,
    families_to_give,
    family_name,
    given_parameters,
    has_branches,
    mass_name,
    system_with,
)
from orbitproof.shared.formats import InputError, check_writable, table_form
from orbitproof.shared.help_text import add_command
from orbitproof.shared.systems import CR3BP, THREE_BODY
from orbitproof.shared.wording import counted

if TYPE_CHECKING:
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.three_body.catalogues import Catalogue, MadeCatalogue

_EXAMPLES = """\
examples:
  orbitproof explore catalogue --family L2-halo --mass jpl-earth-moon --rows 10000 -o halo.json
      a dense catalogue in the form of the JPL catalogue, with distances and altitudes
  orbitproof explore catalogue --family L2-halo --mass jpl-earth-moon --rows 50000 --device gpu -o halo.csv
      corrected many at a time by a GPU; exit code 2 where JAX finds none
  orbitproof explore catalogue --family dro dpo 3:1 --mass jpl-earth-moon --rows 500 --jobs 2 -o moon.csv
      one file for each family: moon-jpl-earth-moon-dro.csv, ..
  orbitproof explore catalogue --family dro dpo --mass sun-earth sun-mars --scheduler 192.0.2.1:8786 -o all.csv
      the same by the workers of a cluster
  orbitproof explore catalogue halo.json --period 6d 8d --perilune 2000km 10000km --stability 1 2 -o part.csv
      the rows of a file that lie between limits, in another form
  orbitproof explore catalogue --family L4-short --mass jpl-earth-moon --rows 100 -o l4.parquet
      of orbits without symmetry too (Parquet: pip install 'orbitproof[parquet]')
  orbitproof verify catalogue halo.json --curve curve.json -o rows.json --table certified.csv
      what a proved curve proves of each row, in the column "proved"; with --rows 10000 in place of it: its rows

Everything here is computed in double precision; the column "proved" says so. The distances are from the smaller
primary, over the whole orbit. The closing error is how far an orbit is from its first state after its period.
Exit codes: 0 all rows found, 1 some not, 2 bad input, 130 interrupted.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "catalogue", "a dense catalogue of a family, or rows of one, as JSON, CSV or Parquet", _EXAMPLES
    )
    parser.add_argument("file", type=Path, nargs="?", metavar="FILE", help="a catalogue (JSON or CSV) to choose from")
    parser.add_argument("--system", metavar="NAME", help="cr3bp or cr3bp-axial (default: that of the family)")
    parser.add_argument(
        "--mass", type=mass_name, nargs="+", metavar="MU", help="mass parameters: names or numbers, taken exactly"
    )
    parser.add_argument(
        "--family", nargs="+", type=family_name, metavar="NAME", help="as for explore family, and L4-short, .."
    )
    parser.add_argument("--from-family", type=Path, metavar="FILE", help="all families of a family file")
    common.add_branch(parser)
    parser.add_argument(
        "--rows",
        type=common.count,
        default=1000,
        metavar="N",
        help="rows at equal steps along a family (default: 1000)",
    )
    parser.add_argument("--step", type=common.positive, metavar="H", help="in place of --rows: the arclength of a step")
    parser.add_argument(
        "--max-orbits", type=common.count, default=1000, metavar="N", help="of the family (default: 1000)"
    )
    parser.add_argument("--min-distance", type=common.positive, metavar="R", help="to a primary, where the family ends")
    parser.add_argument("--distances", action="store_true", help="of a FILE: compute distances, altitudes and hits")
    words = "keep rows whose orbits hit the smaller primary; else they, and ends of a family that do, are left out"
    parser.add_argument("--all", action="store_true", help=words)
    common.add_accept(parser)
    rows = parser.add_argument_group(
        "rows between two limits, each a number, or with a unit: 6.5d, 12h, 3000km; or inf"
    )
    for name, meaning in (
        ("period", "of the orbit"),
        ("jacobi", "Jacobi constant"),
        ("stability", "stability index"),
        ("perilune", "least distance from the centre of the smaller primary"),
        ("altitude", "km above the surface of the smaller primary"),
    ):
        rows.add_argument(f"--{name}", nargs=2, metavar=("LOW", "HIGH"), help=meaning)
    common.add_output(parser, "catalogue (.json, .csv or .parquet)")
    common.add_jobs(parser, ": families at the same time")
    words = "use the cluster of this dask scheduler in place of --jobs (pip install 'orbitproof[cluster]')"
    parser.add_argument("--scheduler", metavar="ADDRESS", help=words)
    common.add_device(parser)
    common.add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Make, filter and write; returns the exit code. Raises `InputError`."""
    check_writable(options.output)
    table_form(options.output)
    given = [options.file, options.family, options.from_family]
    if sum(value is not None for value in given) != 1:
        raise InputError("FILE, --family, --from-family: give one of the three")
    if options.file is not None and options.scheduler is not None:
        raise InputError("--scheduler: a FILE is read here; leave it out")
    requests = None if options.family is None else _requests(options)
    if options.branch is not None and not any(has_branches(name) for name in options.family or ()):
        raise InputError("--branch: none of these families has northern and southern orbits; leave it out")

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.engines import Job, Lost, Reporter, run_all
    from orbitproof.explore.families import Limits
    from orbitproof.explore.flow import batches_on
    from orbitproof.explore.records import read_families
    from orbitproof.explore.three_body.catalogues import (
        CatalogueTask,
        catalogue_task,
        read_catalogue,
        symmetric_about_plane,
        with_distances,
        without_contradictions,
    )

    limits = {name: getattr(options, name) for name in ("period", "jacobi", "stability", "perilune", "altitude")}
    limits = {name: tuple(pair) for name, pair in limits.items() if pair is not None}
    with Reporter(options.quiet) as report:
        if options.file is not None:
            catalogue, complete = read_catalogue(options.file), True
            if options.distances:
                report.stage("distances")
                with batches_on(options.device):
                    if not options.accept:
                        catalogue, told = without_contradictions(catalogue)
                        for line in told:
                            report.error(f"{options.file}: {line}")
                        complete = not told
                    catalogue = with_distances(catalogue, 4, symmetric=symmetric_about_plane(catalogue))
            chosen = _kept(catalogue, limits, options.all, catalogue.title, report)
            return 0 if _write(chosen, options.output, catalogue.title, report, complete) else 1
        how = options.rows, options.device, options.step
        bounds = Limits(options.max_orbits, min_distance=options.min_distance)
        if requests is None:
            records = [record for record in read_families(options.from_family) if record.system in THREE_BODY]
            if not records:
                raise InputError(f"{options.from_family}: holds no family of the CR3BP; give one")
            tasks = [
                CatalogueTask(
                    each.system, each.name, each.label, each.parameters, bounds, *how, record=each, hits=options.all
                )
                for each in records
            ]
        else:
            branch = options.branch or DEFAULT_BRANCH
            tasks = [
                CatalogueTask(system, name, label, parameters, bounds, *how, branch, hits=options.all)
                for system, name, label, parameters in requests
            ]
        report.stage(tasks[0].title if len(tasks) == 1 else f"{len(tasks)} families")
        complete = True
        for index, made in run_all(
            Job(catalogue_task, attrgetter("title"), _never), tasks, options.jobs, report.update, options.scheduler
        ):
            task = tasks[index]
            if isinstance(made, Lost) or made.catalogue is None:
                report.error(f"{task.title}: {made.reason}")
                complete = False
                continue
            report.message(f"{task.title}: ends: {made.reason}")
            if made.hitting:
                report.message(f"{task.title}: {made.hitting}; --all covers them")
            if made.corrected:
                report.message(f"{task.title}: {made.corrected}")
            if made.left_out:
                report.error(f"{task.title}: {made.left_out}")
                complete = False
            path = options.output
            if len(tasks) > 1:
                path = path.with_name(f"{path.stem}-{task.title.replace(' ', '-')}{path.suffix}")
            chosen = _kept(made.catalogue, limits, options.all, task.title, report)
            complete &= _write(chosen, path, task.title, report)
    return 0 if complete else 1


def _never(made: MadeCatalogue) -> bool:
    return False


def _requests(options: argparse.Namespace) -> list[tuple[Any, str, str, Any]]:
    """System, name, label and parameters of each family of each mass."""
    found = []
    for mass in options.mass or [None]:
        if mass is None:
            raise InputError("--mass: missing; give the mass parameter, for example jpl-earth-moon")
        for name in options.family:
            named = CR3BP.name if name in WITHOUT_SYMMETRY else options.system or system_with([name])
            if named is None or system_named(named) not in THREE_BODY:
                known = families_to_give("cr3bp", name)
                raise InputError(
                    f"--family {name}: unknown; give one of {known}, {', '.join(FAMILY_NAMES['cr3bp-axial'])}"
                )
            system = system_named(named)
            found.append((system, name, label_of(system, mass, None), given_parameters(system, mass, None)))
    return found


def _kept(
    catalogue: Catalogue, limits: Mapping[str, tuple[str, str]], everything: bool, title: str, report: Reporter
) -> Catalogue:
    """The rows between the limits that a spacecraft could fly, or all; says how many are left out."""
    from orbitproof.explore.three_body.catalogues import chosen_rows, left_out, without_hits

    between = chosen_rows(catalogue, limits)
    if len(between) < len(catalogue):
        outside = f"{len(catalogue) - len(between)} of {counted(len(catalogue), 'row')}"
        report.message(f"{title}: {outside} left out by {' and '.join(f'--{name}' for name in limits)}")
    kept = between if everything else without_hits(between)
    if len(kept) < len(between):
        report.message(f"{title}: {left_out(kept, between)}; --all keeps them")
    return kept


def _write(catalogue: Catalogue, path: Path, title: str, report: Reporter, complete: bool = True) -> bool:
    """Whether there was a row to write, and the rows are complete."""
    from orbitproof.explore.three_body.catalogues import libration_places, table_of

    if not len(catalogue):
        report.error(f"{title}: no row is left; nothing is written")
        return False
    table_of(catalogue, libration_places(float(catalogue.mass_ratio))).write(path)
    side = {"N": "northern ", "S": "southern "}.get(catalogue.branch, "")
    many = counted(len(catalogue), f"{side}row")
    report.message(f"{title}: {many} written to {path}")
    return complete
