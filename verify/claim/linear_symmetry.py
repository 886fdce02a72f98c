"""That a vector field or a function respects a linear map S, f(S x) = S f(x) identically (sections 1.4 and 25.1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache

from flint import fmpq, fmpq_mpoly

from orbitproof.shared.systems import Program
from orbitproof.verify.claim.first_integral import AlongFlow, NotShownError, Ring

Rows = tuple[tuple[Fraction, ...], ...]
RingOf = Callable[[Program, Program], Ring]


@cache
def is_respected(program: Program, symmetry: Rows, ring_of: RingOf = Ring) -> bool:
    """Whether g(S x, a) = S g(x, a), or g(S x, a) = g(x, a) for a function of one value, is shown identically.

    Then the program is defined at S x wherever it is at x. False also where that takes a relation between the bases of
    different powers, or polynomials that are too large.

    Args:
        program: g; inputs are the state x, then the parameters a.
        symmetry: S, rows.
        ring_of: as for `is_first_integral`.
    """
    size = len(symmetry)
    try:
        ring = ring_of(program, program)
        zero = ring.polynomials.constant(0)
        state, parameters = ring.inputs[:size], ring.inputs[size:]
        before = [output.value for output in program.evaluate(ring.inputs, ring.constant, AlongFlow.power)]
        ring.is_closed = True
        moved = [AlongFlow(ring, value, zero) for value in _image(ring, symmetry, [x.value for x in state])]
        after = [output.value for output in program.evaluate([*moved, *parameters], ring.constant, AlongFlow.power)]
        expected = before if len(before) == 1 else _image(ring, symmetry, before)
        differences = [ring.sum(left, -right) for left, right in zip(after, expected, strict=True)]
        return all(map(ring.vanishes, differences))
    except NotShownError:
        return False


def _image(ring: Ring, symmetry: Rows, values: Sequence[fmpq_mpoly]) -> list[fmpq_mpoly]:
    image = []
    for row in symmetry:
        value = ring.polynomials.constant(0)
        for factor, each in zip(row, values, strict=True):
            value = ring.sum(value, each * fmpq(factor.numerator, factor.denominator))
        image.append(value)
    return image
