"""The proof of a piece covers the whole interval and the whole tube, and its bounds are in the units of the piece.

Where a test needs equations whose zeros are known, they replace the flow: F(sigma, omega) on the enlarged interval
and tube, s = middle + 17/16 (half the length) sigma and p_j = polynomial_j(s) + 2 tube_j omega_j.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import mpmath
import pytest
from flint import arb, ctx
from support.piece_cases import proved_interval
from support.wide_checks import OMEGA, TWIST, piece, value_and_error

from orbitproof.shared.claims import Piece
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS
from orbitproof.verify.algebra import Arithmetic, Series
from orbitproof.verify.curve import PieceLimits, PieceResult, ProvedInterval, parts_of_interval, prove_piece
from orbitproof.verify.curve import piece as branch_piece
from orbitproof.verify.curve.equation import halves
from orbitproof.verify.evidence import Checklist, IntegrationFailure, NotProved, Reason
from orbitproof.verify.oracle import ORACLE

END = Fraction(16, 17)
TUBE = Fraction(1, 64)
LIMITS = PieceLimits(60, 16, 12)
WHOLE = (Fraction(-1), Fraction(1))
MU = MASS_PARAMETERS["earth-moon"]

LINE = piece(("1", "0"), (("0", "1"), ("1", "0")), "1/8", (("0",),), (str(TUBE),), kind="symmetric")
SPATIAL = piece(
    ("7/8", "0", "1/4"), (("0", "1", "1/3"), ("1", "0", "0"), ("0", "-1/2", "1")), "1/8",
    (("1/7", "0", "1/5"), ("0", "0", "0", "0", "1/9")), ("1/16", "1/64"), kind="symmetric",
)  # fmt: skip
REGULAR = replace(LINE, kind="regular")

Interval = tuple[Fraction, Fraction]
Equations = Callable[[Arithmetic], list[Series]]


def ends(value: arb) -> Interval:
    """The ends of a ball, exactly."""
    middle, radius = (exact(x) for x in (value.mid(), value.rad()))
    return middle - radius, middle + radius


def exact(point: arb) -> Fraction:
    mantissa, exponent = point.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def covers(balls: Sequence[arb], start: Fraction, end: Fraction) -> bool:
    """Whether every number of [start, end] lies in one of the balls."""
    reached = start
    for low, high in sorted(map(ends, balls)):
        if low > reached:
            return False
        reached = max(reached, high)
    return reached >= end


def returning(monkeypatch: pytest.MonkeyPatch, equations: Callable[[Any], Sequence[Series]]) -> None:
    """The half return of every piece has these kernel coordinates, after a time of 3."""
    half = SimpleNamespace(time_of_all=arb(3))
    monkeypatch.setattr(branch_piece._Proof, "_half_return", lambda proof, *_: half)
    monkeypatch.setattr(branch_piece._Proof, "_equations", lambda proof, _: equations(proof))


def prove(
    monkeypatch: pytest.MonkeyPatch, equations: Equations, given: Piece = REGULAR, interval: Interval = WHOLE
) -> PieceResult[ProvedInterval]:
    """The verdict on a piece whose half return is known."""
    returning(monkeypatch, lambda proof: equations(proof.arithmetic))
    system, parameters = (TWIST, {"omega": OMEGA}) if len(given.tube) == 1 else (CR3BP, {"mu": MU})
    return prove_piece(system, parameters, given, interval, ORACLE, LIMITS, None, "S")


def reason_of(result: PieceResult[ProvedInterval]) -> Reason:
    """Why a piece is not proved."""
    assert isinstance(result.outcome, NotProved)
    return result.outcome.reason


def wide(arithmetic: Arithmetic, *coefficients: Fraction) -> Series:
    """A polynomial in sigma."""
    count = len(arithmetic.grading.weights)
    return arithmetic.polynomial({(0,) * count: list(coefficients)})


def across(arithmetic: Arithmetic, variable: int = 0) -> Series:
    """omega_variable."""
    count = len(arithmetic.grading.weights)
    return arithmetic.polynomial({tuple(int(i == variable) for i in range(count)): Fraction(1)})


# Covers


@pytest.mark.parametrize("seed", range(5))
def test_halves_cover_a_ball(seed: int) -> None:
    source = random.Random(seed)
    with ctx.workprec(source.choice((30, 53, 120))):
        for _ in range(100):
            middle = arb(source.uniform(-1, 1)) / 3
            whole = arb(middle.mid(), 10.0 ** source.uniform(-12, 0))
            both = halves(whole)
            low, high = ends(whole)
            assert covers(both, low, high)
            for half in both:
                start, end = ends(half)
                assert end - start <= (high - low) * Fraction(51, 100) + Fraction(1, 2**28)


@pytest.mark.parametrize("number", [1, 2, 3, 8, 11])
@pytest.mark.parametrize("bits", [24, 53, 144])
def test_parts_cover_the_interval(number: int, bits: int) -> None:
    with ctx.workprec(bits):
        parts = parts_of_interval(number)
    assert covers(parts, -END, END)
    assert all(high - low <= 2 * END / number * Fraction(1001, 1000) for low, high in map(ends, parts))


def accept(monkeypatch: pytest.MonkeyPatch, newton: Callable[[arb], float]) -> PieceResult[ProvedInterval]:
    """The verdict where the Newton operator is replaced by one that is asked for every part."""

    def answer(functions: Any, part: arb, *_: Any) -> tuple[list[arb], list[arb]]:
        value = newton(part)
        return [arb(value)], [arb(-3 * value)]

    monkeypatch.setattr(branch_piece, "_newton", answer)
    return prove(monkeypatch, lambda arithmetic: [across(arithmetic)])


@pytest.mark.parametrize("seed", range(20))
def test_accepted_parts_cover_the_interval(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Whatever parts were refused at first."""
    source = random.Random(seed)
    accepted: list[arb] = []
    chance = source.choice((0.0, 0.2, 0.5))

    def newton(part: arb) -> float:
        low, high = ends(part)
        if high - low > Fraction(1, 100) and source.random() < chance:
            raise IntegrationFailure("newton", "refused", "halve it")
        accepted.append(part)
        return 0.0

    result = accept(monkeypatch, newton)
    assert result.is_proved
    assert covers(accepted, -END, END)


