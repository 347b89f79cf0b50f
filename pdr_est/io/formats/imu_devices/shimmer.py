"""Read CSV exports of Shimmer sensors by Consensys: titles such as `Shimmer_8E3A_Accel_LN_X_CAL`, a row of units.

The low-noise accelerometer is preferred to the wide-range one. Specific force points up at rest.
"""

import re
from collections.abc import Sequence

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, title_with_end, with_columns
from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.quantities import Quantity, unit_factor
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(rb"_Timestamp_\w*CAL|_(?:Accel_(?:LN|WR)|Gyro)_X_CAL")
_STEMS = {
    Quantity.FORCE: ("Accel_LN", "Accel_WR", "Low_Noise_Accelerometer", "Wide_Range_Accelerometer"),
    Quantity.RATE: ("Gyro", "Gyroscope"),
    Quantity.FIELD: ("Mag", "Magnetometer"),
}
_CLOCKS = (
    "Timestamp_Unix_CAL",
    "TimestampSync_Unix_CAL",
    "Timestamp_CAL",
    "TimestampSync_CAL",
    "Timestamp_Shimmer_CAL",
)


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, sign=1.0, sign_reason="the sign of Shimmer")


def _mapping(layout: TableLayout) -> TableMapping:
    unit_of = dict(zip(layout.titles, layout.units, strict=False))
    known: dict[Quantity, tuple[Sequence[str], float | None]] = {}
    for quantity, stems in _STEMS.items():
        for stem in stems:
            titles = [title_with_end(layout, f"{stem}_{axis}_CAL") for axis in "XYZ"]
            if all(titles) and quantity not in known:
                known[quantity] = (titles, unit_factor(quantity, unit_of.get(titles[0], "")))
    mapping = with_columns(layout, known, without=tuple(quantity for quantity in _STEMS if quantity not in known))
    clocks = tuple(
        ClockColumn(title, unit_factor(Quantity.TIME, unit_of.get(title, "")))
        for name in _CLOCKS
        if (title := title_with_end(layout, name))
    )
    return TableMapping(clocks or mapping.clocks, mapping.columns, unused=mapping.unused)


FORMAT = NamedTableFormat("Shimmer", _MARK, _device, _mapping)
"""The format, for the registry."""
