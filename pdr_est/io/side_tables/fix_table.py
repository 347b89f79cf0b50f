"""Read the table of position fixes that a user wrote: its titles in many spellings, with units, and its times.

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
from pdr_est.frames import Array
from pdr_est.io.tables.quantities import Quantity, unit_spellings
from pdr_est.io.tables.recognition import Evidence, motion_evidence
from pdr_est.io.tables.signals import HEAD_BYTES
from pdr_est.io.tables.times.dates import parse_dates
from pdr_est.io.tables.words.columns import ACCURACIES, EASTINGS, LATITUDES, LONGITUDES, NORTHINGS, TIMES
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.tables.words.units import plain_unit
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.io.text.table_layout import detect_header

FIRST_LINE = 2
"""Line of the first fix; line 1 is the header."""

MAP_COLUMNS = ("x_m", "y_m")
"""Position in the map frame, m."""

GEODETIC_COLUMNS = ("latitude_deg", "longitude_deg")
"""Position on the Earth, degrees."""

LOCAL_TIME = "local_time_s"
"""Time by dates without a time zone, s since 1970."""

_HEAD_BYTES = 4096
_TITLE = re.compile(r"^(?P<stem>.*?)\s*(?:[\[(](?P<bracket>[^\])]*)[\])]|(?:_|\s+in\s+)(?P<suffix>[^\W_]+))?$")
_LENGTHS = unit_spellings(Quantity.ACCURACY)
_TIMES = unit_spellings(Quantity.TIME)
_ANGLES: Mapping[str, float] = {"deg": 1.0}
_PLAIN: Mapping[str, float] = {}

# Column -> its units, and the titles that mean it, the likelier ones first.
_COLUMNS: Mapping[str, tuple[Mapping[str, float], Sequence[str]]] = {
    "time_s": (_TIMES, ("time", "timestamp", "t", "seconds", *sorted(TIMES))),
    "x_m": (_LENGTHS, ("x", "east", *sorted(EASTINGS))),
    "y_m": (_LENGTHS, ("y", "north", *sorted(NORTHINGS))),
    "latitude_deg": (_ANGLES, ("latitude", *sorted(LATITUDES))),
    "longitude_deg": (_ANGLES, ("longitude", *sorted(LONGITUDES))),
    "sigma_m": (
        _LENGTHS,
        ("sigma", "std", "stddev", "standarddeviation", "accuracy", "genauigkeit", *sorted(ACCURACIES)),
    ),
    "robust": (_PLAIN, ("robust",)),
    "source": (_PLAIN, ("source", "provider")),
    "sigma_wander_m": (_LENGTHS, ("sigmawander",)),
    "wander_time_s": (_TIMES, ("wandertime",)),
}
# Sizes of Unix time of our days in ms, µs and ns.
_UNIX_UNITS = ((1e17, 1e19, 1e-9), (1e14, 1e16, 1e-6), (1e11, 1e13, 1e-3))


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
    member = source.members[0]
    data, place = source.read(member), source.place(member)
    dialect = detect_header(data[:_HEAD_BYTES])
    if dialect is None:
        raise RecordingError(f"{place}: no header line such as time_s,x_m,y_m: add one")
    found = _known_columns(dialect.titles, place)
    _require_columns(found, dialect.titles, place)
    if set(MAP_COLUMNS) <= set(found) and motion_evidence(data[:HEAD_BYTES], member_stem(member)) is Evidence.TITLES:
        raise RecordingError(
            f"{place}: a recording of sensors, whose x and y are no positions: give the table of the known positions"
        )
    texts = [found[name].title for name in ("time_s", "source") if name in found]
    table = read_table(
        data,
        place,
        separator=dialect.separator,
        decimal_comma=dialect.decimal_comma,
        columns=[one.title for one in found.values()],
        text_columns=texts,
    )
    if not len(table):
        raise RecordingError(f"{place}: contains no fix: add a row or leave --fixes out")
    time_name, time_s = _times(table, found["time_s"], dialect.decimal_comma)
    columns = {name: _column(table, name, one) for name, one in found.items() if name != "time_s"} | {
        time_name: time_s
    }
    empty = {name: table.empty[one.title] for name, one in found.items() if one.title in table.empty}
    return NumberTable(place, columns, empty)


def _known_columns(titles: Sequence[str], place: str) -> dict[str, _Title]:
    """Find the columns that are known: by their own name, else by the first spelling that a title has."""
    found: dict[str, _Title] = {}
    for name, (units, spellings) in _COLUMNS.items():
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
    if name == "source":
        return table.texts(title.title)
    return table.numbers(title.title) * (1.0 if title.factor is None else title.factor)


def _times(table: NumberTable, title: _Title, decimal_comma: bool) -> tuple[str, Array]:
    """Convert times to seconds (n,): numbers in the unit of the title or of Unix time, or dates.

    Returns
    -------
    name : str
        `time_s`, or `LOCAL_TIME` for dates without a time zone.
    time_s : (n,)
        NaN for an empty cell.
    """
    texts = [str(text).strip() for text in table.texts(title.title)]
    numbers = [_number(text, decimal_comma) for text in texts]
    if any(number is None for number in numbers):
        return _date_times(texts, numbers, table.place, title.title)
    times = np.array(numbers, dtype=np.float64)
    if title.factor is not None:
        return "time_s", times * title.factor
    finite = np.abs(times[np.isfinite(times)])
    middle = float(np.median(finite)) if len(finite) else 0.0
    factor = next((unit for low, high, unit in _UNIX_UNITS if low < middle < high), 1.0)
    return "time_s", times * factor


def _number(text: str, decimal_comma: bool) -> float | None:
    """Return the number that a cell holds, NaN for an empty one; None for other text."""
    try:
        return float(text.replace(",", ".") if decimal_comma else text) if text else math.nan
    except ValueError:
        return None


def _date_times(texts: Sequence[str], numbers: Sequence[float | None], place: str, title: str) -> tuple[str, Array]:
    """Read dates, all of which state a time zone or none does; see `_times`."""
    is_text = [number is None for number in numbers]
    dates = parse_dates(np.array([text if is_date else "" for text, is_date in zip(texts, is_text, strict=True)]))
    read = dates is not None and dates.has_date
    for row, text in enumerate(texts):
        where = f"{place}, line {row + FIRST_LINE}, column {title!r}: {text!r}"
        if is_text[row] and not (read and dates is not None and dates.known[row]):
            raise RecordingError(
                f"{where} is neither a number nor a date such as 2024-06-10T14:03:05Z; correct or remove it"
            )
        if text and not is_text[row]:
            raise RecordingError(f"{where} is a number among dates; write all times in one form")
    if dates is None:
        return "time_s", np.array(numbers, dtype=np.float64)
    return "time_s" if dates.has_zone else LOCAL_TIME, np.where(dates.known, dates.ns / 1e9, math.nan)
