"""The Coq files of a row, and the script that has them checked."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from pathlib import Path

from orbitproof.formal import writing as w
from orbitproof.formal.rows import LevelData, Row
from orbitproof.shared.formats import InputError

THEORY = Path(__file__).parent / "theory"
OF_ORBITS = ("Polynomials", "Elements", "Formats", "Programs", "Steps", "Crossings", "Rows")
OF_CONCLUSIONS = ("Intervals", "Jets", "Conclusions", "Theorems")
STEPS_OF_A_FILE = 8
"""Coq takes half a second to start, as long as for a step of a polynomial field; files are checked side by side."""
_SOURCE = re.compile(r"(Row|Conclusion|(Step|Crossing)[1-9][0-9]*)\.v")
_OF_A_ROW = re.compile(
    r"\.?(Row|Conclusion|Statement|(Step|Crossing)[1-9][0-9]*)\.(v|vo|vok|vos|vio|glob|aux|log)|done|failed|statement\.txt"
)

_HEAD = """\
From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import {modules}.
{own}Import ListNotations.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

"""


def _head(*own: str, modules: tuple[str, ...] = OF_ORBITS) -> str:
    return _HEAD.format(modules=" ".join(modules), own=f"Require Import {' '.join(own)}.\n" if own else "")


def _checked(name: str, what: str) -> str:
    """A lemma that the kernel decides by computing once."""
    return f"Lemma {name} : {what} = true.\nProof. vm_cast_no_check (eq_refl true). Qed.\n"


def _level(level: LevelData) -> str:
    return (
        f"Level\n  ({w.program(level.integral)})\n"
        f"  {w.rational(level.inverse)} {w.z(level.sign)} ({w.affine(level.of)})\n"
        f"  {w.guesses(level.guesses)}"
    )


def _row(row: Row) -> str:
    claim, system, form = row.claim, row.claim.system, row.form
    starts = "[" + ";\n   ".join(map(w.affine, row.starts)) + "]"
    weights = w.listed([str(x) for x in form.weights], nat=True)
    level = "None" if row.level is None else f"(Some ({_level(row.level)}))"
    lines = [
        _head(),
        f"(* The state is ({', '.join(system.state)}), parameters are ({', '.join(system.parameters)}). *)",
        f"Definition the_field : program := {w.program(row.field)}.",
        f"Definition the_box : box := Box {weights} {w.rationals(claim.radii)}\n  {starts}.",
        f"Definition the_level : option level := {level}.",
        f"Definition the_format : format := Eval vm_compute in {w.form(form)}.",
        f"Definition the_row : row := Row the_field {len(system.state)} {system.section_index} the_box the_level "
        f"the_format {row.onto_degree} {w.z(row.clock_bits)}.",
    ]
    for n, position in enumerate(row.positions):
        here = w.state("written the_row", position.state)
        lines.append(
            f"Definition position_{n} : position := Position ({here})\n"
            f"  {w.z(position.clock)} {w.counter(position.counter)}."
        )
    for n, arrival in enumerate(row.arrivals, start=1):
        lines.append(f"Definition image_{n} : state := {w.state('written the_row', arrival.image)}.")
    return "\n\n".join(lines) + "\n"


def _claim(row: Row) -> list[str]:
    claim, system = row.claim, row.claim.system
    signs = w.listed([w.z(s) for s in system.reversing_symmetry])
    symmetry = "None"
    if claim.symmetry is not None and claim.k == 1:
        symmetry = f"(Some {w.listed([w.z(s) for s in system.symmetries[claim.symmetry]])})"
    frame = "[" + "; ".join(w.rationals(r) for r in claim.kernel_frame) + "]"
    integral = "None"
    if row.integral is not None:
        integral = f"(Some ({w.program(row.integral[0])},\n  {w.guesses(row.integral[1])}))"
    side = {"above": 1, "below": -1, "both": 0}[str(row.certificate.side)]
    low, high = map(w.rational, row.stated)
    tangential = "true" if claim.is_tangential else "false"
    own = "None"
    if row.own is not None:
        starts = "[" + ";\n   ".join(map(w.affine, row.own.starts)) + "]"
        weights = w.listed([str(x) for x in row.own.form.weights], nat=True)
        box = f"Box {weights} {w.rationals(row.own.claim.radii)}\n  {starts}"
        own = f"(Some (Own ({box})\n  ({w.form(row.own.form)})\n  {w.guesses(row.own.guesses)}))"
    return [
        f"Definition the_claim : claim := Claim {claim.k} {tangential} {w.z(side)}\n  ({low}, {high}).",
        f"Definition the_bifurcation : bifurcation := Bifurcation the_row {signs} {symmetry}\n  {frame} "
        f"{claim.crossings}\n  {integral} the_claim {w.z(row.precision)}\n  {own}.",
    ]


def _firsts(row: Row) -> range:
    """The first steps of files."""
    return range(1, len(row.moves) + 1, STEPS_OF_A_FILE)


def _steps(row: Row, first: int) -> str:
    text = [_head("Row")]
    for n, move in list(enumerate(row.moves, start=1))[first - 1 : first - 1 + STEPS_OF_A_FILE]:
        parts = w.listed([w.part(p) for p in move.parts])
        text += [
            f"Definition the_step_{n} : step := {w.step(move.step)}.\n",
            f"Definition the_parts_{n} : list part := {parts}.\n",
            _checked(f"step_{n}", f"goes the_row position_{n - 1} the_step_{n} the_parts_{n} position_{n}"),
        ]
    return "\n".join(text)


def _crossing(row: Row, n: int) -> str:
    arrival = row.arrivals[n - 1]
    steps = "[" + ";\n  ".join(map(w.step, arrival.steps)) + "]"
    return f"{_head('Row')}Definition the_steps : list step := {steps}.\n\n" + _checked(
        f"crossing_{n}", f"crosses the_row position_{arrival.source} {n} the_steps {w.z(arrival.ones)} image_{n}"
    )


def _theorem(row: Row) -> str:
    steps = [f"Step{n}" for n in _firsts(row)]
    crossings = [f"Crossing{n}" for n in range(1, len(row.arrivals) + 1)]
    images = w.listed([f"image_{n}" for n in range(1, len(row.arrivals) + 1)])
    lines = [
        _head("Row", *steps, *crossings, modules=(*OF_ORBITS, *OF_CONCLUSIONS)),
        *_claim(row),
        _checked("beginning", "begins_at the_row position_0"),
        _checked("exact", "exact_hypotheses the_bifurcation"),
        _checked("conclusion", f"conclusion_holds the_bifurcation {images}"),
    ]
    lines.append("Definition reached_0_0 : follows the_row position_0 [] := at_the_start _ _ beginning.")
    seen = 0
    found: list[str] = []
    for n in range(len(row.positions)):
        if n:
            now = w.listed(found)
            lines.append(
                f"Definition reached_{n}_{seen} : follows the_row position_{n} {now} :=\n"
                f"  after_a_step _ _ _ _ _ _ reached_{n - 1}_{seen} step_{n}."
            )
        for number, arrival in enumerate(row.arrivals, start=1):
            if arrival.source == n:
                found.append(f"image_{number}")
                lines.append(
                    f"Definition reached_{n}_{number} : follows the_row position_{n} {w.listed(found)} :=\n"
                    f"  at_a_crossing _ _ _ _ _ _ reached_{n}_{seen} crossing_{number}."
                )
                seen = number
    last = len(row.positions) - 1
    lines.append(
        "Theorem all_checked : checked the_bifurcation.\nProof.\n"
        f"  exists position_{last}, {images}.\n  exact (conj reached_{last}_{seen} (conj exact conclusion)).\nQed.\n"
    )
    lines.append("Print Assumptions all_checked.\n")
    return "\n".join(lines)


def name_of(identifier: str) -> str:
    """A folder and a name for Coq."""
    return re.sub(r"\W", "_", identifier)


def sources_of(row: Path) -> list[Path]:
    """The files of a row, which lie in this folder; `check.sh` takes no others."""
    return sorted(path for path in row.glob("*.v") if _SOURCE.fullmatch(path.name))


def digest_of(sources: Iterable[tuple[str, str]]) -> str:
    """Of names and texts of the files of a row."""
    found = hashlib.sha256()
    for name, text in sorted(sources):
        found.update(f"{name} {hashlib.sha256(text.encode()).hexdigest()}\n".encode())
    return found.hexdigest()


def write_row(row: Row, folder: Path) -> tuple[Path, str]:
    """Write the files of a row into a folder of its own; returns that, and the digest of what was written.

    Raises `OSError`, and `InputError` if the folder is a link.
    """
    own = folder / name_of(row.certificate.id)
    if own.is_symlink():
        raise InputError(f"{own} is a link; remove it, or give another folder")
    own.mkdir(parents=True, exist_ok=True)
    # Other files, which `check.sh` refuses, are not ours to remove.
    for old in [path for path in own.iterdir() if _OF_A_ROW.fullmatch(path.name)]:
        old.unlink()
    files = {"Row.v": _row(row)}
    files |= {f"Step{n}.v": _steps(row, n) for n in _firsts(row)}
    files |= {f"Crossing{n}.v": _crossing(row, n) for n in range(1, len(row.arrivals) + 1)}
    files["Conclusion.v"] = _theorem(row)
    for name, text in files.items():
        (own / name).write_text(text, encoding="utf-8")
    return own, digest_of(files.items())
