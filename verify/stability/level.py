"""That dh != 0 on Fix(R) along a curve, h the level of its orbits: a hypothesis of the list (section 18.5)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import Program, System
from orbitproof.verify.claim import atlas_in_words
from orbitproof.verify.curve import Stretch
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits
from orbitproof.verify.evidence import Checklist, Hypothesis, enclose, excludes_zero, is_positive, power
from orbitproof.verify.stability.kinds import Matter
from orbitproof.verify.stability.known_functions import point_over
from orbitproof.verify.stability.list_entries import Gap, Segment, level_name
from orbitproof.verify.stability.zeros import between

LEVEL = "level"
"""Name of the hypothesis."""
_HALVINGS = 10


@dataclass(frozen=True)
class _Along:
    """A function and its derivative in one of its arguments, at all points of a box."""

    value: arb
    rate: arb

    def __add__(self, other: _Along) -> _Along:
        return _Along(self.value + other.value, self.rate + other.rate)

    def __sub__(self, other: _Along) -> _Along:
        return _Along(self.value - other.value, self.rate - other.rate)

    def __mul__(self, other: _Along) -> _Along:
        return _Along(self.value * other.value, self.rate * other.value + self.value * other.rate)

    def __truediv__(self, other: _Along) -> _Along:
        value = self.value / other.value
        return _Along(value, (self.rate - value * other.rate) / other.value)

    def power(self, exponent: Fraction) -> _Along:
        if not exponent:
            return _Along(arb(1), arb(0))
        slope = enclose(exponent) * power(self.value, exponent - 1) if exponent != 1 else arb(1)
        return _Along(power(self.value, exponent), slope * self.rate)


def _constant(number: Fraction) -> _Along:
    return _Along(enclose(number), arb(0))


_FUNCTIONS: Mapping[str, Callable[[_Along], _Along]] = {
    "sin": lambda x: _Along(x.value.sin(), x.value.cos() * x.rate),
    "cos": lambda x: _Along(x.value.cos(), -x.value.sin() * x.rate),
    "exp": lambda x: _Along(x.value.exp(), x.value.exp() * x.rate),
    "log": lambda x: _Along(x.value.log(), x.rate / x.value),
}


def gradient(
    program: Program, arguments: Sequence[arb], names: Sequence[str], system: System | None = None
) -> list[arb]:
    """The partial derivatives of the value of a program in the inputs of these names, at all points of a box.

    Coordinates of the system that are functions of others move with these; their own entries are not used.
    """
    result = []
    for name in names:
        inputs = [_Along(ball, arb(int(name == other))) for ball, other in zip(arguments, program.inputs, strict=True)]
        if system is not None and system.defined:
            from orbitproof.shared.systems import with_functions

            state, parameters = inputs[: len(system.state)], inputs[len(system.state) :]
            inputs = [*with_functions(system, state, parameters, _FUNCTIONS, _constant, _Along.power), *parameters]
        (value,) = program.evaluate(inputs, _constant, _Along.power)
        result.append(value.rate)
    return result


class Level:
    """The level h of the orbits of a claim, as a function on Fix(R), and what is shown of dh along the curve."""

    def __init__(self, atlas: Atlas) -> None:
        self._system = system = atlas.system
        self._names = system.centre_coordinates
        self._is_coordinate = system.family_parameter is not None
        self._program = None if self._is_coordinate else system.first_integral_program
        self._title = level_name(atlas_in_words(atlas))
        self._slopes: dict[str, arb] = {}
        self._known = {name: enclose(system.normalised.get(name, Fraction(0))) for name in system.state}
        self._known |= {name: enclose(value) for name, value in atlas.parameters.items()}
        if self._program is not None and system.derived_parameters:
            from orbitproof.verify.curve import derived_parameter

            for name in system.derived_parameters:
                self._known[name] = derived_parameter(system, name, atlas.parameters, ctx.prec).ball

    def regular(self, stretch: Stretch, segments: Iterable[Segment]) -> tuple[list[Segment], list[Gap]]:
        """The parts of segments on which dh != 0 is shown, and the rest."""
        if self._program is None:
            return list(segments), []
        found: list[Segment] = []
        gaps: list[Gap] = []
        piece = stretch.tube.piece.id
        for segment in segments:
            for low, high, is_regular in self._parts(self._program, stretch, segment.start, segment.end):
                if is_regular:
                    entered = min(max(segment.entered, low), high)
                    found.append(replace(segment, start=low, entered=entered, end=high))
                else:
                    why = f"the derivative of the {self._title} on Fix(R) may vanish there"
                    gaps.append(Gap(segment.stretch, piece, low, high, Matter.EVERYTHING, why))
        return found, gaps

    def _parts(
        self, program: Program, stretch: Stretch, start: Fraction, end: Fraction
    ) -> list[tuple[Fraction, Fraction, bool]]:
        """Parts of a stretch in order, each as long as possible, with whether dh != 0 is shown on all of it."""
        result: list[tuple[Fraction, Fraction, bool]] = []
        pending = [(start, end, 0)]
        while pending:
            low, high, depth = pending.pop()
            slopes = self._gradient(program, stretch, low, high)
            slope = max(filter(excludes_zero, slopes), key=lambda ball: float(ball.abs_lower()), default=None)
            if slope is None and depth < _HALVINGS:
                middle = (low + high) / 2
                pending += [(middle, high, depth + 1), (low, middle, depth + 1)]
                continue
            if slope is not None:
                piece, bound = stretch.tube.piece.id, slope.abs_lower()
                self._slopes[piece] = min(bound, self._slopes.get(piece, bound))
            if result and result[-1][2] == (slope is not None):
                low = result.pop()[0]
            result.append((low, high, slope is not None))
        return result

    def _gradient(self, program: Program, stretch: Stretch, low: Fraction, high: Fraction) -> list[arb]:
        """dh at all points of a part of the curve."""
        point = point_over(stretch, between(low, high))
        known = {**self._known, **dict(zip(self._names, point, strict=True))}
        return gradient(program, [known[name] for name in program.inputs], self._names, self._system)

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """What was shown so far, as the hypothesis `LEVEL`. Raises `NotEstablishedError` if it does not hold."""
        if is_of_axial_orbits(self._system):
            statement = "the level is the Jacobi constant, whose derivative by eps2 z'^2 on Fix(R) is -1"
        elif self._is_coordinate and self._system.normalised:
            statement = (
                "the level is the Jacobi constant, whose derivative by vy is not 0 where the section is crossed "
                f"transversally, as it is by the orbits of the curve (at {self._title} = 0 the limit of that)"
            )
        elif self._is_coordinate:
            statement = f"{self._title} is a coordinate of Fix(R), so its derivative vanishes nowhere"
        else:
            statement = (
                f"the derivative of the {self._title} on Fix(R) vanishes at no point of the curve that the list covers"
            )
        checklist = Checklist()
        with checklist.hypothesis(LEVEL, "18.5", statement, "give another first integral") as evidence:
            evidence.require(self._is_coordinate or self._program is not None, "there is no level")
            for piece, slope in self._slopes.items():
                evidence.record(f"absolute value of a component on {piece}, at least", slope)
                evidence.require(is_positive(slope), "every component may vanish")
        return tuple(checklist.hypotheses)
