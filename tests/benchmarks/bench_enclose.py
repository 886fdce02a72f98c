"""Time, widths and digits of validated maps, beside integrators that compute and prove nothing.

python tests/benchmarks/bench_enclose.py                         print the tables
python tests/benchmarks/bench_enclose.py -o docs/benchmarks.md   write the page with them

One half period of a CR3BP halo orbit, and one return of Lorenz's system, both from a point; then their Poincare maps
with derivatives up to order 3 on a box. scipy (DOP853, relative tolerance 1e-13) and, where they can be imported,
heyoka in double precision and with as many bits as the enclosure. Digits are those in which a number agrees with the
enclosure of a run with more bits. Seconds are of processor time, the least of five runs.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from flint import arb, ctx
from scipy.integrate import solve_ivp

from orbitproof.shared import CR3BP, EARTH_MOON, System, define_system
from orbitproof.verify import enclose
from orbitproof.verify.enclose import Box, Enclosure, Section

LORENZ = define_system({
    "name": "lorenz", "state": "x y z", "parameters": "sigma rho beta",
    "field": {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"},
})  # fmt: skip
HALO = {"x": "0.843193964637", "y": 0, "z": "0.165", "vx": 0, "vy": "0.263718532564", "vz": 0, "mu": EARTH_MOON}
WING = {"x": "-13.763610682134", "y": "-19.578751942452", "z": 27, "sigma": 10, "rho": 28, "beta": "8/3"}
CASES: Sequence[tuple[str, System, Mapping[str, Any], Section, int, Sequence[str], int]] = (
    ("Halo orbit, half a period", CR3BP, HALO, enclose.section("y"), -1, ("x", "z", "vy"), 1),
    ("Lorenz, one return of orbit AB", LORENZ, WING, enclose.section("z", 27), 1, ("x", "y"), 2),
)
BITS = (128, 176, 256)
RADIUS = "1e-12"
REPEATS = 5


def timed(call: Callable[[], Any]) -> tuple[Any, float]:
    """A result, and the least processor time of some runs."""
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        result = call()
        times.append(time.process_time() - begin)
    return result, min(times)


def digits(value: float | arb, exact: arb) -> str:
    """Decimal digits in which a number, or a ball with its radius, agrees with an enclosure."""
    error = abs(arb(value) - exact).upper() / abs(exact)
    return f"{float(-error.log().mid() / arb(10).log().mid()):.1f}" if error > 0 else "all"


def mapped(system: System, box: Box, section: Section, direction: int, crossings: int, **options: Any) -> Enclosure:
    """The Poincare map of a case."""
    found = enclose.poincare_map(system, box, section, direction=direction, crossings=crossings, **options)
    if not isinstance(found, Enclosure):
        raise SystemExit(str(found))
    return found


def by_scipy(
    system: System, centre: Mapping[str, Any], section: Section, direction: int, crossings: int
) -> list[float]:
    """The state at the crossing, in float64."""
    values = {name: float(value) for name, value in enclose.box(centre).centre.items()}
    parameters = [values[name] for name in system.parameters]
    normal = np.array([float(section.normal.get(name, 0)) for name in system.state])

    def field(_time: float, state: Any) -> Any:
        return system.vector_field(list(state), parameters)

    def event(_time: float, state: Any) -> float:
        return float(normal @ state) - float(section.value)

    event.direction, event.terminal = direction, crossings + (crossings > 1)  # type: ignore[attr-defined]
    start = [values[name] for name in system.state]
    done = solve_ivp(field, (0, 20), start, "DOP853", events=event, rtol=1e-13, atol=1e-15)
    return [float(x) for x in done.y_events[0][-1]]


def by_heyoka(
    system: System, centre: Mapping[str, Any], until: arb, bits: int, free: Sequence[str] = (), order: int = 0
) -> tuple[list[Any], float]:
    """The state at a time, and the seconds of the integration alone; `bits` 53 for doubles.

    With an order also all derivatives up to it, by the free coordinates.
    """
    import heyoka as hy

    exact = enclose.box(centre).centre
    number: Callable[[Any], Any] = float if bits == 53 else lambda value: hy.real(str(value), bits)
    kind = float if bits == 53 else hy.real
    variables = hy.make_vars(*system.state)
    constants = [number(exact[name].numerator) / number(exact[name].denominator) for name in system.parameters]
    equations = list(zip(variables, system.vector_field(list(variables), constants), strict=True))
    start = [number(exact[name].numerator) / number(exact[name].denominator) for name in system.state]
    more = {} if bits == 53 else {"prec": bits}
    if order:
        of = dict(zip(system.state, variables, strict=True))
        equations = hy.var_ode_sys(equations, [of[name] for name in free], order=order)
        more["compact_mode"] = True
    integrator = hy.taylor_adaptive(equations, np.array(start), fp_type=kind, **more)
    end = number(until.mid().str(80, radius=False))
    beginning = integrator.state.copy()

    def run() -> list[Any]:
        integrator.time, integrator.state[:] = number("0") if bits != 53 else 0.0, beginning
        integrator.propagate_until(end)
        return list(integrator.state[: len(start)])

    return timed(run)


def compare(
    name: str, system: System, centre: Any, section: Section, direction: int, free: Any, crossings: int
) -> Iterator[str]:
    """The lines of a case's table."""
    yield f"\n## {name}\n"
    yield "| | seconds | digits | width of the widest ball |"
    yield "| --- | --- | --- | --- |"
    point = enclose.box(centre)
    best = mapped(system, point, section, direction, crossings, precision=512)
    watched = [each for each in system.state if abs(best.centre.value[each]) > 1e-3]

    def row(label: str, seconds: float, values: Mapping[str, Any], width: str = "proves nothing") -> str:
        worst = min((digits(values[each], best.centre.value[each]) for each in watched), key=float)
        return f"| {label} | {seconds:.2g} | {worst} | {width} |"

    for bits in BITS:
        found, seconds = timed(lambda bits=bits: mapped(system, point, section, direction, crossings, precision=bits))
        widest = max(ball.rad() for ball in found.value.values())
        yield row(f"from a point, {bits} bits", seconds, found.centre.value, f"{float(2 * widest):.1e}")
    box = enclose.box(centre, radii=dict.fromkeys(free, RADIUS))
    for order in (1, 2, 3):
        found, seconds = timed(
            lambda order=order: mapped(system, box, section, direction, crossings, derivatives=order, precision=176)
        )
        slopes = max(ball.rad() for row_of in found.jacobian.values() for ball in row_of)
        width = f"{float(2 * slopes):.1e}, of a first derivative"
        yield row(f"box of radius {RADIUS}, derivatives to order {order}, 176 bits", seconds, found.centre.value, width)
    state, seconds = timed(lambda: by_scipy(system, centre, section, direction, crossings))
    yield row(f"scipy {scipy.__version__}, DOP853", seconds, dict(zip(system.state, state, strict=True)))
    try:
        import heyoka
    except ImportError:
        yield "| heyoka, which is not installed here | | | |"
        return
    for bits, order in ((53, 0), *((bits, 0) for bits in BITS), *((176, order) for order in (1, 2, 3))):
        state, seconds = by_heyoka(system, centre, best.centre.time, bits, free, order)
        text = [arb(str(value)) for value in state]
        kind = "double precision" if bits == 53 else f"{bits} bits"
        yield row(
            f"heyoka {heyoka.__version__}, {kind}, "
            + (f"derivatives to order {order}, " if order else "")
            + "without the section",
            seconds,
            dict(zip(system.state, text, strict=True)),
        )


