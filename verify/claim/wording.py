"""The names of a system in the words of a theorem, apart from the theorem's own symbols (section 1.5).

A coordinate may be called H and a parameter P. Where a theorem has such a name it says what it is, H_coordinate and
P_parameter; H and P are then the theorem's own. Names of the systems that every installation knows are no such ones.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from orbitproof.shared.systems import ReversibleSystem, System
from orbitproof.verify.evidence import exact_text

if TYPE_CHECKING:
    from orbitproof.shared.formats import Atlas, Candidate

_KINDS = ("coordinate", "parameter", "symmetry")
_SYMBOL = re.compile(rf"(A|Fix|H|P|Q|R|Sigma|T|X|i|j|k|omega|pi|s|[pPRs]_[0-9]+)(_({'|'.join(_KINDS)}))*")
"""What theorems call something; and what is made of such a name, so that no two names become the same."""

Value = TypeVar("Value")


def names_in_words(system: System) -> dict[str, str]:
    """How those names of a system are written that would be symbols of a theorem."""
    symmetries = system.symmetries if isinstance(system, ReversibleSystem) else ()
    groups = (system.state, system.parameters, symmetries)
    return {
        name: f"{name}_{kind}"
        for kind, names in zip(_KINDS, groups, strict=True)
        for name in names
        if _SYMBOL.fullmatch(name)
    }


def keyed_in_words(system: System, values: Mapping[str, Value]) -> dict[str, Value]:
    """Values by names of a system, by those names as they are written."""
    names = names_in_words(system)
    return {names.get(name, name): value for name, value in values.items()}


def system_in_words(system: ReversibleSystem) -> ReversibleSystem:
    """The system with its names as they are written; itself if that is how it has them."""
    names = names_in_words(system)
    integral = system.first_integral_name
    taken = integral in (*system.state, *system.parameters) or (
        integral is not None and integral != "H" and _SYMBOL.fullmatch(integral) is not None
    )
    if not names and not taken:
        return system

    def written(name: str | None) -> str | None:
        return None if name is None else names.get(name, name)

    return replace(
        system,
        state=tuple(names.get(name, name) for name in system.state),
        defined=tuple(replace(each, name=names.get(each.name, each.name)) for each in system.defined),
        parameters=keyed_in_words(system, system.parameters),
        symmetries=keyed_in_words(system, system.symmetries),
        section=names.get(system.section, system.section),
        family_parameter=written(system.family_parameter),
        level_coordinate=written(system.level_coordinate),
        first_integral_name="first integral" if taken else integral,
    )


def sheet_in_words(system: ReversibleSystem) -> str:
    """Which points of a fixed level are meant: w > 0, or 1/2 < w < 3."""
    level = system.fixed_level
    assert level is not None
    if level.between is None:
        return f"{system.level_coordinate} {'>' if level.sign == 1 else '<'} 0"
    low, high = map(exact_text, level.between)
    return f"{low} < {system.level_coordinate} < {high}"


def claim_in_words(candidate: Candidate) -> Candidate:
    """The claim with the names of its system as they are written."""
    system, names = system_in_words(candidate.system), names_in_words(candidate.system)
    if system is candidate.system:
        return candidate
    equation = candidate.equation
    if equation is not None and equation.coordinate is not None:
        equation = replace(equation, coordinate=names.get(equation.coordinate, equation.coordinate))
    symmetry = candidate.symmetry
    return replace(
        candidate,
        system=system,
        parameters=keyed_in_words(candidate.system, candidate.parameters),
        symmetry=None if symmetry is None else names.get(symmetry, symmetry),
        equation=equation,
    )


def atlas_in_words(atlas: Atlas) -> Atlas:
    """An atlas with the names that sentences may use; its pieces are left alone."""
    system, names = system_in_words(atlas.system), names_in_words(atlas.system)
    if system is atlas.system:
        return atlas
    claim, covers = atlas.claim, atlas.claim.covers
    claim = replace(
        claim,
        symmetry=None if claim.symmetry is None else names.get(claim.symmetry, claim.symmetry),
        increasing=tuple(names.get(name, name) for name in claim.increasing),
        covers=None if covers is None else replace(covers, coordinate=names.get(covers.coordinate, covers.coordinate)),
    )
    return replace(atlas, system=system, parameters=keyed_in_words(atlas.system, atlas.parameters), claim=claim)
