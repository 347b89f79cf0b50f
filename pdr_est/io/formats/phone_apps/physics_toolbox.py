"""Read tables of Physics Toolbox Sensor Suite: any subset of g-force, linear acceleration, gyroscope and others.

`gFx` is the acceleration with gravity in g, `ax` is without gravity in m/s^2, `wx` is in rad/s, `Bx` in uT. On
Android the time counts seconds from the start and gravity points up; on iOS it is a date, and gravity points down.
"""

import re

from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.table_layout import TableLayout

# With g-force; or, without it, the blank first line and the comma at the end of the header that this app writes.
_MARK = re.compile(
    rb'^"?time"?[,;](?=[^\n]*\bgFx\b)(?=[^\n]*\bgFy\b)[^\n]*\bgFz\b|\A\s*\n"?time"?[,;](?:(?:[awB][xyz]|TgF|aT|wT|BT)[,;])+\s*$',
    re.MULTILINE | re.IGNORECASE,
)
_DATED_ROW = re.compile(rb"^\"?\d{4}-\d{1,2}-\d{1,2}[ T]", re.MULTILINE)


def _device(head: bytes) -> RawDevice:
    dated = _DATED_ROW.search(head) is not None
    platform, sign = ("ios", -1.0) if dated else ("android", 1.0)
    return RawDevice(
        {},
        platform=platform,
        sign=sign,
        sign_reason="iOS writes dates as time" if dated else "Android writes seconds as time",
        without_gravity="record with g-Force Meter, not only Linear Accelerometer",
    )


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


FORMAT = NamedTableFormat("Physics Toolbox", _MARK, _device, _mapping)
"""The format, for the registry."""
