"""The box of a claim in its section, and functions of the state on it (sections 24.1 and 24.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import InSection
from orbitproof.shared.systems import Program, System
from orbitproof.verify.claim import inverse, keeps_integral
from orbitproof.verify.evidence import Checklist, dot, enclose, is_positive, power, symmetric, total
from orbitproof.verify.maps import AffineSection


@dataclass(frozen=True)
class SectionCoordinates:
    """The coordinates p of points of a section: centre + frame p for p, and p for centre + frame p.

    Attributes:
        pivot: a coordinate that follows from the others on the section.
        rows: shape (N - 1, N - 1), exact; p is this matrix times the other coordinates, those of the centre taken off.
    """

    pivot: int
    rows: tuple[tuple[Fraction, ...], ...]

    def of(self, differences: Sequence[arb]) -> list[arb]:
        """p for x - centre, all N coordinates, of a point on the section; the same for derivatives of x."""
        others = [value for i, value in enumerate(differences) if i != self.pivot]
        return [dot([enclose(value) for value in row], others) for row in self.rows]


def section_coordinates(claim: InSection) -> SectionCoordinates | None:
    """p as a function of the state; `None` where the columns of the frame do not span the section."""
    pivot = max(range(len(claim.normal)), key=lambda i: abs(claim.normal[i]))
    rows = inverse([row for i, row in enumerate(claim.frame) if i != pivot])
    return None if rows is None else SectionCoordinates(pivot, tuple(map(tuple, rows)))


def section_of(system: System, normal: Sequence[Fraction], offset: Fraction) -> AffineSection:
    """A section with a normal in the coordinates that are given, among all that are followed."""
    return AffineSection((*normal, *[Fraction(0)] * len(system.defined)), offset)


def functions_at_start(system: System) -> tuple[tuple[str, Program], ...]:
    """What the further coordinates of a `StartingSet` are, from the given ones (section 24.7)."""
    kinds = [each.function for each in system.defined]
    return tuple(zip(kinds, system.argument_programs, strict=True))


def check_coordinates(checklist: Checklist, claim: InSection) -> None:
    """The box lies in the section, and p are coordinates of it, exactly (section 24.1)."""
    statement = "the normal is not 0, the centre lies on the section, and the columns of the frame span it"
    remedy = "put the centre and the frame onto the section"
    with checklist.hypothesis("section", "24.1", statement, remedy) as evidence:
        evidence.require(any(claim.normal), "the normal is 0")
        evidence.require(_product(claim.normal, claim.centre) == claim.offset, "the centre is not on the section")
        columns = list(zip(*claim.frame, strict=True))
        along = all(_product(claim.normal, column) == 0 for column in columns)
        evidence.require(along, "a column of the frame does not lie along the section")
        if any(claim.normal):
            evidence.require(section_coordinates(claim) is not None, "the columns of the frame are not independent")


def _product(left: Sequence[Fraction], right: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(left, right, strict=True)), Fraction(0))


def check_functions_of(checklist: Checklist, system: System) -> None:
    """Where the field has functions: that they are followed as such (section 24.7)."""
    if system.defined:
        from orbitproof.verify.claim.functions import check_functions

        check_functions(checklist, system)


def check_integral(checklist: Checklist, claim: InSection) -> None:
    """H is a first integral, by the identity grad H . f = 0 (section 1.4)."""
    statement = "grad H . f = 0 identically, H the first integral whose level is claimed (1.4)"
    remedy = (
        "correct the description of the system; if H is constant along orbits, write it without divisors and roots "
        "that the vector field does not have: for such an H this may be true and not be recognised"
    )
    with checklist.hypothesis("first-integral", "24.1", statement, remedy) as evidence:
        integral = claim.system.first_integral_program
        evidence.require(integral is not None, "the system has no first integral")
        if integral is not None:
            evidence.require(keeps_integral(claim.system), "H was not shown to be constant along orbits")


def check_transversal(checklist: Checklist, claim: InSection) -> None:
    """On the whole box the flow crosses the section in the direction of the claim (section 24.1)."""
    word = "positive" if claim.direction > 0 else "negative"
    statement, remedy = f"normal . f is {word} on the box", "claim the other direction, or give smaller radii"
    with checklist.hypothesis("direction", "24.1", statement, remedy) as evidence:
        velocity = values_on(claim.system.program, claim, state_on_box(claim))
        normal = [enclose(value) for value in claim.normal]
        across = evidence.record("normal . f", dot(normal, velocity[: len(normal)]))
        excluded = is_positive(-claim.direction * across)
        evidence.require(is_positive(claim.direction * across), "it may have the other sign", excluded=excluded)


def state_on_box(claim: InSection, sides: Sequence[arb] | None = None) -> list[arb]:
    """Enclosures of the state at the points of the box with p in `sides`, by default the whole box."""
    where = [symmetric(radius) for radius in claim.radii] if sides is None else list(sides)
    return [
        enclose(origin) + dot([enclose(value) for value in row], where)
        for origin, row in zip(claim.centre, claim.frame, strict=True)
    ]


def values_on(program: Program, claim: InSection, state: Sequence[arb]) -> list[arb]:
    """Enclosures of functions of state and parameters, the state in balls, at all parameters of the claim."""
    parameters = parameters_on_box(claim)
    return program.evaluate([*whole_state(claim.system, state, parameters), *parameters], enclose, power)


def whole_state(system: System, state: Sequence[arb], parameters: Sequence[arb]) -> Sequence[arb]:
    """The state with the coordinates that are functions of those given."""
    if not system.defined:
        return state
    from orbitproof.verify.claim.functions import enclose_functions

    return enclose_functions(system, [*state, *[arb(0)] * len(system.defined)], parameters)


def parameters_on_box(claim: InSection) -> list[arb]:
    """Enclosures of the parameters on the box: their values, and all values of one that varies."""
    balls = {name: enclose(value) for name, value in claim.parameters.items()}
    if claim.parameter is not None:
        balls[claim.parameter] = balls[claim.parameter] + symmetric(claim.parameter_radius)
    return [balls[name] for name in claim.system.parameters]


def gradient_on(program: Program, claim: InSection, state: Sequence[arb]) -> list[arb]:
    """Enclosures of the derivatives of a function of one value in the coordinates p, at all points of balls."""
    columns = list(zip(*claim.frame, strict=True))
    return slopes_along(program, state, parameters_on_box(claim), columns, claim.system)


def slopes_along(
    program: Program,
    state: Sequence[arb],
    parameters: Sequence[arb],
    columns: Sequence[Sequence[Fraction]],
    system: System | None = None,
) -> list[arb]:
    """Enclosures of the derivatives of a function of one value along vectors of the state space, on balls.

    Args:
        system: whose coordinates follow from those of `state`, if it has such; else none do.
    """
    zero = (arb(0),) * len(columns)

    def constant(value: Fraction) -> _Linear:
        return _Linear(enclose(value), zero)

    moving = [_Linear(ball, tuple(enclose(column[i]) for column in columns)) for i, ball in enumerate(state)]
    fixed = [_Linear(value, zero) for value in parameters]
    if system is not None and system.defined:
        from orbitproof.verify.claim.functions import with_slopes

        moving = with_slopes(system, moving, fixed, constant)
    (value,) = program.evaluate([*moving, *fixed], constant, _Linear.power)
    return list(value.slopes)


@dataclass(frozen=True)
class _Linear:
    """Values of a function at all points of a set, and of its derivatives."""

    value: arb
    slopes: tuple[arb, ...]

    def __add__(self, other: _Linear) -> _Linear:
        return _Linear(self.value + other.value, tuple(map(_plus, self.slopes, other.slopes)))

    def __sub__(self, other: _Linear) -> _Linear:
        return self + _Linear(-other.value, tuple(-slope for slope in other.slopes))

    def __mul__(self, other: _Linear) -> _Linear:
        slopes = (total((a * other.value, self.value * b)) for a, b in zip(self.slopes, other.slopes, strict=True))
        return _Linear(self.value * other.value, tuple(slopes))

    def __truediv__(self, other: _Linear) -> _Linear:
        return self * other.power(Fraction(-1))

    def power(self, exponent: Fraction) -> _Linear:
        """By d(u^a) = a u^(a - 1) du."""
        if exponent == 0:
            return _Linear(arb(1), (arb(0),) * len(self.slopes))
        return self.composed(power(self.value, exponent), enclose(exponent) * power(self.value, exponent - 1))

    def composed(self, value: arb, slope: arb) -> _Linear:
        """A function of it, with its values and its derivatives at those of this one."""
        return _Linear(value, tuple(slope * each for each in self.slopes))


def _plus(left: arb, right: arb) -> arb:
    return left + right
