"""The rows of certificates files as the tables need them: verdict, enclosures, side, place on Fix(R), cost."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from flint import arb

from orbitproof.explore.three_body.names import NORTH, SOUTH
from orbitproof.figures.orbits import centre_on_fixed_set
from orbitproof.figures.tables.intervals import Interval, parse_interval
from orbitproof.shared.claims.candidate import OfKind
from orbitproof.shared.formats import (
    KINDS,
    REVERSOR_BREAKING,
    Candidate,
    InputError,
    candidate_from_json,
    candidate_to_json,
    read_candidates,
    validate_document,
)
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS, ReversibleSystem, with_functions
from orbitproof.verify.certificate import read_certificates
from orbitproof.verify.evidence import FUNCTIONS, Reason, as_said, ball_from_json, bounds, enclose, power

_NUMBERED = re.compile(r"-(k[0-9]+|fold|loss)-[0-9]+(-second)?\Z")
_HALO = re.compile(r"L([123])-halo(-[0-9]+)?(-north)?")
_LARGEST_EXPONENT = 150_000
_PART = re.compile(r"-?[0-9]+(?:\.([0-9]+))?(?:e([+-]?[0-9]+))?\Z")


@dataclass(frozen=True)
class Enclosure:
    """A ball of a certificate: for printing, and as the exact interval that it is."""

    ball: arb
    interval: Interval


@dataclass(frozen=True)
class CertifiedRow(OfKind):
    """One certificate.

    Attributes:
        id: of the candidate.
        family: name of the family that the id, or the provenance of the candidate, names.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters.
        kind, k: what is claimed.
        proved: the verdict.
        reason: why it is not proved, in one line, as the run said; empty if it is.
        parameter_name: family parameter or first integral.
        parameter: its enclosure at the bifurcation point; `None` if not proved.
        point: enclosures of the coordinates of the point on Fix(R); empty if not proved.
        value: the enclosure of the parameter or, if not proved, its approximate value at the centre of the
            box (two equal ends); `None` where it is not defined.
        side: parameter values at which the new orbits exist: above, below or both; empty if not proved.
        crossing: +1 or -1, the sign of the derivative of the section coordinate at the point on Fix(R), which
            tells the two points of an orbit apart; 0 if undecided.
        seconds, precision: cost of the proof, and the bits of its last attempt.
        arclength: position along the family, if a candidates file told it.
        branch: "north" or "south", the sign of z where a halo orbit is far from the smaller primary; "" for others.
    """

    id: str
    family: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    kind: str
    k: int
    proved: bool
    reason: str
    parameter_name: str
    parameter: Enclosure | None
    point: Mapping[str, Enclosure]
    value: Interval | None
    side: str
    crossing: int
    seconds: float
    precision: int
    arclength: float | None = None
    branch: str = ""


def read_rows(paths: Sequence[Path], candidates: Sequence[Path] = ()) -> list[CertifiedRow]:
    """The rows of certificates files, in their order.

    Candidates files, if given, add what certificates leave out because no proof needs it: the name of the
    family and the position along it. Raises `InputError` for bad files, for an id that appears twice, and for
    a candidate that differs from what its certificate speaks about.
    """
    sources: dict[str, Path] = {}
    rows: list[CertifiedRow] = []
    claims: dict[str, Candidate] = {}
    for path in paths:
        for index, (name, certificate) in enumerate(read_certificates(path).items()):
            if name in sources:
                raise InputError(f"{path}: id {name!r} is in {sources[name]} as well; give each certificate once")
            sources[name] = path
            if certificate.kind not in (*KINDS, REVERSOR_BREAKING):
                continue
            row, claims[name] = _row(certificate.to_json(), f"{path}: field certificates[{index}]")
            rows.append(row)
    origins = {candidate.id: (path, candidate) for path in candidates for candidate in read_candidates(path)}
    return [_place(row, claims[row.id], *origins[row.id]) if row.id in origins else row for row in rows]


def _row(certificate: Mapping[str, Any], where: str) -> tuple[CertifiedRow, Candidate]:
    claim = _claim(certificate["statement"]["candidate"], f"{where}.statement.candidate")
    if claim.id != certificate["id"]:
        raise InputError(f"{where}.id: differs from the id in its statement; verify again")
    system, results = claim.system, certificate["results"]
    name = system.family_parameter or system.first_integral_name or "first integral"
    parameter: Enclosure | None = None
    point: dict[str, Enclosure] = {}
    if results:
        if results["parameter_name"] != name or set(results["point"]) != set(system.centre_coordinates):
            raise InputError(f"{where}.results: parameter or coordinates are not those of {system.name}; verify again")
        parameter = _enclosure(results["parameter"], f"{where}.results.parameter")
        point = {key: _enclosure(ball, f"{where}.results.point.{key}") for key, ball in results["point"].items()}
    balls = [point[key].ball for key in system.centre_coordinates] if point else centre_on_fixed_set(claim)
    parameter_value, crossing = _at_point(system, claim.parameters, balls)
    reason, computation, family = certificate["reason"], certificate["computation"], _family_of(claim)
    if not 0 <= computation["seconds"] < math.inf:
        raise InputError(f"{where}.computation.seconds: not a time; verify again")
    row = CertifiedRow(
        id=claim.id,
        family=family,
        system=system,
        parameters=claim.parameters,
        kind=claim.kind,
        k=claim.k,
        proved=certificate["verdict"] == "proved",
        reason=as_said(Reason(**reason)) if reason else "",
        parameter_name=name,
        parameter=parameter,
        point=point,
        value=parameter_value if parameter is None else parameter.interval,
        side=results["side"] if results else "",
        crossing=crossing,
        seconds=computation["seconds"],
        precision=computation["precision"],
        branch=_branch(system, family, crossing, balls),
    )
    return row, claim


def _claim(entry: Mapping[str, Any], where: str) -> Candidate:
    document = {"format": "orbitproof-candidates", "version": 1, "candidates": [entry]}
    validate_document(document, "candidates", where)
    return candidate_from_json(entry, where)


def _enclosure(entry: Mapping[str, str], where: str) -> Enclosure:
    """The ball of a certificate. A decimal beside it that is not its outward rounding betrays a change by hand."""
    try:
        ball = ball_from_json(entry)
    except (ValueError, OverflowError) as error:
        raise InputError(f"{where}: {error}; the file was changed, verify again") from None
    if any(abs(int(part.man_exp()[1])) > _LARGEST_EXPONENT for part in (ball.mid(), ball.rad())):
        raise InputError(f"{where}: of a size that no computation gives; the file was changed, verify again")
    interval = Interval(*bounds(ball))
    if "decimal" in entry and not _rounds(interval, entry["decimal"]):
        raise InputError(f"{where}: ball and decimal do not agree; the file was changed, verify again")
    return Enclosure(ball, interval)


def _rounds(interval: Interval, text: str) -> bool:
    """Whether `text` contains the interval, with each end less than one unit of its last place away."""
    try:
        decimal = parse_interval(text)
    except ValueError:
        return False
    low, high = (_unit(part.strip()) for part in text.strip("[]").split(","))
    return interval.inside(decimal) and interval.lower - decimal.lower < low and decimal.upper - interval.upper < high


def _unit(text: str) -> Fraction:
    match = _PART.match(text)
    if match is None:
        return Fraction(0)
    return Fraction(10) ** (int(match[2] or 0) - len(match[1] or ""))


def _ball(value: Fraction) -> arb:
    return arb(value.numerator) / arb(value.denominator)


def _at_point(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[arb]
) -> tuple[Interval | None, int]:
    """Value of the bifurcation parameter and sign of the section coordinate's derivative at a point of Fix(R)."""
    coordinates = dict(zip(system.centre_coordinates, point, strict=True))
    state = [coordinates.get(name, arb(0)) for name in system.state]
    values = [coordinates[name] if name in coordinates else _ball(parameters[name]) for name in system.parameters]
    state = with_functions(system, state, values, FUNCTIONS, enclose, power)
    value: Interval | None = None
    crossing = 0
    integral = system.first_integral_program
    try:
        if system.family_parameter is not None:
            level = point[0]
        else:
            level = arb("nan") if integral is None else integral.evaluate([*state, *values], enclose, power)[0]
        speed = system.program.evaluate([*state, *values], enclose, power)[system.section_index]
    except (ZeroDivisionError, ValueError):
        return None, 0
    if level.is_finite():
        middle = Interval(*bounds(level)).middle
        value = Interval(middle, middle)
    # On a fixed level one coordinate of the state is not among those of the claim.
    if speed.is_finite() and system.fixed_level is None:
        crossing = 1 if speed > 0 else -1 if speed < 0 else 0
    return value, crossing


