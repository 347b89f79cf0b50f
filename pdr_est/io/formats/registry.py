"""Find the format of a recording by its content, and read it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol, runtime_checkable

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.clock_faults import mend_clocks
from pdr_est.io.formats.datasets import (
    euroc,
    ilc20,
    ipin2021,
    motionsense,
    oxford_steps,
    oxiod,
    ridi,
    ronin,
    sisfall,
    stride_length,
    wisdm,
)
from pdr_est.io.formats.datasets.weallwalk import reader as weallwalk
from pdr_est.io.formats.exchange import parquet_table, synchronised_arrays
from pdr_est.io.formats.imu_devices import flysight, ros_csv, shimmer, xio, xsens
from pdr_est.io.formats.phone_apps import (
    androsensor,
    core_motion,
    getsensordata,
    gnss_logger,
    hyperimu,
    matlab_mobile,
    physics_toolbox,
    sensorlog,
)
from pdr_est.io.formats.phone_apps.phyphox import reader as phyphox
from pdr_est.io.formats.phone_apps.sensor_logger import reader as sensor_logger
from pdr_est.io.formats.plain_csv import reader as plain_csv
from pdr_est.io.formats.plain_csv.mapped import read_mapped
from pdr_est.io.formats.plain_csv.unknown import describe_unknown
from pdr_est.io.formats.sensor_files import reader as sensor_files
from pdr_est.io.side_tables.clock_messages import split_off_clock_messages
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.text.container import Source
from pdr_est.io.text.single_archive import open_recording
from pdr_est.io.text.unpacked.json_records import unpack_json
from pdr_est.io.text.unpacked.workbook import unpack_workbook
from pdr_est.types.recording import Recording


class Format(Protocol):
    """Interface of a module, or object, that reads one format."""

    @property
    def NAME(self) -> str:
        """Return the name of the format, for messages."""

    def sniff(self, source: Source) -> bool:
        """Tell whether the content of a source is of this format."""

    def read_source(self, source: Source) -> Recording:
        """Read the recording.

        Raises
        ------
        RecordingError
            When it cannot be used.
        """


@runtime_checkable
class FormatOfChosenDevices(Format, Protocol):
    """Interface of a format whose tables may hold the rows of several devices, persons or sessions."""

    def read_chosen(self, source: Source, chosen: Sequence[str]) -> Recording:
        """Read the recording, of the chosen devices only; of all without names, and where none is there.

        Raises
        ------
        RecordingError
            When it cannot be used.
        """


# Asked in this order: formats with unmistakable marks first, header-less tables of numbers after them.
FORMATS: tuple[Format, ...] = (
    parquet_table,
    synchronised_arrays,
    ilc20,
    getsensordata,
    gnss_logger,
    flysight,
    sensor_logger,
    xio.FORMAT,  # whose table of the magnetometer could be one of phyphox
    phyphox,
    motionsense,
    weallwalk,
    stride_length,
    oxiod,
    oxford_steps,
    sisfall,
    wisdm,
    ronin,
    matlab_mobile,
    ridi.FORMAT,
    euroc,
    ipin2021,
    androsensor.FORMAT,
    physics_toolbox.FORMAT,
    sensorlog.FORMAT,
    hyperimu.FORMAT,
    core_motion.FORMAT,
    xsens.FORMAT,
    shimmer.FORMAT,
    ros_csv.FORMAT,
    sensor_files,
    plain_csv,
)


def read(path: str | Path, mapping: TableMapping | None = None, devices: Sequence[str] = ()) -> Recording:
    """Read the recording in a file, a folder or a zip archive, plain or gzipped.

    Parameters
    ----------
    path
        The recording.
    mapping
        What the columns of a table mean (`pdr_est.io.tables.mapping_file.load_mapping`); None to find it out.
    devices
        Names of the devices, persons or sessions whose rows are wanted, where tables hold rows of several; all
        without names, and where the table has none of these names.

    Raises
    ------
    RecordingError
        When the format is unknown, several walks are inside, or the data are damaged: one line that names the file,
        the place and a remedy.
    """
    source, messages = split_off_clock_messages(unpack_workbook(open_recording(path)))
    if not any(source.head(member, 1) for member in source.members):
        raise RecordingError(f"{source.path}: the recording is empty (0 bytes); export it again")
    if mapping is not None:
        return mend_clocks(replace(read_mapped(unpack_json(source), mapping, devices), messages=messages))
    known, source = format_of(source)
    if known is not None:
        return mend_clocks(replace(_read_known(known, source, devices), messages=messages))
    names = ", ".join(known.NAME for known in FORMATS)
    raise RecordingError(
        f"{source.path}: unknown format: {describe_unknown(source)}. Say what the columns mean with --map FILE.yaml, "
        "of which `pdr-est inspect RECORDING --write-map FILE.yaml` writes a draft; known formats are "
        f"{names}; see docs/recorder-formats.md"
    )


def format_of(source: Source) -> tuple[Format | None, Source]:
    """Find the format of a source, and what is then to be read: the tables in it if it is JSON of other recorders.

    Returns
    -------
    tuple of Format or None, and Source
        None with the source, unpacked if possible, when no format knows it.
    """
    tables = source if sensor_logger.sniff(source) else unpack_json(source)
    return next((known for known in FORMATS if known.sniff(tables)), None), tables


def _read_known(known: Format, source: Source, devices: Sequence[str]) -> Recording:
    """Read a source, of the wanted devices only where the format can have rows of several in one table."""
    if isinstance(known, FormatOfChosenDevices):
        return known.read_chosen(source, devices)
    return known.read_source(source)
