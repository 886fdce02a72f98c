"""The coordinate w that follows from a fixed level of the first integral. README, section 4.5."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from .jets import CannotFollow, Jet, ball, implicit


@dataclass(frozen=True)
class LevelSet:
    """The points with H = h on which a family is.

    Attributes:
        integral: the program of H; `value`: h.
        place: index in the state of the coordinate w that follows; `sign`: of w at the points that are claimed.
    """

    integral: Any
    value: Fraction
    place: int
    sign: int

    def _height(self, conserved: Callable[[Sequence[Jet]], Jet], state: Sequence[Jet], w: arb) -> Jet:
        """H - h at points with these other coordinates, w moving about a value as a new variable."""
        degree, new = state[0].degree, len(state)
        jets = [jet if i != self.place else Jet({(): w, (new,): arb(1)}, degree) for i, jet in enumerate(state)]
        return conserved(jets) - Jet({(): ball(self.value)}, degree)

    def near(self, conserved: Callable[[Sequence[Jet]], Jet], state: Sequence[Jet]) -> arb:
        """About the w of a point, on the side that is claimed, if H is about A + b w^2."""
        rest, one = (self._height(conserved, state, arb(w))[()] for w in (0, 1))
        return arb((abs(rest / (one - rest)).sqrt() * self.sign).mid())

    def lifted(self, conserved: Callable[[Sequence[Jet]], Jet], state: Sequence[Jet], bits: int) -> list[Jet]:
        """The state with the jet of w where H = h, in a ball in which no other w solves this. README, section 4.5."""
        new = len(state)
        near = self.near(conserved, [Jet({(): jet[()].mid()}, 1) for jet in state])
        first = self._height(conserved, state, near)
        reach = 4 * (first[()] / first[new,].mid()).abs_upper() + arb(2) ** -(2 * bits)
        slope = self._height(conserved, state, near + arb(0, 1) * reach)[new,]
        move = first[()] / slope
        w = near - move
        if slope.contains(0) or not move.abs_upper() < reach or not w * self.sign > 0:
            raise CannotFollow("w is not shown to follow from the level, with the sign that is claimed")
        jet = Jet({(): w}, state[0].degree) + implicit([self._height(conserved, state, w)], [new])[new]
        return [jet if i == self.place else other for i, other in enumerate(state)]