def _branch(system: ReversibleSystem, family: str, crossing: int, point: Sequence[arb]) -> str:
    """The side of a halo orbit from one of its two points on Fix(R), which are on different sides of the plane.

    Far from the smaller primary y increases on the orbits of L1 and L3, and decreases on those of L2.
    """
    place = _HALO.fullmatch(family)
    if system is not CR3BP or place is None:
        return ""
    height = point[system.centre_coordinates.index("z")] * crossing * (-1 if place[1] == "2" else 1)
    return NORTH if height > 0 else SOUTH if height < 0 else ""


def _family_of(claim: Candidate) -> str:
    """The name of the family in an id such as ``earth-moon-L1-halo-k2-1``; the name of the system without one."""
    name = _NUMBERED.sub("", claim.id)
    if name == claim.id:
        return claim.system.name
    for prefix in (*MASS_PARAMETERS, claim.system.name):
        name = name.removeprefix(f"{prefix}-")
    return name


def _place(row: CertifiedRow, claim: Candidate, path: Path, candidate: Candidate) -> CertifiedRow:
    if candidate_to_json(candidate, provenance=False) != candidate_to_json(claim, provenance=False):
        raise InputError(f"{path}: candidate {row.id!r} differs from the one that was certified; verify again")
    family, arclength = candidate.provenance.get("family"), candidate.provenance.get("arclength")
    known = isinstance(arclength, (int, float)) and math.isfinite(arclength)
    return replace(
        row,
        family=family if isinstance(family, str) and family.strip() else row.family,
        arclength=float(arclength) if arclength is not None and known else None,
    )
