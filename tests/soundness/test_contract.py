"""What holds for every kind of claim about a box or a curve, however it is proved: the contract of certificates."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction as Q
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from support import life_cases
from support.forgeries import Change, balls_of, changes, checked, forged, forged_elsewhere, noticed
from support.inclusion import leaves, with_leaf
from support.joined import retrograde_curve, retrograde_index, retrograde_web
from support.metamorphic_cases import CURVES, ROWS
from support.metamorphic_runs import Told, tell

from orbitproof.shared.claims import BoxClaim
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import write_candidates
from orbitproof.shared.numbers import format_dyadic, format_exact, parse_exact
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.branches import certified_rows, rows_of_curve
from orbitproof.verify.branches.interval_proof import prove_task
from orbitproof.verify.certificate import (
    Certificate,
    Computation,
    Given,
    Level,
    Recheck,
    certify,
    contradictions,
    is_proof_of,
    recheck,
    rechecking,
    tables_from_json,
    write_certificates,
)
from orbitproof.verify.certificate.kinds import CATALOGUE, FURTHER, INDEX, LIFE, MODULES, WEB, kind_named, unconfirmed
from orbitproof.verify.certificate.rechecking import derived
from orbitproof.verify.evidence import NotProved

LIMITS = Limits(digits=10)
FIELDS = [10, pytest.param(60, marks=pytest.mark.slow)]
"""So many fields of a certificate are changed by `make test`, and by `make test-slow`."""
FREE = {
    "statement.candidate.kernel_frame.*.*": "what follows does not depend on which basis the search has chosen",
    "statement.candidate.system.symmetries.S.*": "a symmetry that the claim does not use",
    "computation.precision": "how the verdict was found, which another integration does not repeat",
    "computation.order": "as the precision",
    "computation.attempts": "as the precision",
    "computation.steps": "as the precision",
    "computation.seconds": "as the precision",
    "computation.coordinates": "as the precision",
}
"""Fields that may be others without anything else following, and why."""


LONG_ROWS = (
    "heteroclinic",
    "tori",
    "krein",
    "periodic-functions-fold",
    "periodic-functions-level-fold",
    "periodic-levels",
    "periodic-twice",
    "homoclinic-curve",
)
"""Claims whose proofs take seconds."""
EACH = [pytest.param(name, marks=pytest.mark.slow if name == "homoclinic-curve" else ()) for name in ROWS]
"""All; one of them takes seconds in each test."""


@cache
def claimed(name: str) -> BoxClaim:
    return ROWS[name]()


@cache
def proved(name: str) -> Certificate:
    return certify(claimed(name), LIMITS)


def of_each_field(document: Mapping[str, Any], number: int) -> Iterator[Change]:
    """One change at random of each field, those of a list taken together; of so many fields at random."""
    found: dict[str, list[Change]] = {}
    for change in changes(document):
        found.setdefault(change.field, []).append(change)
    chance = random.Random(len(found))
    yield from (chance.choice(alike) for alike in chance.sample(list(found.values()), min(number, len(found))))


def test_there_is_a_case_of_every_kind() -> None:
    assert {claimed(name).kind for name in ROWS} == set(MODULES)


@pytest.mark.quick
@pytest.mark.parametrize("name", EACH)
def test_an_honest_certificate_stands_at_each_level_and_proves_its_claim(name: str) -> None:
    certificate, claim = proved(name), claimed(name)
    assert certificate.proved, certificate.reason
    assert isinstance(certificate.results, kind_named(claim.kind).results)
    for integrate, level in ((False, Level.CONCLUSION), (True, Level.INTEGRATION)):
        found = recheck(certificate, integrate)
        assert (found.findings, found.passed, found.rendered) == ((), level, None)
    assert Certificate.from_json(certificate.to_json()) == certificate
    assert is_proof_of(certificate, claim)
    others = [other for other in ROWS if claimed(other) != claim]
    assert not any(is_proof_of(certificate, replace(claimed(other), id=claim.id)) for other in others)


ALONE = """
import os, sys
from pathlib import Path
from orbitproof.shared.formats import read_claims
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify, recheck
wrong = []
for claim in read_claims(Path(sys.argv[1])):
    process = os.fork()
    if not process:
        certificate = certify(claim, Limits(digits=10))
        os._exit(0 if certificate.proved and recheck(Certificate.from_json(certificate.to_json())).stands else 1)
    if os.waitpid(process, 0)[1]:
        wrong.append(claim.id)
