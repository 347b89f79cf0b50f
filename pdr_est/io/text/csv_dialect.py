"""Separator, decimal mark and column titles of a table with a header line, found from its first lines."""

import csv
import re
from dataclasses import dataclass

_SEPARATORS = ("\t", ";", ",")
_QUOTED = re.compile(r'"[^"]*"')
_DECIMAL_COMMA = re.compile(r"\d,\d")


@dataclass(frozen=True)
class CsvDialect:
    """How a table is written. titles: of the columns, without quotes and outer blanks."""

    separator: str
    decimal_comma: bool
    titles: tuple[str, ...]


def detect_dialect(head: bytes) -> CsvDialect | None:
    """The dialect of a table from its first bytes; None when the first line does not look like a header.

    The separator is the one that the header has most of outside quotes. Where it is not a comma, a comma between
    two digits of the first row is a decimal mark.
    """
    lines = head.decode("utf-8-sig", "replace").splitlines()
    if not lines or not lines[0].strip():
        return None
    bare = _QUOTED.sub("", lines[0])
    separator = max(_SEPARATORS, key=bare.count)
    if bare.count(separator) == 0:
        return None
    titles = tuple(title.strip() for title in next(csv.reader([lines[0]], delimiter=separator)))
    decimal_comma = separator != "," and len(lines) > 1 and _DECIMAL_COMMA.search(lines[1]) is not None
    return CsvDialect(separator, decimal_comma, titles)
