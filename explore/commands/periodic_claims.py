"""What ``orbitproof explore periodic`` refines: orbits and the bifurcations of families, as claims in a file."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.shared.formats import BoxClaim, InputError, read_claims, write_candidates, write_text
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.wording import counted

if TYPE_CHECKING:
    from orbitproof.explore.periodic import AffineSection, Bifurcation, FoundOrbit, Hopf, PeriodicFamily

Along = tuple[str | None, float, float]
"""The parameter (`None`: the level) and the interval of ``--along``."""

_WORDS = {
    "fold": "fold", "period doubling": "doubling", "pitchfork": "pitchfork", "Neimark-Sacker": "torus", "Hopf": "hopf",
}  # fmt: skip


class ClaimStore:
    """A candidates file that is written anew with each claim, so that an interrupt loses none.

    Attributes:
        complete: whether all that were to be added could be refined.
    """

    def __init__(self, path: Path, kept: list[BoxClaim], report: Any) -> None:
        self.path = path
        self.complete = True
        self._claims = list(kept)
        self._names = {claim.id for claim in kept}
        self._report = report

    def add(self, name: str, refine: Callable[[], BoxClaim]) -> None:
        """Refine a claim and write it. Raises `InputError` if the file has one of the name."""
        from orbitproof.explore.refinement import RefinementFailure

        if name in self._names:
            raise InputError(f"--id {name}: is in {self.path} already; choose another name")
        self._report.stage(f"refining {name}")
        try:
            claim = refine()
        except RefinementFailure as failure:
            self._report.error(f"{name}: not refined: {failure}")
            self.complete = False
            return
        self._names.add(name)
        self._claims.append(claim)
        write_candidates(self.path, self._claims)

    def close(self) -> None:
        """Say what the file has."""
        if self._claims:
            self._report.message(f"{self.path} holds {counted(len(self._claims), 'claim')}")


def kept_claims(options: argparse.Namespace) -> list[BoxClaim]:
    """What the output file holds already, with --append. Raises `InputError`."""
    if options.append and options.output is not None and options.output.is_file():
        return read_claims(options.output)
    return []


def refine_orbits(options: argparse.Namespace, orbits: list[FoundOrbit], store: ClaimStore, report: Any) -> None:
    """Refine all orbits and write them. Raises `InputError`."""
    from orbitproof.explore.periodic import refined

    base = options.id or orbits[0].problem.system.name
    for number, orbit in enumerate(orbits, start=1):
        name = base if len(orbits) == 1 else f"{base}-{number}"
        store.add(name, lambda name=name, orbit=orbit: refined(orbit, name, options.digits, report.update))


def follow_families(
    options: argparse.Namespace,
    orbit: FoundOrbit,
    along: Along,
    store: ClaimStore | None,
    report: Any,
) -> int:
    """Follow the family of an orbit, and those that are born from it; returns the exit code.

    Arguments:
        store: for claims about the bifurcations; `None`: they are only told.

    Raises `InputError`.
    """
    from orbitproof.explore.periodic import (
        PeriodicFailure,
        followed,
    )

    name, low, high = along
    report.stage(f"following the family in {name or 'the level'}")
    section = None if options.section is None else orbit.section
    base = options.id or orbit.problem.system.name
    passed = Passed(base, options, store, report, section)
    try:
        families = followed(orbit, name, (low, high), options.generations, options.symmetry, passed.say)
        code = passed.take(families)
    except PeriodicFailure as failure:
        report.error(f"{orbit.problem.system.name}: {failure}")
        return 1
    except ValueError as error:
        raise InputError(f"--symmetry: {error}; give an involution that the vector field respects") from None
    if code == 0 and store is not None and not passed.claimed:
        some = "of which there are claims " if any(family.bifurcations for family in passed.families) else ""
        report.error(
            f"no fold, doubling, pitchfork, Neimark-Sacker or Hopf point {some}on the way; none is in {store.path}"
        )
        return 1
    return code


class Passed:
    """What families pass: told, and each bifurcation written once.

    Attributes:
        families: those that were taken.
    """

    def __init__(
        self,
        base: str,
        options: argparse.Namespace,
        store: ClaimStore | None,
        report: Any,
        section: AffineSection | None = None,
    ) -> None:
        self._base = base
        self._options = options
        self._store = store
        self._report = report
        self._section = section
        self._known: list[Bifurcation] = []
        self._hopf: list[Hopf] = []
        self._counts = dict.fromkeys(_WORDS, 0)
        self.families: list[PeriodicFamily] = []

    @property
    def claimed(self) -> int:
        """How many claims there were to be."""
        return sum(self._counts.values())

    def say(self, message: str, fraction: float | None) -> None:
        """Tell how far it is."""
        if message:
            self._report.stage(message)
        else:
            self._report.update("", fraction)

    def take(self, families: Iterable[PeriodicFamily]) -> int:
        """Take families as they come; `INTERRUPTED` or 0."""
        from orbitproof.explore.periodic import family_as_json, family_described, is_same, refine_bifurcation

        for family in families:
            self.families.append(family)
            self._report.tell(family_described(family), family_as_json(family))
            _write_family(self._options, family, len(self.families), self._report)
            if family.interrupted:
                self._report.error("interrupted; the family so far is kept")
                return INTERRUPTED
            for found in family.bifurcations:
                if any(is_same(found, other) for other in self._known):
                    continue
                self._known.append(found)
                if found.kind in self._counts and not found.is_double:
                    self._add(
                        found.kind,
                        lambda title, found=found: refine_bifurcation(
                            found, title, self._options.digits, self._report.update, self._section
                        ),
                    )
            for point in family.hopf:
                self.take_hopf(point)
            self._report.stage("following")
        return 0

    def take_hopf(self, point: Hopf) -> None:
        """Write a Hopf point if it is a new one."""
        from orbitproof.explore.periodic import hopf_claim, is_same_hopf

        if any(is_same_hopf(point, other) for other in self._hopf):
            return
        self._hopf.append(point)
        self._add(point.kind, lambda title: hopf_claim(point, title, self._options.digits, self._report.update))

    def _add(self, kind: str, refine: Callable[[str], BoxClaim]) -> None:
        self._counts[kind] += 1
        if self._store is not None:
            title = f"{self._base}-{_WORDS[kind]}-{self._counts[kind]}"
            self._store.add(title, lambda: refine(title))


def _write_family(options: argparse.Namespace, family: PeriodicFamily, number: int, report: Any) -> None:
    """Family number 1 to the files of the options, others to files with their number in the name."""
    from orbitproof.explore.periodic import family_csv, write_periodic_family

    for path, write in (
        (options.csv, lambda file: write_text(file, family_csv(family))),
        (options.family_output, lambda file: write_periodic_family(file, family)),
    ):
        if path is not None:
            file = path if number == 1 else path.with_name(f"{path.stem}-{number}{path.suffix}")
            write(file)
            report.message(f"{len(family.members)} orbits are in {file}")
