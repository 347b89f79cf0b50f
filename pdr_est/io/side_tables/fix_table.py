"""Read a table of positions that a user wrote: its titles in many spellings, with units, and its times.

Tables of position fixes and of trajectories are read alike; a trajectory has more columns (`io.trajectories`).

Titles are compared without case, blanks, underscores and punctuation. A known unit in brackets or after an
underscore at the end of a title is used (`Time (ms)`, `east [cm]`, `x_m`). Without one, times are seconds or, by
their size, Unix time in ms, µs or ns, and lengths are metres.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.io.side_tables.table_times import times_in_seconds
from pdr_est.io.tables.quantities import Quantity, unit_spellings
from pdr_est.io.tables.recognition import Evidence, motion_evidence
from pdr_est.io.tables.signals import HEAD_BYTES
from pdr_est.io.tables.words.columns import ACCURACIES, EASTINGS, LATITUDES, LONGITUDES, NORTHINGS, TIMES
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.tables.words.units import plain_unit
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.io.text.table_layout import detect_header

FIRST_LINE = 2
"""Line of the first position; line 1 is the header."""

MAP_COLUMNS = ("x_m", "y_m")
"""Position in the map frame, m."""

GEODETIC_COLUMNS = ("latitude_deg", "longitude_deg")
"""Position on the Earth, degrees."""

_HEAD_BYTES = 4096
_TITLE = re.compile(r"^(?P<stem>.*?)\s*(?:[\[(](?P<bracket>[^\])]*)[\])]|(?:_|\s+in\s+)(?P<suffix>[^\W_]+))?$")
_LENGTHS = unit_spellings(Quantity.ACCURACY)
_TIMES = unit_spellings(Quantity.TIME)
_ANGLES: Mapping[str, float] = {"deg": 1.0}
_PLAIN: Mapping[str, float] = {}

Columns = Mapping[str, tuple[Mapping[str, float], Sequence[str]]]
"""Column -> its units, and the titles that mean it, the likelier ones first."""

POSITION_COLUMNS: Columns = {
    "time_s": (_TIMES, ("time", "timestamp", "t", "seconds", *sorted(TIMES))),
    "x_m": (_LENGTHS, ("x", "east", *sorted(EASTINGS))),
    "y_m": (_LENGTHS, ("y", "north", *sorted(NORTHINGS))),
    "latitude_deg": (_ANGLES, ("latitude", *sorted(LATITUDES))),
    "longitude_deg": (_ANGLES, ("longitude", *sorted(LONGITUDES))),
    "sigma_m": (
        _LENGTHS,
        ("sigma", "std", "stddev", "standarddeviation", "accuracy", "genauigkeit", *sorted(ACCURACIES)),
    ),
}
"""Columns of every table of positions."""

_FIX_COLUMNS: Columns = {
    **POSITION_COLUMNS,
    "robust": (_PLAIN, ("robust",)),
    "source": (_PLAIN, ("source", "provider")),
    "sigma_wander_m": (_LENGTHS, ("sigmawander",)),
    "wander_time_s": (_TIMES, ("wandertime",)),
}

TRAJECTORY_COLUMNS: Columns = {
    **POSITION_COLUMNS,
    "device": (_PLAIN, ("device", "phone")),
    "cov_xx_m2": (_PLAIN, ("covxxm2",)),
    "cov_xy_m2": (_PLAIN, ("covxym2",)),
    "cov_yy_m2": (_PLAIN, ("covyym2",)),
}
"""Columns of the table of a trajectory."""

_TEXT_COLUMNS = ("time_s", "source", "device")


@dataclass(frozen=True)
class _Title:
    """Title of a column in a file. factor: to SI units; None where the title tells no unit."""

    title: str
    factor: float | None


def read_fix_table(path: str | Path) -> NumberTable:
    """Read a table of fixes with its columns under the names `time_s`, `x_m`, `y_m`, …, in SI units.

    Dates become Unix time in `time_s`; where they state no time zone, the column is `LOCAL_TIME` and holds what the
    Unix time would be if they were UTC. Columns of other names are left out.

    Raises
    ------
    RecordingError
        For a missing or damaged table, and one without times or positions.
    """
    source = Source.open(path)
    if len(source.members) != 1:
        raise RecordingError(
            f"{source.path}: contains {len(source.members)} files: give the table of the fixes itself"
        )
    table = read_position_table(source, source.members[0], _FIX_COLUMNS)
    if not len(table):
        raise RecordingError(f"{table.place}: contains no fix: add a row or leave --fixes out")
    return table


def read_position_table(source: Source, member: str, columns: Columns) -> NumberTable:
    """Read one file with a table of positions; the result is that of `read_fix_table`, for any columns.

    Raises
    ------
    RecordingError
        For a damaged table, and one without times or positions.
    """
    data, place = source.read(member), source.place(member)
    dialect = detect_header(data[:_HEAD_BYTES])
    if dialect is None:
        raise RecordingError(f"{place}: no header line such as time_s,x_m,y_m: add one")
    found = _known_columns(dialect.titles, place, columns)
    _require_columns(found, dialect.titles, place)
    if set(MAP_COLUMNS) <= set(found) and motion_evidence(data[:HEAD_BYTES], member_stem(member)) is Evidence.TITLES:
        raise RecordingError(
            f"{place}: a recording of sensors, whose x and y are no positions: give the table of the known positions"
        )
    texts = [found[name].title for name in _TEXT_COLUMNS if name in found]
    table = read_table(
        data,
        place,
        separator=dialect.separator,
        decimal_comma=dialect.decimal_comma,
        columns=[one.title for one in found.values()],
        text_columns=texts,
    )
    return _in_si_units(table, found, dialect.decimal_comma, "line", FIRST_LINE)


def position_table_of_cells(
    cells: Mapping[str, Sequence[Any]], place: str, columns: Columns, row: str
) -> NumberTable:
    """Make the table that `read_position_table` would read from values of a file that is no table, such as GeoJSON.

    Parameters
    ----------
    cells
        Title -> value (n,) in each row, None where there is none.
    place
        The file, for messages.
    columns
        Columns to keep.
    row
        Name of a row in messages, which are counted from 1.

    Raises
    ------
    RecordingError
        For text where a number is needed, and values without times or positions.
    """
    found = _known_columns(list(cells), place, columns)
    _require_columns(found, list(cells), place)
    values: dict[str, NDArray[Any]] = {}
    for name, one in found.items():
        given = cells[one.title]
        if name in _TEXT_COLUMNS:
            values[one.title] = np.array(["" if cell is None else str(cell) for cell in given])
            continue
        numbers = np.empty(len(given))
        for i, cell in enumerate(given):
            try:
                numbers[i] = math.nan if cell is None else float(cell)
            except (TypeError, ValueError, OverflowError) as error:
                raise RecordingError(
                    f"{place}, {row} {i + 1}: {one.title} = {str(cell)[:60]!r} is not a number: correct it"
                ) from error
        values[one.title] = numbers
    return _in_si_units(NumberTable(place, values), found, False, row, 1)


def _in_si_units(
    table: NumberTable, found: Mapping[str, "_Title"], decimal_comma: bool, row: str, first: int
) -> NumberTable:
    """Rename the columns that are known and convert them to SI units."""
    time_name, time_s = times_in_seconds(
        [str(text).strip() for text in table.texts(found["time_s"].title)],
        found["time_s"].factor,
        decimal_comma,
        lambda i: f"{table.place}, {row} {i + first}, column {found['time_s'].title!r}",
    )
    columns = {name: _column(table, name, one) for name, one in found.items() if name != "time_s"} | {
        time_name: time_s
    }
    empty = {name: table.empty[one.title] for name, one in found.items() if one.title in table.empty}
    return NumberTable(table.place, columns, empty)


def _known_columns(titles: Sequence[str], place: str, columns: Columns) -> dict[str, _Title]:
    """Find the columns that are known: by their own name, else by the first spelling that a title has."""
    found: dict[str, _Title] = {}
    for name, (units, spellings) in columns.items():
        exact = [_Title(title, 1.0) for title in titles if title.casefold() == name]
        others = [_Title(title, unit) for title, unit in _spelt(titles, units, spellings, place)]
        free = [one for one in (*exact, *others) if one.title not in {other.title for other in found.values()}]
        if free:
            found[name] = free[0]
    return found


def _spelt(
    titles: Sequence[str], units: Mapping[str, float], spellings: Sequence[str], place: str
) -> list[tuple[str, float | None]]:
    """List the titles with one of some spellings, in their order, with the factor of the unit that they tell."""
    ranked = []
    for title in titles:
        match = _TITLE.match(title.strip())
        if match is None:
            continue
        stem, bracket = _plain(match["stem"]), match["bracket"]
        if bracket is not None and stem in spellings:
            unit = plain_unit(bracket)
            if units and unit and unit not in units:
                first_names = {factor: name for name, factor in reversed(list(units.items()))}
                known = " or ".join(name for name in units if name in first_names.values())
                raise RecordingError(
                    f"{place}: the unit {bracket!r} of the column {title!r} is not known: give {known}"
                )
            ranked.append((spellings.index(stem), title, units.get(unit)))
        elif match["suffix"] is not None and plain_unit(match["suffix"]) in units and stem in spellings:
            ranked.append((spellings.index(stem), title, units[plain_unit(match["suffix"])]))
        elif _plain(title) in spellings:
            ranked.append((spellings.index(_plain(title)), title, None))
    return [(title, unit) for _, title, unit in sorted(ranked, key=lambda one: one[0])]


def _plain(text: str) -> str:
    return "".join(split_words(text))


def _require_columns(found: Mapping[str, _Title], titles: Sequence[str], place: str) -> None:
    if "time_s" not in found:
        raise RecordingError(f"{place}: no column time_s among {', '.join(titles)}: name the time column time_s")
    if not (found.keys() >= {*MAP_COLUMNS} or found.keys() >= {*GEODETIC_COLUMNS}):
        raise RecordingError(
            f"{place}: needs the columns {' and '.join(MAP_COLUMNS)}, or {' and '.join(GEODETIC_COLUMNS)}; it has "
            f"{', '.join(titles)}"
        )


def _column(table: NumberTable, name: str, title: _Title) -> NDArray[Any]:
    """Return a column in SI units, (n,)."""
    if name in _TEXT_COLUMNS:
        return table.texts(title.title)
    return table.numbers(title.title) * (1.0 if title.factor is None else title.factor)
