"""The crossing of the section that ends a half orbit: found, counted, and the Poincare map there. README, section 4."""

from __future__ import annotations

import time
from collections.abc import Sequence

from flint import arb

from .flow import Step, field_of, take_step
from .jets import CannotFollow, Exponents, Jet, add, implicit, precision, substitute, unit, varying
from .statement import Statement

DEEPEST, SIGN_BITS = 40, 96


def sign_of(value: arb) -> int:
    """1 or -1 if the sign is certain, 0 otherwise."""
    return 1 if value > 0 else -1 if value < 0 else 0


def first_crossing(
    step: Step, zero: Exponents, section: int, sign: int, begin: arb, end: arb
) -> tuple[tuple[arb, arb] | None, int]:
    """An interval with the first zero of the section coordinate in (begin, end], or None; the sign after it.

    `sign` is that of the coordinate at `begin`; 0 says that it vanishes there exactly.
    """
    height = step.polynomials[section][zero]
    todo = [(begin, end, 0)]
    with precision(SIGN_BITS):
        while todo:
            a, b, depth = todo.pop()
            span = a.union(b)
            whole = sign_of(height(span))
            if whole:
                if whole != sign:
                    raise CannotFollow("the sign of the section coordinate contradicts what was followed")
                continue
            slope = sign_of(step.section_slope(span))
            if not slope:
                if depth == DEEPEST:
                    raise CannotFollow("the orbit may touch the section")
                middle = ((a + b) / 2).mid()
                todo += [(middle, b, depth + 1), (a, middle, depth + 1)]
                continue
            after = slope if sign == 0 else sign_of(height(b))
            if after == 0:
                raise CannotFollow("a crossing next to the end of a piece")
            if sign not in (0, after):
                return (a, b), after
            sign = after
    return None, sign


def crossing_state(
    statement: Statement, step: Step, piece: tuple[arb, arb], zero: Exponents, degree: int
) -> tuple[list[Jet], arb]:
    """Jets of the state where the section is crossed in `piece`, and the crossing time within the step."""
    height, size, section = step.polynomials[statement.section][zero], len(zero), statement.section
    guess = ((piece[0] + piece[1]) / 2).mid()
    for _ in range(60):
        guess = min(max((guess - height(guess) / step.section_slope(guess)).mid(), piece[0]), piece[1])
    value, moment = height(guess), piece[0].union(piece[1])
    for _ in range(4):
        # Mean value theorem between the guess and the crossing.
        moment = guess - value / step.section_slope(moment.union(guess))
    if not (moment.is_finite() and moment > 0 and moment <= step.duration):
        raise CannotFollow("the crossing time is not enclosed in its step")
    # One more variable: time counted from the crossing.
    base: list[Jet] = [{(*a, 0): c for a, c in jet.items()} for jet in step.at(moment)]
    motion = base
    for _ in range(degree):
        field = field_of(statement, motion, (*zero, 0), degree)
        motion = [
            add(start, {(*a[:-1], a[-1] + 1): c / (a[-1] + 1) for a, c in f.items() if sum(a) < degree})
            for start, f in zip(base, field, strict=True)
        ]
    inner = [{unit(size, i): arb(1)} for i in range(size)] + implicit([motion[section]], size, degree)
    state = [add({zero: jet.get((*zero, 0), arb(0))}, substitute(varying(jet), inner, zero, degree)) for jet in motion]
    state[section] = {}
    return state, moment


def follow(
    statement: Statement,
    start: Sequence[Jet],
    zero: Exponents,
    degree: int,
    bits: int,
    deadline: float | None = None,
) -> tuple[list[Jet], arb, int]:
    """Jets of the state at the crossing after the start on the section that is claimed, its time, the number of steps.

    At the crossings before it no orbit is in Fix(R).
    """
    state, sign, now, guess, steps, left = list(start), 0, arb(0), arb(1) / 2, 0, statement.crossings
    while True:
        if deadline is not None and time.monotonic() > deadline:
            raise CannotFollow(f"time is up after {steps} steps, at time {float(now):.4f}")
        step, guess = take_step(statement, state, zero, degree, guess, bits)
        end, steps = step.duration, steps + 1
        while not sign_of(step.polynomials[statement.section][zero](end)):
            end = (end * 7 / 8).mid()
            if end < step.duration / 16:
                raise CannotFollow("no step ends away from the section")
        piece, sign = first_crossing(step, zero, statement.section, sign, arb(0), end)
        while piece is not None:
            found, moment = crossing_state(statement, step, piece, zero, degree)
            left -= 1
            if left == 0:
                return found, now + moment, steps
            if not any(sign_of(found[i].get(zero, arb(0))) for i in statement.kernel):
                raise CannotFollow("the half orbit may end before the crossing that is claimed")
            piece, sign = first_crossing(step, zero, statement.section, sign, piece[1], end)
        state, now = step.at(end), now + end
