"""The theorem about parameters at which two resonances meet, in words (section 34.4)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.formats import Candidate
from orbitproof.verify.claim import claim_in_words, keyed_in_words
from orbitproof.verify.double_resonance import ResonanceResults, ResonanceTheorem
from orbitproof.verify.evidence import decimal_interval, interval_text, located
from orbitproof.verify.words.breaking import meetings
from orbitproof.verify.words.formulas import free_letter

_DIGITS = 40


def resonance_in_words(theorem: ResonanceTheorem) -> str:
    """The theorem, in short."""
    candidate = claim_in_words(theorem.claim)
    system, m, k, name = candidate.system, candidate.crossings, candidate.k, candidate.varying
    fixed, c = ", ".join(candidate.parameters), free_letter(system, "c")
    where = f"{system.title}{f' ({fixed} as in the candidate)' if fixed else ''}"
    power = "Poincare map" if m == 1 else f"power {m} of the Poincare map"
    return (
        f"P is the {power} of the {where}, and {name} varies. For each {name} the points x of the box with P(x) in "
        "Fix(R), if there are any, are one or more smooth curves, the family; their orbits are symmetric under R. A "
        "stability parameter of the orbit of x is an eigenvalue, but for the 1 that belongs to the tangent of the "
        "family, of the derivative S at x of the coordinates of P^2 on Fix(R) by themselves; if it is "
        f"{c} = cos(2 pi j/k), the orbit "
        "has the multipliers exp(2 pi i j/k) and exp(-2 pi i j/k). In the box there is exactly one pair of a value of "
        f"{name} and a point x of its family at which det({c} - S) is 0 together with its derivative along the family, "
        f"for k = {k} and the j below; and there {c} is a simple eigenvalue. The orbit of x has the time from x to "
        f"P^2(x) as its least period, and {meetings(m)}. Along the family of this {name} the stability "
        f"parameter has a strict local extremum at x, of order 2; its extremal value along the families of "
        f"neighbouring {name} passes {c} with a derivative by {name} that is not 0. So two 1:{k} resonances meet "
        f"there: for {name} near that value, on one side of it the family has exactly two orbits near x with that "
        f"stability parameter equal to {c}, which it passes at each with a derivative other than 0, and on the other "
        "side none. What branches off there is not said."
    )


def resonance_found(candidate: Candidate, found: ResonanceResults) -> Iterator[str]:
    """What was found, in lines."""
    point = keyed_in_words(candidate.system, found.point)
    name = claim_in_words(candidate).varying
    here = ", ".join(located(key, ball, _DIGITS) for key, ball in point.items() if key != name)
    along = next(iter(keyed_in_words(candidate.system, {found.along: None})))
    level = claim_in_words(candidate).system.first_integral_name or "value of H"
    c, y = (free_letter(candidate.system, letter) for letter in "cy")
    yield f"The value of {name} lies in {decimal_interval(found.parameter, _DIGITS)}. The point x has {here}."
    yield f"There j = {found.turn}, and the stability parameter has a {found.extremum} along the family."
    yield (
        f"The {level} at x lies in {interval_text(found.level, _DIGITS)}, the period of the orbit in "
        f"{interval_text(found.period, _DIGITS)}."
    )
    relation = "greater" if found.side == "above" else "less"
    yield f"The two resonances exist for values of {name} {relation} than that."
    yield (
        f"The extremal value has the derivative {interval_text(found.slope, _DIGITS)} by {name}, the stability "
        f"parameter the second derivative {interval_text(found.curvature, _DIGITS)} by {along} along the family; where "
        f"it is {c}, {name} differs from its value at x by kappa {y}^2 + O({y}^3), {y} the difference of {along} from "
        f"its value at x, kappa in {interval_text(found.opening, _DIGITS)}."
    )
