"""Bifurcations of periodic orbits without symmetry: found, told apart, followed and refined where they are known."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orbitproof import explore
from orbitproof.explore.__main__ import main
from orbitproof.explore.periodic import (
    DOUBLING,
    FOLD,
    PITCHFORK,
    TORUS,
    AffineSection,
    Bifurcation,
    ClosedOrbit,
    FamilyEquations,
    FamilyMember,
    PeriodicFamily,
    PeriodicProblem,
    StepControl,
    continue_orbit,
    correct,
    families,
    linear_symmetries,
    new_orbits,
    refine_bifurcation,
)
from orbitproof.explore.refinement import RefinementFailure
from orbitproof.shared.formats import define_system, read_claims
from orbitproof.shared.interrupts import INTERRUPTED


def _system(name: str, state: str, field: dict[str, str], **more: Any) -> Any:
    return define_system({"name": name, "state": state, "field": field, **more})


CIRCLE = {"x": "x*s - y", "y": "x + y*s"}
ONE = {"s": "1 - x**2 - y**2"}
TWO_CYCLES = _system("cycles", "x y", CIRCLE, parameters="a", where={"r": "x**2 + y**2", "s": "a + r - r**2"})
"""Circles with a + r - r^2 = 0, r the square of the radius: a fold at a = -1/4, r = 1/2."""
PITCHFORK_OF_W = _system("pitchfork", "x y w", {**CIRCLE, "w": "a*w - w**3"}, parameters="a", where=ONE)
EXCHANGE = _system("exchange", "x y w", {**CIRCLE, "w": "a*w - w**2"}, parameters="a", where=ONE)
TURNING = _system("turning", "x y u v", {**CIRCLE, "u": "a*u - v/3", "v": "u/3 + a*v"}, parameters="a", where=ONE)
COLLIDING = _system(
    "colliding", "x y u v", {**CIRCLE, "u": "a*u + v", "v": "a*v - (a + 1/10)*u"}, parameters="a", where=ONE
)
"""The multipliers exp(2 pi (a +- sqrt(-(a + 1/10)))): real until a = -1/10, on the circle at a = 0."""
MOEBIUS = _system(
    "moebius",
    "x y u v",
    {
        **CIRCLE,
        "u": "(a - 1)/2*u + (a + 1)/2*(x*u + y*v) - v/2 - r*u",
        "v": "(a - 1)/2*v + (a + 1)/2*(y*u - x*v) + u/2 - r*v",
    },
    parameters="a",
    where={**ONE, "r": "u**2 + v**2"},
)
"""In a plane that makes half a turn in a period U' = a U - U^3, V' = -V: doubled orbits with U^2 = a."""
LEVELS_FOLD = _system(
    "levels", "x y u v", {"x": "-y", "y": "x", "u": "v", "v": "x**2 + y**2 - 1 - u**2"}, first_integral="x**2 + y**2"
)
"""u^2 = level - 1 on periodic orbits: a fold at the level 1."""
LEVELS_DOUBLING = _system(
    "moebius-levels",
    "x y u v",
    {
        "x": "-y",
        "y": "x",
        "u": "(x*v - y*u)/2 + c*v - v/2",
        "v": "(x*u + y*v)/2 - c*u + u/2",
    },
    first_integral="x**2 + y**2",
    where={"c": "1/2 + u**2 + v**2"},
)
"""In a plane that makes half a turn in a period U' = (r/2 + c) V, V' = (r/2 - c) U: a doubling at the level r^2 = 1."""
SPIN = _system("spin", "x y z", {"x": "x*s - y", "y": "x + y*s", "z": "a*z - z**3"}, parameters="a", where=ONE)


NEUTRAL = _system(
    "neutral", "x y z", {"x": "-a*z*x/2 - y", "y": "x - a*z*y/2", "z": "a*(x**2 + y**2 - 1)"}, parameters="a"
)
"""The unit circle with the multipliers exp(+-2 pi i a), on the circle for all a."""
MICHELSON = _system("michelson", "x y z", {"x": "y", "y": "z", "z": "c**2 - y - x**2/2"}, parameters="c")


def _found(family: PeriodicFamily, kind: str) -> Bifurcation:
    (found,) = [each for each in family.bifurcations if each.kind == kind]
    return found


def _family(
    system: Any, value: str, start: list[float], period: float, bounds: tuple[float, float], **control: Any
) -> PeriodicFamily:
    problem = PeriodicProblem(system, dict.fromkeys(system.parameters, Fraction(value)))
    name = next(iter(system.parameters), None)
    return continue_orbit(problem, correct(problem, start, period), name, bounds, StepControl(**control))


@pytest.mark.slow
def test_a_fold_is_refined_to_its_closed_form() -> None:
    found = _found(_family(TWO_CYCLES, "-1/5", [0.8506, 0], 6.3, (-0.3, 0.0)), FOLD)
    claim = refine_bifurcation(found, "fold", 30)
    assert (claim.kind, claim.parameter, claim.crossings) == ("periodic-fold", "a", 1)
    assert abs(claim.parameters["a"] + Fraction(1, 4)) < Fraction(1, 10**29)
    x, y = claim.centre
    assert abs(x * x + y * y - Fraction(1, 2)) < Fraction(1, 10**28)


def test_the_order_of_a_family_does_not_depend_on_the_sign_of_a_tangent(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rounding may choose it."""
    one = _family(TWO_CYCLES, "-1/5", [0.8506, 0], 6.3, (-0.3, 0.0))
    member_of = FamilyEquations.member_of

    def turned(self: FamilyEquations, orbit: ClosedOrbit) -> FamilyMember:
        member = member_of(self, orbit)
        return replace(member, tangent=-member.tangent)

    monkeypatch.setattr(FamilyEquations, "member_of", turned)
    other = _family(TWO_CYCLES, "-1/5", [0.8506, 0], 6.3, (-0.3, 0.0))
    points, again = ([each.orbit.point for each in family.members] for family in (one, other))
    assert len(points) == len(again) > 2
    assert np.allclose(points, again, rtol=0, atol=1e-9)
    assert one.reason == other.reason


