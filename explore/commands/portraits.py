"""``orbitproof explore portraits``: phase portraits of reversible planar maps at the 1:4 and 1:3 resonances."""

from __future__ import annotations

import argparse
from math import isfinite
from typing import Any

from orbitproof.explore.commands.common import add_output, add_quiet
from orbitproof.shared.formats import InputError, check_writable
from orbitproof.shared.help_text import add_command
from orbitproof.shared.wording import counted

_EXAMPLES = """\
examples:
  orbitproof explore portraits -o portraits.json
  orbitproof explore portraits --parameter 0.02 --orbits 16 --iterates 600 -o portraits.json

The map is f(x, y) = (y, -x + 2 (c y + a y^2 + b y^3)) with R(x, y) = (y, x): a = 0, b = 1 near c = 0 (1:4) and
a = 1, b = 0 near c = -1/2 (1:3). Each resonance is shown before, at and after it. Takes a few seconds.
"""

_WINDOW = {4: 2.1, 3: 5.3}
"""Half-width of the square, in units of the distance of the new orbits from 0: sqrt(nu) for 1:4, nu for 1:3."""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "portraits", "phase portraits of a reversible planar map at the resonances 1:4 and 1:3", _EXAMPLES
    )
    add_output(parser, "portrait file")
    parser.add_argument(
        "--parameter",
        type=float,
        default=0.03,
        metavar="NU",
        help="distance from the resonance, before and after it, in (0, 0.1] (default: %(default)s)",
    )
    parser.add_argument(
        "--orbits",
        type=int,
        default=12,
        metavar="N",
        help="orbits on each of three rays, 2 to 100 (default: %(default)s)",
    )
    parser.add_argument(
        "--iterates",
        type=int,
        default=300,
        metavar="N",
        help="points of each orbit, 10 to 10000 (default: %(default)s)",
    )
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Compute and write the portraits; returns 0. Raises `InputError`."""
    nu = options.parameter
    if not isfinite(nu) or not 0 < nu <= 0.1:
        raise InputError(f"--parameter {nu}: outside (0, 0.1]; farther away the map says little about the resonance")
    for name, value, low, high in (("orbits", options.orbits, 2, 100), ("iterates", options.iterates, 10, 10_000)):
        if not low <= value <= high:
            raise InputError(f"--{name} {value}: give a whole number from {low} to {high}")
    check_writable(options.output)
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.portraits import QUADRUPLING, TOUCH_AND_GO, portrait, write_portraits

    portraits = []
    with Reporter(options.quiet) as report:
        report.stage("portraits")
        cases = [(resonance, value) for resonance in (QUADRUPLING, TOUCH_AND_GO) for value in (-nu, 0.0, nu)]
        for index, (resonance, value) in enumerate(cases):
            report.update(f"1:{resonance.k}, nu = {value:g}", index / len(cases))
            window = _WINDOW[resonance.k] * (nu**0.5 if resonance.k == 4 else nu)
            portraits.append(portrait(resonance, value, window, options.orbits, options.iterates))
        write_portraits(options.output, portraits)
        report.message(f"{counted(len(portraits), 'portrait')} written to {options.output}")
    return 0
