"""Catalogues of periodic orbits as files: JSON in the form of the JPL catalogue, CSV, and Parquet.

Further columns, such as distances and what is proved of a row, follow the nine of that catalogue.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, localcontext
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats.catalogue import FIELDS, HEADER, MASS_RATIO
from orbitproof.shared.formats.documents import validate_document
from orbitproof.shared.output import write_bytes, write_text

FORMS = (".json", ".csv", ".parquet")
"""By the extension of the file."""


@dataclass(frozen=True)
class CatalogueTable:
    """Rows of a catalogue, to be written.

    Attributes:
        mass_ratio: exact.
        rows: nine numbers each, in the order of `FIELDS`.
        numbers: of the rows, as `Id`.
        more: further columns by name, one entry for each row: numbers, texts or `None`.
        system, family, point, branch: as in the files.
        system_details, details: further entries about the system and the family.
        points: positions of libration points by name, where `system_details` has none.
    """

    mass_ratio: Fraction
    rows: Sequence[Sequence[float]]
    numbers: Sequence[int]
    more: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    system: str = ""
    family: str = ""
    point: str = ""
    branch: str = ""
    system_details: Mapping[str, Any] = field(default_factory=dict)
    details: Mapping[str, Any] = field(default_factory=dict)
    points: Mapping[str, Iterable[float]] = field(default_factory=dict)

    def write(self, path: Path) -> None:
        """Write in the form that the extension names, whole or not at all. Raises `InputError`."""
        kind = table_form(path)
        if kind == ".json":
            write_text(path, self.as_json())
        elif kind == ".csv":
            write_text(path, self.as_csv())
        else:
            self._write_parquet(path)

    def as_json(self) -> str:
        """The response of the catalogue's interface."""
        limits = {
            name: [float(min(row[i] for row in self.rows)), float(max(row[i] for row in self.rows))]
            for i, name in enumerate(FIELDS)
            if name in ("jacobi", "period", "stability")
        }
        document = {
            "signature": {"source": "orbitproof", "version": "1.0"},
            "system": {
                **{name: [f"{value:.15g}" for value in place] for name, place in self.points.items()},
                **self.system_details,
                "name": self.system,
                "mass_ratio": decimal_text(self.mass_ratio),
            },
            **self.details,
            "count": str(len(self.rows)),
            "family": self.family,
            "branch": self.branch,
            "libration_point": self.point,
            "limits": limits,
            "fields": [*FIELDS, *self.more],
            "data": [
                [*(f"{value: .16e}" for value in row[:6]), float(row[6]), f"{row[7]: .16e}", float(row[8]), *others]
                for row, *others in zip(self.rows, *self.more.values(), strict=True)
            ],
        }
        validate_document(document, "catalogue", "catalogue file to be written")
        return json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n"

    def as_csv(self) -> str:
        """The table of the catalogue's page."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["Id", *HEADER, *self.more, MASS_RATIO])
        mass_ratio = decimal_text(self.mass_ratio)
        for number, row, *others in zip(self.numbers, self.rows, *self.more.values(), strict=True):
            cells = ["" if value is None else value for value in others]
            writer.writerow([number, *(f"{value:.16e}" for value in row), *cells, mass_ratio])
        return stream.getvalue()

    def _write_parquet(self, path: Path) -> None:
        arrow, parquet = import_module("pyarrow"), import_module("pyarrow.parquet")
        columns: dict[str, Sequence[Any]] = {"id": self.numbers}
        columns |= {name: [float(row[i]) for row in self.rows] for i, name in enumerate(FIELDS)}
        about = {
            "mass_ratio": decimal_text(self.mass_ratio),
            "system": self.system,
            "family": self.family,
            "libration_point": self.point,
            "branch": self.branch,
            **{name: str(value) for name, value in self.system_details.items()},
        }
        table = arrow.table({**columns, **self.more}).replace_schema_metadata(about)
        stream = io.BytesIO()
        parquet.write_table(table, stream)
        write_bytes(path, stream.getvalue())


def table_form(path: Path) -> str:
    """Which of `FORMS` a path names. Raises `InputError` for others."""
    kind = path.suffix.lower()
    if kind not in FORMS:
        raise InputError(f"{path}: its extension says no form; give one of {', '.join(FORMS)}")
    return kind


def decimal_text(value: Fraction) -> str:
    """The decimal expansion of a number, all of it. Raises `ValueError` if it does not end."""
    with localcontext() as context:
        context.prec = 2000
        result = Decimal(value.numerator) / Decimal(value.denominator)
    if Fraction(result) != value:
        raise ValueError(f"{value} is no decimal fraction")
    return f"{result:e}"
