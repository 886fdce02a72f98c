"""The pictures of certificates of atlases, as files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from orbitproof.figures.certified import CertifiedStability, Curve
from orbitproof.figures.files import file_name, save
from orbitproof.figures.pictures import Surface, draw_certified_stability, draw_curves, draw_pieces, draw_surface


def write_curves(curves: Sequence[Curve], folder: Path) -> Iterator[Path]:
    """Draw the pieces of each curve, and all curves of one kind together; yields the paths written."""
    groups: dict[str, list[Curve]] = {}
    for curve in curves:
        groups.setdefault(f"{curve.system.name}-{curve.atlas.claim.kind}", []).append(curve)
        yield from save(draw_pieces(curve), folder / f"atlas-{file_name(curve.atlas.id)}")
    for name, group in groups.items():
        yield from save(draw_curves(group), folder / f"curves-{file_name(name)}")


def write_stability(found: Sequence[CertifiedStability], folder: Path) -> Iterator[Path]:
    """Draw the stability along each curve that has a complete list; yields the paths written."""
    for stability in found:
        figure = draw_certified_stability(stability)
        yield from save(figure, folder / f"stability-{file_name(stability.curve.atlas.id)}")


def write_surfaces(surfaces: Sequence[Surface], folder: Path) -> Iterator[Path]:
    """Draw each surface; yields the paths written."""
    for surface in surfaces:
        yield from save(draw_surface(surface), folder / f"surface-{file_name(surface.atlas.id)}")
