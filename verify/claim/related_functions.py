"""Functions in a field: relations between them, divergence, linear symmetries (section 1.7)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement

from flint import fmpq, fmpq_mpoly

from orbitproof.shared.systems import Program, System
from orbitproof.verify.claim.first_integral import AlongFlow, NotShownError, Ring
from orbitproof.verify.claim.linear_symmetry import Rows

Sum = tuple[tuple[int, int], ...]
"""A sum of arguments, each as (sign, number)."""
_LONGEST_SUM = 3
_PRIME, _MOST_DEGREE = 2**61 - 1, 40
Terms = dict[tuple[int, ...], fmpq]
"""The coefficients of a polynomial by exponents."""


@dataclass(frozen=True)
class Functions:
    """The last coordinates of a state, which are functions of others.

    Attributes:
        first: how many coordinates come before them.
        calls: for each of them the function and its argument; inputs of this: state, then parameters.
    """

    first: int
    calls: tuple[tuple[str, Program], ...]

    def __call__(self, *programs: Program) -> Ring:
        """The ring of programs in which relations between the functions are known. Raises `NotShownError`."""
        return _RelatedRing(self, *programs)

    def places(self, kind: str) -> dict[Program, int]:
        """Where the functions of a kind are among the inputs, by their arguments."""
        return {argument: self.first + i for i, (name, argument) in enumerate(self.calls) if name == kind}


def functions_of(system: System) -> Functions:
    """The functions in the field of a system that has some."""
    kinds = [each.function for each in system.defined]
    return Functions(len(system.given_state), tuple(zip(kinds, system.argument_programs, strict=True)))


class _RelatedRing(Ring):
    """Where sines and cosines of sums, exponentials of sums, squares of sines and products are written by others."""

    def __init__(self, functions: Functions, *programs: Program) -> None:
        super().__init__(*programs)
        self._squares: list[tuple[int, int]] = []
        self._inverses: list[Counter[int]] = []
        arguments = _Arguments(functions, programs[0])
        self._relate_circular(functions, arguments)
        self._relate_exponential(functions, arguments)

    def is_zero(self, polynomial: fmpq_mpoly) -> bool:
        """By s^2 = 1 - c^2 and products of exponentials that are 1 besides."""
        for sine, cosine in self._squares:
            parts: dict[int, Terms] = {}
            for exponents, value in polynomial.to_dict().items():
                whole, rest = divmod(int(exponents[sine]), 2)
                parts.setdefault(whole, {})[(*exponents[:sine], rest, *exponents[sine + 1 :])] = value
            other = self.polynomials.gen(cosine)
            square = self.sum(self.polynomials.constant(1), -self.product(other, other))
            polynomial = self.polynomials.constant(0)
            for whole, part in parts.items():
                lifted = self.product(self.polynomials.from_dict(part), self._whole_power(square, whole))
                polynomial = self.sum(polynomial, lifted)
        for powers in self._inverses:
            terms: Terms = {}
            for exponents, value in polynomial.to_dict().items():
                common = min(int(exponents[i]) // power for i, power in powers.items())
                key = tuple(e - common * powers[i] for i, e in enumerate(map(int, exponents)))
                terms[key] = terms.get(key, fmpq(0)) + value
            polynomial = self.polynomials.from_dict(terms)
        return bool(polynomial.is_zero())

    def _relate_circular(self, functions: Functions, arguments: _Arguments) -> None:
        sines, cosines = functions.places("sin"), functions.places("cos")
        both = [argument for argument in sines if argument in cosines]
        kept, written = arguments.independent(both, (1, -1))
        self._squares = [(sines[both[k]], cosines[both[k]]) for k in kept]
        for k, terms in written:
            sine, cosine = self.polynomials.constant(0), self.polynomials.constant(1)
            for sign, i in terms:
                s, c = self.inputs[sines[both[i]]].value * sign, self.inputs[cosines[both[i]]].value
                sine, cosine = (
                    self.sum(self.product(sine, c), self.product(cosine, s)),
                    self.sum(self.product(cosine, c), -self.product(sine, s)),
                )
            self._write(sines[both[k]], sine)
            self._write(cosines[both[k]], cosine)

    def _relate_exponential(self, functions: Functions, arguments: _Arguments) -> None:
        places = functions.places("exp")
        all_of_them = list(places)
        kept, written = arguments.independent(all_of_them, (1,))
        for k, terms in written:
            value = self.polynomials.constant(1)
            for _, i in terms:
                value = self.product(value, self.inputs[places[all_of_them[i]]].value)
            self._write(places[all_of_them[k]], value)
        for k in kept:
            for terms in arguments.sums_for(all_of_them, k, [i for i in kept if i != k], (-1,)):
                powers = Counter(places[all_of_them[i]] for i in (k, *(i for _, i in terms)))
                if powers not in self._inverses:
                    self._inverses.append(powers)

    def _write(self, place: int, value: fmpq_mpoly) -> None:
        self.inputs[place] = AlongFlow(self, value, self.polynomials.constant(0))


class _Arguments:
    """The arguments of functions as elements of a ring of their own."""

    def __init__(self, functions: Functions, field: Program) -> None:
        programs = [argument for _, argument in functions.calls]
        self.ring = Ring(field, *programs)
        self.values: dict[Program, fmpq_mpoly] = {}
        for program in programs:
            if program not in self.values:
                (found,) = program.evaluate(self.ring.inputs, self.ring.constant, AlongFlow.power)
                self.values[program] = found.value
        # Equal polynomials have equal values at this point: most sums are excluded there.
        point = [fmpq(pow(3, 7 * i + 5, _PRIME)) for i in range(self.ring.variables)]
        short = not self.ring.symbols and all(v.total_degree() <= _MOST_DEGREE for v in self.values.values())
        self._at_point = {p: value(*point) for p, value in self.values.items()} if short else {}

    def are_equal(self, left: Program, terms: Sequence[tuple[int, Program]]) -> bool:
        """Whether an argument is a sum of others with signs, identically."""
        difference = self.values[left]
        for sign, program in terms:
            difference = self.ring.sum(difference, self.values[program] * -sign)
        return self.ring.vanishes(difference)

    def independent(self, programs: Sequence[Program], signs: Sequence[int]) -> tuple[list[int], list[tuple[int, Sum]]]:
        """Arguments that stay, and those that are sums of a few others, each after all that it is made of."""
        kept, written = list(range(len(programs))), list[tuple[int, Sum]]()
        while (found := self._sum_of_others(programs, kept, signs)) is not None:
            kept.remove(found[0])
            written.insert(0, found)
        return kept, written

    def _sum_of_others(
        self, programs: Sequence[Program], kept: Sequence[int], signs: Sequence[int]
    ) -> tuple[int, Sum] | None:
        for k in kept:
            for terms in self.sums_for(programs, k, [i for i in kept if i != k], signs):
                return k, terms
        return None

    def sums_for(
        self, programs: Sequence[Program], k: int, others: Sequence[int], signs: Sequence[int]
    ) -> Iterator[Sum]:
        """Sums of a few others, with signs, that an argument is identically."""
        at = [self._at_point[program] for program in programs] if self._at_point else []
        for terms in _sums(others, signs):
            if at and sum(at[i] if sign > 0 else -at[i] for sign, i in terms) != at[k]:
                continue
            if self.are_equal(programs[k], [(sign, programs[i]) for sign, i in terms]):
                yield terms


def _sums(numbers: Sequence[int], signs: Sequence[int]) -> Iterator[Sum]:
    """All sums of up to `_LONGEST_SUM` of these, with signs."""
    single = [(sign, i) for i in numbers for sign in signs]
    for length in range(1, _LONGEST_SUM + 1):
        yield from combinations_with_replacement(single, length)


@cache
def is_free_with_functions(field: Program, functions: Functions) -> bool:
    """Whether the divergence of the field in the coordinates before the functions is shown to vanish identically."""
    try:
        ring = functions(field, *(argument for _, argument in functions.calls))
        field.evaluate(ring.inputs, ring.constant, AlongFlow.power)
        ring.is_closed = True
        unit, zero = ring.polynomials.constant(1), ring.polynomials.constant(0)
        divergence = zero
        for place in range(functions.first):
            inputs = [AlongFlow(ring, x.value, unit if i == place else zero) for i, x in enumerate(ring.inputs)]
            _move_functions(ring, functions, inputs)
            rates = [output.rate for output in field.evaluate(inputs, ring.constant, AlongFlow.power)]
            divergence = ring.sum(divergence, rates[place])
        return ring.vanishes(divergence)
    except NotShownError:
        return False


def _move_functions(ring: Ring, functions: Functions, inputs: list[AlongFlow]) -> None:
    """Give the functions the rates with which they follow the coordinates before them."""
    sines, cosines = functions.places("sin"), functions.places("cos")
    for place, (kind, argument) in enumerate(functions.calls, functions.first):
        (moving,) = argument.evaluate(inputs, ring.constant, AlongFlow.power)
        match kind:
            case "sin":
                slope = inputs[_partner(cosines, argument)].value
            case "cos":
                slope = -inputs[_partner(sines, argument)].value
            case "exp":
                slope = inputs[place].value
            case "log":
                slope = ring.power(moving.value, Fraction(-1))
            case _:
                raise NotShownError
        inputs[place] = AlongFlow(ring, inputs[place].value, ring.product(slope, moving.rate))


def _partner(places: dict[Program, int], argument: Program) -> int:
    if argument not in places:
        raise NotShownError
    return places[argument]


def with_moved_functions(field: Program, functions: Functions, symmetry: Rows) -> Rows | None:
    """S on all coordinates, where it takes each function to one of the same kind, up to its sign; else `None`.

    Args:
        symmetry: S on the coordinates before the functions, rows.
    """
    first, size = functions.first, functions.first + len(functions.calls)
    rows = [(*row, *[Fraction(0)] * len(functions.calls)) for row in symmetry]
    try:
        arguments = _Arguments(functions, field)
        ring, zero = arguments.ring, arguments.ring.polynomials.constant(0)
        moved = [AlongFlow(ring, _combined(ring, row[:first]), zero) for row in rows]
        for kind, argument in functions.calls:
            # Of later ones it is no function, though its program may have steps that divide by them.
            (value,) = argument.evaluate([*moved, *ring.inputs[len(moved) :]], ring.constant, AlongFlow.power)
            found = _same_up_to_sign(functions, arguments, kind, value.value)
            if found is None:
                return None
            sign, place = found
            rows.append(tuple(Fraction(sign * (i == place)) for i in range(size)))
            moved.append(AlongFlow(ring, ring.inputs[place].value * sign, zero))
    except NotShownError:
        return None
    return tuple(rows)


def _combined(ring: Ring, factors: Sequence[Fraction]) -> fmpq_mpoly:
    value = ring.polynomials.constant(0)
    for factor, each in zip(factors, ring.inputs, strict=False):
        value = ring.sum(value, each.value * fmpq(factor.numerator, factor.denominator))
    return value


def _same_up_to_sign(
    functions: Functions, arguments: _Arguments, kind: str, value: fmpq_mpoly
) -> tuple[int, int] | None:
    """The sign and the place of a function of this kind, with which that of `value` agrees."""
    ring = arguments.ring
    for argument, place in functions.places(kind).items():
        known = arguments.values[argument]
        if ring.vanishes(ring.sum(value, -known)):
            return 1, place
        if kind in ("sin", "cos") and ring.vanishes(ring.sum(value, known)):
            return -1 if kind == "sin" else 1, place
    return None
