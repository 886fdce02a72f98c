"""Families of symmetric periodic orbits as values: sequences of orbits that can be asked, written and drawn."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from html import escape
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.families import TracedFamily
from orbitproof.explore.names import time_given, told_apart
from orbitproof.explore.orbits import SymmetricOrbit
from orbitproof.explore.search import orbits_with
from orbitproof.explore.three_body.catalogues import catalogue_of, write_catalogue_csv
from orbitproof.explore.three_body.names import Branch, on_branch
from orbitproof.explore.three_body.plots import draw_family, draw_orbits
from orbitproof.explore.three_body.trajectories import Units, units_named
from orbitproof.explore.values.orbits import File, Orbit, orbit_value
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, LEVEL, Equation, InputError, write_text
from orbitproof.shared.systems import THREE_BODY, ReversibleSystem
from orbitproof.shared.wording import counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class OrbitFamily(Sequence[Orbit]):
    """A family of symmetric periodic orbits: a sequence of `Orbit`, in order along the family.

    Attributes:
        name: as asked for, for example "L1-halo".
        system: what they are orbits of.
        outcome: "limit", "closed" or "failed".
        reason: the same in words, with the place.
        units: of length and time, if they are known.
    """

    name: str
    system: ReversibleSystem
    outcome: str
    reason: str
    _traced: TracedFamily
    units: Units | None = None

    @property
    def branch(self) -> Branch | None:
        """Where the orbits have z > 0 or z < 0 when they are farthest from the smaller primary; `None` for others."""
        return self._traced.branch

    def __len__(self) -> int:
        return len(self._traced.family.orbits)

    @overload
    def __getitem__(self, index: int) -> Orbit: ...
    @overload
    def __getitem__(self, index: slice) -> list[Orbit]: ...
    def __getitem__(self, index: int | slice) -> Orbit | list[Orbit]:
        family = self._traced.family
        if isinstance(index, slice):
            return [self._value(orbit) for orbit in family.orbits[index]]
        return self._value(family.orbits[index])

    def __iter__(self) -> Iterator[Orbit]:
        return (self[index] for index in range(len(self)))

    def with_units(self, units: Units | str) -> OrbitFamily:
        """This family with units of length and time: `explore.Units(km, s, source)`, or the name of a system."""
        return replace(self, units=units_named(units, self[0].parameters.get("mu")))

    def by_period(self, period: float | Fraction | str) -> list[Orbit]:
        """The orbits of that period between those of the family, corrected; an empty list if there is none.

        With units a text such as "6.5d" or "12h" too.
        """
        if isinstance(period, str):
            try:
                period = time_given("period", period, None if self.units is None else self.units.time)
            except InputError as error:
                raise ValueError(str(error)) from None
        return self._with(Equation(HALF_PERIOD, Fraction(period) / 2))

    def by_level(self, level: float) -> list[Orbit]:
        """The orbits with that value of the first integral, in the CR3BP the Jacobi constant."""
        if self.system.first_integral is None:
            raise ValueError(f"level: {self.system.name} has no first integral; give by_coordinate")
        return self._with(Equation(LEVEL, Fraction(level)))

    def by_coordinate(self, name: str, value: float) -> list[Orbit]:
        """The orbits whose first point has that value of a coordinate, one of `system.centre_coordinates`."""
        if name not in self.system.centre_coordinates:
            raise ValueError(f"name: {name!r} is unknown; there are {', '.join(self.system.centre_coordinates)}")
        return self._with(Equation(COORDINATE, Fraction(value), name))

    def _with(self, equation: Equation) -> list[Orbit]:
        return [self._value(orbit) for orbit in orbits_with(self._traced.family, equation)]

    def to_csv(self, path: File) -> None:
        """Write the orbits as CSV: of the CR3BP with the columns of the JPL catalogue, else those of `to_dataframe`."""
        if self.system in THREE_BODY:
            traced = self._traced
            write_catalogue_csv(Path(path), catalogue_of(traced.family, traced.name, traced.label))
            return
        stream = io.StringIO()
        rows = [self._row(orbit) for orbit in self]
        writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        write_text(Path(path), stream.getvalue())

    def plot(self, orbits: int = 8) -> Figure:
        """Some orbits of the family in two projections, a matplotlib figure (extra `figures`)."""
        which = np.unique(np.linspace(0, len(self) - 1, orbits).round().astype(int))
        mass = float(self._traced.family.problem.parameters["mu"]) if self.system in THREE_BODY else None
        states = [self[int(index)].trajectory(400)[1] for index in which]
        title = f"{on_branch(self.name, self.branch)} of {self.system.name}"
        length = None if self.units is None else self.units.length
        return draw_orbits(title, states, self.system.state, mass, length)

    def plot_stability(self) -> Figure:
        """Period and stability index over the Jacobi constant, or what else varies along the family."""
        levels, name = self._levels()
        indices = np.array([orbit.stability_index for orbit in self])
        return draw_family(
            on_branch(self.name, self.branch), levels, name, np.array([orbit.period for orbit in self]), indices
        )

    def _levels(self) -> tuple[NDArray[np.float64], str]:
        name = self.system.family_parameter
        if name is not None:
            return np.array([orbit.parameters[name] for orbit in self]), name
        return np.array([orbit.first_integral for orbit in self]), self.system.first_integral_name or "level"

    def _value(self, orbit: SymmetricOrbit) -> Orbit:
        return orbit_value(self._traced.family.problem, orbit, self.units)

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame`, one row for each orbit.

        Columns: the state at time 0 by its names, `period`, `period (days)` where the units are known, the first
        integral (or the family parameter), `stability index`, the stability parameters `s1`, `s2`, ..,
        and `arclength`; with parentheses, as `(period)`, if a coordinate is called so.
        Raises `ModuleNotFoundError` where pandas is missing.
        """
        try:
            pandas = import_module("pandas")
        except ModuleNotFoundError:
            raise ModuleNotFoundError("to_dataframe needs pandas: pip install pandas", name="pandas") from None
        return pandas.DataFrame([self._row(orbit) for orbit in self])

    def _row(self, orbit: Orbit) -> dict[str, float | complex]:
        system, varies = self.system, self.system.family_parameter
        row: dict[str, Any] = dict(zip(system.state, orbit.point.tolist(), strict=True))

        def add(head: str, value: float | complex) -> None:
            row[told_apart([head], (*row, *system.parameters))[0]] = value

        add("period", orbit.period)
        if orbit.units is not None:
            add("period (days)", orbit.period_days)
        if varies is not None:
            row[varies] = orbit.parameters[varies]
        elif orbit.first_integral is not None:
            add(system.first_integral_name or "first integral", orbit.first_integral)
        add("stability index", orbit.stability_index)
        for number, value in enumerate(orbit.stability, start=1):
            add(f"s{number}", value.real if value.imag == 0 else value)
        add("arclength", orbit.arclength)
        return row

    def __repr__(self) -> str:
        side = "" if self.branch is None else f"{self.branch}ern "
        many = counted(len(self), f"{side}orbit")
        return f"<OrbitFamily {self.name} of {self.system.name}: {many}, ends: {self.reason}>"

    def _repr_html_(self) -> str:
        """The table that a notebook shows: the first and the last orbits."""
        ends = [self[index] for index in sorted({*range(min(3, len(self))), *range(max(0, len(self) - 3), len(self))})]
        rows = [self._row(orbit) for orbit in ends]
        head = "".join(f"<th>{escape(name)}</th>" for name in rows[0])
        body = "".join("<tr>" + "".join(f"<td>{v:.8g}</td>" for v in row.values()) + "</tr>" for row in rows)
        return f"<table><caption>{escape(repr(self)[1:-1])}</caption><tr>{head}</tr>{body}</table>"
