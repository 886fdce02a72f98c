"""What Coq has printed of three rows, and changes of each part of it, beside their certificates."""

from __future__ import annotations

import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from orbitproof import verify
from orbitproof.formal import files
from orbitproof.formal.rows import claim_of, stated_of
from orbitproof.formal.statements import _printed, difference

DATA = Path(__file__).parents[1] / "data"
PRINTED = json.loads((DATA / "formal-statements.json").read_text("utf-8"))
FILES = {"map": "figures-certificates.json", "integral": "figures-certificates.json", "level": "formal-level-form.json"}
IDS = {"map": "falkner-skan-odd-k2-1", "integral": "earth-moon-L1-halo-k1-1", "level": "earth-moon-L1-halo-k1-1"}
NOT_UNDERSTOOD = "what Coq states was not understood"

OTHERS = [
    ("map", r"Programs\.Mul 1 1", "Programs.Mul 1 0", "field"),
    ("map", r"Programs\.Sub 4 5", "Programs.Add 4 5", "field"),
    ("map", r"Programs\.Const 1 1", "Programs.Const 2 1", "field"),
    ("level", r"Programs\.Power 15 3 2", "Programs.Power 15 1 2", "field"),
    ("level", r"Programs\.Scale 33 \(-1\) 1", "Programs.Scale 33 1 1", "field"),
    ("map", r"outputs := \[1%nat; 2%nat", "outputs := [2%nat; 1%nat", "field"),
    ("map", r"inputs := 4", "inputs := 5", "field"),
    ("map", r"3%nat, 2%nat,", "4%nat, 2%nat,", "dimension"),
    ("map", r"3%nat, 2%nat,", "3%nat, 0%nat,", "section"),
    ("map", r"843328 \|\}", "843329 |}", "box"),
    ("map", r"over := 16604700741", "over := -16604700741", "box"),
    ("level", r"OfLevel", "Affine {| over := 0; under := 1 |} []", "box"),
    ("level", r"\{\| over := -1; under := 1 \|\}, 1,", "{| over := -1; under := 1 |}, -1,", "level"),
    ("level", r"\{\| over := -1; under := 1 \|\}, 1,", "{| over := -1; under := 2 |}, 1,", "level"),
    ("level", r"Programs\.Power 15 1 2", "Programs.Power 15 3 2", "level"),
    ("level", r"over := 32646316192723", "over := 32646316192724", "level"),
    ("map", r"\(\[-1; 1; -1\]", "([1; 1; -1]", "signs of R"),
    ("level", r"Some \[1; 1; -1; 1; 1; -1\]", "Some [1; 1; -1; 1; 1; 1]", "signs of S"),
    ("level", r"Some \[1; 1; -1; 1; 1; -1\]", "None", "signs of S"),
    ("map", r"None, \[\[\{\| over := -1; under := 1", "None, [[{| over := 1; under := 1", "frame of q"),
    ("map", r"\]\]%list, 1%nat\)", "]]%list, 2%nat)", "crossings of a half orbit"),
    ("integral", r"Programs\.Power 15 1 2", "Programs.Power 15 3 2", "first integral"),
    ("integral", r"outputs := \[32%nat\]", "outputs := [31%nat]", "first integral"),
    ("map", r"multiplicity := 2", "multiplicity := 4", "multiplicity"),
    ("map", r"tangential := true", "tangential := false", "kind"),
    ("map", r"claimed_side := -1", "claimed_side := 1", "side"),
    ("map", r"12829770534887;", "12829770534888;", "ends of the parameter"),
    ("level", r"under := 72057594037927936", "under := 72057594037927935", "own box"),
    ("level", r"Some\s*\{\|\s*weights.*\|\}\)\n     : ", "None)\n     : ", "own box"),
    ("map", r", None\)\n     : ", ", Some {| weights := []; radii := []; starts := [] |})\n     : ", "own box"),
    ("level", r"weights := \[", "more := 1; weights := [", "own box"),
    # Names that a file may have given to something else.
    ("map", r"Programs\.Sub 4 5", "Row.Programs.Sub 4 5", "field"),
    ("map", r"Programs\.inputs", "Row.inputs", "field"),
    ("level", r"OfLevel", "Row.OfLevel", "box"),
    ("level", r"Some(?= \[1; 1)", "Row.Some", "signs of S"),
    ("map", r"None(?=, \[\[)", "Row.None", "signs of S"),
    ("map", r"tangential := true", "tangential := Conclusion.true", "kind"),
]  # fmt: skip

