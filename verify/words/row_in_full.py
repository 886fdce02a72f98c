"""Theorems so that they stand alone: the system, the box, what words mean, what was found (section 10.4)."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from itertools import count
from math import floor, log10

from orbitproof.shared.formats import BoxClaim, Candidate, PeriodicBifurcation, PeriodicOrbit
from orbitproof.verify.bifurcation import BifurcationTheorem, FoldTheorem
from orbitproof.verify.claim import claim_in_words, inverse, keyed_in_words, sheet_in_words
from orbitproof.verify.double_resonance import ResonanceResults, ResonanceTheorem
from orbitproof.verify.evidence import (
    Theorem,
    certain_digits,
    decimal_interval,
    dot,
    enclose,
    exact_text,
    guarded,
    symmetric,
)
from orbitproof.verify.krein import KreinResults, KreinTheorem
from orbitproof.verify.orbit import OrbitResults, OrbitTheorem
from orbitproof.verify.periodic import PeriodicResults, PeriodicTheorem
from orbitproof.verify.periodic_bifurcation import (
    PeriodicBifurcationResults,
    PeriodicBifurcationTheorem,
    TorusResults,
    TorusTheorem,
)
from orbitproof.verify.reversor_breaking import BreakingResults, BreakingTheorem
from orbitproof.verify.tori import ToriResults, ToriTheorem
from orbitproof.verify.twist import StableOrbitResults, StableOrbitTheorem
from orbitproof.verify.words.bifurcation import Located, bifurcation_in_words, found_in_words, kind_in_words
from orbitproof.verify.words.breaking import breaking_found, breaking_in_words
from orbitproof.verify.words.double_resonance import resonance_found, resonance_in_words
from orbitproof.verify.words.formulas import setting
from orbitproof.verify.words.krein import krein_found, krein_in_words
from orbitproof.verify.words.orbit import orbit_found, orbit_in_words
from orbitproof.verify.words.periodic import periodic_in_full, periodic_in_words
from orbitproof.verify.words.periodic_bifurcation import (
    periodic_bifurcation_in_full,
    periodic_bifurcation_in_words,
)
from orbitproof.verify.words.periodic_torus import torus_in_full, torus_in_words
from orbitproof.verify.words.stable_orbit import stable_orbit_found, stable_orbit_in_words
from orbitproof.verify.words.tori import tori_found, tori_in_words

_DIGITS = 40
_BITS = 1024
"""More than the numbers of any candidate have: the decimals depend on them alone."""
_SHORT = 6


def theorem_in_words(theorem: Theorem) -> str:
    """A theorem about a box, in short. Raises `TypeError` if it is about no box."""
    match theorem:
        case BifurcationTheorem() | FoldTheorem():
            return bifurcation_in_words(theorem)
        case OrbitTheorem():
            return orbit_in_words(theorem)
        case StableOrbitTheorem():
            return stable_orbit_in_words(theorem)
        case ToriTheorem():
            return tori_in_words(theorem)
        case BreakingTheorem():
            return breaking_in_words(theorem)
        case KreinTheorem():
            return krein_in_words(theorem)
        case ResonanceTheorem():
            return resonance_in_words(theorem)
        case PeriodicTheorem():
            return periodic_in_words(theorem)
        case PeriodicBifurcationTheorem():
            return periodic_bifurcation_in_words(theorem)
        case TorusTheorem():
            return torus_in_words(theorem)
    raise TypeError(f"{type(theorem).__name__}: a theorem about no box")


InSectionResults = PeriodicResults | PeriodicBifurcationResults | TorusResults


def in_full(
    candidate: BoxClaim,
    theorem: Theorem,
    found: Located | OrbitResults | BreakingResults | KreinResults | ResonanceResults | InSectionResults,
) -> str:
    """System, box, theorem, what its words mean, and what was found, in this order.

    The decimals of the box are rounded outward where it is enclosed, and inward where something is said to lie in it.
    """
    if not isinstance(candidate, Candidate) or isinstance(found, InSectionResults):
        words = theorem_in_words(theorem)
        with guarded(_BITS):
            if isinstance(candidate, PeriodicOrbit) and isinstance(found, PeriodicResults):
                return "\n".join(periodic_in_full(candidate, words, found))
            if isinstance(candidate, PeriodicBifurcation) and isinstance(found, PeriodicBifurcationResults):
                return "\n".join(periodic_bifurcation_in_full(candidate, words, found))
            if isinstance(candidate, PeriodicBifurcation) and isinstance(found, TorusResults):
                return "\n".join(torus_in_full(candidate, words, found))
        raise TypeError("the results are those of another kind of claim")
    system = candidate.system
    form = theorem.claim if isinstance(theorem, (BifurcationTheorem, FoldTheorem)) and theorem.in_own_box else None
    own, claim = claim_in_words(candidate), claim_in_words(form or candidate)
    with guarded(_BITS):
        lines = setting(system, candidate.parameters, candidate.symmetry, candidate.crossings)
        lines += _box(claim, form is not None)
        if form is not None:
            lines += ["The candidate's own box:", *_set(own, "candidate")]
        lines += ["Theorem.", theorem_in_words(theorem)]
        if isinstance(found, StableOrbitResults):
            lines += stable_orbit_found(candidate, found)
        elif isinstance(found, ToriResults):
            lines += tori_found(candidate, found)
        elif isinstance(found, OrbitResults):
            lines += orbit_found(candidate, found)
        elif isinstance(found, BreakingResults):
            lines += breaking_found(candidate, found)
        elif isinstance(found, KreinResults):
            lines += krein_found(candidate, found)
        elif isinstance(found, ResonanceResults):
            lines += resonance_found(candidate, found)
        else:
            lines += [kind_in_words(claim), *found_in_words(found, claim, keyed_in_words(system, found.point))]
    return "\n".join(lines)


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
    names = (*claim.system.state, *claim.system.parameters)
    c, p = (next(each for each in _letters(letter) if each not in names) for letter in "cp")
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


def _letters(letter: str) -> Iterator[str]:
    """The letter, and what stands for it where somebody's coordinate is called so."""
    yield letter
    yield from (f"{letter}{number}" for number in count())


def _below(value: Fraction) -> str:
    """A positive number in decimals, rounded down to a few digits."""
    exponent = floor(log10(value.numerator) - log10(value.denominator))
    digits = Decimal(floor(value * Fraction(10) ** (_SHORT - 1 - exponent))).scaleb(1 - _SHORT)
    return f"{digits}e{exponent}"
