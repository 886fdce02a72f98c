"""Equilibria of any vector field in float64: Newton's method from one start, or from many."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import NewtonRule
from orbitproof.explore.periodic.correction import PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.flow import Matrix, Vector, velocity_at
from orbitproof.shared.systems import System, with_functions

_COMPLEX = {"sin": cmath.sin, "cos": cmath.cos, "exp": cmath.exp, "log": cmath.log}
_SHIFT = 1e-30
_RULE, _HALVINGS = NewtonRule(tolerance=1e-13, accepted=1e-8, steps=60), 12
_AT_REST = 1e-7
_FALLS_BY = 1e-3
_STARTS, _SEED = 300, 11
"""So many starts are tried where none is given; they are the same each time."""
_SIZES = (-2.0, 2.0)
"""log10 of the sizes of their coordinates."""
_SAME = 1e-6


@dataclass(frozen=True)
class Equilibrium:
    """A state at rest, in float64.

    Attributes:
        point: shape (N,).
        values: shape (P,), all parameters.
        slopes: shape (N, N + P), derivatives of the field in the state and in the parameters.
        eigenvalues: complex, of the derivatives in the state; the largest real part first.
    """

    point: Vector
    values: Vector
    slopes: Matrix
    eigenvalues: Vector

    @property
    def matrix(self) -> Matrix:
        """Derivatives of the field in the state, shape (N, N)."""
        return self.slopes[:, : len(self.point)]

    @property
    def unstable(self) -> int:
        """How many eigenvalues have a positive real part."""
        return int(np.sum(self.eigenvalues.real > 0))


def equilibrium_at(system: System, point: Vector, values: Vector) -> Equilibrium:
    """A point with the derivatives there, whether it is at rest or not. Raises `FlowFailure`."""
    slopes = field_slopes(system, point, values)
    found = np.linalg.eigvals(slopes[:, : len(point)]).astype(complex)
    return Equilibrium(point, values, slopes, found[np.lexsort((-found.imag, -found.real))])


def field_slopes(system: System, point: Vector, values: Vector) -> Matrix:
    """Derivatives of the field in the given state and all parameters, shape (N, N + P), by complex steps.

    Raises `FlowFailure` where they are not defined.
    """
    velocity_at(system, point, values)
    n, columns = len(point), []
    inputs = [complex(value) for value in (*point, *values)]
    try:
        for place in range(len(inputs)):
            moved = list(inputs)
            moved[place] += 1j * _SHIFT
            whole = with_functions(system, [*moved[:n], *[0j] * len(system.defined)], moved[n:], _COMPLEX, None, _power)
            found = system.program.evaluate([*whole, *moved[n:]], None, _power)[:n]
            columns.append([complex(value).imag / _SHIFT for value in found])
    except (ArithmeticError, ValueError):
        columns = [[np.nan]]
    slopes = np.array(columns).T
    if not np.all(np.isfinite(slopes)):
        raise FlowFailure(f"the derivatives of {system.name} have no value there")
    return slopes


def _power(base: complex, exponent: Fraction) -> complex:
    return base ** (int(exponent) if exponent.denominator == 1 else float(exponent))


def equilibrium_near(problem: PeriodicProblem, start: Sequence[float] | Vector) -> Equilibrium:
    """The equilibrium to which Newton's method leads, its steps shortened where speed does not fall.

    Raises `PeriodicFailure`.
    """
    system, values, x = problem.system, problem.values, np.array(start, dtype=float)
    try:
        speed, before = velocity_at(system, x, values), np.inf
        for _ in range(_RULE.steps):
            slopes = field_slopes(system, x, values)[:, : len(x)]
            step = -np.linalg.lstsq(slopes, speed, rcond=None)[0]
            length = float(np.linalg.norm(step)) / (1 + float(np.linalg.norm(x)))
            if not np.isfinite(length):
                break
            if _RULE.judge(length, before)[0]:
                # Where the derivatives are singular a step may be short though the field is not small.
                if np.linalg.norm(speed) > _AT_REST * np.linalg.norm(slopes) * (1 + np.linalg.norm(x)):
                    break
                return equilibrium_at(system, x + step, values)
            before = length
            x, speed = _slower(system, values, x, speed, step)
    except (FlowFailure, np.linalg.LinAlgError) as failure:
        raise PeriodicFailure(f"no equilibrium is found from there: {failure}") from None
    raise PeriodicFailure("Newton's method leads to no equilibrium; give another start")


def _slower(system: System, values: Vector, x: Vector, speed: Vector, step: Vector) -> tuple[Vector, Vector]:
    """Where a step leads, or a half of it, and so on, if the field is smaller there, and the field there."""
    share = 1.0
    for _ in range(_HALVINGS):
        try:
            now = velocity_at(system, x + share * step, values)
            if np.linalg.norm(now) <= (1 - _FALLS_BY * share) * np.linalg.norm(speed):
                return x + share * step, now
        except FlowFailure:
            pass
        share /= 2
    raise FlowFailure("Newton's method does not come closer to one")


def equilibria_from_many_starts(
    problem: PeriodicProblem, progress: Callable[[float], None] = lambda _done: None
) -> Iterator[Equilibrium]:
    """The equilibria that Newton's method finds from many starts, one after another; there may be others."""
    known: list[Equilibrium] = []
    size, random = len(problem.system.given_state), np.random.default_rng(_SEED)
    signs = random.choice([-1.0, 1.0], (_STARTS, size))
    starts = [np.zeros(size), np.ones(size), *signs * 10 ** random.uniform(*_SIZES, (_STARTS, size))]
    for number, start in enumerate(starts, start=1):
        progress(number / len(starts))
        try:
            found = equilibrium_near(problem, start)
        except PeriodicFailure:
            continue
        if not any(is_same_equilibrium(found, other) for other in known):
            known.append(found)
            yield found


def is_same_equilibrium(left: Equilibrium, right: Equilibrium) -> bool:
    """Whether two agree up to rounding."""
    return bool(np.max(np.abs(left.point - right.point)) < _SAME * (1 + np.max(np.abs(right.point))))
