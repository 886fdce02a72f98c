"""Stability for ever along a curve in words (section 29.6)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.formats import Atlas
from orbitproof.shared.wording import itemised
from orbitproof.verify.claim import atlas_in_words
from orbitproof.verify.evidence import decimal_above
from orbitproof.verify.lasting import (
    ExceptionalOrbit,
    Fate,
    LastingInterval,
    LastingTheorem,
    ProvedLasting,
    Reversibility,
)
from orbitproof.verify.stability import level_name
from orbitproof.verify.words.complete_list import gap_in_words, half, interval_in_words, part, point_in_words

_FATES = {
    Fate.STABLE: "stable for ever",
    Fate.UNSTABLE: "unstable",
    Fate.OPEN: "whether it is stable is not said",
}
_ODD = "a symmetry of the system fixes it and makes its return map odd"
_SIGNS = {1: "positive", -1: "negative"}


def lasting_in_words(theorem: LastingTheorem, known: ProvedLasting) -> str:
    """Which orbits of a curve are stable for ever, which are unstable, and which exceptions there are."""
    atlas, lasting = atlas_in_words(theorem.curve.atlas), known.lasting
    lines = [
        "An orbit is stable for ever if each neighbourhood of it contains a neighbourhood of it such that solutions "
        "that begin there exist for all times, positive and negative, and stay in the first: "
        f"{_where(atlas)}. The twist of a linearly stable orbit is positive if the angle in (0, pi) by which the "
        "return map turns grows with the distance from the orbit."
    ]
    entries = [_stable(atlas, entry) for entry in lasting.stable]
    lines += itemised(
        "All orbits between the following points, themselves not included, but ends of the curve included, are stable "
        "for ever, with invariant tori in each neighbourhood, and their twist has the sign named:",
        entries,
    )
    if not entries:
        lines.append(f"No orbit of {part(atlas)} is shown to be stable for ever.")
    lines.append(
        f"{_but(lasting.undecided)} the other orbits of {part(atlas)}{_but_for(lasting.exceptions)} have a multiplier "
        "outside the unit circle, and are unstable."
    )
    lines += itemised("The exceptions:", [_exception(atlas, entry) for entry in lasting.exceptions])
    lines += itemised(
        "At and between these places it is not decided whether orbits are stable for ever:",
        [interval_in_words(atlas, entry) for entry in lasting.undecided],
    )
    lines += itemised("There the twist is not decided:", map(gap_in_words, lasting.gaps))
    if known.reversibility is not None:
        lines.append(_reversibility(known.reversibility))
    lines.append("Nothing is said of perturbations that leave this system.")
    if half(atlas):
        lines.append("The same is true of the mirror images.")
    return "\n".join(lines)


def _reversibility(shown: Reversibility) -> str:
    """How well what has to be 0 is enclosed, and of what this is a check."""
    count, sharp = shown.intervals, shown.sharp
    of_all = "each of the" if count > 1 else "the"
    text = (
        f"A check: on {of_all} {count} proved interval{'s' if count > 1 else ''} on which functions of the twist are "
        "stored, a function D that is 0 for every reversible map is enclosed as the twist is, and 0 lies in its "
        f"enclosure: what is known of D is at most {decimal_above(shown.known_part)} of the bound of what is not"
    )
    if shown.bound is not None:
        on = "and" if sharp == count else f"and, on {sharp} of them,"
        text += f", {on} this bound at most {decimal_above(shown.bound)} of the largest |Theta| there"
    if sharp < count:
        text += f"; on {count - sharp} the bound is larger than |Theta| is shown to become"
    return (
        f"{text}. The sign of the twist follows from that of Theta, the imaginary part of what D is the real part of. "
        "The return map is made of that of half an orbit so that it is reversible: this checks how Theta is "
        "calculated, not how orbits are followed."
    )


def _where(atlas: Atlas) -> str:
    """In which system orbits are stable."""
    names = ", ".join(atlas.system.given_state)
    if atlas.system.family_parameter is not None:
        return f"in the system with the states ({names}), at the value of {level_name(atlas)} that belongs to the orbit"
    return f"in the system with the states ({names}), on all neighbouring levels of the {level_name(atlas)}"


def _but(undecided: Sequence[object]) -> str:
    return "But for the places named below," if undecided else "All"


def _but_for(exceptions: Sequence[object]) -> str:
    return ", but for the exceptions listed here," if exceptions else ""


def _stable(atlas: Atlas, entry: LastingInterval) -> str:
    return f"{interval_in_words(atlas, entry.between)}; twist {_SIGNS[entry.sign]}"


def _exception(atlas: Atlas, entry: ExceptionalOrbit) -> str:
    why = f", as {_ODD}" if entry.point.k == 3 and entry.fate is Fate.STABLE else ""
    return f"{point_in_words(atlas, entry.point)}: {_FATES[entry.fate]}{why}"
