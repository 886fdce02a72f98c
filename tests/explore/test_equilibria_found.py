"""Equilibria, their curves, Hopf points and what is born there: found where closed forms have them."""

from __future__ import annotations

import json
from fractions import Fraction
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.systems import described

from orbitproof import explore, verify
from orbitproof.explore.__main__ import main
from orbitproof.explore.periodic import (
    BRANCH,
    FOLD,
    EquilibriumCurve,
    FoundEquilibrium,
    Hopf,
    PeriodicFailure,
    PeriodicProblem,
    continue_equilibrium,
    continue_orbit,
    correct,
    cover_equilibria,
    cycles_of,
    equilibria_from_many_starts,
    equilibrium_near,
    families_from,
    find_equilibria,
    hopf_claim,
)
from orbitproof.explore.periodic.equilibria import field_slopes
from orbitproof.explore.refinement import RefinementFailure
from orbitproof.shared.formats import define_system, read_claims
from orbitproof.verify.certificate import certify

BRUSSELATOR = described(
    name="brusselator", state="x y", parameters="A B", field={"x": "A - (B + 1)*x + x**2*y", "y": "B*x - x**2*y"}
)
LORENZ = described(
    name="lorenz", state="x y z", parameters="r", field={"x": "10*(y - x)", "y": "x*(r - z) - y", "z": "x*y - 8*z/3"}
)


def _problem(field: dict[str, str], value: str, **more: Any) -> PeriodicProblem:
    keys = {"name": "mine", "state": " ".join(field), "parameters": "a", "field": field, **more}
    return PeriodicProblem(define_system(keys), {"a": Fraction(value)})


def _curve(problem: PeriodicProblem, start: list[float], bounds: tuple[float, float]) -> EquilibriumCurve:
    name = next(iter(problem.parameters))
    return continue_equilibrium(problem, equilibrium_near(problem, start), name, bounds)


def test_all_equilibria_of_lorenz_are_found_with_their_eigenvalues() -> None:
    found = sorted(
        equilibria_from_many_starts(PeriodicProblem(LORENZ, {"r": Fraction(20)})), key=lambda each: each.point[0]
    )
    side = sqrt(8 / 3 * 19)
    assert [each.point for each in found] == [
        pytest.approx([-side, -side, 19]), pytest.approx([0, 0, 0], abs=1e-12), pytest.approx([side, side, 19])
    ]  # fmt: skip
    assert [each.unstable for each in found] == [0, 1, 0]
    assert found[1].eigenvalues[0].real == pytest.approx((-11 + sqrt(121 + 40 * 19)) / 2)
    assert found[1].eigenvalues[1] == pytest.approx(-8 / 3)


def test_derivatives_of_functions_powers_and_parameters_are_exact() -> None:
    system = described(name="mixed", state="x y", parameters="a", field={"x": "exp(a*x)*y**3", "y": "x**-2 + sin(y)"})
    slopes = field_slopes(system, np.array([-1.5, -0.5]), np.array([0.7]))
    wave = np.exp(-1.05)
    assert slopes[0] == pytest.approx([0.7 * wave * -0.125, wave * 0.75, -1.5 * wave * -0.125], rel=1e-14)
    assert slopes[1] == pytest.approx([2 / 1.5**3, np.cos(-0.5), 0], rel=1e-14)


def test_where_there_is_no_equilibrium_none_is_found() -> None:
    problem = _problem({"x": "1 + x**2 + y**2", "y": "y - x"}, "1")
    assert not list(equilibria_from_many_starts(problem))
    with pytest.raises(PeriodicFailure, match="no equilibrium"):
        equilibrium_near(problem, [0.3, 0.2])


def test_a_curve_is_followed_through_its_folds() -> None:
    curve = _curve(_problem({"x": "a + x - x**3", "y": "x - y"}, "0"), [1, 1], (-1, 1))
    height = 2 / (3 * sqrt(3))
    assert [each.kind for each in curve.special] == [FOLD, FOLD]
    assert sorted(each.value for each in curve.special) == pytest.approx([-height, height], abs=1e-15)
    assert sorted(abs(each.point[0]) for each in curve.special if not isinstance(each, Hopf)) == pytest.approx(
        [1 / sqrt(3)] * 2, abs=1e-14
    )
    values = [each.value for each in curve.members]
    assert values[0] < -1
    assert values[-1] > 1
    assert curve.reason.count("reaches") == 2


def test_curves_that_cross_have_a_branch_point_on_both() -> None:
    problem = _problem({"x": "a*x - x**3 + 0*y", "y": "-y"}, "1/2")
    for start in ([0.0, 0.0], [0.7, 0.0]):
        (found,) = _curve(problem, start, (-1, 1)).special
        assert found.kind == BRANCH
        assert found.value == pytest.approx(0, abs=1e-6)


