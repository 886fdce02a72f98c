"""The integration of one orbit by diffrax: Dormand-Prince 8 with steps chosen by its error, or an implicit method."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import diffrax
import jax
import jax.numpy as jnp
import optimistix

from orbitproof.explore.flow.runge_kutta import (
    ABSOLUTE_TOLERANCE,
    GROW,
    MAX_STEPS,
    RELATIVE_TOLERANCE,
    SAFETY,
    SHRINK,
)

_STIFF = {"rtol": 1e-8, "atol": 1e-10}
"""Tolerances of the implicit method."""


def integrate(
    field: Callable[[Any, Any, Any], Any],
    start: jax.Array,
    time: Any,
    arguments: Any = None,
    *,
    save: diffrax.SubSaveAt | None = None,
    implicit: bool = False,
    most: int = MAX_STEPS,
) -> tuple[jax.Array, diffrax.Solution, jax.Array]:
    """The state after a time of any sign, the solution, and whether the end was reached. To be called while JAX traces.

    Arguments:
        field: of the time, the state and `arguments`.
        save: what to keep on the way, `solution.ys[1]`.
        implicit: Kvaerno 5, to fewer digits, for stiff fields, through whose fast decay the other one crawls.
        most: number of steps.
    """
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(field),
        diffrax.Kvaerno5(root_finder=optimistix.Newton(**_STIFF)) if implicit else diffrax.Dopri8(scan_kind="lax"),
        t0=0.0,
        t1=time,
        # diffrax chooses the first step. It would check ours in a callback, and JAX keeps no code with callbacks.
        dt0=None,
        y0=start,
        args=arguments,
        saveat=diffrax.SaveAt(subs=[diffrax.SubSaveAt(t1=True), *([] if save is None else [save])]),
        stepsize_controller=diffrax.PIDController(
            **(_STIFF if implicit else {"rtol": RELATIVE_TOLERANCE, "atol": ABSOLUTE_TOLERANCE}),
            norm=lambda errors: jnp.sqrt(jnp.mean(jnp.square(errors))),
            safety=SAFETY,
            factormin=SHRINK,
            factormax=GROW,
        ),
        # Derivatives are carried along; nothing is differentiated backwards through the loop.
        adjoint=diffrax.ForwardMode(),
        max_steps=most,
        throw=False,
    )
    end = solution.ys[0][0]
    # An integration to a time that is no number ends at once, successfully.
    reached = (solution.result == diffrax.RESULTS.successful) & jnp.isfinite(time) & jnp.all(jnp.isfinite(end))
    return end, solution, reached
