"""A bifurcation as a theorem of Coq: the steps that are written prove it, and no other ones."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from fractions import Fraction as Q
from pathlib import Path

import pytest

from orbitproof.formal import falkner_skan, files
from orbitproof.formal.falkner_skan import TUPLINGS, coq_file, steps_to

FOLDER = Path(files.__file__).parent / "solutions"
README = (FOLDER.parent / "README.md").read_text("utf-8")
needs_coq = pytest.mark.skipif(
    shutil.which("coqc") is None, reason="Coq is not installed: apt install coq libcoq-bignums libcoq-coquelicot"
)


@pytest.mark.parametrize("k", TUPLINGS)
def test_numbers_are_those_of_the_theorem(k: int) -> None:
    about = TUPLINGS[k]
    text = (FOLDER / "Statements.v").read_text("utf-8")
    (found,) = re.findall(rf"Definition {about.name} : Prop :=\s+bifurcation (\d) (.*?)\(fun", text, re.DOTALL)
    numbers = [Q(x.strip("()").replace(" ", "")) for x in re.findall(r"\([^)]*\)|\d+", found[1])]
    unit = 2**about.clock
    first = int(about.half * unit)
    times = (Q(first, unit), Q(first + 1, unit))
    assert int(found[0]) == k == len(about.signs)
    assert numbers == [about.parameter, about.beginning, *about.near, *times, *about.slopes]
    (row,) = re.findall(rf"^\| {k} (\| \$.*)$", README, re.MULTILINE)
    box = re.findall(r"\$([\d.]+) \\pm 10\^\{-(\d+)\}\$", row)
    shown = [*(Q(x) for x, _ in box), *(1 / Q(10) ** int(r) for _, r in box), *map(Q, re.findall(r"\d+/\d+", row))]
    assert shown == numbers[:6]


def test_what_is_read_first_is_on_the_page() -> None:
    (shown,) = re.findall(r"It begins with\n\n```coq\n(.*?)```", README, re.DOTALL)
    half_orbit, comes_back = shown.split("Definition comes_back")
    text = (FOLDER / "Statements.v").read_text("utf-8")
    assert half_orbit in text
    assert f"Definition comes_back{comes_back}" in text


@pytest.mark.slow
def test_steps_stay_near_each_other_whether_the_box_is_a_point_or_not() -> None:
    about, first = TUPLINGS[2], Q(1, 64)
    around, centre = (steps_to(about, [first], radii)[-1].at_end() for radii in (about.radii, (Q(0), Q(0))))
    for x, y in zip(around, centre, strict=True):
        away = abs(Q(x.known[0][0] - y.known[0][0], 1 << about.form.bits))
        assert away <= Q(sum(x.unknown), 1 << about.form.eps)
        assert sum(y.unknown) < sum(x.unknown)


def check(path: Path) -> tuple[int, str]:
    done = subprocess.run(["sh", str(FOLDER / "check.sh"), str(path)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout.splitlines()[-1]


def with_a_wrong_coefficient(text: str) -> str:
    """In the middle of the steps from the centre."""
    found = [x for x in re.finditer(r"0x[0-9a-f]{25,}", text) if x.start() > text.index("Definition centre")]
    wrong = found[len(found) // 2]
    return f"{text[: wrong.start()]}{hex(int(wrong[0], 16) ^ (1 << 60))}{text[wrong.end() :]}"


def with_a_narrower_interval(text: str) -> str:
    """Of a coordinate at the last return, by a unit."""
    wrong = [x for x in re.finditer(r"\(\(-(0x[0-9a-f]+)\), ", text) if x.start() < text.index("Definition around")][-5]
    return f"{text[: wrong.start(1)]}{hex(int(wrong[1], 16) - 1)}{text[wrong.end(1) :]}"


def with_another_theorem(text: str) -> str:
    """Of Statements.v, where that of the file is one more line of a comment."""
    name = TUPLINGS[4].name
    return text.replace(f"solution : {name}.", "solution : period_tripling.") + f"(*\nTheorem solution : {name}.\n*)\n"


@needs_coq
@pytest.mark.slow
@pytest.mark.parametrize(
    ("k", "fault"), [(2, with_a_wrong_coefficient), (3, with_a_narrower_interval), (4, with_another_theorem)]
)
def test_the_kernel_takes_these_steps_and_no_others(tmp_path: Path, k: int, fault: Callable[[str], str]) -> None:
    text = coq_file(k)
    (tmp_path / "Right.v").write_text(text, "utf-8")
    (tmp_path / "Wrong.v").write_text(fault(text), "utf-8")
    code, said = check(tmp_path / "Right.v")
    assert (code, said.endswith("nothing else")) == (0, True)
    assert f" s: {TUPLINGS[k].name} of Statements.v; " in said
    code, said = check(tmp_path / "Wrong.v")
    assert (code, "NOT CHECKED" in said) == (1, True)
    assert falkner_skan.FIELD["z"] == "b*(y*y-1)-x*z"
