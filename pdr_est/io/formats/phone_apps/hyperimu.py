"""Read tables of HyperIMU, Android: two lines that begin with `@`, and titles such as `MPL_Accelerometer.x`.

The time of the rows is optional; without it the sampling time of the header tells it.
"""

import re
from dataclasses import replace

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(rb"\A@ ?HyperIMU")
_SAMPLING = re.compile(r"Sampling Time:\s*(\d+)\s*ms")


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")


def _mapping(layout: TableLayout) -> TableMapping:
    mapping = with_columns(layout, {})
    sampling = next((found for line in layout.preamble if (found := _SAMPLING.search(line))), None)
    if mapping.clocks or sampling is None:
        return mapping
    return replace(mapping, rate_hz=1e3 / float(sampling.group(1)))


FORMAT = NamedTableFormat("HyperIMU", _MARK, _device, _mapping)
"""The format, for the registry."""
