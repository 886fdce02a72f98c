"""Reduction, normal form and side against polynomials whose curves and derivatives are known in closed form."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction as F
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.claims import known
from support.closed_form_maps import claim, description, table, tables_of_maps, verdict
from support.map_cases import CASES, WIDE, failed, proof
from support.within import within

from orbitproof.verify.bifurcation import (
    BifurcationFunction,
    BifurcationResults,
    DoublySymmetricFamily,
    PeriodTwoFamily,
    Problem,
    ReducedFunction,
    check_family,
    check_fold,
    check_own_box,
    check_reduced_function,
    check_reduction,
    check_transversality,
    coordinates_in_box,
    enclose_first_integral,
    level_form,
    locate,
    narrowed_zero,
    reduced_function,
)
from orbitproof.verify.bifurcation.conditions import _crossing, require_inside
from orbitproof.verify.bifurcation.level_forms import _images, _is_own_box
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    Evidence,
    NotEstablishedError,
    Outcome,
    enclose,
    symmetric,
)
from orbitproof.verify.newton import BoxFunction, ImplicitGraph, Jet

Function = Callable[[Sequence[Any], Callable[[F], Any]], Any]

SMALL = F(1, 2**20)

precision = within(lambda: ctx.workprec(300))


@dataclass(frozen=True)
class Crossing:
    """p_1 = s x + t x^2 and x = u y + v y^2 through a point (x, y are the distances from it), and levels H.

    P^k is (p_1 - family) (x - branch) (1 + m y + n x), and H = h + K_0 x + K_1 y + a x^2 + b x y + c y^2.
    """

    s: F = F(1, 3)
    t: F = F(2)
    u: F = F(1, 5)
    v: F = F(7)
    m: F = F(3)
    n: F = F(-2)
    k_0: F = F(3, 2)
    k_1: F = F(-3, 10)
    a: F = F(4)
    b: F = F(-6)
    c: F = F(5)
    at: tuple[F, F] = (SMALL / 64, SMALL / 32)
    level: F = F(11)

    def distances(self, p: Sequence[Any], number: Callable[[F], Any]) -> tuple[Any, Any]:
        return p[0] + number(-self.at[0]), p[1] + number(-self.at[1])

    def family(self, p: Sequence[Any], number: Callable[[F], Any]) -> Any:
        x, y = self.distances(p, number)
        return y + x * number(-self.s) + x * x * number(-self.t)

    def product(self, p: Sequence[Any], number: Callable[[F], Any]) -> Any:
        x, y = self.distances(p, number)
        branch = x + y * number(-self.u) + y * y * number(-self.v)
        return self.family(p, number) * branch * (number(F(1)) + y * number(self.m) + x * number(self.n))

    def integral(self, p: Sequence[Any], number: Callable[[F], Any]) -> Any:
        x, y = self.distances(p, number)
        square = x * x * number(self.a) + x * y * number(self.b) + y * y * number(self.c)
        return number(self.level) + x * number(self.k_0) + y * number(self.k_1) + square

    def outcome(self, k: int, radii: tuple[F, F], **changes: Any) -> Outcome[BifurcationResults]:
        tables = [[table(self.family, radii)] for _ in range(k - 1)] + [[table(self.product, radii)]]
        kind = "touch_and_go" if k == 3 else "period_tupling"
        return verdict(claim(description(1, True), kind, k, radii, **changes), tables, table(self.integral, radii))

    @property
    def along_family(self) -> F:
        return self.k_0 + self.k_1 * self.s

    @property
    def along_branch(self) -> F:
        return self.k_0 * self.u + self.k_1

    @property
    def curvature(self) -> F:
        return 2 * (self.k_0 * self.v + self.a * self.u**2 + self.b * self.u + self.c)


def is_near(ball: arb, value: F) -> bool:
    return ball.contains(enclose(value)) and bool(ball.rad() < 1e-3 * (1 + abs(float(value))))


@pytest.mark.parametrize("turned", [False, True])
def test_the_normal_form_of_a_doubling_is_that_of_its_curves(turned: bool) -> None:
    case = Crossing() if not turned else Crossing(v=F(-7), c=F(-5), m=F(-1), a=F(-3))
    assert case.along_branch == 0
    results = proof(case.outcome(2, (SMALL, SMALL))).results
    expected = {
        "h_b''": case.curvature,
        "beta": case.curvature / 2,
        "h_fp'": case.along_family,
        "alpha": (1 - case.u * case.s) / case.k_0,
    }
    for name, value in expected.items():
        assert is_near(results.normal_form[name], value), name
    assert results.side == ("above" if case.curvature > 0 else "below")
    assert results.parameter.contains(enclose(case.level))
    assert results.parameter.rad() < 1e-12


def test_the_normal_form_of_a_touch_and_go_is_that_of_its_curves() -> None:
    case = Crossing(k_1=F(2, 5))
    results = proof(case.outcome(3, (SMALL, SMALL))).results
    slope = case.along_branch
    expected = {
        "h_b'": slope,
        "h_fp'": case.along_family,
        "beta": slope / (1 - case.s * slope / case.along_family),
        "alpha": (1 - case.u * case.s) / case.k_0,
    }
    for name, value in expected.items():
        assert is_near(results.normal_form[name], value), name
    assert results.side == "both"


def test_a_point_of_the_box_is_the_centre_and_the_frame_times_p() -> None:
    case, centre, frame = Crossing(), (F(2), F(-3)), ((F(1), F(4)), (F(-2), F(3)))
    point = proof(case.outcome(2, (SMALL, SMALL), centre=centre, frame=frame)).results.point
    for ball, origin, row in zip(point.values(), centre, frame, strict=True):
        assert ball.contains(enclose(origin + row[0] * case.at[0] + row[1] * case.at[1]))
        assert ball.rad() < 1e-14


@pytest.mark.parametrize("k", [2, 4])
def test_the_normal_form_of_maps_with_a_parameter_is_that_of_their_curves(k: int) -> None:
    """On q = y (x - v y^2) (1 + m x): G_01 = 1, and nu is v y^2 along the branch."""
    for v in (F(5), F(-5)):
        tables = [[table(lambda p, c: p[1], (SMALL, SMALL))] for _ in range(k - 1)]
        tables += [[table(lambda p, c, v=v: p[1] * (p[0] + p[1] * p[1] * c(-v)) * (p[0] + c(F(1))), (SMALL, SMALL))]]
        found = proof(verdict(claim(description(1, False), "period_tupling", k, (SMALL, SMALL)), tables, None)).results
        assert found.side == ("above" if v > 0 else "below")
        assert is_near(found.normal_form["beta"], v)
        assert is_near(found.normal_form["alpha"], F(1))


def jet(values: dict[tuple[int, int], F | arb]) -> Jet:
    return Jet(2, 3, {index: enclose(value) if isinstance(value, F) else value for index, value in values.items()})


def test_the_reduced_function_is_the_mean_between_the_family_and_the_point() -> None:
    """G_1(0, c + d) = a + b d + e d^2/2 has the mean a + b d/2 + e d^2/6."""
    foot, a, b, e = F(1, 16), F(1, 8), F(3), F(5)
    at_foot = jet({(0, 1): a, (0, 2): b / 2, (0, 3): e / 6})
    for p_1 in (F(-1), F(-1, 3), F(1, 2), F(1)):
        d = p_1 - foot
        within = enclose(b).union(enclose(b + e * d))
        across = jet({(0, 2): within / 2, (0, 3): e / 6})
        assert across.derivative(0, 2).contains(enclose(b))
        reduced = ReducedFunction(enclose(F(2)), enclose(foot), at_foot, across)
        mean = a + b * d / 2 + e * d**2 / 6
        assert agree(reduced.at_centre(enclose(p_1)), enclose(mean))
        assert reduced.at_centre(enclose(p_1)).rad() < 1e-60
        assert agree(reduced.zero(enclose(p_1)), enclose(-mean / 2))


def test_the_remainder_of_the_reduced_function_is_taken_over_all_points_between() -> None:
    third = arb(5, 2)
    at_foot = jet({(0, 1): F(0), (0, 2): F(1), (0, 3): F(5, 6)})
    across = jet({(0, 2): arb(1, 4), (0, 3): third / 6})
    ball = ReducedFunction(arb(1), arb(0), at_foot, across).at_centre(arb(1))
    for e in (F(3), F(7)):
        assert ball.contains(enclose(1 + e / 6))
    wide = jet({(0, 2): arb(1, 0.5), (0, 3): arb(0, 100)})
    ball = ReducedFunction(arb(1), arb(0), at_foot, wide).at_centre(arb(1))
    for b in (F(1), F(3)):
        assert agree(ball, enclose(b / 2))


def problem_of(
    functions: Sequence[Function], radii: tuple[F, ...]
) -> tuple[Problem, PeriodTwoFamily, BifurcationFunction]:
    """The first function is P and the last P^2, of points (p_0, p_1)."""
    iterates = tuple((BoxFunction(table(function, radii)),) for function in functions)
    box = tuple(symmetric(radius) for radius in radii)
    problem = Problem(len(functions), radii, box, iterates, None)
    family = PeriodTwoFamily(ImplicitGraph(iterates[0], box, 1))
    return problem, family, BifurcationFunction(iterates[-1][0], ImplicitGraph((), box, 2))


def refused(check: Callable[[Checklist], Any]) -> str:
    with pytest.raises(NotEstablishedError) as caught:
        check(Checklist())
    return f"{caught.value.reason.condition}: {caught.value.reason.message}"


def test_derivatives_along_the_family_are_those_of_its_curve() -> None:
    _, family, _ = problem_of([lambda p, c: p[1] + p[0] * c(F(-1, 4)) + p[0] * p[0] * c(F(-1, 2))], (SMALL, SMALL))
    found = family.jet(family.over(arb(0)))
    assert is_near(found.slope, F(1, 4))
    assert is_near(found.curvature, F(1))


def test_the_slope_of_the_reduced_function_follows_the_family() -> None:
    """G = (p_1 - p_0/4) (2 p_0 + 3 p_1 + 4 p_0 p_1): dg/dp_0 is 2 + 4 p_1."""
    family: Function = lambda p, c: p[1] + p[0] * c(F(-1, 4))  # noqa: E731

    def product(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
        return family(p, c) * (p[0] * c(F(2)) + p[1] * c(F(3)) + p[0] * p[1] * c(F(4)))

    problem, curve, reduction = problem_of([family, product], (F(1, 64), F(1, 4)))
    reduced = reduced_function(*problem.box, curve, reduction)
    for p_1 in (F(-1, 4), F(0), F(1, 4)):
        assert reduced.slope.contains(enclose(2 + 4 * p_1))
    point = reduced_function(arb(0), arb(0), curve, reduction)
    assert is_near(point.slope, F(2))


@pytest.mark.parametrize("seed", range(4))
def test_the_slope_of_the_reduced_function_is_that_over_all_of_a_curved_family(seed: int) -> None:
    """G = (p_1 - s p_0 - t p_0^2) (u p_0 + v p_1 + t v p_0^2): dg/dp_0 is u + 2 t v p_0, and G_01 does not vary."""
    chance = random.Random(seed)
    s, t, u, v = (F(chance.choice((-1, 1)) * chance.randint(2, 9), 3) for _ in range(4))
    family: Function = lambda p, c: p[1] + p[0] * c(-s) + p[0] * p[0] * c(-t)  # noqa: E731

    def product(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
        return family(p, c) * (p[0] * c(u) + p[1] * c(v) + p[0] * p[0] * c(t * v))

    problem, curve, reduction = problem_of([family, product], (F(1, 64), F(1, 4)))
    reduced = reduced_function(*problem.box, curve, reduction)
    for p_0 in (F(-1, 64), F(0), F(1, 64)):
        assert reduced.slope.contains(enclose(u + 2 * t * v * p_0))
        # G_1 along the family is (u + s v) p_0 + 2 t v p_0^2.
        assert _crossing(problem.box[0], curve, reduction).contains(enclose(u + s * v + 4 * t * v * p_0))


def test_the_doubly_symmetric_family_has_p_1_zero() -> None:
    box = (symmetric(F(1)), symmetric(F(1)))
    component = BoxFunction(table(lambda p, c: p[1], (F(1), F(1))))
    family = DoublySymmetricFamily(BifurcationFunction(component, ImplicitGraph((), box, 2)))
    for p_0 in box[0], arb("0.5"):
        assert family.over(p_0)[1] == 0


def test_a_point_that_may_lie_on_the_edge_is_not_located() -> None:
    """G_1 = p_0 + e with e in [0.7, 1.1], over |p_0| <= 1; with e = 0.1 the point is found."""
    problem, family, _ = problem_of([lambda p, c: p[1], lambda p, c: p[0] * p[1]], (F(1), F(1)))
    graph = ImplicitGraph((), problem.box, 2)

    def located(e: arb) -> Any:
        old = problem.iterates[-1][0].table
        centre = old.centre | {(0, 1): e}
        component = BoxFunction(DerivativeTable(old.box | {(0, 1): e + arb(0, 1)}, centre))
        return lambda checklist: locate(checklist, problem, family, BifurcationFunction(component, graph))

    assert located(arb("0.1"))(Checklist()).where[0].contains(arb("-0.1"))
    assert ": p_0 in" in refused(located(arb(0.9, 0.2)))


def test_a_family_that_leaves_the_box_over_p_0_is_refused() -> None:
    problem, _, _ = problem_of([lambda p, c: p[1] + p[0] * c(F(-3))] * 2, (SMALL, SMALL))
    assert ": p_1 in" in refused(lambda checklist: check_family(checklist, problem))


def test_a_matrix_that_may_be_singular_is_named() -> None:
    problem, _, _ = problem_of([lambda p, c: p[1] * p[1]] * 2, (SMALL, SMALL))
    assert "pi_q P may be singular" in refused(lambda checklist: check_family(checklist, problem))
    box = tuple(symmetric(SMALL) for _ in range(3))
    parts = (lambda p, c: p[1], lambda p, c: p[2] * p[2])
    iterate = tuple(BoxFunction(table(part, (SMALL,) * 3)) for part in parts)
    planar = Problem(2, (SMALL,) * 3, box, (iterate, iterate), None)
    assert "pi_q2 P^k may be singular" in refused(lambda checklist: check_reduction(checklist, planar, None))


def test_a_family_that_leaves_p_2_is_refused() -> None:
    radii = (SMALL, SMALL, SMALL / 16)
    parts = (lambda p, c: p[1], lambda p, c: p[2] + c(-SMALL / 4))
    iterate = tuple(BoxFunction(table(part, radii)) for part in parts)
    problem = Problem(2, radii, tuple(map(symmetric, radii)), (iterate, iterate), None)
    assert ": p_2 in" in refused(lambda checklist: check_family(checklist, problem))


def test_a_matrix_that_is_singular_off_the_centre_is_no_regular_one() -> None:
    iterates, _ = tables_of_maps(CASES["k=4"][0], 4, WIDE)
    iterates[1] = [table(lambda p, c: p[1] + p[0] * p[1] * c(2 / WIDE[0]), WIDE)]
    failed(verdict(claim(description(1, False), "period_tupling", 4, WIDE), iterates, None), "regular-2")


def test_a_derivative_that_vanishes_off_the_centre_is_no_transversality() -> None:
    """G_1 = 1 + 2 p_0 along p_1 = 0, over |p_0| <= 1."""
    product: Function = lambda p, c: p[1] * (p[0] + p[0] * p[0])  # noqa: E731
    problem, family, reduction = problem_of([lambda p, c: p[1], product], (F(1), F(1)))
    assert "C4" in refused(lambda checklist: check_transversality(checklist, problem, family, reduction))


def test_a_reduced_function_without_a_slope_is_refused_for_it() -> None:
    for extra in (F(0), F(1)):
        product: Function = lambda p, c, e=extra: p[1] * (p[1] + p[0] * p[0] * c(e))  # type: ignore[misc]  # noqa: E731
        problem, family, reduction = problem_of([lambda p, c: p[1], product], (F(1), F(1)))
        message = refused(lambda checklist, a=(problem, family, reduction): check_reduced_function(checklist, *a))
        assert ": g_0 = " in message


def test_want_of_precision_is_no_reason_to_exclude_a_true_bifurcation() -> None:
    system, kind, k, radii = CASES["k=2"]
    tables, _ = tables_of_maps(system, k, radii)
    (old,) = tables[1]
    box = {index: ball + arb(0, 2**40) if sum(index) else ball for index, ball in old.box.items()}
    tables[1] = [DerivativeTable(box, old.centre)]
    outcome = failed(verdict(claim(description(1, False), kind, k, radii), tables, None), "C3")
    assert not outcome.reason.excluded


def test_a_fold_across_the_levels_is_not_excluded_by_a_regular_matrix() -> None:
    """On p_0 = p_1/4 the level p_0 - p_1/4 + p_1^2 has an extremum, and D_(p_1) pi_q P is regular."""
    radii = (SMALL, SMALL)
    curve = table(lambda p, c: p[0] + p[1] * c(F(-1, 4)), radii)
    level = table(lambda p, c: p[0] + p[1] * c(F(-1, 4)) + p[1] * p[1], radii)
    candidate = claim(description(1, True), "fold", 1, radii)
    proof(verdict(candidate, [[curve]], level))
    wide = {index: ball + arb(0, 2**40) if sum(index) > 1 else ball for index, ball in level.box.items()}
    outcome = failed(verdict(candidate, [[curve]], DerivativeTable(wide, level.centre)), "extremum")
    assert not outcome.reason.excluded


@pytest.mark.parametrize(
    "equation, words",
    [
        (lambda p, c: p[0] * p[0] + p[1] * p[1] * c(F(-1)), ": D_(p_0, p_2) pi_q P may be singular"),
        (lambda p, c: p[0] + p[1] * p[1] * p[1] * c(F(-1)), ": g'' = ["),
        (lambda p, c: p[0] + p[1] * p[1] * c(F(-1)) + p[1] * p[1] * p[1] * c(-1 / (2 * SMALL)), ": g'' = ["),
    ],
    ids=["two curves", "inflection at the centre", "inflection off the centre"],
)
def test_what_keeps_a_fold_from_being_shown_is_named(equation: Function, words: str) -> None:
    radii = (4 * SMALL**2, SMALL)
    assert words in refused(lambda checklist: check_fold(checklist, problem_of([equation], radii)[0]))


def test_a_zero_is_sought_in_the_box_only() -> None:
    """The ball of P_i is wider than P_i; what is known of the function holds on the latter."""
    radius = 1 + F(1, 2**40)
    problem = Problem(2, (radius,), (symmetric(radius),), (), None)
    beyond = 1 + F(1, 2**34)
    assert symmetric(radius).contains(enclose(beyond))

    def value(p: arb) -> arb:
        assert abs(p) <= enclose(radius)
        return p - enclose(beyond)

    narrowed_zero(problem, 0, value, lambda _: arb(1))


def test_the_slope_of_newtons_step_is_taken_over_all_that_may_hold_the_zero() -> None:
    problem = Problem(2, (F(2, 5),), (symmetric(F(2, 5)),), (), None)
    root = (arb("2.5").sqrt() - 1) / 2

    def slope(p: arb) -> arb:
        assert agree(p, root)
        assert p.rad() > 0
        return 1 + 2 * p

    found = narrowed_zero(problem, 0, lambda p: p * p + p - arb("0.375"), slope)
    assert agree(found, root)
    assert found.rad() < 1e-8


@pytest.mark.parametrize("ball", [arb(1), arb(1, 0.5), arb(0, 1), arb(0, 2), arb(-1), arb("nan"), arb(0, "inf")])
def test_what_reaches_the_edge_is_not_inside(ball: arb) -> None:
    problem = Problem(2, (F(1),), (symmetric(F(1)),), (), None)
    inside, reached = Evidence(""), Evidence("")
    require_inside(inside, "p_0", arb(0, 0.5), problem, 0)
    require_inside(reached, "p_0", ball, problem, 0)
    assert inside.holds
    assert not reached.holds


def test_the_reduced_function_is_the_quotient_by_the_distance_from_the_family() -> None:
    """G = (p_1 - 1/16) (p_0 + p_1^2), whose family is not at p_1 = 0."""
    radii = (F(1, 16), F(1, 8))
    family: Function = lambda p, c: p[1] + c(F(-1, 16))  # noqa: E731
    _, curve, reduction = problem_of([family, lambda p, c: family(p, c) * (p[0] + p[1] * p[1])], radii)
    for p_1 in (F(-1, 8), F(0), F(1, 10), F(1, 8)):
        reduced = reduced_function(arb(0), enclose(p_1).union(enclose(F(1, 16))), curve, reduction)
        assert agree(reduced.at_centre(enclose(p_1)), enclose(p_1**2))
        assert reduced.at_centre(enclose(p_1)).rad() < 1e-3


@pytest.mark.parametrize("name", ["em1", "em2"])
def test_the_images_of_a_box_hold_its_corners_where_levels_are_curved(name: str) -> None:
    candidate = known(name)
    form = level_form(candidate)
    assert form is not None
    wide = replace(candidate, radii=(F(1, 2**7),) * 3)
    integral = enclose_first_integral(wide, 200)
    assert integral is not None
    names = list(candidate.coordinates)
    kept = [i for i, coordinate in enumerate(names) if coordinate != candidate.system.level_coordinate]
    images = _images(form, wide, integral, kept)
    assert images is not None
    for signs in ((1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 1, 1), (-1, -1, -1), (-1, 1, -1)):
        p = [sign * radius for sign, radius in zip(signs, wide.radii, strict=True)]
        place = {
            coordinate: enclose(origin + sum((a * b for a, b in zip(row, p, strict=True)), F(0)))
            for coordinate, origin, row in zip(names, wide.centre, wide.frame, strict=True)
        }
        state = [place.get(coordinate, arb(0)) for coordinate in candidate.system.state]
        program = candidate.system.first_integral_program
        assert program is not None
        parameters = [enclose(candidate.parameters[key]) for key in candidate.system.parameters]
        (level,) = program.evaluate([*state, *parameters], enclose, lambda ball, q: ball ** enclose(q))
        there = coordinates_in_box(form, {**place, form.coordinates[0]: level})
        for image, ball in zip(images, there, strict=True):
            assert agree(image, ball)


def test_second_derivatives_anywhere_in_a_box_widen_its_image() -> None:
    candidate = known("em1")
    form, integral = level_form(candidate), enclose_first_integral(candidate, 200)
    assert form is not None
    assert integral is not None
    kept = [i for i, name in enumerate(candidate.coordinates) if name != candidate.system.level_coordinate]
    far = {index: ball + arb(0, 2**30) if sum(index) == 2 else ball for index, ball in integral.box.items()}
    near, wide = (_images(form, candidate, part, kept) for part in (integral, DerivativeTable(far, integral.centre)))
    assert near is not None
    assert wide is not None
    assert all(a.contains(b) for a, b in zip(wide, near, strict=True))
    assert wide[0].rad() > 2 * near[0].rad()
    assert wide[0].rad() > enclose(2**28 * candidate.radii[0] ** 2)


def test_the_level_coordinate_has_the_sign_that_it_has_at_the_centre() -> None:
    candidate = known("em1")
    place = candidate.coordinates.index("vy")
    signs = set()
    for factor in (F(1), F(-1)):
        centre = tuple(value * factor if i == place else value for i, value in enumerate(candidate.centre))
        form = level_form(replace(candidate, centre=centre))
        assert form is not None
        assert form.level_sign == (1 if centre[place] > 0 else -1)
        signs.add(form.level_sign)
    assert signs == {1, -1}


def test_a_point_on_the_edge_is_not_shown_to_lie_in_the_own_box() -> None:
    candidate = known("em1")
    form = level_form(candidate)
    assert form is not None

    def at(share: F) -> dict[str, arb]:
        step = [share * candidate.radii[0] * row[0] for row in candidate.frame]
        return {n: enclose(c + d) for n, c, d in zip(candidate.coordinates, candidate.centre, step, strict=True)}

    check_own_box(Checklist(), candidate, form, at(F(1, 2)))
    for share in (F(1), F(3)):
        with pytest.raises(NotEstablishedError) as caught:
            check_own_box(Checklist(), candidate, form, at(share))
        assert caught.value.reason.condition == "candidate-box"
        assert caught.value.reason.excluded == (share > 1)


def test_what_is_no_own_box_is_refused() -> None:
    candidate = known("em1")
    form, integral = level_form(candidate), enclose_first_integral(candidate, 200)
    assert form is not None
    assert integral is not None
    evidence = Evidence("")
    assert _is_own_box(evidence, candidate, form, 200, integral)
    smaller = replace(form, radii=tuple(radius / 2 for radius in form.radii))
    assert not _is_own_box(Evidence(""), candidate, smaller, 200, integral)
    # Boxes so wide that the sign is all that fails.
    wide = replace(candidate, radii=(F(1),) * 3)
    evidence = Evidence("")
    assert not _is_own_box(evidence, wide, replace(form, radii=(F(2**40),) * 3), 200, integral)
    assert evidence.failure == "vy may change its sign on it"
