"""Clocks that the user measured by other means and gives in the configuration."""

from collections.abc import Sequence
from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.errors import ConfigError
from pdr_est.params import NonNegative, params
from pdr_est.types.clock import ClockEstimate

OffsetSeconds = Annotated[float, Ge(-1e10), Le(1e10)]  # Unix time against time since boot must fit
PartsPerMillion = Annotated[float, Ge(-1e4), Le(1e4)]


@params
class GivenClock:
    """Clock of one device: it shows t + offset_s + 1e-6 skew_ppm t when the common clock shows t.

    The times compared are dates where all recorders tell the date, else the numbers in the recordings.
    """

    device: str
    """Name of the device."""

    offset_s: OffsetSeconds
    """Time, s, by which the clock of the device is ahead of the common clock at t = 0."""

    skew_ppm: PartsPerMillion = 0.0
    """Rate, parts per million, by which the clock of the device runs fast."""

    sigma_s: NonNegative = 0.0
    """Standard deviation of the offset, s."""


def device_clocks_from_config(names: Sequence[str], given: Sequence[GivenClock]) -> list[ClockEstimate]:
    """Return the clocks of all devices but the first, relative to the first device.

    Parameters
    ----------
    names
        Names of all devices of the recording; the first one is the reference.
    given
        Clocks from the configuration. A device without one has the common clock.

    Raises
    ------
    ConfigError
        For a device that is not in the recording or is given twice, and when no clock is given at all.
    """
    given_names = [clock.device for clock in given]
    known = ", ".join(names)
    if not given and len(names) > 1:
        raise ConfigError(
            "devices.clock = given, but no clock is given: set devices.clocks (--clock-offset) for one of the "
            f"devices {known}, or choose none (--clock none) to take the time stamps as they are"
        )
    for name in given_names:
        if name not in names:
            raise ConfigError(
                f"devices.clocks (--clock-offset): the recording has no device {name!r}; its devices are {known}"
            )
        if given_names.count(name) > 1:
            raise ConfigError(f"devices.clocks (--clock-offset): device {name!r} is given twice: give it once")
    by_name = {clock.device: clock for clock in given}
    first, *others = (by_name.get(name, GivenClock(device=name, offset_s=0.0)) for name in names)
    return [_relative_clock(first, other) for other in others]


def _relative_clock(first: GivenClock, other: GivenClock) -> ClockEstimate:
    """Compose two clocks: when the first shows t, the common clock shows (t - offset) / (1 + skew) of the first."""
    rate = (1.0 + 1e-6 * other.skew_ppm) / (1.0 + 1e-6 * first.skew_ppm)
    return ClockEstimate(
        offset_s=other.offset_s - rate * first.offset_s,
        skew=rate - 1.0,
        sigma_s=(first.sigma_s**2 + other.sigma_s**2) ** 0.5,
    )
