"""Pieces of atlases as JSON, read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NoReturn

from orbitproof.shared.claims import AnyPiece, LibrationPiece, Piece, SurfacePiece, is_regular
from orbitproof.shared.claims.pieces import Matrix, Vector
from orbitproof.shared.errors import InputError
from orbitproof.shared.numbers import format_rational, parse_exact
from orbitproof.shared.systems import PIECE, PIECE_IN_WORDS, ReversibleSystem, fits


def piece_from_json(entry: Mapping[str, Any], system: ReversibleSystem, source: str) -> AnyPiece:
    """A piece from a schema-valid JSON object; raises `InputError` that names the field."""
    numbers = _Numbers(entry, source)
    if not fits(PIECE, entry["id"]):
        numbers.refuse("id", f"{entry['id']!r} is no id of a piece", PIECE_IN_WORDS)
    if entry["kind"] == LibrationPiece.kind:
        return _libration_piece(entry, numbers)
    size, kernel = len(system.centre_coordinates), len(system.kernel_coordinates)
    wanted = f"{system.name} needs {size}: {', '.join(system.centre_coordinates)}"
    frame = numbers.regular("frame", size)
    if entry["kind"] == SurfacePiece.kind:
        if set(entry["parameters"]) != set(system.fixed_parameters):
            names = ", ".join(system.fixed_parameters) or "none"
            numbers.refuse("parameters", f"not those of {system.name}", f"give exactly: {names}")
        return SurfacePiece(
            id=entry["id"],
            parameters={
                name: numbers.vector(f"parameters.{name}", texts) for name, texts in entry["parameters"].items()
            },
            centre=numbers.rows("centre", size, wanted),
            frame=frame,
            kernel_frame=numbers.regular("kernel_frame", kernel),
            radii=numbers.positive("radii", size, f"{system.name} needs {size}"),
            tilt=numbers.rows("tilt", size - 2, f"{system.name} needs {size - 2}") if "tilt" in entry else (),
            bend=numbers.rows("bend", size - 1, f"{system.name} needs {size - 1}") if "bend" in entry else (),
        )
    centre = numbers.vector("centre", entry["centre"])
    if len(centre) != size:
        numbers.refuse("centre", f"{len(centre)} numbers", wanted)
    across = f"{system.name} needs {kernel}, one for each equation"
    half_width = numbers.vector("half_width", [entry["half_width"]])[0]
    if half_width <= 0:
        numbers.refuse("half_width", "not positive", "turn column 0 of the frame around to turn the piece around")
    return Piece(
        id=entry["id"],
        kind=entry["kind"],
        centre=centre,
        frame=frame,
        half_width=half_width,
        polynomial=numbers.rows("polynomial", kernel, across),
        tube=numbers.positive("tube", kernel, across),
        coordinates=entry.get("coordinates", "auto"),
    )


def _libration_piece(entry: Mapping[str, Any], numbers: _Numbers) -> LibrationPiece:
    pairs = {}
    for name in ("distance", "size"):
        pairs[name] = numbers.vector(name, entry[name])
        if len(pairs[name]) != 2 or pairs[name][1] <= 0:
            numbers.refuse(name, "not a middle and a positive half-width", "give two numbers")
    (tube,) = numbers.vector("tube", [entry["tube"]])
    if tube <= 0:
        numbers.refuse("tube", "not positive", "give a positive half-width")
    rows = tuple(numbers.vector(f"polynomial[{index}]", texts) for index, texts in enumerate(entry["polynomial"]))
    return LibrationPiece(entry["id"], entry["point"], pairs["distance"], pairs["size"], rows, tube)


@dataclass(frozen=True)
class _Numbers:
    """Exact numbers of a JSON object, with their place in the text of errors."""

    entry: Mapping[str, Any]
    source: str

    def refuse(self, name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{self.source}.{name}: {why}; {remedy}")

    def vector(self, name: str, texts: Iterable[str]) -> Vector:
        values = tuple(parse_exact(text) for text in texts)
        for value in values:
            check_length(value, f"{self.source}.{name}")
        return values

    def rows(self, name: str, number: int, wanted: str) -> Matrix:
        rows = tuple(self.vector(f"{name}[{index}]", texts) for index, texts in enumerate(self.entry[name]))
        if len(rows) != number:
            self.refuse(name, f"{len(rows)} rows", wanted)
        return rows

    def positive(self, name: str, number: int, wanted: str) -> Vector:
        values = self.vector(name, self.entry[name])
        if len(values) != number:
            self.refuse(name, f"{len(values)} numbers", wanted)
        for position, value in enumerate(values):
            if value <= 0:
                self.refuse(f"{name}[{position}]", "not positive", "give positive half-widths")
        return values

    def regular(self, name: str, size: int) -> Matrix:
        rows = tuple(self.vector(f"{name}[{index}]", texts) for index, texts in enumerate(self.entry[name]))
        if len(rows) != size or any(len(row) != size for row in rows):
            self.refuse(name, "wrong shape", f"give {size} rows of {size} numbers")
        if not is_regular(rows):
            self.refuse(name, "is singular", "give linearly independent columns")
        return rows


def check_length(value: Fraction, source: str) -> None:
    """Numbers go into certificates, so the text that `format_rational` gives must fit the schema again."""
    if len(format_rational(value)) > _LONGEST:
        raise InputError(f"{source}: a number is too long to be written exactly; give fewer digits")


_LONGEST = 4000
