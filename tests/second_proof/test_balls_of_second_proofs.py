"""Second proofs: what is found of balls contains what is found of each of their points."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import pytest
from flint import acb, arb, arb_mat, arb_poly
from polynomial_returns import BEND, BITS, bifurcation, claimed, jets, legs, returning, synthetic, torus
from support.balls import agree, first_of
from support.inclusion import Refused, broken_inclusions
from support.normal_form_maps import known_bifurcation, known_torus
from support.other_coordinates import mixing
from support.within import within

from orbitproof.verify import second_proof as package
from orbitproof.verify.claim import inverse
from orbitproof.verify.evidence import enclose

conditions, crossing, elliptic, fixed_level, full_return, multipliers, newton, births, halves, proof, statement = (
    import_module(f"{package.__name__}.{name}")
    for name in (
        "conditions", "crossing", "elliptic_tori", "fixed_level", "full_return", "multipliers", "newton", "births",
        "halves", "proof", "statement",
    )
)  # fmt: skip
SMALL, TINY = arb(2) ** -12, arb(2) ** -34
TIME = -1
Row = dict[tuple[int, ...], arb]

precision = within(lambda: jets.precision(BITS))


def monomials(variables: Sequence[int], degree: int) -> list[tuple[int, ...]]:
    """All up to a degree, their variables in order."""
    found: list[tuple[int, ...]] = [()]
    for _ in range(degree):
        found += [(*a, v) for a in found for v in variables if not a or a[-1] <= v]
    return sorted(set(found), key=lambda a: (len(a), a))


def row(chance: random.Random, variables: Sequence[int], degree: int, linear: Mapping[int, float] = {}) -> Row:
    """Random coefficients, with these of degree 1."""
    found = {a: arb(chance.uniform(-1, 1)) for a in monomials(variables, degree)}
    return found | {(v,): arb(value) for v, value in linear.items()}


def regular(chance: random.Random, variables: Sequence[int], degree: int, count: int | None = None) -> list[Row]:
    """As many as variables, with a regular derivative by them."""
    size = len(variables) if count is None else count
    return [
        row(chance, variables, degree, {v: chance.uniform(-0.3, 0.3) + (1.4 if i == j else 0) for j, v in
                                        enumerate(variables)})
        for i in range(size)
    ]  # fmt: skip


def as_jets(rows: Sequence[Row], degree: int) -> list[Any]:
    return [jets.Jet(each, degree) for each in rows]


def numbers(count: int, chance: random.Random) -> list[arb]:
    return [arb(chance.uniform(-1, 1)) for _ in range(count)]


def test_arithmetic_of_jets() -> None:
    chance = random.Random(1)
    variables = (0, 1)

    def found(a: Row, b: Row) -> Any:
        x, y = as_jets([{**a, (): a[()] + 3}, {**b, (): b[()] - 3}], 3)
        half = Fraction(1, 2)
        return [dict(each) for each in (x + y, x - y, x * y, x / y, x**half, x**-half, y ** Fraction(-2), x * x)]

    assert not broken_inclusions(found, (row(chance, variables, 3), row(chance, variables, 3)), chance, 16)

    def composed(outer: Any, inner: Any) -> Any:
        within = {j: each.varying() for j, each in enumerate(as_jets(inner, 3))}
        return [dict(each) for each in jets.substitute(as_jets(outer, 3), within)]

    pairs = [row(chance, variables, 3) for _ in "ab"], [row(chance, variables, 3) for _ in "ab"]
    assert not broken_inclusions(composed, pairs, chance, 12)

    def solved(rows: Any) -> Any:
        return {u: dict(each) for u, each in jets.implicit(as_jets(rows, 3), [1, 2]).items()}

    given = [row(chance, (0, 1, 2), 3, {1: 1.5, 2: 0.3}), row(chance, (0, 1, 2), 3, {1: -0.2, 2: -1.4})]
    assert not broken_inclusions(solved, (given,), chance, 14)


def moved(polynomial: Row, where: Sequence[arb]) -> Row:
    """Its Taylor coefficients up to order 3 at all of these points."""
    found: Row = {}
    for a in monomials(range(len(where)), 3):
        value = arb(0)
        for b, c in polynomial.items():
            rest = list(b)
            if all(rest.count(v) >= a.count(v) for v in set(a)):
                term = c
                for v, place in enumerate(where):
                    n, k = b.count(v), a.count(v)
                    for i in range(k):
                        term = term * (n - i) / (i + 1)
                    for _ in range(n - k):
                        term = term * place
                value = value + term
        found[a] = value
    return found


def over_box(polynomial: Row, radii: Sequence[arb]) -> Any:
    """A table of a polynomial of degree 3: at the centre, and on the box."""
    around = moved(polynomial, [radius * arb(0, 1) for radius in radii])
    return conditions.Table(jets.Jet(polynomial, 3), jets.Jet(around, 3), 2)


@pytest.mark.parametrize("kind", ["fold", "period_tupling"])
def test_conditions_of_a_claim_are_about_all_points_of_its_box(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of functions of degree 4, whose derivatives of order 3 change from point to point."""
    chance, given = random.Random(kind), []
    first, second, level = (row(chance, (0, 1), 4) for _ in range(3))
    radii = [arb(1) / 2, arb(1) / 4]

    def iterates(_: Any, reach: Sequence[arb]) -> Any:
        one, two, last = (jets.Jet(moved(each, reach), 3) for each in (first, second, level))
        return [[one], [two]], last

    monkeypatch.setattr(proof, "conclude_fold", lambda tables, integral, _: given.extend([*tables, integral]))
    monkeypatch.setattr(
        proof, "conclude", lambda k, breaking, rows, integral, _: given.extend([*rows[0], *rows[1], integral])
    )
    claim: Any = SimpleNamespace(
        size=2, breaking=False, statement=SimpleNamespace(kind=kind, k=2), iterates=iterates
    )  # fmt: skip
    proof._Proof.evaluated(claim, None, radii)
    exact = [first, level] if kind == "fold" else [first, second, level]
    for number in range(40):
        shares = [chance.choice((-1, 1)) if number < 8 else arb(chance.uniform(-1, 1)) for _ in radii]
        place = [share * radius for share, radius in zip(shares, radii, strict=True)]
        for table, polynomial in zip(given, exact, strict=True):
            found = table.jet(place)
            assert all(agree(found[a], value) for a, value in moved(polynomial, place).items())


