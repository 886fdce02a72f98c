"""Fixed levels of integrals that are not A + b w^2: w as an element, exact rows, refusals where w does not follow."""

from __future__ import annotations

import json
import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from math import sqrt
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support.balls import agree

from orbitproof.explore.points import refine_at
from orbitproof.explore.refinement import OrbitTask, refine, refine_orbit
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, Candidate, Equation, candidate_from_json, load_system
from orbitproof.shared.formats import candidate_to_json as to_json
from orbitproof.shared.systems import (
    DescriptionError,
    FixedLevel,
    ReversibleSystem,
    completed,
    describe,
    described,
    record,
    with_slope,
)
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic, without_time
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify, recheck
from orbitproof.verify.claim import LevelEquation, check_level, is_in, on_box
from orbitproof.verify.evidence import Checklist, IntegrationFailure, NotEstablishedError, enclose, excludes_zero, power
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings, at_start, initial_values, level_set, on_sheet
from orbitproof.verify.poincare.derivatives import derivative_table
from orbitproof.verify.reversor_breaking import check_sheet, enclose_breaking, following

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
LIMITS = Limits(max_precision=256)

CUBIC = {
    "name": "brakes",
    "state": ["x", "y", "vx", "vy"],
    "parameters": ["a"],
    "field": {"x": "vx", "y": "vy", "vx": "-x - 2*a*x*y", "vy": "-y - a*x**2 + y**2"},
    "R": {"vx": -1, "vy": -1},
    "section": "vy",
    "family_parameter": "a",
    "first_integral": "(vx**2 + vy**2 + x**2 + y**2)/2 + a*x**2*y - y**3/3",
    "level_coordinate": "y",
    "fixed_level": {"value": "1/12", "between": ["-1", "-1/10"]},
}
"""Orbits from rest to rest: the level is that of a potential, a cubic in y with three solutions."""


@cache
def relativistic() -> ReversibleSystem:
    return load_system(EXAMPLES / "relativistic.py")


@cache
def claimed() -> Candidate:
    return refine(relativistic(), {}, "period_tupling", 2, [0.6414622, 0.6756299], digits=40).to_candidate("two", {})


@cache
def certificate() -> Certificate:
    return certify(claimed(), LIMITS)


def on(system: ReversibleSystem, low: Any, high: Any, value: Any = None) -> ReversibleSystem:
    """The system with its level coordinate in another interval, on the same level or another one."""
    assert system.fixed_level is not None
    height = system.fixed_level.value if value is None else F(value)
    return replace(system, fixed_level=FixedLevel(height, between=(F(low), F(high))))


def refusal(system: ReversibleSystem) -> str:
    """The condition that fails where the claim is made of another system."""
    proof = certify(replace(claimed(), system=system), LIMITS)
    return "proved" if proof.reason is None else proof.reason.condition


# The coordinate as an element of the algebra.


def box(arithmetic: Arithmetic, centre: Mapping[str, F], spread: F) -> dict[str, Series]:
    """Points about a centre: one variable for each coordinate."""
    size = len(arithmetic.grading.weights)
    units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
    return {
        name: arithmetic.polynomial({(0,) * size: value, unit: spread})
        for (name, value), unit in zip(centre.items(), units, strict=True)
    }


ROOT = record(lambda x: (x[0] ** F(1, 2),), ("x",))
ARITHMETICS = {
    "narrow": (Arithmetic(Grading((2, 1), 3), 160, 0, 4), F(1, 2**40)),
    "coarse": (Arithmetic(Grading((1, 1), 2), 120, 0, 2), F(1, 64)),
    "wide": (WideArithmetic(Grading((1, 1), 1), 100, 0, 2, width=20), F(1, 2**30)),
}


