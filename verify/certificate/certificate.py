"""Certificates: statement, hypotheses, verdict and computation, as a value and as JSON (section 10)."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, Protocol

from flint import arb

from orbitproof.shared.formats import (
    BoxClaim,
    Candidate,
    claim_from_json,
    validate_document,
)
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate.document import AnyStatement, Computation
from orbitproof.verify.certificate.entry import StoredCertificate
from orbitproof.verify.certificate.kind import Key
from orbitproof.verify.certificate.kinds import (
    Found,
    Results,
    box_kind,
    kind_named,
    kind_of,
    level_form,
    name_of,
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
    """What was claimed, every hypothesis with its enclosures, and the verdict: of a theorem of any kind.

    A value: it does not change, and two are equal if their JSON is. It says what its maker wrote, its verdict and its
    words included; whether that follows from what it carries is what `recheck` decides. All balls are in nondimensional
    units. What some kinds say besides stands in `Kind.more`: `atlas`, `points` and `stable` of a curve, `orbits` of an
    index, `arcs` and `vertices` of a web, `rows` of a catalogue.

    Attributes:
        document: as JSON, which fits its schema; not to be changed.
    """

    document: Mapping[str, Any]

    @classmethod
    def from_json(cls, entry: Mapping[str, Any], source: str = "certificate") -> Certificate:
        """The certificate of a JSON object as `to_json` gives it.

        Raises `InputError` that begins with `source` if it does not fit its schema, or a ball in it is none: of rows
        the definition ``certificate`` of shared/schemas/certificates.schema.json.
        """
        if "format" in entry:
            validate_document(entry, kind_named(name_of(entry)).schema, source)
        else:
            validate_document(rows_document([entry]), "certificates", source)
        found = cls(json.loads(json.dumps(entry, allow_nan=False)))
        found.__dict__["_said"] = found._read(source)
        return found

    def _read(self, source: str) -> Mapping[str, Any]:
        return _NOTHING if "format" in self.document else _fields(self.document, source)

    @cached_property
    def _said(self) -> Mapping[str, Any]:
        return self._read(f"certificate {self.id!r}")

    def __getattr__(self, name: str) -> Any:
        if name == "document" or name.startswith("_"):
            raise AttributeError(name)
        more = kind_named(self.kind).more
        if name not in more:
            raise AttributeError(f"a certificate of the kind {self.kind!r} has no {name!r}", name=name, obj=self)
        return self.__dict__.setdefault(name, more[name](self))

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *kind_named(self.kind).more]

    def __hash__(self) -> int:
        return hash(self.digest)

    @property
    def id(self) -> str:
        """The id of the claim, or of the curve that it is about."""
        return str(self.document["id"])

    @cached_property
    def kind(self) -> str:
        """What was claimed: of a box one of `shared.formats.KINDS` or `ORBIT_KINDS`, of a branch as its atlas says."""
        return name_of(self.document)

    @property
    def k(self) -> int:
        """The multiplicity."""
        return int(self._said["k"])

    @property
    def verdict(self) -> Literal["proved", "not proved"]:
        """ "proved" or "not proved", which never means "shown to be false"."""
        return "proved" if self.document["verdict"] == "proved" else "not proved"

    @property
    def proved(self) -> bool:
        """Whether the verdict is "proved"."""
        return self.verdict == "proved"

    @property
    def theorem(self) -> str | None:
        """What its maker says is proved, in the maker's words; `None` if nothing is.

        Nothing checks them: of a certificate from elsewhere only the words of the `Recheck` may be believed, which is
        in `rendered` the certificate in words that follow from its data, if its own are others.
        """
        theorem: str | None = self.document["statement"].get("theorem")
        return theorem

    @property
    def reason(self) -> Reason | None:
        """Why it is not proved, in words of the run that made it; `None` if it is, or the document has none."""
        return from_json(Reason | None, self.document.get("reason"), "reason")  # type: ignore[arg-type]

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """The hypotheses looked at, in order, with their enclosures; their statements are the maker's words."""
        concluded = self.document if "hypotheses" in self.document else self.document.get("conclusion") or {}
        return from_json(tuple[Hypothesis, ...], concluded.get("hypotheses", []), "hypotheses")

    @property
    def results(self) -> Results:
        """All that is proved, as the chapter of its kind has it; `None` if nothing is. Of a branch what was found on
        the intervals of its pieces, in order.
        """
        return self._said["results"] if "results" in self._said else self.__getattr__("results")

    @property
    def parameter_name(self) -> str | None:
        """The bifurcation parameter, a family parameter or a first integral; for an orbit "period"."""
        name: str | None = self._said["parameter_name"]
        return name

    @property
    def parameter(self) -> arb | None:
        """The ball that contains its value; `None` if nothing is proved, as of the name."""
        parameter: arb | None = self._said["parameter"]
        return parameter

    @property
    def point(self) -> Mapping[str, arb]:
        """Balls that contain the coordinates on Fix(R) of the bifurcation point, or of the point where the orbit
        starts, by name; empty if not proved.
        """
        point: Mapping[str, arb] = self._said["point"]
        return point

    @property
    def side(self) -> Literal["above", "below", "both"] | None:
        """The parameter values at which the new orbits exist; `None` if not proved, or for an orbit."""
        side: Literal["above", "below", "both"] | None = self._said["side"]
        return side

    @property
    def normal_form(self) -> Mapping[str, arb]:
        """Enclosures of the coefficients of the bifurcation function, by name; empty if not proved."""
        coefficients: Mapping[str, arb] = self._said["normal_form"]
        return coefficients

    @property
    def computation(self) -> Computation:
        """How the verdict of a row was found."""
        computation: Computation = self._said["computation"]
        return computation

    @property
    def software(self) -> Mapping[str, str]:
        """Names and versions of what made the certificate."""
        return MappingProxyType(self.document.get("software", {}))

    @property
    def digest(self) -> str:
        """The digest that closes the document; empty if it has none."""
        return str(self.document.get("digest", ""))

    @property
    def key(self) -> Key:
        """What it can be for certificates that rest on it, and its id."""
        return kind_named(self.kind).part, self.id

    @property
    def called(self) -> str:
        """What the certificate is called within a sentence."""
        return kind_named(self.kind).called.format(shown(self.id))

    def _found_as(self, name: str) -> Results:
        return self.results if kind_named(self.kind).found_as == name else None

    @property
    def orbit(self) -> OrbitResults | None:
        """What is proved of a symmetric orbit; `None` for other claims, or if nothing is proved."""
        orbit: OrbitResults | None = self._found_as("orbit")
        return orbit

    @property
    def periodic(self) -> PeriodicResults | None:
        """What is proved of a periodic orbit without symmetry; `None` for other claims, or if nothing is proved."""
        orbit: PeriodicResults | None = self._found_as("periodic")
        return orbit

    @property
    def statement(self) -> dict[str, Any]:
        """The claim in full, as in the JSON: candidate, vector field, first integral, symmetries, section."""
        claim: dict[str, Any] = json.loads(json.dumps(self.document["statement"]))
        return claim

    @property
    def candidate(self) -> BoxClaim:
        """What was claimed of a box. Raises `InputError` if that is no well-formed claim about a system known here."""
        return claim_from_json(self.statement["candidate"], f"certificate {self.id!r}: statement.candidate")

    def to_json(self) -> dict[str, Any]:
        """The JSON object, with the tables of enclosures and the digest: what a file holds."""
        entry: dict[str, Any] = json.loads(json.dumps(self.document, allow_nan=False))
        return entry

    def with_place(self, place: Mapping[str, Any] | None) -> Certificate:
        """This certificate with another place on a proved curve, as JSON, or with none."""
        entry = {key: value for key, value in self.to_json().items() if key not in ("place", "digest")}
        entry |= {} if place is None else {"place": dict(place), "software": completed_here(entry.get("software", {}))}
        return Certificate.from_json({**entry, "digest": digest(entry)}, f"certificate {self.id!r}")

    def without_place(self) -> Certificate:
        """This certificate without its place on a curve; one that was changed after it was written stays what it is."""
        return self.with_place(None) if "place" in self.document and self.digest == digest(self.document) else self

    def __str__(self) -> str:
        claim = self.claimed
        if self.reason is not None:
            return f"{claim}, not proved, {as_said(self.reason)}"
        return ", ".join(part for part in (claim, "proved", self.side, self._shown_parameter()) if part)

    def __repr__(self) -> str:
        extent = kind_named(self.kind).extent(self)
        return f"<Certificate {self.id!r}: {self.verdict}{f', {extent}' if extent else ''}>"

    def __reduce__(self) -> tuple[type[Certificate], tuple[Mapping[str, Any]]]:
        # What was read holds balls, which do not travel.
        return Certificate, (self.document,)

    def _repr_html_(self) -> str:
        """The table that a notebook shows."""
        from html import escape

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
        return f"{box_kind(self.kind).on_side(self.kind)} {side}"

    def _shown_parameter(self) -> str:
        if self.parameter is None or self.parameter_name is None:
            return ""
        name = _SYMBOLS.get(self.parameter_name, self.parameter_name)
        return f"{name} = {certain_digits(self.parameter, _SHOWN_DIGITS)}"


