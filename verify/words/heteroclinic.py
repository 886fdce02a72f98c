"""The theorem about a heteroclinic orbit in words, and what was found (section 41.5)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.claims.heteroclinic import HeteroclinicOrbit
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text
from orbitproof.verify.heteroclinic import HeteroclinicResults, HeteroclinicTheorem
from orbitproof.verify.words.formulas import free_letter
from orbitproof.verify.words.homoclinic import place_in_words, setting_on_level
from orbitproof.verify.words.periodic import integral_in_words

_DIGITS, _SHORT = 20, 10


def _letters(claim: HeteroclinicOrbit) -> list[str]:
    """What is called a, s, g, N and n, unless the system has such names."""
    return [free_letter(claim.system, letter) for letter in "asgNn"]


def heteroclinic_in_words(theorem: HeteroclinicTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    assert claim.level is not None
    a, s, g, most, n = _letters(claim)
    named = ", ".join(keyed_in_words(claim.system, claim.parameters))
    given = f" ({named} as in the candidate)" if named else ""
    (j_1, j_2), (k_1, k_2), (cone_1, cone_2) = claim.returns, claim.arrival, map(exact_text, claim.cone)
    return (
        f"On the level {exact_text(claim.level)} of the {integral_in_words(claim.system)} of the {claim.system.title}"
        f"{given}, box 1 contains exactly one point to which its orbit comes back at crossing {j_1} of the section, "
        f"and box 2 exactly one to which its orbit comes back at crossing {j_2}, where crossings in both directions "
        "count. These periodic orbits, 1 and 2, are two different ones; R maps each of them to itself, and each is "
        "hyperbolic on the level. The unstable manifold of each leads from its point through its box as a graph "
        f"{s} = {g}({a}), |{g}'| at most {cone_1} in box 1 and {cone_2} in box 2. Over the intervals of {a}, there is "
        f"exactly one pair of points of these graphs, one of each, such that crossing {k_1} of the orbit of the first "
        f"is the image under R of crossing {k_2} of the orbit of the second. The orbit of the first is heteroclinic: "
        "it tends to periodic orbit 1 backwards in time, and to periodic orbit 2 forwards. Along it, the unstable "
        "manifold of 1 and the stable manifold of 2 intersect transversally in the level. R maps it to an orbit "
        "that leads from 2 to 1 in the same way. Therefore, for every two neighbourhoods of the periodic orbits 1 and "
        f"2 there is a number {most} such that for every two-sided sequence of the symbols 1 and 2 there is an orbit "
        "on the level with this property: if its crossings are numbered in their order from a suitable one, which is "
        f"number 0, then crossing number {n} {most} lies, for each integer {n}, in the neighbourhood of the periodic "
        f"orbit that symbol number {n} names. The level has infinitely many periodic orbits, and a compact invariant "
        "set on which the flow has positive topological entropy."
    )


def heteroclinic_found(claim: HeteroclinicOrbit, found: HeteroclinicResults) -> Iterator[str]:
    """Both periodic orbits, and where the manifolds meet, in short lines."""
    for number, (own, end) in enumerate(zip(claim.ends, found.ends, strict=True), start=1):
        where = place_in_words(own, end.point, _SHORT)
        yield f"periodic orbit {number}: {where}, multiplier in {decimal_interval(end.multiplier, _SHORT)}"
    yield f"the heteroclinic orbit crosses the section at {place_in_words(claim.ends[0], found.meeting, _SHORT)}"


def heteroclinic_in_full(claim: HeteroclinicOrbit, theorem: str, found: HeteroclinicResults) -> Iterator[str]:
    """System, boxes, theorem and what was found, in lines."""
    first, names = claim.ends[0], names_in_words(claim.system)
    letters = _letters(claim)
    a, s = letters[:2]
    yield from setting_on_level(first, letters)
    p, q, w = (names.get(name, name) for name in (first.along, first.across, first.level_coordinate))
    for number, end in enumerate(claim.ends, start=1):
        word = "positive" if end.level_sign > 0 else "negative"
        c, slope, r = map(exact_text, (end.centre[0], end.slope, end.radii[0]))
        yield (
            f"Box {number} lies where {w} is {word}. It has the coordinates {a} and {s}: {p} = {c} + {a} + {s}, "
            f"{q} = {slope} ({a} - {s}), |{a}| and |{s}| at most {r}. Its interval of {a} has the middle "
            f"{exact_text(end.centre[1])} and the half-width {exact_text(end.radii[1])}."
        )
    yield "Theorem."
    yield theorem
    for number, (own, at) in enumerate(zip(claim.ends, found.ends, strict=True), start=1):
        period, multiplier = (decimal_interval(ball, _DIGITS) for ball in (at.period, at.multiplier))
        yield (
            f"Periodic orbit {number} meets Fix(R) at {place_in_words(own, at.point, _DIGITS)}. A period lies in "
            f"{period}, its multiplier beyond the unit circle in {multiplier}."
        )
    for number, at in enumerate(found.ends, start=1):
        passage, time, *slopes = (decimal_interval(ball, _DIGITS) for ball in (at.passage, at.time, *at.slopes))
        yield (
            f"The point of the pair in box {number} has {a} in {passage}. Its orbit takes a time in {time} to the "
            f"crossing that is named; the derivatives of {p} and {q} there by {a}, along the unstable manifold, lie in "
            f"{' and '.join(slopes)}."
        )
    yield f"The heteroclinic orbit crosses the section there at {place_in_words(first, found.meeting, _DIGITS)}."
