"""Certificates: statement, hypotheses, verdict and computation, as a value and as JSON (section 10)."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from html import escape
from pathlib import Path
from textwrap import indent
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, Protocol

from flint import arb

from orbitproof.shared.claims import ORBIT_KINDS, PERIODIC
from orbitproof.shared.formats import (
    ArgumentError,
    BoxClaim,
    Candidate,
    claim_from_json,
    read_document,
    validate_document,
    write_text,
)
from orbitproof.verify.certificate.document import AnyStatement, Computation
from orbitproof.verify.certificate.entry import Entry
from orbitproof.verify.certificate.kinds import (
    Found,
    Results,
    kind_named,
    kind_of,
    level_form,
    results_from_json,
    tables_to_json,
    theorem_of,
)
from orbitproof.verify.certificate.stored_balls import from_json, to_json
from orbitproof.verify.evidence import (
    Hypothesis,
    Outcome,
    Proved,
    Reason,
    Theorem,
    as_said,
    certain_digits,
    completed_here,
    differs_here,
    software,
)

if TYPE_CHECKING:
    from orbitproof.verify.orbit import OrbitResults
    from orbitproof.verify.periodic import PeriodicResults

_SHOWN_DIGITS = 34
_SYMBOLS = {"Jacobi constant": "C"}


@dataclass(frozen=True, repr=False)
class Certificate:
    """What was claimed about one candidate, every hypothesis with its enclosures, and the verdict.

    A value: it does not change, and two are equal if their JSON is. It says what its maker wrote, its verdict and its
    words included; whether that follows from the enclosures that it carries is what `recheck` decides. All balls are in
    nondimensional units.

    Attributes:
        id: the candidate's.
        kind, k: what was claimed: one of `shared.formats.KINDS` or `ORBIT_KINDS`, and the multiplicity.
        verdict: "proved" or "not proved", which never means "shown to be false".
        theorem: what its maker says is proved, in the maker's words; `None` if nothing is. Nothing checks them: of a
            certificate from elsewhere only the words of the `Recheck` may be believed, which is in `rendered` the
            certificate in words that follow from its data, if its own are others.
        parameter_name: the bifurcation parameter, a family parameter or a first integral; for an orbit "period"; `None`
            if nothing is proved.
        parameter: the ball that contains its value; `None` if nothing is proved.
        point: balls that contain the coordinates on Fix(R) of the bifurcation point, or of the point where the orbit
            starts, by name; empty if not proved.
        side: "above", "below" or "both": parameter values at which the new orbits exist; `None` if not proved, or for
            an orbit.
        normal_form: enclosures of the coefficients of the bifurcation function, by name; empty if not proved.
        results: all that is proved, as the chapter of its kind has it; `None` if nothing is.
        hypotheses: those that were looked at, in order, with their enclosures; their statements are the maker's words.
        reason: why it is not proved, in words of the run that made it; `None` if it is.
        computation: how the verdict was found.
        software: names and versions of what made the certificate.
    """

    id: str = field(compare=False)
    kind: str = field(compare=False)
    k: int = field(compare=False)
    verdict: Literal["proved", "not proved"] = field(compare=False)
    theorem: str | None = field(compare=False)
    parameter_name: str | None = field(compare=False)
    parameter: arb | None = field(compare=False)
    point: Mapping[str, arb] = field(compare=False)
    side: Literal["above", "below", "both"] | None = field(compare=False)
    normal_form: Mapping[str, arb] = field(compare=False)
    hypotheses: tuple[Hypothesis, ...] = field(compare=False)
    reason: Reason | None = field(compare=False)
    computation: Computation = field(compare=False)
    software: Mapping[str, str] = field(compare=False)
    results: Results | None = field(compare=False)
    _text: str

    @classmethod
    def from_json(cls, entry: Mapping[str, Any], source: str = "certificate") -> Certificate:
        """The certificate of a JSON object as `to_json` gives it.

        Raises `InputError` that begins with `source` if it does not fit the definition ``certificate`` of
        shared/schemas/certificates.schema.json, or a ball in it is none.
        """
        validate_document(_document([entry]), "certificates", source)
        text = json.dumps(entry, allow_nan=False)
        return cls(**_fields(json.loads(text), source), _text=text)

    @property
    def proved(self) -> bool:
        """Whether the verdict is "proved"."""
        return self.verdict == "proved"

    @property
    def orbit(self) -> OrbitResults | None:
        """What is proved of a symmetric orbit; `None` for other claims, or if nothing is proved."""
        orbit: OrbitResults | None = self.results if self.kind in ORBIT_KINDS else None
        return orbit

    @property
    def periodic(self) -> PeriodicResults | None:
        """What is proved of a periodic orbit without symmetry; `None` for other claims, or if nothing is proved."""
        orbit: PeriodicResults | None = self.results if self.kind == PERIODIC else None
        return orbit

    @property
    def statement(self) -> dict[str, Any]:
        """The claim in full, as in the JSON: candidate, vector field, first integral, symmetries, section."""
        claim: dict[str, Any] = json.loads(self._statement)
        return claim

    @cached_property
    def _statement(self) -> str:
        return json.dumps(self.to_json()["statement"])

    @property
    def candidate(self) -> BoxClaim:
        """What was claimed. Raises `InputError` if that is no well-formed claim about a system known here."""
        return claim_from_json(self.statement["candidate"], f"certificate {self.id!r}: statement.candidate")

    def to_json(self) -> dict[str, Any]:
        """The JSON object, with the tables of enclosures and the digest: what a certificates file holds."""
        entry: dict[str, Any] = json.loads(self._text)
        return entry

    def with_place(self, place: Mapping[str, Any] | None) -> Certificate:
        """This certificate with another place on a proved curve, as JSON, or with none."""
        entry = {key: value for key, value in self.to_json().items() if key not in ("place", "digest")}
        entry |= {} if place is None else {"place": dict(place), "software": completed_here(entry.get("software", {}))}
        return Certificate.from_json({**entry, "digest": digest(entry)}, f"certificate {self.id!r}")

    def without_place(self) -> Certificate:
        """This certificate without its place on a curve; one that was changed after it was written stays what it is."""
        entry = self.to_json()
        return self.with_place(None) if "place" in entry and entry.get("digest") == digest(entry) else self

    def __str__(self) -> str:
        claim = self.claimed
        if self.reason is not None:
            return f"{claim}, not proved, {as_said(self.reason)}"
        return ", ".join(part for part in (claim, "proved", self.side, self._shown_parameter()) if part)

    def __repr__(self) -> str:
        return f"<Certificate {self.id!r}: {self.verdict}>"

    def __reduce__(self) -> tuple[Callable[..., Certificate], tuple[dict[str, Any]]]:
        return Certificate.from_json, (self.to_json(),)

    def _repr_html_(self) -> str:
        """The table that a notebook shows."""
        rows = [("claim", self.claimed), ("verdict", self.verdict)]
        if self.reason is not None:
            rows += [("reason", as_said(self.reason))]
        if self.parameter is not None:
            rows += [] if self.side is None else [("new orbits", self.side)]
            rows += [("parameter", self._shown_parameter())]
            rows += [(name, certain_digits(ball, _SHOWN_DIGITS)) for name, ball in self.point.items()]
        rows += [("hypotheses", ", ".join(hypothesis.name for hypothesis in self.hypotheses))]
        cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in rows)
        return f"<table><caption>{escape(self.id)}</caption>{cells}</table>"

    @property
    def claimed(self) -> str:
        """The claim in a word or two."""
        return kind_named(self.kind).said(self.k, self.kind)

    @property
    def on_side(self) -> str:
        """What there is on which side of the parameter, in words; empty where no side is proved."""
        if self.side is None:
            return ""
        side = "on both sides" if self.side == "both" else self.side
        return f"{kind_named(self.kind).on_side(self.kind)} {side}"

    def _shown_parameter(self) -> str:
        if self.parameter is None or self.parameter_name is None:
            return ""
        name = _SYMBOLS.get(self.parameter_name, self.parameter_name)
        return f"{name} = {certain_digits(self.parameter, _SHOWN_DIGITS)}"


def _fields(entry: Mapping[str, Any], source: str) -> dict[str, Any]:
    """The attributes of a certificate from its JSON, which fits the schema. Raises `InputError`."""
    stored = from_json(Entry, entry, source)
    candidate, kind = stored.statement.claim, kind_named(stored.statement.claim["kind"])
    results = None if stored.results is None else results_from_json(kind, stored.results, source)
    same = ("id", "verdict", "hypotheses", "reason", "computation", "software")
    found = {
        "kind": candidate["kind"],
        "k": candidate.get("k", 1),
        "theorem": stored.statement.theorem,
        "results": results,
        **{name: getattr(stored, name) for name in same},
        **_NOTHING,
        **({} if results is None else {"point": results.point, **kind.attributes(results)}),
    }
    return {name: MappingProxyType(value) if isinstance(value, dict) else value for name, value in found.items()}


_NOTHING: Mapping[str, Any] = {"point": {}, "parameter_name": None, "parameter": None, "side": None, "normal_form": {}}
"""What a certificate says of what is not proved."""


def make_certificate(
    candidate: BoxClaim,
    outcome: Outcome[Results],
    computation: Computation,
    enclosures: Found | None = None,
    form: Candidate | None = None,
) -> Certificate:
    """The certificate of one candidate.

    `enclosures` are what the conditions were evaluated from, if it came to that; `form` as in `Kind.statement`.
    """
    claim, reason, results = kind_of(candidate).statement(candidate, form), None, None
    if isinstance(outcome, Proved):
        claim, results = _told(claim, candidate, outcome.theorem, outcome.results), outcome.results
    else:
        reason = outcome.reason
    certificate = Entry(
        id=candidate.id,
        statement=claim,
        verdict="proved" if reason is None else "not proved",
        reason=reason,
        hypotheses=outcome.hypotheses,
        results=None if results is None else to_json(results),
        enclosures=None if enclosures is None else tables_to_json(enclosures),
        computation=computation,
        software=software(),
    )
    entry = to_json(certificate)
    return Certificate.from_json({**entry, "digest": digest(entry)}, f"certificate {candidate.id!r}")


def _told(claim: AnyStatement, candidate: BoxClaim, theorem: Theorem, results: Results) -> AnyStatement:
    """The claim in full with its theorem."""
    kind = kind_of(candidate)
    return replace(claim, theorem=kind.in_words(theorem), in_full=kind.in_full(candidate, theorem, results))


def digest(entry: Mapping[str, Any]) -> str:
    """SHA-256 of the canonical JSON (sorted keys, no spaces, ASCII) of a certificate without its digest."""
    content = {key: value for key, value in entry.items() if key != "digest"}
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return f"sha256:{hashlib.sha256(text.encode()).hexdigest()}"


def is_proof_of(certificate: Certificate, candidate: BoxClaim) -> bool:
    """Whether a stored certificate proves exactly this candidate, by exactly this software."""
    entry = certificate.to_json()
    form = level_form(candidate) if "level_form" in entry["statement"] else None
    theorem = theorem_of(candidate, form)
    if isinstance(theorem, Reason) or not isinstance(certificate.results, kind_of(candidate).results):
        return False
    told = _told(kind_of(candidate).statement(candidate, form), candidate, theorem, certificate.results)
    return (
        entry.get("digest") == digest(entry)
        and entry["statement"] == to_json(told)
        and not differs_here(entry.get("software", {}))
        and tuple(hypothesis.name for hypothesis in certificate.hypotheses) == theorem.hypotheses
        and all(hypothesis.holds is True for hypothesis in certificate.hypotheses)
    )


def read_certificates(path: Path) -> dict[str, Certificate]:
    """The certificates of a file by candidate id. Raises `InputError` for anything else."""
    document = read_document(path, "certificates")
    entries = [
        Certificate.from_json(entry, f"{path}: field certificates[{index}]")
        for index, entry in enumerate(document["certificates"])
    ]
    words = "{0}: field certificates: id {1!r} appears twice; write the file again with {fresh=True:--fresh}"
    for name in repeated(entries):
        raise ArgumentError(words, path, name)
    return {entry.id: entry for entry in entries}


class _Identified(Protocol):
    @property
    def id(self) -> str: ...


def repeated(entries: Iterable[_Identified]) -> list[str]:
    """The ids that more than one of these has, once each."""
    counts = Counter(entry.id for entry in entries)
    return [name for name, count in counts.items() if count > 1]


def write_certificates(path: Path, certificates: Iterable[Certificate]) -> None:
    """Write a certificates file, whole or not at all. Raises `InputError` if it cannot be written."""
    head = json.dumps(_document([]), indent=1).removesuffix("[]\n}")
    entries = ",\n".join(_indented(certificate) for certificate in certificates)
    write_text(path, f"{head}[\n{entries}\n ]\n}}\n" if entries else f"{head}[]\n}}\n")


def _document(entries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    return {
        "format": "orbitproof-certificates",
        "version": 1,
        "software": software(),
        "certificates": list(entries),
    }


@lru_cache(maxsize=4096)
def _indented(certificate: Certificate) -> str:
    """As it stands in a file; kept, because a run writes its file again for every row."""
    return indent(json.dumps(certificate.to_json(), indent=1, allow_nan=False), "  ")
