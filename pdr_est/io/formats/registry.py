"""Reads a recording of any known format, recognised by its content."""

from dataclasses import replace
from pathlib import Path
from typing import Protocol

from pdr_est.errors import RecordingError
from pdr_est.io.formats import getsensordata, ilc20, motionsense, oxford_steps, oxiod, sisfall, stride_length
from pdr_est.io.formats.phyphox import reader as phyphox
from pdr_est.io.formats.plain_csv import reader as plain_csv
from pdr_est.io.formats.sensor_logger import reader as sensor_logger
from pdr_est.io.formats.weallwalk import reader as weallwalk
from pdr_est.io.side_tables.clock_messages import split_off_clock_messages
from pdr_est.io.text.container import Source
from pdr_est.types.recording import Recording


class Format(Protocol):
    """A module that reads one recorder's files."""

    NAME: str

    def sniff(self, source: Source) -> bool:
        """Whether the content of the source is of this format."""

    def read_source(self, source: Source) -> Recording:
        """The recording; raises RecordingError when it cannot be used."""


# Asked in this order: formats with unmistakable marks first, header-less tables of numbers after them.
FORMATS: tuple[Format, ...] = (
    ilc20,
    getsensordata,
    sensor_logger,
    phyphox,
    motionsense,
    weallwalk,
    stride_length,
    oxiod,
    oxford_steps,
    sisfall,
    plain_csv,
)


_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")


def read(path: str | Path) -> Recording:
    """Read the recording in a file, a folder or a zip, plain or gzipped.

    Raises RecordingError, in one line with the file, the place and a remedy, when the format is unknown, when
    several walks are inside, or when the data are damaged.
    """
    source, messages = split_off_clock_messages(Source.open(path))
    if not any(source.head(member, 1) for member in source.members):
        raise RecordingError(f"{source.path}: empty (0 bytes of content); export the recording again")
    for known in FORMATS:
        if known.sniff(source):
            return replace(known.read_source(source), messages=messages)
    if any(source.head(member, 2) in _UTF16_MARKS for member in source.members):
        raise RecordingError(f"{source.path}: UTF-16 text; save it as UTF-8")
    names = ", ".join(known.NAME for known in FORMATS)
    raise RecordingError(f"{source.path}: unknown format; known are {names}; see the README for their layouts")
