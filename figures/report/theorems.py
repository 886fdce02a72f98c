"""The theorems of certificate files, each checked again up to its conclusion before it may be told (section 13)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from orbitproof.shared.formats import (
    DOUBLE_RESONANCE,
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
from orbitproof.shared.systems import SYSTEMS, shown
from orbitproof.verify.atlas import (
    AtlasCertificate,
    CatalogueCertificate,
    IndexCertificate,
    Key,
    Resting,
    WebCertificate,
    atlas_of,
    key_of,
    recheck_catalogue,
    recheck_web,
    resting,
)
from orbitproof.verify.bifurcation import level_form
from orbitproof.verify.certificate import (
    CannotBeCheckedError,
    Certificate,
    Recheck,
    not_checked,
    read_certificates,
    systems_with,
)
from orbitproof.verify.run import LONG_CHECK_SECONDS, CheckLimits, Display, Failure, apart
from orbitproof.verify.run.branch_checks import conclusion_apart, index_apart
from orbitproof.verify.run.rows import rechecks
from orbitproof.verify.second_proof import BadCertificate, CannotFollow, read_claim

ATLAS, WEB, CATALOGUE, INDEX = "atlas-certificate", "web-certificate", "catalogue-certificate", "index-certificate"
CERTIFICATE_FORMATS = ("certificates", ATLAS, WEB, CATALOGUE, INDEX)
"""Formats of files that a report may be about."""


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
    """Chapter of the report."""

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
        """Where the new orbits are; empty if none are told of: the side of a collision is that of stable orbits."""
        return "" if self.certificate.kind in (KREIN_COLLISION, DOUBLE_RESONANCE) else self.certificate.side or ""


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
        """Chapter of the report."""
        return "surfaces" if self.atlas.is_surface else "curves"


@dataclass(frozen=True)
class CheckedWeb:
    """A certificate of a web that follows from those that it rests on, with these."""

    path: Path
    certificate: WebCertificate
    document: Mapping[str, Any]
    rests_on: tuple[CheckedRow | CheckedAtlas | CheckedIndex, ...]
    check: Recheck

    command = "verify web"
    chapter = "webs"
    side = ""

    @property
    def name(self) -> str:
        """The certificate's id."""
        return self.certificate.id


@dataclass(frozen=True)
class CheckedCatalogue:
    """A certificate of a catalogue's rows that follows from that of its curve, with that."""

    path: Path
    certificate: CatalogueCertificate
    document: Mapping[str, Any]
    rests_on: tuple[CheckedAtlas]
    check: Recheck

    command = "verify catalogue"
    chapter = "catalogues"
    side = ""

    @property
    def name(self) -> str:
        """The certificate has the id of its curve; its file tells it from others by that curve."""
        return name_of_rows(self.path, self.certificate)


@dataclass(frozen=True)
class CheckedIndex:
    """A certificate of the index along a curve that follows from that of the curve, with that."""

    path: Path
    certificate: IndexCertificate
    document: Mapping[str, Any]
    rests_on: tuple[CheckedAtlas]
    check: Recheck

    command = "verify index"
    chapter = "indices"
    side = ""

    @property
    def name(self) -> str:
        """What the certificates are called, as a catalogue has a name."""
        return name_of_rows(self.path, self.certificate)


Checked = CheckedRow | CheckedAtlas | CheckedWeb | CheckedCatalogue | CheckedIndex
Entry = Certificate | Mapping[str, Any] | WebCertificate | CatalogueCertificate | IndexCertificate
"""What is read of a file; of a branch the document."""


def name_of_rows(path: Path, certificate: CatalogueCertificate | IndexCertificate) -> str:
    """What a certificate with the id of its curve is called among others, of a catalogue or of an index."""
    return f"{certificate.document['id']}-{path.stem}"


