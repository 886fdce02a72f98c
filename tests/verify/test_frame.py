"""Errors in a frame that steps hand on: exact solutions stay inside, whatever frames an oracle finds (section 4.4)."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import product
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import fmpz_mat, fmpz_poly
from support.exact_elements import (
    Element,
    Unknown,
    exponents_of_grade,
    is_enclosed,
    number,
    packed_from,
    random_point,
    rows_of,
)
from support.within import within

from orbitproof.shared.systems import record
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic, prepare
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import FlowStep, InFrame, advance, planned_step
from orbitproof.verify.flow.field_along import FieldAlong
from orbitproof.verify.flow.frame import Frame, _defect, _Over
from orbitproof.verify.flow.gronwall import norm_arithmetic
from orbitproof.verify.flow.step import enclose_step
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.frames import Frames

REFUSALS = (IntegrationFailure, ArithmeticError, ValueError)
FORMATS: dict[str, Arithmetic] = {
    "values": Arithmetic(Grading((), 0), 90, 0, 24),
    "first": Arithmetic(Grading((1, 1), 1), 90, 4, 24),
    "second": Arithmetic(Grading((1,), 2), 90, 4, 24),
    "wide": WideArithmetic(Grading((1,), 1), 70, 4, 16, width=3),
}
RATES = ((-1, 5, 0), (-4, -1, 1), (2, 0, -6))
"""A matrix that turns and contracts, and is not normal."""

_precision = within(lambda: mpmath.workprec(200))


def linear(u: Sequence[Any]) -> list[Any]:
    return [sum((rate * x for rate, x in zip(row[1:], u[1:], strict=True)), row[0] * u[0]) for row in RATES]


def sheared(state: Sequence[Any]) -> Sequence[Any]:
    """The field of (u, v + u^2, w + u v) where (u, v, w)' is the matrix above times (u, v, w)."""
    x, y, z = state
    u = [x, y - x * x, z - x * (y - x * x)]
    slopes = linear(u)
    return [
        slopes[0],
        slopes[1] + 2 * (u[0] * slopes[0]),
        slopes[2] + slopes[0] * u[1] + u[0] * slopes[1],
    ]


PROGRAM = prepare(record(sheared, ("x", "y", "z")))


def flowed(state: Sequence[Any], time: Any) -> list[Any]:
    x, y, z = state
    v = y - x * x
    u = mpmath.expm(mpmath.matrix([[mpmath.mpf(rate) * time for rate in row] for row in RATES])) * mpmath.matrix(
        [x, v, z - x * v]
    )
    return [u[0], u[1] + u[0] ** 2, u[2] + u[0] * u[1]]


def begun(source: random.Random, arithmetic: Arithmetic, unknown: float, bits: int = 12) -> list[Element]:
    """Elements without theta about a point: known parts, small with many bits, and unknown ones up to a size."""
    grading = arithmetic.grading
    elements = []
    for centre in (0.5, -0.25, 0.375):
        small: dict[Any, Any] = {
            e: Fraction(centre) if not any(e) else Fraction(source.randint(-64, 64), 2**bits) for e in grading.monomials
        }
        if arithmetic.width:
            small[grading.monomials[0]] = [Fraction(centre), Fraction(source.randint(-64, 64), 2**bits)]
        parts = []
        for slot in range(grading.top + 2):
            monomials = exponents_of_grade(grading, slot)
            if monomials:
                exponents = source.choice(monomials)
                exponents = (*exponents, source.randrange(3)) if arithmetic.width else exponents
                parts.append((slot, Unknown(unknown * 4.0 ** source.uniform(-3, 0), exponents, 0)))
        series = arithmetic.polynomial(small)
        errors = list(series.errors)
        for slot, part in parts:
            errors[slot] += part.size
        elements.append(Element(series.with_errors(errors), tuple(part for _, part in parts)))
    return elements


def followed(
    elements: Sequence[Element], oracle: Any, count: int, carried: bool = True
) -> tuple[list[tuple[Fraction, Fraction, FlowStep]], InFrame]:
    """Time before, length and enclosure of some steps."""
    steps, state, time, inside = [], [x.series for x in elements], Fraction(0), InFrame(oracle)
    for _ in range(count):
        expansion = ORACLE.expand(PROGRAM, state[0].arithmetic, state, [])
        step = expansion.shortened(planned_step(expansion.step_size, 0.5, 0.0))
        if carried:
            flow = inside.advance(PROGRAM, state, [], expansion, step)
        else:
            flow = advance(PROGRAM, state, [], expansion, step)
        steps.append((time, step, flow))
        time, state = time + step, list(flow.end)
    return steps, inside


