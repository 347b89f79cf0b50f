"""Find out what a numeric clock counts: the unit of its ticks, and the day from which on.

The rate of the rows tells the unit, because those of everyday clocks differ by factors of 1000. Clocks that count
from long ago are known by their size.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.io.conversion.units import CLOCK_UNITS, EARLIEST_UNIX_S, Conversion
from pdr_est.io.tables.times.calendar import DAY_S

TICK_S = 1e-7
"""Unit of the clocks of Windows and .NET, s."""

_UNIX_RANGE_S = (EARLIEST_UNIX_S, 4e9)  # to 2096
_DAYS_RANGE_S = (0.0, 4.7e9)
_RATE_HZ = (2.0, 1500.0)  # of the rows of a sensor; less than a factor of 1000, so that one unit fits
_LIKE_TICKS_HZ = 15.0  # rate in us up to which the rate in units of 100 ns is a usual one, too
_GAIT_HZ = 3.0  # ours: middle of what an accelerometer sees of a walk
_FEWEST_ROWS = 20
_LEAST_ROUGHNESS = 1e-4
_SLOWEST_HZ = 6.0  # at lower rates one row tells nothing of the next, either


@dataclass(frozen=True)
class _Epoch:
    """Beginning of a clock: its name with the unit, s in a tick, and s from then until 1970."""

    name: str
    tick_s: float
    before_1970_s: float


# Clocks that count from long before 1970, so that their size alone tells them.
_EPOCHS = (
    _Epoch("days, as spreadsheets do", DAY_S, 25_569.0 * DAY_S),
    _Epoch("days, as MATLAB does", DAY_S, 719_529.0 * DAY_S),
    _Epoch("days, as astronomers do", DAY_S, 2_440_587.5 * DAY_S),
    _Epoch("units of 100 ns since the year 1, as .NET does", TICK_S, 62_135_596_800.0),
    _Epoch("units of 100 ns since 1601, as Windows does", TICK_S, 11_644_473_600.0),
    _Epoch("us since 1601, as browsers do", 1e-6, 11_644_473_600.0),
)


def seconds_before_1970(first_s: float, tick_s: float) -> float | None:
    """Find the seconds from the beginning of a clock until 1970; None where it does not count from a known date.

    Parameters
    ----------
    first_s
        First time on the clock, s.
    tick_s
        Unit of the clock, s: a clock of days begins at another date than one of ticks.
    """
    if tick_s == DAY_S:
        known = [one.before_1970_s for one in _EPOCHS if one.tick_s == DAY_S]
        return next((one for one in known if _within(first_s - one, _DAYS_RANGE_S)), None)
    known = [0.0, *(one.before_1970_s for one in _EPOCHS if one.tick_s != DAY_S)]
    return next((one for one in known if _within(first_s - one, _UNIX_RANGE_S)), None)


def detect_clock_unit(ticks: NDArray[Any], motion: Callable[[], Array] = lambda: np.zeros((0, 0))) -> Conversion:
    """Detect the unit of a numeric clock: s, ms, us, ns, 100 ns, or days.

    The rate of the rows decides, which must be that of a sensor with 2 to 1500 samples a second: the units differ by
    a factor of 1000, so that at most one fits. Rows that share a stamp count, too. A first value that is a Unix time
    between 1998 and 2096 decides only where no unit gives such a rate, because the boot clock of a phone that has run
    for 10 to 46 days looks like a Unix time in the next larger unit. Whether slow rows in us are fast ones in units
    of 100 ns is decided by how smoothly the motion changes from row to row, with a warning.

    Parameters
    ----------
    ticks
        (n,) clock values, at least one.
    motion
        Returns the (n, k) values of the sensors in the rows.
    """
    first = float(ticks[0])
    step = step_of_rows(ticks)
    epoch = next((one for one in _EPOCHS if _is_clock_since(one, first, step)), None)
    if epoch is not None:
        shown = f"{first:.6f}" if epoch.tick_s == DAY_S else str(ticks[0])
        return Conversion(epoch.tick_s, f"the clock counts {epoch.name}: the first value is {shown}")
    unix = [unit for unit, per_s in CLOCK_UNITS.items() if _within(first / per_s, _UNIX_RANGE_S)]
    by_rate = [unit for unit, per_s in CLOCK_UNITS.items() if step > 0 and _is_rate(per_s / step)]
    if unix and (unix == by_rate or not by_rate):
        factor = 1.0 / CLOCK_UNITS[unix[0]]
        return Conversion(factor, f"the clock counts Unix time in {unix[0]}: the first value is {ticks[0]}")
    if by_rate == ["us"] and ticks.dtype.kind == "i" and CLOCK_UNITS["us"] / step <= _LIKE_TICKS_HZ:
        return _us_or_ticks(CLOCK_UNITS["us"] / step, motion())
    if by_rate:
        unit = by_rate[0]
        decision = f"the clock counts {unit}: the median step is {step:.4g}"
        if unix:
            decision += f", which cannot be Unix time in {unix[0]}"
        return Conversion(1.0 / CLOCK_UNITS[unit], decision)
    span = float(ticks[-1]) - first
    rate = f", {1.0 / step:.4g} a second" if step > 0.0 else ""
    return Conversion(
        1.0,
        f"the clock is assumed to count seconds, although its median step is {step:.4g}",
        f"the unit of the clock cannot be determined from its median step of {step:.4g}: seconds are assumed, with "
        f"which it spans {span:.4g} s for {len(ticks)} rows{rate}",
    )


def is_impossible_rate(ticks: NDArray[Any], tick_s: float) -> bool:
    """Tell whether the rows follow each other faster than those of any recorder, with a unit of the clock in s."""
    step_s = step_of_rows(ticks) * tick_s
    return 0.0 < step_s <= 1.0 / _RATE_HZ[1]


def step_of_rows(ticks: NDArray[Any]) -> float:
    """Compute the median step of the stamps, divided by the rows that share a stamp where most do."""
    steps = np.diff(ticks)
    rises = steps[steps > 0]
    if not len(rises):
        return 0.0
    step = float(np.median(rises))
    shared = float(np.median(np.diff(np.flatnonzero(np.concatenate([[True], steps > 0, [True]])))))
    return step / max(1.0, shared)


def _us_or_ticks(rate_hz: float, motion: Array) -> Conversion:
    """Decide between us and units of 100 ns by the difference between successive rows."""
    rough = _roughness(motion)
    is_fast = rough is not None and abs(np.log(rough / _expected(10.0 * rate_hz))) < abs(
        np.log(rough / _expected(rate_hz))
    )
    factor, unit, other = (TICK_S, "units of 100 ns", "us") if is_fast else (1e-6, "us", "units of 100 ns")
    taken_hz = rate_hz * 1e-6 / factor
    how = "smoothly" if is_fast else "strongly"
    return Conversion(
        factor,
        f"the clock counts {unit}: with these there are {taken_hz:.1f} rows a second",
        f"the clock may count us or units of 100 ns: {unit} are taken, with which there are {taken_hz:.1f} rows a "
        f"second, because the values change {how} from row to row; with {other} all would be "
        f"{'slower' if is_fast else 'faster'} by a factor of 10",
    )


def _roughness(motion: Array) -> float | None:
    """Compute the mean square of the steps of (n, k) values by twice their variance; None where nothing moves."""
    finite = motion[np.isfinite(motion).all(axis=1)] if motion.size else motion
    if len(finite) < _FEWEST_ROWS:
        return None
    spread = finite.var(axis=0)
    moved = spread > 0.0
    if not moved.any():
        return None
    steps = np.mean(np.diff(finite, axis=0) ** 2, axis=0)
    return max(float(np.median(steps[moved] / (2.0 * spread[moved]))), _LEAST_ROUGHNESS)


def _expected(rate_hz: float) -> float:
    """Return the roughness of a walk that is sampled at a rate."""
    return 1.0 - float(np.cos(2.0 * np.pi * _GAIT_HZ / max(rate_hz, _SLOWEST_HZ)))


def _is_clock_since(epoch: _Epoch, first: float, step: float) -> bool:
    allowed = _DAYS_RANGE_S if epoch.tick_s == DAY_S else _UNIX_RANGE_S
    since_1970_s = first * epoch.tick_s - epoch.before_1970_s
    return step > 0.0 and _within(since_1970_s, allowed) and 1.0 / (step * epoch.tick_s) > _RATE_HZ[0]


def _is_rate(rate_hz: float) -> bool:
    return _RATE_HZ[0] <= rate_hz < _RATE_HZ[1]


def _within(value: float, limits: tuple[float, float]) -> bool:
    return limits[0] <= value <= limits[1]
