"""One Taylor step of an ordinary differential equation for jets of its solutions, in fixed-point integers.

Not rigorous: rounding errors are not tracked, only kept small by guard bits. A number x is stored as
the integer nearest to x 2^bits. The Taylor coefficients in time of the orbit itself come from the
usual recurrences. A jet coefficient V_m of monomial m then solves the linear equation

    V_m' = Df(x(t)) V_m + S_m(t),

in which S_m collects products of jet coefficients of lower degree. Df and S_m are polynomials in
time that are known beforehand, so they are formed by fast polynomial products, and only the
products of the non-constant entries of Df with V_m are left to recurrences. Time is scaled by a
power of two, `2 ** exponent`, so that no coefficient grows.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import mul
from typing import Any

from flint import fmpz_mat, fmpz_poly

from orbitproof.explore.numerics import mpf, working_context
from orbitproof.explore.refinement.jets import JetBasis
from orbitproof.explore.refinement.tape import Operation, Tape

_SLACK = 6
"""Bits of the working precision that the truncation of the Taylor series may spoil."""

_JET_SLACK = 12
"""Further bits that it may spoil of a derivative, for each order: enough that most orbits alone decide."""

_SHORTEST = 1 / 4
"""Step in scaled time below which time is scaled anew."""

_BLOCKS = 6
"""Parts in which the Taylor coefficients of jets are found."""

Series = list[int]
OptionalPolynomial = Any


class IntegrationFailure(Exception):
    """The orbit cannot be followed; the message is one line that says why."""


@dataclass(frozen=True)
class StepResult:
    """Taylor polynomials in scaled time of the jets of one step.

    Attributes:
        series: series[i][m][n] is the coefficient of state i, monomial m, (t / 2^exponent)^n, fixed point.
        exponent: the scale of time.
        length: admissible step in scaled time, in (0, 1].
        proposal: the exponent to try in the next step.
    """

    series: list[list[Series]]
    exponent: int
    length: float
    proposal: int


@dataclass(frozen=True)
class _JacobianRow:
    """One row of Df along the centre: constant entries, and the others as polynomials in time, by column."""

    constants: list[tuple[int, int]]
    polynomials: list[tuple[int, OptionalPolynomial]]


class JetStepper:
    """Taylor steps for jets in a given basis, with given precision and order.

    `states` counts the coordinates that move; further inputs of the tape are parameters, whose jets
    do not depend on time. A step may leave out 2 ** -tolerance_bits of the largest coordinate, by default
    what the working precision cannot hold.
    """

    def __init__(
        self,
        tape: Tape,
        states: int,
        basis: JetBasis,
        bits: int,
        order: int | None = None,
        tolerance_bits: int | None = None,
    ) -> None:
        self.tape = tape
        self.states = states
        self.basis = basis
        self.bits = bits
        # The cost per unit of time, order^2 exp(L / order) with L = -log(tolerance), is least at L / 2.
        self.order = order if order is not None else max(12, round(0.4 * bits))
        self._tolerance_bits = bits - _SLACK if tolerance_bits is None else tolerance_bits
        self._unit = 1 << bits
        self._constants = [round(operation.value * self._unit) for operation in tape.operations]
        self._needed = self._multiplied()
        self._context = working_context(bits + 64)

    def _multiplied(self) -> list[bool]:
        needed = [False] * len(self.tape.operations)
        for position, operation in enumerate(self.tape.operations):
            if operation.code in ("multiply", "power"):
                needed[operation.left] = needed[operation.right] = True
            if operation.code in ("invert", "power"):
                needed[position] = needed[operation.left] = True
        return needed

    def step(self, state: Sequence[Sequence[int]], exponent: int) -> StepResult:
        """Expand the solution through the jets `state[i][m]` (fixed point), time scaled by 2 ** exponent.

        Inputs beyond `states` are the parameters. Raises `IntegrationFailure` at a singularity.
        """
        while True:
            nodes, orbit = self._orbit([jet[0] for jet in state], exponent)
            length = self._length(orbit, self._tolerance_bits)
            series: list[list[Series]] = [[s] for s in orbit]
            if length >= _SHORTEST and len(self.basis.monomials) > 1:
                self._jets(nodes, state, exponent, series)
                length = min(length, self._length_of_jets(series))
            if length >= _SHORTEST:
                break
            # Coefficients that grow would spoil the sum with the rounding errors of the powers of time.
            exponent += math.floor(math.log2(length))
        # Near 1 the last coefficients are lost in the rounding error and say nothing: try a longer scale next time.
        proposal = exponent + 1 if length > 0.9 else exponent + math.ceil(math.log2(length))
        return StepResult(series, exponent, min(length, 1.0), proposal)

    def _length(self, curves: Sequence[Series], tolerance_bits: int, least: int = 0) -> float:
        """The step that leaves out 2 ** -tolerance_bits of the largest start, or of `least` if that is larger."""
        tolerance = max(least, *(abs(s[0]) for s in curves)).bit_length() - self.bits - tolerance_bits
        bits_per_order = []
        for n in range(self.order - 2, self.order + 1):
            largest = max(abs(s[n]) for s in curves).bit_length() - self.bits
            bits_per_order.append((tolerance - largest) / n)
        return min(2.0 ** min(bits_per_order), 16.0)

    def _length_of_jets(self, series: Sequence[Sequence[Series]]) -> float:
        """The step that derivatives allow: nearby orbits may move faster than the orbit, as across a linear mode."""
        lengths = []
        for degree in range(1, self.basis.degree + 1):
            batch = [m for m, monomial in enumerate(self.basis.monomials) if sum(monomial) == degree]
            curves = [jets[m] for jets in series for m in batch]
            bits = self._tolerance_bits - degree * _JET_SLACK
            lengths.append(self._length(curves, bits, self._unit) if curves else 16.0)
        return min(lengths)

    def _orbit(self, start: Sequence[int], exponent: int) -> tuple[list[Series], list[Series]]:
        """Taylor coefficients of all operations (order - 1) and of the states (order) along the centre."""
        bits = self.bits
        nodes: list[Series] = [[] for _ in self.tape.operations]
        weighted: list[Series] = [[] for _ in self.tape.operations]
        program = list(zip(self.tape.operations, self._constants, nodes, strict=True))
        for position in range(self.tape.inputs):
            nodes[position].append(start[position])
        for n in range(self.order):
            for position, (operation, constant, out) in enumerate(program):
                code = operation.code
                if code == "input":
                    if operation.left >= self.states and n:
                        out.append(0)
                elif code == "multiply":
                    a, b = nodes[operation.left], nodes[operation.right]
                    if a is b:
                        half = (n + 1) // 2
                        total = 2 * sum(map(mul, a[:half], a[: n - half : -1]))
                        if n % 2 == 0:
                            total += a[half] * a[half]
                    else:
                        total = sum(map(mul, a, b[::-1]))
                    out.append(total >> bits)
                elif code == "add":
                    out.append(nodes[operation.left][n] + nodes[operation.right][n])
                elif code == "subtract":
                    out.append(nodes[operation.left][n] - nodes[operation.right][n])
                elif code == "scale":
                    value = operation.value
                    a_n = nodes[operation.left][n]
                    out.append(a_n * value.numerator if value.denominator == 1 else (a_n * constant) >> bits)
                elif code == "shift":
                    out.append(nodes[operation.left][n] + (0 if n else constant))
                elif code == "constant":
                    out.append(0 if n else constant)
                elif n == 0:
                    out.append(self._head(operation, nodes[operation.left][0]))
                elif code == "invert":
                    a = nodes[operation.left]
                    out.append(-sum(map(mul, out, a[n:0:-1])) // a[0])
                else:
                    a = nodes[operation.left]
                    tail = a[n:0:-1]
                    num, den = operation.value.numerator, operation.value.denominator
                    weighted[position].append((n - 1) * out[n - 1])
                    plain, graded = sum(map(mul, out, tail)), sum(map(mul, weighted[position], tail))
                    out.append((num * n * plain - (num + den) * graded) // (den * n * a[0]))
            for i in range(self.states):
                value = nodes[self.tape.outputs[i]][n]
                value = value << exponent if exponent >= 0 else value >> -exponent
                nodes[i].append(value // (n + 1))
        if max(abs(nodes[i][n]) for i in range(self.states) for n in (0, 1)) >> (bits + 64):
            raise IntegrationFailure("the orbit runs away or into a singularity")
        return nodes, nodes[: self.states]

    def _head(self, operation: Operation, a: int) -> int:
        if operation.code == "invert":
            if a == 0:
                raise IntegrationFailure("division by zero: the orbit meets a singularity")
            return (self._unit << self.bits) // a
        if a <= 0:
            raise IntegrationFailure("power of a number <= 0: the orbit meets a singularity")
        context = self._context
        exponent = mpf(operation.value, context)
        return int(context.ldexp(context.ldexp(context.mpf(a), -self.bits) ** exponent, self.bits))

    def _jets(
        self, nodes: list[Series], state: Sequence[Sequence[int]], exponent: int, series: list[list[Series]]
    ) -> None:
        tape, basis, bits = self.tape, self.basis, self.bits
        centre: list[OptionalPolynomial] = [
            fmpz_poly(s[: self.order]) if needed else None for s, needed in zip(nodes, self._needed, strict=True)
        ]
        slopes = self._slopes(centre)
        rows = self._jacobian(centre, slopes)
        jets: list[list[OptionalPolynomial]] = [centre]
        degrees = [sum(monomial) for monomial in basis.monomials]
        for degree in range(1, basis.degree + 1):
            batch = [m for m, d in enumerate(degrees) if d == degree]
            sources: list[list[OptionalPolynomial]] = []
            for m in batch:
                inputs: list[OptionalPolynomial] = [None] * self.states
                inputs += [fmpz_poly([jet[m]]) if jet[m] else None for jet in state[self.states :]]
                propagated = self._propagate(m, jets, slopes, inputs)
                sources.append([propagated[out] for out in tape.outputs])
                jets.append(propagated)
            starts = [[jet[m] for jet in state[: self.states]] for m in batch]
            solutions = _solve_linear(rows, sources, starts, self.order, bits, exponent)
            for m, solution in zip(batch, solutions, strict=True):
                for i in range(self.states):
                    series[i].append(solution[i])
                if basis.splits_others[m]:
                    inputs = [fmpz_poly(s[: self.order]) for s in solution]
                    inputs += [fmpz_poly([jet[m]]) if jet[m] else None for jet in state[self.states :]]
                    jets[m] = self._propagate(m, jets, slopes, inputs)

    def _slopes(self, centre: Sequence[OptionalPolynomial]) -> dict[int, OptionalPolynomial]:
        """For each inversion and power the polynomial d(result)/d(operand)."""
        result = {}
        for position, operation in enumerate(self.tape.operations):
            if operation.code == "invert":
                result[position] = -self._product(centre[position], centre[position])
            elif operation.code == "power":
                value = operation.value
                slope = self._product(centre[position], centre[operation.right])
                result[position] = slope * value.numerator // value.denominator
        return result

    def _product(self, a: OptionalPolynomial, b: OptionalPolynomial) -> OptionalPolynomial:
        return a.mul_low(b, self.order) // self._unit

    def _jacobian(self, centre: list[OptionalPolynomial], slopes: dict[int, OptionalPolynomial]) -> list[_JacobianRow]:
        rows = [_JacobianRow([], []) for _ in range(self.states)]
        first = self.basis.variable(0)
        for column in range(self.states):
            inputs: list[OptionalPolynomial] = [None] * self.tape.inputs
            inputs[column] = fmpz_poly([self._unit])
            derivative = self._propagate(first, [centre], slopes, inputs, linear=True)
            for i, out in enumerate(self.tape.outputs):
                entry = derivative[out]
                if entry is None:
                    continue
                if entry.length() <= 1:
                    rows[i].constants.append((column, int(entry[0])))
                else:
                    rows[i].polynomials.append((column, entry))
        return rows

    def _propagate(
        self,
        m: int,
        jets: Sequence[Sequence[OptionalPolynomial]],
        slopes: Mapping[int, OptionalPolynomial],
        inputs: Sequence[OptionalPolynomial],
        linear: bool = False,
    ) -> list[OptionalPolynomial]:
        """Coefficient of monomial m of every operation, from the lower ones `jets` and that of the inputs.

        `linear`: take only the terms that are linear in the coefficient m (a column of Df).
        """
        order, unit = self.order, self._unit
        centre = jets[0]
        inner = [] if linear else [(i, j) for i, j in self.basis.splits[m] if i and j]
        monomials = self.basis.monomials
        v = next(i for i, e in enumerate(monomials[m]) if e)
        out: list[OptionalPolynomial] = []
        for position, operation in enumerate(self.tape.operations):
            code, left, right = operation.code, operation.left, operation.right
            result: OptionalPolynomial = None
            if code == "input":
                result = inputs[left]
            elif code in ("add", "subtract"):
                a, b = out[left], out[right]
                if b is None:
                    result = a
                elif a is None:
                    result = b if code == "add" else -b
                else:
                    result = a + b if code == "add" else a - b
            elif code == "scale":
                if out[left] is not None:
                    value = operation.value
                    whole = value.denominator == 1
                    result = out[left] * value.numerator if whole else out[left] * self._constants[position] // unit
            elif code == "shift":
                result = out[left]
            elif code == "multiply":
                terms = []
                if left == right:
                    if out[left] is not None:
                        terms.append(2 * out[left].mul_low(centre[left], order))
                else:
                    if out[left] is not None:
                        terms.append(out[left].mul_low(centre[right], order))
                    if out[right] is not None:
                        terms.append(out[right].mul_low(centre[left], order))
                for i, j in inner:
                    if jets[i][left] is not None and jets[j][right] is not None:
                        terms.append(jets[i][left].mul_low(jets[j][right], order))
                if terms:
                    result = sum(terms[1:], terms[0]) // unit
            elif code in ("invert", "power"):
                if out[left] is not None:
                    result = self._product(out[left], slopes[position])
                num, den = (-1, 1) if code == "invert" else (operation.value.numerator, operation.value.denominator)
                terms = []
                for i, j in inner:
                    if jets[i][left] is not None and jets[j][position] is not None:
                        weight = (num + den) * monomials[i][v] - den * monomials[m][v]
                        if weight:
                            terms.append(jets[i][left].mul_low(jets[j][position], order) * weight)
                if terms:
                    inverse = centre[position] if code == "invert" else centre[right]
                    total = sum(terms[1:], terms[0]) // (unit * den * monomials[m][v])
                    total = self._product(total, inverse)
                    result = total if result is None else result + total
            out.append(result)
        return out


def _coefficients(polynomial: OptionalPolynomial, length: int) -> Series:
    values = [int(c) for c in polynomial.coeffs()]
    return values + [0] * (length - len(values))


def _solve_linear(
    rows: Sequence[_JacobianRow],
    sources: Sequence[Sequence[OptionalPolynomial]],
    starts: Sequence[Sequence[int]],
    order: int,
    bits: int,
    exponent: int,
) -> list[list[Series]]:
    """Taylor coefficients of V' = J(t) V + S(t) for several (S, V(0)) at once; time scaled by 2 ** exponent.

    The coefficients are found in blocks: inside a block by recurrence, a product of small matrices for each
    coefficient, and the contribution of a finished block to all later coefficients by one polynomial product
    per entry of J.
    """
    solutions = [[[value] for value in start] for start in starts]
    count, shift, unit = len(solutions), bits - exponent, 1 << bits
    block = max(8, -(-order // _BLOCKS))
    varying = [i for i, row in enumerate(rows) if row.polynomials]
    columns = sorted({column for row in rows for column, _ in row.polynomials})
    width = len(columns)
    windows = _windows([rows[i] for i in varying], columns, block)
    pending = [[None if s is None else s * unit for s in source] for source in sources]
    for begin in range(0, order, block):
        length = min(block, order - begin)
        parts = [[series[begin:] for series in solution] for solution in solutions]
        known = [[_block(p, length) for p in source] for source in pending]
        recent = fmpz_mat(block * width, count)
        for n in range(length):
            for c, column in enumerate(columns):
                for m, part in enumerate(parts):
                    recent[n * width + c, m] = part[column][n]
            products = [int(entry) for entry in (windows[n] * recent).entries()] if varying else []
            totals = [[earlier[n] for earlier in source] for source in known]
            for r, i in enumerate(varying):
                for m in range(count):
                    totals[m][i] += products[r * count + m]
            for part, total in zip(parts, totals, strict=True):
                for i, row in enumerate(rows):
                    for column, value in row.constants:
                        total[i] += value * part[column][n]
                for series, value in zip(part, total, strict=True):
                    series.append((value >> shift) // (begin + n + 1))
        for solution, part in zip(solutions, parts, strict=True):
            for series, values in zip(solution, part, strict=True):
                series.extend(values[1:])
        if begin + length < order:
            left = order - begin
            pending = [_carried(rows, part, source, length, left) for part, source in zip(parts, pending, strict=True)]
    return solutions


def _windows(rows: Sequence[_JacobianRow], columns: Sequence[int], block: int) -> list[Any]:
    """For each n < block the matrix whose product with coefficients 0 to n of V, stacked, is that of J V to n."""
    entries = [dict(row.polynomials) for row in rows]
    known = [[_block(entry.get(column), block) for column in columns] for entry in entries]
    windows = []
    for n in range(block):
        values = [series[n - j] if j <= n else 0 for row in known for j in range(block) for series in row]
        windows.append(fmpz_mat(len(rows), block * len(columns), values))
    return windows


def _block(polynomial: OptionalPolynomial, length: int) -> Series:
    return [0] * length if polynomial is None else _coefficients(polynomial.truncate(length), length)


def _carried(
    rows: Sequence[_JacobianRow],
    part: Sequence[Series],
    pending: Sequence[OptionalPolynomial],
    length: int,
    left: int,
) -> list[OptionalPolynomial]:
    """What a finished block and those before it contribute to the coefficients after it, `left` with its own."""
    finished = [fmpz_poly(values[:-1]) for values in part]
    carried = []
    for row, earlier in zip(rows, pending, strict=True):
        terms = [finished[column].mul_low(polynomial, left) for column, polynomial in row.polynomials]
        if earlier is not None:
            terms.append(earlier)
        carried.append(sum(terms[1:], terms[0]).right_shift(length) if terms else None)
    return carried
