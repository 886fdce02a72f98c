"""Properties of the second proof as functions of the package, so that faulty copies can be put to the same tests."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from importlib import import_module
from types import ModuleType
from typing import Any

import pytest
from flint import arb, arb_poly, fmpq
from support.balls import agree

Check = Callable[[ModuleType], None]
# Systems with closed-form solutions. Their symmetries play no role in the checks of the flow.
SQUARE = "v0 = y\nv1 = x\nv2 = v1 * v1\nv3 = v0 - v0\nreturn v3, v2"
ROOT = "v0 = y\nv1 = x\nv2 = v1 ** (1/2)\nv3 = v0 - v0\nreturn v3, v2"
INVERSE = "v0 = y\nv1 = x\nv2 = 1\nv3 = v2 / v1\nv4 = v0 - v0\nreturn v4, v3"
FALL = "v0 = s\nv1 = v\nv2 = w\nv3 = -1\nv4 = v0 - v0\nv5 = v3 + v4\nreturn v1, v5, v0"
OSCILLATOR = "v0 = s\nv1 = v\nv2 = w\nv3 = -1\nv4 = v3 * v0\nv5 = v0 * v0\nreturn v1, v4, v5"


def module(package: ModuleType, name: str) -> Any:
    return import_module(f"{package.__name__}.{name}")


def system(package: ModuleType, field: str, reversing: list[int], section: str, integral: str) -> Any:
    fixed = sum(sign == 1 for sign in reversing)
    candidate: dict[str, Any] = {"kind": "period_tupling", "k": 2, "centre": ["1"] * fixed, "parameters": {}}
    candidate |= {"frame": unit_matrix(fixed), "kernel_frame": unit_matrix(len(reversing) - fixed - 1)}
    words = {"candidate": candidate, "vector_field": field, "first_integral": integral, "symmetry": None}
    words |= {"reversing_symmetry": reversing, "section": section}
    return module(package, "statement").read_statement({"statement": words})


def unit_matrix(size: int) -> list[list[str]]:
    return [[str(int(i == j)) for j in range(size)] for i in range(size)]


def monomials(terms: dict[tuple[int, ...], Any]) -> dict[tuple[int, ...], Any]:
    """Terms by monomials, from terms by exponents."""
    return {tuple(j for j, e in enumerate(a) for _ in range(e)): c for a, c in terms.items()}


def contains(jet: dict[Any, Any], exact: dict[Any, arb], where: str) -> None:
    assert exact
    for i, e in exact.items():
        enclosure = jet.get(i, arb(0))
        assert enclosure.is_finite(), f"{where}: coefficient {i} is not finite"
        assert agree(enclosure, e), f"{where}: coefficient {i}: {enclosure.str(20)} misses {e.str(20)}"


def rational(value: Fraction) -> arb:
    return arb(fmpq(value.numerator, value.denominator))


def orders(*coefficients: Any) -> dict[Any, arb]:
    """The coefficients of a jet in one variable."""
    return {(0,) * i: arb(c) for i, c in enumerate(coefficients)}


def jet(package: ModuleType, terms: dict[Any, Any], degree: int = 3) -> Any:
    return module(package, "jets").Jet(terms, degree)


def start(package: ModuleType, value: arb) -> Any:
    """A coordinate that is the variable."""
    return jet(package, {(): value, (0,): arb(1)})


def square_jet(x: arb, t: arb) -> list[arb]:
    """x' = x^2: x/(1 - t x) and its Taylor coefficients in x."""
    d = 1 / (1 - t * x)
    return [x * d, d * d, t * d * d * d, t * t * d * d * d * d]


def root_jet(x: arb, t: arb) -> list[arb]:
    """x' = x^(1/2): (x^(1/2) + t/2)^2."""
    r = x.sqrt()
    return [x + t * r + t * t / 4, 1 + t / (2 * r), -t / (8 * r * x), t / (16 * r * x * x)]


def inverse_jet(x: arb, t: arb) -> list[arb]:
    """x' = 1/x: (x^2 + 2 t)^(1/2)."""
    s = x * x + 2 * t
    r = s.sqrt()
    return [r, x / r, t / (s * r), -t * x / (s * s * r)]


