"""Split tables whose rows are of several devices, persons or sessions, as one of their columns tells.

Rows of different owners must never be read as one signal. Devices that recorded at the same time are the devices of
one walk. Persons, and sessions whose clocks do not go on from one to the next, are walks of their own, of which one
has to be chosen.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.frames import Array
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.times.clock import read_clock
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.tables.words.owners import OWNERS, OWNERS_IN_WORDS, Owner
from pdr_est.io.text.cells import Cell, kind_of_cell, split_line
from pdr_est.io.text.loose_table import LooseTable, read_loose_table
from pdr_est.io.text.table_layout import TableLayout

_FEWEST_ROWS = 10  # of an owner; fewer are damaged cells
_ROWS_OF_AN_OWNER = 10.0  # on average; columns with more values count something
_TOGETHER = 0.5  # share of the shorter time that two devices of one walk record at once
_SAME_STAMPS = 0.5
_GOES_BACK_S = 0.1
_LONGEST_GAP_S = 5.0  # between two sessions of one recording; ours
_NAMED = 6


@dataclass(frozen=True)
class OwnedRows:
    """Rows of one owner.

    Attributes
    ----------
    name
        The owner, as the column names it; "" where the file is of one device.
    text
        Its rows below the header of the file.
    decisions, warnings
        How they were found, in words.
    """

    name: str
    text: bytes
    decisions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Column:
    """Column of owners: what they are, the name (n,) of the owner of each row, "" where the cell is empty."""

    title: str
    kind: Owner
    names: NDArray[np.str_]


def names_owners(titles: Sequence[str]) -> bool:
    """Tell whether a title is that of a column of devices, persons or sessions."""
    owners = (Owner.DEVICE, Owner.PERSON, Owner.SESSION)
    plain = ["".join(split_words(title)) for title in titles]
    return any(OWNERS.get(title) in owners and title not in OWNERS_IN_WORDS for title in plain)


def split_by_owner(
    text: bytes, place: str, layout: TableLayout, mapping: TableMapping, sensor: str | None, chosen: Sequence[str]
) -> tuple[OwnedRows, ...]:
    """Split the rows of a table by the device, person or session that a column names.

    Parameters
    ----------
    text
        Content in UTF-8.
    place
        Name of the file, for messages.
    layout
        How the table is written.
    mapping
        Its columns with the time; without any where they are not known.
    sensor
        Title of the column that names the sensor of each row; None where the table is not long.
    chosen
        Names of the owners whose rows are wanted; those that the table does not have are ignored, and without any
        that it has all rows are wanted.

    Returns
    -------
    tuple of OwnedRows
        A single one without a name where all rows are of one owner.

    Raises
    ------
    SeveralWalksError
        When the wanted rows are of several walks, which it names.
    """
    whole = (OwnedRows("", text),)
    candidates = _candidates(layout, mapping, sensor)
    if not candidates:
        return whole
    columns = _columns(read_loose_table(text, place, layout, (), [*candidates, *_one(sensor)]), candidates, sensor)
    if not columns:
        return whole
    times = [title for clock in mapping.clocks for title in clock.titles]
    loose = read_loose_table(text, place, layout, (), [*times, *candidates, *_one(sensor)])
    columns = _columns(loose, candidates, sensor)
    time_s = _times(loose, mapping)
    alike = _rows_of_one_sensor(loose, sensor)
    separating = [column for column in columns if _separates(column, column.names[alike], time_s[alike])]
    if not separating:
        return whole
    owners = _joined(separating)
    wanted = [name for name in dict.fromkeys(owners.tolist()) if name]
    wanted = [name for name in wanted if name in chosen] or wanted
    titles = " and ".join(repr(column.title) for column in separating)
    if len(wanted) > 1 and not _are_of_one_walk(separating, owners, wanted, time_s):
        kinds = " and ".join(f"{column.kind} in column {column.title!r}" for column in separating)
        named = ", ".join(wanted[:_NAMED]) + (", …" if len(wanted) > _NAMED else "")
        raise SeveralWalksError(
            f"{place}: the rows are of {len(wanted)} walks, by the {kinds}: {named}; choose one with --device NAME",
            tuple(wanted),
            by_device=True,
        )
    return _rows_of_owners(text, layout, [column.title for column in separating], titles, wanted)


def _one(title: str | None) -> tuple[str, ...]:
    return () if title is None else (title,)


def _candidates(layout: TableLayout, mapping: TableMapping, sensor: str | None) -> dict[str, Owner]:
    """List the columns that may name owners, by their titles, or by text where the title says nothing."""
    if not layout.has_header:
        return {}
    taken = {title for one in mapping.columns.values() for title in one.titles} | {sensor}
    taken |= {title for clock in mapping.clocks for title in clock.titles}
    found = {}
    for title, cell in zip(layout.titles, layout.sample, strict=True):
        plain = "".join(split_words(title))
        is_text = kind_of_cell(cell) is Cell.TEXT
        kind = OWNERS.get(plain, Owner.ANY if is_text else None)
        if kind is not None and title not in taken and (is_text or plain not in OWNERS_IN_WORDS):
            found[title] = kind
    return found


def _columns(loose: LooseTable, candidates: Mapping[str, Owner], sensor: str | None) -> list[_Column]:
    """Find the columns with at least two names, but not so many that they count something.

    In a long table a column that has one name for each sensor describes the sensor.
    """
    alike = _rows_of_one_sensor(loose, sensor)
    found = []
    for title, kind in candidates.items():
        column = loose.table.columns[title]
        if column.dtype.kind == "f" and (np.nan_to_num(column) % 1.0 != 0.0).any():
            continue
        names = _as_names(loose, title)
        values, counts = np.unique(names[alike & (names != "")], return_counts=True)
        if (counts >= _FEWEST_ROWS).sum() >= 2 and len(values) <= alike.sum() / _ROWS_OF_AN_OWNER:
            found.append(_Column(title, kind, names))
    return found


def _rows_of_one_sensor(loose: LooseTable, sensor: str | None) -> NDArray[np.bool_]:
    """Find the rows (n,) of the sensor that has the most; all of a table that is not long."""
    if sensor is None:
        return np.ones(len(loose.table), dtype=np.bool_)
    names, counts = np.unique(loose.table.texts(sensor), return_counts=True)
    return np.asarray(loose.table.texts(sensor) == names[int(np.argmax(counts))])


def _as_names(loose: LooseTable, title: str) -> NDArray[np.str_]:
    column = loose.table.columns[title]
    if column.dtype.kind == "f":
        return np.array(["" if np.isnan(value) else f"{value:.0f}" for value in column.tolist()], dtype=np.str_)
    return np.char.strip(loose.table.texts(title))


def _times(loose: LooseTable, mapping: TableMapping) -> Array:
    """Return the time of each row, s; NaN where the table does not tell it."""
    unknown = np.full(len(loose.table), np.nan)
    if not mapping.clocks:
        return unknown
    try:
        return read_clock(
            loose, TableMapping(clocks=tuple(replace(clock, canonical=False) for clock in mapping.clocks))
        ).time_s
    except RecordingError:
        return unknown


def _separates(column: _Column, names: NDArray[np.str_], time_s: Array) -> bool:
    """Tell whether rows of different names (n,), of one sensor, must not be read as one signal."""
    if column.kind in (Owner.DEVICE, Owner.PERSON):
        return True
    changes = np.flatnonzero(names[1:] != names[:-1])
    steps_s = time_s[changes + 1] - time_s[changes]
    steps_s = steps_s[np.isfinite(steps_s)]
    goes_back = bool((steps_s < -_GOES_BACK_S).any())
    if column.kind is Owner.ACTIVITY:
        return goes_back
    if column.kind is Owner.SESSION:
        return goes_back or bool((steps_s > _LONGEST_GAP_S).any())
    return goes_back or _share_stamps(names, time_s)


def _share_stamps(names: NDArray[np.str_], time_s: Array) -> bool:
    """Tell whether most time stamps of the rarest name are those of others, too: one device has each only once."""
    values, counts = np.unique(names[names != ""], return_counts=True)
    rare = names == values[int(np.argmin(counts))]
    own, other = np.unique(time_s[rare & np.isfinite(time_s)]), time_s[~rare & np.isfinite(time_s)]
    return len(own) > 0 and float(np.isin(own, other).mean()) > _SAME_STAMPS


def _joined(columns: Sequence[_Column]) -> NDArray[np.str_]:
    """Join the names of several columns; "" where one is empty."""
    owners = columns[0].names
    for column in columns[1:]:
        both = (owners != "") & (column.names != "")
        owners = np.where(both, np.char.add(np.char.add(owners, "-"), column.names), "")
    return owners


def _are_of_one_walk(
    columns: Sequence[_Column], owners: NDArray[np.str_], wanted: Sequence[str], time_s: Array
) -> bool:
    """Tell whether the wanted rows are those of devices that recorded at the same time."""
    rows = np.isin(owners, wanted)
    for column in columns:
        if column.kind not in (Owner.DEVICE, Owner.ANY) and len(np.unique(column.names[rows])) > 1:
            return False
    spans = []
    for name in wanted:
        own_s = time_s[(owners == name) & np.isfinite(time_s)]
        if not len(own_s):
            return False
        spans.append((float(own_s.min()), float(own_s.max())))
    longest = max(spans, key=lambda span: span[1] - span[0])
    return all(min(end, longest[1]) - max(begin, longest[0]) >= _TOGETHER * (end - begin) for begin, end in spans)


def _rows_of_owners(
    text: bytes, layout: TableLayout, titles: Sequence[str], named: str, wanted: Sequence[str]
) -> tuple[OwnedRows, ...]:
    """Put the lines of each owner below the header of the file."""
    lines = text.decode("utf-8", "replace").split("\n")
    at = [layout.titles.index(title) for title in titles]
    own: dict[str, list[str]] = {name: [] for name in wanted}
    rest = 0
    for line in lines[layout.first_line :]:
        if not line.strip():
            continue
        cells = split_line(line, layout.separator)
        name = "-".join(_cell(cells[i]) for i in at) if len(cells) > max(at) else ""
        if name in own:
            own[name].append(line)
        else:
            rest += 1
    few = [name for name, rows in own.items() if len(rows) < _FEWEST_ROWS]
    kept = [name for name in wanted if name not in few]
    note = f"column {named} names the {'device' if len(titles) == 1 else 'owner'} of each row"
    left = sum(len(own[name]) for name in few) + rest
    decisions = (f"{note}; {left} rows of others are left out",) if left else (note,)
    warnings = (_pair_warning(kept),) if len(kept) > 1 else ()
    head = lines[: layout.first_line]
    return tuple(
        OwnedRows(name, "\n".join([*head, *own[name], ""]).encode(), decisions, warnings if i == 0 else ())
        for i, name in enumerate(kept)
    )


def _cell(cell: str) -> str:
    text = cell.strip().strip("\"'").strip()
    return text[:-2] if text.endswith(".0") and text[:-2].isdigit() else text


def _pair_warning(names: Sequence[str]) -> str:
    return (
        f"the table has the rows of {len(names)} devices ({', '.join(names)}), taken to be carried by one person: "
        "choose one with --device NAME if they were not"
    )
