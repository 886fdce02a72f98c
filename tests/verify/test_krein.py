"""Krein collisions: points, sides and coefficients that are known, what iterates do, and claims that are false."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb, arb, arb_mat
from support import breaking_cases
from support import krein_cases as cases
from support.balls import agree

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import KREIN_COLLISION, Candidate
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
    guarded,
)
from orbitproof.verify.krein import (
    KreinResults,
    check_krein_exactly,
    cubic_coefficient,
    enclose_krein,
    equations_of,
    prove_krein,
    proved_krein,
    theorem_of_krein,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import full_return_jets
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.reversor_breaking import BreakingEnclosures

BITS = 192
SEEDS = range(3)
TURN = 4 * arb.pi() ** 2


def results_of(claim: Candidate) -> KreinResults:
    certificate = certify(claim)
    assert certificate.proved, certificate.reason
    assert isinstance(certificate.results, KreinResults)
    return certificate.results


def outcome_of(candidate: Candidate, found: BreakingEnclosures | None) -> Outcome[KreinResults]:
    return _conclude(candidate, BITS, found)


def refused_by(candidate: Candidate) -> str:
    """The condition that fails, without more precision."""
    if isinstance(theorem_of_krein(candidate), Reason):
        return "theorem"
    found = outcome_of(candidate, enclose_krein(candidate, IntegratorSettings(BITS), ORACLE))
    assert isinstance(found, NotProved)
    return found.reason.condition


@pytest.mark.parametrize(
    ("omega", "a", "b", "side", "kind"),
    [
        ("3/10", "1", "1/2", "below", "subcritical"),
        ("1/5", "-1", "1/2", "above", "subcritical"),
        ("7/10", "-1/3", "-2", "above", "supercritical"),
        ("9/20", "2", "-1/4", "below", "supercritical"),
    ],
)
def test_a_driven_normal_form_has_its_coefficients(omega: str, a: str, b: str, side: str, kind: str) -> None:
    found = results_of(cases.clock(omega, a, b))
    turn = TURN * enclose(Fraction(a))
    assert (found.side, found.type) == (side, kind)
    assert agree(found.parameter, enclose(cases.LEVEL))
    assert found.parameter.rad() < arb(10) ** -30
    assert agree(found.cosine, (2 * arb.pi() * enclose(Fraction(omega))).cos())
    assert agree(found.rotation_number, enclose(min(Fraction(omega), 1 - Fraction(omega))))
    assert agree(found.unfolding, turn)
    assert agree(found.speed, -4 * (1 - found.cosine**2) * turn)
    # z is 2 Re along x1 of length 1: half as long as A there.
    assert agree(found.coefficient, 4 * TURN * enclose(Fraction(b)))
    assert found.coefficient.rad() < arb(10) ** -6
    assert agree(found.period, 2 * arb.pi())
    assert agree(found.point["x"], arb(3) / 2)
    assert agree(found.other_point["x"], -arb(3) / 2)
    assert all(found.point[name].contains(0) and found.other_point[name].contains(0) for name in ("x1", "x2"))


@pytest.mark.parametrize(("g", "side", "kind"), [("1/2", "above", "supercritical"), ("-1/3", "above", "subcritical")])
def test_coupled_springs_have_theirs(g: str, side: str, kind: str) -> None:
    found = results_of(cases.coupled("-1/25", g))
    assert (found.side, found.type) == (side, kind)
    assert agree(found.unfolding, -TURN * arb(25) / 4)
    assert agree(found.coefficient, -TURN * arb(75) / 4 * enclose(Fraction(g)))
    assert agree(found.cosine, (2 * arb.pi() / 5).cos())


def test_it_is_the_full_return_over_all_crossings() -> None:
    found = results_of(cases.coupled("-1/25", kernel_frame=((Fraction(1), Fraction(2)), (Fraction(0), Fraction(1)))))
    assert agree(found.coefficient, -TURN * arb(75) / 8)
    assert refused_by(cases.coupled("-1/25", crossings=2)) == "half-orbit"


def test_the_frame_of_the_box_counts() -> None:
    # p_1 = (x1 - x2)/2 and p_2 = x2/2: z has the length 1 along p_1 if that of x1 is 2.
    rows = ((1, 0, 0), (0, 2, 2), (0, 0, 2))
    frame = tuple(tuple(map(Fraction, row)) for row in rows)
    found = results_of(cases.coupled("-1/25", frame=frame, centre=(cases.LEVEL, Fraction(0), Fraction(0))))
    assert agree(found.coefficient, -TURN * arb(75) / 2)
    assert agree(found.unfolding, -TURN * arb(25) / 4)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_half_returns_have_the_coefficients_that_they_were_made_with(seed: int) -> None:
    half = cases.known_half(seed)
    found = outcome_of(cases.of_family(), half.enclosures())
    assert isinstance(found, Proved), found
    results = found.results
    assert agree(results.cosine, enclose(half.cosine))
    assert agree(results.unfolding, enclose(half.unfolding))
    assert agree(results.coefficient, enclose(half.coefficient))
    assert results.coefficient.rad() < arb(10) ** -10
    assert (results.side == "above") == (half.unfolding < 0)
    assert (results.type == "subcritical") == (half.coefficient > 0)
    margin = found.hypotheses[-1].enclosures["imaginary part that vanishes"]
    assert margin.contains(0)
    assert margin.rad() < arb(10) ** -10


@pytest.mark.parametrize("seed", SEEDS)
def test_results_are_those_at_the_point_and_not_at_the_centre(seed: int) -> None:
    half, radius = cases.known_half(seed), Fraction(1, 2**24)
    found = outcome_of(cases.of_family(radii=(radius,) * 3), half.enclosures(radius, radius / 2))
    assert isinstance(found, Proved), found
    results = found.results
    for ball, known in (
        (results.parameter, radius / 2),
        (results.cosine, half.cosine),
        (results.unfolding, half.unfolding),
        (results.speed, -4 * (1 - half.cosine**2) * half.unfolding),
        (results.coefficient, half.coefficient),
    ):
        assert agree(ball, enclose(known))
        assert ball.rad() < abs(enclose(known)) / 1000


@pytest.mark.parametrize("seed", SEEDS)
def test_the_discriminant_has_the_derivative_that_is_given(seed: int) -> None:
    with guarded(BITS):
        equations = equations_of(cases.known_half(seed).enclosures(Fraction(1, 4)))
        here = [arb(1) / 64, -arb(1) / 128, arb(1) / 32]
        step = arb(2) ** -50
        last = equations.matrix(here)[-1]
        for place in range(3):
            there = [value + step * (place == i) for i, value in enumerate(here)]
            slope = (equations.discriminant(there) - equations.discriminant(here)) / step
            assert abs(slope - last[place]) < arb(2) ** -30, place


@pytest.mark.parametrize("sign", [1, -1])
def test_iterates_leave_or_stay_as_the_sign_says(sign: int) -> None:
    half = cases.known_half(1, sign, Fraction(1, 8))
    assert (half.coefficient > 0) == (sign > 0)
    size = 1.0 / 64
    u = size * np.array([float(value) for value in half.direction])
    start, most = np.abs(u).max(), 0.0
    for _ in range(int(10 / size)):
        u = half.full(u)
        most = max(most, float(np.abs(u).max()) / start)
        if most > 20:
            break
    assert (most > 20) == (sign > 0), most


def test_what_is_false_is_refused() -> None:
    true = cases.clock()
    centre, radius = true.centre, true.radii[0]
    assert refused_by(cases.clock(centre=(centre[0] + Fraction(1, 1000), *centre[1:]))) == "point"
    sliver = radius * Fraction(2**20 + 1, 2**20)
    for place, shift in ((0, sliver), (0, -sliver), (1, sliver)):
        moved = tuple(
            value + shift if i == place else value for i, value in enumerate((cases.LEVEL, Fraction(0), Fraction(0)))
        )
        assert refused_by(cases.clock(centre=moved)) == "point"
    inside = (cases.LEVEL + radius * Fraction(15, 16), Fraction(0), Fraction(0))
    assert certify(cases.clock(centre=inside)).proved
    assert refused_by(cases.clock(omega="1/4")) == "non-resonance"
    assert refused_by(cases.clock(omega="1/3")) == "non-resonance"
    assert refused_by(cases.clock(b="0")) == "type"
    assert refused_by(cases.clock(a="0")) == "point"
    # The multipliers meet on the real line.
    assert refused_by(cases.coupled("1/25")) == "circle"
    # Sigma is a multiple of 1: the discriminant has a double zero.
    assert refused_by(cases.coupled("-1/25", k="0", m="1")) == "point"


def test_multipliers_that_meet_on_the_negative_real_line_are_refused() -> None:
    """L = [[A, X], [1, 1]], A = 1 + h e_21, with (1 - X)^-1 = (1 + Sigma)/2: s = -5/3, N_12 = 1."""
    components: tuple[cases.Polynomial, ...] = (
        {cases.unit(1): Fraction(1), cases.unit(3): Fraction(4), cases.unit(4): Fraction(9, 2)},
        {cases.unit(2): Fraction(1), cases.unit(4): Fraction(4), (1, 1, 0, 0, 0): Fraction(1)},
        {cases.unit(1): Fraction(1), cases.unit(3): Fraction(1)},
        {cases.unit(2): Fraction(1), cases.unit(4): Fraction(1)},
    )
    half = replace(cases.known_half(0), components=components)
    found = outcome_of(cases.of_family(), half.enclosures())
    assert isinstance(found, NotProved)
    assert found.reason.condition == "circle"


def test_claims_that_no_theorem_is_about() -> None:
    own = replace(cases.clock(), centre=(Fraction(3, 2), Fraction(0), Fraction(0)), level_sign=None)
    assert refused_by(own) == "theorem"
    one = replace(breaking_cases.modes(), kind=KREIN_COLLISION)
    assert refused_by(one) == "theorem"
    other = replace(cases.clock(), kind="reversor_breaking")
    for claim in (own, one, other):
        found = prove_krein(claim, Checklist(), None)
        assert isinstance(found, NotProved)
        assert found.reason.condition == "theorem"
        with pytest.raises(NotEstablishedError):
            check_krein_exactly(Checklist(), claim)
    normalised = SimpleNamespace(name="clock", normalised={"x": Fraction(1)})
    frame = cases.clock().kernel_frame
    of_others = SimpleNamespace(kind=KREIN_COLLISION, is_family_of_maps=True, system=normalised, kernel_frame=frame)
    assert isinstance(theorem_of_krein(of_others), Reason)  # type: ignore[arg-type]
    assert not isinstance(theorem_of_krein(cases.clock()), Reason)
    with pytest.raises(InputError, match="kind: "):
        cases.clock(k=2)


def test_no_loss_of_r_is_a_collision_and_the_other_way_round() -> None:
    other = certify(replace(cases.clock(), kind="reversor_breaking"))
    assert other.reason is not None
    assert other.reason.condition in ("kernel", "point")


Change = Callable[[BreakingEnclosures], BreakingEnclosures]


CHANGES: Mapping[str, tuple[Change, str]] = {
    "no sheet": (lambda found: replace(found, sheet=()), "poincare-map"),
    "both sheets": (lambda found: replace(found, sheet=(arb(0, 1),)), "sheet"),
    "P to one point": (lambda found: replace(found, image=(found.image[1], found.image[1])), "regular"),
    "C is singular": (lambda found: replace(found, iterates=(found.iterates[0][:1] * 2,)), "curve"),
}


@pytest.fixture(scope="module")
def enclosed() -> BreakingEnclosures:
    return enclose_krein(cases.clock(), IntegratorSettings(BITS), ORACLE)


@pytest.mark.parametrize("name", CHANGES)
def test_enclosures_that_are_no_enclosures_prove_nothing(enclosed: BreakingEnclosures, name: str) -> None:
    change, condition = CHANGES[name]
    assert isinstance(outcome_of(cases.clock(), enclosed), Proved)
    found = outcome_of(cases.clock(), change(enclosed))
    assert isinstance(found, NotProved)
    assert found.reason.condition == condition


def _wider(found: BreakingEnclosures, by: arb) -> BreakingEnclosures:
    """All third derivatives of the image moved by a ball."""

    def moved(table: DerivativeTable) -> DerivativeTable:
        box, centre = (
            {index: ball + by if sum(index) == 3 and not index[0] else ball for index, ball in part.items()}
            for part in (table.box, table.centre)
        )
        return DerivativeTable(box, centre)

    return replace(found, image=tuple(map(moved, found.image)))


def test_a_coefficient_that_may_vanish_proves_nothing(enclosed: BreakingEnclosures) -> None:
    found = outcome_of(cases.clock(), _wider(enclosed, arb(0, 10**6)))
    assert isinstance(found, NotProved)
    assert found.reason.condition == "type"


def test_a_map_that_is_not_reversible_proves_nothing(enclosed: BreakingEnclosures) -> None:
    with guarded(BITS):
        jets = full_return_jets(equations_of(enclosed).jets([arb(0)] * 3))
        cubic = (3, 0, 0, 0)
        other = [replace(jet, coefficients={**jet.coefficients, cubic: jet[cubic] + 1}) for jet in jets]
        cosine = (2 * arb.pi() * 3 / 10).cos()
        assert abs(cubic_coefficient(jets, cosine).imag) < 1e-6
        assert abs(cubic_coefficient(other, cosine).imag) > 1e-3


def test_a_speed_that_may_vanish_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proved_krein, "newton_image", lambda matrix, residual: [arb(0, 2**200)] * 2)
    found = outcome_of(cases.of_family(), cases.known_half(0).enclosures())
    assert isinstance(found, NotProved)
    assert found.reason.condition == "side"


def test_an_enclosure_of_b_that_is_not_real_proves_nothing(
    enclosed: BreakingEnclosures, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(proved_krein, "cubic_coefficient", lambda jets, cosine: acb(1, 1))
    found = outcome_of(cases.clock(), enclosed)
    assert isinstance(found, NotProved)
    assert found.reason.condition == "type"


def test_equations_are_those_of_the_last_return(enclosed: BreakingEnclosures) -> None:
    (kernel,) = enclosed.iterates

    def middle(*iterates: tuple[DerivativeTable, ...]) -> arb:
        found: arb = equations_of(replace(enclosed, iterates=iterates)).slopes([arb(0)] * 3)[0][1].mid()
        return found

    assert middle(kernel[::-1], kernel) == middle(kernel)
    assert middle(kernel[::-1]) != middle(kernel)


def test_the_full_return_has_the_stability_matrix_as_a_block(enclosed: BreakingEnclosures) -> None:
    with guarded(BITS):
        equations, where = equations_of(enclosed), [arb(0)] * 3
        jets = full_return_jets(equations.jets(where))
        m = arb_mat([[jet[tuple(int(i == j) for i in range(4))] for j in range(4)] for jet in jets])
        trace = m[0, 0] + m[1, 1]
        discriminant = trace**2 - 4 * (m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0])
        assert agree(discriminant, equations.discriminant(where))
        assert discriminant.rad() < arb(10) ** -15


@pytest.fixture(scope="module")
def halo() -> Certificate:
    return certify(cases.halo())


@pytest.mark.slow
def test_halo_orbits_collide_supercritically(halo: Certificate) -> None:
    assert halo.proved
    found = halo.results
    assert isinstance(found, KreinResults)
    assert (found.side, found.type) == ("above", "supercritical")
    assert agree(found.parameter, arb("2.94067371706073966745762740204 +/- 1e-29"))
    assert found.parameter.rad() < arb(10) ** -25
    assert agree(found.coefficient, arb("-2575.30 +/- 0.01"))
