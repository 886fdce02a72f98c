"""The theorem about Krein collisions, in words (sections 31.5 and 31.6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from operator import itemgetter

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.claim import claim_in_words, keyed_in_words
from orbitproof.verify.evidence import decimal_interval, interval_text, located
from orbitproof.verify.krein import KreinResults, KreinTheorem
from orbitproof.verify.words.breaking import at_fixed_parameter, meetings, on_level
from orbitproof.verify.words.formulas import free_letter

_DIGITS = 40


def krein_in_words(theorem: KreinTheorem) -> str:
    """The theorem, in short."""
    candidate = claim_in_words(theorem.claim)
    system, m = candidate.system, candidate.crossings
    fixed = ", ".join(candidate.parameters)
    where = f"{system.title}{f' ({fixed} as in the candidate)' if fixed else ''}"
    power = "Poincare map" if m == 1 else f"power {m} of the Poincare map"
    return (
        "In the box there is exactly one point x of Fix(R) with P(x) in Fix(R) at which the two stability parameters "
        f"of the orbit, {at_fixed_parameter(candidate)}, are equal: a Krein collision. P is the {power} of the "
        f"{where}, and the parameter is {candidate.titles[0]}. The orbit of x is symmetric under R, has the time "
        f"from x to P^2(x) as its least period, and {meetings(m)}. Its multipliers exp(i omega) and exp(-i omega) are "
        "double, on the unit circle, no roots of unity of order 1 to 4, and each has one Jordan block. The symmetric "
        "orbits next to it, one for each value of the parameter, are linearly stable on one side of the value at x; on "
        "the other side none of their four multipliers is real or on the unit circle. The coefficient "
        f"{free_letter(system, 'b')} of the normal form of order 3 of P^2 at x, (31.6) of the chapter on Krein "
        "collisions, is real and not 0."
        f"{on_level(candidate)}"
    )


def krein_found(candidate: Candidate, found: KreinResults) -> Iterator[str]:
    """What was found, in lines."""
    system = candidate.system
    here, there = (_named(keyed_in_words(system, point)) for point in (found.point, found.other_point))
    yield f"The point x has {here}; P(x) has {there}."
    parameter = claim_in_words(candidate).titles[0]
    yield f"The parameter there, {parameter}, lies in {decimal_interval(found.parameter, _DIGITS)}."
    yield f"The period of the orbit of x lies in {interval_text(found.period, _DIGITS)}."
    stable, other = ("greater", "less") if found.side == "above" else ("less", "greater")
    yield (
        f"Next to it the symmetric orbits are linearly stable for values of the parameter {stable} than that, and "
        f"their multipliers have left the unit circle for values {other} than that."
    )
    yield (
        f"The cosine of omega lies in {interval_text(found.cosine, _DIGITS)}, omega/(2 pi) in "
        f"{interval_text(found.rotation_number, _DIGITS)}. The discriminant of the stability parameters, "
        f"(s_1 - s_2)^2, has the derivative {interval_text(found.speed, _DIGITS)} by the parameter."
    )
    letter = {each: free_letter(system, each) for each in _LETTERS}
    a, b, mu, y, z = itemgetter("a", "b", "mu", "y", "z")(letter)
    yield (
        f"In the normal form {z} -> lambda ({z} + {y} + ..), {y} -> lambda ({y} + {a} {mu} {z} + {b} {z} |{z}|^2 + "
        f"..), {mu} the difference of the parameter from its value at x, {a} lies in "
        f"{interval_text(found.unfolding, _DIGITS)} and {b} in {interval_text(found.coefficient, _DIGITS)}."
    )
    yield _TYPES[found.type].format(stable=stable, other=other, **letter)


_LETTERS = ("K", "a", "b", "d", "mu", "y", "z")
"""Letters of the normal form, unless a coordinate or a parameter is called so."""

_TYPES = {
    "subcritical": (
        "The collision is subcritical, {b} > 0. There is a neighbourhood of x, the same for all values of the "
        "parameter near that at x, in which for this value and for those {other} than it only the point of the "
        "symmetric orbit stays under all forward and backward iterates of P^2, on its level or at its parameter: no "
        "other periodic orbit and no invariant curve or torus of P^2 lies in it whole. The orbit of x is not stable. "
        "For values near it that are {stable} all points that stay are within a constant times the square root of "
        "abs({mu}) of the symmetric orbit. What these are is not said."
    ),
    "supercritical": (
        "The collision is supercritical, {b} < 0. For all small {d} and abs({mu}) <= {d}^2, on both sides, the points"
        " with abs({z}) <= {d} and abs({y}) <= {d}^2 stay in abs({z}) <= {K} {d}, abs({y}) <= {K} {d}^2, with a "
        "constant {K}, for at least 1/({K} {d}^2) forward and backward iterates of P^2. "
        "Nothing is said of longer times: neither that the orbit of x is stable, nor that there are invariant curves "
        "or tori near it."
    ),
}


def _named(point: Mapping[str, arb]) -> str:
    return ", ".join(located(name, ball, _DIGITS) for name, ball in point.items())
