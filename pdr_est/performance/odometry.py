"""Measurements of walks of any length: odometry whose errors are drawn from its own covariances."""

import numpy as np

from pdr_est.front_end.step_noise import step_covariance
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, StartPose, StepOdometry

START, SIGMA_SCALE = StartPose((0.0, 0.0), 0.0), 0.11
STEP_S = 0.55
_LENGTH_M, _SIGMA_LENGTH_M, _SIGMA_DIRECTION_RAD, _SIGMA_TURN_RAD = 0.7, 0.08, 0.15, 0.03
_TETHER_S, _REACH_M, _SIGMA_TETHER_M = 2.0, 0.5, 0.02


def walk_of(steps: int, devices: int = 1, seed: int = 0) -> tuple[list[DeviceMeasurements], list[DeviceTether]]:
    """Simulate the measurements of a walk along a winding path.

    Parameters
    ----------
    steps : int
        Number of steps.
    devices : int
        Number of devices, which step at slightly different times.
    seed : int
        Seed of the errors.

    Returns
    -------
    list of DeviceMeasurements, list of DeviceTether
        Odometry of each device, and the tethers between the first two.
    """
    rng = np.random.default_rng([seed, steps, devices])
    turn_rad = 0.15 * np.sin(np.arange(steps) / 9.0 + rng.uniform(0.0, 6.0))
    covariance = step_covariance(_LENGTH_M, _SIGMA_LENGTH_M, _SIGMA_DIRECTION_RAD, _SIGMA_TURN_RAD)
    root = np.linalg.cholesky(covariance)
    known = []
    for number in range(devices):
        error = rng.standard_normal((steps, 3)) @ root.T
        times_s = STEP_S * np.arange(steps + 1) + 0.05 * number
        odometry = tuple(
            StepOdometry(
                device=f"phone{number + 1}",
                time_s=float(times_s[k + 1]),
                start_s=float(times_s[k]),
                length_m=float(_LENGTH_M + error[k, 0]),
                heading_change_rad=float(turn_rad[k] + error[k, 2]),
                covariance=covariance,
            )
            for k in range(steps)
        )
        known.append(DeviceMeasurements(f"phone{number + 1}", float(times_s[0]), odometry))
    if devices < 2:
        return known, []
    at_s = np.arange(_TETHER_S, STEP_S * steps, _TETHER_S).tolist()
    return known, [DeviceTether("phone1", "phone2", time_s, _REACH_M, _SIGMA_TETHER_M) for time_s in at_s]
