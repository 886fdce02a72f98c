"""Proofs about returns that are known polynomials: everything but the integration, in one leg or in two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from importlib import import_module
from math import factorial, prod
from typing import Any

from flint import arb

from orbitproof.verify import second_proof as package

jets = import_module(f"{package.__name__}.jets")
legs = import_module(f"{package.__name__}.legs")
bifurcation = import_module(f"{package.__name__}.periodic_bifurcation")
torus = import_module(f"{package.__name__}.periodic_torus")
stating = import_module(f"{package.__name__}.periodic_statement")
statement = import_module(f"{package.__name__}.statement")

BITS, LOST = 400, 16
BEND = (Fraction(1, 2), Fraction(-1, 3), Fraction(2, 5))
"""Of the field along p, where the section is crossed."""


def polynomial(derivatives: Mapping[tuple[int, ...], Fraction], values: Sequence[Any]) -> Any:
    """A polynomial given by its derivatives at 0, on jets."""
    degree = values[0].degree
    total = jets.Jet({}, degree)
    for index, value in derivatives.items():
        term = jets.Jet({(): jets.ball(Fraction(value) / prod(map(factorial, index)))}, degree)
        for jet, power in zip(values, index, strict=True):
            for _ in range(power):
                term = term * jet
        total = total + term
    return total


def returning(derivatives: Sequence[Mapping[tuple[int, ...], Fraction]], bend: Sequence[Fraction], halves: int) -> Any:
    """E for the return map with these derivatives in (p, a), of a flow along (bend, 1) through the section y = 0.

    Coordinates are (p + bend y, y); the time till the return is less by the sum of all p^2 - p, without a bend of all
    p^2. Of two legs the first one doubles all coordinates.
    """
    n = len(derivatives)

    def late(p: Sequence[Any]) -> Any:
        terms = [x * x - x * int(any(bend)) for x in p]
        return sum(terms[1:], terms[0])

    def equations(x: Sequence[Any], a: Any, t: Any) -> list[Any]:
        begin = [jet * arb(1) for jet in x[: n + 1]]
        at = [jet / jets.Jet({(): arb(2)}, jet.degree) for jet in x[n + 1 :]] if halves == 2 else begin
        y = at[n]
        p = [jet - y * jets.ball(k) for jet, k in zip(at[:n], bend, strict=True)]
        last = y + t + late(p)
        image = [polynomial(row, [*p, a]) + last * jets.ball(k) for row, k in zip(derivatives, bend, strict=True)]
        more = [jet * arb(2) for jet in begin] if halves == 2 else []
        return [*image, last, *more, x[n]]

    return equations


def synthetic(base: type[Any], claim: Any, equations: Any, halves: int) -> Any:
    """An attempt of this class with these equations, started at 0, the second leg at 0 too."""
    size = len(claim.orbit.names)

    class Known(base):  # type: ignore[misc]
        def followed(self, around: Any, degree: int) -> Any:
            rows = self.returned(None, around, degree)
            signs = self.statement.symmetry or [1] * size
            first = [row * sign for row, sign in zip(rows[:size], signs, strict=True)]
            ends = [rows[size : 2 * size], first] if halves == 2 else [first]
            local = [
                [jets.Jet({(j,): row[(i * size + j,)] for j in range(size)} | {(): row[()]}, 1) for row in end]
                for i, end in enumerate(ends)
            ]
            return legs.Return(local, claim.orbit.crossings, {})

        def returned(self, found: Any, around: Any, degree: int) -> Any:
            variables = [jets.Jet({(): c, (j,): arb(1)}, degree) for j, c in enumerate(around[: self.time])]
            time = jets.Jet({(): around[self.time] - 1, (-1,): arb(1)}, degree)
            return equations(variables[:-1], variables[-1], time)

    shares = [arb(1) / 2, arb(1)][2 - halves :]
    points = [[arb(0)] * size] * halves
    return Known(claim, BITS, legs.Start(arb(1), LOST, shares, points))


def claimed(
    kind: str,
    kernel: Sequence[Sequence[Fraction]],
    multiplier: Sequence[Fraction] = (),
    symmetry: Sequence[int] | None = None,
    stretch: int = 1,
) -> Any:
    """A claim about the point 0 at a = 0, the section y = 0 and the box along p, its first edge `stretch` times p_0."""
    n = len(kernel[0])
    names = tuple(f"p{i}" for i in range(n))
    lines = [f"v{i} = {name}" for i, name in enumerate((*names, "y"))]
    lines += [f"v{n + 1} = 0", f"v{n + 2} = 1", f"v{n + 3} = v{n} * v{n}", f"v{n + 4} = v{n + 2} + v{n + 3}"]
    program = statement.Program.from_text("\n".join([*lines, "return " + ", ".join([f"v{n + 1}"] * n + [f"v{n + 4}"])]))
    zero, one = Fraction(0), Fraction(1)
    orbit = stating.PeriodicStatement(
        (*names, "y"), {"a": zero}, program, None, None, None, (*[zero] * n, one), zero, 1, 1, (zero,) * (n + 1),
        tuple(tuple(one * (i == j) * (1 if j else stretch) for j in range(n)) for i in range(n + 1)), "a",
        None if symmetry is None else (*symmetry, 1),
    )  # fmt: skip
    return bifurcation.BifurcationStatement(kind, orbit, zero, tuple(map(tuple, kernel)), tuple(multiplier))
