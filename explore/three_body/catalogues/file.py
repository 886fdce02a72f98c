"""Catalogues of periodic orbits in double precision; `shared.formats.catalogue` reads their files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.names import SECONDS
from orbitproof.explore.three_body.catalogues.columns import ALTITUDE, LEAST
from orbitproof.explore.three_body.catalogues.filters import between
from orbitproof.explore.three_body.names import foreign_units, units_of_system
from orbitproof.shared.formats import FIELDS, CatalogueTable, InputError, read_catalogue_rows, write_text
from orbitproof.shared.printed_tables import aligned
from orbitproof.shared.wording import counted

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
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
        more: further columns by name, shape (N,) each: numbers, texts or `None`.
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
    more: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.states)

    def __repr__(self) -> str:
        """What it is, and a short table of its first and last rows."""
        days = None if self.tunit is None else self.tunit / SECONDS["d"]
        more = [name for name in (LEAST, ALTITUDE) if name in self.more]
        rows = [["", "Jacobi constant", "period", *(["days"] if days else []), "stability index", *more]]
        numbers = self.numbers or range(1, len(self) + 1)
        for place in sorted({*range(min(3, len(self))), *range(max(0, len(self) - 3), len(self))}):
            period = float(self.periods[place])
            values = [self.jacobi_constants[place], period, *([days * period] if days else [])]
            values += [self.stability_indices[place], *(self.more[name][place] for name in more)]
            rows.append([str(numbers[place]), *(_short(value) for value in values)])
        head = f"{self.title} of {self.system or f'mu = {float(self.mass_ratio):.6g}'}: {counted(len(self), 'orbit')}"
        return "\n".join([head, *(aligned(rows) if len(self) else [])])

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

    def chosen(self, which: Array) -> Catalogue:
        """The rows with these indices, with their numbers."""
        numbers = self.numbers or range(1, len(self) + 1)
        return replace(
            self,
            states=self.states[which],
            jacobi_constants=self.jacobi_constants[which],
            periods=self.periods[which],
            stability_indices=self.stability_indices[which],
            numbers=tuple(numbers[i] for i in which),
            more={name: tuple(values[i] for i in which) for name, values in self.more.items()},
        )

    def by_period(self, low: str | float, high: str | float) -> Catalogue:
        """The rows with a period between two values: numbers, or texts such as "6.5d" where the units are known."""
        return between(self, "period", low, high)

    def by_jacobi(self, low: float, high: float) -> Catalogue:
        """The rows with a Jacobi constant between two values."""
        return between(self, "jacobi", low, high)

    def by_stability(self, low: float, high: float) -> Catalogue:
        """The rows with a stability index between two values."""
        return between(self, "stability", low, high)

    def by_perilune(self, low: str | float, high: str | float) -> Catalogue:
        """The rows with a least distance from the smaller primary between two values: numbers, or "3000km"."""
        return between(self, "perilune", low, high)

    def to_csv(self, path: str | Path) -> None:
        """Write the table of the catalogue's page. Raises `InputError`."""
        write_text(Path(path), table_of(self).as_csv())

    def write(self, path: str | Path) -> None:
        """Write as .json, .csv or .parquet. Raises `InputError`."""
        table_of(self).write(Path(path))

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame`, a row for each orbit, with the period in days too where the unit of time is known.

        Raises `ModuleNotFoundError` where pandas is missing.
        """
        try:
            pandas = import_module("pandas")
        except ModuleNotFoundError:
            raise ModuleNotFoundError("to_dataframe needs pandas: pip install pandas", name="pandas") from None
        columns: dict[str, Any] = dict(zip(FIELDS, self.columns.T, strict=True))
        if self.tunit is not None:
            columns["period_days"] = self.periods * self.tunit / SECONDS["d"]
        return pandas.DataFrame({**columns, **self.more}, index=self.numbers or range(1, len(self) + 1))

    @property
    def columns(self) -> Array:
        """Shape (N, 9), in the order of `FIELDS`."""
        rest = (self.jacobi_constants, self.periods, self.stability_indices)
        return np.column_stack([self.states, *rest])


def read_catalogue(path: Path) -> Catalogue:
    """Read a file of either form. Raises `InputError`, one line, for anything that is not well formed."""
    read = read_catalogue_rows(path)
    values = np.array([[float(number) for number in row] for row in read.rows])
    named = {name: value for name, value in vars(read).items() if name not in ("mass_ratio", "rows")}
    catalogue = Catalogue(read.mass_ratio, values[:, :6], values[:, 6], values[:, 7], values[:, 8], **named)
    length, time = catalogue.lunit, catalogue.tunit
    if length is not None and time is not None:
        why = foreign_units(length, time, units_of_system(catalogue.mass_ratio, catalogue.system))
        if why is not None:
            raise InputError(f"{path}: field system: {why}")
    return catalogue


def _short(value: Any) -> str:
    return f"{value:.7g}" if isinstance(value, (int, float)) else str(value or "")


def table_of(catalogue: Catalogue, points: Mapping[str, Iterable[float]] | None = None) -> CatalogueTable:
    """A catalogue as a table to be written; `points` as for `write_catalogue_json`."""
    columns: Any = catalogue.columns.tolist()
    return CatalogueTable(
        mass_ratio=catalogue.mass_ratio,
        rows=columns,
        numbers=catalogue.numbers or range(1, len(catalogue) + 1),
        more=catalogue.more,
        system=catalogue.system,
        family=catalogue.family,
        point=catalogue.point,
        branch=catalogue.branch,
        system_details=catalogue.system_details,
        details=catalogue.details,
        points=points or {},
    )


def write_catalogue_json(path: Path, catalogue: Catalogue, points: Mapping[str, Iterable[float]]) -> None:
    """Write the JSON form, whole or not at all.

    Arguments:
        points: positions of libration points by name, for the block that describes the system where the catalogue
            has none of its own.
    """
    write_text(path, table_of(catalogue, points).as_json())


def write_catalogue_csv(path: Path, catalogue: Catalogue) -> None:
    """Write the CSV form, whole or not at all."""
    write_text(path, table_of(catalogue).as_csv())
