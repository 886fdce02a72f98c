"""The chapters of the method as a reader meets them: what they define, what is cited, and what does not fit together.

Chapters are docs/method.md, the cover, and the README.md files of shared/ and verify/. The second proof shares nothing
with the method, not even its numbers: its chapter is a book of its own. Every check returns what it finds wrong, as
lines of text that name the file.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

NUMBER = r"\d{1,2}(?:\.\d{1,2})?"
_LIST = rf"{NUMBER}(?:(?:,? and |,? or | to |, |,\n){NUMBER}(?!\.?\d))*"
_SECTIONS = re.compile(rf"\b[Ss]ections? ({_LIST})")
_BRACKETS = re.compile(r"\((\d{1,2}\.\d(?:(?:,? and | to |, )\d{1,2}\.\d)*)\)")
_RESULTS = re.compile(rf"\b(?:Lemma|Proposition|Theorem)s? ({_LIST})")
_FOREIGN = re.compile(r"\[WW[^\]]*\]|https?://\S+|`[^`\n]*`")
_SECTION_HEADING = re.compile(rf"^(?:#{{2,3}} (?={NUMBER}\.? \S)|\*\*(?=\d+\.\d))({NUMBER})", re.MULTILINE)
"""A heading, or a paragraph that begins with its number in bold."""
_RESULT_HEADING = re.compile(rf"^\*\*(Lemma|Proposition|Theorem) ({NUMBER})(?: \([^)]*\))?\.\*\*", re.MULTILINE)
_FORMULA = re.compile(r"^.*\\qquad \((\d{1,2}\.\d)\)(?: \\\\)?$", re.MULTILINE)
_ARGUMENT = re.compile(r'(?<=[(,\s=])"([1-9]\d?\.\d{1,2})"(?=[,)])')
"""The section of a hypothesis, as it is handed to the checklist."""
_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
_COVER_ROW = re.compile(r"^\| [^|]+ \| \[[^\]]+\]\(\.\./([^)]+)/README\.md\) \| ([^|]*)\|", re.MULTILINE)
_BROKEN_LINE = re.compile(r"^(?!  |[-|#>]|\d+\. ).+\n((?:[-+*>] |\d+[.)] |=+$|-+$).*)", re.MULTILINE)
"""A line of a paragraph that Markdown takes for something else."""
_INLINE = re.compile(r"\$([^$]+)\$")
_UNMARKED = re.compile(r"(?<![\w.\-/])[A-Za-z]{1,2}_[\w{(]|\w\^[\w({-]")
_ROOMS = ("shared", "verify")
MARKDOWN = MarkdownIt("commonmark").enable("table")


@dataclass(frozen=True)
class Citation:
    """A number that some text cites, and where."""

    kind: str
    number: str
    path: Path


def chapters(root: Path) -> dict[Path, str]:
    """Text of each chapter by path; the cover comes first."""
    paths = [root / "docs" / "method.md", *sorted(p for room in _ROOMS for p in (root / room).rglob("README.md"))]
    return {path: path.read_text("utf-8") for path in paths}


def is_apart(path: Path) -> bool:
    """Whether a file belongs to the second proof, which has numbers of its own."""
    return "second_proof" in path.parts


def _book(root: Path, apart: bool) -> list[str]:
    return [text for path, text in chapters(root).items() if is_apart(path.relative_to(root)) == apart]


def _documents(root: Path) -> list[Path]:
    return [root / "README.md", *sorted((root / "docs").glob("*.md")), *list(chapters(root))[1:]]


def sections(root: Path, apart: bool = False) -> Counter[str]:
    """How often each section is there."""
    return Counter(number for text in _book(root, apart) for number in _SECTION_HEADING.findall(_prose(text)))


def results(root: Path, apart: bool = False) -> Counter[str]:
    """How often each number of a lemma, proposition or theorem is given."""
    found = (match for text in _book(root, apart) for match in _RESULT_HEADING.finditer(text))
    return Counter(match[2] for match in found)


def formulas(root: Path, apart: bool = False) -> Counter[str]:
    """How often each number of a formula is given."""
    return Counter(number for text in _book(root, apart) for number in _FORMULA.findall(text))


def citations(root: Path) -> Iterator[Citation]:
    """Everything that code, certificates and documents cite."""
    for path in _documents(root):
        yield from _in_text(path.read_text("utf-8"), path, brackets=path in chapters(root))
    for folder in ("shared", "verify", "explore", "figures"):
        for path in sorted((root / folder).rglob("*.py")):
            source = path.read_text("utf-8")
            yield from _in_text(source, path, brackets=False)
            if folder == "verify":
                yield from (Citation("section", number, path) for number in _ARGUMENT.findall(source))
    for path in (*(root / "shared" / "schemas").glob("*.json"), *(root / "tests" / "data").glob("*.json")):
        for section in _values(json.loads(path.read_text("utf-8")), "section"):
            if re.fullmatch(NUMBER, section):
                yield Citation("section", section, path)


def _numbered(root: Path, apart: bool) -> dict[str, Counter[str]]:
    there, given = sections(root, apart), formulas(root, apart)
    return {"section": there, "result": results(root, apart), "formula": given, "section or formula": there + given}


def wrong_citations(root: Path) -> list[str]:
    """Citations of what is not there."""
    known = {apart: _numbered(root, apart) for apart in (False, True)}
    missing = {
        f"{c.path.relative_to(root)}: {c.kind} {c.number} is not there"
        for c in citations(root)
        if not known[is_apart(c.path.relative_to(root))][c.kind][c.number]
    }
    return sorted(missing)


def repeated_numbers(root: Path) -> list[str]:
    """Numbers that are given twice in one book."""
    counts = (_numbered(root, apart)[kind] for apart in (False, True) for kind in ("section", "result", "formula"))
    return [f"{number} is there {n} times" for count in counts for number, n in count.items() if n > 1]


def unnamed_modules(root: Path) -> list[str]:
    """Modules that their chapter does not name, and modules in its table that are not there."""
    found = []
    for room in [root / "shared" / "systems", *sorted(path.parent for path in (root / "verify").glob("*/__init__.py"))]:
        chapter = room / "README.md"
        if not chapter.exists():
            found.append(f"{room.relative_to(root)}: there is no README.md")
            continue
        table = re.search(r"^\| module \|.*\n(?:\|.*\n)*", chapter.read_text("utf-8"), re.MULTILINE)
        rows = re.findall(r"^\| ([^|]*)\|", table[0], re.MULTILINE) if table else []
        named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
        modules = {path.stem for path in room.glob("*.py") if not path.stem.startswith("__")}
        found += [f"{chapter.relative_to(root)}: the table does not name `{name}`" for name in sorted(modules - named)]
        found += [f"{chapter.relative_to(root)}: there is no module `{name}`" for name in sorted(named - modules)]
    return found


def wrong_module_names(root: Path) -> list[str]:
    """Names in headings "(`module`, ..)", and dotted names like `flow.step`, that lead to no module."""
    found = []
    for path, text in chapters(root).items():
        for heading in re.findall(r"^#{2,3} \d.*\(((?:`[\w.]+`(?:, )?)+)\)$", text, re.MULTILINE):
            for name in re.findall(r"`([\w.]+)`", heading):
                if not _is_module(root, path.parent, name):
                    found.append(f"{path.relative_to(root)}: heading names `{name}`")
        rooms = "|".join(sorted(p.name for p in (root / "verify").iterdir() if p.is_dir()))
        for name in re.findall(rf"`((?:shared\.|explore\.)[\w.]+|(?:{rooms})\.(?!py|md)[\w.]+)`", text):
            if not _is_module(root, path.parent, name):
                found.append(f"{path.relative_to(root)}: `{name}` is not there")
    return found


def unknown_names(root: Path) -> list[str]:
    """Names in the chapters, `like_this`, that occur nowhere in the code."""
    code = "\n".join(path.read_text("utf-8") for room in _ROOMS for path in sorted((root / room).rglob("*.py")))
    known = set(re.findall(r"\w+", code)) | {path.stem for room in _ROOMS for path in (root / room).rglob("*")}
    found = []
    for path, text in chapters(root).items():
        names = {name.removesuffix("_j") for name in re.findall(r"`([a-z][a-z_0-9]{2,})`", text)}
        found += [f"{path.relative_to(root)}: `{name}` is nowhere in the code" for name in sorted(names - known)]
    return found


def roundabout_citations(root: Path) -> list[str]:
    """In the rooms whose chapters these are, "section 8.4" is all it takes; docs/method.md is only the way to it."""
    paths = [path for room in _ROOMS for path in sorted((root / room).rglob("*.py"))]
    found = [path for path in paths if re.search(r"method\.md, +[Ss]ections? \d", path.read_text("utf-8"))]
    return [f"{path.relative_to(root)}: cites a section of docs/method.md" for path in found]


def lost_paths(root: Path) -> list[str]:
    """Files and folders of the project that documents name and that are not there."""
    found = set()
    for path in _documents(root):
        for name in re.findall(r"`((?:explore|verify|figures|shared|tests)/[\w./-]*)`", path.read_text("utf-8")):
            if not (root / name).exists():
                found.add(f"{path.relative_to(root)}: `{name}` is not there")
    return sorted(found)


def wrong_cover(root: Path) -> list[str]:
    """Rows of the cover's table whose folder or sections are not those of the chapter."""
    (cover, text), *rest = ((p, text) for p, text in chapters(root).items() if not is_apart(p.relative_to(root)))
    rows = {root / folder / "README.md": set(_numbers(listed.strip())) for folder, listed in _COVER_ROW.findall(text)}
    found = [f"{cover.name}: no row for {path.relative_to(root)}" for path, _ in rest if path not in rows]
    for path, listed in rows.items():
        there = set(_SECTION_HEADING.findall(path.read_text("utf-8"))) if path.exists() else set()
        if there != listed:
            found.append(f"{cover.name}: {path.relative_to(root)} has sections {sorted(there ^ listed)} or has not")
    return found


