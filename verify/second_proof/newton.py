"""Newton's method for equations between balls, and the proof that there is one zero. README, section 9.3."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb, arb_mat

from .conditions import Hypothesis, Vector
from .jets import CannotFollow, Jet
from .proof import NEWTON_STEPS

KNOWN = 128
"""Bits beyond those that are lost along an orbit and in derivatives."""


class Newton:
    """One attempt.

    Attributes:
        centre: of all unknowns, moved by Newton's method; `reach`: the radius of their box.
        bits: the precision; `lost`: what is lost of it along the orbit.
        degree: the order of derivatives that Newton's method takes, and that the proof takes.
    """

    degree = 1, 1
    bits: int
    lost: int
    centre: Vector
    reach: arb

    def evaluated(self, around: Sequence[arb], degree: int) -> tuple[Any, list[Jet]]:
        """What is followed from the points of a set, and jets of the equations there."""
        raise NotImplementedError

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivatives of all equations by all unknowns, at the points of a set."""
        raise NotImplementedError

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides of all equations at the centre."""
        raise NotImplementedError

    def names(self) -> list[str]:
        """The names of all unknowns."""
        raise NotImplementedError

    def prepare(self, rows: Sequence[Jet]) -> None:
        """What is guessed from derivatives at the first centre."""

    def converge(self) -> Vector:
        """Move the centre to a zero by Newton's method; the left sides of the equations there."""
        small = arb(2) ** (self.lost + KNOWN // 2 - self.bits)
        for turn in range(NEWTON_STEPS):
            _, rows = self.evaluated(self.centre, self.degree[0])
            if turn == 0:
                self.prepare(rows)
            values = self.zeros(rows)
            moves = solved(self.system(rows, self.centre), values)
            largest = max(abs(move) for move in moves)
            if largest < small:
                self.reach = max(largest.abs_upper() * 256, small * arb(2) ** -(KNOWN // 4)).mid()
                return values
            if not largest < arb(2) ** -8:
                break
            self.centre = [(c - move).mid() for c, move in zip(self.centre, moves, strict=True)]
        raise CannotFollow("Newton's method does not converge from the centre of the certificate")

    def enclosed(self) -> tuple[Hypothesis, Vector, Any, list[Jet]]:
        """Lemma 5: the zero, and what was followed of its box, with jets of E there."""
        values = self.converge()
        around = [c + arb(0, self.reach) for c in self.centre]
        found, rows = self.evaluated(around, self.degree[1])
        moves = [-move for move in solved(self.system(rows, around), values)]
        inside = all(abs(move) < self.reach for move in moves)
        newton = Hypothesis("newton", inside, {"R": self.reach} | dict(zip(self.names(), moves, strict=True)))
        return newton, [c + move for c, move in zip(self.centre, moves, strict=True)], found, rows

    @property
    def width(self) -> int:
        """The box has the radius 2^-width."""
        return int(-float(self.reach.log() / arb(2).log()))


def solved(matrix: Sequence[Sequence[arb]], values: Sequence[arb]) -> Vector:
    """The solution of linear equations."""
    return [entry for (entry,) in arb_mat(matrix).solve(arb_mat([[value] for value in values])).tolist()]


def checked(hypotheses: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """All of them, if all hold. Raises `CannotFollow`."""
    for failed in (h for h in hypotheses if not h.holds):
        shown = ", ".join(f"{name} = {value.str(6)}" for name, value in failed.enclosures.items())
        raise CannotFollow(f"{failed.name} is not shown: {shown}")
    return tuple(hypotheses)
