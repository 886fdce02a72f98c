"""Many orbits at once: the same orbits as one by one, with failures marked and neighbours untouched."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from orbitproof.explore.flow import (
    FlowFailure,
    Matrix,
    batches_on,
    cache_folder,
    compilation,
    compiling,
    configure_jax,
    flow_batch,
    flow_of,
    power,
)
from orbitproof.explore.flow.batch import BLOCK
from orbitproof.explore.orbits import (
    CorrectionFailure,
    OrbitBatch,
    ShootingProblem,
    correct_batch,
    stability_index,
    stability_parameters,
)
from orbitproof.explore.orbits.batch_algebra import (
    characteristic_coefficients,
    least_norm,
    roots,
    solve,
    stability_indices,
)
from orbitproof.explore.orbits.stability import characteristic_coefficients as coefficients_of_one
from orbitproof.explore.seeds import limit_orbit
from orbitproof.shared import InputError
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS

ROOT = Path(__file__).resolve().parents[2]
EARTH_MOON = MASS_PARAMETERS["earth-moon"]
MU = float(EARTH_MOON)
HALO = np.array([0.846, 0.17, 0.2641, 1.308])
ALONG = np.array([0.0, 1.0, 0.0, 0.0])


@cache
def halo_orbits(count: int = 80) -> OrbitBatch:
    """Earth-Moon L1 halo orbits from one orbit's neighbourhood: more than a block."""
    guesses = np.repeat(HALO[None], count, axis=0)
    guesses[:, 1] += np.linspace(-0.004, 0.004, count)
    return correct_batch(CR3BP, {"mu": MU}, guesses, normals=np.repeat(ALONG[None], count, axis=0))


def states_of(unknowns: Matrix) -> Matrix:
    """Initial states of CR3BP orbits."""
    states = np.zeros((len(unknowns), 6))
    states[:, [0, 2, 4]] = unknowns[:, :3]
    return states


def test_the_flow_of_a_batch_is_the_flow_of_each_orbit() -> None:
    rng = np.random.default_rng(1)
    masses = np.array([MU, 0.3, 1e-4, MU, 0.5])
    states = np.array([0.75, 0.01, 0.1, 0.02, 0.3, -0.03]) + rng.uniform(-0.02, 0.02, (5, 6))
    times = np.array([0.3, 1.4, 0.7, 2.2, 1.0])
    batch = flow_batch(CR3BP, states, times, masses[:, None])
    assert batch.finished.all()
    for i in range(5):
        one = flow_of(CR3BP).derivative(states[i], times[i], [masses[i]])
        size = np.linalg.norm(one.state_transition)
        assert batch.states[i] == pytest.approx(one.state, abs=1e-11 * size)
        assert batch.velocities[i] == pytest.approx(one.velocity, abs=1e-10 * size)
        assert batch.state_transitions[i] == pytest.approx(one.state_transition, abs=1e-8 * size)


def test_a_batch_finds_the_orbits_that_are_found_one_by_one() -> None:
    batch = halo_orbits()
    assert len(batch) > BLOCK
    assert batch.converged.all()
    assert batch.failures == ("",) * len(batch)
    problem = ShootingProblem(CR3BP, {"mu": EARTH_MOON})
    for i in (0, 17, len(batch) - 1):
        guess = np.array([HALO[0], batch.unknowns[i, 1], HALO[2], HALO[3]])
        one, many = problem.orbit(problem.correct(guess, ALONG)), batch.orbit(i)
        assert many.unknowns == pytest.approx(one.unknowns, abs=1e-11)
        assert many.second_point == pytest.approx(one.second_point, abs=1e-10)
        assert many.first_integral == pytest.approx(one.first_integral, abs=1e-12)
        assert many.coefficients == pytest.approx(one.coefficients, rel=1e-8)
        assert many.stability == pytest.approx(one.stability, rel=1e-8)
        assert batch.stability[i] == pytest.approx(one.stability, rel=1e-8)
        assert many.crossings == one.crossings == 1
        assert many.derivative is not None
        assert one.derivative is not None
        assert many.derivative.derivative == pytest.approx(one.derivative.derivative, abs=1e-7)
        assert many.derivative.fixed_dimension == 3
    assert batch.residuals.max() < 1e-11


