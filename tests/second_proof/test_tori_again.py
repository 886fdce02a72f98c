"""Tori at elliptic orbits with n = 2, proved once more: known normal forms, springs, false claims."""

from __future__ import annotations

import random
from itertools import combinations_with_replacement
from types import SimpleNamespace
from typing import Any

import pytest
from flint import acb, arb, arb_mat
from support import tori_cases
from support.balls import agree
from support.within import within

from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import ball_from_json, ball_to_json
from orbitproof.verify.run.relation import agreement
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.run.second_symmetric import _torsion as compare_torsion
from orbitproof.verify.second_proof import CannotFollow, NotProved, ProvedSymmetric, second_proof
from orbitproof.verify.second_proof.crossing import TIME
from orbitproof.verify.second_proof.elliptic_tori import COMBINATIONS, torsion
from orbitproof.verify.second_proof.full_return import FullReturn
from orbitproof.verify.second_proof.jets import Jet, combine, precision, substitute

DEGREE, SIZE = 3, 4
TAU = ((2.0, -0.5), (0.75, 1.5))
ANGLES = (2.0, 0.7)

bits = within(lambda: precision(160))


def variable(i: int) -> Jet:
    return Jet({(i,): arb(1)}, DEGREE)


def normal_form(angles: tuple[float, float], tau: tuple[tuple[float, float], ...], growth: float = 0.0) -> list[Jet]:
    """z_j -> exp(i omega_j) z_j (1 + sum of (growth + i tau_jl) |z_l|^2), in real coordinates."""
    z = [variable(2 * j) + variable(2 * j + 1) * acb(0, 1) for j in (0, 1)]
    sizes = [variable(2 * j) * variable(2 * j) + variable(2 * j + 1) * variable(2 * j + 1) for j in (0, 1)]
    found = []
    for j, (angle, row) in enumerate(zip(angles, tau, strict=True)):
        rest = [size * acb(growth, t) for size, t in zip(sizes, row, strict=True)]
        image = z[j] * (Jet({(): acb(1)}, DEGREE) + rest[0] + rest[1]) * acb(arb(angle).cos(), arb(angle).sin())
        found += [image.map(lambda c: acb(c).real), image.map(lambda c: acb(c).imag)]
    return found


def returning(images: list[Jet], seed: int) -> FullReturn:
    """The same map in other coordinates, as the return of a flow that does not meet the section at one time."""
    chance = random.Random(seed)

    def number() -> arb:
        return arb(chance.randint(-8, 8)) / 8

    squares = list(combinations_with_replacement(range(SIZE), 2))
    bends = [Jet({a: number() for a in squares}, DEGREE) for _ in range(SIZE)]
    plain = [variable(i) for i in range(SIZE)]
    back = plain
    for _ in range(DEGREE):
        back = [x - q for x, q in zip(plain, substitute(bends, dict(enumerate(back))), strict=True)]
    moved = substitute(images, dict(enumerate(back)))
    there = [a + b for a, b in zip(moved, substitute(bends, dict(enumerate(moved))), strict=True)]
    matrix = [[number() + 2 * (i == j) for j in range(SIZE)] for i in range(SIZE)]
    inverse = arb_mat(matrix).inv().tolist()
    turned = [combine(plain, row, DEGREE) for row in inverse]
    there = [combine(substitute(there, dict(enumerate(turned))), row, DEGREE) for row in matrix]
    late = variable(TIME) + Jet({a: number() for a in squares} | {(i,): number() for i in range(SIZE)}, DEGREE)
    full = FullReturn.__new__(FullReturn)
    full.live, full.tangent, full.replaced, full.has_level = range(SIZE + 1), list(range(SIZE)), -1, False
    full.rows = [row + late * number() for row in there] + [late]
    full.end = full.rows
    full.claim = SimpleNamespace(system=SimpleNamespace(section=SIZE))  # type: ignore[assignment]
    return full


@pytest.mark.parametrize("seed", range(4))
def test_the_torsion_of_a_known_normal_form_is_found_in_other_coordinates(seed: int) -> None:
    found = torsion(returning(normal_form(ANGLES, TAU), seed))
    for value, angle in zip(found.rotation_numbers, ANGLES, strict=True):
        assert agree(value, arb(angle) / (2 * arb.pi()))
    assert [hypothesis.holds for hypothesis in found.hypotheses] == [True] * 3
    (a, b), (c, d) = found.rows
    # Vectors of other lengths divide a column by a square.
    for mine, other, known in ((a, c, arb(8) / 3), (b, d, -arb(1) / 3)):
        assert other > 0
        assert abs(mine / other - known) < 1e-30
    assert found.determinant > 0
    assert all(abs(value) < 1e-30 for value in found.defect)


def test_a_torsion_that_degenerates_or_a_map_that_is_not_reversible_shows_nothing() -> None:
    for tau, growth in ((((1.0, 2.0), (0.5, 1.0)), 0.0), (TAU, 0.25)):
        found = torsion(returning(normal_form(ANGLES, tau, growth), 1))
        assert [hypothesis.holds for hypothesis in found.hypotheses] == [True, True, False]


