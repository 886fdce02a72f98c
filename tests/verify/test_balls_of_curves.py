"""Births, units and crossings of curves: balls of points give balls that hold them, exactly where that can be told."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.inclusion import broken_inclusions
from support.random_segments import ball, number
from support.thresholds import unsound_balls
from support.within import within

from orbitproof.shared.claims import BirthPiece
from orbitproof.shared.systems import (
    AROUND,
    CR3BP,
    CR3BP_AXIAL,
    HILL,
    HILL_VARIED,
    VERTICAL,
    ParameterRange,
    ReversibleSystem,
)
from orbitproof.verify.curve import PieceLimits, birth_piece, doubled_family, doubling_birth, lifted_family, other_point
from orbitproof.verify.curve import lyapunov_family as planar
from orbitproof.verify.curve import vertical_family as vertical
from orbitproof.verify.curve.bifurcations_on_it import CertifiedPoint
from orbitproof.verify.curve.birth_piece import BirthTube
from orbitproof.verify.curve.followed import Crossing
from orbitproof.verify.curve.libration_point import derived_parameter
from orbitproof.verify.curve.other_point import enclose_crossings, meets_section_once
from orbitproof.verify.curve.proved_intervals import ProvedInterval
from orbitproof.verify.evidence import Checklist, IntegrationFailure, NotEstablishedError, enclose
from orbitproof.verify.oracle import ORACLE

BITS = 160
MU = {"mu": Fraction(1, 80)}
LITTLE = Fraction(1, 2**20)

precision = within(lambda: ctx.workprec(BITS))


def random_birth(chance: random.Random) -> BirthTube:
    rows = [[number(chance), Fraction(0), number(chance), Fraction(0), number(chance)] for _ in range(4)]
    directions = ((number(chance) - 3, number(chance)), (number(chance), number(chance) + 3))
    widths = tuple(Fraction(chance.randint(16, 64), 64) for _ in range(4))
    piece = BirthPiece("birth", directions, Fraction(3, 8), tuple(map(tuple, rows)), widths)
    end = Fraction(3, 4)
    return BirthTube(piece, ProvedInterval(-end, end, tuple(w / 4 for w in widths), (Fraction(1, 64),) * 4))


@pytest.mark.parametrize("seed", range(6))
def test_states_of_a_birth_are_those_of_its_formulas_and_lead_back(seed: int) -> None:
    chance = random.Random(seed)
    tube = random_birth(chance)
    piece = tube.piece
    for s in (Fraction(chance.randint(1, 47), 64), Fraction(1, 2), Fraction(-1, 4)):
        errors = [chance.choice([-1, 1]) * bound for bound in tube.proved.deviation]
        curve = [sum((c * s**n for n, c in enumerate(row)), Fraction(0)) for row in piece.polynomial]
        x, z, vy, b = (value + error for value, error in zip(curve, errors, strict=True))
        vx, vz = (piece.half_width * s * (base + turn * b) for base, turn in piece.directions)
        exact = {"x": x, "z": z, "vx": vx, "vy": vy, "vz": vz}
        found = tube.states(enclose(s))
        assert all(agree(found[name], enclose(value)) for name, value in exact.items())
        local = tube.local({name: enclose(value) for name, value in exact.items()})
        assert local is not None
        assert agree(local[0], enclose(s))
        assert all(agree(a, enclose(value)) for a, value in zip(local[1], (x, z, vy, b), strict=True))
        point, direction = (
            {name: enclose(exact[name]) for name in names} for names in (("x", "z", "vy"), ("vx", "vz"))
        )
        away = tube.at_birth(point, direction)
        assert away is not None
        assert all(agree(a, enclose(value)) for a, value in zip(away, (x, z, vy, b), strict=True))
        # At the edge of the tube in all directions but one, and there on either side.
        edge = [value + width - LITTLE for value, width in zip(curve, piece.tube, strict=True)]
        assert tube.contains(enclose(s), list(map(enclose, edge)))
        for place in range(4):
            for shift in (2 * LITTLE, -2 * piece.tube[place]):
                beyond = [value + shift * (i == place) for i, value in enumerate(edge)]
                assert not tube.contains(enclose(s), list(map(enclose, beyond)))
    curve, end = [enclose(row[0]) for row in piece.polynomial], enclose(tube.proved.end)
    assert tube.contains(arb(0), curve)
    assert not tube.contains(end, [polynomial(end) for polynomial in tube._polynomials])
    assert not tube.contains(arb(0), curve[:3])
    state = {name: ball(chance, 0.5, 1) for name in ("x", "z", "vx", "vy", "vz")}
    assert not broken_inclusions(tube.local, (state,), chance)
    assert not broken_inclusions(lambda state: tube.at_birth(state, state), (state,), chance)
    known = replace(tube, proved=replace(tube.proved, deviation=(Fraction(0),) * 4))
    assert not broken_inclusions(known.states, (ball(chance, 0.1, 0.5),), chance)
    resting = {**state, "vx": arb(0), "vz": arb(0)}
    assert tube.local(resting) is None
    assert tube.at_birth(resting, resting) is None


@pytest.mark.parametrize("seed", range(3))
def test_a_ball_is_in_the_tube_of_a_birth_with_all_of_its_points(seed: int) -> None:
    """Along it, up to the end of what is proved, and across it."""
    chance = random.Random(seed)
    tube = random_birth(chance)
    straight = replace(tube.piece, polynomial=tuple((row[0],) for row in tube.piece.polynomial))
    for each in (tube, replace(tube, piece=straight)):
        place = [enclose(row[0]) for row in each.piece.polynomial]
        for where in ((0,), (1,)):
            assert not unsound_balls(
                lambda given, each=each: each.contains(*given), (arb(0), place), chance,
                where=lambda path, where=where: path[:1] == where,
            )  # fmt: skip


def proof_of(piece: BirthPiece, reach: Fraction) -> Any:
    return birth_piece._Proof(CR3BP_AXIAL, MU, piece, reach, ORACLE, PieceLimits(64, 24, 8))


@pytest.mark.parametrize("seed", range(6))
def test_the_points_of_a_birth_are_off_the_plane_up_to_the_last_bit(seed: int) -> None:
    chance = random.Random(seed)
    piece = random_birth(chance).piece
    x, (_, *others), *rest = piece.polynomial
    reach = Fraction(chance.randint(1, 64), 64)
    most = piece.tube[1] + sum((abs(value) * reach ** (n + 1) for n, value in enumerate(others)), Fraction(0))
    for first, wanted in (
        (most + LITTLE, True),
        (-most - LITTLE, True),
        (most - LITTLE, False),
        (LITTLE - most, False),
    ):
        moved = replace(piece, polynomial=(x, (first, *others), *rest))
        assert proof_of(moved, reach).is_off_plane() == wanted


@pytest.mark.parametrize("differs", ["x", "vy", "vz", "", "plane"])
def test_of_the_ends_of_a_birth_one_coordinate_has_to_differ_and_its_points_are_off_the_plane(differs: str) -> None:
    """All of it holds but `side`: the axial orbits need not be off the plane, or may be two that are one."""
    chance = random.Random(differs)
    piece = random_birth(chance).piece
    x, (_, *others), *rest = piece.polynomial
    height = Fraction(0) if differs == "plane" else Fraction(9)
    proof = proof_of(replace(piece, polynomial=(x, (height, *others), *rest)), Fraction(1, 2))
    arithmetic = proof.limits.arithmetic(proof.tube)

    def element(size: Fraction, other: Fraction) -> Any:
        """An odd part between size - other and size + other, and a large even one."""
        return arithmetic.polynomial({(0,) * 4: [Fraction(7), size], (0, 1, 0, 0): [Fraction(5), 2 * other]})

    half = Fraction(1, 2)
    different, nearly, same = (
        element(*each) for each in ((half, half - LITTLE), (half, half + LITTLE), (0 * half, half))
    )
    state = dict.fromkeys(CR3BP_AXIAL.state, different)
    state |= {name: chance.choice([nearly, same]) for name in ("x", "vy", "vz")}
    if differs:
        state["x" if differs == "plane" else differs] = different
    if differs in ("x", "vy", "vz"):
        proof._check_side(Checklist(), state)
    else:
        with pytest.raises(NotEstablishedError) as caught:
            proof._check_side(Checklist(), state)
        assert caught.value.reason.condition == "side"


def test_points_in_other_units_hold_those_of_all_points() -> None:
    chance = random.Random(0)
    point = {"x": ball(chance, 0.7, 0.8), "z": ball(chance), "vy": ball(chance), "vz": ball(chance, 0.1, 0.5)}
    assert not broken_inclusions(lambda point: doubled_family.in_hill_units(MU["mu"], point), (point,), chance)
    around, above = AROUND["L1"], VERTICAL["L1"]
    assert not broken_inclusions(lambda point: planar.in_units_of_orbit(around, MU, point), (point,), chance)
    assert not broken_inclusions(lambda point: vertical.in_units_of_vertical_orbit(above, MU, point), (point,), chance)
    lifted = {"eps2": ball(chance, 0.1, 0.2), "x": ball(chance, 0.7, 0.8), "vy": ball(chance)}
    for of_point in (
        lambda point: vertical.vertical_jacobi_constant(above, MU, point),
        lambda point: lifted_family.lifted_jacobi_constant(MU, point),
        lambda point: planar.jacobi_constant(around, MU, {**point, "eps": point["x"] - 1}),
    ):
        assert not broken_inclusions(of_point, (lifted,), chance)
    state = {name: ball(chance, 0.2, 0.9) for name in HILL_VARIED.state}
    h = ball(chance, 0.2, 0.3)
    assert not broken_inclusions(doubling_birth._at_other_point, (h, state), chance, 20)
    assert not broken_inclusions(doubling_birth._from_hill_units, (h, state), chance)


def test_levels_and_directions_in_other_units_are_those_of_their_states() -> None:
    """The Jacobi constant of the state itself; of a variation what is left beside a multiple of the field."""
    chance, (program, inputs) = random.Random(2), (CR3BP.first_integral_program, (*CR3BP.state, "mu"))
    assert program is not None

    def level(**state: arb) -> arb:
        known = dict.fromkeys(CR3BP.state, arb(0)) | state | {"mu": enclose(MU["mu"])}
        (value,) = program.evaluate([known[name] for name in inputs], enclose, lambda x, p: x ** enclose(p))
        return arb(value)

    size, x, vy = ball(chance, 0.1, 0.2), ball(chance, 0.2, 0.3), ball(chance)
    point = {"eps2": size, "x": x, "vy": vy}
    x_l = planar.libration_point(VERTICAL["L2"], MU)
    assert x_l is not None
    found = vertical.vertical_jacobi_constant(VERTICAL["L2"], MU, point)
    assert found is not None
    assert agree(found, level(x=x_l + size * x, vy=size * vy, vz=size.sqrt()))
    assert agree(lifted_family.lifted_jacobi_constant(MU, point), level(x=x, vy=vy, vz=size.sqrt()))
    found = planar.jacobi_constant(AROUND["L2"], MU, {"eps": size, "vy": vy})
    assert found is not None
    assert agree(found, level(x=x_l + size, vy=size * vy))
    h, state = ball(chance, 0.2, 0.3), {name: ball(chance, 0.2, 0.9) for name in HILL_VARIED.state}
    at, direction = doubling_birth._at_other_point(h, state)
    field = HILL.vector_field([at[name] for name in HILL.state], [h])
    rates = dict(zip(HILL.state, field, strict=True))
    assert all(agree(at[name], state[name]) for name in HILL.state)
    for name, own in (("vx", "vxi"), ("vz", "vzeta")):
        left = state[f"d{own}"] * rates["eta"] - rates[own] * state["deta"]
        assert agree(direction[name], left / rates["eta"])


@pytest.mark.parametrize("place", range(3))
def test_a_crossing_of_which_one_coordinate_is_not_known_is_not_enclosed(
    place: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = planar_system(lambda s, p: (s[1], -p[0] * s[0], 0 * s[2]), ("y", "vy", "u"), (-1, 1, -1), "w")
    point, of_element, asked = {"vy": arb(1), "w": arb(2)}, other_point._ball, list(range(6))

    def unknown(element: Any) -> arb:
        return arb("nan") if asked.pop(0) == 3 + place else of_element(element)

    assert enclose_crossings(ORACLE, system, {}, point, 2) is not None
    monkeypatch.setattr(other_point, "_ball", unknown)
    assert enclose_crossings(ORACLE, system, {}, point, 2) is None
    assert not asked


def test_a_function_that_changes_its_sign_at_a_pole_has_no_zero_there() -> None:
    """1/x increases from 0 to 0 by way of infinity; x + x^3 has its zero there."""
    for equation, is_found in ((lambda x, _: (1 / x[0],), False), (lambda x, _: (x[0] + x[0] ** 3,), True)):
        definition = SimpleNamespace(equation=equation, interval=lambda given: (Fraction(-3), Fraction(5)))
        system: Any = SimpleNamespace(fixed_parameters=(), derived_parameters={"y": definition})
        if is_found:
            assert derived_parameter(system, "y", {}, 40).ball.contains(0)
        else:
            with pytest.raises(IntegrationFailure):
                derived_parameter(system, "y", {}, 40)


def test_a_derived_parameter_that_is_known_badly_is_known_on_both_sides() -> None:
    for name, system in AROUND.items():
        exact = planar.libration_point(system, MU)
        assert exact is not None
        for bits in (8, 9, 10, 17):
            root = derived_parameter(system, "x_l", MU, bits)
            assert root.ball.contains(exact), name
            assert root.ball.contains(enclose(root.lower))
            assert root.ball.contains(enclose(root.upper))
            assert root.radius == (root.upper - root.lower) / 2 <= Fraction(1, 2**bits)
            assert enclose(root.middle - root.radius) <= exact <= enclose(root.middle + root.radius)


def test_units_are_those_of_the_sizes() -> None:
    """What is carried there and back is the same: X = x_l + eps x and so on, by 16.1, 16.6 and 17.1."""
    chance = random.Random(1)
    for name in ("L1", "L2"):
        x_l = planar.libration_point(AROUND[name], MU)
        assert x_l is not None
        eps, x, vy = ball(chance, 0.1, 0.2), ball(chance), ball(chance)
        found = planar.in_units_of_orbit(AROUND[name], MU, {"x": x_l + eps, "vy": eps * vy})
        assert found is not None
        assert agree(found["eps"], eps)
        assert agree(found["vy"], vy)
        there = {"x": x_l + eps**2 * x, "vy": eps**2 * vy, "vz": -eps}
        found = vertical.in_units_of_vertical_orbit(VERTICAL[name], MU, there)
        assert found is not None
        assert all(agree(found[key], value) for key, value in (("eps2", eps**2), ("x", x), ("vy", vy)))
        assert vertical.in_units_of_vertical_orbit(VERTICAL[name], MU, {**there, "vz": arb(0)}) is None
        assert planar.in_units_of_orbit(AROUND[name], MU, {"x": x_l, "vy": vy}) is None
    orbit = doubled_family.in_hill_units(MU["mu"], {"x": ball(chance), "z": ball(chance), "vy": ball(chance)})
    back = doubling_birth._from_hill_units(orbit["h"], {**orbit, "zeta": orbit["zeta"]})
    again = doubled_family.in_hill_units(MU["mu"], back)
    assert all(agree(again[key], value) for key, value in orbit.items())


@pytest.mark.parametrize("seed", range(8))
def test_the_variation_of_a_doubling_is_the_kernel_whatever_rows_are_regular(seed: int) -> None:
    """Variations arrive as columns of a matrix of rank 2, with dveta = 1 in its kernel; one row may be 0."""
    chance = random.Random(seed)
    kernel = [ball(chance), ball(chance), arb(1)]
    rows = [[ball(chance), ball(chance)] for _ in range(3)]
    if seed % 2:
        rows[seed % 3] = [arb(0), arb(0)]
    rows = [[a, b, -(a * kernel[0] + b * kernel[1])] for a, b in rows]
    certified = CertifiedPoint(
        "d", "period_tupling", 2, point={name: ball(chance) for name in ("x", "z", "vy")}, parameters=MU
    )

    def carried(rows: Any) -> Any:
        def follow(system: Any, parameters: Any, point: Any, crossings: int) -> list[Crossing]:
            start = [point.get(name, arb(1)) for name in doubled_family.VARIED]
            arrives = [sum((a * x for a, x in zip(row, start, strict=True)), arb(0)) for row in rows]
            return [Crossing(dict(zip(doubled_family.VARIED, arrives, strict=True)), arb(1))]

        return doubled_family.doubling_with_variation(certified, follow)

    found = carried(rows)
    assert isinstance(found, dict)
    assert all(agree(found[name], value) for name, value in zip(("dxi", "dzeta"), kernel, strict=False))
    assert not broken_inclusions(carried, (rows,), chance, 9)
    alike = [[a, 2 * a, -3 * a] for a, _, _ in rows]
    assert isinstance(carried(alike), str)


def planar_system(field: Any, state: tuple[str, ...], signs: tuple[int, ...], parameter: str) -> ReversibleSystem:
    """With the section y = 0; u is a constant of motion that counts for nothing."""
    return ReversibleSystem(
        name="planar-system",
        title="two coordinates",
        state=state,
        parameters={parameter: ParameterRange(None, None)},
        vector_field=field,
        reversing_symmetry=signs,
        section="y",
        family_parameter=parameter,
    )


def test_crossings_of_balls_hold_those_of_all_points() -> None:
    """y'' = -w y: the times n pi/w^(1/2) and the states y' = (-1)^n y'(0) depend on one number each."""
    system = planar_system(lambda s, p: (s[1], -p[0] * s[0], 0 * s[2]), ("y", "vy", "u"), (-1, 1, -1), "w")
    chance = random.Random(0)
    point = {"vy": ball(chance, 1, 2), "w": ball(chance, 1, 2)}

    def crossings(point: Any) -> Any:
        return enclose_crossings(ORACLE, system, {}, point, 2)

    found = crossings(point)
    assert found is not None
    for n, each in enumerate(found, start=1):
        assert agree(each.time, n * arb.pi() / point["w"].sqrt())
        assert agree(each.state["vy"], (-1) ** n * point["vy"])
    assert not broken_inclusions(crossings, (point,), chance)


@pytest.mark.parametrize("speed", ["1", "2", "8", "64"])
def test_an_orbit_that_comes_back_to_the_section_in_the_span_is_not_said_to_meet_it_once(speed: str) -> None:
    """x' = c x^2 and y' = 1 - (x - 1)^2/9 from x = 1: y grows, falls, and is 0 again soon before x is infinite."""
    field = lambda s, p: (p[0] * s[0] ** 2, 1 - (s[0] - 1) ** 2 / 9, 0 * s[2])  # noqa: E731
    system = planar_system(field, ("x", "y", "u"), (1, -1, -1), "c")
    c = arb(speed)
    for near in (1, -1):
        # y is 0 again at the t with x = 1/(1 - c t), near enough 0.93/c.
        state = {"x": arb(1), "y": arb(0), "u": arb(0)}
        assert not meets_section_once(system, {"c": near * c}, state, arb("0.97") / c)
        assert meets_section_once(system, {"c": near * c}, state, arb("0.01") / c)
        assert not meets_section_once(system, {"c": near * c}, {**state, "x": arb(4)}, arb("0.01") / c)
        assert meets_section_once(system, {"c": near * c}, state, -arb("0.01") / c)
        assert not meets_section_once(system, {"c": near * c}, state, arb(0, 1))


@pytest.mark.parametrize("name", AROUND)
def test_the_libration_point_is_where_the_force_vanishes(name: str) -> None:
    x_l, mu = planar.libration_point(AROUND[name], MU), enclose(MU["mu"])
    assert x_l is not None
    to_larger, to_smaller = x_l + mu, x_l + mu - 1
    force = x_l - (1 - mu) * to_larger / abs(to_larger) ** 3 - mu * to_smaller / abs(to_smaller) ** 3
    assert force.contains(0)
    assert x_l.rad() < arb(2) ** (8 - BITS)
    c = vertical.stiffness_at_rest(VERTICAL[name], MU)
    assert agree(c, (1 - mu) / abs(to_larger) ** 3 + mu / abs(to_smaller) ** 3)
