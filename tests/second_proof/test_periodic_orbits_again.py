"""Periodic orbits without symmetry proved once more: closed forms, comparison with certificates, what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from flint import acb, arb, arb_mat, ctx
from support.balls import agree
from support.forgeries import changed, move
from support.periodic_cases import hopf, lorenz, oscillators, planar
from support.systems import described

from orbitproof.shared.formats import PeriodicOrbit, define_system
from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.verify import second_proof as package
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import Certificate, Limits, certify, write_certificates
from orbitproof.verify.evidence import ball_to_json
from orbitproof.verify.run.second_periodic import compare_multipliers
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import BadCertificate, NotProved, ProvedPeriodic, second_proof

bifurcation = import_module(f"{package.__name__}.periodic_bifurcation")
periodic = import_module(f"{package.__name__}.periodic")
stating = import_module(f"{package.__name__}.periodic_statement")
legs = import_module(f"{package.__name__}.legs")
newton = import_module(f"{package.__name__}.newton")
isolation = import_module(f"{package.__name__}.multipliers")
statement = import_module(f"{package.__name__}.statement")

CASES: dict[str, PeriodicOrbit] = {
    "on a slanted section": planar(Fraction(8)),
    "on a level": oscillators(
        system=described(
            name="oscillators",
            state="x y u v",
            field={"x": "8*y", "y": "-8*x", "u": "8*v", "v": "-16*u"},
            first_integral="x**2 + y**2",
        )
    ),
    "in space": replace(
        hopf(),
        system=described(
            name="hopf",
            state="x y w",
            parameters="c",
            where={"s": "1 - x**2 - y**2"},
            field={"x": "x*s - 8*y", "y": "8*x + y*s", "w": "-c*w"},
        ),
    ),
}


@pytest.fixture(scope="module")
def certificates() -> dict[str, dict[str, Any]]:
    return {name: certify(claim, Limits(digits=8)).to_json() for name, claim in CASES.items()}


QUICK = ("on a slanted section", "on a level")


@pytest.fixture(scope="module")
def proofs(certificates: dict[str, dict[str, Any]], recorded: Any) -> dict[str, ProvedPeriodic]:
    """The first as it was recorded, in short legs; the other by the function that users call."""
    found = {"on a slanted section": concluded(recorded), "on a level": second_proof(certificates["on a level"])}
    assert all(isinstance(each, ProvedPeriodic) for each in found.values()), str(found)
    return found  # type: ignore[return-value]


def test_orbits_of_closed_forms_are_proved_with_their_periods_and_multipliers(
    proofs: dict[str, ProvedPeriodic],
) -> None:
    with ctx.workprec(400):
        turn = arb.pi() / 4
        assert all(each.period.contains(turn) for each in proofs.values())
        (one,) = proofs["on a slanted section"].multipliers
        assert one.real.contains((-turn / 2).exp())
        angle = 8 * turn * arb(2).sqrt()
        expected = [acb(angle.cos(), angle.sin()), acb(angle.cos(), -angle.sin())]
        assert all(any(z.contains(e) for z in proofs["on a level"].multipliers) for e in expected)
    counts = {name: (each.inside, each.on, each.outside) for name, each in proofs.items()}
    assert counts == {"on a slanted section": (1, 0, 0), "on a level": (0, 2, 0)}
    assert all(float(ball.rad()) < 1e-15 for each in proofs.values() for ball in each.multipliers)


def test_hypotheses_are_shown_by_name(proofs: dict[str, ProvedPeriodic]) -> None:
    names = [h.name for h in proofs["on a level"].hypotheses]
    assert names == ["newton", "direction", "crossings", "gradient"]
    assert all(h.holds for each in proofs.values() for h in each.hypotheses)
    assert "mu" in proofs["on a level"].hypotheses[0].enclosures


@pytest.mark.parametrize("name", QUICK)
def test_certificates_agree(
    name: str, certificates: dict[str, dict[str, Any]], proofs: dict[str, ProvedPeriodic]
) -> None:
    found = compare(certificates[name], proofs[name])
    assert found.verdict == "agrees", found.reason
    assert "holds no other orbits" in found.reason


DIFFERENCES: dict[str, Callable[[dict[str, Any]], object]] = {
    "period": lambda c: move(c["results"]["period"], Fraction(1, 2**60)),
    "point.x": lambda c: move(c["results"]["point"]["x"], Fraction(1, 2**60)),
    "point:": lambda c: c["results"]["point"].pop("x"),
    "multiplier ": lambda c: move(c["results"]["multipliers"]["values"][0]["real"], Fraction(1, 2**40)),
    "outside the circle": lambda c: c["results"]["multipliers"].update(outside=1, inside=0),
    "another number of them": lambda c: c["results"]["multipliers"].update(outside=1),
    "1 for every orbit": lambda c: c["results"]["multipliers"].update(trivial=2),
    "not in the box": lambda c: c["statement"]["candidate"]["centre"].__setitem__(0, "0x10001p-16"),
    "level": lambda c: c["results"].update(level=c["results"]["period"]),
}


@pytest.mark.parametrize("what", DIFFERENCES)
def test_each_difference_is_reported(
    what: str, certificates: dict[str, dict[str, Any]], proofs: dict[str, ProvedPeriodic]
) -> None:
    found = compare(changed(certificates["on a slanted section"], DIFFERENCES[what]), proofs["on a slanted section"])
    assert found.verdict == "disagrees"
    assert what.rstrip(":") in found.reason


def test_a_stored_level_that_is_another_one_disagrees(
    certificates: dict[str, dict[str, Any]], proofs: dict[str, ProvedPeriodic]
) -> None:
    other = changed(certificates["on a level"], lambda c: move(c["results"]["level"], Fraction(1, 2**40)))
    assert compare(other, proofs["on a level"]).verdict == "disagrees"


def test_a_stored_level_that_only_overlaps_is_not_confirmed(
    certificates: dict[str, dict[str, Any]], proofs: dict[str, ProvedPeriodic]
) -> None:
    """A ball that is much wider than the enclosure here, and ends within it."""
    proof, wide = proofs["on a level"], Fraction(1, 2**40)
    exact = parse_exact(certificates["on a level"]["statement"]["candidate"]["level"])
    beside = {"mid": format_exact(exact + wide), "rad": format_exact(wide)}
    stated = changed(certificates["on a level"], lambda c: c["results"].update(level=beside))
    found = compare(stated, replace(proof, level=arb(int(exact), 2.0**-60)))
    assert found.verdict == "cannot follow"
    assert "level" in found.reason


def test_counts_that_are_not_shown_here_are_not_confirmed(
    certificates: dict[str, dict[str, Any]], proofs: dict[str, ProvedPeriodic]
) -> None:
    unknown = replace(proofs["on a level"], on=0)
    assert compare(certificates["on a level"], unknown).verdict == "cannot follow"
    name = "on a slanted section"
    assert compare(certificates[name], replace(proofs[name], inside=0)).verdict == "cannot follow"
    nothing = replace(proofs[name], multipliers=(acb(arb("nan")),))
    assert compare(certificates[name], nothing).verdict != "agrees"


def test_stored_balls_have_one_multiplier_each(
    certificates: dict[str, dict[str, Any]], proofs: dict[str, ProvedPeriodic]
) -> None:
    def ball(middle: int, radius: int) -> dict[str, dict[str, str]]:
        real = {"mid": format_exact(Fraction(middle)), "rad": format_exact(Fraction(radius))}
        return {"real": real, "imaginary": {"mid": "0x0", "rad": "0x1"}}

    proof = replace(proofs["on a level"], multipliers=(acb(1), acb(3)))
    for values, verdict, words in (
        ((ball(1, 1), ball(4, 1)), "agrees", ""),
        ((ball(2, 2), ball(9, 1)), "disagrees", "another number"),
        ((ball(2, 2), ball(2, 3)), "cannot follow", "either of two"),
        ((ball(2, 2), ball(2, 2)), "agrees", ""),
    ):
        stated = changed(
            certificates["on a level"],
            lambda c: c["results"]["multipliers"].update(values=list(values)),  # noqa: B023
        )
        found = compare(stated, proof)
        assert (found.verdict, words in found.reason) == (verdict, True), found.reason


def test_a_point_that_may_be_outside_of_the_box_is_not_confirmed(
    certificates: dict[str, dict[str, Any]], proofs: dict[str, ProvedPeriodic]
) -> None:
    name = "on a slanted section"
    wide = {key: arb(value.mid(), 2.0**-60) for key, value in proofs[name].point.items()}
    found = compare(certificates[name], replace(proofs[name], point=wide))
    assert (found.verdict, "too wide to tell" in found.reason) == ("cannot follow", True)


REFUSED: dict[str, tuple[str, Callable[[dict[str, Any]], object]]] = {
    "the other direction": ("", lambda c: c["statement"]["candidate"].update(direction=1)),
    "a box off the section": ("section", lambda c: c["statement"]["candidate"].update(offset="0x1p-90")),
}


@pytest.mark.parametrize("what", REFUSED)
def test_false_claims_are_not_proved(what: str, certificates: dict[str, dict[str, Any]]) -> None:
    word, change = REFUSED[what]
    found = second_proof(changed(certificates["on a slanted section"], change))
    assert isinstance(found, NotProved)
    assert word in found.reason


@pytest.mark.slow
def test_an_orbit_run_through_twice_is_not_proved(certificates: dict[str, dict[str, Any]]) -> None:
    twice = changed(certificates["in space"], lambda c: c["statement"]["candidate"].update(crossings=2))
    found = second_proof(twice)
    assert isinstance(found, NotProved)
    assert "least period" in found.reason


@pytest.mark.slow
def test_an_orbit_in_space_is_proved_and_agrees(certificates: dict[str, dict[str, Any]]) -> None:
    found = second_proof(certificates["in space"])
    assert isinstance(found, ProvedPeriodic), str(found)
    small, middle = sorted(found.multipliers, key=lambda z: float(z.real.mid()))
    with ctx.workprec(400):
        assert small.real.contains((-arb.pi() / 2).exp())
        assert middle.real.contains((-arb.pi() / 16).exp())
    assert compare(certificates["in space"], found).verdict == "agrees"


def test_a_level_that_is_no_first_integral_is_not_proved(certificates: dict[str, dict[str, Any]]) -> None:
    """With x^2 + 2 y^2 the term in the field does not vanish, or the gradient is not across the field."""
    program = "v0 = x\nv1 = y\nv2 = u\nv3 = v\nv4 = v0 * v0\nv5 = v1 * v1\nv6 = v4 + v5\nv7 = v6 + v0\nreturn v7"

    def change(c: dict[str, Any]) -> None:
        c["statement"]["first_integral"] = program
        c["statement"]["candidate"]["level"] = "0x6"

    assert isinstance(second_proof(changed(certificates["on a level"], change)), NotProved)


BAD: dict[str, Callable[[dict[str, Any]], object]] = {
    "statement.vector_field": lambda c: c["statement"].update(vector_field="v0 = x\nreturn v7"),
    "statement.candidate.centre": lambda c: c["statement"]["candidate"].update(centre=[1.5]),
    "statement.candidate": lambda c: c["statement"]["candidate"].update(direction=2),
    "statement.candidate.parameters": lambda c: c["statement"]["candidate"].update(parameters={}),
}


@pytest.mark.parametrize("field", BAD)
def test_bad_input_names_the_field(field: str, certificates: dict[str, dict[str, Any]]) -> None:
    with pytest.raises(BadCertificate, match=field):
        second_proof(changed(certificates["in space"], BAD[field]))


def test_the_gradient_is_that_of_the_program() -> None:
    """x y/z - sqrt(x) + z^-3 - 2, and a coordinate on which nothing depends."""
    text = (
        "v0 = x\nv1 = y\nv2 = z\nv3 = v0 * v1\nv4 = v3 / v2\nv5 = v0 ** (1/2)\nv6 = v4 - v5\nv7 = v2 ** (-3)\n"
        "v8 = v6 + v7\nv9 = 2\nv10 = v8 - v9\nreturn v10"
    )
    slopes = stating.gradient(statement.Program.from_text(text), ("x", "y", "z", "w"))
    x, y, z = 4.0, 3.0, 2.0
    operations = {**statement.ARITHMETIC, "**": lambda base, exponent: base ** float(exponent)}
    found = slopes.run({"x": x, "y": y, "z": z}, float, operations)
    assert found == pytest.approx([y / z - 0.5 / x**0.5, x / z, -x * y / z**2 - 3 / z**4, 0.0])


def test_multipliers_are_isolated_or_refused() -> None:
    matrix = arb_mat([[1, 5, 0, 0], [0, "0.5", 0, 0], [0, 3, 0, -2], [0, 0, 2, 0]])
    found = sorted(isolation.multipliers(matrix, [isolation.linear(1)]), key=lambda z: float(z.imag.mid()))
    for ball, exact in zip(found, (acb(0, -2), acb("0.5"), acb(0, 2)), strict=True):
        assert ball.contains(exact)
        assert float(ball.rad()) < 1e-10
    assert found[1].imag == 0
    with pytest.raises((ValueError, package.CannotFollow)):
        isolation.multipliers(arb_mat([[1, 0, 0], [0, 3, 0], [0, 0, 3]]), [isolation.linear(1)])
    with pytest.raises((ValueError, package.CannotFollow)):
        isolation.multipliers(arb_mat([[1, 0, 0], [0, 3, 0], [0, 0, arb("3.001", "0.01")]]), [isolation.linear(1)])


def test_volume_is_kept_only_where_no_rate_depends_on_its_own_coordinate() -> None:
    field = {"x": "y + a*z", "y": "x*z", "z": "x - y"}
    systems = [field, field | {"z": "x - y*z"}]
    kept = []
    for number, each in enumerate(systems):
        system = define_system({"name": f"s{number}", "state": "x y z", "parameters": "a", "field": each})
        claim = hopf()
        claim = replace(claim, system=system, parameters={"a": Fraction(1)})
        kept.append(stating.read_periodic(certify(claim, Limits(max_precision=64)).to_json()).keeps_volume())
    assert kept == [True, False]


@pytest.fixture(scope="module")
def recorded(certificates: dict[str, dict[str, Any]]) -> tuple[Any, Any, int, list[Any]]:
    """The statement of the first case, some legs, with how many bits, and what was followed of it in turn."""
    stated = stating.read_periodic(certificates["on a slanted section"])
    with package.jets.precision(160), pytest.MonkeyPatch.context() as patch:
        patch.setattr(legs, "LEG", 6)
        start = periodic.PeriodicProof(stated, 160).guess()
    assert len(start.shares) > 2
    bits, found = 2 * start.lost + newton.KNOWN, list[Any]()

    class Recording(periodic.PeriodicProof):  # type: ignore[name-defined, misc]
        def followed(self, *arguments: Any) -> Any:
            found.append(super().followed(*arguments))
            return found[-1]

    with package.jets.precision(bits):
        assert Recording(stated, bits, start).conclusion().inside == 1
    return stated, start, bits, found


def concluded(
    recorded: tuple[Any, Any, int, list[Any]],
    last: Callable[[Any], Any] = lambda found: found,
    after: Callable[[Any], object] = lambda proof: None,
    **claimed: Any,
) -> Any:
    """The proof of a changed claim from what was followed, the last of it changed, and itself after Newton's method."""
    stated, start, bits, found = recorded
    results = iter([*found[:-1], last(found[-1])])

    class Replayed(periodic.PeriodicProof):  # type: ignore[name-defined, misc]
        def followed(self, *arguments: Any) -> Any:
            return next(results)

        def converge(self) -> Any:
            exactly = super().converge()
            after(self)
            return exactly

    with package.jets.precision(bits):
        return Replayed(replace(stated, **claimed), bits, start).conclusion()


