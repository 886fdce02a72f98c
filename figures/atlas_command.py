"""``python -m figures atlas``: pictures of proved branches, from the certificates of their atlases."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from figures.folder import check_folder
from shared.formats import InputError

if TYPE_CHECKING:
    from figures.atlas import Curve
    from figures.atlas_surface import Surface

_EXAMPLES = """\
examples:
  python -m verify.atlas l1.json -o l1-certificate.json
  python -m figures atlas l1-certificate.json -o figures-out/
  python -m figures atlas l1-earth-moon.json l1-sun-jupiter.json -o figures-out/

For each certificate its atlas (atlas-*: widths of the pieces, the coordinates in which orbits were followed, tubes,
certified points); for all certificates of one kind of curve together the curves themselves, drawn from the certified
polynomials (curves-*); surfaces over the mass parameter (surface-*). Every verdict is copied.
Exit codes: 0 written, 1 written, but something is not proved, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = commands.add_parser(
        "atlas", help="proved branches: their pieces, and the curves", epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("certificates", type=Path, nargs="+", help="certificates of atlases (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    from verify.atlas_certificate import read_atlas_certificate

    certificates = [read_atlas_certificate(path) for path in options.certificates]
    names = [_name(certificate.atlas.id) for certificate in certificates]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two certificates of one atlas, {name!r}; give each atlas once")

    # Matplotlib takes a second to load: only after the input is known to be good.
    from figures.atlas import curve_of
    from figures.atlas_surface import surface_of
    from figures.style import use_style

    check_folder(options.output)
    curves = [curve_of(certificate) for certificate in certificates if not certificate.atlas.is_surface]
    surfaces = [surface_of(certificate) for certificate in certificates if certificate.atlas.is_surface]
    with use_style():
        for path in (*write(curves, options.output), *write_surfaces(surfaces, options.output)):
            print(path, flush=True)
    return 0 if all(certificate.is_proved for certificate in certificates) else 1


def write(curves: Sequence[Curve], folder: Path) -> Iterator[Path]:
    """Draw the pieces of each curve, and all curves of one kind together; yields the paths written."""
    from figures.atlas_pictures import draw_curves, draw_pieces
    from figures.style import close, save

    groups: dict[str, list[Curve]] = {}
    for curve in curves:
        groups.setdefault(f"{curve.system.name}-{curve.atlas.claim.kind}", []).append(curve)
        figure = draw_pieces(curve)
        yield from save(figure, folder / f"atlas-{_name(curve.atlas.id)}")
        close(figure)
    for name, group in groups.items():
        figure = draw_curves(group)
        yield from save(figure, folder / f"curves-{_name(name)}")
        close(figure)


def write_surfaces(surfaces: Sequence[Surface], folder: Path) -> Iterator[Path]:
    """Draw each surface; yields the paths written."""
    from figures.atlas_surface import draw_surface
    from figures.style import close, save

    for surface in surfaces:
        figure = draw_surface(surface)
        yield from save(figure, folder / f"surface-{_name(surface.atlas.id)}")
        close(figure)


def _name(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9.]+", "-", text).strip("-.") or "atlas"
