"""Tables, pages and reports for scripts and notebooks, from files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.figures.files import Files, saved_as
from orbitproof.figures.scripting.written import Names, Source, Told, Written, folder_of, optional, quietly
from orbitproof.shared.formats import (
    ArgumentError,
    InputError,
    check_writable,
    read_candidates,
    stated_format,
    write_text,
)
from orbitproof.shared.systems import THREE_BODY

if TYPE_CHECKING:
    from orbitproof.figures.tables import Table


def tables_of(
    certificates: Sequence[Source], *, candidates: Sequence[Source] = (), published: Source | None = None
) -> list[Table]:
    """The certified rows beside published enclosures, by families. Verdicts are copied.

    Arguments:
        certificates, candidates: files; the candidates give names of families, and the order along them.
        published: file of published enclosures; by default the paper's.
    """
    from orbitproof.figures.tables import build_tables, default_published, read_published, read_rows

    known = read_published(Path(published) if published is not None else default_published())
    paths = [Path(path) for path in certificates]
    rows = read_rows(paths, [Path(path) for path in candidates])
    if not rows:
        named = ", ".join(map(str, paths))
        raise InputError(f"{named}: no bifurcations, which tables are of; orbitproof report tells certified orbits")
    return build_tables(rows, known)


def write_tables(tables: Sequence[Table], folder: Source, *, digits: int = 30, told: Told = quietly) -> list[Path]:
    """Each table as text, Markdown, CSV and LaTeX, with at most so many significant digits."""
    from orbitproof.figures.tables import to_csv, to_latex, to_markdown, to_text

    target, names, written = folder_of(folder), Names(), Written(told)
    for table in tables:
        stem = names.new(f"table-{table.system.name}-{table.family}")
        for suffix, write in ((".txt", to_text), (".md", to_markdown), (".csv", to_csv), (".tex", to_latex)):
            path = target / f"{stem}{suffix}"
            write_text(path, write(table, digits))
            written.add([path])
    return written.paths


_PAGES = (
    "give families, candidates, certificates, branches, a catalogue, a curve, tori, a manifold, or their certificates"
)


def draw_distances(
    families: Sequence[Source], folder: Source, *, files: Files | None = None, told: Told = quietly
) -> list[Path]:
    """How near to the smaller primary the orbits of families of the CR3BP come, and which hit it; one picture each."""
    from orbitproof.figures.files import save
    from orbitproof.figures.model import read_families
    from orbitproof.figures.pictures.distances import draw_distances as draw
    from orbitproof.figures.style import use_style

    known = [(Path(path), family) for path in families for family in read_families(Path(path))]
    for path, family in known:
        if family.system not in THREE_BODY:
            raise InputError(f"{path}: {family.name} is a family of {family.system.name}; give families of cr3bp")
    target, names, written = folder_of(folder), Names(), Written(told)
    with saved_as(files), use_style():
        for _, family in known:
            written.add(save(draw(family), target / names.new(f"distances-{family.name}")))
    return written.paths


def write_page(
    source: Source,
    output: Source,
    *,
    family: str | None = None,
    identifier: str | None = None,
    orbit: int | None = None,
    candidates: Source | None = None,
    certificates: Source | None = None,
) -> Path:
    """Orbits in space as one HTML file, to be turned with the mouse.

    Arguments:
        source: file of families or a catalogue, certificate of an atlas, tori, a manifold; or, for one orbit, any file
            that names orbits.
        output: HTML file to write.
        family: of a file of families, which one.
        identifier, orbit: one orbit of the file, by its id or its number.
        candidates, certificates: files, to show the points of a family and what is certified.

    Raises `ModuleNotFoundError` where plotly is missing.
    """
    path, target = Path(source), Path(output)
    check_writable(target)
    # Before anything is computed: it may not be installed.
    import_module("plotly")
    from orbitproof.figures.pictures.interactive import html_of

    kind = stated_format(path, _PAGES)
    single = identifier is not None or orbit is not None
    whole = {
        "atlas-certificate": _curve_in_space,
        "tori": _tori_in_space,
        "manifold": _tube_in_space,
        "": _rows_in_space,
    }
    if (candidates or certificates) and (kind != "family" or single):
        raise ArgumentError("{candidates}, {certificates}: they belong to a file of families; leave them out")
    if family and kind not in ("family", "mass-curve"):
        raise ArgumentError("{family}: {0} holds no families; leave it out", path)
    if kind == "family" and not single:
        figure = _family_in_space(path, family, optional(candidates), optional(certificates))
    elif kind in whole and not single:
        figure = whole[kind](path)
    else:
        figure = _orbit_in_space(path, identifier, family, orbit)
    write_text(target, html_of(figure))
    return target


def _family_in_space(path: Path, name: str | None, candidates: Path | None, certificates: Path | None) -> Any:
    from orbitproof.figures.model import assign, mark_candidates, read_families
    from orbitproof.figures.pictures.interactive import orbits_figure
    from orbitproof.figures.pictures.lines import family_lines

    if certificates is not None and candidates is None:
        raise ArgumentError("{certificates}: need their candidates; add {candidates}")
    families = [family for family in read_families(path) if family.system in THREE_BODY]
    fits = [family for family in families if name in (None, family.name)]
    if len(fits) != 1:
        if not families:
            known = " or ".join(each.name for each in THREE_BODY)
            raise InputError(f"{path}: has no family of {known}; draw others with orbitproof figures family")
        said = "missing" if name is None else f"no {name!r} in {path}"
        raise ArgumentError("{family}: {0}; give one of {1}", said, ", ".join(family.name for family in families))
    marks = []
    if candidates is not None:
        marks = mark_candidates(read_candidates(candidates), certificates, candidates)
    (own,), _ = assign(fits, marks)
    return orbits_figure(fits[0].name, family_lines(fits[0], own), float(fits[0].parameters["mu"]))


def _curve_in_space(path: Path) -> Any:
    from orbitproof.figures.certified import Curve, heading_of
    from orbitproof.figures.pictures.interactive import orbits_figure
    from orbitproof.figures.pictures.lines import curve_lines

    curve = Curve.read(path)
    if curve.system not in THREE_BODY:
        raise InputError(f"{path}: orbits of {curve.system.name} are not in space; give a curve of cr3bp")
    return orbits_figure(heading_of(curve.atlas), curve_lines(curve), float(curve.parameters["mu"]))


def _tori_in_space(path: Path) -> Any:
    from orbitproof.explore.three_body.invariants import read_tori
    from orbitproof.figures.pictures.interactive import tori_figure

    return tori_figure(read_tori(path))


def _tube_in_space(path: Path) -> Any:
    from orbitproof.explore.three_body.invariants import read_manifold
    from orbitproof.figures.pictures.interactive import tube_figure

    return tube_figure(read_manifold(path))


def _rows_in_space(path: Path) -> Any:
    from orbitproof.explore.three_body.catalogues import read_catalogue
    from orbitproof.figures.pictures.interactive import orbits_figure
    from orbitproof.figures.pictures.lines import catalogue_lines

    catalogue = read_catalogue(path)
    title = f"{catalogue.system} {catalogue.title}".strip()
    return orbits_figure(title, catalogue_lines(catalogue), float(catalogue.mass_ratio))


def _orbit_in_space(path: Path, identifier: str | None, family: str | None, number: int | None) -> Any:
    from orbitproof.explore.names import NoOrbit
    from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of
    from orbitproof.figures.pictures.interactive import orbits_figure
    from orbitproof.figures.pictures.lines import orbit_line

    try:
        trajectory = trajectory_of(find_orbit(path, Choice(identifier, family, number)))
    except NoOrbit as failure:
        raise InputError(f"{path}: {failure}; give another orbit") from None
    source = trajectory.source
    if source.system not in THREE_BODY:
        raise InputError(f"{path}: orbits of {source.system.name} are not in space; give one of cr3bp")
    return orbits_figure(source.title, [orbit_line(trajectory)], float(source.parameters["mu"]))


@dataclass(frozen=True)
class Report:
    """A report that was written.

    Attributes:
        paths: its files, those of pictures included.
        proved, told: how many of its certificates prove something, and how many there are.
    """

    paths: tuple[Path, ...]
    proved: int
    told: int


def write_report(
    certificates: Sequence[Source],
    outputs: Source | Sequence[Source],
    *,
    only: Sequence[str] | None = None,
    pictures: bool = True,
    timeout: float | None = None,
    memory: float | None = None,
    told: Told = quietly,
    quiet: bool = False,
) -> Report:
    """Every theorem as a statement that stands alone, with its hypotheses, margins and pictures.

    Every certificate is checked up to its conclusion first; nothing is written if one does not stand.

    Arguments:
        certificates: files of certificates of all kinds; of a web, and of a catalogue's rows, with those they rest on.
        outputs: .html, .tex or .md, one or several.
        only: ids, with * and ? as in file names; by default all.
        pictures: whether they are drawn.
        timeout, memory: seconds and GiB for each check.
        quiet: no progress on standard error.

    Raises `Refused`, with what was found, if a certificate does not stand.
    """
    from orbitproof.figures.report.content import report_of
    from orbitproof.figures.report.statements import is_proved
    from orbitproof.figures.report.theorems import check_files
    from orbitproof.figures.report.writers import format_of
    from orbitproof.figures.report.writers import write_report as write
    from orbitproof.verify.run import GIBIBYTE, CheckLimits, Display

    targets = [Path(output) for output in ([outputs] if isinstance(outputs, (str, Path)) else outputs)]
    for output in targets:
        format_of(output)
        check_writable(output)
    bytes_ = CheckLimits.memory if memory is None else int(memory * GIBIBYTE)
    names = None if only is None else list(only)
    entries = check_files([Path(path) for path in certificates], names, quiet, timeout, bytes_)
    proved = [entry for entry in entries if is_proved(entry)]
    drawn = {}
    if pictures:
        from orbitproof.figures.report.pictures import pictures_of

        display = Display({entry.name: 1.0 for entry in proved}, quiet)
        with display.shown():
            for entry in proved:
                drawn[entry.name] = pictures_of(entry)
                display.finish(entry.name, "drawn" if drawn[entry.name] else "has no picture")
    report, written = report_of(entries, lambda entry: drawn.get(entry.name, ())), Written(told)
    for output in targets:
        written.add(write(output, report))
    return Report(tuple(written.paths), len(proved), len(entries))
