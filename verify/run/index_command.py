"""Command line for the index along a curve: ``orbitproof verify index --curve curve.json -o index.json``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.shared.formats import InputError, about, check_writable
from orbitproof.shared.interrupts import run_command
from orbitproof.verify.branches import certified_index, indexed_atlas
from orbitproof.verify.certificate import Certificate, Recheck, read_certificate, write_certificate
from orbitproof.verify.run import ArgumentParser, Workplace
from orbitproof.verify.run.proof_command import add_checking_options, by_curve, check_of, prove_or_check, told

_EXAMPLES = """\
examples:
  orbitproof verify index --curve curve.json -o index.json
      the Conley-Zehnder index of all orbits between the points of the curve's list at which it changes
  orbitproof verify index --recheck index.json --curve curve.json
      check that all it states follows from the certificate of the curve and the half turns that were counted
  orbitproof verify index --recheck --integrate index.json --curve curve.json --jobs 2
      and prove the curve again and count the half turns again, in another way

The curve has a list if it was proved with one: orbitproof verify atlas ATLAS -o curve.json --complete 2. Without one
the index of one of its orbits is found, and nothing is said of the others.
exit codes: 0 the index is proved, or the certificate stands; 1 not; 2 bad input; 130 interrupted
"""


def _parser() -> ArgumentParser:
    words = "The Conley-Zehnder index of the orbits of a curve of the three-body problem that is proved."
    parser = ArgumentParser("orbitproof verify index", words, _EXAMPLES)
    words = "with --recheck: the certificate of an index"
    parser.add_argument("file", type=Path, nargs="?", help=words)
    parser.add_argument("--curve", type=Path, required=True, metavar="FILE", help="certificate of the curve")
    parser.add_argument("-o", "--output", type=Path, help="certificate of the index")
    words = "prove the curve again, and count again, in another way"
    add_checking_options(parser, "check the certificate of an index again", words, "pieces of the curve")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    return prove_or_check("index", _parser().parse_args(arguments), _run, _recheck)


def _run(options: argparse.Namespace, workplace: Workplace) -> int:
    if options.file is not None:
        raise InputError("FILE: is taken with --recheck only; the curve is given with --curve")
    if options.output is not None:
        check_writable(options.output)
    with about(options.curve):
        certificate = certify_the_index(_indexed_curve(options), workplace)
    if options.output is not None:
        write_certificate(options.output, certificate.document)
    return told(certificate)


def _recheck(options: argparse.Namespace, workplace: Workplace) -> Recheck:
    if options.file is None:
        raise InputError("FILE: missing; give the certificate of an index")
    curve = _indexed_curve(options)
    certificate = read_certificate(options.file, "index-certificate")
    with about(options.file):
        return check_of(certificate, [curve], options.integrate, workplace)


def _indexed_curve(options: argparse.Namespace) -> Certificate:
    """The certificate of the curve, which is checked before an index is counted only if it can have one."""
    curve = read_certificate(options.curve, "atlas-certificate")
    indexed_atlas(curve, str(options.curve))
    return curve


def certify_the_index(curve: Certificate, workplace: Workplace) -> Certificate:
    """The certificate of the index along a curve, whose certificate is checked up to its conclusion first.

    Raises `InputError` if that does not stand, is of no such curve, or the work is not brought to an end.
    """
    indexed_atlas(curve)
    return Certificate(by_curve(curve, certified_index, (), workplace, {"index": 1.0}, "the index was not found"))


if __name__ == "__main__":
    sys.exit(run_command(main))
