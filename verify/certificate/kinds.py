"""The kinds of claims about a box: a table, and what is done with a claim of any of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from typing import Any

from flint import acb, arb

from orbitproof.shared.claims import BoxClaim, Candidate
from orbitproof.shared.errors import InputError
from orbitproof.verify.bifurcation import BifurcationResults
from orbitproof.verify.certificate.bifurcation_rows import BIFURCATIONS
from orbitproof.verify.certificate.breaking_rows import BREAKINGS
from orbitproof.verify.certificate.document import Computation
from orbitproof.verify.certificate.double_resonance_rows import DOUBLE_RESONANCES
from orbitproof.verify.certificate.krein_rows import COLLISIONS
from orbitproof.verify.certificate.levels import Finding, confirmed, overlap
from orbitproof.verify.certificate.orbit_rows import ORBITS
from orbitproof.verify.certificate.periodic_bifurcation_rows import (
    BIFURCATIONS_OF_PERIODIC_ORBITS,
    TORI_AT_PERIODIC_ORBITS,
)
from orbitproof.verify.certificate.periodic_rows import PERIODIC_ORBITS
from orbitproof.verify.certificate.row_kind import Progress, RowKind
from orbitproof.verify.certificate.stable_orbit_rows import STABLE_ORBITS
from orbitproof.verify.certificate.stored_balls import from_json, to_json
from orbitproof.verify.certificate.tori_rows import TORI_AT_ORBITS
from orbitproof.verify.double_resonance import ResonanceEnclosures, ResonanceResults
from orbitproof.verify.evidence import Checklist, Outcome, Proved, Reason, Theorem, ball_from_json
from orbitproof.verify.krein import KreinResults
from orbitproof.verify.orbit import OrbitEnclosures, OrbitResults
from orbitproof.verify.periodic import PeriodicEnclosures, PeriodicResults
from orbitproof.verify.periodic_bifurcation import BifurcationEnclosures, PeriodicBifurcationResults, TorusResults
from orbitproof.verify.poincare import Enclosures, IntegratorSettings
from orbitproof.verify.reversor_breaking import BreakingEnclosures, BreakingResults
from orbitproof.verify.tori import ToriEnclosures, ToriResults
from orbitproof.verify.twist import StableOrbitEnclosures, StableOrbitResults

_ALL: tuple[RowKind[Any, Any, Any], ...] = (
    BIFURCATIONS, ORBITS, STABLE_ORBITS, TORI_AT_ORBITS, BREAKINGS, COLLISIONS, DOUBLE_RESONANCES, PERIODIC_ORBITS,
    BIFURCATIONS_OF_PERIODIC_ORBITS, TORI_AT_PERIODIC_ORBITS,
)  # fmt: skip
Found = (
    Enclosures
    | OrbitEnclosures
    | StableOrbitEnclosures
    | ToriEnclosures
    | BreakingEnclosures
    | ResonanceEnclosures
    | PeriodicEnclosures
    | BifurcationEnclosures
)
Results = (
    BifurcationResults
    | OrbitResults
    | StableOrbitResults
    | ToriResults
    | BreakingResults
    | KreinResults
    | ResonanceResults
    | PeriodicResults
    | PeriodicBifurcationResults
    | TorusResults
)

KINDS: Mapping[str, RowKind[Any, Any, Any]] = {name: kind for kind in _ALL for name in kind.names}
"""By the kinds of claims as candidates say them."""


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
        return dict(to_json(found))
    except (KeyError, ValueError):
        return None


def tables_from_json(entry: Mapping[str, Any], candidate: BoxClaim, computation: Computation) -> Found:
    """The same enclosures, those of a claim. Raises `ValueError` that names what cannot be read."""
    kind = kind_of(candidate)
    try:
        found: Found = from_json(kind.enclosures, entry, "enclosures")
    except InputError as error:
        raise ValueError(str(error)) from None
    except (KeyError, TypeError):
        raise ValueError("the enclosures are those of another kind of claim") from None
    variables = kind.variables(candidate)
    for place, _ in _numbers(found, ()):
        index = place[-1]
        if isinstance(index, tuple) and len(index) != variables:
            raise ValueError(f"{_said(place)}: a derivative in {len(index)} variables, not {variables}")
    if to_json(found) != entry:
        raise ValueError("the enclosures hold something that is none of such a claim")
    made = {name: getattr(computation, name) for name in ("order", "precision", "steps", "coordinates")}
    return replace(found, **{name: value for name, value in made.items() if value is not None})


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
    old, new = numbers(stored), numbers(fresh)
    if type(stored) is not type(fresh) or old.keys() != new.keys():
        raise ValueError(f"{place}: the tables do not belong to each other")
    for name, value in old.items():
        if isinstance(value, arb):
            yield f"{place}, {name}", value, new[name]
        elif value != new[name]:
            raise ValueError(f"{place}: the tables do not belong to each other: {name} is another one")


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
    results: Any = found.results
    old, new = numbers(from_json(type(results), stored["results"], "results")), numbers(results)
    if old.keys() != new.keys():
        yield Finding(place, "other results are found: " + ", ".join(sorted(old.keys() ^ new.keys())))
        return
    for name, value in old.items():
        if isinstance(value, arb) and isinstance(new[name], arb):
            yield from confirmed(value, new[name], f"{place}, {name}")
        elif value != new[name]:
            yield Finding(f"{place}, {name}", f"stored is {value!r}, found {new[name]!r}")


def numbers(value: Any) -> dict[str, Any]:
    """The balls, and the words and numbers beside them, of what was enclosed or found, by where they stand.

    Raises `ValueError` if one would hide another.
    """
    found = list(_numbers(value, ()))
    named = {_said(place): leaf for place, leaf in found}
    if len(named) != len(found):
        raise ValueError("two of the numbers that are enclosed have one name")
    return named


_Place = tuple[Any, ...]


def _said(place: _Place) -> str:
    return " ".join(map(str, place))


def _numbers(value: Any, place: _Place) -> Iterator[tuple[_Place, Any]]:
    if isinstance(value, acb):
        value = {"real": value.real, "imaginary": value.imag}
    if is_dataclass(value):
        value = {each.name: getattr(value, each.name) for each in fields(value) if not each.metadata.get("hidden")}
    if isinstance(value, (Mapping, list, tuple)):
        for key, inner in value.items() if isinstance(value, Mapping) else enumerate(value, start=1):
            yield from _numbers(inner, (*place, key))
    else:
        yield place, value
