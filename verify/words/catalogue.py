"""What a proved curve says of the rows of a catalogue, in words (section 32.4)."""

from __future__ import annotations

from fractions import Fraction

from orbitproof.shared.formats import Atlas
from orbitproof.shared.numbers import format_rational
from orbitproof.shared.systems import shown


def catalogue_in_words(atlas: Atlas, name: str, digest: str, certified: int, rows: int, within: Fraction) -> str:
    """The theorem about a catalogue by a curve, of which the certificate has this name and digest."""
    if not certified:
        return f"Of no row of the catalogue is an orbit of the curve {shown(name)} ({digest}) shown to start near it."
    times = "" if atlas.claim.crossings == 1 else f", half orbits meeting the section {atlas.claim.crossings} times"
    return (
        f"Let the curve of the certificate {shown(name)} ({digest}) be proved. For each of {certified} of {rows} rows, "
        "those with a place, the point at that place of the curve, or its mirror image where that is meant, is the "
        f"initial state of an R-symmetric periodic orbit of the system that is claimed there{times}. It lies at most "
        f"{format_rational(within)} from the state of the row. Its coordinates, first integral, period, stability "
        "parameters and index, and the least and the greatest distance from the body that the system names, as far as "
        "they are given, lie in the balls that are given, and so do the absolute differences from the numbers of the "
        "row."
    )