@pytest.mark.slow
def test_a_doubling_is_refined_to_its_closed_form() -> None:
    found = _found(_family(MOEBIUS, "-1/20", [1, 0, 0, 0], 6.3, (-0.06, 0.05)), DOUBLING)
    claim = refine_bifurcation(
        found, "doubling", 30, None, AffineSection((Fraction(0), Fraction(1), *[Fraction(0)] * 2), Fraction(0), 1)
    )
    assert claim.kind == "periodic-doubling"
    assert abs(claim.parameters["a"]) < Fraction(1, 10**29)
    assert abs(claim.centre[0] - 1) < Fraction(1, 10**29)
    # At the angle 0 the plane's first axis is that of u; p is (x, u, v).
    (vector,) = claim.kernel
    assert abs(vector[1]) == pytest.approx(1, abs=1e-12)
    assert max(abs(vector[0]), abs(vector[2])) < Fraction(1, 10**20)


@pytest.mark.slow
def test_a_pitchfork_is_refined_with_its_symmetry() -> None:
    found = _found(_family(PITCHFORK_OF_W, "-1/10", [1, 0, 0], 6.3, (-0.11, 0.1)), PITCHFORK)
    claim = refine_bifurcation(found, "pitchfork", 30)
    assert (claim.kind, claim.crossings) == ("periodic-pitchfork", 1)
    assert claim.symmetry == ((1, 0, 0), (0, 1, 0), (0, 0, -1))
    assert abs(claim.parameters["a"]) < Fraction(1, 10**29)


def test_a_torus_is_refined_to_its_closed_form() -> None:
    found = _found(_family(TURNING, "-1/10", [1, 0, 0, 0], 6.3, (-0.11, 0.1)), TORUS)
    claim = refine_bifurcation(found, "torus", 30)
    assert (claim.kind, len(claim.kernel)) == ("periodic-torus", 2)
    assert abs(claim.parameters["a"]) < Fraction(1, 10**29)
    assert claim.multiplier is not None
    cosine, sine = claim.multiplier
    assert abs(cosine + Fraction(1, 2)) < Fraction(1, 10**29)
    assert float(abs(sine)) == pytest.approx(sqrt(3) / 2, abs=1e-15)


def test_a_fold_on_levels_is_found_and_refined() -> None:
    family = _family(LEVELS_FOLD, "0", [sqrt(1.2), 0, sqrt(0.2), 0], 6.28, (0.8, 1.3))
    found = _found(family, FOLD)
    assert found.member.value == pytest.approx(1, abs=1e-7)
    claim = refine_bifurcation(found, "fold", 30)
    assert claim.parameter is None
    assert claim.level is not None
    assert abs(claim.level - 1) < Fraction(1, 10**29)


