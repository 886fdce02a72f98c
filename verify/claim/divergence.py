"""That the divergence of a vector field vanishes, as an identity of functions (section 1.4)."""

from __future__ import annotations

from functools import cache

from orbitproof.shared.systems import Program
from orbitproof.verify.claim.first_integral import AlongFlow, NotShownError, Ring


@cache
def is_free_of_divergence(field: Program, size: int) -> bool:
    """Whether the divergence of f, in its first `size` inputs, is shown to vanish identically; as `is_first_integral`.

    False also where polynomials are too large.
    """
    ring = Ring(field, field)
    unit, zero = ring.polynomials.constant(1), ring.polynomials.constant(0)
    divergence = zero
    try:
        for place in range(size):
            inputs = [AlongFlow(ring, x.value, unit if i == place else zero) for i, x in enumerate(ring.inputs)]
            rates = [output.rate for output in field.evaluate(inputs, ring.constant, AlongFlow.power)]
            divergence = ring.sum(divergence, rates[place])
    except NotShownError:
        return False
    return ring.vanishes(divergence)
