"""Judge the rates of accelerometer and gyroscope by the steps and turns that they have to show.

What counts is how often a value is new: recorders that write rows faster than a sensor delivers repeat its last value
or fill in straight lines, which shows no more of the walk.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.preprocessing.quality.sensor_checks import LONGEST_PERIOD_S
from pdr_est.preprocessing.sensor_ranges import rows_kept, whole_rows
from pdr_est.types.recording import Signal

SLOWEST_STEPS_HZ = 8.0
"""Rate below which steps are missed, Hz: four samples a step. Of a walk thinned to 5 Hz a quarter is missed."""

FASTEST_HZ = 1500.0
"""Rate that no phone or wearable sensor for walks exceeds, Hz; above, the clock is in another unit."""

_LEAST_RATE_HZ = 4.0  # two samples for each of two steps a second; below, what looks like steps is another frequency
_NO_RATE_HZ = 1.0  # of no recorder; the clock is in another unit
_FEWEST_SAMPLES = 5
_WINDOW_S = 4.0  # ours: some steps, so that the slowest rate is still known to 6 %
_ACTIVE = 0.5  # ours: share of the strongest motion from which on a window counts
_STRONGEST_PERCENTILE = 95
_LOW, _HIGH, _LARGEST = 0.1, 0.9, 0.99  # ranks in a window: a damaged number is no motion
_ROUNDING = 3.0  # last digits by which rounded numbers leave a straight line: at most 2
_COARSE = 1e-3  # share of the usual bend above which a last digit hides whether lines are straight
_EXACT = 1e-6
_ROUNDED_NUMBER = 1e-9  # share of the usual bend; what is less comes from binary numbers
_MOSTLY_NEW = 0.7  # ours: some digits repeat by chance
_MOST_WINDOWS = 200  # ours: enough of a long recording


@dataclass(frozen=True)
class SamplingRate:
    """Rates of a sensor.

    Attributes
    ----------
    samples_hz
        Samples a second while it records, Hz; 0 when its clock does not advance.
    new_hz
        New values a second while the device moves, Hz; that of the samples where no value ever changes.
    hidden_by
        How most of the others were made: "repeated" or "interpolated"; "" where at least 70 % of the values are new.
    """

    samples_hz: float
    new_hz: float
    hidden_by: str = ""

    @property
    def text(self) -> str:
        """Describe the rate for a message."""
        if self.new_hz >= self.samples_hz - 0.05:
            return f"{self.samples_hz:.1f} samples a second"
        return (
            f"{self.new_hz:.1f} new values a second (repeated or joined by straight lines in {self.samples_hz:.1f} "
            "samples a second)"
        )


def mean_rate_hz(time_s: Array) -> float:
    """Compute the number of samples a second while a sensor records, in Hz; 0 when its clock does not advance.

    Gaps do not lower it, and stamps that several samples share do not raise it.

    Parameters
    ----------
    time_s
        (n,) time stamps, s.
    """
    period_s = np.diff(time_s)
    forward_s = period_s[period_s > 0.0]
    if not len(forward_s):
        return 0.0
    usual_s = float(np.median(forward_s))
    recorded_s = float(forward_s[forward_s <= max(LONGEST_PERIOD_S, 5.0 * usual_s)].sum())
    return float((period_s >= 0.0).sum()) / recorded_s


def sampling_rate(signal: Signal) -> SamplingRate:
    """Measure how often a sensor is sampled, and how often its value is a new one.

    New values are counted where the device moves most, because a sensor with few digits repeats its values while the
    device lies still.

    Parameters
    ----------
    signal
        (n, k) samples of the sensor.
    """
    samples_hz = mean_rate_hz(signal.time_s)
    size = round(samples_hz * _WINDOW_S)
    finite = whole_rows(np.isfinite(signal.values))
    if size < _FEWEST_SAMPLES or finite.sum() < _FEWEST_SAMPLES:
        return SamplingRate(samples_hz, samples_hz)
    new, repeated = _shares(_active_windows(rows_kept(signal.values, finite), size))
    if not 0.0 < new < _MOSTLY_NEW:
        return SamplingRate(samples_hz, samples_hz * (new or 1.0))
    hidden_by = "repeated" if repeated > 1.0 - new - repeated else "interpolated"
    return SamplingRate(samples_hz, samples_hz * new, hidden_by)


def refuse_slow_sampling(acceleration: Signal, label: str) -> None:
    """Raise RecordingError for an accelerometer that is too slow to see steps.

    Parameters
    ----------
    acceleration
        (n, 3) acceleration.
    label
        Name of the device in messages.
    """
    rate = sampling_rate(acceleration)
    if rate.samples_hz > _NO_RATE_HZ and rate.new_hz < _LEAST_RATE_HZ and len(acceleration) >= _FEWEST_SAMPLES:
        raise RecordingError(
            f"{label}: the accelerometer has only {rate.text}, which cannot show steps, of which a person makes "
            "about two a second: record at 20 Hz or more"
        )


def sampling_rate_warnings(acceleration: Signal) -> tuple[str, ...]:
    """Warn of an accelerometer (n, 3) that is so slow that steps are missed, or impossibly fast."""
    rate = sampling_rate(acceleration)
    if rate.samples_hz > FASTEST_HZ:
        span_s = float(np.ptp(acceleration.time_s))
        return (
            f"the accelerometer has {rate.samples_hz:.0f} samples a second, more than any phone: its time spans "
            f"{span_s:.3g} s for {len(acceleration)} samples; state the unit of time with --map (time: {{column: "
            "time_s, unit: min})",
        )
    if not 0.0 < rate.new_hz < SLOWEST_STEPS_HZ:
        return ()
    return (
        f"the accelerometer has only {rate.text}: many steps are missed, and a track is not to be trusted; record at "
        "20 Hz or more",
    )


def slow_gyroscope_warnings(rotation_rate: Signal) -> tuple[str, ...]:
    """Warn of a gyroscope (n, 3) that is so slow that it misses what a device turns within a step."""
    rate = sampling_rate(rotation_rate)
    if not 0.0 < rate.new_hz < SLOWEST_STEPS_HZ:
        return ()
    return (
        f"the gyroscope has only {rate.text}: turns are missed, and headings and a track are not to be trusted; "
        "record at 20 Hz or more",
    )


def _active_windows(values: Array, size: int) -> Array:
    """Cut (n, k) values into windows and return those with motion; all of a short signal as one.

    Returns
    -------
    windows : (k, m, size + 2)
        Each begins with the two samples before it, of which the first one tells whether it is new.
    """
    count = (len(values) - 2) // size
    if count < 2:
        return values.T[:, None]
    starts = 2 + size * np.arange(count)[:: 1 + (count - 1) // _MOST_WINDOWS]
    windows = values.T.take(starts[:, None] + np.arange(-2, size), axis=1)
    ordered = np.sort(windows)
    spread = (_at_rank(ordered, _HIGH) - _at_rank(ordered, _LOW)).sum(axis=0)
    moving: Array = windows[:, spread >= _ACTIVE * float(np.percentile(spread, _STRONGEST_PERCENTILE))]
    return moving


def _at_rank(ordered: Array, share: float) -> Array:
    """Return the number (...) that the share of ordered ones (..., n) lies below, without interpolation."""
    found: Array = ordered[..., round(share * (ordered.shape[-1] - 1))]
    return found


def _shares(windows: Array) -> tuple[float, float]:
    """Compute usual shares of samples of windows (k, m, n).

    Returns
    -------
    new : float
        Share of those that neither repeat nor go on in a straight line.
    repeated : float
        Share of those that repeat.
    """
    step = np.diff(windows)
    bends = np.abs(np.diff(step))
    bend = bends.max(axis=0)
    usual = _at_rank(np.sort(bend), _LARGEST)[:, None]
    digit = bends.min(axis=(0, 2), initial=np.inf, where=bends > _ROUNDED_NUMBER * usual)[:, None]
    straight = np.where(_ROUNDING * digit < _COARSE * usual, _ROUNDING * digit, _EXACT * usual)
    changed = (step[..., 1:] != 0.0).any(axis=0)
    new = changed & (bend > straight)
    return float(np.median(new.mean(axis=1))), float(np.median(1.0 - changed.mean(axis=1)))
