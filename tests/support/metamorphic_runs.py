"""Claims of any kind proved, and checked again at every level, in this process."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any
from unittest import mock

from support.atlas_runs import go
from support.forgeries import checked
from support.metamorphic import (
    Change,
    changed_atlas,
    changed_box,
    changed_claim,
    changed_section,
    changed_system,
    in_units_of_amplitude,
)
from support.metamorphic_cases import CASES, Case, Curve, Enclosed, system_of
from support.metamorphic_changes import changes
from support.metamorphic_results import Named, differences

from orbitproof.shared.formats import Atlas, BirthAtlas, Candidate, PeriodicAtlas
from orbitproof.shared.systems import description
from orbitproof.verify import enclose
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.branches.interval_proof import prove_task
from orbitproof.verify.certificate import Certificate, Limits, Recheck, certify, recheck
from orbitproof.verify.evidence import Proved
from orbitproof.verify.run.branches import limits_of
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import CannotFollow, second_proof

LIMITS = Limits(max_precision=512)


@dataclass(frozen=True)
class Told:
    """What is said of a case.

    Attributes:
        verdict: "proved", "enclosed" or why not.
        results: what is known then.
        document: the certificate as JSON; `None` for enclosures.
        case: what was asked.
    """

    verdict: str
    results: Any
    document: dict[str, Any] | None
    case: Case

    def check(self, integrate: bool) -> str:
        """ "stands", or what is found where the system is known from the certificate alone."""
        if self.document is None:
            return "stands"
        with mock.patch.dict(description._INTERNED, clear=True):
            if isinstance(self.case, Curve):
                found: Recheck = checked(self.document, prove_task if integrate else None)
            else:
                found = recheck(Certificate.from_json(self.document), integrate)
        return "stands" if found.stands else f"{found.level.name}: {found.obstacle or found.findings[0]}"

    def second(self) -> str:
        """What the second proof says, in short."""
        if self.document is None or isinstance(self.case, Curve):
            return ""
        try:
            return compare(self.document, second_proof(self.document)).verdict
        except CannotFollow as without:
            return str(without)


def tell(case: Case) -> Told:
    """The first proof."""
    if isinstance(case, Curve):
        return _curve(case)
    if isinstance(case, Enclosed):
        return _enclosed(case)
    found = certify(case, LIMITS)
    document = json.loads(json.dumps(found.to_json()))
    reason = found.reason
    return Told("proved" if reason is None else f"{reason.condition}: {reason.message}", found.results, document, case)


def _curve(case: Curve) -> Told:
    atlas, given = case.atlas, case.settings
    limits = limits_of(atlas, case.complete, 1, None, False, case.lasting, **given)
    results = go(atlas, prove_task, limits)[0].results
    document = make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda _: [], case.complete))
    outcome = case.conclude(atlas, results).outcome
    if isinstance(outcome, Proved):
        return Told("proved", outcome.results, json.loads(json.dumps(document)), case)
    return Told(f"{outcome.reason.condition}: {outcome.reason.message}", None, document, case)


def _enclosed(case: Enclosed) -> Told:
    if case.section is None:
        assert case.time is not None
        found = enclose.flow(case.system, case.box, case.time, derivatives=2)
    else:
        found = enclose.poincare_map(case.system, case.box, case.section, crossings=case.crossings)
    if isinstance(found, enclose.NotEnclosed):
        return Told(str(found), None, None, case)
    return Told("enclosed", (found.on_box, found.centre), None, case)


def changed(case: Case, change: Change) -> Case:
    """A case told otherwise."""
    if isinstance(case, Curve):
        return replace(case, atlas=changed_atlas(case.atlas, change))
    if isinstance(case, Enclosed):
        time = None if case.time is None else case.time * change.time
        section = None if case.section is None else changed_section(case.section, change)
        return Enclosed(
            changed_system(case.system, change), changed_box(case.box, change), time, section, case.crossings
        )
    return changed_claim(case, change)


def named(case: Case) -> Named:
    """What a case calls what varies."""
    system = system_of(case)
    if isinstance(case, Curve):
        atlas = case.atlas
        varies = atlas.claim.parameter if isinstance(atlas, PeriodicAtlas) else atlas.system.family_parameter
        return Named(varies, system.first_integral_name, isinstance(atlas, Atlas) and varies is not None)
    if isinstance(case, Candidate):
        varies = case.varying if case.resonances_meet else case.system.family_parameter
        return Named(varies, system.first_integral_name)
    return Named(getattr(case, "parameter", None), system.first_integral_name)


def objections(before: Told, after: Told, change: Change) -> list[str]:
    """What is wrong with what is said of a case told otherwise."""
    if before.verdict != after.verdict:
        return [f"{before.verdict}, told otherwise {after.verdict}"]
    if isinstance(before.case, Curve) and isinstance(before.case.atlas, BirthAtlas):
        change = in_units_of_amplitude(before.case.atlas, change)
    return list(differences(before.results, after.results, change, named(before.case)))


def certificate_of(told: Told) -> Certificate:
    """That of a curve."""
    assert isinstance(told.case, Curve)
    assert told.document is not None
    return Certificate(told.document)


PROVED_AGAIN = ("all at once",)
"""Ways of telling of which a second proof is made: it takes longer than the first."""


def told_in_every_way(name: str, seed: int) -> Iterator[tuple[str, list[str]]]:
    """Each way of telling a case, and what is wrong at any level of checking it."""
    case = CASES[name]()
    before = tell(case)
    second = before.second()
    if before.verdict not in ("proved", "enclosed") or second == "disagrees":
        yield "plainly", [before.verdict, second]
    for change in changes(name, case, seed):
        after = tell(changed(case, change))
        wrong = objections(before, after, change)
        for integrate in (False, True):
            found = after.check(integrate)
            wrong += [] if found == "stands" else [f"checked again{', integrated' * integrate}: {found}"]
        if change.title in PROVED_AGAIN and (found := after.second()) != second:
            wrong.append(f"the second proof says {second!r}, told otherwise {found!r}")
        yield change.title, wrong


def table(counts: Mapping[str, int]) -> list[str]:
    """Kinds of claims and ways of telling them: how often what is said was the same."""
    pairs = [tuple(each.split(": ", 1)) for each in counts]
    ways = list(dict.fromkeys(way for _, way in pairs))
    head = [f"  {number:2}  {way}" for number, way in enumerate(ways, start=1)]
    rows = [
        f"  {name:24}" + "".join(f"{counts.get(f'{name}: {way}', '-'):>4}" for way in ways)
        for name in dict.fromkeys(name for name, _ in pairs)
    ]
    return [*head, f"  {'':24}" + "".join(f"{number:>4}" for number in range(1, len(ways) + 1)), *rows]