@pytest.mark.parametrize("kind", ARITHMETICS)
def test_the_coordinate_contains_the_root_in_closed_form(kind: str) -> None:
    arithmetic, spread = ARITHMETICS[kind]
    system, source = relativistic(), random.Random(kind)
    for _ in range(6):
        centre = {"a": F(source.randint(-40, 40), 64), "y": F(source.randint(-50, 50), 64)}
        point = box(arithmetic, centre, spread)
        if kind == "wide":
            along = arithmetic.polynomial({(0, 0): [F(0), F(source.randint(-9, 9), 64), F(1, 128)]})
            point["y"] = point["y"] + along
        values = initial_values(system, arithmetic, point)
        w = values[system.state.index("px")]
        # E = 3/2 with x = py = 0: px = ((3/2 - y^2/2)^2 - 1)^(1/2), by the corrected power of the algebra.
        y, one = point["y"], arithmetic.constant(F(1))
        energy = arithmetic.constant(F(3, 2)) - (y * y).scaled(F(1, 2))
        (root,) = at_start(ROOT, [energy * energy - one])
        difference = w - root
        assert all(a <= b for a, b in zip(difference.known, difference.errors, strict=True))
        assert max(w.errors) < 16 * max(root.errors)


@pytest.mark.parametrize("kind", ARITHMETICS)
def test_far_from_a_root_the_contraction_contains_it_or_nothing_is_said(kind: str) -> None:
    arithmetic, spread = ARITHMETICS[kind]
    system, source, said = relativistic(), random.Random(kind), 0
    equation = LevelEquation.of(system)
    point = box(arithmetic, {"a": F(1, 3), "y": F(1, 4)}, spread)
    values = [without_time(value) for value in initial_values(system, arithmetic, point)]
    root = values[equation.place]
    for _ in range(40):
        offset = F(source.randint(-1000, 1000), source.choice([1000, 3000, 10**5, 10**9]))
        start = Series(root.arithmetic, root.coefs, root.arithmetic.zero_errors())
        start = start + root.arithmetic.constant(offset)
        try:
            found = level_set._enclosed(equation, values, start)
        except IntegrationFailure:
            continue
        said += 1
        difference = found - root
        assert all(a <= b for a, b in zip(difference.known, difference.errors, strict=True))
    assert said >= 10


def test_what_the_slope_carries_from_grade_to_grade_is_in_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """w u + 1 = 0, begun at w = 0 with a factor 13/20 far from 1/u: grade 1 of the bound comes from grade 0."""
    arithmetic = Arithmetic(Grading((1,), 2), 100, 0, 0)
    factor = arithmetic.constant(F(13, 20))
    u = arithmetic.polynomial({(0,): F(1), (1,): F(3, 20)})
    program = record(lambda s: (s[0] * s[1] + 1,), ("w", "u"))
    equation = LevelEquation("w", 0, with_slope(program, "w"), FixedLevel(F(0), between=(F(-2), F(2))))
    monkeypatch.setattr(level_set, "_newton", lambda _equation, _values, w: (factor * (w * u + one), factor))
    one, start = arithmetic.constant(F(1)), arithmetic.constant(F(0))
    found = level_set._enclosed(equation, [start, u], start)
    (inverse,) = at_start(record(lambda s: (-1 / s[0],), ("u",)), [u])
    difference = found - inverse
    assert all(a <= b for a, b in zip(difference.known, found.errors, strict=True))


