"""Curves of equilibria: closed forms, folds, counts, and claims that are false (section 37)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction as Q
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from flint import arb, arb_mat, ctx
from support import equilibrium_cases as cases
from support.balls import agree

from orbitproof.shared.claims import Covers, EquilibriumAtlas, EquilibriumCurveClaim, Piece
from orbitproof.shared.formats import define_system
from orbitproof.shared.systems import System
from orbitproof.verify.curve import IntervalResult
from orbitproof.verify.equilibrium.expansions import expand
from orbitproof.verify.equilibrium_curve import (
    EquilibriumCurveTheorem,
    EquilibriumLimits,
    ProvedEquilibriumCurve,
    conclude_equilibria,
    folds,
    prove_equilibrium_piece,
)
from orbitproof.verify.equilibrium_curve.counted import Sides, sides_of
from orbitproof.verify.evidence import NotProved, Proved, enclose
from orbitproof.verify.words.equilibrium_curve import equilibrium_curve_in_words

FAST = EquilibriumLimits(precision=80, order=24, width=24)


def results_of(atlas: EquilibriumAtlas, parts: int = 1) -> list[IntervalResult]:
    ends = [Q(2 * number, parts) - 1 for number in range(parts + 1)]
    return [
        prove_equilibrium_piece(atlas, piece, (start, end), FAST).stored
        for piece in atlas.curve_pieces()
        for start, end in pairwise(ends)
    ]


def proved(atlas: EquilibriumAtlas, parts: int = 1) -> ProvedEquilibriumCurve:
    outcome = conclude_equilibria(atlas, results_of(atlas, parts)).outcome
    assert isinstance(outcome, Proved), outcome
    found: ProvedEquilibriumCurve = outcome.results
    return found


def reason(atlas: EquilibriumAtlas, results: Sequence[IntervalResult] | None = None) -> str:
    outcome = conclude_equilibria(atlas, results_of(atlas) if results is None else results).outcome
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition


def line(system: System, reach: Q, a_of_x: Sequence[Q], middle: tuple[Q, ...], **more: Any) -> EquilibriumAtlas:
    """One piece over the first coordinate of the state, the others 0; a is a polynomial of s."""
    size = len(system.given_state)
    columns = [1, 0, *range(2, size + 1)]
    frame = tuple(tuple(Q(int(columns[j] == i)) for j in range(size + 1)) for i in range(size + 1))
    polynomial = (tuple(a_of_x), *[(Q(0),)] * (size - 1))
    piece = Piece("p", "regular", middle, frame, reach, polynomial, (Q(1, 2**12),) * size, "physical")
    claim = EquilibriumCurveClaim("equilibrium-arc", "a", (system.given_state[0],))
    given: dict[str, Any] = {"parameters": {}, "claim": claim, "pieces": (piece,), **more}
    return EquilibriumAtlas("line", "a line", system, **given)


def test_a_curve_goes_through_a_fold_which_is_regular() -> None:
    for parts in (1, 3):
        found = proved(cases.curve_of_equilibria(), parts)
        assert found.ends["start"]["a"].contains(Q(1, 4).numerator / 4)
        assert found.ends["end"]["x"].contains(0.5)
        (fold,) = found.folds
        assert (fold.is_maximum, fold.is_regular, fold.pieces) == (False, True, ("p1", "p1"))
        assert fold.all_values is not None
        assert fold.all_values.contains(0)
        # x = (3 s - 2)/10 is 0 at 2/3.
        assert fold.between[0] < Q(2, 3) < fold.between[1]
        counts = [part.sides for part in found.sides]
        assert [(each.left, each.right) if each else None for each in counts] == [(1, 1), None, (2, 0)]
        assert found.sides[1].all_values.contains(0)
        assert found.sides[0].values[0].contains(0.25)
        # Neighbours meet, and what is said of all points of a part holds at both of its ends.
        for part, after in pairwise(found.sides):
            assert part.between[1] == after.between[0]
            assert part.values[1].overlaps(after.values[0])
            assert abs(part.values[1]) < 1e-6
        for part, values in zip(found.sides, ((Q(1, 4), Q(1, 10), Q(0)), (Q(0),), (Q(1, 100), Q(1, 4))), strict=True):
            assert all(part.all_values.overlaps(enclose(value)) for value in values)
        assert [part.pieces for part in found.sides] == [("p1", "p1"), ("p1", "p1"), ("p1", "p2")]
        assert (found.sides[0].between[0], found.sides[2].between[1]) == (-1, 1)


def test_tangents_are_known_up_to_the_bounds_of_the_slopes() -> None:
    stretch = proved(cases.curve_of_equilibria()).chain.stretches[0]
    frame, reach = stretch.tube.piece.frame, stretch.tube.piece.half_width
    found = folds._tangent(stretch, (Q(1, 4), Q(1, 2)), Q(-1, 8), Q(1, 8))
    for s in (Q(-1, 8), Q(1, 8)):
        for first, second in ((Q(1, 4), Q(-1, 2)), (Q(-1, 4), Q(1, 2))):
            # x = -1/5 + 3 s/10, a = x^2.
            along = (reach, 2 * Q(-1, 5) * reach + 2 * reach**2 * s + first, second)
            for ball, row in zip(found, frame, strict=True):
                assert ball.contains(enclose(sum((x * y for x, y in zip(row, along, strict=True)), Q(0))))


def test_the_slope_of_the_determinant_is_its_derivative_along_the_curve() -> None:
    """Against a quotient of differences, of a field in three coordinates that has all of them in all rates."""
    system = define_system(
        {"name": "f", "state": "x y z", "parameters": "b a",
         "field": {"x": "x*y*z + a*x**2 - b*y", "y": "x**2*z + y**3 - a*z", "z": "a*y*z + x*z**2 + exp(x)"}}
    )  # fmt: skip
    claim = EquilibriumCurveClaim("equilibrium-arc", "a")
    atlas = EquilibriumAtlas("f", "f", system, {"b": Q(3, 7)}, claim, cases.curve_of_equilibria().pieces)
    step = Q(1, 2**80)
    with ctx.workprec(500):

        def determinant(point: Sequence[arb]) -> arb:
            units = [[arb(int(i == j)) for i in range(3)] for j in range(3)]
            rates = expand(system, point[1:], [enclose(Q(3, 7)), point[0]], units, 1)
            return arb_mat([[f.slope(j) for j in range(3)] for f in rates]).det()

        point = [arb(n) / 8 for n in (3, 5, -7, 11)]
        for tangent in (
            [arb(n) for n in (2, -3, 5, 7)],
            [arb(n) for n in (1, 0, 0, 0)],
            [arb(n) for n in (0, 0, 1, 0)],
        ):
            before, after = (
                determinant([x + sign * enclose(step) * t for x, t in zip(point, tangent, strict=True)])
                for sign in (-1, 1)
            )
            found = folds._slope_of_determinant(atlas, point, tangent)
            assert abs(found - (after - before) / (2 * enclose(step))) < arb(2) ** -120
            assert found.rad() < arb(2) ** -120
            # Of balls it holds those of their points.
            for place in range(4):
                near = [x + arb(0, 0.125 * (n == place)) for n, x in enumerate(point)]
                wide = folds._slope_of_determinant(atlas, near, tangent)
                for sign in (-1, 0, 1):
                    moved = [x + sign * arb(0.1 * (n == place)) for n, x in enumerate(point)]
                    assert wide.contains(folds._slope_of_determinant(atlas, moved, tangent))


CUBIC = define_system(
    {"name": "cubic", "state": "x y", "parameters": "a", "field": {"x": "a - x**3 + x*y", "y": "-y + x*y"}}
)
HOOK = define_system({"name": "hook", "state": "x y", "parameters": "a", "field": {"x": "a - 3*x + x**3", "y": "-y"}})


def test_a_parameter_that_stands_still_has_no_fold() -> None:
    """a = x^3."""
    found = proved(line(CUBIC, Q(1, 2), (Q(0), Q(0), Q(0), Q(1, 8)), (Q(0), Q(0), Q(0))))
    assert found.folds == ()


def test_two_folds_on_one_piece() -> None:
    """a = 3 x - x^3 from -3/2 to 3/2: a minimum at -1 and a maximum at 1."""
    reach = Q(3, 2)
    found = proved(line(HOOK, reach, (Q(0), 3 * reach, Q(0), -(reach**3)), (Q(0), Q(0), Q(0))), 4)
    assert [(fold.is_maximum, fold.is_regular) for fold in found.folds] == [(False, True), (True, True)]
    for fold, value in zip(found.folds, (-2, 2), strict=True):
        assert fold.all_values is not None
        assert fold.all_values.contains(value)
    counts = [(each.sides.left, each.sides.right) for each in found.sides if each.sides is not None]
    assert counts == [(1, 1), (2, 0), (1, 1)]


FLAT = define_system({"name": "flat", "state": "x y", "parameters": "a", "field": {"x": "a - x**4", "y": "-y"}})


def test_an_extremum_that_is_flat_is_not_said_to_be_regular() -> None:
    """a = x^4."""
    found = proved(line(FLAT, Q(1, 2), (Q(0), Q(0), Q(0), Q(0), Q(1, 16)), (Q(0), Q(0), Q(0))))
    assert [(fold.is_maximum, fold.is_regular) for fold in found.folds] == [(False, False)]


def test_the_eigenvalues_cross_the_axis_at_a_hopf_point() -> None:
    """The origin of x' = a x - y + .., over a from -1/2 to 1/2, beside a stable direction."""
    system = define_system(
        {"name": "h", "state": "x y z", "parameters": "a",
         "field": {"x": "a*x - y - x**3", "y": "x + a*y", "z": "x*y - 2*z"}}
    )  # fmt: skip
    zero, one = Q(0), Q(1)
    frame = tuple(tuple(one if i == j else zero for j in range(4)) for i in range(4))
    piece = Piece("p", "regular", (zero,) * 4, frame, Q(1, 2), ((zero,),) * 3, (Q(1, 2**12),) * 3, "physical")
    claim = EquilibriumCurveClaim("equilibrium-arc", "a", ("a",), Covers("a", Q(-1, 4), Q(1, 4)))
    found = proved(EquilibriumAtlas("h", "h", system, {}, claim, (piece,)))
    counts = [(each.sides.left, each.sides.right) if each.sides else None for each in found.sides]
    assert counts == [(3, 0), None, (1, 2)]
    assert found.sides[1].all_values.contains(0)
    assert found.folds == ()


