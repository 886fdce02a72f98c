"""The table of a run over an atlas, and the theorem in words or why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from orbitproof.shared.formats import as_options
from orbitproof.shared.printed_tables import fitted, wrapped
from orbitproof.verify.run.branches import AtlasRun

_HEADERS = ("piece", "kind", "verdict", "intervals", "coordinates", "steps", "time")


def piece_table(run: AtlasRun) -> str:
    """One row for each piece, "kept" if an earlier run had settled it, and what was left out for want of time."""
    rows = [_HEADERS]
    for piece in run.atlas.pieces:
        results = run.results_of(piece.id)
        proved = [result.computation for result in results if result.is_proved]
        verdict = _verdict(run, piece.id)
        coordinates = " ".join(sorted({entry.coordinates or "" for entry in proved}))
        steps = sum(entry.steps or 0 for entry in proved)
        seconds = sum(result.computation.seconds for result in results)
        rows.append(
            (
                piece.id, piece.kind.replace("_", " "), verdict, str(len(proved) or ""), coordinates, str(steps or ""),
                "kept" if piece.id in run.kept else f"{seconds:.1f} s" if results else "",
            )
        )  # fmt: skip
    total = sum(result.computation.seconds for result in run.results)
    number = sum(result.is_proved for result in run.results)
    count = sum(run.plan_of(piece.id).is_proved for piece in run.atlas.pieces)
    rows.append((f"{count} of {len(run.atlas.pieces)}", "", "proved", str(number), "", "", f"{total:.1f} s"))
    left_out = [f"{piece.id}: {left}" for piece in run.atlas.pieces if (left := run.left_out(piece.id))]
    return "\n".join([*fitted(rows), wrapped(left_out)] if left_out else fitted(rows))


def _verdict(run: AtlasRun, piece: str) -> str:
    state = run.plan_of(piece)
    return "proved" if state.is_proved else "not proved" if state.is_settled else "not finished"


def branch_as_json(run: AtlasRun, certificate: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """What a run over an atlas has proved, for programs; `certificate` is there if it came to its end."""
    pieces = [
        {
            "id": piece.id,
            "kind": piece.kind,
            "verdict": _verdict(run, piece.id),
            "intervals": sum(result.is_proved for result in run.results_of(piece.id)),
            "seconds": round(sum(result.computation.seconds for result in run.results_of(piece.id)), 1),
        }
        for piece in run.atlas.pieces
    ]
    found: dict[str, Any] = {"id": run.atlas.id, "verdict": "not finished"}
    if certificate is not None:
        found |= {name: certificate.get(name) for name in ("verdict", "reason", "conclusion", "bifurcations")}
        proved = certificate["verdict"] == "proved"
        found["theorem"] = certificate["statement"]["theorem"] if proved else None
    return found | {"pieces": pieces}


def conclusion_text(certificate: Mapping[str, Any]) -> str:
    """The theorem as the certificate proves it, or why it proves none."""
    if certificate["verdict"] == "proved":
        return f"PROVED\n\n{certificate['statement']['theorem']}"
    reason = certificate["reason"]
    return f"NOT PROVED: {reason['condition']}: {reason['message']}; {as_options(reason['remedy'])}"
