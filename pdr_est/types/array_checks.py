"""Checks of sensor arrays that a user hands over, with errors that name value, place and remedy.

Readers of files find units from the values. Arrays come with units stated in the argument names, so that values which
cannot be in that unit are an error of the caller.
"""

import numpy as np
from numpy.typing import ArrayLike

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array

_SHORTEST_STEP_S, _LONGEST_STEP_S = 1e-4, 1.0  # median interval: 1 Hz to 10 kHz
_FORCE_MPS2 = (5.0, 25.0)  # median norm with gravity, from a phone at rest to one on a runner
_FULL_SCALE_RADPS = 40.0  # gyroscopes of phones end at 2000 deg/s, 34.9 rad/s
_PEAK_PERCENTILE = 99.9  # a single damaged sample must not decide
_WALKING_RADPS = 15.0  # 95th percentile of the norm; 12 for a phone in a runner's pocket
_COLUMNS = {"attitude": 4}


def checked_times(time_s: ArrayLike) -> Array:
    """Return the times as a float array (n,) if they are finite, strictly increasing and in seconds.

    Raises
    ------
    RecordingError
        Otherwise.
    """
    times = _as_floats("time_s", time_s)
    if times.ndim != 1 or len(times) < 2:
        raise RecordingError(f"time_s has shape {times.shape}: give at least two times as an array of shape (n,)")
    _refuse_non_finite("time_s", times)
    steps = np.diff(times)
    if (steps <= 0.0).any():
        i = int(np.argmax(steps <= 0.0))
        raise RecordingError(
            f"time_s[{i + 1}] = {times[i + 1]:.6f} s does not come after time_s[{i}] = {times[i]:.6f} s: "
            "sort the samples and drop repeated times, for example with numpy.unique(time_s, return_index=True)"
        )
    step = float(np.median(steps))
    if not _SHORTEST_STEP_S <= step <= _LONGEST_STEP_S:
        raise RecordingError(
            f"time_s increases by {step:.4g} from sample to sample (median), which is no sampling interval in "
            "seconds: convert milliseconds, microseconds or nanoseconds to seconds"
        )
    return times


def checked_values(name: str, values: ArrayLike, count: int) -> Array:
    """Return the samples of one sensor as a float array (count, 3), or (count, 4) for attitudes.

    Parameters
    ----------
    name
        Argument name, which states the unit.
    values
        The samples.
    count
        Number of time stamps.

    Raises
    ------
    RecordingError
        If the shape is wrong, a number is not finite, or the values cannot be in the stated unit.
    """
    samples = _as_floats(name, values)
    columns = _COLUMNS.get(name, 3)
    if samples.shape != (count, columns):
        hint = "; transpose it" if samples.shape == (columns, count) else ""
        raise RecordingError(
            f"{name} has shape {samples.shape}: with {count} times it must have shape ({count}, {columns}){hint}"
        )
    _refuse_non_finite(name, samples)
    if name == "specific_force_mps2":
        _refuse_other_force_unit(samples)
    elif name == "rotation_rate_radps":
        _refuse_degrees(samples)
    elif name == "attitude" and (np.abs(np.linalg.norm(samples, axis=1) - 1.0) > 0.01).any():
        i = int(np.argmax(np.abs(np.linalg.norm(samples, axis=1) - 1.0)))
        norm = float(np.linalg.norm(samples[i]))
        raise RecordingError(f"attitude[{i}] has norm {norm:.4g}: give unit quaternions, w first")
    return samples


def _as_floats(name: str, values: ArrayLike) -> Array:
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RecordingError(f"{name} is no array of numbers ({error}): give a numpy array") from error


def _refuse_non_finite(name: str, values: Array) -> None:
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        place = ", ".join(str(int(i)) for i in bad[0])
        raise RecordingError(f"{name}[{place}] is {values[tuple(bad[0])]}: remove samples that are not finite")


def _refuse_other_force_unit(values: Array) -> None:
    norm = float(np.median(np.linalg.norm(values, axis=1)))
    if not _FORCE_MPS2[0] <= norm <= _FORCE_MPS2[1]:
        raise RecordingError(
            f"specific_force_mps2 has a median norm of {norm:.3g}, but with gravity it is about 9.8 m/s²: "
            f"multiply values in g by {STANDARD_GRAVITY_MPS2}; acceleration without gravity cannot be used"
        )


def _refuse_degrees(values: Array) -> None:
    peak = float(np.percentile(np.abs(values).max(axis=1), _PEAK_PERCENTILE))
    high = float(np.percentile(np.linalg.norm(values, axis=1), 95))
    if peak > _FULL_SCALE_RADPS or high > _WALKING_RADPS:
        raise RecordingError(
            f"rotation_rate_radps reaches {peak:.4g} (95 % of the norms are below {high:.4g}), which no phone on a "
            "person measures in rad/s: convert degrees per second with numpy.deg2rad"
        )
