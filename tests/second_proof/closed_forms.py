"""More properties of the second proof: power series, discs, remainders, crossings and whole proofs by closed forms."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from fractions import Fraction
from types import ModuleType
from typing import Any

import pytest
from exact_series import Series, variable
from flint import acb, arb
from property_checks import SQUARE, Check, claim, contains, jet, module, orders, rational, system
from support.balls import agree

F = Fraction
TINY = arb("1e-20")


def jets_of(package: ModuleType, series: Series) -> Any:
    return jet(package, {a: rational(c) for a, c in series.items()})


def matches(found: Mapping[Any, arb], exact: Series, where: str, width: arb = TINY) -> None:
    """Every coefficient contains the exact one and is narrow; those that are absent on either side are zero."""
    for a in {*found, *exact}:
        value = found.get(a, arb(0))
        assert agree(value, rational(exact.get(a, F(0)))), f"{where}: {a}"
        assert value.rad() < width, f"{where}: {a} is wide"


def jets_are_exact_power_series(package: ModuleType) -> None:
    """Every operation on jets against the same on exact rational power series in three variables."""
    rng = random.Random(4)
    for _ in range(3):
        x, y, z = (Series.random(rng, 3, 3) for _ in range(3))
        x[()], y[()] = F(3, 2), F(-5, 4)
        square = x * x
        with module(package, "jets").precision(160):
            a, b, c, s = (jets_of(package, series) for series in (x, y, z, square))
            for name, found, exact in (
                ("sum", a + b, x + y),
                ("difference", a - b, x - y),
                ("product", a * c, x * z),
                ("square", a * a, square),
                ("factor", a * 3, x * Series.constant(F(3), 3)),
                ("quotient", c / b, z * y.inverse()),
                ("power 0", b ** F(0), Series.constant(F(1), 3)),
                ("power 2", b ** F(2), y * y),
                ("power 3", c ** F(3), z * z * z),
                ("power -1", b ** F(-1), y.inverse()),
                ("power -2", b ** F(-2), (y * y).inverse()),
                ("power 1/2", s ** F(1, 2), x),
                ("power 3/2", s ** F(3, 2), square * x),
                ("power -1/2", s ** F(-1, 2), x.inverse()),
                ("power -3/2", s ** F(-3, 2), (square * x).inverse()),
                ("sum of absent terms", a + jet(package, {(0, 2): arb(1)}), x + variable(0, 3) * variable(2, 3)),
                ("combination", module(package, "jets").combine([a, b], [arb(2), arb(-3)], 3), x * 2 - y * 3),
            ):
                matches(found, exact, name)


def jets_hold_over_boxes(package: ModuleType) -> None:
    """A jet over a ball contains the exact one at its ends."""
    with module(package, "jets").precision(128):
        wide = jet(package, {(): arb(1.5, 0.25), (0,): arb(1)})
        for exponent in (F(2), F(-1), F(1, 2), F(-3, 2)):
            found = wide**exponent
            for end in (F(5, 4), F(3, 2), F(7, 4)):
                factor = value = F(1)
                for j in range(4):
                    power = rational(end) ** rational(exponent - j)
                    contains(found, {(0,) * j: rational(factor) * power}, f"{exponent} at {end}")
                    factor = factor * (exponent - j) / (j + 1)
                assert value == 1


def substitution_is_composition(package: ModuleType) -> None:
    """f(u(v), v_2) with u without constant, exactly."""
    rng = random.Random(5)
    f = Series.random(rng, 3, 3)
    inner = {j: Series.random(rng, 3, 3).without_constant() for j in (0, 1)}
    exact = f.composed({**inner, 2: variable(2, 3)})
    with module(package, "jets").precision(160):
        given = {j: jets_of(package, series) for j, series in inner.items()}
        matches(module(package, "jets").substitute([jets_of(package, f)], given)[0], exact, "composition")


def implicit_functions_of_two_unknowns(package: ModuleType) -> None:
    """E(v, u) = M (u - U(v)) + (u_2 - U_2)(u_3 - U_3) vanishes for u = U(v); constants of E are not used."""
    rng = random.Random(6)
    exact = {j: Series.random(rng, 2, 3).without_constant() for j in (2, 3)}
    first, second = (variable(j, 3) - exact[j] for j in (2, 3))
    equations = [first * 3 + second + first * second, first * F(-1, 2) + second * 2 + first * second * 5]
    with module(package, "jets").precision(160):
        given = [jets_of(package, e + Series.constant(F(1, 8), 3)) for e in equations]
        found = module(package, "jets").implicit(given, [2, 3])
        for j, series in exact.items():
            matches(found[j], series, f"u_{j}")


def precision_is_restored(package: ModuleType) -> None:
    """Also after an exception; and rationals are enclosed, not rounded."""
    from flint import ctx

    jets, before = module(package, "jets"), (ctx.prec, ctx.cap)
    with suppress(KeyError), jets.precision(77):
        assert ctx.prec == 77
        assert ctx.cap > 1000
        raise KeyError
    assert (ctx.prec, ctx.cap) == before
    with jets.precision(64):
        assert not (jets.ball(F(1, 3)) * 3 - 1).is_zero()
        assert (jets.ball(F(1, 3)) * 3 - 1).contains(0)


def discs_bound_complex_solutions(package: ModuleType) -> None:
    """x' = x^2 beside w' = 8000, which makes margins wide: |x/(1 - t x)| is at most the bound, on circles."""
    field = "v0 = y\nv1 = w\nv2 = x\nv3 = v2 * v2\nv4 = 8000\nv5 = v0 - v0\nreturn v5, v4, v3"
    program, level = (module(package, "statement").Program.from_text(t) for t in (field, "v0 = x\nreturn v0"))
    names, signs = ("y", "w", "x"), (-1, -1, 1)
    statement = module(package, "statement").Statement(
        names, {}, program, level, signs, None, 0, (2,), (1,), "period_tupling", 2, (F(1),), (), ()
    )
    flow, jets = module(package, "flow"), module(package, "jets")
    for centre, radius in ((0.5, 0.0), (-0.5, 0.0), (0.5, 0.125), (-0.5, 0.125)):
        with jets.precision(64):
            found = flow.disc(statement, [arb(0), arb(0), arb(centre, radius)], arb(0.5))
            margin, bound = found.margins[2], found.bounds[2]
            assert found.radius > 0.05
            worst = arb(0)
            for turn in range(48):
                for angle in range(48):
                    for end in (-radius, radius):
                        x = acb(centre + end) + acb(margin) * acb.exp_pi_i(acb(arb(angle) / 24))
                        t = acb(found.radius) * acb.exp_pi_i(acb(arb(turn) / 24))
                        worst = max(worst, abs(x / (1 - t * x)).lower())
            assert bound >= worst, f"a solution from {centre} +- {radius} is larger than its bound"
            assert bound < 8 * worst, (bound, worst, margin, found.radius)


def discs_end_before_a_pole_behind(package: ModuleType) -> None:
    """x' = x^2 from -1/2 is infinite at t = -2, x' = x^3 from 1 at t = 1/2, from (1 + i)^-1 .. at complex times."""
    flow, jets = module(package, "flow"), module(package, "jets")
    statement = system(package, SQUARE, [-1, 1], "y", "v0 = x\nreturn v0")
    turning = "v0 = x\nv1 = y\nv2 = v0 * v0\nv3 = v1 * v1\nv4 = v2 - v3\nv5 = v0 * v1\nv6 = v5 + v5\nreturn v4, v6"
    complex_square = system(package, turning, [1, -1], "y", "v0 = x\nreturn v0")
    for guess in (1.0, 2.2, 2.6, 4.0, 30.0):
        with jets.precision(64):
            assert flow.disc(statement, [arb(0), arb(-0.5)], arb(guess)).radius < 2
            # z' = z^2 from z = 1/2 e^(i a) has its pole at 2 e^(-i a), and at 2 e^(i a) for the conjugate.
            for turn in range(9):
                angle = arb.pi() * turn / 8
                start = [angle.cos() / 2, angle.sin() / 2]
                assert flow.disc(complex_square, start, arb(guess)).radius < 2


def remainders_are_cauchys(package: ModuleType) -> None:
    """The last coefficient, and that of the slope, are at least the sums of Cauchy's bounds they stand for."""
    flow, jets = module(package, "flow"), module(package, "jets")
    statement = system(package, SQUARE, [-1, 1], "y", "v0 = x\nreturn v0")
    radius, margins, bounds = arb(0.25), [arb(0.5), arb(0.25)], [arb(3), arb(5)]
    with jets.precision(64):
        state = [
            jet(package, {(): arb(0), (0,): arb(0.125), (0, 1): arb(-0.125)}),
            jet(package, {(): arb(0.5), (0,): arb(-0.0625), (1,): arb(0.03125), (0, 0): arb(0.125)}),
        ]
        with replaced(flow, "disc", lambda *_: flow.Disc(radius, margins, bounds)):
            step, _ = flow.take_step(statement, state, arb(1), 20)
        h, length = step.duration, len(step.polynomials[1][()]) - 1
        # 1/((1 - X_0)(1 - X_1)), X_j the sums of |coefficients|/margin, by powers of both.
        x0 = Series({(0,): F(1, 4), (0, 1): F(1, 4)}, 3)
        x1 = Series({(0,): F(1, 4), (1,): F(1, 8), (0, 0): F(1, 2)}, 3)
        growth = (Series.constant(F(1), 3) - x0).inverse() * (Series.constant(F(1), 3) - x1).inverse()
        tail = sum((radius**-k * h ** (k - length) for k in range(length, length + 400)), arb(0))
        slope = sum((k * radius**-k * h ** (k - length) for k in range(length, length + 400)), arb(0))
        for i, polynomials in enumerate(step.polynomials):
            for a, c in growth.items():
                rest, least = polynomials[a][length], bounds[i] * rational(c) * tail
                assert rest.contains(0)
                assert least * 0.999 < rest.abs_upper() < least * 1.01, (i, a)
        assert slope * 3 * 0.999 < step.section_slope[length - 1].abs_upper() < slope * 3 * 1.01
        # x = 1/2 at the start: x' = 1/4 there.
        assert abs(step.polynomials[1][()][1] - 0.25) < 1e-15
        assert 0 < h < radius


