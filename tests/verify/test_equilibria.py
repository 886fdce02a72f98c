"""Equilibria and Hopf points: enclosures contain closed forms, and what is false is not proved (section 36)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction as Q
from random import Random
from typing import Any

import pytest
from flint import acb, acb_series, arb, ctx
from support import equilibrium_cases as cases
from support.balls import agree
from support.periodic_cases import LORENZ

from orbitproof.shared.formats import Equilibrium, HopfPoint, define_system
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.equilibrium import proved_hopf
from orbitproof.verify.equilibrium.enclosures import enclose_equilibrium, enclose_hopf, pairs
from orbitproof.verify.equilibrium.equations import derivatives_of, equations_of
from orbitproof.verify.equilibrium.expansions import expand
from orbitproof.verify.equilibrium.proved_equilibrium import prove_equilibrium
from orbitproof.verify.equilibrium.spectrum import Spectrum, spectrum_of
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Proved, enclose, guarded
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.words.equilibrium import hopf_in_full

BITS = 200
FAST = Limits(digits=10, max_precision=256)


def reason_of(claim: Equilibrium | HopfPoint) -> str:
    """The condition that is not shown."""
    found = certify(claim, FAST)
    assert found.reason is not None
    return found.reason.condition


# Derivatives of the field


FORMULAS: dict[str, Callable[[acb_series], acb_series]] = {
    "sin(x)": acb_series.sin,
    "cos(x)": acb_series.cos,
    "exp(x)": acb_series.exp,
    "log(x)": acb_series.log,
    "x**3 - 2*x**2 + x - 5": lambda x: x**3 - 2 * x**2 + x - 5,
    "x**(1/2)": acb_series.sqrt,
    "x**(-5/2)": lambda x: 1 / acb_series.sqrt(x) ** 5,
    "(x - 1/3)/(x**2 + 1)": lambda x: (x - acb(1) / 3) / (x**2 + 1),
    "sin(exp(x)/x)": lambda x: (x.exp() / x).sin(),
}


@pytest.mark.parametrize("formula", FORMULAS)
def test_expansions_are_taylor_polynomials(formula: str) -> None:
    """Of x along complex directions, against the power series of FLINT; of two directions at once, their sum."""
    system = define_system({"name": "f", "state": "x y", "parameters": "b", "field": {"x": formula, "y": "b"}})
    source = Random(formula)
    with ctx.workprec(BITS):
        for _ in range(5):
            x = arb(source.randrange(1, 99)) / 32
            d, e, s, t = (acb(source.randrange(-9, 9), source.randrange(-9, 9)) / 8 for _ in range(4))
            along, _ = expand(system, [x, arb(0)], [arb(0)], [[d, acb(0)], [e, acb(0)]], 3)
            with_series = acb_series([acb(x), s * d + t * e], prec=4)
            right = FORMULAS[formula](with_series)
            for degree in range(4):
                value = sum((along[i, degree - i] * s**i * t ** (degree - i) for i in range(degree + 1)), acb(0))
                assert agree(value, right[degree]), degree
                assert abs(value - right[degree]) < arb(2) ** -150


def test_expansions_over_a_ball_enclose_those_at_its_points() -> None:
    system = define_system({"name": "f", "state": "x y", "field": {"x": "exp(x)*y/(1 + x**2)", "y": "x**(3/2)*cos(y)"}})
    with ctx.workprec(BITS):
        x, y = arb(1), arb(1) / 2
        units = [[arb(1), arb(0)], [arb(0), arb(1)]]
        wide = expand(system, [x + arb(0, 1) / 8, y + arb(0, 1) / 8], [], units, 3)
        for _ in range(20):
            source = Random(_)
            point = [value + arb(source.randrange(-64, 65)) / 512 for value in (x, y)]
            for inside, outside in zip(expand(system, point, [], units, 3), wide, strict=True):
                assert set(inside.coefficients) == set(outside.coefficients)
                assert all(outside[index].contains(value) for index, value in inside.coefficients.items())


@pytest.mark.parametrize("formula", ["log(x)", "x**(1/2)", "1/x", "0/x", "log(x)*0", "x**(-1/2)"])
def test_where_the_field_is_not_defined_nothing_is_finite(formula: str) -> None:
    system = define_system({"name": "f", "state": "x y", "field": {"x": f"x + {formula}", "y": "y"}})
    found, _ = expand(system, [arb(0, 1), arb(0)], [], [[arb(1), arb(0)]], 2)
    assert not all(value.is_finite() for value in found.coefficients.values())
    claim = Equilibrium("e", system, {}, (Q(0), Q(0)), (Q(1), Q(1)))
    assert reason_of(claim) == "field"


# Equilibria


def test_the_equilibria_of_a_ring_have_their_eigenvalues() -> None:
    found = certify(cases.equilibrium(radii=(Q(1, 2**90),) * 3)).results
    assert [found.point[name].contains(value) for name, value in (("x", 2), ("y", 1), ("z", 1))] == [True] * 3
    with ctx.workprec(BITS):
        root = acb(0, arb(7).sqrt())
        for value in (acb(-2), (-3 + root) / 2, (-3 - root) / 2):
            assert sum(each.contains(value) for each in found.eigenvalues.values) == 1
    assert (found.eigenvalues.left, found.eigenvalues.right, found.eigenvalues.undecided) == (3, 0, 0)
    assert found.eigenvalues.is_stable


def test_an_equilibrium_of_a_field_with_functions() -> None:
    found = certify(cases.equilibrium_with_functions()).results
    with ctx.workprec(BITS):
        assert found.point["x"].contains(arb.pi() / 6)
        root = acb(0, (4 * (arb.pi() / 6).cos() - 1).sqrt())
        assert all(any(each.contains((-1 + sign * root) / 2) for each in found.eigenvalues.values) for sign in (1, -1))


FALSE = {
    "none, far away": ("x**2 + y**2 + 1", "y", Q(1, 4), "equilibrium"),
    "none, near by": ("x**2 + 1/10000", "y", Q(1, 16), "equilibrium"),
    "two": ("x**2 - 1/10000", "y", Q(1, 16), "equilibrium"),
    "one that is double": ("x**2", "y", Q(1, 16), "equilibrium"),
    "a line": ("x - y", "2*x - 2*y", Q(1, 16), "equilibrium"),
    "at the edge": ("x - 1/16", "y", Q(1, 16), "equilibrium"),
    "beside": ("x - 1/8", "y", Q(1, 16), "equilibrium"),
}


@pytest.mark.parametrize("name", FALSE)
def test_false_claims_about_equilibria_are_not_proved(name: str) -> None:
    first, second, radius, condition = FALSE[name]
    system = define_system({"name": "f", "state": "x y", "field": {"x": first, "y": second}})
    claim = Equilibrium("e", system, {}, (Q(0), Q(0)), (radius, radius))
    assert reason_of(claim) == condition


@pytest.mark.parametrize(("place", "is_excluded"), [("1/16", False), ("1/8", True), ("-1/8", True)])
def test_a_zero_at_the_edge_is_not_excluded(place: str, is_excluded: bool) -> None:
    system = define_system({"name": "f", "state": "x y", "field": {"x": f"x - ({place})", "y": "y"}})
    claim = Equilibrium("e", system, {}, (Q(0), Q(0)), (Q(1, 16),) * 2)
    known = enclose_equilibrium(claim, IntegratorSettings(BITS))
    with guarded(BITS):
        outcome = prove_equilibrium(claim, Checklist(), known)
    assert isinstance(outcome, NotProved)
    assert outcome.reason.excluded is is_excluded
    assert outcome.reason.needs_precision is not is_excluded
    near = replace(claim, centre=(Q(place) - Q(3, 64), Q(0)))
    with guarded(BITS):
        outcome = prove_equilibrium(near, Checklist(), enclose_equilibrium(near, IntegratorSettings(BITS)))
    assert isinstance(outcome, Proved)
    assert outcome.results.point["x"].contains(enclose(Q(place)))


def test_which_eigenvalues_are_where_is_said_as_far_as_it_is_certain() -> None:
    """A centre and a focus that hardly repels: of the box nothing is decided, of a small one more."""
    system = define_system(
        {"name": "f", "state": "x y", "parameters": "e", "field": {"x": "e*x - y + x**2", "y": "x + e*y"}}
    )
    counts = {}
    for e, radius in ((Q(0), Q(1, 2**60)), (Q(1, 2**20), Q(1, 2**60)), (Q(1, 2**20), Q(1, 2**10))):
        found = certify(Equilibrium("e", system, {"e": e}, (Q(0), Q(0)), (radius,) * 2), FAST).results.eigenvalues
        counts[e, radius] = (found.left, found.right, found.undecided)
    assert [*counts.values()] == [(0, 0, 2), (0, 2, 0), (0, 0, 2)]


@pytest.mark.parametrize(("e", "said"), [(Q(0), ""), (Q(1, 4), "unstable"), (Q(-1, 4), "asymptotically stable")])
def test_stability_is_said_where_it_is_decided(e: Q, said: str) -> None:
    system = define_system(
        {"name": "f", "state": "x y", "parameters": "e", "field": {"x": "e*x - y + x**2", "y": "x + e*y"}}
    )
    found = certify(Equilibrium("e", system, {"e": e}, (Q(0), Q(0)), (Q(1, 2**60),) * 2), FAST)
    text = found.to_json()["statement"]["in_full"]
    assert text.endswith(
        f"The equilibrium is {said}." if said else "Which sign the real part of 2 of them has is not decided."
    )


# Hopf points


@pytest.mark.parametrize(("seed", "size", "functions"), [(1, 2, False), (2, 3, False), (3, 4, False), (4, 3, True)])
def test_hopf_points_in_other_coordinates_are_those_of_the_normal_form(seed: int, size: int, functions: bool) -> None:
    for more in range(2):
        known = cases.at_random(100 * more + seed, size, functions)
        found = certify(known.claim, FAST).results
        for ball, value in (
            (found.frequency, known.omega), (found.speed, known.speed), (found.lyapunov, known.lyapunov),
        ):  # fmt: skip
            assert ball.contains(enclose(value).mid()) or agree(ball, enclose(value))
            assert ball.rad() < arb(2) ** -30
        assert len(found.eigenvalues.values) == size - 2
        for value in known.others:
            assert sum(agree(each, acb(enclose(value))) for each in found.eigenvalues.values) == 1
        assert found.side == ("above" if known.speed * known.lyapunov < 0 else "below")
        assert found.criticality == ("supercritical" if known.lyapunov < 0 else "subcritical")
        assert found.is_attracting == (known.lyapunov < 0 and all(value < 0 for value in known.others))
        assert (found.eigenvalues.left, found.eigenvalues.right) == (
            sum(value < 0 for value in known.others), sum(value > 0 for value in known.others),
        )  # fmt: skip


@pytest.mark.parametrize("slaved", [False, True])
def test_the_coefficient_of_any_field_is_that_of_the_formula_for_the_plane(slaved: bool) -> None:
    for seed in range(5):
        known = cases.of_any_field(seed, slaved)
        found = certify(known.claim, FAST)
        assert found.proved, found.reason
        assert agree(found.results.lyapunov, enclose(known.lyapunov))
        assert found.results.lyapunov.rad() < arb(2) ** -30
        assert agree(found.results.speed, enclose(known.speed))
        assert all(
            agree(each, acb(enclose(k))) for each, k in zip(found.results.eigenvalues.values, known.others, strict=True)
        )


WIDE = define_system(
    {
        "name": "wide", "state": "x y z", "parameters": "a b",
        "field": {"x": "a*x*y + exp(z)*b", "y": "sin(x*y) - a**2*z**3", "z": "x*y*z/(2 + a) + y**3 - x**2*z"},
    }
)  # fmt: skip


@pytest.mark.parametrize("wide", ["x", "a", "q", "all"])
def test_enclosures_over_a_wide_box_hold_what_is_so_at_its_points(wide: str) -> None:
    """At exact points (x, a, q) of the box the derivatives are enclosed once more, without a box."""
    source, tiny, size = Random(wide), Q(1, 2**60), Q(1, 16)
    widths = {each: size if wide in (each, "all") else tiny for each in "xaq"}
    middle, value = (Q(1, 2), Q(-3, 4), Q(5, 8)), Q(7, 8)
    kernel = ((Q(1), Q(1, 2), Q(-1)), (Q(0), Q(-3, 4), Q(1, 4)))
    claim = HopfPoint(
        "wide", WIDE, {"a": value, "b": Q(1, 3)}, "a", widths["a"], middle, (widths["x"],) * 3, Q(1), tiny, kernel,
        widths["q"],
    )  # fmt: skip
    found = enclose_hopf(claim, IntegratorSettings(BITS))
    at_rest = enclose_equilibrium(
        Equilibrium("wide", WIDE, claim.parameters, middle, claim.radii), IntegratorSettings(BITS)
    )
    with guarded(BITS + 64):

        def inside(centre: Q, width: Q) -> arb:
            return enclose(centre + width * Q(source.randrange(-64, 65), 64))

        for _ in range(25):
            x = [inside(each, widths["x"]) for each in middle]
            a = [inside(value, widths["a"]), enclose(Q(1, 3))]
            q = [acb(inside(u, widths["q"]), inside(v, widths["q"])) for u, v in zip(*kernel, strict=True)]
            units = [[arb(int(i == place)) for i in range(5)] for place in range(4)]
            second = expand(WIDE, x, a, units, 2)
            third = expand(WIDE, x, a, [q, [each.conjugate() for each in q]], 3)
            for i in range(3):
                assert all(ball.contains(second[i].slope(j)) for j, ball in enumerate(found.field[i].slopes))
                assert all(
                    ball.contains(second[i].second(j, k))
                    for (j, k), ball in zip(pairs(3), found.second[i], strict=True)
                )
                assert found.third[i].contains(2 * third[i][2, 1])
            slopes = expand(WIDE, x, [enclose(value), a[1]], units[:3], 1)
            for i in range(3):
                assert all(ball.contains(slopes[i].slope(j)) for j, ball in enumerate(at_rest.field[i].slopes))
        centre = expand(WIDE, [enclose(each) for each in middle], [enclose(value), a[1]], units[:3], 1)
        for i in range(3):
            assert agree(found.field[i].centre, centre[i].value)
            assert agree(at_rest.field[i].centre, centre[i].value)
            assert all(agree(ball, centre[i].slope(j)) for j, ball in enumerate(found.linear[i]))


def test_a_point_beside_the_centre_is_known_better_than_its_box(monkeypatch: pytest.MonkeyPatch) -> None:
    """The box of half-width 2^-70 is about another centre."""
    known = cases.in_other_coordinates(
        ((1, 1, 0), (0, 1, -1), (1, 0, 2)), [("squares", Q(1)), ("products", Q(1, 2))],
        {"w": Q(3, 2), "d": Q(1, 2), "c": Q(-3, 4), "e": Q(1, 3)}, (Q(-1, 3),),
    )  # fmt: skip
    claim, step = known.claim, Q(1, 2**73)
    beside_it = replace(
        claim,
        centre=tuple(value + step for value in claim.centre),
        parameters={**claim.parameters, "a": -step},
        frequency=claim.frequency + step,
    )
    places: list[Any] = []
    check = proved_hopf._check_others
    monkeypatch.setattr(
        proved_hopf, "_check_others", lambda checklist, place: places.append(place) or check(checklist, place)
    )
    found = certify(beside_it, FAST).results
    for value, u, v in zip(places[-1].q, *claim.kernel, strict=True):
        assert value.real.contains(arb(int(u)))
        assert value.imag.contains(arb(int(v)))
    with ctx.workprec(BITS):
        for ball, value in ((found.parameter, Q(0)), (found.frequency, Q(3, 2)), (found.point["s0"], claim.centre[0])):
            assert agree(ball, enclose(value) + arb(0, 1) / 2**118)
            assert ball.rad() < arb(2) ** -90
        assert agree(found.period * found.frequency, 2 * arb.pi())


def test_a_single_eigenvalue_that_may_be_on_the_axis_is_refused() -> None:
    q = [acb(1), acb(0, -1), acb(0)]
    for width, is_known in ((0, True), (2, False)):
        matrix = [[arb(0), arb(-1), arb(0)], [arb(1), arb(0), arb(0)], [arb(0), arb(0), arb(-1, width)]]
        place = proved_hopf._ImaginaryPair(arb(1), q, proved_hopf.Derivatives(matrix, [], [], []))
        checklist = Checklist()
        if is_known:
            assert proved_hopf._check_others(checklist, place).left == 1
        else:
            with pytest.raises(NotEstablishedError, match="may have real part 0"):
                proved_hopf._check_others(checklist, place)


def test_eigenvalues_that_are_not_found_are_undecided() -> None:
    for ball in (arb("nan"), arb(0, 1)):
        found = spectrum_of([[ball] * 3] * 3)
        assert (found.left, found.right, found.undecided) == (0, 0, 3)
        assert not found.is_stable
        assert not found.is_hyperbolic
    assert not Spectrum((), 2, 0, 1).is_stable
    assert not Spectrum((), 2, 1, 0).is_stable
    assert Spectrum((), 2, 0, 0).is_stable


def test_the_derivative_of_the_equations_is_that_at_all_points_of_the_box() -> None:
    """A wide box holds the matrices of narrow ones about its points; those of the normalisation are the claim's."""
    source, size, tiny = Random(5), Q(1, 16), Q(1, 2**70)
    kernel = ((Q(1), Q(1, 2), Q(-1)), (Q(0), Q(-3, 4), Q(1, 4)))

    def around(x: Sequence[Q], a: Q, omega: Q, rows: Sequence[Sequence[Q]], width: Q) -> list[list[arb]]:
        claim = HopfPoint(
            "wide", WIDE, {"a": a, "b": Q(1, 3)}, "a", width, tuple(x), (width,) * 3, omega, width,
            tuple(map(tuple, rows)), width,
        )  # fmt: skip
        return equations_of(claim, enclose_hopf(claim, IntegratorSettings(BITS)))[0]

    def moved(values: Sequence[Q]) -> list[Q]:
        return [value + size * Q(source.randrange(-64, 65), 64) for value in values]

    middle = (Q(1, 2), Q(-3, 4), Q(5, 8))
    with guarded(BITS):
        wide = around(middle, Q(7, 8), Q(1), kernel, size)
        for _ in range(12):
            (a,), (omega,) = moved([Q(7, 8)]), moved([Q(1)])
            narrow = around(moved(middle), a, omega, list(map(moved, kernel)), tiny)
            for row, inside in zip(wide[:9], narrow[:9], strict=True):
                assert all(ball.contains(value.mid()) for ball, value in zip(row, inside, strict=True))


