"""Files for Coq: what is written is what Coq computes too; the kernel accepts a row, and no other number in it."""

from __future__ import annotations

import json
import random
import shutil
import subprocess
from fractions import Fraction as Q
from pathlib import Path

import pytest
from planted import accepted, drawn

from orbitproof.__main__ import main as orbitproof
from orbitproof.formal.arithmetic import Element, Format, recentred
from orbitproof.formal.files import THEORY
from orbitproof.formal.writing import poly, z

CERTIFICATES = Path(__file__).parents[1] / "data" / "figures-certificates.json"
ROW = "falkner-skan-odd-k2-1"
SMALL = Format((2, 1), 3, 40, 6, 9, 140)
needs_coq = pytest.mark.skipif(
    shutil.which("coqc") is None, reason="Coq is not installed: apt install coq libcoq-bignums"
)


def element(source: random.Random, size: int) -> Element:
    known = [
        [
            source.randint(-1, 1) * source.getrandbits(SMALL.scale(g) - size)
            for _ in range(source.randint(0, SMALL.kept))
        ]
        for g in SMALL.grades
    ]
    return Element(SMALL, known, [source.getrandbits(60) for _ in range(SMALL.top + 2)])


def values(x: Element, theta: Q, xi: tuple[Q, Q], errors: list[Q]) -> Q:
    """At one point, of a function of the set: all that is unknown is a number for each grade."""
    result = Q(0)
    for exponents, g, p in zip(x.form.monomials, x.form.grades, x.known, strict=True):
        power = xi[0] ** exponents[0] * xi[1] ** exponents[1]
        result += sum((c * theta**n for n, c in enumerate(p)), Q(0)) / 2 ** x.form.scale(g) * power
    # A monomial of each grade, and one above: of norm 1.
    for g, e in enumerate(errors):
        result += e * xi[1] ** g
    return result


def test_products_powers_and_scalings_contain_what_they_are_of() -> None:
    source = random.Random(51)
    for _ in range(40):
        x, y = element(source, 3), element(source, 3)
        theta, xi = Q(source.randint(0, 16), 16), (Q(source.randint(-8, 8), 8), Q(source.randint(-8, 8), 8))
        at = []
        for each in (x, y):
            errors = [Q(e, 1 << SMALL.eps) * source.choice((-1, 0, 1)) for e in each.unknown]
            at.append(values(each, theta, xi, errors))
        factor = Q(source.randint(-9, 9), source.randint(1, 9))
        one = SMALL.const(Q(1))
        base = one + y.scaled(Q(1, 1 << 20))
        guess = (one - y.scaled(Q(1, 1 << 20))).known
        inverse = 1 / (1 + at[1] / (1 << 20))
        for found, exact in (
            (x * y, at[0] * at[1]), (x.scaled(factor), factor * at[0]), (x - y, at[0] - at[1]),
            (base.power(1, 1, guess), inverse), (base.power(2, 1, guess), inverse**2),
        ):  # fmt: skip
            away = abs(values(found, theta, xi, []) - exact)
            assert away <= Q(sum(found.unknown), 1 << SMALL.eps)


def test_what_is_not_covered_is_named_and_nothing_is_written_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["orbitproof", "verify", "--formal", str(CERTIFICATES), "-o", str(tmp_path), "--only", "*-k4-1", "--json"]
    monkeypatch.setattr("sys.argv", words)
    assert orbitproof() == 1
    (answer,) = json.loads(capsys.readouterr().out)["results"]
    assert (answer["written"], "not proved" in answer["line"]) == (False, True)
    assert {path.name for path in tmp_path.iterdir()} == {"theory", "check.sh"}


def test_all_theories_are_written_and_compiled() -> None:
    script = (THEORY.parent / "check.sh").read_text("utf-8")
    (line,) = [line for line in script.splitlines() if line.startswith("theory=")]
    assert set(line.removeprefix("theory=").strip('"').split()) == {path.stem for path in THEORY.glob("*.v")}


@needs_coq
def test_coq_multiplies_as_what_writes_the_files(tmp_path: Path) -> None:
    source = random.Random(52)
    p, q = ([source.getrandbits(90) - 2**89 for _ in range(n)] for n in (7, 9))
    product = [sum(p[i] * q[n - i] for i in range(7) if 0 <= n - i < 9) for n in range(15)]
    rest = sum(abs(a * b) for i, a in enumerate(p) for j, b in enumerate(q) if i + j >= 10)
    moved, _ = recentred(3, 4, p)
    shutil.copy(THEORY / "Polynomials.v", tmp_path)
    goals = (
        (f"poly_is (pmul 10 {poly(p)} {poly(q)}) {poly(product[:10])}", "true"),
        (f"poly_is (pmul 10 {poly(p)} {poly(q)}) {poly([*product[:9], product[9] + 1])}", "false"),
        (f"pmul_rest 10 {poly(p)} {poly(q)} =? {z(rest)}", "true"),
        (f"poly_is (recentred 3 4 {poly(p)}) {poly(moved)}", "true"),
    )
    lemmas = "".join(f"Goal ({what}) = {value}. Proof. vm_compute. reflexivity. Qed.\n" for what, value in goals)
    (tmp_path / "Test.v").write_text(
        "From Coq Require Import List.\nFrom Bignums Require Import BigZ.\n"
        "From Orbitproof Require Import Polynomials.\nImport ListNotations.\n"
        "Local Open Scope bigZ_scope.\nLocal Open Scope list_scope.\n"
        "Definition poly_is (p q : poly) : bool := forallb (fun c => c =? 0) (psub p q).\n" + lemmas,
        encoding="utf-8",
    )
    for name in ("Polynomials", "Test"):
        command = ["coqc", "-q", "-R", ".", "Orbitproof", f"{name}.v"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


@needs_coq
@pytest.mark.slow
def test_the_kernel_accepts_a_row_and_no_other_number_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ["orbitproof", "verify", "--formal", str(CERTIFICATES), "-o", str(tmp_path), "--only", ROW, "--quiet"]
    monkeypatch.setattr("sys.argv", words)
    assert orbitproof() == 0
    checked = subprocess.run(["sh", str(tmp_path / "check.sh")], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout
    assert "assumptions: primitive integers, nothing else" in checked.stdout
    folder = tmp_path / ROW.replace("-", "_")
    names = [path.stem for pattern in ("Step?.v", "Crossing?.v") for path in sorted(folder.glob(pattern))]
    for number, planted in enumerate(drawn(folder, names, 40, seed=51)):
        assert not accepted(folder, planted, (-1) ** number, tmp_path / "work"), planted
