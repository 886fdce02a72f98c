"""Neimark-Sacker bifurcations of periodic orbits: closed forms and published ones proved, false claims not."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
from flint import acb, arb, ctx
from support import torus_cases as cases
from support.balls import agree
from support.known_bifurcations import over_box
from support.normal_form_maps import KnownTorus, known_torus, seen_from

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import PERIODIC_DOUBLING, PERIODIC_FOLD, PeriodicBifurcation
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import certify
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotProved,
    Outcome,
    Proved,
    enclose,
    guarded,
    indices_up_to,
    symmetric,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    TorusCoefficients,
    TorusResults,
    enclose_periodic_bifurcation,
    prove_torus,
    without_plane,
)
from orbitproof.verify.poincare import IntegratorSettings

BITS = 200
WIDTH = cases.WIDTH


def _enclose(claim: PeriodicBifurcation) -> BifurcationEnclosures:
    return enclose_periodic_bifurcation(claim, IntegratorSettings(BITS), ORACLE)


@cache
def _round() -> BifurcationEnclosures:
    return _enclose(cases.round_claim())


def _outcome(claim: PeriodicBifurcation, enclosures: BifurcationEnclosures | None) -> Outcome[TorusResults]:
    return _conclude(claim, BITS, enclosures)


def _proved(claim: PeriodicBifurcation, enclosures: BifurcationEnclosures | None = None) -> TorusResults:
    outcome = _outcome(claim, enclosures or _enclose(claim))
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


def _refused(claim: PeriodicBifurcation, enclosures: BifurcationEnclosures | None) -> str:
    outcome = _outcome(claim, enclosures)
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition


def _contains(ball: acb | arb, value: acb | arb) -> bool:
    return bool(acb(ball).contains(acb(value).mid()))


@pytest.mark.parametrize(
    ("b", "c", "d"),
    [
        (Fraction(-1, 3), Fraction(1), Fraction(1, 2)),
        (Fraction(0), Fraction(1), Fraction(1)),
        (Fraction(0), Fraction(1), Fraction(-1)),
        (Fraction(1, 2), Fraction(0), Fraction(2)),
    ],
)
def test_a_torus_in_three_dimensions_has_its_known_coefficients(b: Fraction, c: Fraction, d: Fraction) -> None:
    w = Fraction(2, 7)
    found = _proved(cases.round_claim(w, b, c, d))
    known = 3 * b / 8 - c * d / (8 * w)
    with ctx.workprec(500):
        turn = 2 * arb.pi()
        assert _contains(found.parameter, arb(0))
        assert _contains(found.period, turn)
        assert _contains(found.multiplier, (turn * acb(0, enclose(w))).exp())
        assert _contains(found.speed, turn)
        assert _contains(found.lyapunov, turn * enclose(known))
        assert all(_contains(found.point[name], arb(value)) for name, value in (("x", 1), ("y", 0), ("z", 0)))
    assert found.parameter.rad() < 1e-35
    assert found.speed.rad() < 1e-10
    assert found.parameter_name == "a"
    assert found.multipliers.values == ()
    assert (found.criticality, found.side) == (("supercritical", "above") if known < 0 else ("subcritical", "below"))
    assert found.is_attracting is (known < 0)


def test_an_orbit_with_two_crossings_has_the_coefficients_of_the_same_orbit_with_one() -> None:
    found = _proved(cases.bent_claim())
    with ctx.workprec(500):
        turn = 2 * arb.pi()
        assert _contains(found.parameter, arb(0))
        assert _contains(found.period, turn)
        assert _contains(found.speed, turn)
        known = Fraction(-1, 8) - Fraction(7, 32)
        assert _contains(found.lyapunov, turn * enclose(known * Fraction(24, 5) ** 2))
    assert found.lyapunov.rad() < 1


@pytest.mark.parametrize(
    ("crossings", "turns", "conditions"), [(1, 1, ("bifurcation",)), (4, 2, ("least-period", "bifurcation"))]
)
def test_another_number_of_crossings_is_refused(crossings: int, turns: int, conditions: tuple[str, ...]) -> None:
    claim = cases.bent_claim(crossings=crossings, multiplier=cases.on_circle(Fraction(2 * turns, 7)))
    assert _refused(claim, _enclose(claim)) in conditions


@pytest.mark.parametrize("d", [Fraction(-1), Fraction(2)])
@pytest.mark.parametrize("k", [Fraction(1, 4), Fraction(-1, 8)])
def test_a_torus_attracts_only_if_all_other_multipliers_lie_inside(d: Fraction, k: Fraction) -> None:
    found = _proved(cases.product_claim(d=d, k=k))
    with ctx.workprec(500):
        turn = 2 * arb.pi()
        assert _contains(found.lyapunov, turn * enclose(d))
        assert _contains(found.speed, turn)
        assert _contains(found.multiplier, (turn * acb(0, enclose(Fraction(1, 5)))).exp())
        (other,) = found.multipliers.values
        assert _contains(other, (-2 * turn * enclose(k)).exp())
    assert (found.multipliers.inside, found.multipliers.outside) == ((1, 0) if k > 0 else (0, 1))
    assert found.criticality == ("supercritical" if d < 0 else "subcritical")
    assert found.side == ("above" if d < 0 else "below")
    assert found.is_attracting is (d < 0 and k > 0)


def test_the_side_follows_the_direction_in_which_the_pair_crosses() -> None:
    """With -a for a the pair moves inward as the parameter grows."""
    claim = cases.round_claim()
    field = cases.ROUND.vector_field
    turned = replace(cases.ROUND, vector_field=lambda x, values: field(x, (0 - values[0], *values[1:])))
    found = _proved(replace(claim, system=turned))
    assert found.side == "below"
    assert found.criticality == "supercritical"
    with ctx.workprec(500):
        assert _contains(found.speed, -2 * arb.pi())


def test_a_published_torus_of_an_electronic_circuit_is_proved() -> None:
    """The manual of MatCont: period 8.861103, nu = -5.957506e-001, a positive coefficient, so a torus that repels."""
    found = _proved(cases.circuit())
    assert agree(found.parameter, arb(-0.5957506, 6e-8))
    assert agree(found.period, arb(8.861103, 6e-7))
    assert found.parameter.rad() < 1e-24
    assert (found.side, found.criticality) == ("below", "subcritical")
    assert not found.is_attracting


def test_a_torus_of_langford_with_an_axis_of_symmetry_is_where_it_is_by_hand() -> None:
    claim = cases.symmetric_langford()
    found = _proved(claim)
    with ctx.workprec(500):
        assert _contains(found.parameter, enclose(claim.parameters["a"]))
        period = 4 * arb.pi() / 7
        assert _contains(found.period, period)
        # The real part of the eigenvalues is (a - b^2 - R r^2)/2, and r^2 depends on a as well.
        a, b, constant = (enclose(claim.parameters[name]) for name in ("a", "b", "r"))
        rate = (1 - constant * b / (1 + constant * b)) / 2
        assert _contains(found.speed, period * rate)
        level = enclose(claim.parameters["l"]) + a * b - b * b * b / 3
        assert _contains(found.multiplier, (acb(0, 1) * period * (2 * level).sqrt()).exp())
    assert found.speed.rad() < 1e-10
    assert (found.side, found.criticality) == ("above", "supercritical")


@pytest.mark.slow
def test_a_torus_of_langford_is_proved() -> None:
    found = _proved(cases.langford())
    with ctx.workprec(200):
        # The angle in the plane (x, y) grows with the rate w.
        assert _contains(found.period, 4 * arb.pi() / 7)
    assert found.parameter.rad() < 1e-24
    assert (found.side, found.criticality) == ("above", "supercritical")
    assert found.is_attracting


@pytest.mark.parametrize("w", [Fraction(1, 4), Fraction(1, 3), Fraction(2, 3), Fraction(3, 4)])
def test_strong_resonances_are_refused(w: Fraction) -> None:
    claim = cases.product_claim(w)
    assert _refused(claim, _enclose(claim)) == "non-resonance"


@pytest.mark.parametrize("w", [Fraction(1, 2), Fraction(1)])
def test_real_multipliers_are_refused(w: Fraction) -> None:
    claim = cases.product_claim(w)
    assert _refused(claim, _enclose(claim)) in ("bifurcation", "non-resonance")


def test_a_coefficient_that_is_zero_is_refused() -> None:
    claim = cases.product_claim(d=Fraction(0))
    assert _refused(claim, _enclose(claim)) == "lyapunov"


@pytest.mark.parametrize("unknown", [arb(0, 1), arb(0), arb("nan"), arb(0, "inf")])
def test_coefficients_whose_sign_is_not_certain_prove_nothing(unknown: arb, monkeypatch: pytest.MonkeyPatch) -> None:
    place = "orbitproof.verify.periodic_bifurcation.proved_torus.coefficients_of_torus"
    monkeypatch.setattr(place, lambda *_: TorusCoefficients(arb(-1), unknown))
    assert _refused(cases.round_claim(), _round()) == "crossing"
    monkeypatch.setattr(place, lambda *_: TorusCoefficients(unknown, arb(1)))
    assert _refused(cases.round_claim(), _round()) == "lyapunov"


@pytest.mark.parametrize(("speed", "lyapunov"), [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_the_side_follows_from_signs_however_wide_the_coefficients_are(
    speed: int, lyapunov: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = "orbitproof.verify.periodic_bifurcation.proved_torus.coefficients_of_torus"
    wide = TorusCoefficients(arb(speed, 0.75), arb(lyapunov, 0.75))
    assert (wide.speed * wide.lyapunov).contains(0)
    monkeypatch.setattr(place, lambda *_: wide)
    found = _proved(cases.round_claim(), _round())
    assert found.side == ("below" if speed * lyapunov > 0 else "above")


@pytest.mark.parametrize("parameter", ["w", "b", "d"])
def test_a_pair_that_stays_on_the_circle_is_refused(parameter: str) -> None:
    claim = cases.round_claim(parameter=parameter)
    assert _refused(claim, _enclose(claim)) == "bifurcation"


def test_without_damping_of_the_circle_there_is_no_curve_of_orbits() -> None:
    claim = cases.product_claim(k=Fraction(0))
    assert _refused(claim, _enclose(claim)) == "bifurcation"


@pytest.mark.parametrize("by", [Fraction(3), Fraction(-3)])
@pytest.mark.parametrize("place", [0, 1])
def test_a_box_beside_the_orbit_is_refused(place: int, by: Fraction) -> None:
    claim = cases.round_claim()
    centre = tuple(x + row[place] * by * WIDTH for x, row in zip(claim.centre, claim.frame, strict=True))
    moved = replace(claim, centre=centre)
    outcome = _outcome(moved, _enclose(moved))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"
    assert outcome.reason.excluded


@pytest.mark.parametrize(("by", "excluded"), [(Fraction(3), True), (Fraction(-3), True), (Fraction(1), False)])
def test_an_interval_of_the_parameter_beside_the_bifurcation_is_refused(by: Fraction, excluded: bool) -> None:
    claim = cases.round_claim()
    moved = replace(claim, parameters={**claim.parameters, "a": by * WIDTH})
    outcome = _outcome(moved, _enclose(moved))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"
    assert outcome.reason.excluded is excluded


@pytest.mark.parametrize("turns", [Fraction(1, 7), Fraction(5, 7), Fraction(2, 7) + Fraction(1, 2**27)])
def test_another_multiplier_is_refused(turns: Fraction) -> None:
    outcome = _outcome(cases.round_claim(multiplier=cases.on_circle(turns)), _round())
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"


def test_a_multiplier_that_is_near_is_excluded() -> None:
    outcome = _outcome(cases.round_claim(multiplier=cases.on_circle(Fraction(2, 7) + Fraction(1, 2**27))), _round())
    assert isinstance(outcome, NotProved)
    assert outcome.reason.excluded


@pytest.mark.parametrize("place", range(2))
@pytest.mark.parametrize("part", range(2))
def test_another_eigenvector_is_refused(part: int, place: int) -> None:
    claim = cases.round_claim()
    kernel = [list(row) for row in claim.kernel]
    kernel[part][place] += Fraction(1, 2**20)
    outcome = _outcome(replace(claim, kernel=tuple(map(tuple, kernel))), _round())
    assert isinstance(outcome, NotProved)
    assert (outcome.reason.condition, outcome.reason.excluded) == ("bifurcation", False)


def test_the_conjugate_pair_says_the_same() -> None:
    claim, (c, s) = cases.round_claim(), cases.on_circle(Fraction(2, 7))
    real, imaginary = claim.kernel
    found = _proved(replace(claim, kernel=(real, tuple(-x for x in imaginary)), multiplier=(c, -s)), _round())
    other = _proved(claim, _round())
    with guarded(BITS):
        assert agree(found.multiplier, other.multiplier.conjugate())
        assert agree(found.lyapunov, other.lyapunov)
    assert found.side == other.side


def test_a_longer_eigenvector_changes_the_coefficient_by_the_square_and_nothing_else() -> None:
    claim = cases.round_claim()
    longer = tuple(tuple(3 * x for x in row) for row in claim.kernel)
    found, other = _proved(replace(claim, kernel=longer), _round()), _proved(claim, _round())
    with guarded(BITS):
        assert agree(found.lyapunov, 9 * other.lyapunov)
    assert (found.side, found.criticality) == (other.side, other.criticality)


def _moved(claim: PeriodicBifurcation, unknown: str) -> PeriodicBifurcation:
    """The same with another centre in one of the unknowns; the zero stays in the box."""
    small, large = WIDTH / 2, cases.KERNEL_WIDTH / 8
    (u, v), multiplier = claim.kernel, claim.multiplier
    assert multiplier is not None
    changes: dict[str, dict[str, Any]] = {
        "p_0": {"centre": (1 + small, *claim.centre[1:])},
        "p_1": {"centre": (*claim.centre[:2], small)},
        "s": {"parameters": {**claim.parameters, "a": small}},
        "u": {"kernel": ((u[0], u[1] + large), v)},
        "v": {"kernel": (u, (v[0] + large, v[1]))},
        "cos": {"multiplier": (multiplier[0] + large, multiplier[1])},
        "sin": {"multiplier": (multiplier[0], multiplier[1] - large)},
    }
    return replace(claim, **changes[unknown])


@pytest.mark.parametrize("unknown", ["p_0", "p_1", "s", "u", "v", "cos", "sin"])
def test_what_is_found_does_not_depend_on_the_centre(unknown: str) -> None:
    claim = _moved(cases.round_claim(), unknown)
    found = _proved(claim, _round() if unknown in ("u", "v", "cos", "sin") else None)
    with ctx.workprec(500):
        turn = 2 * arb.pi()
        assert _contains(found.parameter, arb(0))
        assert _contains(found.period, turn)
        assert _contains(found.speed, turn)
        assert _contains(found.multiplier, (turn * acb(0, enclose(Fraction(2, 7)))).exp())
        assert all(_contains(found.point[name], arb(value)) for name, value in (("x", 1), ("y", 0), ("z", 0)))
    assert found.speed.rad() < 1e-7
    assert found.parameter.rad() < 1e-15


def test_a_narrow_box_of_eigenvectors_is_enough() -> None:
    """Their box is not where they have to be looked for: wherever the multiplier is one, its eigenvector is there."""
    found = _proved(cases.round_claim(kernel_radius=Fraction(1, 2**60)), _round())
    assert (found.side, found.criticality) == ("above", "supercritical")


def test_a_torus_seen_at_every_second_crossing_is_refused() -> None:
    claim = cases.product_claim(crossings=2, multiplier=cases.on_circle(Fraction(2, 5)))
    assert _refused(claim, _enclose(claim)) == "least-period"


def test_what_is_wrong_with_the_section_is_seen_exactly() -> None:
    assert _refused(cases.round_claim(direction=-1), _round()) == "direction"
    assert _refused(cases.round_claim(offset=Fraction(1, 2)), _round()) == "section"


@pytest.mark.parametrize(
    "change",
    [{"parameter": None, "level": Fraction(1)}, {"level": Fraction(1)}, {"multiplier": None}, {"parameter": None}],
)
def test_a_torus_takes_a_parameter_a_multiplier_and_no_level(change: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        cases.round_claim(**change)
    claim = replace(cases.round_claim(), system=replace(cases.ROUND, first_integral=lambda x, _: (x[0],)))
    with pytest.raises(InputError, match="level"):
        replace(claim, level=Fraction(1))


def test_a_claim_of_another_kind_is_no_torus() -> None:
    claim = cases.round_claim()
    other = replace(claim, kind=PERIODIC_DOUBLING, kernel=claim.kernel[:1], multiplier=None)
    with guarded(BITS):
        outcome = prove_torus(other, Checklist(), _round())
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "theorem"


def _of_map(known: KnownTorus, claim: PeriodicBifurcation) -> BifurcationEnclosures:
    """As if a known map were the return map of a claim."""
    size = len(known.derivatives)
    with guarded(BITS):
        return _tables(known, claim, size)


def _tables(known: KnownTorus, claim: PeriodicBifurcation, size: int) -> BifurcationEnclosures:
    sides = [*map(symmetric, claim.radii), symmetric(claim.parameter_radius)]
    indices = indices_up_to(size + 1, 3)

    def table(values: dict[tuple[int, ...], Fraction]) -> DerivativeTable:
        centre = {index: enclose(values.get(index, Fraction(0))) for index in indices}
        return DerivativeTable({index: over_box(centre, index, sides) for index in indices}, centre)

    time = table({(0,) * (size + 1): Fraction(1)})
    return BifurcationEnclosures((), tuple(map(table, known.derivatives)), time, None, 1, BITS, 1)


def _claim_of_map(known: KnownTorus) -> PeriodicBifurcation:
    def near(values: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        return tuple(Fraction(round(value * 2**100), 2**100) for value in values)

    cosine, sine = near(known.multiplier)
    kernel = tuple(map(near, known.eigenvector))
    return cases.product_claim(kernel=kernel, multiplier=(cosine, sine), kernel_radius=Fraction(1, 2**20))


@pytest.mark.parametrize("seed", range(5))
def test_maps_with_a_known_torus_are_proved_with_its_side_and_stability(seed: int) -> None:
    known = known_torus(3, random.Random(seed))
    claim = _claim_of_map(known)
    found = _proved(claim, _of_map(known, claim))
    with ctx.workprec(500):
        assert agree(found.lyapunov, enclose(known.lyapunov))
        assert agree(found.speed, enclose(known.speed))
        assert agree(found.multiplier, acb(*map(enclose, known.multiplier)))
        (other,) = found.multipliers.values
        assert agree(other, acb(enclose(known.others[0])))
    assert found.lyapunov.rad() < 1e-6
    assert found.side == ("above" if known.speed * known.lyapunov < 0 else "below")
    assert found.criticality == ("supercritical" if known.lyapunov < 0 else "subcritical")
    assert found.is_attracting is (known.lyapunov < 0 and abs(known.others[0]) < 1)


@pytest.mark.parametrize("seed", range(3))
def test_a_known_torus_seen_from_another_centre_is_where_it_is(seed: int) -> None:
    known = known_torus(3, random.Random(seed))
    claim = _claim_of_map(known)
    by = [WIDTH / 256 * sign for sign in (1, -1, 1, -1)]
    centre = tuple(
        x + sum(a * b for a, b in zip(row, by, strict=False)) for x, row in zip(claim.centre, claim.frame, strict=True)
    )
    moved = replace(claim, centre=centre, parameters={**claim.parameters, "a": by[-1]})
    seen = replace(known, derivatives=seen_from(known.derivatives, by))
    found = _proved(moved, _of_map(seen, moved))
    with guarded(BITS):
        assert found.parameter.contains(0)
        assert found.parameter.rad() < float(WIDTH / 2**20)
        assert agree(found.lyapunov, enclose(known.lyapunov))
        assert agree(found.speed, enclose(known.speed))
        (other,) = found.multipliers.values
        assert agree(other, acb(enclose(known.others[0])))
        assert found.multipliers.trivial == 1
        assert all(found.point[name].contains(value) for name, value in zip("xyuv", (1, 0, 0, 0), strict=True))


@pytest.mark.parametrize(("other", "conditions"), [(-1, ("others",)), (1, ("bifurcation", "others"))])
def test_another_multiplier_on_the_circle_is_refused(other: int, conditions: tuple[str, ...]) -> None:
    known = known_torus(3, random.Random(1), (Fraction(other),))
    claim = _claim_of_map(known)
    assert _refused(claim, _of_map(known, claim)) in conditions


def test_what_is_left_without_the_plane_of_the_pair_are_the_other_multipliers() -> None:
    known = known_torus(4, random.Random(0), (Fraction(1, 2), Fraction(-3)))
    size = len(known.derivatives)
    units = [tuple(int(i == j) for i in range(size + 1)) for j in range(size)]
    with guarded(BITS):
        matrix = [[enclose(each.get(unit, Fraction(0))) for unit in units] for each in known.derivatives]
        rest = without_plane(matrix, [acb(enclose(x), enclose(y)) for x, y in zip(*known.eigenvector, strict=True)])
        ((a, b), (c, d)) = rest
        assert agree(a + d, arb(-5) / 2)
        assert agree(a * d - b * c, arb(-3) / 2)
        assert (a + d).rad() < 1e-40


@pytest.mark.parametrize("kind", [PERIODIC_FOLD, PERIODIC_DOUBLING])
def test_a_torus_is_no_bifurcation_of_another_kind(kind: Any) -> None:
    claim = cases.round_claim()
    for vector in claim.kernel:
        other = replace(claim, kind=kind, kernel=(vector,), multiplier=None)
        assert not certify(other, Limits(digits=12)).proved