@pytest.mark.parametrize("size", [2, 3, 4, 5])
def test_sides_are_those_of_known_eigenvalues(size: int) -> None:
    """Of block triangular matrices in other coordinates; pairs, multiple ones too."""
    source = Random(size)
    for _ in range(30):
        values = [Q(source.choice((-1, 1)) * source.randrange(1, 6), 2) for _ in range(size)]
        matrix = [
            [values[i] if i == j else Q(source.randrange(-2, 3) * (i < j)) for j in range(size)] for i in range(size)
        ]
        if size > 2 and source.random() < 0.7:
            values[1] = matrix[1][1] = values[0]
            matrix[0][1], matrix[1][0] = Q(3), Q(-3)
        for _ in range(6):
            i, j = source.sample(range(size), 2)
            factor = source.randrange(-2, 3)
            matrix[i] = [a + factor * b for a, b in zip(matrix[i], matrix[j], strict=True)]
            for row in matrix:
                row[j] -= factor * row[i]
        found = sides_of([[enclose(entry) for entry in row] for row in matrix])
        # Routh's scheme has a 0 in its first column for some matrices.
        right = sum(value > 0 for value in values)
        assert found in (None, Sides(size - right, right))
        if right in (0,):
            assert found is not None


def test_sides_are_not_told_on_the_axis() -> None:
    for rows in ([[0, 1], [-1, 0]], [[0, 0], [0, 1]], [[0, 1, 0], [-1, 0, 0], [0, 0, -1]], [[0, 1], [1, 0]]):
        found = sides_of([[arb(entry) for entry in row] for row in rows])
        assert found is None or found == Sides(1, 1)
    assert sides_of([[arb(-1, 2), arb(0)], [arb(0), arb(-1)]]) is None


