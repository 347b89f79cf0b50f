"""Read inertial data in the layout of EuRoC and TUM VI: `mav0/imu0/data.csv`, with the reference in a folder beside.

Titles are `timestamp [ns]`, `w_RS_S_x [rad s^-1]`, `a_RS_S_x [m s^-2]`; specific force points up at rest. The axes
are those of the sensor, not of a phone.
"""

import re
from dataclasses import replace

import numpy as np

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat, with_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.container import Source
from pdr_est.io.text.number_table import read_table
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import Recording

NAME = "EuRoC, TUM VI"

_MARK = re.compile(rb"w_RS_S_x[^\n]*a_RS_S_x|a_RS_S_x[^\n]*w_RS_S_x")
_RATE, _FORCE = "w_RS_S_", "a_RS_S_"
_REFERENCES = ("state_groundtruth_estimate0", "mocap0", "vicon0", "leica0")


def sniff(source: Source) -> bool:
    """Tell whether a member has the titles of this layout."""
    return _TABLE.sniff(source)


def read_source(source: Source) -> Recording:
    """Read the walk of a sequence, with the true positions if they lie beside it.

    Raises
    ------
    RecordingError
        For several sequences, and when no motion sensor has values.
    """
    member, _, _ = _TABLE.meaning_of(source)
    recording = _TABLE.read_source(source.with_only(member))
    positions = _reference(source, member, recording.epoch_s)
    return recording if positions is None else replace(recording, truth=Truth(positions=positions))


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, sign=1.0, sign_reason="specific force is up at rest in this layout", usual_axes=False)


def _mapping(layout: TableLayout) -> TableMapping:
    def axes(stem: str) -> list[str]:
        return [next((t for t in layout.titles if t.startswith(f"{stem}{axis}")), stem) for axis in "xyz"]

    clocks = {layout.titles[0]: 1e-9 if "ns" in layout.titles[0] else None}
    return with_columns(layout, {Quantity.RATE: (axes(_RATE), 1.0), Quantity.FORCE: (axes(_FORCE), 1.0)}, clocks)


_TABLE = NamedTableFormat(NAME, _MARK, _device, _mapping)


def _reference(source: Source, member: str, epoch_s: float | None) -> TruePositions | None:
    """Read the table of the reference, whose first columns are time in ns and position, m."""
    if epoch_s is None:
        return None
    tables = (source.sibling(member, f"../{name}/data.csv") for name in _REFERENCES)
    found = next((table for table in tables if table is not None), None)
    if found is None:
        return None
    rows = b"\n".join(line for line in found.read(found.members[0]).splitlines() if not line.startswith(b"#"))
    table = read_table(rows, str(found.path), has_header=False)
    ticks = table.columns[table.names[0]]
    time_s = (ticks - round(epoch_s * 1e9)).astype(np.float64) / 1e9
    position_m = table.stack(table.names[1:3])
    kept = np.isfinite(time_s) & np.isfinite(position_m).all(axis=1)
    return TruePositions(time_s[kept], position_m[kept], 0.0, "poses")