def test_what_was_followed_is_enough_for_the_proof(recorded: Any) -> None:
    assert concluded(recorded).inside == 1


def test_the_last_that_is_followed_is_the_whole_box(recorded: Any) -> None:
    stated, start, bits, found = recorded
    results, seen = iter(found), list[Any]()

    class Watched(periodic.PeriodicProof):  # type: ignore[name-defined, misc]
        def followed(self, around: Any, degree: Any) -> Any:
            seen.append(around)
            return next(results)

        def returned(self, found: Any, around: Any, degree: int) -> Any:
            assert around is seen[-1]
            return super().returned(found, around, degree)

    with package.jets.precision(bits):
        proof = Watched(stated, bits, start)
        proof.conclusion()
    with package.jets.precision(4 * bits):
        for side in (-1, 1):
            assert all(b.contains(c + side * proof.reach) for b, c in zip(seen[-1], proof.centre, strict=True))


def test_the_point_is_known_as_well_as_the_newton_image(recorded: Any) -> None:
    proofs = list[Any]()
    found = concluded(recorded, after=proofs.append)
    (proof,) = proofs
    for name, c in zip(found.point, proof.centre, strict=False):
        move = found.hypotheses[0].enclosures[name]
        assert agree(found.point[name], c + move)
        assert found.point[name].rad() >= move.rad() / 2 > 0


