"""Files for other programs from the lines that `pdr-est track` has written."""

import json
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.online.update import Update, track_of
from pdr_est.output.atomic_output import place_of_file, staged_file
from pdr_est.report.walk.earth_placement import EarthPlacement, place_on_earth
from pdr_est.report.walk.track_formats import TRACK_FORMATS, WrittenTrack, write_track_formats
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track


class OnlineTrackFiles:
    """Files in some formats beside the file of estimates of an online track, with its stem.

    Parameters
    ----------
    lines
        File of estimates.
    formats
        Names of formats.
    overwrite
        True if existing files may be replaced.
    inputs
        Files and folders that are read and never overwritten.

    Raises
    ------
    OutputError
        If one of the files exists and may not be replaced, or is an input.
    """

    def __init__(self, lines: Path, formats: tuple[str, ...], overwrite: bool, inputs: tuple[Path, ...]) -> None:
        self._lines, self._formats, self._overwrite, self._inputs = lines, formats, overwrite, inputs
        for name in formats:  # before the work begins
            place_of_file(lines.with_name(f"{lines.stem}{TRACK_FORMATS[name].suffix}"), overwrite, inputs)

    def require_possible(self, recording: Recording, config: Config) -> None:
        """Refuse formats that need a place on the Earth if the filter does not know it from the beginning.

        Raises
        ------
        RecordingError
            If latitude and longitude, the position at the start or the heading there are unknown.
        """
        earthly = [name for name in self._formats if TRACK_FORMATS[name].on_earth]
        earth = _placement(_EMPTY, recording, config)
        if earthly and earth.origin is None:
            raise RecordingError(f"{recording.name}: {', '.join(earthly)} cannot be written: {earth.meaning}")

    def write(self, recording: Recording, fixes: tuple[PositionFix, ...], config: Config) -> None:
        """Write the files, of the delayed estimates if there are any.

        Parameters
        ----------
        recording
            Recording that was tracked.
        fixes
            Position fixes to draw.
        config
            Configuration of the run.

        Raises
        ------
        OutputError
            If a file cannot be written.
        """
        updates = list(_updates(self._lines))
        delayed = any(update.kind == "delayed" for update in updates)
        track = track_of(updates, "delayed" if delayed else "filtered")
        one = WrittenTrack(track, _placement(track, recording, config), recording, fixes)
        with TemporaryDirectory() as folder:  # the names of further devices' files are known only afterwards
            write_track_formats(one, Path(folder), self._lines.stem, self._formats)
            for file in sorted(Path(folder).iterdir()):
                with staged_file(self._lines.with_name(file.name), self._overwrite, self._inputs) as staging:
                    staging.write_bytes(file.read_bytes())


_EMPTY = Track(
    *(np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.str_), np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2, 2))),
    *(np.zeros(0), np.zeros(0, dtype=np.int8), np.zeros(0)),
    kind="filtered",
    estimator="ekf",
)


def _placement(track: Track, recording: Recording, config: Config) -> EarthPlacement:
    """Place an online track, whose first poses lie on the map only if the start was known."""
    start = config.start.pose()
    if recording.origin is not None and (start.position_m is None or start.heading_rad is None):
        words = (
            "online, the first poses have no place on the Earth unless position and heading at the start are known: "
            "give --start and --heading, or use `pdr-est smooth`"
        )
        return EarthPlacement(track, None, words)
    return place_on_earth(track, "map", recording, config.fixes)


def _updates(lines: Path) -> Iterator[Update]:
    with lines.open(encoding="utf-8") as stream:
        for line in stream:
            yield _update(json.loads(line))


def _update(row: dict[str, Any]) -> Update:
    return Update(
        device=row["device"],
        time_s=row["time_s"],
        position_m=np.array([row["x_m"], row["y_m"]]),
        covariance_m2=np.array([[row["cov_xx_m2"], row["cov_xy_m2"]], [row["cov_xy_m2"], row["cov_yy_m2"]]]),
        heading_rad=row["heading_rad"],
        sigma_heading_rad=row["sigma_heading_rad"],
        kind=row["kind"],
        step_length_m=row["step_length_m"],
        mode=CarryingMode[row["mode"]],
        moving_from_s=row["time_s"],  # not in the lines, and in no format
        height_m=row.get("height_m"),
        sigma_height_m=row.get("sigma_height_m"),
        floor=row.get("floor"),
        floor_probability=row.get("floor_probability"),
    )