UNREADABLE = [
    ("map", r"multiplicity := 2", "multiplicity := 2; multiplicity := 2"),
    ("map", r"multiplicity := 2", "multiplicity := 2; more := 2"),
    ("map", r"tangential := true;", ""),
    ("map", r"under := 17840596\d+", "under := 0"),
    ("map", r"over := 1; under := 1784", "over := -1; under := -1784"),
    ("map", r"over := 16604700741", "over := ?"),
    ("map", r"Programs\.Mul 1 1", "(Programs.Mul 0 0) 1 1"),
    ("map", r"None\)\n     : ", "None)]\n     : "),
    ("map", r"3%nat, 2%nat,", "3%nat 2%nat,"),
    ("map", r"\A     = ", "Warning\n     = "),
    ("map", r"\A     = ", "     "),
    ("map", r"checked Conclusion\.the_bifurcation", "checked other"),
    ("map", r"Axioms:", ""),
    ("map", r"statement\n     : checked", "other\n     : checked"),
    ("map", r"option box\n", "option box * nat\n"),
    ("map", r"3%nat, 2%nat,", f"{'(' * 20000}3%nat, 2%nat,"),
    ("map", r".*", ""),
]


@pytest.fixture(scope="module")
def entries() -> dict[str, verify.Certificate]:
    return {name: next(entry for entry in verify.read(DATA / FILES[name]) if entry.id == IDS[name]) for name in FILES}


def changed(text: str, pattern: str, replacement: str) -> str:
    found, count = re.subn(pattern, lambda _: replacement, text, count=1, flags=re.DOTALL)
    assert count == 1, pattern
    return found


def test_what_coq_states_is_the_claim_of_the_certificate_and_of_no_other(
    entries: dict[str, verify.Certificate],
) -> None:
    for name, entry in entries.items():
        for of, text in PRINTED.items():
            assert (difference(entry, text) == "") == (of == name), (name, of)


@pytest.mark.parametrize("name", FILES)
def test_what_is_written_of_a_claim_is_what_coq_prints(name: str, entries: dict[str, verify.Certificate]) -> None:
    entry, text = entries[name], " ".join(PRINTED[name].replace("-1", "(-1)").split())
    row = SimpleNamespace(
        claim=claim_of(entry), certificate=entry, stated=stated_of(entry), integral=None, own=None, precision=5
    )
    written = " ".join(" ".join(files._claim(row)).split())
    ((k, kind, side),) = re.findall(r"multiplicity := (\d); tangential := (\w+); claimed_side := (\S+);", text)
    ((r, s),) = re.findall(r"\((\[[^\]{]*\]), (None|Some \[[^\]]*\]),", text)
    assert f"Claim {k} {kind} {side} (" in written
    assert f"Bifurcation the_row {r} {s if s == 'None' else f'({s})'} [[" in written


@pytest.mark.parametrize("name", FILES)
def test_each_part_that_differs_is_named(name: str, entries: dict[str, verify.Certificate]) -> None:
    for of, pattern, replacement, part in OTHERS:
        if of == name:
            said = difference(entries[name], changed(PRINTED[name], pattern, replacement))
            assert said == f"what Coq states is not what the certificate claims: {part}", pattern


def test_what_is_not_understood_is_not_the_claim(entries: dict[str, verify.Certificate]) -> None:
    for name, pattern, replacement in UNREADABLE:
        text = changed(PRINTED[name], pattern, replacement)
        assert difference(entries[name], text) == NOT_UNDERSTOOD, (pattern, replacement)
    for more in (PRINTED["map"], PRINTED["level"], "     = 1\n     : nat\n"):
        for text in (PRINTED["map"] + more, more + PRINTED["map"], PRINTED["map"].removeprefix("     = ") + more):
            assert difference(entries["map"], text) == NOT_UNDERSTOOD


def test_the_programs_that_coq_prints_are_field_and_first_integral(entries: dict[str, verify.Certificate]) -> None:
    """By what `theory/Programs.v` says of operations, beside what they are at a point."""
    for name, entry in entries.items():
        system = entry.candidate.system
        point = [0.3 + 0.2 * i for i in range(len(system.state))]
        given = [0.1 + 0.05 * i for i in range(len(system.parameters))]
        printed = _printed(PRINTED[name])
        (field, level, integral), found = (printed[i] for i in (0, 4, 9)), {}
        found[system.vector_field] = field
        for each in (level, integral):
            if each.to:
                found[system.first_integral] = each.to[0][0] if each is level else each.to[0]
        assert len(found) == 1 + (name != "map")
        for function, program in found.items():
            wanted = np.atleast_1d(function(point, given))
            assert evaluated(program, [*point, *given]) == pytest.approx(list(wanted), rel=1e-12), name


def evaluated(program: dict[str, Any], values: list[float]) -> list[float]:
    assert program["Programs.inputs"] == len(values)
    for node in program["Programs.nodes"]:
        at = [values[i] for i in node.to[:2] if i < len(values)]
        match node.head.removeprefix("Programs."), node.to:
            case "Add", _:
                values.append(at[0] + at[1])
            case "Sub", _:
                values.append(at[0] - at[1])
            case "Mul", _:
                values.append(at[0] * at[1])
            case "Const", (a, b):
                values.append(a / b)
            case "Scale", (_, a, b):
                values.append(at[0] * a / b)
            case "Power", (_, a, b):
                values.append(at[0] ** (-a / b))
    return [values[i] for i in program["Programs.outputs"]]
