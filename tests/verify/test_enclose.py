"""Flows and Poincare maps of any system: what is enclosed contains closed forms, and what is not is refused."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import mpmath
import pytest
from flint import arb
from support.balls import agree
from support.closed_form_flows import CLOSED_FORMS, DUFFING, NESTED, OSCILLATOR, SPIRAL, ClosedForm, exact
from support.flow_checks import random_fraction, random_frame
from support.independent_flow import extrapolated_flow
from support.within import within

from orbitproof.shared import CR3BP, EARTH_MOON, System, define_system
from orbitproof.shared.systems import describe, evaluate_formula, record
from orbitproof.verify import enclose
from orbitproof.verify.enclose import Box, Enclosure, NotEnclosed
from orbitproof.verify.evidence import IntegrationFailure, indices_up_to
from orbitproof.verify.oracle import ORACLE

DIGITS = 40
ORDERS = 3

_digits = within(lambda: mpmath.workdps(DIGITS))


def holds(ball: arb, value: Any, tolerance: float = 1e-25) -> bool:
    """Whether a finite ball contains a number of mpmath that is good to a relative tolerance."""
    if not ball.is_finite():
        return False
    middle, radius = mpmath.mpf(ball.mid().str(45, radius=False)), mpmath.mpf(ball.rad().str(20, radius=False))
    return bool(abs(middle - value) <= radius * (1 + mpmath.mpf(10) ** -15) + tolerance * (1 + abs(value)))


BOXES = [3, pytest.param(12, marks=pytest.mark.slow)]


def drawn(source: random.Random, form: ClosedForm, fixed: Sequence[str] = ()) -> Box:
    """A box about a random centre, with a random frame in some of the coordinates and parameters."""
    names = [name for name in form.centre if name not in fixed]
    number = source.randint(1, min(3, len(names)))
    rows = {name: [random_fraction(source) for _ in range(number)] for name in names}
    centre = {
        name: Fraction(value).limit_denominator(1000) + (0 if name in fixed else random_fraction(source, 0.02))
        for name, value in form.centre.items()
    }
    radii = [Fraction(form.widest) * Fraction(source.randint(1, 8), 64) for _ in range(number)]
    return enclose.box(centre, rows, radii)


def at(box: Box, form: ClosedForm, p: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """State and parameters at a point of the box, in mpmath."""
    values = {
        name: exact(middle) + mpmath.fsum(exact(a) * x for a, x in zip(box.row(name), p, strict=True))
        for name, middle in box.centre.items()
    }
    return [values[name] for name in form.system.given_state], [values[name] for name in form.system.parameters]


def points(source: random.Random, box: Box, number: int) -> list[list[Any]]:
    """Random points of a box, its corners more often."""
    return [[exact(random_fraction(source, radius)) for radius in box.radii] for _ in range(number)]


def _ball(value: Any) -> arb:
    return arb(mpmath.nstr(value, DIGITS))


def contained(found: Enclosure, where: Sequence[Any], state: Sequence[Any], time: Any = None) -> None:
    """The state at one point of the box lies in what is enclosed over the box, and near the point."""
    near = found.over([_ball(x) for x in where])
    for name, value in zip(found.system.given_state, state, strict=True):
        assert holds(found.value[name], value), (name, found.value[name], value)
        assert holds(near.value[name], value), (name, near.value[name], value)
    if time is not None:
        assert holds(found.time, time)
        assert holds(near.time, time)


def jets_contained(found: Enclosure, image: Any, where: Sequence[Any], tolerance: float = 1e-9) -> None:
    """Derivatives up to the order asked for, by differences of the closed form at a point of the box."""
    near = found.over([_ball(x) for x in where])
    for place, name in enumerate(found.system.given_state):
        assert set(found.derivatives[name]) == set(indices_up_to(len(where), found.order))
        for index, ball in found.derivatives[name].items():
            if sum(index) == 0:
                continue
            value = mpmath.diff(lambda *p, i=place: image(p)[i], tuple(where), index)
            assert holds(ball, value, tolerance), (name, index, ball, value)
            assert holds(near.derivatives[name][index], value, tolerance), (name, index)


@pytest.mark.parametrize("boxes", BOXES)
@pytest.mark.parametrize("form", CLOSED_FORMS, ids=lambda form: form.system.name)
def test_flow_encloses_closed_forms_at_random_points_of_random_boxes(form: ClosedForm, boxes: int) -> None:
    source = random.Random(f"flow {form.system.name}")
    fixed = ("v",) if form is DUFFING else ()
    for _ in range(boxes):
        box = drawn(source, form, fixed)
        time = (
            Fraction(form.longest)
            * Fraction(source.randint(1, 60), 60)
            * (source.choice((1, 1, -1)) if form.backwards else 1)
        )
        order = source.randint(1, ORDERS)
        found = enclose.flow(form.system, box, time, derivatives=order, precision=source.choice((80, 128)))
        assert isinstance(found, Enclosure), str(found)

        def image(p: Sequence[Any], box: Box = box, time: Fraction = time) -> Sequence[Any]:
            return form.flow(exact(time), *at(box, form, p))

        for where in points(source, box, 40):
            contained(found, where, image(where))
        contained(found, [mpmath.mpf(0)] * len(box.radii), image([0] * len(box.radii)))
        jets_contained(found, image, points(source, box, 1)[0])
        assert found.time.is_finite()
        assert holds(found.time, exact(time))


def roots(height: Any, until: float, start: float = 1e-3, parts: int = 600) -> Iterator[tuple[Any, int]]:
    """The zeros of a function of time after the start, with the direction of crossing."""
    times = (mpmath.mpf(start + (until - start) * n / parts) for n in range(parts + 1))
    for (t, a), (u, b) in itertools.pairwise((t, height(t)) for t in times):
        if a * b < 0:
            yield mpmath.findroot(height, (t, u), solver="anderson", tol=1e-60), 1 if b > 0 else -1


def crossing_time(form: ClosedForm, section: Any, state: Sequence[Any], parameters: Sequence[Any], guess: Any) -> Any:
    """The zero near a guess."""
    return mpmath.findroot(partial(height_along, form, section, state, parameters), guess, tol=1e-60)


def height(form: ClosedForm, section: Any, state: Sequence[Any]) -> Any:
    """normal . x - value."""
    terms = [exact(section.normal.get(name, Fraction(0))) * x for name, x in zip(form.system.state, state, strict=True)]
    return mpmath.fsum(terms) - exact(section.value)


def height_along(form: ClosedForm, section: Any, state: Sequence[Any], parameters: Sequence[Any], time: Any) -> Any:
    """The same as a function of time."""
    return height(form, section, form.flow(time, state, parameters))


@pytest.mark.parametrize("boxes", BOXES)
@pytest.mark.parametrize("form", [SPIRAL, OSCILLATOR], ids=lambda form: form.system.name)
@pytest.mark.parametrize("on_section", [False, True], ids=["off the section", "on the section"])
def test_poincare_maps_of_random_affine_sections_enclose_closed_forms(
    form: ClosedForm, on_section: bool, boxes: int
) -> None:
    source = random.Random(f"section {form.system.name} {on_section}")
    tried = 0
    while tried < boxes:
        box = drawn(source, form)
        state = form.system.state
        normal = {name: random_fraction(source) for name in state}
        if on_section:
            # The last coordinate of the state follows from the others.
            last = state[-1]
            if abs(normal[last]) < Fraction(1, 8):
                continue
            number = len(box.radii)
            rows = {name: list(box.row(name)) for name in box.centre}
            rows[last] = [
                -sum((normal[name] * rows[name][j] for name in state[:-1]), Fraction(0)) / normal[last]
                for j in range(number)
            ]
            box = enclose.box(box.centre, rows, box.radii)
            value = sum((normal[name] * box.centre[name] for name in state), Fraction(0))
        else:
            value = random_fraction(source, 0.3)
        section = enclose.section(normal, value)
        start, parameters = at(box, form, [0] * len(box.radii))
        along = partial(height_along, form, section, start, parameters)
        direction, number = source.choice((-1, 0, 1)), source.randint(1, 2)
        found = enclose.poincare_map(
            form.system, box, section, direction=direction, crossings=number, derivatives=2, precision=96
        )
        if isinstance(found, NotEnclosed):
            # Close to the section at the start, to a tangency, or no such crossing: never a wrong answer.
            assert found.reason.remedy
            continue
        tried += 1
        time = next(itertools.islice((t for t, d in roots(along, 20.0) if direction in (0, d)), number - 1, None))

        def image(p: Sequence[Any], box: Box = box, section: Any = section, time: Any = time) -> Sequence[Any]:
            x, a = at(box, form, p)
            return form.flow(crossing_time(form, section, x, a, time), x, a)

        for where in points(source, box, 8):
            x, a = at(box, form, where)
            contained(found, where, image(where), crossing_time(form, section, x, a, time))
        if tried == 1:
            with mpmath.workdps(60):
                jets_contained(found, image, points(source, box, 1)[0], 1e-7)


LORENZ = define_system({
    "name": "lorenz", "state": "x y z", "parameters": "sigma rho beta",
    "field": {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"},
})  # fmt: skip
ROESSLER = define_system({
    "name": "roessler", "state": "x y z", "parameters": "a b c",
    "field": lambda x, y, z, a, b, c: (-y - z, x + a * y, b + z * (x - c)),
})  # fmt: skip
CHAOTIC = {
    "lorenz": (LORENZ, {"x": "-13.8", "y": "-19.6", "z": 27, "sigma": 10, "rho": 28, "beta": "8/3"}, ("z", 27)),
    "roessler": (ROESSLER, {"x": 0, "y": -5, "z": "0.03", "a": "0.2", "b": "0.2", "c": "5.7"}, ("x", 0)),
}


def followed(system: System, box: Box, p: Sequence[Fraction], time: Any, steps: int) -> list[Any]:
    """The state of one orbit, by an integrator that shares nothing with the one under test."""
    values = {
        name: exact(middle + sum((a * x for a, x in zip(box.row(name), p, strict=True)), Fraction(0)))
        for name, middle in box.centre.items()
    }
    state, parameters = [values[n] for n in system.state], [values[n] for n in system.parameters]
    return extrapolated_flow(system, parameters, state, time, steps, 10)


@pytest.mark.parametrize("number", [1, pytest.param(6, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", CHAOTIC)
def test_random_orbits_lie_in_the_enclosures_of_flow_and_poincare_map(name: str, number: int) -> None:
    system, centre, (coordinate, value) = CHAOTIC[name]
    source = random.Random(name)
    names = [each for each in system.state if each != coordinate]
    parameter = next(iter(system.parameters))
    frame = random_frame(source, 3)
    rows = {each: frame[index] for index, each in enumerate([*names, parameter])}
    box = enclose.box(centre, rows, ["1e-9", "1e-9", "1e-10"])
    flow = enclose.flow(system, box, "1/2", derivatives=2)
    returned = enclose.poincare_map(system, box, enclose.section(coordinate, value), direction=1, derivatives=2)
    assert isinstance(flow, Enclosure)
    assert isinstance(returned, Enclosure)
    assert agree(returned.value[coordinate], arb(value))
    for _ in range(number):
        p = [random_fraction(source, radius) for radius in box.radii]
        where = [arb(x.numerator) / x.denominator for x in p]
        state = followed(system, box, p, mpmath.mpf("0.5"), 20)
        assert all(holds(ball, x) for ball, x in zip(flow.value.values(), state, strict=True))
        assert all(holds(ball, x, 1e-20) for ball, x in zip(flow.over(where).value.values(), state, strict=True))
        time = returned.over(where).time
        state = followed(system, box, p, mpmath.mpf(time.mid().str(40, radius=False)), 60)
        near = returned.over(where).value
        for each, x in zip(system.state, state, strict=True):
            assert holds(returned.value[each], x, 1e-15)
            assert holds(near[each], x, 1e-15)


def test_one_half_return_of_a_known_system_agrees_with_the_half_orbit() -> None:
    centre = {"x": "0.843193964637", "y": 0, "z": "0.165", "vx": 0, "vy": "0.263718532564", "vz": 0, "mu": EARTH_MOON}
    box = enclose.box(centre, radii={"x": "1e-9", "vy": "1e-9"})
    found = enclose.poincare_map(CR3BP, box, enclose.section("y"), direction=0)
    assert isinstance(found, Enclosure)
    state = followed(CR3BP, box, (0, 0), mpmath.mpf(found.centre.time.mid().str(40, radius=False)), 40)
    assert all(holds(found.centre.value[name], x, 1e-15) for name, x in zip(CR3BP.state, state, strict=True))


def test_interval_newton_proves_a_periodic_orbit_of_lorenz() -> None:
    centre = {"x": "-13.763610682134", "y": "-19.578751942452", "z": 27, "sigma": 10, "rho": 28, "beta": "8/3"}
    section = enclose.section("z", 27)
    box = enclose.box(centre, radii={"x": "1e-10", "y": "1e-10"})
    image = enclose.poincare_map(LORENZ, box, section, direction=1, crossings=2, derivatives=2)
    assert isinstance(image, Enclosure)
    zero = enclose.interval_newton(enclose.fixed_point_functions(image))
    assert isinstance(zero, enclose.Zero)
    # Viswanath, Symbolic dynamics and periodic orbits of the Lorenz attractor, Nonlinearity 16 (2003), orbit AB.
    assert holds(image.over(zero.at).time, mpmath.mpf("1.55865221071617"), 1e-14)
    assert zero.point["x"].contains(zero.point["x"].mid())
    assert zero.point["x"].rad() < 1e-15
    # The centre is 2e-13 away from it.
    assert holds(zero.point["x"], mpmath.mpf("-13.763610682134200525"), 1e-18)
    away = enclose.box({**centre, "x": "-13.76361"}, radii={"x": "1e-10", "y": "1e-10"})
    image = enclose.poincare_map(LORENZ, away, section, direction=1, crossings=2, derivatives=2)
    assert isinstance(image, Enclosure)
    refused = enclose.interval_newton(enclose.fixed_point_functions(image))
    assert isinstance(refused, NotEnclosed)
    assert "there is no zero in the set" in refused.reason.message


def test_zeros_depend_on_a_parameter() -> None:
    centre = {"x": "-13.763610682134", "y": "-19.578751942452", "z": 27, "sigma": 10, "rho": 28, "beta": "8/3"}
    rows = {"rho": [1, 0, 0], "x": [0, 1, 0], "y": [0, 0, 1]}
    section = enclose.section("z", 27)
    box = enclose.box(centre, rows, ["1e-11", "1e-9", "1e-9"])
    image = enclose.poincare_map(LORENZ, box, section, direction=1, crossings=2, derivatives=2)
    assert isinstance(image, Enclosure)
    zero = enclose.interval_newton(enclose.fixed_point_functions(image))
    assert isinstance(zero, enclose.Zero)
    assert zero.independent == 1
    ends = [zero.over([arb(side) * arb("1e-11")]) for side in (-1, 1)]
    assert not ends[0][1].overlaps(ends[1][1])


def test_what_a_function_of_the_image_is() -> None:
    box = enclose.box({"x": 1, "v": "1/2"}, radii={"x": "1/8", "v": "1/8"})
    image = enclose.flow(OSCILLATOR.system, box, 1, precision=96)
    assert isinstance(image, Enclosure)
    function = image.function({"x": 2, "v": "-1/2"}, "1/3", [3, "-1/4"])
    where = [arb("0.1"), arb("-0.05")]
    near = image.over(where).value
    expected = 2 * near["x"] - near["v"] / 2 + arb(1) / 3 + 3 * where[0] - where[1] / 4
    assert agree(function.over(where), expected)
    assert function.over(where).rad() < 1e-12
    slope = function.over(where, (1, 0))
    assert agree(slope, 2 * image.jacobian["x"][0] - image.jacobian["v"][0] / 2 + 3)


PENDULUM = define_system({
    "name": "pendulum", "state": "q v", "parameters": "g", "where": {"pull": "g*sin(q)"},
    "field": {"q": "v", "v": "-pull"}, "first_integral": "v**2/2 - g*cos(q)",
})  # fmt: skip


def test_functions_in_formulas_are_coordinates_that_follow_from_the_others() -> None:
    assert PENDULUM.given_state == ("q", "v")
    assert PENDULUM.state == ("q", "v", "sin_q", "cos_q")
    box = enclose.box({"q": 1, "v": 0, "g": 1}, radii={"q": "1e-4", "g": "1e-4"})
    half = enclose.poincare_map(PENDULUM, box, enclose.section("v"), derivatives=2)
    assert isinstance(half, Enclosure)
    # The period of the pendulum is a complete elliptic integral.
    for q, g in ((1, 1), (1 - mpmath.mpf("1e-4"), 1 + mpmath.mpf("1e-4")), (1 + mpmath.mpf("5e-5"), 1)):
        time = 2 * mpmath.ellipk(mpmath.sin(mpmath.mpf(q) / 2) ** 2) / mpmath.sqrt(g)
        assert holds(half.time, time)
        assert holds(half.over([_ball(mpmath.mpf(q) - 1), _ball(mpmath.mpf(g) - 1)]).time, time)
    assert holds(half.value["cos_q"], mpmath.cos(1))
    assert holds(half.value["sin_q"], -mpmath.sin(1))
    assert half.centre.time.rad() < 1e-20
    assert holds(half.centre.jacobian["q"][0], -1)
    assert holds(half.centre.jacobian["sin_q"][0], -mpmath.cos(1))


@pytest.mark.parametrize("rate", ["0*v", "v*cos_q + q - q**2", "-v*cos_q", "v*sin_q"])
def test_a_field_that_does_not_keep_its_functions_is_not_followed(rate: str) -> None:
    """A description may say what it likes of its further coordinates."""
    written = describe(PENDULUM)
    assert isinstance(written, dict)
    assert define_system(written) == PENDULUM
    names = [*PENDULUM.state, *PENDULUM.parameters]

    def field(values: Any) -> Any:
        known = dict(zip(names, values, strict=True))
        return [known["v"], -known["g"] * known["sin_q"], evaluate_formula(rate, known), -known["sin_q"] * known["v"]]

    forged = define_system({**written, "field": record(field, names).text(), "first_integral": None})
    start = enclose.box({"q": 1, "v": 1, "g": 1})
    with pytest.raises(ValueError, match="sin_q, cos_q are not shown to stay the functions"):
        enclose.flow(forged, start, "1/4")
    with pytest.raises(ValueError, match="sin_q, cos_q are not shown to stay the functions"):
        enclose.poincare_map(forged, start, enclose.section("v"))


@pytest.mark.parametrize(
    ("centre", "radii"),
    [
        ({"x": -1, "y": 0, "z": 0, "a": 1}, {}),
        ({"x": 1, "y": 0, "z": 0, "a": 1}, {"x": 1}),
        ({"x": 0, "y": 0, "z": 0, "a": 1}, {}),
    ],
)
def test_functions_that_are_not_defined_on_the_box_are_refused(centre: Any, radii: Any) -> None:
    found = enclose.flow(NESTED.system, enclose.box(centre, radii=radii), "1/10", precision=64)
    assert isinstance(found, NotEnclosed)


CIRCLE = define_system({"name": "circle", "state": "x v", "field": {"x": "v", "v": "-x"}})
BLOW_UP = define_system({"name": "blow-up", "state": "x y", "field": {"x": "x**2", "y": "1"}})
POINT = enclose.box({"x": 1, "v": 0})
POLE = define_system({"name": "pole", "state": "x y", "field": {"x": "-1/x", "y": "1"}})


@pytest.mark.parametrize(
    ("centre", "radii", "section", "options", "words"),
    [
        ({"x": 1, "v": 0}, {"x": "1e-3"}, enclose.section("x", 1), {}, "may be on the section"),
        ({"x": 1, "v": 0}, {}, enclose.section("x", 1), {}, "cannot be separated from zero|changes sign"),
        ({"x": 1, "v": 0}, {"x": "1e-3"}, enclose.section("x", -1), {"direction": -1}, "crossing|section"),
        ({"x": 0, "v": 1}, {"v": "1e-3"}, enclose.section("x", "0.9999"), {}, "velocity across the section"),
        ({"x": 1, "v": "1/10"}, {"x": "1e-3"}, enclose.section("x", 2), {}, "cannot be separated|was not reached"),
        ({"x": 1, "v": 0}, {"x": "1/2", "v": "1/2"}, enclose.section("v"), {}, "on the section"),
        ({"x": 1, "v": 2}, {"x": "1/2", "v": "1/2"}, enclose.section("v"), {}, ""),
    ],
    ids=["box across", "tangent start", "tangency", "near tangency", "never", "box too large", "box large"],
)  # fmt: skip
def test_what_cannot_be_enclosed_is_refused_with_a_reason(
    centre: Any, radii: Any, section: Any, options: Any, words: str
) -> None:
    found = enclose.poincare_map(CIRCLE, enclose.box(centre, radii=radii), section, precision=96, **options)
    assert isinstance(found, NotEnclosed)
    assert not found
    assert found.reason.remedy
    assert str(found).startswith("not enclosed")
    assert any(word in found.reason.message for word in words.split("|"))


@dataclass
class Blind:
    """An expansion that sees no crossing at first."""

    honest: Any
    sees: bool

    def __getattr__(self, name: str) -> Any:
        return getattr(self.honest, name)

    def crossing(self, *arguments: Any) -> Fraction | None:
        return self.honest.crossing(*arguments) if self.sees else None


@dataclass
class BlindOracle:
    """Misses the crossings of the first steps."""

    steps: int
    asked: int = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(ORACLE, name)

    def expand(self, *arguments: Any) -> Any:
        self.asked += 1
        return Blind(ORACLE.expand(*arguments), self.asked > self.steps)


def test_short_arcs_are_crossed_in_the_direction_asked_for() -> None:
    for size, side, direction in itertools.product(("1/200", "1/3", "1e-4", "1e-7", "3/4"), (-1, 1), (-1, 0, 1)):
        t = Fraction(size) * side
        # The arc between the points (-t, t^2 - 1)/(t^2 + 1) and (t, t^2 - 1)/(t^2 + 1) of the circle.
        x, v = 2 * t / (1 + t * t), (t * t - 1) / (1 + t * t)
        whole, angle = 2 * mpmath.pi, 4 * mpmath.atan(exact(t))
        first = angle if side > 0 else whole + angle
        box = enclose.box({"x": x, "v": v}, radii={} if size == "1e-7" else {"x": "1e-30"})
        for oracle in (ORACLE, BlindOracle(1), BlindOracle(2)):
            found = enclose.poincare_map(
                CIRCLE, box, enclose.section("v", v), direction=direction, precision=200, oracle=oracle
            )
            if isinstance(found, NotEnclosed):
                assert oracle is not ORACLE, str(found)
                continue
            here = direction == (-1 if x > 0 else 1)
            assert holds(found.time, whole if here else first), (size, side, direction, str(found))
            assert holds(found.value["x"], exact(x if here else -x))


def test_a_direction_that_never_comes_is_refused() -> None:
    box = enclose.box({"x": -1, "y": 0}, radii={"x": "1e-3"})
    for section, direction in ((enclose.section("y", 1), -1), (enclose.section("y", -1), 1)):
        found = enclose.poincare_map(BLOW_UP, box, section, direction=direction, precision=64)
        assert isinstance(found, NotEnclosed)
        assert "was not reached" in found.reason.message or "step" in found.reason.message
    there = enclose.poincare_map(BLOW_UP, box, enclose.section("y", 1), direction=1, precision=64)
    assert isinstance(there, Enclosure)
    assert holds(there.time, 1)


def test_orbits_that_end_are_not_enclosed() -> None:
    for system, centre in ((BLOW_UP, {"x": 1, "y": 0}), (POLE, {"x": 1, "y": 0})):
        box = enclose.box(centre, radii={"x": "1e-3"})
        assert isinstance(enclose.flow(system, box, "1/4", precision=64), Enclosure)
        found = enclose.flow(system, box, 1, precision=64)
        assert isinstance(found, NotEnclosed)
        assert found.reason.reached is not None
        assert found.reason.reached < 1
    assert isinstance(enclose.flow(POLE, enclose.box({"x": 0, "y": 0}), 1, precision=64), NotEnclosed)
    wide = enclose.box({"x": 1, "y": 0}, radii={"x": 5})
    assert isinstance(enclose.flow(POLE, wide, "1/100", precision=64), NotEnclosed)


def test_nothing_is_said_outside_the_box() -> None:
    box = enclose.box({"x": 1, "v": 0}, radii={"x": "1e-3", "v": "1e-2"})
    image = enclose.flow(CIRCLE, box, 1, precision=96)
    assert isinstance(image, Enclosure)
    function = image.function({"x": 1}, "-0.5403023")
    zero = enclose.interval_newton([function])
    assert isinstance(zero, enclose.Zero)
    for value in ("0.0010001", "-5", "1e300"):
        with pytest.raises(ValueError, match="in the box"):
            zero.over([arb(value)])
        with pytest.raises(ValueError, match="in the box"):
            function.over([arb(0), 10 * arb(value)])
        with pytest.raises(ValueError, match="in the box"):
            image.over([arb(value), arb(0)])
    ((inside, _), (across, _)) = zero.over([arb("0.001")]), zero.over([arb("0.0011", "0.0002")])
    assert agree(inside, across)
    assert across <= arb("0.0010000001")
    for derivative in ((4, 0), (-1, 0), (2, 2)):
        with pytest.raises(ValueError, match="derivative"):
            function.over([arb(0), arb(0)], derivative)


def test_derivatives_of_the_time_of_a_crossing() -> None:
    box = enclose.box({"x": 1, "v": "1/2"}, radii={"x": "1e-3", "v": "1e-3"})
    found = enclose.poincare_map(CIRCLE, box, enclose.section("v"), derivatives=2)
    assert isinstance(found, Enclosure)
    # The angle of (x, v) is atan(v/x): its derivatives at (1, 1/2).
    centre = found.centre.time_derivatives
    for index, value in {(0, 0): mpmath.atan("0.5"), (1, 0): "-0.4", (0, 1): "0.8", (1, 1): "-0.48"}.items():
        assert holds(centre[index], mpmath.mpf(value))
        assert holds(found.on_box.time_derivatives[index], mpmath.mpf(value))


def test_a_zero_is_shown_for_each_value_of_the_independent_variables() -> None:
    box = enclose.box({"x": 1, "v": 0}, radii={"x": "1e-2", "v": "1e-3"})
    image = enclose.flow(CIRCLE, box, 1, precision=96)
    assert isinstance(image, Enclosure)
    # At the centre the zero is there, and leaves the box in v as x moves by less than its radius.
    found = enclose.interval_newton([image.function({"x": 1}, "-0.5403023")])
    assert isinstance(found, NotEnclosed)
    assert "may lie outside" in found.reason.message
    function = image.function({"x": 1})
    with pytest.raises(ValueError, match="as many at most"):
        enclose.interval_newton([function] * 3)


def test_backwards_the_time_that_was_reached_is_negative() -> None:
    box = enclose.box({"x": -1, "y": 0}, radii={"x": "1e-3"})
    found = enclose.flow(BLOW_UP, box, -2)
    assert isinstance(found, NotEnclosed)
    assert found.reason.reached is not None
    assert -1 < found.reason.reached < -0.9
    assert " at time -0.9" in str(found)
    assert found.precision > 128


def test_what_progress_raises_passes_through() -> None:
    box = enclose.box({"x": 1, "v": 0}, radii={"x": "1e-3"})
    for error in (ValueError("mine"), ZeroDivisionError("mine"), IntegrationFailure("mine", "mine", "mine")):

        def progress(steps: int, error: Exception = error) -> None:
            raise error

        for call in (
            partial(enclose.flow, CIRCLE, box, 1),
            partial(enclose.poincare_map, CIRCLE, box, enclose.section("v")),
        ):
            with pytest.raises(type(error), match="mine"):
                call(precision=64, progress=progress)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: enclose.box({"x": 0.1, "v": 0}), "no exact number"),
        (lambda: enclose.box({"x": "nan", "v": 0}), "no exact number"),
        (lambda: enclose.box({"x": True, "v": 0}), "no exact number"),
        (lambda: enclose.box({"x": "+-1", "v": 0}), "no exact number"),
        (lambda: enclose.Box({"x": 0.5, "v": 0}, {}, ()), "no Fraction"),  # type: ignore[dict-item]
        (lambda: enclose.Box({"x": Fraction(1)}, {"x": (Fraction(1),)}, (Fraction(-1),)), "positive"),
        (lambda: enclose.Box({"x": Fraction(1)}, {"x": ()}, (Fraction(1),)), "one for each"),
        (lambda: enclose.Section({"x": Fraction(0)}, Fraction(0)), "normal is zero"),
        (lambda: enclose.box({"x": 1, "v": 0}, radii={"x": 0}), "positive"),
        (lambda: enclose.box({"x": 1, "v": 0}, radii={"u": 1}), "unknown"),
        (lambda: enclose.box({"x": 1, "v": 0}, None, [1]), "by name"),
        (lambda: enclose.box({"x": 1, "v": 0}, {"x": [1, 0]}, [1]), "one for each"),
        (lambda: enclose.section("x", "oo"), "no exact number"),
        (lambda: enclose.section({"x": 0}), "normal is zero"),
        (lambda: enclose.flow(CIRCLE, enclose.box({"x": 1}), 1), "v is missing"),
        (lambda: enclose.flow(CIRCLE, enclose.box({"x": 1, "v": 0, "mu": 1}), 1), "has no mu"),
        (lambda: enclose.flow(CIRCLE, enclose.box({"x": 1, "v": 0}), 0), "time"),
        (lambda: enclose.flow(CIRCLE, enclose.box({"x": 1, "v": 0}), 1, derivatives=4), "derivatives"),
        (lambda: enclose.flow(CIRCLE, enclose.box({"x": 1, "v": 0}), 1, precision=0), "precision"),
        (lambda: enclose.flow(CIRCLE, enclose.box({"x": 1, "v": 0}), 1, degree=0), "degree"),
        (lambda: enclose.poincare_map(CIRCLE, POINT, enclose.section("v"), degree=0), "degree"),
        (lambda: enclose.poincare_map(CIRCLE, POINT, enclose.section("u")), "no state"),
        (lambda: enclose.poincare_map(CIRCLE, POINT, enclose.section("v"), direction=2), "none"),
        (lambda: enclose.poincare_map(CIRCLE, POINT, enclose.section("v"), crossings=0), "crossings"),
        (lambda: enclose.flow(CR3BP, enclose.box({**dict.fromkeys(CR3BP.state, 1), "mu": 2}), 1), "outside"),
        (lambda: enclose.flow(
            CR3BP, enclose.box({**dict.fromkeys(CR3BP.state, 1), "mu": "1/4"}, {"mu": [1, -1]}, ["1/4", "1/8"]), 1
        ), "outside"),
        (lambda: enclose.flow(
            CR3BP, enclose.box({**dict.fromkeys(CR3BP.state, 1), "mu": "3/4"}, {"mu": [1, -1]}, ["1/4", "1/8"]), 1
        ), "outside"),
        (lambda: enclose.flow(CIRCLE, POINT, 1, derivatives=-1), "derivatives"),
        (lambda: enclose.interval_newton([]), "functions"),
        (lambda: enclose.flow(PENDULUM, enclose.box({"q": 1, "v": 0, "g": 1, "sin_q": 0}), 1), "has no sin_q"),
        (lambda: enclose.section("sin_q").of(PENDULUM), "given"),
    ],
)  # fmt: skip
def test_wrong_input_is_an_exception_of_one_line(call: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words) as error:
        call()
    assert "\n" not in str(error.value)


def test_fixed_points_are_asked_for_on_the_section_only() -> None:
    box = enclose.box({"x": 1, "v": "1/10"}, radii={"x": "1e-3"})
    flow = enclose.flow(CIRCLE, box, 1, precision=64)
    image = enclose.poincare_map(CIRCLE, box, enclose.section("v"), precision=64)
    for found in (flow, image):
        assert isinstance(found, Enclosure)
        with pytest.raises(ValueError, match="section"):
            enclose.fixed_point_functions(found)


def test_functions_with_common_zeros_are_on_one_box() -> None:
    images = [
        enclose.flow(CIRCLE, enclose.box({"x": 0, "v": 0}, radii={"x": radius, "v": radius}), 1, precision=64)
        for radius in ("1e-3", "1e-4")
    ]
    first, second = (image.function({name: 1}) for image, name in zip(images, "xv", strict=True))
    with pytest.raises(ValueError, match="one box"):
        enclose.interval_newton([first, second])
    assert enclose.interval_newton([images[0].function({name: 1}) for name in "xv"])


def test_more_bits_are_taken_until_there_are_the_digits_asked_for() -> None:
    few, many = (enclose.flow(CIRCLE, POINT, 1, digits=digits) for digits in (15, 60))
    assert isinstance(few, Enclosure)
    assert isinstance(many, Enclosure)
    assert few.precision == 128 < many.precision
    assert few.centre.value["x"].rad() > 1e-60 > many.centre.value["x"].rad()


def test_a_centre_of_the_circle_is_no_isolated_orbit() -> None:
    box = enclose.box({"x": 1, "v": 0}, radii={"x": "1e-3"})
    image = enclose.poincare_map(CIRCLE, box, enclose.section("v"), direction=-1, precision=64)
    assert isinstance(image, Enclosure)
    assert holds(image.time, 2 * mpmath.pi)
    assert isinstance(enclose.interval_newton(enclose.fixed_point_functions(image)), NotEnclosed)
