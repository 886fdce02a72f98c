"""Curves of equilibria are followed once more in boxes along tangents; false claims are not proved."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction as Q
from functools import cache
from itertools import combinations
from pathlib import Path
from random import Random
from typing import Any

import pytest
from flint import arb, arb_mat
from support import equilibrium_cases as cases
from support.balls import agree

from orbitproof.shared.claims import EquilibriumAtlas
from orbitproof.verify.__main__ import main
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.equilibrium_curve import EquilibriumLimits, prove_equilibrium_piece
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import BadCertificate, CannotFollow, NotProved, ProvedCurve, second_proof
from orbitproof.verify.second_proof.equilibrium_curve_statement import read_curve
from orbitproof.verify.second_proof.equilibrium_curves import sums_of_pairs
from orbitproof.verify.second_proof.jets import precision

CURVES: dict[str, Callable[[], EquilibriumAtlas]] = {
    "bend": cases.curve_of_equilibria,
    "circle": cases.circle_of_equilibria,
    "twice": lambda: cases.circle_of_equilibria(2),
}


@cache
def _certified(name: str) -> str:
    atlas, limits = CURVES[name](), EquilibriumLimits(precision=80, order=24, width=24)
    results = [prove_equilibrium_piece(atlas, piece, (Q(-1), Q(1)), limits).stored for piece in atlas.curve_pieces()]
    return json.dumps(make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda _: [], None)))


def certificate(name: str, change: Callable[[dict[str, Any]], Any] = lambda _: None) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(_certified(name))
    assert found["verdict"] == "proved"
    change(found)
    return found


@cache
def proved(name: str) -> ProvedCurve:
    found = second_proof(certificate(name))
    assert isinstance(found, ProvedCurve), found
    return found


def refused(change: Callable[[dict[str, Any]], Any], name: str = "bend") -> str:
    found = second_proof(certificate(name, lambda c: change(c["statement"]["atlas"])))
    assert isinstance(found, NotProved), found
    return found.reason


def test_a_bend_is_followed_through_its_fold() -> None:
    found = proved("bend")
    assert found.start["a"].contains(arb(1) / 4)
    assert agree(found.start["x"], arb(-1) / 2)
    assert agree(found.end["x"], arb(1) / 2)
    (fold,) = found.extrema
    assert not fold.is_maximum
    assert fold.value.contains(0)
    assert fold.value.rad() < 1e-10
    assert [part.sides for part in found.parts] == [(1, 1), None, (2, 0)]
    assert found.parts[1].values.contains(0)
    assert {h.name for h in found.hypotheses} == {"boxes", "increasing-x", "covers"}
    told = compare(certificate("bend"), found)
    assert told.verdict == "agrees"
    assert "the curve from end to end; the folds; the order of the counts; inside" in told.reason


@pytest.mark.parametrize("name", ["circle", "twice"])
def test_a_loop_is_followed_once(name: str) -> None:
    found = proved(name)
    assert [extremum.is_maximum for extremum in found.extrema] == [False, True]
    for extremum in found.extrema:
        assert extremum.value.contains(1 if extremum.is_maximum else -1)
    assert [part.sides for part in found.parts] == [(1, 1), None, (2, 0), None, (1, 1)]
    told = compare(certificate(name), found)
    assert told.verdict == "agrees"
    assert "the closed curve; " in told.reason
    assert "the point that is named" in told.reason


def _bent(atlas: dict[str, Any]) -> None:
    """As if the curve were another one: a = x^2 + 1/64 in the middle of the tube."""
    for piece in atlas["pieces"]:
        piece["polynomial"][0][0] = "0x1p-6"


def test_false_claims_are_not_proved() -> None:
    assert "increasing-a" in refused(lambda a: a["claim"].update(increasing=["a"]))
    assert "increasing-x" in refused(lambda a: a["claim"].update(increasing=["x"]), "circle")
    assert "covers" in refused(lambda a: a["claim"]["covers"].update({"to": "3"}))
    assert "covers" in refused(lambda a: a["claim"]["covers"].update({"from": "-3"}))
    assert "covers" in refused(
        lambda a: a["claim"].update(covers={"coordinate": "y", "from": "1", "to": "-0x1"}), "circle"
    )
    assert "tube" in refused(_bent)
    assert refused(lambda a: a["claim"].update(kind="equilibrium-loop"))
    assert refused(lambda a: a.update(pieces=a["pieces"][::-1]))
    # The last piece is of another curve, y = 2 x + .. of the circle's field.
    assert refused(lambda a: a["pieces"][1].update(centre=["0x1p-4", "0x1p-2", "0x1p-1"]))


def test_degenerate_extrema_are_not_followed() -> None:
    for power in ("x**3", "x**4"):
        field = f"v0 = x\nv1 = y\nv2 = a\nv3 = b\nv4 = v0 ** ({power[-1]})\nv5 = v2 - v4\nv6 = v1 - v0\nreturn v5, v6"
        given = certificate("bend", lambda c, field=field: c["statement"].update(vector_field=field))
        for piece in given["statement"]["atlas"]["pieces"]:
            piece["tube"] = ["0x1", "0x1p-12"]
        found = second_proof(given)
        assert isinstance(found, NotProved)
        assert "boxes become too short" in found.reason


def _sides(certificate: dict[str, Any], part: int, **sides: int) -> None:
    certificate["conclusion"]["sides"][part]["sides"] = sides


DIFFERENCES: dict[str, tuple[str, str, Callable[[dict[str, Any]], Any]]] = {
    "start.a": ("bend", "disagrees", lambda c: c["conclusion"]["ends"]["start"]["a"].update(mid="0x1p-3")),
    "end.y": ("bend", "disagrees", lambda c: c["conclusion"]["ends"]["end"]["y"].update(mid="0x1p-2")),
    "ends": ("bend", "disagrees", lambda c: c["conclusion"]["ends"]["end"].pop("y")),
    "fold 1": ("bend", "disagrees", lambda c: c["conclusion"]["folds"][0].update(is_maximum=True)),
    "fold 1:": ("bend", "disagrees", lambda c: c["conclusion"]["folds"][0]["all_values"].update(mid="0x1p-3")),
    "at the beginning": ("bend", "disagrees", lambda c: _sides(c, 0, left=2, right=0)),
    "at the end": ("bend", "disagrees", lambda c: _sides(c, 2, left=0, right=2)),
    "sides": ("circle", "cannot follow", lambda c: _sides(c, 2, left=0, right=2)),
    "sides:": ("bend", "cannot follow", lambda c: _sides(c, 1, left=0, right=2)),
    "fold 2": ("circle", "cannot follow", lambda c: c["conclusion"]["folds"][1].update(is_maximum=True)),
}


@pytest.mark.parametrize("what", DIFFERENCES)
def test_differences_are_reported(what: str) -> None:
    name, verdict, change = DIFFERENCES[what]
    found = compare(certificate(name, change), proved(name))
    assert found.verdict == verdict, found.reason
    assert what in found.reason


def test_what_cannot_be_read_is_named() -> None:
    for match, change in (
        ("pieces", lambda a: a["pieces"][0]["tube"].pop()),
        ("pieces", lambda a: a["pieces"][0].update(half_width="0x0")),
        ("pieces", lambda a: a["pieces"][0]["frame"][0].pop()),
        ("pieces", lambda a: a.update(pieces=[])),
        ("pieces", lambda a: a["parameters"].update(a="1")),
        ("pieces", lambda a: a["claim"].update(increasing=["z"])),
        ("parameters", lambda a: a["parameters"].pop("b")),
    ):
        with pytest.raises(BadCertificate, match=match):
            read_curve(certificate("bend", lambda c, change=change: change(c["statement"]["atlas"])))
    other = certificate("bend", lambda c: c["statement"]["atlas"]["claim"].update(kind="periodic-arc"))
    with pytest.raises(CannotFollow, match="about such curves"):
        read_curve(other)
    assert isinstance(second_proof(other), NotProved)


def test_sums_of_pairs_are_the_eigenvalues() -> None:
    """Of matrices with known eigenvalues in other coordinates: the determinant is the product of the sums."""
    source = Random(7)
    with precision(128):
        for size in (2, 3, 4):
            for _ in range(5):
                values = [source.randrange(-4, 5) for _ in range(size)]
                upper = [
                    [values[i] if i == j else source.randrange(-2, 3) * (i < j) for j in range(size)]
                    for i in range(size)
                ]
                change = arb_mat([[source.randrange(-3, 4) + 9 * (i == j) for j in range(size)] for i in range(size)])
                matrix = (change * arb_mat(upper) * change.inv()).tolist()
                expected = 1
                for a, b in combinations(values, 2):
                    expected *= a + b
                assert arb_mat(sums_of_pairs(matrix)).det().contains(expected)
                assert arb_mat(sums_of_pairs(upper)).det() == expected


@pytest.mark.quick
def test_the_command_takes_the_certificate_of_a_curve(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = tmp_path / "curve.json", tmp_path / "second.json"
    path.write_text(_certified("bend"), encoding="utf-8")
    assert main(["--second-proof", str(path), "-o", str(output), "--quiet"]) == 0
    assert "agrees" in capsys.readouterr().out
    (row,) = json.loads(output.read_text(encoding="utf-8"))["rows"]
    assert (row["kind"], row["verdict"], len(row["extrema"]), len(row["parts"])) == ("equilibrium-arc", "agrees", 1, 3)


def test_what_is_only_followed_in_part_is_not_confirmed() -> None:
    """Without the fold, and without a count that the certificate has."""
    whole = proved("bend")
    assert compare(certificate("bend"), replace(whole, extrema=())).verdict == "disagrees"
    unknown = tuple(replace(part, sides=None) for part in whole.parts)
    assert compare(certificate("bend"), replace(whole, parts=unknown)).verdict == "cannot follow"
