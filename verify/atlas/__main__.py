"""Command line for whole branches: ``orbitproof verify atlas atlas.json -o certificate.json``."""

from __future__ import annotations

import argparse
import sys
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from orbitproof.shared.formats import SURFACE, Atlas, InputError, check_writable, read_atlas, read_document, select_ids
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.shared.systems import shown
from orbitproof.verify.atlas.apart import conclusion_apart
from orbitproof.verify.atlas.certificate import (
    SCHEMA,
    Result,
    make_atlas_certificate,
    read_atlas_certificate,
    reusable,
    write_atlas_certificate,
)
from orbitproof.verify.atlas.conclusion import Placing, conclusion_of
from orbitproof.verify.atlas.recheck import Means, recheck_atlas
from orbitproof.verify.atlas.report import conclusion_text, piece_table
from orbitproof.verify.atlas.run import AtlasRun
from orbitproof.verify.atlas.splitting import Settings
from orbitproof.verify.atlas.task import RunLimits, attempts_of, prove_task
from orbitproof.verify.certificate import Certificate, Recheck, read_certificates, recheck_all, recheck_table
from orbitproof.verify.engines import (
    LONG_CHECK_SECONDS,
    Answer,
    ArgumentParser,
    CheckLimits,
    Display,
    Task,
    Work,
    engine_of,
    whole,
)

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

