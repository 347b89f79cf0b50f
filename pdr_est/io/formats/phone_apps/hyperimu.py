"""Read tables of HyperIMU, Android: two lines that begin with `@`, and titles such as `MPL_Accelerometer.x`.

The time of the rows is optional; without it the sampling time of the header tells it.
"""

import re
from dataclasses import replace

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import members_marked, read_named_table, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.text.container import Source
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.types.recording import Recording

NAME = "HyperIMU"

_MARK = re.compile(rb"\A@ ?HyperIMU")
_SAMPLING = re.compile(r"Sampling Time:\s*(\d+)\s*ms")


def sniff(source: Source) -> bool:
    """Tell whether a member begins with this app's name."""
    return bool(members_marked(source, _MARK))


def read_source(source: Source) -> Recording:
    """Read the walk of a table.

    Raises
    ------
    RecordingError
        For several tables, and when no motion sensor has values.
    """
    device = RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")
    return read_named_table(source, members_marked(source, _MARK), NAME, device, _mapping)


def _mapping(layout: TableLayout) -> TableMapping:
    mapping = with_columns(layout, {})
    sampling = next((found for line in layout.preamble if (found := _SAMPLING.search(line))), None)
    if mapping.clocks or sampling is None:
        return mapping
    return replace(mapping, rate_hz=1e3 / float(sampling.group(1)))