def flow_encloses_exact_solutions(package: ModuleType, points: int = 40, bits: int = 40) -> None:
    """Every exact solution from a random rational point of the box, with its derivatives, lies in the enclosures."""
    jets, flow = module(package, "jets"), module(package, "flow")
    rng = random.Random(1)
    for field, exact in ((SQUARE, square_jet), (ROOT, root_jet), (INVERSE, inverse_jet)):
        statement = system(package, field, [-1, 1], "y", "v0 = x\nreturn v0")
        for radius in (Fraction(0), Fraction(1, 2**20)):
            centre, now = Fraction(1, 2), arb(0)
            with jets.precision(128):
                spread = arb(0, rational(radius))
                state = [jet(package, {}), start(package, rational(centre) + spread)]
                guess = arb("0.2")
                inputs = [centre + radius * Fraction(rng.randint(-(10**9), 10**9), 10**9) for _ in range(points)]
                for _ in range(2):
                    step, guess = flow.take_step(statement, state, guess, bits)
                    for fraction in (0.25, 1):
                        found = step.at((step.duration * fraction).mid())
                        time = now + (step.duration * fraction).mid()
                        for x in inputs:
                            with jets.precision(400):
                                contains(
                                    found[1], orders(*exact(rational(x), time)), f"{field!r} from {x} at {time.str(5)}"
                                )
                    state, now = step.at(step.duration), now + step.duration


def discs_end_before_the_solution_does(package: ModuleType) -> None:
    """x' = x^2 from 1/2 is infinite at t = 2: no disc of time may be larger, whatever the guess."""
    flow, jets = module(package, "flow"), module(package, "jets")
    statement = system(package, SQUARE, [-1, 1], "y", "v0 = x\nreturn v0")
    for guess in (1.0, 4.0, 30.0):
        with jets.precision(64):
            found = flow.disc(statement, [arb(0), arb(0.5)], arb(guess))
            assert found.radius < 2
            assert found.bounds[1] >= 0.5 / (1 - float(found.radius.lower()) / 2)


def remainder_covers_short_series(package: ModuleType) -> None:
    """With very few terms of the series the remainder has to carry the solution."""
    flow_encloses_exact_solutions(package, points=3, bits=8)


def free_fall_crossing(package: ModuleType) -> None:
    """s'' = -1 from s = 0, v = p: the crossing is at t = 2p, v = -p, and the integral of s is 2/3 p^3."""
    crossing, jets = module(package, "crossing"), module(package, "jets")
    integral = "v0 = s\nv1 = v\nv2 = v1 * v1\nv3 = v0 + v0\nv4 = v2 + v3\nreturn v4"
    statement = fall(package, integral)
    for radius in (Fraction(0), Fraction(1, 2**20)):
        with jets.precision(160):
            p = rational(Fraction(3, 4)) + arb(0, rational(radius))
            found, time, _ = crossing.follow(statement, [jet(package, {}), start(package, p), jet(package, {})], 80)
            for shift in (-1, 0, 1):
                x = Fraction(3, 4) + shift * radius
                e = rational(x)
                third = [rational(Fraction(2, 3) * c) for c in (x**3, 3 * x**2, 3 * x, 1)]
                assert agree(time, 2 * e)
                contains(found[1], orders(-e, -1, 0, 0), "velocity")
                contains(found[2], orders(*third), "integral")
            assert found[2][0, 0, 0].rad() < 1e-3


def fall(package: ModuleType, integral: str) -> Any:
    """Free fall, of which only the flow matters: the dimensions of Fix(R) are not those of a bifurcation."""
    statement = module(package, "statement")
    field, first = statement.Program.from_text(FALL), statement.Program.from_text(integral)
    state = ("s", "v", "w")
    return statement.Statement(
        state, {}, field, first, (-1, 1, -1), None, 0, (1,), (2,), "period_tupling", 2, (Fraction(1),), (), ()
    )


