"""The planar CR3BP around a libration point: equations, libration points, families down to them."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from support.claims import known
from support.conclusions import conclude
from support.exact_elements import number
from support.stored import entry_of

from orbitproof.explore.__main__ import main
from orbitproof.explore.flow import flow_of
from orbitproof.explore.three_body.atlases import LyapunovFamily, lyapunov_atlas
from orbitproof.explore.three_body.masses import first_breaking
from orbitproof.explore.three_body.seeds import libration_point, lyapunov_orbit
from orbitproof.shared import InputError
from orbitproof.shared.claims import Atlas, Covers, Piece
from orbitproof.shared.formats import atlas_from_json, atlas_to_json, read_atlas, read_candidates
from orbitproof.shared.systems import (
    AROUND,
    BRANCH_SYSTEMS,
    CR3BP,
    CR3BP_AXIAL,
    MASS_PARAMETERS,
    SYSTEMS,
    DerivedParameter,
    ReversibleSystem,
)
from orbitproof.verify.algebra import Arithmetic, Grading
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.claim import check_symmetries, parities
from orbitproof.verify.curve import (
    PieceLimits,
    PieceResult,
    ProvedInterval,
    certified_systems,
    derived_parameter,
    in_units_of_orbit,
    parameter_series,
    prove_piece,
)
from orbitproof.verify.evidence import Checklist, IntegrationFailure, Proved, enclose
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.words.branches import conclusion_in_words
from orbitproof.verify.words.curve import meaning

EARTH_MOON = MASS_PARAMETERS["earth-moon"]
DIGITS = 60
FAST = PieceLimits(56, 24, 24)
WHOLE = (Fraction(-1), Fraction(1))


def root(point: str, mu: Any) -> Any:
    """The libration point to `DIGITS` digits, as the zero of the quintic in the distance from a primary."""
    inner = {"L1": -1, "L2": 1}.get(point)
    with mpmath.workdps(DIGITS + 10):
        if inner is None:
            # At x = -mu - r: the smaller primary is at the distance 1 + r.
            f = lambda r: r + mu - (1 - mu) / r**2 - mu / (1 + r) ** 2  # noqa: E731
            return -mu - mpmath.findroot(f, 1 - 7 * mu / 12)
        # At x = 1 - mu + inner r: the larger primary is at the distance 1 + inner r.
        f = lambda r: 1 - mu + inner * r - (1 - mu) / (1 + inner * r) ** 2 - inner * mu / r**2  # noqa: E731
        return 1 - mu + inner * mpmath.findroot(f, libration_point(point, float(mu)).distance)


@pytest.mark.parametrize("point", AROUND)
def test_the_field_is_the_difference_quotient_of_the_three_body_field(point: str) -> None:
    source = random.Random(point)
    with mpmath.workdps(DIGITS):
        for _ in range(5):
            mu = mpmath.mpf(source.uniform(0.001, 0.5))
            x_l = root(point, mu)
            size = abs(min(abs(x_l + mu), abs(x_l + mu - 1)))
            eps = mpmath.mpf(source.uniform(-0.2, 0.2)) * size
            x, y, vx, vy = (mpmath.mpf(source.uniform(-2, 2)) for _ in range(4))
            field = AROUND[point].vector_field((x, y, vx, vy), (mu, x_l, eps))
            full = CR3BP.vector_field((x_l + eps * x, eps * y, 0, eps * vx, eps * vy, 0), (mu,))
            for left, right in zip(field, (full[0], full[1], full[3], full[4]), strict=True):
                assert abs(left - right / eps) < mpmath.mpf(10) ** (15 - DIGITS)


@pytest.mark.parametrize("point", AROUND)
def test_at_size_zero_the_field_is_the_linearisation(point: str) -> None:
    source = random.Random(point)
    with mpmath.workdps(DIGITS):
        mu = mpmath.mpf(source.uniform(0.001, 0.5))
        x_l = root(point, mu)
        c = (1 - mu) / abs(x_l + mu) ** 3 + mu / abs(x_l + mu - 1) ** 3
        assert c > 1
        x, y, vx, vy = (mpmath.mpf(source.uniform(-2, 2)) for _ in range(4))
        wanted = (vx, vy, 2 * vy + (1 + 2 * c) * x, -2 * vx + (1 - c) * y)
        for left, right in zip(AROUND[point].vector_field((x, y, vx, vy), (mu, x_l, 0)), wanted, strict=True):
            assert abs(left - right) < mpmath.mpf(10) ** (5 - DIGITS)


@pytest.mark.parametrize("point", AROUND)
def test_the_system_is_reversible_and_nothing_else(point: str) -> None:
    system = AROUND[point]
    check_symmetries(Checklist(), system)
    for wrong in ((1, -1, 1, 1), (-1, -1, 1, 1), (-1, 1, 1, -1), (1, 1, -1, -1)):
        assert parities(system.program, wrong) != [-sign for sign in wrong]


def test_a_point_of_a_claim_is_the_size_and_the_speed() -> None:
    system = AROUND["L1"]
    assert system.centre_coordinates == ("eps", "vy")
    assert system.fixed_parameters == ("mu",)
    assert [system.state[i] for i in system.kernel_coordinates] == ["vx"]
    assert system.name in BRANCH_SYSTEMS
    assert system.name not in SYSTEMS


@pytest.mark.parametrize(
    "change",
    [
        {"normalised": {"vx": Fraction(1)}},
        {"normalised": {"u": Fraction(1)}},
        {"normalised": {}},
        {"derived_parameters": {"eps": DerivedParameter(lambda v, p: v, lambda p: (None, None))}},
        {"derived_parameters": {"u": DerivedParameter(lambda v, p: v, lambda p: (None, None))}},
    ],
)
def test_a_wrong_normalisation_or_derived_parameter_is_refused(change: dict[str, Any]) -> None:
    with pytest.raises(ValueError):
        replace(AROUND["L1"], **change)


@pytest.mark.parametrize("mu", [EARTH_MOON, Fraction(1, 2), Fraction(1, 3), Fraction(1, 10**20), Fraction(9, 10)])
@pytest.mark.parametrize("point", AROUND)
def test_the_libration_point_is_enclosed(point: str, mu: Fraction) -> None:
    found = derived_parameter(AROUND[point], "x_l", {"mu": mu}, 150)
    assert 0 < found.radius < Fraction(1, 2**149)
    low, high = {"L1": (-mu, 1 - mu), "L2": (1 - mu, Fraction(9)), "L3": (Fraction(-9), -mu)}[point]
    assert low < found.lower < found.upper < high
    with mpmath.workdps(DIGITS):
        exact = (
            root(point, number(mu))
            if mu <= Fraction(1, 2)
            else -root({"L1": "L1", "L2": "L3", "L3": "L2"}[point], number(1 - mu))
        )
        assert number(found.lower) < exact < number(found.upper)
    assert found.ball.contains(enclose(found.middle))


def derived_from(equation: Any, low: int | None, high: int | None) -> ReversibleSystem:
    return replace(
        AROUND["L1"], derived_parameters={"x_l": DerivedParameter(equation, lambda p: (low, high))}
    )  # fmt: skip


@pytest.mark.parametrize(
    ("equation", "low", "high"),
    [
        (lambda v, p: (v[0] ** -1,), -1, 2),
        (lambda v, p: (v[0] * v[0] + 1,), -1, 1),
        (lambda v, p: (v[0] - 1,), -1, 1),
        (lambda v, p: (-1 * v[0],), None, None),
    ],
    ids=["pole", "positive", "zero at the end", "decreasing"],
)
def test_what_is_no_zero_is_not_enclosed(equation: Any, low: int | None, high: int | None) -> None:
    with pytest.raises(IntegrationFailure, match="not enclosed"):
        derived_parameter(derived_from(equation, low, high), "x_l", {"mu": EARTH_MOON}, 60)


def test_a_derived_parameter_enters_the_algebra_with_its_error() -> None:
    arithmetic = Arithmetic(Grading((1,), 1), 70, 5, 8)
    series = parameter_series(arithmetic, AROUND["L1"], {"mu": EARTH_MOON})["x_l"]
    with mpmath.workdps(DIGITS):
        known_part = mpmath.mpf(int(series.coefs[0][0])) / 2**70
        assert 0 < abs(root("L1", number(EARTH_MOON)) - known_part) <= series.errors[0] < 2.0**-68
    assert series.errors[1:] == [0.0, 0.0]


@pytest.fixture(scope="module")
def family() -> LyapunovFamily:
    return LyapunovFamily("L1", EARTH_MOON)


@pytest.fixture(scope="module")
def atlas(family: LyapunovFamily) -> Atlas:
    return lyapunov_atlas(family, "earth-moon", None, -1, 1e-8)


def test_the_family_starts_with_the_linear_centre(family: LyapunovFamily) -> None:
    linear = lyapunov_orbit(family.libration, 1.0, 1)
    orbit = family.orbit(0.0)
    assert orbit.vy == pytest.approx(linear.direction[4], rel=1e-12)
    assert orbit.half_period == pytest.approx(linear.half_period, rel=1e-12)


def test_the_pieces_are_orbits_of_the_three_body_problem(atlas: Atlas, family: LyapunovFamily) -> None:
    """In its own coordinates, and where S breaks they pass through the point that is known otherwise."""
    (piece,) = atlas.curve_pieces()
    mu, x_l = float(EARTH_MOON), family.libration.x
    for s in np.linspace(-1, 1, 8):
        eps, vy = (float(value) for value in piece.point(Fraction(float(s))))
        state = [x_l + eps, 0.0, 0.0, 0.0, eps * vy, 0.0]
        end = flow_of(CR3BP).derivative(state, family.orbit(eps).half_period, [mu]).state
        assert max(abs(end[1]), abs(end[3])) < 1e-11
    breaking = first_breaking("L1", EARTH_MOON)
    eps = breaking.x - x_l
    assert eps == pytest.approx(family.symmetry_breaking(-1), rel=1e-9)
    s = (Fraction(eps) - piece.centre[0]) / piece.half_width
    assert -1 < s < 1
    assert float(piece.point(s)[1]) == pytest.approx(breaking.vy / eps, rel=1e-9)


def test_every_family_has_an_atlas() -> None:
    """To an end, on the other side, in several pieces that overlap."""
    found = lyapunov_atlas(LyapunovFamily("L3", Fraction(1, 10)), "0.1", 0.6, 1, 1e-8)
    pieces = found.curve_pieces()
    assert len(pieces) > 1
    assert pieces[0].centre[0] - pieces[0].half_width < 0
    assert pieces[-1].centre[0] + pieces[-1].half_width > Fraction(59, 100)
    for before, after in pairwise(pieces):
        place = before.centre[0] + before.half_width
        s = (place - after.centre[0]) / after.half_width
        assert -1 < s < -0.8
        assert abs(before.point(Fraction(1))[1] - after.point(s)[1]) < after.tube[0] / 1000


@pytest.fixture(scope="module")
def proved(atlas: Atlas) -> PieceResult[ProvedInterval]:
    (piece,) = atlas.curve_pieces()
    return prove_piece(atlas.system, atlas.parameters, piece, WHOLE, ORACLE, FAST)


@pytest.fixture(scope="module")
def breaking() -> Certificate:
    return certify(known("em1"), Limits(max_precision=512))


def test_the_family_is_proved_down_to_the_libration_point(
    atlas: Atlas, proved: PieceResult[ProvedInterval], breaking: Certificate
) -> None:
    """With the certified symmetry breaking of the halo orbits on it, and the speed of the linear centre at eps = 0."""
    assert isinstance(proved.outcome, Proved)
    conclusion = conclude(atlas, [entry_of(proved)], [breaking])
    assert isinstance(conclusion.outcome, Proved)
    on = [entry.id for entry in conclusion.bifurcations if entry.place is not None]
    assert on == ["earth-moon-L1-halo-k1-1"]
    words = conclusion_in_words(conclusion)
    assert "emanates from L1" in words
    assert "x_l is the only root X of X = (1 - mu)/(X + mu)^2 - mu/(X - 1 + mu)^2 between" in words
    assert "the initial point x = 1, y = 0" in words
    assert conclusion.outcome.results.ends["start"]["eps"] < 0 < conclusion.outcome.results.ends["end"]["eps"]
    (piece,) = atlas.curve_pieces()
    with mpmath.workdps(DIGITS):
        mu = number(EARTH_MOON)
        x_l = root("L1", mu)
        c = (1 - mu) / abs(x_l + mu) ** 3 + mu / abs(x_l + mu - 1) ** 3
        half = 1 - c / 2
        square = half + mpmath.sqrt(half**2 - (1 + 2 * c) * (1 - c))
        speed = -(square + 1 + 2 * c) / 2
        middle = piece.point(-piece.centre[0] / piece.half_width)
        assert middle[0] == 0
        assert abs(number(middle[1]) - speed) < number(proved.outcome.results.deviation[0])


def test_a_bifurcation_of_another_point_or_mass_is_not_on_the_family(
    atlas: Atlas, proved: PieceResult[ProvedInterval], breaking: Certificate
) -> None:
    for system, parameters in ((AROUND["L2"], atlas.parameters), (atlas.system, {"mu": EARTH_MOON / 2})):
        other = replace(atlas, system=system, parameters=parameters)
        (entry,) = conclude(other, [entry_of(proved)], [breaking]).bifurcations
        assert entry.place is None


@pytest.mark.parametrize("claim", ["true", "beside", "another mass"])
def test_only_the_family_of_that_mass_is_proved(atlas: Atlas, claim: str) -> None:
    """On a short part of the piece, by an expansion of low degree that is enough for what is true."""
    (piece,), mu = atlas.curve_pieces(), EARTH_MOON
    if claim == "beside":
        (row,) = piece.polynomial
        piece = replace(piece, polynomial=((row[0] + 2 * piece.tube[0], *row[1:]),))
    elif claim == "another mass":
        mu *= Fraction(1000001, 1000000)
    part = (Fraction(0), Fraction(1, 8))
    result = prove_piece(atlas.system, {"mu": mu}, piece, part, ORACLE, PieceLimits(48, 20, 8))
    assert result.is_proved == (claim == "true")
    assert claim == "true" or "of the tube" in entry_of(result)["reason"]["message"]


def test_a_point_is_written_in_units_of_its_orbit() -> None:
    parameters = {"mu": EARTH_MOON}
    centre = dict(zip(CR3BP.centre_coordinates, known("em1").centre, strict=True))
    with ctx.workprec(200):
        point = {name: enclose(value) for name, value in centre.items()}
        found = in_units_of_orbit(AROUND["L1"], parameters, point)
        assert found is not None
        with mpmath.workdps(DIGITS):
            eps = number(centre["x"]) - root("L1", number(EARTH_MOON))
            for name, exact in (("eps", eps), ("vy", number(centre["vy"]) / eps)):
                low, high = (
                    mpmath.mpf(str(end.str(50, radius=False))) for end in (found[name].lower(), found[name].upper())
                )
                assert low - mpmath.mpf(10) ** -45 < exact < high + mpmath.mpf(10) ** -45
                assert high - low < mpmath.mpf(10) ** -40
        wide = {**point, "x": point["x"] + arb(0, 1)}
        assert in_units_of_orbit(AROUND["L1"], parameters, wide) is None
    assert certified_systems(AROUND["L1"]) == (CR3BP, CR3BP_AXIAL)
    assert certified_systems(CR3BP) == (CR3BP,)


def test_only_a_curve_across_zero_is_said_to_emanate_from_the_point(atlas: Atlas) -> None:
    assert "emanates" in meaning(atlas)
    assert atlas.claim.covers is not None
    for start, end in ((Fraction(-1, 100), Fraction(-1, 1000)), (Fraction(1, 1000), Fraction(1, 100))):
        beside = replace(atlas, claim=replace(atlas.claim, covers=Covers("eps", start, end)))
        assert "emanates" not in meaning(beside)
    assert meaning(replace(atlas, claim=replace(atlas.claim, increasing=()))) == ""
    assert meaning(replace(atlas, system=CR3BP)) == ""


def test_command_writes_the_atlas(tmp_path: Path, capsys: pytest.CaptureFixture[str], atlas: Atlas) -> None:
    path = tmp_path / "lyapunov.json"
    assert main(["atlas-libration", "--point", "L1", "--mass", "earth-moon", "-o", str(path)]) == 0
    assert "1 piece over eps from -0.0143" in capsys.readouterr().err
    written = read_atlas(path)
    assert atlas_to_json(written) == atlas_to_json(atlas)
    assert written.system is AROUND["L1"]


@pytest.mark.parametrize("point", ["L1", "L2"])
def test_axial_orbits_are_born_where_their_birth_is_certified(point: str) -> None:
    """Of L2 beyond a place where orbits change so fast that Newton's method needs shorter steps."""
    family = LyapunovFamily(point, EARTH_MOON)
    births = read_candidates(Path(__file__).parents[1] / "data" / "axial-births.json")
    (birth,) = (item for item in births if item.id == f"earth-moon-{point}-axial-k1-1")
    assert abs(family.libration.x + family.symmetry_breaking(-1, "axial") - float(birth.centre[0])) < 1e-9


