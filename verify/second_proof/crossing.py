"""The crossing of the section that ends a half orbit: found, counted, and the Poincare map there. README, section 4."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from .flow import Field, Step, take_step
from .jets import CannotFollow, Jet, implicit, joined, precision, substitute
from .statement import Statement

DEEPEST, SIGN_BITS, NEWTON_STEPS = 40, 96, 16
TIME = -1
"""Number of the variable that is time."""


def sign_of(value: arb) -> int:
    """1 or -1 if the sign is certain, 0 otherwise."""
    return 1 if value > 0 else -1 if value < 0 else 0


def first_crossing(step: Step, section: int, sign: int, begin: arb, end: arb) -> tuple[tuple[arb, arb] | None, int]:
    """An interval with the first zero of the section coordinate in (begin, end], or None; the sign after it.

    `sign` is that of the coordinate at `begin`; 0 says that it vanishes there exactly.
    """
    height = step.polynomials[section][()]
    todo = [(begin, end, 0)]
    with precision(SIGN_BITS):
        while todo:
            a, b, depth = todo.pop()
            span = a.union(b)
            if whole := sign_of(height(span)):
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


def moving(field: Field, start: Sequence[Jet]) -> list[Jet]:
    """Jets of the solution from a time on that are jets of it there, with `TIME` as one more variable."""
    motion, degree = list(start), start[0].degree
    for _ in range(degree):
        paths = [
            {joined(a, (TIME,)): c / (a.count(TIME) + 1) for a, c in f.items() if len(a) < degree}
            for f in field.velocity(motion)
        ]
        motion = [jet + Jet(path, degree) for jet, path in zip(start, paths, strict=True)]
    return motion


def crossing_state(statement: Field, step: Step, piece: tuple[arb, arb]) -> tuple[list[Jet], arb]:
    """Jets of the state where the section is crossed in `piece`, and the crossing time within the step."""
    section, moment = statement.section, piece[0].union(piece[1])
    height = step.polynomials[section][()]
    for _ in range(NEWTON_STEPS):
        # Mean value theorem between the middle and the crossing.
        guess = moment.mid()
        moment = moment.intersection(guess - height(guess) / step.section_slope(moment))
    if not (moment.is_finite() and moment > 0 and moment <= step.duration):
        raise CannotFollow("the crossing time is not enclosed in its step")
    start = step.at(moment)
    degree, motion = start[0].degree, moving(statement, start)
    state = substitute(motion, implicit([motion[section]], [TIME]))
    state[section] = Jet({}, degree)
    return state, moment


def follow(statement: Statement, start: Sequence[Jet], bits: int) -> tuple[list[Jet], arb, int]:
    """Jets of the state at the crossing after the start on the section that is claimed, its time, the number of steps.

    At the crossings before it no orbit is in Fix(R).
    """
    state, sign, now, guess, steps, left = list(start), 0, arb(0), arb(1) / 2, 0, statement.crossings
    while True:
        step, guess = take_step(statement, state, guess, bits)
        end, steps = step.duration, steps + 1
        while not sign_of(step.polynomials[statement.section][()](end)):
            end = (end * 7 / 8).mid()
            if end < step.duration / 16:
                raise CannotFollow("no step ends away from the section")
        piece, sign = first_crossing(step, statement.section, sign, arb(0), end)
        while piece is not None:
            found, moment = crossing_state(statement, step, piece)
            left -= 1
            if left == 0:
                return found, now + moment, steps
            if not any(sign_of(found[i][()]) for i in statement.kernel):
                raise CannotFollow("the half orbit may end before the crossing that is claimed")
            piece, sign = first_crossing(step, statement.section, sign, piece[1], end)
        state, now = step.at(end), now + end
