"""Largest values that the sensors of a phone can measure; samples beyond them are damaged numbers."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.sensors import Channel


@dataclass(frozen=True)
class SensorRange:
    """Range of one kind of sensor.

    Attributes
    ----------
    largest
        Largest magnitude of a component, in the unit of the channel.
    unit
        Unit of the channel, for messages.
    """

    largest: float
    unit: str


SENSOR_RANGES: Mapping[Channel, SensorRange] = {
    Channel.SPECIFIC_FORCE: SensorRange(1000.0, "m/s^2"),
    Channel.ROTATION_RATE: SensorRange(200.0, "rad/s"),
    Channel.MAGNETIC_FIELD: SensorRange(1e5, "uT"),
}
"""Several times the widest range of such sensors: 32 g and more rarely 64 g, 4000 deg/s, 5 mT."""


def out_of_range(channel: Channel, values: Array) -> NDArray[np.bool_]:
    """Find the samples with a component beyond the sensor range of a channel.

    Parameters
    ----------
    channel
        Channel of the values; one without a known range has no such samples.
    values
        (n, k) samples. NaN is not beyond the range.

    Returns
    -------
    (n,) bool
    """
    limit = SENSOR_RANGES.get(channel)
    if limit is None:
        return np.zeros(len(values), dtype=np.bool_)
    return np.asarray((np.abs(values) > limit.largest).any(axis=1))
