"""Atlas files: what is written is read again exactly, and every kind of bad input is one line."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from orbitproof.shared import InputError
from orbitproof.shared.claims import (
    BirthCurveClaim,
    EquilibriumCurveClaim,
    PeriodicCurveClaim,
    Piece,
    is_regular,
)
from orbitproof.shared.formats import atlas_from_json, atlas_to_json, piece_from_json, read_atlas, write_atlas
from orbitproof.shared.systems import CR3BP

REGULAR: dict[str, Any] = {
    "id": "p001",
    "kind": "regular",
    "centre": ["0.84", "0.125", "0.25"],
    "frame": [["0.6", "0", "0.8"], ["0.8", "0", "-0.6"], ["0", "1", "0"]],
    "half_width": "0x1p-6",
    "polynomial": [["0", "1e-3", "-2.5e-4"], ["1e-9"]],
    "tube": ["1e-9", "2e-9"],
    "coordinates": "regularised",
}
SYMMETRIC: dict[str, Any] = {
    **REGULAR,
    "id": "p000",
    "kind": "symmetric",
    "centre": ["0.82", "0", "0.13"],
    "frame": [["0", "1", "0"], ["1", "0", "0"], ["0", "0", "1"]],
    "polynomial": [["0", "0", "-2.5e-4"], ["0"]],
}
CURVE: dict[str, Any] = {
    "format": "orbitproof-atlas",
    "version": 1,
    "id": "arc",
    "title": "an arc",
    "system": "cr3bp",
    "parameters": {"mu": "0x18e267d713713fp-59"},
    "claim": {
        "kind": "symmetric-arc",
        "symmetry": "S",
        "increasing": ["vy"],
        "covers": {"coordinate": "vy", "from": "0.25", "to": "20.5"},
    },
    "pieces": [SYMMETRIC, REGULAR],
    "provenance": {"from": "nowhere"},
}
PATCH: dict[str, Any] = {
    "id": "m001",
    "kind": "symmetry_breaking",
    "parameters": {"mu": ["0.125", "0.25"]},
    "centre": [["0.8", "0.1"], ["0"], ["0.1"]],
    "frame": [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]],
    "kernel_frame": [["1", "0"], ["0", "1"]],
    "radii": ["1e-9", "1e-7", "1e-9"],
}
SURFACE: dict[str, Any] = {
    "format": "orbitproof-atlas",
    "version": 1,
    "id": "L1",
    "title": "symmetry breaking of L1",
    "system": "cr3bp",
    "claim": {
        "kind": "symmetry-breaking-surface",
        "symmetry": "S",
        "covers": {"coordinate": "mu", "from": "0.125", "to": "0.25"},
    },
    "pieces": [PATCH],
}


def write(path: Path, document: Any) -> Path:
    path.write_text(json.dumps(document))
    return path


@pytest.mark.parametrize("document", [CURVE, SURFACE], ids=["curve", "surface"])
def test_an_atlas_is_read_written_and_read_again_exactly(document: dict[str, Any], tmp_path: Path) -> None:
    atlas = read_atlas(write(tmp_path / "in.json", document))
    write_atlas(tmp_path / "out.json", atlas)
    assert read_atlas(tmp_path / "out.json") == atlas
    assert len(atlas.curve_pieces()) + len(atlas.surface_pieces()) == len(document["pieces"])
    assert atlas.is_surface == (document is SURFACE)


def test_numbers_are_exact() -> None:
    atlas = atlas_from_json(CURVE, "test")
    piece = atlas.curve_pieces()[1]
    assert piece.half_width == Fraction(1, 64)
    assert piece.polynomial[0] == (0, Fraction(1, 1000), Fraction(-1, 4000))
    assert atlas.parameters["mu"] == Fraction(float.fromhex("0x1.8e267d713713fp-7"))
    assert atlas.claim.covers is not None
    assert atlas.claim.covers.end == Fraction(41, 2)
    assert atlas.provenance == {"from": "nowhere"}
    assert "provenance" not in atlas_to_json(atlas, provenance=False)


def test_the_point_of_a_piece_is_centre_plus_frame_times_local_coordinates() -> None:
    piece = piece_from_json(REGULAR, CR3BP, "test")
    assert isinstance(piece, Piece)
    s = Fraction(1, 2)
    p = piece.local(s)
    assert p == (Fraction(1, 128), Fraction(1, 2000) - Fraction(1, 16000), Fraction(1, 10**9))
    assert piece.point(s) == (
        Fraction(84, 100) + Fraction(3, 5) * p[0] + Fraction(4, 5) * p[2],
        Fraction(1, 8) + Fraction(4, 5) * p[0] - Fraction(3, 5) * p[2],
        Fraction(1, 4) + p[1],
    )


def test_files_have_one_piece_on_a_line(tmp_path: Path) -> None:
    write_atlas(tmp_path / "out.json", atlas_from_json(CURVE, "test"))
    lines = (tmp_path / "out.json").read_text().splitlines()
    assert sum('"half_width"' in line for line in lines) == len(CURVE["pieces"])
    assert len(lines) < 40


@pytest.mark.parametrize(
    ("rows", "regular"),
    [
        (((1, 2), (2, 4)), False),
        (((0, 1), (1, 0)), True),
        (((0, 0), (0, 1)), False),
        (((0, 1, 2), (1, 0, 3), (4, -3, 8)), True),
        (((1, 2, 3), (4, 5, 6), (7, 8, 9)), False),
    ],
)
def test_singular_matrices_are_told_from_regular_ones_exactly(rows: tuple[tuple[int, ...], ...], regular: bool) -> None:
    assert is_regular(tuple(tuple(Fraction(value) for value in row) for row in rows)) is regular


def changed(document: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    """A copy with the entry at a dotted path set, or deleted if the value is `...`."""
    result: Any = json.loads(json.dumps(document))
    *parents, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    inner = result
    for key in parents:
        inner = inner[key]
    if value is ...:
        del inner[last]
    else:
        inner[last] = value
    return result  # type: ignore[no-any-return]


ONE = ["1"]
BAD: list[tuple[dict[str, Any], str, Any, str, str]] = [
    # document, path, new value, field named in the error, words of the error
    (CURVE, "extra", 1, "the document", "unknown key 'extra'"),
    (CURVE, "pieces.1.extra", 1, "pieces[1]", "unknown key 'extra'"),
    (CURVE, "claim.extra", 1, "claim", "unknown key 'extra'"),
    (CURVE, "version", 2, "version", "must be 1"),
    (CURVE, "pieces", [], "pieces", "at least 1"),
    (CURVE, "pieces.0.kind", "bent", "pieces[0].kind", "must be"),
    (CURVE, "pieces.1.centre", ["1", "2"], "pieces[1].centre", "cr3bp needs 3: x, z, vy"),
    (CURVE, "pieces.1.centre.0", 0.5, "pieces[1].centre[0]", "type string"),
    (CURVE, "pieces.1.centre.0", "nan", "pieces[1].centre[0]", "must have the form"),
    (CURVE, "pieces.1.centre.0", "inf", "pieces[1].centre[0]", "must have the form"),
    (CURVE, "pieces.1.centre.0", "1e9000", "pieces[1].centre[0]", "too long"),
    (CURVE, "pieces.1.frame.0", ["1", "2"], "pieces[1].frame", "3 rows of 3 numbers"),
    (CURVE, "pieces.1.frame.0", ["0.8", "0", "-0.6"], "pieces[1].frame", "singular"),
    (CURVE, "pieces.1.half_width", "0", "pieces[1].half_width", "not positive"),
    (CURVE, "pieces.1.half_width", "-1", "pieces[1].half_width", "not positive"),
    (CURVE, "pieces.1.polynomial", [ONE], "pieces[1].polynomial", "needs 2, one for each equation"),
    (CURVE, "pieces.1.polynomial.0", [], "pieces[1].polynomial[0]", "at least 1"),
    (CURVE, "pieces.1.tube", ["1e-9"], "pieces[1].tube", "needs 2"),
    (CURVE, "pieces.1.tube.1", "0", "pieces[1].tube[1]", "not positive"),
    (CURVE, "pieces.1.coordinates", "polar", "pieces[1].coordinates", "must be"),
    (CURVE, "pieces.1.id", "p000", "pieces[1].id", "appears twice"),
    (CURVE, "pieces.1.id", "a\nb", "pieces[1].id", "is no id"),
    (CURVE, "pieces.1", PATCH, "pieces[1].kind", "belongs to surfaces"),
    (CURVE, "system", "pendulum", "atlas.system", "unknown system 'pendulum'"),
    (CURVE, "parameters", ..., "parameters", "missing"),
    (CURVE, "parameters", {}, "atlas.parameters", "takes the parameters: mu"),
    (CURVE, "parameters.mu", "2", "atlas.parameters.mu", "lies outside"),
    (CURVE, "claim.symmetry", "T", "claim.symmetry", "no symmetry 'T'"),
    (CURVE, "claim.symmetry", None, "claim.symmetry", "without a symmetry"),
    (CURVE, "claim", {"kind": "arc"}, "pieces[0].kind", "without a symmetry"),
    (CURVE, "claim.kind", "spiral", "claim.kind", "must be"),
    (CURVE, "claim.increasing", ["vx"], "claim.increasing[0]", "x, z, vy"),
    (CURVE, "claim.increasing", ["z", "z"], "claim.increasing[1]", "once"),
    (CURVE, "claim.covers.coordinate", "mu", "claim.covers.coordinate", "x, z, vy"),
    (CURVE, "claim.covers.to", "0.25", "claim.covers.to", "not greater"),
    (SURFACE, "parameters", {"mu": "0.1"}, "parameters", "leave it out"),
    (SURFACE, "pieces.0.parameters", {}, "pieces[0].parameters", "give exactly: mu"),
    (SURFACE, "pieces.0.centre", [ONE], "pieces[0].centre", "cr3bp needs 3"),
    (SURFACE, "pieces.0.kernel_frame", [["1", "1"], ["1", "1"]], "pieces[0].kernel_frame", "singular"),
    (SURFACE, "pieces.0.radii.2", "-1", "pieces[0].radii[2]", "not positive"),
    (SURFACE, "pieces.0", REGULAR, "pieces[0].kind", "belongs to surfaces"),
    (SURFACE, "claim.covers.coordinate", "x", "claim.covers.coordinate", "choose one of: mu"),
]  # fmt: skip


@pytest.mark.parametrize(("document", "path", "value", "field", "words"), BAD)
def test_bad_input_names_file_field_and_remedy_in_one_line(
    document: dict[str, Any], path: str, value: Any, field: str, words: str, tmp_path: Path
) -> None:
    file = write(tmp_path / "atlas.json", changed(document, path, value))
    with pytest.raises(InputError) as refused:
        read_atlas(file)
    text = str(refused.value)
    assert text.startswith(f"{file}: field {field}:")
    assert words in text
    assert ";" in text
    assert "\n" not in text


@pytest.mark.parametrize(
    "spoil",
    [lambda text: text[:-40], lambda text: text.replace('"0.84"', "NaN"), lambda text: text.replace("{", "", 1)],
    ids=["truncated", "NaN", "no JSON"],
)
def test_files_that_are_not_json_are_refused(spoil: Callable[[str], str], tmp_path: Path) -> None:
    file = tmp_path / "atlas.json"
    file.write_text(spoil(json.dumps(CURVE)))
    with pytest.raises(InputError, match=r"atlas\.json: "):
        read_atlas(file)


def test_curves_around_a_libration_point_have_one_equation_and_no_derived_parameter() -> None:
    piece = {
        **REGULAR, "centre": ["0.01", "0.1"], "frame": [["1", "0"], ["0", "1"]], "polynomial": [["0", "1e-3"]],
        "tube": ["1e-9"],
    }  # fmt: skip
    document = {**CURVE, "system": "cr3bp-l1", "claim": {"kind": "arc", "increasing": ["eps"]}, "pieces": [piece]}
    atlas = atlas_from_json(document, "test")
    assert atlas.system.centre_coordinates == ("eps", "vy")
    assert set(atlas.parameters) == {"mu"}


def test_what_was_found_for_a_claim_is_kept_for_no_other_one() -> None:
    """The setting, by which stored results are taken over, has each field of a claim that its proofs depend on."""
    others: list[tuple[Any, dict[str, list[Any]]]] = [
        (
            PeriodicCurveClaim("periodic-arc", (Fraction(1), Fraction(0)), Fraction(0), 1, 1, "a"),
            {
                "normal": [(Fraction(0), Fraction(1))], "offset": [Fraction(1)], "direction": [-1], "crossings": [2],
                "parameter": ["b", None], "level": [Fraction(0)],
            },
        ),
        (EquilibriumCurveClaim("equilibrium-arc", "a"), {"parameter": ["b"]}),
        (
            BirthCurveClaim("birth-arc", "x", 1, "y", "a"),
            {"section": ["z"], "direction": [-1], "amplitude": ["z"], "parameter": ["b"]},
        ),
    ]  # fmt: skip
    settings = [
        each.setting
        for claim, changes in others
        for each in (claim, *(replace(claim, **{key: value}) for key, values in changes.items() for value in values))
    ]
    assert len(set(settings)) == len(settings) == 15
