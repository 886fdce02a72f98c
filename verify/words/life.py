"""The theorem about a life in words (section 39.5)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from flint import arb

from orbitproof.shared.claims.life import BEGINS
from orbitproof.shared.systems import shown
from orbitproof.shared.wording import counted, itemised
from orbitproof.verify.birth_curve import ProvedBirthCurve
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.equilibrium_curve import ProvedEquilibriumCurve, Sides
from orbitproof.verify.evidence import exact_text, interval_text, located, range_text
from orbitproof.verify.life import Birthplace, LifeCurve, LifeTheorem, ProvedLife
from orbitproof.verify.words.equilibrium_curve import fold_in_words
from orbitproof.verify.words.periodic_curve import turns_in_words

_DIGITS, _FEW = 18, 5


def life_in_words(theorem: LifeTheorem, life: ProvedLife, digests: Mapping[str, str]) -> str:
    """What is proved of a life that rests on certificates with these digests, by id."""
    assert [arc.id for arc in life.arcs] == [arc.id for arc in theorem.life.arcs]
    atlas = life.arcs[0].atlas
    system, names = atlas.system, names_in_words(atlas.system)
    name = names.get(atlas.claim.parameter, atlas.claim.parameter)
    given = ", ".join(f"{each} = {exact_text(v)}" for each, v in keyed_in_words(system, atlas.parameters).items())
    lines = [
        f"Let the certificates named below be proved. Equilibria and periodic orbits of the {system.title}"
        f"{f' with {given}' if given else ''} are here closed sets of states with the value of {name}, compared by the "
        f"Hausdorff distance of the sets and the distance of the values."
    ]
    for arc, values in zip(life.arcs, life.values, strict=True):
        lines += _arc(name, arc, values, [each for each in life.joints if each.arc == arc.id], digests[arc.id])
    if sum(len(arc.births) for arc in life.arcs) > 1:
        lines.append(f"All these births are at different equilibria, or for different values of {name}.")
    for part in life.parts:
        if len(part) > 1:
            lines.append(
                f"Any two equilibria and orbits of the {counted(len(part), 'arc')} {', '.join(map(shown, part))} are "
                "joined by a path of equilibria and periodic orbits of these arcs."
            )
    lines.append("That there are no other equilibria, orbits or births is not said.")
    return "\n".join(lines)


def _arc(name: str, arc: LifeCurve, values: arb, joints: list[Birthplace], digest: str) -> list[str]:
    told, items = f"{name} in {range_text(values, _FEW)}", []
    if isinstance(arc.curve, ProvedBirthCurve):
        what = "periodic orbits from their birth on"
        if arc.curve.period.is_finite():
            told += f"; least periods in {range_text(arc.curve.period, _FEW)}"
        items = [*(_birth(name, arc, joint) for joint in joints), *turns_in_words(name, arc.curve.turns, True)]
    elif isinstance(arc.curve, ProvedEquilibriumCurve):
        what = "equilibria" if not arc.atlas.claim.is_closed else "equilibria, a closed curve"
        items = [fold_in_words(name, fold) for fold in arc.curve.folds]
    return itemised(
        f"The arc {shown(arc.id)} ({digest}) of {what}; {told}:",
        items or [f"that {name} has an extremum along it is not said"],
    )


def _birth(name: str, arc: LifeCurve, joint: Birthplace) -> str:
    system = arc.atlas.system
    given, varying = system.given_state, arc.atlas.claim.parameter
    point = ", ".join(interval_text(joint.birth.point[each], _DIGITS) for each in given)
    state = ", ".join(names_in_words(system).get(each, each) for each in given)
    s, value, omega = (
        located(each, ball, _DIGITS)
        for each, ball in (("s", joint.place.s), (name, joint.birth.point[varying]), ("omega", joint.birth.frequency))
    )
    side = "beginning" if joint.how == BEGINS else "end"
    sentences = [
        f"{joint.how} {shown(joint.on)}, on piece {joint.place.piece} of it, {s}: at {value}, equilibrium ({state}) = "
        f"({point}).",
        f"Towards this {side} the orbits shrink to it, and their least periods tend to 2 pi/omega, {omega}.",
        f"i omega and -i omega are simple eigenvalues there, and cross the imaginary axis with a speed in {name} that "
        "is not 0.",
        *_sides(joint),
    ]
    return " ".join(sentences)


def _sides(joint: Birthplace) -> Iterator[str]:
    """What is known of the other eigenvalues, and of those of equilibria nearby."""
    left, right, open_ones = joint.birth.others.left, joint.birth.others.right, joint.birth.others.undecided
    if not open_ones:
        yield (
            f"Of the equilibria of {shown(joint.on)} next to it those on one side have {left + 2} eigenvalues with "
            f"negative and {right} with positive real part, those on the other side {left} and {right + 2}."
        )
    for sides, where in ((joint.before, "before"), (joint.after, "after")):
        if sides is not None:
            yield f"On the nearest part of {shown(joint.on)} {where} it where they are counted {_have(sides)}."


def _have(sides: Sides) -> str:
    return f"{sides.left} {'has' if sides.left == 1 else 'have'} a negative and {sides.right} a positive real part"
