"""The integration of an atlas's certificate again: what another proof of an interval has to confirm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from typing import Any

import pytest
from support import atlas_work
from support.atlas_runs import CURVE, go

from orbitproof.shared.processes import Answer, Task
from orbitproof.verify.atlas.certificate import make_atlas_certificate
from orbitproof.verify.atlas.conclusion import conclusion_of
from orbitproof.verify.atlas.recheck import Means, _contradictions, recheck_atlas
from orbitproof.verify.certificate import Level, Recheck


def document() -> dict[str, Any]:
    run, _ = go(CURVE, atlas_work.proving)
    conclusion = conclusion_of(
        CURVE, run.results, (), lambda entries: (), None, lambda names: nullcontext(lambda name: None)
    )
    return make_atlas_certificate(CURVE, run.results, conclusion, ())


def checked(change: Callable[[dict[str, Any]], None]) -> Recheck:
    """Check again with a prover whose results on the second piece are changed."""

    def prove(tasks: Sequence[Task], finished: Callable[[Answer], str]) -> None:
        for task in tasks:
            result = atlas_work.proving(task.argument, lambda fraction, label: None)
            if result["piece"] == "p001":
                change(result)
            finished(Answer(task, result, 0.25))

    return recheck_atlas(document(), (), True, Means(lambda entries, integrate: (), prove))


def test_an_integration_that_finds_the_same_confirms() -> None:
    assert checked(lambda result: None).findings == ()


def test_an_atlas_of_which_nothing_is_proved_does_not_pass_the_last_level() -> None:
    conclusion = conclusion_of(CURVE, (), (), lambda entries: (), None)
    nothing = make_atlas_certificate(CURVE, (), conclusion)
    found = recheck_atlas(nothing, (), True, Means(lambda entries, integrate: (), lambda tasks, finished: None))
    assert (found.stands, found.level) == (True, Level.CONCLUSION)
    assert "nothing was integrated again: it stores no proved intervals" in found.notes
    assert checked(lambda result: None).level is Level.INTEGRATION


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
    above, below = ({**result, "parts": [{"interval": ["-0x1", "0x1"], "side": side}]} for side in ("above", "below"))
    assert not list(_contradictions(above, above))
    assert [finding.place for finding in _contradictions(above, below)] == [
        "piece p001, s in [-0x1, 0x1], part [-0x1, 0x1], side"
    ]
