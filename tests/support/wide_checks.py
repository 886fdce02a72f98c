"""What the tests of pieces share: wide sets of orbits with independent references, and a system in closed form."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
from support.exact_elements import known_value, number
from support.reference import Orbits, falkner_skan, three_body

from orbitproof.shared.claims import Piece
from orbitproof.shared.systems import AROUND, CR3BP, FALKNER_SKAN, MASS_PARAMETERS, ParameterRange, ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic
from orbitproof.verify.curve import parameter_series
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import HalfOrbits

MU = MASS_PARAMETERS["earth-moon"]
BITS = 170
TOLERANCE = mpmath.mpf(2) ** -140

OMEGA = Fraction(3, 2)


def _twisted_rotations(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """Two plane rotations whose frequencies depend on the (conserved) radii."""
    a, b, c, d = state
    (omega,) = parameters
    first, second = a * a + b * b, c * c + d * d
    slow = 1 + first / 4
    fast = omega + first + second / 2
    return (-(slow * b), slow * a, -(fast * d), fast * c)


TWIST = ReversibleSystem(
    name="twist",
    title="two rotations with twist",
    state=("a", "b", "c", "d"),
    parameters={"omega": ParameterRange(Fraction(0), None)},
    vector_field=_twisted_rotations,
    reversing_symmetry=(1, -1, 1, -1),
    symmetries={"S": (1, 1, -1, -1)},
    section="b",
    first_integral=lambda x, _: (x[0] * x[0] + x[1] * x[1] + 3 * (x[2] * x[2] + x[3] * x[3]),),
    first_integral_name="weighted radius",
)
"""The first return of (a, 0, c, 0) turns (c, d) by pi (omega + a^2 + c^2/2) / (1 + a^2/4).

