"""Certificates of atlases: the claim, what is proved on each interval, what follows (section 15)."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from orbitproof.shared.claims import ATLASES_WITHOUT_REVERSOR
from orbitproof.shared.formats import (
    AnyAtlas,
    ArgumentError,
    Atlas,
    InputError,
    atlas_from_json,
    atlas_to_json,
    validate_document,
)
from orbitproof.shared.systems import BRANCH_SYSTEMS, record
from orbitproof.shared.wording import counted
from orbitproof.verify.branches.document import BranchDocument, BranchStatement, Total
from orbitproof.verify.branches.kinds import kind_of
from orbitproof.verify.branches.listed import ListedInterval, ListedPoint
from orbitproof.verify.branches.results import Result, results_from_json
from orbitproof.verify.certificate import Certificate, sealed, stated, systems_with
from orbitproof.verify.certificate.stored_balls import from_json, to_json
from orbitproof.verify.evidence import Reason, differs_here, software

SCHEMA = "atlas-certificate"


def statement_of(atlas: Atlas, with_distance: bool = False, with_variations: bool = False) -> BranchStatement:
    """The claim in full, but for the theorem: the atlas without provenance, and the system that it is about.

    `with_distance`, `with_variations`: with the distance that the system names, and the stiffness out of the plane of
    motion, if there are any.
    """
    system, symmetry = atlas.system, atlas.claim.symmetry
    across = system.stiffness_across_program if with_variations else None
    return BranchStatement(
        claim=atlas_to_json(atlas, provenance=False),
        derived_parameters={
            name: record(parameter.equation, (name,), system.fixed_parameters).text()
            for name, parameter in system.derived_parameters.items()
        },
        stiffness_across=None if across is None else across.text(),
        **stated(system, symmetry, with_distance),
    )


_UNFINISHED = Reason("unfinished", "not all intervals were tried", "run the same command again; it goes on from here")


def make_atlas_certificate(
    atlas: AnyAtlas,
    results: Sequence[Result],
    conclusion: Mapping[str, Any] | None,
    rests_on: Sequence[Certificate] = (),
    as_json: Callable[[Result], Any] = to_json,
) -> dict[str, Any]:
    """The certificate of an atlas, with the results in order along the curve.

    `conclusion` is what `conclusion_of` makes of the results; `None` as long as intervals are missing.
    `rests_on` are the certificates of bifurcations that it was made with; it carries them without their places on
    curves, which it says itself. `as_json` makes the JSON of a result.
    """
    place = {piece.id: number for number, piece in enumerate(atlas.pieces)}
    ordered = sorted(results, key=lambda result: (place[result.piece], result.interval))
    kind = kind_of(atlas)
    statement = kind.statement(atlas, results)
    found = conclusion or {"verdict": "not proved", "reason": to_json(_UNFINISHED)}
    if found["verdict"] == "proved":
        theorem = found["statement"]
        statement = replace(statement, theorem=theorem, in_full=kind.in_full(atlas, theorem))
    return sealed(
        BranchDocument(
            id=atlas.id,
            verdict=found["verdict"],
            reason=found["reason"],
            statement=statement,
            results=[as_json(result) for result in ordered],
            conclusion=conclusion,
            rests_on=tuple(entry.without_place().to_json() for entry in rests_on),
            computation=Total(
                sum(result.is_proved for result in ordered),
                round(sum(result.computation.seconds for result in ordered), 3),
            ),
            software=software(),
            digest="",
        ),
        SCHEMA,
    )


def atlas_of(document: Mapping[str, Any]) -> AnyAtlas:
    """The claim of a certificate. Raises `InputError`, `ValueError` or `CannotBeCheckedError` if there is none."""
    stated, where = document["statement"]["atlas"], "statement.atlas"
    validate_document(stated, "atlas", where)
    if stated["claim"]["kind"] in ATLASES_WITHOUT_REVERSOR:
        return atlas_from_json(stated, where)
    return atlas_from_json(stated, where, systems_with(BRANCH_SYSTEMS, document["statement"], stated))


def is_whole(certificate: Certificate) -> bool:
    """Whether all bifurcations asked about are on the curve, and a list that was asked for leaves nothing out."""
    conclusion = certificate.document["conclusion"] or {}
    listed = conclusion.get("complete", {})
    on_curve = all(entry["on_curve"] for entry in conclusion.get("bifurcations", ()))
    lasting = listed.get("lasting", {})
    is_open = any(entry.get(name) for entry in (listed, lasting) for name in ("gaps", "undecided"))
    return on_curve and not is_open


def _listed(kind: Any, name: str, certificate: Certificate) -> Any:
    """What the complete list of a curve has, in order along it; empty without one."""
    entries = (certificate.document["conclusion"] or {}).get("complete", {}).get(name, [])
    try:
        return from_json(kind, entries, name)
    except (LookupError, TypeError, ValueError) as error:
        raise InputError(f"certificate {certificate.id!r}: {name} of the list: {error}") from None


SAID: Mapping[str, Callable[[Certificate], Any]] = {
    "atlas": lambda certificate: atlas_of(certificate.document),
    "is_whole": is_whole,
    "points": partial(_listed, tuple[ListedPoint, ...], "points"),
    "stable": partial(_listed, tuple[ListedInterval, ...], "stable"),
    "results": lambda certificate: results_from_json(certificate.atlas, certificate.document["results"]),
}
"""What a certificate of a branch says besides: its claim, whether nothing is left out, of its list the resonances and
between which orbits all are linearly stable, and what was found on the intervals, in order along the curve."""

ONE_A_LINE = (("statement", "atlas", "pieces"), ("results",), ("rests_on",))


def pieces_of(certificate: Certificate) -> str:
    """How many there are, in words."""
    return counted(len(certificate.document["statement"]["atlas"]["pieces"]), "piece")


def well_formed(document: Mapping[str, Any], path: Path) -> None:
    """Raises `InputError` if the document of a file has no atlas, or results of other pieces."""
    stated = document["statement"]["atlas"]
    where = f"{path}: field statement.atlas"
    validate_document(stated, "atlas", where)
    known = {piece.id for piece in atlas_from_json(stated, where).pieces}
    for index, result in enumerate(document["results"]):
        if result["piece"] not in known:
            raise ArgumentError(
                "{0}: field results[{1}].piece: no such piece in the atlas; write it again with {fresh=True:--fresh}",
                path,
                index,
            )


def results_for(certificate: Certificate, atlas: AnyAtlas) -> list[Result]:
    """The stored results that are about an atlas: of this software, of the same claim, of pieces that are unchanged."""
    before = certificate.atlas
    setting = kind_of(atlas).setting
    same_system = before.system == atlas.system and before.parameters == atlas.parameters
    same_claim = same_system and kind_of(before) is kind_of(atlas) and setting(before) == setting(atlas)
    if not same_claim or differs_here(certificate.document["software"]):
        return []
    unchanged = {piece.id for piece in atlas.pieces if piece in before.pieces}
    return [result for result in certificate.results if result.piece in unchanged]


class Lines:
    """Results as lines of a file: each is put into JSON, validated and written once, however often the file is."""

    def __init__(self) -> None:
        # With its text a result is kept, so that its identity is not given to another one.
        self._known: dict[int, tuple[Any, str]] = {}
        self._entries: dict[int, tuple[Result, Any]] = {}

    def entry(self, result: Result) -> Any:
        """The JSON of a result, always the same object."""
        if id(result) not in self._entries:
            self._entries[id(result)] = result, to_json(result)
        return self._entries[id(result)][1]

    def __call__(self, entry: Any) -> str:
        """An entry on one line."""
        if id(entry) not in self._known:
            self._known[id(entry)] = entry, json.dumps(entry, allow_nan=False)
        return self._known[id(entry)][1]

    def unknown(self, results: Sequence[Any]) -> list[Any]:
        """The results that were not written yet."""
        return [result for result in results if id(result) not in self._known]
