"""Claims about Neimark-Sacker bifurcations: with closed forms, and of published systems."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from flint import arb, ctx
from support.systems import described

from orbitproof.shared.formats import PERIODIC_TORUS, PeriodicBifurcation
from orbitproof.shared.systems import System
from orbitproof.verify.evidence import enclose, exact_value

ROUND = described(
    name="round",
    state="x y z",
    parameters="a w b c d",
    where={"q": "x**2 + y**2 - 1"},
    field={"x": "-w*z*x/2 - y", "y": "x - w*z*y/2", "z": "w*q + 2*a*z + b*z**3 + c*q*z + d*z**2"},
)
"""The unit circle, period 2 pi, multipliers exp(2 pi (a +- i sqrt(w^2 - a^2))).

With x^2 + y^2 = exp(v) it is a rotation and v' = -w z, z' = w (exp(v) - 1) + 2 a z + b z^3 + c (exp(v) - 1) z + d z^2.
At a = 0 the latter has the first Lyapunov coefficient 3 b/8 - c d/(8 w) for the coordinate v + i z, by the formula of
J. Guckenheimer and P. Holmes (Nonlinear oscillations, dynamical systems, and bifurcations of vector fields, 3.4).
"""

BENT = described(
    name="bent",
    state="x y h",
    parameters="a w b c d",
    where={
        "q": "x**2 + y**2 - 1",
        "z": "h - x**2 + y**2",
        "i": "-w*z*x/2 - y",
        "j": "x - w*z*y/2",
    },
    field={"x": "i", "y": "j", "h": "w*q + 2*a*z + b*z**3 + c*q*z + d*z**2 + 2*x*i - 2*y*j"},
)
"""`ROUND` with h = z + x^2 - y^2: the circle crosses planes h = constant twice in each direction."""

PRODUCT = described(
    name="product",
    state="x y u v",
    parameters="a w d k",
    where={"s": "k*(1 - x**2 - y**2)", "q": "a + d*(u**2 + v**2)"},
    field={"x": "x*s - y", "y": "x + y*s", "u": "q*u - w*v", "v": "w*u + q*v"},
)
"""The unit circle, period 2 pi, multipliers exp(-4 pi k) and exp(2 pi (a +- i w)); u + i v is in normal form."""

LANGFORD = described(
    name="langford",
    state="x y z",
    parameters="a b l w r e",
    field={
        "x": "(z - b)*x - w*y",
        "y": "w*x + (z - b)*y",
        "z": "l + a*z - z**3/3 - (x**2 + y**2)*(1 + r*z) + e*z*x**3",
    },
)

CIRCUIT = described(
    name="circuit",
    state="x y z",
    parameters="nu beta gamma r a b e",
    where={"c": "b*(y - x)**3"},
    field={
        "x": "(beta*y - (beta + nu)*x - a*x**3 + c)/r",
        "y": "beta*x - (beta + gamma)*y - z - c",
        "z": "y + e",
    },
)

WIDTH, KERNEL_WIDTH = Fraction(1, 2**40), Fraction(1, 2**28)
ONE, ZERO = Fraction(1), Fraction(0)


def on_circle(turns: Fraction) -> tuple[Fraction, Fraction]:
    """Cosine and sine of 2 pi times a number, about."""
    with ctx.workprec(160):
        angle = 2 * arb.pi() * turns.numerator / turns.denominator
        return _near(angle.cos()), _near(angle.sin())


def _near(value: arb) -> Fraction:
    """A number of 120 bits after the point."""
    return Fraction(round(exact_value(value.mid()) * 2**120), 2**120)


def in_plane(system: System, place: int, centre: list[Fraction], **more: Any) -> PeriodicBifurcation:
    """A claim about a box in the plane where a coordinate has its value at the centre."""
    size = len(centre)
    claim: dict[str, Any] = {
        "id": "torus",
        "kind": PERIODIC_TORUS,
        "system": system,
        "normal": tuple(Fraction(int(i == place)) for i in range(size)),
        "offset": centre[place],
        "direction": 1,
        "crossings": 1,
        "centre": tuple(centre),
        "frame": tuple(tuple(Fraction(int(i == j)) for j in range(size) if j != place) for i in range(size)),
        "radii": (WIDTH,) * (size - 1),
        "parameter_radius": WIDTH,
        "kernel_radius": KERNEL_WIDTH,
    }
    return PeriodicBifurcation(**(claim | more))


def round_claim(
    w: Fraction = Fraction(2, 7),
    b: Fraction = Fraction(-1, 3),
    c: Fraction = ONE,
    d: Fraction = Fraction(1, 2),
    **more: Any,
) -> PeriodicBifurcation:
    """The unit circle of `ROUND` at a = 0, through (1, 0, 0); v = 2 (x - 1) there to first order."""
    given: dict[str, Any] = {
        "parameters": {"a": ZERO, "w": w, "b": b, "c": c, "d": d},
        "parameter": "a",
        "kernel": ((Fraction(1, 4), ZERO), (ZERO, Fraction(-1, 2))),
        "multiplier": on_circle(w),
        **more,
    }
    return in_plane(ROUND, 1, [ONE, ZERO, ZERO], **given)


def bent_claim(**more: Any) -> PeriodicBifurcation:
    """The circle of `BENT` at a = 0, through (3/5, 4/5, -7/25), where h falls, as it does through (-3/5, -4/5, -7/25).

    The vector (x/4, y/4, -i/2) of `round_claim` at this point, moved along the flow into the section, times 24/5.
    """
    given: dict[str, Any] = {
        "parameters": {"a": ZERO, "w": Fraction(2, 7), "b": Fraction(-1, 3), "c": ONE, "d": Fraction(1, 2)},
        "parameter": "a",
        "direction": -1,
        "crossings": 2,
        "kernel": ((ONE, Fraction(3, 4)), (ONE, Fraction(-3, 4))),
        "multiplier": on_circle(Fraction(2, 7)),
        **more,
    }
    return in_plane(BENT, 2, [Fraction(3, 5), Fraction(4, 5), Fraction(-7, 25)], **given)


def product_claim(
    w: Fraction = Fraction(1, 5), d: Fraction = Fraction(-1), k: Fraction = Fraction(1, 4), **more: Any
) -> PeriodicBifurcation:
    """The unit circle of `PRODUCT` at a = 0, through (1, 0, 0, 0)."""
    given: dict[str, Any] = {
        "parameters": {"a": ZERO, "w": w, "d": d, "k": k},
        "parameter": "a",
        "kernel": ((ZERO, Fraction(1, 2), ZERO), (ZERO, ZERO, Fraction(-1, 2))),
        "multiplier": on_circle(w),
        **more,
    }
    return in_plane(PRODUCT, 1, [ONE, ZERO, ZERO, ZERO], **given)


def langford(**more: Any) -> PeriodicBifurcation:
    """W. F. Langford's system with the usual constants b = 0.7, l = 0.6, w = 3.5, r = 0.25 and e = 0.1."""
    constants = {"a": "0.6975876603263874369232219", "b": "0.7", "l": "0.6", "w": "3.5", "r": "0.25", "e": "0.1"}
    given: dict[str, Any] = {
        "id": "langford",
        "parameters": {name: Fraction(value) for name, value in constants.items()},
        "parameter": "a",
        "kernel": (
            (Fraction("-0.0180870035129995108744403"), Fraction("0.8567403065012767781118698")),
            (Fraction("-0.5154330970160749425401072"), Fraction("-0.0007550321048256230239939")),
        ),
        "multiplier": (Fraction("-0.8059013843527961074751048"), Fraction("0.5920497941037111798207800")),
        **more,
    }
    centre = [Fraction("0.9067071875616361603823729"), ZERO, Fraction("0.6999425160293761564796199")]
    return in_plane(LANGFORD, 1, centre, **given)


