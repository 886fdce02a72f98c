"""One certified bifurcation as data for Coq: what `theory/Rows.v` and `theory/Theorems.v` check."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.formal.arithmetic import Element, Format, NotShownError, Poly, Program, first_of, run, values_at
from orbitproof.formal.crossings import Counter, Part, cover, onto_section, range_of, section_field
from orbitproof.formal.recording import Approximation, Leg, format_of, precision_for, record, recorded
from orbitproof.formal.steps import Step, check_step
from orbitproof.shared.formats import BoxClaim, Candidate, InputError
from orbitproof.verify.algebra import fraction_above
from orbitproof.verify.bifurcation import level_form
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.claim import quadratic_coefficient
from orbitproof.verify.poincare import box_of

Progress = Callable[[int, str], None]
_CONCLUSION_BITS = 160


@dataclass(frozen=True)
class Affine:
    """centre + sum of row_j p_j."""

    centre: Fraction
    row: tuple[Fraction, ...]


@dataclass(frozen=True)
class LevelData:
    """As `level` of `theory/Rows.v`; `inverse` is 1 / b."""

    integral: Program
    inverse: Fraction
    sign: int
    of: Affine
    guesses: list[list[Poly]]


@dataclass(frozen=True)
class OwnBox:
    """As `own` of `theory/Theorems.v`: the box of a claim whose level form is checked."""

    claim: Candidate
    starts: list[Affine | None]
    form: Format
    guesses: list[list[Poly]]


@dataclass(frozen=True)
class Position:
    """As `position` of `theory/Rows.v`."""

    state: list[Element]
    clock: int
    counter: Counter


@dataclass(frozen=True)
class Move:
    """A step of the flow between two positions."""

    step: Step
    parts: list[Part]
    to: Position


@dataclass(frozen=True)
class Arrival:
    """A crossing, reached from the position with this number."""

    source: int
    steps: list[Step]
    ones: int
    image: list[Element]


@dataclass(frozen=True)
class Row:
    """All that is written down of one certificate.

    Attributes:
        claim: what the hypotheses are about: the candidate, or its level form.
        starts: one for each input of the field; `None` for the coordinate that follows from the level.
        positions: the first is that of the beginning.
        moves: from each position to the next.
        arrivals: one for each crossing.
        own: the box of the certificate, if `claim` is a level form.
        integral: the first integral and guesses for it, where its values are the parameter and no coordinate.
        stated: ends of an interval that contains the parameter at the point.
        precision: bits of the conclusion.
    """

    certificate: Certificate
    claim: Candidate
    form: Format
    field: Program
    starts: list[Affine | None]
    level: LevelData | None
    onto_degree: int
    clock_bits: int
    positions: list[Position]
    moves: list[Move]
    arrivals: list[Arrival]
    integral: tuple[Program, list[list[Poly]]] | None
    own: OwnBox | None
    stated: tuple[Fraction, Fraction]
    precision: int


def claim_of(certificate: Certificate) -> Candidate:
    """What the hypotheses of a certificate are about. Raises `InputError` where there is no formal check."""
    if "format" in certificate.document:
        raise InputError(f"{certificate.id}: the formal check is for bifurcations at which orbits branch off")
    candidate: BoxClaim = certificate.candidate
    if not certificate.proved:
        raise InputError(f"{certificate.id}: it is not proved; there is nothing to check")
    if not isinstance(candidate, Candidate) or not candidate.has_branch:
        raise InputError(f"{certificate.id}: the formal check is for bifurcations at which orbits branch off")
    system = candidate.system
    if system.defined or system.fixed_level is not None or (candidate.uses_symmetry and candidate.k > 1):
        raise InputError(f"{certificate.id}: functions, fixed levels, and symmetries with k > 1 are not covered")
    if len(candidate.radii) > 3:
        raise InputError(
            f"{certificate.id}: systems with more than two degrees of freedom on the section are not covered"
        )
    if "level_form" not in certificate.statement:
        return candidate
    form = level_form(candidate)
    if form is None:
        raise InputError(f"{certificate.id}: its level form is not found again")
    return form


def starts_of(claim: Candidate) -> list[Affine | None]:
    """Where the inputs of the field begin, in its order."""
    system, zero = claim.system, (Fraction(0),) * len(claim.radii)
    affine = {name: Affine(value, zero) for name, value in claim.parameters.items()}
    for name, centre, row in zip(claim.coordinates, claim.centre, claim.frame, strict=True):
        affine[name] = Affine(centre, tuple(row))
    for name in system.state:
        affine.setdefault(name, Affine(system.normalised.get(name, Fraction(0)), zero))
    follows = system.level_coordinate if claim.level_sign is not None else None
    return [None if name == follows else affine[name] for name in (*system.state, *system.parameters)]


def element_of(form: Format, claim: Candidate, start: Affine | None) -> Element:
    """As `affine` of `theory/Rows.v`; 0 for the coordinate that follows from the level."""
    if start is None:
        return form.const(Fraction(0))
    variables = len(claim.radii)
    given = {(0,) * variables: start.centre}
    for j, (a, r) in enumerate(zip(start.row, claim.radii, strict=True)):
        given[tuple(int(i == j) for i in range(variables))] = 4 * a * r
    known, errors = [], form.nothing()
    for exponents, grade in zip(form.monomials, form.grades, strict=True):
        value, scale = given.get(exponents, Fraction(0)), form.scale(grade)
        c = (value.numerator << scale) // value.denominator
        known.append([c] if value else [])
        if Fraction(c, 1 << scale) != value:
            errors[grade] += form.bound(1, scale)
    return Element(form, known, errors)


def _guess(base: Element, p: int, q: int) -> list[Poly]:
    """About base^(-p/q), for an element without theta, by Newton's method."""
    form = base.form
    one = 1 << form.bits
    middle = first_of(base) / one
    if q > 1 and middle <= 0:
        raise NotShownError("a base is not positive")
    exponent = Fraction(-p, q)
    start = Fraction(abs(middle) ** float(exponent)) * (1 if middle > 0 or p % 2 == 0 else -1)
    bare = Element(form, base.known, form.nothing())
    s = form.const(Fraction(round(start * one), one))
    s = Element(form, s.known, form.nothing())
    unit = form.const(Fraction(1))
    # Each step doubles the number of bits, and the grade up to which it is right.
    for _ in range(10):
        product = unit
        for _ in range(q):
            product = product * s
        for _ in range(p):
            product = product * bare
        s = s + (s * (unit - product)).scaled(Fraction(1, q))
        s = Element(form, s.known, form.nothing())
    return s.known


