"""Tables, pages and reports for scripts and notebooks, from files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.figures.scripting.written import Names, Source, Told, Written, folder_of, optional, quietly
from orbitproof.shared.formats import (
    ArgumentError,
    InputError,
    check_writable,
    read_candidates,
    stated_format,
    write_text,
)
from orbitproof.shared.systems import CR3BP, THREE_BODY

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


def write_page(
    source: Source,
    output: Source,
    *,
    family: str | None = None,
    candidates: Source | None = None,
    certificates: Source | None = None,
) -> Path:
    """Orbits in space as one HTML file, to be turned with the mouse.

    Arguments:
        source: file of families, certificate of an atlas, or tori.
        output: HTML file to write.
        family: of a file of families, which one.
        candidates, certificates: files, to show the points of a family and what is certified.

    Raises `ModuleNotFoundError` where plotly is missing.
    """
    path, target = Path(source), Path(output)
    check_writable(target)
    # Before anything is computed: it may not be installed.
    import_module("plotly")
    from orbitproof.figures.pictures.interactive import html_of

    remedy = "give families, the certificate of an atlas, or tori"
    kind = stated_format(path, remedy)
    if kind not in ("family", "atlas-certificate", "tori"):
        raise InputError(f"{path}: {remedy}")
    if kind != "family" and (family or candidates or certificates):
        raise ArgumentError("{family}, {candidates}, {certificates}: they belong to a file of families; leave them out")
    if kind == "family":
        figure = _family_in_space(path, family, optional(candidates), optional(certificates))
    else:
        figure = _tori_in_space(path) if kind == "tori" else _curve_in_space(path)
    write_text(target, html_of(figure))
    return target


def _family_in_space(path: Path, name: str | None, candidates: Path | None, certificates: Path | None) -> Any:
    from orbitproof.figures.model import assign, mark_candidates, read_families
    from orbitproof.figures.pictures.interactive import family_lines, orbits_figure

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
    from orbitproof.figures.pictures.interactive import curve_lines, orbits_figure

    curve = Curve.read(path)
    if curve.system is not CR3BP:
        raise InputError(f"{path}: orbits of {curve.system.name} are not in space; give a curve of cr3bp")
    return orbits_figure(heading_of(curve.atlas), curve_lines(curve), float(curve.parameters["mu"]))


def _tori_in_space(path: Path) -> Any:
    from orbitproof.explore.invariants import read_tori
    from orbitproof.figures.pictures.interactive import tori_figure

    return tori_figure(read_tori(path))


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
        certificates: files of certificates, of rows and of atlases.
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
