"""What is enclosed: balls over a box, at its centre, on parts of it; or the reason why there are none."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from flint import arb

from orbitproof.shared.systems import System
from orbitproof.verify.enclose.numbers import Number, exact
from orbitproof.verify.enclose.sets import Box, Section
from orbitproof.verify.evidence import (
    MAX_ORDER,
    DerivativeTable,
    MultiIndex,
    Reason,
    dot,
    enclose,
    guarded,
    indices_up_to,
    meet,
    symmetric,
)
from orbitproof.verify.maps import Image, Zeros, combination
from orbitproof.verify.newton import BoxFunction


@dataclass(frozen=True)
class NotEnclosed:
    """Nothing was enclosed, which does not show that there is nothing to enclose. False as a truth value.

    Attributes:
        reason: what stopped it and what to try: `reason.condition`, `reason.message`, `reason.remedy`, and the time
            that was reached, `reason.reached`, where orbits were followed.
        precision: bits of the last attempt.
    """

    reason: Reason
    precision: int

    def __bool__(self) -> bool:
        return False

    def __str__(self) -> str:
        reached = "" if self.reason.reached is None else f" at time {self.reason.reached:.6g}"
        return f"not enclosed{reached}, {self.precision} bits: {self.reason.message}; {self.reason.remedy}"


@dataclass(frozen=True)
class Function:
    """A function on a box, known by enclosures of its derivatives up to order 3 there and at the centre.

    Attributes:
        box: its variables are p_1, p_2, .. of this box.
        table: the enclosures.
        precision: bits with which they were found.
    """

    box: Box
    table: DerivativeTable = field(repr=False)
    precision: int

    def over(self, where: Sequence[arb], derivative: Sequence[int] | None = None) -> arb:
        """The values, or those of a partial derivative up to order 3, at all points of the box with p_j in where[j].

        By Taylor's formula about the centre (section 7.2), so that narrow parts have narrow enclosures. What lies
        beyond the box does not count. Raises `ValueError` for another number of variables, for another derivative, and
        for balls that contain no point of the box.
        """
        index = (0,) * len(self.box.radii) if derivative is None else tuple(derivative)
        if len(where) != len(self.box.radii) or len(index) != len(where):
            raise ValueError(f"where: give a ball for each of the {len(self.box.radii)} variables of the box")
        if index not in self.table.box:
            raise ValueError(
                f"derivative: {index} is none; give whole numbers from 0 on whose sum is {MAX_ORDER} at most"
            )
        with guarded(self.precision):
            return BoxFunction(self.table).derivative(index, _inside("where", where, self.box.radii))


def _inside(key: str, where: Sequence[arb], radii: Sequence[Fraction]) -> list[arb]:
    """The parts of balls that lie in the box. Raises `ValueError` if one has none."""
    for ball, radius in zip(where, radii, strict=True):
        if not ball.overlaps(symmetric(radius)):
            raise ValueError(f"{key}: {ball.str(8)} contains no point of [-{radius}, {radius}]; give balls in the box")
    return [meet(ball, symmetric(radius)) for ball, radius in zip(where, radii, strict=True)]


@dataclass(frozen=True)
class Values:
    """Enclosures that hold at every point of a set, or at one point.

    Attributes:
        value: the state, by name of the coordinate.
        jacobian: its first derivatives by the variables p_1, p_2, .. of the box, by name.
        derivatives: all partial derivatives up to the order asked for, by name and multi-index: (2, 0) is the second
            one by p_1.
        time: the time that the orbits take.
        time_derivatives: its derivatives.
    """

    value: Mapping[str, arb]
    jacobian: Mapping[str, tuple[arb, ...]]
    derivatives: Mapping[str, Mapping[MultiIndex, arb]]
    time: arb
    time_derivatives: Mapping[MultiIndex, arb]


@dataclass(frozen=True)
class Enclosure:
    """The states at which orbits arrive that begin in a box, and the times, as functions of the box's variables.

    `value`, `jacobian`, `derivatives` and `time` (see `Values`) are valid at every real point of the box; those of
    `centre` at its centre, and those of `over` on parts. Balls are `flint.arb`.

    Attributes:
        system, box: what was asked about.
        order: largest order of the derivatives.
        precision: bits of the integration.
        section: the section on which the states are; `None` for the flow over a given time.
    """

    system: System
    box: Box
    order: int
    precision: int
    image: Image = field(repr=False)
    section: Section | None = None

    def __str__(self) -> str:
        state = ", ".join(f"{name} = {ball}" for name, ball in self.value.items())
        return f"{state} at time {self.time}; {self.precision} bits, {self.steps} steps"

    @property
    def steps(self) -> int:
        """Number of integration steps."""
        return self.image.steps

    @property
    def on_box(self) -> Values:
        """Enclosures that hold at every point of the box."""
        return self._values(lambda table, index: table.box[index])

    @property
    def centre(self) -> Values:
        """Enclosures that hold at the centre of the box."""
        return self._values(lambda table, index: table.centre[index])

    @property
    def value(self) -> Mapping[str, arb]:
        """The state over the box, by name."""
        return self.on_box.value

    @property
    def jacobian(self) -> Mapping[str, tuple[arb, ...]]:
        """First derivatives of the state by the box's variables, over the box, by name."""
        return self.on_box.jacobian

    @property
    def derivatives(self) -> Mapping[str, Mapping[MultiIndex, arb]]:
        """Derivatives of the state over the box, by name and multi-index."""
        return self.on_box.derivatives

    @property
    def time(self) -> arb:
        """The time over the box."""
        return self.on_box.time

    def over(self, where: Sequence[arb]) -> Values:
        """Enclosures at all points of the box with p_j in where[j] (see `Function.over`)."""
        return self._values(lambda table, index: Function(self.box, table, self.precision).over(where, index))

    def function(
        self, factors: Mapping[str, Number], constant: Number = 0, variables: Sequence[Number] = ()
    ) -> Function:
        """The function factors . state + variables . p + constant of the box's variables p.

        Arguments:
            factors: by name of a state coordinate; those that are absent count 0 times.
            variables: a number for each variable of the box; none if there are none.

        Raises `ValueError`.
        """
        state = self.system.state
        for name in factors:
            if name not in state:
                raise ValueError(f"factors: {name!r} is no state coordinate; there are {', '.join(state)}")
        if len(variables) not in (0, len(self.box.radii)):
            raise ValueError(f"variables: give a number for each of the {len(self.box.radii)} variables of the box")
        row = [exact(f"factors.{name}", factors.get(name, 0)) for name in state]
        own = [exact("variables", value) for value in variables] or [Fraction(0)] * len(self.box.radii)
        with guarded(self.precision):
            start = self.box.of(self.system)
            table = combination(start, self.image.state, row, own, exact("constant", constant))
        return Function(self.box, table, self.precision)

    def _values(self, get: Callable[[DerivativeTable, MultiIndex], arb]) -> Values:
        indices = indices_up_to(len(self.box.radii), self.order)
        zero = (0,) * len(self.box.radii)
        units = [index for index in indices if sum(index) == 1][: len(zero)]
        tables = dict(zip(self.system.state, self.image.state, strict=True))
        derivatives = {name: {index: get(table, index) for index in indices} for name, table in tables.items()}
        return Values(
            {name: found[zero] for name, found in derivatives.items()},
            {name: tuple(found[unit] for unit in units) for name, found in derivatives.items()},
            derivatives,
            get(self.image.time, zero),
            {index: get(self.image.time, index) for index in indices},
        )


