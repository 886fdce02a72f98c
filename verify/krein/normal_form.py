"""The coefficient of order 3 at a double pair of multipliers with one Jordan block (sections 31.3 and 31.4)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import acb, acb_mat, arb

from orbitproof.verify.evidence import MultiIndex, dot
from orbitproof.verify.newton import Jet
from orbitproof.verify.newton.jets import unit
from orbitproof.verify.tori.normal_form import substituted

_SIZE = 4
_SQUARE, _MIXED, _CONJUGATE, _CUBIC = (2, 0), (1, 1), (0, 2), (2, 1)
"""z^2, z conj z, (conj z)^2 and z |z|^2 by the exponents of z and its conjugate."""


def cubic_coefficient(jets: Sequence[Jet], cosine: arb) -> acb:
    """b of a reversible map from its jets, at which Sigma has the double eigenvalue `cosine` in (-1, 1) (Lemma 31.3).

    Raises `ZeroDivisionError` where Sigma is not shown to be no multiple of 1, or lambda^k may be 1 for k = 1 or 3.
    """
    m = [[jet[unit(_SIZE, j)] for j in range(_SIZE)] for jet in jets]
    sine = (1 - cosine * cosine).sqrt()
    multiplier = acb(cosine, sine)
    nilpotent = [[m[i][j] - (cosine if i == j else 0) for j in range(2)] for i in range(2)]
    row = max((0, 1), key=lambda i: float(abs(nilpotent[i][1 - i].mid())))
    column = 1 - row
    image = [nilpotent[0][column], nilpotent[1][column]]
    length = (image[0] * image[0] + image[1] * image[1]).sqrt()
    a = [value / length for value in image]
    right = [acb(a[0]), acb(a[1]), *(acb(0, -dot(m[i][:2], a) / sine) for i in (2, 3))]
    covector = nilpotent[row]
    left = [acb(covector[0]), acb(covector[1])]
    left += [acb(0, -dot(covector, [m[0][j], m[1][j]]) / sine) for j in (2, 3)]
    cubic = _cubic_part(jets, m, right, multiplier)
    scale = 2 * acb(0, 1) * nilpotent[row][column] * sine
    return multiplier.conjugate() * length * _dot(left, cubic) / scale


def _cubic_part(jets: Sequence[Jet], m: list[list[arb]], right: Sequence[acb], multiplier: acb) -> list[acb]:
    """The coefficient of z |z|^2 in F(z v + conj(z v) + H(z v + conj(z v))), H as in Lemma 31.3."""
    functions = [{index: acb(value) for index, value in jet.coefficients.items() if any(index)} for jet in jets]
    plane: list[dict[MultiIndex, acb]] = [{(1, 0): value, (0, 1): value.conjugate()} for value in right]
    squares = [substituted(function, plane) for function in functions]
    conjugate = multiplier.conjugate()
    factors = {_SQUARE: multiplier * multiplier, _MIXED: acb(1), _CONJUGATE: conjugate * conjugate}
    bent = {index: _solved(m, factor, [_at(each, index) for each in squares]) for index, factor in factors.items()}
    curved = [{**linear, **{index: bent[index][i] for index in factors}} for i, linear in enumerate(plane)]
    return [_at(substituted(function, curved), _CUBIC) for function in functions]


def _solved(m: list[list[arb]], factor: acb, right: Sequence[acb]) -> list[acb]:
    """The h with (factor - M) h = right."""
    shifted = [[(factor if i == j else acb(0)) - m[i][j] for j in range(_SIZE)] for i in range(_SIZE)]
    solution = acb_mat(shifted).solve(acb_mat([[value] for value in right]))
    return [solution[i, 0] for i in range(_SIZE)]


def _dot(left: Sequence[acb], right: Sequence[acb]) -> acb:
    result = acb(0)
    for x, y in zip(left, right, strict=True):
        result = result + x * y
    return result


def _at(polynomial: Mapping[MultiIndex, acb], index: MultiIndex) -> acb:
    return polynomial.get(index, acb(0))
