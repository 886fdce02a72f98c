"""Certificates of atlases checked again: from what they carry, or by another integration.

The first level integrates nothing: the conclusion is evaluated again from the stored results, and compared. The second
one proves every stored interval again, at another precision and order, and concludes from that. It is what finds a
certificate in which pieces or results were changed together with the digest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from orbitproof.verify.atlas.certificate import AtlasCertificate, Result
from orbitproof.verify.atlas.splitting import covers, interval_of
from orbitproof.verify.atlas.task import RunLimits, result_of, task_of
from orbitproof.verify.curve import PieceLimits
from orbitproof.verify.engines import Answer, Display, Engine, Task, Work
from orbitproof.verify.evidence import ball_from_json
from orbitproof.verify.surface import SurfaceLimits

_MORE_BITS = 32
_MORE_ORDER = 4
_NOT_COMPARED = ("ends", "statement", "bifurcations")
"""What depends on the bifurcations that are asked about."""

Conclusion = Mapping[str, Any]


def differences(stored: AtlasCertificate, again: Conclusion, with_bifurcations: bool) -> list[str]:
    """What the stored conclusion says otherwise than `again`, which was made of the stored results.

    `with_bifurcations`: whether `again` is about the same bifurcations.
    """
    document = stored.document
    before = document["conclusion"]
    if before is None:
        return ["the run was not finished, so there is no conclusion; run the same command again"]
    same = [key for key in again if with_bifurcations or key not in _NOT_COMPARED]
    found = [f"{key}: differs from what the results give" for key in same if before.get(key) != again[key]]
    if document["verdict"] != again["verdict"]:
        found.append(f"verdict: stored is {document['verdict']!r}, the results give {again['verdict']!r}")
    if document["statement"].get("theorem", "") != before["statement"]:
        found.append("theorem: is not the statement of the conclusion")
    return found


def proved_again(
    stored: AtlasCertificate, engine: Engine, display: Display, work: Work, timeout: float | None
) -> tuple[list[Result], list[str]]:
    """The proved intervals, proved once more with other settings; and for which of them that failed."""
    atlas = stored.atlas
    pieces = {piece.id: piece for piece in atlas.pieces}
    names = asdict(SurfaceLimits() if atlas.is_surface else PieceLimits())
    waiting: list[Task] = []
    before: dict[tuple[str, tuple[str, ...]], Result] = {}
    for result in proved_of(stored):
        settings = {name: int(result["computation"].get(name, value)) for name, value in names.items()}
        settings = {
            **settings,
            "precision": settings["precision"] + _MORE_BITS,
            "order": settings["order"] + _MORE_ORDER,
        }
        steps = int(result["computation"].get("steps", 1))
        limits = RunLimits({}, timeout)
        task = task_of(atlas, pieces[result["piece"]], interval_of(result), settings, limits, max(1, steps))
        before[result["piece"], tuple(task.argument["interval"])] = result
        waiting.append(task)
    results: list[Result] = []
    findings: list[str] = []

    def source() -> Task | None:
        return waiting.pop(0) if waiting else None

    def finished(answer: Answer) -> None:
        fresh = result_of(answer)
        asked = answer.task.argument["interval"]
        where = f"piece {fresh['piece']}, s in [{', '.join(asked)}]"
        if fresh["verdict"] != "proved":
            findings.append(f"{where}: is not proved again: {fresh['reason']['message']}")
        else:
            results.append(fresh)
            findings.extend(f"{where}: {text}" for text in _contradictions(before[fresh["piece"], tuple(asked)], fresh))
        display.finish(name_of(fresh["piece"], asked), f"{fresh['verdict']} again")

    def progress(name: str, fraction: float, label: str) -> None:
        """Which interval of the piece it is does not matter to the estimate."""

    engine.run(work, source, progress, finished)
    return results, findings


def proved_of(stored: AtlasCertificate) -> Sequence[Result]:
    """The results that say "proved"."""
    return [result for result in stored.results if result["verdict"] == "proved"]


def name_of(piece: str, interval: Sequence[str]) -> str:
    """What progress calls an interval."""
    return f"{piece} [{', '.join(interval)}]"


def _contradictions(stored: Result, fresh: Result) -> list[str]:
    found = []
    if not covers([interval_of(fresh)], interval_of(stored)):
        found.append("is proved on less than that")
    if "time" in stored and "time" in fresh:
        old, new = (ball_from_json(result["time"]) for result in (stored, fresh))
        if old.overlaps(new) is not True:
            found.append("the half periods have no common point")
    return found
