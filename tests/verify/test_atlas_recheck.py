"""The integration of an atlas's certificate again: what another proof of an interval has to confirm."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from typing import Any

import pytest
from support import atlas_work
from support.atlas_runs import CURVE, go
from support.claims import known
from support.forgeries import atlas_certificate, fabricated, forged, honest, of_parabola
from support.stored import value_of, values

from orbitproof.shared.claims import Atlas
from orbitproof.verify.branches import Means, ProvedBefore, conclusion_of, make_atlas_certificate
from orbitproof.verify.branches.recheck import _contradictions
from orbitproof.verify.certificate import (
    Certificate,
    Finding,
    Given,
    Level,
    Limits,
    Recheck,
    certify,
    not_proved,
    recheck,
)
from orbitproof.verify.evidence import Reason
from orbitproof.verify.run.branch_tasks import task_again
from orbitproof.verify.theorems.surface import KIND


def document() -> dict[str, Any]:
    run, _ = go(CURVE, atlas_work.proving)
    conclusion = conclusion_of(
        CURVE, values(run.results), (), lambda entries: (), None, lambda names, word: nullcontext(lambda name: None)
    )
    return make_atlas_certificate(CURVE, values(run.results), conclusion, ())


def without_integrating(changed: Mapping[str, Any]) -> Recheck:
    return recheck(Certificate(changed), False, given=Given((), means=Means(lambda entries, integrate: ())))


def checked(change: Callable[[dict[str, Any]], None]) -> Recheck:
    """Check again with a prover whose results on the second piece are changed."""

    def prove(atlas: Atlas, intervals: Sequence[ProvedBefore], finished: Callable[[str, Any], str]) -> None:
        for each in intervals:
            result = atlas_work.proving(task_again(atlas, each, None).argument, lambda fraction, label: None)
            if result["piece"] == "p001":
                change(result)
            finished(each.name, value_of(result))

    return recheck(Certificate(document()), True, given=Given((), means=Means(lambda entries, integrate: (), prove)))


def test_an_integration_that_finds_the_same_confirms() -> None:
    assert checked(lambda result: None).findings == ()


def test_an_atlas_of_which_nothing_is_proved_does_not_pass_the_last_level() -> None:
    conclusion = conclusion_of(CURVE, values(()), (), lambda entries: (), None)
    nothing = make_atlas_certificate(CURVE, values(()), conclusion)
    found = recheck(
        Certificate(nothing),
        True,
        given=Given((), means=Means(lambda entries, integrate: (), lambda atlas, intervals, finished: None)),
    )
    assert (found.stands, found.level) == (True, Level.CONCLUSION)
    assert "nothing was integrated again: it stores no proved intervals" in found.notes
    assert checked(lambda result: None).level is Level.INTEGRATION


@pytest.mark.parametrize("condition", ["time", "memory", "process"])
def test_an_interval_that_is_not_brought_to_an_end_says_nothing_against_the_certificate(condition: str) -> None:
    reason = {"condition": condition, "message": "it was ended", "remedy": "give more"}
    found = checked(lambda result: result.update(verdict="not proved", reason=reason))
    assert (found.findings, found.stands, found.word) == ((), False, "cannot be checked here")
    assert found.level is Level.CONCLUSION
    assert "it was ended; give more" in found.obstacle
    assert "p001" in found.obstacle


BALL = {"mid": "0x3", "rad": "0x1p-1", "decimal": "[2.5, 3.5]"}
REASON = {"condition": "tube", "message": "the tube is empty", "remedy": ""}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"verdict": "not proved", "reason": REASON}, "is not proved again: the tube is empty"),
        ({"interval": ["-0x1", "0xffp-8"]}, "is proved on less than that"),
        ({"time": BALL}, "does not confirm"),
        ({"time": {"mid": "0x9", "rad": "0x1p-2", "decimal": "[8.75, 9.25]"}}, "half period"),
        ({"deviation": ["0x3p-31"]}, "the new integration finds"),
        ({"slope_deviation": ["0x3p-27"]}, "the new integration finds"),
    ],
)
def test_what_an_integration_does_not_confirm_is_found(change: dict[str, Any], said: str) -> None:
    examined = checked(lambda result: result.update(change))
    assert any(said in finding.message or said in finding.place for finding in examined.findings)


def test_a_contradiction_is_not_mended_by_a_second_integration() -> None:
    asked: list[str] = []

    def once(result: dict[str, Any]) -> None:
        asked.append(result["piece"])
        if len(asked) == 1:
            result["time"] = {"mid": "0x9", "rad": "0x1p-2", "decimal": "[8.75, 9.25]"}

    assert any("half period" in finding.place for finding in checked(once).findings)
    assert len(asked) == 2


def test_sides_that_differ_contradict_each_other() -> None:
    result = document()["results"][1]
    part = {"interval": ["-0x1", "0x1"], "point": [], "hypotheses": {}}
    above, below = ({**result, "parts": [{**part, "side": side}]} for side in ("above", "below"))
    assert not list(_contradictions(value_of(above), value_of(above), KIND))
    assert [finding.place for finding in _contradictions(value_of(above), value_of(below), KIND)] == [
        "piece p001, s in [-0x1, 0x1], part [-0x1, 0x1], side"
    ]


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (lambda d: d["results"].append({**d["results"][0], "piece": "p999"}), "results[3].piece"),
        (lambda d: d["conclusion"]["hypotheses"].pop(), "hypotheses"),
        (lambda d: d["conclusion"]["hypotheses"].reverse(), "hypotheses"),
    ],
    ids=["no such piece", "a hypothesis less", "another order"],
)
def test_what_is_malformed_is_found_before_anything_is_evaluated(change: Any, place: str) -> None:
    assert without_integrating(document()).stands
    found = without_integrating(forged(document(), change))
    assert (found.level, found.findings[0].place) == (Level.NONE, place)


def test_a_run_that_was_not_finished_is_no_certificate() -> None:
    run, _ = go(CURVE, atlas_work.proving)
    found = without_integrating(make_atlas_certificate(CURVE, values(run.results[:2]), None, ()))
    assert (found.level, found.findings[0].place) == (Level.NONE, "conclusion")


def test_decimals_that_are_not_those_of_their_ball_are_found() -> None:
    found = without_integrating(forged(document(), lambda d: d["results"][2]["time"].update(decimal="[2.7, 3.2]")))
    assert (found.level, found.findings[0].place) == (Level.FORM, "results[2], time")


def test_two_certificates_of_one_id_are_refused() -> None:
    entry = not_proved(known("fs3"), Reason("time", "it is late", "give it more"), 0.0)
    run, _ = go(CURVE, atlas_work.proving)
    with pytest.raises(ValueError, match="appears twice"):
        conclusion_of(CURVE, values(run.results), [entry, entry], lambda entries: [], None)


def test_what_another_integration_finds_about_a_bifurcation_on_the_curve_is_said() -> None:
    """Its certificate is checked again with an integration, and one that is not on the curve is not."""
    atlas, results = of_parabola()
    point = certify(known("fs3"), Limits(max_precision=256))
    near = fabricated(point, ("2", "4e-2"), "near")
    carried = atlas_certificate(atlas, results, [near, point])
    assert [entry["on_curve"] for entry in carried["conclusion"]["bifurcations"]] == [True, False]
    integrated: list[str] = []

    def prove(atlas: Atlas, intervals: Sequence[ProvedBefore], finished: Callable[[str, Any], str]) -> None:
        for each in intervals:
            argument = task_again(atlas, each, None).argument
            finished(each.name, value_of(honest(results)(argument, lambda fraction, label: None)))

    def examined(entries: Sequence[Certificate], integrate: bool, *found: Finding, **changes: Any) -> list[Recheck]:
        integrated.extend(entry.id for entry in entries if integrate)
        seen = found if integrate else ()
        return [Recheck(entry.id, "proved", 1, seen, **(changes if integrate else {})) for entry in entries]

    for found, changes, said, obstacle in (
        ((), {}, [], ""),
        ((Finding("tables", "is disjoint"),), {}, [("bifurcation near, tables", "is disjoint")], ""),
        ((), {"obstacle": "no time"}, [], "bifurcation near: no time"),
    ):
        means = Means(lambda entries, integrate, f=found, c=changes: examined(entries, integrate, *f, **c), prove)
        check = recheck(Certificate(carried), True, given=Given((), means=means))
        assert [(finding.place, finding.message) for finding in check.findings] == said
        assert check.obstacle == obstacle
        assert check.level is (Level.CONCLUSION if said or obstacle else Level.INTEGRATION)
    assert integrated == ["near"] * 3
