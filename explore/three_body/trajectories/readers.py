"""An orbit from any file that names some: one reader for each format."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.branches import NoBranch, branch_point, centre_of, numbered, read_branches
from orbitproof.explore.connections import ConnectionFailure, half_of, setting_of
from orbitproof.explore.flow import Vector
from orbitproof.explore.names import Contradiction, NoOrbit, examined
from orbitproof.explore.orbits import ShootingProblem, stability_index
from orbitproof.explore.periodic import read_periodic_family
from orbitproof.explore.records import FamilyRecord, read_families
from orbitproof.explore.three_body.catalogues import Catalogue, correct_catalogue, read_catalogue
from orbitproof.explore.three_body.masses import read_curves
from orbitproof.explore.three_body.trajectories.crossing_time import half_period_of, time_of_crossing
from orbitproof.explore.three_body.trajectories.source import (
    Choice,
    Legs,
    Said,
    SourceOrbit,
    chosen_id,
    chosen_number,
    refuse_family,
    refuse_id,
    refuse_number,
    some,
)
from orbitproof.explore.three_body.trajectories.units import Units, units_of
from orbitproof.shared.claims import HomoclinicOrbit
from orbitproof.shared.formats import (
    HALF_PERIOD,
    LEVEL,
    AnyAtlas,
    Candidate,
    InputError,
    atlas_from_json,
    claim_from_json,
    read_atlas,
    read_claims,
    read_document,
    stated_format,
)
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, SYSTEMS, THREE_BODY, UNITS, ReversibleSystem

_REMEDY = (
    "give candidates, certificates, families, branches, an atlas or its certificate, tori, a manifold, a mass curve, "
    "or a catalogue or its certificate"
)

_ON_FIXED_SET = 1e-9
"""A state whose y, vx and vz are smaller is one of a symmetric orbit on Fix(R)."""

_OF_ROWS = (CR3BP, CR3BP_AXIAL, CR3BP_PLANAR)
"""The systems whose orbits the certificates of catalogues name by the coordinates of their points on Fix(R)."""


def find_orbit(path: Path, choice: Choice) -> SourceOrbit:
    """The orbit that is meant. Raises `InputError` for bad files and choices, `NoOrbit` if there is none there.

    Orbits of the CR3BP in the plane come as orbits of the CR3BP in space. Units are those that the file names, or else
    those of the catalogue whose mass parameter the orbit has.
    """
    kind = stated_format(path, _REMEDY)
    if kind not in _READERS:
        raise InputError(f"{path}: holds {kind}; {_REMEDY}")
    found = replace(_READERS[kind](path, choice), accept=choice.accept)
    examined(found.system, str(path))
    known = UNITS.get(found.parameters.get("mu", Fraction(0)))
    if known is not None and found.system in (*THREE_BODY, CR3BP_PLANAR):
        units = found.units or units_of(found.parameters["mu"])
        first, second = known.name.split("-")
        found = replace(found, units=units, primaries=found.primaries or (first, second))
    if found.system is CR3BP_PLANAR and found.unknowns is not None and found.legs is None:
        x, vy, half_period = found.unknowns
        return replace(found, system=CR3BP, unknowns=np.array([x, 0.0, vy, half_period]))
    return found


def _candidate(path: Path, choice: Choice) -> SourceOrbit:
    claims = {claim.id: claim for claim in read_claims(path)}
    refuse_number(choice, f"{path} holds no families; choose with --id")
    claim = claims[chosen_id(path, choice, list(claims))]
    if choice.connections and isinstance(claim, HomoclinicOrbit):
        return _connection(claim, f"claim {claim.id}", "not proved: a claim, refined numerically")
    return _claimed(claim, f"candidate {claim.id}", "not proved: a candidate, refined numerically", None)


def _certificate(path: Path, choice: Choice) -> SourceOrbit:
    entries = {entry["id"]: entry for entry in read_document(path, "certificates")["certificates"]}
    refuse_number(choice, f"{path} holds no families; choose with --id")
    entry = entries[chosen_id(path, choice, list(entries))]
    claim = claim_from_json(entry["statement"]["candidate"], f"{path}: certificate {entry['id']}")
    if choice.connections and isinstance(claim, HomoclinicOrbit):
        said = f'the certificate says "{entry["verdict"]}" of the homoclinic orbit; not checked again here'
        return _connection(claim, f"certificate {claim.id}", said)
    what = "orbit" if claim.is_of_orbit else "bifurcation"
    said = f'the certificate says "{entry["verdict"]}" of the {what} at the first state, up to the radii of its box'
    return _claimed(claim, f"certificate {claim.id}", f"{said}; not checked again here", entry["results"])


def _claimed(claim: Any, title: str, verdict: str, results: Mapping[str, Any] | None) -> SourceOrbit:
    if claim.is_of_orbit and not claim.uses_reversor:
        centre, values = np.array([*map(float, claim.centre)]), [*map(float, claim.values)]
        period = None if results is None else _middle(results["period"])
        if period is None:
            normal = np.array([*map(float, claim.normal)])
            period = time_of_crossing(claim.system, values, centre, normal, claim.crossings, claim.direction)
        if period is None:
            raise NoOrbit(f"{title}: its orbit does not return")
        legs = Legs(centre[None, :], np.array([period]), False)
        return SourceOrbit(claim.system, claim.parameters, None, title, verdict, legs=legs)
    if not claim.uses_reversor:
        raise NoOrbit(f"{title}: a claim about {claim.kind}, which names no period; give one about an orbit")
    said = _said(claim, results or {})
    if claim.equation is not None:
        half_period = None if results is None else _middle(results["half_period"])
        if claim.equation.quantity == HALF_PERIOD:
            half_period = float(claim.equation.value)
        unknowns = np.array([*map(float, claim.centre), half_period or 0.0])
        if half_period is None:
            unknowns = _to_second_point(claim.system, claim.parameters, unknowns, claim.crossings, title)
        return SourceOrbit(claim.system, claim.parameters, unknowns, title, verdict, said=said)
    parameters = dict(claim.parameters)
    if claim.resonances_meet:
        parameters[claim.varying] = claim.centre[0]
    try:
        start = branch_point(claim)
    except NoBranch:
        # There is an orbit all the same.
        centre = np.array([*centre_of(claim), 0.0])
        unknowns = _to_second_point(claim.system, parameters, centre, claim.crossings, title)
    else:
        unknowns = np.append(start.point, start.half_period)
    return SourceOrbit(claim.system, parameters, unknowns, title, verdict, said=said)


def _connection(claim: HomoclinicOrbit, title: str, verdict: str) -> SourceOrbit:
    """A homoclinic orbit from the box of its claim to Fix(R); of the CR3BP in the plane as one in space."""
    try:
        starts, durations = half_of(claim)
        system = setting_of(claim).system
    except ConnectionFailure as failure:
        raise NoOrbit(f"{title}: {failure}") from None
    if claim.system == CR3BP_PLANAR:
        system, starts = CR3BP, np.insert(starts, [2, 4], 0.0, axis=1)
    legs, distance = Legs(starts, durations, True), float(claim.centre[1])
    return SourceOrbit(system, claim.parameters, None, title, verdict, legs=legs, distance=distance)


def _said(claim: Candidate, results: Mapping[str, Any]) -> Said:
    """What a claim and the results of its certificate say of its orbit."""
    equation, period, level = claim.equation, results.get("period"), results.get("level")
    if level is None and results.get("parameter_name") == claim.system.first_integral_name:
        level = results.get("parameter")
    period, level = (None if ball is None else _middle(ball) for ball in (period, level))
    if equation is not None and equation.quantity == HALF_PERIOD:
        period = float(2 * equation.value)
    elif equation is not None and equation.quantity == LEVEL:
        level = float(equation.value)
    parameters = [
        complex(*(_middle(each[part]) for part in ("real", "imaginary")))
        for each in results.get("stability_parameters") or ()
    ]
    return Said(period, level, stability_index(parameters) if parameters else None)


def _to_second_point(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], unknowns: Vector, crossings: int, title: str
) -> Vector:
    """The unknowns with the half period of an orbit that crosses the section so often until it is on Fix(R) again."""
    problem = ShootingProblem(system, parameters)
    values, start = problem.parameter_values(unknowns).tolist(), problem.initial_state(unknowns)
    half_period = half_period_of(system, values, start, system.section_index, crossings)
    if half_period is None:
        raise NoOrbit(f"{title}: its orbit does not come back to the section")
    return np.append(unknowns[:-1], half_period)


def _middle(ball: Mapping[str, Any]) -> float:
    return float(parse_exact(ball["mid"]))


def _family_row(path: Path, choice: Choice) -> SourceOrbit:
    refuse_id(choice, f"{path} holds families; choose with --family and --orbit")
    records = read_families(path)
    record = _family(path, choice, records)
    number = chosen_number(path, choice, len(record.orbits))
    orbit = record.orbits[number]
    title = f"orbit {number + 1} of {len(record.orbits)} of the family {_name(record)}"
    unknowns = np.append(orbit.point, orbit.half_period)
    said = Said(2 * orbit.half_period, orbit.first_integral, stability_index(orbit.stability))
    return SourceOrbit(record.system, record.parameters, unknowns, title, "not proved: traced numerically", said=said)


def _family(path: Path, choice: Choice, records: Sequence[FamilyRecord]) -> FamilyRecord:
    fits = [record for record in records if choice.family in (None, record.name, _name(record))]
    if len(fits) != 1:
        said = "missing"
        if choice.family is not None:
            said = f"{len(fits) or 'no'} families of {path} are called {choice.family!r}"
        raise InputError(f"--family: {said}; give one of {some([_name(record) for record in records])}")
    return fits[0]


def _name(record: FamilyRecord) -> str:
    return "-".join(part for part in (record.label, record.name) if part)


def _branch_orbit(path: Path, choice: Choice) -> SourceOrbit:
    """The verdict of the branch's birth is no verdict of its orbits."""
    records = {record.id: record for record in read_branches(path)}
    record = records[chosen_id(path, choice, list(records))]
    number = 1 if choice.number is None else choice.number
    try:
        orbit = numbered(record, number)
    except ValueError as error:
        raise InputError(
            f"--orbit {number}: {error}; 1 is the first from the birth, -1 that on the other side"
        ) from None
    title, verdict = f"orbit {number} of the branch {record.id}", "not proved: followed numerically"
    system, parameters = record.system, dict(record.parameters)
    if record.loses_reversor:
        if system.family_parameter is not None:
            parameters[system.family_parameter] = Fraction(orbit.level)
        legs = Legs(orbit.crossings, orbit.times, False)
        return SourceOrbit(system, parameters, None, title, verdict, legs=legs, stability=orbit.stability)
    unknowns = np.append(orbit.point, orbit.half_period)
    start = ShootingProblem(system, parameters).initial_state(unknowns)
    legs = Legs(np.vstack([start, orbit.crossings]), orbit.times, True)
    said = Said(2 * orbit.half_period, orbit.level if system.family_parameter is None else None)
    return SourceOrbit(system, parameters, unknowns, title, verdict, legs=legs, stability=orbit.stability, said=said)


