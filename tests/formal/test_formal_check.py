"""Files for Coq: what is written is what Coq computes too; the kernel accepts a row, and no other number in it."""

from __future__ import annotations

import json
import os
import random
import re
import shutil
import subprocess
from fractions import Fraction as Q
from pathlib import Path

import pytest
from planted import accepted, drawn, numbers

from orbitproof.__main__ import main as orbitproof
from orbitproof.formal.arithmetic import Element, Format, recentred
from orbitproof.formal.files import THEORY
from orbitproof.formal.recording import precision_for
from orbitproof.formal.rows import claim_of
from orbitproof.formal.writing import poly, z
from orbitproof.verify.certificate import Certificate

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


def test_orbits_are_followed_with_as_many_bits_as_the_parameter_needs_in_these_coordinates() -> None:
    stored = json.loads(CERTIFICATES.read_text("utf-8"))
    (entry,) = [entry for entry in stored["certificates"] if entry["id"] == ROW]

    def bits(precision: int, **coordinates: str) -> int:
        computation = {**entry["computation"], "precision": precision, **coordinates}
        certificate = Certificate({**entry, "computation": computation})
        return precision_for(certificate, claim_of(certificate))

    enough = bits(120, coordinates="Kustaanheimo-Stiefel")
    assert enough > 168
    assert bits(enough, coordinates="Kustaanheimo-Stiefel") == enough
    assert bits(120) == 120


def test_rows_that_would_share_a_folder_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    stored = json.loads(CERTIFICATES.read_text("utf-8"))
    (entry,) = [entry for entry in stored["certificates"] if entry["id"].endswith("odd-k4-1")]
    stored["certificates"] = [entry, {**entry, "id": entry["id"].replace("-", "_")}]
    (tmp_path / "two.json").write_text(json.dumps(stored), "utf-8")
    words = ["orbitproof", "verify", "--formal", str(tmp_path / "two.json"), "-o", str(tmp_path / "out")]
    monkeypatch.setattr("sys.argv", words)
    assert orbitproof() == 2
    assert f"it would have the folder of {entry['id']}" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_all_theories_are_written_and_compiled() -> None:
    script = (THEORY.parent / "check.sh").read_text("utf-8")
    (line,) = [line for line in script.splitlines() if line.startswith("theory=")]
    assert set(line.removeprefix("theory=").strip('"').split()) == {path.stem for path in THEORY.glob("*.v")}


def test_each_part_of_a_bifurcation_is_stated_or_is_a_choice() -> None:
    """By the records of the theory: what Coq prints of one, and what may be any that holds."""
    theory = "".join((THEORY / f"{name}.v").read_text("utf-8") for name in ("Rows", "Theorems"))
    parts: set[str] = set()
    for name in ("box", "level", "row", "own", "bifurcation"):
        (fields,) = re.findall(rf"Record {name} := \w+ {{(.*?)}}\.", theory, re.DOTALL)
        parts |= set(re.findall(r"(\w+) :", re.sub(r"\(\*.*?\*\)", "", fields, flags=re.DOTALL)))
    script = (THEORY.parent / "check.sh").read_text("utf-8")
    (printed,) = re.findall(r"Eval vm_compute in\n(.*?)\.\n", script, re.DOTALL)
    choices = {"weights", "level_guesses", "row_format", "onto_degree", "clock_bits", "precision", "own_format"}
    assert parts - set(re.findall(r"\w+", printed)) == choices | {"own_guesses"}
    assert "checked Conclusion.the_bifurcation := Conclusion.all_checked.\n" in script


