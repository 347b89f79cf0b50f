"""Read tables of one phone: the project's own format, and whatever else has a time and three axes.

How titles are understood stands in `pdr_est.io.tables`. There is one row for each time stamp; a cell is empty where a
sensor has no sample. Units and signs come from the documented header or a unit in the title, else they are detected
from the values.
"""

from collections.abc import Sequence

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.tables.device import read_devices
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.recognition import Evidence, motion_evidence
from pdr_est.io.tables.signals import HEAD_BYTES
from pdr_est.io.tables.split.reader import read_tables
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem, require_single_walk
from pdr_est.io.text.table_layout import detect_layout
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import Recording

NAME = "plain CSV"


def sniff(source: Source) -> bool:
    """Tell whether a member is a table with a time and all axes of an accelerometer or gyroscope."""
    return bool(_tables(source))


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
    return _read(source, require_single_walk(source, _tables(source), NAME), None, chosen)


def read_mapped(source: Source, mapping: TableMapping, chosen: Sequence[str] = ()) -> Recording:
    """Read the walk of a table whose columns a person has named.

    Parameters
    ----------
    source
        Source with one table; of several members the one that holds a table with motion is read, or the only table
        where none looks like motion.
    mapping
        Meaning of the columns.
    chosen
        As for `read_chosen`.

    Raises
    ------
    RecordingError
        When there are several tables, or a column of the mapping is absent.
    """
    members = source.members
    if len(members) > 1:
        tables = tuple(member for member in members if detect_layout(source.head(member, HEAD_BYTES)) is not None)
        members = _tables(source) or tables
    return _read(source, require_single_walk(source, members, NAME), mapping, chosen)


def _tables(source: Source) -> tuple[str, ...]:
    """List the members with motion: those whose titles say so, else those whose values look like it."""
    evidence = {
        member: motion_evidence(source.head(member, HEAD_BYTES), member_stem(member)) for member in source.members
    }
    strongest = max(evidence.values(), default=Evidence.NONE)
    if strongest is Evidence.NONE:
        return ()
    return tuple(member for member, found in evidence.items() if found is strongest)


def _read(source: Source, member: str, mapping: TableMapping | None, chosen: Sequence[str]) -> Recording:
    stem = member_stem(member)
    devices = read_tables(
        source.read(member), source.place(member), hint=sensor_by_name(stem), mapping=mapping, chosen=chosen
    )
    readings = read_devices(devices, RawDevice({}))
    first = readings[0]
    return Recording(
        name=stem,
        format=NAME,
        devices=tuple(reading.device for reading in readings),
        truth=Truth(positions=next((one.true_positions for one in readings if one.true_positions is not None), None)),
        fixes=first.gnss.fixes,
        origin=first.gnss.origin,
        epoch_s=first.epoch_s,
        local_epoch_s=first.local_epoch_s,
    )