def test_tables_move_with_the_place_and_with_all_that_they_hold() -> None:
    chance = random.Random(2)
    centre, around = row(chance, (0, 1), 2), row(chance, (0, 1), 3)

    def found(centre: Row, around: Row, reach: Any) -> Any:
        return dict(conditions.Table(jets.Jet(centre, 2), jets.Jet(around, 3), 2).jet(reach))

    assert not broken_inclusions(found, (centre, around, numbers(2, chance)), chance, 16)


def concluded(k: int, n: int, polynomials: Any) -> Any:
    """Conditions of a bifurcation, if all hold: all that is in the conclusion."""
    radii = [arb(2) ** -12, arb(2) ** -16, arb(2) ** -12][: n + 1]
    tables = [over_box(each, radii) for each in polynomials]
    *iterates, integral = tables
    if k == 0:
        found = conditions.conclude_fold(iterates, integral, radii)
    else:
        rows = [iterates[i * n : (i + 1) * n] for i in range(k)]
        found = conditions.conclude(k, False, rows, integral, radii)
    if not all(h.holds for h in found.hypotheses):
        return Refused()
    shown = [h.enclosures for h in found.hypotheses]
    return found.point, found.side, found.normal_form, found.slope, found.drift, shown


@pytest.mark.parametrize("n", [1, 2])
@pytest.mark.parametrize("k", [0, 2, 3])
def test_conditions_of_a_bifurcation(k: int, n: int) -> None:
    """Of a first iterate that is regular in p_1, p_2, and a last one that is p_0 p_1 + .. on the branch."""
    chance = random.Random(10 * k + n)
    variables = range(n + 1)
    integral = row(chance, variables, 3, {0: 1.3, 1: 0.02})
    if k == 0:
        rows = [
            row(chance, variables, 3, {0: 1.2, 1: 0.0, 2: 0.3}),
            row(chance, variables, 3, {0: 0.2, 1: 0.0, 2: -1.1}),
        ]
        polynomials = [{**each, (): arb(0)} for each in rows[:n]]
        integral |= {(1,): arb(0), (1, 1): arb(0.8)}
    else:
        first = [{**each, (): arb(0)} for each in regular(chance, list(variables)[1:], 3, n)]
        first = [{**row(chance, variables, 3), **each, (0,): arb(0)} for each in first]
        last = row(chance, variables, 3, {0: 0.0, 1: 0.0, 2: 0.3})
        last |= {(0, 1): arb(1.5), (): arb(0), (0, 0): arb(0), (1, 1): arb(0.0 if k == 2 else 0.04)}
        more = row(chance, variables, 3, {0: 0.0, 1: 0.0, 2: 1.3}) | {(): arb(0)}
        more |= {(0, 1): arb(0.1), (0, 0): arb(0)}
        polynomials = first * (k - 1) + [last, more][:n]

    def found(polynomials: Any) -> Any:
        return concluded(k, n, polynomials)

    def of_degree(*degrees: int) -> Any:
        return lambda path: len(path[-1]) in degrees

    given = ([*polynomials, integral],)
    assert not broken_inclusions(found, given, chance, 4, arb(2) ** -18, of_degree(0, 1))
    assert not broken_inclusions(found, given, chance, 3, arb(2) ** -5, of_degree(2, 3))


