"""The flow: defect of an approximation, existence and propagation of errors, step by step (sections 3 and 4)."""

from orbitproof.verify.flow.expansion import Expansion, dyadic_below, planned_step, rough
from orbitproof.verify.flow.field_along import FieldAlong
from orbitproof.verify.flow.gronwall import LEAST_ERROR, comparison_matrices, derivative_bounds, exponential_bound
from orbitproof.verify.flow.step import FlowStep, advance
