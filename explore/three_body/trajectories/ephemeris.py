"""States of a spacecraft over dates, as CCSDS Orbit Ephemeris Messages (CCSDS 502.0-B-3, key = value notation)."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.three_body.trajectories.csv_file import BODIES, description
from orbitproof.explore.three_body.trajectories.interpolation import DEGREE, WINDOW, largest_error
from orbitproof.explore.three_body.trajectories.sampling import SampledOrbit
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import THREE_BODY

LONGEST_LINE = 240
"""The standard allows 254 characters a line, the keyword included."""

_PLACE, _VELOCITY = ("x", "y", "z"), ("x_dot", "y_dot", "z_dot")

EARLIEST, LATEST = 1700, 2250
"""Years that fit into nanoseconds counted in 64 bits from 1970."""

J2000 = np.datetime64("2000-01-01T12:00:00", "ns")

_ROUNDED = 1e-6
"""km: what the rounding of dates and digits may add to the error of an interpolation."""


@dataclass(frozen=True)
class Ephemeris:
    """States of one spacecraft in km and km/s, as files for other tools hold them.

    Attributes:
        title: of the object.
        epoch: TDB, of time 0.
        times: shape (N,), s past the epoch.
        states: shape (N, 6).
        error: of the interpolation, km; `None` for fewer than four states.
        origin, frame: names of the centre and of the axes.
        head, remarks: what it is, and what frame and dates mean, as lines of text.
        states_at: the same at other times.
    """

    title: str
    epoch: np.datetime64
    times: Vector
    states: Matrix
    error: float | None
    origin: str
    frame: str
    head: tuple[str, ...]
    remarks: tuple[str, ...]
    states_at: Callable[[Vector], Matrix]

    @property
    def seconds(self) -> Vector:
        """TDB seconds past J2000, shape (N,)."""
        return seconds_of(self.epoch) + self.times


def epoch_of(text: str) -> np.datetime64:
    """The time to which the first state is given, to a nanosecond. Raises `InputError`."""
    try:
        epoch = np.datetime64(datetime.fromisoformat(text).replace(tzinfo=None), "ns")
    except ValueError:
        raise InputError(f"--epoch {text}: no date; write it like 2030-01-01T00:00:00") from None
    if not EARLIEST <= int(str(epoch)[:4]) <= LATEST:
        raise InputError(f"--epoch {text}: outside the years {EARLIEST} to {LATEST}")
    return epoch


def seconds_of(epoch: np.datetime64) -> float:
    """TDB seconds past J2000."""
    return float((epoch - J2000) / np.timedelta64(1, "ns")) * 1e-9


def ephemeris_of(samples: SampledOrbit, epoch: np.datetime64, option: str = "--oem") -> Ephemeris:
    """A sampled orbit of the restricted three-body problem with dates, which that problem does not know: labels.

    Raises `InputError`, about `option`, where there is no length in km.
    """
    source, units = samples.trajectory.source, samples.units
    if source.system not in THREE_BODY:
        raise InputError(f"{option}: {source.system.name} has no orbits in space; leave it out")
    if units is None:
        raise InputError(
            f"{option}: its lengths are km; add --units km, with --lunit and --tunit where the file names none"
        )
    if samples.times[-1] > 3e9:
        raise InputError(f"{option}: {samples.times[-1]:.1e} s are too long for dates; write fewer periods")
    bodies = source.primaries or BODIES
    pair = "-".join(bodies).upper().replace(" ", "_")
    origin = {"barycentre": f"{pair} BARYCENTER", "larger": bodies[0].upper(), "smaller": bodies[1].upper()}
    return Ephemeris(
        source.title,
        epoch,
        samples.times,
        samples.states,
        samples.error,
        origin[samples.frame.origin],
        f"{pair}_{samples.frame.axes.upper()}",
        tuple(description(samples)),
        (
            f"REF_FRAME: {samples.frame.described(bodies)}",
            "TIME: the circular restricted three-body problem has no date; START_TIME is a label",
        ),
        samples.states_at,
    )


def ephemeris_text(ephemeris: Ephemeris) -> str:
    """The message, times TDB. Raises `ModuleNotFoundError` where ccsds-ndm is not installed."""
    from ccsds_ndm.models.ndmxml4 import ndmxml_4_0_0_common_4_0 as common
    from ccsds_ndm.models.ndmxml4 import ndmxml_4_0_0_oem_3_0 as oem
    from ccsds_ndm.models.ndmxml4.ndmxml_4_0_0_master_4_0 import Oem
    from ccsds_ndm.ndm_io import NDMFileFormats, NdmIo

    dates = [_date(ephemeris.epoch, seconds) for seconds in ephemeris.times]
    states = [
        common.StateVectorAccType(
            epoch=date,
            **{name: common.PositionTypeUo(value=_short(value)) for name, value in zip(_PLACE, state[:3], strict=True)},
            **{
                name: common.VelocityTypeUo(value=_short(value))
                for name, value in zip(_VELOCITY, state[3:], strict=True)
            },
        )
        for date, state in zip(dates, ephemeris.states.tolist(), strict=True)
    ]
    interpolated = {} if len(dates) < WINDOW else {"interpolation": "HERMITE", "interpolation_degree": DEGREE}
    metadata = oem.OemMetadata(
        comment=list(ephemeris.remarks),
        object_name=ephemeris.title,
        object_id="NONE",
        center_name=ephemeris.origin,
        ref_frame=ephemeris.frame,
        time_system="TDB",
        start_time=dates[0],
        stop_time=dates[-1],
        **interpolated,
    )
    header = common.OdmHeader(
        comment=[line[:LONGEST_LINE] for line in ephemeris.head],
        creation_date=datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S"),
        originator="ORBITPROOF",
    )
    segment = oem.OemSegment(metadata=metadata, data=oem.OemData(state_vector=states))
    message = Oem(header=header, body=oem.OemBody(segment=[segment]))
    text = str(NdmIo().to_string(message, NDMFileFormats.KVN))
    return re.sub(r"(?m)^(\d{4}-.*)\n\n(?=\d{4}-)", r"\1\n", text)


def error_of_message(text: str, ephemeris: Ephemeris) -> float | None:
    """The error of the interpolation, km, of what a message says when it is read; `None` for fewer than four states.

    Raises `InputError` if it is larger than stated: the file is not what it should be.
    """
    if ephemeris.error is None:
        return None
    from ccsds_ndm.ndm_io import NdmIo

    (segment,) = NdmIo().from_string(text).body.segment
    rows = segment.data.state_vector
    dates = np.array([np.datetime64(row.epoch, "ns") for row in rows])
    times = (dates - ephemeris.epoch) / np.timedelta64(1, "ns") * 1e-9
    states = np.array([[float(getattr(row, name).value) for name in _PLACE + _VELOCITY] for row in rows])
    found = largest_error(ephemeris.states_at, times, states)
    if not found <= 1.01 * ephemeris.error + _ROUNDED:
        raise InputError(f"--oem: read back, its error is {found:.1e} km, not {ephemeris.error:.1e}; write it again")
    return found


def _date(epoch: np.datetime64, seconds: float) -> str:
    return str(epoch + np.timedelta64(round(seconds * 1e9), "ns"))


def _short(value: float) -> float:
    """To 16 digits, the most that the standard allows."""
    return float(f"{value:.15e}")
