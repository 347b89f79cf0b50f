"""Describe what the columns of a table mean: the one record between titles (or a mapping file) and values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from pdr_est.io.tables.quantities import MOTION, Quantity


@dataclass(frozen=True)
class QuantityColumns:
    """Columns of one quantity.

    Attributes
    ----------
    titles
        Titles as in the file, in the order of the axes (`quantities.AXES`).
    factors
        For each column the factor to SI units; None where only the values can tell.
    canonical
        True for the documented header, whose units and signs are promised.
    ambiguous
        True where the titles leave the quantity open, so that the values must confirm it, such as `gx` for a
        gyroscope or gravity.
    turned
        For each column 1, or -1 where its axis points the other way; empty where none does.
    other_order
        Order of the axes that is meant as well by titles such as alpha, beta and gamma, so that the values must tell;
        empty where the titles name the axes.
    unknown_units
        For each column the text that stands where a unit stands but is none that is known; empty where there is none.
    nameless
        True where the titles name axes but no sensor.
    """

    titles: tuple[str, ...]
    factors: tuple[float | None, ...]
    canonical: bool = False
    ambiguous: bool = False
    turned: tuple[float, ...] = ()
    other_order: tuple[int, ...] = ()
    unknown_units: tuple[str, ...] = ()
    nameless: bool = False


@dataclass(frozen=True)
class ClockColumn:
    """One column that tells the time, alone or together with a second one.

    Attributes
    ----------
    title
        Title as in the file.
    factor
        Seconds in one tick; None where the values decide, which is also the case for dates.
    fraction
        Title of a column with the fraction of a second, such as the nanoseconds beside whole seconds, or with the
        time of day beside a date; "" when there is none.
    canonical
        True for `time_s` of the documented header: seconds of the recording, not shifted.
    parts
        Titles of the columns of year, month … second by the names of these parts, where a column each holds them;
        empty for a column that tells the time by itself.
    """

    title: str
    factor: float | None = None
    fraction: str = ""
    canonical: bool = False
    parts: Mapping[str, str] = field(default_factory=dict, hash=False)

    @property
    def titles(self) -> tuple[str, ...]:
        """Return the titles of all columns that are needed."""
        return tuple(dict.fromkeys(title for title in (self.title, self.fraction, *self.parts.values()) if title))


@dataclass(frozen=True)
class TableMapping:
    """Meaning of the columns of a table.

    Attributes
    ----------
    clocks
        Columns that tell the time, best first; the values decide between several.
    columns
        Columns of each quantity.
    rate_hz
        Sampling rate of a table without a time column, Hz; None when it has one.
    force_sign
        +1 where the acceleration points up at rest (Android), -1 where it points down (Apple); None when it is open.
    sign_reason
        Why that sign is expected, for the decisions.
    given
        True when a person stated the mapping, who is then believed about units, signs and clock.
    guessed
        True when only the values told what the columns are.
    incomplete
        Sensors of which some axes are named and others are missing, in words.
    unused
        Titles of the columns that mean nothing to the project, or are not needed beside better ones.
    parts
        Mappings of several tables, or of several sensors in the rows of one; everything else is then in them.
    file
        Name of the file that a part describes; "" for the only one.
    rows
        Column with the names of the sensors, and the name whose rows a part describes; None for all rows.
    """

    clocks: tuple[ClockColumn, ...] = ()
    columns: Mapping[Quantity, QuantityColumns] = field(default_factory=dict)
    rate_hz: float | None = None
    force_sign: float | None = None
    sign_reason: str = ""
    given: bool = False
    guessed: bool = False
    incomplete: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    parts: tuple["TableMapping", ...] = ()
    file: str = ""
    rows: tuple[str, str] | None = None

    @property
    def has_time(self) -> bool:
        """Tell whether the times of the rows can be known."""
        if self.parts:
            return all(part.has_time for part in self.parts)
        return bool(self.clocks) or self.rate_hz is not None

    @property
    def has_motion(self) -> bool:
        """Tell whether an accelerometer or a gyroscope is among the columns."""
        return any(quantity in self.columns for quantity in MOTION) or any(part.has_motion for part in self.parts)
