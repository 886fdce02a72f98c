"""Boxes of initial values, and sections, by the names of a system's coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.shared.systems import System
from orbitproof.verify.enclose.numbers import Number, exact
from orbitproof.verify.maps import AffineSection, StartingSet


@dataclass(frozen=True)
class Box:
    """The points centre + frame p with abs(p_j) <= radii_j, exactly: initial states, and values of parameters.

    Attributes:
        centre: by name, state coordinates and parameters.
        frame: by name, a row of the frame; names that are absent have the same value at all points.
        radii: positive, one for each variable p_j.

    Raises `ValueError`, one line, for numbers that are not exact, names that are unknown, or rows of another length.
    """

    centre: Mapping[str, Fraction]
    frame: Mapping[str, tuple[Fraction, ...]]
    radii: tuple[Fraction, ...]

    def __post_init__(self) -> None:
        for name, value in self.centre.items():
            _exactly(f"centre.{name}", value)
        for position, radius in enumerate(self.radii):
            _exactly(f"radii.{position}", radius)
        if not all(radius > 0 for radius in self.radii):
            raise ValueError("radii: they are positive; leave the variable out of the frame if it does not vary")
        for name, row in self.frame.items():
            if name not in self.centre:
                raise ValueError(f"frame.{name}: unknown; the centre has {', '.join(self.centre)}")
            if len(row) != len(self.radii):
                raise ValueError(f"frame.{name}: {len(row)} numbers for {len(self.radii)} radii; give one for each")
            for value in row:
                _exactly(f"frame.{name}", value)

    def row(self, name: str) -> tuple[Fraction, ...]:
        """The row of the frame for a name."""
        return self.frame.get(name, (Fraction(0),) * len(self.radii))

    def of(self, system: System) -> StartingSet:
        """The box in the order of a system's coordinates.

        Raises `ValueError` unless the names are the same, and for a system whose field is not shown to keep the
        coordinates that are functions of others what they are (section 23.5).
        """
        _require_functions(system)
        names = (*system.given_state, *system.parameters)
        for name in names:
            if name not in self.centre:
                raise ValueError(f"centre: {name} is missing; give a value to each of {', '.join(names)}")
        for name in self.centre:
            if name not in names:
                raise ValueError(f"centre: {system.name} has no {name}; it has {', '.join(names)}")
        for name, interval in system.parameters.items():
            reach = sum(
                (abs(entry) * radius for entry, radius in zip(self.row(name), self.radii, strict=True)), Fraction(0)
            )
            if not all(interval.contains(self.centre[name] + sign * reach) for sign in (-1, 1)):
                raise ValueError(f"{name}: values of the box are outside {interval}; give values inside")
        centre, frame = tuple(self.centre[name] for name in names), tuple(self.row(name) for name in names)
        functions = [each.function for each in system.defined]
        defined = tuple(zip(functions, system.argument_programs, strict=True))
        return StartingSet(len(system.given_state), centre, frame, self.radii, defined)


def box(
    centre: Mapping[str, Number],
    frame: Mapping[str, Sequence[Number]] | None = None,
    radii: Sequence[Number] | Mapping[str, Number] = (),
) -> Box:
    """A set of initial values {centre + frame p : abs(p_j) <= radii_j}, exact; a point if there are no radii.

    What is enclosed holds at every real point of the box, and all derivatives are by its variables p_j. To be
    enclosed the orbits must exist on a box four times as large (section 6).

    Arguments:
        centre: a number for each state coordinate and each parameter, by name; none for coordinates that are
            functions of others, sin, cos, exp and log of the field's formulas. Numbers are exact: int, `Fraction`, or
            text such as "0.1" or "1/3".
        frame: by name, the row of coefficients of p_1, p_2, ..; names that are absent do not vary. Without a frame
            radii are by name, and each name is a variable of its own, in the order given.
        radii: positive, one for each variable.

    Raises `ValueError`, one line, for what is missing, unknown or no exact number.

    >>> from orbitproof.verify import enclose
    >>> enclose.box({"x": 1, "y": "1/3", "mu": "0.1"}, radii={"y": "1e-3", "mu": "1e-3"}).frame["mu"]
    (Fraction(0, 1), Fraction(1, 1))
    """
    middle = {name: exact(f"centre.{name}", value) for name, value in centre.items()}
    if frame is None:
        if not isinstance(radii, Mapping):
            if len(radii):
                raise ValueError("radii: without a frame they are by name; give {name: radius}")
            radii = {}
        names = list(radii)
        frame = {name: [int(name == other) for other in names] for name in names}
        radii = list(radii.values())
    elif isinstance(radii, Mapping):
        raise ValueError("radii: with a frame they are a list, one for each of its columns")
    sizes = tuple(exact(f"radii.{index}", value) for index, value in enumerate(radii))
    rows = {name: tuple(exact(f"frame.{name}", value) for value in row) for name, row in frame.items()}
    return Box(middle, rows, sizes)


@dataclass(frozen=True)
class Section:
    """The points with normal . x = value, exactly.

    Attributes:
        normal: by name of a state coordinate; those that are absent have the coefficient 0.
        value: the value of normal . x on the section.

    Raises `ValueError`, one line, for numbers that are not exact, or a normal that is zero.
    """

    normal: Mapping[str, Fraction]
    value: Fraction

    def __post_init__(self) -> None:
        for name, entry in (*self.normal.items(), ("value", self.value)):
            _exactly(f"section.{name}", entry)
        if not any(self.normal.values()):
            raise ValueError("section: its normal is zero; give a coefficient that is not")

    def of(self, system: System) -> AffineSection:
        """The section in the order of a system's coordinates. Raises `ValueError` for other names."""
        for name in self.normal:
            if name not in system.given_state:
                known = ", ".join(system.given_state)
                raise ValueError(f"section: {name!r} is no state coordinate that is given; there are {known}")
        return AffineSection(tuple(self.normal.get(name, Fraction(0)) for name in system.state), self.value)


def section(normal: str | Mapping[str, Number], value: Number = 0) -> Section:
    """The affine section normal . x = value, exactly.

    Arguments:
        normal: coefficients by name of a state coordinate, not all 0; or one name, for {name = value}.
        value: exact, as in `box`.

    Raises `ValueError`.

    >>> from orbitproof.verify import enclose
    >>> enclose.section("z", 27) == enclose.section({"z": 1}, "27")
    True
    """
    entries: Mapping[str, Number] = {normal: 1} if isinstance(normal, str) else normal
    return Section(
        {name: exact(f"section.{name}", entry) for name, entry in entries.items()}, exact("section.value", value)
    )


def _exactly(key: str, value: object) -> None:
    if not isinstance(value, Fraction):
        raise ValueError(f"{key}: {value!r} is no Fraction; `box` and `section` take other exact numbers")


def _require_functions(system: System) -> None:
    """See `Box.of`."""
    if not system.defined:
        return
    from orbitproof.verify.claim.functions import keeps_its_functions

    if not keeps_its_functions(system):
        further = ", ".join(each.name for each in system.defined)
        raise ValueError(
            f"{system.name}: {further} are not shown to stay the functions of others that they begin as; "
            "write these functions in the formulas of the field"
        )
