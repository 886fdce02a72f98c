"""Symmetries and the first integral, read off straight-line programs (sections 1.3 and 1.4).

Under a diagonal sign change of the state every node of a program is even (unchanged), odd (negated)
or neither. Sums of two even nodes are even, of two odd nodes odd; parities multiply in products and
quotients; a power of an even node is even, an integer power of an odd node has the parity of the
exponent. That proves f(R x) = -R f(x), f(S x) = S f(x) and the invariance of a first integral.
"""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.systems import ReversibleSystem, has_parities, parities
from orbitproof.verify.claim.first_integral import is_first_integral
from orbitproof.verify.evidence import Checklist


def signs_on(system: ReversibleSystem, symmetry: str, coordinates: Sequence[str]) -> tuple[int, ...]:
    """The signs of a symmetry on coordinates of Fix(R); parameters and levels among them are left alone."""
    signs = dict(zip(system.state, system.symmetries[symmetry], strict=True))
    return tuple(signs.get(name, 1) for name in coordinates)


def check_symmetries(checklist: Checklist, system: ReversibleSystem, symmetry: str | None = None) -> None:
    """R reverses the flow, `symmetry`, if named, commutes with it, and H is a first integral that both leave alone.

    R and S commute because both are diagonal.
    """
    turn = system.arrival
    arrival = f", f({turn} x) = {turn} f(x) for the {turn} of half orbits from Fix(R) to Fix(R {turn})" if turn else ""
    with checklist.hypothesis(
        "symmetries",
        "1.3",
        f"f(R x) = -R f(x){arrival}, and f(S x) = S f(x) if a symmetry S is named, from the parities of the program; a "
        "first integral H satisfies grad H . f = 0 identically (1.4), and R and S leave it unchanged",
        "correct the description of the system; a symmetry or an integral may be true and not be recognised: write "
        "sums of terms that R and S change alike, and H without divisors and roots that the vector field does not have",
    ) as evidence:
        integral = system.first_integral_program
        distance = system.squared_distance_program
        involutions = [("R", system.reversing_symmetry, -1)]
        for further in dict.fromkeys(name for name in (symmetry, system.arrival) if name is not None):
            evidence.require(further in system.symmetries, f"{system.name} has no symmetry {further}")
            involutions.append((further, system.symmetries.get(further, ()), 1))
        for name, signs, orientation in involutions:
            shown = has_parities(system.program, signs, [orientation * sign for sign in signs])
            message = f"of {system.name} was not shown to have the symmetry {name}"
            evidence.require(shown, f"the vector field {message}")
            evidence.require(integral is None or parities(integral, signs) == [1], f"the first integral {message}")
        ring_of = None
        if system.defined:
            from orbitproof.verify.claim.functions import require_functions

            ring_of = require_functions(evidence, system, [(name, signs) for name, signs, _ in involutions])
        evidence.require(
            distance is None or parities(distance, system.reversing_symmetry) == [1],
            f"the distance of {system.name} from {system.distance_name} was not shown to have the symmetry R",
        )
        evidence.require(
            integral is None or is_first_integral(system.program, integral, ring_of),
            f"the {system.first_integral_name or 'first integral'} of {system.name} was not shown to be constant along "
            "its orbits",
        )
