"""The level of the first integral as parameter: exact initial values, the same bifurcations."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.claims import known, moved
from support.within import within

from orbitproof.shared import InputError
from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import (
    candidate_from_json,
    candidate_to_json,
    load_system,
    read_candidates,
    write_candidates,
)
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, LEVEL_NAME, ParameterRange, ReversibleSystem
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits, missing_bits
from orbitproof.verify.bifurcation import enclose_first_integral, in_box, level_form
from orbitproof.verify.certificate import Certificate, certify, digest, is_proof_of, recheck
from orbitproof.verify.certificate.certifying import _forms
from orbitproof.verify.certificate.stated_system import is_level_text
from orbitproof.verify.claim import level_program, point_on_fixed_set, quadratic_coefficient
from orbitproof.verify.evidence import DerivativeTable, bounds, enclose
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings, enclose_iterates

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
ROWS = ["em1", "em2", "em3"]

precision = within(lambda: ctx.workprec(300))


def form_of(name: str) -> Candidate:
    form = level_form(known(name))
    assert form is not None
    return form


@cache
def certificate(name: str, level: str) -> Certificate:
    with ctx.workprec(53):
        return certify(known(name), Limits(level=level))


def with_integral(integral: Callable[..., Any]) -> ReversibleSystem:
    return replace(CR3BP, first_integral=lambda s, p: (integral(s[0], s[4]),))


@pytest.mark.parametrize(
    ("integral", "coefficient"),
    [
        (lambda x, w: x - w * w, F(-1)),
        (lambda x, w: 3 * (w * w) + x**-0.5, F(3)),
        (lambda x, w: (x - w * w) * -2, F(2)),
        (lambda x, w: x * x + w * F(1, 2) * w, F(1, 2)),
        (lambda x, w: (w + w) * w, F(2)),
        (lambda x, w: x / 3 - w * w / 2, F(-1, 2)),
        (lambda x, w: (w * 2**-1) ** 2 + x, F(1, 4)),
        (lambda x, w: w * w / (x * x + 1), None),
        (lambda x, w: w * w / (w / w), None),
        (lambda x, w: w * w / (x * x - x * x), None),
        (lambda x, w: x * x, F(0)),
        (lambda x, w: w * w - w * w, F(0)),
        (lambda x, w: w * w + w, None),
        (lambda x, w: w * w + x * w, None),
        (lambda x, w: w * w * w, None),
        (lambda x, w: (x + w) * (x + w), None),
        (lambda x, w: (w * w + x) ** 0.5, None),
        (lambda x, w: x / w, None),
        (lambda x, w: x * (w * w), None),
        (lambda x, w: w * w + (x * x + 1) ** 0.5, F(1)),
        (lambda x, w: w * w + (w * w) ** 0.5 / w, None),
        (lambda x, w: (x + w) * (x + w) - (w + w) * x, F(1)),
    ],
)
def test_a_quadratic_dependence_is_found_exactly_where_the_program_shows_it(integral: Any, coefficient: Any) -> None:
    assert quadratic_coefficient(with_integral(integral)) == coefficient


def test_there_is_a_level_form_only_where_the_first_integral_is_quadratic_in_the_level_coordinate() -> None:
    jacobi = CR3BP.first_integral
    assert jacobi is not None
    for more, there in ((lambda s: 0 * s[0], True), (lambda s: s[4] ** 4, False), (lambda s: s[0] * s[4], False)):
        system = replace(CR3BP, first_integral=lambda s, p, more=more: (jacobi(s, p)[0] + more(s),))
        assert (level_form(replace(known("em2"), system=system)) is not None) == there


def test_the_velocity_across_the_section_follows_from_the_jacobi_constant() -> None:
    assert quadratic_coefficient(CR3BP) == -1
    assert quadratic_coefficient(FALKNER_SKAN) is None
    with pytest.raises(ValueError, match="quadratic"):
        level_program(FALKNER_SKAN, 1)


def test_the_level_is_written_as_no_file_can_and_what_earlier_versions_wrote_is_the_same_program() -> None:
    own = level_program(CR3BP, 1).text()
    earlier = own.replace(LEVEL_NAME, "level")
    assert is_level_text(own, own)
    assert is_level_text(earlier, own)
    assert not is_level_text(None, own)
    assert not is_level_text(level_program(CR3BP, -1).text(), own)
    called_so = replace(with_integral(lambda x, w: x + w * w), parameters={"level": ParameterRange(None, None)})
    own = level_program(called_so, 1).text()
    assert not is_level_text(own.replace(LEVEL_NAME, "level"), own)


@pytest.mark.parametrize("sign", [1, -1])
def test_initial_values_have_the_given_level_and_sign(sign: int) -> None:
    source = random.Random(7)
    candidate = replace(form_of("em2"), level_sign=sign)
    mu = candidate.parameters["mu"]
    for _ in range(50):
        x, z = F(source.randint(820, 900), 1000), F(source.randint(0, 300), 1000)
        w = sign * F(source.randint(1, 400), 1000)
        (level,) = _jacobi(x, z, w, mu)
        point = point_on_fixed_set(candidate, {LEVEL_NAME: level, "x": enclose(x), "z": enclose(z)})
        assert point["vy"].contains(enclose(w))
        assert point["vy"].rad() < 1e-60
        assert list(point) == ["x", "z", "vy"]


def test_the_level_coordinate_is_enclosed_where_another_coordinate_is_known_to_be_near_zero() -> None:
    hill = load_system(EXAMPLES / "hill.py")
    candidate = replace(form_of("em1"), system=hill, parameters={})
    around = {LEVEL_NAME: arb("4.4 +/- 1e-40"), "x": arb("0.4"), "z": arb("0 +/- 1e-40")}
    at_zero = point_on_fixed_set(candidate, around | {"z": arb(0)})["vy"]
    assert point_on_fixed_set(candidate, around)["vy"].contains(at_zero)
    assert at_zero.is_finite()


def _jacobi(x: F, z: F, w: F, mu: F) -> list[arb]:
    larger, smaller = enclose((x + mu) ** 2 + z * z), enclose((x + mu - 1) ** 2 + z * z)
    return [enclose(x * x - w * w) + 2 * (enclose(1 - mu) / larger.sqrt() + enclose(mu) / smaller.sqrt())]


@pytest.mark.parametrize("name", ROWS)
def test_the_new_box_contains_the_old_one(name: str) -> None:
    source = random.Random(3)
    candidate, form = known(name), form_of(name)
    with ctx.workprec(900):
        for _ in range(60):
            p = [r * source.choice([-1, 1, F(source.randint(-99, 99), 100)]) for r in candidate.radii]
            x, z, w = (
                c + sum(a * b for a, b in zip(row, p, strict=True))
                for c, row in zip(candidate.centre, candidate.frame, strict=True)
            )
            (level,) = _jacobi(x, z, w, candidate.parameters["mu"])
            assert in_box(form, {LEVEL_NAME: level, "x": enclose(x), "z": enclose(z)})


@pytest.mark.parametrize("name", ["em1", "em2", "em4"])
def test_the_form_does_not_depend_on_how_the_arithmetic_rounds(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A certificate carries its form, and checking again has to find the same one, to the last bit."""
    candidate = known(name)
    shrunk = [replace(candidate, radii=tuple(r / 2**n for r in candidate.radii)) for n in range(40)]
    forms = [level_form(each) for each in shrunk]
    assert all(form is not None for form in forms)
    for bits in (2, 10**6):
        monkeypatch.setattr("orbitproof.verify.algebra.series._WORTH_CUTTING", bits)
        assert [level_form(each) for each in shrunk] == forms


