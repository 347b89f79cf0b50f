"""Detect the units of raw sensor values from the values themselves, where a recorder does not tell them.

Every function returns a `Conversion`: the factor to SI units, a sentence that says how it was found, and a warning
where the values do not settle the question. Nothing is guessed silently.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.types.recording import Signal

ACCELERATION_UNITS: Mapping[str, float] = {
    "m/s^2": 1.0,
    "g": STANDARD_GRAVITY_MPS2,
    "mg": 1e-3 * STANDARD_GRAVITY_MPS2,
}
"""Units in which recorders write accelerations, with their factors to m/s²."""

ROTATION_RATE_UNITS: Mapping[str, float] = {"rad/s": 1.0, "deg/s": np.pi / 180.0, "mdeg/s": np.pi / 180e3}
"""Units in which recorders write rotation rates, with their factors to rad/s."""

PRESSURE_UNITS: Mapping[str, float] = {"Pa": 1.0, "hPa": 1e2, "kPa": 1e3}
"""Units in which recorders write air pressures, with their factors to Pa."""

CLOCK_UNITS: Mapping[str, float] = {"ns": 1e9, "us": 1e6, "ms": 1e3, "s": 1.0}
"""Units in which recorders count time, with the number of them in a second, the smallest first."""

EARLIEST_UNIX_S = 9e8
"""Least time, s, that is taken as Unix time, of 1998; a smaller clock counts from something else."""

_STATIC_MPS2 = (6.5, 20.0)  # a swung phone has a mean of 12: the swing's centripetal acceleration points one way
_STATIC_G = (0.65, 2.0)
_STATIC_MG = (650.0, 1500.0)  # up to a vigorous arm's mean; above, it may be something else
_GRAVITY_SHARE = 0.65
_PARTS = 10
_ROWS_OF_MEDIAN = 50_000
_FULL_SCALE_RADPS = 40.0  # phones' gyroscopes end at 2000 deg/s = 34.9 rad/s
_WALKING_RADPS = (0.3, 12.0)  # 95th percentile of the norm, from a phone held calmly to one in a runner's pocket
_PEAK_PERCENTILE = 99.9
_CALMEST_WALK_DEGPS = 15.0
_FASTEST_WALK_DEGPS = 3000.0  # no gyroscope of a phone or watch measures more; a calm walk has 15 000 mdeg/s
_PRESSURE_RANGE_PA = (3e4, 1.2e5)


@dataclass(frozen=True)
class Conversion:
    """Conversion of raw values to the project's convention.

    Attributes
    ----------
    factor
        Factor by which raw values are multiplied.
    decision
        Sentence that says how the factor was found.
    warning
        Remaining uncertainty, or "".
    """

    factor: float
    decision: str
    warning: str = ""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Return the warning as a tuple, which is empty when there is none."""
        return (self.warning,) if self.warning else ()


@dataclass(frozen=True)
class RawSignal:
    """Signal as it was recorded.

    Attributes
    ----------
    signal
        Times in s on the clock of the recording, values as recorded.
    title
        File, table or columns that it comes from, for the decisions.
    factor
        Factor to SI units; None where only the values can tell.
    """

    signal: Signal
    title: str
    factor: float | None = None


def detect_acceleration_unit(values: Array) -> Conversion:
    """Detect whether an acceleration is in m/s^2, g or mg.

    The length of the mean vector decides. The mean is taken in ten parts, so that it survives a change of the
    carrying mode. With gravity its length is at least 0.7 of the median norm in any gait, without gravity at most 0.6
    (MotionSense, all activities).

    Parameters
    ----------
    values
        (n, 3) acceleration including gravity, of one walk.
    """
    mean = float(
        np.median([np.linalg.norm(mean_vector(part)) for part in np.array_split(values, _parts(len(values)))])
    )
    share = mean / max(_median_norm(values), 1e-9)
    if share >= _GRAVITY_SHARE:
        if _STATIC_MPS2[0] <= mean <= _STATIC_MPS2[1]:
            return Conversion(1.0, f"acceleration is in m/s^2: its mean vector has length {mean:.2f}")
        if _STATIC_G[0] <= mean <= _STATIC_G[1]:
            return Conversion(ACCELERATION_UNITS["g"], f"acceleration is in g: its mean vector has length {mean:.3f}")
        if _STATIC_MG[0] <= mean <= _STATIC_MG[1]:
            return Conversion(
                ACCELERATION_UNITS["mg"],
                f"acceleration is in mg, or in cm/s^2, which differs by 2 %: its mean vector has length {mean:.0f}",
            )
    assumed = (
        f"acceleration is assumed to be in m/s^2, although its mean vector has length {mean:.3g} "
        f"({share:.0%} of the median norm)"
    )
    if share >= _GRAVITY_SHARE and mean > _STATIC_MPS2[1]:
        return Conversion(
            1.0,
            assumed,
            f"the mean acceleration has length {mean:.4g}, which is gravity in no usual unit (9.8 in m/s^2, 1 in g, "
            f"1000 in mg): m/s^2 is assumed; state the unit with --map, such as unit: "
            f"{STANDARD_GRAVITY_MPS2 / mean:.4g}, or do not trust the track",
        )
    return Conversion(
        1.0,
        assumed,
        f"the mean acceleration has length {mean:.3g}, {share:.0%} of the median norm: with gravity it would be 1 "
        "(g) or 9.8 (m/s^2) and above 70 %; gravity may be missing, check the recorder's settings",
    )


