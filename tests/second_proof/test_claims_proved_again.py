"""Claims about the Falkner-Skan equation: true ones are proved, false ones are not, differences are reported."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx

from orbitproof.shared.numbers import format_dyadic
from orbitproof.verify.__main__ import main
from orbitproof.verify.evidence import exact_value
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import BadCertificate, NotProved, Proved, second_proof
from orbitproof.verify.second_proof.statement import exact

FILE = Path(__file__).parents[1] / "data" / "figures-certificates.json"
CERTIFICATES = {c["id"]: c for c in json.loads(FILE.read_text(encoding="utf-8"))["certificates"]}
DOUBLING, TOUCHING = "falkner-skan-odd-k2-1", "falkner-skan-odd-k3-1"


@pytest.fixture(scope="module")
def proved() -> Proved:
    before = ctx.prec, ctx.cap
    result = second_proof(CERTIFICATES[DOUBLING])
    assert (ctx.prec, ctx.cap) == before, "the precision leaks"
    assert isinstance(result, Proved), str(result)
    return result


def changed(name: str, change: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    certificate = copy.deepcopy(CERTIFICATES[name])
    change(certificate)
    return certificate


def test_period_doubling_is_proved_and_agrees(proved: Proved) -> None:
    assert (proved.kind, proved.k, proved.side) == ("period_tupling", 2, "below")
    assert proved.parameter.rad() < 1e-30
    assert {"family", "regular-1", "HC3", "HC4", "h_b''"} <= {h.name for h in proved.hypotheses}
    found = compare(CERTIFICATES[DOUBLING], proved)
    assert found.verdict == "agrees"
    said, unsaid = found.reason.split("Not confirmed: ")
    assert "inside the stored balls: parameter, point.beta, point.y" in said
    assert re.fullmatch(
        r"alpha beyond \d+ digits, beta beyond \d+ digits, that the candidate's box holds no other orbits", unsaid
    )


def test_coordinates_that_are_functions_of_others_are_not_followed() -> None:
    functions = [{"coordinate": "z", "function": "sin", "argument": "v0 = x\nreturn v0"}]
    certificate = changed(DOUBLING, lambda c: c["statement"].update(functions=functions))
    result = second_proof(certificate)
    assert isinstance(result, NotProved)
    assert "functions of others are not followed" in result.reason
    assert compare(certificate, result).verdict == "cannot follow"


def shift(number: str, by: Fraction) -> str:
    value = exact(number) + by
    bits = value.denominator.bit_length() - 1
    return f"{'-' if value < 0 else ''}0x{abs(value.numerator):x}p-{bits}"


def move_point(c: dict[str, Any]) -> None:
    c["results"]["point"]["y"]["mid"] = shift(c["results"]["point"]["y"]["mid"], Fraction(1, 2**120))


def move_parameter(c: dict[str, Any]) -> None:
    c["results"]["parameter"]["mid"] = shift(c["results"]["parameter"]["mid"], Fraction(-1, 2**110))


def move_box(c: dict[str, Any]) -> None:
    c["statement"]["candidate"]["centre"][1] = shift(c["statement"]["candidate"]["centre"][1], Fraction(1, 2**60))


DIFFERENCES = {
    "side": lambda c: c["results"].update(side="above"),
    "y": move_point,
    "parameter": move_parameter,
    "box": move_box,
    "kind": lambda c: c["statement"]["candidate"].update(k=4),
    "point.y": lambda c: move_by_radii(c["results"]["point"]["y"], 3),
    "parameter:": lambda c: move_by_radii(c["results"]["parameter"], -3),
    "alpha": lambda c: turn(c["results"]["normal_form"]["alpha"]),
    "beta": lambda c: double(c["results"]["normal_form"]["beta"]),
    "normal_form.beta": lambda c: stretch(c["results"]["normal_form"]["beta"], Fraction(1, 10**10)),
    "point.x": lambda c: c["results"]["point"].update(x=c["results"]["point"]["y"]),
    "point.beta": lambda c: c["results"]["point"].pop("beta"),
}


def move_by_radii(entry: dict[str, str], number: int) -> None:
    entry["mid"] = shift(entry["mid"], number * exact(entry["rad"]))


def turn(entry: dict[str, str]) -> None:
    entry["mid"] = shift(entry["mid"], -2 * exact(entry["mid"]))


def double(entry: dict[str, str]) -> None:
    entry["mid"] = shift(entry["mid"], exact(entry["mid"]))


def stretch(entry: dict[str, str], by: Fraction) -> None:
    """As a rounded factor of the derivatives would."""
    bits = round(exact(entry["mid"]) * by * 2**200)
    entry["mid"] = shift(entry["mid"], Fraction(bits, 2**200))


def narrow(c: dict[str, Any], part: str, name: str) -> None:
    """A ball that is too narrow by far: a thousandth of the radius, about another of its points."""
    entry = c["results"][part][name]
    move_by_radii(entry, 1)
    entry["rad"] = f"0x1p-{(1000 / exact(entry['rad'])).__ceil__().bit_length()}"


@pytest.mark.parametrize("name", ["beta", "y"])
def test_a_ball_that_is_too_narrow_disagrees(name: str, proved: Proved) -> None:
    found = compare(changed(DOUBLING, lambda c: narrow(c, "point", name)), proved)
    assert found.verdict == "disagrees"
    assert f"point.{name}" in found.reason


def test_a_ball_that_is_not_confirmed_is_no_agreement(proved: Proved) -> None:
    """Its edge lies in the enclosure of the second proof, which is far narrower: nothing contradicts it."""

    def edge(c: dict[str, Any]) -> None:
        entry = c["results"]["point"]["y"]
        with ctx.workprec(1000):
            entry["mid"] = format_dyadic(exact_value(proved.point["y"].mid()) + exact(entry["rad"]))

    found = compare(changed(DOUBLING, edge), proved)
    assert found.verdict == "cannot follow"
    assert "not inside" in found.reason


def test_what_is_not_compared_is_named(proved: Proved) -> None:
    def more(c: dict[str, Any]) -> None:
        c["results"]["normal_form"]["gamma"] = c["results"]["normal_form"]["beta"]

    found = compare(changed(DOUBLING, more), proved)
    assert found.verdict == "agrees"
    assert re.search("Not confirmed: .*, normal_form.gamma, that", found.reason)
    slope = {"h_fp'": {"mid": "0x2p+0", "rad": "0x0p+0"}}
    certificate = changed(DOUBLING, lambda c: c["results"]["normal_form"].update(slope))
    assert compare(certificate, proved).verdict == "disagrees"
    # p_0 of a level form is another coordinate.
    certificate["statement"]["level_form"] = {}
    assert re.search("Not confirmed: .*, normal_form.h_fp', that", compare(certificate, proved).reason)


def test_signs_have_to_be_shown(proved: Proved) -> None:
    wide = replace(proved, normal_form=proved.normal_form | {"beta": arb(0, 10**6)})
    found = compare(CERTIFICATES[DOUBLING], wide)
    assert found.verdict == "cannot follow"
    assert "sign" in found.reason
    nothing = replace(proved, normal_form=proved.normal_form | {"beta": arb("nan")})
    assert "not finite" in compare(CERTIFICATES[DOUBLING], nothing).reason


@pytest.fixture(scope="module")
def fold(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Proved]:
    """The fold of Michelson's equation, proved by both."""
    path = tmp_path_factory.mktemp("fold") / "certificates.json"
    words = [str(FILE.with_name("known-folds.json")), "--only", "michelson-family-fold-1", "-o", str(path), "--quiet"]
    assert main(words) == 0
    certificate = json.loads(path.read_text(encoding="utf-8"))["certificates"][0]
    result = second_proof(certificate)
    assert isinstance(result, Proved), str(result)
    return certificate, result


