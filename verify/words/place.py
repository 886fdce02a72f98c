"""Where on a proved curve the orbit of a certificate lies, in words (section 19.6)."""

from __future__ import annotations

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import shown
from orbitproof.verify.claim import atlas_in_words
from orbitproof.verify.curve import PlaceOnCurve
from orbitproof.verify.evidence import located

_DIGITS = 18


def place_in_words(atlas: Atlas, place: PlaceOnCurve, name: str, digest: str) -> str:
    """The place of an orbit on the curve of an atlas that a certificate proves, with its name and digest."""
    of_curve = f"the curve that the certificate {shown(name)} ({digest}) proves"
    where = f"on its piece {place.piece}, at {located('s', place.s, _DIGITS)}"
    if atlas.system.normalised:
        # In units of the orbit, and of a vertical one at its crossing of the axis.
        return f"The orbit of x is that of a point of {of_curve}, {where}."
    point = "P(x)" if place.other_point else "x"
    mirror = f"The image under {atlas_in_words(atlas).claim.symmetry} of the" if place.mirrored else "The"
    return f"{mirror} point {point} lies on {of_curve}, {where}."