def holds(source: random.Random, elements: Sequence[Element], steps: Any, points: int) -> bool:
    """Whether exact solutions are in all enclosures, on the steps and at their ends."""
    arithmetic = elements[0].series.arithmetic
    for before, step, flow in steps:
        for _ in range(points):
            theta, t, point = random_point(source, arithmetic.grading, wide=bool(arithmetic.width))
            start = [x.at(mpmath.mpf(0), point) for x in elements]
            for when, enclosures in ((theta, flow.solution), (mpmath.mpf(1), flow.end)):
                exact = flowed(start, number(before) + when * number(step))
                if not all(is_enclosed(x, y, when, t, point) for x, y in zip(enclosures, exact, strict=True)):
                    return False
    return True


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("unknown", [1e-4, 1e-9, 1e-18])
def test_exact_solutions_stay_inside(name: str, unknown: float) -> None:
    source = random.Random(f"{name} {unknown}")
    elements = begun(source, FORMATS[name], unknown)
    steps, inside = followed(elements, ORACLE, 8)
    assert inside._frame is not None
    assert holds(source, elements, steps, 4)


@pytest.mark.parametrize("name", ["values", "first", "wide"])
def test_what_is_contracted_becomes_small(name: str) -> None:
    elements = begun(random.Random(name), FORMATS[name], 1e-9, bits=24)
    count = 32
    (*_, (time, step, framed)), _ = followed(elements, ORACLE, count)
    (*_, (_, _, entrywise)), _ = followed(elements, ORACLE, count, carried=False)
    rates = mpmath.matrix([[rate * number(time + step) for rate in row] for row in RATES])
    contracted = float(mpmath.norm(mpmath.expm(rates), mpmath.inf))
    ours, theirs = (max(x.errors[0] for x in flow.end) for flow in (framed, entrywise))
    assert ours < 32 * contracted * 1e-9
    assert theirs > 8 * ours


class Spoiled(Frames):
    """Finds frames, and gives something else."""

    def __init__(
        self,
        columns: Callable[[Any, Any, Any], Any] = lambda found, frame, coarse: found,
        frames: Callable[[Any, Any, Any], Any] = lambda found, before, bits: found,
    ) -> None:
        self._spoil, self._frames, self._before = columns, frames, None
        self.asked = 0

    def columns(self, slopes: Any, frame: Any, step: Any, coarse: Any) -> Any:
        self.asked += 1
        return self._spoil(super().columns(slopes, frame, step, coarse), frame, coarse)

    def next_frame(self, end: Any, bounds: Any, bits: int) -> Any:
        found = super().next_frame(end, bounds, bits)
        result = self._frames(found, self._before, bits)
        self._before = found
        return result


def _every(change: Callable[[fmpz_poly, int, int], fmpz_poly]) -> Callable[[Any, Any, Any], Any]:
    return lambda found, frame, coarse: [
        [change(p, i, coarse.stride) for i, p in enumerate(row)] for row in found
    ]  # fmt: skip


def _power(exponent: int, size: int) -> fmpz_poly:
    return fmpz_poly([0] * exponent + [size])


SPOILED_COLUMNS: dict[str, Any] = {
    "nothing but the frame": _every(lambda p, i, stride: p.truncate(1)),
    "a little more": _every(lambda p, i, stride: p + _power(stride, 2**60)),
    "much more": _every(lambda p, i, stride: p + _power(3 * stride, 2**90)),
    "another beginning": _every(lambda p, i, stride: p + 2**40),
    "the other sign": _every(lambda p, i, stride: -p),
    "too long": _every(lambda p, i, stride: p + _power(500 * stride, 1)),
    "too many powers of s": _every(lambda p, i, stride: p + _power(2 * stride - 1, 2**50)),
    "a column too few": lambda found, frame, coarse: [row[1:] for row in found],
    "a row too many": lambda found, frame, coarse: [*found, found[0]],
    "rows for columns": lambda found, frame, coarse: [list(row) for row in zip(*found, strict=True)],
    "nothing": lambda found, frame, coarse: None,
}


def _by(change: Callable[[list[list[int]], int], list[list[Any]]], which: int = 0) -> Any:
    def spoil(found: Any, _before: Any, bits: int) -> Any:
        changed = list(found)
        changed[which] = fmpz_mat(change([[int(x) for x in row] for row in found[which].tolist()], bits))
        return tuple(changed)

    return spoil


