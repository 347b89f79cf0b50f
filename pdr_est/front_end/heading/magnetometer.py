"""Heading of a step by the compass: the baseline "Magnetometer" of PSP.

The paper tells no more than that magnetometer readings are used directly. Levelling them by the direction of gravity
and averaging over the step is our reading of it; hard iron is not calibrated, and disturbances are not detected.

References
----------
PSP: Hong et al. 2013, Table I.
"""

from dataclasses import replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, wrap_angle
from pdr_est.front_end.heading.step_yaw import calibrated_mean_yaw
from pdr_est.front_end.signal.vectors import dot
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import Step

_LEAST_Z = 1e-9  # keeps the heading of a device that lies upside down finite


class MagnetometerHeading:
    """Stage Step -> Step that fills in the heading: the device's mean yaw against magnetic north.

    A yaw of zero is that of a device whose x axis points to magnetic east. A step without any sample of the field, or
    with one that has no direction, goes on by the device's own yaw from the last step that had one. Where such steps
    begin a segment, the change to the first direction of the field may be any angle: it gets the standard deviation
    of a uniform one.
    """

    latency_s = 0.0

    def __init__(self) -> None:
        self._segment: int | None = None
        self._north_known = False
        self._offset_rad = 0.0  # magnetic yaw less the device's own

    def push(self, item: Step, /) -> list[Step]:
        """Give a step its heading.

        Raises
        ------
        RecordingError
            If the samples are of a device without magnetometer.
        """
        device_yaw_rad = calibrated_mean_yaw(item.samples.yaw_rad)
        first = item.event.segment != self._segment
        if first:
            self._segment, self._north_known, self._offset_rad = item.event.segment, False, 0.0
        magnetic_rad = mean_magnetic_yaw(item.samples)
        if np.isnan(magnetic_rad):
            return [replace(item, heading_rad=float(wrap_angle(device_yaw_rad + self._offset_rad)))]
        sigma_rad = item.sigma_turn_rad if first or self._north_known else SIGMA_UNIFORM_RAD
        self._north_known, self._offset_rad = True, magnetic_rad - device_yaw_rad
        return [replace(item, heading_rad=magnetic_rad, sigma_turn_rad=float(sigma_rad))]

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []


def mean_magnetic_yaw(samples: LevelBlock) -> float:
    """Average `magnetic_yaw` over some samples as unit vectors, rad; NaN where no sample has a direction."""
    yaw_rad = magnetic_yaw(samples)
    yaw_rad = yaw_rad[np.isfinite(yaw_rad)]
    if not len(yaw_rad):
        return float("nan")
    return float(np.arctan2(np.sin(yaw_rad).sum(), np.cos(yaw_rad).sum()))


def magnetic_yaw(samples: LevelBlock) -> Array:
    """Compute the yaw of the device in a level frame with y to magnetic north.

    The field less its vertical part, turned with the direction up into the z axis by the shortest way, is the field
    in the frame about whose vertical the device's yaw turns; the yaw is the angle that turns it north. So it is the
    same angle as `yaw_rad`, but for its zero.

    Returns
    -------
    ndarray, shape (n,)
        Yaw, rad; NaN without field, or where the field has no horizontal part.

    Raises
    ------
    RecordingError
        If the samples are of a device without magnetometer.
    """
    field = samples.magnetic_field_ut
    if field is None:
        raise RecordingError("the recording has no magnetic field: choose another heading.method than magnetometer")
    up = samples.up
    level = field - dot(field, up)[:, None] * up
    lean = level[:, 2] / np.maximum(1.0 + up[:, 2], _LEAST_Z)
    east, north = level[:, 0] - up[:, 0] * lean, level[:, 1] - up[:, 1] * lean
    yaw_rad: Array = wrap_angle(np.pi / 2.0 - np.arctan2(north, east))
    return np.where((east == 0.0) & (north == 0.0), np.nan, yaw_rad)
