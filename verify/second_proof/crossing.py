"""Crossings of the section: all of them are counted, and the Poincare map follows from the k-th. README, section 4."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_series

from .flow import Step, field_of, take_step
from .jets import CannotFollow, Jet, Monomials, eliminate, monomials, precision
from .statement import Statement

DEEPEST = 40
SIGN_BITS = 96


@dataclass(frozen=True)
class Trajectory:
    """Jets of the state at the crossings 1, .., k of the section, the times of these, and the number of steps."""

    states: list[list[Jet]]
    times: list[arb]
    steps: int


def sign_of(value: arb) -> int:
    """1 or -1 if the sign is certain, 0 otherwise."""
    return 1 if value > 0 else -1 if value < 0 else 0


def crossing_pieces(step: Step, sign: int, end: arb) -> tuple[list[tuple[arb, arb]], int]:
    """Intervals that hold exactly one crossing each, in order; there is no other one in (0, end]; the sign at the end.

    `sign` is that of the section coordinate at time 0; 0 says that it vanishes there exactly.
    """
    found: list[tuple[arb, arb]] = []
    todo = [(arb(0), end, 0)]
    with precision(SIGN_BITS):
        while todo:
            a, b, depth = todo.pop()
            span = arb((a + b) / 2, ((b - a) / 2).upper()).union(a).union(b)
            whole = sign_of(step.section(span))
            if whole:
                if whole != sign:
                    raise CannotFollow("the sign of the section coordinate contradicts the crossings counted")
                continue
            slope = sign_of(step.section_slope(span))
            if not slope:
                if depth == DEEPEST:
                    raise CannotFollow("the orbit may touch the section")
                middle = ((a + b) / 2).mid()
                todo += [(middle, b, depth + 1), (a, middle, depth + 1)]
                continue
            after = slope if sign == 0 else sign_of(step.section(b))
            if after == 0:
                raise CannotFollow("a crossing next to the end of a piece")
            if sign not in (0, after):
                found.append((a, b))
            sign = after
    return found, sign


def crossing_state(statement: Statement, step: Step, piece: tuple[arb, arb], table: Monomials) -> tuple[list[Jet], arb]:
    """Jets of the state where the section is crossed in `piece`, and the crossing time within the step."""
    guess = ((piece[0] + piece[1]) / 2).mid()
    for _ in range(200):
        better = (guess - (step.section(guess) / step.section_slope(guess)).mid()).mid()
        better = min(max(better, piece[0]), piece[1])
        if better == guess or abs(better - guess) < abs(step.section(guess).rad()):
            break
        guess = better
    value, moment = step.section(guess), piece[0].union(piece[1])
    for _ in range(4):
        # Mean value theorem between the guess and the crossing.
        moment = guess - value / step.section_slope(moment.union(guess))
    if not (moment.is_finite() and moment > 0 and moment <= step.duration):
        raise CannotFollow("the crossing time is not enclosed in its step")
    base = step.at(moment)
    local = [[None if c is None else arb_series([c], prec=table.degree + 1) for c in jet] for jet in base]
    motion = local
    for _ in range(table.degree):
        field = field_of(statement, table, motion)
        motion = [
            [_antiderivative(c, f, table.degree + 1) for c, f in zip(*pair, strict=True)]
            for pair in zip(local, field, strict=True)
        ]
    larger = monomials(table.variables + 1, table.degree)
    jets: list[Jet] = []
    for jet in motion:
        big: Jet = [None] * len(larger.exponents)
        for i, a in enumerate(larger.exponents):
            series = jet[table.index[a[:-1]]]
            big[i] = None if series is None else series[a[-1]]
        jets.append(big)
    return eliminate(larger, jets[statement.section], jets), moment


def _antiderivative(start: arb_series | None, slope: Any, length: int) -> arb_series | None:
    if slope is None:
        return start
    slope = slope if isinstance(slope, arb_series) else arb_series([slope], prec=length)
    total = slope.integral() if start is None else slope.integral() + start
    return arb_series(total.coeffs()[:length], prec=length)


def follow(
    statement: Statement,
    start: Sequence[Jet],
    table: Monomials,
    crossings: int,
    bits: int,
    deadline: float | None = None,
    report: Callable[[int, float], None] | None = None,
) -> Trajectory:
    """Follow jets from the section to its crossing number `crossings`. Raises `CannotFollow`."""
    state, sign, now, guess, steps = [list(jet) for jet in start], 0, arb(0), arb("0.125"), 0
    before = field_of(statement, table, state, statement.integral)[0]
    states: list[list[Jet]] = []
    times: list[arb] = []
    while len(states) < crossings:
        if deadline is not None and time.monotonic() > deadline:
            raise CannotFollow(f"time is up after {steps} steps, at crossing {len(states)} of {crossings}")
        step, guess = take_step(statement, state, table, guess, bits)
        end, steps = step.duration, steps + 1
        while not sign_of(step.section(end)):
            end = (end * 7 / 8).mid()
            if end < step.duration / 16:
                raise CannotFollow("no step ends away from the section")
        pieces, sign = crossing_pieces(step, sign, end)
        for piece in pieces[: crossings - len(states)]:
            found, moment = crossing_state(statement, step, piece, table)
            after = field_of(statement, table, found, statement.integral)[0]
            if not all(
                (arb(0) if a is None else a).overlaps(arb(0) if b is None else b)
                for a, b in zip(before, after, strict=True)
            ):
                raise CannotFollow("the first integral is not kept: no first integral, or an error")
            states.append(found)
            times.append(now + moment)
        state, now = step.at(end), now + end
        if report is not None:
            report(len(states), float(now))
    return Trajectory(states, times, steps)
