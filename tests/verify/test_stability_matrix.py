"""The stability matrix along a curve contains what independent integrations find."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from math import floor, log2
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_series, ctx, fmpq
from scipy.integrate import solve_ivp
from support.skew_products import SkewProduct, half_period
from support.stability_cases import (
    HALO_INTERVALS,
    HALO_LIMITS,
    PIECES,
    atlas,
    halo_functions,
    halo_piece,
    results,
)
from support.stored import function_of
from support.within import within

from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Piece
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import piece_from_json
from orbitproof.shared.systems import AROUND, CR3BP, FALKNER_SKAN, LIFTED
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.curve import PieceLimits, derived_parameter, prove_piece
from orbitproof.verify.evidence import IntegrationFailure, Proved
from orbitproof.verify.functions import REACH, bounded, function, known_part, restricted
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import HalfOrbits, first_integral
from orbitproof.verify.run.branch_tasks import RunLimits, attempts_of
from orbitproof.verify.stability import OtherPoint, TubeOfOrbits, matrix, orbit_functions
from orbitproof.verify.stability.along import level_around
from orbitproof.verify.stability.matrix import SHARE
from orbitproof.verify.stability.units import scales

_precision = within(lambda: ctx.workprec(160))


# The stability matrix


def variations(piece: Piece, s: Any, half_periods: Any) -> tuple[Any, Any]:
    """dy/dy(0) after one and two half periods of Falkner-Skan orbits, by an integrator that knows no enclosures."""
    points = np.array([[float(value) for value in piece.point(Fraction(float(x)))] for x in s])
    beta, y = points.T
    zero, one = np.zeros_like(y), np.ones_like(y)

    def field(_: float, flat: Any) -> Any:
        x, y, z, dx, dy, dz = flat.reshape(6, -1)
        rates = [y, z, beta * (y * y - 1) - x * z, dy, dz, beta * 2 * y * dy - dx * z - x * dz]
        return (np.array(rates) * half_periods).ravel()

    start = np.concatenate([zero, y, zero, zero, one, zero])
    found = solve_ivp(field, (0, 2), start, "DOP853", (1.0, 2.0), rtol=3e-14, atol=1e-15)
    ends = found.y.reshape(6, len(y), 2)
    return ends[4, :, 0], ends[4, :, 1]


def check_falkner_skan(
    piece: Piece, entry: Mapping[str, Any], interval: tuple[Fraction, Fraction], number: int
) -> None:
    """Random points of the curve: the independent derivatives lie in the enclosures, up to their own accuracy."""
    start, end = interval
    source = np.random.default_rng(1)
    s = source.uniform(float(start), float(end), number)
    middle, radius = float(start + end) / 2, float(end - start) / 2 * float(REACH)
    taus = [arb(float(value)) for value in (s - middle) / radius]
    names = ("half_period", "level")
    period, level = ([function_of(entry[name]).value(tau) for tau in taus] for name in names)
    sigma = [function_of(entry["characteristic"][0]).value(tau) for tau in taus]
    factor = [function_of(entry["first_factor"]).value(tau) for tau in taus]
    out, around = variations(piece, s, np.array([float(value) for value in period]))
    assert np.allclose([float(value) for value in level], [float(piece.point(Fraction(x))[0]) for x in s], rtol=1e-12)
    for enclosure, value in zip(sigma, around, strict=True):
        assert (enclosure + arb(0, 1e-9)).contains(arb(value))
        assert float(enclosure.rad()) < 1e-6
    ratios = np.array([float(value) for value in factor]) / out
    assert np.all(np.abs(ratios) > 0)
    assert np.all(np.sign(ratios) == np.sign(ratios[0]))


@pytest.mark.slow
def test_sigma_contains_independent_variations_at_random_points() -> None:
    """Sigma = dy(P^2)/dy at fixed beta: the velocity y' = z vanishes on the section."""
    for piece, result in zip(atlas().curve_pieces(), results(), strict=True):
        start, end = (parse_exact(text) for text in result["interval"])
        check_falkner_skan(piece, result["stability"], (start, end), 1000)


