"""The linear equation of the first variation, solved term by term in theta."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from flint import fmpq_poly, fmpz, fmpz_poly

from orbitproof.verify.oracle import linear_equation
from orbitproof.verify.oracle.linear_equation import LinearEquation

BITS = 200
UNIT = 2**BITS


def decaying(source: random.Random, length: int, bits: int = 1) -> fmpz_poly:
    """Each coefficient is about `bits` bits shorter than the one before."""
    return fmpz_poly([int(source.uniform(-1, 1) * UNIT) >> bits * n for n in range(length)])


def defect(
    jacobian: list[dict[int, fmpz_poly]],
    forcing: list[fmpz_poly],
    solution: list[fmpz_poly],
    step: Fraction,
    degree: int,
) -> Fraction:
    """The largest coefficient of v' - step * (J v + forcing) below theta^degree, exactly, in units."""
    worst = Fraction(0)
    for row, force, component in zip(jacobian, forcing, solution, strict=True):
        slope = fmpq_poly(force)
        for j, entry in row.items():
            slope += fmpq_poly(entry * solution[j]) / UNIT
        difference = fmpq_poly(component.derivative()) - slope * step.numerator / step.denominator
        sizes = [abs(Fraction(int(c.p), int(c.q))) for c in difference.coeffs()[:degree]]
        worst = max([worst, *sizes])
    return worst


@pytest.mark.parametrize("blocks", [1, 3, 8, 40])
@pytest.mark.parametrize("degree", [1, 7, 30, 53])
def test_the_equation_holds_up_to_rounding(degree: int, blocks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Components with a varying slope, a constant one, none that depends on them, and no slope at all."""
    monkeypatch.setattr(linear_equation, "_BLOCKS", blocks)
    source = random.Random(degree)
    jacobian = [
        {0: decaying(source, degree), 1: decaying(source, degree // 2 + 2), 2: fmpz_poly([UNIT])},
        {0: decaying(source, degree + 1), 2: decaying(source, degree + 1)},
        {0: fmpz_poly([-UNIT]), 1: fmpz_poly([UNIT // 3])},
        {0: decaying(source, degree + 1), 2: fmpz_poly([UNIT])},
        {},
    ]
    forcings = [
        [decaying(source, length) for length in lengths] for lengths in ((degree + 1, 2, 0, degree, 3), [0] * 5)
    ]
    starts = [[fmpz_poly([source.randrange(-UNIT, UNIT)]) for _ in range(4)] + [fmpz_poly([])] for _ in forcings]
    step = Fraction(5, 16)
    solutions = LinearEquation(jacobian, BITS, degree, step).solutions(forcings, starts)
    for forcing, start, solution in zip(forcings, starts, solutions, strict=True):
        assert [p[0] for p in solution] == [p[0] for p in start]
        assert all(p.degree() <= degree for p in solution)
        # One unit for each coefficient of J over the step, one for the slope, times degree for the division by n + 1.
        rounding = 4 * (degree + 2)
        assert defect(jacobian, forcing, solution, step, degree) < rounding
        solution[1] += fmpz_poly([0, fmpz(10 * rounding)])
        assert defect(jacobian, forcing, solution, step, degree) > rounding


@pytest.mark.parametrize("late", [False, True])
def test_a_series_ends_where_its_coefficients_fall_below_their_unit(late: bool) -> None:
    """Not before all of the forcing, which may begin where the solution has vanished."""
    source = random.Random(1)
    degree = 100
    jacobian = [{0: decaying(source, degree, 8), 1: decaying(source, degree, 8)}, {0: decaying(source, degree, 8)}, {}]
    force = decaying(source, degree, 8) + (fmpz_poly([0] * 90 + [UNIT]) if late else fmpz_poly([]))
    forcing = [force, fmpz_poly([]), force]
    step = Fraction(1, 2)
    [solution] = LinearEquation(jacobian, BITS, degree, step).solutions([forcing], [[fmpz_poly([UNIT])] * 3])
    assert all((p.length() > 90) == (late or p.length() < 20) for p in solution)
    assert defect(jacobian, forcing, solution, step, degree) < 4 * (degree + 2)


def test_an_equation_without_coefficients_is_integrated() -> None:
    solutions = LinearEquation([{}, {}], BITS, 4, Fraction(1, 2)).solutions(
        [[fmpz_poly([UNIT]), fmpz_poly([])]], [[fmpz_poly([3]), fmpz_poly([5])]]
    )
    assert solutions == [[fmpz_poly([3, UNIT // 2]), fmpz_poly([5])]]
