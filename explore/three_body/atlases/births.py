"""Pieces about an orbit from which orbits are born: axial ones from a vertical orbit, others at a period doubling.

Both are curves over the amplitude with which the new orbits leave the old one in the plane y = 0 (`BirthPiece`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from orbitproof.explore.atlases import LibrationFailure, zero_near
from orbitproof.explore.flow import Matrix, Vector, flow_of
from orbitproof.explore.numerics import working_context
from orbitproof.explore.refinement import IntegrationFailure, JetBasis, section_crossings
from orbitproof.shared.formats import BirthPiece
from orbitproof.shared.systems import CR3BP, REGULARISATIONS

TOLERANCE, NOISE = 1e-11, 1e-8
"""Newton's method ends with a step below the tolerance, or one below the noise that is no shorter than the last."""
NODES, COEFFICIENTS = 20, 12
"""Amplitudes at which the orbits are found; at most so many powers of their squares are fitted to these, and no more
than bring the polynomials closer to them by half: further ones would hold noise."""
STEPS = 40
"""So many steps lead to the largest of them."""
X, Y, Z, VX, VY, VZ = range(6)


@dataclass(frozen=True)
class OrbitsAtBirth:
    """Orbits near the one from which they are born: at s they cross y = 0 with (vx, vz) = s directions (1, b).

    Attributes:
        mu: the mass parameter, exact.
        middle: shape (3,), x, z and vy where the old orbit meets y = 0, at right angles.
        time: of both from there to where they meet y = 0 next.
        vanishing: indices of what is 0 there, besides y.
        bits: of the integration for the last step of Newton's method; 0: float64, as for the others.
    """

    mu: Fraction
    middle: Vector
    time: float
    vanishing: tuple[int, int]
    bits: int = 0

    @cached_property
    def directions(self) -> Matrix:
        """Columns: that in which the new orbits leave the old one, and a perpendicular one."""
        x, z, vy = self.middle
        result = flow_of(CR3BP).derivative([x, 0.0, z, 0.0, vy, 0.0], self.time, [float(self.mu)])
        rates = result.state_transition[np.ix_(self._wanted, [VX, VZ])]
        # Until the orbits are in y = 0 again.
        at_section = rates[1:] - np.outer(result.velocity[self._wanted[1:]] / result.velocity[Y], rates[0])
        direction = np.linalg.svd(at_section)[2][-1]
        return np.array([[direction[0], -direction[1]], [direction[1], direction[0]]])

    def orbits(self, amplitudes: Vector) -> tuple[Matrix, Matrix]:
        """x, z, vy and b for each amplitude, and the ends (state, time) of s and of -s."""
        known = [(0.0, np.array([*self.middle, 0.0, self.time, self.time]))]
        rows, ends = {}, {}
        for s in sorted({*amplitudes.tolist(), *np.linspace(0, max(amplitudes), STEPS)[1:].tolist()}):
            (before, first), (after, last) = known[-2:] if len(known) > 1 else known * 2
            # Everything is even in s.
            share = (s**2 - after**2) / (after**2 - before**2) if len(known) > 1 else 0.0
            unknowns, rows[s], ends[s] = self._corrected(last + share * (last - first), s)
            known.append((s, unknowns))
        if self.bits:
            rows.update({s: self._sharpened(np.append(rows[s], ends[s][:, -1]), s) for s in amplitudes.tolist()})
        return np.array([rows[s] for s in amplitudes]), np.array([ends[s] for s in amplitudes])

    def _sharpened(self, unknowns: Vector, s: float) -> Vector:
        """x, z, vy and b at an amplitude, corrected by an integration with more digits.

        Orbits that pass close to a primary lose those of float64.
        """
        context, basis = working_context(self.bits), JetBasis.graded((1,), 0)
        x, z, vy, b = map(context.mpf, unknowns[:4].tolist())
        velocity = [along + across * b for along, across in self.directions.tolist()]
        ends = []
        for side in (s, -s):
            start = [basis.constant(value) for value in (x, 0, z, side * velocity[0], vy, side * velocity[1])]
            crossings = section_crossings(
                CR3BP, {"mu": self.mu}, start, None, context, regularisation=REGULARISATIONS[CR3BP.name]
            )
            try:
                end = next(crossings).jets
            except IntegrationFailure as error:
                raise LibrationFailure(f"at the amplitude {s:.6g} of the birth: {error}") from None
            ends.append([end[index].coefficients[0] for index in self._wanted])
        values = [(a + c) / 2 for a, c in zip(*ends, strict=True)] + [
            (a - c) / (2 * s) for a, c in zip(*ends, strict=True)
        ]
        step = np.linalg.solve(self._equations(unknowns, s)[1], np.array([float(value) for value in values]))
        return np.array([float(value) for value in (x - step[0], z - step[1], vy - step[2], b - step[3])])

    def _corrected(self, unknowns: Vector, s: float) -> tuple[Vector, Vector, Matrix]:
        """The unknowns at an amplitude, the first four of them, and the ends."""
        where = f"at the amplitude {s:.6g} of the birth"
        found, _, ends = zero_near(unknowns, lambda here: self._equations(here, s), is_down_to_noise, where)
        return found, found[:4], ends

    def _equations(self, unknowns: Vector, s: float) -> tuple[Vector, Matrix, Vector]:
        """Means, and differences by s, of what vanishes at the ends of s and -s; their derivatives; the ends."""
        x, z, vy, b = unknowns[:4]
        turn = self.directions[:, 1]
        velocity = self.directions @ [1.0, b]
        values, slopes, ends = [], [], []
        for number, side in enumerate((s, -s)):
            start = [x, 0.0, z, side * velocity[0], vy, side * velocity[1]]
            result = flow_of(CR3BP).derivative(start, unknowns[4 + number], [float(self.mu)])
            rates = result.state_transition[self._wanted]
            times = [result.velocity[self._wanted] if which == number else np.zeros(3) for which in (0, 1)]
            columns = [rates[:, X], rates[:, Z], rates[:, VY], side * rates[:, [VX, VZ]] @ turn, *times]
            values.append(result.state[self._wanted])
            slopes.append(np.stack(columns, axis=1))
            ends.append([*result.state, unknowns[4 + number]])
        joined = [np.concatenate([0.5 * (a + c), 0.5 * (a - c) / s]) for a, c in (values, slopes)]
        return joined[0], joined[1], np.array(ends)

    @property
    def _wanted(self) -> list[int]:
        return [Y, *self.vanishing]


