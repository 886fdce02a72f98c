"""The flow: approximation, defect, existence and propagation of errors, step by step (sections 3 and 4)."""

from orbitproof.verify.flow.centre import dyadic_below, float_coefficients, rough, step_size
from orbitproof.verify.flow.gronwall import LEAST_ERROR
from orbitproof.verify.flow.solution import Expansion
from orbitproof.verify.flow.step import FlowStep, advance
from orbitproof.verify.flow.wide_solution import expand, taylor_at_points

__all__ = [
    "LEAST_ERROR",
    "Expansion",
    "FlowStep",
    "advance",
    "dyadic_below",
    "expand",
    "float_coefficients",
    "rough",
    "step_size",
    "taylor_at_points",
]
