"""The neighbourhood of certified points, drawn from their certificates alone, and how it fits the numerical orbits."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import floor, log10
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from orbitproof.explore.branches import BranchRecord, read_branches
from orbitproof.figures.certified import CertifiedCurves
from orbitproof.figures.files import check_folder, save
from orbitproof.figures.orbits import Array
from orbitproof.figures.pictures.legends import legend_row, verdict_handles
from orbitproof.figures.pictures.marks import draw_point
from orbitproof.figures.style import CURVE, INK, label_of, marker_of, unit_of, use_style
from orbitproof.shared.formats import LEADING_POWERS, InputError
from orbitproof.verify.certificate import read_certificates

_WIDTH = 7.2
_CONTINUED = (0, (3, 1.6))


def write(certificates: Path, branches: Sequence[Path], folder: Path) -> list[Path]:
    """Write a picture of each proved bifurcation of a certificates file, as PDF and PNG.

    Branch files, if given, add the orbits that the search found. Raises `InputError` for bad files, and if no
    certificate proves anything.
    """
    proved = {name: entry for name, entry in read_certificates(certificates).items() if entry.proved}
    if not proved:
        raise InputError(f'{certificates}: no certificate says "proved"; there is nothing certified to draw')
    entries = {name: entry.to_json() for name, entry in proved.items() if entry.orbit is None}
    if not entries:
        raise InputError(f"{certificates}: orbits only, which have no curve; give certificates of bifurcations")
    records = {record.id: record for path in branches for record in read_branches(path)}
    drawn = {
        name: CertifiedCurves.of(entry, f"{certificates}: certificate {name!r}") for name, entry in entries.items()
    }
    check_folder(folder)
    written: list[Path] = []
    with use_style():
        for name, curves in drawn.items():
            figure = draw_certified(curves, _same(curves, records))
            stem = re.sub(r"[^A-Za-z0-9.]+", "-", f"certified-{curves.claim.system.name}-{name}").strip("-.")
            written += save(figure, folder / stem)
    return written


def _same(curves: CertifiedCurves, records: Mapping[str, BranchRecord]) -> BranchRecord | None:
    """The branch of the same claim, if orbits of it are known."""
    claim, record = curves.claim, records.get(curves.claim.id)
    if record is None or not record.sides or (record.system.name, record.k) != (claim.system.name, claim.k):
        return None
    return record if dict(record.parameters) == dict(claim.parameters) else None


def draw_certified(curves: CertifiedCurves, branch: BranchRecord | None) -> Figure:
    """One certified point: the curves in their box, and the bifurcation parameter along the branch.

    A fold has one curve, and the parameter is shown along that.
    """
    figure = plt.figure(figsize=(_WIDTH, 3.1))
    grid = figure.add_gridspec(1, 2, left=0.1, right=0.98, top=0.9, bottom=0.29, wspace=0.27)
    _box(figure.add_subplot(grid[0, 0]), curves)
    _level(figure.add_subplot(grid[0, 1]), curves, branch)
    colour = marker_of(curves.claim.k)[1]
    handles = [Patch(facecolor=CURVE, edgecolor=CURVE, label="family, enclosed")]
    if curves.claim.has_branch:
        handles.append(Patch(facecolor=colour, edgecolor=colour, label="branch, enclosed"))
    handles.append(Patch(facecolor="none", edgecolor=INK, label="box of the certificate"))
    line = Line2D(
        [], [], color=colour, linewidth=1.0, linestyle=(0, (3, 1.6)), label="certified coefficient, continued"
    )
    points = verdict_handles([True, False] if branch is not None else [True])
    for row, height in ((handles, 0.25), ([line, *points], 0.06)):
        legend_row(figure, row, height)
    return figure


def _box(axes: Axes, curves: CertifiedCurves) -> None:
    """Family and branch, if there is one, in the box, each as the boxes that enclose it."""
    axes.add_patch(Rectangle((-1, -1), 2, 2, facecolor="none", edgecolor=INK, linewidth=0.8))
    colour = marker_of(curves.claim.k)[1]
    for boxes, paint in ((curves.family, CURVE), (curves.branch, colour)):
        axes.add_collection(PolyCollection(_corners(boxes), facecolors=paint, edgecolors=paint, linewidths=0.7))
    middle = (curves.point[0] + curves.point[1]) / 2, (curves.point[2] + curves.point[3]) / 2
    draw_point(axes, middle, curves.claim.k, True, curves.claim.id, curves.claim.kind)
    axes.set_xlim(-1.12, 1.12)
    axes.set_ylim(-1.12, 1.12)
    axes.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])
    axes.set_yticks([-1.0, -0.5, 0.0, 0.5, 1.0])
    first, second = (_power(float(radius)) for radius in curves.radii)
    unit = ""
    if curves.claim.is_family_of_maps:
        name = curves.claim.system.family_parameter
        quantity = label_of(curves.claim.system, name, unit=False) if name else curves.parameter_name
        unit = f": {quantity} $-$ centre,"
    axes.set_xlabel(f"$p_0${unit} in units of {first}")
    axes.set_ylabel(f"$p_1$ in units of {second}")
    axes.set_title("(a)  the certified neighbourhood", color=INK)


def _corners(boxes: Array) -> Array:
    """Corners of rectangles from rows (left, right, bottom, top), shape (M, 4, 2)."""
    left, right, bottom, top = boxes.T
    return np.stack(
        [np.stack(pair, axis=-1) for pair in ((left, bottom), (right, bottom), (right, top), (left, top))], axis=1
    )


def _level(axes: Axes, curves: CertifiedCurves, branch: BranchRecord | None) -> None:
    """|parameter - parameter*| against |p_1|: from the size of the box to that of the orbits that were followed."""
    claim = curves.claim
    colour = marker_of(claim.k)[1]
    order = LEADING_POWERS[claim.kind]
    reach = float(curves.radii[1])
    furthest = 100 * reach
    if branch is not None:
        p_1, differences = _orbits(curves, branch)
        furthest = float(p_1.max())
        axes.plot(
            p_1,
            differences,
            linestyle="none",
            marker="o",
            markersize=3.2,
            color=colour,
            markerfacecolor="white",
            zorder=4,
        )
    if curves.beta is not None and curves.beta.is_finite():
        coefficient = abs(float(curves.beta.mid()))
        inside, all_the_way = (np.geomspace(1e-2 * reach, end, 200) for end in (reach, furthest))
        axes.plot(all_the_way, coefficient * all_the_way**order, color=colour, linewidth=1.0, linestyle=_CONTINUED)
        axes.plot(inside, coefficient * inside**order, color=colour, linewidth=3.0, solid_capstyle="butt")
    axes.axvline(reach, color=INK, linewidth=0.8)
    axes.annotate(
        "box",
        (reach, 0.97),
        xycoords=("data", "axes fraction"),
        xytext=(-3, 0),
        va="top",
        ha="right",
        textcoords="offset points",
        fontsize=7,
        color=INK,
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    name = claim.system.family_parameter
    quantity = label_of(claim.system, name, unit=False) if name else curves.parameter_name
    fold, unit = claim.is_fold, unit_of(claim.system)
    axes.set_xlabel(f"$|p_1 - p_1^*|${unit}" if fold else f"$|p_1|${unit}")
    axes.set_ylabel(f"|{quantity} $-$ {'extremum' if fold else 'bifurcation'}|")
    where = {"above": "above", "below": "below", "both": "on both sides"}.get(curves.side, curves.side)
    words = f"family: two orbits {where}" if fold else f"branch: new orbits {where}"
    axes.set_title(f"(b)  along the {words}", color=INK)


def _orbits(curves: CertifiedCurves, branch: BranchRecord) -> tuple[Array, Array]:
    """|p_1| and |level difference| of the orbits on both sides, p_1 in the claim's frame; with level coordinates
    the point's first coordinate is the level.
    """
    claim = curves.claim
    frame = np.array([[float(value) for value in row] for row in claim.frame])
    names = branch.system.centre_coordinates
    orbits = [orbit for side in branch.sides for orbit in side.orbits]
    moved = np.array([orbit.point - branch.point for orbit in orbits])
    differences = np.array([orbit.level_difference for orbit in orbits])
    columns = [moved[:, names.index(name)] if name in names else differences for name in claim.coordinates]
    p_1 = np.linalg.solve(frame, np.array(columns))[1]
    return np.abs(p_1), np.abs(differences)


def _power(value: float) -> str:
    exponent = floor(log10(value))
    return rf"${value / 10.0**exponent:.2g} \times 10^{{{exponent}}}$"
