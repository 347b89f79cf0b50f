"""Turn the axes of devices, as if they had been carried in another posture, or their axes laid otherwise.

A track must not depend on it; `pdr-est benchmark --turn-device` measures whether it does.
"""

import re
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.types.recording import DeviceRecording, Recording, Signal

TURN_NAMES = "x90, x180, z90, … (axis and degrees from -360 to 360) or random:SEED"

_ABOUT_AXIS = re.compile(r"([xyz])(-?[0-9]{1,3})")
_RANDOM = re.compile(r"random:([0-9]{1,9})")
_MOST_DEG = 360


def rotation_named(name: str) -> Rotation:
    """Make the rotation from the old device axes to the new ones.

    Parameters
    ----------
    name
        Axis and whole degrees from -360 to 360, such as "x90", or "random:SEED" for one that is drawn from all
        rotations alike.

    Raises
    ------
    ConfigError
        For any other name.
    """
    about, drawn = _ABOUT_AXIS.fullmatch(name), _RANDOM.fullmatch(name)
    if about is not None and abs(int(about[2])) <= _MOST_DEG:
        return Rotation.from_euler(about[1], float(about[2]), degrees=True)
    if drawn is not None:
        return Rotation.random(random_state=int(drawn[1]))
    raise ConfigError(f"turn of the device {name!r} is unknown: give {TURN_NAMES}")


def turn_devices(recording: Recording, rotation: Rotation) -> Recording:
    """Return the recording with the axes of every device turned.

    Specific force, rotation rate, magnetic field and attitude are written in the new axes, which are not those that
    phones have (`DeviceRecording.usual_axes`).
    """
    return replace(recording, devices=tuple(_turned(device, rotation) for device in recording.devices))


def _turned(device: DeviceRecording, rotation: Rotation) -> DeviceRecording:
    attitude = device.attitude
    if attitude is not None:
        attitude = Signal(attitude.time_s, _turned_attitude(attitude.values, rotation))
    return replace(
        device,
        specific_force=_turned_vectors(device.specific_force, rotation),
        linear_acceleration=_turned_vectors(device.linear_acceleration, rotation),
        rotation_rate=_turned_vectors(device.rotation_rate, rotation),
        magnetic_field=_turned_vectors(device.magnetic_field, rotation),
        attitude=attitude,
        usual_axes=False,
    )


def _turned_vectors(signal: Signal | None, rotation: Rotation) -> Signal | None:
    # Written as a product, because samples that are not finite must stay so.
    return None if signal is None else Signal(signal.time_s, signal.values @ rotation.as_matrix().T)


def _turned_attitude(quaternion: Array, rotation: Rotation) -> Array:
    """Turn attitudes (n, 4), w first, device to level: what was along the old axes is now along the new ones."""
    turned = np.full(quaternion.shape, np.nan)
    usable = np.isfinite(quaternion).all(axis=1) & (np.linalg.norm(quaternion, axis=1) > 0.0)
    x, y, z, w = (Rotation.from_quat(quaternion[usable][:, [1, 2, 3, 0]]) * rotation.inv()).as_quat().T
    turned[usable] = np.stack([w, x, y, z], axis=1)
    return turned
