"""What ``orbitproof explore periodic`` refines: orbits and the bifurcations of families, as claims in a file."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.shared.formats import BoxClaim, InputError, read_claims, write_candidates, write_text
from orbitproof.shared.interrupts import INTERRUPTED

if TYPE_CHECKING:
    from orbitproof.explore.periodic import FoundOrbit, PeriodicFamily

Along = tuple[str | None, float, float]
"""The parameter (`None`: the level) and the interval of ``--along``."""

Told = tuple[list[str], dict[str, Any]]
"""Lines, and what they say for programs."""

_WORDS = {
    "fold": "fold", "period doubling": "doubling", "pitchfork": "pitchfork", "Neimark-Sacker": "torus",
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
            self._report.message(f"{len(self._claims)} claims are in {self.path}")


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
    told: list[Told],
) -> int:
    """Follow the family of an orbit, and those that are born from it; returns the exit code.

    Arguments:
        store: for claims about the bifurcations; `None`: they are only told.
        told: to which what is to be printed is appended, lines with what they say for programs.

    Raises `InputError`.
    """
    from orbitproof.explore.periodic import (
        PeriodicFailure,
        family_as_json,
        family_described,
        followed,
        is_same,
        refine_bifurcation,
    )

    name, low, high = along
    report.stage(f"following the family in {name or 'the level'}")

    def say(message: str, fraction: float | None) -> None:
        if message:
            report.stage(message)
        else:
            report.update("", fraction)

    section = None if options.section is None else orbit.section
    base, known, counts, number = options.id or orbit.problem.system.name, [], dict.fromkeys(_WORDS, 0), 0
    try:
        for family in followed(orbit, name, (low, high), options.generations, options.symmetry, say):
            number += 1
            told.append((family_described(family), family_as_json(family)))
            _write_family(options, family, number, report)
            if family.interrupted:
                report.error("interrupted; the family so far is kept")
                return INTERRUPTED
            for found in family.bifurcations:
                if any(is_same(found, other) for other in known):
                    continue
                known.append(found)
                if store is not None and found.kind in counts:
                    counts[found.kind] += 1
                    title = f"{base}-{_WORDS[found.kind]}-{counts[found.kind]}"
                    store.add(
                        title,
                        lambda title=title, found=found: refine_bifurcation(
                            found, title, options.digits, report.update, section
                        ),
                    )
            report.stage("following")
    except PeriodicFailure as failure:
        report.error(f"{orbit.problem.system.name}: {failure}")
        return 1
    except ValueError as error:
        raise InputError(f"--symmetry: {error}; give an involution that the vector field respects") from None
    if store is not None and not sum(counts.values()):
        report.error(f"no fold, doubling, pitchfork or Neimark-Sacker point on the way; none is in {store.path}")
        return 1
    return 0


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