def test_resonances_up_to_order_four_are_none_of_tori() -> None:
    wanted = {(a, b) for a in range(-4, 5) for b in range(-4, 5) if 0 < abs(a) + abs(b) <= 4}
    assert {*COMBINATIONS, *((-a, -b) for a, b in COMBINATIONS)} == wanted
    assert len(COMBINATIONS) * 2 == len(wanted)
    for angles in ((2.0, 1.0), (2.25, 0.75)):
        with pytest.raises(CannotFollow, match="non-resonance"):
            torsion(returning(normal_form(angles, TAU), 2))


def test_tori_are_claimed_of_elliptic_orbits_only() -> None:
    images = normal_form(ANGLES, TAU)
    stretched = [images[0], images[1], variable(2) * arb(2), variable(3) * (arb(1) / 2)]
    with pytest.raises(CannotFollow, match="elliptic"):
        torsion(returning(stretched, 3))


def stored(value: float) -> dict[str, str]:
    return ball_to_json(arb(value))


COMPARED: dict[str, tuple[dict[str, Any], str]] = {
    "the same": ({}, ""),
    "other lengths of vectors": ({"torsion": [[stored(8), stored(-0.125)], [stored(3), stored(0.375)]]}, ""),
    "a sign": ({"torsion_determinant": stored(-3)}, "torsion_determinant"),
    "a determinant that may be 0": (
        {"torsion_determinant": {**stored(0.0), "rad": "0x1p-3"}},
        "torsion_determinant",
    ),
    "another torsion": ({"torsion": [[stored(2), stored(-0.5)], [stored(0.75), stored(2)]]}, "tau_11 tau_22"),
    "rows exchanged": ({"torsion": [[stored(0.75), stored(1.5)], [stored(2), stored(-0.5)]]}, "tau_11 tau_22"),
}


@pytest.mark.parametrize("change", COMPARED)
def test_a_stored_torsion_agrees_by_what_does_not_depend_on_vectors(change: str) -> None:
    found = torsion(returning(normal_form(ANGLES, TAU), 1))
    numbers = [ball_to_json(value) for value in found.rotation_numbers]
    (a, b), (c, d) = TAU
    results = {
        "rotation_numbers": numbers,
        "torsion": [[stored(a), stored(b)], [stored(c), stored(d)]],
        "torsion_determinant": stored(a * d - b * c),
    }
    changes, word = COMPARED[change]
    pairs: dict[str, Any] = {}
    answer = compare_torsion(results | changes, found, pairs)
    assert list(pairs)[:2] == ["rotation number 1", "rotation number 2"]
    assert [mine for mine, _ in pairs.values()][:2] == list(found.rotation_numbers)
    answer = answer or agreement([], pairs, [], True)
    assert answer.verdict == ("disagrees" if word else "agrees")
    assert word in answer.reason


def test_a_stored_determinant_that_may_be_zero_has_no_sign_not_even_the_negative_one() -> None:
    found = torsion(returning(normal_form(ANGLES, tuple(tuple(-t for t in row) for row in TAU[::-1])), 1))
    assert found.determinant < 0
    (a, b), (c, d) = found.rows
    results = {
        "rotation_numbers": [ball_to_json(value) for value in found.rotation_numbers],
        "torsion": [[ball_to_json(value) for value in row] for row in found.rows],
        "torsion_determinant": ball_to_json(a * d - b * c),
    }
    assert compare_torsion(results, found, {}) is None
    for ball in (arb(0, 1), arb(1)):
        answer = compare_torsion({**results, "torsion_determinant": ball_to_json(ball)}, found, {})
        assert answer is not None
        assert "torsion_determinant" in answer.reason


def test_coordinates_and_multipliers_are_in_the_order_of_the_rotation_numbers() -> None:
    # s_1 < s_2: of the angles 2.0 and 0.7 the first is the larger one, and tau_12 and tau_21 are of different signs.
    (a, b), (c, d) = torsion(returning(normal_form(ANGLES, TAU), 2)).rows
    assert [value > 0 for value in (a, b, c, d)] == [True, False, True, True]
    (a, b), (c, d) = torsion(returning(normal_form(ANGLES[::-1], TAU), 2)).rows
    assert [value > 0 for value in (a, b, c, d)] == [True, True, False, True]


@pytest.mark.slow
def test_tori_beside_a_spring_are_proved_again_and_other_torsions_disagree() -> None:
    certificate: Any = certify(tori_cases.claim(tori_cases.BENT), Limits(digits=12, max_precision=128)).to_json()
    found = second_proof(certificate)
    assert isinstance(found, ProvedSymmetric), found
    assert compare(certificate, found).verdict == "agrees"
    results = certificate["results"]
    (a, b), (c, d) = results["torsion"]
    negative = next(entry for entry in (a, b, c, d) if ball_from_json(entry) < 0)
    for change in ({"torsion": [[b, a], [c, d]]}, {"torsion_determinant": negative}):
        assert compare({**certificate, "results": {**results, **change}}, found).verdict == "disagrees"
    numbers = results["rotation_numbers"][::-1]
    assert compare({**certificate, "results": {**results, "rotation_numbers": numbers}}, found).verdict == "disagrees"
    linear = certify(tori_cases.claim(tori_cases.LINEAR), Limits(digits=8, max_precision=128)).to_json()
    refused = second_proof(linear)
    assert isinstance(refused, NotProved)
    assert "torsion" in refused.reason
