"""The theorems of certificate files, each checked again up to its conclusion before it may be told (section 13)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from orbitproof.shared.formats import (
    ArgumentError,
    BoxClaim,
    InputError,
    claim_from_json,
    select_ids,
)
from orbitproof.shared.systems import SYSTEMS
from orbitproof.verify.bifurcation import level_form
from orbitproof.verify.certificate import (
    ROWS,
    SCHEMAS,
    CannotBeCheckedError,
    Certificate,
    Recheck,
    read_any,
    systems_with,
)
from orbitproof.verify.certificate.kinds import CATALOGUE, INDEX, LIFE, WEB, kind_named
from orbitproof.verify.run import CheckLimits, Display, Workplace
from orbitproof.verify.run.checking_again import checked_again
from orbitproof.verify.second_proof import BadCertificate, CannotFollow, read_claim

CERTIFICATE_FORMATS = (ROWS, *SCHEMAS)
"""Formats of files that a report may be about."""
VERTEX, ARC = "vertex", "arc"
"""What certificates of boxes and of branches can be for others."""


class Refused(Exception):
    """Certificates that do not stand, with what was found: nothing of them may be told."""

    def __init__(self, rechecks: Sequence[tuple[Path, Recheck]]) -> None:
        super().__init__(", ".join(result.id for _, result in rechecks))
        self.rechecks = tuple(rechecks)


@dataclass(frozen=True)
class Checked:
    """A theorem that follows from what its certificate carries, and from those that it rests on.

    Attributes:
        path: the file of the certificate.
        certificate: with words that follow from its data.
        check: what checking it has shown.
        rests_on: those that it rests on.
    """

    path: Path
    certificate: Certificate
    check: Recheck
    rests_on: tuple[Checked, ...] = ()

    @property
    def part(self) -> str:
        """What it can be for others, by its kind."""
        return self.certificate.key[0]

    @property
    def name(self) -> str:
        """What it is called: by its id, or, if that is the id of its curve, by its file too."""
        return name_of(self.path, self.certificate)

    @property
    def document(self) -> Mapping[str, Any]:
        """The certificate as JSON."""
        return self.certificate.document

    @property
    def command(self) -> str:
        """What proves it, and checks it again."""
        return {VERTEX: "verify", ARC: "verify atlas"}.get(self.part, f"verify {self.part}")

    @property
    def chapter(self) -> str:
        """Chapter of the report."""
        chapters = {VERTEX: "bifurcations", WEB: "webs", LIFE: "webs", CATALOGUE: "catalogues", INDEX: "indices"}
        return chapters.get(self.part) or ("surfaces" if self.certificate.atlas.is_surface else "curves")

    @property
    def side(self) -> str:
        """Where the new orbits are; empty if none are told of: the side of a collision is that of stable orbits."""
        told = kind_named(self.certificate.kind).tells_new_orbits
        return (self.certificate.side or "") if told else ""

    @cached_property
    def candidate(self) -> BoxClaim:
        """What is claimed of a box."""
        statement = self.certificate.statement
        stated = statement["candidate"]
        return claim_from_json(stated, "statement.candidate", systems_with(SYSTEMS, statement, stated))

    @cached_property
    def claim(self) -> BoxClaim:
        """What the hypotheses about a box are about, the candidate or its level form."""
        if "level_form" not in self.document["statement"]:
            return self.candidate
        return level_form(self.candidate) or self.candidate


def name_of(path: Path, certificate: Certificate) -> str:
    """What a certificate is called among others; one of a catalogue or of an index has the id of its curve."""
    return f"{certificate.id}-{path.stem}" if certificate.key[0] in (CATALOGUE, INDEX) else certificate.id


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
    entries = [(path, entry) for path in paths for entry in read_any(path, changed=True)]
    if not entries:
        raise InputError(f"{paths[0]}: holds no certificates; prove something first")
    names = [name_of(path, entry) for path, entry in entries]
    wanted = set(names) if only is None else set(select_ids(names, only, "certificate"))
    every = [entry for _, entry in entries]
    called = {entry.digest: name for name, entry in zip(names, every, strict=True)}
    rests_on: dict[str, tuple[Certificate, ...]] = {}
    # What a web needs, an index among that, needs others itself.
    more = wanted
    while more:
        rests_on |= {
            name: _rests_on(path, entry, every)
            for name, (path, entry) in zip(names, entries, strict=True) if name in more
        }  # fmt: skip
        more = {_called(each, called) for name in more for each in rests_on[name]} - rests_on.keys()
    for name, (path, _) in zip(names, entries, strict=True):
        if name in rests_on and names.count(name) > 1:
            raise ArgumentError(
                "{0}: {1!r} is given twice; give each certificate once, or choose with {only}; two that are called the "
                "same need names of their own (explore, {id})",
                path,
                name,
            )
    given = {name: entry for name, entry in zip(names, entries, strict=True) if name in rests_on}
    display = Display({name: _work(entry) for name, (_, entry) in given.items()}, quiet)
    found: dict[str, Checked] = {}
    known: dict[Certificate, Recheck] = {}
    workplace = Workplace(timeout=timeout, memory=memory, quiet=True)
    with display.shown():
        # Webs after the indices that they rest on.
        for parts in ((VERTEX, ARC), (INDEX,), (WEB, LIFE, CATALOGUE)):
            own = {entry: name for name, (_, entry) in given.items() if entry.key[0] in parts}
            with closing(checked_again(list(own), every, False, workplace, known, places=False)) as checks:
                for entry, check in checks:
                    name, path = own[entry], given[own[entry]][0]
                    # Words that are not this version's follow from nothing, and are not told.
                    words = entry if check.rendered is None else Certificate(check.rendered)
                    below = tuple(found[_called(each, called)] for each in rests_on[name])
                    found[name] = Checked(path, words, check, below)
                    display.finish(name, check.word)
            refused = [(each.path, each.check) for each in found.values() if not each.check.stands_without_place]
            if refused:
                raise Refused(refused)
    return [found[name] for name in given if name in wanted]


def _called(entry: Certificate, called: Mapping[str, str]) -> str:
    """The name of a certificate, which may have lost its place on a curve."""
    return called.get(entry.digest, entry.id)


def _rests_on(path: Path, entry: Certificate, given: Sequence[Certificate]) -> tuple[Certificate, ...]:
    """The certificates among all that are given that one rests on. Raises `InputError` if one is not there."""
    try:
        return kind_named(entry.kind).rests_on(entry, given)
    except (InputError, ValueError, CannotBeCheckedError) as error:
        raise InputError(f"{path}: {error}") from None


def has_second_proof(entry: Checked) -> bool:
    """Whether the second proof is about such a claim."""
    with suppress(CannotFollow, BadCertificate):
        read_claim(entry.certificate.to_json())
        return True
    return False


def _work(entry: Certificate) -> float:
    """How long a check takes, in those of a row."""
    intervals = entry.document["results"] if entry.key[0] == ARC else ()
    return 1.0 + len(entry.document.get("rows", ())) / 200 + len(intervals) / 10
