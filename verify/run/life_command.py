"""Command line for lives: ``orbitproof verify life life.json --certificates FILE.. -o life-certificate.json``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.shared.formats.life import read_life_claim
from orbitproof.shared.interrupts import run_command
from orbitproof.verify.branches.life import SCHEMA, certified_life
from orbitproof.verify.certificate import Recheck
from orbitproof.verify.run import ArgumentParser, Workplace
from orbitproof.verify.run.proof_command import add_checking_options, prove_or_check
from orbitproof.verify.run.web_command import check_graph, prove_graph, read_given

_EXAMPLES = """\
examples:
  orbitproof verify life life.json --certificates equilibria.json births.json -o life-certificate.json
      whether these proved curves of orbits begin on these proved curves of equilibria, and all hang together
  orbitproof verify life --recheck life-certificate.json --certificates equilibria.json births.json
      check that all it states follows from the certificates that it rests on
  orbitproof verify life --recheck --integrate life-certificate.json --certificates .. --jobs 2
      and prove all of these again, in another way

exit codes: 0 the graph is proved, or the certificate stands; 1 not; 2 bad input; 130 interrupted
"""


def _parser() -> ArgumentParser:
    words = "Join proved curves of equilibria and of the periodic orbits that are born on them into a graph."
    parser = ArgumentParser("orbitproof verify life", words, _EXAMPLES)
    words = "claim of a life (JSON, docs/formats.md); with --recheck, certificate of one"
    parser.add_argument("file", type=Path, help=words)
    words = "certificates of its curves"
    parser.add_argument("--certificates", type=Path, nargs="+", required=True, metavar="FILE", help=words)
    parser.add_argument("-o", "--output", type=Path, help="certificate of the life")
    words = "prove all that it rests on again, in another way"
    add_checking_options(parser, "check the certificate of a life again", words, "checks")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    return prove_or_check("life", _parser().parse_args(arguments), _run, _recheck)


def _run(options: argparse.Namespace, workplace: Workplace) -> int:
    return prove_graph(read_life_claim(options.file), certified_life, read_given(options), options, workplace)


def _recheck(options: argparse.Namespace, workplace: Workplace) -> Recheck:
    return check_graph(SCHEMA, options, workplace)


if __name__ == "__main__":
    sys.exit(run_command(main))
