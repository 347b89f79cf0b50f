"""Read tables of one phone: the project's own format, and whatever else has a time and three axes.

How titles are understood stands in `pdr_est.io.tables`. There is one row for each time stamp; a cell is empty where a
sensor has no sample. Units and signs come from the documented header or a unit in the title, else they are detected
from the values.
"""

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.tables.device import read_device
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.recognition import Evidence, motion_evidence
from pdr_est.io.tables.signals import HEAD_BYTES
from pdr_est.io.tables.split import read_tables
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
        For several tables, and when neither accelerometer nor gyroscope has values.
    """
    return _read(source, require_single_walk(source, _tables(source), NAME), None)


def read_mapped(source: Source, mapping: TableMapping) -> Recording:
    """Read the walk of a table whose columns a person has named.

    Parameters
    ----------
    source
        Source with one table; of several members the one that holds a table with motion is read, or the only table
        where none looks like motion.
    mapping
        Meaning of the columns.

    Raises
    ------
    RecordingError
        When there are several tables, or a column of the mapping is absent.
    """
    members = source.members
    if len(members) > 1:
        tables = tuple(member for member in members if detect_layout(source.head(member, HEAD_BYTES)) is not None)
        members = _tables(source) or tables
    return _read(source, require_single_walk(source, members, NAME), mapping)


def _tables(source: Source) -> tuple[str, ...]:
    """List the members with motion: those whose titles say so, else those whose values look like it."""
    evidence = {
        member: motion_evidence(source.head(member, HEAD_BYTES), member_stem(member)) for member in source.members
    }
    strongest = max(evidence.values(), default=Evidence.NONE)
    if strongest is Evidence.NONE:
        return ()
    return tuple(member for member, found in evidence.items() if found is strongest)


def _read(source: Source, member: str, mapping: TableMapping | None) -> Recording:
    stem = member_stem(member)
    tables = read_tables(source.read(member), source.place(member), hint=sensor_by_name(stem), mapping=mapping)
    reading = read_device(tables, RawDevice({}))
    return Recording(
        name=stem,
        format=NAME,
        devices=(reading.device,),
        truth=Truth(positions=reading.true_positions),
        fixes=reading.gnss.fixes,
        origin=reading.gnss.origin,
        epoch_s=reading.epoch_s,
        local_epoch_s=reading.local_epoch_s,
    )