def _with_guesses(program: Program, form: Format, given: Sequence[Element]) -> tuple[list[Element], list[list[Poly]]]:
    guesses: list[list[Poly]] = []

    def guess(base: Element, p: int, q: int) -> list[Poly]:
        guesses.append(_guess(base, p, q))
        return guesses[-1]

    return values_at(program, run(program, form, guess, given)), guesses


def level_data(claim: Candidate, form: Format, given: Sequence[Element]) -> tuple[LevelData, Element]:
    """The coordinate that follows from the level, as `from_level` of `theory/Rows.v` finds it."""
    system = claim.system
    coefficient = quadratic_coefficient(system)
    assert coefficient
    assert claim.level_sign is not None
    assert system.first_integral_program is not None
    integral = recorded(system.first_integral_program)
    flat = form.of_degree(0)
    (a,), guesses = _with_guesses(integral, flat, [Element(flat, x.known, x.unknown) for x in given])
    of = Affine(claim.centre[0], tuple(claim.frame[0]))
    base = (element_of(flat, claim, of) - a).scaled(1 / coefficient)
    guesses.append(_guess(base, 1, 2))
    w = (base * base.power(1, 2, guesses[-1])).scaled(Fraction(claim.level_sign))
    return LevelData(integral, 1 / coefficient, claim.level_sign, of, guesses), Element(form, w.known, w.unknown)


def _bounds_as_floats(form: Format, bounds: Sequence[int]) -> list[float]:
    return [fraction_above(Fraction(e, 1 << form.eps)) for e in bounds]


