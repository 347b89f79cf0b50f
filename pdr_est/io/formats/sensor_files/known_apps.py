"""Recognise apps that write one file a sensor, by what is typical of their files."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pdr_est.io.formats.sensor_files.grouping import SensorFile
from pdr_est.io.text.members import member_stem


@dataclass(frozen=True)
class SensorFileApp:
    """App with its conventions.

    Attributes
    ----------
    name
        Name by which people know it.
    platform
        Operating system; empty where it runs on several.
    sign
        Sign of the acceleration; None where the values must tell.
    """

    name: str
    platform: str = ""
    sign: float | None = None


OTHER_APP = SensorFileApp("one file a sensor")


def app_of_files(files: Sequence[SensorFile], heads: Sequence[bytes]) -> SensorFileApp:
    """Return the app that wrote some files, or `OTHER_APP`.

    Parameters
    ----------
    files
        Files of one walk.
    heads
        Their first bytes.
    """
    return next((app for app, fits in _APPS if fits(files, heads)), OTHER_APP)


def _titles_are(*titles: str) -> Callable[[Sequence[SensorFile], Sequence[bytes]], bool]:
    wanted = {title.casefold() for title in titles}
    return lambda files, heads: all(wanted <= _titles(file) for file in files)


def _titles(file: SensorFile) -> set[str]:
    return {title.casefold() for title in file.layout.titles}


def _is_metawear(files: Sequence[SensorFile], heads: Sequence[bytes]) -> bool:
    return all(any(title.startswith("epoc") for title in _titles(file)) for file in files)


def _is_imu_recorder(files: Sequence[SensorFile], heads: Sequence[bytes]) -> bool:
    return all(head.startswith(b"# Created at") for head in heads)


def _is_opencamera(files: Sequence[SensorFile], heads: Sequence[bytes]) -> bool:
    return all(member_stem(file.member).startswith("VID_") and not file.layout.has_header for file in files)


def _is_matlab(files: Sequence[SensorFile], heads: Sequence[bytes]) -> bool:
    stems = {member_stem(file.member).casefold() for file in files}
    known = {"acceleration", "angularvelocity", "magneticfield", "orientation", "position"}
    return stems <= known and all("timestamp" in " ".join(_titles(file)) for file in files)


_APPS: tuple[tuple[SensorFileApp, Callable[[Sequence[SensorFile], Sequence[bytes]], bool]], ...] = (
    (SensorFileApp("Sensor Record", "android", 1.0), _titles_are("Timestamp", "Milliseconds", "X", "Y", "Z")),
    (SensorFileApp("AndroidIMURecorder (RoNIN, RIDI)", "android", 1.0), _is_imu_recorder),
    (SensorFileApp("OpenCamera Sensors", "android", 1.0), _is_opencamera),
    (SensorFileApp("MATLAB Mobile", "", 1.0), _is_matlab),
    (SensorFileApp("MetaWear"), _is_metawear),
    (SensorFileApp("KAIST", "android", 1.0), _titles_are("timeMillis", "timeNanos")),
)
