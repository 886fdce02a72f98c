"""The checks of `theory/Steps.v` once more: which bounds Coq will find, and a tube that holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.formal.arithmetic import (
    Element,
    Format,
    Norm,
    NotShownError,
    Poly,
    Program,
    Slope,
    down,
    l1,
    nadd,
    pderiv,
    psub,
    quotient_up,
    recentred,
    run,
    slopes,
    up,
    values_at,
)

LEAST = 1 << 44
_ATTEMPTS = 8
_MOST_TERMS = 120


@dataclass(frozen=True)
class Step:
    """As `step` of `theory/Steps.v`, with what it shows.

    Attributes:
        length: dyadic.
        solution: for each component, for each monomial.
        powers: about the powers in the field on it.
        tube, terms: as there.
        errors: on the whole step.
        velocities: the field on the tube.
    """

    form: Format
    length: Fraction
    solution: list[list[Poly]]
    powers: list[list[Poly]]
    tube: list[Norm]
    terms: int
    errors: list[Norm]
    velocities: list[Element]

    @property
    def den(self) -> int:
        """The length is an integer over 2^den."""
        return self.length.denominator.bit_length() - 1

    def at_end(self) -> list[Element]:
        """The state at the end."""
        return [
            Element(self.form, [[sum(p)] for p in x], errors)
            for x, errors in zip(self.solution, self.errors, strict=True)
        ]

    def on_step(self, i: int) -> Element:
        """A component on all of the step, of which only the centre is known."""
        return coarsened(Element(self.form, self.solution[i], self.form.nothing()), self.errors[i])


def defect(form: Format, num: int, den: int, x: list[Poly], value: Element) -> Norm:
    """A bound of h f - x'."""
    result = form.nothing()
    for g, p, q in zip(form.grades, x, value.known, strict=True):
        difference = psub([num * c for c in q], [c << den for c in pderiv(p)])
        result[g] += form.bound(l1(difference), form.scale(g) + den)
    return nadd(result, [up(num * e, den) for e in value.unknown])


def coarsened(x: Element, wider: Norm) -> Element:
    """Everything but the centre, to 96 bits and degree 24, is a bound."""
    f, c = x.form, x.form.coarse
    centre = x.known[0]
    errors = nadd(nadd(x.unknown, wider), [0, *x.size[1:]])
    errors[0] += f.bound(l1(centre[c.kept :]), f.bits) + c.rounding(0)
    return Element(c, [[down(a, f.bits - c.bits) for a in centre[: c.kept]]], errors)


def coarse_guess(form: Format, guess: list[Poly]) -> list[Poly]:
    """That of the centre."""
    c = form.coarse
    return [[down(a, form.bits - c.bits) for a in guess[0][: c.kept]]]


def on_part(x: Element, i: int) -> Norm:
    """A bound by grade on one of eight parts of a step."""
    q, scale = recentred(2 * i + 1, 4, x.known[0])
    result = list(x.unknown)
    result[0] += x.form.bound(l1(q), x.form.bits + scale)
    return result


Matrix = list[list[Norm | None]]


def matrix(form: Format, num: int, den: int, rows: Sequence[Sequence[Slope]], i: int) -> Matrix:
    """h / 8 times the bounds of the derivatives on one part."""
    unit = form.const(Fraction(1))

    def entry(s: Slope) -> Norm | None:
        if isinstance(s, int) and s == 0:
            return None
        return [up(num * e, den + 3) for e in on_part(unit if isinstance(s, int) else s, i)]

    return [[entry(s) for s in row] for row in rows]


def apply(form: Format, m: Matrix, v: Sequence[Norm]) -> list[Norm]:
    """A matrix times a vector of bounds."""
    result = []
    for row in m:
        total = form.nothing()
        for entry, x in zip(row, v, strict=True):
            if entry is not None:
                total = nadd(total, form.conv(entry, x))
        result.append(total)
    return result


def exponential(form: Format, m: Matrix, v: Sequence[Norm], terms: int | None) -> tuple[list[Norm], int]:
    """A bound of exp(m) v, and the number of terms, which is found if it is not given."""
    term, total = [list(x) for x in v], [[0] * len(x) for x in v]
    n = 0
    while True:
        small = all(a << 40 <= b for x, y in zip(term, v, strict=True) for a, b in zip(x, y, strict=True))
        if n == terms or (terms is None and small):
            break
        if n == _MOST_TERMS:
            raise NotShownError("the exponential series does not converge")
        n += 1
        total = [nadd(x, y) for x, y in zip(total, term, strict=True)]
        term = [[quotient_up(a, n) for a in x] for x in apply(form, m, term)]
    if not small:
        raise NotShownError("too few terms of the exponential series")
    return [[a + up(a, 39) for a in x] for x in total], n


def check_step(
    program: Program,
    form: Format,
    start: Sequence[Element],
    parameters: Sequence[Element],
    length: Fraction,
    solution: list[list[Poly]],
    powers: list[list[Poly]],
) -> Step:
    """Find a tube for a step. Raises `NotShownError` if there is none."""
    num, den = length.numerator, length.denominator.bit_length() - 1
    c, nothing = form.coarse, form.nothing()
    exact = [Element(form, x, nothing) for x in solution]
    field = values_at(program, run(program, form, powers, [*exact, *parameters]))
    begin = []
    for x, a, value in zip(solution, start, field, strict=True):
        begin.append([LEAST + e for e in nadd(a.unknown, defect(form, num, den, x, value))])
    constants = [coarsened(a, nothing) for a in parameters]
    guesses = [coarse_guess(form, g) for g in powers]
    tube = [[16 * e for e in row] for row in begin]
    for _ in range(_ATTEMPTS):
        values = run(program, c, guesses, [*(map(coarsened, exact, tube)), *constants])
        rows = slopes(program, len(start), values, c)
        matrices = [matrix(c, num, den, rows, i) for i in range(8)]
        terms = 0
        errors = begin
        for m in matrices:
            errors, n = exponential(c, m, errors, None)
            terms = max(terms, n)
        errors = begin
        for m in matrices:
            errors, _ = exponential(c, m, errors, terms)
        if all(a < b for x, y in zip(errors, tube, strict=True) for a, b in zip(x, y, strict=True)):
            velocities = values_at(program, values)
            return Step(form, length, solution, powers, tube, terms, errors, velocities)
        tube = [[4 * e for e in row] for row in errors]
    raise NotShownError("no tube holds")
