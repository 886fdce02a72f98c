"""Curves of symmetry-breaking points of the planar Lyapunov families in the mass parameter, in float64.

The point is the first one on its family at which the symmetry S breaks, where the halo orbits are born. It is found
once, on the planar family at the largest mass; from there pseudo-arclength continuation follows the equations of
`masses.charts` in (position, velocity, time, log mu). Folds in mu do no harm.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice, pairwise
from math import exp, log
from typing import Literal

import numpy as np

from orbitproof.explore.families import Limits
from orbitproof.explore.flow import FlowFailure, Vector
from orbitproof.explore.numerics import BREAKING, NoStep, predict, walked
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.three_body.families import trace_family
from orbitproof.explore.three_body.masses.charts import HALO, LOG_MU, UNKNOWNS, Evaluation, MassChart, evaluate
from orbitproof.explore.three_body.masses.file import CurveRecord, PointRecord
from orbitproof.explore.three_body.seeds import LIBRATION_POINTS
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL

Outcome = Literal["complete", "left", "failed", "interrupted"]


@dataclass(frozen=True)
class _Node:
    unknowns: Vector
    tangent: Vector
    at: Evaluation
    residual: float
    iterations: int


def extremum_brackets(points: Sequence[PointRecord]) -> list[tuple[PointRecord, PointRecord]]:
    """Neighbours on a curve between which dC/dmu changes its sign: between them C has a local extremum."""
    return [(a, b) for a, b in pairwise(points) if a.jacobi_derivative * b.jacobi_derivative < 0]


def chart_of(libration: str, family: str = HALO) -> MassChart:
    """The chart in which the curve of births of a family is regular; raises `ValueError` for an unknown point."""
    if libration not in LIBRATION_POINTS:
        raise ValueError(f"unknown libration point {libration!r}")
    return MassChart(libration != "L3", family)


def first_breaking(libration: str, mu: Fraction, family: str = HALO) -> PointRecord:
    """The first birth of halo or axial orbits on the planar family at one mass.

    Raises `families.named.FamilyFailure`.
    """
    system = CR3BP if family == HALO else CR3BP_AXIAL
    origin = trace_family(system, f"{libration}-{family}", {"mu": mu}, Limits(max_orbits=1)).orbits[0]
    chart = chart_of(libration, family)
    x, vy = (origin.unknowns[system.centre_coordinates.index(name)] for name in ("x", "vy"))
    return correct_at(chart, chart.unknowns(float(x), float(vy), origin.half_period, float(mu)))


def correct_at(chart: MassChart, guess: Vector) -> PointRecord:
    """The symmetry-breaking point at the mass of `guess`, shape (4,); raises `CorrectionFailure`."""
    return _point(chart, _correct(chart, guess, np.eye(UNKNOWNS)[LOG_MU]))


def point_at(libration: str, points: Sequence[PointRecord], mu: float) -> PointRecord:
    """The point at a mass between two points of a curve (the first such place); raises `CorrectionFailure`."""
    chart = chart_of(libration)
    for a, b in pairwise(points):
        # The masses at the ends come from their logarithms.
        if min(a.mu, b.mu) * (1 - 1e-12) <= mu <= max(a.mu, b.mu) * (1 + 1e-12):
            weight = log(mu / a.mu) / log(b.mu / a.mu)
            left, right = _unknowns(chart, a), _unknowns(chart, b)
            guess = left + weight * (right - left)
            guess[LOG_MU] = log(mu)
            return correct_at(chart, guess)
    raise CorrectionFailure(f"mu = {mu:.6g} does not lie on the curve")


def extremum_between(libration: str, a: PointRecord, b: PointRecord) -> PointRecord:
    """The point with dC/dmu = 0 between two points of `extremum_brackets`; raises `CorrectionFailure`.

    By the secant method kept inside the bracket (Illinois), to a relative accuracy of the mass of 1e-8.
    """
    ends = [(log(point.mu), point.jacobi_derivative) for point in (a, b)]
    point = a
    for _ in range(60):
        (left, f), (right, g) = ends
        middle = (left * g - right * f) / (g - f)
        if not min(left, right) < middle < max(left, right):
            break
        point = point_at(libration, (a, b), exp(middle))
        slope = point.jacobi_derivative
        moved = abs(middle - right)
        ends = [(right, g) if slope * g < 0 else (left, f / 2), (middle, slope)]
        if moved < 1e-8 or slope == 0:
            break
    return point


def trace_curve(
    libration: str,
    start: Sequence[PointRecord],
    smallest: float,
    *,
    family: str = HALO,
    step: float = 0.1,
    minimum: float = 1e-6,
    max_points: int = 5000,
    progress: Callable[[list[PointRecord]], None] | None = None,
) -> CurveRecord:
    """Continue a curve towards smaller masses.

    Arguments:
        start: the points there are already, from the largest mass on, at least one.
        smallest: the mass at which the curve ends; its last point lies there exactly.
        family: of the orbits that are born.
        step, minimum: longest and shortest step, in the chart's unknowns (one unit of log mu is a factor e).
        progress: called with all points after each new one.

    Never raises for a point that is not found: the outcome says where and why the curve ends.
    """
    chart, points = chart_of(libration, family), list(start)
    largest = log(points[0].mu)

    def ended(outcome: Outcome, why: str) -> CurveRecord:
        place = f"mu = {points[-1].mu:.6g}, x = {points[-1].x:.8g}"
        return CurveRecord(libration, outcome, f"{why} ({place})", tuple(points))

    if points[-1].mu <= smallest * (1 + 1e-12):
        return ended("complete", "smallest mass")

    def advance(size: float) -> tuple[tuple[_Node, PointRecord | None], float]:
        node, last = _next(chart, nodes[-3:], size), None
        if node.unknowns[LOG_MU] <= log(smallest):
            guess = _predict(nodes[-3:], (log(smallest) - nodes[-1].unknowns[LOG_MU]) / nodes[-1].tangent[LOG_MU])
            guess[LOG_MU] = log(smallest)
            last = correct_at(chart, guess)
        return (node, last), min(step, size * (1.5 if node.iterations <= 3 else 0.7))

    try:
        node = _correct(chart, _unknowns(chart, points[-1]), np.eye(UNKNOWNS)[LOG_MU])
        tangent = node.tangent if len(points) > 1 and _turned(points) else -node.tangent
        nodes = [_Node(node.unknowns, tangent, node.at, node.residual, 0)]
        steps = walked(advance, step, minimum, (CorrectionFailure, FlowFailure))
        for node, last in islice(steps, max(0, max_points - len(points))):
            if last is not None:
                points.append(last)
                return ended("complete", "smallest mass")
            nodes.append(node)
            points.append(_point(chart, node))
            if progress is not None:
                progress(points)
            if node.unknowns[LOG_MU] > largest:
                return ended("left", "the curve turns back to the largest mass")
    except (CorrectionFailure, FlowFailure, NoStep) as failure:
        return ended("failed", str(failure))
    except KeyboardInterrupt:
        return ended("interrupted", "interrupted")
    return ended("failed", f"{max_points} points")


def _unknowns(chart: MassChart, point: PointRecord) -> Vector:
    """The chart's unknowns; the time is good as a first guess only where the chart has it divided by mu."""
    time = chart.unknowns(point.x, point.vy, point.half_period, point.mu)[2]
    return np.array([*point.scaled, time, log(point.mu)])


