"""Known bifurcations with high-precision centres, and claims made from them by changing one thing at a time."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import MASS_PARAMETERS
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.evidence import bounds
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import EarlyEnd, Enclosures, IntegratorSettings, enclose_iterates

DATA = Path(__file__).parents[1] / "data" / "known-bifurcations.json"

ACCURACY = Fraction(1, 10**50)
"""How well the centres in the file are known; the last Newton corrections are below 1e-56."""

NAMES = {
    "fs2": "falkner-skan-odd-k2-1",
    "fs3": "falkner-skan-odd-k3-1",
    "fs4": "falkner-skan-odd-k4-1",
    "fs5": "falkner-skan-odd-k5-1",
    "em1": "earth-moon-L1-halo-k1-1",
    "em2": "earth-moon-L1-halo-k2-1",
    "em3": "earth-moon-L1-halo-k3-1",
    "em4": "earth-moon-L1-halo-k4-1",
}

EARTH_MOON = {"mu": MASS_PARAMETERS["earth-moon"]}
SUN_JUPITER = {"mu": MASS_PARAMETERS["sun-jupiter"]}

TOUCH_AND_GO: dict[str, Any] = {
    "id": "touch-and-go",
    "system": "falkner-skan",
    "parameters": {},
    "kind": "touch_and_go",
    "k": 3,
    "centre": ["453.4425868213848226445176819322243780749336", "0.9398485857159715765408704789027875627762"],
    "frame": [["1", "0"], ["3.69989960370449e-7", "1"]],
    "kernel_frame": [["1"]],
    "radii": ["1e-11", "1e-15"],
}
"""A true claim as an entry of a file: the Falkner-Skan equation at its first 1:3 resonance."""

PUBLISHED_POINTS = {
    2: ("340.18753498914353231", "0.939792756949623004649"),
    3: ("453.442586821384637563", "0.939848585715971576498"),
    4: ("679.95415507296894192", "0.939904499164097608161"),
}
"""Resonances 1:k of the Falkner-Skan equation as Theorem FalknerSkan of the paper prints them: beta, y."""


@cache
def _all() -> dict[str, Candidate]:
    return {candidate.id: candidate for candidate in read_candidates(DATA)}


def to_the_end(claim: Candidate, settings: IntegratorSettings, progress: Any = None) -> Enclosures:
    """All iterates, also of claims that are seen to be false on the way."""
    return enclose_iterates(claim, settings, ORACLE, progress, EarlyEnd(settings.accuracy))


def known(name: str) -> Candidate:
    """A true claim, by its key in `NAMES`."""
    return _all()[NAMES[name]]


def shifted(candidate: Candidate, p: tuple[Fraction, ...]) -> Candidate:
    """The same box around the point with coordinates p."""
    centre = tuple(
        middle + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0))
        for middle, row in zip(candidate.centre, candidate.frame, strict=True)
    )
    return replace(candidate, centre=centre)


def moved(candidate: Candidate, direction: int, radii: Fraction | int) -> Candidate:
    """The same box, moved by a multiple of its half-width along one of its directions."""
    p = [Fraction(0)] * len(candidate.radii)
    p[direction] = candidate.radii[direction] * radii
    return shifted(candidate, tuple(p))


def with_radii(candidate: Candidate, *factors: Fraction | int) -> Candidate:
    """The same centre and frame, radii multiplied by one factor or by one each."""
    each = factors * len(candidate.radii) if len(factors) == 1 else factors
    return replace(candidate, radii=tuple(r * Fraction(f) for r, f in zip(candidate.radii, each, strict=True)))


def verdict(candidate: Candidate, max_precision: int = 512) -> str:
    """ "proved", or the condition that is not shown."""
    return verdict_of(certify(candidate, Limits(max_precision=max_precision)))


def verdict_of(certificate: Certificate) -> str:
    """ "proved", or the condition that is not shown."""
    return "proved" if certificate.reason is None else certificate.reason.condition


def coordinates_in_box(candidate: Candidate, point: tuple[Fraction, ...]) -> list[Fraction]:
    """The coordinates p of a point in the candidate's frame: the exact solution of centre + frame p = point."""
    size = len(point)
    rows = [[*row, x - c] for row, x, c in zip(candidate.frame, point, candidate.centre, strict=True)]
    for column in range(size):
        pivot = next(i for i in range(column, size) if rows[i][column])
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [value / rows[column][column] for value in rows[column]]
        for i in range(size):
            if i != column:
                factor = rows[i][column]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[column], strict=True)]
    return [row[-1] for row in rows]


def distances(certificate: Certificate, point: tuple[Fraction, ...]) -> list[Fraction]:
    """How far each coordinate of a point lies outside the enclosures of a certificate; 0 inside."""
    result = []
    for ball, value in zip(certificate.point.values(), point, strict=True):
        lower, upper = bounds(ball)
        result.append(max(lower - value, value - upper, Fraction(0)))
    return result
