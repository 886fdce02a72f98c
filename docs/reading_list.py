"""What has to be read to believe a theorem: ``python docs/reading_list.py CHAPTER``.

These are the module that concludes, those that enclose what it concludes from, and all that they use, directly or by
way of others, each after what it uses itself. A name that comes through the face of a room counts for the module that
defines it.

What only some claims need is imported in the branch of a function that such a claim takes: a *door*. What is behind the
doors follows below, by the claims that open them.
"""

from __future__ import annotations

import argparse
import ast
import os
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
    "double-resonance": (
        "verify.double_resonance.following",
        "verify.double_resonance.proved_double_resonance",
    ),
    "curve": ("verify.curve.piece", "verify.curve.proved_curve"),
    "periodic": ("verify.periodic.following", "verify.periodic.force", "verify.periodic.proved_periodic"),
    "equilibrium": ("verify.equilibrium.proved_equilibrium",),
    "hopf": ("verify.equilibrium.proved_hopf",),
    "homoclinic": ("verify.homoclinic.following", "verify.homoclinic.proved_homoclinic"),
    "heteroclinic": ("verify.homoclinic.following", "verify.heteroclinic.proved_heteroclinic"),
    "homoclinic-curve": ("verify.homoclinic_curve.following", "verify.homoclinic_curve.proved_homoclinic_curve"),
    "periodic-bifurcation": (
        "verify.periodic_bifurcation.following",
        "verify.periodic.force",
        "verify.periodic_bifurcation.proved_periodic_bifurcation",
    ),
    "torus": (
        "verify.periodic_bifurcation.following",
        "verify.periodic.force",
        "verify.periodic_bifurcation.proved_torus",
    ),
    "periodic-curve": ("verify.periodic_curve.piece", "verify.periodic.force", "verify.periodic_curve.proved_curve"),
    "equilibrium-curve": ("verify.equilibrium_curve.piece", "verify.equilibrium_curve.proved_curve"),
    "birth-curve": ("verify.birth_curve.piece", "verify.birth_curve.proved_curve"),
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
    "double-resonance": ("two-resonances", "codimension-two"),
    "curve": ("branch", "branches", "family", "families", "loop", "piece", "atlas", "libration"),
    "periodic": ("periodic-orbit",),
    "equilibrium": ("one-equilibrium", "fixed-point"),
    "hopf": ("hopf-point", "hopf-bifurcation", "andronov-hopf"),
    "homoclinic": ("homoclinic-orbit", "horseshoe"),
    "heteroclinic": ("heteroclinic-orbit", "connection"),
    "homoclinic-curve": ("homoclinic-levels",),
    "periodic-bifurcation": ("periodic-fold", "periodic-doubling", "periodic-pitchfork", "doubling", "pitchfork"),
    "torus": ("periodic-torus", "neimark-sacker"),
    "periodic-curve": ("periodic-atlas", "periodic-arc", "periodic-loop"),
    "equilibrium-curve": ("equilibrium-arc", "equilibrium-loop"),
    "birth-curve": ("birth-arc", "births"),
    "surface": ("mass", "masses", "birth"),
    "list": ("complete", "complete-list", "stability"),
    "lasting": ("twistless", "stable-for-ever"),
    "second-proof": ("second",),
}
"""What else the chapters are called, where the words of the project name them."""

DOORS = {
    "systems with sin, cos, exp or log": (
        "shared.systems.defined_coordinates",
        "verify.claim.functions",
        "verify.claim.related_functions",
        "verify.poincare.functions",
    ),
    "systems with a periodic force": ("shared.systems.forcing",),
    "systems on a fixed level of an integral": (
        "verify.claim.fixed_level",
        "verify.poincare.level_set",
        "verify.poincare.sheets",
    ),
    "certified bifurcations and orbits on the curve": (
        "verify.curve.bifurcations_on_it",
        "verify.stability.between_orbits",
        "verify.stability.matching",
    ),
    "one orbit, two resonances that meet, or a homoclinic orbit": ("shared.claims.special_claims",),
    "systems with further reversing symmetries": ("shared.systems.further_reversors",),
    "input that is refused": ("shared.printing",),
    "distances from a body": ("verify.distances.distances",),
    "half orbits that meet the section more than once": ("verify.poincare.half_orbit",),
    "orbits that are followed in regularised coordinates": ("verify.poincare.regularised",),
    "families around a libration point, in units of their orbits": (
        "shared.systems.libration",
        "verify.curve.libration_point",
        "verify.curve.vertical_family",
        "verify.curve.lyapunov_family",
    ),
    "axial families from birth to birth": ("shared.systems.lifted", "verify.curve.lifted_family"),
    "families of doubled period from their birth": ("shared.systems.three_body", "verify.curve.doubling_birth"),
    "period doublings over the mass": ("shared.systems.varied", "verify.curve.doubled_family"),
    "motion in a plane of a larger system": ("verify.out_of_plane.out_of_plane", "verify.stability.across_list"),
}
"""The modules that functions import, by the claims for which they do."""