def test_the_coordinate_is_the_one_of_its_sign_where_both_say_which() -> None:
    system = relativistic()
    integral = "(px**2 + py**2 + x**2 + y**2)/2 + a*x**2*y"
    entry = {**CUBIC, "state": ["x", "y", "px", "py"], "R": {"x": -1, "py": -1}, "section": "py",
             "field": {"x": "px", "y": "py", "px": "-x - 2*a*x*y", "py": "-y - a*x**2"},
             "first_integral": integral, "level_coordinate": "px"}  # fmt: skip
    arithmetic, spread = ARITHMETICS["narrow"]
    for sign in (1, -1):
        ends = sorted((sign * F(1, 100), sign * F(3)))
        levels = ({"value": "1/2", "sign": sign}, {"value": "1/2", "between": [str(end) for end in ends]})
        first, second = (described({**entry, "fixed_level": level}) for level in levels)
        point = box(arithmetic, {"a": F(1, 3), "y": F(1, 4)}, spread)
        one, other = (initial_values(each, arithmetic, point)[2] for each in (first, second))
        difference = one - other
        assert all(a <= b for a, b in zip(difference.known, difference.errors, strict=True))
        assert sign * int(one.coefs[0][0]) > 0
    assert system.fixed_level is not None
    assert is_in(FixedLevel(F(0), 1), arb(1))
    assert not is_in(FixedLevel(F(0), 1), arb(0, 1))
    assert not is_in(FixedLevel(F(0), -1), arb(1))


INTERVALS = {
    # The cubic x^2/2 + a x^2 y + y^2/2 - y^3/3 = 1/12 at a = 1, x = 1/4 has roots near -0.45, 0.28 and 1.67.
    "one root": ("-1", "-1/10", True),
    "the next one": ("1/10", "9/10", True),
    "the third": ("6/5", "2", True),
    "two roots and the extremum between": ("-1", "9/10", False),
    "three roots": ("-1", "2", False),
    "none": ("1/2", "9/10", False),
    "a root at an extremum's side, and the extremum": ("-1", "1/10", False),
}


@pytest.mark.parametrize("name", INTERVALS)
def test_an_interval_has_to_have_one_root_and_no_extremum(name: str) -> None:
    low, high, holds = INTERVALS[name]
    system = on(described(CUBIC), low, high)
    arithmetic, spread = ARITHMETICS["narrow"]
    point = box(arithmetic, {"a": F(1), "x": F(1, 4)}, spread)
    candidate = replace(claimed(), system=system, centre=(F(1), F(1, 4)))
    if holds:
        w = initial_values(system, arithmetic, point)[1]
        assert F(low) < F(int(w.coefs[0][0]), 2**160) < F(high)
        check_level(Checklist(), candidate)
        return
    with pytest.raises(IntegrationFailure) as failure:
        initial_values(system, arithmetic, point)
    assert failure.value.reason.condition == "level"
    with pytest.raises(NotEstablishedError):
        check_level(Checklist(), candidate)


def test_slivers_of_an_end_of_the_interval_are_told_apart() -> None:
    system, arithmetic = relativistic(), ARITHMETICS["narrow"][0]
    point = box(arithmetic, {"a": F(1, 3), "y": F(0)}, F(1, 2**90))
    # At y = 0 px is 5^(1/2)/2 exactly.
    with ctx.workprec(300):
        below = F(int((arb(5).sqrt() * 2**79).floor().unique_fmpz()), 2**80)
    sliver = F(1, 2**80)
    assert below**2 < F(5, 4) < (below + sliver) ** 2
    for low, high, holds in [
        (F(1, 4), below + 2 * sliver, True),
        (F(1, 4), below - sliver, False),
        (below - sliver, F(2), True),
        (below + 2 * sliver, F(2), False),
    ]:
        if holds:
            initial_values(on(system, low, high), arithmetic, point)
        else:
            with pytest.raises(IntegrationFailure):
                initial_values(on(system, low, high), arithmetic, point)
    # px is largest at y = 0, and at other points of a wider set it is below the end.
    wider = box(arithmetic, {"a": F(1, 3), "y": F(0)}, F(1, 2**20))
    initial_values(on(system, below - F(1, 2**30), 2), arithmetic, wider)
    with pytest.raises(IntegrationFailure, match="only one in its interval"):
        initial_values(on(system, below - sliver, 2), arithmetic, wider)


