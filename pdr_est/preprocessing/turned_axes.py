"""Turn the axes of the devices of a recording, as if other axes had been laid through them."""

import math
import re
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.types.recording import DeviceRecording, Recording, Signal

_ABOUT_AXIS = re.compile(r"([xyz])([+-]?\d+(?:\.\d+)?)")
_RANDOM = re.compile(r"random:(\d+)")


@dataclass(frozen=True)
class AxisTurn:
    """Rotation of the vectors of a device: their coordinates in the old axes become those in the new ones.

    Attributes
    ----------
    quaternion
        w, x, y, z, of length 1.
    """

    quaternion: tuple[float, float, float, float]

    @classmethod
    def named(cls, name: str) -> "AxisTurn":
        """Return the turn of a name.

        Parameters
        ----------
        name
            An axis and an angle in degrees, such as x90, y-45 or z180; or random:SEED, a turn that is drawn from all
            turns with equal density.

        Raises
        ------
        ConfigError
            For anything else.
        """
        about_axis, random = _ABOUT_AXIS.fullmatch(name), _RANDOM.fullmatch(name)
        if random is not None:
            drawn = np.random.default_rng(int(random.group(1))).normal(size=4)
            w, x, y, z = (drawn / np.linalg.norm(drawn)).tolist()
            return cls((w, x, y, z))
        if about_axis is None:
            raise ConfigError(f"turn of the device {name!r}: write an axis and degrees, such as x90, or random:SEED")
        half = 0.5 * math.radians(float(about_axis.group(2)))
        axis = [math.sin(half) if axis == about_axis.group(1) else 0.0 for axis in "xyz"]
        return cls((math.cos(half), axis[0], axis[1], axis[2]))

    def matrix(self) -> Array:
        """Return the rotation matrix (3, 3)."""
        w, x, y, z = self.quaternion
        return np.array(
            [
                [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
                [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
                [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
            ]
        )

    def attitudes(self, quaternion: Array) -> Array:
        """Compute the attitudes (n, 4) of the new axes from those of the old ones."""
        a, b, c, d = quaternion.T
        w, x, y, z = self.quaternion
        return np.stack(
            [
                a * w + b * x + c * y + d * z,
                b * w - a * x - c * z + d * y,
                c * w - a * y + b * z - d * x,
                d * w - a * z - b * y + c * x,
            ],
            axis=1,
        )


def turn_axes(recording: Recording, turn: AxisTurn) -> Recording:
    """Return a recording whose devices have turned axes; where they were and how they moved is the same.

    It says that the axes are not those that phones have (`DeviceRecording.usual_axes`).

    Parameters
    ----------
    recording
        Recording; it is not changed.
    turn
        Turn of the axes of each device.
    """
    return replace(recording, devices=tuple(_turned(device, turn) for device in recording.devices))


def _turned(device: DeviceRecording, turn: AxisTurn) -> DeviceRecording:
    matrix = turn.matrix()

    def turned(signal: Signal | None) -> Signal | None:
        return None if signal is None else Signal(signal.time_s, signal.values @ matrix.T)

    attitude = device.attitude
    return replace(
        device,
        specific_force=turned(device.specific_force),
        rotation_rate=turned(device.rotation_rate),
        magnetic_field=turned(device.magnetic_field),
        attitude=None if attitude is None else Signal(attitude.time_s, turn.attitudes(attitude.values)),
        usual_axes=False,
    )
