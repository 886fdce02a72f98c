"""The theorem about a curve of equilibria in words (section 37.6)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from orbitproof.shared.claims import BirthAtlas, EquilibriumAtlas
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.equilibrium_curve import EquilibriumCurveTheorem, Fold, ProvedEquilibriumCurve, SidedPart, Sides
from orbitproof.verify.evidence import decimal_interval, exact_text, interval_text
from orbitproof.verify.words.periodic import field_in_lines

_DIGITS = 18
_TAKEN = ("c", "f", "h", "i", "j", "s", "u")
"""Letters of theorems, which no formula has for a part of it."""


def equilibrium_curve_in_words(theorem: EquilibriumCurveTheorem, curve: ProvedEquilibriumCurve) -> str:
    """What is proved of the curve."""
    atlas, claim, system = theorem.atlas, theorem.atlas.claim, theorem.atlas.system
    names = names_in_words(system)
    coordinates = ", ".join(names.get(name, name) for name in atlas.coordinates)
    first, last = (
        f"({', '.join(decimal_interval(ball, _DIGITS) for ball in keyed_in_words(system, curve.ends[key]).values())})"
        for key in ("start", "end")
    )
    simple = " without self-intersections" if claim.increasing or claim.is_closed else ""
    way = f"through {first}" if claim.is_closed else f"from {first} to {last}"
    beyond = "" if claim.is_closed else " and, next to its ends, of its continuation"
    given = ", ".join(
        f"{name} = {exact_text(value)}" for name, value in keyed_in_words(system, atlas.parameters).items()
    )
    paragraphs = [
        f"Consider the {system.title}{f' with {given}' if given else ''}.\nThere is a smooth"
        f"{' closed' if claim.is_closed else ''} curve{simple} in the coordinates ({coordinates}) {way}. Each of its "
        f"points is an equilibrium. Near it there are no other equilibria but those of the curve{beyond}."
    ]
    if claim.increasing:
        grow = "increases" if len(claim.increasing) == 1 else "increase"
        paragraphs.append(
            f"Along it {' and '.join(names.get(name, name) for name in claim.increasing)} {grow} strictly."
        )
    if claim.covers is not None:
        name = names.get(claim.covers.coordinate, claim.covers.coordinate)
        low, high = exact_text(claim.covers.start), exact_text(claim.covers.end)
        paragraphs.append(f"Along it {name} takes all values from {low} to {high}.")
    varying = names.get(claim.parameter, claim.parameter)
    if not claim.increasing and (curve.folds or len(curve.sides) > 1):
        paragraphs.append("Its points may be run through again: what is listed apart below may be the same.")
    paragraphs += [fold_in_words(varying, fold) for fold in curve.folds]
    if curve.folds:
        paragraphs.append(f"That {varying} has no other extrema is not said.")
    paragraphs += _sides(varying, curve.sides)
    return "\n".join(paragraphs)


def equilibrium_curve_in_full(atlas: EquilibriumAtlas | BirthAtlas, statement: str) -> str:
    """The statement so that it stands alone: the system in formulas before it."""
    system, names = atlas.system, names_in_words(atlas.system)
    lines, _ = field_in_lines(system, _TAKEN)
    lines += [f"  {name} = {exact_text(value)}" for name, value in keyed_in_words(system, atlas.parameters).items()]
    if names:
        called = ", ".join(f"{new} is called {name}" for name, new in names.items())
        lines.append(f"In the description of the system {called}, which has another meaning here.")
    return "\n".join([*lines, "Theorem.", statement])


def fold_in_words(name: str, fold: Fold) -> str:
    """Where the parameter, called so, turns back."""
    what = "maximum" if fold.is_maximum else "minimum"
    if fold.is_regular and fold.all_values is not None:
        return (
            f"It has a fold: {name} has exactly one {what} for {name} in {interval_text(fold.all_values, _DIGITS)} on "
            f"the part of piece {fold.pieces[0]} with s from {exact_text(fold.between[0])} to "
            f"{exact_text(fold.between[1])}, where the second derivative of {name} along the curve is not 0."
        )
    first, last = (interval_text(value, _DIGITS) for value in fold.values)
    return f"Along it {name} has a {what} between a point with {name} in {first} and one with {name} in {last}."


def _sides(name: str, parts: Sequence[SidedPart]) -> Iterator[str]:
    """How many eigenvalues lie where, part after part."""
    if len(parts) == 1:
        (part,) = parts
        yield (
            "How many eigenvalues have negative and positive real parts is not decided."
            if part.sides is None
            else f"Of the eigenvalues of every equilibrium of the curve {_where(part.sides)}."
        )
        return
    lines = ["Of the eigenvalues, from the beginning of the curve to its end:"]
    for place, part in enumerate(parts):
        if part.sides is not None:
            first, last = (interval_text(value, _DIGITS) for value in part.values)
            lines.append(f"from {name} in {first} to {name} in {last}, {_where(part.sides)};")
            continue
        near = [other.sides for other in parts[max(0, place - 1) : place + 2] if other is not part]
        differ = len(near) == 2 and near[0] != near[1]
        crossed = "; as the numbers on both sides differ, an equilibrium there has one on the axis" if differ else ""
        lines.append(f"for {name} in {interval_text(part.all_values, _DIGITS)} it is not decided{crossed};")
    yield "\n".join([*lines[:-1], f"{lines[-1][:-1]}."])


def _where(sides: Sides) -> str:
    what = ": stable equilibria" if not sides.right else ": unstable equilibria"
    have = "has" if sides.left == 1 else "have"
    return f"{sides.left} {have} a negative and {sides.right} a positive real part{what}"
