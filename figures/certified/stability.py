"""The stability along a certified curve as the pictures draw it: stored functions in double precision, with bounds.

Resonances, extrema and stable intervals are copied from the certificate's complete list; the pictures prove nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from orbitproof.figures.certified.curve import Curve, Stretch
from orbitproof.figures.certified.twist import twist_on
from orbitproof.figures.orbits import Array
from orbitproof.shared.numbers import parse_exact
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.functions import StoredFunction
from orbitproof.verify.stability import REACH, StabilityFunctions

Ends = tuple[tuple[str, float], tuple[str, float]]
"""Two places on a curve, by (piece, s)."""


@dataclass(frozen=True)
class StabilityOnStretch:
    """The stability parameters on the part of a piece that the curve runs along.

    Attributes:
        stretch: of the curve.
        parameters: complex, shape (M, n), at the stretch's s; NaN where nothing is known.
        bounds: shape (M, n), how far the real ones may be off.
        level, half_period: shape (M,); the level is the first integral or the family parameter.
        twist: shape (M,), NaN where it is not known.
    """

    stretch: Stretch
    parameters: Array
    bounds: Array
    level: Array
    half_period: Array
    twist: Array


@dataclass(frozen=True)
class ListedPoint:
    """A point of the complete list, with k and j of cos(2 pi j/k); whether a certificate is about it."""

    piece: str
    s: float
    k: int
    j: int
    kind: str
    level: float
    half_period: float
    certified: bool

    @property
    def value(self) -> float:
        """The stability parameter."""
        return float(np.cos(2 * np.pi * self.j / self.k))


@dataclass(frozen=True)
class CertifiedStability:
    """A certified curve with its complete list.

    Attributes:
        curve: the curve.
        order: the largest k of the list.
        parts: in order along the curve.
        points: of the list, without Krein collisions.
        stable: the linearly stable intervals, by (piece, s) at both ends.
        lasting: those of orbits that are stable for ever, with whether their twist is positive.
        twistless: orbits without twist, by (piece, s).
    """

    curve: Curve
    order: int
    parts: tuple[StabilityOnStretch, ...]
    points: tuple[ListedPoint, ...]
    stable: tuple[Ends, ...]
    lasting: tuple[tuple[Ends, bool], ...] = ()
    twistless: tuple[tuple[str, float], ...] = ()

    @classmethod
    def of(cls, certificate: Certificate) -> CertifiedStability | None:
        """The stability along the curve of a certificate; `None` if it has no complete list."""
        listed = (certificate.document["conclusion"] or {}).get("complete")
        if not listed or not certificate.proved:
            return None
        curve = Curve.of(certificate)
        lasting = listed.get("lasting", {"stable": [], "exceptions": []})
        return cls(
            curve,
            int(listed["order"]),
            tuple(_on_stretch(stretch, certificate) for stretch in curve.stretches),
            tuple(_point(entry) for entry in listed["points"] if entry["k"]),
            tuple(map(_ends, listed["stable"])),
            tuple((_ends(entry), entry["twist"] == "positive") for entry in lasting["stable"]),
            tuple(
                (entry["piece"], float(parse_exact(entry["s"]["mid"])))
                for entry in lasting["exceptions"]
                if entry["kind"] == "twistless"
            ),
        )


def _point(entry: Mapping[str, Any]) -> ListedPoint:
    s, level, half_period = (float(parse_exact(entry[name]["mid"])) for name in ("s", "level", "half_period"))
    certified = bool(entry["certificates"])
    return ListedPoint(entry["piece"], s, entry["k"], entry["j"], entry["kind"], level, half_period, certified)


def _ends(entry: Mapping[str, Any]) -> Ends:
    return _end(entry["from"], 1), _end(entry["to"], 0)


def _end(entry: Mapping[str, Any], which: int) -> tuple[str, float]:
    return entry["piece"], float(parse_exact(entry["interval"][which]))


def _on_stretch(stretch: Stretch, certificate: Certificate) -> StabilityOnStretch:
    atlas, results = certificate.atlas, certificate.results
    twist = twist_on(stretch, atlas, results)
    # As in the list: of two results the one on the shorter interval, at equal lengths the one with more bits.
    known = [
        (float(result.interval[0]), float(result.interval[1]), result.stability)
        for result in sorted(results, key=lambda result: -(result.computation.precision or 0))
        if result.piece == stretch.piece and isinstance(result.stability, StabilityFunctions)
    ]
    known.sort(key=lambda item: item[1] - item[0])
    size = len(known[0][2].characteristic) if known else 1
    parameters = np.full((len(stretch.s), size), np.nan, complex)
    bounds = np.full((len(stretch.s), size), np.nan)
    level, half_period = (np.full(len(stretch.s), np.nan) for _ in range(2))
    for start, end, entry in reversed(known):
        inside = (stretch.s >= start) & (stretch.s <= end)
        tau = (stretch.s[inside] - (start + end) / 2) / ((end - start) / 2 * float(REACH))
        parameters[inside], bounds[inside] = _parameters(entry.characteristic, tau)
        for values, name in ((level, "level"), (half_period, "half_period")):
            values[inside] = _values(getattr(entry, name), tau)[0]
    return StabilityOnStretch(stretch, parameters, bounds, level, half_period, twist)


def _parameters(functions: Sequence[StoredFunction], tau: Array) -> tuple[Array, Array]:
    """The zeros of c^n - a_1 c^(n-1) + .., with what the bounds of the a_k mean for them to first order."""
    values, errors = zip(*(_values(entry, tau) for entry in functions), strict=True)
    n = len(values)
    signed = [np.ones_like(tau), *(value * (-1) ** k for k, value in enumerate(values, start=1))]
    zeros = np.array([np.sort_complex(np.roots([row[i] for row in signed])) for i in range(len(tau))])
    zeros = zeros.reshape(len(tau), n)
    shift = sum(error * np.abs(zeros) ** (n - k) for k, error in enumerate(errors, start=1))
    slope = np.abs(sum((n - k) * signed[k][:, None] * zeros ** (n - k - 1) for k in range(n)))
    return zeros, shift / np.maximum(slope, 1e-300)


def _values(entry: StoredFunction, tau: Array) -> tuple[Array, float]:
    coefficients = [float(value) for value in entry.coefficients] or [0.0]
    return np.polynomial.polynomial.polyval(tau, coefficients), float(entry.error)
