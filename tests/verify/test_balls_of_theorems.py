"""Of functions that are known up to one number the theorems tell what holds for all of these functions."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb
from support import krein_cases
from support.closed_form_maps import claim, description
from support.closed_form_maps import table as table_of
from support.inclusion import broken_inclusions
from support.polynomial_tables import table
from support.random_segments import ball
from support.within import within

from orbitproof.verify.bifurcation.conditions import Problem
from orbitproof.verify.bifurcation.fold import check as check_turning
from orbitproof.verify.bifurcation.on_the_way import _iterate
from orbitproof.verify.bifurcation.proved_bifurcation import check as check_bifurcation
from orbitproof.verify.double_resonance import proved_double_resonance as double
from orbitproof.verify.double_resonance.equations import equations_of as equations_of_resonances
from orbitproof.verify.evidence import Checklist, NotEstablishedError, enclose, guarded, indices_up_to, symmetric
from orbitproof.verify.krein import equations_of as equations_of_collision
from orbitproof.verify.krein import proved_krein
from orbitproof.verify.newton import BoxFunction, Jet
from orbitproof.verify.orbit import full_return_jets, proved_orbit
from orbitproof.verify.reversor_breaking import equations_of as equations_of_loss
from orbitproof.verify.reversor_breaking import proved_reversor_breaking as breaking
from orbitproof.verify.twist import proved_stable_orbit

BITS = 160
SMALL = Fraction(1, 2**16)

precision = within(lambda: guarded(BITS))


def constant(size: int, value: arb) -> Jet:
    return Jet(size, 3, {(0,) * size: value})


@pytest.mark.parametrize(("size", "on_levels"), [(2, False), (3, True)])
def test_folds(size: int, on_levels: bool) -> None:
    """p_0 = a + b p_1 + c p_1^2 + d p_1^3, and further coordinates; the parameter is p_0, or H."""
    chance = random.Random(size)
    radii = (SMALL,) * size
    candidate = claim(description(size - 1, on_levels), "fold", 1, radii)

    def found(a: arb, b: arb, c: arb, d: arb, slopes: list[arb]) -> Any:
        def first(p: Any, _: Any) -> Jet:
            square = p[1] * p[1]
            result = p[0] + constant(size, -a) + p[1].scaled(-b) + square.scaled(-c) + (square * p[1]).scaled(-d)
            return result if size < 3 else result + (p[2] * p[1]).scaled(arb("0.25"))

        def second(p: Any, _: Any) -> Jet:
            return p[2] + constant(size, -a) + p[1].scaled(-b) + p[0].scaled(arb("0.5"))

        def level(p: Any, _: Any) -> Jet:
            terms = [x.scaled(slope) for x, slope in zip(p, slopes, strict=True)]
            return sum(terms[1:], terms[0]) + (p[1] * p[1]).scaled(arb("0.375")) + constant(size, arb(3))

        components = [first, second][: size - 1]
        iterates = (tuple(BoxFunction(table_of(each, radii)) for each in components),)
        integral = BoxFunction(table_of(level, radii)) if on_levels else None
        box = tuple(symmetric(radius) for radius in radii)
        return check_turning(candidate, Checklist(), Problem(1, radii, box, iterates, integral))

    little = enclose(SMALL / 16)
    slopes = [arb(2), ball(chance) * little, *[arb("0.25")] * (size - 2)]
    arguments = ball(chance) * little, ball(chance) * little, arb(3), arb(1), slopes
    assert not broken_inclusions(found, arguments, chance, size=arb(2) ** -40)


@pytest.mark.parametrize("k", [2, 3])
@pytest.mark.parametrize("on_levels", [False, True])
def test_bifurcations(k: int, on_levels: bool) -> None:
    """The curves p_1 = s x + t x^2 and x = u y + v y^2 through a point, x and y the distances from it."""
    chance = random.Random(k)
    radii = (SMALL, SMALL / 16)
    kind = "touch_and_go" if k == 3 else "period_tupling"
    candidate = claim(description(1, on_levels), kind, k, radii)

    def found(at: list[arb], s: arb, t: arb, u: arb, v: arb, slope: arb) -> Any:
        def family(p: Any) -> Jet:
            x, y = (each + constant(2, -middle) for each, middle in zip(p, at, strict=True))
            return y + x.scaled(-s) + (x * x).scaled(-t)

        def product(p: Any) -> Jet:
            x, y = (each + constant(2, -middle) for each, middle in zip(p, at, strict=True))
            branch = x + y.scaled(-u) + (y * y).scaled(-v)
            return family(p) * branch * (constant(2, arb(1)) + x.scaled(arb("0.5")))

        def level(p: Any) -> Jet:
            x, y = (each + constant(2, -middle) for each, middle in zip(p, at, strict=True))
            # Tangent to the branch where it is to be.
            across = -u * slope if k == 2 else slope * arb("0.5")
            return x.scaled(slope) + y.scaled(across) + (y * y).scaled(arb(2)) + (x * y).scaled(arb("0.5"))

        def tables(function: Callable[[Any], Jet]) -> BoxFunction:
            return BoxFunction(table_of(lambda p, _: function(p), radii))

        iterates = (*((tables(family),) for _ in range(k - 1)), (tables(product),))
        box = tuple(symmetric(radius) for radius in radii)
        problem = Problem(k, radii, box, iterates, tables(level) if on_levels else None)
        return check_bifurcation(candidate, Checklist(), problem)

    little = enclose(SMALL / 1024)
    u = arb(0) if k == 2 and not on_levels else arb("0.25")
    arguments = [ball(chance) * little, ball(chance) * little / 16], arb("0.03"), arb("0.5"), u, arb(2), arb(2)
    wanted = (lambda path: path[0] != 3) if k == 2 and not on_levels else (lambda path: True)
    assert not broken_inclusions(found, arguments, chance, size=arb(2) ** -44, where=wanted)


@pytest.mark.parametrize(("k", "number"), [(k, number) for k in (3, 4, 6) for number in range(1, k)])
def test_each_return_before_the_last_may_have_other_orbits(k: int, number: int) -> None:
    """Where D_p_1 q_1 of one of them vanishes nothing is proved; of all that is asked before that is what fails."""
    radii = (SMALL, SMALL / 16)
    candidate = claim(description(1, False), "touch_and_go" if k == 3 else "period_tupling", k, radii)

    def component(place: int) -> BoxFunction:
        def linear(p: Any, _: Any) -> Jet:
            return p[1] if place != number else p[1] * p[1] if number > 1 else p[0]

        return BoxFunction(table_of(linear, radii))

    box = tuple(symmetric(radius) for radius in radii)
    problem = Problem(k, radii, box, tuple((component(place),) for place in range(1, k + 1)), None)
    with pytest.raises(NotEstablishedError) as caught:
        check_bifurcation(candidate, Checklist(), problem)
    assert caught.value.reason.condition == (f"regular-{number}" if number > 1 else "family")


@pytest.mark.parametrize("k", [3, 4, 5])
def test_derivatives_of_later_returns_hold_those_at_all_points_of_the_box(k: int) -> None:
    """By the recurrences of two returns, at corners of the box in a skew frame."""
    chance = random.Random(k)
    radii, size = (Fraction(1, 8), Fraction(1, 16), Fraction(1, 32)), 3
    frame = tuple(tuple(Fraction(chance.randint(-4, 4), 4) + 2 * (i == j) for j in range(size)) for i in range(size))
    candidate = claim(description(2, True), "period_tupling", k, radii, frame=frame)
    sides = [symmetric(radius) for radius in radii]

    def function() -> Any:
        return table({index: ball(chance) for index in indices_up_to(size, 3) if sum(index)}, sides)

    kernels = tuple(tuple(BoxFunction(function()) for _ in range(2)) for _ in range(2))
    found: Any = SimpleNamespace(image={name: function() for name in candidate.coordinates})
    over = _iterate(candidate, Problem(k, radii, tuple(sides), kernels, None), found)
    for signs in product((-1, 1), repeat=size):
        corner = tuple(sign * enclose(radius) for sign, radius in zip(signs, radii, strict=True))
        at = _iterate(candidate, Problem(k, radii, corner, kernels, None), found)
        for i, j in product(range(2), range(size)):
            assert over[i, j].contains(at[i, j].mid())


Polynomials = list[dict[tuple[int, ...], arb]]


def tables(polynomials: Polynomials, radius: Fraction) -> list[Any]:
    sides = [symmetric(radius)] * len(next(iter(polynomials[0])))
    return [table(each, sides) for each in polynomials]


def test_collisions() -> None:
    chance, half, radius = random.Random(0), krein_cases.known_half(0), Fraction(1, 2**24)
    polynomials = [{index: enclose(value) for index, value in each.items()} for each in half.components]
    for each in polynomials:
        each[0, 0, 0, 0, 0] = ball(chance) * arb(2) ** -28
    candidate = krein_cases.of_family(radii=(radius,) * 3)

    def found(polynomials: Polynomials) -> Any:
        functions = tables(polynomials, radius)
        known: Any = SimpleNamespace(
            iterates=(tuple(functions[2:]),), image=tuple(functions[:2]), half_period=functions[0], sheet=()
        )
        equations = equations_of_collision(known)
        where = proved_krein._check_point(Checklist(), candidate, equations)
        jets = full_return_jets(equations.jets(where))
        cosine = proved_krein._check_circle(Checklist(), jets)
        proved_krein._check_resonances(Checklist(), cosine)
        speed = proved_krein._check_side(Checklist(), equations, where)
        coefficient = proved_krein.cubic_coefficient(jets, cosine).real
        return proved_krein._results(candidate, known, where, cosine, speed, coefficient)

    degrees = lambda path: sum(path[-1]) < 3  # noqa: E731
    assert not broken_inclusions(found, (polynomials,), chance, 2, size=arb(2) ** -40, where=degrees)


def test_losses_of_r() -> None:
    """B is singular for h = 0, up to terms that move the point."""
    chance, radius = random.Random(0), Fraction(1, 2**20)
    units = [tuple(int(i == j) for i in range(5)) for j in range(5)]
    h, p1, p2, q1, q2 = units

    def both(first: tuple[int, ...], second: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(a + b for a, b in zip(first, second, strict=True))

    kernel: Polynomials = [{p1: arb(2), p2: arb("0.5"), h: arb(1)}, {p1: arb("-0.25"), p2: arb(1), h: arb("0.5")}]
    image: Polynomials = [{p1: arb(1), q1: arb("0.5"), q2: arb(1)}, {p2: arb(1), q1: arb(1), q2: arb(2)}]
    image[0] |= {both(h, q1): arb(3), both(p1, q1): arb("0.5"), both(both(q1, q1), q1): arb(-2)}
    image[1] |= {both(p2, q2): arb("0.25"), both(both(q1, q2), q2): arb("0.5")}
    for each in kernel:
        each |= {both(q1, q1): arb("0.5"), both(q1, q2): arb("0.25"), both(p1, p2): arb("0.125")}
    for each in (*kernel, *image):
        each[0, 0, 0, 0, 0] = ball(chance) * arb(2) ** -26
    candidate = krein_cases.of_family(radii=(radius,) * 3, kind="reversor_breaking")

    def found(kernel: Polynomials, image: Polynomials) -> Any:
        functions, images = tables(kernel, radius), tables(image, radius)
        known: Any = SimpleNamespace(iterates=(tuple(functions),), image=tuple(images), half_period=images[1], sheet=())
        equations = equations_of_loss(known)
        where = breaking._check_point(Checklist(), candidate, equations)
        coefficients = breaking._check_side(Checklist(), equations, where)
        return breaking._results(candidate, known, equations, where, coefficients)

    assert not broken_inclusions(found, (kernel, image), chance, 12, size=arb(2) ** -36)


def test_double_resonances() -> None:
    """One stability parameter, on the family u_1 = - 3 mu stationary at about u_0 = 0, and 0 there for mu = 0."""
    chance, radius = random.Random(0), Fraction(1, 2**20)
    names = ("mu", "x", "vy")
    kernel: Polynomials = [{(0, 0, 1): arb(2), (1, 0, 0): arb(6), (0, 1, 0): ball(chance) * arb(2) ** -28}]
    image: Polynomials = [{(0, 1, 0): arb(1), (0, 0, 1): arb(7)}]
    image.append(
        {(1, 0, 1): arb(-3), (0, 2, 1): arb("1.25"), (0, 1, 1): ball(chance) * arb(2) ** -26, (0, 0, 2): arb("0.25")}
    )
    for each in (*kernel, *image):
        each[0, 0, 0] = ball(chance) * arb(2) ** -26
    frame = tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3))
    candidate: Any = SimpleNamespace(
        radii=(radius,) * 3, frame=frame, centre=(Fraction(1, 4),) * 3, coordinates=names, crossings=1, k=4,
        varying="mu", system=SimpleNamespace(centre_coordinates=names[1:]),
    )  # fmt: skip

    def found(kernel: Polynomials, image: Polynomials) -> Any:
        functions, images = tables(kernel, radius), tables(image, radius)
        known: Any = SimpleNamespace(
            iterates=(tuple(functions),), image=tuple(images), half_period=images[0], first_integral=functions[0]
        )
        equations = equations_of_resonances(known, frame, arb(0))
        where = double._check_point(Checklist(), candidate, equations)
        unfolding = double._check_simple(Checklist(), equations, where)
        double._check_unfolding(Checklist(), unfolding)
        return double._results(candidate, known, equations, where, 1, unfolding)

    assert not broken_inclusions(found, (kernel, image), chance, 10, size=arb(2) ** -36)


@pytest.mark.parametrize("quantity", ["coordinate", "level", "half_period"])
def test_orbits(quantity: str) -> None:
    """One zero of what vanishes on Fix(R) and of the equation; all else is told of it."""
    chance = random.Random(quantity)
    radius = Fraction(1, 2**20)
    frame = ((Fraction(1), Fraction(-1, 2)), (Fraction(1, 4), Fraction(1)))
    candidate: Any = SimpleNamespace(
        crossings=1, radii=(radius,) * 2, frame=frame, centre=(Fraction(1, 4), Fraction(-1, 8)), coordinates=("x", "y"),
        system=SimpleNamespace(fixed_level=None, first_integral_name="H", distance_name=None),
        equation=SimpleNamespace(quantity=quantity, value=Fraction(1, 4), coordinate="x"),
    )  # fmt: skip

    def polynomial(linear: tuple[float, float], value: float) -> dict[tuple[int, ...], arb]:
        terms = {(2, 0): ball(chance), (1, 1): ball(chance), (0, 3): ball(chance)}
        return {
            (0, 0): arb(value) + ball(chance) * arb(2) ** -26,
            (1, 0): arb(linear[0]),
            (0, 1): arb(linear[1]),
            **terms,
        }

    polynomials = [
        polynomial((0.25, 2.0), 0.0), polynomial((1.5, 0.5), 0.25), polynomial((2.0, -0.5), 0.25),
        polynomial((1.0, 0.75), 0.5), polynomial((-0.5, 1.0), -0.25),
    ]  # fmt: skip
    back = tuple(tuple(ball(chance) for _ in range(2)) for _ in range(2))

    def found(polynomials: Polynomials) -> Any:
        kernel, time, level, *image = tables(polynomials, radius)
        enclosures: Any = SimpleNamespace(
            iterates=((kernel,),), image=tuple(image), half_period=time, first_integral=level, back=back, distance=None
        )
        graph = proved_orbit._check_newton(Checklist(), candidate, enclosures)
        results = proved_orbit._results(Checklist(), candidate, enclosures, graph)
        numbers = results.point, results.other_point, results.half_period, results.period, results.level
        return numbers, results.stability.parameters

    assert not broken_inclusions(found, (polynomials,), chance, 12, size=arb(2) ** -36)


def test_what_is_told_of_orbits_that_are_stable_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rotation numbers, twist and torsion, of balls of maps and of areas."""
    chance = random.Random(0)
    values: dict[str, Any] = {}
    monkeypatch.setattr(proved_stable_orbit, "concluded", lambda theorem, checklist, check: check())
    monkeypatch.setattr(proved_stable_orbit, "StableOrbitTheorem", lambda candidate: None)
    monkeypatch.setattr(proved_stable_orbit, "StableOrbitResults", lambda **known: known)
    monkeypatch.setattr(proved_stable_orbit, "fields", lambda kind: ())
    monkeypatch.setattr(proved_stable_orbit, "check_orbit", lambda *rest: values["orbit"])
    monkeypatch.setattr(proved_stable_orbit, "_check_return", lambda *rest: values["jets"])
    monkeypatch.setattr(proved_stable_orbit, "_own_area", lambda *rest: ("x", values["area"]))
    # That these maps are not reversible is not what is asked here.
    monkeypatch.setattr(proved_stable_orbit, "excludes_zero", lambda value: False)
    candidate: Any = SimpleNamespace(twist=None, system=SimpleNamespace(state=("x", "v"), kernel_coordinates=(1,)))
    bent = [{(2, 0): ball(chance), (1, 1): ball(chance), (3, 0): ball(chance)}, {(0, 2): ball(chance), (2, 1): arb(1)}]

    def of_one(angle: arb, area: arb) -> Any:
        cosine, sine = angle.cos(), angle.sin()
        linear = {(1, 0): cosine, (0, 1): -2 * sine}, {(1, 0): sine / 2, (0, 1): cosine}
        jets = tuple(Jet(2, 3, {**first, **more}) for first, more in zip(linear, bent, strict=True))
        values.update(jets=jets, area=area)
        values["orbit"] = SimpleNamespace(stability=SimpleNamespace(parameters=(SimpleNamespace(real=cosine),)))
        return proved_stable_orbit.prove_stable_orbit(candidate, Checklist(), SimpleNamespace())  # type: ignore[arg-type]

    assert not broken_inclusions(of_one, (ball(chance, 0.6, 0.9), ball(chance, 1, 2)), chance)
