"""Seconds for one half-return with derivatives to order 3 at 50 digits, and where the time goes.

python tests/benchmarks/bench_half_return.py
"""

from __future__ import annotations

import cProfile
import pstats
import sys
import time
from collections import defaultdict
from fractions import Fraction
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from orbitproof.shared.claims import Candidate
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings, enclose_iterates

PRECISION = 260


def identity(size: int) -> tuple[tuple[Fraction, ...], ...]:
    """The identity matrix."""
    return tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size))


def orbit() -> Candidate:
    """A box around a halo orbit of the Earth-Moon L1 family, as wide as a bifurcation to 50 digits needs."""
    return Candidate(
        id="half return",
        system=CR3BP,
        parameters={"mu": MASS_PARAMETERS["earth-moon"]},
        kind="period_tupling",
        k=1,
        centre=(Fraction("0.843193964637"), Fraction("0.165"), Fraction("0.263718532564")),
        frame=identity(3),
        kernel_frame=identity(2),
        radii=(Fraction("1e-48"), Fraction("1e-24"), Fraction("1e-48")),
    )


def main() -> None:
    """Time three runs, then profile one."""
    settings = IntegratorSettings(PRECISION)
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        found = enclose_iterates(orbit(), settings, ORACLE)
        seconds.append(time.perf_counter() - start)
    table = found.iterates[0][0]
    print(f"half-return, {PRECISION} bits, order {found.order}, {found.steps} steps: best of 3 {min(seconds):.2f} s")
    for alpha in ((0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 3, 0)):
        print(f"  derivative {alpha}: {table.box[alpha].str(12)}")
    profile = cProfile.Profile()
    profile.runcall(enclose_iterates, orbit(), settings, ORACLE)
    spent: dict[str, float] = defaultdict(float)
    root = Path(__file__).resolve().parents[2]
    # Built-in functions and FLINT's types have no file of their own; they count for the module that calls them.
    for (file, _, _), (_, _, own, _, callers) in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        if Path(file).is_relative_to(root):
            spent[Path(file).relative_to(root).as_posix()] += own
        else:
            for (caller, _, _), (_, _, share, _) in callers.items():
                inside = Path(caller).is_relative_to(root)
                spent[Path(caller).relative_to(root).as_posix() if inside else "libraries"] += share
    whole = sum(spent.values())
    print(f"where the time goes (profiled, {whole:.2f} s):")
    for module, share in sorted(spent.items(), key=lambda item: -item[1])[:8]:
        print(f"  {module:28s} {share:6.2f} s {100 * share / whole:4.0f} %")


if __name__ == "__main__":
    main()