def test_without_a_hyperplane_the_correction_is_the_shortest() -> None:
    batch = halo_orbits()
    push = 1e-4 * np.array([1.0, -1.0, 2.0, 0.5])
    near = correct_batch(CR3BP, {"mu": MU}, batch.unknowns[10:13] + push)
    assert near.converged.all()
    problem = ShootingProblem(CR3BP, {"mu": EARTH_MOON})
    for i in range(3):
        _, jacobian, _ = problem.evaluate(near.unknowns[i])
        tangent = problem.tangent(jacobian, ALONG)
        moved = near.unknowns[i] - batch.unknowns[10 + i] - push
        assert np.linalg.norm(moved) > 1e-5
        assert abs(tangent @ moved) < 1e-2 * np.linalg.norm(moved)


def test_each_orbit_has_a_mass_parameter_of_its_own() -> None:
    masses = [Fraction("0.0115"), Fraction("0.0125"), EARTH_MOON]
    guesses = np.repeat(HALO[None], 3, axis=0)
    guesses[:2, 0] += [0.0025, -0.0016]
    batch = correct_batch(
        CR3BP, {"mu": [float(mass) for mass in masses]}, guesses, normals=np.repeat(ALONG[None], 3, axis=0)
    )
    assert batch.converged.all(), batch.failures
    for i, mass in enumerate(masses):
        one = ShootingProblem(CR3BP, {"mu": mass}).correct(batch.unknowns[i], ALONG)
        assert batch.unknowns[i] == pytest.approx(one.unknowns, abs=1e-11)
    assert np.ptp(batch.unknowns[:, 0]) > 1e-4


def test_orbits_that_fail_are_marked_and_leave_the_others_alone() -> None:
    batch = halo_orbits()
    into_the_moon = np.array([1.0 - MU, 0.0, 0.0, 1.0])
    not_a_number = np.array([0.8, np.nan, 0.2, 1.3])
    far_from_any = np.array([0.5, 0.4, -2.0, 0.1])
    mixed = np.array([batch.unknowns[3], into_the_moon, not_a_number, far_from_any, batch.unknowns[5]]) + 1e-6
    found = correct_batch(CR3BP, {"mu": MU}, mixed)
    alone = correct_batch(CR3BP, {"mu": MU}, mixed[[0, 4]])
    assert list(found.converged) == [True, False, False, False, True]
    assert len(found) == len(found.failures) == 5
    assert all(found.failures[i] for i in (1, 2, 3))
    assert "singularity" in found.failures[1]
    assert found.unknowns[[0, 4]] == pytest.approx(alone.unknowns, abs=1e-13)
    assert found.stability[[0, 4]] == pytest.approx(alone.stability, rel=1e-9)
    with pytest.raises(CorrectionFailure, match="singularity"):
        found.orbit(1)
    with pytest.raises(FlowFailure):
        flow_of(CR3BP).derivative(states_of(into_the_moon[None])[0], 1.0, [MU])


def test_orbits_in_the_plane_stay_there_and_keep_their_stability_across_it() -> None:
    from orbitproof.explore.three_body.seeds import libration_point, lyapunov_orbit

    guesses = []
    for amplitude in (1e-3, 2e-3, 4e-3):
        orbit = lyapunov_orbit(libration_point("L1", EARTH_MOON), amplitude, -1)
        guesses.append([*orbit.state[[0, 2, 4]], orbit.half_period])
    batch = correct_batch(CR3BP, {"mu": MU}, np.array(guesses), symmetry="S")
    assert batch.converged.all()
    assert np.all(batch.unknowns[:, 1] == 0)
    problem = ShootingProblem(CR3BP, {"mu": EARTH_MOON}, symmetry="S")
    correction = problem.correct(batch.unknowns[1], np.array([1.0, 0.0, 0.0, 0.0]))
    assert batch.stability[1] == pytest.approx(problem.orbit(correction).stability, rel=1e-7)


