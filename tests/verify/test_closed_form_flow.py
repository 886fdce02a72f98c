"""A third system, given by nothing but its description, whose flow is known in closed form."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import pytest
from flint import ctx
from support.exact_elements import number
from support.flow_checks import (
    Model,
    contains,
    distance_by_grade,
    initial_state,
    kernel_values,
    random_frame,
    random_point,
    reversed_by,
    taylor_enclosure,
    to_section,
)

import orbitproof.verify.flow.step
from orbitproof.shared.claims import Candidate
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading
from orbitproof.verify.claim import check_symmetries
from orbitproof.verify.evidence import Checklist
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import Enclosures, IntegratorSettings, enclose_iterates

DIGITS = 70


def twisted_rotations(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """Two plane rotations whose frequencies depend on the (conserved) radii."""
    a, b, c, d = state
    (omega,) = parameters
    first, second = a * a + b * b, c * c + d * d
    slow = (1 + first) ** -0.5
    fast = omega + (1 + first + second) ** Fraction(-2, 3) + first / (2 + second)
    return (-(slow * b), slow * a, -(fast * d), fast * c)


TWIST = ReversibleSystem(
    name="twist",
    title="two rotations with twist",
    state=("a", "b", "c", "d"),
    parameters={"omega": ParameterRange(Fraction(0), None)},
    vector_field=twisted_rotations,
    reversing_symmetry=(1, -1, 1, -1),
    section="b",
    first_integral=lambda x, _: (x[0] * x[0] + x[1] * x[1] + 3 * (x[2] * x[2] + x[3] * x[3]),),
    first_integral_name="weighted radius",
)

OMEGA = Fraction(7, 5)
RETURNS = 3


@pytest.fixture(autouse=True)
def _precision() -> Iterator[None]:
    with mpmath.workdps(DIGITS), ctx.workprec(400):
        yield


def exact(value: mpmath.mpf) -> Fraction:
    """The fraction that an mpmath number is."""
    return Fraction(int(mpmath.floor(value * mpmath.mpf(2) ** 240)), 2**240)


def return_time(a: Any, crossing: int) -> Any:
    """When the orbit of (a, 0, c, 0) crosses b = 0 for the crossing-th time."""
    return crossing * mpmath.pi * mpmath.sqrt(1 + a * a)


def kernel_coordinate(a: Any, c: Any, crossing: int) -> Any:
    """d at that time."""
    fast = number(OMEGA) + mpmath.power(1 + a * a + c * c, -mpmath.mpf(2) / 3) + a * a / (2 + c * c)
    return c * mpmath.sin(fast * return_time(a, crossing))


SETTINGS = IntegratorSettings(precision=140)


def twist_box(omega: Fraction = OMEGA) -> Candidate:
    """A box of Fix(R); dyadic, so that its initial values have no rounding that could hide another error."""
    source = random.Random(8)
    return Candidate(
        "twist", TWIST, {"omega": omega}, "period_tupling", RETURNS, (Fraction(13, 32), Fraction(5, 16)),
        random_frame(source, 2), random_frame(source, 1), (Fraction(1, 2**66), Fraction(1, 2**36)),
    )  # fmt: skip


@cache
def returns() -> tuple[Candidate, Enclosures]:
    """The box and its first three returns."""
    return twist_box(), enclose_iterates(twist_box(), SETTINGS, ORACLE)


def escapes(candidate: Candidate, found: Enclosures, points: int) -> int:
    """How many returns of random points lie outside their enclosure."""
    source = random.Random(3)
    count = 0
    tolerance = Fraction(1, 2**200)
    for _ in range(points):
        p = random_point(source, candidate)
        state, _ = initial_state(candidate, p)
        a, c = number(state[0]), number(state[2])
        for i, (tables, time) in enumerate(zip(found.iterates, found.return_times, strict=True), 1):
            arrival = [Fraction(0)] * 3 + [exact(kernel_coordinate(a, c, i))]
            (value,) = kernel_values(candidate, arrival)
            inside = contains(taylor_enclosure(tables[0], p), value, tolerance)
            count += not (inside and contains(time, exact(return_time(a, i)), tolerance))
    return count


def test_closed_form_returns_are_enclosed() -> None:
    assert escapes(*returns(), 300) == 0


def test_more_precision_is_not_worse() -> None:
    """A rotation has no singularity to bound the steps, whose Taylor sums grow with the angle of a step."""
    widths = []
    for precision in (100, 180, 260):
        found = enclose_iterates(twist_box(), IntegratorSettings(precision), ORACLE)
        widths.append(float(found.iterates[-1][0].centre[0, 0].rad()))
    assert widths[0] > 2**40 * widths[1] > 2**80 * widths[2] > 0


def test_the_description_shows_the_symmetry() -> None:
    checklist = Checklist()
    check_symmetries(checklist, TWIST)
    assert [hypothesis.holds for hypothesis in checklist.hypotheses] == [True]


def derivatives(candidate: Candidate, p: Sequence[Fraction], alpha: tuple[int, ...], crossing: int) -> Fraction:
    """A partial derivative of the closed form in the coordinates of the box."""
    frame = [[number(value) for value in row] for row in candidate.frame]
    middle = [number(value) for value in candidate.centre]

    def value(*q: Any) -> Any:
        a, c = (m + row[0] * q[0] + row[1] * q[1] for m, row in zip(middle, frame, strict=True))
        return number(candidate.kernel_frame[0][0]) * kernel_coordinate(a, c, crossing)

    return exact(mpmath.diff(value, tuple(map(number, p)), alpha) if any(alpha) else value(*map(number, p)))


def test_closed_form_derivatives_are_enclosed() -> None:
    candidate, found = returns()
    source = random.Random(4)
    points = [random_point(source, candidate) for _ in range(10)] + [(Fraction(0), Fraction(0))]
    for i, (table,) in enumerate(found.iterates, 1):
        for alpha in table.box:
            for p in points:
                value = derivatives(candidate, p, alpha, i)
                assert contains(table.box[alpha], value, Fraction(1, 2**40))
                if not any(p):
                    assert contains(table.centre[alpha], value, Fraction(1, 2**40))


def test_derivatives_of_the_kept_grades_are_sharp() -> None:
    candidate, found = returns()
    for i, (table,) in enumerate(found.iterates, 1):
        for alpha in ((0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 1)):
            value = derivatives(candidate, (Fraction(0), Fraction(0)), alpha, i)
            assert float(table.centre[alpha].rad()) < 1e-5
            assert abs(float(table.box[alpha].mid()) - float(value)) < 1e-4 * max(1.0, abs(float(value)))


def test_the_first_integral_is_enclosed() -> None:
    candidate, found = returns()
    assert found.first_integral is not None
    source = random.Random(5)
    for _ in range(50):
        p = random_point(source, candidate)
        a, _, c, _ = initial_state(candidate, p)[0]
        assert contains(taylor_enclosure(found.first_integral, p), a * a + 3 * c * c)


def test_reversed_return_undoes_the_return() -> None:
    """R P R P on a box of the whole section, derivatives to order 3."""
    arithmetic = Arithmetic(Grading((1, 1, 1), 3), 110, 12, 40)
    unit = [tuple(int(i == j) for i in range(3)) for j in range(3)]
    rows = [("0.4", 0), ("0", None), ("0.3", 1), ("0.2", 2)]
    start = [
        arithmetic.polynomial({(0, 0, 0): Fraction(m)} | ({} if j is None else {unit[j]: Fraction(1, 10**9)}))
        for m, j in rows
    ]
    model = Model(arithmetic, tuple(start), (arithmetic.constant(OMEGA),))
    for _ in range(2):
        (a, *_), _ = model.middle
        image, _ = to_section(TWIST, model, exact(return_time(number(a), 1)), 16)
        model = reversed_by(TWIST, image)
    for returned, initial in zip(model.state, start, strict=True):
        distances = distance_by_grade(returned, initial)
        for distance, error, bound in zip(distances, returned.errors, initial.errors, strict=True):
            assert distance <= Fraction(error) + Fraction(bound)
        assert returned.errors[0] < 1e-20


def test_an_integrator_without_its_defect_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        orbitproof.verify.flow.step, "_defect", lambda solution, field, step: solution.arithmetic.zero_errors()
    )
    found = enclose_iterates(twist_box(), SETTINGS, ORACLE)
    assert escapes(twist_box(), found, 3) > 0


def test_a_wrong_field_is_caught() -> None:
    """The closed form belongs to this field only: a field that differs by 1e-20 leads elsewhere."""
    moved = twist_box(OMEGA + Fraction(1, 10**20))
    assert escapes(moved, enclose_iterates(moved, SETTINGS, ORACLE), 3) > 0
