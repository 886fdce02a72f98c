"""Taylor steps for jets of solutions in float64, all monomials at once: for slopes, sizes and curvatures.

The recurrences are those of `explore.refinement.taylor`. Sums, differences and multiples are linear in the inputs and
in the results of the other operations, so what is left are products and powers, by levels: the operands of a level
are linear in what is known before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, isfinite
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.refinement.jets import Jet, JetBasis
from orbitproof.explore.refinement.tape import Tape
from orbitproof.explore.refinement.taylor import IntegrationFailure

FLOAT_BITS = 53

_ORDER = 30
"""Of the Taylor polynomials. A coefficient costs nearly the same whatever its order."""

_JET_SLACK = 2.0**12
"""How many times more than of the orbit a step may leave out of a derivative, for each order."""

_SAMPLES = 16

_SHORTEST = 2.0**-40

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class _Level:
    """Products and powers whose operands are known: constants and matrices that make them from what is before.

    The first `products` operations are left * right, the others left ** exponent.
    """

    before: int
    products: int
    left: Array
    right: Array
    left_constants: Array
    right_constants: Array
    exponents: tuple[Fraction, ...]


class FloatWalk:
    """An orbit with its jets, step by step to the next crossing of a section.

    Attributes:
        time: elapsed, of the centre.
    """

    def __init__(self, tape: Tape, states: int, basis: JetBasis, context: mpmath.MPContext) -> None:
        self.time = 0.0
        self._states, self._basis, self._context, self._inputs = states, basis, context, tape.inputs
        size = len(basis.monomials)
        self._splits = np.zeros((size, size, size))
        for m, pairs in enumerate(basis.splits):
            for i, j in pairs:
                self._splits[m, i, j] = 1
        self._flat = self._splits.reshape(size, -1).T.copy()
        self._levels, self._outputs, self._constants = _levels(tape)
        degrees = np.array([sum(monomial) for monomial in basis.monomials])
        self._of_degree = [np.flatnonzero(degrees == d) for d in range(basis.degree + 1)]
        self._exponents = np.arange(_ORDER - 2, _ORDER + 1)
        self._side, self._state, self._series, self._length = 0, np.zeros(0), np.zeros(0), 0.0

    def load(self, jets: Sequence[Jet], constant: Jet | None) -> None:
        """Begin at a crossing; `constant` is the jet of the parameter."""
        every = [*jets] if constant is None else [*jets, constant]
        self._state = np.array([[float(c) for c in jet.coefficients] for jet in every])
        self._side = 0

    def step(self, section: int) -> bool:
        """A step, or the part of it up to the section; whether that was reached."""
        with np.errstate(all="ignore"):
            self._series = self._expanded()
            self._length = self._admissible()
        if not self._length > _SHORTEST:
            raise IntegrationFailure("the orbit runs into a singularity")
        height = self._series[section, 0]
        if self._side == 0:
            self._side = 1 if height[1] > 0 else -1
            if abs(height[1]) < 2.0**-20:
                raise IntegrationFailure("the flow is tangent to the section at the start")
        theta = self._first_crossing(height)
        if theta is not None:
            self._length = theta
        self.time += self._length
        if theta is None:
            self._state[: self._states] = self._series @ self._length ** np.arange(_ORDER + 1)
        return theta is not None

    def expansions(self) -> list[list[Jet]]:
        """The jets at the end of the step, and their derivatives in time over factorials, as many as the degree."""
        found = []
        for j in range(self._basis.degree + 1):
            weights = [0.0] * j + [comb(n, j) * self._length ** (n - j) for n in range(j, _ORDER + 1)]
            rows = (self._series @ np.array(weights)).tolist()
            found.append([Jet(self._basis, [self._context.mpf(c) for c in row]) for row in rows])
        return found

    def in_time(self, tau: Jet) -> Jet:
        """A jet in the time of the steps as one in time."""
        return tau

    def _expanded(self) -> Array:
        """Taylor coefficients of the states: shape (states, monomials, 1 + order)."""
        size, levels = len(self._basis.monomials), self._levels
        count = self._inputs + sum(len(level.left) for level in levels)
        nodes = np.zeros((_ORDER + 1, count, size))
        nodes[0, : self._inputs] = self._state
        lefts = [np.zeros((len(level.left), size, _ORDER)) for level in levels]
        rights = [np.zeros((len(level.left), _ORDER, size)) for level in levels]  # the last coefficient first
        inverses: list[Array] = []
        for n in range(_ORDER):
            here = nodes[n]
            for number, (level, left, right) in enumerate(zip(levels, lefts, rights, strict=True)):
                known, place, products = here[: level.before], _ORDER - 1 - n, level.products
                left[:, :, n] = level.left @ known
                right[:products, place] = level.right @ known
                if n == 0:
                    left[:, 0, 0] += level.left_constants
                    right[:products, place, 0] += level.right_constants
                out = here[level.before : level.before + len(left)]
                if products:
                    sums = left[:products, :, : n + 1] @ right[:products, place:]
                    out[:products] = sums.reshape(products, -1) @ self._flat
                if products == len(left):
                    continue
                if n == 0:
                    heads, inverse = self._heads(left[products:, :, 0], level.exponents)
                    out[products:] = heads
                    inverses.append(inverse)
                else:
                    # From a c' = r c a': n a_0 c_n = sum of (r l - (n - l)) a_l c_(n-l), l from 1 to n.
                    weights = [[(float(r) + 1) * l / n - 1 for l in range(1, n + 1)] for r in level.exponents]
                    sums = left[products:, :, 1 : n + 1] * np.array(weights)[:, None] @ right[products:, place + 1 :]
                    totals = sums.reshape(len(left) - products, -1) @ self._flat
                    done = sum(1 for each in levels[:number] if each.exponents)
                    out[products:] = (inverses[done] @ totals[:, :, None])[:, :, 0]
                right[products:, place] = out[products:]
            rates = self._outputs @ here
            if n == 0:
                rates[:, 0] += self._constants
            nodes[n + 1, : self._states] = rates / (n + 1)
        return np.moveaxis(nodes[:, : self._states], 0, 2)

    def _heads(self, bases: Array, exponents: Sequence[Fraction]) -> tuple[Array, Array]:
        """The jets of powers at the start, and the matrices that multiply by the inverses of their bases."""
        heads, inverses = [], []
        for row, exponent in zip(bases.tolist(), exponents, strict=True):
            base = Jet(self._basis, row)
            if row[0] == 0 or not isfinite(row[0]):
                raise IntegrationFailure("division by zero: the orbit meets a singularity")
            if row[0] < 0 and exponent.denominator != 1:
                raise IntegrationFailure("power of a number <= 0: the orbit meets a singularity")
            heads.append(base.power(exponent).coefficients)
            inverses.append(np.einsum("mij,i->mj", self._splits, base.power(Fraction(-1)).coefficients))
        return np.array(heads), np.array(inverses)

    def _admissible(self) -> float:
        """The step that leaves out less than rounding does, and of derivatives somewhat more."""
        sizes = [np.abs(self._series[:, batch]).max(axis=(0, 1), initial=0.0) for batch in self._of_degree]
        lengths = []
        for degree, size in enumerate(sizes):
            start = max(size[0], 1.0 if degree else 0.0)
            tolerance = start * 2.0**-FLOAT_BITS * _JET_SLACK**degree
            last = size[_ORDER - 2 :]
            if not np.isfinite(last).all():
                raise IntegrationFailure("the orbit runs away or into a singularity")
            lengths.append(float(min((tolerance / np.maximum(last, 1e-300)) ** (1 / self._exponents))))
        return min(*lengths, 16.0)

    def _first_crossing(self, height: Array) -> float | None:
        """The first zero of the height in the step, its start apart."""
        times = self._length * np.arange(1, _SAMPLES + 1) / _SAMPLES
        below = np.flatnonzero(self._side * np.polyval(height[::-1], times) < 0)
        if not len(below):
            return None
        coefficients = (self._side * height[::-1]).tolist()
        high = float(times[below[0]])
        low = high - self._length / _SAMPLES
        for _ in range(60):
            middle, value = (low + high) / 2, 0.0
            for c in coefficients:
                value = value * middle + c
            low, high = (low, middle) if value < 0 else (middle, high)
        return (low + high) / 2


def _levels(tape: Tape) -> tuple[list[_Level], Array, Array]:
    """The products and powers of a tape by levels, and its outputs as matrix and constants."""
    kinds, level_of = ("multiply", "invert", "power"), [0] * len(tape.operations)
    for position, operation in enumerate(tape.operations):
        used = [] if operation.code in ("input", "constant") else [operation.left]
        used += [operation.right] if operation.code in ("add", "subtract", "multiply") else []
        level_of[position] = max((level_of[i] for i in used), default=0) + (operation.code in kinds)
    used = ((p, operation) for p, operation in enumerate(tape.operations) if operation.code in kinds)
    order = sorted((level_of[p], operation.code != "multiply", p) for p, operation in used)
    column = {position: tape.inputs + place for place, (_, _, position) in enumerate(order)}
    column |= {position: position for position in range(tape.inputs)}
    forms: list[Array] = []  # of each operation, the constant last
    for position, operation in enumerate(tape.operations):
        form = np.zeros(tape.inputs + len(order) + 1)
        value = float(operation.value)
        if position in column:
            form[column[position]] = 1
        elif operation.code == "constant":
            form[-1] = value
        elif operation.code == "scale":
            form = value * forms[operation.left]
        elif operation.code == "shift":
            form = forms[operation.left].copy()
            form[-1] += value
        else:
            form = forms[operation.left] + (1 if operation.code == "add" else -1) * forms[operation.right]
        forms.append(form)
    levels, before = [], tape.inputs
    for number in sorted({level for level, _, _ in order}):
        operations = [tape.operations[position] for level, _, position in order if level == number]
        products = [operation for operation in operations if operation.code == "multiply"]
        powers = [Fraction(-1) if o.code == "invert" else o.value for o in operations[len(products) :]]
        left = np.array([forms[operation.left] for operation in operations])
        right = np.array([forms[operation.right] for operation in products]).reshape(len(products), left.shape[1])
        operands = left[:, :before], right[:, :before], left[:, -1], right[:, -1]
        levels.append(_Level(before, len(products), *operands, tuple(powers)))
        before += len(operations)
    outputs = np.array([forms[output] for output in tape.outputs])
    return levels, outputs[:, :-1], outputs[:, -1]
