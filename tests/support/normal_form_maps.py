"""Maps with a known Neimark-Sacker bifurcation: normal forms in other coordinates, exactly."""

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
    """

    derivatives: tuple[dict[Exponents, Fraction], ...]
    multiplier: tuple[Fraction, Fraction]
    eigenvector: tuple[tuple[Fraction, ...], tuple[Fraction, ...]]
    lyapunov: Fraction
    speed: Fraction


def known_torus(size: int, chance: random.Random) -> KnownTorus:
    """z -> lambda z (1 + (r + i t) a + (d + i e) |z|^2), further coordinates off the circle, in random coordinates.

    The plane of z is invariant, and the terms that are added vanish on it.
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
    for place in range(2, size):
        eigenvalue = chance.choice([Fraction(1, 2), Fraction(-1, 3), Fraction(2), Fraction(-3, 2), Fraction(0)])
        components.append(_scaled(variables[place], eigenvalue))
    for place in range(size):
        for other in range(2, size):
            terms = _random(size, chance, 1, 2)
            components[place] = _plus(components[place], _times(variables[other], terms))
    change = _change(size, chance)
    back = _inverse(change)
    moved = _composed(change, [*_composed(components, [*back, a]), a])
    columns = [[polynomial.get(_unit(size, j), Fraction(0)) for polynomial in change] for j in range(2)]
    return KnownTorus(
        tuple({index: value * prod(map(factorial, index)) for index, value in each.items()} for each in moved),
        (c, s),
        (tuple(value / 2 for value in columns[0]), tuple(-value / 2 for value in columns[1])),
        d,
        r,
    )


def _number(chance: random.Random) -> Fraction:
    return Fraction(chance.choice([-1, 1]) * chance.randint(1, 9), chance.randint(1, 4))


def _random(size: int, chance: random.Random, least: int, most: int) -> dict[Exponents, Fraction]:
    return {
        index: Fraction(chance.randint(-4, 4), 2)
        for index in _indices(size + 1, most)
        if least <= sum(index) and chance.random() < 0.6
    }


def _change(size: int, chance: random.Random) -> list[Polynomial]:
    """Coordinates whose linear part is regular; the fixed point moves with the parameter."""
    change = []
    for place in range(size):
        linear = {_unit(size, j): Fraction(chance.randint(-2, 2)) for j in range(size) if j < place}
        linear[_unit(size, place)] = Fraction(chance.choice([-2, -1, 1, 2]))
        linear[_unit(size, size)] = Fraction(chance.randint(-3, 3))
        change.append(_plus(linear, _random(size, chance, 2, MOST)))
    return change


def _inverse(change: Sequence[Polynomial]) -> list[Polynomial]:
    """The p with change(p, a) = q, as polynomials in (q, a), by iteration degree by degree."""
    size = len(change)
    a = _variable(size, size)
    found: list[Polynomial] = [{} for _ in range(size)]
    for _ in range(MOST * (size + 1)):
        residual = [_minus(_variable(size, i), each) for i, each in enumerate(_composed(change, [*found, a]))]
        # The linear part is triangular: one row at a time.
        for i, each in enumerate(change):
            step = residual[i]
            found[i] = _plus(found[i], _scaled(step, 1 / each[_unit(size, i)]))
    rest = [_minus(_variable(size, i), each) for i, each in enumerate(_composed(change, [*found, a]))]
    assert not any(any(each.values()) for each in rest)
    return found


def _composed(outer: Sequence[Polynomial], inner: Sequence[Polynomial]) -> list[Polynomial]:
    size = len(inner) - 1
    result = []
    for each in outer:
        value: Polynomial = {}
        for index, factor in each.items():
            term = _constant(size, factor)
            for polynomial, power in zip(inner, index, strict=True):
                for _ in range(power):
                    term = _times(term, polynomial)
            value = _plus(value, term)
        result.append(value)
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
    return {index: left.get(index, Fraction(0)) + right.get(index, Fraction(0)) for index in {**left, **right}}


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
