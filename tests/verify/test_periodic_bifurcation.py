"""Bifurcations of periodic orbits without symmetry: closed forms and published points proved, false claims not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
from flint import acb, arb, ctx
from support import periodic_bifurcation_cases as cases
from support.balls import agree
from support.known_bifurcations import diagonal

from orbitproof.shared.formats import PeriodicBifurcation, define_system
from orbitproof.verify.claim import inverse, is_respected
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    enclose,
    guarded,
    indices_up_to,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    PeriodicBifurcationResults,
    check_bifurcation_exactly,
    enclose_periodic_bifurcation,
    prove_periodic_bifurcation,
)
from orbitproof.verify.poincare import IntegratorSettings

BITS = 160
MANY_BITS = 240
ZERO, ONE, HALF = Fraction(0), Fraction(1), Fraction(1, 2)


@cache
def _enclosed(key: str, bits: int = BITS) -> BifurcationEnclosures:
    return enclose_periodic_bifurcation(CLAIMS[key], IntegratorSettings(bits), ORACLE)


CLAIMS = {
    "fold": cases.folding(),
    "doubling": cases.doubling(2, 1, 1, -1),
    "fixed": cases.breaking(1, -1, 1, HALF),
    "moved": cases.half_a_period(1, 1, 1, -2),
    "level": cases.levels(),
    "level fold": cases.level_fold(),
    "roessler": cases.roessler(),
    "two crossings": cases.lorenz_second_pitchfork(),
}


def _outcome(
    claim: PeriodicBifurcation,
    found: BifurcationEnclosures | None = None,
    enclosed: bool = True,
    bits: int = BITS,
) -> Outcome[PeriodicBifurcationResults]:
    """By enclosures that are given, or by those that are found."""
    checklist = Checklist()
    with guarded(bits):
        try:
            check_bifurcation_exactly(checklist, claim)
            if found is None and enclosed:
                found = enclose_periodic_bifurcation(claim, IntegratorSettings(bits), ORACLE)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
        return prove_periodic_bifurcation(claim, checklist, found)


def _proved(
    claim: PeriodicBifurcation, found: BifurcationEnclosures | None = None, bits: int = BITS
) -> PeriodicBifurcationResults:
    outcome = _outcome(claim, found, bits=bits)
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


def _refused(claim: PeriodicBifurcation, found: BifurcationEnclosures | None = None, enclosed: bool = True) -> str:
    outcome = _outcome(claim, found, enclosed)
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition


def _is(ball: arb | acb, value: arb | acb | Fraction) -> bool:
    with ctx.workprec(600):
        exact = enclose(value) if isinstance(value, Fraction) else value
        return bool((acb(ball) - acb(exact)).contains(0)) and bool(abs(acb(ball) - acb(exact)) < 1e-6)


def test_the_fold_of_circles_is_where_it_is() -> None:
    found = _proved(CLAIMS["fold"], _enclosed("fold"))
    assert _is(found.parameter, ZERO)
    assert found.parameter_name == "a"
    assert (found.side, found.known, found.criticality, found.is_fixed) == ("above", 1, None, None)
    assert _is(found.opening, Fraction(4))
    assert (_is(found.point["x"], ONE), _is(found.point["y"], ZERO)) == (True, True)
    with ctx.workprec(400):
        assert _is(found.period, 2 * arb.pi())
    assert found.multipliers.values == ()


@pytest.mark.parametrize(("b", "c"), [(0, 1), (3, -1), (-2, HALF)])
def test_the_side_of_a_fold_is_that_of_its_circles(b: Any, c: Any) -> None:
    found = _proved(cases.folding(b, c))
    assert found.side == ("above" if c > 0 else "below")
    assert _is(found.opening, Fraction(4) / Fraction(c))


COEFFICIENTS = [(0, 1, 0, 0), (0, -1, 0, 0), (2, 1, 1, -1), (2, 1, -1, 1), (-8, 1, 0, 1), (1, HALF, -1, 1)]


@pytest.mark.parametrize(("b", "c", "d", "e"), COEFFICIENTS)
def test_a_doubling_has_its_side_and_criticality(b: Any, c: Any, d: Any, e: Any) -> None:
    found = _proved(cases.doubling(b, c, d, e))
    speed, bend = ONE + (e + Fraction(1, 4)) * b, c + (e + Fraction(1, 4)) * d
    assert _is(found.opening, bend / speed)
    assert found.side == ("above" if bend / speed > 0 else "below")
    assert found.criticality == ("supercritical" if bend > 0 else "subcritical")
    with ctx.workprec(400):
        pi = arb.pi()
        assert _is(found.period, 2 * pi)
        assert any(_is(value, -(-2 * pi).exp()) for value in found.multipliers.values)
        assert any(_is(value, (-pi / 2).exp()) for value in found.multipliers.values)
    assert (found.known, found.multipliers.inside, found.multipliers.trivial) == (-1, 2, 1)


@pytest.mark.parametrize(("b", "c", "d", "e"), [(0, 1, 0, 0), (1, -1, 1, HALF), (-4, 1, -1, 2)])
def test_a_pitchfork_in_the_fixed_set_has_its_side_and_criticality(b: Any, c: Any, d: Any, e: Any) -> None:
    found = _proved(cases.breaking(b, c, d, e))
    _check_pitchfork(found, b, c, d, e)
    assert found.is_fixed is True
    with ctx.workprec(400):
        for exact in ((-arb.pi() / 2).exp(), (-arb.pi()).exp()):
            assert any(_is(value, exact) for value in found.multipliers.values)
    assert found.multipliers.inside == 2


@pytest.mark.parametrize(("b", "c", "d", "e"), [(0, 1, 0, 0), (1, 1, 1, -2)])
def test_a_pitchfork_of_an_orbit_that_is_moved_by_half_a_period_has_them_too(b: Any, c: Any, d: Any, e: Any) -> None:
    found = _proved(cases.half_a_period(b, c, d, e))
    _check_pitchfork(found, b, c, d, e)
    assert found.is_fixed is False
    with ctx.workprec(400):
        assert all(_is(value, (-arb.pi() / 2).exp()) for value in found.multipliers.values)
    assert found.multipliers.inside == 2


def _check_pitchfork(found: PeriodicBifurcationResults, b: Any, c: Any, d: Any, e: Any) -> None:
    speed, bend = ONE + Fraction(e) * b, c + Fraction(e) * d
    assert _is(found.opening, bend / speed)
    assert found.side == ("above" if bend / speed > 0 else "below")
    assert found.criticality == ("supercritical" if bend > 0 else "subcritical")
    assert found.known == 1
    with ctx.workprec(400):
        assert _is(found.period, 2 * arb.pi())


def test_on_levels_the_side_is_that_of_the_level() -> None:
    found = _proved(CLAIMS["level"], _enclosed("level"))
    assert (found.side, found.criticality, found.parameter_name) == ("above", None, "first integral")
    assert _is(found.parameter, ONE)
    assert _is(found.opening, Fraction(4, 5))
    assert (found.multipliers.trivial, found.multipliers.inside, found.level) == (2, 1, None)
    below = _proved(cases.levels(-1))
    assert below.side == "below"
    fold = _proved(CLAIMS["level fold"], _enclosed("level fold"))
    assert (fold.side, fold.known) == ("above", 1)
    assert _is(fold.opening, ONE)


def test_a_parameter_may_vary_on_a_level() -> None:
    found = _proved(cases.level_fold(parameter="a", level=ONE))
    assert (found.side, found.parameter_name, found.level_name) == ("below", "a", "first integral")
    assert found.level == 1
    assert _is(found.parameter, ZERO)
    assert _is(found.opening, -ONE)


@pytest.mark.parametrize(("integral", "opening"), [("x**2 + y**2 + a", -1), ("(x**2 + y**2)*(1 - 2*a)", HALF)])
def test_a_first_integral_may_depend_on_the_parameter(integral: str, opening: Any) -> None:
    """u^2 = x^2 + y^2 - 1 on the level 1: -a, and 2 a to first order."""
    field = {"x": "-y", "y": "x", "u": "(x**2 + y**2 - 1 - u**2)/4 + 0*a"}
    system = define_system(
        {"name": "on", "state": "x y u", "parameters": "a", "field": field, "first_integral": integral}
    )  # fmt: skip
    found = _proved(cases.level_fold(parameter="a", system=system))
    assert _is(found.opening, Fraction(opening))
    assert found.side == ("above" if opening > 0 else "below")


def test_where_a_map_keeps_an_area_the_other_multiplier_is_the_same() -> None:
    for c in (1, -1):
        found = _proved(cases.area(c))
        assert found.side == ("above" if c > 0 else "below")
        assert _is(found.opening, Fraction(4 * c, 5))
        assert found.multipliers.values == (acb(-1),)
        assert (found.multipliers.on, found.multipliers.trivial, found.criticality) == (1, 2, None)


def test_roesslers_first_doubling_is_proved() -> None:
    found = _proved(CLAIMS["roessler"], _enclosed("roessler", MANY_BITS), MANY_BITS)
    assert (found.side, found.criticality, found.multipliers.inside) == ("above", "supercritical", 1)
    assert abs(float(found.parameter.mid()) - 2.832445) < 1e-6
    assert found.parameter.rad() < 1e-30
    assert abs(float(found.period.mid()) - 5.76982) < 1e-5


def test_the_symmetric_orbit_of_lorenz_loses_its_symmetry() -> None:
    found = _proved(cases.lorenz_pitchfork())
    assert (found.side, found.criticality, found.is_fixed) == ("below", "supercritical", False)
    assert abs(float(found.parameter.mid()) - 312.97353) < 1e-5
    assert found.multipliers.inside == 1


@pytest.mark.slow
def test_other_orbits_of_lorenz_bifurcate() -> None:
    """The window 148 < rho < 166 (C. Sparrow, The Lorenz equations, 1982) ends in a fold at 166.06."""
    fold = _proved(cases.lorenz_fold(), bits=MANY_BITS)
    assert (fold.side, fold.multipliers.inside) == ("below", 1)
    assert abs(float(fold.parameter.mid()) - 166.06149) < 1e-5
    pitchfork = _proved(CLAIMS["two crossings"], _enclosed("two crossings", MANY_BITS), MANY_BITS)
    assert (pitchfork.is_fixed, pitchfork.criticality) == (False, "supercritical")


SLIVER = 3 * cases.WIDTH


@pytest.mark.parametrize("place", [0, 1, 2, 3])
@pytest.mark.parametrize("by", [SLIVER, -SLIVER])
def test_a_box_beside_the_bifurcation_is_refused(place: int, by: Fraction) -> None:
    outcome = _outcome(cases.shifted(cases.doubling(), place, by))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"
    assert outcome.reason.excluded


@pytest.mark.parametrize("place", [0, 2])
def test_what_is_found_does_not_depend_on_the_centre(place: int) -> None:
    claim = cases.shifted(
        cases.roessler(radii=(cases.WIDTH * 64,) * 2, parameter_radius=cases.WIDTH * 64), place, SLIVER
    )
    found, exact = _proved(claim), _proved(CLAIMS["roessler"], _enclosed("roessler"))
    with guarded(BITS):
        assert agree(found.period, exact.period)
        assert agree(found.parameter, exact.parameter)
        assert all(agree(found.point[name], exact.point[name]) for name in "xyz")
        assert agree(found.opening, exact.opening)


def test_the_level_of_a_bifurcation_is_that_of_the_level_and_not_beside_it() -> None:
    for by in (SLIVER, -SLIVER):
        assert _refused(cases.shifted(cases.levels(), 3, by)) == "bifurcation"
        assert _refused(cases.shifted(cases.level_fold(), 2, by)) == "bifurcation"
    assert _is(_proved(cases.shifted(cases.levels(), 3, cases.WIDTH / 2)).parameter, ONE)


@pytest.mark.parametrize(
    ("claim", "kind"),
    [
        (cases.folding(), "periodic-doubling"),
        (cases.doubling(), "periodic-fold"),
        (cases.levels(), "periodic-fold"),
        (cases.level_fold(), "periodic-doubling"),
    ],
)
def test_another_kind_of_bifurcation_is_refused(claim: PeriodicBifurcation, kind: Any) -> None:
    assert _refused(replace(claim, kind=kind)) == "bifurcation"


def test_a_torus_is_a_theorem_of_its_own() -> None:
    kernel = ((ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
    torus = replace(CLAIMS["doubling"], kind="periodic-torus", kernel=kernel, multiplier=(ZERO, ONE))
    assert _refused(torus, _enclosed("doubling")) == "theorem"


def test_a_pitchfork_is_no_fold() -> None:
    """1 is a multiplier, and the orbit does not vanish."""
    claim = replace(cases.breaking(), kind="periodic-fold", symmetry=None)
    assert _refused(claim) in ("bifurcation", "side")


@pytest.mark.parametrize("crossings", [2, 3])
def test_a_bifurcation_run_through_several_times_is_refused(crossings: int) -> None:
    """After two turns the multiplier is 1, and after three it is -1 again."""
    assert _refused(cases.doubling(crossings=crossings)) in ("bifurcation", "least-period", "side")
    assert _refused(cases.folding(crossings=crossings)) == "least-period"
    assert _refused(cases.breaking(crossings=crossings)) in ("least-period", "bifurcation")
    assert _refused(cases.shifted(cases.folding(crossings=crossings), 0, cases.WIDTH / 2)) == "least-period"
    assert _refused(cases.level_fold(crossings=crossings)) == "least-period"


def test_an_orbit_that_is_moved_returns_under_the_symmetry_after_an_odd_number_of_half_periods() -> None:
    assert _refused(cases.half_a_period(crossings=2)) == "bifurcation"
    assert _refused(cases.half_a_period(crossings=3)) == "least-period"


def test_a_bifurcation_of_higher_order_is_not_proved() -> None:
    """With c = 0 the new orbits are all at a = 0: no side can be told."""
    assert _refused(cases.doubling(c=0)) == "side"
    assert _refused(cases.breaking(c=0)) == "side"


def test_a_parameter_on_which_nothing_depends_is_refused() -> None:
    assert _refused(cases.breaking(parameter="c")) == "bifurcation"
    assert _refused(cases.folding(parameter="c")) == "bifurcation"


@pytest.mark.parametrize(
    ("changes", "condition"),
    [
        ({"direction": -1}, "direction"),
        ({"offset": ONE}, "section"),
        ({"normal": (ZERO,) * 4}, "section"),
        ({"symmetry": diagonal(1, 1, -1, 2)}, "symmetry"),
        ({"symmetry": (*diagonal(1, 1, -1, -1)[:2], (ONE, ZERO, -ONE, ZERO), cases.unit(4, 3))}, "symmetry"),
        ({"symmetry": diagonal(1, -1, -1, -1)}, "symmetry"),
        ({"symmetry": diagonal(-1, -1, -1, -1)}, "symmetry"),
        ({"radii": (Fraction(3), ONE, ONE)}, "direction"),
    ],
)
def test_what_is_wrong_with_a_claim_is_seen_exactly(changes: dict[str, Any], condition: str) -> None:
    assert _refused(cases.breaking(**changes), enclosed=False) == condition


def test_the_direction_is_that_of_all_values_of_the_parameter() -> None:
    """y' = w at (1, 0), and w takes both signs."""
    system = define_system({"name": "turning", "state": "x y", "parameters": "w", "field": {"x": "-w*y", "y": "w*x"}})
    claim = cases.bifurcation(system, "periodic-fold", 1, [ONE, ZERO], [ONE], parameters={"w": ONE}, parameter="w")
    assert _refused(claim, enclosed=False) == "return-map"
    assert _refused(replace(claim, parameter_radius=Fraction(2)), enclosed=False) == "direction"


