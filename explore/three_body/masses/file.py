"""Mass-curve files: symmetry-breaking points in the mass parameter as JSON, version 1.

``{"format": "orbitproof-mass-curve", "version": 1, "curves": [...]}``; the fields stand in
``shared/schemas/mass-curve.schema.json``. Points of the curve are in double precision, with their mass as an exact
string; points at given masses and extrema of the Jacobi constant carry the digits that were asked for. Reading it
needs neither JAX nor mpmath.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any

from orbitproof.shared.formats import InputError, read_document, validate_document, write_text
from orbitproof.shared.numbers import format_exact, parse_exact


@dataclass(frozen=True)
class PointRecord:
    """The symmetry-breaking point at one mass parameter, in double precision.

    Attributes:
        mu: mass parameter.
        x, vy: where the orbit crosses the axis first, nondimensional; (x, 0, vy) is a point of Fix(R).
        second: x and vy half a period later.
        scaled: x and vy in the coordinates of `masses.charts.MassChart`: for L1 and L2 x - 1 + mu and vy in units
            of mu^(1/3), which keep the digits that x loses; for L3 x + mu and vy.
        half_period: nondimensional.
        jacobi_constant, jacobi_derivative: C and dC/dmu along the curve.
        residual: size of the last Newton correction, in the units of `scaled`.
    """

    mu: float
    x: float
    vy: float
    second: tuple[float, float]
    scaled: tuple[float, float]
    half_period: float
    jacobi_constant: float
    jacobi_derivative: float
    residual: float


@dataclass(frozen=True)
class SettingsRecord:
    """How a precise point was integrated; `None`: what suits the bits."""

    bits: int
    order: int | None
    tolerance: float | None


@dataclass(frozen=True)
class PreciseRecord:
    """A point at an exact mass; see the schema for the meaning of the fields."""

    mu: Fraction
    x: Fraction
    vy: Fraction
    half_period: float
    jacobi_constant: Fraction
    jacobi_derivative: Fraction
    digits: int
    settings: SettingsRecord
    residual: float
    change: float
    float64_error: float


@dataclass(frozen=True)
class ExtremumRecord:
    """A local extremum of the Jacobi constant along a curve; `mu` is rounded to `digits` digits."""

    kind: str
    mu: Fraction
    mu_exact: Fraction
    x: Fraction
    vy: Fraction
    half_period: float
    jacobi_constant: Fraction
    jacobi_second_derivative: float
    digits: int
    settings: SettingsRecord
    residual: float
    change: float


@dataclass(frozen=True)
class CurveRecord:
    """A curve as it stands in a file."""

    libration: str
    outcome: str
    reason: str
    points: tuple[PointRecord, ...]
    precise: tuple[PreciseRecord, ...] = ()
    extrema: tuple[ExtremumRecord, ...] = ()


def rounded(value: Fraction, digits: int) -> Fraction:
    """The decimal number of `digits` significant digits next to a number."""
    context = Context(prec=digits)
    return Fraction(context.divide(Decimal(value.numerator), Decimal(value.denominator)))


def decimal_text(value: Fraction) -> str:
    """A decimal fraction in plain or scientific notation."""
    # One more digit than the denominator can ask for keeps the division exact.
    context = Context(prec=len(str(value.numerator)) + value.denominator.bit_length() + 1)
    return str(context.divide(Decimal(value.numerator), Decimal(value.denominator)).normalize(context)).lower()


def write_curves(path: Path, curves: Sequence[CurveRecord]) -> None:
    """Write a mass-curve file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = {"format": "orbitproof-mass-curve", "version": 1, "curves": [_to_json(curve) for curve in curves]}
    validate_document(document, "mass-curve", "mass-curve file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def _to_json(curve: CurveRecord) -> dict[str, Any]:
    return {
        "libration": curve.libration,
        "outcome": curve.outcome,
        "reason": curve.reason,
        "points": [
            {
                **vars(point),
                "mu": format_exact(Fraction(point.mu)),
                "second": list(point.second),
                "scaled": list(point.scaled),
            }
            for point in curve.points
        ],
        "precise": [
            {
                **vars(point),
                "mu": format_exact(point.mu),
                "x": format_exact(point.x),
                "vy": format_exact(point.vy),
                "jacobi_constant": decimal_text(point.jacobi_constant),
                "jacobi_derivative": decimal_text(point.jacobi_derivative),
                "settings": vars(point.settings),
            }
            for point in curve.precise
        ],
        "extrema": [
            {
                **vars(point),
                "mu": decimal_text(point.mu),
                "mu_exact": format_exact(point.mu_exact),
                "x": format_exact(point.x),
                "vy": format_exact(point.vy),
                "jacobi_constant": decimal_text(point.jacobi_constant),
                "settings": vars(point.settings),
            }
            for point in curve.extrema
        ],
    }


def read_curves(path: Path) -> list[CurveRecord]:
    """Read a mass-curve file. Raises `InputError`, one line, for anything that is not well formed."""
    document = read_document(path, "mass-curve")
    curves: list[CurveRecord] = []
    for index, entry in enumerate(document["curves"]):
        curve = _curve(entry, f"{path}: field curves[{index}]")
        if any(curve.libration == other.libration for other in curves):
            raise InputError(
                f"{path}: field curves[{index}].libration: {curve.libration} appears twice; keep one curve of it"
            )
        curves.append(curve)
    return curves


def _curve(entry: Mapping[str, Any], source: str) -> CurveRecord:
    points = []
    for index, point in enumerate(entry["points"]):
        where = f"{source}.points[{index}]"
        mu = _mass(point["mu"], where)
        numbers = {name: point[name] for name in ("x", "vy", "half_period", "jacobi_constant", "jacobi_derivative")}
        second, scaled = point["second"], point["scaled"]
        if not all(isfinite(value) for value in (*numbers.values(), *second, *scaled, point["residual"])):
            raise InputError(f"{where}: a number is too large for a double; write the file again")
        points.append(
            PointRecord(
                mu=float(mu),
                second=(float(second[0]), float(second[1])),
                scaled=(float(scaled[0]), float(scaled[1])),
                residual=float(point["residual"]),
                **{name: float(value) for name, value in numbers.items()},
            )
        )
    exact = ("x", "vy", "jacobi_constant")
    precise = [
        PreciseRecord(
            **{
                **point,
                **{name: parse_exact(point[name]) for name in (*exact, "jacobi_derivative")},
                "mu": _mass(point["mu"], f"{source}.precise[{index}]"),
                "settings": SettingsRecord(**point["settings"]),
            }
        )
        for index, point in enumerate(entry["precise"])
    ]
    extrema = [
        ExtremumRecord(
            **{
                **point,
                **{name: parse_exact(point[name]) for name in exact},
                "mu": _mass(point["mu"], f"{source}.extrema[{index}]"),
                "mu_exact": _mass(point["mu_exact"], f"{source}.extrema[{index}]"),
                "settings": SettingsRecord(**point["settings"]),
            }
        )
        for index, point in enumerate(entry["extrema"])
    ]
    return CurveRecord(
        libration=entry["libration"],
        outcome=entry["outcome"],
        reason=entry["reason"],
        points=tuple(points),
        precise=tuple(precise),
        extrema=tuple(extrema),
    )


def _mass(text: str, where: str) -> Fraction:
    value = parse_exact(text)
    if not 0 < value < 1 or not 0.0 < float(value) < 1.0:
        raise InputError(f"{where}.mu: {text} lies outside (0, 1); write the file again")
    return value
