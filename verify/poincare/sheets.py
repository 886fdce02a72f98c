"""On which sheet of a fixed level points are (section 12.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import arb

from orbitproof.shared.systems import FixedLevel, ReversibleSystem
from orbitproof.verify.evidence import IntegrationFailure, is_positive


def on_sheet(system: ReversibleSystem, values: Sequence[arb]) -> ReversibleSystem:
    """The system with that sheet of its fixed level, if it has one, on which points are (sections 18.3 and 19.3).

    Args:
        values: balls that contain the level coordinates of all of them.

    Raises `IntegrationFailure` unless these have one sign.
    """
    level = system.fixed_level
    for sign in (1, -1):
        if level is None or (values and all(is_positive(sign * value) for value in values)):
            return system if level is None else replace(system, fixed_level=FixedLevel(level.value, sign))
    message = f"{system.level_coordinate} is not shown to have one sign at the other points of the orbits"
    raise IntegrationFailure("sheet", message, "give a narrower piece, or smaller radii", needs_precision=True)
