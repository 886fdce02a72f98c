"""Catalogues of a proved curve, and tables in which each row says what is proved of it (section 32.4)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from math import ceil, inf, nextafter
from typing import Any

from flint import arb, ctx

from orbitproof.shared.formats import FIELDS, CatalogueRows, CatalogueTable, InputError
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import UNITS, shown
from orbitproof.verify.branches.catalogue import CertifiedRow, orbits_of
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.evidence import enclose, exact_value, is_below
from orbitproof.verify.orbit_on_curve import PRECISION, OrbitOnCurve, OrbitPlace

_STATE = FIELDS[:6]

COLUMNS = (
    "proved", "state_within", "jacobi_within", "period_within", "stability_within", "least_distance",
    "greatest_distance", "distances_within", "hits",
)  # fmt: skip
"""Beside the nine of a catalogue."""


def rows_of_curve(curve: Certificate, count: int) -> CatalogueRows:
    """A catalogue of so many orbits of a curve, at equal steps of s along its pieces: the middles of their enclosures.

    What is certified of it is what `certified_rows` says. Raises `InputError` for other curves, as `orbits_of` does.
    """
    orbits = orbits_of(curve)
    stretches = orbits.curve.chain.stretches
    length = sum((stretch.leaves - stretch.entered for stretch in stretches), Fraction(0))
    wanted = iter([length * i / (count - 1) for i in range(count)] if count > 1 else [Fraction(0)])
    rows, before, place = [], Fraction(0), next(wanted, None)
    for stretch in stretches:
        part = stretch.leaves - stretch.entered
        while place is not None and place <= before + part:
            at = OrbitPlace(stretch.tube.piece.id, stretch.entered + place - before)
            with suppress(ValueError):
                rows.append(_middle(orbits.at(at)))
            place = next(wanted, None)
        before += part
    if not rows:
        raise InputError(f"the certificate {shown(curve.id)}: has no functions; prove the curve with its list")
    mass = orbits.atlas.parameters["mu"]
    units = UNITS.get(mass)
    return CatalogueRows(
        mass, tuple(rows), system="" if units is None else units.name, family=curve.id,
        system_details={} if units is None else dict(units.details),
    )  # fmt: skip


def _middle(orbit: OrbitOnCurve) -> tuple[Fraction, ...]:
    """The numbers of a row, as doubles, from the enclosures of an orbit; an index that is not known is 0."""
    state = [Fraction(float(orbit.point[name].mid())) if name in orbit.point else Fraction(0) for name in _STATE]
    index = Fraction(0) if orbit.stability_index is None else Fraction(float(orbit.stability_index.mid()))
    return (*state, Fraction(float(orbit.level.mid())), Fraction(float(orbit.period.mid())), index)


def certified_table(rows: CatalogueRows, document: Mapping[str, Any]) -> CatalogueTable:
    """The rows of a catalogue with what their certificate proves of each, as far as it stands.

    Columns: what is proved in words; bounds, rounded up, of the differences of the orbit's state, level, period and
    index from the row's; the middle of the enclosures of its least and greatest distance from the smaller primary, with
    a bound of how far the true ones are from there; and, where the catalogue names its units, whether the orbit meets
    the body.

    Raises `InputError` if the certificate is about another mass ratio or another number of rows, or a number of the
    rows is none of a table.
    """
    certified = from_json(tuple[CertifiedRow, ...], document["rows"], "rows")
    columns: dict[str, list[Any]] = {name: [] for name in COLUMNS}
    mass = parse_exact(document["statement"]["mass_ratio"])
    if (mass, len(certified)) != (rows.mass_ratio, len(rows.rows)):
        raise InputError("the certificate: is about another mass ratio or other rows; give that of these rows")
    radius = _radius(rows)
    try:
        written = [[float(value) for value in row] for row in rows.rows]
    except OverflowError:
        raise InputError("the rows: a number is greater than all doubles; leave its row out") from None
    for row, numbers in zip(certified, written, strict=True):
        for name, value in zip(COLUMNS, _cells(row, _rounding(row, numbers), radius), strict=True):
            columns[name].append(value)
    kept = {name: values for name, values in rows.more.items() if name not in COLUMNS}
    return CatalogueTable(
        rows.mass_ratio, written,
        range(1, len(rows.rows) + 1), {**kept, **columns}, rows.system, rows.family, rows.point, rows.branch,
        rows.system_details, rows.details,
    )  # fmt: skip


def _radius(rows: CatalogueRows) -> arb | None:
    """The smaller primary's radius in units of length, if the file names both; `None` also if that is no length."""
    details = rows.system_details
    if "lunit" not in details or "radius_secondary" not in details:
        return None
    unit, radius = (Fraction(str(details[name])) for name in ("lunit", "radius_secondary"))
    with ctx.workprec(PRECISION):
        return enclose(radius) / enclose(unit) if unit > 0 <= radius else None


def _rounding(row: CertifiedRow, numbers: Sequence[float]) -> list[Fraction]:
    """How far the numbers of a row are from what a table has, at most: doubles, or their decimals of any length."""
    return [
        max(abs(value - given) for value in _as_written(number))
        for number, given in zip(numbers, row.given, strict=True)
    ]


def _as_written(number: float) -> tuple[Fraction, ...]:
    """What a table says where it has this double: the number itself, or one of its decimals."""
    return Fraction(number), Fraction(repr(number)), Fraction(f"{number:.16e}")


def _cells(row: CertifiedRow, rounding: Sequence[Fraction], radius: arb | None) -> tuple[Any, ...]:
    """In the order of `COLUMNS`; what is not proved is empty. The bounds are from the numbers as the table has them."""
    if row.orbit is None or row.differences is None:
        return (f"no: {row.lacks}", *(None,) * (len(COLUMNS) - 1))
    off, orbit = row.differences, row.orbit
    balls = (off.point, off.level, off.period, off.stability_index)
    slack = (sum(rounding[:6], Fraction(0)), *rounding[6:])
    within = [
        None if ball is None else rounded_up(ball + enclose(more)) for ball, more in zip(balls, slack, strict=True)
    ]
    words = f"a symmetric periodic orbit starts at most {within[0]:.2e} away"
    if orbit.least is None or orbit.greatest is None:
        return (words, *within, None, None, None, "unknown")
    middles = [float(ball.mid()) for ball in (orbit.least, orbit.greatest)]
    with ctx.workprec(PRECISION):
        found = zip((orbit.least, orbit.greatest), middles, strict=True)
        apart = max(rounded_up(abs(ball - enclose(value))) for ball, middle in found for value in _as_written(middle))
        hits = "unknown"
        if radius is not None and is_below(radius, orbit.least):
            hits = "no"
        elif radius is not None and is_below(orbit.least, radius):
            hits = "yes"
    return (words, *within, *middles, apart, hits)


def rounded_up(ball: arb) -> float:
    """A double that is no less than any number of a ball of numbers that are not negative, at three digits."""
    with ctx.workprec(PRECISION):
        top = exact_value(ball.upper())
    exponent = int(f"{float(top):e}".partition("e")[2]) if top else 0
    unit = Fraction(10) ** (exponent - 2)
    value = float(ceil(top / unit) * unit)
    return value if Fraction(value) >= top else nextafter(value, inf)