def test_another_interval_and_other_settings_enclose_the_same() -> None:
    piece = atlas().curve_pieces()[1]
    interval = (Fraction(1, 4), Fraction(1, 2))
    found = to_json(
        orbit_functions(
            TubeOfOrbits(atlas().system, {}, piece, interval, PieceLimits(60, 24, 16), "physical", ORACLE)
        ).stored
    )
    check_falkner_skan(piece, found, interval, 20)


@pytest.mark.parametrize("tube", [None, Fraction(1, 10**9)])
def test_the_half_return_of_a_proof_gives_the_same(tube: Fraction | None) -> None:
    """Also where the curve leaves the followed tube at complex s, and a wider one has to be followed."""
    piece = atlas().curve_pieces()[1]
    interval = (Fraction(1, 4), Fraction(1, 2))
    limits = PieceLimits(64, 24, 16)
    proof = prove_piece(atlas().system, {}, piece, interval, ORACLE, limits, slope_bits=64).outcome
    assert isinstance(proof, Proved)
    half = proof.results.half_return
    assert half is not None
    if tube is not None:
        # As if the proof had followed a tube about another curve.
        half = replace(half, state=tuple(element.scaled(Fraction(0)) for element in half.state))
    found = to_json(
        orbit_functions(TubeOfOrbits(atlas().system, {}, piece, interval, limits, "physical", ORACLE), half=half).stored
    )
    check_falkner_skan(piece, found, interval, 20)


@pytest.mark.slow
def test_planar_orbits_in_units_of_their_size_have_the_stability_of_the_three_body_problem() -> None:
    """The trace of the planar monodromy matrix of the CR3BP is 2 + 2 Sigma, and Sigma is continuous at size 0."""
    entry = PIECES["lyapunov"]
    system = AROUND["L1"]
    parameters = {key: parse_exact(value) for key, value in entry["parameters"].items()}
    piece = piece_from_json(entry["piece"], system, "piece")
    assert isinstance(piece, Piece)
    interval = (Fraction(1, 2), Fraction(3, 4))
    found = to_json(
        orbit_functions(
            TubeOfOrbits(system, parameters, piece, interval, PieceLimits(64, 22, 10), "physical", ORACLE)
        ).stored
    )
    functions = [function_of(found[name]) for name in ("half_period", "level")]
    (sigma,) = (function_of(part) for part in found["characteristic"])
    taus = [arb(number) / 32 for number in range(-30, 31, 6)]
    periods, sizes = (np.array([float(function_.value(tau)) for tau in taus]) for function_ in functions)
    s = [Fraction(5, 8) + Fraction(1, 8) * REACH * Fraction(number, 32) for number in range(-30, 31, 6)]
    points = np.array([[float(value) for value in piece.point(place)] for place in s]).T
    assert np.allclose(points[0], sizes, rtol=1e-9)
    mu = parameters["mu"]
    state = np.zeros((6, len(s)))
    x_l = float(derived_parameter(system, "x_l", parameters, 80).middle)
    state[0], state[4] = x_l + points[0], points[0] * points[1]
    whole, _ = monodromy(state, float(mu), 2 * periods)
    plane = np.moveaxis(whole[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], -1, 0)
    for tau, trace in zip(taus, np.trace(plane, axis1=1, axis2=2), strict=True):
        value = sigma.value(tau)
        assert (value + arb(0, 1e-5 * abs(trace))).contains(arb((trace - 2) / 2))
        assert float(value.rad()) < 0.05 * abs(trace)


def test_only_systems_that_scale_have_own_units() -> None:
    assert all(scales(system) for system in AROUND.values())
    assert not scales(FALKNER_SKAN)


