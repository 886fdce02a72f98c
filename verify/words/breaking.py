"""The theorem about births of orbits that R does not map to themselves, in words (section 27.6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.claim import claim_in_words, keyed_in_words, sheet_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text, interval_text, located
from orbitproof.verify.reversor_breaking import BreakingResults, BreakingTheorem
from orbitproof.verify.words.formulas import free_letter

_DIGITS = 40


def breaking_in_words(theorem: BreakingTheorem) -> str:
    """The theorem, in short."""
    candidate = claim_in_words(theorem.claim)
    system, m = candidate.system, candidate.crossings
    fixed = ", ".join(candidate.parameters)
    where = f"{system.title}{f' ({fixed} as in the candidate)' if fixed else ''}"
    power = "Poincare map" if m == 1 else f"power {m} of the Poincare map"
    return (
        "In the box there is exactly one point x of Fix(R) with P(x) in Fix(R) at which D(P^2)(x) - 1, "
        f"{at_fixed_parameter(candidate)}, has a kernel vector that R negates: there R is lost, and two orbits are "
        f"born that R does not map to themselves. P is the {power} of the {where}, and the parameter is "
        f"{candidate.titles[0]}. The orbit of x is symmetric under R, has the time from x to P^2(x) as its least "
        f"period, and {meetings(m)}. A neighbourhood of x in the section and one of the value of the parameter at x "
        "are such that for every value in the second the points x' of the first at which the parameter has that value "
        "and P^2(x') = x' are these: exactly one in Fix(R), whose orbit is symmetric, and which depends smoothly on "
        "the parameter; on one side of the value at x exactly two more, not in Fix(R), which R exchanges and which "
        "tend to x as the value tends to that at x; on the other side, and at x, no more. The two lie on two different "
        "periodic orbits, whose least periods tend to that of the orbit of x. R maps each of these to the other with "
        "time reversed, and neither to itself. "
        f"Of other symmetries nothing is said: the new orbits may have some.{on_level(candidate)}"
    )


def at_fixed_parameter(candidate: Candidate) -> str:
    """Where the maps are compared that a claim is about."""
    if candidate.level_sign is None and candidate.system.fixed_level is None:
        return "at the fixed value of the parameter"
    return (
        "on the level of the first integral" if candidate.level_sign is not None else "at fixed parameter on the level"
    )


def meetings(m: int) -> str:
    """How often the symmetric orbit meets the section."""
    if m == 1:
        return "meets the section in a period at x and P(x) only"
    return f"meets the section in a period {2 * m} times, of which only x and P(x) are in Fix(R)"


def on_level(candidate: Candidate) -> str:
    """The level and the sheet of the points, a sentence that begins with a space."""
    system, level = candidate.system, candidate.system.fixed_level
    if level is not None:
        side = sheet_in_words(system)
        where = f"{system.first_integral_name or 'H'} = {exact_text(level.value)}"
        return f" All points are on the level {where}, those of the box with {side}."
    if candidate.level_sign is None:
        return ""
    side = f"{system.level_coordinate} {'>' if candidate.level_sign > 0 else '<'} 0"
    return f" The box is in the coordinates {', '.join(candidate.titles)}, with {side}."


def breaking_found(candidate: Candidate, found: BreakingResults) -> Iterator[str]:
    """What was found, in lines."""
    system = candidate.system
    here, there = (_named(keyed_in_words(system, point)) for point in (found.point, found.other_point))
    yield f"The point x has {here}; P(x) has {there}."
    parameter = claim_in_words(candidate).titles[0]
    yield f"The parameter there, {parameter}, lies in {decimal_interval(found.parameter, _DIGITS)}."
    yield f"The period of the orbit of x lies in {interval_text(found.period, _DIGITS)}."
    relation = "greater" if found.side == "above" else "less"
    yield f"The two orbits exist for values of the parameter {relation} than that."
    direction = _named(keyed_in_words(system, found.direction))
    w, y, kappa = (free_letter(system, letter) for letter in ("w", "y", "kappa"))
    yield (
        f"They leave Fix(R) along the vector {w} with {direction}: the points x' have the coordinates +-{y} {w} + "
        f"O({y}^3), of those that R negates, and the parameter differs from its value at x by {kappa} {y}^2 + "
        f"O({y}^4), {kappa} in {interval_text(found.opening, _DIGITS)}."
    )


def _named(point: Mapping[str, arb]) -> str:
    return ", ".join(located(name, ball, _DIGITS) for name, ball in point.items())
