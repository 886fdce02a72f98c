"""Enclosures from which the stability of an orbit is shown: those of the orbit, and a half return about it (28.1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

from orbitproof.shared.formats import Candidate
from orbitproof.verify.orbit import OrbitEnclosures, enclose_orbit
from orbitproof.verify.poincare import HalfReturn, IntegratorSettings, WideOracle, enclose_half_return


@dataclass(frozen=True, kw_only=True)
class StableOrbitEnclosures(OrbitEnclosures):
    """What is known of the orbits of a box, and of the points of the section about them.

    Attributes:
        half_return: derivatives up to order 3 of the half return, by the coordinates of the section.
    """

    half_return: HalfReturn


def enclose_stable_orbit(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: WideOracle,
    progress: Callable[[float], None] | None = None,
) -> StableOrbitEnclosures:
    """Follow the box of a claim, and the points of the section about it; see `enclose_orbit`."""
    report = progress or (lambda _fraction: None)
    orbit = enclose_orbit(candidate, settings, oracle, lambda fraction: report(fraction / 2))
    half = enclose_half_return(candidate, settings, oracle, lambda fraction: report((1 + fraction) / 2))
    return StableOrbitEnclosures(
        **{each.name: getattr(orbit, each.name) for each in fields(OrbitEnclosures)}, half_return=half
    )