def crossings_are_counted(package: ModuleType) -> None:
    """s'' = -s: crossing m is at m pi; if an orbit is in Fix(R) before the one that is claimed, nothing is."""
    crossing, jets, statement = (module(package, name) for name in ("crossing", "jets", "statement"))
    text = "v0 = s\nv1 = v\nv2 = w\nv3 = -1\nv4 = v3 * v0\nv5 = v0 * v0\nreturn v1, v4, v5"
    field, first = (statement.Program.from_text(t) for t in (text, "v0 = v\nreturn v0"))
    names, signs = ("s", "v", "w"), (-1, 1, -1)
    for m in (1, 2, 3):
        claimed = statement.Statement(
            names, {}, field, first, signs, None, 0, (1,), (2,), "period_tupling", 2, (F(1),), (), (), m
        )
        with jets.precision(96):
            begin = [jet(package, {}), jet(package, {(): arb(1), (0,): arb(1)}), jet(package, {})]
            found, time, _ = crossing.follow(claimed, begin, 48)
            assert agree(time, m * arb.pi())
            contains(found[1], orders((-1) ** m, (-1) ** m, 0, 0), "velocity")
            contains(found[2], orders(m * arb.pi() / 2, m * arb.pi(), m * arb.pi() / 2, 0), "integral")
            if m > 1:
                back = [*begin[:2], jet(package, {(): -arb.pi() / 2})]
                with pytest.raises(jets.CannotFollow, match="half orbit"):
                    crossing.follow(claimed, back, 48)


