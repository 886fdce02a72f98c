"""Bifurcations of periodic orbits without symmetry: what is proved of return maps in balls holds for each of them."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import pytest
from flint import acb, arb
from support import torus_cases
from support.balls import agree, first_of
from support.inclusion import Path, Refused, broken_inclusions, checked
from support.known_bifurcations import BITS, CASES, case, over_box
from support.normal_form_maps import known_torus
from support.thresholds import contradiction, unsound_balls
from support.within import within

from orbitproof.shared.formats import PERIODIC_TORUS, PeriodicBifurcation
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    enclose,
    guarded,
    index_factorial,
    indices_up_to,
    symmetric,
)
from orbitproof.verify.periodic import Multipliers
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    check_bifurcation_exactly,
    check_torus_exactly,
    prove_periodic_bifurcation,
    prove_torus,
    without_plane,
)
from orbitproof.verify.periodic_bifurcation.coefficients import flip_coefficients, fold_coefficients
from orbitproof.verify.periodic_bifurcation.equations import equations_of
from orbitproof.verify.periodic_bifurcation.extended_system import BifurcationPoint, check_extended, extended_matrix
from orbitproof.verify.periodic_bifurcation.proved_periodic_bifurcation import _squared, quotient
from orbitproof.verify.periodic_bifurcation.symmetry import _image_of, check_mirrored, signs_on_box
from orbitproof.verify.periodic_bifurcation.torus_system import check_torus_point, torus_matrix

Centres = dict[str, Any]
"""Derivatives at the centre: of each coordinate of the image, of the time, of the first integral if there is one."""

precision = within(lambda: guarded(BITS))


def numbers(count: int, chance: random.Random) -> list[arb]:
    return [arb(chance.uniform(-1, 1)) for _ in range(count)]


def centres_of(claim: PeriodicBifurcation, image: Any, integral: Any, chance: random.Random) -> Centres:
    """Those of a map, with a random time of its return."""
    indices = list(image[0])
    time = {index: arb(chance.uniform(-1, 1)) for index in indices}
    time[(0,) * len(indices[0])] = arb(6)
    return {"image": [dict(each) for each in image], "time": time} | (
        {} if integral is None else {"integral": dict(integral)}
    )


def enclosures(claim: PeriodicBifurcation, centres: Centres) -> BifurcationEnclosures:
    """On the box of a claim, the functions being polynomials of degree 3."""
    sides = list(map(symmetric, (*claim.radii, *([] if claim.parameter is None else [claim.parameter_radius]))))

    def table(centre: dict[tuple[int, ...], arb]) -> DerivativeTable:
        return DerivativeTable({index: over_box(centre, index, sides) for index in centre}, centre)

    integral = centres.get("integral")
    return BifurcationEnclosures(
        (), tuple(map(table, centres["image"])), table(centres["time"]), None if integral is None else table(integral),
        1, BITS, 1,
    )  # fmt: skip


def outcome_of(claim: PeriodicBifurcation, centres: Centres) -> Outcome[Any]:
    checklist, is_torus = Checklist(), claim.kind == PERIODIC_TORUS
    try:
        (check_torus_exactly if is_torus else check_bifurcation_exactly)(checklist, claim)
    except NotEstablishedError as error:
        return NotProved(error.reason, tuple(checklist.hypotheses))
    return (prove_torus if is_torus else prove_periodic_bifurcation)(claim, checklist, enclosures(claim, centres))


def results(claim: PeriodicBifurcation) -> Callable[[Centres], Any]:
    """What is proved, and shown on the way; of multipliers in any order what does not depend on it."""

    def found(centres: Centres) -> Any:
        outcome = outcome_of(claim, centres)
        if isinstance(outcome, NotProved):
            return Refused()
        values = dict(vars(outcome.results))
        multipliers: Multipliers = values.pop("multipliers")
        balls, size = multipliers.values, len(multipliers.values)
        sums = [sum((value**n for value in balls), acb(0)) for n in range(1, size + 1)] if balls else None
        return values, sums, [dict(hypothesis.enclosures) for hypothesis in outcome.hypotheses]

    return found


def along(claim: PeriodicBifurcation, centres: Centres, degree: int, chance: random.Random) -> Callable[[arb], Any]:
    """What is proved if a multiple of a random form is added to the derivatives of the image of an order."""
    forms = [{index: arb(chance.uniform(-1, 1)) for index in each if sum(index) == degree} for each in centres["image"]]

    def found(by: arb) -> Any:
        image = [
            {index: ball + by * form.get(index, arb(0)) for index, ball in each.items()}
            for each, form in zip(centres["image"], forms, strict=True)
        ]
        return results(claim)({**centres, "image": image})

    return found


def proves(claim: PeriodicBifurcation) -> Callable[[Centres], bool]:
    return lambda centres: isinstance(outcome_of(claim, centres), Proved)


def of_degree(*degrees: int) -> Callable[[Path], bool]:
    """Numbers of the image and of the integral that are derivatives of these orders."""
    return lambda path: path[0] != "time" and sum(path[-1]) in degrees


def known(kind: str, setting: str, seed: int) -> tuple[PeriodicBifurcation, Centres]:
    """A map in a frame without any symmetry, its centre and its level a little beside the bifurcation."""
    found, claim = case(kind, setting, seed)
    size = len(claim.radii) + (claim.parameter is not None)

    def balls(values: Mapping[tuple[int, ...], Fraction]) -> dict[tuple[int, ...], arb]:
        return {index: enclose(values.get((*index, 0)[: len(claim.radii) + 1], Fraction(0))) for index in indices}

    indices = indices_up_to(size, 3)
    integral = found.integral
    if integral is not None:
        integral = {index: value * index_factorial(index) for index, value in integral.items()}
    image = [balls(each) for each in found.derivatives]
    return claim, centres_of(claim, image, None if integral is None else balls(integral), random.Random(seed))


def torus(seed: int) -> tuple[PeriodicBifurcation, Centres]:
    found = known_torus(3, random.Random(seed))

    def near(values: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        return tuple(Fraction(round(value * 2**100), 2**100) for value in values)

    claim = torus_cases.product_claim(
        kernel=tuple(map(near, found.eigenvector)), multiplier=near(found.multiplier), kernel_radius=Fraction(1, 2**20)
    )
    image = [
        {index: enclose(each.get(index, Fraction(0))) for index in indices_up_to(4, 3)} for each in found.derivatives
    ]
    return claim, centres_of(claim, image, None, random.Random(seed))


CLAIMS = {f"{kind} {setting}": (kind, setting) for kind, setting in CASES}


@pytest.mark.parametrize("name", CLAIMS)
def test_what_is_proved_of_maps_in_balls_holds_for_each_of_them(name: str) -> None:
    chance = random.Random(name)
    kind, setting = CLAIMS[name]
    claim, centres = known(kind, setting, 5 if name == "periodic-doubling free" else 4)
    assert not broken_inclusions(
        results(claim), (centres,), chance, 9, arb(2) ** -68, lambda path: of_degree(0, 1)(path[1:])
    )
    for degree in (2, 3) if kind != "periodic-fold" else (2,):
        assert not broken_inclusions(along(claim, centres, degree, chance), (arb(0),), chance, 1, arb(2) ** -24), degree
    assert not broken_inclusions(
        lambda time: results(claim)({**centres, "time": time}), (centres["time"],), chance, 4, arb(2) ** -20,
        lambda path: sum(path[-1]) < 1,
    )  # fmt: skip


@pytest.mark.parametrize("name", CLAIMS)
def test_maps_that_are_refused_are_refused_in_balls_too(name: str) -> None:
    chance = random.Random(name)
    claim, centres = known(*CLAIMS[name], 5 if name == "periodic-fold free" else 4)
    # Which equation the first integral replaces is chosen by the middles of its slopes.
    of_image = of_degree(0, 1)
    assert not unsound_balls(
        proves(claim), centres, chance, 5, (-140, 4), lambda path: path[0] == "image" and of_image(path)
    )


@pytest.mark.parametrize("name", CLAIMS)
def test_no_side_is_told_of_maps_with_new_orbits_on_both(name: str) -> None:
    chance = random.Random(name)
    claim, centres = known(*CLAIMS[name], 4)
    kind, _ = CLAIMS[name]
    assert not contradiction(along(claim, centres, 2 if kind == "periodic-fold" else 3, chance), [arb(40), arb(2000)])


@pytest.mark.parametrize("seed", range(2))
def test_the_same_of_tori(seed: int) -> None:
    chance = random.Random(seed)
    claim, centres = torus(seed)
    assert not broken_inclusions(
        results(claim), (centres,), chance, 4, arb(2) ** -48, lambda path: of_degree(0, 1)(path[1:])
    )
    for degree in (2, 3):
        assert not broken_inclusions(along(claim, centres, degree, chance), (arb(0),), chance, 1, arb(2) ** -24), degree
    assert not contradiction(along(claim, centres, 3, chance), [arb(100)])
    assert not unsound_balls(proves(claim), centres, chance, 3, (-120, 4), of_degree(0, 1))


@pytest.mark.parametrize(
    "name", ["periodic-fold free", "periodic-doubling parameter on a level", "moved free", "torus"]
)
def test_places_and_eigenvectors_lie_in_their_balls(name: str) -> None:
    chance = random.Random(name)
    claim, centres = torus(0) if name == "torus" else known(*CLAIMS[name], 4)
    size = arb(2) ** (-48 if name == "torus" else -68)

    def found(centres: Centres) -> Any:
        equations = equations_of(claim, enclosures(claim, centres))
        place: Any = (check_torus_point if name == "torus" else check_extended)(Checklist(), claim, equations)
        return vars(place)

    assert not broken_inclusions(found, (centres,), chance, 6, size, lambda path: of_degree(0, 1)(path[1:]))


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
@pytest.mark.parametrize("setting", ["free", "parameter on a level"])
def test_coefficients_depend_on_each_derivative_by_itself(kind: str, setting: str) -> None:
    """The place being given: by the left kernel alone, by the curve of orbits, by third derivatives."""
    chance = random.Random(kind + setting)
    claim, centres = known(kind, setting, 5)
    size = len(claim.radii)
    place = BifurcationPoint(tuple(arb(0) for _ in range(size + 1)), tuple(map(enclose, claim.kernel[0])))
    coefficients = fold_coefficients if kind == "periodic-fold" else flip_coefficients

    def found(centres: Centres, kernel: Any) -> Any:
        equations = equations_of(claim, enclosures(claim, centres))
        given = coefficients(equations, BifurcationPoint(place.where, tuple(kernel)), place.kernel)
        # Which component of l is 1 is chosen by the middles of balls.
        return given.opening, given.pairing / given.speed

    for degree in (1, 2, 3) if kind == "periodic-doubling" else (1, 2):
        of_centres = partial(first_of, found, place.kernel)
        assert not broken_inclusions(
            # Which equation the first integral replaces is chosen by the middles of its slopes.
            of_centres,
            (centres,),
            chance,
            7,
            arb(2) ** -30,
            lambda path, d=degree: path[1] == "image" and of_degree(d)(path[1:]),
        ), degree
    assert not broken_inclusions(lambda kernel: found(centres, kernel), (list(place.kernel),), chance)


def test_the_parts_of_the_equations_depend_on_the_balls_that_they_are_found_from() -> None:
    chance = random.Random(1)
    claim, centres = known("periodic-doubling", "parameter on a level", 5)
    wide = replace(claim, radii=(Fraction(1, 4),) * len(claim.radii), parameter_radius=Fraction(1, 4))
    equations = equations_of(wide, enclosures(wide, centres))
    size = equations.size
    where = [arb(chance.uniform(-0.2, 0.2)) for _ in range(size + 1)]
    u, v = numbers(size, chance), numbers(size, chance)

    def at(where: Any, u: Any, v: Any) -> Any:
        longer = [*u, v[0]]
        return (
            equations.values(where), equations.slopes(where), equations.minus(v[0], equations.slopes(where)),
            equations.curvatures(where, longer), equations.cubic(where, longer),
            extended_matrix(equations, where, u, -1, v), torus_matrix(equations, where, u, v, acb(u[0], v[0]), (u, v)),
        )  # fmt: skip

    assert not broken_inclusions(at, (where, u, v), chance, 10)
    matrix = [numbers(3, chance) for _ in range(3)]
    assert not broken_inclusions(quotient, (matrix, [arb(0.2), arb(1), arb(-0.4)]), chance, 10)
    assert not broken_inclusions(lambda rows: _squared(rows), (matrix,), chance)
    real, imaginary = numbers(3, chance), numbers(3, chance)
    assert not broken_inclusions(
        lambda rows, a, b: without_plane(rows, list(map(acb, a, b))), (matrix, real, imaginary), chance, 10
    )


@pytest.mark.parametrize("kind", ["fixed", "moved"])
def test_where_a_symmetry_takes_the_point_and_its_eigenvector(kind: str) -> None:
    """S without any symmetry of its own: S x in the coordinates of the box, at points of it."""
    for seed in (3, 4):
        chance = random.Random(seed)
        claim, _ = known(kind, "free", seed)
        rows, size = claim.symmetry, len(claim.radii)
        assert rows is not None
        assert any(rows[i][j] != rows[j][i] for i in range(size + 1) for j in range(i))
        signs = signs_on_box(claim)
        assert (signs is None) is (kind == "moved")
        p = [Fraction(chance.randint(-8, 8), 8) for _ in range(size)]
        kernel = tuple(map(enclose, claim.kernel[0]))
        place = BifurcationPoint((*map(enclose, p), arb(0)), kernel)
        state = [x + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0))
                 for x, row in zip(claim.centre, claim.frame, strict=True)]  # fmt: skip
        image = [sum((a * b for a, b in zip(row, state, strict=True)), Fraction(0)) for row in rows]
        found = _image_of(claim, place)
        back = [x + sum((enclose(a) * b for a, b in zip(row, found, strict=True)), arb(0))
                for x, row in zip(map(enclose, claim.centre), claim.frame, strict=True)]  # fmt: skip
        assert all(agree(ball, enclose(value)) for ball, value in zip(back, image, strict=True))
        assert all(ball.rad() < 1e-30 for ball in back)

        def mirrored(where: Any, kernel: Any, claim: PeriodicBifurcation = claim) -> Any:
            return checked(check_mirrored, claim, BifurcationPoint(tuple(where), tuple(kernel)))

        if kind == "moved":
            assert not broken_inclusions(partial(mirrored, kernel=kernel), (list(place.where),), chance)
        else:
            assert signs is not None
            odd = [j for j, sign in enumerate(signs) if sign < 0]
            for j in odd:
                # One odd component is enough, and it takes one that is certainly not 0.
                alone = [arb(1, 0.5) if i == j or i not in odd else arb(0, 1) for i in range(size)]
                assert mirrored(place.where, alone)[0] is True
            with pytest.raises(NotEstablishedError, match="eigenvector"):
                mirrored(place.where, [arb(0.25, 1) if i in odd else arb(1) for i in range(size)])
