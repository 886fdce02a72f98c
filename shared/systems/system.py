"""Systems: vector field and parameters; of reversible ones symmetries, section, first integral.

A system is one `System` value, a reversible one a `ReversibleSystem`. Neither the integrator nor the theorems know
any system by name: a further one is a file of its own (`description`).

All symmetries are diagonal sign matrices in the state coordinates, the section is the vanishing of
one state coordinate, and Fix(R) lies in the section. Coordinates on the section are split into
those that R fixes (they parametrise Fix(R)) and those that it negates (they vanish on Fix(R)).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import nan, sqrt
from typing import Any

from orbitproof.shared.systems.hill import hill_field, hill_integral
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
    """The level of a first integral on which orbits are looked for, and the sign of the level coordinate."""

    value: Fraction
    sign: int


@dataclass(frozen=True)
class Reversor:
    """A further reversing symmetry of a system: its signs, and what people call it."""

    signs: tuple[int, ...]
    title: str


@dataclass(frozen=True, repr=False)
class System:
    """x' = vector_field(x, parameters), of which no symmetry is known.

    Attributes:
        name: the key in `SYSTEMS` and in the JSON formats.
        title: the name that people read.
        state: names of the state coordinates, m of them.
        parameters: admissible open interval of each parameter, by name, in the vector field's order.
        vector_field: plain arithmetic, called with (state, parameters), returns m values.
        first_integral: plain arithmetic like the vector field, returns one value; `None` if absent.
        first_integral_name: what people call it.
    """

    name: str
    title: str
    state: tuple[str, ...]
    parameters: Mapping[str, ParameterRange]
    vector_field: VectorField
    first_integral: VectorField | None = field(default=None, kw_only=True)
    first_integral_name: str | None = field(default=None, kw_only=True)

    def __repr__(self) -> str:
        parameters = f", parameters {' '.join(self.parameters)}" if self.parameters else ""
        return f"<{type(self).__name__} {self.name}: state {' '.join(self.state)}{parameters}>"

    @cached_property
    def program(self) -> Program:
        """The vector field as a straight-line program; inputs: state, then parameters."""
        return record(self.vector_field, self.state, tuple(self.parameters))

    @cached_property
    def first_integral_program(self) -> Program | None:
        """The first integral as a straight-line program; inputs: state, then parameters."""
        if self.first_integral is None:
            return None
        return record(self.first_integral, self.state, tuple(self.parameters))


@dataclass(frozen=True, repr=False)
class ReversibleSystem(System):
    """A system that is reversible under the involution R = diag(reversing_symmetry).

    Attributes, beside those of `System`:
        reversing_symmetry: m signs; f(R x) = -R f(x).
        symmetries: further symmetries, by name, m signs each; f(S x) = S f(x), S commutes with R.
        section: the state coordinate whose vanishing defines the Poincare section; R negates it.
        family_parameter: the parameter of the vector field in which the maps form a family (C1-C4),
            or `None` when the level of `first_integral` is the bifurcation parameter (HC2-HC4).
        level_coordinate: a state coordinate w, fixed by R, in which the first integral is quadratic:
            H = A + b w^2, with A independent of w and a constant b. On Fix(R) it then follows from the level
            of H and the other coordinates up to its sign. `None` if there is no such coordinate.
        normalised: initial values of state coordinates that R fixes and that are no coordinates of a centre, because
            the state is measured in such units.
        derived_parameters: parameters that nobody gives, by name.
        reversors: further reversing symmetries by name; claims use R unless they say which other one (`under`).
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
    fixed_level: FixedLevel | None = None
    original: ReversibleSystem | None = None
    reversor: str | None = None
    squared_distance: VectorField | None = None
    distance_name: str | None = None
    stiffness_across: VectorField | None = None

    def __post_init__(self) -> None:
        m = len(self.state)
        for label, signs in [("R", self.reversing_symmetry), *self.symmetries.items()]:
            if len(signs) != m or any(sign not in (1, -1) for sign in signs):
                raise ValueError(f"{self.name}: {label} needs {m} signs, each 1 or -1")
        if self.section not in self.state:
            raise ValueError(
                f"{self.name}: section: {self.section!r} is no state coordinate; there are {', '.join(self.state)}"
            )
        if self.reversing_symmetry[self.section_index] != -1:
            negated = ", ".join(self.state[i] for i in range(m) if self.reversing_symmetry[i] == -1)
            raise ValueError(f"{self.name}: section: R must negate the section coordinate; it negates {negated}")
        if self.fixed_level is not None:
            if self.family_parameter is None or self.level_coordinate is None or self.fixed_level.sign not in (1, -1):
                raise ValueError(f"{self.name}: fixed_level: needs family_parameter, level_coordinate and its sign")
        elif (self.family_parameter is None) == (self.first_integral is None):
            given = "neither" if self.first_integral is None else "more than one"
            raise ValueError(f"{self.name}: give one of family_parameter and first_integral; {given} is there")
        if self.family_parameter is not None and self.family_parameter not in self.parameters:
            known = ", ".join(self.parameters) or "none"
            raise ValueError(f"{self.name}: unknown family parameter {self.family_parameter!r}; parameters: {known}")
        if self.level_coordinate is not None and (
            self.first_integral is None
            or self.level_coordinate not in self.state
            or self.reversing_symmetry[self.state.index(self.level_coordinate)] != 1
        ):
            raise ValueError(f"{self.name}: level_coordinate: needs a first integral and a coordinate that R fixes")
        for name in self.normalised:
            if name not in self.state or self.reversing_symmetry[self.state.index(name)] != 1:
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
        """The same system with one of its further reversors for R. Raises `ValueError` for a name of none."""
        if name not in self.reversors:
            known = ", ".join(self.reversors) or "none"
            raise ValueError(f"{self.name}: no further reversing symmetry {name!r}; known: {known}")
        return self._settings[name]

    @cached_property
    def _settings(self) -> Mapping[str, ReversibleSystem]:
        return {
            name: replace(
                self,
                name=f"{self.name}-{name}",
                title=f"{self.title}, reversible under {reversor.title}",
                reversing_symmetry=reversor.signs,
                reversors={},
                original=self,
                reversor=name,
            )
            for name, reversor in self.reversors.items()
        }

    @cached_property
    def section_index(self) -> int:
        """Index of the section coordinate."""
        return self.state.index(self.section)

    @cached_property
    def fixed_coordinates(self) -> tuple[int, ...]:
        """Indices of the state coordinates that parametrise Fix(R), without those that follow from the others."""
        given = [*self.normalised, *([] if self.fixed_level is None else [self.level_coordinate])]
        return tuple(i for i, sign in enumerate(self.reversing_symmetry) if sign == 1 and self.state[i] not in given)

    @cached_property
    def kernel_coordinates(self) -> tuple[int, ...]:
        """Indices of the section's coordinates that vanish on Fix(R) (the q of the paper), n of them."""
        return tuple(i for i, sign in enumerate(self.reversing_symmetry) if sign == -1 and i != self.section_index)

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
        """Names of the coordinates of a centre whose first one is the level of the first integral."""
        kept = [self.state[i] for i in self.fixed_coordinates if self.state[i] != self.level_coordinate]
        return (self.first_integral_name or "first integral", *kept)

    def on_level(self, state: Sequence[float], parameters: Sequence[float]) -> list[float]:
        """The state with the level coordinate w that belongs to the fixed level, if there is one, from H = A + b w^2.

        In floating point, not for proofs; NaN where no point of the level lies over the other coordinates.
        """
        if self.fixed_level is None:
            return list(state)
        assert self.first_integral is not None
        place = self.state.index(str(self.level_coordinate))
        before, after = state[:place], state[place + 1 :]
        rest, one = (float(self.first_integral([*before, w, *after], parameters)[0]) for w in (0.0, 1.0))
        square = (float(self.fixed_level.value) - rest) / (one - rest)
        return [*before, self.fixed_level.sign * sqrt(square) if square >= 0 else nan, *after]

    @cached_property
    def squared_distance_program(self) -> Program | None:
        """The square of the distance as a straight-line program; inputs: state, then parameters."""
        if self.squared_distance is None:
            return None
        return record(self.squared_distance, self.state, tuple(self.parameters))

    @cached_property
    def stiffness_across_program(self) -> Program | None:
        """g of variations out of the plane as a straight-line program; inputs: state, then parameters."""
        if self.stiffness_across is None:
            return None
        return record(self.stiffness_across, self.state, tuple(self.parameters))


