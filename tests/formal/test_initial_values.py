"""Initial value problems for Coq: the balls that are written hold the solution, and the kernel takes no other ones."""

from __future__ import annotations

import re
import shutil
import subprocess
from fractions import Fraction as Q
from pathlib import Path

import pytest
from flint import arb

from orbitproof.formal import files
from orbitproof.formal.initial_values import coq_file
from orbitproof.shared import System, define_system
from orbitproof.verify import enclose

SCRIPT = Path(files.__file__).parent / "solutions" / "check.sh"
needs_coq = pytest.mark.skipif(
    shutil.which("coqc") is None, reason="Coq is not installed: apt install coq libcoq-bignums libcoq-coquelicot"
)


def lorenz() -> System:
    field = {"x": "sigma*(y-x)", "y": "x*(rho-z)-y", "z": "x*y-beta*z"}
    return define_system({"name": "lorenz", "state": "x y z", "parameters": "sigma rho beta", "field": field})


VALUES = {"x": 1, "y": 1, "z": 1, "sigma": 10, "rho": 28, "beta": Q(8, 3)}


def test_the_balls_of_a_file_hold_the_solution() -> None:
    text = coq_file(lorenz(), VALUES, Q(1, 8), bits=96, degree=16, digits=12)
    balls = re.findall(r"Rabs \((\w) \(1 / 8\) - \((-?\d+) / (\d+)\)\) <= \((\d+) / (\d+)\)", text)
    assert [name for name, *_ in balls] == ["x", "y", "z"]
    found = enclose.flow(lorenz(), enclose.box(VALUES), Q(1, 8), derivatives=0)
    assert isinstance(found, enclose.Enclosure)
    for name, *numbers in balls:
        centre, over, radius, under = map(int, numbers)
        away = abs(found.centre.value[name] - arb(centre) / over)
        assert away < arb(radius) / under
    assert Q(radius, under) <= Q(1, 10**12)


@pytest.mark.parametrize("time", [Q(0), Q(-1, 2), Q(1, 3)])
def test_times_that_no_file_can_have_are_refused(time: Q) -> None:
    with pytest.raises(ValueError, match="not positive and dyadic"):
        coq_file(lorenz(), VALUES, time)


@needs_coq
@pytest.mark.slow
def test_the_kernel_takes_the_balls_and_no_others(tmp_path: Path) -> None:
    text = coq_file(lorenz(), VALUES, Q(1, 8), bits=96, degree=16, digits=12)
    [ball] = re.findall(r"Rabs \(x \(1 / 8\) - \((-?\d+) / ", text)
    (tmp_path / "Right.v").write_text(text, "utf-8")
    (tmp_path / "Wrong.v").write_text(text.replace(ball, str(int(ball) + 3)), "utf-8")
    (tmp_path / "Assumed.v").write_text("Module Uint63. Axiom add_spec : False. End Uint63.\n" + text, "utf-8")
    said = {}
    for name in ("Right", "Wrong", "Assumed"):
        done = subprocess.run(
            ["sh", str(SCRIPT), str(tmp_path / f"{name}.v")], capture_output=True, text=True, check=False
        )
        said[name] = done.returncode, done.stdout.splitlines()[-1]
    assert said["Right"][0] == 0
    assert said["Right"][1].endswith("nothing else")
    assert said["Wrong"][0] == said["Assumed"][0] == 1
    assert all("NOT CHECKED" in said[name][1] for name in ("Wrong", "Assumed"))