def wrong_order(root: Path) -> list[str]:
    """Rooms of verify/ that the cover lists in another order than the one in which they may import each other."""
    contracts = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    (layers,) = (entry["layers"] for entry in contracts if entry.get("containers") == ["orbitproof.verify"])
    order = {name: place for place, layer in enumerate(reversed(layers)) for name in re.findall(r"\w+", layer)}
    text = (root / "docs" / "method.md").read_text("utf-8")
    listed = [Path(folder).name for folder, _ in _COVER_ROW.findall(text) if folder.startswith("verify/")]
    return [f"the cover lists {b} after {a}" for a, b in pairwise(listed) if order.get(b, -1) < order.get(a, -1)]


def broken_links(root: Path) -> list[str]:
    """Local links that lead nowhere."""
    found = []
    for path in _documents(root):
        for target in _LINK.findall(path.read_text("utf-8")):
            if not re.match(r"[a-z]+:|#", target) and not (path.parent / target.split("#")[0]).exists():
                found.append(f"{path.relative_to(root)}: link to {target}")
    return sorted(set(found))


def ill_formed(root: Path) -> list[str]:
    """Headings that skip a level or stand in another section, tables with uneven rows, results without proof."""
    found = []
    for path, text in chapters(root).items():
        name = path.relative_to(root)
        if text.count("\n```") % 2:
            found.append(f"{name}: a code block is not closed")
        prose = _prose(text)
        levels = [len(marks) for marks in re.findall(r"^(#+) ", prose, re.MULTILINE)]
        if levels[:1] != [1] or any(b > a + 1 or b == 1 for a, b in pairwise(levels)):
            found.append(f"{name}: headings skip a level")
        numbered = re.findall(r"^#+ \d.*", prose, re.MULTILINE)
        found += [f"{name}: not a section heading: {line}" for line in numbered if not _SECTION_HEADING.match(line)]
        for table in re.findall(r"(?:^\|.*\n)+", prose, re.MULTILINE):
            cells = {len(re.findall(r"(?<!\\)\|", line)) for line in table.splitlines()}
            if len(cells) > 1:
                found.append(f"{name}: a table has rows of different lengths: {table.splitlines()[0]}")
        found += [f"{name}: {problem}" for problem in _unproved(prose)]
        found += [f"{name}: read as a list or a heading: {line}" for line in _BROKEN_LINE.findall(prose)]
        found += [f"{name}: unbalanced ** in: {block[:60]}" for block in prose.split("\n\n") if block.count("**") % 2]
    return found