def is_down_to_noise(step: Vector, unknowns: Vector, before: float) -> bool:
    """Whether a step is short enough, or no shorter than the one before as rounding is; see `zero_near`."""
    length = float(np.abs(step).max())
    return length < TOLERANCE or before <= length < NOISE


def birth_piece(
    birth: OrbitsAtBirth, width: float, used: float, tubes: Sequence[float], name: str = "birth"
) -> tuple[BirthPiece, Matrix]:
    """The piece of amplitudes up to `width`, and the ends (state, time) of s and of -s at the amplitude `used`.

    Arguments:
        tubes: half-widths in x, z, vy and b.

    Raises `LibrationFailure`.
    """
    nodes = np.append(width * np.sin(np.pi * (np.arange(NODES) + 0.5) / (2 * NODES)), used)
    rows, ends = birth.orbits(nodes)
    coefficients = _fitted((nodes[:-1] / width) ** 2, rows[:-1], np.asarray(tubes))
    polynomial = tuple(
        tuple(Fraction(float(column[n // 2])) if n % 2 == 0 else Fraction(0) for n in range(2 * len(column) - 1))
        for column in coefficients.T
    )
    piece = BirthPiece(
        id=name,
        directions=tuple(tuple(Fraction(float(value)) for value in row) for row in birth.directions),
        half_width=Fraction(width),
        polynomial=polynomial,
        tube=tuple(Fraction(float(f"{size:.1e}")) for size in tubes),
    )
    return piece, ends[-1]


def _fitted(squares: Vector, rows: Matrix, tubes: Vector) -> Matrix:
    """Coefficients of polynomials, one column each. Differences of s and -s by s hold more noise the smaller s is."""
    weights = np.sqrt(squares)[:, None]
    found, least = np.zeros((0, rows.shape[1])), np.inf
    for count in range(2, COEFFICIENTS + 1):
        powers = weights * np.vander(squares, count, increasing=True)
        more = np.linalg.lstsq(powers, weights * rows, rcond=None)[0]
        off = float(np.max(np.abs(powers @ more - weights * rows) / tubes))
        if off > least / 2:
            break
        found, least = more, off
    return np.asarray(found)