@pytest.mark.parametrize("k", [2, 3])
def test_a_family_stays_in_the_box_over_all_of_its_parameter(k: int) -> None:
    """p_1 = -slope p_0 with |p_0| < 2^-12 and |p_1| < 2^-16."""
    chance = random.Random(k)
    variables = (0, 1)
    integral = row(chance, variables, 3, {0: 1.3, 1: 0.02})
    last = row(chance, variables, 3, {0: 0.0, 1: 0.0})
    last |= {(0, 1): arb(1.5), (): arb(0), (0, 0): arb(0), (1, 1): arb(0.0 if k == 2 else 0.04)}
    for slope, stays in ((2.0**-6, True), (2.0**-3, False), (-(2.0**-6), True), (-(2.0**-3), False)):
        first = row(chance, variables, 3, {0: slope, 1: 1.0}) | {(): arb(0)}
        # The last iterate of the family is the family: p_1 + slope p_0 is a factor.
        moved = last | {(0, 0): arb(1.5 * slope)}
        found = concluded(k, 1, [*[first] * (k - 1), moved, integral])
        assert isinstance(found, Refused) is not stays, slope


def rows_of(attempt: Any) -> tuple[list[Row], list[arb], int]:
    """Jets of E on the box of the zero, as coefficients, and the zero."""
    newton, zero, _, rows = attempt.enclosed()
    assert newton.holds
    return [{a: c.mid() for a, c in each.items()} for each in rows], [x.mid() for x in zero], rows[0].degree


@pytest.mark.parametrize(
    ("kind", "legs_of"), [("periodic-fold", 1), ("periodic-doubling", 1), ("periodic-doubling", 2)]
)
def test_coefficients_of_bifurcations(kind: str, legs_of: int) -> None:
    chance = random.Random(kind)
    known = known_bifurcation(bifurcation.SIGMA[kind], 2, chance, others=(Fraction(1, 2),))
    claim = claimed(kind, (known.eigenvector,))
    attempt = synthetic(bifurcation._Proof, claim, returning(known.derivatives, BEND[:2], legs_of), legs_of)
    rows, zero, degree = rows_of(attempt)
    vector = attempt.vector(zero)

    def found(rows: Any, vector: Any) -> Any:
        given = as_jets(rows, degree)
        hypothesis, kappa, outwards = attempt.coefficients(given, vector)
        return (
            hypothesis.enclosures, kappa, outwards, attempt.left_kernel(given), attempt.scale(vector),
            attempt.coordinates(vector), attempt.bent(given, vector), attempt.equations(given),
            attempt.system(given, [*zero[: attempt.time + 1], *vector]), attempt.slopes(given, -1),
        )  # fmt: skip

    assert not broken_inclusions(lambda vector: found(rows, vector), (vector,), chance)
    of_rows = partial(first_of, found, vector)
    by_parameter = (attempt.varied,)
    assert not broken_inclusions(of_rows, (rows,), chance, 2, where=lambda path: path[-1] == by_parameter)
    for degree in (1, 2) if kind == "periodic-fold" else (1, 2, 3):
        assert not broken_inclusions(of_rows, (rows,), chance, 3, where=lambda path, d=degree: len(path[-1]) == d)