def test_a_doubling_on_levels_is_found_and_refined() -> None:
    family = _family(LEVELS_DOUBLING, "0", [sqrt(0.9), 0, 0, 0], 6.28, (0.85, 1.1))
    found = _found(family, DOUBLING)
    assert found.member.value == pytest.approx(1, abs=1e-7)
    claim = refine_bifurcation(found, "doubling", 30)
    assert claim.level is not None
    assert abs(claim.level - 1) < Fraction(1, 10**29)


def test_multipliers_that_collide_and_cross_on_one_step_are_followed() -> None:
    family = _family(COLLIDING, "-3/20", [1, 0, 0, 0], 6.3, (-0.2, 0.05), initial=0.6, maximum=0.6)
    found = _found(family, TORUS)
    assert found.member.value == pytest.approx(0, abs=1e-7)


def test_multipliers_that_stay_on_the_circle_do_not_cross_it() -> None:
    family = _family(NEUTRAL, "1/4", [1, 0, 0], 6.3, (0.2, 0.3))
    assert not family.bifurcations
    assert len(family.members) < 40


def test_a_field_without_divergence_has_multipliers_in_pairs() -> None:
    problem = PeriodicProblem(MICHELSON, {"c": Fraction(1, 5)})
    orbit = correct(problem, [0.0, 0.3, 0.0], 6.2)
    family = continue_orbit(problem, orbit, "c", (0.15, 0.25))
    assert not [each for each in family.bifurcations if each.kind == TORUS]
    assert len(family.members) < 40


def test_the_orbits_of_a_doubling_are_followed_from_their_birth() -> None:
    birth = _found(_family(MOEBIUS, "-1/20", [1, 0, 0, 0], 6.3, (-0.06, 0.05)), DOUBLING)
    family = new_orbits(birth, (-0.06, 0.05))
    for each in family.members:
        _, _, u, v = each.orbit.point
        assert u * u + v * v == pytest.approx(each.value, abs=1e-9)
        assert each.orbit.period == pytest.approx(4 * pi, abs=1e-9)
    assert family.members[-1].value > 0.05


@pytest.mark.slow
def test_a_doubling_close_to_the_birth_of_its_orbits_is_found() -> None:
    """Lur'e's system: the first step from the third doubling would lead past the fourth."""
    lure = _system("lure", "x y z", {"x": "y", "y": "z", "z": "-a*z - y - x + x**2"}, parameters="a")
    problem = PeriodicProblem(lure, {"a": Fraction(13, 20)})
    first = correct(problem, [0.155619787248, -0.499553770124, 0], 6.36)
    found = families(problem, first, "a", (0.55, 0.66), generations=3)
    values = [each.member.value for family in found for each in family.bifurcations if each.kind == DOUBLING]
    assert values == pytest.approx([0.630302006, 0.579629841, 0.569222720, 0.567018568], abs=1e-8)


def test_a_family_that_goes_back_to_its_birth_ends_there() -> None:
    birth = _found(_family(MOEBIUS, "-1/20", [1, 0, 0, 0], 6.3, (-0.06, 0.05)), DOUBLING)
    doubled = new_orbits(birth, (-0.06, 0.05)).members[-1]
    problem = PeriodicProblem(MOEBIUS, {"a": Fraction(doubled.value)})
    family = continue_orbit(problem, correct(problem, doubled.orbit.point, 4 * pi), "a", (-0.06, 0.07))
    (found,) = family.bifurcations
    assert (found.kind, found.ends) == (DOUBLING, True)
    assert found.member.value == pytest.approx(0, abs=1e-6)
    assert found.member.orbit.period == pytest.approx(2 * pi, abs=1e-6)
    claim = refine_bifurcation(found, "birth", 30)
    assert abs(claim.parameters["a"]) < Fraction(1, 10**29)


def test_one_of_two_mirror_images_is_followed_from_a_pitchfork() -> None:
    problem = PeriodicProblem(SPIN, {"a": Fraction(-1, 10)})
    found = list(families(problem, correct(problem, [1, 0, 0], 6.3), "a", (-0.11, 0.1), generations=3))
    assert [each.generation for each in found] == [0, 1]
    for each in found[1].members:
        assert each.orbit.point[2] ** 2 == pytest.approx(each.value, abs=1e-9)


def test_symmetries_are_those_for_all_values_of_the_parameter() -> None:
    found = linear_symmetries(PeriodicProblem(TURNING, {"a": Fraction(0)}), "a")
    assert {each.described(TURNING.state) for each in found} == {
        "(x, y, u, v) -> (-x, -y, u, v)",
        "(x, y, u, v) -> (x, y, -u, -v)",
        "(x, y, u, v) -> (-x, -y, -u, -v)",
    }
    assert not linear_symmetries(PeriodicProblem(EXCHANGE, {"a": Fraction(0)}), None)[1:]


