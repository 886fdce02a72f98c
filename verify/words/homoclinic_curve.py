"""The theorem about homoclinic orbits on all levels of an interval in words, and what was found (section 42.5)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.claims.homoclinic_curve import HomoclinicCurve
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text
from orbitproof.verify.homoclinic_curve import HomoclinicCurveResults, HomoclinicCurveTheorem
from orbitproof.verify.words.formulas import free_letter
from orbitproof.verify.words.homoclinic import place_in_words, setting_on_level
from orbitproof.verify.words.periodic import integral_in_words

_DIGITS, _SHORT = 20, 10


def _letters(claim: HomoclinicCurve) -> list[str]:
    """What is called a, s, c, l, r, g, t and m, unless the system has such names."""
    return [free_letter(claim.system, letter) for letter in "asclrgtm"]


def _levels(claim: HomoclinicCurve) -> str:
    assert claim.level is not None
    ends = (exact_text(claim.level + side * claim.level_radius) for side in (-1, 1))
    return f"[{', '.join(ends)}]"


def homoclinic_curve_in_words(theorem: HomoclinicCurveTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    a, s, _, _, _, g, *_ = _letters(claim)
    named = ", ".join(keyed_in_words(claim.system, claim.parameters))
    given = f" ({named} as in the candidate)" if named else ""
    return (
        f"For every level in {_levels(claim)} of the {integral_in_words(claim.system)} of the {claim.system.title}"
        f"{given}, the box of this level contains exactly one point to which its orbit comes back at crossing "
        f"{claim.crossings} of the section, where crossings in both directions count. R maps this periodic orbit to "
        "itself, and it is hyperbolic on the level. Its unstable manifold leads from this point through the box as a "
        f"graph {s} = {g}({a}), |{g}'| at most {exact_text(claim.cone)}. Over the interval of {a} of this level, this "
        f"graph has exactly one point whose orbit is in Fix(R) at crossing {claim.arrival} from there. This orbit is "
        "homoclinic to the periodic orbit, R maps it to itself, and along it the unstable and the stable manifold "
        "intersect transversally in the level. Both orbits depend smoothly on the level. Therefore, on every such "
        "level, some iterate of the map to the next crossing has a compact invariant set on which it is conjugate to "
        "the shift on two symbols: the level has infinitely many periodic orbits, and a compact invariant set on "
        "which the flow has positive topological entropy."
    )


def homoclinic_curve_found(claim: HomoclinicCurve, found: HomoclinicCurveResults) -> Iterator[str]:
    """Levels, multipliers, and where the homoclinic orbits meet Fix(R), in short lines."""
    yield f"levels in {_levels(claim)}"
    yield f"multipliers in {decimal_interval(found.multiplier, _SHORT)}"
    yield f"the homoclinic orbits meet Fix(R) at {place_in_words(claim.middle, found.meeting, _SHORT)}"


def homoclinic_curve_in_full(
    claim: HomoclinicCurve, theorem: HomoclinicCurveTheorem, found: HomoclinicCurveResults
) -> Iterator[str]:
    """System, boxes, theorem and what was found, in lines."""
    a, s, c, slope, r, g, t, m = _letters(claim)
    one, names = claim.middle, names_in_words(claim.system)
    *lines, section = setting_on_level(one, (a, s, c, slope, r, g, t, m))
    yield from lines
    p, q, w = (names.get(name, name) for name in (one.along, one.across, one.level_coordinate))
    yield f"{section} The boxes lie where {w} is {'positive' if claim.level_sign > 0 else 'negative'}."
    assert claim.level is not None
    yield (
        f"The levels are {exact_text(claim.level)} + {exact_text(claim.level_radius)} {t}, {t} from -1 to 1. The box "
        f"of a level has the coordinates {a} and {s}: {p} = {c} + {a} + {s}, {q} = {slope} ({a} - {s}), |{a}| and "
        f"|{s}| at most {r} = {exact_text(claim.radii[0])}. The interval of {a} has the middle {m} and the half-width "
        f"{exact_text(claim.radii[1])}. {c}, {m} and {slope} are polynomials in {t}; coefficients of 1, {t}, {t}^2, ..:"
    )
    for name, row in zip((c, m, slope), claim.polynomials, strict=True):
        yield f"  {name}: {', '.join(map(exact_text, row))}"
    yield "Theorem."
    yield homoclinic_curve_in_words(theorem)
    passage, period, multiplier, time, *slopes = (
        decimal_interval(ball, _DIGITS)
        for ball in (found.passage, found.period, found.multiplier, found.time, *found.slopes)
    )
    yield (
        f"The periodic orbits meet Fix(R) at {place_in_words(one, found.point, _DIGITS)}. Periods lie in {period}, "
        f"their multipliers beyond the unit circle in {multiplier}."
    )
    yield (
        f"The homoclinic orbits have points of the graphs with {a} - {m} in {passage}, and meet Fix(R) at "
        f"{place_in_words(one, found.meeting, _DIGITS)}, times in {time} later. The derivatives of {p} and {q} there "
        f"by {a}, along the unstable manifolds, lie in {' and '.join(slopes)}."
    )