def test_false_claims_about_curves_are_not_proved() -> None:
    atlas = cases.curve_of_equilibria()
    first, last = atlas.curve_pieces()
    claim, honest = atlas.claim, results_of(atlas)
    assert reason(replace(atlas, claim=replace(claim, increasing=("a",)))) == "increasing-a"
    assert reason(replace(atlas, claim=replace(claim, covers=Covers("a", Q(-1, 100), Q(1, 100))))) == "covers"
    assert reason(replace(atlas, parameters={}), honest) == "pieces"
    assert reason(replace(atlas, parameters={"a": Q(0), "b": Q(2)}), honest) == "pieces"
    assert reason(replace(atlas, claim=replace(claim, parameter="b")), honest) == "pieces"
    assert reason(replace(atlas, pieces=(first, first)), honest) == "pieces"
    assert reason(replace(atlas, pieces=(first, replace(last, tube=last.tube[:1]))), honest) == "pieces"
    moved = replace(last, centre=(last.centre[0], last.centre[1] + Q(1, 8), last.centre[2]))
    assert reason(replace(atlas, pieces=(first, moved))) == "curve"
    assert reason(replace(atlas, claim=replace(claim, kind="equilibrium-loop"))) == "curve"
    assert reason(atlas, results_of(atlas)[:1]) == "curve"


