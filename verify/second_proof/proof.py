"""The Poincare map near one point and its iterates, refinement, box, proof. README, sections 1, 5 and 6."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from .conditions import Claim, Hypothesis, Table, Vector, certain, conclude, nonzero
from .crossing import follow
from .flow import field_of
from .jets import (
    CannotFollow,
    Exponents,
    Jet,
    add,
    ball,
    combine,
    implicit,
    precision,
    scale,
    substitute,
    unit,
    varying,
)
from .statement import Statement, read_statement

WIDTHS, SECONDS, NEWTON_STEPS = (96, 72, 240, 480), 3600.0, 8


@dataclass(frozen=True)
class Proved:
    """The bifurcation is proved.

    Attributes:
        kind, k: as claimed; `side`: values of the parameter at which the new orbits exist, above, below or both.
        point: enclosures of the coordinates of Fix(R), by name, the family parameter among them if there is one.
        parameter: enclosure of the family parameter or of the first integral.
        hypotheses: every inequality with its enclosures.
        radius, bits, steps: R_1, the precision, and the time steps of all integrations.
    """

    kind: str
    k: int
    side: str
    point: dict[str, arb]
    parameter: arb
    hypotheses: tuple[Hypothesis, ...]
    radius: arb
    bits: int
    steps: int

    def __str__(self) -> str:
        return f"proved: {self.kind}, k = {self.k}, {self.side}, at {self.parameter.str(30)}"


@dataclass(frozen=True)
class NotProved:
    """Nothing is proved; this does not say that the claim is false."""

    reason: str

    def __str__(self) -> str:
        return f"not proved: {self.reason}"


@dataclass(frozen=True)
class PoincareMap:
    """P on the box of all points of the section within `size` of `middle`, and near P(centre). README, section 5.

    Attributes:
        signs: R on the coordinates of the section.
        centre: a point of Fix(R) in the box.
        rows: tables of the coordinates of P: at the centre up to order 1, and on the box.
    """

    signs: tuple[int, ...]
    middle: Vector
    size: arb
    centre: Vector
    rows: list[Table]

    def _around(self, point: Vector) -> list[Jet]:
        if not all(abs(x - m) < self.size for x, m in zip(point, self.middle, strict=True)):
            raise CannotFollow("an iterate leaves the box on which P is known")
        reach = [x - c for x, c in zip(point, self.centre, strict=True)]
        return [row.jet(reach) for row in self.rows]

    def forward(self, state: Sequence[Jet], zero: Exponents) -> list[Jet]:
        """Jets of P(z), from jets of points z in the box."""
        inner, none = [varying(jet) for jet in state], (0,) * len(state)
        rows = self._around([jet[zero] for jet in state])
        return [add({zero: row[none]}, substitute(varying(row), inner, zero, 3)) for row in rows]

    def backward(self, state: Sequence[Jet], zero: Exponents) -> list[Jet]:
        """Jets of P(z) = R w, from jets of points z = R P(w), w in the box. README, section 5."""
        m, n, none = len(state), len(zero), (0,) * len(state)
        targets = [scale(sign, jet) for sign, jet in zip(self.signs, state, strict=True)]
        slopes = arb_mat([[row.around.get(unit(m, j), arb(0)) for j in range(m)] for row in self.rows])
        gaps = arb_mat([[row.centre[none] - t[zero]] for row, t in zip(self.rows, targets, strict=True)])
        move = (slopes.inv() * gaps).tolist()
        point = [c - step for c, (step,) in zip(self.centre, move, strict=True)]
        left = [{(*[0] * n, *a): c for a, c in row.items()} for row in self._around(point)]
        right = [{(*a, *none): -c for a, c in target.items()} for target in targets]
        found = implicit([add(a, b) for a, b in zip(left, right, strict=True)], n, 3)
        return [scale(sign, add({zero: x}, w)) for sign, x, w in zip(self.signs, point, found, strict=True)]


def second_proof(certificate: Mapping[str, Any], seconds: float = SECONDS) -> Proved | NotProved:
    """Prove the bifurcation that a certificate claims, from its statement and centre alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    statement = read_statement(certificate)
    deadline, reasons = time.monotonic() + seconds, [""]
    try:
        symmetric = _symmetries(statement)
    except CannotFollow as error:
        return NotProved(str(error))
    for width in WIDTHS:
        try:
            with precision(2 * width + 16):
                return _prove(statement, width, symmetric, deadline)
        except (CannotFollow, ArithmeticError, ValueError, TypeError, MemoryError) as error:
            kind = "" if isinstance(error, CannotFollow) else f"{type(error).__name__}: "
            reasons.append(f"{kind}{error}")
        # Other bits do not help against the same obstacle twice, but a box may be too small or too large for a centre.
        again = reasons[-1].split(":")[0] == reasons[-2].split(":")[0] and "leaves" not in reasons[-1]
        if again or time.monotonic() > deadline:
            break
    return NotProved("; ".join(f"{r} (R_1 = 2^-{w})" for r, w in zip(reasons[1:], WIDTHS, strict=False)))