@pytest.mark.parametrize("tube", [Fraction(1, 10**9), Fraction(1, 10**8)])
def test_a_curve_beside_its_tube_is_refused(tube: Fraction) -> None:
    """The polynomial is moved by 2e-8 across the curve: out of the tube, and in the wider one out of the half of it."""
    piece = atlas().curve_pieces()[1]
    ((first, *others),) = piece.polynomial
    moved = replace(piece, polynomial=((first + Fraction(2, 10**8), *others),), tube=(tube,))
    interval = (Fraction(1, 4), Fraction(1, 2))
    with pytest.raises(IntegrationFailure, match="in its tube" if tube == Fraction(1, 10**8) else "analytic"):
        orbit_functions(TubeOfOrbits(atlas().system, {}, moved, interval, PieceLimits(60, 24, 16), "physical", ORACLE))


def other_point(*rows: list[Fraction], error: Fraction = Fraction(0)) -> OtherPoint:
    """A curve with these coordinates as polynomials in sigma, and coordinates across it."""
    algebra = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=32)
    return OtherPoint.of([function(algebra, row, error) for row in rows])


@pytest.mark.parametrize("turn", [Fraction(0), Fraction(1, 2), Fraction(-1, 4), Fraction(-51, 50)])
def test_directions_are_known_across_a_curve_that_turns_back(turn: Fraction) -> None:
    """The curve (sigma/100, (sigma - turn)^2) comes back to almost where it came from, or would beyond its end."""
    curve = other_point([Fraction(0), Fraction(1, 100)], [turn**2, -2 * turn, Fraction(1)])
    algebra = curve.point[0].arithmetic
    assert isinstance(algebra, WideArithmetic)
    along, across = (
        [restricted(function(algebra, row, Fraction(0)), SHARE) for row in rows]
        for rows in (
            ([Fraction(1, 100)], [-2 * turn, Fraction(2)]),
            ([2 * turn, Fraction(-2)], [Fraction(1, 100)]),
        )
    )
    (zero,), (other,) = ([bounded(element) for element in vector] for vector in curve.modulo([along, across]))
    for n in range(-16, 17):
        tau = arb(n) / 16
        assert zero.value(tau).contains(0)
        assert zero.value(tau).rad() < 1e-3
        assert not other.value(tau).contains(0)


def test_a_curve_that_stops_has_no_directions_across() -> None:
    """At sigma = 1/2 the point (sigma - 1/2)^2 (1, 2 + sigma) does not move."""
    square = [Fraction(1, 4), Fraction(-1), Fraction(1)]
    for rows in ((square, [Fraction(1, 2), Fraction(-7, 4), Fraction(1), Fraction(1)]), ([Fraction(1)], [Fraction(2)])):
        with pytest.raises(IntegrationFailure, match="may not move"):
            other_point(*rows)
    with pytest.raises(IntegrationFailure, match="singular"):
        other_point([Fraction(0), Fraction(1)], [Fraction(0), Fraction(2)], error=Fraction(1)).modulo([])


# Tubes of different widths


STIFF = ((Fraction(-2), Fraction(1, 2)), (Fraction(1, 4), Fraction(3)))
"""y'' = - STIFF y over the Duffing oscillator: one pair of multipliers grows, the other stays on the unit circle."""
TURNED = ((Fraction(1), Fraction(1, 4), Fraction(1, 8)), (Fraction(1, 2), Fraction(1), Fraction(0)),
          (Fraction(0), Fraction(1, 4), Fraction(1)))  # fmt: skip
"""A frame none of whose columns is along the line y = 0."""


def two_rates() -> tuple[SkewProduct, TubeOfOrbits, float]:
    """Orbits about amplitude 1, in a tube whose polynomial is beside their curve; their amplitude by s less 1."""
    none = ((Fraction(0),) * 2,) * 2
    system = SkewProduct("two-rates", (STIFF, none, none), 0.5, 1.5)
    along = [Fraction(value).limit_denominator(2**20) for value in np.linalg.inv(np.array(TURNED, float))[:, 0]]
    share = Fraction(1, 32)
    # The curve is p = (1, along_1/along_0, along_2/along_0) share s.
    polynomial = tuple(
        (Fraction(0), share * along[j] / along[0] + beside) for j, beside in ((1, Fraction(1, 2**33)), (2, Fraction(0)))
    )
    piece = Piece("piece", "regular", (Fraction(1), Fraction(0), Fraction(0)), TURNED, share, polynomial,
                  (Fraction(1, 2**32), Fraction(1, 2**33)), "physical")  # fmt: skip
    tube = TubeOfOrbits(
        system.system, {}, piece, (Fraction(-1), Fraction(1)), PieceLimits(64, 22, 12), "physical", ORACLE
    )
    return system, tube, float(share / along[0])


