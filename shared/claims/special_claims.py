"""What a claim about one orbit, two resonances that meet, or a homoclinic orbit has to fulfil besides."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NoReturn

from orbitproof.shared.claims.candidate import COORDINATE, HALF_PERIOD, LEVEL, QUANTITIES, Candidate, Equation
from orbitproof.shared.claims.without_symmetry import check_numbers, check_positive, refuse

if TYPE_CHECKING:
    from orbitproof.shared.claims.homoclinic import HomoclinicOrbit
    from orbitproof.shared.claims.homoclinic_curve import HomoclinicCurve

MOST_POWERS = 32
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


def check_homoclinic(claim: HomoclinicOrbit) -> None:
    """Raises `InputError`, one line that begins with the field, for a homoclinic orbit that could not be claimed."""
    claim.check_setting()
    system = claim.system
    if len(system.state) != 4 or system.defined:
        refuse("system", f"{system.name} has not 4 coordinates in plain arithmetic", "give another system")
    if claim.level is None:
        refuse("level", "missing", "give that of the first integral")
    if system.first_integral_program is None:
        refuse("level", f"{system.name} has no first integral", "give a system that has one")
    signs = claim.reversing_symmetry
    if len(signs) != 4 or any(type(sign) is not int or sign not in (1, -1) for sign in signs) or signs.count(1) != 2:
        refuse("reversing_symmetry", f"{signs!r} are not two signs 1 and two -1", "give one for each coordinate")
    for name, value, sign in (("section", claim.section, -1), ("level_coordinate", claim.level_coordinate, 1)):
        if value not in system.state or signs[system.state.index(value)] != sign:
            refuse(name, f"{value!r} is no coordinate with the sign {sign}", f"name one of {system.state}")
    if type(claim.level_sign) is not int or claim.level_sign not in (1, -1):
        refuse("level_sign", f"{claim.level_sign!r} is no sign", "give 1 or -1")
    for name in ("crossings", "arrival"):
        number = getattr(claim, name)
        if type(number) is not int or number < 1:
            refuse(name, f"{number!r} is no number of crossings", "give an integer, at least 1")
    for name in ("centre", "radii"):
        if len(getattr(claim, name)) != 2:
            refuse(name, "wrong length", "give 2 numbers")
    check_numbers({"level": [(claim.level,)]}, rational=True)
    check_numbers({
        "slope": [(claim.slope,)], "cone": [(claim.cone,)], "centre": [claim.centre], "radii": [claim.radii],
    })  # fmt: skip
    check_positive("radii", claim.radii)
    check_positive("cone", [claim.cone])
    if not claim.slope:
        refuse("slope", "it is 0", "give that of the unstable direction")


def check_homoclinic_curve(claim: HomoclinicCurve) -> None:
    """The same for homoclinic orbits on all levels of an interval."""
    check_homoclinic(claim.middle)
    if len(claim.powers) != 3 or not all(0 < len(row) <= MOST_POWERS for row in claim.powers):
        refuse("powers", "wrong shape", f"give 3 rows of at most {MOST_POWERS} numbers")
    check_numbers({"powers": claim.powers})
    check_numbers({"level_radius": [(claim.level_radius,)]}, rational=True)
    if not claim.level_radius > 0:
        refuse("level_radius", "not positive", "give half the length of the interval of levels")
    if not abs(claim.slope) > sum(map(abs, claim.powers[2])):
        refuse("slope", "may be 0 for some t", "give a shorter interval of levels")