def test_what_is_no_first_integral_is_refused() -> None:
    wrong = replace(cases.LEVELS, first_integral=lambda x, _: (x[0] * x[0] + 2 * x[1] * x[1],))
    assert _refused(replace(cases.levels(), system=wrong), enclosed=False) == "first-integral"


def test_a_first_integral_that_a_symmetry_changes_is_refused() -> None:
    field = {"x": "-y", "y": "x", "u": "0*u", "v": "0*v"}
    system = define_system({"name": "odd", "state": "x y u v", "field": field, "first_integral": "x**2 + y**2 + u"})
    symmetry = tuple(tuple(Fraction((1 - 2 * (i > 1)) * (i == j)) for j in range(4)) for i in range(4))
    claim = cases.bifurcation(
        system, "periodic-pitchfork", 1, [ONE, ZERO, ZERO, ZERO], [ZERO, ONE, ZERO], parameters={}, level=ONE,
        symmetry=symmetry,
    )  # fmt: skip
    assert _refused(claim, enclosed=False) == "symmetry"


def test_an_eigenvector_that_the_symmetry_leaves_alone_is_no_pitchfork() -> None:
    same = tuple(cases.unit(4, i) for i in range(4))
    assert _refused(replace(cases.doubling(), kind="periodic-pitchfork", symmetry=same)) == "mirrored"


