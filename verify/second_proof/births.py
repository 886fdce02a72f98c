"""Births of orbits that R does not map to themselves, once more. README, section 14."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from .conditions import Hypothesis, Vector
from .halves import Half, HalfOrbits, SymmetricStatement, guess, read_symmetric
from .jets import CannotFollow, Jet, ball, joined
from .legs import Start, form
from .newton import checked, solved
from .periodic import attempted
from .periodic_bifurcation import best_border
from .proof import NotProved, dot

ORDER = 4
"""Bits per bit that a half orbit loses."""


@dataclass(frozen=True)
class ProvedBirth:
    """The birth is proved.

    Attributes:
        kind: as claimed.
        point, other_point: enclosures of the two points of the symmetric orbit on Fix(R), by name,
            without a coordinate that follows from a fixed level.
        coordinates: of the point in the coordinates of the claim.
        parameter: what varies: the family parameter or the first integral; `side`: of it the new orbits are on.
        period: the least period of the symmetric orbit.
        direction: w, of the new orbits from Fix(R), by name, for the frame of the claim.
        opening: kappa for this w: the new orbits through q = y w + .. have the parameter + kappa y^2 + ..
        hypotheses, width, bits, steps: as of `ProvedPeriodic`.
    """

    kind: str
    point: dict[str, arb]
    other_point: dict[str, arb]
    coordinates: tuple[arb, ...]
    parameter: arb
    side: str
    period: arb
    direction: dict[str, arb]
    opening: arb
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int
    steps: int


class _Proof(HalfOrbits):
    """One attempt: the unknowns are those of the orbit, and w in the coordinates that R negates, without the section.

    Attributes:
        kept: indices in the state of the coordinates at the end that are compared; others follow from integrals.
    """

    degree = 2, 3

    def __init__(self, claim: SymmetricStatement, bits: int, start: Start) -> None:
        super().__init__(claim, bits, start)
        self.moved = (*self.places, *claim.system.kernel)
        self.kept: tuple[int, ...] = ()

    def more(self, half: Half, around: Sequence[arb], degree: int) -> list[Jet]:
        """The coordinates of Fix(R) at the end but for those that follow from the integrals."""
        if not self.kept:
            self.kept = tuple(i for i in self.places if i not in self.following(half))
        return [half.end[i] for i in self.kept]

    def following(self, half: Half) -> list[int]:
        """The parameter, and the coordinate by which the first integral changes most at the end."""
        system = self.claim.system
        parameter = [i for i in self.places if i >= len(system.field.outputs)]
        if parameter and system.level_set is None:
            return parameter
        slopes = self.integral_slopes(half)
        others = [i for i in self.places if i not in parameter]
        return [*parameter, max(others, key=lambda i: float(abs(slopes[i,].mid())))]

    def integral_slopes(self, half: Half) -> Jet:
        """The derivatives of the first integral at the end by the coordinates there."""
        system = self.claim.system
        state = [Jet({(): jet[()], (i,): arb(1)}, 1) for i, jet in enumerate(half.end)]
        return system.conserved(state)

    def prepare(self, rows: Sequence[Jet]) -> None:
        """A first w, which is w_0: the vector that B nearly takes to 0."""
        lines = self.block(rows)
        n = len(lines)
        choices = [[arb(int(i == j)) for i in range(n)] for j in range(n)]
        bordered = max((best_border(lines, below, arb_mat) for below in choices), key=_size)
        *found, _ = bordered.solve(arb_mat([*[[0]] * n, [1]])).tolist()
        self.weights = [w.mid() for (w,) in found]
        self.length = dot(self.weights, self.weights)
        self.centre = [*self.centre, *self.weights]

    def parts(self, rows: Sequence[Jet]) -> tuple[list[Jet], list[Jet]]:
        """The equations of symmetric orbits, and those whose derivative is B."""
        n = len(self.kept)
        return list(rows[:-n]), list(rows[-n:])

    def block(self, rows: Sequence[Jet]) -> list[Vector]:
        """B: the derivatives, by the coordinates that R negates, of what R fixes."""
        return [[row[k,] for k in self.claim.system.kernel] for row in self.parts(rows)[1]]

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivative of (14.1) by the coordinates of Fix(R), T and w."""
        even, odd = self.parts(rows)
        kernel, w, block = self.claim.system.kernel, around[self.time + 1 :], self.block(rows)
        upper = [[*line, *[arb(0)] * len(kernel)] for line in self.slopes(even)]
        bent = [[dot([row[joined((v,), (k,))] for k in kernel], w) for v in self.columns] for row in odd]
        lower = [[*b, *line] for b, line in zip(bent, block, strict=True)]
        return [*upper, *lower, [*[arb(0)] * len(self.columns), *self.weights]]

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides of (14.1) at the centre."""
        w = self.centre[self.time + 1 :]
        values = [row[()] for row in self.parts(rows)[0]]
        return [*values, *(dot(line, w) for line in self.block(rows)), dot(self.weights, w) - self.length]

    def conclusion(self) -> ProvedBirth:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        claim, system = self.claim, self.claim.system
        newton, zero, half, rows = self.enclosed()
        point, period, w = zero[: self.time], 2 * zero[self.time], zero[self.time + 1 :]
        dropped = [i for i in self.places if i not in self.kept and i < len(system.field.outputs)]
        slopes = self.integral_slopes(half)
        steep = {system.state[i]: slopes[i,] for i in dropped}
        follows = all(not slope.contains(0) for slope in steep.values())
        checks = [Hypothesis("integral", follows, steep)] if steep else []
        curve, side, kappa = self.coefficients(half, rows, w)
        first = dot([ball(c) for c in system.kernel_frame[0]], w)
        frames = Hypothesis("frame", not first.contains(0), {"first coordinate": first})
        hypotheses = checked([newton, *self.check_point(zero), *checks, curve, side, frames])
        named = [(system.state[i], i) for i in system.fixed]
        values = dict(zip(self.places, point, strict=True))
        level = system.level([Jet({(): jet[()]}, 0) for jet in self.jets(point, 0)])[()]
        return ProvedBirth(
            system.kind, {name: values[i] for name, i in named}, {name: half.end[i][()] for name, i in named},
            tuple(claim.coordinates(point, level)), level, "above" if kappa > 0 else "below", period,
            {system.state[i]: x / first for i, x in zip(system.kernel, w, strict=True)}, kappa / first**2,
            hypotheses, self.width, self.bits, self.steps,
        )  # fmt: skip

    def coefficients(self, half: Half, rows: Sequence[Jet], w: Vector) -> tuple[Hypothesis, Hypothesis, arb]:
        """Whether M is regular, whether gamma and beta are not 0, and kappa. README, Lemma 15."""
        even, odd = self.parts(rows)
        along = [*even, self.claim.system.level(half.start)]
        matrix, size = self.slopes(along), len(half.start)
        curve = Hypothesis("curve", not arb_mat(matrix).det().contains(0), {"determinant": arb_mat(matrix).det()})

        def whole(indices: Sequence[int], values: Sequence[arb]) -> Vector:
            # The last component is that of `TIME`.
            vector = [arb(0)] * (size + 1)
            for i, value in zip(indices, values, strict=True):
                vector[i] = value
            return vector

        vector = whole(self.claim.system.kernel, w)
        tangent = whole(self.columns, solved(matrix, [arb(0)] * len(even) + [arb(1)]))
        bent = whole(self.columns, solved(matrix, [-value / 2 for value in form(along, vector, vector)]))
        left = self.left_kernel(rows)
        gamma = dot(left, form(odd, vector, tangent))
        cubic = [value / 6 for value in form(odd, vector, vector, vector)]
        beta = dot(left, form(odd, vector, bent)) + dot(left, cubic)
        kappa = -beta / gamma
        away = not any(value.contains(0) for value in (gamma, beta, kappa))
        return curve, Hypothesis("side", away, {"gamma": gamma, "beta": beta, "kappa": kappa}), kappa

    def left_kernel(self, rows: Sequence[Jet]) -> Vector:
        """l with l B = 0 at the birth, one component 1."""
        lines = self.block(rows)
        last: Vector = best_border(lines, self.weights, arb_mat).inv().tolist()[len(lines)]
        return last[:-1]


def _size(matrix: arb_mat) -> float:
    return float(abs(matrix.det().mid()))


def prove_birth(certificate: Mapping[str, Any]) -> ProvedBirth | NotProved:
    """Prove the birth that a certificate claims, from its statement and the centre of its box alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    try:
        claim = read_symmetric(certificate)
    except CannotFollow as error:
        return NotProved(str(error))
    return attempted(
        claim,
        lambda bits: guess(claim, bits),
        ORDER,
        lambda bits, start: _Proof(claim, bits, start).conclusion(),
    )
