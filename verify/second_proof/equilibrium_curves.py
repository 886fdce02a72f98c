"""Curves of equilibria once more: one box after another along tangents, from end to end. README, section 18."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations
from typing import Any

from flint import arb, arb_mat

from .conditions import Hypothesis, Vector
from .equilibrium_curve_statement import CurveStatement, Piece, read_curve
from .jets import CannotFollow, Jet, ball, precision
from .multipliers import multipliers
from .newton import Newton, checked, solved
from .periodic import ERRORS
from .proof import NotProved, dot

BITS = 192
MOST_BOXES, DEEPEST, BISECTIONS = 2_000, 16, 40
SHORTEST = 2.0**-40
"""A length of a box, in the units of the coordinates."""


@dataclass(frozen=True)
class Extremum:
    """The one extremum of what varies on a part of the curve, and its value there; the second derivative is not 0."""

    is_maximum: bool
    value: arb


@dataclass(frozen=True)
class Part:
    """A part of the curve: all values of what varies, and how many eigenvalues are left and right, if that is shown."""

    values: arb
    sides: tuple[int, int] | None


@dataclass(frozen=True)
class ProvedCurve:
    """The curve is proved.

    Attributes:
        start, end: enclosures of the coordinates, by name; of a loop the same point.
        extrema: of what varies along the curve, all of them.
        parts: in order.
        boxes: how many there are; `hypotheses`, `bits`: as of `ProvedPeriodic`.
    """

    start: dict[str, arb]
    end: dict[str, arb]
    extrema: tuple[Extremum, ...]
    parts: tuple[Part, ...]
    boxes: int
    hypotheses: tuple[Hypothesis, ...]
    bits: int


class _OnPlane(Newton):
    """The zero of f on a plane `normal` . z = `height`."""

    lost, bits = 0, BITS

    def __init__(self, statement: CurveStatement, normal: Vector, height: arb, centre: Vector) -> None:
        self.statement, self.normal, self.height = statement, normal, height
        self.centre, self.reach = [x.mid() for x in centre], arb(0)

    def evaluated(self, around: Sequence[arb], degree: int) -> tuple[None, list[Jet]]:
        """Jets of f in all coordinates."""
        return None, self.statement.rates([Jet({(): x, (j,): arb(1)}, degree) for j, x in enumerate(around)])

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivatives of all equations."""
        return [*([row[j,] for j in range(len(around))] for row in rows), self.normal]

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides at the centre."""
        return [*(row[()] for row in rows), dot(self.normal, self.centre) - self.height]

    def names(self) -> list[str]:
        """The names of all unknowns."""
        return list(self.statement.names)

    def zero(self) -> Vector:
        """The zero, enclosed. Raises `CannotFollow`."""
        # Nothing rests on where Newton's method begins.
        for _ in range(4):
            _, rows = self.evaluated(self.centre, 1)
            moves = solved(self.system(rows, self.centre), self.zeros(rows))
            self.centre = [(c - move).mid() for c, move in zip(self.centre, moves, strict=True)]
        newton, zero, _, _ = self.enclosed()
        checked([newton])
        return zero


@dataclass(frozen=True)
class Box:
    """The points c + tangent tau + w, w in the coordinates `kept`: for every tau exactly one zero with |w_k| < reach_k.

    Attributes:
        low, high: of tau; `across`: enclosures of the w of the zeros.
        slopes: enclosures of the derivative of the zero by tau, at all tau.
        second: of the second derivative of what varies by tau.
    """

    centre: Vector
    tangent: Vector
    low: arb
    high: arb
    kept: tuple[int, ...]
    reach: Vector
    across: Vector
    slopes: Vector
    second: arb

    @property
    def free(self) -> int:
        """The coordinate that is not among `kept`."""
        return next(i for i in range(len(self.centre)) if i not in self.kept)

    def place(self, point: Sequence[arb]) -> arb | None:
        """Tau of a zero that is in the box, and so on its curve; `None` if that is not certain."""
        away = [x - c for x, c in zip(point, self.centre, strict=True)]
        tau = away[self.free] / self.tangent[self.free]
        inside = self.low < tau < self.high and all(
            abs(away[k] - tau * self.tangent[k]) < r for k, r in zip(self.kept, self.reach, strict=True)
        )
        return tau if inside else None

    def placed(self, zero: Sequence[arb]) -> arb:
        """Tau of a zero that is in the box. Raises `CannotFollow` if that is not certain."""
        if (tau := self.place(zero)) is None:
            raise CannotFollow("a zero is not shown to be in its box")
        return tau


class _Curve:
    """One attempt: the boxes from a point on, and what is read off them."""

    def __init__(self, statement: CurveStatement) -> None:
        self.statement, self.size = statement, len(statement.names)

    def on_piece(self, piece: Piece, s: Fraction) -> tuple[Vector, Vector]:
        """The zero of a piece over s, shown to be in its tube, and the plane of that s."""
        rows = [list(row) for row in arb_mat([[ball(x) for x in row] for row in piece.frame]).inv().tolist()]
        point, inside = [ball(x) for x in piece.point(s)], [ball(x) for x in piece.inside(s)]
        centre = [ball(x) for x in piece.centre]
        zero = _OnPlane(self.statement, rows[0], inside[0] + dot(rows[0], centre), point).zero()
        away = [x - c for x, c in zip(zero, centre, strict=True)]
        for row, middle, width in zip(rows[1:], inside[1:], piece.tube, strict=True):
            if not abs(dot(row, away) - middle) < ball(width):
                raise CannotFollow("a point of the curve is not shown to be in the tube of its piece")
        return zero, rows[0]

    def tangent(self, point: Sequence[arb], ahead: Sequence[arb]) -> Vector:
        """A vector near the tangent, of about length 1, on the side of `ahead`."""
        middle = [x.mid() for x in point]
        rows = self.jets(middle, _units(self.size), 1)
        along = solved(
            [*([row[j,] for j in range(self.size)] for row in rows), ahead], [arb(0)] * (self.size - 1) + [arb(1)]
        )
        length = sum((x * x for x in along), arb(0)).sqrt()
        return [(x / length).mid() for x in along]

    def jets(self, point: Sequence[arb], directions: Sequence[Sequence[arb]], degree: int) -> list[Jet]:
        """Jets of f at the points of a set, in variables along these vectors."""
        state = [
            Jet({(): x} | {(j,): vector[i] for j, vector in enumerate(directions)}, degree) for i, x in enumerate(point)
        ]
        return self.statement.rates(state)

    def box(self, point: Sequence[arb], tangent: Vector, length: arb) -> Box:
        """The box about the tangent at a point, of this length. README, 18.2."""
        n, centre = self.size, [x.mid() for x in point]
        free = max(range(n), key=lambda i: float(abs(tangent[i])))
        kept = tuple(i for i in range(n) if i != free)
        low, high = -length / 16, length
        span = arb(((low + high) / 2).mid(), ((high - low) / 2).upper())
        units = [_units(n)[k] for k in kept]
        at, line = self.jets(centre, [], 0), self.jets(_along(centre, tangent, span), [tangent], 1)
        values = [f[()] + g[0,] * span for f, g in zip(at, line, strict=True)]
        guess = solved(_slopes(self.jets(centre, units, 1), n - 1), values)
        reach = [(2 * abs(x).upper() + arb(2) ** (-BITS // 2)).mid() for x in guess]
        wide = _along(centre, tangent, span)
        for k, r in zip(kept, reach, strict=True):
            wide[k] += arb(0, r)
        across = [-x for x in solved(_slopes(self.jets(wide, units, 1), n - 1), values)]
        if not all(abs(w) < r for w, r in zip(across, reach, strict=True)):
            raise CannotFollow("the zeros over a box are not shown to be in it")
        tube = _along(centre, tangent, span)
        for k, w in zip(kept, across, strict=True):
            tube[k] += w
        rows = self.jets(tube, [*units, tangent], 1)
        turn = solved(_slopes(rows, n - 1), [-row[n - 1,] for row in rows])
        slopes = list(tangent)
        for k, x in zip(kept, turn, strict=True):
            slopes[k] = slopes[k] + x
        bent = solved(_slopes(rows, n - 1), [-2 * f[0, 0] for f in self.jets(tube, [slopes], 2)])
        second = dict(zip(kept, bent, strict=True)).get(0, arb(0))
        box = Box(centre, tangent, low, high, kept, reach, across, slopes, second)
        if slopes[0].contains(0) and second.contains(0):
            raise CannotFollow("where what varies has extrema is not shown")
        return box

    def over(self, box: Box, tau: arb) -> Vector:
        """The zero of a box over a value of tau."""
        guess = _along(box.centre, box.tangent, tau)
        for k, w in zip(box.kept, box.across, strict=True):
            guess[k] += w.mid()
        normal = _units(self.size)[box.free]
        zero = _OnPlane(self.statement, normal, box.centre[box.free] + tau * box.tangent[box.free], guess).zero()
        box.placed(zero)
        return zero

    def follow(
        self, start: Vector, ahead: Vector, end: Vector, is_closed: bool
    ) -> Iterator[tuple[Box, Vector, Vector]]:
        """Boxes with the zeros at which the curve enters and leaves them, till it is at `end`."""
        point, before, first, length = start, None, None, arb(1) / 4
        far = 4 * max(_distance(start, piece.point(Fraction(s))) for piece in self.statement.pieces for s in (-1, 0, 1))
        for number in range(MOST_BOXES):
            while True:
                if not length > SHORTEST:
                    raise CannotFollow("boxes become too short")
                try:
                    tangent = self.tangent(point, ahead)
                    box = self.box(point, tangent, length)
                    leaves = self.over(box, box.high * 15 / 16)
                    break
                except (CannotFollow, ZeroDivisionError):
                    length = (length / 2).mid()
            if not dot(ahead if before is None else self.velocity(before, point), self.velocity(box, point)) > 0:
                raise CannotFollow("the curve is not shown to go on")
            here, last, first = box.placed(point), box.place(end), first or box
            if last is not None and (not is_closed or (number > 1 and last > 0 and self.is_round(first, box, end))):
                if not last > here:
                    raise CannotFollow("the end is not shown to lie ahead")
                yield box, point, end
                return
            yield box, point, leaves
            if _distance(start, leaves) > far:
                raise CannotFollow("the curve leaves the pieces of the claim")
            point, ahead, before, length = leaves, tangent, box, (length * 3 / 2).mid()
        raise CannotFollow(f"there are more than {MOST_BOXES} boxes")

    def part(self, box: Box, first: arb, last: arb) -> Vector:
        """Enclosures of the zeros over an interval of tau. README, 18.3."""
        middle = ((first + last) / 2).mid()
        spread = arb(0, max((last - middle).abs_upper(), (middle - first).abs_upper()))
        return [x + spread * v for x, v in zip(self.over(box, middle), box.slopes, strict=True)]

    def extremum(self, box: Box, point: Vector, leaves: Vector) -> Extremum | None:
        """The extremum of what varies between two zeros of a box, if there is one."""
        if not box.slopes[0].contains(0):
            return None
        low, high = (box.placed(zero) for zero in (point, leaves))
        before, after = self.direction(box, point), self.direction(box, leaves)
        if before == after:
            return None
        for _ in range(BISECTIONS):
            middle = ((low + high) / 2).mid()
            try:
                sign = self.direction(box, self.over(box, middle))
            except CannotFollow:
                break
            low, high = (middle, high) if sign == before else (low, middle)
        return Extremum(before > 0, self.part(box, low, high)[0])

    def velocity(self, box: Box, zero: Sequence[arb]) -> Vector:
        """The derivative of the curve by tau at a zero of a box."""
        rows = self.jets(zero, [*(_units(self.size)[k] for k in box.kept), box.tangent], 1)
        turn = solved(_slopes(rows, self.size - 1), [-row[self.size - 1,] for row in rows])
        slopes = list(box.tangent)
        for k, x in zip(box.kept, turn, strict=True):
            slopes[k] = slopes[k] + x
        return slopes

    def is_round(self, first: Box, box: Box, start: Vector) -> bool:
        """Whether two boxes have one direction at a zero of both."""
        return bool(dot(self.velocity(first, start), self.velocity(box, start)) > 0)

    def direction(self, box: Box, zero: Sequence[arb]) -> int:
        """The sign of the derivative of what varies at a zero of a box. Raises `CannotFollow` if it is not certain."""
        slope = self.velocity(box, zero)[0]
        if slope.contains(0):
            raise CannotFollow("a direction is not certain")
        return 1 if slope > 0 else -1

    def parts(self, box: Box, point: Vector, leaves: Vector) -> Iterator[Part]:
        """The parts of a box between two zeros, halved where sides are not certain."""
        pending = [(box.placed(point), box.placed(leaves), 0)]
        while pending:
            first, last, depth = pending.pop()
            points = self.part(box, first, last)
            middle = ((first + last) / 2).mid()
            sides = self.sides(points, self.over(box, middle))
            if sides is None and depth < DEEPEST:
                pending += [(middle, last, depth + 1), (first, middle, depth + 1)]
                continue
            yield Part(points[0], sides)

    def sides(self, points: Sequence[arb], inner: Sequence[arb]) -> tuple[int, int] | None:
        """How many eigenvalues are left and right at all points of a set, one of them given. README, Lemma 21."""
        units = _units(self.size)[1:]
        matrix, one = (_slopes(self.jets(place, units, 1), self.size - 1) for place in (points, inner))
        pairs = sums_of_pairs(matrix)
        still = not any(arb_mat(each).det().contains(0) for each in (matrix, pairs) if each)
        try:
            balls = multipliers(arb_mat(one if still else matrix), [])
        except (CannotFollow, *ERRORS):
            return None
        left, right = sum(z.real < 0 for z in balls), sum(z.real > 0 for z in balls)
        return (left, right) if left + right == self.size - 1 else None

    def conclusion(self) -> ProvedCurve:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        claim, names = self.statement, self.statement.names
        begin = Fraction(0) if claim.is_closed else Fraction(-1)
        start, ahead = self.on_piece(claim.pieces[0], begin)
        end = start if claim.is_closed else self.on_piece(claim.pieces[-1], Fraction(1))[0]
        extrema, parts, boxes, rising = list[Extremum](), list[Part](), 0, dict[str, arb]()
        for box, point, leaves in self.follow(start, ahead, end, claim.is_closed):
            boxes += 1
            found = self.extremum(box, point, leaves)
            extrema += [] if found is None else [found]
            for part in self.parts(box, point, leaves):
                if parts and parts[-1].sides == part.sides:
                    part = replace(part, values=parts.pop().values.union(part.values))
                parts.append(part)
            for name in claim.increasing:
                slope = box.slopes[names.index(name)]
                rising[name] = slope.union(rising[name]) if name in rising else slope
        hypotheses = [Hypothesis("boxes", boxes > 0, dict(zip(names, start, strict=True)))]
        hypotheses += [Hypothesis(f"increasing-{name}", slope > 0, {name: slope}) for name, slope in rising.items()]
        if claim.covers is not None:
            name, low, high = claim.covers
            values = start[names.index(name)], end[names.index(name)]
            covered = bool(values[0] <= ball(low)) and bool(values[1] >= ball(high)) and not claim.is_closed
            hypotheses.append(Hypothesis("covers", covered, dict(zip(("beginning", "end"), values, strict=True))))
        first, last = (dict(zip(names, point, strict=True)) for point in (start, end))
        return ProvedCurve(first, last, tuple(extrema), tuple(parts), boxes, checked(hypotheses), BITS)


def sums_of_pairs(matrix: Sequence[Vector]) -> list[Vector]:
    """A matrix whose eigenvalues are the sums of two different eigenvalues of this one. README, Lemma 21."""
    pairs = list(combinations(range(len(matrix)), 2))

    def entry(i: int, j: int, k: int, m: int) -> arb:
        found = matrix[i][k] * int(j == m) + matrix[j][m] * int(i == k)
        return found - matrix[i][m] * int(j == k) - matrix[j][k] * int(i == m)

    return [[entry(*row, *column) for column in pairs] for row in pairs]


def _units(size: int) -> list[Vector]:
    return [[arb(int(i == j)) for i in range(size)] for j in range(size)]


def _along(centre: Sequence[arb], tangent: Sequence[arb], tau: arb) -> Vector:
    return [c + t * tau for c, t in zip(centre, tangent, strict=True)]


def _distance(one: Sequence[arb], other: Sequence[Any]) -> float:
    """About the largest difference of coordinates; nothing rests on it."""
    return max(
        abs(float(x.mid()) - float(y if isinstance(y, Fraction) else y.mid())) for x, y in zip(one, other, strict=True)
    )


def _slopes(rows: Sequence[Jet], count: int) -> list[Vector]:
    """Derivatives by the first variables."""
    return [[row[j,] for j in range(count)] for row in rows]


def prove_curve(certificate: Mapping[str, Any]) -> ProvedCurve | NotProved:
    """Prove the curve of equilibria that a certificate claims, from its statement alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    with precision(BITS):
        try:
            return _Curve(read_curve(certificate)).conclusion()
        except (CannotFollow, *ERRORS) as error:
            return NotProved(f"{type(error).__name__}: {error}")
