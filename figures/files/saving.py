"""Figures as files: which formats, how fine, how large."""

from __future__ import annotations

import argparse
import io
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.shared.formats import ArgumentError, write_bytes

FORMATS = ("pdf", "png", "svg")
DPI = (50, 1200)
WIDTH = (5.0, 30.0)

_UNDATED = {"pdf": {"CreationDate": None}, "png": {"Software": None}, "svg": {"Date": None}}
"""No date inside: the same data give the same bytes."""


@dataclass(frozen=True)
class Files:
    """How figures are saved.

    Attributes:
        formats: some of `FORMATS`.
        dpi: of PNG files; `None`: as in the style sheet.
        width: in inches, the height in proportion, letters as large as ever; `None`: as drawn.
    """

    formats: tuple[str, ...] = ("pdf", "png")
    dpi: int | None = None
    width: float | None = None

    def __post_init__(self) -> None:
        """Raises `InputError` for what cannot be."""
        for name in self.formats:
            if name not in FORMATS:
                raise ArgumentError("{formats:--format} {0}: give some of {1}", name, ", ".join(FORMATS))
        if self.dpi is not None and not DPI[0] <= self.dpi <= DPI[1]:
            raise ArgumentError("{dpi} {0}: give a whole number from {1} to {2}", self.dpi, *DPI)
        if self.width is not None and not WIDTH[0] <= self.width <= WIDTH[1]:
            raise ArgumentError("{width} {0:g}: give a number from {1:g} to {2:g}", self.width, *WIDTH)


_FILES: ContextVar[Files] = ContextVar("files")


def add_file_options(parser: argparse.ArgumentParser) -> None:
    """``--format``, ``--dpi`` and ``--width``, for commands that draw."""
    parser.add_argument(
        "--format",
        nargs="+",
        choices=FORMATS,
        default=["pdf", "png"],
        metavar="FORMAT",
        help=f"files of each picture: {', '.join(FORMATS)} (default: pdf png)",
    )
    parser.add_argument("--dpi", type=int, metavar="N", help=f"of PNG files, {DPI[0]} to {DPI[1]} (default: 200)")
    parser.add_argument(
        "--width",
        type=float,
        metavar="INCHES",
        help=f"of the pictures, {WIDTH[0]:g} to {WIDTH[1]:g}, letters as large as ever (default: 7.2)",
    )


_PLAIN = 1e-3, 1e5
"""Largest numbers at an axis between which none is written with a power of ten."""


def files_of(options: argparse.Namespace) -> Files:
    """What these options say. Raises `InputError`."""
    return Files(tuple(dict.fromkeys(options.format)), options.dpi, options.width)


@contextmanager
def saved_as(files: Files | None) -> Iterator[None]:
    """Figures are saved so while the body runs; `None`: as they are."""
    if files is None:
        yield
        return
    token = _FILES.set(files)
    try:
        yield
    finally:
        _FILES.reset(token)


def save(figure: Any, stem: Path) -> list[Path]:
    """Write `stem`.pdf, `stem`.png or what was asked for, each whole or not at all, and release the figure.

    Raises `InputError`.
    """
    from matplotlib import pyplot

    files = _FILES.get(Files())
    if files.width is not None:
        size = figure.get_size_inches()
        figure.set_size_inches(np.asarray(size) * files.width / size[0])
    _plain_numbers(figure)
    written = []
    for kind in files.formats:
        path = stem.with_name(f"{stem.name}.{kind}")
        buffer = io.BytesIO()
        resolution = {} if files.dpi is None else {"dpi": files.dpi}
        figure.savefig(buffer, format=kind, metadata=_UNDATED[kind], **resolution)
        write_bytes(path, buffer.getvalue())
        written.append(path)
    pyplot.close(figure)
    return written


def _plain_numbers(figure: Any) -> None:
    """Numbers at axes that need no power of ten are plain text, which is sooner set; they look the same."""
    from matplotlib.ticker import ScalarFormatter

    for axes in figure.axes:
        for axis in filter(None, (axes.xaxis, axes.yaxis, getattr(axes, "zaxis", None))):
            largest, formatter = max(map(abs, axis.get_view_interval())), axis.get_major_formatter()
            if type(formatter) is ScalarFormatter and _PLAIN[0] < largest < _PLAIN[1]:
                formatter.set_useMathText(False)
