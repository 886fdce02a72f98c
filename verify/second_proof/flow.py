"""The flow of jets by an interval Taylor method: Picard enclosure, series in time, remainder. README, section 3."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import log2
from typing import Any

from flint import acb, arb, arb_poly, arb_series

from .jets import CannotFollow, Exponents, Jet, ball, evaluate, monomials, multiply, power, precision, unit
from .statement import Program, Statement

DISC_BITS, SECTORS, STAGES, LEAST_STAGES = 64, 16, 48, 12
LEAST_RADIUS = 2.0**-40
LEAF = 8


def field_of(
    statement: Statement, state: Sequence[Jet], zero: Exponents, degree: int, text: Program | None = None
) -> list[Jet]:
    """The vector field, or another program of the statement, on jets of the state."""
    inputs = dict(zip(statement.state, state, strict=True))
    inputs |= {name: {zero: ball(value)} for name, value in statement.parameters.items()}
    return evaluate(statement.field if text is None else text, inputs, zero, degree)


@dataclass(frozen=True)
class Disc:
    """For |t| <= radius and complex initial states within `margins` of a box, solutions are bounded by `bounds`."""

    radius: arb
    margins: list[arb]
    bounds: list[arb]


def disc(statement: Statement, start: Sequence[arb], guess: arb) -> Disc:
    """A disc of complex time, of radius <= `guess`, on which all solutions from a box exist. README, section 3.1."""

    def slope(box: Sequence[acb]) -> list[acb]:
        rows = field_of(statement, [{(): z} for z in box], (), 0)
        return [acb(row.get((), 0)) for row in rows]

    def stage(box: list[acb], turn: acb, last: list[acb], size: arb) -> tuple[list[acb], list[acb]] | None:
        """An enclosure of the solutions from a box for times in [0, size] turn, and of turn f there."""
        reach = arb(size / 2, size / 2)
        for _ in range(6):
            outer = [x + reach * f * arb("1.125") for x, f in zip(box, last, strict=True)]
            try:
                last = [turn * f for f in slope(outer)]
            except (CannotFollow, ZeroDivisionError):
                return None
            if not all(f.is_finite() for f in last):
                return None
            if all(o.contains(x + reach * f) for o, x, f in zip(outer, box, last, strict=True)):
                return outer, last
        return None

    with precision(DISC_BITS):
        while guess > LEAST_RADIUS:
            size, least = (guess / STAGES).mid(), STAGES
            begin = [acb(x) for x in start]
            try:
                first = slope(begin)
                nearby = [x + arb(0, guess / 16) * f for x, f in zip(begin, first, strict=True)]
                speeds = [f.abs_upper().upper() for f in slope(nearby)]
            except (CannotFollow, ZeroDivisionError):
                guess = guess / 2
                continue
            fastest = max(speeds, key=float)
            # A coordinate that hardly moves still needs a margin, or its reciprocal would swell the remainders.
            margins = [(guess / 64 * (s if s > fastest / 256 else fastest / 256)).mid() for s in speeds]
            bounds = [[arb(0)] * len(begin) for _ in range(STAGES + 1)]
            for sector in range(SECTORS):
                angle = arb.pi() * (arb(sector) + arb(0.5, 0.5)) / SECTORS
                turn = acb(angle.cos(), angle.sin())
                box = [x + acb(arb(0, m), arb(0, m)) for x, m in zip(begin, margins, strict=True)]
                last = [turn * f for f in first]
                for n in range(1, least + 1):
                    found = stage(box, turn, last, size)
                    if found is None:
                        least = n - 1
                        break
                    outer, last = found
                    box = [x + size * f for x, f in zip(box, last, strict=True)]
                    bounds[n] = [max(b, z.abs_upper().upper()) for b, z in zip(bounds[n], outer, strict=True)]
                if least < LEAST_STAGES:
                    break
            if least >= LEAST_STAGES and all(m > 0 for m in margins):
                used = least if least == STAGES else least - least // 8
                most = [max(column) for column in zip(*bounds[1 : used + 1], strict=True)]
                return Disc(used * size, margins, most)
            guess = guess / 2
    raise CannotFollow(f"the step shrinks below {LEAST_RADIUS:.0e}: too close to a singularity of the field")


def linear(
    rates: Mapping[tuple[int, int], Sequence[arb]],
    start: Sequence[arb],
    forcing: Sequence[Sequence[arb]],
    begin: int,
    length: int,
) -> list[list[arb]]:
    """Coefficients below t^length of X' = A X + b: `start` at 0, then zeros below t^begin. README, section 3.2."""
    found = [[x] + [arb(0)] * (length - 1) for x in start]
    rows = [list(row[:length]) + [arb(0)] * (length - len(row)) for row in forcing]

    def solve(low: int, high: int) -> None:
        if high - low > LEAF:
            middle = (low + high) // 2
            solve(low, middle)
            parts = [arb_poly(column[low:middle]) for column in found]
            for (i, j), rate in rates.items():
                done = (arb_poly(rate[: high - 1 - low]) * parts[j]).coeffs()
                row = rows[i]
                for s in range(middle - 1 - low, min(len(done), high - 1 - low)):
                    row[low + s] = row[low + s] + done[s]
            solve(middle, high)
            return
        for place in range(low, high):
            if place:
                for column, row in zip(found, rows, strict=True):
                    column[place] = row[place - 1] / place
            for (i, j), rate in rates.items():
                row, value = rows[i], found[j][place]
                for s, c in enumerate(rate[: high - 1 - place], place):
                    row[s] = row[s] + c * value

    solve(begin, length)
    return found