def _symmetries(statement: Statement) -> Hypothesis:
    """[WW] has a theorem; R reverses the field, S and R keep the first integral: by parities of the programs."""
    kind, k = statement.kind, statement.k
    breaking = kind == "symmetry_breaking" and k == 1 and statement.symmetry is not None
    if not (breaking or (kind == "period_tupling" and k % 2 == 0) or (kind == "touch_and_go" and k % 2 and k > 1)):
        raise CannotFollow(f"no theorem of [WW] is about {kind} with k = {k}")
    if len(statement.kernel) not in (1, 2):
        raise CannotFollow("systems with more than two equations are not followed, a limit that [WW] does not have")
    for name, signs, sense in (("R", statement.reversing, -1), ("S", statement.symmetry, 1)):
        changes = dict(zip(statement.state, signs or (), strict=False))
        outputs = list(zip(statement.field.outputs, statement.field.parities(changes), signs or (), strict=False))
        if any(output is not None and parity != sense * sign for output, parity, sign in outputs):
            raise CannotFollow(f"{name} is not shown to be a symmetry of the field")
        if statement.integral.parities(changes) != [1]:
            raise CannotFollow(f"{name} is not shown to be a symmetry of the first integral")
    says = "f(R x) = -R f(x), H(R x) = H(x), and the same without a sign for S"
    return certain(True, "symmetries", says, shown=arb(1))


def check_integral(before: Jet, after: Jet) -> None:
    """Jets of the first integral at two points of one orbit have points in common. README, section 4.4."""
    if not all(before.get(a, arb(0)).overlaps(after.get(a, arb(0))) for a in {**before, **after}):
        raise CannotFollow("the first integral is not kept: no first integral, or an error")


def _mid(values: Sequence[arb]) -> Vector:
    return [v.mid() for v in values]


def _dot(left: Sequence[arb], right: Sequence[arb]) -> arb:
    return sum((a * b for a, b in zip(left, right, strict=True)), arb(0))


def _unit(vector: Sequence[arb]) -> Vector:
    size = max(abs(v.mid()) for v in vector)
    if not size > 0:
        raise CannotFollow("the refinement has no direction to go on with")
    return [(v / size).mid() for v in vector]


def _perpendicular(rows: Sequence[Vector]) -> Vector:
    """A vector orthogonal to n vectors of length n + 1, n = 1 or 2, of maximum norm 1."""
    if len(rows) == 1:
        return _unit([-rows[0][1], rows[0][0]])
    (a, b, c), (d, e, f) = rows
    return _unit([b * f - c * e, c * d - a * f, a * e - b * d])


