"""Read tables of Physics Toolbox Sensor Suite: any subset of g-force, linear acceleration, gyroscope and others.

`gFx` is the acceleration with gravity in g, `ax` is without gravity in m/s^2, `wx` is in rad/s, `Bx` in uT. On
Android the time counts seconds from the start and gravity points up; on iOS it is a date, and gravity points down.
"""

import re
from dataclasses import replace

from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import members_marked, read_named_table, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.container import Source
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.types.recording import Recording

NAME = "Physics Toolbox"

# With g-force; or, without it, the blank first line and the comma at the end of the header that this app writes.
_MARK = re.compile(
    rb'^"?time"?[,;][^\n]*\bgF[xyz]\b|\A\s*\n"?time"?[,;](?:(?:[awB][xyz]|TgF|aT|wT|BT)[,;])+\s*$',
    re.MULTILINE | re.IGNORECASE,
)
_DATED_ROW = re.compile(rb"^\"?\d{4}-\d{1,2}-\d{1,2}[ T]", re.MULTILINE)


def sniff(source: Source) -> bool:
    """Tell whether a member has the titles of this app."""
    return bool(members_marked(source, _MARK))


def read_source(source: Source) -> Recording:
    """Read the walk of a table.

    Raises
    ------
    RecordingError
        For several tables, and when no motion sensor has values.
    """
    members = members_marked(source, _MARK)
    device = RawDevice({}, without_gravity="record with g-Force Meter, not only Linear Accelerometer")
    if len(members) == 1:
        dated = _DATED_ROW.search(source.head(members[0])) is not None
        platform, sign = ("ios", -1.0) if dated else ("android", 1.0)
        reason = "iOS writes dates as time" if dated else "Android writes seconds as time"
        device = replace(device, platform=platform, sign=sign, sign_reason=reason)
    return read_named_table(source, members, NAME, device, _mapping)


def _mapping(layout: TableLayout) -> TableMapping:
    by_name = {title.casefold(): title for title in layout.titles}

    def axes(stem: str) -> list[str]:
        return [by_name.get(f"{stem}{axis}", f"{stem}{axis}") for axis in "xyz"]

    known: dict[Quantity, tuple[list[str], float | None]] = {
        Quantity.FORCE: (axes("gf"), STANDARD_GRAVITY_MPS2),
        Quantity.LINEAR: (axes("a"), 1.0),
        Quantity.RATE: (axes("w"), 1.0),
        Quantity.FIELD: (axes("b"), 1.0),
    }
    return with_columns(layout, known, without=(Quantity.FORCE,))
