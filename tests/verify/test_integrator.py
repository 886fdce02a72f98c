"""The integrator encloses the truth: orbits of random points, derivatives, return times, reversibility."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import pytest
from flint import ctx
from support.flow_checks import (
    Model,
    contains,
    distance_by_grade,
    falkner_skan_box,
    follow,
    halo,
    initial_state,
    kernel_values,
    orbits,
    random_fraction,
    random_point,
    reversed_by,
    series_at,
    taylor_enclosure,
    to_section,
)
from support.reference import finite_differences

import orbitproof.verify.flow.gronwall
import orbitproof.verify.flow.step
from orbitproof.shared.claims import Candidate
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS, ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading, prepare
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import advance
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.solution import CentreExpansion
from orbitproof.verify.poincare import Enclosures, IntegratorSettings, enclose_iterates, grading_for

# Boxes by name: candidate and precision in bits. The radii are so different from one box to the next that once the
# error of the orbit and once the higher derivatives decide; the two gradings of the theorems occur with both systems.
BOXES: dict[str, tuple[Callable[[], Candidate], int]] = {
    "earth-moon wide": (lambda: halo("earth-moon", "period_tupling", ("1e-10", "1e-6", "1e-10"), seed=1), 80),
    "earth-moon narrow": (lambda: halo("earth-moon", "period_tupling", ("1e-16", "1e-9", "1e-16"), seed=2), 100),
    "sun-jupiter": (lambda: halo("sun-jupiter", "touch_and_go", ("1e-10", "1e-9", "1e-16"), seed=3), 90),
    "Falkner-Skan wide": (lambda: falkner_skan_box("period_tupling", 2, ("1e-7", "1e-9"), seed=4), 80),
    "Falkner-Skan narrow": (lambda: falkner_skan_box("touch_and_go", 2, ("1e-9", "1e-12"), seed=5), 110),
}


def test_radii_below_what_float_bounds_resolve_are_refused_without_asking_for_precision() -> None:
    def box(radius: str) -> Candidate:
        return falkner_skan_box("period_tupling", 2, (f"{radius}0", radius), seed=4)

    with pytest.raises(IntegrationFailure, match=r"R_1 = 10\^-99") as refusal:
        enclose_iterates(box("1e-99"), IntegratorSettings(600), ORACLE)
    assert not refusal.value.reason.needs_precision
    assert "larger radii" in refusal.value.reason.remedy


@cache
def enclosures(name: str) -> tuple[Candidate, Enclosures]:
    """A box with its enclosures."""
    make, precision = BOXES[name]
    candidate = make()
    return candidate, enclose_iterates(candidate, IntegratorSettings(precision), ORACLE)


def escapes(candidate: Candidate, found: Enclosures, points: Sequence[Sequence[Fraction]], bits: int) -> int:
    """How many independently integrated points lie outside the enclosures of position or return time."""
    flow = orbits(candidate.system, bits)
    accuracy = Fraction(1, 2 ** (bits - 30))
    count = 0
    for p in points:
        crossings = flow.crossings(*initial_state(candidate, p), candidate.k)
        for crossing, tables, time in zip(crossings, found.iterates, found.return_times, strict=True):
            inside = contains(time, crossing.time, accuracy)
            for table, value in zip(tables, kernel_values(candidate, crossing.state), strict=True):
                inside = inside and contains(taylor_enclosure(table, p), value, accuracy)
            count += not inside
    return count


@pytest.mark.parametrize("number", [6, pytest.param(400, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", BOXES)
def test_flow_encloses_random_point_orbits(name: str, number: int) -> None:
    candidate, found = enclosures(name)
    source = random.Random(name)
    points = [random_point(source, candidate) for _ in range(number)]
    with ctx.workprec(400):
        assert escapes(candidate, found, points, 130) == 0


@pytest.mark.parametrize("name", BOXES)
def test_enclosures_are_narrow(name: str) -> None:
    """What the tests of containment would not notice: enclosures too wide to be of use."""
    candidate, found = enclosures(name)
    grading = grading_for(candidate, len(candidate.radii))
    with ctx.workprec(400):
        for number, tables in enumerate(found.iterates):
            for table in tables:
                assert float(taylor_enclosure(table, candidate.radii).rad()) < 1e-8
                for alpha, derivative in table.box.items():
                    if grading.grade(alpha) > grading.top:
                        continue
                    size = max(1.0, abs(float(table.centre[alpha].mid())))
                    assert float(table.centre[alpha].rad()) < 0.02 * size
                    if "narrow" in name and number == 0:
                        assert float(derivative.rad()) < 0.2 * size


@pytest.mark.parametrize(
    "name, count",
    [
        ("earth-moon narrow", 1),
        pytest.param("sun-jupiter", 1, marks=pytest.mark.slow),
        ("Falkner-Skan wide", 2),
        ("Falkner-Skan narrow", 2),
    ],
)
def test_derivatives_of_random_point_orbits_are_enclosed(name: str, count: int) -> None:
    """First, second and third derivatives at random points of the box, and at its centre."""
    candidate, found = enclosures(name)
    bits = 150
    flow = orbits(candidate.system, bits)
    step = Fraction(1, 2**30)
    source = random.Random(name)

    def images(p: Sequence[Fraction]) -> list[Fraction]:
        return [
            value
            for crossing in flow.crossings(*initial_state(candidate, p), candidate.k)
            for value in kernel_values(candidate, crossing.state)
        ]

    points = [random_point(source, candidate) for _ in range(count)]
    if candidate.system is FALKNER_SKAN:
        points.append((Fraction(0),) * len(candidate.radii))
    tables = [table for row in found.iterates for table in row]
    with ctx.workprec(400):
        for p in points:
            for alpha, values in finite_differences(images, p, step).items():
                for table, value in zip(tables, values, strict=True):
                    # Derivatives of order 5 are below 1e8 times the largest of order 3 in these boxes.
                    tolerance = Fraction(1, 2 ** (bits - 30)) / step ** sum(alpha) + Fraction(10**8) * step**2 * max(
                        1, *(abs(v) for v in values)
                    )
                    assert contains(table.box[alpha], value, tolerance), (alpha, p)
                    if not any(p):
                        assert contains(table.centre[alpha], value, tolerance), alpha


def test_first_integral_is_enclosed() -> None:
    """The table of the Jacobi constant against its formula, at random points of the box."""
    candidate, found = enclosures("earth-moon wide")
    assert found.first_integral is not None
    source = random.Random(0)
    mu = MASS_PARAMETERS["earth-moon"]
    with mpmath.workprec(300), ctx.workprec(300):
        for _ in range(50):
            p = random_point(source, candidate)
            state, _ = initial_state(candidate, p)
            x, _, z, _, vy, _ = (mpmath.mpf(v.numerator) / v.denominator for v in state)
            m = mpmath.mpf(mu.numerator) / mu.denominator
            distances = mpmath.sqrt((x + m) ** 2 + z**2), mpmath.sqrt((x + m - 1) ** 2 + z**2)
            value = x**2 + 2 * (1 - m) / distances[0] + 2 * m / distances[1] - vy**2
            exact = Fraction(int(mpmath.floor(value * 2**280)), 2**280)
            assert contains(taylor_enclosure(found.first_integral, p), exact, Fraction(1, 2**270))


def whole_section(
    system: ReversibleSystem, grading: Grading, bits: int, middle: Sequence[str], parameters: Sequence[Fraction],
    directions: Sequence[Sequence[Fraction]], degree: int | None = None,
) -> Model:  # fmt: skip
    """A box around a point of the state space, spanned by columns `directions`."""
    arithmetic = Arithmetic(grading, bits, 10, bits * 3 // 8 if degree is None else degree)
    unit = [tuple(int(i == j) for i in range(len(grading.weights))) for j in range(len(grading.weights))]
    zero = (0,) * len(grading.weights)
    state = [
        arithmetic.polynomial({zero: Fraction(value)} | {e: d[i] for e, d in zip(unit, directions, strict=True)})
        for i, value in enumerate(middle)
    ]
    return Model(arithmetic, tuple(state), tuple(arithmetic.constant(value) for value in parameters))


EARTH_MOON_POINT = ("0.843193964637", "0", "0.165", "0.01", "0.263718532564", "-0.02")


def random_directions(source: random.Random, count: int, section: int, size: int, length: str) -> list[list[Fraction]]:
    """Random directions within the section."""
    return [
        [Fraction(0) if i == section else random_fraction(source, Fraction(length)) for i in range(size)]
        for _ in range(count)
    ]


REVERSALS: dict[str, Callable[[], tuple[ReversibleSystem, Model, int]]] = {
    "CR3BP, all directions": lambda: (
        CR3BP,
        whole_section(CR3BP, Grading((1,) * 5, 1), 80, EARTH_MOON_POINT, [MASS_PARAMETERS["earth-moon"]],
                      [[Fraction(int(i == j), 10**9) for i in range(6)] for j in (0, 2, 3, 4, 5)]),
        24,
    ),
    "CR3BP, third order": lambda: (
        CR3BP,
        whole_section(CR3BP, Grading((1, 1), 3), 80, EARTH_MOON_POINT, [MASS_PARAMETERS["earth-moon"]],
                      random_directions(random.Random(1), 2, 1, 6, "1e-8")),
        24,
    ),
    "Falkner-Skan, third order": lambda: (
        FALKNER_SKAN,
        whole_section(FALKNER_SKAN, Grading((1, 1), 3), 100, ("0.5", "0.939", "0"), [Fraction("453.25")],
                      random_directions(random.Random(2), 2, 2, 3, "1e-8")),
        24,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REVERSALS)
def test_reversed_return_undoes_the_return(name: str) -> None:
    """R P R P encloses the identity: value and derivatives, for a box of the section away from Fix(R)."""
    system, start, steps = REVERSALS[name]()
    model = start
    times = []
    for _ in range(2):
        (crossing,) = orbits(system, 110).crossings(*model.middle, 1)
        times.append(crossing.time)
        image, _ = to_section(system, model, crossing.time, steps)
        model = reversed_by(system, image)
    assert abs(times[0] - times[1]) < Fraction(1, 10**6)
    for returned, initial in zip(model.state, start.state, strict=True):
        distances = distance_by_grade(returned, initial)
        for distance, error, bound in zip(distances, returned.errors, initial.errors, strict=True):
            assert distance <= Fraction(error) + Fraction(bound)
        assert returned.errors[0] < 1e-14
        assert returned.errors[1] < 1e-12


def test_one_step_encloses_orbits_at_all_times() -> None:
    """All state components and the vector field, at random times within a step."""
    source = random.Random(3)
    start = whole_section(
        CR3BP, Grading((1, 1), 2), 90, ("0.84", "0.1", "0.165", "0.01", "0.26", "-0.02"),
        [MASS_PARAMETERS["earth-moon"]], random_directions(source, 2, -1, 6, "1e-6"),
    )  # fmt: skip
    step = Fraction(3, 64)
    flow = follow(CR3BP.program, start, step)
    reference = orbits(CR3BP, 130)
    accuracy = Fraction(1, 2**110)
    with ctx.workprec(300):
        for _ in range(100):
            xi = [random_fraction(source), random_fraction(source)]
            theta = Fraction(source.randint(1, 2**20), 2**20)
            point = [
                Fraction(int(x.coefs[0][0]), 2**90)
                + sum((a * Fraction(int(x.coefs[n][0]), 2**100) for n, a in ((1, xi[1]), (2, xi[0]))), Fraction(0))
                for x in start.state
            ]
            exact = reference.flow(point, start.middle[1], step * theta)
            for series, value in zip(flow.solution, exact, strict=True):
                assert contains(series_at(series, theta, xi), value, accuracy)
            speed = CR3BP.vector_field([float(v) for v in exact], [float(MASS_PARAMETERS["earth-moon"])])
            for series, number in zip(flow.slopes, speed, strict=True):
                assert contains(series_at(series, theta, ()), Fraction(number), Fraction(1, 2**40))
            if theta == 1:
                for series, value in zip(flow.end, exact, strict=True):
                    assert contains(series_at(series, theta, xi), value, accuracy)


def one_orbit(width: Fraction, degree: int) -> Model:
    """A point of the Falkner-Skan equation of which y is known up to `width`."""
    zero, parameters = [[Fraction(0)] * 3], [Fraction(453)]
    start = whole_section(FALKNER_SKAN, Grading((1,), 1), 100, ("0", "0.94", "0"), parameters, zero, degree)
    x, y, z = start.state
    return Model(start.arithmetic, (x, y.with_errors([float(width), 0.0, 0.0]), z), start.parameters)


def lost_neighbours(degree: int) -> tuple[int, float]:
    """How many components of an orbit from the end of the box leave its enclosure, and the error bound."""
    width = Fraction(1, 2**40)
    model = one_orbit(width, degree)
    step = Fraction(1, 512)
    steps = 16
    for _ in range(steps):
        model = Model(model.arithmetic, follow(FALKNER_SKAN.program, model, step).end, model.parameters)
    start = [Fraction(0), Fraction("0.94") + width, Fraction(0)]
    exact = orbits(FALKNER_SKAN, 130).flow(start, [Fraction(453)], steps * step)
    with ctx.workprec(300):
        lost = sum(
            not contains(series_at(series, Fraction(1), (Fraction(0),)), value, Fraction(1, 2**110))
            for series, value in zip(model.state, exact, strict=True)
        )
    return lost, max(series.errors[0] for series in model.state)


def test_unknown_initial_values_are_carried_along() -> None:
    lost, error = lost_neighbours(30)
    assert lost == 0
    assert error < 1e-8


def test_growth_of_errors_that_is_left_out_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(orbitproof.verify.flow.gronwall, "exponential_bound", lambda matrix, start: start + 2.0**-960)
    lost, _ = lost_neighbours(30)
    assert lost > 0


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_a_degree_that_is_too_low_widens_the_enclosure(degree: int) -> None:
    lost, error = lost_neighbours(degree)
    assert lost == 0
    assert error > 10 * lost_neighbours(30)[1]


def test_a_low_order_of_the_time_expansion_still_encloses() -> None:
    candidate = falkner_skan_box("period_tupling", 1, ("1e-6", "1e-9"), seed=6)
    found = enclose_iterates(candidate, IntegratorSettings(64, 12), ORACLE)
    source = random.Random(0)
    with ctx.workprec(300):
        assert escapes(candidate, found, [random_point(source, candidate) for _ in range(20)], 130) == 0


def no_defect(solution: object, field: object, step: object) -> list[float]:
    """A defect that is claimed to be zero."""
    return [0.0] * (solution.arithmetic.grading.top + 2)  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ["earth-moon wide", "Falkner-Skan wide", "Falkner-Skan narrow"])
def test_an_integrator_without_its_defect_is_caught(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(orbitproof.verify.flow.step, "_defect", no_defect)
    make, precision = BOXES[name]
    candidate = make()
    found = enclose_iterates(candidate, IntegratorSettings(precision), ORACLE)
    source = random.Random(name)
    with ctx.workprec(400):
        assert escapes(candidate, found, [random_point(source, candidate) for _ in range(3)], 130) > 0


def test_an_integrator_without_its_defect_fails_reversibility(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(orbitproof.verify.flow.step, "_defect", no_defect)
    with pytest.raises(AssertionError):
        test_reversed_return_undoes_the_return("Falkner-Skan, third order")


def test_precision_is_restored() -> None:
    before = ctx.prec, ctx.cap
    enclose_iterates(falkner_skan_box("touch_and_go", 1, ("1e-9", "1e-12")), IntegratorSettings(80), ORACLE)
    assert (ctx.prec, ctx.cap) == before


def test_initial_values_are_not_trusted(monkeypatch: pytest.MonkeyPatch) -> None:
    """An approximate solution that starts elsewhere is refused, not silently corrected."""
    model = one_orbit(Fraction(0), 20)
    program = prepare(FALKNER_SKAN.program)
    expansion = CentreExpansion(program, model.arithmetic, model.state, model.parameters)
    wrong = [[int(x.coefs[0][0]) + 1] + [0] * model.arithmetic.degree for x in model.state]
    monkeypatch.setattr(expansion, "_coefficients", lambda step: wrong)
    with pytest.raises(IntegrationFailure, match="does not start"):
        advance(program, model.state, model.parameters, expansion, Fraction(1, 64))


@pytest.mark.parametrize(
    "values", [{"precision": 0}, {"precision": 64, "order": 0}, {"precision": 64, "accuracy": (-1, 0)},
               {"precision": 64, "coordinates": "spherical"}], ids=str,
)  # fmt: skip
def test_settings_that_mean_nothing_are_refused(values: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=str(next(reversed(values)))):
        IntegratorSettings(**values)
