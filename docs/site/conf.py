"""Sphinx: the site is built from a copy of the tree's own documents, by docs/site/build.py."""

from __future__ import annotations

import re
import typing
from contextlib import suppress
from importlib import metadata
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

from orbitproof.figures.report.formulas import to_mathml

project = "orbitproof"
author = "The orbitproof developers"
project_copyright = "2026, The orbitproof developers"
version = release = metadata.version("orbitproof")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = f"orbitproof {release}"
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_static_path = ["_static"]
html_extra_path = ["pages"]
html_css_files = ["site.css"]
exclude_patterns = ["_build"]
default_role = "code"
nitpicky = False

myst_enable_extensions = ["deflist", "dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
nb_execution_mode = "off"

autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
napoleon_numpy_docstring = False
napoleon_custom_sections = [("Arguments", "params_style")]


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(to_mathml(node.astext()))
    raise nodes.SkipNode


def _display(writer: Any, node: nodes.math_block) -> None:
    formula = to_mathml(node.astext(), "block")
    writer.body.append(
        f'<div class="math" style="margin: .4rem 0; overflow-x: auto; overflow-y: hidden">{formula}</div>\n'
    )
    raise nodes.SkipNode


def _without_rules(app: Sphinx, function: Any, bound: bool) -> None:
    """Show the types of arguments without the rules of the fields' JSON, which the schemas have."""
    with suppress(NameError, AttributeError, TypeError):
        function.__annotations__ = typing.get_type_hints(function)


def _short(
    _app: Sphinx, _what: str, _name: str, _object: Any, _options: Any, signature: str | None, result: str | None
) -> Any:
    """Show names of types without those of their modules, in defaults too; arrays by their name."""
    return (None if signature is None else _ARRAY.sub("ndarray", re.sub(r"~(?:\w+\.)+", "", signature))), result


_ARRAY = re.compile(r"ndarray\[tuple\[Any, \.\.\.\], dtype\[\w+\]\]")


def _whole(_app: Sphinx, what: str, _name: str, _object: Any, _options: Any, lines: list[str]) -> None:
    """A property's sentence with a colon in it stays one; napoleon takes what is before the colon for a type."""
    if what == "property" and len(lines) >= 2 and lines[-1].startswith(":type: "):
        lines[:] = [f"{lines[-1].removeprefix(':type: ')}: {lines[0]}", *lines[1:-1]]


def setup(app: Sphinx) -> None:
    """Formulas as MathML, which browsers show without any script and without a network; signatures to be read."""
    app.connect("autodoc-before-process-signature", _without_rules)
    app.connect("autodoc-process-signature", _short)
    app.connect("autodoc-process-docstring", _whole, priority=600)
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
