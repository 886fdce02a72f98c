"""One piece of a symmetry-breaking surface, proved over an interval of s (section 17.2).

The hypotheses of the theorem on symmetry breaking are checked, for every s of a part of the interval at once, with
tables of derivatives that hold on all of the part. A part on which they do not hold is halved: the integration, which
is what takes the time, is not repeated.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from orbitproof.shared.formats import Candidate, SurfacePiece, evaluate
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.bifurcation import prove
from orbitproof.verify.certificate import check_exactly
from orbitproof.verify.evidence import (
    Checklist,
    IntegrationFailure,
    NotEstablishedError,
    NotProved,
    Proved,
    Reason,
    ball_to_json,
    guarded,
)
from orbitproof.verify.surface.half_return import Interval, SurfaceLimits, SurfaceReturn, enclose_surface

__all__ = ["SurfaceLimits", "SurfacePart", "SurfaceResult", "candidate_at", "check_exact_claim", "prove_surface_piece"]

_END = Fraction(1, 64)
"""Length of the first and of the last part, relative to the interval."""

_HALVINGS = 14
"""How often an interval of s is halved at most to show the hypotheses on its parts."""


@dataclass(frozen=True)
class SurfacePart:
    """What is proved for every s of a part of an interval.

    Attributes:
        interval: of s.
        point: enclosures of the coordinates p of the bifurcation point.
        side: levels of the first integral at which the halo orbits live.
        enclosures: of what the hypotheses are about, by hypothesis and name.
    """

    interval: Interval
    point: tuple[arb, ...]
    side: str
    enclosures: Mapping[str, Mapping[str, arb]]

    def to_json(self) -> dict[str, Any]:
        """The JSON object."""
        return {
            "interval": [format_exact(end) for end in self.interval],
            "point": [ball_to_json(ball) for ball in self.point],
            "side": self.side,
            "hypotheses": {
                name: {key: ball_to_json(ball) for key, ball in balls.items() if ball.is_finite()}
                for name, balls in self.enclosures.items()
            },
        }


@dataclass(frozen=True)
class SurfaceResult:
    """What is known of a piece on an interval of s.

    Attributes:
        piece: its id.
        interval: within [-1, 1].
        parts: cover the interval, in order, if the claim is proved on it.
        time: half periods of the orbits.
        reason: why it is not proved; `None` if it is.
        remedy: what may help.
        computation: precision, order, width, top, steps, coordinates, seconds.
    """

    piece: str
    interval: Interval
    parts: tuple[SurfacePart, ...] = ()
    time: arb | None = None
    reason: str | None = None
    remedy: str | None = None
    computation: Mapping[str, float | int | str] = field(default_factory=dict)

    @property
    def is_proved(self) -> bool:
        """Whether the claim of the piece is proved on the interval."""
        return self.reason is None

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the result; all numbers that carry proof are exact."""
        result: dict[str, Any] = {
            "piece": self.piece,
            "interval": [format_exact(end) for end in self.interval],
            "verdict": "proved" if self.is_proved else "not proved",
            "computation": dict(self.computation),
        }
        if self.reason is not None:
            return result | {"reason": {"message": self.reason, "remedy": self.remedy or ""}}
        return result | {
            "parts": [part.to_json() for part in self.parts],
            "time": ball_to_json(self.time if self.time is not None else arb(float("nan"))),
        }


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
    limits: SurfaceLimits | None = None,
    progress: Callable[[float], None] | None = None,
    symmetry: str = "S",
) -> SurfaceResult:
    """Prove the claim of a piece for all s in an interval within [-1, 1], or say why it is not proved.

    Args:
        progress: called after every integration step with the number of steps; what it raises passes through.
        symmetry: name of the symmetry that breaks.
    """
    limits = SurfaceLimits() if limits is None else limits
    start = time.monotonic()
    steps, coordinates = 0, ""
    try:
        check_exact_claim(system, piece, interval, symmetry)
        with np.errstate(all="ignore"):
            returned = enclose_surface(system, piece, interval, limits, progress)
        steps, coordinates = returned.steps, returned.coordinates
        with guarded(limits.precision):
            parts = tuple(
                part
                for first in _sections(interval)
                for part in _parts(system, piece, returned, first, symmetry, _HALVINGS)
            )
        found = SurfaceResult(piece.id, interval, parts, returned.time)
    except NotEstablishedError as error:
        found = SurfaceResult(piece.id, interval, reason=error.reason.message, remedy=error.reason.remedy)
    except IntegrationFailure as error:
        found = SurfaceResult(piece.id, interval, reason=error.message, remedy=error.remedy)
    except (ArithmeticError, ValueError) as error:
        reason = " ".join(f"the verification broke off: {type(error).__name__}: {error}".split())
        found = SurfaceResult(piece.id, interval, reason=reason, remedy="give a narrower piece")
    computation: dict[str, float | int | str] = {
        "precision": limits.precision, "order": limits.order, "width": limits.width, "top": limits.top,
        "steps": steps, "coordinates": coordinates, "seconds": round(time.monotonic() - start, 3),
    }  # fmt: skip
    return SurfaceResult(
        found.piece, found.interval, found.parts, found.time, found.reason, found.remedy, computation
    )  # fmt: skip


