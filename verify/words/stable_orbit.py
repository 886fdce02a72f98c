"""The theorem about an orbit that is stable for ever in words, and what was found of it (section 28.6)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.formats import Candidate
from orbitproof.verify.claim import claim_in_words, names_in_words
from orbitproof.verify.evidence import decimal_above, interval_text, is_positive
from orbitproof.verify.orbit import OrbitTheorem
from orbitproof.verify.twist import StableOrbitResults, StableOrbitTheorem
from orbitproof.verify.words.orbit import orbit_found, orbit_in_words

_DIGITS = 40


def stable_orbit_in_words(theorem: StableOrbitTheorem) -> str:
    """The theorem, in short."""
    candidate = claim_in_words(theorem.claim)
    system = candidate.system
    varies = "" if system.family_parameter is None else f" at the value of {system.family_parameter} at x"
    if system.first_integral is None:
        where, beside = "the section", ""
    else:
        name = system.first_integral_name or "H"
        name = name if name == "H" else f"the {name}"
        where, beside = f"the level of {name} through x", f", whatever its value of {name},"
    return (
        f"{orbit_in_words(OrbitTheorem(theorem.claim))} Its multipliers{' on that level' if beside else ''} are exp(i "
        "omega) and exp(-i omega), 0 < omega < pi, none of their powers 1 to 4 is 1, and the twist of the map that "
        f"follows the orbits for a period, on {where}{varies}, is not 0. Hence every neighbourhood of x in {where} "
        "contains closed curves around x that this map leaves invariant, and the orbit of x is stable for ever in the "
        f"system with exactly the coordinates {', '.join(system.given_state)}{varies}: every neighbourhood of it "
        f"contains a neighbourhood of it from which no solution{beside} leaves the first one, at any time, past or "
        "future. Nothing is said of other systems: of motion in further coordinates, of other values of parameters, of "
        "other forces."
    )


def stable_orbit_found(candidate: Candidate, found: StableOrbitResults) -> Iterator[str]:
    """What was found, in lines."""
    yield from orbit_found(candidate, found)
    names = names_in_words(candidate.system)
    t, q = (names.get(name, name) for name in (found.twist_coordinate, found.twist_momentum))
    grows = "grows" if is_positive(found.twist) else "falls"
    yield f"The rotation number omega/(2 pi) lies in {interval_text(found.rotation_number, _DIGITS)}."
    yield (
        f"The twist, in the coordinates ({t}, {q}), lies in {interval_text(found.twist, _DIGITS)}: a small invariant "
        f"curve that encloses the area A is turned by omega + twist A/pi in a period, to first order in A; the angle "
        f"{grows} with the distance from the orbit."
    )
    yield (
        f"The real part of the same coefficient, which is 0 by reversibility, lies in "
        f"{interval_text(found.defect, _DIGITS)}: at most {decimal_above(abs(found.defect) / abs(found.twist))} of the "
        "twist."
    )
