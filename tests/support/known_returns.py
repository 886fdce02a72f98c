"""Return maps that are linear in the coordinates of a box, with all that is known of them, and claims about them.

They stand for return maps of x' = 0, t' = 1 in other coordinates: every function of x is a first integral.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from support.other_coordinates import Rows, dot, mixing, product

from orbitproof.shared.formats import PeriodicOrbit, define_system
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.claim import inverse
from orbitproof.verify.evidence import (
    Outcome,
    enclose,
)
from orbitproof.verify.periodic import (
    Linearised,
    PeriodicEnclosures,
    PeriodicResults,
    SectionReturn,
)

BITS = 160
WIDTH = Fraction(1, 2**30)
ZERO, ONE = Fraction(0), Fraction(1)


@dataclass(frozen=True)
class KnownReturn:
    """F(p) = f + A p with one fixed point.

    Attributes:
        claim: a box about it, in a frame without any symmetry.
        matrix, fixed: A, and the fixed point; f = (1 - A) fixed.
        time: of the return at p = 0, and its derivatives.
        others: the eigenvalues, real, without that of the levels; none of a rotation.
        height: of the first integral, its derivatives in p and its value at p = 0.
    """

    claim: PeriodicOrbit
    matrix: Rows
    fixed: tuple[Fraction, ...]
    time: tuple[Fraction, ...]
    others: tuple[Fraction, ...]
    height: tuple[Fraction, ...] = ()

    def moved_to(self, fixed: tuple[Fraction, ...]) -> KnownReturn:
        """The same with another fixed point, and a claim about its level."""
        claim = self.claim
        if self.height:
            claim = replace(claim, level=dot(self.height, (*fixed, ONE)))
        return replace(self, claim=claim, fixed=fixed)

    @property
    def enclosures(self) -> PeriodicEnclosures:
        """With the returns after fewer crossings, at which no point of the box is back."""
        size = len(self.fixed)
        earlier = tuple(
            SectionReturn(crossings, self._image([ONE] * size), self._time)
            for crossings in earlier_crossings(self.claim.crossings)
        )
        last = SectionReturn(self.claim.crossings, self._image([ZERO] * size), self._time)
        return PeriodicEnclosures((*earlier, last), 1, BITS, 1)

    def _image(self, by: Sequence[Fraction]) -> tuple[Linearised, ...]:
        rest = [
            x - dot(row, self.fixed) + more for x, row, more in zip(self.fixed, self.matrix, by, strict=True)
        ]  # fmt: skip
        return tuple(
            Linearised(enclose(value), tuple(map(enclose, row))) for value, row in zip(rest, self.matrix, strict=True)
        )

    @property
    def _time(self) -> Linearised:
        first, *slopes = self.time
        return Linearised(enclose(first), tuple(map(enclose, slopes)))


def earlier_crossings(crossings: int) -> list[int]:
    """m / q for the primes q that divide m."""
    primes = [q for q in range(2, crossings + 1) if crossings % q == 0 and all(q % r for r in range(2, q))]
    return sorted(crossings // q for q in primes)


def known_return(
    chance: random.Random,
    size: int,
    on_level: bool = False,
    turns: bool = False,
    keeps_volume: bool = False,
    crossings: int = 1,
    plain: bool = False,
) -> KnownReturn:
    """One with random real multipliers off the circle, or that turns a plane; t' is not 1 unless volume is kept.

    In `plain` coordinates t is the last one, and the box is along the others.
    """
    moduli = chance.sample([Fraction(1, 3), Fraction(-1, 2), Fraction(2), Fraction(-5, 3), Fraction(3, 4)], size)
    diagonal = [[moduli[i] if i == j else ZERO for j in range(size)] for i in range(size)]
    others = tuple(moduli[on_level:])
    if on_level:
        diagonal[0][0] = ONE
    if turns:
        at = size - 2
        for i, row in enumerate([(Fraction(3, 5), Fraction(-4, 5)), (Fraction(4, 5), Fraction(3, 5))]):
            diagonal[at + i][at:] = row
        others = ()
    change = mixing(size, chance)
    back = inverse(change)
    assert back is not None
    matrix = product(product(change, diagonal), back)
    whole = mixing(size + 1, chance)
    if plain:
        whole = tuple(tuple(Fraction(int(i == j)) for j in range(size + 1)) for i in range(size + 1))
    whole_back = inverse(whole)
    assert whole_back is not None
    names = [f"x{place}" for place in range(size + 1)]

    def field(*state: Any) -> tuple[Any, ...]:
        time = dot(whole_back[-1], state)
        rate = 1 + ZERO * time if keeps_volume else 1 + time * time
        return tuple(row[-1] * rate for row in whole)

    centre = tuple(Fraction(chance.randint(-9, 9), 4) for _ in names)
    fixed = tuple(WIDTH * Fraction(chance.choice((-1, 1)) * chance.randint(16, 48), 64) for _ in range(size))
    description: dict[str, Any] = {"name": "map", "state": names, "field": field}
    more: dict[str, Any] = {}
    height: tuple[Fraction, ...] = ()
    if on_level:
        # The first row of the inverse of the change of coordinates is what A leaves alone.
        row = [dot(back[0], column) for column in zip(*whole_back[:-1], strict=True)]
        height = (*(3 * value for value in back[0]), 3 * dot(row, centre))
        description["first_integral"] = lambda *state: 3 * dot(row, state)
        more["level"] = ZERO
    claim = PeriodicOrbit(
        id="known", system=define_system(description), parameters={}, normal=tuple(whole_back[-1]),
        offset=dot(whole_back[-1], centre), direction=1, crossings=crossings, centre=centre,
        frame=tuple(row[:-1] for row in whole), radii=(WIDTH,) * size, **more,
    )  # fmt: skip
    time = (Fraction(chance.randint(8, 24), 4), *(Fraction(chance.randint(-8, 8), 4) for _ in range(size)))
    return KnownReturn(claim, matrix, fixed, time, others, height).moved_to(fixed)


def outcome_of(claim: PeriodicOrbit, found: PeriodicEnclosures) -> Outcome[PeriodicResults]:
    """What is concluded from enclosures."""
    return _conclude(claim, BITS, found)


def contains_all(balls: Sequence[Any], values: Sequence[Fraction]) -> bool:
    """Whether there is a ball for each of these real numbers, a ball of its own."""
    return len(balls) == len(values) and all(
        sum(bool((ball.real - enclose(value)).contains(0)) and bool(ball.imag.contains(0)) for ball in balls) == 1
        for value in values
    )