def test_where_the_symmetry_may_or_may_not_fix_the_point_nothing_is_proved() -> None:
    oblique = ((ONE, ZERO, ZERO), (ZERO, ZERO, ZERO), (ONE, ONE, ZERO), (ZERO, ZERO, ONE))
    assert _refused(cases.breaking(frame=oblique)) == "mirrored"
    assert _refused(cases.shifted(cases.breaking(), 1, cases.WIDTH / 4)) == "mirrored"


def test_the_eigenvector_is_looked_for_in_its_box() -> None:
    """Over the box of points eigenvectors change by more than 2^-90, and that of the centre is known to 2^-132."""
    claim = cases.roessler(kernel_radius=Fraction(1, 2**90))
    assert _proved(claim, bits=MANY_BITS).criticality == "supercritical"
    outcome = _outcome(cases.roessler(kernel_radius=Fraction(1, 2**150)), bits=MANY_BITS)
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"
    assert not outcome.reason.excluded


def test_a_field_respects_a_matrix_or_does_not() -> None:
    system = cases.LORENZ
    assert is_respected(system.program, cases.TURN)
    assert not is_respected(system.program, tuple(tuple(-entry for entry in row) for row in cases.TURN))
    swap = ((ZERO, ONE), (ONE, ZERO))
    fields = {("y/(1 + x**2)", "x/(1 + y**2)"): True, ("y/(1 + y**2)", "x/(1 + y**2)"): False, ("x", "2*y"): False}
    for (right, left), respected in fields.items():
        described = define_system({"name": "swap", "state": "x y", "field": {"x": right, "y": left}})
        assert is_respected(described.program, swap) is respected, right


