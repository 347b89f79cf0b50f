"""Find time and axes in the file of one sensor: by its titles, or by its values where it has no header."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping import ClockColumn, QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import AXES, Quantity, is_unit, unit_factor
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.table_layout import TableLayout, detect_layout, split_line

_ROWS_LOOKED_AT = 60
_RISING_SHARE = 0.98
_FEWEST_ROWS = 3
_AXES_OF_HEADERLESS = {Quantity.ROTATION_VECTOR: 3, Quantity.ATTITUDE: 4, Quantity.PRESSURE: 1}


@dataclass(frozen=True)
class SensorFileColumns:
    """Layout of the file of one sensor, and where its time and axes stand.

    Attributes
    ----------
    layout
        How the table is written.
    mapping
        Columns of the clock and of the one quantity.
    quantity
        What the file holds.
    """

    layout: TableLayout
    mapping: TableMapping
    quantity: Quantity

    @property
    def titles(self) -> tuple[str, ...]:
        """Return the titles of the axes."""
        return self.mapping.columns[self.quantity].titles


def find_columns(head: bytes, quantity: Quantity | None) -> SensorFileColumns | None:
    """Find the columns of a file that holds one sensor.

    Parameters
    ----------
    head
        Beginning of the file.
    quantity
        What its name says that it holds; None when the name does not tell.

    Returns
    -------
    SensorFileColumns or None
        None when the file is no table with a time and the axes of exactly one quantity.
    """
    layout = detect_layout(head, is_unit)
    if layout is None:
        return None
    if not layout.has_header:
        return _by_values(head, layout, quantity)
    mapping = understand_titles(layout.titles, quantity)
    if layout.units:
        mapping = _with_units_row(mapping, layout)
    held = [found for found in mapping.columns if found not in (Quantity.ACCURACY, Quantity.TRUE_POSITION)]
    if not mapping.clocks or not held:
        return None
    if quantity in held:
        return SensorFileColumns(layout, mapping, quantity)
    return SensorFileColumns(layout, mapping, held[0]) if len(held) == 1 else None


def _with_units_row(mapping: TableMapping, layout: TableLayout) -> TableMapping:
    """Take the units of a row of their own for the columns whose titles state none."""
    unit_of = dict(zip(layout.titles, layout.units, strict=False))
    columns = {
        quantity: QuantityColumns(
            found.titles,
            tuple(
                factor if factor is not None else unit_factor(quantity, unit_of.get(title, ""))
                for title, factor in zip(found.titles, found.factors, strict=True)
            ),
            found.canonical,
            found.ambiguous,
        )
        for quantity, found in mapping.columns.items()
    }
    clocks = tuple(
        clock
        if clock.factor is not None
        else ClockColumn(clock.title, unit_factor(Quantity.TIME, unit_of.get(clock.title, "")), clock.fraction)
        for clock in mapping.clocks
    )
    return TableMapping(clocks, columns, unused=mapping.unused)


def _by_values(head: bytes, layout: TableLayout, quantity: Quantity | None) -> SensorFileColumns | None:
    """Find the clock by its rising values; the other columns are the axes in their order."""
    rows = _rows(head, layout)
    if len(rows) < _FEWEST_ROWS:
        return None
    held = Quantity.FORCE if quantity is None else quantity
    n_axes = _AXES_OF_HEADERLESS.get(held, 3)
    rising = _rising_columns(rows)[: max(1, rows.shape[1] - n_axes)]
    counters = [i for i in rising if (np.diff(rows[:, i]) == 1.0).all()]
    clocks = [i for i in rising if i not in counters] or rising
    values = [i for i in range(rows.shape[1]) if i not in rising]
    if not clocks or len(values) < n_axes:
        return None
    axes = values[:n_axes]
    if held is Quantity.ATTITUDE:
        axes = [axes[3], *axes[:3]]  # recorders write w last
    titles = tuple(layout.titles[i] for i in axes)
    used = {*clocks, *axes}
    mapping = TableMapping(
        clocks=tuple(ClockColumn(layout.titles[i]) for i in clocks),
        columns={held: QuantityColumns(titles, (None,) * len(AXES[held]), ambiguous=quantity is None)},
        unused=tuple(title for i, title in enumerate(layout.titles) if i not in used),
    )
    return SensorFileColumns(layout, mapping, held)


def _rising_columns(rows: Array) -> list[int]:
    """List the columns that rise, the likeliest clocks first: slow axes rise for a while, too."""
    rising = [i for i in range(rows.shape[1]) if _rises(rows[:, i])]
    last = rows.shape[1] - 1
    return sorted(rising, key=lambda i: (i != 0, not (rows[:, i] == np.round(rows[:, i])).all(), i != last))


def _rows(head: bytes, layout: TableLayout) -> Array:
    """Read the first rows that are numbers throughout."""
    lines = as_utf8(head).decode("utf-8", "replace").split("\n")[layout.first_line : -1]
    cells = (split_line(line, layout.separator) for line in lines[:_ROWS_LOOKED_AT])
    numbers = [row for row in map(_numbers, cells) if row is not None and len(row) == len(layout.titles)]
    return np.array(numbers) if numbers else np.zeros((0, len(layout.titles)))


def _numbers(cells: Sequence[str]) -> list[float] | None:
    try:
        return [float(cell.strip().replace(",", ".")) for cell in cells]
    except ValueError:
        return None


def _rises(values: Array) -> bool:
    steps = np.diff(values)
    return bool((steps >= 0.0).mean() >= _RISING_SHARE and (steps > 0.0).any() and values[-1] > values[0])
