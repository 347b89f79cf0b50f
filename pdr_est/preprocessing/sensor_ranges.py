"""What no sensor of a phone can give: such a sample is a damaged number and not a measurement."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.sensors import Channel


@dataclass(frozen=True)
class SensorRange:
    """largest: of a component, in the unit of the channel. unit: in words."""

    largest: float
    unit: str


SENSOR_RANGES: Mapping[Channel, SensorRange] = {
    Channel.SPECIFIC_FORCE: SensorRange(1000.0, "m/s^2"),
    Channel.ROTATION_RATE: SensorRange(200.0, "rad/s"),
    Channel.MAGNETIC_FIELD: SensorRange(1e5, "uT"),
}
"""Several times the widest range that such sensors have: 32 g and more rarely 64 g, 4000 deg/s, 5 mT."""


def out_of_range(channel: Channel, values: Array) -> NDArray[np.bool_]:
    """Which samples (n,) of a channel's values (n, k) have a component beyond its limit; NaN is not beyond."""
    limit = SENSOR_RANGES.get(channel)
    if limit is None:
        return np.zeros(len(values), dtype=np.bool_)
    return np.asarray((np.abs(values) > limit.largest).any(axis=1))
