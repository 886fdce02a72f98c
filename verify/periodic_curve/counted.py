"""How many multipliers lie inside and outside the unit circle, along a whole curve (section 26.7)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated

from flint import arb

from orbitproof.shared.formats import PeriodicAtlas
from orbitproof.shared.stored import rules
from orbitproof.verify.claim import keeps_volume
from orbitproof.verify.curve import Chain, Interval, IntervalResult, ProvedInterval, Stretch
from orbitproof.verify.evidence import all_finite, enclose, hull, is_below, power, sign
from orbitproof.verify.functions import REACH
from orbitproof.verify.periodic import whole_state
from orbitproof.verify.periodic_curve.characteristic import MultiplierFunctions

_HALVINGS, _MOST_PARTS = 40, 64
"""A proved interval is halved so often, as long as no more parts than these are undecided."""

Number = Annotated[int, rules("number_of_multipliers", minimum=0, maximum=32)]


@dataclass(frozen=True)
class Counts:
    """How many multipliers lie where, besides those that are 1 for all orbits of their kind."""

    inside: Number
    on: Number
    outside: Number


@dataclass(frozen=True)
class CountedPart:
    """A part of a curve on which the multipliers of all orbits are counted alike, or on which they are not counted.

    Attributes:
        pieces: ids of the pieces on which it begins and ends.
        between: s of both places.
        values: enclosures of the parameter, or of the level, at both.
        all_values: contains its values at all orbits of the part.
        counts: `None` if they are not decided.
    """

    pieces: tuple[str, str]
    between: tuple[Fraction, Fraction]
    values: tuple[arb, arb]
    all_values: arb
    counts: Counts | None


def number_of_multipliers(atlas: PeriodicAtlas) -> int:
    """How many there are besides those that are 1 for all such orbits."""
    return len(atlas.system.given_state) - (2 if atlas.claim.uses_integral else 1)


def counted_along(atlas: PeriodicAtlas, chain: Chain, results: Sequence[IntervalResult]) -> tuple[CountedPart, ...]:
    """The parts of the curve in order, neighbours with other counts; none if no result knows the multipliers.

    `results`: those from which the chain was made.
    """
    known = {
        (result.piece, result.interval): result.multipliers
        for result in results
        if result.is_proved and isinstance(result.multipliers, MultiplierFunctions)
    }
    if not known:
        return ()
    found: list[CountedPart] = []
    for stretch in chain.stretches:
        for part in _parts_of(atlas, stretch, known):
            if found and found[-1].counts == part.counts:
                found[-1] = _joined(found[-1], part)
            else:
                found.append(part)
    return tuple(found)


def _joined(first: CountedPart, last: CountedPart) -> CountedPart:
    return replace(
        first,
        pieces=(first.pieces[0], last.pieces[1]),
        between=(first.between[0], last.between[1]),
        values=(first.values[0], last.values[1]),
        all_values=hull(first.all_values, last.all_values),
    )


def _parts_of(
    atlas: PeriodicAtlas, stretch: Stretch, known: dict[tuple[str, Interval], MultiplierFunctions]
) -> Iterator[CountedPart]:
    """The parts of what the curve runs along of a piece: where it may enter, then each on one proved interval."""
    tube, run = stretch.tube, stretch.run
    name, reached = tube.piece.id, stretch.entered

    def part(low: Fraction, high: Fraction, everywhere: arb, counts: Counts | None) -> CountedPart:
        at = _value(atlas, tube.point(run, low)), _value(atlas, tube.point(run, high))
        return CountedPart((name, name), (low, high), at, everywhere, counts)

    def counted(proved: ProvedInterval, *wanted: Fraction) -> Iterator[CountedPart]:
        interval = proved.start, proved.end
        for low, high, counts in _counted(atlas, known.get((name, interval)), interval, (wanted[0], wanted[1])):
            yield part(low, high, _value(atlas, tube.points(proved.deviation, low, high)), counts)

    if stretch.enters < stretch.entered:
        # Counts of a part of it may be those of orbits before the place at which the piece before is left.
        entering = [each for found in run.between(stretch.enters, stretch.entered) for each in counted(*found)]
        same = all(each.counts == entering[0].counts for each in entering)
        everywhere = hull(entering[0].all_values, *(each.all_values for each in entering[1:]))
        yield part(stretch.enters, stretch.entered, everywhere, entering[0].counts if same else None)
    for proved, start, end in run.between(stretch.entered, stretch.leaves):
        first = max(start, reached)
        if first >= end:
            continue
        yield from counted(proved, first, end)
        reached = end


def _value(atlas: PeriodicAtlas, point: Sequence[arb]) -> arb:
    """The parameter, or the level of the first integral, at points of a curve."""
    claim, program = atlas.claim, atlas.system.first_integral_program
    if claim.parameter is not None:
        return point[0]
    assert program is not None
    state = list(point)
    pivot, normal = claim.pivot, claim.normal
    across = enclose(claim.offset / normal[pivot])
    others = [entry for place, entry in enumerate(normal) if place != pivot]
    for entry, coordinate in zip(others, point, strict=True):
        across -= enclose(entry / normal[pivot]) * coordinate
    state.insert(pivot, across)
    parameters = [enclose(atlas.parameters[name]) for name in atlas.system.parameters]
    whole = whole_state(atlas.system, state, parameters)
    value: arb = program.evaluate([*whole, *parameters], enclose, power)[0]
    return value


def _counted(
    atlas: PeriodicAtlas, functions: MultiplierFunctions | None, interval: Interval, wanted: Interval
) -> list[tuple[Fraction, Fraction, Counts | None]]:
    """Intervals that cover the wanted one, in order, and the counts on each."""
    size = number_of_multipliers(atlas)
    if functions is None or len(functions.coefficients) != size:
        return [(*wanted, None)]
    enclosed = [function.enclosed for function in functions.coefficients]
    keeps_area = size == 2 and keeps_volume(atlas.system)
    middle, length = (interval[0] + interval[1]) / 2, (interval[1] - interval[0]) / 2 * REACH
    decided: list[tuple[Fraction, Fraction, Counts | None]] = []
    pending = [wanted]
    for halving in range(_HALVINGS + 1):
        open_parts = []
        for low, high in pending:
            tau = enclose((low + high) / 2 - middle) + arb(0, 1) * enclose((high - low) / 2)
            values = [function.value(tau / enclose(length)) for function in enclosed]
            counts = counts_of_pair_of_area(values[0]) if keeps_area else counts_of(values)
            if counts is None:
                open_parts.append((low, high))
            else:
                decided.append((low, high, counts))
        if halving == _HALVINGS or len(open_parts) > _MOST_PARTS:
            decided += [(low, high, None) for low, high in open_parts]
            break
        pending = [
            half for low, high in open_parts for half in ((low, (low + high) / 2), ((low + high) / 2, high))
        ]  # fmt: skip
    return sorted(decided, key=lambda part: part[:2])


def counts_of_pair_of_area(first: arb) -> Counts | None:
    """How many zeros of lambda^2 + c lambda + 1 lie where."""
    if is_below(abs(first), arb(2)):
        return Counts(0, 2, 0)
    return Counts(1, 0, 1) if is_below(arb(2), abs(first)) else None


def counts_of(coefficients: Sequence[arb]) -> Counts | None:
    """How many zeros of lambda^n + c_1 lambda^(n-1) + .. + c_n lie where, for all numbers in the balls; `None` if open.

    If they are decided, no zero lies on the circle (Lemma 26.6).
    """
    if not all_finite(coefficients):
        return None
    size, polynomial = len(coefficients), [arb(1), *coefficients]
    if size == 2 and sign(1 + coefficients[0] + coefficients[1]) * sign(1 - coefficients[0] + coefficients[1]) < 0:
        return Counts(1, 0, 1)
    # Inside are `inside` and `sides` times the zeros of the polynomial that lie inside.
    inside, sides = 0, 1
    while len(polynomial) > 1:
        first, last = polynomial[0], polynomial[-1]
        if is_below(abs(first), abs(last)):
            # The zeros of the reversed polynomial are the inverse numbers.
            inside += sides * (len(polynomial) - 1)
            polynomial, sides = polynomial[::-1], -sides
        elif not is_below(abs(last), abs(first)):
            return None
        first, last = polynomial[0], polynomial[-1]
        reduced = [first * a - last * b for a, b in zip(polynomial, reversed(polynomial), strict=True)][:-1]
        inside += sides
        polynomial = [entry / first for entry in reduced]
    return Counts(inside, 0, size - inside)