def test_a_branch_point_without_symmetry_is_no_claim() -> None:
    (found,) = _family(EXCHANGE, "-1/10", [1, 0, 0], 6.3, (-0.11, 0.1)).bifurcations
    with pytest.raises(RefinementFailure, match="no claim"):
        refine_bifurcation(found, "branch", 30)


def test_families_are_followed_and_refined_from_python() -> None:
    (orbit,) = explore.find_periodic(SPIN, {"x": 1, "y": 0, "z": 0}, parameters={"a": "-1/10"}, period=6.3, quiet=True)
    (family, born) = explore.follow_periodic(orbit, "a", (-0.11, 0.1), generations=1, symmetry="x,y,-z", quiet=True)
    assert born.born is family.bifurcations[0]
    claim = explore.refine_periodic(family.bifurcations[0], digits=30, name="birth", section="y=0", quiet=True)
    assert (claim.id, claim.kind, claim.normal) == ("birth", "periodic-pitchfork", (0, 1, 0))
    with pytest.raises(ValueError, match="no such symmetry"):
        explore.follow_periodic(orbit, "a", (-0.11, 0.1), symmetry="-x,y,z", quiet=True)


MINE = """\
name = "mine"
state = "x y w"
parameters = "a"


def field(x, y, w, a):
    s = 1 - x**2 - y**2
    return x * s - y, x + y * s, a * w - w**3
"""


@pytest.mark.slow
def test_bifurcations_are_written_by_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    claims, table = tmp_path / "claims.json", tmp_path / "family.csv"
    system = ["--system", str(tmp_path / "mine.py"), "--parameter", "a=-1/10", "--start", "x=1", "y=0", "w=0"]
    along = [*system, "--period", "6.3", "--along", "a", "-0.11", "0.1", "--quiet", "--digits", "30"]
    assert main(["periodic", *along, "--generations", "1", "-o", str(claims), "--csv", str(table)]) == 0
    said = capsys.readouterr().out
    assert "pitchfork: a = " in said
    assert "born at the pitchfork at a = " in said
    (claim,) = read_claims(claims)
    assert (claim.id, claim.kind) == ("mine-pitchfork-1", "periodic-pitchfork")
    assert (tmp_path / "family-2.csv").read_text().startswith("a,period,x,y,w,")
    assert main(["periodic", *along, "--claims", "all", "-o", str(claims)]) == 0
    assert [claim.kind for claim in read_claims(claims)] == ["periodic", "periodic-pitchfork"]
    short = [*system, "--period", "6.3", "--along", "a", "-0.11", "-0.09", "--quiet", "-o", str(claims)]
    assert main(["periodic", *short]) == 1
    assert "no fold, doubling" in capsys.readouterr().err


def test_an_interrupt_keeps_the_family_so_far(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    claims, table = tmp_path / "claims.json", tmp_path / "family.csv"
    corrected, calls = FamilyEquations.corrected, iter(range(9))

    def interrupted(*arguments: Any) -> Any:
        if next(calls, None) is None:
            raise KeyboardInterrupt
        return corrected(*arguments)

    monkeypatch.setattr(FamilyEquations, "corrected", interrupted)
    words = ["--system", str(tmp_path / "mine.py"), "--parameter", "a=-1/10", "--start", "x=1", "y=0", "w=0"]
    words += ["--period", "6.3", "--along", "a", "-0.11", "0.1", "--quiet", "-o", str(claims), "--csv", str(table)]
    assert main(["periodic", *words]) == INTERRUPTED
    assert "family so far is kept" in capsys.readouterr().err
    assert 5 < len(table.read_text().splitlines()) < 12


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--generations", "1"], "belongs to --along"),
        (["--claims", "all"], "belongs to --along"),
        (["--along", "a", "0", "1"], "-1/10, where the first orbit is, lies outside"),
        (["--along", "a", "-1", "1", "--symmetry=-x,y"], "give the image of (x, y, w)"),
        (["--along", "a", "-1", "1", "--symmetry=-x,y,w**2"], "not linear"),
        (["--along", "a", "-1", "1", "--symmetry=-x,y,w"], "no such symmetry"),
    ],
)
def test_bad_input_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    system = ["--system", str(tmp_path / "mine.py"), "--parameter", "a=-1/10", "--start", "x=1", "y=0", "w=0"]
    assert main(["periodic", *system, "--period", "6.3", "--quiet", *arguments]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
