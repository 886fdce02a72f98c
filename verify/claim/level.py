"""The level of the first integral as bifurcation parameter, and fixed levels (section 12).

If H = A + b w^2 with A independent of the coordinate w and a constant b, then on Fix(R) w follows from
the level h of H and the other coordinates: w = +-((h - A) / b)^(1/2). With w formed in this way the
Poincare maps on the levels of H are a family of maps with the parameter h. On a fixed level w may follow from
any H whose derivative in w is not 0 in an interval of w (section 12.6).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import FixedLevel, Program, ReversibleSystem, record, with_functions, with_slope
from orbitproof.verify.claim.first_integral import derivative_terms
from orbitproof.verify.evidence import FUNCTIONS, Checklist, enclose, excludes_zero, hull, is_below, power, symmetric

_MOST_PARTS = 2048
"""Of the interval of the level coordinate, on which the derivative of the first integral is enclosed one by one."""


def quadratic_coefficient(system: ReversibleSystem) -> Fraction | None:
    """The constant b if the program of H shows H = A + b w^2, w the level coordinate; else `None`."""
    program, name = system.first_integral_program, system.level_coordinate
    if program is None or name is None or name in _behind_functions(system, program):
        return None
    terms = derivative_terms(program, name)
    linear = tuple(int(argument == name) for argument in program.inputs)
    return terms.get(linear, Fraction(0)) / 2 if terms is not None and set(terms) <= {linear} else None


def _behind_functions(system: ReversibleSystem, program: Program) -> set[str]:
    """The inputs in the arguments of the functions that occur in a program, and in the arguments of those in them."""
    arguments = dict(zip((each.name for each in system.defined), system.argument_programs, strict=True))
    pending, found = list(program.used_inputs), set[str]()
    while pending:
        if (name := pending.pop()) in arguments:
            new = arguments[name].used_inputs - found
            found |= new
            pending += new
    return found


def level_program(system: ReversibleSystem, sign: int) -> Program:
    """The level coordinate w; inputs: state (its own entry is not used), parameters, level of H.

    Raises `ValueError` if H was not shown to be A + b w^2 with b != 0.
    """
    coefficient = quadratic_coefficient(system)
    integral, name = system.first_integral, system.level_coordinate
    if not coefficient or integral is None or name is None:
        raise ValueError(f"the first integral of {system.name} was not shown to be quadratic in a coordinate")
    position = system.state.index(name)

    def coordinate(state: Sequence[Any], parameters: Sequence[Any], level: Sequence[Any]) -> Sequence[Any]:
        (rest,) = integral([0 if i == position else value for i, value in enumerate(state)], parameters)
        return (((level[0] - rest) * (1 / coefficient)) ** Fraction(1, 2) * sign,)

    return record(coordinate, system.state, tuple(system.parameters), ("level",))


@dataclass(frozen=True)
class LevelEquation:
    """H(w, ..) = h for w in an interval, the other coordinates given (section 12.6).

    Attributes:
        name, place: of the coordinate w; the latter among the inputs.
        both: the program of H and of its derivative in w; inputs: state, then parameters.
        level: h, and the ends of the interval.
    """

    name: str
    place: int
    both: Program
    level: FixedLevel

    @classmethod
    def of(cls, system: ReversibleSystem) -> LevelEquation:
        """That of a system with a fixed level. Raises `ValueError` if w is in a function that H depends on."""
        program, name, level = system.first_integral_program, system.level_coordinate, system.fixed_level
        if program is None or name is None or level is None or level.between is None:
            raise ValueError("no interval of a coordinate is given in which it follows from the level")
        if name in _behind_functions(system, program):
            raise ValueError(f"the first integral depends on a function of {name}")
        return cls(name, system.state.index(name), with_slope(program, name), level)

    def at(self, arguments: Sequence[arb], w: arb) -> tuple[arb, arb]:
        """H - h and its derivative in w, for balls of all inputs; the entry of w is not used."""
        values = [*arguments[: self.place], w, *arguments[self.place + 1 :]]
        height, slope = self.both.evaluate(values, enclose, power)
        return height - enclose(self.level.value), slope

    def slope(self, arguments: Sequence[arb]) -> arb | None:
        """A ball without 0 that contains dH/dw at all w of the closed interval, `None` if there is none."""
        low, high = self.level.ends
        assert low is not None
        assert high is not None
        pending, found = [(low, high)], list[arb]()
        while pending:
            left, right = pending.pop()
            _, slope = self.at(arguments, enclose((left + right) / 2) + symmetric((right - left) / 2))
            if excludes_zero(slope):
                found.append(slope)
            elif len(found) + len(pending) < _MOST_PARTS and right - left > (high - low) / _MOST_PARTS:
                middle = (left + right) / 2
                pending += [(middle, right), (left, middle)]
            else:
                return None
        slope = hull(*found)
        return slope if excludes_zero(slope) else None

    def contains(self, w: arb) -> bool:
        """Whether a ball lies in the open interval."""
        return is_in(self.level, w)


def is_in(level: FixedLevel, w: arb) -> bool:
    """Whether a ball lies in the open interval of w that is meant on a level."""
    low, high = level.ends
    above = low is None or is_below(enclose(low), w)
    return w.is_finite() and above and (high is None or is_below(w, enclose(high)))


def check_level(checklist: Checklist, candidate: Candidate) -> None:
    """That w follows from the level at all points of the box; S leaves the sheet alone (`adapted-frames`)."""
    fixed = candidate.system.fixed_level
    if fixed is not None and fixed.between is not None:
        _check_interval(checklist, candidate, fixed)
        return
    statement = "the first integral is A + b w^2, w the level coordinate, A independent of w, b a constant other than 0"
    with checklist.hypothesis(
        "level", "12", statement, "give the candidate in the coordinates of Fix(R), without parameter"
    ) as evidence:
        coefficient = quadratic_coefficient(candidate.system)
        evidence.require(bool(coefficient), "the program of the first integral does not show it")
        if coefficient:
            evidence.record("b", enclose(coefficient))


def _check_interval(checklist: Checklist, candidate: Candidate, level: FixedLevel) -> None:
    """Over each point of the box there is one w in its interval with H = h, and dH/dw is not 0 there (Lemma 12.3)."""
    statement = (
        "over each point of the box the first integral, less its level, changes its sign from one end of the interval "
        "of the level coordinate to the other, and its derivative in that coordinate is not 0 in between"
    )
    with checklist.hypothesis("level", "12.6", statement, "give fixed_level another interval (between)") as evidence:
        try:
            equation = LevelEquation.of(candidate.system)
        except ValueError as error:
            evidence.require(False, str(error))
            return
        arguments = on_box(candidate)
        ends = [equation.at(arguments, enclose(end))[0] for end in level.ends if end is not None]
        for which, ball in zip(("lower", "upper"), ends, strict=True):
            evidence.record(f"H - h at the {which} end", ball)
        slope = equation.slope(arguments)
        if slope is not None:
            evidence.record(f"dH/d{equation.name}", slope)
        evidence.require(slope is not None, f"dH/d{equation.name} may vanish in the interval")
        evidence.require(
            excludes_zero(ends[0]) and excludes_zero(ends[1]) and is_below(ends[0] * ends[1], arb(0)),
            "no sign change is shown",
        )


def on_box(candidate: Candidate, moved: Mapping[str, arb] | None = None) -> list[arb]:
    """Balls of the state, whose level coordinate is not used, and of the parameters on the box of a claim.

    Args:
        moved: state coordinates that have other values.
    """
    system = candidate.system
    named = {name: enclose(value) for name, value in candidate.parameters.items()}
    for name, origin, row in zip(candidate.coordinates, candidate.centre, candidate.frame, strict=True):
        spread = sum((abs(a) * radius for a, radius in zip(row, candidate.radii, strict=True)), Fraction(0))
        named[name] = enclose(origin) + symmetric(spread)
    named |= moved or {}
    parameters = [named[name] for name in system.parameters]
    state = [named.get(name, enclose(system.normalised.get(name, Fraction(0)))) for name in system.state]
    return [*with_functions(system, state, parameters, FUNCTIONS, enclose, power), *parameters]


def point_on_fixed_set(candidate: Candidate, where: Mapping[str, arb]) -> dict[str, arb]:
    """Enclosures of all coordinates of Fix(R), from those of the level and the other coordinates."""
    system, sign = candidate.system, candidate.level_sign
    if sign is None:
        raise ValueError("the candidate is given in the coordinates of Fix(R)")
    program = level_program(system, sign)
    state = [where.get(name, arb(0)) for name in system.state]
    parameters = [enclose(candidate.parameters[name]) for name in system.parameters]
    arguments = [*with_functions(system, state, parameters, FUNCTIONS, enclose, power), *parameters]
    (value,) = program.evaluate([*arguments, where[candidate.coordinates[0]]], enclose, power)
    named = {**where, str(system.level_coordinate): value}
    return {name: named[name] for name in system.centre_coordinates}
