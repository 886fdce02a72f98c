"""Systems: vector field and parameters; of reversible ones symmetries, section, first integral.

A system is one `System` value, a reversible one a `ReversibleSystem`. Neither the integrator nor the theorems know
any system by name: a further one is a file of its own (`description`).

All symmetries are diagonal sign matrices in the state coordinates, the section is the vanishing of
one state coordinate, and Fix(R) lies in the section. Coordinates on the section are split into
those that R fixes (they parametrise Fix(R)) and those that it negates (they vanish on Fix(R)).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

from orbitproof.shared.systems.names import LEVEL_NAME
from orbitproof.shared.systems.program import Program, record

VectorField = Callable[[Sequence[Any], Sequence[Any]], Sequence[Any]]


@dataclass(frozen=True)
class ParameterRange:
    """The open interval of admissible values of a parameter (`None`: unbounded)."""

    lower: Fraction | None
    upper: Fraction | None

    def contains(self, value: Fraction) -> bool:
        """Whether `value` lies inside."""
        return (self.lower is None or self.lower < value) and (self.upper is None or value < self.upper)

    def __str__(self) -> str:
        low = "-inf" if self.lower is None else str(self.lower)
        high = "inf" if self.upper is None else str(self.upper)
        return f"({low}, {high})"


@dataclass(frozen=True)
class DerivedParameter:
    """A parameter that follows from the given ones: the only zero of an increasing function on an open interval.

    Attributes:
        equation: plain arithmetic like a vector field, called with ([value], given parameters), returns one value.
        interval: plain arithmetic, called with the given parameters, returns both ends (`None`: unbounded).
    """

    equation: VectorField
    interval: Callable[[Sequence[Any]], tuple[Any, Any]]


@dataclass(frozen=True)
class FixedLevel:
    """The level of a first integral on which orbits are looked for, and which of its points are meant.

    Attributes:
        value: of the first integral.
        sign: of the level coordinate w, if the first integral is A + b w^2.
        between: otherwise the ends of an open interval of w, in which the level has one w over the other coordinates.
    """

    value: Fraction
    sign: int | None = None
    between: tuple[Fraction, Fraction] | None = None

    @property
    def ends(self) -> tuple[Fraction | None, Fraction | None]:
        """Ends of the interval of w that is meant; `None` stands for no end."""
        if self.between is not None:
            return self.between
        return (Fraction(0), None) if self.sign == 1 else (None, Fraction(0))


@dataclass(frozen=True)
class Reversor:
    """A further reversing symmetry of a system.

    Attributes:
        signs: as those of R.
        title: what people call it.
        section, level_coordinate: the state coordinates that go with it; `None` where it is that of R.
    """

    signs: tuple[int, ...]
    title: str
    section: str | None = None
    level_coordinate: str | None = None


@dataclass(frozen=True)
class Defined:
    """A state coordinate that is a function of the others at all states that are meant.

    Attributes:
        name: of the coordinate.
        function: "sin", "cos", "exp" or "log".
        argument: plain arithmetic like the vector field, of coordinates before this one; returns one value.
    """

    name: str
    function: str
    argument: VectorField


@dataclass(frozen=True, repr=False)
class System:
    """x' = vector_field(x, parameters), of which no symmetry is known.

    Attributes:
        name: the key in the JSON formats.
        title: the name that people read.
        state: names of the state coordinates, m of them.
        parameters: admissible open interval of each parameter, by name, in the vector field's order.
        vector_field: plain arithmetic, called with (state, parameters), returns m values.
        first_integral: plain arithmetic like the vector field, returns one value; `None` if absent.
        first_integral_name: what people call it.
        defined: the last state coordinates, if these are functions of the others, in order.
    """

    name: str
    title: str
    state: tuple[str, ...]
    parameters: Mapping[str, ParameterRange]
    vector_field: VectorField
    first_integral: VectorField | None = field(default=None, kw_only=True)
    first_integral_name: str | None = field(default=None, kw_only=True)
    defined: tuple[Defined, ...] = field(default=(), kw_only=True)

    def __post_init__(self) -> None:
        names = (*self.state, *self.parameters)
        for name in names:
            if not name.rstrip("'").isidentifier():
                raise ValueError(f"{self.name}: {name!r} is no name of a coordinate or parameter")
            if names.count(name) > 1:
                raise ValueError(f"{self.name}: two of its coordinates and parameters are called {name!r}")

    def __repr__(self) -> str:
        parameters = f", parameters {' '.join(self.parameters)}" if self.parameters else ""
        return f"<{type(self).__name__} {self.name}: state {' '.join(self.state)}{parameters}>"

    @cached_property
    def program(self) -> Program:
        """The vector field as a straight-line program; inputs: state, then parameters."""
        return record(self.vector_field, self.state, tuple(self.parameters))

    @cached_property
    def first_integral_program(self) -> Program | None:
        """The first integral as such a program; `None` if absent."""
        return self._recorded(self.first_integral)

    @cached_property
    def given_state(self) -> tuple[str, ...]:
        """The state coordinates that are not functions of others."""
        return self.state[: len(self.state) - len(self.defined)]

    def is_given(self, index: int) -> bool:
        """Whether the state coordinate of this index is no function of others."""
        return index < len(self.given_state)

    @cached_property
    def argument_programs(self) -> tuple[Program, ...]:
        """The arguments of `defined`; inputs: state, then parameters."""
        return tuple(record(each.argument, self.state, tuple(self.parameters)) for each in self.defined)

    def _recorded(self, function: VectorField | None) -> Program | None:
        return None if function is None else record(function, self.state, tuple(self.parameters))


@dataclass(frozen=True, repr=False)
class ReversibleSystem(System):
    """A system that is reversible under the involution R = diag(reversing_symmetry): a `System` with more attributes.

    Attributes:
        reversing_symmetry: m signs; f(R x) = -R f(x). Of coordinates that are functions of others: how they change
            with these.
        symmetries: further symmetries, by name, m signs each; f(S x) = S f(x), S commutes with R.
        section: the state coordinate whose vanishing defines the Poincare section; R negates it.
        family_parameter: the parameter of the vector field in which the maps form a family (C1-C4),
            or `None` when the level of `first_integral` is the bifurcation parameter (HC2-HC4).
        level_coordinate: a state coordinate w, fixed by R, in which the first integral is quadratic:
            H = A + b w^2, with A independent of w and a constant b. On Fix(R) it then follows from the level
            of H and the other coordinates up to its sign. `None` if there is no such coordinate. On a fixed level H may
            be any function of w that determines it in an interval.
        normalised: initial values of state coordinates that R fixes and that are no coordinates of a centre, because
            the state is measured in such units.
        derived_parameters: parameters that nobody gives, by name.
        reversors: further reversing symmetries by name; claims use R unless they say which other one (`under`).
        arrival: the name of a symmetry S if half orbits lead from Fix(R) to Fix(R S), so that P^2(x) = S x.
        fixed_level: of the first integral, if there is a family parameter as well: the maps are those on this level,
            and the level coordinate of an initial point follows from its other coordinates and the family parameter.
        original, reversor: of a system in which one of these stands for R: the one that names it, and its name there.
        squared_distance: the square of the distance from a body, plain arithmetic like the vector field, invariant
            under R; returns one value. `None` if orbits have no such distance.
        distance_name: from what, as people say it.
        stiffness_across: of motion in a plane of a larger system: g, plain arithmetic like the vector field, returns
            one value; variations w out of the plane along an orbit obey w'' = -g w, and R leaves g alone.
    """

    reversing_symmetry: tuple[int, ...]
    section: str
    symmetries: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    family_parameter: str | None = None
    level_coordinate: str | None = None
    normalised: Mapping[str, Fraction] = field(default_factory=dict)
    derived_parameters: Mapping[str, DerivedParameter] = field(default_factory=dict)
    reversors: Mapping[str, Reversor] = field(default_factory=dict)
    arrival: str | None = None
    fixed_level: FixedLevel | None = None
    original: ReversibleSystem | None = None
    reversor: str | None = None
    squared_distance: VectorField | None = None
    distance_name: str | None = None
    stiffness_across: VectorField | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        m = len(self.state)
        for label, signs in [("R", self.reversing_symmetry), *self.symmetries.items()]:
            if len(signs) != m or any(sign not in (1, -1) for sign in signs):
                raise ValueError(f"{self.name}: {label} needs {m} signs, each 1 or -1")
        if self.section not in self.state:
            raise ValueError(
                f"{self.name}: section: {self.section!r} is no state coordinate; there are {', '.join(self.state)}"
            )
        if not self.is_given(self.section_index):
            given = ", ".join(self.given_state)
            raise ValueError(f"{self.name}: section: {self.section!r} is a function of others; there are {given}")
        if self.reversing_symmetry[self.section_index] != -1:
            negated = ", ".join(self.state[i] for i in range(m) if self.reversing_symmetry[i] == -1)
            raise ValueError(f"{self.name}: section: R must negate the section coordinate; it negates {negated}")
        if self.arrival is not None and self.arrival not in self.symmetries:
            raise ValueError(f"{self.name}: arrival: no symmetry {self.arrival!r}")
        if self.arrival_signs[self.section_index] != -1:
            raise ValueError(f"{self.name}: arrival: {self.arrival} must leave the section coordinate alone")
        level = self.fixed_level
        if level is not None:
            if self.family_parameter is None or self.level_coordinate is None:
                raise ValueError(f"{self.name}: fixed_level: needs family_parameter, level_coordinate")
            if (level.sign in (1, -1)) == (level.between is not None):
                raise ValueError(f"{self.name}: fixed_level: needs the sign of {self.level_coordinate}, or an interval")
            if level.between is not None and not level.between[0] < level.between[1]:
                raise ValueError(f"{self.name}: fixed_level.between: is empty; give the smaller end first")
        elif (self.family_parameter is None) == (self.first_integral is None):
            given = "neither" if self.first_integral is None else "more than one"
            raise ValueError(f"{self.name}: give one of family_parameter and first_integral; {given} is there")
        if self.family_parameter is not None and self.family_parameter not in self.parameters:
            known = ", ".join(self.parameters) or "none"
            raise ValueError(f"{self.name}: unknown family parameter {self.family_parameter!r}; parameters: {known}")
        if self.level_coordinate is not None and (
            self.first_integral is None
            or self.level_coordinate not in self.given_state
            or self.reversing_symmetry[self.state.index(self.level_coordinate)] != 1
        ):
            raise ValueError(f"{self.name}: level_coordinate: needs a first integral and a coordinate that R fixes")
        for name in self.normalised:
            if name not in self.given_state or self.reversing_symmetry[self.state.index(name)] != 1:
                raise ValueError(f"{self.name}: the normalised {name!r} is no state coordinate that R fixes")
        for name in self.derived_parameters:
            if name not in self.parameters or name == self.family_parameter:
                raise ValueError(f"{self.name}: the derived {name!r} is no fixed parameter")
        for name in self.reversors:
            try:
                self.under(name)
            except ValueError as error:
                raise ValueError(f"{self.name}: reversors.{name}: {str(error).partition(': ')[2]}") from None
        dimension = len(self.kernel_coordinates)
        if len(self.fixed_coordinates) != dimension + (self.family_parameter is None):
            rule = (
                "first integral it fixes as many as"
                if self.family_parameter is None
                else "family parameter it fixes one less than"
            )
            raise ValueError(
                f"{self.name}: Fix(R) has the wrong dimension: R fixes {len(self.fixed_coordinates)} coordinates and "
                f"negates {dimension + 1}; with a {rule} it negates"
            )

    def under(self, name: str) -> ReversibleSystem:
        """This system with one of its further reversors for R. Raises `ValueError` for a name of none."""
        if name not in self.reversors:
            known = ", ".join(self.reversors) or "none"
            raise ValueError(f"{self.name}: no further reversing symmetry {name!r}; known: {known}")
        return self._settings[name]

    @cached_property
    def _settings(self) -> Mapping[str, ReversibleSystem]:
        from orbitproof.shared.systems.further_reversors import settings_of

        return settings_of(self)

    @cached_property
    def section_index(self) -> int:
        """Index of the section coordinate."""
        return self.state.index(self.section)

    @cached_property
    def fixed_coordinates(self) -> tuple[int, ...]:
        """Indices of the state coordinates that parametrise Fix(R), without those that follow from the others."""
        known = [*self.normalised, *([] if self.fixed_level is None else [self.level_coordinate])]
        names = enumerate(self.given_state)
        return tuple(i for i, name in names if self.reversing_symmetry[i] == 1 and name not in known)

    @cached_property
    def arrival_signs(self) -> tuple[int, ...]:
        """The signs of the reversing symmetry in whose fixed set half orbits end: those of R, or of R S (`arrival`)."""
        turn = self.symmetries[self.arrival] if self.arrival is not None else (1,) * len(self.state)
        return tuple(a * b for a, b in zip(self.reversing_symmetry, turn, strict=True))

    @cached_property
    def kernel_coordinates(self) -> tuple[int, ...]:
        """Indices of the section's coordinates that vanish where half orbits end (the q of the paper), n of them."""
        places = range(len(self.given_state))
        return tuple(i for i in places if self.arrival_signs[i] == -1 and i != self.section_index)

    @cached_property
    def fixed_parameters(self) -> tuple[str, ...]:
        """Parameters that are given: neither the family parameter nor derived ones."""
        return tuple(
            name for name in self.parameters if name != self.family_parameter and name not in self.derived_parameters
        )

    @cached_property
    def centre_coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of a candidate's centre, 1 + n of them.

        The family parameter, if there is one, comes first, then the coordinates of Fix(R).
        """
        lead = () if self.family_parameter is None else (self.family_parameter,)
        return lead + tuple(self.state[i] for i in self.fixed_coordinates)

    @cached_property
    def level_coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of a centre whose first one is the level of the first integral, `LEVEL_NAME`."""
        kept = [self.state[i] for i in self.fixed_coordinates if self.state[i] != self.level_coordinate]
        return (LEVEL_NAME, *kept)

    @cached_property
    def squared_distance_program(self) -> Program | None:
        """The square of the distance as a program; `None` if absent."""
        return self._recorded(self.squared_distance)

    @cached_property
    def stiffness_across_program(self) -> Program | None:
        """g of variations out of the plane as a program; `None` if absent."""
        return self._recorded(self.stiffness_across)