A piece that fails is tried with more precision, then split in two; what was proved is kept.
exit codes: 0 the theorem is proved, every bifurcation asked about lies on the curve, and the list leaves out
nothing; 1 not; 2 bad input; 130 interrupted. "not proved" never means "shown to be false"
"""


_MOST_SPLITS, _LARGEST_ORDER = 20, 99


def _parser() -> ArgumentParser:
    words = "Prove a whole branch of symmetric periodic orbits, piece by piece, from its atlas."
    parser = ArgumentParser("orbitproof verify atlas", words, _EXAMPLES)
    parser.add_argument("file", type=Path, help="atlas (JSON); with --recheck, certificate of an atlas")
    parser.add_argument("-o", "--output", type=Path, help="certificate; results are saved as they come")
    words = "certificates files: say which of these bifurcations lie on the curve"
    parser.add_argument("--bifurcations", type=Path, nargs="+", default=[], metavar="FILE", help=words)
    parser.add_argument("--only", nargs="+", metavar="ID", help="of these bifurcations (with * and ? as in file names)")
    words = "also list all resonances 1:1 to 1:K on the curve, and where its orbits are linearly stable"
    parser.number("--complete", "K", words, whole(1, _LARGEST_ORDER), None)
    words = "halve an interval at most N times (default: %(default)s)"
    parser.number("--max-splits", "N", words, whole(0, _MOST_SPLITS), RunLimits.max_splits)
    for name, what in (
        ("precision", "bits"),
        ("order", "degree of the expansions in time"),
        ("width", "degree of the expansions along the curve"),
    ):
        parser.number(f"--{name}", "N", f"{what}, for the first attempt (default: as it suits)", whole(1), None)
    parser.run_options("pieces", "--timeout", "an interval of a piece", LONG_CHECK_SECONDS)
    return parser


def main(arguments: Sequence[str] | None = None, work: Work = prove_task) -> int:
    """Run the command line; returns the exit code. `work` is what a process does for each interval."""
    options = _parser().parse_args(arguments)
    try:
        return _recheck(options, work) if options.recheck else _run(options, work)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _run(options: argparse.Namespace, work: Work) -> int:
    if options.integrate:
        raise InputError("--integrate: there is nothing to integrate again; give it together with --recheck")
    atlas = read_atlas(options.file)
    if options.complete is not None and atlas.is_surface:
        raise InputError("--complete: lists what is on a curve, and this atlas is about a surface; leave it out")
    if options.complete is not None and atlas.system.fixed_level is not None:
        raise InputError("--complete: no list is claimed on a fixed level of a first integral; leave it out")
    limits = _limits(options, atlas)
    bifurcations = _bifurcations(options, atlas.is_surface)
    earlier = _earlier(options, atlas, attempts_of(atlas, limits))
    run = AtlasRun(atlas, limits, earlier)
    kept = frozenset(piece.id for piece in atlas.pieces) - frozenset(run.pending)
    display = Display(dict.fromkeys(run.pending, 1.0), options.quiet)
    if kept:
        display.message(f"{len(kept)} of {len(atlas.pieces)} pieces settled already, kept (--fresh proves again)")

    def saved(results: Sequence[Result]) -> None:
        if options.output is not None:
            write_atlas_certificate(options.output, make_atlas_certificate(atlas, results, None))

    interrupted = False
    unsaved: InputError | None = None
    try:
        with engine_of(options.scheduler, options.jobs, options.timeout) as engine, display.shown():
            run.run(engine, display, saved, work)
    except KeyboardInterrupt:
        interrupted = True
    except InputError as error:
        if not run.results:
            raise
        unsaved = error
    print(piece_table(run, kept), flush=True)
    if unsaved is not None:
        raise unsaved
    if interrupted:
        return _interrupted(options, run)
    try:
        conclusion = _conclude(atlas, run.results, bifurcations, options, options.complete)
    except KeyboardInterrupt:
        return _interrupted(options, run)
    certificate = make_atlas_certificate(atlas, run.results, conclusion, bifurcations)
    print(f"\n{conclusion_text(certificate)}", flush=True)
    if options.output is not None:
        write_atlas_certificate(options.output, certificate)
    return (
        0 if certificate["verdict"] == "proved" and not _off_curve(conclusion) and not _not_covered(conclusion) else 1
    )


def _interrupted(options: argparse.Namespace, run: AtlasRun) -> int:
    done = len(run.atlas.pieces) - len(run.pending)
    saved = "" if options.output is None else f", saved in {options.output}; the same command goes on from there"
    print(f"interrupted: {done} of {len(run.atlas.pieces)} pieces finished{saved}", file=sys.stderr)
    return INTERRUPTED


def _off_curve(conclusion: Mapping[str, Any]) -> list[str]:
    """Ids of the bifurcations that are not shown to lie on the curve."""
    return [entry["id"] for entry in conclusion.get("bifurcations", []) if not entry["on_curve"]]


def _not_covered(conclusion: Mapping[str, Any]) -> bool:
    """Whether a list that was asked for leaves something out."""
    listed = conclusion.get("complete", {})
    return bool(listed.get("gaps") or listed.get("undecided"))


def _limits(options: argparse.Namespace, atlas: Atlas) -> RunLimits:
    given = {name: getattr(options, name) for name in ("precision", "order", "width")}
    limits = RunLimits(
        {name: value for name, value in given.items() if value is not None}, options.timeout, options.max_splits,
        options.complete is not None, options.complete or 1,
    )  # fmt: skip
    try:
        attempts_of(atlas, limits)
    except ValueError as error:
        raise InputError(f"--precision, --order, --width: {error}; give larger numbers") from None
    return limits


def _earlier(options: argparse.Namespace, atlas: Atlas, attempts: Sequence[Settings]) -> list[Result]:
    """What an earlier run left in the output file. The certificate of another atlas is not overwritten."""
    path = options.output
    if path is None:
        return []
    check_writable(path)
    if not path.exists() or options.fresh:
        return []
    try:
        before = read_atlas_certificate(path)
    except InputError as error:
        raise InputError(f"{error}; or replace the file with --fresh") from None
    if before.atlas.id != atlas.id:
        raise InputError(
            f"{path}: holds the certificate of another atlas ({before.atlas.id!r}); "
            "choose another output, or replace the file with --fresh"
        )
    return reusable(before, atlas, attempts, options.complete is not None)


def _bifurcations(options: argparse.Namespace, is_surface: bool) -> list[Certificate]:
    """The certificates asked about, in the order of the files."""
    if options.only is not None and not options.bifurcations:
        raise InputError("--only: chooses among bifurcations; give their certificates with --bifurcations")
    if options.bifurcations and is_surface:
        raise InputError("--bifurcations: a surface is about all bifurcations over it; leave them out")
    found: dict[str, Certificate] = {}
    for path in options.bifurcations:
        for name, certificate in read_certificates(path).items():
            if name in found:
                raise InputError(f"{path}: {name!r} is in another file too; give each certificate once")
            found[name] = certificate
    return [found[name] for name in select_ids(found, options.only, "bifurcation", or_none=True)]


def _conclude(
    atlas: Atlas,
    results: Sequence[Result],
    bifurcations: Sequence[Certificate],
    options: argparse.Namespace,
    order: int | None,
) -> dict[str, Any]:
    """What the results give together; the certificates of bifurcations are checked again, side by side.

    With an `order`, all resonances up to it as well.
    """
    return conclusion_of(
        atlas, results, bifurcations, lambda entries: _checked(entries, False, options), order, _placing(options.quiet)
    )


def _placing(quiet: bool) -> Placing:
    """Shows which certificates are looked for on a curve, one after the other."""

    @contextmanager
    def shown(names: Sequence[str]) -> Iterator[Callable[[str], None]]:
        display = Display(dict.fromkeys(names, 1.0), quiet)
        begun: list[str] = []

        def begin(name: str) -> None:
            for before in begun[-1:]:
                display.finish(before, "looked for on the curve")
            begun.append(name)

        with display.shown():
            yield begin
            begin("")

    return shown


def _recheck(options: argparse.Namespace, work: Work) -> int:
    """Whether the certificate stands: its form, its conclusion, and with --integrate what it was made from."""
    for name in ("output", "fresh", "complete"):
        if getattr(options, name):
            raise InputError(f"--{name}: --recheck writes no file; leave it out")
    document = read_document(options.file, SCHEMA)
    try:
        found = examined(document, options, work)
    except KeyboardInterrupt:
        print("interrupted: nothing is known yet", file=sys.stderr)
        return INTERRUPTED
    print(recheck_table([found.id], {found.id: found}), flush=True)
    for finding in found.findings[:1]:
        print(f"FAILED {shown(found.id)}: {finding.place}: {finding.message}", file=sys.stderr)
    return 0 if found.stands else 1


def examined(document: Mapping[str, Any], options: argparse.Namespace, work: Work = prove_task) -> Recheck:
    """The certificate checked again, up to its conclusion or with `options.integrate` to the end."""
    claim = document["statement"]["atlas"].get("claim")
    given = _bifurcations(options, isinstance(claim, dict) and claim.get("kind") == SURFACE)
    # What follows is done here; it takes what this has taken, and integrations have processes of their own.
    concluded = conclusion_apart(document, _check_limits(options), given)
    if not (options.integrate and concluded.stands):
        return concluded

    limit = _check_limits(options).with_integration

    def prove_again(tasks: Sequence[Task], finished: Callable[[Answer], str]) -> None:
        display = Display(dict.fromkeys([task.name for task in tasks], 1.0), options.quiet)
        waiting = deque(tasks)

        def answered(answer: Answer) -> None:
            display.finish(answer.task.name, finished(answer))

        engine_in = engine_of(options.scheduler, options.jobs, limit, options.memory)
        with engine_in as engine, display.shown():
            engine.run(work, lambda: waiting.popleft() if waiting else None, display.advance, answered)

    def check_again(entries: Sequence[Certificate], integrate: bool) -> Sequence[Recheck]:
        return _checked(entries, integrate, options)

    means = Means(check_again, prove_again, limit, _placing(options.quiet))
    return recheck_atlas(document, given, options.integrate, means)


def _check_limits(options: argparse.Namespace) -> CheckLimits:
    """Of the check of a bifurcation, or of the whole certificate without integration."""
    return CheckLimits(options.timeout, options.memory, LONG_CHECK_SECONDS)


def _checked(entries: Sequence[Certificate], integrate: bool, options: argparse.Namespace) -> Sequence[Recheck]:
    """Certificates of bifurcations, checked again side by side, in their order."""
    checks: dict[str, Recheck] = {}
    if not entries:
        return []
    display = Display({entry.id: 1.0 for entry in entries}, options.quiet)

    def finished(check: Recheck) -> None:
        checks[check.id] = check
        display.finish(check.id, "certificate stands" if check.stands_without_place else "certificate does not stand")

    with display.shown():
        recheck_all(entries, integrate, options.jobs, display.advance, finished, _check_limits(options))
    return [checks[entry.id] for entry in entries]


if __name__ == "__main__":
    sys.exit(run_command(main))