@pytest.mark.parametrize("interval", [(Q(-2), Q(1)), (Q(0), Q(2)), (Q(1), Q(-1))])
def test_a_piece_is_proved_within_its_interval_only(interval: tuple[Q, Q]) -> None:
    atlas = cases.curve_of_equilibria()
    outcome = prove_equilibrium_piece(atlas, atlas.curve_pieces()[0], interval, FAST).outcome
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "piece"


def test_two_curves_that_cross_are_no_piece() -> None:
    """a x = x^2 at 0."""
    system = define_system({"name": "c", "state": "x y", "parameters": "a", "field": {"x": "a*x - x**2", "y": "-y"}})
    atlas = line(system, Q(1, 4), (Q(0), Q(1, 4)), (Q(0), Q(0), Q(0)))
    assert not any(result.is_proved for result in results_of(atlas))


BOWL = define_system({"name": "bowl", "state": "x y", "parameters": "a", "field": {"x": "a - x**2 - x**3", "y": "-y"}})


def cut_at(atlas: EquilibriumAtlas, place: Q) -> list[IntervalResult]:
    piece, ends = atlas.curve_pieces()[0], (Q(-1), place, Q(1))
    return [prove_equilibrium_piece(atlas, piece, part, FAST).stored for part in pairwise(ends)]


def test_a_fold_may_lie_on_two_proved_intervals() -> None:
    """Halving ends at the place of the fold, on [-1/8, 1/8]; the intervals meet at 1/16."""
    bowl = line(BOWL, Q(1, 2), (Q(0), Q(0), Q(1, 4), Q(1, 8)), (Q(0), Q(0), Q(0)))
    flat = line(FLAT, Q(1, 2), (Q(0), Q(0), Q(0), Q(0), Q(1, 16)), (Q(0), Q(0), Q(0)))
    for atlas, is_regular in ((bowl, True), (flat, False)):
        outcome = conclude_equilibria(atlas, cut_at(atlas, Q(1, 16))).outcome
        assert isinstance(outcome, Proved)
        (fold,) = outcome.results.folds
        assert fold.between == (Q(-1, 8), Q(1, 8))
        assert (fold.is_maximum, fold.is_regular) == (False, is_regular)
        assert fold.all_values is not None
        assert all(fold.all_values.contains(value) for value in fold.values)
        row = atlas.curve_pieces()[0].polynomial[0]
        for value, s in zip(fold.values, fold.between, strict=True):
            assert value.overlaps(enclose(sum((c * s**n for n, c in enumerate(row)), Q(0))))


def test_directions_that_are_not_certain_are_no_folds() -> None:
    """Slopes that are known up to 1 only; what increases is a multiple of s."""
    atlas = cases.curve_of_equilibria()
    vague = [replace(result, slope_deviation=(Q(1), Q(1))) for result in results_of(atlas)]
    outcome = conclude_equilibria(atlas, vague).outcome
    assert isinstance(outcome, Proved)
    assert outcome.results.folds == ()


