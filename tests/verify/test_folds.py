"""Folds as claims: true ones are proved with the numbers of the curve, everything else is refused by name."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.claims import distances, known, moved, shifted, verdict_of, with_radii
from support.closed_form_maps import claim, description, table, verdict
from support.map_cases import failed, proof
from support.within import within

from orbitproof.shared.formats import Candidate, InputError, candidate_from_json, candidate_to_json, read_candidates
from orbitproof.verify.bifurcation import BifurcationResults, fold, proved_bifurcation, theorem_of
from orbitproof.verify.certificate import Certificate, Limits, certify
from orbitproof.verify.evidence import Checklist, NotProved, Outcome, bounds, enclose

Function = Callable[[Sequence[Any], Callable[[F], Any]], Any]

R = F(1, 2**10)
RADII = (8 * R * R, R)
RADII_2 = (8 * R * R, R, 8 * R * R)
FOLDS = Path(__file__).parents[1] / "data" / "known-folds.json"
ACCURACY = F(1, 10**48)
EXTREMA = {
    "earth-moon-L1-halo-fold-1": ("above", "2.9978432075945873"),
    "earth-moon-L1-halo-fold-2": ("below", "3.0040154236632148"),
    "earth-moon-L2-halo-fold-1": ("above", "3.0151775942626558"),
    "michelson-family-fold-1": ("below", "1.2662323370691989"),
}
"""Side and first digits of the parameter."""

precision = within(lambda: ctx.workprec(300))


def upward(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
    """p_0 = p_1^2 + p_1^3 + p_0 p_1."""
    return p[0] + p[1] * p[1] * c(F(-1)) + p[1] * p[1] * p[1] * c(F(-1)) + p[0] * p[1] * c(F(-1))


def downward(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
    return p[0] + p[1] * p[1]


def across(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
    """p_2 = 2 p_0 + p_1^2 / 2."""
    return p[2] + p[0] * c(F(-2)) + p[1] * p[1] * c(F(-1, 2))


def outcome(
    equations: Sequence[Function], radii: Sequence[F], level: Function | None = None
) -> Outcome[BifurcationResults]:
    tables = [[table(equation, radii) for equation in equations]]
    integral = None if level is None else table(level, radii)
    candidate = claim(description(len(radii) - 1, level is not None), "fold", 1, radii)
    return verdict(candidate, tables, integral)


def test_a_theorem_says_nothing_of_claims_of_another_kind() -> None:
    turning, branching, breaking = claim(description(1, False), "fold", 1, RADII), known("fs3"), known("em1")
    for theory, about in ((fold, turning), (proved_bifurcation, branching), (proved_bifurcation, breaking)):
        assert theory.theorem_of(about) == theorem_of(about)
    for theory, other in (
        (fold, branching), (fold, breaking), (fold, replace(turning, k=2)),
        (proved_bifurcation, turning), (proved_bifurcation, replace(turning, k=2)),
        (proved_bifurcation, replace(breaking, k=2)), (proved_bifurcation, replace(known("fs2"), k=1)),
    ):  # fmt: skip
        refused = theory.prove(other, Checklist(), (), None)
        assert isinstance(refused, NotProved)
        assert refused.reason.condition == "theorem"


@pytest.mark.parametrize("equation, side, beta", [(upward, "above", 1), (downward, "below", -1)])
def test_a_curve_that_turns_back_in_the_parameter_is_a_fold(equation: Function, side: str, beta: int) -> None:
    for equations, radii in (([equation], RADII), ([equation, across], RADII_2)):
        found = proof(outcome(equations, radii))
        assert [h.name for h in found.hypotheses][-3:] == ["curve", "extremum", "point"]
        assert found.results.side == side
        assert found.results.parameter.contains(0)
        assert found.results.normal_form["beta"].contains(beta)
        assert found.results.normal_form["beta"].rad() < 1e-2


def test_the_level_of_a_first_integral_turns_back_where_its_restriction_to_the_curve_does() -> None:
    # On p_0 = p_1^2, p_2 = 5 p_1^2 / 2 the level 2 p_0 - 3 p_1^2 + p_0 p_2 + 4 p_2 is 9 p_1^2 to second order.
    def level(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
        return p[0] * c(F(2)) + p[1] * p[1] * c(F(-3)) + p[0] * p[2] + p[2] * c(F(4))

    found = proof(outcome([lambda p, c: p[0] + p[1] * p[1] * c(F(-1)), across], RADII_2, level))
    assert found.hypotheses[-1].name == "dH/dp_0"
    assert found.results.side == "above"
    assert found.results.normal_form["beta"].contains(9)


def test_the_extremum_beside_the_centre_is_enclosed() -> None:
    # p_0 = (p_1 - R/4)^2 - R^2/16: least at p_1 = R/4.
    found = proof(outcome([lambda p, c: p[0] + p[1] * c(R / 2) + p[1] * p[1] * c(F(-1))], RADII)).results
    assert found.local[1].contains(arb(2) ** -12)
    assert found.local[1].rad() < arb(2) ** -80
    assert found.parameter.contains(-(arb(2) ** -24))


@pytest.mark.parametrize("seed", range(6))
def test_the_extremum_of_a_random_cubic_is_enclosed_though_its_curvature_varies(seed: int) -> None:
    """p_0 = a (p_1 - e)^2 + b (p_1 - e)^3 less its value at 0: g' vanishes at e, and g'' varies by half over P_1."""
    source = random.Random(seed)
    e, a = F(source.choice((-1, 1)) * source.randint(1, 7), 16) * R, F(source.choice((-1, 1)) * source.randint(2, 6), 4)
    b = a * F(source.randint(-4, 4) or 3, 40) / R

    def cubic(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
        square = p[1] * p[1]
        linear = 2 * a * e - 3 * b * e * e
        return p[0] + p[1] * c(linear) + square * c(3 * b * e - a) + square * p[1] * c(-b)

    found = proof(outcome([cubic], RADII)).results
    assert found.local[1].contains(enclose(e))
    assert found.local[1].rad() < 2.0**-20
    assert found.normal_form["beta"].contains(enclose(a))
    assert found.side == ("above" if a > 0 else "below")


@pytest.mark.parametrize(
    "equation, condition",
    [
        (lambda p, c: p[0] + p[1] * c(-4 * R) + p[1] * p[1] * c(F(-1)), "extremum"),
        (lambda p, c: p[0] + p[1] * p[1] * p[1] * c(F(-1)), "extremum"),
        (lambda p, c: p[0], "extremum"),
        (lambda p, c: p[0] + p[1] * p[1] * c(F(-9)), "curve"),
        (lambda p, c: p[1] * (p[0] + p[1] * p[1] * c(F(-1))), "curve"),
        (lambda p, c: p[0] * p[0] + p[1] * p[1] * c(F(-1)), "curve"),
        (lambda p, c: p[1] + p[0] * p[0], "curve"),
    ],
    ids=["no extremum", "inflection", "constant", "leaves the box", "pitchfork", "crossing", "graph over p_0"],
)  # fmt: skip
def test_what_is_no_fold_is_refused(equation: Function, condition: str) -> None:
    failed(outcome([equation], RADII), condition)


def test_an_extremum_that_lies_outside_the_box_is_excluded() -> None:
    steep = failed(outcome([lambda p, c: p[0] + p[1] * c(-4 * R) + p[1] * p[1] * c(F(-1))], RADII), "extremum")
    assert steep.reason.excluded


def test_a_first_integral_without_a_slope_is_no_parameter() -> None:
    # The square of a first integral has an extremum wherever that vanishes, also where no curve turns back.
    def square(p: Sequence[Any], c: Callable[[F], Any]) -> Any:
        return (p[0] + p[1]) * (p[0] + p[1])

    failed(outcome([lambda p, c: p[0] + p[1] * p[1] * c(F(-1))], RADII, square), "dH/dp_0")


@cache
def folds() -> dict[str, Candidate]:
    return {candidate.id: candidate for candidate in read_candidates(FOLDS)}


@cache
def certified(name: str, level: str = "auto") -> Certificate:
    return certify(folds()[name], Limits(max_precision=256, level=level))


@pytest.mark.parametrize("name", EXTREMA)
def test_an_extremum_along_a_real_family_is_proved_and_enclosed(name: str) -> None:
    certificate = certified(name)
    side, digits = EXTREMA[name]
    assert verdict_of(certificate) == "proved"
    assert certificate.side == side
    assert max(distances(certificate, folds()[name].centre)) <= ACCURACY
    assert certificate.parameter is not None
    lower, upper = bounds(certificate.parameter)
    assert F(digits) - F(1, 10**16) < lower <= upper < F(digits) + F(2, 10**16)
    assert "Fold means" in certificate.statement["in_full"]
    assert "fold, proved" in str(certificate)


@pytest.mark.slow
def test_both_forms_of_the_parameter_prove_the_same_fold() -> None:
    forms = [certified("earth-moon-L1-halo-fold-1", level) for level in ("coordinates", "integral")]
    assert [certificate.proved for certificate in forms] == [True, True]
    first, second = (certificate.parameter for certificate in forms)
    assert first is not None
    assert second is not None
    assert agree(first, second)
    assert forms[0].side == forms[1].side
    assert agree(forms[0].normal_form["beta"], forms[1].normal_form["beta"])


def refusal(candidate: Candidate, level: str = "coordinates") -> str:
    return verdict_of(certify(candidate, Limits(max_precision=256, level=level)))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["michelson-family-fold-1", "earth-moon-L1-halo-fold-1"])
