"""Births of orbits that R does not map to themselves, proved once more: closed forms, forgeries, false claims."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx
from support import breaking_cases as cases
from support.balls import agree
from support.forgeries import changed, move
from support.steps import made_once
from support.within import within

from orbitproof.shared.numbers import format_exact
from orbitproof.shared.systems import FixedLevel, ReversibleSystem, describe
from orbitproof.shared.systems.system import Reversor
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import BadCertificate, NotProved, ProvedBirth, births, read_claim, second_proof
from orbitproof.verify.second_proof.halves import SymmetricStatement, begun, half_orbit
from orbitproof.verify.second_proof.jets import CannotFollow, precision

F = Fraction

same_orbits_are_followed_once = within(lambda: made_once(), "module")


@pytest.fixture(scope="module")
def certificate() -> dict[str, Any]:
    return certify(cases.modes(kernel_frame=((F(2),),)), Limits(digits=8)).to_json()


@pytest.fixture(scope="module")
def proof(certificate: dict[str, Any]) -> ProvedBirth:
    return proved(certificate)


def proved(certificate: dict[str, Any]) -> ProvedBirth:
    found = second_proof(certificate)
    assert isinstance(found, ProvedBirth), str(found)
    return found


def test_the_point_is_that_of_mathieus_equation(proof: ProvedBirth) -> None:
    with ctx.workprec(300):
        level = cases.level_of(odd=True)
        exact = arb(level.numerator) / level.denominator
        assert abs(proof.parameter - exact) < arb(2) ** -140
        assert proof.period.contains(2 * arb.pi())
        assert abs(proof.point["vy"] - exact.sqrt()) < arb(2) ** -120
        assert abs(proof.other_point["vy"] + exact.sqrt()) < arb(2) ** -100
    assert proof.point["x"].contains(0)
    assert proof.other_point["x"].contains(0)
    assert float(proof.parameter.rad()) < 1e-30
    names = ["newton", "crossings", "sheet", "integral", "curve", "side", "frame"]
    assert [h.name for h in proof.hypotheses] == names
    assert all(h.holds for h in proof.hypotheses)


def test_new_orbits_are_where_another_integration_finds_them(proof: ProvedBirth) -> None:
    """q = y w + .. with (B w)_1 = 1: here vx = y/2."""
    assert proof.side == "above"
    (direction,) = proof.direction.values()
    assert direction.contains(0.5)
    y, rises = 0.01, []
    for reach in (y, 2 * y):
        rises.append((cases.level_beside(reach / 2) - float(cases.level_of(odd=True))) / reach**2)
    # The next term of kappa y^2 + .. is taken away.
    assert float(proof.opening) == pytest.approx((4 * rises[0] - rises[1]) / 3, rel=1e-5)


def test_its_certificate_agrees(certificate: dict[str, Any], proof: ProvedBirth) -> None:
    found = compare(certificate, proof)
    assert found.verdict == "agrees", found.reason
    said, unsaid = found.reason.split("Not confirmed: ")
    assert "parameter" in said
    assert "kappa" in said
    left = ", gamma and beta but for their quotient, that the candidate's box holds no other orbits"
    assert re.fullmatch(r"point.x beyond .*e-\d+, other_point.x beyond .*e-\d+", unsaid.removesuffix(left))


DIFFERENCES: dict[str, Callable[[dict[str, Any]], object]] = {
    "side: below": lambda c: c["results"].update(side="below"),
    "parameter:": lambda c: move(c["results"]["parameter"]),
    "period:": lambda c: move(c["results"]["period"]),
    "normal_form.kappa:": lambda c: move(c["results"]["opening"], F(1, 2)),
    "point.x:": lambda c: move(c["results"]["point"]["x"]),
    "point.vy:": lambda c: move(c["results"]["point"]["vy"]),
    "other_point.vy:": lambda c: move(c["results"]["other_point"]["vy"]),
    "direction.vx:": lambda c: move(c["results"]["direction"]["vx"]),
    "direction: other coordinates": lambda c: c["results"]["direction"].update(y=c["results"]["period"]),
    "the point is not in the box": lambda c: c["statement"]["candidate"].update(
        centre=[format_exact(cases.level_of(odd=True) + F(1, 2**40)), "0x0"]
    ),
}


@pytest.mark.parametrize("begin", DIFFERENCES)
def test_every_difference_is_told(certificate: dict[str, Any], proof: ProvedBirth, begin: str) -> None:
    found = compare(changed(certificate, DIFFERENCES[begin]), proof)
    assert (found.verdict, found.reason[: len(begin)]) == ("disagrees", begin)


def test_without_a_sign_of_kappa_nothing_is_proved(
    certificate: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = births.form

    def wide(rows: Any, *vectors: Any) -> Any:
        return [value + arb(0, 2**20) if len(vectors) == 3 else value for value in exact(rows, *vectors)]

    monkeypatch.setattr(births, "form", wide)
    found = second_proof(certificate)
    assert isinstance(found, NotProved)
    assert "side is not shown" in found.reason


def test_kappa_that_may_be_0_is_not_confirmed(certificate: dict[str, Any], proof: ProvedBirth) -> None:
    wide = replace(proof, opening=arb(0, 10))
    assert compare(certificate, wide).verdict == "cannot follow"
    somewhere = replace(proof, coordinates=(arb(0, 1), proof.coordinates[1]))
    assert compare(certificate, somewhere).verdict == "cannot follow"


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("centre", [format_exact(cases.level_of(odd=False)), "0x0"]),
        ("crossings", 2),
        pytest.param("parameters", {"a": "25e-2"}, marks=pytest.mark.slow),
    ],
    ids=["S breaks there", "crossings", "another system"],
)
def test_false_claims_are_not_proved(certificate: dict[str, Any], field: str, value: Any) -> None:
    found = second_proof(changed(certificate, lambda c: c["statement"]["candidate"].update({field: value})))
    assert isinstance(found, NotProved)


def test_the_other_point_is_one_too(certificate: dict[str, Any], proof: ProvedBirth) -> None:
    """With the other sign of vy; w is that of the other point, and so is kappa."""

    def other(entry: dict[str, Any]) -> None:
        entry["statement"]["candidate"]["level_sign"] = -1
        text = entry["statement"]["level_coordinate"]
        last = text.rsplit("return ", 1)[1]
        number = int(last.removeprefix("v"))
        entry["statement"]["level_coordinate"] = (
            text.rsplit("return ", 1)[0] + f"v{number + 1} = -1\nv{number + 2} = {last} * v{number + 1}"
            f"\nreturn v{number + 2}"
        )

    found = proved(changed(certificate, other))
    assert agree(found.parameter, proof.parameter)
    assert agree(found.point["vy"], proof.other_point["vy"])
    assert found.side == proof.side


def test_statements_that_cannot_be_read_are_refused(certificate: dict[str, Any]) -> None:
    for change in (
        lambda c: c["statement"]["candidate"].update(k=2),
        lambda c: c["statement"]["candidate"].update(symmetry="S"),
        lambda c: c["statement"]["candidate"].update(level_sign=0),
        lambda c: c["statement"]["candidate"].update(parameters={}),
        lambda c: c["statement"].pop("level_coordinate"),
        lambda c: c["statement"].update(level_coordinate="v0 = level\nreturn v0"),
    ):
        with pytest.raises(BadCertificate):
            read_claim(changed(certificate, change))
    # R is no symmetry of this field.
    field = certificate["statement"]["vector_field"].replace("return v2, v3", "return v0, v3")
    found = second_proof(changed(certificate, lambda c: c["statement"].update(vector_field=field)))
    assert isinstance(found, NotProved)
    assert "R is not shown" in found.reason


def test_a_half_orbit_ends_with_the_crossing_that_is_claimed(certificate: dict[str, Any]) -> None:
    claim = read_claim(certificate)
    assert isinstance(claim, SymmetricStatement)
    with precision(200):
        values = dict(zip(claim.places, claim.begin(), strict=True))
        start = begun(claim.system, values, claim.places, 1)
        end, _ = half_orbit(claim.system, start, arb.pi(), 200)
        assert abs(end[1][()]) < arb(2) ** -100
        for time in (arb.pi() - 0.75, arb.pi() + 1, arb.pi() + arb(0, 1)):
            with pytest.raises(CannotFollow, match="does not end with the crossing"):
                half_orbit(claim.system, start, time, 200)


def test_the_sign_of_the_coordinate_is_the_one_that_is_claimed(certificate: dict[str, Any]) -> None:
    """The stated function for vy, with which the search begins, is the one of the other sign."""
    found = second_proof(changed(certificate, lambda c: c["statement"]["candidate"].update(level_sign=-1)))
    assert isinstance(found, NotProved)
    assert "sheet is not shown" in found.reason


def test_the_integral_tells_the_coordinate_that_is_left_out(
    certificate: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    slopes = births._Proof.integral_slopes
    monkeypatch.setattr(births._Proof, "integral_slopes", lambda *at: slopes(*at).map(lambda c: c + arb(0, 100)))
    found = second_proof(certificate)
    assert isinstance(found, NotProved)
    assert "integral is not shown" in found.reason


def test_a_side_that_is_not_known_is_not_told(certificate: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    form = births.form
    monkeypatch.setattr(births, "form", lambda *given: [value + arb(0, 1000) for value in form(*given)])
    found = second_proof(certificate)
    assert isinstance(found, NotProved)
    assert "side is not shown" in found.reason


@pytest.mark.slow
def test_an_integral_that_is_not_kept_is_found(certificate: dict[str, Any]) -> None:
    """H + x^2 is H on the normal mode, but not beside it."""

    def bent(entry: dict[str, Any]) -> None:
        *lines, last = entry["statement"]["first_integral"].split("\n")
        x = next(line.partition(" = ")[0] for line in lines if line.endswith(" = x"))
        n = len(lines)
        lines += [f"v{n} = {x} * {x}", f"v{n + 1} = {last.removeprefix('return ')} + v{n}", f"return v{n + 1}"]
        entry["statement"]["first_integral"] = "\n".join(lines)

    found = second_proof(changed(certificate, bent))
    assert isinstance(found, NotProved)
    assert "the first integral is not kept" in found.reason


def on_level() -> ReversibleSystem:
    return replace(
        cases.MODES,
        family_parameter="a",
        fixed_level=FixedLevel(cases.level_of(odd=True), 1),
    )


@pytest.fixture(scope="module")
def on_fixed_level() -> dict[str, Any]:
    claim = cases.modes(
        system=on_level(), parameters={}, centre=(cases.A, F(0)), level_sign=None, radii=(F(1, 2**60),) * 2
    )
    return certify(claim, Limits(digits=8)).to_json()


def test_a_family_parameter_on_a_fixed_level_varies(on_fixed_level: dict[str, Any], proof: ProvedBirth) -> None:
    """dh/da along the curve of births is negative, so that kappa has the other sign here."""
    assert on_fixed_level["verdict"] == "proved", on_fixed_level["reason"]
    found = proved(on_fixed_level)
    assert abs(found.parameter - arb(9) / 10) < arb(2) ** -40
    assert compare(on_fixed_level, found).verdict == "agrees", compare(on_fixed_level, found).reason
    assert found.side == on_fixed_level["results"]["side"]


def test_an_interval_of_the_level_coordinate_is_not_followed(on_fixed_level: dict[str, Any]) -> None:
    level = {"value": on_fixed_level["statement"]["candidate"]["system"]["fixed_level"]["value"], "between": ["0", "9"]}
    found = second_proof(
        changed(on_fixed_level, lambda c: c["statement"]["candidate"]["system"].update(fixed_level=level))
    )
    assert isinstance(found, NotProved)
    assert "not an interval" in found.reason


def test_the_coordinate_that_follows_from_the_level_is_the_reversors_own(on_fixed_level: dict[str, Any]) -> None:
    own = Reversor(cases.MODES.reversing_symmetry, "T", "y", "vy")
    first = {"reversing_symmetry": (-1, 1, 1, -1), "section": "x", "level_coordinate": "vx"}
    system = replace(on_level(), **first, reversors={"T": own}).under("T")
    entry = changed(on_fixed_level, lambda c: c["statement"]["candidate"].update(system=describe(system)))
    found = proved(entry)
    assert compare(entry, found).verdict == "agrees", compare(entry, found).reason


@pytest.mark.slow
def test_the_halo_orbits_of_L1_lose_R_as_the_first_proof_says() -> None:
    """n = 2."""
    certificate = certify(cases.halo(), Limits(digits=8)).to_json()
    found = proved(certificate)
    comparison = compare(certificate, found)
    assert comparison.verdict == "agrees", comparison.reason
    assert found.side == "below"
