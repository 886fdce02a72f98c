"""Random half maps with what the flow of a tube says of them, up to parts of it that are not known.

Half maps L with L u' = v' and L^-1 v' = u' are chosen at random, of as many coordinates as there are, along a random
curve in a random tube; the flow is replaced by what it encloses, which is one thing and is known up to another one.
At every place the matrices are multiplied and inverted in rational numbers.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction as Q
from itertools import combinations
from typing import Any

from flint import arb

from orbitproof.shared.claims import Piece
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.algebra import Series
from orbitproof.verify.curve import HalfReturn, PieceLimits
from orbitproof.verify.curve.equation import parameter_series, tube_points
from orbitproof.verify.functions import known_part
from orbitproof.verify.stability import TubeOfOrbits

LIMITS = PieceLimits(88, 20, 16)
UNKNOWN = Q(1, 2**24)
"""Size of a part of what the flow encloses that is not known."""

Polynomial = list[Q]
"""Coefficients of 1, sigma, .."""
Matrix = list[list[Q]]


def at(row: Polynomial, place: Q) -> Q:
    return sum((c * place**n for n, c in enumerate(row)), Q(0))


def slope_at(row: Polynomial, place: Q) -> Q:
    return sum((n * c * place ** (n - 1) for n, c in enumerate(row) if n), Q(0))


def times(one: Polynomial, other: Polynomial) -> Polynomial:
    result = [Q(0)] * (len(one) + len(other) - 1)
    for i, a in enumerate(one):
        for j, b in enumerate(other):
            result[i + j] += a * b
    return result


def total(*rows: Polynomial) -> Polynomial:
    result = [Q(0)] * max(map(len, rows))
    for row in rows:
        for n, c in enumerate(row):
            result[n] += c
    return result


def scaled(row: Polynomial, factor: Q) -> Polynomial:
    return [factor * c for c in row]


def determinant(rows: Matrix) -> Q:
    if not rows:
        return Q(1)
    first, *others = rows
    return sum(
        ((-1) ** j * a * determinant([row[:j] + row[j + 1 :] for row in others]) for j, a in enumerate(first)), Q(0)
    )


def inverse(rows: Matrix) -> Matrix:
    size, whole = range(len(rows)), determinant(rows)

    def cofactor(i: int, j: int) -> Q:
        return (-1) ** (i + j) * determinant([row[:j] + row[j + 1 :] for k, row in enumerate(rows) if k != i])

    return [[cofactor(j, i) / whole for j in size] for i in size]


def product(one: Matrix, other: Matrix) -> Matrix:
    return [[sum((a * b for a, b in zip(row, column, strict=True)), Q(0)) for column in zip(*other, strict=True)]
            for row in one]  # fmt: skip


def columns(*vectors: Sequence[Q]) -> Matrix:
    return [list(row) for row in zip(*vectors, strict=True)]


def of_quotient(sigma: Matrix) -> list[Q]:
    """a_1, .., a_n of a matrix modulo a vector that it leaves alone: det(c - sigma) = (c - 1) (c^n - a_1 ..)."""
    size, found = len(sigma), [Q(1)]
    for k in range(1, size):
        minors = (
            determinant([[sigma[i][j] for j in chosen] for i in chosen]) for chosen in combinations(range(size), k)
        )
        found.append(sum(minors, Q(0)) - found[-1])
    return found[1:]


@dataclass
class Unknown:
    """What of the flow is not known: of one value, a term of one grade, of one sign, times a power of sigma.

    It is a multiple of omega_variable, or of its square, if it is of grade 1 or 2.
    """

    name: str = ""
    grade: int = 0
    sign: int = 1
    variable: int = 0
    power: int = 0

    def of(self, name: str, size: Q) -> Q:
        return self.sign * UNKNOWN * size if name == self.name else Q(0)


def enclosing(
    flow: Any,
    value: Polynomial,
    slopes: Sequence[Polynomial],
    unknown: Unknown,
    name: str,
    size: Q = Q(1),
    variable: int | None = None,
) -> Series:
    """Encloses a function of (sigma, omega), of these value and derivatives at omega = 0, up to what is not known.

    What is not known is size UNKNOWN sigma^power, times an omega_j, or times its square.
    """
    part = unknown.of(name, size)
    variable = unknown.variable if variable is None else variable
    tail = [Q(0)] * unknown.power + [-part]
    count = len(slopes)
    terms: dict[tuple[int, ...], Any] = {(0,) * count: total(value, tail) if not unknown.grade else list(value)}
    for j, slope in enumerate(slopes):
        missing = unknown.grade == 1 and j == variable
        terms[tuple(int(i == j) for i in range(count))] = total(slope, tail) if missing else list(slope)
    found: Series = flow.polynomial(terms)
    bounds = [found.errors[g] + float(abs(part)) * (g == unknown.grade) for g in range(len(found.errors))]
    return found.with_errors(bounds)


@dataclass
class Halves:
    """A random curve of orbits in a tube, with the derivatives of both halves.

    Attributes:
        n: number of stability parameters.
        unknown: what of the flow is not known.
        given: its system, if it is none of any half maps.
        share: half-widths of the tube over those of the one that is followed.
        reach: how far from the polynomial the curve is, at most, over the latter; of each omega_j its largest value is
            at one of the ends.
        odd: of which of the q the symmetry S of a symmetric piece changes the sign; `None` of a regular one.
    """

    seed: int
    n: int
    unknown: Unknown = field(default_factory=Unknown)
    given: ReversibleSystem | None = None
    share: Q = Q(1, 2)
    reach: Sequence[Q] | None = None
    odd: Sequence[bool] | None = None

    def __post_init__(self) -> None:
        n, chance = self.n, random.Random(f"{self.seed} {self.n}")
        self.chance = chance
        self.system = self.given or a_system(n, self.odd or ())
        frame = self._regular(n + 1)
        piece = Piece(
            "p", "regular" if self.odd is None else "symmetric",
            tuple(Q(chance.randint(20, 60), 64) for _ in range(n + 1)), tuple(map(tuple, frame)),
            Q(chance.randint(8, 24), 128), tuple(tuple(self._row(4, 64)) for _ in range(n)),
            tuple(Q(1, 2 ** chance.randint(11, 15)) for _ in range(n)), "physical",
        )  # fmt: skip
        low, high = Q(chance.randint(-60, -10), 64), Q(chance.randint(0, 60), 64)
        if self.odd is not None:
            low = -high
        parameters = {"mu": Q(1, 80)} if self.given else {"c": Q(3, 7)}
        oracle: Any = None
        symmetry = None if self.odd is None else "S"
        self.tube = TubeOfOrbits(
            self.system, parameters, piece, (low, high), LIMITS, "physical", oracle, symmetry, 1 + self.seed % 3
        )
        self.widths = [width / self.share for width in piece.tube]
        self.flow = self.tube._format(max(self.widths))
        self.middle, self.radius = (low + high) / 2, (high - low) / 2 * Q(17, 16)
        self.omega = [scaled(self._row(3, 16), Q(1)) for _ in range(n)]
        if self.reach is not None:
            self.omega = [[r * 3 / 4, r * chance.choice((-1, 1)) / 4] for r in self.reach]

        if self.odd is not None:
            # What the symmetry negates is odd: sigma times an even function.
            self.omega = [[c * (k % 2 == 0) for k, c in enumerate(row)] for row in self.omega]

        # The curve, as functions of sigma.
        def by_sigma(row: Sequence[Q]) -> Polynomial:
            result, power = [Q(0)], [Q(1)]
            for c in row:
                result, power = total(result, scaled(power, c)), times(power, [self.middle, self.radius])
            return result

        p = [scaled([self.middle, self.radius], piece.half_width)]
        p += [total(by_sigma(row), scaled(omega, width))
              for row, omega, width in zip(piece.polynomial, self.omega, self.widths, strict=True)]  # fmt: skip
        self.here = [
            total([origin], *(scaled(each, factor) for each, factor in zip(p, row, strict=True)))
            for origin, row in zip(piece.centre, frame, strict=True)
        ]
        self.across = [[row[j + 1] for row in frame] for j in range(n)]
        # One coordinate of the other point moves evenly, whichever.
        self.even = chance.randrange(n + 1)
        self.there = [
            [Q(chance.randint(20, 60), 64), *([Q(0)] * 3 if k == self.even else [Q(0), *self._row(2, 256)])]
            for k in range(n + 1)
        ]
        for k in range(n + 1):
            self.there[k][1] = Q(chance.choice((-1, 1)) * chance.randint(24, 60), 64) / (1 if k == self.even else 4)
        self.out = [[self._row(3, 4) for _ in range(n + 1)] for _ in range(n)]
        self.time, self.time_across = [Q(3), *self._row(2, 8)], [self._row(2, 8) for _ in range(n)]

    def _row(self, count: int, scale: int) -> Polynomial:
        return [Q(self.chance.randint(-64, 64), 64 * scale * 4**k) for k in range(count)]

    def _regular(self, size: int) -> Matrix:
        while True:
            rows = [[Q(self.chance.randint(-8, 8), 8) for _ in range(size)] for _ in range(size)]
            if abs(determinant(rows)) > Q(1, 4):
                return rows

    def on_curve(self, value: Polynomial, slopes: Sequence[Polynomial], name: str, size: Q = Q(1)) -> Series:
        """A function of (sigma, omega) with this value and these derivatives on the curve; bent by what is unknown."""
        chosen = self.unknown.variable
        bend = [Q(0)] * self.unknown.power + [self.unknown.of(name, size) if self.unknown.grade == 2 else Q(0)]
        omega = self.omega[chosen]
        # f = value + sum slope_j (omega_j - omega_j*) + bend (omega_chosen - omega_chosen*)^2, by powers of omega.
        lowest = [value, times(bend, times(omega, omega))]
        lowest += [scaled(times(slope, each), Q(-1)) for slope, each in zip(slopes, self.omega, strict=True)]
        turned = scaled(times(bend, omega), Q(-2))
        slopes = [total(slope, turned) if j == chosen else slope for j, slope in enumerate(slopes)]
        return enclosing(self.flow, total(*lowest), slopes, self.unknown, name, size)

    @property
    def half(self) -> HalfReturn:
        """What the flow says at the end of the first half."""
        system, n = self.system, self.n
        assert system is not None
        names = system.centre_coordinates
        state: dict[str, Series] = {system.section: self.flow.constant(Q(0))}
        for k, name in enumerate(names):
            slopes = [scaled(self.out[j][k], self.widths[j]) for j in range(n)]
            state[name] = self.on_curve(self.there[k], slopes, f"p{k}")
        block = [[self._row(2, 8)[: 1 if self.odd else 2] for _ in range(n)] for _ in range(n)]
        for i, index in enumerate(system.kernel_coordinates):
            slopes = [total([Q(3 * (i == j))], block[i][j]) for j in range(n)]
            # Of sizes that differ, as they do where coordinates have units.
            size = Q(16) ** (i - 1)
            name, odd = system.state[index], bool(self.odd and self.odd[i])
            state[name] = self.on_curve([Q(0)], [scaled(row, size) for row in slopes], f"q{i}", size)
            if odd:
                state[name] = state[name] * self.flow.polynomial({(0,) * n: [Q(0), Q(1)]})
        tube = self.tube
        start = parameter_series(self.flow, system, tube.parameters)
        start |= tube_points(self.flow, names, tube.piece, (self.middle, self.radius), self.widths)
        time = self.on_curve(self.time, self.time_across, "time")
        return HalfReturn(
            start, tuple(self.widths), tuple(state[name] for name in system.state), time, arb(3), 5
        )  # fmt: skip

    # The second half

    @property
    def back(self) -> list[list[Polynomial]]:
        """A' by rows: at random, but that it takes v' to u'."""
        size = range(self.n + 1)
        own = [[self.chance.choice((-1, 1)) * c for c in [Q(1, 2), Q(1, 16)]] for _ in size for _ in size]
        rows = [own[(self.n + 1) * i : (self.n + 1) * (i + 1)] for i in size]
        pace = self.there[self.even][1]
        for k, row in enumerate(rows):
            image = total(*(times(a, derivative(v)) for a, v in zip(row, self.there, strict=True)))
            row[self.even] = total(
                row[self.even], scaled(total(derivative(self.here[k]), scaled(image, Q(-1))), 1 / pace)
            )
        return rows

    def truth(self, back: list[list[Polynomial]], place: Q) -> list[Q]:
        """a_1, .., a_n there."""
        here, there = ([slope_at(row, place) for row in point] for point in (self.here, self.there))
        out = columns(there, *([at(c, place) for c in column] for column in self.out))
        forth = product(out, inverse(columns(here, *self.across)))
        twice = product([[2 * at(c, place) for c in row] for row in back], forth)
        return of_quotient([[value - (i == j) for j, value in enumerate(row)] for i, row in enumerate(twice)])

    def determinant(self, place: Q) -> Q:
        """det(dv/dsigma, A b_1, ..)."""
        return determinant([[slope_at(row, place) for row in self.there],
                            *([at(c, place) for c in column] for column in self.out)])  # fmt: skip


