"""The CR3BP around a libration point in units of vertical orbits: equations, families, what their curves prove."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import cast

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from support.balls import agree
from support.conclusions import conclude
from support.stored import entry_of

from orbitproof.explore.__main__ import main
from orbitproof.explore.flow import flow_of
from orbitproof.explore.three_body.atlases import VerticalFamily, vertical_atlas
from orbitproof.explore.three_body.atlases.lyapunov import LEAST_DECAY, decay, expansion
from orbitproof.explore.three_body.atlases.vertical import TurningVerticalFamily
from orbitproof.explore.three_body.seeds import libration_point
from orbitproof.shared.claims import REVERSOR_BREAKING, Atlas, Claim
from orbitproof.shared.claims.web import How, Meeting, Web, WebArc
from orbitproof.shared.formats import read_atlas, read_candidates
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_AXIAL, MASS_PARAMETERS, VERTICAL
from orbitproof.verify.claim import check_symmetries, signs_on
from orbitproof.verify.curve import (
    CertifiedPoint,
    PieceLimits,
    PieceResult,
    ProvedInterval,
    enclose_other_point,
    jacobi_constant,
    prove_piece,
)
from orbitproof.verify.curve import conclude as concluded
from orbitproof.verify.curve.vertical_family import in_units_of_vertical_orbit
from orbitproof.verify.evidence import Checklist, NotProved, Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.reversor_breaking import BreakingResults, is_shifted_by
from orbitproof.verify.web import Arc, WebTheorem, conclude_web
from orbitproof.verify.words.branches import conclusion_in_words
from orbitproof.verify.words.web import web_in_words

EARTH_MOON = MASS_PARAMETERS["earth-moon"]
BIRTHS = Path(__file__).parents[2] / "docs" / "webs" / "vertical-births.json"
FAST = PieceLimits(56, 24, 24)
WHOLE = (Fraction(-1), Fraction(1))
END = 0.06


@pytest.mark.parametrize("point", VERTICAL)
def test_the_field_is_that_of_the_three_body_problem(point: str) -> None:
    """At random states, with the products of z and z' for u, v, w, and at size 0 as a limit."""
    source, system = random.Random(point), VERTICAL[point]
    check_symmetries(Checklist(), system)
    with mpmath.workdps(60):
        for _ in range(5):
            mu = mpmath.mpf(source.uniform(0.001, 0.5))
            near = libration_point(point, float(mu)).x
            x_l = mpmath.findroot(lambda x, m=mu: AROUND[point].derived_parameters["x_l"].equation((x,), (m,))[0], near)
            size = abs(min(abs(x_l + mu), abs(x_l + mu - 1)))
            eps = mpmath.mpf(source.uniform(0.05, 0.2)) * size
            x, y, vx, vy, z, vz = (mpmath.mpf(source.uniform(-2, 2)) for _ in range(6))
            state = (x, y, vx, vy, z * z, z * vz, vz * vz)
            found = system.vector_field(state, (mu, x_l, eps**2))
            scaled = (x_l + eps**2 * x, eps**2 * y, eps * z, eps**2 * vx, eps**2 * vy, eps * vz)
            *_, ax, ay, az = CR3BP.vector_field(scaled, (mu,))
            ax, ay, az = ax / eps**2, ay / eps**2, az / eps
            wanted = (vx, vy, ax, ay, 2 * z * vz, vz * vz + z * az, 2 * vz * az)
            assert all(abs(a - b) < mpmath.mpf(10) ** -40 for a, b in zip(found, wanted, strict=True))
            small = system.vector_field(state, (mu, x_l, mpmath.mpf(10) ** -40))
            rest = system.vector_field(state, (mu, x_l, mpmath.mpf(0)))
            assert all(abs(a - b) < mpmath.mpf(10) ** -30 for a, b in zip(small, rest, strict=True))


@pytest.fixture(scope="module")
def family() -> VerticalFamily:
    return VerticalFamily("L1", EARTH_MOON)


@pytest.fixture(scope="module")
def atlas(family: VerticalFamily) -> Atlas:
    found = vertical_atlas(family, "earth-moon", END, 1e-7)
    assert len(found.pieces) == 1
    return found