def test_the_derivative_is_bounded_on_the_whole_interval() -> None:
    equation = LevelEquation.of(on(described(CUBIC), "1/10", "9/10"))
    arguments = [enclose(F(value)) for value in ("1/4", "7", "0", "0", "1")]
    slope = equation.slope(arguments)
    assert slope is not None
    assert excludes_zero(slope)
    for k in range(9):
        y = F(k + 1, 10)
        assert slope.contains(enclose(F(1, 16) + y - y * y))
    # Over a set: of a and x it is a x^2 + y - y^2.
    wide = equation.slope([arb("0.25", "0.01"), *arguments[1:4], arb(1, "0.1")])
    assert wide is not None
    for x, a in (("0.24", "0.9"), ("0.26", "1.1")):
        assert wide.contains(arb(a) * arb(x) ** 2 + arb("0.25"))
    assert equation.slope([arb(0, 1), *arguments[1:4], arb(0, 1)]) is None
    # d/dy = x^2 + y - y^2 at x = 1/4 has its zeros where y = (1 +- 5^(1/2)/2)/2.
    assert LevelEquation.of(on(described(CUBIC), "1/10", "17/16")).slope(arguments) is None


def test_an_integral_that_depends_on_a_function_of_the_coordinate_gives_no_level() -> None:
    entry = {
        **CUBIC,
        "field": {"x": "vx", "y": "vy", "vx": "-x", "vy": "-sin(y)"},
        "first_integral": "(vx**2 + vy**2 + x**2)/2 - cos(y)",
        "fixed_level": {"value": "-1/2", "between": ["1/10", "3"]},
    }
    system = described(entry)
    with pytest.raises(ValueError, match="function of y"):
        LevelEquation.of(system)
    point = box(ARITHMETICS["narrow"][0], {"a": F(1), "x": F(1, 4)}, F(1, 2**40))
    with pytest.raises(IntegrationFailure, match="function of y"):
        initial_values(system, ARITHMETICS["narrow"][0], point)
    with pytest.raises(NotEstablishedError, match="function of y"):
        check_level(Checklist(), replace(claimed(), system=system, centre=(F(1), F(1, 4))))


def test_functions_of_functions_of_the_coordinate_are_functions_of_it() -> None:
    entry = {
        **CUBIC,
        "field": {"x": "vx", "y": "vy", "vx": "-sin(x + sin(y))", "vy": "-sin(x + sin(y))*cos(y)"},
        "first_integral": "(vx**2 + vy**2)/2 - cos(x + sin(y))",
    }
    with pytest.raises(ValueError, match="function of y"):
        LevelEquation.of(described(entry))


def test_the_box_of_a_claim_is_enclosed_where_frames_have_negative_entries() -> None:
    frame = ((F(1), F(-3)), (F(-2), F(1)))
    candidate = replace(claimed(), frame=frame, centre=(F(1, 2), F(1, 5)), radii=(F(1, 8), F(1, 16)))
    balls = dict(zip((*relativistic().state, "a"), on_box(candidate), strict=True))
    for first in (-1, 1):
        for second in (-1, 1):
            p = F(first, 8), F(second, 16)
            for name, origin, row in zip(("a", "y"), candidate.centre, frame, strict=True):
                assert balls[name].contains(enclose(origin + row[0] * p[0] + row[1] * p[1]))


@pytest.mark.parametrize("side", [-1, 1])
def test_the_coordinate_is_in_its_interval_on_every_part_of_a_wide_set(side: int) -> None:
    """px falls as y rises, and leaves the interval at one end of the wide variable."""
    arithmetic, spread = ARITHMETICS["wide"]
    point = box(arithmetic, {"a": F(1, 3), "y": F(1, 2)}, spread)
    point["y"] = point["y"] + arithmetic.polynomial({(0, 0): [F(0), F(side, 64)]})
    # At y = 1/2 and 1/2 +- 1/64.
    middle, least, most = (F(sqrt((1.5 - y * y / 2) ** 2 - 1)) for y in (0.5, 0.515625, 0.484375))
    initial_values(on(relativistic(), least - F(1, 1000), most + F(1, 1000)), arithmetic, point)
    for low, high in (((middle + least) / 2, F(2)), (F(1, 4), (middle + most) / 2)):
        with pytest.raises(IntegrationFailure, match="only one in its interval"):
            initial_values(on(relativistic(), low, high), arithmetic, point)


