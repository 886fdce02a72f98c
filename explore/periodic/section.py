"""Affine sections, their coordinates, and how often an orbit crosses them, in float64."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from orbitproof.explore.periodic.flow import Matrix, Vector

_TOUCHED = 1e-2
"""Sine of the angle at which an orbit meets a section that it nearly touches."""


@dataclass(frozen=True)
class AffineSection:
    """The points x with normal . x = offset, crossed where normal . x grows (direction 1) or falls (-1); exact.

    Attributes:
        normal: shape (N,), not zero.
    """

    normal: tuple[Fraction, ...]
    offset: Fraction
    direction: int

    @property
    def pivot(self) -> int:
        """The coordinate that follows from the others: that of the largest entry of the normal."""
        return max(range(len(self.normal)), key=lambda i: abs(self.normal[i]))

    def frame(self) -> tuple[tuple[Fraction, ...], ...]:
        """N rows of N - 1 numbers: the columns span the section, one for each coordinate but the pivot."""
        size, j = len(self.normal), self.pivot
        others = [i for i in range(size) if i != j]
        return tuple(
            tuple(-self.normal[k] / self.normal[j] if i == j else Fraction(int(i == k)) for k in others)
            for i in range(size)
        )

    def onto(self, point: Sequence[Fraction]) -> tuple[Fraction, ...]:
        """The point of the section with the same coordinates but the pivot, exactly."""
        j = self.pivot
        rest = sum((a * x for i, (a, x) in enumerate(zip(self.normal, point, strict=True)) if i != j), Fraction(0))
        return tuple((self.offset - rest) / self.normal[j] if i == j else x for i, x in enumerate(point))

    def described(self, names: Sequence[str]) -> str:
        """The section in words, as options take it: y=1/2 --direction -."""
        terms = [
            ("-" if value < 0 else "+") + (name if abs(value) == 1 else f"{abs(value)}*{name}")
            for value, name in zip(self.normal, names, strict=True)
            if value
        ]
        return f"{''.join(terms).removeprefix('+')}={self.offset}" + (" --direction -" if self.direction < 0 else "")

    def heights(self, states: Matrix) -> Vector:
        """normal . x - offset at states, shape (K, N), positive after a crossing in the direction."""
        return self.direction * (states @ np.array(list(map(float, self.normal))) - float(self.offset))

    def crossings(self, loop: Matrix) -> list[int]:
        """Where a closed orbit, given by states at equal times with both ends, crosses in the direction.

        Gives the index before each crossing. The last state is the first one again and counts once.
        """
        heights = self.heights(loop[:-1])
        after = np.roll(heights, -1)
        return [int(i) for i in np.flatnonzero((heights < 0) & (after >= 0))]


def map_derivative(section: AffineSection, monodromy: Matrix, velocity: Vector, frame: Matrix | None = None) -> Matrix:
    """The derivative of the return map at a fixed point, in the coordinates of a frame.

    Arguments:
        frame: shape (N, N - 1), whose columns span the section; by default `AffineSection.frame`.
    """
    normal = np.array(list(map(float, section.normal)))
    across = monodromy - np.outer(velocity, normal @ monodromy) / (normal @ velocity)
    if frame is None:
        frame = np.array([[float(value) for value in row] for row in section.frame()])
    others = [i for i in range(len(normal)) if i != section.pivot]
    return np.linalg.solve(frame[others], (across @ frame)[others])


def through_the_middle(states: Matrix) -> AffineSection:
    """A section for an orbit that is followed for long: its widest coordinate, in the middle of its range."""
    size = states.shape[1]
    j = int(np.argmax(np.ptp(states, axis=0)))
    return AffineSection(tuple(Fraction(int(i == j)) for i in range(size)), _middle(states[:, j]), 1)


def _middle(values: Vector) -> Fraction:
    """The middle of the range of values, to few digits."""
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return Fraction(str(low))
    return Fraction(str(round((low + high) / 2, int(np.ceil(-np.log10(high - low))) + 1)))


def suggested(loop: Matrix, velocities: Matrix, normals: Iterable[tuple[Fraction, ...]] | None = None) -> AffineSection:
    """The first of `sections`. Raises `ValueError` if none is crossed."""
    found = sections(loop, velocities, normals)
    if not found:
        raise ValueError("the orbit does not move")
    return found[0]


def sections(
    loop: Matrix, velocities: Matrix, normals: Iterable[tuple[Fraction, ...]] | None = None
) -> list[AffineSection]:
    """Sections for a closed orbit, in the middle of its range, crossed seldom and steeply; the best first.

    Those that are nearly touched stand last, however seldom they are crossed.

    Arguments:
        normals: to choose from; by default those of the coordinates.
    """
    found: list[tuple[tuple[bool, int, float], AffineSection]] = []
    size = loop.shape[1]
    for normal in normals or (tuple(Fraction(int(i == j)) for i in range(size)) for j in range(size)):
        across = np.array(list(map(float, normal)))
        values = loop @ across
        if not np.ptp(values) > 0:
            continue
        offset = _middle(values)
        for direction in (1, -1):
            section = AffineSection(normal, offset, direction)
            where = section.crossings(loop)
            if not where:
                continue
            steep = min(float(abs(velocities[i] @ across) / (np.linalg.norm(velocities[i]) or 1.0)) for i in where)
            found.append(((steep < _TOUCHED, len(where), -steep), section))
    return [section for _, section in sorted(found, key=lambda each: each[0])]