def check_exact_claim(system: ReversibleSystem, piece: SurfacePiece, interval: Interval, symmetry: str) -> None:
    """The exact conditions on a piece that are meant for all s; raises `IntegrationFailure`."""
    start, end = interval
    if not -1 <= start < end <= 1:
        raise IntegrationFailure("interval", f"[{start}, {end}] is no interval within [-1, 1]", "correct it")
    signs = system.symmetries.get(symmetry)
    if signs is None:
        raise IntegrationFailure("symmetry", f"{system.name} has no symmetry {symmetry}", "name one that it has")
    for name, row in zip(system.centre_coordinates, piece.centre, strict=True):
        if signs[system.state.index(name)] < 0 and any(row):
            raise IntegrationFailure(
                "symmetry", f"{symmetry} negates {name}, and the centre moves along it", "set it to 0"
            )


def _sections(interval: Interval) -> list[Interval]:
    """The interval in three parts: where pieces meet, at the ends, short parts enclose the bifurcation point well."""
    start, end = interval
    margin = _END * (end - start)
    return [(start, start + margin), (start + margin, end - margin), (end - margin, end)]


def _parts(
    system: ReversibleSystem,
    piece: SurfacePiece,
    returned: SurfaceReturn,
    interval: Interval,
    symmetry: str,
    halvings: int,
) -> Iterator[SurfacePart]:
    """Parts that cover the interval, each proved; raises `NotEstablishedError` for one that cannot be."""
    middle = (interval[0] + interval[1]) / 2
    found = _prove_part(system, piece, returned, interval, symmetry)
    if isinstance(found, SurfacePart):
        yield found
    elif halvings == 0:
        where = f"for s in [{float(interval[0]):.6g}, {float(interval[1]):.6g}]: "
        raise NotEstablishedError(Reason(found.condition, where + found.message, found.remedy))
    else:
        for half in ((interval[0], middle), (middle, interval[1])):
            yield from _parts(system, piece, returned, half, symmetry, halvings - 1)


def _prove_part(
    system: ReversibleSystem, piece: SurfacePiece, returned: SurfaceReturn, part: Interval, symmetry: str
) -> SurfacePart | Reason:
    """The theorem for every s of a part: its hypotheses do not ask for more than the tables and the exact frames."""
    candidate = candidate_at(system, piece, (part[0] + part[1]) / 2, symmetry)
    checklist = Checklist()
    try:
        check_exactly(checklist, candidate)
    except NotEstablishedError as error:
        return error.reason
    kernel, level = returned.tables(part)
    outcome = prove(candidate, checklist, [kernel], level, [returned.time])
    if isinstance(outcome, NotProved):
        return outcome.reason
    return SurfacePart(part, _point(outcome), outcome.results.side, _enclosures(outcome))


def _enclosures(outcome: Proved) -> dict[str, Mapping[str, arb]]:
    return {hypothesis.name: hypothesis.enclosures for hypothesis in outcome.hypotheses if hypothesis.enclosures}


def _point(outcome: Proved) -> tuple[arb, ...]:
    """The coordinates p of the bifurcation point: the hypothesis `point` encloses them."""
    balls = _enclosures(outcome)["point"]
    return tuple(balls[f"p_{j}"] for j in range(len(outcome.results.point)))
