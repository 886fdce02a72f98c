"""Equilibria and Hopf points are proved once more, with other means; false claims are not, differences are reported."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction as Q
from functools import cache
from typing import Any

import pytest
from flint import acb, arb
from support import equilibrium_cases as cases
from support.balls import agree

from orbitproof.shared.formats import Equilibrium, HopfPoint, define_system
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.run.second_proofs import compare, prove_row
from orbitproof.verify.second_proof import BadCertificate, NotProved, ProvedEquilibrium, ProvedHopf, second_proof
from orbitproof.verify.second_proof.equilibria import OfEquilibrium, applied, read_equilibrium
from orbitproof.verify.second_proof.hopf_points import CUBES, MIXED, SQUARES, amplitude, derived, homological
from orbitproof.verify.second_proof.jets import Jet, precision
from orbitproof.verify.second_proof.statement import exact

CLAIMS: dict[str, Callable[[], Equilibrium | HopfPoint]] = {
    "ring": cases.equilibrium,
    "with sin": cases.equilibrium_with_functions,
    "hopf": cases.hopf,
    "hopf with exp": cases.hopf_with_functions,
}


@cache
def _certified(name: str) -> str:
    return json.dumps(certify(CLAIMS[name](), Limits(max_precision=256)).to_json())


def certificate(name: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(_certified(name))
    assert content["verdict"] == "proved"
    return content


def stated(claim: Equilibrium | HopfPoint) -> dict[str, Any]:
    """A certificate of which only the statement is meant: that the first proof takes no time."""
    return json.loads(json.dumps(certify(claim, Limits(max_precision=64)).to_json()))


@pytest.mark.quick
@pytest.mark.parametrize("name", CLAIMS)
def test_what_is_certified_is_proved_again_and_agrees(name: str) -> None:
    given = certificate(name)
    row = prove_row(given, lambda *_: None)
    assert row["verdict"] == "agrees", row["reason"]
    assert row["is_only"]
    assert ("functions keep" in row["reason"]) == (CLAIMS[name]().system.defined != ())
    json.dumps(row)


@pytest.mark.parametrize("seed", [1, *(pytest.param(n, marks=pytest.mark.slow) for n in range(2, 40))])
def test_numbers_are_those_of_closed_forms(seed: int) -> None:
    for known in (
        cases.at_random(seed, 2 + seed % 4, seed % 2 == 0),
        cases.of_any_field(seed, False),
        cases.of_any_field(seed, True),
    ):
        found = second_proof(stated(known.claim))
        assert isinstance(found, ProvedHopf), found
        with precision(400):
            for ball, value in ((found.frequency, known.omega), (found.speed, known.speed)):
                assert ball.contains(arb(value.numerator) / value.denominator)
            assert agree(found.lyapunov, arb(known.lyapunov.numerator) / known.lyapunov.denominator)
            assert found.lyapunov.rad() < 1e-60
            others = sorted(float(z.real.mid()) for z in found.multipliers)
        assert others == pytest.approx(sorted(map(float, known.others)))
        assert (found.left, found.right) == (sum(x < 0 for x in known.others), sum(x > 0 for x in known.others))
        assert found.side == ("above" if known.speed * known.lyapunov < 0 else "below")
        assert found.criticality == ("supercritical" if known.lyapunov < 0 else "subcritical")


BENT = {"w": Q(2), "d": Q(1, 2), "c": Q(-3, 4), "e": Q(1, 3)}


def _hopf(others: tuple[Q, ...] = (Q(-1, 3),), **numbers: Q) -> HopfPoint:
    matrix = ((1, 1, 0, 0), (0, 1, -1, 0), (1, 0, 2, 0), (0, 1, 0, 1))
    size = 2 + len(others)
    bends = [("squares", Q(1)), ("products", Q(1, 2)), ("squares", Q(-1))][: size - 1]
    return cases.in_other_coordinates(
        tuple(row[:size] for row in matrix[:size]), bends, {**BENT, **numbers}, others
    ).claim


def _two_pairs() -> HopfPoint:
    field = {"x": "a*x - y - x**3", "y": "x + a*y", "u": "-2*v", "v": "2*u"}
    system = define_system({"name": "pairs", "state": "x y u v", "parameters": "a", "field": field})
    kernel = ((Q(1), Q(0), Q(0), Q(0)), (Q(0), Q(-1), Q(0), Q(0)))
    small = cases.RADIUS
    return HopfPoint("pairs", system, {"a": Q(0)}, "a", small, (Q(0),) * 4, (small,) * 4, Q(1), small, kernel, small)


FALSE: dict[str, tuple[Callable[[], Equilibrium | HopfPoint], str]] = {
    "no zero near the centre": (lambda: cases.equilibrium(centre=(Q(3), Q(1), Q(1))), "does not converge"),
    "a double zero": (lambda: _plane("x**2", "-y"), "singular"),
    "a double eigenvalue": (lambda: _plane("-x + x*y", "-y"), "squareful"),
    "a field that is not defined": (lambda: _plane("log(x - 1) + x", "-y"), "singular"),
    "a pair that stays on the axis": (lambda: _hopf(d=Q(0)), "singular"),
    "no first Lyapunov coefficient": (lambda: _hopf(c=Q(0)), "lyapunov"),
    "an eigenvalue 0": (lambda: _hopf((Q(0),)), "singular"),
    "a further pair on the axis": (_two_pairs, "others"),
    "another frequency": (lambda: replace(_hopf(), frequency=Q(3)), "does not converge"),
    "a vector that is no eigenvector": (
        lambda: replace(_hopf(), kernel=((Q(1), Q(0), Q(0)), (Q(0), Q(1), Q(3)))),
        "does not converge",
    ),
    "a real vector": (lambda: replace(_hopf(), kernel=((Q(1), Q(0), Q(1)), (Q(0),) * 3)), "singular"),
}


def _plane(x: str, y: str) -> Equilibrium:
    system = define_system({"name": "plane", "state": "x y", "parameters": "b", "field": {"x": x, "y": y}})
    return Equilibrium("plane", system, {"b": Q(1)}, (Q(0), Q(0)), (cases.ROOT,) * 2)


@pytest.mark.quick
@pytest.mark.parametrize("name", FALSE)
def test_false_claims_are_not_proved(name: str) -> None:
    claim, reason = FALSE[name]
    found = second_proof(stated(claim()))
    assert isinstance(found, NotProved), name
    assert reason in found.reason


def _moved(entry: dict[str, str]) -> None:
    """Half again as large, or 1 for 0."""
    value = exact(entry["mid"])
    entry["mid"] = _dyadic(value * Q(3, 2) or Q(1))


def _dyadic(value: Q) -> str:
    return f"{'-' if value < 0 else ''}0x{abs(value.numerator):x}p-{value.denominator.bit_length() - 1}"


def _eigenvalues(c: dict[str, Any], **changes: int) -> None:
    for name, step in changes.items():
        c["results"]["eigenvalues"][name] += step


def _of_claim(c: dict[str, Any], name: str) -> None:
    claim = c["statement"]["candidate"]
    if name == "kernel":
        claim["kernel"][0][0] = _dyadic(exact(claim["kernel"][0][0]) + Q(1, 2**60))
    elif name == "centre":
        claim["centre"][0] = _dyadic(exact(claim["centre"][0]) + Q(1, 2**30))
    else:
        claim["parameters"]["a"] = _dyadic(exact(claim["parameters"]["a"]) + Q(1, 2**60))


DIFFERENCES: dict[str, tuple[str, Callable[[dict[str, Any]], Any]]] = {
    "point.y": ("ring", lambda c: _moved(c["results"]["point"]["y"])),
    "point:": ("ring", lambda c: c["results"]["point"].pop("y")),
    "eigenvalues: 1 right": ("ring", lambda c: _eigenvalues(c, left=-1, right=1)),
    "eigenvalues: another number of them": ("ring", lambda c: _eigenvalues(c, left=-1)),
    "no stored ball": ("ring", lambda c: _moved(c["results"]["eigenvalues"]["values"][2]["real"])),
    "not in the box": ("ring", lambda c: _of_claim(c, "centre")),
    "side": ("hopf", lambda c: c["results"].update(side="below")),
    "criticality": ("hopf", lambda c: c["results"].update(criticality="subcritical")),
    "parameter_name": ("hopf", lambda c: c["results"].update(parameter_name="b")),
    "normal_form.lyapunov": ("hopf", lambda c: _moved(c["results"]["lyapunov"])),
    "normal_form.speed": ("hopf", lambda c: _moved(c["results"]["speed"])),
    "parameter:": ("hopf", lambda c: _moved(c["results"]["parameter"])),
    "frequency": ("hopf", lambda c: _moved(c["results"]["frequency"])),
    "period": ("hopf", lambda c: _moved(c["results"]["period"])),
    "eigenvalues: 1 right of": ("hopf", lambda c: _eigenvalues(c, left=-1, right=1)),
    "is not in the box of": ("hopf", lambda c: _of_claim(c, "kernel")),
    "is not in the box": ("hopf", lambda c: _of_claim(c, "parameter")),
}


@cache
def _proved(name: str) -> Any:
    return second_proof(certificate(name))


@pytest.mark.parametrize("what", DIFFERENCES)
def test_differences_are_reported(what: str) -> None:
    name, change = DIFFERENCES[what]
    other = certificate(name)
    change(other)
    found = compare(other, _proved(name))
    assert found.verdict == "disagrees", found.reason
    assert what in found.reason


def test_what_is_not_shown_is_not_said() -> None:
    """In a box in which the derivative is singular somewhere a second zero is not excluded."""
    given = certificate("ring")
    given["statement"]["candidate"]["radii"] = ["0x1p+2"] * 3
    found = second_proof(given)
    assert isinstance(found, ProvedEquilibrium)
    assert not found.is_only
    assert "Not confirmed: that the candidate's box holds no other" in compare(given, found).reason
    wide = certificate("hopf")
    wide["statement"]["candidate"].update(kernel_radius="0x1p+2")
    again = second_proof(wide)
    assert isinstance(again, ProvedHopf)
    assert not again.is_only
    undecided = certificate("ring")
    result = _proved("ring")
    vague = replace(result, multipliers=(acb(arb(0, 3)), *result.multipliers[1:]), left=2)
    assert compare(undecided, vague).verdict == "cannot follow"
    unsigned = replace(_proved("hopf"), lyapunov=arb(0, 10**6))
    assert compare(certificate("hopf"), unsigned).verdict == "cannot follow"


BAD: dict[str, tuple[str, Callable[[dict[str, Any]], Any]]] = {
    "statement.vector_field": ("ring", lambda s: s.update(vector_field="v0 = x\nv1 = y +\nreturn v1")),
    "statement.functions": ("with sin", lambda s: s["functions"].pop()),
    "statement:": ("with sin", lambda s: s["functions"][0].update(function="tan")),
    "parameters: state and": ("ring", lambda s: s["candidate"]["parameters"].pop("a")),
    "statement.candidate: centre and radii": ("ring", lambda s: s["candidate"]["radii"].pop()),
    "statement.candidate.centre": ("ring", lambda s: s["candidate"].update(centre=[1.0, 2.0, 3.0])),
    "statement.candidate: parameter, kernel": ("hopf", lambda s: s["candidate"]["kernel"][0].pop()),
    "statement.candidate: parameter": ("hopf", lambda s: s["candidate"].update(parameter="z")),
    "half-widths": ("hopf", lambda s: s["candidate"].update(kernel_radius="0x0")),
}


@pytest.mark.parametrize("field", BAD)
def test_bad_input_names_the_field(field: str) -> None:
    name, change = BAD[field]
    given = certificate(name)
    change(given["statement"])
    with pytest.raises(BadCertificate, match=field):
        second_proof(given)


def test_a_function_is_one_of_what_comes_before_it() -> None:
    given = certificate("with sin")
    given["statement"]["functions"][0]["argument"] = "v0 = x\nv1 = cos_x\nreturn v1"
    assert isinstance(second_proof(given), NotProved)


def test_functions_of_jets_have_their_derivatives() -> None:
    """sin^2 + cos^2 = 1 and exp(log) = 1, of jets in two variables over a ball."""
    with precision(128):
        jet = Jet({(): arb(2, 1e-9), (0,): arb(3), (1,): arb(-1), (0, 1): arb(5), (0, 0, 0): arb(1)}, 3)
        sine, cosine = applied("sin", jet), applied("cos", jet)
        one = sine * sine + cosine * cosine
        same = applied("exp", applied("log", jet))
        for a in {*one, *same}:
            assert one[a].contains(int(a == ()))
            assert agree(same[a], jet[a])
        assert sine[0,].contains((3 * arb(2).cos()).mid())
        assert sine[0,].rad() > 1e-9


def test_graphs_are_those_of_the_equation() -> None:
    """H' J p - D H is what was asked for, of every kind of monomials."""
    with precision(128):
        block, omega = [[arb(-1), arb(2)], [arb(1) / 3, arb(5)]], arb(7) / 3
        for monomials in (SQUARES, MIXED, CUBES):
            wanted = [Jet({a: arb(1 + 2 * n + k) for n, a in enumerate(monomials)}, 3) for k in range(2)]
            found = homological(wanted, monomials, block, omega)
            turned = [Jet({(1,): omega}, 3), Jet({(0,): -omega}, 3)]
            for k, jet in enumerate(found):
                left = derived(jet, 0) * turned[0] + derived(jet, 1) * turned[1]
                left = left - (found[0] * block[k][0] + found[1] * block[k][1])
                assert all(left[a].contains(wanted[k][a].mid()) for a in monomials)


