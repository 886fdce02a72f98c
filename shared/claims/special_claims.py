"""What a claim about one orbit, or about two resonances that meet, has to fulfil besides."""

from __future__ import annotations

from collections.abc import Callable
from typing import NoReturn

from orbitproof.shared.claims.candidate import COORDINATE, HALF_PERIOD, LEVEL, QUANTITIES, Candidate, Equation

Refuse = Callable[[str, str, str], NoReturn]
"""Called with the field, what is wrong and the remedy."""


def check_equation(candidate: Candidate, equation: Equation, refuse: Refuse) -> None:
    """The equation of a claim about one orbit is one of its system, in the coordinates of Fix(R)."""
    system = candidate.system
    if equation.quantity not in QUANTITIES:
        refuse("equation.quantity", f"{equation.quantity!r} is unknown", f"give one of {', '.join(QUANTITIES)}")
    if (equation.quantity == COORDINATE) != (equation.coordinate is not None):
        refuse("equation.coordinate", "belongs to the quantity 'coordinate'", "give both or none")
    if equation.coordinate is not None and equation.coordinate not in system.centre_coordinates:
        known = ", ".join(system.centre_coordinates)
        refuse("equation.coordinate", f"{equation.coordinate!r} is no coordinate of Fix(R)", f"give one of {known}")
    if equation.quantity == LEVEL and (system.first_integral is None or system.fixed_level is not None):
        why = "has no first integral" if system.first_integral is None else "is on a level already"
        refuse("equation.quantity", f"{system.name} {why}", "give another quantity")
    if equation.quantity == HALF_PERIOD and not equation.value > 0:
        refuse("equation.value", "a half period is positive", "give a positive number")
    if candidate.symmetry is not None or candidate.level_sign is not None:
        refuse("equation", "the orbit is given in the coordinates of Fix(R)", "leave symmetry and parameter out")
    if system.normalised:
        refuse("equation", f"{system.name} is a form of other orbits", "claim it in the original coordinates")


def check_varying(candidate: Candidate, refuse: Refuse) -> None:
    """Where two resonances meet one of the system's fixed parameters varies, and H is none of the coordinates."""
    free = set(candidate.system.fixed_parameters) - set(candidate.parameters)
    if len(free) != 1 or not set(candidate.parameters) <= set(candidate.system.fixed_parameters):
        wanted = ", ".join(candidate.system.fixed_parameters) or "none"
        refuse("parameters", "all but one have a value where two resonances meet", f"there are {wanted}")
    if candidate.k < 2 or candidate.symmetry is not None or candidate.level_sign is not None:
        refuse("kind", f"{candidate.kind} with k = {candidate.k}", "give k > 1, and neither symmetry nor level_sign")
    if candidate.system.family_parameter is not None:
        refuse("kind", f"{candidate.kind} in a system with a family parameter", "claim it of one with a first integral")
