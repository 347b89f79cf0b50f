"""Recognise the format of a trajectory by its content, and read it."""

from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.io.side_tables.fix_table import TRAJECTORY_COLUMNS, read_position_table
from pdr_est.io.text.container import Source
from pdr_est.io.trajectories.geo_files import read_geojson_trajectory, read_gpx
from pdr_est.io.trajectories.trajectory import Trajectory, trajectory_from_table
from pdr_est.io.trajectories.tum import is_tum, read_tum

_HEAD_BYTES = 4096
_BOM = b"\xef\xbb\xbf"


def read_trajectory(path: str | Path) -> Trajectory:
    """Read a trajectory from a file of the formats TUM, CSV (any separator), GeoJSON or GPX, plain or gzipped.

    A table needs a header with a time and `x`, `y` in metres or `latitude`, `longitude`; the names may be those of a
    table of fixes, and units in them are used. `track.csv` and the columns `timestamp,x,y,yaw,floor` of ISO/IEC 21134
    are such tables. Times may be seconds from any start, Unix times or dates.

    Returns
    -------
    Trajectory
        Times and positions as the file has them.

    Raises
    ------
    RecordingError
        For a file that is missing, damaged or of another format, naming place, value and remedy.
    """
    source = Source.open(path)
    if len(source.members) != 1:
        raise RecordingError(
            f"{source.path}: contains {len(source.members)} files: give the file of the trajectory itself"
        )
    member = source.members[0]
    place = source.place(member)
    head = source.head(member, _HEAD_BYTES).removeprefix(_BOM)
    begin = head.lstrip()[:1]
    if begin == b"<":
        return read_gpx(source.read(member), place)
    if begin in (b"{", b"["):
        return read_geojson_trajectory(source.read(member), place)
    if is_tum(head) or Path(source.name).suffix.lower() == ".tum":
        return read_tum(source.read(member), place)
    return trajectory_from_table(read_position_table(source, member, TRAJECTORY_COLUMNS), "table")
