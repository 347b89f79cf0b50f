"""Read CSV exports of ROS messages of type `sensor_msgs/Imu`: rostopic, bagpy, PlotJuggler and others.

`linear_acceleration` is with gravity and up at rest, as the standard of ROS demands (REP 145), in m/s^2; rates are in
rad/s. The time of the message's header is better than that of its arrival.
"""

import re
from collections.abc import Sequence

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, title_with_end, with_columns
from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(
    rb"linear_acceleration[./_]x[\"']?\s*[,;\t][^\n]*angular_velocity[./_]x|"
    rb"angular_velocity[./_]x[\"']?\s*[,;\t][^\n]*linear_acceleration[./_]x"
)
_STEMS = {Quantity.FORCE: "linear_acceleration", Quantity.RATE: "angular_velocity", Quantity.ATTITUDE: "orientation"}


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, sign=1.0, sign_reason="the standard of ROS", usual_axes=False)


def _mapping(layout: TableLayout) -> TableMapping:
    known: dict[Quantity, tuple[Sequence[str], float | None]] = {}
    for quantity, stem in _STEMS.items():
        axes = "wxyz" if quantity is Quantity.ATTITUDE else "xyz"
        titles = [title_with_end(layout, rf"{stem}[./_]{axis}") for axis in axes]
        if all(titles):
            known[quantity] = (titles, None if quantity is Quantity.ATTITUDE else 1.0)
    # Titles with more than the field, such as a unit, are left to what titles mean everywhere.
    named = (Quantity.LINEAR,) if Quantity.FORCE in known else ()
    mapping = with_columns(layout, known, without=(*named, Quantity.ROTATION_VECTOR))
    seconds = title_with_end(layout, r"stamp[./_](?:secs?)")
    nanoseconds = title_with_end(layout, r"stamp[./_](?:n(?:ano)?secs?)")
    stamp = title_with_end(layout, r"header[./_]stamp")
    clocks = [ClockColumn(seconds, 1.0, nanoseconds)] if seconds and nanoseconds else []
    clocks += [ClockColumn(stamp)] if stamp else []
    taken = {title for clock in clocks for title in (clock.title, clock.fraction)}
    rest = tuple(clock for clock in mapping.clocks if clock.title not in taken)
    return TableMapping((*clocks, *rest), mapping.columns, unused=mapping.unused)


FORMAT = NamedTableFormat("ROS Imu messages", _MARK, _device, _mapping)
"""The format, for the registry."""