def _newton(
    statement: Statement, centre: Vector, first: list[Jet], last: list[Jet]
) -> tuple[Vector, list[Vector], list[Vector]]:
    """The step of Newton's method for pi_q P = 0 and G_1 = 0 in the coordinates of Fix(R), columns of p and rows of q.

    Midpoints of enclosures: nothing rests on how good they are. README, section 6.5.
    """
    size, signs = len(centre), statement.symmetry or ()
    units = [unit(size, j) for j in range(size)]

    def gradient(jet: Jet) -> Vector:
        return [jet[u].mid() for u in units]

    def hessian(jet: Jet) -> list[Vector]:
        pairs = [[(tuple(map(sum, zip(u, v, strict=True))), 2 if u == v else 1) for v in units] for u in units]
        return [[(jet.get(a, arb(0)) * c).mid() for a, c in row] for row in pairs]

    none = (0,) * size
    lines = [(jet[none].mid(), gradient(jet)) for jet in first]
    if statement.kind == "symmetry_breaking":
        lines = [line for line, i in zip(lines, statement.kernel, strict=True) if signs[i] == 1]
        odd = [j for j, i in enumerate(statement.fixed) if signs[i] == -1]
        lines += [(centre[j], [arb(int(i == j)) for i in range(size)]) for j in odd]
    if len(lines) != size - 1:
        raise CannotFollow("S does not single out a curve")
    tangent = _perpendicular([line[1] for line in lines])
    gradients, bends = [gradient(jet) for jet in last], [hessian(jet) for jet in last]
    if size == 2:
        rows, kernel = [[arb(1)]], _perpendicular([tangent])
        across = [kernel]
    else:
        column = max(range(size), key=lambda j: sum(float(abs(g[j])) for g in gradients))
        along = _unit([g[column] for g in gradients])
        rows = [[along[1], -along[0]], along]
        normal = _unit([_dot(along, [g[j] for g in gradients]) for j in range(size)])
        kernel = _perpendicular([tangent, normal])
        across = [kernel, normal]
    matrix = [[_dot(g, a) for a in across] for g in gradients]
    slope = [arb(0)] * size
    for j in range(size):
        for i, bend in enumerate(bends):
            changed = [[_dot(bend[j], a) for a in across] if r == i else row for r, row in enumerate(matrix)]
            slope[j] = slope[j] + arb_mat(changed).det()
    right = arb_mat([[-value] for value, _ in lines] + [[-arb_mat(matrix).det()]])
    step = [row[0].mid() for row in arb_mat([*[line[1] for line in lines], slope]).solve(right).tolist()]

    def form(vector: Vector) -> arb:
        return _dot(rows[0], [_dot(vector, [_dot(line, kernel) for line in bend]) for bend in bends])

    tilt = (-form(kernel) / (2 * form(tangent))).mid()
    branch = _unit([c + tilt * t for c, t in zip(kernel, tangent, strict=True)])
    return step, [tangent, branch, *across[1:]], rows


def _adapted(statement: Statement, centre: Vector, columns: list[Vector], rows: list[Vector]) -> None:
    """For symmetry breaking: S fixes the centre, negates p_1 and q_1 and keeps the other p and q, exactly."""
    signs = statement.symmetry or ()
    expected = [(statement.fixed, v, -1 if j == 1 else 1) for j, v in enumerate([*columns, centre])]
    expected += [(statement.kernel, v, 1 if j else -1) for j, v in enumerate(rows)]
    for indices, vector, sign in expected:
        if any(not c.is_zero() and signs[i] != sign for c, i in zip(vector, indices, strict=True)):
            raise CannotFollow("the frames or the centre are not adapted to the symmetry S")


