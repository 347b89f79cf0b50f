"""Read the messages by which devices compared their clocks: a table with one row for each exchange.

Robust DR section V-B: the manager, which is the first device of the recording, sends at T1 of its clock, a worker
receives and answers at T2 of its own clock, and the answer arrives at T3 of the manager's clock.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source, SourceKind
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.number_table import read_table
from pdr_est.io.text.table_layout import detect_header
from pdr_est.types.recording import ClockMessages

RECORDED_NAME = "clock_messages"
"""Name, with any extension, of the table of clock messages in a folder or zip."""

_STAMPS = ("t1_s", "t2_s", "t3_s")
_FIRST_LINE = 2  # of the data; line 1 is the header
_HEAD_BYTES = 4096
_MILLISECONDS_FROM_S = 1e11  # larger times cannot be seconds


def read_clock_messages(path: str | Path) -> ClockMessages:
    """Read the exchanges of a table with the header `device,t1_s,t2_s,t3_s`; separators as in any CSV file.

    t1_s and t3_s are on the clock of the first device, t2_s on that of `device`; each in seconds as in the recording
    of that device, or in Unix time where the recording tells it.

    Raises
    ------
    RecordingError
        For a missing or damaged table, naming file, line, value and remedy.
    """
    source = Source.open(path)
    if len(source.members) != 1:
        raise RecordingError(
            f"{source.path}: contains {len(source.members)} files: give the table of the clock messages itself"
        )
    return _read_exchanges(source, source.members[0])


def split_off_clock_messages(source: Source) -> tuple[Source, tuple[ClockMessages, ...]]:
    """Separate the table `clock_messages` from the other files of a folder or zip.

    Returns
    -------
    Source
        The source without that table.
    tuple of ClockMessages
        The exchanges of the table; empty where there is none.
    """
    members = [name for name in source.members if member_stem(name).casefold() == RECORDED_NAME]
    if source.kind is SourceKind.FILE or not members or len(members) == len(source.members):
        return source, ()
    rest = {name: stored for name, stored in source.stored.items() if name not in members}
    return replace(source, stored=rest), tuple(_read_exchanges(source, member) for member in members)


def _read_exchanges(source: Source, member: str) -> ClockMessages:
    data, place = source.read(member), source.place(member)
    dialect = detect_header(data[:_HEAD_BYTES])
    if dialect is None:
        raise RecordingError(f"{place}: no header line device,{','.join(_STAMPS)}: add it")
    titles = {title.casefold(): title for title in dialect.titles}
    missing = [name for name in ("device", *_STAMPS) if name not in titles]
    if missing:
        raise RecordingError(
            f"{place}: no column {' and no column '.join(missing)} among {', '.join(dialect.titles)}: "
            f"name the columns device,{','.join(_STAMPS)}"
        )
    table = read_table(
        data,
        place,
        separator=dialect.separator,
        decimal_comma=dialect.decimal_comma,
        columns=[titles[name] for name in _STAMPS],
        text_columns=[titles["device"]],
    )
    if not len(table):
        raise RecordingError(f"{place}: contains no exchange: add a row or leave the table out")
    t1_s, t2_s, t3_s = (table.numbers(titles[name]) for name in _STAMPS)
    names = np.char.strip(table.texts(titles["device"]))
    messages = ClockMessages(place, tuple(str(name) for name in names), t1_s, t2_s, t3_s)
    _check_rows(messages)
    return messages


def _check_rows(messages: ClockMessages) -> None:
    """Refuse rows without a device, with times that are not finite or not in seconds, or with T3 before T1."""
    rows = zip(messages.device, messages.t1_s, messages.t2_s, messages.t3_s, strict=True)
    for line, (device, *stamps) in enumerate(rows, start=_FIRST_LINE):
        where = f"{messages.place}, line {line}"
        if not device:
            raise RecordingError(f"{where}: no device name: name the device that answered")
        for name, stamp in zip(_STAMPS, stamps, strict=True):
            if not np.isfinite(stamp):
                raise RecordingError(f"{where}: {name} = {stamp}: give a number of seconds or remove the row")
            if abs(stamp) > _MILLISECONDS_FROM_S:
                raise RecordingError(
                    f"{where}: {name} = {stamp:.6g} is not a time in seconds: convert milliseconds to seconds"
                )
        if stamps[2] < stamps[0]:
            raise RecordingError(
                f"{where}: t3_s = {stamps[2]:.6f} is before t1_s = {stamps[0]:.6f}, the answer before the request: "
                "check whether the columns are exchanged"
            )
