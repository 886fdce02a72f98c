"""The Poincare map near one point and its iterates, refinement, proof. README, sections 5 and 6."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from .conditions import Conclusion, Hypothesis, Table, Vector, conclude, conclude_fold
from .crossing import follow
from .jets import CannotFollow, Jet, ball, combine, implicit, precision, substitute
from .statement import Statement, read_statement

PRECISIONS, NEWTON_STEPS = (96, 72, 120, 144, 168, 200, 400), 8
"""Bits of the integration on D, tried one after the other: D is 2^-(bits - ROOM) in radius."""
ROOM, SPARE, CERTAIN = 24, 56, 32
"""Bits: above D; of the integration from the centre beyond twice those on D; known of derivatives on D at least."""


class TooWide(CannotFollow):
    """Derivatives on D are enclosed too widely: it takes so many more `bits`, or more."""

    def __init__(self, message: str, bits: int) -> None:
        super().__init__(message)
        self.bits = bits


@dataclass(frozen=True)
class Proved:
    """The bifurcation is proved.

    Attributes:
        kind, k: as claimed; `side`: values of the parameter at which the new orbits exist, above, below or both.
        point: enclosures of the coordinates of Fix(R), by name, the family parameter among them if there is one.
        parameter: enclosure of the family parameter or of the first integral.
        hypotheses: every inequality with its enclosures.
        normal_form: coefficients in the coordinates of the claim, by the names that certificates use. README, 6.7.
        width, bits, steps: R_1 = 2^-width, the precision on D, the time steps of all integrations.
    """

    kind: str
    k: int
    side: str
    point: dict[str, arb]
    parameter: arb
    hypotheses: tuple[Hypothesis, ...]
    normal_form: dict[str, arb]
    width: int
    bits: int
    steps: int


@dataclass(frozen=True)
class NotProved:
    """Nothing is proved; this does not say that the claim is false."""

    reason: str


@dataclass(frozen=True)
class PoincareMap:
    """P on the box of all points of the section within `size` of `middle`, and near P(centre). README, section 5.

    Attributes:
        signs: R on the coordinates of the state; `section`: the one that is zero on the section.
        centre: a point of Fix(R) in the box.
        rows: tables of the coordinates of P: at the centre up to order 1, and on the box.
    """

    signs: tuple[int, ...]
    section: int
    middle: Vector
    size: arb
    centre: Vector
    rows: list[Table]

    def _around(self, point: Vector) -> list[Jet]:
        if not all(abs(x - m) < self.size for x, m in zip(point, self.middle, strict=True)):
            raise CannotFollow("an iterate leaves the box on which P is known")
        reach = [x - c for x, c in zip(point, self.centre, strict=True)]
        return [row.jet(reach) for row in self.rows]

    def forward(self, state: Sequence[Jet]) -> list[Jet]:
        """Jets of P(z), from jets of points z in the box."""
        inner = {j: jet.varying() for j, jet in enumerate(state)}
        return substitute(self._around([jet[()] for jet in state]), inner)

    def backward(self, state: Sequence[Jet]) -> list[Jet]:
        """Jets of P(z) = R w, from jets of points z = R P(w), w in the box. README, section 5.2."""
        targets = [jet * sign for sign, jet in zip(self.signs, state, strict=True)]
        live, point = [j for j in range(len(state)) if j != self.section], list(self.centre)
        slopes = arb_mat([[self.rows[i].around[j,] for j in live] for i in live])
        move = slopes.inv() * arb_mat([[self.rows[i].centre[()] - targets[i][()]] for i in live])
        for i, (step,) in zip(live, move.tolist(), strict=True):
            point[i] = point[i] - step
        # Variable j of P is ~j here, apart from those of the state.
        rows = [Jet({tuple(~j for j in reversed(a)): c for a, c in row.items()}, 3) for row in self._around(point)]
        found = implicit([rows[i] - targets[i] for i in live], [~j for j in live])
        return [(Jet({(): x}, 3) + found.get(~j, Jet({}, 3))) * self.signs[j] for j, x in enumerate(point)]


def check_integral(before: Jet, after: Jet) -> None:
    """Jets of the first integral at two points of one orbit have points in common. README, section 4.4."""
    if not all(before[a].overlaps(after[a]) for a in {**before, **after}):
        raise CannotFollow("the first integral is not kept: no first integral, or an error")


def second_proof(certificate: Mapping[str, Any]) -> Proved | NotProved:
    """Prove the bifurcation that a certificate claims, from its statement, centre and frames alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    reasons, least = [], 0
    try:
        statement = read_statement(certificate)
        statement.check()
    except CannotFollow as error:
        return NotProved(str(error))
    for bits in PRECISIONS:
        if bits < least:
            continue
        try:
            with precision(2 * bits + SPARE):
                return _Proof(statement, bits).conclusion()
        except (CannotFollow, ArithmeticError, ValueError, TypeError, MemoryError) as error:
            reasons.append(f"{type(error).__name__}: {error} ({bits} bits)")
            least = bits + error.bits if isinstance(error, TooWide) else least
    return NotProved("; ".join(reasons))