def test_a_box_with_a_second_hopf_point_is_refused() -> None:
    """The real part of the pair is a^2 - 2^-8: it is 0 at a = 1/16 and at -1/16."""
    field = {**PAIR, "x": PAIR["x"].replace("d*a", "(a**2 - 1/256)"), "y": PAIR["y"].replace("d*a", "(a**2 - 1/256)")}
    system = define_system({"name": "two", "state": "x y u v", "parameters": "a c k h", "field": field})
    numbers = {"a": Q(1, 16), "c": Q(-1), "k": Q(-1), "h": Q(0)}
    assert certify(beside(system=system, parameters=numbers), FAST).proved
    for radius, middle in ((Q(1, 8), Q(1, 16)), (Q(1, 8), Q(0)), (Q(9, 128), Q(0))):
        wide = beside(system=system, parameters={**numbers, "a": middle}, parameter_radius=radius)
        assert reason_of(wide) == "imaginary-pair"


PAIR = {
    "x": "(d*a + c*(x**2 + y**2))*x - y", "y": "x + (d*a + c*(x**2 + y**2))*y",
    "u": "k*u - h*v + x**2", "v": "h*u + k*v",
}  # fmt: skip
"""A pair +- i with speed d and coefficient 2 c beside k +- i h."""


def beside(d: Q = Q(1), c: Q = Q(-1), k: Q = Q(-1), h: Q = Q(0), **changes: Any) -> HopfPoint:
    system = define_system({"name": "beside", "state": "x y u v", "parameters": "a c d k h", "field": PAIR})
    radius, zero = Q(1, 2**70), (Q(0),) * 4
    kernel = ((Q(1), Q(0), Q(0), Q(0)), (Q(0), Q(-1), Q(0), Q(0)))
    numbers = {"a": Q(0), "c": c, "d": d, "k": k, "h": h}
    claim = HopfPoint("h", system, numbers, "a", radius, zero, (radius,) * 4, Q(1), radius, kernel, radius)
    return replace(claim, **changes)


