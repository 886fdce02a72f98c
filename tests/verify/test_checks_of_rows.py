"""Each thing that the check of a row compares is compared: certificates and new proofs that differ in it alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any, Literal

import pytest
from flint import arb
from support.claims import known, to_the_end
from support.forgeries import forged as forged_document
from support.springs import springs

from orbitproof.shared.processes import Failure
from orbitproof.verify.certificate import (
    CannotBeCheckedError,
    Certificate,
    Computation,
    Level,
    Limits,
    Recheck,
    certify,
    contradictions,
    decimals,
    digest,
    is_proof_of,
    make_certificate,
    not_checked,
    recheck,
    systems_with,
)
from orbitproof.verify.certificate import rechecking as chapter
from orbitproof.verify.certificate.kinds import numbers, prove, unconfirmed
from orbitproof.verify.certificate.levels import not_finished
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotProved,
    Reason,
    ball_to_json,
)
from orbitproof.verify.poincare import Enclosures

PLACE = {
    "rests_on": {"id": "loop", "digest": "sha256:" + 64 * "0"}, "piece": "p001", "s": ball_to_json(arb(0, 1)),
    "mirrored": False, "other_point": False, "statement": "on the loop",
}  # fmt: skip


@pytest.fixture(scope="module")
def refuted() -> Certificate:
    """With tables: the orbits are followed to the end."""
    claim = known("fs3")
    beside = replace(claim, centre=(claim.centre[0] + Fraction(1, 10**8), claim.centre[1]))
    return certify(beside, Limits(max_precision=256), integrate=to_the_end)


def forged(certificate: Certificate, change: Callable[[dict[str, Any]], Any]) -> Certificate:
    return Certificate.from_json(forged_document(certificate.to_json(), change))


def enclosures_of(certificate: Certificate) -> Enclosures:
    stored = chapter._read(certificate.to_json()).enclosures
    assert isinstance(stored, Enclosures)
    return stored


def wider(found: Enclosures, factor: float) -> Enclosures:
    """Tables with radii multiplied by this."""

    def widened(part: Mapping[Any, arb]) -> dict[Any, arb]:
        return {index: arb(ball.mid(), arb(ball.rad()) * factor) for index, ball in part.items()}

    iterates = tuple(
        tuple(DerivativeTable(widened(table.box), widened(table.centre)) for table in components)
        for components in found.iterates
    )
    return replace(found, iterates=iterates)


# The form


def places(check: Recheck) -> list[str]:
    return [finding.place for finding in check.findings]


def test_hypotheses_stand_in_the_order_of_the_theorem(point: Certificate, refuted: Certificate) -> None:
    for certificate in (point, refuted):
        exchanged = forged(certificate, lambda d: d["hypotheses"].insert(0, d["hypotheses"].pop(1)))
        assert (recheck(exchanged).level, places(recheck(exchanged))) == (Level.NONE, ["hypotheses"])


def test_a_reason_is_a_hypothesis_or_what_ends_a_proof(refuted: Certificate) -> None:
    found = recheck(forged(refuted, lambda d: d["reason"].update(condition="luck")))
    assert (found.level, places(found)) == (Level.NONE, ["reason"])


@pytest.mark.parametrize(("name", "value"), [("precision", 1), ("order", 0)])
def test_bits_and_orders_of_integrations_are_possible(point: Certificate, name: str, value: int) -> None:
    found = recheck(forged(point, lambda d: d["computation"].update({name: value})))
    assert (found.stands, found.level) == (False, Level.NONE)


# The conclusion


def test_the_condition_that_failed_is_the_one_that_follows(refuted: Certificate) -> None:
    other = next(each.name for each in refuted.hypotheses if each.name != refuted.to_json()["reason"]["condition"])
    found = recheck(forged(refuted, lambda d: d["reason"].update(condition=other)))
    assert (found.level, places(found)) == (Level.FORM, ["reason"])
    late = recheck(forged(refuted, lambda d: d["reason"].update(condition="time")))
    assert late.stands


def test_no_hypothesis_is_stored_beyond_those_that_follow() -> None:
    hopeless = certify(replace(known("fs3"), kernel_frame=((Fraction(0),),)))
    names = chapter.theorem_of(hopeless.candidate).hypotheses  # type: ignore[union-attr]
    last = len(hopeless.hypotheses)
    more = {"name": names[last], "statement": "it is so", "section": "6", "holds": True, "enclosures": {}}
    assert recheck(hopeless).stands
    found = recheck(forged(hopeless, lambda d: d["hypotheses"].append(more)))
    assert (found.level, places(found)) == (Level.FORM, [f"hypothesis {names[last]}"])


def test_with_an_open_place_no_more_than_the_form_is_passed() -> None:
    found = Recheck("c", "proved", 3, (), level=Level.INTEGRATION, open_place="it rests on a curve")
    assert (found.stands, found.stands_without_place, found.passed) == (False, True, Level.FORM)
    assert (found.word, found.why) == ("cannot be checked here", "it rests on a curve")
    placed = certify(known("fs3"), Limits(max_precision=256)).with_place(PLACE)
    check = recheck(placed)
    assert (check.level, check.passed, check.stands) == (Level.CONCLUSION, Level.FORM, False)


def test_a_check_that_was_not_brought_to_an_end_does_not_stand() -> None:
    passed = Recheck("c", "proved", 3, (), level=Level.CONCLUSION)
    kinds: list[Literal["process", "time", "memory"]] = ["process", "time", "memory"]
    for kind in kinds:
        failure = Failure(kind, "it was ended")
        for found in (not_checked("c", "proved", failure), not_finished(passed, failure)):
            assert (found.stands, found.findings) == (False, ())
            assert found.obstacle.startswith("it was ended; ")
    assert not_finished(passed, Failure("time", "it was ended")).level is Level.CONCLUSION


def test_decimals_are_looked_at_in_each_entry_of_a_list() -> None:
    ball = ball_to_json(arb(1, 0.25))
    for number in range(3):
        value = [ball] * 3
        value[number] = {**ball, "decimal": "[0.8, 1.2]"}
        assert [finding.place for finding in decimals(value, "here")] == [f"here[{number}]"]


# The integration


def test_enclosures_are_of_as_many_numbers(point: Certificate) -> None:
    stored = enclosures_of(point)
    fewer = replace(stored, return_times=stored.return_times[1:])
    for old, new in ((stored, fewer), (fewer, stored), (stored, springs("once")[1])):
        with pytest.raises(ValueError, match="do not belong to each other"):
            list(contradictions(old, new, "again"))


def test_no_number_hides_behind_the_name_of_another() -> None:
    assert numbers({"time": {"1": arb(1)}}) == {"time 1": arb(1)}
    with pytest.raises(ValueError, match="one name"):
        numbers({"time": {"1": arb(1)}, "time 1": arb(2)})


def test_a_table_may_not_be_exceeded(point: Certificate) -> None:
    stored = enclosures_of(point)
    assert not list(unconfirmed(stored, wider(stored, 0.75), "again"))
    assert not list(unconfirmed(stored, stored, "again"))
    assert list(unconfirmed(stored, wider(stored, 1 + 2.0**-20), "again"))


def test_enclosures_of_another_kind_of_claim_prove_nothing(point: Certificate) -> None:
    for claim, found in ((known("fs3"), springs("once")[1]), (springs("once")[0], enclosures_of(point))):
        assert isinstance(prove(claim, Checklist(), found), NotProved)


def test_what_no_integration_confirms_is_found(point: Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    """All enclosures are a little wider than the stored ones, and prove the claim."""
    asked = []

    def enclose(candidate: Any, settings: Any, progress: Any) -> Enclosures:
        asked.append(settings)
        return wider(enclosures_of(point), 1.1)

    monkeypatch.setattr(chapter, "enclose", enclose)
    found = recheck(point, True)
    assert (found.level, len(asked)) == (Level.CONCLUSION, 4)
    assert all(place.startswith("not confirmed") for place in places(found))
    assert places(found)
    assert min(settings.precision for settings in asked[:3]) > point.computation.precision == asked[0].precision - 32
    assert (asked[3].precision, asked[3].order) == (point.computation.precision, point.computation.order)
    assert asked[0].order > point.computation.order


def test_what_one_integration_confirms_needs_no_other(point: Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    tables = [wider(enclosures_of(point), 1.1), enclosures_of(point)]
    monkeypatch.setattr(chapter, "enclose", lambda *_: tables.pop(0))
    assert recheck(point, True).level is Level.INTEGRATION
    assert not tables


def test_a_new_proof_of_a_level_form_is_one_for_the_own_box(monkeypatch: pytest.MonkeyPatch) -> None:
    row = certify(known("em1"), Limits(max_precision=256, level="integral"))
    stored = enclosures_of(row)
    honestly = chapter.for_origin

    def for_origin(origin: Any, outcome: Any, precision: int) -> Any:
        if precision == row.computation.precision:
            return honestly(origin, outcome, precision)
        return NotProved(Reason("candidate-box", "it is outside", "none"), outcome.hypotheses)

    monkeypatch.setattr(chapter, "enclose", lambda *_: stored)
    assert recheck(row, True).level is Level.INTEGRATION
    monkeypatch.setattr(chapter, "for_origin", for_origin)
    found = recheck(row, True)
    assert found.level is Level.CONCLUSION
    assert "candidate-box: it is outside" in found.why


# What is carried


def test_a_place_belongs_to_what_a_digest_covers(point: Certificate) -> None:
    placed = point.with_place(PLACE)
    assert placed.to_json()["digest"] == digest(placed.to_json()) != point.to_json()["digest"]
    assert placed.without_place() == point
    changed = Certificate.from_json({**placed.to_json(), "id": "another"})
    assert changed.without_place() is changed
    assert point.without_place() is point


def test_a_proof_has_the_hypotheses_of_its_theorem(point: Certificate) -> None:
    assert is_proof_of(point, point.candidate)
    for change in (lambda d: d["hypotheses"].pop(), lambda d: d["hypotheses"].reverse()):
        assert not is_proof_of(forged(point, change), point.candidate)


# Systems that are not known here


def stated(change: Callable[[dict[str, Any]], Any]) -> Any:
    """The system of a claim about one that is not known here, from its statement."""
    candidate, _ = springs("once")
    unproved = make_certificate(candidate, NotProved(Reason("time", "it is late", "give it more")), COMPUTATION)
    statement = unproved.to_json()["statement"]
    statement["candidate"]["system"] = "somebody-elses"
    change(statement)
    return systems_with({}, statement, statement["candidate"])["somebody-elses"]


COMPUTATION = Computation(64, 16, 1, 1, 0.0)
STATEMENTS: dict[str, tuple[Callable[[dict[str, Any]], Any], str]] = {
    "signs without a symmetry": (lambda s: s.update(symmetry=[1, 1, 1, 1]), "its signs are missing"),
    "a symmetry without signs": (lambda s: s["candidate"].update(symmetry="S"), "its signs are missing"),
    "a coordinate for a symmetry": (
        lambda s: (s["candidate"].update(symmetry="x"), s.update(symmetry=[1, 1, 1, 1])), "coordinate or parameter",
    ),
    "a parameter too few": (lambda s: s["candidate"].update(parameters={}), "all have to be given"),
    "neither integral nor family": (lambda s: s.update(first_integral=None), "all have to be given"),
    "a sentence for a title": (lambda s: s["names"].update(system="All orbits are stable. It is proved"), "no title"),
    "a sentence for an integral": (lambda s: s["names"].update(first_integral="energy. It is proved"), "no title"),
}  # fmt: skip


@pytest.mark.parametrize("name", STATEMENTS)
def test_a_statement_describes_a_reversible_system(name: str) -> None:
    change, words = STATEMENTS[name]
    assert stated(lambda statement: None).state == ("x", "y", "vx", "vy")
    with pytest.raises(ValueError, match=words):
        stated(change)


def test_a_system_whose_parameters_follow_from_others_cannot_be_checked_by_itself() -> None:
    with pytest.raises(CannotBeCheckedError, match="parameters that follow from others"):
        stated(lambda statement: statement.update(derived_parameters={"w": "v0 = w\nreturn v0"}))
