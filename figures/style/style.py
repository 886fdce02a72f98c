"""The look of the pictures: style sheet, markers by multiplicity, labels with units."""

from __future__ import annotations

from importlib import resources
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from orbitproof.shared.formats import FOLD, ORBIT
from orbitproof.shared.systems import ReversibleSystem

INK = "#222222"
CURVE = "#3c6e91"
SECOND_CURVE = "#a8a8a8"
_MARKERS = {1: "^", 2: "s", 3: "D", 4: "o", 5: "p", 6: "h"}
_COLOURS = {1: "#111111", 2: "#b2182b", 3: "#e08214", 4: "#1b7837", 5: "#762a83", 6: "#2166ac"}
_OF_KIND = {FOLD: "v", ORBIT: "P"}
_TEX = {
    "vx": r"\dot{x}",
    "vy": r"\dot{y}",
    "vz": r"\dot{z}",
    "beta": r"\beta",
    "mu": r"\mu",
    "nu": r"\nu",
    "eps": r"\varepsilon",
    "xi": r"\xi",
    "zeta": r"\zeta",
    "veta": r"\dot{\eta}",
}


def use_style() -> Any:
    """The style sheet as a context manager."""
    return plt.style.context(str(resources.files("orbitproof.figures.style").joinpath("orbitproof.mplstyle")))


def marker_of(k: int, kind: str = "") -> tuple[str, str]:
    """Marker and colour of multiplicity k, of a fold, or of an orbit that is no bifurcation.

    The shape alone tells which, so that grey prints stay readable.
    """
    return _OF_KIND.get(kind) or _MARKERS.get(k, "*"), _COLOURS.get(k, "#8c510a")


def label_of(name: str, unit: bool = True) -> str:
    """Axis label of a state coordinate or parameter; all are nondimensional."""
    text = f"${_TEX.get(name, name)}$"
    return f"{text}  (nondimensional)" if unit else text


def level_label(system: ReversibleSystem) -> str:
    """Axis label of the bifurcation parameter: first integral or family parameter."""
    if system.family_parameter is not None:
        return label_of(system.family_parameter)
    return f"{system.first_integral_name or 'first integral'}  (nondimensional)"


def close(figure: Figure) -> None:
    """Release a figure that is saved."""
    plt.close(figure)
