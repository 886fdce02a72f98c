"""The verifier for scripts and notebooks: claims in, certificates out; `orbitproof.verify` hands these names on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import closing, suppress
from fractions import Fraction
from pathlib import Path

from orbitproof.shared.formats import InputError
from orbitproof.verify.branches import Placed
from orbitproof.verify.certificate import (
    Certificate,
    Recheck,
    read_any,
    repeated,
    write_certificate,
    write_certificates,
)
from orbitproof.verify.run import GIBIBYTE, CheckLimits, Workplace
from orbitproof.verify.run.branch_checks import places_on_apart
from orbitproof.verify.run.checking_again import checked_again
from orbitproof.verify.run.proofs import AnyClaim, Asked, certified, read_any_claims
from orbitproof.verify.run.second_proofs import Comparison, SecondProofs, problem_of


def certify(
    claims: AnyClaim | Iterable[AnyClaim] | str | Path,
    *,
    rests_on: Certificate | Iterable[Certificate] = (),
    output: str | Path | None = None,
    fresh: bool = False,
    jobs: int = 1,
    scheduler: str | None = None,
    timeout: float | None = None,
    memory: float = CheckLimits.memory / GIBIBYTE,
    quiet: bool = False,
    digits: int | None = None,
    max_precision: int | None = None,
    level: str | None = None,
    other_boxes: int | None = None,
    complete: int | None = None,
    combinations: bool | None = None,
    lasting: bool | None = None,
    max_splits: int | None = None,
    precision: int | None = None,
    order: int | None = None,
    width: int | None = None,
    top: int | None = None,
    indices: bool | None = None,
    within: Fraction | float | str | None = None,
    table: str | Path | None = None,
) -> list[Certificate]:
    """Prove what can be proved, of claims of any kind.

    What a claim is decides how it is proved. Each box and each interval of a branch is looked at in a process of its
    own. Nothing that is wrong with a claim raises: it is not proved, and its certificate says why.

    Arguments:
        claims: one or several, or a file of them; in nondimensional units. Of boxes: candidates, each with an id of its
            own. Of branches: atlases, from `shared.read_atlas`. Of curves that meet: a `shared.Web`. Of the index along
            a proved curve: a `shared.IndexAlong`. Rows of a catalogue: what `shared.read_catalogue_rows` reads, or
            `rows_of_curve` makes.
        rests_on: certificates on which a claim rests, checked up to their conclusions first. Of a branch: those of
            bifurcations that are looked for on it. Of a web: its arcs, vertices and indices. Of an index, and of rows:
            the curve.
        output: a file that keeps each certificate, or each result of a branch, as soon as it is there; the same call
            goes on from it, and proves nothing again that is proved in it.
        fresh: begin anew all the same, and replace the file, whatever it holds.
        jobs: processes side by side.
        scheduler: address of a dask scheduler, whose cluster proves boxes and branches in place of `jobs`.
        timeout: seconds for each box, each interval of a branch, and each check; `None` for what is usual.
        memory: GiB for each check.
        quiet: nothing on standard error; else progress with the time that is left.
        digits: of a box: certain decimal digits of the parameter to aim for; a proof with fewer stands all the same.
        max_precision: of a box: bits that are never exceeded.
        level: of a box: the parameter of Hamiltonian claims: "integral", "coordinates", or "auto" for what suits.
        other_boxes: of a box: so many boxes that failures ask for are tried where a claim is not proved; a certificate
            is about the box in its statement.
        complete: of a curve: all resonances 1:1 to 1:`complete` on it, and where its orbits are linearly stable.
        combinations: with `complete`: combination resonances up to order 4 of linearly stable orbits, for n = 2.
        lasting: with `complete`, at least 4: which of them are stable for ever, with all exceptions, for n = 1.
        max_splits: of a branch: how often an interval is halved at most.
        precision, order, width, top: of a branch: bits, and degree in time, along the curve, and across it, at first.
        indices: of a web: claim the index of each arc of which a certificate of that is given, whatever it says.
        within: of rows: an orbit certifies a row from which it starts no farther than this; nondimensional.
        table: of rows: a file for them with what is proved of each, .json, .csv or .parquet.

    Returns the certificates in the order of the claims.

    Raises `InputError` if an id appears twice, for what cannot be asked of such a claim and for certificates that are
    missing or do not stand; `TypeError` for what is no claim, `ValueError` for a limit that makes no sense. After an
    interrupt (`KeyboardInterrupt`) no process is left, and `output` holds what was done.

    A wrong claim, here a 1:2 resonance of the Falkner-Skan equation where there is none:

    >>> from fractions import Fraction
    >>> from orbitproof import verify
    >>> from orbitproof.shared import FALKNER_SKAN, Candidate
    >>> one, zero = Fraction(1), Fraction(0)
    >>> claim = Candidate(
    ...     id="nothing here", system=FALKNER_SKAN, parameters={}, kind="period_tupling", k=2,
    ...     centre=(Fraction(450), Fraction("0.93")), frame=((one, zero), (zero, one)), kernel_frame=((one,),),
    ...     radii=(Fraction(1, 10**6), Fraction(1, 10**6)),
    ... )
    >>> (proof,) = verify.certify(claim, quiet=True)
    >>> proof
    <Certificate 'nothing here': not proved>
    >>> proof.reason.condition
    'family'
    """
    options = {
        "scheduler": scheduler, "digits": digits, "max_precision": max_precision, "level": level,
        "other_boxes": other_boxes, "complete": complete, "combinations": combinations, "lasting": lasting,
        "max_splits": max_splits, "precision": precision, "order": order, "width": width, "top": top,
        "indices": indices, "within": within, "table": table,
    }  # fmt: skip
    if isinstance(claims, (str, Path)):
        asked = read_any_claims(Path(claims))
    else:
        asked = list(claims) if isinstance(claims, Iterable) else [claims]
    workplace = Workplace(_jobs(jobs), scheduler, timeout, int(memory * GIBIBYTE), quiet)
    where = None if output is None else Path(output)
    return certified(asked, Asked(_several(rests_on), workplace, where, fresh, options))


def recheck(
    certificates: Certificate | Iterable[Certificate],
    *,
    rests_on: Certificate | Iterable[Certificate] = (),
    integrate: bool = False,
    jobs: int = 1,
    timeout: float | None = None,
    memory: float = CheckLimits.memory / GIBIBYTE,
    quiet: bool = False,
) -> list[Recheck]:
    """Check certificates of any kind again: whether each verdict follows from what the certificate carries.

    Each is checked in a process of its own: one that hangs, or takes too much memory, cannot be checked, and that is
    all that it does.

    Arguments:
        certificates: from `certify` or `read`.
        rests_on: certificates on which these rest, checked as far as they are: the curve on which certified orbits have
            their places, the curve of an index or of a catalogue, the arcs, vertices and indices of a web.
        integrate: enclose again, at another precision and order, and prove again from that.
        jobs: processes side by side.
        timeout: seconds for each check; without one 300, and four hours with `integrate`.
        memory: GiB for each process.
        quiet: nothing on standard error.

    Returns one `Recheck` for each certificate, in their order; `stands` says whether all is as it should be,
    `findings` what is not, `obstacle` why it cannot be checked. Raises `InputError` if an id of rows or curves appears
    twice or what one rests on is not given, `ValueError` for a limit that makes no sense.
    """
    workplace = Workplace(_jobs(jobs), None, timeout, int(memory * GIBIBYTE), quiet)
    given, below = _several(certificates), _several(rests_on)
    _ids([entry for entry in given if entry.key[0] in ("vertex", "arc")], "certificates")
    found: dict[Certificate, Recheck] = {}
    with closing(checked_again(given, below, integrate, workplace)) as checks:
        for entry, check in checks:
            found[entry] = check
    return [found[entry] for entry in given]


def places(curve: Certificate, orbits: Iterable[Certificate], *, timeout: float | None = None) -> list[Placed]:
    """Where certified orbits lie on a curve that is proved (sections 15.8 and 19.6).

    Arguments:
        curve: its certificate is checked up to its conclusion first, and so is each orbit's.
        timeout: seconds for that; without one, an hour.

    Returns for each orbit its certificate with the place, if it is shown, and a line that says where, or why it is not
    shown.
    """
    return places_on_apart(curve, list(orbits), Workplace(timeout=timeout).branch_checks)


def prove_again(
    certificates: Certificate | Iterable[Certificate],
    *,
    output: str | Path | None = None,
    fresh: bool = False,
    jobs: int = 1,
    timeout: float | None = None,
    memory: float = CheckLimits.memory / GIBIBYTE,
    quiet: bool = False,
) -> list[Comparison]:
    """Prove certified bifurcations once more, by code that shares nothing with the first proof, and compare.

    Arguments:
        certificates: of bifurcations, each with an id of its own.
        output: a file that keeps each second proof as soon as it is there; the same call goes on from it.
        fresh: prove again what is in it.
        jobs, timeout, memory, quiet: as for `recheck`.

    Returns for each a verdict, "agrees", "disagrees" or "cannot follow", and what agrees, where, or why not. Raises
    `InputError` if an id appears twice or a certificate is not well formed.
    """
    entries = [certificates] if isinstance(certificates, Certificate) else list(certificates)
    _ids(entries, "certificates")
    workplace = Workplace(_jobs(jobs), None, timeout, int(memory * GIBIBYTE), quiet)
    known = {entry.id: entry.to_json() for entry in entries}
    if problem := problem_of(known, CheckLimits(memory=workplace.memory)):
        raise InputError(f"certificates: {problem}")
    proofs = SecondProofs(known, None if output is None else Path(output), fresh)
    proofs.prove(workplace)
    return [Comparison(proofs.rows[name]["verdict"], proofs.rows[name]["reason"]) for name in known]


def read(path: str | Path) -> list[Certificate]:
    """The certificates of a file, in its order: those of rows, or the one of a curve, a web, an index, a catalogue.

    Raises `InputError`, one line with file, field and remedy, for anything else, and for what was changed.

    >>> from orbitproof import verify
    >>> verify.read("no-such-file.json")
    Traceback (most recent call last):
    orbitproof.shared.errors.InputError: no-such-file.json: cannot be read (No such file or directory); \
