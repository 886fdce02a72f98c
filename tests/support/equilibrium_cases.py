"""Equilibria and Hopf points with closed forms: normal forms in other coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction as Q
from math import cos, pi, sin
from random import Random
from typing import Any

from orbitproof.shared.claims import Covers, EquilibriumAtlas, EquilibriumCurveClaim, Piece
from orbitproof.shared.formats import Equilibrium, HopfPoint, define_system

RADIUS = Q(1, 2**70)
ROOT = Q(1, 2**40)

Matrix = tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Known:
    """A Hopf point of which all is known.

    Attributes:
        claim: exact, up to its half-widths.
        omega, speed: of the pair.
        lyapunov: for an eigenvector of length 1.
        others: the other eigenvalues, all real.
    """

    claim: HopfPoint
    omega: Q
    speed: Q
    lyapunov: Q
    others: tuple[Q, ...]


BASE = {
    "r": "p**2 + q**2",
    "dp": "(d*a + c*r)*p - (w + e*r)*q",
    "dq": "(w + e*r)*p + (d*a + c*r)*q",
}
"""p + i q has the eigenvalue d a + i w, and in its equation (c + i e)|p + i q|^2."""
BENDS = {
    "squares": ("{x} - {b}*p**2", "2*{b}*p*dp"),
    "products": ("{x} - {b}*p*{y}", "{b}*(dp*{y} + p*{dy})"),
    "exponentials": ("{x} - {b}*(exp(p) - p)", "{b}*(exp(p) - 1)*dp"),
    "sines": ("{x} - {b}*(1 - cos({y}))", "{b}*sin({y})*{dy}"),
}
"""What a coordinate is less, a function of earlier ones with derivative 0 at 0, and its rate."""


def in_other_coordinates(
    matrix: Matrix, bends: Sequence[tuple[str, Q]], numbers: dict[str, Q], others: Sequence[Q], name: str = "bent"
) -> Known:
    """The normal form beside some real eigenvalues, in coordinates that are bent and then changed linearly.

    The equilibrium of the old coordinates is 0 for all a; that of the new ones is moved by the parameter b.

    Args:
        matrix: regular, of the linear change.
        bends: for each coordinate but the first a name in `BENDS` and a factor.
        numbers: w, d, c and e.
        others: the eigenvalues beside the pair.
    """
    size = 2 + len(others)
    new, inverse = [f"s{i}" for i in range(size)], _inverse(matrix)
    old = ["p", "q", *(f"n{i}" for i in range(len(others)))]
    where, rates = {}, {}
    for i in range(size):
        where[f"y{i}"] = " + ".join(f"({x})*(s{j} - b)" for j, x in enumerate(inverse[i]))
    where["p"], rates["p"] = "y0", "dp"
    for i, coordinate in enumerate(old[1:], start=1):
        bend, factor = bends[i - 1]
        earlier = old[i - 1]
        known = {"x": f"y{i}", "y": earlier, "dy": f"d{earlier}", "b": f"({factor})"}
        where[coordinate] = BENDS[bend][0].format(**known)
        if i > 1:
            where[f"d{coordinate}"] = f"({others[i - 2]})*{coordinate}"
        rates[coordinate] = f"d{coordinate} + {BENDS[bend][1].format(**known)}"
        if i == 1:
            where |= BASE
    field = {
        s: " + ".join(f"({matrix[i][j]})*({rates[coordinate]})" for j, coordinate in enumerate(old))
        for i, s in enumerate(new)
    }
    # exp(p) - p is 1 at 0, and so the coordinate is moved.
    middle = [Q(0)] * size
    for i, (bend, factor) in enumerate(bends, start=1):
        middle[i] = factor if bend == "exponentials" else Q(0)
    shift = Q(1, 3)
    system = define_system(
        {"name": name, "state": " ".join(new), "parameters": "w d c e a b", "where": where, "field": field}
    )
    centre = tuple(sum((Q(x) * y for x, y in zip(row, middle, strict=True)), _NEAR) for row in matrix)
    kernel = tuple(tuple(Q(sign * row[j]) for row in matrix) for j, sign in ((0, 1), (1, -1)))
    radii = (RADIUS,) * size
    claim = HopfPoint(
        name, system, {**numbers, "a": Q(0), "b": shift}, "a", RADIUS, centre, radii, numbers["w"], RADIUS, kernel,
        RADIUS,
    )  # fmt: skip
    length = sum(x**2 for row in kernel for x in row)
    return Known(claim, numbers["w"], numbers["d"], 4 * numbers["c"] / (numbers["w"] * length), tuple(others))


_NEAR = Q(round(Q(1, 3) * 2**120), 2**120)
"""b, which is no dyadic number, as far as matters."""


def _inverse(matrix: Matrix) -> list[list[Q]]:
    size = len(matrix)
    rows = [[Q(x) for x in row] + [Q(int(i == j)) for j in range(size)] for i, row in enumerate(matrix)]
    for i in range(size):
        pivot = next(k for k in range(i, size) if rows[k][i])
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k in range(size):
            if k != i:
                rows[k] = [x - rows[k][i] * y for x, y in zip(rows[k], rows[i], strict=True)]
    return [row[size:] for row in rows]


def at_random(seed: int, size: int, functions: bool = False) -> Known:
    """One at random, with all signs."""
    source = Random(f"{seed} {size} {functions}")

    def number(*signs: int) -> Q:
        return Q(source.choice(signs or (1, -1)) * source.randrange(1, 9), source.choice((1, 2, 4, 5)))

    matrix: Matrix = ()
    while not matrix or not _is_regular(matrix):
        matrix = tuple(tuple(source.randrange(-2, 3) for _ in range(size)) for _ in range(size))
    bends = [(source.choice([*BENDS] if functions else ["squares", "products"]), number()) for _ in range(size - 1)]
    numbers = {"w": number(1), "d": number(), "c": number(), "e": number()}
    others = source.sample([Q(k, 4) for k in range(-9, 10) if k], size - 2)
    return in_other_coordinates(matrix, bends, numbers, others)


def of_any_field(seed: int, slaved: bool) -> Known:
    """x' = d a x - w y + f, y' = w x + d a y + g in random coordinates; f, g have all quadratic and cubic terms.

    The coefficient is that of J. Guckenheimer and P. Holmes (Nonlinear oscillations, dynamical systems, and
    bifurcations of vector fields, 3.4.11). With a third coordinate u' = k u + alpha x^2 + beta x y + gamma y^2 and
    m x u, n y u in f and g, the centre manifold u = A x^2 + B x y + C y^2 adds cubic terms.
    """
    source = Random(f"any {seed} {slaved}")

    def number() -> Q:
        return Q(source.randrange(-8, 9), source.choice((1, 2, 3, 5)))

    w, d = Q(source.randrange(1, 9), source.choice((1, 2, 4))), Q(source.choice((-3, -1, 1, 2)))
    powers = [(i, j) for degree in (2, 3) for i in range(degree + 1) for j in [degree - i]]
    f, g = ({power: number() for power in powers} for _ in range(2))
    k, alpha, beta, gamma, m, n = (number() for _ in range(6))
    k = k or Q(-1)
    size = 3 if slaved else 2
    if not slaved:
        m = n = Q(0)
    b = (2 * w * (alpha - gamma) - k * beta) / (k**2 + 4 * w**2)
    a, c = (w * b - alpha) / k, (-w * b - gamma) / k
    cubic = 6 * f[3, 0] + 2 * f[1, 2] + 2 * g[2, 1] + 6 * g[0, 3] + 6 * m * a + 2 * m * c + 2 * n * a + 6 * n * c
    fxx, fxy, fyy = 2 * f[2, 0], f[1, 1], 2 * f[0, 2]
    gxx, gxy, gyy = 2 * g[2, 0], g[1, 1], 2 * g[0, 2]
    coefficient = (cubic + (fxy * (fxx + fyy) - gxy * (gxx + gyy) - fxx * gxx + fyy * gyy) / w) / 16
    matrix: Matrix = ()
    while not matrix or not _is_regular(matrix):
        matrix = tuple(tuple(source.randrange(-2, 3) for _ in range(size)) for _ in range(size))
    inverse, old = _inverse(matrix), ["x", "y", "u"][:size]
    # The equilibrium moves with a.
    where = {
        name: " + ".join(f"({q})*s{j}" for j, q in enumerate(inverse[i])) + f" - ({number()})*a"
        for i, name in enumerate(old)
    }

    def sum_of(terms: dict[tuple[int, int], Q]) -> str:
        return " + ".join(f"({q})*x**{i}*y**{j}" for (i, j), q in terms.items())

    slave = ("0", "0")
    if slaved:
        slave = (f"({m})*x*u", f"({n})*y*u")
    where["dx"] = f"({d})*a*x - ({w})*y + {sum_of(f)} + {slave[0]}"
    where["dy"] = f"({w})*x + ({d})*a*y + {sum_of(g)} + {slave[1]}"
    where["du"] = f"({k})*u + ({alpha})*x**2 + ({beta})*x*y + ({gamma})*y**2" if slaved else "x"
    field = {
        f"s{i}": " + ".join(f"({row[j]})*d{name}" for j, name in enumerate(old)) for i, row in enumerate(matrix)
    }  # fmt: skip
    system = define_system(
        {"name": "any", "state": [f"s{i}" for i in range(size)], "parameters": "a", "where": where, "field": field}
    )  # fmt: skip
    kernel = tuple(tuple(Q(sign * row[j]) for row in matrix) for j, sign in ((0, 1), (1, -1)))
    claim = HopfPoint(
        "any", system, {"a": Q(0)}, "a", RADIUS, (Q(0),) * size, (RADIUS,) * size, w, RADIUS, kernel, RADIUS
    )  # fmt: skip
    length = sum(q**2 for row in kernel for q in row)
    return Known(claim, w, d, 4 * coefficient / (w * length), (k,) if slaved else ())


def _is_regular(matrix: Matrix) -> bool:
    try:
        _inverse(matrix)
    except StopIteration:
        return False
    return True


def hopf() -> HopfPoint:
    """In three coordinates: orbits above, which attract."""
    numbers = {"w": Q(2), "d": Q(1, 2), "c": Q(-3, 4), "e": Q(1, 3)}
    bends = [("squares", Q(1)), ("products", Q(1, 2))]
    return in_other_coordinates(((1, 1, 0), (0, 1, -1), (1, 0, 2)), bends, numbers, (Q(-1, 3),)).claim


def hopf_with_functions() -> HopfPoint:
    """In the plane: orbits below, which repel."""
    numbers = {"w": Q(3, 2), "d": Q(1), "c": Q(1, 5), "e": Q(0)}
    return in_other_coordinates(((1, 0), (1, 1)), [("exponentials", Q(1, 2))], numbers, (), "bent-by-exp").claim


RING = define_system(
    {
        "name": "ring", "state": "x y z", "parameters": "a b",
        "field": {"x": "a - x*y", "y": "x - b*y", "z": "x + y*z - 3*z"},
    }
)  # fmt: skip


def equilibrium(**changes: Any) -> Equilibrium:
    """x = 2, y = 1, z = 1 at a = 2, b = 2: the eigenvalues are -2 and (-3 +- i sqrt(7))/2."""
    given: dict[str, Any] = {
        "id": "ring", "system": RING, "parameters": {"a": Q(2), "b": Q(2)}, "centre": (Q(2), Q(1), Q(1)),
        "radii": (ROOT,) * 3,
    }  # fmt: skip
    return Equilibrium(**{**given, **changes})


PENDULUM = define_system(
    {"name": "driven-pendulum", "state": "x v", "parameters": "k", "field": {"x": "v", "v": "1/2 - sin(x) - k*v"}}
)


def equilibrium_with_functions() -> Equilibrium:
    """x = pi/6: v^2 + k v + cos(pi/6)."""
    middle = Q(52359877559829887307710723054658381403286, 10**41)
    return Equilibrium("hanging", PENDULUM, {"k": Q(1)}, (middle, Q(0)), (ROOT, ROOT))


# Curves


BEND = define_system(
    {
        "name": "bend", "state": "x y", "parameters": "a b",
        "field": {"x": "a - x**2 + b*(y - x)", "y": "b*x - b*y + (x - y)**2"},
    }
)  # fmt: skip
"""For b > 0 the equilibria near the diagonal have y = x and a = x^2: a fold at 0, and of a matrix at (x, x)."""


def curve_of_equilibria(**changes: Any) -> EquilibriumAtlas:
    """x = y from -1/2 to 1/2, in two pieces that overlap."""
    one, zero = Q(1), Q(0)
    frame = ((zero, one, zero), (one, zero, zero), (one, zero, one))
    pieces = tuple(
        # a = (c + h s)^2
        Piece(
            f"p{number}", "regular", (middle**2, middle, middle), frame, reach,
            ((zero, 2 * middle * reach, reach**2), (zero,)), (Q(1, 2**12),) * 2, "physical",
        )
        for number, (middle, reach) in enumerate(((Q(-1, 5), Q(3, 10)), (Q(1, 4), Q(1, 4))), start=1)
    )  # fmt: skip
    claim = EquilibriumCurveClaim("equilibrium-arc", "a", ("x",), Covers("x", Q(-12, 25), Q(12, 25)))
    given: dict[str, Any] = {
        "id": "bend", "title": "a fold", "system": BEND, "parameters": {"b": Q(2)}, "claim": claim, "pieces": pieces,
    }  # fmt: skip
    return EquilibriumAtlas(**{**given, **changes})


CIRCLE = define_system(
    {"name": "circle", "state": "x y", "parameters": "a", "field": {"x": "a**2 + x**2 - 1", "y": "-y - y*x**2"}}
)


def circle_of_equilibria(turns: int = 1, **changes: Any) -> EquilibriumAtlas:
    """a^2 + x^2 = 1, y = 0, in seven pieces for each turn, from a = 1 upwards in x; the first covers its end."""
    count, zero = 7, Q(0)
    reach = Q(5, 8)
    # sqrt(1 - u^2) - 1
    bend, binomial = [zero] * 17, Q(1)
    for m in range(1, 9):
        binomial *= (m - 1 - Q(1, 2)) / m
        bend[2 * m] = binomial * reach ** (2 * m)
    pieces = []
    for number in range(count * turns):
        angle = 2 * pi * (number % count) / count + 1 / 8
        c, d = (Q(round(value * 2**30), 2**30) for value in (cos(angle), sin(angle)))
        frame = ((-d, c, zero), (c, d, zero), (zero, zero, Q(1)))
        polynomial = (tuple(bend), (zero,))
        tube = (Q(1, 2**6),) * 2
        pieces.append(Piece(f"p{number}", "regular", (c, d, zero), frame, reach, polynomial, tube, "physical"))
    claim = EquilibriumCurveClaim("equilibrium-loop", "a")
    given: dict[str, Any] = {
        "id": "circle", "title": "a circle", "system": CIRCLE, "parameters": {}, "claim": claim,
        "pieces": tuple(pieces),
    }  # fmt: skip
    return EquilibriumAtlas(**{**given, **changes})