def _periodic_member(path: Path, choice: Choice) -> SourceOrbit:
    refuse_id(choice, f"{path} holds one family; choose with --orbit")
    refuse_family(choice, f"{path} holds one family; choose with --orbit")
    record = read_periodic_family(path)
    number = chosen_number(path, choice, len(record.orbits))
    system = SYSTEMS.get(record.system)
    if system is None or system.state != record.state:
        raise InputError(f"{path}: has no formulas of {record.system}; give certificates of its orbits")
    member = record.orbits[number]
    parameters = dict(record.parameters) | ({} if record.over_levels else {record.name: Fraction(member.value)})
    legs = Legs(np.array([member.point]), np.array([member.period]), False)
    title = f"orbit {number + 1} of {len(record.orbits)} of a family of {record.system}"
    return SourceOrbit(system, parameters, None, title, "not proved: followed numerically", legs=legs)


def _piece(path: Path, choice: Choice) -> SourceOrbit:
    return _middle_of_piece(path, choice, read_atlas(path))


def _certified_piece(path: Path, choice: Choice) -> SourceOrbit:
    document = read_document(path, "atlas-certificate")
    return _middle_of_piece(path, choice, atlas_from_json(document["statement"]["atlas"], str(path)))


def _middle_of_piece(path: Path, choice: Choice, atlas: AnyAtlas) -> SourceOrbit:
    refuse_id(choice, f"{path} holds one curve; choose its piece with --orbit")
    refuse_family(choice, f"{path} holds one curve; choose its piece with --orbit")
    pieces = getattr(atlas, "pieces", ())
    number = chosen_number(path, choice, len(pieces), "pieces")
    piece = pieces[number]
    system = atlas.system
    if not (atlas.is_of_symmetric_orbits and piece.is_of_curve) or system.normalised or system.derived_parameters:
        raise InputError(
            f"{path}: its pieces are no tubes of symmetric orbits in the system's own coordinates; {_REMEDY}"
        )
    title = f"middle of piece {number + 1} of {len(pieces)} of {atlas.id}"
    middle = np.array([*map(float, piece.point(Fraction(0))), 0.0])
    unknowns = _to_second_point(system, atlas.parameters, middle, atlas.claim.crossings, title)
    said = "not proved: an orbit near the middle of a piece, corrected numerically"
    return SourceOrbit(system, atlas.parameters, unknowns, title, said)


