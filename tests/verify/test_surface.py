"""Halo orbits over ranges of the mass: Hill's units, one integration for all masses, pieces glued."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from support.balls import agree
from support.claims import known
from support.stored import entry_of, values
from support.surface_cases import ONE, WHOLE, exactly, number, point_of

from orbitproof.explore.flow import flow_of
from orbitproof.shared.claims import Atlas, SurfacePiece, evaluate
from orbitproof.shared.formats import read_atlas
from orbitproof.shared.systems import CR3BP, HILL, MASS_PARAMETERS
from orbitproof.shared.systems.hill import hill_field, hill_integral
from orbitproof.verify.algebra import Grading, WideArithmetic
from orbitproof.verify.curve import PieceResult
from orbitproof.verify.evidence import NotProved, Proved, Reason, enclose, is_inside
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.surface import ProvedParts, SurfaceLimits, SurfaceReturn, enclose_surface, prove_surface_piece
from orbitproof.verify.surface import piece as surface_piece
from orbitproof.verify.surface.gluing import Sheet, read_sheet
from orbitproof.verify.surface.half_return import coordinate_terms

FAST = SurfaceLimits(60, 20, 5, 3)
NARROW = SurfaceLimits(52, 20, 3, 3)
PART = (Fraction(-1, 8), Fraction(1, 8))


@pytest.mark.parametrize("seed", range(5))
def test_hills_units_are_those_of_the_three_body_problem(seed: int) -> None:
    """Field and first integral at random points, in high precision."""
    source = random.Random(seed)
    with mpmath.workdps(60):
        h = mpmath.mpf(source.uniform(0.01, 0.79))
        mu = h**3
        state = [mpmath.mpf(source.uniform(-1, 1)) for _ in range(6)]
        own = [h * value for value in state]
        own[0] += 1 - mu
        power = lambda base, exponent: mpmath.power(base, number(exponent))  # noqa: E731
        field = CR3BP.program.evaluate([*own, mu], number, power)
        assert CR3BP.first_integral_program is not None
        (jacobi,) = CR3BP.first_integral_program.evaluate([*own, mu], number, power)
        for left, right in zip(hill_field(state, [h]), field, strict=True):
            assert abs(h * left - right) < mpmath.mpf(10) ** -50
        (level,) = hill_integral(state, [h])
        assert abs(level - (jacobi - (1 - mu) * (3 - mu)) / h**2) < mpmath.mpf(10) ** -45


def test_at_h_zero_the_equations_are_those_of_hills_lunar_problem() -> None:
    state = [0.3, -0.4, 1.2, 0.5, 0.6, 0.7]
    x, y, z, vx, vy, vz = state
    distance = 1.3
    wanted = [vx, vy, vz, 2 * vy + 3 * x - x / distance**3, -2 * vx - y / distance**3, -z - z / distance**3]
    assert list(hill_field(state, [0.0])) == pytest.approx(wanted, abs=1e-15)
    level = 3 * x * x - z * z + 2 / distance - (vx * vx + vy * vy + vz * vz)
    assert hill_integral(state, [0.0])[0] == pytest.approx(level, abs=1e-14)


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """One piece of L1 around the mass of the Earth and the Moon, h from 0.22 to 0.24."""
    return read_atlas(Path(__file__).parents[1] / "data" / "surface.json")


@pytest.fixture(scope="module")
def piece(atlas: Atlas) -> SurfacePiece:
    return atlas.surface_pieces()[0]


@pytest.fixture(scope="module")
def returned(piece: SurfacePiece) -> SurfaceReturn:
    return enclose_surface(HILL, piece, WHOLE, FAST, ORACLE)


@pytest.fixture(scope="module")
def proved(piece: SurfacePiece, returned: SurfaceReturn) -> PieceResult[ProvedParts]:
    """The proof with the integration above, which takes the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("orbitproof.verify.surface.piece.enclose_surface", lambda *_: returned)
        return prove_surface_piece(HILL, piece, WHOLE, ORACLE, FAST)


