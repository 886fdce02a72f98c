"""The pictures that certificates alone are enough for: boxes with their curves, proved curves, surfaces."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

from orbitproof.figures.certified import CertifiedCurves, Curve
from orbitproof.figures.files import file_name
from orbitproof.figures.orbits import OrbitNotClosed
from orbitproof.figures.pictures import (
    draw_connection,
    draw_curves,
    draw_double_resonance,
    draw_orbit,
    draw_periodic_bifurcation,
    draw_periodic_orbit,
    draw_pieces,
    draw_reversor_breaking,
    draw_rows,
    draw_section,
    draw_surface,
    draw_web,
    surface_of,
)
from orbitproof.figures.pictures.certified_boxes import draw_certified
from orbitproof.figures.report.document import Picture
from orbitproof.figures.report.theorems import ARC, VERTEX, Checked
from orbitproof.figures.style import close, use_style
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate.kinds import CATALOGUE, WEB, box_kind

_PNG_DPI = 130
_FROM_POLYNOMIALS = "drawn from the polynomials of the pieces, from which the true curve is not further than the tube"


def pictures_of(entry: Checked) -> tuple[Picture, ...]:
    """The pictures of a proved theorem."""
    with use_style():
        drawn = _DRAWN.get(entry.part)
        return () if drawn is None else drawn(entry)


def _of_web(entry: Checked) -> tuple[Picture, ...]:
    """The pictures of a web; none if its system is not the three-body problem."""
    curves = [Curve.of(each.certificate) for each in entry.rests_on if each.part == ARC]
    try:
        figure = draw_web(entry.certificate, {curve.atlas.id: curve for curve in curves})
    except InputError:
        return ()
    caption = f"{shown(entry.name)}: level against x where orbits start; the arcs are {_FROM_POLYNOMIALS}"
    return (_picture(f"web-{file_name(entry.name)}", caption, figure),)


def _of_catalogue(entry: Checked) -> tuple[Picture, ...]:
    caption = (
        f"{shown(entry.name)}: (a) the rows, filled where an orbit of the curve is certified to start near one; "
        "(b) certified bounds of how far the numbers of that orbit are from those of the row"
    )
    return (_picture(f"rows-{file_name(entry.name)}", caption, draw_rows(entry.certificate)),)


def _of_row(entry: Checked) -> tuple[Picture, ...]:
    """The picture of a row that its kind names."""
    drawn = _BY_NAME.get(box_kind(entry.certificate.kind).picture)
    return () if drawn is None else drawn(entry)


def _of_orbit(entry: Checked) -> tuple[Picture, ...]:
    name = entry.certificate.id
    caption = (
        f"{shown(name)}: the orbit, integrated in double precision from the middle of its enclosures; the marked "
        "points and times are enclosed by the certificate, far closer than can be seen"
    )
    figure = draw_orbit(entry.candidate, entry.certificate.results)
    return (_picture(f"orbit-{file_name(name)}", caption, figure),)


def _of_stable_orbit(entry: Checked) -> tuple[Picture, ...]:
    return (*_of_orbit(entry), *_section_of(entry))


def _of_birth(entry: Checked) -> tuple[Picture, ...]:
    name = entry.certificate.id
    caption = (
        f"{shown(name)}: (a) the parameter of the new orbits to leading order, between the ends of the enclosure "
        "of kappa, and the symmetric orbits; how far from the point this holds is not said; (b) the orbit at which "
        "R is lost, integrated in double precision from the middle of its enclosures"
    )
    figure = draw_reversor_breaking(entry.candidate, entry.certificate.results)
    return (_picture(f"birth-{file_name(name)}", caption, figure),)


def _of_meeting(entry: Checked) -> tuple[Picture, ...]:
    name = entry.certificate.id
    caption = (
        f"{shown(name)}: (a) the stability parameter along the families of three values of the parameter, and (b) "
        "where it is that of the resonance, to leading order from the middle of the enclosed coefficients; how far "
        "from the point this holds is not said"
    )
    figure = draw_double_resonance(entry.candidate, entry.certificate.results)
    return (_picture(f"meeting-{file_name(name)}", caption, figure),)


def _of_box(entry: Checked) -> tuple[Picture, ...]:
    name = entry.certificate.id
    figure = draw_certified(CertifiedCurves.of(entry.certificate.to_json(), f"certificate {name!r}"), None)
    fold = entry.candidate.is_fold
    curves, along = ("the family", "it") if fold else ("the family and the branch", "the branch")
    caption = (
        f"{shown(name)}: (a) {curves} in the box of the certificate, enclosed; (b) the parameter along {along} from "
        "the enclosed coefficient of the normal form, within the box (thick) and, not proved, continued"
    )
    return (_picture(f"box-{file_name(name)}", caption, figure),)


def _section_of(entry: Checked) -> tuple[Picture, ...]:
    """The return map about an orbit; none where orbits near it cannot be followed."""
    try:
        figure = draw_section(entry.candidate, entry.certificate.results)
    except OrbitNotClosed:
        return ()
    name = entry.certificate.id
    caption = (
        f"{shown(name)}: orbits of the return map near it on the section, on its level or at its parameter, iterated "
        "in double precision; the certificate encloses the point in the middle, and proves that there are closed "
        "invariant curves in every neighbourhood of it, not that those of the picture are such"
    )
    return (_picture(f"section-{file_name(name)}", caption, figure),)


def _of_periodic(entry: Checked) -> tuple[Picture, ...]:
    """An orbit without symmetry; none of one that is too unstable to be drawn in double precision."""
    name = entry.certificate.id
    try:
        figure = draw_periodic_orbit(entry.candidate, entry.certificate.results.point)
    except OrbitNotClosed:
        return ()
    caption = (
        f"{shown(name)}: the orbit, integrated in double precision from the middle of its enclosures; the certificate "
        "encloses the filled point, far closer than can be seen"
    )
    return (_picture(f"orbit-{file_name(name)}", caption, figure),)


def _of_connection(entry: Checked) -> tuple[Picture, ...]:
    """A homoclinic orbit; none where it is not found again in double precision."""
    name = entry.certificate.id
    try:
        figure = draw_connection(entry.candidate, certified=True)
    except OrbitNotClosed:
        return ()
    caption = (
        f"{shown(name)}: (a) the homoclinic orbit and its periodic orbit, integrated in double precision; (b) the box "
        "about the periodic orbit, with the cone that contains the unstable manifold, and the sliver that is followed; "
        "(c) unstable and stable manifold in the section, numerical. The certificate encloses the filled point, far "
        "closer than can be seen, and proves that the manifolds cross there"
    )
    return (_picture(f"homoclinic-{file_name(name)}", caption, figure),)


def _of_periodic_bifurcation(entry: Checked) -> tuple[Picture, ...]:
    """The picture of the orbit; none if it is too unstable to be drawn in double precision."""
    name = entry.certificate.id
    try:
        drawn = draw_periodic_bifurcation(entry.candidate, entry.certificate.results)
    except OrbitNotClosed:
        return ()
    caption = (
        f"{shown(name)}: the orbit at the bifurcation, integrated in double precision from the middle of its "
        "enclosures; the certificate encloses the filled point, far closer than can be seen. "
    )
    caption += f"Numerical, and not proved: {drawn.beside}" if drawn.is_complete else f"Nothing else: {drawn.beside}"
    return (_picture(f"bifurcation-{file_name(name)}", caption, drawn.figure),)


def _of_atlas(entry: Checked) -> tuple[Picture, ...]:
    certificate, atlas = entry.certificate, entry.certificate.atlas
    stem = file_name(atlas.id)
    if atlas.is_surface:
        caption = (
            f"{shown(atlas.id)}: how far the proved orbits reach over the parameter, and where the symmetry breaks"
        )
        return (_picture(f"surface-{stem}", caption, draw_surface(surface_of(certificate))),)
    curve = Curve.of(certificate)
    return (
        _picture(f"curve-{stem}", f"{shown(atlas.id)}: the curve, {_FROM_POLYNOMIALS}", draw_curves([curve])),
        _picture(
            f"pieces-{stem}",
            f"{shown(atlas.id)}: the pieces, their tubes, and the proved distance from the polynomials; the "
            "coordinates in which orbits were followed are as the certificate records them",
            draw_pieces(curve),
        ),
    )


_BY_NAME = {
    "box": _of_box,
    "birth": _of_birth,
    "meeting": _of_meeting,
    "orbit": _of_orbit,
    "stable orbit": _of_stable_orbit,
    "periodic orbit": _of_periodic,
    "bifurcation": _of_periodic_bifurcation,
    "connection": _of_connection,
}
"""Pictures of claims about boxes, as `BoxKind.picture` names them."""

_DRAWN = {VERTEX: _of_row, ARC: _of_atlas, WEB: _of_web, CATALOGUE: _of_catalogue}
"""By what a certificate can be for others; there is no picture of an index."""


def _picture(name: str, caption: str, figure: Figure) -> Picture:
    content = {}
    for suffix in ("png", "pdf"):
        buffer = io.BytesIO()
        metadata = {"CreationDate": None} if suffix == "pdf" else {"Software": None}
        figure.savefig(buffer, format=suffix, metadata=metadata, **({"dpi": _PNG_DPI} if suffix == "png" else {}))
        content[suffix] = buffer.getvalue()
    close(figure)
    return Picture(name, caption, content["png"], content["pdf"])