# Claims.


def test_a_bifurcation_is_proved_and_told_with_its_interval() -> None:
    proof = certificate()
    assert proof.proved, proof.reason
    assert proof.side == "above"
    assert proof.parameter is not None
    with ctx.workprec(200):
        assert agree(proof.parameter, arb("0.641462169594796543440731618339839") + arb(0, "1e-32"))
    assert "on the level E = 3/2, those of the box with 0.25 < px < 2" in str(proof.theorem)
    assert "px being its one solution with 0.25 < px < 2" in proof.statement["in_full"]
    (level,) = (hypothesis for hypothesis in proof.hypotheses if hypothesis.name == "level")
    assert level.section == "12.6"
    assert recheck(proof, integrate=True).findings == ()


def test_elsewhere_nothing_is_proved() -> None:
    system = relativistic()
    assert refusal(on(system, "6/5", "2")) == "level"
    assert refusal(on(system, "-2", "2")) == "level"
    assert refusal(on(system, "1/4", "2", "1501/1000")) == "family"
    # The mirror image of the orbit is one of the same system, with px < 0.
    assert refusal(on(system, "-2", "-1/4")) == "proved"


def test_orbits_are_proved_whose_level_is_that_of_a_potential() -> None:
    system = described(CUBIC)
    task = OrbitTask("brake", system, {}, Equation(COORDINATE, F(1), "a"), (1.0, -0.25), 40, {})
    candidate = refine_orbit(task)
    proof = certify(candidate, LIMITS)
    assert proof.proved, proof.reason
    assert proof.orbit is not None
    start = completed(system, [float(proof.point["x"].mid()), 0.0, 0.0, 0.0], [1.0])
    x, y = start[:2]
    assert abs(x * x / 2 + y * y / 2 + x * x * y - y**3 / 3 - 1 / 12) < 1e-15
    assert -1 < y < -0.1
    # In another interval there is another point over the same x, whose orbit is not periodic.
    assert not certify(replace(candidate, system=on(system, "1/10", "9/10")), LIMITS).proved
    half = replace(task, equation=Equation(HALF_PERIOD, F(proof.orbit.half_period.mid().str(30, radius=False))))
    assert half.equation.quantity == HALF_PERIOD


MODES = {
    **CUBIC,
    "name": "relativistic-modes",
    "state": ["x", "y", "px", "py"],
    "where": {"energy": "sqrt(1 + px**2 + py**2)"},
    "field": {"x": "px/energy", "y": "py/energy", "px": "-a*x - x*y**2", "py": "-y - x**2*y"},
    "R": {"y": -1, "px": -1},
    "section": "y",
    "first_integral": "energy + (a*x**2 + y**2 + x**2*y**2)/2",
    "level_coordinate": "py",
    "fixed_level": {"value": "3/2", "between": ["1/4", "2"]},
}
"""Two oscillators that stiffen each other; on x = 0 the orbit is known but for one quadrature."""


@cache
def loss() -> Candidate:
    place = {"a": 0.2609736537, "x": 0.0}
    return refine_at(described(MODES), place, 1, kind="reversor_breaking", digits=40, id="loss", quiet=True)


def test_a_loss_of_the_reversor_is_where_a_linear_equation_has_an_odd_solution() -> None:
    def end(a: float) -> float:
        def slopes(_t: float, s: Sequence[float]) -> list[float]:
            energy = sqrt(1 + s[1] ** 2)
            return [s[1] / energy, -s[0], s[3] / energy, -(a + s[0] ** 2) * s[2]]

        def height(_t: float, s: Sequence[float]) -> float:
            return s[0]

        height.terminal, height.direction = True, -1  # type: ignore[attr-defined]
        run = solve_ivp(slopes, [0, 20], [0.0, sqrt(1.25), 0.0, 1.0], rtol=1e-11, atol=1e-12, events=height)
        return float(run.y[2, -1])

    proof = certify(loss(), LIMITS)
    assert proof.proved, proof.reason
    assert proof.parameter is not None
    assert abs(float(proof.parameter.mid()) - brentq(end, 0.25, 0.27, xtol=1e-13)) < 1e-10
    (sheet,) = (hypothesis for hypothesis in proof.hypotheses if hypothesis.name == "sheet")
    assert "the derivative of the first integral in py is not 0" in sheet.statement
    assert recheck(proof).stands


