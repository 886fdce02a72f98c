"""Certificates of all kinds checked again, for the command line and for Python alike."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import closing
from typing import TYPE_CHECKING

from orbitproof.verify.certificate import Certificate, Recheck
from orbitproof.verify.run import Display, Workplace
from orbitproof.verify.run.rows import rechecks

if TYPE_CHECKING:
    from orbitproof.verify.atlas import AtlasCertificate


def checked_again(
    certificates: Sequence[Certificate | AtlasCertificate],
    curve: AtlasCertificate | None,
    integrate: bool,
    workplace: Workplace,
) -> Generator[Recheck, None, None]:
    """What checking each certificate again shows, as soon as it is there; to be closed, whatever ends it.

    One that says where on a curve it lies has two verdicts: the second, with the place, takes that of the first.

    Args:
        certificates: each with an id of its own.
        curve: what the places rest on; it is checked as far as the others.

    Raises `InputError` if an id of rows appears twice.
    """
    rows = [entry for entry in certificates if isinstance(entry, Certificate)]
    display = Display({entry.id: _work(entry, integrate) for entry in rows}, workplace.quiet)
    found = dict[str, Recheck]()
    checks = rechecks(rows, integrate, workplace.jobs, display.advance, workplace.row_checks)
    with display.shown(), closing(checks):
        for check in checks:
            found[check.id] = check
            yield check
            display.finish(check.id, "stands" if check.stands_without_place else "does not stand")
    placed = [entry for entry in rows if "place" in entry.to_json()]
    if not placed and len(rows) == len(certificates):
        return
    # Only now: curves take a moment to load.
    from orbitproof.verify.run.branch_checks import examined, places_checked

    if placed:
        yield from places_checked(curve, placed, found, integrate, workplace)
    for entry in certificates:
        if not isinstance(entry, Certificate):
            yield examined(entry.document, (), integrate, workplace)


def _work(certificate: Certificate, integrate: bool) -> float:
    """A measure of the work that checking again takes: the time of the first integration."""
    return certificate.computation.seconds + 0.1 if integrate else 1.0
