"""What the returns of a claim have to be: complete, of its level, and the first ones (sections 25.2, 25.3 and 25.6)."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.evidence import (
    MAX_ORDER,
    Checklist,
    all_finite,
    excludes_zero,
    hull,
    indices_up_to,
    is_positive,
)
from orbitproof.verify.newton import BoxFunction
from orbitproof.verify.periodic import SectionReturn, gradient_on, state_on_box, stops_of
from orbitproof.verify.periodic_bifurcation.enclosures import BifurcationEnclosures, is_complete, variables_of
from orbitproof.verify.periodic_bifurcation.equations import PointEquations, sides_of


def check_returns(
    checklist: Checklist, claim: PeriodicBifurcation, found: BifurcationEnclosures | None
) -> BifurcationEnclosures:
    """Every enclosure that is used is there and finite, and times are positive."""
    size, stops = len(claim.radii), stops_of(claim.crossings)
    variables = variables_of(claim)
    count = "1 crossing" if claim.crossings == 1 else f"{claim.crossings} crossings"
    statement = f"the return map of {count} in the direction exists on the box, with finite enclosures to order 3"
    with checklist.hypothesis("return-map", "25.2", statement, "smaller radii or more precision") as evidence:
        evidence.require(found is not None, "there are no enclosures")
        if found is not None:
            numbers = tuple(each.crossings for each in found.earlier)
            evidence.require(numbers == stops[:-1], "a return is missing, or is one of another number of crossings")
            evidence.require((found.integral is not None) == (claim.level is not None), "the first integral is missing")
            indices = indices_up_to(variables, MAX_ORDER)
            functions = [function for each in found.earlier for function in (*each.image, each.time)]
            complete = (
                len(found.image) == size
                and all(is_complete(table, indices) for table in found.tables)
                and all(len(each.image) == size for each in found.earlier)
                and all(len(function.slopes) == variables for function in functions)
                and all(all_finite(function.balls) for function in functions)
            )
            evidence.require(complete, "a coordinate or a derivative is missing or not finite", needs_precision=True)
            if complete:
                time = evidence.record(f"time of crossing {claim.crossings}", found.time.box[(0,) * variables])
                evidence.require(is_positive(time), "a time is not positive", needs_precision=True)
    assert found is not None
    return found


def check_last(checklist: Checklist, claim: PeriodicBifurcation, equations: PointEquations) -> None:
    """dH/dp_j is not 0 between a point of the box and its image that differs from it in p_j alone (Lemma 24.1)."""
    dropped = equations.replaced
    assert dropped is not None
    statement = f"dH/dp_{dropped} has no zero where p_{dropped} lies between a point of the box and its image"
    with checklist.hypothesis("last-coordinate", "25.3", statement, "smaller radii or another frame") as evidence:
        program = claim.system.first_integral_program
        assert program is not None
        sides = sides_of(claim)
        between = sides[:-1]
        between[dropped] = hull(sides[dropped], equations.returns[dropped].value(sides))
        slopes = gradient_on(program, claim, state_on_box(claim, between))
        slope = evidence.record(f"dH/dp_{dropped}", slopes[dropped])
        evidence.require(excludes_zero(slope), "it may vanish", needs_precision=True)


def check_least(
    checklist: Checklist, claim: PeriodicBifurcation, earlier: Sequence[SectionReturn], where: Sequence[arb]
) -> None:
    """The point is not back at an earlier crossing, so the orbit is run through once.

    Args:
        where: enclosures of p and s.
    """
    m, arguments = claim.crossings, where if claim.parameter is not None else where[:-1]
    numbers = ", ".join(str(each.crossings) for each in earlier)
    under = "" if claim.symmetry is None else " under S"
    statement = (
        "the orbit returns at its first crossing: there is no earlier one"
        if m == 1
        else f"after {numbers} of the {m} crossings the image of the point{under} is another point"
    )
    remedy = "claim fewer crossings, if the orbit is another one run through several times"
    with checklist.hypothesis("least-period", "25.6", statement, remedy) as evidence:
        evidence.require(tuple(each.crossings for each in earlier) == stops_of(m)[:-1], "a return is missing")
        for each in earlier:
            distances = [function.value(arguments) - p for function, p in zip(each.image, where, strict=False)]
            for position, ball in enumerate(distances):
                evidence.record(f"p_{position}, crossing {each.crossings}", ball)
            apart = any(map(excludes_zero, distances))
            evidence.require(apart, f"it may be back after {each.crossings} of {m} crossings", needs_precision=True)


def time_at(claim: PeriodicBifurcation, found: BifurcationEnclosures, where: Sequence[arb]) -> arb:
    """The time of crossing m at the points with p and s in `where`."""
    return BoxFunction(found.time).value(where if claim.parameter is not None else where[:-1])
