"""Which rows of a catalogue: intervals of the period, Jacobi constant, stability index and distances, in any unit."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from orbitproof.explore.names import SECONDS, split_unit
from orbitproof.explore.three_body.catalogues.columns import ALTITUDE, HITS, LEAST
from orbitproof.shared.formats import InputError
from orbitproof.shared.wording import counted

if TYPE_CHECKING:
    from orbitproof.explore.three_body.catalogues.file import Catalogue

QUANTITIES = ("period", "jacobi", "stability", "perilune", "altitude")
"""Perilune: the least distance from the centre of the smaller primary, whatever it is; altitude: from its surface."""


def between(catalogue: Catalogue, quantity: str, low: str | float, high: str | float) -> Catalogue:
    """The rows in which a quantity lies in an interval.

    Arguments:
        low, high: numbers in the units of the catalogue, or texts such as "6.5d", "12h", "3000km", "inf".

    Raises `InputError` for what is no number, a unit that the catalogue does not name, and a missing column.
    """
    least, most = (_value(catalogue, quantity, text) for text in (low, high))
    if not least <= most:
        raise InputError(f"--{quantity} {low} {high}: an empty interval; give the smaller value first")
    values = _values(catalogue, quantity)
    return catalogue.chosen(np.flatnonzero((values >= least) & (values <= most)))


def chosen_rows(catalogue: Catalogue, limits: Mapping[str, tuple[str, str]]) -> Catalogue:
    """The rows in all of the intervals, by the name of the quantity. Raises `InputError`."""
    for quantity, (low, high) in limits.items():
        catalogue = between(catalogue, quantity, low, high)
    return catalogue


def without_hits(catalogue: Catalogue) -> Catalogue:
    """The rows whose orbits do not meet the smaller primary, as far as a column says so."""
    told = catalogue.more.get(HITS)
    return catalogue if told is None else catalogue.chosen(np.flatnonzero([value != "yes" for value in told]))


def left_out(kept: Catalogue, catalogue: Catalogue) -> str:
    """How many rows of a catalogue were left out because their orbits hit the smaller primary, in words."""
    number = len(catalogue) - len(kept)
    return f"{number} of {counted(len(catalogue), 'row')} hit the smaller primary and are left out"


def _values(catalogue: Catalogue, quantity: str) -> Any:
    if quantity == "period":
        return catalogue.periods
    if quantity == "jacobi":
        return catalogue.jacobi_constants
    if quantity == "stability":
        return catalogue.stability_indices
    name = LEAST if quantity == "perilune" else ALTITUDE
    if name not in catalogue.more:
        raise InputError(f"--{quantity}: the catalogue has no column {name}; give --distances to compute it")
    return np.array([np.nan if value in (None, "") else float(value) for value in catalogue.more[name]])


def _value(catalogue: Catalogue, quantity: str, given: str | float) -> float:
    text = str(given).strip().lower()
    number, unit = (text, "") if text in ("inf", "-inf") else split_unit(text, ("km", *SECONDS))
    try:
        value = inf if number == "inf" else float(number)
    except ValueError:
        raise InputError(f"--{quantity} {given}: no number; give one, with km, d, h or s if it is in such") from None
    if not unit or quantity == "altitude":
        return value
    wanted = {"perilune": ("km",), "period": tuple(SECONDS)}.get(quantity, ())
    size = catalogue.lunit if unit == "km" else catalogue.tunit
    if unit not in wanted:
        raise InputError(f"--{quantity} {given}: is not measured in {unit}; leave the unit out")
    if size is None:
        raise InputError(f"--{quantity} {given}: the catalogue names no units; give a number in its own")
    return value / size * (1.0 if unit == "km" else SECONDS[unit])