def test_a_box_that_leaves_its_section_is_refused(recorded: Any) -> None:
    stated = recorded[0]
    stated.check()
    out = tuple(tuple(value + a for value in row) for row, a in zip(stated.frame, stated.normal, strict=True))
    for wrong in ({"frame": out}, {"offset": stated.offset + 1}, {"normal": (Fraction(0),) * 2, "offset": Fraction(0)}):
        with pytest.raises(package.CannotFollow, match="section"):
            replace(stated, **wrong).check()


def test_each_condition_is_looked_at(recorded: Any) -> None:
    with pytest.raises(package.CannotFollow, match="crossings is not shown"):
        concluded(recorded, lambda found: found._replace(crossings=found.crossings + 1))
    with pytest.raises(package.CannotFollow, match="direction is not shown"):
        concluded(recorded, direction=1)
    with pytest.raises(package.CannotFollow, match="newton is not shown"):
        concluded(recorded, after=lambda proof: setattr(proof, "reach", arb(2) ** -1000))


def test_a_time_of_return_that_is_a_multiple_of_the_period_is_refused(recorded: Any) -> None:
    """With two crossings claimed and found: half the time on, the orbit may be at its point."""

    with pytest.raises(package.CannotFollow, match="least period, T/2 is not shown"):
        concluded(recorded, lambda found: found._replace(crossings=2, between={2: found.ends[-1]}), crossings=2)
    with pytest.raises(package.CannotFollow, match="least period, T/2 is not shown"):
        concluded(recorded, lambda found: found._replace(crossings=2), crossings=2)


