"""One orbit of the CR3BP followed over half of its period, with the planes that turn along it (section 35.2)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import acb, arb

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading, Series, evaluate
from orbitproof.verify.evidence import IntegrationFailure, enclose, exact_value, guarded, is_below, power
from orbitproof.verify.flow import advance
from orbitproof.verify.index.half_turns import HalfTurns, Turning, Vectors, determinant, index_of
from orbitproof.verify.index.moving import Moving, moving, reduced
from orbitproof.verify.poincare import Oracle, Orbits, default_order, physical

_UNIT_BITS = 40
_UNIT = Fraction(1, 2**_UNIT_BITS)
"""Size of the variations that are followed; what is wanted is linear in them."""
_DEPTH = 14
_BEYOND = tuple(Fraction(1, 2**bits) for bits in (48, 40, 32, 24, 16, 12))


@dataclass(frozen=True)
class Start:
    """A point of Fix(R) of the CR3BP.

    Attributes:
        system: the CR3BP, with the reversing symmetry R and the section that are meant.
        state: encloses the six coordinates; those that R negates are 0 exactly.
        mu: the mass parameter.
        crossings: of the section by a half orbit, its end included.
        is_planar: whether z = vz = 0; then variations in the plane and across it are separate.
    """

    system: ReversibleSystem
    state: tuple[arb, ...]
    mu: Fraction
    crossings: int
    is_planar: bool


@dataclass(frozen=True)
class Block:
    """Variations that belong together.

    Attributes:
        axes: of the configuration space.
        fixed, negated: numbers of the variables whose coefficients are vectors of each kind.
        with_flow: whether the direction of the orbit is among them.
    """

    axes: tuple[int, ...]
    fixed: tuple[int, ...]
    negated: tuple[int, ...]
    with_flow: bool


@dataclass(frozen=True)
class Part:
    """The orbits at some times of a step, or at the section.

    Attributes:
        field: the vector field along the step.
        variations: by their numbers.
        theta: the times.
    """

    field: Moving
    variations: tuple[Moving, ...]
    theta: arb

    def at(self, theta: arb) -> Part:
        """This step at other times."""
        return replace(self, theta=theta)


def followed(
    start: Start, precision: int, oracle: Oracle, progress: Callable[[int], None] | None = None
) -> tuple[HalfTurns, ...]:
    """The half turns along the half orbit; of a planar one in the plane and across it.

    Raises `IntegrationFailure` if something could not be enclosed.
    """
    with guarded(precision):
        return _HalfOrbit(start, precision, oracle).run(progress)


class _HalfOrbit:
    def __init__(self, start: Start, precision: int, oracle: Oracle) -> None:
        self.start, self.oracle = start, oracle
        signs, size = start.system.reversing_symmetry, len(start.state)
        section = start.system.section_index
        # The velocity across the section, which is not 0 where that is crossed.
        self.speed = section + size // 2
        fixed = [index for index in range(size) if signs[index] == 1 and index != self.speed]
        negated = [index for index in range(size) if signs[index] == -1 and index != section]
        self.directions = [*fixed, *negated]
        self.blocks = self._blocks(len(fixed))
        grading = Grading((1,) * len(self.directions), 1)
        self.arithmetic = Arithmetic(grading, precision, _UNIT_BITS, default_order(precision))
        self.mu = self.arithmetic.constant(start.mu)
        self.orbits = Orbits(physical(start.system), self.arithmetic, self._begin(), [self.mu], oracle)
        begun = self._part(self.orbits.state)
        self.turning = [[Turning(value) for value in self._determinants(block, begun)] for block in self.blocks]

    def _blocks(self, count: int) -> list[Block]:
        """The blocks of the variations; those of a planar orbit are two: of the axes x and y, and of z."""
        numbers = range(len(self.directions))
        if not self.start.is_planar:
            return [Block((0, 1, 2), tuple(numbers[:count]), tuple(numbers[count:]), True)]
        found = []
        for axes in ((0, 1), (2,)):
            own = [number for number in numbers if self.directions[number] % 3 in axes]
            fixed, negated = (tuple(n for n in own if (n < count) == kind) for kind in (True, False))
            found.append(Block(axes, fixed, negated, len(axes) > 1))
        return found

    def _first_variations(self) -> list[list[arb]]:
        """On the level, and in Fix(R) or in what R negates, at the start."""
        gradient = self._gradient(self.start.state)
        rows = []
        for direction in self.directions:
            row = [arb(0)] * len(self.start.state)
            row[direction] = arb(1)
            if self.start.system.reversing_symmetry[direction] == 1:
                row[self.speed] = -gradient[direction] / gradient[self.speed]
            rows.append(row)
        return rows

    def _field(self, state: Sequence[arb]) -> list[arb]:
        values = self.start.system.program.evaluate([*state, enclose(self.start.mu)], enclose, power)
        return [arb(value) for value in values]

    def _gradient(self, state: Sequence[arb]) -> list[arb]:
        """Gradient of the energy (vx^2 + vy^2 + vz^2)/2 - Omega, by the vector field."""
        field, (vx, vy, vz) = self._field(state), state[3:]
        return [2 * vy - field[3], -2 * vx - field[4], -field[5], vx, vy, vz]

    def _begin(self) -> list[Series]:
        """The state with its variations: the coefficient of variable j is `_UNIT` times variation j."""
        count = len(self.directions)
        units = [tuple(int(i == j) for i in range(count)) for j in range(count)]
        variables = [self.arithmetic.polynomial({unit: _UNIT}) for unit in units]
        variations, state = self._first_variations(), []
        for index, ball in enumerate(self.start.state):
            element = _constant(self.arithmetic, ball)
            for variable, row in zip(variables, variations, strict=True):
                if not row[index].is_zero():
                    element = element + _constant(self.arithmetic, row[index]) * variable
            state.append(element)
        return state

    def _part(self, solution: Sequence[Series]) -> Part:
        """A step, at its beginning; or what does not depend on time."""
        field = evaluate(self.orbits.program, [*solution, self.mu])
        numbers = range(1, len(self.directions) + 1)
        variations = (moving(solution, number, _UNIT) for number in numbers)
        return Part(moving(field, 0, Fraction(1)), tuple(variations), arb(0))

    def _canonical(self, vector: Sequence[arb], block: Block) -> tuple[acb, ...]:
        """q - i p on the axes of a block, turned so that Fix(R) is R^N and R negates i R^N (section 35.2)."""
        x, y, z, vx, vy, vz = vector
        pairs = ((x, vx - y), (y, vy + x), (z, vz))
        signs = self.start.system.reversing_symmetry
        return tuple(
            acb(q, -p) / (acb(1) if signs[k] == 1 else acb(0, 1)) for k, (q, p) in enumerate(pairs) if k in block.axes
        )

    def _vectors(self, block: Block, part: Part) -> tuple[Vectors, Vectors, Vectors]:
        """The field divided by i, if it belongs to the block, and the vectors (35.3) of both kinds."""

        def canonical(vector: Moving, theta: arb) -> tuple[acb, ...]:
            return self._canonical(vector.over(theta), block)

        flow = [part.field] if block.with_flow else []
        along = tuple(tuple(entry / acb(0, 1) for entry in canonical(vector, part.theta)) for vector in flow)
        fixed, negated = (
            tuple(
                canonical(vector, part.theta)
                for vector in reduced([*flow, *(part.variations[number] for number in numbers)], canonical, part.theta)
            )[len(flow) :]
            for numbers in (block.fixed, block.negated)
        )
        return along, fixed, negated

    def _determinants(self, block: Block, part: Part) -> tuple[acb, acb]:
        along, fixed, negated = self._vectors(block, part)
        return determinant((*along, *fixed)), determinant((*along, *negated))

    def run(self, progress: Callable[[int], None] | None) -> tuple[HalfTurns, ...]:
        def after_step(steps: int) -> None:
            assert self.orbits.step_taken is not None
            self._cover(self._part(self.orbits.step_taken[0].solution), Fraction(0), Fraction(1))
            if progress is not None:
                progress(steps)

        for _ in range(self.start.crossings):
            image, _ = self.orbits.next_crossing(after_step)
        end = self._part(image)
        self._to_the_section(end)
        return tuple(
            index_of([each.angle for each in turning], *self._vectors(block, end))
            for block, turning in zip(self.blocks, self.turning, strict=True)
        )

    def _cover(self, step: Part, left: Fraction, right: Fraction, depth: int = 0) -> None:
        """A step from one time to another, or its halves."""
        low, high = enclose(left), enclose(right)
        if self._go_on([step.at(low.union(high))], step.at(high)):
            return
        if depth == _DEPTH:
            raise _lost("the vectors are not enclosed well enough along the orbit")
        middle = (left + right) / 2
        self._cover(step, left, middle, depth + 1)
        self._cover(step, middle, right, depth + 1)

    def _go_on(self, over: Sequence[Part], end: Part) -> bool:
        """Follow all arguments, over the parts of the way and to its end, if all of them are known there."""
        ways: list[tuple[Turning, list[acb], acb]] = []
        for block, both in zip(self.blocks, self.turning, strict=True):
            on_the_way = zip(*(self._determinants(block, part) for part in over), strict=True)
            for turning, values, value in zip(both, on_the_way, self._determinants(block, end), strict=True):
                ways.append((turning, list(values), value))
        if not all(turning.reaches(values, value) for turning, values, value in ways):
            return False
        for turning, _, value in ways:
            turning.go_on(value)
        return True

    def _to_the_section(self, end: Part) -> None:
        """From the end of the last step, forwards or backwards, to where the orbit meets the section (35.2)."""
        orbits = self.orbits
        assert orbits.step_taken is not None
        flow, _, length = orbits.step_taken
        (delay,) = moving([orbits.delay], 0, Fraction(1)).over(arb(0))
        expansion = orbits.oracle.expand(orbits.program, self.arithmetic, orbits.state, orbits.fixed)
        for further in _BEYOND:
            if further <= length and is_below(abs(delay), enclose(further)):
                beyond = advance(orbits.program, orbits.state, orbits.fixed, expansion, further)
                back = enclose(1 - further / length).union(arb(1))
                over = [self._part(flow.solution).at(back), self._part(beyond.solution).at(arb(0).union(arb(1)))]
                if self._go_on(over, end):
                    return
        raise _lost("the end of the half orbit is not enclosed well enough")


def _constant(arithmetic: Arithmetic, ball: arb) -> Series:
    """An unknown number in a ball."""
    return arithmetic.constant(exact_value(ball.mid())).widened(exact_value(ball.rad()))


def _lost(why: str) -> IntegrationFailure:
    return IntegrationFailure("half turns", why, "take another orbit, or more precision", needs_precision=True)
