"""Pieces of atlases as JSON, read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from fractions import Fraction
from typing import Any, NoReturn

from orbitproof.shared.claims import AnyPiece, BirthPiece, LibrationPiece, Piece, SurfacePiece, is_regular
from orbitproof.shared.codec import from_json
from orbitproof.shared.errors import InputError
from orbitproof.shared.numbers import format_rational
from orbitproof.shared.systems import PIECE, PIECE_IN_WORDS, ReversibleSystem, fits
from orbitproof.shared.wording import counted


def piece_from_json(entry: Mapping[str, Any], system: ReversibleSystem, source: str) -> AnyPiece:
    """A piece from a schema-valid JSON object; raises `InputError` that names the field."""
    kinds: dict[str, type[AnyPiece]] = {each.kind: each for each in (SurfacePiece, LibrationPiece, BirthPiece)}
    piece = from_json(kinds.get(entry["kind"], Piece), entry, source)
    check = _Check(piece, source)
    check.form()
    _CHECKS[type(piece)](piece, check, system)
    return piece


def _check_birth_piece(piece: BirthPiece, check: _Check, system: ReversibleSystem) -> None:
    check.regular("directions", 2)
    check.of_tube(piece, 4, "give one for each of x, z, vy, b")


def _check_surface_piece(piece: SurfacePiece, check: _Check, system: ReversibleSystem) -> None:
    size, kernel = len(system.centre_coordinates), len(system.kernel_coordinates)
    check.regular("frame", size)
    if set(piece.parameters) != set(system.fixed_parameters):
        names = ", ".join(system.fixed_parameters) or "none"
        check.refuse("parameters", f"not those of {system.name}", f"give exactly: {names}")
    check.rows("centre", size, _wanted(system))
    check.regular("kernel_frame", kernel)
    check.positive("radii", size, f"{system.name} needs {size}")
    for name, rows in (("tilt", size - 2), ("bend", size - 1)):
        if getattr(piece, name):
            check.rows(name, rows, f"{system.name} needs {rows}")


def _check_piece(piece: Piece, check: _Check, system: ReversibleSystem) -> None:
    check.regular("frame", len(system.centre_coordinates))
    check.of_curve(piece, len(system.centre_coordinates), len(system.kernel_coordinates), _wanted(system), system.name)


def _wanted(system: ReversibleSystem) -> str:
    return f"{system.name} needs {len(system.centre_coordinates)}: {', '.join(system.centre_coordinates)}"


def periodic_piece_from_json(entry: Mapping[str, Any], names: Sequence[str], system: str, source: str) -> Piece:
    """A piece of a curve of periodic orbits in coordinates of these names; raises `InputError` that names the field."""
    if entry["kind"] != "regular":
        raise InputError(f"{source}.kind: {entry['kind']!r} in a curve that uses no symmetry; give regular pieces")
    piece = from_json(Piece, entry, source)
    check, size = _Check(piece, source), len(names)
    check.form()
    if piece.coordinates == "regularised":
        check.refuse("coordinates", "regularised ones are for symmetric orbits", "give physical")
    check.regular("frame", size)
    check.of_curve(piece, size, size - 1, f"{system} needs {size} here: {', '.join(names)}", system)
    return piece


def _check_libration_piece(piece: LibrationPiece, check: _Check, system: ReversibleSystem) -> None:
    for name, pair in (("distance", piece.distance), ("size", piece.size)):
        if len(pair) != 2 or pair[1] <= 0:
            check.refuse(name, "not a middle and a positive half-width", "give two numbers")
    if piece.tube <= 0:
        check.refuse("tube", "not positive", "give a positive half-width")


_CHECKS: Mapping[type[AnyPiece], Callable[[Any, _Check, ReversibleSystem], None]] = {
    Piece: _check_piece,
    SurfacePiece: _check_surface_piece,
    LibrationPiece: _check_libration_piece,
    BirthPiece: _check_birth_piece,
}


class _Check:
    """What a system asks of a piece, with its place in the text of errors."""

    def __init__(self, piece: AnyPiece, source: str) -> None:
        self._piece, self._source = piece, source

    def refuse(self, name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{self._source}.{name}: {why}; {remedy}")

    def form(self) -> None:
        """The id of the piece, and how many numbers its lists have."""
        if not fits(PIECE, self._piece.id):
            self.refuse("id", f"{self._piece.id!r} is no id of a piece", PIECE_IN_WORDS)
        for each in fields(self._piece):
            for name, number in _numbers(getattr(self._piece, each.name), each.name):
                check_length(number, f"{self._source}.{name}")

    def of_curve(self, piece: Piece, size: int, equations: int, wanted: str, system: str) -> None:
        """The shapes of a piece of a curve, and the signs of its widths."""
        if len(piece.centre) != size:
            self.refuse("centre", counted(len(piece.centre), "number"), wanted)
        self.of_tube(piece, equations, f"{system} needs {equations}, one for each equation")

    def of_tube(self, piece: Piece | BirthPiece, equations: int, across: str) -> None:
        """The lengths of what goes across a curve, and the signs of its widths."""
        if piece.half_width <= 0:
            self.refuse("half_width", "not positive", "turn column 0 of the frame around to turn the piece around")
        self.rows("polynomial", equations, across)
        self.positive("tube", equations, across)

    def rows(self, name: str, number: int, wanted: str) -> Sequence[Sequence[Fraction]]:
        rows: Sequence[Sequence[Fraction]] = getattr(self._piece, name)
        if len(rows) != number:
            self.refuse(name, counted(len(rows), "row"), wanted)
        return rows

    def positive(self, name: str, number: int, wanted: str) -> None:
        values: Sequence[Fraction] = getattr(self._piece, name)
        if len(values) != number:
            self.refuse(name, counted(len(values), "number"), wanted)
        for position, value in enumerate(values):
            if value <= 0:
                self.refuse(f"{name}[{position}]", "not positive", "give positive half-widths")

    def regular(self, name: str, size: int) -> None:
        rows = getattr(self._piece, name)
        if len(rows) != size or any(len(row) != size for row in rows):
            self.refuse(name, "wrong shape", f"give {size} rows of {size} numbers")
        if not is_regular(rows):
            self.refuse(name, "is singular", "give linearly independent columns")


def _numbers(value: object, name: str) -> Iterator[tuple[str, Fraction]]:
    """The exact numbers of a field, with their places."""
    if isinstance(value, Fraction):
        yield name, value
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from _numbers(item, f"{name}[{index}]")
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from _numbers(item, f"{name}.{key}")


def check_length(value: Fraction, source: str) -> None:
    """Numbers go into certificates, so the text that `format_rational` gives must fit the schema again."""
    if len(format_rational(value)) > _LONGEST:
        raise InputError(f"{source}: a number is too long to be written exactly; give fewer digits")


_LONGEST = 4000