def test_tubes_of_different_widths_on_both_halves_give_the_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """The stability parameters are cos(2 T r^(1/2)), T the half period of the oscillator, r an eigenvalue of STIFF."""
    widths: list[list[Fraction]] = []
    chosen = matrix._as_wide
    monkeypatch.setattr(matrix, "_as_wide", lambda *given: widths.append(chosen(*given)) or widths[-1])
    _, tube, share = two_rates()
    found = orbit_functions(tube).stored
    (around,) = widths
    # Neither tube has one width, and none of the second is one of the first.
    assert max(around) >= 8 * min(around)
    assert not set(around) & {8 * Fraction(2) ** floor(log2(width)) for width in tube.piece.tube}
    rates = np.linalg.eigvals(np.array(STIFF, float)).astype(complex) ** 0.5
    for tau in np.linspace(-1, 1, 9):
        time = half_period(1 + share * float(REACH) * tau)
        first, second = np.cos(2 * time * rates)
        for function_, value in zip(found.characteristic, (first + second, first * second), strict=True):
            enclosure = function_.enclosed.value(arb(tau))
            assert (enclosure + arb(0, 1e-11 * abs(value))).contains(arb(value.real))
            assert enclosure.rad() < 1e-6 * abs(value)


@pytest.mark.parametrize("case", ["one parameter", "two", "axial"])
@pytest.mark.parametrize("attempt", [0, 1])
def test_the_second_half_has_fewer_bits_from_an_error_on(case: str, attempt: int) -> None:
    """44 - floor(log2 e), at least 64: of all formats that lists are asked for with, those of the table in 3.4."""
    system, tube, _ = two_rates()
    claimed = {"one parameter": atlas(), "two": system.atlas(4), "axial": replace(atlas(), system=LIFTED)}[case]
    precision = attempts_of(claimed, RunLimits({}, stability=True))[attempt]["precision"]
    assert precision == {"one parameter": 72, "two": 88, "axial": 108}[case] + 48 * attempt
    tube = replace(tube, limits=replace(tube.limits, precision=precision))
    least = Fraction(2) ** (45 - precision)
    for error, fewer in ((least, 1), (least * Fraction(127, 128), 0), (2 * least, 2), (least / 2**30, 0)):
        assert tube._format(Fraction(1, 2**20), error).bits == precision - fewer
    assert tube._format(Fraction(1, 2**20), Fraction(1, 2**12)).bits == 64
    assert tube._format(Fraction(1, 2**20)).bits == precision


# The CR3BP


def monodromy(state: Any, mu: float, times: Any) -> Any:
    """The derivative of the flow, shape (6, 6, points), and the states there, by complex steps of an integrator."""
    step = 1e-30
    number = state.shape[1]
    start = np.repeat(state[:, None, :], 6, axis=1).astype(complex)
    for column in range(6):
        start[column, column] += 1j * step

    def field(_: float, flat: Any) -> Any:
        values = CR3BP.vector_field(list(flat.reshape(6, 6, number)), [mu])
        return (np.array(values) * times).ravel()

    end = (
        solve_ivp(field, (0, 1), start.ravel(), "DOP853", (1.0,), rtol=1e-12, atol=1e-15).y[:, -1].reshape(start.shape)
    )
    return end.imag / step, end[:, 0].real


def on_section(derivative: Any, state: Any, mu: float) -> Any:
    """Derivatives of the point where the orbits meet y = 0."""
    velocity = np.array(CR3BP.vector_field(list(state), [mu]))
    return derivative - velocity[:, None] * (derivative[1] / velocity[1])[None]


