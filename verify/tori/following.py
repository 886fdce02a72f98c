"""What is enclosed of an orbit at which tori are claimed to accumulate (section 30.1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

from orbitproof.shared.formats import Candidate
from orbitproof.verify.orbit import OrbitEnclosures, enclose_orbit
from orbitproof.verify.poincare import HalfReturn, IntegratorSettings, WideOracle, enclose_half_return

_ORBIT_PART = 0.5
"""About the part of the work that the orbit itself takes."""


@dataclass(frozen=True, kw_only=True)
class ToriEnclosures(OrbitEnclosures):
    """As for an orbit, and the half return about its box.

    Attributes:
        half_return: its derivatives by all coordinates of the section.
    """

    half_return: HalfReturn


def enclose_tori(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: WideOracle,
    progress: Callable[[float], None] | None = None,
) -> ToriEnclosures:
    """Follow the orbits of a box, and the points of the section about it. As `enclose_orbit`."""
    report = progress or (lambda _fraction: None)
    orbit = enclose_orbit(candidate, settings, oracle, lambda done: report(_ORBIT_PART * done))
    half = enclose_half_return(candidate, settings, oracle, lambda done: report(_ORBIT_PART + (1 - _ORBIT_PART) * done))
    return ToriEnclosures(**{each.name: getattr(orbit, each.name) for each in fields(orbit)}, half_return=half)
