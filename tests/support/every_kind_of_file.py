"""A small file of every format, and of every kind of claim, row and piece."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from support import (
    breaking_cases,
    krein_cases,
    periodic_bifurcation_cases,
    periodic_cases,
    periodic_curves,
    torus_cases,
)
from support.joined import write_catalogue, write_indexed_web, write_web

from orbitproof.explore.__main__ import main as explore
from orbitproof.explore.branches import branch_point, follow, write_branches
from orbitproof.explore.periodic import (
    LifeRecord,
    PeriodicProblem,
    continue_orbit,
    correct,
    write_life,
    write_periodic_family,
)
from orbitproof.explore.periodic.life_file import STATUS, RestRecord
from orbitproof.explore.three_body.invariants import Plane, manifold_of, trace_tori, write_manifold, write_tori
from orbitproof.explore.three_body.masses import CurveRecord, PointRecord, write_curves
from orbitproof.explore.three_body.trajectories import SourceOrbit, trajectory_of
from orbitproof.shared.claims import BoxClaim
from orbitproof.shared.formats import read_candidates, read_claims, write_candidates
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.certificate import Limits, certify, write_certificate, write_certificates

DATA = Path(__file__).parents[1] / "data"
MASS = Fraction("1.215058560962404e-2")
HALO = [1.1380985313, -0.1661640169, -0.2240501116, 1.5452867791]
LIMITS = Limits(digits=5, max_precision=64)
STORED = {
    "atlas-falkner-skan.json": "atlas", "atlas-lyapunov.json": "atlas", "atlas-vertical.json": "atlas",
    "atlas-fixed-level.json": "atlas", "surface-light.json": "atlas", "surface-axial.json": "atlas",
    "catalogue-halo.json": "catalogue", "catalogue-halo.csv": "catalogue",
    "figures-falkner-skan-family.json": "families", "figures-halo-family.json": "families",
    "figures-certificates.json": "certificates", "earlier-certificates.json": "certificates",
}  # fmt: skip
"""Of the data of the tests, with what they hold."""


def claims_of_every_kind() -> list[BoxClaim]:
    """One claim of each kind."""
    found: dict[str, BoxClaim] = {}
    names = ("figures-candidates", "known-folds", "double-resonance", "orbit-candidates", "tori-candidates")
    made = [
        krein_cases.halo(), breaking_cases.halo(), periodic_cases.planar(Fraction(3, 2)),
        periodic_bifurcation_cases.folding(), periodic_bifurcation_cases.doubling(),
        periodic_bifurcation_cases.breaking(), torus_cases.bent_claim(),
    ]  # fmt: skip
    for claim in [*(each for name in names for each in read_claims(DATA / f"{name}.json")), *made]:
        found.setdefault(claim.kind, claim)
    return list(found.values())


def not_proved(claim: Any) -> Any:
    """A certificate of a claim whose box is so wide that it is given up at once."""
    return certify(replace(claim, radii=tuple(Fraction(100) for _ in claim.radii)), LIMITS)


def write_every_kind(folder: Path) -> dict[Path, str]:
    """The files, and what each holds: the name of a format, or "" for what is none."""
    files = {folder / name: kind for name, kind in STORED.items()}
    for path in files:
        path.write_bytes((DATA / path.name).read_bytes())

    def named(name: str, kind: str) -> Path:
        files[folder / name] = kind
        return folder / name

    for claim in claims_of_every_kind():
        write_candidates(named(f"claim-{claim.kind}.json", "candidates"), [claim])
        write_certificates(named(f"row-{claim.kind}.json", "certificates"), [not_proved(claim)])
    _write_joined(folder, files)
    _write_numeric(named)
    atlas, results = periodic_curves.closed_atlas()
    certificate = make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda entries: [], None))
    write_certificate(named("periodic-curve.json", "atlas-certificate"), certificate)
    named("periodic-atlas.json", "atlas").write_text(json.dumps(certificate["statement"]["atlas"]))
    named("system.json", "system").write_text(
        json.dumps({
            "format": "orbitproof-system", "version": 1, "name": "swing", "state": ["x", "y"],
            "field": {"x": "y", "y": "-sin(x)"},
        })
    )  # fmt: skip
    named("empty.json", "").write_text("")
    named("list.json", "").write_text("[]")
    named("picture.json", "").write_bytes(b"\x89PNG\r\n\x1a\n\x00\xff")
    return files


def _write_joined(folder: Path, files: dict[Path, str]) -> None:
    """Webs, an index and rows of a catalogue, with what they rest on."""
    for name, write, kinds in (
        ("web", write_web, ("certificates", "atlas-certificate", "web-certificate")),
        ("indexed", write_indexed_web, ("atlas-certificate", "index-certificate", "web-certificate")),
        ("rows", write_catalogue, ("atlas-certificate", "catalogue-certificate")),
    ):
        for path, kind in zip(write(folder), kinds, strict=True):
            files[path.rename(folder / f"{name}-{path.name}")] = kind
    web = {"format": "orbitproof-web", "version": 1, "id": "w", "title": "w", "arcs": [{"id": "dro"}]}
    files[folder / "web.json"] = "web"
    (folder / "web.json").write_text(json.dumps(web))


def _write_numeric(named: Any) -> None:
    """What the search writes besides claims and families."""
    halo = trajectory_of(SourceOrbit(CR3BP, {"mu": MASS}, np.array(HALO), "a halo orbit", "not proved"))
    write_tori(named("tori.json", "tori"), halo, trace_tori(halo.orbit, float(MASS), most=1), surfaces=1)
    tube = manifold_of(halo.solution, float(MASS), kind="unstable", side=-1, plane=Plane(0, 0.98785), count=2)
    write_manifold(named("manifold.json", "manifold"), halo, tube)
    x, vy = 0.835141279809, 0.119257812388
    point = PointRecord(0.01, x, vy, (x, vy), (0.0, 0.0), 1.381819167, 3.15519206858753, 0.0, 0.0)
    write_curves(named("mass-curve.json", "mass-curve"), [CurveRecord("L1", "complete", "ends", (point,))])
    problem = PeriodicProblem(periodic_cases.PLANAR, {"w": Fraction(1)})
    family = continue_orbit(problem, correct(problem, [1, 0], 6.3), "w", (0.9, 1.1))
    write_periodic_family(named("periodic-family.json", "periodic-family"), family)
    rest = RestRecord(0.0, (0.0, 0.0), 0)
    write_life(named("life.json", "life"), LifeRecord(STATUS, "planar", ("x", "y"), {}, "w", (rest, rest), (), ()))
    falkner_skan = read_candidates(DATA / "figures-candidates.json")[1]
    for name, claim in (("branches-loss.json", breaking_cases.halo()), ("branches.json", falkner_skan)):
        write_branches(named(name, "branches"), [follow(branch_point(claim), length=0.02, orbits=6).record(None, None)])
    path = named("portraits.json", "portraits")
    assert explore(["portraits", "--orbits", "2", "--iterates", "10", "--quiet", "-o", str(path)]) == 0
