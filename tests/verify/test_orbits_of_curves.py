"""What a proved curve says of single orbits, against an integrator of its own, and rows of a published catalogue."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import acb, arb, ctx
from support import catalogue_cases
from support.balls import agree
from support.forgeries import checked_by, forged
from support.runs import done_here
from support.stored import values
from support.three_body import Orbits, problem_of
from support.within import within

from orbitproof import verify
from orbitproof.explore.names import NoOrbit
from orbitproof.explore.three_body.trajectories import Choice, find_orbit
from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.formats import FIELDS, CatalogueRows, InputError, atlas_from_json, read_catalogue_rows
from orbitproof.verify.__main__ import main
from orbitproof.verify.branches import catalogue, catalogue_table, certified_rows, certified_table, rows_of_curve
from orbitproof.verify.branches.catalogue import orbits_of
from orbitproof.verify.branches.catalogue_table import rounded_up
from orbitproof.verify.certificate import (
    Certificate,
    Examination,
    Given,
    Recheck,
    read_certificate,
    recheck,
    write_certificate,
)
from orbitproof.verify.curve import ProvedCurve, conclude
from orbitproof.verify.evidence import Proved, ball_to_json, enclose, exact_value, symmetric
from orbitproof.verify.orbit import stability_from
from orbitproof.verify.orbit_on_curve import OrbitOnCurve, OrbitPlace, OrbitsOfCurve
from orbitproof.verify.orbit_on_curve.orbit_on_curve import _index
from orbitproof.verify.stability import StabilityResult
from orbitproof.verify.words.catalogue import catalogue_in_words

DATA = Path(__file__).parents[1] / "data"
ARCS: dict[str, Any] = json.loads((DATA / "three-body-arcs.json").read_text())
NEAR, RETROGRADE, PIECES = "near-the-moon", "distant-retrograde", "fold-and-doublings"
_RANDOM = 40

Document = dict[str, Any]

_precision = within(lambda: ctx.workprec(192))


def orbits_from(atlas: Atlas, entries: list[Any]) -> OrbitsOfCurve:
    results = [result for result in values(entries) if isinstance(result, StabilityResult)]
    outcome = conclude(atlas, results).outcome
    assert isinstance(outcome, Proved)
    assert isinstance(outcome.results, ProvedCurve)
    return OrbitsOfCurve.of(atlas, outcome.results, results)


@cache
def arc(name: str) -> OrbitsOfCurve:
    return orbits_from(atlas_from_json(ARCS[name]["atlas"], name), ARCS[name]["results"])


@cache
def halo() -> OrbitsOfCurve:
    return orbits_of(catalogue_cases.curve())


@cache
def rows() -> CatalogueRows:
    path = DATA / "catalogue-arc.json"
    stored = json.loads(path.read_text())["catalogue"]
    numbers = tuple(tuple(Fraction(str(cell).strip()) for cell in row) for row in stored["data"])
    return CatalogueRows(Fraction(stored["system"]["mass_ratio"]), numbers, "Earth-Moon", "halo", "2", "S")


@cache
def document() -> Document:
    return certified_rows(catalogue_cases.curve(), rows())


@cache
def examined() -> Recheck:
    return recheck(catalogue_cases.curve())


def check(entry: Mapping[str, Any], curve: Certificate | None = None) -> Recheck:
    return checked_by(entry, curve or catalogue_cases.curve(), examined())


def holds(ball: arb | None, value: float, digits: float = 1e-10) -> bool:
    """Whether a ball contains a number that is known so well."""
    return ball is not None and bool((ball + arb(0, digits * max(1.0, abs(value)))).contains(arb(value)))


def index_of(minors: Any) -> float:
    """The stability index, from multipliers."""
    polynomial = [1, -minors[0]] if len(minors) == 1 else [1, -minors[0], minors[1]]
    sizes = []
    for c in np.roots(polynomial).astype(complex):
        size = max(abs(c + np.sqrt(c * c - 1)), abs(c - np.sqrt(c * c - 1)))
        sizes.append((size + 1 / size) / 2)
    return float(max(sizes))


@pytest.mark.parametrize(("name", "number"), [(NEAR, 0), (RETROGRADE, 0), ("halo", 0), (PIECES, 0), (PIECES, 2)])
def test_orbits_at_random_places_are_those_of_another_integrator(name: str, number: int) -> None:
    known = halo() if name == "halo" else arc(name)
    problem = problem_of(known.atlas)
    piece = known.atlas.curve_pieces()[number]
    low = 0.01 if piece.kind == "symmetric" else float(known.curve.chain.stretches[number].entered)
    s = np.sort(np.random.default_rng(5).uniform(low, 1.0, _RANDOM if len(known.segments) == 1 else 8))
    found: Orbits = problem.on_curve(piece, s)
    origin = np.array(problem.origin, dtype=float)[:, None]
    points, minors = found.points + origin, found.minors(problem.coordinates)
    least, greatest, *_ = found.distances
    for number, place in enumerate(s):
        orbit = known.at(OrbitPlace(piece.id, Fraction(place)))
        for ball, value in zip(orbit.point.values(), points[:, number], strict=True):
            assert holds(ball, value, 1e-9)
            assert ball.rad() < 1e-10
        assert holds(orbit.period, 2 * found.half_period[number], 1e-9)
        assert holds(orbit.least, least[number], 1e-9)
        assert holds(orbit.greatest, greatest[number], 1e-9)
        assert holds(orbit.stability_index, index_of(minors[:, number]), 1e-5)
        total, product = acb(0), acb(1)
        for c in orbit.stability.parameters:
            total, product = total + c, product * c
        assert holds(total.real, minors[0, number], 1e-5)
        assert len(minors) == 1 or holds(product.real, minors[1, number], 1e-5)
        assert orbit.period.rad() < 1e-8


def test_a_mirror_image_has_the_numbers_of_its_orbit_and_is_known_on_symmetric_curves_only() -> None:
    known = halo()
    (piece,) = known.atlas.curve_pieces()
    here, there = (known.at(OrbitPlace(piece.id, Fraction(1, 3), mirrored)) for mirrored in (False, True))
    assert {name: str(-ball if name == "z" else ball) for name, ball in here.point.items()} == {
        name: str(ball) for name, ball in there.point.items()
    }
    assert here.point["z"] < 0 < there.point["z"]
    assert str(replace(here, point={})) == str(replace(there, point={}))
    with pytest.raises(ValueError, match="nothing is proved of mirror images"):
        arc(NEAR).at(OrbitPlace("p011", Fraction(1, 3), mirrored=True))


@pytest.mark.parametrize(
    "place",
    [
        OrbitPlace("p001", Fraction(-1, 8)),
        OrbitPlace("p001", Fraction(9, 8)),
        OrbitPlace("p001", 1 + Fraction(1, 2**80)),
        OrbitPlace("p002", Fraction(1, 8)),
    ],
)
def test_a_place_off_the_curve_has_no_orbit(place: OrbitPlace) -> None:
    """The curve runs from the symmetric point s = 0 of its piece to s = 1."""
    with pytest.raises(ValueError, match="the curve does not run through"):
        halo().at(place)


def test_the_point_is_known_up_to_the_deviation_of_its_interval() -> None:
    for known in (halo(), arc(NEAR), arc(PIECES)):
        stretch = known.curve.chain.stretches[-1]
        piece, s = stretch.tube.piece, Fraction(3, 4)
        deviation = stretch.run.at(s).deviation
        orbit = known.at(OrbitPlace(piece.id, s))
        for ball, middle, row in zip(orbit.point.values(), piece.point(s), piece.frame, strict=True):
            spread = sum((abs(a) * e for a, e in zip(row[1:], deviation, strict=True)), Fraction(0))
            assert all(agree(ball, enclose(middle + sign * spread)) for sign in (-1, 1))
            assert ball.rad() <= enclose(spread * Fraction(101, 100) + Fraction(1, 2**100))


def test_without_functions_nothing_is_said() -> None:
    results = [{key: value for key, value in ARCS[NEAR]["results"][0].items() if key != "stability"}]
    known = orbits_from(arc(NEAR).atlas, results)
    with pytest.raises(ValueError, match="prove it with a list"):
        known.at(OrbitPlace("p011", Fraction(0)))


def test_the_place_next_to_a_point_of_the_curve_is_found() -> None:
    for known, side in ((halo(), False), (halo(), True), (arc(NEAR), False)):
        system, (piece,) = known.atlas.system, known.atlas.curve_pieces()
        for s in (Fraction(1, 7), Fraction(5, 8), Fraction(1)):
            orbit = known.at(OrbitPlace(piece.id, s, side))
            state = {name: Fraction(0) for name in system.state}
            state |= {name: Fraction(float(ball.mid())) for name, ball in orbit.point.items()}
            place = known.near(state)
            assert (place.piece, place.mirrored) == (piece.id, side)
            assert abs(place.s - s) < Fraction(1, 10**12)
            assert known.distance(known.at(place), state) < arb("1e-13")
            # Velocities that R negates count too.
            off = known.distance(known.at(place), {**state, "vx": Fraction(3, 1000)})
            assert off.upper() > arb("0.003")


def test_of_several_places_that_closest_to_its_piece_is_taken() -> None:
    known = halo()
    (stretch,) = known.curve.chain.stretches
    piece = stretch.tube.piece
    aside = tuple(c + 100 * max(piece.tube) for c in piece.centre)
    other = replace(stretch, tube=replace(stretch.tube, piece=replace(piece, id="aside", centre=aside)))
    orbit = known.at(OrbitPlace(piece.id, Fraction(1, 2)))
    state = {name: Fraction(0) for name in known.atlas.system.state}
    state |= {name: Fraction(float(ball.mid())) for name, ball in orbit.point.items()}
    for stretches in ((other, stretch), (stretch, other)):
        both = replace(known, curve=replace(known.curve, chain=replace(known.curve.chain, stretches=stretches)))
        place = both.near(state)
        assert place.piece == piece.id


def test_beside_a_joint_and_beyond_an_end_an_orbit_is_found_as_well() -> None:
    known, generator = arc(PIECES), random.Random(1)
    for stretch in known.curve.chain.stretches:
        orbit = known.at(OrbitPlace(stretch.tube.piece.id, stretch.leaves))
        for _ in range(40):
            state = {name: Fraction(0) for name in known.atlas.system.state}
            state |= {
                name: Fraction(float(ball.mid()) + generator.gauss(0, 1e-9)) for name, ball in orbit.point.items()
            }
            assert known.distance(known.at(known.near(state)), state).upper() < arb("1e-8")


def test_a_distance_that_the_symmetry_changes_is_left_out() -> None:
    known = halo()
    results = [result for result in catalogue_cases.curve().results if isinstance(result, StabilityResult)]
    system = replace(known.atlas.system, squared_distance=lambda state, parameters: ((state[2] - 1) * (state[2] - 1),))
    orbit = OrbitsOfCurve.of(replace(known.atlas, system=system), known.curve, results).at(
        OrbitPlace("p001", Fraction(1))
    )
    assert orbit.least is orbit.greatest is None
    assert known.at(OrbitPlace("p001", Fraction(1))).least is not None


def test_a_row_beside_the_plane_is_so_far_from_an_orbit_in_the_plane() -> None:
    known = arc(RETROGRADE)
    (piece,) = known.atlas.curve_pieces()
    orbit = known.at(OrbitPlace(piece.id, Fraction(0)))
    state = {name: Fraction(0) for name in FIELDS[:6]}
    state |= {name: Fraction(float(ball.mid())) for name, ball in orbit.point.items()}
    assert known.near({**state, "z": Fraction(1, 100)}) == known.near(state)
    for name in ("z", "vz"):
        distance = known.distance(orbit, {**state, name: Fraction(1, 100)})
        assert arb("0.01") < distance.upper() < arb("0.0101")
    assert len(orbit.stability.parameters) == 1


def test_the_distance_bounds_that_of_all_points_of_the_balls() -> None:
    known = halo()
    orbit = known.at(OrbitPlace("p001", Fraction(1, 2)))
    generator = random.Random(3)
    for _ in range(200):
        state = {name: Fraction(generator.gauss(0, 1e-3)) for name in known.atlas.system.state}
        points = {
            name: float(ball.mid()) + generator.uniform(-1, 1) * float(ball.rad()) for name, ball in orbit.point.items()
        }
        true = sum((float(value) - points.get(name, 0.0)) ** 2 for name, value in state.items()) ** 0.5
        bound = float(known.distance(orbit, state).upper())
        assert true * (1 - 1e-12) <= bound < true * (1 + 1e-8)


def test_the_stability_index_is_that_of_multipliers() -> None:
    generator = np.random.default_rng(8)
    for _ in range(500):
        c = generator.normal(0, 2, 2)
        for coefficients in ([c[0]], [c[0] + c[1], c[0] * c[1]], [2 * c[0], c[0] ** 2 + c[1] ** 2]):
            exact = [arb(float(value)) for value in coefficients]
            found = _index(stability_from(exact))
            assert holds(found, index_of(np.array([float(value) for value in coefficients])), 1e-7)
    assert _index(stability_from([arb(0), arb(0), arb(0)])) is None


def test_rows_of_the_published_catalogue_are_certified() -> None:
    certificate = Certificate(document())
    assert not certificate.proved
    assert repr(certificate) == "<Certificate 'halo-from-the-plane': not proved, 4 of 5 rows>"
    on, off = certificate.rows[: catalogue_cases.ON_THE_ARC], certificate.rows[catalogue_cases.ON_THE_ARC :]
    assert [row.orbit is not None for row in on] == [True] * 4
    assert [row.mirrored for row in on] == [False, False, True, False]
    for row in on:
        assert row.orbit is not None
        assert row.differences is not None
        assert row.differences.point < arb("1e-12")
        assert row.differences.level < arb("1e-13")
        assert row.differences.period < arb("1e-12")
        assert row.differences.stability_index is not None
        assert row.differences.stability_index < arb("1e-3")
        for ball, value in ((row.orbit.level, row.given[6]), (row.orbit.period, row.given[7])):
            assert abs(ball - float(value)) < arb("1e-12")
    assert [row.lacks for row in off] == ["nearness"]
    assert all(row.orbit is None and row.piece is None for row in off)
    theorem = document()["statement"]["theorem"]
    assert "For each of 4 of 5 rows" in theorem
    assert catalogue_cases.curve().document["digest"] in theorem


def test_a_row_farther_away_than_asked_for_is_not_certified() -> None:
    given = rows().rows[1]
    shifted = tuple(
        value + (Fraction(1, 10**7) if field == "vy" else 0) for field, value in zip(FIELDS, given, strict=True)
    )
    moved = replace(rows(), rows=(given, shifted))
    for distance, lacks in ((Fraction(1, 10**6), [None, None]), (Fraction(1, 10**8), [None, "nearness"])):
        found = Certificate(certified_rows(catalogue_cases.curve(), moved, distance))
        assert [row.lacks for row in found.rows] == lacks
        assert found.proved is (lacks == [None, None])
    first, second = Certificate(certified_rows(catalogue_cases.curve(), moved)).rows
    assert second.differences is not None
    # Along the curve it is compared with a neighbour: the difference shows in the coordinates together.
    assert arb("1e-9") < second.differences.point.upper() < arb("1.1e-7")
    assert first.differences is not None
    assert first.differences.point.upper() < arb("1e-12")


def test_rows_beside_the_plane_are_certified_by_orbits_in_it_as_far_as_they_are_near() -> None:
    curve = catalogue_cases.certificate_of(
        atlas_from_json(ARCS[RETROGRADE]["atlas"], RETROGRADE), ARCS[RETROGRADE]["results"]
    )
    known = orbits_of(curve)
    orbit = known.at(OrbitPlace(known.atlas.curve_pieces()[0].id, Fraction(1, 3)))
    point = {name: Fraction(float(ball.mid())) for name, ball in orbit.point.items()}
    numbers = (orbit.level, orbit.period, orbit.stability_index)
    behind = tuple(Fraction(float(ball.mid())) for ball in numbers if ball is not None)
    lines = tuple(
        (*(({**point, "z": z}).get(name, Fraction(0)) for name in FIELDS[:6]), *behind)
        for z in (Fraction(0), Fraction(1, 10**7), Fraction(1, 10**5))
    )
    found = certified_rows(curve, CatalogueRows(known.atlas.parameters["mu"], lines, "Earth-Moon", "DRO"))
    assert checked_by(found, curve, recheck(curve)).stands
    plane, near, far = Certificate(found).rows
    assert plane.differences is not None
    assert near.differences is not None
    assert plane.differences.point.upper() < arb("1e-12") < arb("0.99e-7") < near.differences.point.upper()
    assert far.lacks == "nearness"


def test_the_theorem_says_how_often_half_orbits_meet_the_section() -> None:
    atlas = replace(halo().atlas, claim=replace(halo().atlas.claim, crossings=3))
    arguments = ("curve", "sha256:0", 1, 2, Fraction(1, 10**6))
    assert ", half orbits meeting the section 3 times." in catalogue_in_words(atlas, *arguments)
    assert "times" not in catalogue_in_words(halo().atlas, *arguments)


def test_a_huge_number_in_a_row_hinders_no_other() -> None:
    huge = tuple(
        Fraction(10) ** 308 if field == "x" else value for field, value in zip(FIELDS, rows().rows[1], strict=True)
    )
    found = certified_rows(catalogue_cases.curve(), replace(rows(), rows=(rows().rows[0], huge)))
    assert [row.get("lacks") for row in found["rows"]] == [None, "nearness"]
    assert check(found).stands


def test_a_family_without_a_title_is_told_before_anything_is_looked_at() -> None:
    for family in ("halo; all of it is proved", "h" * 300):
        with pytest.raises(InputError, match="is no title; give letters"):
            certified_rows(catalogue_cases.curve(), replace(rows(), family=family))


def test_numbers_of_a_catalogue_are_read_with_all_of_their_digits(tmp_path: Path) -> None:
    stored, number = catalogue_cases.STORED["catalogue"], "0.1234567890123456789012345"
    row = [number, "0.0", *stored["data"][0][2:]]
    text = json.dumps({**stored, "count": "1", "data": [row]})
    for written in (text, text.replace(f'"{number}"', number)):
        (tmp_path / "catalogue.json").write_text(written)
        assert read_catalogue_rows(tmp_path / "catalogue.json").rows[0][0] == Fraction(number)
    (tmp_path / "catalogue.json").write_text(text.replace(f'"{number}"', "1e999"))
    with pytest.raises(InputError, match="is too large"):
        read_catalogue_rows(tmp_path / "catalogue.json")


def test_curves_of_other_systems_and_masses_certify_nothing() -> None:
    other = replace(rows(), mass_ratio=rows().mass_ratio + Fraction(1, 10**18))
    with pytest.raises(InputError, match="another mass parameter"):
        certified_rows(catalogue_cases.curve(), other)
    falkner = atlas_from_json(json.loads((DATA / "atlas-falkner-skan.json").read_text()), "atlas")
    results = json.loads((DATA / "stability-falkner-skan.json").read_text())
    with pytest.raises(InputError, match="is of no curve in cr3bp"):
        certified_rows(catalogue_cases.certificate_of(falkner, results), rows())


def test_a_curve_that_is_said_not_to_be_proved_certifies_nothing() -> None:
    curve = catalogue_cases.curve()
    with pytest.raises(InputError, match="proves no curve"):
        orbits_of(replace(curve, document={**curve.document, "verdict": "not proved"}))


def test_an_orbit_beside_that_which_was_found_is_stated_as_well() -> None:
    (first, *_) = Certificate(document()).rows
    assert first.piece is not None
    assert first.s is not None
    place = OrbitPlace(first.piece, first.s + Fraction(1, 2**30))
    row = catalogue._row(halo(), first, place, Fraction(1, 10**6))
    assert row.s == place.s
    assert row.differences is not None
    assert row.differences.point.upper() > arb("1e-12")
    entry = catalogue._document(catalogue_cases.curve(), "other", Fraction(1, 10**6), (row,))
    assert check(entry).stands
    assert not check(forged(entry, lambda entry: entry["statement"].update(within="1e-12"))).stands


def test_rows_are_numbered_from_1_and_rest_on_the_curve_that_is_named(tmp_path: Path) -> None:
    def findings(change: Callable[[Document], Any]) -> set[str]:
        entry = Certificate(forged(document(), change))
        return {each.place for each in catalogue.form(entry, Given((catalogue_cases.curve(),)), Examination())}

    assert findings(lambda entry: None) == set()
    assert findings(lambda entry: entry["rows"].reverse()) == {"rows"}
    assert findings(lambda entry: [row.update(number=row["number"] + 1) for row in entry["rows"]]) == {"rows"}
    assert findings(lambda entry: entry["rests_on"].update(digest="sha256:" + 64 * "0")) == {"rests_on"}
    assert findings(lambda entry: entry["rests_on"].update(id="another")) == {"rests_on"}
    file = tmp_path / "rows.json"
    write_certificate(file, document())
    assert read_certificate(file, "catalogue-certificate") == Certificate(document())
    file.write_text(file.read_text().replace('"id": "', '"id": "my-'))
    with pytest.raises(InputError, match="field digest"):
        read_certificate(file, "catalogue-certificate")


def shifted(ball: dict[str, str]) -> None:
    """A ball, by half of its radius, or a little if it is exact."""
    middle, radius = parse_exact(ball["mid"]), parse_exact(ball["rad"])
    ball.update(ball_to_json(enclose(middle + (radius / 2 or Fraction(1, 2**80))) + symmetric(radius)))


def at(entry: Any, place: tuple[str, ...]) -> Any:
    for key in place:
        entry = entry[int(key)] if isinstance(entry, list) else entry[key]
    return entry


@pytest.mark.slow
def test_the_command_and_python_say_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    curve, catalogue, output = tmp_path / "curve.json", tmp_path / "halo.json", tmp_path / "rows.json"
    write_certificate(curve, catalogue_cases.curve().document)
    stored = catalogue_cases.STORED["catalogue"]
    catalogue.write_text(json.dumps(stored))
    assert main(["catalogue", str(catalogue), "--curve", str(curve), "-o", str(output), "--quiet"]) == 1
    said = capsys.readouterr().out
    assert "4 of 5 rows are certified by the curve halo-from-the-plane" in said
    assert "row 5: not certified: " in said
    assert main(["catalogue", "--recheck", str(output), "--curve", str(curve), "--quiet"]) == 0
    assert "2 conclusion" in capsys.readouterr().out
    assert read_catalogue_rows(catalogue).rows == rows().rows
    shorter = tmp_path / "shorter.json"
    shorter.write_text(json.dumps({**stored, "count": "4", "data": stored["data"][:4]}))
    assert main(["catalogue", str(shorter), "--curve", str(curve), "--quiet"]) == 0
    capsys.readouterr()
    (found,) = verify.certify(catalogue, rests_on=verify.read(curve), within=1e-6, quiet=True)
    assert found.rows[:1] == verify.read(output)[0].rows[:1] or str(found.rows) == str(verify.read(output)[0].rows)
    assert verify.recheck(found, rests_on=verify.read(curve), quiet=True)[0].stands


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--within", "0"], "give a positive number"),
        (["--integrate"], "give it together with --recheck"),
        (["--recheck", "-o", "x.json"], "leave it out"),
    ],
)
def test_wrong_options_are_told(capsys: pytest.CaptureFixture[str], words: list[str], said: str) -> None:
    assert done_here(["verify", "catalogue", "none.json", "--curve", "none.json", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error


def test_a_curve_that_does_not_stand_certifies_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    curve, catalogue = tmp_path / "curve.json", tmp_path / "halo.json"
    changed = forged(catalogue_cases.curve().document, lambda entry: entry["conclusion"].update(joints=[{}]))
    write_certificate(curve, changed)
    catalogue.write_text(json.dumps(catalogue_cases.STORED["catalogue"]))
    assert main(["catalogue", str(catalogue), "--curve", str(curve), "--quiet"]) == 2
    assert "does not stand" in capsys.readouterr().err


def test_the_orbit_is_a_value_that_prints_its_place() -> None:
    orbit = halo().at(OrbitPlace("p001", Fraction(1, 2)))
    assert isinstance(orbit, OrbitOnCurve)
    assert orbit.stability.verdict == "unstable"


def forms_of(number: float) -> list[Fraction]:
    """What files say where a table has a double."""
    return [Fraction(number), Fraction(repr(number)), Fraction(f"{number:.16e}")]


def is_sharp_bound(bound: float, offs: list[Any], size: float) -> bool:
    """Whether it is no less than all of these, and hardly more than the largest with what rounding makes."""
    most = max(off.upper() for off in offs)
    return bool(enclose(Fraction(bound)) >= most) and bound <= 1.02 * (float(most) + 1e-15 * size)


def test_a_table_says_of_each_row_what_is_proved_from_the_numbers_it_has() -> None:
    """Bounds hold of the numbers as doubles and as decimals; the last row is the first orbit itself, to 30 digits."""
    given = tuple(tuple(value + Fraction(7, 10**19) for value in row) for row in rows().rows)
    orbit = Certificate(document()).rows[0].orbit
    assert orbit is not None
    assert orbit.stability_index is not None
    numbers = [
        *(orbit.point.get(name, arb(0)) for name in FIELDS[:6]),
        orbit.level,
        orbit.period,
        orbit.stability_index,
    ]
    given += (tuple(Fraction(round(exact_value(ball.mid()) * 10**30), 10**30) for ball in numbers),)
    certificate = certified_rows(catalogue_cases.curve(), replace(rows(), rows=given))
    table = certified_table(replace(rows(), rows=given), certificate)
    certified = Certificate(certificate).rows
    assert {row.orbit is None for row in certified} == {True, False}
    for index, row in enumerate(certified):
        cells = {name: values[index] for name, values in table.more.items()}
        assert list(table.rows[index]) == [float(value) for value in given[index]]
        if row.orbit is None or row.differences is None:
            assert cells.pop("proved") == f"no: {row.lacks}"
            assert set(cells.values()) == {None}
            continue
        forms = [forms_of(number) for number in table.rows[index]]
        point = [row.orbit.point.get(name, arb(0)) for name in ("x", "y", "z", "vx", "vy", "vz")]
        far = [
            sum(((ball - enclose(entry[form])) ** 2 for ball, entry in zip(point, forms, strict=False)), arb(0))
            .upper()
            .sqrt()
            for form in range(3)
        ]
        assert is_sharp_bound(cells["state_within"], far, 10)
        for name, ball, entry in zip(
            ("jacobi_within", "period_within", "stability_within"),
            (row.orbit.level, row.orbit.period, row.orbit.stability_index),
            forms[6:],
            strict=True,
        ):
            assert ball is not None
            off = [abs(ball - enclose(value)) for value in entry]
            assert is_sharp_bound(cells[name], off, float(abs(entry[0]))), name
        said = str(cells["proved"]).removeprefix("a symmetric periodic orbit starts at most ").removesuffix(" away")
        assert Fraction(said) >= max(exact_value(off.upper()) for off in far)
        assert row.orbit.least is not None
        assert row.orbit.greatest is not None
        off = [
            abs(ball - enclose(value))
            for name, ball in (("least_distance", row.orbit.least), ("greatest_distance", row.orbit.greatest))
            for value in forms_of(cells[name])
        ]
        assert is_sharp_bound(cells["distances_within"], off, 1e-2)
        assert abs(float(row.orbit.least.mid()) - cells["least_distance"]) < 1e-9
        assert cells["hits"] == "unknown"


def test_bounds_in_a_table_are_rounded_up() -> None:
    numbers = [Fraction(0), Fraction(1, 3), Fraction(999_999, 10**12), Fraction(1, 10**300), Fraction(7)]
    # Less than 3/10, and greater than the double next to that.
    numbers.append(Fraction(3 * 2**150 // 10, 2**150))
    for number in [*numbers, *(Fraction(7 * k + 1, 10**k) for k in range(40))]:
        bound = rounded_up(enclose(number))
        assert Fraction(bound) >= number
        assert not number or Fraction(bound) <= number * Fraction(102, 100)
        assert Fraction(f"{bound:.2e}") >= number
        assert Fraction(repr(bound)) >= number


def test_rows_that_hit_the_body_are_told_only_where_that_is_certain() -> None:
    given = rows()
    least = next(row.orbit.least for row in Certificate(document()).rows if row.orbit is not None)
    assert least is not None

    def said(unit: str, radius: str) -> str:
        details = {"lunit": unit, "radius_secondary": radius}
        return str(certified_table(replace(given, system_details=details), document()).more["hits"][0])

    assert [said("1", radius) for radius in ("0", str(exact_value(least.mid())), "10")] == ["no", "unknown", "yes"]
    assert [said("1e3", radius) for radius in ("130.8", "130.9")] == ["no", "yes"]
    assert {said(*wrong) for wrong in (("0", "1"), ("-1", "1"), ("1", "-1"))} == {"unknown"}
    assert certified_table(replace(given, system_details={"lunit": "1"}), document()).more["hits"][0] == "unknown"


def test_a_table_is_made_of_the_rows_that_its_certificate_is_about() -> None:
    huge = replace(rows(), rows=(*rows().rows[:-1], (Fraction(10) ** 400, *rows().rows[-1][1:])))
    for wrong in (replace(rows(), mass_ratio=Fraction(1, 3)), replace(rows(), rows=rows().rows[1:]), huge):
        with pytest.raises(InputError):
            certified_table(wrong, document())
    old = {"proved": ("yes",) * len(rows().rows), "note": ("a",) * len(rows().rows)}
    table = certified_table(replace(rows(), more=old), document())
    assert table.more["note"] == old["note"]
    assert "yes" not in table.more["proved"]


def test_orbits_of_the_curve_itself_are_a_catalogue_that_it_certifies() -> None:
    curve = catalogue_cases.curve()
    found = rows_of_curve(curve, 5)
    made = certified_rows(curve, found, Fraction(1, 10**12))
    assert made["verdict"] == "proved"
    assert len(made["rows"]) == 5
    certified = Certificate(made).rows
    assert all(float(row.differences.period.upper()) < 1e-12 for row in certified if row.differences is not None)
    assert all(float(row.differences.level.upper()) < 1e-12 for row in certified if row.differences is not None)
    stretches = orbits_of(curve).curve.chain.stretches
    begun = {}
    total = Fraction(0)
    for stretch in stretches:
        begun[stretch.tube.piece.id] = total - stretch.entered
        total += stretch.leaves - stretch.entered
    places = [begun[row.piece] + row.s for row in certified if row.piece is not None and row.s is not None]
    assert all(abs(float(place / total) - i / 4) < 1e-6 for i, place in enumerate(places))
    assert rows_of_curve(curve, 1).rows[0] == found.rows[0]


def test_rows_of_a_curve_of_several_pieces_are_at_equal_steps_along_all_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    orbits = arc(PIECES)
    stretches = orbits.curve.chain.stretches
    assert len(stretches) > 2
    monkeypatch.setattr(catalogue_table, "orbits_of", lambda _: orbits)
    found = rows_of_curve(catalogue_cases.curve(), 9).rows
    assert len(found) == 9
    length = sum(stretch.leaves - stretch.entered for stretch in stretches)
    for i, row in enumerate(found):
        left = length * i / 8
        for stretch in stretches:
            part = stretch.leaves - stretch.entered
            if left <= part:
                wanted = orbits.at(OrbitPlace(stretch.tube.piece.id, stretch.entered + left))
                break
            left -= part
        assert abs(wanted.period - enclose(row[7])) < 1e-12
        assert orbits.distance(wanted, dict(zip(FIELDS[:6], row, strict=False))) < 1e-12


def test_a_certified_row_is_an_orbit_that_tools_take(tmp_path: Path) -> None:
    path = tmp_path / "rows.json"
    write_certificate(path, document())
    row = rows().rows[0]
    found = find_orbit(path, Choice(number=1))
    assert found.unknowns == pytest.approx([float(row[0]), float(row[2]), float(row[4]), float(row[7]) / 2], abs=1e-6)
    assert 'says "not proved" of the rows' in found.verdict
    with pytest.raises(NoOrbit, match="shows no orbit near it"):
        find_orbit(path, Choice(number=len(catalogue_cases.ROWS)))