@pytest.mark.slow
def test_a_system_with_a_family_parameter_is_corrected_in_it() -> None:
    limit, betas = limit_orbit(), np.array([2e3, 5e3, 1e4])
    guesses = np.column_stack([betas, np.full(3, limit.upper), limit.half_period / np.sqrt(betas)])
    scale = np.array([1000.0, 1.0, 1.0])
    normals = np.repeat([[1.0, 0.0, 0.0]], 3, axis=0)
    batch = correct_batch(FALKNER_SKAN, {}, guesses, scale=scale, normals=normals)
    assert batch.converged.all(), batch.failures
    assert batch.first_integrals is None
    problem = ShootingProblem(FALKNER_SKAN, {}, scale=(1000.0, 1.0, 1.0))
    for i in range(3):
        orbit = problem.orbit(problem.correct(guesses[i], normals[i]))
        assert batch.unknowns[i] == pytest.approx(orbit.unknowns, rel=1e-11)
        assert batch.coefficients[i] == pytest.approx(orbit.coefficients, rel=1e-8)
        assert batch.orbit(i).first_integral is None


def test_results_do_not_depend_on_blocks_and_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    limit, betas = limit_orbit(), np.geomspace(200, 1e4, 10)
    states = np.column_stack([np.zeros(10), np.full(10, limit.upper), np.zeros(10)])
    times = np.linspace(0.5, 6.0, 10) * limit.half_period / np.sqrt(betas)
    whole = flow_batch(FALKNER_SKAN, states, times, betas[:, None])
    assert whole.finished.all()
    assert whole.steps.max() > 2 * whole.steps.min()
    assert whole.crossings.max() > 3
    # As on a GPU: another width; and fewer steps a round than any orbit needs.
    monkeypatch.setattr("orbitproof.explore.flow.batch.BLOCK", 3)
    monkeypatch.setattr("orbitproof.explore.flow.batch.ROUND", 4)
    monkeypatch.setattr("orbitproof.explore.flow.batch._COMPILED", {})
    done: list[int] = []
    parts = flow_batch(FALKNER_SKAN, states, times, betas[:, None], done.append)
    assert done == sorted(done)
    assert done[-1] == 10
    assert len(done) > 3
    assert parts.finished.all()
    assert np.array_equal(parts.crossings, whole.crossings)
    for name in ("states", "velocities", "state_transitions", "parameter_derivatives"):
        size = np.abs(getattr(whole, name)).max()
        assert getattr(parts, name) == pytest.approx(getattr(whole, name), abs=1e-10 * size)
    for i in (0, 9):
        one = flow_of(FALKNER_SKAN).derivative(states[i], times[i], [betas[i]])
        size = np.abs(one.state_transition).max()
        assert parts.states[i] == pytest.approx(one.state, abs=1e-10 * size)
        assert parts.parameter_derivatives[i] == pytest.approx(one.parameter_derivative, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize(
    ("platforms", "why"),
    [("cpu", "JAX_PLATFORMS=cpu keeps JAX from it; unset it"), ("", "ask for the GPU first in a new process")],
)
def test_what_keeps_batches_from_a_gpu_is_told(platforms: str, why: str, monkeypatch: pytest.MonkeyPatch) -> None:
    configure_jax()
    monkeypatch.setenv("JAX_PLATFORMS", platforms)
    with pytest.raises(InputError, match=f"^device gpu: .*{why}$"):
        batches_on("gpu")
    with batches_on("cpu") as called:
        assert called == "the processor"


def test_a_round_can_be_compiled_for_a_gpu_in_double_precision() -> None:
    import jax
    from jax import export

    from orbitproof.explore.flow.batch import GPU_BLOCKS, _integrator, _start

    configure_jax()
    width = GPU_BLOCKS[0]
    states, masses, times = np.ones((width, 6)), np.ones((width, 1)), np.ones(width)
    lanes = _start(CR3BP, states, masses)
    made = export.export(jax.jit(_integrator(CR3BP)), platforms=["cuda"])(times, masses.T, *lanes.arrays())
    text = made.mlir_module()
    assert "f64" in text
    for only_here in ("f32", "custom_call"):
        assert only_here not in text


TWO_DEVICES = """
import jax, numpy as np
from orbitproof import explore
from orbitproof.explore.flow import batch, configure_jax
configure_jax()
processor, other = jax.local_devices(backend="cpu")
jax.local_devices = lambda backend: [other if backend == "gpu" else processor]
integrator = batch._compiled
def watched(system):
    def advance(*arguments):
        result = integrator(system)(*arguments)
        assert result[0].devices() == {expected}
        return result
    return advance
batch._compiled = watched
made = []
for name, expected in (("gpu", other), ("cpu", processor)):
    made.append(
        explore.catalogue("L2-halo", "jpl-earth-moon", rows=30, max_orbits=12, device=name, hits=True, quiet=True)
    )
assert np.array_equal(made[0].columns, made[1].columns) and len(made[0]) == 30
"""


@pytest.mark.slow
def test_rows_are_corrected_on_the_device_that_was_asked_for() -> None:
    # The second of two devices stands for a GPU.
    environment = os.environ | {"JAX_PLATFORMS": "cpu", "XLA_FLAGS": "--xla_force_host_platform_device_count=2"}
    done = subprocess.run([sys.executable, "-c", TWO_DEVICES], env=environment, capture_output=True, timeout=300)
    assert done.returncode == 0, done.stderr.decode()


def test_parameters_that_are_missing_or_unknown_are_refused() -> None:
    for parameters in ({}, {"mu": MU, "beta": 1.0}):
        with pytest.raises(ValueError, match="fixed parameters of cr3bp are mu"):
            correct_batch(CR3BP, parameters, np.zeros((3, 4)))


def test_unknowns_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(ValueError, match="needs"):
        correct_batch(CR3BP, {"mu": MU}, np.zeros((3, 3)))


def test_an_empty_batch_is_a_result() -> None:
    batch = correct_batch(CR3BP, {"mu": MU}, np.zeros((0, 4)))
    assert len(batch) == 0
    assert batch.stability.shape == (0, 2)


def test_algebra_of_stacks_is_that_of_single_matrices() -> None:
    rng = np.random.default_rng(2)
    matrices, right = rng.normal(size=(6, 3, 3)), rng.normal(size=(6, 3))
    singular = matrices.copy()
    singular[2] = 0.0
    solutions = solve(singular, right)
    assert np.isnan(solutions[2]).all()
    assert solutions[3] == pytest.approx(np.linalg.solve(matrices[3], right[3]))
    wide = rng.normal(size=(6, 2, 3))
    assert least_norm(wide, right[:, :2])[4] == pytest.approx(np.linalg.pinv(wide[4]) @ right[4, :2])
    coefficients = characteristic_coefficients(matrices)
    for i in range(6):
        assert coefficients[i] == pytest.approx(coefficients_of_one(matrices[i]), abs=1e-12)
        single = stability_index(stability_parameters(coefficients[i]))
        assert stability_indices(roots(coefficients))[i] == pytest.approx(single, rel=1e-10)
        assert roots(coefficients)[i] == pytest.approx(stability_parameters(coefficients[i]), abs=1e-10)


@pytest.mark.parametrize("exponent", ["-3/2", "-1/2", "1/2", "5/2", "-1", "2", "1/3"])
def test_powers_and_their_derivatives_are_those_of_arithmetic(exponent: str) -> None:
    import jax
    import jax.numpy as jnp

    configure_jax()
    value = Fraction(exponent)
    base = jnp.array([0.3, 1.0, 7.5])
    result, slope = jax.jvp(lambda x: power(x, value), (base,), (jnp.ones(3),))
    numbers = np.array([0.3, 1.0, 7.5])
    assert np.asarray(result) == pytest.approx(numbers ** float(value), rel=4e-16)
    assert np.asarray(slope) == pytest.approx(float(value) * numbers ** (float(value) - 1), rel=1e-15)


def test_the_folder_of_compiled_code_can_be_moved_and_switched_off(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("ORBITPROOF_CACHE", raising=False)
    folder = cache_folder()
    assert folder is not None
    assert folder.parent == tmp_path / "orbitproof" / "jax"
    monkeypatch.setenv("ORBITPROOF_CACHE", str(tmp_path / "elsewhere"))
    moved = cache_folder()
    assert moved is not None
    assert moved == tmp_path / "elsewhere" / folder.name
    monkeypatch.setenv("ORBITPROOF_CACHE", "off")
    assert cache_folder() is None


def test_a_folder_of_compiled_code_that_others_can_write_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    base = tmp_path / "base"
    folder = base / "code"
    base.mkdir(mode=0o700)
    folder.mkdir(mode=0o700)
    assert compilation._only_ours(folder)
    for place, mode in ((folder, 0o770), (folder, 0o707), (base, 0o777)):
        before = place.stat().st_mode
        place.chmod(mode)
        assert not compilation._only_ours(folder)
        place.chmod(before)
    # As in /tmp: others can add to it, and replace nothing.
    base.chmod(0o1777)
    assert compilation._only_ours(folder)
    base.chmod(0o700)
    somebody = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: somebody)
    assert not compilation._only_ours(folder)


@pytest.mark.slow
def test_compiled_code_of_a_folder_that_others_can_write_is_not_used(tmp_path: Path) -> None:
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("JAX_COMP", "XDG_"))}
    environment |= {"ORBITPROOF_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu"}
    script = """
from orbitproof.explore.flow.compilation import configure_jax
import jax
configure_jax()
print(jax.config.jax_compilation_cache_dir)
"""

    def used() -> tuple[str, str]:
        command = [sys.executable, "-c", script]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=True)
        return done.stdout.strip(), done.stderr

    folder, errors = used()
    assert Path(folder).parent == tmp_path / "cache"
    assert errors == ""
    Path(folder).chmod(0o777)
    folder, errors = used()
    assert folder == "None"
    assert "others can write it" in errors