@pytest.mark.parametrize("n", range(-16, 17))
def test_one_place_without_a_proof_is_enough(monkeypatch: pytest.MonkeyPatch, n: int) -> None:
    """What fails at one number, the ends of the interval included, however often the parts are halved."""
    place = Fraction(n, 17)

    def newton(part: arb) -> float:
        low, high = ends(part)
        if low <= place <= high:
            raise IntegrationFailure("newton", "refused here", "none")
        return 0.0

    result = accept(monkeypatch, newton)
    assert "refused here" in reason_of(result).message


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("smallest", [1.0, 0.1])
@pytest.mark.parametrize("n", range(-15, 17, 2))
def test_bounds_hold_on_every_part(monkeypatch: pytest.MonkeyPatch, n: int, smallest: float, sign: int) -> None:
    """A part, halved or not, that is farther from the polynomial than the others."""
    place = Fraction(n, 17)

    def newton(part: arb) -> float:
        low, high = ends(part)
        if high - low > smallest:
            raise IntegrationFailure("newton", "refused", "halve it")
        return sign * (0.02 if low <= place <= high else 0.001)

    result = accept(monkeypatch, newton)
    known = proved_interval(result)
    for bound, value in ((known.deviation[0], 0.02), (known.slope_deviation[0], 0.06)):
        assert 2 * TUBE * Fraction(value) <= bound <= 2 * TUBE * Fraction(value) * Fraction(1001, 1000)


# The tube


INTERVALS = [
    WHOLE,
    (Fraction(-1, 3), Fraction(1)),
    (Fraction(1, 7), Fraction(2, 7)),
    (Fraction(-1), Fraction(-999, 1000)),
    (Fraction(0), Fraction(1, 5)),
]


@pytest.mark.parametrize("interval", INTERVALS, ids=str)
@pytest.mark.parametrize("kind", ["regular", "symmetric"])
def test_initial_values_are_the_points_of_the_tube(interval: Interval, kind: str) -> None:
    """sigma = -16/17 and 16/17 are the ends of the interval, |omega_j| = 1/2 are the walls of the tube."""
    given = replace(SPATIAL, kind=kind)
    if kind == "regular":
        given = replace(given, polynomial=(*given.polynomial[:1], tuple(Fraction(1, n) for n in range(2, 9))))
    with ctx.workprec(130), mpmath.workprec(200):
        proof = branch_piece._Proof(CR3BP, {"mu": MU}, given, interval, ORACLE, LIMITS, "S")
        proof.check_claim(Checklist())
        start, end = proof.interval
        assert start <= interval[0] < interval[1] <= end
        if kind == "regular":
            assert (start, end) == interval
        initial = proof.points()
        for share in (Fraction(0), Fraction(1), Fraction(1, 2), Fraction(1, 3)):
            s, sigma = start + (end - start) * share, END * (2 * share - 1)
            for w in ((0, 0), (1, 0), (-1, 1), (1, Fraction(-1, 3))):
                p = [x + Fraction(a) * b for x, a, b in zip(given.local(s), (0, *w), (0, *given.tube), strict=True)]
                for name, middle, row in zip(CR3BP.centre_coordinates, given.centre, given.frame, strict=True):
                    value = middle + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0))
                    known, error = value_and_error(initial[name], sigma, [Fraction(x) / 2 for x in w])
                    assert error < 1e-13
                    assert abs(known - mpmath.mpf(value.numerator) / value.denominator) <= error + 1e-40