def test_half_the_period_counts_from_the_begin_of_the_first_leg(recorded: Any) -> None:
    """Half the time on the orbit is at the opposite point of its circle, in whichever leg that is."""
    stated, start, bits, _ = recorded
    proofs = list[Any]()
    concluded(recorded, after=proofs.append)
    centre = proofs[0].centre
    assert start.shares[0] < 0.5
    with package.jets.precision(bits):
        found = periodic.PeriodicProof(replace(stated, crossings=2), bits, start).followed(centre, 1)
    for jet, begun in zip(found.between[2][:2], centre[:2], strict=True):
        assert abs(float(jet[()] + begun)) < 1e-9


def test_the_equations_compare_the_last_leg_with_the_first_point_under_s(recorded: Any) -> None:
    """Ends of legs at their begins: rows are those of S x_1, then of x_0."""
    stated, start, bits, _ = recorded
    turned = replace(stated, symmetry=(-1, 1))
    two = start._replace(shares=[arb(1) / 4, arb(1)], points=start.points[:2])
    with package.jets.precision(bits):
        proof = periodic.PeriodicProof(turned, bits, two)
        begins = [proof.begin(proof.centre[2 * i : 2 * i + 2], 1) for i in range(2)]
        rows = proof.returned(legs.Return(begins, 1, {}), proof.centre, 1)
        x, y, u, v = proof.centre[:4]
        for row, value, place, slope in zip(rows, (-u, v, x, y), (2, 3, 0, 1), (-1, 1, 1, 1), strict=False):
            assert row[()].contains(value)
            assert [row[j,].contains(slope if j == place else 0) for j in range(4)] == [True] * 4
        assert [row[legs.TIME,].contains(0) for row in rows[:4]] == [False] * 4


