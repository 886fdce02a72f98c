"""Pages made from the code: every command from its own --help, every format from its schema, systems as formulas."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module, resources
from typing import Any
from unittest.mock import patch

from orbitproof.__main__ import _COMMANDS as COMMANDS
from orbitproof.figures.report.formulas import to_latex
from orbitproof.shared.systems import BRANCH_SYSTEMS
from orbitproof.verify.words.formulas import setting

_WORDS = (
    ["explore"], ["verify"], ["verify", "atlas"], ["verify", "web"], ["verify", "catalogue"], ["verify", "index"],
    ["verify", "--second-proof"], ["verify", "--formal"], ["figures"], ["report"], ["doctor"],
)  # fmt: skip
"""The command lines that have a parser of their own."""


class _Found(Exception):
    def __init__(self, parser: argparse.ArgumentParser) -> None:
        self.parser = parser


def parsers() -> Iterator[argparse.ArgumentParser]:
    """The parser of every command, in order, each followed by those of its subcommands."""
    for words in _WORDS:
        parser = _parser_of(words)
        yield parser
        for action in parser._actions:
            if isinstance(action, argparse._SubParsersAction):
                yield from dict.fromkeys(action.choices.values())


def _parser_of(words: Sequence[str]) -> argparse.ArgumentParser:
    def stop(parser: argparse.ArgumentParser, *_: Any, **__: Any) -> None:
        raise _Found(parser)

    main = import_module(f"orbitproof.{COMMANDS[words[0]][0]}").main
    with patch.object(argparse.ArgumentParser, "parse_args", stop), suppress(SystemExit):
        try:
            main(list(words[1:]))
        except _Found as found:
            return found.parser
    raise ValueError(f"orbitproof {' '.join(words)}: has no parser")


def commands_page() -> str:
    """What every command says of itself."""
    parts = ["# Commands\n", "What `orbitproof COMMAND --help` prints.\n"]
    with patch.dict("os.environ", {"COLUMNS": "92"}):
        parts += [f"## {parser.prog}\n\n````text\n{parser.format_help().strip()}\n````\n" for parser in parsers()]
    return "\n".join(parts)


def formats_page() -> str:
    """Every field of every format, with what its schema says of it."""
    parts = ["# Fields of all formats\n", "From the schemas in `shared/schemas/`; what they are for: "
             "[formats](../docs/formats.md).\n"]  # fmt: skip
    folder = resources.files("orbitproof.shared").joinpath("schemas")
    for path in sorted(folder.iterdir(), key=lambda entry: entry.name):
        schema = json.loads(path.read_text("utf-8"))
        parts += [f"## {path.name.removesuffix('.schema.json')}\n", f"{schema.get('description', '')}\n",
                  "| field | type | meaning |", "| --- | --- | --- |"]  # fmt: skip
        parts += [f"| `{place}` | {kind} | {_cell(meaning)} |" for place, kind, meaning in _fields(schema, schema, "")]
        parts.append("")
    return "\n".join(parts)


def _fields(schema: Mapping[str, Any], whole: Mapping[str, Any], place: str) -> Iterator[tuple[str, str, str]]:
    """Place, type and description of the fields below a schema."""
    for name, inner in schema.get("properties", {}).items():
        inner = _resolved(inner, whole)
        where = f"{place}.{name}" if place else name
        yield where, _type(inner), inner.get("description", "")
        yield from _fields(inner, whole, where)
    items = schema.get("items")
    if isinstance(items, Mapping):
        yield from _fields(_resolved(items, whole), whole, f"{place}[]")


def _resolved(schema: Mapping[str, Any], whole: Mapping[str, Any]) -> Mapping[str, Any]:
    """The definition that a schema refers to, with the description that stands beside the reference."""
    reference = schema.get("$ref")
    if reference is None or not reference.startswith("#/$defs/"):
        return schema
    rest = {key: value for key, value in schema.items() if key != "$ref"}
    return {**whole["$defs"][reference.removeprefix("#/$defs/")], **rest}


def _type(schema: Mapping[str, Any]) -> str:
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    kind = schema.get("type", "")
    return " or ".join(kind) if isinstance(kind, list) else str(kind)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def systems_page() -> str:
    """The equations of every system, from the programs that proofs use."""
    parts = ["# Systems as formulas\n", "Printed from the straight-line programs that every proof uses. R reverses the "
             "flow, P is the Poincare map.\n"]  # fmt: skip
    for name, system in BRANCH_SYSTEMS.items():
        title, *lines = setting(system, {}, next(iter(system.symmetries), None))
        parts.append(f"## {title.removesuffix(':')} (`{name}`)\n")
        for line in lines:
            parts.append(f"```math\n{to_latex(line)}\n```\n" if line.startswith("  ") else f"{line}\n")
    return "\n".join(parts)


MODULES = {
    "shared": ("orbitproof.shared", "systems and claims", ""),
    "explore": ("orbitproof.explore", "the search, not trusted", ""),
    "verify": ("orbitproof.verify", "proofs and certificates", "InputError, enclose"),
    "enclose": ("orbitproof.verify.enclose", "flows and Poincaré maps of any system, enclosed", ""),
    "figures": ("orbitproof.figures", "pictures and tables", ""),
    "report": ("orbitproof.figures.report", "what certificates prove, as a document", ""),
}
"""The modules of the reference by page: module, what it is for, and what stands on another page."""
_ONLY = {"report": "check_files, report_of, write_report"}
"""Names of a module that are all of its face."""


def python_page() -> str:
    """The modules, with a page for each."""
    rows = "\n".join(f"| [{module}](python-{page}.md) | {what} |" for page, (module, what, _) in MODULES.items())
    pages = "\n".join(f"{module} <python-{page}>" for page, (module, _, _) in MODULES.items())
    return (
        "# Python\n\nEvery public name of every module. How to begin: the [guide](../docs/python.md).\n\n"
        f"| module | for |\n| --- | --- |\n{rows}\n\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"
    )


def module_page(page: str) -> str:
    """What autodoc says of a module."""
    module, what, elsewhere = MODULES[page]
    excluded = f"   :exclude-members: {elsewhere}\n" if elsewhere else ""
    only = f" {_ONLY[page]}" if page in _ONLY else ""
    return (
        f"# {module}\n\n{what[0].upper()}{what[1:]}.\n\n"
        f"```{{eval-rst}}\n.. automodule:: {module}\n   :members:{only}\n{excluded}```\n"
    )


PAGES = {
    "commands.md": commands_page,
    "fields.md": formats_page,
    "systems.md": systems_page,
    "python.md": python_page,
    **{f"python-{page}.md": partial(module_page, page) for page in MODULES},
}
"""The pages of the reference, by file name."""