print(*wrong)
"""
"""Each claim in a process that has met no other: what one kind needs, no other has loaded for it."""


def test_each_kind_is_proved_where_no_other_has_been_loaded(tmp_path: Path) -> None:
    path = tmp_path / "claims.json"
    write_candidates(path, [replace(claimed(name), id=name) for name in ROWS])
    found = subprocess.run([sys.executable, "-c", ALONE, str(path)], capture_output=True, text=True, check=True)
    assert found.stdout.split() == []


@pytest.mark.parametrize("number", FIELDS)
@pytest.mark.parametrize("name", EACH)
def test_each_field_that_is_changed_is_noticed(name: str, number: int) -> None:
    """Without an integration, but for what nothing beside it follows from: another box, an enclosure."""
    document = proved(name).to_json()
    found, well_formed = enclosed_again(document), 0
    for change in of_each_field(document, number):
        try:
            certificate = Certificate.from_json(forged(document, change.apply))
            well_formed += 1
            if noticed(recheck(certificate)) or change.field in FREE:
                continue
            if change.field.startswith("enclosures."):
                assert list(unconfirmed(enclosures_of(certificate), found, "")), change
            else:
                assert noticed(recheck(certificate, True)), change
        except InputError:
            continue
    assert well_formed > number // 4


@pytest.mark.parametrize("name", EACH)
def test_the_certificate_of_one_kind_is_none_of_another(name: str) -> None:
    document = proved(name).to_json()
    for kind in sorted(set(MODULES) - {claimed(name).kind}):
        try:
            certificate = Certificate.from_json(
                forged(document, lambda entry, kind=kind: entry["statement"]["candidate"].update(kind=kind))
            )
        except InputError:
            continue
        assert noticed(recheck(certificate)), kind


@pytest.mark.parametrize("name", EACH)
def test_every_number_that_is_enclosed_is_compared(name: str) -> None:
    """One moved, and one told more narrowly than it is found."""
    found = enclosures_of(proved(name))
    places = list(leaves(found))
    chance = random.Random(name)
    assert not list(contradictions(found, found, "tables"))
    assert not list(unconfirmed(found, found, "tables"))
    for path, ball in chance.sample(places, min(24, len(places))):
        assert len(list(contradictions(found, with_leaf(found, path, ball + 2**200), "tables"))) == 1, path
        narrow = ball + 1 if ball.is_exact() else arb(ball.mid(), ball.rad() / 16)
        assert len(list(unconfirmed(with_leaf(found, path, narrow), found, "tables"))) == 1, path


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG_ROWS else ()) for name in ROWS]
)
def test_what_a_forger_derives_anew_is_refused_by_integration(name: str) -> None:
    """All that follows from a number that was not found."""
    document, chance = proved(name).to_json(), random.Random(name)
    balls = list(balls_of(document["enclosures"]))

    def moved(entry: Any) -> None:
        place, text = chance.choice(balls)
        target = entry["enclosures"]
        for key in place[:-1]:
            target = target[key]
        middle, radius = map(parse_exact, text.split(" +- "))
        target[place[-1]] = " +- ".join(map(format_dyadic, (middle + 4 * radius + Q(1, 2**200), radius)))

    entries = (derived(forged(document, moved)) for _ in range(40))
    sealed = (forged({**entry, "software": document["software"]}, lambda entry: None) for entry in entries)
    certificate = next(found for found in map(Certificate.from_json, sealed) if found.proved)
    assert recheck(certificate).stands
    found = recheck(certificate, integrate=True)
    assert (found.stands, found.passed) == (False, Level.CONCLUSION)


@pytest.mark.parametrize("name", EACH)
def test_enclosures_that_are_no_enclosures_prove_nothing(name: str) -> None:
    """None, what lacks a part or a number, and one that is not finite, unless it counts nowhere."""
    found, chance = enclosures_of(proved(name)), random.Random(name)

    def concluded(enclosures: Any) -> Any:
        return rechecking._conclude(claimed(name), proved(name).computation.precision, enclosures)

    assert isinstance(concluded(None), NotProved)
    results = repr(concluded(found).results)
    numbers, shorter = [path for path, _ in leaves(found)], list(lacking(found))
    changed = [with_leaf(found, path, arb("nan")) for path in chance.sample(numbers, min(6, len(numbers)))]
    for other in (*changed, *chance.sample(shorter, min(12, len(shorter)))):
        outcome = concluded(other)
        assert isinstance(outcome, NotProved) or repr(outcome.results) == results


def lacking(value: Any) -> Iterator[Any]:
    """The same without the last of what one of its tuples and tables has in it."""
    if isinstance(value, tuple | dict) and value:
        yield value[:-1] if isinstance(value, tuple) else dict(list(value.items())[:-1])
    for key in value if isinstance(value, dict) else range(len(value)) if isinstance(value, tuple) else ():
        for part in lacking(value[key]):
            yield {**value, key: part} if isinstance(value, dict) else (*value[:key], part, *value[key + 1 :])
    if is_dataclass(value):
        for field in fields(value):
            yield from (replace(value, **{field.name: part}) for part in lacking(getattr(value, field.name)))


def enclosures_of(certificate: Certificate) -> Any:
    entry = certificate.to_json()
    return tables_from_json(entry["enclosures"], certificate.candidate, Computation(**entry["computation"]))


def enclosed_again(document: Mapping[str, Any]) -> Any:
    stated = rechecking._read(document)
    assert stated.enclosures is not None
    return rechecking.enclose(stated.claim, next(rechecking._settings(stated.enclosures)))


@pytest.mark.parametrize("name", EACH)
def test_each_part_that_is_missing_is_noticed(name: str) -> None:
    document, well_formed = proved(name).to_json(), 0
    for place in parts(document):
        try:
            certificate = Certificate.from_json(forged(document, without(place)))
        except InputError:
            continue
        well_formed += 1
        assert noticed(recheck(certificate)) or "symmetries" in place, place
    assert well_formed > 3


def parts(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The first and the last entry of each list, and each key, of what is stated, enclosed and found."""
    keys = list(value) if isinstance(value, dict) else [0, -1][: len(value)] if isinstance(value, list) else []
    for key in keys:
        if place or key in ("statement", "hypotheses", "enclosures", "results"):
            yield (*place, key)
            yield from parts(value[key], (*place, key)) if isinstance(key, str) else ()


