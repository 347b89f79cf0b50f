"""Read trajectories in the format of the TUM RGB-D benchmark, which evo and most SLAM programs write."""

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.side_tables.table_times import seconds_in_unit
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.trajectories.trajectory import UNNAMED, Trajectory, check_trajectory, clock_of

WIDTHS = (4, 8, 20)
"""Numbers in a line: `time x y z`, which may be followed by a quaternion, and by the upper triangles of the
covariances of orientation and position, as OpenVINS has them."""

_COVARIANCE_OF_POSITION = (14, 15, 17)  # columns of xx, xy and yy in a line of 20

_UPRIGHT_SHARE = 0.2  # of the way in the plane; stairs rise less than 0.7 of it, and no walk has stairs alone


def is_tum(head: bytes) -> bool:
    """Tell whether the first line that is no comment holds as many numbers, between blanks, as one of TUM."""
    for line in as_utf8(head).decode("utf-8", "replace").splitlines():
        cells = line.split()
        if not cells or cells[0].startswith("#"):
            continue
        return len(cells) in WIDTHS and all(_is_number(cell) for cell in cells)
    return False


def read_tum(data: bytes, place: str) -> Trajectory:
    """Read lines `time x y z` or `time x y z qx qy qz qw`, with covariances or without; x points east and y north, m.

    Lines that begin with # are comments. The heading and z are not used.

    Raises
    ------
    RecordingError
        For a line with another number of values or text, with its number; and as `check_trajectory` does.
    """
    rows: list[list[float]] = []
    covariances: list[list[float]] = []
    places: list[str] = []
    for number, line in enumerate(as_utf8(data).decode("utf-8", "replace").splitlines(), start=1):
        cells = line.split()
        if not cells or cells[0].startswith("#"):
            continue
        where = f"{place}, line {number}"
        if len(cells) not in WIDTHS:
            raise RecordingError(
                f"{where}: {len(cells)} values instead of the 8 of TUM, time x y z qx qy qz qw: complete "
                "or remove the line"
            )
        wrong = [cell for cell in cells if not _is_number(cell)]
        if wrong:
            raise RecordingError(f"{where}: {wrong[0][:60]!r} is not a number: correct it or remove the line")
        numbers = [float(cell) for cell in cells]
        rows.append(numbers[:4])
        covariances.append([numbers[i] for i in _COVARIANCE_OF_POSITION] if len(cells) == WIDTHS[2] else [np.nan] * 3)
        places.append(where)
    values = np.array(rows, dtype=np.float64).reshape(-1, 4)
    xx, xy, yy = np.array(covariances, dtype=np.float64).reshape(-1, 3).T
    known = bool(np.isfinite([xx, xy, yy]).all())
    time_s = values[:, 0] * seconds_in_unit(values[:, 0])
    trajectory = Trajectory(
        place=place,
        format="TUM",
        time_s=time_s,
        clock=clock_of(time_s),
        position=values[:, 1:3],
        in_degrees=False,
        device=np.full(len(values), UNNAMED),
        covariance_m2=np.array([[xx, xy], [xy, yy]]).transpose(2, 0, 1) if known and len(values) else None,
        notes=_doubt_about_up(values),
    )
    check_trajectory(trajectory, places)
    return trajectory


def _doubt_about_up(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> tuple[str, ...]:
    """Say that y may be up, as ARKit and cameras have it, where z varies and y hardly does."""
    if len(values) < 2:
        return ()
    _, y_m, z_m = np.ptp(values[:, 1:4], axis=0)
    if z_m > 1.0 and y_m < _UPRIGHT_SHARE * z_m:
        return (
            f"z varies by {z_m:.1f} m and y only by {y_m:.1f} m: if y is up in this file, as in ARKit's, write its "
            "columns as time x -z y",
        )
    return ()


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
