"""Theorems so that they stand alone: the system, the box, what words mean, what was found (section 10.4)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from decimal import Decimal
from fractions import Fraction
from math import floor, log10

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation import BifurcationResults, TheoremInBox
from orbitproof.verify.claim import claim_in_words, inverse, keyed_in_words, sheet_in_words
from orbitproof.verify.evidence import (
    certain_digits,
    decimal_interval,
    dot,
    enclose,
    exact_text,
    guarded,
    symmetric,
)
from orbitproof.verify.words.bifurcation import bifurcation_in_words, found_in_words, kind_in_words
from orbitproof.verify.words.formulas import free_letter, setting

_DIGITS = 40
_BITS = 1024
"""More than the numbers of any candidate have: the decimals depend on them alone."""
_SHORT = 6


def in_lines(lines: Iterable[str]) -> str:
    """Lines as a text; the decimals in them depend on the candidate alone."""
    with guarded(_BITS):
        return "\n".join(lines)


def symmetric_in_full(candidate: Candidate, theorem: str, found: Iterable[str], form: Candidate | None = None) -> str:
    """System, box, theorem, and what was found, of a claim about symmetric orbits.

    The decimals of the box are rounded outward where it is enclosed, and inward where something is said to lie in it.

    Args:
        found: lines, which are made only here.
        form: the level form, if the theorem is about its box.
    """
    return in_lines(_symmetric(candidate, theorem, found, form))


def _symmetric(candidate: Candidate, theorem: str, found: Iterable[str], form: Candidate | None) -> Iterator[str]:
    own, claim = claim_in_words(candidate), claim_in_words(form or candidate)
    yield from setting(candidate.system, candidate.parameters, candidate.symmetry, candidate.crossings)
    yield from _box(claim, form is not None)
    if form is not None:
        yield "The candidate's own box:"
        yield from _set(own, "candidate")
    yield "Theorem."
    yield theorem
    yield from found


def bifurcation_in_full(candidate: Candidate, theorem: TheoremInBox, found: BifurcationResults) -> str:
    """System, boxes, theorem, what its kind of bifurcation means, and what was found."""
    form = theorem.claim if theorem.in_own_box else None
    told = _bifurcation_found(claim_in_words(form or candidate), candidate, found)
    return symmetric_in_full(candidate, bifurcation_in_words(theorem), told, form)


def _bifurcation_found(claim: Candidate, candidate: Candidate, found: BifurcationResults) -> Iterator[str]:
    yield kind_in_words(claim)
    yield from found_in_words(found, claim, keyed_in_words(candidate.system, found.point))


def _box(claim: Candidate, is_form: bool) -> Iterator[str]:
    names = ", ".join(claim.titles)
    fixed = claim.system.fixed_level
    if fixed is not None:
        which = f"its {'positive' if fixed.sign == 1 else 'negative'} solution"
        if fixed.between is not None:
            which = f"its one solution with {sheet_in_words(claim.system)}"
        yield (
            f"The box, in the coordinates ({names}) of those points of Fix(R) that lie on the level "
            f"H = {exact_text(fixed.value)}, {claim.system.level_coordinate} being {which}. Only "
            f"such points are meant in what follows:"
        )
    elif claim.resonances_meet:
        yield f"The box, in the coordinates ({names}): the parameter {claim.varying} and those of Fix(R):"
    elif claim.level_sign is None:
        yield f"The box, in the coordinates ({names}) of Fix(R):"
    else:
        sign = "positive" if claim.level_sign > 0 else "negative"
        yield (
            f"The box, in the coordinates ({names}) of Fix(R), where {claim.system.level_coordinate} is the {sign} "
            f"solution of H = {claim.titles[0]}:"
        )
    yield from _set(claim, "level_form" if is_form else "candidate")


def _set(claim: Candidate, where: str) -> Iterator[str]:
    """The box as a set, exactly by reference to the numbers of the statement, and in decimals."""
    radii = ", ".join(exact_text(radius) for radius in claim.radii)
    c, p = (free_letter(claim.system, letter) for letter in "cp")
    yield (
        f"  all points {c} + A {p} with |{p}_i| <= R_i, where {c}, A and R are exactly centre, frame and radii of "
        f"{where} in this statement; (R_i) = ({radii})."
    )
    sides = [symmetric(radius) for radius in claim.radii]
    for name, middle, row in zip(claim.titles, claim.centre, claim.frame, strict=True):
        values = enclose(middle) + dot([enclose(value) for value in row], sides)
        centre = "0" if middle == 0 else certain_digits(enclose(middle), _DIGITS)
        yield f"  {name}: {c} is {centre}, and on the box {name} lies in {decimal_interval(values, _DIGITS)}."
    rows = inverse(claim.frame)
    if rows is not None:
        reach = min(
            radius / sum((abs(value) for value in row), Fraction(0))
            for row, radius in zip(rows, claim.radii, strict=True)
        )
        yield f"  It contains every point whose coordinates differ from those of {c} by at most {_below(reach)}."


def _below(value: Fraction) -> str:
    """A positive number in decimals, rounded down to a few digits."""
    exponent = floor(log10(value.numerator) - log10(value.denominator))
    digits = Decimal(floor(value * Fraction(10) ** (_SHORT - 1 - exponent))).scaleb(1 - _SHORT)
    return f"{digits}e{exponent}"
