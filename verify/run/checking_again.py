"""Certificates of all kinds checked again, for the command line and for Python alike."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import replace

from orbitproof.verify.certificate import Certificate, Given, Recheck
from orbitproof.verify.certificate.kinds import kind_named
from orbitproof.verify.run import Display, Workplace
from orbitproof.verify.run.rows import rechecks

Checked = Generator[tuple[Certificate, Recheck], None, None]
Known = dict[Certificate, Recheck]


def checked_again(
    certificates: Sequence[Certificate],
    below: Sequence[Certificate],
    integrate: bool,
    workplace: Workplace,
    known: Known | None = None,
    places: bool = True,
) -> Checked:
    """Each certificate with what checking it again shows, as soon as that is there; to be closed, whatever ends it.

    One that says where on a curve it lies has two verdicts: the second, with the place, takes that of the first.

    Args:
        below: among these are those on which others rest, which are checked as far: what places rest on, the curve of
            an index or of a catalogue, the parts of a web.
        known: checks that were made already, as far; what is found is added.
        places: whether places on curves are looked at.

    Raises `InputError` if an id of rows appears twice, or what one rests on is not given.
    """
    known = {} if known is None else known
    rows = {entry.id: entry for entry in certificates if entry.key[0] == "vertex"}
    others = [entry for entry in certificates if entry.key[0] != "vertex"]
    needed = {entry: kind_named(entry.kind).rests_on(entry, below) for entry in others}
    display = Display({name: _work(entry, integrate) for name, entry in rows.items()}, workplace.quiet)
    given = [entry for entry in certificates if entry.key[0] == "vertex"]
    checks = rechecks(given, integrate, workplace.jobs, display.advance, workplace.row_checks)
    with display.shown(), closing(checks):
        for check in checks:
            known[rows[check.id]] = check
            yield rows[check.id], check
            display.finish(check.id, "stands" if check.stands_without_place else "does not stand")
    placed = [entry for entry in rows.values() if places and "place" in entry.document]
    if not placed and not others:
        return
    # Only now: curves take a moment to load.
    from orbitproof.verify.run.branch_checks import check_apart, examined, places_checked

    if placed:
        curve = next((entry for entry in below if entry.key[0] == "arc"), None)
        first = {entry.id: known[entry] for entry in placed}
        for check in places_checked(curve, placed, first, integrate, workplace):
            yield rows[check.id], check
    for entry in others:
        if entry not in known and not needed[entry]:
            known[entry] = examined(entry, (), integrate, workplace)
        elif entry not in known:
            parts = needed[entry]
            for _ in checks_of_parts(parts, below, integrate, workplace, known):
                pass
            own = Given(parts, {part.key: known[part] for part in parts})
            known[entry] = check_apart(entry, own, workplace.branch_checks)
        yield entry, known[entry]


def checks_of_parts(
    parts: Sequence[Certificate],
    below: Sequence[Certificate],
    integrate: bool,
    workplace: Workplace,
    known: Known,
) -> Iterator[Recheck]:
    """The checks of what one certificate rests on."""
    names = {entry: f"index of {entry.id}" if entry.key[0] == "index" else entry.id for entry in parts}
    display = Display(dict.fromkeys(names.values(), 1.0), workplace.quiet)
    quiet = replace(workplace, quiet=True) if len(parts) > 1 else workplace
    waiting = [entry for entry in parts if entry not in known]
    with display.shown(), closing(checked_again(waiting, below, integrate, quiet, known)) as checks:
        for entry, check in checks:
            display.finish(names[entry], "stands" if check.stands else "does not stand")
            yield check


def _work(certificate: Certificate, integrate: bool) -> float:
    """A measure of the work that checking again takes: the time of the first integration."""
    return certificate.computation.seconds + 0.1 if integrate else 1.0
