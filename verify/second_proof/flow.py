"""The flow of jets by an interval Taylor method: Picard enclosure, series in time, remainder. README, section 3."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, zip_longest
from math import log2
from typing import Any

from flint import acb, arb, arb_mat, arb_poly, arb_series

from .jets import CannotFollow, Jet, Monomials, add, ball, evaluate, monomials, precision
from .statement import Program, Statement

Matrix = list[list[Any]]

DISC_BITS = 64
STAGES = 48
INFLATION = arb(9) / 8
LEAST_RADIUS = 2.0**-40


def field_of(statement: Statement, table: Monomials, state: Sequence[Jet], text: Program | None = None) -> list[Jet]:
    """The vector field, or another program of the statement, on jets of the state."""
    inputs = dict(zip(statement.state, state, strict=True))
    inputs |= {name: table.constant(ball(value)) for name, value in statement.parameters.items()}
    return evaluate(statement.field if text is None else text, table, inputs)


@dataclass(frozen=True)
class Disc:
    """For |t| <= radius and complex initial states within `margins` of a box, solutions are bounded by `bounds`."""

    radius: arb
    margins: tuple[arb, ...]
    bounds: tuple[arb, ...]


def picard(statement: Statement, start: Sequence[arb], guess: arb) -> Disc:
    """A disc of complex time on which all solutions from a box exist, by Picard's inclusion, stage by stage."""
    table = monomials(0, 0)

    def slope(box: list[acb]) -> list[acb]:
        return [acb(0) if jet[0] is None else acb(jet[0]) for jet in field_of(statement, table, [[z] for z in box])]

    def stage(box: list[acb], moves: acb) -> list[acb] | None:
        outer = box
        for _ in range(8):
            try:
                paths = [moves * f for f in slope(outer)]
            except CannotFollow:
                return None
            if all(o.contains(x + path) for o, x, path in zip(outer, box, paths, strict=True)):
                return outer
            outer = [x + path * INFLATION for x, path in zip(box, paths, strict=True)]
            if not all(z.is_finite() for z in outer):
                return None
        return None

    with precision(DISC_BITS):
        box, length = [acb(x) for x in start], (guess / 8).mid()
        trial = stage(box, acb(arb(0, length), arb(0, length)))
        if trial is None:
            raise CannotFollow("no disc of time on which Picard's inclusion holds")
        spreads = [(z - x).abs_upper() for z, x in zip(trial, start, strict=True)]
        widest = max(spreads, key=lambda v: float(v.upper()))
        # A coordinate that hardly moves still needs a margin, or its reciprocal would swell the remainders.
        margins = [(v if v > widest / 4096 else widest / 4096).upper() / 8 for v in spreads]
        box = [acb(x + arb(0, m), arb(0, m)) for x, m in zip(start, margins, strict=True)]
        done, length = 0, (guess / (STAGES // 2)).mid()
        moves = acb(arb(0, length), arb(0, length))
        while done < STAGES and (outer := stage(box, moves)) is not None:
            box, done = outer, done + 1
        if not done:
            raise CannotFollow("no disc of time on which Picard's inclusion holds")
        return Disc(done * length, tuple(margins), tuple(z.abs_upper() for z in box))


def disc(statement: Statement, start: Sequence[arb], guess: arb) -> Disc:
    """A disc about as large as Picard's inclusion allows; `guess` is its expected radius."""
    for _ in range(60):
        if guess < LEAST_RADIUS:
            break
        try:
            found = picard(statement, start, guess)
        except CannotFollow:
            guess = guess / 2
            continue
        if 2 * found.radius > guess:
            return found
        guess = found.radius
    raise CannotFollow(f"the step shrinks below {LEAST_RADIUS:.0e}: too close to a singularity of the field")


def _series(value: Any, length: int) -> arb_series:
    if isinstance(value, arb_series):
        return arb_series(value.coeffs()[:length], prec=length)
    return arb_series([] if value is None else [value], prec=length)


def _integral(rows: Sequence[arb_series], low: int, length: int) -> list[arb_series]:
    """Integrals of t^(low-1) times the series, divided by t^low."""
    return [arb_series([c / (low + j) for j, c in enumerate(row.coeffs()[:length])], prec=length) for row in rows]


def _times(matrix: Matrix, rows: Sequence[arb_series], length: int) -> list[arb_series]:
    result = []
    for line in matrix:
        total = arb_series([], prec=length)
        for a, b in zip(line, rows, strict=True):
            if a.length() and b.length():
                total = total + a * b
        result.append(total)
    return result


def _columns(matrix: Matrix) -> Matrix:
    return [list(column) for column in zip(*matrix, strict=True)]


def _tail(series: arb_series, low: int, length: int) -> arb_series:
    return arb_series(series.coeffs()[low : low + length], prec=length)


def _lift(series: arb_series, part: arb_series, low: int, length: int) -> arb_series:
    """series, known below t^low, plus t^low part."""
    known = series.coeffs()[:low]
    return arb_series([*known, *[arb(0)] * (low - len(known)), *part.coeffs()][:length], prec=length)


def _improve(values: Matrix, rate: Matrix, inverse: Matrix, low: int, high: int) -> Matrix:
    """Solutions Y of Y' = rate Y as series, columns known below t^low, by one step of Newton's method to t^high."""
    gap = high - low
    short = [[_series(c, gap) for c in row] for row in values]
    undone = [[_series(c, gap) for c in row] for row in inverse]
    columns = []
    for column in _columns(values):
        product = _times(rate, [_series(c, high) for c in column], high)
        defect = [_tail(p - _series(c, high).derivative(), low - 1, gap) for p, c in zip(product, column, strict=True)]
        change = _times(short, _integral(_times(undone, defect, gap), low, gap), gap)
        columns.append([_lift(c, d, low, high) for c, d in zip(column, change, strict=True)])
    return _columns(columns)


def fundamental_series(statement: Statement, start: Sequence[Any], length: int) -> tuple[list[Any], Matrix, Matrix]:
    """Taylor polynomials in time of the solution x from a state, of phi = Dx and of psi, the inverse of phi."""
    m = len(start)
    first = monomials(m, 1)
    zero, one = arb_series([], prec=1), arb_series([1], prec=1)
    x = [arb_series([c], prec=1) for c in start]
    phi: Matrix = [[one if i == j else zero for j in range(m)] for i in range(m)]
    psi: Matrix = [list(row) for row in phi]
    lengths = [length]
    while lengths[-1] > 1:
        lengths.append((lengths[-1] + 1) // 2)
    known = 1
    for low, high in zip(reversed(lengths), [*reversed(lengths[:-1]), None], strict=True):
        # x is known below t^low, phi and its inverse psi below t^known.
        top = low if high is None else high
        x = [_series(c, top) for c in x]
        jets = [first.linear(c, [arb(1) if i == j else None for j in range(m)]) for i, c in enumerate(x)]
        field = field_of(statement, first, jets)
        if low > known:
            rate = [[_series(c, low) for c in jet[1:]] for jet in field]
            back = [[-c for c in row] for row in _columns(rate)]
            # (psi^T)' = -rate^T psi^T, and phi^T is its inverse.
            phi, psi = (
                _improve(phi, rate, psi, known, low),
                _columns(_improve(_columns(psi), back, _columns(phi), known, low)),
            )
            known = low
        if high is not None:
            gap = high - low
            defect = [_tail(_series(f[0], high) - c.derivative(), low - 1, gap) for f, c in zip(field, x, strict=True)]
            short, undone = ([[_series(c, gap) for c in row] for row in matrix] for matrix in (phi, psi))
            change = _times(short, _integral(_times(undone, defect, gap), low, gap), gap)
            x = [_lift(c, d, low, high) for c, d in zip(x, change, strict=True)]
    return x, phi, psi


@dataclass(frozen=True)
class Expansion:
    """Taylor polynomials in time of the coefficients of jets: README, section 3.3.

    Attributes:
        lower: polynomials of the coefficients of degree below the highest, None above.
        start: the jets at time 0; `forces`: for the monomials of the highest degree what they are driven by.
    """

    table: Monomials
    length: int
    lower: list[Jet]
    start: Sequence[Jet]
    forces: list[Jet]
    phi: Matrix
    psi: Matrix

    def at(self, time: arb) -> list[Jet]:
        """The Taylor polynomials, without remainder, at a time."""
        m, n = len(self.start), self.length
        result = [[None if c is None else arb_poly(c.coeffs())(time) for c in jet] for jet in self.lower]
        powers = [arb(1)]
        for _ in range(n):
            powers.append(powers[-1] * time)
        # sums[i][j][l] is the sum of the first l terms of phi_ij at the time.
        sums = [
            [
                list(
                    accumulate(
                        (c * t for c, t in zip_longest(entry.coeffs(), powers[:n], fillvalue=arb(0))), initial=arb(0)
                    )
                )
                for entry in row
            ]
            for row in self.phi
        ]
        flipped = [
            [arb_series([entry[n - j] * powers[j] / j for j in range(n - 1, 0, -1)], prec=n - 1) for entry in row]
            for row in sums
        ]
        columns = [_times(flipped, [_series(c, n - 1) for c in column], n - 1) for column in _columns(self.psi)]
        begin = len(monomials(self.table.variables, self.table.degree - 1).exponents)
        top = range(begin, len(self.table.exponents))
        weights = [[entry[n] for entry in row] for row in sums]
        values = [[arb(0) if jet[a] is None else jet[a] for a in top] for jet in self.start]
        for j, column in enumerate(columns):
            driven = [_series(self.forces[j][a], n - 1).coeffs() for a in top]
            if not any(driven):
                continue
            for i, entry in enumerate(column):
                weights[i] = weights[i] + [entry[n - 2 - k] for k in range(n - 1)]
            values += [[force[k] if k < len(force) else arb(0) for force in driven] for k in range(n - 1)]
        totals = arb_mat(weights) * arb_mat(values)
        moving = [any(jet[a] is not None for jet in (*self.start, *self.forces)) for a in top]
        for i in range(m):
            for place, a in enumerate(top):
                result[i][a] = totals[i, place] if moving[place] else None
        return result


def expand(statement: Statement, state: Sequence[Jet], table: Monomials, length: int) -> Expansion:
    """Taylor polynomials in time, of the given length, of the jets of the solution from jets of the state."""
    x, phi, psi = fundamental_series(statement, [jet[0] for jet in state], length)
    result: list[Jet] = [[c] + [None] * (len(table.exponents) - 1) for c in x]
    forces: list[Jet] = [table.constant(None) for _ in state]
    for degree in range(1, table.degree + 1):
        part = monomials(table.variables, degree)
        begin = len(monomials(table.variables, degree - 1).exponents)
        if degree > 1:
            forces = field_of(statement, part, [jet[: len(part.exponents)] for jet in result])
        if degree == table.degree:
            break
        for a in range(begin, len(part.exponents)):
            pulled = [arb_series([] if jet[a] is None else [jet[a]], prec=length) for jet in state]
            if degree > 1 and any(force[a] is not None for force in forces):
                driven = _times(psi, [_series(force[a], length) for force in forces], length)
                pulled = [_series(v + p.integral(), length) for v, p in zip(pulled, driven, strict=True)]
            for jet, value in zip(result, _times(phi, pulled, length), strict=True):
                jet[a] = value if value.length() else None
    return Expansion(table, length, result, state, forces, phi, psi)


@dataclass(frozen=True)
class Step:
    """The solution for |t| <= duration; the remainders are those of README, section 3.4, before the factor t^length."""

    duration: arb
    expansion: Expansion
    remainders: list[Jet]
    section: arb_poly
    section_slope: arb_poly

    def at(self, time: arb) -> list[Jet]:
        """Jets of the state at a time in [0, duration]."""
        scale = time**self.expansion.length
        return [
            add(row, [None if r is None else r * scale for r in rest])
            for row, rest in zip(self.expansion.at(time), self.remainders, strict=True)
        ]


def take_step(statement: Statement, state: list[Jet], table: Monomials, guess: arb, bits: int) -> tuple[Step, arb]:
    """One step from jets of the state, and the radius of its disc."""
    found = disc(statement, [jet[0] for jet in state], guess)
    length = int(0.7 * bits) + 24
    with precision(DISC_BITS):
        for jet in state:
            if not all(c is None or c.is_finite() for c in jet):
                raise CannotFollow("the enclosure of the state is not finite")
        growth = table.constant(arb(1))
        for jet, margin in zip(state, found.margins, strict=True):
            ratios = [None, *[None if c is None else c.abs_upper() / margin for c in jet[1:]]]
            growth = table.multiply(growth, table.compose([arb(1)] * (table.degree + 1), ratios))
        # The duration only decides how small the remainder is, not whether it is one.
        sizes = [
            max([1.0, *(float(jet[a].abs_upper()) for jet in state if jet[a] is not None)]) for a in range(len(growth))
        ]
        excess = max(
            log2(max(1.0, float(g.upper()) / size)) for g, size in zip(growth, sizes, strict=True) if g is not None
        )
        duration = (found.radius * arb(2) ** (arb(-bits - excess) / length)).mid()
        q = duration / found.radius
        last = 1 / (found.radius**length * (1 - q))
        slopes = (length / (1 - q) + q / (1 - q) ** 2) / found.radius**length
        remainders = [
            [None if g is None else arb(0, (bound * g * last).upper()) for g in growth] for bound in found.bounds
        ]
        slope_remainder = arb(0, (found.bounds[statement.section] * slopes).upper())
    expansion = expand(statement, state, table, length)
    main = expansion.lower[statement.section][0].coeffs()
    main += [arb(0)] * (length - len(main))
    rest = remainders[statement.section][0]
    slope = arb_poly([k * c for k, c in enumerate(main)][1:] + [slope_remainder])
    return Step(
        duration, expansion, remainders, arb_poly([*main, arb(0) if rest is None else rest]), slope
    ), found.radius
