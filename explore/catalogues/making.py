"""Catalogues of families by name, each a task of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

import numpy as np

from orbitproof.explore.catalogues.dense import dense_catalogue
from orbitproof.explore.catalogues.file import Catalogue
from orbitproof.explore.catalogues.without_symmetry import triangular_catalogue
from orbitproof.explore.engines import Progress
from orbitproof.explore.families import FamilyFailure, Limits, TracedFamily, family_of, trace_family
from orbitproof.explore.names import DEFAULT_BRANCH, WITHOUT_SYMMETRY, Branch, name_on
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.periodic import PeriodicFailure
from orbitproof.explore.records import FamilyRecord
from orbitproof.shared.systems import ReversibleSystem

MOST_ROWS = 1_000_000


@dataclass(frozen=True)
class CatalogueTask:
    """A catalogue to make.

    Attributes:
        system, name, parameters, limits, branch: as for `trace_family`; or one of `WITHOUT_SYMMETRY`.
        label: the mass parameter as the user named it.
        rows: how many, unless `step` says how far, in arclength of the family, one is from the next.
        record: the family, if it is traced already.
    """

    system: ReversibleSystem
    name: str
    label: str
    parameters: Mapping[str, Fraction]
    limits: Limits
    rows: int
    step: float | None = None
    branch: Branch = DEFAULT_BRANCH
    record: FamilyRecord | None = None

    @property
    def called(self) -> str:
        """The name of the family in files."""
        return self.name if self.record is not None else name_on(self.name, self.branch)

    @property
    def title(self) -> str:
        """For messages and files."""
        return f"{self.label} {self.called}" if self.label else self.called


@dataclass(frozen=True)
class MadeCatalogue:
    """The result of a task: the catalogue, if there is one, why the family ends, and how many rows were not found."""

    catalogue: Catalogue | None
    reason: str
    missing: int = 0


def catalogue_task(task: CatalogueTask, progress: Progress) -> MadeCatalogue:
    """Make a catalogue; a family that is not found is a result."""
    try:
        if task.name in WITHOUT_SYMMETRY:
            made, reason = triangular_catalogue(task.name, task.parameters["mu"], task.label, task.rows, progress)
            return MadeCatalogue(made, reason)
        if task.record is not None:
            family = family_of(task.record)
        else:
            family = trace_family(
                task.system, task.name, task.parameters, task.limits, branch=task.branch, progress=progress
            )
        if family.outcome == "interrupted":
            raise KeyboardInterrupt
        rows = task.rows
        if task.step is not None:
            rows = min(MOST_ROWS, 1 + max(1, ceil(family.orbits[-1].arclength / task.step)))
        made, missing = dense_catalogue(TracedFamily(task.name, task.label, family), rows, progress)
        return MadeCatalogue(made, family.reason, missing)
    except (FamilyFailure, CorrectionFailure, PeriodicFailure) as failure:
        return MadeCatalogue(None, str(failure))


def symmetric_about_plane(catalogue: Catalogue) -> bool:
    """Whether all states lie on the fixed set of one reversor, so that half an orbit shows all of its distances."""
    states = np.abs(catalogue.states)
    return any(bool(np.max(states[:, odd]) < 1e-6) for odd in ([1, 3, 5], [1, 2, 3]))