def without(place: tuple[Any, ...]) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        for key in place[:-1]:
            document = document[key]
        del document[place[-1]]

    return change


@pytest.mark.quick
@pytest.mark.parametrize("name", EACH)
def test_a_false_claim_is_not_proved_and_says_why_in_one_line(name: str, tmp_path: Path, capsys: Any) -> None:
    claim = claimed(name)
    beside = tuple(value + 1000 * max(claim.radii) for value in claim.centre)
    path, output = tmp_path / "claim.json", tmp_path / "certificates.json"
    write_candidates(path, [replace(claim, centre=beside)])
    words = ["--max-precision", "128", "--other-boxes", "0", "--quiet"]
    assert main([str(path), "-o", str(output), *words]) == 1
    told = capsys.readouterr()
    assert "not proved" in told.out
    assert told.err == ""
    write_certificates(output, [proved(name)])
    assert main(["--recheck", str(output), "--quiet"]) == 0
    assert "stands" in capsys.readouterr().out


# Curves


FREE_OF_CURVES = (
    "statement.atlas.title",
    "statement.atlas.pieces.*.tube.*",
    "results.*.computation.",
    "results.*.reason.",
)
"""A title and a wider tube are another claim that follows too; how an interval was proved is as for boxes.

So is why it was not proved at first.
"""
LONG = ("list", "periodic-arc-functions", "periodic-arc-functions-levels", "birth-arc")
"""Curves whose proofs take seconds."""
SEEN_BY_INTEGRATION = ("deviation.*", "error", "coefficients.*")
"""Numbers in results from which everything else is concluded."""