def _torus_centre(path: Path, choice: Choice) -> SourceOrbit:
    for refuse in (refuse_id, refuse_family, refuse_number):
        refuse(choice, f"{path} holds the tori around one orbit; leave it out")
    document = read_document(path, "tori")
    x, z, _, _ = document["centre"]
    parameters = {name: parse_exact(text) for name, text in document["parameters"].items()}
    # In the CR3BP the level is quadratic in vy with the coefficient -1.
    at_rest = ShootingProblem(CR3BP, parameters).initial_state(np.array([x, z, 0.0, 1.0]))
    assert CR3BP.first_integral is not None
    level = float(CR3BP.first_integral(at_rest.tolist(), [float(parameters["mu"])])[0])
    vy = document["tori"][0]["side"] * np.sqrt(max(level - document["jacobi_constant"], 0.0))
    unknowns = np.array([x, z, vy, document["period"] / 2])
    verdict = "not proved: the orbit that the tori surround"
    said = Said(document["period"], document["jacobi_constant"])
    return SourceOrbit(CR3BP, parameters, unknowns, document["title"], verdict, said=said)


def _orbit_of_tube(path: Path, choice: Choice) -> SourceOrbit:
    for refuse in (refuse_id, refuse_family, refuse_number):
        refuse(choice, f"{path} holds the tube of one orbit; leave it out")
    document = read_document(path, "manifold")
    if "state" not in document:
        raise InputError(f"{path}: an earlier version wrote it, without the orbit's state; compute the tube again")
    parameters = {name: parse_exact(text) for name, text in document["parameters"].items()}
    state, period = np.array(document["state"]), document["period"]
    verdict, said = "not proved: the orbit of the tube", Said(period, document["jacobi_constant"])
    if np.max(np.abs(state[[1, 3, 5]])) < _ON_FIXED_SET:
        unknowns = np.append(state[[0, 2, 4]], period / 2)
        return SourceOrbit(CR3BP, parameters, unknowns, document["title"], verdict, said=said)
    legs = Legs(state[None], np.array([period]), False)
    return SourceOrbit(CR3BP, parameters, None, document["title"], verdict, legs=legs, said=said)


