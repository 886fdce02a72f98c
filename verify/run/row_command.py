"""Command line of the verifier: ``orbitproof verify candidates.json -o certificates.json``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from time import monotonic

from orbitproof.shared.answers import answered, tell
from orbitproof.shared.formats import InputError, read_claims, refused, select_ids
from orbitproof.shared.printed_tables import wrapped
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import LEVELS, Certificate, Limits, Recheck, read_certificate, read_certificates
from orbitproof.verify.certificate.kinds import kind_of
from orbitproof.verify.evidence import GREATEST_PRECISION, LEAST_PRECISION
from orbitproof.verify.run import CHECK_SECONDS, ArgumentParser, Workplace, interrupted, whole_number
from orbitproof.verify.run.row_tables import recheck_table, rechecks_as_json, verdict_text, verdicts_as_json
from orbitproof.verify.run.rows import RowRun

_DESCRIPTION = """\
Prove bifurcations of symmetric periodic orbits, and single orbits: rigorous verification of candidate boxes.

What a file holds decides what is done with it. Options of each kind:
  orbitproof verify --help             candidates and their certificates (this page)
  orbitproof verify atlas --help       whole branches: curves, surfaces, lists of resonances
  orbitproof verify web --help         graphs of proved curves that meet
  orbitproof verify life --help        equilibria, and the orbits that are born on them, as one graph
  orbitproof verify index --help       the Conley-Zehnder index along a proved curve
  orbitproof verify catalogue --help   rows of a catalogue, certified by a proved curve
  orbitproof verify --second-proof --help
                                       certificates proved once more, by other code
  orbitproof verify --formal --help    certified bifurcations as files that the kernel of Coq checks
"""

_EXAMPLES = """\
examples:
  orbitproof verify candidates.json
      prove what can be proved and print what that is
  orbitproof verify candidates.json -o certificates.json --jobs 2
      the same on two cores, certificates in a file; if interrupted, the same command goes on
  orbitproof verify candidates.json -o certificates.json --only "L1 k=4" --max-precision 2048
      one row again, with more bits
  orbitproof verify candidates.json -o certificates.json --curve curve.json
      and for each orbit say where it lies on a curve that is proved
  orbitproof verify candidates.json -o certificates.json --scheduler tcp://192.0.2.1:8786
      hand the candidates to a cluster (dask.distributed)
  orbitproof verify --recheck certificates.json
      check that every certificate follows from the enclosures that it carries, without integrating
  orbitproof verify --recheck --integrate certificates.json --jobs 2
      and integrate again, at another precision and order