def test_a_piece_is_proved_up_to_its_ends() -> None:
    """x = 0 over a; at a = 0, s = 31/32 on the first, x = a crosses it."""
    system = define_system({"name": "c", "state": "x y", "parameters": "a", "field": {"x": "a*x - x**2", "y": "-y"}})
    frame = tuple(tuple(Q(int(i == j)) for j in range(3)) for i in range(3))
    for middle, is_proved in ((Q(-31, 64), False), (Q(31, 64), False), (Q(-36, 64), True)):
        centre = (middle, Q(0), Q(0))
        piece = Piece("p", "regular", centre, frame, Q(1, 2), ((Q(0),),) * 2, (Q(1, 2**12),) * 2, "physical")
        claim = EquilibriumCurveClaim("equilibrium-arc", "a")
        (result,) = results_of(EquilibriumAtlas("c", "c", system, {}, claim, (piece,)))
        assert result.is_proved is is_proved


def test_all_coordinates_that_are_said_to_increase_do() -> None:
    atlas = cases.curve_of_equilibria()
    honest = results_of(atlas)
    for names in (("x", "a"), ("a", "x")):
        assert reason(replace(atlas, claim=replace(atlas.claim, increasing=names)), honest) == "increasing-a"


def test_only_a_curve_on_which_a_coordinate_increases_is_said_not_to_meet_itself() -> None:
    atlas = cases.curve_of_equilibria()
    found = proved(atlas)
    for names in ((), ("x",), ("x", "y")):
        theorem = EquilibriumCurveTheorem(replace(atlas, claim=replace(atlas.claim, increasing=names)))
        said = equilibrium_curve_in_words(theorem, found)
        assert ("without self-intersections" in said) is bool(names)
        assert ("strictly" in said) is bool(names)
        assert ("what is listed apart below may be the same" in said) is not bool(names)
        assert "has exactly one minimum for a in" in said
        assert "1 has a negative and 1 a positive real part: unstable equilibria" in said
        assert "2 have a negative and 0 a positive real part: stable equilibria" in said
        assert "as the numbers on both sides differ, an equilibrium there has one on the axis" in said


@pytest.mark.parametrize("turns", [1, 2])
def test_a_loop_is_closed_and_has_its_folds(turns: int) -> None:
    """a^2 + x^2 = 1: what pieces that go round twice list twice is not said to differ."""
    atlas = cases.circle_of_equilibria(turns)
    outcome = conclude_equilibria(atlas, results_of(atlas)).outcome
    assert isinstance(outcome, Proved), outcome
    found: ProvedEquilibriumCurve = outcome.results
    assert [fold.is_maximum for fold in found.folds] == [True, False] * turns
    for fold in found.folds:
        assert fold.is_regular
        assert fold.all_values is not None
        assert fold.all_values.contains(1 if fold.is_maximum else -1)
    counts = [(part.sides.left, part.sides.right) if part.sides else None for part in found.sides]
    assert counts == [(2, 0), *[None, (1, 1), None, (2, 0)] * turns]
    start, end = (found.ends[key] for key in ("start", "end"))
    assert all(abs(start[name] - end[name]) < 1e-4 for name in atlas.coordinates)
    assert (start["a"] * start["a"] + start["x"] * start["x"]).contains(1)
    said = equilibrium_curve_in_words(EquilibriumCurveTheorem(atlas), found)
    for expected in (
        "There is a smooth closed curve without self-intersections in the coordinates (a, x, y) through (",
        "Near it there are no other equilibria but those of the curve.",
        "Its points may be run through again: what is listed apart below may be the same.",
        "That a has no other extrema is not said.",
    ):
        assert expected in said
    assert "increase" not in said


