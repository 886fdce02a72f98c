"""Identities of a system: first integral, divergence, linear symmetry (sections 1.4, 1.7 and 25.1)."""

from __future__ import annotations

from orbitproof.shared.systems import System
from orbitproof.verify.claim.divergence import is_free_of_divergence
from orbitproof.verify.claim.first_integral import is_first_integral
from orbitproof.verify.claim.linear_symmetry import Rows, is_respected


def keeps_integral(system: System) -> bool:
    """Whether the first integral of the system, which has one, is shown to be constant along its orbits."""
    integral = system.first_integral_program
    assert integral is not None
    if system.defined:
        from orbitproof.verify.claim.related_functions import functions_of

        return is_first_integral(system.program, integral, functions_of(system))
    return is_first_integral(system.program, integral)


def keeps_volume(system: System) -> bool:
    """Whether the divergence of the field, in the coordinates that are given, is shown to vanish."""
    if system.defined:
        from orbitproof.verify.claim.related_functions import functions_of, is_free_with_functions

        return is_free_with_functions(system.program, functions_of(system))
    return is_free_of_divergence(system.program, len(system.state))


def respects(system: System, symmetry: Rows, with_integral: bool) -> tuple[bool, bool]:
    """Whether f(S x) = S f(x), and H(S x) = H(x) if that is asked, is shown in the coordinates that are given.

    Args:
        symmetry: S, shape (N, N), rows.
    """
    integral = system.first_integral_program if with_integral else None
    if system.defined:
        from orbitproof.verify.claim.related_functions import functions_of, with_moved_functions

        ring_of = functions_of(system)
        rows = with_moved_functions(system.program, ring_of, symmetry)
        if rows is None:
            return False, integral is None
        field = is_respected(system.program, rows, ring_of)
        return field, integral is None or is_respected(integral, rows, ring_of)
    return is_respected(system.program, symmetry), integral is None or is_respected(integral, symmetry)