def _unproved(prose: str) -> Iterator[str]:
    marks = list(re.finditer(r"^\*\*(?:Lemma|Proposition|Theorem) [\d.]+|^#+ |\*Proof\b|\bQED\b", prose, re.MULTILINE))
    claimed, open_ = "", False
    for mark in marks:
        word = mark[0]
        if word == "QED":
            if not open_:
                yield f"QED without a proof before: {prose[max(0, mark.start() - 40) : mark.end()]!r}"
            claimed, open_ = "", False
        elif word.startswith("*Proof"):
            if open_:
                yield f"a proof begins before QED of the one before: {prose[mark.start() : mark.start() + 60]!r}"
            open_ = True
        else:
            if open_:
                yield f"no QED before {word!r}"
            if claimed:
                yield f"{claimed} has no proof"
            claimed, open_ = (word.strip("*#. ") if word.startswith("**") else ""), False
    if claimed or open_:
        yield f"{claimed or 'the last proof'} does not end"


def garbled_mathematics(root: Path) -> list[str]:
    """Formulas between $ that Markdown changes, and letters with indices or exponents outside of formulas and code."""
    made = root / "docs" / "theorems", root / "docs" / "site"
    pages = [root / "README.md", *(page for page in (root / "docs").rglob("*.md") if page.parent not in made)]
    return [
        f"{page.relative_to(root)}: {problem}"
        for page in [*sorted(pages), *list(chapters(root))[1:]]
        for problem in _garbled(page.read_text("utf-8"))
    ]