For omega = 3/2 this is 2 pi on the circle a^2 + c^2 = 1. So the symmetric orbits are that circle and the line c = 0,
which S fixes, and the circle breaks the symmetry at a = 1 and a = -1.
"""

OSCILLATOR = ReversibleSystem(
    name="oscillator",
    title="harmonic oscillator with a clock",
    state=("a", "b", "t"),
    parameters={"nu": ParameterRange(Fraction(0), None)},
    vector_field=lambda x, p: (-(p[0] * x[1]), p[0] * x[0], 1 + x[0]),
    reversing_symmetry=(1, -1, -1),
    section="b",
    family_parameter="nu",
)
"""The orbit of (a, 0, 0) returns to b = 0 after pi / nu, again and again."""

Arrival = tuple[Any, Sequence[Any]]
"""Time and state."""


@cache
def libration_point() -> Fraction:
    """x_L1 of the Earth-Moon system by bisection of the force on the axis, to 240 bits."""
    low, high = Fraction(4, 5), Fraction(9, 10)
    while high - low > Fraction(1, 2**240):
        middle = (low + high) / 2
        force = middle - (1 - MU) / (middle + MU) ** 2 + MU / (middle + MU - 1) ** 2
        low, high = (middle, high) if force < 0 else (low, middle)
    return low


Reference = Callable[[Sequence[Fraction], int], Arrival]
"""Time and state at a crossing of the orbit of a point of Fix(R), by its coordinates of the claim."""


def _twist(point: Sequence[Fraction], crossing: int) -> Arrival:
    a, c = map(number, point)
    slow = 1 + a * a / 4
    time = crossing * mpmath.pi / slow
    angle = (number(OMEGA) + a * a + c * c / 2) * time
    return time, (a * (-1) ** crossing, mpmath.mpf(0), c * mpmath.cos(angle), c * mpmath.sin(angle))


def _oscillator(point: Sequence[Fraction], crossing: int) -> Arrival:
    nu, a = map(number, point)
    time = crossing * mpmath.pi / nu
    return time, (a * (-1) ** crossing, mpmath.mpf(0), time)


def oscillators(powers: Sequence[str]) -> WideSet:
    """Oscillators whose frequency is 1 + a polynomial in s without a constant term."""
    tube = piece(("1", "1/2"), (("0", "1"), ("1", "0")), "1/8", (("0", *powers),), ("1e-6",))
    return WideSet(OSCILLATOR, {}, tube, _oscillator, (60, 16, 40), 1e-4)


def _three_body(point: Sequence[Fraction], crossing: int) -> Arrival:
    x, z, vy = point
    found = Orbits(three_body, 1, BITS).crossings([x, Fraction(0), z, Fraction(0), vy, Fraction(0)], [MU], crossing)
    return number(found[-1].time), [number(value) for value in found[-1].state]


def _falkner_skan(point: Sequence[Fraction], crossing: int) -> Arrival:
    beta, y = point
    orbits = Orbits(falkner_skan, FALKNER_SKAN.section_index, BITS)
    found = orbits.crossings([Fraction(0), y, Fraction(0)], [beta], crossing)
    return number(found[-1].time), [number(value) for value in found[-1].state]


def _around_l1(point: Sequence[Fraction], crossing: int) -> Arrival:
    """The orbit of the CR3BP itself, measured in units of eps from the libration point."""
    values = dict(zip(AROUND["L1"].centre_coordinates, point, strict=True))
    eps, vy = values["eps"], values["vy"]
    start = [libration_point() + eps, Fraction(0), Fraction(0), Fraction(0), eps * vy, Fraction(0)]
    found = Orbits(three_body, 1, BITS).crossings(start, [MU], crossing)[-1]
    x, y, _, vx, vy, _ = found.state
    return number(found.time), [number(value / eps) for value in (x - libration_point(), y, vx, vy)]


@dataclass(frozen=True)
class WideSet:
    """A tube of initial values: a piece without a claim, with an independent way to follow its orbits.

    Attributes:
        limits: fractional bits, degree in theta, width.
        sharp: the errors of the half return stay below this.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    piece: Piece
    reference: Reference
    limits: tuple[int, int, int] = (60, 24, 14)
    sharp: float = 1e-6

    @property
    def arithmetic(self) -> Arithmetic:
        """The format: weight 1 across the curve."""
        bits, degree, width = self.limits
        return WideArithmetic(Grading((1,) * len(self.piece.tube), 1), bits, 12, degree, width=width)

    def point(self, s: Fraction, w: Sequence[Fraction]) -> list[Fraction]:
        """A point of the tube, exactly."""
        piece = self.piece
        p = [value + width * x for value, width, x in zip(piece.local(s), (Fraction(0), *piece.tube), (Fraction(0), *w),
                                                          strict=True)]  # fmt: skip
        return [
            middle + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0))
            for middle, row in zip(piece.centre, piece.frame, strict=True)
        ]

    def initial(self) -> tuple[list[Series], list[Series]]:
        """State and parameters as elements in (w, s)."""
        arithmetic, piece = self.arithmetic, self.piece
        none = (0,) * len(piece.tube)
        rows = [[Fraction(0), piece.half_width], *piece.polynomial]
        named = {}
        for name, middle, factors in zip(self.system.centre_coordinates, piece.centre, piece.frame, strict=True):
            wide = [middle] + [Fraction(0)] * max(map(len, rows))
            for factor, row in zip(factors, rows, strict=True):
                for power, value in enumerate(row):
                    wide[power] += factor * value
            terms: dict[tuple[int, ...], Fraction | Sequence[Fraction]] = {none: wide}
            for j, width in enumerate(piece.tube):
                terms[tuple(int(i == j) for i in range(len(none)))] = factors[j + 1] * width
            named[name] = arithmetic.polynomial(terms)
        rest = {name: arithmetic.constant(value) for name, value in self.system.normalised.items()}
        zero = arithmetic.constant(Fraction(0))
        state = [{**rest, **named}.get(name, zero) for name in self.system.state]
        known = parameter_series(arithmetic, self.system, self.parameters)
        return state, [named[name] if name in named else known[name] for name in self.system.parameters]

    def returns(self) -> HalfOrbits:
        """The orbits, at the start."""
        state, parameters = self.initial()
        names = (*self.system.state, *self.system.parameters)
        point = dict(zip(names, (*state, *parameters), strict=True))
        return HalfOrbits(self.system, self.arithmetic, point, ORACLE, self.piece.coordinates)