@pytest.mark.slow
def test_the_half_return_is_enclosed_for_all_masses(piece: SurfacePiece, returned: SurfaceReturn) -> None:
    """At random points of the box and random s, against orbits in high precision."""
    source = random.Random(1)
    with ctx.workprec(160):
        for _ in range(2):
            s = Fraction(source.randint(-1000, 1000), 1000)
            part = (s - Fraction(1, 500), s) if s > 0 else (s, s + Fraction(1, 500))
            kernel, level = returned.tables(part)
            p = [Fraction(source.randint(-1000, 1000), 1000) * radius for radius in piece.radii]
            start = point_of(piece, s, p)
            h = evaluate(piece.parameters["h"], s)
            image = half_return(start, h)
            # q_1 = v_zeta, q_2 = v_xi in this piece.
            for table, value in zip(kernel, (image[5], image[3]), strict=True):
                assert table.box[0, 0, 0].contains(value)
            assert level.box[0, 0, 0].contains(exactly(hill_integral(start, [number(h)])[0]))


def half_return(start: list[Any], h: Fraction) -> list[arb]:
    """The state at the first zero of eta, by mpmath's Taylor integrator, to about 20 digits."""
    with mpmath.workdps(30):
        flow = mpmath.odefun(lambda _, y: list(hill_field(y, [number(h)])), 0, start, tol=mpmath.mpf(10) ** -24)
        time = mpmath.findroot(lambda t: flow(t)[1], (1.3, 1.4), tol=mpmath.mpf(10) ** -44)
        return [exactly(value) + arb(0, 1e-18) for value in flow(time)]


def test_a_surface_piece_is_proved_for_all_its_masses(proved: PieceResult[ProvedParts]) -> None:
    assert isinstance(proved.outcome, Proved)
    parts = proved.outcome.results.parts
    assert (parts[0].start, parts[-1].end) == (-1, 1)
    assert all(a.end == b.start for a, b in pairwise(parts))
    assert {part.side for part in parts} == {"below"}
    names = ("poincare-map", "HC2", "HC3", "HC4", "point", "dH/dp_0", "h_fp'", "h_b''")
    assert all(name in part.enclosures for part in parts for name in names)


def test_the_certified_point_of_the_earth_moon_system_is_the_surfaces(
    piece: SurfacePiece, proved: PieceResult[ProvedParts], atlas: Atlas
) -> None:
    """A symmetry breaking that was certified in the CR3BP, at one mass: h(mu, 0) encloses it."""
    sheet = read_sheet(piece, "h", values([entry_of(proved)]))
    candidate = known("em1")
    mu = MASS_PARAMETERS["earth-moon"]
    assert candidate.parameters["mu"] == mu
    with ctx.workprec(160):
        low, high = Fraction(-1), Fraction(1)
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if evaluate(piece.parameters["h"], middle) ** 3 <= mu else (low, middle)
        xi, zeta, veta = sheet.point(low, high)
        h = enclose(mu).root(3)
        x, _, vy = candidate.centre
        slack = Fraction(1, 10**30)
        assert is_inside(zeta, slack)
        assert agree(1 - enclose(mu) + h * xi, enclose(x) + arb(0, 1e-25))
        assert agree(h * veta, enclose(vy) + arb(0, 1e-25))
        assert xi.rad() < 1e-7
        assert veta.rad() < 1e-7


def test_halo_orbits_found_by_shooting_lie_where_the_box_bends(piece: SurfacePiece) -> None:
    """Float64 orbits at several masses and heights: p_0 and p_2 are far inside P_0 and P_2, for every z in P_1."""
    flow = flow_of(HILL)
    sheet = Sheet(piece, piece.parameters["h"], ())
    for s, share in ((Fraction(-1), 1.0), (Fraction(1, 3), 0.9), (ONE, -1.0)):
        h = float(evaluate(piece.parameters["h"], s))
        z = share * float(piece.radii[1])
        unknowns = np.array([float(evaluate(piece.centre[0], s)), float(evaluate(piece.centre[2], s)), 1.35])
        for _ in range(8):
            x, vy, time = unknowns
            end = flow.derivative([x, 0.0, z, 0.0, vy, 0.0], time, [h])
            rows = [1, 3, 5]
            matrix = np.column_stack([end.state_transition[rows][:, [0, 4]], end.velocity[rows]])
            unknowns = unknowns - np.linalg.solve(matrix, end.state[rows])
        with ctx.workprec(128):
            p = sheet.offsets(s, s, [arb(unknowns[0]), arb(z), arb(unknowns[1])])
        assert float(p[1]) == pytest.approx(z)
        assert all(abs(float(p[j])) < float(piece.radii[j]) / 8 for j in (0, 2))