@cache
def told(name: str) -> Told:
    return tell(CURVES[name]())


@pytest.mark.quick
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG else ()) for name in CURVES]
)
def test_an_honest_certificate_of_a_curve_stands_at_each_level(name: str) -> None:
    assert told(name).verdict == "proved"
    assert told(name).check(False) == "stands"
    assert told(name).check(True) == "stands"


@pytest.mark.parametrize("number", FIELDS)
@pytest.mark.parametrize("name", CURVES)
def test_each_field_and_each_part_of_a_curve_is_noticed(name: str, number: int) -> None:
    document = told(name).document
    assert document is not None
    for change in of_each_field(document, number):
        if change.field.startswith(FREE_OF_CURVES) or change.field.endswith(SEEN_BY_INTEGRATION):
            continue
        with suppress(InputError):
            assert noticed(checked(forged(document, change.apply))), change
    for place in parts(document):
        with suppress(InputError):
            assert noticed(checked(forged(document, without(place)))), place


@pytest.mark.parametrize("name", CURVES)
def test_bounds_of_a_curve_that_are_too_small_are_found_by_integrating(name: str) -> None:
    """2^-40 of each deviation, which is less than more bits can make of it."""
    document = json.loads(json.dumps(told(name).document))
    for result in (each for each in document["results"] if each["verdict"] == "proved"):
        result["deviation"] = [format_exact(parse_exact(bound) / 2**40) for bound in result["deviation"]]
    forgery = forged(document, lambda entry: None)
    assert not checked(forgery, prove_task).stands


@pytest.mark.quick
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG[1:] else ()) for name in CURVES]
)
def test_a_false_claim_of_a_curve_is_not_proved(name: str) -> None:
    curve = CURVES[name]()
    piece = curve.atlas.pieces[0]
    beside = tuple(value + 2 * piece.tube[0] for value in piece.centre)
    found = tell(replace(curve, atlas=replace(curve.atlas, pieces=(replace(piece, centre=beside),))))
    assert found.verdict not in ("proved", "enclosed")
    assert "\n" not in found.verdict


# What rests on other certificates


def catalogue() -> Certificate:
    """Three orbits of a curve."""
    curve = retrograde_curve()
    return Certificate(certified_rows(curve, rows_of_curve(curve, 3)))


JOINED: dict[str, tuple[Callable[[], Certificate], Callable[[], tuple[Certificate, ...]]]] = {
    WEB: (retrograde_web, lambda: (retrograde_curve(), retrograde_index())),
    LIFE: (life_cases.life, lambda: (life_cases.rest(), life_cases.born())),
    INDEX: (retrograde_index, lambda: (retrograde_curve(),)),
    CATALOGUE: (cache(catalogue), lambda: (retrograde_curve(),)),
}
"""Each with what it rests on."""
FREE_OF_JOINED = ("orbits.*.turns.*.", "statement.title", "statement.claim.title")
"""What an index rests on besides its curve, and titles."""


@cache
def check_below(entry: Certificate, level: Level) -> Recheck:
    return replace(given_with(entry), level=level, precision=128)