def test_a_level_that_varies_is_an_unknown_of_its_equation(certificates: dict[str, dict[str, Any]]) -> None:
    stated = stating.read_periodic(certificates["on a level"])
    claim = bifurcation.BifurcationStatement("periodic-fold", stated, Fraction(9, 2), ((Fraction(1),) * 3,))
    with package.jets.precision(160):
        proof = bifurcation.VaryingLegs(claim, 160)
        state = proof.begin(proof.centre[: stated.section], 2)
        row = proof.returned(legs.Return([state], 1, {}), proof.centre, 2)[-1]
        x, y = proof.centre[:2]
        assert agree(row[()], x * x + y * y - arb(4.5))
    assert proof.varied == len(stated.names) + 1
    assert row[proof.varied,] == -1
    assert [row[j,].contains(0) for j in range(2, proof.varied)] == [True] * (proof.varied - 2)


def test_a_gradient_that_is_zero_shows_no_level(certificates: dict[str, dict[str, Any]]) -> None:
    stated = stating.read_periodic(certificates["on a level"])
    with package.jets.precision(160):
        proof = periodic.PeriodicProof(stated, 160)
        for x, holds in ((1, True), (0, False)):
            zero = [arb(x), *[arb(0)] * (len(proof.centre) - 2), arb(1)]
            checks, _ = proof.check_orbit(legs.Return([], 1, {}), zero)
            assert [check.holds for check in checks if check.name == "gradient"] == [holds]


