"""Uncertainty of a track whose start is known in the map and whose direction is not.

Such a track is drawn in an arbitrary direction, and estimators state how far its shape may be off. Where the walker
is in the map is another question: anywhere on the circle about the start through the drawn pose.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.frames import SIGMA_UNIFORM_RAD, Array
from pdr_est.types.measurements import DeviceMeasurements, HeadingPrior, PositionFix, StartPose
from pdr_est.types.track import Track


def direction_is_unknown(devices: Sequence[DeviceMeasurements], start: StartPose) -> bool:
    """Tell whether the start of a walk is known in the map and nothing tells its direction there.

    Parameters
    ----------
    devices
        What the estimator was given of each device.
    start
        Start pose as far as it is known.
    """
    if start.position_m is None or start.heading_rad is not None:
        return False
    return not any(tells_direction(one) for device in devices for one in device.measurements)


def tells_direction(measurement: object) -> bool:
    """Tell whether a measurement helps to find the direction of a walk in the map: a fix, or a heading there."""
    if isinstance(measurement, HeadingPrior):
        return not measurement.relative
    return isinstance(measurement, PositionFix)


def with_unknown_direction(track: Track, devices: Sequence[DeviceMeasurements], start: StartPose) -> Track:
    """Return a track with the uncertainty of its direction, if nothing tells it: neither measurements nor a plan.

    Parameters
    ----------
    track
        Track of all devices, and of the person.
    devices, start
        What the estimator was given.
    """
    if start.position_m is None or track.on_plan or not direction_is_unknown(devices, start):
        return track
    return replace(
        track,
        covariance_m2=covariance_any_direction(track.position_m, track.covariance_m2, np.array(start.position_m)),
        sigma_heading_rad=np.full(len(track), SIGMA_UNIFORM_RAD),
        region=None,
    )


def covariance_any_direction(position_m: Array, covariance_m2: Array, start_m: Array) -> Array:
    """Return the mean squared errors of drawn positions if the true track is the drawn one turned about its start.

    With a uniform angle, the true position is d R u from the start and the drawn one d u, where R is the rotation, u
    a unit vector and d the distance; the expectation of the square of d (R u - u) is d² (I/2 + u uᵀ). The other
    errors turn as well, so that theirs is isotropic.

    Parameters
    ----------
    position_m
        Drawn positions (n, 2).
    covariance_m2
        Covariances (n, 2, 2) of their other errors.
    start_m
        Start (2,).

    Returns
    -------
    Array
        Expectations (n, 2, 2) of the outer product of the error.
    """
    off_m = position_m - start_m
    square = off_m[:, 0] ** 2 + off_m[:, 1] ** 2 + covariance_m2[:, 0, 0] + covariance_m2[:, 1, 1]
    return np.asarray(0.5 * square[:, None, None] * np.eye(2) + off_m[:, :, None] * off_m[:, None, :])