FALSE: dict[str, tuple[Callable[[SurfacePiece], SurfacePiece], str]] = {
    "the centre off the curve": (
        lambda p: replace(p, centre=((p.centre[0][0] + Fraction(1, 1000), *p.centre[0][1:]), *p.centre[1:])),
        "p_2",
    ),
    "a tampered polynomial": (
        lambda p: replace(p, centre=((p.centre[0][0], p.centre[0][1] * 2, *p.centre[0][2:]), *p.centre[1:])),
        "p_",
    ),
    "another mass": (lambda p: replace(p, parameters={"h": (Fraction(1, 4), p.parameters["h"][1])}), "p_"),
    "a centre out of the plane": (
        lambda p: replace(p, centre=(p.centre[0], (ONE / 2**60,), p.centre[2])),
        "negates zeta",
    ),
    "a frame that is not adapted": (
        lambda p: replace(p, frame=((p.frame[0][0], ONE / 2**90, p.frame[0][2]), *p.frame[1:])),
        "column of frame",
    ),
    "a box that is too large": (lambda p: replace(p, radii=tuple(r * 300 for r in p.radii)), ""),
}  # fmt: skip


def test_the_settings_of_the_refusals_prove_what_is_true(piece: SurfacePiece) -> None:
    assert prove_surface_piece(HILL, piece, PART, ORACLE, NARROW).is_proved


@pytest.mark.parametrize("name", FALSE)
def test_a_false_surface_piece_is_not_proved(name: str, piece: SurfacePiece) -> None:
    change, word = FALSE[name]
    result = prove_surface_piece(HILL, change(piece), PART, ORACLE, NARROW)
    assert isinstance(result.outcome, NotProved)
    assert word in result.outcome.reason.message


@pytest.mark.parametrize("interval", [(-2 * ONE, ONE), (ONE, ONE), (ONE, -ONE)])
def test_an_interval_outside_the_piece_is_refused(interval: tuple[Fraction, Fraction], piece: SurfacePiece) -> None:
    assert "no interval" in prove_surface_piece(HILL, piece, interval, ORACLE, FAST).stored.reason.message


def test_what_the_box_is_made_of(piece: SurfacePiece) -> None:
    """The terms that the integration starts from are those of the format, coordinate by coordinate."""
    source = random.Random(3)
    s = Fraction(source.randint(-99, 99), 99)
    p = [Fraction(source.randint(-99, 99), 99) for _ in range(3)]
    state = point_of(piece, s, p)
    for centre, row, index in zip(piece.centre, piece.frame, (0, 2, 4), strict=True):
        value = evaluate(centre, s)
        for exponents, polynomial in coordinate_terms(piece, row).items():
            factors = [base**power for base, power in zip(p, exponents, strict=True)]
            value += evaluate(polynomial, s) * factors[0] * factors[1] * factors[2]
        assert abs(number(value) - state[index]) < 1e-14


def test_tables_hold_for_every_s_of_a_part() -> None:
    """Of polynomials in s over an interval that is not [-1, 1]."""
    source = random.Random(6)
    scales = (Fraction(1, 8), Fraction(1, 16), Fraction(1, 4))
    arithmetic = WideArithmetic(Grading((2, 1, 2), 3), 80, 0, 4, width=5)
    for _ in range(20):
        start, end = sorted(Fraction(n, 16) for n in source.sample(range(-16, 17), 2))
        rows = [[Fraction(source.randint(-64, 64), 64) for _ in range(5)] for _ in range(2)]
        element = arithmetic.polynomial({(0, 0, 0): rows[0], (1, 0, 0): rows[1]})
        returned = SurfaceReturn((element,), element, arb(1), scales, (start, end), 1, "")
        part = sorted(start + (end - start) * Fraction(n, 16) for n in source.sample(range(17), 2))
        (table,), level = returned.tables((part[0], part[1]))
        for s in (*part, sum(part) / 2):
            t = (2 * s - start - end) / (end - start)
            value, slope = (evaluate(row, t) for row in rows)
            for found in (table, level):
                assert found.centre[0, 0, 0].contains(enclose(value))
                assert found.box[1, 0, 0].contains(enclose(slope / scales[0]))
                assert found.centre[1, 0, 0].contains(enclose(slope / scales[0]))


