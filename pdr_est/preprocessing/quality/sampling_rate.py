"""Judge the sampling rate of an accelerometer by the steps that it has to show."""

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.preprocessing.quality.sensor_checks import LONGEST_PERIOD_S
from pdr_est.types.recording import Signal

SLOWEST_STEPS_HZ = 8.0
"""Rate below which steps are missed, Hz: four samples a step. Of a walk thinned to 5 Hz a quarter is missed."""

_LEAST_RATE_HZ = 4.0  # two samples for each of two steps a second; below, what looks like steps is another frequency
_NO_RATE_HZ = 1.0  # of no recorder; the clock is in another unit
_FEWEST_SAMPLES = 5


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


def refuse_slow_sampling(acceleration: Signal, label: str) -> None:
    """Raise RecordingError for an accelerometer that is too slow to see steps.

    Parameters
    ----------
    acceleration
        (n, 3) acceleration.
    label
        Name of the device in messages.
    """
    rate_hz = mean_rate_hz(acceleration.time_s)
    if _NO_RATE_HZ < rate_hz < _LEAST_RATE_HZ and len(acceleration) >= _FEWEST_SAMPLES:
        raise RecordingError(
            f"{label}: the accelerometer has only {rate_hz:.1f} samples a second, which cannot show steps, of which "
            "a person makes about two a second: record at 20 Hz or more"
        )


def slow_sampling_warnings(acceleration: Signal) -> tuple[str, ...]:
    """Warn of an accelerometer (n, 3) that is so slow that steps are missed."""
    rate_hz = mean_rate_hz(acceleration.time_s)
    if not 0.0 < rate_hz < SLOWEST_STEPS_HZ:
        return ()
    return (
        f"the accelerometer has only {rate_hz:.1f} samples a second: many steps are missed, and a track is not to be "
        "trusted; record at 20 Hz or more",
    )
