"""The formats in which the track of a walk is written for other programs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pdr_est.errors import RecordingError
from pdr_est.io.writers.geojson import write_geojson
from pdr_est.io.writers.gpx import write_gpx
from pdr_est.io.writers.kml import write_kml
from pdr_est.io.writers.trajectories import write_iso21134, write_tum, write_tum_covariance, write_tum_truth
from pdr_est.report.walk.earth_placement import EarthPlacement
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin, Recording
from pdr_est.types.track import Track


@dataclass(frozen=True)
class WrittenTrack:
    """Track with everything that its files need.

    Attributes
    ----------
    track
        Track as it was estimated.
    earth
        The same track on the Earth, if it can be placed there.
    recording
        Recording that it was made from.
    fixes
        Position fixes to draw.
    """

    track: Track
    earth: EarthPlacement
    recording: Recording
    fixes: Sequence[PositionFix] = ()

    @property
    def origin(self) -> GeoOrigin:
        """Origin on the Earth.

        Raises
        ------
        RecordingError
            If the track cannot be placed on the Earth.
        """
        if self.earth.origin is None:
            raise RecordingError(f"{self.recording.name}: cannot be placed on the Earth: {self.earth.meaning}")
        return self.earth.origin


@dataclass(frozen=True)
class TrackFormat:
    """Format of a track.

    Attributes
    ----------
    suffix
        What follows the stem in the name of the file.
    write
        Writes a track to the file.
    on_earth
        True for a format that knows only latitude and longitude.
    default
        True if it is written where no format is chosen.
    """

    suffix: str
    write: Callable[[WrittenTrack, Path], object]
    on_earth: bool = False
    default: bool = False


def _write_tum(one: WrittenTrack, path: Path) -> None:
    write_tum(one.track, path, one.recording.epoch_s)
    truth = one.recording.truth.positions
    if truth is not None and len(truth.time_s):
        name = "truth.tum" if path.stem == "track" else f"{path.stem}-truth.tum"
        write_tum_truth(truth, path.with_name(name), one.recording.epoch_s)


def _write_geojson(one: WrittenTrack, path: Path) -> None:
    track, epoch_s = one.earth.track, one.recording.epoch_s
    write_geojson(track, path, one.earth.origin, fixes=one.fixes, epoch_s=epoch_s, with_steps=True)


def _write_kml(one: WrittenTrack, path: Path) -> None:
    recording = one.recording
    write_kml(one.earth.track, path, one.origin, fixes=one.fixes, epoch_s=recording.epoch_s, name=recording.name)


def _write_gpx(one: WrittenTrack, path: Path) -> None:
    recording = one.recording
    write_gpx(one.earth.track, path, one.origin, fixes=one.fixes, epoch_s=recording.epoch_s, name=recording.name)


def _write_covariance(one: WrittenTrack, path: Path) -> None:
    write_tum_covariance(one.track, path, one.recording.epoch_s)


def _write_iso21134(one: WrittenTrack, path: Path) -> None:
    write_iso21134(one.track, path, one.recording.epoch_s)


TRACK_FORMATS: Mapping[str, TrackFormat] = MappingProxyType(
    {
        "tum": TrackFormat(".tum", _write_tum, default=True),
        "geojson": TrackFormat(".geojson", _write_geojson, default=True),
        "kml": TrackFormat(".kml", _write_kml, on_earth=True, default=True),
        "gpx": TrackFormat(".gpx", _write_gpx, on_earth=True, default=True),
        "tum-covariance": TrackFormat("-covariance.txt", _write_covariance),
        "iso21134": TrackFormat("-iso21134.csv", _write_iso21134),
    }
)
"""Formats by their name."""


def result_files(written: Sequence[str]) -> list[str]:
    """List the names of the result files of a walk beside its report, with the track in these formats."""
    return ["track.csv", "steps.csv", "summary.json", *(f"track{TRACK_FORMATS[name].suffix}" for name in written)]


def require_possible_formats(formats: Sequence[str] | None, recording: Recording) -> None:
    """Refuse a recording that has no place on the Earth when a format is chosen that needs one.

    Raises
    ------
    RecordingError
        If latitude and longitude are unknown. Whether north is known shows only at the end of the work.
    """
    earthly = [name for name in formats or () if TRACK_FORMATS[name].on_earth]
    if earthly and recording.origin is None:
        raise RecordingError(
            f"{recording.name}: {', '.join(earthly)} cannot be written, since the recording holds no latitude and "
            "longitude: record GPS as well, or choose another --format, such as geojson, which may be in metres"
        )


def write_track_formats(
    one: WrittenTrack, folder: Path, stem: str = "track", formats: Sequence[str] | None = None
) -> dict[str, Any]:
    """Write a track in some formats.

    Parameters
    ----------
    one
        The track.
    folder
        Existing folder.
    stem
        Beginning of the names of the files.
    formats
        Names of formats; None for the default, in which those that need a place on the Earth are left out where
        there is none.

    Returns
    -------
    dict
        Names of the formats that were `written`, and those `left_out` with the reason in words.

    Raises
    ------
    RecordingError
        If a format that was chosen needs a place on the Earth and there is none.
    OutputError
        If a file cannot be written.
    """
    chosen = [name for name, kind in TRACK_FORMATS.items() if (kind.default if formats is None else name in formats)]
    lost = [name for name in chosen if TRACK_FORMATS[name].on_earth and one.earth.origin is None]
    if lost and formats is not None:
        raise RecordingError(
            f"{one.recording.name}: {', '.join(lost)} cannot be written, since the track cannot be placed on the "
            f"Earth: {one.earth.meaning}; or choose another --format, such as geojson, which may be in metres"
        )
    written = [name for name in chosen if name not in lost]
    for name in written:
        TRACK_FORMATS[name].write(one, folder / f"{stem}{TRACK_FORMATS[name].suffix}")
    reason = f"the track cannot be placed on the Earth: {one.earth.meaning}"
    return {"written": written, "left_out": dict.fromkeys(lost, reason)}
