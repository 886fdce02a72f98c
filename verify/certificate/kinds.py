"""The two kinds of claims about a box, a bifurcation and one orbit: how each is enclosed, proved and confirmed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import partial
from typing import Any

from flint import arb

from orbitproof.shared.formats import ORBIT, Candidate
from orbitproof.verify import bifurcation
from orbitproof.verify.bifurcation import BifurcationResults, BifurcationTheorem
from orbitproof.verify.certificate.levels import Finding, confirmed, overlap
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.certificate.tables import derivative_name
from orbitproof.verify.evidence import Checklist, DerivativeTable, Outcome, Proved, Reason, ball_from_json
from orbitproof.verify.oracle import ORACLE, counsel
from orbitproof.verify.orbit import OrbitEnclosures, OrbitResults, OrbitTheorem, enclose_orbit, prove_orbit
from orbitproof.verify.poincare import Enclosures, IntegratorSettings, enclose_iterates

Found = Enclosures | OrbitEnclosures
Results = BifurcationResults | OrbitResults


def theorem_of(candidate: Candidate, form: Candidate | None = None) -> BifurcationTheorem | OrbitTheorem | Reason:
    """The theorem that a candidate claims, or why none applies; `form` is its level form, if that is checked."""
    return OrbitTheorem(candidate) if candidate.kind == ORBIT else bifurcation.theorem_of(candidate, form)


def enclose(
    candidate: Candidate, settings: IntegratorSettings, progress: Callable[[float], None] | None = None
) -> Found:
    """What its proof is evaluated from. Raises `IntegrationFailure` if something could not be enclosed, or another
    `NotEstablishedError` if the claim is seen to be false on the way.
    """
    if candidate.kind == ORBIT:
        return enclose_orbit(candidate, settings, ORACLE, progress)
    decide = partial(bifurcation.check_half_returns, counsel=counsel)
    return enclose_iterates(candidate, settings, ORACLE, progress, decide)


def prove(candidate: Candidate, checklist: Checklist, found: Found | None) -> Outcome[Results]:
    """Check the claim, given what was enclosed, if anything; as `bifurcation.prove` and `orbit.prove_orbit`."""
    if candidate.kind == ORBIT:
        return prove_orbit(candidate, checklist, found if isinstance(found, OrbitEnclosures) else None)
    if not isinstance(found, Enclosures):
        return bifurcation.prove(candidate, checklist, (), None)
    tables = (found.iterates, found.first_integral, found.return_times)
    return bifurcation.prove(candidate, checklist, *tables, counsel)


def contradictions(stored: Found, fresh: Found, place: str) -> Iterator[Finding]:
    """Where two enclosures of the same numbers have no common point, or are not of the same numbers."""
    for name, old, new in _pairs(stored, fresh, place):
        yield from overlap(old, new, name)


def too_narrow(stored: Found, fresh: Found, place: str) -> Iterator[Finding]:
    """Where new enclosures of the same numbers reach out of the stored ones by more than these are wide."""
    for name, old, new in _pairs(stored, fresh, place):
        yield from confirmed(old, new, name, _REACH)


_REACH = Fraction(1)
"""By how much of its width an entry of a table may be exceeded: those that are zero by symmetry are known up to the
underflow of bounds only, whatever the precision."""


def _pairs(stored: Found, fresh: Found, place: str) -> Iterator[tuple[str, arb, arb]]:
    """Two enclosures of each number. Raises `ValueError` if they are not of the same numbers."""
    if isinstance(stored, OrbitEnclosures) and isinstance(fresh, OrbitEnclosures):
        old, new = _orbit_numbers(stored), _orbit_numbers(fresh)
    elif isinstance(stored, Enclosures) and isinstance(fresh, Enclosures):
        old, new = _numbers(stored), _numbers(fresh)
    else:
        old, new = {}, {"the claim": arb(0)}
    if old.keys() != new.keys():
        raise ValueError(f"{place}: the tables do not belong to each other")
    for name, ball in old.items():
        yield f"{place}, {name}", ball, new[name]


def _numbers(found: Enclosures) -> dict[str, arb]:
    tables = {
        f"q_{j}(P^{i})": table
        for i, components in enumerate(found.iterates, start=1)
        for j, table in enumerate(components, start=1)
    }
    if found.first_integral is not None:
        tables["the first integral"] = found.first_integral
    times = {f"time of crossing {number}": time for number, time in enumerate(found.return_times, start=1)}
    return {**_of_tables(tables), **times}


def _orbit_numbers(found: OrbitEnclosures) -> dict[str, arb]:
    tables = {
        f"q_{j}(P^{i})": table
        for i, components in enumerate(found.iterates, start=1)
        for j, table in enumerate(components, start=1)
    }
    tables |= {f"coordinate {j} of the image": table for j, table in enumerate(found.image, start=1)}
    tables["the half period"] = found.half_period
    if found.first_integral is not None:
        tables["the first integral"] = found.first_integral
    numbers = {f"back, {i}, {j}": ball for i, row in enumerate(found.back) for j, ball in enumerate(row)}
    if found.distance is not None:
        tables |= {"squared distance at x": found.distance.start, "squared distance at P(x)": found.distance.end}
        kinds = (found.distance.start_kind, *(each.kind for each in found.distance.between), found.distance.end_kind)
        numbers["kinds of the extrema " + ", ".join(map(str, kinds))] = arb(0)
        for number, approach in enumerate(found.distance.between, start=1):
            numbers |= {f"time of extremum {number}": approach.time, f"extremum {number}": approach.value}
    return {**_of_tables(tables), **numbers}


def _of_tables(tables: Mapping[str, DerivativeTable]) -> dict[str, arb]:
    return {
        f"{derivative_name(index)} of {name}, {part}": ball
        for name, table in tables.items()
        for part, source in (("box", table.box), ("centre", table.centre))
        for index, ball in source.items()
    }


def unconfirmed(stored: Mapping[str, Any], found: Proved[Results], place: str) -> Iterator[Finding]:
    """What a certificate says of the hypotheses and results, and what a new proof does not confirm."""
    old_entries = {entry["name"]: entry["enclosures"] for entry in stored["hypotheses"]}
    for hypothesis in found.hypotheses:
        for name, old in old_entries[hypothesis.name].items():
            where = f"{place}, hypothesis {hypothesis.name}, {name}"
            if name not in hypothesis.enclosures:
                yield Finding(where, "is not enclosed again")
            else:
                yield from confirmed(ball_from_json(old), hypothesis.enclosures[name], where)
    if isinstance(found.results, OrbitResults):
        yield from _unconfirmed_orbit(stored["results"], found.results, place)
    else:
        yield from _unconfirmed_bifurcation(stored["results"], found.results, place)


def _unconfirmed_bifurcation(stored: Mapping[str, Any], found: BifurcationResults, place: str) -> Iterator[Finding]:
    if stored["side"] != found.side:
        yield Finding(f"{place}, side", f"stored is {stored['side']!r}, found {found.side!r}")
    yield from confirmed(ball_from_json(stored["parameter"]), found.parameter, f"{place}, {found.parameter_name}")
    for group, balls in (("point", found.point), ("normal_form", found.normal_form)):
        if set(stored[group]) != set(balls):
            yield Finding(f"{place}, {group}", "has other numbers than are found")
            continue
        for name, ball in balls.items():
            yield from confirmed(ball_from_json(stored[group][name]), ball, f"{place}, {name}")


def _unconfirmed_orbit(stored: Mapping[str, Any], found: OrbitResults, place: str) -> Iterator[Finding]:
    old, new = dict(_leaves(stored, "")), dict(_leaves(to_json(found), ""))
    if old.keys() != new.keys():
        yield Finding(place, "other results are found: " + ", ".join(sorted(old.keys() ^ new.keys())))
        return
    for name, value in old.items():
        if isinstance(value, arb) and isinstance(new[name], arb):
            yield from confirmed(value, new[name], f"{place}, {name}")
        elif value != new[name]:
            yield Finding(f"{place}, {name}", f"stored is {value!r}, found {new[name]!r}")


def _leaves(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """The balls and words of a JSON value, by where they stand."""
    if isinstance(value, Mapping) and {"mid", "rad"} <= set(value):
        yield name, ball_from_json(dict(value))
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(inner, f"{name} {key}".strip())
    elif isinstance(value, list):
        for number, inner in enumerate(value, start=1):
            yield from _leaves(inner, f"{name} {number}")
    else:
        yield name, value
