"""Certified orbits against the rows of the catalogue near which they were looked for."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.three_body.catalogues.file import Catalogue
from orbitproof.shared.formats import InputError, read_document
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import CR3BP

ROW = "row-"
"""What the id of a candidate made from a row begins with; the number of the row, counted from 1, follows."""


def compare_certificates(catalogue: Catalogue, path: Path) -> tuple[list[str], bool]:
    """Distances of certified orbits from their rows, as lines of text, and whether all certificates say "proved".

    A distance is one of points in the coordinates (x, z, vy) of Fix(R), from the exact centre of the enclosure; the
    enclosures are far narrower. Raises `InputError`.
    """
    lines = [f"{'row':>6}  {'distance':>9}  {'period':>9}  {'Jacobi':>9}  {'stability':>9}  linear stability"]
    distances, unproved = [], 0
    for entry in read_document(path, "certificates")["certificates"]:
        number = str(entry["id"]).removeprefix(ROW)
        if not (str(entry["id"]).startswith(ROW) and number.isdigit() and 0 < int(number) <= len(catalogue)):
            continue
        if entry["verdict"] != "proved":
            unproved += 1
            lines.append(f"{int(number):6d}  not proved, the run said: {entry['reason']['message']!r}")
            continue
        if parse_exact(entry["statement"]["candidate"]["parameters"]["mu"]) != catalogue.mass_ratio:
            raise InputError(f"{path}: {entry['id']}: about another mass parameter than the catalogue; give its own")
        row, results = int(number) - 1, entry["results"]
        names = [CR3BP.state[index] for index in CR3BP.fixed_coordinates]
        state = [catalogue.states[row][index] for index in CR3BP.fixed_coordinates]
        off = [_difference(results["point"][name], value) for name, value in zip(names, state, strict=True)]
        distances.append(sqrt(sum(value * value for value in off)))
        period = _difference(results["period"], float(catalogue.periods[row]))
        level = _difference(results["level"], float(catalogue.jacobi_constants[row]))
        index = max((_index(each) for each in results["stability_parameters"]), default=float("nan"))
        stability = abs(index - float(catalogue.stability_indices[row])) / max(1.0, index)
        lines.append(
            f"{row + 1:6d}  {distances[-1]:9.1e}  {abs(period):9.1e}  {abs(level):9.1e}  {stability:9.1e}  "
            f"{results['stability']}"
        )
    if not distances and not unproved:
        raise InputError(f"{path}: no certificate of a row; refine them with explore orbit --from-catalogue")
    total = len(distances) + unproved
    lines.append(f"{len(distances)} of {total} certificates say that an orbit near its row is proved")
    if distances:
        lines[-1] += f", at most {max(distances):.1e} from it, in the median {float(np.median(distances)):.1e}"
    lines[-1] += f" (they are not checked here: orbitproof verify --recheck {path})"
    return lines, not unproved


def _difference(ball: Mapping[str, str], value: float) -> float:
    return float(parse_exact(ball["mid"]) - Fraction(value))


def _index(parameter: Mapping[str, Any]) -> float:
    """(|lambda| + 1/|lambda|)/2 of a multiplier with this stability parameter."""
    s = complex(*(float(parse_exact(parameter[part]["mid"])) for part in ("real", "imaginary")))
    size = abs(s + np.sqrt(s - 1) * np.sqrt(s + 1))
    return float((size + 1 / size) / 2)
