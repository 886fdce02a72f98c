"""Symmetries that shift the orbit at which R is lost along itself by half its period (Lemma 27.6)."""

from __future__ import annotations

from flint import ctx

from orbitproof.shared.claims import Candidate
from orbitproof.verify.claim import check_symmetries, inverse, signs_on
from orbitproof.verify.evidence import Checklist, NotEstablishedError, dot, enclose, is_inside, is_positive
from orbitproof.verify.reversor_breaking.proved_reversor_breaking import BreakingResults

_BITS = 512
"""Bits of the balls: more than points of certificates have."""


def is_shifted_by(candidate: Candidate, found: BreakingResults, name: str) -> bool:
    """Whether S P(x) = x is shown for the point x of a proved claim with the level as parameter, S that symmetry.

    It is if S P(x) certainly lies in the box, on the sheet of the claim.
    """
    system, sheet = candidate.system, candidate.system.level_coordinate
    rows = inverse(candidate.frame)
    if rows is None or sheet is None or candidate.level_sign is None:
        return False
    try:
        check_symmetries(Checklist(), system, name)
    except NotEstablishedError:
        return False
    names = (*candidate.coordinates[1:], sheet)
    if not set(names) <= set(found.other_point):
        return False
    signs = signs_on(system, name, names)
    with ctx.workprec(_BITS):
        *image, on_sheet = (sign * found.other_point[each] for sign, each in zip(signs, names, strict=True))
        away = [ball - enclose(c) for ball, c in zip([found.parameter, *image], candidate.centre, strict=True)]
        in_box = [dot([enclose(value) for value in row], away) for row in rows]
        return is_positive(candidate.level_sign * on_sheet) and all(
            is_inside(ball, radius) for ball, radius in zip(in_box, candidate.radii, strict=True)
        )