def dot(left: Sequence[arb], right: Sequence[arb]) -> arb:
    """The sum of products."""
    return sum((a * b for a, b in zip(left, right, strict=True)), arb(0))


class _Proof:
    """One attempt, with so many bits on D: frames, centre, and what has been integrated."""

    def __init__(self, statement: Statement, bits: int) -> None:
        self.statement, self.bits, self.steps, self.size = statement, bits, 0, len(statement.fixed)
        self.columns = [[ball(c) for c in column] for column in zip(*statement.frame, strict=True)]
        self.rows = [[ball(c) for c in row] for row in statement.kernel_frame]
        self.centre, self.tilt = [ball(c).mid() for c in statement.centre], arb(0)
        self.breaking = statement.kind == "symmetry_breaking"

    def state_of(self, values: Sequence[Any], other: Any) -> list[Any]:
        """Values of the coordinates of Fix(R), and others that are the same, as those of the state."""
        known = dict(zip(self.statement.fixed, values, strict=True))
        return [known.get(i, other) for i in range(len(self.statement.state))]

    def point_of(self, values: Sequence[arb]) -> Vector:
        """An exact point of Fix(R), near the fixed level if there is one."""
        return [jet[()].mid() for jet in self.lifted([Jet({(): x}, 1) for x in self.state_of(values, arb(0))])]

    def lifted(self, state: Sequence[Jet]) -> list[Jet]:
        """Points of Fix(R) with the w of the fixed level, if there is one."""
        level_set = self.statement.level_set
        return list(state) if level_set is None else level_set.lifted(self.statement.conserved, state, self.bits)

    def across(self, coordinates: Sequence[arb]) -> Vector:
        """A p in the coordinates of Fix(R)."""
        return [dot(line, coordinates) for line in zip(*self.columns, strict=True)]

    def integrate(self, spread: arb, degree: int, bits: int) -> list[Jet]:
        """Jets of P in the coordinates of the section, on a box about the centre."""
        start = [Jet({(): x + spread, (j,): arb(1)}, degree) for j, x in enumerate(self.point_of(self.centre))]
        start[self.statement.section] = Jet({}, degree)
        with precision(bits):
            found, _, count = follow(self.statement, start, bits)
        self.steps += count
        return found

    def iterates(self, poincare: PoincareMap, reach: Sequence[arb]) -> tuple[list[list[Jet]], Jet]:
        """Jets in p of q(P), .., q(P^k) at all points centre + A p with p in `reach`, and of the first integral."""
        lines = self.state_of(list(zip(*self.columns, strict=True)), [arb(0)] * self.size)
        start = [
            Jet({(): x + dot(line, reach)} | {(j,): a for j, a in enumerate(line)}, 3)
            for x, line in zip(poincare.centre, lines, strict=True)
        ]
        state = self.lifted(start)
        level, kept, found = self.statement.level(state), self.statement.conserved(state), []
        for i in range(self.statement.k):
            state = poincare.backward(state) if i % 2 else poincare.forward(state)
            check_integral(kept, self.statement.conserved(state))
            found.append([combine([state[j] for j in self.statement.kernel], row, 3) for row in self.rows])
        return found, level

    def evaluated(self, poincare: PoincareMap, radii: Vector) -> Conclusion:
        """The conditions on the box with these radii; without radii they are formulas for the bifurcation point."""
        at, level = self.iterates(poincare, [arb(0)] * self.size)
        over, around = self.iterates(poincare, [arb(0, r) for r in radii]) if any(radii) else (at, level)
        tables = [[Table(*pair, 2) for pair in zip(*rows, strict=True)] for rows in zip(at, over, strict=True)]
        if self.statement.kind == "fold":
            return conclude_fold(tables[0], Table(level, around, 2), radii)
        return conclude(self.statement.k, self.breaking, tables, Table(level, around, 2), radii)

    def on_box(self, wide: arb) -> list[Jet]:
        """Jets of P on D. Raises `TooWide` if too little is known about some order of derivatives."""
        box, certain = self.integrate(arb(0, wide), 3, self.bits), min(CERTAIN, self.bits - 64)
        for order in (1, 2, 3):
            known = [c for jet in box for a, c in jet.items() if len(a) == order]
            lost = max(arb(c.rad()) for c in known) / max(c.abs_upper() for c in known)
            if not lost < arb(2) ** -certain:
                missing = int(min(float(lost.log() / arb(2).log()), 999.0)) + certain + 1
                raise TooWide(f"the derivatives of P on D are too wide by {missing} bits", missing)
        return box

    def refined(self) -> tuple[PoincareMap, int]:
        """P about the bifurcation point, to which the centre is moved, and the width of the box. README, 6.5."""
        wide, small = arb(2) ** (ROOM - self.bits), arb(2) ** -(self.bits + 8)
        middle: Vector = []
        for _ in range(NEWTON_STEPS):
            if not middle or any(abs(c - m) > wide / 4 for c, m in zip(self.centre, middle, strict=True)):
                middle, box = self.centre, self.on_box(wide)
            thin = self.integrate(arb(0), 1, 2 * self.bits + SPARE)
            tables = [Table(at, around, 1) for at, around in zip(thin, box, strict=True)]
            near, point = (self.point_of(values) for values in (middle, self.centre))
            poincare = PoincareMap(self.statement.reversing, self.statement.section, near, wide, point, tables)
            found = self.evaluated(poincare, [arb(0)] * self.size)
            if self.statement.k > 1:
                tilt = found.slope.mid()
                self.tilt += tilt
                self.columns[1] = [b + tilt * a for b, a in zip(self.columns[1], self.columns[0], strict=True)]
            moves = [move.mid() for move in self.across(found.point)]
            if max(abs(move) for move in moves) < small:
                off = max(p.abs_upper() for p in found.point)
                reach = max(off, arb(2) ** (-2 * self.bits))
                return poincare, int(-float(reach.log() / arb(2).log())) - 8
            if not max(abs(move) for move in moves) < arb(2) ** -10:
                break
            self.centre = [(c + move).mid() for c, move in zip(self.centre, moves, strict=True)]
        raise CannotFollow("Newton's method does not converge from the centre of the certificate")

    def check_adapted(self) -> None:
        """For symmetry breaking: S fixes the centre, negates p_1 and q_1 and keeps the other p and q, exactly."""
        statement, signs = self.statement, self.statement.symmetry or ()
        expected = [(statement.fixed, v, -1 if j == 1 else 1) for j, v in enumerate([*self.columns, self.centre])]
        expected += [(statement.kernel, v, 1 if j else -1) for j, v in enumerate(self.rows)]
        for indices, vector, sign in expected:
            if any(not c.is_zero() and signs[i] != sign for c, i in zip(vector, indices, strict=True)):
                raise CannotFollow("the frames or the centre are not adapted to the symmetry S")

    def conclusion(self) -> Proved:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        statement = self.statement
        poincare, width = self.refined()
        if self.breaking:
            self.check_adapted()
        radii = [arb(2) ** -(width + (0 if j == 1 else 4)) for j in range(self.size)]
        regular = {"p": arb_mat(self.columns).det(), "q": arb_mat(self.rows).det()}
        found = self.evaluated(poincare, radii)
        hypotheses = (
            Hypothesis("frames", not any(d.contains(0) for d in regular.values()), regular),
            *found.hypotheses,
        )
        for failed in (h for h in hypotheses if not h.holds):
            shown = ", ".join(f"{name} = {value.str(6)}" for name, value in failed.enclosures.items())
            raise TooWide(f"{failed.name} is not shown: {shown}", 1)
        values = [c + moved for c, moved in zip(self.centre, self.across(found.point), strict=True)]
        point = {statement.state[i]: x for i, x in zip(statement.fixed, values, strict=True)}
        level = statement.level([Jet({(): x}, 0) for x in self.state_of(values, arb(0))])[()]
        form = dict(found.normal_form)
        if "h_fp'" in form:
            form["h_fp'"] = form["h_fp'"] / (1 + self.tilt * found.drift)
        where = statement.kind, statement.k, found.side, point, level
        return Proved(*where, hypotheses, form, width, self.bits, self.steps)
