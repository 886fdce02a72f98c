"""Maps with a known bifurcation: normal forms in other coordinates, exactly."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial, prod

Exponents = tuple[int, ...]
Polynomial = Mapping[Exponents, Fraction]
"""In (p_0, .., p_{n-1}, a), up to total degree 3."""

MOST = 3


@dataclass(frozen=True)
class KnownTorus:
    """A map with the fixed point 0 at a = 0, its pair of eigenvalues on the circle, and its coefficients.

    Attributes:
        derivatives: for each component, by multi-index in (p, a).
        multiplier: cosine and sine.
        eigenvector: real and imaginary part, in the normalisation of `lyapunov`.
        lyapunov, speed: Re(conj(lambda) c_1), and the derivative of the absolute value of the multiplier.
        others: the other eigenvalues.
    """

    derivatives: tuple[dict[Exponents, Fraction], ...]
    multiplier: tuple[Fraction, Fraction]
    eigenvector: tuple[tuple[Fraction, ...], tuple[Fraction, ...]]
    lyapunov: Fraction
    speed: Fraction
    others: tuple[Fraction, ...]


OFF_THE_CIRCLE = (Fraction(1, 2), Fraction(-1, 3), Fraction(2), Fraction(-3, 2), Fraction(0))


def known_torus(size: int, chance: random.Random, others: tuple[Fraction, ...] | None = None) -> KnownTorus:
    """z -> lambda z (1 + (r + i t) a + (d + i e) |z|^2), further coordinates, in random coordinates.

    The plane of z is invariant, and the terms that are added vanish on it. The other eigenvalues are `others`, or some
    off the circle.
    """
    cosine, sine = chance.choice([(3, 4), (-3, 4), (4, 3), (-4, -3), (5, 12), (-12, 5), (-7, 24)])
    length = {3: 5, 4: 5, 5: 13, 12: 13, 7: 25}[abs(cosine)]
    c, s = Fraction(cosine, length), Fraction(sine, length)
    r, t, d, e = (_number(chance) for _ in range(4))
    variables = [_variable(size, place) for place in range(size + 1)]
    x, y, a = variables[0], variables[1], variables[size]
    square = _plus(_times(x, x), _times(y, y))
    growing = _plus(_plus(_constant(size, Fraction(1)), _scaled(a, r)), _scaled(square, d))
    turning = _plus(_scaled(a, t), _scaled(square, e))
    real = _minus(_times(x, growing), _times(y, turning))
    imaginary = _plus(_times(y, growing), _times(x, turning))
    components = [
        _minus(_scaled(real, c), _scaled(imaginary, s)),
        _plus(_scaled(real, s), _scaled(imaginary, c)),
    ]
    others = others or tuple(chance.choice(OFF_THE_CIRCLE) for _ in range(2, size))
    components += [_scaled(variables[place], value) for place, value in enumerate(others, start=2)]
    for place in range(size):
        for other in range(2, size):
            terms = _random(size, chance, 1, 2)
            components[place] = _plus(components[place], _times(variables[other], terms))
    moved, columns, _ = _in_other_coordinates(components, chance)
    return KnownTorus(
        tuple(map(_derivatives, moved)),
        (c, s),
        (tuple(value / 2 for value in columns[0]), tuple(-value / 2 for value in columns[1])),
        d,
        r,
        others,
    )


@dataclass(frozen=True)
class KnownBifurcation:
    """A map with the fixed point 0 at a = 0 and the eigenvalue 1 or -1, and what branches off.

    Attributes:
        derivatives: for each component, by multi-index in (p, a).
        eigenvector: w.
        opening: a = opening y^2 along the new points, p = +- y w.
        speed, bend: of the terms a y (fold: a) and y^3 (fold: y^2) in the coordinate y of the normal form.
        others: the other eigenvalues, without that of the levels.
        integral: the function that the map leaves alone, a polynomial in (p, a); `None` without one.
    """

    derivatives: tuple[dict[Exponents, Fraction], ...]
    eigenvector: tuple[Fraction, ...]
    opening: Fraction
    speed: Fraction
    bend: Fraction
    others: tuple[Fraction, ...]
    integral: Polynomial | None


def known_bifurcation(
    sigma: int,
    size: int,
    chance: random.Random,
    on_level: bool = False,
    level_varies: bool = False,
    signs: tuple[int, ...] | None = None,
    others: tuple[Fraction, ...] | None = None,
) -> KnownBifurcation:
    """y -> y + r a + d y^2 or y -> -y + r a y + b y^2 + c y^3, further coordinates, in random coordinates.

    On a level the last coordinate is left alone, and stands for a where the level varies. With signs the map and the
    change of coordinates respect the changes of sign of the coordinates.
    """
    r, b, c = (_number(chance) for _ in range(3))
    if signs is not None:
        b = Fraction(0)
    variables = [_variable(size, place) for place in range(size + 1)]
    y, a = variables[0], variables[size - 1 if level_varies else size]
    square = _times(y, y)
    if sigma == 1:
        first = _plus(_plus(y, _scaled(a, r)), _plus(_scaled(square, c), _scaled(_times(a, y), b)))
        bend = c
    else:
        cubic = _scaled(_times(square, y), c)
        first = _plus(_plus(_scaled(y, Fraction(-1)), _scaled(_times(a, y), r)), _plus(_scaled(square, b), cubic))
        bend = b * b + c
    last = size - on_level
    others = others or tuple(chance.choice(OFF_THE_CIRCLE) for _ in range(1, last))
    components = [first, *(_scaled(variables[place], value) for place, value in enumerate(others, start=1))]
    for place in range(last):
        for other in range(1, last):
            terms = _random(size, chance, 1, 2)
            components[place] = _plus(components[place], _times(variables[other], terms))
    if on_level:
        components.append(variables[last])
    if level_varies:
        components = [_without_parameter(each) for each in components]
    if signs is not None:
        components = [_respecting(each, signs, place) for place, each in enumerate(components)]
    moved, columns, back = _in_other_coordinates(components, chance, signs, not level_varies)
    return KnownBifurcation(
        tuple(map(_derivatives, moved)), tuple(columns[0]), -bend / r, r, bend, others, back[last] if on_level else None
    )


def _without_parameter(polynomial: Polynomial) -> Polynomial:
    return {index: value for index, value in polynomial.items() if not index[-1]}


def _respecting(polynomial: Polynomial, signs: tuple[int, ...], place: int) -> Polynomial:
    """The terms that the changes of sign of p turn as they turn coordinate `place`."""
    return {
        index: value
        for index, value in polynomial.items()
        if prod(sign**power for sign, power in zip(signs, index, strict=False)) == signs[place]
    }


def _in_other_coordinates(
    components: Sequence[Polynomial],
    chance: random.Random,
    signs: tuple[int, ...] | None = None,
    with_parameter: bool = True,
) -> tuple[list[Polynomial], list[list[Fraction]], list[Polynomial]]:
    """A map in random coordinates, their first derivatives in the old ones at 0, and the old ones in them."""
    size = len(components)
    a = _variable(size, size)
    linear, bent = _linear(size, chance), [_random(size, chance, 2, MOST) for _ in range(size)]
    if not with_parameter:
        linear, bent = (list(map(_without_parameter, part)) for part in (linear, bent))
    if signs is not None:
        linear, bent = ([_respecting(each, signs, i) for i, each in enumerate(part)] for part in (linear, bent))
        linear = [{_unit(size, i): each[_unit(size, i)]} for i, each in enumerate(linear)]
    near = [_plus(_variable(size, place), each) for place, each in enumerate(bent)]
    change = _composed(linear, [*near, a])
    back = _composed(_near_inverse(bent), [*_linear_inverse(linear), a])
    assert _composed(change, [*back, a]) == [_variable(size, place) for place in range(size)]
    moved = _composed(change, [*_composed(components, [*back, a]), a])
    columns = [[polynomial.get(_unit(size, j), Fraction(0)) for polynomial in change] for j in range(size)]
    return moved, columns, back


def _derivatives(polynomial: Polynomial) -> dict[Exponents, Fraction]:
    return {index: value * prod(map(factorial, index)) for index, value in polynomial.items()}


def seen_from(derivatives: Sequence[Polynomial], origin: Sequence[Fraction]) -> tuple[dict[Exponents, Fraction], ...]:
    """The derivatives of a map of degree 3 about another point (p, a), in coordinates that are 0 there."""
    moved = [derivatives_at(each, origin) for each in derivatives]
    for each, value in zip(moved, origin, strict=False):
        each[(0,) * len(origin)] -= value
    return tuple(moved)


def derivatives_at(derivatives: Polynomial, origin: Sequence[Fraction]) -> dict[Exponents, Fraction]:
    """Those of a function of degree 3 at another point, from those at 0."""
    found = {}
    for index in _indices(len(origin), MOST):
        value = Fraction(0)
        for shift in _indices(len(origin), MOST - sum(index)):
            there = tuple(i + j for i, j in zip(index, shift, strict=True))
            powers = prod((x**power for x, power in zip(origin, shift, strict=True)), start=Fraction(1))
            value += derivatives.get(there, Fraction(0)) * powers / prod(map(factorial, shift))
        found[index] = value
    return found


def _number(chance: random.Random) -> Fraction:
    return Fraction(chance.choice([-1, 1]) * chance.randint(1, 9), chance.randint(1, 4))


def _random(size: int, chance: random.Random, least: int, most: int) -> dict[Exponents, Fraction]:
    return {
        index: Fraction(chance.randint(-4, 4), 2)
        for index in _indices(size + 1, most)
        if least <= sum(index) and chance.random() < 0.6
    }


def _linear(size: int, chance: random.Random) -> list[Polynomial]:
    """Linear functions of p and a, of triangular form: the fixed point moves with the parameter."""
    rows = list[Polynomial]()
    for place in range(size):
        row = {_unit(size, j): Fraction(chance.randint(-2, 2)) for j in range(place)}
        row[_unit(size, place)] = Fraction(chance.choice([-2, -1, 1, 2]))
        row[_unit(size, size)] = Fraction(chance.randint(-3, 3))
        rows.append(row)
    return rows


def _linear_inverse(rows: Sequence[Polynomial]) -> list[Polynomial]:
    size, found = len(rows), list[Polynomial]()
    for place, row in enumerate(rows):
        rest = _minus(_variable(size, place), _scaled(_variable(size, size), row.get(_unit(size, size), Fraction(0))))
        for j, known in enumerate(found):
            rest = _minus(rest, _scaled(known, row.get(_unit(size, j), Fraction(0))))
        found.append(_scaled(rest, 1 / row[_unit(size, place)]))
    return found


def _near_inverse(bent: Sequence[Polynomial]) -> list[Polynomial]:
    """The p with p + bent(p, a) = q as polynomials in (q, a): each iteration makes one more degree right."""
    size = len(bent)
    found = [_variable(size, place) for place in range(size)]
    for _ in range(2, MOST + 1):
        values = _composed(bent, [*found, _variable(size, size)])
        found = [_minus(_variable(size, place), value) for place, value in enumerate(values)]
    return found


def _composed(outer: Sequence[Polynomial], inner: Sequence[Polynomial]) -> list[Polynomial]:
    size = len(inner) - 1
    products = {(0,) * (size + 1): _constant(size, Fraction(1))}

    def product(powers: Exponents) -> Polynomial:
        if powers not in products:
            place = next(place for place, power in enumerate(powers) if power)
            fewer = tuple(power - (i == place) for i, power in enumerate(powers))
            products[powers] = _times(product(fewer), inner[place])
        return products[powers]

    result = []
    for each in outer:
        value: dict[Exponents, Fraction] = {}
        for powers, factor in each.items():
            for index, term in product(powers).items():
                value[index] = value.get(index, Fraction(0)) + factor * term
        result.append({index: term for index, term in value.items() if term})
    return result


def _indices(variables: int, degree: int) -> Iterator[Exponents]:
    if variables == 0:
        yield ()
        return
    for first in range(degree + 1):
        for rest in _indices(variables - 1, degree - first):
            yield (first, *rest)


def _unit(size: int, place: int) -> Exponents:
    return tuple(int(i == place) for i in range(size + 1))


def _variable(size: int, place: int) -> Polynomial:
    return {_unit(size, place): Fraction(1)}


def _constant(size: int, value: Fraction) -> Polynomial:
    return {(0,) * (size + 1): value}


def _plus(left: Polynomial, right: Polynomial) -> Polynomial:
    """The sum, without terms that are 0."""
    sums = {index: left.get(index, Fraction(0)) + right.get(index, Fraction(0)) for index in {**left, **right}}
    return {index: value for index, value in sums.items() if value}


def _minus(left: Polynomial, right: Polynomial) -> Polynomial:
    return _plus(left, _scaled(right, Fraction(-1)))


def _scaled(polynomial: Polynomial, factor: Fraction) -> Polynomial:
    return {index: value * factor for index, value in polynomial.items()}


def _times(left: Polynomial, right: Polynomial) -> Polynomial:
    result: dict[Exponents, Fraction] = {}
    for a, x in left.items():
        for b, y in right.items():
            if sum(a) + sum(b) <= MOST and x and y:
                index = tuple(i + j for i, j in zip(a, b, strict=True))
                result[index] = result.get(index, Fraction(0)) + x * y
    return result
