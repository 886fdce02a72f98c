"""The finely sampled stability of a family, from a family file: arrays, CSV text, and how fine the samples are."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from orbitproof.explore.records import ExtremumRecord, FamilyRecord, ResonanceRecord
from orbitproof.explore.records import read_families as read_records
from orbitproof.figures.model.family import MarkedPoint, SampledFamily
from orbitproof.figures.orbits import Array
from orbitproof.shared.formats import InputError

_SAME_ORBIT = 1e-3
_EVENT = ("what", "arclength", "level", "k", "kind", "on_fix_r")
_EVENT_VALUES = ("stability_parameter", "resonant_value", "distance", "candidate", "certified")


@dataclass(frozen=True)
class SampledStability:
    """A family of N orbits, so dense that between neighbours no resonance can hide.

    Attributes:
        family: the samples.
        half_periods: shape (N,).
        parameters: shape (N, n), complex: the stability parameters (lambda + 1/lambda)/2, by real part.
        resonances: located on the family in double precision.
        extrema: of the stability parameters, with the nearest resonant value.
    """

    family: SampledFamily
    half_periods: Array
    parameters: np.ndarray
    resonances: tuple[ResonanceRecord, ...]
    extrema: tuple[ExtremumRecord, ...]

    def changes(self, band: float) -> Array:
        """Largest change between neighbours of a real stability parameter in [-band, band], shape (N - 1,)."""
        real = np.where(self.parameters.imag == 0, self.parameters.real, np.nan)
        inside = np.abs(real) <= band
        steps = np.where(inside[1:] | inside[:-1], np.abs(np.diff(real, axis=0)), np.nan)
        return np.asarray(np.nan_to_num(np.nanmax(steps, axis=1, initial=0.0)))

    def summary(self, band: float) -> str:
        """In one line: how fine the samples are, and the extrema nearest to resonant values."""
        count, change = len(self.half_periods), float(self.changes(band).max(initial=0.0))
        text = f"{count} samples, stability parameters in [-{band:g}, {band:g}] change by {change:.2g} at most"
        nearest = sorted(self.extrema, key=lambda item: abs(item.stability_parameter - item.level))[:2]
        turns = [f"{item.stability_parameter:.7g} (1:{item.k} is {item.level:.3g})" for item in nearest]
        return f"{text}; extrema nearest to a resonance: {', '.join(turns)}" if turns else text

    def places(self, marks: Sequence[MarkedPoint]) -> list[BifurcationOnCurve]:
        """The resonances of the family file, each with the candidate that refines it, by arclength.

        Candidates that refine none of them, for example of other multiplicities, are placed by their point. Orbits
        that are claimed for themselves are at no resonance and have no place here.
        """
        rest = [mark for mark in marks if not mark.candidate.is_of_orbit]
        result: list[BifurcationOnCurve] = []
        for resonance in self.resonances:
            known = [
                mark for mark in rest if mark.k == resonance.k and np.allclose(mark.point, resonance.point, atol=1e-6)
            ]
            for mark in known[:1]:
                rest.remove(mark)
            level = resonance.point[0] if self.family.system.family_parameter is not None else resonance.first_integral
            mark = known[0] if known else None
            where = (resonance.side, resonance.arclength, float(level), resonance.stability_parameter)
            result.append(BifurcationOnCurve(resonance.k, resonance.kind, *where, mark))
        for mark in rest:
            found = self.family.place(mark)
            # The other point on Fix(R) of an orbit in resonance: at the arclength of that orbit.
            near = [
                item
                for item in self.resonances
                if item.k == mark.k and abs(item.arclength - found.arclength) < _SAME_ORBIT * (1 + found.arclength)
            ]
            value = near[0].stability_parameter if near else mark.candidate.provenance.get("resonant_value")
            value = float(value) if isinstance(value, float) else np.nan
            arclength = near[0].arclength if near else found.arclength
            where = ("second" if found.second else "first", arclength, mark.level, value)
            result.append(BifurcationOnCurve(mark.k, mark.candidate.kind, *where, mark))
        return sorted(result, key=lambda item: item.arclength)

    def samples_csv(self) -> str:
        """One line for each sample: place, both points on Fix(R), half period, level, stability parameters."""
        system = self.family.system
        names = system.centre_coordinates
        level = (system.first_integral_name or system.family_parameter or "level").replace(" ", "_").lower()
        numbers = range(1, self.parameters.shape[1] + 1)
        header = ["arclength", *names, *(f"{name}_half_period_later" for name in names), "half_period", level]
        header += [f"stability_{i}_{part}" for i in numbers for part in ("real", "imaginary")]
        family = self.family
        rows = np.column_stack(
            [family.arclength, family.points, family.second_points, self.half_periods, family.levels]
            + [part for column in self.parameters.T for part in (column.real, column.imag)]
        )
        return _csv(header, rows.tolist())

    def events_csv(self, places: Sequence[BifurcationOnCurve]) -> str:
        """One line for each resonance and for each extremum of a stability parameter, by arclength."""
        rows: list[tuple[object, ...]] = []
        for item in places:
            where = ("resonance", item.arclength, item.level, item.k, item.kind, item.side)
            candidate = (item.mark.candidate.id, item.mark.certified) if item.mark else ("", "")
            rows.append((*where, item.resonant_value, item.resonant_value, 0.0, *candidate))
        for turn in self.extrema:
            where = ("extremum", turn.arclength, turn.first_integral, turn.k, "", "")
            distance = abs(turn.stability_parameter - turn.level)
            rows.append((*where, turn.stability_parameter, turn.level, distance, "", ""))
        return _csv((*_EVENT, *_EVENT_VALUES), sorted(rows, key=lambda row: row[1]))


@dataclass(frozen=True)
class BifurcationOnCurve:
    """A bifurcation on the curve: its multiplicity and kind, where it is, and its candidate, if there is one."""

    k: int
    kind: str
    side: str
    arclength: float
    level: float
    resonant_value: float
    mark: MarkedPoint | None


def read_curves(path: Path) -> list[SampledStability]:
    """The curves of a family file. Raises `InputError` if it holds a family without one."""
    return [_curve(record, f"{path}: field families[{i}]") for i, record in enumerate(read_records(path))]


def _curve(record: FamilyRecord, source: str) -> SampledStability:
    curve = record.curve
    if curve is None:
        raise InputError(
            f"{source}.curve: missing; search the family for resonances (orbitproof explore family -k ...)"
        )
    family = SampledFamily(
        name=f"{record.label}-{record.name}" if record.label else record.name,
        system=record.system,
        parameters=record.parameters,
        points=curve.points,
        second_points=curve.second_points,
        periods=2 * curve.half_periods,
        levels=curve.points[:, 0] if record.system.family_parameter is not None else curve.first_integrals,
        coefficients=curve.coefficients,
        arclength=curve.arclength,
        branch=record.branch,
    )
    roots = np.array([np.sort_complex(np.roots(row)) for row in curve.coefficients])
    return SampledStability(family, curve.half_periods, roots, record.resonances, record.extrema)


def _csv(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([repr(value) if isinstance(value, float) else value for value in row] for row in rows)
    return stream.getvalue()
