"""What the command lines share that prove one claim from certificates: of an index, a web, rows of a catalogue."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from typing import Any

from orbitproof.shared.answers import answered, tell
from orbitproof.shared.formats import InputError, as_options, refused
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.output import what_is_written
from orbitproof.shared.printed_tables import wrapped
from orbitproof.shared.processes import Failure
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import Certificate, Recheck
from orbitproof.verify.run.branch_checks import examined
from orbitproof.verify.run.checking_again import checked_again
from orbitproof.verify.run.options import ArgumentParser, positive_seconds, whole_number
from orbitproof.verify.run.progress import Display
from orbitproof.verify.run.row_tables import recheck_table, rechecks_as_json
from orbitproof.verify.run.workplace import LONG_CHECK_SECONDS, CheckLimits, Workplace, apart


def add_checking_options(parser: ArgumentParser, recheck: str, integrate: str, jobs: str) -> None:
    """Options of checks: the words of `--recheck` and `--integrate`, and what stands side by side."""
    parser.add_argument("--recheck", action="store_true", help=recheck)
    parser.add_argument("--integrate", action="store_true", help=f"with --recheck: {integrate}")
    parser.number("--jobs", "N", f"{jobs} side by side (default: 1)", whole_number(1), 1)
    words = f"give a check up after this processor time (default: {LONG_CHECK_SECONDS:g})"
    parser.number("--timeout", "SECONDS", words, positive_seconds, None)
    parser.memory_option("each check")
    parser.add_argument("--quiet", action="store_true", help="no progress on stderr")


def limits_of(workplace: Workplace) -> CheckLimits:
    """The limits of one check."""
    return CheckLimits(workplace.timeout, workplace.memory, LONG_CHECK_SECONDS)


def prove_or_check(
    command: str,
    options: argparse.Namespace,
    prove: Callable[[argparse.Namespace, Workplace], int],
    check: Callable[[argparse.Namespace, Workplace], Recheck],
) -> int:
    """Do what is asked for by `command`; returns the exit code."""
    return answered(f"orbitproof verify {command}", options.json, lambda: _done(options, prove, check))


def _done(
    options: argparse.Namespace,
    prove: Callable[[argparse.Namespace, Workplace], int],
    check: Callable[[argparse.Namespace, Workplace], Recheck],
) -> int:
    workplace = Workplace(options.jobs, None, options.timeout, options.memory, options.quiet)
    try:
        if not options.recheck:
            if options.integrate:
                raise InputError("--integrate: there is nothing to integrate again; give it together with --recheck")
            return prove(options, workplace)
        if options.output is not None:
            raise InputError("--output: --recheck writes no file; leave it out")
        return _told_again(check(options, workplace))
    except InputError as error:
        return refused(error)
    except KeyboardInterrupt:
        known = "nothing is known yet" if options.recheck else what_is_written()
        print(f"interrupted: {known}", file=sys.stderr)
        return INTERRUPTED


def check_of(certificate: Certificate, below: Sequence[Certificate], integrate: bool, workplace: Workplace) -> Recheck:
    """What checking a certificate again shows that rests on others, which are checked as far."""
    with closing(checked_again([certificate], below, integrate, workplace)) as checks:
        ((_, check),) = checks
    return check


def by_curve(
    curve: Certificate,
    work: Callable[..., dict[str, Any]],
    arguments: Sequence[object],
    workplace: Workplace,
    tasks: Mapping[str, float],
    failed: str,
) -> dict[str, Any]:
    """What `work` makes of the certificate of a curve, which is checked up to its conclusion first.

    Args:
        arguments: of `work`, after the certificate.
        tasks: the name of the work, with how long it takes, that of checking the curve being 1.
        failed: what is told if it comes to no end.

    Raises `InputError` if the certificate does not stand, or is of no such curve, or the work comes to no end.
    """
    (name,) = tasks
    display = Display({"curve": 1.0, **tasks}, workplace.quiet)
    with display.shown():
        check = examined(curve, (), False, workplace)
        if not check.stands:
            raise InputError(f"the certificate {shown(curve.id)} of the curve does not stand: {check.why}")
        display.finish("curve", "stands")
        found = apart(work, curve.id, (curve, *arguments), limits_of(workplace))
        if isinstance(found, Failure):
            raise found.error if isinstance(found.error, InputError) else InputError(f"{failed}: {found.message}")
        display.finish(name, str(found["verdict"]))
    return found


def told(certificate: Certificate) -> int:
    """Print what is proved, or why it is not; returns the exit code."""
    reason = certificate.reason
    result = {name: certificate.document.get(name) for name in ("id", "verdict", "reason")}
    if reason is None:
        tell(wrapped(f"PROVED\n\n{certificate.theorem}".splitlines()), [result | {"theorem": certificate.theorem}])
        return 0
    words = f"NOT PROVED: {reason.condition}: {reason.message}; {as_options(reason.remedy)}"
    tell(wrapped([words]), [result])
    return 1


def _told_again(found: Recheck) -> int:
    tell(recheck_table([found.id], {found.id: found}), rechecks_as_json([found.id], {found.id: found}))
    for finding in found.findings[:1]:
        print(f"FAILED {shown(found.id)}: {finding.place}: {finding.message}", file=sys.stderr)
    return 0 if found.stands else 1
