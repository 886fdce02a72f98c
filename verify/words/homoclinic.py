"""The theorem about a homoclinic orbit in words, and what was found (section 40.6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flint import arb

from orbitproof.shared.claims.homoclinic import HomoclinicOrbit
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text, located
from orbitproof.verify.homoclinic import HomoclinicResults, HomoclinicTheorem
from orbitproof.verify.words.formulas import equations, free_letter
from orbitproof.verify.words.periodic import field_in_lines, integral_in_words, program_in_words

_DIGITS, _SHORT = 20, 10
_TAKEN = ("f", "p", "q", "H", "R")


def _letters(claim: HomoclinicOrbit) -> list[str]:
    """What is called a, s, c, l, r and g, unless the system has such names."""
    return [free_letter(claim.system, letter) for letter in "asclrg"]


def homoclinic_in_words(theorem: HomoclinicTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    assert claim.level is not None
    a, s, _, _, _, g = _letters(claim)
    named = ", ".join(keyed_in_words(claim.system, claim.parameters))
    given = f" ({named} as in the candidate)" if named else ""
    return (
        f"On the level {exact_text(claim.level)} of the {integral_in_words(claim.system)} of the {claim.system.title}"
        f"{given}, the box contains exactly one point to which its orbit comes back at crossing {claim.crossings} of "
        "the section, where crossings in both directions count. R maps this periodic orbit to itself, and it is "
        f"hyperbolic on the level. Its unstable manifold leads from this point through the box as a graph {s} = "
        f"{g}({a}), |{g}'| at most {exact_text(claim.cone)}. Over the interval of {a}, this graph has exactly one "
        f"point whose orbit is in Fix(R) at crossing {claim.arrival} from there. This orbit is homoclinic to the "
        "periodic orbit, R maps it to itself, and along it the unstable and the stable manifold intersect "
        "transversally in the level. Therefore some iterate of the map to the next crossing has a compact invariant "
        "set on which it is conjugate to the shift on two symbols: the level has infinitely many periodic orbits, and "
        "a compact invariant set on which the flow has positive topological entropy."
    )


def homoclinic_found(claim: HomoclinicOrbit, found: HomoclinicResults) -> Iterator[str]:
    """Multiplier of the periodic orbit, and where the homoclinic one meets Fix(R), in short lines."""
    yield f"multiplier in {decimal_interval(found.multiplier, _SHORT)}"
    yield f"the homoclinic orbit meets Fix(R) at {place_in_words(claim, found.meeting, _SHORT)}"


def place_in_words(claim: HomoclinicOrbit, values: Mapping[str, arb], digits: int) -> str:
    """Coordinates of a point, each in its interval."""
    return ", ".join(located(name, ball, digits) for name, ball in keyed_in_words(claim.system, values).items())


def homoclinic_in_full(claim: HomoclinicOrbit, theorem: str, found: HomoclinicResults) -> Iterator[str]:
    """System, box, theorem and what was found, in lines."""
    a, s, c, slope, r, g = _letters(claim)
    *lines, section = setting_on_level(claim, (a, s, c, slope, r, g))
    yield from lines
    p, q, w = (names_in_words(claim.system).get(n, n) for n in (claim.along, claim.across, claim.level_coordinate))
    word = "positive" if claim.level_sign > 0 else "negative"
    yield f"{section} The box lies where {w} is {word}."
    yield (
        f"The box has the coordinates {a} and {s}: {p} = {c} + {a} + {s}, {q} = {slope} ({a} - {s}), |{a}| and |{s}| "
        f"at most {r}, with {c} = {exact_text(claim.centre[0])}, {slope} = {exact_text(claim.slope)}, "
        f"{r} = {exact_text(claim.radii[0])}. The interval of {a} has the middle {exact_text(claim.centre[1])} and the "
        f"half-width {exact_text(claim.radii[1])}."
    )
    yield "Theorem."
    yield theorem
    passage, period, multiplier, time, *slopes = (
        decimal_interval(ball, _DIGITS)
        for ball in (found.passage, found.period, found.multiplier, found.time, *found.slopes)
    )
    yield (
        f"The periodic orbit meets Fix(R) at {place_in_words(claim, found.point, _DIGITS)}. A period lies in {period}, "
        f"its multiplier beyond the unit circle in {multiplier}."
    )
    yield (
        f"The homoclinic orbit has a point of the graph with {a} in {passage}, and meets Fix(R) at "
        f"{place_in_words(claim, found.meeting, _DIGITS)}, a time in {time} later. The derivatives of {p} and {q} "
        f"there by {a}, along the unstable manifold, lie in {' and '.join(slopes)}."
    )


def setting_on_level(claim: HomoclinicOrbit, letters: Sequence[str]) -> Iterator[str]:
    """System and first integral, with none of these letters for parts of them; the last line is R with the section."""
    system, names = claim.system, names_in_words(claim.system)
    field, taken = field_in_lines(system, (*_TAKEN, *letters))
    yield from field
    for name, value in keyed_in_words(system, claim.parameters).items():
        yield f"  {name} = {exact_text(value)}"
    if names:
        called = ", ".join(f"{new} is called {name}" for name, new in names.items())
        yield f"In the description of the system {called}, which has another meaning here."
    if system.first_integral_program is not None:
        yield f"A first integral, the {integral_in_words(system)}:"
        yield from (
            f"  {line}" for line in equations(program_in_words(system, system.first_integral_program), ["H"], taken)
        )

    def said(name: str) -> str:
        return names.get(name, name)

    state = [said(name) for name in system.state]
    image = [name if sign > 0 else f"-{name}" for name, sign in zip(state, claim.reversing_symmetry, strict=True)]
    yield (
        f"R({', '.join(state)}) = ({', '.join(image)}) reverses the flow. The section is {said(claim.section)} = 0 on "
        f"the level, for both signs of {said(claim.level_coordinate)}, and is crossed in both directions."
    )
