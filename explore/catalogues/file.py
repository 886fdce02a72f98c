"""Catalogues of periodic orbits in double precision; `shared.formats.catalogue` reads their files."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbitproof.shared.formats import (
    FIELDS,
    HEADER,
    MASS_RATIO,
    read_catalogue_rows,
    validate_document,
    write_text,
)

Array = NDArray[np.float64]


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
    read = read_catalogue_rows(path)
    values = np.array([[float(number) for number in row] for row in read.rows])
    named = {name: value for name, value in vars(read).items() if name not in ("mass_ratio", "rows")}
    return Catalogue(read.mass_ratio, values[:, :6], values[:, 6], values[:, 7], values[:, 8], **named)


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
