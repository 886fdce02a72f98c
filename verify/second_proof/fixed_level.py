"""The coordinate w that follows from a fixed level of the first integral. README, section 4.5."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from .jets import CannotFollow, Jet, ball, implicit

_HALVINGS, _STEPS, _MOST_PARTS = 60, 12, 2000


def level_coordinate(system: Mapping[str, Any]) -> Any:
    """The name of w: of the reversor that stands for R, if it is another than the first and has one of its own."""
    chosen = system["reversors"][system["reversor"]] if system.get("reversor") else None
    own = chosen.get("level_coordinate") if isinstance(chosen, dict) else None
    return own or system["level_coordinate"]


@dataclass(frozen=True)
class LevelSet:
    """The points with H = h on which a family is.

    Attributes:
        integral: the program of H; `value`: h.
        place: index in the state of the coordinate w that follows.
        sign: of w at the points that are claimed; 0 if these have w in an interval: `between` its ends.
    """

    integral: Any
    value: Fraction
    place: int
    sign: int
    between: tuple[Fraction, Fraction] | None = None

    def _height(self, conserved: Callable[[Sequence[Jet]], Jet], state: Sequence[Jet], w: arb) -> Jet:
        """H - h at points with these other coordinates, w moving about a value as a new variable."""
        degree, new = state[0].degree, len(state)
        jets = [jet if i != self.place else Jet({(): w, (new,): arb(1)}, degree) for i, jet in enumerate(state)]
        return conserved(jets) - Jet({(): ball(self.value)}, degree)

    def near(self, conserved: Callable[[Sequence[Jet]], Jet], state: Sequence[Jet]) -> arb:
        """About the w of a point, on the side that is claimed: as if H were A + b w^2, or by halving its interval."""
        if self.between is not None:
            low, high = map(ball, self.between)
            first = self._height(conserved, state, low)[()] > 0
            for _ in range(_HALVINGS):
                middle = ((low + high) / 2).mid()
                is_first = (self._height(conserved, state, middle)[()] > 0) == first
                low, high = (middle, high) if is_first else (low, middle)
            return low.mid()
        rest, one = (self._height(conserved, state, arb(w))[()] for w in (0, 1))
        return arb((abs(rest / (one - rest)).sqrt() * self.sign).mid())

    def _is_meant(self, conserved: Callable[[Sequence[Jet]], Jet], state: Sequence[Jet], w: arb) -> bool:
        """Whether w has the sign that is claimed, or is in its interval, in which dH/dw then has no zero."""
        if self.between is None:
            return bool(w * self.sign > 0)
        pending, count = [self.between], 0
        while pending and count < _MOST_PARTS:
            (low, high), count = pending.pop(), count + 1
            middle, radius = (low + high) / 2, ball((high - low) / 2)
            part = [Jet({(): jet[()]}, 1) for jet in state]
            try:
                slope = self._height(conserved, part, ball(middle) + arb(0, 1) * radius.abs_upper())[len(state),]
            except CannotFollow:
                # As a root over too wide a part of the interval.
                slope = arb("nan")
            if not slope.is_finite() or slope.contains(0):
                pending += [(low, middle), (middle, high)]
        first, last = map(ball, self.between)
        return not pending and bool(first < w) and bool(w < last)

    def lifted(self, conserved: Callable[[Sequence[Jet]], Jet], state: Sequence[Jet], bits: int) -> list[Jet]:
        """The state with the jet of w where H = h, in a ball in which no other w solves this. README, section 4.5."""
        new = len(state)
        near = self.near(conserved, [Jet({(): jet[()].mid()}, 1) for jet in state])
        if self.between is not None:
            # So near that one step of Newton's method is short.
            for _ in range(_STEPS):
                first = self._height(conserved, [Jet({(): jet[()].mid()}, 1) for jet in state], near)
                near = (near - first[()] / first[new,]).mid()
        first = self._height(conserved, state, near)
        reach = 4 * (first[()] / first[new,].mid()).abs_upper() + arb(2) ** -(2 * bits)
        slope = self._height(conserved, state, near + arb(0, 1) * reach)[new,]
        move = first[()] / slope
        w = near - move
        if slope.contains(0) or not move.abs_upper() < reach or not self._is_meant(conserved, state, w):
            raise CannotFollow("w is not shown to follow from the level, as the w that is claimed")
        jet = Jet({(): w}, state[0].degree) + implicit([self._height(conserved, state, w)], [new])[new]
        return [jet if i == self.place else other for i, other in enumerate(state)]
