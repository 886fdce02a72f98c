"""The theorems of certificate files, each checked again up to its conclusion before it may be told (section 13)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from orbitproof.shared.formats import (
    KREIN_COLLISION,
    AnyAtlas,
    ArgumentError,
    BoxClaim,
    InputError,
    InSection,
    claim_from_json,
    read_document,
    select_ids,
    stated_format,
)
from orbitproof.shared.systems import SYSTEMS
from orbitproof.verify.atlas import SCHEMA, atlas_of
from orbitproof.verify.bifurcation import level_form
from orbitproof.verify.certificate import Certificate, Recheck, read_certificates, systems_with
from orbitproof.verify.run import LONG_CHECK_SECONDS, CheckLimits, Display
from orbitproof.verify.run.branch_checks import conclusion_apart
from orbitproof.verify.run.rows import rechecks
from orbitproof.verify.second_proof import BadCertificate, CannotFollow, read_claim


class Refused(Exception):
    """Certificates that do not stand, with what was found: nothing of them may be told."""

    def __init__(self, rechecks: Sequence[tuple[Path, Recheck]]) -> None:
        super().__init__(", ".join(result.id for _, result in rechecks))
        self.rechecks = tuple(rechecks)


@dataclass(frozen=True)
class CheckedRow:
    """A certificate of a bifurcation or an orbit that follows from what it carries.

    Attributes:
        path: its file.
        certificate: as it was read.
        candidate: the claim.
        claim: what the hypotheses are about, the candidate or its level form.
        check: what checking it has shown.
    """

    path: Path
    certificate: Certificate
    candidate: BoxClaim
    claim: BoxClaim
    check: Recheck

    command = "verify"
    """What proves it, and checks it again."""
    chapter = "bifurcations"
    """Of the report."""

    @property
    def name(self) -> str:
        """The certificate's id."""
        return self.certificate.id

    @cached_property
    def document(self) -> Mapping[str, Any]:
        """The certificate as JSON."""
        return self.certificate.to_json()

    @property
    def side(self) -> str:
        """Where the new orbits are; empty if there are none, as at a collision, whose side is that of stable orbits."""
        return "" if self.certificate.kind == KREIN_COLLISION else self.certificate.side or ""


@dataclass(frozen=True)
class CheckedAtlas:
    """A certificate of a curve or surface that follows from what it carries: file, claim, document, check."""

    path: Path
    atlas: AnyAtlas
    document: Mapping[str, Any]
    check: Recheck

    command = "verify atlas"
    side = ""

    @property
    def name(self) -> str:
        """The certificate's id."""
        return str(self.document["id"])

    @property
    def chapter(self) -> str:
        """Of the report."""
        return "surfaces" if self.atlas.is_surface else "curves"


Checked = CheckedRow | CheckedAtlas


def check_files(
    paths: Sequence[Path],
    only: Sequence[str] | None = None,
    quiet: bool = True,
    timeout: float | None = None,
    memory: int = CheckLimits.memory,
) -> list[Checked]:
    """Read certificates files of both kinds and check every certificate, each in a process of its own.

    Arguments:
        only: ids, or patterns of ids.
        timeout, memory: of each check, in seconds and bytes.

    Raises:
        InputError: for what cannot be read, and if two different certificates have the same id.
        Refused: if a certificate does not stand or cannot be checked here; it names all of these.
    """
    entries = [entry for path in paths for entry in _read(path)]
    if not entries:
        raise InputError(f"{paths[0]}: holds no certificates; prove something first")
    names = [_name(entry) for _, entry in entries]
    if only is not None:
        chosen = set(select_ids(names, only, "certificate"))
        entries = [entry for entry in entries if _name(entry[1]) in chosen]
        names = [_name(entry) for _, entry in entries]
    for (path, _), name in zip(entries, names, strict=True):
        if names.count(name) > 1:
            raise ArgumentError(
                "{0}: {1!r} is given twice; give each certificate once, or choose with {only}; two that are called the "
                "same need names of their own (explore, {id})",
                path,
                name,
            )
    display = Display({name: _work(entry) for name, (_, entry) in zip(names, entries, strict=True)}, quiet)
    checks: dict[str, Recheck] = {}

    def finished(check: Recheck) -> None:
        checks[check.id] = check
        display.finish(check.id, check.word)

    rows = [entry for _, entry in entries if isinstance(entry, Certificate)]
    again = rechecks(rows, False, 1, display.advance, CheckLimits(timeout, memory))
    with display.shown(), closing(again):
        for check in again:
            finished(check)
        for _, entry in entries:
            if not isinstance(entry, Certificate):
                finished(conclusion_apart(entry, CheckLimits(timeout, memory, LONG_CHECK_SECONDS)))
    found = [(path, entry, checks[name]) for name, (path, entry) in zip(names, entries, strict=True)]
    # A place on a curve is not told.
    refused = [(path, check) for path, _, check in found if not check.stands_without_place]
    if refused:
        raise Refused(refused)
    return [_checked(path, entry, check) for path, entry, check in found]


def has_second_proof(entry: CheckedRow) -> bool:
    """Whether the second proof is about such a claim."""
    with suppress(CannotFollow, BadCertificate):
        read_claim(entry.certificate.to_json())
        return True
    return False


def _read(path: Path) -> list[tuple[Path, Certificate | Mapping[str, Any]]]:
    if stated_format(path, "give the path of a certificates file") == SCHEMA:
        return [(path, read_document(path, SCHEMA))]
    return [(path, certificate) for certificate in read_certificates(path).values()]


def _name(entry: Certificate | Mapping[str, Any]) -> str:
    return entry.id if isinstance(entry, Certificate) else str(entry["id"])


def _work(entry: Certificate | Mapping[str, Any]) -> float:
    return 1.0 if isinstance(entry, Certificate) else 1.0 + len(entry["results"]) / 10


def _checked(path: Path, entry: Certificate | Mapping[str, Any], check: Recheck) -> Checked:
    # Words that are not this version's follow from nothing, and are not told.
    if not isinstance(entry, Certificate):
        return CheckedAtlas(path, atlas_of(entry), check.rendered or entry, check)
    entry = entry if check.rendered is None else Certificate.from_json(check.rendered)
    statement = entry.statement
    stated = statement["candidate"]
    candidate = claim_from_json(stated, "statement.candidate", systems_with(SYSTEMS, statement, stated))
    form = None if "level_form" not in statement or isinstance(candidate, InSection) else level_form(candidate)
    return CheckedRow(path, entry, candidate, form or candidate, check)
