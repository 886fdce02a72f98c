"""Orbits with their state transition matrix per second: one by one, in batches, on a GPU, and by heyoka.

All integrate the same halo orbits over the half period, with the same tolerance, in the same run; times are processor
seconds (wall seconds for a GPU), the best of a few. heyoka is used where it is installed (pip install heyoka).

python tests/benchmarks/bench_batch.py [number of orbits, at least 200]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from orbitproof.explore.flow import batches_on, flow_batch, flow_of
from orbitproof.explore.flow.runge_kutta import RELATIVE_TOLERANCE
from orbitproof.explore.orbits import correct_batch
from orbitproof.shared.arguments import ArgumentError
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

REPEATS = 3
SINGLES = 200


def orbits(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Unknowns (count, 4) and mass parameters of L1 halo orbits around the Earth-Moon ones."""
    mass = float(MASS_PARAMETERS["earth-moon"])
    guesses = np.repeat([[0.846, 0.17, 0.2641, 1.308]], count, axis=0)
    guesses[:, 1] += np.linspace(-0.006, 0.004, count)
    normals = np.repeat([[0.0, 1.0, 0.0, 0.0]], count, axis=0)
    found = correct_batch(CR3BP, {"mu": mass}, guesses, normals=normals)
    assert found.converged.all()
    return found.unknowns, np.full(count, mass)


def best(work: Callable[[], Any], clock: Callable[[], float] = time.process_time) -> tuple[float, Any]:
    """Least seconds of a few runs, and the result; the first run, which may compile, does not count."""
    result, seconds = work(), []
    for _ in range(REPEATS):
        start = clock()
        result = work()
        seconds.append(clock() - start)
    return min(seconds), result


def heyoka_integrators(
    states: np.ndarray, times: np.ndarray, masses: np.ndarray
) -> tuple[dict[str, Callable[[], np.ndarray]], np.ndarray]:
    """The work for heyoka's scalar and batch integrators, by label, and the first `SINGLES` orbits' exact ends.

    Raises `ImportError` where heyoka is not installed.
    """
    import heyoka

    variables = heyoka.make_vars(*CR3BP.state)
    field = CR3BP.vector_field(variables, [heyoka.par[0]])
    plain = list(zip(variables, field, strict=True))
    system = heyoka.var_ode_sys(plain, heyoka.var_args.vars, order=1)
    width, m = heyoka.recommended_simd_size(), states.shape[1]
    scalar = heyoka.taylor_adaptive(system, state=states[0], pars=masses[:1], tol=RELATIVE_TOLERANCE)
    lanes = np.repeat(states[0][:, None], width, axis=1)
    batch = heyoka.taylor_adaptive_batch(
        system, state=lanes, pars=np.repeat(masses[:1, None], width, axis=1), tol=RELATIVE_TOLERANCE
    )
    identity, identities = scalar.state[m:].copy(), batch.state[m:].copy()

    def one_by_one() -> np.ndarray:
        ends = []
        for i in range(SINGLES):
            scalar.time = 0.0
            scalar.state[:m], scalar.state[m:], scalar.pars[0] = states[i], identity, masses[i]
            scalar.propagate_until(times[i])
            ends.append(scalar.state.copy())
        return np.array(ends)[:, :m]

    def batches() -> np.ndarray:
        ends = []
        for start in range(0, len(times) // width * width, width):
            part = slice(start, start + width)
            batch.set_time(0.0)
            batch.state[:m], batch.state[m:], batch.pars[0] = states[part].T, identities, masses[part]
            batch.propagate_until(times[part])
            ends.append(batch.state.copy())
        return np.concatenate(ends, axis=1)[:m].T

    exact = heyoka.taylor_adaptive(plain, state=states[0], pars=masses[:1], tol=1e-18, high_accuracy=True)
    reference = []
    for i in range(SINGLES):
        exact.time = 0.0
        exact.state[:], exact.pars[0] = states[i], masses[i]
        exact.propagate_until(times[i])
        reference.append(exact.state.copy())
    name = f"heyoka {heyoka.__version__}"
    return {f"{name}, one by one": one_by_one, f"{name}, {width} at once": batches}, np.array(reference)


def main(count: int) -> None:
    """Print the rates, one a line."""
    import jax

    with suppress(ArgumentError):
        batches_on("gpu")
    processor = jax.local_devices(backend="cpu")[0]
    rates: dict[str, float] = {}
    ends: dict[str, np.ndarray] = {}
    with jax.default_device(processor):
        unknowns, masses = orbits(count)
        states = np.zeros((count, 6))
        states[:, [0, 2, 4]] = unknowns[:, :3]
        times = unknowns[:, 3]
        flow = flow_of(CR3BP)

        def singles() -> np.ndarray:
            return np.array([flow.derivative(states[i], times[i], masses[i : i + 1]).state for i in range(SINGLES)])

        seconds, ends["one by one"] = best(singles)
        rates["one by one"] = SINGLES / seconds
        seconds, result = best(lambda: flow_batch(CR3BP, states, times, masses[:, None]))
        rates["batch"], ends["batch"] = count / seconds, result.states
        assert result.finished.all()
        print(f"{count} halo orbits over the half period, {result.steps.mean():.0f} steps each, on {processor}")
        pushed = unknowns + 1e-5
        seconds, corrected = best(lambda: correct_batch(CR3BP, {"mu": masses}, pushed))
        assert corrected.converged.all()
        turns = 1 + corrected.iterations.mean()
    compared: dict[str, Callable[[], np.ndarray]] = {}
    reference = None
    try:
        compared, reference = heyoka_integrators(states, times, masses)
    except ImportError:
        print("heyoka: not installed (pip install heyoka)")
    for label, work in compared.items():
        spent, ends[label] = best(work)
        rates[label] = len(ends[label]) / spent
    for label, rate in rates.items():
        error = "" if reference is None else f"   largest error {np.max(np.abs(ends[label][:SINGLES] - reference)):.1e}"
        print(f"  {label:28s} {rate:9.0f} orbits/s of processor time{error}")
    print(f"  corrected from 1e-5 away     {count / seconds:9.0f} orbits/s of processor time ({turns:.1f} flows each)")
    accelerators = [device for device in jax.devices() if device.platform != "cpu"]
    if not accelerators:
        print("  no GPU found by JAX")
    for device in accelerators[:1]:
        for lanes in (count, 16 * count):
            many = np.resize(np.arange(count), lanes)
            with jax.default_device(device):
                spent, result = best(
                    lambda many=many: flow_batch(CR3BP, states[many], times[many], masses[many, None]),
                    time.perf_counter,
                )
            assert result.finished.all()
            print(f"  {device.device_kind}, {lanes} orbits {lanes / spent:9.0f} orbits/s of wall time")


if __name__ == "__main__":
    main(max(SINGLES, int(sys.argv[1])) if len(sys.argv) > 1 else 2048)