def _birth_of_halo_orbits(path: Path, choice: Choice) -> SourceOrbit:
    refuse_id(choice, f"{path} holds curves over the mass; choose with --family and --orbit")
    curves = {curve.libration: curve for curve in read_curves(path)}
    name = choice.family or (next(iter(curves)) if len(curves) == 1 else None)
    if name not in curves:
        said = "missing" if name is None else f"no {name!r} in {path}"
        raise InputError(f"--family: {said}; give one of {some(list(curves))}")
    points = curves[name].points
    number = chosen_number(path, choice, len(points), "points")
    point = points[number]
    title = f"birth of halo orbits about {name}, point {number + 1} of {len(points)}, mass {point.mu:g}"
    unknowns = np.array([point.x, 0.0, point.vy, point.half_period])
    parameters, said = {"mu": Fraction(point.mu)}, Said(2 * point.half_period, point.jacobi_constant)
    return SourceOrbit(CR3BP, parameters, unknowns, title, "not proved: a point of a mass curve", said=said)


def _certified_row(path: Path, choice: Choice) -> SourceOrbit:
    refuse_id(choice, f"{path} holds the rows of a catalogue; choose with --orbit")
    refuse_family(choice, f"{path} holds the rows of one family; choose with --orbit")
    document = read_document(path, "catalogue-certificate")
    rows = document["rows"]
    number = chosen_number(path, choice, len(rows), "rows")
    row, title = rows[number], f"row {number + 1} of {len(rows)} of {document['statement']['title']}"
    if "orbit" not in row:
        raise NoOrbit(f"{path}: {title}: its certificate shows no orbit near it; give the catalogue itself")
    point = {name: _middle(ball) for name, ball in row["orbit"]["point"].items()}
    system = next(each for each in _OF_ROWS if set(point) == set(each.centre_coordinates))
    half_period = _middle(row["orbit"]["period"]) / 2
    unknowns = np.array([*(point[each] for each in system.centre_coordinates), half_period])
    verdict = f'the certificate says "{document["verdict"]}" of the rows of the catalogue; not checked again here'
    parameters = {"mu": parse_exact(document["statement"]["mass_ratio"])}
    index = row["orbit"].get("stability_index")
    said = Said(2 * half_period, _middle(row["orbit"]["level"]), None if index is None else _middle(index))
    return SourceOrbit(system, parameters, unknowns, title, verdict, said=said)


