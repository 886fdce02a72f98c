"""Orbits from their birth on, of closed form (section 38)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction as Q
from math import comb
from typing import Any

from orbitproof.shared.claims import BirthAtlas, BirthCurveClaim, Piece
from orbitproof.shared.formats import define_system
from orbitproof.shared.systems import System

TUBE = Q(1, 2**12)


def circles(growth: str = "a", w: str = "1") -> System:
    """Circles about (a, 0), of the square of the radius `growth`, with the period 2 pi/w."""
    where = {"u": "x - a", "g": f"({growth}) - u**2 - y**2"}
    field = {"x": f"g*u - ({w})*y", "y": f"({w})*u + g*y"}
    return define_system({"name": "circles", "state": "x y", "parameters": "a", "where": where, "field": field})


SLAVED = define_system(
    {
        "name": "slaved", "state": "x y z", "parameters": "a b",
        "where": {"u": "x - a", "g": "b*a - u**2 - y**2"},
        "field": {"x": "g*u - y", "y": "u + g*y", "z": "u**2 - z"},
    }
)  # fmt: skip
"""As `circles`, of the square of the radius b a; z follows: at y = 0, u = r it is 3 r^2/5."""


def piece(reach: Q, rows: Sequence[Sequence[Q]], **changes: Any) -> Piece:
    """From eps = 0 to 2 h, h the reach: the coordinates but eps are polynomials of s, in their order."""
    size = len(rows) + 1
    columns = [1, 0, *range(2, size)]
    frame = tuple(tuple(Q(int(columns[j] == i)) for j in range(size)) for i in range(size))
    centre = tuple(reach if i == 1 else Q(0) for i in range(size))
    given = Piece("p1", "regular", centre, frame, reach, tuple(map(tuple, rows)), (TUBE,) * (size - 1), "physical")
    return replace(given, **changes)


def squares(reach: Q, factor: Q = Q(1)) -> tuple[Q, ...]:
    """factor eps^2, by powers of s."""
    return (factor * reach**2, 2 * factor * reach**2, factor * reach**2)


def circles_born(system: System | None = None, reach: Q = Q(1, 8), square: Q = Q(1), **changes: Any) -> BirthAtlas:
    """a = `square` eps^2 = c_1, c_2 = 0."""
    claim = BirthCurveClaim("birth-arc", "y", 1, "x", "a")
    rows = [squares(reach, square), squares(reach, square), (Q(0),)]
    given: dict[str, Any] = {
        "id": "circles", "title": "circles from their birth on", "system": circles() if system is None else system,
        "parameters": {}, "claim": claim, "pieces": (piece(reach, rows),),
    }  # fmt: skip
    return BirthAtlas(**{**given, **changes})


def bent_circles(u: str, inverse: str, rest: Q, direction: int = -1) -> BirthAtlas:
    """Circles about 0 of u(x) and y, of the square of the radius a; `inverse`: 1/u'(x), `rest`: where u is 0."""
    where = {"u": u, "g": "a - u**2 - y**2"}
    field = {"x": f"({inverse})*(g*u - y)", "y": "u + g*y"}
    system = define_system({"name": "bent", "state": "x y", "parameters": "a", "where": where, "field": field})
    rows, reach = [squares(Q(1, 32)), (rest,), (Q(0),)], Q(1, 32)
    claim = BirthCurveClaim("birth-arc", "x", direction, "y", "a")  # type: ignore[arg-type]
    given = piece(reach, rows, tube=(Q(1, 2**20),) * 3)
    return BirthAtlas("bent", "circles in other coordinates", system, {}, claim, (given,))


def slaved_born(reach: Q = Q(1, 8), b: Q = Q(2)) -> BirthAtlas:
    """a = eps^2/b = c_1, y_z = 3 eps/5."""
    rows = [squares(reach, 1 / b), squares(reach, 1 / b), (Q(0),), (Q(0),), (Q(3, 5) * reach, Q(3, 5) * reach)]
    claim = BirthCurveClaim("birth-arc", "y", 1, "x", "a")
    return BirthAtlas("slaved", "circles, and what follows them", SLAVED, {"b": b}, claim, (piece(reach, rows),))


def born_twice() -> BirthAtlas:
    """Circles of the square of the radius a (1 - a)/4 = eps^2 and the period 2 pi/(1 + a), from a = 0 to a = 1."""
    reach, half, zero, one = Q(1, 16), Q(11, 25), Q(0), Q(1)
    # a = (1 - sqrt(1 - 16 eps^2))/2, Catalan's numbers times powers of 4 eps^2; eps = reach (s + 1).
    a = [zero] * 25
    for n in range(12):
        factor = Q(comb(2 * n, n), n + 1) * (4 * reach**2) ** (n + 1)
        for k in range(2 * n + 3):
            a[k] += factor * comb(2 * n + 2, k)
    back = [Q(k == 0) - (-1) ** k * value for k, value in enumerate(a)]
    # eps = sqrt(1 - 4 (a - 1/2)^2)/4
    eps, factor = [zero] * 49, Q(1, 4)
    for n in range(25):
        eps[2 * n] = factor
        factor *= (4 * half**2) * Q(2 * n - 1, 2 * n + 2)
    first, last = (piece(reach, (row, row, (zero,)), id=name) for name, row in (("p1", a), ("p3", back)))
    last = replace(last, frame=(last.frame[0], (-one, zero, zero, zero), *last.frame[2:]))
    frame = ((one, zero, zero, zero), (zero, one, zero, zero), (one, zero, one, zero), (zero, zero, zero, one))
    middle = replace(
        first, id="p2", centre=(Q(1, 2), zero, Q(1, 2), zero), frame=frame, half_width=half,
        polynomial=(tuple(eps), (zero,), (zero,)),
    )  # fmt: skip
    claim = BirthCurveClaim("birth-to-birth", "y", 1, "x", "a")
    return circles_born(circles("a*(1 - a)/4", "1 + a"), claim=claim, pieces=(first, middle, last))
