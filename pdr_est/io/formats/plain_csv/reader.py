"""Read tables of one phone: the project's own format, and whatever else has a time and three axes.

How titles are understood stands in `pdr_est.io.tables`. There is one row for each time stamp; a cell is empty where a
sensor has no sample. Units and signs come from the documented header or a unit in the title, else they are detected
from the values.
"""

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.tables.device import read_device
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.signals import layout_of, read_table_signals
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import Recording

NAME = "plain CSV"


def sniff(source: Source) -> bool:
    """Tell whether a member is a table whose header names a time and all axes of accelerometer or gyroscope."""
    return bool(find_members(source, _is_table))


def _is_table(head: bytes) -> bool:
    layout = layout_of(head)
    if layout is None or not layout.has_header:
        return False
    mapping = understand_titles(layout.titles, units=layout.units)
    return mapping.has_time and mapping.has_motion


def read_source(source: Source) -> Recording:
    """Read the walk of a plain table.

    Raises
    ------
    RecordingError
        For several tables, and when neither accelerometer nor gyroscope has values.
    """
    member = require_single_walk(source, find_members(source, _is_table), NAME)
    table = read_table_signals(source.read(member), source.place(member))
    reading = read_device((table,), RawDevice({}))
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(reading.device,),
        truth=Truth(positions=reading.true_positions),
        fixes=reading.gnss.fixes,
        origin=reading.gnss.origin,
        epoch_s=reading.epoch_s,
    )
