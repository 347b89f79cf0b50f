"""Find tables in which each sensor has a clock of its own, in columns side by side.

Each sensor has its own rate there, so that the rows of the table do not belong together: in row 100 the accelerometer
may be at 2 s and the gyroscope at 4 s.
"""

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.loose_table import LooseTable

_NUMBERED = re.compile(r"[\s_.]*\(?\d+\)?$")
_BRACKETS = re.compile(r"[\[\](){}（）【】]")
_ACCELERATIONS = frozenset({Quantity.FORCE, Quantity.LINEAR, Quantity.GRAVITY})


def by_sensor_clock(mapping: TableMapping, titles: Sequence[str]) -> tuple[TableMapping, ...]:
    """Split the meaning of a table in which sensors have clocks of their own into one part for each clock.

    A clock belongs to the sensor that its title names, or to the columns behind it where clocks have the same title
    but for a number.

    Parameters
    ----------
    mapping
        Meaning of the columns.
    titles
        All titles in the order of the file.

    Returns
    -------
    tuple of TableMapping
        The mapping itself unless two sensors have a clock each.
    """
    if len(mapping.clocks) < 2 or mapping.given or any(clock.parts for clock in mapping.clocks):
        return (mapping,)
    owner = _named_owners(mapping) or _owners_by_place(mapping, titles)
    if len({clock.title for clock in owner.values()}) < 2:
        return (mapping,)
    owned = {clock.title for clock in owner.values()}
    others = tuple(clock for clock in mapping.clocks if clock.title not in owned) or (next(iter(owner.values())),)
    groups: dict[tuple[ClockColumn, ...], list[Quantity]] = defaultdict(list)
    for quantity in mapping.columns:
        groups[(owner[quantity],) if quantity in owner else others].append(quantity)
    first = next(iter(groups))
    return tuple(
        replace(
            mapping,
            clocks=clocks,
            columns={quantity: mapping.columns[quantity] for quantity in quantities},
            unused=mapping.unused if clocks == first else (),
            incomplete=mapping.incomplete if clocks == first else (),
        )
        for clocks, quantities in groups.items()
    )


def rows_of_clocks(loose: LooseTable, mapping: TableMapping) -> LooseTable:
    """Keep the rows in which a clock of the mapping has a value: the columns of a slow sensor end before the others.

    Parameters
    ----------
    loose
        Table with the columns of all sensors.
    mapping
        One part of the result of `by_sensor_clock`.
    """
    empty = [loose.table.empty.get(title) for clock in mapping.clocks for title in clock.titles]
    cells = [one for one in empty if one is not None]
    return loose.only(~np.all(cells, axis=0)) if len(cells) == len(empty) else loose


def _named_owners(mapping: TableMapping) -> Mapping[Quantity, ClockColumn]:
    """Find the clocks whose titles name a sensor of the table."""
    named = {
        sensor: clock
        for clock in reversed(mapping.clocks)
        if (sensor := sensor_by_name(_BRACKETS.sub(" ", clock.title))) is not None
    }
    found: dict[Quantity, ClockColumn] = {}
    for quantity in mapping.columns:
        alike = _ACCELERATIONS if quantity in _ACCELERATIONS else {quantity}
        clock = named.get(quantity) or next((named[one] for one in named if one in alike), None)
        if clock is not None:
            found[quantity] = clock
    return found if len({clock.title for clock in found.values()}) > 1 else {}


def _owners_by_place(mapping: TableMapping, titles: Sequence[str]) -> Mapping[Quantity, ClockColumn]:
    """Find the clocks of one title that stand each in front of the columns of a sensor."""
    alike: dict[str, list[ClockColumn]] = defaultdict(list)
    for clock in mapping.clocks:
        alike[_NUMBERED.sub("", clock.title).casefold()].append(clock)
    clocks = {clock.title: clock for clock in max(alike.values(), key=len)}
    place = {title: i for i, title in enumerate(titles)}
    at = sorted(place[title] for title in clocks if title in place)
    found = {}
    for quantity, columns in mapping.columns.items():
        before = [i for i in at if i < min(place[title] for title in columns.titles)]
        if before:
            found[quantity] = clocks[titles[before[-1]]]
    used = {clock.title for clock in found.values()}
    return found if len(clocks) > 1 and used == set(clocks) else {}