SPOILED_FRAMES: dict[str, Any] = {
    "zero": _by(lambda rows, bits: [[0] * 3 for _ in rows]),
    "singular": _by(lambda rows, bits: [rows[0], rows[0], rows[2]]),
    "nearly singular": _by(lambda rows, bits: [rows[0], [x + 1 for x in rows[0]], rows[2]]),
    "an inverse of zero": _by(lambda rows, bits: [[0] * 3 for _ in rows], 1),
    "an inverse of the wrong sign": _by(lambda rows, bits: [[-x for x in row] for row in rows], 1),
    "an inverse that is not known well": _by(lambda rows, bits: [[x + x // 5 for x in row] for row in rows], 1),
    "not orthogonal": lambda found, before, bits: (
        fmpz_mat([[2**bits, 2 ** (bits - 1), 0], [0, 2**bits, 0], [0, 0, 2**bits]]),
        fmpz_mat([[2**bits, -(2 ** (bits - 1)), 0], [0, 2**bits, 0], [0, 0, 2**bits]]),
    ),
    "huge": lambda found, before, bits: (found[0] * 2**200, found[1]),
    "scaled": lambda found, before, bits: (
        found[0] * 2**20,
        fmpz_mat([[int(x) >> 20 for x in row] for row in found[1].tolist()]),
    ),
    "stale": lambda found, before, bits: before or found,
    "half stale": lambda found, before, bits: (found[0], (before or found)[1]),
    "of another size": lambda found, before, bits: (fmpz_mat(2, 2), fmpz_mat(2, 2)),
}  # fmt: skip


@pytest.mark.parametrize("which", [*SPOILED_COLUMNS, *SPOILED_FRAMES])
@pytest.mark.parametrize("name", ["first", "wide"])
def test_a_wrong_frame_widens_or_is_refused(name: str, which: str) -> None:
    source = random.Random(f"{name} {which}")
    elements = begun(source, FORMATS[name], 1e-7)
    if which in SPOILED_COLUMNS:
        oracle = Spoiled(columns=SPOILED_COLUMNS[which])
    else:
        oracle = Spoiled(frames=SPOILED_FRAMES[which])
    try:
        steps, _ = followed(elements, oracle, 5)
    except REFUSALS:
        assert oracle.asked
        return
    assert oracle.asked >= 5
    assert holds(source, elements, steps, 2)


UNFIT: dict[str, Any] = {
    "half of it": _every(lambda p, i, stride: fmpz_poly([int(c) // 2 for c in p.coeffs()])),
    "another beginning of the last column": _every(lambda p, i, stride: p + (i == 2) * 2**50),
    "another beginning at s alone": _every(lambda p, i, stride: p + _power(1, 2**50)),
    "too long": SPOILED_COLUMNS["too long"],
    "powers of s that run into others": SPOILED_COLUMNS["too many powers of s"],
}


@pytest.mark.parametrize("which", UNFIT)
def test_columns_that_do_not_begin_at_the_frame_or_do_not_fit_are_not_used(which: str) -> None:
    """The step is taken without them."""
    elements = begun(random.Random(1), FORMATS["wide"], 1e-5)
    ((_, _, entrywise),), _ = followed(elements, ORACLE, 1, False)
    ((_, _, found),), inside = followed(elements, Spoiled(columns=UNFIT[which]), 1)
    assert inside._frame is None
    assert [x.errors for x in found.end] == [x.errors for x in entrywise.end]


@pytest.mark.parametrize("replaced", [(0, 1, 2), (0,), (1,), (2,)])
def test_the_frame_of_one_state_is_not_that_of_another(replaced: Sequence[int]) -> None:
    """A larger set begins anew, also where its elements have the same known parts and only one is another."""
    elements = begun(random.Random(2), FORMATS["values"], 1e-9)
    state, inside = [x.series for x in elements], InFrame(ORACLE)
    expansion = ORACLE.expand(PROGRAM, state[0].arithmetic, state, [])
    step = planned_step(expansion.step_size, 0.25, 0.0)
    first = inside.advance(PROGRAM, state, [], expansion, step)
    larger = [x.with_errors([1e-3, *x.errors[1:]]) if i in replaced else x for i, x in enumerate(first.end)]
    again = ORACLE.expand(PROGRAM, larger[0].arithmetic, larger, [])
    wide = inside.advance(PROGRAM, larger, [], again, step)
    alone = InFrame(ORACLE).advance(PROGRAM, larger, [], again, step)
    assert [x.errors for x in wide.end] == [x.errors for x in alone.end]
    assert max(x.errors[0] for x in wide.end) > 1e-4


def test_a_step_that_was_tried_leaves_the_frame_of_its_state() -> None:
    """A failure changes nothing: the state at which the step begins has the frame that it had."""
    elements = begun(random.Random(3), FORMATS["first"], 1e-6)
    ends = []
    for fails in (False, True):
        state, inside = [x.series for x in elements], InFrame(ORACLE)
        for _ in range(3):
            expansion = ORACLE.expand(PROGRAM, state[0].arithmetic, state, [])
            step = planned_step(expansion.step_size, 0.25, 0.0)
            if fails:
                with pytest.raises(IntegrationFailure):
                    inside.advance(PROGRAM, state, [], expansion, 2**12 * step)
                expansion = ORACLE.expand(PROGRAM, state[0].arithmetic, state, [])
            state = list(inside.advance(PROGRAM, state, [], expansion, step).end)
        ends.append([x.errors for x in state])
    assert ends[0] == ends[1]


def test_nothing_is_left_of_an_attempt_with_another_tube() -> None:
    """Where columns are found at first only, the end has the bounds of the larger tube, and no frame."""
    coarse = Arithmetic(Grading((), 0), 90, 0, 24)
    rates = [[-2.0, 1.0], [0.5, -1.0]]

    def slopes(spread: float) -> list[dict[int, Series]]:
        return [
            {j: Series(coarse, [fmpz_poly([int(x * 2.0**90)])], [spread, spread]) for j, x in enumerate(row)}
            for row in rates
        ]

    class Once(Frames):
        asked = 0

        def columns(self, *arguments: Any) -> Any:
            self.asked += 1
            return super().columns(*arguments) if self.asked == 1 else None

    bounds, defects, step = np.full((2, 2), 1e-3), np.full((2, 2), 1e-9), Fraction(1, 8)
    over = _Over(Frame(fmpz_mat([[2**90, 0], [0, 2**90]]), 90, bounds), Once())
    over.errors(slopes(0.0), bounds + defects, defects, step)
    assert over.last is not None
    assert over.following is not None
    over.errors(slopes(1.0), bounds + defects, defects, step)
    assert over.last is None
    assert over.following is None


@pytest.mark.parametrize("name", ["first", "wide"])
@pytest.mark.parametrize("seed", range(10))
def test_the_defect_of_columns_bounds_its_values_exactly(name: str, seed: int) -> None:
    """h P Y - Y' at random times and points of the wide variable, in fractions; h need not be dyadic."""
    source = random.Random(f"{name} {seed}")
    coarse = norm_arithmetic(FORMATS[name])
    size, unit = source.randint(1, 3), Fraction(1, 2**coarse.bits)

    def polynomial(degree: int) -> fmpz_poly:
        """One coefficient is much the largest, so that a bound has nothing to spare."""
        rows = [
            [source.randint(-(2 ** (coarse.bits - 30)), 2 ** (coarse.bits - 30)) for _ in range(coarse.width + 1)]
            for _ in range(degree + 1)
        ]
        rows[0][0] = source.choice((-1, 1)) * source.randint(2 ** (coarse.bits - 2), 2**coarse.bits)
        return packed_from(coarse, rows)

    known = [[polynomial(3) for _ in range(size)] for _ in range(size)]
    columns = [[polynomial(4) for _ in range(size)] for _ in range(size)]
    slopes = [{j: Series(coarse, [p], coarse.zero_errors()) for j, p in enumerate(row)} for row in known]
    step = Fraction(source.randint(1, 40), source.choice((3, 7, 16, 33, 127)))
    bounds = _defect(slopes, columns, step, coarse)

    def value(p: fmpz_poly, theta: Fraction, s: Fraction, derived: bool = False) -> Fraction:
        result = Fraction(0)
        for n, row in enumerate(rows_of(coarse, p)):
            power = n * theta ** max(n - 1, 0) if derived else theta**n
            result += sum((c * s**j for j, c in enumerate(row)), Fraction(0)) * power * unit
        return result

    for theta, s in product((Fraction(0), Fraction(1), Fraction(source.randint(0, 99), 99)), (-1, 1, Fraction(1, 3))):
        for i, k in product(range(size), repeat=2):
            exact = sum(
                (value(known[i][j], theta, s) * value(columns[j][k], theta, s) for j in range(size)), Fraction(0)
            )
            exact = step * exact - value(columns[i][k], theta, s, derived=True)
            assert abs(exact) <= Fraction(float(bounds[i, k]))


@pytest.mark.parametrize("slot", range(4))
@pytest.mark.parametrize("component", range(3))
@pytest.mark.parametrize("factor", [1.0, 8.0])
def test_errors_that_reach_the_tube_in_one_slot_need_a_larger_one(slot: int, component: int, factor: float) -> None:
    """Whoever bounds them; as large as the tube is too large."""
    state = [x.series for x in begun(random.Random(4), FORMATS["second"], 1e-6)]
    expansion = ORACLE.expand(PROGRAM, state[0].arithmetic, state, [])
    step = planned_step(expansion.step_size, 0.25, 0.0)
    along = FieldAlong(PROGRAM, state[0].arithmetic, state, [])
    expansion.solve(along, step)
    tried = []

    def bound(slopes: Any, start: Any, defects: Any, step: Fraction) -> Any:
        errors = 2.0 * start
        tried.append(errors)
        if len(tried) == 1:
            errors[component, slot] = factor * (16.0 * start[component, slot] + 2.0**-950)
        return errors

    enclose_step(along, step, bound)
    assert len(tried) == 2


def random_matrix(source: random.Random, size: int, bits: int) -> fmpz_mat:
    return fmpz_mat([[int(source.uniform(-1, 1) * 2**bits) for _ in range(size)] for _ in range(size)])


def inverse_of(matrix: fmpz_mat, bits: int) -> list[list[Fraction]]:
    """The exact inverse of matrix times 2^-bits."""
    inverse = matrix.inv()
    return [[Fraction(int(x.p), int(x.q)) * 2**bits for x in row] for row in inverse.tolist()]


@pytest.mark.parametrize("powers", [1, 3])
@pytest.mark.parametrize("seed", range(20))
def test_the_bounds_in_the_next_frame_are_those_of_all_errors(seed: int, powers: int) -> None:
    """The greatest coordinates of X eta + r, exactly, for frames and inverses that are known badly, too.

    X is a polynomial in the wide variable.
    """
    source = random.Random(seed)
    taken = 0
    for _ in range(60):
        size, bits = source.randint(1, 4), 60
        parts = [random_matrix(source, size, bits) for _ in range(powers)]
        matrix = random_matrix(source, size, bits)
        if matrix.det() == 0:
            continue
        exact = inverse_of(matrix, bits)
        wrong = source.choice((0.0, 1e-9, 0.03, 0.3))
        inverse = fmpz_mat(
            [[int(x * 2**bits * (1 + Fraction(source.uniform(-wrong, wrong)))) for x in row] for row in exact]
        )
        bounds, rest = (
            np.array([[10.0 ** source.uniform(-12, 0) for _ in range(2)] for _ in range(size)]) for _ in range(2)
        )

        class Given(Frames):
            def next_frame(self, *_: Any, given: Any = (matrix, inverse)) -> Any:
                return given

        over = _Over(Frame(random_matrix(source, size, bits), bits, bounds), Given())
        end = [[fmpz_poly([int(part[i, j]) for part in parts]) for j in range(size)] for i in range(size)]
        found = over._next(end, rest)
        if found is None:
            continue
        taken += 1
        s = Fraction(source.choice((-1, 1)))
        reached = [
            [sum((Fraction(int(c), 2**bits) * s**n for n, c in enumerate(p.coeffs())), Fraction(0)) for p in row]
            for row in end
        ]
        for slot in range(2):
            for i in range(size):
                along = [sum(exact[i][k] * reached[k][j] for k in range(size)) for j in range(size)]
                reach = sum(abs(a) * Fraction(float(h)) for a, h in zip(along, bounds[:, slot], strict=True))
                reach += sum(abs(a) * Fraction(float(b)) for a, b in zip(exact[i], rest[:, slot], strict=True))
                assert Fraction(float(found.bounds[i, slot])) >= reach
    assert taken > 10


@pytest.mark.parametrize("top", [0, 1])
@pytest.mark.parametrize("seed", range(24))
def test_errors_of_linear_equations_are_bounded_grade_by_grade(top: int, seed: int) -> None:
    """e' = h A e + d with A anywhere in its bounds, hundreds of them by Runge and Kutta."""
    source = np.random.default_rng(100 * top + seed)
    size, bits, samples = int(source.integers(1, 4)), 90, 300
    slots = top + 2
    coarse = Arithmetic(Grading((), top), bits, 0, 24)
    known = source.uniform(-2, 2, (3, size, size)) - 2 * np.eye(size)
    if seed % 2:
        known = np.where(np.eye(size) > 0, known, 1e-9 * known)
    spread = 10.0 ** (source.uniform(-4, -0.7, (slots, 1, 1)) + source.uniform(-0.5, 0, (slots, size, size)))
    # Mostly of one grade each, so that what a product of the two gives is seen in its own grade.
    chosen, own = source.integers(0, slots, 2)
    spread[np.arange(slots) != chosen] *= 1e-4
    slopes = [
        {
            j: Series(coarse, [fmpz_poly([int(c * 2.0**bits) for c in known[:, i, j]])], spread[:, i, j].tolist())
            for j in range(size)
        }
        for i in range(size)
    ]
    frame = source.uniform(-1, 1, (size, size)) + 2 * np.eye(size)
    bounds = 10.0 ** source.uniform(-1, 0, (size, slots))
    if seed % 2:
        # One component is much better known than others, and hardly depends on them but for what is unknown.
        frame = np.where(np.eye(size) > 0, frame, 1e-9 * frame)
        bounds[source.integers(size)] *= 1e-6
    integers = fmpz_mat([[int(x * 2.0**bits) for x in row] for row in frame])
    bounds[:, np.arange(slots) != own] *= 1e-5
    defects = 10.0 ** (source.uniform(-9, -1, (1, slots)) + source.uniform(-1, 0, (size, slots)))
    careless = _every(lambda p, i, stride: p + _power(2, int(source.choice((0, 0, 2**86)))))
    step = Fraction(int(source.integers(5, 40)), 64)
    over = _Over(Frame(integers, bits, bounds), Spoiled(columns=careless))
    errors = over.errors(slopes, bounds, defects, step)
    assert over.last is not None
    assert over.following is not None
    # One number for each grade, and one for all that is beyond the top.
    signs = source.choice((-1.0, 1.0), (samples, slots, size, size))
    matrices = np.swapaxes(signs * spread, 0, 1)
    eta = source.choice((-1.0, 1.0), (samples, slots, size)) * bounds.T
    force = source.choice((-1.0, 1.0), (samples, slots, size)) * defects.T
    state = np.einsum("ij,ngj->ngi", frame, eta)

    def slope(theta: float, e: Any) -> Any:
        result = np.einsum("ij,ngj->ngi", known[0] + theta * known[1] + theta**2 * known[2], e)
        for a, b in product(range(slots), repeat=2):
            result[:, min(a + b, slots - 1)] += np.einsum("nij,nj->ni", matrices[a], e[:, b])
        return float(step) * result + force

    count = 64
    for n in range(count):
        theta, h = n / count, 1 / count
        k1 = slope(theta, state)
        k2 = slope(theta + h / 2, state + h / 2 * k1)
        k3 = slope(theta + h / 2, state + h / 2 * k2)
        k4 = slope(theta + h, state + h * k3)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        assert (errors * (1 + 1e-6) >= np.abs(state).max(axis=0).T).all()
    assert (over.last * (1 + 1e-6) >= np.abs(state).max(axis=0).T).all()
    matrix = np.array([[float(int(x)) * 2.0**-bits for x in row] for row in over.following.matrix.tolist()])
    coordinates = np.einsum("ij,ngj->ngi", np.linalg.inv(matrix), state)
    assert (over.following.bounds * (1 + 1e-6) >= np.abs(coordinates).max(axis=0).T).all()


@pytest.mark.parametrize("rate", [2, 3, 4])
def test_what_is_not_followed_grows_on_the_whole_step(rate: int) -> None:
    """e' = rate e, in columns that stay where they begin."""
    coarse = Arithmetic(Grading((), 0), 90, 0, 24)
    slopes = [{0: Series(coarse, [fmpz_poly([rate << 90])], [0.0, 0.0])}]
    bounds, defects = np.array([[1e-3, 1e-3]]), np.zeros((1, 2))
    over = _Over(Frame(fmpz_mat([[2**90]]), 90, bounds), Spoiled(columns=SPOILED_COLUMNS["nothing but the frame"]))
    errors = over.errors(slopes, bounds, defects, Fraction(1))
    assert over.last is not None
    assert min(errors.min(), over.last.min()) >= 1e-3 * np.exp(rate)
