"""Files of certificates: any number of rows, or one theorem of another kind that its digest closes (section 10.2)."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from textwrap import indent
from typing import Any, Protocol

from orbitproof.shared.formats import (
    ArgumentError,
    InputError,
    json_text,
    read_document,
    stated_format,
    validate_document,
    write_text,
)
from orbitproof.verify.certificate.certificate import Certificate, digest, repeated, rows_document, schema_of
from orbitproof.verify.certificate.kinds import kind_named, name_of

ROWS = "certificates"
"""The format of files of rows."""
SCHEMAS = ("atlas-certificate", "web-certificate", "life-certificate", "index-certificate", "catalogue-certificate")
"""The formats of files that hold one certificate."""


def read_certificates(path: Path) -> dict[str, Certificate]:
    """The rows of a file by their ids. Raises `InputError` for anything else."""
    document = read_document(path, ROWS)
    entries = [
        Certificate.from_json(entry, f"{path}: field certificates[{index}]")
        for index, entry in enumerate(document[ROWS])
    ]
    words = "{0}: field certificates: id {1!r} appears twice; write the file again with {fresh=True:--fresh}"
    for name in repeated(entries):
        raise ArgumentError(words, path, name)
    return {entry.id: entry for entry in entries}


def read_any(path: Path, changed: bool = False) -> list[Certificate]:
    """The certificates of a file, in its order: those of rows, or the one of another kind.

    Raises `InputError`, one line with file, field and remedy, for anything else, and as `read_certificate`.
    """
    schema = stated_format(path, "give the path of a certificates file")
    return [read_certificate(path, schema, changed)] if schema in SCHEMAS else list(read_certificates(path).values())


def read_certificate(path: Path, schema: str, changed: bool = False) -> Certificate:
    """The certificate of a file that holds one, in this format.

    Raises `InputError` if it is none, or was changed after it was written; with `changed` that is left to a check.
    """
    document = read_document(path, schema)
    if changed:
        return Certificate(document)
    if document["digest"] != digest(document):
        raise InputError(f"{path}: field digest: does not fit the content, which was changed; write it again")
    kind_named(name_of(document)).well_formed(document, path)
    return Certificate(document)


def write_certificates(path: Path, certificates: Iterable[Certificate]) -> None:
    """Write a file of rows, whole or not at all. Raises `InputError` if it cannot be written."""
    head = json.dumps(rows_document([]), indent=1).removesuffix("[]\n}")
    entries = ",\n".join(_indented(certificate) for certificate in certificates)
    write_text(path, f"{head}[\n{entries}\n ]\n}}\n" if entries else f"{head}[]\n}}\n")


@lru_cache(maxsize=4096)
def _indented(certificate: Certificate) -> str:
    """As it stands in a file; kept, because a run writes its file again for every row."""
    return indent(json.dumps(certificate.document, indent=1, allow_nan=False), "  ")


class Lines(Protocol):
    """How results stand in a file that is written again and again."""

    def __call__(self, entry: Any) -> str:
        """An entry on one line."""

    def unknown(self, results: Sequence[Any]) -> list[Any]:
        """The results that were not written yet."""


def write_certificate(path: Path, document: Mapping[str, Any], lines: Lines | None = None) -> None:
    """Write a file that holds one certificate, whole or not at all. Raises `InputError` if it cannot be written.

    `lines` are those of a run that writes its file for every interval.
    """
    schema = schema_of(document)
    fresh = document if lines is None else {**document, "results": lines.unknown(document["results"])}
    validate_document(fresh, schema, f"{schema} to be written")
    more = () if lines is None else (lines,)
    write_text(path, json_text(document, kind_named(name_of(document)).one_a_line, *more) + "\n")
