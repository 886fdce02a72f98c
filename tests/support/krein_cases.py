"""Krein collisions that are known: a clock that drives a normal form, and half returns that are random polynomials."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import product
from math import prod
from operator import add, itemgetter, sub
from pathlib import Path
from typing import Any

import numpy as np
from flint import arb

from orbitproof.shared.formats import KREIN_COLLISION, Candidate, candidate_from_json
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.evidence import DerivativeTable, enclose, guarded, indices_up_to, symmetric
from orbitproof.verify.reversor_breaking import BreakingEnclosures

DATA = Path(__file__).parents[1] / "data"
LEVEL = Fraction(9, 4)


def _field(s: Any, p: Any) -> Any:
    x, x1, x2, v, y1, y2 = s
    omega, a, b = p
    p1 = x1 - y1**2 / 4
    rate = a * (x**2 + v**2 - LEVEL) + b * (p1**2 + y1**2)
    # A = p1 + i y1, B = y2 + i x2: A' = i omega A + B, B' = i omega B + rate A.
    turned = omega * p1 + x2
    slope = -omega * y1 + y2
    return (
        v,
        slope + y1 * turned / 2,
        omega * y2 + rate * y1,
        -x,
        turned,
        -omega * x2 + rate * p1,
    )


CLOCK = ReversibleSystem(
    name="clock",
    title="clock beside two oscillators in resonance",
    state=("x", "x1", "x2", "v", "y1", "y2"),
    parameters={name: ParameterRange(None, None) for name in ("omega", "a", "b")},
    vector_field=_field,
    reversing_symmetry=(1, 1, 1, -1, -1, -1),
    section="v",
    first_integral=lambda s, p: (s[0] ** 2 + s[3] ** 2,),
    first_integral_name="energy of the clock",
    level_coordinate="x",
)
"""x'' = -x with the energy h; A' = i omega A + B, B' = i omega B + (a (h - LEVEL) + b |A|^2) A, in x1 - y1^2/4 + i y1
and y2 + i x2. The half return takes the time pi: lambda = exp(2 pi i omega), and in the coordinate A the a and b of
section 31 are those of the system times 4 pi^2."""


def clock(omega: str = "3/10", a: str = "1", b: str = "1/2", **changes: Any) -> Candidate:
    """The claim that multipliers collide on the level LEVEL, with A = B = 0."""
    parameters: Mapping[str, Fraction] = {"omega": Fraction(omega), "a": Fraction(a), "b": Fraction(b)}
    radius = Fraction(1, 2**60)
    unit = tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3))
    arguments: dict[str, Any] = {
        "id": "clock",
        "system": CLOCK,
        "parameters": parameters,
        "kind": KREIN_COLLISION,
        "k": 1,
        "centre": (LEVEL + radius / 4, radius / 8, -radius / 8),
        "frame": unit,
        "kernel_frame": tuple(row[:2] for row in unit[:2]),
        "radii": (radius,) * 3,
        "level_sign": 1,
    }
    return Candidate(**{**arguments, **changes})


def halo() -> Candidate:
    """The claim about the halo orbits of L1 in the Earth-Moon system."""
    path = DATA / "krein-collision.json"
    return candidate_from_json(json.loads(path.read_text(encoding="utf-8")), path.name)


def _coupled(s: Any, p: Any) -> Any:
    x, u1, u2, v, v1, v2 = s
    c, g, k, m = p
    detuning = x**2 + v**2 - LEVEL
    return v, v1, v2, -x, c * u1 + (k + m * detuning) * u2, c * u2 + detuning * u1 + g * u1**3


COUPLED = ReversibleSystem(
    name="coupled",
    title="clock beside two coupled springs",
    state=("x", "u1", "u2", "v", "v1", "v2"),
    parameters={name: ParameterRange(None, None) for name in ("c", "g", "k", "m")},
    vector_field=_coupled,
    reversing_symmetry=(1, 1, 1, -1, -1, -1),
    section="v",
    first_integral=lambda s, p: (s[0] ** 2 + s[3] ** 2,),
    first_integral_name="energy of the clock",
    level_coordinate="x",
)
"""u1'' = c u1 + u2, u2'' = c u2 + (h - LEVEL) u1 + g u1^3 for k = 1, m = 0. With c = - omega^2 the solution u1 = z
exp(i omega t) + conj, u2 = 0 of the linear part puts 3 g z |z|^2 exp(i omega t) into u2: z'' = - (h - LEVEL + 3 g
|z|^2) z/(4 omega^2) slowly. For k = 0, m = 1 Sigma is a multiple of 1 at the collision."""


def coupled(c: str, g: str = "1/2", k: str = "1", m: str = "0", **changes: Any) -> Candidate:
    """The claim that the multipliers of the two springs collide on the level LEVEL, where these are at rest."""
    parameters = {name: Fraction(text) for name, text in (("c", c), ("g", g), ("k", k), ("m", m))}
    return replace(clock(), id="coupled", system=COUPLED, parameters=parameters, **changes)


def _still(s: Any, p: Any) -> Any:
    return s[3], s[4], s[0], s[0], s[1]


FAMILY = ReversibleSystem(
    name="family",
    title="any family of maps",
    state=("x1", "x2", "v", "y1", "y2"),
    parameters={"h": ParameterRange(None, None)},
    vector_field=_still,
    reversing_symmetry=(1, 1, -1, -1, -1),
    section="v",
    family_parameter="h",
)
"""Its half returns do not count: proofs are given those of `known_half`."""


def of_family(**changes: Any) -> Candidate:
    """The claim that multipliers collide at h = x1 = x2 = 0."""
    claim = replace(clock(), id="family", system=FAMILY, parameters={}, level_sign=None, centre=(Fraction(0),) * 3)
    return replace(claim, **changes)


Exponents = tuple[int, ...]
Polynomial = dict[Exponents, Fraction]
"""In (h, p_1, p_2, q_1, q_2), up to degree 3."""
Complex = tuple[Polynomial, Polynomial]
VARIABLES, MOST = 5, 3


@dataclass(frozen=True)
class KnownHalf:
    """A half return f(h, p, q), a polynomial with P(0) = 0, at which multipliers collide for h = 0.

    Attributes:
        components: the p and the q of the image.
        cosine: s.
        unfolding, coefficient: a and b in the coordinates z of section 31.3.
        direction: 2 Re v, in (p, q).
    """

    components: tuple[Polynomial, ...]
    cosine: Fraction
    unfolding: Fraction
    coefficient: Fraction
    direction: tuple[Fraction, ...]

    def enclosures(self, radius: Fraction = Fraction(1, 2**60), moved: Fraction = Fraction(0)) -> BreakingEnclosures:
        """What an integration would give about the point with h = p = -moved."""
        with guarded(192):
            return self._enclosures(radius, moved)

    def _enclosures(self, radius: Fraction, moved: Fraction) -> BreakingEnclosures:
        sides = [symmetric(radius)] * VARIABLES
        origin = [enclose(-moved)] * 3 + [arb(0)] * 2

        def table(function: Polynomial) -> DerivativeTable:
            indices = indices_up_to(VARIABLES, MOST)
            there = [middle + side for middle, side in zip(origin, sides, strict=True)]
            return DerivativeTable(
                {index: _derivative(function, index, there) for index in indices},
                {index: _derivative(function, index, origin) for index in indices},
            )

        time = {(0,) * VARIABLES: Fraction(1)}
        image, kernel = self.components[:2], self.components[2:]
        return BreakingEnclosures((tuple(map(table, kernel)),), tuple(map(table, image)), table(time), ())

    def full(self, u: Any) -> Any:
        """F(u) = R f^-1 R f(u) at h = 0 in double precision."""
        signs = np.array([1.0, 1.0, -1.0, -1.0])
        wanted = signs * self._value(u)
        there = signs * np.asarray(u)
        for _ in range(4):
            there = there - np.linalg.solve(self._slope(there), self._value(there) - wanted)
        return signs * there

    @cached_property
    def _floats(self) -> list[tuple[Any, Any]]:
        terms = [[(i[1:], float(c)) for i, c in each.items() if not i[0]] for each in self.components]
        return [(np.array([i for i, _ in each]), np.array([c for _, c in each])) for each in terms]

    def _value(self, u: Any) -> Any:
        return np.array([np.dot(c, np.prod(np.asarray(u) ** i, axis=1)) for i, c in self._floats])

    def _slope(self, u: Any) -> Any:
        rows = np.empty((4, 4))
        for row, (exponents, c) in enumerate(self._floats):
            for j in range(4):
                less = exponents.copy()
                less[:, j] = np.maximum(less[:, j] - 1, 0)
                rows[row, j] = np.dot(c * exponents[:, j], np.prod(np.asarray(u) ** less, axis=1))
        return rows


def known_half(seed: int, sign: int = 0, bend: Fraction = Fraction(1)) -> KnownHalf:
    """T o f o phi: z -> mu (z + y/2 + ..), y -> mu (y + alpha h z + beta z |z|^2 + ..), T and phi commute with R.

    Then F = phi^-1 (R f^-1 R f) phi, lambda = mu^2, a = 2 Re alpha, and b = 2 Re beta for z along (1, 0, ..).

    Args:
        sign: of b, if it is asked for.
        bend: factor of the terms of degree 2 and 3 of T and phi.
    """
    chance = random.Random(seed)
    real, imaginary, length = chance.choice([(3, 4, 5), (-4, 3, 5), (5, 12, 13), (12, -5, 13), (-24, 7, 25)])
    mu = Fraction(real, length), Fraction(imaginary, length)
    alpha, beta = ((_number(chance), _number(chance)) for _ in range(2))
    if sign:
        beta = abs(beta[0]) * sign, beta[1]
    h, p1, p2, q1, q2 = (_variable(place) for place in range(VARIABLES))
    z, y = (p1, q1), (q2, p2)
    size: Complex = _plus(_times(p1, p1), _times(q1, q1)), {}
    first = _sum(z, _by(y, (Fraction(1, 2), Fraction(0))), _by(_product((h, {}), z), _pair(chance)))
    first = _sum(first, _by(_product(size, z), _pair(chance)), _by(_product((h, {}), y), _pair(chance)))
    second = _sum(y, _by(_product((h, {}), z), alpha), _by(_product(size, z), beta))
    second = _sum(second, _by(_product((h, {}), y), _pair(chance)), _by(_product(size, y), _pair(chance)))
    (x1, y1), (y2, x2) = _by(first, mu), _by(second, mu)
    before, after = _commuting(chance, bend), _commuting(chance, bend)
    half = [_composed(each, [h, *before]) for each in (x1, x2, y1, y2)]
    components = tuple(_composed(each, [h, *half]) for each in after)
    # The columns of D phi^-1 for p_1 and q_2, of which v is half the first less i times what belongs to it.
    rows = [[each.get(unit(place), Fraction(0)) for place in (1, 2)] for each in before[:2]]
    determinant = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    a = rows[1][1] / determinant / 2, -rows[1][0] / determinant / 2
    square = a[0] ** 2 + a[1] ** 2
    return KnownHalf(
        components,
        mu[0] ** 2 - mu[1] ** 2,
        2 * alpha[0],
        2 * beta[0] / square,
        (2 * a[0], 2 * a[1], Fraction(0), Fraction(0)),
    )


def _commuting(chance: random.Random, bend: Fraction) -> list[Polynomial]:
    """Near a linear map, p even and q odd in q."""
    found = []
    for row in range(4):
        terms = {}
        for index in _indices(VARIABLES, MOST):
            odd = (index[3] + index[4]) % 2 == 1
            if sum(index) and odd == (row > 1) and (sum(index) == 1 or chance.random() < 0.4):
                size = Fraction(1) if sum(index) == 1 else bend
                terms[index] = size * Fraction(chance.randint(-3, 3), 4)
        terms[unit(1 + row)] = Fraction(2)
        found.append(terms)
    return found


def _derivative(function: Polynomial, index: Exponents, at: list[arb]) -> arb:
    found = arb(0)
    for exponents, coefficient in function.items():
        if all(e >= i for e, i in zip(exponents, index, strict=True)):
            term = enclose(coefficient)
            for x, e, i in zip(at, exponents, index, strict=True):
                for _ in range(e - i):
                    term = term * x
                term = term * prod(range(e - i + 1, e + 1))
            found += term
    return found


def _number(chance: random.Random) -> Fraction:
    return Fraction(chance.choice([-1, 1]) * chance.randint(2, 9), 4)


def _pair(chance: random.Random) -> tuple[Fraction, Fraction]:
    return _number(chance), _number(chance)


def _indices(variables: int, degree: int) -> Iterator[Exponents]:
    for index in product(range(degree + 1), repeat=variables):
        if sum(index) <= degree:
            yield index


def unit(place: int) -> Exponents:
    """Of a linear term."""
    return tuple(int(i == place) for i in range(VARIABLES))


def _variable(place: int) -> Polynomial:
    return {unit(place): Fraction(1)}


def _plus(*terms: Polynomial) -> Polynomial:
    result: Polynomial = {}
    for each in terms:
        for index, value in each.items():
            result[index] = result.get(index, Fraction(0)) + value
    return result


def _scaled(polynomial: Polynomial, factor: Fraction) -> Polynomial:
    return {index: value * factor for index, value in polynomial.items()}


def _times(left: Polynomial, right: Polynomial) -> Polynomial:
    result: Polynomial = {}
    terms = sorted(((sum(b), b, y) for b, y in right.items()), key=itemgetter(0))
    for a, x in left.items():
        rest = MOST - sum(a)
        for degree, b, y in terms:
            if degree > rest:
                break
            index = tuple(map(add, a, b))
            result[index] = result.get(index, 0) + x * y
    return result


def _composed(outer: Polynomial, inner: Sequence[Polynomial]) -> Polynomial:
    @cache
    def monomial(index: Exponents) -> Polynomial:
        place = next((place for place, power in enumerate(index) if power), None)
        if place is None:
            return {index: Fraction(1)}
        return _times(monomial(tuple(map(sub, index, unit(place)))), inner[place])

    return _plus(*(_scaled(monomial(index), factor) for index, factor in outer.items()))


def _sum(*terms: Complex) -> Complex:
    return _plus(*(each[0] for each in terms)), _plus(*(each[1] for each in terms))


def _product(left: Complex, right: Complex) -> Complex:
    return (
        _plus(_times(left[0], right[0]), _scaled(_times(left[1], right[1]), Fraction(-1))),
        _plus(_times(left[0], right[1]), _times(left[1], right[0])),
    )


def _by(polynomial: Complex, factor: tuple[Fraction, Fraction]) -> Complex:
    constant = (0,) * VARIABLES
    return _product(polynomial, ({constant: factor[0]}, {constant: factor[1]}))
