"""Bifurcating branches for scripts and notebooks; `orbitproof.explore` hands these names on."""

from __future__ import annotations

from orbitproof.explore.branches.claims import task_of
from orbitproof.explore.branches.file import BranchRecord
from orbitproof.explore.branches.following import follow
from orbitproof.explore.branches.start import branch_point
from orbitproof.explore.engines import Reporter
from orbitproof.explore.periodic import refine_periodic
from orbitproof.shared.claims import Candidate, PeriodicOrbit


def follow_branch(
    claim: Candidate, *, length: float = 0.05, orbits: int = 60, side: str | None = None, quiet: bool = False
) -> BranchRecord:
    """The new orbits at a bifurcation point, or where R is lost, to both sides, in double precision.

    Arguments:
        claim: from `explore.refine` or `explore.refine_at`, or the candidate of a certificate.
        length: arclength to follow on each side.
        orbits: the largest number of orbits on each side.
        side: of the new orbits, as proved, "above", "below" or "both"; `contradicts` of the record compares.
        quiet: nothing on standard error; else progress.

    The record says in `failure` why no new orbit was found. Raises `NoBranch`, one line, where there can be none.
    """
    if not (0 < length <= 100 and 4 <= orbits <= 10_000):
        raise ValueError(f"length {length!r}, orbits {orbits!r}: give a length in (0, 100] and 4 to 10000 orbits")
    with Reporter(quiet) as report:
        report.stage(f"following the branch of {claim.id}")
        branch = follow(
            branch_point(claim), length=length, orbits=orbits, progress=lambda done: report.update(claim.id, done)
        )
    return branch.record(None if side is None else "proved", side)


def refine_new_orbit(branch: BranchRecord, number: int, *, digits: int = 50, quiet: bool = False) -> PeriodicOrbit:
    """The claim about an orbit that R does not map to itself, for `verify.certify`.

    Arguments:
        branch: from `follow_branch`, or of a branch file, where R is lost.
        number: 1 for the first orbit from the birth, -1 for that on the other side.
        digits: decimal digits of the point.

    Raises `ValueError` if there is no such orbit, `RefinementFailure` if Newton's method does not converge.
    """
    task = task_of(branch, number, digits)
    with Reporter(quiet) as report:
        report.stage(f"refining {task.id}")
        return refine_periodic(task, report.update)
