"""Extrema of the stability parameters from three certified orbits beside each of them (section 18.10)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from flint import arb

from orbitproof.shared.systems import shown
from orbitproof.verify.curve import Bifurcation
from orbitproof.verify.evidence import EmptyIntersectionError, enclose, hull, is_below, is_positive
from orbitproof.verify.stability.extrema import BAND, is_in_band
from orbitproof.verify.stability.list_entries import Extremum, Gap, Segment


@dataclass(frozen=True)
class _Orbit:
    """A certified orbit on a segment.

    Attributes:
        s: encloses its s.
        parameters: its real stability parameters, certainly in increasing order.
    """

    id: str
    s: arb
    parameters: tuple[arb, ...]


@dataclass(frozen=True)
class _Turn:
    """A stability parameter is stationary within `s`, with a value in `value`."""

    s: arb
    value: arb
    certificates: tuple[str, ...]


def between_orbits(
    extrema: Sequence[Extremum],
    gaps: Sequence[Gap],
    segments: Sequence[Segment],
    pieces: Sequence[str],
    certified: Sequence[Bifurcation],
) -> tuple[Extremum, ...]:
    """The extrema; those between three certified orbits with what these show of them (Lemma 18.6).

    Args:
        gaps: where there may be extrema that are not listed.
        pieces: ids, of the pieces of the stretches.
        certified: certificates with their places on the curve.

    Raises `EmptyIntersectionError` if the orbits contradict the functions on the curve, or the list.
    """
    result = list(extrema)
    for segment in segments:
        for turn in _turns(segment, _orbits_on(segment, pieces[segment.stretch], certified)):
            here = [i for i, e in enumerate(result) if e.stretch == segment.stretch and e.s.overlaps(turn.s)]
            is_open = any(gap.stretch == segment.stretch and _meets(gap, turn.s) for gap in gaps)
            names = ", ".join(map(shown, turn.certificates))
            if not here and not is_open:
                raise EmptyIntersectionError(f"{names} show an extremum that the list does not have")
            if len(here) == 1 and not is_open:
                result[here[0]] = _narrowed(result[here[0]], turn, segment)
    return tuple(result)


def _orbits_on(segment: Segment, piece: str, certified: Sequence[Bifurcation]) -> list[_Orbit]:
    """The certified orbits on a segment with real stability parameters in a known order, by s."""
    found = []
    for entry in certified:
        place, values = entry.place, [value.real for value in entry.stability]
        if not entry.is_of_orbit or place is None or place.piece != piece or not _is_within(place.s, segment):
            continue
        if len(values) != len(segment.characteristic) or not all(value.imag.is_zero() for value in entry.stability):
            continue
        values.sort(key=lambda value: float(value.mid()))
        if not sum(values[1:], values[0]).overlaps(segment.characteristic[0].value(segment.tau_of(place.s))):
            raise EmptyIntersectionError(
                f"{shown(entry.id)} has other stability parameters than the orbits of the curve there"
            )
        if all(is_below(low, high) for low, high in pairwise(values)):
            found.append(_Orbit(entry.id, place.s, tuple(values)))
    return sorted(found, key=lambda orbit: float(orbit.s.mid()))


def _is_within(s: arb, segment: Segment) -> bool:
    return is_below(enclose(segment.entered), s) and is_below(s, enclose(segment.end))


def _turns(segment: Segment, orbits: Sequence[_Orbit]) -> Iterator[_Turn]:
    """Stationary values in the band between neighbouring orbits, one of which is above or below both others."""
    for before, at, after in zip(orbits, orbits[1:], orbits[2:], strict=False):
        if not (is_below(before.s, at.s) and is_below(at.s, after.s)):
            continue
        whole = hull(before.s, after.s)
        width = (after.s - before.s) / enclose(segment.radius)
        for number, bend in enumerate(_bends(segment, segment.tau_of(whole))):
            first, value, last = (orbit.parameters[number] for orbit in (before, at, after))
            is_low = is_below(value, first) and is_below(value, last)
            is_high = is_below(first, value) and is_below(last, value)
            bound = (abs(bend) * width * width / 2).upper()
            if (is_low or is_high) and bound.is_finite():
                value = value + arb(0, 1) * bound
                if is_below(abs(value), enclose(BAND)):
                    yield _Turn(whole, value, (before.id, at.id, after.id))


def _bends(segment: Segment, part: arb) -> list[arb]:
    """Second derivatives of the stability parameters, in increasing order; none if they may meet on the part."""
    trace, *others = segment.characteristic
    if not others:
        return [trace.curvature(part)]
    (second,) = others
    total, slope, bend = trace.value(part), trace.slope(part), trace.curvature(part)
    discriminant = total * total - 4 * second.value(part)
    if not is_positive(discriminant):
        return []
    result = []
    for root in (-discriminant.sqrt(), discriminant.sqrt()):
        value = (total + root) / 2
        rate = (slope * value - second.slope(part)) / root
        result.append((bend * value + 2 * slope * rate - second.curvature(part) - 2 * rate * rate) / root)
    return result


def _narrowed(entry: Extremum, turn: _Turn, segment: Segment) -> Extremum:
    try:
        s, value = entry.s.intersection(turn.s), entry.value.intersection(turn.value)
    except ValueError:
        names = ", ".join(map(shown, turn.certificates))
        raise EmptyIntersectionError(f"{names} show another extremum than the list has there") from None
    tau = segment.tau_of(s)
    return replace(
        entry,
        s=s,
        value=value,
        in_band=is_in_band(value),
        level=segment.level.value(tau),
        half_period=segment.half_period.value(tau),
        certificates=tuple(dict.fromkeys((*entry.certificates, *turn.certificates))),
    )


def _meets(gap: Gap, s: arb) -> bool:
    return not is_below(s, enclose(gap.start)) and not is_below(enclose(gap.end), s)