def invariants(matrix: Any) -> tuple[Any, Any, Any]:
    """Trace, sum of the principal minors of order 2, determinant; shape (n, n, points)."""
    stacked = np.moveaxis(matrix, -1, 0)
    trace = np.trace(stacked, axis1=1, axis2=2)
    second = (trace**2 - np.trace(stacked @ stacked, axis1=1, axis2=2)) / 2
    return trace, second, np.linalg.det(stacked)


def independent_coefficients(points: Any, mu: float, half_periods: Any) -> list[tuple[Any, Any]]:
    """a_1 and a_2, from D(P^2) on Fix(R), and from 1 + 2 B^T C in canonical coordinates on the level."""
    state = np.zeros((6, points.shape[1]))
    state[[0, 2, 4]] = points
    whole, there = monodromy(state, mu, 2 * half_periods)
    return_map = on_section(whole, there, mu)[np.ix_([0, 2, 4], [0, 2, 4])]
    trace, second, _ = invariants(return_map)
    first_way = trace - 1, second - (trace - 1)
    half, there = monodromy(state, mu, half_periods)
    half = on_section(half, there, mu)
    integral = CR3BP.first_integral
    assert integral is not None
    gradient = [
        integral([*(state[:i] + 0j), state[i] + 1e-30j, *(state[i + 1 :] + 0j)], [mu])[0].imag / 1e-30 for i in (0, 2)
    ]
    block_b = half[np.ix_([0, 2], [3, 5])]
    block_c = np.stack(
        [
            half[[3, 5], i] + half[[3, 5], 4] * (slope_ / (2 * state[4]))
            for i, slope_ in zip((0, 2), gradient, strict=True)
        ],
        axis=1,
    )
    sigma = np.eye(2)[:, :, None] + 2 * np.einsum("kip,kjp->ijp", block_b, block_c)
    return [first_way, invariants(sigma)[:2]]


def check_three_body(name: str, interval: tuple[Fraction, Fraction], limits: PieceLimits, number: int) -> None:
    piece, parameters = halo_piece(name)
    found = halo_functions(name, interval, limits)
    source = np.random.default_rng(2)
    start, end = interval
    s = source.uniform(float(start), float(end), number)
    middle, radius = float(start + end) / 2, float(end - start) / 2 * float(REACH)
    taus = [arb(float(value)) for value in (s - middle) / radius]
    points = np.array([[float(value) for value in piece.point(Fraction(x))] for x in s]).T
    periods = np.array([float(function_of(found["half_period"]).value(tau)) for tau in taus])
    for coefficients in independent_coefficients(points, float(parameters["mu"]), periods):
        for stored, values in zip(found["characteristic"], coefficients, strict=True):
            function_ = function_of(stored)
            scale = max(1.0, float(np.max(np.abs(values))))
            for tau, value in zip(taus, values, strict=True):
                enclosure = function_.value(tau)
                assert (enclosure + arb(0, 1e-6 * scale)).contains(arb(value))
                assert float(enclosure.rad()) < 1e-2 * scale


@pytest.mark.parametrize("name", ["symmetric", pytest.param("regularised", marks=pytest.mark.slow)])
def test_sigma_of_halo_orbits_contains_independent_monodromy(name: str) -> None:
    """In both coordinates, with 0 of a symmetric piece inside; D(P^2) on Fix(R), and 1 + 2 B^T C."""
    check_three_body(name, HALO_INTERVALS[name], HALO_LIMITS[name], 50)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["symmetric", "regularised"])
def test_sigma_of_whole_pieces_contains_independent_monodromy(name: str) -> None:
    check_three_body(name, (Fraction(-1), Fraction(1)), PieceLimits(96, 40, 48), 1000)