def test_the_amplitude_is_that_of_polar_coordinates() -> None:
    """x' = -w y + (c x - e y) r^2, y' = w x + (e x + c y) r^2 has r' = c r^3, in any coordinates near 0."""
    with precision(128):
        c, e, omega = arb(3), arb(5), arb(2)
        x = Jet({(0,): -omega, (1, 1, 1): c, (0, 0, 1): c, (0, 1, 1): -e, (0, 0, 0): -e}, 3)
        y = Jet({(1,): omega, (1, 1, 1): e, (0, 0, 1): e, (0, 1, 1): c, (0, 0, 0): c}, 3)
        assert amplitude(y, x, omega).contains(3)


def test_no_other_zero_is_shown_over_the_whole_box_alone() -> None:
    """x (x - 1) (y + 2) has one zero with y = 0 in [-1/4, 1/4] and two in [-1/4, 5/4]."""
    statement = read_equilibrium(stated(_plane("x*(x - 1)*(y + 2)", "y - x*(x - 1)")))
    with precision(128):

        def is_only(*centre: Q, radius: Q = Q(1, 4)) -> bool:
            return OfEquilibrium(replace(statement, centre=centre, radii=(radius,) * 2), 128).is_only()

        assert is_only(Q(0), Q(0))
        assert not is_only(Q(0), Q(0), radius=Q(1, 2))
        assert not is_only(Q(1, 2), Q(0), radius=Q(3, 4))
        undefined = read_equilibrium(stated(_plane("log(x + 1/8) + x", "y")))
        assert not OfEquilibrium(replace(undefined, radii=(Q(1, 4),) * 2), 128).is_only()
