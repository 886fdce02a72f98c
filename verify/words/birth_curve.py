"""The theorem about a curve of orbits from their birth on in words (section 38.6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb

from orbitproof.shared.systems import AMPLITUDE, own_name
from orbitproof.verify.birth_curve import BirthCurveTheorem, ProvedBirthCurve
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.equilibrium.spectrum import Spectrum
from orbitproof.verify.evidence import decimal_interval, exact_text, interval_text, is_below, range_text
from orbitproof.verify.words.periodic_curve import turns_in_words

_DIGITS = 18


def birth_curve_in_words(theorem: BirthCurveTheorem, curve: ProvedBirthCurve) -> str:
    """What is proved of the curve."""
    atlas, claim, system = theorem.atlas, theorem.atlas.claim, theorem.atlas.system
    names = names_in_words(system)
    varying, section, amplitude = (names.get(x, x) for x in (claim.parameter, claim.section, claim.amplitude))
    given_state = system.given_state
    state = ", ".join(names.get(name, name) for name in given_state)
    first, last = curve.ends["start"], curve.ends["end"]
    given = ", ".join(
        f"{name} = {exact_text(value)}" for name, value in keyed_in_words(system, atlas.parameters).items()
    )
    begins, ends = (
        f"{varying} = {decimal_interval(each[claim.parameter], _DIGITS)} with the equilibrium "
        f"{_point([each[name] for name in given_state])}"
        for each in (first, last)
    )
    where, beside = "At every other point", " but those of its continuation next to its ends"
    shrink = (
        f"is 0 where the curve begins and {decimal_interval(last[AMPLITUDE], _DIGITS)} where it ends. Towards its "
        "beginning the orbits shrink to the equilibrium, and their least periods tend to 2 pi/omega"
    )
    closing = f" and the orbit through {_point(_crossing(theorem, last))}."
    if curve.pair_at_end is not None:
        where, beside = "At every point between the ends", ""
        shrink = (
            "is 0 at both ends of the curve. Towards each of them the orbits shrink to the equilibrium there, and "
            "their least periods tend to 2 pi/omega, with omega as there"
        )
        closing = f", to which the orbits shrink.{_pair(varying, *curve.pair_at_end)}"
    paragraphs = [
        f"Consider the {system.title}{f' with {given}' if given else ''}.\nThere is a smooth curve without "
        f"self-intersections of values of {varying}, equilibria ({state}) and periodic orbits. It begins at {begins}."
        f"{_pair(varying, curve.frequency, curve.eigenvalues)}",
        f"{where} of the curve the orbit is periodic. In its least period it crosses the plane where "
        f"{section} is that of the equilibrium exactly once in the direction in which {section} "
        f"{'grows' if claim.direction > 0 else 'falls'}, and it does so where {amplitude} is greater than that of the "
        f"equilibrium. The difference, the amplitude, {shrink}. In the coordinates of the atlas, {varying}, "
        "the amplitude, the equilibrium, and the point of the orbit less the equilibrium in units of the amplitude, "
        f"there are no other such orbits near the curve{beside}.",
        f"The curve ends at {ends}{closing}",
    ]
    start, end = first[claim.parameter], last[claim.parameter]
    if is_below(start, end) or is_below(end, start):
        paragraphs.append(f"For every value of {varying} between its two ends there is such an orbit on the curve.")
    paragraphs += turns_in_words(varying, curve.turns, True)
    if curve.period.is_finite():
        paragraphs.append(f"All least periods lie in {range_text(curve.period, 4)}.")
    paragraphs.append("That there are no other periodic orbits nearby, with other numbers of crossings, is not said.")
    return "\n".join(paragraphs)


def _crossing(theorem: BirthCurveTheorem, end: Mapping[str, arb]) -> list[arb]:
    """The point of the orbit on the plane, c + eps y."""
    claim, known = theorem.atlas.claim, end
    exact = {claim.section: arb(0), claim.amplitude: arb(1)}
    return [
        known[name] + known[AMPLITUDE] * (exact[name] if name in exact else known[own_name(f"along {name}")])
        for name in theorem.atlas.system.given_state
    ]


def _pair(varying: str, omega: arb, others: Spectrum) -> str:
    """The eigenvalues where orbits are born."""
    said = (
        f" There the derivative of the vector field has the simple eigenvalues i omega and -i omega, omega in "
        f"{interval_text(omega, _DIGITS)}, and no other eigenvalue is a multiple of i omega, 0 included. While "
        f"{varying} changes, the real part of this pair changes with a speed that is not 0, as Hopf's theorem takes it."
    )
    left, right, open_ones = others.left, others.right, others.undecided
    if not left + right + open_ones:
        return said
    more = f", of {open_ones} it is not decided" if open_ones else ""
    have = "has" if left == 1 else "have"
    return f"{said} Of the other eigenvalues {left} {have} a negative and {right} a positive real part{more}."


def _point(balls: Sequence[arb]) -> str:
    return f"({', '.join(decimal_interval(ball, _DIGITS) for ball in balls)})"
