"""Command line for whole branches: ``orbitproof verify atlas atlas.json -o certificate.json``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.shared.answers import answered, tell
from orbitproof.shared.formats import InputError, read_atlas, refused, select_ids
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.shared.printed_tables import wrapped
from orbitproof.shared.systems import shown
from orbitproof.verify.branches import SCHEMA, kind_of
from orbitproof.verify.branches.interval_proof import prove_task
from orbitproof.verify.certificate import Certificate, read_certificate, read_certificates
from orbitproof.verify.run import LONG_CHECK_SECONDS, ArgumentParser, Work, Workplace, interrupted, whole_number
from orbitproof.verify.run.branch_checks import examined, holds_points
from orbitproof.verify.run.branch_tables import branch_as_json, conclusion_text, piece_table
from orbitproof.verify.run.branch_tasks import LARGEST_ORDER, MOST_SPLITS, RunLimits
from orbitproof.verify.run.branches import (
    AtlasRun,
    conclude_run,
    limits_of,
    prove_pieces,
    started,
)
from orbitproof.verify.run.row_tables import recheck_table, rechecks_as_json

_EXAMPLES = """\
examples:
  orbitproof verify atlas atlas.json
      prove every piece, and that neighbours are the same curve; print the theorem
  orbitproof verify atlas atlas.json -o curve.json --jobs 2
      the same on two cores, with a certificate; if interrupted, the same command goes on
  orbitproof verify atlas atlas.json -o curve.json --bifurcations certificates.json --only "earth-moon-L1-*"
      also which of the certified bifurcations lie on the curve
  orbitproof verify atlas atlas.json -o curve.json --complete 12
      also all resonances 1:1 to 1:12 on the curve, and where its orbits are linearly stable
  orbitproof verify atlas atlas.json -o curve.json --scheduler tcp://192.0.2.1:8786
      hand the pieces to a cluster (dask.distributed)
  orbitproof verify atlas --recheck curve.json
      check that all it states follows from what the certificate carries
  orbitproof verify atlas --recheck --integrate curve.json --jobs 2
      and prove every interval, and the bifurcations on the curve, again in another way

