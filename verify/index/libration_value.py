"""The index of small orbits around a libration point, by its frequencies (section 35.5)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.curve import point_name, stiffness_at_rest, vertical_point
from orbitproof.verify.evidence import Evidence


def reaches_rest(atlas: Atlas) -> bool:
    """Whether the claim about a curve says that its orbits shrink to a libration point (Theorems 16.3, 16.6)."""
    claim, covers = atlas.claim, atlas.claim.covers
    size = "eps" if point_name(atlas.system) is not None else "eps2"
    return (
        (point_name(atlas.system) is not None or vertical_point(atlas.system) is not None)
        and covers is not None
        and covers.coordinate == size
        and (size in claim.increasing or vertical_point(atlas.system) is not None)
        and covers.start <= 0 <= covers.end
    )


def index_of_small_orbits(
    evidence: Evidence, system: ReversibleSystem, parameters: Mapping[str, Fraction]
) -> tuple[int, ...]:
    """The index of planar orbits in the plane and across it, of vertical ones that of all (Lemma 35.6).

    Raises `ValueError` for other systems; a requirement of `evidence` fails where it is not known.
    """
    if point_name(system) is None and vertical_point(system) is None:
        raise ValueError(f"{system.name}: is not about small orbits around a libration point")
    stiffness = stiffness_at_rest(system, parameters)
    across = evidence.record("frequency out of the plane", stiffness.sqrt())
    squared = (2 - stiffness + (9 * stiffness * stiffness - 8 * stiffness).sqrt()) / 2
    plane = evidence.record("frequency in the plane", squared.sqrt())
    ratio = plane / across if point_name(system) is None else across / plane
    whole = _whole(evidence.record("their ratio", ratio))
    evidence.require(whole is not None, "their ratio may be a whole number", needs_precision=True)
    if whole is None:
        return ()
    turning = 2 * whole + 1
    return (2 + turning,) if point_name(system) is None else (2, turning)


def _whole(ratio: arb) -> int | None:
    """The whole number below a ball that contains none."""
    number = ratio.floor().unique_fmpz()
    return None if number is None or ratio.contains(arb(number)) else int(number)