def test_the_script_takes_no_other_files_and_no_other_assumptions(tmp_path: Path) -> None:
    """With a stand-in for Coq that accepts all and names what a row rests on."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "theory").mkdir()
    stand_in = tmp_path / "bin" / "coqc"
    shutil.copy(THEORY.parent / "check.sh", tmp_path)

    def answer(
        *names: str, row: str, heading: str = "Axioms:", end: tuple[str, ...] = ("     = tt", "     : unit")
    ) -> tuple[int, bool]:
        lines = "\n".join(["statement", "     : checked", heading, *names, *end])
        stand_in.write_text(
            f"#!/bin/sh\ncase \"$*\" in *Statement.v) cat <<'END'\n{lines}\nEND\nesac\n", encoding="utf-8"
        )
        stand_in.chmod(0o755)
        environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}"}
        done = subprocess.run(
            ["sh", str(tmp_path / "check.sh"), row], capture_output=True, text=True, check=False, env=environment
        )
        return done.returncode, ": checked in" in done.stdout

    def row_of(name: str, *others: str) -> str:
        (tmp_path / name).mkdir()
        for file in ("Row.v", "Step1.v", "Crossing1.v", "Conclusion.v", *others):
            (tmp_path / name / file).touch()
        return name

    good = ("PrimInt63.add", "  : PrimInt63.int -> PrimInt63.int", "PrimInt63.int : Set")
    row = row_of("row")
    stale = [tmp_path / "theory" / "Rows.vio", tmp_path / "theory" / "Rows.vo", tmp_path / row / "statement.txt"]
    for path in stale:
        path.write_text("stale")
    assert answer(*good, row=row) == (0, True)
    assert [path.exists() for path in stale] == [False, False, True]
    assert "stale" not in stale[2].read_text()
    for name in (
        "cheat : False",
        "PrimInt63.cheat : False",
        "Row.PrimInt63.int : False",
        "bad is assumed to be guarded.",
    ):
        assert answer(*good, name, row=row) == (1, False)
    assert answer(*good, row=row, end=()) == (1, False)
    assert answer(row=row, heading="Closed under the global context") == (1, False)
    for number, other in enumerate(("PrimInt63.v", "Step01.v", "Step1x.v", "other.cmxs", ".hidden.v")):
        assert answer(*good, row=row_of(f"other{number}", other)) == (1, False), other
    linked, foldered = row_of("linked"), row_of("foldered")
    (tmp_path / linked / "Orbitproof").symlink_to(tmp_path / "theory")
    (tmp_path / foldered / "Orbitproof").mkdir()
    (tmp_path / row_of("moved") / "Step1.v").unlink()
    (tmp_path / "moved" / "Step1.v").symlink_to(tmp_path / "row" / "Step1.v")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "row")
    for name in (linked, foldered, "moved", "link"):
        assert answer(*good, row=name) == (1, False), name

    # Nothing is removed of a folder that is none of ours.
    (tmp_path / row_of("notes", "notes.txt") / "day.log").write_text("Monday")
    assert answer(*good, row="notes") == (1, False)
    assert (tmp_path / "notes" / "day.log").exists()
    for name in ("Row.vo", "Rows.v/Rows.vo", "sub/Rows.vo", "Formal.v"):
        path = tmp_path / "theory" / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
        assert answer(*good, row=row) == (1, False), name
        path.unlink()
        if path.parent.name != "theory":
            path.parent.rmdir()
    assert answer(*good, row=row) == (0, True)
    (tmp_path / "theory").rmdir()
    (tmp_path / "theory").symlink_to(tmp_path / "elsewhere")
    assert answer(*good, row=row) == (1, False)


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


def coqc(folder: Path, name: str) -> bool:
    command = ["coqc", "-q", "-R", "../theory", "Orbitproof", "-Q", ".", "", f"{name}.v"]
    return subprocess.run(command, cwd=folder, capture_output=True, check=False).returncode == 0


def changed(folder: Path, name: str, *changes: tuple[str, str]) -> bool:
    """Whether Coq accepts a file after a change of its text; it is as before then."""
    path = folder / f"{name}.v"
    text = path.read_text("utf-8")
    other = text
    for pattern, replacement in changes:
        other, found = re.subn(pattern, replacement, other, flags=re.DOTALL)
        assert found == 1, pattern
    path.write_text(other, "utf-8")
    try:
        return coqc(folder, name)
    finally:
        path.write_text(text, "utf-8")


def no_other_claim(folder: Path) -> None:
    """Another multiplicity, kind or side, or other ends for the parameter, are not accepted."""
    assert changed(folder, "Conclusion")
    claim = r"(Claim 2 true) (\(-1\)|1|0)"
    (side,) = re.findall(r"Claim 2 true (\(-1\)|1|0)\n", (folder / "Conclusion.v").read_text("utf-8"))
    other = "1" if side != "1" else "(-1)"
    for replacement in (rf"Claim 4 true {side}", "Claim 3 false 0", rf"Claim 2 true {other}", "Claim 2 true 0"):
        assert not changed(folder, "Conclusion", (claim, replacement)), replacement
    ends = r"(Claim 2 true \S+\n  )\((\(Q [^)]*\)), (\(Q [^)]*\))\)\."
    assert not changed(folder, "Conclusion", (ends, r"\1(\3, \2)."))


def nothing_forged(folder: Path) -> None:
    """No way onto the section, or another time; a size that is not that of its element; a format without products."""
    crossing = (folder / "Crossing1.v").read_text("utf-8")
    assert changed(folder, "Crossing1", (r"\[\[0; 1\];", "[[0; 1; 1];"))
    assert not changed(folder, "Crossing1", (r"\[\[0; 1\];", f"[[0; 0x1{40 * '0'}];"))
    (source,) = re.findall(r"the_row (position_\d+) 1 the_steps", crossing)
    assert not changed(folder, "Crossing1", (r"the_steps 0 image_1", f"[] (-1) (here {source})"))
    row = (folder / "Row.v").read_text("utf-8")
    for changes in (
        ((r"(Definition position_0 : position := Position \()(.*?)(\)\n  0 )",
          r"\1map (fun x => Element (known x) (unknown x) (nothing the_format)) (\2)\3"),),
        ((r"(Definition the_format : format := Eval vm_compute in )(.*?)\.",
          r"\1let f := \2 in Format (monomials f) (grades f) (map (fun _ => []) (pairs f)) (top f) (bits f) "
          r"(grade_bits f) (kept f) (eps f)."),),
    ):  # fmt: skip
        text = row
        for pattern, replacement in changes:
            text, found = re.subn(pattern, replacement, text, flags=re.DOTALL)
            assert found == 1, pattern
        (folder / "Row.v").write_text(text, "utf-8")
        assert coqc(folder, "Row")
        (folder / "Start.v").write_text(
            "From Orbitproof Require Import Rows.\nRequire Import Row.\n"
            "Goal begins_at the_row position_0 = true. Proof. vm_compute. reflexivity. Qed.\n", "utf-8",
        )  # fmt: skip
        assert not coqc(folder, "Start")
    (folder / "Start.v").unlink()
    (folder / "Row.v").write_text(row, "utf-8")
    assert coqc(folder, "Row")


@needs_coq
@pytest.mark.slow
def test_the_kernel_accepts_a_row_and_no_other_number_in_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["orbitproof", "verify", "--formal", str(CERTIFICATES), "-o", str(tmp_path), "--only", ROW, "--quiet"]
    monkeypatch.setattr("sys.argv", words)
    assert orbitproof() == 0
    folder, assumed = tmp_path / ROW.replace("-", "_"), tmp_path / "only_assumed"
    assumed.mkdir()
    (assumed / "Row.v").write_text("", "utf-8")
    (assumed / "Step1.v").write_text("", "utf-8")
    (assumed / "Conclusion.v").write_text(
        "From Orbitproof Require Import Theorems.\nAxiom the_bifurcation : bifurcation.\n"
        "Axiom all_checked : checked the_bifurcation.\n", "utf-8",
    )  # fmt: skip
    script = ["sh", str(tmp_path / "check.sh")]
    done = subprocess.run(script, capture_output=True, text=True, check=False)
    first, second, *_ = done.stdout.splitlines()
    assert done.returncode == 1
    assert first.startswith(folder.name)
    assert first.endswith("assumptions: primitive integers, nothing else")
    assert second == f"{assumed.name}: NOT CHECKED: it rests on more than primitive integers:"

    # Numbers of steps and crossings, and of where the orbits are, one after the other; the last four of the beginning
    # are what is counted there, of which the first step does not need all.
    names = ["Row", *(path.stem for word in ("Step", "Crossing") for path in sorted(folder.glob(f"{word}?.v")))]
    planted = drawn(folder, names, 20, seed=51)
    planted += [each for each in numbers(folder / "Row.v") if each.of == "position_0"][-4:]
    for lemma in {each.seen_by: each for each in planted}.values():
        assert accepted(folder, lemma, 0, tmp_path / "work"), lemma
    for number, each in enumerate(planted):
        assert not accepted(folder, each, (-1) ** number, tmp_path / "work"), each

    no_other_claim(folder)
    nothing_forged(folder)
