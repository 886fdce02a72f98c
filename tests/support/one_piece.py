"""Arcs of one piece along a line of Fix(R), proved, with the stability of their orbits."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from support.conclusions import with_complete_list
from support.stored import entry_of, values

from orbitproof.shared.claims import Atlas, Claim, Piece
from orbitproof.shared.codec import to_json
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.curve import PieceLimits, conclude, prove_piece
from orbitproof.verify.evidence import Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import TubeOfOrbits, stability_of_piece

LIMITS = PieceLimits(96, 30, 16)


@dataclass(frozen=True)
class OnePiece:
    """The orbits whose `along`-th coordinate on Fix(R) is between middle - reach and middle + reach, the others 0."""

    system: ReversibleSystem
    along: int
    middle: Fraction
    reach: Fraction
    limits: PieceLimits = LIMITS

    @cached_property
    def atlas(self) -> Atlas:
        """The claim."""
        size = len(self.system.centre_coordinates)
        order = [self.along, *(i for i in range(size) if i != self.along)]
        frame = tuple(tuple(Fraction(int(order[column] == row)) for column in range(size)) for row in range(size))
        centre = tuple(self.middle if i == self.along else Fraction(0) for i in range(size))
        rows, tube = ((Fraction(0),),) * (size - 1), (Fraction(1, 2**20),) * (size - 1)
        piece = Piece("p1", "regular", centre, frame, self.reach, rows, tube, "physical")
        return Atlas("one-piece", "one piece", self.system, {}, Claim("arc", None), (piece,))

    @cached_property
    def results(self) -> list[dict[str, Any]]:
        """What is proved of the piece, with the stability of its orbits."""
        (piece,) = self.atlas.curve_pieces()
        found = prove_piece(self.system, {}, piece, (Fraction(-1), Fraction(1)), ORACLE, self.limits)
        assert isinstance(found.outcome, Proved), found.outcome
        known = found.outcome.results
        stability = to_json(
            stability_of_piece(
                TubeOfOrbits(self.system, {}, piece, (known.start, known.end), self.limits, "physical", ORACLE),
                half=known.half_return,
            )
        )
        return [{**entry_of(found), "stability": stability}]

    def listed(self, order: int) -> dict[str, Any]:
        """The conclusion with the complete list."""
        return with_complete_list(self.atlas, self.results, conclude(self.atlas, values(self.results)), order)
