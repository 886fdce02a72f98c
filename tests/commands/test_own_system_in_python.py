"""A system of one's own from Python: from a description, functions or a file; a point from elsewhere as a claim."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from orbitproof import explore, shared
from orbitproof.explore.__main__ import main as explore_command

MICHELSON: dict[str, Any] = {
    "name": "michelson", "state": "x y z", "parameters": "c", "section": "x", "family_parameter": "c",
    "field": {"x": "y", "y": "z", "z": "c**2 - y - x**2/2"}, "R": {"x": -1, "z": -1},
}  # fmt: skip


def test_a_system_of_formulas_is_that_of_functions_and_of_a_file(tmp_path: Path) -> None:
    formulas = shared.define_system(MICHELSON)
    functions = shared.define_system({**MICHELSON, "field": lambda x, y, z, c: (y, z, c**2 - y - x**2 / 2)})
    assert functions.program.text() == formulas.program.text()
    file = tmp_path / "michelson.json"
    file.write_text(json.dumps({"format": "orbitproof-system", "version": 1, **MICHELSON}))
    assert shared.load_system(file) is formulas


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"R": {"x": -1}}, r"^Fix\(R\) has the wrong dimension"),
        ({"sektion": "x"}, "^sektion: unknown"),
        ({"name": "cr3bp"}, "^name: 'cr3bp' is the name of"),
    ],
)
def test_a_wrong_description_says_what_is_wrong_in_a_line(change: dict[str, Any], words: str) -> None:
    with pytest.raises(shared.InputError, match=words) as refused:
        shared.define_system({**MICHELSON, **change})
    assert "\n" not in str(refused.value)


def test_a_further_reversor_follows_the_file_after_a_colon(tmp_path: Path) -> None:
    file = tmp_path / "springs.py"
    file.write_text(
        'name = "springs"\nstate = "x y u v"\nfield = {"x": "u", "y": "v", "u": "-x - x**3", "v": "-y"}\n'
        'R = {"y": -1, "u": -1}\nsection = "y"\nfirst_integral = "(u**2 + v**2 + x**2 + y**2)/2 + x**4/4"\n'
        'first_integral_name = "energy"\nreversors = {"other": {"y": -1, "x": -1, "v": 1, "u": 1}}\n'
    )
    try:
        system = shared.load_system(f"{file}:other")
    except shared.InputError as error:
        pytest.fail(str(error))
    assert system.reversing_symmetry == (-1, -1, 1, 1)
    assert system.original is shared.load_system(file)
    with pytest.raises(shared.InputError, match=r"springs\.py:third: springs: no further reversing symmetry 'third'"):
        shared.load_system(f"{file}:third")


def test_a_point_from_elsewhere_becomes_the_claim_that_the_command_writes(tmp_path: Path) -> None:
    system = shared.define_system(MICHELSON)
    claim = explore.refine_at(system, {"c": 0.27634, "y": 0.52554}, 3, digits=30, quiet=True)
    assert repr(claim) == "<Candidate 'michelson-k3': touch_and_go, k = 3, of michelson>"
    description, output = tmp_path / "michelson.json", tmp_path / "one.json"
    description.write_text(json.dumps({"format": "orbitproof-system", "version": 1, **MICHELSON}))
    words = ["refine", "--system", str(description), "-k", "3", "--point", "c=0.27634", "y=0.52554"]
    assert explore_command([*words, "--digits", "30", "-o", str(output), "--quiet"]) == 0
    assert shared.read_candidates(output) == [claim]
    for change in ({"point": {"c": 0.3}}, {"digits": 0}, {"kind": "fork"}, {"parameters": {"mu": 1}}):
        given = {"point": {"c": 0.27634, "y": 0.52554}, "k": 3, "quiet": True, **change}
        with pytest.raises(ValueError, match=f"^{next(iter(change))}"):
            explore.refine_at(system, **given)


def test_what_is_claimed_prints_in_a_line(tmp_path: Path) -> None:
    assert repr(shared.CR3BP) == "<ReversibleSystem cr3bp: state x y z vx vy vz, parameters mu>"
    assert repr(shared.define_system(MICHELSON)) == "<ReversibleSystem michelson: state x y z, parameters c>"