def detect_rotation_rate_unit(values: Array) -> Conversion:
    """Detect whether a rotation rate is in rad/s, deg/s or mdeg/s, from its size while a person walks.

    A component above 40 would exceed the full scale of any phone in rad/s. Otherwise the 95th percentile of the norm
    is 0.3 to 12 rad/s in every way of carrying, while even a calmly held phone exceeds 15 deg/s in 5 % of the time.
    Where there is an accelerometer, `detect_rotation_unit` knows better, also while the person stands.

    Parameters
    ----------
    values
        (n, 3) rotation rate of one walk.
    """
    # A single damaged number must not decide, however large it is.
    sample = sampled_rows(values)
    peak = float(np.percentile(_largest_component(sample), _PEAK_PERCENTILE, method="lower"))
    high = float(np.percentile(_lengths(sample), 95))
    numbers = f"the largest component is {peak:.3g} and the 95th percentile of the norm {high:.3g}"
    if high > _FASTEST_WALK_DEGPS:
        return Conversion(ROTATION_RATE_UNITS["mdeg/s"], f"rotation rate is in mdeg/s: {numbers}")
    if peak > _FULL_SCALE_RADPS or high > _CALMEST_WALK_DEGPS:
        return Conversion(ROTATION_RATE_UNITS["deg/s"], f"rotation rate is in deg/s: {numbers}")
    if _WALKING_RADPS[0] <= high <= _WALKING_RADPS[1]:
        return Conversion(1.0, f"rotation rate is in rad/s: {numbers}")
    return Conversion(
        1.0,
        f"rotation rate is assumed to be in rad/s: {numbers}",
        f"the unit of the rotation rate cannot be determined from its size ({numbers}): rad/s is assumed; write the "
        "unit into the header to be sure",
    )


def detect_pressure_unit(values: Array) -> Conversion:
    """Detect whether an air pressure is in Pa, hPa or kPa, from its median."""
    median = float(np.median(values))
    for unit, factor in PRESSURE_UNITS.items():
        if _PRESSURE_RANGE_PA[0] <= median * factor <= _PRESSURE_RANGE_PA[1]:
            return Conversion(factor, f"air pressure is in {unit}: the median is {median:.5g}")
    return Conversion(
        1.0,
        f"air pressure is assumed to be in Pa, although its median is {median:.5g}",
        f"the median air pressure {median:.5g} fits neither Pa nor hPa nor kPa: the pressure cannot be used",
    )


def mean_vector(values: Array) -> Array:
    """Compute the mean (k,) of rows (n, k), several times as fast as `mean` does it of short rows."""
    mean: Array = np.einsum("ij->j", values) / len(values)
    return mean


def sampled_rows(values: Array) -> Array:
    """Return every k-th row of a long recording: what is taken of them hardly changes by the others."""
    return values[:: max(1, len(values) // _ROWS_OF_MEDIAN)]


def _parts(n: int) -> int:
    return max(1, min(_PARTS, n))


def _median_norm(values: Array) -> float:
    """Compute the median length of the rows; of a long recording every k-th row is enough."""
    return float(np.median(_lengths(sampled_rows(values))))


def _lengths(values: Array) -> Array:
    """Compute the length (n,) of each row; column by column, which is much faster than along short rows."""
    total = np.zeros(len(values))
    for column in values.T:
        total += column * column
    return np.sqrt(total)


def _largest_component(values: Array) -> Array:
    """Return the largest absolute component (n,) of each row."""
    largest = np.zeros(len(values))
    for column in values.T:
        np.maximum(largest, np.abs(column), out=largest)
    return largest