def test_a_pair_beside_another_one() -> None:
    for k, attracting in ((Q(-1), True), (Q(-1, 2**40), True), (Q(1), False)):
        for h in (Q(1), Q(2), Q(1, 2)):
            found = certify(beside(k=k, h=h), FAST).results
            assert found.is_attracting is attracting
            assert found.lyapunov.contains(-2)


FALSE_HOPF: dict[str, tuple[HopfPoint, str]] = {
    "zero speed": (beside(d=Q(0)), "imaginary-pair"),
    "zero coefficient": (beside(c=Q(0)), "lyapunov"),
    "an eigenvalue 0": (beside(k=Q(0)), "imaginary-pair"),
    "the same pair twice": (beside(k=Q(0), h=Q(1)), "imaginary-pair"),
    "a pair +- 2i": (beside(k=Q(0), h=Q(2)), "others"),
    "a pair +- 3i": (beside(k=Q(0), h=Q(3)), "others"),
    "a pair +- i/2": (beside(k=Q(0), h=Q(1, 2)), "others"),
    "another frequency": (beside(frequency=Q(2)), "imaginary-pair"),
    "another vector": (beside(kernel=((Q(1), Q(1), Q(0), Q(0)), (Q(0), Q(-1), Q(0), Q(0)))), "imaginary-pair"),
    "the conjugate vector": (beside(kernel=((Q(1), Q(0), Q(0), Q(0)), (Q(0), Q(1), Q(0), Q(0)))), "imaginary-pair"),
    "another parameter": (beside(parameters={**beside().parameters, "a": Q(1, 8)}), "imaginary-pair"),
    "a parameter that plays no part": (beside(parameter="h", parameter_radius=Q(1, 2**70)), "imaginary-pair"),
    "elsewhere": (beside(centre=(Q(1, 4), Q(0), Q(0), Q(0))), "imaginary-pair"),
    "a wide box": (beside(radii=(Q(2),) * 4), "imaginary-pair"),
}


