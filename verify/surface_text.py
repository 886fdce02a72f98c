"""The theorem about a surface of halo orbits in words (docs/method.md, section 17.4)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb

from shared.atlas import Atlas
from shared.numbers import format_exact
from shared.systems import HILL
from verify.ball_text import decimal_interval
from verify.balls import enclose

Ends = Mapping[str, Mapping[str, arb]]
"""Enclosures of the parameter and of the bifurcation point at the first and the last parameter, "start" and "end"."""

_DIGITS = 12
_SIDES = {
    "below": "less than that of the bifurcation point",
    "above": "greater than that of the bifurcation point",
}


def surface_statement(atlas: Atlas, ends: Ends, height: Fraction, sides: set[str], half_period: arb) -> str:
    """What is proved. `sides`: of the levels of the first integral at which the new orbits live, from all pieces."""
    system, claim = atlas.system, atlas.claim
    parameter = system.fixed_parameters[0]
    symmetry = claim.symmetry
    signs = system.symmetries[symmetry or ""]
    names = system.centre_coordinates
    odd = next(name for name in names if signs[system.state.index(name)] < 0)
    even = [name for name in names if name != odd]
    if claim.covers is None:
        reach = f"[{_lower(ends['start'][parameter])}, {_lower(ends['end'][parameter])}]"
    else:
        reach = f"[{_number(claim.covers.start)}, {_number(claim.covers.end)}]"
    point = ", ".join(f"{name}({parameter}, {odd})" if name != odd else odd for name in names)
    paragraphs = [
        f"Consider the {system.title} and the map P to the next crossing of the section {{{system.section} = 0}}.",
        f"There are smooth functions {' and '.join(even)} of {parameter} in {reach} and |{odd}| <= {_number(height)}, "
        f"even in {odd}, such that h({parameter}, {odd}) = ({point}) in Fix(R), in the coordinates "
        f"({', '.join(names)}), has these properties.",
        f"1. h({parameter}, 0) is a symmetry breaking bifurcation of P^2, with the {system.first_integral_name} as "
        f"parameter: a pair of R-symmetric periodic orbits, exchanged by {symmetry}, branches off from the family of "
        f"R- and {symmetry}-symmetric ones.",
        f"2. h({parameter}, {odd}) is the initial condition of an R-symmetric periodic orbit, P^2(h) = h; if {odd} is "
        f"not 0, it is none of the orbits that {symmetry} fixes point by point.",
    ]
    if len(sides) == 1 and (side := _SIDES.get(next(iter(sides)))) is not None:
        paragraphs.append(f"Near the bifurcation point their {system.first_integral_name} is {side}.")
    for key, text in (("start", "first"), ("end", "last")):
        values = ", ".join(f"{name} in {_interval(ends[key][name])}" for name in even)
        paragraphs.append(
            f"At the {text} {parameter}, {_lower(ends[key][parameter])}, the bifurcation point has {values}."
        )
    if half_period.is_finite():
        paragraphs.append(f"All half periods lie in {decimal_interval(half_period, 6)}.")
    further = _meaning(atlas, height)
    return "\n".join([*paragraphs, *([further] if further else [])])


def _meaning(atlas: Atlas, height: Fraction) -> str:
    """What a surface in Hill's units says about the CR3BP (section 17.1)."""
    covers = atlas.claim.covers
    if atlas.system is not HILL or covers is None or covers.end <= 0 or covers.start < 0:
        return ""
    lowest = f"({'0' if covers.start == 0 else _lower(enclose(covers.start**3))}"
    masses = f"{lowest}, {_lower(enclose(covers.end**3))}]"
    return (
        f"In the circular restricted three-body problem with mass parameter mu = h^3 this is the point (x, z, vy) = "
        f"(1 - mu + h xi, h zeta, h veta): for all mu in {masses} there is a symmetry breaking, and there are halo "
        f"orbits for |z| <= {_number(height)} mu^(1/3)."
        + (" At h = 0 the equations are those of Hill's lunar problem." if covers.start == 0 else "")
    )


def _interval(ball: arb) -> str:
    return "0" if ball.is_zero() else decimal_interval(ball, _DIGITS)


def _lower(ball: arb) -> str:
    """A number of which few digits are of interest, for people."""
    return f"{float(ball.mid()):.9g}"


def _number(value: Fraction) -> str:
    """A number exactly: in decimals where these are short, else dyadic with an approximate decimal before it."""
    if value.denominator == 1:
        return str(value.numerator)
    exact = format_exact(value)
    return str(float(value)) if Fraction(str(float(value))) == value else f"{float(value):.17g} (exactly {exact})"
