"""The integration of one orbit by diffrax: Dormand-Prince 8 with steps chosen by its error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import diffrax
import jax
import jax.numpy as jnp

from orbitproof.explore.flow.runge_kutta import ABSOLUTE_TOLERANCE, GROW, MAX_STEPS, RELATIVE_TOLERANCE, SAFETY, SHRINK


def integrate(
    field: Callable[[Any, Any, Any], Any],
    start: jax.Array,
    time: Any,
    arguments: Any = None,
    *,
    watched: Callable[[jax.Array], jax.Array] = lambda errors: errors,
    save: diffrax.SubSaveAt | None = None,
) -> tuple[jax.Array, diffrax.Solution, jax.Array]:
    """The state after a time of any sign, the solution, and whether the end was reached. To be called while JAX traces.

    Arguments:
        field: of the time, the state and `arguments`.
        watched: the part of the errors by which the steps are chosen; all by default.
        save: what to keep on the way, `solution.ys[1]`.
    """
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(field),
        diffrax.Dopri8(scan_kind="lax"),
        t0=0.0,
        t1=time,
        # diffrax chooses the first step. It would check ours in a callback, and JAX keeps no code with callbacks.
        dt0=None,
        y0=start,
        args=arguments,
        saveat=diffrax.SaveAt(subs=[diffrax.SubSaveAt(t1=True), *([] if save is None else [save])]),
        stepsize_controller=diffrax.PIDController(
            rtol=RELATIVE_TOLERANCE,
            atol=ABSOLUTE_TOLERANCE,
            norm=lambda errors: jnp.sqrt(jnp.mean(jnp.square(watched(errors)))),
            safety=SAFETY,
            factormin=SHRINK,
            factormax=GROW,
        ),
        # Derivatives are carried along; nothing is differentiated backwards through the loop.
        adjoint=diffrax.ForwardMode(),
        max_steps=MAX_STEPS,
        throw=False,
    )
    end = solution.ys[0][0]
    # An integration to a time that is no number ends at once, successfully.
    reached = (solution.result == diffrax.RESULTS.successful) & jnp.isfinite(time) & jnp.all(jnp.isfinite(end))
    return end, solution, reached
