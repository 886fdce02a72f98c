"""Certificates that rest on others, as files: a web of a curve and a point on it, a catalogue by its curve."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

from support import catalogue_cases
from support.claims import known
from support.forgeries import atlas_certificate, checked_by, fabricated, of_parabola
from support.stored import values

from orbitproof import verify
from orbitproof.shared.claims.web import PASSES, Meeting, Web, WebArc
from orbitproof.shared.formats import atlas_from_json, read_catalogue_rows
from orbitproof.verify.branches import (
    certified_index,
    certified_rows,
    certified_web,
    conclusion_of,
    make_atlas_certificate,
    resting,
)
from orbitproof.verify.certificate import (
    Certificate,
    Key,
    Limits,
    Recheck,
    certify,
    recheck,
    write_certificate,
    write_certificates,
)

DATA = Path(__file__).parents[1] / "data"


def write_web(folder: Path) -> list[Path]:
    """`rows.json` with a point, `curve.json`, and `web.json`, which says that the curve passes through it."""
    point = fabricated(certify(known("fs3"), Limits(max_precision=256)), ("2", "4e-2"), "near")
    atlas, results = of_parabola()
    curve = Certificate(json.loads(json.dumps(atlas_certificate(atlas, results))))
    claim = Web("a web", "a web", (WebArc("parabola", (Meeting("near", PASSES),)),))
    checks: dict[Key, Recheck] = {
        ("arc", "parabola"): recheck(curve),
        ("vertex", "near"): recheck(point),
    }
    paths = [folder / name for name in ("rows.json", "curve.json", "web.json")]
    write_certificates(paths[0], [point])
    verify.write(paths[1], curve)
    write_certificate(paths[2], certified_web(claim, resting(claim, [point, curve]), checks))
    return paths


@cache
def retrograde_curve(listed: bool = True) -> Certificate:
    """An arc of distant retrograde orbits, with its list or without."""
    stored = json.loads((DATA / "three-body-arcs.json").read_text())["distant-retrograde"]
    atlas, results = replace(atlas_from_json(stored["atlas"], "it"), id="dro"), values(stored["results"])
    conclusion = conclusion_of(atlas, results, (), lambda _: (), 2 if listed else None)
    return Certificate(make_atlas_certificate(atlas, results, conclusion))


@cache
def retrograde_index(listed: bool = True) -> Certificate:
    """Of the orbits of that arc."""
    return Certificate(certified_index(retrograde_curve(listed)))


@cache
def retrograde_web() -> Certificate:
    """Of that arc alone, with its index."""
    curve, index = retrograde_curve(), retrograde_index()
    check = recheck(curve)
    checks = {curve.key: check, index.key: checked_by(index.document, curve, check)}
    return Certificate(certified_web(Web("w", "a web", (WebArc("dro", index=True),)), (curve, index), checks))


def write_indexed_web(folder: Path) -> list[Path]:
    """`dro.json`, `dro-index.json`, and `web.json`, which has that index."""
    paths = [folder / name for name in ("dro.json", "dro-index.json", "web.json")]
    verify.write(paths[0], retrograde_curve())
    write_certificate(paths[1], retrograde_index().document)
    write_certificate(paths[2], retrograde_web().document)
    return paths


def write_catalogue(folder: Path) -> list[Path]:
    """`curve.json`, and `rows.json`, which says what it certifies of four rows."""
    curve, stored = catalogue_cases.curve(), catalogue_cases.STORED["catalogue"]
    given = folder / "given.json"
    data = stored["data"][: catalogue_cases.ON_THE_ARC]
    given.write_text(json.dumps({**stored, "data": data, "count": str(len(data))}))
    paths = [folder / name for name in ("curve.json", "rows.json")]
    verify.write(paths[0], curve)
    write_certificate(paths[1], certified_rows(curve, read_catalogue_rows(given)))
    given.unlink()
    return paths