def test_a_point_outside_is_not_in_the_box() -> None:
    candidate = known("em2")
    for j in range(3):
        for size in (F(101, 100), F(-101, 100)):
            p = [size * candidate.radii[j] * row[j] for row in candidate.frame]
            point = {n: enclose(c + d) for n, c, d in zip(candidate.coordinates, candidate.centre, p, strict=True)}
            assert not in_box(candidate, point)


def test_a_point_not_known_well_enough_for_the_box_asks_for_the_bits_that_it_lacks() -> None:
    candidate = known("em2")

    def at(place: F, width: F) -> int | None:
        """The bits that are asked for, with p_2 this far from the centre and so uncertain, in half-widths."""
        p_2 = place * candidate.radii[2]
        spread = arb(0, enclose(width * candidate.radii[2] / 4).upper())
        point = {n: enclose(c + p_2 * row[2]) + spread for n, c, row in
                 zip(candidate.coordinates, candidate.centre, candidate.frame, strict=True)}  # fmt: skip
        return missing_bits(candidate, point)

    asked = [at(F(1, 2), F(2) ** bits) for bits in (3, 20, 40)]
    assert all(bits is not None for bits in asked)
    assert [b - a for a, b in pairwise(asked)] == [pytest.approx(17 * 6 / 5, abs=2), pytest.approx(20 * 6 / 5, abs=2)]  # type: ignore[operator]
    assert at(F(1), F(1, 2**20)) is None
    assert at(F(3), F(1, 2)) is None