exit codes: 0 everything proved, 1 something not proved, 2 bad input, 130 interrupted
with --recheck: 0 every certificate stands as it is, 1 one does not, 2 bad input, 130 interrupted
"not proved" never means "shown to be false"
"""


def _parser() -> ArgumentParser:
    parser = ArgumentParser("orbitproof verify", _DESCRIPTION, _EXAMPLES)
    parser.add_argument("file", type=Path, help="candidates file (JSON); with --recheck, certificates file")
    parser.add_argument("-o", "--output", type=Path, help="certificates file; rows are saved as they finish")
    parser.add_argument("--only", nargs="+", metavar="ID", help="these only (with * and ? as in file names)")
    bits, words = whole_number(LEAST_PRECISION, GREATEST_PRECISION), "never use more bits (default: %(default)s)"
    parser.number("--max-precision", "BITS", words, bits, Limits.max_precision)
    words = "certain digits to aim for (default: %(default)s); boxes that explore made for fewer take less time"
    parser.number("--digits", "N", words, whole_number(1), Limits.digits)
    words = (
        "coordinates of rows with a first integral: its level in place of one of Fix(R), which then follows from it "
        "(integral); those of Fix(R) as they are (coordinates); or what suits the row (default: auto)"
    )
    parser.add_argument("--level", choices=LEVELS, default=Limits.level, help=words)
    words = (
        "where a candidate is not proved, try so many boxes that its failures ask for; a certificate is about the box "
        "that it holds, and says if that is another than was given (default: %(default)s)"
    )
    parser.number("--other-boxes", "N", words, whole_number(0, 100), Limits.other_boxes)
    words = "certificate of a curve, from verify atlas: where on it the orbits of the candidates lie"
    parser.add_argument("--curve", type=Path, metavar="FILE", help=words)
    parser.run_options("candidates", "--row-timeout", "a candidate", CHECK_SECONDS)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    options = _parser().parse_args(arguments)
    return answered("orbitproof verify", options.json, lambda: _done(options))


def _done(options: argparse.Namespace) -> int:
    workplace = Workplace(options.jobs, options.scheduler, options.row_timeout, options.memory, options.quiet)
    try:
        return _recheck(options, workplace) if options.recheck else _run(options, workplace)
    except InputError as error:
        return refused(error)


def _run(options: argparse.Namespace, workplace: Workplace) -> int:
    if options.integrate:
        raise InputError("--integrate: there is nothing to integrate again; give it together with --recheck")
    curve = _curve(options)
    everything = read_claims(options.file)
    known = {candidate.id: candidate for candidate in everything}
    selected = [known[name] for name in select_ids(known, options.only, "candidate")]
    limits = Limits(options.max_precision, options.digits, options.row_timeout, options.level, options.other_boxes)
    # With --only, --fresh means the selected rows; those of the others stay in the file.
    run = RowRun(everything, selected, limits, options.output, options.fresh, options.fresh and options.only is None)
    start = monotonic()
    ended = False
    unsaved: InputError | None = None
    try:
        run.prove(workplace)
    except KeyboardInterrupt:
        ended = True
    except InputError as error:
        if not run.fresh:
            raise
        unsaved = error
    tell(verdict_text(selected, run.done, run.kept), verdicts_as_json(selected, run.done))
    if curve is not None:
        from orbitproof.verify.run.branch_checks import places_on_apart

        orbits = [run.done[c.id] for c in selected if kind_of(c).found_as == "orbit" and c.id in run.done]
        # The time of a candidate is no limit for checking the curve.
        for placed in places_on_apart(curve, orbits, Workplace(memory=options.memory).branch_checks):
            place = placed.certificate.to_json().get("place")
            tell(wrapped([placed.line]), [{"id": placed.certificate.id, "place": place, "line": placed.line}])
            run.certificates[placed.certificate.id] = placed.certificate
        run.save()
    if unsaved is not None:
        raise unsaved
    if ended:
        saved = options.output if run.certificates else None
        return interrupted(len(run.done), len(selected), "candidates finished", saved)
    proved = sum(run.done[candidate.id].proved for candidate in selected)
    where = "" if options.output is None else f"; certificates: {options.output}"
    tell(f"\n{proved} of {len(selected)} proved in {monotonic() - start:.0f} s{where}")
    return 0 if proved == len(selected) else 1


def _recheck(options: argparse.Namespace, workplace: Workplace) -> int:
    from orbitproof.verify.run.checking_again import checked_again

    for name in ("output", "fresh"):
        if getattr(options, name):
            raise InputError(f"--{name}: --recheck writes no file; leave it out")
    if options.scheduler is not None:
        raise InputError("--scheduler: certificates are checked again on this machine; give --jobs instead")
    stored = read_certificates(options.file)
    selected = [stored[name] for name in select_ids(stored, options.only, "certificate")]
    curve = _curve(options)
    done: dict[str, Recheck] = {}
    ended = False
    try:
        below = [] if curve is None else [curve]
        with closing(checked_again(selected, below, options.integrate, workplace)) as found:
            for entry, result in found:
                done[entry.id] = result
    except KeyboardInterrupt:
        ended = True
    names = [entry.id for entry in selected]
    tell(recheck_table(names, done), rechecks_as_json(names, done))
    if ended:
        return interrupted(len(done), len(selected), "certificates checked")
    failed = [result for result in done.values() if not result.stands]
    for result in failed:
        for finding in result.findings[:1]:
            print(f"FAILED {shown(result.id)}: {finding.place}: {finding.message}", file=sys.stderr)
    return 1 if failed else 0


def _curve(options: argparse.Namespace) -> Certificate | None:
    """The certificate of the curve on which orbits are said to lie, if one is given. Raises `InputError`."""
    return None if options.curve is None else read_certificate(options.curve, "atlas-certificate")
