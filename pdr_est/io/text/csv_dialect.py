"""Detect separator, decimal mark and column titles of a table with a header line, from its first lines."""

import csv
import re
from dataclasses import dataclass

_SEPARATORS = ("\t", ";", ",")
_QUOTED = re.compile(r'"[^"]*"')
_DECIMAL_COMMA = re.compile(r"\d,\d")


@dataclass(frozen=True)
class CsvDialect:
    """Way in which a table is written.

    Attributes
    ----------
    separator
        Character between two cells.
    decimal_comma
        True when a comma is the decimal mark.
    titles
        Titles of the columns, without quotes and outer blanks.
    """

    separator: str
    decimal_comma: bool
    titles: tuple[str, ...]


def detect_dialect(head: bytes) -> CsvDialect | None:
    """Detect the dialect of a table from its first bytes.

    The separator is the character (tab, semicolon or comma) that is most frequent in the header outside quotes. Where
    it is not a comma, a comma between two digits of the first row is a decimal mark.

    Returns
    -------
    CsvDialect or None
        None when the first line does not look like a header.
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