def test_a_function_that_is_defined_elsewhere_is_not_respected() -> None:
    """1/x and -1/x: a divisor has to be one of the field itself."""
    odd = define_system({"name": "odd", "state": "x y", "field": {"x": "1/x", "y": "0*x"}})
    assert not is_respected(odd.program, diagonal(-1, 1))
    apart = define_system({"name": "apart", "state": "x y", "field": {"x": "x", "y": "y*(1 + x)/(1 + x)"}})
    assert not is_respected(apart.program, diagonal(-1, 1))
    assert is_respected(apart.program, diagonal(1, -1))


def test_an_earlier_return_that_may_be_the_point_proves_nothing() -> None:
    claim, found = CLAIMS["two crossings"], _enclosed("two crossings")
    assert _proved(claim, found).is_fixed is False
    (earlier,) = found.earlier
    wide = tuple(replace(function, centre=function.centre + arb(0, 100)) for function in earlier.image)
    assert _refused(claim, replace(found, earlier=(replace(earlier, image=wide),))) == "least-period"
    assert _refused(claim, replace(found, earlier=())) == "return-map"
    assert _refused(claim, replace(found, earlier=(replace(earlier, crossings=2),))) == "return-map"
    assert _refused(claim, replace(found, earlier=(replace(earlier, image=earlier.image[:1]),))) == "return-map"