def test_pieces_that_do_not_close_are_no_loop() -> None:
    atlas = cases.circle_of_equilibria()
    pieces, results = atlas.curve_pieces(), {result.piece: result for result in results_of(atlas)}
    # The same points, s counted the other way.
    (a, b, _), (c, d, _) = pieces[2].frame[:2]
    turned = replace(pieces[2], frame=((-a, b, Q(0)), (-c, d, Q(0)), pieces[2].frame[2]))
    for wrong in (
        pieces[:-1],
        pieces[:3] + pieces[4:],
        (*pieces[:2], turned, *pieces[3:]),
        (pieces[1], pieces[0], *pieces[2:]),
        pieces[::-1],
    ):
        honest = [results[piece.id] for piece in wrong]
        assert reason(replace(atlas, pieces=wrong), honest) == "curve"
    assert reason(replace(atlas, pieces=pieces[:1]), [results["p0"]]) == "pieces"
    assert reason(replace(atlas, pieces=(*pieces, pieces[0])), list(results.values())) == "pieces"
    for increasing in ("x", "a"):
        claim = replace(atlas.claim, increasing=(increasing,))
        assert reason(replace(atlas, claim=claim), list(results.values())) == f"increasing-{increasing}"
    arc = replace(atlas, claim=replace(atlas.claim, kind="equilibrium-arc"))
    outcome = conclude_equilibria(arc, list(results.values())).outcome
    assert isinstance(outcome, Proved)
    assert "closed" not in equilibrium_curve_in_words(EquilibriumCurveTheorem(arc), outcome.results)


def test_every_parameter_has_its_own_value() -> None:
    """a = b x^2 + c x."""
    field = {"x": "a - b*x**2 - c*x", "y": "-c*y"}
    system = define_system({"name": "two", "state": "x y", "parameters": "b c a", "field": field})
    for values, holds in (({"b": Q(1, 2), "c": Q(2)}, True), ({"b": Q(2), "c": Q(1, 2)}, False)):
        atlas = line(system, Q(1, 4), (Q(0), Q(1, 2), Q(1, 32)), (Q(0), Q(0), Q(0)), parameters=values)
        assert [result.is_proved for result in results_of(atlas)] == [holds]


def test_counts_hold_at_all_points_that_the_curve_may_have() -> None:
    """The farther the curve may be from its polynomials, the longer is the part that is not decided."""
    atlas = cases.curve_of_equilibria()
    honest, widest = results_of(atlas), []
    for deviation in (Q(0), Q(1, 2**20), Q(1, 2**13)):
        results = [replace(result, deviation=(deviation,) * 2) for result in honest]
        outcome = conclude_equilibria(atlas, results).outcome
        assert isinstance(outcome, Proved)
        found = outcome.results.sides
        widest.append(max(float(part.between[1] - part.between[0]) for part in found if part.sides is None))
    assert 10 * widest[0] < widest[1] < widest[2] / 10
    theorem = EquilibriumCurveTheorem(atlas)
    for last, differ in ((found[2].sides, True), (found[0].sides, False)):
        curve = replace(outcome.results, sides=(*found[:2], replace(found[2], sides=last)))
        assert ("has one on the axis" in equilibrium_curve_in_words(theorem, curve)) is differ


def test_a_range_is_covered_whether_a_coordinate_increases_or_not() -> None:
    atlas = cases.curve_of_equilibria()
    honest = results_of(atlas)
    for covers in (Covers("x", Q(-12, 25), Q(3, 4)), Covers("x", Q(-3, 4), Q(12, 25)), Covers("y", Q(0), Q(1))):
        for increasing in ((), ("x",)):
            claim = replace(atlas.claim, increasing=increasing, covers=covers)
            assert reason(replace(atlas, claim=claim), honest) == "covers"


def test_a_fold_where_pieces_meet_is_an_extremum_between_them() -> None:
    """a = x^2, one piece up to 0 and one from -1/4: at 0 the direction is not certain on either."""
    system = define_system({"name": "u", "state": "x y", "parameters": "a", "field": {"x": "a - x**2", "y": "-y"}})
    whole = line(system, Q(1, 4), (Q(0),), (Q(0),) * 3)
    (piece,) = whole.curve_pieces()
    pieces = tuple(
        replace(
            piece, id=name, centre=(middle**2, middle, Q(0)), half_width=reach,
            polynomial=((Q(0), 2 * middle * reach, reach**2), (Q(0),)),
        )
        for name, middle, reach in (("p", Q(-1, 4), Q(1, 4)), ("q", Q(1, 8), Q(3, 8)))
    )  # fmt: skip
    found = proved(replace(whole, pieces=pieces))
    (fold,) = found.folds
    assert (fold.is_maximum, fold.is_regular, fold.pieces, fold.all_values) == (False, False, ("p", "q"), None)
    assert all(0 < value < 0.01 for value in fold.values)
    said = equilibrium_curve_in_words(EquilibriumCurveTheorem(replace(whole, pieces=pieces)), found)
    assert "Along it a has a minimum between a point with a in" in said