def given_with(entry: Certificate, level: Level = Level.CONCLUSION) -> Recheck:
    """What checking it shows, given those that it rests on among all, which were checked as far as that."""
    below = kind_named(entry.kind).rests_on(entry, JOINED[entry.kind][1]() if entry.kind in JOINED else ())
    return recheck(entry, given=Given(below, {each.key: check_below(each, level) for each in below}))


def test_there_is_a_case_of_every_kind_that_rests_on_others() -> None:
    branches = {name for name in FURTHER if kind_named(name).part == "arc"}
    assert set(JOINED) | branches == set(FURTHER)
    assert {claim().atlas.claim.kind for claim in CURVES.values()} <= branches


@pytest.mark.quick
@pytest.mark.parametrize("name", JOINED)
def test_what_rests_on_others_stands_as_far_as_these_do(name: str) -> None:
    entry = JOINED[name][0]()
    assert kind_named(name).rests_on(entry, JOINED[name][1]()) == JOINED[name][1]()
    assert Certificate.from_json(entry.to_json()) == entry
    for level in (Level.FORM, Level.CONCLUSION, Level.INTEGRATION):
        found = given_with(entry, level)
        assert (found.findings, found.obstacle, found.passed, found.rendered) == ((), "", level, None)
        assert found.precision == (128 if level is Level.INTEGRATION else 0)
    with pytest.raises(InputError):
        kind_named(name).rests_on(entry, JOINED[name][1]()[1:])


@pytest.mark.parametrize("number", FIELDS)
@pytest.mark.parametrize("name", JOINED)
def test_each_field_and_each_part_of_what_rests_on_others_is_noticed(name: str, number: int) -> None:
    document = JOINED[name][0]().document
    for change in of_each_field(document, number):
        if not change.field.startswith(FREE_OF_JOINED):
            with suppress(InputError):
                assert noticed(given_with(Certificate.from_json(forged(document, change.apply)))), change
    for place in parts(document):
        with suppress(InputError):
            assert noticed(given_with(Certificate.from_json(forged(document, without(place))))), place


@pytest.mark.parametrize("name", ["fold", "list", *JOINED])
def test_what_is_worded_otherwise_is_told_in_the_words_of_this_version(name: str) -> None:
    document: Any = proved(name).to_json() if name in ROWS else told(name).document if name in CURVES else None
    document = document or JOINED[name][0]().document

    def check(entry: Mapping[str, Any]) -> Recheck:
        return given_with(Certificate.from_json(entry)) if name in JOINED else checked(entry)

    def reworded(entry: Any) -> None:
        entry["statement"]["theorem"] = "Everything is stable."
        if "statement" in (entry.get("conclusion") or {}):
            entry["conclusion"]["statement"] = "Everything is stable."

    assert check(document).rendered is None
    assert "these sources, which word what it proves otherwise" in check(forged(document, reworded)).why
    found = check(forged_elsewhere(document, reworded))
    assert (found.stands, found.word) == (True, "stands, worded otherwise")
    assert found.rendered is not None
    assert found.rendered["statement"] == document["statement"]
    assert found.rendered.get("conclusion") == document.get("conclusion")


@pytest.mark.quick
@pytest.mark.parametrize("name", JOINED)
def test_nothing_is_proved_by_what_does_not_stand(name: str) -> None:
    entry = JOINED[name][0]()
    below = JOINED[name][1]()
    for fallen in below:
        checks = {each.key: check_below(each, Level.CONCLUSION) for each in below}
        checks[fallen.key] = replace(checks[fallen.key], obstacle="it hangs")
        found = recheck(entry, given=Given(below, checks))
        assert not found.stands
        assert found.level is Level.FORM
        checks[fallen.key] = replace(check_below(fallen, Level.CONCLUSION), digest="sha256:" + 64 * "0")
        with pytest.raises(ValueError, match="the check of another certificate"):
            recheck(entry, given=Given(below, checks))
