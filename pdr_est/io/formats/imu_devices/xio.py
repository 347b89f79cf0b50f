"""Read CSV exports of x-io Technologies (x-IMU3, NGIMU): `Gyroscope X (deg/s)`, `Accelerometer X (g)`.

x-IMU3 writes `Inertial.csv` beside `Magnetometer.csv` and others; NGIMU writes `sensors.csv`. Specific force points
up at rest.
"""

import re

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat

_MARK = re.compile(rb"Gyroscope X \(deg/s\)[^\n]*Accelerometer X \(g\)")


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, sign=1.0, sign_reason="the sign of x-io")


FORMAT = NamedTableFormat("x-io", _MARK, _device)
"""The format, for the registry."""
