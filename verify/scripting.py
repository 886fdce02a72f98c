"""The verifier for scripts and notebooks: claims in, certificates out; `orbitproof.verify` hands these names on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import closing, suppress
from fractions import Fraction
from pathlib import Path

from orbitproof.shared.claims.web import Web
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import (
    AnyAtlas,
    BoxClaim,
    Candidate,
    CatalogueRows,
    InputError,
    InSection,
    check_writable,
    read_catalogue_rows,
    table_form,
    web_from_json,
)
from orbitproof.shared.formats import read_web as read_claim_of_web
from orbitproof.shared.numbers import parse_exact
from orbitproof.verify.atlas import WITHIN, Placed, certified_table, claiming_indices, kind_of, rows_of_curve
from orbitproof.verify.certificate import (
    Certificate,
    Limits,
    Recheck,
    read_any,
    repeated,
    write_certificate,
    write_certificates,
)
from orbitproof.verify.run import GIBIBYTE, CheckLimits, Workplace
from orbitproof.verify.run.branch_checks import places_on_apart
from orbitproof.verify.run.branch_tasks import RunLimits
from orbitproof.verify.run.branches import conclude_run, limits_of, prove_pieces, started
from orbitproof.verify.run.catalogue_command import certify_rows
from orbitproof.verify.run.checking_again import checked_again
from orbitproof.verify.run.rows import RowRun
from orbitproof.verify.run.second_proofs import Comparison, SecondProofs, problem_of
from orbitproof.verify.run.web_command import certify_the_web


def certify(
    claims: BoxClaim | Iterable[BoxClaim],
    *,
    jobs: int = 1,
    digits: int = Limits.digits,
    max_precision: int = Limits.max_precision,
    timeout: float | None = None,
    level: str = Limits.level,
    other_boxes: int = Limits.other_boxes,
    output: str | Path | None = None,
    fresh: bool = False,
    scheduler: str | None = None,
    quiet: bool = False,
) -> list[Certificate]:
    """Prove what can be proved.

    Each claim is checked in a process of its own. Nothing that is wrong with a claim raises: it is not proved, and
    its certificate says why.

    Arguments:
        claims: candidates, each with an id of its own; in nondimensional units.
        jobs: processes side by side.
        digits: certain decimal digits of the parameter to aim for; a proof with fewer stands all the same.
        max_precision: bits that are never exceeded.
        timeout: seconds for each claim, or `None`.
        level: parameter of Hamiltonian claims: "integral", "coordinates", or "auto" for what suits the claim.
        other_boxes: so many boxes that failures ask for are tried where a claim is not proved; a certificate is about
            the box in its statement.
        output: a file that keeps each certificate as soon as it is there; what is proved in it already is not proved
            again, so that the same call goes on after an interrupt.
        fresh: prove again all the same, and replace the file, whatever it holds.
        scheduler: address of a dask scheduler, whose cluster proves in place of `jobs`.
        quiet: nothing on standard error; else progress with the time that is left.

    Returns the certificates in the order of the claims.

    Raises `InputError` if an id appears twice, `TypeError` for what is no candidate, `ValueError` for a limit that
    makes no sense. After an interrupt (`KeyboardInterrupt`) no process is left.

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
    >>> (proof,) = verify.certify([claim], quiet=True)
    >>> proof
    <Certificate 'nothing here': not proved>
    >>> proof.reason.condition
    'family'
    """
    candidates = [claims] if isinstance(claims, (Candidate, InSection)) else list(claims)
    for claim in candidates:
        if not isinstance(claim, (Candidate, InSection)):
            raise TypeError(
                f"claims: {type(claim).__name__} is no Candidate; explore.refine and read_candidates give some"
            )
    names = _ids(candidates, "claims", "give each candidate its own id")
    limits = Limits(max_precision, digits, timeout, level, other_boxes)
    run = RowRun(candidates, candidates, limits, None if output is None else Path(output), fresh, fresh)
    run.prove(Workplace(_jobs(jobs), scheduler, timeout, quiet=quiet))
    return [run.done[name] for name in names]


def certify_atlas(
    claim: AnyAtlas,
    *,
    complete: int | None = None,
    combinations: bool = False,
    lasting: bool = False,
    bifurcations: Iterable[Certificate] = (),
    jobs: int = 1,
    timeout: float | None = None,
    max_splits: int = RunLimits.max_splits,
    precision: int | None = None,
    order: int | None = None,
    width: int | None = None,
    top: int | None = None,
    output: str | Path | None = None,
    fresh: bool = False,
    scheduler: str | None = None,
    quiet: bool = False,
) -> Certificate:
    """Prove a whole branch, piece by piece: a curve, a libration family, a surface, a curve without symmetry.

    A piece that fails is tried with more precision, then split in two. Nothing that is wrong with a claim raises: it is
    not proved, and its certificate says why.

    Arguments:
        claim: an atlas, from `shared.read_atlas`.
        complete: with it, all resonances 1:1 to 1:`complete` on a curve, and where its orbits are linearly stable.
        combinations: with it and `complete`, combination resonances up to order 4 of linearly stable orbits, for n = 2.
        lasting: which of them are stable for ever, with all exceptions; n = 1, and `complete` at least 4.
        bifurcations: certificates that are looked for on a curve, each with an id of its own.
        jobs: processes side by side.
        timeout: seconds for an interval of a piece, or `None`.
        max_splits: how often an interval is halved at most.
        precision, order, width, top: of the first attempt: bits, degree in time, along the curve, and across it.
        output: a file that keeps every result as soon as it is there; the same call goes on from it.
        fresh: begin anew all the same, and replace the file, whatever it holds.
        scheduler: address of a dask scheduler, whose cluster proves in place of `jobs`.
        quiet: nothing on standard error; else progress with the time that is left.

    Raises `InputError` for what cannot be asked of this atlas, `ValueError` for a limit that makes no sense. After an
    interrupt (`KeyboardInterrupt`) no process is left, and `output` holds what was done.
    """
    given = list(bifurcations)
    _ids(given, "bifurcations")
    if given and not kind_of(claim).holds_points:
        raise InputError("bifurcations: are looked for on curves of symmetric orbits only; leave them out")
    settings = {"precision": precision, "order": order, "width": width, "top": top}
    limits = limits_of(claim, complete, max_splits, timeout, combinations, lasting, **settings)
    run = started(claim, limits, None if output is None else Path(output), fresh)
    workplace = Workplace(_jobs(jobs), scheduler, timeout, quiet=quiet)
    prove_pieces(run, workplace)
    return conclude_run(run, given, workplace)


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
        certificates: from `certify`, `certify_atlas` and so on, or `read`.
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


def certify_catalogue(
    catalogue: str | Path | CatalogueRows | int,
    curve: Certificate,
    *,
    within: Fraction | float | str = WITHIN,
    output: str | Path | None = None,
    table: str | Path | None = None,
    timeout: float | None = None,
    memory: float = CheckLimits.memory / GIBIBYTE,
    quiet: bool = False,
) -> Certificate:
    """Which rows of a catalogue a proved curve certifies, and what it says of the orbits that start near them.

    Arguments:
        catalogue: a file, JSON or CSV in the form of the JPL catalogue, or what `shared.read_catalogue_rows` reads;
            or how many orbits of the curve itself are to be the rows.
        curve: with a list (`certify_atlas(.., complete=1)`); its certificate is checked up to its conclusion first.
        within: an orbit certifies a row from which it starts no farther than this; nondimensional.
        output: a file for the certificate.
        table: a file for the rows with what is proved of each, .json, .csv or .parquet.
        timeout: seconds for each of both; without one, an hour.
        memory: GiB for each.
        quiet: nothing on standard error.

    Returns the certificate; `rows` are its rows. Raises `InputError` for a curve that is of no such system, has
    another mass parameter, or does not stand.
    """
    for path in (output, table):
        if path is not None:
            check_writable(Path(path))
    if table is not None:
        table_form(Path(table))
    if isinstance(catalogue, int):
        rows = rows_of_curve(curve, catalogue)
    else:
        rows = catalogue if isinstance(catalogue, CatalogueRows) else read_catalogue_rows(Path(catalogue))
    distance = parse_exact(within) if isinstance(within, str) else Fraction(within)
    if not distance > 0:
        raise ValueError(f"within: {within} is not positive")
    certificate = certify_rows(
        rows, curve, distance, Workplace(timeout=timeout, memory=int(memory * GIBIBYTE), quiet=quiet)
    )
    if output is not None:
        write_certificate(Path(output), certificate.document)
    if table is not None:
        certified_table(rows, certificate.document).write(Path(table))
    return certificate


def certify_web(
    web: str | Path | Web,
    certificates: Iterable[Certificate],
    *,
    indices: bool = False,
    output: str | Path | None = None,
    jobs: int = 1,
    timeout: float | None = None,
    memory: float = CheckLimits.memory / GIBIBYTE,
    quiet: bool = False,
) -> Certificate:
    """Whether proved curves meet in certified orbits as a web claims, and hang together.

    Arguments:
        web: a file, or a `Web`.
        certificates: of its arcs, vertices and indices, checked up to their conclusions first; others are left out.
        indices: claim the index of each arc of which a certificate of that is given, whatever the web says of it.
        output: a file for the certificate.
        jobs, timeout, memory, quiet: as for `recheck`.

    Returns the certificate, whatever is proved. Raises `InputError` if a certificate that the web names is not given.
    """
    if output is not None:
        check_writable(Path(output))
    claim = web_from_json(to_json(web), "web") if isinstance(web, Web) else read_claim_of_web(Path(web))
    workplace = Workplace(_jobs(jobs), None, timeout, int(memory * GIBIBYTE), quiet)
    given = list(certificates)
    certificate = certify_the_web(claiming_indices(claim, given) if indices else claim, given, workplace)
    if output is not None:
        write_certificate(Path(output), certificate.document)
    return certificate


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
    entries: Sequence[BoxClaim | Certificate],
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
