"""Refinement of the bifurcation point, choice of the box, and the proof on it. README, sections 1 and 6."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from .conditions import Claim, Hypothesis, Table, certain, combine, conclude, determinant
from .crossing import Trajectory, follow
from .flow import field_of
from .jets import CannotFollow, Jet, Monomials, add, ball, monomials, precision
from .statement import Statement, read_statement

Vector = list[arb]
Report = Callable[[str, float], None]

ATTEMPTS = ((88, 216, 136), (200, 448, 304), (400, 960, 600))
"""R_1 = 2^-first, and the bits with which the centre and the box are followed."""

SECONDS = 3600.0
NEWTON_STEPS = 8


@dataclass(frozen=True)
class Proved:
    """The bifurcation is proved.

    Attributes:
        kind, k: as claimed; `side`: values of the parameter at which the new orbits exist, above, below or both.
        point: enclosures of the coordinates of Fix(R), by name, the family parameter among them if there is one.
        parameter: enclosure of the family parameter or of the first integral.
        hypotheses: every inequality with its enclosures.
        radius, bits, steps: R_1, the precision, and the time steps over the box.
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
class _Place:
    """A centre and frames, exact: the initial point is centre + sum of p_j columns_j, and q_i is measured along rows_i.

    `states` are jets of order 2 at the crossings, in the coordinates of Fix(R) relative to the centre.
    """

    centre: Vector
    columns: list[Vector]
    rows: list[Vector]
    states: list[list[Jet]]


def second_proof(
    certificate: Mapping[str, Any], report: Report | None = None, *, seconds: float = SECONDS
) -> Proved | NotProved:
    """Prove the bifurcation that a certificate claims, from its statement and centre alone.

    `report` is called with a stage in words and its share of done crossings. Raises `BadCertificate` for a
    certificate that cannot be read; everything else that goes wrong is a `NotProved` with its reason.
    """
    statement = read_statement(certificate)
    deadline = time.monotonic() + seconds
    reasons: list[str] = []
    for width, bits, box_bits in ATTEMPTS:
        try:
            with precision(bits):
                return _prove(statement, width, bits, box_bits, deadline, report)
        except CannotFollow as error:
            reasons.append(f"{error} ({bits} bits)")
        except (ArithmeticError, ValueError, TypeError, MemoryError) as error:
            reasons.append(f"{type(error).__name__}: {error} ({bits} bits)")
        # More bits do not help against the same obstacle twice, nor against a claim that no theorem covers.
        again = len({reason.split(":")[0] for reason in reasons[-2:]}) < len(reasons[-2:])
        if again or time.monotonic() > deadline or "symmetr" in reasons[-1] or "[WW]" in reasons[-1]:
            break
    return NotProved("; ".join(reasons))


def _symmetries(statement: Statement) -> Hypothesis:
    """R reverses and S keeps the field, both keep the first integral: by parities of the programs."""
    for name, signs, sense in (("R", statement.reversing, -1), ("S", statement.symmetry, 1)):
        if signs is None:
            continue
        changes = dict(zip(statement.state, signs, strict=True))
        parities = statement.field.parities(changes)
        if any(
            output is not None and parity != sense * sign
            for output, parity, sign in zip(statement.field.outputs, parities, signs, strict=True)
        ):
            raise CannotFollow(f"{name} is not shown to be a symmetry of the field")
        if statement.integral.parities(changes) != [1]:
            raise CannotFollow(f"{name} is not shown to be a symmetry of the first integral")
    return certain(
        True, "symmetries", "f(R x) = -R f(x), H(R x) = H(x), and the same without a sign for S", shown=arb(1)
    )


def _covered(statement: Statement) -> None:
    """The theorems of [WW]: symmetry breaking, even k, touch-and-go for odd k."""
    kind, k = statement.kind, statement.k
    breaking = kind == "symmetry_breaking" and k == 1 and statement.symmetry is not None
    if not (breaking or (kind == "period_tupling" and k % 2 == 0) or (kind == "touch_and_go" and k % 2 == 1 and k > 1)):
        raise CannotFollow(f"no theorem of [WW] is about {kind} with k = {k}")
    if len(statement.kernel) not in (1, 2):
        raise CannotFollow("systems with more than two equations are not followed, a limit that [WW] does not have")


