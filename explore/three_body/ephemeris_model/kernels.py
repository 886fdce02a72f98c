"""Bodies as the user's kernels for SPICE have them: where they are, and what they weigh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.flow import Vector
from orbitproof.shared.formats import ArgumentError

AXES = "J2000"
"""SPICE's name of the axes of everything here; they do not turn."""

_LONGEST_PATH = 250


@dataclass(frozen=True)
class Bodies:
    """Point masses in loaded kernels.

    Attributes:
        names: as the user calls them: the larger primary, the smaller one, then all others.
        numbers: SPICE's.
        gravity: GM of each, km^3/s^2.
    """

    names: tuple[str, ...]
    numbers: tuple[int, ...]
    gravity: tuple[float, ...]

    @property
    def mass_ratio(self) -> float:
        """Mass of the smaller primary over that of both."""
        return self.gravity[1] / (self.gravity[0] + self.gravity[1])

    def state(self, index: int, origin: int, seconds: float) -> Vector:
        """State of a body relative to another, km and km/s, at TDB seconds past J2000. Raises `ArgumentError`."""
        import spiceypy

        try:
            state, _ = spiceypy.spkgeo(self.numbers[index], seconds, AXES, self.numbers[origin])
        except spiceypy.utils.exceptions.SpiceyError as error:
            raise ArgumentError(
                "{kernels}: nothing about {0} and {1} at {2} TDB ({3}); give kernels that cover it, or another {epoch}",
                self.names[index],
                self.names[origin],
                _date(seconds),
                error.short.strip(),
            ) from None
        return np.asarray(state, dtype=float)

    def place(self, index: int, origin: int, seconds: float) -> Any:
        """The place alone, three numbers; for times at which `state` has been asked before."""
        import spiceypy

        return spiceypy.spkgps(self.numbers[index], seconds, AXES, self.numbers[origin])[0]


def _date(seconds: float) -> str:
    return str(np.datetime64("2000-01-01T12:00:00") + np.timedelta64(round(seconds), "s"))


@contextmanager
def kernels_loaded(paths: Sequence[Path]) -> Iterator[None]:
    """Load kernels into SPICE, for as long as the block runs. Raises `ArgumentError`."""
    import spiceypy

    loaded: list[str] = []
    try:
        for path in paths:
            if not path.is_file():
                raise ArgumentError("{kernels} {0}: cannot be read; give the path of a kernel for SPICE", path)
            if len(str(path)) > _LONGEST_PATH:
                raise ArgumentError("{kernels} {0}: SPICE reads paths of up to {1} characters", path, _LONGEST_PATH)
            try:
                spiceypy.furnsh(str(path))
            except spiceypy.utils.exceptions.SpiceyError as error:
                raise ArgumentError("{kernels} {0}: no kernel for SPICE ({1})", path, error.short.strip()) from None
            loaded.append(str(path))
        yield
    finally:
        for name in reversed(loaded):
            spiceypy.unload(name)


def bodies_named(names: Sequence[str], given: Mapping[str, float]) -> Bodies:
    """Bodies of loaded kernels by name or number, the primaries first.

    Arguments:
        given: GM of bodies whose GM no kernel has, km^3/s^2, by the same names.

    Raises `ArgumentError`.
    """
    import spiceypy

    numbers, gravity = [], []
    for name in names:
        try:
            number = int(spiceypy.bods2c(name))
        except spiceypy.utils.exceptions.NotFoundError:
            raise ArgumentError("{bodies} {0}: SPICE knows no such body; give its name or number", name) from None
        numbers.append(number)
        if name in given:
            gravity.append(given[name])
        elif spiceypy.bodfnd(number, "GM"):
            gravity.append(float(spiceypy.bodvcd(number, "GM", 1)[1][0]))
        else:
            raise ArgumentError("{gm} {0}: missing; no kernel has its GM: give it in km^3/s^2, or such a kernel", name)
    if len(set(numbers)) != len(numbers):
        raise ArgumentError("{bodies} {0}: one of them twice; name each once", " ".join(names))
    unknown = next((name for name in given if name not in names), None)
    if unknown is not None:
        raise ArgumentError("{gm} {0}: is none of {bodies} {1}", unknown, " ".join(names))
    return Bodies(tuple(names), tuple(numbers), tuple(gravity))
