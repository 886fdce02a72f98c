"""The theorem about a curve of periodic orbits without symmetry in words (section 26.5)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flint import arb

from orbitproof.shared.formats import PeriodicAtlas
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.evidence import decimal_interval, exact_text, interval_text, range_text
from orbitproof.verify.periodic import periods_of_force
from orbitproof.verify.periodic_curve import (
    CountedPart,
    Counts,
    PeriodicCurveTheorem,
    ProvedPeriodicCurve,
    Turn,
    number_of_multipliers,
)
from orbitproof.verify.words.formulas import equations
from orbitproof.verify.words.periodic import (
    FORCE_TURNS,
    exactly_in_words,
    field_in_lines,
    integral_in_words,
    linear_in_words,
    program_in_words,
)

_DIGITS = 18
_TAKEN = ("c", "f", "h", "i", "j", "m", "s", "u")
"""Letters of theorems, which no formula has for a part of it."""


def periodic_curve_in_words(theorem: PeriodicCurveTheorem, curve: ProvedPeriodicCurve) -> str:
    """What is proved of the curve."""
    atlas, claim, system = theorem.atlas, theorem.atlas.claim, theorem.atlas.system
    names, m = names_in_words(system), claim.crossings
    ends = {key: keyed_in_words(system, point) for key, point in curve.ends.items()}
    coordinates = ", ".join(names.get(name, name) for name in atlas.coordinates)
    first, last = _point(ends["start"]), _point(ends["end"])
    simple = " without self-intersections" if claim.increasing or claim.is_closed else ""
    closed = " closed" if claim.is_closed else ""
    way = f"through {first}" if claim.is_closed else f"from {first} to {last}"
    times = "exactly once" if m == 1 else f"in exactly {m} points"
    level = "" if claim.level is None else " of that level"
    beyond = "" if claim.is_closed else " and, next to its ends, of its continuation"
    paragraphs = [
        f"{_setting(atlas)}\nThere is a smooth{closed} curve{simple} in the coordinates ({coordinates}) {way}. The "
        f"orbit of each of its points is periodic, and within its least period it crosses the section in the "
        f"direction of the atlas {times}; the point comes back to itself at crossing number {m}.{_level(atlas)} Near "
        f"it there are no other points of such orbits{level} but those of the curve{beyond}."
    ]
    if claim.increasing:
        grow = "increases" if len(claim.increasing) == 1 else "increase"
        listed = " and ".join(names.get(name, name) for name in claim.increasing)
        paragraphs.append(f"Along it {listed} {grow} strictly.")
    if claim.covers is not None:
        name = names.get(claim.covers.coordinate, claim.covers.coordinate)
        low, high = exact_text(claim.covers.start), exact_text(claim.covers.end)
        paragraphs.append(f"Along it {name} takes all values from {low} to {high}.")
    if claim.parameter is not None:
        paragraphs += turns_in_words(names.get(claim.parameter, claim.parameter), curve.turns, bool(claim.increasing))
    if curve.period.is_finite():
        paragraphs.append(f"All least periods lie in {range_text(curve.period, 4)}.")
        known = periods_of_force(system, atlas.parameters, curve.ends["start"], curve.period)
        if known is not None:
            paragraphs.append(f"Each is {exactly_in_words(known)}{FORCE_TURNS}")
    paragraphs += _multipliers(atlas, names.get(claim.parameter or "", claim.parameter or ""), curve.multipliers)
    paragraphs.append("That there are no other periodic orbits nearby, with other numbers of crossings, is not said.")
    return "\n".join(paragraphs)


def periodic_curve_in_full(atlas: PeriodicAtlas, statement: str) -> str:
    """The statement so that it stands alone: the system in formulas before it."""
    system, names = atlas.system, names_in_words(atlas.system)
    lines, taken = field_in_lines(system, _TAKEN)
    lines += [f"  {name} = {exact_text(value)}" for name, value in keyed_in_words(system, atlas.parameters).items()]
    if names:
        called = ", ".join(f"{new} is called {name}" for name, new in names.items())
        lines.append(f"In the description of the system {called}, which has another meaning here.")
    if atlas.claim.uses_integral and system.first_integral_program is not None:
        lines.append(f"A first integral, the {integral_in_words(system)}:")
        lines += [
            f"  {line}" for line in equations(program_in_words(system, system.first_integral_program), ["H"], taken)
        ]
    return "\n".join([*lines, "Theorem.", statement])


def _setting(atlas: PeriodicAtlas) -> str:
    claim, system = atlas.claim, atlas.system
    names = names_in_words(system)
    given = ", ".join(
        f"{name} = {exact_text(value)}" for name, value in keyed_in_words(system, atlas.parameters).items()
    )
    word = "grows" if claim.direction > 0 else "falls"
    state = [names.get(name, name) for name in system.given_state]
    plane = f"{linear_in_words(claim.normal, state)} = {exact_text(claim.offset)}"
    return (
        f"Consider the {system.title}{f' with {given}' if given else ''}, and the section of all points with {plane}; "
        f"it is crossed in the direction of the atlas where the left side {word} in time."
    )


def _level(atlas: PeriodicAtlas) -> str:
    claim = atlas.claim
    if claim.level is not None:
        return f" All orbits have {integral_in_words(atlas.system)} = {exact_text(claim.level)}."
    return "" if claim.parameter is not None else f" The {integral_in_words(atlas.system)} varies along the curve."


def turns_in_words(name: str, turns: Sequence[Turn], embedded: bool) -> Iterator[str]:
    """Where the parameter has extrema; `embedded`: whether the curve is known to meet none of its points again."""
    if not turns:
        return
    maxima = sum(turn.is_maximum for turn in turns)
    if embedded or max(maxima, len(turns) - maxima) == 1:
        has = f"has at least {'one extremum' if len(turns) == 1 else f'{len(turns)} extrema'}"
    else:
        has = "has extrema, some of which are listed more than once if the curve runs through parts of itself again"
    listed = "; ".join(
        f"a {'maximum' if turn.is_maximum else 'minimum'} between a point with {name} in "
        f"{interval_text(turn.values[0], _DIGITS)} and one with {name} in {interval_text(turn.values[1], _DIGITS)}"
        for turn in turns
    )
    yield f"Along it {name} {has}: {listed}."


def _multipliers(atlas: PeriodicAtlas, parameter: str, parts: Sequence[CountedPart]) -> Iterator[str]:
    """How many lie where, part after part."""
    if not parts:
        return
    size, is_level = number_of_multipliers(atlas), atlas.claim.uses_integral
    name = parameter or integral_in_words(atlas.system)
    trivial = "two multipliers that are 1" if is_level else "the multiplier 1 of the direction of the flow"
    head = f"Besides {trivial} each orbit has {size} {'other' if size == 1 else 'others'}"
    if len(parts) == 1:
        (part,) = parts
        said = (
            "how many of them lie inside and outside the unit circle is not decided"
            if part.counts is None
            else f"for every orbit of the curve {_where(part.counts, size, is_level)}"
        )
        yield f"{head}; {said}."
        return
    lines = [f"{head}. From the beginning of the curve to its end:"]
    for place, part in enumerate(parts):
        if part.counts is not None:
            first, last = (interval_text(value, _DIGITS) for value in part.values)
            lines.append(f"from {name} in {first} to {name} in {last}, {_where(part.counts, size, is_level)};")
            continue
        near = [other.counts for other in parts[max(0, place - 1) : place + 2] if other is not part]
        differ = len(near) == 2 and near[0] != near[1]
        crossed = "; as the numbers on both sides differ, an orbit there has one on the circle" if differ else ""
        lines.append(f"for {name} in {interval_text(part.all_values, _DIGITS)} it is not decided{crossed};")
    yield "\n".join([*lines[:-1], f"{lines[-1][:-1]}."])


def _where(counts: Counts, size: int, is_level: bool) -> str:
    on = f", {counts.on} on" if counts.on else ""
    attracts = counts.inside == size and not is_level
    what = ": asymptotically stable orbits" if attracts else ": unstable orbits" if counts.outside else ""
    return f"{counts.inside} inside{on}, {counts.outside} outside the unit circle{what}"


def _point(point: Mapping[str, arb]) -> str:
    return f"({', '.join(decimal_interval(ball, _DIGITS) for ball in point.values())})"
