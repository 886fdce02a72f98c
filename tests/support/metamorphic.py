"""Claims told otherwise: other names, another order, other units, and things beside that play no part.

A `Change` says how a system is told; `changed_system`, `changed_claim`, `changed_atlas` and `changed_box` tell it and
what is claimed of it so. The coordinates p of boxes and pieces stay the same numbers. What is proved is the same then,
up to names and units (`metamorphic_results`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from random import Random
from typing import Any, TypeVar

from orbitproof.shared.claims import (
    Atlas,
    BirthAtlas,
    Candidate,
    Covers,
    HeteroclinicOrbit,
    HomoclinicCurve,
    HomoclinicOrbit,
    Piece,
)
from orbitproof.shared.formats import (
    COORDINATE,
    HALF_PERIOD,
    LEVEL,
    BoxClaim,
    EquilibriumAtlas,
    HopfPoint,
    InSection,
    PeriodicAtlas,
    PeriodicBifurcation,
)
from orbitproof.shared.systems import (
    AMPLITUDE,
    Defined,
    FixedLevel,
    ParameterRange,
    ReversibleSystem,
    System,
    own_name,
    record,
)
from orbitproof.shared.systems.described_functions import program_function
from orbitproof.verify import enclose

ONE, ZERO = Fraction(1), Fraction(0)
BESIDE_RATE = Fraction(5, 13)
"""Of coordinates that play no part."""
AnySystem = TypeVar("AnySystem", bound=System)
Vector = tuple[Fraction, ...]
Rows = tuple[Vector, ...]


@dataclass(frozen=True)
class Change:
    """How a system is told.

    Attributes:
        title: in one or two words.
        names: new names of coordinates, parameters and symmetries; others keep theirs.
        integral: a new name of the first integral.
        shuffle: the state coordinates and the parameters are in another order; `None`: in the same.
        factors: of coordinates and parameters, by old names, powers of two with a sign: what their values are
            multiplied by.
        time, level: the same of the time and of the first integral, positive.
        unused: parameters that play no part, with values.
        beside: names of two coordinates that play no part: they turn beside a symmetric system, the first is fixed by
            R; without symmetry they decay.
    """

    title: str
    names: Mapping[str, str] = field(default_factory=dict)
    integral: str | None = None
    shuffle: int | None = None
    factors: Mapping[str, Fraction] = field(default_factory=dict)
    time: Fraction = ONE
    level: Fraction = ONE
    unused: Mapping[str, Fraction] = field(default_factory=dict)
    beside: tuple[str, str] | None = None

    def name(self, old: str) -> str:
        """The new name."""
        return self.names.get(old, old)

    def factor(self, old: str) -> Fraction:
        """What values of this are multiplied by."""
        return self.factors.get(old, ONE)


# Systems


def order_of(system: System, change: Change) -> tuple[str, ...]:
    """The old names of the state in its new order, then those that are functions of others; names of `beside` last."""
    given = [*system.given_state, *(change.beside or ())]
    if change.shuffle is not None:
        Random(f"{change.shuffle} {given}").shuffle(given)
        # Whatever chance says, the order is another one.
        given = given[1:] + given[:1] if tuple(given) == system.given_state else given
    return (*given, *system.state[len(system.given_state) :])


def given_order_of(system: System, change: Change) -> tuple[str, ...]:
    """The same without those that are functions of others."""
    whole = order_of(system, change)
    return whole[: len(whole) - len(system.defined)]


def _parameters(system: System, change: Change) -> tuple[str, ...]:
    names = [*change.unused, *system.parameters]
    return tuple(names if change.shuffle is None else reversed(names))


def _told(
    system: System, change: Change, function: Any, factor: Fraction = ONE, of_state: bool = False
) -> Callable[..., Sequence[Any]]:
    """A function of state and parameters, times a factor, as one of the new ones; `of_state`: the vector field.

    As a file has it: recorded.
    """
    state, parameters = order_of(system, change), _parameters(system, change)
    steps = [system.program.instructions[output] for output in system.program.outputs]
    # Written as 0, as somebody would, and not as a multiple of it.
    still = [
        name for name, step in zip(system.state, steps, strict=True) if step.operation == "constant" and not step.value
    ]

    def told(values: Sequence[Any], numbers: Sequence[Any]) -> Sequence[Any]:
        known = {**dict(zip(state, values, strict=True)), **dict(zip(parameters, numbers, strict=True))}
        before = {name: _times(value, 1 / change.factor(name)) for name, value in known.items()}
        found = function([before[name] for name in system.state], [before[name] for name in system.parameters])
        if not of_state:
            return tuple(_times(value, factor) for value in found)
        rates = dict(zip(system.state, found, strict=True)) | dict.fromkeys(still, 0)
        if change.beside is not None:
            first, second = change.beside
            turns = isinstance(system, ReversibleSystem)
            rates[first] = BESIDE_RATE * known[second] if turns else -BESIDE_RATE * known[first]
            rates[second] = -BESIDE_RATE * known[first] if turns else -BESIDE_RATE * known[second]
        return tuple(_times(rates[name], change.factor(name) / change.time) for name in state)

    names = (tuple(map(change.name, each)) for each in (state, parameters))
    return program_function(record(told, *names), len(state))


def _times(value: Any, factor: Fraction) -> Any:
    return value if factor == 1 else -value if factor == -1 else value * factor


def changed_system(system: AnySystem, change: Change) -> AnySystem:
    """The system told otherwise."""
    if isinstance(system, ReversibleSystem) and system.original is not None:
        return changed_system(system.original, change).under(change.name(str(system.reversor)))  # type: ignore[return-value]
    state = order_of(system, change)
    ranges = {**dict.fromkeys(change.unused, ParameterRange(None, None)), **system.parameters}
    integral, name = system.first_integral, system.first_integral_name
    told = System(
        f"{system.name}-otherwise",
        system.title,
        tuple(map(change.name, state)),
        {change.name(key): _scaled_range(ranges[key], change.factor(key)) for key in _parameters(system, change)},
        _told(system, change, system.vector_field, of_state=True),
        first_integral=None if integral is None else _told(system, change, integral, change.level),
        first_integral_name=None if integral is None else change.integral or name,
        defined=tuple(
            Defined(change.name(each.name), each.function, _told(system, change, each.argument))
            for each in system.defined
        ),
    )
    if not isinstance(system, ReversibleSystem):
        return told  # type: ignore[return-value]
    assert not system.derived_parameters
    assert system.arrival is None

    def signs(old: Sequence[int], beside: tuple[int, int]) -> tuple[int, ...]:
        known = dict(zip(system.state, old, strict=True)) | dict(zip(change.beside or (), beside, strict=False))
        return tuple(known[key] for key in state)

    def optional(key: str | None) -> str | None:
        return None if key is None else change.name(key)

    def function_of(function: Any, factor: Fraction = ONE) -> Any:
        return None if function is None else _told(system, change, function, factor)

    return ReversibleSystem(  # type: ignore[return-value]
        **{key: getattr(told, key) for key in System.__dataclass_fields__},
        reversing_symmetry=signs(system.reversing_symmetry, (1, -1)),
        section=change.name(system.section),
        symmetries={change.name(key): signs(each, (1, 1)) for key, each in system.symmetries.items()},
        reversors={
            change.name(key): replace(
                each,
                signs=signs(each.signs, (1, -1)),
                title=change.name(key),
                section=optional(each.section),
                level_coordinate=optional(each.level_coordinate),
            )
            for key, each in system.reversors.items()
        },
        family_parameter=optional(system.family_parameter),
        level_coordinate=optional(system.level_coordinate),
        normalised={change.name(key): value * change.factor(key) for key, value in system.normalised.items()},
        fixed_level=_fixed_level(system, change),
        squared_distance=function_of(system.squared_distance),
        distance_name=system.distance_name,
        stiffness_across=function_of(system.stiffness_across, change.time**-2),
    )


def _scaled_range(interval: ParameterRange, factor: Fraction) -> ParameterRange:
    ends = [None if end is None else end * factor for end in (interval.lower, interval.upper)]
    return ParameterRange(*(ends if factor > 0 else reversed(ends)))


def _fixed_level(system: ReversibleSystem, change: Change) -> FixedLevel | None:
    level = system.fixed_level
    if level is None:
        return None
    factor = change.factor(str(system.level_coordinate))
    sign = None if level.sign is None else level.sign * (1 if factor > 0 else -1)
    between = None if level.between is None else tuple(sorted(end * factor for end in level.between))
    return FixedLevel(level.value * change.level, sign, between)  # type: ignore[arg-type]


# Claims


def _numbers(parameters: Mapping[str, Fraction], change: Change) -> dict[str, Fraction]:
    given = {change.name(key): value * change.factor(key) for key, value in parameters.items()}
    return given | {change.name(key): value for key, value in change.unused.items()}


@dataclass(frozen=True)
class _Affine:
    """Coordinates as functions of p, by old names.

    Attributes:
        size: number of the p; those of `beside` are the last.
        rows: value at p = 0, and the row of the frame.
    """

    size: int
    rows: Mapping[str, tuple[Fraction, Vector]]

    def told(self, names: Sequence[str], change: Change, level: str | None = None) -> tuple[Vector, Rows]:
        """Centre and frame in new units, in this order of old names; `level` is called so."""
        factors = [change.level if name == level else change.factor(name) for name in names]
        found = [self.rows[name] for name in names]
        centre = tuple(value * factor for (value, _), factor in zip(found, factors, strict=True))
        frame = tuple(tuple(x * f for x in row) for (_, row), f in zip(found, factors, strict=True))
        return centre, frame


def _affine(names: Sequence[str], centre: Vector, frame: Rows, beside: Sequence[str]) -> _Affine:
    """Those of a box; each name of `beside` has a p of its own."""
    size, more = len(frame[0]), len(beside)
    rows = {name: (value, (*row, *(ZERO,) * more)) for name, value, row in zip(names, centre, frame, strict=True)}
    for place, name in enumerate(beside):
        rows[name] = ZERO, tuple(Fraction(int(j == size + place)) for j in range(size + more))
    return _Affine(size + more, rows)


def changed_claim(claim: BoxClaim, change: Change) -> BoxClaim:
    """The claim told otherwise."""
    if isinstance(claim, Candidate):
        return _candidate(claim, change)
    if isinstance(claim, HomoclinicOrbit | HomoclinicCurve):
        return _homoclinic(claim, change)
    if isinstance(claim, HeteroclinicOrbit):
        return HeteroclinicOrbit.between(claim.id, *(_homoclinic(end, change) for end in claim.ends))
    return _in_section(claim, change) if isinstance(claim, InSection) else _around_point(claim, change)


def _candidate(claim: Candidate, change: Change) -> Candidate:
    system, told = claim.system, changed_system(claim.system, change)
    along = change.beside[:1] if change.beside is not None else ()
    affine = _affine(claim.coordinates, claim.centre, claim.frame, along)
    before = {change.name(name): name for name in (*system.state, *system.parameters, *(change.beside or ()))}
    # The level's own name is a name of no coordinate.
    first = claim.coordinates[0] if claim.level_sign is not None else None
    shell = told.level_coordinates if claim.level_sign is not None else told.centre_coordinates
    shell = (change.name(claim.varying), *shell) if claim.resonances_meet else shell
    centre, frame = affine.told([first if name == first else before[name] for name in shell], change, first)
    kernel = [system.state[i] for i in system.kernel_coordinates]
    columns = {name: [row[j] for row in claim.kernel_frame] for j, name in enumerate(kernel)}
    radii, size = claim.radii, len(kernel)
    if change.beside is not None:
        radii = (*radii, radii[-1])
        columns = {name: [*column, ZERO] for name, column in columns.items()}
        columns[change.beside[1]] = [*(ZERO,) * size, ONE]
        size += 1
    order = [before[told.state[i]] for i in told.kernel_coordinates]
    rows = tuple(tuple(columns[name][i] / change.factor(name) for name in order) for i in range(size))
    equation, sign = claim.equation, claim.level_sign
    if equation is not None:
        units = {HALF_PERIOD: change.time, LEVEL: change.level, COORDINATE: change.factor(str(equation.coordinate))}
        name = None if equation.coordinate is None else change.name(equation.coordinate)
        equation = replace(equation, value=equation.value * units[equation.quantity], coordinate=name)
    if sign is not None and change.factor(str(system.level_coordinate)) < 0:
        sign = -1 if sign == 1 else 1
    if frame[0][1:] == (ZERO,) * (len(frame) - 1):
        # Theorems about families of maps take the parameter itself for p_0.
        unit = frame[0][0]
        frame = tuple((row[0] / unit, *row[1:]) for row in frame)
        radii = (radii[0] * abs(unit), *radii[1:])
    return replace(
        claim, system=told, parameters=_numbers(claim.parameters, change), centre=centre, frame=frame,
        kernel_frame=rows, radii=radii, equation=equation, level_sign=sign,
        symmetry=None if claim.symmetry is None else change.name(claim.symmetry),
    )  # fmt: skip


def _around_point(claim: Any, change: Change) -> Any:
    """A claim about a box of the state; other numbers that it has, but for those of Hopf points, are as before."""
    system, order = claim.system, given_order_of(claim.system, change)
    beside = change.beside or ()

    def told(values: Sequence[Fraction], at_beside: Fraction, signed: bool = True) -> Vector:
        known = dict(zip(system.given_state, values, strict=True)) | dict.fromkeys(beside, at_beside)
        return tuple(known[name] * (change.factor(name) if signed else abs(change.factor(name))) for name in order)

    known: dict[str, Any] = {
        "system": changed_system(system, change),
        "parameters": _numbers(claim.parameters, change),
        "centre": told(claim.centre, ZERO),
        "radii": told(claim.radii, claim.radii[-1], signed=False),
    }
    if isinstance(claim, HopfPoint):
        known |= {
            "parameter": change.name(claim.parameter),
            "parameter_radius": claim.parameter_radius * abs(change.factor(claim.parameter)),
            "frequency": claim.frequency / change.time,
            "frequency_radius": claim.frequency_radius / change.time,
            "kernel": tuple(told(row, ZERO) for row in claim.kernel),
        }
    return replace(claim, **known)


def _homoclinic(claim: HomoclinicOrbit | HomoclinicCurve, change: Change) -> HomoclinicOrbit | HomoclinicCurve:
    """a and s have the unit of p; q is `slope` times a difference of them."""
    assert claim.level is not None
    one = claim.middle if isinstance(claim, HomoclinicCurve) else claim
    signs = dict(zip(claim.system.state, claim.reversing_symmetry, strict=True))
    unit, is_turned = change.factor(one.along), change.factor(claim.level_coordinate) < 0
    more: dict[str, Any] = {}
    slope = change.factor(one.across) / unit
    if isinstance(claim, HomoclinicCurve):
        units = (unit, unit, slope)
        powers = tuple(tuple(value * by for value in row) for row, by in zip(claim.powers, units, strict=True))
        more = {"level_radius": claim.level_radius * change.level, "powers": powers}
    return replace(
        claim, system=changed_system(claim.system, change), parameters=_numbers(claim.parameters, change),
        reversing_symmetry=tuple(signs[name] for name in order_of(claim.system, change)),
        section=change.name(claim.section), level=claim.level * change.level,
        level_coordinate=change.name(claim.level_coordinate),
        level_sign=-claim.level_sign if is_turned else claim.level_sign,
        slope=claim.slope * slope, centre=tuple(value * unit for value in claim.centre),
        radii=tuple(value * abs(unit) for value in claim.radii), **more,
    )  # fmt: skip


def _in_section(claim: InSection, change: Change) -> InSection:
    system, order = claim.system, given_order_of(claim.system, change)
    affine = _affine(system.given_state, claim.centre, claim.frame, change.beside or ())
    centre, frame = affine.told(order, change)
    more = len(change.beside or ())
    known: dict[str, Any] = {
        "system": changed_system(system, change),
        "parameters": _numbers(claim.parameters, change),
        "normal": _normal(claim.normal, system, change),
        "centre": centre,
        "frame": frame,
        "radii": (*claim.radii, *(claim.radii[-1],) * more),
        "level": None if claim.level is None else claim.level * change.level,
    }
    if isinstance(claim, PeriodicBifurcation):
        unit = change.level if claim.parameter is None else abs(change.factor(claim.parameter))
        known["kernel"] = tuple((*row, *(ZERO,) * more) for row in claim.kernel)
        known["parameter_radius"] = claim.parameter_radius * unit
        known["parameter"] = None if claim.parameter is None else change.name(claim.parameter)
        known["symmetry"] = None if claim.symmetry is None else _matrix(claim.symmetry, system, change)
    return replace(claim, **known)


def _normal(normal: Vector, system: System, change: Change) -> Vector:
    known = dict(zip(system.given_state, normal, strict=True))
    return tuple(known.get(name, ZERO) / change.factor(name) for name in given_order_of(system, change))


def _matrix(matrix: Rows, system: System, change: Change) -> Rows:
    """A linear map of the state; coordinates beside stay."""
    places = {name: i for i, name in enumerate(system.given_state)}

    def entry(row: str, column: str) -> Fraction:
        if row not in places or column not in places:
            return Fraction(int(row == column))
        return matrix[places[row]][places[column]] * change.factor(row) / change.factor(column)

    order = given_order_of(system, change)
    return tuple(tuple(entry(row, column) for column in order) for row in order)


# Curves


def changed_atlas(atlas: Atlas | PeriodicAtlas, change: Change) -> Atlas | PeriodicAtlas:
    """The claim about a curve told otherwise; coordinates that increase or are covered have positive factors."""
    system, claim = atlas.system, atlas.claim
    told = changed_system(system, change)
    covers = claim.covers
    if covers is not None:
        factor = change.factor(covers.coordinate)
        covers = Covers(change.name(covers.coordinate), covers.start * factor, covers.end * factor)
    known: dict[str, Any] = {"increasing": tuple(map(change.name, claim.increasing)), "covers": covers}
    if isinstance(atlas, BirthAtlas):
        claim, change = atlas.claim, in_units_of_amplitude(atlas, change)
        known = {name: change.name(getattr(claim, name)) for name in ("section", "amplitude", "parameter")}
    elif isinstance(atlas, EquilibriumAtlas):
        known["parameter"] = change.name(atlas.claim.parameter)
    elif isinstance(atlas, PeriodicAtlas):
        known["normal"] = _normal(atlas.claim.normal, system, change)
        known["parameter"] = None if atlas.claim.parameter is None else change.name(atlas.claim.parameter)
        known["level"] = None if atlas.claim.level is None else atlas.claim.level * change.level
    elif claim.symmetry is not None:
        known["symmetry"] = change.name(claim.symmetry)
    stated: Any = replace(claim, **known)
    found = replace(atlas, system=told, parameters=_numbers(atlas.parameters, change), claim=stated, pieces=())
    pieces = tuple(_piece(atlas, found, piece, change) for piece in atlas.curve_pieces())
    assert len(pieces) == len(atlas.pieces)
    return replace(found, pieces=pieces)


def in_units_of_amplitude(atlas: BirthAtlas, change: Change) -> Change:
    """The change with what the coordinates of such a curve become: eps is in units of x_j, and y in those of x/x_j."""
    unit = change.factor(atlas.claim.amplitude)
    state = [*atlas.system.state, *(change.beside or ())]
    along = {name: own_name(f"along {name}") for name in state}
    names = {along[name]: own_name(f"along {change.name(name)}") for name in state}
    factors = {along[name]: change.factor(name) / unit for name in state}
    return replace(
        change, names={**change.names, **names}, factors={**change.factors, AMPLITUDE: unit, **factors}
    )  # fmt: skip


def _piece(atlas: Atlas | PeriodicAtlas, told: Any, piece: Piece, change: Change) -> Piece:
    if isinstance(atlas, PeriodicAtlas):
        names, after, beside = atlas.coordinates, told.coordinates, change.beside or ()
        if isinstance(atlas, BirthAtlas):
            beside = (*beside, *(own_name(f"along {name}") for name in beside))
    else:
        names, after = atlas.system.centre_coordinates, told.system.centre_coordinates
        beside = change.beside[:1] if change.beside is not None else ()
    affine = _affine(names, piece.centre, piece.frame, beside)
    if isinstance(atlas, PeriodicAtlas) and not isinstance(atlas, EquilibriumAtlas | BirthAtlas):
        affine = _with_pivot(atlas, affine)
    before = {change.name(name): name for name in affine.rows}
    centre, frame = affine.told([before[name] for name in after], change)
    return replace(
        piece, centre=centre, frame=frame, polynomial=(*piece.polynomial, *((ZERO,),) * len(beside)),
        tube=(*piece.tube, *(piece.tube[-1],) * len(beside)),
    )  # fmt: skip


def _with_pivot(atlas: PeriodicAtlas, affine: _Affine) -> _Affine:
    """With the coordinate that follows from the others on the section."""
    normal = dict(zip(atlas.system.given_state, atlas.claim.normal, strict=True))
    pivot = atlas.system.given_state[atlas.claim.pivot]
    value, row = atlas.claim.offset, [ZERO] * affine.size
    for name, factor in normal.items():
        if name != pivot:
            middle, entries = affine.rows[name]
            value -= factor * middle
            row = [x - factor * entry for x, entry in zip(row, entries, strict=True)]
    known = value / normal[pivot], tuple(x / normal[pivot] for x in row)
    return _Affine(affine.size, {**affine.rows, pivot: known})


# Boxes of `verify.enclose`


def changed_box(box: enclose.Box, change: Change) -> enclose.Box:
    """A box of initial values; those beside are 0."""
    beside = dict.fromkeys(change.beside or (), ZERO)
    centre = {change.name(key): value * change.factor(key) for key, value in box.centre.items()}
    centre |= {change.name(key): value for key, value in {**change.unused, **beside}.items()}
    frame = {change.name(key): tuple(x * change.factor(key) for x in row) for key, row in box.frame.items()}
    return enclose.Box(centre, frame, box.radii)


def changed_section(section: enclose.Section, change: Change) -> enclose.Section:
    """A section of such."""
    normal = {change.name(key): value / change.factor(key) for key, value in section.normal.items()}
    return enclose.Section(normal, section.value)