def _first(table: DerivativeTable, j: int) -> arb:
    return table.centre[tuple(int(i == j) for i in range(3))]


@pytest.mark.parametrize("name", ["em1", pytest.param("em2", marks=pytest.mark.slow)])
def test_derivatives_in_both_forms_obey_the_chain_rule(name: str) -> None:
    candidate, form = known(name), form_of(name)
    settings = IntegratorSettings(200)
    old, new = enclose_iterates(candidate, settings, ORACLE), enclose_iterates(form, settings, ORACLE)
    assert new.first_integral is None
    integral = enclose_first_integral(candidate, 200)
    assert integral is not None
    slope = [_first(integral, j) for j in range(3)]
    for left, right in zip(sum(old.iterates, ()), sum(new.iterates, ()), strict=True):
        assert agree(_first(right, 0), _first(left, 0) / slope[0])
        assert _first(right, 0).rad() < 1e-25
        for j in (1, 2):
            assert agree(_first(right, j), _first(left, j) - slope[j] / slope[0] * _first(left, 0))
            assert _first(right, j).rad() < 1e-5


def _same(name: str) -> None:
    _compare(certificate(name, "coordinates"), certificate(name, "integral"))


def _compare(one: Certificate, two: Certificate) -> None:
    assert one.proved
    assert two.proved
    assert "level_form" not in one.statement
    assert "level_form" in two.statement
    names = [hypothesis.name for hypothesis in two.hypotheses]
    assert {"level", "C2", "C3", "C4"} <= set(names)
    assert names[-2:] == ["level-box", "candidate-box"]
    assert "candidate's own box lies in this box" in str(two.theorem)
    assert not any(hypothesis.startswith("H") for hypothesis in names)
    assert one.side == two.side
    pairs = [(one.parameter, two.parameter)]
    pairs += [(one.point[key], two.point[key]) for key in ("x", "z", "vy")]
    pairs += [(one.normal_form[key], two.normal_form[key]) for key in ("alpha", "beta")]
    for a, b in pairs:
        assert agree(a, b)
        assert _relative_radius(a) < 1e-3
        assert _relative_radius(b) < 1e-3
    assert _relative_radius(two.parameter) < 1e-29


def _relative_radius(ball: arb) -> float:
    lower, upper = bounds(ball)
    size = max(abs(lower), abs(upper))
    return float((upper - lower) / size) if size else 0.0


@pytest.mark.parametrize(
    "name", ["em1", *(pytest.param(name, marks=pytest.mark.slow) for name in ("em2", "em3", "em4"))]
)
def test_both_forms_prove_the_same_bifurcation(name: str) -> None:
    _same(name)


FURTHER = Path(__file__).parents[1] / "data" / "figures-candidates.json"
SMALL_BOXES = {c.id: c for c in read_candidates(FURTHER) if c.system is CR3BP}


@pytest.mark.slow
@pytest.mark.parametrize("name", SMALL_BOXES)
def test_both_forms_prove_the_same_bifurcation_in_small_boxes(name: str) -> None:
    _compare(*(certify(SMALL_BOXES[name], Limits(level=level)) for level in ("coordinates", "integral")))


