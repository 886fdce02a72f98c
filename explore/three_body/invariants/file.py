"""Files of tori (orbitproof-tori) and of manifolds (orbitproof-manifold), version 1, as JSON."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.records import Array
from orbitproof.explore.three_body.invariants.curve import InvariantCurve
from orbitproof.explore.three_body.invariants.manifold import Manifold, Plane
from orbitproof.explore.three_body.invariants.torus_family import TorusFamily, frequencies, surface_of
from orbitproof.explore.three_body.trajectories import Trajectory
from orbitproof.shared.formats import InputError, read_document, validate_document, write_text
from orbitproof.shared.numbers import format_exact, parse_exact

PLACES = 201
"""Places of the periodic orbit that a file of its manifold holds."""

STATUS = "numerics in double precision, nothing is proved"


@dataclass(frozen=True)
class TorusRecord:
    """A torus in a file.

    Attributes:
        curve: the invariant curve.
        surface: shape (around, along, 3), places on the torus, or `None`: not stored.
    """

    curve: InvariantCurve
    surface: Array | None


@dataclass(frozen=True)
class ToriRecord:
    """A family of tori in a file: what they surround, in words, and the tori by amplitude.

    Attributes:
        title: of the periodic orbit.
        mass: mass parameter, rounded.
        centre: shape (4,), x, z, vx, vz of the periodic orbit on the section.
        period: of the periodic orbit.
        stability: stability parameter of the pair of multipliers from whose plane the tori come.
        reason: why the family ends.
    """

    title: str
    mass: float
    centre: Array
    period: float
    stability: float
    jacobi_constant: float
    reason: str
    tori: tuple[TorusRecord, ...]


@dataclass(frozen=True)
class ManifoldRecord:
    """A tube in a file: what it belongs to, in words, the periodic orbit's places, shape (rows, 3), and the tube."""

    title: str
    mass: float
    orbit: Array
    jacobi_constant: float
    manifold: Manifold


def _head(kind: str, trajectory: Trajectory) -> dict[str, Any]:
    source = trajectory.source
    return {
        "format": f"orbitproof-{kind}",
        "version": 1,
        "status": STATUS,
        "system": source.system.name,
        "parameters": {name: format_exact(value) for name, value in source.parameters.items()},
        "title": source.title,
        "jacobi_constant": trajectory.first_integral,
        "period": trajectory.period,
    }


def write_tori(path: Path, trajectory: Trajectory, family: TorusFamily, surfaces: int = 3) -> None:
    """Write a family of tori around an orbit, whole or not at all, with places on `surfaces` of them."""
    count = len(family.curves)
    stored = {round(place) for place in np.linspace(count - 1, 0, surfaces + 1)[:-1]}
    document = _head("tori", trajectory) | {
        "centre": family.centre.tolist(),
        "stability": family.stability,
        "reason": family.reason,
        "tori": [
            {
                "rotation": curve.rotation,
                "frequencies": list(frequencies(curve)),
                "even": curve.even.tolist(),
                "odd": curve.odd.tolist(),
                "side": curve.side,
                "times": curve.times.tolist(),
                "error": curve.error,
            }
            | ({"surface": surface_of(curve).round(12).tolist()} if index in stored else {})
            for index, curve in enumerate(family.curves)
        ],
    }
    _write(path, document, "tori")


def write_manifold(path: Path, trajectory: Trajectory, manifold: Manifold) -> None:
    """Write a tube, whole or not at all."""
    document = _head("manifold", trajectory) | {
        "kind": manifold.kind,
        "side": manifold.side,
        "multiplier": manifold.multiplier,
        "offset": manifold.offset,
        "plane": {"coordinate": "xyz"[manifold.plane.index], "value": manifold.plane.value},
        "drift": None if np.isnan(manifold.drift) else manifold.drift,
        "state": trajectory.states(np.zeros(1))[0].tolist(),
        "orbit": trajectory.states(np.linspace(0.0, trajectory.period, PLACES))[:, :3].tolist(),
        "lines": [
            {
                "start": start.tolist(),
                "end": None if np.isnan(time) else end.tolist(),
                "time": None if np.isnan(time) else float(time),
                "path": places.round(12).tolist(),
            }
            for start, end, time, places in zip(
                manifold.starts, manifold.ends, manifold.times, manifold.paths, strict=True
            )
        ],
    }
    _write(path, document, "manifold")


def _write(path: Path, document: dict[str, Any], name: str) -> None:
    validate_document(document, name, f"{name} file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def read_tori(path: Path) -> ToriRecord:
    """Read a file of tori. Raises `InputError`, one line."""
    document = read_document(path, "tori")
    mass = float(parse_exact(document["parameters"]["mu"]))
    tori = []
    for index, entry in enumerate(document["tori"]):
        where = f"{path}: field tori[{index}]"
        even, odd = _array(entry["even"], where, "even"), _array(entry["odd"], where, "odd")
        if even.shape != (2, odd.shape[1] + 1) or len(odd) != 2:
            raise InputError(f"{where}.even: needs one coefficient more than odd, two rows each; write the file again")
        curve = InvariantCurve(
            mass, document["jacobi_constant"], entry["side"], even, odd, entry["rotation"],
            _array(entry["times"], where, "times"), entry["error"],
        )  # fmt: skip
        if curve.times.shape != curve.angles.shape:
            raise InputError(f"{where}.times: needs {len(curve.angles)} numbers; write the file again")
        surface = _array(entry["surface"], where, "surface") if "surface" in entry else None
        tori.append(TorusRecord(curve, surface))
    return ToriRecord(
        document["title"], mass, np.array(document["centre"]), document["period"], document["stability"],
        document["jacobi_constant"], document["reason"], tuple(tori),
    )  # fmt: skip


def read_manifold(path: Path) -> ManifoldRecord:
    """Read a file of a manifold. Raises `InputError`, one line."""
    document = read_document(path, "manifold")
    lines = document["lines"]
    nothing = [float("nan")] * 6
    manifold = Manifold(
        kind=document["kind"],
        side=document["side"],
        multiplier=document["multiplier"],
        offset=document["offset"],
        plane=Plane("xyz".index(document["plane"]["coordinate"]), document["plane"]["value"]),
        starts=np.array([line["start"] for line in lines]),
        ends=np.array([line["end"] or nothing for line in lines]),
        times=np.array([np.nan if line["time"] is None else line["time"] for line in lines]),
        paths=_array([line["path"] for line in lines], str(path), "lines"),
        drift=np.nan if document["drift"] is None else document["drift"],
    )
    mass = float(parse_exact(document["parameters"]["mu"]))
    orbit = _array(document["orbit"], str(path), "orbit")
    return ManifoldRecord(document["title"], mass, orbit, document["jacobi_constant"], manifold)


def _array(value: Any, where: str, name: str) -> Array:
    try:
        return np.array(value, dtype=float)
    except ValueError:
        raise InputError(f"{where}.{name}: rows of different lengths; write the file again") from None
