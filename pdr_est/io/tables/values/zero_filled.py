"""Find rows in which a recorder wrote 0 for the sensors that had no sample, as for an empty cell."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.quantities import AXES, Quantity
from pdr_est.io.text.loose_table import LooseTable
from pdr_est.io.text.number_table import NumberTable

_FEWEST_ROWS = 50  # of a table whose zeros can be judged
_FEWEST_SHARE = 0.02  # of the rows, that only one of the sensors has values in
_MOST_TOGETHER = 0.02  # of the rows, with values of more than one sensor
_FIRST_ROWS = 64
_VECTORS = (Quantity.FORCE, Quantity.LINEAR, Quantity.RATE, Quantity.FIELD, Quantity.GRAVITY)


def without_zero_fill(loose: LooseTable, mapping: TableMapping) -> LooseTable:
    """Take the zeros of a sensor as empty cells where each row has the sample of one sensor and zeros for the others.

    Two sensors never measure exactly 0 on all axes in turn. Where one row has the samples of several sensors, a zero
    is a measured value; so it is in a table that mostly has empty cells where a sensor has no sample.

    Parameters
    ----------
    loose
        Table with the columns of the mapping.
    mapping
        Meaning of the columns.

    Returns
    -------
    LooseTable
        The same table with further empty cells, and a warning; the table itself where nothing is filled.
    """
    vectors = [
        columns.titles
        for quantity, columns in mapping.columns.items()
        if quantity in _VECTORS and len(AXES[quantity]) == 3 and set(columns.titles) <= set(loose.table.names)
    ]
    if len(vectors) < 2 or len(loose.table) < _FEWEST_ROWS:
        return loose
    if all(_has_values_at_once(loose.table, titles) for titles in vectors):
        return loose
    filled = [_is_zero(loose.table, titles) for titles in vectors]
    n_empty = sum(int(np.isnan(loose.table.stack(titles)).all(axis=1).sum()) for titles in vectors)
    if 2 * n_empty > sum(int(zero.sum()) for zero in filled):
        return loose
    n_measured = np.sum([~zero for zero in filled], axis=0)
    alone = [float((~zero & (n_measured == 1)).mean()) for zero in filled]
    if (n_measured > 1).mean() > _MOST_TOGETHER or sum(share > _FEWEST_SHARE for share in alone) < 2:
        return loose
    empty = dict(loose.table.empty)
    for titles, zero in zip(vectors, filled, strict=True):
        for title in titles:
            empty[title] = zero | empty.get(title, np.zeros(len(zero), dtype=np.bool_))
    named = _named(vectors)
    warning = f"each row has the sample of one sensor, and zeros for the others ({named}): they are left out"
    return replace(loose, table=replace(loose.table, empty=empty), warnings=(*loose.warnings, warning))


def _has_values_at_once(table: NumberTable, titles: Sequence[str]) -> bool:
    """Tell whether the first rows have values of a sensor, all of them: a glance that is enough for most tables."""
    first = [table.columns[title][:_FIRST_ROWS] for title in titles]
    return bool(np.any([column != 0 for column in first], axis=0).all())


def _is_zero(table: NumberTable, titles: Sequence[str]) -> NDArray[np.bool_]:
    """Find the rows (n,) in which all axes of a sensor are 0, or have no value."""
    values = table.stack(titles)
    return np.asarray((np.nan_to_num(values) == 0.0).all(axis=1))


def _named(vectors: Sequence[Sequence[str]]) -> str:
    return "; ".join(", ".join(titles) for titles in vectors)
