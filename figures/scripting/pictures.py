"""Pictures for scripts and notebooks, from files."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from orbitproof.explore.periodic import LIFE, PERIODIC_FAMILY
from orbitproof.figures.files import Files, file_name, saved_as
from orbitproof.figures.scripting.written import Names, Source, Told, Written, folder_of, optional, quietly
from orbitproof.shared.claims import (
    HOPF,
    PERIODIC_DOUBLING,
    PERIODIC_FOLD,
    PERIODIC_PITCHFORK,
    PERIODIC_TORUS,
    HomoclinicOrbit,
)
from orbitproof.shared.formats import (
    ArgumentError,
    BoxClaim,
    InputError,
    InSection,
    read_candidates,
    read_claims,
    select_ids,
    stated_format,
    write_text,
)
from orbitproof.shared.wording import counted
from orbitproof.verify.homoclinic import HomoclinicResults
from orbitproof.verify.periodic import PeriodicResults
from orbitproof.verify.periodic_bifurcation import PeriodicBifurcationResults, TorusResults

if TYPE_CHECKING:
    from orbitproof.figures.pictures import CertifiedPoint


def draw_family(
    candidates: Source,
    folder: Source,
    *,
    certificates: Source | None = None,
    families: Sequence[Source] = (),
    files: Files | None = None,
    told: Told = quietly,
    quiet: bool = True,
) -> list[Path]:
    """Families with their bifurcations, filled where a certificate says "proved"; one picture each.

    Arguments:
        candidates: file of candidates.
        folder: for the pictures.
        certificates: file of their certificates; without it nothing is filled.
        families: files of traced families.
        files: formats, resolution and width of the pictures.
        quiet: nothing on standard error.
    """
    from orbitproof.figures.model import MarkedPoint, assign, mark_candidates, read_families

    source = Path(candidates)
    marks = mark_candidates(read_candidates(source), optional(certificates), source)
    traced = [family.refined() for path in families for family in read_families(Path(path))]

    # Matplotlib takes a second to load: only after the input is known to be good.
    from orbitproof.figures.files import save
    from orbitproof.figures.pictures import draw_family as draw
    from orbitproof.figures.pictures import draw_marks
    from orbitproof.figures.style import use_style

    target, names, written = folder_of(folder), Names(), Written(told)
    with saved_as(files), use_style():
        on_family, alone = assign(traced, marks)
        for family, members in zip(traced, on_family, strict=True):
            written.add(save(draw(family, members), target / names.new(f"family-{family.system.name}-{family.name}")))
        groups: dict[str, list[MarkedPoint]] = {}
        for mark in alone:
            groups.setdefault(mark.candidate.system.name, []).append(mark)
        for system, members in groups.items():
            if not quiet:
                print(f"{system}: on no family given with --family: {counted(len(members), 'point')}", file=sys.stderr)
            written.add(save(draw_marks(members), target / names.new(f"points-{system}")))
    return written.paths


def draw_resonances(
    families: Sequence[Source],
    folder: Source,
    *,
    candidates: Source | None = None,
    certificates: Source | None = None,
    files: Files | None = None,
    told: Told = quietly,
    quiet: bool = True,
) -> list[Path]:
    """Stability along families, finely sampled: pictures, and CSV files of the samples and of the resonances."""
    from orbitproof.explore.records import BAND
    from orbitproof.figures.model import assign, mark_candidates, read_curves

    if certificates is not None and candidates is None:
        raise ArgumentError("{certificates}: need their candidates; add {candidates}")
    curves = [curve for path in families for curve in read_curves(Path(path))]
    marks = []
    if candidates is not None:
        marks = mark_candidates(read_candidates(Path(candidates)), optional(certificates), Path(candidates))
    members, alone = assign([curve.family for curve in curves], marks)
    if alone and not quiet:
        print(f"on none of the families: {counted(len(alone), 'candidate')}", file=sys.stderr)

    from orbitproof.figures.files import save
    from orbitproof.figures.pictures import draw_resonances as draw
    from orbitproof.figures.style import use_style

    target, names, csv_names, written = folder_of(folder), Names(), Names(), Written(told)
    with saved_as(files), use_style():
        for curve, own in zip(curves, members, strict=True):
            places = curve.places(own)
            name = f"{curve.family.system.name}-{curve.family.name}"
            written.add(save(draw(curve, places), target / names.new(f"resonances-{name}")))
            for stem, text in (("stability", curve.samples_csv()), ("resonances", curve.events_csv(places))):
                path = target / f"{csv_names.new(f'{stem}-{name}')}.csv"
                write_text(path, text)
                written.add([path])
            if not quiet:
                print(f"{name}: {curve.summary(BAND)}", file=sys.stderr)
    return written.paths


def draw_atlases(
    certificates: Sequence[Source], folder: Source, *, files: Files | None = None, told: Told = quietly
) -> list[Path]:
    """Branches, from the certificates of their atlases: curves, stability along them, surfaces. Verdicts are copied."""
    from orbitproof.verify.certificate import read_certificate

    known = [read_certificate(Path(path), "atlas-certificate") for path in certificates]
    names = [file_name(certificate.atlas.id) for certificate in known]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two certificates of one atlas, {name!r}; give each atlas once")

    from orbitproof.figures.certified import CertifiedStability, Curve
    from orbitproof.figures.collection.proved import write_curves, write_stability, write_surfaces
    from orbitproof.figures.pictures import surface_of
    from orbitproof.figures.style import use_style

    target, written = folder_of(folder), Written(told)
    about_curves = [certificate for certificate in known if not certificate.atlas.is_surface]
    surfaces = [surface_of(certificate) for certificate in known if certificate.atlas.is_surface]
    listed = [CertifiedStability.of(certificate) for certificate in about_curves]
    with saved_as(files), use_style():
        written.add(write_curves([Curve.of(certificate) for certificate in about_curves], target))
        written.add(write_stability([found for found in listed if found is not None], target))
        written.add(write_surfaces(surfaces, target))
    return written.paths


def draw_web(
    web: Source,
    certificates: Sequence[Source],
    folder: Source,
    *,
    page: Source | None = None,
    files: Files | None = None,
    told: Told = quietly,
) -> list[Path]:
    """The diagram of a proved web, from its certificate and those of its arcs, with the digests that it names.

    `page`: a file for it as HTML, with the orbits of each arc.
    """
    from orbitproof.verify.certificate import read_certificate

    known = read_certificate(Path(web), "web-certificate")
    arcs = [read_certificate(Path(path), "atlas-certificate") for path in certificates]
    given = {certificate.id: certificate for certificate in arcs}
    for entry in known.document["rests_on"]:
        certificate = given.get(entry["id"])
        if entry["kind"] == "arc" and (certificate is None or certificate.document["digest"] != entry["digest"]):
            raise InputError(
                f"{web}: rests on the arc {entry['id']!r} ({entry['digest']}), which is not given; give its file"
            )

    from orbitproof.figures.certified import Curve
    from orbitproof.figures.files import save
    from orbitproof.figures.pictures import draw_web as draw
    from orbitproof.figures.style import use_style

    target, written = folder_of(folder), Written(told)
    curves = {name: Curve.of(certificate) for name, certificate in given.items() if not certificate.atlas.is_surface}
    with saved_as(files), use_style():
        written.add(save(draw(known, curves), target / f"web-{file_name(known.id)}"))
    if page is not None:
        from orbitproof.figures.pictures.web_page import page_of

        write_text(Path(page), page_of(known, curves))
        written.add([Path(page)])
    return written.paths


def draw_catalogues(
    certificates: Sequence[Source], folder: Source, *, files: Files | None = None, told: Told = quietly
) -> list[Path]:
    """The rows of catalogues that a curve certifies, from their certificates: one picture each."""
    from orbitproof.verify.certificate import read_certificate

    given = [(Path(path).stem, read_certificate(Path(path), "catalogue-certificate")) for path in certificates]

    from orbitproof.figures.files import save
    from orbitproof.figures.pictures import draw_rows
    from orbitproof.figures.style import use_style

    target, names, written = folder_of(folder), Names(), Written(told)
    with saved_as(files), use_style():
        for name, certificate in given:
            written.add(save(draw_rows(certificate), target / names.new(f"rows-{file_name(name)}")))
    return written.paths


def draw_branches(
    branches: Source,
    folder: Source,
    *,
    families: Sequence[Source] = (),
    files: Files | None = None,
    told: Told = quietly,
) -> list[Path]:
    """The new orbits of a branch file, all of a family and each by itself; orbits are numerical."""
    from orbitproof.figures.pictures.branches import write

    written = Written(told)
    with saved_as(files):
        written.add(write(Path(branches), [Path(path) for path in families], folder_of(folder)))
    return written.paths


def draw_tori(
    sources: Sequence[Source], folder: Source, *, files: Files | None = None, told: Told = quietly
) -> list[Path]:
    """Tori and manifolds, from files of `orbitproof explore`, in space and on the section; they are numerical."""
    from orbitproof.explore.three_body.invariants import read_manifold, read_tori
    from orbitproof.figures.files import save
    from orbitproof.figures.pictures import draw_manifold
    from orbitproof.figures.pictures import draw_tori as draw
    from orbitproof.figures.style import use_style

    remedy = "give a file of tori or of a manifold, written by orbitproof explore"
    paths, drawings = [Path(source) for source in sources], []
    for path in paths:
        is_manifold = stated_format(path, remedy) == "manifold"
        drawings.append((draw_manifold, read_manifold(path)) if is_manifold else (draw, read_tori(path)))
    names = [file_name(path.stem) for path in paths]
    if len(set(names)) < len(names):
        raise InputError("two files of one name; give files whose names differ")
    target, written = folder_of(folder), Written(told)
    with saved_as(files), use_style():
        for name, (shown, record) in zip(names, drawings, strict=True):
            written.add(save(shown(record), target / name))
    return written.paths


@dataclass(frozen=True)
class Drawn:
    """What became of all pictures.

    Attributes:
        paths: the files.
        not_drawn: why, by the name of the picture.
        bad_input: whether one of these reasons is a file that is not what it should be.
        hollow: whether there were no certificates, so that nothing is filled.
    """

    paths: tuple[Path, ...]
    not_drawn: Mapping[str, str]
    bad_input: bool
    hollow: bool


def draw_periodic(
    sources: Sequence[Source], folder: Source, *, files: Files | None = None, told: Told = quietly
) -> Drawn:
    """Periodic orbits without symmetry, their bifurcations, homoclinic orbits, families, whole lives.

    On a whole life what the certificates prove is filled, and they are not drawn by themselves.

    Verdicts are copied. What is born at a bifurcation is numerical; where it is not found, the orbit is drawn alone and
    `Drawn.not_drawn` says why.
    """
    from orbitproof.explore.periodic import LifeRecord, PeriodicFamilyRecord, read_life, read_periodic_family
    from orbitproof.figures.files import save
    from orbitproof.figures.orbits import OrbitNotClosed
    from orbitproof.figures.pictures import (
        draw_connection,
        draw_life,
        draw_periodic_bifurcation,
        draw_periodic_family,
        draw_periodic_orbit,
    )
    from orbitproof.figures.style import use_style

    remedy = "give candidates, certificates, or a family or a whole life of orbitproof explore"
    drawings: list[tuple[str, PeriodicFamilyRecord | LifeRecord | _Claimed]] = []
    has_life = any(stated_format(path, remedy) == LIFE for path in map(Path, sources))
    certified: list[CertifiedPoint] = []
    for path in map(Path, sources):
        kind = stated_format(path, remedy)
        if kind == PERIODIC_FAMILY:
            drawings.append((f"family-{file_name(path.stem)}", read_periodic_family(path)))
        elif kind == LIFE:
            drawings.append((f"life-{file_name(path.stem)}", read_life(path)))
        elif has_life and kind == "certificates":
            certified += _points(path)
        else:
            found = _certified(path) if kind == "certificates" else _numerical(path)
            if not found:
                what = "claims about periodic orbits without symmetry, their bifurcations or homoclinic orbits"
                raise InputError(f"{path}: holds no {what}; {remedy}")
            drawings += [(f"{_stem(each.claim)}-{file_name(each.claim.id)}", each) for each in found]
    target, names, written, not_drawn = folder_of(folder), Names(), Written(told), dict[str, str]()
    with saved_as(files), use_style():
        for name, drawing in drawings:
            try:
                if isinstance(drawing, PeriodicFamilyRecord):
                    figure = draw_periodic_family(drawing)
                elif isinstance(drawing, LifeRecord):
                    figure = draw_life(drawing, certified)
                elif isinstance(drawing.claim, HomoclinicOrbit):
                    figure = draw_connection(drawing.claim, certified=drawing.found is not None)
                elif not drawing.claim.is_of_orbit:
                    drawn = draw_periodic_bifurcation(drawing.claim, drawing.found)
                    figure = drawn.figure
                    if not drawn.is_complete:
                        not_drawn[name] = f"what is born there: {drawn.beside}"
                else:
                    point = None if drawing.found is None else drawing.found.point
                    figure = draw_periodic_orbit(drawing.claim, point)
            except OrbitNotClosed as error:
                not_drawn[name] = str(error)
                continue
            written.add(save(figure, target / names.new(name)))
    return Drawn(tuple(written.paths), not_drawn, False, False)


@dataclass(frozen=True)
class _Claimed:
    """A claim, with what its certificate has found if it says "proved"."""

    claim: InSection | HomoclinicOrbit
    found: PeriodicResults | PeriodicBifurcationResults | TorusResults | HomoclinicResults | None = None


_POINTS = {
    HOPF: "Hopf",
    PERIODIC_FOLD: "fold",
    PERIODIC_DOUBLING: "period doubling",
    PERIODIC_PITCHFORK: "pitchfork",
    PERIODIC_TORUS: "Neimark-Sacker",
}


def _points(path: Path) -> list[CertifiedPoint]:
    """What the certificates of a file prove to happen at values of a parameter."""
    from orbitproof.figures.pictures import CertifiedPoint
    from orbitproof.verify.certificate import read_certificates

    found = []
    for entry in read_certificates(path).values():
        claim = entry.candidate
        name = getattr(claim, "parameter", None)
        what = _POINTS.get(claim.kind)
        if entry.proved and what is not None and isinstance(name, str):
            found.append(CertifiedPoint(claim.system.name, what, name, float(claim.parameters[name])))
    return found


def _is_drawn(claim: BoxClaim) -> bool:
    """Whether it is about a periodic orbit without symmetry, a bifurcation of one, or a homoclinic orbit."""
    from orbitproof.verify.certificate.kinds import kind_of

    return kind_of(claim).picture in ("periodic orbit", "bifurcation", "connection")


def _stem(claim: InSection | HomoclinicOrbit) -> str:
    if isinstance(claim, HomoclinicOrbit):
        return "homoclinic"
    return "orbit" if claim.is_of_orbit else "bifurcation"


def _numerical(path: Path) -> list[_Claimed]:
    return [_Claimed(claim) for claim in read_claims(path) if _is_drawn(claim)]


def _certified(path: Path) -> list[_Claimed]:
    from orbitproof.verify.certificate import read_certificates

    claimed = []
    for entry in read_certificates(path).values():
        if _is_drawn(entry.candidate):
            claimed.append(_Claimed(entry.candidate, entry.results))
    return claimed


def draw_all(
    data: Source,
    folder: Source,
    *,
    only: Sequence[str] | None = None,
    files: Files | None = None,
    told: Told = quietly,
    quiet: bool = True,
) -> Drawn:
    """Every picture, from a folder of data files (docs/figures.md); those whose data are missing are left out.

    Arguments:
        data: folder of data files, as ``orbitproof figures data`` makes them.
        only: names of pictures, with * and ?; by default all.
        quiet: nothing on standard error but what is not drawn.
    """
    from orbitproof.figures.collection import PICTURES, DataFolder, MissingData
    from orbitproof.figures.orbits import OrbitNotClosed

    known = {picture.name: picture for picture in PICTURES}
    chosen = [known[name] for name in select_ids(known, None if only is None else list(only), "picture")]
    source, target = DataFolder(Path(data)), folder_of(folder)
    written, not_drawn, bad_input = Written(told), dict[str, str](), False
    started = time.monotonic()
    with saved_as(files):
        for number, picture in enumerate(chosen, 1):
            before = time.monotonic()
            try:
                # First of all, so that one missing file is not found only after the drawing of half a picture.
                for name in picture.data:
                    source.path(name)
                written.add(picture.write(source, target))
            except (MissingData, OrbitNotClosed) as error:
                not_drawn[picture.name] = str(error)
            except InputError as error:
                not_drawn[picture.name], bad_input = f"error: {error}", True
            if picture.name in not_drawn:
                print(f"{picture.name}: not drawn: {not_drawn[picture.name]}", file=sys.stderr)
            if not quiet:
                now = time.monotonic()
                left = (now - started) / number * (len(chosen) - number)
                estimate = f"; about {left:.0f} s left" if number < len(chosen) else ""
                print(f"[{number}/{len(chosen)}] {picture.name}: {now - before:.1f} s{estimate}", file=sys.stderr)
    hollow = any(picture.marked for picture in chosen) and not source.has_certificates
    return Drawn(tuple(written.paths), not_drawn, bad_input, hollow)