def test_trouble_with_the_cache_is_silent_and_other_warnings_are_not(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("ORBITPROOF_CACHE", str(tmp_path))
    folder = cache_folder()
    assert folder is not None
    folder.mkdir()
    broken, sound = folder / "jit_half-0123-cache", folder / "jit_whole-4567-cache"
    broken.write_bytes(b"x")
    sound.write_bytes(b"y")
    with compiling():
        warnings.warn("Error reading persistent compilation cache entry for 'jit_half': E: cut short", stacklevel=1)
        warnings.warn("Error writing persistent compilation cache entry for 'jit_whole': disk full", stacklevel=1)
    assert not broken.exists()
    assert sound.exists()
    with pytest.warns(UserWarning, match="something else"), compiling():
        warnings.warn("something else", stacklevel=1)


@pytest.mark.slow
def test_compiled_orbits_are_kept_for_the_next_process(tmp_path: Path) -> None:
    script = """
from orbitproof.explore.flow import flow_of
from orbitproof.explore.periodic.flow import arc_of
from orbitproof.shared import define_system
from orbitproof.shared.systems import FALKNER_SKAN
flow_of(FALKNER_SKAN).derivative([0.0, 0.94, 0.0], 0.2, [340.0])
arc_of(define_system({"name": "turn", "state": "x y", "field": {"x": "-y", "y": "x"}}), [1.0, 0.0], 1.0, [])
"""
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("JAX_COMP", "XDG_"))}
    environment |= {"ORBITPROOF_CACHE": str(tmp_path), "JAX_PLATFORMS": "cpu"}
    subprocess.run([sys.executable, "-c", script], env=environment, check=True, timeout=300)
    kept = "".join(path.name for path in tmp_path.glob("*/*-cache"))
    assert "half_return" in kept
    assert "jit_run-" in kept