@dataclass(frozen=True)
class Zero:
    """For each value of the independent variables the functions have exactly one common zero in the box.

    Attributes:
        box: the box in which that is so.
        independent: how many of the first variables of the box are independent; the others are the unknowns.
        at: enclosures of all variables at the zeros, the independent ones in their intervals.
        precision: bits with which the functions were found.
    """

    box: Box
    independent: int
    at: tuple[arb, ...]
    precision: int
    zeros: Zeros = field(repr=False)

    @property
    def point(self) -> Mapping[str, arb]:
        """Enclosures of the initial values at the zeros, by name."""
        with guarded(self.precision):
            rows = {name: [enclose(value) for value in self.box.row(name)] for name in self.box.centre}
            return {name: enclose(self.box.centre[name]) + dot(row, self.at) for name, row in rows.items()}

    def over(self, independent: Sequence[arb]) -> tuple[arb, ...]:
        """All variables at the zeros whose independent variables are in the given balls.

        What lies beyond the box does not count. Raises `ValueError` for another number of them, and for balls that
        contain no point of the box.
        """
        if len(independent) != self.independent:
            raise ValueError(f"independent: give a ball for each of the {self.independent} independent variables")
        with guarded(self.precision):
            return self.zeros.graph.over(_inside("independent", independent, self.box.radii[: self.independent]))
