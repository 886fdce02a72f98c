"""What the tests of the integrator share: boxes, random points of a box, and checks of containment."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial, prod

from flint import arb, fmpq
from support.claims import PUBLISHED_POINTS
from support.closed_form_maps import identity
from support.reference import Orbits, falkner_skan, three_body

from orbitproof.shared.claims import Candidate
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS, Program, ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series, prepare
from orbitproof.verify.evidence import DerivativeTable
from orbitproof.verify.flow import FlowStep, advance
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.wide_solution import expand
from orbitproof.verify.poincare.section import onto_section
from orbitproof.verify.poincare.section_field import build_section_program

RECURRENCES = {"cr3bp": three_body, "falkner-skan": falkner_skan}


def ball(value: Fraction) -> arb:
    """A ball that contains an exact number."""
    return arb(fmpq(value.numerator, value.denominator))


def random_fraction(source: random.Random, size: Fraction | float = 1) -> Fraction:
    """A dyadic number in [-size, size], sometimes an end."""
    shape = source.choice((-1, 1)) if source.random() < 0.2 else Fraction(source.randint(-(2**40), 2**40), 2**40)
    return Fraction(size) * shape


def random_frame(source: random.Random, size: int) -> tuple[tuple[Fraction, ...], ...]:
    """A matrix near the identity."""
    return tuple(
        tuple(Fraction(int(i == j)) + random_fraction(source, Fraction(1, 4)) for j in range(size)) for i in range(size)
    )


def box(
    system: ReversibleSystem, kind: str, k: int, centre: Sequence[str | Fraction], radii: Sequence[Fraction],
    parameters: Mapping[str, Fraction] | None = None, seed: int | None = None,
) -> Candidate:  # fmt: skip
    """A candidate; with `seed`, its centre is moved by about 1e-4 and its frames are random."""
    source = random.Random(seed)
    middle = [Fraction(value) for value in centre]
    size, kernel = len(middle), len(system.kernel_coordinates)
    if seed is not None:
        middle = [value * (1 + random_fraction(source, Fraction(1, 10**4))) for value in middle]
        frames = random_frame(source, size), random_frame(source, kernel)
    else:
        frames = identity(size), identity(kernel)
    return Candidate("box", system, dict(parameters or {}), kind, k, tuple(middle), *frames, tuple(radii))


def halo(mass: str, kind: str, radii: Sequence[str], seed: int | None = None) -> Candidate:
    """A box of halo-like initial data of the CR3BP."""
    centre = {"earth-moon": ("0.843193964637", "0.165", "0.263718532564"), "sun-jupiter": ("0.915", "0.02", "0.22")}
    return box(CR3BP, kind, 2, centre[mass], [Fraction(r) for r in radii], {"mu": MASS_PARAMETERS[mass]}, seed)


def falkner_skan_box(kind: str, k: int, radii: Sequence[str], seed: int | None = None) -> Candidate:
    """A box near the orbit of the Falkner-Skan equation that is 1:3 resonant."""
    return box(FALKNER_SKAN, kind, k, PUBLISHED_POINTS[3], [Fraction(r) for r in radii], None, seed)


def random_point(source: random.Random, candidate: Candidate) -> tuple[Fraction, ...]:
    """A point p of the candidate's box."""
    return tuple(random_fraction(source, radius) for radius in candidate.radii)


def initial_state(candidate: Candidate, p: Sequence[Fraction]) -> tuple[list[Fraction], list[Fraction]]:
    """State and parameters of the orbit that starts at the point p of Fix(R)."""
    system = candidate.system
    values = {
        name: middle + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0))
        for name, middle, row in zip(system.centre_coordinates, candidate.centre, candidate.frame, strict=True)
    }
    state = [values.get(name, Fraction(0)) for name in system.state]
    return state, [values[name] if name in values else candidate.parameters[name] for name in system.parameters]


def orbits(system: ReversibleSystem, bits: int) -> Orbits:
    """The independent integrator of a system."""
    return Orbits(RECURRENCES[system.name], system.section_index, bits)


def kernel_values(candidate: Candidate, state: Sequence[Fraction]) -> list[Fraction]:
    """The coordinates q of a state."""
    rows = candidate.kernel_frame
    kernel = [state[i] for i in candidate.system.kernel_coordinates]
    return [sum((a * b for a, b in zip(row, kernel, strict=True)), Fraction(0)) for row in rows]


