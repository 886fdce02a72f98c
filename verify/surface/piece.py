"""One piece of a symmetry-breaking surface, proved over an interval of s (section 17.2).

The hypotheses of the theorem on symmetry breaking are checked, for every s of a part of the interval at once, with
tables of derivatives that hold on all of the part. A part on which they do not hold is halved: the integration, which
is what takes the time, is not repeated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from itertools import pairwise

from flint import arb

from orbitproof.shared.formats import Candidate, SurfacePiece, evaluate
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.bifurcation import (
    BifurcationResults,
    Counsel,
    check_exactly,
    prove_by,
    proved_bifurcation,
    silent,
)
from orbitproof.verify.curve import Account, Interval, PieceResult, attempt
from orbitproof.verify.evidence import (
    Checklist,
    Hypothesis,
    NotEstablishedError,
    NotProved,
    Outcome,
    exact_interval_text,
    guarded,
)
from orbitproof.verify.poincare import WideOracle
from orbitproof.verify.surface.half_return import SurfaceLimits, SurfaceReturn, enclose_surface
from orbitproof.verify.surface.proved_parts import ProvedPart, ProvedParts

_END = Fraction(1, 64)
"""Length of the first and of the last part, relative to the interval."""

_HALVINGS = 14
"""How often an interval of s is halved at most to show the hypotheses on its parts."""


@dataclass(frozen=True)
class BreakingTheorem:
    """For every s of the interval the box of the piece contains exactly one symmetry breaking, as the candidate at s
    claims it (section 17.2).
    """

    hypotheses = ("piece", "half-return", "parts")


def candidate_at(system: ReversibleSystem, piece: SurfacePiece, s: Fraction, symmetry: str) -> Candidate:
    """The symmetry-breaking claim of a piece at one s."""
    return Candidate(
        id=piece.id,
        system=system,
        parameters={name: evaluate(row, s) for name, row in piece.parameters.items()},
        kind="symmetry_breaking",
        k=1,
        centre=tuple(evaluate(row, s) for row in piece.centre),
        frame=piece.frame,
        kernel_frame=piece.kernel_frame,
        radii=piece.radii,
        symmetry=symmetry,
    )


def prove_surface_piece(
    system: ReversibleSystem,
    piece: SurfacePiece,
    interval: Interval,
    oracle: WideOracle,
    limits: SurfaceLimits | None = None,
    progress: Callable[[float], None] | None = None,
    symmetry: str = "S",
    sections: Sequence[Interval] = (),
    counsel: Counsel = silent,
) -> PieceResult[ProvedParts]:
    """Prove the claim of a piece for all s in an interval within [-1, 1], or say why it is not proved.

    Args:
        oracle: finds approximations.
        progress: called after every integration step with the number of steps; what it raises passes through.
        symmetry: name of the symmetry that breaks.
        sections: parts that cover the interval, each proved as a whole or in halves; empty: as it suits.
        counsel: is asked about a part that is not proved.
    """
    limits = SurfaceLimits() if limits is None else limits
    computation: Account = {**asdict(limits), "steps": 0, "coordinates": ""}

    def check(checklist: Checklist) -> ProvedParts:
        _check_claim(checklist, system, piece, interval, symmetry)
        with checklist.hypothesis(
            "half-return", "17.2", "the orbits of the piece meet the section again and are enclosed", "narrower pieces"
        ) as evidence:
            returned = enclose_surface(system, piece, interval, limits, oracle, progress)
            computation.update(steps=returned.steps, coordinates=returned.coordinates)
            evidence.record("half period", returned.time)
            evidence.require(returned.time.is_finite(), "the half periods are not enclosed")
        with checklist.hypothesis(
            "parts", "17.2", "the theorem on symmetry breaking holds on parts that cover the interval", "other radii"
        ) as evidence:
            proof = _Parts(system, piece, returned, symmetry, counsel)
            parts = [part for section in sections or _sections(interval) for part in proof.cover(section, _HALVINGS)]
            evidence.require(
                (parts[0].start, parts[-1].end) == interval and all(a.end == b.start for a, b in pairwise(parts)),
                "the parts leave a gap",
            )
        return ProvedParts(tuple(parts), returned.time)

    with guarded(limits.precision):
        return attempt(piece.id, interval, BreakingTheorem(), computation, check)


def _check_claim(
    checklist: Checklist, system: ReversibleSystem, piece: SurfacePiece, interval: Interval, symmetry: str
) -> None:
    """The exact conditions that are meant for all s; those on the frames are checked on every part."""
    statement = "the interval is one of the piece, and the symmetry fixes the centre for every s"
    with checklist.hypothesis("piece", "17.2", statement, "correct the piece") as evidence:
        start, end = interval
        evidence.require(-1 <= start < end <= 1, f"[{start}, {end}] is no interval within [-1, 1]")
        signs = system.symmetries.get(symmetry)
        evidence.require(signs is not None, f"{system.name} has no symmetry {symmetry}")
        for name, row in zip(system.centre_coordinates, piece.centre, strict=True):
            moves = signs is not None and signs[system.state.index(name)] < 0 and any(row)
            evidence.require(not moves, f"{symmetry} negates {name}, and the centre moves along it")


def _sections(interval: Interval) -> list[Interval]:
    """The interval in three parts: where pieces meet, at the ends, short parts enclose the bifurcation point well."""
    start, end = interval
    margin = _END * (end - start)
    return [(start, start + margin), (start + margin, end - margin), (end - margin, end)]


@dataclass(frozen=True)
class _Parts:
    """The theorem on symmetry breaking on parts of the interval on which the half return is enclosed."""

    system: ReversibleSystem
    piece: SurfacePiece
    returned: SurfaceReturn
    symmetry: str
    counsel: Counsel

    def cover(self, interval: Interval, halvings: int) -> Iterator[ProvedPart]:
        """Parts that cover the interval, each proved; raises `NotEstablishedError` for one that cannot be."""
        start, end = interval
        outcome = self._outcome(interval)
        if not isinstance(outcome, NotProved):
            enclosures = {entry.name: _finite(entry) for entry in outcome.hypotheses if entry.enclosures}
            yield ProvedPart(interval, outcome.results.local, outcome.results.side, enclosures)
        elif halvings == 0:
            where = f"for s in {exact_interval_text(start, end)}: "
            raise NotEstablishedError(replace(outcome.reason, message=where + outcome.reason.message))
        else:
            middle = (start + end) / 2
            yield from self.cover((start, middle), halvings - 1)
            yield from self.cover((middle, end), halvings - 1)

    def _outcome(self, part: Interval) -> Outcome[BifurcationResults]:
        """The theorem for every s of a part: its hypotheses ask for no more than the tables and the exact frames."""
        candidate = candidate_at(self.system, self.piece, (part[0] + part[1]) / 2, self.symmetry)
        checklist = Checklist()
        try:
            check_exactly(checklist, candidate)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
        kernel, level = self.returned.tables(part)
        return prove_by(proved_bifurcation, candidate, checklist, [kernel], level, [self.returned.time], self.counsel)


def _finite(hypothesis: Hypothesis) -> dict[str, arb]:
    """The enclosures that can be stored."""
    return {name: ball for name, ball in hypothesis.enclosures.items() if ball.is_finite()}
