"""The theorem about a surface of halo orbits in words (section 17.4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import groupby
from math import ceil, floor

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import IN_HILL_UNITS
from orbitproof.verify.claim import atlas_in_words, keyed_in_words
from orbitproof.verify.evidence import exact_text, located, range_text
from orbitproof.verify.surface import Height, PlanarFamily, ProvedSurface, SurfaceTheorem

_DIGITS = 12
_SIDES = {"below": "less than at it", "above": "greater than at it"}


def surface_in_words(theorem: SurfaceTheorem, surface: ProvedSurface) -> str:
    """What is proved."""
    atlas, heights, sides, half_period = theorem.atlas, surface.heights, surface.sides, surface.half_period
    family = surface.family
    ends = {key: keyed_in_words(atlas.system, point) for key, point in surface.ends.items()}
    atlas = atlas_in_words(atlas)
    height = min(entry.z for entry in heights)
    system, claim = atlas.system, atlas.claim
    further = _meaning(atlas, height, family)
    parameter = system.fixed_parameters[0]
    symmetry = claim.symmetry
    signs = system.symmetries[symmetry or ""]
    names = system.centre_coordinates
    odd = next(name for name in names if signs[system.state.index(name)] < 0)
    even = [name for name in names if name != odd]
    if claim.covers is None:
        reach = f"[{_digits(heights[0].start, ceil)}, {_digits(heights[-1].end, floor)}]"
    else:
        reach = f"[{exact_text(claim.covers.start)}, {exact_text(claim.covers.end)}]"
    point = ", ".join(f"{name}({parameter}, {odd})" if name != odd else odd for name in names)
    comma = "," if system.reversor else ""
    level = f"the value of {'' if system in IN_HILL_UNITS else 'the '}{system.first_integral_name}"
    paragraphs = [
        f"Consider the {system.title}{comma} and the map P to the next crossing of the section "
        f"{{{system.section} = 0}}.",
        f"There are smooth functions {' and '.join(even)} of {parameter} in {reach} and "
        f"|{odd}| <= {exact_text(height)}, even in {odd}, such that X({parameter}, {odd}) = ({point}) in Fix(R), in "
        f"the coordinates ({', '.join(names)}), has these properties.",
        f"1. X({parameter}, 0) is a symmetry breaking bifurcation of P^2, with {level} as parameter: a pair of "
        f"R-symmetric periodic orbits, exchanged by {symmetry}, branches off from the family of R- and "
        f"{symmetry}-symmetric ones. {_which_family(family if further else None)}",
        f"2. X({parameter}, {odd}) is the initial condition of an R-symmetric periodic orbit, P^2(X) = X; if {odd} is "
        f"not 0, it is none of the orbits that {symmetry} fixes point by point.",
    ]
    if len(sides) == 1 and (side := _SIDES.get(next(iter(sides)))) is not None:
        paragraphs.append(f"Near the bifurcation point {level} on them is {side}.")
    for key, text, value in (("start", "first", heights[0].start), ("end", "last", heights[-1].end)):
        values = ", ".join(located(name, ends[key][name], _DIGITS) for name in even)
        paragraphs.append(
            f"At the {text} {parameter} of the pieces, {exact_text(value)}, the bifurcation point has {values}."
        )
    paragraphs += [
        f"Over {parameter} in [{_digits(run.start, ceil)}, {_digits(run.end, floor)}] all this holds up to "
        f"|{odd}| <= {exact_text(run.z)}."
        for run in _higher(heights, height)
    ]
    if half_period.is_finite():
        paragraphs.append(f"All half periods lie in {range_text(half_period, 4)}.")
    return "\n".join([*paragraphs, *([further] if further else [])])


def _higher(heights: Sequence[Height], least: Fraction) -> list[Height]:
    """Runs of neighbours over which the orbits reach higher than the least height, with what they have in common."""
    runs: list[Height] = []
    for reaches, group in groupby(heights, key=lambda entry: entry.z > least):
        if reaches:
            entries = list(group)
            runs.append(Height(entries[0].start, entries[-1].end, min(entry.z for entry in entries)))
    return runs


def _which_family(family: PlanarFamily | None) -> str:
    if family is not None:
        return f"That this family is the one that emanates from {family.point} is said below, with the masses."
    return (
        "Which family of such orbits that is, and whether it is the one that emanates from a libration point, is not "
        "part of the theorem."
    )


def _lyapunov(family: PlanarFamily, first: Fraction, last: Fraction) -> tuple[bool, str]:
    """Whether the family is known for all masses from `first` to `last`, and a sentence about it."""
    start, end = max(family.start, first), min(family.end, last)
    whole = start == first and end == last
    return whole, (
        f"For all mu in {_masses(start, end)} the planar orbit of X(h, 0) belongs to the planar Lyapunov family of "
        f"{family.point}: there is a smooth curve of planar R-symmetric periodic orbits that ends in {family.point}, "
        f"to which they shrink with periods that tend to that of the linear centre, and that orbit is one of them."
    )


def _masses(start: Fraction, end: Fraction) -> str:
    """An interval of masses with nine decimals, rounded inward; 0 itself is no mass."""
    return f"{'(0' if start == 0 else f'[{_decimal(start, ceil)}'}, {_decimal(end, floor)}]"


def _meaning(atlas: Atlas, height: Fraction, family: PlanarFamily | None) -> str:
    """What a surface in Hill's units says about the CR3BP (section 17.1)."""
    covers = atlas.claim.covers
    if atlas.system not in IN_HILL_UNITS or covers is None or covers.end <= 0 or covers.start < 0:
        return ""
    masses = _masses(covers.start**3, covers.end**3)
    whole, known = (False, "") if family is None else _lyapunov(family, covers.start**3, covers.end**3)
    reserve = "" if whole else " up to the identification of the family with that of Lyapunov"
    if known and not whole:
        reserve += ", where that is not said here"
    place, born, odd = _BORN[IN_HILL_UNITS.index(atlas.system)]
    return (
        f"In the circular restricted three-body problem with mass parameter mu = h^3 this is the point {place}: for "
        f"all mu in {masses} there is a symmetry breaking, and there are the orbits that branch off, "
        f"{born}{reserve}, for |{odd}| <= {exact_text(height)} mu^(1/3)."
        + (" At h = 0 the equations are those of Hill's lunar problem." if covers.start == 0 else "")
        + (f"\n{known}" if known else "")
    )


_BORN = (
    ("(x, z, vy) = (1 - mu + h xi, h zeta, h veta)", "halo orbits", "z"),
    ("(x, vy, vz) = (1 - mu + h xi, h veta, h vzeta)", "axial orbits", "vz"),
)
"""Of `IN_HILL_UNITS`: a point of Fix(R) in the coordinates of the CR3BP, the orbits that branch off, and the coordinate
by which is told how far they go."""


def _decimal(value: Fraction, rounded: Callable[[Fraction], int]) -> str:
    """A number in (0, 1] with nine decimals, rounded to one side."""
    return f"{Decimal(rounded(value * 10**9)).scaleb(-9):f}"


def _digits(value: Fraction, rounded: Callable[[Fraction], int]) -> str:
    """A number with twelve decimals, rounded to one side."""
    # Not by operations on decimals, which round to the nearest with 28 digits.
    text = f"{Decimal(f'{rounded(value * 10**12)}e-12'):f}"
    return text.rstrip("0").rstrip(".")
