"""What claims about curves without symmetry may say, and what is told of them: no integration (sections 26.1, 26.5)."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.periodic_curves import LEVELS, ROUND, closed_atlas

from orbitproof.shared.formats import InputError, PeriodicAtlas, define_system, read_atlas, write_atlas
from orbitproof.shared.systems import ParameterRange, describe
from orbitproof.verify.evidence import NotProved, Proved
from orbitproof.verify.periodic_curve import conclude_periodic
from orbitproof.verify.theorems.periodic_curve import told

F = Fraction
FALLING = (-1.1, -0.75, -0.45)
"""Angles of an arc along which a and x increase."""
SYSTEMS: dict[str, dict[str, Any]] = {
    "two": {
        "name": "two",
        "state": "x y",
        "parameters": "a",
        "field": {"x": "y", "y": "-x"},
        "first_integral": "x**2 + y**2",
    },
    "sine": {"name": "sine", "state": "x y", "parameters": "a b", "field": {"x": "y", "y": "a*sin(x) + b"}},
}
RowJson = dict[str, Any]


def with_b(**claim: Any) -> tuple[PeriodicAtlas, Any]:
    """The same arc where the field has a further parameter."""
    field = {"x": "b*x - y", "y": "b*y + x + a"}
    system = define_system(
        {"name": "with-b", "state": "x y", "parameters": {"a": [None, None], "b": [0, 3]}, "field": field}
    )
    atlas, results = closed_atlas(FALLING, kind="periodic-arc", **claim)
    return replace(atlas, system=system, parameters={"b": F(3, 2)}), results


def described(name: str) -> RowJson:
    """The description of another system as it stands in a file."""
    return {"system": describe(define_system(SYSTEMS[name]))}


WRONG: dict[str, tuple[Callable[[RowJson], Any], str]] = {
    "outside its range": (lambda e: e["parameters"].update(b="3"), "field parameters.b: 3 lies outside (0, 3)"),
    "a function": (
        lambda e: (e.update(described("sine")), e["claim"].update(normal=["0", "1", "0", "0"])),
        "claim.normal: 4 numbers; give 2; the state is x, y",
    ),
    "twice": (lambda e: e["claim"].update(increasing=["a", "a"]), "field claim.increasing[1]: 'a'"),
    "no coordinate": (
        lambda e: e["claim"].update(covers={"coordinate": "y", "from": "0", "to": "1"}),
        "field claim.covers.coordinate: 'y'",
    ),
    "no room": (
        lambda e: (e.update(described("two")), e["claim"].update(level="1"), e.update(parameters={})),
        "field claim.kind: a state of 2 coordinates",
    ),
    "a level that varies": (
        lambda e: (e.update(described("two")), e["claim"].update(level="1"), e["claim"].pop("parameter")),
        "field claim.level: the level varies",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_claims_that_say_too_much_are_refused_with_the_field(name: str, tmp_path: Path) -> None:
    change, said = WRONG[name]
    path = tmp_path / "atlas.json"
    write_atlas(path, with_b()[0])
    assert isinstance(read_atlas(path), PeriodicAtlas)
    entry = json.loads(path.read_text())
    change(entry)
    path.write_text(json.dumps(entry))
    with pytest.raises(InputError) as caught:
        read_atlas(path)
    assert said in str(caught.value)


CLAIMS: dict[str, tuple[dict[str, Any], str]] = {
    "another kind": ({"kind": "arc"}, "no claim about such a curve"),
    "a normal of another space": ({"normal": (F(0), F(1), F(0))}, "no normal"),
    "no normal": ({"normal": (F(0), F(0))}, "no normal"),
    "no direction": ({"direction": 2}, "no such crossings"),
    "no crossing": ({"crossings": 0}, "no such crossings"),
}


def of_the_section(atlas: PeriodicAtlas, results: Any) -> str:
    """What hypothesis `section` says against a claim."""
    outcome = conclude_periodic(atlas, results).outcome
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "section"
    return outcome.reason.message


@pytest.mark.parametrize("name", CLAIMS)
def test_claims_that_make_no_sense_are_not_proved(name: str) -> None:
    change, said = CLAIMS[name]
    atlas, results = with_b()
    assert said in of_the_section(replace(atlas, claim=replace(atlas.claim, **change)), results)


def test_a_level_is_given_or_varies() -> None:
    atlas, results = with_b()
    claim = replace(atlas.claim, parameter=None, level=F(1))
    everything = {"a": F(1), "b": F(1)}
    assert "given, and varies" in of_the_section(replace(atlas, claim=claim, parameters=everything), results)


def test_a_curve_has_a_piece_and_a_closed_one_two() -> None:
    for kind, angles in (("periodic-arc", ()), ("periodic-loop", ROUND[:1])):
        atlas, results = closed_atlas(angles, kind=kind)
        outcome = conclude_periodic(atlas, results).outcome
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "pieces"
        assert "too few" in outcome.reason.message


def test_extrema_are_told_as_what_they_are() -> None:
    for angle, words in ((0.0, "one extremum: a maximum between"), (3.0, "one extremum: a minimum between")):
        atlas, results = closed_atlas((angle,), kind="periodic-arc")
        assert words in told(conclude_periodic(atlas, results))["statement"]


def test_over_the_levels_of_an_integral_no_extrema_are_told() -> None:
    """The first coordinate is then one of the state."""
    atlas, results = closed_atlas(kind="periodic-loop", parameter=None, normal=(F(0), F(1), F(0)))
    outcome = conclude_periodic(replace(atlas, system=LEVELS, parameters={"a": F(1)}), results).outcome
    assert isinstance(outcome, Proved)
    assert not outcome.results.turns


@pytest.mark.parametrize("angle", [0.75, -0.75, 2.4, -2.4])
def test_no_point_of_a_piece_leaves_the_range_of_the_parameter(angle: float) -> None:
    """Also at the edges of the tube, and where its polynomial has a constant."""
    atlas, results = closed_atlas((angle,), kind="periodic-arc")
    (piece,) = atlas.curve_pieces()
    ((_, *others),) = piece.polynomial
    moved = replace(piece, polynomial=((F(1, 16), *others),))
    assert conclude_periodic(replace(atlas, pieces=(moved,)), results).is_proved
    across = [side * moved.frame[0][1] * moved.tube[0] for side in (-1, 1)]
    values = [moved.point(F(s))[0] + shift for s in (-1, 0, 1) for shift in across]
    for limits in ((min(values), None), (None, max(values))):
        system = replace(atlas.system, parameters={"a": ParameterRange(*limits)})
        outcome = conclude_periodic(replace(atlas, system=system, pieces=(moved,)), results).outcome
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "pieces"
