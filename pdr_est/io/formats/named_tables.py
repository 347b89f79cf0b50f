"""Read the tables of apps and devices that are known by name: one table, with what is known of its titles.

The general reader (`pdr_est.io.tables`) does the work. An app adds its platform, the sign and units that it always
uses, and the meaning of titles that would be misunderstood without knowing it.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.tables.device import read_device
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping import ClockColumn, QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import layout_of, read_table_signals
from pdr_est.io.text.container import Source
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.types.ground_truth import Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

_SHORTEST_FIX_STEP_S = 0.5  # satellite receivers of phones give one position a second

MappingOf = Callable[[TableLayout], TableMapping]
"""Finds the meaning of the columns of an app's table."""


def members_marked(source: Source, mark: re.Pattern[bytes]) -> tuple[str, ...]:
    """Find the members whose beginning contains the mark of an app."""
    return find_members(source, lambda head: mark.search(as_utf8(head)) is not None)


def title_with_end(layout: TableLayout, ending: str) -> str:
    """Find the title that ends with a name, alone or behind that of a device or message; "" when there is none.

    Parameters
    ----------
    layout
        Table.
    ending
        Regular expression of the name, in capital or small letters.
    """
    pattern = re.compile(rf"(?:^|[./_%]){ending}$", re.IGNORECASE)
    return next((title for title in layout.titles if pattern.search(title)), "")


def read_named_table(
    source: Source, members: Sequence[str], name: str, device: RawDevice, mapping_of: MappingOf | None = None
) -> Recording:
    """Read the only table of an app.

    Parameters
    ----------
    source, members
        The source, and its members that are tables of the app.
    name
        Name of the format.
    device
        What is known of the device; without signals.
    mapping_of
        Meaning of the columns; None for what the titles say by themselves.

    Raises
    ------
    RecordingError
        For several tables, for a table without time, and when no motion sensor has values.
    """
    member = require_single_walk(source, members, name)
    data = source.read(member)
    layout = None if mapping_of is None else layout_of(as_utf8(data[: 1 << 16]))
    mapping = None if mapping_of is None or layout is None else mapping_of(layout)
    reading = read_device((read_table_signals(data, source.place(member), mapping=mapping),), device)
    span = reading.device.span_s
    gnss = one_fix_a_second(reading.gnss)
    gnss = gnss if span is None else drop_fixes_outside(gnss, *span)
    return Recording(
        name=member_stem(member),
        format=name,
        devices=(replace(reading.device, warnings=(*reading.device.warnings, *gnss.warnings)),),
        truth=Truth(positions=reading.true_positions),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=reading.epoch_s,
        local_epoch_s=reading.local_epoch_s,
    )


def one_fix_a_second(gnss: GnssFixes) -> GnssFixes:
    """Keep the first fix of every second where a table has many: it interpolates, and these tell nothing new."""
    times_s = [fix.time_s for fix in gnss.fixes]
    if len(times_s) < 2 or float(np.median(np.diff(times_s))) >= _SHORTEST_FIX_STEP_S:
        return gnss
    first: dict[int, PositionFix] = {}
    for fix in gnss.fixes:
        first.setdefault(math.floor(fix.time_s), fix)
    left = len(gnss.fixes) - len(first)
    warning = f"location: {left} of {len(gnss.fixes)} positions are left out: only one a second is new"
    return GnssFixes(tuple(first.values()), gnss.origin, (warning,))


def with_columns(
    layout: TableLayout,
    columns: Mapping[Quantity, tuple[Sequence[str], float | None]],
    clocks: Mapping[str, float | None] | None = None,
    without: Sequence[Quantity] = (),
) -> TableMapping:
    """Return what the titles say by themselves, with what an app is known to mean.

    Parameters
    ----------
    layout
        How the table is written.
    columns
        Quantity -> titles in the order of the axes, and the factor to SI units or None; used where all titles exist.
    clocks
        Titles of the clock with the seconds in a tick (None for what the values say), best first; those that exist
        come before all others.
    without
        Quantities whose columns mean something else in this app.
    """
    found = understand_titles(layout.titles, units=layout.units)
    known = {
        quantity: QuantityColumns(tuple(titles), (factor,) * len(titles))
        for quantity, (titles, factor) in columns.items()
        if set(titles) <= set(layout.titles)
    }
    taken = {title for one in known.values() for title in one.titles}
    others = {
        quantity: one
        for quantity, one in found.columns.items()
        if quantity not in without and quantity not in known and not taken & set(one.titles)
    }
    first = tuple(ClockColumn(title, factor) for title, factor in (clocks or {}).items() if title in layout.titles)
    rest = tuple(clock for clock in found.clocks if clock.title not in (clocks or {}))
    all_columns = {**others, **known}
    used = {title for one in all_columns.values() for title in one.titles}
    used |= {title for clock in (*first, *rest) for title in (clock.title, clock.fraction)}
    unused = tuple(title for title in layout.titles if title not in used and title.strip())
    return replace(found, clocks=(*first, *rest), columns=all_columns, unused=unused)