def touching_is_no_crossing(package: ModuleType) -> None:
    """t (t - 1)^2 touches zero at 1; t - t^3 meets a sign that is not what was followed."""
    from flint import arb_poly

    crossing, flow, jets = (module(package, name) for name in ("crossing", "flow", "jets"))
    for coefficients in ([0, 1, -2, 1], [1, -2, 1]):
        height = arb_poly(coefficients)
        step = flow.Step(arb(3), [jet(package, {(): height})], height.derivative())
        with pytest.raises(jets.CannotFollow):
            crossing.first_crossing(step, 0, 0 if coefficients[0] == 0 else 1, arb(0), arb(2.5))
    height = arb_poly([2, -1])
    step = flow.Step(arb(3), [jet(package, {(): height})], height.derivative())
    with pytest.raises(jets.CannotFollow, match="contradicts"):
        crossing.first_crossing(step, 0, -1, arb(0), arb(1))
    with pytest.raises(jets.CannotFollow, match="next to the end"):
        crossing.first_crossing(step, 0, 1, arb(0), arb(2))


def normal_forms_are_exact(package: ModuleType) -> None:
    """Family p_1 = f(p_0), branch p_0 = b(p_1), p_2 = c(p_0, p_1), H: random polynomials; exact coefficients."""
    rng = random.Random(7)
    radii = [F(1, 2**40), F(1, 2**40), F(1, 2**37)]

    def small() -> Fraction:
        return F(rng.randint(1, 7), 8) * rng.choice((1, -1))

    p0, p1, p2 = (variable(j, 3) for j in range(3))
    for size, k in ((2, 2), (3, 2), (2, 3), (3, 3), (2, 4), (3, 4)) * 2:
        # For even k the branch is tangent to the level of H, as it is where P^k exchanges its points.
        slope = small() / 4
        family, branch = p0 * (small() / 4) + p0 * p0 * small(), p1 * slope + p1 * p1 * small() + p1 * p1 * p1 * small()
        away = p0 * (small() / 8) + p1 * (small() / 8) + p0 * p1 * small() + p1 * p1 * small()
        level = p0 * p0 * small() + p0 * p1 * small() + p1 * p1 * small() + p0 * 2
        level = level + (p1 * (-2 * slope) if k % 2 == 0 else p1 * small())
        unit = Series.constant(F(2), 3) + p0 * small() + p1 * small()
        g = (p1 - family) * (p0 - branch) * unit
        first, last, integral = [p1 - family], [g], level
        if size == 3:
            rest = p2 - away
            first = [p1 - family + rest * (small() / 4), rest + (p1 - family) * (small() / 4)]
            last, integral = [g + rest * small() + rest * p1 * small(), rest * 3], level + rest * small()
        on_family, on_branch = level.composed({0: p0, 1: family}), level.composed({0: branch, 1: p1})
        gamma = g.derivative(1).composed({0: p0, 1: family})
        rise, bend, climb = on_branch[1,], 2 * on_branch[1, 1], on_family[0,]
        # G on the levels of H: along the family d(G_1)/dh; z = p_1 - p_1(h) of the family.
        exact = {"alpha": gamma[0,] / level[0,], "h_fp'": climb}
        lean = family[0,]
        exact |= (
            {"beta": rise / (1 - lean * rise / climb), "h_b'": rise} if k == 3 else {"beta": bend / 2, "h_b''": bend}
        )
        terms = [[{exponents(a, size): c for a, c in f.items()} for f in row] for row in (first, last)]
        with module(package, "jets").precision(160):
            whole = claim(package, k, *terms, {exponents(a, size): c for a, c in integral.items()}, radii[:size])
            found = module(package, "conditions").conclude(*whole)
            failed = {h.name: h.enclosures for h in found.hypotheses if not h.holds}
            assert not failed, (size, k, failed)
            assert found.side == ("both" if k == 3 else "above" if bend > 0 else "below")
            for name, value in exact.items():
                contains({(): found.normal_form[name]}, {(): rational(value)}, name)
                assert found.normal_form[name].rad() < 1e-6
            assert set(found.normal_form) == set(exact)
            assert agree(found.slope, rational(slope))
            assert agree(found.drift, rational(lean))
            assert all(abs(c) < 1e-11 and c.contains(0) for c in found.point)


