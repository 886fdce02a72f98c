"""Orbits along a hard spring beside two others, whose full returns are known; claims that tori accumulate at them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
from support.springs import BITS, half, number

from orbitproof.shared.formats import COORDINATE, INVARIANT_TORI, Candidate, Equation
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.tori import ToriEnclosures, enclose_tori

ROWS = ((Fraction(1), Fraction(1, 2)), (Fraction(-1, 4), Fraction(1)))
"""y and z as functions of the state coordinates u and v."""
_DETERMINANT = ROWS[0][0] * ROWS[1][1] - ROWS[0][1] * ROWS[1][0]
AMPLITUDE = Fraction(3, 2)


def _both(first: Any, second: Any) -> tuple[Any, Any]:
    return tuple(row[0] * first + row[1] * second for row in ROWS)  # type: ignore[return-value]


def _field(s: Any, p: Any) -> Any:
    x, u, v, vx, vu, vv = s
    forces = []
    for y, (w, b, c) in zip(_both(u, v), (p[:3], p[3:]), strict=True):
        forces.append(-w * y - b * y**2 - c * y**3)
    first = (ROWS[1][1] * forces[0] - ROWS[0][1] * forces[1]) / _DETERMINANT
    second = (ROWS[0][0] * forces[1] - ROWS[1][0] * forces[0]) / _DETERMINANT
    return vx, vu, vv, -x - x**3, first, second


def _energy(s: Any, p: Any) -> Any:
    x, u, v, vx, vu, vv = s
    total = vx**2 + x**2 + x**4 / 2
    for y, vy, (w, b, c) in zip(_both(u, v), _both(vu, vv), (p[:3], p[3:]), strict=True):
        total = total + vy**2 + w * y**2 + 2 * b * y**3 / 3 + c * y**4 / 2
    return (total,)


THREE_SPRINGS = ReversibleSystem(
    name="three-springs",
    title="hard spring beside two others",
    state=("x", "u", "v", "vx", "vu", "vv"),
    parameters={name: ParameterRange(None, None) for name in ("w1", "b1", "c1", "w2", "b2", "c2")},
    vector_field=_field,
    reversing_symmetry=(1, 1, 1, -1, -1, -1),
    section="vx",
    first_integral=_energy,
    first_integral_name="twice the energy",
)
"""x'' = -x - x^3, y'' = -w y - b y^2 - c y^3 and the same of z, where y and z are combinations of u and v."""


@dataclass(frozen=True)
class Springs:
    """Coefficients of the springs y and z: stiffness, and of the square and the cube."""

    y: tuple[Fraction, Fraction, Fraction]
    z: tuple[Fraction, Fraction, Fraction]


def springs_of(*values: str) -> Springs:
    first = tuple(map(Fraction, values[:3]))
    second = tuple(map(Fraction, values[3:]))
    return Springs(first, second)  # type: ignore[arg-type]


BENT = springs_of("2", "1/2", "1/3", "7", "1", "-3/4")
LINEAR = springs_of("2", "0", "0", "7", "0", "0")
RESONANT = springs_of("2", "1/2", "1/3", "8", "1", "-3/4")
UNSTABLE = springs_of("-1/8", "1/2", "1/3", "7", "1", "-3/4")


def claim(springs: Springs, radius: Fraction = Fraction(1, 2**60)) -> Candidate:
    """That tori accumulate at the orbit along the hard spring, the others at rest."""
    off = radius / 4
    unit = tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3))
    return Candidate(
        id="springs",
        system=THREE_SPRINGS,
        parameters=dict(zip(THREE_SPRINGS.parameters, (*springs.y, *springs.z), strict=True)),
        kind=INVARIANT_TORI,
        k=1,
        centre=(AMPLITUDE + off, off, -off),
        frame=unit,
        kernel_frame=tuple(row[:2] for row in unit[:2]),
        radii=(radius,) * 3,
        equation=Equation(COORDINATE, AMPLITUDE, "x"),
    )


@cache
def enclosures(springs: Springs) -> ToriEnclosures:
    with mpmath.workprec(BITS):
        return enclose_tori(claim(springs), IntegratorSettings(160), ORACLE)


def expected(springs: Springs) -> tuple[list[Any], list[list[Any]]]:
    """The cosines of the orbit in increasing order, and the torsion in the coordinates of section 30.2.

    A full return takes the time 2 T(h), h = H - h_y - h_z being the energy left for the hard spring, in which y
    turns back by the angle 2 T(h) omega(A), A its amplitude: omega = w^(1/2) (1 + A^2 (9 c w - 10 b^2) / (24 w^2)) and
    h_y = w A^2 up to higher order (A. H. Nayfeh, D. T. Mook, Nonlinear oscillations, 2.3).
    """
    a = number(AMPLITUDE)
    level = a**2 + a**4 / 2

    def time(value: Any) -> Any:
        return 2 * half(mpmath.sqrt(mpmath.sqrt(1 + 2 * value) - 1))

    slope = mpmath.diff(time, level)
    sizes = [number(sum((x * x for x in row), Fraction(0))) for row in ROWS]
    pairs = []
    for j, spring in enumerate((springs.y, springs.z)):
        w, b, c = map(number, spring)
        root = mpmath.sqrt(w)
        angle = root * time(level)
        sign = 1 if mpmath.sin(-angle) > 0 else -1
        row = []
        for other, (each, size) in enumerate(zip((springs.y, springs.z), sizes, strict=True)):
            value = -root * slope * number(each[0]) * size
            if other == j:
                value += time(level) * root * (9 * c * w - 10 * b**2) / (24 * w**2) * size
            row.append(-sign * value)
        pairs.append((mpmath.cos(angle), row))
    order = sorted(range(2), key=lambda j: pairs[j][0])
    return [pairs[j][0] for j in order], [[pairs[j][1][k] for k in order] for j in order]