def test_a_level_whose_derivative_may_vanish_on_the_way_is_refused() -> None:
    found = _enclosed("level")
    zero = (0,) * len(next(iter(found.time.box)))
    first = found.image[0]
    far = replace(
        first,
        centre={**first.centre, zero: first.centre[zero] - arb(4, 1)},
        box={**first.box, zero: first.box[zero] - arb(4, 1)},
    )
    assert _refused(CLAIMS["level"], replace(found, image=(far, *found.image[1:]))) == "last-coordinate"


def test_orbits_all_at_one_value_of_the_parameter_are_refused() -> None:
    """With w' = a they are a curve in w for a = 0, along which the period doubles at w = 0."""
    assert _refused(cases.vertical()) == "curve"


@pytest.mark.parametrize("place", [0, 1, 2, 3])
def test_a_bifurcation_on_the_edge_of_the_box_is_not_proved(place: int) -> None:
    outcome = _outcome(cases.shifted(cases.doubling(), place, cases.WIDTH))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"
    assert not outcome.reason.excluded
    assert outcome.reason.needs_precision


def _in_another_frame(claim: PeriodicBifurcation, matrix: Sequence[Sequence[int]], by: int) -> PeriodicBifurcation:
    """The columns of the frame times a matrix, the eigenvector in the new coordinates times a number."""
    columns = list(zip(*matrix, strict=True))
    frame = tuple(
        tuple(sum((a * b for a, b in zip(row, column, strict=True)), ZERO) for column in columns) for row in claim.frame
    )
    (old,) = claim.kernel
    back = inverse(tuple(tuple(map(Fraction, row)) for row in matrix))
    assert back is not None
    kernel = tuple(by * sum((a * b for a, b in zip(row, old, strict=True)), ZERO) for row in back)
    return replace(claim, frame=frame, kernel=(kernel,))


