"""The flow: approximation, defect, existence and propagation of errors, step by step (sections 3 and 4)."""

from orbitproof.verify.flow.centre import (
    dyadic_below,
    fixed_coefficients,
    float_coefficients,
    next_crossing,
    rough,
    step_size,
)
from orbitproof.verify.flow.gronwall import LEAST_ERROR
from orbitproof.verify.flow.step import FlowStep, advance, enclose_step
from orbitproof.verify.flow.wide_solution import element_at_points, solve_wide, taylor_at_points, wide_step_size

__all__ = [
    "LEAST_ERROR",
    "FlowStep",
    "advance",
    "dyadic_below",
    "element_at_points",
    "enclose_step",
    "fixed_coefficients",
    "float_coefficients",
    "next_crossing",
    "rough",
    "solve_wide",
    "step_size",
    "taylor_at_points",
    "wide_step_size",
]
