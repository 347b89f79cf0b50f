"""Read RIDI sequences: `data.csv` of an Android phone at 200 Hz with the pose of the same phone (Tango).

Columns are `time` (ns), `gyro_x`, `acce_x`, `linacce_x`, `grav_x`, `magnet_x`, the rotation vector `rv_w`, and
position and attitude of Tango, `pos_x` and `ori_w`, which are the reference.
"""

import re

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(rb"^[^\n]*\bgyro_x\b[^\n]*\bacce_x\b[^\n]*\bpos_x\b[^\n]*\bori_w\b", re.MULTILINE)


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")


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


FORMAT = NamedTableFormat("RIDI", _MARK, _device, _mapping, BESIDE=re.compile(r".+\.txt(?:\.gz)?"))
"""The format, for the registry."""
