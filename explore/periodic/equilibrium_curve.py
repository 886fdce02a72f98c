"""Curves of equilibria in a parameter, with the folds, branch points and Hopf points on them, in float64.

Pseudo-arclength continuation: the unknowns are the state and the parameter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations, islice
from typing import Any

import numpy as np

from orbitproof.explore import numerics
from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.names import told_apart
from orbitproof.explore.numerics import AT_REST, NoStep, walked
from orbitproof.explore.periodic.correction import PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.detection import BRANCH, FOLD, UnresolvedError, followed_one_by_one
from orbitproof.explore.periodic.equilibria import Equilibrium, equilibrium_at
from orbitproof.explore.periodic.equilibrium_refinement import refined_equilibrium
from orbitproof.explore.periodic.flow import Matrix, Vector, velocity_at
from orbitproof.explore.periodic.hopf import Hopf, hopf_as_json, hopf_described, hopf_near, place_of
from orbitproof.explore.refinement import RefinementFailure

_RESOLUTION = 1e-9
_PATIENCE = 1e-4
"""Steps are not made shorter than this for the sake of eigenvalues."""
_FARTHEST = 0.2
"""Eigenvalues move at most so far from point to point, relative to the largest."""
_REAL = 1e-7
_GROWN = 2.0
_CROSSING = 1e-5
"""Singular values below this part of the largest are those of two curves that cross."""
_DIGITS = 20
_SAME = 1e-6


@dataclass(frozen=True)
class EquilibriumControl(numerics.StepControl):
    """Steps along a curve of equilibria, in units of its size and of the interval of the parameter.

    Attributes:
        most: number of points, each way.
    """

    initial: float = 0.005
    minimum: float = 1e-8
    maximum: float = 0.02
    turning: float = 0.2
    most: int = 2000


@dataclass(frozen=True)
class RestPoint:
    """An equilibrium on a curve, the value of the parameter, and the tangent of the curve in units of its scale."""

    equilibrium: Equilibrium
    value: float
    tangent: Vector


@dataclass(frozen=True)
class SpecialPoint:
    """A fold, where the curve turns back in the parameter, or a branch point, where two curves cross."""

    kind: str
    point: Vector
    value: float


@dataclass(frozen=True)
class EquilibriumCurve:
    """A curve of equilibria.

    Attributes:
        name: of the parameter.
        members: in order along the curve.
        special: folds, branch points and Hopf points, in the same order.
        reason: why it ends.
        interrupted: whether it was cut short by the user.
    """

    problem: PeriodicProblem
    name: str
    members: tuple[RestPoint, ...]
    special: tuple[SpecialPoint | Hopf, ...]
    reason: str
    interrupted: bool = False

    @property
    def hopf(self) -> tuple[Hopf, ...]:
        """The Hopf points."""
        return tuple(each for each in self.special if isinstance(each, Hopf))


@dataclass(frozen=True)
class _Equations:
    """f(x, a) = 0, for z = (x, a) in units of a scale of shape (N + 1,)."""

    problem: PeriodicProblem
    name: str
    scale: Vector
    has_integral: bool

    @property
    def place(self) -> int:
        return list(self.problem.system.parameters).index(self.name)

    def values(self, value: float) -> Vector:
        values = self.problem.values
        values[self.place] = value
        return values

    def at(self, z: Vector) -> Equilibrium:
        return equilibrium_at(self.problem.system, z[:-1], self.values(z[-1]))

    def derivative(self, here: Equilibrium) -> Matrix:
        """The derivative of f by z / scale, shape (N, N + 1)."""
        n = len(here.point)
        return np.column_stack([here.matrix, here.slopes[:, n + self.place]]) * self.scale

    def member(self, here: Equilibrium, along: Vector | None) -> RestPoint:
        """With the tangent in the direction of `along`, by default that in which the parameter grows."""
        tangent = np.linalg.svd(self.derivative(here))[2][-1]
        towards = tangent[-1] if along is None else tangent @ along
        return RestPoint(here, float(here.values[self.place]), -tangent if towards < 0 else tangent)

    def corrected(self, before: RestPoint, length: float) -> RestPoint:
        """The equilibrium so far along the curve. Raises `PeriodicFailure`."""
        start = np.append(before.equilibrium.point, before.value)
        predicted = start + length * before.tangent * self.scale
        z, last = predicted.copy(), np.inf
        try:
            for _ in range(AT_REST.steps):
                here = self.at(z)
                residual = velocity_at(self.problem.system, here.point, here.values)
                bordered = np.vstack([self.derivative(here), before.tangent])
                across = before.tangent @ ((z - predicted) / self.scale)
                step = -np.linalg.lstsq(bordered, np.append(residual, across), rcond=None)[0]
                z = z + step * self.scale
                size = float(np.max(np.abs(step)))
                if not np.isfinite(size) or size > 10 * abs(length) + 1e-3:
                    break
                if AT_REST.judge(size, last)[0]:
                    return self.member(self.at(z), before.tangent)
                last = size
        except (FlowFailure, np.linalg.LinAlgError) as failure:
            raise PeriodicFailure(str(failure)) from None
        raise PeriodicFailure("Newton's method does not converge")

    def rescaled(self, now: RestPoint) -> tuple[_Equations, RestPoint]:
        """In units of the size of a point that is larger than the first ones."""
        scale = self.scale.copy()
        scale[:-1] = np.max(np.abs(now.equilibrium.point))
        other = replace(self, scale=scale)
        return other, other.member(now.equilibrium, now.tangent * self.scale / scale)


def continue_equilibrium(
    problem: PeriodicProblem,
    start: Equilibrium,
    name: str,
    bounds: tuple[float, float],
    control: EquilibriumControl | None = None,
    progress: Callable[[float], None] | None = None,
) -> EquilibriumCurve:
    """The curve of an equilibrium in a parameter, both ways, in the order in which the parameter grows at the start.

    Arguments:
        bounds: of the parameter; the curve ends with the first point beyond.

    Raises `PeriodicFailure` if it has no first step.
    """
    control = control or EquilibriumControl()
    size = float(np.max(np.abs(start.point)))
    scale = np.append(np.full(len(start.point), size if size > _SAME else 1.0), bounds[1] - bounds[0])
    # With a first integral pairs of eigenvalues stay on the axis, and nothing tells a Hopf point.
    equations = _Equations(problem, name, scale, problem.system.first_integral_program is not None)
    first = equations.member(start, None)
    say = progress or (lambda _done: None)
    ways = []
    for number, sign in enumerate((-1, 1)):
        trace = _Trace([], [])
        ways.append(trace)
        begin = replace(first, tangent=sign * first.tangent)
        try:
            trace.reason = _follow(
                equations, begin, bounds, control, trace, lambda done, number=number: say((number + done) / 2)
            )
        except KeyboardInterrupt:
            trace.reason, trace.interrupted = "was interrupted", True
            break
    back, ahead = ways[0], ways[1] if len(ways) > 1 else _Trace([], [], "is not followed the other way")
    if not back.members and not ahead.members and not back.interrupted:
        raise PeriodicFailure(f"the curve of equilibria has no first step: it {ahead.reason}")
    return EquilibriumCurve(
        problem,
        name,
        (*(replace(each, tangent=-each.tangent) for each in reversed(back.members)), first, *ahead.members),
        (*reversed(back.special), *ahead.special),
        f"{back.reason}; {ahead.reason}",
        back.interrupted or ahead.interrupted,
    )


@dataclass
class _Trace:
    """A curve one way: its points without the first, what is on it, why it ends."""

    members: list[RestPoint]
    special: list[SpecialPoint | Hopf]
    reason: str = ""
    interrupted: bool = False


def _follow(
    equations: _Equations,
    start: RestPoint,
    bounds: tuple[float, float],
    control: EquilibriumControl,
    trace: _Trace,
    progress: Callable[[float], None],
) -> str:
    """Fill the trace, and say why the curve ends."""
    low, high = bounds
    units, last = equations, start

    def advance(length: float) -> tuple[RestPoint, float]:
        now = units.corrected(last, length)
        angle = float(np.arccos(np.clip(now.tangent @ last.tangent, -1, 1)))
        if angle > control.turning:
            raise PeriodicFailure("it turns too fast")
        trace.special += _between(units, last, now, length, length > _PATIENCE)
        return now, min(control.maximum, length * (1.4 if angle < control.turning / 3 else 1.0))

    try:
        steps = walked(advance, control.initial, control.minimum, (PeriodicFailure, UnresolvedError))
        for now in islice(steps, control.most):
            trace.members.append(now)
            progress(min(0.99, max(len(trace.members) / control.most, abs(now.value - start.value) / (high - low))))
            last = now
            if not low <= now.value <= high:
                return f"reaches {now.value:.6g}"
            apart = np.append(now.equilibrium.point - start.equilibrium.point, now.value - start.value) / units.scale
            if len(trace.members) > 3 and np.max(np.abs(apart)) < 1e-9:
                return "is closed"
            if np.max(np.abs(now.equilibrium.point)) > _GROWN * units.scale[0]:
                units, last = units.rescaled(now)
    except NoStep as failure:
        return f"ends near {last.value:.10g}: {failure}"
    return f"has {control.most} points, the most that were asked for, at {last.value:.6g}"


def _between(
    equations: _Equations, before: RestPoint, now: RestPoint, length: float, patient: bool
) -> list[SpecialPoint | Hopf]:
    """What lies on a step. Raises `UnresolvedError` where a shorter one is needed to tell, and is possible."""
    old, new = before.equilibrium.eigenvalues, now.equilibrium.eigenvalues
    if patient and not equations.has_integral:
        size = max(np.max(np.abs(old)), np.max(np.abs(new)))
        pairs = followed_one_by_one(old, new)
        crossing = [
            (left, right) for left, right in pairs if left.real * right.real < 0 and left.imag > 0 and right.imag > 0
        ]
        if len(crossing) > 1 or any(abs(left - right) > _FARTHEST * size for left, right in pairs):
            raise UnresolvedError
    found: list[SpecialPoint | Hopf] = []
    if before.tangent[-1] * now.tangent[-1] < 0:
        found.append(_fold(equations, _located(equations, before, now, length, lambda each: float(each.tangent[-1]))))
    elif _crossing_test(equations)(before) * _crossing_test(equations)(now) < 0:
        there = _located(equations, before, now, length, _crossing_test(equations))
        found.append(SpecialPoint(BRANCH, there.equilibrium.point, there.value))
    if not equations.has_integral and _hopf_test(before) * _hopf_test(now) < 0:
        hopf = _hopf(equations, _located(equations, before, now, length, _hopf_test))
        found += [] if hopf is None else [hopf]
    return found


def _crossing_test(equations: _Equations) -> Callable[[RestPoint], float]:
    """A function with a sign change where two curves cross, and not at a fold."""

    def test(member: RestPoint) -> float:
        sign, _ = np.linalg.slogdet(np.vstack([equations.derivative(member.equilibrium), member.tangent]))
        return float(sign)

    return test


def _hopf_test(member: RestPoint) -> float:
    """The product of all sums of two eigenvalues, in units of the largest: it changes sign where a pair crosses."""
    found = member.equilibrium.eigenvalues
    size = float(np.max(np.abs(found))) or 1.0
    product = 1.0 + 0j
    for left, right in combinations(found, 2):
        product *= (left + right) / size
    return product.real if len(found) > 1 else 1.0


def _located(
    equations: _Equations, before: RestPoint, now: RestPoint, length: float, test: Callable[[RestPoint], float]
) -> RestPoint:
    """The point on a step at which a test changes its sign; an end of the step if it cannot be reached."""
    # Only now: scipy takes a moment to load.
    from scipy.optimize import brentq

    known = {0.0: before, length: now}

    def value(place: float) -> float:
        if place not in known:
            known[place] = equations.corrected(before, place)
        return test(known[place])

    try:
        return known[brentq(value, 0.0, length, xtol=_RESOLUTION * length, rtol=1e-15)]
    except (PeriodicFailure, ValueError, KeyError):
        return min(known.values(), key=lambda each: abs(test(each)))


def _fold(equations: _Equations, there: RestPoint) -> SpecialPoint:
    """A fold to all digits of float64, as it was located where that fails; a branch point where two curves cross."""
    sizes = np.linalg.svd(equations.derivative(there.equilibrium))[1]
    if sizes[-1] < _CROSSING * sizes[0]:
        return SpecialPoint(BRANCH, there.equilibrium.point, there.value)
    vector = np.linalg.svd(there.equilibrium.matrix)[2][-1]
    guess = [*there.equilibrium.point, there.value]
    try:
        _, found = refined_equilibrium(equations.problem, equations.name, guess, [vector], _DIGITS)
    except RefinementFailure:
        return SpecialPoint(FOLD, there.equilibrium.point, there.value)
    n = len(vector)
    return SpecialPoint(FOLD, np.array(list(map(float, found.unknowns[:n]))), float(found.unknowns[n]))


def _hopf(equations: _Equations, there: RestPoint) -> Hopf | None:
    """The Hopf point near an equilibrium; `None` where two real eigenvalues have sum 0, or none is found."""
    eigenvalues, vectors = np.linalg.eig(there.equilibrium.matrix)
    sums = {(i, j): abs(eigenvalues[i] + eigenvalues[j]) for i, j in combinations(range(len(eigenvalues)), 2)}
    i, j = min(sums, key=lambda pair: sums[pair])
    k = i if eigenvalues[i].imag > 0 else j
    if not eigenvalues[k].imag > _REAL * np.max(np.abs(eigenvalues)):
        return None
    try:
        return hopf_near(
            equations.problem, equations.name, there.equilibrium.point, there.value, float(eigenvalues[k].imag),
            vectors[:, k],
        )  # fmt: skip
    except PeriodicFailure:
        return None


def curve_described(curve: EquilibriumCurve) -> list[str]:
    """A curve in lines."""
    first, last = curve.members[0], curve.members[-1]
    lines = [
        f"equilibria in {curve.name}: {len(curve.members)} points from {first.value:.10g} to {last.value:.10g}; "
        f"it {curve.reason}"
    ]
    for each in curve.special:
        lines += (
            hopf_described(each)
            if isinstance(each, Hopf)
            else [f"  {each.kind}: {curve.name} = {each.value:.15g}, {place_of(curve.problem, each.point)}"]
        )
    return lines


def curve_as_json(curve: EquilibriumCurve) -> dict[str, Any]:
    """A curve for programs; its points are in the files."""
    names = curve.problem.system.given_state
    return {
        "equilibria": curve.name,
        "points": len(curve.members),
        "first": curve.members[0].value,
        "last": curve.members[-1].value,
        "ends": curve.reason,
        "special": [
            hopf_as_json(each) if isinstance(each, Hopf) else {
                "kind": each.kind, "value": each.value, "point": dict(zip(names, each.point, strict=True))
            }
            for each in curve.special
        ],
    }  # fmt: skip


def curve_csv(curve: EquilibriumCurve) -> str:
    """The points of a curve as a table, one a line, in order along it."""
    system = curve.problem.system
    count = len(system.given_state)
    head = [*told_apart((curve.name.replace(",", " "),), system.given_state), *system.given_state]
    head += [f"eigenvalue{number} {part}" for number in range(1, count + 1) for part in ("real", "imaginary")]
    rows = [",".join(head)]
    for each in curve.members:
        numbers = [each.value, *each.equilibrium.point]
        for found in each.equilibrium.eigenvalues:
            numbers += [found.real, found.imag]
        rows.append(",".join(repr(float(number)) for number in numbers))
    return "\n".join(rows) + "\n"
