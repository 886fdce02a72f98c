"""Bifurcations on a fixed level of a first integral, proved once more; false claims about the level are not."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb
from support.balls import agree

from orbitproof.explore.refinement.newton import refine
from orbitproof.shared.formats import load_system, read_atlas
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import BadCertificate, NotProved, Proved, proof, second_proof
from orbitproof.verify.second_proof.fixed_level import LevelSet
from orbitproof.verify.second_proof.halves import HalfOrbits
from orbitproof.verify.second_proof.jets import CannotFollow, Jet
from orbitproof.verify.second_proof.statement import Program

FILE = Path(__file__).parents[1] / "data" / "atlas-fixed-level.json"


@cache
def certificate() -> dict[str, Any]:
    system = read_atlas(FILE).system
    claim = refine(system, {}, "period_tupling", 4, [1.909118763, -0.2369648123], digits=40)
    return certify(claim.to_candidate("quadrupling", {}), Limits(max_precision=512)).to_json()


def changed(change: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    result = copy.deepcopy(certificate())
    change(result["statement"])
    return result


def level(statement: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = statement["candidate"]["system"]["fixed_level"]
    return found


@pytest.mark.slow
def test_a_tupling_on_a_level_is_proved_again() -> None:
    found = second_proof(certificate())
    assert isinstance(found, Proved), str(found)
    assert found.side == "below"
    assert compare(certificate(), found).verdict == "agrees"


@pytest.mark.slow
def test_on_another_level_it_is_another_one() -> None:
    other = second_proof(changed(lambda statement: level(statement).update(value="1e-25")))
    assert isinstance(other, Proved), str(other)
    assert compare(certificate(), other).verdict == "disagrees"


def not_kept(statement: dict[str, Any]) -> None:
    """H + u3^2, which is H on Fix(R): all points that are claimed are on its level."""
    *lines, last = statement["first_integral"].split("\n")
    number = len(lines)
    more = [f"v{number} = v3 ** (2)", f"v{number + 1} = {last.removeprefix('return ')} + v{number}"]
    statement["first_integral"] = "\n".join([*lines, *more, f"return v{number + 1}"])


FALSE: dict[str, Callable[[dict[str, Any]], None]] = {
    "no points": lambda statement: level(statement).update(value="5e-1"),
    "an integral that is not kept": not_kept,
    "a coordinate that R negates": lambda s: s["candidate"]["system"].update(level_coordinate="u3"),
}


@pytest.mark.parametrize("case", FALSE)
def test_a_false_claim_is_not_proved(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proof, "PRECISIONS", (96,))
    try:
        found = second_proof(changed(FALSE[case]))
    except BadCertificate:
        return
    assert isinstance(found, NotProved)


@pytest.mark.slow
def test_on_the_other_sheet_there_is_none() -> None:
    assert isinstance(second_proof(changed(lambda statement: level(statement).update(sign=-1))), NotProved)


@pytest.mark.parametrize(("name", "value"), [("sign", 2), ("value", "h"), ("value", None)])
def test_a_level_that_cannot_be_read_is_named(name: str, value: Any) -> None:
    with pytest.raises(BadCertificate, match=f"fixed_level.{name}"):
        second_proof(changed(lambda statement: level(statement).update({name: value})))


@pytest.mark.parametrize("ends", [None, ["1"], ["1", "h"], [1, 2], {"low": "1"}])
def test_an_interval_that_cannot_be_read_is_named(ends: Any) -> None:
    with pytest.raises(BadCertificate, match=r"fixed_level.between"):
        second_proof(changed(lambda statement: level(statement).update(between=ends)))


Interval = tuple[Fraction, Fraction]


def circle(x: arb, sign: int, level: int = 1, between: Interval | None = None) -> Jet:
    """w on x^2 + w^2 = level, over all points of a ball."""
    program = Program.from_text("v0 = x\nv1 = w\nv2 = v0 * v0\nv3 = v1 * v1\nv4 = v2 + v3\nreturn v4")
    level_set = LevelSet(program, Fraction(level), 1, sign, between)

    def conserved(state: Sequence[Jet]) -> Jet:
        return program.run(dict(zip("xw", state, strict=True)), lambda value: Jet({(): arb(1) * int(value)}, 2))[0]

    return level_set.lifted(conserved, [Jet({(): x, (0,): arb(1)}, 2), Jet({}, 2)], 90)[1]


@pytest.mark.parametrize("sign", [1, -1])
def test_the_coordinate_that_follows_is_enclosed_with_its_derivatives(sign: int) -> None:
    w = circle(arb("0.6"), sign)
    for key, value in ((), "0.8"), ((0,), "-0.75"), ((0, 0), "-0.9765625"):
        assert (w[key] - sign * arb(value)).contains(0)
        assert w[key].rad() < 1e-14
    over = circle(arb("0.6", "0.1"), sign)
    for x in ("0.5", "0.55", "0.7"):
        assert over[()].contains(sign * (1 - arb(x) ** 2).sqrt().mid())


@pytest.mark.parametrize(("x", "level"), [(arb("0.6", "0.18"), 1), (arb("0.6", "0.3"), 1), (arb(2), 1), (arb(0), 0)])
def test_where_it_is_not_shown_to_follow_nothing_is_said(x: arb, level: int) -> None:
    with pytest.raises((CannotFollow, ZeroDivisionError)):
        circle(x, 1, level)


@pytest.mark.parametrize("sign", [1, -1])
def test_in_an_interval_it_is_the_same_coordinate(sign: int) -> None:
    low, high = sorted((sign * Fraction(1, 10), sign * Fraction(3)))
    for x in (arb("0.6"), arb("0.6", "0.1")):
        one, other = circle(x, sign), circle(x, 0, 1, (low, high))
        for key in ((), (0,), (0, 0)):
            assert agree(one[key], other[key])
        assert other[()].rad() < 0.3


@pytest.mark.parametrize(
    ("low", "high"), [("-3", "3"), ("-1/10", "3"), ("9/10", "3"), ("1/10", "7/10"), ("1/10", "4/5"), ("4/5", "3")]
)
def test_an_interval_with_another_point_or_none_is_refused(low: str, high: str) -> None:
    with pytest.raises((CannotFollow, ZeroDivisionError)):
        circle(arb("0.6"), 0, 1, (Fraction(low), Fraction(high)))


@pytest.mark.slow
def test_a_tupling_on_a_level_in_an_interval_is_proved_again() -> None:
    system = load_system(Path(__file__).resolve().parents[2] / "docs" / "examples" / "relativistic.py")
    claim = refine(system, {}, "period_tupling", 2, [0.6414622, 0.6756299], digits=40).to_candidate("two", {})
    entry = certify(claim, Limits(max_precision=512)).to_json()
    found = second_proof(entry)
    assert isinstance(found, Proved), str(found)
    assert compare(entry, found).verdict == "agrees"
    entry["statement"]["candidate"]["system"]["fixed_level"]["between"] = ["-2", "2"]
    assert isinstance(second_proof(entry), NotProved)


@pytest.mark.parametrize("sign", [1, -1])
def test_points_are_on_the_sheet_that_is_claimed_and_at_no_other_time(sign: int) -> None:
    orbits = object.__new__(HalfOrbits)
    claim: Any = SimpleNamespace(sheet=(2, sign), system=SimpleNamespace(state=("a", "b", "w")))
    orbits.claim, orbits.places, orbits.time = claim, [1, 2], 2
    for w, time in product((arb(3), arb(-3), arb(0, 1)), (arb(1), arb(-1), arb(0, 1))):
        holds = {check.name: check.holds for check in orbits.check_point([arb(5), w, time])}
        assert holds == {"crossings": time > 0, "sheet": sign * w > 0}
