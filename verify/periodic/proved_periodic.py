"""One periodic orbit in a box: interval Newton for the return map, and what follows (sections 24.3 to 24.6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from flint import arb

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import PeriodicOrbit
from orbitproof.verify.claim import keeps_volume
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    all_finite,
    concluded,
    dot,
    enclose,
    excludes_zero,
    hull,
    is_inside,
    is_outside,
    is_positive,
    meet,
    show,
    symmetric,
)
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.periodic.box import (
    check_coordinates,
    check_functions_of,
    check_integral,
    check_transversal,
    gradient_on,
    state_on_box,
    values_on,
)
from orbitproof.verify.periodic.enclosures import PeriodicEnclosures, SectionReturn, stops_of
from orbitproof.verify.periodic.multipliers import Multipliers, multipliers_of, on_level

_ROUGH = 2.0**-6
"""A derivative that is known better than this and may be singular is near one that is."""


@dataclass(frozen=True)
class PeriodicResults:
    """What is known of a proved orbit, in the units of its system.

    Attributes:
        point: enclosures of the state at its point in the box, by name.
        period: its least period.
        multipliers: its multipliers, and where they lie.
        level_name, level: the first integral; empty and `None` where the claim uses none.
    """

    point: Mapping[str, arb]
    period: arb
    multipliers: Multipliers
    level_name: Title = ""
    level: arb | None = None

    stored_rules: ClassVar = {"dependentRequired": {"level": ["level_name"]}}


@dataclass(frozen=True)
class PeriodicTheorem:
    """The box of a claim contains exactly one point of a periodic orbit as claimed (Theorem 24.4)."""

    claim: PeriodicOrbit

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        on_level = self.claim.level is not None
        return (
            *(["functions"] if self.claim.system.defined else []),
            "section", *(["first-integral"] if on_level else []), "direction", "return-map", "periodic",
            *(["last-coordinate"] if on_level else []), "least-period",
        )  # fmt: skip


def check_periodic_exactly(checklist: Checklist, claim: PeriodicOrbit) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_functions_of(checklist, claim.system)
    check_coordinates(checklist, claim)
    if claim.level is not None:
        check_integral(checklist, claim)
    check_transversal(checklist, claim)


def prove_periodic(
    claim: PeriodicOrbit, checklist: Checklist, enclosures: PeriodicEnclosures | None
) -> Outcome[PeriodicResults]:
    """Check that the box contains exactly one orbit as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> PeriodicResults:
        found = _checked(checklist, claim, enclosures)
        where = _check_newton(checklist, claim, found.returns[-1])
        slopes = None if claim.level is None else _check_last(checklist, claim, found.returns[-1])
        _check_least(checklist, claim, found.returns[:-1], where)
        return _results(claim, found.returns[-1], where, slopes)

    return concluded(PeriodicTheorem(claim), checklist, check)


def _checked(checklist: Checklist, claim: PeriodicOrbit, found: PeriodicEnclosures | None) -> PeriodicEnclosures:
    """Every enclosure that is used is there and finite, and times are positive."""
    size, stops = len(claim.radii), stops_of(claim.crossings)
    count = "1 crossing" if claim.crossings == 1 else f"{claim.crossings} crossings"
    statement = f"the return map of {count} in the direction exists on the box, with finite enclosures"
    with checklist.hypothesis("return-map", "24.2", statement, "smaller radii or more precision") as evidence:
        evidence.require(found is not None, "there are no enclosures")
        if found is not None:
            numbers = tuple(each.crossings for each in found.returns)
            evidence.require(numbers == stops, "a return is missing, or is one of another number of crossings")
            functions = [function for each in found.returns for function in (*each.image, each.time)]
            complete = all(len(each.image) == size for each in found.returns) and all(
                len(function.slopes) == size for function in functions
            )
            evidence.require(complete, "a coordinate or a derivative is missing")
            finite = all_finite(ball for function in functions for ball in function.balls)
            evidence.require(finite, "an enclosure is not finite", needs_precision=True)
            if complete and finite:
                sides = [symmetric(radius) for radius in claim.radii]
                for each in found.returns:
                    time = evidence.record(f"time of crossing {each.crossings}", each.time.value(sides))
                    evidence.require(is_positive(time), "a time is not positive", needs_precision=True)
    assert found is not None
    return found


def _left_out(claim: PeriodicOrbit) -> int | None:
    """The coordinate p_j whose equation the level replaces: one in which H changes fast; `None` without a level."""
    if claim.level is None:
        return None
    slopes = _level_slopes(claim, [arb(0)] * len(claim.radii))
    return max(range(len(slopes)), key=lambda j: float(abs(slopes[j].mid())))


def _level_slopes(claim: PeriodicOrbit, sides: Sequence[arb]) -> list[arb]:
    """dH/dp at the points of the section with p in `sides`."""
    program = claim.system.first_integral_program
    assert program is not None
    return gradient_on(program, claim, state_on_box(claim, sides))