def test_the_tables_hold_on_all_of_the_box(piece: SurfacePiece, returned: SurfaceReturn) -> None:
    """They are those of half of the polydisc."""
    assert all(scale / 2 >= radius for scale, radius in zip(returned.scales, piece.radii, strict=True))


@pytest.fixture
def parts_at_will(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[Fraction, Fraction], bool]], None]:
    """Has the theorem hold on the parts that a function names, without an integration."""

    def where(holds: Callable[[Fraction, Fraction], bool]) -> None:
        results = SimpleNamespace(local=(arb(0),) * 3, side="below")

        def outcome(self: Any, part: tuple[Fraction, Fraction]) -> Any:
            reason = Reason("HC3", "it may vanish", "other radii")
            return SimpleNamespace(hypotheses=(), results=results) if holds(*part) else NotProved(reason)

        monkeypatch.setattr(surface_piece._Parts, "_outcome", outcome)
        monkeypatch.setattr(
            surface_piece, "enclose_surface", lambda *_: SimpleNamespace(steps=1, coordinates="", time=arb(1))
        )

    return where


def test_parts_are_halved_until_the_theorem_holds_on_all_of_them(parts_at_will: Any, piece: SurfacePiece) -> None:
    parts_at_will(lambda start, end: end - start <= Fraction(1, 4))
    found = prove_surface_piece(HILL, piece, WHOLE, ORACLE, FAST)
    assert isinstance(found.outcome, Proved), found.outcome.reason
    parts = found.outcome.results.parts
    assert (parts[0].start, parts[-1].end) == WHOLE
    assert all(a.end == b.start for a, b in pairwise(parts))
    for place in (Fraction(-99, 100), Fraction(-1, 3), Fraction(1, 3), Fraction(99, 100)):
        parts_at_will(lambda start, end, place=place: not start <= place <= end)
        outcome = prove_surface_piece(HILL, piece, WHOLE, ORACLE, FAST).outcome
        assert isinstance(outcome, NotProved)
        assert "it may vanish" in outcome.reason.message


def test_parts_that_are_asked_for_cover_the_interval(parts_at_will: Any, piece: SurfacePiece) -> None:
    parts_at_will(lambda start, end: True)
    zero, gap = Fraction(0), Fraction(1, 2**40)
    for sections, proved in (
        ([(-ONE, zero), (zero, ONE)], True), ([(-ONE, zero), (gap, ONE)], False),
        ([(-ONE, zero)], False), ([(gap - ONE, zero), (zero, ONE)], False),
    ):  # fmt: skip
        outcome = prove_surface_piece(HILL, piece, WHOLE, ORACLE, FAST, sections=sections).outcome
        assert isinstance(outcome, Proved) == proved
        assert isinstance(outcome, Proved) or "leave a gap" in outcome.reason.message


@pytest.mark.parametrize("zeta", [(ONE / 2**60,), (0 * ONE, ONE), (0 * ONE, 0 * ONE, -ONE / 2**60)])
def test_a_centre_out_of_the_plane_is_named_before_anything_is_followed(
    zeta: tuple[Fraction, ...], parts_at_will: Any, piece: SurfacePiece
) -> None:
    parts_at_will(lambda start, end: True)
    _, word = FALSE["a centre out of the plane"]
    changed = replace(piece, centre=(piece.centre[0], zeta, piece.centre[2]))
    outcome = prove_surface_piece(HILL, changed, WHOLE, ORACLE, FAST).outcome
    assert isinstance(outcome, NotProved)
    assert word in outcome.reason.message
