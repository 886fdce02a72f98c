"""The proof of one interval of a piece: what is asked, and the result, both JSON (sections 15.2 and 17.2).

What is asked says all that the proof is about, and the result is that of the piece that it names; where it is done, and
by whom it is carried there and back, is another matter.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from orbitproof.shared.formats import (
    AnyAtlas,
    AnyPiece,
    BirthPiece,
    LibrationPiece,
    Piece,
    SurfacePiece,
    atlas_without_symmetry,
    curve_claim_from_json,
    periodic_piece_from_json,
    piece_from_json,
    system_without_symmetry,
)
from orbitproof.shared.numbers import format_exact, format_rational, parse_exact
from orbitproof.shared.processes import Report
from orbitproof.shared.systems import BRANCH_SYSTEMS, ReversibleSystem, describe, described
from orbitproof.verify.attempt import counsel
from orbitproof.verify.branches.kinds import kind_of
from orbitproof.verify.branches.results import Result, Settings
from orbitproof.verify.certificate import systems_with
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.curve import NOT_PROVED, Computation, Interval, PieceLimits, prove_birth_piece, prove_piece
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits
from orbitproof.verify.evidence import Proved, Reason
from orbitproof.verify.lasting import CurveIntervalResult, twist_of_piece
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import (
    TubeOfOrbits,
    about_closer_polynomial,
    sharpened,
    stability_of_piece,
    stability_slope_bits,
)
from orbitproof.verify.surface import SurfaceLimits, prove_libration_piece, prove_surface_piece

_MOST_SHOWN = 0.95
"""The number of steps is not known before; progress stops here until the interval is done."""


def question(
    atlas: AnyAtlas,
    piece: AnyPiece,
    interval: Interval,
    settings: Settings,
    stability: bool,
    timeout: float | None,
    steps: int,
    lasting: bool = False,
) -> dict[str, Any]:
    """What `prove_task` is asked: a piece of an atlas on an interval of s, with settings of the integrator.

    `stability`: whether that of its orbits is enclosed as well; `lasting`: their twist too; `timeout` in seconds;
    the expected number of `steps` is for progress only.
    """
    return {
        "system": describe(atlas.system),
        "parameters": {name: format_rational(value) for name, value in atlas.parameters.items()},
        "symmetry": atlas.claim.symmetry,
        "crossings": atlas.claim.crossings,
        "piece": to_json(piece),
        "interval": [format_exact(end) for end in interval],
        "integrator": dict(settings),
        "stability": stability,
        **({"lasting": True} if lasting else {}),
        "timeout": timeout,
        "expected_steps": steps,
        **kind_of(atlas).in_question(atlas),
    }


class _OutOfTimeError(Exception):
    """Raised after a step at which the time is over."""


def prove_task(argument: Mapping[str, Any], report: Report) -> Mapping[str, Any]:
    """What a process does: prove a piece on an interval; the JSON of the result."""
    began = time.process_time()
    timeout = argument["timeout"]

    def stepped(steps: float) -> None:
        report(min(steps / argument["expected_steps"], _MOST_SHOWN), f"step {steps:.0f}")
        if timeout is not None and time.process_time() - began > timeout:
            raise _OutOfTimeError

    try:
        if "claim" in argument:
            return dict(to_json(_periodic(argument, stepped)))
        system = _system_of(argument)
        piece = piece_from_json(argument["piece"], system, "piece")
        asked = _Asked(system, argument, began)
        return dict(to_json(_PROOFS[type(piece)](piece, asked, stepped)))
    except _OutOfTimeError:
        condition, message = "time", f"the time limit of {timeout:g} s has passed"
    except Exception as error:
        # A defect costs one interval, not the run; it is retried by the next run.
        condition, message = "process", " ".join(f"broke off: {type(error).__name__}: {error}".split())
    return dict(to_json(not_proved(argument, condition, message, time.process_time() - began)))


Stepped = Callable[[float], None]


@dataclass(frozen=True)
class _Asked:
    """An interval of a piece, as `prove_task` is asked."""

    system: ReversibleSystem
    argument: Mapping[str, Any]
    began: float

    @property
    def interval(self) -> Interval:
        start, end = (parse_exact(text) for text in self.argument["interval"])
        return start, end

    @property
    def parameters(self) -> dict[str, Fraction]:
        return {name: parse_exact(text) for name, text in self.argument["parameters"].items()}


def _of_surface(piece: SurfacePiece, asked: _Asked, stepped: Stepped) -> Result:
    argument = asked.argument
    parts = [(parse_exact(first), parse_exact(last)) for first, last in argument.get("parts", ())]
    return prove_surface_piece(
        asked.system, piece, asked.interval, ORACLE, SurfaceLimits(**argument["integrator"]), stepped,
        argument["symmetry"], parts, counsel,
    ).stored  # fmt: skip


def _of_libration(piece: LibrationPiece, asked: _Asked, stepped: Stepped) -> Result:
    limits = SurfaceLimits(**asked.argument["integrator"])
    return prove_libration_piece(piece, asked.interval, ORACLE, limits, stepped).stored


def _of_birth(piece: BirthPiece, asked: _Asked, stepped: Stepped) -> Result:
    limits = PieceLimits(**asked.argument["integrator"])
    return prove_birth_piece(asked.system, asked.parameters, piece, asked.interval, ORACLE, limits, stepped).stored


def _of_curve(piece: Piece, asked: _Asked, stepped: Stepped) -> Result:
    argument, system, parameters = asked.argument, asked.system, asked.parameters
    limits, crossings = PieceLimits(**argument["integrator"]), argument.get("crossings", 1)
    slopes = {"slope_bits": stability_slope_bits(limits.precision)} if argument.get("stability") else {}
    more = {"crossings": crossings, **slopes}
    found = prove_piece(
        system, parameters, piece, asked.interval, ORACLE, limits, stepped, argument["symmetry"], **more
    )
    if not (argument.get("stability") and isinstance(found.outcome, Proved)):
        return found.stored
    known = found.outcome.results
    tube = TubeOfOrbits(
        system, parameters, piece, (known.start, known.end), limits, str(found.computation.coordinates),
        ORACLE, argument["symmetry"], crossings,
    )  # fmt: skip
    half = known.half_return
    if argument.get("lasting"):
        tube, half = sharpened(tube, half, stepped)
    elif is_of_axial_orbits(system):
        tube, half = about_closer_polynomial(tube, half)
    stability = stability_of_piece(tube, stepped, half)
    twist = twist_of_piece(tube, stepped, half, stability) if argument.get("lasting") else None
    computation = replace(found.computation, seconds=round(time.process_time() - asked.began, 3))
    return CurveIntervalResult(
        **{**vars(found.stored), "computation": computation, "stability": stability, "twist": twist}
    )


_PROOFS: Mapping[type[AnyPiece], Callable[[Any, _Asked, Stepped], Result]] = {
    Piece: _of_curve,
    SurfacePiece: _of_surface,
    LibrationPiece: _of_libration,
    BirthPiece: _of_birth,
}
"""By the type of the piece."""


def _periodic(argument: Mapping[str, Any], stepped: Callable[[float], None]) -> Result:
    """The result on an interval of a piece of a curve that uses no symmetry."""
    system = system_without_symmetry(argument["system"], "system", BRANCH_SYSTEMS)
    claim = curve_claim_from_json(argument["claim"], "claim")
    piece = periodic_piece_from_json(argument["piece"], claim.coordinates(system), system.name, "piece")
    parameters = {name: parse_exact(text) for name, text in argument["parameters"].items()}
    start, end = (parse_exact(text) for text in argument["interval"])
    atlas = atlas_without_symmetry(piece.id, piece.id, system, parameters, claim, (piece,))
    kind = kind_of(atlas)
    assert kind.prove is not None
    return kind.prove(atlas, piece, (start, end), kind.limits(**argument["integrator"]), stepped)


def _system_of(argument: Mapping[str, Any]) -> ReversibleSystem:
    """The system by its name or description, or, where it is not known, as a certificate states it."""
    stated = argument.get("stated")
    if stated is None:
        return described(argument["system"])
    claim = stated["claim"]
    return systems_with(BRANCH_SYSTEMS, stated["statement"], claim)[str(claim["system"])]


_REMEDIES = {
    "process": "free memory, or give fewer `jobs`",
    "time": "give `timeout` more seconds",
    "memory": "give `memory` more",
}


def not_proved(argument: Mapping[str, Any], condition: str, message: str, seconds: float) -> Result:
    """The result of a task that was not brought to an end."""
    start, end = (parse_exact(text) for text in argument["interval"])
    computation = Computation(round(seconds, 3), **argument["integrator"])
    reason = Reason(condition, message, _REMEDIES[condition])
    return Result(str(argument["piece"]["id"]), (start, end), NOT_PROVED, computation, reason)
