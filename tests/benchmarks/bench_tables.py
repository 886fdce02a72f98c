"""How the time of a row grows with k and with the distance to the smaller primary, and what KS coordinates save.

python tests/benchmarks/bench_tables.py certificates.json
python tests/benchmarks/bench_tables.py certificates.json --candidates candidates.json --both ID [ID ..]

Reads the seconds of a finished `orbitproof verify`; with --both it integrates the named rows once in each kind
of coordinates, one after the other, and prints the ratio.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import defaultdict
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import CR3BP
from orbitproof.shared.systems.regularised import KUSTAANHEIMO_STIEFEL
from orbitproof.verify.attempt import first_precision
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import PHYSICAL, REGULARISED, IntegratorSettings, enclose_iterates

_STEP = 2e-3
_MOST_STEPS = 40_000


def closest_approach(x: float, z: float, vy: float, mu: float) -> float:
    """Smallest distance to the smaller primary on the half return of a point of Fix(R), float64."""
    state = [x, 0.0, z, 0.0, vy, 0.0]
    assert CR3BP.first_integral is not None
    level = CR3BP.first_integral(state, (mu,))
    branch = KUSTAANHEIMO_STIEFEL.branch(state, (mu,))
    v = np.array(KUSTAANHEIMO_STIEFEL.embedding(state, (mu,), branch), dtype=float)
    section = KUSTAANHEIMO_STIEFEL.section_index

    def field(at: Any) -> Any:
        return np.array(KUSTAANHEIMO_STIEFEL.vector_field(at, (mu,), level))

    closest, before = float(v[:4] @ v[:4]), 0.0
    for _ in range(_MOST_STEPS):
        k1 = field(v)
        k2 = field(v + _STEP / 2 * k1)
        k3 = field(v + _STEP / 2 * k2)
        v = v + _STEP / 6 * (k1 + 2 * k2 + 2 * k3 + field(v + _STEP * k3))
        closest = min(closest, float(v[:4] @ v[:4]))
        if before and before * v[section] < 0:
            break
        before = float(v[section])
    return closest


def print_growth(certificates: list[dict[str, Any]]) -> None:
    """One line a row, then medians by k and by distance."""
    by_k: dict[int, list[float]] = defaultdict(list)
    by_distance: dict[str, list[float]] = defaultdict(list)
    whole = 0.0
    for row in certificates:
        claim, work = row["statement"]["candidate"], row["computation"]
        whole += work["seconds"]
        line = f"{row['id']:34s} k = {claim['k']}  {row['verdict']:10s} {work['seconds']:7.1f} s  "
        line += f"{work['precision']:4d} bits {work['steps']:4d} steps {work['attempts']} attempts"
        if claim["system"] == CR3BP.name:
            x, z, vy = (float(parse_exact(value)) for value in claim["centre"])
            distance = closest_approach(x, z, vy, float(parse_exact(claim["parameters"]["mu"])))
            line += f"  r_2 >= {distance:.1e}  {work.get('coordinates', '')}"
            by_distance[f"1e{int(np.floor(np.log10(distance))):+d}"].append(work["seconds"] / claim["k"])
        by_k[claim["k"]].append(work["seconds"])
        print(line)
    print(f"{len(certificates)} rows, {whole:.0f} s in all")
    for k, values in sorted(by_k.items()):
        print(f"k = {k}: median {median(values):.1f} s, largest {max(values):.1f} s ({len(values)} rows)")
    for decade, values in sorted(by_distance.items()):
        print(f"r_2 from {decade}: median {median(values):.2f} s a half return ({len(values)} rows)")


def print_ratio(candidate: Candidate) -> None:
    """Seconds in both kinds of coordinates at the precision of the first attempt."""
    seconds = {}
    for coordinates in (PHYSICAL, REGULARISED):
        start = time.process_time()
        settings = IntegratorSettings(first_precision(candidate, 30), coordinates=coordinates)
        found = enclose_iterates(candidate, settings, ORACLE)
        seconds[coordinates] = time.process_time() - start
        third = found.iterates[-1][0].box[0, 3, 0].rad()
        print(
            f"{candidate.id}: {found.coordinates}, {found.steps} steps, {seconds[coordinates]:.2f} s, "
            f"third derivative +- {float(third):.1e}"
        )
    print(f"{candidate.id}: physical / regularised = {seconds[PHYSICAL] / seconds[REGULARISED]:.2f}")


def main() -> None:
    """Print what the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("certificates", type=Path)
    parser.add_argument("--candidates", type=Path)
    parser.add_argument("--both", nargs="+", default=[])
    options = parser.parse_args()
    if options.both:
        for candidate in read_candidates(options.candidates):
            if candidate.id in options.both:
                print_ratio(candidate)
        return
    print_growth(json.loads(options.certificates.read_text("utf-8"))["certificates"])


if __name__ == "__main__":
    main()