def crossing_time_depends_on_the_state(package: ModuleType) -> None:
    """s'' = -w from s = 0, v = 1, u' = 1: the crossing is at t = u = 2/w."""
    crossing, jets, statement = (module(package, name) for name in ("crossing", "jets", "statement"))
    text = "v0 = s\nv1 = v\nv2 = w\nv3 = u\nv4 = -1\nv5 = v4 * v2\nv6 = v0 - v0\nv7 = 1\nreturn v1, v5, v6, v7"
    field, first = statement.Program.from_text(text), statement.Program.from_text("v0 = w\nreturn v0")
    names, signs = ("s", "v", "w", "u"), (-1, 1, 1, -1)
    claim = statement.Statement(
        names, {}, field, first, signs, None, 0, (2,), (3,), "period_tupling", 2, (Fraction(1),), (), ()
    )
    with jets.precision(160):
        w = arb(1.5)
        found, time, _ = crossing.follow(
            claim, [jet(package, {}), jet(package, {(): arb(1)}), start(package, w), jet(package, {})], 80
        )
        assert agree(time, 2 / w)
        contains(found[3], orders(*(2 * (-1) ** n / w ** (n + 1) for n in range(4))), "clock")


def implicit_functions_have_their_jet(package: ModuleType) -> None:
    """u + u^2 = v has u = v - v^2 + 2 v^3 + .."""
    equation = jet(package, {(0,): arb(-1), (1,): arb(1), (1, 1): arb(1)})
    found = module(package, "jets").implicit([equation], [1])[1]
    contains(found, orders(0, 1, -1, 2), "implicit function")


def first_crossing_of_an_oscillator(package: ModuleType) -> None:
    """s'' = -s: the first crossing is at pi, not at 0; w = integral of s^2 = pi p^2 / 2 there."""
    crossing, jets, statement = (module(package, name) for name in ("crossing", "jets", "statement"))
    field = statement.Program.from_text(OSCILLATOR)
    first = statement.Program.from_text("v0 = s\nv1 = v\nv2 = v0 * v0\nv3 = v1 * v1\nv4 = v2 + v3\nreturn v4")
    claim = statement.Statement(
        ("s", "v", "w"), {}, field, first, (-1, 1, -1), None, 0, (1,), (2,), "period_tupling", 2, (Fraction(1),), (), ()
    )
    with jets.precision(128):
        for sign in (1, -1):
            found, time, steps = crossing.follow(
                claim, [jet(package, {}), start(package, arb(sign)), jet(package, {})], 60
            )
            assert steps > 1
            assert agree(time, arb.pi())
            contains(found[1], orders(-sign, -1, 0, 0), "velocity")
            half = arb.pi() / 2
            contains(found[2], orders(half, 2 * sign * half, half, 0), "integral")


def every_crossing_in_a_step_is_seen(package: ModuleType) -> None:
    """The section coordinate t (t - 1) (t - 2) has its first zero at 1, also from behind the section."""
    crossing, flow = module(package, "crossing"), module(package, "flow")
    height = arb_poly([0, 2, -3, 1])
    step = flow.Step(arb(3), [jet(package, {(): height})], height.derivative())
    for sign in (0, 1):
        (a, b), after = crossing.first_crossing(step, 0, sign, arb(0), arb(2.5))
        assert a < 1 < b < 2
        assert after == -1
        (a, _), after = crossing.first_crossing(step, 0, after, b, arb(2.5))
        assert b <= a < 2
        assert after == 1
    assert crossing.first_crossing(step, 0, 0, arb(0), arb(0.5)) == (None, 1)


def wrong_first_integral_is_noticed(package: ModuleType) -> None:
    """v^3 is not kept by free fall, v^2 + 2 s is."""
    crossing, jets = (module(package, name) for name in ("crossing", "jets"))
    wrong = "v0 = s\nv1 = v\nv2 = v1 * v1\nv3 = v2 * v1\nreturn v3"
    right = "v0 = s\nv1 = v\nv2 = v1 * v1\nv3 = v0 + v0\nv4 = v2 + v3\nreturn v4"
    check = module(package, "proof").check_integral
    with jets.precision(128):
        begin = [jet(package, {}), start(package, arb(0.75)), jet(package, {})]
        end, _, _ = crossing.follow(fall(package, right), begin, 60)
        values = {}
        for text in (right, wrong):
            system = fall(package, text)
            values[text] = [system.level(state) for state in (begin, end)]
        check(*values[right])
        with pytest.raises(jets.CannotFollow, match="first integral"):
            check(*values[wrong])


