"""The equations of a bifurcation of periodic orbits with many digits: the orbit, its parameter and an eigenvector.

The point is x(p) = c + A p in a section, with S phi_T(x) = x, where S is the identity or a symmetry, T the time of the
return and a the parameter or the level. An eigenvector w of the return map, in the coordinates p, solves
S (D phi_T A w + t f) = sigma A w with some time t, sigma = 1 at a fold and -1 at a doubling or pitchfork; at a torus
two vectors u, v solve it for u + i v and cos + i sin. With a first integral there are more equations than unknowns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from orbitproof.explore.numerics import Linearised, mpf
from orbitproof.explore.periodic.refinement import evaluated, flow_jets, whole_jets
from orbitproof.explore.periodic.symmetries import Symmetry
from orbitproof.explore.refinement import Jet, JetBasis
from orbitproof.shared.systems import System


@dataclass(frozen=True)
class ExtendedSystem:
    """What is solved for (p, T, a, w, t, ..): n = N - 1 numbers p; T; a; n numbers w and t for each vector; cos, sin.

    Attributes:
        parameters: all of the system's, exact; that of `name` is not used.
        name: of the parameter that varies; `None`: the level does.
        level: of the first integral, if it is used and does not vary; exact.
        centre, frame: c, shape (N,), and A, shape (N, n), exact.
        eigenvalue: sigma; `None` for a torus.
        weights: for each vector one of shape (n,), exact; the first with its vector gives 1.
    """

    system: System
    parameters: Mapping[str, Fraction]
    name: str | None
    level: Fraction | None
    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    symmetry: Symmetry | None
    eigenvalue: int | None
    weights: tuple[tuple[Fraction, ...], ...]

    @property
    def size(self) -> int:
        """n, the number of coordinates p."""
        return len(self.centre) - 1

    @property
    def vectors(self) -> int:
        """How many vectors the eigenvector has: 1, or 2 for its real and imaginary part."""
        return len(self.weights)

    def vector(self, unknowns: Sequence[Any], j: int) -> Sequence[Any]:
        """Vector number j."""
        first = self.size + 2 + j * (self.size + 1)
        return unknowns[first : first + self.size]

    def point(self, unknowns: Sequence[Fraction]) -> tuple[Fraction, ...]:
        """x(p)."""
        return tuple(c + d for c, d in zip(self.centre, _combined(self.frame, unknowns[: self.size]), strict=True))

    def linearised(self, unknowns: Sequence[Fraction], context: mpmath.MPContext) -> Linearised:
        """What is zero; the spread is the largest derivative of the flow, of order 1 or 2.

        Raises `IntegrationFailure`.
        """
        jets = _Jets(self, unknowns, context)
        equations = [*_return(self, unknowns, jets)]
        for j in range(self.vectors):
            equations += _eigenvector(self, unknowns, jets, j)
        equations += _normalised(self, unknowns, context)
        equations += _on_level(self, unknowns, jets)
        count = len(unknowns)
        rows = [[slopes.get(column, 0) for column in range(count)] for _, slopes in equations]
        return Linearised(context.matrix([value for value, _ in equations]), context.matrix(rows), jets.spread)


def _combined(frame: Sequence[Sequence[Fraction]], vector: Sequence[Fraction]) -> list[Fraction]:
    return [sum((a * w for a, w in zip(row, vector, strict=True)), Fraction(0)) for row in frame]


Equation = tuple[Any, dict[int, Any]]
"""What is zero, and its derivatives by number of the unknown."""


class _Jets:
    """The end of the orbit and what else is needed of it, as jets in p, the parameter and one variable per vector.

    Attributes:
        images: the vectors A w, exact.
        end, velocity: S phi_T and S f there, as jets.
        acceleration: S Df f there.
        integral: the first integral at the start, or `None`.
    """

    def __init__(self, system: ExtendedSystem, unknowns: Sequence[Fraction], context: mpmath.MPContext) -> None:
        n, varies = system.size, system.name is not None
        self.context = context
        self.parameter = n if varies else None
        first = n + varies
        count = first + system.vectors
        self.vectors = range(first, count)
        linear = JetBasis.graded((1,) * count, 1).monomials
        squares = (tuple(int(k == i) + int(k == j) for k in range(count)) for i in range(first) for j in self.vectors)
        self.basis = JetBasis.of([*linear, *squares])
        self.images = [
            [
                sum((a * w for a, w in zip(row, system.vector(unknowns, j), strict=True)), Fraction(0))
                for row in system.frame
            ]
            for j in range(system.vectors)
        ]
        start = []
        for i, value in enumerate(system.point(unknowns)):
            jet = self.basis.constant(value)
            for k in range(n):
                jet.coefficients[self.basis.variable(k)] = system.frame[i][k]
            for j, image in zip(self.vectors, self.images, strict=True):
                jet.coefficients[self.basis.variable(j)] = image[i]
            start.append(jet)
        fixed = dict(system.parameters)
        given: list[Any] = []
        if system.name is not None:
            del fixed[system.name]
            jet = self.basis.constant(unknowns[n + 1])
            jet.coefficients[self.basis.variable(n)] = Fraction(1)
            given.append(jet)
        flown = flow_jets(system.system, fixed, [*start, *given], unknowns[n], context)
        self.spread = max(float(abs(value)) for jet in flown for value in jet.coefficients[1:])
        values = [
            self._rounded(given[0]) if name == system.name else mpf(system.parameters[name], context)
            for name in system.system.parameters
        ]
        velocity = evaluated(system.system.program, [*flown, *values], context)
        velocity = [each if isinstance(each, Jet) else self.basis.constant(each) for each in velocity]
        in_time = JetBasis.graded((1,), 1)
        moving = [Jet(in_time, [x.coefficients[0], f.coefficients[0]]) for x, f in zip(flown, velocity, strict=True)]
        plain = [value.coefficients[0] if isinstance(value, Jet) else value for value in values]
        rates = evaluated(system.system.program, [*moving, *plain], context)
        acceleration = [each.coefficients[1] if isinstance(each, Jet) else 0 for each in rates]
        applied = list if system.symmetry is None else system.symmetry.applied
        own = slice(n + 1)
        self.end, self.velocity, self.acceleration = (
            applied(flown[own]),
            applied(velocity[own]),
            applied(acceleration[own]),
        )
        self.integral: Jet | None = None
        program = system.system.first_integral_program
        if program is not None and (system.level is not None or not varies):
            (self.integral,) = evaluated(
                program, [*whole_jets(system.system, start, values, context), *values], context
            )

    def _rounded(self, jet: Jet) -> Jet:
        return Jet(self.basis, [mpf(value, self.context) for value in jet.coefficients])

    def slope(self, jet: Jet, *variables: int) -> Any:
        """A derivative by different variables."""
        return jet.coefficients[self.basis.index[tuple(int(k in variables) for k in range(self.basis.variables))]]


def _return(system: ExtendedSystem, unknowns: Sequence[Fraction], jets: _Jets) -> list[Equation]:
    """S phi_T(x) = x."""
    n, equations = system.size, []
    for i, value in enumerate(system.point(unknowns)):
        slopes = {k: jets.slope(jets.end[i], k) - mpf(system.frame[i][k], jets.context) for k in range(n)}
        slopes[n] = jets.velocity[i].coefficients[0]
        if jets.parameter is not None:
            slopes[n + 1] = jets.slope(jets.end[i], jets.parameter)
        equations.append((jets.end[i].coefficients[0] - mpf(value, jets.context), slopes))
    return equations


def _eigenvector(system: ExtendedSystem, unknowns: Sequence[Fraction], jets: _Jets, j: int) -> list[Equation]:
    """S (D phi A w_j + t_j f) = the combination of A w that the eigenvalue says."""
    n, context, v = system.size, jets.context, jets.vectors[j]
    time = mpf(unknowns[2 * n + 2 + j * (n + 1)], context)
    if system.eigenvalue is not None:
        factors = [context.mpf(system.eigenvalue)]
    else:
        cosine, sine = (mpf(value, context) for value in unknowns[-2:])
        factors = [cosine, -sine] if j == 0 else [sine, cosine]
    images = [[mpf(value, context) for value in image] for image in jets.images]
    equations = []
    for i in range(n + 1):
        end, velocity = jets.end[i], jets.velocity[i]
        speed = velocity.coefficients[0]
        value = jets.slope(end, v) + speed * time - sum(f * image[i] for f, image in zip(factors, images, strict=True))
        slopes = {k: jets.slope(end, v, k) + jets.slope(velocity, k) * time for k in range(n)}
        slopes[n] = jets.slope(velocity, v) + jets.acceleration[i] * time
        if jets.parameter is not None:
            slopes[n + 1] = jets.slope(end, v, jets.parameter) + jets.slope(velocity, jets.parameter) * time
        for other, factor in enumerate(factors):
            for k in range(n):
                own = jets.slope(end, k) if other == j else 0
                place = n + 2 + other * (n + 1) + k
                slopes[place] = own - factor * mpf(system.frame[i][k], context)
        slopes[2 * n + 2 + j * (n + 1)] = speed
        if system.eigenvalue is None:
            slopes[len(unknowns) - 2] = -images[j][i]
            slopes[len(unknowns) - 1] = images[1][i] if j == 0 else -images[0][i]
        equations.append((value, slopes))
    return equations


def _normalised(system: ExtendedSystem, unknowns: Sequence[Fraction], context: mpmath.MPContext) -> list[Equation]:
    """<weights, w> = 1; for u + i v with weights (a, b): <a, u> + <b, v> = 1, <a, v> = <b, u>, cos^2 + sin^2 = 1."""
    n, weights = system.size, [[mpf(value, context) for value in row] for row in system.weights]
    vectors = [[mpf(value, context) for value in system.vector(unknowns, j)] for j in range(system.vectors)]
    places = [n + 2 + j * (n + 1) for j in range(system.vectors)]

    def product(pairs: Sequence[tuple[int, int, int]], goal: int) -> Equation:
        value = sum(
            sign * sum(a * w for a, w in zip(weights[left], vectors[right], strict=True)) for sign, left, right in pairs
        )
        slopes = {places[right] + k: sign * weights[left][k] for sign, left, right in pairs for k in range(n)}
        return value - goal, slopes

    if system.eigenvalue is not None:
        return [product([(1, 0, 0)], 1)]
    cosine, sine = (mpf(value, context) for value in unknowns[-2:])
    last = len(unknowns)
    circle = cosine * cosine + sine * sine - 1, {last - 2: 2 * cosine, last - 1: 2 * sine}
    return [product([(1, 0, 0), (1, 1, 1)], 1), product([(1, 0, 1), (-1, 1, 0)], 0), circle]


def _on_level(system: ExtendedSystem, unknowns: Sequence[Fraction], jets: _Jets) -> list[Equation]:
    """H(x) = level and dH A w = 0, where a first integral is used."""
    if jets.integral is None:
        return []
    n, integral, context = system.size, jets.integral, jets.context
    level = unknowns[n + 1] if system.level is None else system.level
    slopes = {k: jets.slope(integral, k) for k in range(n)}
    slopes[n + 1] = context.mpf(-1) if jets.parameter is None else jets.slope(integral, jets.parameter)
    equations: list[Equation] = [(integral.coefficients[0] - mpf(level, context), slopes)]
    for j, v in enumerate(jets.vectors):
        across = {k: jets.slope(integral, v, k) for k in range(n)}
        if jets.parameter is not None:
            across[n + 1] = jets.slope(integral, v, jets.parameter)
        for k in range(n):
            across[n + 2 + j * (n + 1) + k] = jets.slope(integral, k)
        equations.append((jets.slope(integral, v), across))
    return equations
