"""The verifier for scripts and notebooks: claims in, certificates out; `orbitproof.verify` hands these names on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from orbitproof.shared.formats import Candidate, InputError
from orbitproof.verify.certificate import (
    Certificate,
    Limits,
    Recheck,
    certify_all,
    read_certificates,
    recheck_all,
    write_certificates,
)
from orbitproof.verify.engines import GIBIBYTE, CheckLimits, Display


def certify(
    claims: Candidate | Iterable[Candidate],
    *,
    jobs: int = 1,
    digits: int = Limits.digits,
    max_precision: int = Limits.max_precision,
    timeout: float | None = None,
    level: str = Limits.level,
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
    candidates = [claims] if isinstance(claims, Candidate) else list(claims)
    for claim in candidates:
        if not isinstance(claim, Candidate):
            raise TypeError(
                f"claims: {type(claim).__name__} is no Candidate; explore.refine and read_candidates give some"
            )
    names = [claim.id for claim in candidates]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"claims: id {name!r} appears twice; give each candidate its own id")
    limits = Limits(max_precision, digits, timeout, level)
    display = Display({claim.id: float(claim.k) for claim in candidates}, quiet)
    found: dict[str, Certificate] = {}

    def finished(certificate: Certificate) -> None:
        found[certificate.id] = certificate
        display.finish(certificate.id, f"{certificate.verdict}, {certificate.computation.seconds:.1f} s")

    with display.shown():
        certify_all(candidates, limits, _jobs(jobs), display.advance, finished)
    return [found[name] for name in names]


def recheck(
    certificates: Certificate | Iterable[Certificate],
    *,
    integrate: bool = False,
    jobs: int = 1,
    timeout: float | None = None,
    memory: float = CheckLimits.memory / GIBIBYTE,
    quiet: bool = False,
) -> list[Recheck]:
    """Check certificates again: whether each verdict follows from the enclosures that the certificate carries.

    Each is checked in a process of its own: one that hangs, or takes too much memory, cannot be checked, and that is
    all that it does.

    Arguments:
        certificates: from `certify` or `read`, each with an id of its own.
        integrate: enclose again, at another precision and order, and prove again from that.
        jobs: processes side by side.
        timeout: seconds for each check; without one 300, and four hours with `integrate`.
        memory: GiB for each process.
        quiet: nothing on standard error.

    Returns one `Recheck` for each certificate, in their order; `stands` says whether all is as it should be,
    `findings` what is not, `obstacle` why it cannot be checked. Raises `InputError` if an id appears twice,
    `ValueError` for a limit that makes no sense.
    """
    limits = CheckLimits(timeout, int(memory * GIBIBYTE))
    entries = [certificates] if isinstance(certificates, Certificate) else list(certificates)
    names = [entry.id for entry in entries]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"certificates: id {name!r} appears twice; give each certificate once")
    display = Display(dict.fromkeys(names, 1.0), quiet)
    found: dict[str, Recheck] = {}

    def finished(result: Recheck) -> None:
        found[result.id] = result
        display.finish(result.id, result.word)

    with display.shown():
        recheck_all(entries, integrate, _jobs(jobs), display.advance, finished, limits)
    return [found[name] for name in names]


def read(path: str | Path) -> list[Certificate]:
    """The certificates of a file, in its order.

    Raises `InputError`, one line with file, field and remedy, for anything else.

    >>> from orbitproof import verify
    >>> verify.read("no-such-file.json")
    Traceback (most recent call last):
    orbitproof.shared.errors.InputError: no-such-file.json: cannot be read (No such file or directory); \
give the path of a certificates file
    """
    return list(read_certificates(Path(path)).values())


def write(path: str | Path, certificates: Sequence[Certificate]) -> None:
    """Write certificates to a file (docs/formats.md), whole or not at all; a file that is there is replaced.

    Raises `InputError` if an id appears twice, there is nothing to write or the file cannot be written.
    """
    names = [certificate.id for certificate in certificates]
    if not names:
        raise InputError(f"{path}: there are no certificates to write")
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{path}: id {name!r} appears twice; give each certificate its own id")
    write_certificates(Path(path), certificates)


def _jobs(jobs: int) -> int:
    with suppress(TypeError):
        if jobs >= 1 and int(jobs) == jobs:
            return int(jobs)
    raise ValueError(f"jobs: {jobs!r} is not a positive integer")