def test_coefficients_of_tori() -> None:
    chance = random.Random(4)
    known = known_torus(2, chance)
    claim = claimed("periodic-torus", known.eigenvector, known.multiplier)
    attempt = synthetic(torus._Torus, claim, returning(known.derivatives, BEND[:2], 1), 1)
    rows, zero, degree = rows_of(attempt)

    def found(rows: Any, zero: Any) -> Any:
        given, at, vector = as_jets(rows, degree), attempt.multiplier(zero), attempt.vector(zero)
        return (
            *attempt.coefficients(given, at, vector), attempt.scale(vector), at, vector, attempt.lines(given, at),
            attempt.system(given, zero),
        )  # fmt: skip

    assert not broken_inclusions(lambda zero: found(rows, zero), (zero,), chance)
    of_rows = partial(first_of, found, zero)
    by_parameter = (attempt.varied,)
    assert not broken_inclusions(of_rows, (rows,), chance, 2, where=lambda path: path[-1] == by_parameter)
    for degree in (1, 2, 3):
        assert not broken_inclusions(of_rows, (rows,), chance, 3, where=lambda path, d=degree: len(path[-1]) == d)


@pytest.mark.parametrize("size", [2, 3])
def test_multipliers_of_all_matrices_between_two(size: int) -> None:
    for seed in range(3):
        chance = random.Random(f"{size} {seed}")
        change = mixing(size, chance)
        back = inverse(change)
        assert back is not None
        values = [1.0, *chance.sample([-3.0, -0.5, 0.25, 2.0], size - 1)]

        def between(by: arb, values: Any = values, change: Any = change, back: Any = back) -> arb_mat:
            middle = arb_mat(
                [[arb(values[i]) + (by if i else 0) if i == j else 0 for j in range(size)] for i in range(size)]
            )
            left, right = (arb_mat([[enclose(x) for x in line] for line in each]) for each in (change, back))
            return left * middle * right

        ends = [between(sign * arb(2) ** -24) for sign in (-1, 1)]
        pairs = zip(*(end.entries() for end in ends), strict=True)
        wide = arb_mat(size, size, [a.union(b) for a, b in pairs])
        found = multipliers.multipliers(wide, [multipliers.linear(1)])
        for end in ends:
            exact = multipliers.multipliers(end, [multipliers.linear(1)])
            assert all(any(agree(ball, value) for ball in found) for value in exact)
        assert all(float(ball.real.rad()) < 1e-3 for ball in found)
        for ball in found:
            assert ball.imag.is_zero()
    with pytest.raises(jets.CannotFollow):
        multipliers.multipliers(arb_mat([[arb(1), arb(0)], [arb(0), arb(0.5, 0.6)]]), [])


def full(rows: Sequence[Row], end: Sequence[Row], tangent: Sequence[int], replaced: int) -> Any:
    """What is known of a return, without a flow: the section is the last coordinate."""
    found = object.__new__(full_return.FullReturn)
    size = len(end)
    found.claim = SimpleNamespace(system=SimpleNamespace(section=size - 1, state=[f"x{i}" for i in range(size)]))
    found.live, found.tangent, found.checks = range(size), list(tangent), []
    found.end, found.rows = as_jets(end, 3), as_jets(rows, 3)
    found.replaced, found.has_level = replaced, replaced >= 0
    return found


@pytest.mark.parametrize("size", [3, 4, 5])
def test_a_whole_return(size: int) -> None:
    chance = random.Random(size)
    tangent = list(range(size - 1))
    replaced = 0 if size % 2 == 0 else -1
    variables = [TIME, *tangent]
    rows = [
        row(chance, variables, 3, {v: chance.uniform(-0.4, 0.4) + (1.6 if v == i else 0) for v in variables})
        for i in range(size)
    ]
    rows[-1] |= {(TIME,): arb(1.7)}
    angles = [arb(0.9), arb(1.9)]
    at = [acb(angle.cos(), angle.sin()) for angle in angles]

    def found(rows: Any) -> Any:
        known = full(rows, rows, tangent, replaced)
        lines = [known.lines(z) for z in at]
        matrix, second = known.monodromy(), known.second(at[0] * at[1], *([acb(1, v) for v in range(size + 1)],) * 2)
        return lines, matrix, second

    assert not broken_inclusions(found, (rows,), chance, 10)
    if size > 3:

        def parameters(rows: Any) -> Any:
            return [z.real + z.imag for z in full(rows, rows, tangent, replaced).stability()]

        assert not broken_inclusions(parameters, (rows,), chance, 6)

    def vectors(rows: Any) -> Any:
        known = full(rows, rows, tangent, replaced)
        direction, left = known.direction(at[0])
        return direction, left, known.coefficient(at[0])

    assert not broken_inclusions(vectors, (rows,), chance, 6)
    if size == 5:
        assert not broken_inclusions(
            lambda rows: elliptic.normal_form(full(rows, rows, tangent, replaced), at), (rows,), chance, 4
        )