def _fields(entry: Mapping[str, Any], source: str) -> dict[str, Any]:
    """What the certificate of a row says, from its JSON, which fits the schema. Raises `InputError`."""
    stored = from_json(StoredCertificate, entry, source)
    candidate = stored.statement["candidate"]
    kind = box_kind(candidate["kind"])
    results = None if stored.results is None else results_from_json(kind, stored.results, source)
    found = {
        **_NOTHING,
        "k": candidate.get("k", 1),
        "results": results,
        "computation": stored.computation,
        **({} if results is None else {"point": getattr(results, "point", {}), **kind.attributes(results)}),
    }
    return {name: MappingProxyType(value) if isinstance(value, dict) else value for name, value in found.items()}


_NOTHING: Mapping[str, Any] = {
    "k": 1, "point": MappingProxyType({}), "parameter_name": None, "parameter": None, "side": None,
    "normal_form": MappingProxyType({}),
}  # fmt: skip
"""What a certificate says of what is not proved, or has none of these."""


def make_certificate(
    candidate: BoxClaim,
    outcome: Outcome[Results],
    computation: Computation,
    enclosures: Found | None = None,
    form: Candidate | None = None,
) -> Certificate:
    """The certificate of one candidate, as of `certified`, which has to fit its schema."""
    entry = certified(candidate, outcome, computation, enclosures, form)
    return Certificate.from_json(entry, f"certificate {candidate.id!r}")