def exponents(monomial: tuple[int, ...], size: int) -> tuple[int, ...]:
    return tuple(monomial.count(j) for j in range(size))


def folds_are_exact(package: ModuleType) -> None:
    """The curve (f(p_1), p_1, c(p_1)) and H(p): h'' exactly; the conditions fail where they have to."""
    conditions, jets = module(package, "conditions"), module(package, "jets")
    p0, p1, p2 = (variable(j, 3) for j in range(3))
    radii = [F(1, 2**44), F(1, 2**40), F(1, 2**44)]
    start = [Series.constant(value, 3) for value in (F(1, 2**45), F(0), F(-1, 2**46))]

    def conclusion(equations: list[Series], level: Series) -> Any:
        size = len(equations) + 1
        whole = [
            claim(package, 1, [], [{exponents(a, size): c for a, c in f.items()}], {(0,) * size: F(1)}, radii[:size])
            for f in (*equations, level)
        ]
        tables = [w[2][0][0] for w in whole]
        with jets.precision(160):
            return conditions.conclude_fold(tables[:-1], tables[-1], whole[0][4])

    def fails(equations: list[Series], level: Series) -> set[str]:
        return {h.name for h in conclusion(equations, level).hypotheses if not h.holds}

    for bend in (F(1), F(-3), F(1, 5)):
        curve, away = start[0] + p1 * F(1, 2**10) + p1 * p1 * bend, start[2] + p1 * F(1, 2**9) + p1 * p1 * 7
        level = p0 * 2 - p1 * F(1, 2**9) + p1 * p1 * F(1, 3) + (p0 - start[0]) * p1
        second = 2 * level.composed({0: curve, 1: p1})[1, 1]
        for equations in ([(p0 - curve) * 5], [(p0 - curve) * 2 + (p2 - away), (p0 - curve) - (p2 - away) * 3]):
            if len(equations) == 1:
                wide = [conclusion(equations, level)]
            else:
                wide = [conclusion(equations, level + (p2 - away) * 4)]
            for found in wide:
                held = {h.name: h.holds for h in found.hypotheses}
                assert set(held) == {"curve", "extremum", "dH/dp_0"}
                assert held["extremum"]
                contains({(): found.normal_form["beta"]}, {(): rational(second / 2)}, "beta")
                assert found.normal_form["beta"].rad() < 1e-6
                assert found.side == ("above" if second > 0 else "below")
                for value, series in zip(found.point, start, strict=False):
                    assert value.contains(rational(series[()]))
                    assert value.rad() < 1e-20
    upright = p1 * p1
    assert fails([p0 - upright], p0) == set()
    assert fails([p0 - upright - Series.constant(F(1, 2**43), 3)], p0) == {"curve"}
    assert fails([p0 - upright - p1], p0) >= {"curve"}
    assert "extremum" in fails([p0 - p1 * p1 * p1], p0)
    assert "extremum" in fails([p0 - upright], p0 + p1 * F(1, 2**38))
    assert "dH/dp_0" in fails([p0 - upright], p0 * p0 + p1 * p1)
    assert "curve" in fails([p0 - upright, p2 - Series.constant(F(1, 2**43), 3)], p0)


