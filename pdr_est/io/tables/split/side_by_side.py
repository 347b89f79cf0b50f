"""Split tables side by side in one file: each sensor has a time column of its own, and its own number of rows."""

from dataclasses import replace

import numpy as np

from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import TableSignals, signals_of
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.loose_table import LooseTable, read_loose_table
from pdr_est.io.text.table_layout import TableLayout

_SAME_SHARE = 0.01  # of the length of the clocks, by which two clocks of one row may differ


def read_side_by_side(
    text: bytes, place: str, layout: TableLayout, hint: Quantity | None = None
) -> tuple[TableSignals, ...]:
    """Read the sensors of a table on the clock that is named after each; empty where the rows have one clock.

    Parameters
    ----------
    text
        Content in UTF-8.
    place
        Name of the file, for messages.
    layout
        How the table is written.
    hint
        Quantity that the name of the file tells; None when it tells none.
    """
    if not layout.has_header:
        return ()
    whole = understand_titles(layout.titles, hint, layout.units)
    own = _clocks_of_sensors(whole)
    if len(own) < 2:
        return ()
    numbers = [title for columns in whole.columns.values() for title in columns.titles]
    times = [title for clock in whole.clocks for title in (clock.title, clock.fraction) if title]
    loose = read_loose_table(text, place, layout, numbers, times)
    if not _differ(loose, [clock.title for clock in own.values()]):
        return ()
    rest = {quantity: columns for quantity, columns in whole.columns.items() if quantity not in own}
    found = []
    for number, (quantity, clock) in enumerate(own.items()):
        columns = {quantity: whole.columns[quantity]} | (rest if number == 0 else {})
        mapping = replace(whole, clocks=(clock,), columns=columns, unused=whole.unused if number == 0 else ())
        found.append(signals_of(_rows_with_time(loose, clock), mapping))
    note = f"each sensor has a clock of its own: {', '.join(clock.title for clock in own.values())}"
    found[0] = replace(found[0], decisions=(note, *found[0].decisions))
    return tuple(found)


def _clocks_of_sensors(mapping: TableMapping) -> dict[Quantity, ClockColumn]:
    """Find the clock of each sensor that the title of a clock names."""
    found: dict[Quantity, ClockColumn] = {}
    for clock in mapping.clocks:
        quantity = sensor_by_name(clock.title)
        if quantity is not None and quantity in mapping.columns:
            found.setdefault(quantity, clock)
    return found


def _differ(loose: LooseTable, clocks: list[str]) -> bool:
    """Tell whether the clocks (numbers) do not run side by side, row by row."""
    if any(title in loose.text_columns for title in clocks):
        return False
    first = loose.table.numbers(clocks[0])
    for title in clocks[1:]:
        other = loose.table.numbers(title)
        both = np.isfinite(first) & np.isfinite(other)
        if not both.any():
            return True
        apart = np.ptp((other - first)[both])
        if apart > _SAME_SHARE * np.ptp(first[both]) or both.mean() < 1.0 - _SAME_SHARE:
            return True
    return False


def _rows_with_time(loose: LooseTable, clock: ClockColumn) -> LooseTable:
    """Leave out the rows below the end of the shorter of two tables."""
    known = np.isfinite(loose.table.numbers(clock.title))
    columns = {title: column[known] for title, column in loose.table.columns.items()}
    empty = {title: cells[known] for title, cells in loose.table.empty.items()}
    return replace(loose, table=replace(loose.table, columns=columns, empty=empty))
