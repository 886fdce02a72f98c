"""A document written as HTML, LaTeX or Markdown: one template each, and what escaping and formulas need there."""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from orbitproof.figures.files import check_folder
from orbitproof.figures.report.document import Code, Document, Link, Math, Picture, Reference, Run, Runs
from orbitproof.figures.report.formulas import to_mathml
from orbitproof.shared.formats import InputError, write_bytes, write_text

_LONG = 24
_CHUNK = 8


@dataclass(frozen=True)
class Format:
    """How a format writes text.

    Attributes:
        template: its file in templates/.
        run: a piece of text in a line.
        filters: what the template uses beside that.
        picture: suffix of the pictures that lie beside the file; empty where they are embedded.
    """

    template: str
    run: Callable[[Run], str]
    filters: Mapping[str, Callable[..., Any]]
    picture: str = ""


def write_report(path: Path, document: Document) -> list[Path]:
    """Write a report in the format that its suffix says, and its pictures; returns the paths, the report last.

    HTML carries its pictures. Those of LaTeX and Markdown go into a folder beside the report, named after it. Raises
    `InputError` for another suffix, and where nothing can be written.
    """
    style = format_of(path)
    folder = path.with_name(f"{path.stem}-pictures")
    pictures = list(document.pictures()) if style.picture else []
    written = []
    if pictures:
        check_folder(folder)
        for picture in pictures:
            target = folder / f"{picture.name}{style.picture}"
            write_bytes(target, picture.png if style.picture == ".png" else picture.pdf)
            written.append(target)
    write_text(path, text_of(document, style, folder.name))
    return [*written, path]


def format_of(path: Path) -> Format:
    """The format of a path. Raises `InputError`."""
    found = FORMATS.get(path.suffix)
    if found is None:
        raise InputError(f"-o {path}: the suffix says which format is written; give {', '.join(FORMATS)}")
    return found


def text_of(document: Document, style: Format, folder: str) -> str:
    """The document as text; `folder` is where its pictures lie."""
    environment = Environment(
        loader=PackageLoader("orbitproof.figures.report"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
        autoescape=False,
    )

    def runs(value: Runs | str) -> str:
        return style.run(value) if isinstance(value, str) else "".join(style.run(each) for each in value)

    environment.filters.update(style.filters)
    environment.filters["runs"] = runs
    environment.filters["kind"] = lambda block: type(block).__name__
    return environment.get_template(style.template).render(document=document, folder=folder) + "\n"


def _html(run: Run) -> str:
    match run:
        case Math():
            return to_mathml(run.latex)
        case Code():
            return f"<code>{escape(run.text)}</code>"
        case Link():
            return f'<a href="{escape(run.target)}">{escape(run.text)}</a>'
        case Reference():
            return f'<a href="#{anchor(run.label)}">{escape(run.text)}</a>'
    return str(escape(run))


def anchor(label: str) -> str:
    """A label as every format takes it."""
    return re.sub(r"[^A-Za-z0-9-]+", "-", label)


def _data_uri(picture: Picture) -> str:
    return f"data:image/png;base64,{b64encode(picture.png).decode('ascii')}"


def _display(latex: str) -> Markup:
    return Markup(to_mathml(latex, "block"))


_TEX_CHARACTERS = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\textless{}", ">": r"\textgreater{}",
    "|": r"\textbar{}", "[": "{[}", "]": "{]}", '"': r"\textquotedbl{}", "'": r"\textquotesingle{}",
}  # fmt: skip


_MANY_DIGITS = re.compile(r"[0-9]{20,}")


def _tex_text(text: str) -> str:
    escaped = "".join(_TEX_CHARACTERS.get(character, character) for character in text)
    return _MANY_DIGITS.sub(lambda found: r"\allowbreak{}".join(_chunks(found[0])), escaped)


def _chunks(text: str) -> list[str]:
    return [text[i : i + _CHUNK] for i in range(0, len(text), _CHUNK)]


def _tex_code(text: str) -> str:
    """Typewriter; long words may be broken anywhere."""
    chunks = _chunks(text) if len(text) > _LONG else [text]
    return r"\texttt{" + r"\allowbreak{}".join(_tex_text(chunk) for chunk in chunks) + "}"


def _tex(run: Run) -> str:
    match run:
        case Math():
            return f"${run.latex}$"
        case Code():
            return _tex_code(run.text)
        case Link():
            return rf"\href{{{run.target}}}{{{_tex_text(run.text)}}}"
        case Reference():
            return rf"\hyperref[{anchor(run.label)}]{{{_tex_text(run.text)}}}"
    return _tex_text(run)


def _markdown(run: Run) -> str:
    match run:
        case Math():
            return f"${run.latex}$"
        case Code():
            return f"`{run.text}`"
        case Link():
            return f"[{_markdown_text(run.text)}]({run.target})"
        case Reference():
            return f"[{_markdown_text(run.text)}](#{anchor(run.label)})"
    return _markdown_text(run)


def _markdown_text(text: str) -> str:
    """Text in which nothing is markup; vertical bars would end a cell of a table."""
    return re.sub(r"([\\`*_{}\[\]<>#|$~])", r"\\\1", text)


FORMATS: Mapping[str, Format] = {
    ".html": Format("report.html", _html, {"display": _display, "uri": _data_uri, "anchor": anchor}),
    ".tex": Format("report.tex", _tex, {"anchor": anchor}, ".pdf"),
    ".md": Format("report.md", _markdown, {"anchor": anchor}, ".png"),
}
"""By suffix."""
