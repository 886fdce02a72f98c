"""The periodic orbits that are born at a Hopf point, followed from there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import sqrt

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import NoStep, walked
from orbitproof.explore.periodic.births import with_descendants
from orbitproof.explore.periodic.continuation import PATIENCE, PeriodicFamily, StepControl, scale_of, traced
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure
from orbitproof.explore.periodic.family import FamilyEquations, FamilyMember
from orbitproof.explore.periodic.flow import SAMPLES, Arc, Vector
from orbitproof.explore.periodic.hopf import Hopf, is_same_hopf
from orbitproof.explore.periodic.symmetries import Symmetry, linear_symmetries

_FIRST = 2e-3
"""The first orbit is so far from the Hopf point, in units of the interval of the parameter, by the normal form."""
_LARGEST, _SMALLEST = 0.05, 1e-4
"""The size of the first orbit is between these, relative to that of the equilibrium."""
_FROM_MIDDLE = 0.5
"""In the scale of the first orbit, how far its point is from the equilibrium."""


def cycles_of(
    hopf: Hopf,
    bounds: tuple[float, float],
    control: StepControl | None = None,
    progress: Progress | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
) -> PeriodicFamily:
    """The family of periodic orbits that is born at a Hopf point, from the smallest one on.

    Arguments:
        bounds: of the parameter; the family ends with the first orbit beyond.

    Raises `PeriodicFailure` if it cannot be reached.
    """
    control = control or StepControl()
    problem, name = hopf.problem, hopf.name
    if symmetries is None:
        symmetries = linear_symmetries(problem, name)
    small = _small_orbit(hopf, _radius(hopf, bounds[1] - bounds[0]))
    family = FamilyEquations(problem, name, scale_of(small, name, bounds), None, symmetries)
    direction = np.append(hopf.vector.real / np.linalg.norm(hopf.vector.real), [0.0, 0.0])
    begin = FamilyMember(small, hopf.value, direction)

    def attempt(length: float) -> tuple[FamilyMember, float]:
        return family.corrected(begin, length), length

    try:
        first = next(walked(attempt, _FROM_MIDDLE, PATIENCE, (PeriodicFailure,)))
    except (NoStep, FlowFailure) as failure:
        raise PeriodicFailure(
            f"no small orbits are reached from the Hopf point at {name} = {hopf.value:.8g}: {failure}"
        ) from None
    # Its tangent in the plane across the flow at its own point, from where the next orbits are looked for.
    here = family.member_of(first.orbit)
    first = here if here.tangent @ first.tangent > 0 else replace(here, tangent=-here.tangent)
    ahead = traced(family, first, bounds, control, progress, grows=True)
    return PeriodicFamily(
        problem, name, (first, *ahead.members), tuple(ahead.bifurcations), ahead.reason, hopf,
        interrupted=ahead.interrupted, hopf=ahead.hopf,
    )  # fmt: skip


def families_from(
    points: Sequence[Hopf],
    bounds: tuple[float, float],
    generations: int = 0,
    control: StepControl | None = None,
    progress: Progress | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
) -> Iterator[PeriodicFamily]:
    """The families that are born at Hopf points, each with those that are born from it (`births.families`).

    A family that cannot be reached is left out, and so is one that is known from its other end. Of two points that a
    symmetry maps to each other one is taken.
    """
    say = progress or (lambda _message, _fraction: None)
    known: list[Hopf] = []
    for point in points:
        own = linear_symmetries(point.problem, point.name) if symmetries is None else symmetries
        if any(is_same_hopf(point, other, (each.matrix for each in own)) for other in known):
            continue
        known.append(point)
        say(f"orbits of the Hopf point at {point.name} = {point.value:.8g}", None)
        try:
            family = cycles_of(point, bounds, control, progress, own)
        except PeriodicFailure as failure:
            say(str(failure), None)
            continue
        known += family.hopf
        for each in with_descendants(family, bounds, generations, control, progress, own):
            yield each
            if each.interrupted:
                return


def _radius(hopf: Hopf, width: float) -> float:
    """|z| of the first orbit x = x_0 + z q + conj(z q): speed (a - a_0) + omega l_1 |z|^2 = 0."""
    size = float(np.max(np.abs(hopf.equilibrium.point))) or 1.0
    wanted = sqrt(abs(hopf.speed) * _FIRST * width / max(abs(hopf.frequency * hopf.lyapunov), np.finfo(float).tiny))
    return min(max(wanted, _SMALLEST * size), _LARGEST * size)


def _small_orbit(hopf: Hopf, radius: float) -> ClosedOrbit:
    """The orbit of the linear flow; it stands at the equilibrium, with its velocity where the real part of q leads."""
    q, n, times = hopf.vector, len(hopf.vector), np.linspace(0.0, 2 * np.pi, SAMPLES)
    states = hopf.equilibrium.point + 2 * radius * np.real(q * np.exp(1j * times)[:, None])
    velocity: Vector = -hopf.frequency * 2 * radius * q.imag
    arc = Arc(hopf.equilibrium.point, velocity, np.eye(n), np.zeros((n, len(hopf.equilibrium.values))), states)
    return ClosedOrbit(hopf.equilibrium.point, hopf.period, hopf.equilibrium.values, arc, None, np.zeros(0), 0.0)