LEVELS = {
    1: ("v3 = v0 * v0\nv4 = v1 * v2\nv5 = v3 + v4\nv6 = v5 + v2\nreturn v6", None),
    -1: ("v3 = v0 * v0\nv4 = v1 * v2\nv5 = v3 + v4\nv6 = v5 + v2\nreturn v6", None),
    0: ("v3 = v0 * v0\nv4 = v1 * v0\nv5 = v3 + v4\nv6 = v5 + v2\nreturn v6", (Fraction(1, 2), Fraction(3))),
}
"""w^2 + x y + y with a sign of w, and w^2 + x w + y in an interval."""


@pytest.mark.parametrize("sign", LEVELS)
def test_the_coordinate_that_follows_from_a_level(sign: int) -> None:
    """A jet in x and y on the level 2."""
    lines, between = LEVELS[sign]
    program = statement.Program.from_text(f"v0 = w\nv1 = x\nv2 = y\n{lines}")
    level = fixed_level.LevelSet(program, Fraction(2), 0, sign, between)

    def conserved(state: Sequence[Any]) -> Any:
        return program.at(dict(zip("wxy", state, strict=False)), state[0])[0]

    def found(x: Any, y: Any) -> Any:
        state = [jets.Jet({}, 3), jets.Jet({(): x, (1,): arb(1)}, 3), jets.Jet({(): y, (2,): arb(1)}, 3)]
        try:
            return [dict(each) for each in level.lifted(conserved, state, 100)]
        except jets.CannotFollow:
            return Refused()

    x, y = arb(0.25), arb(0.375)
    assert not broken_inclusions(found, (x, y), random.Random(5), 2, SMALL)
    w = found(x, y)[0][()]
    assert (w * w + (x * w if between else x * y) + y - 2).contains(0)
    assert (w > 0) is (sign >= 0)


def test_the_state_at_a_crossing() -> None:
    """On a step of known polynomials: the time, the state, its derivatives by the beginning."""
    chance = random.Random(6)
    variables = (0, 1)
    coefficients = {
        a: [numbers(3, chance), [arb(-0.5 * (a == ())) + (arb(0.1) if a else 0), arb(1.25 * (a == ())), arb(0.1)]]
        for a in monomials(variables, 2)
    }
    field = SimpleNamespace(section=1, velocity=lambda state: [state[1] * arb(0.5), state[0] * arb(0.25) + jets.Jet(
        {(): arb(1)}, state[0].degree)])  # fmt: skip

    def found(coefficients: Any) -> Any:
        polynomials = [
            jets.Jet({a: arb_poly(parts[i]) for a, parts in coefficients.items()}, 2) for i in range(2)
        ]  # fmt: skip
        step = SimpleNamespace(
            duration=arb(1), polynomials=polynomials, section_slope=polynomials[1][()].derivative(),
            at=lambda time: [each.map(lambda p: p(time)) for each in polynomials],
        )  # fmt: skip
        state, moment = crossing.crossing_state(field, step, (arb(0.25), arb(0.75)))
        return [dict(each) for each in state], moment

    assert not broken_inclusions(found, (coefficients,), chance, 16, arb(2) ** -24)


def test_a_monodromy_matrix_is_that_of_all_legs() -> None:
    chance = random.Random(7)
    known = known_bifurcation(-1, 2, chance, signs=(-1, 1))
    attempt = synthetic(
        bifurcation._Proof, claimed("periodic-pitchfork", (known.eigenvector,), symmetry=(-1, 1)),
        returning(known.derivatives, (Fraction(0),) * 2, 2), 2,
    )  # fmt: skip
    ends = [[row(chance, (0, 1, 2), 1) for _ in range(3)] for _ in range(2)]

    def found(ends: Any) -> Any:
        return attempt.monodromy(legs.Return([as_jets(each, 1) for each in ends], 1, {}))

    assert not broken_inclusions(found, (ends,), chance, 12)
    signs = attempt.statement.symmetry
    first, second = (arb_mat([[each[j,] for j in range(3)] for each in end]) for end in ends)
    product = second * first
    matrix = found(ends)
    assert all(agree(matrix[i, j], product[i, j] * signs[i]) for i in range(3) for j in range(3))


