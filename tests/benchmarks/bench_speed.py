"""Processor time of rows, pieces, the first answer and the demo; of another checkout beside it, run in turn.

python tests/benchmarks/bench_speed.py [--against CHECKOUT] [--only NAME ..] [--runs 3] [--long] [--list]

Each measurement is a process of its own. Rows and pieces are proved once before they are timed, so that what is loaded
at first does not count; commands begin with nothing compiled. The other checkout needs an environment of its own
(.venv). The least of all runs is printed, and the ratio: this checkout to the other one.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROWS = {"row": "earth-moon-L1-halo-k2-1", "row of Falkner-Skan": "falkner-skan-odd-k2-1"}
PIECES = ("falkner-skan", "lyapunov", "symmetric", "regularised", "l3-halo")
ORBIT = "explore orbit --family nrho --mass earth-moon --period 1.36 -o orbit.json"
DEMO = ["make", "--no-print-directory", "demo"]


def _seconds(work: Callable[[], object]) -> float:
    """Of the second run."""
    work()
    start = time.process_time()
    work()
    return time.process_time() - start


def row(name: str) -> float:
    """One certificate of a stored row, with its proof."""
    from orbitproof.shared.formats import read_candidates
    from orbitproof.verify.certificate import certify

    rows = {each.id: each for each in read_candidates(Path("tests/data/known-bifurcations.json"))}
    return _seconds(lambda: certify(rows[name]))


def piece(name: str) -> float:
    """One piece of a curve, with the limits that a run begins with."""
    sys.path.insert(0, "tests")
    from support.piece_cases import known_piece

    from orbitproof.verify.curve import prove_piece
    from orbitproof.verify.oracle import ORACLE

    system, parameters, symmetry, claim = known_piece(name)
    interval = Fraction(-1), Fraction(1)
    return _seconds(lambda: prove_piece(system, parameters, claim, interval, ORACLE, symmetry=symmetry))


def command(words: Sequence[str], checkout: Path, first_line: bool) -> float:
    """Processor time of a command and all that it starts; up to the first line that it prints, if that is asked for."""
    with tempfile.TemporaryDirectory() as folder:
        env = {**os.environ, "ORBITPROOF_CACHE": f"{folder}/compiled", "JAX_PLATFORMS": "cpu"}
        env.pop("PYTHONDONTWRITEBYTECODE", None)
        place = checkout if words[0] == "make" else Path(folder)
        process = subprocess.Popen(
            [*words, *([f"OUT={folder}/out"] if words[0] == "make" else [])],
            cwd=place, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        assert process.stdout is not None
        if first_line:
            process.stdout.readline()
            used = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
            process.kill()
            process.communicate()
            return sum(map(int, used[11:13])) / os.sysconf("SC_CLK_TCK")
        process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in (0, 1):
            raise SystemExit(f"{' '.join(words)}: exit code {process.returncode}")
        return usage.ru_utime + usage.ru_stime


def items(long: bool) -> Mapping[str, Sequence[str]]:
    """What is measured, and how: a function here with its argument, or a command."""
    found: dict[str, Sequence[str]] = {title: ("row", name) for title, name in ROWS.items()}
    found |= {f"piece: {name}": ("piece", name) for name in PIECES}
    found["first line of progress"] = ("first", *ORBIT.split())
    found["an orbit by its period"] = ("command", *ORBIT.split())
    found["make demo"] = ("command", *DEMO)
    if long:
        search, rows = "explore candidates --preset tables -o rows.json", "verify rows.json -o proved.json --jobs 1"
        found["62 rows: search"] = ("command", *search.split())
        found["62 rows: search and proof"] = ("commands", search, rows)
        for name, options in (
            ("l1-circle-sun-jupiter", "--complete 12"),
            ("l1-circle-earth-moon", "--complete 12"),
            ("dro-earth-moon", "--complete 4 --lasting"),
            ("falkner-skan", "--complete 12"),
        ):
            cover, proof = (
                f"explore atlas --preset {name} -o a.json",
                f"verify atlas a.json -o p.json {options} --jobs 1",
            )
            found[f"{name}: cover"] = ("command", *cover.split())
            found[f"{name} {options}: cover and proof"] = ("commands", cover, proof)
    return found


def measured(how: Sequence[str], checkout: Path) -> float:
    """Seconds, in a process of a checkout."""
    kind, *words = how
    bin_ = checkout / ".venv" / "bin"
    python = str(bin_ / "python") if bin_.is_dir() else sys.executable
    if kind in ("row", "piece"):
        ran = subprocess.run(
            [python, str(Path(__file__).resolve()), "--one", kind, *words],
            cwd=checkout, capture_output=True, text=True, check=True,
            env={**os.environ, "PYTHONPATH": str(checkout / "src")},
        )  # fmt: skip
        return float(ran.stdout)
    if words[0] == "make":
        return command(words, checkout, first_line=False)
    orbitproof = str(bin_ / "orbitproof")
    if kind == "commands":
        whole = " && ".join(f"{{ {orbitproof} {each}; [ $? -le 1 ]; }}" for each in words)
        return command(["sh", "-c", whole], checkout, first_line=False)
    return command([orbitproof, *words], checkout, kind == "first")


def main() -> None:
    """Measure in turn and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--against", type=Path, metavar="CHECKOUT", help="another checkout, with an environment of its own"
    )
    parser.add_argument("--only", nargs="+", metavar="NAME", help="what contains one of these words")
    parser.add_argument("--runs", type=int, default=3, help="default: %(default)s")
    parser.add_argument("--long", action="store_true", help="also 62 rows and four long theorems (hours)")
    parser.add_argument("--list", action="store_true", help="say what is measured, and measure nothing")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one is not None:
        kind, name = options.one
        print({"row": row, "piece": piece}[kind](name))
        return
    chosen = {
        title: how
        for title, how in items(options.long).items()
        if options.only is None or any(word in title for word in options.only)
    }
    if options.list:
        print("\n".join(chosen))
        return
    checkouts = [ROOT] if options.against is None else [options.against.resolve(), ROOT]
    print("| | " + " | ".join(["seconds"] if len(checkouts) == 1 else ["before", "after", "ratio"]) + " |")
    print("| --- |" + " --- |" * (1 if len(checkouts) == 1 else 3))
    for title, how in chosen.items():
        runs = [[measured(how, checkout) for checkout in checkouts] for _ in range(options.runs)]
        least = [min(column) for column in zip(*runs, strict=True)]
        numbers = [f"{value:.3g}" for value in least]
        if len(least) == 2:
            numbers.append(f"{least[1] / least[0]:.2f}")
        print(f"| {title} | " + " | ".join(numbers) + " |", flush=True)


if __name__ == "__main__":
    main()