def derivative(row: Polynomial) -> Polynomial:
    return [n * c for n, c in enumerate(row)][1:] or [Q(0)]


def a_system(n: int, odd: Sequence[bool]) -> ReversibleSystem:
    """With n + 1 coordinates on Fix(R), one of them after the others in its state; S negates those q that are odd."""
    names = [f"a{i}" for i in range(n)]
    return ReversibleSystem(
        name="halves",
        title="any half maps",
        state=("z", *names, *(f"b{i}" for i in range(n)), "l"),
        parameters={"c": ParameterRange(None, None)},
        vector_field=lambda state, _: state,
        reversing_symmetry=(-1, *[1] * n, *[-1] * n, 1),
        symmetries={"S": (1, *[1] * n, *(-1 if each else 1 for each in odd), 1)} if odd else {},
        section="z",
        first_integral=lambda s, p: (s[1] * s[-1] + p[0] * s[1] - s[-1],),
    )


def integral(point: Sequence[Q]) -> Q:
    return point[0] * point[-1] + Q(3, 7) * point[0] - point[-1]


def second_half(halves: Halves, back: list[list[Polynomial]], seen: list[Mapping[str, Series]]) -> Any:
    """In place of the integration of the second half: the image of what it is given under A'."""
    system, unknown = halves.system, halves.unknown
    assert system is not None
    names = system.centre_coordinates

    class Followed:
        def __init__(self, beyond: Any, flow: Any, begun: Mapping[str, Series], *_: Any) -> None:
            seen.append(begun)
            self.system, self.flow, self.begun = beyond, flow, begun

        def half_orbit(self, crossings: int, after: Any) -> tuple[list[Series], arb]:
            assert crossings == halves.tube.crossings
            state = {name: self.flow.constant(Q(0)) for name in system.state}
            n = halves.n
            for k, name in enumerate(names):
                slopes = []
                for j in range(n):
                    position = self.flow.grading.variable(j)
                    vector = [(known_part(self.begun[each], position) or [Q(0)])[0] for each in names]
                    slopes.append(total(*(scaled(a, c) for a, c in zip(back[k], vector, strict=True))))
                size = max(max(map(abs, row)) for row in slopes)
                state[name] = enclosing(self.flow, halves.here[k], slopes, unknown, f"back{k}", size)
            return [state[name] for name in system.state], arb(3)

    return Followed


