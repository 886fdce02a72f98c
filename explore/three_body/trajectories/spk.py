"""Ephemerides as SPK files of NAIF's SPICE, type 13: Hermite interpolation between states at unequal times."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from orbitproof.explore.three_body.trajectories.ephemeris import Ephemeris
from orbitproof.explore.three_body.trajectories.interpolation import DEGREE, WINDOW, check_times
from orbitproof.shared.formats import InputError, write_bytes

FRAME = "ECLIPJ2000"

_LONGEST_COMMENT = 250
_BARYCENTRES = {"earth": 3, "mars": 4, "jupiter": 5, "saturn": 6, "uranus": 7, "neptune": 8, "pluto": 9}
"""SPICE's numbers of the barycentres of planets with moons, by the name of the planet."""


def centre_number(origin: str, bodies: tuple[str, str] | None, given: int | None) -> int:
    """SPICE's number of the centre: that of a body by its name, of a planet's barycentre by that of the planet.

    Arguments:
        origin: one of `trajectories.frames.ORIGINS`.
        bodies: names of the primaries, or `None`.
        given: by the user, or `None`.

    Raises `InputError`.
    """
    if given is not None:
        return given
    import spiceypy

    name = None if bodies is None or origin == "barycentre" else bodies[origin == "smaller"]
    if bodies is not None and origin == "barycentre" and bodies[0].lower() in _BARYCENTRES:
        return _BARYCENTRES[bodies[0].lower()]
    number = None
    if name is not None:
        try:
            number = int(spiceypy.bodn2c(name))
        except spiceypy.utils.exceptions.NotFoundError:
            number = None
    if number is None:
        said = "the centre of mass" if name is None else name
        raise InputError(
            f"--spk-centre: missing; SPICE has no number for {said} here: give one, or --origin with a body"
        )
    return number


def write_spk(path: Path, ephemeris: Ephemeris, *, body: int, centre: int, frame: str = FRAME) -> float:
    """Write the file, whole or not at all, and read it back by SPICE.

    Arguments:
        body, centre: SPICE's numbers.
        frame: a name that SPICE knows; the axes of the ephemeris are taken to be those of this frame.

    Returns the largest distance, km, between what SPICE interpolates, between any two states, and the orbit. Raises
    `InputError`, and `ModuleNotFoundError` where spiceypy is not installed.
    """
    import spiceypy

    if len(ephemeris.times) < WINDOW:
        raise InputError(f"--points {len(ephemeris.times)}: an SPK file needs {WINDOW} states; give more")
    with tempfile.TemporaryDirectory() as folder:
        draft = Path(folder) / "draft.bsp"
        try:
            _write(draft, ephemeris, body, centre, frame)
            error = _read_back(draft, ephemeris, body, centre, frame)
        except spiceypy.utils.exceptions.SpiceyError as failure:
            raise InputError(
                f"--spk {path}: SPICE refuses it: {failure.short or failure}; see its names of frames"
            ) from None
        content = draft.read_bytes()
    write_bytes(path, content)
    return error


def _write(path: Path, ephemeris: Ephemeris, body: int, centre: int, frame: str) -> None:
    import spiceypy

    seconds = ephemeris.seconds
    comments = [line[i : i + _LONGEST_COMMENT] for line in (*ephemeris.head, *ephemeris.remarks)
                for i in range(0, len(line), _LONGEST_COMMENT)]  # fmt: skip
    comments = [line.encode("ascii", "replace").decode() for line in comments]
    handle = spiceypy.spkopn(str(path), "orbitproof", sum(map(len, comments)) + 2 * len(comments))
    try:
        spiceypy.dafac(handle, comments)
        name = ephemeris.title.encode("ascii", "replace").decode()[:40]
        spiceypy.spkw13(
            handle, body, centre, frame, seconds[0], seconds[-1], name, DEGREE, len(seconds), ephemeris.states, seconds
        )  # fmt: skip
    finally:
        spiceypy.spkcls(handle)


def _read_back(path: Path, ephemeris: Ephemeris, body: int, centre: int, frame: str) -> float:
    import spiceypy

    between = check_times(ephemeris.times).ravel()
    start = ephemeris.seconds[0]
    spiceypy.furnsh(str(path))
    try:
        found = np.array([spiceypy.spkgeo(body, start + time, frame, centre)[0][:3] for time in between])
    finally:
        spiceypy.unload(str(path))
    return float(np.linalg.norm(found - ephemeris.states_at(between)[:, :3], axis=1).max())
