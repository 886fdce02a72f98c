"""Processor time of the complete certification of rows with k = 1, 2, 3, 4, and where the time goes.

python tests/benchmarks/bench_certification.py [candidates.json]
"""

from __future__ import annotations

import cProfile
import pstats
import sys
import time
from collections import defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import read_candidates
from orbitproof.verify.certificate import certify

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "tests" / "data" / "known-bifurcations.json"


def seconds_by_module(candidate: Candidate) -> dict[str, float]:
    """Own time of each module of the verifier; built-ins and FLINT count for the module that calls them."""
    profile = cProfile.Profile()
    profile.runcall(certify, candidate)
    spent: dict[str, float] = defaultdict(float)
    for (file, _, _), (_, _, own, _, callers) in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        if Path(file).resolve().is_relative_to(ROOT / "verify"):
            spent[Path(file).stem] += own
        else:
            for (caller, _, _), (_, _, part, _) in callers.items():
                if Path(caller).resolve().is_relative_to(ROOT / "verify"):
                    spent[Path(caller).stem] += part
    return spent


def main(path: Path) -> None:
    """Certify each row of a candidates file; profile the last row with k = 2."""
    candidates = read_candidates(path)
    for candidate in candidates:
        start = time.process_time()
        certificate = certify(candidate)
        work = certificate.computation
        print(
            f"{candidate.id}: k = {candidate.k}, {certificate.verdict}, {time.process_time() - start:.2f} s "
            f"({work.precision} bits, order {work.order}, {work.steps} steps, {work.attempts} attempts)",
            flush=True,
        )
    doubled = [candidate for candidate in candidates if candidate.k == 2]
    if doubled:
        spent = seconds_by_module(doubled[-1])
        whole = sum(spent.values())
        print(f"where the time goes, {doubled[-1].id} (profiled, so slower):")
        for module, own in sorted(spent.items(), key=lambda item: -item[1])[:8]:
            print(f"  {module:14s} {own / whole:6.1%}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else STORED)