def _garbled(text: str) -> Iterator[str]:
    tokens = MARKDOWN.parse(text)
    for before, token in zip([None, *tokens], tokens, strict=False):
        if token.type != "inline" or (before is not None and before.type == "heading_open"):
            continue
        shown = "".join(_shown(child) for child in token.children or ())
        written = _without_code(token)
        if written.count("$") % 2:
            yield f"a $ without another: {written[:60]!r}"
        for found in _INLINE.finditer(written):
            if found[1] not in shown:
                yield f"Markdown changes {found[0]}"
            if re.match(r"\w", written[found.end() :]) or re.search(r"\w\Z", written[: found.start()]):
                yield f"a letter beside {found[0]}, which is not set then"
        yield from (f"not marked as a formula: {found[0]!r}" for found in _UNMARKED.finditer(_INLINE.sub("", shown)))


def _without_code(token: Token) -> str:
    return re.sub(r"(`+).+?\1", "", token.content, flags=re.DOTALL)


def _shown(token: Token) -> str:
    """What Markdown without mathematics makes of a piece of a paragraph; code, and what sets emphasis, is left out."""
    if token.type == "softbreak":
        return "\n"
    return token.content if token.type in ("text", "html_inline") else "\0"


def mathematics(text: str) -> tuple[list[str], list[str]]:
    """The formulas of a document: between $ in its paragraphs, and fenced."""
    tokens = MARKDOWN.parse(text)
    paragraphs = (_without_code(token) for token in tokens if token.type == "inline")
    inline = [formula for paragraph in paragraphs for formula in _INLINE.findall(paragraph)]
    return inline, [token.content for token in tokens if token.type == "fence" and token.info == "math"]


def _prose(text: str) -> str:
    return re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)


def _numbers(listed: str) -> Iterator[str]:
    """The numbers of a list such as "3, 3.1 to 3.3 and 4"; ranges are filled in."""
    parts = re.split(rf"({NUMBER})", listed)
    numbers, joints = parts[1::2], [joint.strip(" ,\n") for joint in parts[2::2]]
    for index, number in enumerate(numbers):
        if index and joints[index - 1] == "to" and ("." in number) == ("." in numbers[index - 1]):
            head, _, last = number.rpartition(".")
            first = numbers[index - 1].rpartition(".")[2]
            for between in range(int(first) + 1, int(last)):
                yield f"{head}.{between}" if head else str(between)
        yield number


def _in_text(text: str, path: Path, brackets: bool) -> Iterator[Citation]:
    text = re.sub(r"\s*\n\s*(?:#\s+)?", " ", _FOREIGN.sub("", text))
    for pattern, kind in ((_SECTIONS, "section"), (_RESULTS, "result")):
        for listed in pattern.findall(text):
            yield from (Citation(kind, number, path) for number in _numbers(listed))
    if brackets:
        for listed in _BRACKETS.findall(text):
            yield from (Citation("section or formula", number, path) for number in _numbers(listed))


def _values(document: object, key: str) -> Iterator[str]:
    if isinstance(document, dict):
        if isinstance(document.get(key), str):
            yield document[key]
        for value in document.values():
            yield from _values(value, key)
    elif isinstance(document, list):
        for value in document:
            yield from _values(value, key)


def _is_module(root: Path, folder: Path, name: str) -> bool:
    """Whether a dotted name is a module, or a name that a module defines, seen from a chapter's folder."""
    parts = name.split(".")
    if len(parts) == 1 and any(
        re.search(rf"^(?:def|class) {name}\b", path.read_text("utf-8"), re.MULTILINE) for path in folder.glob("*.py")
    ):
        return True
    for start in (folder, root / "verify", root / "shared", root):
        for length in range(len(parts), 0, -1):
            path = start.joinpath(*parts[:length])
            places = (path.with_suffix(".py"), path / "__init__.pyi", path / "__init__.py")
            module = next((place for place in places if place.exists()), places[-1])
            if module.exists():
                rest = parts[length:]
                if not rest or (len(rest) == 1 and re.search(rf"\b{rest[0]}\b", module.read_text("utf-8"))):
                    return True
    return False


CHECKS = (
    wrong_citations,
    repeated_numbers,
    unnamed_modules,
    wrong_module_names,
    unknown_names,
    roundabout_citations,
    lost_paths,
    wrong_cover,
    wrong_order,
    broken_links,
    ill_formed,
    garbled_mathematics,
)
"""All checks; each takes the root of the project and returns what it finds wrong."""