@pytest.fixture(scope="module")
def proved(atlas: Atlas) -> PieceResult[ProvedInterval]:
    (piece,) = atlas.curve_pieces()
    return prove_piece(atlas.system, atlas.parameters, piece, WHOLE, ORACLE, FAST)


@pytest.fixture(scope="module")
def beyond() -> VerticalFamily:
    return VerticalFamily("L3", EARTH_MOON)


@pytest.mark.slow
def test_pieces_of_l3_where_x_is_small_beside_vy_are_wide(beyond: VerticalFamily) -> None:
    x, vy = expansion(beyond, -0.002, 0.1)
    assert abs(x[0]) < abs(vy[0]) / 100
    assert max(len(x), len(vy)) < 12
    assert decay(beyond, -0.002, 0.1, [x, vy]) > 2 * LEAST_DECAY


def test_where_eps2_turns_around_the_family_of_l3_goes_on_over_vy(beyond: VerticalFamily) -> None:
    turning = TurningVerticalFamily(beyond)
    early = turning.orbit(0.52)
    assert turning.values(0.52) == pytest.approx((early.eps2, beyond.orbit(early.eps2).x), rel=1e-8)
    sizes = [turning.orbit(vy).eps2 for vy in (0.9, 0.98, 1.06)]
    assert sizes[0] < sizes[1] > sizes[2] > 0.99
    orbit = turning.orbit(1.2)
    top = flow_of(CR3BP).derivative(beyond.state(orbit), orbit.half_period, [float(EARTH_MOON)]).state
    assert np.abs(top[[1, 3, 5]]).max() < 1e-9


def test_r_is_lost_on_the_family_of_l3_where_that_is_certified(beyond: VerticalFamily) -> None:
    born = beyond.birth()
    top = flow_of(CR3BP).derivative(beyond.state(born), born.half_period, [float(EARTH_MOON)]).state
    (loss,) = (item for item in read_candidates(BIRTHS) if item.id == "earth-moon-L3-vertical-loss-of-R")
    assert [float(value) for value in loss.centre[1:]] == pytest.approx([top[0], top[2]], abs=1e-8)


@pytest.mark.slow
def test_a_piece_beyond_the_turn_is_proved(beyond: VerticalFamily) -> None:
    found = vertical_atlas(beyond, "earth-moon", None, 1e-7)
    assert found.claim.increasing == ("vy",)
    sizes = [float(piece.centre[0]) for piece in found.curve_pieces()]
    assert max(sizes) > sizes[-1] > 0.75
    assert prove_piece(found.system, found.parameters, found.curve_pieces()[-1], WHOLE, ORACLE, FAST).is_proved


@pytest.mark.slow
def test_a_vertical_orbit_is_at_rest_of_its_size_a_quarter_later(family: VerticalFamily) -> None:
    """In the coordinates of the CR3BP it starts on the axis and is on the plane y = 0 at right angles."""
    orbit, x_l = family.orbit(END), family.libration.x
    state = [x_l + END * orbit.x, 0.0, 0.0, 0.0, END * orbit.vy, END**0.5]
    top = flow_of(CR3BP).derivative(state, orbit.half_period, [float(EARTH_MOON)]).state
    assert np.abs(top[[1, 3, 5]]).max() < 1e-9
    assert abs(top[2]) > 0.1
    assert 4 * family.first.half_period == pytest.approx(2 * np.pi / family.libration.stiffness**0.5, rel=1e-12)


def test_the_family_is_proved_from_the_libration_point_on(
    atlas: Atlas, proved: PieceResult[ProvedInterval], family: VerticalFamily
) -> None:
    conclusion = conclude(atlas, [entry_of(proved)])
    assert isinstance(conclusion.outcome, Proved)
    assert [hypothesis.name for hypothesis in conclusion.outcome.hypotheses][-1] == "vertical"
    words = conclusion_in_words(conclusion)
    assert "the vertical family that emanates from L1" in words
    assert "periodic with the least period 4 T" in words
    with ctx.workprec(200):
        level = jacobi_constant(atlas.system, atlas.parameters, {name: arb(0) for name in ("eps2", "x", "vy")})
        assert level is not None
        assert float(level) == pytest.approx(family.libration.jacobi_constant, rel=1e-14)


