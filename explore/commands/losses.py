"""``orbitproof explore losses``: candidates at the points of a list at which R may be lost or multipliers collide."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from orbitproof.explore.commands import common
from orbitproof.shared.formats import ACROSS_KINDS, REVERSOR_BREAKING, check_writable, write_candidates
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof verify atlas loop.json --complete 4 -o loop-certificate.json
  orbitproof explore losses loop-certificate.json -o losses.json
  orbitproof explore losses loop-certificate.json --kind krein_collision -o collisions.json
  orbitproof verify losses.json -o loss-certificates.json
  orbitproof verify atlas loop.json --complete 4 --bifurcations loss-certificates.json -o loop-certificate.json

Exit codes: 0 all refined, 1 one was not, or there is none, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands,
        "losses",
        "refine the points of a complete list at which R may be lost, or multipliers collide",
        _EXAMPLES,
    )
    parser.add_argument("list", type=Path, metavar="CERTIFICATE", help="certificate of a curve with a complete list")
    parser.add_argument(
        "--kind",
        choices=ACROSS_KINDS,
        default=REVERSOR_BREAKING,
        help="R is lost, or two pairs of multipliers meet on the unit circle (default: %(default)s)",
    )
    parser.add_argument(
        "--digits", type=common.digits, default=50, metavar="N", help="decimal digits (default: %(default)s)"
    )
    common.add_output(parser, "candidates file")
    common.add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Refine and write; returns the exit code. Raises `InputError`."""
    check_writable(options.output)
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.losses import read_losses
    from orbitproof.explore.refinement import refine_tasks

    tasks = read_losses(options.list, options.digits, options.kind)
    if not tasks:
        print(f"{options.list}: its list has no point of the kind {options.kind}; nothing is written", file=sys.stderr)
        return 1
    found = []
    with Reporter(options.quiet) as report:
        report.stage(f"refining points of the kind {options.kind}")
        for _, refined in refine_tasks(tasks, 1, report.update):
            if refined.candidate is None:
                report.error(f"{refined.task.id}: not refined: {refined.failure}")
            else:
                found.append(refined.candidate)
    if found:
        write_candidates(options.output, found)
    if not options.quiet:
        print(f"{len(found)} of {len(tasks)} points written to {options.output}", file=sys.stderr)
    return 0 if len(found) == len(tasks) else 1