def test_a_box_beside_the_fold_is_refused(name: str) -> None:
    fold = folds()[name]
    assert refusal(moved(fold, 0, 3)) == "curve"
    assert refusal(moved(fold, 0, -3)) == "curve"
    # Wide enough across for the curve to stay inside, but a regular piece of it.
    beside = shifted(fold, (F(0), 3 * fold.radii[1], *[F(0)] * (len(fold.radii) - 2)))
    assert refusal(with_radii(beside, 16, 1, *[16] * (len(fold.radii) - 2))) == "extremum"


def test_a_fold_is_no_symmetry_breaking_and_no_resonance() -> None:
    fold = folds()["earth-moon-L1-halo-fold-1"]
    assert refusal(replace(fold, kind="symmetry_breaking", symmetry="S")) == "adapted-frames"
    assert refusal(replace(fold, kind="period_tupling", k=2)) != "proved"
    assert refusal(replace(fold, k=2)) == "theorem"


def test_a_symmetry_breaking_and_a_resonance_are_no_folds() -> None:
    assert refusal(replace(known("em1"), kind="fold", symmetry=None)) == "curve"
    assert refusal(replace(known("fs2"), kind="fold", k=1)) in ("curve", "extremum")
    assert refusal(replace(known("fs3"), kind="fold", k=1)) in ("curve", "extremum")


def test_a_fold_with_another_multiplicity_is_no_claim() -> None:
    entry = candidate_to_json(folds()["earth-moon-L1-halo-fold-1"]) | {"k": 2}
    with pytest.raises(InputError, match="k: fold with k = 2"):
        candidate_from_json(entry, "claim")