@pytest.mark.parametrize("name", FALSE_HOPF)
def test_false_claims_about_hopf_points_are_not_proved(name: str) -> None:
    claim, condition = FALSE_HOPF[name]
    assert reason_of(claim) == condition


def test_a_speed_of_zero_is_seen_where_the_point_is_regular() -> None:
    """The real part of the pair is a^2: the value 0 of the parameter is double, and no box around it is proved."""
    field = {**PAIR, "x": PAIR["x"].replace("d*a", "d*a**2"), "y": PAIR["y"].replace("d*a", "d*a**2")}
    system = define_system({"name": "touching", "state": "x y u v", "parameters": "a c d k h", "field": field})
    assert reason_of(beside(system=system)) == "imaginary-pair"


def rounded(ball: arb) -> Q:
    with ctx.workprec(400):
        mantissa, exponent = ball.mid().man_exp()
        return Q(round(Q(int(mantissa)) * Q(2) ** (int(exponent) + 160)), 2**160)


def of_lorenz() -> HopfPoint:
    """At rho = 470/19: omega^2 = beta (sigma + rho), in the plane of (x, y, z) with sigma y = (sigma + i omega) x."""
    with ctx.workprec(400):
        rho, beta = arb(470) / 19, arb(8) / 3
        x, omega = (beta * (rho - 1)).sqrt(), (beta * (10 + rho)).sqrt()
        first = acb(1, 0)
        second = acb(10, omega) / 10
        third = x * (first + second) / acb(beta, omega)
        kernel = tuple(
            tuple(map(rounded, (value.real if part else value.imag for value in (first, second, third))))
            for part in (True, False)
        )
        radius = Q(1, 2**80)
        return HopfPoint(
            "lorenz", LORENZ, {"sigma": Q(10), "rho": rounded(rho), "beta": Q(8, 3)}, "rho", radius,
            (rounded(x), rounded(x), rounded(rho - 1)), (radius,) * 3, rounded(omega), radius, kernel, radius,
        )  # fmt: skip