give the path of a certificates file
    """
    return read_any(Path(path))


def write(path: str | Path, certificates: Certificate | Iterable[Certificate]) -> None:
    """Write certificates to a file (docs/formats.md), whole or not at all; a file that is there is replaced.

    A file holds any number of certificates of rows, or one of a curve, a web, an index, a catalogue. Raises
    `InputError` if an id appears twice, there is nothing to write or the file cannot be written.
    """
    entries = _several(certificates)
    if not _ids(entries, str(path), "give each certificate its own id"):
        raise InputError(f"{path}: there are no certificates to write")
    rows = [entry for entry in entries if "format" not in entry.document]
    if len(rows) == len(entries):
        write_certificates(Path(path), rows)
        return
    if len(entries) > 1:
        raise InputError(f"{path}: the certificate of a curve, web, index or catalogue has a file of its own")
    write_certificate(Path(path), entries[0].document)


def _several(certificates: Certificate | Iterable[Certificate]) -> list[Certificate]:
    return [certificates] if isinstance(certificates, Certificate) else list(certificates)


def _ids(
    entries: Sequence[Certificate],
    where: str,
    remedy: str = "give each certificate once",
) -> list[str]:
    """The ids of these, in their order. Raises `InputError` if one appears twice."""
    for name in repeated(entries):
        raise InputError(f"{where}: id {name!r} appears twice; {remedy}")
    return [entry.id for entry in entries]


def _jobs(jobs: int) -> int:
    with suppress(TypeError):
        if jobs >= 1 and int(jobs) == jobs:
            return int(jobs)
    raise ValueError(f"jobs: {jobs!r} is not a positive integer")
