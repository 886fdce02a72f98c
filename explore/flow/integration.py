"""The integration of one orbit by diffrax: Dormand-Prince 8 with steps chosen by its error, or an implicit method."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import diffrax
import jax
import jax.numpy as jnp

from orbitproof.explore.flow.runge_kutta import (
    ABSOLUTE_TOLERANCE,
    GROW,
    MAX_STEPS,
    RELATIVE_TOLERANCE,
    SAFETY,
    SHRINK,
    scales,
    weighted,
)

_STIFF = {"rtol": 1e-8, "atol": 1e-10}
"""Tolerances of the implicit method."""


class _Extended(diffrax.PIDController):  # type: ignore[misc]
    """Errors of an orbit with its derivatives relative to what `scales` says."""

    def adapt_step_size(
        self,
        t0: Any,
        t1: Any,
        y0: jax.Array,
        y1_candidate: jax.Array,
        args: Any,
        y_error: jax.Array,
        error_order: Any,
        controller_state: Any,
    ) -> Any:
        """The next step, as in diffrax."""
        return super().adapt_step_size(
            t0, t1, scales(y0), scales(y1_candidate), args, y_error, error_order, controller_state
        )


def integrate(
    field: Callable[[Any, Any, Any], Any],
    start: jax.Array,
    time: Any,
    arguments: Any = None,
    *,
    extended: bool = False,
    save: diffrax.SubSaveAt | None = None,
    implicit: bool = False,
    most: int = MAX_STEPS,
) -> tuple[jax.Array, diffrax.Solution, jax.Array]:
    """The state after a time of any sign, the solution, and whether the end was reached. To be called while JAX traces.

    Arguments:
        field: of the time, the state and `arguments`.
        extended: whether the state is an orbit with its derivatives, and errors are measured accordingly.
        save: what to keep on the way, `solution.ys[1]`.
        implicit: Kvaerno 5, to fewer digits, for stiff fields, through whose fast decay the other one crawls.
        most: number of steps.
    """
    controller = _Extended if extended else diffrax.PIDController
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(field),
        diffrax.Kvaerno5(root_finder=diffrax.VeryChord(**_STIFF)) if implicit else diffrax.Dopri8(scan_kind="lax"),
        t0=0.0,
        t1=time,
        # diffrax chooses the first step. It would check ours in a callback, and JAX keeps no code with callbacks.
        dt0=None,
        y0=start,
        args=arguments,
        saveat=diffrax.SaveAt(subs=[diffrax.SubSaveAt(t1=True), *([] if save is None else [save])]),
        stepsize_controller=controller(
            **(_STIFF if implicit else {"rtol": RELATIVE_TOLERANCE, "atol": ABSOLUTE_TOLERANCE}),
            norm=weighted if extended else lambda errors: jnp.sqrt(jnp.mean(jnp.square(errors))),
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
