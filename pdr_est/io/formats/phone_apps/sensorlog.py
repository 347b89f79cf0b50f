"""Read tables of SensorLog (Bernd Thomas, iOS): one wide table of all sensors, with Core Motion's quantities in g.

Gravity points down at rest, as everywhere in Core Motion. The clocks of accelerometer and motion count from the start
of the phone and are steadier than `loggingTime`, which tells the Unix time. Rows repeat the last value of slow
sensors.
"""

import re
from collections.abc import Sequence

from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(rb"loggingTime|accelerometerTimestamp_sinceReboot|motionTimestamp_sinceReboot|motionUserAccel")
_CLOCKS = ("accelerometerTimestamp_sinceReboot", "motionTimestamp_sinceReboot", "loggingTime", "loggingSample")
_AXES = "XYZ"


def _device(_head: bytes) -> RawDevice:
    return RawDevice(
        {},
        platform="ios",
        sign=-1.0,
        sign_reason="Core Motion's sign",
        without_gravity="switch on Accelerometer, or Device Motion with gravity",
    )


def _mapping(layout: TableLayout) -> TableMapping:
    by_stem = {re.sub(r"\s*\(.*\)$", "", title): title for title in layout.titles}

    def titles(stem: str, axes: str = _AXES) -> Sequence[str]:
        return [by_stem.get(f"{stem}{axis}", f"{stem}{axis}") for axis in axes]

    rate = next(stem for stem in ("motionRotationRate", "gyroRotation", "") if f"{stem}X" in by_stem or not stem)
    known: dict[Quantity, tuple[Sequence[str], float | None]] = {
        Quantity.FORCE: (titles("accelerometerAcceleration"), STANDARD_GRAVITY_MPS2),
        Quantity.LINEAR: (titles("motionUserAcceleration"), STANDARD_GRAVITY_MPS2),
        Quantity.GRAVITY: (titles("motionGravity"), STANDARD_GRAVITY_MPS2),
        Quantity.RATE: (titles(rate), 1.0),
        Quantity.FIELD: (titles("motionMagneticField"), 1.0),
        Quantity.ATTITUDE: (titles("motionQuaternion", "WXYZ"), None),
    }
    clocks = {by_stem[stem]: (1.0 if "Timestamp" in stem else None) for stem in _CLOCKS if stem in by_stem}
    mapping = with_columns(layout, known, clocks, without=(Quantity.ROTATION_VECTOR,))
    kept = tuple(clock for clock in mapping.clocks if clock.title in clocks) or mapping.clocks
    return TableMapping(kept, mapping.columns, unused=mapping.unused)


FORMAT = NamedTableFormat("SensorLog", _MARK, _device, _mapping)
"""The format, for the registry."""