def test_orbits_of_the_lorenz_system_are_born_below_and_repel() -> None:
    found = certify(of_lorenz()).results
    assert agree(found.parameter, enclose(Q(470, 19)))
    assert (found.side, found.criticality, found.is_attracting) == ("below", "subcritical", False)
    # The trace is that of the matrix.
    assert agree(found.eigenvalues.values[0].real, -arb(41) / 3)


def test_the_other_eigenvalues_are_those_beside_every_vector_of_the_box() -> None:
    """q = (1, -i, 0) is off the middle of its balls."""
    rows = [[0, -1, 3], [1, 0, -2], [0, 0, 5]]
    q = [
        acb(arb("1.125", "0.25"), arb("0.125", "0.25")),
        acb(arb(0), arb(-1)),
        acb(arb("0.125", "0.25"), arb(0, "0.1")),
    ]
    ((found,),) = proved_hopf.beside_pair([[arb(entry) for entry in row] for row in rows], q)
    assert found.contains(5)
    assert found.is_finite()


def test_a_speed_or_a_coefficient_that_may_be_0_is_none() -> None:
    """Of a field without second derivatives, and without third ones."""
    claim = cases.hopf()
    with guarded(BITS):
        known = derivatives_of(enclose_hopf(claim, IntegratorSettings(precision=BITS)))
        straight = [{places: arb(0) for places in row} for row in known.second]
        plain = replace(known, second=straight, third=[acb(0)] * 3)
        vector = [acb(enclose(u), enclose(v)) for u, v in zip(*claim.kernel, strict=True)]
        at = [proved_hopf._ImaginaryPair(enclose(claim.frequency), vector, each) for each in (known, plain)]
        left, _ = proved_hopf._check_crossing(Checklist(), claim, at[0])
        with pytest.raises(NotEstablishedError, match="it may be 0"):
            proved_hopf._check_crossing(Checklist(), claim, at[1])
        with pytest.raises(NotEstablishedError, match="it may be 0"):
            proved_hopf._check_lyapunov(Checklist(), at[1], left)


