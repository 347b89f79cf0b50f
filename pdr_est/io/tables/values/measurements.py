"""Read the values of one sensor from its columns: in one unit, without empty rows and rows of codes or spikes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.io.conversion.raw_device import RawSignal
from pdr_est.io.conversion.units import Conversion
from pdr_est.io.tables.mapping import QuantityColumns
from pdr_est.io.tables.quantities import MOTION, Quantity, unit_factor
from pdr_est.io.tables.titles import understand_title
from pdr_est.io.tables.values.column_units import complete_factors, unknown_unit_words
from pdr_est.io.tables.values.impossible_values import ImpossibleRows, find_impossible_rows, rows_without_measurement
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.number_table import NumberTable

_NEVER_ZERO = (Quantity.FORCE, Quantity.GRAVITY, Quantity.FIELD)
_EVIDENT = (Quantity.FORCE, Quantity.GRAVITY)  # whose zeros show that the whole row is empty
_JUDGED = (*_NEVER_ZERO, Quantity.LINEAR, Quantity.RATE)
# What a phone can measure along an axis: 16 g, and a field of some mT, over the usual length of the vector.
_LARGEST_OVER_USUAL = {Quantity.FORCE: 18.0, Quantity.FIELD: 60.0}
# Rotation rates: full scale in rad/s, deg/s and mdeg/s by what 95 % of the values do not exceed in that unit.
_FULL_SCALES = ((15.0, 40.0), (3000.0, 2300.0), (np.inf, 2.3e6))
_SAMPLED_ROWS = 5000
_MOST_NAMED = 3


@dataclass
class Notes:
    """Sentences about a table, for the decisions and warnings of its recording."""

    decisions: list[str]
    warnings: list[str]


def find_missing_rows(
    table: NumberTable, columns: Mapping[Quantity, QuantityColumns], notes: Notes
) -> Mapping[Quantity, NDArray[np.bool_]]:
    """Find for each sensor the rows (n,) that hold a code for a missing value, or a spike beyond any phone.

    Sensors of which no row does are not in the result.
    """
    parts = {
        quantity: [table.columns[title] for title in columns[quantity].titles]
        for quantity in _JUDGED
        if quantity in columns and all(title in table for title in columns[quantity].titles)
    }
    found = {
        quantity: find_impossible_rows(
            axes,
            never_zero=quantity in _NEVER_ZERO,
            largest=_largest(table, columns[quantity], quantity),
            lone_jumps=quantity in MOTION,
        )
        for quantity, axes in parts.items()
    }
    missing = {quantity: one.rows for quantity, one in found.items()}
    for evident in _EVIDENT:
        if evident not in found or not found[evident].rows.any():
            continue
        for quantity, axes in parts.items():
            if quantity not in _EVIDENT:
                one = rows_without_measurement(axes, missing[evident], found[evident].zero_is_code)
                missing[quantity] = missing[quantity] | one
    for quantity, rows in missing.items():
        if rows.any():
            notes.warnings.append(_words(quantity, rows, found[quantity]))
    return {quantity: rows for quantity, rows in missing.items() if rows.any()}


def _words(quantity: Quantity, rows: NDArray[np.bool_], found: ImpossibleRows) -> str:
    values = ", ".join(found.words[:_MOST_NAMED]) or "zeros beside another sensor without a measurement"
    more = ", …" if len(found.words) > _MOST_NAMED else ""
    return (
        f"{quantity}: {int(rows.sum())} of {len(rows)} rows are left out, because they hold no measurement "
        f"({values}{more})"
    )


def _largest(table: NumberTable, columns: QuantityColumns, quantity: Quantity) -> float | None:
    """Return the most that a phone can measure along an axis, in the unit of the values, as far as they tell it."""
    step = max(1, len(table) // _SAMPLED_ROWS)
    sample = np.stack([table.columns[title][::step].astype(np.float64) for title in columns.titles], axis=1)
    if columns.factors.count(columns.factors[0]) < len(columns.factors):
        return None
    length = np.linalg.norm(sample, axis=1)
    length = length[np.isfinite(length)]
    if not len(length):
        return None
    if quantity in _LARGEST_OVER_USUAL:
        usual = float(np.median(length))
        return _LARGEST_OVER_USUAL[quantity] * usual if usual > 0.0 else None
    if quantity is not Quantity.RATE:
        return None
    high = float(np.percentile(length, 95.0))
    return next(full_scale for most, full_scale in _FULL_SCALES if high <= most)


def read_measurements(
    table: NumberTable,
    time_s: Array,
    quantity: Quantity,
    columns: QuantityColumns,
    missing: NDArray[np.bool_] | None,
    notes: Notes,
) -> RawSignal | None:
    """Read the rows of a sensor that hold a measurement; None when none does.

    Parameters
    ----------
    table
        Table with its columns.
    time_s
        (n,) s, time of each row.
    quantity, columns
        The sensor and its columns.
    missing
        (n,) rows without a measurement; None where there are none.
    notes
        Where decisions and warnings are kept.
    """
    if any(title not in table for title in columns.titles):
        return None
    sampled = table.has_values(columns.titles)
    if not sampled.any():
        notes.decisions.append(f"{quantity}: the columns are there but have no values")
        return None
    if not sampled.all():
        notes.decisions.append(f"{quantity}: {int(sampled.sum())} of {len(sampled)} rows have values")
    if missing is not None:
        sampled &= ~missing
        if not sampled.any():
            return None
    values = table.stack(columns.titles)
    if not sampled.all():
        time_s, values = time_s[sampled], values[sampled]
    values, factor, conversion = _in_one_unit(values, columns, quantity)
    if conversion is not None:
        notes.decisions.append(conversion.decision)
        notes.warnings += conversion.warnings
    elif factor is not None and _states_unit(columns, quantity):
        notes.decisions.append(f"{quantity}: the unit is in the header ({columns.titles[0]})")
    unknown = unknown_unit_words(columns)
    if unknown and factor is None:
        notes.warnings.append(f"{unknown}: the values decide; write a usual unit, or state it with --map")
    elif unknown:
        notes.decisions.append(unknown)
    signal, dropped = finite_signal_or_none(time_s, values, quantity, table.place)
    notes.warnings += dropped
    return None if signal is None else RawSignal(signal, ", ".join(columns.titles), factor)


def _states_unit(columns: QuantityColumns, quantity: Quantity) -> bool:
    """Tell whether the unit comes from the title, and not from what is known of an app."""
    meaning = understand_title(columns.titles[0])
    return columns.canonical or (meaning is not None and unit_factor(quantity, meaning.unit) is not None)


def _in_one_unit(
    values: Array, columns: QuantityColumns, quantity: Quantity
) -> tuple[Array, float | None, Conversion | None]:
    """Bring columns of different units to SI units.

    Returns
    -------
    values : (n, k)
    factor : float or None
        Factor to SI units of all of them; None where no unit is known.
    conversion : Conversion or None
        How the unit of columns was found that state none, beside others that do.
    """
    if columns.turned:
        values = values * np.array(columns.turned)
    if all(factor is None for factor in columns.factors):
        return values, None, None
    if len(set(columns.factors)) == 1:
        return values, columns.factors[0], None
    factors, conversion = complete_factors(values, columns, quantity)
    return values * factors, 1.0, conversion
