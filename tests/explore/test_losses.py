"""Points at which R is lost: refined from a guess and from a list, and proved."""

from __future__ import annotations

from fractions import Fraction
from math import sqrt
from pathlib import Path
from typing import Any

import pytest
from support import breaking_cases as cases
from support import krein_cases, stability_cases
from support.stored import values

from orbitproof.explore.__main__ import main
from orbitproof.explore.losses import tasks_of
from orbitproof.explore.points import refine_at
from orbitproof.explore.refinement import RefinementFailure, refine_task
from orbitproof.explore.refinement.krein import refuse_off_circle
from orbitproof.shared.claims import Atlas, Claim, Piece
from orbitproof.shared.formats import KREIN_COLLISION, REVERSOR_BREAKING
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.certificate import certify, write_certificate

ROOT = sqrt(cases.level_of(odd=True))


def refined(vy: float, **more: Any) -> Any:
    point = {"x": 1e-9, "vy": vy}
    return refine_at(cases.MODES, point, 1, parameters={"a": cases.A}, kind=REVERSOR_BREAKING, quiet=True, **more)


def test_a_guess_becomes_a_claim_that_is_proved() -> None:
    claim = refined(ROOT + 1e-5)
    assert abs(claim.centre[0] - cases.level_of(odd=True)) < Fraction(1, 10**50)
    assert claim.level_sign == 1
    certificate = certify(claim)
    assert certificate.proved
    assert certificate.side == "above"
    assert refined(-ROOT).level_sign == -1


def test_what_is_no_loss_is_not_refined() -> None:
    with pytest.raises(RefinementFailure):
        refined(2.0)
    with pytest.raises(ValueError, match="k = 1"):
        refine_at(cases.MODES, {"x": 0.0, "vy": ROOT}, 2, kind=REVERSOR_BREAKING)


def test_points_of_a_list_become_claims() -> None:
    middle = Fraction(ROOT + 1e-6)
    piece = Piece(
        id="mode",
        kind="regular",
        centre=(Fraction(0), middle),
        frame=((Fraction(0), Fraction(1)), (Fraction(1), Fraction(0))),
        half_width=Fraction(1, 100),
        polynomial=((Fraction(0),),),
        tube=(Fraction(1, 10**6),),
    )
    atlas = Atlas("modes", "normal modes", cases.MODES, {"a": cases.A}, Claim(kind="arc"), (piece,))
    places = [("loss of R", "0x0"), ("fold", "0x1p-1"), ("loss of R", "0x1p-12")]
    listed = {"points": [{"kind": kind, "piece": "mode", "s": {"mid": s, "rad": "0x0"}} for kind, s in places]}
    tasks = tasks_of(atlas, listed, 40)
    assert [task.id for task in tasks] == ["modes-loss-1", "modes-loss-2"]
    assert tasks[1].guess == (0.0, pytest.approx(float(middle) + 0.01 / 4096))
    found = refine_task(tasks[0])
    assert found.candidate is not None
    assert certify(found.candidate).proved


def collision(point: dict[str, float], **more: Any) -> Any:
    parameters = {"omega": "3/10", "a": "1", "b": "-1/2", **more}
    return refine_at(krein_cases.CLOCK, point, 1, parameters=parameters, kind=KREIN_COLLISION, quiet=True, digits=30)


def test_a_guess_becomes_a_claim_of_a_collision_that_is_proved() -> None:
    claim = collision({"x": -1.5001, "x1": 1e-5, "x2": -1e-5})
    assert abs(claim.centre[0] - krein_cases.LEVEL) < Fraction(1, 10**30)
    assert claim.level_sign == -1
    certificate = certify(claim)
    assert certificate.proved
    assert certificate.side == "below"


def test_what_is_no_collision_is_not_refined() -> None:
    with pytest.raises(RefinementFailure):
        collision({"x": 1.7, "x1": 0.0, "x2": 0.0})
    point = {"x": 0.0, "vy": ROOT}
    with pytest.raises(RefinementFailure, match="two pairs"):
        refine_at(cases.MODES, point, 1, parameters={"a": cases.A}, kind=KREIN_COLLISION, quiet=True)


