"""Claims about boxes as JSON, read and written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, NoReturn, cast

from orbitproof.shared.claims import (
    ACROSS_KINDS,
    DOUBLE_RESONANCE,
    KINDS_WITHOUT_REVERSOR,
    ONCE,
    ORBIT_KINDS,
    BoxClaim,
    Candidate,
)
from orbitproof.shared.codec import from_json, register, to_json
from orbitproof.shared.errors import InputError, short
from orbitproof.shared.formats.documents import read_document, write_document
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.stored import rules
from orbitproof.shared.systems import (
    SYSTEM,
    SYSTEMS,
    DescriptionError,
    ReversibleSystem,
    System,
    describe,
    described,
    described_plainly,
)


def read_claims(path: Path) -> list[BoxClaim]:
    """Read a candidates file. Raises `InputError` for anything that is not a well-formed claim."""
    document = read_document(path, "candidates")
    claims: list[BoxClaim] = []
    seen: set[str] = set()
    for index, entry in enumerate(document["candidates"]):
        source = f"{path}: field candidates[{index}]"
        claim = claim_from_json(entry, source)
        if claim.id in seen:
            raise InputError(f"{source}.id: {claim.id!r} appears twice; give each candidate its own id")
        seen.add(claim.id)
        claims.append(claim)
    return claims


_WITHOUT_SYMMETRY = "is about no symmetric orbit"


def read_candidates(path: Path) -> list[Candidate]:
    """The candidates of a file whose claims are all about symmetric orbits. Raises `InputError` for others too."""
    candidates: list[Candidate] = []
    for claim in read_claims(path):
        if not claim.uses_reversor:
            raise InputError(f"{path}: {claim.id!r} {_WITHOUT_SYMMETRY}, which is not available here; leave it out")
        candidates.append(cast(Candidate, claim))
    return candidates


for _kind in (System, ReversibleSystem):
    _like = Annotated[str, rules("system", pattern=SYSTEM)] | Mapping[str, Any]
    register(_kind, describe, lambda system: system, _like)
"""Which systems are known is for the reader to say: it puts the system in place of its name."""


def candidate_to_json(candidate: BoxClaim, provenance: bool = True) -> dict[str, Any]:
    """The JSON object of a candidate, with or without what the verifier ignores."""
    entry: dict[str, Any] = to_json(candidate)
    return entry if provenance else {key: value for key, value in entry.items() if key != "provenance"}


def read_system(
    entry: Mapping[str, Any],
    source: str,
    systems: Mapping[str, ReversibleSystem] = SYSTEMS,
    varying: int = 0,
) -> tuple[ReversibleSystem, dict[str, Fraction]]:
    """The system of a JSON object, one of `systems` by name or one that it describes, and its fixed parameters.

    So many of them, `varying`, have no value. Raises `InputError` that names the field.
    """
    system = find_system(entry["system"], f"{source}.system", systems)
    parameters = {name: parse_exact(text) for name, text in entry["parameters"].items()}
    known = set(system.fixed_parameters)
    if not set(parameters) <= known or len(known - set(parameters)) != varying:
        wanted = ", ".join(system.fixed_parameters) or "none"
        exactly = "all but one of these" if varying else "exactly these"
        raise InputError(f"{source}.parameters: {system.name} takes the parameters: {wanted}; give {exactly}")
    for name, value in parameters.items():
        interval = system.parameters[name]
        if not interval.contains(value):
            text = short(entry["parameters"][name])
            raise InputError(f"{source}.parameters.{name}: {text} lies outside {interval}; choose a value inside")
    return system, parameters


def find_system(
    entry: str | Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem]
) -> ReversibleSystem:
    """One of `systems` by its name, or the system that a JSON object describes. Raises `InputError`."""
    if isinstance(entry, str):
        if entry not in systems:
            raise InputError(f"{source}: unknown system {entry!r}; known: {', '.join(systems)}")
        return systems[entry]
    try:
        return described(entry)
    except DescriptionError as error:
        raise InputError(f"{source}.{error}") from None


def claim_from_json(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = SYSTEMS
) -> BoxClaim:
    """The claim of a schema-valid JSON object, about one of `systems` or one that it describes. Raises `InputError`."""
    if entry["kind"] not in KINDS_WITHOUT_REVERSOR:
        return candidate_from_json(entry, source, systems)
    system: System
    described_alone = entry["system"]
    if isinstance(described_alone, Mapping) and not {"R", "section", "reversor"} & set(described_alone):
        try:
            system = described_plainly(described_alone)
        except DescriptionError as error:
            raise InputError(f"{source}.system.{error}") from None
    else:
        system = find_system(described_alone, f"{source}.system", systems)
    return from_json(KINDS_WITHOUT_REVERSOR[entry["kind"]], {**entry, "system": system}, source)


def candidate_from_json(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = SYSTEMS
) -> Candidate:
    """A `Candidate` about one of `systems`, from a schema-valid JSON object; `InputError` names the field."""

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}.{name}: {why}; {remedy}")

    if entry["kind"] in KINDS_WITHOUT_REVERSOR:
        refuse("kind", f"{_WITHOUT_SYMMETRY}, which is not available here", "leave it out")
    system, _ = read_system(entry, source, systems, int(entry["kind"] == DOUBLE_RESONANCE))
    kind, k = entry["kind"], entry["k"]
    once = (*ONCE, *ORBIT_KINDS, *ACROSS_KINDS)
    if (kind in once) != (k == 1):
        refuse("k", f"{kind} with k = {k}", f"{', '.join(once)} have k = 1, the other kinds have k > 1")
    if ("parameter" in entry) != ("level_sign" in entry):
        refuse("parameter", "parameter and level_sign belong together", "give both or none")
    if "level_sign" in entry and (system.level_coordinate is None or system.family_parameter is not None):
        refuse("parameter", f"{system.name} has no coordinate that follows from its first integral", "leave it out")
    return from_json(Candidate, {**entry, "system": system}, source)


def write_candidates(path: Path, candidates: Sequence[BoxClaim]) -> None:
    """Write a candidates file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = {
        "format": "orbitproof-candidates",
        "version": 1,
        "candidates": [candidate_to_json(candidate) for candidate in candidates],
    }
    write_document(path, document, "candidates")