def certified(
    candidate: BoxClaim,
    outcome: Outcome[Results],
    computation: Computation,
    enclosures: Found | None = None,
    form: Candidate | None = None,
) -> dict[str, Any]:
    """The certificate of one candidate, as JSON.

    `enclosures` are what the conditions were evaluated from, if it came to that; `form` as in `Kind.statement`.
    """
    claim, reason, results = kind_of(candidate).statement(candidate, form), None, None
    if isinstance(outcome, Proved):
        claim, results = _told(claim, candidate, outcome.theorem, outcome.results), outcome.results
    else:
        reason = outcome.reason
    certificate = StoredCertificate(
        id=candidate.id,
        statement=to_json(claim),
        verdict="proved" if reason is None else "not proved",
        reason=reason,
        hypotheses=outcome.hypotheses,
        results=None if results is None else to_json(results),
        enclosures=None if enclosures is None else tables_to_json(enclosures),
        computation=computation,
        software=software(),
    )
    entry = to_json(certificate)
    return {**entry, "digest": digest(entry)}


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


class _Identified(Protocol):
    @property
    def id(self) -> str: ...


def repeated(entries: Iterable[_Identified]) -> list[str]:
    """The ids that more than one of these has, once each."""
    counts = Counter(entry.id for entry in entries)
    return [name for name, count in counts.items() if count > 1]


def rows_document(entries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    return {
        "format": "orbitproof-certificates",
        "version": 1,
        "software": software(),
        "certificates": list(entries),
    }


def schema_of(document: Mapping[str, Any]) -> str:
    """The format of a document that is one certificate, which it says."""
    return str(document["format"]).removeprefix("orbitproof-")


def sealed(document: Any, schema: str, lists: Sequence[str] = ()) -> dict[str, Any]:
    """A value as a document with its format and digest; `lists` stand in it even where they are empty."""
    made = {"format": f"orbitproof-{schema}", "version": 1, **{name: [] for name in lists}, **to_json(document)}
    return {**made, "digest": digest(made)}
