"""``orbitproof explore branches``: follow the new orbits of bifurcation points, numerical or certified."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands.common import add_output, add_quiet
from orbitproof.explore.names import examined
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import (
    Candidate,
    InputError,
    candidate_from_json,
    check_writable,
    read_candidates,
    read_document,
    select_ids,
    stated_format,
    validate_document,
)
from orbitproof.shared.help_text import add_command
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.printed_tables import fitted
from orbitproof.shared.systems import shown

if TYPE_CHECKING:
    from orbitproof.explore.branches import Birth, BranchRecord
    from orbitproof.explore.engines import Reporter

_EXAMPLES = """\
examples:
  orbitproof explore branches certificates.json -o branches.json
  orbitproof explore branches candidates.json --only earth-moon-L1-halo-k3-1 --length 0.2 -o branches.json

The new orbits of a point with multiplicity k close after k times the period. Each branch is followed to both
sides of the point, and the side of the Jacobi constant (or beta) on which the first new orbits are is
compared with that of the certificate. Where R is lost (kind reversor_breaking) the new orbits are followed over
their whole period, and their mirror images on the other side. Lengths are those of the starting points on Fix(R), or
beside it in the section, a coordinate in units of its own size where it exceeds 1.
Exit codes: 0 all branches found, 1 one was not found or contradicts its certificate, 2 bad input, 130 interrupted
(what was found by then is written).
"""


NEAR_FOLD = 0.05
"""Part of the length that was followed within which a fold of the level is worth a message."""


@dataclass(frozen=True)
class Claim:
    """A point to start from: the claim, and what its certificate says, if there is one."""

    candidate: Candidate
    verdict: str | None = None
    side: str | None = None


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "branches", "switch onto the new orbits at bifurcation points and follow them", _EXAMPLES
    )
    parser.add_argument("points", type=Path, metavar="FILE", help="candidates or certificates file")
    parser.add_argument("--only", nargs="+", metavar="ID", help="these points only (with * and ? as in file names)")
    parser.add_argument(
        "--length",
        type=float,
        default=0.05,
        metavar="L",
        help="arclength to follow on each side, in (0, 100] (default: %(default)s)",
    )
    parser.add_argument(
        "--orbits",
        type=int,
        default=60,
        metavar="N",
        help="at most so many orbits on each side, 4 to 10000 (default: %(default)s)",
    )
    add_output(parser, "branch file")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Follow the branches and write them; returns the exit code. Raises `InputError`."""
    if not isfinite(options.length) or not 0 < options.length <= 100:
        raise InputError(f"--length {options.length}: give a number in (0, 100]")
    if not 4 <= options.orbits <= 10_000:
        raise InputError(f"--orbits {options.orbits}: give a whole number from 4 to 10000")
    known = {claim.candidate.id: claim for claim in read_claims(options.points)}
    claims = [known[name] for name in select_ids(known, options.only, "point")]
    for claim in claims:
        examined(claim.candidate.system, f"{options.points}: {claim.candidate.id}")
    check_writable(options.output)
    from orbitproof.explore.branches import write_branches
    from orbitproof.explore.engines import Reporter

    found: list[BranchRecord] = []
    with Reporter(options.quiet) as report:
        report.stage("branches")
        complete, interrupted = True, False
        try:
            for number, claim in enumerate(claims):
                branch = _branch(claim, options, number, len(claims), report)
                complete = _announce(claim, branch, report) and complete
                if branch is not None:
                    found.append(branch)
                    if any(side.outcome == "interrupted" for side in branch.sides):
                        raise KeyboardInterrupt
        except KeyboardInterrupt:
            interrupted = True
        write_branches(options.output, found)
        report.message(f"{len(found)} of {len(claims)} points written to {options.output}")
        if interrupted:
            report.error("interrupted; the branches found so far are written")
    _print_rows(found)
    return INTERRUPTED if interrupted else 0 if complete else 1


