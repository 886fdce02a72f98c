"""``orbitproof figures atlas``: pictures of proved branches, from the certificates of their atlases."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, check_folder, file_name
from orbitproof.shared.formats import InputError

_EXAMPLES = """\
examples:
  orbitproof verify atlas l1.json -o l1-certificate.json
  orbitproof figures atlas l1-certificate.json -o figures-out/
  orbitproof figures atlas l1-earth-moon.json l1-sun-jupiter.json -o figures-out/

For each certificate its atlas (atlas-*: widths of the pieces, the coordinates in which orbits were followed, tubes,
certified points); for all certificates of one kind of curve together the curves themselves, drawn from the certified
polynomials (curves-*); of those with a complete list (--complete K) the stability parameters with all resonances
(stability-*); surfaces over the mass parameter (surface-*). Every verdict is copied.
Exit codes: 0 written, 1 written, but something is not proved, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = commands.add_parser(
        "atlas",
        help="proved branches: their pieces, and the curves",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("certificates", type=Path, nargs="+", help="certificates of atlases (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    from orbitproof.verify.atlas import read_atlas_certificate

    certificates = [read_atlas_certificate(path) for path in options.certificates]
    names = [file_name(certificate.atlas.id) for certificate in certificates]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two certificates of one atlas, {name!r}; give each atlas once")

    # Matplotlib takes a second to load: only after the input is known to be good.
    from orbitproof.figures.certified import CertifiedStability, Curve
    from orbitproof.figures.collection.proved import write_curves, write_stability, write_surfaces
    from orbitproof.figures.pictures import surface_of
    from orbitproof.figures.style import use_style

    check_folder(options.output)
    curves = [Curve.of(certificate) for certificate in certificates if not certificate.atlas.is_surface]
    surfaces = [surface_of(certificate) for certificate in certificates if certificate.atlas.is_surface]
    listed = [CertifiedStability.of(certificate) for certificate in certificates if not certificate.atlas.is_surface]
    stability = [found for found in listed if found is not None]
    with use_style():
        for paths in (
            write_curves(curves, options.output),
            write_stability(stability, options.output),
            write_surfaces(surfaces, options.output),
        ):
            for path in paths:
                print(path, flush=True)
    return 0 if all(certificate.is_proved for certificate in certificates) else 1
