"""Reversible maps in closed form with one hypothesis missing: each is refused by the name of that hypothesis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction as F
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.closed_form_maps import ReversibleMap, claim, description, tables_of_maps, verdict
from support.map_cases import CASES, SLOPED, WIDE, cubic, even, failed, outcome_of, proof, quadratic, tilted
from support.within import within

from orbitproof.verify.bifurcation import (
    BifurcationFunction,
    BifurcationResults,
    PeriodTwoFamily,
    Problem,
    check_transversality,
    locate,
    theorem_of,
)
from orbitproof.verify.bifurcation.conditions import Point
from orbitproof.verify.bifurcation.nondegeneracy import check_family_of_maps
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    enclose,
    indices_up_to,
)
from orbitproof.verify.newton import BoxFunction, ImplicitGraph

precision = within(lambda: ctx.workprec(300))


def identity_with(size: int, entries: dict[tuple[int, int], F]) -> tuple[tuple[F, ...], ...]:
    return tuple(tuple(entries.get((i, j), F(int(i == j))) for j in range(size)) for i in range(size))


@pytest.mark.parametrize(
    ("changes", "hamiltonian"),
    [
        ({"frame": identity_with(2, {(1, 1): F(0)})}, False),
        ({"kernel_frame": ((F(0),),)}, False),
        ({"frame": identity_with(2, {(0, 1): F(1, 2)})}, False),
        ({"frame": identity_with(2, {(0, 0): F(2)})}, False),
        ({"frame": identity_with(2, {(0, 1): F(1), (1, 0): F(1)})}, True),
    ],
    ids=["frame singular", "kernel frame singular", "parameter mixed", "parameter scaled", "singular, Hamiltonian"],
)
def test_singular_frames_are_not_proved(changes: dict[str, Any], hamiltonian: bool) -> None:
    failed(outcome_of("k=2", hamiltonian, **changes), "frames")


NOT_ADAPTED: list[dict[str, Any]] = [
    {"symmetry": None},
    {"centre": (F(0), F(1, 2**100))},
    {"frame": identity_with(2, {(1, 0): F(1, 2**100)})},
]


@pytest.mark.parametrize(
    "changes", NOT_ADAPTED, ids=["no symmetry", "centre not symmetric", "family direction not symmetric"]
)
@pytest.mark.parametrize("name", ["k=1", "k=3, symmetric"])
def test_a_claim_that_uses_a_symmetry_is_not_proved_without_exactly_adapted_frames(
    name: str, changes: dict[str, Any]
) -> None:
    failed(outcome_of(name, **changes), "adapted-frames")


def test_touch_and_go_is_not_proved_where_a_symmetry_makes_it_a_tripling() -> None:
    for hamiltonian, condition in ((False, "G_11"), (True, "h_b'")):
        system, _, k, radii = CASES["k=3, symmetric"]
        tables, integral = tables_of_maps(system, k, radii, even if hamiltonian else None)
        failed(verdict(claim(description(1, hamiltonian), "touch_and_go", k, radii), tables, integral), condition)


@pytest.mark.parametrize("entry", [(0, 1), (1, 0)])
def test_kernel_frame_that_mixes_even_and_odd_is_not_proved(entry: tuple[int, int]) -> None:
    failed(outcome_of("k=1, n=2", kernel_frame=identity_with(2, {entry: F(1, 2**100)})), "adapted-frames")


def edited(
    name: str,
    iterate: int,
    index: tuple[int, ...],
    box: Callable[[arb], arb] | None = None,
    centre: Callable[[arb], arb] | None = None,
    component: int = 0,
) -> Outcome[BifurcationResults]:
    """The outcome with one derivative of one iterate replaced, in the table of the box and of the centre."""
    system, kind, k, radii = CASES[name]
    tables, _ = tables_of_maps(system, k, radii)
    old = tables[iterate - 1][component]
    tables[iterate - 1][component] = DerivativeTable(
        {**old.box, index: old.box[index] if box is None else box(old.box[index])},
        {**old.centre, index: old.centre[index] if centre is None else centre(old.centre[index])},
    )
    return verdict(claim(description(len(radii) - 1, False, k == 1), kind, k, radii), tables, None)


def test_box_off_the_family_is_not_proved() -> None:
    failed(edited("k=2", 1, (0, 0), box=lambda x: x + 1, centre=lambda x: x + 1), "family")


def test_period_quadrupling_claimed_at_a_doubling_is_not_proved() -> None:
    system, _, _, radii = CASES["k=2"]
    tables, _ = tables_of_maps(system, 4, radii)
    failed(verdict(claim(description(1, False), "period_tupling", 4, radii), tables, None), "regular-2")


def test_period_doubling_claimed_at_a_quadrupling_is_not_proved() -> None:
    system, _, _, radii = CASES["k=4"]
    tables, _ = tables_of_maps(system, 2, radii)
    failed(verdict(claim(description(1, False), "period_tupling", 2, radii), tables, None), "C3")


@pytest.mark.parametrize(("second", "i"), [(F(0), 2), (F(-1, 2), 3), (F(1), 1)])
def test_resonance_of_the_second_pair_is_not_proved(second: F, i: int) -> None:
    system, kind, k, radii = CASES["k=4, n=2"]
    tables, _ = tables_of_maps(replace(system, others=(second,)), k, radii)
    outcome = verdict(claim(description(2, False), kind, k, radii), tables, None)
    failed(outcome, "family" if i == 1 else f"regular-{i}")


def test_singular_matrix_of_an_intermediate_iterate_is_not_proved() -> None:
    failed(edited("k=4", 3, (0, 1), box=lambda x: x - x.mid(), centre=lambda x: x - x.mid()), "regular-3")


def test_values_outside_p_2_are_not_proved() -> None:
    system, kind, k, radii = CASES["k=2, n=2"]
    narrow = (radii[0], radii[1], radii[2] / 2**20)
    tables, integral = tables_of_maps(system, k, narrow)
    failed(verdict(claim(description(2, False), kind, k, narrow), tables, integral), "C2")
    tables, integral = tables_of_maps(system, k, narrow, tilted)
    failed(verdict(claim(description(2, True), kind, k, narrow), tables, integral), "HC2")


def test_branch_that_leaves_p_0_is_not_proved() -> None:
    system, kind, k, radii = CASES["k=2"]
    narrow = (radii[0] / 2**10, radii[1])
    tables, integral = tables_of_maps(system, k, narrow)
    failed(verdict(claim(description(1, False), kind, k, narrow), tables, integral), "C3")
    tables, integral = tables_of_maps(system, k, narrow, tilted)
    failed(verdict(claim(description(1, True), kind, k, narrow), tables, integral), "HC3")


def test_box_shifted_off_the_bifurcation_is_not_proved_and_asks_for_no_precision() -> None:
    system, kind, k, radii = CASES["k=2"]
    shifted = replace(system, a=system.a + 4 * radii[0])
    tables, _ = tables_of_maps(shifted, k, radii)
    outcome = failed(verdict(claim(description(1, False), kind, k, radii), tables, None), "C3")
    assert not outcome.reason.needs_precision


def planar_problem(product: dict[tuple[int, int], F], radii: tuple[F, F]) -> tuple[Problem, Any, Any]:
    """Problem, family p_1 = p_0 / 8 and reduction with G given by its derivatives, which are constant."""
    indices = indices_up_to(2, 3)

    def function(values: dict[tuple[int, int], F]) -> BoxFunction:
        table = {index: enclose(values.get(index, F(0))) for index in indices}
        return BoxFunction(DerivativeTable(table, table))

    family = function({(0, 1): F(1), (1, 0): F(-1, 8)})
    bifurcation = function(product)
    box = tuple(arb(0, 1) * enclose(radius) for radius in radii)
    problem = Problem(3, radii, box, ((family,), (family,), (bifurcation,)), None)
    return problem, PeriodTwoFamily(ImplicitGraph((family,), box, 1)), BifurcationFunction(
        bifurcation, ImplicitGraph((), box, 2))  # fmt: skip


def test_curves_that_touch_are_not_proved() -> None:
    # G = (p_1 - p_0/8) (p_0 - 8 p_1): both factors have the same zeros.
    problem, family, reduction = planar_problem({(1, 1): F(2), (0, 2): F(-16), (2, 0): F(-1, 4)}, (F(1), F(1)))
    checklist = Checklist()
    with pytest.raises(NotEstablishedError) as caught:
        check_transversality(checklist, problem, family, reduction)
    assert caught.value.reason.condition == "C4"
    assert not checklist.hypotheses[0].holds


def test_point_outside_the_box_is_not_proved() -> None:
    # G_1 = 1 + p_0: its zero is on the edge of P_0 for R_0 = 1 and outside for R_0 = 1/2.
    for radius in (F(1), F(1, 2)):
        problem, family, reduction = planar_problem({(0, 1): F(1), (1, 1): F(1)}, (radius, F(1)))
        with pytest.raises(NotEstablishedError) as caught:
            locate(Checklist(), problem, family, reduction)
        assert caught.value.reason.condition == "point"


def test_vanishing_mixed_derivative_is_not_proved() -> None:
    _, _, reduction = planar_problem({(0, 3): F(1)}, (F(1), F(1)))
    point, doubling = Point((arb(0), arb(0)), arb(0)), claim(description(1, False), "period_tupling", 2, SLOPED)
    with pytest.raises(NotEstablishedError) as caught:
        check_family_of_maps(Checklist(), doubling, reduction, point)
    assert caught.value.reason.condition == "G_01"


def test_touch_and_go_without_quadratic_term_is_not_proved() -> None:
    # theta = pi/3: f^3 is -1 at the resonance and the quadratic term vanishes.
    system = ReversibleMap(F(1, 2), cubic)
    tables, _ = tables_of_maps(system, 3, SLOPED)
    failed(verdict(claim(description(1, False), "touch_and_go", 3, SLOPED), tables, None), "G_11")
    tables, integral = tables_of_maps(system, 3, SLOPED, even)
    failed(verdict(claim(description(1, True), "touch_and_go", 3, SLOPED), tables, integral), "h_b'")


def test_period_doubling_without_cubic_term_is_not_proved() -> None:
    system = ReversibleMap(F(0), quadratic)
    tables, _ = tables_of_maps(system, 2, WIDE)
    failed(verdict(claim(description(1, False), "period_tupling", 2, WIDE), tables, None), "G_111")


Level = Callable[[Sequence[Any], Callable[[F], Any]], Any]

DEGENERATE_LEVELS: dict[str, tuple[str, Level]] = {
    # The derivative of H in p_0 vanishes.
    "dH/dp_0": ("k=3", lambda p, c: p[0] * p[0] + p[1]),
    # H is stationary along the family p_1 = p_0 / 2^8.
    "h_fp'": ("k=3, sloped family", lambda p, c: p[0] + p[1] * c(F(-(2**8)))),
    # H is stationary along the crossing branch p_0 = p_1 / 2.
    "h_b'": ("k=3", lambda p, c: p[0] + p[1] * c(F(-1, 2))),
    # H is constant to second order along the new branch p_0 = p_1^2.
    "h_b''": ("k=2", lambda p, c: p[0] + p[1] * p[1] * c(F(-1))),
}


@pytest.mark.parametrize("condition", DEGENERATE_LEVELS)
def test_degenerate_first_integral_is_not_proved(condition: str) -> None:
    name, level = DEGENERATE_LEVELS[condition]
    system, kind, k, radii = CASES[name]
    tables, _ = tables_of_maps(system, k, radii)
    _, integral = tables_of_maps(system, 1, radii, level)
    failed(verdict(claim(description(1, True), kind, k, radii), tables, integral), condition)


@pytest.mark.parametrize(
    ("kind", "k"),
    [("touch_and_go", 2), ("touch_and_go", 4), ("touch_and_go", 5), ("touch_and_go", 7)],
)
def test_claim_without_a_theorem_is_not_proved(kind: str, k: int) -> None:
    outcome = verdict(claim(description(1, False), kind, k, WIDE), [], None)
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "theorem"
    assert not outcome.reason.needs_precision


def test_proved_cannot_be_made_with_a_missing_or_failing_hypothesis() -> None:
    result = proof(outcome_of("k=2"))
    assert not isinstance(theorem_of(claim(description(1, False), "period_tupling", 2, WIDE)), NotProved)
    for position in range(len(result.hypotheses)):
        rest = (*result.hypotheses[:position], *result.hypotheses[position + 1 :])
        with pytest.raises(ValueError, match="not those of the theorem"):
            replace(result, hypotheses=rest)
        broken = (*rest[:position], replace(result.hypotheses[position], holds=False), *rest[position:])
        with pytest.raises(ValueError, match="does not hold"):
            replace(result, hypotheses=broken)
    with pytest.raises(ValueError, match="not those of the theorem"):
        replace(result, hypotheses=(), theorem=SimpleNamespace(hypotheses=()))


def test_a_hypothesis_without_any_check_does_not_hold() -> None:
    checklist = Checklist()
    with pytest.raises(NotEstablishedError, match="nothing was checked"), checklist.hypothesis("empty", "1", "", ""):
        pass
    assert not checklist.hypotheses[0].holds