@contextmanager
def replaced(owner: Any, name: str, value: Any) -> Iterator[None]:
    before = getattr(owner, name)
    setattr(owner, name, value)
    try:
        yield
    finally:
        setattr(owner, name, before)


FIELD = "v0 = s\nv1 = x\nv2 = y\nv3 = nu\nv4 = v0 * v1\nreturn v3, v4, v1"
FIELDS = "v0 = s\nv1 = x\nv2 = u\nv3 = y\nv4 = w\nv5 = nu\nv6 = v0 * v1\nv7 = v0 * v2\nreturn v5, v6, v7, v1, v2"


def certificate(kind: str, k: int, centre: list[str], frame: list[list[str]], rows: list[list[str]]) -> dict[str, Any]:
    """A claim about a map (x, y, nu) -> (x + .., y + .., nu) or, with two x and y, in twice the dimension."""
    many = len(rows)
    stated = {"kind": kind, "k": k, "centre": centre, "frame": frame, "kernel_frame": rows, "parameters": {}}
    words: dict[str, Any] = {"candidate": stated, "vector_field": FIELD if many == 1 else FIELDS, "section": "s"}
    words |= {"reversing_symmetry": [-1, *[1] * many, *[-1] * many]}
    words |= {"symmetry": [1, -1, -1] if kind == "symmetry_breaking" else None}
    return {"statement": words}


def prove(package: ModuleType, words: dict[str, Any], kick: Any) -> Any:
    """The second proof with a map of a closed form in place of the flow: half a kick, a drift, half a kick."""
    proof = module(package, "proof")
    with replaced(proof, "follow", closed(kick)):
        return proof.second_proof(words)


def closed(kick: Any) -> Any:
    """What takes the place of `crossing.follow`."""

    def follow(statement: Any, start: list[Any], bits: int) -> Any:
        section, *moving, nu = start
        n = len(moving) // 2
        x, y = moving[:n], moving[n:]
        y = [a + f for a, f in zip(y, kick(x, nu), strict=True)]
        x = [a + b for a, b in zip(x, y, strict=True)]
        y = [a + f for a, f in zip(y, kick(x, nu), strict=True)]
        return [section, *x, *y, nu], arb(1), 1

    return follow


