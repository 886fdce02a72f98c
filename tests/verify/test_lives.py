"""Lives: circles of closed form on their equilibria, joints at random, and graphs that are false (section 39)."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path
from random import Random
from typing import Any

import pytest
from flint import arb, ctx
from support import birth_cases, equilibrium_cases
from support.balls import agree
from support.forgeries import forged, forged_elsewhere, noticed
from support.life_cases import born, certificate_of, claim, life, life_of, rest, rest_atlas

from orbitproof import verify
from orbitproof.figures.commands.report import main as report
from orbitproof.shared.claims import EquilibriumAtlas, EquilibriumCurveClaim, Piece
from orbitproof.shared.claims.life import BEGINS, ENDS, Life, LifeArc, LifeJoint
from orbitproof.shared.claims.parts import hanging_together
from orbitproof.shared.formats import InputError, define_system
from orbitproof.shared.formats.life import life_from_json, read_life_claim
from orbitproof.verify.__main__ import main
from orbitproof.verify.birth_curve import ProvedBirthCurve, conclude_births
from orbitproof.verify.branches.life import _stored, certified_life
from orbitproof.verify.branches.rests_on import resting
from orbitproof.verify.certificate import Certificate, Given, Level, Recheck, digest, recheck, write_certificate
from orbitproof.verify.curve import Chain, PlaceOnCurve, ProvedInterval, Stretch, is_inside_curve, read_tube
from orbitproof.verify.equilibrium_curve import ProvedEquilibriumCurve, SidedPart, Sides, conclude_equilibria
from orbitproof.verify.evidence import EmptyIntersectionError, NotProved, Proved, enclose
from orbitproof.verify.life import Birthplace, LifeCurve, LifeTheorem, conclude_life, joint_shown
from orbitproof.verify.life.joints import _beside
from orbitproof.verify.words.life import life_in_words

JOINT = LifeJoint("rest", BEGINS)


def known(certificate: Certificate) -> LifeCurve:
    """What a certificate of a curve proves."""
    atlas = certificate.atlas
    conclude: Callable[..., Any] = conclude_equilibria if isinstance(atlas, EquilibriumAtlas) else conclude_births
    outcome = conclude(atlas, certificate.results).outcome
    return LifeCurve(atlas, outcome.results if isinstance(outcome, Proved) else None)


def fabricated(atlas: EquilibriumAtlas, deviation: Q = Q(1, 2**40)) -> LifeCurve:
    """As if its piece were proved with such a deviation."""
    bounds = (deviation,) * len(atlas.system.given_state)
    (piece,) = atlas.curve_pieces()
    tube = read_tube(piece, [ProvedInterval(Q(-1), Q(1), bounds, bounds, arb(0)).stored(piece.id, {})])
    chain = Chain((Stretch(tube, tube.runs[0], Q(-1), Q(-1), Q(1)),), ())
    return LifeCurve(atlas, ProvedEquilibriumCurve(chain, {}))


def why_not(said: Life, *arcs: LifeCurve) -> tuple[str, str]:
    outcome = conclude_life(said, arcs)
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition, outcome.reason.message


def below() -> tuple[Certificate, ...]:
    return rest(), born()


def checked(entry: Certificate, given: Sequence[Certificate] | None = None) -> Recheck:
    certificates = below() if given is None else tuple(given)
    return recheck(entry, given=Given(certificates, {each.key: recheck(each) for each in certificates}))


# True lives


def test_circles_are_born_on_their_line_of_equilibria() -> None:
    """At a = 0, omega = 1; the pair has the real part a."""
    found = life()
    assert (found.verdict, found.reason) == ("proved", None)
    equilibria, orbits = found.arcs
    (joint,) = orbits.joints
    assert (joint.arc, joint.how, joint.piece) == ("rest", BEGINS, "e1")
    for ball, value in ((joint.value, 0), (joint.frequency, 1), (joint.point[0], 0), (joint.point[1], 0)):
        assert ball.contains(value)
        assert ball.rad() < 1e-15
    assert agree(joint.s, enclose(Q(1, 9)))
    assert (joint.before, joint.after) == (Sides(2, 0), Sides(0, 2))
    assert equilibria.values.contains(enclose(Q(-1, 4)))
    assert equilibria.values.contains(enclose(Q(1, 5)))
    assert orbits.values.contains(enclose(Q(1, 16)))
    assert (equilibria.period, equilibria.joints) == (None, ())
    assert orbits.period.contains(2 * arb.pi())
    for words in (
        "The arc born (sha256:", "begins on rest, on piece e1 of it, s in [0.1111111111111111",
        "their least periods tend to 2 pi/omega, omega in [0.99999999999", "a speed in a that is not 0",
        "next to it those on one side have 2 eigenvalues with negative and 0 with positive real part, those on the "
        "other side 0 and 2. On the nearest part of rest before it where they are counted 2 have a negative and 0",
        "of the 2 arcs rest, born are joined by a path of equilibria and periodic orbits",
    ):  # fmt: skip
        assert words in str(found.theorem)


def test_parts_are_told_apart_if_nothing_else_is_claimed() -> None:
    said = Life("a life", "apart", (LifeArc("rest"), LifeArc("born")), connected=False)
    outcome = conclude_life(said, [known(rest()), known(born())])
    assert isinstance(outcome, Proved)
    assert outcome.results.parts == (("rest",), ("born",))
    assert "joined by a path" not in str(life_of(said, below()).theorem)
    assert why_not(replace(said, connected=True), known(rest()), known(born()))[0] == "connected"


def test_arcs_hang_together_by_chains() -> None:
    met = {"a": ["1", "2"], "b": ["1"], "c": ["2"], "d": ["3"], "e": ["4"], "f": ["3", "4"], "g": []}
    assert hanging_together(met) == (("a", "b", "c"), ("d", "e", "f"), ("g",))
    assert hanging_together({"a": ["1"], "b": ["1", "2"], "c": ["2"]}) == (("a", "b", "c"),)


def from_birth_to_birth() -> LifeCurve:
    """Circles from a = 0, omega = 1, to a = 1, omega = 2, as if their pieces were proved."""
    atlas, near = replace(birth_cases.born_twice(), id="born"), Q(1, 2**40)
    results = [
        ProvedInterval(Q(-1), Q(1), (near,) * 3, (near,) * 3, (3 + arb(0, 1)) * arb.pi() / 2).stored(each.id, {})
        for each in atlas.curve_pieces()
    ]
    outcome = conclude_births(atlas, results).outcome
    assert isinstance(outcome, Proved), outcome
    return LifeCurve(atlas, outcome.results)


def test_orbits_from_birth_to_birth_begin_and_end_on_their_equilibria() -> None:
    orbits = from_birth_to_birth()
    system, joints = orbits.atlas.system, (LifeJoint("rest", BEGINS), LifeJoint("rest", ENDS))
    said = Life("a life", "both ends", (LifeArc("rest"), LifeArc("born", joints)))
    on = fabricated(rest_atlas(Q(-1, 4), Q(5, 4), system=system))
    outcome = conclude_life(said, [on, orbits])
    assert isinstance(outcome, Proved), outcome
    begins, ends = outcome.results.joints
    for joint, a, omega in ((begins, 0, 1), (ends, 1, 2)):
        for ball, value in ((joint.birth.point["a"], a), (joint.birth.point["x"], a), (joint.birth.frequency, omega)):
            assert ball.contains(value)
            assert ball.rad() < 1e-9
    for joint, stored in zip((begins, ends), _stored(outcome.results, 1).joints, strict=True):
        own = joint.birth
        assert (stored.frequency, stored.point) == (own.frequency, (own.point["x"], own.point["y"]))
    words = " ".join(life_in_words(LifeTheorem(said), outcome.results, {"rest": "d", "born": "d"}).split())
    assert "- ends on rest, on piece e1" in words
    assert (
        "Towards this end the orbits shrink to it, and their least periods tend to 2 pi/omega, omega in [1.9" in words
    )
    assert "All these births are at different equilibria" in words
    short = fabricated(rest_atlas(Q(-1, 4), Q(1, 2), system=system))
    assert why_not(said, short, orbits)[0] == "joints"
    only_ends = Life("a life", "one end", (LifeArc("rest"), LifeArc("born", joints[1:])))
    assert why_not(only_ends, short, orbits)[0] == "joints"
    # One that is born where the other ends.
    assert orbits.curve is not None
    (piece, *_) = orbits.atlas.curve_pieces()
    atlas = replace(orbits.atlas, id="again", pieces=(replace(piece, centre=(Q(1), *piece.centre[1:])),))
    swapped = {"start": orbits.curve.ends["end"], "end": orbits.curve.ends["start"]}
    again = LifeCurve(atlas, replace(orbits.curve, ends=swapped, pair_at_end=None))  # type: ignore[arg-type, call-arg]
    three = replace(said, arcs=(*said.arcs, LifeArc("again")), connected=False)
    assert why_not(three, on, orbits, again)[0] == "births"


def line(rng: Random, moved: Q = Q(0)) -> EquilibriumAtlas:
    """A curve through (a, x, y) = (0, 0, 0) at some s, bent, in a turned frame, and moved across there."""
    h, s = Q(rng.randrange(1, 8), 8), Q(rng.randrange(-15, 16), 16)
    frame = ((Q(1), Q(rng.randrange(-3, 4), 4), Q(0)), (Q(rng.randrange(-3, 4), 4), Q(1), Q(0)), (Q(1), Q(1), Q(1)))
    while frame[0][0] * frame[1][1] == frame[0][1] * frame[1][0]:
        frame = (frame[0], (Q(rng.randrange(-3, 4), 4), Q(1), Q(0)), frame[2])
    polynomial = tuple(tuple(Q(rng.randrange(-8, 9), 16) for _ in range(4)) for _ in range(2))
    p = [h * s, *(sum(c * s**n for n, c in enumerate(row)) for row in polynomial)]
    p[rng.randrange(1, 3)] += moved
    centre = tuple(-sum(a * b for a, b in zip(row, p, strict=True)) for row in frame)
    piece = Piece("e1", "regular", centre, frame, h, polynomial, (Q(1, 2**12),) * 2, "physical")
    return rest_atlas(pieces=(piece,), claim=EquilibriumCurveClaim("equilibrium-arc", "a"), provenance={"s": str(s)})


def test_a_birth_is_found_where_it_lies_on_curves_at_random() -> None:
    """And on no curve that passes it by more than a tube; beside the only point in the tube is a contradiction."""
    rng, orbits, tube = Random(39), known(born()), Q(1, 2**12)
    for number in range(150):
        with ctx.workprec(256):
            on = fabricated(line(rng))
            found = joint_shown(orbits, JOINT, on)
            assert isinstance(found, Birthplace), found
            assert found.place.s.contains(enclose(Q(on.atlas.provenance["s"])))
            if number % 3 == 0:
                sign = rng.choice((-1, 1))
                far = fabricated(line(rng, sign * tube * Q(rng.randrange(9, 30), 8)))
                assert "outside the tubes" in str(joint_shown(orbits, JOINT, far))
                near = fabricated(line(rng, sign * tube * Q(rng.randrange(1, 8), 8)))
                condition, message = why_not(claim(), near, orbits)
                assert condition == "joints"
                assert "the tube of e1 has no such point so far off its polynomial" in message


# False ones


def other(atlas: Any, **changes: Any) -> Any:
    """An arc of another claim, as if it were proved by the same pieces."""
    return lambda: replace(known(born() if atlas == "born" else rest()), atlas=changed(atlas, **changes))


def changed(name: str, **changes: Any) -> Any:
    return replace(born().atlas if name == "born" else rest().atlas, **changes)


def of_parameter(name: str) -> Any:
    """The same field, but in another parameter, and the claim about that."""
    field = {"x": f"({name} - u**2 - y**2)*u - y", "y": f"u + ({name} - u**2 - y**2)*y"}
    system = define_system({
        "name": "circles", "state": "x y", "parameters": name, "where": {"u": f"x - {name}"}, "field": field,
    })  # fmt: skip
    return {"system": system, "claim": replace(born().atlas.claim, parameter=name)}


def refused_arcs() -> dict[str, tuple[Life, Sequence[LifeCurve], str, str]]:
    line_, orbits = known(rest()), known(born())
    twice = certificate_of(birth_cases.circles_born(id="again", reach=Q(1, 16)))
    again = LifeArc("again", (JOINT,))
    copied = replace(orbits, atlas=replace(orbits.atlas, id="again"))
    turned = replace(birth_cases.circles(), state=("y", "x"))
    functions = equilibrium_cases.PENDULUM
    return {
        "of another field": (
            claim(), (line_, other("born", system=birth_cases.circles("2*a"))()), "equations", "different ones",
        ),
        "with functions": (claim(), (line_, other("born", system=functions)()), "equations", "different ones"),
        "of another value": (
            claim(), (line_, other("born", parameters={"b": Q(1)})()), "equations", "different ones",
        ),
        "of another order": (claim(), (line_, other("born", system=turned)()), "equations", "different ones"),
        "of another parameter": (claim(), (line_, other("born", **of_parameter("b"))()), "equations", "different ones"),
        "stops before": (
            claim(), (known(certificate_of(rest_atlas(Q(-1, 4), Q(-1, 8)))), orbits), "joints", "beyond the ends",
        ),
        "ends there": (
            claim(), (known(certificate_of(rest_atlas(Q(-1, 4), Q(0)))), orbits), "joints", "is not shown",
        ),
        "begins there": (
            claim(), (known(certificate_of(rest_atlas(Q(0), Q(1, 4)))), orbits), "joints", "is not shown",
        ),
        "is not proved": (claim(), (line_, LifeCurve(orbits.atlas, None)), "arcs", "is not proved"),
        "does not stand": (claim(), (line_, replace(orbits, problem="it is forged")), "arcs", "it is forged"),
        "twice": (
            claim(LifeArc("born", (JOINT,))), (line_, orbits, orbits), "arcs", "two arcs have the same id",
        ),
        "a copy": (claim(again), (line_, orbits, copied), "arcs", "two arcs have a piece in common"),
        "the same birth": (claim(again), (line_, orbits, known(twice)), "births", "may be the same"),
        "the same birth, not joined": (
            claim(LifeArc("again"), connected=False), (line_, orbits, known(twice)), "births", "may be the same",
        ),
        "in another order": (claim(), (orbits, line_), "arcs", "not those of the claim"),
        "one too few": (claim(), (line_,), "arcs", "not those of the claim"),
        "none": (Life("a life", "nothing", ()), (), "arcs", "not those of the claim"),
        "on orbits": (
            Life("a life", "", (LifeArc("rest"), LifeArc("born"), LifeArc("again", (LifeJoint("born", BEGINS),)))),
            (line_, orbits, known(twice)), "joints", "the other is no curve of equilibria",
        ),
        "of equilibria": (
            Life("a life", "", (LifeArc("rest", (LifeJoint("born", BEGINS),)), LifeArc("born"))), (line_, orbits),
            "joints", "no orbits are proved to be born there",
        ),
        "on none": (claim(on="elsewhere"), (line_, orbits), "joints", "that is none of the arcs"),
        "at its end": (
            Life("a life", "", (LifeArc("rest"), LifeArc("born", (LifeJoint("rest", ENDS),)))), (line_, orbits),
            "joints", "no orbits are proved to be born there",
        ),
    }  # fmt: skip


def test_graphs_that_are_false_are_refused() -> None:
    for name, (said, arcs, condition, message) in refused_arcs().items():
        found = why_not(said, *arcs)
        assert found[0] == condition, (name, found)
        assert message in found[1], (name, found)


def test_equations_are_the_same_where_functions_and_values_are() -> None:
    """The rates of sin(x + 1) and of sin(x + 2) are the same program."""
    field = {"x": "v", "v": "a*v - b*sin(x + {})"}
    one, two = (
        define_system({"name": "p", "state": "x v", "parameters": "a b", "field": {**field, "v": field["v"].format(n)}})
        for n in (1, 2)
    )
    atlas = rest_atlas(system=one, parameters={"b": Q(1)})
    same = LifeCurve(atlas, None).equations
    assert LifeCurve(replace(atlas, id="another", title="another"), None).equations == same
    shifted = replace(one, defined=two.defined)
    assert shifted.program.text() == one.program.text()
    for changes in ({"system": shifted}, {"parameters": {"b": Q(2)}}, {"parameters": {"a": Q(1)}}):
        assert LifeCurve(replace(atlas, **changes), None).equations != same


def test_names_of_systems_are_not_compared() -> None:
    renamed = replace(birth_cases.circles(), name="rings", title="rings")
    outcome = conclude_life(claim(), [known(rest()), other("born", system=renamed)()])
    assert isinstance(outcome, Proved)


def test_births_are_different_if_one_coordinate_certainly_is() -> None:
    said, line_, orbits = claim(LifeArc("again"), connected=False), known(rest()), known(born())
    assert isinstance(orbits.curve, ProvedBirthCurve)
    (piece,) = orbits.atlas.curve_pieces()
    elsewhere = replace(orbits.atlas, id="again", pieces=(replace(piece, centre=(Q(1), *piece.centre[1:])),))
    for name in ("a", "x", "y"):
        for width, different in ((arb(0), True), (arb(0, 2.0**-39), False)):
            ends = dict(orbits.curve.ends)
            ends["start"] = {**ends["start"], name: ends["start"][name] + arb(2) ** -40 + width}
            again = LifeCurve(elsewhere, replace(orbits.curve, ends=ends))
            outcome = conclude_life(said, [line_, orbits, again])
            assert isinstance(outcome, Proved) == different
            if isinstance(outcome, Proved):
                digests = dict.fromkeys(("rest", "born", "again"), "d")
                words = life_in_words(LifeTheorem(said), outcome.results, digests)
                assert "All these births are at different equilibria" in words
                # The first of three once more, which is no neighbour of it in the claim.
                third = replace(elsewhere, id="third", pieces=(replace(piece, centre=(Q(2), *piece.centre[1:])),))
                more = replace(said, arcs=(*said.arcs, LifeArc("third")))
                assert why_not(more, line_, orbits, again, LifeCurve(third, orbits.curve))[0] == "births"


def test_counts_beside_a_birth_are_those_of_the_nearest_parts_that_are_decided() -> None:
    curve = known(certificate_of(equilibrium_cases.curve_of_equilibria())).curve
    assert curve is not None
    a, b, c, d = Sides(2, 0), Sides(1, 1), Sides(0, 2), None

    def part(pieces: tuple[str, str], begin: Q, end: Q, sides: Sides | None) -> SidedPart:
        return SidedPart(pieces, (begin, end), (arb(0), arb(0)), arb(0), sides)

    parts = (
        part(("p1", "p1"), Q(-1), Q(0), a), part(("p1", "p1"), Q(0), Q(1, 4), d),
        part(("p1", "p2"), Q(1, 4), Q(-1, 2), b), part(("p2", "p2"), Q(-1, 2), Q(0), d),
        part(("p2", "p2"), Q(0), Q(1), c),
    )  # fmt: skip
    curve = replace(curve, sides=parts)
    for piece, s, expected in (
        ("p1", arb(0.125), (a, b)), ("p2", arb(-0.25), (b, c)), ("p1", arb(0.125, 0.25), (a, b)),
        ("p2", arb(-0.25, 0.5), (b, c)), ("p1", arb(0, 0.25), (a, b)), ("p2", arb(-0.5, 0.25), (b, c)),
    ):  # fmt: skip
        assert _beside(curve, PlaceOnCurve(piece, s, False)) == expected, (piece, s)
    # A part within the enclosure may lie on either side.
    inside = replace(curve, sides=(parts[0], parts[1], part(("p1", "p1"), Q(1, 4), Q(1, 2), b), *parts[3:]))
    assert _beside(inside, PlaceOnCurve("p1", arb(0.25, 0.5), False)) == (None, None)
    assert _beside(inside, PlaceOnCurve("p1", arb(0.125), False)) == (a, b)
    assert _beside(replace(curve, sides=parts[1:3]), PlaceOnCurve("p1", arb(0.125), False)) == (None, b)
    for piece, s in (("p1", arb(-0.5)), ("p2", arb(0.5)), ("p1", arb(0.5)), ("p2", arb(-0.75))):
        with pytest.raises(EmptyIntersectionError, match="none is on the axis"):
            _beside(curve, PlaceOnCurve(piece, s, False))


def test_a_part_where_the_next_piece_may_be_entered_is_not_after_a_birth() -> None:
    """The first piece ends just behind the birth, and knows a so badly that the second may be entered before it."""
    zero, one, end = Q(0), Q(1), Q(1, 2**17)
    (last,) = rest_atlas(Q(-1, 8), Q(1, 5)).curve_pieces()
    (first,) = rest_atlas(Q(-1, 4), end).curve_pieces()
    frame = ((one, one, zero), (one, zero, zero), (zero, zero, one))
    rough = replace(first, id="e0", frame=frame, polynomial=((-4 * end,), (zero,)), tube=(Q(1, 2**7),) * 2)
    on = known(certificate_of(rest_atlas(pieces=(rough, last))))
    assert on.curve is not None
    stretch = on.curve.chain.stretches[1]
    assert last.centre[0] + last.half_width * stretch.enters < 0
    with ctx.workprec(256):
        found = joint_shown(known(born()), JOINT, on)
    assert isinstance(found, Birthplace), found
    assert (found.place.piece, found.before, found.after) == ("e0", Sides(2, 0), Sides(0, 2))


def test_the_values_on_an_arc_contain_those_of_all_its_points() -> None:
    """a = x^2 from x = -1/2 to 1/2."""
    values = known(certificate_of(equilibrium_cases.curve_of_equilibria())).values
    for number in range(33):
        assert values.contains(enclose(Q(number - 16, 32) ** 2))
    assert not values.contains(enclose(Q(1, 3)))


def test_the_values_on_an_arc_are_those_on_all_of_its_pieces() -> None:
    """a = x^2 from x = -1/2 to a place near that, and then from x = 0 on."""
    atlas = equilibrium_cases.curve_of_equilibria()
    curve = known(certificate_of(atlas)).curve
    assert curve is not None
    first, *others = curve.chain.stretches
    chain = replace(curve.chain, stretches=(replace(first, leaves=first.enters + Q(1, 64)), *others))
    values = LifeCurve(atlas, replace(curve, chain=chain)).values  # type: ignore[arg-type]
    assert values.contains(enclose(Q(1, 100)))


def test_the_place_of_a_birth_is_enclosed_for_all_of_its_enclosure() -> None:
    """s = 40 a/9 + 1/9."""
    orbits, on, far = known(born()), known(rest()), arb(2) ** -20
    assert orbits.curve is not None
    ends = dict(orbits.curve.ends)
    ends["start"] = {**ends["start"], "a": far * arb(0, 1), "x": far * arb(0, 1)}
    found = joint_shown(replace(orbits, curve=replace(orbits.curve, ends=ends)), JOINT, on)  # type: ignore[arg-type]
    assert isinstance(found, Birthplace)
    for sign in (-1, 1):
        assert found.place.s.contains((sign * 40 * far * arb("0.99") + 1) / 9)


def test_what_may_be_an_end_of_an_arc_is_not_inside_of_it() -> None:
    on = known(rest())
    assert on.curve is not None
    for s, inside in (
        (arb(-1), False),
        (arb(1), False),
        (arb(0.75, 0.25), False),
        (arb(-0.75, 0.25), False),
        (arb(0, 0.5), True),
    ):
        assert is_inside_curve(on.atlas, on.curve.chain, PlaceOnCurve("e1", s, False)) == inside


# Claims as files


DOCUMENT = {
    "format": "orbitproof-life-claim", "version": 1, "id": "a life", "title": "circles and their equilibria",
    "arcs": [{"id": "rest"}, {"id": "born", "joints": [{"arc": "rest", "how": "begins on"}]}],
}  # fmt: skip


@pytest.mark.parametrize(
    ("arcs", "message"),
    [
        ([], "arcs"),
        ([{"id": "rest"}, {"id": "rest"}], "appears twice; give each arc once"),
        ([{"id": "born", "joints": [{"arc": "rest", "how": "begins on"}]}], "none of the other arcs"),
        ([{"id": "born", "joints": [{"arc": "born", "how": "begins on"}]}], "none of the other arcs"),
        ([{"id": "rest"}, {"id": "born", "joints": [{"arc": "rest", "how": "begins on"}] * 2}], "ends once"),
        ([{"id": "rest"}, {"id": "born", "joints": [{"arc": "rest", "how": "shares"}]}], "joints[0].how"),
    ],
)
def test_malformed_claims_are_refused_by_their_field(arcs: list[Any], message: str, tmp_path: Path) -> None:
    path = tmp_path / "life.json"
    path.write_text(json.dumps({**DOCUMENT, "arcs": arcs}))
    with pytest.raises(InputError, match="arcs") as error:
        read_life_claim(path)
    assert message in str(error.value)


def test_an_empty_claim_is_refused_wherever_it_comes_from() -> None:
    with pytest.raises(InputError, match="is empty"):
        life_from_json({"id": "a", "title": "a", "arcs": []}, "it")


def test_what_is_needed_is_asked_for() -> None:
    for given in ([rest()], [born()], []):
        with pytest.raises(InputError, match="no such certificate is given"):
            resting(claim(), given)
    with pytest.raises(InputError, match="appears twice"):
        resting(claim(), [rest(), rest(), born()])


# Certificates


def test_a_certificate_is_checked_by_those_that_it_rests_on() -> None:
    found = checked(life())
    assert (found.stands, found.findings, found.passed) == (True, (), Level.CONCLUSION)
    assert not recheck(life(), given=Given()).stands


def test_forged_certificates_are_found() -> None:
    def put(value: Any, *place: Any) -> Certificate:
        document = json.loads(json.dumps(life().document))
        inner = document
        for key in place[:-1]:
            inner = inner[key]
        inner[place[-1]] = value
        return Certificate({**document, "digest": digest(document)})

    joints = ("arcs", 1, "joints", 0)
    for entry in (
        put("sha256:" + "0" * 64, "rests_on", 0, "digest"),
        put("other", "rests_on", 0, "id"),
        put({"left": 1, "right": 1}, *joints, "before"),
        put(life().document["arcs"][1]["joints"][0]["frequency"], *joints, "value"),
        put("e2", *joints, "piece"),
        put([["rest"], ["born"]], "parts"),
        put([], "arcs", 1, "joints"),
        put([], "statement", "claim", "arcs", 1, "joints"),
        put(False, "statement", "claim", "connected"),
        put([], "hypotheses"),
    ):
        assert not checked(entry).stands
    said = put("Everything is proved.", "statement", "theorem")
    assert noticed(checked(said))
    told = checked(Certificate(forged_elsewhere(said.document, lambda it: None))).rendered
    assert told is not None
    assert told["statement"]["theorem"] == life().theorem


def test_a_check_of_another_certificate_is_none() -> None:
    again = certificate_of(rest_atlas(Q(-1, 4), Q(1, 4)))
    with pytest.raises(ValueError, match="check"):
        certified_life(claim(), (again, born()), {entry.key: recheck(entry) for entry in below()})


def test_a_life_does_not_rest_on_what_is_not_proved_or_forged() -> None:
    short = certificate_of(birth_cases.circles_born(id="born"), (Q(-1), Q(0)))
    assert not short.proved
    bad = Certificate(forged(rest().document, lambda it: it["results"][0].update(deviation=["0x1p0", "0x0"])))
    for given, message in (((rest(), short), "says 'not proved'"), ((bad, born()), "does not stand")):
        found = life_of(claim(), given)
        assert found.verdict == "not proved"
        assert found.reason is not None
        assert found.reason.condition == "arcs"
        assert message in found.reason.message


# Commands


def test_a_life_from_the_command_line_and_from_python(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [tmp_path / name for name in ("rest.json", "born.json", "life.json", "certificate.json")]
    for path, entry in zip(paths, below(), strict=False):
        write_certificate(path, entry.document)
    paths[2].write_text(json.dumps(DOCUMENT))
    given = ["--certificates", *map(str, paths[:2])]
    assert main([str(paths[2]), *given, "-o", str(paths[3]), "--quiet"]) == 0
    assert "PROVED" in capsys.readouterr().out
    (stored,) = verify.read(paths[3])
    assert stored.document == life().document
    assert main(["--recheck", str(paths[3]), *given, "--quiet"]) == 0
    assert main([str(paths[2]), "--certificates", str(paths[0]), "--quiet"]) == 2
    assert "no such certificate is given" in capsys.readouterr().err
    paths[2].write_text(json.dumps({**DOCUMENT, "arcs": [{"id": "rest"}, {"id": "born"}]}))
    assert main(["life", str(paths[2]), *given, "--quiet"]) == 1
    assert "NOT PROVED: connected" in capsys.readouterr().out
    told = tmp_path / "report.md"
    assert report([*map(str, [*paths[:2], paths[3]]), "-o", str(told), "--no-pictures", "--quiet"]) == 0
    written = told.read_text("utf-8")
    assert "**Theorem 3** (Equilibria and the orbits that are born on them" in written
    assert "orbitproof verify life --recheck certificate.json --certificates rest.json born.json" in written
    (found,) = verify.certify(claim(), rests_on=below())
    assert found.document == life().document