FRAMES = [((1, 0, 0), (1, 1, 0), (0, 0, 1)), ((1, 2, 1), (0, 1, 1), (0, 0, 1)), ((0, -1, 0), (0, 0, 2), (1, 1, 0))]


@pytest.mark.parametrize("matrix", FRAMES)
@pytest.mark.parametrize("by", [pytest.param(1, marks=pytest.mark.slow), -2])
def test_what_is_found_does_not_depend_on_the_frame(matrix: Any, by: int) -> None:
    """But kappa, which is that of an eigenvector `by` times as long."""
    claim = CLAIMS["doubling"]
    found = _proved(_in_another_frame(claim, matrix, by))
    assert _is(found.opening, -HALF * by**2)
    assert (found.side, found.criticality) == ("below", "supercritical")
    on_level = _proved(_in_another_frame(CLAIMS["level"], matrix, by))
    assert _is(on_level.opening, Fraction(4, 5) * by**2)
    with ctx.workprec(400):
        pi = arb.pi()
        for exact in (-(-2 * pi).exp(), (-pi / 2).exp()):
            assert any(_is(value, exact) for value in found.multipliers.values)
        assert [_is(value, -(-2 * pi).exp()) for value in on_level.multipliers.values] == [True]


def test_what_is_found_does_not_depend_on_the_section() -> None:
    """On y + u/2 = 0 the eigenvector is (0, -1/2, 1, 0), the old one moved along the flow."""
    frame = ((ONE, ZERO, ZERO), (ZERO, -HALF, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
    found = _proved(replace(CLAIMS["doubling"], normal=(ZERO, ONE, HALF, ZERO), frame=frame))
    assert _is(found.opening, -HALF)
    assert (found.side, found.criticality) == ("below", "supercritical")
    moved = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ZERO), (ZERO, ZERO, -Fraction(2)))
    pitchfork = _proved(replace(CLAIMS["moved"], frame=moved, kernel=((ZERO, ZERO, ONE),)))
    assert _is(pitchfork.opening, 4 * _proved(CLAIMS["moved"], _enclosed("moved")).opening)


