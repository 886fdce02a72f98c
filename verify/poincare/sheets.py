"""On which sheet of a fixed level points are (sections 12.5 and 12.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb

from orbitproof.shared.systems import FixedLevel, ReversibleSystem
from orbitproof.verify.claim import is_in
from orbitproof.verify.evidence import IntegrationFailure, all_finite, exact_value, hull

_MARGIN = Fraction(1, 1024)


def on_sheet(system: ReversibleSystem, values: Sequence[arb]) -> ReversibleSystem:
    """The system with that sheet of its fixed level, if it has one, on which points are (sections 18.3 and 19.3).

    Args:
        values: balls that contain the level coordinates of all of them.

    Raises `IntegrationFailure` unless these have one sign, if that is what says the sheet.
    """
    level = system.fixed_level
    if level is None:
        return system
    for sheet in _sheets(level, values):
        if values and all(is_in(sheet, value) for value in values):
            return replace(system, fixed_level=sheet)
    what = "have one sign" if level.between is None else "be enclosed"
    message = f"{system.level_coordinate} is not shown to {what} at the other points of the orbits"
    raise IntegrationFailure("sheet", message, "give a narrower piece, or smaller radii", needs_precision=True)


def _sheets(level: FixedLevel, values: Sequence[arb]) -> list[FixedLevel]:
    """The sheets that points may be on."""
    if level.between is None:
        return [FixedLevel(level.value, sign) for sign in (1, -1)]
    if not all_finite(values):
        return []
    around = hull(*values)
    middle = exact_value(around.mid())
    reach = 2 * exact_value(around.rad()) + (1 + abs(middle)) * _MARGIN
    return [FixedLevel(level.value, between=(middle - reach, middle + reach))]
