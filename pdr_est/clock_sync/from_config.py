"""Clocks that somebody measured otherwise: as the configuration gives them."""

from collections.abc import Sequence
from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.errors import ConfigError
from pdr_est.params import NonNegative, params
from pdr_est.types.clock import ClockEstimate

Ahead = Annotated[float, Ge(-1e10), Le(1e10)]  # also of a clock since 1970 against one since the phone was started
PartsPerMillion = Annotated[float, Ge(-1e4), Le(1e4)]


@params
class GivenClock:
    """The device's clock shows t + offset_s + skew_ppm 1e-6 t when the common clock shows t. sigma_s: of the offset.

    Where all recorders tell the date, times are compared as dates, else as the numbers in the recordings.
    """

    device: str
    offset_s: Ahead
    skew_ppm: PartsPerMillion = 0.0
    sigma_s: NonNegative = 0.0


def clocks_given(names: Sequence[str], given: Sequence[GivenClock]) -> list[ClockEstimate]:
    """The clocks of all devices but the first, against the first. One that is not given is that of the common clock.

    Raises ConfigError for a device that is not there or is given twice, and when none is given.
    """
    told = [clock.device for clock in given]
    known = ", ".join(names)
    if not given and len(names) > 1:
        raise ConfigError(
            f"devices.clock = given: no clock is: give devices.clocks (--clock-offset) for one of {known}, or choose "
            "none (--clock none) to take the time stamps as they are"
        )
    for name in told:
        if name not in names:
            raise ConfigError(f"devices.clocks (--clock-offset): no device {name!r} in the recording: it has {known}")
        if told.count(name) > 1:
            raise ConfigError(f"devices.clocks (--clock-offset): device {name!r} is given twice: give it once")
    by_name = {clock.device: clock for clock in given}
    first, *others = (by_name.get(name, GivenClock(device=name, offset_s=0.0)) for name in names)
    return [_against(first, other) for other in others]


def _against(first: GivenClock, other: GivenClock) -> ClockEstimate:
    """When the first clock shows t, the common one shows (t - offset) / (1 + skew) of the first."""
    faster = (1.0 + 1e-6 * other.skew_ppm) / (1.0 + 1e-6 * first.skew_ppm)
    return ClockEstimate(
        offset_s=other.offset_s - faster * first.offset_s,
        skew=faster - 1.0,
        sigma_s=(first.sigma_s**2 + other.sigma_s**2) ** 0.5,
    )
