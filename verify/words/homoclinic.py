"""The theorem about a homoclinic orbit in words, and what was found (section 40.6)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.claims.homoclinic import HomoclinicOrbit
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text, located
from orbitproof.verify.homoclinic import HomoclinicResults, HomoclinicTheorem
from orbitproof.verify.words.periodic import field_in_lines

_DIGITS = 20
_TAKEN = ("a", "f", "p", "q", "r", "s", "H", "R")


def homoclinic_in_words(theorem: HomoclinicTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    assert claim.level is not None
    integral = claim.system.first_integral_name or "first integral"
    named = ", ".join(keyed_in_words(claim.system, claim.parameters))
    given = f" ({named} as in the candidate)" if named else ""
    return (
        f"On the level {exact_text(claim.level)} of the {integral} of the {claim.system.title}{given}, the box "
        f"contains exactly one point that its orbit comes back to at crossing {claim.crossings} of the section. R maps "
        "this periodic orbit to itself, and it is hyperbolic on the level. Its unstable manifold leads from this point "
        f"through the box as a graph s = g(a), |g'| at most {exact_text(claim.cone)}. Over the interval of a, this "
        f"graph has exactly one point whose orbit is in Fix(R) at crossing {claim.arrival} from there. This orbit is "
        "homoclinic to the periodic orbit, R maps it to itself, and along it the unstable and the stable manifold "
        "intersect transversally in the level. Therefore some iterate of the return map has a compact invariant set on "
        "which it is conjugate to the shift on two symbols: the level has infinitely many periodic orbits, and the "
        "topological entropy of the flow on it is positive."
    )


def homoclinic_in_full(claim: HomoclinicOrbit, theorem: str, found: HomoclinicResults) -> Iterator[str]:
    """System, box, theorem and what was found, in lines."""
    system, names = claim.system, names_in_words(claim.system)
    yield from field_in_lines(system, _TAKEN)[0]
    for name, value in keyed_in_words(system, claim.parameters).items():
        yield f"  {name} = {exact_text(value)}"
    if names:
        called = ", ".join(f"{new} is called {name}" for name, new in names.items())
        yield f"In the description of the system {called}, which has another meaning here."

    def said(name: str) -> str:
        return names.get(name, name)

    negated = " and ".join(
        said(name) for name, sign in zip(system.state, claim.reversing_symmetry, strict=True) if sign < 0
    )
    p, q, w = map(said, (claim.along, claim.across, claim.level_coordinate))
    word = "positive" if claim.level_sign > 0 else "negative"
    yield f"R negates {negated}. The section is {said(claim.section)} = 0 on the level, with {w} {word}."
    yield (
        f"The box has the coordinates a and s: {p} = c + a + s, {q} = l (a - s), |a| and |s| at most r, with "
        f"c = {exact_text(claim.centre[0])}, l = {exact_text(claim.slope)}, r = {exact_text(claim.radii[0])}. "
        f"The interval of a has the middle {exact_text(claim.centre[1])} and the half-width "
        f"{exact_text(claim.radii[1])}."
    )
    yield "Theorem."
    yield theorem
    place = ", ".join(located(name, ball, _DIGITS) for name, ball in keyed_in_words(system, found.point).items())
    yield (
        f"The periodic orbit meets Fix(R) at {place}. A period lies in {decimal_interval(found.period, _DIGITS)}, its "
        f"multiplier of absolute value above 1 in {decimal_interval(found.multiplier, _DIGITS)}."
    )
    place = ", ".join(located(name, ball, _DIGITS) for name, ball in keyed_in_words(system, found.meeting).items())
    yield (
        f"The homoclinic orbit leaves at a in {decimal_interval(found.departure, _DIGITS)} and meets Fix(R) at "
        f"{place}, after a time in {decimal_interval(found.time, _DIGITS)}. The derivatives of {p} and {q} there by a, "
        f"along the unstable manifold, lie in {' and '.join(decimal_interval(ball, _DIGITS) for ball in found.slopes)}."
    )