CACHED_RUN = """
import sys, numpy as np
from orbitproof.explore.flow.compilation import compiled, configure_jax
configure_jax()
import jax, jax.numpy as jnp
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
print([float(v).hex() for v in compiled(lambda x: jnp.exp(jnp.sin(x)) / 3)(np.linspace(0.1, 2.0, 5))])
"""


@pytest.mark.slow
def test_results_do_not_depend_on_the_cache_and_a_broken_one_heals(tmp_path: Path) -> None:
    blocked = tmp_path / "a file"
    blocked.write_text("in the way of the folder")
    kept = tmp_path / "kept"

    def run(cache: Path | str) -> str:
        environment = {k: v for k, v in os.environ.items() if not k.startswith(("JAX_COMP", "XDG_"))}
        environment |= {"ORBITPROOF_CACHE": str(cache), "PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu"}
        result = subprocess.run(
            [sys.executable, "-W", "error", "-c", CACHED_RUN],
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert result.returncode == 0, result.stderr
        assert result.stderr == ""
        return result.stdout

    plain = run(blocked)
    assert run(kept) == plain
    (entry,) = [path for path in kept.glob("*/*-cache") if "lambda" in path.name]
    whole = entry.read_bytes()
    entry.write_bytes(whole[: len(whole) // 2])
    assert run(kept) == plain
    assert run(kept) == plain
    assert len(entry.read_bytes()) > len(whole) // 2