def _coefficients(value: Any, length: int) -> list[arb]:
    return list(value.coeffs()[:length]) if isinstance(value, arb_series) else [arb(value)]


def solution(
    statement: Statement, start: Sequence[arb], length: int
) -> tuple[list[list[arb]], dict[tuple[int, int], list[arb]]]:
    """Taylor coefficients in time of the solution from a state, and of the nonzero entries of Df along it."""
    m, known = len(start), 1
    zero, units = tuple([0] * m), [unit(m, i) for i in range(m)]
    found = [[c] for c in start]
    while True:
        low, known = known, min(2 * known, length)
        series = [arb_series(c, prec=known) for c in found]
        field = field_of(statement, [{zero: c, u: arb(1)} for c, u in zip(series, units, strict=True)], zero, 1)
        rates = {(i, j): _coefficients(f[u], known) for i, f in enumerate(field) for j, u in enumerate(units) if u in f}
        if low == length:
            return found, rates
        defects = [[arb(0)] * (low - 1) + _coefficients(f.get(zero, 0), known)[low - 1 :] for f in field]
        change = linear(rates, [arb(0)] * m, defects, low, known)
        found = [c + d[low:] for c, d in zip(found, change, strict=True)]


@dataclass(frozen=True)
class Step:
    """The solution for 0 <= t <= duration: Taylor polynomials in t, the last coefficient a ball for the remainder."""

    duration: arb
    polynomials: list[dict[Exponents, arb_poly]]
    section_slope: arb_poly

    def at(self, time: arb) -> list[Jet]:
        """Jets of the state at a time in [0, duration]."""
        return [{a: p(time) for a, p in row.items()} for row in self.polynomials]


def expand(statement: Statement, state: Sequence[Jet], zero: Exponents, degree: int, length: int) -> list[Jet]:
    """Taylor coefficients in time, below t^length, of the jets of the solution from jets of the state."""
    lowest, rates = solution(statement, [jet.get(zero, arb(0)) for jet in state], length)
    result: list[Jet] = [{zero: c} for c in lowest]
    for order in range(1, degree + 1):
        forces: list[Jet] = [{} for _ in state]
        if order > 1:
            series = [{a: arb_series(c, prec=length) for a, c in jet.items()} for jet in result]
            forces = field_of(statement, series, zero, order)
        for a in monomials(len(zero), order):
            start = [jet.get(a, arb(0)) for jet in state]
            forcing = [_coefficients(f.get(a, 0), length) for f in forces]
            if any(a in f for f in (*forces, *state)):
                for jet, column in zip(result, linear(rates, start, forcing, 0, length), strict=True):
                    jet[a] = column
    return result


def take_step(
    statement: Statement, state: Sequence[Jet], zero: Exponents, degree: int, guess: arb, bits: int
) -> tuple[Step, arb]:
    """One step from jets of the state, and a guess for the next disc. README, section 3.4."""
    if not all(c.is_finite() for jet in state for c in jet.values()):
        raise CannotFollow("the enclosure of the state is not finite")
    found = disc(statement, [jet.get(zero, arb(0)) for jet in state], guess)
    length = int(0.7 * bits) + 24
    with precision(DISC_BITS):
        growth: Jet = {zero: arb(1)}
        for jet, margin in zip(state, found.margins, strict=True):
            ratios = {a: -c.abs_upper() / margin for a, c in jet.items() if any(a)}
            growth = multiply(growth, power({zero: arb(1), **ratios}, Fraction(-1), degree), degree)
        # The duration only decides how small the remainder is, not whether it is one.
        sizes = {a: max([1.0, *(float(jet[a].abs_upper()) for jet in state if a in jet)]) for a in growth}
        excess = max(log2(max(1.0, float(g.upper()) / sizes[a])) for a, g in growth.items())
        duration = (found.radius * arb(2) ** (arb(-bits - excess) / length)).mid()
        q = duration / found.radius
        last = 1 / (found.radius**length * (1 - q))
        steep = (length / (1 - q) + q / (1 - q) ** 2) / found.radius**length
        rests = [{a: arb(0, (bound * g * last).upper()) for a, g in growth.items()} for bound in found.bounds]
        slope_rest = arb(0, (found.bounds[statement.section] * steep).upper())
    expanded = expand(statement, state, zero, degree, length)
    rows = [
        {a: arb_poly([*jet.get(a, [arb(0)] * length), rest[a]]) for a in {*jet, *rest}}
        for jet, rest in zip(expanded, rests, strict=True)
    ]
    slope = arb_poly([k * c for k, c in enumerate(expanded[statement.section][zero])][1:] + [slope_rest])
    return Step(duration, rows, slope), found.radius * 3 / 2
