"""The kinds of theorems: a table, and what is done with a claim about a box of any of them.

A kind is a module of `verify.theorems`, found by name when the first claim of it is met: no other kind is loaded.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from importlib import import_module
from typing import Any, cast

from flint import acb, arb

from orbitproof.shared.claims import (
    ATLASES_WITHOUT_REVERSOR,
    BOX_KINDS,
    CLAIMS,
    KINDS,
    KINDS_WITHOUT_REVERSOR,
    PERIODIC,
    PERIODIC_BIFURCATIONS,
    PERIODIC_TORUS,
    SURFACE,
    BoxClaim,
    Candidate,
)
from orbitproof.shared.errors import InputError
from orbitproof.verify.certificate.document import Computation
from orbitproof.verify.certificate.kind import BoxKind, Kind, Progress
from orbitproof.verify.certificate.levels import Finding, confirmed, overlap
from orbitproof.verify.certificate.stored_balls import from_json, to_json
from orbitproof.verify.evidence import Checklist, Outcome, Reason, Theorem
from orbitproof.verify.poincare import IntegratorSettings

Found = Any
"""What a proof of some kind is evaluated from: its `Kind.enclosures`."""
Results = Any
"""What is proved of some kind: its `Kind.results`."""

_CALLED: Mapping[str, str] = {
    **dict.fromkeys(KINDS, "bifurcation"),
    PERIODIC: "periodic_orbit",
    **dict.fromkeys(PERIODIC_BIFURCATIONS, "periodic_bifurcation"),
    PERIODIC_TORUS: "periodic_torus",
}
MODULES: Mapping[str, str] = {name: _CALLED.get(name, name) for name in (*BOX_KINDS, *KINDS_WITHOUT_REVERSOR)}
"""Modules of `verify.theorems`, by the kinds of claims about a box: called as these, but for those of `_CALLED`."""

JOINED = WEB, LIFE, INDEX, CATALOGUE = "web", "life", "index", "catalogue"  # rest on other certificates
FURTHER: Mapping[str, str] = {
    **dict.fromkeys(CLAIMS, "curve"),
    SURFACE: "surface",
    # Called as the module of the claim.
    **{name: atlas.__module__.rpartition(".")[2] for name, atlas in ATLASES_WITHOUT_REVERSOR.items()},
    **{name: name for name in JOINED},
}
"""The other kinds of theorems, by the kinds of claims about branches as atlases say them, or what is joined."""


@cache
def kind_named(name: str) -> Kind:
    """The kind of theorems that claims or certificates call so. Raises `KeyError` for another name."""
    module = MODULES[name] if name in MODULES else FURTHER[name]
    return cast(Kind, import_module(f"orbitproof.verify.theorems.{module}").KIND)


def box_kind(name: str) -> BoxKind[Any, Any, Any]:
    """The kind of claims about a box that candidates call so. Raises `KeyError` for another name."""
    return cast(BoxKind[Any, Any, Any], kind_named(name if name in MODULES else ""))


def name_of(document: Mapping[str, Any]) -> str:
    """The name of the kind of theorem that a document is about, as far as it says so: a branch is a curve if not.

    Raises `InputError` for a format that is that of no certificate.
    """
    schema = document.get("format", "orbitproof-").removeprefix("orbitproof-").removesuffix("-certificate")
    if schema == "atlas":
        claim = document["statement"]["atlas"].get("claim", {})
        name = claim.get("kind") if isinstance(claim, Mapping) else None
        return str(name) if name in FURTHER and name not in JOINED else CLAIMS[0]
    if schema and schema not in JOINED:
        raise InputError(f"format: {document['format']!r} is that of no certificate; give one")
    return str(schema or document["statement"]["candidate"]["kind"])


def kind_of(candidate: BoxClaim) -> BoxKind[Any, Any, Any]:
    """The kind of a claim about a box."""
    return box_kind(candidate.kind)


def theorem_of(candidate: BoxClaim, form: Candidate | None = None) -> Theorem | Reason:
    """The theorem that a candidate claims, or why none applies; `form` is its level form, if that is checked."""
    return kind_of(candidate).theorem_of(candidate, form)


def level_form(candidate: BoxClaim) -> Candidate | None:
    """The claim with the level of the first integral as parameter, if there is one."""
    return cast("Candidate | None", kind_of(candidate).level_form(candidate))


def check_exactly(checklist: Checklist, candidate: BoxClaim) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    kind_of(candidate).check_exactly(checklist, candidate)


def enclose(candidate: BoxClaim, settings: IntegratorSettings, progress: Progress | None = None) -> Found:
    """What its proof is evaluated from. Raises `IntegrationFailure` if something could not be enclosed, or another
    `NotEstablishedError` if the claim is seen to be false on the way.
    """
    return cast(Found, kind_of(candidate).enclose(candidate, settings, progress))


def prove(candidate: BoxClaim, checklist: Checklist, found: Found | None) -> Outcome[Results]:
    """Check the claim, given what was enclosed, if anything; enclosures of another kind of claim are none."""
    kind = kind_of(candidate)
    known = found if isinstance(found, kind.enclosures) else None
    return kind.prove(candidate, checklist, known)


def tables_to_json(found: Found) -> dict[str, Any] | None:
    """All derivatives and numbers, exactly; `None` if one is not finite, which proves nothing anyway."""
    try:
        return dict(to_json(found))
    except (KeyError, ValueError):
        return None


def tables_from_json(entry: Mapping[str, Any], candidate: BoxClaim, computation: Computation) -> Found:
    """The enclosures of a claim from their JSON. Raises `ValueError` that names what cannot be read."""
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


def results_from_json(kind: BoxKind[Any, Any, Any], entry: Mapping[str, Any], source: str) -> Results:
    """What a certificate says is proved of a claim, which fits the schema. Raises `InputError`."""
    return from_json(kind.results, entry, f"{source}.results")


def contradictions(stored: Found, fresh: Found, place: str) -> Iterator[Finding]:
    """Where two enclosures of the same numbers have no common point, or are not of the same numbers."""
    for name, old, new in _pairs(stored, fresh, place):
        yield from overlap(old, new, name)


def unconfirmed(stored: Found, fresh: Found, place: str) -> Iterator[Finding]:
    """Where new enclosures of the same numbers do not lie within the stored ones."""
    for name, old, new in _pairs(stored, fresh, place):
        yield from confirmed(old, new, name)


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


def numbers(value: Any) -> dict[str, Any]:
    """The balls, and the words and numbers beside them, of what was enclosed or found, by where they stand.

    Raises `ValueError` if one would hide another.
    """
    found = list(_numbers(value, ()))
    named = {_said(place): leaf for place, leaf in found}
    if len(named) != len(found):
        raise ValueError("two of the numbers that are enclosed have one name")
    return named


_Path = tuple[Any, ...]


def _said(place: _Path) -> str:
    return " ".join(map(str, place))


def _numbers(value: Any, place: _Path) -> Iterator[tuple[_Path, Any]]:
    if isinstance(value, acb):
        value = {"real": value.real, "imaginary": value.imag}
    if is_dataclass(value):
        value = {each.name: getattr(value, each.name) for each in fields(value) if not each.metadata.get("hidden")}
    if isinstance(value, (Mapping, list, tuple)):
        for key, inner in value.items() if isinstance(value, Mapping) else enumerate(value, start=1):
            yield from _numbers(inner, (*place, key))
    else:
        yield place, value