PAGE = """# Benchmarks

What an enclosure costs beside integrators that compute and prove nothing. Made by

```sh
pip install heyoka
python tests/benchmarks/bench_enclose.py -o docs/benchmarks.md
```

on one core of a small virtual machine. Seconds are of processor time, the least of five runs, without the time in which
heyoka compiles a system.

- *Digits* are those in which the worst coordinate agrees with an enclosure of 512 bits; a ball counts with its radius.
- *Widths* are of the widest ball.
- *From a point* is one orbit up to its crossing of the section.
- *A box* has the Poincaré map of all its points, with all partial derivatives to an order. heyoka's derivatives are by
  the same coordinates, at one point.
- *The half period* is that of a halo orbit of the Earth-Moon system; the return of Lorenz's system is once around
  the orbit AB.

What the enclosures say, and what they do not: [validated integration](validated-integration.md).
"""


OTHER = "\n## Against an earlier version\n"
"""What stands from here on is made by another benchmark, and kept."""


def main() -> None:
    """Print the tables, and write the page if that is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="the page to write")
    options = parser.parse_args()
    lines = []
    with ctx.workprec(640):
        for case in CASES:
            for line in compare(*case):
                print(line, flush=True)
                lines.append(line)
    if options.output is not None:
        before = options.output.read_text("utf-8") if options.output.is_file() else ""
        rest = before.partition(OTHER)
        options.output.write_text(PAGE + "\n".join(lines) + "\n" + "".join(rest[1:]), encoding="utf-8")


if __name__ == "__main__":
    main()
