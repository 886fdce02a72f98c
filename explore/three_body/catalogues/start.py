"""Starting from a catalogue file: its orbits corrected and compared, and one of them as the seed of a family."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import Family, in_fixed_space
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.three_body.catalogues.file import Catalogue, read_catalogue
from orbitproof.explore.three_body.catalogues.orbits import CorrectedCatalogue, correct_catalogue
from orbitproof.shared.formats import InputError, decimal_text
from orbitproof.shared.systems import MASS_PARAMETERS
from orbitproof.shared.wording import counted

MOST_LINES = 20
"""So many failed orbits are listed one by one."""


@dataclass(frozen=True)
class CatalogueStart:
    """A catalogue as the start of a search.

    Attributes:
        name, label: of the family and of its mass parameter, for messages and files.
        seed: the chosen orbit, `None` if it could not be corrected.
        table: how far the corrected orbits are from the catalogue's numbers, as lines of text.
        complete: whether every orbit was corrected, to that of its row.
        corrected: the corrected orbits in the catalogue's form, `None` if there are none.
    """

    name: str
    label: str
    seed: Family | None
    table: tuple[str, ...]
    complete: bool
    corrected: Catalogue | None


def catalogue_start(
    path: Path, number: int | None, tolerance: float, report: Reporter, accept: bool = False
) -> CatalogueStart:
    """Read a catalogue, correct its orbits and take orbit `number`, counted from 1, or the middle one.

    What a row says that is not so of the orbit found is told, and such a row left out, unless `accept` takes it.
    Raises `InputError`.
    """
    catalogue = read_catalogue(path)
    if number is None:
        number = (len(catalogue) + 1) // 2
    if number > len(catalogue):
        raise InputError(
            f"--catalogue-orbit {number}: {path} has {counted(len(catalogue), 'orbit')}; give a smaller number"
        )
    report.stage(f"correcting {counted(len(catalogue), 'orbit')} of {path}")
    corrected = correct_catalogue(catalogue, tolerance=tolerance, accept=accept, progress=report.update)
    failed = [(index, failure) for index, failure in enumerate(corrected.reasons, start=1) if failure]
    for index, failure in failed[:MOST_LINES]:
        report.error(f"{path}: orbit {index}: {failure}")
    if len(failed) > MOST_LINES:
        report.error(f"{path}: {len(failed) - MOST_LINES} more orbits are not taken")
    seed = None
    try:
        seed = _seed(corrected, number - 1)
    except CorrectionFailure as error:
        report.error(f"--catalogue-orbit {number}: no family is traced from it: {error}")
    mass = catalogue.mass_ratio
    label = next((name for name, value in MASS_PARAMETERS.items() if value == mass), decimal_text(mass))
    return CatalogueStart(
        catalogue.title, label, seed, tuple(agreement_table(corrected)), not failed,
        corrected.result,
    )  # fmt: skip


def without_contradictions(catalogue: Catalogue) -> tuple[Catalogue, list[str]]:
    """The rows that no orbit found contradicts, and a line for each of the others."""
    corrected = correct_catalogue(catalogue)
    told = [f"orbit {index}: {why}" for index, why in enumerate(corrected.contradictions, start=1) if why]
    return catalogue.chosen(np.flatnonzero([not why for why in corrected.contradictions])), told


def _seed(corrected: CorrectedCatalogue, index: int) -> Family:
    if corrected.reasons[index]:
        raise CorrectionFailure("no orbit of its row was found")
    seed = corrected.seed(index)
    if in_fixed_space(seed.problem, seed.orbits[0]):
        raise CorrectionFailure("it lies in the plane, where two families meet; choose another orbit")
    return seed


def agreement_table(corrected: CorrectedCatalogue) -> list[str]:
    """How far the corrected orbits are from the catalogue's numbers, as lines of text."""
    catalogue, differences = corrected.catalogue, corrected.differences
    count = int(np.count_nonzero(corrected.corrected))
    lines = [
        f"{catalogue.title}: {count} of {len(catalogue)} orbits corrected, "
        f"mass ratio {decimal_text(catalogue.mass_ratio)}"
    ]
    if not count:
        return lines
    lines.append(f"{'difference from the catalogue':32}{'median':>10}{'largest':>10}  at orbit")
    for name, values in (
        ("first point", differences.state),
        ("Jacobi constant", differences.jacobi_constant),
        ("period", differences.period),
        ("stability index, relative", differences.stability_index),
    ):
        worst = int(np.nanargmax(values))
        lines.append(f"{name:32}{np.nanmedian(values):10.1e}{values[worst]:10.1e}  {worst + 1}")
    return lines
