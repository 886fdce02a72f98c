"""Parameters at which two 1:k resonances of a family meet: hypotheses and results (sections 34.1 to 34.4)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd
from typing import Literal

from flint import arb

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import Candidate
from orbitproof.verify.claim import check_frames, check_symmetries, inverse
from orbitproof.verify.double_resonance.equations import ResonanceEquations, Unfolding, equations_of
from orbitproof.verify.double_resonance.following import ResonanceEnclosures
from orbitproof.verify.evidence import (
    MAX_ORDER,
    Checklist,
    NotEstablishedError,
    Outcome,
    Reason,
    all_finite,
    concluded,
    dot,
    enclose,
    excludes_zero,
    indices_up_to,
    is_positive,
    symmetric,
)
from orbitproof.verify.newton import BoxFunction, enclose_zero, is_regular
from orbitproof.verify.poincare import check_half_orbit


@dataclass(frozen=True)
class ResonanceResults:
    """What is known of a proved meeting of two resonances, in nondimensional units.

    Attributes:
        point: enclosures of the parameter and of the point of the orbit on Fix(R), by name.
        parameter_name, parameter: what varies, and its value there.
        side: the values for which the family has the two resonances near it: above or below.
        turn: j; the stability parameter is cos(2 pi j/k).
        extremum: what the stability parameter has there along the family of that value.
        period: the least period of the orbit.
        level: of the first integral.
        along: the coordinate y by which the family is described.
        slope: the derivative of the extremal value of the stability parameter in the parameter.
        curvature: the second derivative of the stability parameter by y along the family.
        opening: kappa: the parameter differs by kappa (y - y*)^2 + .. along the curve of resonances.
    """

    point: Mapping[str, arb]
    parameter_name: Title
    parameter: arb
    side: Literal["above", "below"]
    turn: int
    extremum: Literal["minimum", "maximum"]
    period: arb
    level: arb
    along: Title
    slope: arb
    curvature: arb
    opening: arb


@dataclass(frozen=True)
class ResonanceTheorem:
    """The box of a claim contains exactly one point at which two 1:k resonances meet (Theorem 34.3)."""

    claim: Candidate

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        later = ["half-orbit"] if self.claim.crossings > 1 else []
        return ("symmetries", "frames", "parameter", "return-map", *later, "family", "point", "simple", "unfolding")


def theorem_of_resonance(candidate: Candidate) -> ResonanceTheorem | Reason:
    """The theorem that a candidate claims, or why none applies."""
    system = candidate.system
    if not candidate.resonances_meet:
        return Reason("theorem", f"{candidate.kind} is about other points", "claim another kind")
    if system.normalised or system.derived_parameters or system.first_integral is None:
        message = f"{system.name} has units of its own, derived parameters or no first integral"
        return Reason("theorem", message, "claim it of another system")
    return ResonanceTheorem(candidate)


def check_resonance_exactly(checklist: Checklist, candidate: Candidate) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    theorem = theorem_of_resonance(candidate)
    if isinstance(theorem, Reason):
        raise NotEstablishedError(theorem)
    system, name = candidate.system, candidate.varying
    check_symmetries(checklist, system, None)
    check_frames(checklist, candidate)
    statement = f"all values of {name} in the box are values of this parameter"
    with checklist.hypothesis("parameter", "34.1", statement, "move the box") as evidence:
        reach = sum((abs(value) * r for value, r in zip(candidate.frame[0], candidate.radii, strict=True)), Fraction(0))
        admissible = system.parameters[name]
        ends = (candidate.centre[0] - reach, candidate.centre[0] + reach)
        evidence.require(all(map(admissible.contains, ends)), f"{name} leaves {admissible}")


def prove_resonance(
    candidate: Candidate, checklist: Checklist, enclosures: ResonanceEnclosures | None
) -> Outcome[ResonanceResults]:
    """Check that two resonances meet at exactly one point of the box, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> ResonanceResults:
        found = _check_return_map(checklist, candidate, enclosures)
        check_half_orbit(checklist, found.iterates[:-1])
        turn, equations = _equations(candidate, found)
        sides = [symmetric(radius) for radius in candidate.radii]
        _check_family(checklist, candidate, equations, sides)
        where = _check_point(checklist, candidate, equations)
        unfolding = _check_simple(checklist, equations, where)
        _check_unfolding(checklist, unfolding)
        return _results(candidate, found, equations, where, turn, unfolding)

    return concluded(theorem_of_resonance(candidate), checklist, check)


def _power(candidate: Candidate, times: int = 1) -> str:
    power = times * candidate.crossings
    return "P" if power == 1 else f"P^{power}"


