"""Parameters that follow from the given ones: the libration points (section 16.3).

A derived parameter is the zero of an increasing function (`shared.systems.system.DerivedParameter`). Bisection brings
it between two dyadic numbers; that the function is finite between them, hence continuous, and has certain signs
at them is the proof. Nothing else about the bisection matters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import DerivedParameter, Program, ReversibleSystem, record
from orbitproof.verify.evidence import GUARD_BITS, IntegrationFailure, enclose, guarded, hull, power, sign

_HALVINGS = 200


@dataclass(frozen=True)
class Root:
    """A real number in the open interval (lower, upper), dyadic ends."""

    lower: Fraction
    upper: Fraction

    @property
    def middle(self) -> Fraction:
        """The middle of the interval."""
        return (self.lower + self.upper) / 2

    @property
    def radius(self) -> Fraction:
        """Half the length of the interval."""
        return (self.upper - self.lower) / 2

    @property
    def ball(self) -> arb:
        """A ball that contains the interval."""
        return hull(enclose(self.lower), enclose(self.upper))


def derived_parameter(system: ReversibleSystem, name: str, parameters: Mapping[str, Fraction], bits: int) -> Root:
    """Enclosure of a derived parameter at given values of the others, to 2^-bits (relative where it is above 1).

    Raises `IntegrationFailure` if none was found.
    """
    given = [parameters[key] for key in system.fixed_parameters]
    with guarded(bits):
        return _Search(system.derived_parameters[name], name, system.fixed_parameters, given).root(bits)


class _Search:
    """The zero of one equation, by bisection."""

    def __init__(self, definition: DerivedParameter, name: str, names: tuple[str, ...], given: list[Fraction]) -> None:
        self.name = name
        self.program: Program = record(definition.equation, (name,), names)
        self.given = [enclose(value) for value in given]
        self.ends = tuple(None if end is None else Fraction(end) for end in definition.interval(given))

    def value(self, where: arb) -> arb:
        (result,) = self.program.evaluate([where, *self.given], enclose, power)
        return arb(result)

    def sign(self, where: Fraction) -> int:
        return sign(self.value(enclose(where)))

    def root(self, bits: int) -> Root:
        low, high = self._first(-1, bits), self._first(1, bits)
        while (high - low) * 2**bits > max(1, abs(low), abs(high)):
            low, high = self._halve(low, high, bits)
        begin, end = self.ends
        inside = (begin is None or begin < low) and (end is None or high < end)
        continuous = self.value(hull(enclose(low), enclose(high))).is_finite()
        if not (inside and continuous and self.sign(low) < 0 and self.sign(high) > 0):
            raise self._failure()
        return Root(low, high)

    def _halve(self, low: Fraction, high: Fraction, bits: int) -> tuple[Fraction, Fraction]:
        # Where the zero is the very middle, its sign cannot be told, but that of another point can.
        for share in (Fraction(1, 2), Fraction(3, 8)):
            place = round_dyadic(low + share * (high - low), bits + GUARD_BITS)
            side = self.sign(place) if low < place < high else 0
            if side:
                return (place, high) if side < 0 else (low, place)
        raise self._failure()

    def _first(self, wanted: int, bits: int) -> Fraction:
        """A point of the interval where the function has this sign, looked for towards the lower end for -1."""
        begin, end = self.ends
        for count in range(1, _HALVINGS):
            near, far = (begin, end) if wanted < 0 else (end, begin)
            if near is not None:
                reach = Fraction(1) if far is None else abs(near - far)
                place = near - wanted * reach / 2**count
            else:
                place = (Fraction(0) if far is None else far) + wanted * Fraction(2) ** (count - 1)
            place = round_dyadic(place, bits + GUARD_BITS)
            if self.sign(place) == wanted:
                return place
        raise self._failure()

    def _failure(self) -> IntegrationFailure:
        return IntegrationFailure(
            "derived parameter",
            f"{self.name} was not enclosed",
            "give more precision, or parameters that are further from the ends of their range",
            needs_precision=True,
        )