def kicked(x: Any, y: Any, constant: Any) -> tuple[Any, Any]:
    """A map reversed by R = (x, -y): y += f(x), x += y, y += f(x), f = 1/2 - x - 2 x^2; (0, 0) goes to (1/2, 0)."""

    def kick(x: Any) -> Any:
        return constant - x - x * x * 2

    y = y + kick(x)
    x = x + y
    return x, y + kick(x)


def iterates_of_a_reversible_map_are_enclosed(package: ModuleType) -> None:
    """P^i from the jets of P near (0, 0) alone: at random points, values and derivatives of the exact iterates."""
    jets, conditions, proof = (module(package, name) for name in ("jets", "conditions", "proof"))

    def near(x: arb, y: arb) -> list[Any]:
        return [jet(package, {(): x, (0,): arb(1)}), jet(package, {(): y, (1,): arb(1)}), half]

    half = jet(package, {(): arb(1) / 2})
    rng = random.Random(3)
    with jets.precision(200):
        size, small = Fraction(1, 2**40), Fraction(1, 2**60)
        wide = arb(0, rational(size))
        tables = [
            conditions.Table(jet(package, {a: c for a, c in at.items() if len(a) < 2}), around, 1)
            for at, around in zip(kicked(*near(arb(0), arb(0))), kicked(*near(wide, wide)), strict=True)
        ]
        poincare = proof.PoincareMap((1, -1), -1, [arb(0), arb(0)], rational(size), [arb(0), arb(0)], tables)
        state = near(arb(0, rational(small)), arb(0, rational(small)))[:2]
        found = []
        for i in range(4):
            state = poincare.backward(state) if i % 2 else poincare.forward(state)
            found.append(state)
        for _ in range(20):
            point = near(*(rational(small * Fraction(rng.randint(-(10**9), 10**9), 10**9)) for _ in range(2)))[:2]
            for i, state in enumerate(found, 1):
                point = list(kicked(*point, half))
                for name, row, exact in zip("xy", state, point, strict=True):
                    contains(row, exact, f"{name} of iterate {i}")
        assert all(c.rad() < 1e-2 for row in found[-1] for c in row.values())
        with pytest.raises(jets.CannotFollow, match="leaves"):
            poincare.forward(near(arb(0), arb(0, rational(2 * size)))[:2])


def roots_need_a_positive_enclosure(package: ModuleType) -> None:
    jets = module(package, "jets")
    with jets.precision(64):
        with pytest.raises(jets.CannotFollow, match="positive"):
            start(package, arb(0.1, 0.2)) ** Fraction(-1, 2)
        with pytest.raises(jets.CannotFollow, match="zero"):
            start(package, arb(0.1, 0.2)) ** Fraction(-2)


def polynomial_tables(package: ModuleType, terms: dict[tuple[int, ...], Fraction], radii: list[Fraction]) -> Any:
    """The table of a polynomial of p of degree <= 3, exact at the centre and in balls over the box."""
    conditions, exact = module(package, "conditions"), monomials(terms)
    variables = [jet(package, {(): arb(0, rational(r)), (j,): arb(1)}) for j, r in enumerate(radii)]
    box = jet(package, {})
    for a, c in exact.items():
        term = jet(package, {(): rational(c)})
        for j in a:
            term = term * variables[j]
        box = box + term
    return conditions.Table(jet(package, {a: rational(c) for a, c in exact.items() if len(a) < 3}), box, 2)


def claim(
    package: ModuleType, k: int, first: Any, last: Any, integral: Any, radii: list[Fraction], breaking: bool = False
) -> Any:
    """A claim about maps given by polynomials: iterates 1, .., k-1 have `first`, iterate k has `last`."""
    make = lambda terms: polynomial_tables(package, terms, radii)  # noqa: E731
    rows = [[make(t) for t in first] for _ in range(k - 1)] + [[make(t) for t in last]]
    return k, breaking, rows, make(integral), [rational(r) for r in radii]


F = Fraction
RADII = [F(1, 1000), F(1, 100), F(1, 100)]
FAMILY = {(0, 1): F(2)}
LEVEL = {(1, 0): F(1)}


