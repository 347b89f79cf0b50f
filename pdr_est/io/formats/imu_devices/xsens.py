"""Read exports of Xsens and Movella: DOT and Awinda as CSV, and the text files of MT Manager.

Accelerations are in m/s^2, up at rest. DOT gives rotation rates in deg/s and its `SampleTimeFine` in us; MT Manager
gives rad/s and ticks of 0.1 ms, or only a packet counter beside the update rate of the header. `FreeAcc` is without
gravity and in the axes of the room, so that it is not used.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.table_layout import TableLayout

_MARK = re.compile(rb"^(?:PacketCounter|Counter|SampleTimeFine)\b[^\n]*\bAcc_X\b", re.MULTILINE)
_RATE = re.compile(r"(?:Update Rate|OutputRate|Sample rate)\s*:?[,\s]*([\d.]+)", re.IGNORECASE)
_MT_MANAGER = re.compile(r"^//")
_DOT_TICK_S, _MT_TICK_S = 1e-6, 1e-4
_COUNTERS = ("PacketCounter", "Counter")
_CLOCK = "SampleTimeFine"


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, sign=1.0, sign_reason="the sign of Xsens")


def _mapping(layout: TableLayout) -> TableMapping:
    manager = any(_MT_MANAGER.match(line) for line in layout.preamble)
    quaternion = next(
        names
        for names in (_axes("Quat_", ("W", "X", "Y", "Z")), _axes("Quat_q", "0123"), ())
        if set(names) <= set(layout.titles)
    )
    known: dict[Quantity, tuple[Sequence[str], float | None]] = {
        Quantity.FORCE: (_axes("Acc_", "XYZ"), 1.0),
        Quantity.RATE: (_axes("Gyr_", "XYZ"), 1.0 if manager else np.pi / 180.0),
    }
    if quaternion:
        known[Quantity.ATTITUDE] = (quaternion, None)
    mapping = with_columns(layout, known, without=(Quantity.LINEAR, Quantity.ROTATION_VECTOR, Quantity.FIELD))
    if _CLOCK in layout.titles and _has_cell(layout, _CLOCK):
        clock = ClockColumn(_CLOCK, _MT_TICK_S if manager else _DOT_TICK_S)
        return replace(mapping, clocks=(clock,))
    counter = next((title for title in _COUNTERS if title in layout.titles), None)
    rate = next((found for line in layout.preamble if (found := _RATE.search(line))), None)
    if counter is not None and rate is not None:
        return replace(mapping, clocks=(ClockColumn(counter, 1.0 / float(rate.group(1))),))
    return mapping


def _axes(stem: str, axes: Sequence[str]) -> list[str]:
    return [f"{stem}{axis}" for axis in axes]


def _has_cell(layout: TableLayout, title: str) -> bool:
    return layout.sample[layout.titles.index(title)] != ""


FORMAT = NamedTableFormat("Xsens, Movella", _MARK, _device, _mapping)
"""The format, for the registry."""
