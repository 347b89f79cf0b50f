"""Read tables of HyperIMU, Android: two lines that begin with `@`, and titles such as `MPL_Accelerometer.x`.

The time of the rows is optional; without it the sampling time of the header tells it.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.split.long_table import is_second_choice
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(rb"\A@ ?HyperIMU")
_VECTORS = (Quantity.FORCE, Quantity.LINEAR, Quantity.GRAVITY, Quantity.RATE, Quantity.FIELD)
_SAMPLING = re.compile(r"Sampling Time:\s*(\d+)\s*ms")


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")


def _mapping(layout: TableLayout) -> TableMapping:
    """Find the sensors by the names that their makers give them, such as `LSM6DSO Accelerometer Non-wakeup.x`."""
    sensors: dict[str, dict[str, str]] = {}
    for title in layout.titles:
        name, _, axis = title.rpartition(".")
        sensors.setdefault(name, {})[axis.strip().casefold()] = title
    known: dict[Quantity, tuple[Sequence[str], float | None]] = {}
    for name in sorted(sensors, key=is_second_choice):
        quantity, titles = sensor_by_name(name), [sensors[name].get(axis, "") for axis in "xyz"]
        if quantity in _VECTORS and quantity is not None and all(titles):
            known.setdefault(quantity, (titles, 1.0))
    mapping = with_columns(layout, known)
    sampling = next((found for line in layout.preamble if (found := _SAMPLING.search(line))), None)
    if mapping.clocks or sampling is None:
        return mapping
    return replace(mapping, rate_hz=1e3 / float(sampling.group(1)))


FORMAT = NamedTableFormat("HyperIMU", _MARK, _device, _mapping)
"""The format, for the registry."""