def _circular_restricted_three_body(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z, vx, vy, vz = state
    (mu,) = parameters
    larger = x + mu
    smaller = larger - 1
    off_axis = y * y + z * z
    pull_larger = (1 - mu) * (larger * larger + off_axis) ** -1.5
    pull_smaller = mu * (smaller * smaller + off_axis) ** -1.5
    pull = pull_larger + pull_smaller
    return (
        vx,
        vy,
        vz,
        x + 2 * vy - pull_larger * larger - pull_smaller * smaller,
        y - 2 * vx - pull * y,
        -(pull * z),
    )


def _jacobi_constant(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z, vx, vy, vz = state
    (mu,) = parameters
    larger = x + mu
    smaller = larger - 1
    off_axis = y * y + z * z
    potential = (1 - mu) * (larger * larger + off_axis) ** -0.5 + mu * (smaller * smaller + off_axis) ** -0.5
    return (x * x + y * y + 2 * potential - (vx * vx + vy * vy + vz * vz),)


def _from_smaller_primary(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z, *_ = state
    (mu,) = parameters
    along = x + mu - 1
    return (along * along + y * y + z * z,)


def _falkner_skan(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z = state
    (beta,) = parameters
    return (y, z, beta * (y * y - 1) - x * z)


CR3BP = ReversibleSystem(
    name="cr3bp",
    title="circular restricted three-body problem",
    state=("x", "y", "z", "vx", "vy", "vz"),
    parameters={"mu": ParameterRange(Fraction(0), Fraction(1))},
    vector_field=_circular_restricted_three_body,
    reversing_symmetry=(1, -1, 1, -1, 1, -1),
    symmetries={"S": (1, 1, -1, 1, 1, -1)},
    section="y",
    first_integral=_jacobi_constant,
    first_integral_name="Jacobi constant",
    level_coordinate="vy",
    squared_distance=_from_smaller_primary,
    distance_name="the smaller primary",
    reversors={"axial": Reversor((1, -1, -1, -1, 1, 1), "the half turn about the x axis")},
)

CR3BP_AXIAL = CR3BP.under("axial")

THREE_BODY = (CR3BP, CR3BP_AXIAL)
"""The same equations with their two reversing symmetries: R, and R S, the half turn about the x axis."""

HILL = ReversibleSystem(
    name="cr3bp-hill",
    title="circular restricted three-body problem in Hill's units",
    state=("xi", "eta", "zeta", "vxi", "veta", "vzeta"),
    # Below h = 0 there is no mechanics, but the field is as regular there.
    parameters={"h": ParameterRange(Fraction(-1), Fraction(1))},
    vector_field=hill_field,
    reversing_symmetry=(1, -1, 1, -1, 1, -1),
    symmetries={"S": (1, 1, -1, 1, 1, -1)},
    section="eta",
    first_integral=hill_integral,
    first_integral_name="(C - (1 - mu)(3 - mu))/mu^(2/3)",
)

FALKNER_SKAN = ReversibleSystem(
    name="falkner-skan",
    title="Falkner-Skan equation",
    state=("x", "y", "z"),
    parameters={"beta": ParameterRange(None, None)},
    vector_field=_falkner_skan,
    reversing_symmetry=(-1, 1, -1),
    section="z",
    family_parameter="beta",
)

SYSTEMS: Mapping[str, ReversibleSystem] = {system.name: system for system in (CR3BP, CR3BP_AXIAL, HILL, FALKNER_SKAN)}

MASS_PARAMETERS: Mapping[str, Fraction] = {
    "earth-moon": Fraction(float.fromhex("0x1.8e267d713713fp-7")),
    "sun-jupiter": Fraction(float.fromhex("0x1.f41bc26a74648p-11")),
    "jpl-earth-moon": Fraction("1.215058560962404e-2"),
    "jupiter-europa": Fraction("2.528017528540000e-5"),
    "mars-phobos": Fraction("1.611081404409632e-8"),
    "saturn-enceladus": Fraction("1.901109735892602e-7"),
    "saturn-titan": Fraction("2.366393158331484e-4"),
    "sun-earth": Fraction("3.054200000000000e-6"),
    "sun-mars": Fraction("3.227154996101724e-7"),
}
"""Mass parameters by name, exactly: the first two are those of the paper, equation (EM_SJ_mass), two IEEE doubles; the
others those of the systems of the JPL three-body periodic orbit catalogue, as decimals."""