def check_files(
    paths: Sequence[Path],
    only: Sequence[str] | None = None,
    quiet: bool = True,
    timeout: float | None = None,
    memory: int = CheckLimits.memory,
) -> list[Checked]:
    """Read certificates files of all kinds and check every certificate, each in a process of its own.

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
    names = [_name(path, entry) for path, entry in entries]
    wanted = set(names) if only is None else set(select_ids(names, only, "certificate"))
    every = [each for _, each in entries]
    indices = {
        each.document["digest"]: name
        for name, each in zip(names, every, strict=True) if isinstance(each, IndexCertificate)
    }  # fmt: skip

    def called(each: Resting) -> str:
        return indices[each.document["digest"]] if isinstance(each, IndexCertificate) else each.id

    rests_on: dict[str, tuple[Resting, ...]] = {}
    needed: set[str] = set()
    # What a web needs, an index among that, needs others itself.
    more = wanted
    while more:
        found_now = {
            name: _rests_on(path, entry, every)
            for name, (path, entry) in zip(names, entries, strict=True) if name in more
        }  # fmt: skip
        rests_on |= found_now
        needed |= more
        more = {called(each) for resting in found_now.values() for each in resting} - needed
    for name, (path, _) in zip(names, entries, strict=True):
        if name in needed and names.count(name) > 1:
            raise ArgumentError(
                "{0}: {1!r} is given twice; give each certificate once, or choose with {only}; two that are called the "
                "same need names of their own (explore, {id})",
                path,
                name,
            )
    given = {name: entry for name, entry in zip(names, entries, strict=True) if name in needed}
    display = Display({name: _work(entry) for name, (_, entry) in given.items()}, quiet)
    limits, long = CheckLimits(timeout, memory), CheckLimits(timeout, memory, LONG_CHECK_SECONDS)
    checks: dict[str, Recheck] = {}

    def finished(name: str, check: Recheck) -> None:
        checks[name] = check
        display.finish(name, check.word)

    rows = [entry for _, entry in given.values() if isinstance(entry, Certificate)]
    again = rechecks(rows, False, 1, display.advance, limits)
    with display.shown(), closing(again):
        for check in again:
            finished(check.id, check)
        for name, (_, entry) in given.items():
            if isinstance(entry, Mapping):
                finished(name, conclusion_apart(entry, long))
        _refuse(given, checks)
        # Webs after the indices that they rest on.
        for name, (_, entry) in sorted(given.items(), key=lambda each: isinstance(each[1][1], WebCertificate)):
            if isinstance(entry, WebCertificate | CatalogueCertificate | IndexCertificate):
                own = {key_of(each): checks[called(each)] for each in rests_on[name]}
                finished(name, _joined(entry, rests_on[name], own, long))
    _refuse(given, checks)
    known: dict[str, CheckedRow | CheckedAtlas | CheckedIndex] = {}
    for name, (path, entry) in given.items():
        if isinstance(entry, Certificate):
            known[name] = _checked_row(path, entry, checks[name])
        elif isinstance(entry, Mapping):
            known[name] = CheckedAtlas(path, atlas_of(entry), checks[name].rendered or entry, checks[name])
    for name, (path, entry) in given.items():
        if isinstance(entry, IndexCertificate):
            document, curve = checks[name].rendered or entry.document, known[rests_on[name][0].id]
            assert isinstance(curve, CheckedAtlas)
            known[name] = CheckedIndex(path, IndexCertificate(document), document, (curve,), checks[name])
    found: list[Checked] = []
    for name, (path, entry) in given.items():
        # Words that are not this version's follow from nothing, and are not told.
        if isinstance(entry, WebCertificate):
            document = checks[name].rendered or entry.document
            resting = tuple(known[called(each)] for each in rests_on[name])
            found.append(CheckedWeb(path, WebCertificate(document), document, resting, checks[name]))
        elif isinstance(entry, CatalogueCertificate):
            document, curve = checks[name].rendered or entry.document, known[rests_on[name][0].id]
            assert isinstance(curve, CheckedAtlas)
            found.append(CheckedCatalogue(path, CatalogueCertificate(document), document, (curve,), checks[name]))
        elif name in wanted:
            found.append(known[name])
    return found


def _refuse(given: Mapping[str, tuple[Path, Entry]], checks: Mapping[str, Recheck]) -> None:
    """Raises `Refused` if one of the checks so far has failed. A place on a curve is not told."""
    refused = [(given[name][0], check) for name, check in checks.items() if not check.stands_without_place]
    if refused:
        raise Refused(refused)


def _rests_on(path: Path, entry: Entry, given: Sequence[Entry]) -> tuple[Resting, ...]:
    """The certificates among all that are given that one rests on. Raises `InputError` if one is not there."""
    branches = [each for each in given if isinstance(each, Mapping)]
    try:
        if isinstance(entry, WebCertificate):
            arcs = [_branch(each) for each in branches if each["id"] in entry.claim.certificates]
            others = (each for each in given if isinstance(each, Certificate | IndexCertificate))
            return resting(entry.claim, [*arcs, *others])
        if isinstance(entry, CatalogueCertificate | IndexCertificate):
            name, digest = (entry.document["rests_on"][key] for key in ("id", "digest"))
            found = next((_branch(each) for each in branches if each["digest"] == digest), None)
            if found is None:
                raise InputError(f"rests on the curve {shown(name)} ({digest}), which is not given; give its file")
            return (found,)
    except (InputError, ValueError, CannotBeCheckedError) as error:
        raise InputError(f"{path}: {error}") from None
    return ()


def _branch(document: Mapping[str, Any]) -> AtlasCertificate:
    return AtlasCertificate(atlas_of(document), document)


def _joined(
    entry: WebCertificate | CatalogueCertificate | IndexCertificate,
    resting: Sequence[Resting],
    checks: Mapping[Key, Recheck],
    limits: CheckLimits,
) -> Recheck:
    """The check of a certificate that rests on others, which were checked; of rows with a place without that again."""
    if not isinstance(entry, WebCertificate):
        (curve,) = resting
        assert isinstance(curve, AtlasCertificate)
        if isinstance(entry, IndexCertificate):
            return index_apart(entry, curve, checks[key_of(curve)], limits)
        arguments: tuple[Any, ...] = (entry.document, curve, checks[key_of(curve)])
        found = apart(recheck_catalogue, curve.id, arguments, limits)
    else:
        placed = [
            each for each in resting
            if isinstance(each, Certificate) and checks[key_of(each)].digest != each.to_json().get("digest")
        ]  # fmt: skip
        with closing(rechecks(placed, False, 1, lambda *_: None, limits)) as again:
            without_place: dict[Key, Recheck] = {("vertex", check.id): check for check in again}
        arguments = (entry.document, tuple(resting), {**checks, **without_place})
        found = apart(recheck_web, entry.id, arguments, limits)
    if isinstance(found, Failure):
        return not_checked(str(entry.document["id"]), entry.verdict, found)
    return found


def has_second_proof(entry: CheckedRow) -> bool:
    """Whether the second proof is about such a claim."""
    with suppress(CannotFollow, BadCertificate):
        read_claim(entry.certificate.to_json())
        return True
    return False


def _read(path: Path) -> list[tuple[Path, Entry]]:
    stated = stated_format(path, "give the path of a certificates file")
    if stated == ATLAS:
        return [(path, read_document(path, ATLAS))]
    if stated == WEB:
        return [(path, WebCertificate(read_document(path, WEB)))]
    if stated == CATALOGUE:
        return [(path, CatalogueCertificate(read_document(path, CATALOGUE)))]
    if stated == INDEX:
        return [(path, IndexCertificate(read_document(path, INDEX)))]
    return [(path, certificate) for certificate in read_certificates(path).values()]


def _name(path: Path, entry: Entry) -> str:
    if isinstance(entry, CatalogueCertificate | IndexCertificate):
        return name_of_rows(path, entry)
    return str(entry["id"]) if isinstance(entry, Mapping) else entry.id


def _work(entry: Entry) -> float:
    """How long a check takes, in those of a row."""
    match entry:
        case CatalogueCertificate():
            return 1.0 + len(entry.document["rows"]) / 200
        case Mapping():
            return 1.0 + len(entry["results"]) / 10
    return 1.0


def _checked_row(path: Path, entry: Certificate, check: Recheck) -> CheckedRow:
    entry = entry if check.rendered is None else Certificate.from_json(check.rendered)
    statement = entry.statement
    stated = statement["candidate"]
    candidate = claim_from_json(stated, "statement.candidate", systems_with(SYSTEMS, statement, stated))
    form = None if "level_form" not in statement or isinstance(candidate, InSection) else level_form(candidate)
    return CheckedRow(path, entry, candidate, form or candidate, check)
