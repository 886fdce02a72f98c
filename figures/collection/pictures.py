"""All pictures by name: what each shows, which data it needs, and how it is drawn from a data folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from orbitproof.figures.certified import Curve
from orbitproof.figures.collection.data_folder import DataFolder
from orbitproof.figures.collection.proved import write_curves
from orbitproof.figures.files import save
from orbitproof.figures.pictures import (
    draw_bifurcation,
    draw_closed_curves,
    draw_crossings,
    draw_gallery,
    draw_geometry,
    draw_mass_curves,
    draw_portraits,
    draw_resonances,
    draw_resonant_families,
    draw_resonant_orbits,
    draw_torus,
    read_mass_curves,
)
from orbitproof.figures.pictures.branches import write as write_branches
from orbitproof.figures.pictures.certified_boxes import write as write_certified_branches
from orbitproof.figures.style import use_style
from orbitproof.shared.systems import FALKNER_SKAN

Drawn = Iterator[tuple[str, Figure]]


@dataclass(frozen=True)
class Picture:
    """One or several figures of the same kind.

    Attributes:
        name: what it is asked for by.
        shows: in a few words.
        data: names of the files of the data folder that it needs.
        write: draws from the data folder into another folder and yields the paths written. Raises `MissingData`,
            `OrbitNotClosed` or `InputError`.
        marked: whether it marks points, filled where certificates.json says so.
    """

    name: str
    shows: str
    data: tuple[str, ...]
    write: Callable[[DataFolder, Path], Iterator[Path]]
    marked: bool = False


def _saved(draw: Callable[[DataFolder], Drawn]) -> Callable[[DataFolder, Path], Iterator[Path]]:
    """The `write` of a function that yields the stems of the files and the figures."""

    def write(data: DataFolder, folder: Path) -> Iterator[Path]:
        with use_style():
            for stem, figure in draw(data):
                yield from save(figure, folder / stem)

    return write


def _portraits(data: DataFolder) -> Drawn:
    from orbitproof.explore.portraits import read_portraits

    yield "phase-portraits", draw_portraits(read_portraits(data.path("portraits.json")))


def _geometry(data: DataFolder) -> Drawn:
    yield "bifurcation-geometry", draw_geometry()


def _falkner_skan_family(data: DataFolder) -> Drawn:
    family = data.family("falkner-skan.json", "odd").refined()
    yield "falkner-skan-family", draw_crossings(family, data.marks_on(family)[0])


def _falkner_skan_orbits(data: DataFolder) -> Drawn:
    family = data.family("falkner-skan.json", "odd").refined()
    marks = [mark for mark in data.marks_on(family)[0] if mark.candidate.system is FALKNER_SKAN and mark.k in (2, 3, 4)]
    yield "falkner-skan-orbits", draw_resonant_orbits(marks)


def _lyapunov_and_halo(data: DataFolder) -> Drawn:
    lyapunov = data.family("lyapunov.json", "L1-lyapunov", "sun-jupiter")
    yield "lyapunov-and-halo-orbits", draw_bifurcation(lyapunov, data.family("families.json", "L1-halo", "sun-jupiter"))


def _symmetry_breaking(data: DataFolder) -> Drawn:
    yield "symmetry-breaking-curves", draw_mass_curves(read_mass_curves(data.path("mass-curve.json")))


def _closed_curves(data: DataFolder) -> Drawn:
    families = [data.family("families.json", "L1-halo", mass).refined() for mass in ("earth-moon", "sun-jupiter")]
    yield "closed-halo-curves", draw_closed_curves(families, data.marks_on(*families))


def _torus(data: DataFolder) -> Drawn:
    yield "halo-torus", draw_torus(data.family("families.json", "L1-halo", "sun-jupiter"))


def _resonant_families(data: DataFolder) -> Drawn:
    files = {"L1": "families.json", "L2": "families.json", "L3": "l3-halo.json"}
    halos = {name: data.family(file, f"{name}-halo", "earth-moon").refined() for name, file in files.items()}
    marks = dict(zip(halos, data.marks_on(*halos.values()), strict=True))
    yield "resonant-halo-families", draw_resonant_families(halos, marks)


def _stability(data: DataFolder) -> Drawn:
    curves = data.curves("families.json") + data.curves("falkner-skan.json")
    for curve, marks in zip(curves, data.marks_on(*(curve.family for curve in curves)), strict=True):
        yield (
            f"stability-{curve.family.system.name}-{curve.family.name}",
            draw_resonances(curve, curve.places(marks)),
        )


def _galleries(data: DataFolder) -> Drawn:
    for family in [*data.families("families.json"), *data.families("l3-halo.json")]:
        yield f"gallery-{family.name}", draw_gallery(family)


def _branches(data: DataFolder, folder: Path) -> Iterator[Path]:
    families = [data.path("families.json"), data.path("falkner-skan.json")]
    yield from write_branches(data.path("branches.json"), families, folder / "branches")


def _certified_branches(data: DataFolder, folder: Path) -> Iterator[Path]:
    branches = [data.path("branches.json")]
    yield from write_certified_branches(data.path("certificates.json"), branches, folder / "certified-branches")


def _proved_branches(*names: str) -> Callable[[DataFolder, Path], Iterator[Path]]:
    """The `write` of the pictures of certificates of atlases."""

    def write(data: DataFolder, folder: Path) -> Iterator[Path]:
        curves = [Curve.read(data.path(name)) for name in names]
        with use_style():
            yield from write_curves(curves, folder)

    return write


_LOOPS = ("branch-l1-circle-earth-moon.json", "branch-l1-circle-sun-jupiter.json")
_ARCS = ("branch-l2-arc-earth-moon.json", "branch-l2-arc-sun-jupiter.json")
_FALKNER_SKAN = ("branch-falkner-skan.json",)

PICTURES: tuple[Picture, ...] = (
    Picture(
        "phase-portraits",
        "a reversible planar map before, at and after its 1:4 and 1:3 resonances",
        ("portraits.json",),
        _saved(_portraits),
    ),
    Picture(
        "bifurcation-geometry",
        "the curves of the definitions of period tupling and touch-and-go, from normal forms",
        (),
        _saved(_geometry),
    ),
    Picture(
        "falkner-skan-family",
        "the Falkner-Skan family: both crossings of Fix(R), and the period",
        ("falkner-skan.json", "candidates.json"),
        _saved(_falkner_skan_family),
        marked=True,
    ),
    Picture(
        "falkner-skan-orbits",
        "the Falkner-Skan orbits in 1:2, 1:3 and 1:4 resonance",
        ("falkner-skan.json", "candidates.json"),
        _saved(_falkner_skan_orbits),
        marked=True,
    ),
    Picture(
        "lyapunov-and-halo-orbits",
        "Sun-Jupiter: planar Lyapunov orbits around L1 and the halo orbits that branch off",
        ("lyapunov.json", "families.json"),
        _saved(_lyapunov_and_halo),
    ),
    Picture(
        "symmetry-breaking-curves",
        "where S breaks on the Lyapunov families of L1, L2, L3, against the mass",
        ("mass-curve.json",),
        _saved(_symmetry_breaking),
    ),
    Picture(
        "closed-halo-curves",
        "the closed curves of L1 halo orbits on Fix(R), for both masses",
        ("families.json", "candidates.json"),
        _saved(_closed_curves),
        marked=True,
    ),
    Picture(
        "halo-torus",
        "Sun-Jupiter: the torus that the L1 halo orbits sweep out",
        ("families.json",),
        _saved(_torus),
    ),
    Picture(
        "resonant-halo-families",
        "Earth-Moon: the L1, L2, L3 halo families with their resonances",
        ("families.json", "l3-halo.json", "candidates.json"),
        _saved(_resonant_families),
        marked=True,
    ),
    Picture(
        "stability",
        "stability parameters along each family, with the resonances",
        ("families.json", "falkner-skan.json", "candidates.json"),
        _saved(_stability),
        marked=True,
    ),
    Picture(
        "branches",
        "the new orbits at each bifurcation: where they branch off, their points on Fix(R), in space",
        ("branches.json", "families.json", "falkner-skan.json"),
        _branches,
        marked=True,
    ),
    Picture(
        "certified-branches",
        "both curves of each certified point in the box of its certificate",
        ("certificates.json", "branches.json"),
        _certified_branches,
    ),
    Picture(
        "gallery",
        "orbits along each halo family, with Jacobi constant and period",
        ("families.json", "l3-halo.json"),
        _saved(_galleries),
    ),
    Picture(
        "proved-loops",
        "the L1 loops of halo orbits, both masses, from their certificates: pieces, curves",
        _LOOPS,
        _proved_branches(*_LOOPS),
    ),
    Picture(
        "proved-arcs",
        "the L2 arcs of halo orbits, both masses, from their certificates: pieces, curves",
        _ARCS,
        _proved_branches(*_ARCS),
    ),
    Picture(
        "proved-falkner-skan",
        "the Falkner-Skan family, from its certificate: pieces, curve",
        _FALKNER_SKAN,
        _proved_branches(*_FALKNER_SKAN),
    ),
)
"""In the order of the paper, then those that it does not have."""
