"""The stability parameters along a family, sampled finely enough to trust the list of resonances.

Between neighbouring samples cubic interpolation predicts the characteristic polynomial (`explore.numerics.resolve`)
and no stability parameter in the band [-BAND, BAND], which holds all resonant values, changes by more than
`MAX_CHANGE`. Its local extrema are followed to the orbit where they occur: how far they stay from the resonant
values says how far the family is from a pair of further resonances there.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np

from orbitproof.explore.families.continuation import Family
from orbitproof.explore.flow import Vector
from orbitproof.explore.names import resonant_values
from orbitproof.explore.numerics import Samples, refine_minimum, resolve, subdivide
from orbitproof.explore.orbits import CorrectionFailure, SymmetricOrbit, stability_parameters
from orbitproof.explore.records import BAND

CLOSE = 0.02
"""Distance of an extremum from a resonant value below which the curve is sampled more finely around it."""

AROUND = 17
"""Samples around such an extremum."""

MAX_CHANGE = 0.05
"""Largest change of a stability parameter in the band between neighbouring samples."""


@dataclass(frozen=True)
class Extremum:
    """A local extremum of a stability parameter along a family.

    Attributes:
        orbit: where it is.
        value: the stability parameter there.
        k, level: the resonance whose value cos(2 pi j/k) is nearest.
    """

    orbit: SymmetricOrbit
    value: float
    k: int
    level: float

    @property
    def distance(self) -> float:
        """From the nearest resonant value."""
        return abs(self.value - self.level)


class StabilityCurve:
    """The orbits of a family and their stability as a function of the arclength, each computed once."""

    def __init__(self, family: Family, timeout: float = inf) -> None:
        self.family = family
        self.timeout = timeout
        self._end = time.monotonic() + timeout
        self._failures: dict[float, str] = {}
        self._orbits = {orbit.arclength: orbit for orbit in family.orbits}

    def orbit(self, arclength: float) -> SymmetricOrbit:
        """The orbit at an arclength. Raises `CorrectionFailure`."""
        orbit = self._orbits.get(arclength)
        if orbit is None:
            orbit = self._orbits[arclength] = self.family.orbit_at(arclength)
        return orbit

    def coefficients(self, arclength: float) -> Vector:
        """Characteristic coefficients of Sigma without the leading 1; interpolated where Newton fails."""
        try:
            return self.orbit(arclength).coefficients[1:]
        except (CorrectionFailure, ZeroDivisionError) as error:
            self._failures[arclength] = str(error)
            places = self.family.arclengths
            rows = np.array([orbit.coefficients[1:] for orbit in self.family.orbits])
            return np.array([np.interp(arclength, places, column) for column in rows.T])

    @property
    def unknown(self) -> tuple[str, ...]:
        """Where the stability is not known, in one line however many orbits there are; empty if it is everywhere."""
        if not self._failures:
            return ()
        first, last, count = min(self._failures), max(self._failures), len(self._failures)
        where = f"arclength {first:.6g}" if count == 1 else f"{count} orbits, arclength {first:.6g} to {last:.6g}"
        return (f"stability unknown at {where}: {self._failures[first]}",)

    def samples(self, progress: Callable[[float], None] | None = None) -> Samples:
        """The coefficients, sampled as the module's text says."""
        length = self.family.arclengths[-1]

        def first_half(place: float) -> None:
            if progress is not None:
                progress(place / 2)

        def second_half(place: float) -> None:
            if progress is not None:
                progress((length + place) / 2)

        coarse = resolve(self.coefficients, self.family.arclengths, progress=first_half, stop=self._is_late)
        return subdivide(
            self.coefficients,
            coarse,
            lambda low, high: largest_change(low, high) <= MAX_CHANGE,
            progress=second_half,
            stop=self._is_late,
        )

    def _is_late(self) -> bool:
        return time.monotonic() > self._end

    def left_out(self, samples: Samples) -> tuple[str, ...]:
        """What a time limit left out of the samples, in one line; empty if nothing."""
        if samples.places[-1] >= self.family.arclengths[-1]:
            return ()
        return (
            f"no resonances are looked for beyond arclength {samples.places[-1]:.6g} of "
            f"{self.family.arclengths[-1]:.6g}: sampling ended after {self.timeout:g} s; give --sampling-timeout more, "
            "or a shorter part of the family",
        )

    def error(self, samples: Samples) -> float:
        """The largest estimate of the error of a stability parameter in the band, by rounding and truncation."""
        errors = [0.0]
        for place, value in zip(samples.places, samples.values, strict=True):
            orbit = self._orbits.get(place)
            if orbit is not None and orbit.derivative is not None and np.any(np.abs(_roots(value)) <= BAND):
                errors.append(orbit.derivative.error)
        return max(errors)

    def orbits(self, samples: Samples, extrema: Sequence[Extremum]) -> tuple[SymmetricOrbit, ...]:
        """The orbits at the samples, at the extrema and around those close to a resonance, by arclength.

        Without those that could not be computed.
        """
        places = set(samples.places)
        for extremum in extrema:
            places.add(extremum.orbit.arclength)
            if extremum.distance < CLOSE:
                places |= set(self._around(extremum))
        return tuple(self._orbits[place] for place in sorted(places) if place in self._orbits)

    def _around(self, extremum: Extremum) -> list[float]:
        """Places around an extremum, as far as the curve is about three times as far from the resonance."""
        centre, step = extremum.orbit.arclength, 1e-3
        ends = self.family.arclengths[0], self.family.arclengths[-1]
        if not ends[0] < centre - step < centre + step < ends[1]:
            return []
        sides = [_roots(self.coefficients(centre + sign * step)) for sign in (-1, 1)]
        bend = max(float(np.min(np.abs(side - extremum.value))) for side in sides)
        width = step * float(np.sqrt(extremum.distance / max(bend, 1e-12)))
        offsets = np.linspace(-2.0, 2.0, AROUND) * width
        places = [centre + float(offset) for offset in offsets if ends[0] < centre + offset < ends[1]]
        for place in places:
            self.coefficients(place)
        return places

    def extrema(self, samples: Samples, multiplicities: Iterable[int]) -> list[Extremum]:
        """The extrema of real stability parameters in the band, by arclength."""
        levels = [(value, k) for k in sorted(set(multiplicities)) if k > 1 for value in resonant_values(k)]
        found: list[Extremum] = []
        if not levels:
            return found
        rows = [_roots(value) for value in samples.values]
        for index in range(1, len(rows) - 1):
            triple = rows[index - 1 : index + 2]
            if any(np.any(row.imag != 0) for row in triple):
                continue
            for number, (low, middle, high) in enumerate(zip(*(row.real for row in triple), strict=True)):
                if abs(middle) > BAND or not (middle - low) * (high - middle) <= 0 or low == middle == high:
                    continue
                sign = 1.0 if middle <= low and middle <= high else -1.0

                def height(place: float, number: int = number, sign: float = sign) -> float:
                    return sign * float(_roots(self.coefficients(place))[number].real)

                place, _ = refine_minimum(
                    height, samples.places[index - 1 : index + 2], (sign * low, sign * middle, sign * high)
                )
                orbit = self.orbit(place)
                value = float(_roots(orbit.coefficients[1:])[number].real)
                level, k = min(levels, key=lambda pair: abs(pair[0] - value))
                found.append(Extremum(orbit, value, k, level))
        return found


def largest_change(low: Vector, high: Vector) -> float:
    """Largest change, between two samples, of a stability parameter that is in the band at one of them."""
    changes = [
        abs(b - a)
        for a, b in zip(_roots(low), _roots(high), strict=True)
        if (min(abs(a.real), abs(b.real)) <= BAND or a.real * b.real < 0)
        # A resonant stability parameter is real: far from the real axis nothing can hide.
        and min(abs(a.imag), abs(b.imag)) <= 2 * MAX_CHANGE
    ]
    return max(changes, default=0.0)


def largest_changes(samples: Sequence[Vector]) -> float:
    """The largest of `largest_change` between neighbours; `samples` are coefficients without the leading 1."""
    return max((largest_change(low, high) for low, high in pairwise(samples)), default=0.0)


def _roots(coefficients: Vector) -> np.ndarray:
    return np.array(stability_parameters(np.append(1.0, coefficients)))
