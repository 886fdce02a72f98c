"""Symmetries are read off the straight-line program, and wrong ones are refused."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

import pytest
from support.claims import known
from support.closed_form_maps import claim, description

from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, SYSTEMS, ReversibleSystem, record
from orbitproof.verify.claim import check_adapted_frames, check_level, check_symmetries, parities, signs_on
from orbitproof.verify.evidence import Checklist, NotEstablishedError


@pytest.mark.parametrize("name", SYSTEMS)
def test_known_systems_have_their_symmetries(name: str) -> None:
    system, checklist = SYSTEMS[name], Checklist()
    check_symmetries(checklist, system)
    for symmetry in system.symmetries:
        check_symmetries(checklist, system, symmetry)
    assert [found.holds for found in checklist.hypotheses] == [True] * (1 + len(system.symmetries))


def numerically_reversible(system: ReversibleSystem, signs: Sequence[int], orientation: int) -> bool:
    """Whether f(R x) = orientation R f(x) at random points, in float64."""
    source = random.Random(0)
    for _ in range(5):
        x = [source.uniform(0.2, 0.6) for _ in system.state]
        p = [source.uniform(0.1, 0.4) for _ in system.parameters]
        image = system.vector_field([s * v for s, v in zip(signs, x, strict=True)], p)
        for s, left, right in zip(signs, image, system.vector_field(x, p), strict=True):
            if abs(left - orientation * s * right) > 1e-9 * (1 + abs(right)):
                return False
    return True


@pytest.mark.parametrize("name", SYSTEMS)
def test_exactly_the_true_sign_changes_are_accepted(name: str) -> None:
    """All sign matrices, against values of the vector field."""
    system = SYSTEMS[name]
    for signs in product((1, -1), repeat=len(system.state)):
        for orientation in (1, -1):
            shown = parities(system.program, signs) == [orientation * sign for sign in signs]
            assert shown == numerically_reversible(system, signs, orientation), (signs, orientation)


WRONG_REVERSALS = {
    "velocity of z negated with z": replace(CR3BP, reversing_symmetry=(1, -1, -1, 1, 1, -1)),
    "velocity kept": replace(CR3BP, reversing_symmetry=(1, -1, 1, 1, -1, -1), level_coordinate=None),
    "y kept": replace(FALKNER_SKAN, reversing_symmetry=(1, -1, -1)),
    "a term that breaks it": replace(
        FALKNER_SKAN,
        vector_field=lambda s, p: (s[1], s[2], p[0] * (s[1] * s[1] - 1) - s[0] * s[2] + s[0]),
    ),
    "an integral that is not invariant": replace(CR3BP, first_integral=lambda s, _: (s[0] + s[1],)),
    "friction": replace(
        CR3BP,
        vector_field=lambda s, p: (
            *CR3BP.vector_field(s, p)[:3],
            *(a - v for a, v in zip(CR3BP.vector_field(s, p)[3:], s[3:], strict=True)),
        ),
    ),
}


@pytest.mark.parametrize("name", WRONG_REVERSALS)
def test_wrong_reversals_are_refused(name: str) -> None:
    with pytest.raises(NotEstablishedError, match="not shown to have the symmetry R"):
        check_symmetries(Checklist(), WRONG_REVERSALS[name])


def test_a_true_symmetry_that_is_not_recognised_is_refused_with_the_way_to_write_it() -> None:
    def field(square: Any) -> Any:
        return lambda s, p: (s[1], s[2], p[0] * (s[1] * s[1] - 1) - s[0] * s[2] + square(s))

    factored, expanded = (
        replace(FALKNER_SKAN, vector_field=field(square))
        for square in (lambda s: (s[1] + s[0]) * (s[1] - s[0]), lambda s: s[1] * s[1] - s[0] * s[0])
    )
    assert numerically_reversible(factored, factored.reversing_symmetry, -1)
    check_symmetries(Checklist(), expanded)
    with pytest.raises(NotEstablishedError, match="not shown to have the symmetry R") as refusal:
        check_symmetries(Checklist(), factored)
    assert "true and not be recognised: write sums of terms that R and S change alike" in refusal.value.reason.remedy


@pytest.mark.parametrize(
    "distance",
    [lambda s, p: (s[0] * s[0] + s[1] * s[1] * s[1] + 1,), lambda s, p: (s[1],), lambda s, p: (1 + s[0] * s[1],)],
    ids=["odd and even", "odd", "mixed product"],
)
def test_a_distance_that_the_reversal_changes_is_refused(distance: Any) -> None:
    wrong = replace(CR3BP, squared_distance=distance, distance_name="the body")
    with pytest.raises(NotEstablishedError, match=r"the distance .* not shown to have the symmetry R"):
        check_symmetries(Checklist(), wrong)


WRONG_SYMMETRIES = {
    "R itself": CR3BP.reversing_symmetry,
    "x and its velocity": (-1, 1, 1, -1, 1, 1),
    "z without its velocity": (1, 1, -1, 1, 1, 1),
    "everything": (-1, -1, -1, -1, -1, -1),
}


@pytest.mark.parametrize("name", WRONG_SYMMETRIES)
def test_wrong_symmetries_are_refused(name: str) -> None:
    system = replace(CR3BP, symmetries={"S": WRONG_SYMMETRIES[name]})
    check_symmetries(Checklist(), system)
    with pytest.raises(NotEstablishedError, match="not shown to have the symmetry S"):
        check_symmetries(Checklist(), system, "S")
    with pytest.raises(NotEstablishedError, match="no symmetry T"):
        check_symmetries(Checklist(), system, "T")


def test_the_identity_is_a_symmetry() -> None:
    checklist = Checklist()
    check_symmetries(checklist, replace(CR3BP, symmetries={"S": (1,) * 6}), "S")
    assert [found.holds for found in checklist.hypotheses] == [True]


def test_parities_of_all_operations() -> None:
    def operations(x: Sequence[Any], p: Sequence[Any]) -> Sequence[Any]:
        odd, even = x
        (parameter,) = p
        return (
            odd + odd, odd - even, odd * even, odd * odd, even / odd, odd**3, odd**-2, odd**0, even**-1.5,
            odd**0.5, (odd + even) ** 2, odd * parameter, odd + 1, parameter - 1, -odd, odd ** Fraction(1, 3),
        )  # fmt: skip

    found = parities(record(operations, ("odd", "even"), ("parameter",)), (-1, 1))
    assert found == [-1, 0, -1, 1, -1, -1, 1, 1, 1, 0, 0, -1, 0, 1, -1, 0]


def test_a_symmetry_leaves_what_is_no_coordinate_of_the_state_alone() -> None:
    assert signs_on(CR3BP, "S", ("Jacobi constant", "x", "z", "vy")) == (1, 1, -1, 1)


def test_a_symmetry_that_moves_the_level_coordinate_is_not_adapted() -> None:
    form = replace(known("em1"), level_sign=1)
    moving = replace(CR3BP, symmetries={"S": (1, 1, -1, 1, -1, -1)})
    with pytest.raises(NotEstablishedError, match="S does not fix vy"):
        check_adapted_frames(Checklist(), replace(form, system=moving))


def test_the_rows_of_the_kernel_frame_are_adapted() -> None:
    system = replace(description(3, False), symmetries={"S": (-1, 1, 1, 1, 1, 1, -1)})
    one, zero = Fraction(1), Fraction(0)
    rows = ((zero, zero, one), (one, zero, zero), (zero, one, zero))
    candidate = claim(system, "symmetry_breaking", 1, [one] * 4, kernel_frame=rows)
    check_adapted_frames(Checklist(), candidate)
    with pytest.raises(NotEstablishedError, match="row of kernel_frame"):
        check_adapted_frames(Checklist(), replace(candidate, kernel_frame=tuple(zip(*rows, strict=True))))


def test_a_level_without_a_square_of_the_coordinate_is_none() -> None:
    for integral in (lambda s, _: (s[0],), lambda s, _: (s[4] * s[4] - s[4] * s[4],), lambda s, _: (s[4] * s[0],)):
        system = replace(CR3BP, first_integral=integral)
        with pytest.raises(NotEstablishedError, match="does not show it"):
            check_level(Checklist(), replace(known("em1"), system=system, level_sign=1))
