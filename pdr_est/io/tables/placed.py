"""Put the signals of several tables on one clock."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from pdr_est.io.conversion.raw_device import RawDevice, RawSignal
from pdr_est.io.tables.quantities import MOTION, Quantity
from pdr_est.io.tables.signals import TableSignals
from pdr_est.types.recording import Signal

_MARGIN_S = 60.0  # a fix or a slow sensor may begin before or end after the motion


@dataclass(frozen=True)
class PlacedSignal:
    """Signal of a table on the clock of the recording, with the table that it comes from.

    Attributes
    ----------
    raw
        The samples.
    table
        The table.
    """

    raw: RawSignal
    table: TableSignals

    def is_ambiguous(self, quantity: Quantity) -> bool:
        """Tell whether the titles of the signal leave open whether it is this quantity."""
        columns = self.table.mapping.columns.get(quantity)
        return columns is not None and columns.ambiguous

    def is_nameless(self, quantity: Quantity) -> bool:
        """Tell whether the titles of the signal name axes but no sensor."""
        columns = self.table.mapping.columns.get(quantity)
        return columns is not None and columns.nameless

    @property
    def other_order(self) -> tuple[int, ...]:
        """Return the other order in which the axes of a rotation rate may be meant; empty where its titles tell."""
        columns = self.table.mapping.columns.get(Quantity.RATE)
        return () if columns is None else columns.other_order


def first_motion(tables: Sequence[TableSignals]) -> TableSignals:
    """Return the table with motion that begins first; its first row is time zero."""
    motion = [table for table in tables if set(MOTION) & set(table.signals)]
    return min(motion or tables, key=lambda table: table.clock.start)


def place_signals(
    tables: Sequence[TableSignals], zero: Fraction, epoch_s: float | None, device: RawDevice
) -> dict[Quantity, PlacedSignal]:
    """Put all signals on the clock of the recording.

    Parameters
    ----------
    tables
        Tables of one device; the first one with a quantity gives it.
    zero, epoch_s
        Time zero on the recorder's clock, s, and its Unix time.
    device
        Where decisions and warnings are kept.
    """
    placed: dict[Quantity, PlacedSignal] = {}
    for table in tables:
        shift_s = float(table.clock.start - zero)
        for quantity, raw in table.signals.items():
            if quantity in placed:
                device.decisions.append(f"not used: {raw.title} of {table.place}; there is another {quantity}")
                continue
            signal = raw.signal if shift_s == 0.0 else Signal(raw.signal.time_s + shift_s, raw.signal.values)
            placed[quantity] = PlacedSignal(replace(raw, signal=signal), table)
    _check_overlap(placed, zero, epoch_s, device)
    return placed


def _check_overlap(
    placed: dict[Quantity, PlacedSignal], zero: Fraction, epoch_s: float | None, device: RawDevice
) -> None:
    """Bring tables on another clock to that of the motion by their Unix time; leave them out where there is none."""
    base = next((placed[quantity].raw.signal for quantity in MOTION if quantity in placed), None)
    if base is None:
        return
    start_s, end_s = float(base.time_s.min()) - _MARGIN_S, float(base.time_s.max()) + _MARGIN_S
    for quantity, one in list(placed.items()):
        times = one.raw.signal.time_s
        if float(times.max()) >= start_s and float(times.min()) <= end_s:
            continue
        if epoch_s is not None and one.table.clock.epoch_s is not None:
            shift_s = one.table.clock.epoch_s - epoch_s - float(one.table.clock.start - zero)
            signal = Signal(times + shift_s, one.raw.signal.values)
            placed[quantity] = replace(one, raw=replace(one.raw, signal=signal))
            continue
        device.warnings.append(
            f"{quantity}: left out because its times do not overlap those of the motion; record both with one clock"
        )
        del placed[quantity]
