"""On which side of a bifurcation the new orbits are, from following them with the independent integrator."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import arb, arb_mat, ctx
from support.flow_checks import initial_state, kernel_values, orbits

from orbitproof.shared.claims import Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.verify.evidence import enclose, exact_value

BITS = 200
_STEP = Fraction(1, 2**80)
_DISTANCE = Fraction(1, 2**28)
_FAR = Fraction(1, 2**8)
_NEWTON_STEPS = 3


def kernel_of(candidate: Candidate, p: Sequence[Fraction]) -> list[Fraction]:
    """q of P^k at the point p of the candidate's frame."""
    crossings = orbits(candidate.system, BITS).crossings(*initial_state(candidate, p), candidate.k)
    return kernel_values(candidate, crossings[-1].state)


def on_the_branch(candidate: Candidate, p_1: Fraction) -> tuple[Fraction, ...]:
    """The point of the new branch with this p_1, by Newton's method for the other coordinates with differences."""
    p = [Fraction(0)] * len(candidate.radii)
    p[1] = p_1
    free = [j for j in range(len(p)) if j != 1]
    for _ in range(_NEWTON_STEPS):
        value = kernel_of(candidate, p)
        columns = []
        for j in free:
            moved = kernel_of(candidate, [x + _STEP * (i == j) for i, x in enumerate(p)])
            columns.append([(a - b) / _STEP for a, b in zip(moved, value, strict=True)])
        with ctx.workprec(2 * BITS):
            matrix = arb_mat([[enclose(column[i]) for column in columns] for i in range(len(value))])
            step = matrix.solve(arb_mat([[enclose(x)] for x in value]))
            for i, j in enumerate(free):
                p[j] -= round_dyadic(exact_value(step[i, 0].mid()), 120)
        assert max(map(abs, p)) < _FAR, "there is no branch here"
    return tuple(p)


def parameter_at(candidate: Candidate, p: Sequence[Fraction]) -> arb:
    """The bifurcation parameter at a point: the family parameter, or the first integral."""
    state, parameters = initial_state(candidate, p)
    program = candidate.system.first_integral_program
    if program is None:
        return enclose(dict(zip(candidate.system.parameters, parameters, strict=True))[candidate.coordinates[0]])
    arguments = [enclose(value) for value in (*state, *parameters)]
    (value,) = program.evaluate(arguments, enclose, lambda base, exponent: base ** enclose(exponent))
    return value


def side_of(claim: Candidate) -> str:
    """Parameter values, compared with that at the centre, a bifurcation, at which there are new orbits."""
    middle = tuple(Fraction(0) for _ in claim.radii)
    signs = set()
    with ctx.workprec(2 * BITS):
        for distance in (_DISTANCE, -_DISTANCE):
            here = parameter_at(claim, on_the_branch(claim, distance)) - parameter_at(claim, middle)
            assert abs(here) > enclose(_DISTANCE**2 / 2**20)
            signs.add(here > 0)
    return "both" if len(signs) == 2 else "above" if True in signs else "below"
