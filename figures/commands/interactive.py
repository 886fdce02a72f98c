"""``orbitproof figures interactive``: a family, a proved loop or tori in space, as one HTML file."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path
from typing import Any

from orbitproof.shared.formats import InputError, check_writable, stated_format, write_text
from orbitproof.shared.systems import CR3BP, THREE_BODY

_EXAMPLES = """\
examples:
  orbitproof figures interactive families.json --family earth-moon-L2-halo -o l2.html
  orbitproof figures interactive families.json --family earth-moon-L1-halo --candidates candidates.json \\
    --certificates certificates.json -o l1.html
  orbitproof figures interactive l1-certificate.json -o loop.html        (the certificate of an atlas)
  orbitproof figures interactive tori.json -o torus.html

The page holds everything it needs. What the mouse points at shows Jacobi constant, period, stability index and
verdict; verdicts are copied. Exit codes: 0 written, 2 bad input.
"""

_REMEDY = "give families, the certificate of an atlas, or tori"


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = commands.add_parser(
        "interactive",
        help="orbits in space as one HTML file, to be turned with the mouse",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="families, certificate of an atlas, or tori (JSON)")
    parser.add_argument("--family", metavar="NAME", help="the family, for example earth-moon-L2-halo")
    parser.add_argument("--candidates", type=Path, metavar="FILE", help="candidates file, to show its points")
    parser.add_argument("--certificates", type=Path, metavar="FILE", help="certificates of these candidates")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="HTML file to write")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the page; returns the exit code. Raises `InputError`."""
    check_writable(options.output)
    # Before anything is computed: it may not be installed.
    import_module("plotly")
    from orbitproof.figures.pictures.interactive import html_of

    kind = stated_format(options.file, _REMEDY)
    draw = {"family": _family, "atlas-certificate": _curve, "tori": _tori}.get(kind)
    if draw is None:
        raise InputError(f"{options.file}: {_REMEDY}")
    if kind != "family" and (options.family or options.candidates or options.certificates):
        raise InputError("--family, --candidates, --certificates: they belong to a file of families; leave them out")
    write_text(options.output, html_of(draw(options)))
    print(options.output)
    return 0


def _family(options: argparse.Namespace) -> Any:
    from orbitproof.figures.model import assign, mark_candidates, read_families
    from orbitproof.figures.pictures.interactive import family_lines, orbits_figure
    from orbitproof.shared.formats import read_candidates

    if options.certificates is not None and options.candidates is None:
        raise InputError("--certificates: need their candidates; add --candidates")
    families = [family for family in read_families(options.file) if family.system in THREE_BODY]
    fits = [family for family in families if options.family in (None, family.name)]
    if len(fits) != 1:
        if not families:
            known = " or ".join(each.name for each in THREE_BODY)
            raise InputError(f"{options.file}: has no family of {known}; draw others with orbitproof figures family")
        said = "missing" if options.family is None else f"no {options.family!r} in {options.file}"
        raise InputError(f"--family: {said}; give one of {', '.join(family.name for family in families)}")
    marks = []
    if options.candidates is not None:
        marks = mark_candidates(read_candidates(options.candidates), options.certificates, options.candidates)
    (own,), _ = assign(fits, marks)
    return orbits_figure(fits[0].name, family_lines(fits[0], own), float(fits[0].parameters["mu"]))


def _curve(options: argparse.Namespace) -> Any:
    from orbitproof.figures.certified import Curve, heading_of
    from orbitproof.figures.pictures.interactive import curve_lines, orbits_figure

    curve = Curve.read(options.file)
    if curve.system is not CR3BP:
        raise InputError(f"{options.file}: orbits of {curve.system.name} are not in space; give a curve of cr3bp")
    return orbits_figure(heading_of(curve.atlas), curve_lines(curve), float(curve.parameters["mu"]))


def _tori(options: argparse.Namespace) -> Any:
    from orbitproof.explore.invariants import read_tori
    from orbitproof.figures.pictures.interactive import tori_figure

    return tori_figure(read_tori(options.file))
