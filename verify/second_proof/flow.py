"""The flow of jets by an interval Taylor method: a disc of complex time, series, remainder. README, section 3."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from flint import acb, arb, arb_poly, arb_series

from .jets import CannotFollow, Jet, precision
from .statement import Statement

DISC_BITS, SECTORS, STAGES, LEAST_STAGES = 64, 16, 48, 12
LEAST_RADIUS = 2.0**-40


class Disc(NamedTuple):
    """For |t| <= radius and complex initial states within `margins` of a box, solutions are bounded by `bounds`."""

    radius: arb
    margins: list[arb]
    bounds: list[arb]


def disc(statement: Statement, start: Sequence[arb], guess: arb) -> Disc:
    """A disc of complex time, of radius <= `guess`, on which all solutions from a box exist. README, section 3.1."""

    def slope(box: Sequence[acb], turn: acb) -> list[acb]:
        return [turn * acb(f[()]) for f in statement.velocity([Jet({(): z}, 0) for z in box])]

    def stage(box: list[acb], last: list[acb], turn: acb, size: arb) -> tuple[list[acb], list[acb]]:
        """An enclosure of the solutions from a box for times in [0, size] turn, and of turn f there."""
        reach = arb(size / 2, size / 2)
        for _ in range(6):
            outer = [x + reach * f * arb("1.125") for x, f in zip(box, last, strict=True)]
            last = slope(outer, turn)
            if all(f.is_finite() and o.contains(x + reach * f) for o, x, f in zip(outer, box, last, strict=True)):
                return outer, last
        raise CannotFollow("no enclosure of a stage")

    with precision(DISC_BITS):
        while guess > LEAST_RADIUS:
            size, least, bounds = (guess / STAGES).mid(), STAGES, [arb(0)] * len(start)
            speeds = [f.abs_upper() for f in slope([acb(x) for x in start], acb(1))]
            # A coordinate that hardly moves still needs a margin, or its reciprocal would swell the remainders.
            margins = [(guess / 64 * max(s, max(speeds) / 256)).mid() for s in speeds]
            for sector in range(SECTORS):
                angle = arb.pi() * (arb(sector) + arb(0.5, 0.5)) / SECTORS
                turn = acb(angle.cos(), angle.sin())
                box = [acb(x + arb(0, m), arb(0, m)) for x, m in zip(start, margins, strict=True)]
                done = 0
                try:
                    last = slope(box, turn)
                    while done < least:
                        outer, last = stage(box, last, turn, size)
                        box = [x + size * f for x, f in zip(box, last, strict=True)]
                        bounds = [max(b, z.abs_upper()) for b, z in zip(bounds, outer, strict=True)]
                        done += 1
                except (CannotFollow, ZeroDivisionError):
                    least = done
                if least < LEAST_STAGES:
                    break
            else:
                return Disc(least * size, margins, bounds)
            guess = guess / 2
    raise CannotFollow(f"the step shrinks below {LEAST_RADIUS:.0e}: too close to a singularity of the field")


def _cut(series: arb_series, low: int, high: int) -> arb_series:
    """The coefficients from t^low to below t^high; the others are exactly zero."""
    return arb_series([0] * low + [series[i] for i in range(low, high)], prec=high)


def _times(columns: list[list[arb_series]], vector: Sequence[Any]) -> list[arb_series]:
    terms = [[c * x for c in column] for column, x in zip(columns, vector, strict=True)]
    return [sum(row[1:], row[0]) for row in zip(*terms, strict=True)]


class Linear(NamedTuple):
    """Columns of a fundamental matrix of X' = A(t) X that is the identity at 0, and of its inverse, below t^length."""

    matrix: list[list[arb_series]]
    inverse: list[list[arb_series]]
    length: int

    def extended(self, n: int) -> Linear:
        """The same polynomials, as series below t^n."""
        matrix, inverse = ([[_cut(x, 0, n) for x in column] for column in m] for m in (self.matrix, self.inverse))
        return Linear(matrix, inverse, n)

    def solve(self, start: Sequence[arb], force: Sequence[Any]) -> list[arb_series]:
        """X with X' = A X + force and X = start at 0: variation of constants."""
        return _times(self.matrix, [x + c.integral() for x, c in zip(start, _times(self.inverse, force), strict=True)])

    def refined(self, rates: Sequence[Jet], n: int) -> Linear:
        """The same below t^n, n at most twice the length; the coefficients of v_j in `rates` are column j of A."""
        h, old, rest = self.length, self.extended(n), [rate.varying().items() for rate in rates]
        matrix, inverse = [], []
        for column in old.matrix:
            lines = zip(rest, column, strict=True)
            sums = [sum((c * column[k] for (k,), c in row), -x.derivative()) for row, x in lines]
            change = old.solve([arb(0)] * len(rates), [_cut(defect, h - 1, n - 1) for defect in sums])
            matrix.append([x + d for x, d in zip(column, change, strict=True)])
        for j, column in enumerate(old.inverse):
            gap = [_cut(int(i == j) - x, h, n) for i, x in enumerate(_times(matrix, column))]
            inverse.append([x + d for x, d in zip(column, _times(old.inverse, gap), strict=True)])
        return Linear(matrix, inverse, n)


