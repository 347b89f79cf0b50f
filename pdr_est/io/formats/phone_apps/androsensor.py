"""Read tables of AndroSensor, Android: titles in capitals with units, at 0.5 to 100 Hz, 2 Hz unless changed.

Columns are `ACCELEROMETER X (m/s²)`, `GRAVITY X`, `LINEAR ACCELERATION X`, `GYROSCOPE X (rad/s)`,
`LOCATION Latitude :` and `Time since start in ms`. Every row repeats the last position.
"""

import re

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(rb"(?:ACCELEROMETER|GYROSCOPE|LINEAR ACCELERATION) X \(|YYYY-MO-DD HH-MI-SS_SSS")


def _device(_head: bytes) -> RawDevice:
    return RawDevice(
        {},
        platform="android",
        sign=1.0,
        sign_reason="Android's sign",
        without_gravity="switch on Accelerometer, not only Linear acceleration",
    )


def _mapping(layout: TableLayout) -> TableMapping:
    """Leave out ORIENTATION, which is angles in degrees."""
    return with_columns(layout, {}, without=(Quantity.ROTATION_VECTOR,))


FORMAT = NamedTableFormat("AndroSensor", _MARK, _device, _mapping)
"""The format, for the registry."""
