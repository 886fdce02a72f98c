"""The flow of jets by an interval Taylor method: a disc of complex time, series, remainder. README, section 3."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from flint import acb, arb, arb_poly, arb_series

from .jets import CannotFollow, Jet, precision

DISC_BITS, SECTORS, STAGES, LEAST_STAGES = 64, 16, 48, 12
LEAST_RADIUS = 2.0**-40


class Field(Protocol):
    """A vector field, and the coordinate whose zeros are crossings."""

    @property
    def section(self) -> int:
        """The place of the section coordinate in the state."""

    def velocity(self, state: Sequence[Any]) -> list[Any]:
        """The field on jets, or on numbers."""


class Disc(NamedTuple):
    """For |t| <= radius and complex initial states within `margins` of a box, solutions are bounded by `bounds`."""

    radius: arb
    margins: list[arb]
    bounds: list[arb]


def disc(statement: Field, start: Sequence[arb], guess: arb) -> Disc:
    """A disc of complex time, of radius <= `guess`, on which all solutions from a box exist. README, section 3.1."""

    def slope(box: Sequence[acb], turn: acb) -> list[acb]:
        return [turn * f for f in statement.velocity(box)]

    def stage(box: list[acb], last: list[acb], turn: acb, size: arb) -> tuple[list[acb], list[acb]]:
        """An enclosure of the solutions from a box for times in [0, size] turn, and of turn f there."""
        reach = arb(size / 2, size / 2)
        for _ in range(6):
            outer = [x + reach * f * 5 / 4 for x, f in zip(box, last, strict=True)]
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


def _part(series: arb_series, low: int, high: int) -> arb_series:
    """The coefficients from t^low to below t^high, as a series that begins with the first of them."""
    return arb_series([series[i] for i in range(low, high)], prec=high - low)


def _joined(series: arb_series, more: Iterable[arb]) -> arb_series:
    """A polynomial, all of whose coefficients are known, and those that follow."""
    coefficients = [series[i] for i in range(series.prec)] + list(more)
    return arb_series(coefficients, prec=len(coefficients))


def _times(columns: list[list[arb_series]], vector: Sequence[Any]) -> list[arb_series]:
    terms = [[c * x for c in column] for column, x in zip(columns, vector, strict=True)]
    return [sum(row[1:], row[0]) for row in zip(*terms, strict=True)]


class Linear(NamedTuple):
    """Columns of a fundamental matrix of X' = A(t) X that is the identity at 0, and of its inverse, below t^length."""

    matrix: list[list[arb_series]]
    inverse: list[list[arb_series]]
    length: int

    def solve(self, start: Sequence[arb], force: Sequence[Any]) -> list[arb_series]:
        """X with X' = A X + force and X = start at 0: variation of constants."""
        return _times(self.matrix, [x + c.integral() for x, c in zip(start, _times(self.inverse, force), strict=True)])

    def extended(self, vector: Sequence[arb_series], defects: Sequence[arb_series], n: int) -> list[arb_series]:
        """What is right below t^length, made right below t^n, n at most twice that; `defects` from t^(length - 1)."""
        h = self.length
        inner = _times(self.inverse, [_part(d, h - 1, n - 1) for d in defects])
        change = _times(self.matrix, [arb_series([c[i] / (h + i) for i in range(n - h)], prec=n - h) for c in inner])
        return [_joined(x, (d[i] for i in range(n - h))) for x, d in zip(vector, change, strict=True)]

    def refined(self, rates: Sequence[Jet], n: int, with_inverse: bool) -> Linear:
        """The solution below t^n, n at most twice the length; the coefficients of v_j in `rates` are column j of A."""
        h, rest, matrix, inverse = self.length, [rate.varying().items() for rate in rates], [], []
        for column in self.matrix:
            padded = [_joined(x, [arb(0)] * (n - h)) for x in column]
            sums = [
                sum((c * padded[k] for (k,), c in row), -x.derivative()) for row, x in zip(rest, padded, strict=True)
            ]
            matrix.append(self.extended(column, sums, n))
        for column in self.inverse if with_inverse else ():
            product = _times(matrix, [_joined(x, [arb(0)] * (n - h)) for x in column])
            change = _times(self.inverse, [-_part(x, h, n) for x in product])
            inverse.append([_joined(x, (d[i] for i in range(n - h))) for x, d in zip(column, change, strict=True)])
        return Linear(matrix, inverse, n)


def expand(statement: Field, state: Sequence[Jet], length: int) -> list[Jet]:
    """Taylor coefficients in time, below t^length, of the jets of the solution. README, sections 3.2 and 3.3."""
    m, degree, n = len(state), state[0].degree, 1
    base = [arb_series([jet[()]], prec=1) for jet in state]
    one = [[arb_series([int(i == j)], prec=1) for i in range(m)] for j in range(m)]
    linear = Linear(one, one, 1)
    while True:
        more = min(2 * n, length)
        padded = [_joined(x, [arb(0)] * (more - n)) for x in base]
        field = statement.velocity([Jet({(): x, (i,): arb(1)}, 1) for i, x in enumerate(padded)])
        linear = linear.refined(field, n, degree > 1 or n < length) if n > 1 else linear
        if n == length:
            break
        defects = [f[()] - x.derivative() for f, x in zip(field, padded, strict=True)]
        base, n = linear.extended(base, defects, more), more
    result = [Jet({(): x}, degree) for x in base]
    for order in range(1, degree + 1):
        forces = statement.velocity([Jet(jet, order) for jet in result]) if order > 1 else []
        for a in sorted({a for jet in (*forces, *state) for a in jet if len(a) == order}):
            begin = [jet[a] for jet in state]
            column = linear.solve(begin, [f[a] for f in forces]) if forces else _times(linear.matrix, begin)
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


def take_step(statement: Field, state: Sequence[Jet], guess: arb, bits: int) -> tuple[Step, arb]:
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