def _catalogue_row(path: Path, choice: Choice) -> SourceOrbit:
    refuse_id(choice, f"{path} is a catalogue; choose with --orbit")
    catalogue = read_catalogue(path)
    refuse_family(choice, f"{path} is a catalogue of one family; choose with --orbit")
    number = chosen_number(path, choice, len(catalogue))
    corrected = correct_catalogue(_row(catalogue, number), accept=choice.accept)
    if corrected.reasons[0]:
        which = Contradiction if corrected.contradictions[0] else NoOrbit
        raise which(f"orbit {number + 1}: {corrected.reasons[0]}")
    names = catalogue.system.split("-")
    units = None
    if catalogue.lunit is not None and catalogue.tunit is not None:
        units = Units(catalogue.lunit, catalogue.tunit, "as in the catalogue")
    title = f"orbit {number + 1} of {len(catalogue)} of {' '.join((catalogue.system, catalogue.title)).strip()}"
    return SourceOrbit(
        corrected.problem.system,
        {"mu": catalogue.mass_ratio},
        corrected.batch.unknowns[0],
        title,
        "not proved: corrected numerically",
        (names[0], names[1]) if len(names) == 2 else None,
        units,
    )


def _row(catalogue: Catalogue, index: int) -> Catalogue:
    rows = slice(index, index + 1)
    return replace(
        catalogue,
        states=catalogue.states[rows],
        jacobi_constants=catalogue.jacobi_constants[rows],
        periods=catalogue.periods[rows],
        stability_indices=catalogue.stability_indices[rows],
    )


_READERS: Mapping[str, Callable[[Path, Choice], SourceOrbit]] = {
    "candidates": _candidate,
    "certificates": _certificate,
    "family": _family_row,
    "branches": _branch_orbit,
    "periodic-family": _periodic_member,
    "atlas": _piece,
    "atlas-certificate": _certified_piece,
    "tori": _torus_centre,
    "manifold": _orbit_of_tube,
    "mass-curve": _birth_of_halo_orbits,
    "catalogue-certificate": _certified_row,
    "": _catalogue_row,
}
