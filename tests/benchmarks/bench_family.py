"""Seconds for tracing families and finding their resonances in float64, and for the command line as a whole.

python tests/benchmarks/bench_family.py
"""

from __future__ import annotations

import importlib
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))


def timed(label: str, work: Callable[[], Any]) -> Any:
    """Run `work` and print its wall and processor seconds."""
    wall, processor = time.perf_counter(), time.process_time()
    result = work()
    print(f"{label:<52} {time.perf_counter() - wall:8.3f} s wall {time.process_time() - processor:8.3f} s processor")
    return result


def command_line(label: str, folder: Path) -> None:
    """Trace 500 orbits with the command line, in a process of its own; compiled code is kept in `folder`."""
    arguments = ["family", "--system", "cr3bp", "--mass", "earth-moon", "--family", "L1-lyapunov"]
    arguments += ["--max-orbits", "500", "--jobs", "1", "--quiet", "-o", str(folder / "family.json")]
    before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    environment = os.environ | {"ORBITPROOF_CACHE": str(folder)}
    subprocess.run([sys.executable, "-m", "orbitproof.explore", *arguments], cwd=ROOT, env=environment, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{label:<52} {time.perf_counter() - wall:8.3f} s wall {processor:8.3f} s processor")


def main() -> None:
    """Print the timings, one a line."""
    with tempfile.TemporaryDirectory() as folder:
        command_line("command line, 500 planar orbits, first run", Path(folder))
        command_line("  the same, compiled code at hand", Path(folder))

    named = "orbitproof.explore.three_body.families.named"
    trace_family = timed("import JAX and diffrax", lambda: importlib.import_module(named)).trace_family
    families = importlib.import_module("orbitproof.explore.families")
    detection = importlib.import_module("orbitproof.explore.families.detection")
    flow_of = importlib.import_module("orbitproof.explore.flow").flow_of
    from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS

    mass = MASS_PARAMETERS["earth-moon"]
    flow = flow_of(CR3BP)
    state = [0.8426, 0.0, 0.1639, 0.0, 0.2635, 0.0]
    timed("first half return (tracing, compiling or its cache)", lambda: flow.derivative(state, 1.3346, [float(mass)]))
    timed("first samples of an orbit", lambda: flow.samples(state, 1.3346, [float(mass)]))
    count = 100
    repeat = timed(
        f"{count} half returns with state transition matrix",
        lambda: [flow.derivative(state, 1.3346, [float(mass)]) for _ in range(count)],
    )
    assert len(repeat) == count
    for bound in (0.2, 0.3):
        limits = families.Limits(coordinate_max={"z": bound})
        parameters = {"mu": mass}
        family = timed(
            f"Earth-Moon L1 halo family from its birth to z = {bound}",
            lambda limits=limits, parameters=parameters: trace_family(CR3BP, "L1-halo", parameters, limits),
        )
        found = timed(
            f"  its resonances k = 1, 2, 3, 4 ({len(family.orbits)} orbits)",
            lambda family=family: detection.detect(family, [1, 2, 3, 4]),
        )
        print(f"  found: {', '.join(f'k = {resonance.k}' for resonance in found.resonances)}")
    for label, name, speed in (
        ("earth-moon", "L1-halo", None),
        ("sun-jupiter", "L1-halo", None),
        ("earth-moon", "L2-halo", 20.5),
        ("sun-jupiter", "L2-halo", 8.0),
    ):
        parameters = {"mu": MASS_PARAMETERS[label]}
        limits = families.Limits(coordinate_max={} if speed is None else {"vy": speed})
        family = timed(
            f"{label} {name} as far as the paper's tables go",
            lambda name=name, parameters=parameters, limits=limits: trace_family(CR3BP, name, parameters, limits),
        )
        found = timed(
            f"  its resonances k = 1, 2, 3, 4 ({len(family.orbits)} orbits)",
            lambda family=family: detection.detect(family, [1, 2, 3, 4]),
        )
        print(f"  found: {len(found.resonances)} resonances, {len(found.samples)} samples")
    odd = timed(
        "Falkner-Skan family, beta 100 to 1000, with compiling",
        lambda: trace_family(FALKNER_SKAN, "odd", {}, families.Limits()),
    )
    found = timed(
        f"  its resonances k = 2, 3, 4 ({len(odd.orbits)} orbits)",
        lambda: detection.detect(odd, [2, 3, 4]),
    )
    print(f"  found: {', '.join(f'k = {resonance.k}' for resonance in found.resonances)}")


if __name__ == "__main__":
    main()