def read_claims(path: Path) -> list[Claim]:
    """The points of a candidates or a certificates file. Raises `InputError`."""
    if stated_format(path, "give candidates or certificates") != "certificates":
        return [Claim(candidate) for candidate in read_candidates(path) if _is_followed(candidate)]
    claims: dict[str, Claim] = {}
    for index, entry in enumerate(read_document(path, "certificates")["certificates"]):
        where = f"{path}: field certificates[{index}]"
        stated: Mapping[str, Any] = entry["statement"]["candidate"]
        document = {"format": "orbitproof-candidates", "version": 1, "candidates": [stated]}
        validate_document(document, "candidates", f"{where}.statement.candidate")
        candidate = candidate_from_json(stated, f"{where}.statement.candidate")
        if candidate.id in claims:
            raise InputError(f"{where}.id: {candidate.id!r} appears twice; keep one certificate for each candidate")
        if not _is_followed(candidate):
            continue
        results = entry["results"]
        claims[candidate.id] = Claim(candidate, entry["verdict"], results["side"] if results else None)
    return list(claims.values())


def _is_followed(candidate: Candidate) -> bool:
    return candidate.has_branch or candidate.loses_reversor


def _branch(
    claim: Claim, options: argparse.Namespace, number: int, total: int, report: Reporter
) -> BranchRecord | None:
    # JAX takes a second to load: only after the input is known to be good.
    from orbitproof.explore.branches import NoBranch, branch_point, follow

    name = claim.candidate.id
    report.update(name, number / total)
    try:
        start = branch_point(claim.candidate)
        branch = follow(
            start,
            length=options.length,
            orbits=options.orbits,
            progress=lambda fraction: report.update(name, (number + fraction) / total),
        )
    except NoBranch as failure:
        report.error(f"{name}: {failure}")
        return None
    return branch.record(claim.verdict, claim.side)


def _announce(claim: Claim, branch: BranchRecord | None, report: Reporter) -> bool:
    """Say what is wrong with a branch; whether nothing is."""
    name = claim.candidate.id
    if branch is None:
        return False
    if branch.birth is None:
        report.error(f"{name}: {branch.failure}")
        return False
    if branch.contradicts:
        report.error(
            f"{name}: CONTRADICTION: the certificate says that the new orbits are {claim.side!r}, the orbits found are "
            f"{branch.birth.side!r} (level = level at the bifurcation + {branch.birth.slope:.6g} a + "
            f"{branch.birth.curvature:.6g} a^2, measured at a = {branch.birth.amplitude:.3g})"
        )
        return False
    fold = _fold(branch.birth)
    if fold is not None and fold < NEAR_FOLD * max(abs(side.orbits[-1].arclength) for side in branch.sides):
        report.message(
            f"{name}: the level turns back already at the arclength {fold:.2g}: farther away the new orbits are "
            f"{'above' if branch.birth.curvature > 0 else 'below'} on both sides of the branch"
        )
    for side, sign in zip(branch.sides, "-+", strict=True):
        if side.outcome == "failed":
            report.message(f"{name}: side {sign} ends early: {side.reason}")
    return True


def _fold(birth: Birth) -> float | None:
    """Where the level along a touch-and-go branch turns back, by its first two coefficients."""
    return abs(birth.slope / (2 * birth.curvature)) if birth.slope and birth.curvature else None


_COLUMNS = ("k", "side", "certified", "slope", "curvature", "orbits -", "orbits +", "id")


def _print_rows(branches: Sequence[BranchRecord]) -> None:
    """One line for each branch on standard output."""
    rows: list[tuple[str, ...]] = [_COLUMNS]
    for branch in branches:
        birth, counts = branch.birth, [str(len(side.orbits)) for side in branch.sides] or ["0", "0"]
        certified = branch.certified_side or ("-" if branch.verdict is None else branch.verdict)
        numbers = ["-"] * 3 if birth is None else [birth.side, f"{birth.slope:.6g}", f"{birth.curvature:.6g}"]
        rows.append((str(branch.k), numbers[0], certified, *numbers[1:], counts[0], counts[1], shown(branch.id)))
    tell("\n".join(fitted(rows, head=-1)), list(map(_as_json, branches)))


def _as_json(branch: BranchRecord) -> dict[str, Any]:
    """What is known of a branch, for programs."""
    birth = branch.birth
    return {
        "id": branch.id,
        "k": branch.k,
        "verdict": branch.verdict,
        "certified_side": branch.certified_side,
        "side": None if birth is None else birth.side,
        "slope": None if birth is None else birth.slope,
        "curvature": None if birth is None else birth.curvature,
        "orbits": [len(side.orbits) for side in branch.sides],
        "failure": branch.failure or None,
    }
