"""Systems with two reversing symmetries: a claim uses one of them, and the axial orbits are born where S breaks."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.claims import known

from orbitproof.explore.names import system_named
from orbitproof.explore.refinement import refine
from orbitproof.shared.formats import (
    Candidate,
    InputError,
    candidate_from_json,
    candidate_to_json,
    load_system,
    read_candidates,
)
from orbitproof.shared.systems import CR3BP, SYSTEMS, ReversibleSystem, describe, described
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify, digest, recheck

BIRTHS = {
    "earth-moon-L1-axial-k1-1": "3.02139212923076323216679724384125",
    "earth-moon-L2-axial-k1-1": "3.01376751514413786420556360224670",
    "sun-jupiter-L1-axial-k1-1": "3.00840226465034401746886395246522",
    "sun-jupiter-L2-axial-k1-1": "3.00781743092469500173323669963470",
}
"""First digits of the Jacobi constant."""

TWO = {
    "format": "orbitproof-system",
    "version": 1,
    "name": "two-oscillators",
    "state": ["x", "y", "vx", "vy"],
    "field": {"x": "vx", "y": "vy", "vx": "-x - 2*x*y**2", "vy": "-2*y - 2*x**2*y"},
    "R": {"x": -1, "vy": -1},
    "reversors": {"other": {"x": -1, "y": -1}},
    "symmetries": {"S": {"y": -1, "vy": -1}},
    "section": "x",
    "first_integral": "(vx**2 + vy**2 + x**2)/2 + y**2 + x**2*y**2",
}


@cache
def births() -> dict[str, Candidate]:
    return {item.id: item for item in read_candidates(Path(__file__).parents[1] / "data" / "axial-births.json")}


@cache
def certified(name: str) -> Certificate:
    return certify(births()[name], Limits(max_precision=512))


@pytest.mark.parametrize("name", BIRTHS)
def test_the_axial_family_is_born_on_the_planar_one(name: str) -> None:
    certificate = certified(name)
    assert certificate.proved, certificate.reason
    assert certificate.side == "below"
    assert certificate.parameter is not None
    with ctx.workprec(200):
        assert agree(certificate.parameter, arb(BIRTHS[name]) + arb(0, "1e-32"))
    assert certificate.point["vz"].contains(0)
    assert "reversible under the half turn about the x axis" in str(certificate.theorem)
    assert "(x, -y, -z, -vx, vy, vz) reverses the flow" in certificate.statement["in_full"]


def test_where_one_family_is_born_the_other_is_not() -> None:
    limits = Limits(max_precision=256, level="coordinates")
    for there, kernel_frame in (
        (births()["earth-moon-L1-axial-k1-1"], ((0, 1), (1, 0))),
        (known("em1"), ((1, 0), (0, 1))),
    ):
        # The same planar orbit and box: one of z and vz is a coordinate of Fix(R), the other one of q.
        x, *rest = zip(there.centre, there.frame, strict=True)
        system = CR3BP if there.system is not CR3BP else CR3BP.under("axial")
        centre, frame = zip(x, *reversed(rest), strict=True)
        rows = tuple(tuple(F(value) for value in row) for row in kernel_frame)
        certificate = certify(replace(there, system=system, centre=centre, frame=frame, kernel_frame=rows), limits)
        assert certificate.reason is not None
        assert certificate.reason.condition == "HC3"


def written(path: Path, **changes: Any) -> Path:
    path.write_text(json.dumps({**TWO, **changes}))
    return path


@pytest.fixture
def two(tmp_path: Path) -> ReversibleSystem:
    return load_system(written(tmp_path / "two.json"))


def test_a_system_of_ones_own_names_its_reversors_and_a_claim_says_which(two: ReversibleSystem) -> None:
    other = two.under("other")
    assert two.centre_coordinates == ("y", "vx")
    assert other.centre_coordinates == ("vx", "vy")
    for system in (two, other):
        assert described(json.loads(json.dumps(describe(system)))) == system
        assert pickle.loads(pickle.dumps(system)) is described(describe(system))
    entry = describe(other)
    assert isinstance(entry, dict)
    assert entry["reversor"] == "other"
    claim = {
        "id": "a", "system": entry, "parameters": {}, "kind": "period_tupling", "k": 2, "centre": ["1", "0"],
        "frame": [["1", "0"], ["0", "1"]], "kernel_frame": [["1"]], "radii": ["0x1p-9", "0x1p-9"],
    }  # fmt: skip
    candidate = candidate_from_json(claim, "claim")
    assert candidate.system.reversing_symmetry == (-1, -1, 1, 1)
    assert candidate_to_json(candidate)["system"] == entry


def test_the_command_line_takes_a_reversor_by_name(tmp_path: Path) -> None:
    path = written(tmp_path / "two.json")
    assert system_named(f"{path}:other").reversing_symmetry == (-1, -1, 1, 1)
    assert system_named("cr3bp:axial") is SYSTEMS["cr3bp-axial"] is CR3BP.under("axial")
    for text in (f"{path}:third", "cr3bp:third", "falkner-skan:axial"):
        with pytest.raises(InputError, match="no further reversing symmetry"):
            system_named(text)


@pytest.mark.parametrize(
    "signs, words",
    [
        ({"x": -1, "vx": -1}, ("reversors.other", "not reversible")),
        ({"x": -1}, ("reversors.other", "wrong dimension")),
        ({"y": -1, "vx": -1}, ("reversors.other", "must negate the section")),
        ({"u": -1}, ("reversors.other.u",)),
        ({"R": {"vx": -1, "vy": -1}, "section": "x"}, ("reversors.other: section: R must negate", "it negates vx, vy")),
        ({"R": {"vx": -1, "vy": -1}, "section": "u"}, ("reversors.other.section: 'u' is no state", "there are x, y")),
        ({"R": {"vx": -1, "vy": -1}, "section": 3}, ("reversors.other.section", "string")),
        ({"section": "vx"}, ("reversors.other", "section")),
        ({"R": {"vx": -1, "vy": -1}, "level_coordinate": "vx"}, ("reversors.other", "must negate the section")),
        ({"R": {"u": -1}, "section": "vx"}, ("reversors.other.u: no state coordinate",)),
        ({"R": {"x": -1}, "section": "x"}, ("reversors.other", "wrong dimension")),
    ],
)
def test_a_wrong_reversor_is_named_in_one_line(signs: dict[str, Any], words: tuple[str, ...], tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        load_system(written(tmp_path / "two.json", reversors={"other": signs}))
    assert "\n" not in str(error.value)
    for word in words:
        assert word in str(error.value)


EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"


@cache
def breaking() -> tuple[ReversibleSystem, Certificate]:
    """Henon and Heiles with the section x = 0; where S breaks under T, whose section is vy = 0."""
    own = described({
        "name": "henon-heiles-x", "state": ["x", "y", "vx", "vy"], "section": "x",
        "field": {"x": "vx", "y": "vy", "vx": "-x - 2*x*y", "vy": "-y - x**2 + y**2"},
        "R": {"x": -1, "vy": -1}, "symmetries": {"S": {"x": -1, "vx": -1}},
        "reversors": {"T": {"R": {"vx": -1, "vy": -1}, "section": "vy"}},
        "first_integral": "(vx**2 + vy**2 + x**2 + y**2)/2 + x**2*y - y**3/3",
    }).under("T")  # fmt: skip
    point = refine(own, {}, "symmetry_breaking", 1, [0.0, -0.49703478], digits=40, symmetry="S")
    return own, certify(point.to_candidate("T", {}), Limits(max_precision=512))


def test_a_reversor_has_a_section_of_its_own() -> None:
    own, proof = breaking()
    common = load_system(EXAMPLES / "henon-heiles.py").under("T")
    assert own.original is not None
    assert (own.original.section, own.section, common.section) == ("x", "vy", "vy")
    assert described(json.loads(json.dumps(describe(own)))) is own
    assert pickle.loads(pickle.dumps(own)) is own
    assert proof.proved, proof.reason
    assert "section {vy = 0}" in proof.statement["in_full"]
    # Published as 0.986709235 in units of 1/6.
    assert proof.parameter is not None
    with ctx.workprec(100):
        assert abs(6 * proof.parameter - arb("0.98670923531816")) < 1e-13
    assert recheck(proof, integrate=True).stands


def test_a_reversor_has_a_level_coordinate_of_its_own() -> None:
    own = described({
        **{key: value for key, value in TWO.items() if key not in ("format", "version")},
        "parameters": ["a"], "field": {"x": "vx", "y": "vy", "vx": "-a*x - 2*x*y**2", "vy": "-2*y - 2*x**2*y"},
        "first_integral": "(vx**2 + vy**2 + a*x**2)/2 + y**2 + x**2*y**2", "family_parameter": "a",
        "level_coordinate": "vx", "fixed_level": {"value": "1", "sign": 1},
        "reversors": {"T": {"R": {"y": -1, "vx": -1}, "section": "y", "level_coordinate": "vy"}},
    }).under("T")  # fmt: skip
    assert own.original is not None
    assert (own.original.level_coordinate, own.level_coordinate) == ("vx", "vy")
    assert (own.original.centre_coordinates, own.centre_coordinates) == (("a", "y"), ("a", "x"))
    assert described(json.loads(json.dumps(describe(own)))) is own


def test_a_section_that_is_not_the_reversors_own_is_found() -> None:
    _, proof = breaking()
    for forge in (lambda t: t.replace('"section": "vy"', '"section": "vx"'), lambda t: t.replace("vy", "vz", 1)):
        entry = json.loads(forge(json.dumps(proof.to_json())))
        entry["digest"] = digest(entry)
        assert not recheck(Certificate.from_json(entry)).stands
