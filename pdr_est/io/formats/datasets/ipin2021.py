"""Read walks of the set IPIN 2021 (Hamburg, Galaxy S10): `acc`, `gyr`, `mag` and `bar` without header, and waypoints.

Rows are Unix ms and values, separated by blanks; units and signs are Android's, air pressure is in hPa. `ref` has the
waypoints in UTM, m, which are given relative to the first one.
"""

from dataclasses import replace

from pdr_est.io.formats.sensor_files.grouping import sensor_file_walks
from pdr_est.io.formats.sensor_files.reader import read_sensor_files
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import read_table_signals
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.number_table import read_table
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "IPIN 2021"

_NEEDED = frozenset(("acc", "gyr", "ref"))
_USED = frozenset(("acc", "gyr", "mag", "bar", "ref"))
_WAYPOINT_SIGMA_M = 0.7  # ours: tapped while passing a surveyed point, as in the other sets of waypoints
_PA_PER_HPA = 100.0


def sniff(source: Source) -> bool:
    """Tell whether the source has the files of this set."""
    return {member_stem(member) for member in source.members} >= _NEEDED and "" in sensor_file_walks(source)


def read_source(source: Source) -> Recording:
    """Read the walk: one phone, with the waypoints as reference.

    Raises
    ------
    RecordingError
        When a file is damaged.
    """
    recording = read_sensor_files(source, sensor_file_walks(source)[""])
    by_stem = {member_stem(member): member for member in source.members}
    device = replace(
        recording.devices[0],
        platform="android",
        pressure=_pressure(source, by_stem, recording),
        decisions=_decisions(recording.devices[0], source),
    )
    return replace(
        recording,
        format=NAME,
        devices=(device,),
        truth=Truth(positions=_waypoints(source, by_stem["ref"], recording.epoch_s or 0.0)),
    )


def _decisions(device: DeviceRecording, source: Source) -> tuple[str, ...]:
    """Say what the files are used for that hold no sensor with axes."""
    unused = [member for member in source.members if member_stem(member) not in _USED]
    kept = tuple(text for text in device.decisions if not text.startswith("files not used"))
    told = (f"files not used: {', '.join(unused)}",) if unused else ()
    return (*told, *kept, "the reference is ref, the air pressure bar, in hPa")


def _pressure(source: Source, by_stem: dict[str, str], recording: Recording) -> Signal | None:
    if "bar" not in by_stem or recording.epoch_s is None:
        return None
    member = by_stem["bar"]
    table = read_table_signals(source.read(member), source.place(member), hint=Quantity.PRESSURE)
    raw = table.signals.get(Quantity.PRESSURE)
    if raw is None or table.clock.epoch_s is None:
        return None
    shift_s = table.clock.epoch_s - recording.epoch_s
    return Signal(raw.signal.time_s + shift_s, raw.signal.values * _PA_PER_HPA)


def _waypoints(source: Source, member: str, epoch_s: float) -> TruePositions:
    table = read_table(source.read(member), source.place(member), separator=" ", has_header=False)
    time_s = table.numbers(table.names[0]) / 1e3 - epoch_s
    position_m = table.stack(table.names[1:3])
    return TruePositions(time_s, position_m - position_m[0], _WAYPOINT_SIGMA_M, "waypoints")
