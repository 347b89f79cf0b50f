"""Write tracks as plain tables of poses for programs that compare trajectories.

These formats hold one trajectory a file. Of a track of several devices the first one gets the file; every further
device is written beside it to `<stem>-<device><suffix>`. Where the walker stands, a line more says when the next step
begins: other programs take the walker to move evenly between two lines. Every writer raises OutputError when a file
cannot be written.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.io.writers.standing_poses import with_standing_poses
from pdr_est.output.atomic_output import text_output
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.track import Track

ISO21134_COLUMNS = ("timestamp", "x", "y", "yaw", "floor")

_COVARIANCE_HEADER = (
    "# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 Pr33 Pt11 Pt12 Pt13 Pt22 Pt23 Pt33\n"
)


def write_tum(track: Track, path: str | Path, epoch_s: float | None = None) -> tuple[Path, ...]:
    """Write the poses as `time x y z qx qy qz qw` lines, the format of the TUM RGB-D benchmark that evo reads.

    z is 0, and the quaternion rotates by the heading about z.

    Parameters
    ----------
    track
        Track of one or more devices.
    path
        File of the first device.
    epoch_s
        Unix time of time zero. When it is given, times are Unix times, else seconds of the recording.

    Returns
    -------
    tuple of Path
        The files written.
    """
    return _write_devices(track, path, lambda one: (f"{pose}\n" for pose in _tum_poses(one, epoch_s or 0.0)))


def write_tum_truth(truth: TruePositions, path: str | Path, epoch_s: float | None = None) -> None:
    """Write the true positions as a TUM file; their orientation is unknown and written as the identity.

    Parameters
    ----------
    truth
        Reference positions.
    path
        File to write.
    epoch_s
        Unix time of time zero, as for `write_tum`.
    """
    order = np.argsort(truth.time_s, kind="stable")
    rows = zip(truth.time_s[order].tolist(), truth.position_m[order].tolist(), strict=True)
    with text_output(path) as stream:
        stream.writelines(f"{(epoch_s or 0.0) + time:.6f} {x:.4f} {y:.4f} 0 0 0 0 1\n" for time, (x, y) in rows)


def write_tum_covariance(track: Track, path: str | Path, epoch_s: float | None = None) -> tuple[Path, ...]:
    """Write TUM poses followed by their covariance, as ov_eval, the evaluation of OpenVINS, reads them.

    After the eight TUM columns stand the upper triangles of the covariance of the orientation, rad², of which only
    the variance of the heading about z is known, and of the position, m². What belongs to z, roll and pitch is 0,
    since they are not estimated.

    Parameters
    ----------
    track
        Track of one or more devices.
    path
        File of the first device.
    epoch_s
        Unix time of time zero, as for `write_tum`.

    Returns
    -------
    tuple of Path
        The files written.
    """

    def lines(one: Track) -> Iterator[str]:
        yield _COVARIANCE_HEADER
        for i, pose in enumerate(_tum_poses(one, epoch_s or 0.0)):
            heading = one.sigma_heading_rad[i] ** 2
            (xx, xy), (_, yy) = one.covariance_m2[i]
            yield f"{pose} 0 0 0 0 0 {heading:.9g} {xx:.9g} {xy:.9g} 0 {yy:.9g} 0 0\n"

    return _write_devices(track, path, lines)


def write_iso21134(track: Track, path: str | Path, epoch_s: float | None = None) -> tuple[Path, ...]:
    """Write a CSV table with the columns `timestamp,x,y,yaw,floor` that benchmarks in the style of ISO/IEC 21134 use.

    timestamp is in seconds, x and y in metres, yaw in radians counter-clockwise from east in [-pi, pi). floor is the
    number of the floor, counted from that at the start, and an empty cell where it is not known.

    Parameters
    ----------
    track
        Track of one or more devices.
    path
        File of the first device.
    epoch_s
        Unix time of time zero, as for `write_tum`.

    Returns
    -------
    tuple of Path
        The files written.
    """

    def lines(one: Track) -> Iterator[str]:
        yield ",".join(ISO21134_COLUMNS) + "\n"
        floors = [""] * len(one) if one.height is None else one.height.floor[one.height.nearest(one.time_s)].tolist()
        rows = zip(one.time_s, one.position_m, wrap_angle(one.heading_rad), floors, strict=True)
        for time_s, (x, y), yaw, floor in rows:
            yield f"{(epoch_s or 0.0) + time_s:.6f},{x:.4f},{y:.4f},{yaw:.6f},{floor}\n"

    return _write_devices(track, path, lines)


def _tum_poses(track: Track, epoch_s: float) -> Iterator[str]:
    half_heading: Array = wrap_angle(track.heading_rad) / 2.0
    qz, qw = np.sin(half_heading), np.cos(half_heading)
    for i in range(len(track)):
        x, y = track.position_m[i]
        yield f"{epoch_s + track.time_s[i]:.6f} {x:.4f} {y:.4f} 0 0 0 {qz[i]:.9f} {qw[i]:.9f}"


def _write_devices(track: Track, path: str | Path, lines: Callable[[Track], Iterable[str]]) -> tuple[Path, ...]:
    """Write the lines of each device to a file of its own."""
    first = Path(path)
    files: dict[Path, str] = {}
    for number, device in enumerate(track.devices):
        file = first
        if number:
            name = re.sub(r"[^\w.-]+", "_", device)
            file = first.with_name(f"{first.stem}-{name}{first.suffix}")
        if file in files:
            file = file.with_name(f"{file.stem}-{number + 1}{file.suffix}")
        files[file] = device
    for file, device in files.items():
        with text_output(file) as stream:
            stream.writelines(lines(with_standing_poses(track.of_device(device))))
    return tuple(files)
