"""Stability for ever along a curve at its joints, on loops, on parts of pieces, and where it is not known."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import comb
from types import SimpleNamespace
from typing import Any, cast

import pytest
from flint import arb, ctx
from support.conclusions import conclude
from support.return_maps import Number
from support.stability_cases import atlas
from support.stored import values
from support.within import within
from test_lasting import elliptic, form, made_up, near, of_beta, results, said, stored, through

import orbitproof.verify.lasting.half_map as half_map
import orbitproof.verify.lasting.stored as storing
from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.systems import FALKNER_SKAN, FixedLevel
from orbitproof.verify.algebra import Grading, WideArithmetic
from orbitproof.verify.evidence import IntegrationFailure, enclose
from orbitproof.verify.lasting import FunctionJet, LastingList, exchanged, is_known_of, lasting_list, normal_form
from orbitproof.verify.lasting.fates import Fate, _fate
from orbitproof.verify.stability import PRECISION, Kind
from orbitproof.verify.stability.complete_list import complete_list

Results = list[dict[str, Any]]
CONSTANT = 0.25
"""A stability parameter that is no resonance up to 4."""

_precision = within(lambda: ctx.workprec(PRECISION))


def lasting(found: Results, kind: str = "arc", joint: Fraction = Fraction(0)) -> LastingList:
    """The list for a curve of this kind; of the joint of its two pieces so little is known."""
    outcome: Any = conclude(atlas(), found).outcome
    known: Any = values(found)
    chain = outcome.results.chain
    first, second = chain.stretches
    chain = replace(chain, stretches=(first, replace(second, entered=second.entered + joint)))
    curve = replace(atlas(), claim=replace(atlas().claim, kind=kind, increasing=(), covers=None))
    return lasting_list(curve, chain, complete_list(atlas(), chain, known, 4), known)


def kinds(found: LastingList) -> list[Kind]:
    return [entry.point.kind for entry in found.exceptions]


# Joints


def at_joint(joint: Fraction) -> Fraction:
    """tau in the middle of what is known of the joint, on the second piece."""
    outcome: Any = conclude(atlas(), results()).outcome
    middle = (outcome.results.chain.stretches[1].enters + joint / 2) * Fraction(32, 33)
    return Fraction(round(middle * 2**60), 2**60)


def joined(first: dict[str, Any], second: dict[str, Any]) -> Results:
    """Functions without zeros on the first piece, with the signs that these have beyond the joint."""
    found = made_up(([], []))
    found[1]["twist"] |= {"twist": first, "exchanged": second}
    return found


def test_a_zero_where_pieces_are_joined_is_not_listed_and_not_passed_over() -> None:
    joint = Fraction(1, 64)
    vanishing, double = ([at_joint(joint)] * power for power in (1, 2))
    for first, second in ((vanishing, vanishing), (double, vanishing)):
        rows = [stored(through(cast(Any, row)), 1e-12) for row in (first, second)]
        found = lasting(joined(*rows), joint=joint)
        assert Kind.TWISTLESS not in kinds(found)
        gap = found.gaps[0]
        assert gap.stretch == 1
        assert gap.start < at_joint(joint) * Fraction(33, 32) < gap.end
        assert gap.end - gap.start >= joint
        assert found.undecided
    # One of both functions is enough.
    without = lasting(joined(stored(through(cast(Any, vanishing)), 1e-12), stored([Fraction(1)])), joint=joint)
    assert without.gaps == without.undecided == ()


# Loops


def elliptic_throughout(points: list[float]) -> Results:
    """The curve with one stability parameter, and these twistless orbits on its second piece."""
    found = made_up(([], points))
    for result in found:
        result["stability"]["characteristic"] = [stored([Fraction(CONSTANT)])]
    return found


def test_on_a_loop_the_orbits_at_its_cut_are_stable_with_those_on_both_sides() -> None:
    found = elliptic_throughout([of_beta(1, 555.0), of_beta(1, 640.0)])
    signs = {"arc": [1, -1, 1], "loop": [1, -1]}
    for kind, wanted in signs.items():
        known = lasting(found, kind)
        assert kinds(known) == [Kind.TWISTLESS] * 2
        assert [entry.sign for entry in known.stable] == wanted
        assert known.undecided == known.gaps == ()
    around = lasting(found, "loop").stable[0].between
    places = [None if bound.point is None else round(float(bound.point.level)) for bound in (around.begin, around.end)]
    assert places == [640, 555]


def test_twistless_orbits_are_found_between_all_of_the_places_where_stability_changes() -> None:
    """On the second piece c = 1 - 3/2 (tau^2 - 1/9): unstable for abs(tau) < 1/3, on either side of which one lies."""
    places = [-0.75, 0.75]
    found = made_up(([], places))
    for result, row in zip(found, (["1/4"], ["7/6", "0", "-3/2"]), strict=True):
        rows = [Fraction(round(Fraction(text) * 2**60), 2**60) for text in row]
        result["stability"]["characteristic"] = [stored(rows)]
    known = lasting(found)
    listed = [entry.point for entry in known.exceptions if entry.point.kind is Kind.TWISTLESS]
    assert [float(point.s) * 32 / 33 for point in listed] == pytest.approx(places, abs=1e-6)
    assert [entry.sign for entry in known.stable][:2] == [1, 1]
    assert {entry.sign for entry in known.stable} == {1, -1}
    assert known.undecided == known.gaps == ()


# Parts of pieces


def on_part(function: dict[str, Any], middle: Fraction, share: Fraction) -> dict[str, Any]:
    """The function of tau on a part of the piece, where tau is middle * 32/33 + share * (tau of the part)."""
    coefficients = [parse_exact(text) for text in function["coefficients"]]
    start = middle * Fraction(32, 33)
    moved = [
        share**j * sum((comb(n, j) * start ** (n - j) * c for n, c in enumerate(coefficients) if n >= j), Fraction(0))
        for j in range(len(coefficients))
    ]
    scale = 2**200
    rounded = [Fraction(round(value * scale), scale) for value in moved]
    return {**function, "coefficients": [format_exact(value) for value in rounded]}


def halved(found: Results, rows: Sequence[dict[str, Any]] = ({}, {})) -> Results:
    """The second piece in two parts, with other functions of the twist on each of them."""
    first, second = found
    parts = []
    for low, row in zip((Fraction(-1), Fraction(0)), rows, strict=True):
        middle, share = low + Fraction(1, 2), Fraction(1, 2)

        def of(entry: Any, middle: Fraction = middle, share: Fraction = share) -> Any:
            if isinstance(entry, dict) and "coefficients" in entry:
                return on_part(entry, middle, share)
            if isinstance(entry, dict):
                return {key: of(value) for key, value in entry.items()}
            return [of(value) for value in entry] if isinstance(entry, list) else entry

        known = {name: of(second[name]) for name in ("stability", "twist")}
        known["twist"] |= row
        parts.append({**second, **known, "interval": [format_exact(low), format_exact(low + 1)]})
    return [first, *parts]


def test_in_parts_the_list_is_the_same() -> None:
    whole = said(results())
    parts = said(halved(results()))
    for name in ("exceptions", "stable"):
        assert len(parts[name]) == len(whole[name])
    assert [(entry["k"], entry["fate"], near(entry)) for entry in parts["exceptions"]] == [
        (entry["k"], entry["fate"], near(entry)) for entry in whole["exceptions"]
    ]
    assert [entry["twist"] for entry in parts["stable"]] == [entry["twist"] for entry in whole["stable"]]
    assert parts["gaps"] == parts["undecided"] == []


def test_resonances_are_judged_by_the_functions_of_their_own_part() -> None:
    """1:3 lies on the first part, 1:4 on the second."""
    above, below, nothing = (stored([Fraction(number)]) for number in (1, -1, 0))
    for fourth, fate in (((below, above), "unstable"), ((above, below), "stable")):
        found = said(halved(made_up(([], [])), [{"fourth": function} for function in fourth]))
        assert [entry["fate"] for entry in found["exceptions"] if entry["k"] == 4] == [fate]
    nowhere = {"twist": nothing, "exchanged": nothing}
    for rows, fate in ((({}, nowhere), "unstable"), ((nowhere, {}), "open")):
        found = said(halved(made_up(([], [])), rows))
        assert [entry["fate"] for entry in found["exceptions"] if entry["k"] == 3] == [fate]


def test_a_resonance_is_judged_at_all_points_of_its_place_on_one_part() -> None:
    def fate(found: Results, place: arb | None = None) -> Fate:
        outcome: Any = conclude(atlas(), found).outcome
        known, chain = values(found), outcome.results.chain
        listed = complete_list(atlas(), chain, cast(Any, known), 4)
        (point,) = [point for point in listed.points if point.k == 4]
        return _fate(chain, listed, cast(Any, known), point if place is None else replace(point, s=place))

    s = Fraction(round(of_beta(1, 679.954155) * 33 / 32 * 2**60), 2**60)
    changing = made_up(([], []))
    # Negative in the middle of the place, positive at its end.
    zero = Fraction(round((s * 32 / 33 + Fraction(1, 2**20)) * 2**60), 2**60)
    changing[1]["twist"]["fourth"] = stored([-zero, Fraction(1)])
    assert fate(changing) is Fate.STABLE
    assert fate(changing, arb(enclose(s).mid(), 2.0**-18)) is Fate.OPEN
    # Across the joint of two parts.
    parts = halved(made_up(([], []), fourth=-1))
    assert fate(parts) is Fate.STABLE
    assert fate(parts, arb(0, 2.0**-4)) is Fate.OPEN
    unknown = made_up(([], []), fourth=-1)
    unknown[1]["twist"] = {"reason": {"condition": "twist", "message": "no", "remedy": ""}}
    assert fate(unknown) is Fate.OPEN


def test_of_two_results_of_one_interval_that_with_more_bits_is_taken() -> None:
    true = made_up(([], []))
    worse = {**made_up(([], []), (-1, -1), error=2.0, fourth=-1)[1]}
    worse["computation"] = {**worse["computation"], "precision": worse["computation"]["precision"] - 1}
    for entries in ([true[0], worse, true[1]], [true[0], true[1], worse]):
        assert {**said(entries), "reversibility": {}} == {**said(true), "reversibility": {}}


# What is not known


def test_functions_of_an_interval_that_is_not_proved_say_nothing() -> None:
    true = made_up(([], []))
    other = made_up(([], []), (-1, -1), fourth=-1)[1]
    reason = {"condition": "newton", "message": "no", "remedy": ""}
    known = said([true[0], {**other, "verdict": "not proved", "reason": reason}, true[1]])
    assert known == said(true)


def test_nothing_is_said_where_a_level_is_held() -> None:
    free = SimpleNamespace(kernel_coordinates=(1,), normalised={}, fixed_level=None)
    assert is_known_of(cast(Any, free))
    held = SimpleNamespace(**{**vars(free), "fixed_level": FixedLevel(Fraction(1), 1)})
    assert not is_known_of(cast(Any, held))


# How the functions are made


def test_half_orbits_end_at_the_crossing_of_the_claim(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []

    def half_orbit(crossings: int, _: Any) -> Any:
        seen.append(crossings)
        raise IntegrationFailure("test", "no further", "")

    monkeypatch.setattr(half_map, "HalfOrbits", lambda *_: SimpleNamespace(half_orbit=half_orbit))
    monkeypatch.setattr(half_map, "parameter_series", lambda *_: {})
    monkeypatch.setattr(half_map, "_around", lambda *_: {})
    one_element = SimpleNamespace(arithmetic=None)
    monkeypatch.setattr(half_map, "_elements", lambda *_: defaultdict(lambda: one_element))
    tube = SimpleNamespace(system=FALKNER_SKAN, parameters={}, oracle=None, crossings=3)
    half = SimpleNamespace(widths=[Fraction(1, 1024)], steps=0)
    with pytest.raises(IntegrationFailure, match="no further"):
        half_map.return_map(cast(Any, tube), cast(Any, half), cast(Any, None), None)
    assert seen == [3]


@pytest.mark.parametrize("seed", range(4))
def test_stored_are_theta_its_other_form_and_delta(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a map that is the same along the curve."""
    own = WideArithmetic(Grading((1,), 0), 200, 0, 0, width=4)
    found = elliptic(seed)
    jets = [
        FunctionJet({index: own.constant(Fraction(float(value))) for index, value in jet.coefficients.items()})
        for jet in found
    ]
    monkeypatch.setattr(storing, "return_map", lambda *_: jets)
    # These numbers are rounded, and what reversibility makes zero with them.
    monkeypatch.setattr(storing, "require_zero", lambda *_: None)
    tube = SimpleNamespace(
        curve=lambda half: None, arithmetic=own, system=FALKNER_SKAN, piece=atlas().curve_pieces()[0]
    )
    known = storing._twist(cast(Any, tube), cast(Any, None), None)
    s, one = found[0].coefficients[1, 0], Number(1)
    other = normal_form(exchanged(found[1]), exchanged(found[0]), s, one)
    wanted = (form(found).twist, other.twist, form(found).fourth)
    for name, value in zip(("twist", "exchanged", "fourth"), wanted, strict=True):
        function = getattr(known, name)
        assert float(function.coefficients[0]) == pytest.approx(float(value), rel=1e-9)
        assert function.error < 1e-20
