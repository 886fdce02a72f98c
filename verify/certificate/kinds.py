"""The kinds of claims about a box: a table, and what is done with a claim of any of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.shared.claims import BoxClaim, Candidate
from orbitproof.verify.bifurcation import BifurcationResults
from orbitproof.verify.certificate.bifurcation_rows import BIFURCATIONS
from orbitproof.verify.certificate.levels import Finding, confirmed, overlap
from orbitproof.verify.certificate.orbit_rows import ORBITS
from orbitproof.verify.certificate.periodic_bifurcation_rows import BIFURCATIONS_OF_PERIODIC_ORBITS
from orbitproof.verify.certificate.periodic_rows import PERIODIC_ORBITS
from orbitproof.verify.certificate.row_kind import Progress, RowKind, all_numbers
from orbitproof.verify.evidence import Checklist, Outcome, Proved, Reason, Theorem, ball_from_json
from orbitproof.verify.orbit import OrbitEnclosures, OrbitResults
from orbitproof.verify.periodic import PeriodicEnclosures, PeriodicResults
from orbitproof.verify.poincare import Enclosures, IntegratorSettings

Found = Enclosures | OrbitEnclosures | PeriodicEnclosures
Results = BifurcationResults | OrbitResults | PeriodicResults

_ALL: tuple[RowKind[Any, Any, Any], ...] = (BIFURCATIONS, ORBITS, PERIODIC_ORBITS, BIFURCATIONS_OF_PERIODIC_ORBITS)

KINDS: Mapping[str, RowKind[Any, Any, Any]] = {name: kind for kind in _ALL for name in kind.names}
"""By the kinds of claims as candidates say them."""


def kind_named(name: str) -> RowKind[Any, Any, Any]:
    """The kind of claims with a name; a file may say one that is none, until it is checked: as if of a bifurcation."""
    return KINDS.get(name, BIFURCATIONS)


def kind_of(candidate: BoxClaim) -> RowKind[Any, Any, Any]:
    """The kind of a claim."""
    return KINDS[candidate.kind]


def theorem_of(candidate: BoxClaim, form: Candidate | None = None) -> Theorem | Reason:
    """The theorem that a candidate claims, or why none applies; `form` is its level form, if that is checked."""
    return kind_of(candidate).theorem_of(candidate, form)


def level_form(candidate: BoxClaim) -> Candidate | None:
    """The same claim with the level of the first integral as parameter, if there is one."""
    form: Candidate | None = kind_of(candidate).level_form(candidate)
    return form


def check_exactly(checklist: Checklist, candidate: BoxClaim) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    kind_of(candidate).check_exactly(checklist, candidate)


def enclose(candidate: BoxClaim, settings: IntegratorSettings, progress: Progress | None = None) -> Found:
    """What its proof is evaluated from. Raises `IntegrationFailure` if something could not be enclosed, or another
    `NotEstablishedError` if the claim is seen to be false on the way.
    """
    found: Found = kind_of(candidate).enclose(candidate, settings, progress)
    return found


def prove(candidate: BoxClaim, checklist: Checklist, found: Found | None) -> Outcome[Results]:
    """Check the claim, given what was enclosed, if anything; enclosures of another kind of claim are none."""
    kind = kind_of(candidate)
    outcome: Outcome[Results] = kind.prove(candidate, checklist, found if isinstance(found, kind.enclosures) else None)
    return outcome


def tables_to_json(found: Found) -> dict[str, Any] | None:
    """All derivatives and numbers, exactly; `None` if one is not finite, which proves nothing anyway."""
    try:
        return _kind_of_enclosures(found).to_json(found)
    except (KeyError, ValueError):
        return None


def tables_from_json(entry: Mapping[str, Any], candidate: BoxClaim, computation: Mapping[str, Any]) -> Found:
    """The same enclosures, those of a claim. Raises `ValueError` that names what cannot be read."""
    kind = kind_of(candidate)
    if set(entry) != kind.keys:
        raise ValueError("the enclosures are those of another kind of claim")
    found: Found = kind.from_json(entry, len(candidate.radii), computation)
    if kind.to_json(found) != entry:
        raise ValueError("the enclosures hold something that is none of such a claim")
    return found


def _kind_of_enclosures(found: Found) -> RowKind[Any, Any, Any]:
    return next(kind for kind in KINDS.values() if isinstance(found, kind.enclosures))


def contradictions(stored: Found, fresh: Found, place: str) -> Iterator[Finding]:
    """Where two enclosures of the same numbers have no common point, or are not of the same numbers."""
    for name, old, new in _pairs(stored, fresh, place):
        yield from overlap(old, new, name)


def too_narrow(stored: Found, fresh: Found, place: str) -> Iterator[Finding]:
    """Where new enclosures of the same numbers reach out of the stored ones by more than these are wide."""
    for name, old, new in _pairs(stored, fresh, place):
        yield from confirmed(old, new, name, _REACH)


_REACH = Fraction(1)
"""By how much of its width an entry of a table may be exceeded: those that are zero by symmetry are known up to the
underflow of bounds only, whatever the precision."""


def _pairs(stored: Found, fresh: Found, place: str) -> Iterator[tuple[str, arb, arb]]:
    """Two enclosures of each number. Raises `ValueError` if they are not of the same numbers."""
    kinds = _kind_of_enclosures(stored), _kind_of_enclosures(fresh)
    old, new = all_numbers(kinds[0], stored), all_numbers(kinds[1], fresh)
    if kinds[0] is not kinds[1] or old.keys() != new.keys():
        raise ValueError(f"{place}: the tables do not belong to each other")
    for name, ball in old.items():
        yield f"{place}, {name}", ball, new[name]


def unconfirmed(stored: Mapping[str, Any], found: Proved[Results], place: str) -> Iterator[Finding]:
    """What a certificate says of the hypotheses and results, and what a new proof does not confirm."""
    old_entries = {entry["name"]: entry["enclosures"] for entry in stored["hypotheses"]}
    for hypothesis in found.hypotheses:
        for name, old in old_entries[hypothesis.name].items():
            where = f"{place}, hypothesis {hypothesis.name}, {name}"
            if name not in hypothesis.enclosures:
                yield Finding(where, "is not enclosed again")
            else:
                yield from confirmed(ball_from_json(old), hypothesis.enclosures[name], where)
    kind = next(kind for kind in KINDS.values() if isinstance(found.results, kind.results))
    yield from kind.unconfirmed(stored["results"], found.results, place)
