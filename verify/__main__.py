"""Command line of the verifier: ``orbitproof verify candidates.json -o certificates.json``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.shared.formats import ORBIT, Candidate, InputError, check_writable, read_candidates, select_ids
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import (
    GREATEST_PRECISION,
    LEAST_PRECISION,
    LEVELS,
    Certificate,
    Limits,
    Recheck,
    certify_all,
    expected_work,
    is_proof_of,
    read_certificates,
    recheck_all,
    recheck_table,
    verdict_table,
    write_certificates,
)
from orbitproof.verify.engines import (
    CHECK_SECONDS,
    LONG_CHECK_SECONDS,
    ArgumentParser,
    CheckLimits,
    Display,
    engine_of,
    whole,
)

_DESCRIPTION = """\
Prove bifurcations of symmetric periodic orbits, and single orbits: rigorous verification of candidate boxes.

commands:
  orbitproof verify FILE ..         certificates of bifurcations, from candidates (this page)
  orbitproof verify atlas FILE ..   certificates of whole branches, from atlases (orbitproof verify atlas --help)
  orbitproof verify --second-proof FILE ..
                                    certified bifurcations proved once more, by code that shares nothing with the first
"""

_EXAMPLES = """\
examples:
  orbitproof verify candidates.json
      prove what can be proved and print the table
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
    bits, words = whole(LEAST_PRECISION, GREATEST_PRECISION), "never use more bits (default: %(default)s)"
    parser.number("--max-precision", "BITS", words, bits, Limits.max_precision)
    words = "certain digits of the parameter to aim for (default: %(default)s)"
    parser.number("--digits", "N", words, whole(1), Limits.digits)
    words = (
        "parameter of Hamiltonian rows: the level of the first integral, a coordinate of Fix(R) following from it "
        "(integral), the coordinates of Fix(R) as they are (coordinates), or what suits the row (default: auto)"
    )
    parser.add_argument("--level", choices=LEVELS, default=Limits.level, help=words)
    words = "certificate of a curve, from verify atlas: where on it the orbits of the candidates lie"
    parser.add_argument("--curve", type=Path, metavar="FILE", help=words)
    parser.run_options("candidates", "--row-timeout", "a candidate", CHECK_SECONDS)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words[:1] == ["atlas"]:
        from orbitproof.verify.atlas.__main__ import main as verify_atlas

        return verify_atlas(words[1:])
    if "--second-proof" in words:
        from orbitproof.verify.second_proofs import main as prove_again

        return prove_again([word for word in words if word != "--second-proof"])
    options = _parser().parse_args(words)
    try:
        return _recheck(options) if options.recheck else _run(options)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _run(options: argparse.Namespace) -> int:
    if options.integrate:
        raise InputError("--integrate: there is nothing to integrate again; give it together with --recheck")
    curve = None
    if options.curve is not None:
        # Only now: curves take a moment to load.
        from orbitproof.verify.atlas import places_on_apart, read_atlas_certificate

        curve = read_atlas_certificate(options.curve)
    everything = read_candidates(options.file)
    known = {candidate.id: candidate for candidate in everything}
    selected = [known[name] for name in select_ids(known, options.only, "candidate")]
    earlier: dict[str, Certificate] = {}
    if options.output is not None:
        check_writable(options.output)
        # With --only, --fresh means the selected rows; those of the others stay in the file.
        if options.output.exists() and not (options.fresh and options.only is None):
            earlier = _earlier(options.output, everything)
    certificates = dict(earlier)
    reusable = [] if options.fresh else [c for c in selected if c.id in earlier]
    kept = frozenset(c.id for c in reusable if is_proof_of(earlier[c.id], c))
    pending = [candidate for candidate in selected if candidate.id not in kept]
    fresh: set[str] = set()
    limits = Limits(options.max_precision, options.digits, options.row_timeout, options.level)
    display = Display({candidate.id: expected_work(candidate, limits) for candidate in pending}, options.quiet)
    if kept:
        display.message(f"{len(kept)} of {len(selected)} proved already, kept (--fresh verifies again)")

    def save() -> None:
        if options.output is not None and certificates:
            write_certificates(options.output, [certificates[c.id] for c in everything if c.id in certificates])

    def finished(certificate: Certificate) -> None:
        certificates[certificate.id] = certificate
        fresh.add(certificate.id)
        save()
        display.finish(certificate.id, f"{certificate.verdict}, {certificate.computation.seconds:.1f} s")

    interrupted = False
    unsaved: InputError | None = None
    try:
        with engine_of(options.scheduler, options.jobs, options.row_timeout) as engine, display.shown():
            certify_all(pending, limits, options.jobs, display.advance, finished, engine)
    except KeyboardInterrupt:
        interrupted = True
    except InputError as error:
        if not fresh:
            raise
        unsaved = error
    done = {name: certificate for name, certificate in certificates.items() if name in fresh | kept}
    print(verdict_table(selected, done, kept), flush=True)
    if curve is not None:
        orbits = [done[c.id] for c in selected if c.kind == ORBIT and c.id in done]
        # The time of a candidate is no limit for checking the curve.
        for placed in places_on_apart(curve, orbits, CheckLimits(None, options.memory, LONG_CHECK_SECONDS)):
            print(placed.line, flush=True)
            certificates[placed.certificate.id] = placed.certificate
        save()
    if unsaved is not None:
        raise unsaved
    if interrupted:
        saved = "" if options.output is None else f", saved in {options.output}; the same command goes on from there"
        print(f"interrupted: {len(done)} of {len(selected)} candidates finished{saved}", file=sys.stderr)
        return INTERRUPTED
    return 0 if all(done[candidate.id].proved for candidate in selected) else 1