def value_and_error(series: Series, s: Fraction, w: Sequence[Fraction]) -> tuple[Any, Any]:
    """The middle and the radius of the enclosure at a real point, with the errors of each grade at their place."""
    middle = known_value(series, mpmath.mpf(1), [*map(number, w), number(s)])
    t = max((abs(number(x)) for x in w), default=mpmath.mpf(1))
    radius = sum((mpmath.mpf(e) * t**grade for grade, e in enumerate(series.errors)), mpmath.mpf(0))
    return middle, radius


def holds(series: Series, value: Any, s: Fraction, w: Sequence[Fraction]) -> bool:
    """Whether an enclosure without theta holds a value that is known up to `TOLERANCE`."""
    middle, radius = value_and_error(series, s, w)
    return bool(abs(middle - value) <= radius + TOLERANCE)


def random_place(source: random.Random, count: int) -> tuple[Fraction, list[Fraction]]:
    """(s, w), sometimes at the ends, sometimes with a small w."""
    small = source.choice((Fraction(1), Fraction(1), Fraction(1, 2**20)))
    unit = [Fraction(source.choice((-64, 64, source.randint(-64, 64))), 64) for _ in range(count + 1)]
    return unit[0], [small * x for x in unit[1:]]


def piece(
    centre: Sequence[str], frame: Sequence[Sequence[str]], half_width: str, polynomial: Sequence[Sequence[str]],
    tube: Sequence[str], coordinates: str = "physical", kind: str = "regular",
) -> Piece:  # fmt: skip
    """A piece from decimal numbers and fractions."""
    rows = [tuple(Fraction(value) for value in row) for row in frame]
    curves = [tuple(Fraction(value) for value in row) for row in polynomial]
    numbers = tuple(Fraction(value) for value in centre), tuple(Fraction(value) for value in tube)
    return Piece("piece", kind, numbers[0], tuple(rows), Fraction(half_width), tuple(curves), numbers[1], coordinates)


EARTH_MOON = {"mu": MU}

WIDE_SETS: Mapping[str, WideSet] = {
    "falkner-skan": WideSet(
        FALKNER_SKAN, {},
        piece(("10", "0.9327"), (("1", "1/50"), ("0", "1")), "1", (("0", "1e-3", "2e-4"),), ("1e-6",)),
        _falkner_skan, sharp=1e-4,
    ),
    "cr3bp, physical": WideSet(
        CR3BP, EARTH_MOON,
        piece(("0.8257", "0.0796", "0.1933"), (("1/16", "1", "0"), ("2/3", "0", "3/4"), ("3/4", "0", "-2/3")),
              "4e-3", (("0", "1e-4"), ("0", "0", "1e-4")), ("1e-6", "1e-7")),
        _three_body,
    ),
    "cr3bp, regularised": WideSet(
        CR3BP, EARTH_MOON,
        piece(("0.9254", "0.3086", "0.0828"), (("-1/4", "0", "1"), ("1", "0", "1/4"), ("0", "1", "1/10")),
              "2e-3", (("0", "1e-4"), ("0", "0", "1e-4")), ("1e-7", "1e-7"), "regularised"),
        _three_body, (60, 24, 10),
    ),
    "cr3bp-l1": WideSet(
        AROUND["L1"], EARTH_MOON,
        piece(("-0.0063", "-8.79"), (("1", "0"), ("0", "1")), "2e-3", (("0", "0.02"),), ("1e-6",)), _around_l1,
        (60, 24, 10),
    ),
    "twist": WideSet(
        TWIST, {"omega": OMEGA},
        piece(("0.5", "0.3"), (("1", "1/8"), ("1/4", "1")), "0.15", (("0", "1/20", "1/30"),), ("1e-6",)), _twist,
        sharp=1e-5,
    ),
}  # fmt: skip