def _prove(statement: Statement, width: int, symmetric: Hypothesis, deadline: float) -> Proved:
    k, size, bits = statement.k, len(statement.fixed), 2 * width + 16
    places = [i for i in range(len(statement.state)) if i != statement.section]
    none, zero = (0,) * len(places), (0,) * size
    radii = [arb(2) ** -(width + (0 if j == 1 else 8)) for j in range(size)]
    wide, tiny = arb(2) ** -(2 * width // 3), arb(2) ** -(width + 20)
    runs: list[tuple[arb, int]] = []

    def section_point(centre: Vector) -> Vector:
        values = dict(zip(statement.fixed, centre, strict=True))
        return [values.get(i, arb(0)) for i in places]

    def state_of(jets: Sequence[Jet]) -> list[Jet]:
        values = dict(zip(places, jets, strict=True))
        return [values.get(i, {}) for i in range(len(statement.state))]

    def integrate(centre: Vector, spread: arb, degree: int, used: int) -> list[Jet]:
        start = [{none: x + spread, unit(len(places), j): arb(1)} for j, x in enumerate(section_point(centre))]
        with precision(used):
            found, moment, count = follow(statement, state_of(start), none, degree, used, deadline)
        runs.append((moment, count))
        return [found[i] for i in places]

    def iterates(poincare: PoincareMap, columns: list[Vector], reach: Sequence[arb]) -> tuple[list[list[Jet]], Jet]:
        """Jets in p of P, .., P^k at all points centre + A p with p in `reach`, and of the first integral."""
        slopes = dict(zip(statement.fixed, zip(*columns, strict=True), strict=True))
        lines = [slopes.get(i, (arb(0),) * size) for i in places]
        units = [unit(size, j) for j in range(size)]
        moved = zip(poincare.centre, lines, strict=True)
        state = [{zero: x + _dot(line, reach), **dict(zip(units, line, strict=True))} for x, line in moved]
        before = field_of(statement, state_of(state), zero, 3, statement.integral)[0]
        found = []
        for i in range(k):
            state = poincare.backward(state, zero) if i % 2 else poincare.forward(state, zero)
            after = field_of(statement, state_of(state), zero, 3, statement.integral)[0]
            check_integral(before, after)
            values = dict(zip(places, state, strict=True))
            found.append([values[j] for j in statement.kernel])
        return found, before

    centre = middle = _mid([ball(c) for c in statement.centre])
    box: list[Jet] = []
    for _ in range(NEWTON_STEPS):
        if not box or any(abs(c - m) > wide / 4 for c, m in zip(centre, middle, strict=True)):
            middle = centre
            box = integrate(middle, arb(0, wide), 3, 2 * width // 3 + 24)
            crossed, _ = runs[-1]
        thin = integrate(centre, arb(0), 1, bits)
        tables = [Table(at, around, 1) for at, around in zip(thin, box, strict=True)]
        signs = tuple(statement.reversing[i] for i in places)
        poincare = PoincareMap(signs, section_point(middle), wide, section_point(centre), tables)
        identity = [[arb(int(i == j)) for i in range(size)] for j in range(size)]
        found, _ = iterates(poincare, identity, [arb(0)] * size)
        step, columns, rows = _newton(statement, centre, found[0], found[-1])
        largest = max(abs(c) for c in step)
        if largest < tiny:
            break
        if not largest < arb(2) ** -10:
            raise CannotFollow("Newton's method does not converge from the centre of the certificate")
        centre = _mid([c + s for c, s in zip(centre, step, strict=True)])
    else:
        raise CannotFollow("Newton's method does not converge from the centre of the certificate")
    if statement.kind == "symmetry_breaking":
        _adapted(statement, centre, columns, rows)
    regular = arb_mat(rows).det(), arb_mat(columns).det()
    says = "the frames of p and q are regular"
    frames = certain(all(nonzero(d) for d in regular), "frames", says, p=regular[1], q=regular[0])
    m = statement.crossings
    which = "the first crossing" if m == 1 else f"crossing {m}, the first one that may be in Fix(R),"
    says = f"P exists on the box; it is {which} there, and every iterate stays where P is known"
    crossings = certain(True, "crossings", says, time=crossed)
    at_centre, first = iterates(poincare, columns, [arb(0)] * size)
    over_box, around = iterates(poincare, columns, [arb(0, r) for r in radii])
    pairs = zip(at_centre, over_box, strict=True)
    q = [[Table(combine(row, at), combine(row, over), 2) for row in rows] for at, over in pairs]
    claim = Claim(k, statement.kind == "symmetry_breaking", q, Table(first, around, 2), radii)
    hypotheses, coordinates, side = conclude(claim)
    offsets = [_dot(line, coordinates) for line in zip(*columns, strict=True)]
    values = [c + offset for c, offset in zip(centre, offsets, strict=True)]
    point = {statement.state[i]: x for i, x in zip(statement.fixed, values, strict=True)}
    state = state_of([{(): x} for x in section_point(values)])
    parameter = field_of(statement, state, (), 0, statement.integral)[0][()]
    shown = (symmetric, frames, crossings, *hypotheses)
    return Proved(statement.kind, k, side, point, parameter, shown, radii[1], bits, sum(count for _, count in runs))