def test_of_a_known_level_the_part_on_the_curve_alone_is_taken() -> None:
    """Its value at omega = 0 and its derivatives there lie within the bounds of their own grades."""
    lines = {"x": ("0.99", "0.002"), "z": ("0.01", "0.001"), "vy": ("0.7", "-0.03")}
    across = {"x": (0.001, 0), "z": (0, 0.002), "vy": (0.1, 0.1)}
    mu, program = Fraction(1, 80), CR3BP.first_integral_program
    assert program is not None

    def element(arithmetic: WideArithmetic, name: str, share: int, away: Fraction) -> Series:
        terms = [share * Fraction(value) for value in across[name]]
        start, slope = map(Fraction, lines[name])
        line = arithmetic.polynomial({(0, 0): [start + away, slope], (1, 0): terms[0], (0, 1): terms[1]})
        return line.widened(away)

    def points(bits: int, width: int, share: int, away: Fraction) -> dict[str, Series]:
        arithmetic = WideArithmetic(Grading((1, 1), 1), bits, 0, 0, width=width)
        return {"mu": arithmetic.constant(mu), **{name: element(arithmetic, name, share, away) for name in lines}}

    fine = points(160, 60, 0, Fraction(0))
    exact = first_integral(CR3BP, fine["mu"].arithmetic, fine)
    assert exact is not None
    one = WideArithmetic(Grading((1,), 0), 160, 0, 0, width=60)
    moved = Fraction(1, 2**20)
    on_curve = function(one, [a + (not n) * moved for n, a in enumerate(known_part(exact, 0))], moved)
    around = points(96, 20, 1, Fraction(1, 2**14))
    level = level_around(around, CR3BP, on_curve)
    whole = first_integral(CR3BP, around["mu"].arithmetic, around)
    assert level is not None
    assert whole is not None
    assert level.errors[1:] == whole.errors[1:]
    # On the curve the level is known better than the points are.
    assert level.errors[0] < 2**-18
    for sigma in (arb(n) / 5 for n in range(-5, 6)):
        known = [
            sum((arb(fmpq(a.numerator, a.denominator)) * sigma**n for n, a in enumerate(known_part(level, m))), arb(0))
            for m in range(3)
        ]
        for j, position in ((0, (1, 0)), (1, (0, 1))):
            values = {}
            for name, (start, slope) in lines.items():
                at = arb(start) + arb(slope) * sigma
                values[name] = arb_series(
                    [at, arb(Fraction(across[name][j]).numerator) / Fraction(across[name][j]).denominator], 2
                )
            state = [values.get(name, arb_series([0], 2)) for name in CR3BP.state]
            (found,) = program.evaluate(
                [*state, arb_series([arb(1) / 80], 2)],
                lambda value: arb_series([arb(value.numerator) / value.denominator], 2),
                lambda base, e: base ** (arb(e.numerator) / e.denominator),
            )
            assert abs(found[0] - known[0]) < arb(level.errors[0])
            assert abs(found[1] - known[level.arithmetic.grading.index[position]]) < arb(level.errors[1])


@pytest.mark.slow
def test_the_second_half_takes_the_level_of_the_first_with_its_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Near the Moon, in regularised coordinates: what the second integration takes as a constant of motion."""
    taken: list[Series] = []

    class Recorded(HalfOrbits):
        def __init__(self, *arguments: Any) -> None:
            taken.append(arguments[-1])
            super().__init__(*arguments)

    monkeypatch.setattr("orbitproof.verify.stability.matrix.HalfOrbits", Recorded)
    piece, parameters = halo_piece("regularised")
    limits = HALO_LIMITS["regularised"]
    tube = TubeOfOrbits(CR3BP, parameters, piece, HALO_INTERVALS["regularised"], limits, "regularised", ORACLE, "S")
    found = orbit_functions(tube).level
    (level,) = taken
    # The format of the second integration is no finer than that of functions along the curve.
    assert level.errors[0] >= found.errors[0] > 0
    own, known = bounded(found), known_part(level, 0)
    for tau in (arb(n) / 4 for n in range(-4, 5)):
        sigma = tau * SHARE.numerator / SHARE.denominator
        value = sum((arb(fmpq(a.numerator, a.denominator)) * sigma**n for n, a in enumerate(known)), arb(0))
        assert (value + arb(0, level.errors[0])).contains(own.value(tau).mid())