@pytest.mark.parametrize("interval", INTERVALS, ids=str)
def test_bounds_of_a_curve_that_is_known(monkeypatch: pytest.MonkeyPatch, interval: Interval) -> None:
    """c = 1/16 + a/8 + a^2/64 in the plane of (a, c), by a polynomial that is wrong by 2^-12 (1 - s/2)."""
    h = Fraction(1, 8)
    error = Fraction(1, 2**12)
    row = (Fraction(1, 16) + error, h / 8 - error / 2, h * h / 64)
    given = Piece(
        "known", "regular", (Fraction(0), Fraction(0)),
        ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))), h, (row,), (TUBE,),
    )  # fmt: skip

    def equations(proof: Any) -> list[Series]:
        point = proof.points()
        a, constant = point["a"], proof.arithmetic.constant(Fraction(1, 16))
        return [point["c"] - constant - a.scaled(Fraction(1, 8)) - (a * a).scaled(Fraction(1, 64))]

    returning(monkeypatch, equations)
    result = proved_interval(prove_piece(TWIST, {"omega": OMEGA}, given, interval, ORACLE, LIMITS))
    check(result.deviation[0], max(error * (1 - s / 2) for s in (result.start, result.end)))
    check(result.slope_deviation[0], error / 2)


# Slopes


def check(bound: Fraction, truth: Fraction, factor: Fraction = Fraction(103, 100)) -> None:
    assert truth <= bound <= truth * factor


def radius_of(interval: Interval) -> Fraction:
    """d s / d sigma."""
    return Fraction(17, 16) * (interval[1] - interval[0]) / 2


SIZE = Fraction(1, 200)


@pytest.mark.parametrize(
    "interval", [WHOLE, (Fraction(1, 4), Fraction(1, 2)), (Fraction(-1), Fraction(-1, 8))], ids=str
)
def test_slopes_of_regular_pieces(monkeypatch: pytest.MonkeyPatch, interval: Interval) -> None:
    """omega = (3 - sigma)/200, from an equation in which the two are multiplied."""

    def equations(arithmetic: Arithmetic) -> list[Series]:
        curve = wide(arithmetic, 3 * SIZE, -SIZE)
        return [wide(arithmetic, Fraction(1), Fraction(1, 8)) * (across(arithmetic) - curve)]

    result = proved_interval(prove(monkeypatch, equations, REGULAR, interval))
    check(result.deviation[0], 2 * TUBE * SIZE * (3 + END))
    check(result.slope_deviation[0], 2 * TUBE * SIZE / radius_of(interval), Fraction(11, 10))


@pytest.mark.parametrize(
    "interval", [(Fraction(1, 4), Fraction(1, 2)), (Fraction(-1), Fraction(-1, 8)), (Fraction(1, 100), Fraction(1))],
    ids=str,
)  # fmt: skip
def test_slopes_of_symmetric_pieces_away_from_their_symmetric_point(
    monkeypatch: pytest.MonkeyPatch, interval: Interval
) -> None:
    """omega = sigma/50: its slope is largest, relative to s, at the end next to 0."""
    equations = lambda arithmetic: [across(arithmetic) - wide(arithmetic, Fraction(0), 4 * SIZE)]  # noqa: E731
    result = proved_interval(prove(monkeypatch, equations, LINE, interval))
    nearest = min(map(abs, interval))
    check(result.slope_deviation[0], 2 * TUBE * 4 * SIZE / radius_of(interval) / nearest)
    check(result.deviation[0], 2 * TUBE * 4 * SIZE * END)


@pytest.mark.parametrize(
    "interval", [WHOLE, (Fraction(0), Fraction(1, 5)), (Fraction(-1, 3), Fraction(1, 10))], ids=str
)
def test_slopes_of_symmetric_pieces_through_their_symmetric_point(
    monkeypatch: pytest.MonkeyPatch, interval: Interval
) -> None:
    """omega_1 = sigma^2/200 from an even equation, omega_2 = (sigma^2 + sigma^4)/200 from an odd one."""
    zero = Fraction(0)

    def equations(arithmetic: Arithmetic) -> list[Series]:
        even = across(arithmetic) - wide(arithmetic, zero, zero, SIZE)
        odd = across(arithmetic, 1) - wide(arithmetic, zero, zero, SIZE, zero, SIZE)
        return [even.scaled(Fraction(3)), wide(arithmetic, zero, Fraction(2)) * odd]

    result = proved_interval(prove(monkeypatch, equations, SPATIAL, interval))
    end = max(map(abs, interval))
    assert (result.start, result.end) == (-end, end)
    radius = Fraction(17, 16) * end
    first, second = SPATIAL.tube
    check(result.deviation[0], 2 * first * SIZE * END**2)
    check(result.deviation[1], 2 * second * SIZE * (END**2 + END**4))
    check(result.slope_deviation[0], 2 * first * 2 * SIZE / radius**2)
    check(result.slope_deviation[1], 2 * second * SIZE * (2 + 4 * END**2) / radius**2, Fraction(11, 10))


