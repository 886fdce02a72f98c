"""Which pieces of an atlas are proved first."""

from __future__ import annotations

from fractions import Fraction

from orbitproof.shared.formats import AnyAtlas
from orbitproof.verify.branches import Settings
from orbitproof.verify.branches.kinds import symmetric_curve
from orbitproof.verify.oracle import steps_about


def longest_first(atlas: AnyAtlas, settings: Settings) -> list[str]:
    """Ids of the pieces, those first whose orbits take the most steps: what one process does last is short then.

    By an estimate; where there is none, as along the curve.
    """
    names = [piece.id for piece in atlas.pieces]
    curve = symmetric_curve(atlas)
    if curve is None:
        return names
    pieces = curve.curve_pieces()
    parameters = {name: float(value) for name, value in atlas.parameters.items()}
    try:
        middles = [map(float, piece.point(Fraction(0))) for piece in pieces]
        points = [
            {**parameters, **dict(zip(curve.system.centre_coordinates, middle, strict=True))} for middle in middles
        ]
    except ValueError:
        # A piece with other numbers of coordinates is refused when it is proved.
        return names
    found = steps_about(curve.system, points, settings["precision"], settings["order"])
    steps = dict(zip((piece.id for piece in pieces), found, strict=True))
    return sorted(names, key=lambda name: -steps.get(name, 0))
