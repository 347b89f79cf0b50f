"""Find out what the columns of a table without a header hold, from their values.

The clock is the column that rises all the time; three columns of numbers behind each other are the axes of a sensor.
The first triple whose mean is as long as gravity is the accelerometer, unless the name of the file tells more.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.gravity_content import has_gravity
from pdr_est.io.tables.mapping import ClockColumn, QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.times.dates import parse_dates
from pdr_est.io.tables.values.impossible_values import without_impossible_rows
from pdr_est.io.text.loose_table import LooseTable

_RISING_SHARE = 0.95
_NEW_STAMPS_SHARE = 0.02
_UNIT_NORM = 0.02
_USUAL_WIDTHS = (3, 6, 9)  # one to three sensors; other widths are too uncertain
_MOST_GRADES = 4
_VECTORS = (Quantity.FORCE, Quantity.RATE, Quantity.FIELD, Quantity.GRAVITY, Quantity.LINEAR)


def guess_columns(loose: LooseTable, hint: Quantity | None) -> TableMapping:
    """Guess the meaning of columns without titles.

    Parameters
    ----------
    loose
        All columns of the table.
    hint
        Quantity of the table from the name of its file; None when it is not known.

    Raises
    ------
    RecordingError
        When the values do not tell; the message shows the first row.
    """
    clocks = [ClockColumn(title) for title in _ordered_clocks(loose)]
    others = [title for title in loose.table.names if title not in {clock.title for clock in clocks}]
    numbers = [title for title in others if _is_measured(loose, title, is_named=hint is not None)]
    columns = _columns(loose, numbers, hint)
    used = {title for one in columns.values() for title in one.titles} | {clock.title for clock in clocks[:1]}
    if not columns or not clocks:
        missing = "no column rises like a clock" if not clocks else "no three columns look like an accelerometer"
        raise RecordingError(
            f"{loose.table.place}: the table has no header line, and {missing}; its first row is "
            f"{', '.join(_first_cells(loose))}; say what the columns mean with --map, or write titles above them"
        )
    unused = tuple(title for title in loose.table.names if title not in used)
    return TableMapping(clocks=tuple(clocks[:1]), columns=columns, unused=unused)


def _first_cells(loose: LooseTable) -> Sequence[str]:
    return [str(column[0]) for column in loose.table.columns.values() if len(column)]


def _ordered_clocks(loose: LooseTable) -> list[str]:
    """List the columns that rise, those with the most stamps first, row numbers last."""
    found = []
    for title in loose.table.names:
        column = loose.table.columns[title]
        if title in loose.text_columns:
            dates = parse_dates(column)
            if dates is not None:
                found.append((-len(np.unique(dates.ns)), 0, title))
        elif _rises(column):
            found.append((-len(np.unique(column)), int(_is_row_number(column)), title))
    return [title for _, _, title in sorted(found, key=lambda one: (one[1], one[0]))]


def _rises(column: NDArray[Any]) -> bool:
    if len(column) < 2 or not np.isfinite(column.astype(np.float64)).all():
        return False
    steps = np.diff(column)
    return bool((steps >= 0).mean() > _RISING_SHARE and (steps > 0).mean() > _NEW_STAMPS_SHARE)


def _is_row_number(column: NDArray[Any]) -> bool:
    return column.dtype.kind == "i" and bool((np.diff(column) == 1).all()) and abs(int(column[0])) <= 1


def _is_measured(loose: LooseTable, title: str, *, is_named: bool) -> bool:
    """Tell whether a column has numbers that are no grades of an accuracy.

    Where the name of the file tells the sensor (is_named), these may be written with a decimal point, too.
    """
    if title in loose.text_columns:
        return False
    column = loose.table.columns[title]
    finite = column[np.isfinite(column.astype(np.float64))]
    if not len(finite) or len(np.unique(finite)) > _MOST_GRADES:
        return len(finite) > 0
    if column.dtype.kind == "i":
        return False
    return not is_named or not bool((finite == np.round(finite)).all() and (finite != 0.0).any())


def _columns(loose: LooseTable, numbers: Sequence[str], hint: Quantity | None) -> dict[Quantity, QuantityColumns]:
    if hint in (Quantity.ROTATION_VECTOR, Quantity.ATTITUDE):
        return _attitude(loose, numbers)
    triples = [tuple(numbers[i : i + 3]) for i in range(0, len(numbers) - 2, 3)]
    if hint in _VECTORS and hint is not None and triples:
        return {hint: _of(triples[0])}
    if hint is Quantity.PRESSURE and numbers:
        return {hint: _of(numbers[:1])}
    if len(numbers) not in _USUAL_WIDTHS:
        return {}
    force = next(
        (triple for triple in triples[:2] if has_gravity(without_impossible_rows(loose.table.stack(triple)))), None
    )
    if force is None:
        return {}
    found = {Quantity.FORCE: _of(force)}
    others = [triple for triple in triples[:2] if triple is not force]
    if others:
        found[Quantity.RATE] = QuantityColumns(others[0], (None,) * 3, ambiguous=True)
    return found


def _attitude(loose: LooseTable, numbers: Sequence[str]) -> dict[Quantity, QuantityColumns]:
    """Take four columns of unit length as x, y, z, w, as Android's recorders do, else three as a rotation vector."""
    if len(numbers) >= 4:
        norm = np.linalg.norm(_finite(loose.table.stack(numbers[:4])), axis=1)
        if len(norm) and abs(float(np.median(norm)) - 1.0) < _UNIT_NORM:
            x, y, z, w = numbers[:4]
            return {Quantity.ATTITUDE: _of((w, x, y, z))}
    return {Quantity.ROTATION_VECTOR: _of(numbers[:3])} if len(numbers) >= 3 else {}


def _of(titles: Sequence[str]) -> QuantityColumns:
    return QuantityColumns(tuple(titles), (None,) * len(titles))


def _finite(values: Array) -> Array:
    return values[np.isfinite(values).all(axis=1)]
