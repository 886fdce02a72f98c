"""Files of the JPL three-body periodic orbit catalogue: its JSON responses and its CSV tables.

One family of orbits of one CR3BP system. Columns, in nondimensional units (CR3BP: distance of the primaries, angular
velocity and total mass 1; the larger primary at x = -mu): initial state x, y, z, vx, vy, vz, Jacobi constant, period,
and the stability index (|lambda| + 1/|lambda|)/2 of the multiplier with the largest magnitude. Every file has a mass
ratio of its own; it is taken exactly as written.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, localcontext
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbitproof.shared.formats import InputError, read_document, validate_document, write_text
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.wording import counted

Array = NDArray[np.float64]

FIELDS = ("x", "y", "z", "vx", "vy", "vz", "jacobi", "period", "stability")
"""Names of the columns in the JSON form."""

HEADER = (
    "x0 (LU)",
    "y0 (LU)",
    "z0 (LU)",
    "vx0 (LU/TU)",
    "vy0 (LU/TU)",
    "vz0 (LU/TU)",
    "Jacobi constant (LU2/TU2)",
    "Period (TU)",
    "Stability index",
)
"""Names of the same columns in the CSV form, where ``Id`` stands before and ``Mass ratio`` behind them."""

MASS_RATIO = "Mass ratio"

_KEYS = frozenset(
    ("signature", "system", "count", "family", "branch", "libration_point", "limits", "filter", "fields", "data")
)
"""Entries of the JSON form that are read, or that follow from the others."""


@dataclass(frozen=True)
class Catalogue:
    """A family of N periodic orbits in the catalogue's form; nothing has been checked by integration.

    Attributes:
        mass_ratio: mass of the smaller primary over the total mass, exactly as written.
        states: shape (N, 6), x, y, z, vx, vy, vz of one point of each orbit.
        jacobi_constants, periods, stability_indices: shape (N,).
        system: name of the system, for example Earth-Moon, or "".
        family: for example halo, or "".
        point: number of the libration point, or "".
        branch: for example N or S, or "".
        system_details: everything else that a JSON file says about the system, as it stands there: units of length
            (lunit, km) and time (tunit, s), radius_secondary (km), positions of the libration points.
        details: further entries of a JSON file that name the family, such as the resonance.
        numbers: of the orbits in the file that they come from, counted from 1; `None`: all of them, in order.
    """

    mass_ratio: Fraction
    states: Array
    jacobi_constants: Array
    periods: Array
    stability_indices: Array
    system: str = ""
    family: str = ""
    point: str = ""
    branch: str = ""
    system_details: Mapping[str, Any] = field(default_factory=dict)
    details: Mapping[str, Any] = field(default_factory=dict)
    numbers: tuple[int, ...] | None = None

    def __len__(self) -> int:
        return len(self.states)

    @property
    def title(self) -> str:
        """Point, family and branch in one word: L2-halo-S; "orbits" if the file names none of them."""
        parts = (f"L{self.point}" if self.point else "", self.family, self.branch)
        return "-".join(part for part in parts if part) or "orbits"

    @property
    def lunit(self) -> float | None:
        """The unit of length, km, if the file names it."""
        return self._unit("lunit")

    @property
    def tunit(self) -> float | None:
        """The unit of time, s, if the file names it."""
        return self._unit("tunit")

    def _unit(self, name: str) -> float | None:
        value = self.system_details.get(name)
        return None if value is None else float(value)

    @property
    def columns(self) -> Array:
        """Shape (N, 9), in the order of `FIELDS`."""
        rest = (self.jacobi_constants, self.periods, self.stability_indices)
        return np.column_stack([self.states, *rest])


def decimal_text(value: Fraction) -> str:
    """The decimal expansion of a number, all of it. Raises `ValueError` if it does not end."""
    with localcontext() as context:
        context.prec = 2000
        result = Decimal(value.numerator) / Decimal(value.denominator)
    if Fraction(result) != value:
        raise ValueError(f"{value} is no decimal fraction")
    return f"{result:e}"


def read_catalogue(path: Path) -> Catalogue:
    """Read a file of either form. Raises `InputError`, one line, for anything that is not well formed."""
    try:
        with path.open(encoding="utf-8") as stream:
            start = stream.read(4096).lstrip("\ufeff \t\r\n")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give the path of a catalogue file") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file; give a catalogue file (JSON or CSV, UTF-8)") from None
    return _read_json(path) if start.startswith("{") else _read_csv(path)


def _read_json(path: Path) -> Catalogue:
    document = read_document(path, "catalogue")
    fields, data = [str(name).strip() for name in document["fields"]], document["data"]
    missing = [name for name in FIELDS if name not in fields]
    if missing:
        raise InputError(f"{path}: field fields: no column {missing[0]!r}; give {', '.join(FIELDS)}")
    if "count" in document and int(document["count"]) != len(data):
        raise InputError(
            f"{path}: field count: {document['count']}, but data has {counted(len(data), 'row')}; "
            "the file may be truncated"
        )
    order = [fields.index(name) for name in FIELDS]
    rows = []
    for index, row in enumerate(data):
        if len(row) != len(fields):
            raise InputError(
                f"{path}: field data[{index}]: {counted(len(row), 'number')} for {counted(len(fields), 'field')}; "
                "write it again"
            )
        rows.append([row[i] for i in order])
    return _catalogue(
        _mass_ratio(document["system"]["mass_ratio"], f"{path}: field system.mass_ratio"),
        rows,
        lambda row, column: f"{path}: field data[{row}][{order[column]}]",
        system=document["system"].get("name", ""),
        family=document.get("family", ""),
        point=str(document.get("libration_point", "")),
        branch=document.get("branch", ""),
        system_details={
            name: value for name, value in document["system"].items() if name not in ("name", "mass_ratio")
        },
        details={name: value for name, value in document.items() if name not in _KEYS},
    )


def _read_csv(path: Path) -> Catalogue:
    try:
        table = list(csv.reader(io.StringIO(path.read_text("utf-8-sig")), skipinitialspace=True, strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: no readable table ({error}); give a catalogue file (JSON or CSV)") from None
    lines = [(number, row) for number, row in enumerate(table, start=1) if any(cell.strip() for cell in row)]
    if not lines:
        raise InputError(f"{path}: empty; give a catalogue file (JSON or CSV)")
    names = [cell.strip().lower() for cell in lines[0][1]]
    wanted = (*HEADER, MASS_RATIO)
    missing = [name for name in wanted if name.lower() not in names]
    if missing:
        raise InputError(f"{path}: no column {missing[0]!r}; give {', '.join(wanted)} in the first line")
    *order, mass_column = (names.index(name.lower()) for name in wanted)
    rows, numbers, masses = [], [], []
    for number, row in lines[1:]:
        if len(row) != len(names):
            raise InputError(
                f"{path}: line {number}: {counted(len(row), 'cell')} for {counted(len(names), 'column')}; "
                "write it again"
            )
        rows.append([row[i] for i in order])
        numbers.append(number)
        masses.append(_mass_ratio(row[mass_column], f"{path}: line {number}, column {MASS_RATIO!r}"))
        if masses[-1] != masses[0]:
            raise InputError(
                f"{path}: line {number}, column {MASS_RATIO!r}: differs from line {numbers[0]}; one system a file"
            )
    if not rows:
        raise InputError(f"{path}: no orbits below the first line; give at least one")
    return _catalogue(masses[0], rows, lambda row, column: f"{path}: line {numbers[row]}, column {HEADER[column]!r}")


def _mass_ratio(text: object, where: str) -> Fraction:
    try:
        value = parse_exact(_decimal_form(str(text)))
    except ValueError:
        raise InputError(f"{where}: {str(text)[:40]!r} is no number; give the smaller mass over the total") from None
    if not 0 < value < 1 or not 0.0 < float(value) < 1.0:
        raise InputError(f"{where}: {str(text).strip()[:40]} lies outside (0, 1); give the smaller mass over the total")
    return value


def _decimal_form(text: str) -> str:
    """As `parse_exact` takes it: no spaces, no plus sign, digits on both sides of the point, a small e."""
    text = text.strip().lower().removeprefix("+")
    mantissa, e, exponent = text.partition("e")
    whole, dot, fraction = mantissa.partition(".")
    return f"{whole or '0'}{dot if fraction else ''}{fraction}{e}{exponent.removeprefix('+')}"


def _catalogue(mass_ratio: Fraction, rows: Sequence[Sequence[Any]], where: Any, **names: Any) -> Catalogue:
    values = np.empty((len(rows), len(FIELDS)))
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            try:
                values[i, j] = float(cell)
            except (ValueError, OverflowError):
                raise InputError(f"{where(i, j)}: {str(cell)[:40]!r} is no number; write it again") from None
            if not isfinite(values[i, j]):
                raise InputError(f"{where(i, j)}: {str(cell)[:40]} is not finite; write it again")
        for j, lowest, what in ((7, 0.0, "not positive"), (8, 0.0, "negative")):
            if values[i, j] < lowest or (j == 7 and values[i, j] == 0):
                raise InputError(f"{where(i, j)}: {str(row[j]).strip()[:40]} is {what}; write it again")
    return Catalogue(mass_ratio, values[:, :6], values[:, 6], values[:, 7], values[:, 8], **names)


def write_catalogue_json(path: Path, catalogue: Catalogue, points: Mapping[str, Iterable[float]]) -> None:
    """Write the JSON form, whole or not at all.

    Arguments:
        points: positions of libration points by name, for the block that describes the system where the catalogue
            has none of its own.
    """
    columns = catalogue.columns
    document = {
        "signature": {"source": "orbitproof", "version": "1.0"},
        "system": {
            **{name: [f"{value:.15g}" for value in place] for name, place in points.items()},
            **catalogue.system_details,
            "name": catalogue.system,
            "mass_ratio": decimal_text(catalogue.mass_ratio),
        },
        **catalogue.details,
        "count": str(len(catalogue)),
        "family": catalogue.family,
        "branch": catalogue.branch,
        "libration_point": catalogue.point,
        "limits": {
            name: [float(columns[:, i].min()), float(columns[:, i].max())]
            for i, name in enumerate(FIELDS)
            if name in ("jacobi", "period", "stability")
        },
        "fields": list(FIELDS),
        "data": [
            [*(f"{value: .16e}" for value in row[:6]), float(row[6]), f"{row[7]: .16e}", float(row[8])]
            for row in columns
        ],
    }
    validate_document(document, "catalogue", "catalogue file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def write_catalogue_csv(path: Path, catalogue: Catalogue) -> None:
    """Write the CSV form, whole or not at all."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["Id", *HEADER, MASS_RATIO])
    mass_ratio = decimal_text(catalogue.mass_ratio)
    numbers = catalogue.numbers or range(1, len(catalogue) + 1)
    for number, row in zip(numbers, catalogue.columns, strict=True):
        writer.writerow([number, *(f"{value:.16e}" for value in row), mass_ratio])
    write_text(path, stream.getvalue())