PLACE = {"nu": F(1, 7), "x": F(-2, 3), "u": F(5, 11)}
"""The fixed point at which the maps below bifurcate."""


def kicks(slope: Fraction) -> Any:
    """nu - a x - x^2/2 + x^3/3 about the place; with a second coordinate that is driven: x^2/3 - u/5."""

    def kick(x: list[Any], nu: Any) -> list[Any]:
        def about(value: Any, name: str) -> Any:
            return type(value)({**value, (): value[()] - rational(PLACE[name])}, value.degree)

        z = about(x[0], "x")
        square = z * z
        first = about(nu, "nu") - z * rational(slope) - square * arb(0.5) + square * z * rational(F(1, 3))
        driven = [square * rational(F(1, 3)) - about(u, "u") * rational(F(1, 5)) for u in x[1:]]
        return [first, *driven]

    return kick


def odd(x: list[Any], nu: Any) -> list[Any]:
    """nu x - x^3."""
    return [nu * x[0] - x[0] * x[0] * x[0]]


def bifurcation_function(k: int, slope: Fraction) -> Series:
    """y(P^k) on y = 0 as an exact power series in (nu, x) about the place."""

    def kick(x: Series) -> Series:
        return variable(0, 3) - x * slope - x * x * F(1, 2) + x * x * x * F(1, 3)

    a, b = variable(1, 3), Series({}, 3)
    for _ in range(k):
        b = b + kick(a)
        a = a + b
        b = b + kick(a)
    return b


CLAIMS = [("period_tupling", 2, F(1)), ("touch_and_go", 3, F(3, 2))]
"""Kind, k, and the slope of the kick at which it happens: the trace of DP is 2 - 2 a."""


def numbers(k: int, slope: Fraction) -> tuple[Fraction, Fraction, Fraction]:
    """Slope dx/dnu of the family, alpha, beta, by the formulas for maps with a parameter."""
    g, lean = bifurcation_function(k, slope), 1 / slope
    alpha = g[0, 1] + 2 * g[1, 1] * lean
    return lean, alpha, -g[1, 1, 1] / alpha if k == 2 else -g[1, 1] / alpha


def whole_proofs_about_closed_maps(package: ModuleType) -> None:
    """Doubling, touch-and-go, fold and symmetry breaking, in several frames, from centres that are not exact."""
    off = F(1, 2**70)
    for kind, k, slope in CLAIMS:
        lean, alpha, beta = numbers(k, slope)
        for frame in (((1, 0), (0, 1)), ((2, F(1, 4)), (F(-1, 2), F(1, 2)))):
            (a, b), (c, d) = (tuple(F(e) for e in row) for row in frame)
            det, scale = a * d - b * c, F(3)
            # p_1 = (-c dnu + a dx)/det: on a level of nu it is a/det times x; q_1 = scale y.
            grow = a / det
            exact = {"alpha": scale * alpha / grow, "beta": beta / grow**2 if k == 2 else beta / grow}
            exact["h_fp'"] = det / (d - b * lean)
            centre = [str(PLACE["nu"] + off), str(PLACE["x"] - off)]
            found = prove(package, certificate(kind, k, centre, texts(frame), [[str(scale)]]), kicks(slope))
            assert type(found).__name__ == "Proved", found
            assert found.side == ("both" if k == 3 else "above" if beta > 0 else "below")
            assert (found.kind, found.k) == (kind, k)
            agrees(package, found, ["nu", "x"], exact)
    frame = texts(((1, F(1, 4)), (0, F(1, 2))))
    half = texts(((1, 0), (0, F(1, 2))))
    found = prove(package, certificate("symmetry_breaking", 1, ["0", "0"], half, [["3"]]), odd)
    assert found.side == "above"
    assert all(found.point[name].contains(0) for name in ("nu", "x"))
    assert found.point["x"].is_zero()
    form = found.normal_form
    assert agree(form["alpha"], arb(3))
    assert agree(form["beta"], arb(0.25))
    assert agree(form["h_fp'"], arb(1))
    assert max(c.rad() for c in form.values()) < 1e-8
    centre = [str(PLACE["nu"] + off), str(PLACE["x"] + off)]
    found = prove(package, certificate("fold", 1, centre, half, [["3"]]), kicks(F(0)))
    assert found.side == "above"
    # nu = x^2/2 - x^3/3, x = p_1/2.
    agrees(package, found, ["nu", "x"], {"beta": F(1, 8)})
    # Frames that are not adapted to S; a centre that S does not fix; frames that are singular.
    for centre, columns in ((["0", "0"], frame), (["0", "0x1p-80"], half)):
        found = prove(package, certificate("symmetry_breaking", 1, centre, columns, [["3"]]), odd)
        assert "adapted" in found.reason
    for columns, row in ((texts(((1, 1), (1, 1))), "3"), (texts(((1, 0), (0, 1))), "0")):
        centre = [str(PLACE["nu"]), str(PLACE["x"])]
        found = prove(package, certificate("period_tupling", 2, centre, columns, [[row]]), kicks(F(1)))
        assert type(found).__name__ == "NotProved"


