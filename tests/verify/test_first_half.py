"""The stability parameter from the first half of planar orbits contains closed forms, and what both halves give."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from support.closed_form_lists import ellipse, in_plane, line, minors
from support.within import within

from orbitproof.shared.claims import Atlas, Piece
from orbitproof.shared.formats import read_atlas
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_PLANAR, FALKNER_SKAN
from orbitproof.verify.algebra import Grading, WideArithmetic
from orbitproof.verify.curve import HalfReturn, PieceLimits
from orbitproof.verify.evidence import IntegrationFailure, guarded
from orbitproof.verify.functions import REACH, BoundedFunction, bounded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.out_of_plane import VariationFunctions
from orbitproof.verify.poincare import HalfOrbits
from orbitproof.verify.stability import TubeOfOrbits, orbit_functions
from orbitproof.verify.stability import first_half as room
from orbitproof.verify.stability.first_half import _needed, _on_curve, from_first_half, is_enough, preserves_volume

DATA = Path(__file__).parents[1] / "data"

_precision = within(lambda: ctx.workprec(160))


def tube_of(atlas: Atlas, piece: Piece, interval: tuple[Fraction, Fraction], limits: PieceLimits) -> TubeOfOrbits:
    return TubeOfOrbits(atlas.system, atlas.parameters, piece, interval, limits, "physical", ORACLE)


@cache
def planar() -> TubeOfOrbits:
    """A short part of the planar orbits of L1, Earth-Moon, in units of their size."""
    atlas = read_atlas(DATA / "atlas-lyapunov.json")
    assert isinstance(atlas, Atlas)
    (piece,) = atlas.curve_pieces()
    return tube_of(atlas, piece, (Fraction(1, 2), Fraction(9, 16)), PieceLimits(56, 18, 6))


@cache
def half() -> HalfReturn:
    with guarded(120):
        return planar().wider(None)


def functions(tube: TubeOfOrbits) -> list[BoundedFunction]:
    found = orbit_functions(tube)
    assert isinstance(found.out_of_plane, VariationFunctions)
    assert found.distance is None
    known = [*found.characteristic, found.level, found.half_period, found.first_factor]
    return [*map(bounded, known), *found.out_of_plane.known.entries]


@cache
def with_second_half() -> list[BoundedFunction]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("orbitproof.verify.stability.matrix.is_enough", lambda _: False)
        return functions(planar())


def test_functions_are_those_that_the_second_half_gives() -> None:
    """In units of the orbit: another x at the other point, and a level there."""
    assert is_enough(planar())
    names = "a_1", "level", "half period", "first factor", "11", "12", "21", "22"
    for name, one, other in zip(names, functions(planar()), with_second_half(), strict=True):
        distance = sum((abs(c) for c in (one.polynomial - other.polynomial).coeffs()), arb(0))
        assert distance < one.error + other.error, name
        assert distance < 1e-7 * one.size, name
        assert one.error < 40 * other.error + 1e-12, name


@pytest.mark.slow
@pytest.mark.parametrize("make", [lambda: line(1, 1, True), lambda: ellipse(1, 1, "folds")], ids=["line", "fold"])
def test_functions_contain_closed_forms(make: Any) -> None:
    """Of a system with a first integral, in coordinates of the state."""
    system = in_plane(3, make())
    atlas = system.atlas(24 if system.ellipse is None else 40)
    piece = atlas.curve_pieces()[5]
    tube = tube_of(atlas, piece, (Fraction(-1, 4), Fraction(1, 4)), PieceLimits(56, 16, 8))
    assert is_enough(tube)
    found = functions(tube)
    for number in range(-4, 5):
        place = system.places(piece, np.array([float(REACH) * number / 4 / 4]))
        expected: Sequence[float] = [float(minors(system.sigma(place))[0][0]), *system.variations(place)[:, 0]]
        for one, value in zip([found[0], *found[4:]], expected, strict=True):
            enclosure = one.value(arb(number) / 4)
            assert (enclosure + arb(0, 1e-8 * max(1.0, abs(value)))).contains(arb(value))
            assert float(enclosure.rad()) < 1e-3 * max(1.0, abs(value))


@pytest.mark.slow
def test_where_it_fails_the_second_half_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> Any:
        raise IntegrationFailure("stability", "it was not enclosed", "give more precision")

    expected = with_second_half()
    monkeypatch.setattr("orbitproof.verify.stability.matrix.from_first_half", fails)
    assert [one.error for one in functions(planar())] == [one.error for one in expected]


def test_a_flow_preserves_volume_where_no_rate_depends_on_its_coordinate() -> None:
    assert all(map(preserves_volume, [*AROUND.values(), CR3BP, CR3BP_PLANAR]))
    assert not preserves_volume(FALKNER_SKAN)
    tube = planar()

    def damped(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        *rates, last = tube.system.vector_field(state, parameters)
        return (*rates, last + state[1] * state[3])

    assert not is_enough(replace(tube, system=replace(tube.system, vector_field=damped)))


def test_the_second_half_is_followed_for_distances_and_in_other_coordinates() -> None:
    tube = planar()
    distant = replace(tube.system, squared_distance=lambda state, _: (state[0] * state[0],))
    assert not is_enough(replace(tube, system=distant))
    assert not is_enough(replace(tube, coordinates="regularised"))
    assert not is_enough(replace(tube, system=replace(tube.system, stiffness_across=None)))


def test_the_second_half_is_followed_where_the_section_has_other_coordinates_or_n_is_2() -> None:
    tube = planar()
    given = {name: getattr(tube.system, name) for name in ("program", "state", "stiffness_across")}
    plain = {**given, **dict.fromkeys(("defined", "arrival", "fixed_level", "squared_distance"))}
    assert is_enough(replace(tube, system=SimpleNamespace(**plain)))  # type: ignore[arg-type]
    for name in ("defined", "arrival", "fixed_level", "squared_distance"):
        assert not is_enough(replace(tube, system=SimpleNamespace(**plain | {name: "another"})))  # type: ignore[arg-type]
    assert not is_enough(replace(tube, piece=replace(tube.piece, tube=2 * tube.piece.tube)))


def test_half_orbits_are_followed_to_the_crossing_of_the_claim(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def recorded(_: HalfOrbits, crossings: int, progress: Any = None) -> Any:
        asked.append(crossings)
        raise IntegrationFailure("stability", "it is not followed here", "wait")

    half()
    with guarded(120):
        monkeypatch.setattr(HalfOrbits, "half_orbit", recorded)
        for crossings in (1, 2):
            with pytest.raises(IntegrationFailure, match="not followed here"):
                from_first_half(replace(planar(), crossings=crossings), half())
    assert asked == [1, 2]


def test_variations_stand_by_rows_and_the_parameter_is_found_from_the_derivative_of_q_by_q(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given, tube = [], planar()
    with guarded(120):
        rows = [
            [tube.arithmetic.constant(Fraction(3 * i + j)) for j in range(3)] for i in range(len(tube.system.state) + 2)
        ]
        monkeypatch.setattr(room, "_derivatives", lambda *_: rows)
        monkeypatch.setattr(room, "_parameter", lambda *arguments: given.append(arguments[-1]) or arguments[-2])
        found = from_first_half(tube, half()).out_of_plane
        assert isinstance(found, VariationFunctions)
        values = [entry.value(arb(0)) for entry in found.known.entries]
    (q,) = tube.system.kernel_coordinates
    assert given == [rows[q][0]]
    last = 3 * len(tube.system.state)
    for value, wanted in zip(values, (last + 1, last + 2, last + 4, last + 5), strict=True):
        assert value.contains(wanted)


def test_the_points_have_the_error_with_which_the_curve_is_known() -> None:
    here, there = (
        WideArithmetic(Grading((1,) * count, top), 64, 8 * top, 4, width=4) for count, top in ((1, 0), (2, 1))
    )
    found = _on_curve(there, here.polynomial({(0,): [Fraction(1), Fraction(3)]}).widened(Fraction(1, 2**20)))
    assert list(found.coefs[0].coeffs()) == [2**64, 3 * 2**64]
    assert not any(each.length() for each in found.coefs[1:])
    assert 2.0**-20 <= found.errors[0] < 2.0**-19
    assert found.errors[1:] == [0.0, 0.0]


def test_as_many_bits_are_followed_as_the_points_are_known_to() -> None:
    assert _needed(Fraction(0), 72, 28) == (72, 28)
    assert _needed(Fraction(1, 2**60), 72, 28) == (72, 28)
    assert _needed(Fraction(1, 2**40), 72, 28) == (64, 25)
    assert _needed(Fraction(1), 72, 28) == (60, 24)
