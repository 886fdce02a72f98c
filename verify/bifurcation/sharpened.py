"""Whether a condition would fail even if nothing were rounded: then more precision does not help.

Nothing here carries proof: it only decides whether a claim that is not proved is tried again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from flint import arb

from orbitproof.verify.bifurcation.conditions import Problem
from orbitproof.verify.evidence import DerivativeTable, MultiIndex
from orbitproof.verify.newton import BoxFunction

_SAFETY = 2**10
"""An enclosure over the box may owe so many times more to rounding than the one at its centre."""


def sharpened(problem: Problem) -> Problem:
    """The problem as more precision may make it at best: what is wide because the box is wide stays so."""
    integral = problem.first_integral
    return replace(
        problem,
        iterates=tuple(tuple(_function(component) for component in components) for components in problem.iterates),
        first_integral=None if integral is None else _function(integral),
    )


def _function(function: BoxFunction) -> BoxFunction:
    centre = function.table.centre
    return BoxFunction(DerivativeTable(_narrower(function.table.box, centre), _narrower(centre, centre)))


def _narrower(balls: Mapping[MultiIndex, arb], centre: Mapping[MultiIndex, arb]) -> dict[MultiIndex, arb]:
    """The balls without what rounding may have added, but not without a small part of their width."""
    result = {}
    for index, ball in balls.items():
        width, rounding = arb(ball.rad()), arb(centre[index].rad()) * _SAFETY
        rest, least = width - rounding, width / _SAFETY
        result[index] = arb(ball.mid(), (rest if rest > least else least).upper())
    return result
