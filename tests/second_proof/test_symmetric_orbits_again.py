"""Symmetric orbits, and those that are stable for ever, proved once more: closed forms, forgeries, false claims."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache
from types import SimpleNamespace
from typing import Any

import mpmath
import pytest
from flint import acb, arb, ctx
from support import tori_cases
from support.balls import agree
from support.forgeries import changed, move
from support.springs import BITS, CLAIMS, SPRINGS, contains, half, spring
from support.steps import few_bits, made_once

from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, LEVEL, ORBIT, STABLE_ORBIT, Candidate, Equation
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import ball_to_json
from orbitproof.verify.run.relation import Comparison
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import BadCertificate, NotProved, ProvedSymmetric, read_claim, second_proof
from orbitproof.verify.second_proof.full_return import FullReturn
from orbitproof.verify.second_proof.halves import read_symmetric
from orbitproof.verify.second_proof.jets import CannotFollow, precision
from orbitproof.verify.second_proof.statement import Program
from orbitproof.verify.second_proof.symmetric_orbit import _Proof, guess

F = Fraction
UNIT = ((F(1), F(0)), (F(0), F(1)))


@pytest.fixture(scope="module", autouse=True)
def same_orbits_are_followed_once() -> Iterator[None]:
    with made_once(), few_bits():
        yield


@pytest.fixture(scope="module")
def certificate() -> dict[str, Any]:
    return certify(spring(), Limits(digits=10)).to_json()


@pytest.fixture(scope="module")
def proof(certificate: dict[str, Any]) -> ProvedSymmetric:
    return proved(certificate)


def proved(certificate: dict[str, Any]) -> ProvedSymmetric:
    found = second_proof(certificate)
    assert isinstance(found, ProvedSymmetric), str(found)
    return found


def test_the_twist_of_a_spring_beside_another_is_a_derivative_of_an_elliptic_integral(proof: ProvedSymmetric) -> None:
    """z = y + i vy / w^(1/2) turns back by theta(|z|^2), and w^(1/2) |z|^2 is |w|^2."""
    with mpmath.workprec(BITS):
        root, a = mpmath.sqrt(2), mpmath.mpf(3) / 2

        def angle(rho: Any) -> Any:
            level = a**2 + a**4 / 2 - 2 * rho
            return 2 * root * half(mpmath.sqrt(mpmath.sqrt(1 + 2 * level) - 1))

        turn = angle(mpmath.mpf(0)) % (2 * mpmath.pi)
        sign = 1 if turn < mpmath.pi else -1
        omega = turn if sign > 0 else 2 * mpmath.pi - turn
        assert proof.rotation_number is not None
        assert contains(proof.rotation_number, omega / (2 * mpmath.pi), 1e-30)
        assert contains(proof.twists["y"], sign * mpmath.diff(angle, 0) / root, 1e-15)
        assert contains(proof.stability[0].real, mpmath.cos(omega), 1e-30)
        assert contains(proof.period, 2 * half(a), 1e-30)
    assert list(proof.twists) == ["y"]
    assert proof.momentum == "vy"
    assert proof.twists["y"].rad() < 1e-20
    assert proof.defect is not None
    assert proof.defect.contains(0)
    assert proof.level is not None
    assert proof.level.contains(arb(153) / 32)
    names = ["newton", "crossings", "level", "elliptic", "non-resonance", "twist"]
    assert [h.name for h in proof.hypotheses] == names


def test_its_certificate_agrees(certificate: dict[str, Any], proof: ProvedSymmetric) -> None:
    found = compare(certificate, proof)
    assert found.verdict == "agrees", found.reason
    said, unsaid = found.reason.split("Not confirmed: ")
    assert "rotation_number, twist" in said
    left = ", that the first integral is one, that the candidate's box holds no other orbits"
    assert re.fullmatch(
        r"point.x beyond \d+ digits, other_point.x beyond \d+ digits, other_point.y beyond .*e-\d+",
        unsaid.removesuffix(left),
    )


DIFFERENCES: dict[str, Callable[[dict[str, Any]], object]] = {
    "rotation_number:": lambda c: move(c["results"]["rotation_number"]),
    "normal_form.twist:": lambda c: move(c["results"]["twist"]),
    "defect:": lambda c: move(c["results"]["defect"]),
    "period:": lambda c: move(c["results"]["period"]),
    "half_period:": lambda c: move(c["results"]["half_period"]),
    "level: the enc": lambda c: move(c["results"]["level"]),
    "level: is here": lambda c: c["results"].pop("level"),
    "stability parameter 1, real": lambda c: move(c["results"]["stability_parameters"][0]["real"]),
    "stability parameter 1, imag": lambda c: move(c["results"]["stability_parameters"][0]["imaginary"]),
    "stability_parameters: another number": lambda c: c["results"].update(stability_parameters=[]),
    "multipliers: they": lambda c: move(c["results"]["multipliers"][0]["real"], F(1, 2)),
    "multipliers: another": lambda c: c["results"].update(multipliers=2 * c["results"]["multipliers"]),
    "stability: unst": lambda c: c["results"].update(stability="unstable"),
    "twist_momentum": lambda c: c["results"].update(twist_momentum="vx"),
    "point.x:": lambda c: move(c["results"]["point"]["x"]),
    "point.y:": lambda c: move(c["results"]["point"]["y"]),
    "other_point.x:": lambda c: move(c["results"]["other_point"]["x"]),
    "the point is not in the box": lambda c: c["statement"]["candidate"].update(centre=["3e0", "0x0"]),
}


@pytest.mark.parametrize("begin", DIFFERENCES)
def test_every_difference_is_told(certificate: dict[str, Any], proof: ProvedSymmetric, begin: str) -> None:
    found = compare(changed(certificate, DIFFERENCES[begin]), proof)
    assert (found.verdict, found.reason[: len(begin)]) == ("disagrees", begin)


def test_what_is_not_shown_here_is_not_confirmed(certificate: dict[str, Any], proof: ProvedSymmetric) -> None:
    other = changed(certificate, lambda c: c["results"].update(twist_coordinate="x"))
    assert compare(other, proof).verdict == "cannot follow"
    for name, ball in (("twists", {"y": arb(0, 1)}), ("coordinates", (arb(3, 2), arb(0)))):
        assert compare(certificate, replace(proof, **{name: ball})).verdict == "cannot follow"


def test_stability_that_is_not_shown_here_is_not_confirmed(certificate: dict[str, Any], proof: ProvedSymmetric) -> None:
    found = compare(certificate, replace(proof, stability=(acb(arb(0, 2)),)))
    assert (found.verdict, found.reason[:10]) == ("cannot follow", "stability:"), found.reason


def test_multipliers_are_confirmed_where_there_are_some(certificate: dict[str, Any], proof: ProvedSymmetric) -> None:
    around = {"real": {"mid": "0x0", "rad": "0x1p1"}, "imaginary": {"mid": "0x0", "rad": "0x1p1"}}
    wide = changed(certificate, lambda c: c["results"].update(multipliers=[around]))
    found = compare(wide, proof)
    assert (found.verdict, found.reason[:11]) == ("cannot follow", "multipliers"), found.reason
    none = compare(changed(certificate, lambda c: c["results"].update(multipliers=[])), proof)
    assert none.verdict == "agrees", none.reason
    assert "multiplier" not in none.reason
    assert "multiplier 1, real part, multiplier 1, imaginary part" in compare(certificate, proof).reason


def stored_multiplier(real: arb, imaginary: arb) -> dict[str, Any]:
    return {"real": ball_to_json(real), "imaginary": ball_to_json(imaginary)}


@pytest.mark.parametrize("angle", [0.3, 1.2, 2.5, 3.1])
def test_a_multiplier_is_confirmed_by_one_of_the_pair_that_is_told_from_the_other(
    certificate: dict[str, Any], proof: ProvedSymmetric, angle: float
) -> None:
    """lambda and 1/lambda have the sum 2 c: the ball that is stored has to contain one of them."""
    with ctx.workprec(200):
        exact, tiny = arb(angle), arb(0, 2.0**-100)
        found = replace(proof, stability=(acb(exact.cos() + tiny),))
        parameter = stored_multiplier(exact.cos() + 2 * tiny, arb(0))

        def told(real: arb, imaginary: arb) -> Comparison:
            values = {"stability_parameters": [parameter], "multipliers": [stored_multiplier(real, imaginary)]}
            return compare(changed(certificate, lambda c: c["results"].update(values)), found)

        wide, one, other = arb(0, 2.0**-80), exact.cos(), exact.sin()
        for sign in (1, -1):
            inside = told(one + wide, sign * other + wide).reason.split("Not confirmed: ")[0]
            assert "multiplier 1, real part, multiplier 1, imaginary part" in inside
        for move, verdict in (
            (arb(2.0**-70), "disagrees"),
            (wide.rad() * 1.5, "disagrees"),
            (wide.rad(), "cannot follow"),
        ):
            assert told(one + move + wide, other + wide).verdict == verdict
        # In a ball that holds both neither is told from the other.
        assert told(arb(0, 4) + 8, arb(0, 4)).verdict == "disagrees"
        assert told(one + wide, arb(0, 2)).verdict != "disagrees"


def claimed(certificate: dict[str, Any], **values: Any) -> dict[str, Any]:
    return changed(certificate, lambda c: c["statement"]["candidate"].update(values))


def test_the_sign_that_is_claimed_has_to_be_that_of_the_twist(certificate: dict[str, Any]) -> None:
    assert isinstance(second_proof(claimed(certificate, twist=-1)), ProvedSymmetric)
    found = second_proof(claimed(certificate, twist=1))
    assert isinstance(found, NotProved)
    assert "twist is not shown" in found.reason


def test_kinds_without_a_second_proof_are_not_followed(certificate: dict[str, Any]) -> None:
    for kind, reason in (
        ("krein_collision", "no theorem that is used here is about krein_collision with k = 1"),
        ("invariant_tori", "the theorem about tori that is used here is about n = 2"),
    ):
        found = second_proof(claimed(certificate, kind=kind))
        assert isinstance(found, NotProved)
        assert found.reason == reason


def test_statements_that_cannot_be_read_are_refused(certificate: dict[str, Any]) -> None:
    for values in (
        {"twist": 2},
        {"equation": {"quantity": "energy", "value": "1e0"}},
        {"equation": {"quantity": "coordinate", "coordinate": "vx", "value": "1e0"}},
        {"k": 3},
    ):
        with pytest.raises(BadCertificate):
            read_claim(claimed(certificate, **values))


BESIDE = ReversibleSystem(
    name="beside",
    title="a spring beside a linear one",
    state=("x", "y", "vx", "vy"),
    parameters={"w": ParameterRange(None, None)},
    vector_field=lambda s, p: (s[2], s[3], -p[0] * s[0] - s[0] ** 3, -s[1]),
    reversing_symmetry=(1, -1, -1, 1),
    section="y",
    first_integral=lambda s, p: (s[2] ** 2 + p[0] * s[0] ** 2 + s[0] ** 4 / 2 + s[1] ** 2 + s[3] ** 2,),
    first_integral_name="twice the energy",
)
"""x = 0, y = sin t has the rotation number w^(1/2), up to whole numbers and sign, and the period 2 pi."""


@cache
def beside() -> dict[str, Any]:
    """The claim for w = 2, certified."""
    candidate = Candidate(
        id="beside",
        system=BESIDE,
        parameters={"w": F(2)},
        kind=STABLE_ORBIT,
        k=1,
        centre=(F(1, 2**62), F(1)),
        frame=UNIT,
        kernel_frame=((F(1),),),
        radii=(F(1, 2**60),) * 2,
        equation=Equation(COORDINATE, F(1), "vy"),
    )
    return certify(candidate, Limits(digits=10)).to_json()


def test_an_orbit_of_a_linear_spring_is_proved_and_agrees() -> None:
    """An orbit of x'' = -w x - x^3 with the amplitude A has the frequency w^(1/2) + 3 A^2/(8 w^(1/2)) + .."""
    found = proved(beside())
    assert compare(beside(), found).verdict == "agrees", compare(beside(), found).reason
    root = float(arb(2).sqrt())
    assert found.rotation_number is not None
    assert float(found.rotation_number) == pytest.approx(root - 1, rel=1e-14)
    # |w|^2 = w^(1/2) A^2 turns by 2 pi 3 A^2/(8 w^(1/2)) more.
    assert float(found.twists["x"]) == pytest.approx(6 * float(arb.pi()) / (8 * 2), rel=1e-13)


@pytest.mark.parametrize(
    ("w", "reason"),
    [
        ("1/16", "non-resonance"),
        ("1/9", "non-resonance"),
        pytest.param("-1/4", "elliptic", marks=pytest.mark.slow),
        ("1/4", "elliptic"),
    ],
)
def test_orbits_that_are_resonant_or_unstable_are_not_proved(w: str, reason: str) -> None:
    found = second_proof(claimed(beside(), parameters={"w": w}))
    assert isinstance(found, NotProved)
    assert f"{reason} is not shown" in found.reason


def test_an_orbit_without_twist_is_not_proved() -> None:
    field = "v0 = x\nv1 = y\nv2 = vx\nv3 = vy\nv4 = w\nv5 = -1\nv6 = v5 * v0\nv7 = v6 * v4\nv8 = v5 * v1\n"
    level = "v0 = x\nv1 = y\nv2 = vx\nv3 = vy\nv4 = w\nv5 = v0 * v0\nv6 = v4 * v5\nv7 = v1 * v1\nv8 = v2 * v2\n"
    level += "v9 = v3 * v3\nv10 = v6 + v7\nv11 = v10 + v8\nv12 = v11 + v9\nreturn v12"
    plain = changed(
        beside(),
        lambda c: c["statement"].update(vector_field=field + "return v2, v3, v7, v8", first_integral=level),
    )
    found = second_proof(plain)
    assert isinstance(found, NotProved)
    assert "twist is not shown" in found.reason


@cache
def half_orbits() -> tuple[_Proof, tuple[arb, ...]]:
    """An attempt at the same orbit, and its point and half period."""
    claim = read_symmetric(beside())
    with precision(160):
        attempt = _Proof(claim, 160, guess(claim, 160))
        return attempt, tuple(attempt.enclosed()[1])


def whole(attempt: _Proof, zero: tuple[arb, ...], degree: int = 1) -> FullReturn:
    with precision(160):
        return FullReturn(attempt, list(zero), degree)


SHEARED = """v0 = x
v1 = y
v2 = vx
v3 = vy
v4 = w
v5 = -1
v6 = 1/2
v7 = 1/3
v8 = v2 * v7
v9 = v3 - v8
v10 = v9 * v6
v11 = v2 - v10
v12 = v0 * v0
v13 = v4 * v1
"""
FORCES = """v14 = v12 * v0
v15 = v0 + v14
v16 = v15 * v5
v17 = v13 * v5
v18 = v17 * v6
v19 = v16 + v18
v20 = v19 * v7
v21 = v17 + v20
return v11, v9, v19, v21"""
ENERGY = """v14 = v12 * v12
v15 = v14 * v6
v16 = v13 * v1
v17 = v11 * v11
v18 = v9 * v9
v19 = v12 + v15
v20 = v19 + v16
v21 = v20 + v17
v22 = v21 + v18
return v22"""


@pytest.mark.slow
def test_stability_is_that_of_the_return_to_another_section(
    certificate: dict[str, Any], proof: ProvedSymmetric
) -> None:
    """The springs with vx + vy/2 in the place of vx, and vy + (vx + vy/2)/3 in that of vy: all velocities matter."""

    def change(entry: dict[str, Any]) -> None:
        entry["statement"] |= {"vector_field": SHEARED + FORCES, "first_integral": SHEARED + ENERGY}
        entry["statement"]["candidate"]["kind"] = ORBIT

    found = proved(changed(certificate, change))
    assert agree(found.stability[0], proof.stability[0])
    assert found.stability[0].real.rad() < 1e-20


def test_an_orbit_is_back_after_its_period() -> None:
    attempt, zero = half_orbits()
    assert whole(attempt, zero).live
    with pytest.raises(CannotFollow, match="not back after its period"):
        whole(attempt, (*zero[:-1], zero[-1] + arb(2) ** -20))


def test_a_first_integral_is_kept_over_the_period() -> None:
    """x is back after the period, and is no first integral: x beside the orbit is not."""
    attempt, zero = half_orbits()
    other = copy.copy(attempt)
    system = replace(attempt.claim.system, integral=Program.from_text("v0 = x\nreturn v0"))
    other.claim = replace(attempt.claim, system=system)
    with pytest.raises(CannotFollow, match="the first integral is not kept"):
        whole(other, zero)


def test_a_level_on_which_the_first_integral_has_no_slope_is_refused() -> None:
    """(H - 1)^2 is kept, and its derivative is 0 on the orbit."""

    def change(entry: dict[str, Any]) -> None:
        *lines, last = entry["statement"]["first_integral"].split("\n")
        n, level = len(lines), last.removeprefix("return ")
        lines += [f"v{n} = -1", f"v{n + 1} = {level} + v{n}", f"v{n + 2} = v{n + 1} * v{n + 1}", f"return v{n + 2}"]
        entry["statement"]["first_integral"] = "\n".join(lines)
        entry["statement"]["candidate"]["kind"] = ORBIT

    found = second_proof(changed(beside(), change))
    assert isinstance(found, NotProved)
    assert "level is not shown" in found.reason


def test_what_reversibility_makes_zero_contains_zero() -> None:
    attempt, zero = half_orbits()
    full = whole(attempt, zero, 3)
    with precision(160):
        assert all(hypothesis.holds for hypothesis in full.twisted()[0])
        true = full.coefficient
        full.coefficient = lambda at: (true(at)[0] + at * arb(2) ** -60, true(at)[1])  # type: ignore[method-assign]
        assert [hypothesis.name for hypothesis in full.twisted()[0] if not hypothesis.holds] == ["twist"]


@pytest.mark.slow
def test_the_number_of_crossings_has_to_be_that_of_the_half_orbit(certificate: dict[str, Any]) -> None:
    found = second_proof(claimed(certificate, crossings=2))
    assert isinstance(found, NotProved)
    assert "may end before the crossing that is claimed" in found.reason


@pytest.mark.slow
def test_an_orbit_whose_halves_meet_the_section_twice_agrees() -> None:
    with mpmath.workprec(BITS):
        candidate = replace(CLAIMS["twice"](), system=replace(SPRINGS, squared_distance=None, distance_name=None))
    entry = certify(candidate, Limits(digits=8)).to_json()
    found = proved(entry)
    comparison = compare(entry, found)
    assert comparison.verdict == "agrees", comparison.reason
    assert found.rotation_number is None


@pytest.mark.slow
@pytest.mark.parametrize("quantity", [HALF_PERIOD, LEVEL])
def test_an_orbit_is_singled_out_by_its_period_or_level(certificate: dict[str, Any], quantity: str) -> None:
    entry = changed(certificate, lambda c: c["statement"]["candidate"].update(kind=ORBIT))
    with mpmath.workprec(BITS):
        exact = half(mpmath.mpf(3) / 2)
        value = F(int(mpmath.nint(mpmath.ldexp(exact, 140))), 2**140)
    value = {HALF_PERIOD: value, LEVEL: F(153, 32)}[quantity]
    # y has its equation by symmetry: x is the one that is found.
    entry["statement"]["candidate"]["equation"] = {"quantity": quantity, "value": format_exact(value)}
    found = proved(entry)
    assert abs(found.point["x"] - arb(3) / 2) < arb(2) ** -90
    entry["statement"]["candidate"]["equation"]["value"] = format_exact(value + F(1, 2**30))
    off = proved(entry)
    assert 2**-40 < abs(float(off.point["x"]) - 1.5) < 2**-28
    assert compare(entry, off).verdict == "disagrees"


@cache
def three() -> dict[str, Any]:
    """n = 2."""
    return certify(replace(tori_cases.claim(tori_cases.BENT), kind=ORBIT), Limits(digits=8)).to_json()


@pytest.mark.slow
def test_two_stability_parameters_agree() -> None:
    found = proved(three())
    assert len(found.stability) == 2
    comparison = compare(three(), found)
    assert comparison.verdict == "agrees", comparison.reason
    values = three()["results"]["stability_parameters"]
    other = changed(three(), lambda c: c["results"].update(stability_parameters=values[::-1]))
    assert compare(other, found).verdict == "disagrees", "multipliers stay in their order"


@pytest.mark.parametrize("angles", [(1, 2), (2, 1), (2, 2)])
def test_stability_parameters_of_two_rotations_are_told_apart(angles: tuple[int, int]) -> None:
    full = FullReturn.__new__(FullReturn)
    full.tangent, full.has_level = [0, 1, 2, 3], False
    (c, s), (d, t) = ((arb(angle).cos(), arb(angle).sin()) for angle in angles)
    full.monodromy = lambda: [[c, s, 0, 0], [-s, c, 0, 0], [0, 0, d, t], [0, 0, -t, d]]  # type: ignore[method-assign,list-item]
    if angles[0] == angles[1]:
        with pytest.raises(CannotFollow, match="two stability parameters are not told apart"):
            full.stability()
    else:
        first, second = full.stability()
        assert agree(first.real, arb(1).cos())
        assert agree(second.real, arb(2).cos())


def test_orbits_with_n_2_are_not_claimed_to_be_stable() -> None:
    found = second_proof(claimed(three(), kind=STABLE_ORBIT))
    assert isinstance(found, NotProved)
    assert "n > 1" in found.reason


def giving(answer: Any) -> Callable[..., Any]:
    return lambda *_: answer


@pytest.mark.parametrize("claimed", [-1, 0, 1])
def test_a_twist_has_one_certain_sign_for_some_coordinate_and_that_which_is_claimed(claimed: int) -> None:
    """c_1 = lambda (defect + i tau), and areas of the planes of (x, q) and (w, q), of which some may be 0."""
    full, cosine = FullReturn.__new__(FullReturn), arb(3) / 10
    full.claim = SimpleNamespace(  # type: ignore[assignment]
        system=SimpleNamespace(kernel=(1,), fixed=(0, 2), state=("x", "q", "w")), places=(0, 2), twist=claimed
    )
    full.stability = giving((acb(cosine),))  # type: ignore[method-assign]
    at, small, unknown = acb(cosine, (1 - cosine * cosine).sqrt()), arb(0, 2.0**-40), arb(0, 1)
    for tau, defect, areas, sign in (
        (arb(2), small, (arb(1), arb(3)), 1), (arb(-2), small, (arb(1), unknown), -1),
        (arb(2, 1), small, (unknown, arb(-3)), 1), (arb(-2, 1), small, (arb(-1), arb(1)), -1),
        (arb(2), small, (unknown, unknown), 0), (arb(1, 2), small, (arb(1), arb(3)), 0),
        (arb(2), small + arb(1) / 1024, (arb(1), arb(3)), 0),
    ):  # fmt: skip
        vector = [acb(areas[0]), acb(0, arb(1) / 2), acb(areas[1])]
        full.coefficient = giving((at * acb(defect, tau), vector))  # type: ignore[method-assign]
        hypotheses, _, twists, real = full.twisted()
        assert [h.holds for h in hypotheses[:2]] == [True, True]
        assert hypotheses[2].holds == (sign != 0 and claimed in (0, sign))
        assert agree(real, defect)
        known = {name: area for name, area in zip("xw", areas, strict=True) if not area.contains(0)}
        assert set(twists) == set(known)
        assert all(agree(twists[name], tau / (2 * abs(area))) for name, area in known.items())
