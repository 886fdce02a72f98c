"""Certificates that are JSON documents closed by a digest: what those of an index, a web and a catalogue share."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.shared.formats import InputError, json_text, read_document, validate_document, write_text
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import (
    CannotBeCheckedError,
    Examination,
    Finding,
    Level,
    Recheck,
    climb,
    differences,
    digest,
    digest_findings,
)
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.evidence import Reason

if TYPE_CHECKING:
    from orbitproof.verify.atlas.certificate import AtlasCertificate

_APART = ("software", "digest")
"""What another run of the same proof may have otherwise."""

Step = Callable[[Examination], Iterator[Finding]]


class Sealed:
    """A certificate that says what its maker wrote; whether that follows is what checks decide.

    Attributes:
        document: fits the schema and its digest.
    """

    document: Mapping[str, Any]

    @property
    def id(self) -> str:
        """The id of the claim, or of the curve that it is about."""
        return str(self.document["id"])

    @property
    def verdict(self) -> str:
        """ "proved" or "not proved", which never means "shown to be false"."""
        return str(self.document["verdict"])

    @property
    def proved(self) -> bool:
        """Whether the verdict is "proved"."""
        return self.verdict == "proved"

    @property
    def theorem(self) -> str | None:
        """What its maker says is proved, in the maker's words; `None` if nothing is."""
        theorem: str | None = self.document["statement"].get("theorem")
        return theorem

    @property
    def reason(self) -> Reason | None:
        """Why it is not proved, in words of the run that made it; `None` if it is, or the document has none."""
        reason = self.document.get("reason")
        return None if reason is None else Reason(reason["condition"], reason["message"], reason["remedy"])


def sealed(document: Any, schema: str, lists: Sequence[str] = ()) -> dict[str, Any]:
    """A document as JSON with its format and digest; `lists` stand in it even where they are empty."""
    made = {"format": f"orbitproof-{schema}", "version": 1, **{name: [] for name in lists}, **to_json(document)}
    return {**made, "digest": digest(made)}


def write_sealed(path: Path, document: Mapping[str, Any], schema: str, one_a_line: Sequence[tuple[str, ...]]) -> None:
    """Write a certificate, whole or not at all. Raises `InputError` if it cannot be written."""
    validate_document(document, schema, f"{schema} to be written")
    write_text(path, json_text(document, one_a_line) + "\n")


def read_sealed(path: Path, schema: str) -> dict[str, Any]:
    """Read a certificate as JSON. Raises `InputError` if it is none, or was changed after it was written."""
    document = read_document(path, schema)
    if document["digest"] != digest(document):
        raise InputError(f"{path}: field digest: does not fit the content, which was changed; write it again")
    return document


def has_form(document: Mapping[str, Any], schema: str) -> Iterator[Finding]:
    """Its digest; raises `InputError` if it does not fit its schema."""
    yield from digest_findings(document)
    validate_document(document, schema, "the certificate")


def rests_on(document: Mapping[str, Any], curve: AtlasCertificate) -> Iterator[Finding]:
    """Whether it names the curve that is given, by its id and digest."""
    given, stored = {"id": curve.id, "digest": digest(curve.document)}, document["rests_on"]
    if stored != given:
        words = f"rests on the curve {shown(stored['id'])} ({stored['digest']}); given is {shown(curve.id)}"
        yield Finding("rests_on", f"{words} ({given['digest']})")


def climb_with_curve(
    document: Mapping[str, Any],
    curve: AtlasCertificate,
    examined: Recheck,
    form: Step,
    conclusion: Step,
    integration: Step,
) -> Recheck:
    """Check what rests on a curve again, as far as the curve was checked.

    `examined` is what checking the curve has shown. Raises `ValueError` if it is the check of another certificate.
    """
    if examined.digest != digest(curve.document):
        raise ValueError(f"examined: is the check of {examined.id!r}, and not of the curve {curve.id!r}")

    def concluded(examination: Examination) -> Iterator[Finding]:
        if not examined.stands:
            raise CannotBeCheckedError(f"the certificate {shown(curve.id)} of the curve does not stand: {examined.why}")
        yield from conclusion(examination)

    def integrated(examination: Examination) -> Iterator[Finding]:
        examination.precision = examined.precision
        yield from integration(examination)

    steps = [form]
    if examined.level >= Level.CONCLUSION or not examined.stands:
        steps.append(concluded)
    if examined.level is Level.INTEGRATION:
        steps.append(integrated)
    return climb(document, steps)


def in_all_data(document: Mapping[str, Any], fresh: Mapping[str, Any], examination: Examination) -> Iterator[Finding]:
    """Whether a certificate is what is concluded afresh, in all but the software; words apart, which are told anew."""
    old, new = ({key: value for key, value in entry.items() if key not in _APART} for entry in (document, fresh))
    yield from examination.in_data(differences(old, new, ""), {**new, **{key: document[key] for key in _APART}})
