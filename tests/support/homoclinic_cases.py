"""Homoclinic and heteroclinic orbits of one's own systems and of the planar three-body problem (sections 40, 41)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction as Q

from orbitproof.shared.claims import HeteroclinicOrbit, HomoclinicCurve, HomoclinicOrbit
from orbitproof.shared.formats import define_system
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import CR3BP_PLANAR

DESCRIBED = {
    "name": "wells", "state": "x y u v", "parameters": "w e", "where": {"z": "x - 1"},
    "field": {"x": "u", "y": "v", "u": "z - z**3 - 2*e*z*y**2", "v": "-w*y - 2*e*z**2*y"},
    "first_integral": "(u**2 + v**2)/2 - z**2/2 + z**4/4 + w*y**2/2 + e*z**2*y**2", "first_integral_name": "energy",
}  # fmt: skip
WELLS = define_system(DESCRIBED)
"""A particle that swings in y where two wells in x meet, at x = 1."""
MULTIPLIER = 20.940258827600452
"""Of x = 1, y = sin(2 t)/2, for w = 4, e = 1/4: in x an equation of Mathieu."""


def wells() -> HomoclinicOrbit:
    """Of x = 1 at the energy 1/2."""
    return HomoclinicOrbit(
        "wells", WELLS, {"w": Q(4), "e": Q(1, 4)}, reversing_symmetry=(1, -1, -1, 1), section="y", level=Q(1, 2),
        level_coordinate="v", level_sign=1, crossings=2, arrival=6, slope=parse_exact("0x1f2dbda6698feb8d7p-65"),
        cone=Q(7, 2**16), centre=(Q(1), Q(12626638772568271387, 2**75)), radii=(Q(9, 2**14), Q(11, 2**39)),
    )  # fmt: skip


def wells_on_levels() -> HomoclinicCurve:
    """Of x = 1 at the energies from 0.499 to 0.501."""
    rows = (Q(1), Q(0)), (Q("3.3422434542e-4"), Q("1.7788e-7"), Q("5e-11")), (Q("0.9743336"), Q("-5.271e-5"))
    return _on_levels(wells(), Q("0.001"), rows, Q("4e-4"), (Q("5e-4"), Q("2.5e-9")))


def _on_levels(
    one: HomoclinicOrbit, reach: Q, rows: Sequence[Sequence[Q]], cone: Q, radii: tuple[Q, Q]
) -> HomoclinicCurve:
    (c, *_), (a, *_), (slope, *_) = rows
    middle = replace(one, centre=(c, a), slope=slope, cone=cone, radii=radii)
    given = {each.name: getattr(middle, each.name) for each in fields(middle)}
    return HomoclinicCurve(level_radius=reach, powers=tuple(tuple(row[1:]) for row in rows), **given)


def jupiter() -> HomoclinicOrbit:
    """Of the Lyapunov orbit about L1 with C = 3.03 in the units of Wilczak and Zgliczynski."""
    mu = Q("0.0009537")
    return HomoclinicOrbit(
        "L1", CR3BP_PLANAR, {"mu": mu}, reversing_symmetry=(1, -1, -1, 1), section="y", level=Q("3.03") - mu * (1 - mu),
        level_coordinate="vy", level_sign=1, crossings=2, arrival=7, slope=Q("2.5733012193647429351"), cone=Q("2e-8"),
        centre=(Q("0.920803491320743247190172918050642056"), Q("-2.107686028449205278722206960e-12")),
        radii=(Q("3e-12"), Q("1e-19")),
    )  # fmt: skip


def jupiter_on_levels() -> HomoclinicCurve:
    """For all C within 0.0001 of 3.03."""
    c = (9208034913207432471902, 495778207379520901, 1135186762567977, 12015804067991, 58679618576, 476291523, 3575718)
    a = (-2107686028, 29308128, -288764, 1727, -12)
    slope = (257330121936, 229839481, 484654, 2689, 20)
    rows = [[Q(n, 10**digits) for n in row] for row, digits in ((c, 22), (a, 21), (slope, 11))]
    return _on_levels(jupiter(), Q("0.0001"), rows, Q("4e-7"), (Q("3.25e-12"), Q("3e-17")))


def beyond_jupiter() -> HomoclinicOrbit:
    """Of the Lyapunov orbit about L2 on the same level, through the outer region."""
    return replace(
        jupiter(), id="L2", level_sign=-1, slope=parse_exact("0x12411bc3a411aeee1p-63"), cone=Q(3, 2**26),
        centre=tuple(map(parse_exact, ("0x8a7caa594823170d0f97e314e9377e2a02e3p-143", "0x1cb8b58b977372d15p-104"))),
        radii=(Q(11, 2**42), Q(15, 2**67)),
    )  # fmt: skip


HILLS_DESCRIBED = {
    "name": "hills", "state": "x y u v", "parameters": "w e d", "where": {"f": "w + e*(3*x - x**3)"},
    "field": {"x": "u", "y": "v", "u": "(x**2 - 1)*(x + 3*d + 3*e*y**2/2)", "v": "-y*f"},
    "first_integral": "(u**2 + v**2)/2 - (x**2 - 1)**2/4 + d*(3*x - x**3) + f*y**2/2", "first_integral_name": "energy",
}  # fmt: skip
HILLS = define_system(HILLS_DESCRIBED)
"""A particle between two hills, at x = -1 and x = 1, on which it can swing in y: y = A sin(f^(1/2) t)."""


def hills() -> HeteroclinicOrbit:
    """From x = -1, where the square of the frequency is 15/4, to x = 1, where it is 17/4, at the energy 1/2."""
    return HeteroclinicOrbit(
        "hills", HILLS, {"w": Q(4), "e": Q(1, 8), "d": Q(-1, 128)}, reversing_symmetry=(1, -1, -1, 1), section="y",
        level=Q(1, 2), level_coordinate="v", level_sign=(1, 1), returns=(2, 2), arrival=(6, 6),
        slope=(parse_exact("0x5adacf0cf0c5d011p-62"), parse_exact("0x5a2600a281f6c5bbp-62")),
        cone=(Q(9, 2**13), Q(3, 2**12)),
        centre=(Q(-1), parse_exact("0x71248758f1a6919bp-81"), Q(1), parse_exact("-0x1a6750d2f8e8d4967p-83")),
        radii=(Q(11, 2**21), Q(13, 2**39), Q(5, 2**20), Q(3, 2**37)),
    )  # fmt: skip


def oterma() -> HeteroclinicOrbit:
    """From the Lyapunov orbit about L1 to that about L2 on the level of `jupiter`."""
    centre = (
        "0xebb9c71143e4f092585d293c8148e687p-128", "0x10e0c5d5d774d02fdp-97", "0x453e552ca4118b8687cbf18a749bbf15p-126",
        "-0x7c5bed2c4ff21761p-95",
    )  # fmt: skip
    slope = parse_exact("0x14961ef31f6d8da25p-63"), parse_exact("0x12411bc3a411aeee1p-63")
    first, second = (
        replace(jupiter(), level_sign=sign, arrival=arrival, slope=each, cone=Q(cone, 2**22))
        for sign, arrival, each, cone in zip((1, -1), (6, 5), slope, (15, 26), strict=True)
    )
    return replace(
        HeteroclinicOrbit.between("oterma", first, second), centre=tuple(map(parse_exact, centre)),
        radii=(Q(13, 2**36), Q(9, 2**76), Q(3, 2**33), Q(1, 2**72)),
    )  # fmt: skip
