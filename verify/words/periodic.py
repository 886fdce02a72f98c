"""The theorem about a periodic orbit without symmetry in words, and what was found of the orbit (section 24.6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction

from flint import acb, arb

from orbitproof.shared.formats import InSection, PeriodicOrbit
from orbitproof.shared.systems import FORCE_AT_START, Program, System
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.evidence import certain_digits, decimal_interval, dot, enclose, exact_text, located, symmetric
from orbitproof.verify.periodic import Multipliers, PeriodicResults, PeriodicTheorem, PeriodsOfForce, of_orbit
from orbitproof.verify.words.formulas import equations, functions_in_lines

_DIGITS, _SHORT = 40, 15
_TAKEN = ("c", "f", "h", "i", "j", "m", "s", "u")
"""Letters of theorems, which no formula has for a part of it."""


def periodic_in_words(theorem: PeriodicTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    system, m = claim.system, claim.crossings
    fixed = ", ".join(keyed_in_words(system, claim.parameters))
    where = f"{system.title}{f' ({fixed} as in the candidate)' if fixed else ''}"
    level = ""
    if claim.level is not None:
        level = f" and {integral_in_words(claim.system)} = {exact_text(claim.level)}"
    near = "" if claim.level is None else " of its level"
    moved = "the parameters" if claim.level is None else "the parameters and the level"
    times = "exactly once" if m == 1 else f"in exactly {m} points"
    return (
        f"In the box, which lies in the section, there is exactly one point that comes back to itself at crossing "
        f"number {m} of the section in the direction of the candidate{level}, under the flow of the {where}. Its orbit "
        f"is periodic, and within its least period it crosses the section in that direction {times}. At the point the "
        f"derivative of the equations that say so is regular: near it no other point{near} comes back to itself at "
        f"that crossing, and the orbit persists for neighbouring values of {moved}. Whether orbits near it close after "
        "more crossings is not said. The results enclose what they name for this orbit. That the box contains no "
        "point of other periodic orbits, with another number of crossings, is not said."
    )


def periodic_in_full(claim: PeriodicOrbit, theorem: str, found: PeriodicResults) -> Iterator[str]:
    """System, section, box, theorem and what was found, in lines."""
    yield from setting_in_section(claim)
    yield "Theorem."
    yield theorem
    yield from periodic_found(claim, found)


def setting_in_section(claim: InSection) -> Iterator[str]:
    """System, section and box, in lines; of a parameter that varies nothing but its name."""
    system, names = claim.system, names_in_words(claim.system)
    varying = claim.parameter
    state = [names.get(name, name) for name in system.given_state]
    field, taken = field_in_lines(system, _TAKEN)
    yield from field
    fixed = {name: value for name, value in claim.parameters.items() if name != varying}
    for name, value in keyed_in_words(system, fixed).items():
        yield f"  {name} = {exact_text(value)}"
    if names:
        called = ", ".join(f"{new} is called {name}" for name, new in names.items())
        yield f"In the description of the system {called}, which has another meaning here."
    if claim.level is not None and system.first_integral_program is not None:
        yield f"A first integral, the {integral_in_words(claim.system)}:"
        program = program_in_words(system, system.first_integral_program)
        yield from (f"  {line}" for line in equations(program, ["H"], taken))
    word = "grows" if claim.direction > 0 else "falls"
    yield (
        f"The section is the set of all points with {linear_in_words(claim.normal, state)} = "
        f"{exact_text(claim.offset)}; it is crossed in the direction of the candidate where the left side {word} in "
        "time."
    )
    yield from _box(claim, state)


def field_in_lines(system: System, taken: tuple[str, ...]) -> tuple[list[str], tuple[str, ...]]:
    """The vector field, what coordinates are functions of others, and which letters are taken for what follows."""
    names = names_in_words(system)
    state = [names.get(name, name) for name in system.state]
    field = equations(program_in_words(system, system.program), [f"{name}'" for name in state], taken)
    lines = [f"The {system.title}:", *(f"  {line}" for line in field)]
    taken = (*taken, *_left_sides(field))
    if not system.defined:
        return lines, taken
    kinds = [(names.get(each.name, each.name), each.function) for each in system.defined]
    arguments = [program_in_words(system, program) for program in system.argument_programs]
    given = state[: len(system.given_state)]
    functions = functions_in_lines(given, kinds, arguments, taken)
    return [*lines, *functions], (*taken, *_left_sides(functions))


def _left_sides(lines: list[str]) -> list[str]:
    return [line.strip().partition(" = ")[0] for line in lines]


def periodic_found(claim: PeriodicOrbit, found: PeriodicResults) -> Iterator[str]:
    """What was found, in lines."""
    place = ", ".join(located(name, ball, _DIGITS) for name, ball in keyed_in_words(claim.system, found.point).items())
    yield f"The point of the orbit in the box has {place}."
    yield f"The least period lies in {decimal_interval(found.period, _DIGITS)}."
    yield from force_in_full(claim, found.point, found.period)
    yield from multipliers_in_words(found.multipliers)
    if found.multipliers.is_attracting:
        yield "The orbit is asymptotically stable, with asymptotic phase."
    elif found.multipliers.outside:
        yield "The orbit is unstable."


def force_in_words(
    claim: InSection, point: Mapping[str, arb], period: arb, parameter: arb | None = None
) -> Iterator[str]:
    """What the least period is exactly, if there is a force; `parameter` as of `of_orbit`."""
    known = of_orbit(claim, point, period, parameter)
    if known is not None:
        yield f"the period is {exactly_in_words(known, _SHORT)}"


def force_in_full(
    claim: InSection, point: Mapping[str, arb], period: arb, parameter: arb | None = None
) -> Iterator[str]:
    """The same in a sentence, with its reason."""
    known = of_orbit(claim, point, period, parameter)
    if known is not None:
        yield f"It is {exactly_in_words(known)}{FORCE_TURNS}"


FORCE_TURNS = ": {} and {} are the cosine and the sine of an angle that changes at this speed.".format(*FORCE_AT_START)
"""Why a period is one of the force."""


def exactly_in_words(known: PeriodsOfForce, digits: int = _DIGITS) -> str:
    """A period by the speed at which the force turns."""
    if isinstance(known.rate, Fraction):
        rate = f"omega = {exact_text(known.rate)}"
    else:
        rate = located("omega", known.rate, digits)
    return f"exactly {known.number} x 2 pi/omega, where {rate} is the speed of the force"


def multipliers_in_words(found: Multipliers, known: int | None = None) -> Iterator[str]:
    """The multipliers that are 1 for every orbit, one that is known where an orbit bifurcates, and the others."""
    if found.trivial == 1:
        yield "One multiplier is 1, that of the direction of the flow."
    else:
        yield (
            "The multiplier 1 occurs at least twice, as for every orbit on a level of a first integral: once for the "
            "direction of the flow, once for the levels."
        )
    if known is not None:
        yield f"One more multiplier is {known} exactly, that of the bifurcation."
    if not found.values:
        yield "The other multipliers are not enclosed." if found.undecided else "There are no other multipliers."
        return
    yield f"The other multipliers, with multiplicity, lie in: {'; '.join(map(complex_in_words, found.values))}."
    counts = [(found.inside, "inside"), (found.on, "on"), (found.outside, "outside")]
    yield "Of them " + ", ".join(f"{count} {_lie(count)} {where}" for count, where in counts) + " the unit circle."
    if found.undecided:
        yield f"Where {found.undecided} of them {_lie(found.undecided)} is not decided."


def _lie(count: int) -> str:
    return "lies" if count == 1 else "lie"


def complex_in_words(value: acb) -> str:
    """A complex number, or a real one."""
    if value.imag.is_zero():
        return decimal_interval(value.real, _DIGITS)
    return f"{decimal_interval(value.real, _DIGITS)} + i {decimal_interval(value.imag, _DIGITS)}"


def integral_in_words(system: System) -> str:
    """What the first integral is called."""
    name = system.first_integral_name
    return "first integral H" if name is None or name == "first integral" else f"{name} H"


def program_in_words(system: System, program: Program) -> Program:
    """A function of state and parameters with their names as they are written."""
    names = names_in_words(system)
    steps = [step if step.name is None else replace(step, name=names.get(step.name, step.name))
             for step in program.instructions]  # fmt: skip
    return replace(program, inputs=tuple(names.get(name, name) for name in program.inputs), instructions=tuple(steps))


def _box(claim: InSection, state: list[str]) -> Iterator[str]:
    radii = ", ".join(exact_text(radius) for radius in claim.radii)
    yield (
        f"The box, in the coordinates ({', '.join(state)}): all points centre + frame p with |p_i| <= R_i, i = 0, .., "
        f"{len(claim.radii) - 1}, where centre, frame and radii R are exactly those of candidate in this statement; "
        f"(R_i) = ({radii})."
    )
    sides = [symmetric(radius) for radius in claim.radii]
    for name, middle, row in zip(state, claim.centre, claim.frame, strict=True):
        centre = "0" if middle == 0 else certain_digits(enclose(middle), _DIGITS)
        values: arb = enclose(middle) + dot([enclose(value) for value in row], sides)
        lies = f"on the box {name} lies in {decimal_interval(values, _DIGITS)}" if any(row) else "the same on the box"
        yield f"  {name}: its centre is {centre}, {lies}."


def linear_in_words(factors: tuple[Fraction, ...], names: list[str]) -> str:
    """A linear function of coordinates with these names."""
    terms: list[str] = []
    for factor, name in zip(factors, names, strict=True):
        if factor:
            size = "" if abs(factor) == 1 else f"{exact_text(abs(factor))} "
            sign = "-" if factor < 0 else "+" if terms else ""
            terms.append(f"{sign}{' ' if terms else ''}{size}{name}")
    return " ".join(terms) or "0"