@cache
def path_of(module: str) -> Path | None:
    """The file of a module, named without the package; `None` if there is none."""
    path = ROOT.joinpath(*module.split("."))
    # The face of a room that loads what is asked of it says in its stub what it has.
    faces = (path / "__init__.pyi", path / "__init__.py")
    found = [file for file in (*faces, path.with_suffix(".py")) if file.exists()]
    return found[0] if found else None


@cache
def tree_of(path: Path) -> ast.Module:
    """A file, read."""
    return ast.parse(path.read_text("utf-8"))


@cache
def imports(path: Path, in_functions: bool = False) -> tuple[tuple[str, str], ...]:
    """Module and name of all that a file imports from the package, or that its functions do, types alone left out."""
    return tuple(each for each, is_inside in _imports(path) if is_inside == in_functions)


def _imports(path: Path) -> Iterator[tuple[tuple[str, str], bool]]:
    waiting: list[tuple[ast.AST, bool]] = [(tree_of(path), False)]
    while waiting:
        node, is_inside = waiting.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            continue
        if isinstance(node, ast.ImportFrom):
            room = [PACKAGE, *path.relative_to(ROOT).parts[:-1]][: 1 - node.level or None] if node.level else []
            source = ".".join([*room, *([node.module] if node.module else [])])
            if source.startswith(f"{PACKAGE}."):
                yield from (((source.removeprefix(f"{PACKAGE}."), each.name), is_inside) for each in node.names)
        is_inside |= isinstance(node, ast.FunctionDef)
        waiting += [(child, is_inside) for child in reversed(list(ast.iter_child_nodes(node)))]


@cache
def definer(module: str, name: str) -> str:
    """The module in which a name that can be imported from `module` is defined."""
    if path_of(f"{module}.{name}") is not None:
        return f"{module}.{name}"
    path = path_of(module)
    assert path is not None, module
    sources = [source for source, imported in imports(path) if imported == name]
    return definer(sources[0], name) if path.stem == "__init__" and sources else module


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


def behind_doors(modules: Sequence[str]) -> dict[str, list[str]]:
    """What is to be read besides for some claims, as `DOORS` calls them, in order."""
    always = reading_list(modules)
    opened: dict[str, list[str]] = {claims: [] for claims in DOORS}
    waiting = list(always)
    while waiting:
        path = path_of(waiting.pop())
        assert path is not None
        for door in sorted({definer(*each) for each in imports(path, in_functions=True)} - set(always)):
            (claims,) = (claims for claims, entries in DOORS.items() if door in entries)
            if door not in opened[claims]:
                opened[claims].append(door)
                waiting += reading_list([door])
    return {
        claims: [name for name in reading_list(entries) if name not in always]
        for claims, entries in opened.items()
        if entries
    }


@cache
def length(module: str) -> int:
    """Its lines, all of them."""
    path = path_of(module)
    assert path is not None, module
    return len(path.read_text("utf-8").splitlines())


def told(last: Sequence[str]) -> str:
    """The list as text: file, lines, and what it is about."""
    modules = reading_list(last)
    lines = [*map(entry, modules), "", f"in all {total(modules)}"]
    for claims, more in behind_doors(last).items():
        lines += ["", f"and for {claims}, {total(more)} more", "", *map(entry, more)]
    return "\n".join(lines)


def entry(module: str) -> str:
    """The line of a module."""
    path = path_of(module)
    assert path is not None, module
    about = (ast.get_docstring(tree_of(path)) or "").partition("\n")[0]
    return f"{path.relative_to(ROOT)!s:44}{length(module):6}  {about}"


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
            more = sum(map(length, {each for names in behind_doors(last).values() for each in names}))
            print(f"{name:21}{total(modules)}, {more} more for some claims, up to {last[-1]}")
        last = [name for last in CHAPTERS.values() for name in last]
        everything = {*reading_list(last), *(each for names in behind_doors(last).values() for each in names)}
        print(f"\nin all {total(sorted(everything))}")
        return 0
    chapter = chapter_of(asked)
    last = CHAPTERS.get(chapter, (chapter,))
    if path_of(last[-1]) is None:
        print(f"error: no chapter or module {asked!r}; give one of {', '.join(CHAPTERS)}", file=sys.stderr)
        return 2
    print(told(last))
    return 0


if __name__ == "__main__":
    try:
        code = main()
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read on has seen enough, as with | head; Python has nothing more to write when it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    sys.exit(code)