def _turned(points: Sequence[PointRecord]) -> bool:
    return points[-1].mu > points[-2].mu


def _correct(chart: MassChart, guess: Vector, normal: Vector) -> _Node:
    """Newton's method in the hyperplane through `guess` across `normal`."""
    unknowns, last = guess.copy(), np.inf
    for iteration in range(BREAKING.steps):
        at = _evaluate(chart, unknowns)
        matrix = np.vstack([at.jacobian, normal])
        try:
            step = np.linalg.solve(matrix, np.append(at.residual, normal @ (unknowns - guess)))
        except np.linalg.LinAlgError:
            raise CorrectionFailure("the equations of symmetry breaking are singular") from None
        size = float(np.linalg.norm(step))
        found, lost = BREAKING.judge(size, last)
        if found:
            return _Node(unknowns, _tangent(at, normal), at, size, iteration)
        if lost:
            break
        last, unknowns = size, unknowns - step
    raise CorrectionFailure("Newton's method does not converge to a symmetry breaking")


def _evaluate(chart: MassChart, unknowns: Vector) -> Evaluation:
    # Beyond these the equations of the chart have further solutions that are no orbits; see its text.
    if not np.all(np.isfinite(unknowns)) or abs(chart.half_period(unknowns) - np.pi) > 0.45 * np.pi * (
        1 + 2 * chart.smaller
    ):
        raise CorrectionFailure("Newton's method does not converge to a symmetry breaking")
    return evaluate(chart, unknowns)


def _tangent(at: Evaluation, direction: Vector) -> Vector:
    _, values, rows = np.linalg.svd(at.jacobian)
    if values[-1] <= 1e-12 * values[0]:
        raise CorrectionFailure("the curve has no unique tangent")
    tangent: Vector = rows[-1]
    return tangent if float(tangent @ direction) >= 0 else -tangent


def _predict(nodes: Sequence[_Node], distance: float) -> Vector:
    last = nodes[-1]
    backwards = list(reversed(nodes))
    return predict([node.unknowns for node in backwards], [node.tangent for node in backwards], last.tangent, distance)


def _next(chart: MassChart, nodes: Sequence[_Node], size: float) -> _Node:
    tangent = nodes[-1].tangent
    node = _correct(chart, _predict(nodes, size), tangent)
    if float(node.tangent @ tangent) < 0.98:
        raise CorrectionFailure("the curve turns too sharply")
    return node


def _point(chart: MassChart, node: _Node) -> PointRecord:
    mu = exp(float(node.unknowns[LOG_MU]))
    place = node.unknowns[:2]
    x, vy = chart.point(place, mu)
    # The tangent of the curve, per unit of mu.
    slope = float(node.at.jacobi_gradient @ node.tangent) / float(node.tangent[LOG_MU]) / mu
    return PointRecord(
        mu=mu,
        x=x,
        vy=vy,
        second=chart.point(node.at.second, mu),
        scaled=(float(place[0]), float(place[1])),
        half_period=chart.half_period(node.unknowns),
        jacobi_constant=node.at.jacobi_constant,
        jacobi_derivative=slope,
        residual=node.residual,
    )
