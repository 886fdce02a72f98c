"""``orbitproof explore orbit``: from an approximate symmetric orbit to a corrected one."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands import common
from orbitproof.explore.names import system_named
from orbitproof.shared.formats import InputError, check_writable

if TYPE_CHECKING:
    from orbitproof.explore.families import TracedFamily

_EXAMPLES = """\
examples:
  orbitproof explore orbit --system mine.py --start c=0.1 y=0.2
  orbitproof explore orbit --system cr3bp --mass earth-moon --start x=0.8234 z=0 vy=0.126 -o orbit.json
  orbitproof explore family --from-family orbit.json --parameter-max x 0.83 -o family.json

The family of the orbit is traced, both ways, from the file that -o writes, or by explore family with the same options.
Exit codes: 0 corrected, 1 not, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = common.add_command(commands, "orbit", "correct an approximate symmetric orbit of any system", _EXAMPLES)
    common.add_start(parser)
    parser.add_argument("--mass", nargs=1, metavar="MU", help="mass parameter of the CR3BP: a name or a number")
    parser.add_argument("--family", nargs=1, metavar="NAME", help="what to call its family (default: family)")
    common.add_output(parser, "family file of this orbit", required=False)
    parser.set_defaults(run=run, mirror=False, vy_max=None)


def run(options: argparse.Namespace) -> int:
    """Correct, print and write; returns the exit code. Raises `InputError`."""
    for option in ("system", "start"):
        if getattr(options, option) is None:
            raise InputError(f"--{option}: missing; give one")
    if options.output is not None:
        check_writable(options.output)
    system = system_named(options.system)

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.families import CONTROL, FamilyFailure, TracedFamily, family_record, first_family
    from orbitproof.explore.records import write_families
    from orbitproof.explore.search import started

    found: list[TracedFamily] = []
    requests = started(options, system)
    with Reporter(quiet=False) as report:
        for request in requests:
            assert request.first is not None
            try:
                family = first_family(system, request.parameters, request.first, CONTROL)
            except FamilyFailure as error:
                report.error(f"{request.name}: {error}")
                continue
            found.append(TracedFamily(request.name, request.label, family))
        if options.output is not None and found:
            write_families(options.output, [family_record(item) for item in found])
            report.message(f"written to {options.output}")
    for item in found:
        print("\n".join(_lines(item)))
    return 0 if len(found) == len(requests) else 1


def _lines(item: TracedFamily) -> list[str]:
    problem, (orbit,) = item.family.problem, item.family.orbits
    system = problem.system
    rows = [("orbit", item.title)]
    for title, side in (("point", "first"), ("other point", "second")):
        place = zip(system.centre_coordinates, orbit.centre("first" if side == "first" else "second"), strict=True)
        rows.append((title, ", ".join(f"{name} = {value:.15g}" for name, value in place)))
    rows += [("half period", f"{orbit.half_period:.15g}"), ("crossings", f"{orbit.crossings} in the half period")]
    if orbit.first_integral is not None:
        rows.append((system.first_integral_name or "first integral", f"{orbit.first_integral:.15g}"))
    rows.append(
        (
            "stability",
            ", ".join(f"{value.real:.10g}" if value.imag == 0 else f"{value:.10g}" for value in orbit.stability),
        )
    )
    if problem.symmetry is not None:
        rows.append(("symmetry", problem.symmetry))
    width = max(len(title) for title, _ in rows)
    return [f"{title:{width}}  {text}" for title, text in rows]