def test_two_real_eigenvalues_with_sum_zero_are_no_hopf_point() -> None:
    assert not _curve(_problem({"x": "a*x", "y": "-y", "z": "-2*z"}, "1/2"), [0, 0, 0], (1 / 4, 7 / 4)).special


def test_pairs_that_stay_on_the_axis_are_no_hopf_points() -> None:
    problem = _problem({"x": "a*y", "y": "-x"}, "1", first_integral="x**2 + a*y**2")
    assert not _curve(problem, [0, 0], (1 / 2, 2)).special


@pytest.mark.parametrize("sign", [1, -1])
def test_the_lyapunov_coefficient_is_that_of_a_circle_sheared(sign: int) -> None:
    # r' = a r + c r^3, where first y is y - x^2/3: l_1 = 2 c for a vector of length 1.
    own = "(y - x**2/3)"
    square = f"(x**2 + {own}**2)"
    first = f"(a*x - {own} + {sign}*2/5*x*{square})"
    problem = _problem(
        {"x": first, "y": f"x + a*{own} + {sign}*2/5*{own}*{square} + 2/3*x*{first}", "z": "-3*z + x**2"}, "-1/10"
    )
    (found,) = _curve(problem, [0, 0, 0], (-1, 1)).special
    assert isinstance(found, Hopf)
    assert found.value == pytest.approx(0, abs=1e-15)
    assert (found.frequency, found.speed) == (pytest.approx(1, abs=1e-15), pytest.approx(1, abs=1e-14))
    assert found.lyapunov == pytest.approx(sign * 4 / 5, abs=1e-13)
    assert found.others == pytest.approx([-3])
    assert found.side == ("above" if sign < 0 else "below")
    assert found.orbits_are_stable == (sign < 0)


def test_hopf_points_of_lorenz_and_the_brusselator_are_those_of_closed_forms() -> None:
    problem = PeriodicProblem(BRUSSELATOR, {"A": Fraction(2), "B": Fraction(4)})
    (found,) = _curve(problem, [2, 2], (1, 5 / 2)).hopf
    assert found.value == pytest.approx(sqrt(3), abs=1e-15)
    assert found.frequency == pytest.approx(sqrt(3), abs=1e-15)
    assert found.speed == pytest.approx(-sqrt(3), abs=1e-14)
    (found,) = _curve(PeriodicProblem(LORENZ, {"r": Fraction(20)}), [7, 7, 19], (10, 30)).hopf
    assert found.value == pytest.approx(470 / 19, abs=1e-13)
    assert found.frequency == pytest.approx(sqrt(8 / 3 * (470 / 19 + 10)), abs=1e-13)
    assert (found.side, found.orbits_are_stable) == ("below", False)


def test_cycles_grow_from_a_hopf_point_as_it_says_and_lead_back_to_it() -> None:
    problem = PeriodicProblem(BRUSSELATOR, {"A": Fraction(2), "B": Fraction(4)})
    (hopf,) = _curve(problem, [2, 2], (1, 5 / 2)).hopf
    (family,) = families_from([hopf], (1, 5 / 2))
    first, last = family.members[0], family.members[-1]
    assert family.born is hopf
    assert last.value < 1
    # |z|^2 = -speed (a - a_0) / (omega l_1), z the first Fourier coefficient along q.
    states = first.orbit.loop[:-1]
    wave = np.exp(-2j * pi * np.arange(len(states)) / len(states))
    size = np.linalg.norm((states * wave[:, None]).mean(axis=0))
    right = -hopf.speed * (first.value - hopf.value) / (hopf.frequency * hopf.lyapunov)
    assert size**2 == pytest.approx(right, rel=0.01)
    back = PeriodicProblem(BRUSSELATOR, {"A": Fraction(3, 2), "B": Fraction(4)})
    orbit = correct(back, family.members[12].orbit.point, family.members[12].orbit.period)
    ended = continue_orbit(back, orbit, "A", (1, 5 / 2))
    assert [each.value for each in ended.hopf] == [pytest.approx(sqrt(3), abs=1e-15)]
    assert "ends at a Hopf point" in ended.reason
    assert cycles_of(hopf, (1, 5 / 2)).members[0].value == first.value


FILE = """\
name = "brusselator"
state = "x y"
parameters = "A B"
field = {"x": "A - (B + 1)*x + x**2*y", "y": "B*x - x**2*y"}
"""


