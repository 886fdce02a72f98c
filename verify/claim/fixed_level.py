"""Fixed levels of a first integral that may be any function of the level coordinate w (section 12.6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import FixedLevel, Program, ReversibleSystem, with_slope
from orbitproof.verify.claim.functions import behind_functions, enclose_functions
from orbitproof.verify.evidence import Checklist, enclose, excludes_zero, hull, is_below, power, symmetric

_MOST_PARTS = 2048
"""Parts of the interval of the level coordinate, on each of which the derivative of the first integral is enclosed."""


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
        """The equation of a system with a fixed level. Raises `ValueError` if w is in a function that H depends on."""
        program, name, level = system.first_integral_program, system.level_coordinate, system.fixed_level
        if program is None or name is None or level is None or level.between is None:
            raise ValueError("no interval of a coordinate is given in which it follows from the level")
        if name in behind_functions(system, program):
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


def check_interval(checklist: Checklist, candidate: Candidate, level: FixedLevel) -> None:
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
    return [*enclose_functions(system, state, parameters), *parameters]