@pytest.mark.parametrize("parameter", [-3.58, -1.02, 1.02])
def test_where_real_multipliers_meet_there_is_no_claim(parameter: float) -> None:
    with pytest.raises(RefinementFailure, match="where multipliers are real"):
        refuse_off_circle(parameter)
    for other in (-1.005, 0.3, 1.0):
        refuse_off_circle(other)


def test_collisions_of_a_list_become_claims() -> None:
    piece = Piece(
        id="clock",
        kind="regular",
        centre=(Fraction(3, 2), Fraction(0), Fraction(0)),
        frame=tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3)),
        half_width=Fraction(1, 100),
        polynomial=((Fraction(0),), (Fraction(0),)),
        tube=(Fraction(1, 10**6),) * 2,
    )
    system, parameters = krein_cases.CLOCK, krein_cases.clock().parameters
    atlas = Atlas("clock", "rest", system, parameters, Claim(kind="arc"), (piece,))
    places = [("loss of R", "0x0"), ("Krein collision", "0x1p-8")]
    listed = {"points": [{"kind": kind, "piece": "clock", "s": {"mid": s, "rad": "0x0"}} for kind, s in places]}
    (task,) = tasks_of(atlas, listed, 30, KREIN_COLLISION)
    assert (task.id, task.kind) == ("clock-collision-1", KREIN_COLLISION)
    found = refine_task(task)
    assert found.candidate is not None
    assert certify(found.candidate).proved


def test_what_is_no_certificate_of_a_curve_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "list.json"
    path.write_text("{}", encoding="utf-8")
    assert main(["losses", str(path), "-o", str(tmp_path / "losses.json"), "--quiet"]) == 2
    assert "list.json" in capsys.readouterr().err


def test_a_list_without_losses_is_told_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, output = tmp_path / "list.json", tmp_path / "losses.json"
    found = stability_cases.results()
    conclusion = stability_cases.listed(found)
    write_certificate(path, make_atlas_certificate(stability_cases.atlas(), values(found), conclusion))
    assert main(["losses", str(path), "-o", str(output), "--quiet"]) == 1
    assert "no point of the kind reversor_breaking" in capsys.readouterr().err
    assert not output.exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mass", "point", "level"),
    [
        ("earth-moon", (0.92994, 0.28725, 0.08173), "2.947009569188494484384445144117"),
        ("sun-jupiter", (0.988455, 0.125671, 0.014828), "2.995335576627487149713525004734"),
    ],
)
def test_the_halo_orbits_of_the_chapter_lose_r(mass: str, point: tuple[float, ...], level: str) -> None:
    guess = dict(zip(("x", "z", "vy"), point, strict=True))
    claim = refine_at(CR3BP, guess, 1, parameters={"mu": mass}, kind=REVERSOR_BREAKING, quiet=True)
    certificate = certify(claim)
    assert certificate.proved
    assert certificate.side == "below"
    assert level in str(certificate)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mass", "point", "level", "sign"),
    [
        ("earth-moon", (0.92854, 0.29456, 0.0818), "2.94067371706073966745762740204", -1),
        ("sun-jupiter", (0.98817185, 0.12908558, 0.014858515), "2.99406298196303494248411865529", 1),
    ],
)
def test_the_halo_orbits_of_the_chapter_collide(mass: str, point: tuple[float, ...], level: str, sign: int) -> None:
    guess = dict(zip(("x", "z", "vy"), point, strict=True))
    claim = refine_at(CR3BP, guess, 1, parameters={"mu": mass}, kind=KREIN_COLLISION, quiet=True)
    certificate = certify(claim)
    assert certificate.proved
    assert certificate.side == "above"
    assert level in str(certificate)
    assert certificate.normal_form["b"] * sign > 0
