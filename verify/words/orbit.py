"""The theorem about one orbit in words, and what was found of the orbit (section 19.5)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from flint import acb, arb

from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, Candidate
from orbitproof.verify.claim import claim_in_words, keyed_in_words, sheet_in_words, system_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text, interval_text, located
from orbitproof.verify.orbit import STABLE, UNDECIDED, UNSTABLE, Extremum, OrbitResults, OrbitTheorem, Stability

_DIGITS = 40


def orbit_in_words(theorem: OrbitTheorem) -> str:
    """The theorem, in short."""
    candidate = claim_in_words(theorem.claim)
    system, m = candidate.system, candidate.crossings
    fixed = ", ".join(candidate.parameters)
    where = f"{system.title}{f' ({fixed} as in the candidate)' if fixed else ''}"
    return (
        f"In the box there is exactly one point x of Fix(R) with P(x) in Fix(R) and {_equation(candidate)}, P the "
        f"{'Poincare map' if m == 1 else f'power {m} of the Poincare map'} of the {where} and T(x) the time from x to "
        f"P(x). Its orbit is symmetric under R and periodic with least period 2 T(x), and {_meetings(m)}. At x the "
        "derivative of these equations on Fix(R) is regular: near x the points with P(x) in Fix(R) are one regular "
        "curve, and the equation singles out x transversally. The results enclose what they name for this orbit."
        f"{_on_level(candidate)}"
    )


def _on_level(candidate: Candidate) -> str:
    system, level = candidate.system, candidate.system.fixed_level
    if level is None:
        return ""
    where = f"{system.first_integral_name or 'H'} = {exact_text(level.value)}"
    side = sheet_in_words(system)
    return f" All points are on the level {where}, those of the box with {side}; Fix(R) stands for its points there."


def _meetings(m: int) -> str:
    if m == 1:
        return "meets the section in a period at x and P(x) only"
    return f"meets the section in a period {2 * m} times, of which only x and P(x) are in Fix(R)"


def _equation(candidate: Candidate) -> str:
    equation = candidate.equation
    assert equation is not None
    if equation.quantity == HALF_PERIOD:
        left = "T(x)"
    elif equation.quantity == COORDINATE:
        left = str(equation.coordinate)
    else:
        left = f"the {candidate.system.first_integral_name or 'first integral'}"
    return f"{left} = {exact_text(equation.value)}"


def orbit_found(candidate: Candidate, found: OrbitResults) -> Iterator[str]:
    """What was found, in lines."""
    here, there = (_named(keyed_in_words(candidate.system, point)) for point in (found.point, found.other_point))
    yield f"The orbit starts at the point with {here}; the image of that point under P has {there}."
    yield f"T(x) lies in {_text(found.half_period)}, the period in {_text(found.period)}."
    if found.level is not None:
        yield f"The {system_in_words(candidate.system).first_integral_name} lies in {_text(found.level)}."
    yield from _stability(found.stability, candidate)
    for word, extremum in (("least", found.least), ("greatest", found.greatest)):
        if extremum is not None:
            yield _distance(word, extremum, found.distance_name)


def _stability(stability: Stability, candidate: Candidate) -> Iterator[str]:
    family = "at fixed parameters" if candidate.system.family_parameter is not None else "on its level"
    family += " on its level" if candidate.system.fixed_level is not None else ""
    if not stability.parameters:
        yield "Stability parameters are not enclosed."
        return
    values = "; ".join(map(_complex, stability.parameters))
    yield (
        f"The stability parameters, eigenvalues of the stability matrix, lie in: {values}. The multipliers of the "
        f"orbit {family} other than 1 and -1 are the lambda with (lambda + 1/lambda)/2 one of them that is not 1 or -1."
    )
    if stability.multipliers:
        yield f"One of each pair lambda, 1/lambda lies in: {'; '.join(map(_complex, stability.multipliers))}."
    yield {
        STABLE: "The orbit is linearly stable: these multipliers are on the unit circle and distinct.",
        UNSTABLE: "The orbit is unstable: a multiplier lies off the unit circle.",
        UNDECIDED: "Whether the orbit is linearly stable is not decided.",
    }[stability.verdict]


def _distance(word: str, extremum: Extremum, name: str) -> str:
    times = " and ".join(map(_text, extremum.times))
    if len(extremum.times) == 1:
        at = "at time 0 only" if extremum.times[0].is_zero() else f"at one time only, in {times}"
    else:
        at = f"at times among {times}"
    return (
        f"The {word} distance from {name} over the whole orbit lies in {_text(extremum.distance)}; within [0, T(x)] it "
        f"is taken {at}."
    )


def _named(point: Mapping[str, arb]) -> str:
    return ", ".join(located(name, ball, _DIGITS) for name, ball in point.items())


def _text(ball: arb) -> str:
    return interval_text(ball, _DIGITS)


def _complex(value: acb) -> str:
    if value.imag.is_zero():
        return decimal_interval(value.real, _DIGITS)
    return f"{decimal_interval(value.real, _DIGITS)} + i {decimal_interval(value.imag, _DIGITS)}"