def test_a_crossing_that_may_be_after_the_period_does_not_end_it(
    recorded: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The period is near the end of the first piece, and not certainly in it."""
    stated, start, bits, _ = recorded
    nothing = SimpleNamespace(duration=arb(3), at=lambda time: [])

    class Pieces(periodic.PeriodicProof):  # type: ignore[name-defined, misc]
        def step(self, state: Any, guess: Any) -> Any:
            return nothing, arb(3), guess

    for period, crossings in ((arb(0.75, 0.01), 1), (arb(1, 0.1), 0)):
        pieces = iter([((arb(0.5), arb(1)), -1), ((arb(1.5), arb(2)), 1), (None, 1)])
        monkeypatch.setattr(legs, "first_crossing", lambda *given, found=pieces: next(found))
        proof = Pieces(replace(stated, direction=-1), bits, start)
        if crossings:
            assert proof.leg([], 0, period, True, {}, {}) == ([], 1)
        else:
            with pytest.raises(package.CannotFollow, match="not crossed at the end"):
                proof.leg([], 0, period, True, {}, {})


def test_the_equations_ask_for_the_section_and_the_level(certificates: dict[str, dict[str, Any]]) -> None:
    """Also where the centre is on neither: what is left of the last rows is by how much."""
    stated = stating.read_periodic(certificates["on a level"])
    moved = replace(stated, centre=tuple(c + Fraction(1, 8) for c in stated.centre))
    off = sum((a * c for a, c in zip(moved.normal, moved.centre, strict=True)), -moved.offset)
    x, y, *_ = moved.centre
    with package.jets.precision(160):
        proof = periodic.PeriodicProof(moved, 160)
        state = proof.begin(proof.centre[: moved.section], 1)
        rows = proof.returned(legs.Return([state], 1, {}), proof.centre, 1)
        *_, section, level = proof.zeros(rows)
        *_, by_section, by_level = proof.slopes(rows)
    assert by_section == [*map(package.jets.ball, moved.normal), 0, 0]
    assert all(agree(by_level[i], 2 * proof.centre[i]) for i in (0, 1))
    assert by_level[4:] == [0, 0]
    assert off != 0
    for found, wanted in ((section, off), (level, x * x + y * y - moved.level)):
        assert found.contains(arb(wanted.numerator) / wanted.denominator)
        assert found.rad() < 1e-30


COUNTED: dict[str, tuple[list[acb], bool, tuple[int, int, int]]] = {
    "a pair, volume kept": ([acb(0.6, 0.8), acb(0.6, -0.8)], True, (0, 2, 0)),
    "a pair, volume not kept": ([acb(0.5, 0.5), acb(0.5, -0.5)], False, (2, 0, 0)),
    "two real ones, volume kept": ([acb(0.5), acb(2)], True, (1, 0, 1)),
    "two that may be real": ([acb(arb(1), arb(0, 0.1)), acb(arb(3), arb(0, 0.1))], True, (0, 0, 1)),
    "one that may be on the circle": ([acb(arb(1, 0.1)), acb(0.5)], False, (1, 0, 0)),
    "three, volume kept": ([acb(0.5, 0.5), acb(0.5, -0.5), acb(0.0, 2.0)], True, (2, 0, 1)),
}


@pytest.mark.parametrize("name", COUNTED)
def test_multipliers_are_counted_where_they_are_shown_to_be(
    name: str, recorded: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    balls, volume, counts = COUNTED[name]
    monkeypatch.setattr(periodic, "multipliers", lambda monodromy, known: balls)
    monkeypatch.setattr(stating.PeriodicStatement, "keeps_volume", lambda statement: volume)
    found = concluded(recorded)
    assert (found.inside, found.on, found.outside) == counts


def test_a_disc_that_may_have_two_multipliers_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    coefficients = [arb("9.0003", "1e-6"), arb("-6.0001"), arb(1)]
    with pytest.raises(package.CannotFollow, match="not isolated"):
        isolation._only_root(coefficients, acb(3))
    monkeypatch.setattr(isolation, "_nearer", lambda polynomial, guess: acb("0.5"))
    with pytest.raises(package.CannotFollow, match="not told apart"):
        isolation.multipliers(arb_mat([[1, 0, 0], [0, "0.5", 0], [0, 0, 3]]), [isolation.linear(1)])


@pytest.mark.slow
def test_an_orbit_of_lorenz_is_proved_and_agrees() -> None:
    certificate = certify(lorenz("AB"), Limits(digits=20)).to_json()
    result = second_proof(certificate)
    assert isinstance(result, ProvedPeriodic), str(result)
    assert [h.name for h in result.hypotheses][-1] == "least period, T/2"
    assert compare(certificate, result).verdict == "agrees"


@pytest.mark.slow
def test_the_command_proves_and_compares(
    certificates: dict[str, dict[str, Any]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, output = tmp_path / "certificates.json", tmp_path / "second.json"
    write_certificates(path, [Certificate.from_json(certificates["on a slanted section"], "planar")])
    assert main(["--second-proof", str(path), "-o", str(output), "--quiet"]) == 0
    (row,) = json.loads(output.read_text())["rows"]
    assert (row["verdict"], row["inside"], row["on"], row["outside"]) == ("agrees", 1, 0, 0)
    assert "agrees" in capsys.readouterr().out


def test_legs_that_begin_or_end_on_the_section_are_refused(recorded: Any) -> None:
    stated, start, bits, _ = recorded
    with package.jets.precision(bits):
        same = periodic.PeriodicProof(stated, bits, start._replace(points=[start.points[0]] * len(start.points)))
        with pytest.raises(package.CannotFollow, match="a leg begins on the section"):
            same.followed(same.centre, 1)
        state = same.begin(start.points[0], 1)
        with pytest.raises(package.CannotFollow, match="a leg ends on the section"):
            same.leg(state, 0, start.period + arb(0, 2.0**-20), False, {}, {})


def test_a_guess_that_is_no_orbit_is_not_proved(recorded: Any) -> None:
    """Points of the legs of another orbit, or in another order."""
    stated, start, bits, _ = recorded
    wrong = start._replace(points=[start.points[0], *start.points[:0:-1]])
    with package.jets.precision(bits), pytest.raises((package.CannotFollow, ArithmeticError, ValueError)):
        periodic.PeriodicProof(stated, bits, wrong).conclusion()


def test_each_leg_has_its_own_variables_and_its_share_of_the_period(recorded: Any) -> None:
    stated, start, bits, found = recorded
    with package.jets.precision(bits):
        proof = periodic.PeriodicProof(stated, bits, start)
        rows, legs_there = proof.returned(found[0], proof.centre, 1), len(start.shares)
        for i, end in enumerate(found[0].ends):
            share = start.shares[i] - (start.shares[i - 1] if i else 0)
            for j, speed in enumerate(stated.velocity(end)[:2]):
                row = rows[(i + 1) % legs_there * 2 + j]
                assert all(agree(row[2 * i + v,], end[j][v,]) for v in range(2))
                assert set(row) <= {(), (-1,), (2 * i,), (2 * i + 1,)}
                assert agree(row[-1,], speed[()] * share)
                assert not row[-1,].overlaps(speed[()])


def test_crossings_of_all_legs_are_counted(recorded: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    stated, start, bits, _ = recorded
    with package.jets.precision(bits):
        proof = periodic.PeriodicProof(stated, bits, start)
        monkeypatch.setattr(proof, "leg", lambda state, *more: (state, 2))
        assert proof.followed(proof.centre, 1).crossings == 2 * len(start.shares)


def test_both_parts_of_a_multiplier_are_compared_each_with_its_own() -> None:
    balls = [acb(arb(2, 0.25), arb(3, 0.5)), acb(arb(2, 0.25), arb(-3, 0.5))]
    parts = [{"real": ball_to_json(ball.real), "imaginary": ball_to_json(ball.imag)} for ball in balls]
    stored = {"trivial": 1, "inside": 0, "on": 0, "outside": 2, "undecided": 0, "values": parts}
    mine: Any = SimpleNamespace(inside=0, on=0, outside=2, multipliers=(acb(2, -3), acb(2, 3)))
    found = compare_multipliers(stored, mine, on_level=False)
    assert isinstance(found, dict)
    for number, ball in enumerate(mine.multipliers, start=1):
        for part, value in (("real", ball.real), ("imaginary", ball.imag)):
            here, there = found[f"multiplier {number}, {part} part"]
            assert here == value
            assert there.contains(value)
            assert not there.contains(value + 1)
