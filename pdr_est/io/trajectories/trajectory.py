"""The record of a trajectory as a file has it, and its checks."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.side_tables.fix_table import GEODETIC_COLUMNS, MAP_COLUMNS
from pdr_est.io.side_tables.table_times import LOCAL_TIME
from pdr_est.io.text.number_table import NumberTable

UNNAMED = "track"
"""Name of the device of a trajectory that names none."""

_UNIX_FROM_S = 1e9  # larger times are Unix times, as for position fixes
_FARTHEST_M = 1e8  # of map coordinates, which may be UTM
_COVARIANCE = ("cov_xx_m2", "cov_xy_m2", "cov_yy_m2")


class Clock(StrEnum):
    """Meaning of the times of a trajectory."""

    UNIX = "Unix time"
    LOCAL = "dates without a time zone"
    OWN = "seconds from a start of its own"


@dataclass(frozen=True)
class Trajectory:
    """Positions over time as a file has them.

    Attributes
    ----------
    place
        The file, for messages.
    format
        "TUM", "table", "GeoJSON" or "GPX".
    time_s
        (n,) s, increasing for each device.
    clock
        Meaning of the times.
    position
        (n, 2) m east and north; or latitude and longitude, degrees.
    in_degrees
        True for latitude and longitude.
    device
        (n,) name of the device or person; `UNNAMED` where the file names none.
    covariance_m2
        (n, 2, 2) m², covariance of the positions; None where the file states none.
    sigma_m
        (n,) m, stated standard deviation of each axis; None where the file has none.
    notes
        Remarks of the reader, in words.
    """

    place: str
    format: str
    time_s: Array
    clock: Clock
    position: Array
    in_degrees: bool
    device: NDArray[np.str_]
    covariance_m2: Array | None = None
    sigma_m: Array | None = None
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Return the number of positions."""
        return len(self.time_s)

    @property
    def devices(self) -> tuple[str, ...]:
        """Names of the devices in order of first appearance."""
        return tuple(dict.fromkeys(map(str, self.device.tolist())))

    @property
    def span_s(self) -> tuple[float, float]:
        """Times of the first and the last position, s."""
        return float(self.time_s.min()), float(self.time_s.max())

    def of_device(self, device: str) -> "Trajectory":
        """Select the positions of one device."""
        keep = self.device == device
        return replace(
            self,
            time_s=self.time_s[keep],
            position=self.position[keep],
            device=self.device[keep],
            covariance_m2=None if self.covariance_m2 is None else self.covariance_m2[keep],
            sigma_m=None if self.sigma_m is None else self.sigma_m[keep],
        )


def trajectory_from_table(table: NumberTable, kind: str, row: str = "line", first: int = 2) -> Trajectory:
    """Make a trajectory of the columns of a table of positions.

    Parameters
    ----------
    table
        Columns as `fix_table.read_position_table` names them.
    kind
        Format, in words.
    row, first
        Name and number of the first row, for messages.

    Raises
    ------
    RecordingError
        For values that are missing or impossible, and for times that do not increase.
    """
    in_degrees = not all(name in table for name in MAP_COLUMNS)
    time_s = table.numbers(LOCAL_TIME if LOCAL_TIME in table else "time_s")
    device = np.char.strip(table.texts("device")) if "device" in table else np.full(len(table), "")
    covariance = None
    if all(name in table for name in _COVARIANCE):
        xx, xy, yy = (table.numbers(name) for name in _COVARIANCE)
        covariance = np.stack([np.stack([xx, xy], axis=1), np.stack([xy, yy], axis=1)], axis=1)
    trajectory = Trajectory(
        place=table.place,
        format=kind,
        time_s=time_s,
        clock=Clock.LOCAL if LOCAL_TIME in table else clock_of(time_s),
        position=table.stack(GEODETIC_COLUMNS if in_degrees else MAP_COLUMNS),
        in_degrees=in_degrees,
        device=np.where(device == "", UNNAMED, device),
        covariance_m2=covariance,
        sigma_m=table.numbers("sigma_m") if "sigma_m" in table else None,
    )
    check_trajectory(trajectory, [f"{table.place}, {row} {i + first}" for i in range(len(table))])
    return trajectory


def clock_of(time_s: Array) -> Clock:
    """Tell Unix times (n,), s, from others by their size."""
    finite = time_s[np.isfinite(time_s)]
    return Clock.UNIX if len(finite) and float(np.median(finite)) >= _UNIX_FROM_S else Clock.OWN


def check_trajectory(trajectory: Trajectory, rows: list[str]) -> None:
    """Refuse positions and times that cannot be used.

    Parameters
    ----------
    trajectory
        The trajectory.
    rows
        (n,) words for the place of each position.

    Raises
    ------
    RecordingError
        For no position, a value that is missing or out of range, a covariance that is not positive semidefinite, and
        times of a device that do not increase.
    """
    if not len(trajectory):
        raise RecordingError(f"{trajectory.place}: contains no position: give the file of a trajectory")
    unusable = np.flatnonzero(~np.isfinite(np.column_stack([trajectory.time_s, trajectory.position])).all(axis=1))
    if len(unusable):
        raise RecordingError(f"{rows[unusable[0]]}: time or position is missing: complete or remove it")
    _check_ranges(trajectory, rows)
    for device in trajectory.devices:
        own = np.flatnonzero(trajectory.device == device)
        back = np.flatnonzero(np.diff(trajectory.time_s[own]) <= 0.0)
        if len(back):
            before, after = trajectory.time_s[own[back[0]]], trajectory.time_s[own[back[0] + 1]]
            raise RecordingError(
                f"{rows[own[back[0] + 1]]}: time {after:.3f} s is not after {before:.3f} s of the position before: "
                "sort the positions by time, one for each time, and give one walk a file"
            )


def _check_ranges(trajectory: Trajectory, rows: list[str]) -> None:
    size = np.abs(trajectory.position)
    limits = (90.0, 360.0) if trajectory.in_degrees else (_FARTHEST_M, _FARTHEST_M)
    far = np.flatnonzero((size > np.array(limits)).any(axis=1))
    if len(far):
        first, second = trajectory.position[far[0]]
        what = "latitude and longitude" if trajectory.in_degrees else "a position in metres"
        remedy = "check whether they are swapped" if trajectory.in_degrees else "give metres"
        raise RecordingError(f"{rows[far[0]]}: {first:g}, {second:g} is not {what}: {remedy}")
    if trajectory.sigma_m is not None:
        wrong = np.flatnonzero(trajectory.sigma_m < 0.0)
        if len(wrong):
            value = trajectory.sigma_m[wrong[0]]
            raise RecordingError(f"{rows[wrong[0]]}: sigma_m = {value:g}: give a number of metres, not below 0")
    if trajectory.covariance_m2 is not None:
        (xx, xy), (_, yy) = np.moveaxis(trajectory.covariance_m2, 0, 2)
        # Rounded numbers of a degenerate ellipse may be indefinite by their last digit.
        wrong = np.flatnonzero((xx < 0.0) | (yy < 0.0) | (xy * xy > xx * yy * (1.0 + 1e-6) + 1e-12))
        if len(wrong):
            i = wrong[0]
            raise RecordingError(
                f"{rows[i]}: covariance {xx[i]:g}, {xy[i]:g}, {yy[i]:g} is not positive semidefinite: correct it or "
                "leave the columns out"
            )
