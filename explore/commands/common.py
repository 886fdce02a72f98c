"""What commands have in common: options, and the types of options.

What does not fit a type is an `argparse.ArgumentTypeError`.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from math import isfinite
from pathlib import Path
from typing import Any

from orbitproof.explore.three_body.names import BRANCHES, DEFAULT_BRANCH, FAMILY_NAMES
from orbitproof.shared.formats import InputError, check_writable

MAX_MULTIPLICITY = 1000
DIGITS = (15, 400)


WORTH_TELLING = 0.01
"""A correction that moves a guess so far, relative to its size, is told."""


def add_system(parser: Any) -> None:
    """``--system`` and ``--parameter``."""
    parser.add_argument(
        "--system",
        metavar="NAME|FILE",
        help=f"{', '.join(FAMILY_NAMES)}, or a file of your own, .json, or .py, which is run as a program; "
        "NAME:REVERSOR for a further reversing symmetry",
    )
    parser.add_argument(
        "--parameter", nargs="+", metavar="NAME=VALUE", help="the system's fixed parameters, taken exactly as written"
    )


def add_start(parser: Any) -> None:
    """``--system``, ``--parameter``, ``--start`` and ``--half-period``."""
    add_system(parser)
    parser.add_argument(
        "--start",
        nargs="+",
        metavar="NAME=VALUE",
        help="where a family of any system starts: an approximate orbit, by its coordinates on Fix(R) and the family "
        "parameter; or the word equilibrium (and coordinates near it): the families of its elliptic pairs",
    )
    parser.add_argument(
        "--half-period",
        type=positive,
        metavar="T",
        help="time from that point of the orbit to its other one on Fix(R) (default: found)",
    )


def add_output(parser: Any, kind: str, *, required: bool = True) -> None:
    """``-o``: the file that the command writes."""
    parser.add_argument("-o", "--output", type=Path, required=required, metavar="FILE", help=f"{kind} to write")


def add_jobs(parser: Any, meaning: str) -> None:
    """``--jobs``: processes for what `meaning` says."""
    meaning = f"processes{meaning} (default: the number of processors, %(default)s)"
    parser.add_argument("--jobs", type=jobs, default=os.cpu_count() or 1, metavar="N", help=meaning)


def add_device(parser: Any) -> None:
    """``--device``."""
    words = "where the rows are corrected, many at a time (default: cpu); gpu needs one that JAX finds"
    parser.add_argument("--device", choices=("cpu", "gpu"), default="cpu", help=words)


def add_quiet(parser: Any) -> None:
    """``--quiet``."""
    parser.add_argument("--quiet", action="store_true", help="no messages but errors on standard error")


def add_orbit_choice(parser: Any) -> None:
    """One orbit of a file: the file, ``--id``, ``--family``, ``--orbit``."""
    parser.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="candidates, certificates, families, branches, an atlas or its certificate, tori, or a periodic orbit "
        "catalogue",
    )
    parser.add_argument("--id", metavar="ID", help="the candidate, certificate or branch")
    parser.add_argument("--family", metavar="NAME", help="the family of a family file, for example earth-moon-L2-halo")
    parser.add_argument(
        "--orbit",
        type=place,
        metavar="N",
        help="the orbit of a family or catalogue, or the piece of an atlas, counted from 1; the orbit of a branch, 1 "
        "the first from the birth, -1 that on the other side",
    )
    add_accept(parser)


def check_outputs(*paths: Path | None) -> None:
    """Raises `InputError` if no file is named that a trajectory is written to, or one cannot be written."""
    if not any(paths):
        raise InputError("-o, --oem, --spk: missing; name the CSV file or the ephemeris file to write")
    for path in filter(None, paths):
        check_writable(path)


def add_claim_output(parser: Any, otherwise: str) -> None:
    """``--digits``, ``--id``, ``--output``, ``--append``, ``--quiet``; what is printed `otherwise`."""
    parser.add_argument("--digits", type=digits, default=50, metavar="N", help="default: %(default)s")
    words = "of the claim, numbered if there are several (default: the system)"
    parser.add_argument("--id", metavar="NAME", help=words)
    words = f"candidates file to write; without, {otherwise}"
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help=words)
    parser.add_argument("--append", action="store_true", help="keep what the output file already holds")
    add_quiet(parser)


def add_branch(parser: Any) -> None:
    """``--branch``."""
    parser.add_argument(
        "--branch",
        choices=BRANCHES,
        help="halo families and those that branch off from them: the northern or the southern orbits, mirror images, "
        f"by the sign of z where they are farthest from the smaller primary (default: {DEFAULT_BRANCH})",
    )


def add_accept(parser: Any) -> None:
    """``--accept``."""
    parser.add_argument(
        "--accept",
        action="store_true",
        help="take the orbit that is found though the file says something else of it (its state, period, level, "
        "stability): without it that is told, with both numbers, exit code 1",
    )


def positive(text: str) -> float:
    """A positive finite number."""
    value = float(text)
    if not isfinite(value) or value <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive number")
    return value


def number(text: str) -> float:
    """A finite number."""
    value = float(text)
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def _whole(low: int, high: int, meaning: str) -> Callable[[str], int]:
    def whole(text: str) -> int:
        value = int(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text!r} is not {meaning} from {low} to {high}")
        return value

    return whole


count = _whole(2, 1_000_000, "a whole number")
"""A number of orbits."""

index = _whole(1, 1_000_000, "a whole number")
"""A place in a list, counted from 1."""


def place(text: str) -> int:
    """A place in a list, counted from 1, or from -1 on its other side."""
    value = int(text)
    if not 1 <= abs(value) <= 1_000_000:
        raise argparse.ArgumentTypeError(f"{text!r} is no place: give 1, 2, .. or, of a branch, -1, -2, ..")
    return value


jobs = _whole(1, 1024, "a number of processes")

multiplicity = _whole(1, MAX_MULTIPLICITY, "a multiplicity")
"""The k of a 1:k resonance."""

digits = _whole(*DIGITS, "a number of digits")
"""A number of decimal digits."""

crossings = _whole(1, 100, "a number of crossings")
generations = _whole(0, 20, "a number of generations")

# argparse names the type in its message about text that is no number at all.
for _type in (positive, number):
    _type.__name__ = "number"
for _type in (count, index, place, jobs, multiplicity, digits, generations):
    _type.__name__ = "whole number"
