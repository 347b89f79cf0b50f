"""Read the tables of apps and devices that are known by name: one table, with what is known of its titles.

The general reader (`pdr_est.io.tables`) does the work. An app adds its platform, the sign and units that it always
uses, and the meaning of titles that would be misunderstood without knowing it.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.tables.device import read_devices
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping import ClockColumn, QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import HEAD_BYTES, layout_of
from pdr_est.io.tables.split.reader import read_tables
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


@dataclass(frozen=True)
class NamedTableFormat:
    """Format of an app or device that writes one table.

    Attributes
    ----------
    NAME
        Name of the format.
    mark
        What the beginning of such a table contains.
    device_of
        Facts about the device (without signals), from the beginning of the table.
    mapping_of
        Meaning of the columns; None for what the titles say by themselves.
    BESIDE
        Names of files that lie beside such a table and are no walks.
    """

    NAME: str
    mark: re.Pattern[bytes]
    device_of: Callable[[bytes], RawDevice]
    mapping_of: MappingOf | None = None
    BESIDE: re.Pattern[str] = re.compile(r"(?!)")

    def sniff(self, source: Source) -> bool:
        """Tell whether a member of the source is such a table."""
        return bool(self._members(source))

    def read_source(self, source: Source) -> Recording:
        """Read the walk of the only table.

        Raises
        ------
        RecordingError
            For several tables, for a table without time, and when no motion sensor has values.
        """
        return self.read_chosen(source, ())

    def read_chosen(self, source: Source, chosen: Sequence[str]) -> Recording:
        """Read the walk of the only table, of the chosen devices or persons only where it has rows of several."""
        member, mapping, device = self.meaning_of(source)
        place = source.place(member)
        devices = read_tables(source.read(member), place, mapping=mapping, chosen=chosen)
        readings = read_devices(devices, device)
        first = readings[0]
        gnss = one_fix_a_second(first.gnss)
        gnss = gnss if first.device.span_s is None else drop_fixes_outside(gnss, *first.device.span_s)
        with_fixes = replace(first.device, warnings=(*first.device.warnings, *gnss.warnings))
        return Recording(
            name=member_stem(member),
            format=self.NAME,
            devices=(with_fixes, *(reading.device for reading in readings[1:])),
            truth=Truth(positions=first.true_positions),
            fixes=gnss.fixes,
            origin=gnss.origin,
            epoch_s=first.epoch_s,
            local_epoch_s=first.local_epoch_s,
        )

    def meaning_of(self, source: Source) -> tuple[str, TableMapping | None, RawDevice]:
        """Return the member with the table, the meaning of its columns where it is not plain, and the device.

        Raises
        ------
        RecordingError
            When the source has several such tables.
        """
        member = require_single_walk(source, self._members(source), self.NAME)
        device = self.device_of(source.head(member))
        others = [other for other in source.members if other != member]
        device.decisions += [f"files not used: {', '.join(others)}"] if others else []
        layout = None if self.mapping_of is None else layout_of(as_utf8(source.head(member, HEAD_BYTES)))
        return member, None if self.mapping_of is None or layout is None else self.mapping_of(layout), device

    def _members(self, source: Source) -> tuple[str, ...]:
        return find_members(source, lambda head: self.mark.search(as_utf8(head)) is not None)


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
