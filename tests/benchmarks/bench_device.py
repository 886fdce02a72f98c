"""One batch of halo orbits corrected on a GPU, on the processor and one at a time: seconds, and how far they differ.

The orbits are those of the Earth-Moon L2 halo family above the Moon's surface, at equal arclengths; each is corrected
from what the traced family predicts there, with its stability index. Seconds are of wall time, the best of a few; the
first call, which compiles, is told apart. Without a GPU its line is left out.

python tests/benchmarks/bench_device.py [number of orbits]
"""

from __future__ import annotations

import os
import sys
import time
from typing import NamedTuple

import numpy as np

from orbitproof.explore.families import Family, Limits
from orbitproof.explore.flow import batches_on
from orbitproof.explore.orbits import correct_batch, stability_index
from orbitproof.explore.three_body.catalogues.dense import _predicted
from orbitproof.explore.three_body.families import trace_family
from orbitproof.shared import InputError
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

REPEATS = 3
SINGLES = 500
SURFACE = 0.0045


class Numbers(NamedTuple):
    """Of N orbits: unknowns (N, 4), Jacobi constants and stability indices (N,)."""

    unknowns: np.ndarray
    levels: np.ndarray
    indices: np.ndarray


def together(family: Family, guesses: np.ndarray, normals: np.ndarray) -> Numbers:
    """The orbits, corrected as one batch; NaN for what did not converge."""
    problem = family.problem
    mass = {name: float(value) for name, value in problem.parameters.items()}
    batch = correct_batch(CR3BP, mass, guesses, scale=problem.scales, normals=normals)
    for reason in set(filter(None, batch.failures)):
        print(f"  {batch.failures.count(reason)} of {len(batch)}: {reason}")
    batch.unknowns[~batch.converged] = np.nan
    assert batch.first_integrals is not None
    return Numbers(batch.unknowns, batch.first_integrals, batch.stability_indices)


def one_at_a_time(family: Family, guesses: np.ndarray, normals: np.ndarray) -> Numbers:
    """The same by Newton's method and an integration for each."""
    problem = family.problem
    orbits = [problem.orbit(problem.correct(guess, normal)) for guess, normal in zip(guesses, normals, strict=True)]
    indices = [stability_index(orbit.stability) for orbit in orbits]
    levels = [orbit.first_integral for orbit in orbits]
    return Numbers(np.array([orbit.unknowns for orbit in orbits]), np.array(levels), np.array(indices))


def told(label: str, numbers: Numbers, reference: Numbers) -> None:
    """Print the largest differences."""
    pairs = zip(numbers, reference, (1.0, 1.0, reference.indices), strict=True)
    points, levels, indices = (np.nanmax(np.abs(one - other) / size) for one, other, size in pairs)
    print(f"  {label}: point, half period {points:.1e}, Jacobi constant {levels:.1e}, stability index {indices:.1e}")


def main(rows: int) -> None:
    """Print seconds and differences."""
    found: dict[str, Numbers] = {}
    try:
        devices = {name: batches_on(name) for name in ("gpu", "cpu")}
    except InputError as error:
        print(error)
        devices = {"cpu": batches_on("cpu")}
    mass = MASS_PARAMETERS["jpl-earth-moon"]
    family = trace_family(CR3BP, "L2-halo", {"mu": mass}, Limits(min_distance=SURFACE))
    guesses, normals = _predicted(family, np.linspace(0.0, family.orbits[-1].arclength, rows))
    print(f"{rows} L2 halo orbits; {os.cpu_count()} processor cores")
    for name, context in devices.items():
        with context as called:
            seconds, spent = [], []
            for _ in range(1 + REPEATS):
                start, used = time.perf_counter(), time.process_time()
                found[name] = together(family, guesses, normals)
                seconds.append(time.perf_counter() - start)
                spent.append(time.process_time() - used)
        best, first = min(seconds[1:]), seconds[0]
        print(f"  {called}: {best:.2f} s, of processor time {min(spent[1:]):.2f} s; the first time {first:.1f} s")
    chosen = np.linspace(0, rows - 1, SINGLES).astype(int)
    one_at_a_time(family, guesses[:1], normals[:1])
    start, used = time.perf_counter(), time.process_time()
    singles = one_at_a_time(family, guesses[chosen], normals[chosen])
    alone, spent_alone = (rows / SINGLES * value for value in (time.perf_counter() - start, time.process_time() - used))
    print(f"  one at a time: {alone:.0f} s, of processor time {spent_alone:.0f} s, from {SINGLES} of them")
    if "gpu" in found:
        told("GPU and processor", found["gpu"], found["cpu"])
    told("processor and one at a time", Numbers(*(values[chosen] for values in found["cpu"])), singles)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 50000)
