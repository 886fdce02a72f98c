"""Resonances, symmetry breakings and folds along a family of symmetric periodic orbits.

A 1:k resonance, k > 1, is a zero of det(Sigma - c) along the family, c = cos(2 pi j/k), with the
stability matrix Sigma of `explore.orbits.stability`; along an orbit family in Fix(S) symmetry breaks where the
S-odd block of D_p pi_q P is singular; a fold is a zero of the derivative of the bifurcation parameter, family
parameter or first integral, along the unit tangent. All are smooth functions of the arclength, and every
evaluation corrects onto the family: a zero is the solution of the shooting equations together with
the resonance condition.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby

import numpy as np

from orbitproof.explore.families.continuation import Course, Family, Start, Stop, describe, trace
from orbitproof.explore.families.stability_curve import Extremum, StabilityCurve
from orbitproof.explore.families.step_control import SAMPLING_TIMEOUT
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.names import resonant_values
from orbitproof.explore.numerics import Samples, Touch, bracketed_zero, find_zeros
from orbitproof.explore.orbits import (
    CorrectionFailure,
    ShootingProblem,
    Side,
    SymmetricOrbit,
    tupling_sides,
)
from orbitproof.shared.claims.candidate import OfKind
from orbitproof.shared.formats import FOLD

BREAKS = "the symmetry breaks"

_LOST_RANK = 1e-2
"""Smallest singular value beside that of the orbits on both sides; it falls in proportion to the distance."""

_SAME = 1e-9
"""Between a stability parameter and the entry of the stability matrix that it is."""

_DIFFERENCE = 1e-5
"""In scaled arclength: rounding and truncation leave ten digits of a derivative."""


@dataclass(frozen=True)
class LocatedResonance(OfKind):
    """A bifurcation of symmetric orbits, located in float64.

    Attributes:
        k: multiplicity, 1 for symmetry breaking and folds.
        kind: "symmetry_breaking", "fold", "touch_and_go" (k = 3) or "period_tupling".
        symmetry: the symmetry that breaks or, for period tupling with k = 3, that fixes the family; otherwise `None`.
        orbit: the resonant orbit.
        side: the point of the orbit on Fix(R) near which new orbits meet Fix(R).
        other_side: whether they (for even k: others) do so near the other point as well.
        value: the resonant stability parameter cos(2 pi j/k).
    """

    k: int
    kind: str
    symmetry: str | None
    orbit: SymmetricOrbit
    side: Side
    other_side: bool
    value: float

    @property
    def point(self) -> Vector:
        """The bifurcation point, in the order of `ReversibleSystem.centre_coordinates`."""
        return self.orbit.centre(self.side)


@dataclass(frozen=True)
class Detection:
    """What `detect` found.

    Attributes:
        resonances: by arclength.
        undecided: one line for each place where a stability curve comes so near to a resonant value
            that float64 cannot tell whether it reaches it, or where an orbit could not be computed.
        samples: orbits along the family, between which no resonance can hide; see `explore.families.stability_curve`.
            Empty if only symmetry breakings were asked for.
        extrema: of the stability parameters, the places where two further resonances might have been missed.
        error: an estimate of how far float64 may be off in the stability parameters of the samples.
    """

    resonances: tuple[LocatedResonance, ...]
    undecided: tuple[str, ...]
    samples: tuple[SymmetricOrbit, ...] = ()
    extrema: tuple[Extremum, ...] = ()
    error: float = 0.0


def kind_of(k: int) -> str:
    """The generic bifurcation of symmetric orbits at a 1:k resonance."""
    return {1: "symmetry_breaking", 3: "touch_and_go"}.get(k, "period_tupling")


def _resonance_function(coefficients: Vector, value: float) -> float:
    """det(value - Sigma), divided by a positive smooth function so that large |Sigma| does no harm."""
    return float(np.polyval(np.append(1.0, coefficients), value)) / float(np.sqrt(1.0 + coefficients @ coefficients))


def detect(
    family: Family,
    multiplicities: Iterable[int],
    *,
    with_folds: bool = False,
    timeout: float = SAMPLING_TIMEOUT,
    progress: Callable[[float], None] | None = None,
) -> Detection:
    """All 1:k resonances of a family for the given k, and for k = 1 its symmetry breakings.

    Arguments:
        multiplicities: the k to look for, each at least 1.
        with_folds: whether to look for folds as well.
        timeout: seconds after which the stability is not sampled further along the family.
        progress: called with the arclength that has been searched.
    """
    wanted = sorted(set(multiplicities))
    found: list[LocatedResonance] = []
    undecided: list[str] = []
    if 1 in wanted:
        found += symmetry_breakings(family)
    if with_folds:
        found += folds(family)
    orbits: tuple[SymmetricOrbit, ...] = ()
    error = 0.0
    extrema: list[Extremum] = []
    if any(k > 1 for k in wanted):
        family, unresolved = resolved_part(family)
        undecided += unresolved
    if any(k > 1 for k in wanted) and len(family.orbits) > 1:
        curve = StabilityCurve(family, timeout)
        samples = curve.samples(progress)
        undecided += curve.left_out(samples)
        error = curve.error(samples)
        for k in wanted if len(samples.places) > 1 else ():
            for value in resonant_values(k) if k > 1 else ():
                more, unclear = _tuplings(curve, samples, k, value)
                found += more
                undecided += unclear
        extrema = curve.extrema(samples, wanted)
        orbits = curve.orbits(samples, extrema)
        undecided += curve.unknown
    found.sort(key=lambda resonance: resonance.orbit.arclength)
    return Detection(tuple(found), tuple(undecided), orbits, tuple(extrema), error)


def resolved_part(family: Family) -> tuple[Family, list[str]]:
    """The longest part of a family on which float64 resolves the stability, and a line for each part left out.

    Where a half return contracts by more than float64 can hold, as in the Falkner-Skan equation towards beta = 1, the
    stability parameter of its orbit is nothing but rounding errors. With more than one stability parameter the others
    may still be resolved: such families are left whole.
    """
    if len(family.problem.system.kernel_coordinates) > 1:
        return family, []
    problem = family.problem
    orbits = [problem.with_derivative(orbit) for orbit in family.orbits]
    resolved = [orbit.derivative is not None and orbit.derivative.resolved for orbit in orbits]
    parts: list[tuple[int, int, bool]] = []
    for known, group in groupby(range(len(orbits)), key=resolved.__getitem__):
        indices = list(group)
        parts.append((indices[0], indices[-1] + 1, known))
    kept = max((part for part in parts if part[2]), key=lambda part: part[1] - part[0], default=(0, 0, True))
    lines = [
        f"no resonances are looked for from {describe(problem, orbits[start])} to "
        f"{describe(problem, orbits[end - 1])}: float64 does not resolve the stability there"
        for start, end, known in parts
        if (start, end, known) != kept
    ]
    if len(parts) == 1 and kept[1]:
        return family, []
    part = slice(kept[0], kept[1])
    return replace(family, orbits=tuple(orbits[part]), tangents=family.tangents[part]), lines


def _tuplings(
    curve: StabilityCurve, samples: Samples, k: int, value: float
) -> tuple[list[LocatedResonance], list[str]]:
    family = curve.family

    def function(arclength: float) -> float:
        return _resonance_function(curve.coefficients(arclength), value)

    zeros = find_zeros(function, samples.places, [_resonance_function(row, value) for row in samples.values])
    found: list[LocatedResonance] = []
    for place in zeros.zeros:
        orbit = family.problem.with_derivative(curve.orbit(place))
        assert orbit.derivative is not None
        sides = tupling_sides(orbit.derivative, k)
        symmetry = _tripling_symmetry(family.problem, orbit, value) if k == 3 else None
        kind = kind_of(k) if symmetry is None else "period_tupling"
        found.append(LocatedResonance(k, kind, symmetry, orbit, sides[0], len(sides) > 1, value))
    undecided = zeros.undecided
    if k == 2:
        doublings = {touch: _doublings(curve, samples, touch) for touch in undecided}
        found += [each for several in doublings.values() for each in several]
        undecided = tuple(touch for touch in undecided if not doublings[touch])
    unclear = [
        f"a stability parameter comes within {abs(touch.value):.1e} of {value:.6g} (k = {k}) and may or may not "
        f"reach it ({describe(family.problem, curve.orbit(touch.place))})"
        for touch in undecided
    ]
    return found, unclear


def _tripling_symmetry(problem: ShootingProblem, orbit: SymmetricOrbit, value: float) -> str | None:
    """The symmetry that fixes the family and negates the direction in which the orbit is resonant, if there is one.

    Then the new orbits do not touch and go.
    """
    name = problem.symmetry
    if name is None or orbit.derivative is None or len(problem.odd_unknowns(name)) != 1:
        return None
    odd = [i for i, state in enumerate(problem.system.kernel_coordinates) if problem.parities[state] == -1]
    if len(odd) != 1:
        return None
    parameters = np.linalg.eigvals(orbit.derivative.stability_matrix)
    across = orbit.derivative.stability_matrix[odd[0], odd[0]]
    return name if abs(across - value) <= np.min(np.abs(parameters - value)) + _SAME else None


def _doublings(curve: StabilityCurve, samples: Samples, touch: Touch) -> list[LocatedResonance]:
    """The 1:2 resonance where a stability parameter touches -1, as on straight orbits: both its factors change sign.

    Empty where neither does next to the touch.
    """
    problem = curve.family.problem
    index = int(np.searchsorted(samples.places, touch.place))
    low, high = samples.places[max(index - 1, 0)], samples.places[min(index + 1, len(samples.places) - 1)]
    if low == touch.place:
        low = samples.places[max(index - 2, 0)]

    def value(arclength: float, side: Side) -> float:
        derivative = problem.with_derivative(curve.orbit(arclength)).derivative
        assert derivative is not None
        return derivative.doubling_value(side)

    places: dict[Side, float] = {}
    for side in ("first", "second"):
        ends = value(low, side), value(high, side)
        if (ends[0] < 0) != (ends[1] < 0):
            tolerance = 4e-13 * max(1.0, abs(high))
            places[side] = bracketed_zero(partial(value, side=side), (low, high), ends, tolerance)
    if not places:
        return []
    side = next(iter(places))
    orbit = problem.with_derivative(curve.orbit(places[side]))
    return [LocatedResonance(2, kind_of(2), None, orbit, side, len(places) > 1, -1.0)]


def symmetry_breakings(family: Family) -> list[LocatedResonance]:
    """Symmetry breakings on a family.

    On a family within Fix(S): the sign changes of the S-odd block. On any other: its ends that lie
    in Fix(S), where it branches off from orbits in Fix(S).

    Raises `CorrectionFailure` if the orbit at a sign change cannot be computed.
    """
    problem, system = family.problem, family.problem.system
    found: list[LocatedResonance] = []
    if problem.symmetry is None:
        for orbit in {id(orbit): orbit for orbit in (family.orbits[0], family.orbits[-1])}.values():
            for name in system.symmetries:
                odd = problem.odd_unknowns(name)
                if odd and all(orbit.unknowns[i] == 0 for i in odd):
                    found.append(_breaking(orbit, name))
        return found

    orbits = [problem.with_derivative(orbit) for orbit in family.orbits]
    values = [problem.symmetry_breaking_function(orbit) for orbit in orbits]

    def function(arclength: float) -> float:
        try:
            return problem.symmetry_breaking_function(family.orbit_at(arclength))
        except CorrectionFailure:
            return float(np.interp(arclength, family.arclengths, values))

    zeros = find_zeros(function, family.arclengths, values).zeros if len(orbits) > 1 else ()
    return [_breaking(family.orbit_at(place), problem.symmetry) for place in zeros]


def folds(family: Family) -> list[LocatedResonance]:
    """Extrema of the bifurcation parameter, family parameter or first integral, along a family.

    Extrema for another reason are left out, at which two curves of symmetric orbits meet: ends of the family in Fix(S),
    where symmetry breaks, and places where a family goes back over its own orbits, at a period doubling.
    """
    problem, values = family.problem, list[float]()
    for orbit, tangent in zip(family.orbits, family.tangents, strict=True):
        values.append(_level_slope(problem, orbit.unknowns, tangent))
    breaking = [id(found.orbit) for found in symmetry_breakings(family)] if problem.symmetry is None else []
    kept = [i for i, orbit in enumerate(family.orbits) if id(orbit) not in breaking]
    places = [family.arclengths[i] for i in kept]

    def function(arclength: float) -> float:
        try:
            orbit = family.orbit_at(arclength)
            _, jacobian, _ = problem.evaluate(orbit.unknowns)
            nearest = min(kept, key=lambda i: abs(family.arclengths[i] - arclength))
            return _level_slope(problem, orbit.unknowns, problem.tangent(jacobian, family.tangents[nearest]))
        except (CorrectionFailure, FlowFailure):
            return float(np.interp(arclength, places, [values[i] for i in kept]))

    zeros = find_zeros(function, places, [values[i] for i in kept]).zeros if len(kept) > 1 else ()
    found = [family.orbit_at(place) for place in zeros]
    return [
        LocatedResonance(1, FOLD, None, orbit, "first", True, 1.0) for orbit in found if _is_one_curve(family, orbit)
    ]


def _is_one_curve(family: Family, orbit: SymmetricOrbit) -> bool:
    """Whether the derivative of the shooting equations keeps its rank at an orbit between those of the family.

    At a fold it does, the family parameter or level included; where two curves meet, it does not.
    """
    problem = family.problem

    def least(unknowns: Vector) -> float:
        _, jacobian, _ = problem.evaluate(unknowns)
        scales = problem.scales[list(problem.free_unknowns)]
        return float(np.linalg.svd(jacobian * scales, compute_uv=False)[-1])

    place = int(np.searchsorted(family.arclengths, orbit.arclength))
    beside = family.orbits[max(place - 1, 0) : place + 1]
    try:
        return least(orbit.unknowns) > _LOST_RANK * max(least(other.unknowns) for other in beside)
    except FlowFailure:
        return True


def _level_slope(problem: ShootingProblem, unknowns: Vector, tangent: Vector) -> float:
    """Derivative of the bifurcation parameter along a scaled tangent."""
    direction = tangent * problem.scales
    integral = problem.system.first_integral
    if integral is None or problem.system.family_parameter is not None:
        return float(direction[0])

    def value(shift: float) -> float:
        moved = unknowns + shift * direction
        return float(integral(problem.initial_state(moved), problem.parameter_values(moved))[0])

    return (value(_DIFFERENCE) - value(-_DIFFERENCE)) / (2 * _DIFFERENCE)


def _breaking(orbit: SymmetricOrbit, symmetry: str) -> LocatedResonance:
    return LocatedResonance(1, kind_of(1), symmetry, orbit, "first", True, 1.0)


def symmetry_breaking_near(problem: ShootingProblem, symmetry: str, guess: Vector, reach: float) -> SymmetricOrbit:
    """The symmetry-breaking orbit in Fix(S) nearest to `guess` on the family of orbits in Fix(S).

    Arguments:
        problem: any shooting problem of the system.
        guess: shape (2 + n,), unknowns; their S-odd ones are ignored.
        reach: scaled arclength to search in both directions.

    Raises `CorrectionFailure` if there is none within reach.
    """
    inner = replace(problem, symmetry=symmetry)
    unknowns = guess.copy()
    unknowns[list(problem.odd_unknowns(symmetry))] = 0.0
    try:
        _, jacobian, _ = inner.evaluate(unknowns)
    except FlowFailure as error:
        raise CorrectionFailure(str(error)) from None
    tangent = inner.tangent(jacobian, np.ones(inner.size))
    best: SymmetricOrbit | None = None
    for direction in (tangent, -tangent):
        limit = reach if best is None else best.arclength
        family = trace(inner, Start(unknowns, direction), Course(until_breaking(inner, limit), max_orbits=200))
        breakings = symmetry_breakings(family)
        if breakings and (best is None or breakings[0].orbit.arclength < best.arclength):
            best = breakings[0].orbit
    if best is None:
        raise CorrectionFailure(f"the symmetry {symmetry} does not break nearby")
    return best


def until_breaking(problem: ShootingProblem, reach: float) -> Stop:
    """Stops a family in Fix(S) after a sign change of its S-odd block, or out of reach."""
    values: list[float] = []

    def stop(orbit: SymmetricOrbit, states: Matrix) -> str | None:
        values.append(problem.symmetry_breaking_function(orbit))
        if values[-1] * values[0] < 0:
            return BREAKS
        return "out of reach" if orbit.arclength > reach else None

    return stop