def test_false_claims_in_level_form_are_not_proved() -> None:
    form = form_of("em1")
    wrong = [
        replace(form, level_sign=-form.level_sign),  # type: ignore[operator]
        moved(form, 0, 3),
        moved(form, 2, 3),
        replace(form, frame=((F(2), F(0), F(0)), *form.frame[1:])),
    ]
    for candidate in wrong:
        result = certify(candidate, Limits(max_precision=256))
        assert not result.proved, candidate
    assert certify(form, Limits(max_precision=256)).proved


def test_a_point_in_the_new_box_only_is_not_proved() -> None:
    candidate = moved(known("em1"), 0, F(65, 64))
    form = level_form(candidate)
    assert form is not None
    result = certify(candidate, Limits(level="integral", max_precision=256))
    assert not result.proved
    assert result.reason.condition == "candidate-box"
    assert [hypothesis.name for hypothesis in result.hypotheses if not hypothesis.holds] == ["candidate-box"]
    assert recheck(result).stands
    assert certify(candidate, Limits(max_precision=256)).verdict == "not proved"


def test_the_better_conditioned_form_comes_first() -> None:
    candidate = known("em3")
    assert [form is None for form in _forms(candidate, Limits(level="auto"))] == [False, True]
    assert _forms(candidate, Limits(level="coordinates")) == [None]
    assert [form is None for form in _forms(candidate, Limits(level="integral"))] == [False]
    # p_1 along the family as well, and much longer than p_0: the levels then say little about p_0.
    frame = tuple((row[0], row[1] + row[0], row[2]) for row in candidate.frame)
    tangent = replace(candidate, frame=frame, radii=(candidate.radii[0] / 1024, *candidate.radii[1:]))
    assert [form is None for form in _forms(tangent, Limits(level="auto"))] == [True, False]
    assert _forms(known("fs2"), Limits(level="integral")) == [None]
    # P_2 so narrow that the level form would have to find the point far more accurately than it needs to itself.
    narrow = replace(candidate, radii=(*candidate.radii[:2], candidate.radii[0] / 2**160))
    assert [form is None for form in _forms(narrow, Limits())] == [True, False]


def test_a_candidate_without_a_level_form_is_taken_as_it_is() -> None:
    candidate = known("em2")
    assert level_form(form_of("em2")) is None
    at_rest = replace(candidate, centre=(*candidate.centre[:2], F(0)))
    wide = replace(candidate, radii=(F(1), F(1), F(1)))
    for changed in (at_rest, wide):
        assert level_form(changed) is None
        assert _forms(changed, Limits(level="integral")) == [None]


def test_a_level_form_is_a_candidate_of_its_own(tmp_path: Path) -> None:
    form = form_of("em1")
    entry = candidate_to_json(form)
    assert entry["parameter"] == "first integral"
    assert candidate_from_json(entry, "test") == form
    path = tmp_path / "candidates.json"
    write_candidates(path, [form])
    assert main([str(path), "--quiet", "--max-precision", "256"]) == 0
    for change in ({"parameter": None}, {"level_sign": None}):
        broken = {key: value for key, value in entry.items() if key not in change}
        with pytest.raises(InputError, match="belong together"):
            candidate_from_json(broken, "test")
    fs = candidate_to_json(known("fs2")) | {"parameter": "first integral", "level_sign": 1}
    with pytest.raises(InputError, match="falkner-skan"):
        candidate_from_json(fs, "test")


def test_certificates_in_level_form_are_kept_and_checked_again() -> None:
    candidate, proved = known("em1"), certificate("em1", "integral")
    assert is_proof_of(proved, candidate)
    assert not recheck(proved).findings

    def forged(change: Callable[[dict[str, Any]], Any]) -> Certificate:
        entry = proved.to_json()
        change(entry["statement"])
        entry["digest"] = digest(entry)
        return Certificate.from_json(entry)

    radii = proved.statement["level_form"]["radii"]
    forgeries = [
        forged(lambda claim: claim["level_form"].update(radii=[radii[0], radii[1], "0x1p-20"])),
        forged(lambda claim: claim["level_form"].update(level_sign=-1)),
        forged(lambda claim: claim.pop("level_form")),
        forged(lambda claim: claim.update(level_coordinate="return v0")),
        forged(lambda claim: claim.pop("level_coordinate")),
    ]
    for entry in forgeries:
        assert not is_proof_of(entry, candidate)
        assert not recheck(entry).stands
