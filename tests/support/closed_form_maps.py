"""Reversible maps in closed form, with tables of derivatives like the integrator's.

f = R J, J = Phi L Phi^-1, with the involutions R (p, q) -> (p, -q) and L (p_j, q_j) -> (a_j p_j + q_j,
(1 - a_j^2) p_j - a_j q_j) and the shear Phi (p, q) -> (p, q + s(p)), s of second order. The origin is fixed
for every value of nu, its multipliers are exp(+-i theta_j) with cos theta_j = a_j, and a_1 = a + nu.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any

from flint import arb

from orbitproof.shared.claims import Candidate
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.bifurcation import BifurcationResults, prepare, prove
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    enclose,
    indices_up_to,
    symmetric,
)
from orbitproof.verify.newton import Jet
from orbitproof.verify.newton.jets import increment

Shear = Callable[[Sequence[Any]], Sequence[Any]]


@dataclass(frozen=True)
class ReversibleMap:
    """The family of maps above; `a` and `others` are the constants a_j, `slope` shifts p_1 by slope * nu."""

    a: Fraction
    shear: Shear
    others: tuple[Fraction, ...] = ()
    slope: Fraction = Fraction(0)

    def iterate_kernel(self, nu: Any, p: Sequence[Any], k: int, number: Callable[[Fraction], Any]) -> list[list[Any]]:
        """The q components of f, .., f^k at (p, 0)."""
        p = [p[0] + nu * number(-self.slope), *p[1:]]
        q = [number(Fraction(0)) for _ in p]
        constants = [nu + number(self.a), *(number(value) for value in self.others)]
        minus = number(Fraction(-1))
        result = []
        for _ in range(k):
            q = [y + minus * s for y, s in zip(q, self.shear(p), strict=True)]
            image = [a * x + y for a, x, y in zip(constants, p, q, strict=True)]
            q = [(number(Fraction(1)) + minus * a * a) * x + minus * a * y
                 for a, x, y in zip(constants, p, q, strict=True)]  # fmt: skip
            p = image
            q = [minus * (y + s) for y, s in zip(q, self.shear(p), strict=True)]
            result.append(q)
        return result


def table(
    function: Callable[[list[Jet], Callable[[Fraction], Jet]], Jet], radii: Sequence[Fraction]
) -> DerivativeTable:
    """Derivatives of a closed-form function over the box and at its centre."""
    size = len(radii)

    def number(value: Fraction) -> Jet:
        return Jet(size, 3, {(0,) * size: enclose(value)})

    def at(base: Sequence[arb]) -> dict[tuple[int, ...], arb]:
        variables = [Jet(size, 3, {(0,) * size: ball}) + increment(size, 3, i) for i, ball in enumerate(base)]
        jet = function(variables, number)
        return {index: jet.derivative(*index) for index in indices_up_to(size, 3)}

    return DerivativeTable(at([symmetric(radius) for radius in radii]), at([arb(0)] * size))


Level = Callable[[Sequence[Any], Callable[[Fraction], Any]], Any]


def tables_of_maps(
    system: ReversibleMap, k: int, radii: Sequence[Fraction], level: Level | None = None
) -> tuple[list[list[DerivativeTable]], DerivativeTable | None]:
    """Tables of f, .., f^k in (p_0, p_1, ..) with nu = p_0, or nu = level(p), then also the first integral."""
    nu_of: Level = level if level is not None else (lambda p, _: p[0])
    iterates = [
        [
            table(lambda p, c, i=i, j=j: system.iterate_kernel(nu_of(p, c), p[1:], i, c)[-1][j], radii)
            for j in range(len(radii) - 1)
        ]
        for i in range(1, k + 1)
    ]
    return iterates, None if level is None else table(nu_of, radii)


def description(n: int, hamiltonian: bool, symmetric_system: bool = False) -> ReversibleSystem:
    """A system description with the right numbers of coordinates; its vector field is not used."""
    fixed = n + (1 if hamiltonian else 0)
    state = (*(f"p{i}" for i in range(fixed)), "y", *(f"q{i}" for i in range(n)))
    m = len(state)
    odd = {fixed - n, fixed + 1}
    return ReversibleSystem(
        name="closed-form", title="closed-form system", state=state,
        parameters={} if hamiltonian else {"nu": ParameterRange(None, None)},
        vector_field=lambda x, _: list(x),
        reversing_symmetry=(1,) * fixed + (-1,) * (m - fixed),
        symmetries={"S": tuple(-1 if i in odd else 1 for i in range(m))} if symmetric_system else {},
        section="y",
        family_parameter=None if hamiltonian else "nu",
        first_integral=(lambda x, _: [x[0]]) if hamiltonian else None,
        first_integral_name="energy" if hamiltonian else None,
    )  # fmt: skip


def identity(size: int) -> tuple[tuple[Fraction, ...], ...]:
    """The identity matrix."""
    return tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size))


def claim(system: ReversibleSystem, kind: str, k: int, radii: Sequence[Fraction], **changes: Any) -> Candidate:
    """A candidate at the origin with identity frames."""
    size = len(radii)
    values: dict[str, Any] = {
        "id": "claim", "system": system, "parameters": {}, "kind": kind, "k": k,
        "centre": (Fraction(0),) * size, "frame": identity(size), "kernel_frame": identity(size - 1),
        "radii": tuple(radii), "symmetry": "S" if kind == "symmetry_breaking" else None,
    }  # fmt: skip
    return Candidate(**{**values, **changes})


def verdict(
    candidate: Candidate, iterates: Sequence[Sequence[DerivativeTable]], first_integral: DerivativeTable | None
) -> Outcome[BifurcationResults]:
    """The outcome for given tables; the symmetries of the flow are taken for granted."""
    checklist = Checklist()
    with checklist.hypothesis("symmetries", "1", "given", "") as evidence:
        evidence.require(True, "")
    try:
        prepare(candidate, checklist)
    except NotEstablishedError as error:
        return NotProved(error.reason, tuple(checklist.hypotheses))
    return prove(candidate, checklist, iterates, first_integral)


def square_root(value: Fraction, bits: int) -> Fraction:
    """A dyadic number within 2^-bits of the square root."""
    return Fraction(isqrt(value.numerator * 4**bits // value.denominator), 2**bits)
