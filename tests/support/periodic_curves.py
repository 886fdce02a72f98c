"""Curves of periodic orbits in closed form, as atlases of exact pieces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import pi, tan
from typing import Any

from flint import arb

from orbitproof import shared
from orbitproof.shared.formats import PeriodicAtlas, PeriodicCurveClaim, Piece
from orbitproof.verify.curve import PROVED, Computation, IntervalResult, PieceResult, ProvedInterval
from orbitproof.verify.evidence import NotProved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_curve import PeriodicLimits, conclude_periodic, prove_periodic_piece
from orbitproof.verify.periodic_curve.returns import FramingWideOracle

LIMITS = PeriodicLimits(96, 40, 24, 2)
TUBE = Fraction(1, 10**8)
WHOLE = (Fraction(-1), Fraction(1))
Q = Fraction


def _turning(x: Any, y: Any, a: Any) -> tuple[Any, Any]:
    q = x * x + y * y
    rate = (a + 2 * q - q * q) / 10
    return rate * x - y, rate * y + x


def _two_crossings(x: Any, y: Any, u: Any, a: Any) -> tuple[Any, Any, Any]:
    rate = (a - x * x - y * y) / 8
    dx, dy = rate * x - y, rate * y + x
    return dx, dy, x * x - y * y - u + 2 * x * dx - 2 * y * dy


TURNING = shared.define_system({"name": "turning", "state": "x y", "parameters": "a", "field": _turning})
"""x^2 + y^2 = q turns with period 2 pi if a = q^2 - 2 q, which has a minimum at q = 1."""

TWICE = shared.define_system({"name": "twice", "state": "x y u", "parameters": "a", "field": _two_crossings})
"""x + iy = R exp(it), a = R^2, and u = x^2 - y^2 vanishes four times in a period, twice growing."""


def _faster(x: Any, y: Any, a: Any) -> tuple[Any, Any]:
    rate, speed = (1 - x * x - y * y) / 8, 1 + a / 4
    return rate * x - speed * y, rate * y + speed * x


FASTER = shared.define_system({"name": "faster", "state": "x y", "parameters": "a", "field": _faster})
"""The unit circle, run through in the time 2 pi/(1 + a/4)."""

LEVELS = shared.define_system(
    {
        "name": "levels", "state": "x y z", "parameters": "a", "first_integral": lambda x, y, z, a: x * x + y * y,
        "field": lambda x, y, z, a: (y, -x, a * x - z),
    }
)  # fmt: skip
"""Where y = 0 and falls or grows, z = a x/2 on the periodic orbits, all of period 2 pi."""


def _closed(x: Any, y: Any, a: Any) -> tuple[Any, Any]:
    r = (x * x + y * y) ** Q(1, 2)
    rate = (r * r - 4 * r + 3 + a * a) / 10
    return rate * x - y, rate * y + x


CLOSED = shared.define_system({"name": "closed", "state": "x y", "parameters": "a", "field": _closed})
"""x^2 + y^2 = r^2 turns with period 2 pi if (r - 2)^2 + a^2 = 1: a closed curve of orbits."""

ROUND = tuple(0.3 - pi + 2 * pi * number / 12 for number in range(12))
"""Angles of pieces that go round once."""


def _piece(name: str, centre: Sequence[Q], along: int, half_width: Q, rows: Sequence[Sequence[Q]]) -> Piece:
    """A graph over coordinate number `along`; `rows` are polynomials in s for the other coordinates, whole."""
    size = len(centre)
    order = [along, *(i for i in range(size) if i != along)]
    frame = tuple(tuple(Q(int(order[j] == i)) for j in range(size)) for i in range(size))
    flat = tuple(value if i == along else Q(0) for i, value in enumerate(centre))
    return Piece(name, "regular", flat, frame, half_width, tuple(map(tuple, rows)), (TUBE,) * len(rows), "physical")


def turning_piece(name: str, radius: str, half_width: str = "1/8") -> Piece:
    """x from radius - half_width to radius + half_width."""
    r, h = Q(radius), Q(half_width)
    row = [r**4 - 2 * r**2, 4 * r**3 * h - 4 * r * h, 6 * r**2 * h**2 - 2 * h**2, 4 * r * h**3, h**4]
    return _piece(name, (Q(0), r), 1, h, [row])


def turning_atlas(**claim: Any) -> PeriodicAtlas:
    """Through the minimum of a, in two pieces."""
    stated = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1)), Q(0), 1, 1, "a", increasing=("x",))
    pieces = (turning_piece("p1", "9/10"), turning_piece("p2", "11/10"))
    return PeriodicAtlas("turning", "Through a fold", TURNING, {}, replace(stated, **claim), pieces)


def twice_atlas(crossings: int = 2) -> PeriodicAtlas:
    """x = -y from -0.85 to -0.75, a = 2 x^2."""
    x, h = Q(-4, 5), Q(1, 20)
    rows = [[2 * x**2, 4 * x * h, 2 * h**2], [-x, -h]]
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(0), Q(1)), Q(0), 1, crossings, "a")
    return PeriodicAtlas("twice", "Two crossings", TWICE, {}, claim, (_piece("p1", (Q(0), x, -x), 1, h, rows),))


def faster_atlas() -> PeriodicAtlas:
    """x = 1, a from 0 to 1."""
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1)), Q(0), 1, 1, "a")
    piece = _piece("p1", (Q(1, 2), Q(0)), 0, Q(1, 2), [[Q(1)]])
    return PeriodicAtlas("faster", "Faster and faster", FASTER, {}, claim, (piece,))


def levels_atlas(a: str = "1/2") -> PeriodicAtlas:
    """Over the levels of x^2 + y^2, x from -1.25 to -0.75, z = a x/2."""
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1), Q(0)), Q(0), 1, 1)
    x, h, value = Q(-1), Q(1, 4), Q(a)
    piece = _piece("p1", (x, Q(0)), 0, h, [[value * x / 2, value * h / 2]])
    return PeriodicAtlas("levels", "Over the levels", LEVELS, {"a": value}, claim, (piece,))


def tilted_atlas() -> PeriodicAtlas:
    """Over the levels, from the section x + y/2 = 1: y from -0.1 to 0.1, where x changes with it; z = (x - y)/4."""
    claim = PeriodicCurveClaim("periodic-arc", (Q(1), Q(1, 2), Q(0)), Q(1), -1, 1)
    piece = _piece("p1", (Q(0), Q(0)), 0, Q(1, 10), [[Q(1, 4), Q(-3, 80)]])
    return PeriodicAtlas("tilted", "Over the levels", LEVELS, {"a": Q(1, 2)}, claim, (piece,))


TWISTING = shared.define_system(
    {
        "name": "twisting", "state": "x y u v", "parameters": "a",
        "field": lambda x, y, u, v, a: (y, -x, v, -a * u),
        "first_integral": lambda x, y, u, v, a: x * x + y * y + v * v + a * u * u,
    }
)  # fmt: skip
"""Where u = v = 0 the orbits have the period 2 pi, and the multipliers exp(2 pi i a^(1/2)) and its inverse."""


def twisting_atlas(low: Q, high: Q) -> PeriodicAtlas:
    """On the level 1, x = 1, a from `low` to `high`."""
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1), Q(0), Q(0)), Q(0), -1, 1, "a", Q(1))
    piece = _piece("p1", ((low + high) / 2, Q(0), Q(0), Q(0)), 0, (high - low) / 2, [[Q(1)], [Q(0)], [Q(0)]])
    return PeriodicAtlas("twisting", "Twisting", TWISTING, {}, claim, (piece,))


OSCILLATOR = shared.define_system(
    {
        "name": "oscillator", "state": "x y", "parameters": "a", "field": lambda x, y, a: (a * y, -a * x),
        "first_integral": lambda x, y, a: x * x + y * y,
    }
)  # fmt: skip
"""Circles, run through in the time 2 pi/a; both multipliers are 1."""


def oscillator_atlas() -> PeriodicAtlas:
    """On the level 1, x = -1, a from 1.25 to 1.75."""
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1)), Q(0), 1, 1, "a", Q(1))
    piece = _piece("p1", (Q(3, 2), Q(0)), 0, Q(1, 4), [[Q(-1)]])
    return PeriodicAtlas("oscillator", "In the plane", OSCILLATOR, {}, claim, (piece,))


def _flipping(x: Any, y: Any, u: Any, v: Any) -> tuple[Any, Any, Any, Any]:
    rate = (1 - x * x - y * y) / 8
    return rate * x - y, rate * y + x, v / 2, -u / 2


FLIPPING = shared.define_system(
    {"name": "flipping", "state": "x y u v", "field": _flipping, "first_integral": lambda x, y, u, v: u * u + v * v}
)
"""After one turn of (x, y) the point (u, v) is at (-u, -v), on the same level."""


def flipped_atlas() -> PeriodicAtlas:
    """x = 1, v = 0, u from 0.5 to 1.5: all equations hold after one turn but that for u."""
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1), Q(0), Q(0)), Q(0), 1, 1)
    piece = _piece("p1", (Q(0), Q(1), Q(0)), 1, Q(1, 2), [[Q(1)], [Q(0)]])
    return PeriodicAtlas("flipped", "No curve", FLIPPING, {}, claim, (piece,))


def on_level_atlas(level: str = "1") -> PeriodicAtlas:
    """On the level x^2 + y^2 = 1, x = -1 and z = -a/2, a from 0.25 to 0.75."""
    claim = PeriodicCurveClaim("periodic-arc", (Q(0), Q(1), Q(0)), Q(0), 1, 1, "a", Q(level))
    piece = _piece("p1", (Q(1, 2), Q(0), Q(0)), 0, Q(1, 4), [[Q(-1)], [Q(-1, 4), Q(-1, 8)]])
    return PeriodicAtlas("on-level", "On a level", LEVELS, {}, claim, (piece,))


def _arc_of_circle(name: str, angle: float) -> Piece:
    """|p_0| <= 0.35 on the tangent of the circle a^2 + (x - 2)^2 = 1, p_1 across it, to 18 digits."""
    half_width, t = Q(7, 20), Q(tan(angle / 2))
    cosine, sine = (Q(round(2**60 * value), 2**60) for value in ((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)))
    row, factor = [Q(0)], Q(1)
    for k in range(1, 15):
        factor *= (k - 1 - Q(1, 2)) / k
        row += [Q(0), Q(round(2**80 * factor * half_width ** (2 * k)), 2**80)]
    frame = ((-sine, cosine), (cosine, sine))
    return Piece(
        name, "regular", (cosine, 2 + sine), frame, half_width, (tuple(row),), (Q(1, 10**6),), "physical"
    )  # fmt: skip


def closed_atlas(angles: Sequence[float] = ROUND, **claim: Any) -> tuple[PeriodicAtlas, tuple[IntervalResult, ...]]:
    """Parts of the closed curve about points at these angles, and what is true of them, without an integration."""
    stated = PeriodicCurveClaim("periodic-loop", (Q(0), Q(1)), Q(0), 1, 1, "a")
    pieces = tuple(_arc_of_circle(f"p{number}", angle) for number, angle in enumerate(angles))
    bounds = ((Q(1, 10**9),), (Q(1, 10**7),), arb(2 * pi, 2.0**-20))
    results = tuple(IntervalResult(piece.id, WHOLE, PROVED, Computation(0.0), None, *bounds) for piece in pieces)
    return PeriodicAtlas("closed", "A closed curve", CLOSED, {}, replace(stated, **claim), pieces), results


ATLASES: Mapping[str, PeriodicAtlas] = {
    atlas.id: atlas for atlas in (turning_atlas(), twice_atlas(), levels_atlas(), tilted_atlas(), on_level_atlas())
}


def attempt(
    atlas: PeriodicAtlas,
    number: int = 0,
    limits: PeriodicLimits = LIMITS,
    interval: tuple[Fraction, Fraction] = WHOLE,
    oracle: FramingWideOracle = ORACLE,
) -> PieceResult[ProvedInterval]:
    """One piece, by default over all of s."""
    return prove_periodic_piece(atlas, atlas.curve_pieces()[number], interval, oracle, limits)


@cache
def proved(name: str) -> tuple[IntervalResult, ...]:
    """What is found for all pieces of an atlas."""
    atlas = ATLASES[name]
    return tuple(attempt(atlas, number).stored for number in range(len(atlas.pieces)))


def shifted(atlas: PeriodicAtlas, by: Q, number: int = 0, row: int = 0) -> PeriodicAtlas:
    """With a constant added to a polynomial of a piece."""
    pieces = list(atlas.curve_pieces())
    rows = [list(each) for each in pieces[number].polynomial]
    rows[row][0] += by
    pieces[number] = replace(pieces[number], polynomial=tuple(map(tuple, rows)))
    return replace(atlas, pieces=tuple(pieces))


def refused(atlas: PeriodicAtlas, results: Sequence[IntervalResult]) -> str:
    """The condition and the message for which a curve is not proved."""
    outcome = conclude_periodic(atlas, results).outcome
    assert isinstance(outcome, NotProved)
    return f"{outcome.reason.condition}: {outcome.reason.message}"
