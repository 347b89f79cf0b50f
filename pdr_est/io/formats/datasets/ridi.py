"""Read RIDI sequences: `data.csv` of an Android phone at 200 Hz with the pose of the same phone (Tango).

Columns are `time` (ns), `gyro_x`, `acce_x`, `linacce_x`, `grav_x`, `magnet_x`, the rotation vector `rv_w`, and
position and attitude of Tango, `pos_x` and `ori_w`, which are the reference.
"""

import re

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import members_marked, read_named_table, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.container import Source
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.types.recording import Recording

NAME = "RIDI"

_MARK = re.compile(rb"^[^\n]*\bgyro_x\b[^\n]*\bacce_x\b[^\n]*\bpos_x\b[^\n]*\bori_w\b", re.MULTILINE)


def sniff(source: Source) -> bool:
    """Tell whether a member has the titles of this data set."""
    return bool(members_marked(source, _MARK))


def read_source(source: Source) -> Recording:
    """Read the walk of a sequence: one phone, with its true positions.

    Raises
    ------
    RecordingError
        For several sequences, and when no motion sensor has values.
    """
    device = RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")
    return read_named_table(source, members_marked(source, _MARK), NAME, device, _mapping)


def _mapping(layout: TableLayout) -> TableMapping:
    def axes(stem: str, names: str = "xyz") -> list[str]:
        return [f"{stem}_{axis}" for axis in names]

    return with_columns(
        layout,
        {
            Quantity.FORCE: (axes("acce"), 1.0),
            Quantity.LINEAR: (axes("linacce"), 1.0),
            Quantity.GRAVITY: (axes("grav"), 1.0),
            Quantity.RATE: (axes("gyro"), 1.0),
            Quantity.FIELD: (axes("magnet"), 1.0),
            Quantity.ATTITUDE: (axes("rv", "wxyz"), None),
            Quantity.TRUE_POSITION: (axes("pos", "xy"), 1.0),
        },
        {"time": 1e-9},
        without=(Quantity.ROTATION_VECTOR,),
    )