@dataclass
class FirstHalf(Halves):
    """Planar orbits: f_0 is vy, so det L = vy at x over vy at y; D and V are chosen."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.d = [Q(self.chance.choice((-2, 2)), 3), *self._row(2, 4)]
        self.v = [[self._row(2, 2) for _ in range(2)] for _ in range(2)]

    def sigma(self, place: Q) -> Q:
        """a_1, from the matrix of the half map and its inverse."""
        here, there = ([slope_at(row, place) for row in point] for point in (self.here, self.there))
        out, across = [at(row, place) for row in self.out[0]], self.across[0]
        d, c = at(self.d, place), Q(5, 7)
        wanted = at(self.here[1], place) / at(self.there[1], place) * determinant([here, across])
        # With q as the third coordinate, L u' = v', L b = (A b, c), L q = (0, beta, d) or (beta, 0, d).
        k = 1 if there[0] else 0
        beta = (d * determinant([there, out]) - wanted) / c / (there[0] if k else -there[1])
        image = columns([*there, Q(0)], [*out, c], [beta * (1 - k), beta * k, d])
        whole = product(image, inverse(columns([*here, Q(0)], [*across, Q(0)], [Q(0), Q(0), Q(1)])))
        assert determinant(whole) == at(self.here[1], place) / at(self.there[1], place)
        back = inverse(whole)
        block, other = ([row[:2] for row in rows[:2]] for rows in (whole, back))
        (found,) = of_quotient([[2 * value - (i == j) for j, value in enumerate(row)]
                                for i, row in enumerate(product(other, block))])  # fmt: skip
        return found


def first_half_again(halves: FirstHalf) -> Any:
    """In place of the integration of the first half once more: D and V."""
    unknown = halves.unknown

    class Followed:
        def __init__(self, system: ReversibleSystem, flow: Any, start: Mapping[str, Series], *_: Any) -> None:
            self.system, self.flow, self.start = system, flow, start

        def half_orbit(self, crossings: int, after: Any) -> tuple[list[Series], arb]:
            assert crossings == halves.tube.crossings
            # They are orbits of points of the curve.
            for name, row in zip(halves.tube.system.centre_coordinates, halves.here, strict=True):
                for place in (Q(-1), Q(1, 3), Q(1)):
                    away = abs(at(known_part(self.start[name], 0), place) - at(row, place))
                    assert away <= Q(self.start[name].errors[0])
            names = ("vx", "w", "w'")
            rows = {"vx": [halves.d, [Q(1)], [Q(1)]], "w": [[Q(1)], *halves.v[0]], "w'": [[Q(1)], *halves.v[1]]}
            steps = []
            for j, name in enumerate(names):
                # Points off the curve are those of one coordinate each.
                known = [known_part(self.start[name], self.flow.grading.variable(i)) or [Q(0)] for i in range(3)]
                assert [bool(any(row)) for row in known] == [i == j for i in range(3)]
                steps.append(known[j][0])
            state = {name: self.flow.constant(Q(0)) for name in self.system.state}
            for name, row in rows.items():
                slopes = [scaled(each, step) for each, step in zip(row, steps, strict=True)]
                # What is not known of the derivative by q, or by w.
                variable = 0 if name == "vx" else 1
                state[name] = enclosing(self.flow, [Q(0)], slopes, unknown, name, steps[0], variable)
            return [state[name] for name in self.system.state], arb(3)

    return Followed