def pitchfork(bend: Fraction) -> dict[tuple[int, ...], Fraction]:
    """p_1 (p_0 - bend p_1^2)."""
    return {(1, 1): F(1), (0, 3): -bend}


def verdict(package: ModuleType, *args: Any, **kwargs: Any) -> Any:
    """The conclusion about polynomial maps if all conditions hold, or None."""
    with module(package, "jets").precision(128):
        try:
            found = module(package, "conditions").conclude(*claim(package, *args, **kwargs))
        except ZeroDivisionError:
            return None
    return found if all(h.holds for h in found.hypotheses) else None


def normal_forms_have_their_side(package: ModuleType) -> None:
    """p_1 (p_0 - bend p_1^2) has its branch at p_0 = bend p_1^2, so h_b'' = 2 bend."""
    for bend in (F(1), F(-1), F(3)):
        found = verdict(package, 2, [FAMILY], [pitchfork(bend)], LEVEL, RADII[:2])
        assert found is not None
        assert found.side == ("above" if bend > 0 else "below")
        value = next(h for h in found.hypotheses if h.name == "h_b''").enclosures["value"]
        assert agree(value, 2 * rational(bend))
        assert value.rad() < 0.1
    touch = verdict(package, 3, [FAMILY], [{(1, 1): F(1), (0, 2): F(-1, 100)}], LEVEL, RADII[:2])
    assert touch is not None
    assert touch.side == "both"


def reduction_removes_p2(package: ModuleType) -> None:
    """q_2 = p_2 - p_1^2, q_1 = p_1 (p_0 - 2 p_1^2) + p_1 p_2: on p_2 = p_1^2 the branch is p_0 = p_1^2."""
    first = [{(0, 1, 0): F(1)}, {(0, 0, 1): F(1)}]
    last = [{(1, 1, 0): F(1), (0, 3, 0): F(-2), (0, 1, 1): F(1)}, {(0, 0, 1): F(1), (0, 2, 0): F(-1)}]
    found = verdict(package, 2, first, last, {(1, 0, 0): F(1)}, RADII)
    assert found is not None
    value = next(h for h in found.hypotheses if h.name == "h_b''").enclosures["value"]
    assert agree(value, arb(2))
    assert value.rad() < 0.5


def tables_enclose_derivatives(package: ModuleType) -> None:
    """The mean value forms of a table contain the Taylor coefficients at random points of smaller boxes."""
    rng = random.Random(2)
    terms = {(1, 2): F(3), (0, 3): F(-2), (2, 0): F(5), (1, 1): F(7), (0, 1): F(1)}
    jets = module(package, "jets")
    with jets.precision(128):
        table = polynomial_tables(package, terms, RADII[:2])
        radii = [RADII[0] / 2, RADII[1] / 2]
        enclosure = table.jet([arb(0, rational(r)) for r in radii])
        for _ in range(100):
            x, y = (r * F(rng.randint(-1000, 1000), 1000) for r in radii)
            exact = {
                (0, 0): 3 * x * y**2 - 2 * y**3 + 5 * x**2 + 7 * x * y + y,
                (1, 0): 3 * y**2 + 10 * x + 7 * y,
                (0, 1): 6 * x * y - 6 * y**2 + 7 * x + 1,
                (2, 0): F(5),
                (1, 1): 6 * y + 7,
                (0, 2): 3 * x - 6 * y,
                (3, 0): F(0),
                (2, 1): F(0),
                (1, 2): F(3),
                (0, 3): F(-2),
            }
            contains(enclosure, {a: rational(c) for a, c in monomials(exact).items()}, f"at {x}, {y}")