def symmetric_langford(**more: Any) -> PeriodicBifurcation:
    """The same with e = 0: in r, z it is r' = (z - b) r, z' = l + a z - z^3/3 - r^2 (1 + R z), R the last constant.

    The cycle has z = b and r^2 (1 + R b) = l + a b - b^3/3; the trace a - b^2 - R r^2 vanishes for
    a = b^2 + R (l + 2 b^3/3), and then the eigenvalues are +-i omega, omega^2 = 2 r^2 (1 + R b).
    """
    b, l, w, constant = Fraction(7, 10), Fraction(3, 5), Fraction(7, 2), Fraction(1, 4)
    a = b**2 + constant * (l + 2 * b**3 / 3)
    with ctx.workprec(200):
        factor = enclose(1 + constant * b)
        radius = (enclose(l + a * b - b**3 / 3) / factor).sqrt()
        omega = (2 * factor).sqrt() * radius
        angle = omega * 2 * arb.pi() / enclose(w)
        x, slope, c, s = (_near(value) for value in (radius, omega / radius, angle.cos(), angle.sin()))
    given: dict[str, Any] = {
        "id": "symmetric",
        "parameters": {"a": a, "b": b, "l": l, "w": w, "r": constant, "e": ZERO},
        "parameter": "a",
        "kernel": ((ONE, ZERO), (ZERO, slope)),
        "multiplier": (c, s),
        **more,
    }
    return in_plane(LANGFORD, 1, [x, ZERO, b], **given)


def circuit(**more: Any) -> PeriodicBifurcation:
    """An electronic circuit, with the constants of the manual of MatCont."""
    constants = {
        "nu": "-0.5957505526271184866934771", "beta": "0.5", "gamma": "-0.6", "r": "0.6", "a": "0.32858",
        "b": "0.93358", "e": "0.001",
    }  # fmt: skip
    given: dict[str, Any] = {
        "id": "circuit",
        "parameters": {name: Fraction(value) for name, value in constants.items()},
        "parameter": "nu",
        "kernel": (
            (Fraction("0.8293875121775977380004670"), Fraction("0.5483768296477473207005071")),
            (Fraction("0.0000857283782730948418054"), Fraction("0.1067673672516718226210138")),
        ),
        "multiplier": (Fraction("0.5742927953829709224620006"), Fraction("0.8186499772010093276311589")),
        **more,
    }
    centre = [Fraction("-0.0948715889624298807842728"), Fraction("-0.001"), Fraction("-0.1483472864987093806570425")]
    return in_plane(CIRCUIT, 1, centre, **given)
