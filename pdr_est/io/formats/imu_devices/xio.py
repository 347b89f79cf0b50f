"""Read CSV exports of x-io Technologies (x-IMU3, NGIMU): `Gyroscope X (deg/s)`, `Accelerometer X (g)`.

x-IMU3 writes `Inertial.csv` beside `Magnetometer.csv` and others; NGIMU writes `sensors.csv`. Specific force points
up at rest.
"""

import re

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import members_marked, read_named_table
from pdr_est.io.text.container import Source
from pdr_est.types.recording import Recording

NAME = "x-io"

_MARK = re.compile(rb"Gyroscope X \(deg/s\)[^\n]*Accelerometer X \(g\)")


def sniff(source: Source) -> bool:
    """Tell whether a member has the titles of these devices."""
    return bool(members_marked(source, _MARK))


def read_source(source: Source) -> Recording:
    """Read the walk of the table with the inertial sensors.

    Raises
    ------
    RecordingError
        For several tables, for one without time, and when no motion sensor has values.
    """
    device = RawDevice({}, sign=1.0, sign_reason="the sign of x-io")
    members = members_marked(source, _MARK)
    others = [member for member in source.members if member not in members]
    if others:
        device.decisions.append(f"files not used: {', '.join(others)}")
    return read_named_table(source, members, NAME, device)