def _start(
    statement: Statement, centre: Vector, columns: list[Vector], table: Monomials, radii: Sequence[arb] | None
) -> list[Jet]:
    """Jets in p of the initial state, at p = 0 or at all points of the box."""
    state = [table.constant(arb(0)) for _ in statement.state]
    for row, i in enumerate(statement.fixed):
        slopes = [column[row] for column in columns]
        value = centre[row]
        for slope, radius in zip(slopes, radii or [], strict=False):
            value = value + arb(0, (abs(slope) * radius).upper())
        state[i] = table.linear(value, [None if s.is_zero() else s for s in slopes])
    return state


def _mid(values: Sequence[arb]) -> Vector:
    return [v.mid() for v in values]


def _dot(left: Sequence[arb], right: Sequence[arb]) -> arb:
    return sum((a * b for a, b in zip(left, right, strict=True)), arb(0))


def _perpendicular(rows: Sequence[Vector]) -> Vector:
    """A vector orthogonal to n vectors of length n + 1, n = 1 or 2, of maximum norm 1."""
    if len(rows) == 1:
        vector = [-rows[0][1], rows[0][0]]
    else:
        (a, b, c), (d, e, f) = rows
        vector = [b * f - c * e, c * d - a * f, a * e - b * d]
    return _unit(vector)


def _unit(vector: Sequence[arb]) -> Vector:
    size = max((abs(v.mid()) for v in vector), key=lambda v: v)
    if not size > 0:
        raise CannotFollow("the refinement has no direction to go on with")
    return [(v / size).mid() for v in vector]


def _first_and_second(
    jets: Sequence[Jet], statement: Statement, table: Monomials
) -> list[tuple[arb, Vector, list[Vector]]]:
    """Midpoints of value, gradient and Hessian of q_1, .., q_n."""
    result = []
    size = table.variables
    for i in statement.kernel:
        jet = [arb(0) if c is None else c.mid() for c in jets[i]]
        hessian = [[arb(0)] * size for _ in range(size)]
        for a, c in zip(table.exponents, jet, strict=True):
            places = [j for j, e in enumerate(a) for _ in range(e)]
            if len(places) == 2:
                hessian[places[0]][places[1]] += c
                hessian[places[1]][places[0]] += c
        result.append((jet[0], jet[1 : 1 + size], hessian))
    return result


def refine(statement: Statement, width: int, run: Callable[[str, Vector, list[Vector]], Trajectory]) -> _Place:
    """Newton's method for pi_q P = 0 and G_1 = 0 in the coordinates of Fix(R), and adapted frames.

    Nothing rests on how good they are; the jets at the last centre, which enclose, are used for the proof.
    """
    size = len(statement.fixed)
    table = monomials(size, 2)
    unit = [[arb(1) if i == j else arb(0) for i in range(size)] for j in range(size)]
    centre = _mid([ball(c) for c in statement.centre])
    for _ in range(NEWTON_STEPS):
        states = run("centre", centre, unit).states
        first, last = (_first_and_second(s, statement, table) for s in (states[0], states[-1]))
        lines = [(value, gradient) for value, gradient, _ in first]
        if statement.kind == "symmetry_breaking":
            signs = statement.symmetry or ()
            lines = [line for line, i in zip(lines, statement.kernel, strict=True) if signs[i] == 1]
            lines += [
                (c, unit[j]) for j, (c, i) in enumerate(zip(centre, statement.fixed, strict=True)) if signs[i] == -1
            ]
        if len(lines) != size - 1:
            raise CannotFollow("S does not single out a curve")
        tangent = _perpendicular([line[1] for line in lines])
        gradients = [gradient for _, gradient, _ in last]
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
        slope = []
        for j in range(size):
            changed = [[_dot(h[j], a) for a in across] for _, _, h in last]
            slope.append(
                sum(
                    (
                        determinant([changed[r] if r == i else matrix[r] for r in range(len(matrix))])
                        for i in range(len(matrix))
                    ),
                    arb(0),
                )
            )
        system = arb_mat([*[line[1] for line in lines], slope])
        right = arb_mat([[-line[0]] for line in lines] + [[-determinant(matrix)]])
        step = [row[0].mid() for row in system.solve(right).tolist()]
        size_of_step = max((abs(c) for c in step), key=lambda v: v)
        if not size_of_step < arb(2) ** -10:
            raise CannotFollow("Newton's method does not converge from the centre of the certificate")
        if size_of_step < arb(2) ** -(width + 20):
            break
        centre = _mid([c + s for c, s in zip(centre, step, strict=True)])
    else:
        raise CannotFollow("Newton's method does not converge from the centre of the certificate")

    def form(u: Vector, v: Vector) -> arb:
        return sum(
            (c * _dot(u, [_dot(h, v) for h in hessian]) for c, (_, _, hessian) in zip(rows[0], last, strict=True)),
            arb(0),
        )

    tilt = (-form(kernel, kernel) / (2 * form(tangent, kernel))).mid()
    branch = _unit([c + tilt * t for c, t in zip(kernel, tangent, strict=True)])
    return _Place(centre, [tangent, branch, *across[1:]], rows, states)


