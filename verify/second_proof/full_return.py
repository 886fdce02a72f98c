"""The whole period of a symmetric orbit from its point: multipliers, rotation and twist. README, section 15."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from flint import acb, acb_mat, arb

from .conditions import Hypothesis, Vector
from .crossing import TIME, moving
from .flow import take_step
from .halves import MOST_STEPS, HalfOrbits, begun
from .jets import CannotFollow, Jet, precision
from .legs import form
from .newton import checked
from .periodic_bifurcation import best_border
from .periodic_torus import Complex, product, solve
from .proof import check_integral
from .statement import Statement

RESONANCES = 1, 2, 3, 4


class FullReturn:
    """The flow over the period near the point, at a fixed value of a parameter. README, section 15.1.

    Attributes:
        live: indices of the coordinates that move; `tangent`: those of them that are not 0 on the section.
        rows: jets of E: coordinates after the period, or for one of them the first integral at the beginning.
    """

    def __init__(self, orbit: HalfOrbits, zero: Vector, degree: int) -> None:
        system = orbit.claim.system
        self.claim = orbit.claim
        values = dict(zip(orbit.places, zero, strict=False))
        self.live = range(len(system.field.outputs))
        self.tangent = [i for i in self.live if i != system.section]
        start = begun(system, values, self.tangent, degree)
        with precision(orbit.bits):
            self.end, steps = flowed(system, start, 2 * zero[orbit.time], orbit.bits)
        orbit.steps += steps
        check_integral(system.conserved(start), system.conserved([Jet(_still(jet), degree) for jet in self.end]))
        if not all(self.end[i][()].overlaps(start[i][()]) for i in self.live):
            raise CannotFollow("the orbit is not back after its period: an error")
        self.rows, self.replaced, self.checks = [self.end[i] for i in self.live], -1, list[Hypothesis]()
        integral = system.conserved(start)
        # A parameter that is followed as a coordinate is the first integral if there is no other one.
        self.has_level = system.level_set is not None or len(system.state) == len(self.live)
        if self.has_level:
            self.replaced = max(self.tangent, key=lambda i: float(abs(integral[i,].mid())))
            slope = integral[self.replaced,]
            fixed = {system.state[i]: integral[i,] for i in orbit.places if i in self.tangent}
            away = not slope.contains(0) and any(not c.contains(0) for c in fixed.values())
            self.checks.append(Hypothesis("level", away, fixed))
            self.rows[self.replaced] = integral

    def monodromy(self) -> list[Vector]:
        """The derivative of the return to the section, in its coordinates."""
        section = self.end[self.claim.system.section]
        speed = section[TIME,]
        return [
            [self.end[i][j,] - self.end[i][TIME,] * section[j,] / speed for j in self.tangent] for i in self.tangent
        ]

    def stability(self) -> tuple[acb, ...]:
        """The zeros of the polynomial of (lambda + 1/lambda)/2. README, section 15.2."""
        matrix = self.monodromy()
        n = len(self.tangent) // 2
        trace = sum((matrix[i][i] for i in range(len(matrix))), arb(0)) - int(self.has_level)
        if n == 1:
            return (acb(trace / 2),)
        minors = [
            matrix[i][i] * matrix[j][j] - matrix[i][j] * matrix[j][i] for i, j in combinations(range(len(matrix)), 2)
        ]
        second = sum(minors, arb(0)) - int(self.has_level) * trace
        middle = trace / 4
        square = middle * middle - (second - 2) / 4
        if square.contains(0):
            raise CannotFollow("two stability parameters are not told apart")
        root = acb(square.sqrt()) if square > 0 else acb(0, (-square).sqrt())
        return acb(middle + root), acb(middle - root)

    def lines(self, at: acb) -> list[Complex]:
        """D E - J with a multiplier."""
        lines = [[acb(row[v,]) for v in (*self.tangent, TIME)] for row in self.rows]
        for column, i in enumerate(self.tangent):
            if i != self.replaced:
                lines[i][column] -= at
        return lines

    def whole(self, vector: Sequence[Any]) -> list[Any]:
        """A vector with a component for each variable of jets, the last that of time."""
        known = dict(zip(self.tangent, vector[:-1], strict=True))
        return [*(known.get(i, acb(0)) for i in range(len(self.end))), vector[-1]]

    def twisted(self) -> tuple[list[Hypothesis], arb, dict[str, arb], arb]:
        """The conditions of stability, the rotation number, twists, and what is 0 by reversibility."""
        system, (parameter,) = self.claim.system, self.stability()
        s = parameter.real
        elliptic = Hypothesis("elliptic", 1 - s * s > 0, {"s": s})
        checked([elliptic])
        at = acb(s, (1 - s * s).sqrt())
        powers = {f"power {k}": abs(at**k - 1) for k in RESONANCES}
        away = Hypothesis("non-resonance", all(z > 0 for z in powers.values()), powers)
        # At a resonance of order 1 or 3 there is no c_1.
        checked([away])
        c_1, vector = self.coefficient(at)
        bend, (momentum,) = at.conjugate() * c_1, system.kernel
        areas = {
            i: abs(4 * (vector[i] * vector[momentum].conjugate()).imag) for i in self.claim.places if i in system.fixed
        }
        twists = {system.state[i]: bend.imag / area for i, area in areas.items() if area > 0}
        signs = {1 if tau > 0 else -1 if tau < 0 else 0 for tau in twists.values()}
        wanted = {self.claim.twist} if self.claim.twist else {1, -1}
        is_twist = len(signs) == 1 and signs <= wanted and bend.real.contains(0)
        twist = Hypothesis("twist", is_twist, twists | {"Re(conj(lambda) c_1)": bend.real})
        return [elliptic, away, twist], s.acos() / (2 * arb.pi()), twists, bend.real

    def direction(self, at: acb) -> tuple[Complex, Complex]:
        """W and l with l . J' W = 1, for a multiplier. README, section 15.3."""
        lines, size = self.lines(at), len(self.tangent) + 1
        units = [[acb(int(i == j)) for j in range(size)] for i in range(len(self.tangent))]
        bordered = max((best_border(lines, below, acb_mat) for below in units), key=_size)
        inverse = bordered.inv().tolist()
        column, left = [row[size] for row in inverse][:-1], inverse[size][:-1]
        vector = self.whole(column)
        rest = [i for i in self.tangent if i != self.replaced]
        pairing = product([left[i] for i in rest], [vector[i] for i in rest])
        return vector, [entry / pairing for entry in left]

    def second(self, at: acb, *vectors: Complex) -> Complex:
        """H with (D E - J) H = -E_2 at two vectors, J that of a product of multipliers."""
        return self.whole(solve(self.lines(at), [-z for z in form(self.rows, *vectors)]))

    def coefficient(self, at: acb) -> tuple[acb, Complex]:
        """c_1 and the vector W to which it belongs. README, section 15.3."""
        vector, left = self.direction(at)
        bar = [z.conjugate() for z in vector]
        mixed, square = self.second(acb(1), vector, bar), self.second(at * at, vector, vector)
        terms = form(self.rows, vector, vector, bar), form(self.rows, vector, mixed), form(self.rows, bar, square)
        return product(left, [a + 2 * b + c for a, b, c in zip(*terms, strict=True)]) / 2, vector


def _size(matrix: acb_mat) -> float:
    return float(abs(matrix.det().mid()))


def _still(jet: Jet) -> dict[Any, Any]:
    return {a: c for a, c in jet.items() if TIME not in a}


def flowed(system: Statement, start: list[Jet], duration: arb, bits: int) -> tuple[list[Jet], int]:
    """Jets after a time, with `TIME` as a variable, and the steps."""
    state, now, size = start, arb(0), arb(1) / 2
    for steps in range(1, MOST_STEPS + 1):
        step, size = take_step(system, state, size, bits)
        rest = duration - now
        if not rest > 0:
            raise CannotFollow("the ball of the period is longer than a step")
        if rest <= step.duration:
            return moving(system, step.at(rest)), steps
        # The last step begins before all times of the ball.
        end = step.duration / 2 if rest.overlaps(step.duration) else step.duration
        state, now = step.at(end), now + end
    raise CannotFollow(f"the orbit takes more than {MOST_STEPS} steps")
