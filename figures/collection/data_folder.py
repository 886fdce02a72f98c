"""Reading the data folder: each file once, and what is missing named with the command that makes it."""

from __future__ import annotations

from functools import cache, cached_property
from pathlib import Path

from orbitproof.figures.collection.manifest import step_of
from orbitproof.figures.model import (
    MarkedPoint,
    SampledFamily,
    SampledStability,
    assign,
    mark_candidates,
    read_curves,
    read_families,
)
from orbitproof.shared.formats import InputError, read_candidates
from orbitproof.shared.systems import MASS_PARAMETERS


class MissingData(Exception):
    """A picture's data are not there; one line says which, and how they are made."""


class DataFolder:
    """The files of one folder, as the pictures need them. Methods raise `InputError` for bad files."""

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            raise InputError(f"{folder}: no such folder; make it with: orbitproof figures data {folder}")
        self.folder = folder
        self._families = cache(read_families)
        self._curves = cache(read_curves)

    def path(self, name: str) -> Path:
        """The path of a file that has to be there; raises `MissingData`."""
        path = self.folder / name
        if not path.exists():
            raise MissingData(f"{path} is missing; make it with: {step_of(name).text(self.folder)}")
        return path

    @property
    def has_certificates(self) -> bool:
        """Whether there is a certificates file: without it no marker is filled."""
        return (self.folder / "certificates.json").exists()

    @cached_property
    def marks(self) -> list[MarkedPoint]:
        """All candidates with their verdicts."""
        path = self.path("candidates.json")
        certificates = self.folder / "certificates.json"
        return mark_candidates(read_candidates(path), certificates if self.has_certificates else None, path)

    def families(self, name: str) -> list[SampledFamily]:
        """The families of a file."""
        return self._families(self.path(name))

    def curves(self, name: str) -> list[SampledStability]:
        """The finely sampled families of a file."""
        return self._curves(self.path(name))

    def family(self, name: str, kind: str, mass: str | None = None) -> SampledFamily:
        """One family of a file: the `kind` (L1-halo) of a mass given by its name; raises `MissingData`."""
        for family in self.families(name):
            if family.name == kind or family.name.endswith(f"-{kind}"):
                known = mass is None or family.parameters.get("mu") == MASS_PARAMETERS[mass]
                if known:
                    return family
        path = self.path(name)
        wanted = f"{mass} {kind}" if mass else kind
        raise MissingData(f"{path} holds no family {wanted}; make it with: {step_of(name).text(self.folder)}")

    def marks_on(self, *families: SampledFamily) -> list[list[MarkedPoint]]:
        """The marks that lie on each family."""
        return assign(families, self.marks)[0]