def test_an_undecided_eigenvalue_beside_a_decided_one_is_refused() -> None:
    field = {"x": "a*x - y - x**3", "y": "x + a*y", "u": "-2*v", "v": "2*u", "w": "-w"}
    system = define_system({"name": "pairs", "state": "x y u v w", "parameters": "a", "field": field})
    kernel, small = ((Q(1), *[Q(0)] * 4), (Q(0), Q(-1), *[Q(0)] * 3)), cases.RADIUS
    claim = HopfPoint(
        "pairs", system, {"a": Q(0)}, "a", small, (Q(0),) * 5, (small,) * 5, Q(1), small, kernel, small
    )  # fmt: skip
    assert reason_of(claim) == "others"


@pytest.mark.parametrize(
    ("c", "other", "stability"),
    [(Q(-1), Q(-1, 3), "asymptotically stable"), (Q(-1), Q(1, 3), "unstable"), (Q(1), Q(-1, 3), "unstable")],
)
def test_orbits_attract_if_the_coefficient_and_all_other_eigenvalues_are_negative(
    c: Q, other: Q, stability: str
) -> None:
    numbers = {"w": Q(2), "d": Q(1, 2), "c": c, "e": Q(1, 3)}
    bends = [("squares", Q(1)), ("products", Q(1, 2))]
    claim = cases.in_other_coordinates(((1, 1, 0), (0, 1, -1), (1, 0, 2)), bends, numbers, (other,)).claim
    found = certify(claim, FAST)
    text, side = found.to_json()["statement"]["in_full"], "above" if c < 0 else "below"
    assert text.rpartition(". ")[2].startswith(f"They are {stability}")
    assert (
        f"are there for values of a {side} that of the point, not for values {'below' if c < 0 else 'above'} it" in text
    )
    assert found.side == side


