"""The report of checked certificates: a summary, every theorem, and how to check and cite it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path

from orbitproof import __version__
from orbitproof.figures.report.again import check_again, second_proofs
from orbitproof.figures.report.document import (
    Block,
    Code,
    Document,
    Items,
    Link,
    Listing,
    Paragraph,
    Picture,
    Reference,
    Runs,
    Section,
    Statement,
    Table,
)
from orbitproof.figures.report.joined import resting_paragraph, tables_of_joined
from orbitproof.figures.report.statements import (
    box_label,
    box_table,
    hypothesis_table,
    is_proved,
    kind_of,
    parameter_text,
    piece_table,
    statement_blocks,
    system_blocks,
    system_of,
)
from orbitproof.figures.report.theorems import ARC, VERTEX, Checked
from orbitproof.shared.systems import shown
from orbitproof.shared.wording import counted
from orbitproof.verify.certificate import MEANINGS, Level
from orbitproof.verify.evidence import as_said, software

TITLE = "Bifurcations and families of symmetric periodic orbits: theorems and their certificates"

_CHAPTERS = {
    "bifurcations": "Bifurcations",
    "curves": "Curves of symmetric periodic orbits",
    "surfaces": "Over ranges of a parameter",
    "indices": "The index along curves",
    "webs": "Curves joined into graphs",
    "catalogues": "Rows of catalogues",
}
"""The theorems, in this order."""

Draw = Callable[[Checked], tuple[Picture, ...]]


def report_of(entries: Sequence[Checked], draw: Draw = lambda entry: ()) -> Document:
    """The report. `draw` gives the pictures of a theorem."""
    proved = _in_order([entry for entry in entries if is_proved(entry)])
    numbers = {entry.name: number for number, entry in enumerate(proved, start=1)}
    sections = [_summary(proved, numbers)]
    systems = {
        lines: number for number, lines in enumerate(dict.fromkeys(filter(None, map(system_of, proved))), start=1)
    }
    sections += _systems(systems)
    for label, title in _CHAPTERS.items():
        if group := [entry for entry in proved if entry.chapter == label]:
            sections.append(Section(label, title, ()))
            sections += [_theorem(entry, numbers, systems, draw) for entry in group]
    sections += _not_proved([entry for entry in entries if not is_proved(entry)])
    sections += [_checked(entries), _again(entries), _software(entries)]
    if rows := _rows(proved):
        sections += _boxes(rows)
    return Document(TITLE, (*sections, _references()))


def _in_order(proved: Sequence[Checked]) -> list[Checked]:
    """By chapters, and in each as they were given."""
    return sorted(proved, key=lambda entry: list(_CHAPTERS).index(entry.chapter))


def _rows(entries: Sequence[Checked]) -> list[Checked]:
    return [entry for entry in entries if entry.part == VERTEX]


def theorem_label(name: str) -> str:
    """The label of a theorem."""
    return f"theorem-{name}"


def _summary(proved: Sequence[Checked], numbers: dict[str, int]) -> Section:
    many = counted(len(proved), "theorem") if len(proved) != 1 else "one theorem"
    blocks: list[Block] = [
        Paragraph((
            f"This report states {many}, in full: a system that several are about stands once, before them. "
            "An interval [a, b] is an enclosure: it contains the number, and its ends are rounded outward. A number "
            "written 0xMp-E is the hexadecimal integer M divided by 2 to the E, exactly. Numbers are those of the "
            "certificates, words those that follow from them; each was checked again before it was printed. What that "
            "check shows, and what it leaves to be believed, stands in ",
            Reference("checked", "What was checked"), ". Names such as ",
            Code(proved[0].name if proved else "earth-moon-L1-halo-k1-1"),
            " are labels: nothing is concluded from them.",
        )),
    ]  # fmt: skip
    rows: list[tuple[Runs, ...]] = []
    for entry in proved:
        name = entry.name
        number: Runs = (Reference(theorem_label(name), str(numbers[name])),)
        rows.append((number, (kind_of(entry),), (name,), (parameter_text(entry),), (entry.side,)))
    if rows:
        header = ("theorem", "about", "certificate", "bifurcation parameter, period, or extent", "new orbits")
        table = Table(header, tuple(rows), "The theorems", (0.1, 0.19, 0.24, 0.31, 0.08))
        blocks.append(table.without_empty_columns())
    return Section("summary", "Summary", tuple(blocks))


def _systems(systems: Mapping[tuple[str, ...], int]) -> list[Section]:
    """Each system of the theorems about boxes, once."""
    if not systems:
        return []
    each = [
        Section(f"system-{number}", f"System {number}", system_blocks(lines), level=2)
        for lines, number in systems.items()
    ]
    return [Section("systems", "Systems", ()), *each]


def _theorem(entry: Checked, numbers: Mapping[str, int], systems: Mapping[tuple[str, ...], int], draw: Draw) -> Section:
    name, number = entry.name, numbers[entry.name]
    of_system = systems.get(system_of(entry))
    system = None if of_system is None else Reference(f"system-{of_system}", f"System {of_system}")
    title = f"{kind_of(entry)}; {shown(name)}"
    statement = Statement(theorem_label(name), number, title, statement_blocks(entry, system))
    blocks: list[Block] = [statement]
    if entry.rests_on:

        def place_of(other: str) -> Reference | None:
            return Reference(theorem_label(other), f"Theorem {numbers[other]}") if other in numbers else None

        blocks.append(resting_paragraph(entry, place_of))
    if entry.certificate.hypotheses:
        blocks.append(hypothesis_table(entry))
    if entry.part == ARC:
        blocks.append(piece_table(entry))
    blocks += tables_of_joined(entry)
    return Section(f"section-{name}", f"Theorem {number}: {shown(name)}", (*blocks, *draw(entry)), level=2)


def _not_proved(entries: Sequence[Checked]) -> list[Section]:
    if not entries:
        return []
    items: list[Runs] = []
    for entry in entries:
        reason = entry.certificate.reason
        why = f"{parameter_text(entry)} are certified by the curve" if reason is None else as_said(reason)
        items.append((f"{shown(entry.name)}: {why}",))
    words = (
        "These certificates claim nothing. That something is not proved does not mean that it is false. What the runs "
        "said is quoted; nothing checks it."
    )
    return [Section("not-proved", "Not proved", (Paragraph((words,)), Items(tuple(items))))]


def _checked(entries: Sequence[Checked]) -> Section:
    rows: list[tuple[Runs, ...]] = []
    for level in (Level.FORM, Level.CONCLUSION):
        meaning = MEANINGS[level]
        rows.append(((f"{level:d} {level.name.lower()}",), (meaning.checked,), (meaning.how,), (meaning.remains,)))
    words = (
        f"Each of the {len(entries)} certificates passed these checks before the report was made. Nothing was "
        "integrated again: that the stored enclosures of derivatives and the stored proved intervals are true rests on "
        "the run that made the certificates, and the commands of the next section show it once more."
    )
    integration = MEANINGS[Level.INTEGRATION]
    last = f"A second integration then leaves to be believed: {integration.remains}."
    header = ("level", "what was checked", "how", "what remains to be believed")
    table = Table(header, tuple(rows), "The checks that every certificate passed", (0.12, 0.25, 0.25, 0.3))
    return Section("checked", "What was checked", (Paragraph((words,)), table, Paragraph((last,))))


def _again(entries: Sequence[Checked]) -> Section:
    def named(path: Path) -> str:
        return path.name

    files = list(dict.fromkeys(entry.path for entry in entries))
    lines = ["# follows from what the certificates carry", *(check_again(entries, path, named) for path in files)]
    lines += ["", "# integrated again, with other settings"]
    lines += [check_again(entries, path, named, integrate=True) for path in files]
    if second := second_proofs(entries, named):
        lines += ["", "# once more, by code that shares nothing with the first proof", *second]
    words = f"With orbitproof {__version__} installed and the certificate files at hand:"
    return Section("again", "How to check it again", (Paragraph((words,)), Listing("\n".join(lines))))


def _software(entries: Sequence[Checked]) -> Section:
    rows: list[tuple[Runs, ...]] = []
    for name, version in software().items():
        rows.append((("this report and its checks",), (name,), (Code(version),)))
    made: dict[tuple[tuple[str, str], ...], int] = {}
    for entry in entries:
        key = tuple(entry.document.get("software", {}).items())
        made[key] = made.get(key, 0) + 1
    for by, count in made.items():
        for name, version in by:
            rows.append(((f"{count} certificates, as they record",), (name,), (Code(version),)))
    digests = tuple(
        (((Reference(theorem_label(entry.name), entry.name) if is_proved(entry) else entry.name),),
         (Code(str(entry.document["digest"])),))
        for entry in entries
    )  # fmt: skip
    return Section("software", "Software and digests", (
        Table(("used for", "name", "version or digest of sources"), tuple(rows), "Software", (0.26, 0.16, 0.52)),
        Table(("certificate", "digest of its content"), digests, "Certificates", (0.34, 0.6)),
    ))  # fmt: skip


def _boxes(rows: Sequence[Checked]) -> list[Section]:
    words = "Numbers are exact: 0xMp-E is the hexadecimal integer M divided by 2 to the E, 0xMpE is M times 2 to the E."
    tables = [Section(box_label(entry), entry.name, (box_table(entry),), level=2) for entry in rows]
    return [Section("boxes", "Boxes, exactly", (Paragraph((words,)),)), *tables]


def _references() -> Section:
    text = resources.files("orbitproof.figures.report").joinpath("references.bib").read_text("utf-8")
    text = text.replace("VERSION", __version__)
    theory: Runs = (
        "The theorems are those of I. Walawska and D. Wilczak, Validated numerics for period-tupling and touch-and-go "
        "bifurcations of symmetric periodic orbits in reversible systems (",
        Link("arXiv:1903.01195", "https://arxiv.org/abs/1903.01195"),
        "), and those of the chapters of the method of orbitproof, which the sections in the tables of hypotheses "
        "belong to. Every enclosure rests on the ball arithmetic of FLINT.",
    )
    return Section("references", "References", (Paragraph(theory), Listing(text.strip())))
