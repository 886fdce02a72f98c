"""Files of the JPL three-body periodic orbit catalogue, exactly as written: its JSON responses and its CSV tables.

One family of orbits of one CR3BP system. Columns, in nondimensional units (CR3BP: distance of the primaries, angular
velocity and total mass 1; the larger primary at x = -mu): initial state x, y, z, vx, vy, vz, Jacobi constant, period,
and the stability index (|lambda| + 1/|lambda|)/2 of the multiplier with the largest magnitude. Every file has a mass
ratio of its own.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Any

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats.documents import read_document
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.wording import counted

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
class CatalogueRows:
    """A family of orbits as a catalogue has it. Nothing has been checked.

    Attributes:
        mass_ratio: mass of the smaller primary over the total mass.
        rows: exact numbers, in the order of `FIELDS`.
        system: name of the system, for example Earth-Moon, or "".
        family: for example halo, or "".
        point: number of the libration point, or "".
        branch: for example N or S, or "".
        system_details: everything else that a JSON file says about the system, as it stands there.
        details: further entries of a JSON file that name the family, such as the resonance.
        more: further columns by name, as they stand there.
    """

    mass_ratio: Fraction
    rows: tuple[tuple[Fraction, ...], ...]
    system: str = ""
    family: str = ""
    point: str = ""
    branch: str = ""
    system_details: Mapping[str, Any] = field(default_factory=dict)
    details: Mapping[str, Any] = field(default_factory=dict)
    more: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)

    kind = "catalogue"

    @property
    def title(self) -> str:
        """Point, family and branch in one word: L2-halo-S; "orbits" if the file names none of them."""
        parts = (f"L{self.point}" if self.point else "", self.family, self.branch)
        return "-".join(part for part in parts if part) or "orbits"


def read_catalogue_rows(path: Path) -> CatalogueRows:
    """Read a file of either form. Raises `InputError`, one line, for anything that is not well formed."""
    try:
        with path.open(encoding="utf-8") as stream:
            start = stream.read(4096).lstrip("\ufeff \t\r\n")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give the path of a catalogue file") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file; give a catalogue file (JSON or CSV, UTF-8)") from None
    return _read_json(path) if start.startswith("{") else _read_csv(path)


class _AsWritten(float):
    """A number of a file, as text with all of its digits."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __str__(self) -> str:
        return self._text


def _refuse_error_reply(path: Path) -> None:
    """An error reply of the catalogue's interface, saved in place of a catalogue, is told as such."""
    with suppress(OSError, ValueError, RecursionError):
        reply = json.loads(path.read_text("utf-8"))
        if isinstance(reply, dict) and "message" in reply and "data" not in reply:
            raise InputError(f"{path}: an error reply of the catalogue, no orbits; its message says what to ask for")


def _read_json(path: Path) -> CatalogueRows:
    _refuse_error_reply(path)
    document = read_document(path, "catalogue", _AsWritten)
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
        more={name: tuple(row[i] for row in data) for i, name in enumerate(fields) if name not in FIELDS},
    )


def _read_csv(path: Path) -> CatalogueRows:
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
    known = {name.lower() for name in ("Id", *wanted)}
    more = {
        lines[0][1][i].strip(): tuple(row[i] for _, row in lines[1:])
        for i, name in enumerate(names)
        if name not in known
    }
    return _catalogue(
        masses[0], rows, lambda row, column: f"{path}: line {numbers[row]}, column {HEADER[column]!r}", more=more
    )


def _mass_ratio(text: object, where: str) -> Fraction:
    try:
        value = parse_exact(_decimal_form(str(text)))
    except ValueError:
        raise InputError(f"{where}: {str(text)[:40]!r} is no number; give the smaller mass over the total") from None
    if not 0 < value < 1 or not 0.0 < float(value) < 1.0:
        raise InputError(f"{where}: {str(text).strip()[:40]} lies outside (0, 1); give the smaller mass over the total")
    if value > Fraction(1, 2):
        raise InputError(
            f"{where}: {str(text).strip()[:40]} is above 1/2, so the primaries are exchanged; give 1 - mu, and states "
            "with the other sign of x, y, vx, vy"
        )
    return value


def _decimal_form(text: str) -> str:
    """As `parse_exact` takes it: no spaces, no plus sign, digits on both sides of the point, a small e."""
    text = text.strip().lower().removeprefix("+")
    sign, text = ("-", text[1:]) if text.startswith("-") else ("", text)
    mantissa, e, exponent = text.partition("e")
    whole, dot, fraction = mantissa.partition(".")
    return f"{sign}{whole or '0'}{dot if fraction else ''}{fraction}{e}{exponent.removeprefix('+')}"


def _catalogue(
    mass_ratio: Fraction, rows: Sequence[Sequence[Any]], where: Callable[[int, int], str], **names: Any
) -> CatalogueRows:
    result = []
    for i, row in enumerate(rows):
        numbers = [_number(cell, partial(where, i, j)) for j, cell in enumerate(row)]
        for j, lowest, what in ((7, Fraction(0), "not positive"), (8, Fraction(0), "negative")):
            if numbers[j] < lowest or (j == 7 and numbers[j] == 0):
                raise InputError(f"{where(i, j)}: {str(row[j]).strip()[:40]} is {what}; write it again")
        result.append(tuple(numbers))
    return CatalogueRows(mass_ratio, tuple(result), **names)


def _number(cell: Any, where: Callable[[], str]) -> Fraction:
    try:
        is_finite = isfinite(float(cell))
    except (TypeError, ValueError, OverflowError):
        is_finite = None
    if is_finite:
        try:
            return parse_exact(_decimal_form(str(cell)))
        except ValueError:
            is_finite = None
    if is_finite is None:
        raise InputError(f"{where()}: {str(cell)[:40]!r} is no number; write it again")
    raise InputError(f"{where()}: {str(cell)[:40]} is not finite; write it again")
