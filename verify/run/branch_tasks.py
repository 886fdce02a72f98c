"""The proof of one interval of a piece as a task for an engine: JSON in, JSON out."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import AnyPiece, Atlas, LibrationPiece, SurfacePiece, piece_from_json
from orbitproof.shared.numbers import format_exact, format_rational, parse_exact
from orbitproof.shared.systems import BRANCH_SYSTEMS, ReversibleSystem, describe, described
from orbitproof.verify.atlas.recheck import ProvedBefore
from orbitproof.verify.atlas.results import Settings
from orbitproof.verify.certificate import systems_with
from orbitproof.verify.curve import Interval, PieceLimits, prove_piece
from orbitproof.verify.evidence import Proved
from orbitproof.verify.oracle import ORACLE, counsel
from orbitproof.verify.run import Answer, Failure, Report, Task
from orbitproof.verify.stability import SLOPE_BITS, stability_to_json
from orbitproof.verify.surface import SurfaceLimits, prove_libration_piece, prove_surface_piece

_MOST_SHOWN = 0.95
"""The number of steps is not known before; progress stops here until the interval is done."""


@dataclass(frozen=True)
class RunLimits:
    """How to prove pieces.

    Attributes:
        integrator: settings of `PieceLimits` or `SurfaceLimits` for the first attempt, by name, if not the default.
        timeout: seconds for an interval, or `None`.
        max_splits: how often an interval is halved at most.
        stability: whether the stability of the orbits on proved intervals is enclosed as well.
        order: up to which k all resonances are wanted then.
    """

    integrator: Mapping[str, int]
    timeout: float | None = None
    max_splits: int = 6
    stability: bool = False
    order: int = 1


def attempts_of(atlas: Atlas, limits: RunLimits) -> tuple[Settings, ...]:
    """Settings of the integrator for the first attempt at an interval and for the next one.

    Some orbits lose more digits than others, and no shorter interval makes up for them. Raises `ValueError` if a
    setting is out of range.
    """
    kind = SurfaceLimits if atlas.is_surface else PieceLimits
    given = {**(_FOR_STABILITY if limits.stability else {}), **limits.integrator}
    first = asdict(kind(**given))
    more = {"precision": _MORE_BITS, "order": _MORE_ORDER, "width": _MORE_WIDTH}
    return first, {name: value + more.get(name, 0) for name, value in first.items()}


_MORE_BITS, _MORE_ORDER, _MORE_WIDTH = 48, 8, 8
_FOR_STABILITY = {"precision": 96, "order": 40, "width": 60}
"""More than a proof takes: of n parameters of stability one may be small and the others large."""


def task_of(
    atlas: Atlas, piece: AnyPiece, interval: Interval, settings: Settings, limits: RunLimits, steps: int
) -> Task:
    """The task of proving a piece on an interval; the expected number of `steps` is for progress only."""
    return Task(
        piece.id,
        {
            "system": describe(atlas.system),
            "parameters": {name: format_rational(value) for name, value in atlas.parameters.items()},
            "symmetry": atlas.claim.symmetry,
            "crossings": atlas.claim.crossings,
            "piece": to_json(piece),
            "interval": [format_exact(end) for end in interval],
            "integrator": dict(settings),
            "stability": limits.stability,
            "timeout": limits.timeout,
            "expected_steps": steps,
        },
    )


def task_again(atlas: Atlas, before: ProvedBefore, timeout: float | None) -> Task:
    """The task of proving an interval again that a certificate says is proved; `timeout` in seconds."""
    limits = RunLimits({}, timeout, stability=before.stability)
    argument = dict(task_of(atlas, before.piece, before.interval, before.settings, limits, before.steps).argument)
    if before.stated is not None:
        argument["stated"] = before.stated
    if before.parts:
        argument["parts"] = [[format_exact(end) for end in part] for part in before.parts]
    return Task(before.name, argument)


class _OutOfTimeError(Exception):
    """Raised after a step at which the time is over."""


def prove_task(argument: Mapping[str, Any], report: Report) -> Mapping[str, Any]:
    """What a process does: prove a piece on an interval; the JSON of the result."""
    system = _system_of(argument)
    piece = piece_from_json(argument["piece"], system, "piece")
    start, end = (parse_exact(text) for text in argument["interval"])
    began = time.monotonic()
    timeout = argument["timeout"]

    def stepped(steps: float) -> None:
        report(min(steps / argument["expected_steps"], _MOST_SHOWN), f"step {steps:.0f}")
        if timeout is not None and time.monotonic() - began > timeout:
            raise _OutOfTimeError

    try:
        if isinstance(piece, SurfacePiece):
            surface_limits = SurfaceLimits(**argument["integrator"])
            parts = [(parse_exact(first), parse_exact(last)) for first, last in argument.get("parts", ())]
            return prove_surface_piece(
                system, piece, (start, end), ORACLE, surface_limits, stepped, argument["symmetry"], parts, counsel
            ).to_json()
        if isinstance(piece, LibrationPiece):
            surface_limits = SurfaceLimits(**argument["integrator"])
            return prove_libration_piece(piece, (start, end), ORACLE, surface_limits, stepped).to_json()
        parameters = {name: parse_exact(text) for name, text in argument["parameters"].items()}
        limits, crossings = PieceLimits(**argument["integrator"]), argument.get("crossings", 1)
        more = {"crossings": crossings, **({"slope_bits": SLOPE_BITS} if argument.get("stability") else {})}
        found = prove_piece(
            system, parameters, piece, (start, end), ORACLE, limits, stepped, argument["symmetry"], **more
        )
        result = found.to_json()
        if argument.get("stability") and isinstance(found.outcome, Proved):
            known = found.outcome.results
            result["stability"] = stability_to_json(
                system, parameters, piece, (known.start, known.end), limits, str(found.computation["coordinates"]),
                ORACLE, argument["symmetry"], stepped, known.half_return, crossings,
            )  # fmt: skip
            result["computation"]["seconds"] = round(time.monotonic() - began, 3)
        return result
    except _OutOfTimeError:
        condition, message = "time", f"the time limit of {timeout:g} s has passed"
    except Exception as error:
        # A defect costs one interval, not the run; it is retried by the next run.
        condition, message = "process", " ".join(f"broke off: {type(error).__name__}: {error}".split())
    return not_proved(argument, condition, message, time.monotonic() - began)


def _system_of(argument: Mapping[str, Any]) -> ReversibleSystem:
    """The system by its name or description, or, where it is not known, as a certificate states it."""
    stated = argument.get("stated")
    if stated is None:
        return described(argument["system"])
    claim = stated["claim"]
    return systems_with(BRANCH_SYSTEMS, stated["statement"], claim)[str(claim["system"])]


_REMEDIES = {
    "process": "free memory, or give fewer --jobs",
    "time": "give --timeout more seconds",
    "memory": "give --memory more",
}


def not_proved(argument: Mapping[str, Any], condition: str, message: str, seconds: float) -> dict[str, Any]:
    """The result of a task that was not brought to an end."""
    return {
        "piece": argument["piece"]["id"],
        "interval": list(argument["interval"]),
        "verdict": "not proved",
        "reason": {"condition": condition, "message": message, "remedy": _REMEDIES[condition]},
        "computation": {**argument["integrator"], "seconds": round(seconds, 3)},
    }


def result_of(answer: Answer) -> dict[str, Any]:
    """The result of a task, also if its process was lost."""
    if isinstance(answer.result, Failure):
        return not_proved(answer.task.argument, answer.result.kind, answer.result.message, answer.seconds)
    return dict(answer.result)


ProvePiece = Callable[[Mapping[str, Any], Report], Mapping[str, Any]]
"""`prove_task`, or what takes its place."""