def _check_newton(checklist: Checklist, claim: PeriodicOrbit, found: SectionReturn) -> list[arb]:
    """One zero of F(p) - p in the box, one of its equations replaced by H = level if there is one; enclosures of it."""
    size, dropped = len(claim.radii), _left_out(claim)
    equations = "F(p) = p" if dropped is None else f"F(p) = p but for p_{dropped}, and H = level,"
    verb = "has" if dropped is None else "have"
    statement = f"interval Newton: {equations} {verb} exactly one solution inside the box"
    remedy = "move the centre to the orbit, or choose smaller radii"
    with checklist.hypothesis("periodic", "24.3", statement, remedy) as evidence:
        sides = [symmetric(radius) for radius in claim.radii]
        matrix = [[slope - int(i == j) for j, slope in enumerate(f.slopes)] for i, f in enumerate(found.image)]
        residual = [function.centre for function in found.image]
        if dropped is not None and claim.level is not None:
            program = claim.system.first_integral_program
            assert program is not None
            (value,) = values_on(program, claim, [enclose(origin) for origin in claim.centre])
            matrix[dropped], residual[dropped] = _level_slopes(claim, sides), value - enclose(claim.level)
        for row, entries in enumerate(matrix, start=1):
            for position, ball in enumerate(entries):
                evidence.record(f"d G_{row} / d p_{position}", ball)
        widest = max((ball.rad() for entries in matrix for ball in entries), default=arb(0))
        vague = f"the derivative over the box is known too roughly, up to {show(widest)}: smaller radii or more bits"
        message = "the derivative may be singular in the box" if widest < _ROUGH else vague
        evidence.require(is_regular(matrix), message, needs_precision=True)
        image = newton_image(matrix, residual)
        for position, (ball, radius) in enumerate(zip(image, claim.radii, strict=True)):
            evidence.record(f"p_{position}", ball)
            outside = is_outside(ball, radius)
            message = f"p_{position} in {show(ball)} is not inside its interval"
            evidence.require(is_inside(ball, radius), message, needs_precision=not outside, excluded=outside)
        evidence.require(len(image) == size, "an equation is missing")
    return [meet(side, ball) for side, ball in zip(sides, image, strict=True)]


def _check_last(checklist: Checklist, claim: PeriodicOrbit, found: SectionReturn) -> list[arb]:
    """dH/dp_j is not 0 between a point of the box and its image that differs from it in p_j alone; dH on the box."""
    dropped = _left_out(claim)
    assert dropped is not None
    statement = f"dH/dp_{dropped} has no zero where p_{dropped} lies between a point of the box and its image"
    with checklist.hypothesis("last-coordinate", "24.3", statement, "smaller radii or another frame") as evidence:
        sides = [symmetric(radius) for radius in claim.radii]
        between = list(sides)
        between[dropped] = hull(sides[dropped], found.image[dropped].value(sides))
        slope = evidence.record(f"dH/dp_{dropped}", _level_slopes(claim, between)[dropped])
        evidence.require(excludes_zero(slope), "it may vanish", needs_precision=True)
    return _level_slopes(claim, sides)


def _check_least(
    checklist: Checklist, claim: PeriodicOrbit, earlier: Sequence[SectionReturn], where: Sequence[arb]
) -> None:
    """The orbit does not return to its point at an earlier crossing, so it is run through once."""
    m = claim.crossings
    numbers = ", ".join(str(each.crossings) for each in earlier)
    statement = (
        "the orbit crosses the section once in the direction within a period: there is no shorter one"
        if m == 1
        else f"after {numbers} of the {m} crossings the orbit is at another point: the period is the least one"
    )
    remedy = "claim fewer crossings, if the orbit is another one run through several times"
    with checklist.hypothesis("least-period", "24.4", statement, remedy) as evidence:
        evidence.require(tuple(each.crossings for each in earlier) == stops_of(m)[:-1], "a return is missing")
        for each in earlier:
            distances = [function.value(where) - p for function, p in zip(each.image, where, strict=True)]
            for position, ball in enumerate(distances):
                evidence.record(f"p_{position}, crossing {each.crossings}", ball)
            apart = any(map(excludes_zero, distances))
            evidence.require(apart, f"it may be back after {each.crossings} of {m} crossings", needs_precision=True)


def _results(
    claim: PeriodicOrbit, found: SectionReturn, where: Sequence[arb], level_slopes: Sequence[arb] | None
) -> PeriodicResults:
    system = claim.system
    derivative = [list(function.slopes) for function in found.image]
    if level_slopes is not None:
        dropped = _left_out(claim)
        assert dropped is not None
        derivative = on_level(derivative, level_slopes, dropped)
    trivial = 1 if level_slopes is None else 2
    return PeriodicResults(
        dict(zip(system.given_state, _point(claim, where), strict=True)),
        found.time.value(where),
        multipliers_of(derivative, trivial, keeps_volume(system)),
        "" if claim.level is None else system.first_integral_name or "H",
        None if claim.level is None else enclose(claim.level),
    )


def _point(claim: PeriodicOrbit, where: Sequence[arb]) -> list[arb]:
    return [
        enclose(origin) + dot([enclose(value) for value in row], where) if any(row) else enclose(Fraction(origin))
        for origin, row in zip(claim.centre, claim.frame, strict=True)
    ]