@pytest.mark.parametrize("place", [0, 1])
def test_what_is_found_in_a_wide_box_is_true(place: int) -> None:
    wide = Fraction(1, 2**16)
    claim = cases.folding(1, 1, radii=(wide,), parameter_radius=wide, kernel_radius=Fraction(1, 4))
    found = _proved(cases.shifted(claim, place, wide / 4))
    with guarded(BITS):
        assert found.parameter.contains(0)
        assert found.point["x"].contains(1)
        assert (found.period - 2 * arb.pi()).contains(0)
        assert found.opening.contains(4)


@pytest.mark.parametrize(("key", "place"), [("fold", 0), ("fold", 1), ("level fold", 0)])
def test_derivatives_are_enclosed_up_to_the_edges_of_the_box_and_the_interval(key: str, place: int) -> None:
    claim = replace(CLAIMS[key], crossings=2)
    radii = [cases.WIDTH] * (len(claim.radii) + 1)
    radii[place] = Fraction(1, 2**16)
    wide = replace(claim, radii=tuple(radii[:-1]), parameter_radius=radii[-1])
    for side in (Fraction(15, 16), Fraction(-15, 16)):
        narrow = cases.shifted(claim, place, side * radii[place])
        outer, inner = (enclose_periodic_bifurcation(each, IntegratorSettings(BITS), ORACLE) for each in (wide, narrow))
        for left, right in zip(outer.tables, inner.tables, strict=True):
            for index, ball in right.centre.items():
                if any(index):
                    assert agree(left.box[index], ball), index
        for left, right in zip(outer.earlier[0].image, inner.earlier[0].image, strict=True):
            assert all(agree(ball, other) for ball, other in zip(left.slopes, right.slopes, strict=True))


def _table(values: dict[tuple[int, ...], Any]) -> DerivativeTable:
    """Derivatives at the centre in three variables, and the same over the box."""
    known = {index: arb(values.get(index, 0)) for index in indices_up_to(3, 3)}
    return DerivativeTable({index: ball + arb(0, 1e-18) for index, ball in known.items()}, known)


@pytest.mark.parametrize("c", [1, -1])
def test_a_double_multiplier_has_no_criticality(c: int) -> None:
    """F(p, s) = (-p_0 + p_1, s p_0 - p_1 + c p_0^3): l = (0, 1), w = (1, 0), gamma = 1 and c."""
    image = (
        _table({(1, 0, 0): -1, (0, 1, 0): 1}),
        _table({(1, 0, 1): 1, (0, 1, 0): -1, (3, 0, 0): 6 * c}),
    )
    claim = cases.bifurcation(
        cases.ROESSLER, "periodic-doubling", 1, [ONE, ZERO, ZERO], [ONE, ZERO],
        parameters={"a": ONE, "b": ONE, "c": ONE}, parameter="c",
    )  # fmt: skip
    by_hand = BifurcationEnclosures((), image, _table({(0, 0, 0): 6}), None)
    found = _proved(claim, by_hand)
    assert _is(found.opening, Fraction(-c))
    assert (found.side, found.criticality) == ("below" if c > 0 else "above", None)