def expand(statement: Statement, state: Sequence[Jet], length: int) -> list[Jet]:
    """Taylor coefficients in time, below t^length, of the jets of the solution. README, sections 3.2 and 3.3."""
    m, degree, n = len(state), state[0].degree, 1
    base = [arb_series([jet[()]], prec=1) for jet in state]
    one = [[arb_series([int(i == j)], prec=1) for i in range(m)] for j in range(m)]
    linear = Linear(one, one, 1)
    while True:
        more = min(2 * n, length)
        base = [_cut(x, 0, more) for x in base]
        field = statement.velocity([Jet({(): x, (i,): arb(1)}, 1) for i, x in enumerate(base)])
        linear = linear.refined(field, n) if n > 1 else linear
        if n == length:
            break
        defect = [_cut(f[()] - x.derivative(), n - 1, more - 1) for f, x in zip(field, base, strict=True)]
        change = linear.extended(more).solve([arb(0)] * m, defect)
        base, n = [x + d for x, d in zip(base, change, strict=True)], more
    result = [Jet({(): x}, degree) for x in base]
    for order in range(1, degree + 1):
        forces = statement.velocity([Jet(jet, order) for jet in result]) if order > 1 else [Jet({}, 1)] * m
        for a in sorted({a for jet in (*forces, *state) for a in jet if len(a) == order}):
            column = linear.solve([jet[a] for jet in state], [f[a] for f in forces])
            for jet, c in zip(result, column, strict=True):
                jet[a] = c
    return result


@dataclass(frozen=True)
class Step:
    """The solution for 0 <= t <= duration: Taylor polynomials in t, the last coefficient a ball for the remainder."""

    duration: arb
    polynomials: list[Jet]
    section_slope: arb_poly

    def at(self, time: arb) -> list[Jet]:
        """Jets of the state at a time in [0, duration]."""
        return [jet.map(lambda p: p(time)) for jet in self.polynomials]


def take_step(statement: Statement, state: Sequence[Jet], guess: arb, bits: int) -> tuple[Step, arb]:
    """One step from jets of the state, and a guess for the next disc. README, section 3.4."""
    if not all(c.is_finite() for jet in state for c in jet.values()):
        raise CannotFollow("the enclosure of the state is not finite")
    radius, margins, bounds = disc(statement, [jet[()] for jet in state], guess)
    length, degree = int(0.7 * bits) + 24, state[0].degree
    with precision(DISC_BITS):
        growth = Jet({(): arb(1)}, degree)
        for jet, margin in zip(state, margins, strict=True):
            ratios = Jet({a: c.abs_upper() / margin for a, c in jet.varying().items()}, degree)
            growth = growth / (Jet({(): arb(1)}, degree) - ratios)
        # The duration only decides how small the remainder is, not whether it is one.
        duration = (radius * arb(2) ** (arb(-bits - 16) / length)).mid()
        q = duration / radius
        last = 1 / (radius**length * (1 - q))
        steep = (length / (1 - q) + q / (1 - q) ** 2) / radius**length
        rests = [growth.map(lambda g: arb(0, (bound * g * last).upper())) for bound in bounds]  # noqa: B023
        slope_rest = arb(0, (bounds[statement.section] * steep).upper())
    rows = expand(statement, state, length)
    polynomials = [Jet({}, degree) for _ in rows]
    for jet, row, rest in zip(polynomials, rows, rests, strict=True):
        for a in {*row, *rest}:
            jet[a] = arb_poly([row[a][i] if a in row else 0 for i in range(length)] + [rest[a]])
    slope = arb_poly([i * rows[statement.section][()][i] for i in range(1, length)] + [slope_rest])
    return Step(duration, polynomials, slope), radius * 3 / 2
