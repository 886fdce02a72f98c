"""The full return at a point of a symmetric orbit, on its level or at its parameter, as jets (section 19.8)."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat

from orbitproof.shared.formats import Candidate
from orbitproof.verify.evidence import MAX_ORDER, enclose, indices_of_degree, indices_up_to
from orbitproof.verify.newton import Jet, compose, derivatives_of, implicit_jets
from orbitproof.verify.newton.jets import unit
from orbitproof.verify.poincare import Derivatives, HalfReturn, named


def half_return_jets(candidate: Candidate, half: HalfReturn) -> tuple[Jet, ...]:
    """Jets of the half return at fixed level of the first integral, or at fixed family parameter.

    Variables are those of the p but one, in order, then the q; components the coordinates of the image on Fix(R) but
    one, then its q. They are jets at every point of the box, in particular at the point of the orbit.

    Raises `ZeroDivisionError` where the level is not shown to have such coordinates, `ValueError` for enclosures of
    another claim.
    """
    size = len(candidate.radii)
    variables = 2 * size - 1
    images = [named(row, variables) for row in half.image]
    increments = jets_on_level(candidate, half)
    jets = [compose(image, increments) for image in images]
    return _best(jets, size)


def jets_on_level(candidate: Candidate, half: HalfReturn) -> list[Jet]:
    """Jets of all (p, q), less their values at the base point, on the level, in the variables of `half_return_jets`.

    Raises as that does.
    """
    size = len(candidate.radii)
    return _along_level(_kept(candidate, half, 2 * size - 1), size)


def full_return_jets(half: Sequence[Jet]) -> tuple[Jet, ...]:
    """Jets of F = R P^-1 R P at a point of Fix(R), from those of P, the half return in coordinates (p, q) on the level.

    R negates the q, the second half of the coordinates, at both points of the orbit on Fix(R). Raises
    `ZeroDivisionError` where the derivative of P is not shown to be regular.
    """
    inverse = _mirrored(inverse_jets(half))
    return tuple(compose(derivatives_of(jet), _mirrored([_centred(each) for each in half])) for jet in inverse)


def _mirrored(jets: Sequence[Jet]) -> list[Jet]:
    """R after the map."""
    n = len(jets) // 2
    return [*jets[:n], *(jet.scaled(arb(-1)) for jet in jets[n:])]


def _centred(jet: Jet) -> Jet:
    return Jet(jet.variables, jet.order, {index: value for index, value in jet.coefficients.items() if any(index)})


def _kept(candidate: Candidate, half: HalfReturn, variables: int) -> Derivatives:
    """Derivatives by (p, q) of what the half return keeps: the first integral, or the family parameter."""
    if candidate.system.family_parameter is None and half.first_integral is not None:
        return named(half.first_integral, variables)
    slopes = [enclose(value) for value in candidate.frame[0]]
    indices = indices_up_to(variables, MAX_ORDER)
    rest = {unit(variables, j): slope for j, slope in enumerate(slopes)}
    return {index: rest.get(index, arb(0)) for index in indices}


def _along_level(kept: Derivatives, size: int) -> list[Jet]:
    """Jets of the (p, q) on the level, by the p but that on which it depends most, and the q."""
    variables = 2 * size - 1
    pivot = max(range(size), key=lambda j: float(abs(kept[unit(variables, j)].mid())))
    order = [*(j for j in range(variables) if j != pivot), pivot]
    moved = {tuple(index[j] for j in order): value for index, value in kept.items()}
    jets = implicit_jets([moved], variables - 1, MAX_ORDER)
    return [jets[order.index(j)] for j in range(variables)]


def _best(jets: Sequence[Jet], size: int) -> tuple[Jet, ...]:
    """Without the one of the first `size` components without which the derivative is farthest from singular."""

    def determinant(dropped: int) -> float:
        rows = [jet for i, jet in enumerate(jets) if i != dropped]
        matrix = arb_mat([[jet[unit(len(rows), j)] for j in range(len(rows))] for jet in rows])
        return float(abs(matrix.mid().det().mid()))

    dropped = max(range(size), key=determinant)
    return tuple(jet for i, jet in enumerate(jets) if i != dropped)


def inverse_jets(jets: Sequence[Jet]) -> tuple[Jet, ...]:
    """Jets of the inverse of a map with the value 0 at 0, given jets of its components, as many as there are variables.

    Degree by degree, the unknown coefficients solve a linear system with the derivative of the map (differentiation of
    f(g(v)) = v). Constant terms of the jets are not used. Raises `ZeroDivisionError` if the derivative is not shown to
    be regular.
    """
    size, order = len(jets), jets[0].order
    matrix = arb_mat([[jet[unit(size, j)] for j in range(size)] for jet in jets])
    functions = [derivatives_of(jet) for jet in jets]
    unknown = [Jet(size, order, {}) for _ in range(size)]
    for degree in range(1, order + 1):
        images = [compose(function, unknown) for function in functions]
        for index in indices_of_degree(size, degree):
            wanted = [int(index == unit(size, i)) - image[index] for i, image in enumerate(images)]
            solution = matrix.solve(arb_mat([[value] for value in wanted]))
            unknown = [Jet(size, order, {**jet.coefficients, index: solution[i, 0]}) for i, jet in enumerate(unknown)]
    return tuple(unknown)