def _recheck(options: argparse.Namespace) -> int:
    for name in ("output", "fresh"):
        if getattr(options, name):
            raise InputError(f"--{name}: --recheck writes no file; leave it out")
    if options.scheduler is not None:
        raise InputError("--scheduler: certificates are checked again on this machine; give --jobs instead")
    stored = read_certificates(options.file)
    selected = [stored[name] for name in select_ids(stored, options.only, "certificate")]
    display = Display({entry.id: _work(entry, options.integrate) for entry in selected}, options.quiet)
    done: dict[str, Recheck] = {}

    def finished(result: Recheck) -> None:
        done[result.id] = result
        display.finish(result.id, "stands" if result.stands_without_place else "does not stand")

    interrupted = False
    try:
        with display.shown():
            recheck_all(selected, options.integrate, options.jobs, display.advance, finished, _check_limits(options))
    except KeyboardInterrupt:
        interrupted = True
    if not interrupted:
        done = _with_places(selected, done, options)
    print(recheck_table([entry.id for entry in selected], done), flush=True)
    if interrupted:
        print(f"interrupted: {len(done)} of {len(selected)} certificates checked", file=sys.stderr)
        return INTERRUPTED
    failed = [result for result in done.values() if not result.stands]
    for result in failed:
        for finding in result.findings[:1]:
            print(f"FAILED {shown(result.id)}: {finding.place}: {finding.message}", file=sys.stderr)
    return 1 if failed else 0


def _with_places(
    selected: Sequence[Certificate], done: dict[str, Recheck], options: argparse.Namespace
) -> dict[str, Recheck]:
    """The checks with those of the places on curves, where certificates carry some."""
    if options.curve is None and not any("place" in entry.to_json() for entry in selected):
        return done
    # Only now: curves take a moment to load.
    from orbitproof.verify.atlas import read_atlas_certificate, recheck_places_apart
    from orbitproof.verify.atlas.__main__ import examined

    limits = _check_limits(options)
    if options.curve is None:
        return recheck_places_apart(None, None, selected, done, limits)
    curve = read_atlas_certificate(options.curve)
    how = argparse.Namespace(**{**vars(options), "only": None}, bifurcations=[], timeout=options.row_timeout)
    checked = None if curve.atlas.is_surface else examined(curve.document, how)
    return recheck_places_apart(curve, checked, selected, done, limits)


def _check_limits(options: argparse.Namespace) -> CheckLimits:
    return CheckLimits(options.row_timeout, options.memory)


def _work(certificate: Certificate, integrate: bool) -> float:
    """A measure of the work that checking again takes: the time of the first integration."""
    return certificate.computation.seconds + 0.1 if integrate else 1.0


def _earlier(path: Path, candidates: Sequence[Candidate]) -> dict[str, Certificate]:
    """The certificates of an earlier run. Nothing that belongs to other candidates is overwritten."""
    try:
        result = read_certificates(path)
    except InputError as error:
        raise InputError(f"{error}; or replace the file with --fresh") from None
    known = {candidate.id for candidate in candidates}
    foreign = [name for name in result if name not in known]
    if foreign:
        raise InputError(
            f"{path}: holds certificates of other candidates ({foreign[0]!r}); "
            "choose another output, or replace the file with --fresh"
        )
    return result


if __name__ == "__main__":
    sys.exit(run_command(main))
