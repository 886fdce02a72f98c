"""Bits that enclosures lose in flows that contract, beside what is lost at least.

python tests/benchmarks/bench_contracting.py

A point is followed to times 2 and 10 with 256 bits. Between the two its errors grow by so many bits a unit of time; the
flow's derivative grows by so many (*true*), and no enclosure can lose less for long. *Before* is commit 65d25d4d, whose
bounds had no frame. CAPD's method, an orthogonal frame that is carried from step to step, was tried in floats for the
systems; for Lorenz's CAPD 6.1 itself was measured, with its default settings. Then boxes, whose widths CAPD gives too.
Seconds are of processor time.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any

from flint import arb

from orbitproof.shared import System, define_system
from orbitproof.verify import enclose

BITS = 256
BEGIN, END = 2, 10


def system(name: str, state: str, parameters: str, **field: str) -> System:
    """A system from formulas."""
    return define_system({"name": name, "state": state, "parameters": parameters, "field": field})


LORENZ = system("Lorenz", "x y z", "sigma rho beta", x="sigma*(y - x)", y="x*(rho - z) - y", z="x*y - beta*z")
ROESSLER = system("Roessler", "x y z", "a b c", x="-y - z", y="x + a*y", z="b + z*(x - c)")
VAN_DER_POL = system("van-der-pol", "x y", "mu", x="y", y="mu*(1 - x**2)*y - x")
CHUA = system("Chua", "x y z", "alpha b c", x="alpha*(y - x**3 - c*x)", y="x - y + z", z="-b*y")
BRUSSELATOR = system("Brusselator", "x y", "a b", x="a - (b + 1)*x + x**2*y", y="b*x - x**2*y")
WING: Mapping[str, Any] = {
    "x": "-13.763610682134", "y": "-19.578751942452", "z": 27, "sigma": 10, "rho": 28, "beta": "8/3"
}  # fmt: skip

POINTS: tuple[tuple[str, System, Mapping[str, Any], str, str], ...] = (
    ("Lorenz", LORENZ, WING, "27.2", "1.6, measured"),
    ("Roessler", ROESSLER, {"x": -5, "y": -5, "z": "0.02", "a": "0.2", "b": "0.2", "c": "5.7"}, "10.1", "0.54"),
    ("Van der Pol, mu = 1", VAN_DER_POL, {"x": 2, "y": 0, "mu": 1}, "3.7", "0.29"),
    ("Van der Pol, mu = 10", VAN_DER_POL, {"x": 2, "y": 0, "mu": 10}, "23", "0.26"),
    (
        "Chua", CHUA, {"x": "0.5", "y": "0.1", "z": "-0.3", "alpha": "8.697433705", "b": "100/7", "c": "-1/7"},
        "8.4", "1.1",
    ),
)  # fmt: skip
"""Name, system, point, and bits a unit of time that were lost before, and that CAPD's method loses."""

BOXES: tuple[tuple[str, System, Mapping[str, Any], str, int, str], ...] = (
    ("Lorenz", LORENZ, WING, "0", 10, ""),
    ("Lorenz", LORENZ, WING, "1e-10", 5, "4.5e-08"),
    ("Lorenz", LORENZ, WING, "1e-10", 10, ""),
    ("Lorenz", LORENZ, WING, "1e-12", 5, "2.7e-09"),
    ("Brusselator", BRUSSELATOR, {"x": 1, "y": 1, "a": 1, "b": 3}, "1e-3", 5, "6.4e-04"),
)
"""Name, system, centre, radius in all coordinates, time, and CAPD's radius after that time."""


def widest(balls: Mapping[str, arb]) -> arb:
    """The largest radius."""
    return max(ball.rad() for ball in balls.values())


def bits_of(value: arb) -> float:
    """The logarithm to the base 2."""
    return float((value.log() / arb(2).log()).mid())


def of_point(name: str, of: System, point: Mapping[str, Any], before: str, other: str) -> str:
    """A line of the first table."""
    begin = time.process_time()
    values = [enclose.flow(of, enclose.box(point), t, derivatives=0, precision=BITS) for t in (BEGIN, END)]
    seconds = time.process_time() - begin
    lost = "not enclosed"
    if all(values):
        first, last = (bits_of(widest(value.value)) for value in values)
        lost = f"{(last - first) / (END - BEGIN):.2f}"
    return f"| {name} | {before} | {lost} | {growth(of, point)} | {other} | {seconds:.2g} |"


def growth(of: System, point: Mapping[str, Any]) -> str:
    """The bits a unit of time by which the derivative of the flow by the state grows."""
    box = enclose.box(point, radii=dict.fromkeys(of.state, "1e-90"))
    sizes = []
    for t in (BEGIN, END):
        found = enclose.flow(of, box, t, precision=512)
        if not found:
            return "not enclosed"
        sizes.append(max(abs(slope).mid() for row in found.centre.jacobian.values() for slope in row))
    return f"{(bits_of(sizes[1]) - bits_of(sizes[0])) / (END - BEGIN):.2f}"


def of_box(name: str, of: System, centre: Mapping[str, Any], radius: str, until: int, other: str) -> Iterator[str]:
    """Lines of the second table."""
    box = enclose.box(centre, radii={} if radius == "0" else dict.fromkeys(of.state, radius))
    for degree in (1, 2) if box.radii else (1,):
        begin = time.process_time()
        found = enclose.flow(of, box, until, degree=degree, precision=128)
        seconds = time.process_time() - begin
        width = f"{float(widest(found.value)):.1e}" if found else f"ends at {found.reason.reached:.2g}"
        yield f"| {name} | {radius} | {until} | {degree} | {width} | {other} | {seconds:.2g} |"


def of_return(degree: int) -> str:
    """The radius of the derivative of Lorenz's return map over a box of radius 1e-6."""
    begin = time.process_time()
    box = enclose.box(WING, radii=dict.fromkeys("xy", "1e-6"))
    found = enclose.poincare_map(LORENZ, box, enclose.section("z", 27), direction=1, degree=degree, precision=128)
    seconds = time.process_time() - begin
    width = f"{float(max(slope.rad() for row in found.jacobian.values() for slope in row)):.1e}" if found else "none"
    return f"| {degree} | {width} | 2.1e-03 | {seconds:.2g} |"


def main() -> None:
    """Print the tables."""
    print("| bits lost a unit of time | before | now | true | CAPD's method | seconds |\n" + "| --- " * 6 + "|")
    for case in POINTS:
        print(of_point(*case), flush=True)
    print("\n| box | radius | time | degree | radius then | CAPD | seconds |\n" + "| --- " * 7 + "|")
    for each in BOXES:
        for line in of_box(*each):
            print(line, flush=True)
    print(
        "\n| degree | radius of the derivative of Lorenz's return map over 1e-6 | CAPD | seconds |\n"
        + "| --- " * 4
        + "|"
    )
    for degree in (1, 2):
        print(of_return(degree), flush=True)


if __name__ == "__main__":
    main()