def _adapted(statement: Statement, place: _Place) -> None:
    """For symmetry breaking: S negates p_1 and q_1 and keeps the other p and q, exactly."""
    signs = statement.symmetry or ()
    for vectors, indices in ((place.columns, statement.fixed), (place.rows, statement.kernel)):
        negated = 1 if vectors is place.columns else 0
        for j, vector in enumerate(vectors):
            for c, i in zip(vector, indices, strict=True):
                if not c.is_zero() and signs[i] != (-1 if j == negated else 1):
                    raise CannotFollow("the frames are not adapted to the symmetry S")
    if any(not c.is_zero() and signs[i] == -1 for c, i in zip(place.centre, statement.fixed, strict=True)):
        raise CannotFollow("the centre is not fixed by the symmetry S")


def _in_frame(jet: Jet, columns: Sequence[Vector]) -> Jet:
    """The jet of order 2 at p = 0 of f(A p) from that of f at 0, columns of A."""
    size = len(columns)
    plain = monomials(size, 2)
    terms = [(a, c) for a, c in zip(plain.exponents, jet, strict=True) if c is not None]
    result = plain.constant(jet[0])
    lines = [plain.linear(None, [column[i] for column in columns]) for i in range(size)]
    for a, c in terms:
        factors = [lines[i] for i, e in enumerate(a) for _ in range(e)]
        if factors:
            product = factors[0] if len(factors) == 1 else plain.multiply(factors[0], factors[1])
            result = add(result, [None if p is None else p * c for p in product])
    return result


def _prove(
    statement: Statement, width: int, bits: int, box_bits: int, deadline: float, report: Report | None
) -> Proved:
    _covered(statement)
    shown = _symmetries(statement)
    k, size = statement.k, len(statement.fixed)

    def run(stage: str, centre: Vector, columns: list[Vector], radii: Sequence[arb] | None = None) -> Trajectory:
        table = monomials(size, 3 if radii else 2)
        start = _start(statement, centre, columns, table, radii)
        tell = None if report is None else lambda done, _: report(stage, done / k)
        with precision(box_bits if radii else bits):
            return follow(statement, start, table, k, box_bits if radii else bits, deadline, tell)

    place = refine(statement, width, run)
    centre, columns = place.centre, place.columns
    if statement.kind == "symmetry_breaking":
        _adapted(statement, place)
    regular = determinant(place.rows), arb_mat(columns).det()
    frames = certain(
        all(bool(d > 0) or bool(d < 0) for d in regular),
        "frames",
        "the frames of p and q are regular",
        p=regular[1],
        q=regular[0],
    )
    least, wide = arb(2) ** (-width - 8), arb(2) ** -width
    radii = [least, wide, least][:size]
    box = run("box", centre, columns, radii)
    iterates = []
    for at_centre, over_box in zip(place.states, box.states, strict=True):
        tables = [Table(_in_frame(at_centre[i], columns), over_box[i]) for i in statement.kernel]
        iterates.append([combine(row, tables) for row in place.rows])
    integral = []
    for degree, spread in ((2, None), (3, radii)):
        start = _start(statement, centre, columns, monomials(size, degree), spread)
        integral.append(field_of(statement, monomials(size, degree), start, statement.integral)[0])
    times = {f"time {i}": moment for i, moment in enumerate(box.times, 1)}
    crossings = certain(True, "crossings", "P, .., P^k exist on the box; every crossing is counted", **times)
    claim = Claim(k, statement.kind == "symmetry_breaking", iterates, Table(*integral), radii)
    result = conclude(claim)
    point = {}
    for row, i in enumerate(statement.fixed):
        point[statement.state[i]] = centre[row] + _dot([column[row] for column in columns], result.point)
    values = [monomials(0, 0).constant(arb(0)) for _ in statement.state]
    for i in statement.fixed:
        values[i] = [point[statement.state[i]]]
    parameter = field_of(statement, monomials(0, 0), values, statement.integral)[0][0]
    return Proved(
        statement.kind,
        k,
        result.side,
        point,
        parameter,
        (shown, frames, crossings, *result.hypotheses),
        wide,
        bits,
        box.steps,
    )