def test_where_a_piece_is_entered_is_one_part() -> None:
    """Eigenvalues x +- i on x = a, y = 0; the first piece knows x well and a badly, the second one the other way round.

    The second may be entered before x = 0, so that what is counted there may lie before the end of the first.
    """
    field, where = {"x": "g*u - y", "y": "u + g*y"}, {"u": "x - a", "g": "x - u**2 - y**2"}
    system = define_system({"name": "c", "state": "x y", "parameters": "a", "where": where, "field": field})
    (zero, one), origin = (Q(0), Q(1)), Q(-2307692, 10**7)
    by_x, by_a, places = (one, one, zero), (one, zero, zero), (-one, Q(-2309, 10000), Q(-2306, 10000), one)

    def piece(name: str, start: Q, end: Q, rows: Sequence[tuple[Q, ...]], polynomial: tuple[Q, ...]) -> Piece:
        middle, frame, tube = (start + end) / 2, (*rows, (zero, zero, one)), (Q(1, 2**7),) * 2
        polynomials = (polynomial, (zero,))
        return Piece(name, "regular", (middle, middle, zero), frame, (end - start) / 2, polynomials, tube, "physical")

    first = piece("p", Q(-1, 4), Q(1, 2**17), (by_x, by_a), (-Q(1, 2**15),))
    stable, unstable = Sides(2, 0), Sides(0, 2)
    for eps, rest in ((Q(1, 2**13), [None, unstable]), (zero, [])):
        last = piece("q", Q(-1, 8), Q(1, 5), (by_a, by_x), (eps * origin**2, -2 * eps * origin, eps))
        atlas = EquilibriumAtlas("c", "c", system, {}, EquilibriumCurveClaim("equilibrium-arc", "a"), (first, last))
        parts = [(first, (-one, one)), *((last, part) for part in pairwise(places))]
        outcome = conclude_equilibria(
            atlas, [prove_equilibrium_piece(atlas, of, part, FAST).stored for of, part in parts]
        ).outcome
        assert isinstance(outcome, Proved), outcome
        found = outcome.results
        stretch = found.chain.stretches[1]
        assert stretch.enters < places[1] < origin < stretch.entered
        assert [part.sides for part in found.sides] == [stable, None, unstable, None, unstable, *rest]
        assert [part.pieces for part in found.sides] == [("p", "p")] * 3 + [("q", "q")] * (2 + len(rest))
        assert found.sides[3].between == (stretch.enters, stretch.entered)
        assert all(found.sides[3].all_values.contains(value) for value in (-3e-5, 0, 3e-6))
        assert found.sides[4].between[0] == stretch.entered
        said = equilibrium_curve_in_words(EquilibriumCurveTheorem(atlas), found)
        assert said.count("an equilibrium there has one on the axis") == 1


def test_slopes_are_within_those_of_the_polynomial_and_the_bound() -> None:
    """The polynomial is off by c s, the curve's own slope by c."""
    atlas = cases.curve_of_equilibria()
    first, last = atlas.curve_pieces()
    ((constant, linear, square), other) = first.polynomial
    off = first.tube[0] / 200
    bent = replace(atlas, pieces=(replace(first, polynomial=((constant, linear + off, square), other)), last))
    outcome = prove_equilibrium_piece(bent, bent.curve_pieces()[0], (Q(0), Q(1, 4)), FAST).outcome
    assert isinstance(outcome, Proved)
    assert off <= outcome.results.slope_deviation[0] < 64 * off
    assert off / 4 <= outcome.results.deviation[0] < off / 2


def test_a_curve_of_a_field_with_functions() -> None:
    """a = log(1 + x)."""
    system = define_system(
        {"name": "e", "state": "x y", "parameters": "a", "field": {"x": "exp(a) - 1 - x", "y": "-exp(x)*y"}}
    )
    found = proved(line(system, Q(1, 16), (Q(0), Q(1, 16), -Q(1, 512), Q(1, 12288)), (Q(0),) * 3))
    assert agree(found.ends["end"]["a"], (arb(17) / 16).log())
    assert [(part.sides.left, part.sides.right) for part in found.sides if part.sides] == [(2, 0)]
