"""The complete list of a certificate as values."""

from __future__ import annotations

from typing import Any

import pytest
from support.balls import agree
from support.stability_cases import atlas, listed, results
from support.stored import values

from orbitproof.shared import InputError
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.evidence import ball_from_json


def certificate(**changes: Any) -> Certificate:
    conclusion = listed(results())
    conclusion = {**conclusion, "complete": {**conclusion["complete"], **changes}}
    return Certificate(make_atlas_certificate(atlas(), values(results()), conclusion))


def test_points_and_stable_intervals_are_those_of_the_document() -> None:
    found = certificate()
    entries = found.document["conclusion"]["complete"]
    assert [(p.piece, p.kind, p.k, p.j) for p in found.points] == [
        (e["piece"], e["kind"], e["k"], e["j"]) for e in entries["points"]
    ]
    for point, entry in zip(found.points, entries["points"], strict=True):
        assert agree(point.level, ball_from_json(entry["level"]))
        assert set(point.point) == set(entry["point"])
    (interval,) = found.stable
    assert list(interval.start.what) == entries["stable"][0]["from"]["what"]
    assert interval.start.interval[0] <= interval.start.interval[1]
    assert len(repr(found.points[0])) < 60
    assert found.verdict == "proved"


def test_without_a_list_there_is_nothing_and_what_is_none_is_refused_in_a_line() -> None:
    assert Certificate(make_atlas_certificate(atlas(), values(results()), None)).points == ()
    for changes in ({"points": [{"piece": "p001"}]}, {"points": [3]}, {"stable": [{"from": {}}]}):
        found = certificate(**changes)
        with pytest.raises(InputError, match="of the list: "):
            _ = found.points, found.stable