def whole_proofs_in_two_directions(package: ModuleType) -> None:
    """The same with a driven second coordinate, u = 5 x^2/3 on the family: numbers of the first alone."""
    for kind, k, slope in CLAIMS:
        _, alpha, beta = numbers(k, slope)
        frame = texts(((1, 0, 0), (0, 1, 0), (0, 0, 1)))
        centre = [str(PLACE["nu"]), str(PLACE["x"]), str(PLACE["u"] + F(1, 2**75))]
        found = prove(package, certificate(kind, k, centre, frame, [["1", "0"], ["0", "1"]]), kicks(slope))
        assert type(found).__name__ == "Proved", found
        agrees(package, found, ["nu", "x", "u"], {"alpha": alpha, "beta": beta})


def agrees(package: ModuleType, found: Any, coordinates: list[str], form: Mapping[str, Fraction]) -> None:
    """The point is the place, the parameter is nu there, and the normal form is what it is."""
    with module(package, "jets").precision(256):
        for name in coordinates:
            assert found.point[name].contains(rational(PLACE[name])), name
            assert found.point[name].rad() < 1e-30, name
        assert found.parameter.contains(rational(PLACE["nu"]))
        for name, value in form.items():
            assert agree(found.normal_form[name], rational(value)), (name, found.normal_form[name].str(12), value)
            assert found.normal_form[name].rad() < 1e-8, name


def texts(matrix: Any) -> list[list[str]]:
    return [[str(F(c)) for c in row] for row in matrix]


def false_claims_about_closed_maps(package: ModuleType) -> None:
    """Claims of another kind, k or place are not proved."""
    unit, there = texts(((1, 0), (0, 1))), [str(PLACE["nu"]), str(PLACE["x"])]
    for kind, k, centre, kick in (
        ("period_tupling", 4, there, kicks(F(1))),
        ("touch_and_go", 3, there, kicks(F(1))),
        ("period_tupling", 2, there, kicks(F(1, 2))),
        # G_11 = 0 there.
        ("touch_and_go", 3, there, kicks(F(1, 2))),
        ("period_tupling", 6, there, kicks(F(1, 2))),
        ("fold", 1, there, kicks(F(1))),
        ("fold", 1, ["0", "0"], odd),
        ("period_tupling", 2, [there[0], "-1/2"], kicks(F(1))),
    ):
        found = prove(package, certificate(kind, k, centre, unit, [["1"]]), kick)
        assert type(found).__name__ == "NotProved", (kind, k)
        assert found.reason


def each_condition_fails_by_its_name(package: ModuleType) -> None:
    """Where another condition fails as well, the one that is about it has to fail by itself."""
    radii = [F(1, 1000), F(1, 100)]

    def failing(k: int, first: Any, last: Any, level: Any) -> set[str]:
        with module(package, "jets").precision(128):
            found = module(package, "conditions").conclude(*claim(package, k, [first], [last], level, radii))
        return {h.name for h in found.hypotheses if not h.holds}

    plain, touching = {(0, 1): F(2)}, {(1, 1): F(1), (0, 2): F(-1, 40)}
    assert failing(3, plain, touching, {(1, 0): F(1)}) == set()
    # The branch p_0 = p_1/2 leaves P_0 within P_1.
    assert failing(3, plain, {(1, 1): F(1), (0, 2): F(-1, 2)}, {(1, 0): F(1)}) == {"HC3"}
    # G = (p_1 - p_0) (p_0 - p_1): family and branch are tangent.
    tangent = {(1, 1): F(2), (0, 2): F(-1), (2, 0): F(-1)}
    assert "HC4" in failing(3, {(0, 1): F(1), (1, 0): F(-1)}, tangent, {(1, 0): F(1)})
    assert "dH/dp_0" in failing(3, {(0, 1): F(1), (1, 0): F(-1)}, tangent, {(0, 1): F(1)})
    # H = p_0 - p_1 on the family p_1 = p_0.
    assert "h_fp'" in failing(3, {(0, 1): F(1), (1, 0): F(-1)}, touching, {(1, 0): F(1), (0, 1): F(-1)})
    assert "h_fp'" not in failing(3, {(0, 1): F(1), (1, 0): F(-1)}, touching, {(1, 0): F(1)})