def test_the_command_tells_equilibria_and_hopf_points(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("brusselator.py").write_text(FILE)
    words = ["equilibria", "--system", "brusselator.py", "--parameter", "A=2", "B=4", "--start", "x=1.8", "y=2.1"]
    assert main([*words, "--along", "A", "1", "5/2", "--curve", "curve.csv", "--json"]) == 0
    output = json.loads(capsys.readouterr().out)
    point, curve = output["results"]
    assert point["point"] == {"x": pytest.approx(2), "y": pytest.approx(2)}
    assert point["unstable"] == 0
    (hopf,) = curve["special"]
    assert (hopf["kind"], hopf["side"], hopf["stable_orbits"]) == ("Hopf", "below", True)
    rows = Path("curve.csv").read_text().splitlines()
    assert rows[0].startswith("A,x,y,eigenvalue1 real")
    assert len(rows) == curve["points"] + 1
    assert main([*words, "--along", "A", "1", "5/2", "--quiet"]) == 0
    lines = capsys.readouterr()
    assert "Hopf: A = 1.73205080756888" in lines.out
    assert not lines.err


def test_what_the_command_writes_is_proved(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("brusselator.py").write_text(FILE)
    words = ["equilibria", "--system", "brusselator.py", "--parameter", "A=2", "B=4", "--start", "x=2", "y=2"]
    words += ["--along", "A", "1", "5/2", "--digits", "30", "-o", "claims.json", "--quiet"]
    assert main([*words, "--claims", "all"]) == 0
    claims = read_claims(Path("claims.json"))
    assert [claim.id for claim in claims] == ["brusselator-equilibrium", "brusselator-hopf-1"]
    rest, hopf = map(certify, claims)
    assert rest.proved
    assert hopf.proved
    assert (hopf.results.side, float(hopf.results.speed.mid())) == ("below", pytest.approx(-sqrt(3)))
    assert float(hopf.results.lyapunov.mid()) == pytest.approx(-0.20619652, abs=1e-8)
    capsys.readouterr()
    assert main([*words[:9], "--along", "A", "9/5", "5/2", "-o", "none.json", "--quiet"]) == 1
    assert "no Hopf point on the way" in capsys.readouterr().err


def test_a_curve_in_pieces_is_proved_through_its_folds() -> None:
    problem = _problem({"x": "a + x - x**3", "y": "x - y"}, "0")
    found = FoundEquilibrium(problem, equilibrium_near(problem, [1, 1]))
    covered = cover_equilibria(found, "a", (-1 / 2, 1 / 2), "cubic")
    assert covered.reaches
    (proof,) = verify.certify(covered.atlas, quiet=True, jobs=1)
    assert proof.proved
    assert proof.theorem is not None
    assert proof.theorem.count("It has a fold") == 2


def test_a_hopf_point_that_is_degenerate_is_no_claim() -> None:
    problem = _problem({"x": "a*x - y", "y": "x + a*y"}, "-1/10")
    (found,) = _curve(problem, [0, 0], (-1, 1)).hopf
    assert found.side is None
    with pytest.raises(RefinementFailure, match="vanishes there"):
        hopf_claim(found, "linear", 30)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--along", "C", "1", "2"], "--along C: brusselator has no such parameter; there are A, B"),
        (["--along", "A", "3", "4"], "--along A: 2, where the equilibrium is, lies outside"),
        (["--along", "A", "4", "3"], "--along A: an empty interval"),
        (["--cycles"], "--cycles: belongs to --along"),
        (["--along", "A", "1", "3", "--csv", "c.csv"], "--csv: belongs to --cycles"),
        (["--claims", "all"], "--claims: belongs to --along"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("brusselator.py").write_text(FILE)
    start = ["--parameter", "A=2", "B=4", "--start", "x=2", "y=2"]
    assert main(["equilibria", "--system", "brusselator.py", *start, *words]) == 2
    assert capsys.readouterr().err.startswith(f"error: {said}")


def test_equilibria_print_as_a_table_in_python() -> None:
    found = explore.find_equilibria(BRUSSELATOR, parameters={"A": 2, "B": 4}, quiet=True)
    assert repr(found).splitlines()[1].split()[:4] == ["[0]", "0", "-0.5", "+-"]
    curve = explore.follow_equilibrium(found[0], "A", (1, 2.5), quiet=True)
    assert [each.kind for each in curve.special] == ["Hopf"]
    with pytest.raises(ValueError, match="has no such parameter"):
        explore.follow_equilibrium(found[0], "C", (1, 2.5), quiet=True)


@pytest.mark.parametrize("start", [None, (0.0, 0.0, 0.0, 0.0)])
def test_a_forced_system_has_no_equilibria(start: tuple[float, ...] | None) -> None:
    """Where the two coordinates of the force are 0 there is no force."""
    field = {"x": "v", "v": "-x - v + cos(t)"}
    system = define_system({"name": "forced", "state": "x v", "field": field})
    with pytest.raises(PeriodicFailure, match="periodic force"):
        next(find_equilibria(system, {}, start, lambda *_: None))
