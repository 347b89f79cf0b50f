"""The track of a walk: what every estimator returns, with its canonical table."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.steps import CarryingMode

COLUMNS = (
    "time_s",
    "device",
    "x_m",
    "y_m",
    "heading_rad",
    "cov_xx_m2",
    "cov_xy_m2",
    "cov_yy_m2",
    "sigma_heading_rad",
    "mode",
    "step_length_m",
)


_ROW_FIELDS = (
    "time_s",
    "moving_from_s",
    "device",
    "position_m",
    "heading_rad",
    "covariance_m2",
    "sigma_heading_rad",
    "mode",
    "step_length_m",
)


@dataclass(frozen=True)
class Track:
    """Poses at the ends of the steps, the start first, device by device.

    time_s: (n,) s on the recording's clock; moving_from_s: (n,) when the movement towards this pose began (the
    walker stands still before it); device: (n,) names; position_m: (n, 2) east and north;
    covariance_m2: (n, 2, 2) in the map frame; heading_rad: (n,) counter-clockwise from east;
    sigma_heading_rad, step_length_m: (n,); mode: (n,) values of CarryingMode.
    kind: "filtered" (each pose from the past only), "smoothed" (from the whole walk) or "delayed" (from the past and
    a fixed time after it). length_scale: the walker's estimated step
    length over the model's, with its standard deviation.
    """

    time_s: Array
    moving_from_s: Array
    device: NDArray[np.str_]
    position_m: Array
    heading_rad: Array
    covariance_m2: Array
    sigma_heading_rad: Array
    mode: NDArray[np.int8]
    step_length_m: Array
    kind: str
    estimator: str
    length_scale: float = 1.0
    sigma_length_scale: float = 0.0

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def devices(self) -> tuple[str, ...]:
        """Device names in order of first appearance."""
        return tuple(dict.fromkeys(str(name) for name in self.device))

    @property
    def distance_m(self) -> float:
        """Length of the polyline through the poses, summed over devices."""
        legs = np.linalg.norm(np.diff(self.position_m, axis=0), axis=1)
        return float(legs[self.device[1:] == self.device[:-1]].sum())

    def of_device(self, device: str) -> "Track":
        """The poses of one device."""
        return self.rows_where(self.device == device)

    def rows_where(self, keep: NDArray[np.bool_]) -> "Track":
        """The poses where keep (n,) is true."""
        return replace(self, **{name: getattr(self, name)[keep] for name in _ROW_FIELDS})

    def at(self, time_s: Array) -> tuple[Array, Array]:
        """Positions (k, 2) and covariances (k, 2, 2) at some times, linear between poses.

        One device only. Between two steps the walker stands until the next step begins. Times outside the
        track take its first or last pose.
        """
        if len(self.devices) > 1:
            raise ValueError(f"the track has several devices {self.devices}: choose one with of_device()")
        before, after, share = legs_at(self.time_s, self.moving_from_s, np.asarray(time_s, dtype=np.float64))
        position = self.position_m[before] + share[:, None] * (self.position_m[after] - self.position_m[before])
        covariance = self.covariance_m2[before] + share[:, None, None] * (
            self.covariance_m2[after] - self.covariance_m2[before]
        )
        return position, covariance

    def to_csv(self, path: str | Path) -> None:
        """Write the track table, one row a pose, columns `COLUMNS`."""
        with Path(path).open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(COLUMNS)
            for row in self.rows():
                writer.writerow(row)

    def rows(self) -> list[tuple[str | float, ...]]:
        """The rows of the track table, numbers rounded to a tenth of a millimetre or finer."""
        return [
            (
                f"{self.time_s[i]:.6f}",
                str(self.device[i]),
                f"{self.position_m[i, 0]:.4f}",
                f"{self.position_m[i, 1]:.4f}",
                f"{float(wrap_angle(self.heading_rad[i])):.6f}",
                f"{self.covariance_m2[i, 0, 0]:.9g}",
                f"{self.covariance_m2[i, 0, 1]:.9g}",
                f"{self.covariance_m2[i, 1, 1]:.9g}",
                f"{self.sigma_heading_rad[i]:.6g}",
                CarryingMode(int(self.mode[i])).name,
                f"{self.step_length_m[i]:.4f}",
            )
            for i in range(len(self))
        ]


def legs_at(time_s: Array, moving_from_s: Array, at_s: Array) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Which rows a walker is between at times at_s (k,), and the share of the way, each (k,).

    time_s, moving_from_s: (n,) of the rows of one device. The walker stands until the next movement begins, before
    the first row and after the last one.
    """
    after = np.clip(np.searchsorted(time_s, at_s, side="right"), 1, max(len(time_s) - 1, 1))
    if len(time_s) == 1:
        after = np.zeros(len(at_s), dtype=np.int64)
    before = np.maximum(after - 1, 0)
    begin = np.maximum(moving_from_s[after], time_s[before])
    span = np.maximum(time_s[after] - begin, 1e-9)
    return before, after, np.clip((at_s - begin) / span, 0.0, 1.0)


def concatenate(tracks: Sequence[Track]) -> Track:
    """The tracks of several devices as one; kind, estimator and length scale are those of the first."""
    columns: dict[str, Any] = {
        name: np.concatenate([getattr(track, name) for track in tracks]) for name in _ROW_FIELDS
    }
    return replace(tracks[0], **columns)