def test_the_sheet_of_the_images_is_told_over_all_of_the_box(monkeypatch: pytest.MonkeyPatch) -> None:
    """The centre may be on one sheet of the level and points of the box on the other."""

    def wider(element: Series, scales: Any, ratio: Any) -> Any:
        table = derivative_table(element, scales, ratio)
        return replace(table, box={index: value + arb(0, 3) for index, value in table.box.items()})

    monkeypatch.setattr(following, "derivative_table", wider)
    found = enclose_breaking(loss(), IntegratorSettings(128), ORACLE)
    assert found.sheet[0].contains(0)
    with ctx.workprec(128), pytest.raises(NotEstablishedError, match="may vanish"):
        check_sheet(Checklist(), loss(), found)


def test_at_the_image_the_derivative_counts_and_not_the_sign() -> None:
    found = enclose_breaking(loss(), IntegratorSettings(128), ORACLE)
    with ctx.workprec(128):
        check_sheet(Checklist(), loss(), found)
        with pytest.raises(NotEstablishedError, match="may vanish"):
            check_sheet(Checklist(), loss(), replace(found, sheet=(arb(0, "1e-3"),)))
        # The same coordinates in the cubic, whose derivative at x = 0 is y - y^2.
        other = replace(loss(), system=described(CUBIC))
        check_sheet(Checklist(), other, replace(found, sheet=(arb("0.5"),)))
        for y in (arb(1), arb("1.01", "0.02"), arb(0)):
            with pytest.raises(NotEstablishedError, match="may vanish"):
                check_sheet(Checklist(), other, replace(found, sheet=(y,)))
        (table,) = found.image
        zero = (0,) * len(next(iter(table.box)))
        far = replace(found, sheet=(arb(1),), image=(replace(table, box={**table.box, zero: arb(2)}),))
        check_sheet(Checklist(), other, far)
        # Across Fix(R) too: there the derivative is y - y^2 + vx^2.
        integral = f"{CUBIC['first_integral']} + vx**2*y"
        across = replace(loss(), system=described({**CUBIC, "first_integral": integral}))
        ((last,),) = found.iterates
        for vx, holds in ((arb(2), True), (arb(0, "1e-3"), False)):
            moved = replace(found, sheet=(arb(1),), iterates=((replace(last, box={**last.box, zero: vx}),),))
            if holds:
                check_sheet(Checklist(), across, moved)
            else:
                with pytest.raises(NotEstablishedError, match="may vanish"):
                    check_sheet(Checklist(), across, moved)


def test_the_other_points_get_an_interval_of_their_own() -> None:
    with ctx.workprec(100):
        there = on_sheet(described(CUBIC), [arb("0.4") + arb(0, "0.01"), arb("0.42")]).fixed_level
        assert there is not None
        assert there.between is not None
        assert there.between[0] < F(38, 100) < F(43, 100) < there.between[1]
        for values in ([], [arb("nan")], [arb(0, "inf")]):
            with pytest.raises(IntegrationFailure, match="be enclosed"):
                on_sheet(described(CUBIC), values)


# Descriptions.


def test_a_description_keeps_the_interval() -> None:
    system = described(CUBIC)
    assert system.fixed_level == FixedLevel(F(1, 12), between=(F(-1), F(-1, 10)))
    assert described(json.loads(json.dumps(describe(system)))) is system
    again = candidate_from_json(to_json(claimed(), provenance=False), "claim")
    assert again.system is relativistic()


