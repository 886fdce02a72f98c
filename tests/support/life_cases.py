"""Lives of closed form: circles that are born on a straight line of equilibria (section 39)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from fractions import Fraction as Q
from functools import cache
from itertools import pairwise
from typing import Any

from support import birth_cases

from orbitproof.shared.claims import BirthAtlas, EquilibriumAtlas, EquilibriumCurveClaim, Piece
from orbitproof.shared.claims.life import BEGINS, Life, LifeArc, LifeJoint
from orbitproof.verify.birth_curve import BirthLimits, prove_birth_curve_piece
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.branches.life import certified_life
from orbitproof.verify.branches.rests_on import resting
from orbitproof.verify.certificate import Certificate, recheck
from orbitproof.verify.equilibrium_curve import EquilibriumLimits, prove_equilibrium_piece
from orbitproof.verify.oracle import ORACLE

TUBE = Q(1, 2**12)


def rest_atlas(begin: Q = Q(-1, 4), end: Q = Q(1, 5), **changes: Any) -> EquilibriumAtlas:
    """x = a, y = 0 of `birth_cases.circles`, in one piece."""
    one, zero = Q(1), Q(0)
    frame = ((one, zero, zero), (one, one, zero), (zero, zero, one))
    middle, reach = (begin + end) / 2, (end - begin) / 2
    piece = Piece(
        "e1", "regular", (middle, middle, zero), frame, reach, ((zero,), (zero,)), (TUBE,) * 2, "physical"
    )  # fmt: skip
    given: dict[str, Any] = {
        "id": "rest", "title": "a line of equilibria", "system": birth_cases.circles(), "parameters": {},
        "claim": EquilibriumCurveClaim("equilibrium-arc", "a"), "pieces": (piece,),
    }  # fmt: skip
    return EquilibriumAtlas(**{**given, **changes})


def certificate_of(atlas: EquilibriumAtlas | BirthAtlas, ends: Sequence[Q] = (Q(-1), Q(1))) -> Certificate:
    """What is proved of an atlas, its pieces tried between these values of s."""
    fast = BirthLimits(precision=80, order=24, width=16, top=1)
    parts = list(pairwise(ends))
    results = [
        prove_birth_curve_piece(atlas, piece, part, ORACLE, fast).stored
        if isinstance(atlas, BirthAtlas)
        else prove_equilibrium_piece(atlas, piece, part, EquilibriumLimits(precision=96, width=24, top=1)).stored
        for piece in atlas.curve_pieces()
        for part in parts
    ]
    conclusion = conclusion_of(atlas, results, (), lambda _: (), None)
    return Certificate(json.loads(json.dumps(make_atlas_certificate(atlas, results, conclusion))))


@cache
def rest() -> Certificate:
    """The line of equilibria."""
    return certificate_of(rest_atlas())


@cache
def born() -> Certificate:
    """The circles that are born on it."""
    return certificate_of(birth_cases.circles_born(id="born"))


def claim(*others: LifeArc, on: str = "rest", connected: bool = True) -> Life:
    """That the circles begin on the line."""
    arcs = (LifeArc("rest"), LifeArc("born", (LifeJoint(on, BEGINS),)), *others)
    return Life("a life", "circles and their equilibria", arcs, connected)


def life_of(said: Life, given: Sequence[Certificate]) -> Certificate:
    """What is proved of a life, by certificates that are checked first."""
    certificates = resting(said, given)
    return Certificate(certified_life(said, certificates, {entry.key: recheck(entry) for entry in certificates}))


@cache
def life() -> Certificate:
    """Of these two."""
    return life_of(claim(), (rest(), born()))