@pytest.mark.parametrize("change", ["nothing", "not increasing", "from above 0", "a later return"])
def test_only_a_curve_from_the_first_quarter_at_rest_is_a_vertical_family(
    atlas: Atlas, proved: PieceResult[ProvedInterval], change: str
) -> None:
    claim, entry = atlas.claim, entry_of(proved)
    assert claim.covers is not None
    if change == "not increasing":
        claim = Claim(claim.kind, None, (), claim.covers)
    elif change == "from above 0":
        claim = replace(claim, covers=replace(claim.covers, start=Fraction(1, 100)))
    elif change == "a later return":
        entry = {**entry, "time": {"mid": "0x3p-1", "rad": "0x1p-4", "decimal": "1.5"}}
    conclusion = conclude(replace(atlas, claim=claim), [entry])
    assert conclusion.is_proved == (change in ("nothing", "not increasing"))
    if isinstance(conclusion.outcome, NotProved):
        assert conclusion.outcome.reason.condition == "vertical"


def ball(value: float, digits: int = 9) -> arb:
    return arb(value, 10.0**-digits)


def top_of(family: VerticalFamily, size: float) -> Mapping[str, arb]:
    orbit, x_l = family.orbit(size), family.libration.x
    state = [x_l + size * orbit.x, 0.0, 0.0, 0.0, size * orbit.vy, size**0.5]
    state = flow_of(CR3BP).derivative(state, orbit.half_period, [float(EARTH_MOON)]).state
    return {name: ball(float(state[CR3BP.state.index(name)]), 11) for name in ("x", "z", "vy")}


@pytest.fixture(scope="module")
def top(family: VerticalFamily) -> Mapping[str, arb]:
    """The highest point of an orbit of the atlas, on Fix(R)."""
    return top_of(family, END / 2)


CHANGES = {
    "nothing": {},
    "not shifted": {"shifted_by": ()},
    "half orbits of one crossing": {"crossings": 1},
    "another kind": {"kind": "orbit"},
}


@pytest.mark.parametrize("change", [*CHANGES, "another orbit", "another mass", "beyond the end"])
def test_a_loss_of_the_reversor_is_on_the_family_if_it_is_shifted_by_half_its_period(
    atlas: Atlas, proved: PieceResult[ProvedInterval], top: Mapping[str, arb], family: VerticalFamily, change: str
) -> None:
    claim = atlas
    if change == "another orbit":
        top = {**top, "vy": top["vy"] + arb(1e-3)}
    elif change == "beyond the end":
        top = top_of(family, 1.5 * END)
    elif change == "another mass":
        claim = replace(atlas, parameters={"mu": EARTH_MOON * Fraction(1001, 1000)})
    point = CertifiedPoint("v", REVERSOR_BREAKING, 1, crossings=2, point=top, shifted_by=("S",))
    point = replace(point, **CHANGES.get(change, {}))

    (entry,) = concluded(claim, [proved.stored], [point], partial(enclose_other_point, ORACLE)).bifurcations
    assert (entry.place is not None) == (change == "nothing"), entry.reason
    if change == "nothing":
        assert entry.point["eps2"].contains(END / 2) is True


def test_the_crossing_of_the_axis_is_between_the_two_points_of_the_plane(top: Mapping[str, arb]) -> None:
    parameters = {"mu": EARTH_MOON}
    found = enclose_other_point(ORACLE, CR3BP, parameters, top, 1, CR3BP_AXIAL)
    assert found is not None
    assert set(found) == {"x", "vy", "vz"}
    assert enclose_other_point(ORACLE, CR3BP, parameters, top, 1) is None
    at_rest = {**found, "vz": arb(0, 1e-3)}
    assert in_units_of_vertical_orbit(VERTICAL["L1"], parameters, at_rest) is None


