"""Command line for webs: ``orbitproof verify web web.json --certificates FILE.. -o web-certificate.json``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from orbitproof.shared.claims.life import Life
from orbitproof.shared.claims.web import Web
from orbitproof.shared.formats import InputError, about, check_writable
from orbitproof.shared.formats.web import read_web
from orbitproof.shared.interrupts import run_command
from orbitproof.verify.branches import RestingError, certified_web, claiming_indices, resting
from orbitproof.verify.certificate import Certificate, Key, Recheck, read_any, read_certificate, write_certificate
from orbitproof.verify.run import ArgumentParser, Failure, Workplace, apart
from orbitproof.verify.run.checking_again import Known, checks_of_parts
from orbitproof.verify.run.proof_command import add_checking_options, check_of, limits_of, prove_or_check, told

_EXAMPLES = """\
examples:
  orbitproof verify web web.json --certificates planar.json halo.json certificates.json -o web-certificate.json
      whether these proved curves meet in these certified orbits as the web claims, and hang together
  orbitproof verify web --recheck web-certificate.json --certificates planar.json halo.json certificates.json
      check that all it states follows from the certificates that it rests on
  orbitproof verify web --recheck --integrate web-certificate.json --certificates .. --jobs 2
      and prove all of these again, in another way

exit codes: 0 the graph is proved, or the certificate stands; 1 not; 2 bad input; 130 interrupted
"""


def _parser() -> ArgumentParser:
    words = "Join proved curves of periodic orbits into a graph: which meets which in which certified orbit."
    parser = ArgumentParser("orbitproof verify web", words, _EXAMPLES)
    parser.add_argument("file", type=Path, help="web (JSON, docs/formats.md); with --recheck, certificate of one")
    words = (
        "certificates of curves and of the index along them, and files of certificates of bifurcations and orbits, as "
        "far as the web names them"
    )
    parser.add_argument("--certificates", type=Path, nargs="+", required=True, metavar="FILE", help=words)
    words = "claim the index of each arc of which the certificates hold it, whatever the web says of it"
    parser.add_argument("--indices", action="store_true", help=words)
    parser.add_argument("-o", "--output", type=Path, help="certificate of the web")
    words = "prove all that it rests on again, in another way"
    add_checking_options(parser, "check the certificate of a web again", words, "checks")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    return prove_or_check("web", _parser().parse_args(arguments), _run, _recheck)


def _run(options: argparse.Namespace, workplace: Workplace) -> int:
    web, given = read_web(options.file), read_given(options)
    web = claiming_indices(web, [entry for _, entry in given]) if options.indices else web
    return prove_graph(web, certified_web, given, options, workplace)


def _recheck(options: argparse.Namespace, workplace: Workplace) -> Recheck:
    if options.indices:
        raise InputError("--indices: is about a web that is not proved yet; --recheck takes the claim as it was made")
    return check_graph("web-certificate", options, workplace)


Files = Sequence[tuple[Path, Certificate]]
Certified = Callable[[Any, Sequence[Certificate], Mapping[Key, Recheck]], dict[str, Any]]
"""The certificate of a graph, from its claim, the certificates that it rests on, and what checking these showed."""


def prove_graph(
    claim: Web | Life, certified: Certified, given: Files, options: argparse.Namespace, workplace: Workplace
) -> int:
    """Prove a graph of curves, write its certificate where the options say, and tell it; returns the exit code."""
    if options.output is not None:
        check_writable(options.output)
    with _about(options, given):
        certificate = certify_graph(claim, certified, [entry for _, entry in given], workplace)
    if options.output is not None:
        write_certificate(options.output, certificate.document)
    return told(certificate)


def check_graph(schema: str, options: argparse.Namespace, workplace: Workplace) -> Recheck:
    """What checking the certificate of a graph again shows."""
    certificate, given = read_certificate(options.file, schema), read_given(options)
    with _about(options, given):
        return check_of(certificate, [entry for _, entry in given], options.integrate, workplace)


def read_given(options: argparse.Namespace) -> Files:
    """The certificates in files of all kinds, each with its file."""
    return [(path, entry) for path in options.certificates for entry in read_any(path)]


@contextmanager
def _about(options: argparse.Namespace, given: Files) -> Iterator[None]:
    """While the body runs, what is wrong with a certificate names its file, and what is wrong with the graph that."""
    with about(options.file):
        try:
            yield
        except RestingError as error:
            # Of two of one name the later one is one too many.
            with about({entry.key: path for path, entry in given}[error.key]):
                raise


def certify_graph(
    claim: Web | Life, certified: Certified, given: Sequence[Certificate], workplace: Workplace
) -> Certificate:
    """The certificate of a graph by certificates that are checked up to their conclusions first.

    Raises `InputError` if one that it names is not given, or the work is not brought to an end.
    """
    certificates, known = resting(claim, given), Known()
    for _ in checks_of_parts(certificates, certificates, False, workplace, known):
        pass
    checks = {entry.key: known[entry] for entry in certificates}
    found = apart(certified, claim.id, (claim, certificates, checks), limits_of(workplace))
    if isinstance(found, Failure):
        error = InputError(f"the {claim.kind} was not put together: {found.message}")
        raise found.error if isinstance(found.error, InputError) else error
    return Certificate(found)


if __name__ == "__main__":
    sys.exit(run_command(main))
