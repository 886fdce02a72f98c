"""The theorem about a bifurcation of periodic orbits in words, and what was found of it (section 25.8)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text, located
from orbitproof.verify.periodic_bifurcation import PeriodicBifurcationResults, PeriodicBifurcationTheorem
from orbitproof.verify.words.periodic import (
    force_in_full,
    integral_in_words,
    linear_in_words,
    multipliers_in_words,
    setting_in_section,
)

_DIGITS = 40
_OTHER = {"above": "below", "below": "above"}


def periodic_bifurcation_in_words(theorem: PeriodicBifurcationTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    system, m, varying = claim.system, claim.crossings, varying_in_words(claim)
    fixed = {name: value for name, value in claim.parameters.items() if name != claim.parameter}
    named = ", ".join(keyed_in_words(system, fixed))
    flow = f"under the flow of the {system.title}{f' ({named} as in the candidate)' if named else ''}"
    on_level, restricted = "", ""
    if claim.level is not None:
        value = f" = {exact_text(claim.level)}" if claim.parameter is not None else ""
        on_level = f", on a level of the {integral_in_words(claim.system)}{value}"
        restricted = ", restricted to the level,"
    crossing = f"crossing number {m} of the section in the direction of the candidate"
    comes = f"at which the point comes back to itself at {crossing}"
    if claim.is_mirrored:
        comes = f"at which S, the symmetry of the candidate, takes {crossing} after the point to the point"
    multiplier = 1 if claim.is_fold else -1
    return (
        f"In the box, which lies in the section, and in the interval of {varying} there are exactly one point and one "
        f"value of {varying} {comes}{on_level}, {flow}, and the derivative of this map at the point{restricted} has "
        f"the eigenvalue {multiplier}. {_what_happens(claim)} How far these orbits reach is not said, nor whether the "
        "box contains bifurcations of periodic orbits with another number of crossings. The results enclose what they "
        "name."
    )


def _what_happens(claim: PeriodicBifurcation) -> str:
    m, varying = claim.crossings, varying_in_words(claim)
    near = "" if claim.level is None else " of the level"
    side = f"or values of {varying} near it, on the side that the results name"
    crosses = f"crosses the section in that direction {'once' if m == 1 else f'in {m} points'} in its least period."
    if claim.is_fold:
        return (
            f"The orbit of the point is periodic and {crosses} It is a fold of periodic orbits: f{side}, exactly two "
            f"points{near} near the point come back to themselves at that crossing, and they are on two periodic "
            "orbits, each with as many crossings in its least period; for values near it on the other side none does."
        )
    if not claim.is_mirrored:
        return (
            f"The orbit of the point is periodic and {crosses} It continues as a periodic orbit for values of "
            f"{varying} on both sides. F{side}, exactly one further periodic orbit{near} passes near the point whose "
            f"points there come back to themselves at crossing number {2 * m}; it crosses the section in that "
            f"direction in {2 * m} points in its least period, which is near twice that of the orbit. For values "
            "near it on the other side there is none."
        )
    return (
        "The orbit of the point is periodic, and S maps it to itself. It continues as such an orbit for values of "
        f"{varying} on both sides. F{side}, exactly two further periodic orbits{near} pass near the point whose points "
        f"there come back to themselves at crossing number {2 * m}; S maps one to the other and neither to itself, and "
        "their least periods are near that of the orbit. For values near it on the other side there are none."
    )


def varying_in_words(claim: PeriodicBifurcation) -> str:
    """What varies, as the theorem calls it."""
    if claim.parameter is None:
        return "the level of H"
    return names_in_words(claim.system).get(claim.parameter, claim.parameter)


def periodic_bifurcation_in_full(
    claim: PeriodicBifurcation, theorem: str, found: PeriodicBifurcationResults
) -> Iterator[str]:
    """System, section, box, interval, symmetry, theorem and what was found, in lines."""
    yield from setting_with_interval(claim)
    yield "Theorem."
    yield theorem
    yield from periodic_bifurcation_found(claim, found)


def setting_with_interval(claim: PeriodicBifurcation) -> Iterator[str]:
    """System, section, box, interval and symmetry, in lines."""
    yield from setting_in_section(claim)
    middle = claim.level if claim.parameter is None else claim.parameters[claim.parameter]
    assert middle is not None
    yield (
        f"The interval of {varying_in_words(claim)}: all values that differ from {exact_text(middle)} by at most "
        f"{exact_text(claim.parameter_radius)}."
    )
    if claim.parameter is not None and claim.level is not None:
        yield f"All is on the level H = {exact_text(claim.level)}."
    if claim.symmetry is not None:
        state = [names_in_words(claim.system).get(name, name) for name in claim.system.given_state]
        image = ", ".join(linear_in_words(row, state) for row in claim.symmetry)
        yield f"The symmetry S maps ({', '.join(state)}) to ({image})."


def periodic_bifurcation_found(claim: PeriodicBifurcation, found: PeriodicBifurcationResults) -> Iterator[str]:
    """What was found, in lines."""
    varying = varying_in_words(claim)
    place = ", ".join(located(name, ball, _DIGITS) for name, ball in keyed_in_words(claim.system, found.point).items())
    yield f"The bifurcation is where {located(varying, found.parameter, _DIGITS)}; its point has {place}."
    yield f"The least period of its orbit lies in {decimal_interval(found.period, _DIGITS)}."
    yield from force_in_full(claim, found.point, found.period, found.parameter)
    if found.is_fixed is not None:
        moved = f"S moves the orbit by half its period; it crosses the section in {2 * claim.crossings} points."
        yield "The orbit lies in the fixed set of S." if found.is_fixed else moved
    yield from multipliers_in_words(found.multipliers, found.known)
    yield f"The new orbits are at values of {varying} {found.side} that of the bifurcation."
    yield (
        f"Along them {varying} changes by kappa eta^2 and terms of higher order, where eta = w . (p - p*)/(w . w) with "
        "the vector w that the candidate calls kernel, the coordinates p of their points in the box, and those of the "
        f"bifurcation, p*; kappa lies in {decimal_interval(found.opening, _DIGITS)}."
    )
    if found.criticality is not None:
        where = "outside" if found.criticality == "supercritical" else "inside"
        yield (
            f"The bifurcation is {found.criticality}: the new orbits are where the multiplier of the old one that "
            f"passes through {found.known} is {where} the unit circle."
        )
    yield from _stability(claim, found)


def _stability(claim: PeriodicBifurcation, found: PeriodicBifurcationResults) -> Iterator[str]:
    if not found.multipliers.is_attracting:
        return
    here, there = found.side, _OTHER[found.side]
    if claim.is_fold:
        yield "Near the bifurcation one of the two orbits is asymptotically stable, and the other is unstable."
    elif found.criticality == "supercritical":
        yield (
            "Near the bifurcation the new orbits are asymptotically stable; the old one is asymptotically stable "
            f"{there} the value and unstable {here} it."
        )
    elif found.criticality == "subcritical":
        yield (
            "Near the bifurcation the new orbits are unstable; the old one is asymptotically stable "
            f"{here} the value and unstable {there} it."
        )