def test_a_fold_is_proved_and_agrees(fold: tuple[dict[str, Any], Proved]) -> None:
    certificate, result = fold
    assert (result.kind, result.k, result.side) == ("fold", 1, "below")
    assert {h.name for h in result.hypotheses} == {"frames", "curve", "extremum", "dH/dp_0"}
    assert compare(certificate, result).verdict == "agrees"
    for change in (
        lambda c: c["results"].update(side="above"),
        lambda c: turn(c["results"]["normal_form"]["beta"]),
        lambda c: move_by_radii(c["results"]["parameter"], 3),
        lambda c: narrow(c, "point", "y"),
    ):
        other = copy.deepcopy(certificate)
        change(other)
        assert compare(other, result).verdict == "disagrees"


@pytest.mark.parametrize("what", DIFFERENCES)
def test_difference_is_reported(what: str, proved: Proved) -> None:
    found = compare(changed(DOUBLING, DIFFERENCES[what]), proved)
    assert found.verdict == "disagrees"
    assert what.rstrip(":") in found.reason


def test_enclosure_wider_than_the_box_is_no_difference(proved: Proved) -> None:
    narrow = changed(DOUBLING, claim(radii=["0x1p-400", "0x1p-400"]))
    found = compare(narrow, proved)
    assert found.verdict == "cannot follow"
    assert "too wide" in found.reason


def test_nothing_to_compare_with_is_no_agreement(proved: Proved) -> None:
    assert (
        compare(changed(DOUBLING, lambda c: c.update(verdict="not proved", results=None)), proved).verdict
        == "cannot follow"
    )
    assert compare(CERTIFICATES[DOUBLING], NotProved("time is up")).reason == "time is up"


def refuse(certificate: dict[str, Any]) -> str:
    result = second_proof(certificate)
    assert isinstance(result, NotProved)
    assert result.reason
    return result.reason


def claim(**values: Any) -> Callable[[dict[str, Any]], None]:
    return lambda c: c["statement"]["candidate"].update(values)