@pytest.mark.parametrize("size", [1, 2])
def test_coefficients_of_births(size: int) -> None:
    """Of rows of E in the coordinates of Fix(R), those that R negates, and time; the level is coordinate 1."""
    chance = random.Random(8)
    kernel, places = tuple(range(2, 2 + size)), (0, 1)
    attempt = object.__new__(births._Proof)
    system = SimpleNamespace(kernel=kernel, section=2 + size, level=lambda state: state[1])
    attempt.claim = SimpleNamespace(system=system, places=places)
    attempt.places, attempt.time, attempt.kept, attempt.weights = places, 2, tuple(range(size)), numbers(size, chance)
    variables = [TIME, 0, 1, *kernel]
    even = [
        row(chance, variables, 3, {0: 1.3, 1: 0.2, TIME: 0.3}),
        row(chance, variables, 3, {0: -0.2, 1: 0.4, TIME: 1.5}),
    ]
    odd = [row(chance, variables, 3) for _ in range(size)]
    start = [row(chance, (0, 1, *kernel), 3, {i: 1.0}) for i in range(3 + size)]
    w = numbers(size, chance)

    def found(rows: Any, w: Any) -> Any:
        half = SimpleNamespace(start=as_jets(start, 3))
        given = as_jets(rows, 3)
        curve, side, kappa = attempt.coefficients(half, given, w)
        system = attempt.system(given, [arb(0.1), arb(0.2), arb(1), *w])
        return curve.enclosures, side.enclosures, kappa, attempt.left_kernel(given), attempt.block(given), system

    assert not broken_inclusions(found, ([*even, *odd], w), chance, 12)
    # Of the left kernel all that depends on the derivatives by what R negates.
    slopes = [{(k,): each[k,] for k in kernel} for each in odd]

    def of_slopes(slopes: Any) -> Any:
        rows = [each | slope for each, slope in zip(odd, slopes, strict=True)]
        half = SimpleNamespace(start=as_jets(start, 3))
        _, side, kappa = attempt.coefficients(half, as_jets([*even, *rows], 3), w)
        return attempt.left_kernel(as_jets([*even, *rows], 3)), side.enclosures, kappa

    if size > 1:
        assert not broken_inclusions(of_slopes, (slopes,), chance)


@pytest.mark.parametrize("crossings", [1, 6, 30])
@pytest.mark.parametrize("mirrored", [False, True])
def test_an_orbit_is_at_another_point_after_each_part_of_its_period(crossings: int, mirrored: bool) -> None:
    """One coordinate apart is enough, for every prime that divides the crossings; S is applied to what comes back."""
    known = known_bifurcation(-1, 2, random.Random(1), signs=(-1, 1))
    claim = claimed("periodic-pitchfork", (known.eigenvector,), symmetry=(-1, 1) if mirrored else None)
    claim = replace(claim, orbit=replace(claim.orbit, crossings=crossings))
    attempt = synthetic(bifurcation._Proof, claim, returning(known.derivatives, (Fraction(0),) * 2, 1), 1)
    point = [arb(0.5), arb(-0.25), arb(0)]
    zero = [*point, arb(0), arb(1), *[arb(0)] * 5][: attempt.time + 6]
    zero[attempt.time] = arb(1)
    primes = [q for q in (2, 3, 5) if crossings % q == 0]
    signs = (-1, 1, 1) if mirrored else (1, 1, 1)

    def holds(between: Mapping[int, Sequence[arb]], counted: int = crossings) -> bool:
        states = {q: [jets.Jet({(): x}, 1) for x in state] for q, state in between.items()}
        checks, _ = attempt.check_orbit(legs.Return([], counted, states), zero)
        return all(check.holds for check in checks)

    same = [x * sign for x, sign in zip(point, signs, strict=True)]
    away = {q: [same[0] + 1, *same[1:]] for q in primes}
    assert holds(away)
    assert not holds(away, crossings + 1)
    for q in primes:
        assert not holds({key: state for key, state in away.items() if key != q})
        assert not holds(away | {q: same})
        for place in range(3):
            assert holds(away | {q: [x + (i == place) for i, x in enumerate(same)]})
            assert not holds(away | {q: [x + arb(0.25, 0.5) * (i == place) for i, x in enumerate(same)]})
    attempt.statement = replace(attempt.statement, direction=-1)
    assert not holds(away)
