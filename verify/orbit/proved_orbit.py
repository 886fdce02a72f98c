"""One symmetric orbit in a box: interval Newton, and what follows from its enclosures (sections 19.2 to 19.5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, ClassVar

from flint import arb

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, LEVEL, Candidate
from orbitproof.shared.stored import rules, stored
from orbitproof.verify.claim import inverse
from orbitproof.verify.evidence import (
    MAX_ORDER,
    Checklist,
    DerivativeTable,
    MultiIndex,
    Outcome,
    all_finite,
    bounds,
    concluded,
    dot,
    enclose,
    excludes_zero,
    hull,
    indices_up_to,
    is_below,
    is_inside,
    is_outside,
    is_positive,
    show,
    symmetric,
)
from orbitproof.verify.newton import BoxFunction, ImplicitGraph
from orbitproof.verify.orbit.following import Distance, OrbitEnclosures
from orbitproof.verify.orbit.multipliers import Stability, stability_of
from orbitproof.verify.poincare import check_half_orbit


@dataclass(frozen=True)
class Extremum:
    """The least or greatest distance along an orbit.

    Attributes:
        distance: its enclosure.
        times: enclosures of the times in [0, T], T the half period, at one of which it is taken; 0 is that of the
            first point on Fix(R).
    """

    distance: arb
    times: Annotated[tuple[arb, ...], rules(minItems=1, maxItems=1000)]


@dataclass(frozen=True)
class OrbitResults:
    """What is known of a proved orbit; all in nondimensional units.

    Attributes:
        point, other_point: enclosures of its two points on Fix(R), by coordinate name.
        half_period: the time from one to the other.
        period: twice that; the least period.
        stability: stability parameters and multipliers.
        level_name, level: the first integral; empty and `None` without one.
        distance_name: from what body distances are; empty if none is named.
        least, greatest: distance from it along the orbit; `None` if none is named.
    """

    point: Mapping[str, arb]
    other_point: Mapping[str, arb]
    half_period: arb
    period: arb
    stability: Stability = stored(flat=True)
    level_name: Title = ""
    level: arb | None = None
    distance_name: Title = stored("distance_from", default="")
    least: Extremum | None = stored("least_distance", default=None)
    greatest: Extremum | None = stored("greatest_distance", default=None)

    stored_rules: ClassVar = {"dependentRequired": {
        "level": ["level_name"], "distance_from": ["least_distance", "greatest_distance"],
        "least_distance": ["distance_from"], "greatest_distance": ["distance_from"],
    }}  # fmt: skip


@dataclass(frozen=True)
class OrbitTheorem:
    """The box of a claim contains exactly one point whose orbit is symmetric and solves the equation (Theorem 19.3)."""

    claim: Candidate

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        system = self.claim.system
        on_level = system.fixed_level is not None
        names = ["symmetries", "frames", *(["level"] if on_level else []), "poincare-map"]
        names += [*(["half-orbit"] if self.claim.crossings > 1 else []), "orbit"]
        names += ["level"] if system.first_integral is not None and not on_level else []
        names += ["distance"] if system.squared_distance is not None else []
        return tuple(names)


def prove_orbit(
    candidate: Candidate, checklist: Checklist, enclosures: OrbitEnclosures | None
) -> Outcome[OrbitResults]:
    """Check that the box contains exactly one orbit as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """
    return concluded(OrbitTheorem(candidate), checklist, lambda: check_orbit(checklist, candidate, enclosures))


def check_orbit(checklist: Checklist, candidate: Candidate, enclosures: OrbitEnclosures | None) -> OrbitResults:
    """The hypotheses of Theorem 19.3 and its results. Raises `NotEstablishedError` for the first that fails."""
    found = _checked(checklist, candidate, enclosures)
    check_half_orbit(checklist, found.iterates[:-1])
    graph = _check_newton(checklist, candidate, found)
    return _results(checklist, candidate, found, graph)


def _checked(checklist: Checklist, candidate: Candidate, found: OrbitEnclosures | None) -> OrbitEnclosures:
    """Every enclosure that is used is there and finite, and the half period is positive."""
    size, m = len(candidate.radii), candidate.crossings
    power = "P" if m == 1 else f"P, .., P^{m}"
    verb = "exists" if m == 1 else "exist"
    statement = f"{power} {verb} on the box, and at its image on Fix(R), with finite enclosures of its derivatives"
    with checklist.hypothesis("poincare-map", "19.2", statement, "smaller radii or more precision") as evidence:
        evidence.require(found is not None, "there are no enclosures")
        if found is not None:
            system = candidate.system
            shape = *(len(components) for components in found.iterates), len(found.image)
            evidence.require(shape == (*[size - 1] * m, size), "an iterate or a component is missing")
            evidence.require(
                (found.first_integral is None) == (system.first_integral is None)
                and (found.distance is None) == (system.squared_distance is None),
                "the first integral or the distance is missing, or there is one too many",
            )
            evidence.require(
                len(found.back) == size and all(len(row) == size for row in found.back), "a derivative is missing"
            )
            indices = indices_up_to(size, MAX_ORDER)
            parts = [part for table in _tables(found) for part in (table.box, table.centre)]
            complete = all(set(indices) <= set(part) for part in parts)
            evidence.require(complete, "a derivative is missing")
            balls = [ball for row in found.back for ball in row]
            if complete:
                balls += [part[index] for part in parts for index in indices]
                time = evidence.record(f"time of crossing {m}", found.half_period.box[(0,) * size])
                evidence.require(is_positive(time), "the half period is not positive", needs_precision=True)
            evidence.require(all_finite(balls), "an enclosure is not finite", needs_precision=True)
    assert found is not None
    return found


def _tables(found: OrbitEnclosures) -> list[DerivativeTable]:
    tables = [table for components in found.iterates for table in components]
    tables += [*found.image, found.half_period]
    tables += [] if found.first_integral is None else [found.first_integral]
    return tables + ([] if found.distance is None else [found.distance.start, found.distance.end])


def _check_newton(checklist: Checklist, candidate: Candidate, found: OrbitEnclosures) -> ImplicitGraph:
    """One zero of (pi_q P^m, quantity - value) in the box."""
    power = "P" if candidate.crossings == 1 else f"P^{candidate.crossings}"
    statement = f"interval Newton: (pi_q {power}, the equation) = 0 has one solution inside the box"
    remedy = "move the centre to the orbit, or choose smaller radii"
    with checklist.hypothesis("orbit", "19.2", statement, remedy) as evidence:
        functions = (*(BoxFunction(table) for table in found.iterates[-1]), BoxFunction(_equation(candidate, found)))
        box = tuple(symmetric(radius) for radius in candidate.radii)
        graph = ImplicitGraph(functions, box, 0)
        for row, entries in enumerate(graph.derivative_matrix(box), start=1):
            for position, ball in enumerate(entries):
                evidence.record(f"d F_{row} / d p_{position}", ball)
        evidence.require(graph.is_regular(), "the derivative may be singular in the box", needs_precision=True)
        for position, ball in enumerate(graph.image(())):
            evidence.record(f"p_{position}", ball)
            radius = candidate.radii[position]
            outside = is_outside(ball, radius)
            message = f"p_{position} in {show(ball)} is not inside P_{position}"
            evidence.require(is_inside(ball, radius), message, needs_precision=not outside, excluded=outside)
    return graph


def _equation(candidate: Candidate, found: OrbitEnclosures) -> DerivativeTable:
    """Derivatives of quantity - value on the box."""
    equation = candidate.equation
    assert equation is not None
    if equation.quantity == HALF_PERIOD:
        return _minus(found.half_period, enclose(equation.value))
    if equation.quantity == LEVEL and found.first_integral is not None:
        return _minus(found.first_integral, enclose(equation.value))
    assert equation.coordinate is not None
    return _minus(_coordinate(candidate, candidate.coordinates.index(equation.coordinate)), enclose(equation.value))


def _minus(table: DerivativeTable, value: arb) -> DerivativeTable:
    def shifted(part: Mapping[MultiIndex, arb]) -> dict[MultiIndex, arb]:
        return {index: ball if any(index) else ball - value for index, ball in part.items()}

    return DerivativeTable(shifted(table.box), shifted(table.centre))


def _coordinate(candidate: Candidate, row: int) -> DerivativeTable:
    """Derivatives of a coordinate of the points centre + frame p, which is affine."""
    size = len(candidate.radii)
    origin = enclose(candidate.centre[row])
    slopes = [enclose(value) for value in candidate.frame[row]]
    sides = [symmetric(radius) for radius in candidate.radii]
    box, centre = {}, {}
    for index in indices_up_to(size, MAX_ORDER):
        if sum(index) == 0:
            box[index], centre[index] = origin + dot(slopes, sides), origin
        else:
            box[index] = centre[index] = slopes[index.index(1)] if sum(index) == 1 else arb(0)
    return DerivativeTable(box, centre)


def _results(checklist: Checklist, candidate: Candidate, found: OrbitEnclosures, graph: ImplicitGraph) -> OrbitResults:
    system, equation = candidate.system, candidate.equation
    assert equation is not None
    where = graph.over(())
    at = {name: BoxFunction(table) for name, table in zip(candidate.coordinates, found.image, strict=True)}
    point = {
        name: enclose(equation.value)
        if equation.quantity == COORDINATE and name == equation.coordinate
        else enclose(origin) + dot([enclose(value) for value in row], where)
        for name, origin, row in zip(candidate.coordinates, candidate.centre, candidate.frame, strict=True)
    }
    integral = None if found.first_integral is None else BoxFunction(found.first_integral)
    if integral is not None and system.fixed_level is None:
        _check_level(checklist, integral, where)
    half_period = BoxFunction(found.half_period).value(where)
    level = None if integral is None else integral.value(where)
    if equation.quantity == HALF_PERIOD:
        half_period = enclose(equation.value)
    elif equation.quantity == LEVEL:
        level = enclose(equation.value)
    if system.fixed_level is not None:
        level = enclose(system.fixed_level.value)
    least = greatest = None
    if found.distance is not None:
        least, greatest = _check_distance(checklist, found.distance, where, half_period)
    return OrbitResults(
        point,
        {name: function.value(where) for name, function in at.items()},
        half_period,
        2 * half_period,
        stability_of(_own_derivatives(candidate, list(at.values()), where), found.back),
        "" if level is None else system.first_integral_name or "H",
        level,
        "" if found.distance is None else str(system.distance_name),
        least,
        greatest,
    )


def _check_level(checklist: Checklist, integral: BoxFunction, where: Sequence[arb]) -> None:
    statement = "the derivative of the first integral on Fix(R) does not vanish at the point"
    remedy = "claim an orbit that is no equilibrium, or give a smaller box"
    with checklist.hypothesis("level", "19.3", statement, remedy) as evidence:
        slopes = integral.gradient(where, 0)
        for position, ball in enumerate(slopes):
            evidence.record(f"dH/dp_{position}", ball)
        evidence.require(any(map(excludes_zero, slopes)), "every component may vanish", needs_precision=True)


def _own_derivatives(candidate: Candidate, image: Sequence[BoxFunction], where: Sequence[arb]) -> list[list[arb]]:
    """Derivatives of the image's coordinates on Fix(R) by those on Fix(R), at the point."""
    rows = inverse(candidate.frame)
    assert rows is not None
    columns = list(zip(*rows, strict=True))
    gradients = [function.gradient(where, 0) for function in image]
    return [[dot(gradient, [enclose(value) for value in column]) for column in columns] for gradient in gradients]


