"""What has to be read to believe a theorem: ``python docs/reading_list.py CHAPTER``.

These are the module that concludes, those that enclose what it concludes from, and all that they use, directly or by
way of others, each after what it uses itself. A name that comes through the face of a room counts for the module that
defines it.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "orbitproof"

CHAPTERS = {
    "bifurcation": ("verify.poincare.iterates", "verify.bifurcation.proved_bifurcation"),
    "fold": ("verify.poincare.iterates", "verify.bifurcation.fold"),
    "orbit": ("verify.orbit.following", "verify.orbit.proved_orbit"),
    "twist": ("verify.twist.following", "verify.twist.proved_stable_orbit"),
    "krein": ("verify.reversor_breaking.following", "verify.krein.proved_krein"),
    "curve": ("verify.curve.piece", "verify.curve.proved_curve"),
    "periodic": ("verify.periodic.following", "verify.periodic.proved_periodic"),
    "periodic-bifurcation": (
        "verify.periodic_bifurcation.following",
        "verify.periodic_bifurcation.proved_periodic_bifurcation",
    ),
    "torus": ("verify.periodic_bifurcation.following", "verify.periodic_bifurcation.proved_torus"),
    "periodic-curve": ("verify.periodic_curve.piece", "verify.periodic_curve.proved_curve"),
    "surface": ("verify.surface.piece", "verify.surface.libration_piece", "verify.surface.proved_surface"),
    "list": ("verify.curve.piece", "verify.stability.matrix", "verify.stability.proved_list"),
    "lasting": (
        "verify.curve.piece",
        "verify.stability.matrix",
        "verify.lasting.stored",
        "verify.lasting.proved_lasting",
    ),
    "second-proof": ("verify.second_proof.proof",),
}
"""The modules that enclose, and the one that concludes, by what it concludes about."""

OTHER_WORDS = {
    "bifurcation": ("row", "candidate", "resonance", "symmetry-breaking", "period-tupling", "touch-and-go"),
    "fold": ("extremum",),
    "orbit": ("one-orbit", "single-orbit"),
    "twist": ("stable-orbit",),
    "krein": ("collision", "krein-collision"),
    "curve": ("branch", "branches", "family", "families", "loop", "piece", "atlas", "libration"),
    "periodic": ("periodic-orbit",),
    "periodic-bifurcation": ("periodic-fold", "periodic-doubling", "periodic-pitchfork", "doubling", "pitchfork"),
    "torus": ("periodic-torus", "neimark-sacker"),
    "periodic-curve": ("periodic-atlas", "periodic-arc", "periodic-loop"),
    "surface": ("mass", "masses", "birth"),
    "list": ("complete", "complete-list", "stability"),
    "lasting": ("twistless", "stable-for-ever"),
    "second-proof": ("second",),
}
"""What else the chapters are called, where the words of the project name them."""


@cache
def path_of(module: str) -> Path | None:
    """The file of a module, named without the package; `None` if there is none."""
    path = ROOT.joinpath(*module.split("."))
    found = [file for file in (path / "__init__.py", path.with_suffix(".py")) if file.exists()]
    return found[0] if found else None


@cache
def tree_of(path: Path) -> ast.Module:
    """A file, read."""
    return ast.parse(path.read_text("utf-8"))


def imports(path: Path) -> Iterator[tuple[str, str]]:
    """Module and name of everything that a file imports from the package, wherever in it, types alone left out."""
    waiting: list[ast.AST] = [tree_of(path)]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            continue
        if isinstance(node, ast.ImportFrom):
            room = [PACKAGE, *path.relative_to(ROOT).parts[:-1]][: 1 - node.level or None] if node.level else []
            source = ".".join([*room, *([node.module] if node.module else [])])
            if source.startswith(f"{PACKAGE}."):
                yield from ((source.removeprefix(f"{PACKAGE}."), alias.name) for alias in node.names)
        waiting += reversed(list(ast.iter_child_nodes(node)))


@cache
def definer(module: str, name: str) -> str:
    """The module in which a name that can be imported from `module` is defined."""
    if path_of(f"{module}.{name}") is not None:
        return f"{module}.{name}"
    path = path_of(module)
    assert path is not None, module
    sources = [source for source, imported in imports(path) if imported == name]
    return definer(sources[0], name) if path.name == "__init__.py" and sources else module


def reading_list(modules: Sequence[str]) -> list[str]:
    """The modules to be read for these, the last of them last, each after those that it uses."""
    found: dict[str, None] = {}
    begun: set[str] = set()

    def read(name: str) -> None:
        if name in begun:
            return
        begun.add(name)
        path = path_of(name)
        assert path is not None, name
        for source in sorted({definer(*each) for each in imports(path)}):
            read(source)
        found[name] = None

    for module in modules:
        read(module)
    return list(found)


def length(module: str) -> int:
    """Its lines, all of them."""
    path = path_of(module)
    assert path is not None, module
    return len(path.read_text("utf-8").splitlines())


def told(last: Sequence[str]) -> str:
    """The list as text: file, lines, and what it is about."""
    modules = reading_list(last)
    lines = []
    for name in modules:
        path = path_of(name)
        assert path is not None
        about = (ast.get_docstring(tree_of(path)) or "").partition("\n")[0]
        lines.append(f"{path.relative_to(ROOT)!s:44}{length(name):6}  {about}")
    return "\n".join([*lines, "", f"in all {total(modules)}"])


def total(modules: Sequence[str]) -> str:
    """How long they are together."""
    return f"{sum(map(length, modules))} lines in {len(modules)} modules"


def chapter_of(words: str) -> str:
    """The chapter that words mean, in the plural too; or a module or room of `verify`; or the words themselves."""
    plain = "-".join(words.lower().replace("_", " ").split())
    for name, others in OTHER_WORDS.items():
        if {plain, plain.removesuffix("s")} & {name, *others}:
            return name
    return f"verify.{words}" if path_of(f"verify.{words}") else words


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 2 for a chapter that is not there."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words = f"{', '.join(CHAPTERS)}, or a module as verify.curve.proved_curve; without one, the length of each list"
    parser.add_argument("chapter", nargs="*", help=words)
    options = parser.parse_args(arguments)
    asked = " ".join(options.chapter)
    if not asked:
        for name, last in CHAPTERS.items():
            modules = reading_list(last)
            print(f"{name:21}{sum(map(length, modules)):7} lines in {len(modules)} modules, up to {last[-1]}")
        print(f"\nin all {total(reading_list([name for last in CHAPTERS.values() for name in last]))}")
        return 0
    chapter = chapter_of(asked)
    last = CHAPTERS.get(chapter, (chapter,))
    if path_of(last[-1]) is None:
        print(f"error: no chapter or module {asked!r}; give one of {', '.join(CHAPTERS)}", file=sys.stderr)
        return 2
    print(told(last))
    return 0


if __name__ == "__main__":
    sys.exit(main())