def test_kinds_without_a_theorem_are_refused() -> None:
    for values in (
        {"k": 3},
        {"kind": "touch_and_go"},
        {"kind": "symmetry_breaking"},
        {"kind": "fold"},
        {"kind": "fold", "k": 3},
    ):
        assert "theorem" in refuse(changed(DOUBLING, claim(**values)))


def test_wrong_symmetry_is_refused() -> None:
    assert "symmetry" in refuse(changed(DOUBLING, wrong_field))


def wrong_field(c: dict[str, Any]) -> None:
    """z' = beta (y^2 - 1) - x, which R does not reverse."""
    c["statement"]["vector_field"] = c["statement"]["vector_field"].replace("v8 = v0 * v2", "v8 = v0 + v0")


BAD = {
    "statement.vector_field": lambda c: c["statement"].update(vector_field="v0 = x\nv1 = __import__('os')\nreturn v1"),
    "statement.candidate.centre": lambda c: c["statement"]["candidate"].update(centre=[0.5, 1.0]),
    "statement.section": lambda c: c["statement"].update(section="y"),
    "statement.reversing_symmetry": lambda c: c["statement"].update(reversing_symmetry=[1, 2, 3]),
    "statement": lambda c: c.pop("statement"),
}


@pytest.mark.parametrize("field", BAD)
def test_bad_input_names_the_field(field: str) -> None:
    with pytest.raises(BadCertificate, match=field):
        second_proof(changed(DOUBLING, BAD[field]))


def reverse_field(c: dict[str, Any]) -> None:
    c["statement"]["vector_field"] = c["statement"]["vector_field"].replace("v9 = v7 - v8", "v9 = v8 - v7")


def shift_centre(by: Fraction) -> Callable[[dict[str, Any]], None]:
    def change(c: dict[str, Any]) -> None:
        centre = c["statement"]["candidate"]["centre"]
        centre[0] = shift(centre[0], by)

    return change


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [claim(k=4), claim(k=3, kind="touch_and_go"), reverse_field, shift_centre(Fraction(5))],
    ids=["k = 4 in place of 2", "touch-and-go in place of doubling", "field with the wrong sign", "centre far away"],
)
def test_false_claim_is_not_proved(change: Callable[[dict[str, Any]], None]) -> None:
    refuse(changed(DOUBLING, change))


@pytest.mark.slow
def test_touch_and_go_is_proved_and_agrees() -> None:
    result = second_proof(CERTIFICATES[TOUCHING])
    assert isinstance(result, Proved)
    assert result.side == "both"
    assert compare(CERTIFICATES[TOUCHING], result).verdict == "agrees"


@pytest.mark.slow
def test_a_centre_that_is_not_exact_is_refined() -> None:
    """Its certificate proves nothing, from the same centre."""
    certificate = CERTIFICATES["falkner-skan-odd-k4-1"]
    result = second_proof(certificate)
    assert isinstance(result, Proved), str(result)
    assert (result.k, result.side) == (4, "above")
    assert compare(certificate, result).verdict == "cannot follow"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["earth-moon-L1-halo-k1-1", "earth-moon-L1-halo-k2-1", "earth-moon-L1-halo-k3-2"])
def test_halo_bifurcation_is_proved_and_agrees(name: str) -> None:
    certificate = CERTIFICATES[name]
    result = second_proof(certificate)
    assert isinstance(result, Proved)
    assert compare(certificate, result).verdict == "agrees"


@pytest.mark.slow
def test_half_orbit_agrees_with_mpmath() -> None:
    """The first crossing of a Falkner-Skan orbit and its derivative in y, against mpmath's Taylor integration."""
    from mpmath import mp, mpf, odefun

    from orbitproof.verify.second_proof import read_statement
    from orbitproof.verify.second_proof.crossing import follow
    from orbitproof.verify.second_proof.jets import Jet, ball, precision

    statement = read_statement(CERTIFICATES[DOUBLING])
    with precision(192):
        from flint import arb

        start = [Jet({}, 2) for _ in range(4)]
        for j, (i, centre) in enumerate(zip(statement.fixed, statement.centre, strict=True)):
            start[i] = Jet({(): ball(centre), (j,): arb(1)}, 2)
        found, moment, _ = follow(statement, start, 160)
        time, value, slope = (x.mid().str(30, radius=False) for x in (moment, found[0][()], found[0][1,]))
    with mp.workdps(30):
        beta, y = (mpf(c.numerator) / c.denominator for c in statement.centre)

        def end(height: Any) -> Any:
            solution = odefun(
                lambda _, v: [v[1], v[2], beta * (v[1] ** 2 - 1) - v[0] * v[2]], 0, [mpf(0), height, mpf(0)]
            )
            moment = mpf(time)
            for _ in range(4):
                x, y, z = solution(moment)
                moment -= z / (beta * (y**2 - 1) - x * z)
            return solution(moment)[0]

        step = mpf(10) ** -8
        assert abs(end(y) - mpf(value)) < mpf(10) ** -15
        assert abs((end(y + step) - end(y - step)) / (2 * step) - mpf(slope)) < mpf(10) ** -9
