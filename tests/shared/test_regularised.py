"""Regularised coordinates: the same orbits, the same Poincare map, and no way through a collision."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from itertools import product
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_series, ctx, fmpz_poly
from scipy.integrate import solve_ivp
from support.balls import agree
from support.claims import known
from support.flow_checks import (
    ball,
    box,
    contains,
    falkner_skan_box,
    halo,
    initial_state,
    kernel_values,
    orbits,
    random_point,
    series_at,
    taylor_enclosure,
)

from orbitproof.shared.claims import Candidate
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS
from orbitproof.shared.systems.regularised import KUSTAANHEIMO_STIEFEL
from orbitproof.verify.algebra import Arithmetic, Grading, Series
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import certify, recheck
from orbitproof.verify.claim import point_on_fixed_set
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import Expansion, FlowStep, advance
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import (
    PHYSICAL,
    REGULARISED,
    CrossingCounter,
    Enclosures,
    Integration,
    IntegratorSettings,
    enclose_iterates,
    stays_positive,
)
from orbitproof.verify.poincare.regularised import regularised
from orbitproof.verify.poincare.section import onto_section

MU = MASS_PARAMETERS["earth-moon"]
RADII = tuple(Fraction(r) for r in ("1e-16", "1e-9", "1e-16"))


def near(kind: str, centre: tuple[str, str, str], seed: int) -> Candidate:
    """A box of the Earth-Moon system."""
    return box(CR3BP, kind, 2, centre, RADII, {"mu": MU}, seed)


# On both sides of the smaller primary, hence both formulas of the embedding; the last one starts at 0.03 from it.
BOXES = {
    "inside": lambda: halo("earth-moon", "period_tupling", ("1e-16", "1e-9", "1e-16"), seed=2),
    "outside": lambda: near("touch_and_go", ("1.10935", "0.20", "-0.26"), 3),
    "close": lambda: near("period_tupling", ("0.98801", "0.0309", "0.8473"), 4),
}


@cache
def enclosures(name: str, coordinates: str) -> tuple[Candidate, Enclosures]:
    """A box with its enclosures."""
    candidate = BOXES[name]()
    return candidate, enclose_iterates(candidate, IntegratorSettings(110, coordinates=coordinates), ORACLE)


def power(base: arb, exponent: Fraction) -> arb:
    """For running programs on balls."""
    return base ** ball(exponent)


def bilinear(u: Sequence[Any], w: Sequence[Any]) -> Any:
    """l(u, w), which vanishes along the orbits that the equations describe."""
    return u[0] * w[3] - u[1] * w[2] + u[2] * w[1] - u[3] * w[0]


def vanishes(value: arb) -> bool:
    """Whether a ball is about zero."""
    return bool(value.contains(0)) and bool(abs(value) < 1e-30)


@pytest.mark.parametrize("seed", range(20))
def test_the_equations_are_those_of_the_three_body_problem(seed: int) -> None:
    """Where l = 0 and C is the Jacobi constant: d/ds of the projection is r_2 times the vector field, dl/ds = 0."""
    source = random.Random(seed)
    with ctx.workprec(300):
        mu, *u, w1, w2, w3, time = (ball(Fraction(source.randint(1, 10**6), 10**6)) for _ in range(9))
        rho2 = 2 * (u[0] * u[1] - u[2] * u[3])
        w = [w1, w2, w3, (u[1] * w3 - u[2] * w2 + u[3] * w1) / u[0]]
        v = [*u, *w, rho2, time]
        state = KUSTAANHEIMO_STIEFEL.projection_program.evaluate([*v, mu], ball, power)
        assert CR3BP.first_integral_program is not None
        level = CR3BP.first_integral_program.evaluate([*state, mu], ball, power)
        slopes = KUSTAANHEIMO_STIEFEL.program.evaluate([*v, mu, *level], ball, power)
        line = [arb_series([value, slope], 2) for value, slope in zip(v, slopes, strict=True)]
        moved = KUSTAANHEIMO_STIEFEL.projection_program.evaluate(
            [*line, arb_series([mu], 2)], lambda value: arb_series([ball(value)], 2)
        )
        distance = sum((value * value for value in u), arb(0))
        for along, wanted in zip(moved, CR3BP.program.evaluate([*state, mu], ball, power), strict=True):
            assert vanishes(along[1] - distance * wanted)
        assert vanishes(bilinear(u, slopes[4:8]))
        # The section coordinate follows from the others, and so does its derivative.
        (own,) = KUSTAANHEIMO_STIEFEL.section_program.evaluate(v, ball, power)
        (shift,) = KUSTAANHEIMO_STIEFEL.section_program.evaluate(line, lambda value: arb_series([ball(value)], 2))
        assert vanishes(own - rho2)
        assert vanishes(shift[1] - slopes[8])
        assert all(vanishes(slope - value) for slope, value in zip(slopes[:4], w, strict=True))
        assert vanishes(slopes[9] - distance)


def test_the_program_is_the_field_as_it_is_written() -> None:
    """(14.1) at any point, with l = 0 or not, whatever products the program forms it by."""
    source = random.Random(1)
    with ctx.workprec(300):
        mu, u1, u2, u3, u4, w1, w2, w3, w4, y, time, level = (
            ball(Fraction(source.randint(1, 10**6), 10**6)) for _ in range(12)
        )
        r2, rho1 = u1 * u1 + u2 * u2 + u3 * u3 + u4 * u4, u1 * u1 - u2 * u2 - u3 * u3 + u4 * u4
        rho3, sigma = 2 * (u1 * u3 + u2 * u4), u3 * w1 + u4 * w2 + u1 * w3 + u2 * w4
        r1 = (1 + 2 * rho1 + r2 * r2).sqrt()
        pull = (1 - mu) / r1**3
        energy = (r2 * r2 - rho3 * rho3 + 2 * (1 - mu) * rho1 + (1 - mu) ** 2 - level) / 2 + pull * r1 * r1
        p = energy + r2 * r2 - r2 * r2 * pull + (1 - mu) * r2 - r2 * pull
        m = energy + r2 * r2 - r2 * r2 * pull - (1 - mu) * r2 + r2 * pull
        written = [
            *(w1, w2, w3, w4),
            (p * u1 - r2 * rho3 * u3) / 2 + 2 * (r2 * w2 - sigma * u4),
            (m * u2 - r2 * rho3 * u4) / 2 - 2 * (r2 * w1 - sigma * u3),
            (m * u3 - r2 * rho3 * u1) / 2 + 2 * (r2 * w4 - sigma * u2),
            (p * u4 - r2 * rho3 * u2) / 2 - 2 * (r2 * w3 - sigma * u1),
            *(2 * (u2 * w1 + u1 * w2 - u4 * w3 - u3 * w4), r2),
        ]
        point = [u1, u2, u3, u4, w1, w2, w3, w4, y, time, mu, level]
        found = KUSTAANHEIMO_STIEFEL.program.evaluate(point, ball, power)
        assert all(vanishes(value - wanted) for value, wanted in zip(found, written, strict=True))


@pytest.mark.parametrize("branch", [1, -1])
def test_the_projection_undoes_the_embedding(branch: int) -> None:
    """On the whole section, not only where orbits start."""
    source = random.Random(branch)
    with ctx.workprec(200):
        for _ in range(50):
            x, z, *speed = (ball(Fraction(source.randint(-(10**6), 10**6), 10**6)) for _ in range(5))
            state = [x, arb(0), z, *speed]
            spinors = KUSTAANHEIMO_STIEFEL.embedding_program(branch).evaluate([*state, ball(MU)], ball, power)
            again = KUSTAANHEIMO_STIEFEL.projection_program.evaluate([*spinors, ball(MU)], ball, power)
            for given, found in zip(state, again, strict=True):
                assert vanishes(found - given)
            assert vanishes(bilinear(spinors[:4], spinors[4:8]))
            assert spinors[8:] == [0, 0]


def test_orbits_from_any_point_of_the_section_are_those_of_the_three_body_problem() -> None:
    """Lemma 14.1, where all components of the velocity are other than 0; two integrations that know no enclosures."""
    source, mu = np.random.default_rng(14), float(MU)
    for _ in range(5):
        x, z = source.uniform(-0.15, 0.15, 2)
        state = [1 - mu + x, 0.0, z, *source.uniform(-0.6, 0.6, 3)]
        assert CR3BP.first_integral is not None
        level = CR3BP.first_integral(state, (mu,))
        field = lambda _, v, level=level: KUSTAANHEIMO_STIEFEL.vector_field(v, (mu,), level)  # noqa: E731
        branch = KUSTAANHEIMO_STIEFEL.branch(state, (mu,))
        start = [float(value) for value in KUSTAANHEIMO_STIEFEL.embedding(state, (mu,), branch)]
        end = solve_ivp(field, (0, 3), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        motion = lambda _, v: CR3BP.vector_field(v, (mu,))  # noqa: E731
        there = solve_ivp(motion, (0, end[9]), state, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        assert end[9] > 0.1
        assert np.abs(there - state).max() > 0.05
        assert np.allclose(KUSTAANHEIMO_STIEFEL.projection(end, (mu,)), there, rtol=1e-7, atol=1e-8)


def test_both_formulas_of_the_embedding_agree_where_both_are_valid() -> None:
    """Next to rho_1 = 0 a box may reach across; up to the sign of u, the formulas give one point."""
    with ctx.workprec(200):
        for z in (Fraction(1, 3), Fraction(-1, 3)):
            state = [ball(1 - MU), arb(0), ball(z), arb(0), arb(-2), arb(0), ball(MU)]
            one, two = (KUSTAANHEIMO_STIEFEL.embedding_program(b).evaluate(state, ball, power) for b in (1, -1))
            sign = 1 if z > 0 else -1
            assert all(vanishes(a - sign * b) for a, b in zip(one, two, strict=True))


@pytest.mark.parametrize("number", [4, pytest.param(20, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", BOXES)
def test_regularised_enclosures_contain_random_physical_orbits(name: str, number: int) -> None:
    candidate, found = enclosures(name, REGULARISED)
    assert found.coordinates == KUSTAANHEIMO_STIEFEL.name
    source, accuracy = random.Random(name), Fraction(1, 2**130)
    flow = orbits(CR3BP, 170)
    with ctx.workprec(400):
        for _ in range(number):
            p = random_point(source, candidate)
            crossings = flow.crossings(*initial_state(candidate, p), candidate.k)
            for crossing, tables, time in zip(crossings, found.iterates, found.return_times, strict=True):
                assert contains(time, crossing.time, accuracy)
                for table, value in zip(tables, kernel_values(candidate, crossing.state), strict=True):
                    assert contains(taylor_enclosure(table, p), value, accuracy)


@pytest.mark.parametrize("name", BOXES)
def test_both_coordinates_give_overlapping_derivatives(name: str) -> None:
    _, own = enclosures(name, PHYSICAL)
    _, other = enclosures(name, REGULARISED)
    assert own.coordinates != other.coordinates
    for one, two in zip(sum(own.iterates, ()), sum(other.iterates, ()), strict=True):
        for alpha in one.box:
            assert agree(one.box[alpha], two.box[alpha])
            assert agree(one.centre[alpha], two.centre[alpha])
        for alpha in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 2, 0), (1, 1, 0)):
            assert two.centre[alpha].rad() < 1e-3 * max(1.0, abs(float(two.centre[alpha].mid())))


@pytest.mark.slow
def test_another_mass_or_orbit_does_not_overlap() -> None:
    candidate, found = enclosures("inside", REGULARISED)
    for wrong in (
        replace(candidate, parameters={"mu": MU + Fraction(1, 10**6)}),
        replace(candidate, centre=(candidate.centre[0] + Fraction(1, 10**6), *candidate.centre[1:])),
    ):
        other = enclose_iterates(wrong, IntegratorSettings(110, coordinates=PHYSICAL), ORACLE)
        assert not other.iterates[0][0].box[0, 0, 0].overlaps(found.iterates[0][0].box[0, 0, 0])


def collision() -> Candidate:
    """A box around a planar orbit that falls into the smaller primary: from 0.01 inside, with the speed for it."""
    field = KUSTAANHEIMO_STIEFEL.vector_field
    mu = float(MU)

    def closest(speed: float) -> tuple[float, float]:
        state = [1 - mu - 0.01, 0.0, 0.0, 0.0, speed, 0.0]
        assert CR3BP.first_integral is not None
        level = CR3BP.first_integral(state, (mu,))
        v = [float(value) for value in KUSTAANHEIMO_STIEFEL.embedding(state, (mu,), -1)]
        best, step = (1.0, 0.0), 1e-2
        for _ in range(300):
            k1 = field(v, (mu,), level)
            k2 = field([a + step / 2 * b for a, b in zip(v, k1, strict=True)], (mu,), level)
            k3 = field([a + step / 2 * b for a, b in zip(v, k2, strict=True)], (mu,), level)
            k4 = field([a + step * b for a, b in zip(v, k3, strict=True)], (mu,), level)
            v = [a + step / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(v, k1, k2, k3, k4, strict=True)]
            distance = sum(a * a for a in v[:4])
            turn = v[2] * v[7] - v[3] * v[6]
            best = min(best, (distance, turn))
        return best

    low, high = -0.2, 0.2
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if (closest(middle)[1] < 0) == (closest(low)[1] < 0) else (low, middle)
    return box(CR3BP, "touch_and_go", 1, (1 - MU - Fraction(1, 100), Fraction(0), Fraction((low + high) / 2)),
               [Fraction(1, 10**6)] * 3, {"mu": MU})  # fmt: skip


def test_an_orbit_that_may_collide_is_refused() -> None:
    candidate = collision()
    with pytest.raises(IntegrationFailure, match="collision"):
        enclose_iterates(candidate, IntegratorSettings(110, coordinates=REGULARISED), ORACLE)
    assert certify(candidate).verdict == "not proved"


def test_each_step_is_checked_for_a_collision(monkeypatch: pytest.MonkeyPatch) -> None:
    candidate, settings = known("em1"), IntegratorSettings(110, coordinates=REGULARISED)
    seen: list[Series] = []

    def check(series: Series, wide: arb | None, refused: int = -1) -> bool:
        seen.append(series)
        return len(seen) - 1 != refused and stays_positive(series, wide)

    monkeypatch.setattr("orbitproof.verify.poincare.returns.stays_positive", check)
    steps = enclose_iterates(candidate, settings, ORACLE).steps
    assert len(seen) == steps
    # What is checked is the distance from the primary.
    x, z = (candidate.centre[candidate.coordinates.index(name)] - start for name, start in (("x", 1 - MU), ("z", 0)))
    assert agree(series_at(seen[0], Fraction(0), ()), ball(x * x + z * z).sqrt())
    assert series_at(seen[0], Fraction(0), ()).rad() < 1e-9
    for refused in range(steps):
        seen.clear()
        monkeypatch.setattr("orbitproof.verify.poincare.returns.stays_positive", partial(check, refused=refused))
        with pytest.raises(IntegrationFailure, match="collision"):
            enclose_iterates(candidate, settings, ORACLE)


@pytest.mark.parametrize("level", ["integral", "coordinates"])
def test_initial_values_and_the_jacobi_constant_are_enclosed_over_the_box(level: str) -> None:
    """The box is so wide that the part above the kept grades is seen."""
    wide = tuple(Fraction(1, 2000) for _ in range(3))
    candidate = halo("earth-moon", "period_tupling", ("1e-3", "1e-3", "1e-3"))
    if level == "integral":
        assert CR3BP.first_integral is not None
        x, z, vy = (float(value) for value in candidate.centre)
        (jacobi,) = CR3BP.first_integral([x, 0.0, z, 0.0, vy, 0.0], [float(MU)])
        candidate = replace(candidate, centre=(Fraction(jacobi), *candidate.centre[:2]), radii=wide, level_sign=1)
    integration = Integration(candidate, IntegratorSettings(110, coordinates=REGULARISED), ORACLE, None)
    entered = integration.returns
    assert entered.coordinates.name == KUSTAANHEIMO_STIEFEL.name
    assert CR3BP.first_integral_program is not None
    branch = KUSTAANHEIMO_STIEFEL.branch([float(candidate.centre[level == "integral"])], [float(MU)])
    embedding = KUSTAANHEIMO_STIEFEL.embedding_program(branch)
    source = random.Random(level)
    with ctx.workprec(300):
        for _ in range(20):
            p = random_point(source, candidate)
            named = dict(zip(candidate.coordinates, (
                ball(middle + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0)))
                for middle, row in zip(candidate.centre, candidate.frame, strict=True)
            ), strict=True))  # fmt: skip
            named = named if level == "coordinates" else point_on_fixed_set(candidate, named)
            arguments = [*(named.get(name, arb(0)) for name in CR3BP.state), ball(MU)]
            wanted = [*embedding.evaluate(arguments, ball, power), ball(MU)]
            wanted += CR3BP.first_integral_program.evaluate(arguments, ball, power)
            xi = [x / scale for x, scale in zip(p, integration.box.scales, strict=True)]
            for series, value in zip((*entered.state, *entered.constants), wanted, strict=True):
                assert agree(series_at(series, Fraction(0), xi), value)
                assert value.rad() < 1e-60


def test_each_step_starts_from_the_whole_enclosure(monkeypatch: pytest.MonkeyPatch) -> None:
    """The state and the constants of motion go into every step with their errors."""
    integration = Integration(known("em1"), IntegratorSettings(110, coordinates=REGULARISED), ORACLE, None)
    running = integration.returns
    steps: list[Fraction] = []

    def check_step(
        program: Any, state: Sequence[Series], parameters: Sequence[Series], expansion: Expansion, step: Fraction
    ) -> FlowStep:
        assert state is running.state
        assert parameters is running.constants
        steps.append(step)
        return advance(program, state, parameters, expansion, step)

    def check_last(*arguments: Any) -> tuple[list[Series], Series]:
        # The section coordinate is formed from the others where it is known better so.
        close, index = list(arguments[3]), KUSTAANHEIMO_STIEFEL.section_index
        own, carried = close.pop(index), [*running.state]
        assert own.errors[0] <= carried.pop(index).errors[0]
        assert all(a is b for a, b in zip(close, carried, strict=True))
        xi = [Fraction(1, 3)] * len(own.arithmetic.grading.weights)
        y, *u = (series_at(element, Fraction(0), xi) for element in (own, *close[:4]))
        assert agree(y, 2 * (u[0] * u[1] - u[2] * u[3]))
        assert arguments[4] is running.constants
        steps.append(Fraction(0))
        return onto_section(*arguments)

    assert any(running.constants[-1].errors)
    monkeypatch.setattr("orbitproof.verify.poincare.returns.advance", check_step)
    monkeypatch.setattr("orbitproof.verify.poincare.returns.onto_section", check_last)
    assert integration.run().steps == len(steps) - 1
    assert steps[-1] == 0


def test_the_section_coordinate_from_the_others_has_their_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is 2 (u1 u2 - u3 u4) for all u within the errors; a component y that is known better stays."""
    running = Integration(known("em1"), IntegratorSettings(110, coordinates=REGULARISED), ORACLE, None).returns
    index, error = KUSTAANHEIMO_STIEFEL.section_index, Fraction(1, 2**20)
    u = [Fraction(1, n) for n in (2, 3, 5, 7)]
    running.state[:4] = [running.arithmetic.constant(value).widened(error) for value in u]
    taken: list[Series] = []

    def check_last(*arguments: Any) -> None:
        taken.append(arguments[3][index])
        raise IntegrationFailure("section", "this is enough", "none")

    monkeypatch.setattr("orbitproof.verify.poincare.returns.onto_section", check_last)
    monkeypatch.setattr(CrossingCounter, "arrival", lambda *_: "some time")
    for rough in (Fraction(1), error / 16):
        running.state[index] = running.arithmetic.constant(2 * (u[0] * u[1] - u[2] * u[3])).widened(rough)
        with pytest.raises(IntegrationFailure, match="enough"):
            running.crossing(1)
    formed, kept = taken
    assert kept is running.state[index]
    found = series_at(formed, Fraction(0), [Fraction(0)] * len(running.arithmetic.grading.weights))
    assert found.rad() < 8 * float(error)
    for signs in product((1, -1), repeat=4):
        a, b, c, d = (value + sign * error for value, sign in zip(u, signs, strict=True))
        assert contains(found, 2 * (a * b - c * d))