def _check_return_map(
    checklist: Checklist, candidate: Candidate, found: ResonanceEnclosures | None
) -> ResonanceEnclosures:
    """All derivatives are there, finite, and do not contradict each other."""
    statement = f"{_power(candidate)} and {_power(candidate, 2)} are defined on the box, with derivatives to order 3"
    with checklist.hypothesis("return-map", "34.2", statement, "smaller radii or another centre") as evidence:
        evidence.require(found is not None, "nothing was enclosed")
        if found is not None:
            size, n = len(candidate.radii), len(candidate.kernel_frame)
            shape = [len(components) for components in found.iterates]
            evidence.require(shape == [n] * candidate.crossings and len(found.image) == n + 1, "a function is missing")
            indices = set(indices_up_to(size, MAX_ORDER))
            parts = [part for table in found.tables for part in (table.box, table.centre)]
            complete = all(indices == set(part) for part in parts)
            evidence.require(complete, "a derivative is missing")
            balls = [ball for part in parts for ball in part.values()]
            evidence.require(all_finite(balls), "an enclosure is not finite", needs_precision=True)
            if complete:
                meet = all(part.box[i].overlaps(part.centre[i]) is True for part in found.tables for i in indices)
                evidence.require(meet, "an enclosure at the centre is disjoint from that over the box")
                time = evidence.record("half period", found.half_period.box[(0,) * size])
                evidence.require(is_positive(time), "it is not positive", needs_precision=True)
    assert found is not None
    return found


def _equations(candidate: Candidate, found: ResonanceEnclosures) -> tuple[int, ResonanceEquations]:
    """j, chosen by the numbers at the centre, and the equations; nothing rests on the choice."""
    rows = inverse(candidate.frame) or ()
    directions = tuple(zip(*rows, strict=True))
    k, zero = candidate.k, [arb(0)] * len(candidate.radii)
    turns = [j for j in range(1, k // 2 + 1) if gcd(j, k) == 1]
    known = [(j, equations_of(found, directions, _cosine(j, k))) for j in turns]
    return min(known, key=lambda entry: float(abs(entry[1].values(zero)[-2].mid())))


def _cosine(j: int, k: int) -> arb:
    return arb(0) if k == 4 else (2 * arb.pi() * j / k).cos()


def _check_family(
    checklist: Checklist, candidate: Candidate, equations: ResonanceEquations, sides: Sequence[arb]
) -> None:
    """For each value of the parameter and of y at most one point of the box is on a symmetric orbit."""
    names = candidate.system.centre_coordinates
    power, along = _power(candidate), names[equations.along]
    statement = f"the derivative of pi_q {power} in the coordinates of Fix(R) but {along} is regular on the box"
    with checklist.hypothesis("family", "34.3", statement, "smaller radii or another centre") as evidence:
        matrix = equations.across_slopes(sides)
        for row, entries in enumerate(matrix, start=1):
            for place, ball in zip(equations.across, entries, strict=True):
                evidence.record(f"d q_{row} / d {names[place]}", ball)
        evidence.require(is_regular(matrix), "it may be singular in the box", needs_precision=True)


def _check_point(checklist: Checklist, candidate: Candidate, equations: ResonanceEquations) -> list[arb]:
    """One zero of (pi_q P^m, f, g) in the box."""
    statement = f"interval Newton: pi_q {_power(candidate)} = 0, f = 0 and g = 0 have one solution inside the box"
    remedy = "move the centre to the point, or choose smaller radii"
    with checklist.hypothesis("point", "34.3", statement, remedy) as evidence:
        residual = equations.values([arb(0)] * len(candidate.radii))
        names = [f"p_{place}" for place in range(len(candidate.radii))]
        where = enclose_zero(evidence, equations.matrix, residual, candidate.radii, names)
    return where


def _check_simple(checklist: Checklist, equations: ResonanceEquations, where: Sequence[arb]) -> Unfolding:
    """c is a simple eigenvalue of S."""
    statement = "c is a simple zero of the characteristic polynomial of S at the point"
    with checklist.hypothesis("simple", "34.3", statement, "more precision, or nothing where two meet") as evidence:
        found = equations.unfolding(where)
        evidence.record("its derivative at c", found.simplicity)
        evidence.require(excludes_zero(found.simplicity), "it may vanish", needs_precision=True)
    return found


def _check_unfolding(checklist: Checklist, found: Unfolding) -> None:
    """The extremum is one of order 2, and its value changes with the parameter."""
    statement = "the extremal value changes with the parameter, and the second derivative along the family is not 0"
    with checklist.hypothesis("unfolding", "34.4", statement, "more precision") as evidence:
        for name, ball in (("slope", found.slope), ("curvature", found.curvature), ("kappa", found.opening)):
            evidence.record(name, ball)
            evidence.require(excludes_zero(ball), f"{name} may be 0", needs_precision=True)


def _results(
    candidate: Candidate,
    found: ResonanceEnclosures,
    equations: ResonanceEquations,
    where: Sequence[arb],
    turn: int,
    unfolding: Unfolding,
) -> ResonanceResults:
    point = {
        name: enclose(origin) + dot([enclose(value) for value in row], where)
        for name, origin, row in zip(candidate.coordinates, candidate.centre, candidate.frame, strict=True)
    }
    return ResonanceResults(
        point,
        candidate.varying,
        point[candidate.varying],
        "above" if is_positive(unfolding.opening) else "below",
        turn,
        "minimum" if is_positive(unfolding.curvature) else "maximum",
        2 * BoxFunction(found.half_period).value(where),
        BoxFunction(found.first_integral).value(where),
        candidate.system.centre_coordinates[equations.along],
        unfolding.slope,
        unfolding.curvature,
        unfolding.opening,
    )
