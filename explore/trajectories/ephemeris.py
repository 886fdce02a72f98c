"""Trajectories as CCSDS Orbit Ephemeris Messages (CCSDS 502.0-B-3, version 3.0, key = value notation)."""

from __future__ import annotations

import re
from datetime import UTC, datetime

import numpy as np

from orbitproof.explore.trajectories.csv_file import description
from orbitproof.explore.trajectories.trajectory import Trajectory
from orbitproof.explore.trajectories.units import Units
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import THREE_BODY

LONGEST_LINE = 240
"""The standard allows 254 characters a line, the keyword included."""

_PLACE, _VELOCITY = ("x", "y", "z"), ("x_dot", "y_dot", "z_dot")

EARLIEST, LATEST = 1700, 2250
"""Years that fit into nanoseconds counted in 64 bits from 1970."""


def epoch_of(text: str) -> np.datetime64:
    """The time to which the first state is given, to a nanosecond. Raises `InputError`."""
    try:
        epoch = np.datetime64(datetime.fromisoformat(text).replace(tzinfo=None), "ns")
    except ValueError:
        raise InputError(f"--epoch {text}: no date; write it like 2030-01-01T00:00:00") from None
    if not EARLIEST <= int(str(epoch)[:4]) <= LATEST:
        raise InputError(f"--epoch {text}: outside the years {EARLIEST} to {LATEST}")
    return epoch


def ephemeris_text(trajectory: Trajectory, units: Units | None, epoch: np.datetime64) -> str:
    """The message: km and km/s in the rotating frame, times TDB.

    The restricted three-body problem knows no date: `epoch` is the label of time 0. Raises `InputError` where there
    is no length in km, and `ModuleNotFoundError` where ccsds-ndm is not installed.
    """
    if trajectory.source.system not in THREE_BODY:
        raise InputError(f"--oem: {trajectory.source.system.name} has no orbits in space; leave it out")
    if units is None:
        raise InputError(
            "--oem: its lengths are km; add --units km, with --lunit and --tunit where the file names none"
        )
    span = float(trajectory.times[-1]) * units.time
    if span > 3e9:
        raise InputError(f"--oem: {span:.1e} s are too long for dates; write fewer periods")
    from ccsds_ndm.models.ndmxml4 import ndmxml_4_0_0_common_4_0 as common
    from ccsds_ndm.models.ndmxml4 import ndmxml_4_0_0_oem_3_0 as oem
    from ccsds_ndm.models.ndmxml4.ndmxml_4_0_0_master_4_0 import Oem
    from ccsds_ndm.ndm_io import NDMFileFormats, NdmIo

    dates = [_date(epoch, seconds) for seconds in trajectory.times * units.time]
    places = trajectory.states[:, :3] * units.length
    velocities = trajectory.states[:, 3:] * units.velocity
    states = [
        common.StateVectorAccType(
            epoch=date,
            **{name: common.PositionTypeUo(value=_short(value)) for name, value in zip(_PLACE, place, strict=True)},
            **{
                name: common.VelocityTypeUo(value=_short(value))
                for name, value in zip(_VELOCITY, velocity, strict=True)
            },
        )
        for date, place, velocity in zip(dates, places.tolist(), velocities.tolist(), strict=True)
    ]
    bodies = trajectory.source.primaries or ("larger primary", "smaller primary")
    pair = "-".join(bodies).upper().replace(" ", "_")
    metadata = oem.OemMetadata(
        comment=[
            f"REF_FRAME: turns with the bodies, x from {bodies[0]} to {bodies[1]}, z normal to their orbits",
            "TIME: the circular restricted three-body problem has no date; START_TIME is a label",
        ],
        object_name=trajectory.source.title,
        object_id="NONE",
        center_name=f"{pair} BARYCENTER",
        ref_frame=f"{pair}_ROTATING",
        time_system="TDB",
        start_time=dates[0],
        stop_time=dates[-1],
    )
    header = common.OdmHeader(
        comment=[line[:LONGEST_LINE] for line in description(trajectory, units)],
        creation_date=datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S"),
        originator="ORBITPROOF",
    )
    segment = oem.OemSegment(metadata=metadata, data=oem.OemData(state_vector=states))
    message = Oem(header=header, body=oem.OemBody(segment=[segment]))
    text = str(NdmIo().to_string(message, NDMFileFormats.KVN))
    return re.sub(r"(?m)^(\d{4}-.*)\n\n(?=\d{4}-)", r"\1\n", text)


def _date(epoch: np.datetime64, seconds: float) -> str:
    return str(epoch + np.timedelta64(round(seconds * 1e9), "ns"))


def _short(value: float) -> float:
    """To 16 digits, the most that the standard allows."""
    return float(f"{value:.15e}")
