"""Read tables of one phone: the project's own format, and whatever else has a time and three axes.

How titles are understood stands in `pdr_est.io.tables`. There is one row for each time stamp; a cell is empty where a
sensor has no sample. Units and signs come from the documented header or a unit in the title, else they are detected
from the values.
"""

from collections.abc import Sequence

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.tables.device import DeviceReading, read_devices
from pdr_est.io.tables.recognition import Evidence, motion_evidence
from pdr_est.io.tables.signals import HEAD_BYTES
from pdr_est.io.tables.split.reader import read_tables
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem, require_single_walk
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import Recording

NAME = "plain CSV"


def sniff(source: Source) -> bool:
    """Tell whether a member is a table with a time and all axes of an accelerometer or gyroscope."""
    return bool(tables_with_motion(source))


def read_source(source: Source) -> Recording:
    """Read the walk of a plain table.

    Raises
    ------
    RecordingError
        For several tables, for rows of several walks, and when neither accelerometer nor gyroscope has values.
    """
    return read_chosen(source, ())


def read_chosen(source: Source, chosen: Sequence[str]) -> Recording:
    """Read the walk of a plain table, of the chosen devices only where it has rows of several.

    Parameters
    ----------
    source
        Source with the table.
    chosen
        Names of the devices, persons or sessions whose rows are wanted; all without names.

    Raises
    ------
    RecordingError
        For several tables, for rows of several walks, and when neither accelerometer nor gyroscope has values.
    """
    return _read(source, require_single_walk(source, tables_with_motion(source), NAME), chosen)


def tables_with_motion(source: Source) -> tuple[str, ...]:
    """List the members with motion: those whose titles say so, else those whose values look like it."""
    evidence = {
        member: motion_evidence(source.head(member, HEAD_BYTES), member_stem(member)) for member in source.members
    }
    strongest = max(evidence.values(), default=Evidence.NONE)
    if strongest is Evidence.NONE:
        return ()
    return tuple(member for member, found in evidence.items() if found is strongest)


def _read(source: Source, member: str, chosen: Sequence[str]) -> Recording:
    stem = member_stem(member)
    device = RawDevice({})
    unused = [other for other in source.members if other != member]
    device.decisions += [f"files not used: {', '.join(unused)}"] if unused else []
    devices = read_tables(source.read(member), source.place(member), hint=sensor_by_name(stem), chosen=chosen)
    return recording_of_devices(stem, read_devices(devices, device))


def recording_of_devices(name: str, readings: Sequence[DeviceReading]) -> Recording:
    """Make the recording of the devices of plain tables; fixes and date are those of the first one."""
    first = readings[0]
    return Recording(
        name=name,
        format=NAME,
        devices=tuple(reading.device for reading in readings),
        truth=Truth(positions=next((one.true_positions for one in readings if one.true_positions is not None), None)),
        fixes=first.gnss.fixes,
        origin=first.gnss.origin,
        epoch_s=first.epoch_s,
        local_epoch_s=first.local_epoch_s,
    )