def test_births_at_l3_are_found_where_half_orbits_of_other_families_are_near() -> None:
    """Near the larger primary Newton's method may lead to an orbit run through twice, or to one about that primary."""
    family = LyapunovFamily("L3", EARTH_MOON)
    assert abs(family.libration.x + family.symmetry_breaking(1, "axial") + 0.1091210908) < 1e-9


def test_a_parameter_that_follows_from_others_is_not_given(atlas: Atlas) -> None:
    document = atlas_to_json(atlas)
    document["parameters"]["x_l"] = "0.5"
    with pytest.raises(InputError, match="mu"):
        atlas_from_json(document, "atlas.json")


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["--mass", "2"], 2, "outside"),
        (["--mass", "moon"], 2, "neither a name"),
        (["--mass", "0.1", "--end", "0"], 2, "--end 0"),
        (["--mass", "0.1", "--end", "0.01", "--side", "left"], 2, "--side"),
        (["--mass", "0.1", "--end", "0.01", "--through", "axial"], 2, "--through"),
        (["--mass", "0.1", "--tube", "0.1"], 2, "--tube"),
        (["--mass", "0.1", "--end", "5"], 1, "at eps ="),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str], code: int, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "a.json"
    assert main(["atlas-libration", "--point", "L1", *arguments, "-o", str(output), "--quiet"]) == code
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert message in lines[0]
    assert not output.exists()


def test_pieces_are_exact(atlas: Atlas) -> None:
    """What is written and read again is the same piece, and eps is its first coordinate."""
    piece: Piece = atlas.curve_pieces()[0]
    assert piece.point(Fraction(0))[0] == piece.centre[0]
    assert piece.point(Fraction(1))[0] - piece.point(Fraction(0))[0] == piece.half_width
