"""Read tables whose columns a person has named (`--map`), in one file or in several."""

from collections.abc import Sequence

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.plain_csv.reader import NAME, recording_of_devices, tables_with_motion
from pdr_est.io.formats.sensor_files.grouping import by_device
from pdr_est.io.tables.device import read_devices
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.signals import HEAD_BYTES, layout_of
from pdr_est.io.tables.split.reader import DeviceTables, read_tables
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem, require_single_walk
from pdr_est.types.recording import Recording


def read_mapped(source: Source, mapping: TableMapping, chosen: Sequence[str] = ()) -> Recording:
    """Read the walk of tables whose columns a person has named.

    Parameters
    ----------
    source
        Source with the files that the mapping names. Where it names none, the only table is read: of several members
        the one that holds a table with motion, or the only table where none looks like motion.
    mapping
        Meaning of the columns.
    chosen
        Names of the devices, persons or sessions whose rows are wanted; all without names.

    Raises
    ------
    RecordingError
        When there are several tables, or a file or column of the mapping is absent.
    """
    names = list(dict.fromkeys(part.file for part in mapping.parts if part.file))
    if names:
        devices = by_device([_read_file(source, name, mapping, chosen) for name in names])
        stem = member_stem(source.name) if source.path.is_file() else source.name
        return recording_of_devices(stem, read_devices(devices, RawDevice({})))
    members = source.members
    if len(members) > 1:
        tables = tuple(member for member in members if layout_of(source.head(member, HEAD_BYTES)) is not None)
        members = tables_with_motion(source) or tables
    member = require_single_walk(source, members, NAME)
    devices = read_tables(source.read(member), source.place(member), mapping=mapping, chosen=chosen)
    return recording_of_devices(member_stem(member), read_devices(devices, RawDevice({})))


def _read_file(source: Source, name: str, mapping: TableMapping, chosen: Sequence[str]) -> tuple[DeviceTables, ...]:
    """Read a file that the mapping names."""
    plain = name.casefold().removesuffix(".gz")
    found = [m for m in source.members if plain in (m.casefold(), m.casefold().rpartition("/")[2])]
    if len(found) != 1:
        fault = "which is not there" if not found else f"of which there are {len(found)}"
        raise RecordingError(
            f"{source.path}: the mapping names the file {name!r}, {fault}; there are {', '.join(source.members[:9])}"
        )
    parts = tuple(part for part in mapping.parts if part.file == name)
    stated = TableMapping(parts=parts, given=True)
    return read_tables(source.read(found[0]), source.place(found[0]), mapping=stated, chosen=chosen)