@pytest.mark.parametrize("change", ["nothing", "beside the box", "the other sheet", "wide", "not known", "no symmetry"])
def test_a_shift_by_half_the_period_is_shown_by_the_box_alone(change: str) -> None:
    candidate = read_candidates(BIRTHS)[0]
    with ctx.workprec(200):
        level, x, z = (arb(value.numerator) / value.denominator for value in candidate.centre)
        away = {"beside the box": arb(2) ** -99, "wide": arb(0, 2.0**-90)}.get(change, arb(0))
        vy = arb(-1 if change == "the other sheet" else 1) * candidate.level_sign
        other = {"x": x + away, "z": -z, "vy": vy}
        if change == "not known":
            del other["z"]
        zero = arb(0)
        found = BreakingResults(
            {"x": x, "z": z, "vy": vy}, other, "Jacobi constant", level, "above", zero, {}, zero, zero, zero
        )
    if change == "no symmetry":
        signs = (1, 1, -1, -1, 1, -1)
        candidate = replace(candidate, system=replace(CR3BP, symmetries={"S": signs}, reversors={}))
        assert signs_on(candidate.system, "S", candidate.coordinates) == signs_on(CR3BP, "S", candidate.coordinates)
    assert is_shifted_by(candidate, found, "S") == (change == "nothing")


HOW = {
    "L1": ("ends at", "L1", ""),
    "another point": ("ends at", "L2", "not proved to be the family that shrinks to L2"),
    "a loss of R": ("passes through", "v", ""),
    "claimed halo": ("branches off at", "v", "no symmetric point of it"),
}


@pytest.mark.parametrize("meeting", HOW)
def test_in_a_web_it_ends_at_its_libration_point_and_passes_through_what_lies_on_it(
    atlas: Atlas, proved: PieceResult[ProvedInterval], top: Mapping[str, arb], meeting: str
) -> None:
    point = CertifiedPoint("v", REVERSOR_BREAKING, 1, crossings=2, point=top, shifted_by=("S",))
    found = concluded(atlas, [proved.stored], [point], partial(enclose_other_point, ORACLE))
    assert isinstance(found.outcome, Proved)
    arc = Arc(atlas, found.outcome.results, "", {entry.id: entry for entry in found.bifurcations})
    how, vertex, why = HOW[meeting]
    claim = Web("w", "a web", (WebArc(atlas.id, (Meeting(vertex, cast(How, how)),)),))
    outcome = conclude_web(claim, [arc])
    if why:
        assert isinstance(outcome, NotProved)
        assert why in outcome.reason.message
        return
    assert isinstance(outcome, Proved)
    (known,), (shown,) = outcome.results.arcs, outcome.results.vertices
    assert known.period.contains(4 * arb(0.72)) is True
    assert known.period.contains(2 * arb(0.72)) is False
    assert known.level.contains(shown.level) is True
    if vertex == "v":
        state = {**{name: arb(0) for name in CR3BP.state}, **top}
        assert agree(shown.level, jacobi(state)) is True
    assert "vertical, symmetric under R and the half turn" in web_in_words(
        WebTheorem(claim), outcome.results, {atlas.id: "digest", "v": "digest"}
    )


def jacobi(state: Mapping[str, arb]) -> arb:
    x, y, z, *speeds = (state[name] for name in CR3BP.state)
    mu = arb(EARTH_MOON.numerator) / EARTH_MOON.denominator
    first, second = ((x - place) ** 2 + y**2 + z**2 for place in (-mu, 1 - mu))
    potential = 2 * ((1 - mu) / first.sqrt() + mu / second.sqrt())
    return x**2 + y**2 + potential - sum((v**2 for v in speeds), arb(0))


def test_the_command_writes_the_family(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "vertical.json"
    command = ["atlas-libration", "--vertical", "--point", "L1", "--mass", "earth-moon", "-o", str(path)]
    assert main([*command, "--end", "0.01", "--quiet"]) == 0
    found = read_atlas(path)
    assert found.system is VERTICAL["L1"]
    assert found.id == "vertical-l1-earth-moon"
    assert main(["atlas", "--check", str(path), "--quiet"]) == 2
    assert "field system: cr3bp-l1-vertical" in capsys.readouterr().err
    for wrong, word in ((["--side", "left"], "--side"), (["--end", "-0.1"], "--end"), (["--through", "halo"], "--thr")):
        assert main([*command, *wrong, "--quiet"]) == 2
        assert word in capsys.readouterr().err