def export(certificate: Certificate, progress: Progress = lambda n, what: None) -> Row:
    """All that Coq is to check of a certificate.

    `progress` is called with the number of steps so far. Raises `InputError` where there is no formal check,
    `NotShownError` where a check of Coq would fail, `IntegrationFailure`.
    """
    claim = claim_of(certificate)
    system = claim.system
    starts = starts_of(claim)
    level: LevelData | None = None
    begin: list[Element] = []

    def initial(form: Format) -> dict[int, tuple[list[Poly], list[float]]]:
        nonlocal level
        given = [element_of(form, claim, start) for start in starts]
        replaced = {}
        if claim.level_sign is not None:
            level, w = level_data(claim, form, given)
            place = starts.index(None)
            given[place] = w
            replaced[place] = (w.known, _bounds_as_floats(form, w.unknown))
        begin.extend(given)
        return replaced

    form, legs = record(claim, precision_for(certificate, claim), initial)
    size, field = len(system.state), recorded(system.program)
    state, parameters = begin[:size], begin[size:]
    clock_bits = 16 + max(a.length.denominator.bit_length() for leg in legs for a in leg.steps)
    positions = [Position(state, 0, Counter())]
    moves: list[Move] = []
    arrivals: list[Arrival] = []
    degrees = {len(p) - 1 for leg in legs for a in leg.onto for x in a.solution for p in x}
    onto_degree = max(2 * form.top + 4, *degrees)
    for number, leg in enumerate(legs, start=1):
        for approximation in leg.steps:
            moves.append(_move(form, field, positions[-1], parameters, approximation, system.section_index, clock_bits))
            positions.append(moves[-1].to)
            progress(len(moves), "steps")
        source = positions[-1]
        arrivals.append(
            _arrival(
                form.of_degree(onto_degree),
                field,
                source,
                len(moves),
                parameters,
                leg,
                number,
                system.section_index,
                clock_bits,
            )
        )
    integral = None
    if not claim.is_family_of_maps:
        assert system.first_integral_program is not None
        program, flat = recorded(system.first_integral_program), form.of_degree(0)
        _, guesses = _with_guesses(program, flat, [Element(flat, x.known, x.unknown) for x in begin])
        integral = program, guesses
    return Row(
        certificate,
        claim,
        form,
        field,
        starts,
        level,
        onto_degree,
        clock_bits,
        positions,
        moves,
        arrivals,
        integral,
        _own(certificate) if "level_form" in certificate.statement else None,
        stated_of(certificate),
        form.bits + form.top * form.grade_bits + _CONCLUSION_BITS,
    )


def _own(certificate: Certificate) -> OwnBox:
    claim = certificate.candidate
    assert isinstance(claim, Candidate)
    system = claim.system
    assert system.first_integral_program is not None
    bits = 64 + 2 * max(max(0, r.denominator.bit_length() - r.numerator.bit_length()) for r in claim.radii)
    form = format_of(box_of(claim, bits, 1).arithmetic)
    starts, flat = starts_of(claim), form.of_degree(0)
    _, guesses = _with_guesses(
        recorded(system.first_integral_program), flat, [element_of(flat, claim, s) for s in starts]
    )
    return OwnBox(claim, starts, form, guesses)


def stated_of(certificate: Certificate) -> tuple[Fraction, Fraction]:
    """Ends of the parameter at the point, twice as far from the middle as those of the certificate."""
    from orbitproof.verify.evidence import bounds

    assert certificate.parameter is not None
    low, high = bounds(certificate.parameter)
    return low - (high - low) / 2, high + (high - low) / 2


def _check(
    program: Program, form: Format, state: Sequence[Element], parameters: Sequence[Element], found: Approximation
) -> Step:
    return check_step(program, form, state, parameters, found.length, found.solution, found.powers)


def _move(
    form: Format,
    field: Program,
    source: Position,
    parameters: Sequence[Element],
    found: Approximation,
    section: int,
    clock_bits: int,
) -> Move:
    step = _check(field, form, source.state, parameters, found)
    y, dy = step.on_step(section), step.velocities[section]
    parts, counter = cover(y, dy, clock_bits, source.clock, step.length, source.counter)
    clock = source.clock + (step.length.numerator << clock_bits - step.den)
    return Move(step, parts, Position(step.at_end(), clock, counter))


def _arrival(
    form: Format,
    field: Program,
    source: Position,
    place: int,
    parameters: Sequence[Element],
    leg: Leg,
    number: int,
    section: int,
    clock_bits: int,
) -> Arrival:
    since, behind = source.counter.arrival(number)
    program = section_field(field, len(source.state), section)
    state = onto_section(source.state, form)
    constants = [*(Element(form, x.known, x.unknown) for x in parameters), state[section]]
    steps = []
    for found in leg.onto:
        # The verifier's program for this may have its powers in another order: the only one that it adds is the last.
        steps.append(_check(program, form, state, constants, found))
        state = steps[-1].at_end()
    ones = max(step.den for step in steps)
    low, high = range_of(state[-1])
    if not (source.clock - since << form.eps) + (low << clock_bits) > 0 or (behind and not high < 0):
        raise NotShownError(f"crossing {number} is not separated from the one before it")
    return Arrival(place, steps, ones, state[:-1])
