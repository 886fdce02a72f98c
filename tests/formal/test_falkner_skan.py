"""A bifurcation as a theorem of Coq: the steps that are written prove it, and no other ones."""

from __future__ import annotations

import re
import shutil
import subprocess
from fractions import Fraction as Q
from pathlib import Path

import pytest

from orbitproof.formal import falkner_skan, files
from orbitproof.formal.falkner_skan import BEGINNING, FORM, PARAMETER, RADII, coq_file, steps_to

FOLDER = Path(files.__file__).parent / "solutions"
needs_coq = pytest.mark.skipif(
    shutil.which("coqc") is None, reason="Coq is not installed: apt install coq libcoq-bignums libcoq-interval"
)


def test_numbers_are_those_of_the_theorem() -> None:
    text = (FOLDER / "FalknerSkan.v").read_text("utf-8")
    for name, value in (("b_ratio", PARAMETER), ("e_ratio", BEGINNING)):
        (over, under) = re.findall(rf"Definition {name} : ratio := \((\d+), (\d+)\)%bigZ", text)[0]
        assert Q(int(over), int(under)) == value
    (form,) = re.findall(r"fs_format : format := format_of \[\] 0 (\d+) 0 (\d+) (\d+)\.", text)
    assert tuple(map(int, form)) == (FORM.bits, FORM.kept - 1, FORM.eps)
    (radii,) = re.findall(r"box_of steps \((\d+), (\d+)\)%bigZ \((\d+), (\d+)\)%bigZ 1000000000000 ", text)
    over_b, under_b, over_e, under_e = map(int, radii)
    assert (Q(over_b, under_b), Q(over_e, under_e)) == RADII


@pytest.mark.slow
def test_steps_stay_near_each_other_whether_the_box_is_a_point_or_not() -> None:
    first = Q(1, 64)
    around, centre = (steps_to([first], radii)[-1].at_end() for radii in (RADII, (Q(0), Q(0))))
    for x, y in zip(around, centre, strict=True):
        away = abs(Q(x.known[0][0] - y.known[0][0], 1 << FORM.bits))
        assert away <= Q(sum(x.unknown), 1 << FORM.eps)
        assert sum(y.unknown) < sum(x.unknown)


def check(path: Path) -> tuple[int, str]:
    done = subprocess.run(["sh", str(FOLDER / "check.sh"), str(path)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout.splitlines()[-1]


@needs_coq
@pytest.mark.slow
def test_the_kernel_takes_these_steps_and_no_others(tmp_path: Path) -> None:
    text = coq_file()
    (tmp_path / "Right.v").write_text(text, "utf-8")
    numbers = [
        found for found in re.finditer(r"0x[0-9a-f]{25,}", text) if found.start() > text.index("Definition centre")
    ]
    wrong = numbers[len(numbers) // 2]
    changed = f"{text[: wrong.start()]}{hex(int(wrong[0], 16) ^ (1 << 60))}{text[wrong.end() :]}"
    (tmp_path / "Wrong.v").write_text(changed, "utf-8")
    code, said = check(tmp_path / "Right.v")
    assert (code, said.endswith("assumptions: the real numbers and primitive integers, nothing else")) == (0, True)
    code, said = check(tmp_path / "Wrong.v")
    assert (code, "NOT CHECKED" in said) == (1, True)
    assert falkner_skan.FIELD["z"] == "b*(y*y-1)-x*z"
