"""The picture of the families by name: ``python docs/families.py`` writes docs/images/families.png."""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.ticker import MaxNLocator
from PIL import Image

from orbitproof.explore.families import Limits
from orbitproof.explore.flow import flow_batch
from orbitproof.explore.three_body.catalogues.without_symmetry import triangular_catalogue
from orbitproof.explore.three_body.families import trace_family
from orbitproof.explore.three_body.names import FAMILY_NAMES, WITHOUT_SYMMETRY
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

MASS = MASS_PARAMETERS["jpl-earth-moon"]
STATES = 600
LOOKS = (("#0b3c5d", "solid"), ("#c0392b", (0, (6, 2))), ("#3b8f5a", (0, (2, 1.5))))
"""Colour and line of the orbits, from the beginning of the family on."""
KINDS = ("butterfly", "dragonfly", "dro", "dpo", "lpo-east", "lpo-west", "resonant")


def orbits_of(name: str) -> list[tuple[np.ndarray, float]]:
    """First states and periods of three orbits, along the family."""
    if name in WITHOUT_SYMMETRY:
        rows, _ = triangular_catalogue(name, MASS, "jpl-earth-moon", 60)
        return [
            (rows.states[i], float(rows.periods[i])) for i in np.linspace(len(rows) // 6, len(rows) - 1, 3).astype(int)
        ]
    family = trace_family(CR3BP, name, {"mu": MASS}, Limits(120))
    chosen = np.linspace(len(family.orbits) // 6, len(family.orbits) - 1, 3).astype(int)
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
    pyplot.rcParams.update({"font.size": 11, "axes.titlesize": 13})
    figure, axes = pyplot.subplots(7, 3, figsize=(10.5, 24))
    for axis, name in zip(axes.flat, names, strict=True):
        orbits = [path_of(state, period) for state, period in orbits_of(name)]
        # The view from above, or from the side of orbits that leave the plane.
        up = 2 if max(np.abs(orbit[:, 2]).max() for orbit in orbits) > 1e-6 else 1
        for (colour, style), orbit in zip(LOOKS, orbits, strict=True):
            axis.plot(orbit[:, 0], orbit[:, up], color=colour, linestyle=style, linewidth=1.5)
        low, high = axis.get_xlim()
        for place, body, shift, side in ((1 - float(MASS), "Moon", 4, "left"), (-float(MASS), "Earth", -4, "right")):
            if low < place < high:
                axis.plot(place, 0, "o", color="black", markersize=4)
                axis.annotate(body, (place, 0), (shift, 5), textcoords="offset points", fontsize=10, ha=side)
        axis.set_title(name)
        axis.set_xlabel("x")
        axis.set_ylabel("xyz"[up])
        axis.set_aspect("equal", adjustable="datalim")
        axis.xaxis.set_major_locator(MaxNLocator(5))
        axis.yaxis.set_major_locator(MaxNLocator(5))
        axis.grid(color="0.9", linewidth=0.6)
    figure.tight_layout()
    # Few colours, so that the file is small.
    stream = io.BytesIO()
    figure.savefig(stream, dpi=80)
    path = Path(__file__).parent / "images" / "families.png"
    Image.open(stream).convert("RGB").quantize(32).save(path, optimize=True)


if __name__ == "__main__":
    main()