@pytest.mark.parametrize("coordinates", [PHYSICAL, REGULARISED])
def test_the_times_of_the_steps_follow_each_other(coordinates: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The count of crossings speaks of the whole time from the start to the crossing."""
    covered: list[tuple[arb, arb]] = []

    class Counter(CrossingCounter):
        def cover(self, position: Series, velocity: Series, time: arb, step: arb) -> None:
            covered.append((time, step))
            super().cover(position, velocity, time, step)
            assert self.clear_time is None or self.clear_time <= time + step + arb(2) ** -90
            if self.velocity_sign == 0:
                assert agree(self.clear_time, time + step)

    monkeypatch.setattr("orbitproof.verify.poincare.returns.CrossingCounter", Counter)
    found = enclose_iterates(known("em1"), IntegratorSettings(110, coordinates=coordinates), ORACLE)
    assert len(covered) == found.steps
    ends = [arb(0), *(time + step for time, step in covered)]
    assert all(agree(time, end) for (time, _), end in zip(covered, ends, strict=False))
    # In the system's own time the last step ends at the crossing; where r_2 < 1, the other time is longer.
    last = ends[-1] - found.return_times[0]
    assert abs(last) < 1e-6 if coordinates == PHYSICAL else last > 1e-2


@pytest.mark.parametrize("coordinates", [PHYSICAL, REGULARISED])
@pytest.mark.parametrize("delay", [10.0, float("inf"), float("nan")])
def test_a_crossing_at_an_uncertain_time_is_refused(
    coordinates: str, delay: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(*arguments: Any) -> tuple[list[Series], Series]:
        image, elapsed = onto_section(*arguments)
        return image, elapsed.with_errors([delay, *elapsed.errors[1:]])

    monkeypatch.setattr("orbitproof.verify.poincare.returns.onto_section", late)
    with pytest.raises(IntegrationFailure, match="not separated from the crossing before it"):
        enclose_iterates(known("em1"), IntegratorSettings(110, coordinates=coordinates), ORACLE)


def test_the_time_of_a_crossing_is_that_on_the_section(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is a coordinate of the image, not of the state from which the section is reached."""
    usual = enclose_iterates(known("em1"), IntegratorSettings(110, coordinates=REGULARISED), ORACLE).return_times[0]

    def later(*arguments: Any) -> tuple[list[Series], Series]:
        image, elapsed = onto_section(*arguments)
        time = KUSTAANHEIMO_STIEFEL.time_index
        image[time] = image[time] + image[time].arithmetic.constant(Fraction(1))
        return image, elapsed

    monkeypatch.setattr("orbitproof.verify.poincare.returns.onto_section", later)
    found = enclose_iterates(known("em1"), IntegratorSettings(110, coordinates=REGULARISED), ORACLE).return_times[0]
    assert agree(found, usual + 1)
    assert not found.overlaps(usual)


@pytest.mark.parametrize("coordinates", [PHYSICAL, REGULARISED])
def test_a_crossing_that_does_not_arrive_is_refused(coordinates: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orbitproof.verify.poincare.returns.CrossingCounter.arrival", lambda *_: None)
    with pytest.raises(IntegrationFailure, match="not proved to be at crossing 1"):
        enclose_iterates(known("em1"), IntegratorSettings(110, coordinates=coordinates), ORACLE)


@pytest.mark.parametrize("coordinates", [PHYSICAL, REGULARISED])
def test_shorter_steps_after_a_failed_one_give_the_same_map(coordinates: str, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = enclose_iterates(known("em1"), IntegratorSettings(110, coordinates=coordinates), ORACLE)
    failed: list[Fraction] = []

    def sometimes(*arguments: Any) -> FlowStep:
        step = arguments[-1]
        if len(failed) < 2:
            failed.append(step)
            raise IntegrationFailure("tube", "no tube", "smaller radii")
        return advance(*arguments)

    monkeypatch.setattr("orbitproof.verify.poincare.returns.advance", sometimes)
    found = enclose_iterates(known("em1"), IntegratorSettings(110, coordinates=coordinates), ORACLE)
    assert failed[1] < Fraction(2, 3) * failed[0]
    assert found.steps > usual.steps
    for one, two in zip(usual.iterates[0], found.iterates[0], strict=True):
        assert all(agree(one.centre[alpha], two.centre[alpha]) for alpha in one.centre)
    assert agree(found.return_times[0], usual.return_times[0])


@pytest.mark.parametrize("level", ["integral", "coordinates"])
def test_what_is_proved_in_regularised_coordinates_is_proved_again_in_the_systems_own(level: str) -> None:
    def integrate(candidate: Candidate, settings: IntegratorSettings, progress: Any) -> Enclosures:
        return enclose_iterates(candidate, replace(settings, coordinates=REGULARISED), ORACLE, progress)

    certificate = certify(known("em1"), Limits(level=level), None, integrate)
    assert certificate.proved
    assert certificate.computation.coordinates == KUSTAANHEIMO_STIEFEL.name
    assert ("level_form" in certificate.statement) == (level == "integral")
    again = recheck(certificate, integrate=True)
    assert again.stands, again.findings


@pytest.mark.slow
def test_an_orbit_near_the_primary_is_followed_in_regularised_coordinates_by_itself() -> None:
    close, far = BOXES["close"](), BOXES["inside"]()
    assert enclose_iterates(close, IntegratorSettings(110), ORACLE).coordinates == KUSTAANHEIMO_STIEFEL.name
    assert enclose_iterates(far, IntegratorSettings(110), ORACLE).coordinates == PHYSICAL


def test_systems_without_regularisation_keep_their_own_coordinates() -> None:
    assert regularised(FALKNER_SKAN, [0.0] * 3, [400.0]) is None
    candidate = falkner_skan_box("period_tupling", 1, ("1e-7", "1e-9"))
    assert enclose_iterates(candidate, IntegratorSettings(64, coordinates=REGULARISED), ORACLE).coordinates == PHYSICAL


def test_another_system_of_the_same_name_has_no_regularisation(monkeypatch: pytest.MonkeyPatch) -> None:
    other = replace(CR3BP, title="another system")
    assert regularised(other, [0.84, 0.0, 0.16, 0.0, 0.26, 0.0], [float(MU)]) is None
    monkeypatch.setattr("orbitproof.shared.systems.known.SYSTEMS", {CR3BP.name: other})
    monkeypatch.setattr("orbitproof.verify.poincare.coordinates.SYSTEMS", {CR3BP.name: other}, raising=False)
    assert regularised(other, [0.84, 0.0, 0.16, 0.0, 0.26, 0.0], [float(MU)]) is None


def test_positivity_is_seen_only_where_it_is_certain() -> None:
    arithmetic = Arithmetic(Grading((1,), 2), 60, 0, 4)
    one = int(arithmetic.one)
    blank = [fmpz_poly([])] * (len(arithmetic.grading.monomials) - 1)

    def series(coefficients: list[int], error: float) -> Series:
        return Series(arithmetic, [fmpz_poly(coefficients), *blank], [error, 0.0, 0.0, 0.0])

    # (theta - 1/2)^2 + 1/100, whose minimum is well inside.
    quadratic = [one // 4 + one // 100, -one, one]
    assert stays_positive(series(quadratic, 0.005))
    assert not stays_positive(series(quadratic, 0.02))
    assert not stays_positive(series([-one], 0.0))
    assert not stays_positive(series([0], 0.0))
    assert not stays_positive(series([one], float("nan")))
