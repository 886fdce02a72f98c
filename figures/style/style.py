"""The look of the pictures: style sheet, markers by multiplicity, labels with units."""

from __future__ import annotations

from importlib import resources
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from orbitproof.shared.formats import DOUBLE_RESONANCE, FOLD, KREIN_COLLISION, ORBIT_KINDS, REVERSOR_BREAKING
from orbitproof.shared.systems import BRANCH_SYSTEMS, ReversibleSystem, System

INK = "#222222"
CURVE = "#3c6e91"
SECOND_CURVE = "#a8a8a8"
_MARKERS = {1: "^", 2: "s", 3: "D", 4: "o", 5: "p", 6: "h"}
_COLOURS = {1: "#111111", 2: "#b2182b", 3: "#e08214", 4: "#1b7837", 5: "#762a83", 6: "#2166ac"}
_OF_KIND = {
    FOLD: "v",
    REVERSOR_BREAKING: "X",
    KREIN_COLLISION: "*",
    DOUBLE_RESONANCE: "d",
    **dict.fromkeys(ORBIT_KINDS, "P"),
}
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
    "vzeta": r"\dot{\zeta}",
}
_GREEK = frozenset({
    "alpha", "beta", "gamma", "delta", "epsilon", "varepsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda",
    "mu", "nu", "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta",
    "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega",
})  # fmt: skip


def use_style() -> Any:
    """The style sheet as a context manager."""
    return plt.style.context(str(resources.files("orbitproof.figures.style").joinpath("orbitproof.mplstyle")))


def marker_of(k: int, kind: str = "") -> tuple[str, str]:
    """Marker and colour of multiplicity k, of a fold, a loss of R, a collision, or an orbit that is no bifurcation.

    The shape alone tells which, so that grey prints stay readable.
    """
    return _OF_KIND.get(kind) or _MARKERS.get(k, "*"), _COLOURS.get(k, "#8c510a")


def label_of(system: System, name: str, unit: bool = True) -> str:
    """Axis label of a state coordinate or parameter of a system."""
    known = _TEX.get(name, name) if is_built_in(system) else symbol(name)
    return f"${known}${unit_of(system)}" if unit else f"${known}$"


def level_label(system: ReversibleSystem) -> str:
    """Axis label of the bifurcation parameter: first integral or family parameter."""
    if system.family_parameter is not None:
        return label_of(system, system.family_parameter)
    return f"{system.first_integral_name or 'first integral'}{unit_of(system)}"


def unit_of(system: System) -> str:
    """What an axis says of the unit: that there is none, of equations that were made so; nothing of a user's own."""
    return "  (nondimensional)" if is_built_in(system) else ""


def is_built_in(system: System) -> bool:
    """Whether every installation knows the system, and this module what its names mean."""
    return BRANCH_SYSTEMS.get(system.name) == system


def symbol(name: str) -> str:
    """A name of a user's own as mathematics: Greek letters, digits and what follows _ as index, words upright."""
    stem, _, index = name.partition("_")
    letters = stem.rstrip("0123456789")
    index = ",".join(part for part in (stem[len(letters) :], index.replace("_", ",")) if part)
    if letters == "eps":
        letters = "varepsilon"
    if letters in _GREEK:
        text = rf"\{letters}"
    else:
        text = letters if len(letters) == 1 else rf"\mathrm{{{letters}}}"
    return rf"{text}_{{\mathrm{{{index}}}}}" if index else text


def close(figure: Figure) -> None:
    """Release a figure that is saved."""
    plt.close(figure)
