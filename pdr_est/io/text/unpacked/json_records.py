"""Open JSON as tables: lists of records, a record a line, messages with a list of records, or a list a column.

Names inside each other become one title, `acc.x`; a list of numbers in a record becomes columns that are counted,
`acc.0`, `acc.1`, `acc.2`.
"""

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source
from pdr_est.io.text.unpacked.tables_source import source_of_tables

_OPENING = (b"{", b"[")
_LARGEST_BYTES = 512 * 1024**2  # as Python objects JSON needs about ten times its size
_LONGEST_VECTOR = 16
_DEEPEST = 5
_FEWEST_ROWS = 2
_NAMED_WITHIN = 200

Records = list[Mapping[str, Any]]


def unpack_json(source: Source) -> Source:
    """Return the lists of records in a JSON file as a source of tables; any other source as it is.

    Raises
    ------
    RecordingError
        For JSON that is damaged or too large.
    """
    if len(source.members) != 1 or not source.head(source.members[0], 64).lstrip(b"\xef\xbb\xbf \r\n\t").startswith(
        _OPENING
    ):
        return source
    data = source.read(source.members[0])
    if len(data) > _LARGEST_BYTES:
        raise RecordingError(f"{source.path}: JSON of more than 512 MB; export the recording as CSV")
    lists = _lists_of_records(_parsed(data, str(source.path)))
    found = {name: records for name, records in lists.items() if len(records) >= _FEWEST_ROWS}
    if not found:
        return source
    names = {"": next(iter(found.values()))} if len(found) == 1 else found
    return source_of_tables(source, {name: _as_csv(records) for name, records in names.items()}, "list")


def _parsed(data: bytes, place: str) -> Any:
    """Parse JSON, or JSON of which each line is a value by itself; nothing where the first line is none."""
    try:
        text = data.decode("utf-8-sig")
        return json.loads(text)
    except (UnicodeDecodeError, RecursionError):
        return None
    except json.JSONDecodeError as error:
        lines = [line for line in text.split("\n") if line.strip()]
        values = [_value_of_line(line) for line in lines]
        wrong = [number for number, value in enumerate(values, start=1) if value is None]
        if 1 in wrong:
            if '"' not in text[:_NAMED_WITHIN]:  # names stand in quotes: it is other text in brackets
                return None
            raise RecordingError(
                f"{place}, line {error.lineno}: damaged or truncated JSON ({error.msg}); export it again"
            ) from error
        if wrong and wrong != [len(values)]:  # the last line is cut where a recorder was stopped
            raise RecordingError(f"{place}, line {wrong[0]}: damaged JSON; correct or remove it") from error
        return values[: len(values) - len(wrong)]


def _value_of_line(line: str) -> Any:
    try:
        return json.loads(line)
    except (json.JSONDecodeError, RecursionError):
        return None


def _lists_of_records(value: Any) -> dict[str, Records]:
    """Find name -> records in what a file holds."""
    if isinstance(value, Mapping):
        columns = _columns(value)
        if columns:
            return {"": columns}
        inner = {name: one for name, one in value.items() if isinstance(one, Mapping | list)}
        return {
            f"{name}.{below}" if below else str(name): records
            for name, one in inner.items()
            for below, records in _lists_of_records(one).items()
        }
    if not isinstance(value, list) or not value or not all(isinstance(one, Mapping) for one in value):
        return {}
    nested = {name for name, one in value[0].items() if _is_list_of_records(one)}
    if len(nested) == 1:  # messages, each with some of the records
        name = nested.pop()
        return {"": [record for one in value for record in one.get(name, ()) if isinstance(record, Mapping)]}
    return {"": list(value)}


def _is_list_of_records(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, Mapping) for one in value)


def _columns(value: Mapping[str, Any]) -> Records:
    """Turn lists of equal length, one for each column, into records; nothing where there are none."""
    lists = {
        name: one
        for name, one in value.items()
        if isinstance(one, list) and len(one) > _LONGEST_VECTOR and not any(isinstance(cell, Mapping) for cell in one)
    }
    if len(lists) < 2 or len({len(one) for one in lists.values()}) > 1:
        return []
    return [dict(zip(lists, row, strict=True)) for row in zip(*lists.values(), strict=True)]


def _as_csv(records: Records) -> bytes:
    rows = [dict(_cells(record, "", 0)) for record in records]
    titles = list(dict.fromkeys(title for row in rows for title in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, titles, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


def _cells(value: Any, title: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Iterate over title -> cell of a record, with the names inside each other joined by points."""
    inside: Sequence[tuple[Any, Any]] = ()
    if isinstance(value, Mapping):
        inside = list(value.items())
    elif isinstance(value, list) and len(value) <= _LONGEST_VECTOR:
        inside = list(enumerate(value))
    elif not isinstance(value, list):
        yield title, "" if value is None else value
    if depth < _DEEPEST:
        for name, one in inside:
            yield from _cells(one, f"{title}.{name}" if title else str(name), depth + 1)
