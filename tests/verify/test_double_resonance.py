"""Where two resonances meet: equations of known maps, false claims, the point on the halo family of L2."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import comb, factorial, prod
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from flint import arb, ctx
from support.balls import agree
from support.told import in_full

from orbitproof.explore.numerics import working_context
from orbitproof.explore.points import refine_at
from orbitproof.explore.refinement.double_resonance import _Equations
from orbitproof.shared.claims import DOUBLE_RESONANCE, Candidate
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import candidate_from_json, candidate_to_json, read_claims, validate_document
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_PLANAR, FALKNER_SKAN, ReversibleSystem
from orbitproof.verify.attempt.precision import Limits
from orbitproof.verify.certificate.certificate import Certificate
from orbitproof.verify.certificate.certifying import certify
from orbitproof.verify.certificate.rechecking import recheck
from orbitproof.verify.double_resonance import (
    ResonanceEnclosures,
    ResonanceResults,
    ResonanceTheorem,
    Unfolding,
    check_resonance_exactly,
    prove_resonance,
    theorem_of_resonance,
)
from orbitproof.verify.double_resonance.proved_double_resonance import _check_unfolding
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    enclose,
    indices_up_to,
    symmetric,
)

NAMES = ("mu", "x", "z", "vy")
CLAIM = Path(__file__).parents[1] / "data" / "double-resonance.json"
RADIUS = Fraction(1, 2**16)
Powers = tuple[int, ...]
Polynomial = Mapping[Powers, Fraction]


def unit(size: int, place: int) -> Powers:
    return tuple(int(i == place) for i in range(size))


def substituted(polynomial: Polynomial, rows: list[list[Fraction]]) -> Polynomial:
    """The polynomial of `rows` times the variables."""
    size = len(rows)
    result: dict[Powers, Fraction] = {}
    for powers, value in polynomial.items():
        part = {(0,) * size: Fraction(value)}
        for row, power in zip(rows, powers, strict=True):
            for _ in range(power):
                more: dict[Powers, Fraction] = {}
                for (index, c), (j, entry) in product(part.items(), enumerate(row)):
                    key = tuple(e + (i == j) for i, e in enumerate(index))
                    more[key] = more.get(key, Fraction(0)) + c * entry
                part = more
        for index, c in part.items():
            result[index] = result.get(index, Fraction(0)) + c
    return result


def table(polynomial: Polynomial, frame: list[list[Fraction]], radii: tuple[Fraction, ...]) -> DerivativeTable:
    """Derivatives in p of a polynomial in x = frame p, on the box and at its centre."""
    size, in_p = len(frame), substituted(polynomial, frame)
    sides = [symmetric(radius) for radius in radii]

    def derivative(index: Powers, where: list[arb]) -> arb:
        value = arb(0)
        for powers, c in in_p.items():
            if all(a <= b for a, b in zip(index, powers, strict=True)):
                factor = prod(comb(b, a) * factorial(a) for a, b in zip(index, powers, strict=True))
                term = enclose(c * factor)
                for ball, a, b in zip(where, index, powers, strict=True):
                    for _ in range(b - a):
                        term = term * ball
                value = value + term
        return value

    indices, zero = indices_up_to(size, 3), [arb(0)] * size
    return DerivativeTable({i: derivative(i, sides) for i in indices}, {i: derivative(i, zero) for i in indices})


SLOPE, CURVATURE = Fraction(-3), Fraction(5, 2)


def model(
    system: ReversibleSystem,
    slope: Fraction = SLOPE,
    curvature: Fraction = CURVATURE,
    other: Fraction = Fraction(2),
    value: Fraction = Fraction(0),
    beside: Fraction = Fraction(0),
) -> tuple[list[Polynomial], list[Polynomial]]:
    """q of P and u of P^2 in (mu, u): the family is u_1 + 3 mu = 0, u_2 = 0, described by y = u_0, with the stability
    parameters value + slope mu + curvature y^2/2 + beside u_1, and `other`.
    """
    size = 1 + len(system.fixed_coordinates)
    across = range(2, size)
    kernel: list[Polynomial] = [{unit(size, i): Fraction(2)} for i in across]
    kernel[0] = {**kernel[0], unit(size, 0): Fraction(6)}
    image: list[Polynomial] = [{unit(size, 1): Fraction(1), unit(size, 2): Fraction(7)}]
    y, first = unit(size, 1), unit(size, 2)
    image.append({
        first: value,
        tuple(a + b for a, b in zip(unit(size, 0), first, strict=True)): slope,
        tuple(2 * a + b for a, b in zip(y, first, strict=True)): curvature / 2,
        tuple(2 * a for a in first): beside / 2,
    })  # fmt: skip
    image += [{unit(size, i): other} for i in range(3, size)]
    return kernel, image


MIXED = [[1, 2, 0, 1], [0, 1, 0, 0], [1, 0, 1, 0], [0, 1, 0, 3]]
"""A frame in which no coordinate is one of the box."""


TILT, SHIFT, BESIDE = Fraction(1, 2), Fraction(5), Fraction(1, 3)


def shifted(system: ReversibleSystem) -> tuple[list[Polynomial], list[Polynomial]]:
    """The model where S depends on u_1 too, which is - 3 mu on the family."""
    return model(system, SLOPE + 3 * BESIDE, beside=BESIDE)


def tilted(system: ReversibleSystem) -> tuple[list[Polynomial], list[Polynomial]]:
    """The same with u_1 - TILT y - SHIFT mu in place of u_1: a family with y as one of two coordinates that change."""
    kernel, image = shifted(system)
    size = 1 + len(system.fixed_coordinates)
    rows = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    rows[2][0], rows[2][1] = -SHIFT, -TILT
    kernel, image = ([substituted(each, rows) for each in group] for group in (kernel, image))
    moved = {
        key: image[1].get(key, Fraction(0)) + TILT * image[0].get(key, Fraction(0)) for key in {*image[0], *image[1]}
    }
    moved[unit(size, 0)] = moved.get(unit(size, 0), Fraction(0)) + SHIFT
    return kernel, [image[0], moved, *image[2:]]


def claim(system: ReversibleSystem, k: int = 4, frame: list[list[Fraction]] | None = None) -> Candidate:
    size, n = 1 + len(system.fixed_coordinates), len(system.kernel_coordinates)
    rows = frame or [list(map(Fraction, unit(size, i))) for i in range(size)]
    return Candidate(
        id="model",
        system=system,
        parameters={},
        kind=DOUBLE_RESONANCE,
        k=k,
        centre=(Fraction(1, 4), *(Fraction(1, 8),) * (size - 1)),
        frame=tuple(map(tuple, rows)),
        kernel_frame=tuple(tuple(map(Fraction, unit(n, i))) for i in range(n)),
        radii=(RADIUS,) * size,
    )


def prove(candidate: Candidate, functions: tuple[list[Polynomial], list[Polynomial]]) -> Outcome[ResonanceResults]:
    frame = [list(row) for row in candidate.frame]
    kernel, image = ([table(each, frame, candidate.radii) for each in group] for group in functions)
    one = table({(0,) * len(frame): Fraction(3, 2)}, frame, candidate.radii)
    checklist = Checklist()
    with ctx.workprec(120):
        check_resonance_exactly(checklist, candidate)
        found = ResonanceEnclosures((tuple(kernel),), tuple(image), one, one)
        return prove_resonance(candidate, checklist, found)


@pytest.mark.parametrize("system", [CR3BP_PLANAR, CR3BP], ids=["one pair", "two pairs"])
@pytest.mark.parametrize("functions", [shifted, tilted])
@pytest.mark.parametrize("mixed", [False, True])
def test_the_meeting_of_a_known_map_is_found(
    system: ReversibleSystem,
    mixed: bool,
    functions: Callable[[ReversibleSystem], tuple[list[Polynomial], list[Polynomial]]],
) -> None:
    """s = slope mu + curvature y^2/2: two resonances where mu has the sign of - curvature/slope."""
    size = 1 + len(system.fixed_coordinates)
    frame = [[Fraction(value) for value in row[:size]] for row in MIXED[:size]] if mixed else None
    candidate = claim(system, frame=frame)
    with ctx.workprec(120):
        outcome = prove(candidate, functions(system))
    assert isinstance(outcome, Proved), outcome.reason
    found = outcome.results
    assert tuple(entry.name for entry in outcome.hypotheses) == ResonanceTheorem(candidate).hypotheses
    for name, middle in zip(candidate.coordinates, candidate.centre, strict=True):
        assert found.point[name].contains(enclose(middle))
        assert float(found.point[name].rad()) < 1e-6
    assert found.slope.contains(enclose(SLOPE))
    assert found.curvature.contains(enclose(CURVATURE))
    assert agree(found.opening, enclose(-CURVATURE / (2 * SLOPE)))
    assert float(found.opening.rad()) < 1e-12
    assert (found.side, found.extremum, found.turn, found.along) == ("above", "minimum", 1, "x")
    assert found.period == 3


@pytest.mark.parametrize(
    "k, value, turn", [(2, -1.0, 1), (3, -0.5, 1), (5, 0.309016994374947, 1), (5, -0.809016994374947, 2)]
)
def test_which_multiple_it_is_follows_from_the_numbers(k: int, value: float, turn: int) -> None:
    """s is within 1e-15 of cos(2 pi j/k), and passes it inside the box."""
    outcome = prove(claim(CR3BP, k), model(CR3BP, value=Fraction(value)))
    assert isinstance(outcome, Proved), outcome.reason
    assert outcome.results.turn == turn
    # 1:3 is not taken for 2:6.
    assert isinstance(prove(claim(CR3BP, 6), model(CR3BP, value=Fraction(-1, 2))), NotProved)


@pytest.mark.parametrize(
    "changes, condition",
    [
        ({"value": Fraction(1, 10)}, "point"), ({"slope": Fraction(0)}, "point"), ({"curvature": Fraction(0)}, "point"),
        ({"other": Fraction(0)}, "point"),
    ],
    ids=["another value", "the value stays", "no extremum", "both parameters"],
)  # fmt: skip
def test_what_does_not_meet_is_not_proved(changes: dict[str, Fraction], condition: str) -> None:
    outcome = prove(claim(CR3BP), model(CR3BP, **changes))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == condition


def test_two_parameters_that_are_equal_there_are_not_proved() -> None:
    """f = det(c - S) has a regular zero with g = 0 although c is double: s_1 and s_2 meet there and become complex."""
    kernel, image = model(CR3BP)
    size, second, third = 4, unit(4, 2), unit(4, 3)
    by = lambda place, power: tuple(power * a + b for a, b in zip(unit(size, place), second, strict=True))  # noqa: E731
    # The block [[0, 1], [a, 0]] with a = slope mu + curvature y^2/2.
    image = [image[0], {third: Fraction(1)}, {by(0, 1): SLOPE, by(1, 2): CURVATURE / 2}]
    outcome = prove(claim(CR3BP), (kernel, image))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "simple"


def test_a_family_that_is_no_curve_is_not_proved() -> None:
    kernel, image = model(CR3BP)
    outcome = prove(claim(CR3BP), ([kernel[0], {unit(4, 2): Fraction(2)}], image))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "family"


def test_a_stationary_value_out_of_the_box_is_refused_for_good() -> None:
    outcome = prove(claim(CR3BP), model(CR3BP, value=Fraction(1, 10)))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.excluded


def test_a_half_period_that_is_negative_proves_nothing() -> None:
    candidate = claim(CR3BP)
    frame = [list(row) for row in candidate.frame]
    kernel, image = ([table(each, frame, candidate.radii) for each in group] for group in model(CR3BP))
    one = table({(0,) * 4: Fraction(3, 2)}, frame, candidate.radii)
    outcome = prove_resonance(
        candidate, Checklist(), ResonanceEnclosures((tuple(kernel),), tuple(image), negative(one), one)
    )
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "return-map"


def test_half_orbits_that_may_be_shorter_are_not_proved() -> None:
    candidate = replace(claim(CR3BP), crossings=2)
    frame = [list(row) for row in candidate.frame]
    kernel, image = (tuple(table(each, frame, candidate.radii) for each in group) for group in model(CR3BP))
    one = table({(0,) * 4: Fraction(3, 2)}, frame, candidate.radii)
    for first, proved in ((kernel, False), ((one, kernel[1]), True)):
        with ctx.workprec(120):
            checklist = Checklist()
            check_resonance_exactly(checklist, candidate)
            outcome = prove_resonance(candidate, checklist, ResonanceEnclosures((first, kernel), image, one, one))
        assert isinstance(outcome, Proved) is proved
        assert proved or (isinstance(outcome, NotProved) and outcome.reason.condition == "half-orbit")


@pytest.mark.parametrize("slope, curvature", [(arb(1, 2), arb(1)), (arb(1), arb(1, 2)), (arb(1), arb("nan"))])
def test_coefficients_that_may_be_0_show_no_unfolding(slope: arb, curvature: arb) -> None:
    with pytest.raises(NotEstablishedError) as error:
        _check_unfolding(Checklist(), Unfolding(slope, curvature, arb(1)))
    assert error.value.reason.condition == "unfolding"


def negative(given: DerivativeTable) -> DerivativeTable:
    box, centre = ({key: -ball for key, ball in part.items()} for part in (given.box, given.centre))
    return DerivativeTable(box, centre)


def test_a_box_beyond_the_values_of_the_parameter_is_refused() -> None:
    candidate = replace(claim(CR3BP), centre=(RADIUS / 2, *(Fraction(1, 8),) * 3))
    with pytest.raises(NotEstablishedError) as error:
        check_resonance_exactly(Checklist(), candidate)
    assert error.value.reason.condition == "parameter"
    assert not isinstance(theorem_of_resonance(candidate), NotProved)


def test_systems_in_units_of_their_own_have_no_such_theorem() -> None:
    for system in (*AROUND.values(), FALKNER_SKAN):
        assert isinstance(theorem_of_resonance(cast(Any, SimpleNamespace(resonances_meet=True, system=system))), Reason)


def test_the_words_say_what_meets_and_where() -> None:
    candidate = claim(CR3BP)
    outcome = prove(candidate, model(CR3BP))
    assert isinstance(outcome, Proved)
    text = in_full(candidate, ResonanceTheorem(candidate), outcome.results)
    assert "the parameter mu and those of Fix(R)" in text
    assert "two 1:4 resonances meet" in text
    assert "has a minimum along the family" in text
    assert "exist for values of mu greater than that" in text


@pytest.mark.parametrize(
    "changes, field",
    [
        ({"k": 1}, "kind"), ({"parameters": {"mu": Fraction(1, 4)}}, "parameters"), ({"symmetry": "S"}, "kind"),
        ({"level_sign": 1}, "kind"), ({"system": FALKNER_SKAN}, "parameters"),
        ({"centre": (Fraction(1),) * 3}, "centre"),
    ],
)  # fmt: skip
def test_a_claim_that_makes_no_sense_is_refused(changes: dict[str, object], field: str) -> None:
    with pytest.raises(InputError, match=f"^{field}"):
        replace(claim(CR3BP), **changes)  # type: ignore[arg-type]


def test_a_claim_is_written_and_read() -> None:
    (candidate,) = read_claims(CLAIM)
    assert isinstance(candidate, Candidate)
    entry = candidate_to_json(candidate)
    validate_document({"format": "orbitproof-candidates", "version": 1, "candidates": [entry]}, "candidates", "here")
    assert candidate_from_json(entry, "here") == candidate
    assert candidate.coordinates == NAMES
    with pytest.raises(InputError, match="all but one of these"):
        candidate_from_json({**entry, "parameters": {"mu": "1e-3"}}, "here")
    with pytest.raises(InputError, match="give exactly these"):
        candidate_from_json({**entry, "kind": "orbit", "k": 1}, "here")


def test_the_equations_of_the_search_vanish_at_the_certified_point() -> None:
    (candidate,) = read_claims(CLAIM)
    assert isinstance(candidate, Candidate)
    place = _Equations(CR3BP, {}, 4, 1, working_context(80))
    kernel, image = place.jets(candidate.centre, 1)
    values = [*(jet.coefficients[0] for jet in kernel), place.defect(image, 1).coefficients[0]]
    assert max(map(abs, values)) < 1e-15
    assert place.nearest_turn(candidate.centre) == 1


@pytest.mark.slow
def test_a_point_known_to_five_digits_is_refined_to_the_claim() -> None:
    """The command is that of `orbitproof explore refine --help`; half a minute."""
    (candidate,) = read_claims(CLAIM)
    point = {name: float(f"{float(value):.6g}") for name, value in zip(NAMES, candidate.centre, strict=True)}
    found = refine_at(CR3BP, point, 4, kind=DOUBLE_RESONANCE, digits=30, quiet=True)
    assert max(abs(a - b) for a, b in zip(found.centre, candidate.centre, strict=True)) < Fraction(1, 10**30)


@pytest.mark.parametrize("changes", [{"k": 1}, {"point": dict.fromkeys("xyz", 0.1)}, {"symmetry": "S"}])
def test_what_cannot_be_refined_is_said(changes: dict[str, object]) -> None:
    given = {"system": CR3BP, "point": dict.fromkeys(NAMES, 0.1), "k": 4, **changes}
    with pytest.raises(ValueError, match="needs k > 1, no symmetry, a system with a first integral"):
        refine_at(kind=DOUBLE_RESONANCE, quiet=True, **given)  # type: ignore[arg-type]


@pytest.mark.slow
def test_two_resonances_of_the_halo_family_of_l2_meet_between_the_masses() -> None:
    """Proved, read again and checked with another integration; about a minute."""
    (candidate,) = read_claims(CLAIM)
    proof = certify(candidate, Limits(digits=20))
    assert proof.proved, proof.reason
    assert isinstance(proof.results, ResonanceResults)
    assert agree(proof.results.parameter, arb("0.00352111037365612532914676577419611763786 +/- 1e-38"))
    assert agree(proof.results.level, arb("3.0135165200634744440114103542299713886 +/- 1e-36"))
    assert (proof.side, proof.results.turn, proof.results.extremum) == ("above", 1, "minimum")
    again = Certificate.from_json(proof.to_json(), "here")
    assert recheck(again, integrate=True).stands
    moved = replace(candidate, centre=(candidate.centre[0] + Fraction(1, 2**60), *candidate.centre[1:]))
    assert not certify(moved, Limits(digits=20)).proved
