"""The picture of the families by name: ``python docs/families.py`` writes docs/images/families.png."""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

from orbitproof.explore.catalogues.without_symmetry import triangular_catalogue
from orbitproof.explore.families import Limits, trace_family
from orbitproof.explore.flow import flow_batch
from orbitproof.explore.names import FAMILY_NAMES, WITHOUT_SYMMETRY
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

MASS = MASS_PARAMETERS["jpl-earth-moon"]
STATES = 400
KINDS = ("butterfly", "dragonfly", "dro", "dpo", "lpo-east", "lpo-west", "resonant")


def orbits_of(name: str) -> list[tuple[np.ndarray, float]]:
    """First states and periods of five orbits."""
    if name in WITHOUT_SYMMETRY:
        rows, _ = triangular_catalogue(name, MASS, "jpl-earth-moon", 60)
        return [(rows.states[i], float(rows.periods[i])) for i in np.linspace(5, len(rows) - 1, 5).astype(int)]
    family = trace_family(CR3BP, name, {"mu": MASS}, Limits(120))
    chosen = np.linspace(0, len(family.orbits) - 1, 5).astype(int)
    found = [family.orbits[index] for index in chosen]
    return [(family.problem.initial_state(orbit.unknowns), orbit.period) for orbit in found]


def path_of(state: np.ndarray, period: float) -> np.ndarray:
    """States over a period."""
    times = np.linspace(0, period, STATES)
    starts = np.repeat(state[None], STATES, axis=0)
    return flow_batch(CR3BP, starts, np.maximum(times, 1e-12), np.full((STATES, 1), float(MASS))).states


def main() -> None:
    """Draw and write."""
    matplotlib.use("Agg")
    from matplotlib import pyplot

    names = [name for name in FAMILY_NAMES["cr3bp"] if any(kind in name for kind in KINDS)] + ["L4-short", "L4-long"]
    figure, axes = pyplot.subplots(6, 4, figsize=(11, 16.5))
    colours = pyplot.get_cmap("viridis")(np.linspace(0.0, 0.85, 5))
    for axis, name in zip(axes.flat, names, strict=False):
        for colour, (state, period) in zip(colours, orbits_of(name), strict=False):
            x, y = path_of(state, period)[:, :2].T
            axis.plot(x, y, color=colour, linewidth=0.8)
        low, high = axis.get_xlim()
        for place, marker in ((1 - float(MASS), "o"), (-float(MASS), "o")):
            if low < place < high:
                axis.plot(place, 0, marker, color="0.4", markersize=4)
        axis.set_title(name, fontsize=10)
        axis.set_aspect("equal", adjustable="datalim")
        axis.tick_params(labelsize=6)
    for axis in axes.flat[len(names) :]:
        axis.axis("off")
    figure.tight_layout()
    # Few colours, so that the file is small.
    stream = io.BytesIO()
    figure.savefig(stream, dpi=72)
    path = Path(__file__).parent / "images" / "families.png"
    Image.open(stream).convert("RGB").quantize(32).save(path, optimize=True)


if __name__ == "__main__":
    main()