def test_all_results_hold_what_is_so_at_a_point_beside_the_centre_of_a_wide_box() -> None:
    """Of an equilibrium with w + w^2 = a that moves with a: at a = 2 the pair is +- i, and the third eigenvalue -3."""
    field = {"x": "r*x - y", "y": "x + r*y", "w": "a - w - w**2"}
    where = {"r": "w + a - 3 - x**2 - y**2"}
    system = define_system({"name": "moving", "state": "x y w", "parameters": "a", "where": where, "field": field})
    middle, radii = (Q(1, 10000), Q(-1, 5000), 1 - Q(1, 8000)), (Q(1, 1000),) * 3
    kernel = ((Q(1), Q(0), Q(0)), (Q(0), Q(-1), Q(0)))
    claim = HopfPoint(
        "m", system, {"a": 2 + Q(1, 8000)}, "a", Q(1, 1000), middle, radii, 1 + Q(1, 10000), Q(1, 500), kernel,
        Q(1, 250),
    )  # fmt: skip

    def prove(each: HopfPoint) -> Any:
        with guarded(BITS):
            return proved_hopf.prove_hopf(each, Checklist(), enclose_hopf(each, IntegratorSettings(BITS)))

    found = prove(claim).results
    for ball, value in (
        (found.point["x"], Q(0)), (found.point["y"], Q(0)), (found.point["w"], Q(1)), (found.parameter, Q(2)),
        (found.frequency, Q(1)), (found.speed, Q(4, 3)), (found.lyapunov, Q(-2)), (found.period / (2 * arb.pi()), Q(1)),
        (found.eigenvalues.values[0].real, Q(-3)),
    ):  # fmt: skip
        assert ball.contains(enclose(value))
        assert 0 < ball.rad() < 0.1
    # w moves by 1/(1 + 2 w): from 1/4 to 1/2, where that is 3 up to 1.
    second = [{places: arb(int(i < 2 and places in ((i, 2), (i, 3)))) for places in pairs(3)} for i in range(3)]
    matrix = [[arb(0), arb(-1), arb(0)], [arb(1), arb(0), arb(0)], [arb(0), arb(0), arb(-3, 1)]]
    known = proved_hopf.Derivatives(matrix, [arb(0), arb(0), arb(1)], second, [acb(0)] * 3)
    place = proved_hopf._ImaginaryPair(arb(1), [acb(1), acb(0, -1), acb(0)], known)
    _, speed = proved_hopf._check_crossing(Checklist(), claim, place)
    assert speed.contains(1.25)
    assert speed.contains(1.5)
    # l has the third component 3 b/20 + .., where b is 1 up to 1.
    second[2][0, 3], matrix[0][2], matrix[2][2] = arb(1), arb(1, 1), arb(-3)
    known = replace(known, matrix=matrix, second=second)
    _, speed = proved_hopf._check_crossing(Checklist(), claim, replace(place, known=known))
    assert all(speed.contains(enclose(Q(4, 3) + Q(3 * b, 20))) for b in (0, 1, 2))
    # |q|^2 is 9/4 up to 1.
    straight = replace(known, second=[{places: arb(0) for places in pairs(3)}] * 3, third=[acb(-2), acb(0), acb(0)])
    wide = replace(place, q=[acb(arb(1, 0.5)), *place.q[1:]], known=straight)
    lyapunov = proved_hopf._check_lyapunov(Checklist(), wide, [acb(1), acb(0), acb(0)])
    assert all(lyapunov.contains(enclose(-1 / (1 + Q(n, 4) ** 2))) for n in (2, 4, 6))
    # 2 i omega - A is known as well as omega and A are.
    second = [{places: arb(places == {0: (1, 2), 2: (0, 0)}.get(i)) for places in pairs(3)} for i in range(3)]

    def coefficient(eigenvalue: arb, omega: arb) -> arb:
        straight = [[arb(0), -omega, arb(0)], [omega, arb(0), arb(0)], [arb(0), arb(0), eigenvalue]]
        bent = proved_hopf.Derivatives(straight, known.rate, second, [acb(-2), acb(0), acb(0)])
        pair = proved_hopf._ImaginaryPair(omega, place.q, bent)
        return proved_hopf._check_lyapunov(Checklist(), pair, [acb(1), acb(0), acb(0)])

    for wide, values in (
        (coefficient(arb(-3, 1), arb(1)), [coefficient(arb(-n), arb(1)) for n in (2, 3, 4)]),
        (coefficient(arb(-3), arb(1, 0.25)), [coefficient(arb(-3), arb(n) / 4) for n in (3, 4, 5)]),
    ):
        assert all(wide.contains(value) for value in values)
    # Each interval is told with its own half-width.
    said = " ".join(hopf_in_full(claim, "", found))
    for words in ("a lies in [1.9991, 2.0012]", "omega lies in [0.9980, 1.0022]", "kernel_radius = 0.004 of"):
        assert words in said
    # The eigenvector has a third component that differs from that of k by as much.
    for side, holds in ((Q(1, 500), True), (Q(3, 500), False)):
        assert isinstance(prove(replace(claim, kernel=((*kernel[0][:2], side), kernel[1]))), NotProved) is not holds


def test_parameter_and_frequency_lie_each_in_an_interval_of_its_own() -> None:
    claim, off, narrow = cases.hopf(), Q(1, 2**80), Q(1, 2**90)
    moved = {**claim.parameters, "a": off}
    assert reason_of(replace(claim, frequency=claim.frequency + off, frequency_radius=narrow)) == "imaginary-pair"
    assert reason_of(replace(claim, parameters=moved, parameter_radius=narrow)) == "imaginary-pair"
    for true in (
        replace(claim, frequency=claim.frequency + off, parameter_radius=narrow),
        replace(claim, parameters=moved, frequency_radius=narrow),
    ):
        assert certify(true, FAST).reason is None