def iterates_hold_over_the_box(package: ModuleType) -> None:
    """q(P^i) at the corners of a box about the place, exactly."""
    proof, jets, slope, size = module(package, "proof"), module(package, "jets"), F(1), F(1, 2**80)
    centre = [str(PLACE["nu"]), str(PLACE["x"])]
    words = certificate("period_tupling", 2, centre, texts(((1, 0), (0, 1))), [["1"]])
    with jets.precision(248), replaced(proof, "follow", closed(kicks(slope))):
        tried = proof._Proof(module(package, "statement").read_statement(words), 96)
        found, _ = tried.iterates(tried.refined()[0], [arb(0, rational(size))] * 2)
        for nu, x in ((size, size), (size, -size), (-size, size)):
            for k, rows in enumerate(found, 1):
                series = bifurcation_function(k, slope)
                place = {0: Series.constant(nu, 3), 1: Series.constant(x, 3)}
                exact = rational(series.composed(place)[()])
                assert abs(rows[0][()] - exact) < 2 * rational(size) * abs(rational(series[1,])) + 64 * rational(size)
                assert rows[0][()].rad() >= abs(exact) * 0.999


def symmetries_are_those_of_the_field(package: ModuleType) -> None:
    words = certificate("symmetry_breaking", 1, ["0", "0"], texts(((1, 0), (0, 1))), [["1"]])
    words["statement"]["symmetry"] = [1, -1, 1]
    assert "S is not shown" in prove(package, words, odd).reason
    words["statement"] |= {"symmetry": [1, -1, -1], "reversing_symmetry": [-1, 1, 1]}
    with pytest.raises(ValueError, match="centre"):
        prove(package, words, odd)


def iterates_that_leave_the_box_are_refused(package: ModuleType) -> None:
    """Backward as forward: w has to be in the box on which P is known."""
    conditions, jets, proof = (module(package, name) for name in ("conditions", "jets", "proof"))

    def far(x: Any, y: Any) -> tuple[Any, Any]:
        return x + y, y

    with jets.precision(128):
        wide, zero = arb(0, arb(2) ** -40), jet(package, {})
        coordinates = [jet(package, {(): wide, (j,): arb(1)}) for j in (0, 1)]
        middle = [jet(package, {(j,): arb(1)}) for j in (0, 1)]
        tables = [conditions.Table(at, around, 1) for at, around in zip(far(*middle), far(*coordinates), strict=True)]
        known = proof.PoincareMap((1, -1), -1, [arb(0)] * 2, arb(2) ** -40, [arb(0)] * 2, tables)
        near = [jet(package, {(): arb(2) ** -50, (0,): arb(1)}), jet(package, {(1,): arb(1)}) + zero]
        known.backward(near)
        for step in (known.forward, known.backward):
            with pytest.raises(jets.CannotFollow, match="leaves"):
                step([jet(package, {(): arb(2) ** -39, (0,): arb(1)}), near[1]])


CHECKS: dict[str, Check] = {
    f.__name__: f
    for f in (
        jets_are_exact_power_series,
        jets_hold_over_boxes,
        substitution_is_composition,
        implicit_functions_of_two_unknowns,
        precision_is_restored,
        remainders_are_cauchys,
        touching_is_no_crossing,
        normal_forms_are_exact,
        folds_are_exact,
        whole_proofs_about_closed_maps,
        whole_proofs_in_two_directions,
        false_claims_about_closed_maps,
        each_condition_fails_by_its_name,
        iterates_hold_over_the_box,
        symmetries_are_those_of_the_field,
        iterates_that_leave_the_box_are_refused,
        crossings_are_counted,
        discs_end_before_a_pole_behind,
        discs_bound_complex_solutions,
    )
}