def _check_distance(
    checklist: Checklist, distance: Distance, where: Sequence[arb], half_period: arb
) -> tuple[Extremum, Extremum]:
    """The least and the greatest distance over the whole orbit, among all extrema of a half of it."""
    statement = (
        "the extrema of the distance over half the orbit are those at its ends and those listed; all are positive"
    )
    with checklist.hypothesis("distance", "19.4", statement, "smaller radii or more precision") as evidence:
        extrema = [(arb(0), BoxFunction(distance.start).value(where), distance.start_kind)]
        extrema += [(approach.time, approach.value, approach.kind) for approach in distance.between]
        extrema.append((half_period, BoxFunction(distance.end).value(where), distance.end_kind))
        for number, (time, value, kind) in enumerate(extrema):
            name = "minimum" if kind > 0 else "maximum"
            evidence.record(f"time of extremum {number}, a {name}", time)
            evidence.record(f"squared distance at extremum {number}", value)
            evidence.require(kind in (1, -1), "the kind of an extremum is not known")
            evidence.require(is_positive(value), "the square of a distance may vanish", needs_precision=True)
        kinds = [kind for _, _, kind in extrema]
        evidence.require(all(left == -right for left, right in pairwise(kinds)), "minima and maxima do not alternate")
        for approach in distance.between:
            inner = is_positive(approach.time) and is_below(approach.time, half_period)
            evidence.require(inner, "the time of an extremum is not inside the half period")
    minima = [(time, value.sqrt()) for time, value, kind in extrema if kind > 0]
    maxima = [(time, -value.sqrt()) for time, value, kind in extrema if kind < 0]
    # Both ends are extrema, and minima and maxima alternate: there is one of each.
    least, greatest = _first_of(minima), _first_of(maxima)
    return least, Extremum(-greatest.distance, greatest.times)


def _first_of(extrema: Sequence[tuple[arb, arb]]) -> Extremum:
    """The least value, with the times at which it may be taken."""
    ends = [bounds(value) for _, value in extrema]
    below = min(upper for _, upper in ends)
    near = [extremum for extremum, (lower, _) in zip(extrema, ends, strict=True) if lower <= below]
    times = tuple(time for time, _ in near)
    if len(near) == 1:
        return Extremum(near[0][1], times)
    return Extremum(hull(enclose(min(lower for lower, _ in ends)), enclose(below)), times)
