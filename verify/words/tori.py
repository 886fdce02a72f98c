"""The theorem about invariant tori near one orbit in words, and what was found of them (section 30.6)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.formats import Candidate
from orbitproof.verify.evidence import decimal_interval
from orbitproof.verify.orbit import OrbitTheorem
from orbitproof.verify.tori import ToriResults, ToriTheorem
from orbitproof.verify.words.orbit import orbit_found, orbit_in_words

_DIGITS = 40


def tori_in_words(theorem: ToriTheorem) -> str:
    """The theorem, in short."""
    where = _where(theorem.claim)
    return (
        f"{orbit_in_words(OrbitTheorem(theorem.claim))} Invariant tori accumulate at this orbit: {where}, every "
        "neighbourhood of the orbit contains tori of dimension 3 that are invariant under the flow, the motion on each "
        "of them being quasi-periodic. This holds because the orbit has two different pairs of conjugate multipliers "
        "on the unit circle without resonance up to order 4, and the torsion of the full return at x has a determinant "
        "that is not 0. It is not stability: tori of dimension 3 do not separate the set of dimension 5 in which they "
        "lie, and nothing is said of the orbits between them, nor how large or how near the tori are."
    )


def _where(candidate: Candidate) -> str:
    system = candidate.system
    if system.family_parameter is None:
        return "on its level of the first integral"
    if system.fixed_level is None:
        return "at its value of the family parameter"
    return "on the level, at its value of the family parameter"


def tori_found(candidate: Candidate, found: ToriResults) -> Iterator[str]:
    """What was found, in lines."""
    yield from orbit_found(candidate, found)
    first, second = (decimal_interval(value, _DIGITS) for value in found.rotation_numbers)
    yield (
        f"The rotation numbers of the full return at x, omega_1/(2 pi) and omega_2/(2 pi) with multipliers "
        f"exp(i omega_j), lie in {first} and {second}."
    )
    entries = ", ".join(
        f"tau_{j}{position} in {decimal_interval(value, _DIGITS)}"
        for j, row in enumerate(found.torsion, start=1)
        for position, value in enumerate(row, start=1)
    )
    yield (
        "In its normal form z_j -> exp(i omega_j) z_j (1 + i tau_j1 |z_1|^2 + i tau_j2 |z_2|^2) + terms of higher "
        f"order, in coordinates as in section 30.2, there are {entries}; the determinant lies in "
        f"{decimal_interval(found.torsion_determinant, _DIGITS)}."
    )
    yield "That the orbit is stable is not claimed."
