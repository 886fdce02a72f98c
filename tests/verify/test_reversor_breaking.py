"""Where R is lost: points, coefficients and sides that are known, and claims that are false."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import prod
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb
from support import breaking_cases as cases
from support.balls import agree
from support.breaking_cases import results_of

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import Candidate
from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    enclose,
    exact_value,
    guarded,
    indices_up_to,
    symmetric,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.reversor_breaking import (
    BreakingEnclosures,
    BreakingResults,
    across,
    check_breaking_exactly,
    enclose_breaking,
    equations_of,
    prove_breaking,
    theorem_of,
    variables_of,
)

BITS = 192
HALF = Fraction(1, 2)


@pytest.fixture(scope="module")
def modes() -> Certificate:
    return certify(cases.modes())


@pytest.fixture(scope="module")
def halo() -> Certificate:
    return certify(cases.halo())


def exactly(ball: arb) -> Fraction:
    return exact_value(ball.mid())


def outcome_of(candidate: Candidate, found: BreakingEnclosures | None) -> Outcome[BreakingResults]:
    return _conclude(candidate, BITS, found)


def refused_by(candidate: Candidate) -> str:
    certificate = certify(candidate)
    assert not certificate.proved
    assert certificate.reason is not None
    return certificate.reason.condition


def test_the_point_of_the_normal_mode_is_that_of_mathieus_equation(modes: Certificate) -> None:
    found = results_of(modes)
    h = cases.level_of(odd=True)
    with guarded(BITS):
        assert agree(found.parameter, enclose(h))
    assert found.parameter.rad() < arb(10) ** -30
    assert found.point["x"].contains(0)
    assert found.side == "above"
    assert agree(found.point["vy"] ** 2, found.parameter)
    assert (found.other_point["vy"] + found.point["vy"]).contains(0)
    assert agree(found.period, 2 * arb.pi())
    assert found.direction["vx"] == 1


def test_new_orbits_are_where_the_coefficient_says(modes: Certificate) -> None:
    h, kappa = float(cases.level_of(odd=True)), results_of(modes).opening
    slopes = [(cases.level_beside(y) - h) / y**2 for y in (0.02, 0.04)]
    # kappa + c y^2: the second term is taken away.
    limit = (4 * slopes[0] - slopes[1]) / 3
    assert abs(float(kappa.mid()) - limit) < 2e-6
    assert float(kappa.rad()) < 1e-5


def test_the_direction_is_in_the_coordinates_that_r_negates() -> None:
    turned = results_of(certify(cases.modes(kernel_frame=((Fraction(2),),))))
    assert agree(turned.direction["vx"], arb(HALF.numerator) / HALF.denominator)
    assert not turned.direction["vx"].overlaps(arb(2))


def test_r_is_lost_along_a_halo_family(halo: Certificate) -> None:
    found = results_of(halo)
    assert agree(found.parameter, arb("2.947009569188494484384445144117172081228 +/- 1e-38"))
    assert found.parameter.rad() < arb(10) ** -30
    assert found.side == "below"
    assert agree(found.opening, arb("-0.0070032 +/- 1e-6"))


@pytest.mark.slow
def test_at_the_other_point_the_same_is_born(halo: Certificate) -> None:
    found, claim = results_of(halo), cases.halo()
    centre = tuple(map(exactly, (found.parameter, found.other_point["x"], found.other_point["z"])))
    other = replace(claim, id="other", centre=centre, level_sign=-1, kernel_frame=((HALF, HALF), (HALF, -HALF)))
    there = results_of(certify(other))
    assert agree(there.parameter, found.parameter)
    assert agree(there.period, found.period)
    assert there.side == found.side
    assert agree(there.point["vy"], found.other_point["vy"])
    assert agree(there.other_point["z"], found.point["z"])
    # x, z and vx, vz are canonical on the section: B there is the transpose of B here (Lemma 27.4).
    crossings = []
    for each in (replace(claim, kernel_frame=((1, 0), (0, 1))), replace(other, kernel_frame=((1, 0), (0, 1)))):
        exact = replace(each, kernel_frame=tuple(tuple(map(Fraction, row)) for row in each.kernel_frame))
        enclosed = enclose_breaking(exact, IntegratorSettings(BITS), ORACLE)
        with guarded(BITS):
            crossings.append(equations_of(enclosed).crossing([arb(0)] * 3))
    here, over = crossings
    assert all(agree(here[i][j], over[j][i]) for i, j in product(range(2), repeat=2))
    assert not here[0][1].overlaps(over[0][1])


def test_what_is_false_is_refused() -> None:
    true, even = cases.modes(), cases.level_of(odd=False)
    # S breaks at the even solution: there C is singular, and B is not.
    assert refused_by(cases.modes(centre=(even, Fraction(0)))) == "curve"
    assert refused_by(cases.modes(centre=(true.centre[0] + Fraction(1, 1000), Fraction(0)))) == "point"
    assert refused_by(cases.modes(crossings=2)) == "half-orbit"
    assert refused_by(cases.modes(parameters={"a": cases.A + Fraction(1, 10**9)})) == "point"
    narrow = true.radii[0]
    # Beyond the box, and on its border: not inside.
    for shift in (narrow * Fraction(2**20 + 1, 2**20), -narrow * Fraction(2**20 + 1, 2**20), narrow, -narrow):
        assert refused_by(cases.modes(centre=(true.centre[0] + shift, Fraction(0)))) == "point"
        assert refused_by(cases.modes(centre=(true.centre[0], shift))) == "point"


def test_the_direction_of_a_halo_orbit_is_the_kernel_of_another_integrators_b(halo: Certificate) -> None:
    found, claim = results_of(halo), cases.halo()
    direction = [float(found.direction[name].mid()) for name in ("vx", "vz")]
    assert abs(np.dot([float(value) for value in claim.kernel_frame[0]], direction) - 1) < 1e-12
    columns = [cases.halo_crossing(found, along) for along in ((1.0, 0.0), (0.0, 1.0))]
    b = np.transpose(columns)
    w = np.array(direction) / np.hypot(*direction)
    assert np.hypot(*(b @ w)) < 1e-4 * np.hypot(*(b @ [-w[1], w[0]]))


def test_claims_that_no_theorem_is_about() -> None:
    own = replace(cases.modes(), centre=(Fraction(0), HALF), level_sign=None)
    assert refused_by(own) == "theorem"
    fold = replace(cases.modes(), kind="fold")
    for claim in (own, fold):
        found = prove_breaking(claim, Checklist(), None)
        assert isinstance(found, NotProved)
        assert found.reason.condition == "theorem"
        with pytest.raises(NotEstablishedError):
            check_breaking_exactly(Checklist(), claim)
    normalised = SimpleNamespace(name="modes", normalised={"x": Fraction(1)})
    of_other_orbits = SimpleNamespace(loses_reversor=True, is_family_of_maps=True, system=normalised)
    assert isinstance(theorem_of(of_other_orbits), Reason)  # type: ignore[arg-type]
    assert not isinstance(theorem_of(cases.modes()), Reason)
    with pytest.raises(InputError, match="level_sign: modes-on-level has the parameter a"):
        replace(cases.on_level(), level_sign=1)
    for changes in ({"symmetry": "S"}, {"k": 2}):
        with pytest.raises(InputError, match="kind: "):
            cases.modes(**changes)


def test_a_symmetry_breaking_of_s_is_no_loss_of_r_and_the_other_way_round() -> None:
    h = cases.level_of(odd=True)
    other = replace(
        cases.modes(), kind="symmetry_breaking", symmetry="S", radii=(Fraction(1, 2**40), Fraction(1, 2**22))
    )
    assert not certify(replace(other, centre=(h, Fraction(0)))).proved
    assert certify(replace(other, centre=(cases.level_of(odd=False), Fraction(0)))).proved


@pytest.mark.slow
def test_a_frame_of_q_across_the_kernel_is_refused(halo: Certificate) -> None:
    claim, found = cases.halo(), results_of(halo)
    along = [exactly(found.direction[name]) for name in ("vx", "vz")]
    # Row 1 has to be other than 0 on the kernel.
    assert refused_by(replace(claim, kernel_frame=((along[1], -along[0]), (along[0], along[1])))) == "kernel"
    first, second = claim.kernel_frame
    assert certify(replace(claim, kernel_frame=(second, first))).proved


Change = Callable[[BreakingEnclosures], BreakingEnclosures]


def _negative(table: DerivativeTable) -> DerivativeTable:
    zero = next(iter(table.box))
    return DerivativeTable({**table.box, zero: -table.box[zero]}, {**table.centre, zero: -table.centre[zero]})


CHANGES: Mapping[str, tuple[Change, str]] = {
    "one too many": (lambda found: replace(found, iterates=found.iterates * 2), "poincare-map"),
    "a sheet that is not finite": (lambda found: replace(found, sheet=(arb("nan"),)), "poincare-map"),
    "both sheets": (lambda found: replace(found, sheet=(arb(0, 1),)), "sheet"),
    "back in time": (lambda found: replace(found, half_period=_negative(found.half_period)), "poincare-map"),
}


@pytest.fixture(scope="module")
def enclosed() -> BreakingEnclosures:
    return enclose_breaking(cases.modes(), IntegratorSettings(BITS), ORACLE)


@pytest.mark.parametrize("name", CHANGES)
def test_enclosures_that_are_no_enclosures_prove_nothing(enclosed: BreakingEnclosures, name: str) -> None:
    change, condition = CHANGES[name]
    assert isinstance(outcome_of(cases.modes(), enclosed), Proved)
    found = outcome_of(cases.modes(), change(enclosed))
    assert isinstance(found, NotProved)
    assert found.reason.condition == condition


def test_points_beside_fix_r_are_as_far_as_the_root_of_the_box() -> None:
    for power in (7, 20, 61):
        width = across(cases.modes(radii=(Fraction(1, 2**power),) * 2))
        assert Fraction(1, 2 ** (power + 2)) < width**2 < Fraction(1, 2 ** (power - 2))


Polynomial = dict[tuple[int, ...], float]


class Cubic:
    """A polynomial map (h, p', q) -> (P_p, P_q) of degree 3 with a singular B and a regular C at 0."""

    def __init__(self, n: int, seed: int) -> None:
        self.n, random = n, np.random.default_rng(seed)
        self.w = np.append(1.0, random.integers(-8, 9, n - 1) / 8)
        blocks = [np.round(8 * random.normal(size=(n, n))) / 8 for _ in range(2)]
        self.b = blocks[0] - np.outer(blocks[0] @ self.w, np.eye(n)[0])
        self.c = np.round(8 * random.normal(size=(n, n))) / 8 + 3 * np.eye(n)
        self.image = [self._component(random, self.b[i], across=True) for i in range(n)]
        self.kernel = [self._component(random, self.c[i], across=False) for i in range(n)]

    def _component(self, random: Any, slopes: Any, across: bool) -> Polynomial:
        n = self.n
        found = {index: round(8 * random.normal()) / 8 for index in indices_up_to(2 * n + 1, 3)}
        found[(0,) * (2 * n + 1)] = 0.0
        for j, slope in enumerate(slopes):
            place = n + 1 + j if across else 1 + j
            found[tuple(int(i == place) for i in range(2 * n + 1))] = float(slope)
        return found

    def enclosures(self, radius: Fraction) -> BreakingEnclosures:
        sides = [symmetric(radius)] * (2 * self.n + 1)

        def table(function: Polynomial) -> DerivativeTable:
            indices = indices_up_to(2 * self.n + 1, 3)
            centre = [arb(0)] * len(sides)
            return DerivativeTable(
                {index: _derivative(function, index, sides) for index in indices},
                {index: _derivative(function, index, centre) for index in indices},
            )

        time = {(0,) * (2 * self.n + 1): 1.0}
        return BreakingEnclosures((tuple(map(table, self.kernel)),), tuple(map(table, self.image)), table(time), ())

    def level_at(self, y: Any) -> Any:
        """h of the zero of E with q_1 = y, E = P - R P R."""
        n = self.n

        def equations(*unknowns: Any) -> list[Any]:
            h, p, rest = unknowns[0], unknowns[1 : n + 1], unknowns[n + 1 :]
            q = [y, *(y * value for value in rest)]
            there, mirrored = [h, *p, *q], [h, *p, *(-value for value in q)]
            odd = [(_value(f, there) - _value(f, mirrored)) / (2 * y) for f in self.image]
            return [*odd, *((_value(f, there) + _value(f, mirrored)) / 2 for f in self.kernel)]

        start = [mpmath.mpf(0)] * (n + 1) + [mpmath.mpf(value) for value in self.w[1:]]
        return mpmath.findroot(equations, start)[0]


def _value(function: Polynomial, at: Any) -> Any:
    return mpmath.fsum(c * prod((x**e for x, e in zip(at, index, strict=True))) for index, c in function.items())


def _derivative(function: Polynomial, index: tuple[int, ...], at: list[arb]) -> arb:
    found = arb(0)
    for exponents, coefficient in function.items():
        if all(e >= i for e, i in zip(exponents, index, strict=True)):
            term = arb(coefficient)
            for x, e, i in zip(at, exponents, index, strict=True):
                for _ in range(e - i):
                    term = term * x
                term = term * prod(range(e - i + 1, e + 1))
            found += term
    return found


@pytest.mark.parametrize(("n", "seeds"), [(1, 8), (2, 3), pytest.param(3, 8, marks=pytest.mark.slow)])
def test_coefficients_are_those_of_the_orbits_of_random_maps(n: int, seeds: int) -> None:
    with mpmath.workdps(60), guarded(BITS):
        for seed in range(seeds):
            cubic = Cubic(n, seed)
            found = equations_of(cubic.enclosures(Fraction(1, 2**60)))
            where = [arb(0)] * (n + 1)
            coefficients = found.coefficients(where)
            y = mpmath.mpf(10) ** -14
            kappa = cubic.level_at(y) / y**2
            known = arb(mpmath.nstr(kappa, 30))
            gap = abs(coefficients.opening - known)
            assert gap < arb(10) ** -10 * (1 + abs(known)), (n, seed)
            kernel = found.kernel_over(where)
            assert kernel.defect.contains(0)
            assert all(ball.contains(arb(float(w))) for ball, w in zip(kernel.right, cubic.w, strict=True))


@pytest.mark.parametrize(("n", "seeds"), [(1, 8), (2, 2), pytest.param(3, 8, marks=pytest.mark.slow)])
def test_g_and_its_slope_are_those_of_the_bordered_matrix(n: int, seeds: int) -> None:
    with guarded(BITS):
        for seed in range(seeds):
            cubic = Cubic(n, seed)
            found = equations_of(cubic.enclosures(Fraction(1, 2**10)))
            random = np.random.default_rng(seed)
            here = [arb(round(float(value) * 2**20)) / 2**32 for value in random.uniform(-1, 1, n + 1)]
            whole = found.matrix([symmetric(Fraction(1, 2**10))] * (n + 1))
            at = found.kernel_over(here)
            for place in range(n + 1):
                step = arb(2) ** -60
                there = found.kernel_over([value + step * (place == i) for i, value in enumerate(here)])
                slope = (there.defect - at.defect) / step
                assert agree(whole[n][place], slope)
                assert agree(found.matrix(here)[n][place], slope + arb(0, 1) * arb(2) ** -40)


def test_a_coefficient_that_may_vanish_proves_nothing(enclosed: BreakingEnclosures) -> None:
    (image,) = enclosed.image
    cubic = (0, 0, 3)
    wide = DerivativeTable({**image.box, cubic: arb(0, 100)}, {**image.centre, cubic: arb(0, 100)})
    found = outcome_of(cases.modes(), replace(enclosed, image=(wide,)))
    assert isinstance(found, NotProved)
    assert found.reason.condition == "side"
    turned = DerivativeTable({**image.box, cubic: arb(-100)}, {**image.centre, cubic: arb(-100)})
    other = outcome_of(cases.modes(), replace(enclosed, image=(turned,)))
    assert isinstance(other, Proved)
    assert other.results.side == "below"


def test_variables_are_those_of_p_and_q() -> None:
    assert variables_of(cases.modes()) == 3
    assert variables_of(cases.halo()) == 5


def test_equations_are_those_of_the_last_return() -> None:
    with guarded(BITS):
        own, other = (Cubic(1, seed).enclosures(Fraction(1, 2**20)) for seed in (0, 1))
        where = [arb(0)] * 2
        wanted = equations_of(own).slopes(where)
        assert equations_of(replace(own, iterates=(*other.iterates, *own.iterates))).slopes(where) == wanted
        assert equations_of(other).slopes(where) != wanted