def taylor_enclosure(table: DerivativeTable, p: Sequence[Fraction]) -> arb:
    """The value at a point of the box, by Taylor's formula with the remainder of order 3 over the box."""
    value = arb(0)
    for alpha, derivative in table.box.items():
        term = derivative if sum(alpha) == 3 else table.centre[alpha]
        for x, n in zip(p, alpha, strict=True):
            term = term * ball(x**n) / factorial(n)
        value = value + term
    return value


def contains(enclosure: arb, value: Fraction, tolerance: Fraction = Fraction(0)) -> bool:
    """Whether a finite ball contains a number that is known up to a tolerance."""
    return enclosure.is_finite() and abs(ball(value) - enclosure.mid()).upper() <= enclosure.rad() + ball(tolerance)


@dataclass(frozen=True)
class Model:
    """A box of initial values for the integrator's own parts: state and parameters as series."""

    arithmetic: Arithmetic
    state: tuple[Series, ...]
    parameters: tuple[Series, ...]

    @property
    def middle(self) -> tuple[list[Fraction], list[Fraction]]:
        """The centre, exactly."""
        one = int(self.arithmetic.one)
        rows = ([Fraction(int(x.coefs[0][0]), one) for x in group] for group in (self.state, self.parameters))
        first, second = rows
        return first, second


def series_at(series: Series, theta: Fraction, xi: Sequence[Fraction]) -> arb:
    """The enclosure at a real point of the polydisc; unknown parts are not told apart by grade."""
    arithmetic = series.arithmetic
    value = arb(0)
    for exponents, polynomial, scale in zip(arithmetic.grading.monomials, series.coefs, arithmetic.scales, strict=True):
        monomial = prod((x**n for x, n in zip(xi, exponents, strict=False)), start=Fraction(1))
        exact = sum((int(c) * theta**n for n, c in enumerate(polynomial.coeffs())), Fraction(0))
        value = value + ball(exact * monomial / 2**scale)
    unknown = sum((arb(e) for e in series.errors), arb(0))
    return value + arb(0, 1) * unknown


def follow(program: Program | PreparedProgram, model: Model, step: Fraction) -> FlowStep:
    """One step of the flow from a box."""
    prepared = prepare(program) if isinstance(program, Program) else program
    arithmetic = model.arithmetic
    expansion = expand(prepared, arithmetic, model.state, model.parameters)
    return advance(prepared, model.state, model.parameters, expansion, step)


def to_section(system: ReversibleSystem, model: Model, time: Fraction, steps: int) -> tuple[Model, Series]:
    """The image on the section next to a time, in equal steps, and what is missing to the time of arrival.

    The section coordinate of the image is zero and is set so.
    """
    program = prepare(system.program)
    bits = model.arithmetic.bits
    step = Fraction((time.numerator << bits) // (time.denominator * steps), 1 << bits)
    for _ in range(steps):
        model = Model(model.arithmetic, follow(program, model, step).end, model.parameters)
    section_program = build_section_program(system.program, len(system.state), system.section_index)
    image, elapsed = onto_section(
        section_program, system.section_index, model.arithmetic, model.state, model.parameters, ORACLE
    )
    image[system.section_index] = model.arithmetic.constant(Fraction(0))
    return Model(model.arithmetic, tuple(image), model.parameters), elapsed


def reversed_by(system: ReversibleSystem, model: Model) -> Model:
    """The box under R."""
    state = [
        x if sign == 1 else x.scaled(Fraction(-1))
        for x, sign in zip(model.state, system.reversing_symmetry, strict=True)
    ]
    return Model(model.arithmetic, tuple(state), model.parameters)


def distance_by_grade(series: Series, other: Series) -> list[Fraction]:
    """l1 distance of two known parts, by grade (the last slot is 0)."""
    grading = series.arithmetic.grading
    result = [Fraction(0)] * (grading.top + 2)
    rows = zip(series.coefs, other.coefs, grading.grades, series.arithmetic.scales, strict=True)
    for left, right, grade, scale in rows:
        result[grade] += Fraction(sum(abs(int(c)) for c in (left - right).coeffs()), 2**scale)
    return result
