"""Whatever is asked for is checked, as far as it was asked for, and what is not brought to an end is not passed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from support.forgeries import atlas_certificate, forged, of_parabola
from support.stored import values

from orbitproof.shared.formats import read_atlas
from orbitproof.shared.processes import Failure
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.certificate import Certificate, Finding, Level, Recheck
from orbitproof.verify.evidence import ball_to_json
from orbitproof.verify.run import CheckLimits, Workplace, branch_checks, checking_again, rows

QUIET = Workplace(quiet=True)
DATA = Path(__file__).parents[1] / "data"
PLACE = {
    "rests_on": {"id": "loop", "digest": "sha256:" + 64 * "0"}, "piece": "p001", "s": ball_to_json(arb(0, 1)),
    "mirrored": False, "other_point": False, "statement": "on the loop",
}  # fmt: skip


def curve() -> Certificate:
    atlas, results = of_parabola()
    return Certificate(atlas_certificate(atlas, results))


def standing(name: str, level: Level = Level.CONCLUSION) -> Recheck:
    return Recheck(name, "proved", 1, (), level=level)


@pytest.mark.parametrize("integrate", [False, True])
def test_rows_places_and_branches_are_all_checked_as_far_as_is_asked_for(
    integrate: bool, point: Certificate, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, bool]] = []

    def of_rows(certificates: Sequence[Certificate], far: bool, *_: Any) -> Iterator[Recheck]:
        for entry in certificates:
            asked.append((f"row {entry.id}", far))
            yield standing(entry.id)

    def of_places(on: Any, certificates: Sequence[Certificate], checks: Any, far: bool, _: Any) -> Iterator[Recheck]:
        assert [checks[entry.id].id for entry in certificates] == [entry.id for entry in certificates]
        for entry in certificates:
            asked.append((f"place of {entry.id} on {on.id}", far))
            yield standing(entry.id)

    def of_branch(certificate: Certificate, given: Any, far: bool, _: Any) -> Recheck:
        asked.append((f"branch {certificate.id}", far))
        return standing(certificate.id)

    monkeypatch.setattr(checking_again, "rechecks", lambda *rest: (each for each in of_rows(*rest)))
    monkeypatch.setattr(branch_checks, "places_checked", of_places)
    monkeypatch.setattr(branch_checks, "examined", of_branch)
    placed = Certificate.from_json(forged(point.with_place(PLACE).to_json(), lambda d: d.update(id="placed")))
    with closing(checking_again.checked_again([curve(), point, placed], [curve()], integrate, QUIET)) as found:
        assert [(entry.id, check.id) for entry, check in found] == [
            (name, name) for name in (point.id, "placed", "placed", "parabola")
        ]
    wanted = [f"row {point.id}", "row placed", "place of placed on parabola", "branch parabola"]
    assert asked == [(what, integrate) for what in wanted]


def test_what_stands_is_integrated_again_and_what_does_not_is_not(point: Certificate) -> None:
    other = Certificate.from_json(
        forged(point.to_json(), lambda d: (d.update(id="forged"), d["results"].update(side="above")))
    )
    with closing(rows.rechecks([point, other], True, 1, lambda *_: None, CheckLimits())) as found:
        checks = {check.id: check for check in found}
    assert (checks[point.id].stands, checks[point.id].level) == (True, Level.INTEGRATION)
    assert (checks["forged"].stands, checks["forged"].level) == (False, Level.FORM)


def test_an_integration_that_was_not_brought_to_an_end_is_none(
    point: Certificate, monkeypatch: pytest.MonkeyPatch
) -> None:
    def apart(certificates: Sequence[Certificate], far: bool, *_: Any) -> Iterator[tuple[Certificate, Any]]:
        for entry in certificates:
            yield entry, Failure("time", "it was late") if far else standing(entry.id)

    monkeypatch.setattr(rows, "_checked_apart", lambda *rest: (each for each in apart(*rest)))
    with closing(rows.rechecks([point], True, 1, lambda *_: None, CheckLimits())) as found:
        (check,) = found
    assert (check.stands, check.level, check.findings) == (False, Level.CONCLUSION, ())
    assert check.obstacle.startswith("it was late")


@pytest.mark.parametrize("integrate", [False, True])
@pytest.mark.parametrize("stands", [False, True])
def test_a_branch_that_stands_is_integrated_again_where_that_is_asked_for(
    integrate: bool, stands: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = standing("parabola") if stands else Recheck("parabola", "proved", 1, (Finding("results", "is none"),))
    again = standing("parabola", Level.INTEGRATION)
    monkeypatch.setattr(branch_checks, "check_apart", lambda *_: first)
    monkeypatch.setattr(branch_checks, "recheck", lambda certificate, far, given: again if far else first)
    assert branch_checks.examined(curve(), (), integrate, QUIET) is (again if integrate and stands else first)


def test_a_place_that_was_not_looked_at_is_not_passed(point: Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    placed = point.with_place(PLACE)
    monkeypatch.setattr(branch_checks, "apart", lambda *_: Failure("memory", "it was large"))
    check = branch_checks.place_apart(curve(), standing("parabola"), placed, standing(placed.id), CheckLimits())
    assert (check.stands, check.level) == (False, Level.FORM)
    assert check.obstacle.startswith("its place: it was large")


def test_no_place_rests_on_a_surface(point: Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its certificate is not even looked at."""
    atlas = read_atlas(DATA / "surface.json")
    results = values(json.loads((DATA / "surface-results.json").read_text()))
    surface = Certificate(make_atlas_certificate(atlas, results, None))
    handed: list[Any] = []

    def place(on: Any, checked: Any, certificate: Certificate, check: Recheck, _: Any) -> Recheck:
        handed.append(checked)
        return check

    monkeypatch.setattr(branch_checks, "place_apart", place)
    monkeypatch.setattr(branch_checks, "examined", lambda certificate, *_: standing(certificate.id))
    for on in (surface, curve(), None):
        list(branch_checks.places_checked(on, [point], {point.id: standing(point.id)}, False, QUIET))
    assert handed == [None, standing("parabola"), None]


def test_certificates_of_bifurcations_are_checked_in_their_order(
    point: Certificate, monkeypatch: pytest.MonkeyPatch
) -> None:
    entries = [Certificate.from_json(forged(point.to_json(), lambda d, name=name: d.update(id=name))) for name in "abc"]
    monkeypatch.setattr(
        branch_checks, "rechecks", lambda given, *_: (standing(entry.id) for entry in reversed(list(given)))
    )
    assert [check.id for check in branch_checks.checked_side_by_side(entries, False, QUIET)] == ["a", "b", "c"]
