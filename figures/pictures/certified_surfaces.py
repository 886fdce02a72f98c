"""A surface of halo or axial orbits over the mass, from its certificate: the pieces, and where the symmetry breaks."""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from orbitproof.figures.certified import heading_of
from orbitproof.figures.orbits import Array
from orbitproof.figures.style import CURVE, INK, label_of
from orbitproof.shared.formats import Atlas, SurfacePiece
from orbitproof.verify.certificate import Certificate

_WIDTH = 7.2
_SAMPLES = 200
_LIGHT = "#9dbdd3"
_UNPROVED = "#b2182b"
_DASHES = ("solid", (0, (5, 2)), (0, (1.5, 1.2)))
_NAMES = {"h": r"$h=\mu^{1/3}$", "mu": r"$\mu$"}


@dataclass(frozen=True)
class Sheet:
    """A piece of a surface.

    Attributes:
        piece: its id.
        parameter: shape (M,), values of the parameter, for s from -1 to 1.
        points: shape (M, 1 + n), the polynomials of the bifurcation point.
        reach: up to where the orbits over the piece go in the coordinate that the symmetry negates.
        borders: values of the parameter at the ends of the proved parts.
        is_proved: whether the proved intervals cover the piece.
    """

    piece: str
    parameter: Array
    points: Array
    reach: float
    borders: tuple[float, ...]
    is_proved: bool


@dataclass(frozen=True)
class Surface:
    """The certificate of a surface: its atlas, whether it says "proved", its pieces in order."""

    atlas: Atlas
    is_proved: bool
    sheets: tuple[Sheet, ...]

    @property
    def parameter_name(self) -> str:
        """The parameter over which the surface lies."""
        return self.atlas.system.fixed_parameters[0]


def surface_of(certificate: Certificate) -> Surface:
    """The surface of a certificate that is about one."""
    atlas = certificate.atlas
    sheets = tuple(_sheet(certificate, piece) for piece in atlas.surface_pieces())
    return Surface(atlas, certificate.proved, sheets)


def _sheet(certificate: Certificate, piece: SurfacePiece) -> Sheet:
    system = certificate.atlas.system
    signs = system.symmetries[certificate.atlas.claim.symmetry or ""]
    odd = [i for i, name in enumerate(system.centre_coordinates) if signs[system.state.index(name)] < 0]
    coefficients = [float(value) for value in piece.parameters[system.fixed_parameters[0]]]
    s = np.linspace(-1.0, 1.0, _SAMPLES)
    intervals, ends = [], []
    for result in certificate.results:
        if result.piece == piece.id and result.is_proved:
            intervals.append((float(result.interval[0]), float(result.interval[1])))
            ends += [float(part.end) for part in result.parts]
    reached = -1.0
    for start, end in sorted(intervals):
        reached = max(reached, end) if start <= reached else reached
    return Sheet(
        piece=piece.id,
        parameter=np.polynomial.polynomial.polyval(s, coefficients),
        points=np.stack(
            [np.polynomial.polynomial.polyval(s, [float(value) for value in row]) for row in piece.centre], axis=1
        ),
        reach=float(abs(piece.frame[odd[0]][1]) * piece.radii[1]),
        borders=tuple(float(np.polynomial.polynomial.polyval(end, coefficients)) for end in ends if end < 1.0),
        is_proved=reached >= 1.0,
    )


def draw_surface(surface: Surface) -> Figure:
    """Over the parameter: how far the orbits of each piece reach, and the coordinates of the bifurcation point."""
    system = surface.atlas.system
    figure = plt.figure(figsize=(_WIDTH, 4.4))
    grid = figure.add_gridspec(2, 1, left=0.1, right=0.985, top=0.9, bottom=0.16, hspace=0.24, height_ratios=(1.0, 1.2))
    reach = figure.add_subplot(grid[0, 0])
    points = figure.add_subplot(grid[1, 0], sharex=reach)
    signs = system.symmetries[surface.atlas.claim.symmetry or ""]
    even = [i for i, name in enumerate(system.centre_coordinates) if signs[system.state.index(name)] > 0]
    for number, sheet in enumerate(surface.sheets):
        low, high = float(sheet.parameter.min()), float(sheet.parameter.max())
        look = (
            {"facecolor": (CURVE, _LIGHT)[number % 2], "linewidth": 0.0}
            if sheet.is_proved
            else {"facecolor": "white", "edgecolor": _UNPROVED, "linewidth": 0.9}
        )
        reach.bar(low, sheet.reach, width=high - low, align="edge", zorder=2, **look)
        reach.vlines(sheet.borders, 0.0, sheet.reach, color=INK, linewidth=0.3, zorder=3)
        for style, index in zip(_DASHES, even, strict=False):
            colour = INK if sheet.is_proved else _UNPROVED
            points.plot(sheet.parameter, sheet.points[:, index], color=colour, linestyle=style, linewidth=1.1)
    proved = sum(sheet.is_proved for sheet in surface.sheets)
    parts = sum(len(sheet.borders) + 1 for sheet in surface.sheets if sheet.is_proved)
    odd = next(name for i, name in enumerate(system.centre_coordinates) if i not in even)
    figure.text(0.1, 0.965, heading_of(surface.atlas), color=INK, fontweight="bold", va="center")
    count = f"{proved} of {len(surface.sheets)} pieces proved, in {parts} parts"
    reach.set_title(f"(a)  orbits that are born, up to this {label_of(system, odd, unit=False)}; {count}", color=INK)
    reach.set_ylabel(f"{label_of(system, odd, unit=False)}")
    reach.margins(x=0.015)
    reach.tick_params(labelbottom=False)
    reach.grid(visible=False, axis="x")
    points.set_title("(b)  where the symmetry breaks", color=INK)
    points.set_xlabel(_NAMES.get(surface.parameter_name, label_of(system, surface.parameter_name, unit=False)))
    handles = [
        plt.Line2D(
            [], [], color=INK, linestyle=style, label=label_of(system, system.centre_coordinates[index], unit=False)
        )
        for style, index in zip(_DASHES, even, strict=False)
    ]
    if proved < len(surface.sheets):
        handles.append(Patch(facecolor="white", edgecolor=_UNPROVED, label="not proved"))
    figure.legend(
        handles=handles,
        loc="lower center",
        ncols=len(handles),
        handlelength=2.6,
        borderaxespad=0.0,
        bbox_to_anchor=(0.5, 0.01),
    )
    return figure