def false_maps_are_not_proved(package: ModuleType) -> None:
    """Each condition of [WW] fails for one of these maps."""
    two, good = [FAMILY], [pitchfork(F(1))]
    assert verdict(package, 2, two, good, LEVEL, RADII[:2]) is not None
    # The branch leaves P_0: HC3.
    assert verdict(package, 2, two, [pitchfork(F(20))], LEVEL, RADII[:2]) is None
    # The family is at p_1 = 1/50, outside P_1.
    assert verdict(package, 2, [{(0, 1): F(1), (0, 0): F(1, 50)}], good, LEVEL, RADII[:2]) is None
    # D_p pi_q P vanishes at p_1 = 0: neither a family nor regular-1.
    assert verdict(package, 2, [{(0, 1): F(1, 1000), (0, 2): F(1)}], good, LEVEL, RADII[:2]) is None
    # No crossing: G_01 = 0.
    assert verdict(package, 2, two, [{(0, 3): F(1)}], LEVEL, RADII[:2]) is None
    # A cusp on the branch: G_111 = 0.
    assert verdict(package, 2, two, [{(1, 1): F(1)}], LEVEL, RADII[:2]) is None
    # Touch-and-go with a branch that is not a graph over the parameter.
    assert verdict(package, 3, two, good, LEVEL, RADII[:2]) is None
    # The first integral does not replace p_0, or is stationary along the family.
    assert verdict(package, 2, two, good, {(2, 0): F(1), (0, 2): F(1)}, RADII[:2]) is None
    # p_2^H leaves P_2.
    first = [{(0, 1, 0): F(1)}, {(0, 0, 1): F(1)}]
    last = [{(1, 1, 0): F(1), (0, 3, 0): F(-1)}, {(0, 0, 1): F(1), (0, 0, 0): F(1, 50)}]
    assert verdict(package, 2, first, last, {(1, 0, 0): F(1)}, RADII) is None


def middle_iterates_have_to_be_regular(package: ModuleType) -> None:
    """k = 4: the second iterate is singular in the box, the first and third are not."""
    with module(package, "jets").precision(128):
        whole = claim(package, 4, [FAMILY], [pitchfork(F(1))], LEVEL, RADII[:2])
        whole[2][1] = [polynomial_tables(package, {(0, 2): F(1)}, RADII[:2])]
        found = module(package, "conditions").conclude(*whole)
    assert [h.name for h in found.hypotheses if not h.holds] == ["regular-2"]


def nothing_follows_from_nan(package: ModuleType) -> None:
    conditions = module(package, "conditions")
    assert conditions.Hypothesis("name", True, {"value": arb(1)}).holds
    assert not conditions.Hypothesis("name", False, {"value": arb(1)}).holds
    for value in (arb("nan"), arb("inf"), arb(0, "inf")):
        assert not conditions.Hypothesis("name", True, {"value": value}).holds
    assert not conditions.Hypothesis("name", True, {}).holds


def asymmetric_fields_are_refused(package: ModuleType) -> None:
    """v' = s^2 + v is neither even nor odd under s -> -s, v -> v with time reversed."""
    statement = module(package, "statement")
    signs = {"s": -1, "v": 1}
    text = "v0 = s\nv1 = v\nv2 = v0 * v0\nv3 = v2 + v0\nv4 = v0 * v1\nv5 = v1 / v0\nv6 = v0 ** (3)\nv7 = v1 ** (-3/2)\n"
    text += "v8 = v0 ** (1/2)\nv9 = v3 ** (2)\nv10 = v3 * v3\nv11 = v0 ** (-2)\nv12 = v3 + v3\n"
    program = statement.Program.from_text(text + "return v2, v3, v4, v5, v6, v7, v8, v9, v10, v11, v12")
    assert program.run(signs, lambda _: 1, statement.PARITY) == [1, 0, -1, -1, -1, 1, 0, 0, 0, 1, 0]


CHECKS: dict[str, Check] = {
    f.__name__: f
    for f in (
        flow_encloses_exact_solutions,
        discs_end_before_the_solution_does,
        remainder_covers_short_series,
        free_fall_crossing,
        crossing_time_depends_on_the_state,
        implicit_functions_have_their_jet,
        first_crossing_of_an_oscillator,
        every_crossing_in_a_step_is_seen,
        iterates_of_a_reversible_map_are_enclosed,
        wrong_first_integral_is_noticed,
        roots_need_a_positive_enclosure,
        normal_forms_have_their_side,
        reduction_removes_p2,
        tables_enclose_derivatives,
        false_maps_are_not_proved,
        middle_iterates_have_to_be_regular,
        nothing_follows_from_nan,
        asymmetric_fields_are_refused,
    )
}