# Uniqueness


def with_zeros(*zeros: Fraction) -> Equations:
    """The product of omega - zero."""

    def equations(arithmetic: Arithmetic) -> list[Series]:
        result = arithmetic.constant(Fraction(1))
        for zero in zeros:
            result = result * (across(arithmetic) - arithmetic.constant(zero))
        return [result]

    return equations


@pytest.mark.parametrize("first", [0.0, 0.01, -0.02])
@pytest.mark.parametrize("second", [0.0, 0.05, 0.3, 0.45, 0.5])
@pytest.mark.parametrize("sign", [1, -1])
def test_tubes_with_two_zeros_are_refused(
    monkeypatch: pytest.MonkeyPatch, first: float, second: float, sign: int
) -> None:
    result = prove(monkeypatch, with_zeros(Fraction(first), sign * Fraction(second)))
    assert reason_of(result).condition == "slope"


def test_tubes_with_two_zeros_in_two_unknowns_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """omega_1 = omega_2 and omega_1 omega_2 = omega_1/4."""

    def equations(arithmetic: Arithmetic) -> list[Series]:
        first, second = across(arithmetic), across(arithmetic, 1)
        return [first - second, first * second - first.scaled(Fraction(1, 4))]

    given = replace(SPATIAL, kind="regular")
    assert not prove(monkeypatch, equations, given).is_proved
    assert prove(monkeypatch, lambda arithmetic: [across(arithmetic, 1), across(arithmetic)], given).is_proved


@pytest.mark.parametrize("zero", [0.0, 0.01, -0.02])
@pytest.mark.parametrize("other", [10.0, -10.0])
def test_tubes_with_one_zero_well_inside_are_proved(monkeypatch: pytest.MonkeyPatch, zero: float, other: float) -> None:
    result = prove(monkeypatch, with_zeros(Fraction(zero), Fraction(other)))
    truth = 2 * TUBE * abs(Fraction(zero))
    assert truth <= proved_interval(result).deviation[0] <= truth * Fraction(5, 4) + Fraction(1, 10**12)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("zero", "proved"),
    [("1/33", True), ("1/32", False), ("1/31", False), ("1/16", False), ("2/5", False), ("1/2", False), ("3/5", False)],
)
def test_zeros_beyond_a_sixteenth_of_the_tube_are_refused(
    monkeypatch: pytest.MonkeyPatch, zero: str, proved: bool, sign: int
) -> None:
    assert prove(monkeypatch, with_zeros(sign * Fraction(zero))).is_proved == proved


def test_tubes_without_a_zero_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not prove(monkeypatch, lambda arithmetic: [arithmetic.constant(Fraction(1, 10**6))]).is_proved
    square = prove(
        monkeypatch,
        lambda arithmetic: [across(arithmetic) * across(arithmetic) + arithmetic.constant(Fraction(1, 10**6))],
    )
    assert not square.is_proved


@pytest.mark.parametrize("centre", ["16/17", "-16/17", "1/3"])
def test_a_zero_that_leaves_the_tube_at_one_place_is_found(monkeypatch: pytest.MonkeyPatch, centre: str) -> None:
    """omega = height (1 - ((sigma - centre)/2)^2)^6, largest at one number."""
    at = Fraction(centre)
    row = [Fraction(1)]
    for _ in range(6):
        factor = [1 - at * at / 4, at / 2, Fraction(-1, 4)]
        product = [Fraction(0)] * (len(row) + 2)
        for i, a in enumerate(row):
            for j, b in enumerate(factor):
                product[i + j] += a * b
        row = product
    for height, proved in (("1/31", False), ("1/33", True)):
        scaled = [Fraction(height) * value for value in row]
        result = prove(
            monkeypatch,
            lambda arithmetic, c=scaled: [across(arithmetic) - wide(arithmetic, *c)],  # type: ignore[misc]
        )
        assert result.is_proved == proved


@pytest.mark.parametrize("near", [0, 1])
def test_zeros_have_to_be_well_inside_in_every_direction(monkeypatch: pytest.MonkeyPatch, near: int) -> None:
    zeros = [Fraction(1, 100) if j == near else Fraction(1, 20) for j in range(2)]
    result = prove(
        monkeypatch,
        lambda arithmetic: [across(arithmetic, j) - arithmetic.constant(zero) for j, zero in enumerate(zeros)],
        replace(SPATIAL, kind="regular"),
    )
    assert not result.is_proved