@pytest.mark.parametrize(
    ("level", "message"),
    [
        ({"value": "0"}, "sign, 1 or -1, or between"),
        ({"value": "0", "sign": 1, "between": ["0", "1"]}, "sign, 1 or -1, or between"),
        ({"value": "0", "between": ["0"]}, "sign, 1 or -1, or between"),
        ({"value": "0", "between": "0"}, "sign, 1 or -1, or between"),
        ({"value": "0", "between": ["1", "1"]}, "is empty; give the smaller end first"),
        ({"value": "0", "between": ["0", "x"]}, "fixed_level.between"),
    ],
)
def test_an_interval_that_is_none_is_named(level: Any, message: str) -> None:
    with pytest.raises(DescriptionError, match="fixed_level") as error:
        described({**CUBIC, "fixed_level": level})
    assert message in str(error.value)


def test_a_sign_where_an_interval_is_needed_is_told_with_the_remedy(tmp_path: Path) -> None:
    text = (EXAMPLES / "relativistic.py").read_text("utf-8")
    file = tmp_path / "relativistic.py"
    file.write_text(text.replace('"between": ["1/4", "2"]', '"sign": 1'), "utf-8")
    with pytest.raises(InputError, match="give fixed_level an interval of it"):
        load_system(file)


def test_floating_point_finds_the_root_in_the_interval_and_none_elsewhere() -> None:
    system = relativistic()
    found = completed(system, [0.0, 0.3, 0.0, 0.0], [0.5])
    assert abs(found[2] - ((1.5 - 0.045) ** 2 - 1) ** 0.5) < 1e-15
    for low, high in (("6/5", "2"), ("1/4", "1/2")):
        missing = completed(on(system, low, high), [0.0, 0.3, 0.0, 0.0], [0.5])[2]
        assert missing != missing


PROGRAMS: dict[str, Any] = {
    "quotients": lambda s: ((s[0] ** 2 - 3 * s[1]) / (s[0] * s[1] + 5) - s[1] / s[0],),
    "powers": lambda s: ((1 + s[0] ** 2) ** F(-3) * s[1] - s[0] ** 3 + (2 - s[0]) ** 0,),
    "without it": lambda s: (s[1] ** 2 / 7,),
    "alone": lambda s: (s[0],),
}


def test_roots_of_constants_stay_roots() -> None:
    # In floating point the root would be 10^16.
    large = 10**32 + 1
    program = record(lambda s: (s[0] ** 2 + root_of(s, large) * s[0],), ("w", "u"))
    constants = record(lambda s: (s[0] * root_of(s, large),), ("w", "u"))
    for each in (program, constants):
        with ctx.workprec(200):
            value, slope = with_slope(each, "w").evaluate([arb(2), arb(3)], enclose, power)
            rest = 4 if each is program else 0
            assert abs(slope - rest - arb(large).sqrt()) < 1e-40
            assert abs(value - rest - 2 * arb(large).sqrt()) < 1e-40


def root_of(variables: Any, number: int) -> Any:
    """The root of a constant, as a recorded operation."""
    return variables[0].recorder.lift(number) ** F(1, 2)


@pytest.mark.parametrize("name", PROGRAMS)
def test_the_slope_of_a_program_is_that_of_its_function(name: str) -> None:
    program = record(PROGRAMS[name], ("w", "u"))
    both = with_slope(program, "w")
    for w, u in ((F(3, 7), F(2)), (F(-5, 2), F(1, 3))):
        step = F(1, 10**12)

        def at(x: F, u: F = u) -> F:
            (value,) = program.evaluate([x, u], lambda c: c, lambda b, e: b ** int(e))
            return F(value)

        value, slope = both.evaluate([w, u], lambda c: c, lambda b, e: b ** int(e))
        assert value == at(w)
        assert abs(slope - (at(w + step) - at(w - step)) / (2 * step)) < F(1, 10**18)
