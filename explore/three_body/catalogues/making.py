"""Catalogues of families by name, each a task of its own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.families import FamilyFailure, Limits, TracedFamily, family_of
from orbitproof.explore.flow import Device, batches_on
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.periodic import PeriodicFailure
from orbitproof.explore.records import FamilyRecord
from orbitproof.explore.three_body.catalogues.columns import CLOSING
from orbitproof.explore.three_body.catalogues.dense import between_hits, dense_catalogue
from orbitproof.explore.three_body.catalogues.file import Catalogue
from orbitproof.explore.three_body.catalogues.without_symmetry import triangular_catalogue
from orbitproof.explore.three_body.families import trace_family
from orbitproof.explore.three_body.names import DEFAULT_BRANCH, WITHOUT_SYMMETRY, Branch, name_on
from orbitproof.shared.arguments import ArgumentError
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.shared.wording import counted

MOST_ROWS = 1_000_000


@dataclass(frozen=True)
class CatalogueTask:
    """A catalogue to make.

    Attributes:
        system, name, parameters, limits, branch: as for `trace_family`; or one of `WITHOUT_SYMMETRY`.
        label: the mass parameter as the user named it.
        rows: how many, unless `step` says how far, in arclength of the family, one is from the next.
        device: where they are corrected; the family is traced by the processor.
        record: the family, if it is traced already.
        hits: whether rows are spread over the whole family. Else its ends are left out where all orbits hit the
            smaller primary.
    """

    system: ReversibleSystem
    name: str
    label: str
    parameters: Mapping[str, Fraction]
    limits: Limits
    rows: int
    device: Device = "cpu"
    step: float | None = None
    branch: Branch = DEFAULT_BRANCH
    record: FamilyRecord | None = None
    hits: bool = False

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
    """The result of a task.

    Attributes:
        catalogue: if there is one.
        reason: why the family ends, or why there is no catalogue.
        missing: how many rows were not found, by the reason.
        device: what the device calls itself that corrected the rows; "" where none were.
        hitting: which part of the family was left out because it hits the smaller primary, in words; "" if none was.
    """

    catalogue: Catalogue | None
    reason: str
    missing: Counter[str] = field(default_factory=Counter)
    device: str = ""
    hitting: str = ""

    @property
    def left_out(self) -> str:
        """How many rows were not found and why, in words; "" if all were."""
        if not self.missing:
            return ""
        why = ", ".join(f"{many}: {reason}" for reason, many in self.missing.most_common())
        return f"{counted(self.missing.total(), 'row')} not found, left out ({why})"

    @property
    def corrected(self) -> str:
        """How many rows were corrected, by what, and how well they close, in words; "" if none were."""
        errors = self.catalogue.more.get(CLOSING) if self.catalogue else None
        if not errors or not self.device:
            return ""
        return f"{counted(len(errors), 'row')} corrected by {self.device}, closing to {max(errors):.1e} or better"


def catalogue_task(task: CatalogueTask, progress: Progress) -> MadeCatalogue:
    """Make a catalogue; a family that is not found is a result. Raises `InputError` where the device is missing."""
    if task.device == "gpu" and task.name in WITHOUT_SYMMETRY:
        raise ArgumentError("{device} gpu: the orbits of {0} are corrected one at a time; leave it out", task.name)
    device = batches_on(task.device)
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
        traced, length = TracedFamily(task.name, task.label, family), family.orbits[-1].arclength
        low, high = (0.0, length) if task.hits else between_hits(traced)
        rows = task.rows
        if task.step is not None:
            rows = min(MOST_ROWS, 1 + max(1, ceil((high - low) / task.step)))
        with device as used:
            made, missing = dense_catalogue(traced, np.linspace(low, high, rows), progress)
        return MadeCatalogue(made, family.reason, missing, used, _hitting(low, high, length, rows))
    except (FamilyFailure, CorrectionFailure, PeriodicFailure) as failure:
        return MadeCatalogue(None, str(failure))


def _hitting(low: float, high: float, length: float, rows: int) -> str:
    """The ends of a family that are left out, and how many rows they would have had, in words."""
    ends = [f"up to {low:.4g}"] * (low > 0) + [f"beyond {high:.4g}"] * (high < length)
    if not ends:
        return ""
    many = round((length - (high - low)) * (rows - 1) / (high - low)) if high > low else 0
    at_this_step = f", {counted(many, 'row')} at this step" if many else ""
    where = " and ".join(ends)
    return f"orbits at arclengths {where} of {length:.4g} hit the smaller primary and are left out{at_this_step}"


def symmetric_about_plane(catalogue: Catalogue) -> bool:
    """Whether all states lie on the fixed set of one reversor, so that half an orbit shows all of its distances."""
    states = np.abs(catalogue.states)
    return any(bool(np.max(states[:, odd]) < 1e-6) for odd in ([1, 3, 5], [1, 2, 3]))
