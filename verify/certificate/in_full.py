"""The theorem of a candidate's certificate so that it stands alone (section 10.4)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import count
from math import floor, log10
from typing import Protocol

from flint import arb

from orbitproof.shared.formats import FOLD, Candidate
from orbitproof.verify.bifurcation import parameter_name
from orbitproof.verify.claim import claim_in_words, inverse, keyed_in_words, setting
from orbitproof.verify.evidence import (
    Theorem,
    certain_digits,
    decimal_interval,
    dot,
    enclose,
    exact_text,
    guarded,
    located,
    symmetric,
)
from orbitproof.verify.orbit import OrbitResults, orbit_in_full

_DIGITS = 40
_BITS = 1024
"""More than the numbers of any candidate have: the decimals depend on them alone."""
_SHORT = 6


class Located(Protocol):
    """What is known of a proved bifurcation: a certificate, or results."""

    @property
    def point(self) -> Mapping[str, arb]:
        """Enclosures of its coordinates on Fix(R)."""

    @property
    def parameter(self) -> arb | None:
        """Enclosure of the parameter."""

    @property
    def side(self) -> str | None:
        """Parameter values at which there are new orbits."""


def in_full(candidate: Candidate, form: Candidate | None, theorem: Theorem, found: Located | OrbitResults) -> str:
    """System, box, theorem, what its words mean, and what was found, in this order.

    `form` as in `certificate.statement`. The decimals of the box are rounded outward where it is enclosed, and inward
    where something is said to lie in it.
    """
    system = candidate.system
    own, claim = claim_in_words(candidate), claim_in_words(form or candidate)
    with guarded(_BITS):
        lines = setting(system, candidate.parameters, candidate.symmetry, candidate.crossings)
        lines += _box(claim, form is not None)
        if form is not None:
            lines += ["The candidate's own box:", *_set(own, "candidate")]
        lines += ["Theorem.", theorem.statement]
        if isinstance(found, OrbitResults):
            lines += orbit_in_full(candidate, found)
        else:
            lines += [_definition(claim), *_found(found, claim, keyed_in_words(system, found.point))]
    return "\n".join(lines)


def _box(claim: Candidate, is_form: bool) -> Iterator[str]:
    names = ", ".join(claim.coordinates)
    fixed = claim.system.fixed_level
    if fixed is not None:
        sign = "positive" if fixed.sign > 0 else "negative"
        yield (
            f"The box, in the coordinates ({names}) of those points of Fix(R) that lie on the level "
            f"H = {exact_text(fixed.value)}, {claim.system.level_coordinate} being its {sign} solution. Only "
            f"such points are meant in what follows:"
        )
    elif claim.level_sign is None:
        yield f"The box, in the coordinates ({names}) of Fix(R):"
    else:
        sign = "positive" if claim.level_sign > 0 else "negative"
        yield (
            f"The box, in the coordinates ({names}) of Fix(R), where {claim.system.level_coordinate} is the {sign} "
            f"solution of H = {claim.coordinates[0]}:"
        )
    yield from _set(claim, "level_form" if is_form else "candidate")


def _set(claim: Candidate, where: str) -> Iterator[str]:
    """The box as a set, exactly by reference to the numbers of the statement, and in decimals."""
    radii = ", ".join(exact_text(radius) for radius in claim.radii)
    names = (*claim.system.state, *claim.system.parameters)
    c, p = (next(each for each in _letters(letter) if each not in names) for letter in "cp")
    yield (
        f"  all points {c} + A {p} with |{p}_i| <= R_i, where {c}, A and R are exactly centre, frame and radii of "
        f"{where} in this statement; (R_i) = ({radii})."
    )
    sides = [symmetric(radius) for radius in claim.radii]
    for name, middle, row in zip(claim.coordinates, claim.centre, claim.frame, strict=True):
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


def _letters(letter: str) -> Iterator[str]:
    """The letter, and what stands for it where somebody's coordinate is called so."""
    yield letter
    yield from (f"{letter}{number}" for number in count())


def _below(value: Fraction) -> str:
    """A positive number in decimals, rounded down to a few digits."""
    exponent = floor(log10(value.numerator) - log10(value.denominator))
    digits = Decimal(floor(value * Fraction(10) ** (_SHORT - 1 - exponent))).scaleb(1 - _SHORT)
    return f"{digits}e{exponent}"


def _definition(claim: Candidate) -> str:
    k = claim.k
    if claim.kind == FOLD:
        return (
            "Fold means: on one side of the value of the parameter at the bifurcation point the box contains no point "
            "x of Fix(R) with P^2(x) = x; for every value on the other side that is near enough it contains exactly "
            "two, on two different orbits, and they merge at the bifurcation point."
        )
    along = "near the bifurcation point the family has one point for every value of the parameter near its value there"
    if claim.kind == "touch_and_go":
        return (
            f"Touch-and-go of order {k} means: {along}; besides it the points x of Fix(R) with P^{2 * k}(x) = x are "
            f"one more curve, which also has one point for every such value, and the two meet at the bifurcation "
            f"point only."
        )
    if claim.kind == "symmetry_breaking":
        return (
            f"Symmetry breaking means: {along}; on one side of this value only, there are exactly two further points "
            f"x of Fix(R) near by with P^2(x) = x, exchanged by {claim.symmetry}, and they merge at the bifurcation "
            f"point."
        )
    exchanged = f", exchanged by P^{k}," if k % 2 == 0 else ""
    return (
        f"Period-{k}-tupling means: {along}; on one side of this value only, there are exactly two further points x of "
        f"Fix(R) near by with P^{2 * k}(x) = x{exchanged} and they merge at the bifurcation point."
    )


_SIDES = {
    "above": "for values of the parameter greater than that",
    "below": "for values of the parameter less than that",
    "both": "for values of the parameter on both sides of that",
}


def _found(found: Located, claim: Candidate, point: Mapping[str, arb]) -> Sequence[str]:
    where = ", ".join(located(name, ball, _DIGITS) for name, ball in point.items())
    parameter = "not finite" if found.parameter is None else decimal_interval(found.parameter, _DIGITS)
    return [
        f"The bifurcation point has {where}.",
        f"The parameter there, {parameter_name(claim)}, lies in {parameter}.",
        f"The {'two' if claim.kind == FOLD else 'new'} orbits exist {_SIDES[str(found.side)]}.",
    ]