A piece that fails is tried with more precision, or where that promises more with second derivatives across the curve,
then split in two; what was proved is kept.
exit codes: 0 the theorem is proved, every bifurcation asked about lies on the curve, and the list leaves out
nothing; 1 not; 2 bad input; 130 interrupted. "not proved" never means "shown to be false"
"""


def _parser() -> ArgumentParser:
    words = "Prove a whole branch of periodic orbits, piece by piece, from its atlas."
    parser = ArgumentParser("orbitproof verify atlas", words, _EXAMPLES)
    parser.add_argument("file", type=Path, help="atlas (JSON); with --recheck, certificate of an atlas")
    parser.add_argument("-o", "--output", type=Path, help="certificate; results are saved as they come")
    words = "certificates files: say which of these bifurcations lie on the curve"
    parser.add_argument("--bifurcations", type=Path, nargs="+", default=[], metavar="FILE", help=words)
    parser.add_argument("--only", nargs="+", metavar="ID", help="of these bifurcations (with * and ? as in file names)")
    words = "also list all resonances 1:1 to 1:K on the curve, and where its orbits are linearly stable"
    parser.number("--complete", "K", words, whole_number(1, LARGEST_ORDER), None)
    words = "with --complete: combination resonances up to order 4 of linearly stable orbits too, for n = 2"
    parser.add_argument("--combinations", action="store_true", help=words)
    words = "also say which orbits are stable for ever, and list the exceptions (n = 1; with --complete 4 or more)"
    parser.add_argument("--lasting", action="store_true", help=words)
    words = "halve an interval at most N times (default: %(default)s)"
    parser.number("--max-splits", "N", words, whole_number(0, MOST_SPLITS), RunLimits.max_splits)
    for name, what in (
        ("precision", "bits"),
        ("order", "degree of the expansions in time"),
        ("width", "degree of the expansions along the curve"),
        ("top", "degree of the expansions across the curve"),
    ):
        parser.number(f"--{name}", "N", f"{what}, for the first attempt (default: as it suits)", whole_number(1), None)
    parser.run_options("pieces", "--timeout", "an interval of a piece", LONG_CHECK_SECONDS)
    return parser


def main(arguments: Sequence[str] | None = None, work: Work = prove_task) -> int:
    """Run the command line; returns the exit code. `work` is what a process does for each interval."""
    options = _parser().parse_args(arguments)
    return answered("orbitproof verify atlas", options.json, lambda: _done(options, work))


def _done(options: argparse.Namespace, work: Work) -> int:
    workplace = Workplace(options.jobs, options.scheduler, options.timeout, options.memory, options.quiet)
    try:
        return _recheck(options, workplace, work) if options.recheck else _run(options, workplace, work)
    except InputError as error:
        return refused(error)


def _run(options: argparse.Namespace, workplace: Workplace, work: Work) -> int:
    if options.integrate:
        raise InputError("--integrate: there is nothing to integrate again; give it together with --recheck")
    atlas = read_atlas(options.file)
    given = {name: getattr(options, name) for name in ("precision", "order", "width", "top")}
    combined: bool = options.combinations
    asked = (options.complete, options.max_splits, options.timeout, combined, options.lasting)
    limits = limits_of(atlas, *asked, **given)
    bifurcations = _chosen_bifurcations(options.bifurcations, options.only, kind_of(atlas).holds_points)
    run = started(atlas, limits, options.output, options.fresh)
    try:
        prove_pieces(run, workplace, work)
    except KeyboardInterrupt:
        tell(piece_table(run), [branch_as_json(run)])
        return _ended(run)
    except InputError:
        if run.results:
            tell(piece_table(run))
        raise
    tell(piece_table(run))
    try:
        certificate = conclude_run(run, bifurcations, workplace)
    except KeyboardInterrupt:
        tell("", [branch_as_json(run)])
        return _ended(run)
    conclusion = conclusion_text(certificate.document)
    tell(wrapped(["", *conclusion.splitlines()]), [branch_as_json(run, certificate.document)])
    if run.proved is not None and not certificate.proved:
        print(f"{run.proved}: still holds the proof of before; what was found now: {run.output}", file=sys.stderr)
    return 0 if certificate.proved and certificate.is_whole else 1


def _ended(run: AtlasRun) -> int:
    total = len(run.atlas.pieces)
    return interrupted(total - len(run.pending), total, "pieces finished", run.output if run.results else None)


def _recheck(options: argparse.Namespace, workplace: Workplace, work: Work) -> int:
    """Whether the certificate stands: its form, its conclusion, and with --integrate what it was made from."""
    for name in ("output", "fresh", "complete", "combinations", "lasting"):
        if getattr(options, name):
            raise InputError(f"--{name}: --recheck writes no file; leave it out")
    certificate = read_certificate(options.file, SCHEMA, changed=True)
    given = _chosen_bifurcations(options.bifurcations, options.only, holds_points(certificate))
    try:
        found = examined(certificate, given, options.integrate, workplace, work)
    except KeyboardInterrupt:
        print("interrupted: nothing is known yet", file=sys.stderr)
        return INTERRUPTED
    tell(recheck_table([found.id], {found.id: found}), rechecks_as_json([found.id], {found.id: found}))
    for finding in found.findings[:1]:
        print(f"FAILED {shown(found.id)}: {finding.place}: {finding.message}", file=sys.stderr)
    return 0 if found.stands else 1


def _chosen_bifurcations(files: Sequence[Path], only: Sequence[str] | None, holds_points: bool) -> list[Certificate]:
    """The certificates asked about, in the order of the files. Raises `InputError`."""
    if only is not None and not files:
        raise InputError("--only: chooses among bifurcations; give their certificates with --bifurcations")
    if files and not holds_points:
        raise InputError("--bifurcations: are looked for on curves of symmetric orbits only; leave them out")
    found: dict[str, Certificate] = {}
    for path in files:
        for name, certificate in read_certificates(path).items():
            if name in found:
                raise InputError(f"{path}: {name!r} is in another file too; give each certificate once")
            found[name] = certificate
    chosen = select_ids(found, None if only is None else list(only), "bifurcation", or_none=True)
    return [found[name] for name in chosen]


if __name__ == "__main__":
    sys.exit(run_command(main))
